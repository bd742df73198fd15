"""Parts of every kind by the model of all skills: window after window towards the goals of a plan (LINGO A.4, A.5).

The procedural body does a part first: that is the plan. Of it the model is told where pelvis and hand are to be and
when, and what is done in words; the frames are its own. A scheduler ends what ends. What misses its goal, or is deeper
in furniture than may be, is made again from other noise, and else is left to the plan, with the reason.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import torch

from motion_backend import rotations
from motion_backend.backend_protocol import BodyState, History, PartKind
from motion_backend.diffusion.completion_scheduler import CompletionScheduler
from motion_backend.diffusion.goal_cleanup import (
    OVER,
    eased,
    held_shares,
    pelvis_brought,
    with_arms_of,
    with_carriage_of,
    wrist_brought,
)
from motion_backend.diffusion.guidance import HOLD, Guide, along, both, posed, reaching, towards
from motion_backend.diffusion.learned_walker import known_poses, spline
from motion_backend.diffusion.motion_features import HISTORY, STRIDE, WINDOW, HeadingFrame, to_features
from motion_backend.diffusion.passage_checks import LOST, RefusedError, check, refuse_beyond, refuse_unseen
from motion_backend.diffusion.planned_passages import PlannedPassage
from motion_backend.diffusion.rollout import Rollout, conditions
from motion_backend.diffusion.sampler import Sampler, Scale
from motion_backend.diffusion.windows import THERE
from motion_backend.furniture_clearance import arms_aside
from motion_backend.metrics.contact_error import THRESHOLDS
from motion_backend.mocap.foot_hold import held
from motion_backend.motion import FPS, Motion, Note, Phase, Skill, join
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX, Skeleton
from motion_backend.stride_takeover import ARMS_HALF_LIFE, HALF_LIFE, joined
from motion_backend.walk_driver import by_rules
from motion_backend.walk_generator import LOOK, Frames

TRIES: Final = 4
"""How often a passage is made, each time from other noise: as it comes, then a walk by the other weights, and at last
with the plan's arms; a walk takes the plan's carriage from its third try on."""
LAID_OVER: Final = "the arms are the rules', laid over it"
OTHER: Final = 2
"""Which try of a walk is made by the other weights."""
CLOSELY: Final = (HOLD, 4)
"""How a walk is pulled to its way from that try on: bends are narrow where furniture stands."""
CARRIAGE: Final = "the carriage is the rules', laid over it"
CARRIED: Final = "the arms and the carriage are the rules', laid over it"
LATER: Final = 2
"""Windows after the plan's end in which what is done may still come to its end."""
SOFTENED: Final = 0.15
"""Seconds in which half of what a walk is off at its beginning is gone; arms that swing are off by much."""
KEPT: Final = 10
"""Frames before a passage that it goes on from."""


@dataclass(frozen=True)
class Missed:
    """How far from its goal a made passage ended before it was brought there."""

    kind: PartKind
    metres: float


@dataclass(frozen=True)
class Followed:
    """A part as the model made it, and the procedural body what it could not."""

    motion: Motion
    """Its phases say who made them, and why."""
    missed: tuple[Missed, ...]
    """Of the passages that are the model's."""
    since: int
    """Frames of its last passage, for what goes on with that."""


