"""Whether a story flows: what the body does where one action meets the next, standing about, turning on the spot.

A *seam* is the first frame of an action but the first. A *walking seam* lies between two walks that both lead
somewhere: people go on walking there. Where they arrive, touch, sit down or rise, they slow down and may stop.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.metrics.balance_figures import RESTING
from motion_backend.metrics.contact_error import STRICT
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.stillness import STILL, fastest_speeds
from motion_backend.motion import Action, PhaseKind, Skill
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

FLOWS: Final = 0.3
"""A pelvis faster than this (m/s) goes on."""
AROUND: Final = 0.5
"""Seconds to either side of a seam in which nobody who goes on stops."""
LEADS: Final = 0.8
"""A walk whose pelvis gets this far from where it began (metres) leads somewhere."""
HANDS: Final = 0.10
"""A wrist or an ankle slower than this (m/s) does nothing yet."""
SMOOTHED: Final = 0.25
"""Standard deviation (s) of the bell that heading and place are smoothed by before turning is told from swaying."""
RISES: Final = frozenset({Skill.STANDUP, Skill.GETUP})
Span = tuple[int, int]
"""First frame of an action and the frame after its last."""


@dataclass(frozen=True)
class Seam:
    """Where one action meets the next."""

    frame: int
    before: Skill
    after: Skill
    walking: bool
    """Between two walks that both lead somewhere, the first of which is not to stand about where it comes to."""
    speed: float
    """Of the pelvis over the floor at the seam, m/s."""
    slowest: float
    """The least of it within half a second of the seam, m/s."""

    @property
    def stops(self) -> bool:
        """Whether the pelvis stands still there or close by."""
        return self.slowest < STILL


@dataclass(frozen=True)
class Share:
    """A part of a whole: shares of several stories are added up part by part."""

    part: float
    whole: float

    @property
    def value(self) -> float | None:
        """The share; None where there is nothing to have a share of."""
        return self.part / self.whole if self.whole else None


def seams(body: Kinematics, actions: Sequence[Action], spans: Sequence[Span]) -> tuple[Seam, ...]:
    """All seams of a story, whose actions fill the spans."""
    speed, around = _pace(body), round(AROUND * body.motion.fps)
    leads = [_leads(body, action, span) for action, span in zip(actions, spans, strict=True)]
    return tuple(
        Seam(
            frame=start,
            before=actions[index].skill,
            after=actions[index + 1].skill,
            walking=leads[index] and leads[index + 1] and not actions[index].stands,
            speed=float(speed[start]),
            slowest=float(speed[max(start - around, 0) : start + around].min()),
        )
        for index, (start, stop) in enumerate(spans[1:])
        if stop > start
    )


def _pace(body: Kinematics) -> Array:
    """Speed of the pelvis over the floor, from the frame before; the first is the second's. (T,) m/s."""
    steps = np.linalg.norm(np.diff(body.positions[:, 0, [0, 2]], axis=0), axis=1) * body.motion.fps
    return np.concatenate([steps[:1], steps]) if len(steps) else np.zeros(len(body.positions))


def _leads(body: Kinematics, action: Action, span: Span) -> bool:
    places = body.positions[span[0] : span[1], 0][:, [0, 2]]
    away = np.linalg.norm(places - places[:1], axis=1).max(initial=0.0)
    return bool(action.skill is Skill.LOCO and action.goal is not None and away >= LEADS)


def holds(body: Kinematics, actions: Sequence[Action], spans: Sequence[Span]) -> NDArray[np.bool_]:
    """Frames that an action means to stay in. (T,).

    A contact from where it is first reached to where it is last held, staying on the spot or where a walk has led, and
    the end of the story.
    """
    found = np.zeros(len(body.motion), dtype=bool)
    for action, (start, stop) in zip(actions, spans, strict=True):
        if action.skill is Skill.LOCO and action.goal is None:
            found[start:stop] = True
        elif action.skill is Skill.LOCO and action.stands:
            found[max(start, stop - round(action.stands * body.motion.fps)) : stop] = True
        elif action.spot is not None and action.skill not in RISES:
            held = np.flatnonzero(_at_its_place(body, action, (start, stop)))
            if len(held):
                found[start + held[0] : start + held[-1] + 1] = True
    last = (actions[-1].stands or actions[-1].hold) if actions else 0.0
    if last > 0:
        found[-round(last * body.motion.fps) :] = True
    return found


