"""What is in the hands by name: things that the theme names, in the keyframes that take, use, carry and put them down.

A thing that is named again is in the hands in between, and one that was taken stays there afterwards, until the hands
are needed for something else.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from motion_backend.motion import RISINGS, Emotion, Skill
from motion_backend.props import held_in, shown_as, things_named
from planner_service.composition.furniture_words import pieces_in
from planner_service.composition.whereabouts import is_held
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.captions import captions
from planner_service.scripts.script import PlannedKeyframe
from planner_service.themes.beats import ReadBeat
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar, lemma_of
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from planner_service.themes.verb_finder import is_plural, tokens_of

CARRIED: Final = "carrying with both hands"
"""How who walks carries what takes both hands."""
_LARGE: Final = "box"
"""What that caption holds, and what is as large."""
_MEANT: Final = frozenset(("it", "them", "one"))
_NAMED_AFTER: Final = frozenset(("with", "up", "down", "out", "off", "away", "back", "over"))
"""Words after which a deed still names what it is done to, or with: "picks up a letter"."""
_LISTS: Final = frozenset((",", "and"))
_LAID: Final = frozenset(("put", "set", "lay", "place"))
_FILLED: Final = frozenset(("glass", "drink", "cup"))
"""What is named by what is in it: "a glass of wine"."""
_OWN: Final = frozenset(("his", "her", "their", "my", "reading"))
_BUSY: Final = re.compile(
    r"\b(?:arms?|fists?|clap\w*|wav\w+|danc\w+|throw\w*|kneel\w*|jump\w*|shrug\w*|cheer\w*|stretch\w*|cry\w*|laugh\w*"
    r"|behind|(?:holding|supporting|under) (?:the )?head|face|chin|mouth|toes|ankles|wrist|belly|chest|hips|pockets"
    r"|palms|both hands|phone|piano|prone"
    r"|squat\w*|spin|point\w*|scratch\w*|pray\w*|shouting|punch\w*|kick\w*|skip|run)\b",
    re.IGNORECASE,
)
"""Captions in which the hands are needed, or nothing stays in them."""
_HANDS_IT: Final = re.compile(r"^(?:An act of|touch|pick up|put down|wash|Low touch)\b")
"""Captions of a hand at a thing."""
_STOWED: Final = re.compile(r"\b(?:hands behind back|hands in pockets)\b")
"""Walks that may as well be plain ones, where something is in the hands."""
_LONGEST: Final = 4
"""Keyframes for which what was taken stays in the hands, where nothing more is told of it."""


@dataclass
class _Hands:
    """What is in the hands, as keyframes follow one another."""

    keyframes: list[PlannedKeyframe]
    named: dict[int, str] = field(default_factory=dict)
    """What a keyframe's own words name, by its place."""
    kept: set[int] = field(default_factory=set)
    """Of these, those after which it is in the hands."""
    laid: set[int] = field(default_factory=set)
    """Those that put it down."""
    last: str = ""
    """What was named last, which "it" may be."""

    def name(self, number: int, clause: Clause, nth: int) -> None:
        """Note what a keyframe's clause has in the hands in it: the tool that it is done with, else what it is done to,
        at several places the `nth` there."""
        keyframe = self.keyframes[number]
        told = things_in(clause, keyframe) or [self.last] * bool(_MEANT & set(clause.lemmas[1:3]))
        tool = next((one for one in [*told, keyframe.held] if is_tool(one, keyframe)), "")
        if tool:  # "it" is what it was done to
            self.named.setdefault(number, tool)
            self.last = next((one for one in (*told, mentioned(clause)) if one not in ("", tool)), self.last)
            return
        thing = told[min(nth, len(told) - 1)] if told else ""
        self.last = thing or mentioned(clause) or self.last
        if not thing:
            return
        takes = clause.verb in theme_words()["taking_verbs"] | theme_words()["bringing_verbs"]
        if number in self.named or not _may_hold(keyframe, thing, takes):
            return
        self.named[number] = thing
        puts = clause.verb in theme_words()["putting_verbs"] and clause.lemmas[1:2] != ("on",)  # no coat
        lays = keyframe.skill is Skill.TOUCH and puts
        self.laid |= {number} if lays else set()
        row = held_in(keyframe.skill, keyframe.caption, thing) is not None
        eaten = "eating" in keyframe.caption
        self.kept |= {number} if (takes or row) and not (lays or eaten) else set()

    def hold(self, beat: int, clause: Clause, near: Sequence[int]) -> None:
        """Put what is only told to be held into the hands in what is done meanwhile: "reads, holding a candle"."""
        thing = next(iter(things_in(clause)), "")
        there = [
            number for number, one in enumerate(self.keyframes)
            if one.beat in near and one.skill not in RISINGS and number not in self.named
        ]  # fmt: skip
        if not thing or not there or not all(_may_hold(self.keyframes[number], thing, True) for number in there):
            return
        self.named |= dict.fromkeys(there, thing)
        last = self.keyframes[there[-1]]
        self.keyframes[there[-1]] = last.model_copy(update={"also": (*last.also, beat)})

    def carried(self) -> list[PlannedKeyframe]:
        """The keyframes with what is in the hands in each."""
        held = dict(self.named)
        for number, thing in self.named.items():
            held |= dict.fromkeys(self._led(number, thing) if number in self.laid else (), thing)
            stays = self._goes_on(number) or self._is_used_next(number)
            held |= dict.fromkeys(self._following(number, thing) if stays else (), thing)
        return [
            one.model_copy(update={"held": held[number]}) if number in held else one
            for number, one in enumerate(self.keyframes)
        ]

    def _goes_on(self, number: int) -> bool:
        """Whether a thing is in the hands after a keyframe: it was taken there, or before, and is not put down."""
        before = [one for one in self.named if one <= number and self.named[one] == self.named[number]]
        states = [one in self.kept for one in before if one in self.kept | self.laid]
        return bool(states) and states[-1]

    def _is_used_next(self, number: int) -> bool:
        """Whether what a hand is at is in the hands when it is named next: who "cuts an apple and eats it"."""
        later = next((one for one in sorted(self.named) if one > number), number)
        same = later > number and self.named[later] == self.named[number] and number not in self.laid
        return same and self.keyframes[number].skill is Skill.TOUCH is not self.keyframes[later].skill

    def _following(self, number: int, thing: str) -> Sequence[int]:
        """The keyframes after one in which a thing stays in the hands."""
        later = next((one for one in sorted(self.named) if one > number), None)
        ends = later if later is not None else len(self.keyframes)
        again = later is not None and self.named[later] == thing
        found: list[int] = []
        for one in range(number + 1, ends):
            if not _are_free(self.keyframes[one], thing, again):
                return () if again and later is not None else found
            found.append(one)
        return found if again else found[:_LONGEST]

    def _led(self, number: int, thing: str) -> Sequence[int]:
        """The walk that leads to where a thing is put down."""
        leads = number > 0 and connects(self.keyframes[number - 1]) and number - 1 not in self.named
        return (number - 1,) if leads and _are_free(self.keyframes[number - 1], thing, False) else ()


