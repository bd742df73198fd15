"""`sims play` acts a script as it stands, and says where a word is not known and what would be right."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from planner_service.cli.play import MAX_FAULTS, read_script, unknown_captions
from planner_service.cli.story import new_folder
from planner_service.pipeline import RequestError
from planner_service.tasks.task_plan import MAX_KEYFRAMES

WALK = {"skill": "loco", "emotion": "sad", "caption": "walk", "furniture": "floor"}
SIT = {"skill": "sitdown", "emotion": "tired", "caption": "sitting still", "furniture": "sofa"}


def written(folder: Path, value: object) -> Path:
    path = folder / "script.json"
    path.write_text(value if isinstance(value, str) else json.dumps(value), encoding="utf-8")
    return path


def test_a_list_a_script_and_a_story_are_the_same_keyframes(tmp_path: Path) -> None:
    rows = [WALK, SIT]
    shapes = [rows, {"id": "mine", "keyframes": rows}, {"title": "Mine", "script": {"beats": [], "keyframes": rows}}]
    found = [read_script(written(tmp_path, shape))[0] for shape in shapes]
    assert found[0] == found[1] == found[2]
    assert [keyframe.caption for keyframe in found[0]] == ["walk", "sitting still"]


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ([SIT | {"furniture": "soffa"}], "keyframes.0.furniture: 'soffa' is not known; perhaps"),
        ([WALK, {"skill": "fly", "caption": "walk"}], "keyframes.1.skill: Input should be"),
        ([WALK | {"colour": "red"}], "keyframes.0.colour: Extra inputs"),
        ([3], "keyframes.0: Input should be"),
        ([], "holds no keyframes"),
        ({"title": "x"}, "holds no keyframes"),
        ("{", "is not JSON"),
        ("[" * 100_000, "is not JSON"),
        ([WALK] * (MAX_KEYFRAMES + 1), f"at most {MAX_KEYFRAMES}"),
    ],
)
def test_what_cannot_be_acted_is_shown_where_it_stands(tmp_path: Path, value: object, said: str) -> None:
    with pytest.raises(RequestError) as refused:
        read_script(written(tmp_path, value))
    assert said in str(refused.value)


def test_all_that_is_wrong_is_told_at_once_and_within_bounds(tmp_path: Path) -> None:
    bad = {"skill": "fly", "furniture": "soffa", "colour": "red"}
    with pytest.raises(RequestError) as refused:
        read_script(written(tmp_path, [WALK, bad, SIT, bad]))
    for number in (1, 3):
        for field in ("skill", "caption", "colour", "furniture"):
            assert str(refused.value).count(f"keyframes.{number}.{field}: ") == 1
    assert "keyframes.0" not in str(refused.value)
    with pytest.raises(RequestError) as refused:
        read_script(written(tmp_path, [bad] * MAX_KEYFRAMES))
    assert str(refused.value).count("keyframes.") == MAX_FAULTS
    assert str(refused.value).endswith(f"and {4 * MAX_KEYFRAMES - MAX_FAULTS} more")


def test_captions_that_the_body_does_not_know_are_shown_with_those_it_does(tmp_path: Path) -> None:
    (known, other), _ = read_script(written(tmp_path, [SIT, SIT | {"caption": "siting stil"}]))
    (line,) = unknown_captions([known, other])
    assert line.startswith("keyframes.1.caption: 'siting stil' is read word by word; perhaps 'sitting still'")


def test_a_file_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="cannot be read"):
        read_script(tmp_path / "none.json")


def test_a_new_folder_is_named_after_the_title_and_never_one_that_is_there(tmp_path: Path) -> None:
    assert new_folder(tmp_path, "The Interview!") == tmp_path / "the-interview"
    (tmp_path / "the-interview").mkdir()
    (tmp_path / "the-interview-2").mkdir()
    assert new_folder(tmp_path, "The Interview!") == tmp_path / "the-interview-3"
    assert new_folder(tmp_path, "¿…?") == tmp_path / "story"


def test_a_script_is_called_what_it_calls_itself(tmp_path: Path) -> None:
    rows: list[tuple[object, str]] = [
        ([SIT], ""), ({"keyframes": [SIT]}, ""), ({"summary": " At\nrest ", "keyframes": [SIT]}, "At rest"),
        ({"title": "The Book", "script": {"summary": "no", "keyframes": [SIT]}}, "The Book"),
        ({"title": 7, "script": {"summary": "At rest", "keyframes": [SIT]}}, "At rest"),
    ]  # fmt: skip
    assert [read_script(written(tmp_path, value))[1] for value, _ in rows] == [title for _, title in rows]
