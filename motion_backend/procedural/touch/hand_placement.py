"""How a hand lies on a surface: turned on it and its elbow swung until the skin of its palm meets it and nothing else.

Its wrist is where the contact goal says. A wrist bends only so far, so that a palm that is merely asked for lies askew,
with its fingers in the surface: ways to turn the hand, to tip its fingers and to swing the elbow are tried together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.joint_limits import out_of_cone
from motion_backend.inverse_kinematics import arm_rotations
from motion_backend.procedural.arm_collision import in_bars, own_bars
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.held_poses import shoulders
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.procedural.touch.hand_captions import Laid
from motion_backend.procedural.touch.hand_contacts import is_top
from motion_backend.procedural.touch.reach_keys import HandPlacement
from motion_backend.procedural.touch.touch_keys import Rotate
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST, Skeleton

Depth = Callable[[Array], Array]
PALM: Final = np.array(
    [
        [0.00, -0.023, 0.000], [0.03, -0.027, 0.045], [0.03, -0.027, -0.035], [0.06, -0.031, 0.070],
        [0.08, -0.032, 0.015], [0.08, -0.032, -0.044], [0.10, -0.028, 0.072], [0.11, -0.027, -0.045],
        [0.13, -0.032, 0.047], [0.14, -0.032, -0.047], [0.15, -0.033, 0.015], [0.165, -0.033, 0.049],
        [0.165, -0.030, -0.020], [0.172, -0.027, 0.015],
    ]
)  # fmt: skip
"""The under side of a left hand from its wrist: along the fingers, out of its back, towards the thumb (metres at
1.70 m, the mannequin's)."""
FOREARM: Final = np.array([[0.0, 0.042], [0.6, 0.034]])
"""Shares of a forearm from the elbow, and how thick it is there (metres at 1.70 m)."""
TURNS, DEEPER = 21, 0.016
"""So many turns of a grip are tried, and how much deeper a palm may be in the surface then (metres)."""
SWINGS: Final = np.linspace(-1.5, 1.5, 21)
SWING_STEP: Final = 0.31
"""Swings of the elbow that are tried with each, and how far one is from that of the turn before at most (radians)."""
UNLIKE: Final = 0.12
"""A hand that is farther from where it is to be does not follow (radians)."""
DEEPEST, SOON = 0.02, 4
"""No palm is in a surface deeper than this (metres): so many frames before it would be a hand has come off it."""


def placed(bent: Pose, laid: Laid, elbows: Array, seen: Depth, skeleton: Skeleton, row: HandPlacement) -> Laid:
    """The same hands as they best lie where a bent single pose has them, and where their elbows then point.

    `elbows` (2, 3) is where they would point by themselves, `seen` says how deep points (N, 3) are in what is there.
    """
    found, poles = replace(laid, elbows=elbows.copy()), elbows.copy()
    for place, (index, wrist, palm) in enumerate(laid.hands):
        tried = _tries(bent, (index, wrist, palm), laid, elbows[index], skeleton, row)
        arm = Arm.of(tried, skeleton, index, chest_frame(tried, skeleton))
        body = own_bars(bent.repeat(1), skeleton)[index].at(np.zeros(len(tried), dtype=np.intp))
        own = row.deep_per_m * in_bars(arm, arm.hand(arm.limb), body).depth(len(tried))
        cost = own + _cost(arm, tried, laid.normal, wrist, seen, skeleton.scale, row) + _unusual(laid, row)
        best = int(np.argmin(cost))
        poles[index] = tried.elbows[best, index]
        chosen = tried.palms[best, index]
        other = found.other
        found = replace(found, palm=chosen) if place == 0 or other is None else replace(found, other=(other[0], chosen))
    return replace(found, elbows=poles)


@dataclass(frozen=True)
class Grip:
    """How far a hand on a surface turns about what it holds, and where its elbow goes for it to get there."""

    palm: Array
    """(4,) hand to world before it is turned: as the wrist can, not as it was asked to."""
    turns: Array
    """(N,) rising, 0 among them (radians)."""
    elbows: Array
    """(N, 3) where the elbow points for each, in the chest's frame."""

    def swung(self, wave: Array) -> Array:
        """Turns (T,) for a wave of unit size, to the farther side first. (T,)."""
        first, last = self.turns[[0, -1]]
        return np.asarray((first + last) / 2 + (last - first) / 2 * (wave if last > -first else -wave))


def gripped(held: Pose, index: int, angle: Array, normal: Array, grip: Grip, row: Rotate) -> Pose:
    """T frames of a hand (0 left, 1 right) on a surface, its grip turned by angles (T,) about what it holds, and the
    elbow with it."""
    turn, side = rotations.rotvec_to_quat(angle[:, None] * normal), (1.0, -1.0)[index]
    reach, palms, elbows = held.reach.copy(), held.palms.copy(), held.elbows.copy()
    middle = rotations.rotate(grip.palm, np.array([side * row.grip_m, 0.0, 0.0]))
    reach[:, index] += middle - rotations.rotate(turn, middle) + row.lift_per_rad * np.abs(angle)[:, None] * normal
    palms[:, index] = rotations.compose(turn, grip.palm)
    elbows[:, index] = np.stack([np.interp(angle, grip.turns, axis) for axis in grip.elbows.T], axis=1)
    return replace(held, reach=reach, palms=palms, elbows=elbows)


def lifted_off(whole: Pose, laid: Laid, skeleton: Skeleton) -> Pose:
    """T frames of hands on a surface, which come off it where their fingers would be deep in it: on its way over a
    thing a hand gets to where its wrist cannot bend as far as it would have to."""
    from scipy.ndimage import gaussian_filter1d, maximum_filter1d

    reach, frame = whole.reach.copy(), chest_frame(whole, skeleton)
    for index, wrist, _ in laid.hands:
        skin, _, _ = _palm_skin(Arm.of(whole, skeleton, index, frame), skeleton.scale)
        deep = -((skin - wrist) @ laid.normal + HAND_REST).min(axis=1) - DEEPEST
        over = maximum_filter1d(np.clip(deep, 0.0, None) * whole.reaching[:, index], 2 * SOON + 1, mode="nearest")
        reach[:, index] += gaussian_filter1d(over, SOON / 2, mode="nearest")[:, None] * laid.normal
    return replace(whole, reach=reach)


def grip_of(there: Pose, laid: Laid, skeleton: Skeleton, row: Rotate) -> Grip:
    """How far a hand that lies in a single pose turns to either side with its palm on the surface, its elbow swinging
    as little as will do about the line from the shoulder."""
    from scipy.ndimage import gaussian_filter1d

    index, wrist, _ = laid.hands[0]
    one, side = there.repeat(1), (1.0, -1.0)[index]
    frame = chest_frame(one, skeleton)
    along = rotations.rotate(rotations.inverse(frame[0][0]), wrist - shoulders(one, skeleton)[0, index])
    along = rotations.normalize(along)
    poles = rotations.rotate(rotations.rotvec_to_quat((side * SWINGS)[:, None] * along), there.elbows[index])
    _, hand, _ = _palm_skin(Arm.of(one, skeleton, index, frame), skeleton.scale)
    angles = np.linspace(-row.turn_rad, row.turn_rad, TURNS)
    # Every turn with every swing of the elbow.
    angle, pole = np.repeat(angles, len(SWINGS)), np.tile(poles, (TURNS, 1))
    still = Grip(hand[0], angles, np.tile(there.elbows[index], (TURNS, 1)))
    tried = gripped(there.repeat(len(angle)), index, angle, laid.normal, still, row)
    elbows = tried.elbows.copy()
    elbows[:, index] = pole
    can = _follows(replace(tried, elbows=elbows), laid, skeleton).reshape(TURNS, len(SWINGS))
    first, up = _swings(can[TURNS // 2 :: -1]), _swings(can[TURNS // 2 :])
    swings = np.array([*first[:0:-1], *up])
    turns = angles[TURNS // 2 + 1 - len(first) : TURNS // 2 + len(up)]
    smooth = gaussian_filter1d(swings, 1.0, mode="nearest")
    turned = rotations.rotvec_to_quat((side * smooth)[:, None] * along)
    return Grip(hand[0], turns, rotations.rotate(turned, there.elbows[index]))


def _follows(tried: Pose, laid: Laid, skeleton: Skeleton) -> NDArray[np.bool_]:
    """Whether the hand gets to where it is turned, with its palm no deeper in the surface than it was at first, and no
    strain in the shoulder. (N,)."""
    index, wrist, _ = laid.hands[0]
    arm = Arm.of(tried, skeleton, index, chest_frame(tried, skeleton))
    skin, hand, _ = _palm_skin(arm, skeleton.scale)
    gap = ((skin - wrist) @ laid.normal + HAND_REST).min(axis=1)
    unlike = rotations.length(
        rotations.quat_to_rotvec(rotations.compose(rotations.inverse(hand), tried.palms[:, index]))
    )
    upper, _ = arm_rotations(arm.limb, arm.side)
    strain = out_of_cone(f"{arm.name}_shoulder", rotations.compose(rotations.inverse(arm.clavicle), upper))
    return np.asarray((unlike[:, 0] < UNLIKE) & (gap > gap[len(gap) // 2] - DEEPER) & (strain < UNLIKE))


def _swings(can: NDArray[np.bool_]) -> list[float]:
    """From no turn on outwards, the swing of the elbow for each turn, as near to the last one as may be; as far as
    there is one within reach. `can` is (turns, swings)."""
    found = [0.0]
    for row in can[1:]:
        away = np.where(row, np.abs(SWINGS - found[-1]), np.inf)
        if away.min() > SWING_STEP:
            break
        found.append(float(SWINGS[np.argmin(away)]))
    return found


def lies_free(wrist: Array, palm: Array, side: float, seen: Depth, scale: float) -> bool:
    """Whether the palm (4,) of a hand laid flat with its wrist (3,) there is in nothing that stands on the surface; 1
    is the left one, -1 the right."""
    points = wrist + scale * rotations.rotate(palm[None], PALM * [side, 1.0, 1.0])
    return bool(seen(points).max() <= 0.0)


def _grid(laid: Laid, row: HandPlacement) -> tuple[Array, Array, Array]:
    """Turns of the hand on the surface, tips of its fingers into it and swings of its elbow that are tried. (N,)."""
    turns = row.top_turns_rad if is_top(laid.normal) else row.front_turns_rad
    turn, tip, swing = np.meshgrid(turns, row.tips_rad, row.swings_rad, indexing="ij")
    return turn.ravel(), tip.ravel(), swing.ravel()


def _unusual(laid: Laid, row: HandPlacement) -> Array:
    """What it costs to lie otherwise than straight ahead, or up a front. (N,)."""
    turn, tip, swing = _grid(laid, row)
    return np.asarray(row.turn_per_rad * np.abs(turn) + row.tip_per_rad * tip + row.swing_per_rad * np.abs(swing))


def _tries(
    bent: Pose, hand: tuple[int, Array, Array], laid: Laid, pole: Array, skeleton: Skeleton, row: HandPlacement
) -> Pose:
    """The pose with its hand laid in every way of the grid: its index, wrist and palm are given, and where its elbow
    points. N frames."""
    index, wrist, palm = hand
    side = 1.0 if index == 0 else -1.0
    turn, tip, swing = _grid(laid, row)
    tries = bent.repeat(len(turn))
    reach, reaching, palms = tries.reach.copy(), tries.reaching.copy(), tries.palms.copy()
    pressing, elbows = tries.pressing.copy(), tries.elbows.copy()
    reach[:, index], reaching[:, index], pressing[:, index] = wrist, 1.0, 1.0
    shoulder, (chest, _) = shoulders(bent.repeat(1), skeleton)[0, index], chest_frame(bent.repeat(1), skeleton)
    along = rotations.normalize(rotations.rotate(rotations.inverse(chest[0]), wrist - shoulder))
    # Inwards is clockwise for the left hand, seen from above the surface.
    turned = rotations.rotvec_to_quat((-side * turn)[:, None] * laid.normal)
    tipped = rotations.axis_to_quat("z", -side * tip)
    palms[:, index] = rotations.compose(rotations.compose(turned, palm), tipped)
    # About the line from shoulder to wrist: outwards and up from where it points by itself.
    elbows[:, index] = rotations.rotate(rotations.rotvec_to_quat((side * swing)[:, None] * along), pole)
    return replace(tries, reach=reach, reaching=reaching, palms=palms, pressing=pressing, elbows=elbows)


def _cost(arm: Arm, tried: Pose, normal: Array, wrist: Array, seen: Depth, scale: float, row: HandPlacement) -> Array:
    """What an arm costs that is in something, hovers, or is strained. (N,)."""
    upper, _ = arm_rotations(arm.limb, arm.side)
    skin, hand, bent = _palm_skin(arm, scale)
    gap = (skin - wrist) @ normal + HAND_REST
    share, thick = FOREARM.T
    along = arm.elbow[:, None] + share[:, None] * arm.lengths[1] * arm.limb.lower[:, None]
    points = np.concatenate([skin, along], axis=1)
    deep = seen(points.reshape(-1, 3)).reshape(points.shape[:2]) + np.append(np.zeros(len(PALM)), scale * thick)
    deepest = np.maximum(np.maximum(deep, 0.0).sum(axis=1), -gap.min(axis=1))
    strain = out_of_cone(f"{arm.name}_shoulder", rotations.compose(rotations.inverse(arm.clavicle), upper))
    bend = rotations.length(rotations.quat_to_rotvec(bent))[:, 0]
    unlike = rotations.length(
        rotations.quat_to_rotvec(rotations.compose(rotations.inverse(hand), tried.palms[:, arm.which]))
    )[:, 0]
    return np.asarray(
        row.deep_per_m * deepest
        + row.hover_per_m * np.maximum(gap.min(axis=1), 0.0)
        + row.strain_per_rad * strain
        + row.bend_per_rad * bend
        + row.unlike_per_rad * unlike
    )


def _palm_skin(arm: Arm, scale: float) -> tuple[Array, Array, Array]:
    """Points of a palm (N, P, 3), its hand's world and its wrist's local rotation (N, 4)."""
    wrist, (_, lower) = arm.joints()[f"{arm.name}_wrist"], arm_rotations(arm.limb, arm.side)
    hand = rotations.compose(lower, wrist)
    skin = arm.wrist[:, None] + scale * rotations.rotate(hand[:, None], PALM * [float(arm.side), 1.0, 1.0])
    return skin, hand, wrist
