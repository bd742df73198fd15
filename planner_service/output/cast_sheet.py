"""The cast as one picture: everybody in their own clothes, what else there is to wear, and a face in nine emotions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.body.cast import Look, cast
from motion_backend.body.character_mesh import build_character
from motion_backend.body.face_track import expression
from motion_backend.body.skinning import skin
from motion_backend.motion import Character, Emotion
from motion_backend.rendering.rasterizer import orbit
from motion_backend.rendering.renderer import Image, Solid, render
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton

BODY, FACE = (126, 250), (126, 126)
"""Pixels of a body and of a face."""
LABEL: Final = 18
"""Pixels under each for its name."""
INK, PAPER = (35, 38, 43), 255
ARMS_DOWN: Final = 1.22
"""Radians from the T-pose."""
BODY_SPAN, FACE_SPAN = 1.95, 0.30
"""Metres a picture is high; a face's at 1.70 m."""
BODY_VIEW, FACE_VIEW = (0.45, 0.10), (0.30, 0.03)
"""Yaw and pitch, radians."""
FAR: Final = 4.0
HEAD_HEIGHT: Final = 0.665
"""The middle of a face above the pelvis, at 1.70 m."""
FACES: Final = ("tom", "mara")
"""Whose faces are shown."""


def cast_sheet() -> Image:
    """The whole cast, the clothes that nobody has on, and two faces in every emotion. (H, W, 3) uint8."""
    members = [one.name for one in cast().member]
    own = [(name, _body(Look.of(Character(member=name)))) for name in members]
    worn = {one.outfit for one in cast().member}
    others = [one for one in cast().outfit if one.name not in worn]
    dressed = [
        (one.name, _body(replace(Look.of(Character(member=wearer)), outfit=one.name)))
        for number, one in enumerate(others)
        for wearer in [members[number % len(members)] if one.name != "suit_dress" else "mara"]
    ]
    faces = [
        (emotion.value, _face(Look.of(Character(member=name)), expression(emotion)))
        for name in FACES
        for emotion in Emotion
    ]
    rows = [own, dressed, *(faces[start : start + len(Emotion)] for start in range(0, len(faces), len(Emotion)))]
    width = max(len(row) * row[0][1].shape[1] for row in rows)
    return np.concatenate([_row(row, width) for row in rows])


def _row(cells: Sequence[tuple[str, Image]], width: int) -> Image:
    from PIL import Image as Pictures
    from PIL import ImageDraw

    height = cells[0][1].shape[0]
    page = Pictures.new("RGB", (width, height + LABEL), (PAPER,) * 3)
    pen = ImageDraw.Draw(page)
    for number, (name, picture) in enumerate(cells):
        left = number * picture.shape[1]
        page.paste(Pictures.fromarray(picture), (left, 0))
        pen.text((left + picture.shape[1] / 2, height + LABEL / 2), name, INK, anchor="mm")
    return np.asarray(page)


def _body(look: Look) -> Image:
    """Somebody standing."""
    pose = np.tile(rotations.IDENTITY, (1, len(INDEX), 1))
    for side, sign in (("left", -1), ("right", 1)):
        pose[0, INDEX[f"{side}_shoulder"]] = rotations.axis_to_quat("z", np.array(sign * ARMS_DOWN))
    camera = orbit((0.0, BODY_SPAN / 2 - 0.12, 0.0), FAR, *BODY_VIEW)
    return render([_solid(look, pose, None)], replace(camera, span=BODY_SPAN), BODY)


def _face(look: Look, shares: Array) -> Image:
    """The head alone, with a face."""
    scale = _height(look) / 1.70
    skeleton = build_skeleton(_height(look))
    target = (0.0, skeleton.standing_height + HEAD_HEIGHT * scale, 0.0)
    camera = orbit(target, FAR, *FACE_VIEW)
    solid = _solid(look, np.tile(rotations.IDENTITY, (1, len(INDEX), 1)), shares[None])
    return render([solid], replace(camera, span=FACE_SPAN * scale), FACE, ground=None, shadows=False)


def _solid(look: Look, pose: Array, shares: Array | None) -> Solid:
    skeleton = build_skeleton(_height(look))
    mesh = build_character(skeleton, look)
    vertices, normals = skin(mesh, skeleton, np.array([[0.0, skeleton.standing_height, 0.0]]), pose, shares)
    return Solid(vertices[0], mesh.faces, mesh.face_colors, normals[0])


def _height(look: Look) -> float:
    return cast().ages[look.age].height_m
