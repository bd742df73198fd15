"""What presses on a simulated body, and where its feet stand: read from MuJoCo's contacts while it is simulated."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

import numpy as np

from motion_backend.body.capsules import BODIES
from motion_backend.physics.engine import engine
from motion_backend.physics.mjcf_character import SIDES, SOLE_POINTS, TOES
from motion_backend.rotations import Array

TOUCHED: Final = tuple(capsule.name for capsule in BODIES)
"""The 15 contact bodies (SIMS 3.3); toes count as their foot, knees as their shin, what is sat on as the pelvis."""
STANDS: Final = 20.0
"""Newtons at heel or ball from which it counts as planted."""


def _zeros() -> Array:
    return np.zeros(len(TOUCHED))


ROOT: Final = 6
"""Degrees of freedom of the pelvis."""


@dataclass(frozen=True)
class Pressure:
    """Mean forces over a frame, in newtons, at right angles to what they act on."""

    floor: Array = field(default_factory=_zeros)
    """Of the floor on each contact body. (15,)."""
    things: Array = field(default_factory=_zeros)
    """Of walls and furniture. (15,)."""
    soles: Array = field(default_factory=lambda: np.zeros((len(SIDES), 6)))
    """By the nearest point of a foot: heel, heel, ball, ball, toe, toe. (2, 6)."""
    up: Array = field(default_factory=lambda: np.zeros(1))
    """The upward part of all of them and of friction, that is, what carries the body. (1,)."""
    root: Array = field(default_factory=lambda: np.zeros(1))
    """The greatest force or torque on the pelvis besides weight and contacts, newtons or newton metres. (1,)."""

    @property
    def planted(self) -> Array:
        """Left heel, left ball, right heel, right ball: 1 where it carries. (4,)."""
        heel, ball = self.soles[:, :2].sum(axis=1), self.soles[:, 2:].sum(axis=1)
        return (np.stack([heel, ball], axis=1).ravel() > STANDS).astype(np.float64)

    @property
    def total(self) -> float:
        """All that carries the body."""
        return float(self.floor.sum() + self.things.sum())


@dataclass(frozen=True)
class ContactReader:
    """Knows a body's geoms in any window of a home."""

    own: tuple[int, ...]
    """Which contact body each geom is; -1 for the home's."""
    floor: int
    feet: tuple[tuple[int, int], ...]
    """Bodies of foot and toes, left and right."""
    scale: float

    @staticmethod
    def of(model: Any, scale: float) -> ContactReader:
        """From a mujoco.MjModel with a body of that size against 1.70 m."""
        names = [model.geom(index).name for index in range(model.ngeom)]
        own = tuple(_index(name) for name in names)
        feet = tuple((int(model.body(f"{side}_foot").id), int(model.body(f"{side}_toe").id)) for side, _ in SIDES)
        return ContactReader(own, names.index("floor"), feet, scale)

    def read(self, model: Any, data: Any, pressure: Pressure, share: float) -> None:
        """Add what presses now to a frame's pressure, as a share of it."""
        force, feet = np.zeros(6), dict[int, Array]()
        for index in range(data.ncon):
            geoms = data.contact.geom[index].tolist()
            own = max(self.own[geom] for geom in geoms)
            engine().mj_contactForce(model, data, index, force)
            pressing = pressure.floor if self.floor in geoms else pressure.things
            pressing[own] += share * force[0]
            # MuJoCo's contact frame has its axes as rows, the first from the first geom to the second.
            upward = float(force[:3] @ data.contact.frame[index].reshape(3, 3)[:, 1])
            pressure.up[0] += share * (upward if self.own[geoms[1]] >= 0 else -upward)
            if TOUCHED[own].endswith("_foot"):
                side = int(TOUCHED[own].startswith("right"))
                if side not in feet:
                    feet[side] = self.foot_points(data, side)
                away = feet[side] - data.contact.pos[index]
                pressure.soles[side, (away * away).sum(axis=1).argmin()] += share * force[0]

    @cached_property
    def sole(self) -> Array:
        """Two points of the heel and two of the ball, in the foot's frame. (4, 3)."""
        return self.scale * SOLE_POINTS

    def sole_points(self, data: Any, side: int) -> Array:
        """Heel, heel, ball, ball of a foot in the world. (4, 3)."""
        foot, _ = self.feet[side]
        placed: Array = data.xpos[foot] + self.sole @ data.xmat[foot].reshape(3, 3).T
        return placed

    def foot_points(self, data: Any, side: int) -> Array:
        """The same and both ends of the toes. (6, 3)."""
        _, toe = self.feet[side]
        below = self.scale * np.array([[x, y - TOES[2], z] for x, y, z in TOES[:2]])
        return np.concatenate([self.sole_points(data, side), data.xpos[toe] + below @ data.xmat[toe].reshape(3, 3).T])


def _index(name: str) -> int:
    side, _, part = name.partition("_")
    touched = {"toe": f"{side}_foot", "knee": f"{side}_shin", "seat": "pelvis"}.get(part, name)
    return TOUCHED.index(touched) if touched in TOUCHED else -1


def root_force(data: Any) -> float:
    """What pushes the pelvis in a step besides weight and contacts: applied to it, or by servos, springs or damping."""
    own = (data.qfrc_applied[:ROOT], data.qfrc_actuator[:ROOT], data.qfrc_passive[:ROOT], data.xfrc_applied.ravel())
    return float(np.abs(np.concatenate(own)).max())
