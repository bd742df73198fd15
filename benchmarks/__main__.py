"""`python -m benchmarks [--markdown]`: every figure beside its limit; exit code 1 if one is missed."""

from __future__ import annotations

import os
import platform
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.clips import clip_figures
from benchmarks.demo import measure_demo
from benchmarks.film import film_figures
from benchmarks.geometry import geometry_figures
from benchmarks.learned import learned_figures
from benchmarks.moving import skill_figures
from benchmarks.reading import reading_figures
from benchmarks.retrieval import retrieval_figures
from benchmarks.service import service_figures
from benchmarks.simulated import physics_figures
from benchmarks.stories import file_figures, make_stories, quality_figures, speed_figures
from benchmarks.tables import figure_rows, markdown, plain, story_rows
from benchmarks.weaving import weaving_figures
from planner_service.library.library import Shelves
from planner_service.pipeline import Pipeline


def main() -> int:
    """Measure and print; 0 if every limit is kept, else 1."""
    started = time.perf_counter()
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
    print(f"{machine}\n")
    figures = measure_demo()
    with tempfile.TemporaryDirectory(prefix="sims-bench-") as folder:
        pipeline = Pipeline(Shelves(cache=Path(folder)))
        made = make_stories(pipeline)
        figures += speed_figures(made)
        figures += skill_figures(made)
        figures += physics_figures()
        figures += learned_figures()
        figures += clip_figures(Path(folder))
        figures += weaving_figures()
        figures += retrieval_figures()
        figures += geometry_figures()
        figures += reading_figures()
        figures += film_figures(Path(folder))
        figures += file_figures(pipeline, Path(folder))
        figures += service_figures(Path(folder))
    figures += quality_figures(made)
    as_markdown = "--markdown" in sys.argv[1:]
    for rows, left in ((figure_rows(figures), (0, 3, 4)), (story_rows(made), (0,))):
        print(markdown(rows) if as_markdown else plain(rows, left), end="\n\n")
    missed = [figure.name for figure in figures if figure.missed]
    print(f"{'missed: ' + ', '.join(missed) if missed else 'every limit is kept'}", end="")
    print(f" · {time.perf_counter() - started:.0f} s")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
