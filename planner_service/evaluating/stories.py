"""Every labelled theme woven and told without a language model, beside stories that `direct` improvises (SIMS 10)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from motion_backend.language.text import Vectors
from motion_backend.motion import Character
from planner_service.evaluating.covering import Coverage, coverage
from planner_service.evaluating.improvising import improviser
from planner_service.evaluating.labels import LabelledTheme
from planner_service.evaluating.likeness import alike, nearness, sentence_vectors
from planner_service.furnish import FurnishError, furnish
from planner_service.scripts.acting import UnreachableError, act
from planner_service.scripts.checking import check
from planner_service.scripts.composing import Request, compose
from planner_service.scripts.events import ThemeError
from planner_service.scripts.keyframe import LongScript
from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.narrating import narrate
from scene_graphs.homes import HomeError
from scene_graphs.navigation import NoPath
from scene_graphs.retrieval import LayoutIndex, NoSuitableRoom

SEEDS: Final = (0, 1, 2, 3, 4)


@dataclass(frozen=True)
class Woven:
    """A theme's long script of one seed, with its story."""

    script: LongScript
    story: str
    coverage: tuple[Coverage, ...]

    @property
    def valid(self) -> bool:
        """Whether checking finds nothing that keeps it from being acted out."""
        return bool(self.script.keyframes) and not check(self.script)


@dataclass(frozen=True)
class Theme:
    """What became of one labelled theme."""

    label: LabelledTheme
    woven: tuple[Woven, ...]
    """One a seed; none where the theme was not understood."""
    fault: str
    """Why its first script cannot be acted out in any home; empty when it can."""
    alike: float
    """How well its stories are told in each other."""
    direct_alike: float
    """The same of the stories improvised for it."""
    nearness: tuple[float, ...]
    """For each story the share of the other themes it is farther from than from its own."""


def tell_themes(labels: Sequence[LabelledTheme], library: ScriptLibrary, rooms: LayoutIndex) -> tuple[Theme, ...]:
    """All themes, planned with every seed of `SEEDS`, told, and compared with each other."""
    woven = [_woven(label, library) for label in labels]
    themes = [sentence_vectors(label.text, library.encoder) for label in labels]
    told = []
    for own, (label, each) in enumerate(zip(labels, woven, strict=True)):
        stories = [sentence_vectors(one.story, library.encoder) for one in each]
        told.append(
            Theme(
                label,
                each,
                _fault(each[0].script, rooms) if each else "the theme was not understood",
                _alike(stories),
                _alike(_improvised(label.text, library)) if each else 1.0,
                tuple(round(nearness(story, themes, own), 4) for story in stories),
            )
        )
    return tuple(told)


def _woven(label: LabelledTheme, library: ScriptLibrary) -> tuple[Woven, ...]:
    try:
        scripts = [compose(label.text, library, Request(seed=seed)) for seed in SEEDS]
    except ThemeError:
        return ()
    return tuple(
        Woven(script, narrate(script, Character(), script.seed).text, coverage(label.events, script))
        for script in scripts
    )


def _improvised(theme: str, library: ScriptLibrary) -> list[Vectors]:
    """The stories that `direct` makes with the improvising model, told by the same narrator."""
    stories = []
    for seed in SEEDS:
        asked = Request(seed=seed, method="direct")
        script = compose(theme, library, asked, improviser(theme, seed), insist=True)
        stories.append(sentence_vectors(narrate(script, Character(), seed).text, library.encoder))
    return stories


def _alike(stories: Sequence[Vectors]) -> float:
    """1 where there are no stories: what was not told is no variety."""
    return alike(stories) if len(stories) else 1.0


def _fault(script: LongScript, rooms: LayoutIndex) -> str:
    try:
        stage = furnish(script, rooms, seed=script.seed)
        act(stage.script.keyframes, stage.places, stage.home, script.seed)
    except (FurnishError, NoSuitableRoom, HomeError, NoPath, UnreachableError) as error:
        return str(error)
    return ""
