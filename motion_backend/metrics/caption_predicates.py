"""Whether a body does what the words of its caption say: data/caption_predicates.toml, judged over the frames it shows.

A row of the table has words and what joints must measure where a caption has them; all rows whose words a caption has
count. A body that cannot do it where it is must say so in a note of its keyframe: obeyed, or noted.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache
from typing import Final, Literal

import numpy as np

from motion_backend import rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, Motion, PhaseKind, Skill
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from scene_graphs.data_tables import read_table, require_known, table

SIDES: Final = ("left", "right")
PALM: Final = 0.075
"""Wrist to the middle of the palm (metres at 1.70 m)."""
SKULL, MOUTH = np.array([0.0, 0.065, 0.0]), np.array([0.0, 0.01, 0.10])
"""The middle of the head, and the mouth, in the head joint's frame (metres at 1.70 m)."""
EASES: Final = 0.3
"""Seconds at both ends of a hold in which the body still comes to it, or leaves it."""
STARTS: Final = 0.6
"""Seconds at both ends of a walk that belong to starting and stopping."""
AFTERWARDS, BEFOREHAND = r"\bpick|\bturn on", r"\bput|\bslam"
"""Words of touches that show after the hand was there, and before."""
ARRIVES: Final = 3
"""Frames in which a hand gets to a thing."""
FROM_CHAIR: Final = 0.36
"""How far a pelvis rises from a chair (metres at 1.70 m)."""
NEAREST: Final = 0.03
"""A hand that touches is so near to where it comes nearest to its goal (metres)."""


@table
class Check:
    """One measure that must lie in a range for a share of the frames."""

    measure: str
    """A name in `MEASURES`."""
    least: float = -np.inf
    most: float = np.inf
    side: Literal["both", "either", "left", "right"] = "both"
    share: float = 0.5
    """Of the frames: 0.5 is the median, less is now and then, more is nearly all the time."""

    def __post_init__(self) -> None:
        require_known("measure", [self.measure], MEASURES)

    def __str__(self) -> str:
        side = "" if self.side == "both" else f"{self.side} "
        return f"{side}{self.measure} not {self.least:g} to {self.most:g} in {self.share:.0%} of frames"

    def holds(self, body: Kinematics) -> bool:
        """Whether it is so in the frames of a body."""
        values = MEASURES[self.measure](body)
        shares = np.atleast_1d(((values >= self.least) & (values <= self.most)).mean(axis=0))
        kept = shares >= self.share
        if self.side in SIDES and len(kept) == len(SIDES):
            return bool(kept[SIDES.index(self.side)])
        return bool(kept.any() if self.side == "either" else kept.all())


@table
class Predicate:
    """What captions with these words must look like."""

    skill: Skill
    words: str
    """The pattern that a caption fits, in lower case."""
    checks: tuple[Check, ...]
    unless: str = ""
    """A caption that fits this too is left to other rows."""
    noted: str = ""
    """The words of a note that says it is not possible here; nothing excuses where this is empty."""
    neutral: bool = False
    """Whether the skill looks like this whatever the caption is."""

    def is_of(self, skill: Skill, caption: str) -> bool:
        """Whether the row judges a caption."""
        text = caption.lower()
        left = bool(self.unless and re.search(self.unless, text))
        return skill == self.skill and not left and re.search(self.words, text) is not None


@table
class CaptionPredicates:
    """data/caption_predicates.toml."""

    captions: tuple[Predicate, ...]


@dataclass(frozen=True)
class Verdict:
    """What became of a caption's words."""

    caption: str
    missed: tuple[str, ...]
    """What is not so, in words; empty where all words are obeyed."""
    noted: bool
    """Whether notes say so of all that is missed."""

    @property
    def kept(self) -> bool:
        """Obeyed, or noted."""
        return not self.missed or self.noted


@cache
def predicates() -> tuple[Predicate, ...]:
    """All rows. TableError."""
    read: CaptionPredicates = read_table("motion_backend", "caption_predicates.toml", CaptionPredicates)
    return read.captions


def predicates_of(skill: Skill, caption: str) -> tuple[Predicate, ...]:
    """The rows that judge a caption; none where it says nothing that the table knows."""
    return tuple(row for row in predicates() if row.is_of(skill, caption))


