"""What a body does at something that happens: it starts, and its head goes there before anything else does.

In whatever posture it is, with whatever its hands do. The numbers are rows of data/reactions.toml.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.backend_protocol import Part
from motion_backend.motion import FPS, Posture, Reacts
from motion_backend.procedural.body_state import Body
from motion_backend.procedural.emotion_style import bearing_of
from motion_backend.procedural.gaze import Look, gaze_table, turned_to
from motion_backend.procedural.held_poses import idle
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.touch.gestures import gesture
from motion_backend.procedural.touch.hand_rests import follow
from motion_backend.rotations import Array
from motion_backend.scene import EYES, SILL
from scene_graphs.data_tables import read_table, table
from scene_graphs.furniture import categories_of

POCKET: Final = np.array([-0.25, 0.75, 0.35])
"""Where a phone is that lies nowhere: to the left, up and ahead of who has it about them (metres)."""
NEVER_LOST: Final = 1e3
"""What is heard is turned to wherever it is (radians)."""
ABOUT: Final = "phone"
"""What is carried about."""


@table
class _Reacting:
    """How something is taken."""

    seconds: float
    doing: str
    """What trunk and hands do: one of `gestures.gesture_names`; nothing where it is empty."""
    lying: str = ""
    """The same of who lies."""
    from_s: float = 0.0
    """When the head sets out,"""
    turn_s: float = 0.0
    """and how long it takes; without that it goes nowhere."""


@table
class _Reactions:
    """data/reactions.toml."""

    turn_max_rad: float
    """Of head and trunk, to either side: as far as that goes who hears something behind them turns."""
    trunk_share: float
    lying_turn_max_rad: float
    kinds: dict[Reacts, _Reacting]


def _table() -> _Reactions:
    rows: _Reactions = read_table("motion_backend", "reactions.toml", _Reactions)
    return rows


def react(body: Body, part: Part) -> None:
    """Stay as one is and take what happens; `looking` turns the head there."""
    assert part.reaction is not None
    row, restless = _table().kinds[part.reaction.how], bearing_of(part.action.emotion).restless
    held = idle(body.pose, row.seconds, restless, body.rng, FPS)
    if body.posture is Posture.SEATED:
        held = follow(held, body.pose, body.holds, body.skeleton)
    body.add(gesture(held, row.lying if body.posture is Posture.LYING else row.doing))


def looking(pose: Pose, body: Body, part: Part) -> Pose:
    """T frames of a reaction with the head turned to what happens, and on it until the end."""
    assert part.reaction is not None
    rows = _table()
    row, time = rows.kinds[part.reaction.how], np.arange(1, len(pose) + 1) / FPS
    if not row.turn_s:
        return pose
    far = replace(
        gaze_table(),
        turn_max_rad=rows.turn_max_rad,
        lying_turn_max_rad=rows.lying_turn_max_rad,
        trunk_share=rows.trunk_share,
        lost_rad=NEVER_LOST,
        begin_s=row.turn_s,
    )
    look = Look(source_of(part.reaction.at, body), smooth((time - row.from_s) / row.turn_s))
    return turned_to(pose, [look], body.posture, body.skeleton, far)


def source_of(at: str, body: Body) -> Array:
    """Where something happens for a body: the nearest such thing of its room, else the nearest door of it. (3,)."""
    here, home = body.pose.pelvis, body.scene.home
    room = home.room_at(body.place)
    found = _openings(at, body, room) or [
        (placed.position[0], placed.position[1] + placed.size[1] / 2, placed.position[2])
        for placed in home.objects
        if at and placed.category in categories_of(at) and int(placed.id.partition("/")[0]) == room
    ]
    if not found and at == ABOUT:
        return np.asarray(here * [1.0, 0.0, 1.0] + rotations.rotate(rotations.yaw_to_quat(body.yaw), POCKET))
    found = found or _openings("door", body, room) or _openings("door", body, None)
    if not found:
        return np.asarray(here + rotations.rotate(rotations.yaw_to_quat(body.yaw), np.array([1.0, 0.6, 1.0])))
    places = np.array(found)
    return np.asarray(places[np.argmin(np.linalg.norm((places - here)[:, [0, 2]], axis=1))])


def _openings(at: str, body: Body, room: int | None) -> list[tuple[float, float, float]]:
    """Middles of the doors or windows of a room, or of all; as high as eyes where one comes in by them."""
    if at not in ("door", "window"):
        return []
    found = []
    for wall in body.scene.home.walls:
        for opening in wall.openings:
            x, z = np.mean(opening.segment, axis=0)
            is_door = opening.bottom < SILL
            if is_door is (at == "door") and room in (None, body.scene.home.room_at((float(x), float(z)))):
                found.append((float(x), EYES if is_door else (opening.bottom + opening.top) / 2, float(z)))
    return found
