"""The parts of every category of furniture, scaled to a piece's box.

Seats end where their back and arms begin, so a seat's own rectangle is free to sit on. Tables are hollow and have leg
room, cupboards are solid boxes, shelves are boards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from scene_graphs.boxes import SOFT_ROLES, Part, Point3, box, ends, inside, legs
from scene_graphs.layout import Placed


def chair(w: float, h: float, d: float) -> list[Part]:
    """Seat, a back with two posts, four legs."""
    seat, back = min(0.45, max(0.52 * h, 0.3 * h)), min(0.05, 0.12 * d)
    return [
        box("seat", (-w / 2, w / 2), (seat - 0.05, seat), (-d / 2 + back, d / 2)),
        box("back", (-w / 2, w / 2), (seat + 0.12, h), (-d / 2, -d / 2 + back)),
        *(box("back", xs, (seat - 0.05, seat + 0.12), (-d / 2, -d / 2 + back)) for xs in ends(w, 0.04)),
        *legs(w, seat - 0.05, d, min(0.04, 0.1 * w), 0.005),
    ]


def office_chair(w: float, h: float, d: float) -> list[Part]:
    """Padded seat on a post with a cross foot, arms where there is width for them."""
    seat, back = min(0.47, 0.52 * h), min(0.08, 0.16 * d)
    arm = 0.05 if w >= 0.52 else 0.0
    free = w / 2 - arm
    return [
        box("seat", (-free, free), (seat - 0.08, seat), (-d / 2 + back, d / 2 - 0.02)),
        box("back", (-free + 0.02, free - 0.02), (seat + 0.1, h), (-d / 2, -d / 2 + back)),
        box("pole", (-0.04, 0.04), (seat, seat + 0.12), (-d / 2 + 0.01, -d / 2 + back - 0.01)),
        *(box("arm", xs, (seat + 0.16, seat + 0.2), (-0.3 * d, 0.15 * d)) for xs in ends(w, arm)),
        *(box("pole", xs, (seat - 0.06, seat + 0.16), (-0.1 * d, -0.02 * d)) for xs in ends(w, arm)),
        box("pole", (-0.035, 0.035), (0.08, seat - 0.08), (-0.035, 0.035)),
        box("leg", (-0.42 * w, 0.42 * w), (0.02, 0.09), (-0.03, 0.03)),
        box("leg", (-0.03, 0.03), (0.02, 0.09), (-0.42 * d, 0.42 * d)),
    ]


def stool(w: float, h: float, d: float) -> list[Part]:
    """A seat at the piece's full height on four legs."""
    return [
        box("seat", (-w / 2, w / 2), (h - 0.07, h), (-d / 2, d / 2)),
        *legs(w, h - 0.07, d, min(0.045, 0.15 * min(w, d)), 0.02),
    ]


def ottoman(w: float, h: float, d: float) -> list[Part]:
    """A padded block."""
    return [
        box("seat", (-w / 2, w / 2), (h - 0.14, h), (-d / 2, d / 2)),
        box("base", (-w / 2 + 0.015, w / 2 - 0.015), (0.05, h - 0.14), (-d / 2 + 0.015, d / 2 - 0.015)),
        *legs(w, 0.05, d, 0.05, 0.04),
    ]


@dataclass(frozen=True)
class _Upholstery:
    """Measures every padded seat shares: seat height, seat depth before the back cushion, frame and arm thickness."""

    seat: float
    depth: float
    frame: float
    arm: float
    arm_top: float


def _upholstery(w: float, h: float, d: float) -> _Upholstery:
    seat = min(0.43, 0.55 * h)
    frame = min(0.18, 0.22 * d)
    depth = min(0.58, d - frame)
    arm = min(0.17, max(0.0, (w - 0.5) / 2)) if w < 1.2 else min(0.17, max(0.10, (w - 1.64) / 2))
    return _Upholstery(seat, depth, frame, arm, min(max(seat + 0.17, 0.6), 0.8 * h))


def sofa(w: float, h: float, d: float) -> list[Part]:
    """Seat between two arms, before a frame and back cushions; also armchairs."""
    u = _upholstery(w, h, d)
    free, seat_back, base = w / 2 - u.arm, d / 2 - u.depth, u.seat - 0.15
    return [
        box("seat", (-free, free), (base, u.seat), (seat_back, d / 2)),
        box("base", (-w / 2, w / 2), (0.07, base), (-d / 2, d / 2 - 0.01)),
        box("back", (-free, free), (base, h - 0.08), (-d / 2 + u.frame, seat_back)),
        box("back", (-w / 2, w / 2), (base, h), (-d / 2, -d / 2 + u.frame)),
        *(box("arm", xs, (base, u.arm_top), (-d / 2 + u.frame, d / 2)) for xs in ends(w, u.arm)),
        *legs(w, 0.07, d, 0.06, 0.05),
    ]


