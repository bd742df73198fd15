"""Which of a source's joints is which of our 22: tables for the families of names in use, or a user's own.

Where a source has two joints for one of ours (neck, spine, wrist), the lower one is named: its world rotation holds
both. A joint of ours that no source joint stands for follows its parent.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from motion_backend.mocap.clip import ClipError
from motion_backend.skeleton import JOINTS

JointMap = dict[str, str]
"""Our joint name to the source's."""
_PAIRED = ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")
REQUIRED_JOINTS = ("pelvis", *(f"{side}_{joint}" for joint in _PAIRED for side in ("left", "right")))
"""Joints without which a body cannot be told."""
_ONE_OF = (("spine1", "spine2", "spine3"), ("neck", "head"))
"""Of these one of each is wanted too."""
_MAX_MAP_BYTES = 1 << 20


@dataclass(frozen=True)
class Family:
    """Names that files of one origin use."""

    name: str
    middle: Mapping[str, str]
    """Our joints of the middle to their names."""
    sides: Mapping[str, str]
    """Our joints without left_ or right_ to a pattern; {} stands for the side's mark."""
    marks: tuple[str, str] = ("Left", "Right")

    def joints(self) -> JointMap:
        """Our joint to theirs."""
        pairs = dict(self.middle)
        for side, mark in zip(("left", "right"), self.marks, strict=True):
            pairs |= {f"{side}_{joint}": pattern.format(mark) for joint, pattern in self.sides.items()}
        return {joint: pairs[joint] for joint in JOINTS if joint in pairs}


