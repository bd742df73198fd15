"""The state machine at work: parts from several backends, windows, batches, and what stands where one fails."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_home import DIRECTOR, after, contact, rise, small_home, to

from motion_backend.backend_protocol import HISTORY, BodyState, History, Part, PartKind, Request, Unwanted
from motion_backend.contact_goals import contact_goals, positions_and_mask
from motion_backend.director import Director, Segment, Take, segments_of
from motion_backend.metrics.smoothness import seam_jump
from motion_backend.motion import FPS, Action, Character, Emotion, Motion, PhaseKind, Posture, Skill, join
from motion_backend.scene import scene_of
from motion_backend.skeleton import build_skeleton
from motion_backend.state_machine import ENDS
from scene_graphs.home import Home

HOME = small_home()
SIT = contact(HOME, Skill.SITDOWN, "chair", "crossing arms")
LIE = contact(HOME, Skill.LIEDOWN, "bed", "hands on belly")
TABLE = contact(HOME, Skill.TOUCH, "table", "touch medium height")
DAY = (to(SIT), SIT, rise(SIT), to(TABLE), TABLE, to(LIE), LIE)
ARRAYS = ("root_positions", "local_rotations", "contacts", "actions")
WINDOW = 8
"""Frames that the glider makes at a time."""


@dataclass
class Glider:
    """A stranger's backend: it only walks, a window at a time, in the pose the body is in, at 1.5 m/s."""

    name = "glider"
    parts = frozenset({PartKind.WALK, PartKind.TURN})
    asked: list[tuple[Part, tuple[Part, ...]]] = field(default_factory=list)

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        place = scene_of(home).walkable.random_point(np.random.default_rng(seed), 0)
        return BodyState.standing(place, 0.0, character, seed)

    def advance(
        self,
        home: Home,  # noqa: ARG002 - it glides through everything
        part: Part,
        upcoming: Sequence[Part],
        state: BodyState,
    ) -> tuple[Motion, BodyState]:
        self.asked.append((part, tuple(upcoming)))
        here, goal = np.array(state.pelvis), np.array(state.pelvis)
        goal[[0, 2]] = part.goal
        step = goal - here
        left = float(np.linalg.norm(step)) / (1.5 / FPS)
        shares = np.minimum(np.arange(1, WINDOW + 1) / max(left, 1e-9), 1.0)
        motion = Motion(
            root_positions=(here + shares[:, None] * step).astype(np.float32),
            local_rotations=np.repeat(state.history.local_rotations[-1:], WINDOW, axis=0).astype(np.float32),
            contacts=np.ones((WINDOW, 4), np.float32),
            skeleton=build_skeleton(state.height),
            actions=np.full(WINDOW, part.action.keyframe, np.int32),
            completion=min(WINDOW / max(left, 1e-9), 1.0),
        )
        return motion, state.after(part, motion, self.name)


class Faulty(Glider):
    """One whose motions are spoilt."""

    def __init__(self, spoil: str) -> None:
        super().__init__()
        self.spoil = spoil

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        motion, after = super().advance(home, part, upcoming, state)
        ways: dict[str, dict[str, Any]] = {
            "gives up": {"completed": False, "reason": "its weights are gone"},
            "nan": {"root_positions": motion.root_positions * np.float32("nan")},
            "elsewhere": {"root_positions": motion.root_positions + np.float32(3.0)},
            "never done": {"completion": 0.5},
            "says nothing": {"completion": 0.5} | {name: getattr(motion, name)[:0] for name in ARRAYS},
            "ill-fitting": {"contacts": motion.contacts[:, :2]},
        }
        return replace(motion, **ways[self.spoil]), after


@cache
def mixed() -> tuple[list[Motion], Glider]:
    """The day with a glider's walks and all else by our own."""
    glider = Glider()
    director = Director(glider, DIRECTOR.backend)
    return [motion for motion, _ in director.play(HOME, DAY, after(HOME))], glider


def test_another_backend_takes_over_in_mid_story_and_every_part_says_who_made_it() -> None:
    motions, _ = mixed()
    assert all(motion.completed for motion in motions), [motion.reason for motion in motions]
    walk, sit = segments_of(motions[0]), segments_of(motions[1])
    assert walk == (Segment("glider", None),)
    assert Segment("procedural", "glider makes no sit") in sit
    assert {phase.backend for phase in join(motions).phases} == {"glider", "procedural"}


