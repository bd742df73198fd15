"""Tables of lying: key poses down onto a bed or the floor and up again, and how trunk, legs and hands lie there.

The files in `data/transitions` say how their columns are to be read. Whoever gives a character poses of its own hands
in tables with other rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from motion_backend.procedural.lie.lie_own import LieOwn, timed
from motion_backend.procedural.own_way import DRAWN
from scene_graphs.data_tables import read_table, table

Vector = tuple[float, float, float]


@table
class LyingLeg:
    """A left leg: ankle in the pelvis frame (left, towards the head, forwards), and how foot and knee are turned."""

    name: str
    ankle_m: Vector
    foot_pitch_rad: float
    """0 looks forwards, positive tips the toes away from the head."""
    knee_out_ratio: float
    """How far outwards the knee points, against forwards."""
    foot_out_rad: float
    """How far the toes fall outwards."""


@table
class Fold:
    """A leg of who lies on a side: bends at hip and knee, plantar flexion."""

    hip_deg: float
    knee_deg: float
    plantar_deg: float


@table
class SideLegs:
    """The leg below and the leg above of who lies on a side."""

    name: str
    below: Fold
    above: Fold
    above_ankle_up_m: float = 0.135
    """The ankle above, over what the body lies on."""


@table
class RestingHand:
    """A left hand at rest, in the chest's frame (left, towards the head, forwards)."""

    name: str
    wrist_m: Vector
    elbow_direction: Vector
    fingers_direction: Vector
    back_direction: Vector
    """Where the back of the hand looks: away from what the palm lies on."""
    with_head: bool = False
    """Whether it goes with the head when that is raised."""
    room_m: float = 0.0
    """How much room beside the middle of the body the arm needs."""
    narrower: str | None = None
    """The row with less."""


@table
class OnBack:
    """The trunk of who lies on the back."""

    spine_lift_share: float


@table
class Propped:
    """Raised on the elbows."""

    hips_back_rad: float
    head_pitch_rad: float
    shoulder_height_m: float
    elbow_aside_share: float
    elbow_ahead_share: float
    forearm_inwards_share: float


@table
class HeadInHand:
    """On a side, the head in the hand below; in the head's frame, as if lying on the left."""

    hips_up_rad: float
    elbow_ahead_ratio: float
    spine_pitch_rad: float
    spine_turn_rad: float
    head_pitch_rad: float
    head_side_rad: float
    head_turn_rad: float
    wrist_m: Vector
    fingers_direction: Vector
    back_direction: Vector


@table
class OnSide:
    """The trunk of who lies on a side; to the left for who lies on the left."""

    pelvis_up_m: float
    tucked_curl_rad: float
    shoulder_up_m: float
    """Of the shoulder below, over what the body lies on: the trunk bends off it."""
    spine_turn_rad: float
    head_pitch_rad: float
    head_curl_share: float


@table
class FootDown:
    """A leg over the side of a bed, its foot on the floor."""

    thigh_share: float
    out_share: float
    toes_out_share: float
    toes_along_share: float
    knee_up_ratio: float


@table
class OverEnd:
    """A straight leg over a low end of a place that is too short."""

    foot_out_m: float
    heel_down_m: float
    under_ankle_m: float
    foot_pitch_rad: float
    knee_out_ratio: float


@table
class BeforeEnd:
    """A leg with the knee up before a high end of a place that is too short."""

    short_of_end_m: float
    min_heel_down_m: float
    behind_m: float
    foot_pitch_rad: float
    knee_out_ratio: float


@table
class LiePose:
    """How a lying body holds trunk, legs and hands."""

    back: OnBack
    propped: Propped
    head_in_hand: HeadInHand
    side: OnSide
    foot_down: FootDown
    over_end: OverEnd
    before_end: BeforeEnd
    leg: tuple[LyingLeg, ...]
    side_legs: tuple[SideLegs, ...]
    back_hand: tuple[RestingHand, ...]
    below_hand: tuple[RestingHand, ...]
    above_hand: tuple[RestingHand, ...]


