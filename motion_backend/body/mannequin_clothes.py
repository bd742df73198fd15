"""The shapes of the mannequin, one field a garment, limb or feature.

Frame: the reference skeleton's T-pose, pelvis at the origin, facing +Z, left is +X, metres. Limbs are the left ones.
"""

from __future__ import annotations

from motion_backend.body.implicit_surface import (
    Field,
    capsule,
    ellipsoid,
    half_space,
    intersection,
    mirrored,
    tube,
    union,
)

SOLE = -0.9005
"""Height of the ground under the standing body."""
_LAST = (
    (-0.060, 0.088, -0.868, 0.031, 0.034),
    (-0.030, 0.088, -0.862, 0.036, 0.040),
    (0.000, 0.088, -0.862, 0.037, 0.042),
    (0.060, 0.089, -0.868, 0.041, 0.037),
    (0.120, 0.091, -0.876, 0.045, 0.030),
    (0.165, 0.091, -0.882, 0.040, 0.024),
    (0.188, 0.090, -0.886, 0.028, 0.017),
)
"""Stations of the shoe's tube from heel to toe."""


def trousers() -> Field:
    """Hips, seat and both legs, down to the hems."""
    hips = tube(
        1,
        [
            (-0.10, 0, -0.008, 0.075, 0.065),
            (-0.05, 0, -0.002, 0.145, 0.098),
            (0.00, 0, 0.000, 0.158, 0.101),
            (0.05, 0, 0.000, 0.149, 0.099),
            (0.10, 0, 0.000, 0.136, 0.095),
        ],
        power=2.3,
    )
    leg = tube(
        1,
        [
            (-0.840, 0.088, -0.004, 0.051, 0.056),
            (-0.70, 0.088, -0.010, 0.047, 0.052),
            (-0.58, 0.089, -0.017, 0.054, 0.060),
            (-0.50, 0.088, -0.012, 0.055, 0.060),
            (-0.4165, 0.088, 0.000, 0.056, 0.060),
            (-0.30, 0.089, 0.005, 0.066, 0.070),
            (-0.15, 0.092, 0.003, 0.079, 0.082),
            (-0.04, 0.090, -0.002, 0.083, 0.088),
            (0.02, 0.080, 0.000, 0.080, 0.085),
        ],
        rounding=0.035,
    )
    seat = ellipsoid((0.072, -0.045, -0.045), (0.080, 0.075, 0.060))
    return union(0.035, hips, mirrored(leg), mirrored(seat))


def shirt() -> Field:
    """Chest and waist, shoulders, short sleeves."""
    torso = tube(
        1,
        [
            (0.000, 0, 0.000, 0.170, 0.114),
            (0.06, 0, 0.001, 0.156, 0.107),
            (0.14, 0, 0.003, 0.132, 0.096),
            (0.25, 0, 0.004, 0.145, 0.105),
            (0.35, 0, 0.005, 0.160, 0.110),
            (0.42, 0, 0.001, 0.155, 0.101),
            (0.47, 0, -0.006, 0.120, 0.080),
            (0.545, 0, -0.012, 0.068, 0.062),
        ],
        power=2.4,
        rounding=0.04,
    )
    slope = capsule((0.035, 0.508, -0.014), (0.150, 0.468, -0.004), (0.045, 0.044))
    sleeve = tube(
        0,
        [
            (0.10, 0.455, -0.002, 0.048, 0.058),
            (0.17, 0.468, 0.000, 0.052, 0.059),
            (0.24, 0.481, 0.000, 0.051, 0.055),
            (0.360, 0.485, 0.000, 0.051, 0.053),
        ],
        rounding=0.035,
    )
    return union(0.05, torso, mirrored(slope), mirrored(sleeve))


def _skull() -> Field:
    cranium = ellipsoid((0, 0.705, -0.010), (0.075, 0.093, 0.092))
    face = ellipsoid((0, 0.658, 0.024), (0.059, 0.074, 0.066))
    jaw = ellipsoid((0, 0.612, 0.040), (0.041, 0.032, 0.046))
    return union(0.03, union(0.045, cranium, face), jaw)


