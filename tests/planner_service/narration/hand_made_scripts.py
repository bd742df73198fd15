"""Long scripts made by hand from beats and keyframes, and any that the shipped short scripts give."""

from __future__ import annotations

from importlib import resources

from motion_backend.motion import Skill
from planner_service.scripts.script import Beat, BeatKind, LongScript, PlannedKeyframe, Retrieved, Room, ShortScript

LIBRARY = tuple(
    ShortScript.model_validate_json(line)
    for line in resources.files("planner_service")
    .joinpath("data/short_scripts.jsonl")
    .read_text(encoding="utf-8")
    .splitlines()
)
BY_ID = {script.id: script for script in LIBRARY}


def beat(text: str, kind: BeatKind = "deed", why: str = "", who: str = "") -> Beat:
    return Beat(text=text, kind=kind, why=why, who=who)


def frame(
    skill: str, caption: str, at: str, of: int | None, mood: str = "neutral", room: Room = "living_room"
) -> PlannedKeyframe:
    return PlannedKeyframe(skill=Skill(skill), caption=caption, furniture=at, beat=of, emotion=mood, room=room)


def made(theme: str, beats: list[Beat], keyframes: list[PlannedKeyframe]) -> LongScript:
    return LongScript(theme=theme, beats=tuple(beats), short_scripts=(), keyframes=tuple(keyframes), method="auto")


def long_script(chosen: list[ShortScript], theme: str = "A person spends a day.") -> LongScript:
    """Short scripts one after the other, with the rising in between that a body needs, and no beats: as matching."""
    keyframes: list[PlannedKeyframe] = []
    for number, script in enumerate(chosen):
        last = keyframes[-1] if keyframes else None
        if last is not None and last.skill in (Skill.SITDOWN, Skill.LIEDOWN):
            skill = Skill.STANDUP if last.skill == Skill.SITDOWN else Skill.GETUP
            keyframes.append(PlannedKeyframe(skill=skill, caption="get up", furniture=last.furniture, room=last.room))
        keyframes += [
            PlannedKeyframe(**k.model_dump(), short_script=number, room=script.room) for k in script.keyframes
        ]
    found = tuple(Retrieved(script=script, beat=number, score=0.5) for number, script in enumerate(chosen))
    return LongScript(theme=theme, beats=(), short_scripts=found, keyframes=tuple(keyframes))


