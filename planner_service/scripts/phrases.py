"""How a story words what a body does: every caption of the library as phrases, and a mood's words for any other.

Phrases start with a verb in its base form; further verbs are marked with ~. Blanks: {to} "to the sofa", {about} "around
the bedroom", {back} "up and down in the bedroom", {on} "on the sofa" or "in the armchair", {onto}, {the} "the sofa",
{hand} "a hand", and the pronouns of `Voice.fill`.
"""

from __future__ import annotations

from typing import Final, NamedTuple


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
