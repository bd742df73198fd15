"""A long script told as a story: prose that follows the keyframes in order and knows which words tell which."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import BaseModel, Field

import prompts
from motion_backend.motion import Character, Skill
from planner_service.llm.asking import ask
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts import framing, phrases
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.keyframe import Event, LongScript, PlannedKeyframe
from planner_service.scripts.moments import Phrase, Piece, Places, Variety, Wording, joined, mood_of, sentences_of
from planner_service.scripts.scenes import Scene, covered, event_retold, scenes_of
from planner_service.scripts.voice import Voice, retell

_MANY = 22
"""Keyframes above which a story leaves out what says little."""


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


def narrate(script: LongScript, character: Character, seed: int = 0, places: Places | None = None) -> Told:
    """The story of a script by rules; the same seed tells it in the same words."""
    return _Narrator(script, Voice.of(character), seed, places or {}).tell()


def narrate_with_model(
    script: LongScript, character: Character, model: LanguageModel, places: Places | None = None
) -> Told:
    """The story of a script by a language model. Raises ModelAnswerError when it gives none that can be used."""
    voice = Voice.of(character)
    moments = [(k.skill, k.emotion, k.caption, _called(i, k, places or {})) for i, k in enumerate(script.keyframes)]
    prompt = prompts.read("narrate_story").fill(
        name=voice.name,
        pronouns=voice.pronouns,
        theme=script.theme,
        events="\n".join(f"- {script.events[r.event].text}: {r.script.summary}" for r in script.short_scripts),
        keyframes="\n".join("- " + ", ".join(moment) for moment in moments),
    )
    answer = ask(model, prompt, _ModelStory)
    return Told(answer.title.strip(), answer.text.strip(), _found_spans(answer.text.strip(), [m[3] for m in moments]))


class _ModelStory(BaseModel):
    title: str = Field(min_length=1, max_length=120)
    text: str = Field(min_length=80, max_length=8000)


class _Narrator:
    """Writes the paragraphs of one story from its opening to its closing sentence."""

    def __init__(self, script: LongScript, voice: Voice, seed: int, places: Places) -> None:
        self.script = script
        self.voice = voice
        self.variety = Variety(seed)
        self.wording = Wording(voice, self.variety, places, brief=len(script.keyframes) > _MANY)
        self.text = ""
        self.spans: list[Span] = []
        self.moods: set[str] = set()
        self.rooms: list[str] = []
        self.gerunds = False
        self.arrival = ""
        """Words for a room that is new, until a sentence has used them."""
        self.bare = 0
        """Sentences in a row that begin with their subject."""

    def tell(self) -> Told:
        """The whole story."""
        events = self.script.events
        first, last = (events[0], events[-1]) if events else (Event(text=self.script.theme),) * 2
        self._add(self._framed(framing.OPENINGS[emotion_of(first.emotion) or "neutral"], first.text))
        next_event = 0
        for number, scene in enumerate(scenes_of(self.script)):
            if number:
                self.text += "\n\n"
            reached = next_event if scene.event is None else max(next_event, scene.event + 1)
            self._tell_scene(scene, number, [event.text for event in events[next_event:reached]])
            next_event = reached
        for event in events[next_event:]:
            if told := event_retold(event.text, self.voice):
                self._add(self._turned(told))
        self._add(self._framed(self._closings(), last.text))
        title = framing.title_of(self.script.theme, emotion_of(last.emotion) or "neutral")
        return Told(title, self.text, tuple(self.spans))

    def _tell_scene(self, scene: Scene, number: int, events: Sequence[str]) -> None:
        """One paragraph: what happens (the lead) and what the body does, in the order that reads best."""
        named = not number and self.voice.name in self.text
        lead = self._lead(scene, events, number > 0, named)
        self._enter(scene, lead)
        sentences = sentences_of(self.wording.phrases(scene.keyframes))
        before = _told_before(scene, lead, sentences, number)
        if before:
            lead = self._lead(scene, events, turn=False, named=True)
        for position, sentence in enumerate(sentences[:before]):
            self._add_sentence(sentence, name=position == 0 and not named, plain=position == 0)
        for told in lead:
            self._add(told)
        for position, sentence in enumerate(sentences[before:]):
            name = position == 2 or (position == 0 and not lead and not named)
            self._add_sentence(sentence, name=name, plain=position == 0, last=position == len(sentences) - before - 1)

    def _enter(self, scene: Scene, lead: Sequence[str]) -> None:
        """Choose words for the room if it is new and the lead does not name it."""
        room = self.wording.room_of(*scene.keyframes[0])
        said = any(room in told for told in lead)
        self.arrival, self.gerunds = "", False
        if room != "room" and room not in self.rooms[-1:] and not said:
            options = framing.ROOMS if room in self.rooms else framing.NEW_ROOMS if self.rooms else framing.FIRST_ROOM
            self.arrival = self.variety.pick(options).format(room=room)
        self.wording.say_room = not said and not self.arrival
        self.rooms.append(room)

    def _lead(self, scene: Scene, events: Sequence[str], turn: bool, named: bool) -> list[str]:
        """The theme's own words where the summary does not cover them, then the summary."""
        summary = "" if scene.script is None else self.script.short_scripts[scene.script].script.summary
        lead: list[str] = []
        for event in events:
            told = event_retold(event, self.voice, named) if covered(event, summary) < 0.5 else None
            if told:
                lead.append(self._turned(told) if turn else told)
                named = turn = True
        told = retell(summary, self.voice, named) if summary else None
        return [*lead, *([told] if told else [])]

    def _turned(self, told: str) -> str:
        """A sentence after "then" or "later"."""
        inner = told if told.startswith(self.voice.name) else told[:1].lower() + told[1:]
        return f"{self.variety.pick(framing.TURNS)} {inner}"

    def _add_sentence(self, sentence: Sequence[Phrase], name: bool, plain: bool, last: bool = False) -> None:
        subject = self.voice.name if name else self.voice["they"]
        if len(sentence) == 1 and sentence[0].rises and not plain:
            before, after = self.variety.pick(framing.RISINGS).replace("{they}", subject).split("{rose}")
            pieces = [(self.voice.fill(before), ()), (sentence[0].text, sentence[0].keyframes), (after, ())]
        else:
            pieces = [*self._begun(sentence, subject, plain, last), (".", ())]
        if self.text and not self.text.endswith("\n"):
            self.text += " "
        for position, (words, keyframes) in enumerate(pieces):
            words = words[:1].upper() + words[1:] if position == 0 else words
            if keyframes:
                self.spans.append(Span(len(self.text), len(self.text) + len(words), keyframes))
            self.text += words

    def _begun(self, sentence: Sequence[Phrase], subject: str, plain: bool, last: bool) -> list[Piece]:
        """The sentence with what stands before its subject: a room, a mood, an earlier act, a connective or nothing."""
        mood = next((phrase.mood for phrase in sentence if not phrase.rises), "neutral")
        if self.arrival and not sentence[0].rises:
            opening, self.arrival = self.arrival, ""
        elif mood in phrases.MOODS and mood not in self.moods and not sentence[0].rises and self.variety.chance(0.6):
            self.moods.add(mood)
            opening = self.variety.pick(phrases.MOODS[mood]) + ","
        elif self._may_follow_on(sentence, plain):
            self.gerunds = True
            first = (sentence[0].gerund, sentence[0].keyframes)
            return [("after ", ()), first, (f", {subject} ", ()), *joined(sentence[1:])]
        elif plain or (not self.bare and self.variety.chance(0.3)):
            self.bare = 1
            return [(f"{subject} ", ()), *joined(sentence)]
        else:
            options = framing.LAST_CONNECTIVES if last and self.variety.chance(0.4) else framing.CONNECTIVES
            opening = self.variety.pick([word for word in options if word != "from there" or not sentence[0].rises])
        self.bare = 0
        return [(f"{opening} {subject} ", ()), *joined(sentence)]

    def _may_follow_on(self, sentence: Sequence[Phrase], plain: bool) -> bool:
        """Whether to begin with "after crossing to the shelf": once a paragraph at most."""
        fits = len(sentence) > 1 and not plain and "," not in sentence[0].text and " and " not in sentence[0].text
        return fits and not self.gerunds and self.variety.chance(0.3)

    def _closings(self) -> tuple[str, ...]:
        if not self.script.keyframes:
            return framing.CLOSINGS["neutral"]
        last = self.script.keyframes[-1]
        mood = mood_of(last)
        asleep = re.search(r"sleep|awake", self.text.rpartition("\n\n")[2])
        lying = framing.LYING_CLOSINGS.get(mood) if last.skill == Skill.LIEDOWN and not asleep else None
        return lying or framing.CLOSINGS[mood]

    def _framed(self, templates: tuple[str, ...], event: str) -> str:
        they, their = self.voice["they"].capitalize(), self.voice["their"].capitalize()
        template = self.variety.pick(templates)
        told = self.voice.fill(template, time=framing.time_of(event), They=they, Their=their)
        return re.sub(r"\ba (?=[aeiou])", "an ", told)

    def _add(self, sentence: str) -> None:
        self.text += (" " if self.text and not self.text.endswith("\n") else "") + sentence


