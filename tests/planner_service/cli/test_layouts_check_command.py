"""`sims layouts check`."""

from __future__ import annotations

from math import pi
from pathlib import Path

from typer.testing import CliRunner

from planner_service.cli.layouts import app
from scene_graphs.layout import Layout, Placed, write_layouts

TABLE = Placed("table", "dining_table", (2.0, 0.0, 2.0), (1.6, 0.76, 0.9))
CHAIRS = (
    Placed("under", "dining_chair", (2.0, 0.0, 2.5), (0.47, 0.87, 0.54), pi),
    Placed("free", "dining_chair", (0.6, 0.0, 3.2), (0.47, 0.87, 0.54), pi),
)
ROOM = Layout("mine", "dining_room", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)), objects=(TABLE, *CHAIRS))


def test_a_file_of_rooms_is_told_by_category(tmp_path: Path) -> None:
    write_layouts(tmp_path / "rooms.json", [ROOM])
    done = CliRunner().invoke(app, ["check", str(tmp_path / "rooms.json")], env={"SIMS_DATA_DIR": str(tmp_path)})
    assert done.exit_code == 0, done.output
    row = next(line for line in done.output.splitlines() if line.startswith("dining_chair"))
    assert row.split() == ["dining_chair", "sit", "2", "100.0%", "50.0%", "100.0%"]
    assert "1 room;" in done.output
