"""A long script told as a story: prose that follows the keyframes in order and knows which words tell which."""

from __future__ import annotations

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

from motion_backend.motion import Character, Skill
from planner_service.narration.event_sentences import fragment, happening, link_before, told_together
from planner_service.narration.keyframe_phrases import (
    Phrase,
    Places,
    Variety,
    Wording,
    joined,
    sentences_of,
    without_room,
)
from planner_service.narration.narrative_voice import Voice, retell
from planner_service.narration.openings_and_endings import (
    ANY_OTHER,
    STANDS_ALONE,
    gainsaid,
    story_texts,
    tells_time,
    time_of,
    title_of,
)
from planner_service.narration.sentence_frames import Ear, Manner, Sentence, framed, said
from planner_service.narration.story_scenes import (
    RESTS,
    SENTENCES,
    Lead,
    Scene,
    Span,
    balanced,
    deeds_in,
    finds,
    laid_out,
    leads_of,
    scenes_of,
)
from planner_service.scripts.script import Beat, LongScript

__all__ = ["Places", "Span", "Told", "narrate"]
_UNFIT = r"[,;:]|\b(?:when|that|this|first)\b"
"""What an event does not have that begins a story."""
_AN = re.compile(r"\ba (?=[aeiou])")
_DEED = re.compile(r"(?:He|She|They) (?!was|were|had|could|did not|felt|stayed|kept|became|got|grew)")
"""How a sentence begins that time can have passed before."""
_BEGINS = 14
"""Words of what happens first, in a story's first sentence."""
_JOINED = 22
"""Words of a sentence that tells what happens and what the body does."""
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


def _names_it(sentence: Sequence[Phrase]) -> bool:
    """Whether a sentence begins with what the one before it named."""
    return bool(re.search(r"\bits?\b", sentence[0].text))


def _last_of(skills: Sequence[Skill], sentences: Sequence[Sequence[Phrase]]) -> int:
    """Which is the last of the sentences to tell one of the skills; the first that tells of a touch."""
    places = [i for i, sentence in enumerate(sentences) if any(phrase.skill in skills for phrase in sentence)]
    return (min if Skill.TOUCH in skills else max)(places, default=len(sentences) - 1)


Remark = tuple[str, str | None]
"""A sentence about what happens, and the theme's own "so" or "but" before it; None of what a summary adds."""


def _skills(scene: Scene, remark: Remark) -> tuple[Skill, ...]:
    """What the body does first of what a remark tells; nothing where that goes before."""
    sentence, link = remark
    return scene.tells(sentence) or ((Skill.TOUCH,) if link is None and finds(sentence) else ())


