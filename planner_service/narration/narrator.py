"""A long script told as a story: its beats in the theme's own words beside what the keyframes show, and no more.

What no keyframe shows is not told; a deed that something else stands for is told as what that is done for.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from typing import Final

from motion_backend.motion import RISINGS, Character, Skill
from planner_service.narration.beat_clause import WAS, Predicate, event, purpose
from planner_service.narration.keyframe_phrases import RESTS, Phrase, Places, Variety, Wording
from planner_service.narration.narrative_voice import Voice
from planner_service.narration.story_words import story_words, title_of
from planner_service.scripts.script import LongScript, PlannedKeyframe
from planner_service.themes.details import core_of
from planner_service.themes.lexicon import grammar, is_noun, past
from planner_service.themes.protagonist import cast_by
from planner_service.themes.theme_words import theme_words
from planner_service.themes.verb_finder import is_plural
from scene_graphs.furniture import class_of, display_name, is_known

__all__ = ["Places", "Span", "Told", "narrate"]
MAX_SENTENCES = 5
"""Sentences in a paragraph."""
_MAX_PHRASES: Final = 3
_MAX_WORDS: Final = 22
"""Words of a sentence after which no more is added to it."""
_SHORT: Final = 18
"""Words of two beats that may stand in one sentence."""
_TOGETHER: Final = 0.6
"""Share of the short beats that stand in one sentence with the one before."""
_OPENING: Final = 0.4
"""Share of the sentences that open with the way to what is done."""
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
    thoughts: tuple[Span, ...] = ()
    """What is told and no keyframe shows: what something is done for."""

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
    writer = _Writer(voice, variety)
    writer.write(_sentences(_Teller(script, hero, voice, variety, places or {}).phrases(), variety))
    title = title_of(script.theme, script.beats[-1].emotion if script.beats else "neutral")
    return Told(title, writer.text, tuple(writer.spans), tuple(writer.thoughts))


class _Teller:
    """Says what is told of every beat, and in which of its words the keyframes are."""

    def __init__(self, script: LongScript, hero: str, voice: Voice, variety: Variety, places: Places) -> None:
        self.script = script
        self.voice = voice
        self.wording = Wording(voice, variety, places)
        self.hero = hero
        self.told: set[int] = set()
        self.here = ""
        """At which furniture the beat before ended."""

    def phrases(self) -> list[Phrase]:
        """Everything that is told, in order; beats without keyframes of their own stand where the theme has them."""
        runs = _runs(self.script.keyframes)
        own = {beat for beat, _ in runs}
        told: list[Phrase] = []
        for beat, rows in [*runs, (len(self.script.beats), ())]:
            for earlier in range(min(beat or 0, len(self.script.beats))):
                told += self._besides(earlier) if earlier not in own else []
            if rows:
                told += self._shown(beat, rows)
                self.here = self.wording.the(*rows[-1])
        return told

    def _event(self, number: int) -> Predicate | None:
        """A beat that is acted, as it happens; None where it was told, or is somebody else's."""
        beat = self.script.beats[number]
        acted = beat.kind in ("deed", "feeling", "speech") and not (beat.why or beat.who or beat.stood_for)
        if not acted or number in self.told:
            return None
        self.told.add(number)
        return event(beat.model_copy(update={"text": core_of(beat.text, beat.unshown)}), self.hero, self.voice)

    def _besides(self, number: int) -> list[Phrase]:
        """A beat without keyframes of its own: what is felt, or done besides."""
        told = self._event(number)
        return [Phrase(told.text, begins=True)] if told else []

    def _shown(self, number: int | None, rows: Rows) -> list[Phrase]:
        """A beat and its keyframes."""
        phrases = self.wording.phrases(rows)
        if number is not None and number < len(self.script.beats):
            beat = self.script.beats[number]
            if beat.stood_for:
                told = event(beat, self.hero, self.voice)
                same = told is not None and any(_moves(told, phrase) for phrase in phrases)
                phrases = self._standing_in("" if same else purpose(beat, self.hero, self.voice), phrases)
            elif told := self._event(number):
                phrases = self._with_event(told, phrases)
        return [replace(phrases[0], begins=True), *phrases[1:]]

    @staticmethod
    def _standing_in(purpose: str, phrases: list[Phrase]) -> list[Phrase]:
        """What the body does in place of a deed, and that it is for it; a way there needs no hand laid on anything.

        What is danced or walked in place of a deed is for nothing: of that the deed is left out. So is one that a
        phrase names by itself: nobody rises to jump up.
        """
        *before, last = phrases
        if last.skill in (Skill.LOCO, *RISINGS) or not purpose:
            return phrases
        if last.skill is Skill.TOUCH and before and before[-1].leads:
            last = replace(before[-1], keyframes=(*before.pop().keyframes, *last.keyframes), leads=False)
        text = last.text.partition(",")[0]
        if text.split()[0] in map(past, purpose.split()[1:2]):  # "crossed to the desk to cross it out"
            return phrases
        if last.at and last.at in text:
            purpose = re.sub(rf"\b{re.escape(last.at)}\b", "it", purpose)
        return [*before, replace(last, text=text, purpose=purpose, manner="")]

    def _with_event(self, told: Predicate, phrases: list[Phrase]) -> list[Phrase]:
        """What happens and how the body does it; once, where a phrase says the same or was written for it."""
        plain = Phrase(told.text)
        if told.is_state:
            return [plain, *phrases]
        if _names_all(told.text, phrases):
            return [replace(plain, keyframes=tuple(index for phrase in phrases for index in phrase.keyframes))]
        alike = [_likeness(told, phrase) for phrase in phrases]
        if any(alike):
            return self._once(told.text, phrases, alike.index(max(alike)))
        at = next((at for at, phrase in enumerate(phrases) if phrase.deeds & told.verbs), None)
        uses = sum(phrase.skill in (*RESTS, Skill.TOUCH) for phrase in phrases)
        if at is None and (self.script.method == "matching" or uses > 1):
            return [plain, *phrases]
        at = len(phrases) - 1 if at is None else at
        before, last, after = phrases[:at], phrases[at], phrases[at + 1 :]
        if last.skill == Skill.LOCO:
            still = replace(plain, keyframes=last.keyframes, mood=last.mood)
            return [*before, *([still] if last.stays else [plain, last]), *after]
        if last.skill == Skill.TOUCH or last.stays:
            known = last.stays or _PLACE.search(told.text) or (before and before[-1].leads) or last.at == self.here
            text = told.text if known else f"{told.text} at {last.at}"
            return [*before, replace(plain, text=text, keyframes=last.keyframes, mood=last.mood), *after]
        place = re.search(r" (?:on|in)(?:to)? (the .+)$", last.text)
        text = last.text[: place.start()] if place and f" {place[1]}" in told.text else last.text
        return [*before, replace(last, text=text, manner="", leads=True), replace(plain, mood=last.mood), *after]

    def _once(self, text: str, phrases: list[Phrase], at: int) -> list[Phrase]:
        """A deed in place of the phrase that says the same; it says where it is, or the way there does."""
        before, phrase = phrases[:at], phrases[at]
        keyframes = phrase.keyframes
        if before and before[-1].leads and _furniture_in(text, phrase.word):
            keyframes = (*before.pop().keyframes, *keyframes)
        elif phrase.skill in RESTS and not phrase.stays and phrase.at != self.here and not _PLACE.search(text):
            text += _place_of(phrase)
        return [*before, Phrase(text, keyframes, mood=phrase.mood), *phrases[at + 1 :]]


