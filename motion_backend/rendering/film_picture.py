"""A film's pictures as films keep them: brightness in full, colour at half the size (YUV 4:2:0, BT.709).

A picture is one array (3 height / 2, width) uint8: `height` rows of brightness, then both colours row after row.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Planes = NDArray[np.uint8]
BLACK, WHITE, GREY = 16, 235, 128
"""Brightness from where to where, and the colour of no colour."""


def split(planes: Planes) -> tuple[Planes, Planes, Planes]:
    """Brightness (height, width) and both colours (height / 2, width / 2), in place."""
    height, width = 2 * planes.shape[0] // 3, planes.shape[1]
    flat, whole = planes.reshape(-1), height * width
    half = (height // 2, width // 2)
    return planes[:height], flat[whole : whole * 5 // 4].reshape(half), flat[whole * 5 // 4 :].reshape(half)


def to_rgb(planes: Planes) -> NDArray[np.uint8]:
    """The picture (height, width, 3) as other programs draw it."""
    bright, blue, red = (plane.astype(np.float32) for plane in split(planes))
    blue, red = ((plane - GREY).repeat(2, axis=0).repeat(2, axis=1) * (255 / 224) for plane in (blue, red))
    bright = (bright - BLACK) * (255 / (WHITE - BLACK))
    green = bright - (0.0722 * 1.8556 * blue + 0.2126 * 1.5748 * red) / 0.7152
    rgb = np.stack([bright + 1.5748 * red, green, bright + 1.8556 * blue], axis=-1)
    return np.asarray(np.clip(np.round(rgb), 0, 255), dtype=np.uint8)


def lay_words(planes: Planes, letters: NDArray[np.float32], bottom: float, shade: float, across: float = 0.5) -> None:
    """White words (h, w), how much of each pixel they cover, on a band with that share of the light that was there.

    They end at the share `bottom` of the picture's height, with the share `across` of the free width on their left.
    """
    bright, *colors = split(planes)
    height, width = (2 * (side // 2) for side in letters.shape)
    top = max(2 * round(bottom * bright.shape[0] / 2) - height, 0)
    left = 2 * int(across * (bright.shape[1] - width) / 2)
    cover = letters[:height, :width]
    part = bright[top : top + height, left : left + width]
    part[:] = BLACK + (part.astype(np.float32) - BLACK) * (shade * (1 - cover)) + (WHITE - BLACK) * cover
    for color in colors:
        part = color[top // 2 : (top + height) // 2, left // 2 : (left + width) // 2]
        part[:] = GREY + (part.astype(np.float32) - GREY) * (shade * (1 - cover[::2, ::2]))
