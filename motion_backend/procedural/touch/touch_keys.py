"""Tables of touching: key poses down to the knees, and those of what is done at a thing.

The files in `data/transitions` say how their columns are to be read. Whoever gives a character poses of its own hands
in tables with other rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from motion_backend.procedural.touch.bursts import Burst
from motion_backend.procedural.touch.reach_keys import ElbowPole, ReachTable
from scene_graphs.data_tables import read_table, table

Foot = Literal["standing", "lifted", "back"]
"""Where it stood, half-way back and off the floor, or back on its curled toes."""


@table
class KneelPose:
    """A key pose on the way down."""

    name: str
    pelvis_back_m: float
    """Behind the standing feet."""
    pelvis_up_m: float
    lean_rad: float
    """Of the trunk, forwards."""
    left: Foot = "standing"
    right: Foot = "standing"


@table
class KneelingBody:
    """What the key poses share."""

    hips_share: float
    """Of the lean."""
    spine_share: float
    head_forward_rad: float
    lifted_m: float
    """Off the floor, a foot half-way back."""
    behind_m: float
    """How far behind where they stood the ankles of a kneeling body are."""
    apart_m: float
    """From the middle to either of them."""
    ankle_up_m: float
    foot_pitch_rad: float
    """How far the feet stand upright."""
    toes_rad: float
    knee_down_ratio: float
    """How much knees point down for what they point ahead."""


@table
class Prone:
    """A body on its knees, sat back and bent forwards, one hand on the floor."""

    lean_min_deg: float
    """Leans that are tried."""
    lean_below_deg: float
    lean_step_deg: float
    usual_lean_deg: float
    pelvis_ahead_m: float
    """Of the ankles."""
    pelvis_up_m: float
    hips_share: float
    """Of the lean."""
    spine_share: float
    arm_max_share: float
    """Of its length, that an arm is stretched to."""
    arm_min_share: float
    unusual_m: float
    """A radian off the usual lean is worth such a miss."""
    head_pitch_rad: float
    bearing_ahead_m: float
    """Of its shoulder, the hand that bears."""
    bearing_elbow: ElbowPole
    top_elbow: ElbowPole
    """Of the hand on a top."""
    front_elbow: ElbowPole


@table
class KneelTable:
    """Down to both knees, and prone from there: `kneel_to_touch.toml`."""

    pose: tuple[KneelPose, ...]
    body: KneelingBody
    prone: Prone


@table
class TouchPose:
    """A key pose of a touch."""

    name: str
    body: Literal["standing", "looking", "at it"]
    """Where the body is: away from the thing, the same with the eyes on it, or bent to it."""
    off_m: float = 0.0
    """At the thing: how far its hand is off the surface."""
    fingers_rad: float = 0.0
    """How far the fingers are turned into the surface."""
    drawn_out_m: float = 0.0
    """How far the hand has then been drawn out from the surface."""
    drawn_back_m: float = 0.0
    """The same over a top, towards the body."""
    arms: str = ""
    """Away from it: the arm pose of the hands that touch; as they were where that is empty."""
    arms_up_arms: float = 0.0
    """How much higher these hands are held (arm lengths)."""
    spine_forward_rad: float = 0.0
    spine_turn_rad: float = 0.0
    """Towards the side of its hand."""
    pelvis_back_m: float = 0.0
    head_forward_rad: float = 0.0
    head_pitch_rad: float | None = None
    """The bend of the head in place of what it was."""


@table
class TouchKey:
    """One step of the way through the poses."""

    stage: Literal["come", "do", "leave", "after"]
    pose: str
    wait_s: float
    """To get to it from the one before; the least it takes at the pace "hold"."""
    pace: Literal["body", "hands", "clock", "hold"]
    """Of the bending body, of the hands, the same in any mood, or what is left of the seconds to stay."""


@table
class Stroke:
    """A hand that flies from a pose in which it is drawn back onto the thing, and is stopped by it."""

    speed_mps: float
    """Of the hand as it gets there."""
    speed_share: float
    """A standard deviation of that,"""
    speed_min_mps: float
    speed_max_mps: float
    """and its bounds, whatever the mood."""
    palm_share: float
    """Of the way in time, the palm is turned to the surface by then."""


@table
class TouchTable:
    """What is done at a thing: a file of `touch_*.toml`."""

    key: tuple[TouchKey, ...]
    pose: tuple[TouchPose, ...]
    hold_min_s: float = 0.0
    """What a hand that stays there does takes at least this long."""
    busy_s: float = 0.0
    """How much of the seconds to stay is over where the stage "after" begins."""
    stroke: Stroke | None = None
    """How the last key of the stage "come" is got to, where that is with a blow."""


@table
class Rest:
    """A hand that rests: it slides, the trunk breathes, eyes wander."""

    slide_m: float
    slide_hz: float
    breath_rad: float
    breath_hz: float
    nod_ratio: float
    """Of the breath, in the head."""
    glance_rad: float
    glance_hz: float
    glance_ease_s: float


@table
class Recoil:
    """A hand that was stopped: it bounces, the trunk goes on, and then it leans there, out of breath."""

    off_m: float
    off_s: float
    follows_rad: float
    """Of the trunk, forwards."""
    follows_s: float
    breath_ratio: float
    """Against who rests there."""


@table
class Wash:
    """Strokes from side to side."""

    stroke_hz: float
    grows_s: float
    """How long strokes take to become as wide as they get."""
    forth_share: float
    """How far to and fro, of the stroke's width: hands go round."""
    palm_rad: float
    """How far the hand turns on the surface at the end of a stroke."""
    usual_m: float
    """A stroke to either side for which trunk and head go as far as said."""
    pelvis_share: float
    """Of the stroke."""
    spine_forth_rad: float
    spine_lean_rad: float
    spine_turn_rad: float
    head_lean_rad: float
    head_turn_rad: float


