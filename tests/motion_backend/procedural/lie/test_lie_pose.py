"""Lying down: every caption is its own performance, bodies lie on what they lie on, and hands where they are said."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from importlib import resources
from itertools import combinations

import numpy as np
import pytest
from layers import sampled
from small_home import DIRECTOR, after, contact, rise, small_home

from motion_backend.backend_protocol import BodyState, PartKind
from motion_backend.body.capsules import BODIES, placed
from motion_backend.body.joint_limits import limits_share
from motion_backend.body.segment_masses import centres_of_mass
from motion_backend.body.self_collision import self_penetration
from motion_backend.metrics.foot_skate import skate_ratio, support_slip
from motion_backend.metrics.joint_speed import fastest_joint
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import FPS, Action, Emotion, Motion, PhaseKind, Skill
from motion_backend.procedural.lie.lie_pose import Bed, place_to_lie
from motion_backend.procedural.lie.lie_styles import lie_style, wanted_edge
from motion_backend.procedural.tail import TAILS
from motion_backend.skeleton import INDEX, LYING_REST
from scene_graphs.affordances.affordances import floor_spot, spots

HOME = small_home()
CAPTIONS: list[str] = json.loads(
    resources.files("planner_service").joinpath("data/captions.json").read_text(encoding="utf-8")
)["liedown"]
STYLES = {caption: lie_style(Emotion.NEUTRAL, caption) for caption in CAPTIONS}
ON_A_SIDE = [caption for caption, style in STYLES.items() if style.side != "back" and not style.propped]


@cache
def lie(caption: str, name: str = "sofa", which: int = 0, height: float = 1.70) -> Motion:
    action = contact(HOME, Skill.LIEDOWN, name, caption, which=which)
    if caption.endswith("foot on the floor"):
        action = replace(action, spot=place_to_lie([action.spot], caption) if action.spot else None)
    return DIRECTOR.act(HOME, action, after(HOME, seed=2, height=height))[0]


def held(caption: str, name: str = "sofa", which: int = 0) -> dict[str, np.ndarray]:
    """Where joints are in the last frame, seen from the pelvis along the sofa: left, towards the head, up."""
    motion = lie(caption, name, which)
    positions = motion.joint_positions()[-1].astype(np.float64)
    yaw = spots(HOME.object(f"0/{name}"), "lie")[which].facing
    up = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    frame = np.stack([np.cross(up, [0.0, 1.0, 0.0]), up, [0.0, 1.0, 0.0]])
    return {joint: frame @ (positions[index] - positions[0]) for joint, index in INDEX.items()}


def which_has(side: str, name: str) -> int:
    """The spot of a piece whose free edge is on that side of who lies on the back."""
    found = spots(HOME.object(f"0/{name}"), "lie")
    return next(i for i, s in enumerate(found) if (np.sin(s.facing - s.approach) > 0) == (side == "left"))


@pytest.mark.parametrize("caption", sampled(CAPTIONS, 5))
def test_a_lying_body_keeps_its_joints_and_its_place(caption: str) -> None:
    motion = lie(caption)
    assert motion.completed, motion.reason
    still = motion.part(len(motion) - 45, len(motion))
    assert limits_share(still.local_rotations) <= 0.02
    goal = np.array(motion.goals[0].position)
    moved = np.linalg.norm(still.root_positions - goal, axis=1).max()
    assert moved <= 0.03
    positions, world = still.skeleton.forward_kinematics(still.root_positions, still.local_rotations)
    assert self_penetration(still.skeleton, positions.astype(np.float64), world).max() <= 0.05


@pytest.mark.sweep
def test_no_two_captions_of_lying_look_alike() -> None:
    poses = {caption: np.stack(list(held(caption).values())) for caption in CAPTIONS}
    for one, other in combinations(CAPTIONS, 2):
        apart = np.linalg.norm(poses[one] - poses[other], axis=1).max()
        assert apart > 0.06, f"{one!r} looks like {other!r}"


def test_who_lies_on_a_side_has_hips_and_shoulders_one_above_the_other() -> None:
    for caption, below, above in (
        ("side-lie on left, legs bent", "left", "right"),
        ("side-lie on right", "right", "left"),
    ):
        at = held(caption)
        assert at[f"{above}_hip"][2] - at[f"{below}_hip"][2] > 0.16
        assert at[f"{above}_shoulder"][2] - at[f"{below}_shoulder"][2] > 0.24
        assert at[f"{above}_knee"][2] > at[f"{below}_knee"][2] + 0.05


@pytest.mark.parametrize("caption", ON_A_SIDE)
def test_on_a_side_one_leg_lies_on_the_mattress_the_other_upon_it_and_no_hand_on_the_face(caption: str) -> None:
    side = STYLES[caption].side
    below, above = ("left", "right") if side == "left" else ("right", "left")
    at, surface = held(caption, "sofa", which_has(side, "sofa")), -LYING_REST - 0.017
    for name, least, most in ((below, 0.03, 0.09), (above, 0.1, 0.21)):
        for joint in ("ankle", "knee"):
            assert surface + least < at[f"{name}_{joint}"][2] < surface + most
    assert at[f"{below}_shoulder"][2] < surface + 0.08
    assert np.linalg.norm(at[f"{above}_wrist"] - at["head"]) > 0.25


def test_who_reads_or_has_the_hands_on_the_belly_lies_on_the_back_with_both_elbows_on_the_mattress() -> None:
    for caption in ("reading on the back, book held above the chest", "hands on belly"):
        at = held(caption, "bed")
        assert max(at["left_elbow"][2], at["right_elbow"][2]) < 0.06, caption


def test_the_upper_hand_of_who_lies_on_a_side_is_on_the_body_or_on_the_mattress() -> None:
    for caption in ("side-lie on left, legs bent", "side-lie on left, legs crossed", "side-lie on right"):
        motion = lie(caption, "sofa", which_has(STYLES[caption].side, "sofa"))
        body = Kinematics.of(motion.part(len(motion) - 1, len(motion)))
        starts, ends, radii = (
            part[0] if part.ndim > 1 else part for part in placed(body.motion.skeleton, body.positions, body.world)
        )
        hand = [one.name for one in BODIES].index("right_hand" if STYLES[caption].side == "left" else "left_hand")
        legs = [index for index, one in enumerate(BODIES) if one.name.endswith("thigh") or one.name == "pelvis"]
        middle = 0.5 * (starts[hand] + ends[hand])
        gaps = [
            np.linalg.norm(middle - point) - radii[leg] - radii[hand]
            for leg in legs
            for point in np.linspace(starts[leg], ends[leg], 9)
        ]
        over = middle[1] - radii[hand] - (body.positions[0, 0, 1] - LYING_REST - 0.017)
        assert min(*gaps, over) < 0.05, caption


def test_curled_up_is_tighter_than_legs_bent() -> None:
    which = which_has("left", "sofa")
    curled = held("curled up on the left side, knees drawn up", "sofa", which)
    bent = held("side-lie on left, legs bent", "sofa", which)
    chest = "spine3"
    assert np.linalg.norm(curled["left_knee"] - curled[chest]) < np.linalg.norm(bent["left_knee"] - bent[chest]) - 0.1


def test_hands_on_the_belly_lie_on_its_skin() -> None:
    motion = lie("hands on belly")
    positions, world = motion.skeleton.forward_kinematics(motion.root_positions[-1:], motion.local_rotations[-1:])
    start, end, radii = placed(motion.skeleton, positions.astype(np.float64), world)
    names = ("torso", "left_hand", "right_hand")
    from motion_backend.body.capsules import BODIES

    torso, *hands = (next(i for i, body in enumerate(BODIES) if body.name == name) for name in names)
    axis = end[0, torso] - start[0, torso]
    for hand in hands:
        middle = 0.5 * (start[0, hand] + end[0, hand])
        share = np.clip((middle - start[0, torso]) @ axis / (axis @ axis), 0.0, 1.0)
        gap = np.linalg.norm(middle - start[0, torso] - share * axis) - radii[torso] - radii[hand]
        assert -0.01 < gap < 0.032


def test_a_foot_on_the_floor_is_on_the_floor_and_a_bent_leg_is_not() -> None:
    which = which_has("left", "sofa")
    caption = "lying, left foot on the floor"
    motion = lie(caption, "sofa", which)
    assert motion.joint_positions()[-1, INDEX["left_ankle"], 1] == pytest.approx(motion.skeleton.ankle_height, abs=0.02)
    assert lie("left leg bent", "sofa", which).joint_positions()[-1, INDEX["left_ankle"], 1] > 0.3
    assert wanted_edge(caption) == "left"


def test_on_the_elbows_the_forearms_lie_on_the_mattress_and_the_head_is_up() -> None:
    motion = lie("elbows supporting body, left leg bent")
    top = spots(HOME.object("0/sofa"), "lie")[0].point[1]
    at = motion.joint_positions()[-1]
    for joint in ("left_elbow", "right_elbow", "left_wrist", "right_wrist"):
        assert at[INDEX[joint], 1] - top == pytest.approx(0.045, abs=0.03)
    assert at[INDEX["head"], 1] - top > 0.35


def test_the_body_sits_on_the_edge_and_bears_on_a_hand_before_it_lies() -> None:
    motion = lie("lying down, legs straight")
    spot = spots(HOME.object("0/sofa"), "lie")[0]
    positions = motion.joint_positions()
    trunk = positions[:, INDEX["neck"], 1] - positions[:, 0, 1]
    seated = (trunk > 0.42) & (positions[:, 0, 1] < spot.point[1] + 0.15)
    assert seated.sum() > 15
    wrists = positions[seated][:, [INDEX["left_wrist"], INDEX["right_wrist"]]]
    assert np.abs(wrists[..., 1] - spot.point[1] - 0.06).min() < 0.03


@pytest.mark.parametrize("height", [1.5, 1.9])
def test_short_and_tall_bodies_lie_as_well(height: float) -> None:
    motion = lie("lying with hands under head, legs crossed", "bed", 0, height)
    assert motion.completed
    assert np.abs(motion.root_positions[-30:] - np.array(motion.goals[0].position)).max() < 0.03


@cache
def on_the_floor(caption: str) -> tuple[Action, Motion, BodyState]:
    """Lying down on the floor."""
    action = Action(Skill.LIEDOWN, caption, Emotion.NEUTRAL, "floor", "floor", floor_spot("lie", (3.2, 2.6), 0.7))
    return action, *DIRECTOR.act(HOME, action, after(HOME, seed=2))


def test_no_knee_swings_round_its_leg_on_the_way_to_a_side() -> None:
    for caption in (caption for caption, style in STYLES.items() if style.side != "back" and style.propped):
        motion = on_the_floor(caption)[1]
        assert fastest_joint(motion.local_rotations, FPS)[1] < 15, caption
        assert limits_share(motion.local_rotations) == 0, caption


@cache
def up_again(caption: str, how: str) -> Motion:
    """Getting up from the floor."""
    action, _, state = on_the_floor(caption)
    return DIRECTOR.act(HOME, replace(rise(action, Skill.GETUP), caption=how), state)[0]


def during(motion: Motion, *kinds: PhaseKind) -> slice:
    """The frames of some parts that follow each other."""
    found = [phase for phase in motion.phases if phase.kind in kinds]
    return slice(found[0].start, found[-1].stop)


@pytest.mark.parametrize(
    "caption", sampled(["curled up on the left side, knees drawn up", "lying still", "side-lie on right"], 3)
)
def test_the_floor_is_lain_on_and_got_up_from(caption: str) -> None:
    down = on_the_floor(caption)[1]
    quick, slow = (up_again(caption, how) for how in ("get up quickly", "get up slowly"))
    assert down.root_positions[-1, 1] < 0.15
    for up in (quick, slow):
        assert up.completed, up.reason
        assert up.root_positions[-1, 1] > 0.85 * up.skeleton.standing_height
        assert limits_share(up.local_rotations) == 0.0
    assert limits_share(down.local_rotations) == 0.0
    assert len(slow) > 1.5 * len(quick)


@pytest.mark.parametrize("which", [0, 1])
def test_one_goes_down_to_the_floor_and_up_from_it_over_hands_and_knees(which: int) -> None:
    motion = (on_the_floor("lying still")[1], up_again("lying still", "get up slowly"))[which]
    joints = motion.joint_positions()[
        during(motion, *((PhaseKind.EDGE, PhaseKind.LIEDOWN), (PhaseKind.GETUP, PhaseKind.STANDUP))[which])
    ]
    knees, wrists = (joints[:, [INDEX[f"left_{joint}"], INDEX[f"right_{joint}"]]] for joint in ("knee", "wrist"))
    high = joints[:, 0, 1] > 0.4
    kneeling = high & (knees[..., 1].max(axis=1) < 0.09)
    assert kneeling.sum() > 10
    assert np.ptp(knees[kneeling, 0], axis=0).max() < 0.02
    assert (kneeling & (wrists[..., 1].max(axis=1) < 0.12)).any()
    one_down = high & (knees[:, 0, 1] < 0.09) & (knees[:, 1, 1] > 0.35)
    assert one_down.any()


def test_hands_that_carry_stay_and_are_lifted_when_the_body_is_over_its_heels() -> None:
    motion = up_again("lying still", "get up slowly")
    frames = during(motion, PhaseKind.GETUP)
    body = Kinematics.of(motion.part(frames.start, frames.stop))
    left, right = (body.positions[:, INDEX[f"{side}_wrist"]] for side in ("left", "right"))
    rising = np.arange(len(body.positions)) >= np.flatnonzero(body.positions[:, 0, 1] > 0.2)[0]
    for hand in (left, right):
        carries = rising & (hand[:, 1] < 0.065)
        assert carries.sum() > 10
        assert np.ptp(hand[carries][:, [0, 2]], axis=0).max() < 0.05
    lifted = np.flatnonzero(rising & (right[:, 1] < 0.065))[-1]
    centre = centres_of_mass(motion.skeleton, body.positions, body.world)[lifted]
    knee, ankle = (
        body.positions[lifted, [INDEX[f"{side}_{joint}"] for side in ("left", "right")]].mean(axis=0)
        for joint in ("knee", "ankle")
    )
    back = (ankle - knee) * [1.0, 0.0, 1.0]
    assert (centre - knee) @ back / np.linalg.norm(back) > -0.02


@pytest.mark.parametrize("which", [0, 1])
def test_no_arm_is_drawn_out_from_under_the_trunk_that_rolls_on_the_floor(which: int) -> None:
    motion = (on_the_floor("lying still")[1], up_again("lying still", "get up slowly"))[which]
    joints = motion.joint_positions()[during(motion, (PhaseKind.LIEDOWN, PhaseKind.GETUP)[which])].astype(np.float64)
    pelvis, shoulder, elbow, wrist = (
        joints[:, INDEX[name]] for name in ("pelvis", "left_shoulder", "left_elbow", "left_wrist")
    )
    # The shoulder below carries, and the trunk is over the side.
    turned = joints[:, INDEX["right_shoulder"], 1] - shoulder[:, 1] > 0.2
    rolls = turned & (shoulder[:, 1] < 0.15)
    assert rolls.sum() > 10
    for joint in (elbow, wrist):
        assert np.linalg.norm(np.diff(joint[rolls], axis=0), axis=1).sum() < 0.2, "it is drawn along"
    trunk, arm = ((joint - pelvis)[rolls][:, [0, 2]] for joint in (shoulder, elbow))
    before = np.abs(trunk[:, 0] * arm[:, 1] - trunk[:, 1] * arm[:, 0]) / np.linalg.norm(trunk, axis=1)
    assert before.min() > 0.2, "the elbow is under the trunk"


def test_feet_do_not_slide_on_the_way_down_and_up() -> None:
    # What is walked before is held against walkers, who swing their toes low (test_how_people_walk), its last step too.
    down, up = on_the_floor("lying still")[1], up_again("lying still", "get up slowly")
    lies, rises = during(down, PhaseKind.EDGE, PhaseKind.LIEDOWN), during(up, PhaseKind.GETUP, PhaseKind.STANDUP)
    last_step = round(TAILS[PartKind.WALK, PartKind.LIE] * FPS)
    for motion, frames in ((down, slice(lies.start + last_step, lies.stop)), (up, rises)):
        body = Kinematics.of(motion.part(frames.start, frames.stop))
        assert skate_ratio(body) <= 0.02
        assert support_slip(body) < 1.0, "feet are drawn over the floor"


def test_who_stands_up_from_the_knees_is_over_the_right_foot_until_the_left_one_is_down() -> None:
    motion = up_again("lying still", "get up slowly")
    frames = during(motion, PhaseKind.STANDUP)
    body = Kinematics.of(motion.part(frames.start, frames.stop))
    alone = (body.motion.contacts.reshape(-1, 2, 2).max(axis=2) > 0.5) @ [1, 2] == 2
    alone &= body.positions[:, 0, 1] > 0.5
    assert alone.sum() > 10
    centre = centres_of_mass(motion.skeleton, body.positions, body.world)[alone]
    soles = body.soles[alone, 1]
    across = soles[:, 2] - soles[:, 3]
    aside = ((centre - soles[:, 2:].mean(axis=1)) * across)[:, [0, 2]].sum(axis=1) / np.linalg.norm(across, axis=1)
    assert np.abs(aside).max() < 0.06


@pytest.mark.parametrize("turned", [0.0, 2.0])
def test_who_puts_a_foot_down_lies_by_the_edge(turned: float) -> None:
    bed = replace(HOME.object("0/bed"), yaw=turned)
    found = spots(bed, "lie")
    spot = place_to_lie(found, "lying, left foot on the floor")
    assert Bed.of(spot).edge_side == "left"
    assert spot.edge <= 0.30
    plain = place_to_lie(found, "left leg bent")
    assert plain == found[0]


def test_captions_say_which_edge_is_wanted() -> None:
    assert wanted_edge("side-lie on right") == "right"
    assert wanted_edge("lying still") is None
    assert lie_style(Emotion.NEUTRAL, "curled up on the left side, knees drawn up").legs == "tucked"
