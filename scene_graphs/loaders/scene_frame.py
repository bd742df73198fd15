"""The frame of a user's scene file: which axis is up, how long a unit is, and which way furniture faces in it."""

from __future__ import annotations

from math import atan2, isfinite, pi
from typing import Final, NamedTuple

import numpy as np

from scene_graphs.fields import LayoutError
from scene_graphs.loaders.options import Options
from scene_graphs.placed import Array, wrap

_FRONTS: Final = {"+z": 0.0, "+x": pi / 2, "-z": pi, "-x": -pi / 2}
_Z_UP: Final = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
_UPRIGHT: Final = 0.99
"""Cosine of the largest tilt at which a node's turn about the vertical is a turn."""


class Frame(NamedTuple):
    """How the file's frame lies in ours."""

    axes: Array
    unit: float
    front: float
    """Yaw of the pieces' fronts in their own frame."""

    def points(self, points: Array) -> Array:
        """Points of the file in our frame, in metres. (N, 3)."""
        moved: Array = points @ self.axes.T * self.unit
        return moved

    def heading(self, turn: Array) -> float | None:
        """The yaw of a piece whose node is turned so; None if it is tilted."""
        own = self.axes @ turn @ self.axes.T
        if own[1, 1] >= _UPRIGHT:
            forward = own[:, 2]
        elif own[1, 2] >= _UPRIGHT:
            # Modelled with z up and turned upright by its node: then the front is -y.
            forward = -own[:, 1]
        else:
            return None
        return wrap(atan2(forward[0], forward[2]) + self.front)


def frame_of(options: Options) -> Frame:
    """The frame that the options name. LayoutError if they name none."""
    if options.up not in ("y", "z") or options.front not in _FRONTS:
        raise LayoutError(f"up must be y or z, and front one of {', '.join(_FRONTS)}")
    if not (isinstance(options.unit, int | float) and isfinite(options.unit) and 1e-6 <= options.unit <= 1e6):
        raise LayoutError(f"unit must be metres a unit, such as 0.01 for centimetres, got {options.unit!r:.60}")
    return Frame(_Z_UP if options.up == "z" else np.eye(3), float(options.unit), _FRONTS[options.front])
