"""Finding short scripts: by shared words, by meaning, and by both together."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.keyword_index import KeywordIndex, stems
from planner_service.scripts.script import EMOTIONS, ShortScript
from planner_service.scripts.script_library import Features, LibraryError, ScriptLibrary
from planner_service.scripts.script_search import rank
from scene_graphs.furniture import ROOM_TYPES, categories_of

TEXTS = ["eats a warm soup", "writes a long letter at the desk", "writes", "naps"]
SAID = ("eats", "a", "warm", "soup", "writes", "long", "letter", "desk", "naps", "zebra")
WORDS = st.lists(st.sampled_from(SAID), min_size=1).map(" ".join)


@cache
def ours() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


def script(number: int, summary: str = "", **more: object) -> ShortScript:
    keyframe = {"skill": "sitdown", "caption": f"hands on thighs {number}", "furniture": "chair"}
    told = {"id": f"s{number}", "summary": summary or f"The character does thing {number}."}
    row = {"emotion": "neutral", "room": "study", "keyframes": [keyframe]}
    return ShortScript.model_validate(row | told | more)


def small(*scripts: ShortScript) -> ScriptLibrary:
    return ScriptLibrary(scripts, Features(HashingEncoder()))


# Shared words.


def test_the_forms_of_a_word_are_one_word() -> None:
    assert stems("She drinks") == stems("she drank")
    assert stems("Running children") == stems("runs, child")
    assert stems("recieves zxqv") == ["recieve", "zxqv"]


def test_the_text_with_the_rarest_shared_word_is_first_and_an_unshared_one_gets_nothing() -> None:
    index = KeywordIndex(TEXTS)
    (scores,) = index.scores(["a soup"])
    assert scores.argmax() == 0
    assert scores[2] == scores[3] == 0
    assert index.scores(["nothing shared here"]).max() == 0


def test_of_texts_with_the_same_words_the_shorter_is_first() -> None:
    (scores,) = KeywordIndex(TEXTS).scores(["writing"])
    assert scores[2] > scores[1] > scores[0]


@tries(60)
@given(WORDS, WORDS)
def test_scores_lie_between_nothing_and_one_and_do_not_depend_on_order_or_on_other_queries(one: str, two: str) -> None:
    index = KeywordIndex(TEXTS)
    scores = index.scores([one, two])
    assert scores.shape == (2, len(TEXTS))
    assert scores.min() >= 0
    assert scores.max() < 1
    np.testing.assert_array_equal(scores, scores.round(4))
    turned = " ".join(reversed(one.split()))
    np.testing.assert_array_equal(index.scores([turned])[0], scores[0])


@given(WORDS)
def test_a_word_that_no_text_has_lowers_all_and_changes_no_order(query: str) -> None:
    index = KeywordIndex(TEXTS)
    (with_it,), (without,) = index.scores([f"{query} xylophone"]), index.scores([query])
    assert (with_it <= without).all()
    assert (with_it[without > 0] < without[without > 0]).all()


def test_no_texts_and_no_words_have_no_scores() -> None:
    assert KeywordIndex([]).scores(["a soup"]).shape == (1, 0)
    assert KeywordIndex(["", "..."]).scores(["a soup", "?"]).tolist() == [[0, 0], [0, 0]]


# Both together.


def test_each_query_is_ranked_as_it_is_alone_from_nothing_to_one() -> None:
    queries = ["hits the sack", "writes a letter", "?"]
    scores = rank(queries, ours())
    assert scores.shape == (3, len(ours()))
    assert 0 <= scores.min() <= scores.max() <= 1
    np.testing.assert_array_equal(scores, scores.round(4))
    for query, row in zip(queries, scores, strict=True):
        np.testing.assert_array_equal(rank([query], ours())[0], row)
    np.testing.assert_array_equal(rank(queries, ours(), HashingEncoder().encode(queries)), scores)


def test_a_summary_finds_its_own_script_first() -> None:
    sample = range(0, len(ours()), 10)
    scores = rank([ours().scripts[index].summary for index in sample], ours())
    assert scores.argmax(axis=1).tolist() == list(sample)


def test_a_cue_finds_its_script_though_the_summary_shares_no_word() -> None:
    library = small(script(1), script(2, cues=["hits the sack"]), script(3))
    assert library.search("she hits the sack", k=1)[0].script.id == "s2"


def test_among_equals_the_first_id_comes_first() -> None:
    same = [script(number, "The character naps.") for number in (3, 1, 2)]
    assert [found.script.id for found in small(*same).search("a nap", k=3)] == ["s1", "s2", "s3"]


def test_furniture_that_is_asked_for_is_used_by_all_that_is_found() -> None:
    found = ours().search("sits and thinks", k=30, furniture=("desk", "chair"))
    assert found
    for one in found:
        used = set().union(*(categories_of(keyframe.piece[0]) for keyframe in one.script.keyframes))
        assert used & categories_of("desk")
        assert used & categories_of("chair")
    with pytest.raises(LibraryError, match=r"^furniture: 'throne' is not known"):
        ours().search("sits", furniture=("throne",))


def test_emotions_and_rooms_are_those_of_the_scripts() -> None:
    for index, one in enumerate(ours().scripts[::9]):
        assert EMOTIONS[ours().emotions[index * 9]] == one.emotion
        assert ROOM_TYPES[ours().rooms[index * 9]] == one.room
