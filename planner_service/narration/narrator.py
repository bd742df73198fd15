"""A long script told as a story: its beats in the theme's own words beside what the keyframes show, and no more.

What no keyframe shows is told as a thought, as left undone, or not at all.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from typing import Final

from motion_backend.motion import Character, Skill
from planner_service.narration.beat_clause import WAS, Predicate, event, left_undone, thought
from planner_service.narration.keyframe_phrases import RESTS, RISES, Phrase, Places, Variety, Wording
from planner_service.narration.narrative_voice import Voice
from planner_service.narration.story_words import story_words, title_of
from planner_service.scripts.script import Beat, LongScript, PlannedKeyframe
from planner_service.themes.protagonist import cast_by
from scene_graphs.furniture import class_of, display_name, is_known

__all__ = ["Places", "Span", "Told", "narrate"]
MAX_SENTENCES = 5
"""Sentences in a paragraph."""
SENTENCES_A_JOINT = 8
"""At most every such sentence begins by saying that time has passed."""
_MAX_MOVES: Final = 3
_MAX_WORDS: Final = 22
"""Words of a sentence after which no more is added to it."""
_SHORT: Final = 9
"""Words of two beats that may stand in one sentence."""
_PLACE: Final = re.compile(r"\b(?:on|in|at|by|into|onto|under|beside|near|to|from|around|against|before|behind) \w+")
Rows = Sequence[tuple[int, PlannedKeyframe]]


@dataclass(frozen=True)
class Span:
    """A stretch of a told text, end exclusive, and the keyframes it tells."""

    start: int
    end: int
    keyframes: tuple[int, ...]


@dataclass(frozen=True)
class Told:
    """A story as text: paragraphs parted by empty lines, spans in order and not overlapping."""

    title: str
    text: str
    spans: tuple[Span, ...]


@dataclass(frozen=True)
class _Move:
    """Something told of the story's person, without its subject."""

    text: str
    keyframes: tuple[int, ...] = ()
    gerund: str = ""
    """The same before another one, "crossing to the sofa"; empty where that would not do."""
    adjective: str = ""
    mood: str = "neutral"
    begins: bool = False
    """Whether a beat begins with it."""
    leads: bool = False
    """Whether the next one is what it is done for."""
    ends: bool = False
    """Whether a sentence ends with it."""
    negated: bool = False

    @property
    def words(self) -> int:
        """How long it is."""
        return len(self.text.split())


def narrate(script: LongScript, character: Character, seed: int = 0, places: Places | None = None) -> Told:
    """The story of a script by rules; the same seed tells it in the same words."""
    voice = Voice.of(character)
    variety = Variety(seed, zlib.crc32(script.theme.encode()))
    moves = _Teller(script, voice, variety, places or {}).moves()
    text, spans = _Writer(voice, variety, _introduction(script.theme, voice)).write(_sentences(moves, variety))
    others = _others(script, voice, variety)
    text = " ".join(filter(None, (text, others)))
    return Told(title_of(script.theme, script.beats[-1].emotion if script.beats else "neutral"), text, spans)


