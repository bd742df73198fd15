"""From meshes to seats, mattresses, tops and boxes."""

from __future__ import annotations

import json
import os
from functools import cache
from math import hypot, isclose, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scene_graphs.affordances.affordances import Spot, spots
from scene_graphs.boxes import MAX_PARTS, Part, Point3
from scene_graphs.furniture import typical_size
from scene_graphs.furniture_shapes import parts
from scene_graphs.geometry.mesh_decomposition import front_of_mesh, shape_of
from scene_graphs.graph.furniture_graph import offers
from scene_graphs.layout import Layout, LayoutError, Placed, layout_from_dict, layout_to_dict
from scene_graphs.meshes.furniture_mesh import furniture_meshes

Array = NDArray[np.float64]
Faces = NDArray[np.int64]
SEATS = ("dining_chair", "office_chair", "armchair", "lounge_chair", "lazy_sofa", "stool", "ottoman", "bench")
SOFAS = ("multi_seat_sofa", "loveseat_sofa", "l_shaped_sofa", "chaise_longue_sofa", "sofa_bed")
BEDS = ("double_bed", "single_bed", "bunk_bed")
TABLES = ("dining_table", "coffee_table", "desk", "side_table")
SIDES = "013 032 467 475 045 051 237 276 026 064 157 173"
BOX = np.array([[int(corner) for corner in side] for side in SIDES.split()])


def mesh_of(boxes: tuple[Part, ...]) -> tuple[Array, Faces]:
    corners = [
        [(part.low, part.high)[pick][axis] for axis, pick in enumerate(picks)]
        for part in boxes
        for picks in np.ndindex(2, 2, 2)
    ]
    return np.array(corners), np.concatenate([BOX + 8 * number for number in range(len(boxes))])


@cache
def form(category: str) -> tuple[Array, Faces]:
    """The mesh of a piece of usual size; nobody changes it."""
    return mesh_of(parts(category, typical_size(category)))


@cache
def shape_of_form(category: str) -> tuple[Part, ...]:
    return shape_of(*form(category), category)


def standing(category: str, size: Point3, shape: tuple[Part, ...] = ()) -> Placed:
    return Placed("a", category, (0.0, 0.0, 0.0), size, shape=shape)


def is_near(one: Spot, other: Spot) -> bool:
    return (
        hypot(one.point[0] - other.point[0], one.point[2] - other.point[2]) < 0.04
        and hypot(one.standing[0] - other.standing[0], one.standing[1] - other.standing[1]) < 0.04
        and abs(one.point[1] - other.point[1]) < 0.02
        and isclose(np.cos(one.facing - other.facing), 1.0, abs_tol=1e-6)
        and isclose(np.cos(one.approach - other.approach), 1.0, abs_tol=1e-6)
    )


def agree(first: tuple[Spot, ...], second: tuple[Spot, ...]) -> bool:
    return all(
        any(is_near(one, other) for other in others)
        for these, others in ((first, second), (second, first))
        for one in these
    )


def is_settled(category: str, size: Point3) -> bool:
    """Whether a piece two cells longer, shorter, higher or lower offers as much: nothing is just long enough."""
    counts = {
        tuple(len(spots(standing(category, (size[0] + by, size[1] + up, size[2] + by)), use)) for use in ("sit", "lie"))
        for by, up in ((-0.06, 0.0), (0.0, -0.06), (0.0, 0.0), (0.0, 0.06), (0.03, 0.0))
    }
    return len(counts) == 1


@tries(25)
@given(st.sampled_from([*SEATS, *SOFAS, *BEDS, *TABLES]), st.tuples(*(st.floats(0.9, 1.15) for _ in range(3))))
def test_the_mesh_of_a_form_is_sat_and_lain_on_where_the_form_is(category: str, scale: tuple[float, ...]) -> None:
    width, height, depth = (length * by for length, by in zip(typical_size(category), scale, strict=True))
    size = (width, height, depth)
    assume(is_settled(category, size))
    plain = standing(category, size)
    measured = standing(category, size, shape_of(*mesh_of(parts(category, size)), category))
    assert len(measured.shape) <= MAX_PARTS
    for affordance in ("sit", "lie"):
        assert agree(spots(plain, affordance), spots(measured, affordance))
    assert offers(plain) == offers(measured)


