"""Themes become long scripts that cover their events in order."""

from __future__ import annotations

import re

import pytest
from encoded import encoded
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from themes import THEMES, Theme

from motion_backend.language.sentence_encoder import HashingEncoder, SentenceEncoder
from planner_service.composition.compose import compose
from planner_service.composition.request import Request
from planner_service.llm.fake_model import ScriptedModel
from planner_service.llm.protocol import ModelError
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import LongScript
from planner_service.scripts.script_embeddings import load_by_heart
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.scripts.script_repair import check
from planner_service.themes.beats import ThemeError

HASHING = ScriptLibrary(built_in(), Features(HashingEncoder()))
THEME = THEMES[5].text


@pytest.fixture(scope="module")
def meaning() -> ScriptLibrary:
    """The library with the real encoder, where its weights are installed."""
    encoder: SentenceEncoder = load_by_heart(encoded())
    if encoder.name == "hashing":
        pytest.skip("the MiniLM weights are not installed")
    return ScriptLibrary(built_in(), Features(encoder, encoded()))


def covers(script: LongScript, theme: Theme) -> None:
    """Every expected event is there, in order, felt rightly, played by a fitting script, and acted in that order."""
    for event, wanted in zip(script.beats, theme.events, strict=True):
        assert all(word in event.text for word in wanted.words), (event.text, wanted.words)
        assert event.emotion in wanted.emotions, event
    assert script.acted == script.asked
    served = [chosen.beat for chosen in script.short_scripts]
    assert served == sorted(served)
    assert set(served) == set(range(len(theme.events)))
    acted = [keyframe.beat for keyframe in script.keyframes if keyframe.beat is not None]
    assert acted == sorted(acted)
    assert set(acted) == set(range(len(theme.events)))
    for chosen in script.short_scripts:
        told = " / ".join([chosen.script.summary, *(keyframe.caption for keyframe in chosen.script.keyframes)])
        assert re.search(theme.events[chosen.beat].played, told), (script.beats[chosen.beat].text, told)


@pytest.mark.parametrize("theme", THEMES, ids=lambda theme: theme.name)
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.sweep) for seed in (1, 2))])
def test_a_theme_of_the_paper_is_covered_event_by_event_in_order(
    meaning: ScriptLibrary, theme: Theme, seed: int
) -> None:
    script = compose(theme.text, meaning, request=Request(seed=seed))
    covers(script, theme)
    assert not check(script)
    assert script.planner == "rules"
    assert script.encoder == "all-MiniLM-L6-v2"


@for_each("theme", THEMES)
def test_the_hashing_encoder_finds_the_same_events_and_says_that_it_ranked(theme: Theme) -> None:
    script = compose(theme.text, HASHING)
    assert [event.emotion in wanted.emotions for event, wanted in zip(script.beats, theme.events, strict=True)]
    assert {chosen.beat for chosen in script.short_scripts} == set(range(len(theme.events)))
    assert not check(script)
    assert script.encoder == "hashing"


def test_the_same_seed_gives_the_same_script_and_seeds_differ() -> None:
    theme = THEMES[5].text
    scripts = [compose(theme, HASHING, request=Request(seed=seed)) for seed in range(8)]
    assert compose(theme, HASHING, request=Request(seed=3)) == scripts[3]
    assert len({tuple(chosen.script.id for chosen in script.short_scripts) for script in scripts}) > 1


@for_each("count", [1, 2, 4, 9, 12])
def test_as_many_short_scripts_as_asked_for_are_used_and_none_twice(count: int) -> None:
    script = compose(THEME, HASHING, request=Request(short_scripts=count))
    ids = [chosen.script.id for chosen in script.short_scripts]
    assert len(ids) == len(set(ids)) == count
    played = {chosen.beat for chosen in script.short_scripts}
    assert len(played) == min(count, len(script.beats))
    assert [not beat.why for beat in script.beats] == [place in played for place in range(len(script.beats))]
    assert not check(script)


def test_one_event_still_gets_two_short_scripts() -> None:
    assert len(compose("A person enjoys a relaxed afternoon at home.", HASHING).short_scripts) == 2


def test_rooms_that_are_asked_for_are_kept_to() -> None:
    script = compose(THEME, HASHING, request=Request(rooms=("living room", "bedroom")))
    assert {chosen.script.room for chosen in script.short_scripts} <= {"living_room", "bedroom"}


def test_a_room_the_theme_names_is_preferred(meaning: ScriptLibrary) -> None:
    for name, room in (("study", "study"), ("bedroom", "bedroom"), ("living room", "living_room")):
        script = compose(f"She reads a book in the {name}.", meaning)
        assert script.short_scripts[0].script.room == room


def test_every_keyframe_knows_its_room_and_the_script_it_came_from() -> None:
    script = compose(THEME, HASHING)
    for keyframe in script.keyframes:
        assert keyframe.room is not None
        if keyframe.short_script is not None:
            source = script.short_scripts[keyframe.short_script].script
            assert keyframe.caption in {own.caption for own in source.keyframes} | {"get up"}


def test_an_event_nothing_is_about_is_listed_and_the_rest_is_played(meaning: ScriptLibrary) -> None:
    script = compose("He reads a book. Quantum chromodynamics governs black holes. He falls asleep.", meaning)
    assert tuple(beat.text for beat in script.beats if beat.why) == ("Quantum chromodynamics governs black holes",)
    assert {chosen.beat for chosen in script.short_scripts} == {0, 2}


