"""What furniture is made of: solid boxes with a role, in the piece's own frame.

Frame of a piece: origin at the centre of its bottom face, Y up, front +Z; its box spans ±w/2, 0..h, ±d/2.
"""

from __future__ import annotations

from dataclasses import dataclass

Point3 = tuple[float, float, float]
Range = tuple[float, float]

_RESTED_ON = {"seat", "mattress", "back", "arm", "headboard", "base", "pillow"}
_STORAGE = {"top", "shelf", "panel", "doors", "drawers", "leg", "pole", "foot"}
_DECOR = {"shade", "screen", "mirror", "picture", "pot", "stem", "foliage", "rug"}
ROLES = frozenset(_RESTED_ON | _STORAGE | _DECOR)
"""What a part can be."""
SOFT_ROLES = frozenset({"pillow", "foliage", "rug"})
"""Roles a body may sink into or step on: drawn, but no obstacle."""
THINNEST = 0.004
"""Parts thinner than this are left out."""
MAX_PARTS = 64
"""No piece is made of more."""


@dataclass(frozen=True)
class Part:
    """One axis-aligned box of a piece, in the piece's own frame (metres)."""

    role: str
    """One of `ROLES`."""
    low: Point3
    """Corner of least x, y, z."""
    high: Point3
    """Corner of greatest x, y, z."""

    @property
    def center(self) -> Point3:
        """The middle of the box."""
        (x0, y0, z0), (x1, y1, z1) = self.low, self.high
        return ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)

    @property
    def size(self) -> Point3:
        """Width x, height y, depth z."""
        (x0, y0, z0), (x1, y1, z1) = self.low, self.high
        return (x1 - x0, y1 - y0, z1 - z0)

    @property
    def top(self) -> float:
        """Height of the top face above the piece's bottom."""
        return self.high[1]

    @property
    def is_soft(self) -> bool:
        """Whether a body may pass into it."""
        return self.role in SOFT_ROLES


def box(role: str, x: Range, y: Range, z: Range) -> Part:
    """A part by its ranges on the three axes."""
    return Part(role, (x[0], y[0], z[0]), (x[1], y[1], z[1]))


def ends(width: float, thick: float) -> tuple[Range, Range]:
    """The two slices of that thickness at the ends of a width that is centred on 0."""
    return ((-width / 2, -width / 2 + thick), (width / 2 - thick, width / 2))


def legs(w: float, height: float, d: float, thick: float, inset: float = 0.0) -> list[Part]:
    """Four square legs near the corners: back left, back right, front left, front right (left is -x)."""
    xs, zs = ends(w - 2 * inset, thick), ends(d - 2 * inset, thick)
    return [box("leg", x, (0.0, height), z) for z in zs for x in xs]


def inside(built: list[Part], size: Point3) -> tuple[Part, ...]:
    """Clip parts to a piece's box and leave out what a very small piece has no room for."""
    w, h, d = size
    low, high = (-w / 2, 0.0, -d / 2), (w / 2, h, d / 2)
    kept = []
    for part in built:
        x, y, z = ((max(a, b), min(c, e)) for a, b, c, e in zip(part.low, low, part.high, high, strict=True))
        if all(end - start >= THINNEST for start, end in (x, y, z)):
            kept.append(box(part.role, x, y, z))
    return tuple(kept)
