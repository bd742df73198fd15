"""Tables of sitting: key poses down to a seat and up from it, and how legs, hands and trunk are held on it.

The files in `data/transitions` say how their columns are to be read. Whoever gives a character poses of its own hands
in tables with other rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from scene_graphs.data_tables import read_table, table

Vector = tuple[float, float, float]


@table
class SeatedLeg:
    """What one leg does: a row of `sit_pose.toml`, which says how its columns are to be read."""

    name: str
    outwards_m: float
    knee_out_rad: float
    knee_up_ratio: float
    foot: Literal["flat", "heel", "free"]
    low_outwards_m: float | None = None
    stretched_share: float = 0.0
    beyond_m: float = 0.0
    ahead_m: float | None = None
    low_ahead_m: float | None = None
    lifted_m: float = 0.0
    ankle_height_m: float | None = None
    """Over the floor, where it does not follow from how the foot stands."""
    below_seat_m: float | None = None
    """Pelvis to ankle, where that is given instead."""


@table
class HangingFeet:
    """What becomes of feet that do not come down to the floor."""

    below_seat_m: float
    ahead_m: float
    knee_up_ratio: float


@table
class SeatedLegs:
    """All that legs of a sitter do."""

    pose: tuple[SeatedLeg, ...]
    hanging: HangingFeet

    def of(self, name: str) -> SeatedLeg:
        """The row of that name."""
        return next(row for row in self.pose if row.name == name)


@table
class Surface:
    """How a hand lies on something besides the body: a row of `sit_pose.toml`."""

    name: str
    fingers_out_rad: float
    """Against the way one looks."""
    elbow_direction: Vector
    inwards_m: float = 0.0
    """Of a table, from its edge to the palm, or from the pelvis to the palm within the bounds below."""
    min_inwards_m: float | None = None
    max_inwards_m: float | None = None
    apart_m: float = 0.0
    """Of a table, from palm to palm."""


@table
class Trunk:
    """Which share of a lean the trunk's parts take, and how far it leans back at most."""

    hips_back_share: float
    hips_forward_share: float
    spine_back_share: float
    spine_forward_share: float
    head_ahead_share: float
    """Of a lean back, what the head takes back: one still looks ahead, for the most part."""
    max_back_deg: float
    max_free_deg: float
    """Where there is no backrest."""
    max_propped_deg: float
    """Where there is none, with hands beside or behind."""


@table
class SitPose:
    """How a settled sitter holds legs, hands and trunk."""

    legs: SeatedLegs
    surface: tuple[Surface, ...]
    trunk: Trunk

    def surface_of(self, name: str) -> Surface:
        """The row of that name."""
        return next(row for row in self.surface if row.name == name)


@table
class Look:
    """Over the shoulder at the seat: by so much times how far the manner looks, but for `spine_pitch_rad`."""

    time_s: float
    head_pitch_rad: float
    head_turn_rad: float
    spine_pitch_rad: float
    spine_turn_rad: float


@table
class Lower:
    """What the key poses down to a seat have in common."""

    time_s: float
    lean_rad: float
    lean_per_depth_rad: float
    low_tuck_share: float
    arms_down_share: float
    arms_ahead_ratio: float
    low_arms_out_ratio: float
    low_arms_up_ratio: float


@table
class Lowered:
    """A key pose on the way down to a seat."""

    name: str
    time_share: float
    pelvis_back_share: float
    pelvis_down_share: float
    sway_ratio: float
    hip_pitch_share: float
    hip_tuck_ratio: float
    spine_pitch_share: float
    spine_tuck_ratio: float
    head_pitch_rad: float
    arms_share: float
    felt_share: float


@table
class Settling:
    """A key pose of the weight coming down."""

    name: str
    time_s: float
    tempo_time_s: float
    sink_ratio: float
    spine_share: float
    head_pitch_rad: float


@table
class Move:
    """How long hands and feet take from pose to pose."""

    min_time_s: float
    time_per_m_s: float
    first_foot_s: float
    foot_time_s: float


@table
class SitDown:
    """From standing to settled; `sit_down.toml` says how its columns are to be read."""

    look: Look
    lower: Lower
    pose: tuple[Lowered, ...]
    settle: tuple[Settling, ...]
    take: Move


@table
class Ready:
    """Leaning over the feet, about to rise."""

    name: Literal["ready"]
    time_share: float
    pelvis_ahead_m: float
    hip_pitch_share: float
    spine_pitch_share: float
    arms_up_ratio: float
    arms_ahead_ratio: float


@table
class Risen:
    """A key pose on the way up."""

    name: Literal["leave", "lift", "straighten"]
    time_share: float
    pelvis_ahead_share: float
    pelvis_up_share: float
    hip_pitch_share: float
    spine_pitch_share: float
    arms_up_ratio: float
    arms_ahead_ratio: float
    arms_away_share: float
    held_share: float


@table
class Rise:
    """What the key poses up from a seat have in common."""

    time_s: float
    lean_rad: float
    lean_per_depth_rad: float
    gathered_share: float
    low_fold_share: float
    low_lean_ratio: float
    low_time_ratio: float
    """How much longer it takes from the floor, for its depth."""


@table
class StandUp:
    """From a seat to standing; `stand_up.toml` says how its columns are to be read."""

    gather: Move
    rise: Rise
    pose: tuple[Ready, Risen, Risen, Risen]
    low_pose: tuple[Risen, Risen, Risen]
    """In place of the last three, from the floor."""


@dataclass(frozen=True)
class SitKeys:
    """The tables of sitting, for those who vary them."""

    pose: SitPose
    down: SitDown
    up: StandUp
    spread: dict[str, float]
    """How far people sit otherwise, standard deviations; `sit_own.toml` says of what."""


def sit_keys() -> SitKeys:
    """The tables that are shipped."""
    return SitKeys(
        read_table("motion_backend", "transitions/sit_pose.toml", SitPose),
        read_table("motion_backend", "transitions/sit_down.toml", SitDown),
        read_table("motion_backend", "transitions/stand_up.toml", StandUp),
        read_table("motion_backend", "transitions/sit_own.toml", dict[str, float]),
    )
