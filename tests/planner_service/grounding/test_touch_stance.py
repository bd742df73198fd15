"""Who touches something stands where both arms are clear of what is beside it."""

from __future__ import annotations

import numpy as np
import pytest

from motion_backend.body.scene_collision import Obstacles
from planner_service.grounding.touch_stance import ElbowRoom
from scene_graphs.affordances.affordances import Spot, spots
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Placed
from scene_graphs.navigation.path_planner import Walkable

ROOM = Layout(
    "room",
    "study",
    ((0.0, 0.0), (0.0, 4.0), (5.0, 4.0), (5.0, 0.0)),
    objects=(
        Placed("corner", "cabinet", (0.23, 0.0, 0.3), (0.6, 1.9, 0.4), np.pi / 2),
        Placed("free", "cabinet", (2.8, 0.0, 0.25), (0.8, 1.9, 0.4), 0.0),
        Placed("low", "tv_stand", (0.75, 0.0, 3.75), (1.4, 0.5, 0.4), np.pi),
    ),
)
HOME = home_from_layouts([ROOM], 0)
ROOMY = ElbowRoom(Walkable(HOME), Obstacles.of_home(HOME).solid())


def spot_of(name: str, towards: float, height: str = "medium") -> Spot:
    found = spots(HOME.object(f"0/{name}"), "touch")
    return next(s for s in found if s.height == height and np.cos(s.facing - towards) > 0.99)


def arms(spot: Spot) -> np.ndarray:
    """Depth of the shoulders, 0.2 m to either side of where one stands, in what is beside. (2,)."""
    left = 0.2 * np.array([np.cos(spot.facing), 0.0, -np.sin(spot.facing)])
    middle = np.array([spot.standing[0], 1.3, spot.standing[1]])
    return ROOMY.solid.depth(np.stack([middle + left, middle - left]))


@pytest.mark.parametrize("hand", ["left", "right"])
def test_beside_a_wall_one_stands_aside_of_what_one_touches(hand: str) -> None:
    spot = spot_of("corner", np.pi)
    assert arms(spot).max() > -0.06
    same, aside = ROOMY.freely(spot, hand, "touch medium height")
    assert same == hand
    assert arms(aside).max() < -0.09
    assert (aside.point, aside.normal) == (spot.point, spot.normal)
    away = np.hypot(aside.point[0] - aside.standing[0], aside.point[2] - aside.standing[1])
    assert away < 0.55


@pytest.mark.parametrize("hand", ["left", "right"])
def test_where_there_is_room_one_stands_straight_before_it(hand: str) -> None:
    spot = spot_of("free", np.pi)
    assert ROOMY.freely(spot, hand, "touch medium height") == (hand, spot)


def test_of_two_hands_the_one_towards_a_wall_is_laid_on_the_spot() -> None:
    """One stands at the end of the stand, a wall on the left: the right hand has its place on the other side."""
    spot = spot_of("low", -np.pi / 2, "low")
    hand, aside = ROOMY.freely(spot, "right", "wash with both hands")
    assert hand == "left"
    assert arms(aside).max() < -0.04


def test_before_two_hands_one_stands_in_their_middle() -> None:
    spot = spot_of("free", np.pi)
    hand, middle = ROOMY.freely(spot, "right", "wash with both hands")
    left = np.array([np.cos(spot.facing), -np.sin(spot.facing)])
    moved = np.subtract(middle.standing, spot.standing) @ left
    assert hand == "right"
    assert moved == pytest.approx(0.12)
    assert middle.facing == pytest.approx(spot.facing)
