"""The dual-aware finite state machine at work (SIMS 3.4): it hands backends part after part and judges what they made.

It stands above all backends: which parts an action has, when a part is over, what counts as done and who takes over
from whom is decided here alone.
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from motion_backend.backend_protocol import BodyState, MotionBackend, Part, PartKind, Request, Unwanted
from motion_backend.backends import DEFAULT_BACKEND, load_backend
from motion_backend.contact_goals import contact_goals
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import (
    Action,
    Character,
    Emotion,
    Motion,
    Note,
    Phase,
    PhaseKind,
    Posture,
    Reacts,
    Skill,
    join,
)
from motion_backend.scene import scene_of
from motion_backend.skeleton import build_skeleton
from motion_backend.state_machine import ENDS, parts_of, shortfall, time_limit
from scene_graphs.home import Home

MAX_JUMP = 0.25
"""A pelvis that begins farther from where it was (metres) has not gone on from there."""
PACES = 3
"""Who paces goes a way so many times."""
STANDS = 1.0
"""Seconds that a body stands for an action of which nothing is left to do."""
MAX_REASON = 200
"""Characters of somebody else's error that are told."""
log = logging.getLogger("sims.motion")
Step = tuple[Motion, BodyState]
Asking = Generator[tuple[MotionBackend, Request], Step, Step]
"""Yields what is asked of whom, is sent what was made, and returns what came of it."""


@dataclass(frozen=True)
class Take:
    """One action to be done in a home from a state, and the action that comes after it."""

    home: Home
    action: Action
    state: BodyState
    following: Action | None = None


@dataclass(frozen=True)
class Director:
    """A backend, and another that does what the first cannot do."""

    backend: MotionBackend
    fallback: MotionBackend | None = None

    @staticmethod
    def of(name: str) -> Director:
        """A backend by its name, with the default one behind it. UnknownBackendError, BrokenBackendError."""
        return Director(load_backend(name), load_backend(DEFAULT_BACKEND) if name != DEFAULT_BACKEND else None)

    def begin(self, home: Home, character: Character, seed: int, first: Action | None = None) -> BodyState:
        """The body in the home before its first action: standing, or resting where that has it rest already."""
        state = self._standing(home, character, seed)
        if first is None or not (first.already or first.begins):
            return state
        return _unseen(home, first if first.already else _entering(first), state)

    def _standing(self, home: Home, character: Character, seed: int) -> BodyState:
        try:
            return self.backend.begin(home, character, seed)
        except Exception:
            if self.fallback is None:
                raise
            log.warning("%s raised an exception at the beginning", self.backend.name, exc_info=True)
            return self.fallback.begin(home, character, seed)

    def act(self, home: Home, action: Action, state: BodyState, following: Action | None = None) -> Step:
        """Act out one action from a state; the backend knows what `following` will ask of it."""
        acting = self._acting(Take(home, action, state, following))
        backend, asked = next(acting)
        while True:
            try:
                backend, asked = acting.send(self._advance(backend, asked))
            except StopIteration as done:
                found: Step = done.value
                return found

    def play(self, home: Home, actions: Sequence[Action], state: BodyState) -> Iterator[Step]:
        """Act out one action after the other, each knowing the next."""
        for action, following in zip(actions, (*actions[1:], None), strict=True):
            motion, state = self.act(home, action, state, following)
            yield motion, state

    def act_many(self, takes: Sequence[Take]) -> list[Step]:
        """The same for many bodies at once: backends that can are asked in batches, the results are the same."""
        actings = [self._acting(take) for take in takes]
        waiting = {index: next(acting) for index, acting in enumerate(actings)}
        done: dict[int, Step] = {}
        while waiting:
            for backend in {id(backend): backend for backend, _ in waiting.values()}.values():
                mine = [index for index, (asked_of, _) in waiting.items() if asked_of is backend]
                steps = self._advance_many(backend, [waiting[index][1] for index in mine])
                for index, step in zip(mine, steps, strict=True):
                    try:
                        waiting[index] = actings[index].send(step)
                    except StopIteration as finished:
                        done[index] = finished.value
                        del waiting[index]
        return [done[index] for index in range(len(takes))]

    def _advance(self, backend: MotionBackend, asked: Request) -> Step:
        """What a backend makes; where another stands behind it, an exception is a fault as others are."""
        if backend is not self.backend or self.fallback is None:
            return _advance(backend, asked)
        try:
            return _made(_advance(backend, asked))
        except Unwanted:
            raise
        except Exception as error:  # whatever somebody else's code may raise; who interrupts is no Exception
            log.warning("%s raised an exception at a %s", backend.name, asked.part.kind, exc_info=True)
            return _raised(error, asked), asked.state

    def _advance_many(self, backend: MotionBackend, requests: Sequence[Request]) -> list[Step]:
        if backend is not self.backend or self.fallback is None:
            return advance_many(backend, requests)
        try:
            return [_made(step) for step in advance_many(backend, requests)]
        except Unwanted:
            raise
        except Exception:  # at which of them is seen one by one
            pass
        return [self._advance(backend, asked) for asked in requests]

    def _acting(self, take: Take) -> Asking:
        """An action part by part; what follows a part that failed is left out."""
        action, state = take.action, take.state
        place = (state.pelvis[0], state.pelvis[2]) if state.posture is Posture.STANDING else None
        parts, later = parts_of(action, state.posture, place, state.rest), self._later(take)
        segments: list[Motion] = []
        for index, part in enumerate(parts):
            segment, state = yield from self._part(Request(take.home, part, (*parts[index + 1 :], *later), state))
            segments.append(segment)
            if not segment.completed:
                break
        if not sum(map(len, segments)):
            stays = Part(PartKind.HOLD, action, hold=STANDS)
            segment, state = yield from self._part(Request(take.home, stays, later, state))
            segments.append(segment)
        return _judged(join(segments), action), state

    def _later(self, take: Take) -> tuple[Part, ...]:
        if take.following is None:
            return ()
        return parts_of(take.following, ENDS[take.action.skill], rest=take.action.spot)

    def _part(self, asked: Request) -> Asking:
        """A part by the backend, else by the one behind it, every phase labelled with who made it and why."""
        able, kind = getattr(self.backend, "parts", PartKind), asked.part.kind
        why = "" if kind in able else f"{self.backend.name} makes no {kind}"
        if not why:
            motion, state = yield from _windows(self.backend, asked)
            why = fault(motion, asked)
            if not why or self.fallback is None:
                return _labelled(motion, asked.part, self.backend, "", why), state
        if self.fallback is None:
            raise ValueError(f"{why}, and no backend stands behind it")
        motion, state = yield from _windows(self.fallback, asked)
        return _labelled(motion, asked.part, self.fallback, why, fault(motion, asked)), state


