"""The last pass over the arms of a segment: out of what is solid and of the own body, no joint faster than people's.

What arms want is in the handles of a pose. One solve over the whole segment finds a detour for both: how far each wrist
goes elsewhere, and how far its elbow swings about the line from the shoulder, frame by frame. It is a Gauss-Newton
solve: in each of a few rounds the places that are in something (arm_collision.py) are to come out along their ways,
with the least change of the detour (Levenberg 1944) and the least of its second differences, which make one banded
system of equations over all frames. A round that leaves the arms deeper than they were is taken back, and the frames
that are to blame are damped (Marquardt 1963).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.body.joint_limits import out_of_cone
from motion_backend.body.scene_collision import Obstacles
from motion_backend.inverse_kinematics import Limb, arm_rotations, two_bone
from motion_backend.motion import FPS, Posture
from motion_backend.procedural.arm_collision import Bars, Contacts, in_bars, in_things, other_arm, own_bars
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.pose import Pose, concatenate, smooth
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.procedural.touch.hand_captions import steadies, with_both_hands
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

ROUNDS, BARREN, GAIN = 6, 2, 0.95
"""So often it is looked again what a moved arm is in, and so often in a row in vain: more than this of it is left."""
HARDER, EASIER = 4.0, 4.0
"""How much more a frame's detour is damped after a round that left its arms deeper in something, and how much less
after one that did not."""
NOWHERE: Final = 1e-9
"""A way out shorter than this has no direction (metres)."""
SEEN, OUT = 0.003, 0.01
"""An arm this deep in something goes out of it, and is out when it is no deeper than this: flesh gives (metres)."""
LEAD: Final = 14
"""Frames before and after it in which an arm does."""
STIFF: Final = np.array([0.05, 0.05, 0.05, 0.0004])
"""What it costs a wrist to go a metre elsewhere (m²), and an elbow to swing by a radian, against a metre of depth."""
SPREAD: Final = 4.0
"""Frames over which a detour grows."""
FIRM, YIELDS = 4e3, 12.0
"""How much stiffer an arm is where its detour begins and ends and a wrist whose hand touches something, and one whose
hand merely rests on something."""
HANDLES: Final = ("reach", "arms", "elbows", "pressing")
"""What a detour changes of a pose."""
LETS_GO: Final = (0.02, 0.08)
"""A hand that is so far off what it was to lie on is free to turn, wholly so from so much more (metres)."""
WRIST: Final = np.array([1.0, 1.0, 1.0, 0.0])
"""What of a detour is the wrist's."""
STRAINED, STRAIN = float(np.radians(2)), 3.0
"""A shoulder so far beyond its range (radians) is brought back, and what a radian counts (metres)."""
STRETCHED: Final = 0.98
"""Of its length: an arm that a detour stretches farther snaps straight at the elbow."""
STEP: Final = 1e-4
"""How far a wrist (metres) and an elbow (radians) are moved to see what goes with them."""
FLOOR: Final = "floor"
"""The id of what is sat or lain on where that is no object."""
SINKS, SINKS_IN_FLOOR = 0.03, 0.01
"""How deep arms sink into what is sat or lain on, and into a floor (metres)."""
FASTEST: Final = 12.0
"""Of a shoulder, an elbow and a wrist (radians a second): people walk, sit and reach with half of it."""
TRIES: Final = ((8, 2.5), (12, 4.0), (18, 6.0), (26, 9.0))
"""Frames before and after a joint is too fast in which its arm is smoothed, and the width of the bell: as little as
will do."""
LAID_FROM: Final = 0.6
"""A hand that presses more than this lies on something, and the more it does, the more its wrist stays there."""


class Around(NamedTuple):
    """What a body does in a segment, and among what."""

    part: Part
    posture: Posture
    under: str | None
    """What it rests on or gets onto: an object's id."""
    solid: Obstacles

    @property
    def touching(self) -> tuple[bool, bool]:
        """Whether the left and the right hand are on things on purpose."""
        if self.part.kind is not PartKind.REACH:
            return (self.posture is not Posture.STANDING,) * 2
        caption, hand = self.part.action.caption, self.part.action.hand
        both = with_both_hands(caption) or steadies(caption)
        return both or hand == "left", both or hand == "right"

    @property
    def things(self) -> tuple[Obstacles, float]:
        """What arms keep out of, and the height of the floor: who sits or lies sinks in a little."""
        if self.posture is Posture.STANDING:
            return self.solid, 0.0
        return self.solid.sunk_into(self.under, SINKS), -SINKS_IN_FLOOR if self.under == FLOOR else 0.0


