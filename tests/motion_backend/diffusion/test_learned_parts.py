"""Sitting, rising and reaching by the weights that ship: goals are met, and what cannot stand is the plan's."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from small_home import contact, rise, small_home

from motion_backend import rotations
from motion_backend.backend_protocol import BodyState, Part, PartKind
from motion_backend.diffusion import plan_follower
from motion_backend.diffusion.backend import DiffusionBackend
from motion_backend.diffusion.goal_cleanup import held_shares, pelvis_brought, with_carriage_of, wrist_brought
from motion_backend.diffusion.own_strides import walkers
from motion_backend.diffusion.passage_checks import RefusedError, check
from motion_backend.diffusion.planned_passages import PlannedPassage
from motion_backend.diffusion.windows import settled
from motion_backend.director import Director, shares
from motion_backend.motion import Action, Character, Emotion, Motion, PhaseKind, Skill
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton
from motion_backend.walk_generator import LOOK, Frames


def sits() -> Action:
    return contact(small_home(), Skill.SITDOWN, "chair", "sit upright with hands on thighs")


def acted(*actions: Action) -> list[tuple[Motion, BodyState]]:
    director = Director(DiffusionBackend(), ProceduralBackend())
    return list(director.play(small_home(), actions, director.begin(small_home(), Character(), 3)))


@cache
def sat() -> tuple[tuple[Motion, BodyState], ...]:
    return tuple(acted(sits(), rise(sits())))


def test_a_body_sits_where_it_is_to_sit_and_gets_up_by_the_model() -> None:
    (seated, _), (risen, _) = sat()
    assert seated.completed
    assert risen.completed
    goal = np.array(seated.goals[0].position)
    assert np.linalg.norm(seated.root_positions[-1] - goal) < 0.05
    assert risen.root_positions[-1, 1] > 0.8
    assert shares(seated)["diffusion"] > 0.4
    assert shares(risen)["diffusion"] > 0.4


def test_what_the_model_left_follows_on_and_can_be_stored() -> None:
    (seated, state), (risen, _) = sat()
    assert np.linalg.norm(risen.root_positions[0] - seated.root_positions[-1]) < 0.02
    stored = BodyState.from_dict(json.loads(json.dumps(state.to_dict())))
    again, _ = Director(DiffusionBackend(), ProceduralBackend()).act(small_home(), rise(sits()), stored)
    assert np.array_equal(again.local_rotations, risen.local_rotations)


def test_all_that_is_not_the_models_says_why() -> None:
    for motion, _ in sat():
        for phase in motion.phases:
            assert phase.backend == "diffusion" or phase.fallback


def test_what_misses_its_goal_is_the_plans_frame_by_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan_follower, "LOST", -1.0)
    monkeypatch.setattr(plan_follower, "TRIES", 1)
    made, by_rules = (
        director.act(small_home(), sits(), director.begin(small_home(), Character(), 3))[0]
        for director in (Director(DiffusionBackend(), ProceduralBackend()), Director(ProceduralBackend()))
    )
    seats = made.phases[-1].stop - made.phases[-1].start
    assert made.phases[-1].backend == "procedural"
    assert "from its goal" in made.phases[-1].fallback
    assert np.abs(made.root_positions[-seats // 2 :] - by_rules.root_positions[-seats // 2 :]).max() < 0.05


def standing(frames: int) -> Frames:
    root = np.tile([0.0, 0.92, 0.0], (frames, 1))
    local = np.tile([0.0, 0.0, 0.0, 1.0], (frames, 22, 1))
    local[:, INDEX["right_elbow"]] = [0.0, np.sin(0.4), 0.0, np.cos(0.4)]
    return Frames(root, local)


def test_a_wrist_is_brought_where_it_is_to_be_and_nothing_else_moves() -> None:
    skeleton, frames = build_skeleton(), standing(30)
    shift = held_shares(np.arange(30), 15, 5)[:, None] * np.array([0.05, 0.03, 0.04])
    before = skeleton.forward_kinematics(frames.root, frames.local)[0]
    moved = wrist_brought(frames, skeleton, "right", shift)
    after = skeleton.forward_kinematics(moved.root, moved.local)[0]
    assert np.abs(after[:, INDEX["right_wrist"]] - before[:, INDEX["right_wrist"]] - shift).max() < 1e-4
    others = [joint for name, joint in INDEX.items() if name not in ("right_elbow", "right_wrist")]
    assert np.abs(after[:, others] - before[:, others]).max() < 1e-5


def test_a_hand_comes_stays_and_leaves() -> None:
    shares_of = held_shares(np.arange(120), 40, 20)
    assert (shares_of[40:61] == 1).all()
    assert shares_of[0] == 0 == shares_of[-1]
    assert np.abs(np.diff(shares_of)).max() < 0.1


def test_a_pelvis_is_brought_to_its_seat_without_a_step() -> None:
    moved = pelvis_brought(standing(60), np.array([0.06, -0.02, 0.0]))
    assert moved.root[-1] - standing(60).root[-1] == pytest.approx([0.06, -0.02, 0.0])
    assert np.linalg.norm(np.diff(moved.root, axis=0), axis=1).max() < 0.005


def test_a_body_has_settled_from_when_on_it_stays() -> None:
    way = np.concatenate([np.linspace(0.0, 1.0, 50), np.full(30, 1.0)])
    roots = np.stack([way, np.full(80, 0.5), np.zeros(80)], axis=1)
    assert 46 <= settled(roots) <= 49
    assert settled(roots[60:]) == 0


def test_people_between_two_walk_about_as_fast_as_these() -> None:
    paces = (1.0, 1.05, 1.6, 1.7, 0.9, 1.1)
    crowd = walkers(paces, np.random.default_rng(0))
    assert [one.gait for one in crowd] == list(range(1, 64))
    assert all(one.share == 0 for one in crowd[: len(paces)])
    assert all(one.main != one.other and 0.1 < one.share <= 0.5 for one in crowd[len(paces) :])
    assert max(abs(paces[one.main - 1] - paces[one.other - 1]) for one in crowd) < 0.8
    assert crowd == walkers(paces, np.random.default_rng(0))


@pytest.mark.sweep
def test_a_character_of_another_size_sits_too_or_says_why_not() -> None:
    director = Director(DiffusionBackend(), ProceduralBackend())
    begun = director.begin(small_home(), replace(Character(), height=1.5), 3)
    motion, _ = director.act(small_home(), sits(), begun)
    assert motion.completed


def test_a_carriage_is_laid_over_and_the_stride_is_left() -> None:
    """A body that is bent over as another is keeps its legs and its way."""
    frames = Frames(*stood_for(60))
    bent = frames.local.copy()
    bent[:, INDEX["spine1"]] = rotations.compose(
        bent[:, INDEX["spine1"]], rotations.axis_to_quat("x", np.full(60, 0.4))
    )
    found = with_carriage_of(frames, Frames(frames.root, bent), np.linspace(0.0, 1.0, 60))
    skeleton = build_skeleton()
    before, wanted, after = (
        skeleton.forward_kinematics(one.root, one.local)[0] for one in (frames, Frames(frames.root, bent), found)
    )
    legs = [INDEX[f"{side}_{name}"] for side in ("left", "right") for name in ("hip", "knee", "ankle", "foot")]
    assert np.abs(after - before)[:, legs].max() < 1e-5
    tilt = (after - before)[-1, INDEX["neck"], [0, 2]], (wanted - before)[-1, INDEX["neck"], [0, 2]]
    assert np.linalg.norm(tilt[0]) > 0.7 * np.linalg.norm(tilt[1])
    assert np.abs(after - before)[0].max() < 1e-5


def stood_for(count: int) -> tuple[Array, Array]:
    """A body that stands for so many frames."""
    history = ProceduralBackend().begin(small_home(), Character(), 3).history
    root, local = history.root_positions[-1:], history.local_rotations[-1:]
    return np.repeat(root, count, axis=0), np.repeat(local, count, axis=0)


@pytest.mark.parametrize(
    ("caption", "why"),
    [("excited walk", "hops"), ("run with open arms", "flies"), ("skip happily", "hops"), ("walk on tiptoe", "toes")],
)
def test_what_ten_frames_a_second_do_not_hold_is_left_to_the_rules(caption: str, why: str) -> None:
    walks = Action(Skill.LOCO, caption, Emotion.HAPPY, goal=(4.6, 1.0))
    ((motion, _),) = acted(walks)
    assert motion.completed
    assert shares(motion) == {"procedural": 1.0}
    assert all(why in phase.fallback for phase in motion.phases)


def test_what_jumps_is_refused() -> None:
    still = Frames(*stood_for(12))
    root, local = stood_for(30)
    local = local.copy()
    local[15, INDEX["left_shoulder"]] = rotations.compose(
        local[15, INDEX["left_shoulder"]], rotations.axis_to_quat("z", np.array(0.8))
    )
    plan = moved(root, stood_for(30)[1])
    passage = PlannedPassage(small_home(), acted_part(), PhaseKind.STAND, plan)
    check(plan, passage, still)
    with pytest.raises(RefusedError, match="jumped"):
        check(moved(root, local), passage, still)


def moved(root: Array, local: Array) -> Motion:
    return Motion(
        root.astype(np.float32), local.astype(np.float32), np.ones((len(root), 4), np.float32), build_skeleton(),
        np.zeros(len(root), np.int32),
    )  # fmt: skip


def acted_part() -> Part:
    return Part(PartKind.HOLD, sits())


def test_who_sits_down_jumps_nowhere_between_windows() -> None:
    (seated, _), _ = sat()
    phase = next(phase for phase in seated.phases if phase.kind is PhaseKind.SITDOWN)
    assert phase.backend == "diffusion"
    wrists = seated.joint_positions()[phase.start : phase.stop, [INDEX["left_wrist"], INDEX["right_wrist"]]]
    changes = np.linalg.norm(np.diff(wrists.astype(np.float64), 2, axis=0), axis=-1).max(axis=1) * seated.fps
    border = slice(LOOK - 3, LOOK + 4)
    assert changes[border].max() < 1.0


def test_who_comes_to_a_stand_stands_upright_on_straight_legs() -> None:
    ((motion, _),) = acted(Action(Skill.LOCO, "walk to the shelf", Emotion.NEUTRAL, goal=(3.2, 1.0)))
    assert motion.phases[-1].backend == "diffusion"
    places = motion.joint_positions()[-1].astype(np.float64)
    for side in ("left", "right"):
        hip, knee, ankle = (places[INDEX[f"{side}_{joint}"]] for joint in ("hip", "knee", "ankle"))
        straight = np.linalg.norm(hip - ankle) / (np.linalg.norm(hip - knee) + np.linalg.norm(knee - ankle))
        assert straight > 0.985


def test_who_dances_where_they_stand_does_so_with_their_legs() -> None:
    dance = Action(Skill.LOCO, "dancing steps, arms swinging", Emotion.HAPPY, "floor", goal=(3.2, 2.6), stands=9.0)
    ((made, _),) = acted(dance)
    director = Director(ProceduralBackend())
    plan, _ = director.act(small_home(), dance, director.begin(small_home(), Character(), 3))
    assert made.phases[-1].backend == "diffusion"
    bends = [_knees_bend(motion.part(motion.phases[-1].start, len(motion))) for motion in (made, plan)]
    assert bends[0] > 0.7 * bends[1] > 0.07


def _knees_bend(motion: Motion) -> float:
    """How much the bend of the knees changes (standard deviation, radians), the mean of both."""
    knees = motion.local_rotations[:, [INDEX["left_knee"], INDEX["right_knee"]]].astype(np.float64)
    return float(np.linalg.norm(rotations.quat_to_rotvec(knees), axis=-1).std(axis=0).mean())
