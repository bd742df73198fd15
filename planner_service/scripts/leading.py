"""What stands at the head of each scene: which events of the theme it tells, and how much of its summary."""

from __future__ import annotations

import re
from collections.abc import Container, Sequence
from dataclasses import dataclass, replace
from typing import Final

from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.happenings import joint_between
from planner_service.scripts.keyframe import LongScript
from planner_service.scripts.moments import Variety
from planner_service.scripts.scenes import Scene, covered

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
    event = script.events[found.event].text
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
        before, after = (script.events[events[end]] for events, end in ((one.events, -1), (two.events, 0)))
        joint = joint_between(script.theme, before.text, after.text)
        if not joint or scenes[place].tells(before.text) or scenes[place + 1].tells(after.text):
            continue
        lasting = joint == "before" or emotion_of(before.emotion) == emotion_of(after.emotion)
        if lasting and one.details and len(one.events) == 1 and place not in moved:
            leads[place], leads[place + 1] = replace(one, events=()), replace(two, events=one.events + two.events)
            moved.add(place + 1)
        elif lasting and not _RESTING.search(after.text):
            leads[place], leads[place + 1] = replace(one, events=one.events + two.events), replace(two, events=())
    return leads


_RESTING: Final = re.compile(r"\b(?:sleep|asleep|nap|doz|nod)", re.IGNORECASE)
