"""The library of short scripts: what is in it, and finding them."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder, Vectors
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_library import Features, LibraryError, ScriptLibrary

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


def small(*scripts: ShortScript) -> ScriptLibrary:
    """A library of a few scripts."""
    return ScriptLibrary(scripts, Features(HashingEncoder()))


@cache
def ours() -> ScriptLibrary:
    """The library that is shipped."""
    return small(*built_in())


class Counting(HashingEncoder):
    """An encoder that tells how many texts it was given."""

    def __init__(self) -> None:
        super().__init__()
        self.texts = 0

    def encode(self, texts: Sequence[str]) -> Vectors:
        self.texts += len(texts)
        return super().encode(texts)


def test_our_scripts_are_there_and_their_ids_differ() -> None:
    scripts = built_in()
    assert len({script.id for script in scripts}) == len(scripts) >= 100


def test_two_scripts_of_one_id_are_no_library() -> None:
    with pytest.raises(LibraryError, match=r"^id: two short scripts are called 'my-nap'"):
        small(nap(), nap(summary="Another."))


def test_a_script_is_got_by_its_id_or_missed_by_name() -> None:
    library = small(nap())
    assert library.get("my-nap") == nap()
    with pytest.raises(LibraryError, match=r"^id: .*'my-sleep' among the 1"):
        library.get("my-sleep")


@pytest.mark.parametrize("cached", [True, False])
def test_each_sentence_is_encoded_once_though_libraries_follow_each_other(cached: bool, tmp_path: Path) -> None:
    encoder = Counting()
    features = Features(encoder, tmp_path if cached else None)
    first = ScriptLibrary((nap(),), features)
    second = ScriptLibrary((nap(), nap(id="other", summary="Something else.")), features)
    query = HashingEncoder().encode(["naps"])
    first.scores(query)
    before = encoder.texts
    assert second.scores(query)[0, 0] == first.scores(query)[0, 0]
    assert encoder.texts == before + 1


@pytest.mark.sweep
def test_threads_that_search_at_once_find_the_same(tmp_path: Path) -> None:
    library = ScriptLibrary(built_in(), Features(HashingEncoder(), tmp_path))
    queries = [script.summary for script in library.scripts[:40]]
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda query: library.search(query, 3), queries))
    assert found == [ours().search(query, 3) for query in queries]


def test_search_keeps_to_the_emotion_and_room_asked_for() -> None:
    library = ours()
    found = library.search("drinks wine", k=4, emotion="sad", room="living room")
    assert len(found) == 4
    assert {(one.script.emotion, one.script.room) for one in found} == {("sad", "living_room")}
    assert [one.score for one in found] == sorted((one.score for one in found), reverse=True)


@for_each(
    ("query", "options", "fault"),
    [
        ("x", {"emotion": "bored"}, "emotion"),
        ("x", {"room": "attic"}, "room"),
        (" ", {}, "query"),
        ("x", {"k": 0}, "query"),
    ],
)
def test_a_search_for_nothing_is_refused(query: str, options: dict[str, Any], fault: str) -> None:
    with pytest.raises(LibraryError, match=f"^{fault}: "):
        small(nap()).search(query, **options)


def test_a_caption_is_no_text_that_a_script_is_found_by() -> None:
    library = small(nap(), nap(id="hands", summary="Hands on belly."))
    (scores,) = library.scores(HashingEncoder().encode(["hands on belly"]))
    assert scores[0] < 0.5 < scores[1] == 1


def test_scores_are_rounded_so_that_machines_rank_alike() -> None:
    library = small(nap())
    scores = library.scores(HashingEncoder().encode(["a nap", "a zebra"]))
    assert scores.shape == (2, 1)
    np.testing.assert_array_equal(scores, scores.round(4))


@for_each("odd", ["\x1b[31mred\x1b[0m", "a\x00b", "a\x9b31mb", "a\u202eb", "# a\n![x](http://evil/)", "a\u2028b"])
def test_what_a_terminal_or_page_would_obey_is_not_kept(odd: str) -> None:
    kept = nap(summary=f"The character naps {odd}", cues=[f"naps {odd}"], licence=f"MIT {odd}")
    for text in (kept.summary, *kept.cues, kept.licence):
        assert text.isprintable()
        assert "  " not in text
