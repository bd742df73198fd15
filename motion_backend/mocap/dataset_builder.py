"""From a folder of motion files to a collection: read, retarget, label, split by subject, then augment."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from motion_backend.datasets.splits import splits
from motion_backend.mocap.augmentation import BACKWARDS, change_speed, mirror, mirror_words, reverse, sped_times
from motion_backend.mocap.clip import Clip, ClipError
from motion_backend.mocap.clip_captions import (
    NO_MOTION,
    TABLE,
    Label,
    Labels,
    emotion_of,
    labels_of,
    read_labels,
    ways_to_say,
)
from motion_backend.mocap.dataset_file import Dataset, Entry
from motion_backend.mocap.fidelity_report import Fidelity
from motion_backend.mocap.joint_map import JointMap
from motion_backend.mocap.near_duplicates import Copy, joined_subjects
from motion_backend.mocap.readers import read_clips
from motion_backend.mocap.retarget import retarget
from motion_backend.skeleton import Skeleton

SUFFIXES = (".amc", ".bvh", ".glb", ".gltf", ".json", ".npy", ".npz", ".txt")
MAX_FILES = 20_000


@dataclass(frozen=True)
class Kept:
    """A clip that was read: the entry, and how true it is to its source."""

    entry: Entry
    report: Fidelity


@dataclass(frozen=True)
class Unread:
    """A file or clip that could not be used, and why."""

    name: str
    why: str


def folder_labels(folder: Path, given: Path | None = None) -> Labels:
    """The rows of the table that was given, else of the folder's own, else none."""
    table = given or folder / TABLE
    return read_labels(table) if given or table.is_file() else {}


def motion_files(folder: Path, labels: Labels, but: Collection[Path] = ()) -> list[str]:
    """Files of a folder and below that may hold motion, as paths from it, in order; a table says which, if it is there.

    Hidden files and folders are left out, and those in `but`. ClipError if there is none.
    """
    if not folder.is_dir():
        raise ClipError(f"{folder} is no folder")
    barren = {file for (file, _), rows in labels.items() if any(row.kind in NO_MOTION for row in rows)}
    listed = {file for file, _ in labels}
    left_out = {path.resolve() for path in but}
    there = sorted(
        path for path in folder.rglob("*") if _may_be_motion(path, folder) and path.resolve() not in left_out
    )
    names = [path.relative_to(folder).as_posix() for path in there]
    found = [name for name in names if name in listed and name not in barren] if listed else names
    if names and not found:
        raise ClipError(f"{folder} holds none of the motion files that the table of clips names")
    if not found:
        raise ClipError(f"{folder} holds no motion file ({', '.join(SUFFIXES)})")
    if len(found) > MAX_FILES:
        raise ClipError(f"{folder} holds {len(found)} files, more than {MAX_FILES}: build it in parts")
    return found


def _may_be_motion(path: Path, folder: Path) -> bool:
    hidden = any(part.startswith(".") for part in path.relative_to(folder).parts)
    return path.suffix.lower() in SUFFIXES and not hidden and _is_file(path)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:
        return False


def read_folder(
    folder: Path,
    labels: Labels,
    joints: JointMap | None = None,
    skeleton: Skeleton | None = None,
    but: Collection[Path] = (),
) -> Iterator[Kept | Unread]:
    """Every clip of a folder but some files on our body, one at a time, or why not; names are given once."""
    files, given = motion_files(folder, labels, but), Counter[str]()
    for file in sorted({file for (file, _), rows in labels.items() if rows[0].kind not in NO_MOTION}):
        if not _is_file(folder / file):
            yield Unread(file, "the table of clips names it, but there is no such file")
    for file in files:
        try:
            clips = read_clips(folder / file, joints=joints)
        except ClipError as error:
            yield Unread(file, str(error))
            continue
        for clip in clips:
            name = file if len(clips) == 1 else f"{file}#{clip.name}"
            given[name] += 1
            name += f" ({given[name]})" if given[name] > 1 else ""
            for label in labels_of(labels, file, clip.name):
                part = f"{name}@{label.start:g}-{label.stop or clip.duration:.6g}" if label.segment else name
                try:
                    yield _kept(_cut(clip, label), label, part, file, joints, skeleton)
                except ClipError as error:
                    yield Unread(part, str(error))


