"""Sample motions that tests of how people move share, made once a run by the backend's own `advance`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from small_home import DIRECTOR, after, contact, rise, small_home, to

from motion_backend import rotations
from motion_backend.backend_protocol import BodyState
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, Emotion, Motion, PhaseKind, Skill
from motion_backend.skeleton import INDEX
from scene_graphs.affordances.affordances import floor_spot, spots
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Placed

SMALL = small_home()
HALL = home_from_layouts(
    [
        Layout(
            "hall", "living_room", ((0.0, 0.0), (0.0, 9.0), (7.0, 9.0), (7.0, 0.0)),
            objects=(
                Placed("chair", "dining_chair", (1.0, 0.0, 7.0), (0.45, 0.9, 0.5), np.pi / 2),
                Placed("sofa", "multi_seat_sofa", (5.9, 0.0, 1.6), (2.1, 0.8, 0.9), -np.pi / 2),
                Placed("bed", "single_bed", (1.3, 0.0, 1.3), (1.0, 0.5, 2.0), 0.0),
                Placed("shelf", "bookshelf", (6.7, 0.0, 6.5), (0.9, 1.9, 0.35), -np.pi / 2),
            ),
        )
    ],
    0,
)  # fmt: skip
"""Larger, and everything stands in it otherwise."""
HOMES = {"small": SMALL, "hall": HALL}
WAYS = {"small": ((3.0, 1.0), (3.2, 4.5)), "hall": ((3.0, 1.0), (3.6, 8.0))}
"""Where walks start and end."""


@dataclass(frozen=True)
class Body:
    """A motion, and where the joints of the body are in it."""

    motion: Motion
    action: Action

    @cached_property
    def kinematics(self) -> Kinematics:
        return Kinematics.of(self.motion)

    def at(self, joint: str) -> np.ndarray:
        """(T, 3) metres."""
        return self.kinematics.positions[:, INDEX[joint]]

    def axis(self, joint: str, axis: tuple[float, float, float]) -> np.ndarray:
        """Where one of a joint's own axes points: (0, 0, 1) is its front, (1, 0, 0) its left. (T, 3)."""
        return rotations.rotate(self.kinematics.world[:, INDEX[joint]], np.array(axis))

    @property
    def planted(self) -> np.ndarray:
        """Whether the left and the right foot stand. (T, 2)."""
        return self.motion.contacts[:, [0, 2]] > 0

    def phase(self, part: PhaseKind) -> slice:
        """The frames of one part."""
        found = next(phase for phase in self.motion.phases if phase.kind is part)
        return slice(found.start, found.stop)

    @property
    def facing(self) -> np.ndarray:
        """Unit vector that the action's place faces, on the floor. (3,)."""
        assert self.action.spot is not None
        return np.array([np.sin(self.action.spot.facing), 0.0, np.cos(self.action.spot.facing)])

    @cached_property
    def way(self) -> np.ndarray:
        """Unit vector of where the middle of a straight walk leads. (3,)."""
        ground = self.at("pelvis")[self.middle] * [1.0, 0.0, 1.0]
        return rotations.normalize(ground[-1] - ground[0])

    def before(self, one: str, other: str) -> np.ndarray:
        """How far a joint is ahead of another in the middle of a walk. (M,) metres."""
        return (self.at(one) - self.at(other))[self.middle] @ self.way

    @property
    def middle(self) -> slice:
        """Of a walk: the frames between start and stop."""
        return slice(int(0.3 * len(self.motion)), int(0.75 * len(self.motion)))

    def knee(self, side: str) -> np.ndarray:
        """Degrees that a knee is bent. (T,)."""
        thigh = rotations.normalize(self.at(f"{side}_knee") - self.at(f"{side}_hip"))
        shin = rotations.normalize(self.at(f"{side}_ankle") - self.at(f"{side}_knee"))
        return np.degrees(np.arccos(np.clip(np.sum(thigh * shin, axis=1), -1, 1)))

    def elbow(self, side: str) -> np.ndarray:
        """Degrees that an elbow is bent. (T,)."""
        upper = rotations.normalize(self.at(f"{side}_elbow") - self.at(f"{side}_shoulder"))
        lower = rotations.normalize(self.at(f"{side}_wrist") - self.at(f"{side}_elbow"))
        return np.degrees(np.arccos(np.clip(np.sum(upper * lower, axis=1), -1, 1)))

    def hip(self, side: str) -> np.ndarray:
        """Degrees between the thigh and the trunk carried on downwards: 0 standing upright. (T,)."""
        trunk = rotations.normalize(self.at("neck") - self.at("pelvis"))
        thigh = rotations.normalize(self.at(f"{side}_knee") - self.at(f"{side}_hip"))
        return 180 - np.degrees(np.arccos(np.clip(np.sum(trunk * thigh, axis=1), -1, 1)))

    def lean(self, front: np.ndarray) -> np.ndarray:
        """Degrees that the trunk leans to a side, a unit vector (3,). (T,)."""
        trunk = self.at("neck") - self.at("pelvis")
        return np.degrees(np.arctan2(trunk @ front, trunk[:, 1]))


