"""Tables that are data are read into dataclasses, and what does not fit is refused by file, place and fault."""

from __future__ import annotations

from pathlib import Path

import pytest

from scene_graphs import data_tables
from scene_graphs.data_tables import TableError, read_table, table


@table
class Row:
    name: str
    time: float
    pelvis: tuple[float, float, float] = (0.0, 0.0, 0.0)


@table
class Sheet:
    seconds: float
    pose: tuple[Row, ...]


GOOD = 'seconds = 1\n[[pose]]\nname = "hinge"\ntime = 0.42\npelvis = [0.42, 0, 0.42]\n'


@pytest.fixture
def read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(data_tables, "files", lambda package: tmp_path / package)
    monkeypatch.setattr(data_tables, "read_table", read_table.__wrapped__)

    def reading(text: str) -> Sheet:
        folder = tmp_path / "somewhere" / "data"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "sheet.toml").write_text(text)
        return data_tables.read_table("somewhere", "sheet.toml", Sheet)

    return reading


def test_sections_and_rows_become_dataclasses(read) -> None:
    assert read(GOOD) == Sheet(1.0, (Row("hinge", 0.42, (0.42, 0.0, 0.42)),))


@pytest.mark.parametrize(
    ("fault", "place"),
    [
        (GOOD + "speed = 3\n", "pose.0.speed"),
        (GOOD.replace("time = 0.42\n", ""), "pose.0.time"),
        (GOOD.replace("0.42\n", "nan\n", 1), "pose.0.time"),
        (GOOD.replace("[0.42, 0, 0.42]", "[0.42, 0]"), "pose.0.pelvis"),
        (GOOD.replace("seconds = 1", "seconds = 'long'"), "seconds"),
        ("seconds = ", "Invalid value"),
    ],
)
def test_what_does_not_fit_is_refused_by_file_and_place(read, fault: str, place: str) -> None:
    with pytest.raises(TableError, match=r"somewhere/data/sheet\.toml: .*" + place.replace(".", r"\.")):
        read(fault)
