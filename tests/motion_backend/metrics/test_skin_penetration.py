"""What is seen of a body in what is seen of a home: on shapes whose depth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_motions import standing_still

from motion_backend.metrics.skin_penetration import THIN, skin_penetration
from motion_backend.motion import Action, Emotion, Skill
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Placed
from scene_graphs.meshes.convex_shapes import WALL, ConvexShape, convex_shapes
from scene_graphs.meshes.furniture_mesh import home_meshes

HOME = home_from_layouts(
    [
        Layout(
            "room", "bedroom", ((0.0, 0.0), (0.0, 5.0), (5.0, 5.0), (5.0, 0.0)),
            objects=(
                Placed("table", "dining_table", (2.5, 0.0, 1.0), (1.6, 0.75, 0.9), 0.4),
                Placed("cabinet", "cabinet", (1.0, 0.0, 4.5), (0.9, 1.0, 0.5), np.pi),
                Placed("bed", "single_bed", (4.2, 0.0, 3.5), (1.0, 0.5, 2.0), 0.0),
                Placed("plant", "plant", (0.6, 0.0, 0.6), (0.5, 1.2, 0.5), 0.0),
            ),
        )
    ],
    0,
)  # fmt: skip


def box(low: tuple[float, float, float], high: tuple[float, float, float], owner: str = "0/box") -> ConvexShape:
    normals = np.concatenate([np.eye(3), -np.eye(3)])
    return ConvexShape(owner, np.array(low), np.array(high), normals, np.concatenate([high, -np.array(low)]))


def test_a_body_in_the_open_is_in_nothing_and_one_in_a_block_is_as_deep_as_the_block_says() -> None:
    body = standing_still()
    assert skin_penetration(body, None, [box((1, 0, -1), (2, 2, 1))]).most == 0
    crown = box((-1.0, 1.60, -1.0), (1.0, 3.0, 1.0))
    found = skin_penetration(body, None, [crown])
    assert found.share == 1.0
    assert 0.06 < found.most < 0.16
    assert skin_penetration(body, None, [box((-1.0, 1.62, -1.0), (1.0, 3.0, 1.0))]).most == pytest.approx(
        found.most - 0.02, abs=0.002
    )


def test_who_sits_may_sink_into_the_seat_and_into_nothing_else() -> None:
    body = standing_still()
    height = float(body.root_positions[0, 1]) - 0.06
    under = box((-0.2, height - 0.4, -0.2), (0.2, height, 0.2), "0/seat")
    sit = Action(Skill.SITDOWN, "sit", Emotion.NEUTRAL, object_id="0/seat")
    free = skin_penetration(body, replace(sit, object_id="0/other"), [under])
    sunk = skin_penetration(body, sit, [under])
    assert sunk.most == pytest.approx(free.most - 0.05, abs=0.02)
    assert skin_penetration(body, replace(sit, skill=Skill.LOCO), [under]).most == free.most


def test_short_motions_are_looked_at_too() -> None:
    crown = box((-1.0, 1.60, -1.0), (1.0, 3.0, 1.0))
    for frames in (1, 4, 31):
        assert skin_penetration(standing_still(frames), None, [crown]).share == 1.0


def test_the_shapes_of_a_home_are_what_is_drawn_of_it() -> None:
    shapes = convex_shapes(HOME)
    assert {shape.owner for shape in shapes} == {WALL, "0/table", "0/cabinet", "0/bed", "0/plant"}
    table = HOME.object("0/table")
    for shape in shapes:
        middle = (shape.low + shape.high) / 2
        assert shape.depth(middle[None])[0] > 0
        assert shape.depth(np.array([shape.low - 0.01, shape.high + 0.01])).max() < 0
    top = max((s for s in shapes if s.owner == "0/table"), key=lambda shape: float(shape.high[1]))
    above, inside = table.to_world((0.6, 0.76, 0.3)), table.to_world((0.6, 0.74, 0.3))
    depth = top.depth(np.array([above, inside]))
    assert depth == pytest.approx([-0.01, 0.01], abs=1e-3)


def test_what_gives_way_or_is_thin_is_left_out() -> None:
    pillows = next(mesh for mesh in home_meshes(HOME) if mesh.name == "0/bed:pillowcase")
    top = pillows.vertices[pillows.vertices[:, 1].argmax()] - [0.0, 0.01, 0.0]
    assert all(shape.depth(top[None])[0] <= 0 for shape in convex_shapes(HOME))
    assert all(shape.thickness >= THIN for shape in convex_shapes(HOME, THIN))
    assert len(convex_shapes(HOME, THIN)) < len(convex_shapes(HOME))
