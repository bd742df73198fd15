"""The short scripts and captions that ship with the service."""

from __future__ import annotations

import json
import re
from collections import Counter
from importlib import resources
from itertools import pairwise, product

import numpy as np
from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Skill
from planner_service.composition.deed_table import captions_of_gestures
from planner_service.narration.narrative_voice import tells_of_one
from planner_service.scripts.script import EMOTIONS, ShortScript
from planner_service.scripts.script_repair import check, repair
from scene_graphs.furniture import (
    ROOM_TYPES,
    affordances,
    categories_of,
    class_of,
    group_of,
    is_known,
)
from scene_graphs.layout_library import built_in_layouts

DATA = resources.files("planner_service").joinpath("data")
SCRIPTS = tuple(
    ShortScript.model_validate_json(line)
    for line in DATA.joinpath("short_scripts.jsonl").read_text(encoding="utf-8").splitlines()
)
CAPTIONS: dict[str, list[str]] = json.loads(DATA.joinpath("captions.json").read_text(encoding="utf-8"))
NEEDS = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie", Skill.TOUCH: "touch"}
SIT_CAPTIONS_OF_THE_PAPER = {
    "arms loosely, legs open",
    "hands behind head, cross-legged, lean back",
    "hands support on seat, legs straight",
    "legs straight, hands support body",
    "hands on thighs",
    "arms crossed, straight legs, feet crossed",
    "sit upright with hands on thighs",
    "hands behind head, lean back, cross-legged",
    "hands behind head, lean back, feet crossed",
    "hands behind head, legs straight",
}
LIE_CAPTIONS_OF_THE_PAPER = {
    "left leg bent",
    "side-lie on left, legs bent",
    "side-lie on left, legs crossed",
    "side lie on left, right hand on belly",
    "right leg bent",
    "side-lie on right",
    "elbows supporting body, left leg bent",
    "hands on belly",
    "side-lying on right, legs bent",
    "hands on belly, left leg bent",
    "hands on belly, right leg bent",
    "side lying on left with hands on belly",
}
WALK_CAPTIONS_OF_THE_PAPER = {
    "walk with knees bent",
    "skip steps running",
    "walk while talking on the phone with the left hand",
    "walk with the body leaning back",
    "walk on tiptoes",
    "tap chest lightly with both hands",
    "run and spin",
    "uplifted head walking",
    "walk while talking on the phone with the right hand",
    "walk like an old person",
    "rush anxiously forward",
    "walking slowly, hands behind back",
    "walk with depression",
    "head bowed and body bent while walking",
    "walking drunkenly",
}
USUAL_FURNITURE = {
    *("bed", "nightstand", "wardrobe", "dresser", "dressing table", "mirror", "table lamp"),
    *("sofa", "loveseat", "armchair", "ottoman", "coffee table", "side table", "tv stand", "tv", "floor lamp", "plant"),
    *("dining table", "dining chair", "sideboard", "refrigerator", "wine cabinet", "cabinet", "shelf", "stool"),
    *("desk", "office chair", "chair", "bookshelf"),
}
"""What a home usually has, in the words of scripts. No shipped room has a piano, half of the dining rooms a stove."""


def why_not_executable(script: ShortScript) -> str | None:
    """What keeps a body that stands somewhere in the room from acting the script out."""
    posture, at = "standing", None
    for number, keyframe in enumerate(script.keyframes):
        here = keyframe.furniture
        match keyframe.skill:
            case Skill.LOCO if posture == "standing":
                at = here
            case Skill.TOUCH if posture == "standing" and at == here and not keyframe.on_floor:
                pass
            case Skill.SITDOWN | Skill.LIEDOWN if posture == "standing" and at == here:
                posture = "seated" if keyframe.skill == Skill.SITDOWN else "lying"
            case Skill.STANDUP if posture == "seated" and at == here:
                posture = "standing"
            case Skill.GETUP if posture == "lying" and at == here:
                posture = "standing"
            case _:
                return f"keyframe {number}: {keyframe.skill} at {here} while {posture} at {at}"
    return None


@for_each("script", SCRIPTS)
def test_a_body_can_act_a_script_out(script: ShortScript) -> None:
    assert why_not_executable(script) is None
    assert check(script) == ()
    assert repair(script.keyframes) == (script.keyframes, ())
    assert 3 <= len(script.keyframes) <= 9


def test_ids_and_summaries_are_unique() -> None:
    assert len({script.id for script in SCRIPTS}) == len(SCRIPTS) >= 560
    assert len({script.summary for script in SCRIPTS}) == len(SCRIPTS)


def test_no_two_summaries_are_much_alike_in_their_words() -> None:
    features = HashingEncoder().encode([script.summary for script in SCRIPTS])
    alike = np.triu(features @ features.T, 1)
    one, other = np.unravel_index(int(alike.argmax()), alike.shape)
    assert alike[one, other] < 0.6, (SCRIPTS[one].id, SCRIPTS[other].id)


def test_no_two_scripts_are_played_alike() -> None:
    runs = Counter(tuple((k.skill, k.caption, k.furniture) for k in script.keyframes) for script in SCRIPTS)
    assert [run for run, count in runs.items() if count > 1] == []


