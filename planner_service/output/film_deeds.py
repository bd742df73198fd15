"""When each keyframe's own deed begins: the sip, the lying down, not the walk that leads to it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.motion import PhaseKind, Skill
from motion_backend.props import prop_tracks
from motion_backend.skeleton import INDEX
from planner_service.grounding.keyframes_to_actions import stays

if TYPE_CHECKING:
    from motion_backend.body.cast import Role
    from motion_backend.motion import Motion
    from planner_service.narration.told import Told

WAYS: Final = (PhaseKind.WALK, PhaseKind.STANDUP, PhaseKind.GETUP)
"""Phases that lead to a deed done elsewhere."""
OWN: Final = {Skill.STANDUP: (), Skill.GETUP: (), Skill.LOCO: (PhaseKind.STANDUP, PhaseKind.GETUP)}
"""The ways of skills whose deed is one."""
STANDS: Final = 1.5
"""Seconds for which who stops on a way stands, at least, where the deed is done there: a look out, a wave."""
DOWN: Final = 0.5
"""The share of its way down that a head still has before it from which on somebody is on the way to sleep."""
RESTS: Final = 0.05
"""Metres that the head of who lies or sits already moves at most."""
TAKEN_FOR: Final = 1.0
"""Seconds for which a keyframe goes on, at least, after something is taken in hand for it, and not for the next one."""


def deeds(told: Told, motion: Motion, segments: Sequence[tuple[int, int]], role: Role) -> list[int]:
    """The frame at which the own deed of each keyframe begins, `segments` being the frames of keyframes: where the way
    to it ends, where something is taken in hand for it, and of who sleeps where they lie down. Of a keyframe that is
    nothing but the way to another which the same words tell, it is that of the other."""
    taken = [frame for track in prop_tracks(motion, role) for frame in track.lifts]
    found = [_deed(motion, keyframe, segment, role, taken) for keyframe, segment in enumerate(segments)]
    for span in told.spans:
        for keyframe, following in reversed(list(pairwise(span.keyframes))):
            if following > keyframe and _is_way(motion, segments[keyframe], taken):
                found[keyframe] = found[following]
    return found


def _is_way(motion: Motion, segment: tuple[int, int], taken: Sequence[int]) -> bool:
    """Whether nothing is done in some frames but walking, with nothing taken in hand."""
    start, stop = segment
    kinds = {phase.kind for phase in motion.phases if phase.start < stop and phase.stop > start}
    return kinds == {PhaseKind.WALK} and not any(start <= frame < stop for frame in taken)


def _deed(motion: Motion, keyframe: int, segment: tuple[int, int], role: Role, taken: Sequence[int]) -> int:
    start, stop = segment
    skill, caption = role.captions.get(keyframe, (None, ""))
    ways = OWN.get(skill, WAYS) if skill is not None else WAYS
    phases = [phase for phase in motion.phases if phase.start < stop and phase.stop > start]
    if phases and phases[0].reacts:  # what is told first is what happens
        return start
    arrives = next((phase.stop for phase in reversed(phases) if phase.kind in ways), start)
    own = [frame for frame in taken if start <= frame < stop - TAKEN_FOR * motion.fps]
    if skill is Skill.LOCO and stays(caption) and not own:
        arrives = max(arrives, _stops(motion, start, stop))
    # What is all way is done on the way.
    arrives = arrives if start <= arrives < stop else start
    if keyframe in role.asleep and arrives < stop:
        arrives = _sinks(motion, arrives, stop)
    return max([arrives, *own])


def _stops(motion: Motion, start: int, stop: int) -> int:
    """The frame from which somebody stands for a while to the end of some frames; their first where nobody does."""
    stands = [p for p in motion.phases if p.kind is PhaseKind.STAND and p.start < stop <= p.stop]
    return next((p.start for p in stands if stop - max(p.start, start) >= STANDS * motion.fps), start)


def _sinks(motion: Motion, start: int, stop: int) -> int:
    """The frame from which on the head of who falls asleep in some frames is nearly where it then rests."""
    heights = motion.part(start, stop).joint_positions()[:, INDEX["head"], 1]
    left = np.abs(heights - heights[-1])
    return start + int(np.flatnonzero(left >= DOWN * left.max())[-1]) if left.max() > RESTS else start