def _entering(first: Action) -> Action:
    """A walk to where the body begins."""
    x, z, yaw = first.begins or (0.0, 0.0, 0.0)
    return Action(Skill.LOCO, "", Emotion.NEUTRAL, goal=(x, z), facing=yaw, stands=STANDS)


def _unseen(home: Home, first: Action, standing: BodyState) -> BodyState:
    """As the default backend has got there, which nobody sees; standing still where it cannot."""
    backend, state = load_backend(DEFAULT_BACKEND), standing
    parts = parts_of(replace(first, reacts=()), Posture.STANDING)
    for index, part in enumerate(parts[:-1]):
        motion, state = _advance(backend, Request(home, part, parts[index + 1 :], state))
        if not motion.completed:
            return standing
    return state


def _made(step: Step) -> Step:
    """TypeError where a backend gave something else than a motion and a state."""
    motion, state = step
    if not isinstance(motion, Motion) or not isinstance(state, BodyState):
        raise TypeError(f"a motion and a body state are wanted, not {type(motion).__name__}, {type(state).__name__}")
    return step


def _raised(error: Exception, asked: Request) -> Motion:
    """No frames, and what was raised as the reason."""
    why = f"it raised {error!r:.{MAX_REASON}}"
    return replace(Motion.empty(build_skeleton(asked.state.height)), completed=False, reason=why)


def _windows(backend: MotionBackend, asked: Request) -> Asking:
    """One window after the other until the part is done (LINGO A.5) or has taken too long."""
    motion, state = yield backend, asked
    windows, seconds = [motion], motion.duration
    # A window without a frame would be followed by others for ever.
    while windows[-1].completion < 1 and len(windows[-1]) and not _too_long(seconds, asked):
        motion, state = yield backend, replace(asked, state=state)
        windows.append(motion)
        seconds += motion.duration
    return replace(join(windows), completion=windows[-1].completion), state


