"""What stands at the head of each scene: which events of the theme it tells, and how much of its summary.

The parts of a long script as a teller sees them: scenes, and how much of an event a sentence tells.

Paragraphs: sentences of scenes brought to a length that reads well, and laid out as text with spans.
"""

from __future__ import annotations

import re
from collections.abc import Container, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Final

from motion_backend.motion import Skill
from planner_service.narration.event_sentences import joint_between
from planner_service.narration.keyframe_phrases import Variety
from planner_service.narration.sentence_frames import Sentence
from planner_service.narration.tense import stem
from planner_service.scripts.script import LongScript, PlannedKeyframe

_ASLEEP = re.compile(r"\b(?:fell (?:fast )?asleep|went to sleep|(?:took|into) a nap|dozed off|nodded off|passed out)\b")
_PALE_WORDS = """
come comes came goes going went gone make makes made take takes took
all and are but can did for get gets had has her him his its not off out said say says she tell tells the told too was
who again about after becom befor begin chara decid feels felt from gets herse himse into over perso some start that
their then thems this very when with
"""
_PALE = frozenset(_PALE_WORDS.split())
"""Words, or their first five letters, that say nothing about what happens."""
_ON_SEAT = re.compile(
    r"\b(?:(?:on|in|into|onto) (?:an?|the|his|her|their)(?: \w+)? (?:\w*chair|sofa|couch|loveseat|bench|stool)"
    r"|(?:on|in|into|onto|to) (?:(?:an?|the|his|her|their) )?bed)\b"
)
_FINDS = re.compile(r"\b(?:finds?|found) (?!that\b|out\b|no\b|it\b|he\b|she\b|they\b|\w*self\b)")
_DOES = frozenset(("eat", "drink", "write", "type", "read", "play", "listen", "talk"))
"""Deeds that a posture's caption tells."""
_ON_FOOT = frozenset(("run", "dance", "pace", "stroll", "skip", "march", "stomp"))
"""Deeds that a walk's caption tells."""
RESTS = (Skill.SITDOWN, Skill.LIEDOWN)
_RISES = (Skill.STANDUP, Skill.GETUP)


@dataclass(frozen=True)
class Scene:
    """Keyframes that one short script put in, or one event where there are no short scripts."""

    script: int | None
    """Index into the long script's short scripts."""
    event: int | None
    keyframes: tuple[tuple[int, PlannedKeyframe], ...]
    """With their indices in the long script."""

    def sleeps(self, told: str) -> bool:
        """Whether the telling speaks of sleep and the body rests: sleep is then told after the last rest."""
        own = [k.skill for _, k in self.keyframes if k.short_script is not None or self.script is None]
        return bool(_ASLEEP.search(told)) and any(skill in RESTS for skill in own)

    def tells(self, told: str) -> tuple[Skill, ...]:
        """The skills of the scene's keyframes that tell what the telling speaks of too: a rest, what is done at it, or
        a way to walk; none where they tell something else."""
        seats = [keyframe.caption for _, keyframe in self.keyframes if keyframe.skill in RESTS]
        if seats and (_ON_SEAT.search(told) or deeds_in(told) & deeds_in(" ".join(seats))):
            return RESTS
        walks = " ".join(k.caption for _, k in self.keyframes if k.skill == Skill.LOCO and k.on_floor)
        return (Skill.LOCO,) if deeds_in(" ".join(told.split()[:2])) & deeds_in(walks) & _ON_FOOT else ()


def finds(summary: str) -> bool:
    """Whether a summary tells of something found, which the body has to reach for first."""
    return bool(_FINDS.search(summary))


def deeds_in(text: str) -> frozenset[str]:
    """What a text says is done that captions tell as well, in base form."""
    return (_DOES | _ON_FOOT) & {stem(word) for word in re.findall(r"[a-z]+", text.lower())}