def arms_clear(pose: Pose, start: Pose, around: Around, skeleton: Skeleton) -> Pose:
    """A segment of T frames, begun in the single pose `start`, with its arms out of what is solid and none too fast."""
    return _slowed(arms_out(pose, around, skeleton), start, skeleton)


class _Arms(NamedTuple):
    """Both arms of T frames as they want to be, and what is about them that does not move with them."""

    pose: Pose
    wanted: tuple[Arm, Arm]
    chest: tuple[Array, Array]
    bars: tuple[Bars, Bars]
    """The body, as each arm goes round it."""
    things: tuple[Obstacles, float]
    laid: Array
    """How much each hand lies on something on purpose. (T, 2)."""
    firm: float
    """How much stiffer its wrist is then."""
    edges: Array
    """1 where detours begin and end, else 0. (T,)."""
    skeleton: Skeleton

    @staticmethod
    def of(pose: Pose, around: Around, skeleton: Skeleton) -> _Arms:
        chest, laid = chest_frame(pose, skeleton), _laid(pose) * np.array(around.touching)
        arms = Arm.of(pose, skeleton, 0, chest), Arm.of(pose, skeleton, 1, chest)
        bars = own_bars(pose, skeleton)
        firm = FIRM if around.part.kind is PartKind.REACH else YIELDS
        return _Arms(pose, arms, chest, bars, around.things, laid, firm, np.zeros(len(pose)), skeleton)

    def about(self, frames: NDArray[np.bool_]) -> tuple[NDArray[np.intp], _Arms]:
        """The frames about those that a mask (T,) has, and the arms in them."""
        away = np.abs(np.arange(len(frames))[:, None] - np.flatnonzero(frames)).min(axis=1)
        at = np.flatnonzero(away <= LEAD)
        # What goes on from the segment before, and into the next one, is not held there.
        edges = ((away[at] == LEAD) & (at > 0) & (at < len(frames) - 1)).astype(np.float64)
        (left, right), (first, second) = self.bars, self.wanted
        return at, self._replace(
            pose=self.pose.at(at),
            wanted=(first.part(at), second.part(at)),
            chest=(self.chest[0][at], self.chest[1][at]),
            bars=(left.at(at), right.at(at)),
            laid=self.laid[at],
            edges=edges,
        )

    def moved(self, detours: Array) -> Pose:
        """The pose with its arms on their detours (2, T, 4)."""
        handles = {name: getattr(self.pose, name).copy() for name in HANDLES}
        reach, arms, elbows, pressing = handles.values()
        for index, arm in enumerate(self.wanted):
            aside = _within_reach(arm, detours[index, :, :3])
            off = (rotations.length(aside)[:, 0] - LETS_GO[0]) / LETS_GO[1]
            pressing[:, index] *= 1 - smooth(off)
            reach[:, index] += aside
            arms[:, index] += arm.in_chest(aside) / sum(arm.lengths)
            axis = arm.in_chest(rotations.normalize(arm.way + aside))
            elbows[:, index] = _about(axis, detours[index, :, 3:], elbows[:, index])
        return replace(self.pose, **handles)

    def on(self, detours: Array) -> _Tried:
        """The arms on detours (2, T, 4)."""
        pose, arms = self.pose, self.wanted
        if detours.any():
            pose = self.moved(detours)
            arms = Arm.of(pose, self.skeleton, 0, self.chest), Arm.of(pose, self.skeleton, 1, self.chest)
        hands = _hands(arms)
        first, second = (_rows(arm, self.contacts(arms, hands, index)) for index, arm in enumerate(arms))
        frames, wanted = (np.concatenate(pair) for pair in zip(first[::2], second[::2], strict=True))
        missing = np.bincount(frames, wanted, len(pose)).astype(np.float64)
        return _Tried(detours, pose, (first, second), missing, float(wanted.max(initial=0.0)))

    def contacts(self, arms: tuple[Arm, Arm], hands: tuple[Array, Array], index: int) -> Contacts:
        """What one of the arms is in."""
        arm, hand, other = arms[index], hands[index], 1 - index
        bars = in_bars(arm, hand, self.bars[index].beside(other_arm(arms[other], hands[other])))
        things = in_things(arm, hand, *self.things, self.laid[:, index])
        frames, of, out = (np.concatenate(parts) for parts in zip(bars, things, strict=True))
        return Contacts(frames, of, out)