def _told_before(scene: Scene, lead: Sequence[str], sentences: Sequence[Sequence[Phrase]], number: int) -> int:
    """How many sentences about the body come before what happens: all when it ends asleep, at times the first walk."""
    if lead and sentences and scene.ends_asleep(" ".join(lead)):
        left = sentences[-1][0].rises and len(sentences) > 1  # what comes after the sleep
        return len(sentences) - left
    wanders = scene.keyframes[0][1].on_floor and len(sentences) > 1 and not sentences[0][0].rises
    return int(bool(lead) and number % 2 == 1 and wanders)


def _called(index: int, keyframe: PlannedKeyframe, places: Places) -> str:
    return places[index][0] if index in places else keyframe.furniture


def _found_spans(text: str, furniture: Sequence[str]) -> tuple[Span, ...]:
    """Sentences tied to keyframes in order: each goes to the next sentence that names its furniture, or stays."""
    bounds = [(m.start(), m.end()) for m in re.finditer(r"\S[^.!?]*[.!?]+[\"”’']*|\S[^.!?]*$", text)]
    at, owners = 0, []
    for word in furniture:
        named = [i for i in range(at, len(bounds)) if word.lower() in text[slice(*bounds[i])].lower()]
        at = named[0] if named and word.lower() != "floor" else at
        owners.append(at)
    return tuple(
        Span(*bounds[at], tuple(i for i, owner in enumerate(owners) if owner == at)) for at in sorted(set(owners))
    )