def judge_caption(motion: Motion, action: Action, caption: str = "") -> Verdict | None:
    """Whether a segment shows its caption, or what another one says; None where no row judges that."""
    caption = caption or action.caption
    rows = predicates_of(action.skill, caption)
    if not rows:
        return None
    body = Kinematics.of(shown(motion, replace(action, caption=caption)))
    missed = [(row, check) for row in rows for check in row.checks if not check.holds(body)]
    said = [note.words for note in motion.notes if note.keyframe == action.keyframe]
    noted = all(row.noted and any(re.search(row.noted, words) for words in said) for row, _ in missed)
    return Verdict(caption, tuple(str(check) for _, check in missed), bool(missed) and noted)


def kept_share(verdicts: Iterable[Verdict | None]) -> float | None:
    """The share of captions obeyed or noted, of those that are judged; None where none is."""
    judged = [verdict.kept for verdict in verdicts if verdict is not None]
    return float(np.mean(judged)) if judged else None


def shown(motion: Motion, action: Action) -> Motion:
    """The frames that show a caption: the hold of a pose, the hand at its goal, the way of a walk, all of a rise; of who
    turns before doing something on the spot, that.

    What is picked up or turned on shows once the hand has left, what is put down or slammed before it is there.
    """
    frames, fps = len(motion), motion.fps
    match action.skill:
        case Skill.SITDOWN | Skill.LIEDOWN:
            ease, hold = round(EASES * fps), round(action.hold * fps)
            start, stop = frames - hold + ease, frames - ease
        case Skill.TOUCH:
            start, stop = _at_the_goal(motion)
            if re.search(AFTERWARDS, action.caption.lower()):
                start, stop = stop, frames
            elif re.search(BEFOREHAND, action.caption.lower()):
                start, stop = 0, start + 1
        case Skill.LOCO:
            walks = [phase for phase in motion.phases if phase.kind is PhaseKind.WALK]
            ends = round(STARTS * fps)
            start, stop = (walks[0].start + ends, walks[-1].stop - ends) if walks else (0, frames)
            if walks and action.goal is None and walks[-1].stop < frames:
                start, stop = walks[-1].stop, frames
        case _:
            start, stop = 0, frames
    start = max(start, 0)
    return motion.part(start, stop) if stop > start else motion


def _at_the_goal(motion: Motion) -> tuple[int, int]:
    """From the first to behind the last frame in which the hand is as near to its goal as it comes."""
    if not motion.goals:
        return 0, len(motion)
    goal = motion.goals[0]
    wrist = motion.joint_positions()[:, INDEX[goal.joint]].astype(np.float64)
    away = np.linalg.norm(wrist - np.asarray(goal.position), axis=1)
    near = np.flatnonzero(away < away.min() + NEAREST)
    return int(near[0]), int(near[-1]) + 1


def _both(body: Kinematics, joint: str) -> Array:
    """Positions of the left and the right joint of that name. (T, 2, 3)."""
    return body.positions[:, [INDEX[f"{side}_{joint}"] for side in SIDES]]


