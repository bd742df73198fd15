"""Tables of reaching: the search for a posture, how a hand lies, and what differs from one time to the next.

The file `data/transitions/reach.toml` says how its columns are to be read.
"""

from __future__ import annotations

import numpy as np

from motion_backend.rotations import Array
from scene_graphs.data_tables import table


@table
class ElbowPole:
    """Where an elbow points in the chest frame: out to its own side, up and ahead."""

    out: float
    up: float
    ahead: float

    def of(self, index: int) -> Array:
        """For the left (0) or the right (1) elbow. (3,)."""
        return np.array([self.out if index == 0 else -self.out, self.up, self.ahead])


@table
class Approach:
    """The way to the thing."""

    over_m: float
    """How far from a surface a hand comes down on it."""
    eyes_there_share: float
    """How far the head is bent as it will be at the thing before anything else moves."""
    eyes_kept_share: float
    """And how far as it was."""
    begun_share: float
    """And so far it has then begun to bend."""
    settle_s: float
    kneeling_ratio: float
    """Who kneels down takes so much longer."""
    folded: str
    """The arm pose through which a hand is raised, and from which it comes down."""
    folding_s: float
    kneeling_step_s: float
    """For each step of getting down on the knees."""
    deep_m: float
    """Lowering the pelvis by more than this slows a reach down."""
    tiptoe_ratio: float
    """How far feet tip against what the ankles' rise asks for."""
    tiptoe_max_share: float
    """Of the foot's length, that ankles rise."""
    goes_along_power: float
    """Of the share of its way to the thing: how much sooner than that a hand goes with the body again."""


@table
class FreeArm:
    """What the other arm does meanwhile: names of arm poses, by what the hand does."""

    low_share: float
    """Below this share of the standing height of its pelvis a body lays the free hand on a thigh."""
    bent_over_cos: float
    """And beyond this tilt of its chest."""
    high_m: float
    """A hand above this is balanced by the arm pose `high`."""
    high: str
    doing: dict[str, str]


@table
class ThighHand:
    """The free hand on a thigh."""

    along_share: float
    """Of the way to the knee."""
    over_m: float
    """The wrist above the middle of the thigh."""
    elbow: ElbowPole


@table
class ReachingHand:
    """A hand on its way onto a surface."""

    raised_from_m: float
    """From this height on it is raised,"""
    raised_within_m: float
    """and altogether so much higher."""
    behind_share: float
    """Onto a top it comes from the body's side by this share of its height over it,"""
    behind_raised_share: float
    """and this much more where it is raised."""
    pressing_share: float
    """How far the palm lies as the surface does while it is still off it."""
    low_m: float


@table
class HandPlacement:
    """How a hand lies on a surface, and its elbow: ways that are tried, and what they cost."""

    top_turns_rad: tuple[float, ...]
    """On a top, inwards from straight ahead;"""
    front_turns_rad: tuple[float, ...]
    """on a front, inwards from straight up."""
    tips_rad: tuple[float, ...]
    """Of the fingers into the surface."""
    swings_rad: tuple[float, ...]
    """Of the elbow, outwards and up."""
    deep_per_m: float
    """Skin in something."""
    hover_per_m: float
    """Air between the palm and the surface."""
    strain_per_rad: float
    """A shoulder beyond its range."""
    bend_per_rad: float
    """A wrist bent."""
    unlike_per_rad: float
    """A hand that lies otherwise than it is told to: its wrist cannot."""
    turn_per_rad: float
    tip_per_rad: float
    swing_per_rad: float


@table
class ReachingElbow:
    """Where the elbow of a reaching arm points by itself."""

    behind: ElbowPole
    """Of a lowered hand;"""
    raised_by: ElbowPole
    """how that changes as the hand is raised."""
    low: ElbowPole
    over_edge: ElbowPole
    """Onto a high top."""


