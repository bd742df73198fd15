"""How a walking body is carried over its feet: the tables of data/gait/carriage.toml, metres at 1.70 m."""

from __future__ import annotations

from scene_graphs.data_tables import read_table, table


@table
class GaitWay:
    """How a way is gone."""

    pace_spread_share: float
    """Two walks of one style differ in speed by about this."""
    pace_spread_max_sigmas: float
    spin_rad_per_s: float
    spin_mps: float
    """and how fast it goes on meanwhile."""
    spin_eases_s: float
    """How much longer a spin takes."""
    stagger_aside_m: float
    """Of a drunk body of unit size."""
    stagger_aside_hz: float
    stagger_room_m: float
    """Who has less than this beside the way staggers the less."""
    stagger_turn_deg: float
    stagger_turn_hz: float
    stagger_ease_frames: float
    same_arms: float
    """A walk that goes on takes arms up as they swing that are no farther off than this (arm lengths),"""
    same_arms_s: float
    """over so long."""


@table
class Sway:
    """Over each foot that bears."""

    late_share: float
    """Of a step, later than half-way through a stance, the body is farthest over the foot,"""
    drops_late_share: float
    """and the other side of the pelvis lowest."""
    standing_ratio: float
    """Of the style's sway, the less the faster."""
    less_per_mps: float
    min_ratio: float
    max_ratio: float
    shoulders_ratio: float
    """How far the shoulders tip with the pelvis, and"""
    shoulders_late_share: float
    """how much later."""
    last_steps: float
    """All that swings fades over the last of this many steps."""


@table
class Surge:
    """Ahead of the mean way after each heel strike, behind before it."""

    ahead_m: float
    at_phase: float
    """Phase at which it is farthest ahead (share of a step)."""
    brisk_max_mps: float
    """Surge, lean and jolts grow with the speed up to here."""


@table
class Lean:
    """Trunk and pelvis, bent forwards and turned."""

    walking_rad: float
    """How much further forward the trunk is carried in walking than in standing,"""
    fast_rad_per_mps: float
    """and how much more in walking faster than"""
    fast_from_mps: float
    fast_within_mps: float
    falls_rad_per_mps: float
    """Who sets out falls forward before the step, for so much speed as is still to come within"""
    falls_ahead_s: float
    falls_within_m: float
    """and less and less over so much of the way (at 1.70 m)."""
    straightens_share: float
    """A bowed body straightens up so much where it arrives."""
    straightens_frames: float
    bowed_from_deg: float
    hips_share: float
    spine_share: float
    hips_wave_rad: float
    hips_wave_at_phase: float
    jolt_rad: float
    """Of the chest, as a heel comes down."""
    jolt_at_phase: float
    stamp_rad_per_m: float
    looks_share: float
    """Of the gaze's turn to where a way curves."""
    hips_late_share: float
    """Of a step, later than its lift hips are turned farthest to a foot that swings,"""
    counter_early_share: float
    """and so much earlier the chest is against them."""
    counter_ratio: float
    """Of the hips' turn, that the chest turns against it."""


@table
class Wander:
    """Nobody is as even as a clock."""

    hz: float
    trunk_deg: float
    arms_deg: float
    head_deg: float
    trembles_hz: float
    trunk_trembles_deg: float
    arms_tremble_deg: float
    head_trembles_deg: float


@table
class Drunk:
    """A stagger of unit size."""

    hz: float
    aside_m: float
    lean_rad: float
    side_rad: float
    nod_rad: float
    tilt_rad: float


@table
class Gaze:
    """The head."""

    ahead_frames: int
    """It turns to where the body will head so much later."""
    turn_max_rad: float
    chest_ahead_frames: int
    """The chest follows it so long before the pelvis does."""
    chest_max_rad: float
    counter_ratio: float
    """Of the hips' turn, that the head turns back."""
    start_frames: float
    end_frames: float
    glance_hz: float
    nod_hz: float
    veer_start_s: float
    veer_end_s: float
    level_share: float
    """Of the walking lean, that the head is kept level against."""
    fast_rad_per_mps: float
    fast_from_mps: float
    fast_within_mps: float
    jolt_share: float


@table
class Knees:
    """Where knees point."""

    foot_ratio: float
    """As the foot does, so much more than as the pelvis does."""
    foot_max_rad: float
    """But not as a foot that is turned further from the pelvis,"""
    inwards_rad: float
    """and so much further in: shins are twisted."""


@table
class Carriage:
    """data/gait/carriage.toml: metres at 1.70 m."""

    way: GaitWay
    sway: Sway
    surge: Surge
    lean: Lean
    wander: Wander
    drunk: Drunk
    gaze: Gaze
    knees: Knees


def carriage() -> Carriage:
    """How a walking body is carried over its feet."""
    rows: Carriage = read_table("motion_backend", "gait/carriage.toml", Carriage)
    return rows
