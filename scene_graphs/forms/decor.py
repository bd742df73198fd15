"""Forms of lamps, plants, screens and what hangs on walls."""

from __future__ import annotations

from scene_graphs.solids import Part, box


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
