"""The words of the body: skills, actions, and motion.

Arrays are float32, Y up, metres, seconds, quaternions xyzw; T frames at `fps`; 22 joints in SMPL's order (skeleton.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from motion_backend.skeleton import Skeleton
from scene_graphs.affordances.affordances import Spot

Floats = NDArray[np.float32]
FPS = 30


Does = Literal["open", "close", "into", "on", "off"]
"""What is done to a piece: opened, shut, opened for as long as a hand is at it, switched on or off."""


Reacts = Literal["start", "notice", "search"]
"""How a body takes what happens: it starts and looks there, only looks there, or looks about and finds nobody."""


@dataclass(frozen=True)
class Reaction:
    """What a body does at something that happens, in whatever posture it is, before or after what it does itself."""

    how: Reacts
    at: str = ""
    """Where that is: "door", "window" or a piece of furniture; empty: whatever door is nearest."""
    after: bool = False
    """Whether it happens once the action is done; otherwise before it begins."""


class Skill(StrEnum):
    """The keyframe skills of SIMS 3.4, with standing up from a seat told apart as in its tables."""

    LOCO = "loco"
    SITDOWN = "sitdown"
    STANDUP = "standup"
    GETUP = "getup"
    LIEDOWN = "liedown"
    TOUCH = "touch"

    @property
    def words(self) -> str:
        """What people call it: "sit down"."""
        return SKILL_WORDS[self][0]

    @classmethod
    def _missing_(cls, value: object) -> Skill | None:
        """The skill that people call so."""
        said = " ".join(value.lower().replace("_", " ").split()) if isinstance(value, str) else ""
        return next((skill for skill, words in SKILL_WORDS.items() if said in (skill.value, *words)), None)


SKILL_WORDS: Final = {
    Skill.LOCO: ("walk",),
    Skill.SITDOWN: ("sit down", "sit"),
    Skill.STANDUP: ("stand up",),
    Skill.GETUP: ("get up",),
    Skill.LIEDOWN: ("lie down", "lie"),
    Skill.TOUCH: ("touch",),
}
"""What people call each, the first as it is printed; a script may say any of them."""


def skills_named() -> str:
    """Every skill with its other words: "loco (or walk), sitdown (or sit down, sit)"."""
    others = ((skill, [word for word in words if word != skill]) for skill, words in SKILL_WORDS.items())
    return ", ".join(f"{skill} (or {', '.join(words)})" if words else skill for skill, words in others)


def moment(keyframe: int) -> str:
    """What people are told a keyframe is; they count from 1, indices from 0."""
    return f"moment {keyframe + 1}"


class Emotion(StrEnum):
    """Neutral and the eight emotions or styles of SIMS 4.1; free words become one in emotion_words.py."""

    NEUTRAL = "neutral"
    HAPPY = "happy"
    ANGRY = "angry"
    HURRIED = "hurried"
    TIRED = "tired"
    SAD = "sad"
    STRESSED = "stressed"
    DRUNK = "drunk"
    RELAXED = "relaxed"


class Posture(StrEnum):
    """What the body rests in between two actions."""

    STANDING = "standing"
    SEATED = "seated"
    LYING = "lying"


class PhaseKind(StrEnum):
    """What a body does for a while: the phases that a part (state_machine.py) is made of."""

    STAND = "stand"
    GETUP = "getup"
    """From lying to the edge of the bed, or from the floor to the knees."""
    STANDUP = "standup"
    WALK = "walk"
    EDGE = "edge"
    """Onto the edge of a bed, or onto the knees to lie on the floor."""
    SITDOWN = "sitdown"
    LIEDOWN = "liedown"
    TOUCH = "touch"


@dataclass(frozen=True)
class Phase:
    """One phase of a segment and its frames, `start` to `stop` (exclusive)."""

    kind: PhaseKind
    start: int
    stop: int
    backend: str = ""
    """Who made it; empty where nobody knows."""
    fallback: str = ""
    """Why another backend than the one asked for made it; empty where it was that one."""
    reacts: Reacts | Literal[""] = ""
    """How something that happens is taken in it; empty where nothing is."""


@dataclass(frozen=True)
class Note:
    """Something that a keyframe's caption asks for and the body did otherwise, since the place does not allow it."""

    keyframe: int
    words: str
    """What is lacking and what was done instead: "no table before the seat: hands in the lap"."""


