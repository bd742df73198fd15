"""Whose walk it is: people differ, and stay who they are."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from motion_backend.procedural.walk.gait_character import NOBODY, GaitCharacter, character_table, gait_character


def values(character: GaitCharacter) -> np.ndarray:
    return np.array([getattr(character, field.name) for field in fields(character)])


def test_a_seed_and_a_height_give_one_character_and_others_another() -> None:
    assert gait_character(3, 1.7) == gait_character(3, 1.7)
    assert gait_character(3, 1.7) != gait_character(4, 1.7)
    assert gait_character(3, 1.7) != gait_character(3, 1.6)


def test_every_trait_of_a_character_is_drawn() -> None:
    assert set(character_table().spread) == {field.name for field in fields(GaitCharacter)}
    crowd = np.array([values(gait_character(seed)) for seed in range(60)])
    assert (crowd.std(axis=0) > 0).all()


def test_left_and_right_differ_about_what_both_have() -> None:
    one = gait_character(5)
    assert NOBODY.of_side("swing", "ratio", 1) == NOBODY.of_side("swing", "ratio", -1) == 1.0
    assert one.of_side("swing", "ratio", 1) != one.of_side("swing", "ratio", -1)
    assert np.isclose(one.of_side("elbow", "deg", 1) + one.of_side("elbow", "deg", -1), 2 * one.elbow_deg)
