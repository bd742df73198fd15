"""The caption vocabulary: other words for every caption, and the known caption that is nearest to any other."""

from __future__ import annotations

import itertools
import re

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from layers import sampled

from motion_backend.language.sentence_encoder import HashingEncoder, load_encoder
from motion_backend.motion import Emotion, Skill
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.captions import Vocabulary, agree, captions, sides, synonyms
from planner_service.scripts.script import EMOTIONS

KNOWN, OTHERS = captions(), synonyms()
ALL = [(Skill(skill), caption) for skill, some in KNOWN.items() for caption in some]
WORDS = Vocabulary.built_in(HashingEncoder())
SKILLS = st.sampled_from(Skill)


def test_every_caption_has_five_other_ways_to_say_it() -> None:
    assert {skill: list(others) for skill, others in OTHERS.items()} == KNOWN
    for skill, others in OTHERS.items():
        told = [text.lower() for caption, some in others.items() for text in (caption, *some)]
        assert len(set(told)) == len(told) == 6 * len(KNOWN[skill])


def test_other_words_keep_hands_and_sides() -> None:
    for others in OTHERS.values():
        for caption, some in others.items():
            for text in some:
                assert sides(text) - {"both"} == sides(caption) - {"both"}, text
                assert "both" not in sides(caption) or "both" in sides(text), text


def test_no_caption_names_both_hands_and_one() -> None:
    for _, caption in ALL:
        assert "both" not in sides(caption) or len(sides(caption)) == 1, caption


@for_each(
    ("caption", "named"),
    [
        ("typing, both hands on the keyboard", {"both"}),
        ("wash with two hands", {"both"}),
        ("side lie on left, right hand on belly", {"left", "right"}),
        ("sit upright with hands on thighs", set()),
        ("Left hand up", {"left"}),
    ],
)
def test_the_sides_of_a_caption_are_read(caption: str, named: set[str]) -> None:
    assert sides(caption) == named


@given(
    SKILLS, st.text(max_size=60) | st.sampled_from(["left hand", "with the right hand", "both hands up", "sit left"])
)
@tries(80)
def test_the_nearest_caption_is_known_for_the_skill_and_never_changes_sides(skill: Skill, caption: str) -> None:
    nearest, score = WORDS.nearest(skill, caption)
    assert WORDS.known(skill, nearest)
    assert agree(caption, nearest)
    assert -1 <= score <= 1
    assert round(score, 4) == score
    assert WORDS.nearest(skill, caption) == (nearest, score)


@pytest.mark.parametrize("most", sampled([1, 5], 2))
def test_what_is_known_and_its_other_words_are_nearest_to_themselves(most: int) -> None:
    for skill, caption in ALL:
        assert WORDS.known(skill, caption)
        assert WORDS.nearest(skill, caption) == (caption, 1.0)
        for text in OTHERS[skill][caption][:most]:
            assert WORDS.nearest(skill, f"  {text.upper()}!") == (caption, 1.0)


def test_other_words_lead_back_to_their_caption_when_they_were_never_seen() -> None:
    """Half of them held out, hashed words alone: most come home, and what does not keeps its sides."""
    kept = {skill: {caption: some[:3] for caption, some in others.items()} for skill, others in OTHERS.items()}
    words = Vocabulary(KNOWN, kept, HashingEncoder())
    held_out = [(Skill(k), c, text) for k, others in OTHERS.items() for c, some in others.items() for text in some[3:]]
    home = [words.nearest(skill, text)[0] == caption for skill, caption, text in held_out]
    assert sum(home) / len(home) > 0.5


@for_each(
    ("skill", "caption", "nearest"),
    [
        ("loco", "tiptoe quietly", "walk on tiptoes"),
        ("sitdown", "drinking coffee", "drinking from a cup in the right hand"),
        ("sitdown", "typing an email on the laptop", "typing, both hands on the keyboard"),
        ("touch", "grab the keys with the left hand", "pick up with the left hand"),
        ("touch", "wipe the table with both hands", "wash with both hands"),
        ("getup", "jump out of bed", "get up quickly"),
    ],
)
def test_captions_in_other_words_are_understood(skill: str, caption: str, nearest: str) -> None:
    assert WORDS.nearest(Skill(skill), caption)[0] == nearest


def test_a_sentence_encoder_finds_what_shares_no_word() -> None:
    encoder = load_encoder("minilm")
    if encoder.name == "hashing":
        pytest.skip("all-MiniLM-L6-v2 is not installed")
    few = {"sitdown": ["drinking from a cup in the right hand", "reading, book held in both hands", "crossing arms"]}
    words = Vocabulary(few, {}, encoder)
    for caption, nearest in (("sipping hot cocoa", few["sitdown"][0]), ("leafing through a novel", few["sitdown"][1])):
        assert words.nearest(Skill.SITDOWN, caption)[0] == nearest


@pytest.mark.parametrize("caption", ["yodelling", "quantum flux", "ascending by helicopter"])
def test_nonsense_is_near_to_nothing(caption: str) -> None:
    assert WORDS.nearest(Skill.LOCO, caption)[1] < WORDS.least


def test_a_vocabulary_without_the_side_says_so() -> None:
    words = Vocabulary({"touch": ["with the left hand"]}, {}, HashingEncoder())
    with pytest.raises(ValueError, match=r"^caption: no caption of touch .*; add one"):
        words.nearest(Skill.TOUCH, "with the right hand")
    with pytest.raises(ValueError, match=r"^caption: no caption of loco"):
        words.nearest(Skill.LOCO, "walk")


@for_each("caption", ["", "slowly", "suddenly", "high, left hand", "low with the right hand", "both hands"])
def test_the_usual_caption_is_known_and_keeps_the_side(caption: str) -> None:
    for skill, mood in itertools.product(Skill, EMOTIONS):
        found = usual(skill, mood, caption)
        assert found in KNOWN[skill]
        assert agree(caption, found)


def test_the_usual_touch_keeps_its_height_and_hand() -> None:
    assert (
        usual(Skill.TOUCH, Emotion.SAD, "juggle high up with the left hand")
        == "An act of reaching high with the left hand"
    )
    assert usual(Skill.TOUCH, Emotion.SAD, "juggle under it") == "touch low height"


def test_captions_are_plain_words() -> None:
    assert all(re.fullmatch(r"[A-Za-z][A-Za-z, '-]+", text) for _, text in ALL)
    assert all(re.fullmatch(r"[A-Za-z][A-Za-z, '-]+", t) for o in OTHERS.values() for some in o.values() for t in some)