def arms_out(pose: Pose, around: Around, skeleton: Skeleton, where: NDArray[np.bool_] | None = None) -> Pose:
    """A segment of T frames with both arms out of what they are in, or out of what they are in about the frames `where`
    (T,) alone."""
    from scipy.ndimage import uniform_filter1d

    whole = _Arms.of(pose, around, skeleton)
    wanting, seen = whole.on(np.zeros((2, len(pose), 4))), np.zeros(len(pose), dtype=bool)
    for rows in wanting.rows:
        seen[rows.frames[rows.wanted > SEEN]] = True
    if where is not None:
        seen &= where
    if not seen.any():
        return pose
    at, near = whole.about(seen)
    free, damped = bool(at[-1] == len(pose) - 1), np.ones(len(at))
    best, barren = wanting.part(at, near.pose), 0
    for _ in range(ROUNDS):
        if best.deepest < OUT or barren == BARREN:
            break
        tried = near.on(best.detours + _step(near, best, damped, free))
        worse = uniform_filter1d(tried.missing - best.missing, 2 * round(SPREAD) + 1, mode="nearest") > 0
        damped = np.where(worse, damped * HARDER, np.maximum(damped / EASIER, 1.0))
        barren = 0 if tried.missing.sum() < GAIN * best.missing.sum() else barren + 1
        if tried.missing.sum() < best.missing.sum():
            best = tried
    handles = {}
    for name in HANDLES:
        handles[name] = getattr(pose, name).copy()
        handles[name][at] = getattr(best.pose, name)
    return replace(pose, **handles)


def _step(arms: _Arms, best: _Tried, damped: Array, free: bool) -> Array:
    """What is added to both detours (2, T, 4), the less the more a frame is damped (T,)."""
    found = []
    for index, rows in enumerate(best.rows):
        firm = FIRM * arms.edges[:, None] + arms.firm * arms.laid[:, index, None] * WRIST
        found.append(_solved(rows, damped[:, None] * (1 + firm), best.detours[index], free))
    return np.stack(found)


def _laid(pose: Pose) -> Array:
    """How much each hand lies on something. (T, 2)."""
    return pose.reaching * np.clip((pose.pressing - LAID_FROM) / (1 - LAID_FROM), 0.0, 1.0)


def _hands(arms: tuple[Arm, Arm]) -> tuple[Array, Array]:
    """Where both hands point. (T, 3) each."""
    return arms[0].hand(arms[0].limb), arms[1].hand(arms[1].limb)


def _strain(arm: Arm, limb: Limb) -> Array:
    """How far the shoulder of bones (..., T, 3) is beyond its range. (..., T) radians."""
    upper, _ = arm_rotations(limb, arm.side)
    return out_of_cone(f"{arm.name}_shoulder", rotations.compose(rotations.inverse(arm.clavicle), upper))


def _within_reach(arm: Arm, aside: Array) -> Array:
    """Detours (T, 3) of a wrist on which its arm is stretched no farther than it was, or than `STRETCHED`."""
    way = arm.way + aside
    most = np.maximum(rotations.length(arm.way), STRETCHED * sum(arm.lengths))
    return np.asarray(way * np.minimum(most / np.maximum(rotations.length(way), NOWHERE), 1.0) - arm.way)


def _about(axes: Array, angles: Array, vectors: Array) -> Array:
    """Vectors turned about unit axes by angles (..., 1)."""
    return rotations.rotate(rotations.rotvec_to_quat(angles * axes), vectors)


class _Tried(NamedTuple):
    """Both arms of T frames on detours (2, T, 4), and what they are in then."""

    detours: Array
    pose: Pose
    rows: tuple[_Rows, _Rows]
    missing: Array
    """The ways out of all that they are in, added up. (T,) metres."""
    deepest: float
    """The longest of them (metres)."""

    def part(self, at: NDArray[np.intp], pose: Pose) -> _Tried:
        """The same of some frames, in which they are in a pose."""
        first, second = (rows.part(at) for rows in self.rows)
        return _Tried(self.detours[:, at], pose, (first, second), self.missing[at], self.deepest)


