"""What keyframes do, worded: each becomes a verb phrase, and phrases become sentences tied to their keyframes.

How a story words what a body does: every caption of the library as phrases, and a mood's words for any other.

Phrases start with a verb in its base form; further verbs are marked with ~. Blanks: {to} "to the sofa", {about} "around
the bedroom", {back} "up and down in the bedroom", {on} "on the sofa" or "in the armchair", {onto}, {the} "the sofa",
{hand} "a hand", and the pronouns of `Voice.fill`.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from motion_backend.motion import Skill
from planner_service.narration.narrative_voice import Voice
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.script import Keyframe, PlannedKeyframe
from planner_service.themes.lexicon import gerund, past
from scene_graphs.furniture import class_of, display_name


class Walk(NamedTuple):
    """Ways to word one way of walking."""

    to: tuple[str, ...]
    """Towards a piece of furniture."""
    about: tuple[str, ...]
    """With no goal but the room."""


WALKS: Final[dict[str, Walk]] = {
    "smoothly forward walk": Walk(
        ("walk {to}", "cross to {the}", "go {to}"), ("walk {about}", "stroll {about}", "take a few easy steps {about}")
    ),
    "steadily walking forward": Walk(("walk steadily {to}", "make {their} way {to}"), ("walk steadily {about}",)),
    "sidestepping": Walk(("sidestep {to}", "edge sideways {to}"), ("sidestep {about}",)),
    "walk with knees bent": Walk(("walk with bent knees {to}", "creep {to}"), ("walk with bent knees {about}",)),
    "skip steps running": Walk(
        ("skip {to}", "bound {to}"), ("skip {about}", "bounce {about}", "skip and ~hop {about}")
    ),
    "walk while talking on the phone with the left hand": Walk(
        ("walk with the phone at {their} left ear {to}",), ("wander {about}, the phone at {their} left ear",)
    ),
    "walk while talking on the phone with the right hand": Walk(
        ("walk with the phone at {their} right ear {to}",), ("wander {about}, the phone pressed to {their} right ear",)
    ),
    "walk with the body leaning back": Walk(
        ("sway {to}, leaning back as if against a wind", "walk {to}, leaning far back"),
        ("sway {about}, leaning far back", "wander {about}, leaning back at every step"),
    ),
    "walk on tiptoes": Walk(("tiptoe {to}", "steal {to} on tiptoe"), ("tiptoe {about}", "steal {about} on tiptoe")),
    "tap chest lightly with both hands": Walk(
        ("walk {to}, tapping {their} chest with both hands",), ("walk {about}, tapping {their} chest with both hands",)
    ),
    "run and spin": Walk(("whirl {to}",), ("run and ~spin {about}", "twirl {about}", "run {about}, spinning")),
    "uplifted head walking": Walk(("walk {to}, head held high",), ("walk {about}, head held high",)),
    "walk like an old person": Walk(
        ("shuffle {to} as if fifty years older", "hobble {to}"), ("hobble {about}", "shuffle {about} like an old soul")
    ),
    "rush anxiously forward": Walk(
        ("rush {to}", "hurry {to}", "dash {to}", "run {to}"), ("rush {about}", "dash {about}", "hurry {about}")
    ),
    "walking slowly, hands behind back": Walk(
        ("walk slowly {to}, hands behind {their} back", "stroll {to}, hands clasped behind {their} back"),
        ("walk slowly {about}, hands behind {their} back", "stroll {about}, hands clasped behind {their} back"),
    ),
    "walk with depression": Walk(
        ("trudge {to}", "drift with hanging shoulders {to}", "walk listlessly {to}"),
        ("trudge {about}", "drift aimlessly {about}", "wander {about} without a goal"),
    ),
    "head bowed and body bent while walking": Walk(
        ("plod {to}, bent and silent", "move {to}, head down", "walk with lowered eyes {to}"),
        ("walk with lowered eyes {about}", "plod {about}, bent and silent"),
    ),
    "walking drunkenly": Walk(
        ("stagger {to}", "stumble {to}", "weave {to}", "lurch {to}"),
        ("stagger {about}", "reel {about}", "stumble {about}", "weave {about}"),
    ),
    "angrily walking": Walk(("storm {to}", "march angrily {to}"), ("storm {about}", "stalk {about}")),
    "walk with arms crossed over chest": Walk(
        ("walk with crossed arms {to}",), ("walk with crossed arms {about}", "circle {about}, arms crossed")
    ),
    "excited walk": Walk(("bounce {to}", "bustle {to}"), ("bounce {about}", "bustle {about} in excitement")),
    "walk with large steps": Walk(("stride {to}", "take long steps {to}"), ("stride {about}",)),
    "run with open arms": Walk(("run with open arms {to}",), ("run {about}, arms wide open", "fly {about}, arms out")),
    "walking with hands placed on the hips": Walk(
        ("walk {to}, hands on {their} hips",), ("walk {about}, hands on {their} hips",)
    ),
    "walk excitedly with arms opened": Walk(
        ("walk with open arms {to}", "sail {to}, arms spread"), ("walk with open arms {about}",)
    ),
    "walk wearily, dragging the feet": Walk(
        ("drag {their} feet {to}", "plod {to}", "trail {to}"), ("drag {their} feet {about}", "plod {about}")
    ),
    "pacing back and forth": Walk(("hurry nervously {to}",), ("pace {back}", "walk {back}")),
    "stomping heavily": Walk(("stomp {to}", "stamp {to}"), ("stomp {about}", "stamp {about}")),
    "dancing steps, arms swinging": Walk(("dance {to}", "waltz {to}"), ("dance {about}", "waltz {about}")),
    "strolling with hands in pockets": Walk(
        ("stroll {to}", "amble {to}, hands in {their} pockets"), ("stroll {about}, hands in {their} pockets",)
    ),
    "walking quickly": Walk(("walk quickly {to}", "hasten {to}"), ("walk quickly {about}", "bustle {about}")),
    "shuffling sleepily forward": Walk(("shuffle {to}", "stumble sleepily {to}"), ("shuffle {about}",)),
    "walking with the arms wrapped around the body": Walk(
        ("walk {to}, arms wrapped tightly around {themself}",),
        ("wander {about}, arms wrapped tightly around {themself}",),
    ),
    "walking carefully, arms out for balance": Walk(
        ("feel {their} way {to}", "step carefully {to}"), ("feel {their} way {about}",)
    ),
    "marching with swinging arms": Walk(("march {to}",), ("march {about}",)),
    "walk to the front left": Walk(
        ("bear left and ~walk {to}", "turn half left and ~walk {to}"),
        ("take a few steps to the left", "wander off to the left"),
    ),
    "walk to the front right": Walk(
        ("bear right and ~walk {to}", "turn half right and ~walk {to}"),
        ("take a few steps to the right", "wander off to the right"),
    ),
    "stand still": Walk(
        ("stop and ~stand still before {the}",), ("stand still for a moment", "stop and ~stand there, quite still")
    ),
    "wave with the right hand": Walk(
        ("wave {their} right hand and ~go {to}",), ("wave {their} right hand", "raise {their} right hand and ~wave")
    ),
}

WALKS_IN_MOOD: Final[dict[str, Walk]] = {
    "neutral": Walk(("walk {to}", "go {to}", "cross to {the}"), ("walk {about}",)),
    "happy": Walk(("bounce {to}", "hop {to}"), ("bounce {about}", "skip {about}")),
    "angry": Walk(("stomp {to}", "storm {to}"), ("storm {about}",)),
    "hurried": Walk(("hurry {to}", "rush {to}"), ("rush {about}",)),
    "tired": Walk(("plod {to}", "shuffle {to}"), ("drag {their} feet {about}",)),
    "sad": Walk(("trudge {to}", "walk slowly {to}"), ("drift {about}",)),
    "stressed": Walk(("walk tensely {to}", "hurry {to}"), ("pace {back}",)),
    "drunk": Walk(("stagger {to}", "stumble {to}"), ("reel {about}",)),
    "relaxed": Walk(("stroll {to}", "amble {to}"), ("stroll {about}",)),
}

SITS_IN_MOOD: Final[dict[str, tuple[str, ...]]] = {
    "neutral": ("sit down {on}", "take a seat {on}"),
    "happy": ("plop down {on}", "drop happily {onto}", "sit down {on}"),
    "angry": ("sit down hard {on}", "drop {onto}", "sit down stiffly {on}"),
    "hurried": ("perch {on}", "sit down {on} for a moment"),
    "tired": ("sink {onto}", "slump down {onto}", "let {themself} fall {onto}"),
    "sad": ("sink down {onto}", "sit down wearily {on}", "sink slowly {onto}"),
    "stressed": ("sit down uneasily {on}", "sit down {on}"),
    "drunk": ("slump {onto}", "flop down {on}", "drop {onto}"),
    "relaxed": ("settle down {on}", "settle comfortably {on}", "sit back {on}"),
}

SITS: Final[dict[str, tuple[str, ...]]] = {
    "arms loosely, legs open": ("arms loose and legs apart",),
    "hands behind head, cross-legged, lean back": ("leaning back with crossed legs, hands behind {their} head",),
    "hands support on seat, legs straight": ("propped on both hands, legs straight out",),
    "legs straight, hands support body": ("legs straight, leaning on both hands",),
    "hands on thighs": ("both hands on {their} thighs",),
    "arms crossed, straight legs, feet crossed": ("arms and feet crossed",),
    "sit upright with hands on thighs": ("upright, hands on {their} thighs",),
    "hands behind head, lean back, cross-legged": ("leaning back cross-legged, hands behind {their} head",),
    "hands behind head, lean back, feet crossed": ("leaning back, hands behind {their} head and feet crossed",),
    "hands behind head, legs straight": ("{their} hands behind {their} head and legs stretched out",),
    "hands holding head, legs extended": ("holding {their} head in both hands",),
    "crossing arms": ("arms crossed", "arms folded"),
    "right leg held, left leg stretched out": ("hugging {their} right knee, the left leg stretched out",),
    "left leg straightened": ("one leg stretched out",),
    "sitting upright, hands placed on thighs": ("very upright, hands on {their} thighs",),
    "legs extended, hands on floor for support": ("legs stretched out, leaning on both hands",),
    "leaning back, legs straight, hands supporting head": ("leaning back, hands supporting {their} head",),
    "Resting hands on the armrests, legs spread apart": ("{their} hands on the armrests",),
    "sitting with head bowed, hands resting on thighs": (
        "head bowed low, hands on {their} thighs",
        "head bowed, hands in {their} lap",
    ),
    "lying back in chair, arms relaxed at sides": ("leaning far back, arms slack at {their} sides",),
    "supporting head with hands, head bowed": ("{their} head in {their} hands", "face buried in {their} hands"),
    "leaning forward, elbows on knees": ("leaning forward, elbows on {their} knees",),
    "right hand on chin, thinking": ("chin in hand", "a hand at {their} chin"),
    "reading, book held in both hands": ("the book open in both hands", "a book in both hands"),
    "sitting upright, phone at the right ear": ("the phone at {their} ear",),
    "cross-legged, hands on knees": ("cross-legged, hands on {their} knees",),
    "leaning forward, forearms on the table": ("leaning forward on {their} forearms",),
    "writing at the table, right hand moving": (
        ", then ~write line after line",
        ", then ~take a pen in {their} right hand and ~write",
    ),
    "typing, both hands on the keyboard": (", then ~type with both hands", "both hands on the keyboard"),
    "playing a game, controller held in both hands": (
        ", then ~play a game, the controller in both hands",
        "the controller in both hands",
    ),
    "drinking from a cup in the right hand": (
        ", then ~sip from the cup in {their} right hand",
        "a cup in {their} right hand",
    ),
    "eating at the table, right hand to the mouth": (
        ", then ~eat slowly with {their} right hand",
        ", then ~eat a little",
    ),
    "listening to music, both hands at the ears": (
        ", then ~listen to music with both hands at {their} ears",
        ", then ~listen to music, both hands at {their} ears",
    ),
    "playing the piano, both hands on the keys": (
        ", then ~play the piano with both hands",
        "both hands on the piano keys",
    ),
    "talking on the phone with the left hand": (
        ", then ~talk on the phone in {their} left hand",
        "the phone at {their} left ear",
    ),
    "sitting still": ("keeping quite still", "without stirring"),
}

LIES_IN_MOOD: Final[dict[str, tuple[str, ...]]] = {
    "neutral": ("lie down {on}",),
    "happy": ("stretch out {on}", "flop down {on}"),
    "angry": ("throw {themself} {onto}", "lie down {on}"),
    "hurried": ("lie down {on}",),
    "tired": ("lie down {on}", "collapse {onto}", "sink {onto}"),
    "sad": ("lie down {on}", "lie down wearily {on}"),
    "stressed": ("lie down {on}", "lie stiffly {on}"),
    "drunk": ("fall {onto}", "topple {onto}"),
    "relaxed": ("stretch out {on}", "lie back {on}", "lie down {on}"),
}

LIES: Final[dict[str, tuple[str, ...]]] = {
    "left leg bent": ("{their} left leg bent",),
    "right leg bent": ("{their} right leg bent",),
    "side-lie on left, legs bent": ("on {their} left side, knees bent",),
    "side-lie on left, legs crossed": ("on {their} left side with crossed legs",),
    "side lie on left, right hand on belly": ("on {their} left side, one hand on {their} belly",),
    "side-lie on right": ("on {their} right side",),
    "elbows supporting body, left leg bent": ("propped up on {their} elbows, one knee bent",),
    "hands on belly": ("both hands on {their} belly",),
    "side-lying on right, legs bent": ("on {their} right side, knees drawn up",),
    "hands on belly, left leg bent": ("hands on {their} belly and one knee bent",),
    "hands on belly, right leg bent": ("one knee bent, hands on {their} belly",),
    "side lying on left with hands on belly": ("on {their} left side, hands on {their} belly",),
    "Lying down with right leg bent and hands covering face": ("both hands over {their} face",),
    "lying down, legs straight": ("{their} legs stretched out", "flat on {their} back"),
    "Lie down with legs crossed and right arm supporting the head": ("legs crossed, an arm under {their} head",),
    "lying flat with hands over belly and knees bent": ("on {their} back with bent knees, hands over {their} belly",),
    "lying, left foot on the floor": ("one foot on the floor",),
    "Legs are bent while lying flat": ("flat on {their} back with bent knees",),
    "lying with hands under head, legs crossed": ("legs crossed, hands under {their} head",),
    "lying on the back, arms spread wide": ("on {their} back, arms spread wide",),
    "curled up on the left side, knees drawn up": ("curled up, knees to {their} chest",),
    "lying still": ("keeping quite still", "without stirring"),
    "reading on the back, book held above the chest": (
        ", then ~read, the book held above {their} chest",
        "on {their} back, a book held above {their} chest",
    ),
}

RISES: Final[dict[str, tuple[str, ...]]] = {
    "neutral": ("get up", "stand up", "rise"),
    "slow": ("get slowly to {their} feet", "rise slowly", "get up slowly"),
    "fast": ("jump up", "spring to {their} feet", "leap up"),
}

TOUCHES: Final[dict[str, tuple[str, ...]]] = {
    "low": ("bend down to {the}", "stoop to {the}", "reach down beside {the}"),
    "prone": ("crouch and ~reach far under {the}",),
    "medium": ("lay {hand} on {the}", "put {hand} on {the}", "touch {the}", "reach over to {the}"),
    "high": ("reach high up at {the}", "stretch to the top of {the}"),
}
TOUCHES_AT: Final[dict[tuple[str, str], tuple[str, ...]]] = {
    ("bed", "low"): ("bend down and ~reach under {the}", "feel about beneath {the}"),
    ("bed", "prone"): ("crouch down and ~feel about under {the}",),
    ("bed", "medium"): ("smooth {the} with {hand}", "run {hand} over {the}", "lay {hand} on {the}"),
    ("closet", "low"): ("bend down to the lowest drawer of {the}", "stoop to the lowest shelf of {the}"),
    ("closet", "medium"): ("open {the}", "reach into {the}", "put {hand} on the door of {the}", "look into {the}"),
    ("closet", "high"): ("reach for the top shelf of {the}", "stretch up to the highest shelf of {the}"),
    ("shelf", "low"): ("stoop to the lowest row of {the}",),
    ("shelf", "medium"): ("run {hand} along {the}", "reach into {the}", "lay {hand} on {the}"),
    ("shelf", "high"): ("reach up to the top row of {the}", "stretch to the very top of {the}"),
    ("table", "low"): ("bend down to {the}", "bend over {the}", "stoop to {the}"),
    ("table", "medium"): (
        "lay {hand} on {the}",
        "reach across {the}",
        "lean {hand} on {the}",
        "rest {hand} on {the}",
        "run {hand} along the edge of {the}",
        "stop at {the}",
    ),
    ("side", "medium"): ("lay {hand} on {the}", "reach over to {the}", "rest {hand} on {the}", "put {hand} on {the}"),
    ("side", "low"): ("bend down to {the}", "pull open the drawer of {the}"),
    ("media", "low"): ("bend down to {the}", "crouch before {the}"),
    ("media", "medium"): ("lay {hand} on {the}", "lean over {the}", "stop before {the}"),
    ("sofa", "low"): ("reach down between the cushions of {the}", "feel along the bottom of {the}"),
    ("sofa", "medium"): ("pat {the} with {hand}", "run {hand} over {the}"),
    ("light", "medium"): ("touch {the}", "reach out for {the}"),
}
"""By class of furniture and height, where the general wording would be pale."""
TOUCHES_DOING: Final[dict[str, tuple[str, ...]]] = {
    "pick up with the right hand": ("pick something up from {the} with {hand}", "take something from {the} in {hand}"),
    "pick up with the left hand": ("pick something up from {the} with {hand}", "take something from {the} in {hand}"),
    "put down with the right hand": ("put down on {the} what {they} held in {hand}", "set something down on {the}"),
    "put down with the left hand": ("put down on {the} what {they} held in {hand}", "set something down on {the}"),
    "turn on with the right hand": ("reach for the switch at {the} with {hand}", "press a switch at {the} with {hand}"),
    "wash with both hands": ("wash {the} with both hands", "scrub {the} with both hands"),
    "rotate with the right hand": ("turn something round on {the} with {hand}",),
}
"""By caption, where it says what is done."""


Piece = tuple[str, tuple[int, ...]]
"""Words and the keyframes they tell, none for connecting words."""
Places = Mapping[int, tuple[str, str]]
"""Index of a keyframe to how its furniture and its room are called in the home it is acted out in."""
_IN = ("armchair", "lounge chair", "lazy sofa", "rocking chair")
_DEEP = (*_IN, "chair")
"""What one sits on but drops into."""
_CONTENT = re.compile(r"(?<!\{)\b(?:\w{4,}|lay|put|run|lie|sit)\b(?!\})")
_VERB = re.compile(r"(?:^|~)(\w+)")
_MANNER = re.compile(r"\{\w+\}|\b(?:both|their|with|over|about|from|into|then|without)\b|^\w+")
"""What is left out of a template to find the words for the manner in which something is done."""
_RISES = (Skill.STANDUP, Skill.GETUP)
_MAX_MOMENT_WORDS = 24
"""Words of a sentence after which no more is added to it."""
_FURTHER = ("to and fro", "from wall to wall", "this way and that", "from one end to the other")
"""Where a walk with no goal goes after another one."""
_IDLE_WALKS = (
    "smoothly forward walk", "steadily walking forward", "walking slowly, hands behind back", "walking quickly",
    "strolling with hands in pockets", "walk with the body leaning back", "head bowed and body bent while walking",
)  # fmt: skip
_NEUTRAL_WALKS = ("smoothly forward walk", "steadily walking forward")


@dataclass(frozen=True)
class Phrase:
    """A verb phrase without its subject and the keyframes it tells."""

    base: str
    """With verbs in their base form, further ones marked: "bend down and ~reach under the bed"."""
    keyframes: tuple[int, ...]
    mood: str = "neutral"
    rises: bool = False
    anew: bool = False
    """Begins a sentence: a rising that is not told comes before it."""
    arrives: bool = False
    """A walk whose purpose follows in the next phrase: the two stay in one sentence."""
    skill: Skill = Skill.LOCO
    at: str = ""
    """What it is done at, "the sofa"; empty on the floor."""

    @cached_property
    def bare(self) -> str:
        """ "sit down on the sofa with bowed head"."""
        return self.base.replace("~", "")

    @cached_property
    def text(self) -> str:
        """In the past: "sat down on the sofa with bowed head"."""
        return _VERB.sub(lambda verb: past(verb[1]), self.base)

    @cached_property
    def gerund(self) -> str:
        """ "sitting down on the sofa with bowed head"."""
        return _VERB.sub(lambda verb: gerund(verb[1]), self.base)


class Variety:
    """Chooses among ways to say a thing: the least used so far, ties by the seed."""

    def __init__(self, *seeds: int) -> None:
        self._rng = np.random.default_rng(seeds)
        self._used: Counter[str] = Counter()

    def pick(self, options: Sequence[str]) -> str:
        """One of the options; it counts as used."""
        fewest = min(self._used[option] for option in options)
        fresh = [option for option in options if self._used[option] == fewest]
        chosen = fresh[int(self._rng.integers(len(fresh)))]
        self._used[chosen] += 1
        return chosen

    def index(self, count: int) -> int:
        """A number below `count`."""
        return int(self._rng.integers(count))

    def chance(self, share: float) -> bool:
        """True in that share of cases."""
        return bool(self._rng.random() < share)


class Wording:
    """Words one story's keyframes, remembering where the body is so that "it" can stand for the furniture."""

    def __init__(self, voice: Voice, variety: Variety, places: Places, brief: bool = False) -> None:
        self.voice = voice
        self.brief = brief
        """Whether to leave out how the body walks and rests where that says little."""
        self.variety = variety
        self.places = places
        self.say_room = True
        """Whether the room may be called by its name; not where it was already."""
        self._at: str | None = None
        self._said: str | None = None  # what "it" stands for
        self._wandering = False
        self.doing: frozenset[str] = frozenset()
        """Verbs that the scene's events tell, so that no posture need to."""
        self._manners: list[frozenset[str]] = []
        self._recent: tuple[str, ...] = ()  # the templates of the two phrases before

    def phrases(self, keyframes: Iterable[tuple[int, PlannedKeyframe]], risen: bool = False) -> list[Phrase]:
        """Keyframes of one event as phrases in order; every index is in exactly one of them.

        Where the body has just `risen`, the way to what it does next is told.
        """
        rows = list(keyframes)
        self._wandering, self._said = False, None
        told: list[Phrase] = []
        untold: tuple[int, ...] = ()
        for position, (index, keyframe) in enumerate(rows):
            before = rows[position - 1][1] if position else None
            following = rows[position + 1][1] if position + 1 < len(rows) else None
            arrives = keyframe.skill == Skill.LOCO and _goes_on(keyframe, following)
            if arrives and (self._is_here(index, keyframe) or (not risen and self._is_plain(keyframe))):
                untold = (*untold, index)
                continue
            if following is not None and self._goes_without_saying(
                before, keyframe, [row[1] for row in rows[position + 1 :]]
            ):
                untold = (*untold, index)
                continue
            text = self._text(index, keyframe)
            rises = keyframe.skill in _RISES
            at = "" if keyframe.on_floor else self._the(index, keyframe)
            anew = any(rows[i][1].skill in _RISES for i in range(position) if rows[i][0] in untold)
            told.append(Phrase(text, (*untold, index), mood_of(keyframe), rises, anew, arrives, keyframe.skill, at))
            untold, risen = (), rises
        return told

    def _is_plain(self, keyframe: Keyframe) -> bool:
        """Whether walking there goes without saying."""
        return self.variety.chance(0.5 + 0.5 * self.brief if keyframe.caption in _NEUTRAL_WALKS else 0.3)

    def _goes_without_saying(self, before: Keyframe | None, keyframe: Keyframe, following: Sequence[Keyframe]) -> bool:
        """Whether a keyframe says little: strolling about between two things done, or rising to rest there again."""
        if keyframe.skill in _RISES:
            after = following[1] if len(following) > 1 and _goes_on(following[0], following[1]) else following[0]
            rests = after.skill in (Skill.SITDOWN, Skill.LIEDOWN)
            return rests and before is not None and keyframe.piece == after.piece
        idle = keyframe.skill == Skill.LOCO and keyframe.on_floor and keyframe.caption in _IDLE_WALKS
        return idle and before is not None and self.variety.chance(0.6)

    def _is_here(self, index: int, keyframe: Keyframe) -> bool:
        return not keyframe.on_floor and self._at == self._the(index, keyframe)

    def _text(self, index: int, keyframe: PlannedKeyframe) -> str:
        mood = mood_of(keyframe)
        match keyframe.skill:
            case Skill.LOCO:
                template = self._fresh(self._walks(keyframe, mood))
                self._note(template)
            case Skill.SITDOWN:
                template = self._posture(keyframe, SITS_IN_MOOD[mood], SITS)
            case Skill.LIEDOWN:
                template = self._posture(keyframe, LIES_IN_MOOD[mood], LIES)
            case Skill.TOUCH:
                template = self._fresh(touches(keyframe))
            case _:
                pace = re.search(r"slow|weari", keyframe.caption) and "slow"
                pace = pace or (re.search(r"quick|abrupt|jump", keyframe.caption) and "fast") or "neutral"
                template = self.variety.pick(RISES[pace])
        self._recent = (*self._recent[-1:], template)
        filled = self._fill(template, index, keyframe)
        self._wandering = keyframe.skill == Skill.LOCO and keyframe.on_floor
        self._at = self._said = None if keyframe.on_floor else self._the(index, keyframe)
        return " ".join(filled.split()).replace(" ,", ",")

    def _walks(self, keyframe: Keyframe, mood: str) -> tuple[str, ...]:
        walk = WALKS.get(keyframe.caption, WALKS_IN_MOOD[mood])
        plain = WALKS_IN_MOOD[mood]
        ways, others = (walk.about, plain.about) if keyframe.on_floor else (walk.to, plain.to)
        ways = self._unheard(ways) or self._unheard(others) or others
        short = tuple(way for way in ways if "," not in way)
        return short if self.brief and short else ways

    def _unheard(self, templates: Sequence[str]) -> tuple[str, ...]:
        """Those whose manner no phrase of the story had."""
        return tuple(template for template in templates if not self._repeats(_manner_of(template)))

    def _repeats(self, manner: frozenset[str]) -> bool:
        return bool(manner) and any(len(manner & had) >= min(2, len(manner), len(had)) for had in self._manners)

    def _posture(self, keyframe: Keyframe, verbs: tuple[str, ...], manners: Mapping[str, tuple[str, ...]]) -> str:
        known = [
            way for way in self._unheard(manners.get(keyframe.caption, ())) if not self.doing & set(_VERB.findall(way))
        ]
        manner = self.variety.pick(known) if known and self.variety.chance(0.45 if self.brief else 0.65) else ""
        comma = "" if manner.startswith(("with ", "on ", "flat ", ",")) or not manner else ","
        self._note(manner)
        return f"{self._fresh(verbs)}{comma} {manner}"

    def _note(self, template: str) -> None:
        if manner := _manner_of(template):
            self._manners.append(manner)

    def _fresh(self, options: Sequence[str]) -> str:
        """One of the options, if possible none with a word of the two phrases before it."""
        heard = {word for template in self._recent for word in _CONTENT.findall(template)}
        shared = [len(heard.intersection(_CONTENT.findall(option))) for option in options]
        return self.variety.pick(
            [option for option, count in zip(options, shared, strict=True) if count == min(shared)]
        )

    def _fill(self, template: str, index: int, keyframe: PlannedKeyframe) -> str:
        the = self._the(index, keyframe)
        here = not keyframe.on_floor and self._said == the
        inside = the.endswith(_IN)
        name = "it" if here else the
        if here and re.search(r"\b(?:down|out|back|seat|comfortably)\b", template.split("{on}")[0]):
            template = template.replace(" {on}", "")
        if here:
            template = re.sub(r"the (\w+(?: \w+)?) of \{the\}", r"its \1", template)
        hand = _hand(keyframe.caption, self.voice)
        if hand == "a hand":
            template = template.replace(" with {hand}", "")
        room = self._room(index, keyframe)
        ways = _FURTHER if self._wandering else (f"around {room}", f"about {room}", f"through {room}")
        return self.voice.fill(
            template,
            the=name,
            on=f"{'in' if inside else 'on'} {name}",
            onto=f"{'into' if the.endswith(_DEEP) else 'onto'} {name}",
            to=f"{self.variety.pick(('to', 'over to', 'across to'))} {the}" if "{to}" in template else "",
            about=self.variety.pick(ways) if "{about}" in template else "",
            back=self.variety.pick(("up and down", "back and forth")) + f" in {room}" if "{back}" in template else "",
            hand=hand,
        )

    def _the(self, index: int, keyframe: Keyframe) -> str:
        if keyframe.on_floor:
            return "the floor"
        word, instance = keyframe.piece
        name = self.places[index][0] if index in self.places else display_name(word)
        return f"the {'other ' if instance > 1 else ''}{name.removeprefix('the ')}"

    def room_of(self, index: int, keyframe: PlannedKeyframe) -> str:
        """How the keyframe's room is called, "room" where it has none."""
        room = self.places[index][1] if index in self.places else (keyframe.room or "room")
        return room.replace("_", " ").lower().removeprefix("the ")

    def _room(self, index: int, keyframe: PlannedKeyframe) -> str:
        name = self.room_of(index, keyframe)
        chosen = self.variety.pick((name, "room")) if self.say_room else "room"
        self.say_room = self.say_room and chosen != name
        return f"the {chosen}"


