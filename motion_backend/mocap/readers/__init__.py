"""Motion files of every format we know, read into clips."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.formats.npz import read_npz
from motion_backend.mocap.clip import Clip, ClipError, make_bones, make_clip
from motion_backend.mocap.joint_map import JointMap
from motion_backend.mocap.readers.acclaim import read_acclaim_clip
from motion_backend.mocap.readers.bvh_reader import read_bvh_clip
from motion_backend.mocap.readers.deepmimic import read_amp_clip, read_deepmimic_clip
from motion_backend.mocap.readers.expmap import read_expmap_clip
from motion_backend.mocap.readers.glb_reader import read_glb_clips
from motion_backend.mocap.readers.safe_numpy import npz_arrays, npz_names
from motion_backend.mocap.readers.smplx import is_kimodo, is_smplx, read_kimodo_clip, read_smplx_clip
from motion_backend.motion import Motion
from scene_graphs.json_fields import LayoutError

MAX_FILE_BYTES: Final = 256 << 20
"""Bytes."""
MAX_TEXT_BYTES: Final = 40 << 20
"""Bytes of a file of text, such as seven minutes of BVH at 120 Hz: it takes eight times that to read."""
FORMATS: Final = {
    "bvh": "BVH: .bvh, any channel order, axes and unit",
    "acclaim": "Acclaim: .amc, with its skeleton .asf beside it",
    "deepmimic": "DeepMimic: JSON text, .txt or .json",
    "amp": "AMP skeleton motion: .npy with one dictionary",
    "glb": "glTF: .glb or .gltf with its data inside, one clip an animation",
    "smplx": "AMASS and SMPL-X: .npz with poses and trans",
    "kimodo": "Kimodo: .npz with posed_joints and global_rot_mats",
    "expmap": "CMU trials as exponential maps: .txt, 117 numbers a row",
    "sims": "our own motion: .npz as `sims` writes it",
}
"""What can be read, in words."""
_BY_SUFFIX: Final = {".bvh": "bvh", ".amc": "acclaim", ".npy": "amp", ".glb": "glb", ".gltf": "glb"}


class MotionFile(NamedTuple):
    """A file that is being read."""

    path: Path
    data: bytes
    skeleton_file: Path | None
    joints: JointMap | None

    @property
    def name(self) -> str:
        """The clip's name: that of the file."""
        return self.path.stem

    def text(self) -> str:
        """The content as text. ClipError if it is none, or too long."""
        if len(self.data) > MAX_TEXT_BYTES:
            raise ClipError(f"it has more than {MAX_TEXT_BYTES >> 20} MB of text", "cut it into shorter files")
        return _text(self.data, "the file")


def read_clips(
    path: Path | str,
    *,
    format: str | None = None,  # noqa: A002
    skeleton_file: Path | str | None = None,
    joints: JointMap | None = None,
) -> tuple[Clip, ...]:
    """The clips in a file, one as a rule, one an animation of a glTF.

    The format is told by suffix and content unless it is given (a key of `FORMATS`). Acclaim needs a skeleton (.asf),
    exponential maps take one (.bvh): the one given, else an .asf in the same folder. `joints`, our names to
    the file's, tells a skeleton whose names are of no family its unit, axes and T-pose. ClipError names the file and
    says what is wrong.
    """
    path = Path(path)
    if format is not None and format not in FORMATS:
        raise ClipError(f"format must be one of {', '.join(FORMATS)}, got {format!r}")
    file = MotionFile(path, _content(path), None if skeleton_file is None else Path(skeleton_file), joints)
    try:
        # Numbers beyond all bounds are refused when a clip is made, whatever they came to on the way there.
        with np.errstate(all="ignore"):
            return _READERS[format or _format_of(file)](file)
    except (ClipError, LayoutError) as error:
        raise ClipError(f"{path.name}: {error.within}") from error


def clip_of_motion(motion: Motion, name: str) -> Clip:
    """One of our own motions as a clip."""
    skeleton = motion.skeleton
    bones, order = make_bones(skeleton.names, skeleton.parents, skeleton.offsets)
    tpose = np.tile(rotations.IDENTITY, (len(order), 1))
    turns = np.asarray(motion.local_rotations, dtype=np.float64)[:, order]
    return make_clip(name, bones, motion.root_positions, turns, tpose, motion.fps, "sims")