class _Rows(NamedTuple):
    """M equations of one round for one arm: how far what is in something goes out of it with a wrist and an elbow."""

    frames: NDArray[np.intp]
    """(M,)."""
    gone: Array
    """By the wrist along the axes, and by the elbow's swing. (M, 4)."""
    wanted: Array
    """(M,) metres."""

    def part(self, at: NDArray[np.intp]) -> _Rows:
        """Those of some frames."""
        kept = np.isin(self.frames, at)
        return _Rows(np.searchsorted(at, self.frames[kept]), self.gone[kept], self.wanted[kept])


def _rows(arm: Arm, contacts: Contacts) -> _Rows:
    """What an arm of T frames is in, and the strain of its shoulder."""
    strains = _strain(arm, arm.limb)
    beyond = strains - STRAINED
    strained = np.flatnonzero(beyond > 0)
    at = np.union1d(contacts.frames, strained)
    if not len(at):
        return _Rows(at, np.zeros((0, 4)), np.zeros(0))
    gone, strain = _derivatives(arm.part(at), strains[at])
    far = np.maximum(rotations.length(contacts.out), NOWHERE)
    here = np.searchsorted(at, contacts.frames)
    rows = np.einsum("mc,mcji,mi->mj", contacts.of, gone[here], contacts.out / far)
    strain = -STRAIN * strain[np.searchsorted(at, strained)]
    return _Rows(
        np.concatenate([contacts.frames, strained]),
        np.concatenate([rows, strain]),
        np.concatenate([far[:, 0], STRAIN * beyond[strained]]),
    )


def _derivatives(arm: Arm, strains: Array) -> tuple[Array, Array]:
    """How elbow, wrist and the hand's direction (T, 3, 4, 3), and the strain of the shoulder (T, 4), go with a wrist
    that goes along the axes and with an elbow that swings; `strains` (T,) is what it is now."""
    moves = np.concatenate([np.eye(3), np.zeros((1, 3))])[:, None]
    pole = rotations.cross(rotations.normalize(arm.way), arm.limb.hinge)
    swung = _about(rotations.normalize(arm.way), np.full((1, 1), STEP), pole)
    tried = two_bone(arm.shoulder, arm.wrist + STEP * moves, np.stack([pole, pole, pole, swung]), arm.lengths)
    elbow = arm.lengths[0] * (tried.upper - arm.limb.upper)
    fore = tried.lower - arm.limb.lower
    gone = np.stack([elbow, elbow + arm.lengths[1] * fore, fore * (1 - arm.pressing)[:, None]])
    strain = _strain(arm, tried) - strains
    return np.moveaxis(gone, (0, 1), (1, 2)) / STEP, strain.T / STEP


def _solved(rows: _Rows, firm: Array, detour: Array, free: bool) -> Array:
    """What is added to a detour (T, 4) that begins from none, and does not go back to it where its end is `free`;
    `firm` (T, 4) is how much less than a free arm it is to be changed, 1 or more."""
    from scipy.linalg import solveh_banded

    frames, rough = len(detour), STIFF * SPREAD**4
    blocks, wanted = np.zeros((frames, 4, 4)), np.zeros((frames, 4))
    np.add.at(blocks, rows.frames, rows.gone[:, :, None] * rows.gone[:, None])
    np.add.at(wanted, rows.frames, rows.wanted[:, None] * rows.gone)
    blocks[:, range(4), range(4)] += STIFF * firm
    bands = np.zeros((9, frames, 4))
    for below in range(4):
        bands[below, :, : 4 - below] = blocks[:, range(below, 4), range(4 - below)]
    # Second differences with themselves; beyond both ends there is no detour.
    bands[0] += 6 * rough
    bands[4, :-1] -= 4 * rough
    bands[8, :-2] += rough
    bent = np.diff(np.pad(detour, ((2, 2), (0, 0))), n=2, axis=0)
    if free and frames > 2:
        bands[0, -1] -= 5 * rough
        bands[0, -2] -= rough
        bands[4, -2] += 2 * rough
        bent[-2:] = 0.0
    wanted -= rough * np.diff(bent, n=2, axis=0)
    found = solveh_banded(bands.reshape(9, -1), wanted.ravel(), lower=True, check_finite=False)
    return np.asarray(found.reshape(frames, 4))


