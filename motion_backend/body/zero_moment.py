"""The zero-moment point of a moving body, and how far it is from the soles that carry (Vukobratovic and Borovac 2004).

It is where on the floor the force that moves the centre of mass as it moves would have to act. While it is inside the
hull of the planted soles, feet alone can give that force; outside, the body would have to fall. The body counts as one
mass: what its limbs turn by themselves is left out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend.rotations import Array

GRAVITY = 9.81
"""m/s²."""
SMOOTHED = 0.05
"""Standard deviation (s) of the bell that the centre of mass is smoothed by before it is differentiated twice: where a
recorded body is known to 2 mm, its acceleration at 30 frames a second is not known at all."""
LEAST_WEIGHT = 2.0
"""A body that falls so fast that it presses on the floor with less than this (m/s²) is in the air."""


def accelerations(centres: Array, fps: float) -> tuple[Array, Array]:
    """The smoothed way of a centre of mass and its acceleration. (T, 3) metres to (T, 3) and (T, 3) m/s²."""
    if len(centres) < 3:
        return centres, np.zeros_like(centres)
    from scipy.ndimage import gaussian_filter1d

    smooth = np.asarray(gaussian_filter1d(centres, SMOOTHED * fps, axis=0, mode="nearest"))
    rate = np.gradient(np.gradient(smooth, axis=0), axis=0) * fps**2
    return smooth, np.asarray(rate)


def zero_moment_points(centres: Array, fps: float) -> Array:
    """Where on the floor the zero-moment point is. Centres of mass (T, 3), Y above the floor, to (T, 2) x and z."""
    smooth, rate = accelerations(centres, fps)
    weight = np.maximum(rate[:, 1] + GRAVITY, LEAST_WEIGHT)
    return np.asarray(smooth[:, [0, 2]] - (smooth[:, 1] / weight)[:, None] * rate[:, [0, 2]])


def nearest_in_hull(points: Array, corners: Array, carries: NDArray[np.bool_]) -> Array:
    """The place nearest to each point in the convex hull of the corners that carry, of its frame. (T, 2) metres.

    Points (T, 2), corners (T, N, 2), carries (T, N). A point inside stays; where nothing carries it is not a number.
    """
    somewhere = np.asarray(carries.any(axis=1))
    # What does not carry takes the place of a corner that does: hulls of all frames then have as many corners.
    stand_in = np.take_along_axis(corners, carries.argmax(axis=1)[:, None, None], axis=1)
    hull = np.where(carries[..., None], corners, stand_in)
    nearest = _nearest_on_lines(points, hull)
    nearest = np.where(_surrounded(points, hull)[:, None], points, nearest)
    return np.where(somewhere[:, None], nearest, np.nan)


def _nearest_on_lines(points: Array, hull: Array) -> Array:
    """The nearest place on any line between two corners, of which the edges of the hull are some. (T, 2)."""
    first, second = np.triu_indices(hull.shape[1], 1)
    start, edge = hull[:, first], hull[:, second] - hull[:, first]
    along = ((points[:, None] - start) * edge).sum(axis=-1) / np.maximum((edge**2).sum(axis=-1), 1e-12)
    places = start + np.clip(along, 0.0, 1.0)[..., None] * edge
    best = ((places - points[:, None]) ** 2).sum(axis=-1).argmin(axis=1)
    return np.asarray(np.take_along_axis(places, best[:, None, None], axis=1)[:, 0])


def _surrounded(points: Array, hull: Array) -> NDArray[np.bool_]:
    """Whether corners are on all sides of a point: no gap between their directions is half a circle. (T,)."""
    towards = hull - points[:, None]
    angles = np.sort(np.arctan2(towards[..., 1], towards[..., 0]), axis=1)
    gaps = np.diff(angles, axis=1, append=angles[:, :1] + 2 * np.pi)
    return np.asarray(gaps.max(axis=1) < np.pi)