class _Teller:
    """Says what is told of every beat, and in which of its words the keyframes are."""

    def __init__(self, script: LongScript, voice: Voice, variety: Variety, places: Places) -> None:
        self.script = script
        self.voice = voice
        self.variety = variety
        self.wording = Wording(voice, variety, places)
        self.hero = cast_by(script.theme, Character()).pronouns
        self.told: set[int] = set()

    def moves(self) -> list[_Move]:
        """Everything that is told, in order; beats without keyframes stand where the theme has them."""
        runs = _runs(self.script.keyframes)
        shown = {beat for beat, _ in runs}
        moves: list[_Move] = []
        for beat, rows in runs:
            for earlier in range(min(beat or 0, len(self.script.beats))):
                moves += self._unshown(earlier) if earlier not in shown else []
            moves += self._shown(beat, rows)
        for late in range(len(self.script.beats)):
            moves += self._unshown(late)
        return moves

    def _unshown(self, number: int) -> list[_Move]:
        """A beat without keyframes: its feeling, what is thought, what is not done."""
        beat = self.script.beats[number]
        if number in self.told or beat.who:
            return []
        self.told.add(number)
        if beat.kind == "memory":
            return [_Move(text, begins=True, ends=True) for text in self._thought(beat)]
        if beat.kind == "undone":
            told = left_undone(beat, self.hero, self.voice)
        else:
            told = None if beat.why or beat.kind == "other" else event(beat, self.hero, self.voice)
        return [_Move(told.text, adjective=told.adjective, begins=True, negated=told.negated)] if told else []

    def _thought(self, beat: Beat) -> list[str]:
        told = thought(beat, self.hero, self.voice)
        if told and told.split()[0] == self.voice["they"]:
            told = self.voice.fill(self.variety.pick(story_words().thoughts), clause=told)
        return [told] if told else []

    def _shown(self, number: int | None, rows: Rows) -> list[_Move]:
        """A beat and its keyframes."""
        phrases = self.wording.phrases(rows)
        if number is None or number >= len(self.script.beats) or number in self.told:
            return _begun([_move(phrase) for phrase in phrases])
        beat = self.script.beats[number]
        if beat.kind not in ("deed", "feeling", "speech") or beat.why or beat.who:
            return [*self._unshown(number), *_begun([_move(phrase) for phrase in phrases])]
        self.told.add(number)
        told = event(beat, self.hero, self.voice)
        if told is None:
            return _begun([_move(phrase) for phrase in phrases])
        if beat.kind == "feeling":
            return [_Move(told.text, adjective=told.adjective, begins=True), *(_move(phrase) for phrase in phrases)]
        return _begun(self._with_deed(told, phrases, all(row.short_script is None for _, row in rows)))

    def _with_deed(self, told: Predicate, phrases: list[Phrase], written: bool) -> list[_Move]:
        """A deed and how the body does it; once, where a phrase says the same or was written for it."""
        at = next((at for at in reversed(range(len(phrases))) if _same(told, phrases[at])), None)
        if at is not None:
            return self._once(told, phrases, at)
        doing = next((at for at, phrase in enumerate(phrases) if phrase.deeds & told.verbs), None)
        acts = [phrase for phrase in phrases if phrase.skill in (*RESTS, Skill.TOUCH)]
        if doing is None and (not written or len(acts) > 1):
            return [_Move(told.text, ends=True), *(_move(phrase) for phrase in phrases)]
        at = len(phrases) - 1 if doing is None else doing
        before, last, after = phrases[:at], phrases[at], [_move(phrase) for phrase in phrases[at + 1 :]]
        if last.skill != Skill.TOUCH:
            told_there = _Move(told.text, mood=last.mood)
            return [*(_move(one) for one in before), _move(last, manner=False), told_there, *after]
        place = "" if (before and before[-1].leads) or _PLACE.search(told.text) else f" at {last.the}"
        return [*(_move(one) for one in before), _Move(told.text + place, last.keyframes, mood=last.mood), *after]

    def _once(self, told: Predicate, phrases: list[Phrase], at: int) -> list[_Move]:
        """A deed in place of the phrase that says the same; of the way there at most one of them tells where it is."""
        before, phrase, text = phrases[:at], phrases[at], told.text
        keyframes = phrase.keyframes
        if before and before[-1].leads and (there := _furniture_in(text, phrase.word)):
            at_it = re.search(rf" (on|in|into|onto|from|at) (?:the|an?|his|her|their) (?:\w+ )??{there}\b", text)
            if at_it and self.variety.chance(0.6):
                it = "" if at_it[1] == "at" else f" {at_it[1]} it"
                text = text[: at_it.start()] + it + text[at_it.end() :]
            else:
                keyframes = (*before.pop().keyframes, *keyframes)
        text += "" if _PLACE.search(text) or phrase.skill not in RESTS else _at(phrase)
        same = _Move(text, keyframes, mood=phrase.mood)
        return [*(_move(one) for one in before), same, *(_move(one) for one in phrases[at + 1 :])]


def _same(told: Predicate, phrase: Phrase) -> bool:
    """Whether a deed says what a phrase does."""
    if phrase.leads:
        return False
    if phrase.skill in RISES and "get" in told.verbs and not re.search(r" up\b| out of bed\b", told.text):
        return False
    named = phrase.skill not in RISES and _furniture_in(told.text, phrase.word)
    return bool(named or told.verbs & frozenset(story_words().deeds.get(phrase.skill, "").split()))


def _furniture_in(text: str, word: str) -> str:
    """How a text calls a piece of furniture: by its name, or that of another of its class; empty where it does not."""
    words = re.findall(r"[a-z]+", text.lower())
    two = [" ".join(pair) for pair in pairwise(words)]
    names = (word.lower(), display_name(word).lower())
    alike = (one for one in (*two, *words) if one in names or (is_known(one) and class_of(one) == class_of(word)))
    return next(alike, "") if word else ""


def _runs(keyframes: Sequence[PlannedKeyframe]) -> list[tuple[int | None, Rows]]:
    """Keyframes with the beat they are told with; one of none goes with what follows it, the last with those before."""
    owners = [keyframe.beat for keyframe in keyframes]
    for order in (reversed(range(len(owners) - 1)), range(1, len(owners))):
        for at in order:
            near = (
                at + 1 if owners[at] is None and owners[at + 1 : at + 2] != [None] and at + 1 < len(owners) else at - 1
            )
            if owners[at] is None and near >= 0:
                owners[at] = owners[near]
    rows = groupby(enumerate(keyframes), key=lambda row: owners[row[0]])
    return [(owner, list(run)) for owner, run in rows]


def _move(phrase: Phrase, manner: bool = True) -> _Move:
    gerund = phrase.gerund if phrase.skill in (Skill.LOCO, *RISES) else ""
    text = phrase.text(manner)
    rises = phrase.skill in RISES
    return _Move(text, phrase.keyframes, gerund, "", phrase.mood, rises, phrase.leads, ends="," in text)


def _begun(moves: list[_Move]) -> list[_Move]:
    return [replace(move, begins=move.begins or at == 0) for at, move in enumerate(moves)]