SAD_EVENING = made(
    "An old widower comes home in the evening. He is exhausted. He drinks a glass of wine alone at the table "
    "and remembers his wife. He lies awake until midnight.",
    [
        beat("comes home in the evening"),
        beat("is exhausted", "feeling"),
        beat("drinks a glass of wine alone at the table"),
        beat("remembers his wife", "memory", "it is only thought of"),
        beat("lies awake until midnight"),
    ],
    [
        frame("loco", "walk wearily, dragging the feet", "floor", 0, "tired"),
        frame("loco", "walk wearily, dragging the feet", "floor", 1, "tired"),
        frame("loco", "smoothly forward walk", "dining chair", 2, "sad", "dining_room"),
        frame("sitdown", "drinking from a cup in the right hand", "dining chair", 2, "sad", "dining_room"),
        frame("standup", "stand up slowly", "dining chair", None, "sad", "dining_room"),
        frame("loco", "walk with depression", "bed", 4, "sad", "bedroom"),
        frame("liedown", "lying down, legs straight", "bed", 4, "sad", "bedroom"),
    ],
)
HURRIED_MORNING = made(
    "Lena oversleeps. She jumps out of bed, grabs her clothes from the wardrobe, looks for her keys and runs "
    "to the door. She does not eat breakfast.",
    [
        beat("oversleeps"),
        beat("jumps out of bed"),
        beat("grabs her clothes from the wardrobe"),
        beat("looks for her keys"),
        beat("runs to the door"),
        beat("does not eat breakfast", "undone"),
    ],
    [
        frame("liedown", "lying still", "bed", 0, "tired", "bedroom"),
        frame("getup", "jump up quickly", "bed", 1, "hurried", "bedroom"),
        frame("loco", "rush anxiously forward", "wardrobe", 2, "hurried", "bedroom"),
        frame("touch", "touch medium height with the right hand", "wardrobe", 2, "hurried", "bedroom"),
        frame("loco", "rush anxiously forward", "nightstand", 3, "stressed", "bedroom"),
        frame("touch", "touch low height", "nightstand", 3, "stressed", "bedroom"),
        frame("loco", "walking quickly", "desk", 3, "stressed", "study"),
        frame("touch", "touch medium height", "desk", 3, "stressed", "study"),
        frame("loco", "rush anxiously forward", "floor", 4, "hurried", "study"),
    ],
)
NEGATION = made(
    "He does not sit down. He paces and listens to music.",
    [
        beat("does not sit down", "undone"),
        beat("paces"),
        beat("listens to music"),
    ],
    [
        frame("loco", "pacing back and forth", "floor", 1, "stressed"),
        frame("loco", "smoothly forward walk", "sofa", 2),
        frame("sitdown", "listening to music, both hands at the ears", "sofa", 2, "relaxed"),
    ],
)
MEMORY = made(
    "Tired after missing the bus, Mia lies on the couch and thinks of the exam she failed. She had lost her "
    "umbrella too.",
    [
        beat("missing the bus", "memory", "it is only thought of"),
        beat("Tired", "feeling"),
        beat("lies on the couch"),
        beat("thinks of the exam she failed", "memory", "it is only thought of"),
        beat("had lost her umbrella too", "memory", "it is only thought of"),
    ],
    [
        frame("loco", "walk wearily, dragging the feet", "sofa", 2, "tired"),
        frame("liedown", "hands on belly", "sofa", 2, "tired"),
        frame("getup", "get up slowly", "sofa", None, "tired"),
        frame("loco", "walk with depression", "floor", None, "sad"),
    ],
)
OTHERS = made(
    "Anna reads a book on the sofa. The phone rings and her husband comes in with flowers. She is happy and "
    "dances around the room, then the guests leave and she waters the plants.",
    [
        beat("reads a book on the sofa"),
        beat("The phone rings", "other", "it is not shown", "The phone"),
        beat("her husband comes in with flowers", "other", "it is not shown", "her husband"),
        beat("is happy", "feeling"),
        beat("dances around the room"),
        beat("the guests leave", "other", "it is not shown", "the guests"),
        beat("waters the plants"),
    ],
    [
        frame("loco", "smoothly forward walk", "bookshelf", 0),
        frame("touch", "pick up with the right hand", "bookshelf", 0),
        frame("loco", "smoothly forward walk", "sofa", 0),
        frame("sitdown", "reading, book held in both hands", "sofa", 0),
        frame("standup", "stand up", "sofa", None, "happy"),
        frame("loco", "skip steps running", "floor", 3, "happy"),
        frame("loco", "dancing steps, arms swinging", "floor", 4, "happy"),
        frame("loco", "smoothly forward walk", "plant", 6),
        frame("touch", "touch low height", "plant", 6),
    ],
)
FIRST_PERSON = made(
    "I come home from work. I am angry with my boss. I throw myself on my bed and cry. I call my sister. I "
    "can't sleep.",
    [
        beat("come home from work"),
        beat("am angry with my boss", "feeling"),
        beat("throw myself on my bed and cry"),
        beat("call my sister"),
        beat("can't sleep", "undone"),
    ],
    [
        frame("loco", "angrily walking", "floor", 0, "angry", "bedroom"),
        frame("loco", "stomping heavily", "floor", 1, "angry", "bedroom"),
        frame("loco", "angrily walking", "bed", 2, "angry", "bedroom"),
        frame("liedown", "Lying down with right leg bent and hands covering face", "bed", 2, "sad", "bedroom"),
        frame("getup", "get up", "bed", None, "sad", "bedroom"),
        frame("loco", "walk with depression", "desk chair", 3, "sad", "study"),
        frame("sitdown", "talking on the phone with the left hand", "desk chair", 3, "sad", "study"),
    ],
)
LONG_DAY = made(
    "A young student wakes up. She makes the bed, makes coffee at the coffee machine, and sits down at the "
    "desk. She writes an essay, is frustrated, and walks around the room. She eats an apple, plays the piano, "
    "takes a nap on the sofa and, in the end, is happy and looks out of the window.",
    [
        beat("wakes up"),
        beat("makes the bed"),
        beat("makes coffee at the coffee machine"),
        beat("sits down at the desk"),
        beat("writes an essay"),
        beat("is frustrated", "feeling"),
        beat("walks around the room"),
        beat("eats an apple"),
        beat("plays the piano"),
        beat("takes a nap on the sofa"),
        beat("is happy", "feeling"),
        beat("looks out of the window"),
    ],
    [
        frame("liedown", "lying still", "bed", 0, "neutral", "bedroom"),
        frame("getup", "get up", "bed", 0, "neutral", "bedroom"),
        frame("touch", "touch medium height", "bed", 1, "neutral", "bedroom"),
        frame("loco", "smoothly forward walk", "coffee machine", 2, "neutral", "dining_room"),
        frame("touch", "turn on with the right hand", "coffee machine", 2, "neutral", "dining_room"),
        frame("loco", "steadily walking forward", "desk chair", 3, "neutral", "study"),
        frame("sitdown", "writing at the table, right hand moving", "desk chair", 3, "neutral", "study"),
        frame("standup", "stand up quickly", "desk chair", None, "stressed", "study"),
        frame("loco", "pacing back and forth", "floor", 5, "stressed", "study"),
        frame("loco", "angrily walking", "floor", 6, "stressed", "study"),
        frame("loco", "smoothly forward walk", "dining chair", 7, "neutral", "dining_room"),
        frame("sitdown", "eating at the table, right hand to the mouth", "dining chair", 7, "neutral", "dining_room"),
        frame("standup", "stand up", "dining chair", None, "neutral", "dining_room"),
        frame("loco", "smoothly forward walk", "piano bench", 8),
        frame("sitdown", "playing the piano, both hands on the keys", "piano bench", 8, "relaxed"),
        frame("standup", "stand up", "piano bench", None),
        frame("loco", "shuffling sleepily forward", "sofa", 9, "tired"),
        frame("liedown", "curled up on the left side, knees drawn up", "sofa", 9, "tired"),
        frame("getup", "get up", "sofa", None, "happy"),
        frame("loco", "excited walk", "floor", 10, "happy"),
        frame("loco", "excited walk", "window", 11, "happy"),
        frame("touch", "touch medium height", "window", 11, "happy"),
    ],
)
HAND_MADE = (SAD_EVENING, HURRIED_MORNING, NEGATION, MEMORY, OTHERS, FIRST_PERSON, LONG_DAY)
