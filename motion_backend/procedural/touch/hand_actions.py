"""What is done once a hand is at a thing: rest, press, wipe, turn, pick up, put down; and the way there and back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import arm_arrays
from motion_backend.procedural.pose import Pose, concatenate, interpolate, smooth
from motion_backend.procedural.touch.hand_captions import Laid, carrying, empty
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array

Keys = list[tuple[Pose, float]]
"""Key poses, each with the seconds it takes to get to it."""
OVER: Final = 0.12
"""How far from a surface a hand comes down on it and leaves it (metres)."""
GRIP, POINTED = 0.26, 0.95
"""Fingers turned into a surface by a hand that holds something there, and by one that presses with their tips."""
WIDE: Final = 0.09
"""How far hands go to either side in wiping, where there is room for it (metres)."""
WASHED, TURNED = 2.4, 2.0
"""What wiping and turning take at least (seconds)."""
_SLIDE, _TURN, _ELBOW, _GRIPPED, _SWING = 0.012, 0.75, 1.0, 0.09, 0.30


@dataclass(frozen=True)
class Way:
    """The poses a touch goes through, as the body that does it has found them."""

    away: Pose
    """Standing."""
    lead: Pose
    """Standing, with the eyes on the thing."""
    down: tuple[Pose, ...]
    """On the way down to one's knees, if one kneels."""
    hand: Callable[[float, float], Pose]
    """Bent to it, the hand so far off the surface (metres) and its fingers turned into it so far (radians)."""
    laid: Laid
    hold: float
    """Seconds to stay."""
    tempo: float
    """Speed of the hands against neutral."""
    bending: float
    """Seconds for what takes the whole body a second."""
    step: float
    """For each pose of `down`, of such seconds."""

    @property
    def hands(self) -> list[int]:
        """Which hands are laid on the thing (0 left, 1 right)."""
        return [index for index, *_ in self.laid.hands]

    def through(self, start: Pose, keys: Keys) -> Pose:
        """Frames from a pose through others."""
        times = np.concatenate([[0.0], np.cumsum([wait for _, wait in keys])]) / self.tempo
        return interpolate([float(time) for time in times], [start, *(key for key, _ in keys)], FPS)

    def coming(self, keys: Keys) -> Keys:
        """From standing to the thing, the first of these keys being the bent body's: the eyes go first."""
        (bent, wait), *hand = keys
        return [*self.bent([(self.lead, 0.35), *((key, self.step) for key in self.down), (bent, wait)]), *hand]

    def leaving(self, keys: Keys, end: Pose) -> Keys:
        """Away from the thing, the last of these keys being the bent body's, and back to standing."""
        return [*keys, *self.bent([*((key, self.step) for key in self.down[::-1]), (end, 0.75)])]

    def bent(self, keys: Keys) -> Keys:
        """The keys at the pace of the whole body."""
        return [(key, wait * self.bending * self.tempo) for key, wait in keys]

    def around(self, over: Pose, there: Pose, held: Pose) -> Pose:
        """What is held at the thing, with the way to it and back."""
        come = self.through(self.away, self.coming([(over, 0.55), (there, 0.35)]))
        return concatenate([come, held, self.through(there, self.leaving([(over, 0.3)], self.away))])

    def turned(self) -> tuple[Array, Array]:
        """World directions to the body's left and ahead, along the surface. (3,), (3,)."""
        yaw = float(yaw_of(self.away.hips))
        left = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
        left = rotations.normalize(left - (left @ self.laid.normal) * self.laid.normal)
        return left, rotations.cross(left, self.laid.normal)


def deed(way: Way, doing: str) -> Pose:
    """A touch from standing to standing, with what is done there (a word of `handling.HANDLINGS`, or "")."""
    return _DEEDS[doing](way)


def _rest(way: Way) -> Pose:
    """The hand is laid on the thing and stays, alive: it breathes, slides a little, and the eyes wander about it."""
    over, there = way.hand(OVER, 0.0), way.hand(0.0, 0.0)
    time, ease, held = _held(there, way.hold)
    left, _ = way.turned()
    reach = held.reach.copy()
    reach[:, way.hands[0]] += (_SLIDE * ease * _wave(0.4, time))[:, None] * left
    held = replace(_breathing(held, time), reach=reach)
    return way.around(over, there, held)


