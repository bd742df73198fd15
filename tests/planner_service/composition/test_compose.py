"""Themes become long scripts that a body can act out, by each of the three methods, with a model or without."""

from __future__ import annotations

from functools import cache

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from seven_themes import SEVEN

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.composition.compose import compose, script_of
from planner_service.composition.request import METHODS, Method, Request
from planner_service.llm.fake_model import ScriptedModel
from planner_service.llm.protocol import ModelError
from planner_service.scripts.acted_beats import planned_beats
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import REACTED, Keyframe, LongScript
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.scripts.script_repair import check
from planner_service.themes.beats import ThemeError

PLAIN = (
    "A woman reads a book on the sofa.",
    "He wakes up, makes coffee and drinks it.",
    "Anna cannot sleep. She gets up and paces around the bedroom.",
    "An old man waters the plants and dances.",
    "She comes home, takes off her coat and falls asleep.",
    "A boy plays a video game until his mother calls. He does not eat.",
    "The writer sits at the desk and types. Then he stares out of the window.",
    "He is angry and stomps around the living room.",
    "She searches for her keys, finds them on the table and laughs.",
    "A student studies in the kitchen instead of sleeping.",
    "He eats dinner and washes the dishes.",
    "She listens to music and cries.",
    "Before going to bed, he folds his shirts.",
    "He stumbles home drunk and collapses on the bed.",
    "A nurse sits down, takes a deep breath and meditates.",
    "Tom plays the piano while his brother sleeps.",
    "She phones her friend and walks up and down.",
    "He tidies the living room without sitting down.",
    "I write a letter. I am sad.",
    "She washes the dishes because guests arrive, and she yawns.",
)
THEME = SEVEN["jewellery"]


@cache
def hashing() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


def planned(theme: str, method: Method = "auto", **asked: object) -> LongScript:
    return compose(theme, hashing(), Request(method=method, **asked))  # type: ignore[arg-type]


@for_each("theme", PLAIN)
@for_each("method", METHODS)
def test_every_method_plans_a_script_that_can_be_acted_and_counts_its_beats(method: Method, theme: str) -> None:
    script = planned(theme, method)
    assert script.keyframes
    assert not check(script)
    assert (script.method, script.planner, script.theme) == (method, "rules", theme)
    served = {beat for keyframe in script.keyframes for beat in (keyframe.beat, *keyframe.also) if beat is not None}
    assert served <= set(range(len(script.beats)))
    shown = [beat for beat in script.beats if beat.kind != "undone" and not beat.why]
    assert script.acted == sum(not beat.stood_for for beat in shown)
    assert script.asked == sum(beat.kind != "undone" and not beat.why.startswith(REACTED) for beat in script.beats)
    assert script.acted == planned_beats(script).acted
    assert shown


@for_each("theme", PLAIN)
def test_the_default_method_says_why_it_leaves_a_beat_out(theme: str) -> None:
    script = planned(theme)
    assert script.encoder == "hashing"
    assert all(beat.why for beat in script.beats if beat.kind in ("undone", "other", "speech", "memory"))
    assert all(0 <= chosen.beat < len(script.beats) and chosen.score <= 1 for chosen in script.short_scripts)


@for_each("theme", list(SEVEN.values()))
def test_the_themes_of_the_paper_are_acted_whole_but_for_what_is_remembered_or_learnt(theme: str) -> None:
    script = planned(theme)
    missed = [beat.text for beat in script.beats if beat.why and beat.kind != "memory"]
    assert set(missed) <= {"finds that he won a lottery"}
    assert not check(script)


def test_a_seed_gives_the_same_script_again_and_seeds_differ() -> None:
    scripts = [planned(THEME, seed=seed) for seed in range(5)]
    assert planned(THEME, seed=3).model_dump_json() == scripts[3].model_dump_json()
    assert len({tuple(keyframe.caption for keyframe in script.keyframes) for script in scripts}) > 1


@for_each("theme", ["asdf qwer zxcv", "A banana.", "🚀🚀 blorf", "The universe expands.", "Nobody sits."])
def test_a_theme_of_which_nothing_can_be_acted_is_refused_by_its_words(theme: str) -> None:
    with pytest.raises(ThemeError, match=r"Try for example: A person") as error:
        planned(theme)
    assert theme.rstrip(".").split()[-1] in str(error.value)


@for_each("theme", ["Autumn. Leaves. Wind. Nothing.", "Snow, fog, yellow, music, the sea."])
def test_words_that_tell_of_nobody_and_of_hardly_a_deed_are_refused(theme: str) -> None:
    with pytest.raises(ThemeError, match="it tells of nobody"):
        planned(theme)


