"""A 3D-FRONT house becomes rooms in its own frame; what cannot be used is counted, whatever the file holds."""

from __future__ import annotations

import json
import time
from contextlib import suppress
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from spoiling import spoiled

from benchmarks.houses import MODELS, TYPES, synthetic_house
from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout, Placed, layout_from_dict, layout_to_dict
from scene_graphs.loaders import Imported, Options, Source, read_scene

Json = dict[str, Any]


def turned(degrees: float) -> list[float]:
    half = np.radians(degrees) / 2
    return [0.0, sin(half), 0.0, cos(half)]


def placed(ref: str, x: float = 1.5, z: float = 1.1, degrees: float = 0.0, **more: Any) -> Json:
    pose = {"pos": [x, 0, z], "rot": turned(degrees), "scale": [1, 1, 1]}
    return {"ref": ref, "instanceid": f"furniture/{ref}", **pose, **more}


def mesh(uid: str, kind: str, points: list[list[float]], faces: list[int]) -> Json:
    return {"uid": uid, "type": kind, "xyz": [number for point in points for number in point], "faces": faces}


def obj_box(low: tuple[float, ...], high: tuple[float, ...], first: int = 1) -> str:
    """A closed box as OBJ text; `first` is the number of its first point."""
    points = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join(
        "f " + " ".join(str(first + corner) for corner in face) + "\n" for face in faces
    )


def small_house(*children: Json, furniture: list[Json] | None = None, meshes: tuple[Json, ...] = ()) -> Json:
    """A bedroom of three by four metres with a bed."""
    bed = {"uid": "3/model", "jid": "j-bed", "valid": True, "title": "bed/single bed", "size": [1.0, 2.0, 0.9]}
    floor = mesh("9/0", "Floor", [[0, 0, 0], [3, 0, 0], [3, 0, 4], [0, 0, 4]], [0, 2, 1, 0, 3, 2])
    shell = [{"ref": row["uid"], "instanceid": f"mesh/{row['uid']}"} for row in (floor, *meshes)]
    room = {
        "type": "Bedroom",
        "instanceid": "Bedroom-1",
        "empty": 0,
        "children": [*shell, placed("3/model"), *children],
    }
    return {
        "uid": "h1",
        "furniture": [bed, *(furniture or [])],
        "mesh": [floor, *meshes],
        "extension": {"door": []},
        "scene": {"room": [room]},
    }


def read(house: Any, **options: Any) -> Imported:
    return read_scene(Source.of_bytes("h1.json", json.dumps(house).encode()), "3d-front", Options(**options))


def only(house: Json) -> Layout:
    (layout,) = read(house).layouts
    return layout


def dropped(imported: Imported) -> int:
    return imported.report.dropped.total()


def test_the_small_house_is_read_in_its_own_frame() -> None:
    layout = only(small_house())
    assert (layout.id, layout.room_type, layout.tags) == ("3d-front/h1/Bedroom-1", "bedroom", ("bedroom",))
    assert shapely.Polygon(layout.floor_polygon).symmetric_difference(shapely.box(0, 0, 3, 4)).area < 0.01
    assert layout.objects == (Placed("furniture/3/model", "single_bed", (1.5, 0.0, 1.1), (1.0, 0.9, 2.0)),)
    assert layout_from_dict(layout_to_dict(layout)) == layout


def test_size_is_width_depth_height_and_a_lone_bbox_width_height_depth() -> None:
    entry = {"uid": "4/model", "jid": "j", "valid": True, "category": "Wardrobe"}
    for box in ({"size": [1.5, 0.6, 2.2], "bbox": [1.5, 0.6, 2.2]}, {"bbox": [1.5, 2.2, 0.6]}):
        layout = only(small_house(placed("4/model", z=3.6), furniture=[entry | box]))
        assert layout.object("furniture/4/model").size == (1.5, 2.2, 0.6)


