"""Forms of tables and storage: hollow tables with leg room, cupboards as solid boxes, shelves of boards."""

from __future__ import annotations

from scene_graphs.solids import Part, box, ends, legs

WORK_HEIGHT = 0.75
"""Above this a desk or dressing table carries something on its back edge, which is no working surface."""


def panel(w: float, h: float, d: float) -> list[Part]:
    """One solid box."""
    return [box("panel", (-w / 2, w / 2), (0, h), (-d / 2, d / 2))]


def table(w: float, h: float, d: float) -> list[Part]:
    """A top on four legs."""
    return [
        box("top", (-w / 2, w / 2), (h - 0.04, h), (-d / 2, d / 2)),
        *legs(w, h - 0.04, d, min(0.06, 0.15 * min(w, d)), min(0.04, 0.05 * min(w, d))),
    ]


def coffee_table(w: float, h: float, d: float) -> list[Part]:
    """A top on four legs with a board below."""
    return [
        box("top", (-w / 2, w / 2), (h - 0.04, h), (-d / 2, d / 2)),
        box("shelf", (-w / 2 + 0.06, w / 2 - 0.06), (0.3 * h, 0.3 * h + 0.02), (-d / 2 + 0.05, d / 2 - 0.05)),
        *legs(w, h - 0.04, d, min(0.06, 0.15 * min(w, d)), 0.015),
    ]


def pedestal_table(w: float, h: float, d: float) -> list[Part]:
    """A top on a post and a foot."""
    post = min(0.035, 0.1 * min(w, d))
    foot_x, foot_z = 0.28 * w, 0.28 * d
    return [
        box("top", (-w / 2, w / 2), (h - 0.03, h), (-d / 2, d / 2)),
        box("pole", (-post, post), (0.025, h - 0.03), (-post, post)),
        box("leg", (-foot_x, foot_x), (0, 0.025), (-foot_z, foot_z)),
    ]


def desk(w: float, h: float, d: float) -> list[Part]:
    """A top with drawers at one side, leg room at the other, and a hutch where the piece is taller than a desk."""
    top = min(h, WORK_HEIGHT) if h > 0.85 else h
    drawers = min(0.42, max(0.0, w - 0.68))
    built = [
        box("top", (-w / 2, w / 2), (top - 0.04, top), (-d / 2, d / 2)),
        box("panel", (-w / 2 + 0.02, -w / 2 + 0.05), (0, top - 0.04), (-d / 2 + 0.02, d / 2 - 0.03)),
        box(
            "drawers",
            (w / 2 - 0.02 - max(drawers, 0.03), w / 2 - 0.02),
            (0.04, top - 0.04),
            (-d / 2 + 0.02, d / 2 - 0.03),
        ),
        box(
            "panel",
            (-w / 2 + 0.05, w / 2 - 0.02 - max(drawers, 0.03)),
            (0.35, top - 0.04),
            (-d / 2 + 0.02, -d / 2 + 0.04),
        ),
    ]
    hutch = min(0.22, 0.35 * d)
    if h > top + 0.1:
        back = -d / 2 + 0.02
        built += [
            box("panel", (-w / 2, w / 2), (top, h), (-d / 2, back)),
            *(box("panel", x, (top, h), (back, -d / 2 + hutch)) for x in ends(w, 0.025)),
            *(
                box("shelf", (-w / 2 + 0.025, w / 2 - 0.025), (y - 0.025, y), (back, -d / 2 + hutch))
                for y in _heights(top, h)
            ),
        ]
    return built


def dressing_table(w: float, h: float, d: float) -> list[Part]:
    """A desk with a mirror on its back edge where it is tall enough for one."""
    top = min(h, WORK_HEIGHT) if h > 0.85 else h
    built = [
        box("top", (-w / 2, w / 2), (top - 0.04, top), (-d / 2, d / 2)),
        box("drawers", (-w / 2 + 0.02, w / 2 - 0.02), (top - 0.15, top - 0.04), (-d / 2 + 0.02, d / 2 - 0.03)),
        *legs(w, top - 0.15, d, 0.045, 0.025),
    ]
    if h > top + 0.1:
        built.append(box("mirror", (-0.34 * w, 0.34 * w), (top + 0.02, h), (-d / 2, -d / 2 + 0.03)))
        built.append(box("pole", (-0.06, 0.06), (top, top + 0.02), (-d / 2, -d / 2 + 0.06)))
    return built


def nightstand(w: float, h: float, d: float) -> list[Part]:
    """Drawers under a top, on short legs."""
    foot = min(0.12, 0.25 * h)
    return [
        box("top", (-w / 2, w / 2), (h - 0.025, h), (-d / 2, d / 2)),
        box("drawers", (-w / 2 + 0.01, w / 2 - 0.01), (foot, h - 0.025), (-d / 2, d / 2 - 0.012)),
        *legs(w, foot, d, 0.04, 0.02),
    ]


def low_storage(w: float, h: float, d: float) -> list[Part]:
    """A closed body under a top, on short legs: dressers, sideboards, consoles."""
    foot = min(0.09, 0.2 * h)
    return [
        box("top", (-w / 2, w / 2), (h - 0.025, h), (-d / 2, d / 2)),
        box("doors", (-w / 2 + 0.012, w / 2 - 0.012), (foot, h - 0.025), (-d / 2, d / 2 - 0.012)),
        *legs(w, foot, d, 0.05, 0.03),
    ]


def tall_storage(w: float, h: float, d: float) -> list[Part]:
    """A closed body to the full height on a plinth that leaves room for toes: wardrobes, cabinets, refrigerators."""
    return [
        box("doors", (-w / 2, w / 2), (0.07, h), (-d / 2, d / 2)),
        box("panel", (-w / 2 + 0.01, w / 2 - 0.01), (0, 0.07), (-d / 2, d / 2 - 0.05)),
    ]


def open_shelf(w: float, h: float, d: float) -> list[Part]:
    """Sides, a thin back and boards every 0.30 to 0.38 m."""
    side, back = min(0.03, 0.1 * w), min(0.015, 0.1 * d)
    inner = w / 2 - side
    boards = [0.09, *_heights(0.09, h - 0.03), h] if h > 0.5 else [0.06, h]
    return [
        *(box("panel", x, (0, h), (-d / 2, d / 2)) for x in ends(w, side)),
        box("panel", (-inner, inner), (0.02, h), (-d / 2, -d / 2 + back)),
        *(box("shelf", (-inner, inner), (y - 0.03, y), (-d / 2 + back, d / 2 - 0.006)) for y in boards),
    ]


def counter(w: float, h: float, d: float) -> list[Part]:
    """A straight kitchen run: worktop over closed cupboards with room for toes."""
    return [
        box("top", (-w / 2, w / 2), (h - 0.04, h), (-d / 2, d / 2)),
        box("doors", (-w / 2, w / 2), (0.1, h - 0.04), (-d / 2, d / 2 - 0.03)),
        box("panel", (-w / 2, w / 2), (0, 0.1), (-d / 2, d / 2 - 0.08)),
    ]


def _heights(low: float, high: float) -> list[float]:
    """Tops of the boards strictly between two heights, evenly and about 0.34 m apart."""
    count = max(1, round((high - low) / 0.34))
    return [low + (high - low) * step / count for step in range(1, count)]
