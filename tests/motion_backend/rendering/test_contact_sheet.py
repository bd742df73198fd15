"""Contact sheets: a row a motion, poses on the line that is the floor, and the stances that were."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_home import contact, small_home, to
from upright_body import walking

from motion_backend import rotations
from motion_backend.body.cast import PLAIN
from motion_backend.director import Director
from motion_backend.motion import Character, Motion, Skill
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.rendering.contact_sheet import CELL, GAP, HEAD, UNDER, _Row, facts, footprints, sheet
from motion_backend.skeleton import INDEX, build_skeleton

HOME = small_home()
TALL = HEAD + 2 * CELL[1] + GAP


def standing(frames: int = 31, raised: float = 0.0) -> Motion:
    skeleton = build_skeleton()
    return Motion(
        root_positions=np.tile([1.0, skeleton.standing_height + raised, 2.0], (frames, 1)).astype(np.float32),
        local_rotations=np.tile(rotations.IDENTITY, (frames, 22, 1)).astype(np.float32),
        contacts=np.ones((frames, 4), dtype=np.float32),
        skeleton=skeleton,
        actions=np.zeros(frames, dtype=np.int32),
    )


def side_cell(page: np.ndarray) -> np.ndarray:
    """The first pose of the first row, seen from the side, without the line beside it."""
    return page[HEAD + CELL[1] : HEAD + 2 * CELL[1], 1 : CELL[0]].astype(int)


def lowest_of_body(page: np.ndarray) -> int:
    cell = side_cell(page)
    dark = (cell.sum(axis=-1) < 400).any(axis=1)
    return int(np.flatnonzero(dark)[-1])


def test_a_page_has_a_row_for_every_motion_and_equal_motions_are_drawn_alike() -> None:
    page = sheet([("a", standing()), ("a", standing())], columns=1)
    assert page.shape == (2 * TALL, CELL[0] + 2 * CELL[1], 3)
    np.testing.assert_array_equal(page[:TALL, : CELL[0]], page[TALL:, : CELL[0]])


def test_a_standing_body_stands_on_the_white_line_and_a_floating_one_above_it() -> None:
    line = round((1.0 - UNDER) * CELL[1])
    page = sheet([("stands", standing())], columns=1)
    assert (side_cell(page)[line, :20] > 250).all()
    assert abs(lowest_of_body(page) - line) <= 2
    assert lowest_of_body(sheet([("floats", standing(raised=0.2))], columns=1)) < line - 8


def test_stances_are_where_the_feet_were_down() -> None:
    motion = standing()
    lifted = motion.contacts.copy()
    lifted[10:20, 2:] = 0
    motion = replace(motion, contacts=lifted)
    joints = motion.joint_positions()
    assert [start for _, start in footprints(motion, joints, "left")] == [0]
    assert [start for _, start in footprints(motion, joints, "right")] == [0, 20]
    (left, _), (right, _) = footprints(motion, joints, "left")[0], footprints(motion, joints, "right")[0]
    assert left[0, 0] > 1.0 > right[0, 0]  # left is +X for a body that faces +Z


def test_a_walk_in_a_room_is_drawn_with_its_furniture() -> None:
    action = to(contact(HOME, Skill.TOUCH, "shelf", "touch medium height"))
    backend = Director(ProceduralBackend())
    motion, _ = backend.act(HOME, action, backend.begin(HOME, Character(), 3))
    bare, there = sheet([("walk", motion)], columns=1), sheet([("walk", motion)], HOME, columns=1)
    assert bare.shape == there.shape
    assert (bare[:, : CELL[0]] != there[:, : CELL[0]]).mean() > 0.1


def test_the_title_tells_what_was_not_done() -> None:
    motion = replace(standing(), completed=False, reason="no way to the chair")
    assert facts(motion) == "1.0 s  ·  0.0 m  ·  NOT DONE: no way to the chair"


def test_a_page_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="at least one motion"):
        sheet([])


def test_a_row_is_seen_from_the_side_of_the_hand_that_does_something() -> None:
    stands = walking((0.0, 0.0, 0.0), 0.0)
    for side, sign in (("left", 1), ("right", -1)):
        turns = stands.local_rotations.copy()
        turns[:, INDEX[f"{side}_shoulder"]] = [0.0, 0.0, 0.0, 1.0]
        assert _Row(replace(stands, local_rotations=turns), [], 8, PLAIN).hand == sign