@for_each("category", ["dining_chair", "l_shaped_sofa", "double_bed", "desk", "bookshelf"])
def test_boxes_fill_what_the_mesh_fills_and_leave_free_what_it_leaves_free(category: str) -> None:
    size, boxes = typical_size(category), parts(category, typical_size(category))
    measured = shape_of_form(category)
    points = np.random.default_rng(0).uniform([-0.5, 0, -0.5], [0.5, 1, 0.5], (20_000, 3)) * size

    def holds(these: tuple[Part, ...], slack: float) -> NDArray[np.bool_]:
        low, high = (np.array(ends)[:, None] for ends in zip(*((p.low, p.high) for p in these), strict=True))
        return np.asarray(((points > low - slack) & (points < high + slack)).all(axis=-1).any(axis=0))

    solid = tuple(part for part in measured if not part.is_soft)
    assert not (holds(boxes, -0.001) & ~holds(measured, 0.031)).any()
    assert not (holds(solid, -0.001) & ~holds(boxes, 0.031)).any()


@for_each("category", ["dining_chair", "multi_seat_sofa", "double_bed"])
def test_the_front_of_a_turned_mesh_is_turned_as_much(category: str) -> None:
    turned, faces = form(category)
    for quarters in range(4):
        front = front_of_mesh(turned, faces, category)
        assert front is not None
        assert isclose(np.cos(front - quarters * pi / 2), 1.0, abs_tol=1e-9)
        assert quarters or front == 0.0
        turned = turned[:, [2, 1, 0]] * [1, 1, -1]


@for_each("category", ["stool", "ottoman", "dining_table", "wardrobe", "rug"])
def test_what_looks_the_same_from_all_sides_has_no_front(category: str) -> None:
    assert front_of_mesh(*mesh_of(parts(category, typical_size(category))), category) is None


@pytest.mark.parametrize("category", ["stool", "dining_table", "ottoman"])
def test_a_quarter_turn_of_the_mesh_turns_its_boxes(category: str) -> None:
    vertices, faces = form(category)
    turned = shape_of(vertices[:, [2, 1, 0]] * [1, 1, -1], faces, category)
    as_found = shape_of_form(category)
    back = {(p.role, (-p.high[2], p.low[1], p.low[0]), (-p.low[2], p.high[1], p.high[0])) for p in turned}
    assert _rounded(back) == _rounded({(part.role, part.low, part.high) for part in as_found})


def _rounded(boxes: set[tuple[str, Point3, Point3]]) -> set[tuple[str, tuple[float, ...], tuple[float, ...]]]:
    return {(r, tuple(round(v, 2) + 0.0 for v in a), tuple(round(v, 2) + 0.0 for v in b)) for r, a, b in boxes}


def test_a_mirrored_corner_sofa_is_mirrored() -> None:
    vertices, faces = mesh_of(parts("l_shaped_sofa", (2.6, 0.85, 1.65)))
    size = (2.6, 0.85, 1.65)
    right = standing("l_shaped_sofa", size, shape_of(vertices, faces, "l_shaped_sofa"))
    left = standing("l_shaped_sofa", size, shape_of(vertices * [-1, 1, 1], faces, "l_shaped_sofa"))
    for affordance in ("sit", "lie"):
        there, here = spots(right, affordance), spots(left, affordance)
        assert len(there) == len(here) > 0
        for spot in there:
            assert any(hypot(spot.point[0] + o.point[0], spot.point[2] - o.point[2]) < 0.04 for o in here)


def test_double_and_degenerate_faces_change_nothing() -> None:
    vertices, faces = form("armchair")
    more = np.concatenate([faces, faces[::-1, ::-1], np.zeros((3, 3), dtype=int)])
    assert shape_of(vertices, more, "armchair") == shape_of_form("armchair")


def test_a_mesh_of_many_small_triangles_has_the_shape_of_the_one_with_few() -> None:
    trimesh = pytest.importorskip("trimesh")
    many = trimesh.Trimesh(*form("armchair"), process=False).subdivide_to_size(0.02)
    assert len(many.faces) > 10_000
    size = typical_size("armchair")
    shapes = shape_of_form("armchair"), shape_of(many.vertices, many.faces, "armchair")
    first, second = (standing("armchair", size, shape) for shape in shapes)
    assert agree(spots(first, "sit"), spots(second, "sit"))


