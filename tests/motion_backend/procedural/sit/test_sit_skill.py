"""Where on a seat one sits: drawn up to a table, beside an armrest, and otherwise where one sits anyway."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.body.scene_collision import Obstacles
from motion_backend.director import Director
from motion_backend.motion import Action, Character, Emotion, Skill
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.procedural.sit.sit_skill import MIN_EDGE, seat_for
from scene_graphs.affordances.affordances import spots
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Layout, Placed

TYPING, RESTING = "typing, both hands on the keyboard", "Resting hands on the armrests, legs spread apart"
CHAIR = Placed("chair", "dining_chair", (2.5, 0.0, 2.0), (0.47, 0.87, 0.54), 0.0)
SOFA = Placed("sofa", "multi_seat_sofa", (2.5, 0.0, 2.0), (2.2, 0.85, 0.9), 0.0)
BACKEND = Director(ProceduralBackend())


def room(*objects: Placed) -> Home:
    corners = ((0.0, 0.0), (0.0, 5.0), (5.0, 5.0), (5.0, 0.0))
    return home_from_layouts([Layout("studio", "bedroom", corners, objects=objects)], 0)


def with_table(gap: float) -> Home:
    """A table so far before the chair's front."""
    return room(CHAIR, Placed("table", "dining_table", (2.5, 0.0, 2.27 + gap + 0.35), (1.2, 0.75, 0.7), 0.0))


def noted(home: Home, piece: str, caption: str) -> list[str]:
    """What sitting there says it did otherwise."""
    found = spots(home.object(f"0/{piece}"), "sit")
    spot = seat_for(found, Emotion.NEUTRAL, caption, Obstacles.of_home(home))
    action = Action(Skill.SITDOWN, caption, Emotion.NEUTRAL, piece, f"0/{piece}", spot)
    motion, _ = BACKEND.act(home, action, BACKEND.begin(home, Character(), 1))
    assert motion.completed, motion.reason
    return [note.words for note in motion.notes]


@given(st.floats(0.0, 1.2))
def test_a_seat_drawn_up_is_moved_ahead_only_and_never_left(gap: float) -> None:
    home = with_table(gap)
    (spot,) = spots(home.object("0/chair"), "sit")
    drawn = seat_for([spot], Emotion.NEUTRAL, TYPING, Obstacles.of_home(home))
    moved = np.asarray(drawn.point) - np.asarray(spot.point)
    ahead = np.array([np.sin(spot.facing), 0.0, np.cos(spot.facing)])
    assert moved @ ahead >= 0.0
    assert moved == pytest.approx((moved @ ahead) * ahead)
    assert drawn.edge == pytest.approx(spot.edge - moved @ ahead)
    assert drawn.back == pytest.approx(spot.back + moved @ ahead)
    assert drawn.edge >= MIN_EDGE - 1e-9


def test_who_wants_no_table_sits_where_one_sits() -> None:
    home = with_table(0.5)
    found = spots(home.object("0/chair"), "sit")
    assert seat_for(found, Emotion.NEUTRAL, "crossing arms", Obstacles.of_home(home)) is found[0]


@pytest.mark.parametrize(("gap", "said"), [(0.55, []), (1.5, ["no table before the seat: each hand in the lap"])])
def test_a_table_that_stands_off_is_typed_at_from_the_front_of_the_seat_and_a_far_one_is_said(
    gap: float, said: list[str]
) -> None:
    assert noted(with_table(gap), "chair", TYPING) == said


def test_of_a_sofa_the_seat_beside_an_arm_is_taken_and_the_other_hand_is_said() -> None:
    (said,) = noted(room(SOFA), "sofa", RESTING)
    assert said in {f"no armrest on the {side}: {side} hand on its thigh" for side in ("left", "right")}


def test_on_a_chair_without_arms_both_hands_are_said() -> None:
    assert noted(room(CHAIR), "chair", RESTING) == ["no armrest: each hand on its thigh"]


def test_nobody_has_a_piano() -> None:
    assert noted(with_table(0.2), "chair", "playing the piano, both hands on the keys") == [
        "no piano: each hand in the air"
    ]