def l_shaped_sofa(w: float, h: float, d: float) -> list[Part]:
    """A sofa whose +x end runs forward as a chaise."""
    body = min(0.98, 0.62 * d)
    if d < 1.2 or w < 1.7:
        return sofa(w, h, d)
    u = _upholstery(w, h, body)
    front = -d / 2 + body
    seat_back, base, free = front - u.depth, u.seat - 0.15, w / 2 - u.arm
    chaise = free - min(0.78, 0.38 * w)
    return [
        box("seat", (-free, free), (base, u.seat), (seat_back, front)),
        box("seat", (chaise, free), (base, u.seat), (front, d / 2)),
        box("base", (-w / 2, w / 2), (0.07, base), (-d / 2, front - 0.01)),
        box("base", (chaise, free), (0.07, base), (front - 0.01, d / 2 - 0.01)),
        box("back", (-free, free), (base, h - 0.08), (-d / 2 + u.frame, seat_back)),
        box("back", (-w / 2, w / 2), (base, h), (-d / 2, -d / 2 + u.frame)),
        *(box("arm", xs, (base, u.arm_top), (-d / 2 + u.frame, front)) for xs in ends(w, u.arm)),
        *(box("leg", xs, (0, 0.07), (-d / 2 + 0.05, -d / 2 + 0.11)) for xs in ends(w - 0.1, 0.06)),
        box("leg", (-w / 2 + 0.05, -w / 2 + 0.11), (0, 0.07), (front - 0.11, front - 0.05)),
        *(box("leg", (x, x + 0.06), (0, 0.07), (d / 2 - 0.11, d / 2 - 0.05)) for x in (chaise + 0.05, free - 0.11)),
    ]


def chaise_longue(w: float, h: float, d: float) -> list[Part]:
    """Long in width: a back behind and one arm at its -x end. Long in depth: a back at the head end alone."""
    if w < d:
        return _daybed(w, h, d)
    u = _upholstery(w, h, d)
    seat_back, base, arm = d / 2 - u.depth, u.seat - 0.15, min(0.13, 0.1 * w)
    return [
        box("seat", (-w / 2 + arm, w / 2), (base, u.seat), (seat_back, d / 2)),
        box("base", (-w / 2, w / 2 - 0.01), (0.07, base), (-d / 2, d / 2 - 0.01)),
        box("back", (-w / 2 + arm, 0.2 * w), (base, h - 0.08), (-d / 2 + u.frame, seat_back)),
        box("back", (-w / 2, 0.2 * w), (base, h), (-d / 2, -d / 2 + u.frame)),
        box("back", (0.2 * w, w / 2), (base, u.seat + 0.12), (-d / 2, seat_back)),
        box("arm", (-w / 2, -w / 2 + arm), (base, u.arm_top), (-d / 2 + u.frame, d / 2)),
        *legs(w, 0.07, d, 0.06, 0.05),
    ]


def _daybed(w: float, h: float, d: float) -> list[Part]:
    seat, back = min(0.43, 0.6 * h), min(0.16, 0.12 * d)
    return [
        box("seat", (-w / 2, w / 2), (seat - 0.15, seat), (-d / 2 + back, d / 2)),
        box("base", (-w / 2 + 0.02, w / 2 - 0.02), (0.07, seat - 0.15), (-d / 2, d / 2 - 0.02)),
        box("back", (-w / 2, w / 2), (seat - 0.15, h), (-d / 2, -d / 2 + back)),
        *legs(w, 0.07, d, 0.06, 0.05),
    ]


def bed(w: float, h: float, d: float) -> list[Part]:
    """Mattress on a base, a headboard at -z, one or two pillows before it."""
    top, head = min(0.50, 0.4 * h + 0.10, 0.9 * h), min(0.08, 0.05 * d)
    back = -d / 2 + head
    pillow = min(0.68, 0.9 * w if w < 1.3 else 0.42 * w) / 2
    centers = (0.0,) if w < 1.3 else (-w / 4, w / 4)
    return [
        box("mattress", (-w / 2, w / 2), (top - 0.22, top), (back, d / 2)),
        box("base", (-w / 2 + 0.02, w / 2 - 0.02), (0.08, top - 0.22), (back, d / 2 - 0.02)),
        box("headboard", (-w / 2, w / 2), (0, h), (-d / 2, back)),
        *(box("pillow", (x - pillow, x + pillow), (top, top + 0.07), (back + 0.04, back + 0.46)) for x in centers),
        *legs(w, 0.08, d, 0.07, 0.06)[2:],
    ]


