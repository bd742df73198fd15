"""When each keyframe's own deed begins: the sip, the lying down, not the walk that leads to it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from motion_backend.motion import PhaseKind, Skill
from motion_backend.props import prop_tracks

if TYPE_CHECKING:
    from motion_backend.body.cast import Role
    from motion_backend.motion import Motion
    from planner_service.narration.told import Told

WAYS: Final = (PhaseKind.WALK, PhaseKind.STANDUP, PhaseKind.GETUP)
"""Phases that lead to a deed done elsewhere."""
SETTLES: Final = (*WAYS, PhaseKind.EDGE, PhaseKind.SITDOWN, PhaseKind.LIEDOWN)
"""Phases after which who falls asleep can."""
OWN: Final = {Skill.STANDUP: (), Skill.GETUP: (), Skill.LOCO: (PhaseKind.STANDUP, PhaseKind.GETUP)}
"""The ways of skills whose deed is one."""
DOWN: Final = 0.6
"""The share of the settling phase that is over when somebody is as good as down: the rest is ease."""


def deeds(told: Told, motion: Motion, segments: Sequence[tuple[int, int]], role: Role) -> list[int]:
    """The frame at which the own deed of each keyframe begins, `segments` being the frames of keyframes: where the way
    to it ends, where something is taken in hand for it, and of who sleeps where they are down. Of a keyframe that is
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
    skill, _ = role.captions.get(keyframe, (None, ""))
    asleep = keyframe in role.asleep
    ways = SETTLES if asleep else OWN.get(skill, WAYS) if skill is not None else WAYS
    phases = [phase for phase in motion.phases if phase.start < stop and phase.stop > start]
    last = next((phase for phase in reversed(phases) if phase.kind in ways), None)
    arrives = start
    if last is not None:
        settles = asleep and last.kind not in WAYS
        arrives = round(last.start + DOWN * (last.stop - last.start)) if settles else last.stop
    # What is all way is done on the way.
    arrives = arrives if start <= arrives < stop else start
    return max([arrives, *(frame for frame in taken if start <= frame < stop)])
