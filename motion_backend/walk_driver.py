"""Parts of kind walk by any generator of walking frames: the way, starts, stops and turns are the procedural body's.

That body walks the part first. Where it goes ahead at a walking pace its frames give way to the generator's, which go
the same way at the same speed; then it takes over again in the stride that the generator left the body in, and comes
to the place, the stop and the turn that the part asks for. Every phase says who made it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Protocol

import numpy as np

from motion_backend import rotations
from motion_backend.backend_protocol import BodyState, History, Part
from motion_backend.furniture_clearance import arms_aside
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import CLEARLY_IN, penetration
from motion_backend.mocap.foot_hold import held
from motion_backend.motion import FPS, Action, Character, Emotion, Motion, Phase, PhaseKind, join
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.takeover import pose_of
from motion_backend.procedural.walk.stride import Stride
from motion_backend.procedural.walk.walk_styles import Walk, style_of, walk_style
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX, build_skeleton
from motion_backend.stride_takeover import ARMS_HALF_LIFE, ONSET, joined, stride_of, strides_landing
from motion_backend.walk_generator import Frames, WalkGenerator, Way, windows, yaw_of
from scene_graphs.home import Home

SMOOTH: Final = 6.0
"""Width of the bell (frames) that takes a body's sway out of its way."""
AHEAD: Final = np.radians(45.0)
"""Who moves farther from where he faces does not walk ahead."""
FULL: Final = 0.7
"""Of the fastest pace of a walk: below it is being started or stopped. Who takes over in a start flings its foot."""
SHORTEST: Final = 24
"""Frames that are worth a generator's."""
BEND: Final = 2.0
"""Radians a metre that a way bends at most where it is walked by recorded frames, which are straight for the most."""
SLOWEST: Final = 0.1
"""Metres in two thirds of a second, under which a bend is not told."""
FASTEST: Final = 2.0
"""Metres a second, beyond which people run."""
LATER: Final = 12
"""Frames of its way beyond the stretch that a generator is to walk, in which its last step may end."""
OFF: Final = 0.2
"""Metres beside its way at which a generator's body has lost it."""
PASSES, BY = 0.25, 10
"""Metres from a place within which it is passed by, and frames in which that was just now."""
BEYOND: Final = 20
"""Frames that are made beyond such a place, so that a heel comes down by it: a step has some 16."""
WAITS, EVERY, GENTLE = 12, 3, 0.8
"""Frames that a generator may wait to take over, how often it is tried in them, and metres a second from frame to frame
by which a joint changes its speed in a stride: who takes over in another phase of it flings a foot."""
EARLIER: Final = 5
"""Steps that are tried for the last one of a stretch, from the farthest one back, while the rest is in furniture."""
CARRIAGE_S: Final = 0.5
"""Seconds in which a mood's bend of trunk and head comes and goes."""
_BENT: Final = {"spine1": 1 / 3, "spine2": 1 / 3, "spine3": 1 / 3}
_NODS: Final = {"neck": 0.5, "head": 0.5}
"""Shares of the joints that bend."""
FREE: Final = {"bounce": 0.02, "sway": 0.06, "swing": 26.0, "twist": 10.0, "hips": 7.0, "elbow": 25.0}
"""What captions of plain walks may ask for, up to this: people do that of themselves."""
OWN: Final = frozenset({"speed", "bearing", "character", "release", "stride", "roll", "strike", *FREE})
"""What a caption may say of a walk that is still a plain one."""
BORROWED: Final = "borrowed"
"""What a state remembers whose stride was another body's than the one that remembers it."""
ITSELF: Final = 0.002
"""Metres that its joints may be off for a body to be itself again."""
HURRY: Final = (0.7, 1.4)
"""How much slower and faster than the procedural body a generator may go that has a pace of its own."""
MOST, AGAIN = 5, 15
"""Stretches of one part, and the frames of the procedural body between two of them at least."""
LEAST: Final = 12
"""Frames of a stretch that was cut off, of any use."""
TOO_SHORT: Final = "the way is too short, or too winding, to get into a stride"
STARTS_AND_STOPS: Final = "starts, stops and turns on the spot are the rules'"


