"""A story.json plays again as its story did; what somebody changed in it is made and told anew, and nothing else."""

from __future__ import annotations

import json
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from encoded import encoded
from typer.testing import CliRunner

from motion_backend.motion import RISINGS, Character
from planner_service.cli import app
from planner_service.cli.play import read_script
from planner_service.library.library import Shelves
from planner_service.output.replayed_story import ReplayedStory
from planner_service.output.story_export import story_to_dict
from planner_service.pipeline import Pipeline, Planned, RequestError, StoryRequest
from scene_graphs.furniture import display_name

THEME = (
    "An old man comes home, opens the window, writes a letter to his daughter at the desk, drinks a cup of tea on the "
    "sofa and falls asleep."
)
TEA = "drinking from a cup in the right hand"


@cache
def pipeline() -> Pipeline:
    return Pipeline(Shelves(cache=encoded()))


@cache
def made() -> dict[str, Any]:
    """The story.json of a story with a name and a get-up of its own."""
    request = StoryRequest(THEME, seed=11, character=Character("Ludwig", "he", outfit="pyjamas"))
    return json.loads(json.dumps(story_to_dict(pipeline().make(request))))


def read(row: object, folder: Path) -> ReplayedStory:
    path = folder / "story.json"
    path.write_text(json.dumps(row), encoding="utf-8")
    story = read_script(path).story
    assert story is not None
    return story


def drinking(row: dict[str, Any]) -> int:
    """The moment at which the tea is drunk."""
    return next(at for at, one in enumerate(row["script"]["keyframes"]) if one["caption"] == TEA)


def changed(folder: Path, at: int, **fields: str) -> tuple[ReplayedStory, Planned]:
    row = deepcopy(made())
    row["script"]["keyframes"][at] |= fields
    story = read(row, folder)
    return story, story.planned(pipeline(), story.request)


def words_of(told: dict[str, Any], moment: int) -> set[str]:
    return {told["text"][one["start"] : one["end"]] for one in told["spans"] if moment in one["keyframes"]}


def test_played_unchanged_it_is_the_same_to_the_last_digit(tmp_path: Path) -> None:
    story = read(made(), tmp_path)
    planned = story.planned(pipeline(), story.request)
    again = json.loads(json.dumps(story_to_dict(pipeline().play(planned, kept=story.kept(planned)))))
    assert again == made()
    assert (again["character"]["name"], again["character"]["outfit"]) == ("Ludwig", "pyjamas")


def test_only_the_words_of_the_moment_that_was_changed_are_other_words(tmp_path: Path) -> None:
    at = drinking(made())
    story, planned = changed(tmp_path, at, caption="right hand on chin, thinking")
    told = planned.told.to_dict()
    assert told["title"] == made()["title"]
    for moment in range(len(made()["actions"])):
        if moment == at or not words_of(made(), at) & words_of(made(), moment):  # the way there is told with it
            assert (words_of(told, moment) == words_of(made(), moment)) == (moment != at), moment
    (words,) = words_of(told, at)
    assert "chin" in words
    assert "tea" not in planned.told.text
    assert planned.told.text.count("Ludwig") == made()["text"].count("Ludwig")
    kept = story.kept(planned)
    rising = [one.skill in RISINGS for one in planned.script.keyframes]  # grounded anew from what is risen from
    assert [index for index, one in enumerate(kept[: at + 1]) if one is None and not rising[index]] == [at]
    assert planned.home == story.stage.home


def test_a_touch_at_another_piece_is_told_at_that_one(tmp_path: Path) -> None:
    row = made()
    at = next(index for index, one in enumerate(row["script"]["keyframes"]) if one["skill"] == "touch")
    story, planned = changed(tmp_path, at, furniture="sofa")
    moment = next(index for index, one in enumerate(planned.script.keyframes) if one.skill == "touch")
    (words,) = words_of(planned.told.to_dict(), moment)
    assert "window" not in planned.told.text
    object_id = planned.stage.places[moment].object_id
    assert object_id is not None
    assert display_name(planned.home.object(object_id).category) in words
    actions = pipeline().act(planned.request, planned.stage, story.kept(planned))
    assert actions[moment].object_id == object_id


