"""More motion from a motion: mirrored, played backwards, faster or slower; and its words along with it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.mocap.resampling import sample_positions, sample_rotations
from motion_backend.motion import ContactGoal, Motion
from motion_backend.skeleton import INDEX, JOINTS, other_side

SPEEDS = (0.7, 1.3)
"""Slowest and fastest that a motion may be played and still look like one."""
BACKWARDS = {"getup": "liedown", "standup": "sitdown"}
"""What a skill looks like played backwards; weight then falls the wrong way, so such clips are labelled."""


def _other_side(word: str) -> str:
    return {"left": "right", "right": "left"}.get(word, word)


SWAPPED = [INDEX[other_side(joint)] for joint in JOINTS]
_ACROSS = np.array([-1.0, 1.0, 1.0])
_TURNED = np.array([1.0, -1.0, -1.0, 1.0])


def mirror(motion: Motion) -> Motion:
    """The same as seen in a mirror at x = 0: sides swapped, x negated, turns about y and z reversed."""
    goals = tuple(
        ContactGoal(JOINTS[SWAPPED[INDEX[goal.joint]]], (-goal.position[0], goal.position[1], goal.position[2]))
        for goal in motion.goals
    )
    return replace(
        motion,
        root_positions=(motion.root_positions * _ACROSS).astype(np.float32),
        local_rotations=(motion.local_rotations[:, SWAPPED] * _TURNED).astype(np.float32),
        contacts=motion.contacts[:, [2, 3, 0, 1]],
        goals=goals,
    )


def mirror_words(text: str) -> str:
    """Left for right and right for left, where they are whole words or parts joined by hyphens; case is kept."""

    def swap(found: re.Match[str]) -> str:
        word = _other_side(found[0].lower())
        return word.upper() if found[0].isupper() else word.capitalize() if found[0][0].isupper() else word

    # "Right away" and "all right" name no side.
    return re.sub(r"(?<!all )\b(left|right)\b(?! away| now)", swap, text, flags=re.IGNORECASE)


def reverse(motion: Motion) -> Motion:
    """Played backwards."""
    return replace(
        motion,
        root_positions=motion.root_positions[::-1].copy(),
        local_rotations=motion.local_rotations[::-1].copy(),
        contacts=motion.contacts[::-1].copy(),
        actions=motion.actions[::-1].copy(),
    )


def change_speed(motion: Motion, speed: float) -> Motion:
    """Played at a multiple of its speed, at the same frame rate. ValueError outside `SPEEDS`."""
    if not SPEEDS[0] <= speed <= SPEEDS[1]:
        raise ValueError(f"a motion is played {SPEEDS[0]} to {SPEEDS[1]} times as fast, not {speed:g}")
    times = sped_times(len(motion), speed)
    nearest = np.round(times).astype(int)
    turns = sample_rotations(rotations.continuous(motion.local_rotations.astype(np.float64)), times)
    return replace(
        motion,
        root_positions=sample_positions(motion.root_positions.astype(np.float64), times).astype(np.float32),
        local_rotations=turns.astype(np.float32),
        contacts=motion.contacts[nearest],
        actions=motion.actions[nearest],
    )


def sped_times(frames: int, speed: float) -> NDArray[np.float64]:
    """The frames of a motion that its copy at another speed shows."""
    return np.asarray(np.linspace(0, frames - 1, max(round((frames - 1) / speed), 1) + 1))