class Follower(Protocol):
    """Something that does what the procedural body would do, in frames of its own."""

    def act(self, home: Home, part: Part, plan: Motion, state: BodyState, frames: int) -> Motion:
        """So many frames of a plan done by somebody else, who sees how it goes on; where he cannot, those of the plan.

        Its phases say who made it, and why.
        """
        ...


@dataclass(frozen=True)
class WalkDriver:
    """Walks parts by a generator's frames."""

    generator: WalkGenerator
    follower: Follower | None = None
    """Who does what the generator does not; None: the procedural body."""

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """Standing in the home, as the procedural body does."""
        return ProceduralBackend().begin(home, character, seed)

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Do a walk. What the generator has no part in is the procedural body's, with the reason."""
        index, made = state.index, list[Motion]()
        style, why = style_of(part.action), unlike_people(part.action)
        least = 0
        walk = _Walk.of(home, part, tuple(upcoming), state, style)
        for _ in range(MOST):
            stretch = None if why else plain_stretch(walk.ruled, self.generator.slowest, least)
            if not walk.ruled.completed or stretch is None:
                why = why or (TOO_SHORT if not made else STARTS_AND_STOPS)
                break
            lead = min(stretch[0] + WAITS, stretch[1] - SHORTEST) if stretch[0] else 0
            led = self._acted(walk, lead, STARTS_AND_STOPS) if lead else None
            found = self._stretch(walk, stretch, led)
            if found is None and led is not None:
                led = by_rules(walk.ruled.part(0, lead), STARTS_AND_STOPS)
                found = self._stretch(walk, stretch, led)
            if found is None:
                why = f"{self.generator.name} finds no room"
                break
            made += [led.part(0, found.start), found.motion] if led is not None else [found.motion]
            if found.onward is None:
                return join(made), replace(found.state, index=index + 1)
            walk, least, why = found.onward, AGAIN, ""
        else:
            why = STARTS_AND_STOPS
        if not len(walk.ruled) and not made:
            return walk.ruled, walk.after
        rest, after = self._rest(walk, walk.ruled.reason or why)
        return join([*made, rest]), replace(after, index=index + 1)

    def _acted(self, walk: _Walk, frames: int, why: str) -> Motion:
        """The first frames of the procedural body's walk by the follower, or by itself."""
        if self.follower is None or not frames:
            return by_rules(walk.ruled.part(0, frames), why)
        return self.follower.act(walk.home, walk.part, walk.onward, walk.state, frames)

    def _rest(self, walk: _Walk, why: str) -> tuple[Motion, BodyState]:
        """What is left of a walk once no stretch of it is the generator's any more, and the state after it."""
        motion = self._acted(walk, len(walk.onward), why)
        if not walk.ruled.completed or all(phase.backend == ProceduralBackend.name for phase in motion.phases):
            return by_rules(walk.ruled, walk.ruled.reason or _told(motion) or why), walk.after
        if walk.stride is None:
            memory = {**walk.after.memory, BORROWED: True}
            return motion, replace(walk.after, history=walk.state.history.followed_by(motion), memory=memory)
        places = motion.joint_positions().astype(np.float64)
        last = _landing_by(places, np.array(walk.part.goal))
        if last is None:
            return by_rules(walk.ruled, f"{self.generator.name} comes by in no step"), walk.after
        motion = motion.part(0, last + 1)
        beyond = walk.way[_nearest(walk.way, places[last, 0][[0, 2]]) + 1 :]
        return motion, _in_stride(replace(walk.after, history=walk.state.history.followed_by(motion)), walk, beyond)

    def _stretch(self, walk: _Walk, stretch: tuple[int, int], led: Motion | None) -> _Stretch | None:
        """A stretch of a walk by the generator, feet held, that ends as a heel comes down; None where it finds no room.

        `led` is what leads up to it. It ends before the body would be in furniture, or beside its way, and a step
        earlier where the procedural body would come into furniture in the stride that it takes over.
        """
        set_out = self._set_out(walk, stretch, led)
        skeleton, past, places = walk.ruled.skeleton, set_out.past, set_out.places
        made = past.then(set_out.first)
        for found in set_out.windows:
            made = made.then(found)
        made = in_mood(made, walk.part.action, len(past))
        root, local, contacts = held(made.root * skeleton.scale, made.local, skeleton, len(past))
        motion = Motion(
            root_positions=root[len(past) :].astype(np.float32),
            local_rotations=local[len(past) :].astype(np.float32),
            contacts=contacts[len(past) :].astype(np.float32),
            skeleton=skeleton,
            actions=np.full(len(root) - len(past), walk.part.action.keyframe, dtype=np.int32),
        )
        motion = arms_aside(motion, walk.part, scene_of(walk.home).obstacles)
        body = Kinematics.of(motion)
        end, found = places[min(set_out.frames, len(places) - 1)], list[_Stretch]()
        for count in _steps_end(body.positions[: walk.free(body)], end)[:EARLIER]:
            if count < LEAST:
                break
            taken = replace(motion.part(0, count), phases=(Phase(PhaseKind.WALK, 0, count, self.generator.name),))
            gone = _nearest(places[: set_out.frames + LATER], root[len(past) + count - 1, [0, 2]])
            found.append(walk.after_stretch(set_out, taken, places[gone + 1 :]))
            if found[-1].deep <= max(walk.deep, CLEARLY_IN):
                break
        return min(found, key=lambda one: max(one.deep, CLEARLY_IN), default=None)

    def _set_out(self, walk: _Walk, stretch: tuple[int, int], led: Motion | None) -> _SetOut:
        """The generator's first window of a stretch: after as much of what leads up to it as lets it fling no joint."""
        before, scale, found = walk.state.history, walk.ruled.skeleton.scale, list[_SetOut]()
        starts = range(stretch[0], len(led) + 1, EVERY) if led is not None else [stretch[0]]
        step = walk.hurry(stretch, self.generator.pace)
        for start in starts:
            history = before.followed_by(led.part(0, start)) if led is not None else before
            places, frames = _hastened(walk.way[start:], step), max(int((stretch[1] - start) / step), 1)
            past = Frames(history.root_positions / scale, history.local_rotations)
            rng = np.random.default_rng([walk.state.seed, walk.state.index, len(history), start])
            ahead = windows(self.generator.begin(past, rng), past, Way(places[: frames + LATER] / scale))
            found.append(_SetOut(start, frames, history, past, places, next(ahead), ahead))
            if found[-1].flung < GENTLE:
                break
        return min(found, key=lambda one: one.flung)