def test_a_body_goes_on_from_what_another_backend_left() -> None:
    """The pelvis never jumps, and no joint moves farther in a frame at a change of hands than it does elsewhere."""
    motions, _ = mixed()
    assert seam_jump(join(motions)) < 0.08
    for before, following in pairwise(motions):
        ends = np.stack([before.joint_positions()[-1], following.joint_positions()[0]])
        assert np.linalg.norm(ends[1] - ends[0], axis=1).max() < 0.15


def test_a_part_is_made_window_by_window_until_it_is_complete() -> None:
    motions, glider = mixed()
    assert len(motions[0]) > 3 * WINDOW
    assert len(motions[0]) % WINDOW == 0
    assert len(glider.asked) > len(motions[0]) // WINDOW - 1


def test_a_backend_sees_the_rest_of_its_action_and_the_whole_of_the_next() -> None:
    _, glider = mixed()
    walk, upcoming = glider.asked[0]
    assert walk.kind is PartKind.WALK
    assert [part.kind for part in upcoming] == [PartKind.WALK, PartKind.SIT, PartKind.HOLD]
    assert upcoming[1].action is SIT


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        ("gives up", "its weights are gone"),
        ("nan", "its motion has numbers that are not finite"),
        ("elsewhere", "it begins 5.2 m from where the body is"),
        ("never done", "the walk was not done after "),
        ("says nothing", "the walk was not done after 0 s"),
        ("ill-fitting", "its arrays have the shapes "),
    ],
)
def test_what_one_fails_at_another_does_and_says_why(spoil: str, why: str) -> None:
    motion, state = Director(Faulty(spoil), DIRECTOR.backend).act(HOME, DAY[0], after(HOME))
    assert motion.completed
    (segment,) = segments_of(motion)
    assert segment.backend == "procedural"
    assert segment.fallback is not None
    assert segment.fallback.startswith(why)
    if spoil != "says nothing":
        alone, _ = Director(Faulty(spoil)).act(HOME, DAY[0], after(HOME))
        assert not alone.completed
        assert alone.reason.startswith(why)
    assert state.backend == "procedural"


class Raising(Glider):
    """One that raises something in its second window."""

    def __init__(self, what: BaseException) -> None:
        super().__init__()
        self.what = what

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        if state.backend == self.name:
            raise self.what
        return super().advance(home, part, upcoming, state)


class Speechless(Glider):
    """One that returns nothing, and cannot begin."""

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:  # noqa: ARG002
        raise RuntimeError("no weights")

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> Any:  # noqa: ARG002
        return None


def test_what_one_raises_at_another_does_and_says_what_was_raised() -> None:
    walk, state = DAY[0], after(HOME)
    own, _ = DIRECTOR.act(HOME, walk, state)
    error = ValueError("no such\nlayer " + 300 * "x")
    for broken, why in (
        (Raising(error), r"it raised ValueError('no such\nlayer xxx"),
        (Speechless(), "it raised TypeError('cannot unpack"),
    ):
        director = Director(broken, DIRECTOR.backend)
        for motion, left in (director.act(HOME, walk, state), *director.act_many([Take(HOME, walk, state)] * 2)):
            (segment,) = segments_of(motion)
            assert segment.backend == left.backend == "procedural"
            assert segment.fallback is not None
            assert segment.fallback.startswith(why)
            assert len(segment.fallback) < 260
            assert motion.root_positions.tobytes() == own.root_positions.tobytes()


def test_who_cannot_begin_is_begun_for() -> None:
    who = Character()
    assert Director(Speechless(), DIRECTOR.backend).begin(HOME, who, 3) == DIRECTOR.begin(HOME, who, 3)
    with pytest.raises(RuntimeError, match="no weights"):
        Director(Speechless()).begin(HOME, who, 3)


def test_only_what_another_can_stand_in_for_is_caught() -> None:
    """Who interrupts is obeyed; the default backend's exceptions, and those of one that stands alone, are bugs."""
    state, error = after(HOME), ValueError("a bug")
    for director, wanted in (
        (Director(Raising(KeyboardInterrupt()), DIRECTOR.backend), KeyboardInterrupt),
        (Director(Raising(SystemExit()), DIRECTOR.backend), SystemExit),
        (Director(Raising(Unwanted()), DIRECTOR.backend), Unwanted),
        (Director(Raising(error)), ValueError),
        (Director(Faulty("gives up"), Raising(error)), ValueError),
    ):
        with pytest.raises(wanted):
            director.act(HOME, DAY[0], state)
        with pytest.raises(wanted):
            director.act_many([Take(HOME, DAY[0], state)])