@table
class OverEdge:
    """Between sitting on the edge of a bed and lying on that side: the body turns about the way it looks."""

    name: str
    wait_s: float
    pelvis_share: float
    pelvis_up_m: float
    tilt_rad: float
    roll_rad: float
    spine_pitch_rad: float
    spine_side_rad: float
    head_pitch_rad: float
    head_side_rad: float
    head_turn_rad: float
    legs_rad: tuple[float, float]
    """Of the leg on the side of the head end, and of the other."""
    feet_apart_share: float
    foot_pitch_rad: float
    below_share: float
    above_share: float
    below_wrist_ratio: Vector
    below_elbow_direction: Vector
    above_wrist_ratio: Vector
    above_elbow_direction: Vector
    feet_up_m: tuple[float, float]
    """How far over the floor feet are at least; those that are not, and hang straight down, stand."""
    foot_drawn_m: float = 0.0
    """How much nearer to the hip feet are than they hang: knees bend for it."""


@table
class Rolled:
    """On the side of the edge, knees bent; arms are rows of `lie_pose.toml`."""

    name: Literal["rolled"]
    wait_s: float
    head_pitch_rad: float
    pelvis_share: float
    below_arm: str
    above_arm: str


@table
class PushingHands:
    """Where the hands push: the one below, on the side of the head end, and the one above, before the chest."""

    below_min_headwards_m: float
    below_max_headwards_m: float
    below_out_m: float
    below_fingers_rad: float
    above_headwards_m: float
    above_out_m: float
    above_fingers_rad: float
    inside_edge_m: float


@table
class SettleOnBed:
    """Times of what comes after the side: flat with bent knees, a leg lifted over the other, the way of lying."""

    back_wait_s: float
    bent_wait_s: float
    lifted_wait_s: float
    end_wait_s: float
    end_after_lifted_wait_s: float


@table
class LieDown:
    """From the edge of a bed to lying; `lie_down.toml` says how its columns are to be read."""

    pose: tuple[OverEdge, ...]
    side: Rolled
    settle: SettleOnBed
    hands: PushingHands


@table
class LeaveBed:
    """Times of what comes before the side: a leg lifted over, flat with bent knees (see `freed`)."""

    lifted_wait_s: float
    bent_wait_s: float


@table
class SittingUp:
    """Upright on the edge with both feet down."""

    name: Literal["sitting"]
    wait_s: float
    hip_pitch_rad: float
    spine_pitch_rad: float
    head_pitch_rad: float
    foot_out_m: float
    knee_up_ratio: float
    wrist_ratio: Vector
    elbow_direction: Vector


@table
class RiseToEdge:
    """From lying to sitting on the edge of a bed; `rise_to_edge.toml` says how its columns are to be read."""

    leave: LeaveBed
    side: Rolled
    pose: tuple[OverEdge, ...]
    end: SittingUp
    hands: PushingHands


@table
class OneKnee:
    """The left knee down, the right foot standing; a hand pushes on that thigh on the way up."""

    name: Literal["one_knee"]
    wait_s: float
    pelvis_aside_m: float
    pelvis_back_m: float
    hand_share: float
    hip_pitch_rad: float
    spine_pitch_rad: float
    knee_up_ratio: float


@table
class OverOneKnee:
    """Still on both knees, the weight over the left one before the right foot is taken."""

    name: Literal["over_one_knee"]
    wait_s: float
    pelvis_aside_m: float
    pelvis_back_m: float
    spine_pitch_rad: float
    spine_side_rad: float


@table
class BothKnees:
    """Upright on both knees."""

    name: Literal["both_knees"]
    wait_s: float
    pelvis_back_m: float
    hip_pitch_rad: float
    spine_pitch_rad: float
    head_pitch_rad: float
    knee_down_ratio: float
    arms_down_share: float
    arms_ahead_ratio: float


@table
class HandsAndKnees:
    """Hands where they bear the body on its hip: what carries it stays."""

    name: Literal["hands_and_knees"]
    wait_s: float
    pelvis_back_m: float
    hip_pitch_rad: float
    spine_pitch_rad: float
    head_pitch_rad: float
    elbow_direction: Vector


