"""What a body does between two skills, when a skill counts as done, and how long it may take (SIMS 3.4, Eq. 6).

A skill is told where the body is and where it is to get; from the posture it is in follows what comes first. It is
done once what matters has been where it should be for long enough without a break, and given up when its time is over.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.metrics.contact_error import (
    HAND_OVER,
    RISEN,
    SUSTAINED,
    THRESHOLDS,
    contact_distance,
    longest_run,
    risen,
)
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import RISINGS, Action, Posture, Skill, moment
from scene_graphs.affordances.affordances import Spot

ENTERING: Final[dict[Skill, tuple[PartKind, ...]]] = {
    Skill.LOCO: (PartKind.WALK,),
    Skill.SITDOWN: (PartKind.WALK, PartKind.SIT, PartKind.HOLD),
    Skill.LIEDOWN: (PartKind.WALK, PartKind.LIE, PartKind.HOLD),
    Skill.TOUCH: (PartKind.WALK, PartKind.REACH),
    Skill.STANDUP: (PartKind.HOLD,),
    Skill.GETUP: (PartKind.HOLD,),
}
"""What a standing body does for each skill, in order."""
STOOD, STOOD_ALREADY = 0.3, 0.8
"""Seconds that one stays on the feet one has come to, and on those one stood on."""
ON_FLOOR: Final = 0.02
"""A place no higher than this is the floor (metres)."""
AT_THE_SPOT: Final = 0.04
"""A body this near to its goal (metres) need not walk: it turns."""
ON_THE_PIECE: Final = {Posture.SEATED: Skill.LIEDOWN, Posture.LYING: Skill.SITDOWN}
"""What is done without rising first by who rests on the same piece, beside the place for it."""
BESIDE, TURNED = 0.65, 0.2
"""A place to sit is beside one to lie that is no farther along the edge (metres) and looks over it (radians)."""
ENDS: Final[dict[Skill, Posture]] = {
    Skill.LOCO: Posture.STANDING,
    Skill.SITDOWN: Posture.SEATED,
    Skill.LIEDOWN: Posture.LYING,
    Skill.TOUCH: Posture.STANDING,
    Skill.STANDUP: Posture.STANDING,
    Skill.GETUP: Posture.STANDING,
}
"""The posture each skill leaves the body in."""
PATIENCE: Final = 15.0
"""Seconds for every part, besides its way and its hold. UniHSI gives each of its steps 10, and who gets up slowly from
the floor takes those."""
STUCK_SPEED: Final = 0.2
"""Metres a second: who walks more slowly is stuck."""


@dataclass(frozen=True)
class Rule:
    """When a skill counts as done."""

    what: str
    within: float
    """Metres from the goal."""
    seconds: float
    """How long without a break."""


DONE: Final[dict[Skill, Rule]] = {
    Skill.LOCO: Rule("the pelvis", HAND_OVER, 0.1),
    Skill.SITDOWN: Rule("the pelvis", THRESHOLDS[Skill.SITDOWN], SUSTAINED),
    Skill.LIEDOWN: Rule("the pelvis", THRESHOLDS[Skill.LIEDOWN], SUSTAINED),
    Skill.TOUCH: Rule("the hand", THRESHOLDS[Skill.TOUCH], SUSTAINED),
}
"""Skills with a goal; rising is done once the body has stood for as long as `RISEN` says."""


def parts_of(
    action: Action, posture: Posture, place: tuple[float, float] | None = None, rest: Spot | None = None
) -> tuple[Part, ...]:
    """All that a body in a posture does for an action, in order (Eq. 6); `place` is where it stands, where known, and
    `rest` what it sits or lies on: one lies down there from sitting, sits up from lying, or rests in another way. What
    happens before it or after it is reacted to there."""
    before, after = (
        tuple(Part(PartKind.HOLD, action, reaction=one) for one in action.reacts if one.after is later)
        for later in (False, True)
    )
    return (*before, *_own_parts(action, posture, place, rest), *after)


def _own_parts(
    action: Action, posture: Posture, place: tuple[float, float] | None, rest: Spot | None
) -> tuple[Part, ...]:
    if action.already and rest is not None and rest == action.spot:
        return (_part(PartKind.HOLD, action, place),)
    if goes_on_resting(posture, action, rest) or (
        ON_THE_PIECE.get(posture) is action.skill and alongside(rest, action.spot)
    ):
        return tuple(_part(kind, action, place) for kind in ENTERING[action.skill] if kind is not PartKind.WALK)
    rising = () if posture is Posture.STANDING else (Part(PartKind.RISE, action),)
    if action.skill is Skill.LOCO and action.goal is None:
        return (*rising, Part(PartKind.HOLD, action, hold=action.hold))
    stands = (Part(PartKind.HOLD, action, hold=action.stands),) if action.stands > 0 else ()
    if action.skill is Skill.LOCO and action.handle is not None and action.spot is not None:
        # Who leaves opens the door first.
        to = Part(PartKind.WALK, action, action.spot.standing, action.spot.approach)
        return (*rising, to, Part(PartKind.REACH, action), _part(PartKind.WALK, action, None), *stands)
    if action.skill in RISINGS:
        return (*rising, *(stands or (Part(PartKind.HOLD, action, hold=STOOD if rising else STOOD_ALREADY),)))
    return (*rising, *(_part(kind, action, place) for kind in ENTERING[action.skill]), *stands)


def goes_on_resting(posture: Posture, action: Action, rest: Spot | None) -> bool:
    """Whether who sits or lies does so in another way on the same place."""
    return (
        posture is not Posture.STANDING and ENDS[action.skill] is posture and rest is not None and rest == action.spot
    )


def alongside(one: Spot | None, other: Spot | None) -> bool:
    """Whether a place to sit and one to lie are beside each other on the same edge of a piece."""
    if one is None or other is None or one.object_id != other.object_id or one.point[1] < ON_FLOOR:
        return False
    turn = float(rotations.wrap(one.approach - other.approach))
    along = np.array([np.cos(one.approach), -np.sin(one.approach)])
    away = np.array([other.point[0] - one.point[0], other.point[2] - one.point[2]])
    return abs(turn) < TURNED and abs(float(away @ along)) < BESIDE


def _part(kind: PartKind, action: Action, place: tuple[float, float] | None) -> Part:
    if kind is PartKind.WALK:
        goal, facing = action.goal, action.facing
        if action.spot is not None and action.skill is not Skill.LOCO:
            goal, facing = action.spot.standing, action.spot.approach
        near = place is not None and goal is not None and np.hypot(goal[0] - place[0], goal[1] - place[1]) < AT_THE_SPOT
        return Part(PartKind.TURN if near else kind, action, goal, facing)
    return Part(kind, action, hold=action.hold if kind in (PartKind.REACH, PartKind.HOLD) else 0.0)


def time_limit(part: Part, way: float) -> float:
    """Seconds a part may take that has `way` metres to walk."""
    return PATIENCE + way / STUCK_SPEED + part.hold


def shortfall(action: Action, body: Kinematics) -> str:
    """Why what a body did is not the action; empty where it is."""
    motion = body.motion
    rule = DONE.get(action.skill)
    if rule is None:
        return _not_up(action, body)
    near = _distance(action, body)
    if near is None:
        return ""
    start, stop = longest_run(near <= rule.within)
    if stop - start >= round(rule.seconds * motion.fps):
        return ""
    return (
        f"{moment(action.keyframe)}: {rule.what} should be within {rule.within:.2f} m of where to {action.skill.words} "
        f"for {rule.seconds:.1f} s, and was for {(stop - start) / motion.fps:.1f} s; it came to {near.min():.2f} m"
    )


def _distance(action: Action, body: Kinematics) -> NDArray[np.float64] | None:
    """Metres from the goal in every frame; None for a skill without one."""
    if action.skill is Skill.LOCO:
        if action.goal is None:
            return None
        return np.asarray(np.hypot(*(body.positions[:, 0, [0, 2]] - np.asarray(action.goal)).T))
    return contact_distance(body) if body.motion.goals else None


def _not_up(action: Action, body: Kinematics) -> str:
    stood = risen(body)[::-1]
    frames = len(stood) if stood.all() else int(np.argmin(stood))
    if frames >= round(RISEN[2] * body.motion.fps):
        return ""
    seconds = frames / body.motion.fps
    return f"{moment(action.keyframe)}: the body should stand for {RISEN[2]} s at its end, and did for {seconds:.1f} s"
