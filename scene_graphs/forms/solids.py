"""What furniture is made of: solid boxes with a role, in the piece's own frame.

Frame of a piece: origin at the centre of its bottom face, Y up, front +Z; its box spans ±w/2, 0..h, ±d/2.
"""

from __future__ import annotations

from dataclasses import dataclass

from scene_graphs.layouts import Point3

Range = tuple[float, float]

SOFT_ROLES = frozenset({"pillow", "foliage", "rug"})
"""Roles a body may sink into or step on: drawn, but no obstacle."""
THINNEST = 0.004
"""Parts thinner than this are left out."""


@dataclass(frozen=True)
class Part:
    """One axis-aligned box of a piece, in the piece's own frame (metres)."""

    role: str
    """seat, back, arm, leg, top, shelf, panel, mattress, pillow, headboard, pole, shade, screen, pot, foliage, ..."""
    center: Point3
    size: Point3

    @property
    def low(self) -> Point3:
        """Corner of least x, y, z."""
        (x, y, z), (w, h, d) = self.center, self.size
        return (x - w / 2, y - h / 2, z - d / 2)

    @property
    def high(self) -> Point3:
        """Corner of greatest x, y, z."""
        (x, y, z), (w, h, d) = self.center, self.size
        return (x + w / 2, y + h / 2, z + d / 2)

    @property
    def top(self) -> float:
        """Height of the top face above the piece's bottom."""
        return self.center[1] + self.size[1] / 2

    @property
    def is_soft(self) -> bool:
        """Whether a body may pass into it."""
        return self.role in SOFT_ROLES


def box(role: str, x: Range, y: Range, z: Range) -> Part:
    """A part by its ranges on the three axes."""
    center = ((x[0] + x[1]) / 2, (y[0] + y[1]) / 2, (z[0] + z[1]) / 2)
    return Part(role, center, (x[1] - x[0], y[1] - y[0], z[1] - z[0]))


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
