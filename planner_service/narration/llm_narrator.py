"""A long script told by a language model: asked for, held against the keyframes, and tied to them by its sentences."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from pydantic import BaseModel, Field

import prompts
from motion_backend.motion import Character, Skill
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.structured_output import ask
from planner_service.narration.keyframe_phrases import Places
from planner_service.narration.narrative_voice import Voice
from planner_service.narration.told import Span, Told
from planner_service.scripts.script import Beat, LongScript, legible
from scene_graphs.furniture import catalogue, display_name, is_minor

_SHOWN: Final = 8
"""Problems that the model is told of at once."""
_USED: Final = (Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH)
_COMMON: Final = frozenset({"bar", "bench", "chest", "monitor", "shelf", "stool", "tv"})
"""Words that a story may use of something that is no piece of furniture, or is part of one."""
_MIN_SHARE: Final = 0.6
"""Of the pieces that are used, how many a story has to name."""


class _ModelStory(BaseModel):
    title: str = Field(min_length=1, max_length=120)
    text: str = Field(min_length=80, max_length=8000)


@dataclass(frozen=True)
class _Moment:
    """A keyframe as a model is told of it."""

    skill: Skill
    emotion: str
    caption: str
    furniture: str
    asked: str
    """What the script calls the furniture: "the bed" is said of a children's bed, too."""

    def __str__(self) -> str:
        return ", ".join((self.skill, self.emotion, self.caption, self.furniture))


def narrate_with_model(
    script: LongScript, character: Character, model: LanguageModel, places: Places | None = None
) -> Told:
    """The story of a script by a language model. Raises ModelAnswerError when it gives none that can be used.

    It is told what was wrong where the name is missing, a piece of furniture is used that no keyframe uses, one that is
    used is left out, or they come in another order.
    """
    voice = Voice.of(character)
    moments = [
        _Moment(k.skill, k.emotion, k.caption, (places or {}).get(i, (k.furniture, ""))[0], k.furniture)
        for i, k in enumerate(script.keyframes)
    ]
    prompt = prompts.read("narrate_story").fill(
        name=voice.name,
        pronouns=voice.pronouns,
        theme=script.theme,
        beats="\n".join(f"- {beat.kind}, {_how_told(beat)}: {_whole(beat)}" for beat in script.beats),
        keyframes="\n".join(f"- {moment}" for moment in moments),
    )
    answer = ask(model, prompt, _ModelStory, lambda story: _problems(story.text, voice, moments, script.theme)[:_SHOWN])
    text = "\n\n".join(str(legible(part)) for part in re.split(r"\n\s*\n", answer.text.strip()))
    return Told(str(legible(answer.title)), text, _found_spans(text, [moment.furniture for moment in moments]))


def _how_told(beat: Beat) -> str:
    return "acted" if beat.asked and not (beat.why or beat.who or beat.stood_for) else "not acted"


def _whole(beat: Beat) -> str:
    return beat.text + (f" ({beat.who})" if beat.who and beat.who.lower() not in beat.text.lower() else "")


def _problems(text: str, voice: Voice, moments: Sequence[_Moment], said: str) -> list[str]:
    """What is unfaithful in a story, each with what would be right; `said` is what may be spoken of besides."""
    found: list[str] = []
    if not re.search(rf"\b{re.escape(voice.name)}(?!\w)", text, 0 if voice.name[:1].isupper() else re.IGNORECASE):
        found.append(f"text: the name {voice.name} is nowhere in it; tell of {voice.name}")
    used = {m.furniture: m.asked for m in moments if m.skill in _USED and m.furniture.lower() != "floor"}
    plain = list(used.values())  # what several pieces are called tells none of them apart
    used = {name: asked if plain.count(asked) == 1 else name for name, asked in used.items()}
    missing = [name for name, asked in used.items() if not _mentions(text, name, asked)]
    if len(missing) > (1 - _MIN_SHARE) * len(used):
        found.append(f"text: nothing is told of the {', the '.join(missing)}; say what {voice.name} does there")
    found += _disorder(text, [names for names in used.items() if names[0] not in missing])
    known = " ".join([*(f"{moment.furniture} {moment.asked}" for moment in moments), said]).lower()
    lacking = [word for word in _furniture_in(text) if word not in known]
    return found + [f"text: there is a {word}, but no keyframe is at one; leave it out" for word in lacking]


def _mentions(text: str, *names: str) -> list[int]:
    """Where a piece is named, by any of its names."""
    return [match.start() for match in re.finditer(rf"\b(?:{'|'.join(map(re.escape, names))})", text, re.IGNORECASE)]


def _disorder(text: str, pieces: Sequence[tuple[str, str]]) -> list[str]:
    """The first piece that is told only before one that is used before it."""
    at, before = -1, ""
    for name, asked in pieces:
        later = [place for place in _mentions(text, name, asked) if place > at]
        if not later:
            return [f"text: the {name} comes before the {before}, which is used first; keep the order of the keyframes"]
        at, before = later[0], name
    return []


def _furniture_in(text: str) -> list[str]:
    """The furniture that a text names, each once; small things and words of many meanings left out."""
    words = {display_name(category).lower() for category in catalogue().categories if not is_minor(category)} - _COMMON
    return [word for word in sorted(words) if re.search(rf"\b{re.escape(word)}s?\b", text, re.IGNORECASE)]


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