def _likeness(told: Predicate, phrase: Phrase) -> int:
    """How well a deed says what a phrase does: in its verb, in its furniture; 0 where it says something else."""
    if phrase.leads or (phrase.rises and "get" in told.verbs and not re.search(r" up\b| out of bed\b", told.text)):
        return 0
    moves = _moves(told, phrase)
    named = not phrase.rises and bool(_furniture_in(told.text, phrase.word))
    does = not told.verbs.isdisjoint(phrase.deeds)
    return (moves or named) * (1 + 2 * moves + 2 * does)


def _moves(told: Predicate, phrase: Phrase) -> bool:
    """Whether a deed's verb says what a phrase's skill does."""
    return not told.verbs.isdisjoint(story_words().deeds.get(phrase.skill or "", "").split())


def _names_all(text: str, phrases: Sequence[Phrase]) -> bool:
    """Whether a deed names every one of several pieces of furniture: "searched the desk and the shelf"."""
    words = [phrase.word for phrase in phrases if phrase.word and not phrase.leads]
    return len({*words}) > 1 and all(_furniture_in(text, word) for word in words)


def _furniture_in(text: str, word: str) -> str:
    """How a text calls a piece of furniture: by its name, or that of another of its class; empty where it does not."""
    words = re.findall(r"[a-z]+", text.lower())
    names = (word.lower(), display_name(word).lower())
    two = map(" ".join, pairwise(words))
    alike = (one for one in (*two, *words) if one in names or (is_known(one) and class_of(one) == class_of(word)))
    return next(alike, "") if word else ""