def _cut(clip: Clip, label: Label) -> Clip:
    """The segment that a row names; one that stops later than its clip ends with it."""
    if not label.segment:
        return clip
    start = round(label.start * clip.fps)
    stop = len(clip) if label.stop is None else min(round(label.stop * clip.fps), len(clip))
    if stop - start < 2:
        raise ClipError(f"{clip.name} lasts {clip.duration:.1f} s: nothing of it lies from {label.start:g} s on")
    return clip.part(start, stop)


def _kept(clip: Clip, label: Label, name: str, file: str, joints: JointMap | None, skeleton: Skeleton | None) -> Kept:
    found = retarget(clip, skeleton, joints)
    entry = Entry(
        name=name,
        skill=label.skill,
        style=label.style,
        emotion=emotion_of(label.style, f"{label.caption} {clip.name}"),
        captions=ways_to_say(label.skill, label.style, label.caption),
        subject=label.subject,
        kind=label.kind,
        licence=label.licence,
        source=label.source or file,
        changed=(),
        split="train",
        motion=found.motion,
        hands=found.hands,
    )
    return Kept(entry, replace(found.report, name=name))


def collect(
    entries: Sequence[Entry],
    mirrored: bool = False,
    reversed_too: bool = False,
    speeds: Sequence[float] = (),
    copies: Sequence[Copy] = (),
) -> Dataset:
    """The collection: subjects are dealt to train and test first, then clips are multiplied. ClipError if empty.

    Subjects with `copies` of each other's clips are dealt as one.
    """
    if not entries:
        raise ClipError("no clip was accepted", "the report says why")
    group = joined_subjects([entry.subject for entry in entries], copies)
    sides = splits([(group[entry.subject], len(entry.motion)) for entry in entries])
    kept = [replace(entry, split=sides[group[entry.subject]]) for entry in entries]
    if reversed_too:
        kept += [_reversed(entry) for entry in kept if entry.skill in BACKWARDS]
    kept += [_at_speed(entry, speed) for speed in speeds for entry in list(kept) if not _sped(entry)]
    if mirrored:
        kept += [_mirrored(entry) for entry in kept]
    return Dataset(entries[0].motion.skeleton, tuple(kept))


def _mirrored(entry: Entry) -> Entry:
    return replace(
        entry,
        name=f"{entry.name} mirrored",
        captions=tuple(mirror_words(caption) for caption in entry.captions),
        style=mirror_words(entry.style),
        changed=(*entry.changed, "mirrored"),
        motion=mirror(entry.motion),
        hands=entry.hands[:, ::-1].copy(),
    )


def _reversed(entry: Entry) -> Entry:
    skill = BACKWARDS[entry.skill]
    return replace(
        entry,
        name=f"{entry.name} reversed",
        skill=skill,
        captions=ways_to_say(skill, entry.style, ""),
        changed=(*entry.changed, "reversed"),
        motion=reverse(entry.motion),
        hands=entry.hands[::-1].copy(),
    )


def _sped(entry: Entry) -> bool:
    return any(word.startswith("speed") for word in entry.changed)


def _at_speed(entry: Entry, speed: float) -> Entry:
    try:
        motion = change_speed(entry.motion, speed)
    except ValueError as error:
        raise ClipError(f"--speeds: {error}") from error
    nearest = np.round(sped_times(len(entry.motion), speed)).astype(int)
    name = f"{entry.name} speed {speed:g}"
    changed = (*entry.changed, f"speed {speed:g}")
    return replace(entry, name=name, changed=changed, motion=motion, hands=entry.hands[nearest])
