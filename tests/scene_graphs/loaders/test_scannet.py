"""A ScanNet scan becomes a room of labelled boxes; files of different meshes are told apart."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from scans import INFO, ply, scan, write
from spoiling import spoiled

from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout, layout_from_dict, layout_to_dict
from scene_graphs.loaders import Options, Source, read_scene
from scene_graphs.loaders.scannet import read_ply_vertices


def read(folder: Path, **options: Any) -> Layout:
    (layout,) = read_scene(folder, "scannet", Options(**options)).layouts
    return layout


@pytest.mark.parametrize("kind", ["binary_little_endian", "binary_big_endian", "ascii"])
def test_a_scan_becomes_an_upright_room(tmp_path: Path, kind: str) -> None:
    aggregation, segments, points = scan()
    layout = read(write(tmp_path, aggregation, segments, ply(points, kind)))
    assert (layout.id, layout.room_type, layout.tags) == ("scannet/scene1", "bedroom", ("bedroom", "study"))
    assert layout.area == pytest.approx(12.0, abs=0.05)
    by_category = {placed.category: placed for placed in layout.objects}
    assert set(by_category) == {"single_bed", "pillow", "desk", "office_chair", "mug"}
    bed, desk = by_category["single_bed"], by_category["desk"]
    assert np.allclose(bed.position, (1.0, 0.0, -2.4), atol=0.03)
    assert np.allclose(bed.size, (1.0, 0.6, 2.0), atol=0.03)
    assert np.allclose(bed.front, (1.0, 0.0), atol=1e-3)
    assert np.allclose(desk.size, (1.2, 0.75, 0.6), atol=0.03)
    assert by_category["mug"].parent == desk.id
    assert (len(layout.doors), len(layout.windows)) == (1, 1)
    assert layout_from_dict(layout_to_dict(layout)) == layout


def test_a_scan_is_found_by_folder_file_or_name(tmp_path: Path) -> None:
    aggregation, segments, points = scan()
    folder = tmp_path / "scans" / "scene1"
    folder.mkdir(parents=True)
    layout = read(write(folder, aggregation, segments, ply(points)))
    (folder / "scene1_vh_clean.aggregation.json").write_text("{}")
    assert read(folder) == layout
    assert read(folder / "scene1.aggregation.json") == layout
    assert read(tmp_path, scan="scene1") == layout
    assert read(folder.parent, scan="scene1") == layout
    with pytest.raises(LayoutError, match="scene2"):
        read(tmp_path, scan="scene2")
    with pytest.raises(LayoutError, match=r"aggregation\.json"):
        read(tmp_path)


def test_the_dense_meshs_files_are_told_apart(tmp_path: Path) -> None:
    aggregation, segments, points = scan()
    folder = write(tmp_path, aggregation, segments, ply(np.repeat(points, 3, axis=0)))
    with pytest.raises(LayoutError, match=r"dense.*scene1_vh_clean_2\.ply"):
        read(folder)
    for group in aggregation["segGroups"]:
        group["segments"] = [number + 5000 for number in group["segments"]]
    with pytest.raises(LayoutError, match="dense"):
        read(write(tmp_path, aggregation, segments, ply(points)))
    (folder / "scene1_vh_clean.aggregation.json").write_text("{}")
    with pytest.raises(LayoutError, match="decimated"):
        read(folder / "scene1_vh_clean.aggregation.json")


@pytest.mark.parametrize("missing", ["_vh_clean_2.0.010000.segs.json", "_vh_clean_2.ply"])
def test_a_missing_file_is_named(tmp_path: Path, missing: str) -> None:
    aggregation, segments, points = scan()
    (write(tmp_path, aggregation, segments, ply(points)) / f"scene1{missing}").unlink()
    with pytest.raises(LayoutError, match=f"scene1{missing}"):
        read(tmp_path)


def test_without_alignment_and_type_the_room_is_still_read(tmp_path: Path) -> None:
    aggregation, segments, points = scan()
    layout = read(write(tmp_path, aggregation, segments, ply(points), info=None))
    assert layout.room_type == "bedroom"
    assert layout.area == pytest.approx(12.0, abs=0.05)
    bed = next(placed for placed in layout.objects if placed.category == "single_bed")
    assert np.allclose(sorted(bed.size), (0.6, 1.0, 2.0), atol=0.03)


@pytest.mark.parametrize(
    "info", ["axisAlignment = 1 2 3", "axisAlignment = " + "nan " * 16, "axisAlignment = " + "2 " * 16]
)
def test_an_alignment_that_is_none_is_named(tmp_path: Path, info: str) -> None:
    aggregation, segments, points = scan()
    with pytest.raises(LayoutError, match="axisAlignment"):
        read(write(tmp_path, aggregation, segments, ply(points), info))


def test_without_floor_points_the_hull_of_all_is_the_floor(tmp_path: Path) -> None:
    aggregation, segments, points = scan()
    del aggregation["segGroups"][0]
    folder = write(tmp_path, aggregation, segments, ply(points))
    imported = read_scene(folder, "scannet")
    assert imported.layouts[0].area == pytest.approx(12.0, abs=0.5)
    assert imported.report.guessed["floor"] == 1


@given(spoiled([*scan()[:2]]), st.sampled_from([INFO, "", "sceneType = \x1b[1m", "axisAlignment = 1e300", "\ud800?"]))
@tries(80, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_spoiled_scan_is_refused_or_reported(tmp_path: Path, rows: Any, info: str) -> None:
    points = ply(scan()[2])
    rows = rows if isinstance(rows, list) and len(rows) == 2 else (rows, rows)
    folder = write(tmp_path, rows[0], rows[1], points, info.encode("utf-8", "replace").decode())
    with suppress(LayoutError):
        assert layout_from_dict(layout_to_dict(read(folder)))


def test_a_point_that_is_a_signalling_nan_is_refused_without_a_warning() -> None:
    data = ply(np.ones((1, 3)))
    one = np.float32(1.0).tobytes()
    with pytest.raises(LayoutError, match="not within"):
        read_ply_vertices(Source.of_bytes("m.ply", data.replace(one, bytes.fromhex("0100a07f"), 1)))


@given(st.sampled_from(["ascii", "binary_little_endian"]), st.integers(0, 10**6), st.binary(max_size=9))
@tries(150)
def test_a_damaged_mesh_gives_its_points_or_is_refused(kind: str, place: int, junk: bytes) -> None:
    points = np.arange(30, dtype=float).reshape(10, 3)
    data = ply(points, kind)
    place %= len(data)
    for spoilt in (data[:place], data[:place] + junk + data[place + len(junk) :]):
        with suppress(LayoutError):
            read = read_ply_vertices(Source.of_bytes("m.ply", spoilt))
            assert read.shape[1] == 3
            assert np.isfinite(read).all()


@for_each(
    ("header", "named"),
    [
        ("element vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\n", "at most"),
        ("element vertex 9000000\nproperty float x\nproperty float y\nproperty float z\n", "cut off|save it as binary"),
        ("element vertex 1\nproperty list uchar float x\n", "plain types"),
        ("element vertex 1\nproperty float x\nproperty float y\n", "x, y and z"),
        ("element face 1\nproperty float x\n", "first element"),
        ("element vertex -1\nproperty float x\nproperty float y\nproperty float z\n", "at most"),
    ],
)
@for_each("kind", ["ascii", "binary_little_endian"])
def test_a_header_that_lies_is_refused(kind: str, header: str, named: str) -> None:
    data = f"ply\nformat {kind} 1.0\n{header}end_header\n1 2 3".encode()
    with pytest.raises(LayoutError, match=named):
        read_ply_vertices(Source.of_bytes("m.ply", data))