def mood_of(keyframe: Keyframe) -> str:
    """The one emotion of a keyframe's words, neutral when they name none."""
    if keyframe.emotion.lower().startswith("neutral"):
        return "neutral"
    return emotion_of(keyframe.emotion) or "neutral"


def touches(keyframe: Keyframe) -> tuple[str, ...]:
    """Ways to word a touch: by what its caption says is done, else by its height and what is touched."""
    if keyframe.caption in TOUCHES_DOING:
        return TOUCHES_DOING[keyframe.caption]
    caption = keyframe.caption.lower()
    height = next((h for h in ("prone", "low", "high") if re.search(rf"\b{h}\b", caption)), "medium")
    return TOUCHES_AT.get((class_of(keyframe.piece[0]), height)) or TOUCHES[height]


def joined(told: Sequence[Phrase]) -> list[Piece]:
    """Phrases as one predicate, piece by piece: "stood up, crossed to the bed, and lay down"."""
    pieces: list[Piece] = []
    for position, phrase in enumerate(told):
        last = position == len(told) - 1
        if position and last:
            crowded = len(told) > 2 or "," in told[0].text
            pieces.append((", and " if crowded else " and ", ()))
        elif position:
            pieces.append((", ", ()))
        pieces.append((phrase.text, phrase.keyframes))
    return pieces


