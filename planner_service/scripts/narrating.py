"""A long script told as a story: prose that follows the keyframes in order and knows which words tell which."""

from __future__ import annotations

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

from motion_backend.motion import Character, Skill
from planner_service.scripts import framing, reasons
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.frames import Ear, Manner, Sentence, framed, said
from planner_service.scripts.keyframe import Event, LongScript
from planner_service.scripts.moments import Phrase, Places, Variety, Wording, mood_of, sentences_of
from planner_service.scripts.paragraphs import Span, balanced, laid_out
from planner_service.scripts.scenes import RESTS, Scene, covered, event_retold, link_before, scenes_of, told_of_hero
from planner_service.scripts.voice import Voice, retell

__all__ = ["Places", "Span", "Told", "narrate"]
_LINKED = 0.3
"""Share of an event's words in a summary that may take the event's "so" or "but"."""
_MANY = 22
"""Keyframes above which a story leaves out what says little."""


@dataclass(frozen=True)
class Told:
    """A story as text: paragraphs parted by empty lines, spans in order and not overlapping."""

    title: str
    text: str
    spans: tuple[Span, ...]


def narrate(script: LongScript, character: Character, seed: int = 0, places: Places | None = None) -> Told:
    """The story of a script by rules; the same seed tells it in the same words."""
    return _Narrator(script, Voice.of(character), seed, places or {}).tell()