@given(st.floats(-180, 180), st.floats(-1e-3, 1e-3))
def test_the_front_of_a_model_is_its_z_axis(degrees: float, tilt: float) -> None:
    x, y, z, w = turned(degrees)
    layout = only(small_house(placed("3/model", rot=[x + tilt, y, z + tilt, w])))
    bed = layout.objects[1]
    assert np.allclose(bed.front, [sin(np.radians(degrees)), cos(np.radians(degrees))], atol=5e-3)


@given(st.tuples(*[st.floats(0.1, 4.9)] * 3), st.tuples(*[st.sampled_from([-1, 1])] * 2))
def test_a_scale_stretches_the_box_and_a_mirrored_front_looks_back(
    factors: tuple[float, float, float], signs: tuple[int, int]
) -> None:
    scale = [factors[0] * signs[0], factors[1], factors[2] * signs[1]]
    bed = only(small_house(placed("3/model", scale=scale))).objects[1]
    assert np.allclose(bed.size, [factors[0] * 1.0, factors[1] * 0.9, factors[2] * 2.0])
    assert np.allclose(bed.front, [0.0, signs[1]])


@for_each("scale", [[1e-6, 1, 1], [1, 6, 1], [0, 0, 0], [1, 1], ["1", "1", "1"], [1, 1, None]])
def test_a_scale_that_is_none_drops_the_piece(scale: list[Any]) -> None:
    imported = read(small_house(placed("3/model", scale=scale)))
    assert (len(imported.layouts[0].objects), dropped(imported)) == (1, 1)


def test_only_valid_models_with_a_size_are_kept_and_the_others_counted() -> None:
    entries: list[Json] = [
        {"uid": "a", "valid": False, "size": [1, 1, 1], "title": "sofa"},
        {"uid": "b", "size": [1, 1, 1], "title": "sofa"},
        {"uid": "c", "valid": True, "title": "sofa"},
        {"uid": "d", "valid": "true", "size": [1, 1, 1], "title": "sofa"},
        {"uid": "e", "valid": True, "size": [1, 0, 1], "title": "sofa"},
    ]
    imported = read(small_house(*(placed(name) for name in "abcdefg"), placed("a") | {"ref": 7}, furniture=entries))
    assert [o.category for o in imported.layouts[0].objects] == ["single_bed"]
    counts = sorted(imported.report.dropped.values())
    assert counts == [1, 1, 1, 2, 3]
    assert imported.report.dropped["it points at a model the house does not have"] == 2


@for_each(
    ("entry", "category"),
    [
        ({"category": "Drawer Chest / Corner cabinet"}, "cabinet"),
        ({"category": "Three-Seat / Multi-seat Sofa"}, "multi_seat_sofa"),
        ({"category": "Corner/Side Table"}, "corner_side_table"),
        ({"category": "table/night table"}, "nightstand"),
        ({"category": None, "title": "bed/king-size bed"}, "double_bed"),
        ({"category": "", "title": ""}, "unknown"),
        ({"title": 5}, "unknown"),
        ({"title": "hammock"}, "hammock"),
    ],
)
def test_a_piece_is_named_by_category_or_the_end_of_its_title(entry: Json, category: str) -> None:
    row = {"uid": "4/model", "valid": True, "size": [1, 1, 1], **entry}
    assert only(small_house(placed("4/model"), furniture=[row])).objects[1].category == category


def test_model_info_and_raw_models_beside_the_house_come_first(tmp_path: Path) -> None:
    house = small_house(placed("3/model", x=1.0, z=2.0, degrees=90))
    (tmp_path / "h1.json").write_text(json.dumps(house))
    (tmp_path / "model_info.json").write_text(json.dumps([{"model_id": "j-bed", "category": "Bunk Bed"}, 5, {}]))
    model = tmp_path / "3D-FUTURE-model" / "j-bed"
    model.mkdir(parents=True)
    # Off its origin: the middle of its bottom is at (0.1, 0, 0.2).
    (model / "raw_model.obj").write_text(obj_box((-0.4, 0, -0.8), (0.6, 1.7, 1.2)))
    for source in (tmp_path / "h1.json", tmp_path):
        layout = read_scene(source, "3d-front", Options(scan="h1")).layouts[0]
        assert [(o.category, o.mesh) for o in layout.objects] == [("bunk_bed", "j-bed")] * 2
        straight, sideways = layout.objects
        assert np.allclose(straight.size, (1.0, 1.7, 2.0))
        assert np.allclose(straight.position, (1.6, 0.0, 1.3))
        assert np.allclose(sideways.position, (1.2, 0.0, 1.9))
    (model / "raw_model.obj").write_text("v 0 0 zero\n")
    with pytest.raises(LayoutError, match=r"raw_model\.obj"):
        read_scene(tmp_path / "h1.json", "3d-front")


