"""What an acted beat tells besides its deed, and no keyframe of it shows: for whom, with what, where and how often."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import Final

from motion_backend.motion import Skill
from motion_backend.props import held_in
from planner_service.composition.deed_lexicon import said_row
from planner_service.composition.deed_table import deed_table
from planner_service.composition.furniture_words import pieces_in, pieces_told
from planner_service.composition.other_people import others_in
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.script import PlannedKeyframe
from planner_service.scripts.script_words import affords
from planner_service.themes.clause import Clause
from planner_service.themes.details import details_of
from planner_service.themes.lexicon import grammar, lemma_of
from planner_service.themes.opening_words import opening_of
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things, things_called
from planner_service.themes.verb_finder import tokens_of
from scene_graphs.furniture import categories_of

_PLACE: Final = re.compile(
    r"\b(?P<how>on top of|on|onto|upon|in|into|inside|from|out of|under|underneath|beneath|behind|against|through|over)"
    r" (?P<what>(?:the|an?|his|her|their|my|its|every|each) (?:[\w'-]+ ){0,2}?[\w'-]+)(?= (?:\w+ly|and|to|with|while"
    r"|for|until|as|again)\b|[,.;]|$)",
    re.IGNORECASE,
)
"""Where a deed is told to be done."""
_NEAR: Final = re.compile(
    r"\b(?:by|beside|next to|near|at|before|in front of) "
    r"(?P<what>(?:the|an?|his|her|their|my) (?:[\w'-]+ ){0,2}?[\w'-]+)"
    r"(?= (?:\w+ly|and|to|with|while|for|until|as|again|in|on|of|from)\b|[,.;]|$)",
    re.IGNORECASE,
)
"""What a deed is told to be done beside."""
_NOWHERE: Final = frozenset(
    ("windowsill", "sill", "fireplace", "hearth", "fire", "fireside", "stairs", "balcony", "bathtub", "tub", "bath",
     "shower", "toilet", "cot", "crib", "cradle", "altar", "easel", "lectern", "workbench", "stepladder", "ladder")
)  # fmt: skip
"""Places of a home that no home here has."""
_POSED: Final = re.compile(
    r"\bon (?:(?:his|her|their|my|one|both) (?:\w+ )?(?:knees?|legs?|foot|toes|elbows|back|stomach|belly|side|head)"
    r"|all fours|hands and knees)\b",
    re.IGNORECASE,
)
"""How a body is while it does something, if its caption says so too."""
_POSES: Final = re.compile(r"kneel|tiptoe|prone|supine|l(?:ie|ying)|squat|crouch|yoga")
_LED: Final = (
    r"(?:\b(?:of|from|off|in|on|at|to|by|into|onto) )?"
    r"(?:(?:the|an?|his|her|their|my|its|every|each|both) )?(?:[\w'-]+ )??"
)
"""Words before a name."""
_ON: Final = frozenset(("on top of", "on", "onto", "upon"))
_HIDDEN: Final = frozenset(("under", "underneath", "beneath", "behind", "in", "into", "inside", "through"))
_FROM: Final = ("from", "out of")
_UNDER: Final = frozenset(("under", "underneath", "beneath"))
_OFTEN: Final = re.compile(
    r"\b(?:twice|thrice|(?:two|three|four|five|six|seven|eight|nine|ten|a dozen|many|several|a hundred) times"
    r"|again and again|over and over(?: again)?|one by one|one after (?:another|the other))\b",
    re.IGNORECASE,
)
"""How often, of what is seen once."""
_EXERCISED: Final = re.compile(
    r"\b(?:\d+|five|six|seven|eight|nine|ten|twelve|fifteen|twenty|thirty|forty|fifty|a hundred|hundreds of)"
    r"(?= (?:\w+[ -])?(?:(?:push|sit|press|pull)-?ups?|squats?|jacks|crunches|jumps|laps|reps)\b)",
    re.IGNORECASE,
)
"""More of them than are seen."""
_EACH: Final = re.compile(
    r"\b(?:each|every|all|both|two|three|four|five|six|seven|eight|nine|ten)"
    r"(?= (?:of )?(?:the |his |her |their |my )?(?P<what>[\w'-]+))",
    re.IGNORECASE,
)
_OBJECT: Final = re.compile(
    r"(?:^|\b(?P<with>with ))(?:(?:(?:him|her|them|my)sel(?:f|ves)|him|her|them|me) )?"
    r"(?:(?:up|down|out|away|off|on|together) )?"
    r"(?P<what>(?:the|an?|his|her|their|my|its|some|every|two|three|four) (?:[\w'-]+ ){0,2}?[\w'-]+)"
    r"(?= (?:in|on|at|to|into|onto|from|for|with|under|behind|off|out|up|down|away|back|over|again|and|while|until"
    r"|\w+ly)\b"
    r"|[,.;]|$)",
    re.IGNORECASE,
)
"""What a deed is done to, or with."""
_WITH: Final = re.compile(
    r"with (?:[\w'-]+ ){0,3}?(?P<what>[\w'-]+)(?: in (?:his|her|their|one|the|both) (?:\w+ )?(?:hands?|arms))?$",
    re.IGNORECASE,
)
"""What somebody has in the hands meanwhile, and where else it is told to be is not seen."""
_BEHIND: Final = re.compile(r"behind (?:him|her|them)(?:self|selves)?$", re.IGNORECASE)
"""Where somebody is who shuts a door."""
_BARE: Final = re.compile(
    r"^(?:An act|touch|pick up|put down|turn on|rotate|wash|Low touch|carrying|throwing|kicking|dressing)\b"
)
"""Captions in which nothing is in the hands; but a box."""
_DOING: Final = re.compile(r"\w+ing\b")
_AT_REST: Final = frozenset(
    ("sitting", "lying", "leaning", "lean", "thinking", "resting", "supporting", "crossing", "bending")
)
"""What captions call somebody's doing who does nothing with the hands."""
_SEEN_OFTEN: Final = re.compile(r"knock|jump|clap|nod|wav|kick|squat|swing|step|march|paci|rock|stir|knit|shak")
"""Of captions that do it several times."""