@for_each(
    "theme", ["Exhausted. Bed. Lights out.", "Quick lunch, then a nap.", "a very very tired man", "Do ten push-ups."]
)
def test_a_note_of_few_words_is_a_theme(theme: str) -> None:
    assert planned(theme).keyframes


@for_each("theme", ["He does not sit down.", "She never lies down.", "Anna is not sitting."])
def test_somebody_of_whom_it_is_only_told_what_they_do_not_do_is_seen_standing(theme: str) -> None:
    script = planned(theme)
    assert [(keyframe.skill.value, keyframe.caption) for keyframe in script.keyframes] == [("loco", "stand still")]
    assert all(beat.why == "it is not done" for beat in script.beats)


def test_who_has_walked_to_a_piece_of_furniture_does_not_walk_to_it_once_more() -> None:
    script = planned("He cooks in the kitchen, walks to the sofa and lies down on it, tired.")
    assert [keyframe.skill.value for keyframe in script.keyframes] == ["loco", "touch", "loco", "liedown"]


def test_wrong_requests_name_the_field() -> None:
    for wrong, field in (
        ({"short_scripts": 0}, "short_scripts"),
        ({"rooms": ("attic",)}, "rooms"),
        ({"method": "x"}, "method"),
    ):
        with pytest.raises(ValueError, match=field):
            Request(**wrong)


WORDS = """he she becomes drunk sad and then but , . when before after reads a book the sofa sleeps not very because
wine so gets up lies down bed walks"""


@tries(60)
@given(st.lists(st.sampled_from(WORDS.split()), min_size=1, max_size=25), st.sampled_from(METHODS))
def test_any_string_of_words_gives_an_executable_script_or_a_clear_refusal(words: list[str], method: Method) -> None:
    try:
        script = planned(" ".join(words), method)
    except ThemeError:
        return
    assert script.keyframes
    assert not check(script)


def test_keyframes_that_somebody_wrote_are_repaired_and_are_nobodys_plan() -> None:
    written = [Keyframe(skill="sitdown", caption="sitting still", furniture="sofa")]
    script = script_of(written, "t")
    assert [keyframe.skill.value for keyframe in script.keyframes] == ["loco", "sitdown"]
    assert (script.planner, script.beats) == ("given", ())


# With a language model; what it plans for `auto` is tested in test_llm_beats.


@for_each("answer", ["", "no idea", '{"beats": [', '{"beats": []}', {"x": 1}, ModelError("no connection")])
@for_each("method", METHODS)
def test_a_model_without_usable_answers_leaves_the_rules_script(method: Method, answer: str) -> None:
    model = ScriptedModel(lambda _prompt, _schema: answer)
    script = compose(THEME, hashing(), Request(method=method), model)
    assert script.planner == "rules"
    assert script.keyframes == planned(THEME, method).keyframes
    assert "by rules: " in script.repairs[0]


@for_each("method", METHODS)
def test_who_insists_on_a_model_is_told_when_it_fails(method: Method) -> None:
    with pytest.raises(ModelError):
        compose(THEME, hashing(), Request(method=method), ScriptedModel(lambda _prompt, _schema: "no"), insist=True)


def test_direct_generation_by_a_model_is_repaired_until_it_can_be_acted() -> None:
    sits = {"skill": "sit", "emotion": "sad", "caption": "head bowed", "furniture": "couch"}
    walks = {"skill": "walk", "emotion": "drunk", "caption": "walking drunkenly", "furniture": "floor"}
    script = compose(THEME, hashing(), Request(method="direct"), ScriptedModel([{"keyframes": [sits, walks]}]))
    assert [str(keyframe.skill) for keyframe in script.keyframes] == ["loco", "sitdown", "standup", "loco"]
    assert (script.method, script.planner, len(script.repairs)) == ("direct", "llm:scripted", 2)


def test_an_animal_that_is_called_it_is_not_seen() -> None:
    beats = {beat.text: beat.unshown for beat in planned("The cat jumps on the table, so she picks it up.").beats}
    assert beats["picks it up"][:1] in (("it",), ("picks it up",))


@for_each(("theme", "asked"), [("The rain falls. She sweeps.", 1), ("She wants to sleep, but she sweeps.", 1)])
def test_what_happens_or_is_wished_for_is_not_counted_among_what_is_to_be_acted(theme: str, asked: int) -> None:
    assert planned(theme).asked == asked


def test_it_is_said_who_is_played_where_others_do_something() -> None:
    told = {beat.text: beat.why for beat in planned("Ben sweeps the floor. Anna sits at the table.").beats}
    assert told["Anna sits at the table"] == "Anna does it: only Ben is played"
