"""How a story begins, goes on and ends: openings, connecting words, closings and titles, by mood.

Why a body does what it does: words for a mood that lead to an act, and for one mood that gives way to another.
"""

from __future__ import annotations

import re
from typing import Final

OPENINGS: Final[dict[str, tuple[str, ...]]] = {
    "neutral": (
        "It was an ordinary {time}, and {name} had the house to {themself}.",
        "The {time} began like any other, with {name} alone at home.",
        "Nothing about the {time} seemed unusual at first.",
        "Nobody could have said beforehand what the {time} would bring.",
        "The {time} had only just begun, and the house lay still around {name}.",
        "On a {time} like any other, {name} was at home and glad of it.",
        "There was nobody in the house that {time} but {name}.",
    ),
    "happy": (
        "It was one of those {time}s on which everything seemed possible.",
        "Light filled the house that {time}, and {name} was in the best of spirits.",
        "That {time} there was a spring in every step {name} took.",
        "Some {time}s begin with a smile, and this was one of them.",
    ),
    "angry": (
        "The {time} had hardly begun, and already it was going wrong.",
        "There are {time}s that test a person's patience, and this was one.",
        "That {time} it took very little to make {name} boil over.",
    ),
    "hurried": (
        "That {time} the clock was nobody's friend.",
        "There was never enough time, and that {time} there was less than ever.",
        "Every minute counted that {time}.",
        "The {time} had started without {name}, and there was much to catch up on.",
    ),
    "tired": (
        "It had been a long {time}, and {name} could feel it in every bone.",
        "The {time} was still, and {name} was close to the end of {their} strength.",
        "That {time} even the light in the rooms looked tired.",
    ),
    "sad": (
        "A grey {time} hung over the house.",
        "That {time} all colours seemed to have left the house.",
        "It was very quiet in the house that {time}, quieter than {name} could bear.",
        "Some {time}s weigh more than others, and this was one of them.",
    ),
    "stressed": (
        "That {time} {name} could not find a moment's peace.",
        "Something was wrong with the {time} from the start: it would not pass.",
        "There was a tightness in the air that {time}, and {name} felt it with every breath.",
    ),
    "drunk": (
        "The {time} was no longer young, and neither was the first bottle.",
        "It was that kind of {time}, and the glass was seldom empty.",
    ),
    "relaxed": (
        "It was a slow, generous {time}, and {name} had nowhere to be.",
        "For once the {time} belonged to {name} alone.",
        "The {time} lay ahead, wide and quiet, without a single plan.",
    ),
}

BEGINNINGS: Final = (
    "That {time} {event}",
    "This is how the {time} began: {event}",
    "Once, on a {time} like any other, {event}",
)
"""A story's first sentence with what happens first in it."""
SUDDEN_BEGINNINGS: Final = (
    "It all began when {event}",
    "It was the {time} when {event}",
    "Later it would be remembered as the {time} when {event}",
)
"""The same where it is no state."""
JOINTS: Final = (
    "{event}, and {who} ",
    "{event}; then {who} ",
    "{event}, and soon {who} ",
    "{event}, and with that {who} ",
    "{event}; a little later {who} ",
    "{event}, and before long {who} ",
)
"""What happens and what the body does, in one sentence."""

THERE: Final = ("there", "and there", "once there,", "it was there that")
"""Before what is done at rest, once the body rests."""
SO: Final = ("and so", "so", "that was how")
"""Before what the body has just done."""
TURNS: Final = (
    "Then", "Later,", "After that,", "Not long afterwards,", "Some time later,", "By and by,", "In time,",
    "A good while later,", "Next,", "After a time,", "At some point,", "A little later,", "In due time,",
)  # fmt: skip
"""Before a sentence about what happens that begins like one before it."""
NOTES: Final = ("As it happened,", "For once,", "Be that as it may,")
"""Before such a sentence where it cannot be told when."""
CRIES: Final = ("And then", "And at last", "And all at once")
STANDS_ALONE: Final = re.compile(r"(?:That (?:night|day)|It was|There was|The next|The day|Then|But|So|Later|After)\b")
"""Sentences that no word for the time goes before."""

