"""A ProcTHOR house becomes rooms; what it does not say is estimated and counted, and nothing it says can break it."""

from __future__ import annotations

import copy
import gzip
import json
from contextlib import suppress
from math import pi, remainder, tau
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from spoiling import spoiled
from unity_houses import ASSETS, HOUSE, MODELS, ROOM, procthor_house, vector

from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout, Placed, layout_from_dict, layout_to_dict
from scene_graphs.loaders import Imported, Options, Source, read_scene


def read(*houses: Any, assets: Any = ASSETS, name: str = "houses.jsonl", scan: str | None = None) -> Imported:
    data = "\n".join(json.dumps(house) for house in houses).encode()
    given_assets = None if assets is None else Source.of_bytes("boxes.json", json.dumps(assets).encode())
    return read_scene(Source.of_bytes(name, data), "procthor", Options(assets=given_assets, scan=scan))


def test_some_houses_of_many_are_named_by_their_numbers() -> None:
    for scan, numbers in {"1": [1], "1-2": [1, 2], "0-9": [0, 1, 2], "2-400000": [2]}.items():
        assert [layout.id for layout in read(HOUSE, HOUSE, HOUSE, scan=scan).layouts] == [
            f"houses/{n}/2" for n in numbers
        ]
    for scan, says in {
        "3": "no house",
        "two": "17 or 0-99",
        "-1": "17 or 0-99",
        "2-1": "no house",
        "": "17 or 0-99",
    }.items():
        with pytest.raises(LayoutError, match=says):
            read(HOUSE, HOUSE, HOUSE, scan=scan)


def house_with(*objects: dict[str, Any]) -> dict[str, Any]:
    return {**HOUSE, "objects": list(objects)}


def thing(asset: str, x: float = 2.0, y: Any = 0.4, z: float = 1.5, **more: Any) -> dict[str, Any]:
    return {"id": f"2|{asset}", "assetId": asset, "position": vector(x, y, z), "rotation": vector(0, 0, 0), **more}


def close(a: Layout, b: Layout) -> bool:
    return all(
        (p.id, p.category, p.parent) == (q.id, q.category, q.parent)
        and np.allclose([*p.position, *p.size], [*q.position, *q.size], atol=1e-9)
        and abs(remainder(p.yaw - q.yaw, tau)) < 1e-9
        for p, q in zip(a.objects, b.objects, strict=True)
    )


def test_a_room_written_as_a_house_is_read_as_it_was() -> None:
    [layout] = read(HOUSE).layouts
    assert (layout.id, layout.room_type, layout.height) == (ROOM.id, ROOM.room_type, ROOM.height)
    assert set(layout.floor_polygon) == set(ROOM.floor_polygon)
    assert close(layout, ROOM)
    assert {frozenset(door.segment) for door in layout.doors} == {frozenset(door.segment) for door in ROOM.doors}
    assert [(window.bottom, window.top) for window in layout.windows] == [(0.9, 2.0)]


@tries(40)
@given(st.floats(-pi, pi), st.floats(0.6, 3.4), st.floats(0.6, 2.4), st.booleans())
def test_reading_undoes_writing_wherever_a_bed_stands(yaw: float, x: float, z: float, runs_back: bool) -> None:
    bed = Placed("2|0", "single_bed", (-x, 0.0, z), (1.0, 0.9, 2.0), yaw)
    room = Layout(ROOM.id, "bedroom", ROOM.floor_polygon, 2.7, ROOM.doors, (), (bed,))
    house = procthor_house(room, {"2|0": "Bed_13"})
    if runs_back:
        # A wall may be written from its other end: then its doors are measured from there.
        wall = next(wall for wall in house["walls"] if wall["id"] == house["doors"][0]["wall0"])
        wall["polygon"] = [wall["polygon"][index] for index in (1, 0, 3, 2)]
        for corner in house["doors"][0]["holePolygon"]:
            corner["x"] = 4.0 - corner["x"]
    [layout] = read(house).layouts
    assert close(layout, room)
    assert np.allclose(sorted(layout.doors[0].segment), sorted(room.doors[0].segment), atol=1e-9)


@for_each(
    ("asset", "category"),
    [
        ("Bed_13", "single_bed"),
        ("Bed_2", "double_bed"),
        ("Sofa_1", "loveseat_sofa"),
        ("Stool_3", "barstool"),
        ("Side_Table_1", "nightstand"),
        ("Side_Table_2", "side_table"),
        ("RoboTHOR_office_chair_x", "office_chair"),
        ("Chair_1", "dining_chair"),
        ("Dog_Bed_1", "pet_bed"),
    ],
)
def test_a_model_is_called_by_its_type_its_box_and_its_room(asset: str, category: str) -> None:
    [layout] = read(house_with(thing(asset))).layouts
    assert [placed.category for placed in layout.objects] == [category]