@dataclass(frozen=True)
class _SetOut:
    """A generator that has taken over a body."""

    start: int
    """The frame of the walk in which it does."""
    frames: int
    """For which it is to walk."""
    history: History
    past: Frames
    places: Array
    """Its way, one place a frame. (N, 2)."""
    first: Frames
    """Its first window."""
    windows: Iterator[Frames]
    """Those after that."""

    @cached_property
    def flung(self) -> float:
        """By how many metres a second the fastest joint changes its speed from frame to frame as it takes over."""
        over = self.past[-2:].then(self.first[:ONSET])
        places = build_skeleton().forward_kinematics(over.root, over.local)[0].astype(np.float64)
        return float(np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max(initial=0.0)) * FPS


@dataclass(frozen=True)
class _Stretch:
    """Frames of a generator, and how the walk goes on after them."""

    start: int
    """The frame of the walk in which they begin."""
    motion: Motion
    state: BodyState
    onward: _Walk | None
    """As the procedural body does what is left of it; None where it is over."""

    @property
    def deep(self) -> float:
        """How deep the procedural body is in furniture then (metres)."""
        return 0.0 if self.onward is None else self.onward.deep


@dataclass(frozen=True)
class _Walk:
    """A walk as the procedural body did it."""

    home: Home
    part: Part
    upcoming: tuple[Part, ...]
    state: BodyState
    """Before it."""
    style: Walk
    ruled: Motion
    after: BodyState
    """What that left."""

    @staticmethod
    def of(home: Home, part: Part, upcoming: tuple[Part, ...], state: BodyState, style: Walk) -> _Walk:
        """From a state."""
        return _Walk(home, part, upcoming, state, style, *ruled(home, part, upcoming, state))

    @property
    def stride(self) -> Stride | None:
        """What the procedural body was in at the end; None where it stopped."""
        told = self.after.memory.get("stride")
        return Stride.from_lists(told) if told else None

    @cached_property
    def onward(self) -> Motion:
        """What the procedural body did, and where it does not stop a step and a bit of how it goes on."""
        if self.stride is None or not self.upcoming:
            return self.ruled
        later, _ = ProceduralBackend().advance(self.home, self.upcoming[0], self.upcoming[1:], self.after)
        return _led_on(self.ruled, later.part(0, min(BEYOND, len(later))))

    @cached_property
    def way(self) -> Array:
        """Where its pelvis goes, without its sway, and on from there where it does not stop. (N, 2)."""
        places = _way_of(self.ruled)
        if self.stride is None:
            return places
        onward = Way.along(np.concatenate([places[-1:], self.stride.rest[1:]]), max(self.stride.speed, SLOWEST)).places
        return np.concatenate([places, onward[1:]])

    def to_goal(self, beyond: Array) -> Array:
        """Of the way that is left what leads to the place of this part: of one that goes on, no more than that."""
        if self.stride is None or self.part.goal is None or not len(beyond):
            return beyond
        return beyond[: _nearest(beyond, np.array(self.part.goal)) + 1]

    def is_over(self, motion: Motion) -> bool:
        """Whether a motion has passed the place by which the way goes on."""
        return self.stride is not None and self.part.goal is not None and self._passes(motion) < PASSES

    def _passes(self, motion: Motion) -> float:
        """How near a motion comes to the place (metres)."""
        goal = np.asarray(self.part.goal, dtype=np.float64)
        return float(np.linalg.norm(motion.root_positions[:, [0, 2]] - goal, axis=1).min())

    def after_stretch(self, set_out: _SetOut, motion: Motion, beyond: Array) -> _Stretch:
        """How it goes on after a motion that ended as a heel came down, whose way is `beyond` (N, 2) then."""
        state = replace(self.state, history=set_out.history.followed_by(motion))
        if self.is_over(motion):
            return _Stretch(set_out.start, motion, _in_stride(state, self, beyond), None)
        state = _in_stride(state, self, self.to_goal(beyond))
        return _Stretch(set_out.start, motion, state, _Walk.of(self.home, self.part, self.upcoming, state, self.style))

    @cached_property
    def deep(self) -> float:
        """How deep the procedural body is in furniture (metres)."""
        return float(penetration(Kinematics.of(self.ruled), scene_of(self.home).obstacles, None).max(initial=0.0))

    def hurry(self, stretch: tuple[int, int], pace: float | None) -> float:
        """How much faster somebody goes a stretch who usually walks at `pace`, in the mood that the walk is in."""
        if pace is None:
            return 1.0
        way = self.way[slice(*stretch)] / self.ruled.skeleton.scale
        planned = FPS * float(np.median(np.linalg.norm(np.diff(way, axis=0), axis=1)))
        mood = self.style.speed / walk_style(Emotion.NEUTRAL, "walk").speed
        return float(np.clip(mood * pace / max(planned, SLOWEST), *HURRY))

    def free(self, body: Kinematics) -> int:
        """How many of a body's frames come before it is clearly in furniture, or has lost its way."""
        obstacles = scene_of(self.home).obstacles
        places = body.positions[:, 0][:, [0, 2]]
        off = np.sqrt(((places[:, None] - self.way[None]) ** 2).sum(axis=2)).min(axis=1)
        lost = (penetration(body, obstacles, None) > CLEARLY_IN) | (off > OFF)
        return int(np.argmax(lost)) if lost.any() else len(lost)


