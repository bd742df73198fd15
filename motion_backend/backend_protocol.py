"""What the state machine asks of a backend, and what a backend leaves: parts, body states and the protocol itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.contact_goals import contact_goals
from motion_backend.motion import FPS, Action, Character, ContactGoal, Motion, Posture, Reaction
from motion_backend.rotations import Array
from motion_backend.skeleton import build_skeleton
from scene_graphs.affordances.affordances import Spot, spot_from_dict, spot_to_dict
from scene_graphs.home import Home
from scene_graphs.json_fields import Json

HISTORY: Final = 10
"""Frames a state remembers: a third of a second, more than the two frames at 10 a second that LINGO goes on from."""
_DIGITS: Final = 6
"""Decimals of what is remembered: a micrometre."""
Rows = tuple[tuple[float, ...], ...]


class PartKind(StrEnum):
    """What one backend is asked for at a time: the five policies of SIMS 3.4, turning and holding told apart."""

    WALK = "walk"
    TURN = "turn"
    """On the spot, where there is no way to go."""
    SIT = "sit"
    LIE = "lie"
    REACH = "reach"
    """The hand to its goal, what it does there, and back."""
    RISE = "rise"
    """From a seat, a bed or the floor to standing: GetUp of the paper."""
    HOLD = "hold"
    """Stay in the pose one has come to."""


class Unwanted(Exception):  # noqa: N818
    """Nobody wants the motion any more: raised by who is asked between two windows, and no fault of a backend."""


@dataclass(frozen=True)
class Part:
    """One element (k, h, g, z) of SIMS Eq. 6: a skill with its goals; caption and mood stand in the action.

    Goals come from the planning side, and what was done is judged by them; a backend never sets its own.
    """

    kind: PartKind
    action: Action
    goal: tuple[float, float] | None = None
    """Where the pelvis is to be on the floor, [x, z] (LINGO A.4's pelvis goal): walk, turn."""
    facing: float | None = None
    """The yaw to end with; None: any."""
    hold: float = 0.0
    """Seconds to stay: hold, and the hand of reach."""
    reaction: Reaction | None = None
    """What a hold is for: something happens, wherever the body is by then; None where it does what the action says."""

    @property
    def contacts(self) -> tuple[ContactGoal, ...]:
        """What is to be touched, sat or lain on (SIMS 3.3): none on the way there, nor in getting off."""
        if self.reaction is None and self.kind in (PartKind.SIT, PartKind.LIE, PartKind.REACH, PartKind.HOLD):
            return contact_goals(self.action)
        return ()


@dataclass(frozen=True)
class History:
    """The last frames of a body at 30 a second, oldest first: what any backend can go on from."""

    roots: Rows
    """(K, 3) pelvis in the world, metres."""
    rotations: Rows
    """(K, 22 · 4) local rotations, xyzw."""
    contacts: Rows
    """(K, 4) left ankle, left toe, right ankle, right toe."""

    @staticmethod
    def of(roots: Array, local: Array, contacts: Array) -> History:
        """From arrays (T, 3), (T, 22, 4) and (T, 4); the last `HISTORY` frames are kept."""
        return History(_rows(roots), _rows(local), _rows(contacts))

    def __len__(self) -> int:
        return len(self.roots)

    @property
    def root_positions(self) -> Array:
        """(K, 3) metres."""
        return np.array(self.roots)

    @property
    def local_rotations(self) -> Array:
        """(K, 22, 4) xyzw, of unit length."""
        return rotations.normalize(np.array(self.rotations).reshape(len(self), -1, 4))

    @property
    def root_velocity(self) -> Array:
        """Of the pelvis in the last frame, metres a second. (3,)."""
        roots = self.root_positions[-2:]
        return np.asarray((roots[-1] - roots[0]) * FPS)

    @property
    def angular_velocities(self) -> Array:
        """Of every joint against its parent in the last frame, rotation vectors in radians a second. (22, 3)."""
        turns = self.local_rotations[-2:]
        return rotations.quat_to_rotvec(rotations.compose(turns[-1], rotations.inverse(turns[0]))) * FPS

    def followed_by(self, motion: Motion) -> History:
        """The last frames once a motion has been played after these."""
        taken = slice(-HISTORY, None)
        later = _rows(motion.root_positions[taken]), _rows(motion.local_rotations[taken]), _rows(motion.contacts[taken])
        both = [(old + new)[taken] for old, new in zip((self.roots, self.rotations, self.contacts), later, strict=True)]
        return History(*both)


def _rows(array: NDArray[np.floating]) -> Rows:
    last = np.round(np.asarray(array, dtype=np.float64)[-HISTORY:], _DIGITS)
    return tuple(tuple(row.ravel().tolist()) for row in last)


@dataclass(frozen=True)
class BodyState:
    """All a backend needs to go on: JSON-able, so that a story can stop and resume between any two actions."""

    posture: Posture
    history: History
    rest: Spot | None = None
    """What it sits or lies on."""
    index: int = 0
    """Segments made so far; with the seed it fixes the next segment's randomness."""
    seed: int = 0
    height: float = 1.70
    backend: str = ""
    """Who left it; empty before the first segment. Only that one can read `memory`."""
    memory: dict[str, Any] = field(default_factory=dict)
    """The backend's own: lists and numbers only."""

    @staticmethod
    def standing(place: tuple[float, float], yaw: float, character: Character, seed: int) -> BodyState:
        """A body that stands at [x, z] in the skeleton's rest pose, its arms stretched out to the sides."""
        skeleton = build_skeleton(character.height)
        local = np.tile(rotations.IDENTITY, (1, len(skeleton.names), 1))
        local[:, 0] = rotations.yaw_to_quat(yaw)
        root = np.array([[place[0], skeleton.standing_height, place[1]]])
        return BodyState(Posture.STANDING, History.of(root, local, np.ones((1, 4))), seed=seed, height=character.height)

    @property
    def pelvis(self) -> tuple[float, float, float]:
        """Where the pelvis is in the world (metres)."""
        x, y, z = self.history.roots[-1]
        return x, y, z

    @property
    def yaw(self) -> float:
        """Where the pelvis faces."""
        ahead = rotations.rotate(self.history.local_rotations[-1, 0], np.array([0.0, 0.0, 1.0]))
        return float(np.arctan2(ahead[0], ahead[2]))

    def after(self, part: Part, motion: Motion, backend: str, memory: dict[str, Any] | None = None) -> BodyState:
        """The state that a part leaves once its motion was made; a part that is done ends in its kind's posture."""
        posture, rest = self.posture, self.rest
        if part.kind in POSTURE_AFTER and motion.completed and motion.completion >= 1:
            posture = POSTURE_AFTER[part.kind]
            rest = part.action.spot if posture is not Posture.STANDING else None
        history = self.history.followed_by(motion)
        return replace(
            self,
            posture=posture,
            history=history,
            rest=rest,
            index=self.index + 1,
            backend=backend,
            memory=memory or {},
        )

    def to_dict(self) -> Json:
        """Plain values, for JSON."""
        return asdict(self) | {"rest": spot_to_dict(self.rest)}

    @staticmethod
    def from_dict(row: Json) -> BodyState:
        """The inverse of `to_dict`, also after JSON."""
        history = History(**{name: tuple(map(tuple, rows)) for name, rows in row["history"].items()})
        own = {"posture": Posture(row["posture"]), "history": history, "rest": spot_from_dict(row["rest"])}
        return BodyState(**row | own)


POSTURE_AFTER: Final = {
    PartKind.WALK: Posture.STANDING,
    PartKind.TURN: Posture.STANDING,
    PartKind.SIT: Posture.SEATED,
    PartKind.LIE: Posture.LYING,
    PartKind.REACH: Posture.STANDING,
    PartKind.RISE: Posture.STANDING,
}
"""What a body rests in after each kind of part; holding changes nothing."""


@dataclass(frozen=True)
class Request:
    """What `advance` is asked: for batches."""

    home: Home
    part: Part
    upcoming: tuple[Part, ...]
    state: BodyState


class MotionBackend(Protocol):
    """What moves the body. One segment a part, each reproducible alone from the state it starts in.

    A backend may have three things more. `parts`, the kinds of parts it can do: others are done by the fallback.
    `advance_many(requests)`, for which one pass over many bodies is cheaper than one after the other. `between`, a
    function without arguments that others put there: what takes long calls it often, and it raises to cancel.
    """

    name: str

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """The body standing in the home, before its first action."""
        ...

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Go on with a part from a state, knowing what comes after it: all of it, or a window with its completion.

        No frames at all where nothing has to be done. `state.after` makes the state that is left.
        """
        ...
