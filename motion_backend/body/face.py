"""A simple face: eyes that look and blink, brows, a mouth, laid on a head as thin patches, and what moves them.

Every feature is drawn flat, from the front, and put on the head by where it meets its surface; so is every way in which
it moves (`UNITS`, after the action units of Ekman and Friesen 1978), which keeps it there. Frame: the reference
skeleton's T-pose, left is +X, metres.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.body import head_shapes
from motion_backend.body.cast import Color, cast
from motion_backend.body.implicit_surface import Faces, Field, gradient, union
from motion_backend.body.mesh_pieces import Cut
from motion_backend.body.skin_weights import dense, weigh_spine
from motion_backend.body.skinning import Material, Morphs
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

if TYPE_CHECKING:
    from motion_backend.body.cast import Look

UNITS: Final = (
    "brows_up", "brows_angry", "brows_sad", "lids_down", "lids_up", "smile", "mouth_open", "mouth_wide", "mouth_skew",
    "gaze_left", "gaze_up",
)  # fmt: skip
"""What a face can do, each by a share of 1; less than 0 is the opposite."""
SIDED: Final = ("gaze_left", "mouth_skew")
"""Those that go the same way on both sides; all others are mirrored."""

EYE: Final = (0.0310, 0.6865)
"""The middle of the left eye."""
EYE_HALF: Final = (0.0160, 0.0115)
IRIS, PUPIL, GLINT = 0.0090, 0.0046, 0.0018
"""Radii."""
LOOKS_ASIDE, LOOKS_UP = 0.0052, 0.0030
"""How far an iris goes."""
LID_EDGE, LID_TOP, LID_SHUT = 0.66, 1.32, -0.92
"""Of the upper lid, in half heights of the eye above its middle: open, its root, and shut."""
LOWER_EDGE, LOWER_ROOT, LOWER_UP = -0.93, -1.30, -0.30
LASH: Final = 0.0023
"""Of lashes' breadth, brows' too."""
BROW_IN, BROW_OUT, BROW_ARCH = (0.0135, 0.7120), (0.0500, 0.7085), 0.0045
BROW: Final = 0.0066
MOUTH: Final = (0.0, 0.6330)
MOUTH_HALF, GAP, UPPER, LOWER = 0.0255, 0.0012, 0.0044, 0.0060
"""Half of the mouth's breadth and of the line between its lips; how high the lips are."""
TEETH: Final = 0.5
"""How much of an open mouth upper teeth fill."""
DEPTH: Final = (0.0, 0.16)
"""Along z, from inside any head to before it."""
HALVINGS: Final = 18
LIFTS: Final = {
    "white": 0.0012, "iris": 0.0020, "pupil": 0.0026, "glint": 0.0031, "lower lid": 0.0034, "lid": 0.0038,
    "lash": 0.0044, "brow": 0.0024, "mouth": 0.0014,
    "teeth": 0.0018, "lips": 0.0022,
}  # fmt: skip
"""Metres that each lies above the head."""
WHITE, BLACK, INSIDE = (0.95, 0.94, 0.92), (0.05, 0.04, 0.05), (0.28, 0.09, 0.09)
ROSE: Final = (0.66, 0.22, 0.22)
"""What lips have more of than skin."""
BROWN_EYES, BLUE_EYES = (0.30, 0.18, 0.10), (0.30, 0.44, 0.56)
LIGHT_HAIR: Final = ("blond", "red", "white")
"""Goes with blue eyes."""


@dataclass(frozen=True)
class _Feature:
    """A patch seen from the front, and how its points move."""

    name: str
    color: Color
    points: Array
    """(N, 2) x and y."""
    faces: Faces
    moves: Mapping[str, Array]
    """(N, 2) by unit."""

    def mirrored(self) -> _Feature:
        """The same on the right."""
        flip = np.array([-1.0, 1.0])
        moves = {unit: move if unit in SIDED else move * flip for unit, move in self.moves.items()}
        return replace(self, points=self.points * flip, faces=self.faces[:, ::-1], moves=moves)


@dataclass(frozen=True)
class Face:
    """Patches on a head."""

    cuts: list[Cut]
    offsets: Array
    """(K, F, 3), a unit each, of all their vertices in order."""

    def morphs(self, first: int) -> Morphs:
        """As the morphs of a mesh whose vertices from `first` on are the face's."""
        return Morphs(UNITS, first, self.offsets.astype(np.float32), INDEX["head"])


