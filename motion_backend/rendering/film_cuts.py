"""Where a film is cut: at actions and where one shot would be too long or go too far; and what is looked at from near,
a face whose mood changes or that is done something with, a hand that touches.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import pairwise
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.body.cast import PLAIN, Role
from motion_backend.motion import Emotion, Motion, PhaseKind
from motion_backend.props import PropTrack
from motion_backend.props.prop_frames import runs_of
from motion_backend.rendering.face_deed import STILL, face_deed
from motion_backend.rendering.film_edit import FilmEdit, Frames
from motion_backend.rendering.hand_deed import HANDS, Blow, from_hanging
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

SHORTEST, LONGEST = 1.6, 7.0
"""Seconds a shot lasts."""
FARTHEST: Final = 3.2
"""Metres the body goes in one shot: who goes farther is followed by another camera."""
CLOSE_SECONDS: Final = 2.2
"""What is looked at from near."""
AGAIN: Final = 6.0
"""Seconds before a face whose mood stays is looked at from near again."""
LENGTHENED: Final = 1.8
"""How many times as long a look from near may be where it is all of a shot."""
HELD: Final = 0.5
"""Metres that a hand which touches moves in that while: a camera that stands still would lose it."""
HELD_SECONDS: Final = 1.0
"""For which something is in a hand that must be seen."""
LIFTED: Final = 0.28
"""Metres from where a hand would hang from which on it is lifted, by who does not walk: a gesture."""
ALSO: Final = 0.75
"""The share of the one hand's way from which the other is lifted as well."""
IN_HAND: Final = 0.25
"""Metres from the middle of a thing to a wrist that has a part in holding it."""
TO_HEAD: Final = 0.30
"""Metres between a wrist and the head of who telephones, drinks or eats."""
REBOUND: Final = 0.3
"""Seconds after a blow that belong to it."""
BOTH: Final = 0.8
"""The share of the one hand's way from hanging from which the other one has a part in it too."""
LYING: Final = 0.5
"""How upright a pelvis is at most, as the height of its own up, of who lies."""
_HEAD: Final = INDEX["head"]


class Subject(StrEnum):
    """What a camera looks at."""

    BODY = "body"
    FACE = "face"
    HANDS = "hands"


@dataclass(frozen=True)
class Framing:
    """Frames start to stop (exclusive), and what of them is looked at."""

    start: int
    stop: int
    subject: Subject = Subject.BODY
    hands: tuple[int, ...] = ()
    """The wrists that have a part in it."""
    deed: Frames | None = None
    """Frames in which these hands are what it is about; of a look from near all are."""
    gesture: bool = False
    """Whether these hands neither touch nor hold anything."""
    of_face: bool = False
    """Whether it is a deed of the face, of which there is no better picture than from near."""


@dataclass(frozen=True)
class Cut:
    """Frames start to stop (exclusive) between two cuts, and what in them is worth looking at from near."""

    start: int
    stop: int
    close: Framing | None = None
    reach: Framing | None = None
    """Where hands touch or hold something, whether that is worth a look from near or not."""

    @property
    def whole(self) -> Framing:
        """All of it, with the hands that must be seen."""
        if self.reach is None:
            return Framing(self.start, self.stop)
        deed = (self.reach.start, self.reach.stop)
        return Framing(self.start, self.stop, hands=self.reach.hands, deed=deed, gesture=self.reach.gesture)