@dataclass(frozen=True)
class PlanFollower:
    """Follows plans by a model of all skills."""

    acting: Sampler
    """Of the weights that sit, lie, rise and reach."""
    walking: Sampler
    """Of those that walk: what they learned of our own body's walks, starts, stops and turns among them."""
    scheduler: CompletionScheduler
    seen_as: Scale
    """What the scheduler sees of features."""
    name: str = "diffusion"
    watch: Callable[[Missed], None] | None = None
    """Told of each passage that is the model's."""

    def follow(
        self, passages: Sequence[PlannedPassage], notes: tuple[Note, ...], state: BodyState, arms: str = ""
    ) -> Followed:
        """Passages of a plan, one after the other, from where a state left the body.

        With `arms`, those of the plan are laid over what is made, and its phases say so in these words.
        """
        past = Frames(state.history.root_positions, state.history.local_rotations)
        made: list[Motion] = []
        missed: list[Missed] = []
        for index, passage in enumerate(passages):
            try:
                motion, away = self._tried(passage, past, [state.seed, state.index, index], arms)
                missed.append(Missed(passage.kind, away))
                if self.watch is not None:
                    self.watch(missed[-1])
            except RefusedError as error:
                motion = by_rules(passage.plan, f"{self.name}: {error}")
                if missed:
                    motion = joined(_known(past), motion, of_arms=ARMS_HALF_LIFE)
            past = past.then(_frames(motion))[-KEPT:]
            made.append(motion)
        last = passages[-1].since + len(made[-1])
        return Followed(replace(join(made), notes=notes), tuple(missed), last)

    def _tried(self, passage: PlannedPassage, past: Frames, seed: list[int], arms: str) -> tuple[Motion, float]:
        """A passage, and how far it was from its goal; of tries that can stand the one that is least in furniture.

        RefusedError where none can.
        """
        refuse_unseen(passage)
        why, best = RefusedError(""), list[tuple[int, Motion, float]]()
        for number in range(TRIES):
            try:
                body = _Body(number, self, passage.plan.skeleton, past)
                frames, laid = _laid(body.through(passage, [*seed, number]), passage, arms, number)
                frames, away = body.brought(passage, frames)
                motion = _settled(past, frames, passage, Phase(passage.phase, 0, len(frames), self.name, laid))
                if passage.is_free:
                    motion = arms_aside(motion, passage.part, scene_of(passage.home).obstacles)
                deeper = check(motion, passage, past)
                best = sorted([*best, (deeper, motion, away)], key=lambda one: one[0])
                if not deeper:
                    break
            except RefusedError as error:
                why = error
        if not best:
            raise why
        return best[0][1:]

    def sampler(self, passage: PlannedPassage, number: int) -> Sampler:
        """Whose weights make a try: both know our own body's walks, one better in stride, one from other poses."""
        if not passage.is_periodic:
            return self.acting
        return self.acting if number == OTHER else self.walking


