"""What people do at home, and how a body shows it: the deed that the words of a beat tell of, from data/deeds.toml."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, takewhile
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.deed_patterns import fits, says, words_in
from planner_service.composition.deed_table import DeedRow, deed_table
from planner_service.composition.furniture_words import (
    lemmas_of,
    listed_places,
    pieces_in,
    typical_of,
)
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import EXPRESSIONS
from planner_service.themes.clause import Clause
from planner_service.themes.constructions import light_readings
from planner_service.themes.lexicon import gerund, grammar, is_adjective, is_noun, lemma_of, verb_of
from planner_service.themes.protagonist import head_of, is_person
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things, things_called
from planner_service.themes.verb_finder import tokens_of
from planner_service.themes.verb_group import NEARLY
from scene_graphs import furniture

_WAYS: Final = re.compile(
    r"\b(?:to|into|through|around|about|along|across|towards?|down|up|out of|from room to|back)\b.*?"
    r"\b(?:rooms?|kitchen|hall(?:way)?|corridor|bedroom|study|house|home|flat|apartment|stairs|door|window|bathroom)\b",
    re.IGNORECASE,
)
"""A way through a home, whatever the verb that goes it."""
_FLOOR: Final = re.compile(
    r"(?<!feet )(?<!foot )\b(?:on|onto|to) (?:the|an?|his|her|their|my) (?:\w+ )?"
    r"(?:floor|ground|(?:hearth)?rug|carpet|tiles|lino|floorboards|(?:door|yoga |gym )?mat)\b"
)
_GROUND: Final = re.compile(r"\b(?:floor|floorboards?|(?:hearth)?rugs?|carpets?|(?:door)?mats?|tiles|lino|skirting)\b")
"""What hands reach down to."""
_UNDER_IT: Final = re.compile(r"\b(?:under|beneath|underneath|below) (?:the|an?|his|her|their|my|every|each)\b")
_GOAL: Final = re.compile(r"\b(?:over|on|onto|into|in|inside|under|against|behind|beneath|beside) ((?:\w+ ?){1,4})")
"""Where something is put."""
_BEFORE_A_PICTURE: Final = re.compile(
    r"\b(?:before|in front of|at|by) (?:the|an?|his|her|their|my) (?:\w+ ){0,2}"
    r"(?:photo\w*|portrait|picture|painting|poster)\b"
)
"""Where one stands who looks at a picture."""
_BROUGHT_TO: Final = re.compile(r"\b(?:to|into|onto|towards?) ((?:\w+ ?){1,4})")
"""Where a way leads: "drags the chair | to the desk"."""
_LOW: Final = ("touch low height with the right hand", "touch low height")
_ON_TOP: Final = re.compile(r"\bon (?:the|a|his|her|their) (?:\w+ )?(?:table|desk|counter)")
_LIMBS: Final = frozenset(("foot", "leg", "elbow", "arm", "head"))
"""What lies on a table of who sits beside it: "puts her feet up on the table"."""
_UNDER: Final = re.compile(r"\b(?:under|beneath|underneath|behind|beside|next to)\b")
_STATES: Final = frozenset(("be", "have", "become", "need", "like", "love", "hate", "know", "miss", "own", "do", "let"))
_EXPRESSED: Final = frozenset(EXPRESSIONS)
_MAX_FRAGMENT: Final = 4
"""Words of a sentence without a verb that may stand for a deed."""
_NOT_NOW: Final = frozenset(("before", "after", "until", "since", "during", "without", "no", "not", "never", "nothing"))
"""Words before what is not done, or not yet."""
_GONE: Final = re.compile(
    r"^(?:\w+ )?(?:out (?:of |through )?the (?:\w+ )?(?:door|house|flat)|off to (?:the )?\w+|back (?:for|to|into) the "
    r"\w+|back home|home again|(?:in|on)?to the (?:kitchen|bedroom|living room|bathroom|study|hall|door|window))$",
    re.IGNORECASE,
)
"""Words without a verb that tell of a way: "Out the door.", "Back for the keys." """
_LIGHT_VERBS: Final = ("do", "have", "take", "play", "watch")
"""Verbs that a noun alone stands for: "dinner", "a nap", "yoga"."""
_PUT_VERBS: Final = ("put", "take", "turn", "lay")
_PUT: Final = frozenset(("on", "off", "up", "down", "out", "away", "in"))
"""Words that tell what is done to what stands before them: "kettle on"."""
_FEWEST_SAID: Final = 2
"""Words that a saying must have of them: the verb, the thing and the last."""
_INSIDE: Final = re.compile(r"\b(?:crawl|creep|crept|climb|slip|squeez)\w* (?:back )?(?:inside|in)(?: with\b|$)")
"""Into what was named before."""
_ON: Final = re.compile(r"\b(?:on|onto|in|into|at|over|by) (?=((?:\w+ ?){1,4}))")
"""Where somebody rests: not the cushion that is hugged."""
_ON_IT: Final = re.compile(r"\b(?:on|onto) it\b")
_ALONE: Final = frozenset(("picture", "clock"))
"""Pieces that, as lamps, are themselves what something is done to."""
_PICTURES: Final = frozenset(("photo", "photograph", "portrait", "frame", "poster", "drawing", "sketch", "wall"))
"""What hands do to these is seen at a picture."""
_WRITTEN: Final = frozenset(("message", "text", "email", "letter"))
"""What is answered without a voice."""
_IT: Final = frozenset(("it", "there", "one", "them"))
_ANYWHERE: Final = ("table", "kitchen counter", "desk", "cabinet")
"""Where a thing may be of which nobody knows where it is kept."""


@dataclass(frozen=True)
class Deed:
    """What a beat has a body do."""

    row: DeedRow
    skill: Skill
    pieces: tuple[str, ...]
    """Furniture where it may be done, the likeliest first; empty: wherever one is."""
    named: bool
    """Whether the beat itself names the furniture."""

    @property
    def is_gesture(self) -> bool:
        """Whether it is seen in limbs, trunk or head: what has been learned of beats has no opinion of that."""
        return any(self.row.says is row.says for row in deed_table().gesture)


def deed_of(clause: Clause, about: str = "", row: DeedRow | None = None) -> Deed | None:
    """The deed of a clause; None where nothing in its words is anything that a body does at home.

    `about` are the words that "it" and "there" may mean furniture of; `row` is what it does where that is known.
    """
    if row is None and not clause.verb and (fragment := _deed_of_fragment(clause)):
        return fragment
    found = row or row_of(clause, about)
    if found is None or (row is None and _is_of_body(clause, found)):
        return None
    named = _named(clause, about)
    skill = found.skill
    need = NEEDS.get(skill)
    in_bed = any(furniture.group_of(piece) == "bed" for piece in named)
    sits = clause.verb in ("sit", "perch", "settle") or "edge" in clause.lemmas
    if skill is Skill.SITDOWN and not found.rests and in_bed and not sits:
        skill, need = Skill.LIEDOWN, "lie"
    seated = any(affords(piece, "sit") or piece in deed_table().seats_at for piece in named) and not any(
        affords(piece, "lie") for piece in named
    )
    if skill is Skill.LIEDOWN and seated and not (_FLOOR.search(clause.text) or _UNDER.search(clause.text)):
        skill, need = Skill.SITDOWN, "sit"  # "collapses into the armchair"
    on = [
        *(piece for place in _ON.findall(clause.text) for piece in pieces_in(place)),
        *(["floor"] if _FLOOR.search(clause.text) else []),
    ]
    if need is None and (rested := _at_rest(found, on)):
        return rested
    if need is None:
        goals = [piece for place in _BROUGHT_TO.findall(clause.text) for piece in pieces_in(place)]
        pieces = [piece for piece in goals or named if furniture.affordances(piece)]
        if not pieces and _BEFORE_A_PICTURE.search(clause.text):
            pieces = ["picture"]
        return Deed(found, skill, tuple(pieces or found.at), bool(pieces))
    if skill is Skill.TOUCH:
        return _touched(clause, about, found, named)
    fitting = [piece for piece in named if affords(piece, need)]
    on_top = found.skill is skill and _ON_TOP.search(clause.text) and _LIMBS.isdisjoint(clause.lemmas)
    if skill is Skill.SITDOWN and not on_top:
        at = [piece for piece in named if not (fitting and piece == "tv stand")]  # "watches TV on the loveseat"
        seats = [seat for piece in at for seat in deed_table().seats_at.get(piece, ())]
        fitting = seats or fitting
    under = need == "lie" and bool(named) and not fitting and bool(_UNDER.search(clause.text))
    if under or _FLOOR.search(clause.text):
        fitting = ["floor"]
    return Deed(found, skill, tuple(fitting or dict.fromkeys(found.at)), bool(fitting))


def _at_rest(row: DeedRow, named: Sequence[str]) -> Deed | None:
    """What is done sitting or lying on what is named, of what is else done on one's feet: "weeps on the bed"."""
    for skill, some in ((Skill.LIEDOWN, row.lying), (Skill.SITDOWN, row.seated)):
        fitting = tuple(piece for piece in named if affords(piece, NEEDS[skill]))
        if skill is Skill.LIEDOWN and row.seated:  # a sofa is sat on
            fitting = tuple(piece for piece in fitting if furniture.group_of(piece) == "bed")
        if row.skill is Skill.LOCO and some and fitting:
            return Deed(replace(row, skill=skill, captions=some, rests=True), skill, fitting, True)
    return None


