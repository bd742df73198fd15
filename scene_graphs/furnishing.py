"""Furniture and homes as solids and meshes: the one door to what things are made of and look like."""

from __future__ import annotations

from scene_graphs.forms import SOFT_ROLES, Part, parts

__all__ = ["SOFT_ROLES", "Part", "parts"]