def ruled(home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
    """A part as the procedural body does it from here on, whoever moved the body before."""
    motion, after = ProceduralBackend().advance(home, part, upcoming, state)
    if state.memory.get(BORROWED) and len(motion):
        own, motion = motion, joined(state.history, motion, of_arms=ARMS_HALF_LIFE)
        after = replace(after, history=state.history.followed_by(motion))
        if _apart(own, motion) > ITSELF:
            after = replace(after, memory={**after.memory, BORROWED: True})
    return motion, after


def _apart(one: Motion, other: Motion) -> float:
    """How far joints of two motions are from each other in their last frame (metres)."""
    places = [motion.part(len(motion) - 1, len(motion)).joint_positions() for motion in (one, other)]
    return float(np.linalg.norm(places[0] - places[1], axis=-1).max())


def by_rules(motion: Motion, why: str) -> Motion:
    """A motion of the procedural body, labelled so."""
    phases = tuple(replace(phase, backend=ProceduralBackend.name, fallback=why) for phase in motion.phases)
    return replace(motion, phases=phases)


def unlike_people(action: Action) -> str:
    """Why no plain walk serves an action; empty where one does."""
    style = style_of(action)
    usual = walk_style(action.emotion, "walk")
    odd = [name for name in vars(style) if name not in OWN and getattr(style, name) != getattr(usual, name)]
    odd += [name for name, most in FREE.items() if getattr(style, name) > max(most, getattr(usual, name))]
    odd += ["arms"] * (style.bearing.arms != usual.bearing.arms) + ["wobble"] * bool(usual.wobble)
    if style.speed > FASTEST:
        return "nobody runs in recorded walks"
    return f"no recorded walk is like {action.caption!r:.40} ({', '.join(odd)})" if odd else ""


def plain_stretch(motion: Motion, slowest: float, least: int = 0) -> tuple[int, int] | None:
    """The longest stretch of a motion that is plain walking ahead, from frame to frame; None where it is short.

    It does not begin before frame `least`.
    """
    if len(motion) < SHORTEST:
        return None
    steps = np.gradient(_way_of(motion), axis=0) * FPS
    pace = np.linalg.norm(steps, axis=1)
    facing = _smooth(np.unwrap(yaw_of(motion.local_rotations[:, 0].astype(np.float64))))
    ahead = np.abs(rotations.wrap(np.arctan2(steps[:, 0], steps[:, 1]) - facing)) < AHEAD
    scale = motion.skeleton.scale
    walks = ahead & (pace > max(slowest * scale, FULL * float(pace.max()))) & (pace < FASTEST * scale)
    yaw, gone = np.unwrap(np.arctan2(steps[:, 0], steps[:, 1])), np.cumsum(pace) / FPS
    reach = FPS // 3
    turned = np.abs(yaw[2 * reach :] - yaw[: -2 * reach]) / np.maximum(gone[2 * reach :] - gone[: -2 * reach], SLOWEST)
    walks &= np.pad(turned * scale, (reach, reach), mode="edge") < BEND
    walking = [phase for phase in motion.phases if phase.kind is PhaseKind.WALK]
    in_walk = np.zeros(len(motion), dtype=np.bool_)
    for phase in walking:
        in_walk[max(phase.start, least) : phase.stop] = True
    edges = np.flatnonzero(np.diff(np.concatenate([[False], walks & in_walk, [False]]).astype(np.int8)))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return None
    start, stop = runs[int(np.argmax(runs[:, 1] - runs[:, 0]))].tolist()
    quick = np.flatnonzero(pace[start:stop] > FULL * float(pace.max()))
    stop = start + int(quick.max(initial=-1)) + 1
    return (start, stop) if stop - start >= SHORTEST else None


def _way_of(motion: Motion) -> Array:
    """Where a pelvis goes, without its sway. (T, 2)."""
    return _smooth(motion.root_positions[:, [0, 2]].astype(np.float64))


def _smooth(values: Array) -> Array:
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(values, SMOOTH, axis=0, mode="nearest"))


