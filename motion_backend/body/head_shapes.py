"""Heads and what grows and sits on them as fields: hair in nine styles, a beard, glasses.

Frame: the reference skeleton's T-pose, pelvis at the origin, facing +Z, left is +X, metres.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.body.implicit_surface import (
    Field,
    capsule,
    difference,
    ellipsoid,
    half_space,
    intersection,
    mirrored,
    ring,
    swollen,
    union,
)
from motion_backend.rotations import Array

if TYPE_CHECKING:
    from motion_backend.body.cast import Look

JAWS: Final = {"straight": 1.0, "curved": 0.88, "young": 0.90, "small": 0.94}
"""Breadth of the chin, by figure."""
_CAP: Final = ellipsoid((0, 0.705, -0.012), (0.085, 0.102, 0.101))
_HAIRLINE: Final = half_space((0, 0.748, 0.085), (0, -1.0, 0.74))
"""In front of and below it there is no hair."""
_FACE: Final = ellipsoid((0, 0.665, 0.115), (0.062, 0.088, 0.062))
"""What long hair leaves free."""


def head(jaw: float = 1.0, aged: bool = False) -> Field:
    """Neck, skull, face with its nose, ears; `jaw` is the breadth of the chin."""
    cranium = ellipsoid((0, 0.705, -0.010), (0.075, 0.093, 0.092))
    face = ellipsoid((0, 0.658, 0.024), (0.059, 0.074, 0.066))
    chin = ellipsoid((0, 0.607, 0.046), (0.040 * jaw, 0.030, 0.044))
    skull = union(0.03, union(0.045, cranium, face), chin)
    neck = capsule((0, 0.47, -0.018), (0, 0.62, -0.012), (0.054, 0.044))
    nose = capsule((0, 0.694, 0.082), (0, 0.665, 0.100), (0.007, 0.0125 if aged else 0.0115))
    lobe = ellipsoid((0.076, 0.680, -0.006), (0.012, 0.034 if aged else 0.030, 0.018))
    return union(0.012, union(0.014, skull, neck), nose, mirrored(lobe))


def head_of(look: Look) -> Field:
    """The bare head of a look."""
    return head(JAWS[look.figure], look.age == "old")


def short() -> Field:
    """A cap from the hairline to the nape."""
    return intersection(0.02, _CAP, _HAIRLINE)


def balding() -> Field:
    """A wreath around a bare crown."""
    wreath = intersection(
        0.012, swollen(_CAP, -0.004), half_space((0, 0.735, 0), (0, 1, 0.25)), half_space((0, 0, 0.035), (0, 0, 1))
    )
    return intersection(0.012, wreath, half_space((0, 0.655, 0), (0, -1, 0)))


def swept() -> Field:
    """Short, with a full parting over the brow."""
    lock = ellipsoid((-0.012, 0.784, 0.052), (0.066, 0.026, 0.044))
    return union(0.02, short(), lock)


def curly() -> Field:
    """Thick curls all around."""
    mass = ellipsoid((0, 0.724, -0.018), (0.112, 0.112, 0.114))
    whole = difference(0.02, mass, _FACE)
    shaped = intersection(0.02, whole, half_space((0, 0.742, 0.09), (0, -1.0, 0.80)))
    return lambda p: shaped(p) + _curls(p)


def _curls(p: Array) -> Array:
    wave = np.sin(150 * p[..., 0]) * np.sin(150 * p[..., 1]) * np.sin(150 * p[..., 2])
    return np.asarray(-0.006 * wave)


def bob() -> Field:
    """To the chin, with a fringe."""
    mass = union(0.03, swollen(_CAP, 0.006), ellipsoid((0, 0.655, -0.028), (0.093, 0.068, 0.082)))
    opened = difference(0.012, mass, _FACE, half_space((0, 0.600, 0), (0, 1, 0)))
    return difference(0.012, opened, ellipsoid((0, 0.612, 0.09), (0.055, 0.10, 0.10)))


def long() -> Field:
    """Down to the shoulder blades."""
    fall = union(
        0.03,
        ellipsoid((0, 0.640, -0.045), (0.090, 0.090, 0.066)),
        capsule((0.035, 0.62, -0.072), (0.045, 0.46, -0.112), (0.046, 0.030)),
        capsule((-0.035, 0.62, -0.072), (-0.045, 0.46, -0.112), (0.046, 0.030)),
    )
    mass = union(0.035, swollen(_CAP, 0.006), fall)
    parted = difference(0.012, mass, _FACE, ellipsoid((0, 0.60, 0.08), (0.066, 0.12, 0.10)))
    return intersection(0.012, parted, half_space((0, 0.752, 0.095), (0, -1.0, 0.9)))


def ponytail() -> Field:
    """Drawn back, and down behind."""
    tail = union(
        0.02,
        ellipsoid((0, 0.735, -0.118), (0.028, 0.026, 0.026)),
        capsule((0, 0.728, -0.132), (0, 0.60, -0.150), (0.028, 0.018)),
    )
    return union(0.015, intersection(0.02, swollen(_CAP, -0.002), _HAIRLINE), tail)


def bun() -> Field:
    """Drawn back into a knot."""
    knot = ellipsoid((0, 0.775, -0.098), (0.042, 0.040, 0.038))
    return union(0.014, intersection(0.02, swollen(_CAP, -0.002), _HAIRLINE), knot)


HAIRSTYLES: Final[dict[str, Callable[[], Field]]] = {
    "balding": balding,
    "short": short,
    "swept": swept,
    "curly": curly,
    "bob": bob,
    "long": long,
    "ponytail": ponytail,
    "bun": bun,
}
"""All but bald."""


def beard(face: Field) -> Field:
    """On chin and cheeks, and above the lip."""
    jaw = intersection(
        0.010,
        swollen(face, 0.008),
        half_space((0, 0.652, 0.06), (0, 1, -0.55)),
        half_space((0, 0.588, 0), (0, -1, -0.3)),
        half_space((0, 0, 0.008), (0, 0, -1)),
    )
    return intersection(0.006, jaw, ellipsoid((0, 0.62, 0.04), (0.075, 0.055, 0.085)))


def glasses() -> Field:
    """Two round frames, the bridge and the temples."""
    frame = ring((0.031, 0.686, 0.100), (0.18, 0, 1), 0.0240, (0.0034, 0.0034))
    bridge = capsule((0.0, 0.690, 0.105), (0.009, 0.689, 0.104), (0.0032, 0.0032))
    temple = capsule((0.054, 0.690, 0.096), (0.078, 0.694, 0.000), (0.0032, 0.0032))
    return mirrored(union(0.001, frame, bridge, temple))
