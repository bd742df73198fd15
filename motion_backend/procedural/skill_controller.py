"""The state machine of SIMS 3.4: what each skill needs before it (state_machine.py), then the skill itself."""

from __future__ import annotations

from collections.abc import Callable

from motion_backend.motion import FPS, Action, Part, Posture, Skill
from motion_backend.procedural.body_state import Body, spot_under
from motion_backend.procedural.emotion_style import Bearing, bearing_of
from motion_backend.procedural.held_poses import Seat, idle
from motion_backend.procedural.lie.lie_skill import get_up, leave_bed, liedown
from motion_backend.procedural.pose import settle_from
from motion_backend.procedural.sit.sit_skill import leave_seat, sitdown
from motion_backend.procedural.touch.touch_skill import touch_spot
from motion_backend.procedural.walk.walk_skill import loco
from motion_backend.state_machine import ENDS, LEAVING, OWN

STAYS, COMES_TO = 0.3, 0.8
"""How long a body stays on the feet it has got up on, and takes to come to where it stood already (seconds)."""


def perform(body: Body, action: Action) -> None:
    """Leave what the body rests on, then do the skill."""
    bearing = bearing_of(action.emotion, action.caption)
    for part in LEAVING[body.posture]:
        body.enter(part)
        RISES[part](body, bearing)
    body.enter(Part.STAND if action.skill is Skill.LOCO else OWN[action.skill])
    SKILLS[action.skill](body, action)
    body.posture = ENDS[action.skill]
    body.rest = action.spot if body.posture is not Posture.STANDING else None


def _stand_up(body: Body, bearing: Bearing) -> None:
    """From a seat, or from where one has come to from lying."""
    if body.posture is Posture.LYING:
        leave_bed(body, bearing)
    else:
        leave_seat(body, Seat.of(spot_under(body)), bearing)


def _stand(body: Body, action: Action) -> None:
    """Stay on the feet one has come to."""
    restless = bearing_of(action.emotion, action.caption).restless
    if body.frames:
        body.add(idle(body.pose, STAYS, restless, body.rng, FPS))
    else:
        body.add(settle_from(body.pose, idle(body.pose, COMES_TO, restless, body.rng, FPS), FPS))


RISES: dict[Part, Callable[[Body, Bearing], None]] = {Part.GETUP: get_up, Part.STANDUP: _stand_up}
"""How a body gets off what it rests on, part by part."""
SKILLS: dict[Skill, Callable[[Body, Action], None]] = {
    Skill.LOCO: loco,
    Skill.SITDOWN: sitdown,
    Skill.LIEDOWN: liedown,
    Skill.STANDUP: _stand,
    Skill.GETUP: _stand,
    Skill.TOUCH: touch_spot,
}
"""The performer of each skill, from standing."""
