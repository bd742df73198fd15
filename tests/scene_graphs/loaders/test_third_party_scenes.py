"""Every room of the third-party data imports; what is in it, and what was dropped and why, is printed."""

from __future__ import annotations

import gzip
import json
import os
from collections import Counter
from math import remainder, tau
from pathlib import Path

import numpy as np
import pytest
from unity_houses import procthor_house

from scene_graphs.layout import layout_from_dict
from scene_graphs.loaders import Imported, Options, Source, read_scene

DATA = Path(os.environ.get("SIMS_TEST_DATA", ".")) / "layouts"
SOURCES = {"procthor": (476, 10_879), "tdw": (41, 523), "virtualhome": (22, 414)}
"""Rooms and objects of each, as its own README counts them."""
pytestmark = pytest.mark.skipif(not (DATA / "rooms").is_dir(), reason="SIMS_TEST_DATA holds no layouts/rooms")


@pytest.fixture(scope="module")
def imported() -> dict[str, Imported]:
    return {name: read_scene(DATA / "rooms" / f"{name}_rooms.jsonl.gz", "native") for name in SOURCES}


def test_every_room_and_object_is_kept(imported: dict[str, Imported], capsys: pytest.CaptureFixture[str]) -> None:
    counts = Counter({name: result.report.kept.total() for name, result in imported.items()})
    categories: Counter[str] = sum((result.report.kept for result in imported.values()), Counter())
    with capsys.disabled():
        print(f"\n{'source':<12}{'rooms':>7}{'objects':>9}{'dropped':>9}  why")
        for name, result in imported.items():
            report = result.report
            why = "; ".join(f"{count} {reason}" for reason, count in report.dropped.most_common()) or "-"
            print(f"{name:<12}{report.rooms:>7}{counts[name]:>9}{report.dropped.total():>9}  {why}")
        print(
            f"{len(categories)} categories: " + ", ".join(f"{n} {c}" for c, n in categories.most_common(40)) + ", ..."
        )
    assert {name: (len(r.layouts), counts[name]) for name, r in imported.items()} == SOURCES
    assert not any(result.report.dropped for result in imported.values())


@pytest.mark.sweep
@pytest.mark.parametrize("has_boxes", [True, False])
def test_rooms_written_back_as_houses_are_read_as_others_converted_them(
    has_boxes: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    with gzip.open(DATA / "rooms" / "procthor_rooms.jsonl.gz", "rt") as stream:
        rows = [json.loads(line) for line in stream]
    rooms = [layout_from_dict(row) for row in rows]
    models = [{item["id"]: item["asset"] for item in row["objects"]} for row in rows]
    houses = [procthor_house(room, names) for room, names in zip(rooms, models, strict=True)]
    content = "\n".join(json.dumps(house) for house in houses).encode()
    boxes = Source.of_path(DATA / "procthor_asset_boxes.json.gz") if has_boxes else None
    result = read_scene(Source.of_bytes("houses.jsonl", content), "procthor", Options(assets=boxes))
    pairs = [
        (ours, theirs)
        for mine, room in zip(result.layouts, rooms, strict=True)
        for ours, theirs in zip(
            sorted(mine.objects, key=lambda o: o.id), sorted(room.objects, key=lambda o: o.id), strict=True
        )
    ]
    renamed = Counter((theirs.category, ours.category) for ours, theirs in pairs if ours.category != theirs.category)
    with capsys.disabled():
        print(f"\nProcTHOR, {'asset boxes' if has_boxes else 'no asset file'}: {result.report.lines()[0][:60]} ...")
        print(f"estimated {dict(result.report.guessed)}, otherwise named {renamed.total()}: {renamed.most_common(6)}")
    assert all(abs(remainder(ours.yaw - theirs.yaw, tau)) < 1e-3 for ours, theirs in pairs)
    assert not result.report.dropped
    for mine, room in zip(result.layouts, rooms, strict=True):
        assert (len(mine.doors), len(mine.windows)) == (len(room.doors), len(room.windows))
        assert set(mine.floor_polygon) == set(room.floor_polygon)
    if has_boxes:
        # A sofa that is 1.6 m deep or more has a corner, whoever called it otherwise.
        assert set(renamed) <= {("multi_seat_sofa", "l_shaped_sofa")}
        tilted = {item["id"] for row in rows for item in row["objects"] if "quat" in item}
        assert all(np.allclose(a.size, b.size, atol=2e-3) for a, b in pairs if a.id not in tilted)
        assert [set(m.tags) for m in result.layouts] == [set(r.tags) for r in rooms]
    else:
        furniture = [(a, b) for a, b in pairs if b.parent is None]
        assert np.mean([a.category == b.category for a, b in furniture]) > 0.94
        floor_errors = [abs(a.position[1]) for a, b in furniture if b.position[1] == 0.0]
        assert np.mean(np.array(floor_errors) < 0.01) > 0.9


def test_beds_and_sofas_of_converted_rooms_look_into_their_rooms(imported: dict[str, Imported]) -> None:
    looks = [
        float(placed.front @ (np.mean(layout.floor_polygon, axis=0) - np.array(placed.position)[[0, 2]])) > 0
        for result in imported.values()
        for layout in result.layouts
        for placed in layout.objects
        if placed.category in ("double_bed", "single_bed", "wardrobe", "bookshelf")
    ]
    assert np.mean(looks) > 0.97


def test_the_original_flat_says_what_it_leaves_out(capsys: pytest.CaptureFixture[str]) -> None:
    result = read_scene(DATA / "extra" / "virtualhome_TestScene2_graph.json.gz", "virtualhome")
    with capsys.disabled():
        print("\nVirtualHome TestScene2: " + "\n  ".join(result.report.lines()))
    assert len(result.layouts) == 4
    assert sum(len(layout.objects) for layout in result.layouts) == result.report.kept.total() > 100
    assert all(reason and count for reason, count in result.report.dropped.items())