_BVH_ARMS = {"collar": "{}Shoulder", "shoulder": "{}Arm", "elbow": "{}ForeArm", "wrist": "{}Hand"}
_BVH_LEGS = {"hip": "{}UpLeg", "knee": "{}Leg", "ankle": "{}Foot", "foot": "{}ToeBase"}
_BVH_HEAD = {"pelvis": "Hips", "neck": "Neck", "head": "Head"}
_SIDES = {joint[5:]: joint[5:] for joint in JOINTS if joint.startswith("left_")}
FAMILIES = (
    Family(
        "CMU trials as BVH",
        {**_BVH_HEAD, "spine1": "LowerBack", "spine2": "Spine", "spine3": "Spine1", "neck": "Neck1"},
        _BVH_LEGS | _BVH_ARMS,
    ),
    Family(
        "MIT trials as BVH",
        {**_BVH_HEAD, "spine1": "Spine", "spine2": "Spine2", "spine3": "Spine3"},
        _BVH_LEGS | _BVH_ARMS,
    ),
    Family(
        "Mixamo",
        {**_BVH_HEAD, "spine1": "Spine", "spine2": "Spine1", "spine3": "Spine2"},
        _BVH_LEGS | _BVH_ARMS,
    ),
    Family(
        "Kimodo",
        {"pelvis": "Hips", "spine1": "Spine1", "spine2": "Spine2", "spine3": "Chest", "neck": "Neck2", "head": "Head"},
        {"hip": "{}Leg", "knee": "{}Shin", "ankle": "{}Foot", "foot": "{}ToeBase"} | _BVH_ARMS,
    ),
    Family(
        "Acclaim bones",
        {
            "pelvis": "root",
            "spine1": "lowerback",
            "spine2": "upperback",
            "spine3": "thorax",
            "neck": "upperneck",
            "head": "head",
        },
        {
            "hip": "{}femur",
            "knee": "{}tibia",
            "ankle": "{}foot",
            "foot": "{}toes",
            "collar": "{}clavicle",
            "shoulder": "{}humerus",
            "elbow": "{}radius",
            "wrist": "{}hand",
        },
        ("l", "r"),
    ),
    Family(
        "Quaternius",
        {
            "pelvis": "DEF-hips",
            "spine1": "DEF-spine.001",
            "spine2": "DEF-spine.002",
            "spine3": "DEF-spine.003",
            "neck": "DEF-neck",
            "head": "DEF-head",
        },
        {
            "hip": "DEF-thigh.{}",
            "knee": "DEF-shin.{}",
            "ankle": "DEF-foot.{}",
            "foot": "DEF-toe.{}",
            "collar": "DEF-shoulder.{}",
            "shoulder": "DEF-upper_arm.{}",
            "elbow": "DEF-forearm.{}",
            "wrist": "DEF-hand.{}",
        },
        ("L", "R"),
    ),
    Family(
        "Mesh2Motion",
        {
            "pelvis": "pelvis",
            "spine1": "spine_01",
            "spine2": "spine_02",
            "spine3": "spine_03",
            "neck": "neck_01",
            "head": "head",
        },
        {
            "hip": "thigh_{}",
            "knee": "calf_{}",
            "ankle": "foot_{}",
            "foot": "ball_{}",
            "collar": "clavicle_{}",
            "shoulder": "upperarm_{}",
            "elbow": "lowerarm_{}",
            "wrist": "hand_{}",
        },
        ("l", "r"),
    ),
    Family(
        "KayKit",
        {"pelvis": "hips", "spine1": "spine", "spine3": "chest", "head": "head"},
        {
            "hip": "upperleg.{}",
            "knee": "lowerleg.{}",
            "ankle": "foot.{}",
            "foot": "toes.{}",
            "shoulder": "upperarm.{}",
            "elbow": "lowerarm.{}",
            "wrist": "wrist.{}",
        },
        ("l", "r"),
    ),
    Family(
        "SMPL-X and this project",
        {joint: joint for joint in JOINTS if "_" not in joint},
        {joint: "{}_" + joint for joint in _SIDES},
        ("left", "right"),
    ),
    Family(
        "AMP bodies",
        {"pelvis": "pelvis", "spine3": "torso", "head": "head"},
        {
            "hip": "{}_thigh",
            "knee": "{}_shin",
            "ankle": "{}_foot",
            "shoulder": "{}_upper_arm",
            "elbow": "{}_lower_arm",
            "wrist": "{}_hand",
        },
        ("left", "right"),
    ),
    Family(
        "DeepMimic",
        {"pelvis": "root", "spine3": "chest", "head": "neck"},
        {joint: "{}_" + joint for joint in ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")},
        ("left", "right"),
    ),
)


def find_map(names: Iterable[str]) -> tuple[str, JointMap]:
    """The family whose names a skeleton has, the fullest first, and its map; a prefix such as `mixamorig:` is ignored.

    ClipError lists what is missing.
    """
    plain = {_plain(name): name for name in reversed(list(names))}
    found = [(name, joints) for name, joints in _tables() if set(joints.values()) <= plain.keys()]
    if found:
        family, joints = max(found, key=lambda pair: len(pair[1]))
        return family, {ours: plain[theirs] for ours, theirs in joints.items()}
    nearest, joints = min(_tables(), key=lambda pair: len(set(pair[1].values()) - plain.keys()))
    lost = [theirs for theirs in joints.values() if theirs not in plain]
    raise ClipError(
        f"no table of joint names fits; nearest is {nearest}, which also has {_listed(lost)}",
        'give your own with --map: a JSON object such as {"pelvis": "Hips", "left_hip": "LeftUpLeg", …}',
    )


def joint_places(names: Sequence[str], given: JointMap | None = None) -> dict[str, int] | None:
    """Our joints to their places among a skeleton's, by the map given, else that of a family; None if neither fits."""
    try:
        known = checked_map(given or {}, names)
    except ClipError:
        try:
            known = find_map(names)[1]
        except ClipError:
            return None
    return {ours: names.index(theirs) for ours, theirs in known.items()}


def read_map(path: Path) -> JointMap:
    """A user's own map from JSON: our joint names to the source's. ClipError names what is wrong."""
    try:
        if path.stat().st_size > _MAX_MAP_BYTES:
            raise ClipError(f"{path.name}: a joint map is a small JSON object")
        read = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ClipError(f"{path.name}: not a JSON joint map: {error}") from error
    if not isinstance(read, dict) or not all(isinstance(theirs, str) for theirs in read.values()):
        raise ClipError(f'{path.name}: a joint map is one object of names, such as {{"pelvis": "Hips"}}')
    unknown = [ours for ours in read if ours not in JOINTS]
    if unknown:
        raise ClipError(f"{path.name}: {_listed(unknown)} not among our joints: {', '.join(JOINTS)}")
    return read


def checked_map(given: JointMap, names: Iterable[str]) -> JointMap:
    """The map in our joints' order, if it is enough to tell a body and the skeleton has what it names."""
    lost = [joint for joint in REQUIRED_JOINTS if joint not in given]
    lost += [some[0] for some in _ONE_OF if not given.keys() & set(some)]
    if lost:
        raise ClipError(f"the joint map lacks {_listed(lost)}")
    strange = [theirs for theirs in given.values() if theirs not in set(names)]
    if strange:
        raise ClipError(f"the joint map names {_listed(strange)}, which the clip has not: {_listed(names)}")
    twice = sorted({theirs for theirs in given.values() if list(given.values()).count(theirs) > 1})
    if twice:
        raise ClipError(f"the joint map gives {_listed(twice)} to more than one joint")
    return {joint: given[joint] for joint in JOINTS if joint in given}


@cache
def _tables() -> tuple[tuple[str, JointMap], ...]:
    return tuple((family.name, family.joints()) for family in FAMILIES)


def _plain(name: str) -> str:
    return re.sub(r"^.*[:|]", "", name.strip())


def _listed(names: Iterable[str]) -> str:
    shown = list(names)
    return ", ".join(repr(name)[:40] for name in shown[:12]) + (
        f" and {len(shown) - 12} more" if len(shown) > 12 else ""
    )
