"""Parts of kind walk by any generator of walking frames: the way, starts, stops and turns are the procedural body's.

That body walks the part first. Where it goes ahead at a walking pace its frames give way to the generator's, which go
the same way at the same speed; then it takes over again in the stride that the generator left the body in, and comes
to the place, the stop and the turn that the part asks for. Every phase says who made it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.backend_protocol import BodyState, History, Part
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import penetration
from motion_backend.mocap.foot_hold import held
from motion_backend.motion import FPS, Action, Character, Motion, Phase, PhaseKind, Skill, join
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.takeover import pose_of
from motion_backend.procedural.walk.stride import Stride
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX
from motion_backend.stride_takeover import joined, stride_of, strides_landing
from motion_backend.walk_generator import Frames, WalkGenerator, Way, windows, yaw_of
from scene_graphs.home import Home

SMOOTH: Final = 6.0
"""Width of the bell (frames) that takes a body's sway out of its way."""
AHEAD: Final = np.radians(35.0)
"""Who moves farther from where he faces does not walk ahead."""
STARTED, STOPPING = 0.55, 0.85
"""Of the fastest pace of a walk: from the first on it has been started, below the second it is being stopped."""
SHORTEST: Final = 30
"""Frames that are worth a generator's."""
BEND: Final = 1.2
"""Radians a metre that a way bends at most where it is walked by recorded frames, which are straight for the most."""
SLOWEST: Final = 0.1
"""Metres in two thirds of a second, under which a bend is not told."""
FASTEST: Final = 2.0
"""Metres a second, beyond which people run."""
LATER: Final = 12
"""Frames of its way beyond the stretch that a generator is to walk, in which its last step may end."""
OFF: Final = 0.2
"""Metres beside its way at which a generator's body has lost it."""
PASSES: Final = 0.2
"""Metres from a place within which it is passed by."""
DEEPER: Final = 0.02
"""Metres by which a generator's body may be deeper in furniture than the procedural one."""
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
STARTS_AND_STOPS: Final = "starts, stops and turns on the spot are the rules'"


@dataclass(frozen=True)
class WalkDriver:
    """Walks parts by a generator's frames."""

    generator: WalkGenerator

    @property
    def _rules(self) -> ProceduralBackend:
        return ProceduralBackend()

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """Standing in the home, as the procedural body does."""
        return self._rules.begin(home, character, seed)

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Do a walk. Where the generator has no part in it, all of it is the procedural body's, with the reason."""
        ruled, after = self._rules.advance(home, part, upcoming, state)
        if state.memory.get(BORROWED):
            ruled = joined(state.history, ruled)
        if not len(ruled) or not ruled.completed:
            return self._by_rules(ruled, ruled.reason), after
        why = unlike_people(part.action)
        stretch = None if why else plain_stretch(ruled, self.generator.slowest)
        if stretch is None:
            return self._by_rules(ruled, why or "the way is too short to get into a stride"), after
        walk = _Walk(home, part, tuple(upcoming), state, ruled, after)
        made, left = self._walked(walk, stretch)
        if astray := _astray(made, walk):
            return self._by_rules(ruled, f"{self.generator.name} {astray}"), after
        deeper = _depth(made, home) - _depth(ruled, home)
        if deeper > DEEPER:
            return self._by_rules(ruled, f"{self.generator.name} was {100 * deeper:.0f} cm deeper in furniture"), after
        return made, left

    def _by_rules(self, motion: Motion, why: str) -> Motion:
        """A motion of the procedural body, labelled so."""
        phases = tuple(replace(phase, backend=self._rules.name, fallback=why) for phase in motion.phases)
        return replace(motion, phases=phases)

    def _walked(self, walk: _Walk, stretch: tuple[int, int]) -> tuple[Motion, BodyState]:
        """The procedural beginning, the generator's stretch of the way, and the procedural end."""
        start = stretch[0]
        history = walk.state.history.followed_by(walk.ruled.part(0, start)) if start else walk.state.history
        motion, beyond = self._stretch(walk, history, stretch)
        begun = self._by_rules(walk.ruled.part(0, start), STARTS_AND_STOPS)
        state = replace(walk.state, history=history.followed_by(motion))
        onward = _in_stride(state, walk, beyond)
        if walk.goes_on:
            return join([begun, motion]), replace(onward, index=walk.after.index, posture=walk.after.posture)
        ended, after = self._rules.advance(walk.home, walk.part, walk.upcoming, onward)
        ended = joined(state.history, ended)
        return join([begun, motion, self._by_rules(ended, STARTS_AND_STOPS)]), replace(
            after, index=walk.after.index, history=state.history.followed_by(ended)
        )

    def _stretch(self, walk: _Walk, history: History, stretch: tuple[int, int]) -> tuple[Motion, Array]:
        """The generator's frames, feet held and ending as a foot has come down, and the way (N, 2) that is left."""
        skeleton, (start, stop) = walk.ruled.skeleton, stretch
        scale = skeleton.scale
        past = Frames(history.root_positions / scale, history.local_rotations)
        way = Way(walk.way[start:] / scale)
        rng = np.random.default_rng([walk.state.seed, walk.state.index, 1])
        made = past
        for found in windows(self.generator.begin(past, rng), past, Way(way.places[: stop - start + LATER])):
            made = made.then(found)
        made = _carried(made, walk.part.action, len(past))
        root, local, contacts = held(made.root * scale, made.local, skeleton, len(past))
        positions = skeleton.forward_kinematics(root, local)[0].astype(np.float64)
        last = _steps_end(positions[len(past) :], way.places[min(stop - start, len(way) - 1)] * scale) + len(past)
        taken, count = slice(len(past), last + 1), last + 1 - len(past)
        motion = Motion(
            root_positions=root[taken].astype(np.float32),
            local_rotations=local[taken].astype(np.float32),
            contacts=contacts[taken].astype(np.float32),
            skeleton=skeleton,
            actions=np.full(count, walk.part.action.keyframe, dtype=np.int32),
            phases=(Phase(PhaseKind.WALK, 0, count, self.generator.name),),
        )
        at = _nearest(way.places * scale, root[last, [0, 2]])
        return motion, way.places[at + 1 :] * scale


