"""Tables of touching, gestures, walking and holding still: units, bounds and orders that rows must keep."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from importlib.resources import files
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from for_each import for_each

from motion_backend.procedural.emotion_style import Bearing, arm_poses
from motion_backend.procedural.held_poses import idle_table, standing
from motion_backend.procedural.lie.lie_keys import lie_keys
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.sit.sit_keys import sit_keys
from motion_backend.procedural.style_sheet import read_style_sheet
from motion_backend.procedural.touch.gestures import Move, MoveKey, gesture_table
from motion_backend.procedural.touch.hand_actions import STAGES
from motion_backend.procedural.touch.hand_captions import Handled, Laid
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.procedural.touch.reach import Manner, touch
from motion_backend.procedural.touch.touch_keys import TouchKeys, TouchTable, touch_keys
from motion_backend.procedural.walk.arm_swing import arm_table
from motion_backend.procedural.walk.cadence import cadence
from motion_backend.procedural.walk.carriage import carriage
from motion_backend.procedural.walk.foot_trajectory import foot_table
from motion_backend.procedural.walk.footsteps import footstep_table
from motion_backend.procedural.walk.gait_character import character_table
from motion_backend.procedural.walk.pelvis_height import pelvis_table
from motion_backend.procedural.walk.root_path import root_path_table
from motion_backend.procedural.walk.way_junction import junction_table
from motion_backend.skeleton import build_skeleton
from scene_graphs.data_tables import read_table

TOUCH = touch_keys()
HANDLINGS = [row.changes for row in read_style_sheet("touch.toml", Handled).captions]
DEEDS = ["", *(changes["doing"] for changes in HANDLINGS if "doing" in changes)]
TABLES = {
    "touch": TOUCH, "gestures": gesture_table(), "idle": idle_table(), "carriage": carriage(), "feet": foot_table(),
    "steps": footstep_table(), "cadence": cadence(), "arms": arm_table(), "pelvis": pelvis_table(),
    "root": root_path_table(), "junction": junction_table(), "character": character_table(),
}  # fmt: skip
UNITS = {
    "s", "m", "rad", "deg", "share", "ratio", "hz", "arms", "frames", "steps", "phase", "mps", "mps2", "radps", "cos",
    "power", "sigmas", "m2", "s2", "rad2", "hz2",
}  # fmt: skip
PLAIN = {
    "at", "out", "up", "ahead", "middle", "slow_double", "hop_lift", "hop_land", "hop_middle", "skip_lift",
    "skip_land", "skip_middle", "size_min", "points_down", "tiptoe",
}  # fmt: skip
"""Columns that are phases of a step, parts of a direction or costs, as the head of their file says."""
SKELETON = build_skeleton(1.7)


def numbers(rows: Any, where: str) -> Iterator[tuple[str, str, float]]:
    """Every number of a table: where it stands, its column, and itself."""
    for field in fields(rows):
        value, inside = getattr(rows, field.name), f"{where}.{field.name}"
        if is_dataclass(value):
            yield from numbers(value, inside)
        elif isinstance(value, Mapping):
            for name, each in value.items():
                if is_dataclass(each):
                    yield from numbers(each, f"{inside}.{name}")
                elif isinstance(each, float):
                    yield f"{inside}.{name}", name if field.name == "spread" else field.name, each
        elif isinstance(value, tuple) and value and is_dataclass(value[0]):
            for index, row in enumerate(value):
                yield from numbers(row, f"{inside}[{getattr(row, 'name', index)}]")
        elif isinstance(value, float | int) and not isinstance(value, bool):
            yield inside, field.name, float(value)


NUMBERS = [found for name, rows in TABLES.items() for found in numbers(rows, name)]


def test_every_table_is_read_by_one_of_the_readers() -> None:
    read_table.cache_clear()
    for reader in (touch_keys, gesture_table, idle_table, carriage, foot_table, footstep_table, cadence, arm_table,
                   pelvis_table, root_path_table, junction_table, character_table,
                   sit_keys, lie_keys):  # fmt: skip
        reader()
    data = files("motion_backend").joinpath("data")
    shipped = [
        one for folder in ("", "gait", "transitions") for one in data.joinpath(folder).iterdir()
        if one.name in {"gestures.toml", "idle.toml"} or (folder and one.name.endswith(".toml"))
    ]  # fmt: skip
    assert read_table.cache_info().currsize == len(shipped)


def test_every_column_has_a_unit() -> None:
    assert len(NUMBERS) > 400
    unnamed = [where for where, column, _ in NUMBERS if column not in PLAIN and column.rsplit("_", 1)[-1] not in UNITS]
    assert not unnamed


def test_shares_are_shares_and_times_and_rates_go_on() -> None:
    ends = {"share": (0.0, 1.0), "s": (0.0, 15.0), "hz": (0.01, 10.0), "m": (-2.0, 3.0), "cos": (0.0, 1.0)}
    plain = [(where, column.rsplit("_", 1)[-1], number) for where, column, number in NUMBERS if "_per_" not in column]
    assert not [where for where, unit, number in plain if unit in ends and not ends[unit][0] <= number <= ends[unit][1]]


def test_what_is_least_is_not_above_what_is_most() -> None:
    found = {where: number for where, _, number in NUMBERS}
    pairs = [
        (where, other)
        for where in found
        for low, high in (("_min_", "_max_"), ("_lift", "_land"), ("_from_share", "_to_share"))
        if (other := where.replace(low, high)) != where and other in found
    ]
    assert len(pairs) >= 9
    assert not [where for where, other in pairs if found[where] >= found[other]]


def test_shares_of_one_thing_add_up_to_it() -> None:
    gestures, approach, arms = gesture_table(), TOUCH.reach.approach, arm_table().swing
    sums = {
        "a line": gestures.write.written_share + gestures.write.returned_share,
        "eyes": approach.eyes_there_share + approach.eyes_kept_share,
        "reaching": TOUCH.reach.search.hips_share + TOUCH.reach.search.spine_share,
        "kneeling": TOUCH.kneel.body.hips_share + TOUCH.kneel.body.spine_share,
        "walking": carriage().lean.hips_share + carriage().lean.spine_share,
        "elbow": arms.shoulder_share + arms.forearm_share,
        "moving": arms.still_share + arms.moving_share,
        "arm": arms.upper_arms + arms.lower_arms,
    }
    assert sums == pytest.approx(dict.fromkeys(sums, 1.0))
    assert gestures.read.leaf_at_share + gestures.read.leaf_share < 1.0


@for_each("doing", DEEDS)
def test_a_touch_goes_to_the_thing_and_comes_away_from_it(doing: str) -> None:
    rows = TOUCH.of(doing)
    poses = {row.name: row for row in rows.pose}
    assert max(Counter(row.name for row in rows.pose).values()) == 1
    assert {key.pose for key in rows.key} == set(poses)
    stages = [STAGES.index(key.stage) for key in rows.key]
    assert stages == sorted(stages)
    assert {0, 2} <= set(stages)
    came, gone = ([poses[key.pose] for key in rows.key if key.stage == stage] for stage in ("come", "leave"))
    # From over the surface onto it, but with a blow; eyes first, and back to standing.
    first = next(row for row in came if row.body == "at it")
    assert came.index(first) > [row.body for row in came].index("looking")
    assert (first.off_m > 0, min(row.off_m for row in came if row.body == "at it"), came[-1].body) == (
        rows.stroke is None,
        0.0,
        "at it",
    )
    # Who stirs or pours takes something there, and does it over the thing.
    assert (came[-1].off_m > 0) == (doing in ("stir", "pour"))
    assert (gone[0].body, gone[-1].body) == ("at it", "standing")
    assert poses[rows.key[-1].pose].body == "standing"
    assert all(poses[key.pose].body == "at it" for key in rows.key if key.stage == "do")
    assert all(poses[key.pose].body == "standing" for key in rows.key if key.stage == "after")
    assert all(key.wait_s > 0 for key in rows.key)
    # What stays on the thing needs no keys there, what does not says which share of the hold is over.
    assert (doing in ("", "wash", "rotate", "strike", *TOUCH.held.busy)) != ("do" in {key.stage for key in rows.key})
    assert (
        (rows.busy_s > 0) == ("hold" in {key.pace for key in rows.key}) == ("after" in {key.stage for key in rows.key})
    )
    assert {row.arms for row in rows.pose} - {""} <= set(arm_poses())
    assert {TOUCH.reach.free_arm.high, TOUCH.reach.free_arm.doing[doing]} <= set(arm_poses())


def test_who_kneels_goes_down_on_one_knee_and_then_the_other() -> None:
    rows = TOUCH.kneel.pose
    heights = [row.pelvis_up_m for row in rows]
    assert heights == sorted(heights, reverse=True)
    order = ("standing", "lifted", "back")
    for feet in ([row.left for row in rows], [row.right for row in rows]):
        steps = [order.index(foot) for foot in feet]
        assert steps == sorted(steps)
        assert steps[-1] == 2
    assert not [row.name for row in rows if row.left == row.right == "lifted"]
    # The pelvis stays over the knees that bear it.
    assert all(0.0 < row.pelvis_back_m < TOUCH.kneel.body.behind_m for row in rows)


def test_feet_end_their_step_as_they_began_it() -> None:
    curves = foot_table().curve
    for name, points in ((field.name, getattr(curves, field.name)) for field in fields(curves)):
        times = [point.at for point in points]
        values = [point.up_m if name == "level" else point.share for point in points]
        assert (np.diff(times) > 0).all(), name
        assert (values[0], values[-1]) == (0.0, 0.0), name
        assert (times[0], times[-1]) == ((0.0, 1.0) if name in ("usual", "lifted", "level") else (-1.0, 2.0)), name
        assert name == "level" or max(values) == 1.0, name
    # The heel leads the way up, and the tip of the foot comes up before it is set down.
    assert max(curves.heel_off, key=lambda point: point.share).at < 0.5
    assert 0.8 < max(curves.heel_strike, key=lambda point: point.share).at <= 1.0


def test_every_gesture_moves_something_and_its_keys_come_one_after_the_other() -> None:
    for name, move in gesture_table().moves.items():
        assert all(row.left_arms or row.up_arms or row.ahead_arms for row in move.hands), name
        assert all(row.forward_rad or row.turn_rad or row.side_rad or row.up_m for row in move.trunk), name
        assert move.hands or move.trunk or move.keys, name
        times = [0.0, *(key.at_share for key in move.keys), 1.0]
        assert (np.diff(times) > 0).all(), name
        assert {arm for key in move.keys for arm in key.arms} <= {"", *arm_poses()}, name
        bursts = [*(row.burst for row in move.hands), *(row.burst for row in move.trunk)]
        assert all(2 * one.rises_s <= one.lasts_s < one.every_s for one in bursts if one is not None), name


def test_a_foot_of_a_gesture_goes_nowhere_but_through_the_air() -> None:
    for name, move in gesture_table().moves.items():
        keys = [MoveKey(at_share=0.0), *move.keys, MoveKey(at_share=1.0, feet_turn_rad=_about(move))]
        for before, after in pairwise(keys):
            for index, foot in enumerate(("left_foot_m", "right_foot_m")):
                here, there = np.array(getattr(before, foot)), np.array(getattr(after, foot))
                if here[1] == there[1] == 0.0 and before.flight_m == after.flight_m == 0.0:
                    assert (here == there).all(), (name, foot, after.at_share)
                    assert before.feet_turn_rad[index] == after.feet_turn_rad[index], (name, foot, after.at_share)


def _about(move: Move) -> tuple[float, float]:
    """How far feet have turned by the end: back to where they were, or once about."""
    return move.keys[-1].feet_turn_rad if move.keys else (0.0, 0.0)


def touched(doing: str, keys: TouchKeys, prone: bool = False) -> Pose:
    """A hand on a table in the middle of nowhere."""
    start = standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    up = np.array([0.0, 1.0, 0.0])
    wrist = np.array([-0.2, 0.35, 0.75]) if prone else np.array([-0.2, 0.95, 0.45])
    laid = Laid(wrist, palm_on(up, 0.0, "right"), up, "right", stroke=np.array([0.09, 0.0, 0.0]))
    manner, rng = Manner(Bearing(), 2.5, doing, prone), np.random.default_rng(0)
    return touch(start, laid, manner, SKELETON, lambda points: -np.ones(len(points)), keys, rng)


def varied(doing: str, **columns: Any) -> TouchKeys:
    """The shipped tables with columns of all rows of a touch that have them changed."""
    rows = TOUCH.of(doing)
    names = {field.name for field in fields(rows.pose[0])} & set(columns)
    posed = tuple(replace(row, **{name: columns[name] for name in names if getattr(row, name)}) for row in rows.pose)
    slower = tuple(replace(key, wait_s=columns.get("wait_ratio", 1.0) * key.wait_s) for key in rows.key)
    changed: TouchTable = replace(rows, pose=posed, key=slower)
    by_doing: dict[str, Any] = {doing or "rest": changed}
    return replace(TOUCH, **by_doing)


@for_each("doing", DEEDS)
def test_a_slower_table_makes_a_longer_touch(doing: str) -> None:
    assert len(touched(doing, varied(doing, wait_ratio=1.5))) > len(touched(doing, TOUCH)) + 5


def test_other_rows_make_another_touch_and_end_where_it_ended() -> None:
    plain, varied_ = touched("pick", TOUCH), touched("pick", varied("pick", head_forward_rad=0.7, arms_up_arms=-0.2))
    assert (varied_.head - plain.head)[:, 0].max() == pytest.approx(0.25, abs=0.02)
    assert (plain.arms - varied_.arms)[:, 1, 1].max() == pytest.approx(0.1, abs=0.03)
    np.testing.assert_allclose(varied_.pelvis[-1], plain.pelvis[-1], atol=1e-9)


def test_who_kneels_kneels_as_the_rows_say() -> None:
    rows = tuple(replace(row, pelvis_up_m=row.pelvis_up_m + 0.05) for row in TOUCH.kneel.pose)
    higher = replace(TOUCH, kneel=replace(TOUCH.kneel, pose=rows))
    plain, varied_ = touched("", TOUCH, prone=True), touched("", higher, prone=True)
    assert (varied_.pelvis - plain.pelvis)[:, 1].max() == pytest.approx(0.05, abs=0.01)
