"""What pictures are lit and drawn from, as compiled code takes it: surfaces, lamps, light, and a body in a picture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.rasterizer import Ints, Real
from motion_backend.rotations import Array


class Surfaces(NamedTuple):
    """All triangles of a scene."""

    corners: Array
    """(F, 3, 3) metres."""
    normals: Real
    """(F, 3, 3) float32, one a corner; not read where it is flat."""
    flat: Real
    """(F, 3) float32, unit."""
    is_smooth: NDArray[np.bool_]
    """(F,)."""
    color: Real
    """(F, 3) float32, linear."""


class Shading(NamedTuple):
    """A lamp and its map as compiled code reads them."""

    matrix: Array
    """A point p in the map is matrix @ (p, 1): x, y and nearness. (3, 4)."""
    depth: Real
    """The nearness of what the lamp meets first. (pixels, pixels) float32."""
    most: Real
    least: Real
    """The greatest and the least of it around each pixel, as far as its taps reach. (pixels, pixels) float32 each."""
    taps: Real
    """Where the map is read around a place, in pixels. (K, 2) float32."""
    direction: Array
    """Unit vector towards the lamp. (3,)."""


class Palette(NamedTuple):
    """How bright lights are, and what is drawn beside surfaces."""

    sun: float
    sky: float
    bounce: float
    camera: float
    open_sky: float
    """The share of the sky's light that nothing takes away."""
    offset: float
    """Metres off a surface at which light is looked up."""
    bias: float
    """Metres towards the light at which it is looked up."""
    grid: float
    """Metres between the floor's lines; 0 for none."""
    haze_start: float
    haze_depth: float
    """Metres around the target that are clear, and over which all fades behind them."""
    horizon: Real
    """Linear. (3,)."""
    zenith: Real
    """What the sky becomes where one looks up. Linear. (3,)."""
    rise: float
    """The sine of the angle over the horizon at which it is that."""


class Lit(NamedTuple):
    """A still picture in linear light. All (height, width, 3) float32."""

    color: Real
    by_sun: Real
    """What of it comes from the sun."""
    by_sky: Real
    """What of it comes from that part of the sky that can be shaded."""
    in_sun: Real
    """Where in the sun's map what is seen lies; minus infinity where nothing is."""
    in_sky: Real


class Cutting(NamedTuple):
    """The part of a lamp's map that a body alone covers."""

    corner: Ints
    """Its upper left pixel, x and y."""
    depth: Real
    """(h, w) float32."""
    most: Real
    least: Real
    """The greatest and the least depth around each pixel, as far as its taps reach. (h, w) float32 each."""
    taps: Real
    """Where it is read around a place, for each of four pixels in a square. (4, K, 2) float32."""


class Drawn(NamedTuple):
    """A body in the picture."""

    nearest: NDArray[np.int32]
    """Its faces where they are nearest, else -1; four samples a pixel. (2 h, 2 w)."""
    corner: Ints
    """The pixel in their upper left, x and y."""
    light: Array
    """On its faces as planes over samples from that corner; see `film_kernel.light_planes`. (F, 3)."""
    colors: Real
    """Of its faces, linear. (F, 3) float32."""