def bunk_bed(w: float, h: float, d: float) -> list[Part]:
    """Two mattresses between four posts; a low one is a bed."""
    if h < 1.45:
        return bed(w, h, d)
    post, built = 0.07, legs(w, h, d, 0.07)
    for top in (0.36, h - 0.26):
        built += [
            box("mattress", (-w / 2 + post, w / 2 - post), (top - 0.16, top), (-d / 2 + post, d / 2 - post)),
            box("base", (-w / 2 + post, w / 2 - post), (top - 0.22, top - 0.16), (-d / 2 + post, d / 2 - post)),
            box("pillow", (-0.3 * w, 0.3 * w), (top, top + 0.07), (-d / 2 + 0.1, -d / 2 + 0.46)),
        ]
    return built


def floor_lamp(w: float, h: float, d: float) -> list[Part]:
    """A foot, a pole and a shade."""
    shade = min(0.32, 0.3 * h)
    return [
        box("foot", (-0.36 * w, 0.36 * w), (0, 0.03), (-0.36 * d, 0.36 * d)),
        box("pole", (-0.015, 0.015), (0.03, h - shade), (-0.015, 0.015)),
        box("shade", (-w / 2, w / 2), (h - shade, h), (-d / 2, d / 2)),
    ]


def table_lamp(w: float, h: float, d: float) -> list[Part]:
    """A rounded foot under a shade."""
    shade = 0.48 * h
    return [
        box("foot", (-0.26 * w, 0.26 * w), (0, 0.4 * h), (-0.26 * d, 0.26 * d)),
        box("pole", (-0.012, 0.012), (0.4 * h, h - shade), (-0.012, 0.012)),
        box("shade", (-w / 2, w / 2), (h - shade, h), (-d / 2, d / 2)),
    ]


def pendant_lamp(w: float, h: float, d: float) -> list[Part]:
    """A shade on a cord."""
    shade = min(0.24, 0.5 * h)
    return [
        box("shade", (-w / 2, w / 2), (0, shade), (-d / 2, d / 2)),
        box("pole", (-0.008, 0.008), (shade, h), (-0.008, 0.008)),
    ]


def ceiling_lamp(w: float, h: float, d: float) -> list[Part]:
    """A flat shade."""
    return [box("shade", (-w / 2, w / 2), (0, h), (-d / 2, d / 2))]


def plant(w: float, h: float, d: float) -> list[Part]:
    """A pot, a stem and leaves one may brush against."""
    pot, width = min(0.34, 0.32 * h), 0.27
    return [
        box("pot", (-width * w, width * w), (0, pot), (-width * d, width * d)),
        box("stem", (-0.012, 0.012), (pot, 0.7 * h), (-0.012, 0.012)),
        box("foliage", (-w / 2, w / 2), (pot + 0.02, h), (-d / 2, d / 2)),
    ]


def vase(w: float, h: float, d: float) -> list[Part]:
    """A vessel with a few stalks."""
    return [
        box("pot", (-0.4 * w, 0.4 * w), (0, 0.6 * h), (-0.4 * d, 0.4 * d)),
        box("foliage", (-w / 2, w / 2), (0.6 * h, h), (-d / 2, d / 2)),
    ]


def screen(w: float, h: float, d: float) -> list[Part]:
    """A television or monitor on a foot."""
    foot = 0.1 * h
    thick = min(0.05, d / 2)
    return [
        box("screen", (-w / 2, w / 2), (foot, h), (-thick / 2, thick / 2)),
        box("foot", (-0.2 * w, 0.2 * w), (0, 0.25 * foot), (-d / 2, d / 2)),
        box("pole", (-0.03, 0.03), (0.25 * foot, foot), (-thick / 4, thick / 4)),
    ]


def picture(w: float, h: float, d: float) -> list[Part]:
    """A frame around a picture, flat on the wall behind it."""
    return [box("picture", (-w / 2, w / 2), (0, h), (-d / 2, d / 2))]


def mirror(w: float, h: float, d: float) -> list[Part]:
    """A framed mirror."""
    return [box("mirror", (-w / 2, w / 2), (0, h), (-d / 2, d / 2))]