def _touched(clause: Clause, about: str, row: DeedRow, named: list[str]) -> Deed | None:
    """What hands do: where something is put, at what is named, where the thing is, else where it usually is done."""
    goals = [piece for place in _GOAL.findall(clause.text) for piece in pieces_in(place)]
    named = goals if row.there else sorted(named, key=lambda piece: "," not in clause.text and piece not in goals)
    fitting = [piece for piece in named if affords(piece, "touch")]
    if (_UNDER_IT if named else _GROUND).search(clause.text):
        row = replace(row, captions=_LOW)
    if several := listed_places(clause) or ([] if fitting else typical_of(clause.text)):
        fitting = [several[0], *fitting, *row.at]
    if fitting:
        return Deed(row, Skill.TOUCH, tuple(fitting), True)
    kept = [piece for piece in _kept(clause, about) if affords(piece, "touch")]
    if not (kept or row.at):  # hands do it to what no list has
        return Deed(replace(row, stands=True), Skill.TOUCH, _ANYWHERE, False) if _may_be_touched(clause) else None
    order = (*kept, *row.at) if row.things else (*row.at, *kept)
    return Deed(row, Skill.TOUCH, tuple(dict.fromkeys(order)), False)


def _may_be_noun(lemma: str) -> bool:
    """Whether a word is a noun, and no mark or numeral that a dictionary has as one."""
    known = grammar()
    return is_noun(lemma) and lemma not in known.marks | known.numbers | known.prepositions | _PUT | {"one"}


