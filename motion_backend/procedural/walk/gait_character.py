"""Whose walk it is: what stays of a gait through a whole story, whatever the mood and the caption.

No two people walk alike, and nobody walks evenly: one arm swings further than the other, one shoulder hangs, the feet
point where they are used to. All of it is drawn once, from the seed of a story and the size of its body, and lasts. How
much people differ is in data/gait/character.toml.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cache

import numpy as np

from scene_graphs.data_tables import read_table, table

Spread = tuple[float, float]
"""Mean and standard deviation."""
DRAWN_FOR = 20261
"""Beside the seed, so that a character does not share its luck with what is drawn for its walks."""
MILLIMETRES = 1000


@table
class CharacterTable:
    """data/gait/character.toml."""

    max_sigmas: float
    """Nobody is farther from the mean."""
    spread: dict[str, Spread]
    """How people differ in every field of `GaitCharacter`."""

    def __post_init__(self) -> None:
        if list(self.spread) != [field.name for field in fields(GaitCharacter)]:
            raise ValueError("spread: its rows are the traits of a character, in their order")


def character_table() -> CharacterTable:
    """How people differ from each other in walking."""
    rows: CharacterTable = read_table("motion_backend", "gait/character.toml", CharacterTable)
    return rows


@dataclass(frozen=True)
class GaitCharacter:
    """What somebody's walk has beside its style: factors (`_ratio`), or what is added. As it stands here, nothing.

    Of pairs, `sides` is what the left one has more, or earlier, and the right one less.
    """

    stride_ratio: float = 1.0
    width_ratio: float = 1.0
    """Between the feet in full stride."""
    sway_ratio: float = 1.0
    hips_ratio: float = 1.0
    """How far the pelvis tips with each step,"""
    twist_ratio: float = 1.0
    """and turns,"""
    counter_ratio: float = 1.0
    """and the chest against it."""
    bounce_ratio: float = 1.0
    clearance_ratio: float = 1.0
    clearance_sides_ratio: float = 1.0
    roll_ratio: float = 1.0
    strike_ratio: float = 1.0
    double_share: float = 0.0
    crouch_m: float = 0.0
    nod_ratio: float = 1.0
    """Of the trunk with each step."""
    lean_deg: float = 0.0
    head_deg: float = 0.0
    toes_deg: float = 0.0
    toes_sides_deg: float = 0.0
    toes_swing_ratio: float = 1.0
    """How far toes swing outwards in the air."""
    toes_swing_sides_ratio: float = 1.0
    heel_deg: float = 0.0
    """How far off the floor the heel of a standing foot is, under way."""
    heel_sides_deg: float = 0.0
    step_sides_m: float = 0.0
    """Steps of the left foot are longer,"""
    beat_sides_share: float = 0.0
    """and sooner over."""
    width_sides_m: float = 0.0
    hips_roll_deg: float = 0.0
    """How askew the pelvis stands, the left side up,"""
    hips_turn_deg: float = 0.0
    """or turned to the left,"""
    shoulder_roll_deg: float = 0.0
    """and likewise the shoulders."""
    shoulder_turn_deg: float = 0.0
    shoulder_swing_ratio: float = 1.0
    """How far shoulders tip with each step."""
    swing_ratio: float = 1.0
    """Of the arms."""
    swing_sides_ratio: float = 1.0
    hang_deg: float = 0.0
    """Forward."""
    hang_sides_deg: float = 0.0
    splay_arms: float = 0.0
    """Outwards (arm lengths)."""
    splay_sides_arms: float = 0.0
    elbow_deg: float = 0.0
    elbow_sides_deg: float = 0.0
    folds_ratio: float = 1.0
    """Of the elbow, as an arm comes forward."""
    lag_phase: float = 0.0
    """How much later arms swing (of a step)."""
    lag_sides_phase: float = 0.0
    inwards_arms: float = 0.0
    """How much further hands come in before the body (arm lengths)."""
    inwards_sides_arms: float = 0.0

    def of_side(self, name: str, unit: str, side: int) -> float:
        """What one side has of a trait that both have, and of what sets them apart: +1 left, -1 right."""
        both, apart = float(getattr(self, f"{name}_{unit}")), float(getattr(self, f"{name}_sides_{unit}"))
        return both * apart**side if unit == "ratio" else both + side * apart


NOBODY = GaitCharacter()
"""Nobody in particular: the average of all."""


@cache
def gait_character(seed: int, height: float = 1.70) -> GaitCharacter:
    """The character that a story's seed gives a body of that height (metres)."""
    rng, rows = np.random.default_rng([seed, round(height * MILLIMETRES), DRAWN_FOR]), character_table()
    drawn = {}
    for name, (mean, deviation) in rows.spread.items():
        luck = deviation * float(np.clip(rng.standard_normal(), -rows.max_sigmas, rows.max_sigmas))
        drawn[name] = mean * float(np.exp(luck)) if name.endswith("_ratio") else mean + luck
    return GaitCharacter(**drawn)
