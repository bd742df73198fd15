"""What the model learns from: stretches of motion with their passages, and windows of them with their conditions.

A stretch is motion without a break; its passages say what is done from when to when. Collections of clips are read as
they are (`sims clips build`: one passage a clip); what our own body acted is kept with the passages it really had.
"""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.conditions import MadeOf
from motion_backend.formats.npz import archive
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.dataset_file import Dataset, Entry, read_dataset
from motion_backend.motion import Action, Motion, PhaseKind, Skill
from motion_backend.rotations import Array

VERSION: Final = 1
KINDS: Final = {
    "real mocap": MadeOf.RECORDED, "hand-keyed": MadeOf.KEYED, "matched": MadeOf.MATCHED,
    "procedural": MadeOf.PROCEDURAL,
}  # fmt: skip
"""Kinds of clips that are learned from; what another model made is not."""
DOES: Final = {
    Skill.LOCO: PartKind.WALK, Skill.SITDOWN: PartKind.SIT, Skill.LIEDOWN: PartKind.LIE, Skill.TOUCH: PartKind.REACH,
    Skill.STANDUP: PartKind.RISE, Skill.GETUP: PartKind.RISE,
}  # fmt: skip
"""What a clip of a skill is one passage of."""
PERIODIC: Final = (PartKind.WALK, PartKind.TURN)
"""Locomotion: its frame number is zero, and its goal is where the window ends (LINGO A.3)."""
ODD: Final = re.compile(
    r"\b(?:run|jog|crawl|sneak|stealth|zombie|hop|jump|balanc|stagger|exaggerat|strid|crouch|backward|stroll sneaky)",
    re.IGNORECASE,
)
"""Walks that are not plain, by style or caption: they are left out where only walking is learned."""
PHASES: Final = {
    PhaseKind.WALK: PartKind.WALK, PhaseKind.STAND: PartKind.TURN,
    PhaseKind.SITDOWN: PartKind.SIT, PhaseKind.EDGE: PartKind.SIT, PhaseKind.LIEDOWN: PartKind.LIE,
    PhaseKind.GETUP: PartKind.RISE, PhaseKind.STANDUP: PartKind.RISE, PhaseKind.TOUCH: PartKind.REACH,
}  # fmt: skip
"""What a phase of our own body is a passage of; the edge of a bed is sat on before one lies down."""
WALKING: Final = "steadily walking forward"
NEAR: Final = 0.02
"""Metres from its nearest at which a hand has come to its goal."""
_UNIT: Final = 32767.0
_ARRAYS: Final = {"roots": (np.float32, (3,)), "local": (np.int16, (22, 4)), "contacts": (np.uint8, (4,))}


@dataclass(frozen=True)
class Passage:
    """What is done in some frames of a stretch."""

    start: int
    stop: int
    """Exclusive."""
    kind: PartKind
    caption: str
    hand: tuple[float, float, float] | None = None
    """Where the hand is to be, in the world of the stretch; None where no hand has a goal."""
    left: bool = False
    """Whether it is the left hand."""
    reached: int | None = None
    """The frame in which the hand is there."""


@dataclass(frozen=True)
class Stretch:
    """Frames at 30 a second that follow one another."""

    name: str
    person: str
    made_of: MadeOf
    roots: Array
    """(T, 3) metres."""
    local: Array
    """(T, 22, 4) xyzw."""
    contacts: Array
    """(T, 4)."""
    passages: tuple[Passage, ...]
    split: str = "train"
    room: str | None = None
    """The layout of the library that it was acted in."""
    plain: bool = True
    """Whether it is nothing odd, such as a zombie's walk."""

    def __len__(self) -> int:
        return len(self.roots)


def read_stretches(path: Path) -> list[Stretch]:
    """All stretches of a file: of `sims train act`, or a collection of clips. ClipError for anything else."""
    try:
        with np.load(path) as file:
            own = "stretches" in file.files
            if own:
                arrays = {name: _checked(file[name], name) for name in _ARRAYS}
                rows = json.loads(bytes(file["stretches"]))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise _unread(path, error) from error
    if not own:
        return stretches_of(read_dataset(path))
    bounds = np.cumsum([0, *(int(row["frames"]) for row in rows["rows"])])
    if rows["version"] != VERSION or bounds[-1] != len(arrays["roots"]):
        raise ClipError(f"{path.name} is of another version or cut off", "make it again with `sims train act`")
    return [_stretch(row, arrays, slice(*bounds[i : i + 2])) for i, row in enumerate(rows["rows"])]


def write_stretches(
    stretches: Sequence[Stretch], path: Path, sentences: Mapping[str, NDArray[np.float32]] | None = None
) -> None:
    """One .npz; the same stretches give the same bytes. `sentences`: features (384,) of what is said in them."""
    rows = [
        {"name": s.name, "person": s.person, "made_of": int(s.made_of), "frames": len(s), "split": s.split,
         "room": s.room, "plain": s.plain, "passages": [asdict(passage) for passage in s.passages]}
        for s in stretches
    ]  # fmt: skip
    manifest = json.dumps({"version": VERSION, "rows": rows}).encode()
    arrays: dict[str, NDArray[Any]] = {
        "roots": np.concatenate([s.roots for s in stretches]).astype(np.float32),
        "local": np.round(np.concatenate([s.local for s in stretches]) * _UNIT).astype(np.int16),
        "contacts": (np.concatenate([s.contacts for s in stretches]) > 0.5).astype(np.uint8),
        "stretches": np.frombuffer(manifest, np.uint8),
    }
    if sentences:
        arrays["sentences"] = np.frombuffer(json.dumps([*sentences]).encode(), np.uint8)
        arrays["features"] = np.stack([*sentences.values()]).astype(np.float32)
    path.write_bytes(archive(arrays, level=6))