def _hastened(places: Array, step: float) -> Array:
    """A way of one place a frame gone at `step` times its speed. (N, 2) to (M, 2)."""
    if step == 1:
        return places
    at = np.arange(0.0, len(places) - 1, step)
    return np.stack([np.interp(at, np.arange(len(places)), places[:, axis]) for axis in (0, 1)], axis=1)


def _led_on(motion: Motion, later: Motion) -> Motion:
    """A motion whose last phase lasts as long as the frames that are put after it."""
    *before, last = motion.phases
    whole = join([motion, replace(later, actions=np.full(len(later), motion.actions[-1], dtype=np.int32))])
    return replace(
        motion,
        root_positions=whole.root_positions,
        local_rotations=whole.local_rotations,
        contacts=whole.contacts,
        actions=whole.actions,
        phases=(*before, replace(last, stop=len(whole))),
    )


def _told(motion: Motion) -> str:
    """Why somebody else than the one asked for made a motion."""
    return next((phase.fallback for phase in motion.phases if phase.fallback), "")


def _nearest(places: Array, place: Array) -> int:
    return int(np.argmin(np.sum((places - place) ** 2, axis=1)))


def in_mood(made: Frames, action: Action, fixed: int) -> Frames:
    """Trunk and head bent as a mood and a caption bend them, besides what the generator does."""
    plain, moody = style_of(action).bearing, Bearing()
    lean, nod = np.radians(plain.lean - moody.lean), np.radians(plain.head - moody.head)
    if not lean and not nod:
        return made
    ease = np.clip((np.arange(len(made)) - fixed + 1) / (CARRIAGE_S * FPS), 0.0, 1.0)
    local = made.local.copy()
    for joints, angle in ((_BENT, lean), (_NODS, nod)):
        for name, share in joints.items():
            bend = rotations.axis_to_quat("x", ease * share * angle)
            local[:, INDEX[name]] = rotations.compose(local[:, INDEX[name]], bend)
    return Frames(made.root, local)


