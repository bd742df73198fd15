"""Windows of 16 frames with their conditions, cut from stretches in batches: what a training step sees.

Everything of all stretches lies one after the other in a few tensors; a window is a place in them and the passage it
belongs to. Half of all windows are seen in a mirror, words and goals with them.
"""

from __future__ import annotations

import copy
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.conditions import GAITS, MAX_SECONDS, TIME_UNIT, Conditions, MadeOf
from motion_backend.diffusion.dataset import PERIODIC, Passage, Stretch
from motion_backend.diffusion.motion_features import HISTORY, STRIDE, WINDOW, quat_to_six, twist
from motion_backend.diffusion.scene_encoder import RoomVoxels
from motion_backend.mocap.augmentation import SWAPPED, mirror_words
from motion_backend.mocap.clip import ClipError
from motion_backend.motion import FPS
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton
from scene_graphs.home import home_from_layouts
from scene_graphs.layout_library import built_in_index

LEAD: Final = HISTORY * STRIDE
"""Frames of a window before its first new one."""
SPAN: Final = (WINDOW - 1) * STRIDE
"""From a window's first frame to its last."""
HELD: Final = 45
"""Frames by which windows of our own body run past a passage's end: its last frame is held; so one learns to stay."""
SEATS: Final = (PartKind.SIT, PartKind.LIE, PartKind.RISE)
"""Passages whose goal has a height and a facing."""
THERE: Final = 0.03
"""Metres from where it ends up within which a pelvis has sat down, lain down or risen."""
_OFFSET: Final = HISTORY - 1
Encode = Callable[[Sequence[str]], NDArray[np.float32]]
"""Sentences to features (N, 384)."""


@dataclass(frozen=True)
class Windows:
    """Places in a bank, and what each counts for when one is drawn."""

    starts: NDArray[np.int64]
    """(N,) first frames."""
    passages: NDArray[np.int64]
    """(N,) of the bank's."""
    weights: Array
    """(N,) that sum to one."""

    def __len__(self) -> int:
        return len(self.starts)

    def drawn(self, count: int, rng: np.random.Generator) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """So many, by their weights: first frames and passages."""
        chosen = np.searchsorted(self._sums, rng.random(count)).clip(max=len(self) - 1)
        return self.starts[chosen], self.passages[chosen]

    @cached_property
    def fingerprint(self) -> int:
        """Of what may be drawn, and how often."""
        found = 0
        for kept in (self.starts, self.passages, self.weights):
            found = zlib.crc32(np.ascontiguousarray(kept).tobytes(), found)
        return found

    @cached_property
    def _sums(self) -> Array:
        return np.asarray(np.cumsum(self.weights))


@dataclass(frozen=True)
class Batch:
    """B windows to learn from."""

    windows: Tensor
    """(B, 16, 202) features."""
    given: Conditions
    periodic: Tensor
    """(B,) whether it is locomotion."""
    over: Tensor
    """(B,) whether what is done is done by the end of the window: what is held after that is more of the same."""


