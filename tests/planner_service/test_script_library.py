"""The library of short scripts: reading, adding and finding them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from motion_backend.language.text import HashingEncoder
from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.library import LibraryError, ScriptLibrary, built_in

NAP = {
    "id": "my-nap",
    "summary": "The character naps on the zebra-striped sofa.",
    "emotion": "tired",
    "room": "living_room",
    "keyframes": [{"skill": "liedown", "emotion/style": "tired", "caption": "hands on belly", "furnitures": "sofa"}],
}


def nap(**changes: object) -> ShortScript:
    """A script of a user's."""
    return ShortScript.model_validate({**NAP, **changes})


def small(*scripts: ShortScript, file: Path | None = None) -> ScriptLibrary:
    """A library of a few scripts."""
    return ScriptLibrary(scripts, HashingEncoder(), file=file)


def test_our_scripts_are_there_and_their_ids_differ() -> None:
    scripts = built_in()
    assert len({script.id for script in scripts}) == len(scripts) >= 100


def test_a_script_that_was_added_is_written_found_and_read_again(tmp_path: Path) -> None:
    file = tmp_path / "mine" / "scripts.jsonl"
    library = ScriptLibrary.read(file, HashingEncoder())
    more = library.add(nap()).add(nap(id="my-second-nap"))
    assert len(more) == len(library) + 2
    assert more.search("zebra-striped sofa")[0].script == nap()
    again = ScriptLibrary.read(file, HashingEncoder())
    assert again.scripts == more.scripts
    assert again.get("my-nap") == nap()
    assert [path.name for path in file.parent.iterdir()] == ["scripts.jsonl"]


def test_a_file_without_a_last_line_end_is_not_spoilt(tmp_path: Path) -> None:
    file = tmp_path / "scripts.jsonl"
    file.write_text(json.dumps(NAP), encoding="utf-8")
    ScriptLibrary.read(file, HashingEncoder()).add(nap(id="another"))
    assert [script.id for script in ScriptLibrary.read(file, HashingEncoder()).scripts[-2:]] == ["my-nap", "another"]


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"id": built_in()[0].id}, "already; choose another id"),
        (
            {"keyframes": [{"skill": "touch", "caption": "x", "furniture": "spaceship"}]},
            r"keyframes\.0\.furniture: .*spaceship",
        ),
        ({"keyframes": [{"skill": "loco", "caption": "x", "emotion": "purple"}]}, r"keyframes\.0\.emotion: .*purple"),
    ],
)
def test_a_script_that_cannot_be_kept_is_refused_and_nothing_is_written(
    tmp_path: Path, change: dict[str, object], fault: str
) -> None:
    library = ScriptLibrary.read(tmp_path / "scripts.jsonl", HashingEncoder())
    with pytest.raises(LibraryError, match=rf"^scripts\.jsonl:.*{fault}"):
        library.add(nap(**change))
    assert list(tmp_path.iterdir()) == []


def test_a_library_without_a_file_cannot_be_added_to() -> None:
    with pytest.raises(LibraryError, match="no file"):
        small(nap()).add(nap(id="another"))


@pytest.mark.parametrize(
    ("lines", "where"),
    [
        (["{"], r"^scripts\.jsonl:1:line: "),
        (["", json.dumps({**NAP, "emotion": "bored"})], r"^scripts\.jsonl:2:emotion: "),
        (
            [json.dumps({**NAP, "keyframes": [{"skill": "fly", "caption": "x"}]})],
            r"^scripts\.jsonl:1:keyframes\.0\.skill: ",
        ),
        ([json.dumps(NAP), json.dumps(NAP)], r"^scripts\.jsonl:2:id: 'my-nap' is taken by scripts\.jsonl:1"),
        ([json.dumps({**NAP, "id": built_in()[0].id})], r"^scripts\.jsonl:1:id: .* is taken by short_scripts\.jsonl"),
    ],
)
def test_a_line_that_cannot_be_read_is_named_with_its_field(tmp_path: Path, lines: list[str], where: str) -> None:
    file = tmp_path / "scripts.jsonl"
    file.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(LibraryError, match=where):
        ScriptLibrary.read(file, HashingEncoder())


def test_bytes_that_are_not_text_are_named_with_their_line(tmp_path: Path) -> None:
    file = tmp_path / "scripts.jsonl"
    file.write_bytes(json.dumps(NAP).encode() + b"\n\xff\xfe")
    with pytest.raises(LibraryError, match=r"^scripts\.jsonl:2: not UTF-8"):
        ScriptLibrary.read(file, HashingEncoder())


def test_a_summary_finds_its_own_script_first() -> None:
    library = ScriptLibrary.read(encoder=HashingEncoder())
    for script in library.scripts[::10]:
        found = library.search(script.summary, k=1)[0]
        assert (found.script.id, found.score) == (script.id, pytest.approx(1, abs=1e-3))


def test_search_keeps_to_the_emotion_and_room_asked_for() -> None:
    library = ScriptLibrary.read(encoder=HashingEncoder())
    found = library.search("drinks wine", k=4, emotion="sad", room="living room")
    assert len(found) == 4
    assert {(one.script.emotion, one.script.room) for one in found} == {("sad", "living_room")}
    assert [one.score for one in found] == sorted((one.score for one in found), reverse=True)


@pytest.mark.parametrize(
    ("query", "options", "fault"),
    [
        ("x", {"emotion": "bored"}, "emotion"),
        ("x", {"room": "attic"}, "room"),
        (" ", {}, "query"),
        ("x", {"k": 0}, "query"),
    ],
)
def test_a_search_for_nothing_is_refused(query: str, options: dict[str, object], fault: str) -> None:
    with pytest.raises(LibraryError, match=f"^{fault}: "):
        small(nap()).search(query, **options)  # type: ignore[arg-type]


def test_a_caption_counts_less_than_a_summary() -> None:
    library = small(nap(), nap(id="hands", summary="Hands on belly."))
    hands, own = library.search("hands on belly")
    assert (hands.script.id, hands.score) == ("hands", pytest.approx(1, abs=1e-3))
    assert own.score == pytest.approx(0.7, abs=0.02)


def test_scores_are_rounded_so_that_machines_rank_alike() -> None:
    library = small(nap())
    scores = library.scores(HashingEncoder().encode(["a nap", "a zebra"]))
    assert scores.shape == (2, 1)
    np.testing.assert_array_equal(scores, scores.round(4))


def test_a_rare_word_tells_which_scripts_name_it() -> None:
    library = ScriptLibrary.read(encoder=HashingEncoder())
    named = library.naming("wins the lottery")
    assert 1 <= named.sum() <= 5
    assert all("lottery" in library.scripts[index].summary for index in np.flatnonzero(named))
    assert not library.naming("the character").any()