def object_of(clause: Clause) -> str:
    """The first noun after a clause's verb, or ""."""
    body = theme_words()["body"]
    return next((lemma for lemma in clause.lemmas[1:] if lemma in body or _may_be_noun(lemma)), "")


def thing_of(clause: Clause) -> str:
    """The last of the nouns that name what a clause's deed is done to: of "the photo album" the album."""
    noun = object_of(clause)
    at = clause.lemmas.index(noun, 1) if noun else 0
    others = grammar().adverbs | grammar().prepositions | grammar().marks
    for after in clause.lemmas[at + 1 :] if noun else ():
        if after in others or not is_noun(after):
            break
        noun = after
    return noun


def _is_of_body(clause: Clause, row: DeedRow) -> bool:
    """Whether only a part of the body does it, or has it done to it: "his heart raced", "opens one eye"."""
    body = theme_words()["body"]
    parts = [lemma_of(head_of(clause.subject))]
    rest = clause.lemmas[1:]  # "arms folded", but not "elbows wobbling"
    folded = says(row.says, (clause.verb, *parts, *rest)) and not says(row.says, (clause.verb, "thing", *rest))
    races = row.skill in (Skill.LOCO, Skill.TOUCH) and not (row.mood or folded) and bool(body & set(parts))
    noun = object_of(clause)
    return races or (row.skill is Skill.TOUCH and row.things and noun in body and noun not in things())


def _may_be_touched(clause: Clause) -> bool:
    """Whether hands may do a deed to what it is done to: to a noun that is no person and no part of the body."""
    noun = object_of(clause)
    return bool(noun) and noun not in theme_words()["body"] and not is_person(noun)


def _eaten(word: str) -> bool:
    return lemma_of(word) in (*things_called("food"), *things_called("drink"))


