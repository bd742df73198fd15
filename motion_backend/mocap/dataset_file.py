"""A collection of clips on our body in one file: arrays of all frames, and a manifest of what each clip is.

An .npz without pickle. Rotations are stored as 16-bit integers: a joint's angle is right to 0.006 degrees, its
position to 0.1 mm. The same clips give the same bytes.
"""

from __future__ import annotations

import json
import lzma
import tokenize
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.formats.npz import archive
from motion_backend.mocap.clip import MAX_COORDINATE, ClipError
from motion_backend.mocap.clip import MAX_FRAMES as MAX_CLIP_SECONDS
from motion_backend.motion import FPS, Motion
from motion_backend.skeleton import JOINTS, PARENTS, Skeleton

VERSION = 1
MAX_FRAMES, MAX_CLIPS, MAX_MANIFEST_BYTES = 5_000_000, 100_000, 64 << 20
"""What is read at most: 5 million frames are 46 hours."""
_DAMAGED = (
    OSError, EOFError, ValueError, TypeError, KeyError, AttributeError, RuntimeError, SyntaxError,
    tokenize.TokenError, zipfile.BadZipFile, zlib.error, lzma.LZMAError,
)  # fmt: skip
"""What zipfile, numpy's reader of headings and json raise for bytes that they did not write."""
_UNIT = 32767.0
_FRAMES = {"root_positions": (np.float32, (3,)), "local_rotations": (np.int16, (22, 4)), "touching": (np.uint8, ())}


@dataclass(frozen=True)
class Entry:
    """One clip and what it is."""

    name: str
    skill: str
    style: str
    emotion: str
    """One of nine."""
    captions: tuple[str, ...]
    subject: str
    kind: str
    licence: str
    source: str
    changed: tuple[str, ...]
    """What was made of the recorded clip: mirrored, reversed, speed 0.85."""
    split: str
    """train or test; everything of one subject is on one side."""
    motion: Motion
    hands: NDArray[np.bool_]
    """(T, 2) whether left and right hand rest on something."""


@dataclass(frozen=True)
class Dataset:
    """Clips on one skeleton."""

    skeleton: Skeleton
    entries: tuple[Entry, ...]

    @property
    def frames(self) -> int:
        """Of all clips."""
        return sum(len(entry.motion) for entry in self.entries)

    def named(self, name: str) -> Entry:
        """The clip of that name. ClipError if there is none."""
        found = next((entry for entry in self.entries if entry.name == name), None)
        if found is None:
            raise ClipError(f"no clip is named {name!r:.80}", "`sims clips list` shows the names")
        return found

    def of_every_skill(self) -> list[Entry]:
        """The longest clip of each skill, a recorded one where there is one."""
        best: dict[str, Entry] = {}
        for entry in self.entries:
            known = best.get(entry.skill)
            if known is None or _worth_showing(entry) > _worth_showing(known):
                best[entry.skill] = entry
        return list(best.values())


def _worth_showing(entry: Entry) -> tuple[bool, int]:
    return not entry.changed, len(entry.motion)


def dataset_bytes(dataset: Dataset) -> bytes:
    """The whole file."""
    if not dataset.entries:
        raise ClipError("there is no clip to keep")
    motions = [entry.motion for entry in dataset.entries]
    manifest = {
        "version": VERSION,
        "fps": FPS,
        "joints": list(JOINTS),
        "offsets": dataset.skeleton.offsets.tolist(),
        "clips": [_row(entry) for entry in dataset.entries],
    }
    # Names of files need not be UTF-8; what such a letter is replaced by is an escape of JSON.
    told = json.dumps(manifest, ensure_ascii=False, sort_keys=True)
    turns = np.concatenate([rotations.normalize(motion.local_rotations.astype(np.float64)) for motion in motions])
    arrays: dict[str, NDArray[Any]] = {
        "manifest": np.frombuffer(told.encode(errors="backslashreplace"), dtype=np.uint8),
        "starts": np.cumsum([0, *(len(motion) for motion in motions)], dtype=np.int64),
        "root_positions": np.concatenate([motion.root_positions for motion in motions]).astype(np.float32),
        "local_rotations": np.round(turns * _UNIT).astype(np.int16),
        "touching": np.concatenate([_packed(entry) for entry in dataset.entries]),
    }
    return archive(arrays, level=6)


def is_dataset(path: Path) -> bool:
    """Whether a file is a collection, whole or damaged, of this version or another."""
    try:
        with zipfile.ZipFile(path) as archive:
            return {f"{name}.npy" for name in ("manifest", "starts", *_FRAMES)} <= set(archive.namelist())
    except _DAMAGED:
        return False


