"""How much faster than it plays the body's motion is made, skill by skill."""

from __future__ import annotations

import time
from collections.abc import Sequence

from benchmarks.figure import Figure
from benchmarks.stories import SPEED, Timed
from benchmarks.themes import SEED
from motion_backend.director import Director
from motion_backend.motion import Character, Skill


def skill_figures(made: Sequence[Timed]) -> list[Figure]:
    """The actions of all stories acted once more, each skill's beside what they play; the slowest skill counts.

    Seconds of one core.
    """
    played, taken = dict.fromkeys(Skill, 0.0), dict.fromkeys(Skill, 0.0)
    for one in made:
        director, home = Director.of("procedural"), one.story.planned.home
        acting = director.play(home, one.story.actions, director.begin(home, Character(), SEED))
        for action in one.story.actions:
            started = time.process_time()
            motion, _ = next(acting)
            taken[action.skill] += time.process_time() - started
            played[action.skill] += motion.duration
    speeds = {skill: played[skill] / taken[skill] for skill in Skill if taken[skill]}
    slowest = min(speeds, key=lambda skill: speeds[skill])
    note = ", ".join(f"{skill} {speed:.0f}" for skill, speed in speeds.items())
    return [Figure("motion against playing it, slowest skill", speeds[slowest], "×", SPEED, "least", note, 0)]
