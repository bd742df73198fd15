"""The end of a part that is still being done while the next part has begun: nobody finishes one thing, stops, and
begins another.

A part ends in a pose, and the next one sets out from that pose. Where the two flow together the last frames of the
first are kept back, as a tail, and are added to the first frames of the second: what every handle had still to go.
A tail begins with the frame before them, which was shown.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.metrics.contact_error import RISEN, risen
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import FPS, RISINGS, Motion
from motion_backend.procedural.pose import Pose, concatenate
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

TAILS: Final[dict[tuple[PartKind, PartKind], float]] = {
    (PartKind.WALK, PartKind.SIT): 0.95,
    (PartKind.WALK, PartKind.LIE): 0.95,
    (PartKind.WALK, PartKind.REACH): 0.8,
    (PartKind.WALK, PartKind.WALK): 0.7,
    (PartKind.REACH, PartKind.WALK): 0.8,
    (PartKind.REACH, PartKind.REACH): 0.5,
    (PartKind.RISE, PartKind.WALK): 0.35,
    (PartKind.RISE, PartKind.REACH): 0.35,
}
"""Seconds of a part that are still done while the next kind of part begins; others end before anything begins."""
ARRIVED, STAYS = 0.25, 0.13
"""Who walks somewhere is so near to the place (metres) for so long (seconds) before anything else begins."""
LEGS: Final = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("knee", "ankle")]
IN_SWING, CHANGES = 1.0, 0.35
"""A leg with a joint that is faster, or changes its speed by more in a frame (m/s), is in swing: nothing else begins
then."""
_PLACES: Final = ("pelvis", "spine", "head", "ankles", "toes", "knees", "arms", "reach")
_TURNS: Final = ("hips", "feet", "palms")
_SHARES: Final = ("reaching", "pressing")


def frames_kept_back(part: Part, upcoming: tuple[Part, ...], made: Motion) -> int:
    """How many of the frames made for a part are done together with the next one's; who rises stands first, who
    walks is there, and who has stepped up to a thing and walks off has stepped back."""
    later = next((one for one in upcoming if not only_stands(one) and not _leads_nowhere(one, part)), None)
    if later is None:
        return 0
    own, following = (PartKind.WALK if one.kind is PartKind.TURN else one.kind for one in (part, later))
    kept = min(round(TAILS.get((own, following), 0.0) * FPS), len(made) - 1)
    if (own, following) == (PartKind.REACH, PartKind.WALK):
        kept = min(kept, _lasting(made.contacts.min(axis=1) > 0))
    if part.goal is not None:
        stays = round(STAYS * FPS)
        away = np.hypot(*(made.root_positions[-kept - stays :, [0, 2]] - part.goal).T)
        kept = min(kept, len(away) - stays - int(np.argmax(away <= max(ARRIVED, away.min()))))
        kept -= _until_calm(made.part(max(len(made) - kept - 2, 0), len(made)))
    if part.kind is PartKind.RISE and kept > 0:
        up = risen(Kinematics.of(made.part(max(len(made) - FPS, 0), len(made))))
        kept = min(kept, _lasting(up) - round(RISEN[2] * FPS) - 1)
    return max(kept, 0)


def _lasting(holds: NDArray[np.bool_]) -> int:
    """For how many frames something has been so at the end."""
    return len(holds) if holds.all() else int(np.argmin(holds[::-1]))


def _until_calm(made: Motion) -> int:
    """The first frames, from the third on, in which a leg swings, or sets out or arrives."""
    gone = np.diff(Kinematics.of(made).positions[:, LEGS], axis=0) * FPS
    changed = np.linalg.norm(np.diff(gone, axis=0), axis=-1).max(axis=1, initial=0.0)
    calm = (np.linalg.norm(gone[1:], axis=-1).max(axis=1, initial=0.0) < IN_SWING) & (changed < CHANGES)
    return int(np.argmax(calm)) if calm.any() else 0


def _leads_nowhere(later: Part, part: Part) -> bool:
    """Whether a part only leads to where the part before it has led."""
    return later.kind is PartKind.WALK and later.goal == part.goal


def only_stands(part: Part) -> bool:
    """Whether a part is nothing but staying on the feet one has come to: who has something to do next does that."""
    return part.kind is PartKind.HOLD and part.reaction is None and part.action.skill in RISINGS


def carried_on(tail: Pose, pose: Pose) -> Pose:
    """Frames of a part with the tail of the one before it, which ended where these set out from, added to the first."""
    tail = tail.at(slice(1, None))
    frames, end = len(tail), tail.at(slice(len(tail) - 1, None))
    if len(pose) < frames:
        pose = concatenate([pose, pose.at(len(pose) - 1).repeat(frames - len(pose))])
    begun, changed = slice(0, frames), {}
    for name in (*_PLACES, *_SHARES):
        values = getattr(pose, name).copy()
        values[begun] += getattr(tail, name) - getattr(end, name)
        changed[name] = np.clip(values, 0.0, 1.0) if name in _SHARES else values
    for name in _TURNS:
        values = getattr(pose, name).copy()
        to_go = rotations.compose(getattr(tail, name), rotations.inverse(getattr(end, name)))
        values[begun] = rotations.compose(to_go, values[begun])
        changed[name] = values
    # A pole may point along its arm as well: only where the elbow is because of it can be gone on from.
    to_go = rotations.compose(_bent(tail), rotations.inverse(_bent(end)))
    elbows = pose.elbows.copy()
    elbows[begun] = rotations.rotate(rotations.compose(to_go, _bent(pose.at(begun))), np.array([0.0, 1.0, 0.0]))
    changed["elbows"] = elbows
    planted: Array = pose.planted.copy()
    planted[begun] = np.minimum(planted[begun], tail.planted)
    return replace(pose, **changed, planted=planted)


def _bent(pose: Pose) -> Array:
    """The frames that arms are bent in: along the arm, to the elbow, and square to both. (T, 2, 4)."""
    along = rotations.normalize(pose.arms)
    aside = rotations.normalize(pose.elbows - rotations.dot(pose.elbows, along) * along)
    return rotations.basis_to_quat(along, aside, rotations.cross(along, aside))