class _Turning(NamedTuple):
    """An arm as its joints turn it, with the frame before the segment first."""

    arm: Arm
    joints: Array
    """Local rotations of shoulder, elbow and wrist. (1 + T, 3, 4)."""

    @staticmethod
    def of(pose: Pose, skeleton: Skeleton, index: int) -> _Turning:
        arm = Arm.of(pose, skeleton, index, chest_frame(pose, skeleton))
        local = arm.joints()
        joints = [local[f"{arm.name}_{joint}"] for joint in ("shoulder", "elbow", "wrist")]
        return _Turning(arm, rotations.continuous(np.stack(joints, axis=1)))

    def too_fast(self) -> NDArray[np.intp]:
        """Frames into which a joint turns faster than it may."""
        turns = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(self.joints[:-1]), self.joints[1:]))
        return np.flatnonzero(np.linalg.norm(turns, axis=-1).max(axis=1) > FASTEST / FPS) + 1


def _slowed(pose: Pose, start: Pose, skeleton: Skeleton) -> Pose:
    """The same segment with each arm smoothed about where a joint of it is too fast, the seam before it included."""
    whole = concatenate([start.repeat(1), pose])
    for index in (0, 1):
        begun = whole
        for reach, width in TRIES:
            turning = _Turning.of(whole, skeleton, index)
            fast = turning.too_fast()
            if not len(fast):
                break
            # Of the arm as it was: smoothing twice would wander off.
            about = _near(fast, len(whole), reach)
            whole = _posed(whole, begun, about, _Turning.of(begun, skeleton, index), width, skeleton)
    return whole.at(slice(1, None))


def _near(fast: NDArray[np.intp], frames: int, reach: int) -> Array:
    """How much frames are about those that are too fast: 1 there, 0 from `reach` frames on and in the first. (frames,).

    An arm that was smoothed from the first frame on would set out faster than it came.
    """
    at = np.arange(frames)
    away = np.abs(at[:, None] - fast).min(axis=1)
    return smooth(2 * (1 - away / reach)) * smooth(at / fast.min())


def _posed(pose: Pose, begun: Pose, about: Array, turning: _Turning, width: float, skeleton: Skeleton) -> Pose:
    """An arm turned by the joints it has in `begun`, smoothed by a bell of so many frames as much as `about` says;
    the first frame stays, and a hand that lies on something stays there."""
    from scipy.ndimage import gaussian_filter1d

    arm, joints = turning
    bell = rotations.normalize(gaussian_filter1d(joints, width, axis=0, mode="nearest"))
    off = rotations.quat_to_rotvec(rotations.compose(joints[0], rotations.inverse(bell[0])))
    fade = 1 - smooth(np.arange(len(joints)) / (2 * width))
    bell = rotations.compose(rotations.rotvec_to_quat(fade[:, None, None] * off), bell)
    shoulder, elbow, wrist = np.moveaxis(rotations.slerp(joints, bell, about[:, None]), 1, 0)
    upper = rotations.compose(arm.clavicle, shoulder)
    lower = rotations.compose(upper, elbow)
    out = np.array([float(arm.side), 0.0, 0.0])
    bones = [size * rotations.rotate(turn, out) for size, turn in zip(arm.lengths, (upper, lower), strict=True)]
    laid = _laid(begun)[:, arm.which]
    place = arm.shoulder + bones[0] + bones[1]
    place = place + laid[:, None] * (arm.wrist - place)
    hinge = rotations.rotate(upper, np.array([0.0, -float(arm.side), 0.0]))
    pole = arm.in_chest(rotations.cross(rotations.normalize(place - arm.shoulder), hinge))
    rest = arm.in_chest(place - arm.shoulder) + _lifted(arm, skeleton)
    changed = {
        "arms": rest / sum(arm.lengths),
        "elbows": pole,
        "reach": place,
        "palms": rotations.compose(lower, wrist),
        # A hand that lets go in these frames is turned by them to the end.
        "pressing": np.full(len(joints), float((arm.pressing[about > 0] > 0).any())),
    }
    return _with(pose, arm.which, about > 0, changed)


def _lifted(arm: Arm, skeleton: Skeleton) -> Array:
    """From where the shoulder hangs to where its collar bone has lifted it, in the chest's frame. (T, 3)."""
    bone = skeleton.offsets[skeleton.names.index(f"{arm.name}_shoulder")]
    return np.asarray(rotations.rotate(arm.collar, bone) - bone)


def _with(pose: Pose, index: int, frames: NDArray[np.bool_], changed: dict[str, Array]) -> Pose:
    """The same with handles of one arm changed in some frames."""
    handles = {name: getattr(pose, name).copy() for name in changed}
    for name, values in changed.items():
        handles[name][frames, index] = values[frames]
    return replace(pose, **handles)
