"""What a body does between two skills, when a skill counts as done, and how long it may take (SIMS 3.4, Eq. 6).

A skill is told where the body is and where it is to get; from the posture it is in follows what comes first. It is
done once what matters has been where it should be for long enough without a break, and given up when its time is over.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

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
from motion_backend.motion import Action, Part, Posture, Skill

LEAVING: Final[dict[Posture, tuple[Part, ...]]] = {
    Posture.STANDING: (),
    Posture.SEATED: (Part.STANDUP,),
    Posture.LYING: (Part.GETUP, Part.STANDUP),
}
"""How a body comes to stand from each posture: who lies sits on the edge first."""
ENTERING: Final[dict[Skill, tuple[Part, ...]]] = {
    Skill.LOCO: (Part.WALK,),
    Skill.SITDOWN: (Part.WALK, Part.BACK_UP, Part.SITDOWN),
    Skill.LIEDOWN: (Part.WALK, Part.BACK_UP, Part.EDGE, Part.LIEDOWN),
    Skill.TOUCH: (Part.WALK, Part.BACK_UP, Part.TOUCH),
    Skill.STANDUP: (Part.STAND,),
    Skill.GETUP: (Part.STAND,),
}
"""What a standing body does for each skill, in order; it walks and backs up only where there is a way to go."""
OWN: Final[dict[Skill, Part]] = {skill: parts[-1] for skill, parts in ENTERING.items()}
"""The skill itself among its parts."""
ENDS: Final[dict[Skill, Posture]] = {
    Skill.LOCO: Posture.STANDING,
    Skill.SITDOWN: Posture.SEATED,
    Skill.LIEDOWN: Posture.LYING,
    Skill.TOUCH: Posture.STANDING,
    Skill.STANDUP: Posture.STANDING,
    Skill.GETUP: Posture.STANDING,
}
"""The posture each skill leaves the body in."""
PATIENCE: Final = 10.0
"""Seconds for every part but walking, as UniHSI gives each of its steps."""
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
    Skill.LOCO: Rule("the pelvis", HAND_OVER, 0.3),
    Skill.SITDOWN: Rule("the pelvis", THRESHOLDS[Skill.SITDOWN], SUSTAINED),
    Skill.LIEDOWN: Rule("the pelvis", THRESHOLDS[Skill.LIEDOWN], SUSTAINED),
    Skill.TOUCH: Rule("the hand", THRESHOLDS[Skill.TOUCH], SUSTAINED),
}
"""Skills with a goal; rising is done once the body has stood for as long as `RISEN` says."""


def parts_of(posture: Posture, skill: Skill) -> tuple[Part, ...]:
    """All that a body in a posture does for a skill, in order."""
    return LEAVING[posture] + ENTERING[skill]


def time_limit(posture: Posture, action: Action, way: float) -> float:
    """Seconds an action may take that has `way` metres to walk."""
    standing_still = [part for part in parts_of(posture, action.skill) if part not in (Part.WALK, Part.BACK_UP)]
    return PATIENCE * max(len(standing_still), 1) + way / STUCK_SPEED + action.hold


def shortfall(action: Action, body: Kinematics, limit: float) -> str:
    """Why what a body did is not the action; empty where it is. `limit` is how long it may take (seconds)."""
    motion = body.motion
    if motion.duration > limit:
        return f"keyframe {action.keyframe}: {action.skill} took {motion.duration:.0f} s, longer than {limit:.0f} s"
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
        f"keyframe {action.keyframe}: {rule.what} was within {rule.within:.2f} m of where to {action.skill} for "
        f"{(stop - start) / motion.fps:.1f} s and not for {rule.seconds:.1f} s; it came to {near.min():.2f} m"
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
    return f"keyframe {action.keyframe}: it had stood for {frames / body.motion.fps:.1f} s and not for {RISEN[2]} s"
