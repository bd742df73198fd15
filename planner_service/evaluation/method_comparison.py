"""Ways of planning held side by side: what of the themes each acts, how alike its stories are, what it costs (SIMS 10).

Pairs of films of one theme under neutral names, with a sheet to mark them by.
"""

from __future__ import annotations

import csv
import itertools
import re
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from motion_backend.formats.glb_film import film_glb
from motion_backend.language.sentence_encoder import SentenceEncoder, Vectors
from motion_backend.motion import Character
from planner_service.composition.request import METHODS
from planner_service.evaluation.beat_judgement import Judgement
from planner_service.evaluation.labels import LabelledTheme
from planner_service.evaluation.planning_evaluation import fulfilled, ratio
from planner_service.llm.client import ServedModel
from planner_service.narration.narrator import narrate
from planner_service.pipeline import Pipeline, Story, StoryRequest
from planner_service.themes.beats import ThemeError
from scene_graphs.errors import UserError

_SENTENCE: Final = re.compile(r"(?<=[.!?])\s+")
QUESTIONS: Final = (
    "Does the body move as a real person would? (Table 4: physical realism)",
    "Does the film show what the theme says, in its order? (Table 4: script alignment)",
    "Is the film free of deeds that the theme does not ask for? (Table 10)",
    "Is it rich in fitting detail: objects, touches, manner? (Tables 11 and 12)",
    "Do the feelings show and change as they should? (Table 13)",
)
"""Each is marked from 1 (poor) to 5 (excellent)."""


@dataclass(frozen=True)
class Method:
    """One way of planning."""

    name: str
    """As in a request."""
    pipeline: Pipeline
    """With a language model or without."""

    @property
    def title(self) -> str:
        """How it is told apart: "auto by rules", "direct by openai:gpt-5"."""
        return f"{self.name} by {self.pipeline.model.name if self.pipeline.model else 'rules'}"


@dataclass(frozen=True)
class Compared:
    """What one method makes of all themes."""

    method: str
    acted: float
    """Share of the actable beats that are acted in order."""
    named: float
    """Share of what is not acted that is named as such."""
    forbidden: int
    """Keyframes that show what must not be seen."""
    unasked: float
    """Share of screen time that nobody asked for."""
    deeds: float
    """Keyframes a beat, without walks to furniture."""
    alike: float
    """How well a story is told in the stories of the other themes: repetition."""
    wrong: int
    """Themes played that should be refused, or refused that should be played."""
    calls: float
    """Questions to a language model, a theme."""
    tokens: float
    """Read and written by a language model, a theme."""
    seconds: float
    """To plan a theme."""


def methods_of(pipeline: Pipeline) -> tuple[Method, ...]:
    """Every method by rules, and by the pipeline's language model where it has one."""
    models = (None,) if pipeline.model is None else (None, pipeline.model)
    return tuple(Method(name, replace(pipeline, model=model)) for model in models for name in METHODS)


def compare(method: Method, labels: Sequence[LabelledTheme], encoder: SentenceEncoder, seed: int = 0) -> Compared:
    """Plan every theme by one method. A model's mistakes are the method's: where it fails, the rules step in."""
    if method.pipeline.model is None:  # what is loaded once is no part of its seconds
        _plan(method, labels[0], seed)
    plans = [_plan(method, label, seed) for label in labels]
    judged = [plan.judgement for plan in plans]
    stories = [narrate(one.script, Character(), seed).text for one in judged if one.script is not None]
    played = [one for one in judged if not one.label.refuse]
    return Compared(
        method=method.title,
        acted=fulfilled([(len(one.acted), len(one.actable)) for one in played]),
        named=fulfilled([(len(one.named), len(one.missing)) for one in played]),
        forbidden=sum(len(one.forbidden) for one in played),
        unasked=ratio([(one.unasked_seconds, one.seconds) for one in played]),
        deeds=ratio([(one.deeds, len(one.actable)) for one in played]),
        alike=alike([sentence_vectors(text, encoder) for text in stories]) if len(stories) > 1 else 0.0,
        wrong=sum(not one.refused_rightly for one in judged),
        calls=ratio([(plan.calls, 1) for plan in plans]),
        tokens=ratio([(plan.tokens, 1) for plan in plans]),
        seconds=ratio([(plan.seconds, 1) for plan in plans]),
    )


@dataclass(frozen=True)
class _Plan:
    judgement: Judgement
    calls: int
    tokens: int
    seconds: float


def _plan(method: Method, label: LabelledTheme, seed: int) -> _Plan:
    own = method.pipeline.for_story(seed)
    begun = time.perf_counter()
    try:
        script = own.script(StoryRequest(label.theme, method=method.name, seed=seed))
    except ThemeError:
        script = None
    seconds = time.perf_counter() - begun
    spent = own.model.spending if isinstance(own.model, ServedModel) else None
    return _Plan(Judgement(label, script), spent.calls if spent else 0, spent.tokens if spent else 0, seconds)


def sentence_vectors(text: str, encoder: SentenceEncoder) -> Vectors:
    """One unit row a sentence: an encoder reads only so much at once, and a mean would favour long texts. (N, D)."""
    return encoder.encode([part for part in _SENTENCE.split(text.strip()) if part] or [text])


def told_in(text: Vectors, other: Vectors) -> float:
    """How well each sentence of a text is told by some sentence of another, on average, -1 to 1. (N, D), (M, D)."""
    return float((text @ other.T).max(axis=1).mean())


def alike(texts: Sequence[Vectors]) -> float:
    """Mean of how well every text is told in every other, to 1e-4. ValueError when there are fewer than two."""
    if len(texts) < 2:
        raise ValueError(f"texts: {len(texts)} of them; likeness needs two")
    return round(float(np.mean([told_in(one, other) for one, other in itertools.permutations(texts, 2)])), 4)


def write_pairs(
    methods: tuple[Method, Method], labels: Sequence[LabelledTheme], count: int, folder: Path, seed: int = 0
) -> Iterator[str]:
    """Films of up to `count` themes by two methods, as 01-A.glb and 01-B.glb, yielding the id of each theme done.

    Which is which is by chance and stands in key.csv alone; sheet.csv asks `QUESTIONS` of every film, 1 to 5. A theme
    that one of the two cannot make is passed over.
    """
    folder.mkdir(parents=True, exist_ok=True)
    luck = np.random.default_rng(seed)
    sheet: list[Sequence[object]] = [("pair", "theme", "film", *QUESTIONS, "remarks")]
    key: list[Sequence[object]] = [("pair", "theme", "A", "B")]
    for label in (one for one in labels if not one.refuse):
        if len(key) > count:
            break
        pair = methods if luck.random() < 0.5 else methods[::-1]
        try:
            made = [one.pipeline.make(StoryRequest(label.theme, method=one.name, seed=seed)) for one in pair]
        except UserError:
            continue
        number = f"{len(key):02d}"
        for letter, story in zip("AB", made, strict=True):
            _write_film(story, folder, f"{number}-{letter}")
            sheet.append((number, label.theme, letter, *[""] * len(QUESTIONS), ""))
        key.append((number, label.id, *(one.title for one in pair)))
        yield label.id
    for name, rows in (("sheet.csv", sheet), ("key.csv", key)):
        with (folder / name).open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows(rows)


def _write_film(story: Story, folder: Path, name: str) -> None:
    """The film and the told text, neither of which says what planned it."""
    (folder / f"{name}.glb").write_bytes(film_glb(story.planned.home, story.motion))
    (folder / f"{name}.txt").write_text(story.planned.told.text + "\n", encoding="utf-8")
