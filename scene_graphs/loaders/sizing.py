"""The exact category of what a source only calls "bed" or "sofa", by its box."""

from __future__ import annotations

from scene_graphs.solids import Point3

SINGLE, LOVESEAT, CORNER = 1.30, 1.85, 1.60
"""A bed narrower than the first is single, a sofa narrower than the second a loveseat; one that is as deep as the third
has a corner. Metres."""
BARSTOOL, LOW, SMALL = 0.62, 0.55, 0.70
"""A stool this high is a barstool; a table lower than the second or narrower than the third is none to sit at."""
_HANGS, _STANDS = 1.4, 0.9


def exact_category(word: str, size: Point3, bottom: float = 0.0) -> str:
    """The category of a piece that has a generic name, its size [w, h, d] in metres and how high its bottom is.

    Any other word stays as it is.
    """
    short, height, long = min(size[0], size[2]), size[1], max(size[0], size[2])
    match word:
        case "bed":
            return "single_bed" if short < SINGLE else "double_bed"
        case "sofa":
            return "l_shaped_sofa" if short >= CORNER else "loveseat_sofa" if long < LOVESEAT else "multi_seat_sofa"
        case "chair":
            return "dining_chair"
        case "stool":
            return "barstool" if height >= BARSTOOL else "stool"
        case "table":
            return "side_table" if long <= SMALL else "coffee_table" if height < LOW else "dining_table"
        case "lamp":
            return "ceiling_lamp" if bottom > _HANGS else "floor_lamp" if height >= _STANDS else "table_lamp"
    return word