def test_a_sofa_without_an_underside_is_filled_and_a_table_stays_hollow() -> None:
    vertices, faces = mesh_of((Part("seat", (-0.5, 0.0, -0.4), (0.5, 0.42, 0.4)),))
    downwards = np.array([(vertices[face][:, 1] == 0).all() for face in faces])
    (seat, *below) = shape_of(vertices, faces[~downwards], "ottoman")
    assert seat.top == pytest.approx(0.42, abs=1e-3)
    assert any(part.low[1] < 0.02 and part.size[0] > 0.9 for part in below)
    table = shape_of_form("dining_table")
    assert all(part.role == "top" or max(abs(part.center[0]), abs(part.center[2])) > 0.3 for part in table)


@for_each("category", ["rug", "plant", "floor_lamp", "picture", "tv"])
def test_decor_keeps_its_form(category: str) -> None:
    assert shape_of(*mesh_of(parts(category, typical_size(category))), category) == ()


@for_each("category", ["wardrobe", "bookshelf", "dresser", "nightstand", "refrigerator", "piano", "trash_can"])
def test_storage_and_the_unknown_are_never_sat_on(category: str) -> None:
    measured = standing(category, typical_size(category), shape_of_form(category))
    assert measured.shape
    assert not spots(measured, "sit")
    assert not spots(measured, "lie")


def test_a_shape_is_written_and_read_again() -> None:
    size = typical_size("l_shaped_sofa")
    placed = standing("l_shaped_sofa", size, shape_of_form("l_shaped_sofa"))
    room = Layout("r", "living_room", ((-3, -3), (-3, 3), (3, 3), (3, -3)), objects=(placed,), tags=("living_room",))
    assert layout_from_dict(json.loads(json.dumps(layout_to_dict(room)))) == room


def test_a_measured_piece_is_drawn_by_its_boxes() -> None:
    size = (0.5, 0.9, 0.5)
    shape = (
        Part("seat", (-0.25, 0.4, -0.2), (0.25, 0.45, 0.25)),
        Part("back", (-0.25, 0.45, -0.25), (0.25, 0.9, -0.2)),
    )
    vertices = np.concatenate([drawn.vertices for drawn in furniture_meshes(standing("dining_chair", size, shape))])
    assert np.allclose(vertices.min(axis=0), (-0.25, 0.4, -0.25), atol=0.01)
    assert np.allclose(vertices.max(axis=0), (0.25, 0.9, 0.25), atol=0.01)


ONE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])


