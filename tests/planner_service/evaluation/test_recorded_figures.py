"""Evaluations of a few small inputs give the figures that they gave when somebody last looked at them."""

from __future__ import annotations

from dataclasses import asdict
from itertools import islice
from typing import Any, Final

import numpy as np
import pytest
from recorded import agrees

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.metrics.kernel_mmd import Distance
from motion_backend.metrics.walk_classifier import Told, Yardstick
from motion_backend.mocap.dataset_file import Dataset, Entry
from motion_backend.motion import Emotion, Motion
from motion_backend.skeleton import build_skeleton
from planner_service.composition.compose import compose
from planner_service.composition.request import Request
from planner_service.evaluation import walk_comparison
from planner_service.evaluation.acted_motion import act_for_training
from planner_service.evaluation.labels import Alternative, LabelledBeat, LabelledTheme, Query
from planner_service.evaluation.motion_ablation import ABLATIONS
from planner_service.evaluation.planning_evaluation import (
    beat_figures,
    executable,
    judged_themes,
    search_figures,
    theme_misses,
)
from planner_service.evaluation.script_evaluation import LEVELS, ScriptResult, ScriptTrial, sum_up_scripts
from planner_service.evaluation.walk_comparison import compare_walks
from planner_service.evaluation.walk_evaluation import (
    CAPTION,
    Compared,
    Take,
    WalkReport,
    Walks,
    apart,
    jerk_bins,
    matched_walks,
    mood_walks,
    recorded_walks,
    spread,
    walks_of,
)
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script_library import Features, ScriptLibrary
from scene_graphs.layout_library import built_in_index

SITS, LIES, WAVES = (
    Alternative(skill=("sitdown",)),
    Alternative(skill=("liedown",), furniture=("bed",)),
    Alternative(skill=("loco",), furniture=("window",)),
)


def beat(text: str, *shown_by: Alternative) -> LabelledBeat:
    return LabelledBeat(text=text, actable=bool(shown_by), shown_by=shown_by)


THEMES: Final = (
    LabelledTheme(
        id="tired", theme="She sits down on the sofa, thinks of her youth and lies down on the bed.", split="tune",
        beats=(beat("sits down", SITS), beat("thinks of her youth"), beat("lies down", LIES)),
    ),
    LabelledTheme(
        id="window", theme="He waves to a friend from the window, dances and eats at the table.", split="held_out",
        beats=(beat("waves", WAVES), beat("dances", LIES), beat("eats", SITS)), forbidden=(SITS,),
    ),
    LabelledTheme(id="nonsense", theme="Zxqv wvzk.", split="held_out", refuse=True),
    LabelledTheme(id="sound", theme="He falls asleep on the couch.", split="tune", refuse=True),
)  # fmt: skip
QUERIES: Final = tuple(
    Query(id=f"{number}-{split[:4]}", query=text, kind="plain", split=split, right=(right,))
    for split in ("tune", "held_out")
    for number, (text, right) in enumerate(
        [(one.summary, one.id) for one in built_in()[::90]] + [("somebody reads a letter", built_in()[3].id)]
    )
)


def test_figures_of_planning_are_as_recorded() -> None:
    library = ScriptLibrary(built_in()[::9], Features(HashingEncoder()))
    found, missed = search_figures(QUERIES, library)
    themes = judged_themes(THEMES, lambda theme: compose(theme, library, Request()))
    figures = [*found, *beat_figures(themes), executable(themes, built_in_index())]
    misses = [*missed, *theme_misses(themes)]
    agrees("planning_figures", {
        "figures": {one.name: plain(asdict(one)) for one in figures},
        "misses": [str(miss) for miss in misses],
    })  # fmt: skip


def test_figures_of_scripts_are_as_recorded() -> None:
    results = []
    for errors, level in enumerate(LEVELS):
        for seed in range(7):
            count, trial = 2 + seed % 3, ScriptTrial("bedroom-0000", seed, level)
            done, done_any = min(seed, count), min(seed + 1, count)
            results.append(ScriptResult(trial, count, done, done_any, (0.01 * seed,) * errors))
    figures = {f"{one.name}, {one.level}": plain(asdict(one)) for one in sum_up_scripts(results)}
    agrees("script_figures", figures)


def walker(person: int, split: str, motion: Motion) -> Entry:
    return Entry(
        f"{person}", "loco", "neutral", Emotion.NEUTRAL, ("a person walks",), f"person {person}", "real mocap", "", "",
        (), split, motion, np.zeros((len(motion), 2), dtype=np.bool_),
    )  # fmt: skip


def test_figures_of_walks_are_as_recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of rules beside rules that pass for people; how surely they are told apart is another's to say."""
    asked: list[Any] = []

    def told_apart(people: Any, own: Any, limb: str) -> Told:
        asked.append([limb, len(people), len(own)])
        return Told(0.75, 0.7, 0.8, {})

    monkeypatch.setattr(walk_comparison, "told_apart", told_apart)
    takes: list[Take] = []

    def kept(name: str, some: Any) -> Any:
        takes.extend(some)
        return walks_of(name, some)

    monkeypatch.setattr("planner_service.evaluation.walk_evaluation.walks_of", kept)
    ours = matched_walks(np.linspace(0.9, 1.5, 8), CAPTION, build_skeleton())
    entries = [walker(i, ("train", "test")[i % 2], take.motion) for i, take in enumerate(takes)]
    dataset = Dataset(entries[0].motion.skeleton, tuple(entries))
    people = recorded_walks(dataset)
    sad = mood_walks(CAPTION, Emotion.SAD, 1)
    found = compare_walks(dataset, ["procedural"], CAPTION, rooms=1, seeds=1)
    agrees("walk_figures", {
        "ours": [short(*row) for row in ours.features],
        "apart": short(*apart(people, sad)),
        "spread": short(*spread(people, sad)),
        "jerk": [plain(asdict(one)) for one in jerk_bins(people, sad)],
        "compared": {f"{one.name} {one.place}": plain(one.to_dict()) for one in found},
        "asked": asked,
        "report": plain(report_of(people, ours, sad).to_dict()),
    })  # fmt: skip


def report_of(people: Walks, ours: Walks, sad: Walks) -> WalkReport:
    """Of walks that are at hand, with a classifier's figures made up."""
    far, told = Distance(0.3, 0.2, 0.4), Told(0.8, 0.7, 0.9, {"anna": 0.8})
    return WalkReport(
        people, far, (Compared(ours, far, told), Compared(sad, far, None)), jerk_bins(people, sad),
        Yardstick(0.7, 0.65, 0.75, {"anna": 0.7}), {"legs": told}, (), CAPTION, "procedural",
    )  # fmt: skip


def test_what_is_left_out_to_see_what_it_is_worth_is_as_recorded() -> None:
    agrees("ablations", {one.name: plain(asdict(one)) for one in ABLATIONS})


def test_what_is_acted_to_be_learned_from_is_as_recorded() -> None:
    made = list(islice(act_for_training(1.0, 4), 3))
    agrees("acted", {
        stretch.name: [len(stretch), stretch.room,
                       *(f"{one.kind} {one.start}-{one.stop} {one.caption}" for one in stretch.passages)]
        for stretch in made
    })  # fmt: skip


def plain(value: Any) -> Any:
    """Numbers rounded, all the way down."""
    if isinstance(value, dict):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    return round(float(value), 4) if isinstance(value, float | np.floating) else value


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
