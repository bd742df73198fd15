"""One hand-made room with something to sit on, lie on and touch, and ways to act in it."""

from __future__ import annotations

from functools import cache

import numpy as np

from motion_backend.backend_protocol import BodyState
from motion_backend.director import Director
from motion_backend.motion import Action, Character, Emotion, Skill
from motion_backend.procedural.backend import ProceduralBackend
from scene_graphs.affordances.affordances import spots
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Layout, Placed

ROOM = Layout(
    "small",
    "bedroom",
    ((0.0, 0.0), (0.0, 5.0), (6.0, 5.0), (6.0, 0.0)),
    objects=(
        Placed("bed", "double_bed", (1.2, 0.0, 1.2), (1.7, 0.9, 2.2), 0.0),
        Placed("sofa", "multi_seat_sofa", (5.4, 0.0, 2.5), (2.3, 0.85, 0.95), -np.pi / 2),
        Placed("shelf", "bookshelf", (3.2, 0.0, 0.2), (0.9, 1.9, 0.35), 0.0),
        Placed("table", "dining_table", (1.2, 0.0, 4.3), (1.4, 0.76, 0.8), np.pi),
        Placed("chair", "dining_chair", (4.0, 0.0, 4.3), (0.47, 0.87, 0.54), np.pi),
    ),
)


@cache
def small_home() -> Home:
    return home_from_layouts([ROOM], 0)


DIRECTOR = Director(ProceduralBackend())
"""One for all: what it does hangs on the body's state alone."""


@cache
def after(home: Home, *actions: Action, seed: int = 3, height: float = 1.70) -> BodyState:
    """A body that has begun in a home and done all that."""
    if not actions:
        return DIRECTOR.begin(home, Character(height=height), seed)
    return DIRECTOR.act(home, actions[-1], after(home, *actions[:-1], seed=seed, height=height))[1]


def contact(
    home: Home, skill: Skill, name: str, caption: str, emotion: Emotion = Emotion.NEUTRAL, which: int = 0
) -> Action:
    """A contact action at the `which`-th spot of an object."""
    need = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie", Skill.TOUCH: "touch"}[skill]
    spot = spots(home.object(f"0/{name}"), need)[which]
    return Action(skill, caption, emotion, name, f"0/{name}", spot)


def rise(action: Action, skill: Skill = Skill.STANDUP) -> Action:
    """Leaving what a contact action rests on."""
    return Action(skill, "stand up", Emotion.NEUTRAL, action.furniture, action.object_id, action.spot)


def to(action: Action, caption: str = "smoothly forward walk", emotion: Emotion = Emotion.NEUTRAL) -> Action:
    """The walk to where a contact action begins."""
    spot = action.spot
    assert spot is not None
    return Action(
        Skill.LOCO, caption, emotion, action.furniture, action.object_id, goal=spot.standing, facing=spot.approach
    )
