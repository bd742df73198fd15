"""Ways of sitting: trunk, legs and hands, and which an emotion and a caption ask for (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from motion_backend.motion import Emotion
from motion_backend.procedural.emotion_style import AT_EASE, THIGHS, Bearing, Words, bearing_of, changes_of


@dataclass(frozen=True)
class Manner:
    """How one goes down onto a seat and leaves it."""

    glance: float = 1.0
    """How far one looks back at the seat first, 0 to 1."""
    hands: tuple[bool, bool] = (False, True)
    """Which hands feel for the armrest or the seat on the way down."""
    plump: float = 0.4
    """How heavily one lands, 0 to 1: the pelvis sinks and comes up again."""
    sway: float = 0.0
    """To the side on the way (metres)."""


MANNERS: dict[str, Manner] = {
    "neutral": Manner(),
    "happy": Manner(glance=0.4, hands=(False, False), plump=0.9),
    "angry": Manner(glance=0.0, hands=(False, False), plump=1.0),
    "hurried": Manner(glance=0.5, hands=(False, False), plump=0.7),
    "tired": Manner(glance=0.6, hands=(True, True), plump=1.0),
    "sad": Manner(glance=0.3, hands=(True, False), plump=0.3),
    "stressed": Manner(glance=1.0, hands=(True, True), plump=0.2),
    "drunk": Manner(glance=0.8, hands=(True, True), plump=1.0, sway=0.05),
    "relaxed": Manner(glance=0.5, hands=(False, True), plump=0.6),
}


@dataclass(frozen=True)
class Seated:
    """A way of sitting."""

    bearing: Bearing = AT_EASE
    manner: Manner = MANNERS["neutral"]
    arms: tuple[str, str] = (THIGHS, THIGHS)
    """A rest of `resting_hands.HOLDS`, a surface of `seated.SURFACES` or an arm pose of `styles.ARMS` for each hand."""
    legs: str = "rest"
    """One of `seated_legs.WAYS`."""
    recline: float = 4.0
    """Backward lean of the trunk once seated; negative is forward. The backrest limits it."""
    on_elbows: bool = False
    """Leaning forward just as far as elbows lie on thighs or table, whatever `recline` says."""
    head: float = 0.0
    tilt: float = 0.0
    """Head turned to the left."""
    doing: str = ""
    """What the hands do while seated: a name in `gestures.GESTURES`."""


_DESK = ("table", "table")
_SIT_WORDS: Words = (
    (r"lean(ing)? back|lying back|recline|against", {"recline": 22.0}),
    (r"upright|straight back", {"recline": 0.0, "lean": 0}),
    (r"\bstill\b", {"arms": ("folded", "folded_over"), "legs": "together"}),
    (r"head (bowed|down|lowered)", {"head": 28.0, "recline": -14.0}),
    (r"arms? (loose|relaxed|at)|relaxed at sides|arms loosely", {"arms": ("beside", "beside")}),
    (r"lying back", {"head": -6.0, "legs": "slouched"}),
    (r"armrest|resting hands", {"arms": ("armrest", "armrest")}),
    (r"support(ing)? (the )?(body|him|her)|hands support", {"arms": ("edge", "edge"), "recline": -6.0}),
    (r"hands? (support )?on (the )?seat", {"arms": ("beside", "beside"), "recline": 0.0}),
    (r"hands? on (the )?floor", {"arms": ("behind", "behind"), "recline": 20.0}),
    (r"thigh|lap", {"arms": (THIGHS, THIGHS)}),
    (r"knees", {"arms": ("knees", "knees")}),
    (r"lean(ing)? forward", {"head": 6.0, "arms": ("clasped", "clasped"), "on_elbows": True}),
    (r"forearms? on", {"head": 2.0, "arms": ("desk", "desk"), "on_elbows": True}),
    (r"cross(ing|ed)? arms|arms cross", {"arms": ("crossed", "crossed")}),
    (r"behind (the |his |her )?head", {"arms": ("behind_head", "behind_head"), "head": -4.0}),
    (r"supporting (the )?head$|hands supporting head", {"arms": ("nape", "nape"), "head": -14.0}),
    (r"holding (the )?head", {"arms": ("temples", "temples"), "recline": -12.0, "head": 16.0}),
    (
        r"supporting head with hands|head in hands|cover",
        {"arms": ("forehead", "forehead"), "head": 22.0, "on_elbows": True},
    ),
    (r"chin|one hand on (the )?(face|cheek)|thinking", {"arms": ("belly", "chin"), "head": 8.0, "recline": -6.0}),
    (r"\bread|book|letter|photo", {"arms": ("read", "read"), "head": 20.0, "doing": "read"}),
    (r"\bwrit(e|ing)|drawing|sketch", {"arms": _DESK, "head": 22.0, "recline": -14.0, "doing": "write"}),
    (r"\btyp(e|ing)|keyboard|laptop", {"arms": _DESK, "head": 12.0, "recline": -5.0, "doing": "type"}),
    (r"piano|keys\b", {"arms": ("keys", "keys"), "head": 10.0, "recline": -6.0, "doing": "piano"}),
    (r"game|controller", {"arms": ("gamepad", "gamepad"), "recline": -8.0, "doing": "game"}),
    (r"drink|sip|\bcup\b|\bmug\b", {"arms": (THIGHS, "cup"), "doing": "drink"}),
    (r"(drink|sip|\bcup\b|\bmug\b).*\bleft\b", {"arms": ("cup", THIGHS), "doing": "drink_left"}),
    (r"\beat(ing)?\b|spoon|\bfork\b", {"arms": _DESK, "head": 12.0, "recline": -10.0, "doing": "eat"}),
    (r"music|at (the |his |her )?ears", {"arms": ("ears", "ears"), "doing": "music"}),
    (r"phone.*left", {"arms": ("phone", THIGHS), "tilt": 7.0}),
    (r"phone(?!.*left)", {"arms": (THIGHS, "phone"), "tilt": -7.0}),
    (r"legs? (straight|extended|stretched)|straight legs|stretched out", {"legs": "straight"}),
    (r"left leg (straight|stretched|extended)", {"legs": "left_straight"}),
    (r"right leg (straight|stretched|extended)", {"legs": "right_straight"}),
    (r"right leg held", {"legs": "held", "arms": ("other_shin", "own_shin"), "recline": 8.0}),
    (r"legs (spread|open|apart)", {"legs": "open"}),
    (r"feet crossed|ankles crossed", {"legs": "feet_crossed"}),
    (r"cross-legged|legs crossed|crossed legs", {"legs": "crossed"}),
    (r"cross-legged.*hands on (the )?knees", {"arms": ("crossed_ankle", "knees")}),
    (r"knees? (up|drawn)|hugging", {"legs": "drawn"}),
)  # fmt: skip


def sit_style(emotion: Emotion, caption: str) -> Seated:
    """The way of sitting a caption asks for, in that emotion."""
    bearing, changes = bearing_of(emotion, caption), changes_of(caption, _SIT_WORDS)
    if "lean" in changes:
        bearing = replace(bearing, lean=changes.pop("lean"))
    slump = {"recline": 4.0 - 0.6 * max(bearing.lean, 0.0), "head": 0.8 * max(bearing.head, 0.0)}
    return Seated(bearing=bearing, manner=MANNERS[emotion], **(slump | changes))
