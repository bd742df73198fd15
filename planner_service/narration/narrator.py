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
from planner_service.narration.beat_clause import WAS, Predicate, event, left_undone, of_voice, purpose, thought
from planner_service.narration.keyframe_phrases import RESTS, Phrase, Places, Variety, Wording
from planner_service.narration.narrative_voice import Voice
from planner_service.narration.story_words import story_words, title_of
from planner_service.scripts.emotions import feelings
from planner_service.scripts.script import Beat, LongScript, PlannedKeyframe
from planner_service.themes.details import core_of
from planner_service.themes.protagonist import cast_by, name_in
from scene_graphs.furniture import class_of, display_name, is_known

__all__ = ["Places", "Span", "Told", "narrate"]
MAX_SENTENCES = 5
"""Sentences in a paragraph."""
SENTENCES_A_JOINT = 8
"""At most every such sentence begins by saying that time has passed."""
_MAX_PHRASES: Final = 3
_MAX_WORDS: Final = 22
"""Words of a sentence after which no more is added to it."""
_SHORT: Final = 18
"""Words of two beats that may stand in one sentence."""
_PLACE: Final = re.compile(r"\b(?:on|in|at|by|into|onto|under|beside|near|to|from|around|against|before|behind) \w+")
_NOBODY: Final = frozenset(("they", "he", "she", "somebody", "someone", "everybody", "everyone", "nobody"))
"""Of whom nothing need be said."""
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
    thoughts: tuple[Span, ...] = ()
    """What is told and no keyframe shows: remembered, wished for, left undone, or that others are not to be seen."""

    @property
    def events(self) -> str:
        """The text without its thoughts: what is told as happening."""
        ends = [0, *(span.end for span in self.thoughts)]
        starts = [*(span.start for span in self.thoughts), len(self.text)]
        return "".join(self.text[end:start] for end, start in zip(ends, starts, strict=True))


def narrate(script: LongScript, character: Character, seed: int = 0, places: Places | None = None) -> Told:
    """The story of a script by rules; the same seed tells it in the same words."""
    voice = Voice.of(character)
    variety = Variety(seed, zlib.crc32(script.theme.encode()))
    hero = cast_by(script.theme, Character()).pronouns
    phrases = _Teller(script, hero, voice, variety, places or {}).phrases()
    writer = _Writer(voice, variety, _introduction(script.theme, voice))
    writer.write(_sentences(phrases, variety))
    others = _others(script, hero, voice, variety)
    text = " ".join(filter(None, (writer.text, others)))
    thoughts = (*writer.thoughts, *([Span(len(text) - len(others), len(text), ())] if others else []))
    title = title_of(script.theme, script.beats[-1].emotion if script.beats else "neutral")
    return Told(title, text, tuple(writer.spans), thoughts)