def test_a_moment_that_is_put_in_or_left_out_moves_the_words_of_no_other(tmp_path: Path) -> None:
    row, new = deepcopy(made()), {"skill": "walk", "caption": "clapping hands", "furniture": "floor"}
    row["script"]["keyframes"].insert(1, new)
    story = read(row, tmp_path)
    told = story.planned(pipeline(), story.request).told.to_dict()
    for moment in range(1, len(made()["actions"])):
        assert words_of(made(), moment) <= words_of(told, moment + 1)
    del row["script"]["keyframes"][1]
    assert read(row, tmp_path).unchanged


def test_what_the_home_lacks_is_said_where_it_stands_with_what_there_is(tmp_path: Path) -> None:
    at = drinking(made())
    with pytest.raises(RequestError, match=rf"moment {at + 1}, furniture: the home has no hammock|is not known"):
        changed(tmp_path, at, furniture="hammock")
    with pytest.raises(RequestError, match=rf"moment {at + 1}, caption: the body knows no “yodel” .* nearest"):
        changed(tmp_path, at, caption="yodel")


@pytest.mark.parametrize(
    "broken",
    [
        {"acted": {}},
        {"acted": {"keyframes": [], "places": []}},
        {"acted": 3},
        {"spans": [{"start": 0, "end": 10_000, "keyframes": [0]}]},
        {"actions": []},
        {"character": {"name": "Ludwig", "tail": "long"}},
        {"home": {}},
    ],
)
def test_a_file_that_is_no_story_any_more_is_refused_in_words(broken: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"story\.json|home") as refused:
        read(made() | broken, tmp_path)
    assert isinstance(refused.value, RequestError) or "home" in str(refused.value)


def test_the_command_gives_another_name_and_the_same_words(tmp_path: Path) -> None:
    path = tmp_path / "story.json"
    path.write_text(json.dumps(made()), encoding="utf-8")
    done = CliRunner().invoke(app, ["play", str(path), "--name", "Otto", "--out", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    again = json.loads((tmp_path / "out" / "story.json").read_text(encoding="utf-8"))
    assert again["text"] == made()["text"].replace("Ludwig", "Otto")
    assert again["title"] == made()["title"]
    assert again["character"] == made()["character"] | {"name": "Otto"}


def test_what_is_in_the_hands_is_kept_and_may_be_changed(tmp_path: Path) -> None:
    """Only seen: the body moves as it did."""
    at = drinking(made())
    assert made()["script"]["keyframes"][at]["held"] == "tea"
    same = read(made(), tmp_path)
    assert same.unchanged
    _, bare = changed(tmp_path, at, held="")
    assert bare.script.keyframes[at].held == ""
    assert "held" not in bare.script.keyframes[at].model_dump()
    story, planned = changed(tmp_path, at, held="beer")
    assert planned.script.keyframes[at].held == "beer"
    kept = story.kept(planned)
    actions = pipeline().act(planned.request, planned.stage, kept)
    assert [one.holds for one in actions][at] == "beer"
    assert [one.spot for one in actions] == [one.spot for one in story.actions]


def test_what_becomes_of_a_piece_is_kept_and_may_be_changed(tmp_path: Path) -> None:
    at = next(i for i, one in enumerate(made()["script"]["keyframes"]) if one["skill"] == "touch")
    story, planned = changed(tmp_path, at, does="open")
    assert planned.script.keyframes[at].does == "open"
    assert not story.unchanged
    _, bare = changed(tmp_path, at, does="")
    assert "does" not in bare.script.keyframes[at].model_dump()
    actions = pipeline().act(planned.request, planned.stage, story.kept(planned))
    assert [one.spot for one in actions] == [one.spot for one in story.actions]
    with pytest.raises(RequestError):
        changed(tmp_path, at, does="explode")