def scenes_of(script: LongScript) -> list[Scene]:
    """The scenes in order; connecting keyframes go with what follows them, but rising ends the scene before."""
    keyframes = script.keyframes
    owners: list[tuple[int | None, int | None]] = [(k.short_script, k.beat) for k in keyframes]
    bridging = [k.short_script is None and bool(script.short_scripts) for k in keyframes]
    for index in reversed(range(len(keyframes) - 1)):
        if bridging[index]:
            owners[index] = owners[index + 1]
    for index in range(1, len(keyframes)):
        trailing = bridging[index] and (keyframes[index].skill in _RISES or all(bridging[index:]))
        if trailing:
            owners[index] = owners[index - 1]
    runs = groupby(enumerate(keyframes), key=lambda row: owners[row[0]])
    return [Scene(owner[0], owner[1], tuple(run)) for owner, run in runs]


def covered(event: str, summary: str) -> float:
    """Share of an event's content words that the summary has too; 1 when it has no content words."""
    wanted, had = _stems(event), _stems(summary)
    return len(wanted & had) / len(wanted) if wanted else 1.0


def _stems(text: str) -> set[str]:
    words = re.findall(r"[a-z]{3,}", text.lower())
    return {stem(word)[:5] for word in words if word not in _PALE and word[:5] not in _PALE}


SENTENCES: Final = re.compile(r"(?<=[.!?])\s+")
_SAME: Final = 0.5
"""Share of an event's words from which on a sentence tells the event again."""
_COLOUR: Final = 0.25
"""Share of an event's words below which a sentence of a summary that tells the event only adds to it."""
_AGAIN: Final = 0.15
"""How much nearer a second script for one event has to be."""
_NEARLY: Final = 0.75
"""Share of an event's words from which on a summary may tell it in the theme's stead."""
_IN_ITS_WORDS: Final = 0.2
"""Share of the stories in which it does."""
_FOREIGN: Final = 0.45
"""Nearness of a script to its event at which its summary would be another story."""
_OFTEN: Final = 0.75
"""Share of the stories that tell what the nearest summaries say besides the event."""
_TOGETHER: Final = 0.8
"""Share of the events told in one sentence with the next, where that can be."""
_MAX_EVENTS_PER_LEAD: Final = 3
"""Events in one sentence."""


@dataclass(frozen=True)
class Lead:
    """What is told of a scene besides what the body does."""

    events: tuple[int, ...] = ()
    """Events of the theme, in one sentence where their words allow it."""
    details: tuple[int, ...] = ()
    """Sentences of the scene's summary."""


def leads_of(script: LongScript, scenes: Sequence[Scene], tellable: Container[int], variety: Variety) -> list[Lead]:
    """One lead a scene. Every event is told once, in the theme's own words where it is `tellable`.

    What the summary says besides is told where the script is near its event, the nearer the likelier; all of it where
    nothing else would tell the event.
    """
    leads: list[Lead] = []
    reached = 0
    for scene in scenes:
        upto = reached if scene.event is None else max(reached, scene.event + 1)
        leads.append(_own(script, scene, range(reached, upto), tellable, variety))
        reached = upto
    return _together(script, scenes, leads, variety)


def _own(script: LongScript, scene: Scene, events: Sequence[int], tellable: Container[int], variety: Variety) -> Lead:
    if scene.script is None:
        return Lead(tuple(events))
    found = script.short_scripts[scene.script]
    event = script.beats[found.beat].text
    sentences = SENTENCES.split(found.script.summary)
    shares = [1.0 if sentence.rstrip(".!?") in event else covered(event, sentence) for sentence in sentences]
    everything = tuple(range(len(shares)))
    if events and not any(event in tellable for event in events):
        return Lead(tuple(events), everything)
    if len(events) == 1 and max(shares) >= _NEARLY and variety.chance(_IN_ITS_WORDS):
        return Lead((), everything)
    near = max(found.score, covered(event, found.script.summary)) - (0 if events else _AGAIN)
    share = min(_OFTEN, max(0.0, (near - _FOREIGN) / (1 - _FOREIGN) * 2))
    asleep = _RESTING.search(event) and _RESTING.search(found.script.summary)
    if asleep or not variety.chance(share):
        return Lead(tuple(events))
    least = _COLOUR if covered(event, found.script.summary) >= _SAME else _SAME
    return Lead(tuple(events), tuple(place for place in everything if shares[place] < least))


