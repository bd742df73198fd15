"""Acclaim: a skeleton (.asf) and its motion (.amc), as CMU and VICON write them.

A bone turns about its near end, so the joint that carries its name stands there; each bone's angles are read in its
own `axis` frame and in the order of its `dof` line. Y up, facing +Z. Lengths: inches divided by the skeleton's
`length`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.mocap.clip import MAX_JOINTS, MAX_TURNS, Clip, ClipError, make_bones, make_clip
from motion_backend.mocap.joint_map import JointMap
from motion_backend.mocap.readers.bvh_reader import euler_to_quat
from motion_backend.mocap.rest_pose import t_posed
from motion_backend.rotations import Array

INCH: Final = 0.0254
RATE: Final = 120.0
"""Frames a second of CMU's captures; the format does not say."""
_MAX_MOTION_LENGTH: Final = 20 << 20
"""Characters of a motion: some twenty times that in words."""
_ROOT: Final = "root"
_TURNS: Final = {"rx": 0, "ry": 1, "rz": 2}
_MOVES: Final = {"tx": 0, "ty": 1, "tz": 2}


@dataclass(frozen=True)
class Bone:
    """One bone as the skeleton file has it; lengths in file units."""

    name: str
    vector: Array
    """(3,) from its near to its far end, in the world's axes."""
    frame: Array
    """(4,) of the axes in which its angles are read."""
    dof: tuple[str, ...]


@dataclass(frozen=True)
class Acclaim:
    """A skeleton file."""

    bones: tuple[Bone, ...]
    """The root first."""
    parents: tuple[int, ...]
    unit: float
    """Metres a unit."""
    angle: float
    """Radians a unit of angle."""


def read_acclaim_clip(motion: str, skeleton: str, name: str, joints: JointMap | None = None) -> Clip:
    """The clip of a motion text on the body of a skeleton text. ClipError says what is wrong with either."""
    asf = parse_asf(skeleton)
    offsets = [np.zeros(3) if above < 0 else asf.bones[above].vector for above in asf.parents]
    bones, order = make_bones([bone.name for bone in asf.bones], asf.parents, np.array(offsets) * asf.unit)
    columns, angle = _parse_amc(motion, asf)
    frames = len(next(iter(columns.values())))
    turns = np.tile(rotations.IDENTITY, (frames, len(order), 1))
    roots = np.zeros((frames, 3))
    for place, old in enumerate(order):
        bone = asf.bones[old]
        values = columns.get(bone.name)
        if values is None:
            continue
        turning = [(column, _TURNS[kind]) for column, kind in enumerate(bone.dof) if kind in _TURNS]
        angles = values[:, [column for column, _ in turning]] * angle
        # Acclaim lists the angle that is applied first first.
        turn = euler_to_quat(angles[:, ::-1], tuple(axis for _, axis in reversed(turning)))
        turns[:, place] = rotations.compose(rotations.compose(bone.frame, turn), rotations.inverse(bone.frame))
        for column, kind in enumerate(bone.dof):
            if place == 0 and kind in _MOVES:
                roots[:, _MOVES[kind]] = values[:, column] * asf.unit
    notes = (
        f"lengths taken as inches / {INCH / asf.unit:.4g} (x {asf.unit:.6g})",
        f"{RATE:g} frames a second, as CMU captures: the format does not say",
    )
    tpose = t_posed(bones, np.tile(rotations.IDENTITY, (len(order), 1)), joints)
    return make_clip(name, bones, roots, turns, tpose, RATE, "acclaim", notes)


def parse_asf(text: str) -> Acclaim:
    """The skeleton. ClipError says what is wrong with it."""
    sections = _sections(text)
    units = dict(line.split(None, 1) for line in sections.get("units", []) if len(line.split()) > 1)
    angle = 1.0 if units.get("angle", "deg").startswith("rad") else np.pi / 180
    length = _number(units.get("length", "1"), ":units length")
    if not length > 0:
        raise ClipError(f":units length must be above zero, got {length:g}")
    bones = [_bone(block, angle) for block in _blocks(sections.get("bonedata", []), ":bonedata")]
    if not 0 < len(bones) < MAX_JOINTS:
        raise ClipError(f"an .asf skeleton has 1 to {MAX_JOINTS - 1} bones in its :bonedata, this has {len(bones)}")
    bones.insert(0, _root_bone(sections.get("root", []), angle))
    places = {bone.name: place for place, bone in enumerate(bones)}
    if len(places) < len(bones):
        raise ClipError(":bonedata gives two bones one name")
    parents: dict[int, int] = {0: -1}
    for block in _blocks(sections.get("hierarchy", []), ":hierarchy"):
        for above, *below in (line.split() for line in block):
            for child in below:
                if above not in places or child not in places:
                    raise ClipError(f":hierarchy names {child if above in places else above!r}, which is no bone")
                if places[child] in parents:
                    raise ClipError(f":hierarchy gives {child!r} two parents")
                parents[places[child]] = places[above]
    lost = [bone.name for place, bone in enumerate(bones) if place not in parents]
    if lost:
        raise ClipError(f":hierarchy does not say what {lost[0]!r} hangs on")
    return Acclaim(tuple(bones), tuple(parents[place] for place in range(len(bones))), INCH / length, angle)