def unshown(clause: Clause, used: Collection[str]) -> tuple[str, ...]:
    """What a clause tells besides its deed, and neither the furniture that is used nor the deed's own saying has: "for
    her ladyship"."""
    row = said_row(clause)
    known = frozenset(re.findall(r"[a-z]{4,}", " ".join(row.says)) if row else ()) - grammar().prepositions
    return tuple(
        text for text in details_of(clause)
        if known.isdisjoint(map(lemma_of, _words(text)))
        and not (pieces_in(text) and set(used).issuperset(pieces_in(text)))
    )  # fmt: skip


def unseen(clause: Clause, keyframes: Sequence[PlannedKeyframe]) -> tuple[str, ...]:
    """The same of the keyframes that show it, with things that no hand is seen with, places where the body is not, and
    how often it does what it does once."""
    named = _held_words(keyframes)
    told = unshown(clause, {one.piece[0] for one in keyframes})
    shuts = any(one.does == "close" for one in keyframes)
    besides = [
        text for text in told
        if (not (match := _WITH.match(text)) or lemma_of(match["what"].lower()) not in named)
        and not (shuts and _BEHIND.match(text))
    ]  # fmt: skip
    more = (
        *others_in(clause, keyframes),
        *_things(clause, keyframes),
        *_places(clause, keyframes),
        *_pieces(clause, keyframes),
        *_poses(clause, keyframes),
        *_counts(clause, keyframes),
    )
    words = [*besides, *dict.fromkeys(more)]
    return tuple(text for text in words if not any(text != one and text in one for one in words))


def _held_words(keyframes: Sequence[PlannedKeyframe]) -> frozenset[str]:
    """What keyframes name to be in the hands."""
    return frozenset(lemma_of(word) for one in keyframes for word in _words(one.held))


def _words(text: str) -> list[str]:
    return [token.low for token in tokens_of(text)]


def _things(clause: Clause, keyframes: Sequence[PlannedKeyframe]) -> list[str]:
    """What hands do it to, and with what, of things that are kept somewhere: a hand that is laid there has none of
    them but what its keyframe names, and what is carried is else a box."""
    done = [one for one in keyframes if not connects(one)] or list(keyframes)
    rows = [held_in(one.skill, one.caption, one.held) for one in done]
    worked = any(row is not None and row.of and row.lies_under for row in rows)
    tooled = any(row is not None and row.of for row in rows)
    bare = bool(done) and not worked and (tooled or all(_BARE.search(one.caption) or _is_idle(one) for one in done))
    if clause.verb in theme_words()["sought_verbs"] or clause.quotes:
        return []
    told = [one for one in _OBJECT.finditer(clause.text.partition(" ")[2]) if bare or one["with"]]
    seen = {lemma_of(word) for one in done for word in _words(one.caption)}
    seen |= {grip.prop for row in rows if row is not None for grip in row.props}
    named = _held_words(keyframes)
    told = [one for one in told if lemma_of(_words(one["what"])[-1]) not in (named if bare else named | seen)]
    found = [(one["with"] or "") + one["what"] for one in told if _is_carried(one["what"])]
    plain = " ".join(clause.text.split()[1:2]).strip(",.;")  # "chops vegetables"
    if bare and plain and lemma_of(plain.lower()) not in named and _is_carried(plain):
        found.append(plain)
    return found[:1]


def _is_idle(keyframe: PlannedKeyframe) -> bool:
    """Whether somebody only sits or lies there."""
    rests = keyframe.skill in (Skill.SITDOWN, Skill.LIEDOWN)
    return rests and not keyframe.held and _AT_REST.issuperset(_DOING.findall(keyframe.caption.lower()))


def _is_carried(what: str) -> bool:
    """Whether words name a thing that would be seen in a hand; no furniture, nor what belongs to a house."""
    noun = lemma_of(_words(what)[-1])
    fixed = noun in (*things_called("fixture"), *theme_words()["body"]) or things().get(noun, ())[:1] == ("plant",)
    return noun in things() and not (fixed or pieces_in(what)) and noun not in theme_words()["not_held"]