@dataclass(frozen=True)
class _Walk:
    """A walk as the procedural body did it."""

    home: Home
    part: Part
    upcoming: tuple[Part, ...]
    state: BodyState
    """Before it."""
    ruled: Motion
    after: BodyState
    """What that left."""

    @property
    def stride(self) -> Stride | None:
        """What the procedural body was in at the end; None where it stopped."""
        told = self.after.memory.get("stride")
        return Stride.from_lists(told) if told else None

    @property
    def way(self) -> Array:
        """Where its pelvis goes, without its sway, and on from there where it does not stop. (N, 2)."""
        places = _way_of(self.ruled)
        if self.stride is None:
            return places
        onward = Way.along(np.concatenate([places[-1:], self.stride.rest[1:]]), max(self.stride.speed, 0.1)).places
        return np.concatenate([places, onward[1:]])

    @property
    def goes_on(self) -> bool:
        """Whether the next part is walked to without a stop."""
        return self.stride is not None


def unlike_people(action: Action) -> str:
    """Why no plain walk serves an action; empty where one does."""
    style = walk_style(action.emotion, action.caption if action.skill is Skill.LOCO else "walk")
    usual = walk_style(action.emotion, "walk")
    odd = [name for name in vars(style) if name not in OWN and getattr(style, name) != getattr(usual, name)]
    odd += [name for name, most in FREE.items() if getattr(style, name) > max(most, getattr(usual, name))]
    odd += ["arms"] * (style.bearing.arms != usual.bearing.arms) + ["wobble"] * bool(usual.wobble)
    if style.speed > FASTEST:
        return "nobody runs in recorded walks"
    return f"no recorded walk is like {action.caption!r:.40} ({', '.join(odd)})" if odd else ""