class WindowBank:
    """All frames of some stretches, as tensors."""

    def __init__(self, stretches: Sequence[Stretch], encode: Encode, scenes: bool = False) -> None:
        self.stretches = list(stretches)
        if not self.stretches:
            raise ClipError("there is nothing to learn from", "give clips that walk, sit, lie, rise or touch")
        self._skeleton = build_skeleton()
        self._lay_out_frames()
        self._lay_out_passages(encode)
        self._level = _tensor([1.0, 0.0, 1.0])
        self._mirrored, self._signs = mirrored_features()
        self._pelvis_signs = _tensor([-1.0, 1, 1, -1, 1, 1, 1, 1, 1])
        self._hand_signs = _tensor([-1.0, 1, 1, -1])
        self._sees = scenes

    @property
    def device(self) -> torch.device:
        """Where its tensors are, and batches are made."""
        return self._roots.device

    def on(self, device: str) -> WindowBank:
        """The same on another device, where its batches are made of what lies there."""
        found = copy.copy(self)
        for name, value in vars(self).items():
            if isinstance(value, Tensor):
                setattr(found, name, value.to(device))
        if self._sees:
            found._rooms = self._rooms.on(device)
        return found

    def _lay_out_frames(self) -> None:
        lengths = [len(stretch) for stretch in self.stretches]
        self._begins = np.cumsum([0, *lengths])
        roots = np.concatenate([stretch.roots for stretch in self.stretches])
        local = np.concatenate([stretch.local for stretch in self.stretches])
        places, _ = self._skeleton.forward_kinematics(roots, local)
        self._roots, self._yaws = _tensor(roots), _tensor(twist(local[:, 0]))
        self._six = torch.from_numpy(quat_to_six(local).astype(np.float16))
        self._places = _tensor(places)
        self._contacts = _tensor(np.concatenate([stretch.contacts for stretch in self.stretches]))
        along = places[:, INDEX["head"]] - places[:, 0]
        self._lying = _tensor(np.arctan2(along[:, 0], along[:, 2]))

    def _lay_out_passages(self, encode: Encode) -> None:
        rows = [(index, passage) for index, stretch in enumerate(self.stretches) for passage in stretch.passages]
        self.passages = rows
        begins = self._begins
        self._first = torch.tensor([begins[i] + p.start for i, p in rows])
        self._last = torch.tensor([begins[i] + p.stop - 1 for i, p in rows])
        self._reached = torch.tensor([begins[i] + arrival(self.stretches[i], p) for i, p in rows])
        made = [self.stretches[i].made_of for i, _ in rows]
        self._made_of = torch.tensor([int(one) for one in made])
        self.gaits = gaits(self.stretches)
        self._gait = torch.tensor([self.gaits.get(walker(self.stretches[i]), 0) for i, _ in rows])
        self._held = torch.tensor([one is MadeOf.PROCEDURAL for one in made])
        self._low = torch.tensor([begins[i] for i, _ in rows])
        self._high = torch.tensor([begins[i + 1] - 1 for i, _ in rows])
        self._room_names = sorted({stretch.room for stretch in self.stretches if stretch.room is not None})
        numbers = {name: number for number, name in enumerate(self._room_names)}
        self._room = torch.tensor([numbers.get(self.stretches[i].room or "", -1) for i, _ in rows])
        self._is_periodic = torch.tensor([p.kind in PERIODIC for _, p in rows])
        self._is_seat = torch.tensor([p.kind in SEATS for _, p in rows])
        self._is_lying = torch.tensor([p.kind is PartKind.LIE for _, p in rows])
        self._has_hand = torch.tensor([p.hand is not None for _, p in rows])
        self._hands = torch.tensor([p.hand or (0.0, 0.0, 0.0) for _, p in rows], dtype=torch.float32)
        self._sides = torch.tensor([1.0 if p.left else -1.0 for _, p in rows])
        words = wordings(self.stretches)
        place = {text: index for index, text in enumerate(words)}
        self._texts = torch.from_numpy(np.asarray(encode(words), dtype=np.float32))
        self._text = torch.tensor([place[p.caption] for _, p in rows])
        self._mirrored_text = torch.tensor([place[mirror_words(p.caption)] for _, p in rows])

    @cached_property
    def fingerprint(self) -> int:
        """Of all that is learned from: a run goes on with the same only."""
        found = zlib.crc32(repr([(index, passage) for index, passage in self.passages]).encode())
        for tensor in (self._roots, self._six, self._contacts, self._texts, self._made_of, self._gait):
            found = zlib.crc32(tensor.numpy().tobytes(), found)
        return found

    @property
    def learned_from(self) -> tuple[str, ...]:
        """Everybody who was recorded in it, himself or in what recordings were put together to."""
        made = (MadeOf.RECORDED, MadeOf.MATCHED)
        return tuple(sorted({walker(one) for one in self.stretches if one.made_of in made}))

    def windows(self, shares: Mapping[tuple[MadeOf, PartKind], float], every: int = STRIDE) -> Windows:
        """All windows of passages that have a share, a window beginning `every` frames.

        Shares are of what is drawn; within one, everybody counts alike, however long they were recorded. ClipError
        where nothing has a share.
        """
        starts, owners, groups = [], [], []
        for row, (index, passage) in enumerate(self.passages):
            key = (self.stretches[index].made_of, passage.kind)
            if not shares.get(key):
                continue
            found = self._starts(index, row, every)
            starts += found
            owners += [row] * len(found)
            groups += [(key, self.stretches[index].person)] * len(found)
        if not starts:
            raise ClipError("no window of 1.6 s has a share", f"there are {len(self.passages)} passages")
        return Windows(np.array(starts), np.array(owners), _weights(groups, shares))

    def _starts(self, index: int, row: int, every: int) -> list[int]:
        """First frames whose window has its first new frame in the passage."""
        passage, begin = self.passages[row][1], int(self._begins[index])
        low = begin + passage.start - LEAD
        if bool(self._held[row]):
            over = 0 if passage.kind in PERIODIC else HELD
            high = max(begin + passage.stop - SPAN + over, low + 1)
            return [at for at in range(low, high, every) if at + LEAD < begin + passage.stop]
        ends = int(self._begins[index + 1])
        return [at for at in range(max(low, begin), begin + passage.stop - LEAD, every) if at + SPAN < ends]

    def batch(self, starts: NDArray[np.int64], rows: NDArray[np.int64], flips: NDArray[np.bool_]) -> Batch:
        """Windows with their conditions; those with a flip are seen in a mirror."""
        start, row, flip = (torch.from_numpy(one).to(self.device) for one in (starts, rows, flips))
        frames = start[:, None] + STRIDE * torch.arange(WINDOW, device=self.device)
        top = torch.where(self._held[row], self._last[row], self._high[row])
        frames = torch.minimum(torch.maximum(frames, self._low[row][:, None]), top[:, None])  # (B, 16)
        yaw, origin = self._yaws[frames[:, _OFFSET]], self._roots[frames[:, _OFFSET]] * self._level
        periodic = self._is_periodic[row]
        ends = torch.where(periodic, frames[:, -1], self._last[row])
        pelvis, has_pelvis = self._pelvis(row, ends, start, origin, yaw)
        hand = torch.cat([turned(self._hands[row] - origin, yaw), self._sides[row][:, None]], dim=1)
        has_hand = self._has_hand[row].float()
        frame = torch.where(periodic, 0, (start + LEAD - self._first[row]).clamp(min=0))
        text = self._texts[torch.where(flip, self._mirrored_text[row], self._text[row])]
        voxels, has_scene = self._voxels(row, ends, origin, yaw)
        windows = self._features(frames, origin, yaw)
        everybody = torch.ones(len(start), device=self.device)
        given = Conditions(
            text, everybody, frame, self._made_of[row].clone(), self._gait[row].clone(), pelvis, has_pelvis,
            hand * has_hand[:, None], has_hand, voxels, has_scene,
        )  # fmt: skip
        windows, given = self._flipped(windows, given, flip)
        over = ~periodic & (start + SPAN >= self._reached[row])
        return Batch(windows, given, periodic, over)

    def _flipped(self, windows: Tensor, given: Conditions, flip: Tensor) -> tuple[Tensor, Conditions]:
        """Features, goals and voxels of some windows as seen in a mirror at x = 0; words are mirrored already."""
        windows = torch.where(flip[:, None, None], windows[..., self._mirrored] * self._signs, windows)
        pelvis = torch.where(flip[:, None], given.pelvis * self._pelvis_signs, given.pelvis)
        hand, voxels = torch.where(flip[:, None], given.hand * self._hand_signs, given.hand), given.voxels
        if voxels is not None:
            voxels = torch.where(flip[:, None, None, None], voxels.flip(2), voxels)
        return windows, replace(given, pelvis=pelvis, hand=hand, voxels=voxels)

    def _features(self, frames: Tensor, origin: Tensor, yaw: Tensor) -> Tensor:
        """As `to_features` has them. (B, 16, 202)."""
        roots, six = self._roots[frames], self._six[frames].float()
        frame_yaw = yaw[:, None].expand(frames.shape)
        under = roots * self._level
        places = turned(self._places[frames] - under[:, :, None], frame_yaw[..., None].expand(*frames.shape, 22))
        six[:, :, 0, :3] = turned(six[:, :, 0, :3], frame_yaw)
        six[:, :, 0, 3:] = turned(six[:, :, 0, 3:], frame_yaw)
        root = turned(roots - origin[:, None], frame_yaw)
        return torch.cat([root, six.flatten(2), places[:, :, 1:].flatten(2), self._contacts[frames]], dim=-1)

    def _pelvis(self, row: Tensor, ends: Tensor, start: Tensor, origin: Tensor, yaw: Tensor) -> tuple[Tensor, Tensor]:
        """The pelvis goal (B, 9) and who has one: all but hands, which are told only how long they have."""
        place = turned(self._roots[ends] - origin, yaw)
        facing = torch.where(self._is_lying[row], self._lying[ends], self._yaws[ends]) - yaw
        seat, reaches = self._is_seat[row].float(), self._has_hand[row].float()
        left = ((self._reached[row] - (start + STRIDE * _OFFSET)).float() / FPS).clamp(0, MAX_SECONDS) / TIME_UNIT
        timed = (~self._is_periodic[row]).float()
        placed = 1 - reaches
        columns = (
            place[:, 0] * placed, place[:, 2] * placed, place[:, 1] * seat, facing.sin() * placed,
            facing.cos() * placed, seat, placed, left * timed, timed,
        )  # fmt: skip
        return torch.stack(columns, dim=-1), torch.ones(len(row), device=self.device)

    def _voxels(self, row: Tensor, ends: Tensor, origin: Tensor, yaw: Tensor) -> tuple[Tensor | None, Tensor | None]:
        """What stands around the bodies and their goals; None where scenes are not looked at."""
        if not self._sees:
            return None, None
        rooms, across = self._room[row], [0, 2]
        seen = (rooms >= 0).float()
        there = self._roots[ends]
        images = self._rooms.images(
            rooms.clamp(min=0), origin[:, across], there[:, across], yaw, self._is_periodic[row]
        )
        return images * seen[:, None, None, None], seen

    @cached_property
    def _rooms(self) -> RoomVoxels:
        """Those that something was acted in; one of any kind where nothing was."""
        names = self._room_names or [built_in_index().layouts[0].id]
        return RoomVoxels([home_from_layouts([built_in_index().layout(name)], 0) for name in names])


