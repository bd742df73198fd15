"""Fields are negative inside, blend without holes, and become closed surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from for_each import for_each

from motion_backend.body.implicit_surface import (
    capsule,
    ellipsoid,
    half_space,
    intersection,
    mirrored,
    to_triangles,
    tube,
    union,
)

BOX = ((-0.6, -0.6, -0.6), (0.6, 0.6, 0.6), (0.05, 0.06, 0.07))


def volume(vertices, faces) -> float:
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6)


def edge_counts(faces) -> np.ndarray:
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return np.unique(edges, axis=0, return_counts=True)[1]


@for_each(
    ("field", "expected"),
    [
        (ellipsoid((0, 0, 0), (0.4, 0.4, 0.4)), 4 / 3 * np.pi * 0.4**3),
        (ellipsoid((0.1, 0, 0), (0.4, 0.3, 0.2)), 4 / 3 * np.pi * 0.4 * 0.3 * 0.2),
        (capsule((0, -0.2, 0), (0, 0.2, 0), (0.2, 0.2)), np.pi * 0.04 * 0.4 + 4 / 3 * np.pi * 0.008),
        (tube(1, [(-0.4, 0, 0, 0.3, 0.3), (0.4, 0, 0, 0.3, 0.3)]), np.pi * 0.09 * 0.8),
    ],
)
def test_a_surface_is_closed_turned_outwards_and_holds_its_volume(field, expected):
    vertices, faces = to_triangles(field, *BOX)
    assert (edge_counts(faces) == 2).all()
    assert volume(vertices, faces) == pytest.approx(expected, rel=0.05)
    np.testing.assert_allclose(field(vertices), 0.0, atol=0.01)


def test_a_blend_holds_both_shapes_and_a_little_more_between_them():
    a, b = ellipsoid((-0.2, 0, 0), (0.2, 0.2, 0.2)), ellipsoid((0.2, 0, 0), (0.2, 0.2, 0.2))
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (500, 3))
    assert (union(0.1, a, b)(points) <= np.minimum(a(points), b(points)) + 1e-12).all()
    assert union(0.1, a, b)(np.array([[0.0, 0.01, 0.0]]))[0] < min(a(np.array([[0.0, 0.01, 0.0]]))[0], 0)


def test_an_intersection_holds_only_what_both_hold():
    ball, lower = ellipsoid((0, 0, 0), (0.4, 0.4, 0.4)), half_space((0, 0, 0), (0, 1, 0))
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (500, 3))
    assert (intersection(0.05, ball, lower)(points) >= np.maximum(ball(points), lower(points)) - 1e-12).all()


def test_mirroring_repeats_the_left_on_the_right():
    field = mirrored(ellipsoid((0.3, 0, 0), (0.1, 0.1, 0.1)))
    assert (field(np.array([[0.3, 0, 0], [-0.3, 0, 0]])) < 0).all()
    assert field(np.zeros((1, 3)))[0] > 0