def _content(path: Path) -> bytes:
    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise ClipError(f"{path.name} is larger than {MAX_FILE_BYTES >> 20} MB", "cut it into shorter files")
        return path.read_bytes()
    except OSError as error:
        raise ClipError(f"{path} cannot be read: {error.strerror or error}") from error


def _text(data: bytes, what: str) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ClipError(f"{what} is not text (at byte {error.start})") from error


def _format_of(file: MotionFile) -> str:
    suffix = file.path.suffix.lower()
    if suffix in _BY_SUFFIX:
        return _BY_SUFFIX[suffix]
    if suffix == ".npz":
        names = dict.fromkeys(npz_names(file.data))
        known = {"kimodo": is_kimodo(names), "smplx": is_smplx(names), "sims": "local_rotations" in names}
        found = next((name for name, fits in known.items() if fits), None)
        if found is None:
            raise ClipError(f"no motion we know is an archive of {', '.join(names) or 'nothing'}")
        return found
    if suffix == ".asf":
        raise ClipError("a skeleton without motion", "read the .amc that goes with it")
    if suffix in (".txt", ".json"):
        start = file.data[:400].removeprefix(b"\xef\xbb\xbf").lstrip()
        if start.startswith(b"{"):
            return "deepmimic"
        if start.count(b",") >= 10:
            return "expmap"
    raise ClipError("no motion we know looks like this", f"there are {', '.join(FORMATS)} (give one as the format)")


def _asf_of(file: MotionFile) -> Path:
    """The skeleton that was given, or that of the same subject, or the only one in the folder."""
    if file.skeleton_file is not None:
        return file.skeleton_file
    beside = sorted(file.path.parent.glob("*.asf"))
    own = [other for other in beside if file.name.startswith(other.stem)]
    if not own and len(beside) != 1:
        raise ClipError("an .amc motion needs its skeleton: put the .asf beside it or name it")
    return max(own or beside, key=lambda other: len(other.stem))


def _bvh(file: MotionFile) -> tuple[Clip, ...]:
    return (read_bvh_clip(file.text(), file.name, file.joints),)


def _acclaim(file: MotionFile) -> tuple[Clip, ...]:
    path = _asf_of(file)
    clip = read_acclaim_clip(file.text(), _text(_content(path), path.name), file.name, file.joints)
    if file.name.startswith(path.stem):
        return (clip,)
    return (replace(clip, notes=(*clip.notes, f"on the skeleton {path.name}, whose name is of another subject")),)


def _deepmimic(file: MotionFile) -> tuple[Clip, ...]:
    return (read_deepmimic_clip(file.text(), file.name),)


def _amp(file: MotionFile) -> tuple[Clip, ...]:
    return (read_amp_clip(file.data, file.name, file.joints),)


def _glb(file: MotionFile) -> tuple[Clip, ...]:
    return read_glb_clips(file.data, file.path.name, file.joints)


def _smplx(file: MotionFile) -> tuple[Clip, ...]:
    return (read_smplx_clip(npz_arrays(file.data), file.name),)


def _kimodo(file: MotionFile) -> tuple[Clip, ...]:
    return (read_kimodo_clip(npz_arrays(file.data), file.name),)


def _expmap(file: MotionFile) -> tuple[Clip, ...]:
    path = file.skeleton_file
    skeleton = None if path is None else _text(_content(path), path.name)
    return (read_expmap_clip(file.text(), skeleton, file.name),)


def _sims(file: MotionFile) -> tuple[Clip, ...]:
    npz_arrays(file.data)  # refuses what claims more than it holds
    try:
        return (clip_of_motion(read_npz(io.BytesIO(file.data)), file.name),)
    except (ValueError, KeyError, TypeError, IndexError, AttributeError) as error:
        raise ClipError(f"not one of our motions: {error}") from error


_READERS: Final[dict[str, Callable[[MotionFile], tuple[Clip, ...]]]] = {
    "bvh": _bvh,
    "acclaim": _acclaim,
    "deepmimic": _deepmimic,
    "amp": _amp,
    "glb": _glb,
    "smplx": _smplx,
    "kimodo": _kimodo,
    "expmap": _expmap,
    "sims": _sims,
}