def _said_again(phrase: Phrase) -> str:
    """The text of a phrase at a place that has just been told."""
    if re.search(r"\bit\b", phrase.whole):  # which stands for something else
        return re.sub(rf"(?<=down|seat) (?:on|in) {re.escape(phrase.at)}$", "", phrase.text)
    return phrase.text.replace(phrase.at, "it", 1)


def _names_a_thing(text: str) -> bool:
    """Whether "it" may stand for something in a text."""
    small = grammar().prepositions | grammar().adverbs | grammar().marks
    words = (word for word in re.findall(r"[a-z]+", text.lower()) if word not in small and not word.endswith("ing"))
    return any(word == "it" or (is_noun(word) and not is_plural(word)) for word in words)


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


def _sentences(phrases: Sequence[Phrase], variety: Variety) -> list[list[Phrase]]:
    """Up to three phrases a sentence; a walk stays with its purpose, a beat seldom shares one with another."""
    told: list[list[Phrase]] = []
    for phrase in phrases:
        last = told[-1] if told else []
        words = sum(len(one.whole.split()) for one in (*last, phrase))
        joined = any(re.search(r",| and ", one.whole) for one in last) or (last and " and " in phrase.whole)
        full = len(last) == _MAX_PHRASES or words > _MAX_WORDS or joined
        short = len(last) == 1 and words <= _SHORT
        apart = full or (phrase.begins and not (short and variety.chance(_TOGETHER)))
        if last and (last[-1].leads or not apart):
            last.append(phrase)
        else:
            told.append([phrase])
    return told


class _Writer:
    """Writes sentences with their subjects, and notes where they tell of which keyframes."""

    def __init__(self, voice: Voice, variety: Variety) -> None:
        self.voice = voice
        self.variety = variety
        self.text = ""
        self.spans: list[Span] = []
        self.thoughts: list[Span] = []
        self._named = ""  # the furniture that is told last, with no other thing after it

    def write(self, sentences: Sequence[Sequence[Phrase]]) -> None:
        """The text of all sentences in paragraphs as long as each other."""
        count = -(-len(sentences) // MAX_SENTENCES)
        starts = {round(number * len(sentences) / count) for number in range(count)} if count else set()
        own = {*self.voice.name.lower().split()}
        for at, phrases in enumerate(sentences):
            self.text += "" if not at else "\n\n" if at in starts else " "
            before = {*re.findall(r"[a-z]+", self.text.rpartition(". ")[2].lower())} - own
            self._named = "" if at in starts else self._named
            self._sentence(
                [self._again(one) for one in phrases], at in starts or bool(theme_words()["people"] & before)
            )

    def _again(self, phrase: Phrase) -> Phrase:
        """A phrase that calls it "it" at which the one before has the body already, or does not say again where."""
        known = bool(phrase.at) and phrase.at == self._named and phrase.skill is not Skill.LOCO
        again = replace(phrase, text=_said_again(phrase)) if known else phrase
        there = phrase.at if phrase.at and phrase.at in again.text else self._named
        told = again.whole if not phrase.at else again.whole.partition(there)[2] if there else ""
        self._named = "" if _names_a_thing(told) else there
        return again

    def _sentence(self, phrases: Sequence[Phrase], named: bool) -> None:
        start, opening = len(self.text), ""
        first = phrases[0]
        if len(phrases) > 1 and first.gerund and (first.rises or first.leads) and self.variety.chance(_OPENING):
            self._say(first.gerund, first.keyframes)
            opening, phrases = ", ", phrases[1:]
        who = self.voice.name if named else self.voice["they"]
        self._say(f"{opening}{who} ")
        for at, phrase in enumerate(phrases):
            crowded = len(phrases) > 2 or any(re.search(r",| and ", one.whole) for one in phrases[:-1])
            if at:
                link = ", " if crowded or at < len(phrases) - 1 else " "
                self._say(link + "and " * (at == len(phrases) - 1))
            self._say(phrase.whole.replace(WAS, self.voice.was(who)), phrase.keyframes)
            if phrase.purpose:
                self.thoughts.append(Span(len(self.text) - len(phrase.purpose), len(self.text), ()))
        self.text = f"{self.text[:start]}{self.text[start:][:1].upper()}{self.text[start + 1 :]}."

    def _say(self, words: str, keyframes: tuple[int, ...] = ()) -> None:
        if keyframes:
            self.spans.append(Span(len(self.text), len(self.text) + len(words), keyframes))
        self.text += words
