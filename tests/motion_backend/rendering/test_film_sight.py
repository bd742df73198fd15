"""What a camera sees of a body, and what crowds its picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion_backend import rotations
from motion_backend.motion import Character, Motion, Phase, PhaseKind
from motion_backend.rendering.film_cuts import Framing, Subject
from motion_backend.rendering.film_sight import Appearances, Look
from motion_backend.rendering.rasterizer import orbit
from motion_backend.rendering.renderer import Solid
from motion_backend.rotations import IDENTITY
from motion_backend.skeleton import INDEX, build_skeleton


def with_knees_drawn_up(radians: float) -> Motion:
    """One frame of who stands in the air with the thighs raised that far."""
    skeleton = build_skeleton(Character().height)
    turns = np.tile(np.float32(IDENTITY), (1, len(skeleton.names), 1))
    for hip in ("left_hip", "right_hip"):
        turns[0, INDEX[hip]] = [-np.sin(radians / 2), 0.0, 0.0, np.cos(radians / 2)]
    return Motion(
        root_positions=np.array([[0.0, skeleton.standing_height, 0.0]], np.float32),
        local_rotations=turns,
        contacts=np.ones((1, 4), np.float32),
        skeleton=skeleton,
        actions=np.zeros(1, np.int32),
    )


def face_of(motion: Motion, legs: bool = True) -> Look:
    """How a face is shown by a camera before it; with legs that count or not."""
    seen = Appearances.of(motion, Framing(0, 1, Subject.FACE), 16 / 9)
    x, y, z = motion.joint_positions()[0, INDEX["head"]].tolist()
    return replace(seen, legs=seen.legs & legs).look([], orbit((x, y - 0.15, z), 1.25, 0.0, 0.0))


def test_a_picture_of_a_face_that_is_full_of_thighs_is_none() -> None:
    standing, curled = (with_knees_drawn_up(radians) for radians in (0.0, 2.0))
    assert face_of(standing).enough
    assert not face_of(curled).enough
    assert face_of(curled, legs=False).enough, "nothing hides the face itself"


def standing_with(*solids: Solid) -> float:
    """How much a picture of somebody standing appeals, seen from 4 m before them, with some things in it."""
    motion = with_knees_drawn_up(0.0)
    seen = Appearances.of(motion, Framing(0, 1), 16 / 9)
    return seen.look([WALL, *solids], orbit((0.0, 0.9, 0.0), 4.0, 0.0, 0.1)).appeal


def upright(low: tuple[float, float], high: tuple[float, float], z: float, opacity: float = 1.0) -> Solid:
    """A board across the view from low to high [x, y]."""
    (left, bottom), (right, top) = low, high
    corners = [(left, bottom, z), (right, bottom, z), (right, top, z), (left, top, z)]
    return Solid(np.array(corners), np.array([[0, 1, 2], [0, 2, 3]]), opacity=opacity)


WALL = upright((-9.0, 0.0), (9.0, 9.0), -2.5)


def test_the_less_of_a_body_is_seen_and_the_more_stands_before_it_the_less_a_picture_appeals() -> None:
    free = standing_with()
    beside = [standing_with(upright((0.5, 0.0), (0.5 + wide, 2.0), 1.5)) for wide in (0.2, 0.5)]
    before = standing_with(upright((-0.2, 0.0), (0.2, 1.1), 0.6))
    assert free > beside[0] > beside[1]
    assert free > before
    rug = upright((0.5, 0.0), (1.0, 0.2), 1.5)
    assert standing_with(rug) == free, "what lies on the floor stands before nobody"


def test_a_lampshade_behind_a_head_is_a_clutter_and_glass_and_what_is_elsewhere_are_none() -> None:
    head = float(with_knees_drawn_up(0.0).joint_positions()[0, INDEX["head"], 1])
    shade = ((-0.12, head + 0.10), (0.12, head + 0.40))
    free = standing_with()
    assert standing_with(upright(*shade, z=-1.0)) < free - 0.3
    assert standing_with(upright(*shade, z=-1.0, opacity=0.25)) == free
    assert standing_with(upright((0.8, 0.9), (1.1, 1.2), z=-1.0)) == free


def lying(yaw: float) -> Motion:
    """One frame of who lies on their back, the head at -z, turned about the vertical."""
    motion = with_knees_drawn_up(0.0)
    down = np.array([-np.sin(np.pi / 4), 0.0, 0.0, np.cos(np.pi / 4)])
    motion.local_rotations[0, 0] = rotations.compose(rotations.yaw_to_quat(yaw), down)
    motion.root_positions[0, 1] = 0.6
    return motion


@pytest.mark.parametrize("yaw", [0.0, 0.9, 2.2, -1.6])
def test_the_face_of_who_lies_is_seen_from_the_head_and_not_from_beneath(yaw: float) -> None:
    seen = Appearances.of(lying(yaw), Framing(0, 1), 16 / 9)
    above, beneath = (seen.look([], orbit((0.0, 0.6, 0.0), 4.0, yaw + 1.57, pitch)) for pitch in (0.9, -0.9))
    assert above.faced
    assert not beneath.faced
    assert above.rank > beneath.rank
    assert above.appeal > beneath.appeal


@pytest.mark.parametrize(("yaw", "faced"), [(0.0, True), (0.8, True), (1.4, True), (2.4, False), (np.pi, False)])
def test_a_view_from_behind_is_taken_only_where_there_is_none_with_the_face(yaw: float, faced: bool) -> None:
    seen = Appearances.of(with_knees_drawn_up(0.0), Framing(0, 1), 16 / 9)
    look = seen.look([], orbit((0.0, 0.9, 0.0), 4.0, yaw, 0.1))
    assert look.faced == faced
    front = seen.look([WALL], orbit((0.0, 0.9, 0.0), 4.0, 0.0, 0.1))
    assert faced or look.rank < front.rank


def test_a_face_that_a_lamp_hides_is_not_seen_and_a_thin_one_before_the_trunk_counts() -> None:
    seen = Appearances.of(with_knees_drawn_up(0.0), Framing(0, 1), 16 / 9)
    x, y, z = with_knees_drawn_up(0.0).joint_positions()[0, INDEX["head"]].tolist()
    camera = orbit((0.0, 0.9, 0.0), 4.0, 0.0, 0.1)
    free, shaded, thin = (
        seen.look([WALL, *before], camera)
        for before in (
            [],
            [upright((x - 0.3, y - 0.3), (x + 0.3, y + 0.4), z + 0.5)],
            [upright((-0.05, 0.0), (0.05, 1.3), 0.5)],
        )
    )
    assert free.faced
    assert not shaded.faced
    assert thin.faced
    assert thin.appeal < free.appeal - 0.3


def test_nobody_asks_for_the_face_of_who_walks() -> None:
    motion = with_knees_drawn_up(0.0)
    walks = replace(motion, phases=(Phase(PhaseKind.WALK, 0, 1),))
    back = orbit((0.0, 0.9, 0.0), 4.0, np.pi, 0.1)
    assert not Appearances.of(motion, Framing(0, 1), 16 / 9).look([], back).faced
    assert Appearances.of(walks, Framing(0, 1), 16 / 9).look([], back).faced


def test_a_hand_before_the_trunk_appeals_to_who_sees_it_and_not_to_who_is_behind() -> None:
    motion = with_knees_drawn_up(0.0)
    turn = rotations.axis_to_quat("y", np.array(-1.4))
    motion.local_rotations[0, INDEX["left_shoulder"]] = turn  # out of the T-pose to the front
    hand = motion.joint_positions()[0, INDEX["left_wrist"]]
    assert hand[2] > 0.3
    deed = Framing(0, 1, hands=(INDEX["left_wrist"],), deed=(0, 1))

    def gain(yaw: float) -> float:
        camera = orbit((0.0, 0.9, 0.0), 4.0, yaw, 0.1)
        with_deed, without = (Appearances.of(motion, framing, 16 / 9) for framing in (deed, Framing(0, 1)))
        return with_deed.look([], camera).appeal - without.look([], camera).appeal

    assert gain(0.5) > 2.0
    assert gain(np.pi) < 0.5 * gain(0.5)


def test_what_is_outside_of_a_home_is_no_picture() -> None:
    seen = Appearances.of(with_knees_drawn_up(0.0), Framing(0, 1), 16 / 9)
    camera = orbit((0.0, 0.9, 0.0), 4.0, 0.0, 0.1)
    half = upright((-9.0, -9.0), (0.0, 9.0), -4.0)
    nothing, some, full = (seen.look(scene, camera).appeal for scene in ([], [half], [WALL]))
    assert nothing + 0.5 < some < full - 0.5


def test_ground_that_fills_a_picture_is_as_much_outside_as_nothing_and_hides_as_a_floor_does() -> None:
    seen = Appearances.of(with_knees_drawn_up(0.0), Framing(0, 1), 16 / 9)
    camera = orbit((0.0, 0.9, 0.0), 4.0, 0.0, 0.1)
    ground = replace(WALL, outside=True)
    nothing, outside, inside = (
        seen.look([wall], camera).appeal for wall in (upright((90.0, 0.0), (91.0, 1.0), 1.0), ground, WALL)
    )
    assert outside == pytest.approx(nothing)
    assert inside > outside + 2.0
    before = replace(upright((-9.0, 0.0), (9.0, 9.0), 1.0), outside=True)
    assert seen.look([before], camera).shown == 0.0


def test_what_is_held_counts_by_its_worst_second_too() -> None:
    motion = with_knees_drawn_up(0.0)
    long = replace(
        motion,
        root_positions=np.repeat(motion.root_positions, 90, axis=0),
        local_rotations=np.repeat(motion.local_rotations, 90, axis=0),
        contacts=np.repeat(motion.contacts, 90, axis=0),
        actions=np.repeat(motion.actions, 90),
    )
    seen = Appearances.of(long, Framing(0, 90), 16 / 9)
    free, hidden = np.array([[0.9, 1.2, 0.2]]), np.array([[0.9, 1.2, -3.0]])
    looks = len(seen.vertices)
    # As many looks with it hidden, in a row or one here and one there.
    row = tuple(hidden if at < looks // 2 else free for at in range(looks))
    spread = tuple(hidden if at % 2 else free for at in range(looks))
    camera = orbit((0.0, 0.9, 0.0), 4.0, 0.0, 0.1)
    appeals = [replace(seen, held=held).look([WALL], camera).appeal for held in ((free,) * looks, spread, row)]
    assert appeals[0] > appeals[1] > appeals[2]


def test_a_wall_with_one_side_hides_a_body_from_that_side_alone() -> None:
    """The hall behind a door is drawn for who looks out of the room."""
    motion = with_knees_drawn_up(0.0)
    bodies = Appearances.of(motion, Framing(0, 1), 16 / 9)
    corners = np.array([[-2.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 3.0, 1.0], [-2.0, 3.0, 1.0]])
    towards_us = Solid(corners, np.array([[0, 1, 2], [0, 2, 3]]), normals=np.tile([0.0, 0.0, 1.0], (4, 1)))
    turned_away = replace(towards_us, faces=towards_us.faces[:, ::-1])
    camera = orbit((0.0, 0.9, 0.0), 4.0, 0.0, 0.1)
    assert bodies.shares([towards_us], camera).max() == 0.0
    assert np.array_equal(bodies.shares([turned_away], camera), bodies.shares([], camera))


def test_no_picture_is_better_than_the_best_that_there_may_be() -> None:
    motion = with_knees_drawn_up(0.5)
    bodies = Appearances.of(motion, Framing(0, 1, hands=(20, 21), deed=(0, 1)), 16 / 9)
    for yaw in np.linspace(-np.pi, np.pi, 9):
        assert bodies.look([], orbit((0.0, 0.9, 0.0), 4.0, float(yaw), 0.1)).appeal <= bodies.most
