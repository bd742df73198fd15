"""Ways of walking: the numbers of a gait, and which an emotion and a caption ask for (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from motion_backend.motion import Emotion
from motion_backend.procedural.emotion_style import AT_EASE, BEARINGS, Bearing, Words, changes_of


@dataclass(frozen=True)
class Walk:
    """Numbers of a gait."""

    bearing: Bearing = AT_EASE
    speed: float = 1.15
    """Metres a second on the straight."""
    stride: float = 1.0
    """Step length against what is usual at that speed."""
    width: float = 0.085
    """Half the distance between the feet where the body stands; in full stride they come nearer."""
    clearance: float = 0.058
    """How high the ball of the foot swings."""
    bounce: float = 0.006
    stamp: float = 0.0
    """How far the body drops onto each foot that comes down (metres)."""
    sway: float = 0.038
    hips: float = 4.6
    """How far the pelvis tips to the side of the leg that swings."""
    swing: float = 18.0
    """Arm swing to each side of the vertical."""
    twist: float = 6.0
    """Turn of the hips with each step; the chest turns against it."""
    elbow: float = 19.0
    splay: float = 0.0
    """How much further from the body hands swing (arm lengths)."""
    across: float = 0.0
    """Share of arms swinging together from side to side."""
    crouch: float = 0.0
    """How much lower the pelvis is carried."""
    double: float = 0.12
    """Share of a step on both feet; negative is flight, as in running."""
    roll: float = 1.0
    """How far the heel rises behind, against a usual step."""
    strike: float = 1.0
    """How far the tip of the foot points up as the heel comes down, likewise."""
    scuff: float = 0.0
    """How far its tip points up all the way, so that the heel scuffs over the floor."""
    tiptoe: float = 0.0
    """Heel lift of standing feet."""
    drag: float = 0.0
    """How far the right foot, which hardly leaves the floor, stays behind (metres)."""
    uneven: float = 0.0
    """How much steps differ from each other (share)."""
    wobble: float = 0.0
    """Size of the stagger of a drunk body."""
    glance: float = 0.0
    """How far the gaze wanders to the sides."""
    nod: float = 0.0
    """How far the head sinks and rises again, slowly."""
    tilt: float = 0.0
    """How far the head lies on its right side, as on a telephone; negative on the left."""
    spin: float = 0.0
    """Whole turns about itself along the way."""
    skips: bool = False
    """Whether each foot hops on before the other one lands."""
    aside: float = 0.0
    """How far from its way the body faces: 90 in stepping sideways, 180 backwards."""
    to_and_fro: bool = False
    """Whether it turns round on the way, goes back and comes again."""
    veer: float = 0.0
    """How far it looks to the left (right if negative) while its way curves there."""
    tap: bool = False
    """Hands tap the chest."""
    doing: str = ""
    """What the hands do meanwhile: a name in `gestures.GESTURES`."""
    release: bool = False
    """Whether arms come down at the end of the way, where something else begins."""


_WALKS: dict[str, dict[str, Any]] = {
    "neutral": {},
    "happy": {"speed": 1.3, "bounce": 0.032, "swing": 34.0, "elbow": 24.0, "hips": 6.0, "clearance": 0.085},
    "angry": {"speed": 1.4, "stride": 0.94, "swing": 27.0, "elbow": 40.0, "stamp": 0.012, "splay": 0.07, "twist": 8.0},
    "hurried": {"speed": 1.6, "stride": 0.94, "swing": 28.0, "elbow": 55.0, "twist": 8.0},
    "tired": {"speed": 0.75, "stride": 0.92, "swing": 20.0, "bounce": 0.01, "crouch": 0.025,
              "sway": 0.042, "strike": 0.8, "roll": 0.8, "nod": 4.0, "elbow": 8.0},
    "sad": {"speed": 0.68, "stride": 0.88, "swing": 6.0, "bounce": 0.007, "crouch": 0.01,
            "twist": 3.0, "strike": 0.9, "roll": 0.8, "elbow": 10.0},
    "stressed": {"speed": 1.15, "stride": 0.82, "swing": 9.0, "elbow": 42.0, "glance": 20.0, "uneven": 0.05,
                 "twist": 4.0, "sway": 0.02},
    "drunk": {"speed": 0.7, "stride": 0.85, "width": 0.13, "sway": 0.05, "swing": 18.0, "wobble": 1.35, "elbow": 25.0,
              "uneven": 0.12, "splay": 0.12, "glance": 10.0, "nod": 6.0},
    "relaxed": {"speed": 0.92, "swing": 23.0, "sway": 0.045, "bounce": 0.012, "hips": 5.6, "twist": 7.5,
                "elbow": 10.0, "glance": 8.0},
}  # fmt: skip
_SHUFFLING = {"speed": 0.42, "stride": 0.62, "bounce": 0.004, "swing": 4.0, "clearance": 0.046, "roll": 0.22,
              "strike": 0.0, "scuff": 12.5, "twist": 3.0, "hips": 2.0, "crouch": 0.008, "nod": 9.0, "lean": 10,
              "head": 24}  # fmt: skip
_DRAGGING = {"speed": 0.6, "stride": 0.95, "drag": 0.09, "sway": 0.05, "hips": 5.5, "swing": 12.0, "clearance": 0.085,
             "strike": 0.2, "scuff": 15.0, "roll": 0.45, "crouch": 0.005, "lean": 17, "head": 14,
             "uneven": 0.04}  # fmt: skip
_WALK_WORDS: Words = (
    (r"\bsmooth", {"speed": 1.0, "bounce": 0.008, "sway": 0.046, "swing": 25.0, "twist": 8.0, "elbow": 9.0}),
    (r"\bstead(y|il)", {"sway": 0.037, "twist": 4.7, "hips": 4.4}),
    (r"slow|stroll", {"speed": 0.65}),
    (r"stroll", {"speed": 0.8, "glance": 22.0, "hips": 5.0, "sway": 0.036, "lean": -3}),
    (r"quick", {"speed": 1.6, "elbow": 30.0, "stride": 1.04}),
    (r"pac(e|ing)", {"speed": 1.0, "stride": 0.9, "to_and_fro": True, "head": 14, "arms": ("belly", "hang")}),
    (r"shuffl|sleepil", _SHUFFLING),
    (r"drag|weari", _DRAGGING),
    (r"side ?step", {"speed": 0.45, "width": 0.15, "swing": 0.0, "aside": 90.0, "twist": 0.0, "bounce": 0.02,
                     "hips": 2.0, "arms": ("bent", "bent"), "elbow": 30.0, "crouch": 0.02, "clearance": 0.14}),
    (r"backwards?\b", {"speed": 0.65, "aside": 180.0, "stride": 0.8, "swing": 12.0, "glance": 25.0, "crouch": 0.01}),
    (r"march", {"clearance": 0.30, "bounce": 0.018, "swing": 44.0, "elbow": 10.0, "lean": -3, "head": -4, "roll": 0.95,
                "strike": 0.0, "stamp": 0.008, "speed": 1.05, "stride": 0.88, "splay": 0.06}),
    (r"pocket", {"arms": ("pockets", "pockets"), "swing": 0.0}),
    (r"wrapped|hugging", {"arms": ("wrapped", "wrapped"), "swing": 0.0, "lean": 10, "head": 12, "stride": 0.85}),
    (r"careful|balance", {"arms": ("balance", "balance"), "swing": 0.0, "speed": 0.6, "stride": 0.85, "head": 9,
                          "lean": 5, "clearance": 0.11, "crouch": 0.02, "width": 0.05, "roll": 0.6, "strike": 0.9}),
    (r"large steps|big steps|stride", {"stride": 1.38, "speed": 1.25, "swing": 38.0, "twist": 11.0, "bounce": 0.025,
                                               "clearance": 0.13}),
    (r"rush|hurr", {"speed": 1.75}),
    (r"anxious", {"lean": 11, "stride": 0.8, "swing": 20.0, "elbow": 60.0, "glance": 22.0}),
    (r"excited", {"speed": 1.4, "bounce": 0.045, "swing": 40.0, "elbow": 35.0, "hips": 5.5, "roll": 1.15}),
    (r"angr", {"elbow": 45.0, "lean": 13, "head": 15}),
    (r"stomp", {"clearance": 0.20, "stamp": 0.035, "speed": 0.95, "stride": 0.95, "elbow": 20.0, "splay": 0.14,
                "strike": 0.0, "roll": 0.9, "arms": ("fists", "fists"), "lean": 7, "head": 12, "sway": 0.045,
                "swing": 24.0}),
    (r"\bold\b", {"speed": 0.5, "stride": 0.72, "lean": 26, "head": -6, "crouch": 0.04, "swing": 7.0, "elbow": 45.0,
                  "strike": 0.3, "roll": 0.5, "clearance": 0.052, "scuff": 8.0, "width": 0.10, "uneven": 0.05}),
    (r"knees? bent", {"crouch": 0.08, "roll": 1.3, "lean": 16, "speed": 0.9, "elbow": 35.0}),
    (r"leaning back|body lean", {"lean": -17, "head": 12, "speed": 0.85, "swing": 14.0}),
    (r"depress", {"lean": 12, "head": 26, "swing": 5.0, "speed": 0.62, "stride": 0.8}),
    (r"head bowed|body bent", {"lean": 30, "head": 26, "swing": 12.0, "speed": 0.8}),
    (r"uplifted|head up|head held high", {"lean": -5, "head": -24, "speed": 1.1, "twist": 7.0}),
    (r"tiptoe|sneak|quiet", {"tiptoe": 32.0, "speed": 0.7, "clearance": 0.16, "arms": ("balance", "balance"),
                             "strike": 0.0, "roll": 0.25}),
    (r"drunk|stagger|stumbl", {"wobble": 1.35, "speed": 0.7, "width": 0.13, "sway": 0.05}),
    (r"behind (his |her |the )?back", {"arms": ("behind_back", "behind_back"), "swing": 0.0}),
    (r"arms? crossed|crossing arms", {"arms": ("crossed", "crossed"), "swing": 0.0}),
    (r"hands? .*hips", {"arms": ("hips", "hips"), "swing": 0.0, "lean": -3, "hips": 6.0, "twist": 8.0}),
    (r"phone.*left|left.*phone", {"arms": ("ear", "hang"), "head": 8, "tilt": -9.0, "speed": 0.95}),
    (r"phone(?!.*left)", {"arms": ("hang", "ear"), "head": 8, "tilt": 9.0, "speed": 0.95}),
    (r"tap chest|chest.*tap", {"tap": True, "arms": ("chest", "chest"), "swing": 0.0}),
    (r"\brun|jog", {"speed": 2.1, "double": -0.26, "bounce": 0.04, "elbow": 80.0, "swing": 30.0, "lean": 8, "roll": 1.3,
                    "strike": 0.3, "clearance": 0.16, "twist": 9.0}),
    (r"skip", {"speed": 1.5, "swing": 44.0, "elbow": 35.0, "clearance": 0.30, "skips": True, "double": 0.06,
               "roll": 1.0, "strike": 0.0, "lean": -1, "bounce": 0.016}),
    (r"open arms|arms open|arms wide|arms opened", {"arms": ("open", "open"), "swing": 0.0}),
    (r"spin|twirl", {"spin": 1.0, "arms": ("balance", "balance"), "swing": 0.0, "clearance": 0.11}),
    (r"\bwav(e|ing)\b", {"arms": ("hang", "wave"), "doing": "wave"}),
    (r"\bwav(e|ing)\b.*left", {"arms": ("wave", "hang")}),
    (r"front left|(to|towards?) the left", {"veer": 36.0}),
    (r"front right|(to|towards?) the right", {"veer": -36.0}),
    (r"danc", {"bounce": 0.045, "sway": 0.06, "hips": 9.0, "twist": 11.0, "speed": 0.9, "spin": 1.0, "across": 1.0,
               "stride": 0.85, "roll": 1.1, "clearance": 0.10, "arms": ("bent", "bent")}),
)  # fmt: skip


def walk_style(emotion: Emotion, caption: str) -> Walk:
    """The gait of an emotion, changed by what the caption says."""
    bearing, changes = BEARINGS[emotion], changes_of(caption, _WALK_WORDS)
    carried = {name: changes.pop(name) for name in ("lean", "head", "arms") if name in changes}
    return Walk(bearing=replace(bearing, **carried), **(_WALKS[emotion] | changes))