CLOSINGS: Final[dict[str, tuple[str, ...]]] = {
    "neutral": ("And so the {time} took its course.", "The house was still again, and that was all right."),
    "happy": (
        "It was a {time} to remember.",
        "Long afterwards, {name} would still smile at the thought of that {time}.",
        "If happiness had a sound, it would have filled every room.",
    ),
    "angry": (
        "It would be a good while before the anger burned down.",
        "That {time} would not be forgiven quickly.",
    ),
    "hurried": (
        "And there was still no time to lose.",
        "It was a {time} without a quiet minute.",
    ),
    "tired": (
        "The house grew quiet around {them}, and the long {time} was over.",
        "There was nothing more to do but rest.",
    ),
    "sad": (
        "Outside, the world went on as if nothing had happened.",
        "The silence stayed, and {name} stayed in it.",
        "Some things take longer than one {time} to heal.",
    ),
    "stressed": (
        "Peace of mind would have to wait for another day.",
        "The worry had not left; it had only sat down too.",
    ),
    "drunk": ("The room went on turning for a long while.", "Tomorrow would have a word to say about all this."),
    "relaxed": (
        "There was nothing left to wish for.",
        "Nothing else was needed that {time}.",
        "And the rest of the {time} could take care of itself.",
    ),
}
LYING_CLOSINGS: Final[dict[str, tuple[str, ...]]] = {
    "tired": ("Sleep was not long in coming.", "Within minutes {they} {were} fast asleep."),
    "drunk": ("Sleep came like a curtain falling.", "Sleep came at once."),
    "sad": ("Sleep, when it came, was a mercy.",),
    "relaxed": ("{Their} breath grew slow, and the {time} drifted away.",),
    "happy": ("{They} lay there and smiled.",),
}

TURNED_CLOSINGS: Final[dict[tuple[str, str], tuple[str, ...]]] = {
    ("happy", "sad"): (
        "How light the {time} had been when it began!",
        "Of the hopes it had begun with, not one was left.",
    ),
    ("happy", "angry"): ("And it had begun so well.",),
    ("happy", "tired"): ("It had been a good {time}, and it was a good tiredness.",),
    ("happy", "drunk"): ("The joy had been real; the headache would be, too.",),
    ("happy", "relaxed"): ("It was the kind of {time} that asks for nothing more.",),
    ("sad", "happy"): ("Nobody who saw {them} now would have guessed how the {time} had begun.",),
    ("sad", "relaxed"): ("The grief was not gone, but it had grown quiet.",),
    ("sad", "drunk"): ("The sorrow was still there.",),
    ("angry", "relaxed"): ("Of all that anger there was nothing left to see.",),
    ("angry", "happy"): (
        "What had there been to be so angry about?",
        "The anger was forgotten as quickly as it had come.",
    ),
    ("angry", "sad"): ("Anger would have been easier to bear.",),
    ("stressed", "relaxed"): ("Not one of the great worries seemed so very great any more.",),
    ("stressed", "happy"): ("Of all that worry there was nothing left.",),
    ("stressed", "tired"): ("Whatever there was to worry about would have to wait.",),
    ("hurried", "tired"): ("All that haste had left nothing but tired feet.",),
    ("hurried", "relaxed"): ("There was no hurry any more.",),
    ("tired", "happy"): ("Of the tiredness there was nothing left to be seen.",),
}
"""Where a story ends in another mood than it began."""