def _parse_amc(text: str, asf: Acclaim) -> tuple[dict[str, Array], float]:
    """Each moving bone's numbers (T, dof), and radians a unit of angle. Every frame lists the same bones in order."""
    first = re.search(r"^\s*1\s*$", text, re.MULTILINE)
    if first is None:
        raise ClipError("an .amc motion has its frames numbered from 1")
    heads = text[: first.start()].lower().split()
    angle = np.pi / 180 if ":degrees" in heads else 1.0 if ":radians" in heads else asf.angle
    if len(text) > _MAX_MOTION_LENGTH:
        raise ClipError(f"it has more than {_MAX_MOTION_LENGTH >> 20} MB of text", "cut it into shorter files")
    words = text[first.start() :].split()
    bones = {bone.name: bone for bone in asf.bones}
    spans, place = [], 1
    while place < len(words) and words[place] in bones:
        name = words[place]
        spans.append((name, place))
        place += 1 + len(bones[name].dof)
    if not spans:
        raise ClipError(f"an .amc frame lists bones of its skeleton; {(words[1:2] or ['nothing'])[0][:40]!r} is none")
    if len(words) % place:
        raise ClipError(f"frames of {place} words do not fill the {len(words)} there are", "is the file cut off?")
    if len(words) // place * len(bones) > MAX_TURNS:
        raise ClipError(f"{len(words) // place} frames of {len(bones)} bones are too many", "cut the file")
    if words[::place] != [str(number + 1) for number in range(len(words) // place)]:
        raise ClipError("the frames are not numbered one after the other, or do not list the same bones")
    found = {}
    for name, start in spans:
        if set(words[start::place]) != {name}:
            raise ClipError(f"every frame must list the same bones; {name!r} is missing in some")
        columns = [_numbers(words[start + 1 + index :: place], name) for index in range(len(bones[name].dof))]
        found[name] = np.stack(columns, axis=1) if columns else np.zeros((len(words) // place, 0))
    return found, angle


def _sections(text: str) -> dict[str, list[str]]:
    """Lines by the `:keyword` they stand under; what stands behind a keyword is its first line."""
    sections: dict[str, list[str]] = {}
    lines: list[str] = []
    for line in text.splitlines():
        line = line.strip()
        if line.startswith(":"):
            keyword, _, rest = line[1:].partition(" ")
            lines = sections.setdefault(keyword.lower(), [])
            line = rest
        if line and not line.startswith("#"):
            lines.append(line)
    return sections


def _blocks(lines: list[str], where: str) -> list[list[str]]:
    """What stands between each begin and end."""
    blocks: list[list[str]] = []
    inside = False
    for line in lines:
        if line == "begin" and not inside:
            blocks.append([])
        elif line == "end" and inside:
            pass
        elif inside:
            blocks[-1].append(line)
            continue
        else:
            raise ClipError(f"{where} holds {line[:40]!r} outside of begin and end")
        inside = not inside
    if inside:
        raise ClipError(f"{where} does not end", "is the file cut off?")
    return blocks


def _bone(lines: list[str], angle: float) -> Bone:
    words = {line.split()[0]: line.split()[1:] for line in lines if not line.startswith("(")}
    name = " ".join(words.get("name", []))
    if not name or len(words.get("direction", [])) != 3 or len(words.get("length", [])) != 1:
        raise ClipError(f"bone {name!r} must have a name, a direction of 3 numbers and a length")
    direction = _numbers(words["direction"], name)
    dof = tuple(word.lower() for word in words.get("dof", []) if word.lower() != "l")
    if not set(dof) <= _TURNS.keys() | _MOVES.keys() or len(set(dof)) < len(dof):
        raise ClipError(f"bone {name!r}: dof must be of {', '.join([*_TURNS, *_MOVES])}, each once")
    vector = rotations.normalize(direction) * _number(words["length"][0], f"length of {name}")
    return Bone(name, vector, _frame(words.get("axis", ["0", "0", "0", "XYZ"]), angle, name), dof)


def _root_bone(lines: list[str], angle: float) -> Bone:
    words = {line.split()[0].lower(): line.split()[1:] for line in lines}
    order = tuple(word.lower() for word in words.get("order", ["TX", "TY", "TZ", "RX", "RY", "RZ"]))
    if not set(order) <= _TURNS.keys() | _MOVES.keys() or len(set(order)) < len(order):
        raise ClipError(":root order must be of TX, TY, TZ, RX, RY, RZ, each once")
    axis = (words.get("axis") or ["XYZ"])[-1]
    return Bone(_ROOT, np.zeros(3), _frame([*words.get("orientation", ["0", "0", "0"]), axis], angle, _ROOT), order)


def _frame(words: list[str], angle: float, name: str) -> Array:
    """The rotation of `axis a b c XYZ`: the axis named first is applied first."""
    if len(words) != 4 or sorted(words[3].upper()) != ["X", "Y", "Z"]:
        raise ClipError(f"axis of {name} must be three angles and an order such as XYZ, got {' '.join(words)[:40]!r}")
    axes = tuple("XYZ".index(letter) for letter in words[3].upper())
    angles = _numbers(words[:3], f"axis of {name}") * angle
    return euler_to_quat(angles[::-1], axes[::-1])


def _numbers(words: list[str], what: str) -> Array:
    try:
        return np.array([float(word) for word in words])
    except ValueError as error:
        raise ClipError(f"{what} must have numbers: {error}") from error


def _number(word: str, what: str) -> float:
    return float(_numbers([word], what)[0])