def _together(script: LongScript, scenes: Sequence[Scene], leads: list[Lead], variety: Variety) -> list[Lead]:
    """Events told in one sentence with those of the next scene: after the scene where its summary tells enough of it,
    before both where one feeling lasts."""
    moved: set[int] = set()
    for place in range(len(leads) - 1):
        one, two = leads[place : place + 2]
        able = one.events and two.events and len(one.events) + len(two.events) <= _MAX_EVENTS_PER_LEAD
        if not able or not variety.chance(_TOGETHER):
            continue
        before, after = (script.beats[events[end]] for events, end in ((one.events, -1), (two.events, 0)))
        joint = joint_between(script.theme, before.text, after.text)
        if not joint or scenes[place].tells(before.text) or scenes[place + 1].tells(after.text):
            continue
        lasting = joint == "before" or before.emotion == after.emotion
        if lasting and one.details and len(one.events) == 1 and place not in moved:
            leads[place], leads[place + 1] = replace(one, events=()), replace(two, events=one.events + two.events)
            moved.add(place + 1)
        elif lasting and not _RESTING.search(after.text):
            leads[place], leads[place + 1] = replace(one, events=one.events + two.events), replace(two, events=())
    return leads


_RESTING: Final = re.compile(r"\b(?:sleep|asleep|nap|doz|nod)", re.IGNORECASE)


MIN_SENTENCES, MAX_SENTENCES = 3, 6
"""Sentences in a paragraph, where the story is long enough for it."""


@dataclass(frozen=True)
class Span:
    """A stretch of a told text, end exclusive, and the keyframes it tells."""

    start: int
    end: int
    keyframes: tuple[int, ...]


def balanced(scenes: Sequence[Sequence[Sentence]]) -> list[list[Sentence]]:
    """One paragraph a scene; short ones join a neighbour, long ones are parted in the middle."""
    joined: list[list[Sentence]] = []
    for scene in scenes:
        short = bool(joined) and min(len(scene), len(joined[-1])) < MIN_SENTENCES
        if short and (len(scene) + len(joined[-1]) <= MAX_SENTENCES or not scene):
            joined[-1] += scene
        else:
            joined.append(list(scene))
    for index in range(len(joined) - 1, 0, -1):
        if len(joined[index]) < MIN_SENTENCES:
            joined[index - 1] += joined.pop(index)
    if len(joined) > 1 and len(joined[0]) < MIN_SENTENCES:
        joined[0] += joined.pop(1)
    return [part for paragraph in joined for part in _parted(paragraph)]


def _parted(paragraph: list[Sentence]) -> list[list[Sentence]]:
    """A paragraph as it is, or parts of it where a sentence about the body can begin the next with the name."""
    places = range(MIN_SENTENCES, len(paragraph) - MIN_SENTENCES + 1)
    able = [place for place in places if paragraph[place].named is not None]
    if len(paragraph) <= MAX_SENTENCES or not able:
        return [paragraph]
    at = min(able, key=lambda place: abs(2 * place - len(paragraph)))
    return [*_parted(paragraph[:at]), *_parted([paragraph[at].with_name(), *paragraph[at + 1 :]])]


def laid_out(paragraphs: Sequence[Sequence[Sentence]]) -> tuple[str, tuple[Span, ...]]:
    """The text, paragraphs parted by empty lines, and which of its characters tell which keyframes."""
    text = ""
    spans: list[Span] = []
    for number, paragraph in enumerate(paragraphs):
        text += "\n\n" if number else ""
        for place, sentence in enumerate(paragraph):
            text += " " if place else ""
            for position, (words, keyframes) in enumerate(sentence.pieces):
                words = words[:1].upper() + words[1:] if position == 0 else words
                if keyframes:
                    spans.append(Span(len(text), len(text) + len(words), keyframes))
                text += words
    return text, tuple(spans)
