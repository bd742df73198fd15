"""Garments and bare limbs as fields: cut to a figure, long or short, wide or close, open or closed in front.

Frame: the reference skeleton's T-pose, pelvis at the origin, facing +Z, left is +X, metres. Limbs are the left ones.
"""

from __future__ import annotations

from dataclasses import dataclass

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
    tube,
    union,
)

SHORT_SLEEVE, LONG_SLEEVE = 0.36, 0.715
"""Where sleeves end, along the arm."""
WIDE = 0.009
"""Metres that what is cut wide is wider."""
_SLEEVE = (
    (0.10, 0.455, -0.002, 0.048, 0.058),
    (0.17, 0.468, 0.000, 0.052, 0.059),
    (0.24, 0.481, 0.000, 0.051, 0.055),
    (0.36, 0.485, 0.000, 0.051, 0.053),
    (0.472, 0.485, 0.000, 0.046, 0.047),
    (0.60, 0.485, 0.001, 0.042, 0.044),
    (0.715, 0.485, 0.001, 0.032, 0.037),
)
_TORSO = (
    (0.000, 0, 0.000, 0.170, 0.114),
    (0.06, 0, 0.001, 0.156, 0.107),
    (0.14, 0, 0.003, 0.132, 0.096),
    (0.25, 0, 0.004, 0.145, 0.105),
    (0.35, 0, 0.005, 0.160, 0.110),
    (0.42, 0, 0.001, 0.155, 0.101),
    (0.47, 0, -0.006, 0.120, 0.080),
    (0.545, 0, -0.012, 0.068, 0.062),
)
_SKIRT = (
    (-0.375, 0, 0.004, 0.205, 0.122),
    (-0.25, 0, 0.002, 0.196, 0.120),
    (-0.10, 0, -0.004, 0.182, 0.118),
    (-0.03, 0, -0.006, 0.170, 0.117),
    (0.04, 0, -0.001, 0.152, 0.104),
    (0.10, 0, 0.001, 0.138, 0.098),
)
_LEG = (
    (-0.840, 0.088, -0.004, 0.034, 0.038),
    (-0.70, 0.088, -0.010, 0.040, 0.044),
    (-0.58, 0.089, -0.017, 0.047, 0.052),
    (-0.50, 0.088, -0.012, 0.046, 0.051),
    (-0.4165, 0.088, 0.000, 0.049, 0.053),
    (-0.30, 0.089, 0.005, 0.059, 0.063),
    (-0.15, 0.092, 0.003, 0.072, 0.075),
)
BUST = (0.066, 0.335, 0.082)
"""The middle of what is modelled of the left breast."""


@dataclass(frozen=True)
class Fit:
    """How a top is cut."""

    sleeve: float = SHORT_SLEEVE
    bust: float = 0.0
    """Metres that the breast stands out; 0 for none."""
    wide: float = 0.0
    """Metres wider than close."""


def top(fit: Fit) -> Field:
    """Chest and waist, shoulders, sleeves."""
    torso = tube(1, _TORSO, power=2.4, rounding=0.04)
    slope = capsule((0.035, 0.508, -0.014), (0.150, 0.468, -0.004), (0.045, 0.044))
    sleeve = tube(0, [row for row in _SLEEVE if row[0] <= fit.sleeve], rounding=0.035 if fit.sleeve < 0.5 else 0.012)
    whole = union(0.05, torso, mirrored(slope), mirrored(sleeve))
    if fit.bust:
        half = (0.066, 0.068, 0.028 + fit.bust)
        whole = union(0.045, whole, mirrored(ellipsoid(BUST, half)))
    return swollen(whole, fit.wide)


def tunic(upper: Field, trousers: Field, hem: float) -> Field:
    """A top that goes on over the hips of trousers, down to a hem."""
    hips = intersection(0.008, swollen(trousers, 0.009), half_space((0, hem, 0), (0, -1, 0)))
    between = ellipsoid((0, hem + 0.055, 0), (0.12, 0.055, 0.085))
    return union(0.03, upper, hips, between)


def open_front(field: Field, neck: float, width: float) -> Field:
    """A garment cut open along the front from a neckline's bottom to the hem, and in a V above it."""
    deep = 0.30
    slot = intersection(
        0.004,
        half_space((width, 0, 0), (1, 0, 0)),
        half_space((-width, 0, 0), (-1, 0, 0)),
        half_space((0, neck, 0), (0, 1, 0)),
        half_space((0, 0, 0.02), (0, 0, -1)),
    )
    wedge = intersection(
        0.004,
        half_space((width, neck - 0.01, 0), (1, -0.36, 0)),
        half_space((-width, neck - 0.01, 0), (-1, -0.36, 0)),
        half_space((0, neck - 0.01, 0), (0, -1, 0)),
        half_space((0, 0, 0.02), (0, 0, -1)),
        half_space((0, neck + deep, 0), (0, 1, 0)),
    )
    return difference(0.014, field, slot, wedge)