def _places(clause: Clause, keyframes: Sequence[PlannedKeyframe]) -> list[str]:
    """Furniture and things that it is told to be done on, in, under or against, where no keyframe is."""
    first = clause.text.split(" ", 1)[0]
    found = []
    for place in _PLACE.finditer(clause.text):
        how, what = place["how"].lower(), place["what"]
        beside_verb = clause.text[: place.start()].strip() == first
        if how in _FROM and not _is_carried(what):
            continue  # where somebody comes from is not seen there
        worn = how == "on" and lemma_of(_words(what)[-1]) in things_called("clothes")  # "ties | on an apron"
        if beside_verb and how not in _UNDER and (worn or clause.verb in theme_words()["particle_verbs"]):
            continue
        if _is_place(what) and not any(_is_at(one, how, what) for one in keyframes):
            found.append(place[0])
    beside = [place for place in _NEAR.finditer(clause.text) if not _is_near(clause, place["what"], keyframes)]
    return [*found, *(place[0] for place in beside)]


def _pieces(clause: Clause, keyframes: Sequence[PlannedKeyframe]) -> list[str]:
    """Furniture, and places that no home has, of which no keyframe is at any: "pulls the sheets off | the piano"."""
    told = clause.text.partition(" ")[2]
    names = [name for name, _ in pieces_told(told) if not name.startswith("drawer")]
    names += [word for word in _words(told) if lemma_of(word) in _NOWHERE and word not in names]
    if any(opening_of(one.skill, clause.text) for one in keyframes):
        return []
    far = [re.escape(name) for name in names if not any(_is_at(one, "at", name) for one in keyframes)]
    found = (re.search(rf"{_LED}\b{name}\b", told, re.IGNORECASE) for name in far)
    return [one[0] for one in found if one]


def _poses(clause: Clause, keyframes: Sequence[PlannedKeyframe]) -> list[str]:
    """How the body is told to be, where no caption says so: "scrubs it | on his knees"."""
    seen = any(_POSES.search(one.caption.lower()) or one.skill is Skill.LIEDOWN for one in keyframes)
    return [] if seen else [one[0] for one in _POSED.finditer(clause.text)]


def _is_near(clause: Clause, what: str, keyframes: Sequence[PlannedKeyframe]) -> bool:
    """Whether a keyframe is seen beside what words name, where that is a place: furniture, a window or a door."""
    noun = lemma_of(_words(what)[-1])
    if noun in _NOWHERE:
        return False
    if noun in ("window", "door", "doorway"):
        return any(opening_of(one.skill, clause.text) for one in keyframes)
    return not pieces_in(what) or any(_is_at(one, "at", what) for one in keyframes)


def _is_place(what: str) -> bool:
    """Whether words name furniture or a thing; no room, time or part of a body."""
    noun = lemma_of(_words(what)[-1])
    return bool(pieces_in(what)) or noun in things() or noun in _NOWHERE


def _is_at(keyframe: PlannedKeyframe, how: str, what: str) -> bool:
    """Whether a keyframe is seen to be there, as far as its furniture and its caption tell."""
    in_hands = _held_words([keyframe]).union(map(lemma_of, _words(keyframe.caption)))
    if any(lemma_of(word) in in_hands for word in _words(what)[1:]):
        return True  # "reads in the book", "reads on her phone"
    pieces = pieces_in(what)
    if lemma_of(_words(what)[-1]) in _NOWHERE:
        return False
    kinds = categories_of(keyframe.piece[0])
    meant = [*pieces, *(seat for piece in pieces for seat in deed_table().seats_at.get(piece, ()))]
    there = any(not kinds.isdisjoint(categories_of(piece)) for piece in meant)
    if keyframe.skill is Skill.LOCO:  # it stands before it
        return there and how not in _ON | _HIDDEN
    if keyframe.skill is Skill.TOUCH:  # what hands do to a thing is seen where it is kept
        under = how in _UNDER and "prone" not in keyframe.caption.lower() and bool(pieces)
        return (there and not under) or not pieces
    under = (
        how in _HIDDEN and bool(pieces) and not any(affords(piece, "sit") or affords(piece, "lie") for piece in pieces)
    )
    return there and (how == "behind" or not under)


def _counts(clause: Clause, keyframes: Sequence[PlannedKeyframe]) -> list[str]:
    """How often, and to how many, of what is done once."""
    done = [one for one in keyframes if not connects(one)] or list(keyframes)
    if found := _EXERCISED.search(clause.text):
        return [found[0]]
    if len(done) > 1 or any(_SEEN_OFTEN.search(one.caption) for one in done):
        return []
    counted = [one[0] for one in _OFTEN.finditer(clause.text)]
    return [*counted, *(one[0] for one in _EACH.finditer(clause.text) if _is_place(f"the {one['what']}"))]