def test_without_boxes_a_size_is_estimated_from_the_name_and_the_height_and_counted() -> None:
    painting = thing("Wall_Decor_Painting_7", 0.1, 1.4, 2.0)
    result = read(house_with(thing("Dresser_5", y=0.55), painting), assets=None)
    dresser, picture = result.layouts[0].objects
    assert (dresser.category, picture.category) == ("dresser", "picture")
    assert dresser.size[1] == pytest.approx(1.1)
    assert dresser.position[1] == pytest.approx(0.0)
    assert picture.size[1] < 1.0 < picture.position[1] + picture.size[1] / 2
    assert result.report.guessed["size"] == 2


def test_boxes_lie_beside_the_houses_or_come_as_procthors_own_database(tmp_path: Path) -> None:
    file = tmp_path / "houses.jsonl"
    file.write_text(json.dumps(HOUSE))
    with gzip.open(tmp_path / "procthor_asset_boxes.json.gz", "wt") as stream:
        json.dump(ASSETS, stream)
    beside = read_scene(file, "procthor")
    database = {
        type_: [{"assetId": name, "objectType": type_, "boundingBox": vector(*box)}]
        for name, (type_, box) in ASSETS.items()
        if name in MODELS.values()
    }
    assert not beside.report.guessed
    assert read(HOUSE, assets=database).layouts == beside.layouts


_KITCHEN = [(4, 0), (4, 3), (8, 3), (8, 0)]


def test_every_room_of_a_house_takes_what_stands_on_its_floor() -> None:
    house = copy.deepcopy(HOUSE)
    house["rooms"].append(
        {"id": "room|3", "roomType": "Kitchen", "floorPolygon": [vector(x, 0, z) for x, z in _KITCHEN]}
    )
    house["objects"] += [thing("Chair_1", 6.0), {**thing("Chair_1", 30.0), "id": "9|9"}]
    result = read(house)
    bedroom, kitchen = result.layouts
    assert (bedroom.id, kitchen.id) == ("houses/0/2", "houses/0/3")
    assert [placed.category for placed in kitchen.objects] == ["dining_chair"]
    assert result.report.dropped["it stands in no room of its house"] == 1


def test_one_bad_house_or_object_does_not_spoil_the_others() -> None:
    broken = house_with(thing("Bed_2", x=float("nan")), thing("Chair_1"), {"id": "2|9"}, thing("Bed_2", y="low"))
    result = read({"rooms": 3}, broken, HOUSE, 7)
    assert [len(layout.objects) for layout in result.layouts] == [1, 3]
    assert result.report.dropped["a house that cannot be read"] == 2
    assert result.report.dropped["one of the objects that cannot be read"] == 3


def test_a_room_that_is_named_twice_is_read_once_and_that_is_said() -> None:
    house = copy.deepcopy(HOUSE)
    house["rooms"].append(house["rooms"][0])
    result = read(house)
    assert len(result.layouts) == len(read(HOUSE).layouts)
    assert result.report.dropped["a room whose id occurs before"] == 1


def test_a_file_without_houses_is_refused_with_the_reason() -> None:
    with pytest.raises(LayoutError, match="must be a house with rooms"):
        read({"nodes": []})
    with pytest.raises(LayoutError, match="Bed_13"):
        read(HOUSE, assets=["Bed_13"])


@pytest.mark.sweep
def test_a_heap_of_a_hundred_thousand_things_is_refused_in_bounded_time() -> None:
    pile = thing("Bed_13", children=[thing("pillow_1")] * 4_999)
    with pytest.raises(LayoutError, match="a house holds at most 5000 objects"):
        read(house_with(*[pile] * 20))


@tries(150)
@given(spoiled({"house": HOUSE, "assets": ASSETS}))
def test_whatever_a_house_says_it_is_read_or_refused(file: Any) -> None:
    parts = file if isinstance(file, dict) else {}
    with suppress(LayoutError):
        for layout in read(parts.get("house"), assets=parts.get("assets")).layouts:
            assert layout_from_dict(layout_to_dict(layout)) == layout


@tries(40)
@given(st.integers(0, len(json.dumps(HOUSE)) - 1))
def test_a_file_that_is_cut_off_is_refused(length: int) -> None:
    with pytest.raises(LayoutError):
        read_scene(Source.of_bytes("house.json", json.dumps(HOUSE)[:length].encode()), "procthor")