_TIMES: Final = (
    (r"(?<!until )(?<!for )(?<!early )\bmorning\b|\boversle\w+|\bbreakfast\b|\bwak(?:es?|ing) up\b", "morning"),
    (r"\bafternoon\b|\blunch\b", "afternoon"),
    (r"\bevening\b|\bdinner\b|\bsunset\b|\bafter work\b|\bfrom work\b", "evening"),
    (r"\bnight\b|\bmidnight\b|\bsleepless\b|\binsomnia\b|\b(?:can't|can’t|cannot) sleep\b", "night"),
    (r"\bsunday\b", "Sunday"),
    (r"\bsaturday\b", "Saturday"),
)
_TITLES: Final = (
    (r"\bpizza\b", "Dinner by Telephone"),
    (r"lotter", "The Winning Ticket"),
    (r"jewel|jewell|\bring\b|necklace", "The Lost Jewellery"),
    (r"interview", "The Job Interview"),
    (r"picnic", "Before the Picnic"),
    (r"photograph|\bphoto\b", "An Old Photograph"),
    (r"dead wife|late wife|widow|his wife", "The Empty Chair"),
    (r"lost love|broken heart|heartbr|break-?up|dumped", "After the Goodbye"),
    (r"birthday", "A Birthday at Home"),
    (r"guests?\b|visitors?\b", "Before the Guests Arrive"),
    (r"pass(?:es|ed)? (?:\w+ )?exam", "The Exam Is Passed"),
    (r"fail(?:s|ed)? (?:\w+ )?exam", "After the Exam"),
    (r"(?:all|whole) night.*\bexams?\b", "The Night Before the Exam"),
    (r"\bexams?\b|studying", "The Exam"),
    (r"deadline|working late|\bovertime\b", "Past Midnight"),
    (r"\bkeys\b", "Where Are the Keys?"),
    (r"hangover|hung ?over", "The Morning After"),
    (r"insomnia|cannot sleep|can't sleep|sleepless", "Wide Awake"),
    (r"power cut|blackout|lights go out", "Lights Out"),
    (r"quarrel|argument|argu(?:es|ing)|fights? with", "After the Quarrel"),
    (r"\blate for|oversle", "Running Late"),
    (r"\bletter\b", "The Letter"),
    (r"promot", "A Reason to Celebrate"),
    (r"\bdate\b", "Dressed for the Evening"),
    (r"party", "The Party"),
    (r"\bpacks?\b|\bpacking\b|\btrip\b|journey", "Packing"),
    (r"\bsick\b|\bcold\b|fever|\bill\b", "A Day in Bed"),
    (r"\brain(?:s|ing|y)?\b|\bthunder", "Rain on the Window"),
    (r"\bwine\b|\bwhisky\b|\bdrunk", "One Glass More"),
    (r"\bcomics?\b", "The Comic Book"),
    (r"\bbooks?\b|\bnovel\b|\bread(?:s|ing)?\b", "A Good Book"),
    (r"\bbills?\b|\bdebts?\b", "The Bills"),
    (r"meditat|yoga", "A Quiet Breath"),
    (r"weekend|sunday|saturday", "A Slow Weekend"),
    (r"bad news", "Bad News"),
    (r"good news", "Good News"),
    (r"\bphone\b|\bcall\b", "The Call"),
    (r"\bcook|\bdinner\b", "Dinner at Home"),
    (r"\bguitar\b|\bpiano\b", "A Song at Home"),
    (r"\bneighbours?\b|\bnoise\b", "Through the Wall"),
    (r"\bidea\b", "The Idea"),
    (r"\blonel", "A Quiet House"),
    (r"\bsearch|looking for|\bloses\b|\blost\b", "Lost and Looked For"),
    (r"danc", "Nobody Is Watching"),
    (r"\bwork\b", "Home from Work"),
)
_MOOD_TITLES: Final[dict[str, str]] = {
    "neutral": "An Ordinary {time}",
    "happy": "A Bright {time}",
    "angry": "A Short Fuse",
    "hurried": "Against the Clock",
    "tired": "A Long {time}",
    "sad": "A Heavy {time}",
    "stressed": "No Peace of Mind",
    "drunk": "One Glass More",
    "relaxed": "A {time} at Home",
}


def time_of(*texts: str) -> str:
    """The time of day that the first text to do so speaks of: morning, afternoon, evening, night, Sunday, or day."""
    found = (time for text in texts for pattern, time in _TIMES if re.search(pattern, text, re.IGNORECASE))
    return next(found, "day")


def tells_time(text: str) -> bool:
    """Whether a text says when it happens."""
    return time_of(text) != "day" or bool(re.search(r"\b(?:day|noon|hours?|weeks?)\b", text))


def gainsaid(opening: str, event: str) -> bool:
    """Whether a story's opening sentence claims a place or a time that its first event speaks of itself."""
    away = re.search(r"\bhome\b|\breturn|\barriv|\bback from\b|\bguests?\b|\bfriends?\b|\bvisit", event, re.IGNORECASE)
    all_of_it = re.search(r"\b(?:all|whole|until|till)\b", event)
    return bool(
        (away and re.search(r"at home|the house|alone", opening))
        or (all_of_it and re.search(r"^All that|long \{time\}|only just begun|lay ahead", opening))
    )


def title_of(theme: str, mood: str, time: str | None = None) -> str:
    """A short title: after what the theme is about, else after its mood and the time of day."""
    for pattern, title in _TITLES:
        if re.search(pattern, theme, re.IGNORECASE):
            return title
    title = _MOOD_TITLES[mood].format(time=(time or time_of(theme)).capitalize())
    return re.sub(r"^A (?=[AEIOU])", "An ", title)


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