class _Teller:
    """Says what is told of every beat, and in which of its words the keyframes are."""

    def __init__(self, script: LongScript, hero: str, voice: Voice, variety: Variety, places: Places) -> None:
        self.script = script
        self.voice = voice
        self.variety = variety
        self.wording = Wording(voice, variety, places)
        self.hero = hero
        self.told: set[int] = set()
        self.here = ""
        """At which furniture the beat before ended."""

    def phrases(self) -> list[Phrase]:
        """Everything that is told, in order; beats without keyframes stand where the theme has them."""
        runs = _runs(self.script.keyframes)
        shown = {beat for beat, _ in runs}
        told: list[Phrase] = []
        for beat, rows in runs:
            for earlier in range(min(beat or 0, len(self.script.beats))):
                told += self._unshown(earlier) if earlier not in shown else []
            told += self._shown(beat, rows)
            self.here = self.wording.the(*rows[-1])
        for late in range(len(self.script.beats)):
            told += self._unshown(late)
        return told

    def _unshown(self, number: int) -> list[Phrase]:
        """A beat without keyframes of its own: what is felt, done besides, thought, or left undone."""
        beat = self.script.beats[number]
        if number in self.told or beat.who:
            return []
        self.told.add(number)
        if beat.kind == "memory":
            return self._thought(beat)
        if beat.kind == "undone":
            told = left_undone(beat, self.hero, self.voice)
        else:
            shown = beat.model_copy(update={"text": core_of(beat.text, beat.unshown)})
            told = None if beat.why or beat.stood_for or beat.kind == "other" else event(shown, self.hero, self.voice)
        if told is None:
            return []
        thought = beat.kind == "undone"
        return [Phrase(told.text, adjective=told.adjective, begins=True, negated=told.negated, is_thought=thought)]

    def _thought(self, beat: Beat) -> list[Phrase]:
        told = thought(beat, self.hero, self.voice)
        if told and told.split()[0] == self.voice["they"]:
            told = self.voice.fill(self.variety.pick(story_words().thoughts), clause=told)
        return [Phrase(told, begins=True, ends=True, is_thought=True)] if told else []

    def _shown(self, number: int | None, rows: Rows) -> list[Phrase]:
        """A beat and its keyframes."""
        phrases = self.wording.phrases(rows)
        beat = None if number is None or number >= len(self.script.beats) else self.script.beats[number]
        if number is not None and beat and number not in self.told:
            if beat.kind not in ("deed", "feeling", "speech") or beat.why or beat.who:
                return [*self._unshown(number), *_begun(phrases)]
            self.told.add(number)
            if beat.stood_for:
                return _begun(self._standing_in(purpose(beat, self.hero, self.voice), phrases))
            beat = beat.model_copy(update={"text": core_of(beat.text, beat.unshown)})
            if told := event(beat, self.hero, self.voice):
                return _begun(self._with_event(told, phrases))
        return _begun(phrases)

    @staticmethod
    def _standing_in(purpose: str, phrases: list[Phrase]) -> list[Phrase]:
        """What the body does in place of a deed, and that it is for it; a way there needs no hand laid on anything.

        What is danced or walked in place of a deed is for nothing: of that the deed is left out.
        """
        *before, last = phrases
        purpose = "" if last.skill is Skill.LOCO else purpose
        if purpose and last.skill is Skill.TOUCH and before and before[-1].leads:
            last = replace(before[-1], keyframes=(*before.pop().keyframes, *last.keyframes), leads=False)
        manner = "" if purpose else last.manner
        return [*before, replace(last, purpose=purpose, manner=manner, ends=bool(purpose) or last.ends)]

    def _with_event(self, told: Predicate, phrases: list[Phrase]) -> list[Phrase]:
        """What happens and how the body does it; once, where a phrase says the same or was written for it."""
        plain = Phrase(told.text, adjective=told.adjective)
        if told.is_state:
            return [plain, *phrases]
        alike = [_likeness(told, phrase) for phrase in phrases]
        if any(alike):
            return self._once(told.text, phrases, alike.index(max(alike)))
        at = next((at for at, phrase in enumerate(phrases) if phrase.deeds & told.verbs), None)
        whole_scripts = self.script.method == "matching"
        if at is None and (whole_scripts or sum(phrase.skill in (*RESTS, Skill.TOUCH) for phrase in phrases) > 1):
            return [replace(plain, ends=True), *phrases]
        at = len(phrases) - 1 if at is None else at
        before, last, after = phrases[:at], phrases[at], phrases[at + 1 :]
        if last.skill == Skill.LOCO:
            return [*before, plain, last, *after]
        if last.skill == Skill.TOUCH or last.stays:
            known = last.stays or _PLACE.search(told.text) or (before and before[-1].leads) or last.at == self.here
            text = told.text if known else f"{told.text} at {last.at}"
            return [*before, replace(plain, text=text, keyframes=last.keyframes, mood=last.mood), *after]
        place = re.search(r" (?:on|in)(?:to)? (the .+)$", last.text)
        text = last.text[: place.start()] if place and f" {place[1]}" in told.text else last.text
        there = replace(last, text=text, manner="", ends=False, leads=True)
        return [*before, there, replace(plain, mood=last.mood), *after]

    def _once(self, text: str, phrases: list[Phrase], at: int) -> list[Phrase]:
        """A deed in place of the phrase that says the same; of the two, the way there or the deed says where it is."""
        before, phrase = phrases[:at], phrases[at]
        keyframes = phrase.keyframes
        if before and before[-1].leads and (there := _furniture_in(text, phrase.word)):
            at_it = re.search(rf" (on|in|into|onto|from|at) (?:the|an?|his|her|their) (?:\w+ )??{there}\b", text)
            if at_it and self.variety.chance(0.6):
                it = "" if at_it[1] == "at" else f" {at_it[1]} it"
                text = text[: at_it.start()] + it + text[at_it.end() :]
            else:
                keyframes = (*before.pop().keyframes, *keyframes)
        elif phrase.skill in RESTS and not phrase.stays and phrase.at != self.here and not _PLACE.search(text):
            text += _place_of(phrase)
        return [*before, Phrase(text, keyframes, mood=phrase.mood), *phrases[at + 1 :]]