def rug(w: float, h: float, d: float) -> list[Part]:
    """Something flat to walk over."""
    return [box("rug", (-w / 2, w / 2), (0, h), (-d / 2, d / 2))]


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
    """A straight kitchen run: worktop over drawers and closed cupboards with room for toes."""
    drawers = 0.8 * h
    return [
        box("top", (-w / 2, w / 2), (h - 0.04, h), (-d / 2, d / 2)),
        box("drawers", (-w / 2, w / 2), (drawers, h - 0.04), (-d / 2, d / 2 - 0.03)),
        box("doors", (-w / 2, w / 2), (0.1, drawers), (-d / 2, d / 2 - 0.03)),
        box("panel", (-w / 2, w / 2), (0, 0.1), (-d / 2, d / 2 - 0.08)),
    ]


def stove(w: float, h: float, d: float) -> list[Part]:
    """A plate to cook on over an oven."""
    return [
        box("hob", (-w / 2, w / 2), (h - 0.03, h), (-d / 2, d / 2)),
        box("oven", (-w / 2, w / 2), (0.1, h - 0.03), (-d / 2, d / 2 - 0.015)),
        box("panel", (-w / 2, w / 2), (0, 0.1), (-d / 2, d / 2 - 0.08)),
    ]


def sink(w: float, h: float, d: float) -> list[Part]:
    """A rim on a worktop, or a body where it is as high as one, and a tap behind it that reaches over its middle."""
    back, rim = 0.03 - d / 2, max(min(0.015, h), h - 0.3)
    return [
        box("basin", (-w / 2, w / 2), (0, rim), (-d / 2, d / 2)),
        box("pole", (-0.012, 0.012), (rim, h), (back, back + 0.024)),
        box("spout", (-0.01, 0.01), (h - 0.02, h), (back + 0.02, 0.0)),
    ]


def microwave(w: float, h: float, d: float) -> list[Part]:
    """One box with a door in front."""
    return [box("oven", (-w / 2, w / 2), (0, h), (-d / 2, d / 2))]


def _heights(low: float, high: float) -> list[float]:
    """Tops of the boards strictly between two heights, evenly and about 0.34 m apart."""
    count = max(1, round((high - low) / 0.34))
    return [low + (high - low) * step / count for step in range(1, count)]


__all__ = ["FORMS", "SOFT_ROLES", "Part", "form_of", "parts", "parts_of"]

Form = Callable[[float, float, float], list[Part]]

_MEMBERS: tuple[tuple[Form, str], ...] = (
    (chair, "chair dining_chair dressing_chair chinese_chair folding_chair"),
    (office_chair, "office_chair"),
    (stool, "stool barstool bench"),
    (ottoman, "ottoman footstool bed_end_stool"),
    (sofa, "sofa multi_seat_sofa loveseat_sofa sofa_bed armchair lounge_chair lazy_sofa"),
    (l_shaped_sofa, "l_shaped_sofa"),
    (chaise_longue, "chaise_longue_sofa"),
    (bed, "bed double_bed single_bed kids_bed bed_frame"),
    (bunk_bed, "bunk_bed"),
    (table, "table dining_table console_table bar"),
    (coffee_table, "coffee_table"),
    (pedestal_table, "side_table corner_side_table round_end_table"),
    (desk, "desk"),
    (dressing_table, "dressing_table"),
    (nightstand, "nightstand"),
    (
        low_storage,
        "dresser sideboard tv_stand shoe_cabinet chest console children_cabinet bathroom_cabinet",
    ),
    (tall_storage, "wardrobe cabinet wine_cabinet refrigerator kitchen_cabinet dishwasher"),
    (open_shelf, "bookshelf shelf wall_shelf"),
    (counter, "kitchen_counter"),
    (stove, "stove"),
    (sink, "kitchen_sink"),
    (microwave, "microwave"),
    (floor_lamp, "lamp floor_lamp"),
    (table_lamp, "table_lamp"),
    (pendant_lamp, "pendant_lamp"),
    (ceiling_lamp, "ceiling_lamp wall_lamp"),
    (plant, "plant"),
    (vase, "vase"),
    (screen, "tv television monitor"),
    (picture, "painting picture"),
    (mirror, "mirror"),
    (rug, "rug"),
)
FORMS: dict[str, Form] = {category: form for form, members in _MEMBERS for category in members.split()}
"""What builds each category; every other category is one solid panel."""


def form_of(category: str) -> str:
    """The name of the form a category has: "chair", "sofa", "bed", "table", ..., "panel" if it has none."""
    return FORMS.get(category, panel).__name__


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
    return inside(FORMS.get(category, panel)(*size), size) or tuple(panel(*size))