@pytest.mark.parametrize("scale", [(1, 1, 1), (-1, 1, 1), (1, 1, -1), (-1, 1, -1), (1.2, 0.9, 1.1)])
def test_a_raw_model_gives_a_piece_its_shape_turned_and_mirrored_with_it(
    tmp_path: Path, scale: tuple[float, float, float]
) -> None:
    """A chair with one arm, at its +X: the arm and the back stand in the room where the scaled mesh has them."""
    chair = {"uid": "4/model", "jid": "chair", "valid": True, "category": "Dining Chair", "bbox": [9, 9, 9]}
    house = small_house(placed("4/model", x=1.0, z=2.0, degrees=90, scale=scale), furniture=[chair])
    (tmp_path / "h1.json").write_text(json.dumps(house))
    (tmp_path / "chair").mkdir()
    seat, back = obj_box((-0.25, 0, -0.25), (0.25, 0.45, 0.25)), obj_box((-0.25, 0.45, -0.25), (0.25, 0.9, -0.19), 9)
    arm = obj_box((0.19, 0.45, -0.19), (0.25, 0.65, 0.25), 17)
    (tmp_path / "chair" / "raw_model.obj").write_text(seat + back + arm)
    piece = read_scene(tmp_path / "h1.json", "3d-front").layouts[0].object("furniture/4/model")
    centres = {part.role: np.mean([part.low, part.high], axis=0) for part in piece.shape}
    assert {"seat", "back", "arm"} <= set(centres)
    for role, (x, z) in {"back": (0.0, -0.22), "arm": (0.22, 0.03)}.items():
        # Turned by 90 degrees about Y, the model's x is the room's -z and its z the room's x.
        expected = (1.0 + z * scale[2], 2.0 - x * scale[0])
        assert np.allclose(piece.to_world(centres[role])[[0, 2]], expected, atol=0.05), role
    assert centres["back"][2] < 0
    assert centres["back"][1] * 2 > 0.9 * scale[1]


@for_each(
    ("kind", "tags"),
    [
        ("LivingDiningRoom", ("living_room", "dining_room")),
        ("MasterBedroom", ("bedroom",)),
        ("Library", ("study",)),
        ("MasterBathroom", ("master_bathroom",)),
        ("KidsRoom", ("kids_room", "bedroom")),
        ("none", ("bedroom",)),
        (None, ("bedroom",)),
        ("OtherRoom", ("bedroom",)),
        ("../\x1b[1m", ("1m",)),
    ],
)
def test_a_room_is_what_its_own_word_says_or_what_its_furniture_makes_it(kind: Any, tags: tuple[str, ...]) -> None:
    house = small_house()
    house["scene"]["room"][0]["type"] = kind
    assert only(house).tags == tags


def test_the_floor_is_the_union_of_its_triangles_and_heights_count_from_it() -> None:
    wing = mesh("8/0", "Floor", [[3, 0, 0], [5, 0, 0], [5, 0, 2], [3, 0, 2]], [0, 1, 2, 0, 2, 3])
    ceiling = mesh("7/0", "Ceiling", [[0, 2.9, 0], [1, 2.9, 0], [1, 2.9, 1]], [0, 1, 2])
    house = small_house(meshes=(wing, ceiling))
    layout = only(house)
    assert len(layout.floor_polygon) == 6
    assert layout.area == pytest.approx(16.0, abs=0.01)
    assert layout.height == pytest.approx(2.9)
    for row in house["mesh"]:
        row["xyz"][1::3] = [y + 3.1 for y in row["xyz"][1::3]]
    house["scene"]["room"][0]["children"][-1]["pos"][1] = 3.1
    raised = only(house)
    assert raised.height == pytest.approx(2.9)
    assert raised.objects[0].position[1] == pytest.approx(0.0)
    assert raised.floor_polygon == layout.floor_polygon