def test_every_emotion_is_shown_in_every_room_at_least_ten_times() -> None:
    cells: Counter[tuple[str, str]] = Counter((script.emotion, script.room) for script in SCRIPTS)
    assert {cell: count for cell in product(EMOTIONS, ROOM_TYPES) if (count := cells[cell]) < 10} == {}


def test_all_scripts_are_our_own() -> None:
    assert {(script.source, script.licence) for script in SCRIPTS} == {("authored", "MIT")}


def test_captions_come_from_the_vocabulary_and_all_of_it_but_gestures_is_used() -> None:
    used = {(keyframe.skill, keyframe.caption) for script in SCRIPTS for keyframe in script.keyframes}
    known = {(Skill(skill), caption) for skill, some in CAPTIONS.items() for caption in some}
    assert used <= known
    assert known - used == captions_of_gestures()


def test_every_caption_is_shown_in_five_scripts_or_more() -> None:
    shown = Counter(pair for script in SCRIPTS for pair in {(k.skill, k.caption) for k in script.keyframes})
    assert {pair: count for pair, count in shown.items() if count < 5} == {}


def test_furniture_that_a_home_usually_has_is_used_by_ten_scripts_or_more() -> None:
    users = Counter(word for script in SCRIPTS for word in {keyframe.piece[0] for keyframe in script.keyframes})
    assert {word: users[word] for word in USUAL_FURNITURE if users[word] < 10} == {}


def test_what_is_in_every_tenth_room_of_a_kind_can_be_meant_by_some_word_of_ten_scripts() -> None:
    """By its own name, by a generic word, or as the nearest of its class."""
    rooms: dict[str, list[set[str]]] = {kind: [] for kind in ROOM_TYPES}
    for layout in built_in_layouts():
        rooms[layout.room_type].append({item.category for item in layout.objects})
    usual = {
        category
        for kept in rooms.values()
        for category, count in Counter(one for room in kept for one in room).items()
        if count >= len(kept) / 10 and affordances(category)
    }
    users = Counter(
        category
        for script in SCRIPTS
        for category in usual
        if any(_in_class(category, k.piece[0]) for k in script.keyframes if not k.on_floor)
    )
    assert {category: users[category] for category in usual if users[category] < 10} == {}


def test_most_touches_say_more_than_that_something_is_touched() -> None:
    touches = [k.caption for script in SCRIPTS for k in script.keyframes if k.skill is Skill.TOUCH]
    assert sum(caption.startswith("touch medium height") for caption in touches) < len(touches) / 4


def test_the_captions_of_the_paper_are_all_there() -> None:
    assert set(CAPTIONS["sitdown"]) >= SIT_CAPTIONS_OF_THE_PAPER
    assert set(CAPTIONS["liedown"]) >= LIE_CAPTIONS_OF_THE_PAPER
    assert set(CAPTIONS["loco"]) >= WALK_CAPTIONS_OF_THE_PAPER
    assert {len(captions) for captions in CAPTIONS.values()} <= set(range(2, 101))


def test_furniture_is_known_and_affords_what_is_done_with_it() -> None:
    for script in SCRIPTS:
        for keyframe in script.keyframes:
            if not keyframe.on_floor:
                assert is_known(keyframe.furniture), (script.id, keyframe.furniture)
                assert NEEDS.get(keyframe.skill, "touch") in affordances(keyframe.furniture), (script.id, keyframe)


def test_the_furniture_is_found_in_rooms_of_that_kind() -> None:
    """In a tenth of the shipped rooms or more: itself, or else what a room search would take for it."""
    rooms: dict[str, list[set[str]]] = {kind: [] for kind in ROOM_TYPES}
    for layout in built_in_layouts():
        rooms[layout.room_type].append({item.category for item in layout.objects})
    uses = {
        (script.room, keyframe.piece[0], NEEDS.get(keyframe.skill, "touch"))
        for script in SCRIPTS
        for keyframe in script.keyframes
        if not keyframe.on_floor
    }
    rare = {}
    for kind, word, need in sorted(uses):
        share = max(
            sum(any(same(one, word) and need in affordances(one) for one in room) for room in rooms[kind])
            for same in (_is, _in_class, _in_group)
        ) / len(rooms[kind])
        if share < 0.1:
            rare[kind, word, need] = share
    assert rare == {}


def _is(category: str, word: str) -> bool:
    return category in categories_of(word)


def _in_class(category: str, word: str) -> bool:
    return class_of(category) == class_of(word)


def _in_group(category: str, word: str) -> bool:
    return group_of(category) == group_of(word)


def test_a_script_shows_the_emotion_it_is_filed_under() -> None:
    for script in SCRIPTS:
        assert script.emotion in {keyframe.mood for keyframe in script.keyframes}, script.id


def test_no_keyframe_is_repeated_at_once() -> None:
    for script in SCRIPTS:
        assert all(one != other for one, other in pairwise(script.keyframes)), script.id


def test_every_summary_tells_of_one_person_in_the_present() -> None:
    assert not [script.id for script in SCRIPTS if not tells_of_one(script.summary)]


def test_summaries_are_one_to_three_sentences_in_plain_letters() -> None:
    for script in SCRIPTS:
        assert re.fullmatch(r"[A-Z][A-Za-z0-9 ,.:!'-]{30,198}[.!]", script.summary), script.id
        assert 1 <= len(re.findall(r"[.!](?: [A-Z]|$)", script.summary)) <= 3, script.id
        assert "  " not in script.summary, script.id