def _stood(home: str, goal: tuple[float, float], facing: float, seed: int, height: float) -> BodyState:
    walk = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=goal, facing=facing)
    return after(HOMES[home], walk, seed=seed, height=height)


def _advanced(home: str, action: Action, state: BodyState) -> tuple[Motion, BodyState]:
    return DIRECTOR.act(HOMES[home], action, state)


@cache
def walked(caption: str, emotion: str = "neutral", home: str = "small", seed: int = 3, height: float = 1.70) -> Body:
    """From one end of a home to the other, begun facing the way."""
    start, goal = WAYS[home]
    state = _stood(home, start, float(np.arctan2(goal[0] - start[0], goal[1] - start[1])), seed, height)
    action = Action(Skill.LOCO, caption, Emotion(emotion), goal=goal)
    return Body(_advanced(home, action, state)[0], action)


@cache
def _rested(skill: Skill, name: str, caption: str, emotion: str, home: str, seed: int) -> tuple[Body, BodyState]:
    if name == "floor":
        need = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie"}[skill]
        action = Action(skill, caption, Emotion(emotion), "floor", "floor", floor_spot(need, (3.4, 3.2), 0.0))
    else:
        action = contact(HOMES[home], skill, name, caption, Emotion(emotion))
    arrived = after(HOMES[home], to(action), seed=seed)
    action = replace(action, keyframe=1)
    motion, state = _advanced(home, action, arrived)
    return Body(motion, action), state


def sat(name: str, caption: str, emotion: str = "neutral", home: str = "small", seed: int = 3) -> Body:
    """Sitting down on a thing, walked to before; "floor" too."""
    return _rested(Skill.SITDOWN, name, caption, emotion, home, seed)[0]


def lain(name: str, caption: str, emotion: str = "neutral", home: str = "small", seed: int = 3) -> Body:
    """Lying down on a thing, walked to before; "floor" too."""
    return _rested(Skill.LIEDOWN, name, caption, emotion, home, seed)[0]


@cache
def risen_from(name: str, caption: str, emotion: str = "neutral", home: str = "small", seed: int = 3) -> Body:
    """Standing up from a thing that was sat on."""
    body, state = _rested(Skill.SITDOWN, name, "sitting still", emotion, home, seed)
    action = replace(rise(body.action), caption=caption, emotion=Emotion(emotion), keyframe=2)
    return Body(_advanced(home, action, state)[0], action)


@cache
def got_up(name: str, caption: str, emotion: str = "neutral", home: str = "small", seed: int = 3) -> Body:
    """Getting up from a thing, or the floor, that was lain on."""
    body, state = _rested(Skill.LIEDOWN, name, caption, emotion, home, seed)
    action = replace(rise(body.action, Skill.GETUP), caption="get up", emotion=Emotion(emotion), keyframe=2)
    return Body(_advanced(home, action, state)[0], action)


@cache
def touched(name: str, height: str, caption: str, hand: str = "right", home: str = "small", seed: int = 3) -> Body:
    """Touching a thing at a height ("low", "medium", "high"), walked to before."""
    where = HOMES[home]
    spot = next(one for one in spots(where.object(f"0/{name}"), "touch") if one.height == height)
    state = _stood(home, spot.standing, spot.facing, seed, 1.70)
    action = Action(Skill.TOUCH, caption, Emotion.NEUTRAL, name, f"0/{name}", spot, hand=hand)
    return Body(_advanced(home, action, state)[0], action)