def film_cuts(
    motion: Motion,
    joints: Array,
    starts: Sequence[int],
    role: Role = PLAIN,
    edit: FilmEdit | None = None,
    props: Sequence[PropTrack] = (),
) -> Iterator[Cut]:
    """What an edit keeps of a motion, or all, whose joints are (T, 22, 3) in the world and whose actions begin at
    `starts`; `props` are in its hands."""
    finder = _Finder(motion, joints, role, tuple(props))
    seen: Emotion | None = None
    found: list[Cut] = []
    kept = (edit or FilmEdit.whole(len(motion))).kept
    for start, stop in (window for part in kept for window in _windows(motion, starts, part)):
        mood = finder.mood((start + stop) // 2)
        close = finder.close_up(start, stop, mood is not seen)
        before = next((cut.close for cut in reversed(found) if cut.close is not None), None)
        if close is not None and before is not None:
            # Two in a row would leave no one know where all this is; what the head does is a matter of now and then.
            rest = (close.start - before.stop) / motion.fps
            again = mood is seen if close.subject is Subject.FACE else before.subject is Subject.HANDS
            if close.of_face and rest < SHORTEST and found[-1].close is before:
                found[-1] = replace(found[-1], close=None)  # The face is seen from near as it does it, and not before.
            elif rest <= 0 or (again and rest < AGAIN and not close.of_face):
                close = None
        found.append(Cut(start, stop, close, finder.deed(start, stop)))
        seen = mood if close is not None and close.subject is Subject.FACE else seen
    return iter(found)


def _windows(motion: Motion, starts: Sequence[int], part: Frames) -> Iterator[Frames]:
    """Frames between cuts in a part of a motion: at every action, where walking ends, and where one shot would be too
    long or go too far."""
    first, last = part
    shortest = round(SHORTEST * motion.fps)
    walks = [p for p in motion.phases if p.kind is PhaseKind.WALK]
    edges = sorted({*starts, *(p.start for p in walks), *(p.stop for p in walks)})
    cuts = [first]
    for edge in edges:
        if min(edge - cuts[-1], last - edge) >= shortest:
            cuts.append(edge)
    for start, stop in pairwise([*cuts, last]):
        pieces = np.linspace(start, stop, _pieces(motion, start, stop) + 1).round().astype(int)
        yield from pairwise(pieces.tolist())


def _pieces(motion: Motion, start: int, stop: int) -> int:
    steps = np.linalg.norm(np.diff(motion.root_positions[start:stop, [0, 2]], axis=0), axis=1)
    wanted = max((stop - start) / motion.fps / LONGEST, float(steps.sum()) / FARTHEST)
    return max(1, min(int(np.ceil(wanted)), int((stop - start) / motion.fps / SHORTEST)))


@dataclass(frozen=True)
class _Finder:
    """What close-ups are found in."""

    motion: Motion
    joints: Array
    role: Role
    props: tuple[PropTrack, ...]

    def mood(self, frame: int) -> Emotion:
        """That of the keyframe a frame serves."""
        return self.role.emotions.get(int(self.motion.actions[frame]), Emotion.NEUTRAL)

    def close_up(self, start: int, stop: int, changed: bool) -> Framing | None:
        """The face where it does what it is about, else the hand where something is touched, else the face where the
        mood is another or the head is what matters, else the hands in which something is."""
        own = self._own_face(start, stop)
        if own is not None:
            return own
        if self._lies(start, stop):
            return self._face(start, stop, changed)
        if self._strikes(start, stop):
            return None  # A blow is seen from where the hand is drawn to what it hits.
        return self._touch(start, stop) or self._face(start, stop, changed) or self._held(start, stop)

    def _lies(self, start: int, stop: int) -> bool:
        """Whether somebody lies in some of the frames: of them nothing is looked at from near but the face."""
        up = rotations.rotate(self.motion.local_rotations[start:stop, 0].astype(np.float64), np.array([0.0, 1.0, 0.0]))[
            :, 1
        ]
        return bool((np.abs(up) < LYING).mean() > 0.2)

    def deed(self, start: int, stop: int) -> Framing | None:
        """The frames in which something is touched, else those in which it is in hand, else those of a gesture, and
        the hands that do so."""
        held = next(self._holding(start, stop, HELD_SECONDS), None)
        return self.reach(start, stop) or held or self._gesture(start, stop)

    def _gesture(self, start: int, stop: int) -> Framing | None:
        """The frames in which hands of who does not walk are lifted for the longest, and which."""
        away = from_hanging(self.joints[start:stop])
        walks = [p for p in self.motion.phases if p.kind is PhaseKind.WALK]
        stands = [not any(p.start <= frame < p.stop for p in walks) for frame in range(start, stop)]
        runs = runs_of((away.max(axis=1) > LIFTED) & stands)
        first, last = max(runs, key=lambda run: run[1] - run[0], default=(0, 0))
        if last - first < HELD_SECONDS * self.motion.fps:
            return None
        far = away[first:last].mean(axis=0)
        hands = tuple(np.asarray(HANDS)[far > ALSO * far.max()].tolist())
        return Framing(start + first, start + last, Subject.HANDS, hands, gesture=True)

    def reach(self, start: int, stop: int) -> Framing | None:
        """The frames in which something is touched, or in which a hand is drawn and hits it, and with which hands."""
        touched = self._touched(start, stop)
        if touched is None:
            return None
        first, last = touched
        blow = Blow.of(self.joints, first, last)
        if blow is not None:
            return Framing(
                blow.drawn, min(blow.hit + round(REBOUND * self.motion.fps), last), Subject.HANDS, (blow.hand,)
            )
        away = from_hanging(self.joints[first:last])
        hand = int(away.max(axis=0).argmax())
        there = np.flatnonzero(away[:, hand] > away[:, hand].max() - 0.08)
        hands = HANDS if away[there].min(axis=1).mean() > BOTH * away.max() else (HANDS[hand],)
        return Framing(first + int(there[0]), first + int(there[-1]) + 1, Subject.HANDS, hands)

    def _touched(self, start: int, stop: int) -> Frames | None:
        """From where to where something is touched in some frames."""
        touches = [p for p in self.motion.phases if p.kind is PhaseKind.TOUCH and p.start < stop and p.stop > start]
        return (max(start, touches[0].start), min(stop, touches[-1].stop)) if touches else None

    def _strikes(self, start: int, stop: int) -> bool:
        """Whether there is a blow in some frames."""
        touched = self._touched(start, stop)
        return touched is not None and Blow.of(self.joints, *touched) is not None

    def _touch(self, start: int, stop: int) -> Framing | None:
        reach = self.reach(start, stop)
        if reach is None:
            return None
        return self._around(start, stop, (reach.start + reach.stop - 1) // 2, Subject.HANDS, reach.hands, HELD)

    def _face(self, start: int, stop: int, changed: bool) -> Framing | None:
        near = np.linalg.norm(self.joints[start:stop, HANDS] - self.joints[start:stop, [_HEAD]], axis=-1) < TO_HEAD
        busy = near.mean(axis=0) > 0.4
        asleep = int(self.motion.actions[(start + stop) // 2]) in self.role.asleep
        if not (changed or busy.any() or asleep):
            return None
        long = round(CLOSE_SECONDS * self.motion.fps)
        if stop - start < long:
            return None
        moved = [np.ptp(self.joints[at : at + long, _HEAD], axis=0).max() for at in range(start, stop - long + 1, 5)]
        middle = start + 5 * int(np.argmin(moved)) + long // 2
        hands = tuple(np.asarray(HANDS)[busy].tolist())
        gesture = self._gesture(start, stop)
        if gesture is not None and not hands:
            hands = gesture.hands  # a face whose hands say something is seen with them
        return self._around(start, stop, middle, Subject.FACE, hands, STILL)

    def _own_face(self, start: int, stop: int) -> Framing | None:
        """A deed of the face, with the hands that are at it."""
        found = face_deed(self.motion, self.joints, self.role, start, stop, round(SHORTEST * self.motion.fps))
        if found is None:
            return None
        first, last = found
        near = np.linalg.norm(self.joints[first:last, HANDS] - self.joints[first:last, [_HEAD]], axis=-1) < TO_HEAD
        hands = tuple(np.asarray(HANDS)[near.mean(axis=0) > 0.4].tolist())
        gesture = None if hands else self._gesture(first, last)
        return Framing(first, last, Subject.FACE, gesture.hands if gesture is not None else hands, of_face=True)

    def _holding(self, start: int, stop: int, seconds: float) -> Iterator[Framing]:
        """Frames in which something is in some hands for so long."""
        for track, (since, until) in ((one, held) for one in self.props for held in one.held):
            first, last = max(start, since), min(stop, until)
            if last - first < seconds * self.motion.fps:
                continue
            there = track.positions[first - track.start : last - track.start]
            away = np.linalg.norm(self.joints[first:last, HANDS] - there[:, None], axis=-1).mean(axis=0)
            hands = tuple(np.asarray(HANDS)[away < max(IN_HAND, away.min() + 1e-6)].tolist())
            yield Framing(first, last, Subject.HANDS, hands)

    def _held(self, start: int, stop: int) -> Framing | None:
        """The hands, where something is in them for most of a while."""
        for held in self._holding(start, stop, CLOSE_SECONDS):
            middle = (held.start + held.stop) // 2
            found = self._around(start, stop, middle, Subject.HANDS, held.hands, HELD)
            if found is not None and held.start <= found.start and found.stop <= held.stop:
                return found
        return None

    def _around(
        self, start: int, stop: int, middle: int, subject: Subject, hands: tuple[int, ...], most: float
    ) -> Framing | None:
        """A close-up about a frame that leaves no splinter of the shot around it; None where what it shows moves."""
        window = _splinterless(start, stop, middle, self.motion.fps)
        if window is None:
            return None
        first, last = window
        watched = self.joints[first:last, [_HEAD] if subject is Subject.FACE else list(hands)]
        if np.ptp(watched, axis=0).max() > most:
            return None
        return Framing(first, last, subject, hands)


def _splinterless(start: int, stop: int, middle: int, fps: int) -> tuple[int, int] | None:
    """Frames about one, or from the beginning or to the end of a shot, that leave nothing of it too short to be seen;
    None where there are none."""
    long, shortest = round(CLOSE_SECONDS * fps), round(SHORTEST * fps)
    for first in (middle - long // 2, stop - long, start):
        last = first + long
        rests = (first - start, stop - last)
        if first <= middle < last and all(rest == 0 or rest >= shortest for rest in rests):
            return first, last
    return (start, stop) if long <= stop - start <= LENGTHENED * long else None
