"""The figures of a trial and of a story, put together from what `measures` defines (docs/metrics.md).

A trial is one keyframe: the frames a backend made for one action. Thresholds are the paper's: sit and reach 20 cm,
lie 30 cm; a walk hands over within 30 cm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.joint_limits import limits_share
from motion_backend.body.scene_collision import Obstacles
from motion_backend.body.self_collision import self_penetration
from motion_backend.metrics.balance_figures import outside_soles, rising_frames, upright_frames
from motion_backend.metrics.contact_error import outcome
from motion_backend.metrics.foot_skate import (
    floor_penetration,
    height_above_support,
    skate_ratio,
    skate_speed,
    support_slip,
)
from motion_backend.metrics.joint_speed import WILD, fastest_joint
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import CLEARLY_IN, penetration
from motion_backend.metrics.smoothness import jerk, jerk_peak
from motion_backend.metrics.stillness import frozen_share
from motion_backend.metrics.story_figures import mean_over
from motion_backend.motion import Action, Motion, Skill


@dataclass(frozen=True)
class KeyframeFigures:
    """How well one keyframe went."""

    keyframe: int
    skill: str
    reached: bool
    """Within the threshold without a break for one second (a walk: at its end; rising: for a tenth)."""
    reached_any: bool
    """Within the threshold in any frame (SIMS' own rule)."""
    reached_strict: bool
    """Within 10 cm, as long as `reached` asks for."""
    contact_error: float | None
    """Metres from joint to goal: the smallest in the last second of the contact."""
    contact_mean: float | None
    """The mean of the same over the hold."""
    execution_time: float | None
    """Seconds until the threshold was first met; None if never."""
    seconds: float
    skate_ratio: float
    """GMD: share of frames with a toe near the floor and faster than 0.5 m/s."""
    skate: float
    """Mean speed of soles on the floor, cm/s."""
    slip: float
    """Mean speed of the best supported point of the soles, cm/s."""
    pen_mean: float
    """Mean over frames of the deepest point inside furniture, metres."""
    pen_max: float
    pen_share: float
    """Share of frames with a point deeper than 2 cm."""
    floor_pen: float
    """Mean depth of the lowest sole corner below the floor, metres."""
    floating: float
    """Mean height of the lowest point of the body above what is under it, metres."""
    self_pen_max: float
    """How deep the body's own parts are in each other, metres."""
    self_pen_share: float
    """Share of frames with two parts deeper than 2 cm in each other."""
    limits_share: float
    """Share of frames with a joint more than 5 degrees beyond its range."""
    jerk: float
    """Mean over joints and frames, m/s³."""
    jerk_peak: float
    """99th percentile over joints and frames, m/s³."""
    joint_speed: float | None
    """Radians a second of the fastest joint; None for a caption that is wild by name."""
    frozen_share: float
    """Share of frames in which no joint moves."""
    zmp_upright: float | None
    """Metres that the zero-moment point is outside the soles on average while standing or walking; None without."""
    zmp_rising: float | None
    """The same while standing up."""
    reason: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Plain values, rounded for reading."""
        return {key: round(value, 5) if isinstance(value, float) else value for key, value in asdict(self).items()}


def judge(motion: Motion, action: Action, obstacles: Obstacles) -> KeyframeFigures:
    """All figures of one keyframe."""
    body = Kinematics.of(motion)
    found = outcome(action, body)
    depth = penetration(body, obstacles, action)
    own = self_penetration(motion.skeleton, body.positions, body.world)
    outside = outside_soles(body)
    return KeyframeFigures(
        keyframe=action.keyframe,
        skill=action.skill.value,
        reached=found.reached,
        reached_any=found.reached_any,
        reached_strict=found.reached_strict,
        contact_error=found.error,
        contact_mean=found.mean_error,
        execution_time=found.seconds,
        seconds=motion.duration,
        skate_ratio=skate_ratio(body),
        skate=skate_speed(body),
        slip=support_slip(body),
        pen_mean=float(depth.mean()),
        pen_max=float(depth.max()),
        pen_share=float((depth > CLEARLY_IN).mean()),
        floor_pen=floor_penetration(body),
        floating=float(height_above_support(body, obstacles).mean()),
        self_pen_max=float(own.max()),
        self_pen_share=float((own > CLEARLY_IN).mean()),
        limits_share=limits_share(motion.local_rotations),
        jerk=jerk(body.positions, motion.fps),
        jerk_peak=jerk_peak(body.positions, motion.fps),
        joint_speed=None if action.caption in WILD else fastest_joint(motion.local_rotations, motion.fps)[1],
        frozen_share=frozen_share(body),
        zmp_upright=mean_over(outside, upright_frames(body)).value,
        zmp_rising=mean_over(outside, rising_frames(body)).value,
        reason=motion.reason,
    )


def summarise(figures: Sequence[KeyframeFigures]) -> dict[str, Any]:
    """The whole story: what was reached and how well, weighted by time where a figure is per frame."""
    seconds = np.array([f.seconds for f in figures])
    loco = np.array([f.skill == Skill.LOCO.value for f in figures])
    contacts = [f for f in figures if f.contact_error is not None]

    def mean(name: str, chosen: NDArray[np.bool_] | None = None) -> float:
        values = np.array([getattr(f, name) for f in figures])
        weights = seconds if chosen is None else seconds * chosen
        return round(float((values * weights).sum() / max(weights.sum(), 1e-9)), 5)

    def most(name: str) -> float:
        return round(float(max((getattr(f, name) for f in figures), default=0.0)), 5)

    def share(name: str) -> float:
        return round(float(sum(getattr(f, name) for f in figures)) / max(len(figures), 1), 4)

    by_skill = {
        skill.value: {
            "keyframes": sum(f.skill == skill.value for f in figures),
            "reached": sum(f.reached for f in figures if f.skill == skill.value),
        }
        for skill in Skill
        if any(f.skill == skill.value for f in figures)
    }
    return {
        "keyframes": len(figures),
        "reached": sum(f.reached for f in figures),
        "success": share("reached"),
        "success_any_frame": share("reached_any"),
        "success_strict": share("reached_strict"),
        "by_skill": by_skill,
        "contact_error": average([f.contact_error for f in contacts]),
        "contact_error_success": average([f.contact_error for f in contacts if f.reached]),
        "contact_mean": average([f.contact_mean for f in contacts]),
        "execution_time": average([f.execution_time for f in figures]),
        "skate_ratio_loco": mean("skate_ratio", loco),
        "skate": mean("skate"),
        "slip": mean("slip"),
        "pen_mean": mean("pen_mean"),
        "pen_share": mean("pen_share"),
        "pen_max": most("pen_max"),
        "floor_pen": mean("floor_pen"),
        "floating": mean("floating"),
        "self_pen_max": most("self_pen_max"),
        "self_pen_share": mean("self_pen_share"),
        "limits_share": mean("limits_share"),
        "frozen_share": mean("frozen_share"),
        "jerk": mean("jerk"),
        "jerk_peak": mean("jerk_peak"),
        "seconds": round(float(seconds.sum()), 3),
    }


def average(values: Sequence[float | None]) -> float | None:
    """The plain mean of those that are there; None where there are none."""
    known = [value for value in values if value is not None]
    return round(float(np.mean(known)), 5) if known else None