def _deed_of_fragment(clause: Clause) -> Deed | None:
    """The deed of words without a verb that stand for one: "Sleep.", "Then bed."; None of any others."""
    words = [token.low for token in tokens_of(clause.text) if token.text[:1].isalpha()]
    told = [word for word in words if word not in grammar().adverbs | grammar().joints]
    alone = clause.joint in ("", "then", ",") and 0 < len(told) <= _MAX_FRAGMENT and words[0] not in _NOT_NOW
    if alone and _GONE.search(clause.text):
        return deed_of(replace(clause, verb="walk", lemmas=("walk", *map(lemma_of, words))))
    if not alone or told[0] in ("out", "away"):
        return None
    for light in _PUT_VERBS if len(told) > 1 and told[-1] in _PUT else ():  # "kettle on, shoes off, feet up"
        verb = replace(clause, verb=light, lemmas=(light, *map(lemma_of, told)))
        if (found := _said(verb)) and found[0] > _FEWEST_SAID - (light == "turn"):
            return deed_of(verb)
    if told[0] in theme_words()["body"]:
        return None
    if verb_of(told[0]) == told[0]:
        verb = replace(clause, verb=told[0], lemmas=tuple(map(lemma_of, told)))
        if said_row(verb):
            return deed_of(verb)
    rests = [word for word in told if word not in grammar().prepositions | grammar().marks]
    piece = next(iter(pieces_in(" ".join(rests))), "")
    for skill in (Skill.LIEDOWN, Skill.SITDOWN):
        if len(rests) == 1 and piece and affords(piece, NEEDS[skill]):
            return Deed(DeedRow((rests[0],), skill), skill, (piece,), True)
    listed = clause.sentence > 0 and words[0] not in grammar().marks and any(map(is_noun, rests))
    if listed and len(rests) == 1 and (kept := things().get(lemma_of(rests[0]))) and not _eaten(rests[0]):  # "Keys."
        return Deed(DeedRow((rests[0],), Skill.TOUCH, stands=True), Skill.TOUCH, kept, False)
    for light in _LIGHT_VERBS if listed else ():  # "Tuesday: yoga" is done, "a banana" only spoken of
        verb = replace(clause, verb=light, lemmas=(light, *map(lemma_of, told)))
        if (found := _said(verb)) and found[0] > 1:
            return deed_of(verb)
    return None


def _named(clause: Clause, about: str) -> list[str]:
    """Furniture that a clause names, or means by "it" and "there"."""
    counts = any(word == "one" and is_noun(after) for word, after in pairwise(clause.lemmas))  # "on one leg"
    meant = (_IT & set(clause.lemmas[1:])) - ({"one"} if counts else set()) or _INSIDE.search(clause.text)
    return pieces_in(clause.text) or (pieces_in(about)[-1:] if meant else [])


def row_of(clause: Clause, about: str) -> DeedRow | None:
    """The row that a clause's words say, else by its things."""
    return said_row(_spelt_out(clause, about)) or _by_things(clause, about)


def _spelt_out(clause: Clause, about: str) -> Clause:
    """A clause with what "it" and "them" mean: of trainers "ties them" is ties the trainers, of a sofa "jumps on it" is
    on the sofa."""
    on = _ON_IT.search(clause.text) and pieces_in(about)
    meant = on[-1] if on else next((word for word in lemmas_of(about) if word in things()), "")
    if not meant or not {"it", "them"} & set(clause.lemmas[1:]):
        return clause
    known = replace(clause, lemmas=tuple(meant if word in ("it", "them") else word for word in clause.lemmas))
    return known if (_said(known) or (0,))[0] > (_said(clause) or (0,))[0] else clause


def said_row(clause: Clause) -> DeedRow | None:
    """The row whose saying tells most of the clause's words, from its verb on; else from a later -ing on."""
    found = _said(clause)
    return found[1] if found else None


def _said(clause: Clause, gestures: bool = True) -> tuple[int, DeedRow] | None:
    """The same, with how many words its saying has."""
    table = deed_table()
    does = bool(clause.verb) or clause.text.split(" ", 1)[0].endswith("ing")  # "pacing", but not "wrapped in a blanket"
    limbs = lemma_of(head_of(clause.subject)) in theme_words()["body"]  # "one leg stretched before him"
    for lemmas in readings(clause):
        first = "".join(lemmas[:1])
        for pattern, row in table.gestures.get(first, ()) if gestures and does and not limbs else ():
            if fits(pattern, lemmas) and not says(row.unless, lemmas) and not (row.alone and _is_beside(clause)):
                return len(lemmas), row
        fitting = [
            (words_in(pattern), row)
            for word in (first if does else "", "")
            for pattern, row in table.ways.get(word, ())
            if fits(pattern, lemmas)
        ]
        if fitting:
            return max(fitting, key=lambda one: one[0])
    return None