def fault(motion: Motion, asked: Request) -> str:
    """Why what was made for a part cannot stand; empty where it can."""
    if not motion.completed:
        return motion.reason
    if motion.completion < 1:
        return f"the {asked.part.kind} was not done after {motion.duration:.0f} s"
    if not len(motion):
        return ""
    shapes = (motion.root_positions.shape, motion.local_rotations.shape, motion.contacts.shape)
    frames, joints = len(motion), len(motion.skeleton.names)
    if shapes != ((frames, 3), (frames, joints, 4), (frames, 4)):
        return f"its arrays have the shapes {shapes}"
    arrays = (motion.root_positions, motion.local_rotations, motion.contacts)
    if not all(np.isfinite(array).all() for array in arrays):
        return "its motion has numbers that are not finite"
    gap = float(np.linalg.norm(motion.root_positions[0] - asked.state.history.root_positions[-1]))
    if gap > MAX_JUMP:
        return f"it begins {gap:.1f} m from where the body is"
    if _too_long(motion.duration, asked):
        return f"the {asked.part.kind} took {motion.duration:.0f} s"
    return ""


def _too_long(seconds: float, asked: Request) -> bool:
    # The way is only looked for where somebody takes his time.
    return seconds > time_limit(asked.part, 0.0) and seconds > time_limit(asked.part, _way(asked))


def _way(asked: Request) -> float:
    """Metres to walk for a part, pacing there and back counted in."""
    x, _, z = asked.state.pelvis
    walkable = scene_of(asked.home).walkable
    if asked.part.goal is None or not walkable.reachable((x, z), asked.part.goal):
        return 0.0
    path = walkable.path((x, z), asked.part.goal)
    return PACES * float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def _labelled(motion: Motion, part: Part, backend: MotionBackend, fallback: str, why: str) -> Motion:
    phases = motion.phases
    if not phases and len(motion):
        phases = (Phase(PHASE_OF[part.kind], 0, len(motion)),)
    # A backend may say itself who made a phase of it.
    reacts: Reacts | Literal[""] = part.reaction.how if part.reaction is not None else ""
    phases = tuple(
        replace(phase, backend=phase.backend or backend.name, fallback=phase.fallback or fallback, reacts=reacts)
        for phase in phases
    )
    return replace(motion, phases=phases, completed=not why, reason=why)


def _judged(motion: Motion, action: Action) -> Motion:
    """A whole action's motion with its goals, and whether they were met."""
    served = np.full(len(motion), action.keyframe, dtype=np.int32)
    motion = replace(motion, actions=served, goals=contact_goals(action), completion=1.0)
    why = motion.reason or shortfall(action, Kinematics.of(motion))
    notes = (*motion.notes, *((Note(action.keyframe, action.lacks),) if action.lacks else ()))
    return replace(motion, completed=not why, reason=why, phases=_run_together(motion.phases), notes=notes)


def _run_together(phases: Sequence[Phase]) -> tuple[Phase, ...]:
    """Neighbours of one kind by one backend as one phase: sitting down and sitting there."""
    found: list[Phase] = []
    for phase in phases:
        if found and replace(found[-1], start=phase.start, stop=phase.stop) == phase:
            phase = replace(phase, start=found.pop().start)
        found.append(phase)
    return tuple(found)


@dataclass(frozen=True)
class Segment:
    """Frames of an action that one backend made."""

    backend: str
    fallback: str | None
    """Why another backend than the one asked for made them; None where it was that one."""


def segments_of(motion: Motion) -> tuple[Segment, ...]:
    """Who made a motion, in order; neighbours by the same backend for the same reason are one."""
    found: list[Segment] = []
    for phase in motion.phases:
        segment = Segment(phase.backend, phase.fallback or None)
        if not found or found[-1] != segment:
            found.append(segment)
    return tuple(found)


def shares(motion: Motion) -> dict[str, float]:
    """The share of a motion's frames that each backend made; empty where nobody knows."""
    frames = Counter[str]()
    for phase in motion.phases:
        frames[phase.backend] += phase.stop - phase.start
    return {name: round(count / len(motion), 4) for name, count in frames.most_common() if name}


def _advance(backend: MotionBackend, asked: Request) -> Step:
    return backend.advance(asked.home, asked.part, asked.upcoming, asked.state)


def advance_many(backend: MotionBackend, requests: Sequence[Request]) -> list[Step]:
    """Many requests to one backend: in one batch where it can, else one after the other."""
    batch = getattr(backend, "advance_many", None)
    return list(batch(requests)) if batch is not None else [_advance(backend, asked) for asked in requests]


PHASE_OF = {
    PartKind.WALK: PhaseKind.WALK,
    PartKind.TURN: PhaseKind.WALK,
    PartKind.SIT: PhaseKind.SITDOWN,
    PartKind.LIE: PhaseKind.LIEDOWN,
    PartKind.REACH: PhaseKind.TOUCH,
    PartKind.RISE: PhaseKind.STANDUP,
    PartKind.HOLD: PhaseKind.STAND,
}
"""What a part counts as where its backend does not say more."""