@for_each(
    ("vertices", "faces", "message"),
    [
        (ONE, np.zeros((0, 3), dtype=int), "needs faces"),
        (ONE[:, :2], [[0, 1, 2]], "vertices .N, 3."),
        (ONE, [[0.0, 1.0, 2.0]], "whole numbers"),
        (ONE, [[0, 1, 3]], "vertices 0 to 2"),
        (ONE, [[0, 1, -1]], "vertices 0 to 2"),
        (ONE * np.nan, [[0, 1, 2]], "finite"),
        (ONE * 1e9, [[0, 1, 2]], "metres"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices: Any, faces: Any, message: str) -> None:
    with pytest.raises(LayoutError, match=message):
        shape_of(vertices, faces, "armchair")


def test_a_surface_that_would_take_hours_to_sample_is_refused() -> None:
    rng = np.random.default_rng(0)
    with pytest.raises(LayoutError, match="simplify"):
        shape_of(rng.uniform(-1, 1, (3000, 3)), rng.integers(0, 3000, (40_000, 3)), "armchair")


@tries(2)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.sampled_from(["armchair", "double_bed", "desk", "wardrobe"]))
def test_any_heap_of_triangles_becomes_boxes_within_its_own(seed: int, count: int, category: str) -> None:
    vertices = np.random.default_rng(seed).uniform([-0.5, 0, -0.5], [0.5, 1, 0.5], (3 * count, 3))
    found = shape_of(vertices, np.arange(3 * count).reshape(-1, 3), category)
    assert len(found) <= MAX_PARTS
    assert len(found) > 0
    low, high = vertices.min(axis=0) - 0.02, vertices.max(axis=0) + 0.02
    for part in found:
        assert all(a < b for a, b in zip(part.low, part.high, strict=True))
        assert (part.low >= low).all()
        assert (part.high <= high).all()


# Furniture as others model it.


@cache
def manifest() -> dict[str, dict[str, Any]]:
    data = os.environ.get("SIMS_TEST_DATA")
    folder = Path(data or "") / "layouts" / "meshes_aws_mit0"
    if not data or not folder.is_dir():
        pytest.skip("SIMS_TEST_DATA names no folder with layouts/meshes_aws_mit0")
    rows: list[dict[str, Any]] = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["meshes"]
    return {row["file"].removesuffix(".glb"): row | {"path": folder / row["file"]} for row in rows}


@cache
def mesh(name: str) -> tuple[Array, Faces]:
    trimesh = pytest.importorskip("trimesh")
    loaded = trimesh.load(manifest()[name]["path"], force="mesh")
    return np.asarray(loaded.vertices, dtype=float), np.asarray(loaded.faces)


@cache
def measured(name: str) -> Placed:
    vertices, faces = mesh(name)
    width, height, depth = np.ptp(vertices, axis=0).tolist()
    category = manifest()[name]["category"]
    return standing(category, (width, height, depth), shape_of(vertices, faces, category))


@for_each(
    ("name", "affordance"),
    [("bed", "lie"), ("chaira", "sit"), ("chaird", "sit"), ("sofab", "sit"), ("sofac", "sit"), ("sofac", "lie")],
)
def test_a_real_piece_is_used_at_the_height_it_was_measured_at(name: str, affordance: str) -> None:
    placed = measured(name)
    found = spots(placed, affordance)
    assert found
    for spot in found:
        assert spot.point[1] == pytest.approx(manifest()[name]["flat_regions"][0]["height"], abs=0.03)
        assert stands_outside(placed, spot)


def stands_outside(placed: Placed, spot: Spot) -> bool:
    """Whether none of the mesh's vertices above the ankles is where the one who stands there has the legs."""
    vertices, _ = mesh(next(name for name, row in manifest().items() if row["category"] == placed.category))
    above = vertices[(vertices[:, 1] > 0.12) & (vertices[:, 1] < 1.0)][:, [0, 2]]
    return bool(np.hypot(*(above - spot.standing).T).min() > 0.08)


@for_each("name", ["sofab", "chaira", "chaird", "sofac", "readingdesk", "kitchentable", "shoerack", "trash"])
def test_the_surface_of_a_real_piece_is_nowhere_far_from_its_boxes(name: str) -> None:
    vertices, faces = mesh(name)
    points = np.concatenate([vertices, vertices[faces].mean(axis=1)])
    low, high = (np.array(ends)[:, None] for ends in zip(*((p.low, p.high) for p in measured(name).shape), strict=True))
    gaps = np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0.0), axis=-1).min(axis=0)
    assert np.quantile(gaps, 0.9) < 0.03
    assert gaps.max() < 0.06


def test_both_wings_of_a_real_corner_sofa_are_sat_on() -> None:
    facing = {round(spot.facing / (pi / 2)) for spot in spots(measured("sofac"), "sit")}
    assert facing == {0, 1}


@for_each("name", ["bed", "chaira", "chaird", "sofab", "sofac"])
def test_the_front_of_a_real_piece_is_where_its_maker_put_it(name: str) -> None:
    assert front_of_mesh(*mesh(name), manifest()[name]["category"]) == 0.0


@for_each(
    "name", ["tvcabinet", "nightstand", "wardrobe", "readingdesk", "kitchentable", "refrigerator", "shoerack", "trash"]
)
def test_real_tables_and_storage_are_not_called_seats(name: str) -> None:
    placed = measured(name)
    assert not {part.role for part in placed.shape} & {"seat", "mattress"}
    assert not spots(placed, "sit")
    assert not spots(placed, "lie")


def test_a_chair_goes_under_a_real_table() -> None:
    for part in measured("kitchentable").shape:
        assert part.low[1] > 0.6 or max(abs(part.low[0]), abs(part.high[0])) > 0.5