def _steps_end(positions: Array, end: Array) -> list[int]:
    """Counts of frames (T, 22, 3) up to where heels come down: first the nearest to a place (2,), then earlier ones."""
    landing = strides_landing(positions)
    if not len(landing):
        return [len(positions)] if len(positions) else []
    last = _nearest(positions[landing, 0][:, [0, 2]], end)
    return [int(at) + 1 for at in landing[last::-1]]


def _landing_by(positions: Array, goal: Array) -> int | None:
    """The last frame of (T, 22, 3) in which a heel comes down as the body has just come by a place (2,)."""
    near = np.linalg.norm(positions[:, 0][:, [0, 2]] - goal, axis=1) < PASSES
    begun = max(int(np.argmax(near)) - BEYOND, 0)
    # Of strides about there alone: before a bend they are shorter.
    landing = [begun + int(at) for at in strides_landing(positions[begun:])]
    landing = [at for at in landing if near[max(at - BY, 0) : at + 1].any()]
    return landing[-1] if landing else None


def _in_stride(state: BodyState, walk: _Walk, beyond: Array) -> BodyState:
    """The state that lets the procedural body go on in the stride that the last frames are in."""
    skeleton = walk.ruled.skeleton
    rest = beyond if len(beyond) else np.array([walk.part.goal])
    stride = stride_of(state.history, skeleton, walk.style, rest)
    pose = pose_of(state.history, skeleton).to_lists()
    memory = {"pose": pose, "holds": [None, None], "tail": None, "stride": stride.to_lists(), BORROWED: True}
    return replace(state, backend=ProceduralBackend.name, memory=memory)
