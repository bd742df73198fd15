"""CMU trials as exponential maps: 117 comma-separated numbers a frame.

Root position, root rotation, then 37 rotations in the order of CMU's BVH joints with end sites counted. The sign is
reversed: R = exp(-v). The first row is a T-pose. Offsets are in no such file: they come from a BVH of that skeleton,
or else from the T-pose and a body of our own lengths.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.mocap.axes_and_units import unit_of
from motion_backend.mocap.clip import MAX_TURNS, Bones, Clip, ClipError, make_bones, make_clip
from motion_backend.mocap.readers.bvh_reader import all_numbers, bvh_bones, parse_hierarchy
from motion_backend.mocap.resampling import without_stray_frames
from motion_backend.mocap.rest_pose import t_posed
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton

WIDTH: Final = 117
UNIT: Final = 0.0254 / 0.45
"""Metres a unit of the root's path, CMU's."""
RATE: Final = 120.0
"""Frames a second of CMU's captures; the format does not say."""
_SIDE: Final = (
    ("{0}HipJoint", "Hips", None),
    ("{1}UpLeg", "{0}HipJoint", "hip"),
    ("{1}Leg", "{1}UpLeg", "knee"),
    ("{1}Foot", "{1}Leg", "ankle"),
    ("{1}ToeBase", "{1}Foot", "foot"),
    ("", "", None),
)
_TRUNK: Final = (
    ("LowerBack", "Hips", None),
    ("Spine", "LowerBack", "spine1"),
    ("Spine1", "Spine", "spine2"),
    ("Neck", "Spine1", "spine3"),
    ("Neck1", "Neck", "neck"),
    ("Head", "Neck1", "head"),
    ("", "", None),
)
_ARM: Final = (
    ("{1}Shoulder", "Spine1", "collar"),
    ("{1}Arm", "{1}Shoulder", "shoulder"),
    ("{1}ForeArm", "{1}Arm", "elbow"),
    ("{1}Hand", "{1}ForeArm", "wrist"),
    ("{1}FingerBase", "{1}Hand", None),
    ("{1}HandIndex1", "{1}FingerBase", None),
    ("", "", None),
    ("{0}Thumb", "{1}Hand", None),
    ("", "", None),
)
"""Joint, parent and which of our bones leads to it; nameless rows are end sites, which take three numbers too."""


def read_expmap_clip(text: str, skeleton: str | None, name: str) -> Clip:
    """The clip in a text of exponential maps, on the skeleton of a BVH text or on a body of our own lengths."""
    table = _table(text)
    joints = _joints()
    slots = [slot for slot, (joint, _, _) in enumerate(joints) if joint]
    vectors = table[:, 3:].reshape(len(table), -1, 3)[:, slots]
    turns = rotations.rotvec_to_quat(-vectors)
    notes = [
        f"lengths of the root's path x {UNIT:.6g}, CMU's unit",
        f"{RATE:g} frames a second, as CMU captures: the format does not say",
    ]
    if skeleton is None:
        bones, order = _own_bones(turns[0])
        notes.append("no skeleton given: a body of our own lengths; name a BVH of the same subject for its own")
    else:
        bones, order = _bones_of(skeleton, {joints[slot][0] for slot in slots})
    turns = turns[:, order]
    tpose = t_posed(bones, np.concatenate([np.array([rotations.IDENTITY]), turns[0, 1:]]))
    return without_stray_frames(make_clip(name, bones, table[:, :3] * UNIT, turns, tpose, RATE, "expmap", notes))


def _joints() -> list[tuple[str, str, str | None]]:
    """The 38 joints of a row, in its order."""
    rows: list[tuple[str, str, str | None]] = [("Hips", "", None)]
    for part in (_SIDE, None, _ARM):
        if part is None:
            rows += _TRUNK
            continue
        for marks in (("L", "Left"), ("R", "Right")):
            rows += [(joint.format(*marks), above.format(*marks), bone) for joint, above, bone in part]
    return rows


def _own_bones(tpose: Array) -> tuple[Bones, list[int]]:
    """CMU's joints on bones of our lengths, laid out so that the T-pose (31, 4) is one."""
    rows = [row for row in _joints() if row[0]]
    names = [joint for joint, _, _ in rows]
    parents = [names.index(above) if above else -1 for _, above, _ in rows]
    ours = build_skeleton().offsets
    offsets = np.zeros((len(rows), 3))
    world = np.tile(rotations.IDENTITY, (len(rows), 1))
    for joint, (name, _, bone) in enumerate(rows):
        if parents[joint] < 0:
            continue
        world[joint] = rotations.compose(world[parents[joint]], tpose[joint])
        side = "right" if name.startswith("R") else "left"
        own = next((ours[INDEX[key]] for key in (bone or "", f"{side}_{bone}") if key in INDEX), np.zeros(3))
        offsets[joint] = rotations.rotate(rotations.inverse(world[parents[joint]]), own)
    return make_bones(names, parents, offsets)


def _bones_of(skeleton: str, wanted: set[str]) -> tuple[Bones, list[int]]:
    """The bones of a BVH text in metres, and where each stands among ours."""
    bones, _ = bvh_bones(parse_hierarchy(skeleton.partition("MOTION")[0]))
    if set(bones.names) != wanted:
        raise ClipError(f"the skeleton must have CMU's {len(wanted)} joints, {', '.join(sorted(wanted)[:3])} …")
    unit, _ = unit_of(bones)
    ours = [joint for joint, _, _ in _joints() if joint]
    return Bones(bones.names, bones.parents, bones.offsets * unit), [ours.index(name) for name in bones.names]


def _table(text: str) -> Array:
    """All numbers. (T, 117)."""
    if text.count(",") > MAX_TURNS:
        raise ClipError("it has too many frames", "cut it into shorter files")
    rows = [line for line in text.splitlines() if line.strip()]
    wrong = next((number for number, row in enumerate(rows) if row.count(",") != WIDTH - 1), None)
    if wrong is not None:
        raise ClipError(f"row {wrong + 1} has {rows[wrong].count(',') + 1} numbers; {WIDTH} are wanted")
    values = all_numbers(",".join(rows).replace(",", " "), "a row")
    if len(values) != len(rows) * WIDTH:
        raise ClipError("rows must be numbers with commas between them, none left out")
    if not np.isfinite(values).all():
        wrong = int(np.flatnonzero(~np.isfinite(values))[0]) // WIDTH
        raise ClipError(f"row {wrong + 1} holds a number that is not finite")
    return values.reshape(len(rows), WIDTH)
