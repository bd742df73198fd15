"""`sims captions` lists what the body can do, in words, and finds it by what it means."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from motion_backend.motion import Skill
from planner_service.cli import app
from planner_service.composition.caption_meanings import find_captions, known_captions
from planner_service.pipeline import RequestError
from planner_service.scripts.captions import captions


def printed(*words: str) -> str:
    done = CliRunner().invoke(app, ["captions", *words], env={"COLUMNS": "200"})
    assert done.exit_code == 0, done.output
    return done.stdout


def test_every_caption_is_listed_once_under_its_skill() -> None:
    listed = json.loads(printed("--json"))["items"]
    assert [(one["skill"], one["caption"]) for one in listed] == [
        (skill.value, text) for skill in Skill for text in captions()[skill.value]
    ]
    table = printed()
    for skill in Skill:
        assert f"{skill} ({skill.words}): {len(captions()[skill.value])}" in table


@pytest.mark.parametrize(
    ("words", "caption"),
    [("applaud", "clapping hands"), ("clap standing", ""), ("weep", "crying, face in both hands"),
     ("round of applause", "clapping hands"), ("SEW", "knitting, both hands in the lap")],
)  # fmt: skip
def test_a_caption_is_found_by_the_deed_it_is_a_gesture_of_and_by_other_words(words: str, caption: str) -> None:
    found = [one.caption for one in find_captions(words)]
    assert (caption in found) if caption else not found
    assert len(found) < len(known_captions()) / 10
    assert all(one in printed(*words.split()) for one in found)


def test_a_skill_is_chosen_by_what_people_call_it() -> None:
    assert printed("--skill", "sit down") == printed("--skill", "sitdown")
    refused = CliRunner().invoke(app, ["captions", "--skill", "fly"])
    assert isinstance(refused.exception, RequestError)
    assert "loco (or walk)" in str(refused.exception)
    assert "other words" in printed("zzz")


def test_what_a_caption_is_seen_as_is_no_pattern() -> None:
    for one in known_captions():
        assert len(set(one.shows)) == len(one.shows)
        assert not any(mark in way for way in one.shows for mark in "|$."), one