@dataclass(frozen=True)
class Force:
    """How strongly something pressed on a part of a simulated body."""

    body: str
    """One of the 15 contact bodies (body/capsules.py)."""
    on: str
    """What it pressed on: "floor", or "things", furniture and walls."""
    newtons: float
    """Its median while it pressed."""
    most: float
    """Its largest mean over a frame, newtons."""
    seconds: float
    """How long it pressed."""


@dataclass(frozen=True)
class Simulated:
    """What a physics engine made of a part of a keyframe."""

    keyframe: int
    mode: str
    """What moved the joints: "mpc", model-predictive control, or "policy", a network."""
    seconds: float
    root_force_newtons: float = 0.0
    """What pushed the pelvis besides its joints and what it touched."""
    resets: int = 0
    """How often the body was set onto its plan."""
    rewinds: int = 0
    """How often it fell, and was gone back from."""
    rewound_seconds: float = 0.0
    """What was thrown away in that."""
    forces: tuple[Force, ...] = ()
    why: str = ""
    """Why no policy moved them, where one was asked for."""
    weight_error: float | None = None
    """How far what carried it at rest was from its weight, as a share of that; None where it never rested."""


@dataclass(frozen=True)
class Character:
    """Who acts: the name and pronouns the story uses, the height the body has (metres), and words for how it looks.

    The words are those of data/cast.toml; an empty one is chosen or read where the story is (body/cast.py).
    """

    name: str = "Sam"
    pronouns: str = "they"
    """he, she or they."""
    height: float = 1.70
    member: str = ""
    """Of the cast: who plays; the other words say what differs from them."""
    age: str = ""
    build: str = ""
    skin: str = ""
    hair: str = ""
    hair_color: str = ""
    outfit: str = ""


RISINGS: Final = (Skill.STANDUP, Skill.GETUP)
"""Skills of which nothing is left to do once the body stands."""


@dataclass(frozen=True)
class Handle:
    """What a hand takes along that opens or shuts a door or a drawer: about an upright hinge, or straight out."""

    does: Does
    shut: tuple[float, float, float]
    """Where it is while that is shut, in the world."""
    hinge: tuple[float, float]
    """[x, z]."""
    turn: float = 0.0
    """About +Y, from there to as far as it is opened (radians)."""
    way: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """The same of a drawer (metres)."""
    front: int = 0
    """Which of the piece's fronts that is."""
    share: float = 1.0
    """How far open that is, of as far as it goes."""

    @staticmethod
    def from_dict(row: Mapping[str, Any] | None) -> Handle | None:
        """The inverse of `asdict`, also once lists have come back for tuples."""
        plain: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value for name, value in (row or {}).items()
        }
        return Handle(**plain) if plain else None

    def at(self, shares: NDArray[np.floating] | float) -> NDArray[np.float64]:
        """Where it is at shares (...) of its way, 0 shut and 1 opened. (..., 3)."""
        shares = np.asarray(shares, dtype=np.float64)
        x, y, z = self.shut
        aside, ahead = x - self.hinge[0], z - self.hinge[1]
        cos, sin = np.cos(self.turn * shares), np.sin(self.turn * shares)
        places = [self.hinge[0] + cos * aside + sin * ahead, 0 * shares + y, self.hinge[1] + cos * ahead - sin * aside]
        return np.asarray(np.stack(places, axis=-1) + shares[..., None] * np.array(self.way))


@dataclass(frozen=True)
class Action:
    """One thing to do, grounded in the home: what a backend gets for one keyframe (SIMS 3.4, Eq. 6)."""

    skill: Skill
    caption: str
    emotion: Emotion
    """What the keyframe's words ("tired, sad") mean: the planner tells it and the body acts it."""
    furniture: str = "floor"
    object_id: str | None = None
    spot: Spot | None = None
    """Where on the object: surface point, normal, facing and standing point. None for walking."""
    goal: tuple[float, float] | None = None
    """Pelvis goal on the floor, [x, z], for loco."""
    facing: float | None = None
    """Yaw to end with, for loco."""
    by: tuple[float, float] | None = None
    """Where its way first leads, [x, z]: round to where there is room to run. None for the shortest way."""
    hand: str = "right"
    """The hand that touches: left or right."""
    hold: float = 1.5
    """Seconds to stay in the reached pose."""
    stands: float = 0.0
    """Seconds to stand about afterwards, on the feet one has come to: at the end of a story."""
    keyframe: int = 0
    """Index of the keyframe it serves."""
    holds: str | None = None
    """What is in the hands during it, or is reached for, in words ("cup, book"); only seen, no backend knows it."""
    interaction: str | None = None
    """What is done in the pose, in words ("watch TV"): LINGO's interaction steps."""
    already: bool = False
    """Whether the body sits or lies there before the first frame; so only of the first action."""
    begins: tuple[float, float, float] | None = None
    """Where the body stands and looks, [x, z, yaw], before the first frame, if the words say: at the door that it has
    come in by. So only of the first action."""
    reacts: tuple[Reaction, ...] = ()
    """What happens besides, and is reacted to before it or after it."""
    handle: Handle | None = None
    """What the hand takes along; of who leaves the home, that of the door which is opened on the way."""
    lacks: str = ""
    """What the home lacks for it, and what is done instead (`Note.words`); empty where it lacks nothing."""


