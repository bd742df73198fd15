"""The body in the middle of one part: where it is, what it rests on, the frames it has made."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from motion_backend.backend_protocol import Part
from motion_backend.motion import Action, Phase, PhaseKind, Posture, moment
from motion_backend.procedural.balance_pass import NOTHING, Before
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.touch.hand_rests import Holds
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.procedural.walk.stride import Stride
from motion_backend.scene import Scene
from motion_backend.skeleton import Skeleton
from scene_graphs.affordances.affordances import Spot
from scene_graphs.navigation.path_planner import NoPath

Point = tuple[float, float]


@dataclass
class Body:
    """One part being made: frames so far, the last pose, what it rests on and what it will do next."""

    scene: Scene
    skeleton: Skeleton
    rng: np.random.Generator
    pose: Pose
    posture: Posture
    rest: Spot | None
    before: Before = NOTHING
    """Its last frames, as its balance goes on from them."""
    holds: Holds = (None, None)
    """What its hands lie on."""
    seed: int = 0
    """Of the story: what of a body lasts all through it is drawn from it."""
    tail: Pose | None = None
    """The frame shown last, and what is still to be done of the part before (tail.py)."""
    stride: Stride | None = None
    """What it is walking in, where the last walk did not stop."""
    beyond: Pose | None = None
    """How that was to go on."""
    upcoming: tuple[Part, ...] = ()
    """What it is to do next, for this action and the one after it."""
    frames: list[Pose] = field(default_factory=list)
    made: int = 0
    """How many frames that is."""
    begun: Pose = field(init=False)
    """The pose it set out from."""
    doing: list[tuple[PhaseKind, int]] = field(default_factory=list)
    """What it has been doing, and from which frame on."""
    otherwise: list[str] = field(default_factory=list)
    """What it does otherwise than the caption says, in words (`Note.words`)."""

    def __post_init__(self) -> None:
        self.begun = self.pose

    def enter(self, kind: PhaseKind) -> None:
        """Frames added from now on are this phase of the part."""
        if self.doing and self.doing[-1][1] == self.made:
            self.doing.pop()
        if not self.doing or self.doing[-1][0] is not kind:
            self.doing.append((kind, self.made))

    @property
    def phases(self) -> tuple[Phase, ...]:
        """What it did with its frames."""
        stops = [start for _, start in self.doing[1:]] + [self.made]
        return tuple(
            Phase(kind, start, stop) for (kind, start), stop in zip(self.doing, stops, strict=True) if stop > start
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
        raise NoPath(f"{moment(action.keyframe)}: there is no place to {action.skill.words}")
    return action.spot


def spot_under(body: Body) -> Spot:
    """What a body that does not stand rests on."""
    if body.rest is None:
        raise ValueError(f"a body that is {body.posture} rests on something, and its state does not say on what")
    return body.rest
