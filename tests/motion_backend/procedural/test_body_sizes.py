"""Bodies of any size on furniture made for grown-ups: none sinks in, feet that do not come down hang."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from for_each import for_each
from layers import sampled
from small_home import DIRECTOR, after, contact, rise, small_home

from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import penetration
from motion_backend.metrics.skin_penetration import THIN, skin_penetration
from motion_backend.motion import Action, Motion, Posture, Skill, join
from motion_backend.procedural.held_poses import Seat
from motion_backend.procedural.sit.sit_legs import at_front, feet_hang
from motion_backend.procedural.sit.sit_skill import seat_for
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX, MAX_HEIGHT, MIN_HEIGHT, REFERENCE_HEIGHT
from scene_graphs.affordances.affordances import spots
from scene_graphs.meshes.convex_shapes import convex_shapes

HOME = small_home()
HEIGHTS = (MIN_HEIGHT, 1.17, 1.4, 2.1)
DEEPEST = 0.05


def sitting(piece: str, height: float) -> Action:
    """Sitting there as the planning side places a body of that height."""
    action = contact(HOME, Skill.SITDOWN, piece, "sitting still")
    found = spots(HOME.object(f"0/{piece}"), "sit")
    obstacles = scene_of(HOME).obstacles
    spot = seat_for(found, action.emotion, action.caption, obstacles, height / REFERENCE_HEIGHT)
    return replace(action, spot=spot)


def acted(actions: tuple[Action, ...], height: float) -> Motion:
    """All of them, one after the other."""
    state, made = after(HOME, height=height), []
    for action in actions:
        motion, state = DIRECTOR.act(HOME, action, state)
        assert motion.completed, motion.reason
        depth = penetration(Kinematics.of(motion), scene_of(HOME).obstacles, action)
        assert depth.max() <= DEEPEST, (action.skill, height, depth.max())
        made.append(motion)
    assert state.posture is Posture.STANDING
    return join(made)


@pytest.mark.parametrize(
    ("piece", "height"), sampled([(piece, height) for height in HEIGHTS for piece in ("chair", "sofa")], 3)
)
def test_nobody_sinks_into_a_seat_or_leaves_it_through_its_edge(piece: str, height: float) -> None:
    sit = sitting(piece, height)
    acted((sit, rise(sit)), height)


@pytest.mark.parametrize("height", sampled([MIN_HEIGHT, 2.1], 2))
def test_nobody_sinks_into_a_bed(height: float) -> None:
    lie = contact(HOME, Skill.LIEDOWN, "bed", "hands on belly")
    acted((lie, rise(lie, Skill.GETUP)), height)


@for_each("height", [1.17, 1.7])
def test_feet_hang_exactly_where_legs_are_too_short_for_the_seat(height: float) -> None:
    sit, scale = sitting("sofa", height), height / REFERENCE_HEIGHT
    assert sit.spot is not None
    motion, _ = DIRECTOR.act(HOME, sit, after(HOME, height=height))
    ankles = motion.joint_positions()[-1, [INDEX["left_ankle"], INDEX["right_ankle"]], 1]
    seat = Seat.of(sit.spot)
    assert feet_hang(seat, scale) == (scale < 1)
    assert bool((ankles > 0.1).all()) == (scale < 1)
    assert motion.contacts[-1].any() == (scale >= 1)


@for_each(("piece", "height"), [("chair", 1.1), ("sofa", 1.1), ("chair", 1.3), ("sofa", 1.3)])
def test_who_is_small_sits_back_with_the_knees_over_the_edge_and_calves_before_it(piece: str, height: float) -> None:
    sit, scale = sitting(piece, height), height / REFERENCE_HEIGHT
    assert sit.spot is not None
    motion, _ = DIRECTOR.act(HOME, sit, after(HOME, height=height))
    seat, last = Seat.of(sit.spot), motion.part(len(motion) - 10, len(motion))
    ahead = np.array([np.sin(seat.yaw), 0.0, np.cos(seat.yaw)])
    places = last.joint_positions()[-1]
    over = (places[[INDEX["left_knee"], INDEX["right_knee"]]] - seat.pelvis) @ ahead - seat.edge
    assert (over > 0).all()
    assert (over < 0.1 * scale).all()
    assert skin_penetration(last, sit, convex_shapes(HOME, THIN)).most < 0.01


def test_the_front_of_a_seat_is_where_it_was_for_those_who_need_no_other() -> None:
    seat = Seat(np.array([0.0, 0.54, 0.0]), 0.0, 0.3, 0.33)
    slides = [float(at_front(seat, height / REFERENCE_HEIGHT).pelvis[2]) for height in np.arange(1.1, MAX_HEIGHT, 0.1)]
    assert slides == sorted(slides, reverse=True)
    assert slides[0] > 0.2
    assert at_front(seat, 1.0) is seat
