"""How an emotion and a caption look: numbers for walking, sitting, lying and standing (SIMS 4.1, 8.1).

Angles are degrees here, since people tune them; everything else is metres, seconds and shares.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from motion_backend.procedural.pose import Array


@dataclass(frozen=True)
class ArmPose:
    """Where a left wrist is, from its shoulder in the chest frame (arm lengths), and where its elbow points."""

    wrist: tuple[float, float, float]
    elbow: tuple[float, float, float]


ARMS: dict[str, ArmPose] = {
    "hang": ArmPose((0.15, -0.955, 0.07), (0.25, 0.0, -1.0)),
    "bent": ArmPose((0.12, -0.74, 0.42), (0.45, -0.2, -1.0)),
    "behind_back": ArmPose((-0.22, -0.74, -0.33), (0.8, 0.0, -0.6)),
    "crossed": ArmPose((-0.42, -0.27, 0.32), (0.6, -0.8, 0.1)),
    "behind_head": ArmPose((-0.14, 0.42, -0.16), (1.0, 0.25, 0.2)),
    "ear": ArmPose((-0.09, 0.30, 0.15), (0.5, -0.8, 0.35)),
    "hips": ArmPose((0.06, -0.70, 0.08), (1.0, 0.0, -0.4)),
    "open": ArmPose((0.93, -0.02, 0.22), (0.0, -0.4, -1.0)),
    "face": ArmPose((-0.20, 0.26, 0.30), (0.35, -1.0, 0.35)),
    "belly": ArmPose((-0.16, -0.60, 0.33), (1.0, -0.2, -0.2)),
    "chest": ArmPose((-0.26, -0.14, 0.34), (0.8, -0.7, 0.0)),
    "props": ArmPose((0.20, -0.90, -0.27), (0.5, 0.0, -1.0)),
    "armrest": ArmPose((0.24, -0.62, 0.42), (0.7, -0.2, -0.8)),
    "sides": ArmPose((0.24, -0.93, 0.06), (0.8, 0.0, -0.5)),
    "chin": ArmPose((-0.24, 0.16, 0.26), (0.3, -1.0, 0.3)),
    "elbows": ArmPose((0.10, -0.62, 0.36), (0.35, -0.7, -0.8)),
    "balance": ArmPose((0.62, -0.62, 0.16), (0.2, -0.2, -1.0)),
    "read": ArmPose((-0.10, -0.34, 0.58), (0.7, -0.8, -0.1)),
}
THIGHS = "thighs"
"""Hands laid on the thighs: their place follows the legs, so it is not in the table."""


def arm_arrays(left: str, right: str) -> tuple[Array, Array]:
    """Wrist offsets and elbow directions of two named arm poses. (2, 3) each; right is mirrored."""
    mirror = np.array([-1.0, 1.0, 1.0])
    chosen = [ARMS.get(left, ARMS["hang"]), ARMS.get(right, ARMS["hang"])]
    wrists = np.array([chosen[0].wrist, chosen[1].wrist])
    elbows = np.array([chosen[0].elbow, chosen[1].elbow])
    wrists[1] *= mirror
    elbows[1] *= mirror
    if left == right == "crossed":
        wrists[1] += (0.02, -0.08, 0.07)
    return wrists, elbows


@dataclass(frozen=True)
class Bearing:
    """How the body carries itself: posture, pace and restlessness, whatever it does."""

    lean: float = 2.0
    """Forward bend of the trunk."""
    head: float = 3.0
    """Forward bend of the head."""
    tempo: float = 1.0
    """Speed of sitting, rising and reaching against neutral."""
    restless: float = 1.0
    """Size of idle movement against neutral."""
    arms: tuple[str, str] = ("hang", "hang")


@dataclass(frozen=True)
class Walk:
    """Numbers of a gait."""

    bearing: Bearing = Bearing()
    speed: float = 1.15
    """Metres a second on the straight."""
    stride: float = 1.0
    """Step length against what is usual at that speed."""
    width: float = 0.085
    """Half the distance between the feet."""
    clearance: float = 0.09
    """How high the ball of the foot swings."""
    bounce: float = 0.018
    sway: float = 0.022
    swing: float = 24.0
    """Arm swing to each side of the vertical."""
    twist: float = 6.0
    """Turn of the hips with each step; the chest turns against it."""
    elbow: float = 14.0
    crouch: float = 0.0
    """How much lower the pelvis is carried."""
    double: float = 0.22
    """Share of a step on both feet; negative is flight, as in running."""
    tiptoe: float = 0.0
    """Heel lift of standing feet."""
    wobble: float = 0.0
    """Size of the stagger of a drunk body."""
    spin: float = 0.0
    """Whole turns about itself along the way."""
    tap: bool = False
    """Hands tap the chest."""


@dataclass(frozen=True)
class Seated:
    """A way of sitting."""

    bearing: Bearing = Bearing()
    arms: tuple[str, str] = (THIGHS, THIGHS)
    legs: str = "rest"
    """rest, straight, feet_crossed, open, crossed, left_straight, right_straight, drawn."""
    recline: float = 4.0
    """Backward lean of the trunk once seated; negative is forward. The backrest limits it."""
    head: float = 0.0


@dataclass(frozen=True)
class Lying:
    """A way of lying."""

    bearing: Bearing = Bearing()
    side: str = "back"
    """back, left or right: what is down."""
    arms: tuple[str, str] = ("sides", "sides")
    legs: str = "straight"
    """straight, left_bent, right_bent, bent, crossed."""
    prop: float = 0.0
    """How far the trunk is propped up."""


BEARINGS: dict[str, Bearing] = {
    "neutral": Bearing(),
    "happy": Bearing(lean=-3, head=-7, tempo=1.2, restless=1.5),
    "angry": Bearing(lean=9, head=10, tempo=1.3, restless=1.4, arms=("bent", "bent")),
    "hurried": Bearing(lean=7, head=2, tempo=1.4, restless=1.5),
    "tired": Bearing(lean=13, head=16, tempo=0.75, restless=0.7),
    "sad": Bearing(lean=15, head=24, tempo=0.72, restless=0.5),
    "stressed": Bearing(lean=7, head=13, tempo=1.05, restless=1.8),
    "drunk": Bearing(lean=6, head=11, tempo=0.8, restless=3.5),
    "relaxed": Bearing(lean=-2, head=0, tempo=0.9, restless=0.9),
}
_WALKS: dict[str, dict[str, Any]] = {
    "neutral": {},
    "happy": {"speed": 1.3, "bounce": 0.035, "swing": 34.0, "elbow": 22.0, "clearance": 0.10},
    "angry": {"speed": 1.4, "stride": 1.06, "swing": 30.0, "elbow": 38.0, "bounce": 0.022, "clearance": 0.10},
    "hurried": {"speed": 1.6, "swing": 32.0, "elbow": 45.0},
    "tired": {"speed": 0.75, "stride": 0.92, "swing": 13.0, "clearance": 0.085, "bounce": 0.012, "crouch": 0.02},
    "sad": {"speed": 0.7, "stride": 0.9, "swing": 9.0, "clearance": 0.085, "bounce": 0.01, "crouch": 0.015},
    "stressed": {"speed": 1.0, "stride": 0.92, "swing": 14.0, "elbow": 30.0},
    "drunk": {"speed": 0.7, "stride": 0.85, "width": 0.12, "sway": 0.05, "swing": 20.0, "wobble": 1.0, "elbow": 25.0},
    "relaxed": {"speed": 0.95, "swing": 22.0, "sway": 0.028, "bounce": 0.015},
}
_FEELINGS = (
    ("drunk", r"drunk|tipsy|zombie|stagger|intoxicat|hangover"),
    ("angry", r"ang(er|ry)|furious|rage|mad\b|irritat|annoy|cold"),
    ("hurried", r"hurr|rush|urgen|panic|haste|late\b"),
    ("sad", r"sad|depress|grie|mourn|lonely|pain|heartbr|disappoint|melanchol|cry"),
    ("stressed", r"stress|anxi|nervous|worr|serious|disturb|uncomfort|tense|afraid|scared|guilt|asham"),
    ("tired", r"tired|sleepy|exhaust|weary|drows|sick|bored"),
    ("happy", r"happy|excit|joy|child|playful|cheer|proud|confident|elat|celebrat|curious|love"),
    ("relaxed", r"relax|content|peace|cozy|comfort|dream"),
)


@lru_cache(maxsize=4096)
def feeling(emotion: str, caption: str = "") -> str:
    """The one of nine emotions that free text such as "tired, depressed, drunk" stands for: the first word decides.

    A neutral emotion falls back to what the caption says ("walking drunkenly").
    """
    for text in (emotion.lower(), caption.lower()):
        found = [(match.start(), name) for name, pattern in _FEELINGS if (match := re.search(pattern, text))]
        if "drunk" in [name for _, name in found]:
            return "drunk"
        if found:
            return min(found)[1]
    return "neutral"


def bearing_of(emotion: str, caption: str = "") -> Bearing:
    """Posture and pace of an emotion."""
    return BEARINGS[feeling(emotion, caption)]


# Each row: what the caption says, and what changes. Later rows win, so put the particular after the general.
_WALK_WORDS: tuple[tuple[str, dict[str, Any]], ...] = (
    (r"slow", {"speed": 0.65}),
    (r"large steps|big steps|stride", {"stride": 1.22, "speed": 1.3}),
    (r"rush|hurr", {"speed": 1.7}),
    (r"excited", {"speed": 1.35, "bounce": 0.04, "swing": 38.0}),
    (r"angr|stomp", {"clearance": 0.115, "bounce": 0.028, "elbow": 40.0}),
    (r"old", {"speed": 0.5, "stride": 0.72, "lean": 24, "head": -4, "crouch": 0.055, "swing": 6.0, "elbow": 45.0}),
    (r"knees? bent", {"crouch": 0.13, "lean": 14, "speed": 0.9}),
    (r"leaning back|body lean", {"lean": -15, "head": 8, "speed": 0.85}),
    (r"head bowed|body bent|depress", {"lean": 20, "head": 28, "swing": 8.0, "speed": 0.7}),
    (r"uplifted|head up|head held high", {"lean": -4, "head": -22}),
    (r"tiptoe|sneak|quiet", {"tiptoe": 32.0, "speed": 0.7, "clearance": 0.10, "arms": ("balance", "balance")}),
    (r"drunk|stagger|stumbl", {"wobble": 1.0, "speed": 0.7, "width": 0.12, "sway": 0.05}),
    (r"behind (his |her |the )?back", {"arms": ("behind_back", "behind_back"), "swing": 0.0}),
    (r"arms? crossed|crossing arms", {"arms": ("crossed", "crossed"), "swing": 0.0}),
    (r"hands? .*hips", {"arms": ("hips", "hips"), "swing": 0.0, "lean": -3}),
    (r"phone.*left|left.*phone", {"arms": ("ear", "hang"), "head": 8}),
    (r"phone(?!.*left)", {"arms": ("hang", "ear"), "head": 8}),
    (r"tap chest|chest.*tap", {"tap": True, "arms": ("chest", "chest"), "swing": 0.0}),
    (r"\brun|jog", {"speed": 1.9, "double": -0.14, "bounce": 0.045, "elbow": 75.0, "swing": 32.0, "lean": 7}),
    (r"skip", {"speed": 1.6, "double": -0.22, "bounce": 0.075, "swing": 40.0, "elbow": 30.0, "clearance": 0.14}),
    (r"open arms|arms open|arms wide|arms opened", {"arms": ("open", "open"), "swing": 0.0}),
    (r"spin|danc|twirl", {"spin": 1.0, "arms": ("balance", "balance"), "swing": 0.0, "speed": 1.3}),
    (r"danc", {"bounce": 0.05, "sway": 0.05}),
)
_SIT_WORDS: tuple[tuple[str, dict[str, Any]], ...] = (
    (r"lean(ing)? back|lying back|recline|against", {"recline": 22.0}),
    (r"upright|straight back", {"recline": 0.0, "lean": 0}),
    (r"head (bowed|down|lowered)", {"head": 28.0, "recline": -14.0}),
    (r"arms? (loose|relaxed|at)|relaxed at sides|arms loosely", {"arms": ("sides", "sides")}),
    (r"armrest|resting hands", {"arms": ("armrest", "armrest")}),
    (r"support(ing)? (the )?(on|body|him|her)|hands on (floor|seat)|hands support", {"arms": ("props", "props"), "recline": 12.0}),
    (r"thigh|lap|knees", {"arms": (THIGHS, THIGHS)}),
    (r"cross(ing|ed)? arms|arms cross", {"arms": ("crossed", "crossed")}),
    (r"behind (the |his |her )?head|supporting (the )?head$|hands supporting head", {"arms": ("behind_head", "behind_head"), "recline": 20.0}),
    (r"supporting head with hands|holding head|head in hands|cover", {"arms": ("face", "face"), "recline": -28.0, "head": 24.0}),
    (r"chin|one hand on (the )?(face|cheek)|thinking", {"arms": (THIGHS, "chin"), "head": 10.0}),
    (r"\bread|book|writing|typing|letter|photo", {"arms": ("read", "read"), "head": 20.0}),
    (r"phone.*left", {"arms": ("ear", THIGHS)}),
    (r"phone(?!.*left)", {"arms": (THIGHS, "ear")}),
    (r"legs? (straight|extended|stretched)|straight legs|stretched out", {"legs": "straight"}),
    (r"left leg (straight|stretched|extended)", {"legs": "left_straight"}),
    (r"right leg (straight|stretched|extended)", {"legs": "right_straight"}),
    (r"right leg held", {"legs": "left_straight"}),
    (r"legs (spread|open|apart)", {"legs": "open"}),
    (r"feet crossed|ankles crossed", {"legs": "feet_crossed"}),
    (r"cross-legged|legs crossed|crossed legs", {"legs": "crossed"}),
    (r"knees? (up|drawn)|hugging", {"legs": "drawn"}),
)  # fmt: skip
_LIE_WORDS: tuple[tuple[str, dict[str, Any]], ...] = (
    (r"belly|stomach|chest", {"arms": ("belly", "belly")}),
    (r"(under|behind|supporting) (the |his |her )?head", {"arms": ("behind_head", "behind_head")}),
    (r"right (arm|hand) .*head", {"arms": ("belly", "behind_head")}),
    (r"left (arm|hand) .*head", {"arms": ("behind_head", "belly")}),
    (r"right hand on belly", {"arms": ("sides", "belly")}),
    (r"cover", {"arms": ("face", "face")}),
    (r"elbows? support|propp", {"prop": 32.0, "arms": ("elbows", "elbows")}),
    (r"legs (are )?bent|knees bent|curled", {"legs": "bent"}),
    (r"legs crossed", {"legs": "crossed"}),
    (r"left leg bent|left knee|left foot on", {"legs": "left_bent"}),
    (r"right leg bent|right knee|right foot on", {"legs": "right_bent"}),
    (r"side[- ]?l(ie|ying)( on)?( the)? left|on (his |her |the )?left side", {"side": "left"}),
    (r"side[- ]?l(ie|ying)( on)?( the)? right|on (his |her |the )?right side", {"side": "right"}),
)


def _changes(caption: str, words: tuple[tuple[str, dict[str, Any]], ...]) -> dict[str, Any]:
    changes: dict[str, Any] = {}
    for pattern, row in words:
        if re.search(pattern, caption.lower()):
            changes |= row
    return changes


def walk_style(emotion: str, caption: str) -> Walk:
    """The gait of an emotion, changed by what the caption says."""
    mood = feeling(emotion, caption)
    bearing, changes = BEARINGS[mood], _changes(caption, _WALK_WORDS)
    carried = {name: changes.pop(name) for name in ("lean", "head", "arms") if name in changes}
    return Walk(bearing=replace(bearing, **carried), **(_WALKS[mood] | changes))


def sit_style(emotion: str, caption: str) -> Seated:
    """The way of sitting a caption asks for, in that emotion."""
    bearing, changes = bearing_of(emotion, caption), _changes(caption, _SIT_WORDS)
    if "lean" in changes:
        bearing = replace(bearing, lean=changes.pop("lean"))
    slump = {"recline": 4.0 - 0.6 * max(bearing.lean, 0.0), "head": 0.8 * max(bearing.head, 0.0)}
    return Seated(bearing=bearing, **(slump | changes))


def lie_style(emotion: str, caption: str) -> Lying:
    """The way of lying a caption asks for."""
    return Lying(bearing=bearing_of(emotion, caption), **_changes(caption, _LIE_WORDS))
