"""Why a body does what it does: words for a mood that lead to an act, and for one mood that gives way to another."""

from __future__ import annotations

from typing import Final

MOODS: Final[dict[str, tuple[str, ...]]] = {
    "happy": ("beaming", "full of joy", "light at heart", "glowing"),
    "angry": ("still fuming", "white with anger", "jaw set"),
    "hurried": ("with no time to lose", "short of breath", "in a great hurry"),
    "tired": ("heavy-limbed", "half asleep", "yawning"),
    "sad": ("heavy at heart", "close to tears", "lost in sorrow"),
    "stressed": ("tense", "on edge", "with a knot in the stomach"),
    "drunk": ("none too steady", "with swimming eyes", "far from sober"),
    "relaxed": ("at ease", "in no hurry at all", "quite content"),
}
"""Words about the body's mood that may open a sentence before its subject."""

REASONS: Final[dict[tuple[str, str], tuple[str, ...]]] = {
    ("happy", "roam"): (
        "standing still was out of the question, so {who} {did}.",
        "so much joy needed room, and {who} {did}.",
        "because happiness will not keep still, {who} {did}.",
    ),
    ("happy", "settle"): (
        "it was time to catch a breath, so {who} {did}.",
        "out of breath with so much gladness, {who} {did}.",
    ),
    ("happy", "rest"): (
        "it was time to catch a breath, so {who} {did}.",
        "out of breath with so much gladness, {who} {did}.",
    ),
    ("happy", "do"): ("everything was easy that {time}, and {who} {did}.",),
    ("angry", "roam"): (
        "the anger had to go somewhere, so {who} {did}.",
        "because keeping still was impossible, {who} {did}.",
    ),
    ("angry", "settle"): (
        "there was nothing to be done about it, so {who} {did}.",
        "with clenched teeth, {who} {did}.",
    ),
    ("angry", "rest"): ("there was nothing to be done about it, so {who} {did}.",),
    ("angry", "do"): ("anger made every movement rough as {who} {did}.",),
    ("hurried", "roam"): ("there was not a second to spare, so {who} {did}.",),
    ("hurried", "do"): (
        "with one eye on the clock, {who} {did}.",
        "every second counted, so {who} {did}.",
        "haste makes clumsy hands, but {who} {did}.",
    ),
    ("tired", "roam"): (
        "every step cost an effort, but {who} {did}.",
        "with eyes that would hardly stay open, {who} {did}.",
    ),
    ("tired", "settle"): (
        "it was high time to rest, so {who} {did}.",
        "longing for nothing but rest, {who} {did}.",
    ),
    ("tired", "rest"): (
        "as {their} legs would carry {them} no further, {who} {did}.",
        "the day had taken all {their} strength, so {who} {did}.",
        "because even standing was too much, {who} {did}.",
    ),
    ("tired", "do"): ("slowly, as if through deep water, {who} {did}.",),
    ("sad", "roam"): (
        "not knowing where to turn, {who} {did}.",
        "because there was nothing else to do, {who} {did}.",
        "with thoughts that were far away, {who} {did}.",
    ),
    ("sad", "settle"): (
        "wanting only to be left alone, {who} {did}.",
        "with no strength left, {who} {did}.",
    ),
    ("sad", "rest"): (
        "there was no strength left to stand, so {who} {did}.",
        "the weight of it all was too much, and {who} {did}.",
        "as if {their} knees had given way, {who} {did}.",
    ),
    ("sad", "do"): ("with hands that felt like someone else's, {who} {did}.", "without a word, {who} {did}."),
    ("stressed", "roam"): (
        "because standing still would only have made it worse, {who} {did}.",
        "{their} thoughts would not rest, and so {who} {did}.",
    ),
    ("stressed", "settle"): (
        "to steady {their} nerves, {who} {did}.",
        "in the hope of a little calm, {who} {did}.",
    ),
    ("stressed", "rest"): ("to steady {their} nerves, {who} {did}.", "in the hope of a little calm, {who} {did}."),
    ("stressed", "do"): ("just to have something to do, {who} {did}.",),
    ("drunk", "roam"): ("the floor seemed to tilt as {who} {did}.", "in something like a straight line, {who} {did}."),
    ("drunk", "settle"): (
        "because the world was spinning, {who} {did}.",
        "with the room going round, {who} {did}.",
    ),
    ("drunk", "rest"): (
        "because the world was spinning, {who} {did}.",
        "before {their} legs could give way, {who} {did}.",
    ),
    ("drunk", "do"): ("with great care and little success, {who} {did}.",),
    ("relaxed", "roam"): ("because there was no hurry, {who} {did}.", "just because it was pleasant, {who} {did}."),
    ("relaxed", "settle"): (
        "there was all the time in the world, so {who} {did}.",
        "as nobody was waiting, {who} {did}.",
    ),
    ("relaxed", "rest"): (
        "there was all the time in the world, so {who} {did}.",
        "to enjoy it properly, {who} {did}.",
        "as nobody was waiting, {who} {did}.",
    ),
    ("relaxed", "do"): ("taking plenty of time, {who} {did}.",),
    ("neutral", "roam"): ("to stretch {their} legs a little, {who} {did}.", "deep in thought, {who} {did}."),
    ("neutral", "settle"): ("as there was a little time, {who} {did}.",),
    ("neutral", "rest"): ("as there was time to sit for a while, {who} {did}.",),
    ("neutral", "do"): ("without much thought, {who} {did}.", "as on any other day, {who} {did}."),
}
"""Frames that give a reason, by mood and by what the sentence is for: to roam, to rest there and then, to go and settle
somewhere, or to do something."""

_BRIGHTER: Final = ("Then all at once everything looked brighter.", "And then {name} could not help but smile.")
"""To a good mood where there was no bad one."""

MOOD_CHANGES: Final[dict[str, dict[str, tuple[str, ...]]]] = {
    "happy": {
        "neutral": _BRIGHTER,
        "relaxed": _BRIGHTER,
        "hurried": _BRIGHTER,
        "drunk": ("For all that, there was still room for joy.",),
        "": (
            "Then the {time} took a turn for the better.",
            "And then, quite unexpectedly, things looked up.",
            "Then, against all expectation, the clouds parted.",
        ),
    },
    "sad": {
        "happy": ("But the good mood did not last.", "Joy is a guest that leaves early."),
        "relaxed": ("But the peace did not last.",),
        "angry": ("Little by little the anger gave way to something heavier.",),
        "drunk": ("The wine did not help for long.",),
        "": ("Then a shadow fell over the {time}.", "Something in {name} grew very quiet then."),
    },
    "angry": {
        "": ("That was where {their} patience ended.", "It did not take much more, and {their} temper was gone."),
    },
    "hurried": {"": ("Suddenly there was no time to lose.", "All at once every minute counted.")},
    "tired": {
        "": (
            "By then {their} strength was running low.",
            "All of that had taken its toll, and {name} felt every step.",
        ),
    },
    "stressed": {
        "": ("But something would not leave {them} in peace.", "But the calm did not hold."),
    },
    "drunk": {"": ("It did not stay at one glass.", "From then on nothing in the house stood quite still.")},
    "relaxed": {
        "happy": ("Little by little the excitement made way for a quiet contentment.",),
        "neutral": ("After that there was nothing that could not wait.",),
        "": ("Slowly, very slowly, the tension eased.", "And then, at last, a little peace returned."),
    },
    "neutral": {
        "": ("After that, everyday things had their turn.", "Life, meanwhile, went on as usual."),
    },
}
"""A sentence between two moods, by the new mood and then the old one, "" for any other old one."""