def test_a_room_without_floor_gets_one_around_its_furniture() -> None:
    house = small_house()
    house["mesh"] = []
    imported = read(house)
    assert shapely.Polygon(imported.layouts[0].floor_polygon).contains(shapely.box(1.0, 0.1, 2.0, 2.1))
    assert imported.report.guessed["floor"] == 1


def test_doors_and_windows_are_on_the_outlines_of_all_rooms_they_lead_to() -> None:
    door = mesh("d", "Door", [[3.1, 0, 1], [3.1, 0, 1.9], [3.1, 2.1, 1.9], [3.05, 1, 1.4]], [0, 1, 2])
    hole = mesh("h", "Hole", [[3.1, 0, 1], [3.1, 0, 1.9], [3.1, 2.1, 1.9]], [0, 1, 2])
    window = mesh("w", "Window", [[0.5, 0.9, 4.1], [1.7, 0.9, 4.1], [1.7, 2.0, 4.1]], [0, 1, 2])
    house = small_house(meshes=(hole, door, window))
    floor = mesh("9/1", "Floor", [[3.2, 0, 0], [6, 0, 0], [6, 0, 4], [3.2, 0, 4]], [0, 2, 1, 0, 3, 2])
    house["mesh"].append(floor)
    house["scene"]["room"].append(
        {"type": "Library", "instanceid": "L", "children": [{"ref": "9/1"}, placed("3/model", x=4.5, z=2.0)]}
    )
    bedroom, study = read(house).layouts
    for layout, x in ((bedroom, 3.0), (study, 3.2)):
        (opening,) = layout.doors
        assert {round(end[0], 3) for end in opening.segment} == {x}
        assert sorted(round(end[1], 3) for end in opening.segment) == [1.0, 1.9]
        assert (opening.bottom, opening.top) == (0.0, 2.1)
    assert [(w.bottom, w.top) for w in bedroom.windows] == [(0.9, 2.0)]
    assert not study.windows


def test_a_door_model_that_the_house_names_is_a_door() -> None:
    entry = {"uid": "d/model", "title": "", "bbox": [0.9, 2.1, 0.1]}
    house = small_house(placed("d/model", x=1.5, z=-0.1), furniture=[entry])
    assert not only(house).doors
    house["extension"]["door"] = [{"type": "entryDoor", "roomId": "Bedroom-1", "ref": ["d/model", 5]}, None, {"ref": 1}]
    assert len(only(house).doors) == 1
    house["extension"]["door"] = []
    house["furniture"][1]["title"] = "door/single swing door"
    assert len(only(house).doors) == 1


def test_what_stands_on_another_rooms_floor_belongs_there() -> None:
    house = small_house(placed("4/model", x=5.0, z=1.0), placed("4/model", x=40.0))
    house["furniture"].append({"uid": "4/model", "valid": True, "category": "Desk", "size": [1.4, 0.6, 0.75]})
    house["mesh"].append(mesh("9/1", "Floor", [[3.2, 0, 0], [6, 0, 0], [6, 0, 4], [3.2, 0, 4]], [0, 2, 1, 0, 3, 2]))
    house["scene"]["room"].append({"type": "Library", "instanceid": "L", "children": [{"ref": "9/1"}]})
    imported = read(house)
    assert [[o.category for o in layout.objects] for layout in imported.layouts] == [["single_bed"], ["desk"]]
    assert dropped(imported) == 1


def test_rooms_of_one_name_get_ids_of_their_own() -> None:
    house = small_house()
    house["scene"]["room"] *= 3
    assert len({layout.id for layout in read(house).layouts}) == 3