def head() -> Field:
    """Neck, skull, face with its nose, ears."""
    neck = capsule((0, 0.47, -0.018), (0, 0.62, -0.012), (0.054, 0.046))
    nose = capsule((0, 0.692, 0.084), (0, 0.663, 0.099), (0.007, 0.0115))
    ear = ellipsoid((0.075, 0.680, -0.006), (0.012, 0.030, 0.018))
    return union(0.012, union(0.022, _skull(), neck), nose, mirrored(ear))


def hair() -> Field:
    """A cap from the hairline to the nape."""
    cap = ellipsoid((0, 0.705, -0.012), (0.085, 0.102, 0.101))
    return intersection(0.02, cap, half_space((0, 0.748, 0.085), (0, -1.0, 0.74)))


def eyes() -> Field:
    """The left eye."""
    return ellipsoid((0.028, 0.689, 0.0825), (0.0085, 0.0120, 0.0080))


def brows() -> Field:
    """The left eyebrow."""
    return capsule((0.018, 0.7170, 0.0868), (0.043, 0.7155, 0.0765), (0.0055, 0.0042))


def arm() -> Field:
    """The bare arm from inside the sleeve to inside the hand."""
    return tube(
        0,
        [
            (0.30, 0.485, 0.000, 0.042, 0.043),
            (0.40, 0.485, 0.001, 0.040, 0.041),
            (0.472, 0.485, 0.000, 0.038, 0.038),
            (0.53, 0.485, 0.001, 0.039, 0.040),
            (0.62, 0.485, 0.001, 0.033, 0.035),
            (0.70, 0.485, 0.000, 0.025, 0.030),
            (0.755, 0.484, 0.000, 0.019, 0.029),
        ],
        rounding=0.015,
    )


def hand() -> Field:
    """Palm down, thumb forward, fingers side by side and curled as those of a hand at rest, the little one most."""
    palm = tube(
        0,
        [
            (0.705, 0.485, 0.000, 0.021, 0.026),
            (0.745, 0.484, 0.000, 0.021, 0.034),
            (0.785, 0.481, 0.001, 0.018, 0.042),
            (0.815, 0.478, 0.001, 0.015, 0.042),
            (0.828, 0.476, 0.001, 0.012, 0.040),
        ],
        power=2.4,
        rounding=0.012,
    )
    fingers = [
        union(
            0.002,
            capsule((0.805, 0.479, z), (x - 0.036, 0.472, z + 0.4 * fan), (0.0100, 0.0092)),
            capsule((x - 0.036, 0.472, z + 0.4 * fan), (x, tip, z + fan), (0.0092, 0.0075)),
        )
        for z, fan, x, tip in (
            (0.033, 0.002, 0.874, 0.455),
            (0.012, 0.000, 0.881, 0.452),
            (-0.010, 0.000, 0.874, 0.449),
            (-0.031, -0.001, 0.854, 0.447),
        )
    ]
    thumb = union(
        0.005,
        capsule((0.735, 0.480, 0.018), (0.778, 0.470, 0.054), (0.018, 0.015)),
        capsule((0.778, 0.470, 0.054), (0.815, 0.464, 0.064), (0.015, 0.011)),
    )
    return union(0.012, union(0.006, palm, *fingers), thumb)


def shoe() -> Field:
    """The upper of a shoe."""
    foot = tube(2, _LAST, power=2.5, rounding=0.016)
    ankle = capsule((0.088, -0.850, -0.008), (0.088, -0.790, -0.006), (0.041, 0.040))
    return intersection(0.006, union(0.03, foot, ankle), half_space((0, SOLE + 0.008, 0), (0, -1, 0)))


def sole() -> Field:
    """The slab under it, a little wider."""
    widened = [(z * 1.03, x, y, u + 0.004, v + 0.006) for z, x, y, u, v in _LAST]
    slab = intersection(0.004, half_space((0, SOLE, 0), (0, -1, 0)), half_space((0, SOLE + 0.017, 0), (0, 1, 0)))
    return intersection(0.006, tube(2, widened, power=2.5, rounding=0.016), slab)
