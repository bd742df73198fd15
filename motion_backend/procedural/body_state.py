"""The body in the middle of one action: where it is, what it rests on, the frames it has made."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import Action, Part, Phase, Posture
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.skeleton import Skeleton
from scene_graphs.affordances.affordances import Spot
from scene_graphs.home import Home
from scene_graphs.navigation.path_planner import NoPath, Walkable

Point = tuple[float, float]


@dataclass(frozen=True)
class Scene:
    """A home with what is worked out about it once."""

    home: Home
    walkable: Walkable
    obstacles: Obstacles


@dataclass
class Body:
    """One action being made: frames so far, the last pose, and what it rests on."""

    scene: Scene
    skeleton: Skeleton
    rng: np.random.Generator
    pose: Pose
    posture: Posture
    rest: Spot | None
    frames: list[Pose]
    made: int = 0
    """How many frames that is."""
    way: float = 0.0
    """How far it set out to walk (metres)."""
    parts: list[tuple[Part, int]] = field(default_factory=list)
    """What it has been doing, and from which frame on."""
    otherwise: list[str] = field(default_factory=list)
    """What it does otherwise than the caption says, in words (`Note.words`)."""

    def enter(self, part: Part) -> None:
        """Frames added from now on are this part of the action."""
        if self.parts and self.parts[-1][1] == self.made:
            self.parts.pop()
        if not self.parts or self.parts[-1][0] is not part:
            self.parts.append((part, self.made))

    @property
    def phases(self) -> tuple[Phase, ...]:
        """The parts with their frames."""
        stops = [start for _, start in self.parts[1:]] + [self.made]
        return tuple(
            Phase(part, start, stop) for (part, start), stop in zip(self.parts, stops, strict=True) if stop > start
        )

    def note(self, *words: str) -> None:
        """Say what is done otherwise than the caption says, and why; each thing once."""
        self.otherwise.extend(said for said in dict.fromkeys(words) if said not in self.otherwise)

    def add(self, frames: Pose) -> None:
        """Append frames and take the last as the present pose."""
        self.frames.append(frames)
        self.made += len(frames)
        self.pose = frames.at(len(frames) - 1)

    @property
    def place(self) -> Point:
        """Pelvis on the floor plan."""
        return float(self.pose.pelvis[0]), float(self.pose.pelvis[2])

    @property
    def yaw(self) -> float:
        """Heading of the pelvis."""
        return float(yaw_of(self.pose.hips))


def spot_of(action: Action) -> Spot:
    """Where on the furniture an action is to be done."""
    if action.spot is None:
        raise NoPath(f"keyframe {action.keyframe}: {action.skill} has no place to go to")
    return action.spot


def spot_under(body: Body) -> Spot:
    """What a body that does not stand rests on."""
    if body.rest is None:
        raise ValueError(f"a body that is {body.posture} rests on something, and its state does not say on what")
    return body.rest