@dataclass
class _Body:
    """A body that goes on window after window, in one of the tries."""

    number: int
    follower: PlanFollower
    skeleton: Skeleton
    past: Frames
    """At 30 a second, in the world."""

    def through(self, passage: PlannedPassage, seed: list[int]) -> Frames:
        """The frames of a passage, as they are made."""
        if passage.is_seat and not passage.since:
            return self._ending(passage, seed)
        return self._lasting(passage, seed)

    def _lasting(self, passage: PlannedPassage, seed: list[int]) -> Frames:
        """A passage that lasts as long as its plan: the first window is cut, so that the last one ends with it."""
        frames = len(passage.plan)
        first = frames % LOOK or LOOK
        made, past = None, self.past
        while made is None or len(made) < frames:
            window, _ = self._window(passage, 0 if made is None else len(made), past, seed)
            window = window[: first if made is None else LOOK]
            made, past = window if made is None else made.then(window), past.then(window)
        return made

    def _ending(self, passage: PlannedPassage, seed: list[int]) -> Frames:
        """A passage that is over when the scheduler says so. RefusedError where it never does."""
        made, past = None, self.past
        while made is None or len(made) < len(passage.plan) + LATER * LOOK:
            window, over = self._window(passage, 0 if made is None else len(made), past, seed)
            made, past = window if made is None else made.then(window), past.then(window)
            # Arms that come to a held pose come to it after the pelvis has come to its seat.
            done = over and len(made) >= len(passage.plan)
            if done and np.linalg.norm(made.root[-1] - passage.plan.root_positions[-1]) < LOST:
                return made[: max(len(passage.plan), _arrived(made, passage))]
        raise RefusedError(f"the {passage.phase} was not over after {len(made) / FPS:.1f} s")

    def _window(self, passage: PlannedPassage, done: int, past: Frames, seed: list[int]) -> tuple[Frames, bool]:
        """The next 42 frames, and whether what is done is over with them."""
        known = known_poses(past)
        sampler = self.follower.sampler(passage, self.number)
        body = Rollout(sampler, self.skeleton, known)
        seen = sampler.denoiser.conditions.scene is not None
        wish = passage.wish(done, body.frame, seen)
        after = body.go_on(wish, [*seed, done], self._guide(passage, done, body))
        keys = Frames(after.poses.roots[0, HISTORY - 1 :], after.poses.local[0, HISTORY - 1 :])
        found, _ = spline(keys, _key_speed(past))
        if not passage.is_seat:
            return found, False
        told = conditions(wish, body.frame)
        features = to_features(after.poses.frames(slice(-WINDOW, None)), body.frame, self.skeleton)
        window = self.follower.seen_as.encode(torch.from_numpy(features.astype(np.float32)))
        return found, bool(self.follower.scheduler.over(window, told.text, told.frame)[0])

    def _guide(self, passage: PlannedPassage, done: int, body: Rollout) -> Guide | None:
        """Walks are pulled to their way, hands to their goal, and bodies to how they sit, at last to their seat."""
        frame = body.frame
        if passage.is_periodic:
            way = frame.inward(passage.way(done))[None, :, [0, 2]]
            kept = along(torch.from_numpy(way.astype(np.float32)), *(CLOSELY if self.number >= OTHER else ()))
            stood = _posed(passage, done, frame, passage.standing(done))
            return kept if stood is None else both(kept, stood)
        if passage.hand is not None:
            goal, left = passage.hand
            return reaching(frame.inward(goal[None])[0], left, passage.held(done))
        if not passage.is_seat:
            return None
        # Who rises leaves his pose by himself.
        held = None if passage.kind is PartKind.RISE else _posed(passage, done, frame, passage.settled(done))
        if passage.due > done + LOOK:
            return held
        # A body that is pulled up faster than its legs stretch leaves the floor: then it rises by itself.
        by_itself = passage.kind is PartKind.RISE and self.number % 2
        axes = (0, 2) if by_itself else (0, 1, 2)
        place = frame.inward(passage.plan.root_positions[-1].astype(np.float64)[None])[:, axes]
        seated = towards(torch.from_numpy(place.astype(np.float32)), axes)
        return seated if held is None else both(seated, held)

    def brought(self, passage: PlannedPassage, made: Frames) -> tuple[Frames, float]:
        """Frames with pelvis or hand at the goal at last, and how far it was. RefusedError where it was too far."""
        if passage.hand is not None:
            return self._hand_brought(passage, made, *passage.hand)
        away = passage.plan.root_positions[-1].astype(np.float64) - made.root[-1]
        if not passage.is_seat:
            away[1] = 0.0
        far = float(np.linalg.norm(away))
        refuse_beyond(far, LOST, passage)
        return pelvis_brought(made, away, OVER if passage.is_seat else LOOK), far

    def _hand_brought(self, passage: PlannedPassage, made: Frames, goal: Array, left: bool) -> tuple[Frames, float]:
        """The same of a hand: it is at its goal when the plan's is, and while it stays it moves as that does."""
        side, due = "left" if left else "right", min(passage.due, len(made) - 1)
        wrist, planned = (
            places[: len(made), INDEX[f"{side}_wrist"]].astype(np.float64)
            for places in (
                self.skeleton.forward_kinematics(made.root, made.local)[0],
                passage.plan.joint_positions(),
            )
        )
        away = float(np.linalg.norm(goal - wrist[due]))
        refuse_beyond(away, THRESHOLDS[Skill.TOUCH], passage)
        shares = held_shares(np.arange(len(made)), due, round(passage.part.hold * FPS))
        return wrist_brought(made, self.skeleton, side, shares[:, None] * (planned - wrist)), away


