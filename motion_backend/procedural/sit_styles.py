"""Ways of sitting: trunk, legs and hands, and which an emotion and a caption ask for (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from motion_backend.procedural.moods import Words, bearing_of, changes_of
from motion_backend.procedural.styles import AT_EASE, THIGHS, Bearing


@dataclass(frozen=True)
class Seated:
    """A way of sitting."""

    bearing: Bearing = AT_EASE
    arms: tuple[str, str] = (THIGHS, THIGHS)
    legs: str = "rest"
    """rest, straight, feet_crossed, open, crossed, left_straight, right_straight, drawn."""
    recline: float = 4.0
    """Backward lean of the trunk once seated; negative is forward. The backrest limits it."""
    head: float = 0.0
    doing: str = ""
    """What the hands do while seated: a name in `gestures.GESTURES`."""


_SIT_WORDS: Words = (
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


def sit_style(emotion: str, caption: str) -> Seated:
    """The way of sitting a caption asks for, in that emotion."""
    bearing, changes = bearing_of(emotion, caption), changes_of(caption, _SIT_WORDS)
    if "lean" in changes:
        bearing = replace(bearing, lean=changes.pop("lean"))
    slump = {"recline": 4.0 - 0.6 * max(bearing.lean, 0.0), "head": 0.8 * max(bearing.head, 0.0)}
    return Seated(bearing=bearing, **(slump | changes))
