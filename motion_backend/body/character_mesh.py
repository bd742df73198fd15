"""A member of the cast as a skinned mesh: head, hair, clothes and bare limbs cut from fields, a face on the head.

It is the mannequin's skeleton and skin weights under other clothes; proportions are the flesh's alone. Meshes of the
reference height are kept, one a look.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from motion_backend.body import head_shapes, mannequin_clothes, wardrobe
from motion_backend.body.cast import Color, Look, Outfit, cast
from motion_backend.body.face import face_of
from motion_backend.body.implicit_surface import Field, swollen, union
from motion_backend.body.mannequin_mesh import shaped
from motion_backend.body.mesh_pieces import Box, Piece, assembled, cut_all
from motion_backend.body.skin_weights import (
    weigh_arm,
    weigh_coat,
    weigh_hair,
    weigh_head,
    weigh_shirt,
    weigh_shoe,
    weigh_skirt,
    weigh_spine,
    weigh_trousers,
    weigh_tunic,
)
from motion_backend.body.skinning import Material, SkinnedMesh
from motion_backend.body.wardrobe import LONG_SLEEVE, SHORT_SLEEVE, WIDE, Fit
from motion_backend.skeleton import Skeleton

MAX_LOOKS: Final = 16
"""Meshes that are kept."""
SOLES: Final = (0.86, 0.83, 0.77)
DARK: Final = (0.13, 0.12, 0.13)
COAT: Final = 0.012
"""Metres that what is worn over a top is wider."""
TUNIC_HEM: Final = -0.13
"""Where it ends."""

_TORSO: Final[Box] = ((-0.46, -0.03, -0.22), (0.46, 0.6, 0.22))
_LONG_TORSO: Final[Box] = ((-0.78, -0.19, -0.22), (0.78, 0.6, 0.22))
_CHEST: Final[Box] = ((-0.16, -0.04, 0.0), (0.16, 0.60, 0.2))
_BIB: Final[Box] = ((-0.23, -0.03, -0.18), (0.23, 0.58, 0.20))
_NECK: Final[Box] = ((-0.12, 0.44, -0.18), (0.12, 0.62, 0.12))
_LEGS: Final[Box] = ((-0.27, -0.87, -0.22), (0.27, 0.16, 0.22))
_LEG: Final[Box] = ((0.0, -0.86, -0.12), (0.2, -0.10, 0.14))
_HEAD: Final[Box] = ((-0.13, 0.42, -0.16), (0.13, 0.86, 0.16))
_HAIR: Final[Box] = ((-0.14, 0.40, -0.20), (0.14, 0.87, 0.14))
_GLASSES: Final[Box] = ((0.0, 0.65, -0.02), (0.09, 0.72, 0.12))
_HAND: Final[Box] = ((0.69, 0.42, -0.07), (0.91, 0.52, 0.09))
_ARM: Final[Box] = ((0.27, 0.40, -0.09), (0.80, 0.56, 0.12))
_FOOT: Final[Box] = ((0.0, -0.93, -0.12), (0.18, -0.75, 0.24))


def build_character(skeleton: Skeleton, look: Look) -> SkinnedMesh:
    """The mesh of a look for a skeleton of our proportions, scaled to its height."""
    mesh = _reference_mesh(look)
    morphs = None if mesh.morphs is None else mesh.morphs.scaled(skeleton.scale)
    return replace(mesh, vertices=(mesh.vertices * skeleton.scale).astype(np.float32), morphs=morphs)


@lru_cache(maxsize=MAX_LOOKS)
def _reference_mesh(look: Look) -> SkinnedMesh:
    """It at the reference height."""
    face = face_of(look)
    mesh = assembled([*cut_all(tuple(_pieces(look))), *face.cuts])
    first = len(mesh.vertices) - face.offsets.shape[1]
    mesh = shaped(mesh, look.proportions)
    return replace(mesh, morphs=face.morphs(first).scaled(look.proportions.head))


def _pieces(look: Look) -> Iterator[Piece]:
    known = cast()
    skin = Material("skin", known.skins_srgb[look.skin], 0.7)
    hair = Material("hair", known.hair_srgb[look.hair_color], 0.75)
    yield Piece(skin, head_shapes.head_of(look), _HEAD, (0.0125, 0.0125, 0.0115), weigh_spine)
    yield Piece(skin, mannequin_clothes.hand(), _HAND, (0.0095, 0.0075, 0.0062), weigh_arm, True)
    if look.hair != "bald":
        yield Piece(hair, head_shapes.HAIRSTYLES[look.hair](), _HAIR, (0.0145, 0.0145, 0.0145), weigh_hair)
    if look.beard:
        yield Piece(hair, head_shapes.beard(head_shapes.head_of(look)), _HEAD, (0.0125, 0.0115, 0.0115), weigh_spine)
    if look.glasses:
        frames = Material("glasses", DARK, 0.4)
        yield Piece(frames, head_shapes.glasses(), _GLASSES, (0.0034, 0.0034, 0.0040), weigh_head, True)
    worn = look.clothes
    yield from _tops(worn, skin, known.figures[look.figure].bust_m)
    yield from _bottoms(worn, skin)
    yield Piece(
        _cloth("shoes", worn.shoes_srgb), mannequin_clothes.shoe(), _FOOT, (0.017, 0.016, 0.022), weigh_shoe, True
    )
    yield Piece(
        Material("soles", SOLES, 0.8), mannequin_clothes.sole(), _FOOT, (0.016, 0.0085, 0.019), weigh_shoe, True
    )


def _tops(worn: Outfit, skin: Material, bust: float) -> Iterator[Piece]:
    wide = WIDE if worn.loose else 0.0
    long_sleeved = worn.top == "shirt"
    base = wardrobe.top(Fit(LONG_SLEEVE if long_sleeved else SHORT_SLEEVE, bust, wide))
    if worn.top == "tunic":
        base = wardrobe.tunic(base, mannequin_clothes.trousers(), TUNIC_HEM)
    box = _LONG_TORSO if long_sleeved or worn.top == "tunic" else _TORSO
    weigh = weigh_tunic if worn.top == "tunic" else weigh_shirt
    yield Piece(_cloth("top", worn.top_srgb), base, box, (0.022, 0.026, 0.024), weigh)
    if not (long_sleeved or worn.over):
        yield Piece(skin, mannequin_clothes.arm(), _ARM, (0.022, 0.014, 0.014), weigh_arm, True)
    if worn.over:
        long = worn.over == "coat"
        cut = wardrobe.top(Fit(LONG_SLEEVE, bust, COAT))
        closed = union(0.03, cut, wardrobe.coat_skirt()) if long else cut
        opened = wardrobe.open_front(closed, 0.30, 0.030 if long else 0.018)
        lengthened: Box = ((-0.78, -0.29, -0.22), (0.78, 0.6, 0.22)) if long else _LONG_TORSO
        weigh = weigh_coat if long else weigh_shirt
        yield Piece(_cloth("over", worn.over_srgb), opened, lengthened, (0.019, 0.022, 0.021), weigh)
    yield from _extras(worn, base, wide)


def _extras(worn: Outfit, base: Field, wide: float) -> Iterator[Piece]:
    accent = _cloth("accent", worn.accent_srgb)
    fine, wider = (0.0095, 0.011, 0.0095), (0.013, 0.014, 0.013)
    for extra in worn.extras:
        match extra:
            case "collar":
                shade = worn.accent_srgb if "tie" not in worn.extras else worn.top_srgb
                yield Piece(_cloth("collar", shade), wardrobe.collar(), _NECK, fine, weigh_spine)
            case "tie":
                yield Piece(accent, wardrobe.tie(), _CHEST, fine, weigh_spine)
            case "placket":
                yield Piece(accent, wardrobe.placket(wide), _CHEST, fine, weigh_spine)
            case "belt":
                yield Piece(accent, wardrobe.belt(), _TORSO, (0.019, 0.010, 0.019), weigh_trousers)
            case "hood":
                yield Piece(_cloth("top", worn.top_srgb), wardrobe.hood(wide), _NECK, wider, weigh_spine)
            case "bib":
                yield Piece(accent, wardrobe.bib(base, 0.0), _BIB, wider, weigh_shirt)
            case "apron":
                yield Piece(accent, wardrobe.apron_skirt(wardrobe.skirt()), _LEGS, (0.02, 0.026, 0.02), weigh_skirt)
            case "neckline":
                yield Piece(accent, wardrobe.neckline(), ((-0.40, 0.38, -0.08), (0.40, 0.58, 0.15)), wider, weigh_shirt)
            case "badge":
                yield Piece(accent, wardrobe.badge(base), _CHEST, fine, weigh_spine)


def _bottoms(worn: Outfit, skin: Material) -> Iterator[Piece]:
    cloth = _cloth("bottom", worn.bottom_srgb)
    trousers = mannequin_clothes.trousers()
    if worn.bottom == "trousers":
        wide = swollen(trousers, WIDE / 2 if worn.loose else 0.0)
        yield Piece(cloth, wide, _LEGS, (0.025, 0.034, 0.025), weigh_trousers)
        return
    yield Piece(skin, wardrobe.bare_leg(), _LEG, (0.019, 0.028, 0.019), weigh_trousers, True)
    if worn.bottom == "shorts":
        yield Piece(cloth, wardrobe.shorts(trousers), _LEGS, (0.025, 0.028, 0.025), weigh_trousers)
    else:
        yield Piece(cloth, wardrobe.skirt(), _LEGS, (0.022, 0.030, 0.022), weigh_skirt)


def _cloth(name: str, color: Color) -> Material:
    return Material(name, color, 0.9)