def arrival(stretch: Stretch, passage: Passage) -> int:
    """The frame of a stretch in which a passage has come to what it is for: who sits has sat down, and may stay long.

    That of the hand where it is told; else from when on the pelvis stays where it is in the end.
    """
    if passage.reached is not None:
        return passage.reached
    if passage.kind not in SEATS or stretch.made_of is not MadeOf.PROCEDURAL:
        return passage.stop - 1
    return passage.start + settled(stretch.roots[passage.start : passage.stop])


def settled(roots: Array) -> int:
    """The frame from which on pelvises (T, 3) stay where they are in the end."""
    away = np.flatnonzero(np.linalg.norm(roots - roots[-1], axis=1) > THERE)
    return int(away[-1]) + 1 if len(away) else 0


def wordings(stretches: Sequence[Stretch]) -> list[str]:
    """All that is said in them, and what it is in the mirror."""
    said = {passage.caption for stretch in stretches for passage in stretch.passages}
    return sorted(said | {mirror_words(text) for text in said})


def walker(stretch: Stretch) -> str:
    """Who walked what was recorded, or what recordings were put together to."""
    return stretch.person.removeprefix(f"{MadeOf.MATCHED.name.lower()} ")


def gaits(stretches: Sequence[Stretch]) -> dict[str, int]:
    """A number from 1 on for everybody who was recorded walking; ClipError for more people than can be told apart."""
    walks = {walker(one) for one in stretches if one.made_of is MadeOf.RECORDED and one.passages[0].kind in PERIODIC}
    if len(walks) >= GAITS:
        raise ClipError(f"{len(walks)} people walk in it", f"at most {GAITS - 1} are told apart")
    return {name: number for number, name in enumerate(sorted(walks), start=1)}


