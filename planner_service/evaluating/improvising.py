"""A scripted model that writes long scripts by itself, for the baseline of SIMS 10 where no real model is at hand."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache

import numpy as np
from pydantic import BaseModel

from motion_backend.motion import Skill
from planner_service.llm.scripted import ScriptedModel
from planner_service.scripts.directing import direct_by_rules
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.events import clauses_of, moods_of
from planner_service.scripts.fitting import NEEDS, affords
from planner_service.scripts.keyframe import Event, PlannedKeyframe
from planner_service.scripts.planning import DirectKeyframe, DirectScript


def improviser(theme: str, seed: int) -> ScriptedModel:
    """A model that answers `prompts/direct_script.md` for this theme. Raises ThemeError as `clauses_of` does.

    It stands for a language model at some temperature and is none: rules find the events and what is done in each,
    and the seed chooses captions in the event's mood and furniture that serves, out of all that the prompt offers.
    """
    clauses = clauses_of(theme)
    moods = moods_of(clauses, [None] * len(clauses))
    events = [Event(text=clause.text, emotion=mood) for clause, mood in zip(clauses, moods, strict=True)]

    def answer(prompt: str, _schema: type[BaseModel]) -> DirectScript:
        return improvised(events, captions_in(prompt), furniture_in(prompt), seed)

    return ScriptedModel(answer, name="improviser")


def improvised(
    events: Sequence[Event], captions: dict[Skill, list[str]], furniture: Sequence[str], seed: int
) -> DirectScript:
    """What is done in each event, with captions and furniture by the seed."""
    luck = np.random.default_rng(seed)
    keyframes = direct_by_rules(events)
    pieces = _pieces(keyframes, events, furniture, luck)
    return DirectScript(
        keyframes=[
            DirectKeyframe(
                skill=keyframe.skill,
                emotion=keyframe.emotion,
                caption=str(luck.choice(_fitting(keyframe, captions.get(keyframe.skill, [])))),
                furniture=pieces.get(keyframe.event, keyframe.furniture),
            )
            for keyframe in keyframes
        ]
    )


def _fitting(keyframe: PlannedKeyframe, known: Sequence[str]) -> Sequence[str]:
    """Captions that show the keyframe's emotion, else those that show none, else its own."""
    moody = [caption for caption in known if _mood(caption) == keyframe.emotion]
    return moody or [caption for caption in known if _mood(caption) in (None, "neutral")] or [keyframe.caption]


@cache
def _mood(caption: str) -> str | None:
    return emotion_of(caption)


def captions_in(prompt: str) -> dict[Skill, list[str]]:
    """The captions that a prompt offers, by skill."""
    found = re.findall(rf"^  ({'|'.join(Skill)}): (.+)$", prompt, re.MULTILINE)
    return {Skill(skill): captions.split("; ") for skill, captions in found}


def furniture_in(prompt: str) -> list[str]:
    """The furniture words that a prompt offers."""
    line = re.search(r"^Furniture: (.+?)\. ", prompt, re.MULTILINE)
    return line[1].split(", ") if line else []


def _pieces(
    keyframes: Sequence[PlannedKeyframe], events: Sequence[Event], furniture: Sequence[str], luck: np.random.Generator
) -> dict[int | None, str]:
    """The piece of furniture of each event that needs one: what its words name, else one that serves."""
    pieces: dict[int | None, str] = {}
    for keyframe in keyframes:
        if keyframe.skill is Skill.LOCO or keyframe.event is None:
            continue
        named = keyframe.furniture in events[keyframe.event].text.lower()
        serving = [] if named else [word for word in furniture if affords(word, NEEDS[keyframe.skill])]
        pieces[keyframe.event] = str(luck.choice(serving)) if serving else keyframe.furniture
    return pieces