def _posed(passage: PlannedPassage, done: int, frame: HeadingFrame, shares: Array) -> Guide | None:
    """The pose of a plan in the window after `done` frames, held by shares (14,); None where it is held in none."""
    if not shares.any():
        return None
    pose, held = (torch.from_numpy(one.astype(np.float32)) for one in (passage.pose(done, frame), shares))
    return posed(pose, held)


def _key_speed(past: Frames) -> tuple[Array, Array]:
    """At the end of the frames of a body, of its pelvis and of its rotations' components, a frame at 10 a second."""
    if len(past) < 3:
        return np.zeros_like(past.root[-1]), np.zeros_like(past.local[-1])
    turns = rotations.continuous(past.local[: -len(past) - 1 : -1][:3])[::-1]
    # The slope at the end of the parabola through the last three.
    root, turn = (STRIDE * (3 * last[-1] - 4 * last[-2] + last[-3]) / 2 for last in (past.root[-3:], turns))
    return root, turn


def _arrived(made: Frames, passage: PlannedPassage) -> int:
    """Frames until the pelvis is as near to where it is to be as it comes, and stays so near."""
    away = np.linalg.norm(made.root - passage.plan.root_positions[-1], axis=1)
    later = np.flatnonzero(away > away.min() + THERE)
    return int(later[-1]) + 1 if len(later) else len(made)


def _laid(frames: Frames, passage: PlannedPassage, arms: str, number: int) -> tuple[Frames, str]:
    """Frames with what of the plan is laid over a try, come to over a while, and the words for it.

    What words did not make of a walk its carriage may; arms are laid over where they are the plan's, and at last.
    """
    at = np.minimum(np.arange(len(frames)), len(passage.plan) - 1)
    # Who sits there already has come to it: what is left to the plan's arms dies away behind the seam.
    plan, share = _frames(passage.plan), eased((np.arange(len(frames)) + 1) / (1 if passage.since else OVER))
    plan = Frames(plan.root[at], plan.local[at])
    carried, last = passage.is_periodic and number > 0, number == TRIES - 1
    if carried:
        frames = with_carriage_of(frames, plan, share)
    if arms or last:
        frames = with_arms_of(frames, plan.local, share)
    if carried:
        return frames, CARRIED if arms or last else CARRIAGE
    return frames, arms or (LAID_OVER if last else "")


def _settled(past: Frames, frames: Frames, passage: PlannedPassage, phase: Phase) -> Motion:
    """Frames as motion that goes on from the past, with standing feet held where they stand.

    What the two were apart dies away before feet are held: it would drag them along. Who sits or lies there has them
    where they rest.
    """
    skeleton, count = passage.plan.skeleton, len(frames)
    half_life = SOFTENED if passage.is_periodic else HALF_LIFE
    begun = joined(_known(past), _motion(frames, np.zeros((count, 4)), passage, phase), half_life, ARMS_HALF_LIFE)
    if passage.since:
        at = np.minimum(np.arange(count), len(passage.plan) - 1)
        return replace(begun, contacts=passage.plan.contacts[at])
    whole, new = past.then(_frames(begun)), slice(len(past), None)
    root, local, contacts = held(whole.root, whole.local, skeleton, len(past))
    return _motion(Frames(root[new], local[new]), contacts[new], passage, phase)


def _motion(frames: Frames, contacts: Array, passage: PlannedPassage, phase: Phase) -> Motion:
    return Motion(
        root_positions=frames.root.astype(np.float32),
        local_rotations=frames.local.astype(np.float32),
        contacts=contacts.astype(np.float32),
        skeleton=passage.plan.skeleton,
        actions=np.full(len(frames), passage.part.action.keyframe, dtype=np.int32),
        phases=(phase,),
    )


def _known(past: Frames) -> History:
    """Frames of a body as its history."""
    return History.of(past.root, past.local, np.zeros((len(past), 4)))


def _frames(motion: Motion) -> Frames:
    return Frames(motion.root_positions.astype(np.float64), motion.local_rotations.astype(np.float64))