def read_dataset(path: Path) -> Dataset:
    """The clips that `dataset_bytes` kept. ClipError says what is wrong with a file."""
    try:
        with zipfile.ZipFile(path) as archive:
            return _unpacked({name: _array(archive, name) for name in ("manifest", "starts", *_FRAMES)})
    except _DAMAGED as error:
        why = f"lacks {error}" if isinstance(error, KeyError) else error
        raise ClipError(f"{path.name}: not a collection of clips that this version reads: {why}") from error


def _array(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """One array, read only if its heading agrees with its size and the size is one we would write."""
    info = archive.getinfo(name + ".npy")
    with archive.open(info) as file:
        version = np.lib.format.read_magic(file)
        if version != (1, 0):
            raise ValueError(f"{name} is of npy version {version}")
        shape, fortran, dtype = np.lib.format.read_array_header_1_0(file)
        size = int(np.prod(shape, dtype=object)) * dtype.itemsize
        heading = file.tell()
    most = {"manifest": MAX_MANIFEST_BYTES, "starts": 8 * (MAX_CLIPS + 1)}.get(name, MAX_FRAMES * 176)
    if dtype.hasobject or fortran or heading + size != info.file_size or size > most:
        raise ValueError(f"{name} has a size it cannot have")
    with archive.open(info) as file:
        return np.asarray(np.lib.format.read_array(file, allow_pickle=False))


def _unpacked(arrays: dict[str, NDArray[Any]]) -> Dataset:
    manifest = json.loads(arrays["manifest"].tobytes())
    if manifest["version"] != VERSION or manifest["joints"] != list(JOINTS) or manifest["fps"] != FPS:
        raise ValueError(f"it is of version {manifest['version']!r:.20}, not {VERSION}")
    starts, rows = arrays["starts"], manifest["clips"]
    frames = len(arrays["root_positions"])
    if starts.dtype != np.int64 or starts.shape != (len(rows) + 1,) or len(rows) < 1:
        raise ValueError("it does not say where each clip starts")
    lengths = np.diff(starts)
    if starts[0] != 0 or starts[-1] != frames or not ((lengths >= 1) & (lengths <= MAX_CLIP_SECONDS)).all():
        raise ValueError("its clips do not add up to its frames, or one is too long")
    for name, (dtype, shape) in _FRAMES.items():
        if arrays[name].dtype != dtype or arrays[name].shape != (frames, *shape):
            raise ValueError(f"{name} must be {np.dtype(dtype)} of shape ({frames}, …), is {arrays[name].shape}")
    if not (np.abs(arrays["root_positions"]) <= MAX_COORDINATE).all():
        raise ValueError("a root position is not a number, or far away")
    if not arrays["local_rotations"].any(axis=-1).all():
        raise ValueError("a rotation is nought")
    offsets = np.array(manifest["offsets"], dtype=np.float64).reshape(len(JOINTS), 3)
    if not (np.abs(offsets) <= MAX_COORDINATE).all():
        raise ValueError("a joint's offset is not a number, or far away")
    skeleton = Skeleton(JOINTS, PARENTS, offsets)
    bounds = zip(rows, starts[:-1], starts[1:], strict=True)
    return Dataset(skeleton, tuple(_entry(row, arrays, slice(int(a), int(b)), skeleton) for row, a, b in bounds))


def _row(entry: Entry) -> dict[str, Any]:
    told = {name: value for name, value in vars(entry).items() if name not in ("motion", "hands")}
    return json.loads(json.dumps(told))  # type: ignore[no-any-return]


def _packed(entry: Entry) -> NDArray[np.uint8]:
    """Six flags a frame as bits: the four contacts of the feet, then the hands."""
    flags = np.concatenate([entry.motion.contacts > 0.5, entry.hands], axis=1)
    return np.packbits(flags, axis=1, bitorder="little")[:, 0]


def _entry(row: dict[str, Any], arrays: dict[str, NDArray[Any]], part: slice, skeleton: Skeleton) -> Entry:
    flags = np.unpackbits(arrays["touching"][part, None], axis=1, bitorder="little", count=6)
    turns = rotations.normalize(arrays["local_rotations"][part].astype(np.float64) / _UNIT)
    motion = Motion(
        root_positions=arrays["root_positions"][part],
        local_rotations=turns.astype(np.float32),
        contacts=flags[:, :4].astype(np.float32),
        skeleton=skeleton,
        actions=np.zeros(len(turns), dtype=np.int32),
        fps=FPS,
    )
    if not row["captions"] or not all(isinstance(row[name], list) for name in ("captions", "changed")):
        raise ValueError("a clip needs a list of captions, and one of what was changed")
    lists = {name: tuple(str(one) for one in row[name]) for name in ("captions", "changed")}
    words = ("name", "skill", "style", "emotion", "subject", "kind", "licence", "source", "split")
    return Entry(**{name: str(row[name]) for name in words}, **lists, motion=motion, hands=flags[:, 4:] > 0)  # type: ignore[arg-type]