@table
class SatBack:
    """Over the heels, where no hand is needed; the right one still bears a little."""

    name: Literal["sat_back"]
    wait_s: float
    pelvis_back_m: float
    hip_pitch_rad: float
    spine_pitch_rad: float
    head_pitch_rad: float
    wrist_ratio: Vector


@table
class OnHip:
    """Half-way between hands and knees and lying on the side."""

    name: Literal["on_hip"]
    wait_s: float
    pelvis_out_m: float
    pelvis_up_m: float
    spine_pitch_rad: float
    spine_side_rad: float
    head_pitch_rad: float
    right_ankle_up_m: float
    toes_bend_rad: float
    left_hand_headwards_m: float
    left_hand_out_m: float
    right_hand_headwards_m: float
    right_hand_out_m: float
    left_elbow_direction: Vector
    right_elbow_direction: Vector


@table
class Pushing:
    """Over the right foot, the left one pushing off."""

    name: Literal["pushing"]
    wait_s: float
    hip_pitch_rad: float
    spine_pitch_rad: float
    pelvis_ahead_m: float
    pelvis_up_m: float
    pelvis_aside_m: float
    hand_share: float


@table
class Stood:
    """Standing, and how far the pelvis is over the right foot, and lower, until the left one is down beside it."""

    name: Literal["stood"]
    wait_s: float
    aside_m: float
    down_m: float


@table
class Step:
    """When a foot goes from its place to another, at tempo 1."""

    begins_s: float
    ends_s: float


@table
class SettleOnFloor:
    """Times of what comes after the hip is down (see `freed`)."""

    side_wait_s: float
    back_wait_s: float
    lifted_wait_s: float
    end_wait_s: float


@table
class LieOnFloor:
    """From standing to lying on the floor; `lie_on_floor.toml` says how its columns are to be read."""

    pose: tuple[OneKnee, OverOneKnee, BothKnees, SatBack, HandsAndKnees, OnHip]
    left_step: Step
    right_step: Step
    settle: SettleOnFloor


@table
class LeaveFloor:
    """Times of what comes before the hip is up (see `freed`)."""

    back_wait_s: float
    lifted_wait_s: float
    side_wait_s: float


@table
class RiseFromFloor:
    """From lying on the floor to standing; `rise_from_floor.toml` says how its columns are to be read."""

    leave: LeaveFloor
    pose: tuple[OnHip, HandsAndKnees, SatBack, BothKnees, OverOneKnee, OneKnee, Pushing, Stood]
    left_step: Step
    right_step: Step


@dataclass(frozen=True)
class LieKeys:
    """The tables of lying, for those who vary them."""

    pose: LiePose
    down: LieDown
    up: RiseToEdge
    floor_down: LieOnFloor
    floor_up: RiseFromFloor
    own: LieOwn
    """How people differ."""


def lie_keys() -> LieKeys:
    """The tables that are shipped."""
    return LieKeys(
        read_table("motion_backend", "transitions/lie_pose.toml", LiePose),
        read_table("motion_backend", "transitions/lie_down.toml", LieDown),
        read_table("motion_backend", "transitions/rise_to_edge.toml", RiseToEdge),
        read_table("motion_backend", "transitions/lie_on_floor.toml", LieOnFloor),
        read_table("motion_backend", "transitions/rise_from_floor.toml", RiseFromFloor),
        read_table("motion_backend", "transitions/lie_own.toml", LieOwn),
    )


def paced(keys: LieKeys, rng: np.random.Generator) -> LieKeys:
    """The tables with the times of this time: over an edge each pose takes its own; on the floor, where feet step in
    time with them, all are quicker or slower."""
    spread = keys.own.spread["wait_share"]

    def drawn() -> float:
        return float(np.exp(spread * np.clip(rng.normal(), -DRAWN, DRAWN)))

    floor = drawn()
    return replace(
        keys,
        down=timed(keys.down, drawn),
        up=timed(keys.up, drawn),
        floor_down=timed(keys.floor_down, lambda: floor),
        floor_up=timed(keys.floor_up, lambda: floor),
    )