def _weights(
    groups: list[tuple[tuple[MadeOf, PartKind], str]], shares: Mapping[tuple[MadeOf, PartKind], float]
) -> Array:
    """Of windows, by the share of their group, the same for everybody in it."""
    counts: dict[tuple[tuple[MadeOf, PartKind], str], int] = {}
    for group in groups:
        counts[group] = counts.get(group, 0) + 1
    persons: dict[tuple[MadeOf, PartKind], int] = {}
    for key, _ in counts:
        persons[key] = persons.get(key, 0) + 1
    total = sum(shares[key] for key in persons)
    return np.array([shares[group[0]] / total / persons[group[0]] / counts[group] for group in groups])


def turned(points: Tensor, yaw: Tensor) -> Tensor:
    """Points (…, 3) of the world turned into frames that face `yaw` (…)."""
    cos, sin = yaw.cos(), yaw.sin()
    x, y, z = points.unbind(-1)
    return torch.stack([cos * x - sin * z, y, sin * x + cos * z], dim=-1)


def mirrored_features() -> tuple[Tensor, Tensor]:
    """From where each feature comes that is seen in a mirror at x = 0, and its sign there. (202,) each."""
    six = 3 + 6 * np.asarray(SWAPPED)[:, None] + np.arange(6)
    places = 135 + 3 * (np.asarray(SWAPPED[1:])[:, None] - 1) + np.arange(3)
    order = np.concatenate([np.arange(3), six.ravel(), places.ravel(), 198 + np.array([2, 3, 0, 1])])
    across = np.array([-1.0, 1.0, 1.0])
    signs = np.concatenate([across, np.tile([1.0, -1, -1, -1, 1, 1], 22), np.tile(across, 21), np.ones(4)])
    return torch.from_numpy(order), _tensor(signs)


def _tensor(values: object) -> Tensor:
    return torch.as_tensor(np.asarray(values), dtype=torch.float32)
