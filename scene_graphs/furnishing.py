"""Furniture and homes as solids and as meshes: the one door to what things are made of and what they look like."""

from __future__ import annotations

from scene_graphs.forms import SOFT_ROLES, Part, parts, parts_of
from scene_graphs.homes import Home
from scene_graphs.looks.dressing import furniture_meshes
from scene_graphs.looks.interiors import floor_meshes, wall_meshes
from scene_graphs.looks.shapes import Mesh

__all__ = ["SOFT_ROLES", "Mesh", "Part", "furniture_meshes", "home_meshes", "parts", "parts_of"]


def home_meshes(home: Home) -> list[Mesh]:
    """All of a home in its own frame: floors, walls with doors and windows, furniture; no ceilings to look through.

    Names begin with "floor", "wall", "door" or "window", those of furniture with "room/object" unless it hangs on a
    wall ("wall ...") or a ceiling ("ceiling ...") or is a rug ("rug ...").
    """
    return [
        *floor_meshes(home),
        *wall_meshes(home),
        *(mesh for placed in home.objects for mesh in furniture_meshes(placed)),
    ]
