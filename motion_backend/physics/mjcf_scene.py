"""What a simulated body meets: the floor, and the solid boxes of a home near its way, as many in every window.

All windows have the same number of boxes, most of them perhaps far below the floor, so that one state runs through
them: a window is changed by handing MuJoCo another model.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np

from motion_backend.body.scene_collision import Obstacles
from motion_backend.body.zero_moment import GRAVITY
from motion_backend.physics.engine import engine
from motion_backend.physics.mjcf_character import character, numbers
from motion_backend.rotations import Array

SLOTS: Final = 14
"""Boxes of a window."""
REACH: Final = 0.6
"""Boxes this near to the body's joints in a window are in it (metres)."""
LOW: Final = 0.04
"""What is no higher is walked over (metres): rugs."""
THIN: Final = 0.004
"""The least half size of a box (metres): MuJoCo takes none of zero."""
CUSHION: Final = (0.3, 0.8, 0.17)
"""Tops of what gives under a body, from and to, and the least half width (metres): seats and mattresses."""
GIVES: Final = 'solref=".06 1" solimp=".1 .9 .06" priority="2"'
"""How it gives, whatever lies on it: some 3 cm under a body. A rigid one throws thighs off that lie in it by as much in
the plan."""
STEP: Final = 1 / 120
"""Seconds of a simulated step; four make a frame. At 1/60 feet slide three times as fast."""
COARSE_STEP: Final = 1 / 60
"""Seconds of a step of the model that is linearised."""
ITERATIONS: Final = 50
"""Of the solver, at most: with 6 states went to infinity."""
CONTACT_TIME: Final = 2.04
"""Steps in which a rigid contact is resolved; below two MuJoCo calls it unstable."""


@dataclass(frozen=True)
class Models:
    """A window of the home with the body in it."""

    fine: Any
    """mujoco.MjModel that is simulated."""
    coarse: Any
    """The same with the longer step and inverse dynamics of whole steps, to be linearised."""


def near_way(joints: Array, boxes: Obstacles) -> Obstacles:
    """The solid boxes nearest to where a body's joints (T, J, 3) come in a window, at most `SLOTS`."""
    tops = boxes.centers[:, 1] + boxes.halves[:, 1]
    boxes = boxes.only(~boxes.soft & (tops > LOW) & np.isfinite(boxes.centers).all(axis=1))
    points = joints.reshape(-1, 3)
    boxes = boxes.near(points.min(axis=0) - REACH, points.max(axis=0) + REACH)
    gaps = np.array([-boxes.inside(points, index).max() for index in range(len(boxes.owners))])
    order = np.argsort(gaps, kind="stable")[:SLOTS]
    chosen = np.zeros(len(boxes.owners), dtype=bool)
    chosen[[index for index in order if gaps[index] < REACH]] = True
    return boxes.only(chosen)


def models_of(height: float, boxes: Obstacles) -> Models:
    """The body of a height (metres) among some boxes, at most `SLOTS`."""
    rows = tuple(
        (*boxes.centers[index].tolist(), *boxes.halves[index].tolist(), float(boxes.yaws[index]))
        for index in range(len(boxes.owners))
    )
    return _models(height, rows)


@lru_cache(maxsize=32)
def _models(height: float, rows: tuple[tuple[float, ...], ...]) -> Models:
    fine = engine().MjModel.from_xml_string(_world(height, rows, STEP))
    coarse = engine().MjModel.from_xml_string(_world(height, rows, COARSE_STEP))
    coarse.opt.enableflags |= engine().mjtEnableBit.mjENBL_INVDISCRETE
    return Models(fine, coarse)


def _world(height: float, rows: tuple[tuple[float, ...], ...], step: float) -> str:
    pelvis, actuators = character(height)
    boxes = "".join(_box(np.array(row[:3]), np.array(row[3:6]), row[6]) for row in rows)
    spare = "".join(
        _box(np.array([0.0, -20.0 - index, 0.0]), np.full(3, 0.01), 0.0) for index in range(SLOTS - len(rows))
    )
    return f"""<mujoco model="sims">
<compiler angle="degree"/>
<option timestep="{step:.9g}" integrator="implicitfast" gravity="0 {-GRAVITY} 0" iterations="{ITERATIONS}"
 ls_iterations="{ITERATIONS}"><flag eulerdamp="disable" autoreset="disable"/></option>
<size memory="8M"/>
<default><geom condim="3" friction="1 .05 .05" solref="{CONTACT_TIME * step:.6g} 1" contype="1" conaffinity="2"/>
<default class="body"><geom contype="2" conaffinity="1"/></default></default>
<worldbody><geom name="floor" type="plane" size="60 60 1" zaxis="0 1 0"/>{boxes}{spare}{pelvis}</worldbody>
<actuator>{actuators}</actuator></mujoco>"""


def _box(centre: Array, half: Array, yaw: float) -> str:
    top = centre[1] + half[1]
    low, high, wide = CUSHION
    gives = f" {GIVES}" if low < top < high and min(half[0], half[2]) > wide else ""
    turn = numbers(np.cos(yaw / 2), 0.0, np.sin(yaw / 2), 0.0)
    return f'<geom type="box" pos="{numbers(centre)}" size="{numbers(np.maximum(half, THIN))}" quat="{turn}"{gives}/>'
