"""Waves that come and go: of gestures, and of what hands do at a thing."""

from __future__ import annotations

from motion_backend.procedural.pose import smooth
from motion_backend.rotations import Array
from scene_graphs.data_tables import table


@table
class Burst:
    """A wave that comes and goes: so often, for so long each time, growing and fading over so long."""

    every_s: float
    lasts_s: float
    rises_s: float = 0.12
    after_s: float = 0.0
    """When the first one begins."""

    def share(self, time: Array) -> Array:
        """How much of the wave is there at times (T,). (T,)."""
        since = (time - self.after_s) % self.every_s
        return smooth(since / self.rises_s) * smooth((self.lasts_s - since) / self.rises_s) * (time >= self.after_s)
