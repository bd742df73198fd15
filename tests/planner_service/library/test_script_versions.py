"""Short scripts are kept again under their ids: the newest counts, the older ones can be read, nothing is lost."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from databases import DATABASES
from sqlalchemy import Engine

from planner_service.library.library import (
    RESERVED,
    AbsentError,
    ChangedError,
    FixedError,
    FullError,
    ShelfError,
    Shelves,
    UnfitError,
)
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import MAX_VERSIONS, ShortScript
from planner_service.scripts.script_library import LibraryError
from planner_service.settings import Settings
from planner_service.store.database import database_url, open_engine
from planner_service.store.library_store import MAX_KEPT, ShelfFull, renew
from planner_service.store.tables import script_versions

Opening = Callable[[], Shelves]
OURS = built_in()[0]


def script(script_id: str = "my-nap", **changes: object) -> ShortScript:
    row: dict[str, object] = {"id": script_id, "summary": "The character naps.", "emotion": "tired"}
    keyframe = {"skill": "liedown", "caption": "hands on belly", "furniture": "sofa"}
    return ShortScript.model_validate({**row, "room": "living_room", "keyframes": [keyframe], **changes})


@pytest.fixture(params=DATABASES)
def opening(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Opening]:
    """Opens shelves as another process would, on a database of either kind."""
    address = "" if request.param == "sqlite" else request.getfixturevalue("postgres_url")
    url = database_url(Settings(_env_file=None, data_dir=tmp_path, database_url=address))
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
    engine = open_engine(database_url(Settings(_env_file=None, data_dir=tmp_path)))
    yield Shelves(engine)
    engine.dispose()


def test_what_is_replaced_is_the_next_version_and_can_still_be_read_elsewhere(opening: Opening) -> None:
    mine, theirs = opening(), opening()
    mine.add_scripts(script(summary="One."))
    assert theirs.scripts().get("my-nap").summary == "One."
    added = mine.add_scripts(script(summary="Two."), script("other"), replace=True)
    assert (added.new, added.replaced, added.unchanged) == (["other"], ["my-nap"], [])
    again = mine.add_scripts(script(summary="Two."), replace=True)
    assert (again.new, again.replaced, again.unchanged) == ([], [], ["my-nap"])
    mine.change_script(script(summary="Three.", version=2))
    assert [(one.version, one.summary) for one in theirs.script_versions("my-nap")] == [
        (1, "One."), (2, "Two."), (3, "Three."),
    ]  # fmt: skip
    assert theirs.scripts().get("my-nap") == theirs.script_version("my-nap", 3)
    assert theirs.script_version("my-nap", 1) == script(summary="One.")
    with pytest.raises(AbsentError, match="no version 4 of 'my-nap'; there are 1, 2, 3"):
        theirs.script_version("my-nap", 4)
    theirs.remove_script("my-nap")
    with pytest.raises(AbsentError):
        mine.script_versions("my-nap")
    mine.add_scripts(script(summary="Anew."))
    assert [one.summary for one in theirs.script_versions("my-nap")] == ["Anew."]


def test_of_many_who_change_the_same_version_at_once_one_succeeds(opening: Opening) -> None:
    opening().add_scripts(script())
    several = [opening() for _ in range(4)]

    def change(number: int) -> bool:
        try:
            several[number % 4].change_script(script(summary=f"By {number}."))
        except ChangedError:
            return False
        return True

    with ThreadPoolExecutor(6) as pool:
        done = list(pool.map(change, range(8)))
    assert sum(done) == 1
    assert [one.summary for one in opening().script_versions("my-nap")] == [
        "The character naps.", f"By {done.index(True)}.",
    ]  # fmt: skip


def test_many_who_replace_and_remove_at_once_leave_versions_without_a_gap(opening: Opening) -> None:
    several = [opening() for _ in range(3)]

    def work(number: int) -> None:
        if number == 5:
            try:
                several[0].remove_script("my-nap")
            except AbsentError:
                return
        else:
            several[number % 3].add_scripts(script(summary=f"By {number}."), script(f"own-{number}"), replace=True)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(work, range(10)))
    several[0].add_scripts(script(summary="By the last."), replace=True)  # it may have been removed after all others
    kept = opening().script_versions("my-nap")
    assert [one.version for one in kept] == list(range(1, len(kept) + 1))
    assert len({one.summary for one in kept}) == len(kept)


def test_a_change_that_says_the_same_is_none(shelves: Shelves) -> None:
    shelves.add_scripts(script())
    first = shelves.change_script(script(summary="Two."))
    assert (first.version, first.summary) == (2, "Two.")
    assert shelves.change_script(script(summary="Two.")) == first
    assert len(shelves.script_versions("my-nap")) == 2


def test_what_cannot_be_kept_leaves_everything_as_it_was(shelves: Shelves) -> None:
    shelves.add_scripts(script())
    bad = script("bad", keyframes=[{"skill": "touch", "caption": "x", "furniture": "spaceship"}])
    for wrong, kind in (
        (bad, UnfitError),
        (OURS.model_copy(update={"summary": "Mine now."}), FixedError),
        (script("other", summary="Twice.").model_copy(update={"id": "my-nap"}), ShelfError),
    ):
        with pytest.raises(kind):
            shelves.add_scripts(script(summary="Two."), script("new"), wrong, replace=True)
        assert shelves.scripts().scripts == (*built_in(), script())
        assert shelves.script_versions("my-nap") == (script(),)
    with pytest.raises(UnfitError):
        shelves.change_script(bad)
    with pytest.raises(AbsentError):
        shelves.change_script(script("nobody"))
    with pytest.raises(FixedError):
        shelves.change_script(OURS.model_copy(update={"summary": "Mine now."}))
    assert shelves.script_versions(OURS.id) == (OURS,)


def test_all_of_ours_given_back_change_nothing(shelves: Shelves) -> None:
    added = shelves.add_scripts(*built_in(), replace=True)
    assert (added.new, added.replaced, len(added.unchanged)) == ([], [], len(built_in()))


@pytest.mark.parametrize("script_id", sorted(RESERVED))
def test_no_script_is_called_like_a_path(shelves: Shelves, script_id: str) -> None:
    with pytest.raises(ShelfError, match=f"^id: '{script_id}' is a path"):
        shelves.add_scripts(script(script_id))


def test_what_was_exported_elsewhere_keeps_its_version_until_it_is_changed(shelves: Shelves) -> None:
    shelves.add_scripts(script(version=7))
    shelves.add_scripts(script(summary="Eight.", version=1), replace=True)
    assert [one.version for one in shelves.script_versions("my-nap")] == [7, 8]
    shelves.add_scripts(script("last", version=MAX_VERSIONS))
    with pytest.raises(FullError, match="versions; choose another id"):
        shelves.add_scripts(script("last", summary="One more."), replace=True)
    assert shelves.scripts().get("last").version == MAX_VERSIONS


def test_of_very_many_versions_the_oldest_are_forgotten(shelves: Shelves) -> None:
    for number in range(1, MAX_KEPT + 4):
        shelves.add_scripts(script(summary=f"By {number}."), replace=True)
    versions = [one.version for one in shelves.script_versions("my-nap")]
    assert versions == list(range(3, MAX_KEPT + 4))


def test_a_full_shelf_takes_changes_and_nothing_new(shelves: Shelves) -> None:
    assert shelves.engine is not None
    shelves.add_scripts(script())
    body = script(summary="Two.", version=2).model_dump_json()
    with pytest.raises(ShelfFull):
        renew(shelves.engine, {"my-nap": lambda _: body, "new": lambda _: body}, 1)
    assert shelves.scripts().get("my-nap") == script()
    renew(shelves.engine, {"my-nap": lambda _: body}, 1)
    assert shelves.scripts().get("my-nap").version == 2


def test_a_database_of_the_version_before_gets_its_table(tmp_path: Path) -> None:
    url = database_url(Settings(_env_file=None, data_dir=tmp_path))
    engine = open_engine(url)
    Shelves(engine).add_scripts(script())
    script_versions.drop(engine)
    engine.dispose()
    engine = open_engine(url)
    Shelves(engine).add_scripts(script(summary="Two."), replace=True)
    assert len(Shelves(engine).script_versions("my-nap")) == 2
    engine.dispose()


def test_without_a_database_ours_can_be_read_and_nothing_can_be_kept() -> None:
    shelves = Shelves()
    assert shelves.script_versions(OURS.id) == (OURS,)
    with pytest.raises(ShelfError, match="no database"):
        shelves.add_scripts(script(), replace=True)
    with pytest.raises(LibraryError, match="nobody"):
        shelves.scripts().get("nobody")
