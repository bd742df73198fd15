"""A script that somebody changed says of each beat whether what is done now shows it."""

from __future__ import annotations

from typing import Any

from for_each import for_each
from narration.hand_made_scripts import beat, frame, made

from planner_service.grounding.script_revision import EditedKeyframe, rewritten
from planner_service.scripts.acted_beats import planned_beats
from planner_service.scripts.script import LongScript
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout_library import built_in_index

SCRIPT = made(
    "She sits down and reads a book on the sofa.",
    [beat("sits down"), beat("reads a book on the sofa")],
    [
        frame("loco", "smoothly forward walk", "sofa", 0),
        frame("sitdown", "reading, book held in both hands", "sofa", 0).model_copy(update={"also": (1,)}),
    ],
)


def home() -> Home:
    return home_from_layouts([built_in_index().layout("living-room-0002")], 0)


def changed(**words: Any) -> LongScript:
    """The script with its last keyframe changed."""
    rows = [{**one.model_dump(include={"skill", "emotion", "caption", "furniture"}), "index": index}
            for index, one in enumerate(SCRIPT.keyframes)]  # fmt: skip
    rows[-1] |= words
    return rewritten(SCRIPT, [EditedKeyframe.model_validate(row) for row in rows], home())


def acted(script: LongScript) -> list[bool]:
    return [one.acted for one in planned_beats(script).outcomes]


def test_what_is_left_as_it_was_is_acted_as_it_was() -> None:
    assert acted(changed()) == acted(SCRIPT) == [True, True]


@for_each(
    ("skill", "caption", "reads"),
    [
        ("sitdown", "drinking from a cup in the right hand", False),
        ("sitdown", "sit upright with hands on thighs", False),
        ("liedown", "reading on the back, book held above the chest", True),
    ],
)
def test_a_beat_is_only_stood_for_where_its_caption_was_changed_for_something_else(
    skill: str, caption: str, reads: bool
) -> None:
    assert acted(changed(skill=skill, caption=caption)) == [skill == "sitdown", reads]


@for_each(
    ("words", "held"),
    [
        ({}, "novel"),
        ({"held": "newspaper"}, "newspaper"),
        ({"held": ""}, ""),
        ({"caption": "clapping while seated"}, ""),
        ({"caption": "drinking from a cup in the right hand", "held": "beer"}, "beer"),
        ({"emotion": "sad"}, "novel"),
    ],
)
def test_what_is_in_the_hands_stays_while_the_same_is_done_and_nobody_says_otherwise(
    words: dict[str, str], held: str
) -> None:
    reads = SCRIPT.keyframes[-1].model_copy(update={"held": "novel"})
    script = SCRIPT.model_copy(update={"keyframes": (*SCRIPT.keyframes[:-1], reads)})
    rows = [{**one.model_dump(include={"skill", "emotion", "caption", "furniture"}), "index": index}
            for index, one in enumerate(script.keyframes)]  # fmt: skip
    rows[-1] |= words
    found = rewritten(script, [EditedKeyframe.model_validate(row) for row in rows], home())
    assert found.keyframes[-1].held == held


def test_what_is_taken_out_is_no_more_acted_though_somebody_still_gets_up_for_it() -> None:
    script = made(
        "She sits down on the sofa, dances and looks out.",
        [beat("sits down on the sofa"), beat("dances"), beat("looks out")],
        [
            frame("sitdown", "sitting still", "sofa", 0),
            frame("standup", "stand up", "sofa", 1),
            frame("loco", "dancing steps, arms swinging", "floor", 1),
            frame("loco", "stand still", "floor", 2),
        ],
    )
    kept = [
        EditedKeyframe.model_validate(
            {**one.model_dump(include={"skill", "emotion", "caption", "furniture"}), "index": at}
        )
        for at, one in enumerate(script.keyframes)
        if at != 2
    ]
    left = rewritten(script, kept, home())
    assert acted(left) == [True, False, True]
    assert all(1 not in (one.beat, *one.also) for one in left.keyframes)


@for_each(
    ("words", "does"),
    [({}, "open"), ({"does": "close"}, "close"), ({"does": ""}, ""), ({"caption": "clapping while seated"}, "")],
)
def test_what_becomes_of_the_piece_stays_while_the_same_is_done_and_nobody_says_otherwise(
    words: dict[str, str], does: str
) -> None:
    opens = SCRIPT.keyframes[-1].model_copy(update={"does": "open"})
    script = SCRIPT.model_copy(update={"keyframes": (*SCRIPT.keyframes[:-1], opens)})
    rows = [{**one.model_dump(include={"skill", "emotion", "caption", "furniture"}), "index": index}
            for index, one in enumerate(script.keyframes)]  # fmt: skip
    rows[-1] |= words
    found = rewritten(script, [EditedKeyframe.model_validate(row) for row in rows], home())
    assert found.keyframes[-1].does == does
