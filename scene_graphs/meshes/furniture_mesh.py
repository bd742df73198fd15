"""Furniture and homes as meshes: the one door to what they look like.

Each role of each form is drawn its own way: cushions with soft edges, doors with handles, shades, pots and leaves.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, product

import numpy as np

from scene_graphs.furniture_shapes import SOFT_ROLES, Part, form_of, parts, parts_of
from scene_graphs.home import Home
from scene_graphs.layout import Placed
from scene_graphs.meshes import materials as m
from scene_graphs.meshes.interior_mesh import floor_meshes, wall_meshes
from scene_graphs.meshes.materials import Canvas, Material
from scene_graphs.meshes.mesh_details import books, doors, drawers, foliage, painting, screen_face, shade, stalks
from scene_graphs.meshes.mesh_primitives import Mesh, block, cylinder, turned


def furniture_meshes(placed: Placed) -> list[Mesh]:
    """The meshes of a piece where it stands, one a material; they keep to its solid parts.

    Names are "id:material", with "wall ", "ceiling ", "window " or "rug " before what hangs or lies there. What is
    drawn beyond the parts (blankets, handles, books, leaves) is thin or stays inside the piece's box.
    """
    canvas, form = Canvas(placed), form_of(placed.category)
    for part in parts_of(placed):
        _STYLES.get((form, part.role), _STYLES.get(("", part.role), _wooden))(canvas, part)
    return canvas.meshes()


Style = Callable[[Canvas, Part], None]


def _wooden(canvas: Canvas, part: Part) -> None:
    canvas.add(canvas.wood, block(part.low, part.high, 0.006))


def _leg(canvas: Canvas, part: Part) -> None:
    canvas.add(canvas.wood, block(part.low, part.high))


def _metal_block(canvas: Canvas, part: Part) -> None:
    canvas.add(m.METAL, block(part.low, part.high))


def _pole(canvas: Canvas, part: Part) -> None:
    canvas.add(m.METAL, cylinder(part.low, part.high, 8))


def _table_top(canvas: Canvas, part: Part) -> None:
    canvas.add(canvas.wood, block(part.low, part.high, 0.01))


def _round_top(canvas: Canvas, part: Part) -> None:
    canvas.add(canvas.wood, cylinder(part.low, part.high, 24))


def _round_foot(canvas: Canvas, part: Part) -> None:
    canvas.add(m.METAL, cylinder(part.low, part.high, 20))


def _chair_seat(canvas: Canvas, part: Part) -> None:
    """A wooden seat with a thin cushion on it."""
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    canvas.add(canvas.wood, block((x0, y0, z0), (x1, y1 - 0.022, z1), 0.008))
    fabric = canvas.pick(m.FABRICS, "seat")
    canvas.add(fabric, block((x0 + 0.012, y1 - 0.028, z0 + 0.005), (x1 - 0.012, y1, z1 - 0.012), 0.014))


def _padded(canvas: Canvas, part: Part) -> None:
    canvas.add(m.DARK_FABRIC, block(part.low, part.high, 0.028))


def _ottoman(canvas: Canvas, part: Part) -> None:
    canvas.add(canvas.pick(m.FABRICS), block(part.low, part.high, 0.04))


def _upholstered(bevel: float) -> Style:
    def style(canvas: Canvas, part: Part) -> None:
        canvas.add(_sofa_fabric(canvas), block(part.low, part.high, bevel))

    return style


def _cushions(canvas: Canvas, part: Part) -> None:
    """A row of cushions, one a seat, along the part."""
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    count = max(1, round((x1 - x0) / 0.72))
    edges = np.linspace(x0, x1, count + 1)
    for left, right in pairwise(edges):
        low, high = (float(left) + 0.004, y0, z0), (float(right) - 0.004, y1, z1)
        canvas.add(_sofa_fabric(canvas), block(low, high, 0.045))


def _sofa_fabric(canvas: Canvas) -> Material:
    one_seat = canvas.placed.size[0] < 1.2
    return canvas.pick(m.FABRICS if one_seat else m.SEAT_FABRICS)


def _mattress(canvas: Canvas, part: Part) -> None:
    """Linen, with a blanket over the two thirds at the foot."""
    canvas.add(m.LINEN, block(part.low, part.high, 0.05))
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    over = 0.01
    low, high = (x0 - over, y0 + 0.04, z0 + 0.36 * (z1 - z0)), (x1 + over, y1 + over, z1 + over)
    blanket = canvas.pick(m.BLANKETS)
    canvas.add(blanket, block(low, high, 0.05))
    canvas.add(m.LINEN, block((x0 - over, y0 + 0.05, low[2] - 0.16), (x1 + over, y1 + over, low[2] + 0.02), 0.045))


def _pillow(canvas: Canvas, part: Part) -> None:
    canvas.add(m.PILLOW, block(part.low, part.high, 0.034))


def _headboard(canvas: Canvas, part: Part) -> None:
    canvas.add(canvas.wood, block(part.low, part.high, 0.02))


def _carcass(canvas: Canvas, part: Part) -> None:
    material = m.FRONTS.get(canvas.placed.category) or canvas.pick(m.CARCASSES)
    canvas.add(material, block(part.low, part.high, 0.004))


def _board(canvas: Canvas, part: Part) -> None:
    """A shelf with books on it, except on the top board."""
    canvas.add(canvas.wood, block(part.low, part.high))
    above = [other.low[1] for other in parts_of(canvas.placed) if other.low[1] > part.top + 0.05]
    shelves = [y for y in above if y < part.top + 0.6]
    if shelves:
        for material, shapes in books(part, min(shelves) - part.top, canvas.placed).items():
            canvas.add(material, *shapes)


def _shade(canvas: Canvas, part: Part) -> None:
    canvas.add(m.LAMPSHADE, shade(form_of(canvas.placed.category), part))


def _lamp_foot(canvas: Canvas, part: Part) -> None:
    """A round plate under a floor lamp, a bellied jar under a table lamp."""
    if part.size[1] < 0.06:
        canvas.add(m.METAL, cylinder(part.low, part.high, 16))
        return
    r, y0, h = part.size[0] / 2, part.low[1], part.size[1]
    profile = [(0.0, y0), (0.6 * r, y0), (r, y0 + 0.4 * h), (0.75 * r, y0 + 0.75 * h), (0.3 * r, y0 + h), (0.0, y0 + h)]
    canvas.add(canvas.pick((m.CERAMIC, m.BRASS, m.TERRACOTTA)), turned(profile, segments=14))


def _pot(canvas: Canvas, part: Part) -> None:
    canvas.add(canvas.pick((m.TERRACOTTA, m.CERAMIC)), cylinder(part.low, part.high, 14, 1.3))


def _vase(canvas: Canvas, part: Part) -> None:
    r, y0, h = part.size[0] / 2, part.low[1], part.size[1]
    profile = [
        (0.0, y0),
        (0.55 * r, y0),
        (r, y0 + 0.35 * h),
        (0.45 * r, y0 + 0.85 * h),
        (0.6 * r, y0 + h),
        (0.0, y0 + h),
    ]
    canvas.add(canvas.pick((m.CERAMIC, m.TERRACOTTA)), turned(profile, segments=14))


def _leaves(canvas: Canvas, part: Part) -> None:
    make = stalks if form_of(canvas.placed.category) == "vase" else foliage
    for material, shapes in make(part, canvas.placed).items():
        canvas.add(material, *shapes)


def _screen(canvas: Canvas, part: Part) -> None:
    x1, y1, z1 = part.high
    canvas.add(m.BLACK, block(part.low, (x1, y1, z1 - 0.004), 0.006))
    canvas.add(m.SCREEN, block(*screen_face(part)))


def _picture(canvas: Canvas, part: Part) -> None:
    for material, shapes in painting(part, canvas.placed).items():
        canvas.add(material, *shapes)


def _mirror(canvas: Canvas, part: Part) -> None:
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    canvas.add(canvas.wood, block(part.low, (x1, y1, z1 - 0.004), 0.01))
    canvas.add(m.GLASS, block((x0 + 0.03, y0 + 0.03, z0 + 0.002), (x1 - 0.03, y1 - 0.03, z1)))


def _rug(canvas: Canvas, part: Part) -> None:
    """A field inside a border."""
    (x0, _, z0), (x1, y1, z1) = part.low, part.high
    border, field_ = (canvas.pick(choices) for choices in (m.BORDERS, m.RUGS))
    canvas.add(border, block(part.low, (x1, y1 - 0.002, z1)))
    canvas.add(field_, block((x0 + 0.12, 0.0, z0 + 0.12), (x1 - 0.12, y1, z1 - 0.12)))


def _worktop(canvas: Canvas, part: Part) -> None:
    canvas.add(m.WOODS[0], block(part.low, part.high, 0.006))


def _hob(canvas: Canvas, part: Part) -> None:
    """Four round plates on black glass, which lies a little deeper than they."""
    (x0, _, z0), (x1, y1, z1) = part.low, part.high
    glass = y1 - 0.008
    canvas.add(m.BLACK, block(part.low, (x1, glass, z1), 0.004))
    radius = 0.16 * min(x1 - x0, z1 - z0)
    for x, z in product((x0 + 0.27 * (x1 - x0), x0 + 0.73 * (x1 - x0)), (z0 + 0.3 * (z1 - z0), z0 + 0.72 * (z1 - z0))):
        canvas.add(m.STEEL, cylinder((x - radius, glass, z - radius), (x + radius, y1, z + radius), 20))
        inner = 0.8 * radius
        canvas.add(m.METAL, cylinder((x - inner, y1, z - inner), (x + inner, y1 + 0.001, z + inner), 20))


def _oven(canvas: Canvas, part: Part) -> None:
    """Steel around a dark window; a stove's has a bar to open it and knobs above, a microwave's buttons beside it."""
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    w, h, face = x1 - x0, y1 - y0, z1 - 0.012
    canvas.add(m.STEEL, block((x0, y0, z0), (x1, y1, face), 0.006))
    cooks = form_of(canvas.placed.category) == "stove"
    low, high = ((0.08, 0.3), (0.92, 0.76)) if cooks else ((0.05, 0.12), (0.72, 0.88))
    canvas.add(
        m.SCREEN, block((x0 + low[0] * w, y0 + low[1] * h, face), (x0 + high[0] * w, y0 + high[1] * h, z1), 0.004)
    )
    if cooks:
        y = y0 + 0.8 * h
        canvas.add(m.METAL, block((x0 + 0.1 * w, y, face), (x1 - 0.1 * w, y + 0.02, z1 + 0.02), 0.006))
    for step in range(5):
        share = 0.14 + 0.18 * step
        x, y = (x0 + share * w, y0 + 0.92 * h) if cooks else (x0 + 0.86 * w, y0 + share * h)
        canvas.add(m.METAL, block((x - 0.015, y - 0.015, face), (x + 0.015, y + 0.015, z1), 0.004))


def _basin(canvas: Canvas, part: Part) -> None:
    """A steel rim around a dark hollow, as seen from above."""
    (x0, _, z0), (x1, y1, z1) = part.low, part.high
    canvas.add(m.STEEL, block(part.low, (x1, y1 - 0.002, z1), 0.004))
    canvas.add(m.METAL, block((x0 + 0.04, y1 - 0.004, z0 + 0.08), (x1 - 0.04, y1, z1 - 0.03)))


def _panel(canvas: Canvas, part: Part) -> None:
    """What has no form of its own: a plain painted box."""
    canvas.add(canvas.pick((m.CERAMIC, *m.WOODS)), block(part.low, part.high, 0.015))


_STYLES: dict[tuple[str, str], Style] = {
    ("", "leg"): _leg,
    ("", "pole"): _pole,
    ("", "top"): _table_top,
    ("", "drawers"): drawers,
    ("", "doors"): doors,
    ("", "shade"): _shade,
    ("", "mirror"): _mirror,
    ("", "foot"): _lamp_foot,
    ("", "mattress"): _mattress,
    ("", "pillow"): _pillow,
    ("", "headboard"): _headboard,
    ("", "foliage"): _leaves,
    ("", "stem"): _leg,
    ("", "pot"): _pot,
    ("vase", "pot"): _vase,
    ("chair", "seat"): _chair_seat,
    ("office_chair", "seat"): _padded,
    ("office_chair", "back"): _padded,
    ("office_chair", "arm"): _metal_block,
    ("office_chair", "leg"): _metal_block,
    ("stool", "seat"): _chair_seat,
    ("ottoman", "seat"): _ottoman,
    ("ottoman", "base"): _ottoman,
    **{(form, "seat"): _cushions for form in ("sofa", "l_shaped_sofa", "chaise_longue")},
    **{(form, "back"): _cushions for form in ("sofa", "l_shaped_sofa", "chaise_longue")},
    **{(form, "arm"): _upholstered(0.045) for form in ("sofa", "l_shaped_sofa", "chaise_longue")},
    **{(form, "base"): _upholstered(0.02) for form in ("sofa", "l_shaped_sofa", "chaise_longue")},
    ("pedestal_table", "top"): _round_top,
    ("pedestal_table", "leg"): _round_foot,
    ("low_storage", "top"): _carcass,
    ("nightstand", "top"): _table_top,
    ("tall_storage", "panel"): _carcass,
    ("open_shelf", "shelf"): _board,
    ("desk", "shelf"): _board,
    ("screen", "screen"): _screen,
    ("screen", "foot"): _metal_block,
    ("screen", "pole"): _metal_block,
    ("picture", "picture"): _picture,
    ("rug", "rug"): _rug,
    ("counter", "top"): _worktop,
    ("counter", "panel"): _metal_block,
    ("stove", "panel"): _metal_block,
    ("stove", "hob"): _hob,
    ("stove", "oven"): _oven,
    ("microwave", "oven"): _oven,
    ("sink", "basin"): _basin,
    ("sink", "spout"): _metal_block,
    ("panel", "panel"): _panel,
}


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
