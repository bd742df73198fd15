"""What is told of a simulated motion: by keyframe who moved the joints, falls and resets, and what pressed on what."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, Final

import numpy as np

from motion_backend.motion import FPS, Force, Motion, Simulated
from motion_backend.physics.contact_forces import TOUCHED, Pressure
from motion_backend.rotations import Array

PRESSES: Final = 5.0
"""Newtons from which a body counts as pressing on something."""
LEAST: Final = 0.1
"""Seconds: what is touched for less is not told of."""
SLOW: Final = 0.05
"""Metres a second: a body whose pelvis is slower, half a second before and after too, is at rest."""


def forces_of(pressures: Sequence[Pressure]) -> tuple[Force, ...]:
    """What pressed on which of the 15 contact bodies in some frames."""
    floor = np.array([pressure.floor for pressure in pressures])
    things = np.array([pressure.things for pressure in pressures])
    found = [
        _force(name, on, rows[:, index])
        for on, rows in (("floor", floor), ("things", things))
        for index, name in enumerate(TOUCHED)
    ]
    return tuple(force for force in found if force.seconds >= LEAST)


def weight_error(pressures: Sequence[Pressure], speeds: Array, weight: float) -> float | None:
    """How far what carries a body (contacts' upward forces) is from its weight, as a share of that: the mean of the
    frames at rest, each by itself. None where it never rests; pelvis speeds are (T,), metres a second."""
    near = np.ones(FPS // 2 * 2 + 1)
    rests = np.convolve(speeds < SLOW, near)[len(near) // 2 :][: len(speeds)] > len(near) - 0.5
    carried = np.array([pressure.up[0] for pressure in pressures])[rests]
    return round(float(np.abs(carried / weight - 1).mean()), 4) if len(carried) else None


def _force(name: str, on: str, newtons: Array) -> Force:
    pressing = newtons[newtons > PRESSES]
    if not len(pressing):
        return Force(name, on, 0.0, 0.0, 0.0)
    median, most = round(float(np.median(pressing)), 1), round(float(pressing.max()), 1)
    return Force(name, on, median, most, round(len(pressing) / FPS, 2))


def physics_of(motion: Motion) -> dict[str, Any] | None:
    """For a story's report; None where nothing was simulated."""
    rows = motion.simulated
    if not rows:
        return None
    keyframes = sorted({row.keyframe for row in rows})
    return {
        "mode": "+".join(sorted({row.mode for row in rows})),
        "root_force_newtons": max(row.root_force_newtons for row in rows),
        **_sums(rows),
        "keyframes": [
            {"keyframe": keyframe} | _sums(own) | _modes(own) | {"forces": [asdict(force) for force in _merged(own)]}
            for keyframe in keyframes
            for own in [[row for row in rows if row.keyframe == keyframe]]
        ],
    }


def _modes(rows: Sequence[Simulated]) -> dict[str, Any]:
    """Seconds by who moved the joints, and why no policy did where one was asked for."""
    seconds = {mode: sum(row.seconds for row in rows if row.mode == mode) for mode in {row.mode for row in rows}}
    told = {mode: round(seconds[mode], 2) for mode in sorted(seconds)}
    return {"modes": told, "no_policy": sorted({row.why for row in rows if row.why})}


def _sums(rows: Sequence[Simulated]) -> dict[str, float | None]:
    return {
        "seconds": round(sum(row.seconds for row in rows), 2),
        "resets": sum(row.resets for row in rows),
        "rewinds": sum(row.rewinds for row in rows),
        "rewound_seconds": round(sum(row.rewound_seconds for row in rows), 2),
        "weight_error": max((row.weight_error for row in rows if row.weight_error is not None), default=None),
    }


def _merged(rows: Sequence[Simulated]) -> list[Force]:
    """The forces of a keyframe's parts: the mean of their medians by how long they lasted."""
    found: dict[tuple[str, str], Force] = {}
    for force in (force for row in rows for force in row.forces):
        known = found.setdefault((force.body, force.on), Force(force.body, force.on, 0.0, 0.0, 0.0))
        seconds = known.seconds + force.seconds
        mean = (known.newtons * known.seconds + force.newtons * force.seconds) / seconds
        most = max(known.most, force.most)
        found[force.body, force.on] = Force(force.body, force.on, round(mean, 1), most, round(seconds, 2))
    return list(found.values())