def _is_beside(clause: Clause) -> bool:
    """Whether it goes on beside what is told before: "she sweeps, singing"."""
    return clause.joint in (",", "while") and clause.text.split(" ", 1)[0].endswith("ing")


def without_gestures(clause: Clause) -> DeedRow | None:
    """The row of a clause's words where no gesture is looked for."""
    found = _said(clause, gestures=False)
    return found[1] if found else None


def readings(clause: Clause) -> Iterator[tuple[str, ...]]:
    """A clause's words from its verb on, then from every later -ing on."""
    written = not _WRITTEN.isdisjoint(clause.lemmas)
    light = light_readings(clause.lemmas)
    if clause.verb == "give" and not is_person(" ".join(clause.lemmas[1:2])):  # "gives the pot a stir"
        yield from light
    if clause.verb in theme_words()["speech_verbs"] and len(clause.lemmas) > 1 and not written:  # "says into the phone"
        yield ("talk", *clause.lemmas[1:])
    if lemma_of(head_of(clause.subject)) in theme_words()["body"]:  # "arms folded", "her knees drew up"
        yield (*clause.lemmas[:1], *lemmas_of(clause.subject), *clause.lemmas[1:])
    if clause.text.split(" ", 1)[0].lower() in NEARLY:
        yield ("nearly", *clause.lemmas)
    yield ("cannot", *clause.lemmas) if clause.unable else clause.lemmas
    if not grammar().adverbs.isdisjoint(clause.lemmas):  # "is still on hold"
        yield tuple(lemma for lemma in clause.lemmas if lemma not in grammar().adverbs)
    if clause.verb == "dream":
        return  # of dancing
    tokens = [token.low for token in tokens_of(clause.text)]
    nouns = grammar().marks - {"to"}
    beside = {word for before, word in pairwise(tokens) if before not in nouns}  # not "her reading glasses"
    for place, lemma in enumerate(clause.lemmas[1:], 1):
        if gerund(lemma) in beside and lemma not in ("be",):
            yield clause.lemmas[place:]
    yield from light


def _by_things(clause: Clause, about: str) -> DeedRow | None:
    """What is done with things by a verb nobody foresaw: a hand is laid on them; or a way is gone."""
    if clause.verb in _EXPRESSED:
        return None
    if not clause.verb or clause.verb in _STATES or _says_how(clause):
        return None
    named = _named(clause, "" if "them" in clause.lemmas else about)
    if any(affords(piece, "touch") for piece in named) or _kept(clause, about):
        return DeedRow((clause.verb,), Skill.TOUCH, things=True)
    return DeedRow((clause.verb,), Skill.LOCO) if _WAYS.search(clause.text) else None


def _says_how(clause: Clause) -> bool:
    """Whether a verb of state only says how somebody is: "feels watched", not "feels the wall"."""
    after = next((token.low for token in tokens_of(clause.text)[1:] if token.low not in grammar().adverbs), "")
    so = (after.endswith("ed") and bool(verb_of(after))) or (is_adjective(after) and not is_noun(after))
    return clause.verb in theme_words()["state_verbs"] | {"feel"} and so


def _kept(clause: Clause, about: str) -> tuple[str, ...]:
    """Where the first thing is that a clause names after its verb, or means by "it"."""
    places = things()
    first = next((at for at, word in enumerate(clause.lemmas) if at and word in places), 0)
    run = takewhile(places.__contains__, clause.lemmas[first:]) if first else ()
    found = next((places[word] for word in reversed([*run])), ())  # "the photo | album"
    if found or not _IT & set(clause.lemmas[1:]):
        return found
    return next((places[word] for word in reversed(lemmas_of(about)) if word in places), ())


def is_another(clause: Clause, piece: str) -> bool:
    """Whether a piece is itself a thing, a lamp or a picture, and no place for the other thing that hands do a deed to:
    nobody lights a candle at a lamp."""
    thing, first = thing_of(clause), object_of(clause)
    shown = _PICTURES.isdisjoint(lemma for lemma in clause.lemmas if lemma in (thing, "wall") or lemma != first)
    kept = things().get(thing) if shown else None
    alone = furniture.class_of(piece) == "light" or furniture.canonical(piece) in _ALONE
    return kept is not None and piece not in kept and alone