def test_many_bodies_at_once_do_what_each_does_alone() -> None:
    director = Director(Glider(), DIRECTOR.backend)
    takes = [Take(HOME, SIT, after(HOME, seed=seed), rise(SIT)) for seed in (3, 4)]
    takes.append(Take(HOME, TABLE, after(HOME, seed=5)))
    together = director.act_many(takes)
    for take, (motion, state) in zip(takes, together, strict=True):
        alone, left = director.act(take.home, take.action, take.state, take.following)
        assert motion.root_positions.tobytes() == alone.root_positions.tobytes()
        assert motion.phases == alone.phases
        assert state == left


def test_a_backend_that_can_is_asked_in_batches() -> None:
    sizes: list[int] = []

    class Batched(Glider):
        def advance_many(self, requests: Sequence[Request]) -> list[tuple[Motion, BodyState]]:
            sizes.append(len(requests))
            return [self.advance(one.home, one.part, one.upcoming, one.state) for one in requests]

    Director(Batched()).act_many([Take(HOME, to(SIT), after(HOME, seed=seed)) for seed in (3, 4, 5)])
    assert sizes[0] == 3
    assert sizes == sorted(sizes, reverse=True)


@given(st.sampled_from(range(len(DAY))))
def test_goals_are_the_planning_sides_whatever_a_backend_says(index: int) -> None:
    motion = mixed()[0][index]
    assert motion.goals == contact_goals(DAY[index])
    positions, mask = positions_and_mask(motion.goals)
    assert (positions.shape, mask.shape) == ((15, 3), (15,))
    assert mask.sum() == len(motion.goals)


def test_a_state_remembers_the_last_frames_their_speed_and_what_is_rested_on() -> None:
    motion, state = DIRECTOR.act(HOME, SIT, after(HOME))
    history = state.history
    assert len(history) == HISTORY
    np.testing.assert_allclose(history.root_positions, motion.root_positions[-HISTORY:], atol=1e-6)
    np.testing.assert_allclose(history.local_rotations, motion.local_rotations[-HISTORY:], atol=2e-6)
    walk, walking = Director(Glider()).act(HOME, to(SIT), after(HOME))
    moved = np.diff(walk.root_positions[-2:].astype(float), axis=0)[0] * FPS
    np.testing.assert_allclose(walking.history.root_velocity, moved, atol=1e-3)
    assert np.abs(walking.history.angular_velocities).max() < 1e-3
    assert (state.posture, state.rest) == (Posture.SEATED, SIT.spot)
    assert BodyState.from_dict(json.loads(json.dumps(state.to_dict()))) == state


def test_a_short_history_grows_to_its_length_and_no_farther() -> None:
    one = BodyState.standing((1.0, 2.0), 0.5, Character(), 0)
    assert (len(one.history), one.pelvis[0], one.pelvis[2]) == (1, 1.0, 2.0)
    assert one.yaw == pytest.approx(0.5, abs=1e-5)
    assert one.history.root_velocity.tolist() == [0.0, 0.0, 0.0]
    motion, state = DIRECTOR.act(HOME, to(SIT), replace(one, height=1.8))
    assert isinstance(state.history, History)
    assert len(state.history) == HISTORY
    assert motion.completed


def test_an_action_of_which_nothing_is_left_is_stood_through() -> None:
    state = after(HOME, to(TABLE))
    motion, _ = DIRECTOR.act(HOME, replace(to(TABLE), goal=(state.pelvis[0], state.pelvis[2]), facing=None), state)
    assert motion.duration == pytest.approx(1.0)
    assert [phase.kind for phase in motion.phases] == [PhaseKind.STAND]


def test_what_follows_a_part_that_failed_is_left_out_and_the_posture_stays() -> None:
    assert SIT.spot is not None
    nowhere = replace(SIT, spot=replace(SIT.spot, standing=(50.0, 50.0), point=(50.0, 0.4, 50.4)))
    motion, state = DIRECTOR.act(HOME, nowhere, after(HOME))
    assert not motion.completed
    assert state.posture is Posture.STANDING
    assert PhaseKind.SITDOWN not in [phase.kind for phase in motion.phases]
    assert ENDS[Skill.SITDOWN] is Posture.SEATED
    assert Action(Skill.LOCO, "walk", Emotion.NEUTRAL).goal is None
