"""What a language model is asked for when a long script is composed, and how its answers are checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from pydantic import BaseModel, ValidationError

import prompts
from motion_backend.emotion_words import emotion_of
from motion_backend.motion import Emotion, Skill
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.structured_output import ask, problems_of
from planner_service.scripts.captions import captions_offered, furniture_offered
from planner_service.scripts.script import EMOTIONS, Beat, Keyframe
from planner_service.scripts.script_repair import check, read_keyframe
from planner_service.scripts.script_search import Found

MAX_KEYFRAMES: Final = 40
_MAX_CAPTIONS: Final = 40


class PlannedEvent(BaseModel):
    """One event as a model writes it."""

    text: str
    emotion: str


class PlannedEvents(BaseModel):
    """The answer to `prompts/plan_events.md`."""

    events: list[PlannedEvent]


class Choice(BaseModel):
    """A short script chosen for an event."""

    event: int
    script: str


class Arrangement(BaseModel):
    """The answer to `prompts/arrange_story.md`."""

    choices: list[Choice]


class DirectKeyframe(BaseModel):
    """One keyframe as a model writes it."""

    skill: str
    emotion: str
    caption: str
    furniture: str


class DirectScript(BaseModel):
    """The answer to `prompts/direct_script.md`."""

    keyframes: list[DirectKeyframe]


def plan_events(model: LanguageModel, theme: str, most: int) -> tuple[Beat, ...]:
    """The events of a theme in the order of time, as the model reads it. Raises ModelError."""

    def problems(answer: PlannedEvents) -> list[str]:
        found = [] if 1 <= len(answer.events) <= most else [f"events: {len(answer.events)} of them, wanted 1 to {most}"]
        for index, event in enumerate(answer.events):
            if not 0 < len(event.text.strip()) <= 300:
                found.append(f"events.{index}.text: must have 1 to 300 letters")
            if emotion_of(event.emotion) is None:
                found.append(f"events.{index}.emotion: {event.emotion!r} is none of {', '.join(EMOTIONS)}")
        return found

    prompt = prompts.render("plan_events", theme=theme, emotions=", ".join(EMOTIONS), most=str(most))
    answer = ask(model, prompt, PlannedEvents, problems)
    return tuple(
        Beat(text=" ".join(event.text.split()), emotion=emotion_of(event.emotion) or Emotion.NEUTRAL)
        for event in answer.events
    )


def arrange(
    model: LanguageModel, theme: str, events: Sequence[Beat], offers: Mapping[int, Sequence[Found]], count: int
) -> list[tuple[int, Found]]:
    """The short scripts a model chooses among those offered for each event, in order. Raises ModelError."""

    def problems(answer: Arrangement) -> list[str]:
        choices = answer.choices
        found = [] if len(choices) == count else [f"choices: {len(choices)} of them, wanted {count}"]
        for index, choice in enumerate(choices):
            ids = [offer.script.id for offer in offers.get(choice.event, ())]
            if choice.script not in ids:
                listed = ", ".join(ids) or "none: leave this event out"
                found.append(
                    f"choices.{index}: {choice.script!r} was not offered for event {choice.event}; offered: {listed}"
                )
        if [choice.event for choice in choices] != sorted(choice.event for choice in choices):
            found.append("choices: the event numbers go down somewhere")
        if len({choice.script for choice in choices}) < len(choices):
            found.append("choices: a short script is used twice")
        left = sorted(offers.keys() - {choice.event for choice in choices})
        if left and len(offers) <= count:
            found.append(f"choices: nothing for event {', '.join(map(str, left))}")
        return found

    prompt = prompts.render(
        "arrange_story",
        theme=theme,
        events="\n".join(f"{index}. {event.text} ({event.emotion})" for index, event in enumerate(events)),
        candidates="\n".join(_offered(index, found) for index, found in offers.items()),
        count=str(count),
    )
    answer = ask(model, prompt, Arrangement, problems)
    by_id = {(event, found.script.id): found for event, offer in offers.items() for found in offer}
    return [(choice.event, by_id[choice.event, choice.script]) for choice in answer.choices]


def _offered(event: int, offers: Sequence[Found]) -> str:
    lines = [
        f"  {found.script.id} [{found.script.room}, {found.script.emotion}] {found.script.summary}" for found in offers
    ]
    return "\n".join([f"event {event}:", *lines])


def direct(model: LanguageModel, theme: str) -> tuple[Keyframe, ...]:
    """The keyframes a model writes by itself (SIMS 10), in known words, not yet repaired. Raises ModelError."""

    def problems(answer: DirectScript) -> list[str]:
        if not 1 <= len(answer.keyframes) <= MAX_KEYFRAMES:
            return [f"keyframes: {len(answer.keyframes)} of them, wanted 1 to {MAX_KEYFRAMES}"]
        try:
            keyframes = _keyframes(answer)
        except ValidationError as error:
            return problems_of(error)
        return [
            f"keyframes.{one.keyframe}.{one.field}: {one.fault}" for one in check(keyframes) if one.field != "skill"
        ]

    prompt = prompts.render(
        "direct_script",
        theme=theme,
        skills=", ".join(Skill),
        emotions=", ".join(EMOTIONS),
        furniture=furniture_offered(),
        captions=captions_offered(_MAX_CAPTIONS),
        most=str(MAX_KEYFRAMES),
    )
    return tuple(_keyframes(ask(model, prompt, DirectScript, problems)))


def _keyframes(answer: DirectScript) -> list[Keyframe]:
    return [read_keyframe(keyframe.model_dump()) for keyframe in answer.keyframes]
