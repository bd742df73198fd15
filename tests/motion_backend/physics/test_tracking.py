"""Plans followed by a body under gravity: it stands, walks, weighs what it weighs, and is moved by its joints alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated import empty_room, stood, tracked, tracker_of, walk, walked

from motion_backend.body.zero_moment import GRAVITY
from motion_backend.motion import Phase, PhaseKind
from motion_backend.physics.contact_forces import Pressure
from motion_backend.physics.engine import engine
from motion_backend.physics.mjcf_character import NU, SIMULATED, mass_of
from motion_backend.physics.mpc import SLIDING, Controller, Effort, Moment, moment_of
from motion_backend.physics.physics_options import PhysicsOptions, give_physics
from motion_backend.physics.reference import Doing, Plan
from motion_backend.physics.task import plan_of
from motion_backend.physics.tracker import AT_LEAST, EFFORTS, UNPREPARED, Tracked, Tracker


def away(plan: Plan, done: Tracked) -> np.ndarray:
    """How far the pelvis is from its plan. (T,) metres."""
    places = np.array([moment.state.qpos[:3] for moment in done.moments])
    return np.linalg.norm(places - plan.roots[: len(places)], axis=1)


@pytest.mark.parametrize("seconds", [0.7, pytest.param(3, marks=pytest.mark.sweep)])
def test_a_body_stands_and_the_floor_carries_its_weight(seconds: float) -> None:
    plan, done = stood(seconds=seconds)
    assert not done.rewinds
    assert away(plan, done).max() < 0.05
    carried = np.mean([pressure.total for pressure in done.pressures[-15:]])
    assert carried == pytest.approx(mass_of(1.70) * GRAVITY, rel=0.05)
    assert carried == pytest.approx(np.mean([pressure.up[0] for pressure in done.pressures[-15:]]), rel=0.01)
    assert done.pressures[-1].planted.tolist() == [1, 1, 1, 1]


@pytest.mark.parametrize("frames", [40, pytest.param(60, marks=pytest.mark.sweep)])
def test_a_body_walks_as_it_plans_to(frames: int) -> None:
    plan, done = walked(frames)
    assert not done.rewinds
    assert away(plan, done).max() < 0.08
    planted = np.array([pressure.planted.reshape(2, 2).max(axis=1) for pressure in done.pressures[1:]])
    assert (planted.sum(axis=1) < 2).any(), "no foot was lifted"
    assert planted.any(axis=1).mean() > 0.95


def test_the_recorded_controls_alone_make_the_same_states() -> None:
    # What else pushed the body would be missing here.
    _, done = walked(40)
    mujoco, model = engine(), empty_room().fine
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = done.moments[0].state
    for before, after in zip(done.moments[:30], done.moments[1:31], strict=True):
        for step in range(4):
            data.ctrl[:] = before.control + (after.control - before.control) * ((step + 1) / 4)
            mujoco.mj_step(model, data)
        np.testing.assert_array_equal(data.qpos, after.state.qpos)
        np.testing.assert_array_equal(data.qvel, after.state.qvel)


def test_results_do_not_depend_on_the_number_of_threads() -> None:
    plan = plan_of(walk())
    found = []
    try:
        for threads in (1, 3):
            give_physics(PhysicsOptions(threads=threads))
            found.append(tracked(plan, 4).moments[-1].state.qpos)
    finally:
        give_physics(PhysicsOptions())
    np.testing.assert_array_equal(found[0], found[1])


def test_a_state_that_is_not_finite_is_planned_again_and_then_reset() -> None:
    plan = plan_of(walk())
    tracker = tracker_of(plan)
    broken = moment_of(tracker.reference, 0)
    broken.state.qvel[3] = np.nan
    done = tracker.track(broken, np.zeros((0, NU)), 8)
    assert len(done.resets) == 1
    assert all(moment.finite for moment in done.moments)


def test_a_fall_is_gone_back_from_three_times_and_then_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = plan_of(walk())
    efforts = []

    def falls(_self: Tracker, done: Tracked, effort: object, *_rest: object) -> None:
        """A body that is carried off after a second, every time."""
        efforts.append(effort)
        reference, at = tracker.reference, len(done.moments)
        moment = moment_of(reference, at)
        if at >= 30 and len(done.resets) == 0:
            moment.state.qpos[0] += 1.0
        done.moments.append(moment)
        done.pressures.append(Pressure())

    tracker = tracker_of(plan)
    monkeypatch.setattr(Tracker, "_window", falls)
    done = tracker.track(moment_of(tracker.reference, 0), np.zeros((0, NU)), 60)
    assert done.rewinds == [30, 30, 30]
    assert done.resets == [30]
    assert len(done.moments) == 61
    assert len(set(map(str, efforts))) == 4


@pytest.mark.parametrize(("off", "mends", "rewinds"), [(0.05, True, 0), (0.2, True, 1), (0.2, False, 3)])
def test_what_would_fall_in_the_next_part_is_gone_back_for_in_this_one(
    monkeypatch: pytest.MonkeyPatch, off: float, mends: bool, rewinds: int
) -> None:
    tracker, frames = tracker_of(plan_of(walk())), 40

    def topples(_self: Tracker, done: Tracked, effort: Effort, _data: object, _reader: object, left: int) -> None:
        """A body that leans at the end of a part, and falls if it goes on like that."""
        at = len(done.moments)
        moment = moment_of(tracker.reference, at)
        if at >= frames and not (mends and effort != EFFORTS[0]):
            moment.state.qpos[0] += off if at == frames else 1.0
        assert left == (frames + 24 if at > frames else frames) - (at - 1)
        done.moments.append(moment)
        done.pressures.append(Pressure())
        done.ahead = np.full((1, NU), float(at))

    monkeypatch.setattr(Tracker, "_window", topples)
    done = tracker.track(moment_of(tracker.reference, 0), np.zeros((0, NU)), frames)
    assert (len(done.moments), len(done.pressures)) == (frames + 1, frames + 1)
    assert (len(done.rewinds), done.resets) == (rewinds, [])
    assert done.ahead[0, 0] == frames, "what comes next begins with the controls that this part left"
    away_at_end = abs(done.moments[-1].state.qpos[0] - tracker.reference.qpos[frames][0])
    assert away_at_end == pytest.approx(0.0 if mends and rewinds else off)


def test_a_plan_that_jumps_or_is_not_finite_is_known_by_the_frame() -> None:
    plan = plan_of(walk())
    assert plan.jump() is None
    roots = plan.roots.copy()
    roots[50:] += 2.0
    assert replace(plan, roots=roots).jump() == 50
    roots = plan.roots.copy()
    roots[7] = np.nan
    assert replace(plan, roots=roots).jump() == 7


@pytest.mark.sweep
@pytest.mark.parametrize("height", [1.2, 2.0])
def test_small_and_tall_bodies_stand(height: float) -> None:
    plan, done = stood(height, 1)
    assert not done.rewinds
    assert away(plan, done).max() < 0.05
    carried = np.mean([pressure.total for pressure in done.pressures[-10:]])
    assert carried == pytest.approx(mass_of(height) * GRAVITY, rel=0.1)


def test_a_moment_knows_whether_it_is_finite() -> None:
    moment = moment_of(tracker_of(plan_of(walk())).reference, 3)
    assert moment.finite
    assert not Moment(moment.state, np.full_like(moment.warm, np.inf), moment.control).finite


def test_the_price_of_sliding_is_that_of_its_jacobian() -> None:
    tracker = tracker_of(plan_of(walk()))
    data, reader = tracker._scratch()
    controller = Controller(empty_room(), data, tracker.reference, reader)
    for at in range(10, 40, 3):
        data.qpos[:], data.qvel[:] = tracker.reference.qpos[at], tracker.reference.qvel[at] + 0.1
        rows = controller._planted_rows(at)
        wanted = 0.0 if rows is None else SLIDING * float(((rows @ data.qvel) ** 2).sum())
        assert controller._sliding(at) == pytest.approx(wanted)


def test_getting_up_from_the_floor_is_looked_farther_ahead_and_the_pelvis_comes_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = plan_of(walk())
    doing = np.where(np.arange(len(plan)) >= 4, Doing.RISES, Doing.OTHER)
    tracker, efforts = tracker_of(replace(plan, doing=doing)), []

    def goes(_self: Tracker, done: Tracked, effort: object, *_rest: object) -> None:
        efforts.append(effort)
        done.moments.append(moment_of(tracker.reference, len(done.moments)))
        done.pressures.append(Pressure())

    monkeypatch.setattr(Tracker, "_window", goes)
    tracker.track(moment_of(tracker.reference, 0), np.zeros((0, NU)), 8)
    assert efforts == [EFFORTS[0]] * 4 + [EFFORTS[AT_LEAST[Doing.RISES]]] * 4
    data, reader = tracker._scratch()
    found = [Controller(empty_room(), data, tracker.reference, reader)._prices(at) for at in (0, 4)]
    assert (found[1][:6] > found[0][:6]).all()
    arms = [joint.qvel for joint in SIMULATED if joint.name.endswith(("shoulder", "elbow", "trunk", "neck"))]
    np.testing.assert_array_equal(found[1][arms], found[0][arms])


def test_a_plan_begun_without_controls_for_it_is_improved_more_often(monkeypatch: pytest.MonkeyPatch) -> None:
    tracker, rounds = tracker_of(plan_of(walk())), []
    improve = Controller.improve

    def counted(self: Controller, now: Moment, at: int, ahead: np.ndarray, effort: Effort) -> object:
        rounds.append(effort.rounds)
        return improve(self, now, at, ahead, replace(effort, horizon=6, rounds=1))

    monkeypatch.setattr(Controller, "improve", counted)
    tracker.track(moment_of(tracker.reference, 0), np.zeros((0, NU)), 8)
    assert rounds == [UNPREPARED, EFFORTS[0].rounds]


def prices(plan: Plan, at: int) -> np.ndarray:
    tracker = tracker_of(plan)
    data, reader = tracker._scratch()
    return Controller(empty_room(), data, tracker.reference, reader)._prices(at)


def all_along(plan: Plan, doing: Doing) -> Plan:
    return replace(plan, doing=np.full(len(plan), doing, dtype=np.int8))


def test_the_pelvis_comes_first_on_the_way_down_to_lie_as_on_the_way_up() -> None:
    plan = plan_of(walk())
    ups = (Doing.LIES, Doing.RISES, Doing.STANDS_UP, Doing.GOES_DOWN, Doing.OTHER)
    lies, rises, stands_up, goes_down, does = (prices(all_along(plan, one), 4) for one in ups)
    np.testing.assert_array_equal(lies, rises)
    np.testing.assert_array_equal(lies[:6], stands_up[:6])
    assert (lies[:6] > goes_down[:6]).all()
    assert (goes_down[:6] > does[:6]).all()


def test_controls_change_less_where_more_than_feet_touches_something() -> None:
    plan = plan_of(walk())
    changed = {}
    for doing in (Doing.OTHER, Doing.LIES):
        tracker = tracker_of(all_along(plan, doing))
        data, reader = tracker._scratch()
        controller = Controller(empty_room(), data, tracker.reference, reader)
        start = moment_of(tracker.reference, 4)
        nudged = start._replace(state=start.state._replace(qvel=start.state.qvel + 0.2))
        offsets = controller.improve(nudged, 4, np.zeros((0, NU)), Effort()).offsets
        changed[doing] = float(np.abs(np.diff(offsets, axis=0)).sum() / np.abs(offsets).sum())
    assert changed[Doing.LIES] < changed[Doing.OTHER]


def test_the_leg_that_swings_is_to_be_where_it_is_planned_and_the_one_that_stands_to_hold_the_pelvis_up() -> None:
    plan = plan_of(walk())
    stands = plan.contacts.reshape(-1, 2, 2).max(axis=2) > 0.5
    legs = [next(joint.qvel for joint in SIMULATED if joint.name == f"{side}_knee") for side in ("left", "right")]
    for swings, knee in enumerate(legs):
        at = int(np.flatnonzero(~stands[:, swings] & stands[:, 1 - swings])[0])
        walks, does = prices(all_along(plan, Doing.WALKS), at), prices(all_along(plan, Doing.OTHER), at)
        assert walks[knee] > does[knee]
        assert walks[legs[1 - swings]] == does[legs[1 - swings]]
        assert walks[1] > does[1]
        np.testing.assert_array_equal(walks[[0, 2, 3, 4, 5]], does[[0, 2, 3, 4, 5]])
        for doing, other in ((Doing.GOES_DOWN, Doing.LIES), (Doing.STANDS_UP, Doing.RISES)):
            kneels, lies = prices(all_along(plan, doing), at), prices(all_along(plan, other), at)
            assert kneels[knee] > kneels[legs[1 - swings]]
            assert lies[knee] == lies[legs[1 - swings]] > does[knee]
    both = int(np.flatnonzero(stands.all(axis=1))[0])
    assert (prices(all_along(plan, Doing.WALKS), both) != prices(all_along(plan, Doing.OTHER), both)).sum() == 1


def test_a_plan_knows_what_it_does_in_every_frame() -> None:
    motion = walk().part(0, 70)
    kinds = (
        PhaseKind.WALK, PhaseKind.EDGE, PhaseKind.LIEDOWN, PhaseKind.SITDOWN, PhaseKind.TOUCH, PhaseKind.GETUP,
        PhaseKind.STANDUP,
    )  # fmt: skip
    phases = tuple(Phase(kind, 10 * index, 10 * index + 10) for index, kind in enumerate(kinds))
    motion = replace(motion, phases=phases)
    from_bed = [Doing.WALKS, Doing.GOES_DOWN, Doing.LIES, Doing.OTHER, Doing.REACHES, Doing.LIES, Doing.OTHER]
    assert plan_of(motion).doing[::10].tolist() == from_bed
    low = replace(motion, root_positions=motion.root_positions * np.array([1, 0.2, 1], dtype=np.float32))
    from_floor = [*from_bed[:-3], Doing.GOES_DOWN, Doing.RISES, Doing.STANDS_UP]  # a low touch kneels
    assert plan_of(low).doing.tolist() == np.repeat(from_floor, 10).tolist()
    assert plan_of(low).part(slice(5, 15)).doing.tolist() == [Doing.WALKS] * 5 + [Doing.GOES_DOWN] * 5
