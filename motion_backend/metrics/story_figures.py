"""The figures that only a whole story has, or that are worked out over all of it (docs/metrics.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend.metrics.balance_figures import outside_soles, rising_frames, upright_frames
from motion_backend.metrics.joint_speed import WILD, joint_speeds
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.smoothness import jerk_against_real, seam_jump, seam_speed_jump
from motion_backend.metrics.story_flow import (
    FLOWS,
    Share,
    Span,
    seams,
    still_outside_holds,
    touch_waits,
    turning_on_the_spot,
)
from motion_backend.motion import Action, Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import JOINTS


@dataclass(frozen=True)
class StoryFigures:
    """What is seen of a whole story; shares and means keep what they are of, so that stories can be added up."""

    seam_jump: float
    """Metres."""
    seam_speed_jump: float
    """m/s."""
    joint_speed: float
    """Radians a second of the fastest joint, outside captions that are wild by name."""
    joint: str
    """Which that is."""
    jerk_against_real: float | None
    walk_seam_stops: Share
    """Of the seams between two walks, those at which the pelvis stops."""
    walk_seam_flows: Share
    """And those at which it is faster than 0.3 m/s."""
    still_share: Share
    """Of the frames that no action means to stay in, those in which nothing moves."""
    touch_wait: Share
    """Seconds of standing about before touches, over touches."""
    spot_turning: Share
    """Of all turning while up, that on the spot."""
    zmp_upright: Share
    """Metres that the zero-moment point is outside the soles, over frames of standing and walking."""
    zmp_rising: Share
    """The same over frames of standing up."""

    @property
    def values(self) -> dict[str, float | None]:
        """Every figure as one number; None where there is nothing that it is of."""
        return {
            name: one.value if isinstance(one, Share) else one for name, one in vars(self).items() if name != "joint"
        }

    def to_dict(self) -> dict[str, Any]:
        """Rounded for reading."""
        rounded = {name: None if one is None else round(float(one), 5) for name, one in self.values.items()}
        return rounded | {"joint_speed_joint": self.joint, "walk_seams": int(self.walk_seam_stops.whole)}


def story_figures(motion: Motion, actions: Sequence[Action], spans: Sequence[Span]) -> StoryFigures:
    """All of them, of a story whose actions fill the spans."""
    body = Kinematics.of(motion)
    walking = [seam for seam in seams(body, actions, spans) if seam.walking]
    waits, outside = touch_waits(body, actions, spans), outside_soles(body)
    joint, speed = _fastest(motion, actions, spans)
    return StoryFigures(
        seam_jump=seam_jump(motion),
        seam_speed_jump=seam_speed_jump(motion),
        joint_speed=speed,
        joint=joint,
        jerk_against_real=jerk_against_real(body),
        walk_seam_stops=Share(sum(seam.stops for seam in walking), len(walking)),
        walk_seam_flows=Share(sum(seam.speed > FLOWS for seam in walking), len(walking)),
        still_share=still_outside_holds(body, actions, spans),
        touch_wait=Share(sum(waits), len(waits)),
        spot_turning=turning_on_the_spot(body),
        zmp_upright=mean_over(outside, upright_frames(body)),
        zmp_rising=mean_over(outside, rising_frames(body)),
    )


def mean_over(values: Array, frames: NDArray[np.bool_]) -> Share:
    """The mean of values (T,) over some frames, those left out in which it is not a number."""
    judged = values[frames & np.isfinite(values)]
    return Share(float(judged.sum()), float(len(judged)))


def _fastest(motion: Motion, actions: Sequence[Action], spans: Sequence[Span]) -> tuple[str, float]:
    """The joint that turns fastest outside what is wild by name, and its speed (rad/s)."""
    speeds = joint_speeds(motion.local_rotations, motion.fps)
    for action, (start, stop) in zip(actions, spans, strict=True):
        if action.caption in WILD:
            speeds[max(start - 1, 0) : stop] = 0.0
    if not speeds.any():
        return "", 0.0
    joint = int(speeds.max(axis=0).argmax())
    return JOINTS[joint], float(speeds[:, joint].max())
