"""How an emotion and a caption look: the style each asks for (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache
from typing import Any

from motion_backend.procedural.styles import THIGHS, Bearing, Lying, Seated, Walk

STILL = 0.3
"""Restlessness, against its mood, of who keeps still."""

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
    """Posture and pace of an emotion; "slowly" and "abruptly" in the caption change the pace."""
    bearing = BEARINGS[feeling(emotion, caption)]
    if re.search(r"slow|weari", caption.lower()):
        return replace(bearing, tempo=min(bearing.tempo, 0.7))
    if re.search(r"abrupt|quick|sudden|leap|jump", caption.lower()):
        return replace(bearing, tempo=max(bearing.tempo, 1.5))
    if re.search(r"\bstill\b", caption.lower()):
        return replace(bearing, restless=STILL * bearing.restless)
    return bearing


# Each row: what the caption says, and what changes. Later rows win, so put the particular after the general.
_WALK_WORDS: tuple[tuple[str, dict[str, Any]], ...] = (
    (r"slow|stroll", {"speed": 0.65}),
    (r"quick", {"speed": 1.55, "elbow": 30.0}),
    (r"pac(e|ing)", {"speed": 1.0, "stride": 0.9}),
    (
        r"shuffl|drag|sleepil|weari",
        {"speed": 0.6, "stride": 0.75, "bounce": 0.008, "swing": 6.0, "lean": 14, "head": 18},
    ),
    (r"sidestep", {"speed": 0.6, "stride": 0.7, "width": 0.13, "swing": 10.0}),
    (r"march", {"clearance": 0.15, "bounce": 0.03, "swing": 42.0, "elbow": 20.0, "lean": -3, "head": -4}),
    (r"pocket", {"arms": ("pockets", "pockets"), "swing": 0.0}),
    (r"wrapped|hugging", {"arms": ("wrapped", "wrapped"), "swing": 0.0, "lean": 8}),
    (r"careful|balance", {"arms": ("balance", "balance"), "swing": 0.0, "speed": 0.7, "stride": 0.85}),
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
    (r"spin|danc|twirl", {"spin": 1.0, "arms": ("balance", "balance"), "swing": 0.0}),
    (r"\bwav(e|ing)\b", {"arms": ("hang", "wave"), "swing": 0.0, "doing": "wave"}),
    (r"\bwav(e|ing)\b.*left", {"arms": ("wave", "hang")}),
    (r"danc", {"bounce": 0.05, "sway": 0.05, "speed": 1.3}),
)
_SIT_WORDS: tuple[tuple[str, dict[str, Any]], ...] = (
    (r"lean(ing)? back|lying back|recline|against", {"recline": 22.0}),
    (r"upright|straight back", {"recline": 0.0, "lean": 0}),
    (r"head (bowed|down|lowered)", {"head": 28.0, "recline": -14.0}),
    (r"arms? (loose|relaxed|at)|relaxed at sides|arms loosely", {"arms": ("sides", "sides")}),
    (r"armrest|resting hands", {"arms": ("armrest", "armrest")}),
    (
        r"support(ing)? (the )?(on|body|him|her)|hands on (floor|seat)|hands support",
        {"arms": ("props", "props"), "recline": 12.0},
    ),
    (r"thigh|lap|knees", {"arms": (THIGHS, THIGHS)}),
    (r"lean(ing)? forward", {"recline": -24.0, "head": 6.0, "arms": ("on_knees", "on_knees")}),
    (r"cross(ing|ed)? arms|arms cross", {"arms": ("crossed", "crossed")}),
    (
        r"behind (the |his |her )?head|supporting (the )?head$|hands supporting head",
        {"arms": ("behind_head", "behind_head"), "recline": 20.0},
    ),
    (
        r"supporting head with hands|holding head|head in hands|cover",
        {"arms": ("face", "face"), "recline": -28.0, "head": 24.0},
    ),
    (r"chin|one hand on (the )?(face|cheek)|thinking", {"arms": (THIGHS, "chin"), "head": 10.0}),
    (r"\bread|book|letter|photo", {"arms": ("read", "read"), "head": 20.0}),
    (r"\bwrit(e|ing)|drawing|sketch", {"arms": (THIGHS, THIGHS), "head": 20.0, "recline": -14.0, "doing": "write"}),
    (r"\btyp(e|ing)|keyboard|laptop", {"arms": (THIGHS, THIGHS), "head": 16.0, "recline": -8.0, "doing": "type"}),
    (r"piano|keys\b", {"arms": ("keys", "keys"), "head": 10.0, "recline": -6.0, "doing": "piano"}),
    (r"game|controller", {"arms": ("gamepad", "gamepad"), "recline": -8.0, "doing": "game"}),
    (r"drink|sip|\bcup\b|\bmug\b", {"arms": (THIGHS, "cup"), "doing": "drink"}),
    (r"\beat(ing)?\b|spoon|\bfork\b", {"arms": (THIGHS, THIGHS), "head": 12.0, "recline": -10.0, "doing": "eat"}),
    (r"music|at (the |his |her )?ears", {"arms": ("ears", "ears"), "doing": "music"}),
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
    (r"spread|wide", {"arms": ("wide", "wide")}),
    (r"belly|stomach|chest", {"arms": ("belly", "belly")}),
    (r"(under|behind|supporting) (the |his |her )?head", {"arms": ("behind_head", "behind_head")}),
    (r"right (arm|hand) .*head", {"arms": ("belly", "behind_head")}),
    (r"left (arm|hand) .*head", {"arms": ("behind_head", "belly")}),
    (r"right hand on belly", {"arms": ("sides", "belly")}),
    (r"cover", {"arms": ("face", "face")}),
    (r"\bread|book", {"arms": ("held_above", "held_above")}),
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
