"""The parts of every category of furniture, scaled to a piece's box."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from scene_graphs.forms import decor, resting, standing
from scene_graphs.placed import Placed
from scene_graphs.solids import SOFT_ROLES, Part, Point3, inside

__all__ = ["FORMS", "SOFT_ROLES", "Part", "form_of", "parts", "parts_of"]

Form = Callable[[float, float, float], list[Part]]

_MEMBERS: tuple[tuple[Form, str], ...] = (
    (resting.chair, "chair dining_chair dressing_chair chinese_chair folding_chair"),
    (resting.office_chair, "office_chair"),
    (resting.stool, "stool barstool bench"),
    (resting.ottoman, "ottoman footstool bed_end_stool"),
    (resting.sofa, "sofa multi_seat_sofa loveseat_sofa sofa_bed armchair lounge_chair lazy_sofa"),
    (resting.l_shaped_sofa, "l_shaped_sofa"),
    (resting.chaise_longue, "chaise_longue_sofa"),
    (resting.bed, "bed double_bed single_bed kids_bed bed_frame"),
    (resting.bunk_bed, "bunk_bed"),
    (standing.table, "table dining_table console_table bar"),
    (standing.coffee_table, "coffee_table"),
    (standing.pedestal_table, "side_table corner_side_table round_end_table"),
    (standing.desk, "desk"),
    (standing.dressing_table, "dressing_table"),
    (standing.nightstand, "nightstand"),
    (
        standing.low_storage,
        "dresser sideboard tv_stand shoe_cabinet chest console children_cabinet kitchen_cabinet bathroom_cabinet",
    ),
    (standing.tall_storage, "wardrobe cabinet wine_cabinet refrigerator"),
    (standing.open_shelf, "bookshelf shelf wall_shelf"),
    (standing.counter, "kitchen_counter"),
    (decor.floor_lamp, "lamp floor_lamp"),
    (decor.table_lamp, "table_lamp"),
    (decor.pendant_lamp, "pendant_lamp"),
    (decor.ceiling_lamp, "ceiling_lamp wall_lamp"),
    (decor.plant, "plant"),
    (decor.vase, "vase"),
    (decor.screen, "tv television monitor"),
    (decor.picture, "painting picture"),
    (decor.mirror, "mirror"),
    (decor.rug, "rug"),
)
FORMS: dict[str, Form] = {category: form for form, members in _MEMBERS for category in members.split()}
"""What builds each category; every other category is one solid panel."""


def form_of(category: str) -> str:
    """The name of the form a category has: "chair", "sofa", "bed", "table", ..., "panel" if it has none."""
    return FORMS.get(category, standing.panel).__name__


def parts_of(placed: Placed) -> tuple[Part, ...]:
    """The boxes of an object, in its own frame: those measured from its mesh, or the form of its category."""
    return placed.shape or parts(placed.category, placed.size)


@lru_cache(maxsize=4096)
def parts(category: str, size: Point3) -> tuple[Part, ...]:
    """The boxes a piece of that category and size [w, h, d] is built of, in the piece's own frame.

    Tables and desks are hollow, chairs are seat, back and legs, beds mattress, headboard and pillows, shelves boards; a
    category without a form is one solid "panel". Every part lies within the piece's box. Roles in `SOFT_ROLES` are
    drawn but no obstacle. ValueError if an extent is not positive.
    """
    if not all(extent > 0 for extent in size):
        raise ValueError(f"size of a {category} must be three positive lengths in metres, got {size}")
    return inside(FORMS.get(category, standing.panel)(*size), size) or tuple(standing.panel(*size))