def _likeness(told: Predicate, phrase: Phrase) -> int:
    """How well a deed says what a phrase does: in its verb, in its furniture; 0 where it says something else."""
    if phrase.leads or (phrase.rises and "get" in told.verbs and not re.search(r" up\b| out of bed\b", told.text)):
        return 0
    moves = not told.verbs.isdisjoint(story_words().deeds.get(phrase.skill or "", "").split())
    named = not phrase.rises and bool(_furniture_in(told.text, phrase.word))
    does = not told.verbs.isdisjoint(phrase.deeds)
    return (moves or named) * (1 + 2 * moves + 2 * does)


def _furniture_in(text: str, word: str) -> str:
    """How a text calls a piece of furniture: by its name, or that of another of its class; empty where it does not."""
    words = re.findall(r"[a-z]+", text.lower())
    names = (word.lower(), display_name(word).lower())
    two = map(" ".join, pairwise(words))
    alike = (one for one in (*two, *words) if one in names or (is_known(one) and class_of(one) == class_of(word)))
    return next(alike, "") if word else ""


def _place_of(phrase: Phrase) -> str:
    """Where a phrase has the body rest: " in the armchair"; empty where the way there has said so."""
    found = re.search(rf" (on|in)(?:to)? ({re.escape(phrase.at)})", phrase.text) if phrase.at else None
    return f" {found[1]} {found[2]}" if found else ""


def _runs(keyframes: Sequence[PlannedKeyframe]) -> list[tuple[int | None, Rows]]:
    """Keyframes with the beat they are told with; one of none goes with what follows it, the last with those before."""
    owners: list[int | None] = []
    for keyframe in reversed(keyframes):
        owners.append(keyframe.beat if keyframe.beat is not None or not owners else owners[-1])
    last = next((owner for owner in owners if owner is not None), None)
    known = iter([last if owner is None else owner for owner in reversed(owners)])
    return [(owner, list(run)) for owner, run in groupby(enumerate(keyframes), key=lambda _: next(known))]


def _begun(phrases: Sequence[Phrase]) -> list[Phrase]:
    return [replace(phrase, begins=phrase.begins or at == 0) for at, phrase in enumerate(phrases)]


def _is_state(phrase: Phrase) -> bool:
    return bool(phrase.adjective) or phrase.text.startswith(WAS)


def _sentences(phrases: Sequence[Phrase], variety: Variety) -> list[list[Phrase]]:
    """Up to three phrases a sentence; a walk stays with its purpose, a beat seldom shares one with another."""
    told: list[list[Phrase]] = []
    for phrase in phrases:
        last = told[-1] if told else []
        words = sum(len(one.whole.split()) for one in (*last, phrase))
        doubled = any(" and " in one.text for one in (*last, phrase))
        most = 2 if doubled or any(one.negated or _is_state(one) for one in last) else _MAX_PHRASES
        room = last and len(last) < most and words <= _MAX_WORDS and not last[-1].ends
        gainsaid = any(one.negated for one in last) and not phrase.keyframes
        begins = _is_state(phrase) or (
            phrase.begins and not (len(last) == 1 and words <= _SHORT and variety.chance(0.6))
        )
        if last and (last[-1].leads or (room and not begins and not gainsaid)):
            last.append(phrase)
        else:
            told.append([phrase])
    return told


