"""Ways of walking: the numbers of a gait, which data/styles/walk.toml has by emotion and caption (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from motion_backend.motion import Action, Emotion, Skill
from motion_backend.procedural.emotion_style import Bearing, bearings, carried
from motion_backend.procedural.style_sheet import (
    ArmLengths,
    Degrees,
    Metres,
    MetresPerSecond,
    Ratio,
    Seconds,
    Share,
    StyleSheet,
    Turns,
    read_style_sheet,
)
from motion_backend.procedural.walk.gait_character import NOBODY, GaitCharacter

MIN_DOUBLE = 0.05
"""Share of a step on both feet that whoever does not run has at least."""
BOUNCES, MORE = 0.04, 1.25
"""A walk that bounces so much (metres) does so whoever it is: nobody less, and so much more at most."""
CARRIAGE: Final = frozenset({"lean", "head"})
"""What of a bearing words and moods both change."""


@dataclass(frozen=True)
class Walk:
    """Numbers of a gait."""

    bearing: Bearing
    speed: MetresPerSecond
    """On the straight."""
    stride: Ratio
    """Step length against what is usual at that speed."""
    width: Metres
    """Half the distance between the feet where the body stands; in full stride they come nearer."""
    clearance: Metres
    """How high the ball of the foot swings."""
    bounce: Metres
    stamp: Metres
    """How far the body drops onto each foot that comes down."""
    sway: Metres
    hips: Degrees
    """How far the pelvis tips to the side of the leg that swings."""
    swing: Degrees
    """Arm swing to each side of the vertical."""
    twist: Degrees
    """Turn of the hips with each step; the chest turns against it."""
    elbow: Degrees
    splay: ArmLengths
    """How much further from the body hands swing."""
    across: Share
    """Share of arms swinging together from side to side."""
    crouch: Metres
    """How much lower the pelvis is carried."""
    double: Share
    """Share of a step on both feet; negative is flight, as in running."""
    roll: Ratio
    """How far the heel rises behind, against a usual step."""
    strike: Ratio
    """How far the tip of the foot points up as the heel comes down, likewise."""
    scuff: Degrees
    """How far its tip points up all the way, so that the heel scuffs over the floor."""
    tiptoe: Degrees
    """Heel lift of standing feet."""
    drag: Metres
    """How far the right foot, which hardly leaves the floor, stays behind."""
    uneven: Share
    """How much steps differ from each other."""
    wobble: Ratio
    """Size of the stagger of a drunk body."""
    glance: Degrees
    """How far the gaze wanders to the sides."""
    nod: Degrees
    """How far the head sinks and rises again, slowly."""
    tilt: Degrees
    """How far the head lies on its right side, as on a telephone; negative on the left."""
    spin: Turns
    """About itself along the way."""
    skips: bool
    """Whether each foot hops on before the other one lands."""
    aside: Degrees
    """How far from its way the body faces: 90 in stepping sideways, 180 backwards."""
    to_and_fro: bool
    """Whether it turns round on the way, goes back and comes again."""
    veer: Degrees
    """How far it looks to the left (right if negative) while its way curves there."""
    doing: str
    """What the hands do meanwhile: one of `gestures.gesture_names`."""
    stays: Seconds
    """How long it is done on the spot; 0 is a walk."""
    begins: tuple[str, str] = ("hang", "hang")
    """How arms hold what is taken up and looked at before who stands sets out; nothing where they hang."""
    release: bool = False
    """Whether arms come down at the end of the way, where something else begins."""
    character: GaitCharacter = NOBODY
    """Whose walk it is."""

    def in_character(self) -> Walk:
        """The same style as its character walks it, in what both sides have alike."""
        own = self.character
        bearing = replace(self.bearing, lean=self.bearing.lean + own.lean_deg, head=self.bearing.head + own.head_deg)
        return replace(
            self,
            bearing=bearing,
            stride=self.stride * own.stride_ratio,
            clearance=self.clearance * own.clearance_ratio,
            bounce=self.bounce * (own.bounce_ratio if self.bounce < BOUNCES else min(max(own.bounce_ratio, 1.0), MORE)),
            sway=self.sway * own.sway_ratio,
            hips=self.hips * own.hips_ratio,
            twist=self.twist * own.twist_ratio,
            crouch=max(self.crouch + own.crouch_m, 0.0),
            double=max(self.double + own.double_share, MIN_DOUBLE) if self.double > 0 else self.double,
            roll=self.roll * own.roll_ratio,
            strike=self.strike * own.strike_ratio,
        )


def usual_width() -> float:
    """Half the distance between the feet of who walks in no particular mood (metres)."""
    return float(_sheet().emotions[Emotion.NEUTRAL]["width"])


def _sheet() -> StyleSheet:
    return read_style_sheet("walk.toml", Bearing, Walk)


def walk_style(emotion: Emotion, caption: str) -> Walk:
    """The gait that a caption says, in the mood of an emotion."""
    sheet, mood = _sheet(), bearings()[emotion]
    usual, words = sheet.emotions[Emotion.NEUTRAL], sheet.of_caption(caption, emotion)
    # A flight through the air needs its speed: who runs does so in any mood.
    kept = ("speed", "stride", "bounce") if words.get("double", 1.0) < 0 else ()
    moods = {name: value for name, value in sheet.emotions[emotion].items() if name not in kept}
    said = {**usual, **moods, **words}
    for name in sorted(name for name in moods.keys() & words.keys() if isinstance(moods[name], float)):
        said[name] = _both(usual[name], moods[name], words[name], gently=name == "speed")
    for name in CARRIAGE & words.keys():
        usually = getattr(bearings()[Emotion.NEUTRAL], name)
        said[name] = _farther(usually, getattr(mood, name), words[name])
    bearing, gait = carried(mood, said, Walk)
    return Walk(bearing=bearing, **gait)


def style_of(action: Action) -> Walk:
    """The way of walking to where an action is done: as one walks, where it is then done on the spot."""
    style = walk_style(action.emotion, action.caption if action.skill is Skill.LOCO else "walk")
    return walk_style(action.emotion, "walk") if style.stays and action.stands else style


def _both(usual: float, mood: float, words: float, gently: bool) -> float:
    """A number that a mood and words change alike goes as far as either has it; where they change it against each
    other, the mood changes what the words say, or only `gently`: half as much."""
    if (mood - usual) * (words - usual) < 0 < usual:
        return float(words * (mood / usual) ** (0.5 if gently else 1.0))
    return _farther(usual, mood, words)


def _farther(usual: float, mood: float, words: float) -> float:
    """The one of two numbers that is farther from what is usual; the words' where they go the other way."""
    same = (mood - usual) * (words - usual) > 0
    return mood if same and abs(mood - usual) > abs(words - usual) else words
