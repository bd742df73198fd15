"""What further labellers would play, held against the labels."""

from __future__ import annotations

import pytest

from planner_service.evaluation.beat_judgement import Judgement
from planner_service.evaluation.labels import LabelledTheme, labelled_themes
from planner_service.evaluation.second_labellers import judged_labellers, played, second_labellers
from planner_service.scripts.captions import captions
from planner_service.scripts.script import Keyframe
from scene_graphs.furniture import is_known

THEME = LabelledTheme.model_validate(
    {
        "id": "x", "theme": "He sits down, thinks of home and writes.", "split": "tune",
        "beats": [
            {"text": "sits down", "actable": True, "shown_by": [{"skill": ["sitdown"]}]},
            {"text": "thinks of home", "actable": False},
            {"text": "writes", "actable": True, "shown_by": [{"caption": ["writing"]}]},
        ],
    },
    strict=False,
)  # fmt: skip
SITS = Keyframe(skill="sitdown", caption="hands on thighs", furniture="sofa")
WRITES = Keyframe(skill="sitdown", caption="writing at the table, right hand moving", furniture="dining chair")


def test_everything_that_was_read_has_a_label_with_as_many_beats_and_words_that_we_know() -> None:
    labels = {one.id: one for one in labelled_themes()}
    read = second_labellers()
    assert set(read) == {"A", "B"}
    for themes in read.values():
        assert {theme for theme in themes if theme.startswith("n")} <= set(labels)
        for theme, plays in themes.items():
            if theme in labels:
                assert labels[theme].split == "held_out", theme
                assert len(plays) == len(labels[theme].beats), theme
            for one in filter(None, plays):
                assert one.caption in captions()[one.skill.value], (theme, one)
                assert one.on_floor or is_known(one.furniture), (theme, one)


def test_who_plays_what_the_label_accepts_has_acted_and_named_everything() -> None:
    judged = Judgement(THEME, played(THEME, (SITS, None, WRITES)))
    assert judged.acted == (0, 2)
    assert judged.missing == judged.named == (1,)


def test_who_plays_what_the_label_does_not_accept_has_neither_acted_nor_named_it() -> None:
    judged = Judgement(THEME, played(THEME, (SITS, SITS, SITS)))
    assert judged.acted == (0,)
    assert judged.missing == (1, 2)
    assert judged.named == ()


def test_who_plays_nothing_has_named_everything() -> None:
    judged = Judgement(THEME, played(THEME, (None, None, None)))
    assert judged.acted == ()
    assert judged.named == judged.missing == (0, 1, 2)


def test_plays_for_other_beats_are_refused() -> None:
    with pytest.raises(ValueError, match=r"zip\(\)"):
        played(THEME, (SITS,))


def test_themes_that_nobody_read_again_are_left_out() -> None:
    assert all(themes == () for themes in judged_labellers([THEME]).values())