def face_of(look: Look) -> Face:
    """The face of a look, on its head."""
    head = head_shapes.head_of(look)
    ground = union(0.0, head, head_shapes.beard(head)) if look.beard else head
    features = list(_features(look))
    drawn = [points for one in features for points in (one.points, *(one.points + m for m in one.moves.values()))]
    heights = np.repeat(
        [LIFTS[one.name] for one in features], [len(one.points) * (1 + len(one.moves)) for one in features]
    )
    laid, normals = _laid(ground, np.concatenate(drawn), heights)
    places = iter(np.split(laid, np.cumsum([len(one) for one in drawn])[:-1]))
    slopes = iter(np.split(normals, np.cumsum([len(one) for one in drawn])[:-1]))
    cuts, offsets = [], []
    for feature in features:
        vertices, slope = next(places), next(slopes)
        moved = dict.fromkeys(UNITS, np.zeros_like(vertices))
        for unit in feature.moves:
            moved[unit], _ = next(places) - vertices, next(slopes)
        weights = dense(weigh_spine(vertices), len(vertices))
        cuts.append(Cut(Material(f"face {feature.name}", feature.color, 0.6), vertices, slope, feature.faces, weights))
        offsets.append(np.stack([moved[unit] for unit in UNITS]))
    return Face(cuts, np.concatenate(offsets, axis=1))


def _laid(head: Field, points: Array, lift: Array) -> tuple[Array, Array]:
    """Points (N, 2) seen from the front, so far (N,) above where they meet the head, and its normals. (N, 3) each."""
    inside, outside = (np.full(len(points), z) for z in DEPTH)
    for _ in range(HALVINGS):
        middle = (inside + outside) / 2
        within = head(np.column_stack([points, middle])) < 0
        inside, outside = np.where(within, middle, inside), np.where(within, outside, middle)
    met = np.column_stack([points, (inside + outside) / 2])
    normals = gradient(head, met)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return met + lift[:, None] * normals, normals


def _features(look: Look) -> Iterator[_Feature]:
    known = cast()
    figure = known.figures[look.figure]
    skin, hair = known.skins_srgb[look.skin], known.hair_srgb[look.hair_color]
    eyes = BLUE_EYES if look.hair_color in LIGHT_HAIR else BROWN_EYES
    for feature in [*_eye(skin, eyes), _brow(_mixed(hair, BLACK, 0.25), BROW * figure.brow_ratio)]:
        yield feature
        yield feature.mirrored()
    yield from _mouth(_mixed(skin, ROSE, 0.22 * figure.lips_ratio**2), figure.lips_ratio)


def _mixed(one: Color, other: Color, share: float) -> Color:
    """A colour that has a share of another."""
    red, green, blue = ((1 - share) * a + share * b for a, b in zip(one, other, strict=True))
    return round(red, 3), round(green, 3), round(blue, 3)


def _eye(skin: Color, iris: Color) -> Iterator[_Feature]:
    """The left eye: its white, what looks, its lids and lashes."""
    gaze = {"gaze_left": np.array([LOOKS_ASIDE, 0.0]), "gaze_up": np.array([0.0, LOOKS_UP])}
    yield _disc("white", WHITE, EYE, EYE_HALF, {})
    yield _disc("iris", iris, EYE, (IRIS, IRIS), gaze)
    yield _disc("pupil", BLACK, EYE, (PUPIL, PUPIL), gaze)
    yield _disc("glint", WHITE, (EYE[0] + 0.0028, EYE[1] + 0.0033), (GLINT, GLINT), gaze)
    shade = _mixed(skin, BLACK, 0.10)

    def edge(height: float) -> Callable[[Array], Array]:
        return lambda u: height * EYE_HALF[1] * np.sqrt(np.maximum(1 - u**2, 0.0))

    shut = {"lids_down": (lambda u: 0 * u, lambda u: edge(LID_SHUT)(u) - edge(LID_EDGE)(u))}
    yield _band("lid", shade, EYE, 1.10 * EYE_HALF[0], (edge(LID_TOP), edge(LID_EDGE)), shut)
    fall = (lambda u: edge(LID_SHUT)(u) - edge(LID_EDGE)(u),) * 2
    lash = (lambda u: edge(LID_EDGE)(u) + LASH / 2, lambda u: edge(LID_EDGE)(u) - LASH / 2)
    yield _band("lash", BLACK, EYE, 1.14 * EYE_HALF[0], lash, {"lids_down": fall})
    rise = {"lids_up": (lambda u: edge(LOWER_UP)(u) - edge(LOWER_EDGE)(u), lambda u: 0 * u)}
    yield _band("lower lid", shade, EYE, 1.06 * EYE_HALF[0], (edge(LOWER_EDGE), edge(LOWER_ROOT)), rise)


def _brow(color: Color, breadth: float) -> _Feature:
    """The left eyebrow: u runs from -1, within, to 1."""
    middle = ((BROW_IN[0] + BROW_OUT[0]) / 2, (BROW_IN[1] + BROW_OUT[1]) / 2)
    half = (BROW_OUT[0] - BROW_IN[0]) / 2

    def line(u: Array) -> Array:
        return BROW_ARCH * (1 - u**2) + (BROW_OUT[1] - BROW_IN[1]) / 2 * u

    def thick(u: Array) -> Array:
        return breadth / 2 * (0.62 - 0.38 * u)

    moves = {
        "brows_up": (lambda u: 0 * u + 0.0065,) * 2,
        "brows_angry": (lambda u: 0.0075 * u - 0.0030,) * 2,
        "brows_sad": (lambda u: 0.0020 - 0.0055 * u,) * 2,
    }
    return _band("brow", color, middle, half, (lambda u: line(u) + thick(u), lambda u: line(u) - thick(u)), moves)