def read_sentences(path: Path) -> dict[str, NDArray[np.float32]]:
    """Features (384,) of sentences that stand in a file of stretches; none where none do. ClipError."""
    try:
        with np.load(path) as file:
            if "sentences" not in file.files:
                return {}
            found = dict(zip(json.loads(bytes(file["sentences"])), file["features"], strict=True))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise _unread(path, error) from error
    return found


def _unread(path: Path, error: Exception) -> ClipError:
    return ClipError(f"{path.name} cannot be read ({error})", "give a file of `sims clips build` or `train act`")


def stretches_of(dataset: Dataset) -> list[Stretch]:
    """Clips that say what is done in them, one passage each."""
    return [_of_clip(entry) for entry in dataset.entries if entry.skill in list(DOES) and entry.kind in KINDS]


def _of_clip(entry: Entry) -> Stretch:
    motion, kind = entry.motion, DOES[Skill(entry.skill)]
    frames = len(motion)
    hand, left, reached = _touched(motion, entry.hands) if kind is PartKind.REACH else (None, False, None)
    passage = Passage(0, frames, kind, entry.captions[0], hand, left, reached)
    return Stretch(
        entry.name,
        entry.subject,
        KINDS[entry.kind],
        motion.root_positions.astype(np.float64),
        motion.local_rotations.astype(np.float64),
        motion.contacts.astype(np.float64),
        (passage,),
        entry.split,
        plain=not ODD.search(" ".join((entry.style, *entry.captions))),
    )


def _touched(motion: Motion, hands: NDArray[np.bool_]) -> tuple[tuple[float, float, float] | None, bool, int | None]:
    """Where and when the hand that rests longest on something rests; nothing where none does."""
    if not hands.any():
        return None, False, None
    left = bool(hands[:, 0].sum() > hands[:, 1].sum())
    at = np.flatnonzero(hands[:, 0 if left else 1])
    frame = int(at[len(at) // 2])
    x, y, z = motion.joint_positions()[frame, -2 if left else -1].astype(float).tolist()
    return (x, y, z), left, frame


def _checked(array: NDArray[Any], name: str) -> NDArray[Any]:
    kind, shape = _ARRAYS[name]
    if array.dtype != kind or array.shape[1:] != shape:
        raise ValueError(f"{name} has {array.dtype} of shape {array.shape}")
    return array


def _stretch(row: dict[str, Any], arrays: dict[str, NDArray[Any]], part: slice) -> Stretch:
    passages = tuple(
        Passage(**{**one, "kind": PartKind(one["kind"]), "hand": None if one["hand"] is None else tuple(one["hand"])})
        for one in row["passages"]
    )
    turns = rotations.normalize(arrays["local"][part].astype(np.float64) / _UNIT)
    return Stretch(
        row["name"], row["person"], MadeOf(row["made_of"]), arrays["roots"][part].astype(np.float64), turns,
        arrays["contacts"][part].astype(np.float64), passages, row["split"], row["room"], row["plain"],
    )  # fmt: skip


def followed(actions: Sequence[Action], motions: Sequence[Motion], name: str, room: str | None) -> Stretch:
    """What our own body acted, one action after the other, with the phases it had as passages.

    Standing and walking are locomotion; a hand's goal is the contact that its motion set out for.
    """
    passages: list[Passage] = []
    begun = 0
    for action, motion in zip(actions, motions, strict=True):
        places = motion.joint_positions()
        for phase in motion.phases:
            kind = PHASES[phase.kind]
            if phase.stop <= phase.start:
                continue
            words = WALKING if kind in PERIODIC and action.skill is not Skill.LOCO else action.caption
            own = _hand_goal(motion, places[phase.start : phase.stop]) if kind is PartKind.REACH else (None, False, 0)
            hand, left, after = own
            passages.append(
                Passage(
                    begun + phase.start, begun + phase.stop, kind, words, hand, left,
                    None if hand is None else begun + phase.start + after,
                )
            )  # fmt: skip
        begun += len(motion)
    return Stretch(
        name, "procedural", MadeOf.PROCEDURAL,
        np.concatenate([motion.root_positions for motion in motions]).astype(np.float64),
        np.concatenate([motion.local_rotations for motion in motions]).astype(np.float64),
        np.concatenate([motion.contacts for motion in motions]).astype(np.float64),
        tuple(passages), room=room,
    )  # fmt: skip


def _hand_goal(motion: Motion, places: NDArray[np.float32]) -> tuple[tuple[float, float, float] | None, bool, int]:
    goal = next((goal for goal in motion.goals if goal.joint.endswith("_wrist")), None)
    if goal is None:
        return None, False, 0
    left = goal.joint.startswith("left")
    away = np.linalg.norm(places[:, -2 if left else -1] - np.array(goal.position), axis=-1)
    return goal.position, left, int(np.argmax(away < away.min() + NEAR))


def people(stretches: Iterable[Stretch]) -> dict[str, float]:
    """Seconds of each person's motion."""
    found: dict[str, float] = {}
    for stretch in stretches:
        found[stretch.person] = found.get(stretch.person, 0.0) + len(stretch) / 30
    return found