def sentences_of(told: Sequence[Phrase], variety: Variety) -> list[tuple[Phrase, ...]]:
    """Two to four phrases a sentence: a walk stays with its purpose, rising and a change of mood start a new one."""
    groups: list[list[Phrase]] = []
    most = 3
    for phrase, following in zip(told, [*told[1:], None], strict=True):
        current = groups[-1] if groups else []
        tied = bool(current) and (current[-1].arrives or current[-1].rises)
        purpose = [following] if phrase.arrives and following is not None else []
        words = sum(len(p.text.split()) for p in [*current, phrase, *purpose])
        room = 0 < len(current) < most and words <= _MAX_MOMENT_WORDS and not (phrase.rises or phrase.anew)
        turns = len(current) >= 2 and (phrase.arrives or phrase.mood != current[-1].mood)
        if tied or (room and not turns):
            current.append(phrase)
        else:
            groups.append([phrase])
            most = 2 + variety.index(3)
    return [tuple(group) for group in groups]


def _goes_on(walk: Keyframe, following: Keyframe | None) -> bool:
    """Whether what follows is done at the piece this walk leads to."""
    return (
        following is not None
        and following.skill in (Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH)
        and not walk.on_floor
        and walk.piece == following.piece
    )


def _manner_of(template: str) -> frozenset[str]:
    """The words of a template that say in which manner, none where it tells of two deeds."""
    told = "" if "~" in template else _MANNER.sub(" ", template)
    return frozenset(re.findall(r"[a-z]{4,}", told))


def without_room(told: Sequence[Phrase], room: str, named: bool) -> tuple[Phrase, ...]:
    """The phrases of one sentence with the room said once, or not at all where it is `named` besides."""
    phrases_: list[Phrase] = []
    here = re.compile(rf" (around|about|through|in) the (?:room|{re.escape(room)})\b")
    for phrase in told:
        base = phrase.base
        if named:
            base = here.sub(
                lambda way: "" if way[1] == "in" else " about" if way[1] == "through" else f" {way[1]}", base
            )
        named = named or bool(here.search(base))
        phrases_.append(replace(phrase, base=base))
    return tuple(phrases_)


def _hand(caption: str, voice: Voice) -> str:
    side = re.search(r"\b(left|right)\b", caption)
    return f"{voice['their']} {side[1]} hand" if side else "a hand"
