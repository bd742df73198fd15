"""Words as a film lays them on its pictures: white letters, upright or slanted, that always fit into the picture."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import groupby
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from PIL.ImageFont import FreeTypeFont

Letter = tuple[str, bool]
"""A letter, and whether it is slanted."""
WIDEST: Final = 0.92
"""Of the picture's width that a line fills at most."""
SMALLER: Final = (1.0, 0.9, 0.8, 0.7, 0.6)
"""Shares of the letters' height that are tried where words are too wide."""
FONTS: Final = ("DejaVu Sans", "DejaVu Sans:italic")
"""Upright and slanted."""
PITCH: Final = 1.22
"""From line to line, in letters' heights."""


def lettered(lines: Sequence[Sequence[Letter]], size: tuple[int, int], share: float) -> NDArray[np.float32] | None:
    """Lines as how much of each pixel they cover, in letters of that share of the picture's height. (h, w), not wider
    than the picture; None where there is nothing to be read.

    Lines too wide for the picture are written smaller, and those that are still too wide are cut.
    """
    widest = WIDEST * size[0]
    height = next((part for part in SMALLER if _widest(lines, size, share * part) <= widest), SMALLER[-1])
    fonts = _fonts(share * height, size)
    return _drawn([_cut(line, fonts, widest) for line in lines], size, fonts)


def titled(title: str, size: tuple[int, int], share: float) -> NDArray[np.float32] | None:
    """A title on one line, else on two, else in smaller letters; what goes beyond is cut. (h, w) or None."""
    words = title.split()
    widest = WIDEST * size[0]
    lines: list[list[str]] = []
    for part in SMALLER:
        fonts = _fonts(share * part, size)
        lines = _wrapped(words, fonts, widest)
        if len(lines) <= 2 and all(_width(_plain(line), fonts) <= widest for line in lines):
            break
    else:
        fonts = _fonts(share * SMALLER[-1], size)
        lines = [*lines[:1], [word for line in lines[1:] for word in line]]
    return _drawn([_cut(_plain(line), fonts, widest) for line in lines], size, fonts)


def _plain(words: Sequence[str]) -> list[Letter]:
    return [(letter, False) for letter in " ".join(words)]


def _wrapped(words: Sequence[str], fonts: tuple[FreeTypeFont, FreeTypeFont], widest: float) -> list[list[str]]:
    """Words on as few lines as they need; of two lines neither is much longer than the other."""
    lines: list[list[str]] = []
    for word in words:
        if lines and _width(_plain([*lines[-1], word]), fonts) <= widest:
            lines[-1].append(word)
        else:
            lines.append([word])
    if len(lines) != 2:
        return lines
    ways = ((list(words[:at]), list(words[at:])) for at in range(1, len(words)))
    return list(min(ways, key=lambda way: max(_width(_plain(line), fonts) for line in way)))


def _cut(line: Sequence[Letter], fonts: tuple[FreeTypeFont, FreeTypeFont], widest: float) -> list[Letter]:
    """A line without the letters at its end for which there is no room."""
    if _width(line, fonts) <= widest:
        return list(line)
    kept, more = 0, len(line)
    while kept < more:  # what is left is the longest beginning that fits
        middle = (kept + more + 1) // 2
        fits = _width([*line[:middle], ("…", line[middle - 1][1])], fonts) <= widest
        kept, more = (middle, more) if fits else (kept, middle - 1)
    while kept and line[kept - 1][0] in " ,":
        kept -= 1
    return [*line[:kept], ("…", bool(kept) and line[kept - 1][1])]


def _fonts(share: float, size: tuple[int, int]) -> tuple[FreeTypeFont, FreeTypeFont]:
    upright, slanted = (_font(name, max(round(share * size[1]), 1)) for name in FONTS)
    return upright, slanted


@cache
def _font(name: str, height: int) -> FreeTypeFont:
    from matplotlib import font_manager
    from PIL import ImageFont

    return ImageFont.truetype(font_manager.findfont(name), height)


def _widest(lines: Sequence[Sequence[Letter]], size: tuple[int, int], share: float) -> float:
    return max((_width(line, _fonts(share, size)) for line in lines), default=0.0)


def _width(line: Sequence[Letter], fonts: tuple[FreeTypeFont, FreeTypeFont]) -> float:
    return sum(fonts[slanted].getlength(text) for text, slanted in _runs(line))


def _runs(line: Sequence[Letter]) -> list[tuple[str, bool]]:
    """A line in pieces that are written in one way."""
    # Marks that are no letters, such as those that end a paragraph, have no place on a line.
    runs = groupby((letter for letter in line if letter[0].isprintable()), key=lambda letter: letter[1])
    return [("".join(letter for letter, _ in run), slanted) for slanted, run in runs]


def _drawn(
    lines: Sequence[Sequence[Letter]], size: tuple[int, int], fonts: tuple[FreeTypeFont, FreeTypeFont]
) -> NDArray[np.float32] | None:
    from PIL import Image as Pictures
    from PIL import ImageDraw

    page = Pictures.new("L", size)
    pen = ImageDraw.Draw(page)
    letters = fonts[0].size
    for number, line in enumerate(lines):
        x = (size[0] - _width(line, fonts)) / 2
        y = size[1] / 2 + PITCH * letters * (number - (len(lines) - 1) / 2)
        for text, slanted in _runs(line):
            pen.text((x, y), text, 255, fonts[slanted], anchor="lm")
            x += fonts[slanted].getlength(text)
    box = page.getbbox()
    if box is None:
        return None
    pad = round(0.3 * letters)
    low = (max(box[0] - 2 * pad, 0), max(box[1] - pad, 0))
    high = (min(box[2] + 2 * pad, size[0]), min(box[3] + pad, size[1]))
    cover = np.asarray(page.crop((*low, *high)), dtype=np.float32)
    return cover / np.float32(255)