def _angle(one: Array, other: Array) -> Array:
    """Degrees between vectors (..., 3)."""
    cosine = np.sum(rotations.normalize(one) * rotations.normalize(other), axis=-1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def _at_joint(body: Kinematics, above: str, joint: str, below: str) -> Array:
    """Degrees at a joint between the bones to its neighbours: 180 is straight. (T, 2)."""
    middle = _both(body, joint)
    return _angle(_both(body, above) - middle, _both(body, below) - middle)


def _trunk(body: Kinematics) -> Array:
    """From the pelvis to the neck. (T, 3)."""
    return body.positions[:, INDEX["neck"]] - body.positions[:, INDEX["pelvis"]]


def _heading(body: Kinematics) -> Array:
    """Unit vector on the floor that the hips look to, whatever way the pelvis is pitched. (T, 3)."""
    hips = _both(body, "hip")
    left = rotations.normalize((hips[:, 0] - hips[:, 1]) * [1.0, 0.0, 1.0])
    return np.stack([-left[:, 2], np.zeros(len(left)), left[:, 0]], axis=-1)


def _ahead(body: Kinematics, points: Array) -> Array:
    """How far points (T, 2, 3) are ahead of the pelvis (metres). (T, 2)."""
    away = points - body.positions[:, None, INDEX["pelvis"]]
    return np.asarray(np.sum(away * _heading(body)[:, None], axis=-1))


def _left_over_right(body: Kinematics, joint: str) -> Array:
    """How far the left joint is to the left of the right one: below 0 they are crossed (metres). (T,)."""
    pair, ahead = _both(body, joint), _heading(body)
    to_the_left = np.stack([ahead[:, 2], np.zeros(len(ahead)), -ahead[:, 0]], axis=-1)
    return np.asarray(np.sum((pair[:, 0] - pair[:, 1]) * to_the_left, axis=-1))


def _palms(body: Kinematics) -> Array:
    """Middles of both palms. (T, 2, 3)."""
    joints = [INDEX[f"{side}_wrist"] for side in SIDES]
    way = np.array([[PALM, 0.0, 0.0], [-PALM, 0.0, 0.0]]) * body.motion.skeleton.scale
    return np.asarray(body.positions[:, joints] + rotations.rotate(body.world[:, joints], way))


def _palms_to(body: Kinematics, joint: str, place: Array) -> Array:
    """From both palms to a place in the frame of a joint (metres). (T, 2)."""
    turned = rotations.rotate(body.world[:, INDEX[joint]], place * body.motion.skeleton.scale)
    point = body.positions[:, INDEX[joint]] + turned
    return np.asarray(np.linalg.norm(_palms(body) - point[:, None], axis=-1))


def _palms_to_bones(body: Kinematics, above: str, below: str) -> Array:
    """From both palms to the nearer of the two bones between such joints (metres). (T, 2)."""
    starts, ends, palms = _both(body, above)[:, None], _both(body, below)[:, None], _palms(body)[:, :, None]
    bones = ends - starts
    share = np.clip(np.sum((palms - starts) * bones, axis=-1) / np.sum(bones**2, axis=-1), 0.0, 1.0)
    away = np.linalg.norm(palms - starts - share[..., None] * bones, axis=-1)
    return np.asarray(away.min(axis=-1))


def _pitch(vectors: Array) -> Array:
    """Degrees that vectors (T, 3) point below the horizontal. (T,)."""
    level = np.hypot(vectors[:, 0], vectors[:, 2])
    return np.asarray(np.degrees(np.arctan2(-vectors[:, 1], level)))


def _front(body: Kinematics, joint: str) -> Array:
    """Where a joint's own front points. (T, 3)."""
    return rotations.rotate(body.world[:, INDEX[joint]], np.array([0.0, 0.0, 1.0]))


def _speeds(body: Kinematics, points: Array) -> Array:
    """Metres a second of points (T, ..., 3). (T, ...)."""
    if len(points) < 2:
        return np.zeros(points.shape[:-1])
    return np.asarray(np.linalg.norm(np.gradient(points, axis=0), axis=-1) * body.motion.fps)


def _slope(values: Array, fps: int) -> Array:
    """Change a second of values (T,). (T,)."""
    return np.asarray(np.gradient(values) * fps) if len(values) > 1 else np.zeros(len(values))


def _as_from_chair(body: Kinematics) -> float:
    """How many times farther a body would rise from a chair than it does, 1 where it rises from lower."""
    rise, chair = float(np.ptp(body.positions[:, INDEX["pelvis"], 1])), FROM_CHAIR * body.motion.skeleton.scale
    return chair / min(max(rise, NEAREST), chair)


def _trunk_aside(body: Kinematics) -> Array:
    """Degrees that the trunk leans to the left. (T,)."""
    ahead, trunk = _heading(body), _trunk(body)
    left = np.stack([ahead[:, 2], np.zeros(len(ahead)), -ahead[:, 0]], axis=-1)
    return np.asarray(np.degrees(np.arctan2(np.sum(trunk * left, axis=-1), trunk[:, 1])))


def _yaw(vectors: Array) -> Array:
    """Where vectors (T, 3) point on the floor, continuous (degrees). (T,)."""
    return np.asarray(np.degrees(np.unwrap(np.arctan2(vectors[:, 0], vectors[:, 2]))))


def _off_the_way(body: Kinematics) -> Array:
    """Degrees between where the hips look and where the pelvis goes. (T,)."""
    pelvis = body.positions[:, INDEX["pelvis"]] * [1.0, 0.0, 1.0]
    return _angle(np.gradient(pelvis, axis=0), _heading(body)) if len(pelvis) > 1 else np.zeros(len(pelvis))


def _in_all(values: Array) -> Array:
    """The range of values (T,), the same in every frame. (T,)."""
    return np.broadcast_to(np.ptp(values), values.shape)


def _in_every(body: Kinematics, values: Array) -> Array:
    """Values (2,) of both sides, the same in every frame. (T, 2)."""
    return np.broadcast_to(values, (len(body.motion), 2))


def _arriving(speeds: Array) -> Array:
    """The largest of speeds (T, 2) in the last frames. (2,)."""
    return np.asarray(speeds[-ARRIVES:].max(axis=0))


def _drawn_back(points: Array, fps: int) -> Array:
    """How far points (T, 2, 3) have been from the last one in the last second. (2,)."""
    return np.asarray(np.linalg.norm(points[-fps:] - points[-1], axis=-1).max(axis=0))


def _travel(points: Array) -> Array:
    """The largest extent along an axis of where points (T, 2, 3) go, the same in every frame (metres). (T, 2)."""
    return np.broadcast_to(np.ptp(points, axis=0).max(axis=-1), points.shape[:2])


def _turning(body: Kinematics, joints: tuple[str, str]) -> Array:
    """The farthest that joints are turned from where they are first, the same in every frame (degrees). (T, 2)."""
    world = body.world[:, [INDEX[joint] for joint in joints]]
    turned = rotations.quat_to_rotvec(rotations.compose(world, rotations.inverse(world[:1])))
    return np.broadcast_to(np.degrees(np.linalg.norm(turned, axis=-1).max(axis=0)), world.shape[:2])


def _from_pelvis(body: Kinematics, points: Array) -> Array:
    """Points (T, 2, 3) as the pelvis carries them along and round. (T, 2, 3)."""
    away, ahead = points - body.positions[:, None, INDEX["pelvis"]], _heading(body)
    turned = rotations.yaw_to_quat(-np.arctan2(ahead[:, 0], ahead[:, 2]))
    return np.asarray(rotations.rotate(turned[:, None], away))


def _in_pelvis(body: Kinematics, joint: str) -> Array:
    """Where the left joint is against the right one, in the pelvis' own frame (metres). (T, 3)."""
    pair = _both(body, joint)
    return rotations.rotate(rotations.inverse(body.world[:, INDEX["pelvis"]]), pair[:, 0] - pair[:, 1])


def _high(points: Array) -> Array:
    return np.asarray(points[..., 1])


MEASURES: Final[dict[str, Callable[[Kinematics], Array]]] = {
    # Degrees, of the left and the right limb.
    "knee": lambda body: _at_joint(body, "hip", "knee", "ankle"),
    "elbow": lambda body: _at_joint(body, "shoulder", "elbow", "wrist"),
    "hip": lambda body: _angle(_both(body, "knee") - _both(body, "hip"), _trunk(body)[:, None]),
    "arm_from_trunk": lambda body: _angle(_both(body, "elbow") - _both(body, "shoulder"), -_trunk(body)[:, None]),
    # Degrees: of the trunk forwards against upright (below 0 back) and from upright whichever way; of the face below
    # the horizontal, and turned to the left against the hips.
    "trunk_pitch": lambda body: np.degrees(np.arctan2(np.sum(_trunk(body) * _heading(body), -1), _trunk(body)[:, 1])),
    "trunk_tilt": lambda body: _angle(_trunk(body), np.array([0.0, 1.0, 0.0])),
    "face_down": lambda body: _pitch(_front(body, "head")),
    "face_left": lambda body: (_yaw(_front(body, "head")) - _yaw(_heading(body)) + 180) % 360 - 180,
    # Degrees a second: how fast the trunk bends, and the face nods and turns, whichever way.
    "trunk_pace": lambda body: np.abs(_slope(MEASURES["trunk_pitch"](body), body.motion.fps)),
    "nod_pace": lambda body: np.abs(_slope(MEASURES["face_down"](body), body.motion.fps)),
    "turn_pace": lambda body: np.abs(_slope(np.unwrap(MEASURES["face_left"](body), period=360), body.motion.fps)),
    # Degrees: how far the face nods, the trunk sways from side to side and the hips turn in all; off the way that is
    # gone.
    "face_nods": lambda body: _in_all(MEASURES["face_down"](body)),
    "trunk_sway": lambda body: _in_all(_trunk_aside(body)),
    "turned": lambda body: _in_all(_yaw(_heading(body))),
    "off_the_way": _off_the_way,
    # Degrees that the left of the pelvis points below the horizontal: on the left side above 0, on the right below.
    "left_down": lambda body: _pitch(rotations.rotate(body.world[:, INDEX["pelvis"]], np.array([1.0, 0.0, 0.0]))),
    "pelvis_pitch": lambda body: _pitch(_front(body, "pelvis")),
    # Metres, of the left and the right hand: the middle of its palm.
    "hand_to_head": lambda body: _palms_to(body, "head", SKULL),
    "hand_to_mouth": lambda body: _palms_to(body, "head", MOUTH),
    "hand_to_belly": lambda body: _palms_to(body, "spine1", np.array([0.0, 0.0, 0.1])),
    "hand_to_chest": lambda body: _palms_to(body, "spine3", np.array([0.0, 0.0, 0.1])),
    "hand_to_thigh": lambda body: _palms_to_bones(body, "hip", "knee"),
    "hand_to_shin": lambda body: _palms_to_bones(body, "knee", "ankle"),
    "hand_ahead": lambda body: _ahead(body, _palms(body)),
    "hand_height": lambda body: _high(_palms(body)),
    "hand_over_pelvis": lambda body: _high(_palms(body)) - _high(body.positions[:, None, INDEX["pelvis"]]),
    "hand_over_head": lambda body: _high(_palms(body)) - _high(body.positions[:, None, INDEX["head"]]),
    "hand_travel": lambda body: _travel(_from_pelvis(body, _palms(body))),
    # And how far they go from side to side.
    "hand_sweep": lambda body: np.broadcast_to(
        np.ptp(_from_pelvis(body, _palms(body))[..., 0], axis=0), (len(body.motion), 2)
    ),
    "hand_speed": lambda body: _speeds(body, _from_pelvis(body, _palms(body))),
    "hands_apart": lambda body: np.linalg.norm(_palms(body)[:, 0] - _palms(body)[:, 1], axis=-1),
    # Metres a second of a hand in the world at the end of what is shown, and how far from its last place it has been
    # within the second before (metres): the same in every frame.
    "hand_arrives": lambda body: _in_every(body, _arriving(_speeds(body, _palms(body)))),
    "hand_drawn_back": lambda body: _in_every(body, _drawn_back(_palms(body), body.motion.fps)),
    # Degrees that the left and the right hand turn in all.
    "hand_turn": lambda body: _turning(body, ("left_wrist", "right_wrist")),
    # Metres, of the left and the right foot: the lowest corner of its sole, and of both soles, its heel, its toes; its
    # ankle.
    "foot_height": lambda body: _high(body.soles).min(axis=-1),
    "in_flight": lambda body: _high(body.soles).min(axis=(-1, -2)),
    "heel_height": lambda body: _high(body.soles[:, :, 0]),
    "toe_height": lambda body: _high(body.soles[:, :, 1]),
    "foot_ahead": lambda body: _ahead(body, _both(body, "ankle")),
    "feet_apart": lambda body: _left_over_right(body, "ankle"),
    "knees_apart": lambda body: np.linalg.norm(_both(body, "knee")[:, 0] - _both(body, "knee")[:, 1], axis=-1),
    # Of who lies: how far the left ankle is to the left of the right one, and before or behind it.
    "ankles_across": lambda body: _in_pelvis(body, "ankle")[:, 0],
    "ankles_ahead": lambda body: np.abs(_in_pelvis(body, "ankle")[:, 2]),
    "neck_over_pelvis": lambda body: _high(_trunk(body)),
    "elbow_over_pelvis": lambda body: _high(_both(body, "elbow")) - _high(body.positions[:, None, INDEX["pelvis"]]),
    "elbow_to_knee": lambda body: np.linalg.norm(_both(body, "elbow") - _both(body, "knee"), axis=-1),
    # Metres and metres a second.
    "knee_height": lambda body: _high(_both(body, "knee")),
    "pelvis_height": lambda body: _high(body.positions[:, INDEX["pelvis"]]),
    "pelvis_rise": lambda body: _slope(_high(body.positions[:, INDEX["pelvis"]]), body.motion.fps),
    # The same as if the body rose as far as from a chair: from a high stool one comes up in the same time.
    "rise_pace": lambda body: _slope(_high(body.positions[:, INDEX["pelvis"]]), body.motion.fps) * _as_from_chair(body),
    "neck_speed": lambda body: _speeds(body, body.positions[:, INDEX["neck"]]),
    "pelvis_speed": lambda body: _speeds(body, body.positions[:, INDEX["pelvis"]] * [1.0, 0.0, 1.0]),
}  # fmt: skip
"""What can be measured of a body in every frame: (T,), or (T, 2) for left and right. (T, 2) over-floor heights count
from height 0."""