def _mouth(lips: Color, ratio: float) -> Iterator[_Feature]:
    """What is between the lips, and both lips."""

    def arc(height: float, power: float = 0.75) -> Callable[[Array], Array]:
        return lambda u: height * np.maximum(1 - u**2, 0.0) ** power

    def bow(u: Array) -> Array:
        return arc(UPPER * ratio)(u) * (1 - 0.28 * np.exp(-((u / 0.16) ** 2)))

    def at_corners(u: Array) -> Array:
        return 0.0085 * np.abs(u) ** 1.7 - 0.0016

    smile, skew = (at_corners,) * 2, (lambda u: 0.0042 * u,) * 2
    drop, lift = arc(-0.0115, 0.6), arc(0.0022, 0.6)
    both: dict[str, tuple[Curve, Curve]] = {"smile": smile, "mouth_skew": skew}
    wide = {"smile": 0.20, "mouth_wide": 0.24, "mouth_open": -0.10}
    upper = (lambda u: arc(GAP)(u) + bow(u), arc(GAP))
    teeth = (lift, lambda u: (1 - TEETH) * lift(u) + TEETH * drop(u))
    lower = (arc(-GAP), lambda u: -arc(GAP)(u) - arc(LOWER * ratio)(u))
    yield _band("mouth", INSIDE, MOUTH, MOUTH_HALF, (arc(GAP), arc(-GAP)), both | {"mouth_open": (lift, drop)}, wide)
    rows = (arc(GAP), arc(GAP))
    yield _band("teeth", WHITE, MOUTH, MOUTH_HALF, rows, both | {"mouth_open": teeth}, wide)
    yield _band("lips", lips, MOUTH, MOUTH_HALF, upper, both | {"mouth_open": (lift, lift)}, wide)
    yield _band("lips", lips, MOUTH, MOUTH_HALF, lower, both | {"mouth_open": (drop, drop)}, wide)


Curve = Callable[[Array], Array]
"""Heights over u, which runs from -1 to 1 across a feature."""
_ACROSS, _DOWN, _AROUND = 13, 4, 16


def _band(
    name: str,
    color: Color,
    middle: tuple[float, float],
    half: float,
    edges: tuple[Curve, Curve],
    moves: Mapping[str, tuple[Curve, Curve]],
    wider: Mapping[str, float] | None = None,
) -> _Feature:
    """A patch between an upper and a lower edge; units move either, or make it wider by a share of its breadth."""
    u = np.linspace(-1.0, 1.0, _ACROSS)
    down = np.linspace(0.0, 1.0, _DOWN)[:, None]

    def between(upper: Curve, lower: Curve) -> Array:
        return np.asarray((1 - down) * upper(u) + down * lower(u)).reshape(-1)

    across = np.tile(u, _DOWN)
    points = np.column_stack([middle[0] + half * across, middle[1] + between(*edges)])
    shifts = {}
    for unit in {*moves, *(wider or {})}:
        up = between(*moves[unit]) if unit in moves else np.zeros(len(points))
        shifts[unit] = np.column_stack([(wider or {}).get(unit, 0.0) * half * across, up])
    corner = np.add.outer(np.arange(_DOWN - 1) * _ACROSS, np.arange(_ACROSS - 1)).reshape(-1)
    a, b, c, d = corner, corner + 1, corner + _ACROSS, corner + _ACROSS + 1
    faces = np.concatenate([np.column_stack([a, c, d]), np.column_stack([a, d, b])])
    return _Feature(name, color, points, faces, shifts)


def _disc(
    name: str,
    color: Color,
    middle: tuple[float, float],
    half: tuple[float, float],
    moves: Mapping[str, Array],
) -> _Feature:
    """An ellipse."""
    angle = np.arange(_AROUND) * 2 * np.pi / _AROUND
    rim = np.column_stack([np.cos(angle), np.sin(angle)]) * half
    points = np.concatenate([np.zeros((1, 2)), rim / 2, rim]) + middle
    one = np.arange(_AROUND)
    two = (one + 1) % _AROUND
    faces = np.concatenate(
        [
            np.column_stack([0 * one, 1 + one, 1 + two]),
            np.column_stack([1 + one, 1 + _AROUND + one, 1 + _AROUND + two]),
            np.column_stack([1 + one, 1 + _AROUND + two, 1 + two]),
        ]
    )
    return _Feature(name, color, points, faces, {unit: np.tile(move, (len(points), 1)) for unit, move in moves.items()})