class _Narrator:
    """Writes one story from its opening to its closing sentence."""

    def __init__(self, script: LongScript, voice: Voice, seed: int, places: Places) -> None:
        self.script = script
        self.voice = voice
        self.variety = Variety(seed, zlib.crc32(script.theme.encode()))
        self.ear = Ear(self.variety)
        self.wording = Wording(voice, self.variety, places, brief=len(script.keyframes) > _MANY)
        events = script.beats
        self.first, self.last = (events[0], events[-1]) if events else (Beat(text=script.theme),) * 2
        self.time = time_of(self.first.text, *(r.script.summary for r in script.short_scripts[:1]))
        self.rooms: list[str] = []
        self.arrival = ""
        """The room that the next sentence about the body names."""
        self.visits = -1
        """How often the story was in this room before; -1 in its first."""
        self.mood = ""
        """The mood of the scene before."""
        self.risen: tuple[Phrase, ...] = ()
        """The rising that leads from the scene before to this one."""
        self.setting = ""
        """What the theme says of when or how the next event is."""
        self.turned = False
        """Whether the mood turned since something happened."""
        self.later = False
        """Whether something was told already."""
        self.scene: list[Sentence] = []

    def tell(self) -> Told:
        """The whole story."""
        scenes = scenes_of(self.script)
        theme, events = self.script.theme, self.script.beats
        tellable = {number for number, event in enumerate(events) if happening(event.text, theme, self.voice)}
        told: list[list[Sentence]] = []
        leads = leads_of(self.script, scenes, tellable, self.variety)
        for number, (scene, lead) in enumerate(zip(scenes, leads, strict=True)):
            self.scene, self.later = [], number > 0
            self._tell_scene(scene, lead, final=number == len(scenes) - 1)
            told.append(self.scene)
        self.scene = [] if scenes else [self.ear.choose(self._opening())]
        reached = max((scene.event + 1 for scene in scenes if scene.event is not None), default=0)
        self._say_all(self._happens(range(reached, len(events))))
        self.scene.append(self.ear.choose(self._framed(self._closings([*told[-1:], self.scene]))))
        if told and len(self.scene) == 1:
            self.scene = told.pop() + self.scene
        text, spans = laid_out(balanced([*told, self.scene]))
        title = title_of(self.script.theme, self.last.emotion, self.time)
        return Told(title, text, spans)

    def _tell_scene(self, scene: Scene, head: Lead, final: bool) -> None:
        """What happens (the lead) and what the body does; sleep comes after what leads to it."""
        lead = self._headed(scene, head)
        asleep = scene.sleeps(" ".join(sentence for sentence, _ in lead))
        rest = [] if asleep else [remark for remark in lead if _skills(scene, remark)]
        lead = [remark for remark in lead if remark not in rest]
        self.wording.doing = deeds_in(" ".join(sentence for sentence, _ in rest))
        late = [] if asleep or len(lead) < 2 or self.variety.chance(0.6) else [lead.pop()]
        if not asleep:
            self._say_all(lead[:-1])
        self._enter(scene, "" if asleep else lead[-1][0] if lead else "")
        sentences = self._sentences(scene, asleep, final)
        at = next((i for i, told in enumerate(sentences[1:]) if not _names_it(told)), len(sentences) - 1)
        joined = not asleep and bool(lead) and self.variety.chance(0.25) and self._joined(lead[-1], sentences[0])
        if not asleep and not joined:
            self._say_all(lead[-1:])
        shown = {remark: _last_of(_skills(scene, remark), sentences) for remark in rest}
        falls_asleep = _last_of(RESTS, sentences) if asleep else None
        for position, sentence in enumerate(sentences):
            woken = falls_asleep is not None and position == falls_asleep + 1
            if position or not joined:
                self._act(sentence, last=position == len(sentences) - 1 > 0 and not (rest or late), woken=woken)
            self._say_there(scene, [remark for remark in rest if shown[remark] == position])
            if position == falls_asleep:
                self._say_all(lead)
            if position == at:
                self._say_all(late)

    def _headed(self, scene: Scene, head: Lead) -> list[Remark]:
        """What is still to be told of a scene's lead after the story's first sentence, or one between two moods."""
        if self.rooms:
            self._turn_to(scene)
            return self._told(scene, head)
        self.mood = self._emotion(scene)
        setting = self.setting
        lead = self._told(scene, head)
        if (
            head.events
            and lead
            and not scene.tells(lead[0][0])
            and self.variety.chance(0.5)
            and (options := self._beginnings(lead[0][0]))
        ):
            self.scene.append(self.ear.choose(options))
            return lead[1:]
        self.scene.append(self.ear.choose(self._opening()))
        self.setting = setting
        return self._told(scene, head)

    def _beginnings(self, event: str) -> list[Sentence]:
        """Ways to begin with an event, none where it is not short and plain."""
        if not event.endswith(".") or re.search(_UNFIT, event[:-1]) or len(event.split()) > _BEGINS:
            return []
        is_state = re.search(r"\b(?:was|were|had)\b", event)
        shapes = story_texts().beginnings + (() if is_state else story_texts().sudden_beginnings)
        fitting = [shape for shape in shapes if "{time}" not in shape or not tells_time(event)]
        told = [self.voice.fill(shape, time=self.time, event=self._inner(event)) for shape in fitting]
        return [said(_AN.sub("an ", text)) for text in told]

    def _opening(self) -> list[Sentence]:
        """First sentences that the first event does not gainsay."""
        openings = story_texts().openings[self.first.emotion]
        fitting = [text for text in openings if not gainsaid(text, self.first.text)]
        return self._framed(fitting or story_texts().openings["neutral"][3:4])

    def _turn_to(self, scene: Scene) -> None:
        """A sentence that leads from the mood of the scene before to that of this one."""
        emotion = self._emotion(scene)
        turns = story_texts().mood_changes.get(emotion, {})
        fits = scene.event is None or self.script.beats[scene.event].emotion == emotion
        if self.mood and emotion != self.mood and fits and self.variety.chance(0.75):
            options = self._framed(turns.get(self.mood, turns.get(ANY_OTHER, ())))
            if options and not self.ear.heard(options):
                self.scene.append(self.ear.choose(options))
                self.turned = True
        self.mood = emotion

    def _emotion(self, scene: Scene) -> str:
        if scene.script is not None:
            return self.script.short_scripts[scene.script].script.emotion
        return scene.keyframes[-1][1].mood

    def _happens(self, events: Sequence[int]) -> list[Remark]:
        """Events in the theme's own words, each sentence with the theme's "so" or "but" before it."""
        texts = [self.script.beats[event].text for event in events]
        theme = self.script.theme
        together = told_together([text for text in texts if not fragment(text)], theme, self.voice, self._named())
        sentences = [sentence for text in together for sentence in SENTENCES.split(text)]
        links: list[str | None] = [link_before(theme, texts[0]) if texts else "", *([""] * len(sentences))]
        settings = [setting for text in texts if (setting := fragment(text))]
        if sentences and (settings or self.setting):
            sentences[0] = f"{[self.setting, *settings][-1]}, {self._inner(sentences[0])}"
            self.setting, links[0] = "", ""
        elif settings:
            self.setting = settings[-1]
        return list(zip(sentences, links, strict=False))

    def _told(self, scene: Scene, lead: Lead) -> list[Remark]:
        """The sentences of a lead."""
        told = self._happens(lead.events)
        if scene.script is None or not lead.details:
            return told
        summary = self.script.short_scripts[scene.script].script.summary
        chosen = [sentence for place, sentence in enumerate(SENTENCES.split(summary)) if place in lead.details]
        more = retell(" ".join(chosen), self.voice, bool(told) or self._named())
        return told + [(text, None) for text in SENTENCES.split(more or "") if text]

    def _say_all(self, lead: Sequence[Remark]) -> None:
        """Sentences of a lead; some of those that tell of a deed say that time has passed.

        What a summary adds is left out where something began with the same words.
        """
        for sentence, link in lead:
            deed = _DEED.match(re.sub(rf"^{re.escape(self.voice.name)}\b", "They", sentence))
            timed = bool(deed) and link is not None and self.later and not self.turned and self.variety.chance(0.35)
            if link is not None or not self.ear.heard([said(sentence)]):
                self._say(sentence, "" if self.turned else link or "", timed)
            self.turned = False

    def _say_there(self, scene: Scene, rest: Sequence[Remark]) -> None:
        """What keyframes tell too, once the body has come to it."""
        for remark in rest:
            skills, sentence = _skills(scene, remark), remark[0]
            if Skill.TOUCH in skills:
                self._say_all([remark])
                continue
            who = self.voice["they"] if self._named() and self.voice.pronouns != "they" else self.voice.name
            inner = self._inner(re.sub(rf"^{re.escape(self.voice.name)} ", f"{who} ", sentence))
            words = story_texts().there if skills == RESTS and not re.search(r" to bed\b", inner) else story_texts().so
            options = [said(f"{word} {inner}", f"{word} {{who}}", "there") for word in words]
            self.scene.append(self.ear.choose(options, first=True))

    def _joined(self, lead: Remark, sentence: Sequence[Phrase]) -> bool:
        """Tell an event and what the body does first as one sentence, where both are short; whether that was done."""
        event, link = lead
        words = len(event.split()) + sum(len(phrase.text.split()) for phrase in sentence)
        if self.arrival or link or words > _JOINED or re.search(r"[,;:!?]", event) or sentence[0].rises:
            return False
        name = self.voice.name in event or (self._named() and self.voice.pronouns != "they")
        who = self.voice["they"] if name else self.voice.name
        options = [
            Sentence(((shape.format(event=event[:-1], who=who), ()), *joined(sentence), (".", ())), shape, "joint")
            for shape in story_texts().joints
        ]
        if self.ear.heard(options):
            return False
        self.scene.append(self.ear.choose(options))
        return True

    def _inner(self, sentence: str) -> str:
        """A sentence as it goes on after other words."""
        return sentence if sentence.startswith(self.voice.name) else sentence[:1].lower() + sentence[1:]

    def _enter(self, scene: Scene, next_told: str) -> None:
        """Note a room that is new and not named yet; the first sentence about the body will name it."""
        room = self.wording.room_of(*scene.keyframes[0])
        named = room == "room" or any(room in text for text in (next_told, *(sentence.text for sentence in self.scene)))
        new = room not in self.rooms[-1:]
        self.arrival = room if new and not named else ""
        self.visits = -1 if not self.rooms else self.rooms.count(room)
        self.wording.say_room = not named and not self.arrival
        self.rooms.append(room)

    def _sentences(self, scene: Scene, asleep: bool, final: bool) -> list[tuple[Phrase, ...]]:
        """The scene's keyframes worded; leaving a seat at its end is told with the next."""
        phrases = [*self.risen, *self.wording.phrases(scene.keyframes, risen=bool(self.risen))]
        self.risen = ()
        if len(phrases) > 1 and phrases[-1].rises and not asleep:
            rising = phrases.pop()
            if final:
                phrases[-1] = replace(phrases[-1], keyframes=phrases[-1].keyframes + rising.keyframes)
            else:
                self.risen = (rising,)
        return sentences_of(phrases, self.variety)

    def _act(self, sentence: Sequence[Phrase], last: bool = False, woken: bool = False) -> None:
        """One sentence about the body, in the frame that sounds freshest."""
        who = self.voice["they"] if self._named() else self.voice.name
        manner = Manner(self.time, last=last, woken=woken)
        if len(sentence) > 1 or not sentence[0].rises:
            sentence = without_room(sentence, self.rooms[-1], named=bool(self.arrival))
            manner, self.arrival = replace(manner, room=self.arrival, visits=self.visits), ""
        options = framed(sentence, who, self.voice, manner)
        self.scene.append(self.ear.choose(options))

    def _named(self) -> bool:
        """Whether a pronoun would be understood: the name was said a sentence or two ago in this scene."""
        recent = [sentence.text for sentence in self.scene[-2:]]
        if not any(self.voice.name in text for text in recent):
            return False
        return self.voice.pronouns != "they" or bool(re.search(rf"\b(?:{self.voice.name}|[Tt]hey)\b", recent[-1]))

    def _say(self, sentence: str, link: str = "", timed: bool = False) -> None:
        """Add a sentence that is not about the body, after a word for the time where it needs one or is `timed`."""
        inner = self._inner(sentence)
        if link and sentence.startswith((self.voice.name, "The ", "A ", "An ", "He ", "She ", "They ")):
            options = [said(f"{link} {inner}")]
        else:
            turns = story_texts().notes if STANDS_ALONE.match(sentence) else story_texts().turns
            turns = story_texts().cries if sentence.endswith("!") else turns
            options = [said(sentence), *(said(f"{turn} {inner}", turn, "after") for turn in turns)]
        self.scene.append(self.ear.choose(options, first=not (link or timed)))

    def _closings(self, told: Sequence[Sequence[Sentence]]) -> tuple[str, ...]:
        if not self.script.keyframes:
            return story_texts().closings["neutral"]
        last = self.script.keyframes[-1]
        mood = last.mood
        asleep = re.search(r"sleep|awake", " ".join(sentence.text for part in told for sentence in part))
        lying = story_texts().lying_closings.get(mood) if last.skill == Skill.LIEDOWN and not asleep else None
        turned = story_texts().turned_closings.get(self.first.emotion, {}).get(mood)
        return lying or turned or story_texts().closings[mood]

    def _framed(self, templates: Sequence[str]) -> list[Sentence]:
        they, their = self.voice["they"].capitalize(), self.voice["their"].capitalize()
        told = [self.voice.fill(template, time=self.time, They=they, Their=their) for template in templates]
        return [said(_AN.sub("an ", text), text, "turn") for text in told]
