"""Every category of furniture has the form, the places to use it and the looks that somebody last looked at."""

from __future__ import annotations

from typing import Any

import numpy as np
from recorded import agrees

from scene_graphs.affordances.affordances import spots
from scene_graphs.affordances.spot import Spot, spot_to_dict
from scene_graphs.furniture import affordances, catalogue, class_of, group_of, is_minor, typical_size
from scene_graphs.furniture_shapes import form_of, parts
from scene_graphs.layout import Placed
from scene_graphs.meshes.convex_shapes import shapes_of
from scene_graphs.meshes.furniture_mesh import furniture_meshes
from scene_graphs.meshes.mesh_primitives import Mesh


def test_furniture_is_as_recorded() -> None:
    categories = list(catalogue().categories)
    forms = {form_of(category): category for category in reversed(categories)}
    found = {category: told(category) for category in categories}
    agrees("furniture", {"categories": found, "forms": {form: boxes(forms[form]) for form in sorted(forms)}})


def boxes(category: str) -> dict[str, list[float]]:
    """Both corners of every part."""
    there = parts(category, typical_size(category))
    return {f"{number} {part.role}": short(*part.low, *part.high) for number, part in enumerate(there)}


def told(category: str) -> dict[str, Any]:
    """One piece of a category, standing at the origin."""
    size = typical_size(category)
    placed = Placed("it", category, (0.0, 0.0, 0.0), size)
    words = [class_of(category), group_of(category), form_of(category), *["minor"] * is_minor(category)]
    return {
        "is": " | ".join([*words, *sorted(affordances(category))]),
        "size": short(*size),
        "spots": dict(row(spot) for need in sorted(affordances(category)) for spot in spots(placed, need)[::3]),
        "looks": measured(furniture_meshes(placed)),
        "solids": len(shapes_of(placed)),
    }


def row(spot: Spot) -> tuple[str, list[float]]:
    """What is done there and from where, and the numbers of a spot; what is endless is -1."""
    plain = [-1.0 if value is None else value for value in (spot_to_dict(spot) or {}).values()]
    numbers = [value if isinstance(value, tuple) else (value,) for value in plain if not isinstance(value, str)]
    where = f"{spot.affordance}, {spot.height}, from {short(*spot.standing)}"
    return where, short(*(number for several in numbers for number in several))


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]


def measured(meshes: list[Mesh]) -> list[float]:
    """Triangles of all looks, their area, the volume in them and the middle of their corners, in metres."""
    corners = np.concatenate([mesh.vertices.astype(np.float64)[mesh.faces] for mesh in meshes])  # (faces, 3, 3)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    volume = np.linalg.det(corners).sum() / 6
    return short(len(corners), area, volume, *corners.mean(axis=(0, 1)))
