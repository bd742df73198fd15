"""Forms of what one sits or lies on: chairs, stools, sofas, beds.

Seats end where their back and arms begin, so a seat's own rectangle is free to sit on.
"""

from __future__ import annotations

from dataclasses import dataclass

from scene_graphs.solids import Part, box, ends, legs


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