class _Writer:
    """Writes sentences with their subjects, and notes where they tell of which keyframes."""

    def __init__(self, voice: Voice, variety: Variety, introduction: str) -> None:
        self.voice = voice
        self.variety = variety
        self.first = introduction
        self.text = ""
        self.spans: list[Span] = []
        self.thoughts: list[Span] = []

    def write(self, sentences: Sequence[Sequence[Phrase]]) -> None:
        """The text of all sentences in paragraphs as long as each other."""
        count = -(-len(sentences) // MAX_SENTENCES)
        starts = {round(number * len(sentences) / count) for number in range(count)} if count else set()
        joint, people = 0, story_words().lists["people"]
        for at, phrases in enumerate(sentences):
            self.text += "" if not at else "\n\n" if at in starts else " "
            before = {*re.findall(r"[a-z]+", self.text.rpartition(". ")[2].lower())} - {self.voice["they"]}
            named = at in starts or bool(people & before)
            late = at + 1 - joint >= SENTENCES_A_JOINT and phrases[0].begins and at not in starts
            joint = at + 1 if late else joint
            self._sentence(phrases, named, self.variety.pick(story_words().joints) if late else "")

    def _sentence(self, phrases: Sequence[Phrase], named: bool, opening: str) -> None:
        start = len(self.text)
        first = phrases[0]
        if len(phrases) > 1 and not opening and not self.first:
            if first.adjective and self.variety.chance(0.6):
                opening, phrases = f"{first.adjective},", phrases[1:]
            elif first.gerund and (first.rises or first.leads) and self.variety.chance(0.4):
                self._say(first.gerund, first.keyframes)
                opening, phrases = ",", phrases[1:]
        moods = story_words().moods.get(first.mood, ())
        says_so = any(feelings(phrase.whole) for phrase in phrases)
        fresh = [] if says_so else [words for words in moods if not self.variety.used[words]]
        if not opening and not self.first and first.keyframes and fresh and self.variety.chance(0.25):
            opening = f"{self.variety.pick(fresh)},"
        who = self.voice.name if named else self.voice["they"]
        was = "were" if who == "they" else "was"
        self._say(f"{opening} {who}{self.first} ".lstrip())
        self.first = ""
        for at, phrase in enumerate(phrases):
            crowded = len(phrases) > 2 or any(re.search(r",| and ", one.whole) for one in phrases[:-1])
            if at:
                link = "but" if phrases[0].negated else "and"
                self._say(f", {link} " if crowded else f" {link} ") if at == len(phrases) - 1 else self._say(", ")
            told = len(self.text)
            self._say(phrase.whole.replace(WAS, was), phrase.keyframes)
            if phrase.is_thought or phrase.purpose:
                only = len(self.text) - len(phrase.purpose) if phrase.purpose else told
                self.thoughts.append(Span(only, len(self.text), ()))
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


def _others(script: LongScript, hero: str, voice: Voice, variety: Variety) -> str:
    """A sentence about the people whose deeds the theme has and nobody shows."""
    known = story_words().lists["people"] - _NOBODY
    theirs = [beat.who for beat in script.beats if beat.who != voice.name]
    who = [re.sub(r"^(?:The|An?|His|Her|Their|My) ", lambda one: one[0].lower(), one) for one in theirs]
    people = [one for one in who if known & {*one.lower().split()} or name_in(f"{one} sits")]
    *most, last = list(dict.fromkeys(people))[:3] or [""]
    others = of_voice(" and ".join(filter(None, (", ".join(most), last))), hero, voice)
    return voice.fill(variety.pick(story_words().others), others=others) if others else ""