def is_tool(thing: str, keyframe: PlannedKeyframe) -> bool:
    """Whether a thing is a tool whose work a keyframe's caption shows, where it is in the hand."""
    row = held_in(keyframe.skill, keyframe.caption, thing)
    return row is not None and bool(row.of)


def is_handled(clause: Clause, keyframes: Sequence[PlannedKeyframe]) -> bool:
    """Whether a hand is seen taking the thing that a clause says is taken, or putting it down."""
    taken = clause.verb in theme_words()["taking_verbs"] | _LAID and clause.lemmas[1:2] != ("on",)
    named = things_in(clause)
    return taken and any(one.skill is Skill.TOUCH and one.held in named for one in keyframes)


def as_hands_hold(keyframes: Sequence[PlannedKeyframe]) -> tuple[PlannedKeyframe, ...]:
    """Keyframes with captions that go with what is in the hands: who walks with a tray takes both, and nobody has a
    glass in hands that are behind the back."""
    carried = [_as_carried(one) if one.held and one.skill is Skill.LOCO else one for one in keyframes]
    return tuple(_by_right(number, carried) for number in range(len(carried)))


def _as_carried(keyframe: PlannedKeyframe) -> PlannedKeyframe:
    shape, plain = shown_as(keyframe.held), usual(Skill.LOCO, keyframe.mood)
    large = shape is not None and shape.way == "rim" and _LARGE in (shape.shape, *shape.instead)
    stowed = bool(_STOWED.search(keyframe.caption))
    walks = keyframe.caption == plain or stowed or connects(keyframe)
    if large and walks and keyframe.mood is Emotion.NEUTRAL:
        return keyframe.model_copy(update={"caption": CARRIED})
    return keyframe.model_copy(update={"caption": plain}) if stowed else keyframe


