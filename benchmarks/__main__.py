"""`python -m benchmarks`: every figure beside its limit; exit code 1 if one is missed."""

from __future__ import annotations

import os
import platform
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.demo import measure_demo
from benchmarks.figure import Figure
from benchmarks.retrieval import retrieval_figures
from benchmarks.stories import Timed, file_figures, make_stories, quality, quality_figures, speed_figures
from planner_service.stories import Studio


def main() -> int:
    """Measure and print; 0 if every limit is kept, else 1."""
    started = time.perf_counter()
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
    print(f"{machine}\n")
    figures = measure_demo()
    with tempfile.TemporaryDirectory(prefix="sims-bench-") as folder:
        studio = Studio(cache=Path(folder))
        made = make_stories(studio)
        figures += speed_figures(made)
        figures += retrieval_figures(studio)
        figures += file_figures(made, Path(folder))
    figures += quality_figures(made)
    print_figures(figures)
    print_stories(made)
    missed = [figure.name for figure in figures if figure.missed]
    print(f"\n{'missed: ' + ', '.join(missed) if missed else 'every limit is kept'}", end="")
    print(f" · {time.perf_counter() - started:.0f} s")
    return 1 if missed else 0


def print_figures(figures: Sequence[Figure]) -> None:
    """One line a figure; of the seven stories the worst counts."""
    print(f"{'what':<38} {'limit':>10} {'measured':>10}  {'':<4}  how")
    for one in figures:
        print(f"{one.name:<38} {one.shown_limit:>10} {one.shown:>10}  {one.verdict:<4}  {one.note}".rstrip())


def print_stories(made: Sequence[Timed]) -> None:
    """One line a story: what was reached and how well, and what each stage took."""
    titles = ("seconds", "reached", "contact", "pen_mean", "pen_share", "skate", "plan", "act", "move", "judge")
    print("\nstory      " + "".join(f"{title:>10}" for title in titles))
    for one in made:
        report, plan = one.story.report, min(one.plans)
        _, contact, pen_mean, pen_share, skate = quality(report)
        reached = f"{report['reached']}/{report['keyframes']}"
        marks = (f"{contact:.2f} cm", f"{pen_mean:.2f} cm", f"{pen_share:.2f} %", f"{skate:.2f} %")
        stages = [f"{1000 * seconds:.0f} ms" for seconds in (plan, one.acted, one.moved, one.judged)]
        cells = (f"{report['seconds']:.0f}", reached, *marks, *stages)
        print(f"{one.name:<11}" + "".join(f"{cell:>10}" for cell in cells))


if __name__ == "__main__":
    sys.exit(main())