def skirt() -> Field:
    """From the waist to above the knee."""
    return tube(1, _SKIRT, power=2.2, rounding=0.02)


def coat_skirt() -> Field:
    """The lower half of a coat."""
    return swollen(tube(1, [row for row in _SKIRT if row[0] >= -0.25], power=2.2, rounding=0.02), 0.010)


def bare_leg() -> Field:
    """From inside a skirt to inside a shoe."""
    return tube(1, _LEG, rounding=0.015)


def shorts(trousers: Field) -> Field:
    """Trousers that end above the knee."""
    return intersection(0.006, trousers, half_space((0, -0.33, 0), (0, -1, 0)))


def collar() -> Field:
    """Round the neck of a shirt, its points in front."""
    band = ring((0, 0.545, -0.010), (0, 1, 0.22), 0.063, (0.010, 0.017))
    point = capsule((0.022, 0.520, 0.052), (0.045, 0.494, 0.066), (0.012, 0.008))
    return union(0.012, band, mirrored(point))


def tie() -> Field:
    """Knot and blade down the chest."""
    knot = ellipsoid((0, 0.508, 0.068), (0.016, 0.016, 0.012))
    blade = tube(
        1,
        [
            (0.12, 0, 0.102, 0.006, 0.006),
            (0.15, 0, 0.104, 0.026, 0.006),
            (0.25, 0, 0.112, 0.024, 0.006),
            (0.35, 0, 0.117, 0.020, 0.006),
            (0.42, 0, 0.106, 0.016, 0.006),
            (0.48, 0, 0.084, 0.012, 0.006),
            (0.51, 0, 0.066, 0.010, 0.006),
        ],
        power=3.0,
        rounding=0.004,
    )
    return union(0.008, knot, blade)


def belt() -> Field:
    """Round the waist, where a skirt begins."""
    return tube(1, [(0.085, 0, 0.001, 0.150, 0.110), (0.12, 0, 0.002, 0.145, 0.106)], power=2.3, rounding=0.008)


def hood(wide: float) -> Field:
    """Lying on the back of the neck."""
    roll = ring((0, 0.505, -0.045), (0, 1, 0.62), 0.082, (0.030 + wide / 2, 0.026))
    return intersection(0.02, roll, half_space((0, 0, 0.055), (0, 0, 1)))


def bib(base: Field, floor: float) -> Field:
    """The front of dungarees, a pinafore or an apron, and the straps that carry it, on what is worn under it."""
    front = intersection(
        0.006,
        half_space((0.122, 0, 0), (1, 0.10, 0)),
        half_space((-0.122, 0, 0), (-1, 0.10, 0)),
        half_space((0, 0.345, 0), (0, 1, 0)),
        half_space((0, 0, 0.02), (0, 0, -1)),
    )
    strap = intersection(
        0.004,
        half_space((0.094, 0, 0), (1, 0, 0)),
        half_space((0.062, 0, 0), (-1, 0, 0)),
        half_space((0, 0.33, 0.10), (0, -1, 1.4)),  # lower behind than in front
    )
    outline = union(0.004, front, half_space((0, 0.10, 0), (0, 1, 0)), mirrored(strap))
    return intersection(0.006, swollen(base, 0.007), outline, half_space((0, floor, 0), (0, -1, 0)))


def apron_skirt(base: Field) -> Field:
    """An apron below the waist, in front."""
    return intersection(0.006, swollen(base, 0.009), half_space((0, 0, 0.03), (0, 0, -1)))


def neckline() -> Field:
    """The light edges of a tunic's V, and those of its sleeves."""
    edge = capsule((0.004, 0.405, 0.108), (0.052, 0.530, 0.050), (0.009, 0.009))
    cuff = ring((SHORT_SLEEVE - 0.012, 0.485, 0.0), (1, 0, 0), 0.052, (0.010, 0.007))
    return union(0.004, mirrored(edge), mirrored(cuff))


def placket(wide: float) -> Field:
    """The strip of buttons down the front."""
    return tube(
        1,
        [
            (0.03, 0, 0.108 + wide, 0.012, 0.006),
            (0.14, 0, 0.099 + wide, 0.012, 0.006),
            (0.25, 0, 0.109 + wide, 0.012, 0.006),
            (0.35, 0, 0.115 + wide, 0.012, 0.006),
            (0.42, 0, 0.103 + wide, 0.012, 0.006),
            (0.50, 0, 0.072 + wide, 0.012, 0.006),
        ],
        power=3.0,
        rounding=0.004,
    )


def badge(base: Field) -> Field:
    """On the left of the chest."""
    return intersection(
        0.003,
        swollen(base, 0.005),
        half_space((0.105, 0, 0), (1, 0, 0)),
        half_space((0.060, 0, 0), (-1, 0, 0)),
        half_space((0, 0.405, 0), (0, 1, 0)),
        half_space((0, 0.375, 0), (0, -1, 0)),
        half_space((0, 0, 0.02), (0, 0, -1)),
    )
