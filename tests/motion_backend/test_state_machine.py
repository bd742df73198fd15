"""The state machine: what goes before each skill, when it is done, and when it has taken too long."""

from __future__ import annotations

import io
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from small_home import contact, rise, small_home, to

from motion_backend.backend_protocol import BodyState, PartKind
from motion_backend.director import Director
from motion_backend.formats.motion_json import json_bytes, read_json
from motion_backend.formats.npz import npz_bytes, read_npz
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, Character, Emotion, Motion, Note, PhaseKind, Posture, Skill, join
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.skeleton import build_skeleton
from motion_backend.state_machine import DONE, ENDS, ENTERING, alongside, parts_of, shortfall, time_limit
from scene_graphs.affordances.affordances import spots

HOME = small_home()
SIT = contact(HOME, Skill.SITDOWN, "chair", "crossing arms")
LIE = contact(HOME, Skill.LIEDOWN, "bed", "hands on belly")
TOUCH = contact(HOME, Skill.TOUCH, "table", "touch medium height")
BACKEND = Director(ProceduralBackend())
ACTIONS = {
    Skill.LOCO: to(TOUCH), Skill.SITDOWN: SIT, Skill.LIEDOWN: LIE, Skill.TOUCH: TOUCH,
    Skill.STANDUP: rise(SIT), Skill.GETUP: rise(LIE, Skill.GETUP),
}  # fmt: skip
LEAVING = {
    Posture.STANDING: (), Posture.SEATED: (PhaseKind.STANDUP,), Posture.LYING: (PhaseKind.GETUP, PhaseKind.STANDUP),
}  # fmt: skip
COMING = {
    Skill.LOCO: (PhaseKind.WALK,),
    Skill.SITDOWN: (PhaseKind.WALK, PhaseKind.SITDOWN),
    Skill.LIEDOWN: (PhaseKind.WALK, PhaseKind.EDGE, PhaseKind.LIEDOWN),
    Skill.TOUCH: (PhaseKind.WALK, PhaseKind.TOUCH),
    Skill.STANDUP: (PhaseKind.STAND,),
    Skill.GETUP: (PhaseKind.STAND,),
}
"""The phases of getting up from a posture, and of each skill from standing."""
PAIRS = tuple(product(Posture, ACTIONS))


@cache
def start(posture: Posture) -> BodyState:
    """A body that stands, sits or lies."""
    state = BACKEND.begin(HOME, Character(), 3)
    taken = {Posture.SEATED: SIT, Posture.LYING: LIE}.get(posture)
    return state if taken is None else BACKEND.act(HOME, taken, state)[1]


@cache
def made(posture: Posture, skill: Skill) -> tuple[Motion, BodyState]:
    """What a body does from there."""
    return BACKEND.act(HOME, ACTIONS[skill], start(posture))


@given(st.sampled_from(Posture), st.sampled_from(sorted(ACTIONS)))
def test_every_skill_follows_every_posture_and_nobody_walks_before_standing(posture: Posture, skill: Skill) -> None:
    kinds = [part.kind for part in parts_of(ACTIONS[skill], posture)]
    upright = [] if posture is Posture.STANDING else [PartKind.RISE]
    assert kinds == [*upright, *ENTERING[skill]]
    assert all(part.action is ACTIONS[skill] for part in parts_of(ACTIONS[skill], posture))


ON_BED = contact(HOME, Skill.SITDOWN, "bed", "sitting still")
BESIDE = next(spot for spot in spots(HOME.object("0/bed"), "lie") if alongside(ON_BED.spot, spot))


def test_who_sits_on_a_bed_lies_down_there_and_sits_up_again_without_standing() -> None:
    lie = replace(LIE, spot=BESIDE)
    for posture, action, rest in ((Posture.SEATED, lie, ON_BED.spot), (Posture.LYING, ON_BED, BESIDE)):
        kinds = [part.kind for part in parts_of(action, posture, rest=rest)]
        assert kinds == [kind for kind in ENTERING[action.skill] if kind is not PartKind.WALK]
        assert parts_of(action, posture, rest=SIT.spot)[0].kind is PartKind.RISE
    _, state = BACKEND.act(HOME, ON_BED, BACKEND.begin(HOME, Character(), 3))
    standing = 0.8 * build_skeleton().standing_height
    for action, came in ((lie, [PhaseKind.LIEDOWN]), (ON_BED, [PhaseKind.GETUP, PhaseKind.SITDOWN])):
        motion, state = BACKEND.act(HOME, action, state)
        assert motion.completed, motion.reason
        assert [phase.kind for phase in motion.phases] == came
        assert motion.root_positions[:, 1].max() < standing
        assert state.posture is ENDS[action.skill]


def test_who_sits_there_sits_otherwise_without_rising_and_rises_for_another_seat() -> None:
    otherwise = replace(SIT, caption="right hand on chin, thinking")
    assert [part.kind for part in parts_of(otherwise, Posture.SEATED, rest=SIT.spot)] == [PartKind.SIT, PartKind.HOLD]
    assert parts_of(otherwise, Posture.SEATED, rest=ON_BED.spot)[0].kind is PartKind.RISE
    before, state = made(Posture.STANDING, Skill.SITDOWN)
    motion, state = BACKEND.act(HOME, otherwise, state)
    assert motion.completed, motion.reason
    assert [phase.kind for phase in motion.phases] == [PhaseKind.SITDOWN]
    moved = np.linalg.norm(motion.root_positions - before.root_positions[-1], axis=1)
    assert moved.max() < 0.1
    hands = motion.joint_positions()[:, [20, 21]]
    assert np.linalg.norm(hands[-1] - hands[0], axis=1).max() > 0.2
    assert state.posture is Posture.SEATED