@table
class Rotate:
    """A grip turned, let go and taken anew."""

    turn_rad: float
    turn_hz: float
    turning_share: float
    """Of the time, that it turns; then it goes back."""
    lets_go_m: float
    """How far the hand is off on the way back."""
    grip_m: float
    """From the wrist to the middle of what it turns about."""
    lift_per_rad: float
    """How far the hand comes off what it lies on for every radian of the turn (metres)."""
    pelvis_m: float
    spine_turn_rad: float
    spine_side_rad: float
    head_turn_rad: float
    head_side_rad: float


@table
class Pull:
    """A handle taken along."""

    grips_s: float
    """For which the hand is at it before."""
    speed_mps: float
    """With which it goes along, on the whole."""
    rate_radps: float
    """With which what swings turns, at most, on the whole (radians a second)."""
    swing_min_s: float
    """For which it does so at least."""
    least_s: float
    """For which it stays where that ends, at least."""


@table
class HandMove:
    """One wave that a hand is moved by over what it is at."""

    rate_hz: float | None = None
    """Without one it goes there and stays."""
    aside_m: float = 0.0
    """To the body's left along the surface."""
    ahead_m: float = 0.0
    off_m: float = 0.0
    """Out from the surface."""
    tilt_rad: float = 0.0
    """About the way of the fingers, the thumb downwards."""
    bend_rad: float = 0.0
    """At the wrist, fingers off the surface."""
    phase_share: float = 0.0
    taps: bool = False
    """Whether only its upper half is gone through."""
    burst: Burst | None = None


@table
class Busy:
    """What a hand does that comes and goes over a thing: waves, each added to the ones before."""

    moves: tuple[HandMove, ...]
    spine_turn_rad: float = 0.0
    """Of the trunk, for every stroke aside by `Wash.usual_m`."""
    ear_turn_rad: float = 0.0
    """How far the head is turned away from the hand, an ear to the thing."""
    ear_side_rad: float = 0.0
    """And bent down to it."""


@table
class HeldTouches:
    """touch_held.toml."""

    ease_s: float
    """They grow out of the pose at the thing, and back into it, over this long."""
    rest: Rest
    recoil: Recoil
    wash: Wash
    rotate: Rotate
    pull: Pull
    busy: dict[str, Busy]


@dataclass(frozen=True)
class TouchKeys:
    """The tables of touching, for those who vary them."""

    reach: ReachTable
    kneel: KneelTable
    held: HeldTouches
    rest: TouchTable
    press: TouchTable
    wash: TouchTable
    rotate: TouchTable
    pick: TouchTable
    put: TouchTable
    knock: TouchTable
    stir: TouchTable
    pour: TouchTable
    strike: TouchTable
    pull: TouchTable

    def of(self, doing: str) -> TouchTable:
        """The key poses of what is done (see `hand_captions.Handled`)."""
        table: TouchTable = getattr(self, doing or "rest")
        return table


def touch_keys() -> TouchKeys:
    """The tables that are shipped."""
    deeds = {
        name: read_table("motion_backend", f"transitions/touch_{name}.toml", TouchTable)
        for name in ("rest", "press", "wash", "rotate", "pick", "put", "knock", "stir", "pour", "strike", "pull")
    }
    return TouchKeys(
        read_table("motion_backend", "transitions/reach.toml", ReachTable),
        read_table("motion_backend", "transitions/kneel_to_touch.toml", KneelTable),
        read_table("motion_backend", "transitions/touch_held.toml", HeldTouches),
        **deeds,
    )