class _Narrator:
    """Writes one story from its opening to its closing sentence."""

    def __init__(self, script: LongScript, voice: Voice, seed: int, places: Places) -> None:
        self.script = script
        self.voice = voice
        self.variety = Variety(seed, zlib.crc32(script.theme.encode()))
        self.ear = Ear(self.variety)
        self.wording = Wording(voice, self.variety, places, brief=len(script.keyframes) > _MANY)
        events = script.events
        self.first, self.last = (events[0], events[-1]) if events else (Event(text=script.theme),) * 2
        self.time = framing.time_of(self.first.text, *(r.script.summary for r in script.short_scripts[:1]))
        self.rooms: list[str] = []
        self.arrival = ""
        """The room that the next sentence about the body names."""
        self.visits = -1
        """How often the story was in this room before; -1 in its first."""
        self.mood = ""
        """The mood of the scene before."""
        self.passed_over: tuple[int, ...] = ()
        """Keyframes that go without saying, to be told with what follows."""
        self.scene: list[Sentence] = []

    def tell(self) -> Told:
        """The whole story."""
        events = self.script.events
        scenes = scenes_of(self.script)
        told: list[list[Sentence]] = []
        next_event = 0
        opening = self._framed(framing.OPENINGS[emotion_of(self.first.emotion) or "neutral"])
        for number, scene in enumerate(scenes):
            self.scene = [] if number else [self.ear.choose(opening)]
            reached = next_event if scene.event is None else max(next_event, scene.event + 1)
            self._tell_scene(scene, range(next_event, reached), final=number == len(scenes) - 1)
            next_event = reached
            told.append(self.scene)
        self.scene = [] if scenes else [self.ear.choose(opening)]
        for event in range(next_event, len(events)):
            text = told_of_hero(events[event].text, self.script.theme)
            if sentence := event_retold(text, self.voice, self._named()):
                self._say(sentence, link_before(self.script.theme, events[event].text))
        self.scene.append(self.ear.choose(self._framed(self._closings([*told[-1:], self.scene]))))
        if told and len(self.scene) == 1:
            self.scene = told.pop() + self.scene
        text, spans = laid_out(balanced([*told, self.scene]))
        title = framing.title_of(self.script.theme, emotion_of(self.last.emotion) or "neutral", self.time)
        return Told(title, text, spans)

    def _tell_scene(self, scene: Scene, events: Sequence[int], final: bool) -> None:
        """What happens (the lead) and what the body does; sleep comes after what leads to it."""
        self._turn_to(scene)
        happens = self._events(scene, events)
        summary = self._summary(scene)
        asleep = scene.sleeps(" ".join([*happens, retell(summary, self.voice) or ""]))
        if not asleep:
            self._lead(happens, summary, events)
        self._enter(scene)
        sentences = self._sentences(scene, asleep, final)
        resting = [i for i, sentence in enumerate(sentences) if any(phrase.skill in RESTS for phrase in sentence)]
        falls_asleep = max(resting, default=len(sentences) - 1) if asleep else None
        for position, sentence in enumerate(sentences):
            woken = falls_asleep is not None and position == falls_asleep + 1
            self._act(sentence, last=position == len(sentences) - 1 > 0, woken=woken)
            if position == falls_asleep:
                self._lead(happens, summary, events)

    def _turn_to(self, scene: Scene) -> None:
        """A sentence that leads from the mood of the scene before to that of this one."""
        emotion = self._emotion(scene)
        turns = reasons.TURNS.get(emotion, {})
        fits = scene.event is None or emotion_of(self.script.events[scene.event].emotion) in (emotion, None)
        if self.mood and emotion != self.mood and fits and self.variety.chance(0.75):
            options = self._framed(turns.get(self.mood, turns.get("", ())))
            if options and not self.ear.heard(options):
                self.scene.append(self.ear.choose(options))
        self.mood = emotion

    def _emotion(self, scene: Scene) -> str:
        if scene.script is not None:
            return self.script.short_scripts[scene.script].script.emotion
        return mood_of(scene.keyframes[-1][1])

    def _events(self, scene: Scene, events: Sequence[int]) -> list[str]:
        """The theme's own words where no summary that serves them has them."""
        told: list[str] = []
        for number in events:
            served = [r.script.summary for r in self.script.short_scripts if r.event == number]
            served += [self.script.short_scripts[scene.script].script.summary] if scene.script is not None else []
            event = self.script.events[number].text
            if max((covered(event, summary) for summary in served), default=0.0) < 0.5:
                event = told_of_hero(event, self.script.theme)
                told.append(event_retold(event, self.voice, bool(told) or self._named()) or "")
        return [sentence for sentence in told if sentence]

    def _summary(self, scene: Scene) -> str:
        return "" if scene.script is None else self.script.short_scripts[scene.script].script.summary

    def _lead(self, happens: Sequence[str], summary: str, events: Sequence[int]) -> None:
        """The theme's own words, then the summary, joined by the theme's own "so" or "but"."""
        turned = len(self.scene) > 0 and self.scene[-1].family == "turn"
        event = self.script.events[events[0]].text if events else ""
        meant = bool(happens) or covered(event, summary) >= _LINKED
        link = link_before(self.script.theme, event) if meant and not turned else ""
        for sentence in happens:
            self._say(sentence, link)
            link = ""
        told = retell(summary, self.voice, self._named()) if summary else None
        for sentence in re.split(r"(?<=[.!?])\s+", told or ""):
            if sentence:
                self._say(sentence, link)
                link = ""

    def _enter(self, scene: Scene) -> None:
        """Note a room that is new and not named yet; the first sentence about the body will name it."""
        room = self.wording.room_of(*scene.keyframes[0])
        named = room == "room" or any(room in sentence.text for sentence in self.scene)
        new = room not in self.rooms[-1:]
        self.arrival = room if new and not named else ""
        self.visits = -1 if not self.rooms else self.rooms.count(room)
        self.wording.say_room = not named and not self.arrival
        self.rooms.append(room)

    def _sentences(self, scene: Scene, asleep: bool, final: bool) -> list[tuple[Phrase, ...]]:
        """The scene's keyframes worded; leaving a seat at its end may go without saying."""
        phrases = self.wording.phrases(scene.keyframes, self.passed_over)
        self.passed_over = ()
        if len(phrases) > 1 and phrases[-1].rises and not final and not asleep and self.variety.chance(0.6):
            self.passed_over = phrases.pop().keyframes
        return sentences_of(phrases)

    def _act(self, sentence: Sequence[Phrase], last: bool = False, woken: bool = False) -> None:
        """One sentence about the body, in the frame that sounds freshest."""
        who = self.voice["they"] if self._named() else self.voice.name
        manner = Manner(self.time, last=last, woken=woken)
        if not sentence[0].rises:
            manner, self.arrival = replace(manner, room=self.arrival, visits=self.visits), ""
        options = framed(sentence, who, self.voice, manner)
        self.scene.append(self.ear.choose(options))

    def _named(self) -> bool:
        """Whether a pronoun would be understood: the name was said a sentence or two ago in this scene."""
        recent = [sentence.text for sentence in self.scene[-2:]]
        if not any(self.voice.name in text for text in recent):
            return False
        return self.voice.pronouns != "they" or bool(re.search(rf"\b(?:{self.voice.name}|[Tt]hey)\b", recent[-1]))

    def _say(self, sentence: str, link: str = "") -> None:
        """Add a sentence that is not about the body, after a word for the time where it needs one."""
        inner = sentence if sentence.startswith(self.voice.name) else sentence[:1].lower() + sentence[1:]
        if link and sentence.startswith((self.voice.name, "The ", "A ", "An ", "He ", "She ", "They ")):
            options = [said(f"{link} {inner}")]
        else:
            turns = framing.NOTES if framing.STANDS_ALONE.match(sentence) else framing.TURNS
            turns = framing.CRIES if sentence.endswith("!") else turns
            options = [said(sentence), *(said(f"{turn} {inner}", turn, "after") for turn in turns)]
        self.scene.append(self.ear.choose(options, first=not link))

    def _closings(self, told: Sequence[Sequence[Sentence]]) -> tuple[str, ...]:
        if not self.script.keyframes:
            return framing.CLOSINGS["neutral"]
        last = self.script.keyframes[-1]
        mood = mood_of(last)
        asleep = re.search(r"sleep|awake", " ".join(sentence.text for part in told for sentence in part))
        lying = framing.LYING_CLOSINGS.get(mood) if last.skill == Skill.LIEDOWN and not asleep else None
        turned = framing.TURNED_CLOSINGS.get((emotion_of(self.first.emotion) or "neutral", mood))
        return lying or turned or framing.CLOSINGS[mood]

    def _framed(self, templates: Sequence[str]) -> list[Sentence]:
        they, their = self.voice["they"].capitalize(), self.voice["their"].capitalize()
        told = [self.voice.fill(template, time=self.time, They=they, Their=their) for template in templates]
        return [said(re.sub(r"\ba (?=[aeiou])", "an ", text), text, "turn") for text in told]