def _press(way: Way) -> Pose:
    """Fingertips forward, one short push from a cocked wrist, and the hand leaves; then one looks whether it is on."""
    over, aimed, pushed = way.hand(0.10, POINTED), way.hand(0.0, POINTED), way.hand(0.0, GRIP)
    pushed = replace(pushed, spine=pushed.spine + np.array([0.05, 0.0, 0.0]))
    # As quick in any mood.
    push = [(key, wait * way.tempo) for key, wait in ((aimed, 0.45), (pushed, 0.22), (pushed, 0.22), (aimed, 0.22))]
    wrists, poles = arm_arrays("bent", "bent")
    arms, elbows = way.away.arms.copy(), way.away.elbows.copy()
    for index in way.hands:
        arms[index], elbows[index] = wrists[index], poles[index]
    looking = replace(way.away, arms=arms, elbows=elbows, head=np.array([-0.28, 0.0, 0.0]))
    stays = max(way.hold - sum(wait for _, wait in push) / way.tempo, 0.3)
    return concatenate([
        way.through(way.away, way.coming([(over, 0.6), (aimed, 0.3)])),
        way.through(aimed, push),
        way.through(aimed, way.leaving([(over, 0.2 * way.tempo)], looking)),
        way.through(looking, [(looking, stays * way.tempo), (way.away, 0.5)]),
    ])  # fmt: skip


def _wash(way: Way) -> Pose:
    """Wide strokes from side to side, a little to and fro; trunk, hips and eyes go along."""
    over, there = way.hand(OVER, 0.0), way.hand(0.0, 0.0)
    time, ease, held = _held(there, max(way.hold, WASHED))
    aside, forth = ease * _wave(0.6, time), ease * _wave(1.2, time)
    along = way.laid.stroke
    across = rotations.cross(along, way.laid.normal)
    reach, palms = held.reach.copy(), held.palms.copy()
    swing = rotations.rotvec_to_quat((_SWING * aside)[:, None] * way.laid.normal)
    for index in way.hands:
        reach[:, index] += aside[:, None] * along + 0.3 * forth[:, None] * across
        palms[:, index] = rotations.compose(swing, held.palms[:, index])
    left, ahead = way.turned()
    still, far = np.zeros_like(aside), 1 / WIDE
    turn, lean = far * float(along @ left) * aside, far * float(along @ ahead) * aside
    held = replace(
        held,
        reach=reach,
        palms=palms,
        pelvis=held.pelvis + 0.35 * aside[:, None] * np.array([along[0], 0.0, along[2]]),
        spine=held.spine + np.stack([0.03 * forth + 0.10 * lean, 0.18 * turn, still], axis=1),
        head=held.head + np.stack([0.10 * lean, 0.22 * turn, still], axis=1),
    )
    return way.around(over, there, held)


def _rotate(way: Way) -> Pose:
    """A grip that is turned to and fro about what it holds; the elbow goes up and down with it, and the trunk along."""
    over, there = way.hand(OVER, 0.5), way.hand(0.0, GRIP)
    time, ease, held = _held(there, max(way.hold, TURNED))
    index, normal = way.hands[0], way.laid.normal
    angle = _TURN * ease * _wave(0.65, time)
    turn = rotations.rotvec_to_quat(angle[:, None] * normal)
    side = 1.0 if index == 0 else -1.0
    middle = rotations.rotate(there.palms[index], np.array([side * _GRIPPED, 0.0, 0.0]))
    reach, palms, elbows = held.reach.copy(), held.palms.copy(), held.elbows.copy()
    reach[:, index] += middle - rotations.rotate(turn, middle)
    palms[:, index] = rotations.compose(turn, held.palms[:, index])
    elbows[:, index] += _ELBOW * angle[:, None] * np.array([-1.0, -0.6 * side, 0.0])
    left, _ = way.turned()
    along = angle / _TURN
    still = np.zeros_like(along)
    held = replace(
        held,
        reach=reach,
        palms=palms,
        elbows=elbows,
        pelvis=held.pelvis + 0.02 * along[:, None] * np.array([left[0], 0.0, left[2]]),
        spine=held.spine + np.stack([still, 0.10 * along, -0.06 * along], axis=1),
        head=held.head + np.stack([still, -0.06 * along, -0.10 * along], axis=1),
    )
    return way.around(over, there, held)


