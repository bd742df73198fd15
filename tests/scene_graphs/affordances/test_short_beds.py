"""Who lies on a bed of any usual size has the whole head on it, at the end where its pillows are."""

from __future__ import annotations

from math import cos, sin

from for_each import for_each

from scene_graphs.affordances.affordances import spots
from scene_graphs.layout import Placed

CROWN = 0.80
"""From the pelvis to the crown of who is 1.70 m tall and lies straight, in metres."""
CURLED = 0.28
"""How far before the pelvis the head of somebody is who lies curled up on a side."""
HEAD = 0.10


@for_each("length", [1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0, 2.1, 2.2])
@for_each("width", [0.9, 1.2, 1.4, 1.6, 1.8])
@for_each("category", ["double_bed", "single_bed"])
def test_the_head_is_on_the_bed_whichever_way_one_lies(category: str, width: float, length: float) -> None:
    if length < 0.85 * width:  # one lies across a mattress that is so much wider than it is long
        return
    bed = Placed("bed", category, (0.0, 0.0, 0.0), (width, 0.5, length), 0.7)
    found = list(spots(bed, "lie"))
    assert found
    for spot in found:
        # In the bed's frame the pillows are at -z.
        x, z = (
            cos(bed.yaw) * spot.point[0] - sin(bed.yaw) * spot.point[2],
            sin(bed.yaw) * spot.point[0] + cos(bed.yaw) * spot.point[2],
        )
        head = (sin(spot.facing - bed.yaw), cos(spot.facing - bed.yaw))
        assert abs(head[0]) < 1e-6
        assert head[1] < 0, "towards the pillows"
        assert z - CROWN >= -length / 2
        assert width / 2 - abs(x) >= min(CURLED + HEAD, 0.4 * width) - 1e-6
