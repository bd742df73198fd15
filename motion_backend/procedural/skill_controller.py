"""The performers of the parts that the state machine (SIMS 3.4) asks for."""

from __future__ import annotations

from collections.abc import Callable

from motion_backend.backend_protocol import Part, PartKind
from motion_backend.motion import Action, PhaseKind, Posture
from motion_backend.procedural.body_state import Body, Point, spot_of, spot_under
from motion_backend.procedural.emotion_style import bearing_of
from motion_backend.procedural.held_poses import Seat
from motion_backend.procedural.lie.lie_skill import before_bed, get_up, leave_bed, lie, sit_up, stay_lying
from motion_backend.procedural.reaction import react
from motion_backend.procedural.sit.sit_legs import at_front
from motion_backend.procedural.sit.sit_skill import before_seat, leave_seat, sit, stay_seated
from motion_backend.procedural.tail import only_stands
from motion_backend.procedural.touch.touch_skill import before_thing, come_to_thing, reach
from motion_backend.procedural.walk.walk_skill import go, halt, stay
from motion_backend.procedural.walk.walk_styles import walk_style


def perform(body: Body, part: Part) -> None:
    """Do a part; frames are added to the body."""
    if body.stride is not None and part.kind not in (PartKind.WALK, PartKind.TURN):
        body.enter(PhaseKind.WALK)
        halt(body, part.action)
    PARTS[part.kind](body, part)


def _walk(body: Body, part: Part) -> None:
    """Walk to the goal of a part: to the very place that what comes next begins at, where that is done there."""
    if part.goal is None:
        return
    goal, facing = _bound_for(body, part, part.goal, body.upcoming)
    onward = None
    if body.upcoming and body.upcoming[0].kind is PartKind.WALK and body.upcoming[0].goal is not None:
        later = body.upcoming[0]
        # Nobody goes on sideways or backwards as he came.
        if not walk_style(later.action.emotion, later.action.caption).aside:
            onward, _ = _bound_for(body, later, body.upcoming[0].goal, body.upcoming[1:])
        # Who passes by does not turn to what is there.
        facing = facing if onward == goal else None
    body.enter(PhaseKind.WALK)
    go(body, goal, facing, part.action, onward)
    if body.upcoming and body.upcoming[0].kind is PartKind.REACH:
        come_to_thing(body, body.upcoming[0].action)


def _bound_for(body: Body, part: Part, goal: Point, upcoming: tuple[Part, ...]) -> tuple[Point, float | None]:
    """Where a walk to a part's goal ends, and the yaw, from what comes after it."""
    contact = next((later for later in upcoming if later.kind not in (PartKind.WALK, PartKind.TURN)), None)
    if contact is not None and contact.kind in PLACES and spot_of(contact.action).standing == goal:
        return PLACES[contact.kind](body, contact.action)
    return goal, part.facing


def _sit(body: Body, part: Part) -> None:
    """From standing, or from lying on the same piece."""
    if body.posture is Posture.LYING:
        body.enter(PhaseKind.GETUP)
        seat = at_front(Seat.of(spot_of(part.action)), body.skeleton.scale)
        sit_up(body, bearing_of(part.action.emotion, part.action.caption), seat)
    sit(body, part)


def _rise(body: Body, part: Part) -> None:
    """From what the body rests on to standing."""
    bearing = bearing_of(part.action.emotion, part.action.caption)
    if body.posture is Posture.LYING:
        body.enter(PhaseKind.GETUP)
        get_up(body, bearing)
        body.enter(PhaseKind.STANDUP)
        leave_bed(body, bearing)
    else:
        body.enter(PhaseKind.STANDUP)
        leave_seat(body, Seat.of(spot_under(body)), bearing)


def _hold(body: Body, part: Part) -> None:
    """Stay in the pose that the body has come to, or take what happens in it."""
    if part.reaction is not None:
        body.enter(RESTS_IN[body.posture])
        react(body, part)
    elif body.posture is Posture.SEATED:
        body.enter(PhaseKind.SITDOWN)
        stay_seated(body, part)
    elif body.posture is Posture.LYING:
        body.enter(PhaseKind.LIEDOWN)
        stay_lying(body, part)
    else:
        body.enter(PhaseKind.STAND)
        if not (only_stands(part) and body.upcoming):
            stay(body, part)


RESTS_IN = {
    Posture.STANDING: PhaseKind.STAND,
    Posture.SEATED: PhaseKind.SITDOWN,
    Posture.LYING: PhaseKind.LIEDOWN,
}
"""The phase of who stays in a posture."""
PLACES: dict[PartKind, Callable[[Body, Action], tuple[Point, float]]] = {
    PartKind.SIT: before_seat,
    PartKind.LIE: before_bed,
    PartKind.REACH: before_thing,
}
"""Where to stand, and the yaw, before each kind of contact."""
PARTS: dict[PartKind, Callable[[Body, Part], None]] = {
    PartKind.WALK: _walk,
    PartKind.TURN: _walk,
    PartKind.SIT: _sit,
    PartKind.LIE: lie,
    PartKind.REACH: reach,
    PartKind.RISE: _rise,
    PartKind.HOLD: _hold,
}
"""How each kind of part is done."""