def _pick(way: Way) -> Pose:
    """Fingers close round it, it comes up to the belly with its weight, the eyes on it, and is kept there."""
    over, laid, gripped, lifted = (way.hand(*at) for at in ((OVER, 0.8), (0.0, 0.0), (0.0, GRIP), (0.17, 0.7)))
    grip: Keys = [(gripped, 0.3), (gripped, 0.5 * way.tempo)]
    carried = carrying(way.away, way.hands)
    heavy = replace(
        carried,
        arms=carried.arms - np.where(np.isin([0, 1], way.hands), 0.10, 0.0)[:, None] * np.array([0.0, 1.0, 0.0]),
        spine=carried.spine - np.array([0.06, 0.0, 0.0]),
        head=carried.head + np.array([0.45, 0.0, 0.0]),
    )
    watched = replace(carried, head=heavy.head)
    stays = max(way.hold - 1.0, 0.5)
    return concatenate([
        way.through(way.away, way.coming([(over, 0.5), (laid, 0.35)])),
        way.through(laid, grip),
        way.through(gripped, way.leaving([(lifted, 0.4 * way.tempo)], heavy)),
        way.through(heavy, [(watched, 0.35), (watched, stays * way.tempo), (carried, 0.4)]),
    ])  # fmt: skip


def _put(way: Way) -> Pose:
    """The forearm comes up, lowers slowly, the hand opens and draws back over the surface; arms hang again."""
    high, gripped, opened = way.hand(0.17, 0.15), way.hand(0.0, GRIP), way.hand(0.0, -0.15)
    _, ahead = way.turned()
    reach = opened.reach.copy()
    reach[way.hands] += 0.03 * way.laid.normal - 0.08 * ahead * float(way.laid.normal[1] > 0.7)
    drawn = replace(opened, reach=reach)
    carried = carrying(way.away, way.hands)
    up = replace(carried, head=carried.head + np.array([0.3, 0.0, 0.0]))
    lead = replace(way.lead, arms=carried.arms, elbows=carried.elbows)
    come = [(up, 0.7), *replace(way, lead=lead).coming([(high, 0.6), (gripped, 0.7)])]
    let_go: Keys = [(gripped, 0.25 * way.tempo), (opened, 0.25), (opened, 0.15 * way.tempo)]
    end = empty(way.away, way.hands)
    stays = max(way.hold - 0.65, 0.3)
    return concatenate([
        way.through(way.away, come),
        way.through(gripped, let_go),
        way.through(opened, way.leaving([(drawn, 0.3)], end)),
        way.through(end, [(end, stays * way.tempo)]),
    ])  # fmt: skip


_DEEDS: Final[dict[str, Callable[[Way], Pose]]] = {
    "": _rest,
    "press": _press,
    "wash": _wash,
    "rotate": _rotate,
    "pick": _pick,
    "put": _put,
}


def _held(pose: Pose, seconds: float) -> tuple[Array, Array, Pose]:
    """Times (T,), an ease that is 0 at both ends (T,), and the pose held so long."""
    time = np.arange(1, max(round(seconds * FPS), 1) + 1) / FPS
    return time, smooth(time / 0.3) * smooth((time[-1] - time) / 0.3), pose.repeat(len(time))


def _wave(rate: float, time: Array) -> Array:
    return np.asarray(np.sin(2 * np.pi * rate * time))


def _breathing(held: Pose, time: Array) -> Pose:
    """A breath in the trunk, and eyes that wander."""
    still = np.zeros_like(time)
    breath = 0.02 * _wave(0.35, time)
    look = smooth(time / 0.4)[:, None] * np.stack([1.5 * breath, 0.08 * _wave(0.3, time), still], axis=1)
    return replace(held, spine=held.spine + np.stack([breath, still, still], axis=1), head=held.head + look)