def _by_right(number: int, keyframes: Sequence[PlannedKeyframe]) -> PlannedKeyframe:
    """A reach for what is in the hands before or after is made with the right hand, which drinks and carries."""
    one = keyframes[number]
    beside = [other.held for other in (*keyframes[max(number - 1, 0) : number], *keyframes[number + 1 : number + 2])]
    caption = one.caption.replace("left hand", "right hand")
    passed = one.skill is Skill.TOUCH and bool(one.held) and one.held in beside
    return one.model_copy(update={"caption": caption}) if passed and caption in captions()[one.skill.value] else one


def with_things(read: Sequence[ReadBeat], keyframes: Sequence[PlannedKeyframe]) -> tuple[PlannedKeyframe, ...]:
    """Keyframes with what is in the hands by the words of their beats, and else the tools that they had already."""
    hands = _Hands(list(keyframes))
    told: set[int] = set()
    for number, keyframe in enumerate(keyframes):
        own = [one for one in (keyframe.beat, *keyframe.also) if one is not None]
        latest = max(own, default=-1)
        for beat in [one for one in range(latest) if one not in told and one not in own]:
            hands.last = mentioned(read[beat].clause) or hands.last
            told.add(beat)
        if connects(keyframe) and keyframe.skill is not Skill.LOCO:
            continue
        for beat in own:
            walks_only = connects(keyframe) and _is_done_later(number, beat, keyframes)
            if not walks_only:
                done = [one for one in range(number) if one in hands.named and keyframes[one].beat == beat]
                hands.name(number, read[beat].clause, len(done))
                told.add(beat)
    for beat, one in enumerate(read):
        if is_held(one.clause) and not any(beat in (keyframe.beat, *keyframe.also) for keyframe in keyframes):
            hands.hold(beat, one.clause, [near for near in (beat + 1, beat - 1) if _same_sentence(read, beat, near)])
    return tuple(hands.carried())


def _same_sentence(read: Sequence[ReadBeat], beat: int, near: int) -> bool:
    return 0 <= near < len(read) and read[near].clause.sentence == read[beat].clause.sentence


def _is_done_later(number: int, beat: int, keyframes: Sequence[PlannedKeyframe]) -> bool:
    """Whether a walk only leads to what is done for its beat."""
    return any(beat in (one.beat, *one.also) for one in keyframes[number + 1 :])


