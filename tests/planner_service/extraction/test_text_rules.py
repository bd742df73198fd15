"""What rules read in a scene: whose deeds are followed, what keyframes show of them, and where a script ends."""

from __future__ import annotations

from itertools import pairwise

from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.extraction.script_writer import Maker
from planner_service.extraction.text_rules import SceneRead, read_scene
from planner_service.extraction.text_scenes import Line, TextScene
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script_library import Features, ScriptLibrary

LIBRARY = ScriptLibrary(built_in(), Features(HashingEncoder()))
DEEDS = ("walks to the desk", "sits down on the sofa", "opens the wardrobe", "lies down on the bed", "dances")


def read(*lines: str | Line, place: str = "") -> SceneRead:
    told = tuple(line if isinstance(line, Line) else Line(line) for line in lines)
    return read_scene(TextScene(told, place), Maker("a text", LIBRARY))


def acted(scene: SceneRead) -> list[tuple[str, str]]:
    """Skills and furniture of all its keyframes, without walks."""
    keyframes = [keyframe for draft in scene.drafts for keyframe in draft.script.keyframes]
    return [(keyframe.skill.value, keyframe.furniture) for keyframe in keyframes if keyframe.skill != "loco"]


@for_each(
    ("text", "shown"),
    [
        ("Anna slumped onto the couch.", [("sitdown", "sofa")]),
        ("He grabbed the phone from the shelf.", [("touch", "shelf")]),
        ("She lay awake.", [("liedown", "bed")]),
        ("Tom collapsed on the bed.", [("liedown", "bed")]),
        ("She was sitting at the desk.", [("sitdown", "office chair")]),
        ("The man sat at the dining table.", [("sitdown", "dining chair")]),
        ("He took the suit from the wardrobe.", [("touch", "wardrobe")]),
        ("She hung a coat in the wardrobe.", [("touch", "wardrobe")]),
        ("Anna put the cup on the coffee table.", [("touch", "coffee table")]),
        ("He walked to the desk, sat down and began to write.", [("sitdown", "office chair")]),
        ("He went to bed. He could not sleep.", [("liedown", "bed")]),
        ("Daniel, unshaven, shuffles in and opens the fridge.", [("touch", "refrigerator")]),
        ("She read a book in the armchair, got up and left.", [("sitdown", "armchair"), ("standup", "armchair")]),
    ],
)
def test_keyframes_show_what_is_told(text: str, shown: list[tuple[str, str]]) -> None:
    assert acted(read(text)) == shown


@for_each(
    "text",
    [
        "She lied to her mother.", "He closed his eyes.", "Anna does not sit.", "It was late.",
        "He wants to sit down.", "Clouds hung over the town.", "She had slept in the bed.", "Nobody sat down.",
        "The cat sat on the sofa.",
    ],
)  # fmt: skip
def test_what_nobody_does_now_or_no_body_shows_gives_no_script(text: str) -> None:
    scene = read(text)
    assert scene.drafts == ()
    assert scene.reason == "nobody in it does what a body can act"


@for_each(
    ("text", "hero"),
    [
        ("Anna sat on the sofa. Tom walked in. He lay down on the bed. She wept.", "Anna"),
        ("Tom sat on the sofa. The children came in. He wept. Mia lay down on the bed.", "Tom"),
        ("Mr. Hill sat on the sofa. His wife lay down on the bed. He wept.", "Mr. Hill"),
        ("Grandfather sat on the sofa. Mia lay down on the bed. The old man wept.", "Grandfather"),
        ("I sat on the sofa. Mia lay down on the bed. I wept.", "I"),
        ("After dinner Jonas sat on the sofa while Mia lay down on the bed. That night he wept.", "Jonas"),
    ],
)
def test_one_persons_deeds_are_followed_and_the_others_are_named(text: str, hero: str) -> None:
    scene = read(text)
    assert ("sitdown", "sofa") in acted(scene)
    assert ("liedown", "bed") not in acted(scene)
    assert scene.drafts[-1].script.summary.endswith("weeps.")
    assert any(line.endswith(f"the script follows {hero}") for line in scene.unused)


@tries(40)
@given(st.lists(st.sampled_from(DEEDS), min_size=1, max_size=20))
def test_a_script_has_six_deeds_at_most_and_its_own_part_of_time(deeds: list[str]) -> None:
    scene = read(*(Line(f"She {deed}.", start=at, end=at + 1) for at, deed in enumerate(deeds)))
    spans = [(one.start, one.end) for draft in scene.drafts if (one := draft.script.origin) is not None]
    assert spans == sorted(spans)
    assert all(before[1] <= after[0] for before, after in pairwise(spans))  # type: ignore[operator]
    assert (spans[0][0], spans[-1][1]) == (0, len(deeds))
    # A deed takes a walk, a rising and itself at most.
    assert all(len(draft.script.keyframes) <= 3 * 6 for draft in scene.drafts)


@for_each(
    ("text", "place", "room"),
    [
        ("She sits down.", "ANNA'S BEDROOM - NIGHT", "bedroom"),
        ("She sits down.", "KITCHEN", "dining_room"),
        ("She sits down in the study.", "", "study"),
        ("She opens the wardrobe.", "", "bedroom"),
        ("She sits down.", "", "living_room"),
    ],
)
def test_a_scene_plays_where_its_slugline_its_words_or_its_furniture_say(text: str, place: str, room: str) -> None:
    (draft,) = read(text, place=place).drafts
    assert draft.script.room == room


def test_what_is_said_shows_the_mood_where_nobody_is_told_to_feel_any() -> None:
    said = Line("I am so furious!", spoken=True)
    assert read(said, "She sits down.").drafts[0].script.emotion == "angry"
    assert read(said, "She sits down, happy.").drafts[0].script.emotion == "happy"
