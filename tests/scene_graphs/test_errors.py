"""What a user did wrong is said in facts; its text is made of them and never taken apart again."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.mocap.clip import ClipError
from scene_graphs.errors import FieldPath, UserError
from scene_graphs.json_fields import LayoutError, read_number, read_rows, read_texts
from scene_graphs.retrieval.layout_index import NoSuitableRoom

NAMES = st.text("abcdefgh_", min_size=1, max_size=6)
STEPS = st.lists(NAMES | st.integers(0, 99), min_size=1, max_size=5).map(lambda steps: ("body", *steps))


def test_a_text_is_made_of_place_fault_and_remedy() -> None:
    assert str(UserError("it is empty")) == "it is empty"
    assert str(UserError("it is empty", "write a word")) == "it is empty; write a word"
    assert str(UserError("it is empty", "write a word", at="theme")) == "theme: it is empty; write a word"
    assert UserError("it is empty", "write a word", at="theme").said == "it is empty; write a word"
    place = FieldPath(file="a.glb") / "nodes" / 3
    for kind in (LayoutError, ClipError):
        assert str(kind("has two parents", at=place)) == "a.glb nodes[3] has two parents"
        assert kind("has two parents", at=place).within == "nodes[3] has two parents"
        assert kind("is cut off", at=FieldPath(file="a.glb")).within == "is cut off"


@given(STEPS)
def test_a_path_is_written_as_in_python_and_points_as_in_json(steps: tuple[str | int, ...]) -> None:
    value = "here"
    row: Any = value
    for step in reversed(steps):
        row = {step: row} if isinstance(step, str) else [None] * step + [row]
    path = FieldPath()
    for step in steps:
        path = path / step
    for step in path.steps:
        row = row[step]
    assert row == value
    assert path.pointer.split("/")[1:] == [str(step) for step in steps]
    assert str(path) == "".join(f"[{one}]" if isinstance(one, int) else f".{one}" for one in steps)[1:]


def test_a_pointer_writes_signs_of_its_own_as_escapes() -> None:
    assert (FieldPath() / "a/b" / "c~d").pointer == "/a~1b/c~0d"


def test_nowhere_is_no_path() -> None:
    assert not FieldPath()
    assert not UserError("it is empty").at
    assert FieldPath(file="a.glb")
    assert FieldPath((0,))


@pytest.mark.parametrize(
    "error",
    [
        UserError("it is empty", "write a word", at="theme"),
        LayoutError("must be a number", at=FieldPath(("body", "size"))),
        NoSuitableRoom("no study has all of: bed", "leave them out", ()),
    ],
)
def test_an_error_keeps_its_facts_on_the_way_between_processes(error: UserError) -> None:
    again = copy.copy(error)  # as pickle does it
    assert (type(again), str(again), again.at, again.remedy) == (type(error), str(error), error.at, error.remedy)


def test_a_reader_of_fields_says_where_it_was() -> None:
    root = FieldPath(("body",))
    ((row, place),) = read_rows({"objects": [{"tags": ["a", 5]}]}, "objects", root, 3)
    with pytest.raises(LayoutError, match=r"^body\.objects\[0\]\.tags\.1 must be a text") as error:
        read_texts(row, "tags", place, 3)
    assert error.value.at.pointer == "/body/objects/0/tags/1"
    with pytest.raises(LayoutError, match=r"^body\.height must lie between 0 and 3, got 7$") as error:
        read_number(7, root / "height", 0.0, 3.0)
    assert (error.value.at, error.value.fault) == (root / "height", "must lie between 0 and 3, got 7")