def _may_hold(keyframe: PlannedKeyframe, thing: str, takes: bool) -> bool:
    """Whether a thing is seen in a keyframe that its words name: as its caption's own, under a hand, or carried."""
    shape, row = shown_as(thing), held_in(keyframe.skill, keyframe.caption, thing)
    if shape is None:
        return False
    if row is not None:
        named = shown_as(thing, row)
        return named is not None and any(grip.prop in (named.shape, *named.words.split()) for grip in row.props)
    if keyframe.skill is Skill.TOUCH:
        return bool(_HANDS_IT.search(keyframe.caption))
    freed = keyframe.caption == CARRIED or bool(_STOWED.search(keyframe.caption))
    return takes and (freed or _are_free(keyframe, thing, True))


def _are_free(keyframe: PlannedKeyframe, thing: str, reaching: bool) -> bool:
    """Whether a thing may stay in the hands in a keyframe; while `reaching`, one hand may be at something else."""
    if keyframe.skill in RISINGS or keyframe.caption == CARRIED:
        return True
    shape = shown_as(thing)
    hangs = shape is not None and shape.way == "hanging"
    resting = keyframe.skill is Skill.LIEDOWN or (keyframe.skill is Skill.SITDOWN and hangs)
    touching = keyframe.skill is Skill.TOUCH and not (reaching and _HANDS_IT.search(keyframe.caption))
    holds = held_in(keyframe.skill, keyframe.caption, thing) is not None
    return not (resting or touching or holds or _BUSY.search(keyframe.caption))


def things_in(clause: Clause, keyframe: PlannedKeyframe | None = None) -> list[str]:
    """The things with a shape that a clause's deed is done to, or with; of a keyframe that holds something, also what
    else its words name that it may hold: "looks at the photo"."""
    row = held_in(keyframe.skill, keyframe.caption) if keyframe is not None else None
    found, before = [], ""
    for led, words in _phrases(clause):
        before = before if led in _LISTS else led
        thing = _last_thing(words)
        shape = shown_as(thing, row) if thing else None
        fits = row is not None and shape is not None and any(map(shape.is_held_for, row.props))
        if thing and (not before or before in _NAMED_AFTER or fits):
            found.append(thing)
    return found


def mentioned(clause: Clause) -> str:
    """The first thing with a shape that a clause names at all, or ""."""
    return next((thing for _, words in _phrases(clause) if (thing := _last_thing(words))), "")


def _phrases(clause: Clause) -> list[tuple[str, list[str]]]:
    """The words behind a clause's verb, each stretch with the preposition before it; what is in a glass stands for
    it."""
    found: list[tuple[str, list[str]]] = [("", [])]
    sought = clause.verb in ("look", "search", "hunt", "seek", "miss", "need", "want")
    apart = grammar().prepositions | grammar().joints | _NAMED_AFTER | {"to", "while", "until"} | _LISTS
    for token in tokens_of(clause.text)[1:]:
        word = token.low
        if word == "of":
            filled = found[-1][1][-1:] and found[-1][1][-1] in _FILLED
            found += [(found[-1][0], [])] if not filled else []
            found[-1] = (found[-1][0], [] if filled else found[-1][1])
        elif word in apart:
            on = word == "on" and clause.verb in theme_words()["particle_verbs"] and not any(found[0][1])
            found.append(("" if on else word, []))
        else:
            found[-1][1].append(word)
    return [(led or ("for" if sought else ""), words) for led, words in found]


def _last_thing(words: Sequence[str]) -> str:
    """The thing that a phrase is of, by its last noun: of "the wine glass" that, of "the coffee table" none."""
    for place in range(len(words) - 1, -1, -1):
        word, before = words[place], words[place - 1] if place else ""
        thing = word if word in things_named() or not is_plural(word) else lemma_of(word)  # "drunk" is no drink
        if word == "glasses":
            thing = "glasses" if before in _OWN else "glass"
        pair = f"{before} {thing}"
        if before and shown_as(f"{before}-{thing}") is not None:
            return pair
        if thing in things() or shown_as(thing) is not None or pieces_in(" ".join(words[place:])):
            return thing if shown_as(thing) is not None and not pieces_in(" ".join(words[place : place + 2])) else ""
    return ""