@pytest.mark.parametrize("theme", ["asdf qwer zxcv", "qwertz uiop", "🚀🚀 blorf"])
def test_nonsense_is_refused_with_what_was_not_understood_and_examples(meaning: ScriptLibrary, theme: str) -> None:
    for library in (HASHING, meaning):
        with pytest.raises(ThemeError, match=r"Try for example: A person") as error:
            compose(theme, library)
        assert theme.split()[-1] in str(error.value)


@for_each(
    "theme",
    [
        "Eine Frau kommt müde nach Hause und liest ein Buch.",
        "Une femme rentre et dort.",
        "彼女は本を読む。",
        "日本語の物語",
    ],
)
def test_a_theme_in_another_language_is_refused_and_told_that_english_is_read(
    meaning: ScriptLibrary, theme: str
) -> None:
    with pytest.raises(ThemeError, match=r"Themes are read in English\. Try for example: A person"):
        compose(theme, meaning)


@for_each("theme", ["", "  \n ", "x" * 2001, "a\x00b", "12 34 !!", "\ud800 sits"])
def test_what_is_no_theme_is_refused(theme: str) -> None:
    with pytest.raises(ThemeError, match=r"^theme: "):
        compose(theme, HASHING)


def test_wrong_requests_name_the_field() -> None:
    for wrong, field in (
        ({"short_scripts": 0}, "short_scripts"),
        ({"rooms": ("attic",)}, "rooms"),
        ({"method": "x"}, "method"),
    ):
        with pytest.raises(ValueError, match=field):
            Request(**wrong)


WORDS = """he she becomes drunk sad and then but , . when before after reads a book the sofa sleeps not very because
wine so"""


@tries(40)
@given(st.lists(st.sampled_from(WORDS.split()), min_size=1, max_size=25))
def test_any_string_of_words_gives_an_executable_script_or_a_clear_refusal(words: list[str]) -> None:
    try:
        script = compose(" ".join(words), HASHING)
    except ThemeError:
        return
    assert script.keyframes
    assert not check(script)


# With a language model.

EVENTS = {"events": [{"text": "searches for the jewellery under the bed", "emotion": "hurried"},
                     {"text": "finds the jewellery", "emotion": "happy"}]}  # fmt: skip


def arranged(prompt: str) -> dict[str, object]:
    """The first two offers for the events, read off the prompt as a model would."""
    offers = re.findall(r"event (\d+):\n  (\S+) ", prompt)
    return {"choices": [{"event": int(event), "script": script} for event, script in offers]}


def test_a_model_plans_the_events_and_arranges_summaries_without_seeing_keyframes() -> None:
    model = ScriptedModel(lambda prompt, schema: EVENTS if schema.__name__ == "PlannedEvents" else arranged(prompt))
    script = compose(THEME, HASHING, model=model)
    assert script.planner == "llm:scripted"
    assert [event.text for event in script.beats] == [event["text"] for event in EVENTS["events"]]
    assert [chosen.beat for chosen in script.short_scripts] == [0, 1]
    assert not any("caption" in call.prompt or "walk with" in call.prompt for call in model.calls)


def test_a_model_that_makes_up_scripts_is_told_and_then_the_rules_take_over() -> None:
    made_up = {"choices": [{"event": 0, "script": "made-up"}, {"event": 1, "script": "too"}]}
    model = ScriptedModel([EVENTS, made_up, made_up, made_up])
    script = compose(THEME, HASHING, model=model)
    assert "'made-up' was not offered for event 0" in model.calls[2].prompt
    assert script.planner == "llm:scripted, rules"
    assert "short scripts arranged by rules" in script.repairs[0]
    assert len(script.short_scripts) == 2


@for_each("answer", ["", "no idea", '{"events": [', '{"events": []}', {"x": 1}, ModelError("no connection")])
def test_a_model_without_usable_answers_leaves_the_rules_script(answer: str) -> None:
    model = ScriptedModel(lambda prompt, schema: answer)  # noqa: ARG005
    script = compose(THEME, HASHING, model=model)
    assert script.planner == "rules"
    assert script.keyframes == compose(THEME, HASHING).keyframes


def test_direct_generation_by_a_model_is_repaired_until_it_can_be_acted() -> None:
    sits = {"skill": "sit", "emotion": "sad", "caption": "head bowed", "furniture": "couch"}
    walks = {"skill": "walk", "emotion": "drunk", "caption": "walking drunkenly", "furniture": "floor"}
    written = {"keyframes": [sits, walks]}
    script = compose(THEME, HASHING, Request(method="direct"), ScriptedModel([written]))
    assert [str(keyframe.skill) for keyframe in script.keyframes] == ["loco", "sitdown", "standup", "loco"]
    assert (script.method, script.planner, len(script.repairs)) == ("direct", "llm:scripted", 2)


@for_each("theme", THEMES)
def test_direct_generation_by_rules_plays_every_event_in_order(theme: Theme) -> None:
    script = compose(theme.text, HASHING, request=Request(method="direct"))
    events = [keyframe.beat for keyframe in script.keyframes if keyframe.beat is not None]
    assert events == sorted(events)
    assert set(events) == set(range(len(theme.events)))
    assert not check(script)
    assert (script.method, script.planner, script.short_scripts) == ("direct", "rules", ())
