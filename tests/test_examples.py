"""The stories in docs/examples are what the program tells today."""

from __future__ import annotations

import runpy
from pathlib import Path
from types import SimpleNamespace

import pytest
from encoded import encoded
from PIL import Image

from planner_service.library.library import Shelves
from planner_service.pipeline import Pipeline

FOLDER = Path(__file__).resolve().parents[1] / "docs"
stories = SimpleNamespace(**runpy.run_path(str(FOLDER / "stories.py")))
SMALL = 300_000
"""Bytes."""
names = [example.file for example in stories.EXAMPLES]


@pytest.fixture(scope="module")
def pipeline() -> Pipeline:
    pipeline = Pipeline(Shelves(cache=encoded()))
    if pipeline.shelves.scripts().encoder.name == "hashing":
        pytest.skip("all-MiniLM-L6-v2 is not installed")
    return pipeline


@pytest.mark.parametrize("number", [0, 4])
def test_an_example_is_told_today_as_its_page_says(pipeline: Pipeline, number: int) -> None:
    example = stories.EXAMPLES[number]
    page = (FOLDER / "examples" / f"{example.file}.md").read_text(encoding="utf-8")
    assert stories.page(example, stories.told(example, pipeline)) == page, "run python docs/stories.py"


def test_there_are_ten_examples_and_a_page_for_each() -> None:
    pages = {path.stem for path in (FOLDER / "examples").glob("*.md")} - {"README"}
    assert len(names) == 10
    assert pages == set(names)
    assert (FOLDER / "examples" / "README.md").read_text(encoding="utf-8") == stories.index()


def test_every_example_has_a_small_picture_that_moves() -> None:
    for name in names:
        path = FOLDER / "examples" / f"{name}.webp"
        with Image.open(path) as picture:
            assert getattr(picture, "n_frames", 1) >= 30, name
        assert path.stat().st_size <= SMALL, name