def plain_stretch(motion: Motion, slowest: float) -> tuple[int, int] | None:
    """The longest stretch of a motion that is plain walking ahead, from frame to frame; None where it is short."""
    if len(motion) < SHORTEST:
        return None
    steps = np.gradient(_way_of(motion), axis=0) * FPS
    pace = np.linalg.norm(steps, axis=1)
    facing = _smooth(np.unwrap(yaw_of(motion.local_rotations[:, 0].astype(np.float64))))
    ahead = np.abs(rotations.wrap(np.arctan2(steps[:, 0], steps[:, 1]) - facing)) < AHEAD
    scale = motion.skeleton.scale
    walks = ahead & (pace > max(slowest * scale, STARTED * float(pace.max()))) & (pace < FASTEST * scale)
    yaw, gone = np.unwrap(np.arctan2(steps[:, 0], steps[:, 1])), np.cumsum(pace) / FPS
    reach = FPS // 3
    turned = np.abs(yaw[2 * reach :] - yaw[: -2 * reach]) / np.maximum(gone[2 * reach :] - gone[: -2 * reach], SLOWEST)
    walks &= np.pad(turned * scale, (reach, reach), mode="edge") < BEND
    walking = [phase for phase in motion.phases if phase.kind is PhaseKind.WALK]
    in_walk = np.zeros(len(motion), dtype=np.bool_)
    for phase in walking:
        in_walk[phase.start : phase.stop] = True
    edges = np.flatnonzero(np.diff(np.concatenate([[False], walks & in_walk, [False]]).astype(np.int8)))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return None
    start, stop = runs[int(np.argmax(runs[:, 1] - runs[:, 0]))].tolist()
    slower = np.flatnonzero(pace[start:stop] > STOPPING * float(pace.max()))
    stop = start + int(slower[-1]) + 1
    return (start, stop) if stop - start >= SHORTEST else None


def _astray(made: Motion, walk: _Walk) -> str:
    """How a made walk leaves its way; empty where it does not."""
    places = made.root_positions[:, [0, 2]].astype(np.float64)
    own = [phase for phase in made.phases if phase.backend not in ("", ProceduralBackend.name)]
    walked = np.concatenate([places[phase.start : phase.stop] for phase in own])
    off = np.sqrt(((walked[:, None] - walk.way[None]) ** 2).sum(axis=2)).min(axis=1)
    if off.max() > OFF:
        return f"was {100 * off.max():.0f} cm beside the way"
    if walk.goes_on and walk.part.goal is not None:
        past = float(np.linalg.norm(places - walk.part.goal, axis=1).min())
        if past > PASSES:
            return f"passed the place at {past:.2f} m"
    return ""


def _way_of(motion: Motion) -> Array:
    """Where a pelvis goes, without its sway. (T, 2)."""
    return _smooth(motion.root_positions[:, [0, 2]].astype(np.float64))


def _smooth(values: Array) -> Array:
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(values, SMOOTH, axis=0, mode="nearest"))


def _nearest(places: Array, place: Array) -> int:
    return int(np.argmin(np.sum((places - place) ** 2, axis=1)))


def _carried(made: Frames, action: Action, fixed: int) -> Frames:
    """Trunk and head bent as a mood bends them, besides what the generator does."""
    plain, moody = walk_style(action.emotion, "walk").bearing, Bearing()
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


def _steps_end(positions: Array, end: Array) -> int:
    """Of the frames (T, 22, 3) in which a heel comes down the one that is nearest to a place (2,)."""
    landing = strides_landing(positions)
    if not len(landing):
        return len(positions) - 1
    return int(landing[_nearest(positions[landing, 0][:, [0, 2]], end)])


def _in_stride(state: BodyState, walk: _Walk, beyond: Array) -> BodyState:
    """The state that lets the procedural body go on in the stride that the last frames are in."""
    skeleton, action, goal = walk.ruled.skeleton, walk.part.action, walk.part.goal
    style = walk_style(action.emotion, action.caption if action.skill is Skill.LOCO else "walk")
    rest = beyond if len(beyond) else np.array([goal])
    stride = stride_of(state.history, skeleton, style, rest)
    pose = pose_of(state.history, skeleton).to_lists()
    memory = {"pose": pose, "holds": [None, None], "tail": None, "stride": stride.to_lists(), BORROWED: True}
    return replace(state, backend=ProceduralBackend.name, memory=memory)


def _depth(motion: Motion, home: Home) -> float:
    """How deep a walking body is in furniture and walls at worst (metres)."""
    return float(penetration(Kinematics.of(motion), scene_of(home).obstacles, None).max())
