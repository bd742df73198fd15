"""The shelves: what users add is kept in the database, seen by every process, and cheap to ask for."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from databases import DATABASES
from sqlalchemy import Engine, text, update

from planner_service.grounding.furnish import furnish
from planner_service.library.library import (
    AbsentError,
    FixedError,
    FullError,
    ShelfError,
    Shelves,
    TakenError,
    UnfitError,
    open_shelves,
)
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_library import LibraryError
from planner_service.settings import Settings
from planner_service.store.database import database_url, open_engine
from planner_service.store.library_store import ShelfFull, put
from planner_service.store.tables import short_scripts
from scene_graphs.generation.generate_room import generate_room
from scene_graphs.graph.furniture_graph import graph_from_uses
from scene_graphs.layout import Layout, LayoutError, Placed, write_layouts
from scene_graphs.layout_library import built_in_layouts

Opening = Callable[[], Shelves]


def script(script_id: str = "my-nap", **changes: object) -> ShortScript:
    row: dict[str, object] = {"id": script_id, "summary": "The character naps.", "emotion": "tired"}
    keyframe = {"skill": "liedown", "caption": "hands on belly", "furniture": "sofa"}
    return ShortScript.model_validate({**row, "room": "living_room", "keyframes": [keyframe], **changes})


def room(layout_id: str = "my-room", seed: int = 3) -> Layout:
    return replace(generate_room("living_room", seed), id=layout_id)


def settings(folder: Path, **changes: Any) -> Settings:
    return Settings(_env_file=None, **{"data_dir": folder, **changes})


@pytest.fixture(params=DATABASES)
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """A database of either kind."""
    address = "" if request.param == "sqlite" else request.getfixturevalue("postgres_url")
    return database_url(settings(tmp_path, database_url=address))


@pytest.fixture
def opening(url: str) -> Iterator[Opening]:
    """Opens shelves as another process would: on the same database, by a connection of its own."""
    engines: list[Engine] = []

    def opened() -> Shelves:
        engines.append(open_engine(url))
        return Shelves(engines[-1])

    yield opened
    for engine in engines:
        engine.dispose()


@pytest.fixture
def shelves(tmp_path: Path) -> Iterator[Shelves]:
    """Shelves on an empty SQLite file."""
    engine = open_engine(database_url(settings(tmp_path)))
    yield Shelves(engine)
    engine.dispose()


def test_what_one_process_adds_another_sees_and_what_it_removes_is_gone(opening: Opening) -> None:
    mine, theirs = opening(), opening()
    assert theirs.scripts().scripts == built_in()
    assert set(theirs.rooms()) == {layout.id for layout in built_in_layouts()}
    mine.add_scripts(script(), script("second"))
    mine.add_layouts(room())
    assert theirs.scripts().scripts == (*built_in(), script(), script("second"))
    assert theirs.rooms()["my-room"] == theirs.layouts().layout("my-room") == room()
    mine.remove_script("my-nap")
    mine.remove_layout("my-room")
    assert theirs.scripts().scripts == (*built_in(), script("second"))
    assert "my-room" not in theirs.rooms()


def test_an_id_that_is_used_again_means_the_new_thing_everywhere(opening: Opening) -> None:
    mine, theirs = opening(), opening()
    for summary in ("One.", "Two.", "Three."):
        mine.add_scripts(script(summary=summary))
        assert theirs.scripts().get("my-nap").summary == summary
        theirs.remove_script("my-nap")


def test_what_has_not_changed_is_the_very_same_object(opening: Opening) -> None:
    mine, theirs = opening(), opening()
    library, index = theirs.scripts(), theirs.layouts()
    assert theirs.scripts() is library
    assert theirs.layouts() is index
    mine.add_scripts(script())
    assert theirs.layouts() is index
    assert theirs.scripts().features is library.features
    mine.add_layouts(room())
    after = theirs.layouts()
    assert after is not index
    mine.add_layouts(room("other"))
    assert theirs.layouts().layout("my-room") is after.layout("my-room")


def test_of_many_who_add_the_same_id_at_once_one_succeeds(opening: Opening) -> None:
    several = [opening() for _ in range(4)]

    def add(number: int) -> bool:
        try:
            several[number % 4].add_scripts(script(f"own-{number}"), script("shared", summary=f"By {number}."))
        except TakenError:
            return False
        return True

    with ThreadPoolExecutor(8) as pool:
        added = list(pool.map(add, range(12)))
    assert sum(added) == 1
    own = [one.id for one in opening().scripts().scripts[len(built_in()) :]]
    assert sorted(own) == [f"own-{added.index(True)}", "shared"]


def test_readers_see_all_of_what_was_added_while_they_read(opening: Opening) -> None:
    mine, theirs = opening(), opening()

    def read(_: int) -> set[str]:
        return {one.id for one in theirs.scripts().scripts[len(built_in()) :]}

    with ThreadPoolExecutor(4) as pool:
        reading = pool.map(read, range(12))
        for number in range(4):
            mine.add_scripts(script(f"a-{number}"), script(f"b-{number}"))
        seen = list(reading)
    for ids in seen:
        assert {one[2:] for one in ids if one[0] == "a"} == {one[2:] for one in ids if one[0] == "b"}
    assert len(read(0)) == 8


@pytest.mark.parametrize(
    ("wrong", "kind", "says"),
    [
        (script(built_in()[0].id), TakenError, r"^id: .* already; choose another id"),
        (script("good"), TakenError, r"'good' already"),
        (
            script(keyframes=[{"skill": "touch", "caption": "x", "furniture": "spaceship"}]),
            UnfitError,
            r"^my-nap: keyframes\.0\.furniture: .*spaceship",
        ),
        (
            script(keyframes=[{"skill": "loco", "caption": "x", "emotion": "purple"}]),
            UnfitError,
            r"^my-nap: keyframes\.0\.emotion: .*purple",
        ),
    ],
)
def test_a_script_that_cannot_be_kept_is_refused_with_all_that_came_with_it(
    shelves: Shelves, wrong: ShortScript, kind: type[Exception], says: str
) -> None:
    with pytest.raises(kind, match=says):
        shelves.add_scripts(script("good"), wrong)
    assert shelves.scripts().scripts == built_in()


@pytest.mark.parametrize("layout_id", ["", "a b", "../x", "a//b", "/a", "a/", "ü", "x" * 121, "a/scene.glb", "a\nb"])
def test_an_id_that_is_no_part_of_an_address_is_refused(shelves: Shelves, layout_id: str) -> None:
    with pytest.raises(ShelfError, match=r"^id: "):
        shelves.add_layouts(room(layout_id))


@pytest.mark.parametrize("layout_id", ["procthor1k/train/0495", "a", "My_Room.2", "x" * 120, "a:b-c"])
def test_ids_of_other_peoples_rooms_are_kept_as_they_are(shelves: Shelves, layout_id: str) -> None:
    shelves.add_layouts(room(layout_id))
    assert layout_id in shelves.rooms()


def test_ours_cannot_be_removed_nor_what_is_not_there(shelves: Shelves) -> None:
    for remove, ours in ((shelves.remove_script, built_in()[0].id), (shelves.remove_layout, "study-0000")):
        with pytest.raises(FixedError, match="cannot be removed"):
            remove(ours)
        with pytest.raises(AbsentError, match="'nothing'"):
            remove("nothing")


def test_a_shelf_that_is_full_takes_nothing_more(shelves: Shelves) -> None:
    assert shelves.engine is not None
    rows = {f"s-{number}": {"body": script(f"s-{number}").model_dump_json()} for number in range(3)}
    put(shelves.engine, "short_scripts", rows, 3)
    with pytest.raises(ShelfFull):
        put(shelves.engine, "short_scripts", {"one-more": rows["s-0"]}, 3)
    assert len(shelves.scripts()) == len(built_in()) + 3
    assert issubclass(FullError, ShelfError)


def test_a_row_that_cannot_be_read_is_named(shelves: Shelves) -> None:
    shelves.add_scripts(script())
    assert shelves.engine is not None
    with shelves.engine.begin() as connection:
        connection.execute(update(short_scripts).values(body="{}"))
    with pytest.raises(LibraryError, match="database: short script 'my-nap' cannot be read"):
        Shelves(shelves.engine).scripts()


def test_a_users_script_comes_before_one_that_a_later_version_of_ours_calls_the_same(shelves: Shelves) -> None:
    ours = built_in()[0]
    mine = script(ours.id)
    assert shelves.engine is not None
    put(shelves.engine, "short_scripts", {ours.id: {"body": mine.model_dump_json()}}, 10)
    assert shelves.scripts().get(ours.id) == mine
    assert not shelves.is_fixed_script(shelves.scripts().get(ours.id))
    shelves.remove_script(ours.id)
    assert shelves.scripts().get(ours.id) == ours


def test_without_a_database_there_are_ours_and_nothing_can_be_added() -> None:
    shelves = Shelves()
    assert shelves.scripts().scripts == built_in()
    with pytest.raises(ShelfError, match="no database"):
        shelves.add_scripts(script())


def test_rooms_of_a_file_are_beside_ours_and_may_not_be_called_the_same(tmp_path: Path) -> None:
    file = tmp_path / "rooms.json"
    write_layouts(file, [room()])
    assert Shelves(layouts_file=file).rooms()["my-room"] == room()
    write_layouts(file, [room("study-0000")])
    with pytest.raises(LayoutError, match="'study-0000' is the id of a built-in room"):
        Shelves(layouts_file=file).rooms()


def test_who_only_reads_makes_no_database(tmp_path: Path) -> None:
    folder = tmp_path / "data"
    shelves = open_shelves(settings(folder))
    assert shelves.engine is None
    assert len(shelves.scripts()) == len(built_in())
    assert not folder.exists()
    writing = open_shelves(settings(folder), writes=True)
    writing.add_scripts(script())
    again = open_shelves(settings(folder))
    assert again.scripts().get("my-nap") == script()
    for one in (writing, again):
        assert one.engine is not None
        one.engine.dispose()


def test_a_users_room_is_not_chosen_for_a_seat_that_nobody_gets_to(shelves: Shelves) -> None:
    corners = ((-2.0, -2.0), (-2.0, 2.0), (2.0, 2.0), (2.0, -2.0))
    chair = Placed("armchair_1", "armchair", (1.4, 0.0, 1.4), (0.8, 0.9, 0.8), math.pi)
    fence = tuple(
        Placed(f"cabinet_{i}", "cabinet", spot, size)
        for i, (spot, size) in enumerate([((0.6, 0.0, 1.2), (0.4, 1.0, 1.6)), ((1.2, 0.0, 0.6), (1.6, 1.0, 0.4))])
    )
    walled = Layout("walled", "study", corners, objects=(chair, *fence), tags=("study",))
    free = replace(walled, id="free", objects=(chair,))
    shelves.add_layouts(walled, free)
    query = graph_from_uses([("armchair", 1)], [["sit"]])
    found = {match.layout_id: match for match in shelves.layouts().search(query, 500)}
    assert not found["free"].missing
    assert [node.category for node in found["walled"].missing] == [node.category for node in query]


def test_a_story_finds_its_way_into_a_users_room_when_it_fits_best(shelves: Shelves) -> None:
    own = replace(generate_room("study", 7), id="my-study")
    shelves.add_layouts(own)
    keyframes = script(
        keyframes=[{"skill": "sitdown", "caption": "sit", "furniture": own.objects[0].category}], room="study"
    ).keyframes
    pipeline = Pipeline(shelves)
    plan = pipeline.script(StoryRequest("", rooms=("study",), keyframes=keyframes))
    assert furnish(plan, shelves.layouts(), ("study",), (shelves.rooms()["my-study"],)).matches[0].layout_id == own.id


def test_thousands_of_users_scripts_and_rooms_cost_a_request_next_to_nothing(shelves: Shelves) -> None:
    assert shelves.engine is not None
    rows = {f"s-{number}": {"body": script(f"s-{number}").model_dump_json()} for number in range(3000)}
    put(shelves.engine, "short_scripts", rows, 10_000)
    shelves.scripts()
    started = time.process_time()
    for _ in range(50):
        shelves.scripts()
    assert (time.process_time() - started) / 50 < 0.01
    first = shelves.scripts().get("s-0")
    shelves.add_scripts(script("one-more"))
    assert shelves.scripts().get("s-0") is first
    with shelves.engine.connect() as connection:
        assert connection.execute(text("select count(*) from short_scripts")).scalar() == 3001