def test_who_rests_there_already_is_not_seen_to_come() -> None:
    for action in (SIT, LIE):
        begun = replace(action, already=True)
        state = BACKEND.begin(HOME, Character(), 3, begun)
        assert state.posture is ENDS[action.skill]
        motion, state = BACKEND.act(HOME, begun, state)
        assert motion.completed, motion.reason
        assert len(motion.phases) == 1
        assert np.ptp(motion.root_positions, axis=0).max() < 0.1
        assert state.posture is ENDS[action.skill]
        assert BACKEND.begin(HOME, Character(), 3, action).posture is Posture.STANDING


def test_nobody_lies_down_from_a_seat_that_is_elsewhere() -> None:
    there = ON_BED.spot
    assert there is not None
    assert not alongside(there, replace(BESIDE, object_id="0/sofa"))
    assert not alongside(there, replace(BESIDE, approach=BESIDE.approach + np.pi))
    x, y, z = BESIDE.point
    assert not alongside(there, replace(BESIDE, point=(x, y, z + 1.5)))
    assert not alongside(None, BESIDE)


def test_who_is_there_already_only_turns() -> None:
    spot = TOUCH.spot
    assert spot is not None
    for near, kind in ((0.03, PartKind.TURN), (0.05, PartKind.WALK)):
        place = (spot.standing[0] + near, spot.standing[1])
        assert parts_of(TOUCH, Posture.STANDING, place)[0].kind is kind


@for_each(("posture", "skill"), PAIRS)
def test_the_body_does_what_the_table_says_in_its_order(posture: Posture, skill: Skill) -> None:
    motion, after = made(posture, skill)
    assert motion.completed, motion.reason
    assert after.posture is ENDS[skill]
    done = [phase.kind for phase in motion.phases]
    leaving = () if ENDS[skill] is posture else LEAVING[posture]  # it is the same seat, and the same bed
    order = [kind for kind in (*leaving, *COMING[skill]) if kind in done]
    assert done == list(dict.fromkeys(order))
    assert set(leaving) <= set(done)


@for_each(("posture", "skill"), PAIRS)
def test_the_parts_of_a_segment_fill_it_without_a_gap(posture: Posture, skill: Skill) -> None:
    motion, _ = made(posture, skill)
    edges = [0, *(phase.stop for phase in motion.phases)]
    assert [phase.start for phase in motion.phases] == edges[:-1]
    assert edges[-1] == len(motion)


@for_each("skill", list(DONE))
def test_done_means_near_enough_for_as_long_as_is_said(skill: Skill) -> None:
    action = ACTIONS[skill]
    motion, _ = made(Posture.STANDING, skill)
    assert shortfall(action, Kinematics.of(motion)) == ""
    last = motion.phases[-1]
    early = motion.part(0, last.start if skill is not Skill.LOCO else len(motion) // 3)
    assert "moment 1: " in shortfall(action, Kinematics.of(early))
    assert f"for {DONE[skill].seconds:.1f} s" in shortfall(action, Kinematics.of(early))


def test_who_has_not_stood_has_not_risen() -> None:
    motion, _ = made(Posture.LYING, Skill.GETUP)
    body = Kinematics.of(motion.part(0, len(motion) // 2))
    assert "and did for 0.0 s" in shortfall(ACTIONS[Skill.GETUP], body)


@given(st.sampled_from(Posture), st.sampled_from(sorted(ACTIONS)), st.floats(0, 50), st.floats(0, 50))
def test_a_longer_way_may_take_longer(posture: Posture, skill: Skill, way: float, more: float) -> None:
    for part in parts_of(ACTIONS[skill], posture):
        assert time_limit(part, way) >= 10.0
        assert time_limit(part, way + more) >= time_limit(part, way)


def test_what_cannot_be_walked_to_is_told_and_the_body_stands() -> None:
    far = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=(50.0, 50.0))
    motion, after = BACKEND.act(HOME, far, start(Posture.SEATED))
    assert not motion.completed
    assert motion.reason
    assert after.posture is Posture.STANDING
    assert [phase.kind for phase in motion.phases] == [PhaseKind.STANDUP, PhaseKind.STAND]


def test_parts_are_kept_by_joining_cutting_and_files() -> None:
    walk, state = made(Posture.LYING, Skill.LOCO)
    touch, _ = BACKEND.act(HOME, TOUCH, state)
    whole = join([walk, touch])
    assert [phase.kind for phase in whole.phases] == [phase.kind for phase in (*walk.phases, *touch.phases)]
    assert whole.phases[-1].stop == len(whole)
    assert whole.part(len(walk), len(whole)).phases == touch.phases
    assert read_npz(io.BytesIO(npz_bytes(whole))).phases == whole.phases
    assert read_json(json_bytes(whole)).phases == whole.phases


def test_what_is_done_otherwise_is_said_and_kept() -> None:
    typing = contact(HOME, Skill.SITDOWN, "chair", "typing, both hands on the keyboard")
    lacking, _ = BACKEND.act(HOME, replace(typing, keyframe=4), start(Posture.STANDING))
    fine = made(Posture.STANDING, Skill.SITDOWN)[0]
    whole = join([fine, lacking])
    assert fine.notes == ()
    assert whole.notes == (Note(4, "no table before the seat: each hand in the lap"),)
    assert whole.part(0, len(fine)).notes == ()
    assert whole.part(len(fine), len(whole)).notes == whole.notes
    assert read_npz(io.BytesIO(npz_bytes(whole))).notes == whole.notes
    assert read_json(json_bytes(whole)).notes == whole.notes