@given(st.integers(0, 10**6), st.integers(1, 10), st.integers(0, 40))
@tries(10)
def test_every_piece_of_a_house_is_kept_or_counted(seed: int, rooms: int, pieces: int) -> None:
    house = synthetic_house(seed, rooms, pieces)
    try:
        imported = read(house)
    except LayoutError:
        assert pieces * len(TYPES) < 400
        return
    lost = 6 * rooms
    bare = imported.report.dropped["a room without furniture"]
    outside = sum(count for why, count in imported.report.dropped.items() if "door" in why or "window" in why)
    assert imported.report.kept.total() + dropped(imported) - lost - bare - outside == pieces
    assert imported.report.rooms + bare == rooms
    for layout in imported.layouts:
        floor = shapely.Polygon(layout.floor_polygon).buffer(0.31)
        assert all(floor.contains(shapely.Point(o.position[0], o.position[2])) for o in layout.objects)
        outline = shapely.Polygon(layout.floor_polygon).exterior
        assert all(outline.distance(shapely.Point(end)) < 1e-6 for door in layout.doors for end in door.segment)
    assert set(imported.report.kept) <= set(MODELS.values())


def test_the_same_house_gives_the_same_rooms() -> None:
    assert read(synthetic_house(7)).layouts == read(synthetic_house(7)).layouts


@given(spoiled(small_house(meshes=(mesh("d", "Door", [[3.1, 0, 1], [3.1, 0, 1.9], [3.1, 2, 1]], [0, 1, 2]),))))
@tries(200)
def test_a_spoiled_house_is_refused_or_reported(house: Any) -> None:
    try:
        imported = read(house)
    except LayoutError:
        return
    for layout in imported.layouts:
        assert layout_from_dict(layout_to_dict(layout)) == layout


@given(st.integers(0, 1200))
@tries(30)
def test_a_cut_off_file_is_refused(length: int) -> None:
    data = json.dumps(small_house()).encode()
    with pytest.raises(LayoutError, match=r"h1\.json"):
        read_scene(Source.of_bytes("h1.json", data[: min(length, len(data) - 1)]), "3d-front")


@for_each("value", [[], 5, {}, {"scene": {}}, {"scene": {"room": {}}}, {"scene": {"room": []}}])
def test_another_format_is_refused_with_what_would_be_right(value: Any) -> None:
    with pytest.raises(LayoutError, match=r"3D-FRONT|no room"):
        read(value)


def test_a_folder_asks_for_the_house(tmp_path: Path) -> None:
    with pytest.raises(LayoutError, match="scan"):
        read_scene(tmp_path, "3d-front")


@pytest.mark.sweep
@pytest.mark.parametrize("what", ["children", "pieces", "rooms", "meshes", "triangles", "doors", "round"])
def test_a_huge_house_is_read_or_refused_in_bounded_time(what: str) -> None:
    house, many = small_house(), 100_000
    room = house["scene"]["room"][0]
    if what == "children":
        room["children"] += [{"ref": "lost"}] * many
    elif what == "pieces":
        room["children"] += [placed("3/model")] * 9_000
    elif what == "rooms":
        house["scene"]["room"] *= 1_500
    elif what == "meshes":
        house["mesh"] += [mesh("x", "Floor", [[0, 0, 0]], [0, 0, 0])] * many
    elif what == "triangles":
        house["mesh"].append(mesh("t", "Floor", [[0, 0, 0], [3, 0, 0], [3, 0, 4]], [0, 1, 2] * 5_000))
        room["children"] += [{"ref": "t"}] * 9
    elif what == "doors":
        house["mesh"].append(mesh("t", "Door", [[0, 0, 0], [0.9, 2, 0]], [0, 1, 0]))
        room["children"] += [{"ref": "t", "pos": [number % 997 * 0.9, 0, 0]} for number in range(20_000)]
    else:
        points = [[round(9 * cos(a), 6), a % 2, round(9 * sin(a), 6)] for a in np.linspace(0, 2 * pi, 60_000)]
        house["mesh"].append(mesh("t", "Window", points, [0, 1, 2]))
        room["children"].append({"ref": "t"})
    start = time.process_time()
    with suppress(LayoutError):
        read(house)
    assert time.process_time() - start < 10.0