def _at_its_place(body: Kinematics, action: Action, span: Span) -> NDArray[np.bool_]:
    """Frames of a span in which what touches is where it is to be, for hands near it and for the rest on it."""
    assert action.spot is not None
    joint = f"{action.hand}_wrist" if action.skill is Skill.TOUCH else "pelvis"
    places = body.positions[span[0] : span[1], INDEX[joint]]
    away = np.linalg.norm(places - np.asarray(action.spot.point), axis=1)
    # A resting joint is up to 10 cm off the surface that it rests on.
    return np.asarray(away <= 2 * STRICT)


def still_outside_holds(body: Kinematics, actions: Sequence[Action], spans: Sequence[Span]) -> Share:
    """Frames in which neither pelvis nor any other joint moves, of those that no action means to stay in."""
    moving = ~holds(body, actions, spans)
    return Share(float((moving & (fastest_speeds(body) < STILL)).sum()), float(moving.sum()))


def touch_waits(body: Kinematics, actions: Sequence[Action], spans: Sequence[Span]) -> tuple[float, ...]:
    """Seconds that the body stands about before every touch it walks to: neither going, stepping nor reaching yet.

    From half a second before it stands at the place to the first frame in which the hand is there; a touch that was
    done elsewhere is not judged.
    """
    pelvis = body.positions[:, :1]
    limbs = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("wrist", "ankle")]
    apart = np.diff(body.positions[:, limbs] - pelvis, axis=0, prepend=(body.positions[:1, limbs] - pelvis[:1]))
    idle = (np.linalg.norm(apart, axis=-1).max(axis=1) * body.motion.fps < HANDS) & (_pace(body) < STILL)
    found, before = [], round(AROUND * body.motion.fps)
    for index, (action, span) in enumerate(zip(actions, spans, strict=True)):
        walked_to = index > 0 and actions[index - 1].skill is Skill.LOCO
        if action.skill is Skill.TOUCH and action.spot is not None and walked_to:
            there = np.flatnonzero(_at_its_place(body, action, span))
            if len(there):
                until = span[0] + int(there[0])
                found.append(float(idle[max(span[0] - before, 0) : until].sum()) / body.motion.fps)
    return tuple(found)


def turning_on_the_spot(body: Kinematics) -> Share:
    """Radians that the pelvis turns while it is slower than `FLOWS`, of all that it turns on its way: who dances or
    sweeps where they stand is to turn there."""
    if len(body.motion) < 2:
        return Share(0.0, 0.0)
    from scipy.ndimage import gaussian_filter1d

    ahead = rotations.rotate(body.world[:, 0], np.array([0.0, 0.0, 1.0]))
    sigma = SMOOTHED * body.motion.fps
    yaw = gaussian_filter1d(np.unwrap(np.arctan2(ahead[:, 0], ahead[:, 2])), sigma, mode="nearest")
    place = gaussian_filter1d(body.positions[:, 0, [0, 2]], sigma, axis=0, mode="nearest")
    turned = np.abs(np.diff(yaw)) * _on_its_way(body)[1:]
    slow = np.linalg.norm(np.diff(place, axis=0), axis=1) * body.motion.fps < FLOWS
    return Share(float(turned[slow].sum()), float(turned.sum()))


def _on_its_way(body: Kinematics) -> NDArray[np.bool_]:
    """Frames of no part that stays where it stands, rests, goes down or comes up. (T,)."""
    found = np.ones(len(body.motion), dtype=bool)
    for phase in body.motion.phases:
        if phase.kind in RESTING or phase.kind in (PhaseKind.STANDUP, PhaseKind.STAND):
            found[phase.start : phase.stop] = False
    return found
