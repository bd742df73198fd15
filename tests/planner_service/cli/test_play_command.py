"""`sims play` acts a script as it stands, and says where a word is not known and what would be right."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from motion_backend.motion import SKILL_WORDS, Skill
from planner_service.cli.play import MAX_FAULTS, read_script, unknown_captions
from planner_service.cli.story import new_folder
from planner_service.pipeline import RequestError
from planner_service.scripts.captions import captions
from planner_service.scripts.script import Keyframe
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
        ([SIT | {"furniture": "soffa"}], "moment 1, furniture: 'soffa' is not known; perhaps 'sofa', 'sofa bed'"),
        ([WALK, {"skill": "fly", "caption": "walk"}], "moment 2, skill: Input should be"),
        ([WALK | {"colour": "red"}], "moment 1, colour: Extra inputs"),
        ([3], "moment 1: Input should be"),
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
    for number in (2, 4):
        for field in ("skill", "caption", "colour", "furniture"):
            assert str(refused.value).count(f"moment {number}, {field}: ") == 1
    assert "moment 1," not in str(refused.value)
    with pytest.raises(RequestError) as refused:
        read_script(written(tmp_path, [bad] * MAX_KEYFRAMES))
    assert str(refused.value).count("moment ") == MAX_FAULTS
    assert str(refused.value).endswith(f"and {4 * MAX_KEYFRAMES - MAX_FAULTS} more")


def test_captions_that_the_body_does_not_know_are_shown_with_those_it_does(tmp_path: Path) -> None:
    known, other = read_script(written(tmp_path, [SIT, SIT | {"caption": "siting stil"}])).keyframes
    (line,) = unknown_captions([known, other])
    assert line.startswith("moment 2, caption: 'siting stil' is unknown to the body, which does ")
    near = line.partition("; perhaps ")[2].split(", ")
    assert near[0] == "'sitting still'"
    assert len(set(near)) == len(near)


def test_a_caption_that_is_read_as_another_is_said_before_anything_is_made(tmp_path: Path) -> None:
    kick = {"skill": "touch", "emotion": "angry", "caption": "kick it", "furniture": "cabinet"}
    turned = {"skill": "loco", "emotion": "neutral", "caption": "moonwalk backwards", "furniture": "floor"}
    first, second = unknown_captions(read_script(written(tmp_path, [kick, turned]))[0])
    assert first.startswith("moment 1, caption: 'kick it' is unknown to the body, which does 'touch medium height'")
    assert second.startswith("moment 2, caption: 'moonwalk backwards' is read word by word")


def test_words_of_a_caption_that_nothing_shows_are_named_and_those_that_are_seen_are_not() -> None:
    seat = {"skill": Skill.SITDOWN, "furniture": "sofa", "emotion": "neutral"}
    paper, book = unknown_captions(
        [Keyframe(caption=f"legs crossed, reading a {what}", **seat) for what in ("newspaper", "book")]
    )
    assert "is read word by word, and nothing of 'newspaper' is seen; perhaps" in paper
    assert "is read word by word; perhaps" in book


def test_what_is_done_instead_is_not_suggested_as_well() -> None:
    sit = Keyframe(skill=Skill.SITDOWN, caption="siting stil", furniture="sofa", emotion="neutral")
    (line,) = unknown_captions([sit])
    done = line.partition("does '")[2].partition("' instead")[0]
    assert done
    assert line.count(repr(done)) == 1, line


def test_what_is_suggested_means_what_was_asked_for_or_is_what_the_mood_does() -> None:
    walk = {"skill": Skill.LOCO, "furniture": "floor"}
    drunk, plain = unknown_captions(
        [
            Keyframe(caption=caption, emotion=mood, **walk)
            for caption, mood in (("xyzzy", "drunk"), ("xyzzy", "neutral"))
        ]
    )
    assert drunk.endswith("which does 'walking drunkenly' instead")
    assert "perhaps" not in plain + drunk, "what is done is not suggested"


@pytest.mark.parametrize("skill", Skill)
def test_a_skill_may_be_written_as_stories_print_it(skill: Skill, tmp_path: Path) -> None:
    written_so = (skill.value, skill.words, skill.words.title(), *SKILL_WORDS[skill])
    rows = [{"skill": word, "caption": "x", "furniture": "sofa"} for word in written_so]
    assert {one.skill for one in read_script(written(tmp_path, rows)).keyframes} == {skill}


def test_a_skill_that_nobody_knows_is_shown_with_both_words_of_each(tmp_path: Path) -> None:
    with pytest.raises(RequestError) as refused:
        read_script(written(tmp_path, [WALK | {"skill": "fly"}]))
    for skill, words in SKILL_WORDS.items():
        assert skill.value in str(refused.value)
        assert all(word in str(refused.value) for word in words)


def test_no_caption_is_suggested_twice() -> None:
    for skill, rows in captions().items():
        asked = [Keyframe(skill=Skill(skill), caption=f"{row} x", furniture="sofa", emotion="neutral") for row in rows]
        for line in unknown_captions(asked):
            near = line.partition("; perhaps ")[2]
            assert not near or all(near.count(repr(row)) <= 1 for row in rows), line


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
