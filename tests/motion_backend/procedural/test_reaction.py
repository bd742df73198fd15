"""Something happens: the head goes there before anything else does, whatever the body does, and the body stays."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from small_home import DIRECTOR, after, contact, small_home

from motion_backend import rotations
from motion_backend.backend_protocol import BodyState
from motion_backend.body.cast import Role
from motion_backend.body.face import UNITS
from motion_backend.body.face_track import face_track
from motion_backend.formats.motion_json import dict_to_motion, motion_to_dict
from motion_backend.formats.npz import npz_bytes, read_npz
from motion_backend.metrics.joint_speed import fastest_joint
from motion_backend.motion import FPS, Action, Emotion, Motion, Reaction, Reacts, Skill
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

HOME = small_home()
SEATED = contact(HOME, Skill.SITDOWN, "sofa", "reading, book held in both hands")
LYING = contact(HOME, Skill.LIEDOWN, "bed", "lying still")
STILL = Action(Skill.LOCO, "stand still", Emotion.NEUTRAL, hold=1.0)
SHELF = np.add(HOME.object("0/shelf").position, (0.0, HOME.object("0/shelf").size[1] / 2, 0.0))
POSTURES = pytest.mark.parametrize("before", [(), (SEATED,), (LYING,)], ids=["standing", "seated", "lying"])


def taken(before: tuple[Action, ...], how: Reacts, at: str = "shelf") -> Motion:
    """What a body makes of it that has done something before."""
    last = before[-1] if before else STILL
    state: BodyState = after(HOME, *before)
    motion, _ = DIRECTOR.act(HOME, replace(last, reacts=(Reaction(how, at),)), state)
    first = motion.phases[0]
    assert first.reacts == how
    return motion.part(first.start, first.stop)


def ahead(motion: Motion) -> Array:
    """Where the head points. (T, 3)."""
    _, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    return rotations.rotate(world[:, INDEX["head"]], np.array([0.0, 0.0, 1.0]))


def off(motion: Motion, place: Array) -> Array:
    """How far from where a place is the head points. (T,) radians."""
    way = rotations.normalize(place - motion.joint_positions()[:, INDEX["head"]])
    return np.asarray(np.arccos(np.clip(np.sum(way * ahead(motion), axis=1), -1.0, 1.0)))


@POSTURES
@pytest.mark.parametrize("how", ["start", "notice"])
def test_the_head_turns_to_it(before: tuple[Action, ...], how: Reacts) -> None:
    motion = taken(before, how)
    away = off(motion, SHELF)
    assert 1.0 <= motion.duration <= 2.0
    assert away.min() < max(0.35, away[0] - 0.2)


@pytest.mark.parametrize("before", [(), (SEATED,)], ids=["standing", "seated"])
def test_the_eyes_stay_there_for_half_a_second(before: tuple[Action, ...]) -> None:
    away = off(taken(before, "start"), SHELF)
    assert away[-FPS // 2 :].max() < max(0.35, away[0] - 0.35)


@POSTURES
def test_a_body_stays_where_it_is_and_no_joint_is_thrown(before: tuple[Action, ...]) -> None:
    for how in ("start", "notice", "search"):
        motion = taken(before, how)
        assert np.linalg.norm(np.ptp(motion.root_positions, axis=0)) < 0.08
        assert fastest_joint(motion.local_rotations, motion.fps)[1] < 12.0


def test_who_finds_nobody_looks_to_either_side_and_sinks() -> None:
    motion = taken((), "search")
    heading = ahead(motion)[0]
    aside = np.arctan2(ahead(motion)[:, 0], ahead(motion)[:, 2]) - np.arctan2(heading[0], heading[2])
    aside = np.angle(np.exp(1j * aside))
    assert aside.max() > 0.6
    assert aside.min() < -0.6
    assert aside.argmax() < aside.argmin()
    assert ahead(motion)[-FPS // 2 :, 1].min() < ahead(motion)[0, 1] - 0.3


def test_a_face_that_starts_has_its_brows_up_and_only_then() -> None:
    state = after(HOME)
    motion, _ = DIRECTOR.act(HOME, replace(STILL, hold=3.0, reacts=(Reaction("start", "shelf"),)), state)
    brows = face_track(motion, Role())[:, UNITS.index("brows_up")]
    assert brows[FPS // 2 : FPS].min() > 0.9
    assert abs(brows[-1]) < 0.1


def test_what_is_reacted_to_is_kept_in_files() -> None:
    motion = taken((), "start")
    assert read_npz(BytesIO(npz_bytes(motion))).phases == motion.phases
    assert dict_to_motion(motion_to_dict(motion)).phases == motion.phases


def test_an_action_without_an_event_has_the_parts_it_had() -> None:
    state = after(HOME)
    plain, _ = DIRECTOR.act(HOME, STILL, state)
    assert all(not phase.reacts for phase in plain.phases)
