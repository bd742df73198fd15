"""Key poses are rows: columns with units, times in order, no column too many; and other rows make another motion."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion_backend.body.joint_limits import CLEARLY, beyond_limits
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import Seat, part_way, standing
from motion_backend.procedural.lie.lie_keys import LieDown, LieKeys, RiseToEdge, lie_keys
from motion_backend.procedural.lie.lie_legs import BACK
from motion_backend.procedural.lie.lie_on_floor import Mat, kneel_down, lie_down_from_knees
from motion_backend.procedural.lie.lie_pose import Bed, lying
from motion_backend.procedural.lie.lie_styles import Lying
from motion_backend.procedural.lie.lie_transition import edge_seat, lie_down
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.sit.sit_keys import SitDown, SitKeys, SitPose, StandUp, sit_keys
from motion_backend.procedural.sit.sit_legs import WAYS, Room
from motion_backend.procedural.sit.sit_pose import SURFACES, Place
from motion_backend.procedural.sit.sit_styles import Seated
from motion_backend.procedural.sit.sit_transition import NOTHING, sit_down, stand_up
from motion_backend.procedural.touch.handholds import Handholds
from motion_backend.skeleton import LYING_REST, SEATED_REST, build_skeleton
from scene_graphs import data_tables
from scene_graphs.data_tables import TableError, read_table

SIT, LIE = sit_keys(), lie_keys()
UNITS = ("_s", "_m", "_rad", "_deg", "_share", "_ratio", "_direction")
SKELETON = build_skeleton(1.7)
SEAT = Seat(np.array([0.0, 0.45 + SEATED_REST, 0.0]), 0.0, np.inf, 0.25)
BED = Bed(np.array([0.0, 0.45 + LYING_REST, 0.0]), 0.0, np.pi / 2, 0.6)
FLOOR = Bed(np.array([0.0, LYING_REST, 0.0]), 0.0, np.pi / 2, 0.6)


def numbers(keys: Any, where: str = "") -> Iterator[tuple[str, str, float]]:
    """Every number of tables: where it stands, its column, and itself."""
    for field in fields(keys):
        value = getattr(keys, field.name)
        inside = f"{where}.{field.name}"
        if is_dataclass(value):
            yield from numbers(value, inside)
        elif isinstance(value, tuple) and is_dataclass(value[0]):
            for row in value:
                yield from numbers(row, f"{inside}[{getattr(row, 'name', '')}]")
        elif isinstance(value, float | tuple):
            yield from ((inside, field.name, number) for number in np.atleast_1d(value).tolist())


NUMBERS = [*numbers(SIT, "sit"), *numbers(LIE, "lie")]


def test_every_number_has_a_unit_in_its_column_and_every_share_is_one() -> None:
    assert len(NUMBERS) > 500
    assert not [where for where, column, _ in NUMBERS if not column.endswith(UNITS)]
    assert not [where for where, column, share in NUMBERS if column.endswith("_share") and not 0.0 <= share <= 1.0]


def test_no_time_runs_backwards() -> None:
    assert not [where for where, column, number in NUMBERS if column.endswith("_s") and number < 0.0]
    assert not [where for where, column, number in NUMBERS if column.endswith("wait_s") and number <= 0.0]
    down, up = ([row.time_share for row in keys.pose] for keys in (SIT.down, SIT.up))
    assert down[-1] == 1.0
    assert (np.diff([0.0, *down]) > 0).all()
    assert (np.diff([0.0, *up, 1.0]) > 0).all()
    settle = SIT.down.settle
    assert (np.diff([0.0, *(row.time_s + row.tempo_time_s for row in settle)]) > 0).all()
    for floor in (LIE.floor_down, LIE.floor_up):
        assert all(step.begins_s < step.ends_s for step in (floor.left_step, floor.right_step))


def test_the_way_down_leads_to_the_seat_and_the_way_up_from_it() -> None:
    back, drop = (
        [getattr(row, column) for row in SIT.down.pose] for column in ("pelvis_back_share", "pelvis_down_share")
    )
    ahead, rise = (
        [getattr(row, column) for row in SIT.up.pose[1:]] for column in ("pelvis_ahead_share", "pelvis_up_share")
    )
    for shares in (back, drop, [*ahead, 1.0], [*rise, 1.0]):
        assert (np.diff([0.0, *shares]) > 0).all()
        assert shares[-1] == 1.0
    # The weight goes over before it goes down, and is over the feet before it goes up.
    assert all(far >= deep for far, deep in zip(back, drop, strict=True))
    assert all(far >= high for far, high in zip(ahead, rise, strict=True))
    assert SIT.down.pose[-1].felt_share == 1.0
    assert SIT.down.settle[-1].sink_ratio == 0.0


def test_rows_have_names_of_their_own_and_all_that_are_asked_for_are_there() -> None:
    lists = (
        SIT.pose.legs.pose, SIT.pose.surface, SIT.down.pose, SIT.down.settle, SIT.up.pose,
        LIE.pose.leg, LIE.pose.side_legs, LIE.pose.back_hand, LIE.pose.below_hand, LIE.pose.above_hand,
        LIE.down.pose, LIE.up.pose, LIE.floor_down.pose, LIE.floor_up.pose,
    )  # fmt: skip
    for rows in lists:
        assert max(Counter(row.name for row in rows).values()) == 1
    assert {row.name for row in SIT.pose.legs.pose} == {leg for pair in WAYS.values() for leg in pair}
    assert {row.name for row in SIT.pose.surface} == set(SURFACES)
    assert {row.name for row in LIE.pose.leg} == {leg for pair in BACK.values() for leg in pair}
    assert {"straight", "bent", "tucked", "gathered"} <= {row.name for row in LIE.pose.side_legs}


def test_arms_with_less_and_less_room_come_to_an_end() -> None:
    hands = {row.name: row for row in LIE.pose.back_hand}
    for row in hands.values():
        assert (row.narrower is None) == (row.room_m == 0.0)
        assert row.narrower is None or hands[row.narrower].room_m < row.room_m, row.name


SCHEMAS = {
    "sit_pose": SitPose,
    "sit_down": SitDown,
    "stand_up": StandUp,
    "lie_down": LieDown,
    "rise_to_edge": RiseToEdge,
}


@pytest.fixture
def read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, Callable[[str], str]], Any]:
    """Reads a shipped table after a change to its text."""

    def reading(name: str, change: Callable[[str], str]) -> Any:
        text = files("motion_backend").joinpath(f"data/transitions/{name}.toml").read_text(encoding="utf-8")
        assert change(text) != text
        folder = tmp_path / "data" / "transitions"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.toml").write_text(change(text), encoding="utf-8")
        monkeypatch.setattr(data_tables, "files", lambda _package: tmp_path)
        return read_table.__wrapped__("motion_backend", f"transitions/{name}.toml", SCHEMAS[name])

    return reading


@pytest.mark.parametrize(
    ("name", "old", "new", "place"),
    [
        ("sit_down", "time_share = 0.42", "time_share = 0.42\nspeed = 3", r"pose\.0\.speed"),
        ("sit_down", "felt_share = 0.7\n", "", r"pose\.1\.felt_share"),
        ("sit_pose", 'foot = "heel"', 'foot = "heels"', r"legs\.pose\.3\.foot"),
        ("stand_up", 'name = "ready"', 'name = "lift"', r"pose\.0\.name"),
        ("lie_down", "spine_side_rad = 0.12", "spine_side_rad = inf", r"pose\.3\.spine_side_rad"),
        ("lie_down", "[-0.30, -0.50, 0.45]", "[-0.30, -0.50]", r"pose\.3\.above_wrist_ratio"),
        ("rise_to_edge", 'name = "rolled"', 'name = "sitting"', r"side\.name"),
    ],
)
def test_a_column_too_many_or_too_few_and_a_row_out_of_its_place_are_refused(
    read: Callable[[str, Callable[[str], str]], Any], name: str, old: str, new: str, place: str
) -> None:
    with pytest.raises(TableError, match=rf"data/transitions/{name}\.toml: .*{place}"):
        read(name, lambda text: text.replace(old, new, 1))


def down(keys: SitKeys) -> Pose:
    """Sitting down in the middle of nowhere."""
    stood = standing(SEAT.standing_point(SKELETON.scale), 0.0, Bearing(), SKELETON)
    place = Place(SEAT, Handholds(), (Room(0.8, 0.4), Room(0.8, 0.4)))
    return sit_down(stood, place, Seated(), NOTHING, SKELETON, keys)[0]


def test_a_varied_row_changes_its_stretch_of_the_motion_and_not_the_end() -> None:
    hinge, *others = SIT.down.pose
    bowed = replace(SIT, down=replace(SIT.down, pose=(replace(hinge, spine_pitch_share=0.9), *others)))
    plain, varied = down(SIT), down(bowed)
    assert len(plain) == len(varied)
    bend = varied.spine[:, 0] - plain.spine[:, 0]
    assert bend.max() > 0.1
    assert np.argmax(np.abs(bend)) < len(plain) // 2
    np.testing.assert_allclose(varied.pelvis[-1], SEAT.pelvis, atol=1e-9)
    np.testing.assert_allclose(varied.spine[-1], plain.spine[-1], atol=1e-9)
    assert beyond_limits(solve(varied, SKELETON)[1]).max() < CLEARLY


def test_one_more_row_is_one_more_key_pose() -> None:
    hinge, low, contact = SIT.down.pose
    before = replace(hinge, name="unlock", time_share=0.2, pelvis_back_share=0.4, pelvis_down_share=0.02)
    more = replace(SIT, down=replace(SIT.down, pose=(before, hinge, low, contact)))
    assert len(down(more)) == len(down(SIT))
    assert (down(SIT).pelvis - down(more).pelvis)[:, 2].max() > 0.05


def test_a_slower_table_takes_longer_in_proportion() -> None:
    seated = down(SIT)
    seated = seated.at(len(seated) - 1)
    lengths = []
    for factor in (1.0, 2.0):
        rise = replace(SIT.up.rise, time_s=factor * SIT.up.rise.time_s)
        lengths.append(len(stand_up(seated, SEAT, Bearing(), NOTHING, SKELETON, replace(SIT.up, rise=rise))))
    assert lengths[1] - lengths[0] == pytest.approx(FPS * SIT.up.rise.time_s, rel=0.2)


def lain(keys: LieKeys) -> Pose:
    seat = edge_seat(BED, (0.8, 0.0), np.pi / 2, 0.6, SKELETON.scale)
    seated = replace(standing((0.8, 0.0), np.pi / 2, Bearing(), SKELETON), pelvis=seat.pelvis)
    return lie_down(seated, seat, BED, Lying(), SKELETON, keys)


def test_a_bed_is_lain_on_as_its_rows_say() -> None:
    look, hand, lifted, elbow, legs = LIE.down.pose
    high = replace(elbow, pelvis_up_m=elbow.pelvis_up_m + 0.1)
    plain, varied = lain(LIE), lain(replace(LIE, down=replace(LIE.down, pose=(look, hand, lifted, high, legs))))
    assert (varied.pelvis - plain.pelvis)[:, 1].max() == pytest.approx(0.1, abs=0.01)
    np.testing.assert_allclose(varied.ankles[-1], plain.ankles[-1], atol=1e-9)
    longer = replace(LIE, down=replace(LIE.down, settle=replace(LIE.down.settle, bent_wait_s=1.75)))
    assert len(lain(longer)) - len(plain) == FPS


def test_the_floor_is_lain_on_as_its_rows_say() -> None:
    mat = Mat(FLOOR, SKELETON)
    stood = standing(mat.standing_point, 0.0, Bearing(), SKELETON)
    one, over, both, back, hands, hip = LIE.floor_down.pose
    flat = replace(
        LIE, floor_down=replace(LIE.floor_down, pose=(one, over, both, back, replace(hands, head_pitch_rad=0.0), hip))
    )
    heads = []
    for keys in (LIE, flat):
        knelt = kneel_down(stood, mat, Bearing(), keys.floor_down)
        way = lie_down_from_knees(knelt.at(len(knelt) - 1), mat, Lying(), keys)
        heads.append(way.head[round((back.wait_s + hands.wait_s) * FPS) - 1, 0])
    assert heads == pytest.approx([hands.head_pitch_rad, 0.0], abs=1e-9)


def test_a_lying_body_is_held_as_its_rows_say() -> None:
    stood = standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    wide = replace(LIE.pose, leg=tuple(replace(row, foot_out_rad=row.foot_out_rad + 0.2) for row in LIE.pose.leg))
    plain, varied = (lying(stood, BED, Lying(), SKELETON, keys) for keys in (LIE.pose, wide))
    np.testing.assert_array_equal(plain.ankles, varied.ankles)
    assert np.abs(plain.feet - varied.feet).max() > 0.05


def test_all_of_the_way_is_the_end_itself() -> None:
    start, end = np.random.default_rng(0).normal(size=(2, 100))
    np.testing.assert_array_equal(part_way(start, end, 1.0), end)
    np.testing.assert_array_equal(part_way(start, end, 0.0), start)
    np.testing.assert_allclose(part_way(start, end, 0.5), (start + end) / 2)