@table
class ReachSearch:
    """The postures that are tried."""

    lean_below_deg: float
    lean_step_deg: float
    rise_max_m: float
    """Of the pelvis, on tiptoes."""
    crouch_below_m: float
    crouch_step_m: float
    back_lean_m: float
    """How far the pelvis goes back with the sine of the lean,"""
    back_crouch_share: float
    """and with the crouch."""
    hips_share: float
    """Of the lean."""
    spine_share: float
    spine_rad: float
    turn_rad: float
    """How far the shoulder of the one hand comes forward,"""
    turn_within_rad: float
    """from this lean on altogether."""
    arm_max_share: float
    """Of its length, that an arm is stretched to,"""
    arm_raised_share: float
    """and so much more straight up."""
    arm_min_share: float
    head_up_m: float
    """The middle of the head from the chest."""
    head_ahead_m: float
    head_room_m: float
    """That it keeps to furniture,"""
    knee_room_m: float
    """and the middles of both knees,"""
    behind_m: float
    """and, so far behind the pelvis, who crouches"""
    behind_room_m: float
    """to what is there."""


@table
class ReachEffort:
    """What counts in choosing among them."""

    miss_per_m: float
    lean_per_rad: float
    lean_per_rad2: float
    busy_lean_per_rad2: float
    """The same of who does something there for a while."""
    tiptoe: float
    tiptoe_per_m: float
    stretch_from_m: float
    """To what is higher than this one stretches,"""
    stretch_within_m: float
    """wholly so from so much higher:"""
    stretch_m: float
    """heels rise by so much of themselves."""
    crouch_per_m: float
    """To what is low."""
    crouch_more_per_m: float
    """And so much more to what is higher than"""
    squat_below_m: float
    squat_within_m: float
    """by this."""
    crouch_top_per_m: float
    """The least to a top above `top_above_m`,"""
    crouch_top_per_m2: float
    """the more the deeper: back and knees share it,"""
    top_above_m: float
    top_below_m: float
    """And below this: to higher ones knees give."""


@table
class ReachGaze:
    """Where the head looks."""

    eyes_up_m: float
    """Above the shoulders."""
    leant_share: float
    """Of the lean, that the gaze has gone down already."""
    nod_min_rad: float
    nod_max_rad: float
    turn_max_rad: float


@table
class StepIn:
    """One foot goes up to the thing as the body bends to it, and back."""

    least_m: float
    most_m: float
    pelvis_share: float
    """How far the pelvis goes with it, of its way."""
    lift_m: float
    room_m: float
    """That its toes keep to furniture."""
    toes_m: float
    """Before the ankle."""
    comes_from_share: float
    """Of the time until the hand is there,"""
    comes_to_share: float
    goes_from_share: float
    """and of the time in which the body rises again."""
    goes_to_share: float


@table
class ReachVariation:
    """What differs from one time to the next: standard deviations."""

    tempo_share: float
    pelvis_m: float
    """To each side and ahead."""
    spine_rad: float
    deep_share: float
    """Of all this, where one squats."""
    head_rad: float
    elbow_ratio: float
    """Of an elbow's direction, in each of its three parts."""
    wrist_arms: float
    """Of the free wrist."""
    over_share: float
    """Of the height from which a hand comes down."""
    misses_m: float
    """The hand still gets so near."""


@table
class Arriving:
    """The end of a walk to a thing."""

    hand_s: float
    """The hand begins to rise so long before one stands."""
    hand_share: float
    """How far it has, on the way into the arm pose `hand`."""
    hand: str
    looks_rad: float
    """A head turned from the thing by this much takes as long as the table says to look at it."""


@table
class ReachTable:
    """Bringing a hand onto a surface: `reach.toml`."""

    approach: Approach
    free_arm: FreeArm
    thigh: ThighHand
    hand: ReachingHand
    placement: HandPlacement
    elbow: ReachingElbow
    search: ReachSearch
    effort: ReachEffort
    gaze: ReachGaze
    step: StepIn
    variation: ReachVariation
    arriving: Arriving