@dataclass(frozen=True)
class ContactGoal:
    """One contact to reach: a joint and where it should be (surface point + normal × rest offset)."""

    joint: str
    position: tuple[float, float, float]


@dataclass(frozen=True)
class Motion:
    """What the body did over T frames; world joint positions follow by `skeleton.forward_kinematics`."""

    root_positions: Floats
    """(T, 3) pelvis in the world."""
    local_rotations: Floats
    """(T, 22, 4) xyzw, each joint in its parent's frame, the pelvis in the world's."""
    contacts: Floats
    """(T, 4) 1 where planted: left ankle, left toe, right ankle, right toe."""
    skeleton: Skeleton
    actions: NDArray[np.int32]
    """(T,) index of the keyframe each frame serves."""
    fps: int = FPS
    goals: tuple[ContactGoal, ...] = ()
    """What this segment set out to touch, sit on or reach."""
    completed: bool = True
    reason: str = ""
    """Why not, when it was not completed."""
    completion: float = 1.0
    """How much of the part it was made for is done, 0 to 1: below 1 the next window goes on with it (LINGO A.5)."""
    phases: tuple[Phase, ...] = ()
    """What it is made of, in order; empty where nobody knows."""
    notes: tuple[Note, ...] = ()
    """What was done otherwise than captions say."""
    simulated: tuple[Simulated, ...] = ()
    """What a physics engine had a part in; empty for a kinematic body."""

    @staticmethod
    def empty(skeleton: Skeleton) -> Motion:
        """No frames."""
        return Motion(
            root_positions=np.zeros((0, 3), np.float32),
            local_rotations=np.zeros((0, len(skeleton.names), 4), np.float32),
            contacts=np.zeros((0, 4), np.float32),
            skeleton=skeleton,
            actions=np.zeros(0, np.int32),
        )

    def __len__(self) -> int:
        return int(self.root_positions.shape[0])

    @property
    def duration(self) -> float:
        """Seconds."""
        return len(self) / self.fps

    def joint_positions(self) -> Floats:
        """World positions of all joints. (T, 22, 3) float32."""
        return self.skeleton.forward_kinematics(self.root_positions, self.local_rotations)[0]

    def part(self, start: int, stop: int) -> Motion:
        """Frames start to stop (exclusive)."""
        window = slice(start, stop)
        cut = [
            replace(phase, start=max(phase.start, start) - start, stop=min(phase.stop, stop) - start)
            for phase in self.phases
            if phase.start < stop and phase.stop > start
        ]
        served = set(self.actions[window].tolist())
        return replace(
            self,
            root_positions=self.root_positions[window],
            local_rotations=self.local_rotations[window],
            contacts=self.contacts[window],
            actions=self.actions[window],
            phases=tuple(cut),
            notes=tuple(note for note in self.notes if note.keyframe in served),
            simulated=tuple(one for one in self.simulated if one.keyframe in served),
        )


def join(motions: list[Motion]) -> Motion:
    """One motion after the other; they must share skeleton and fps."""
    first = motions[0]
    starts = np.cumsum([0, *(len(motion) for motion in motions)]).tolist()
    return replace(
        first,
        root_positions=np.concatenate([m.root_positions for m in motions]),
        local_rotations=np.concatenate([m.local_rotations for m in motions]),
        contacts=np.concatenate([m.contacts for m in motions]),
        actions=np.concatenate([m.actions for m in motions]),
        goals=(),
        completed=all(m.completed for m in motions),
        reason="; ".join(m.reason for m in motions if m.reason),
        phases=tuple(
            replace(phase, start=start + phase.start, stop=start + phase.stop)
            for start, motion in zip(starts, motions, strict=False)
            for phase in motion.phases
        ),
        notes=tuple(note for motion in motions for note in motion.notes),
        simulated=tuple(one for motion in motions for one in motion.simulated),
    )
