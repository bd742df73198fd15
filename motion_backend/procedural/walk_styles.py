"""Ways of walking: the numbers of a gait, and which an emotion and a caption ask for (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from motion_backend.procedural.moods import BEARINGS, Words, changes_of, feeling
from motion_backend.procedural.styles import AT_EASE, Bearing


@dataclass(frozen=True)
class Walk:
    """Numbers of a gait."""

    bearing: Bearing = AT_EASE
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
    doing: str = ""
    """What the hands do where the body stays: a name in `gestures.GESTURES`."""
    release: bool = False
    """Whether arms come down at the end of the way, where something else begins."""


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
_WALK_WORDS: Words = (
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


def walk_style(emotion: str, caption: str) -> Walk:
    """The gait of an emotion, changed by what the caption says."""
    mood = feeling(emotion, caption)
    bearing, changes = BEARINGS[mood], changes_of(caption, _WALK_WORDS)
    carried = {name: changes.pop(name) for name in ("lean", "head", "arms") if name in changes}
    return Walk(bearing=replace(bearing, **carried), **(_WALKS[mood] | changes))
