"""Frames before a motion begins that are no part of it: T-poses put in front, and markers that were not yet found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend.clips.clip import Clip
from motion_backend.clips.mapping import JointMap
from motion_backend.clips.tposes import is_t_pose

MAX_JOINT_SPEED = 15.0
"""Metres a second: no joint of a person moves faster; what does is a jump of the data."""
_LEAD = 0.25
"""Seconds at the start in which such frames are looked for."""
_MIN_FRAMES = 4


def without_stray_frames(clip: Clip, given: JointMap | None = None) -> Clip:
    """The clip from where no joint moves faster than 15 m/s, with a note of what was dropped.

    A T-pose that stands in front is the source's own, better than one made of its rest pose.
    """
    steps = min(len(clip) - 2, max(_MIN_FRAMES, round(_LEAD * clip.fps)))
    positions, _ = clip.bones.forward_kinematics(clip.root_positions[: steps + 1], clip.local_rotations[: steps + 1])
    speeds = np.linalg.norm(np.diff(positions, axis=0), axis=-1).max(axis=1) * clip.fps  # (steps,)
    jumps = np.flatnonzero(speeds > MAX_JOINT_SPEED)
    if len(jumps) == 0:
        return clip
    first = int(jumps[-1]) + 1
    fastest = speeds[jumps].max()
    note = f"{first} leading frame{'s' * (first > 1)} dropped: a T-pose or stray (a joint moved {fastest:.0f} m/s)"
    kept = replace(clip.part(first, len(clip)), notes=(*clip.notes, note))
    lead = np.concatenate([clip.tpose[:1], clip.local_rotations[0, 1:]])
    return replace(kept, tpose=lead) if is_t_pose(clip.bones, lead, given) else kept