def _at(phrase: Phrase) -> str:
    found = re.search(r" (?:on|in|onto|into) (the .+)$", phrase.base)
    return "" if not found else f" {'in' if re.search(rf' in(?:to)? {found[1]}', phrase.base) else 'on'} {found[1]}"


def _sentences(moves: Sequence[_Move], variety: Variety) -> list[list[_Move]]:
    """Up to three moves a sentence; a walk stays with its purpose, a beat seldom shares one with another."""
    told: list[list[_Move]] = []
    for move in moves:
        last = told[-1] if told else []
        words = sum(one.words for one in last) + move.words
        together = len(last) == 1 and words <= 2 * _SHORT and variety.chance(0.5)
        most = 2 if any(one.negated for one in (*last, move)) else _MAX_MOVES
        room = last and len(last) < most and words <= _MAX_WORDS and not last[-1].ends
        crowded = any(" and " in one.text for one in (*last, move)) and len(last) > 1
        fits = room and not crowded and (together if move.begins else not last[0].adjective or len(last) < 2)
        if last and (last[-1].leads or fits):
            last.append(move)
        else:
            told.append([move])
    return told


class _Writer:
    """Writes sentences with their subjects, and notes where they tell of which keyframes."""

    def __init__(self, voice: Voice, variety: Variety, introduction: str) -> None:
        self.voice = voice
        self.variety = variety
        self.first = introduction
        self.text = ""
        self.spans: list[Span] = []

    def write(self, sentences: Sequence[Sequence[_Move]]) -> tuple[str, tuple[Span, ...]]:
        """The text of all sentences in paragraphs as long as each other."""
        count = -(-len(sentences) // MAX_SENTENCES)
        starts = {round(number * len(sentences) / count) for number in range(count)} if count else set()
        joint, people = 0, story_words().lists["people"]
        for at, moves in enumerate(sentences):
            self.text += "" if not at else "\n\n" if at in starts else " "
            before = {*re.findall(r"[a-z]+", self.text.rpartition(". ")[2].lower())} - {self.voice["they"]}
            named = at in starts or bool(people & before)
            late = at + 1 - joint >= SENTENCES_A_JOINT and moves[0].begins and at not in starts
            joint = at + 1 if late else joint
            self._sentence(moves, named, self.variety.pick(story_words().joints) if late else "")
        return self.text, tuple(self.spans)

    def _sentence(self, moves: Sequence[_Move], named: bool, opening: str) -> None:
        start = len(self.text)
        first = moves[0]
        if len(moves) > 1 and not opening and not self.first:
            if first.adjective and self.variety.chance(0.6):
                opening, moves = f"{first.adjective},", moves[1:]
            elif first.gerund and self.variety.chance(0.4):
                self._say(first.gerund, first.keyframes)
                opening, moves = ",", moves[1:]
        moods = story_words().moods.get(first.mood, ())
        fresh = [words for words in moods if not self.variety.used[words]]
        if not opening and not self.first and first.keyframes and fresh and self.variety.chance(0.25):
            opening = f"{self.variety.pick(fresh)},"
        who = self.voice.name if named else self.voice["they"]
        was = "were" if who == "they" else "was"
        self._say(f"{opening} {who}{self.first} ".lstrip())
        self.first = ""
        for at, move in enumerate(moves):
            crowded = len(moves) > 2 or any(re.search(r",| and ", one.text) for one in moves[:-1])
            if at:
                link = "but" if moves[0].negated else "and"
                self._say(f", {link} " if crowded else f" {link} ") if at == len(moves) - 1 else self._say(", ")
            self._say(move.text.replace(WAS, was), move.keyframes)
        self.text = f"{self.text[:start]}{self.text[start:][:1].upper()}{self.text[start + 1 :]}."

    def _say(self, words: str, keyframes: tuple[int, ...] = ()) -> None:
        if keyframes:
            self.spans.append(Span(len(self.text), len(self.text) + len(words), keyframes))
        self.text += words


def _introduction(theme: str, voice: Voice) -> str:
    """Who the person is, as the theme has it where it gives no name: ", an old widower,"."""
    known = story_words().lists
    words = theme.lower().split()[:4]
    at = next((at for at, word in enumerate(words) if word in known["people"]), 0)
    if not at or words[0] not in ("a", "an") or voice.name in theme or (words[at] in known["plain_people"] and at < 2):
        return ""
    return f", {' '.join(words[: at + 1])},"


def _others(script: LongScript, voice: Voice, variety: Variety) -> str:
    """A sentence about the people whose deeds the theme has and nobody shows."""
    people = story_words().lists["people"] - {"they", "he", "she"}
    who = [
        re.sub(r"^(?:The|An?|His|Her|Their) ", lambda one: one[0].lower(), beat.who)
        for beat in script.beats
        if beat.who.istitle() or people & {*beat.who.lower().split()}
    ]
    *most, last = list(dict.fromkeys(who))[:3] or [""]
    others = " and ".join(filter(None, (", ".join(most), last)))
    return voice.fill(variety.pick(story_words().others), others=others) if others else ""
