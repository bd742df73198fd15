"""The rule-based teller: prose without slips that follows the keyframes."""

from __future__ import annotations

import re
from importlib import resources

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion_backend.motion import Character, Skill
from planner_service.llm.asking import ModelAnswerError
from planner_service.llm.scripted import ScriptedModel
from planner_service.scripts import framing, phrases
from planner_service.scripts.keyframe import Event, Keyframe, LongScript, PlannedKeyframe, Retrieved, ShortScript
from planner_service.scripts.moments import Variety, mood_of, touches
from planner_service.scripts.narrating import Told, narrate
from planner_service.scripts.tense import BASES
from planner_service.scripts.told_by_model import narrate_with_model

LIBRARY = tuple(
    ShortScript.model_validate_json(line)
    for line in resources.files("planner_service")
    .joinpath("data/short_scripts.jsonl")
    .read_text(encoding="utf-8")
    .splitlines()
)
BY_ID = {script.id: script for script in LIBRARY}
PEOPLE = (Character("Sam", "they"), Character("Emily", "she"), Character("James", "he"))
EVENTS = ("finds the lost ring and becomes excited", "is told on the phone that he fails", "relaxes at home")
SLIPS = {
    "two spaces": r"  ",
    "a space before a mark": r" [.,;:!?]",
    "two marks": r"[.,;:!?][.,;:]",
    "a doubled word": r"\b(\w+) \1\b",
    "they with a singular verb": r"\bthey (?:was|has|is)\b",
    "one person with a plural verb": r"\b(?:he|she|Sam|Emily|James) (?:were|are|have)\b",
    "a before a vowel": r"\ba [aeio]\w+",
    "an before a consonant": r"\ban [^aeiouh\W]",
    "an unresolved mention": r"(?i)\b(?:the|a) character\b",
    "a blank": r"[{}~_⟦⟧]",
    "a sentence without a capital": r"(?:^|[.!?] |\n)[a-z]",
    "a capital inside": r"[a-z,] (?:He|She|They|His|Her|Their|The|Then)\b",
    "across across": r"\bcross(?:ed|ing) (?:over|across|to the \w+ to)",
    "a wrong case": r"\b(?:to|on|with|over) (?:he|they)\b",
}


def long_script(
    chosen: list[ShortScript], events: list[str] | None = None, theme: str = "A person spends a day."
) -> LongScript:
    """Short scripts one after the other, with the rising in between that a body needs."""
    told = [Event(text=text) for text in events or [script.summary for script in chosen]]
    keyframes: list[PlannedKeyframe] = []
    for number, script in enumerate(chosen):
        last = keyframes[-1] if keyframes else None
        if last is not None and last.skill in (Skill.SITDOWN, Skill.LIEDOWN):
            skill = Skill.STANDUP if last.skill == Skill.SITDOWN else Skill.GETUP
            keyframes.append(PlannedKeyframe(skill=skill, caption="get up", furniture=last.furniture, room=last.room))
        keyframes += [
            PlannedKeyframe(**k.model_dump(), short_script=number, event=number, room=script.room)
            for k in script.keyframes
        ]
    found = tuple(Retrieved(script=script, event=number, score=0.5) for number, script in enumerate(chosen))
    return LongScript(theme=theme, events=tuple(told), short_scripts=found, keyframes=tuple(keyframes))


stories = st.lists(st.sampled_from(LIBRARY), min_size=1, max_size=5, unique=True).map(long_script)


def slips(text: str) -> list[str]:
    return [f"{kind}: {found[0]!r}" for kind, pattern in SLIPS.items() if (found := re.search(pattern, text))]


def spoken(told: Told) -> list[int]:
    return [index for span in told.spans for index in span.keyframes]


@settings(max_examples=150, deadline=None)
@given(stories, st.sampled_from(PEOPLE), st.integers(0, 9))
def test_no_story_has_a_slip_of_grammar(script: LongScript, person: Character, seed: int) -> None:
    told = narrate(script, person, seed)
    assert slips(told.text) == [], told.text
    assert person.name in told.text


@pytest.mark.parametrize("person", PEOPLE, ids=lambda person: person.pronouns)
def test_every_short_script_is_told_without_a_slip(person: Character) -> None:
    found = {s.id: slips(narrate(long_script([s]), person, 1).text) for s in LIBRARY}
    assert {name: problems for name, problems in found.items() if problems} == {}


@settings(max_examples=40, deadline=None)
@given(stories, st.integers(0, 9))
def test_spans_tell_every_keyframe_once_and_in_order(script: LongScript, seed: int) -> None:
    told = narrate(script, PEOPLE[0], seed)
    assert spoken(told) == list(range(len(script.keyframes)))
    bounds = [bound for span in told.spans for bound in (span.start, span.end)]
    assert bounds == sorted(bounds)
    assert all(told.text[span.start : span.end].strip() for span in told.spans)
    assert bounds[-1] <= len(told.text)


@settings(max_examples=20, deadline=None)
@given(stories, st.integers(0, 9))
def test_a_span_of_use_names_the_furniture_or_what_stands_for_it(script: LongScript, seed: int) -> None:
    places = {index: (f"thing{index}", "hall") for index in range(len(script.keyframes))}
    told = narrate(script, PEOPLE[1], seed, places)
    for span in told.spans:
        last = script.keyframes[span.keyframes[-1]]
        if last.skill == Skill.LOCO and not last.on_floor:
            assert f"the thing{span.keyframes[-1]}" in told.text[span.start : span.end]


def test_the_same_seed_tells_the_same_story_and_another_seed_another() -> None:
    script = long_script(list(LIBRARY[:4]))
    one, same, other = (narrate(script, PEOPLE[2], seed) for seed in (3, 3, 4))
    assert one == same
    assert one.text != other.text


def test_a_story_has_a_paragraph_for_every_short_script_and_a_fitting_length() -> None:
    told = narrate(long_script(list(LIBRARY[10:60:12])), PEOPLE[1])
    assert len(told.text.split("\n\n")) == 5
    assert 120 <= len(told.text.split()) <= 360


@settings(max_examples=20, deadline=None)
@given(stories, st.integers(0, 9))
def test_no_sentence_is_told_twice_in_a_story(script: LongScript, seed: int) -> None:
    sentences = re.split(r"(?<=[.!?])\s+", narrate(script, PEOPLE[1], seed).text)
    long = [sentence for sentence in sentences if len(sentence.split()) > 4]
    assert len(set(long)) == len(long)


def test_the_themes_own_words_open_an_event_that_the_summary_does_not_cover() -> None:
    chosen = [BY_ID["folding-the-laundry"], BY_ID["insulting-email"]]
    script = long_script(chosen, ["wins the lottery", "is told on the phone that he fails the job interview"])
    text = narrate(script, PEOPLE[2]).text
    assert "won the lottery." in text
    assert "James was told on the phone that he failed the job interview." in text


def test_an_event_without_a_short_script_is_told_in_its_place() -> None:
    script = long_script(
        [BY_ID["folding-the-laundry"], BY_ID["insulting-email"]], ["irons a shirt", "misses the bus", "reads mail"]
    )
    keyframes = tuple(k.model_copy(update={"event": 2}) if k.event == 1 else k for k in script.keyframes)
    text = narrate(script.model_copy(update={"keyframes": keyframes}), PEOPLE[1]).text
    assert re.search(r"Emily missed the bus\..*insulting", text, re.DOTALL)


def test_falling_asleep_is_told_last() -> None:
    text = narrate(long_script([BY_ID["falling-asleep-after-a-long-day"]]), PEOPLE[1]).text
    assert text.index("bed") < text.index("fell asleep")


def test_a_direct_script_without_short_scripts_is_told_from_its_events() -> None:
    keyframes = tuple(
        PlannedKeyframe(**k.model_dump(), event=0, room="bedroom") for k in BY_ID["reading-in-bed"].keyframes
    )
    script = LongScript(
        theme="She rests.", events=(Event(text="rests"),), short_scripts=(), keyframes=keyframes, method="direct"
    )
    told = narrate(script, PEOPLE[1])
    assert "Emily rested." in told.text
    assert spoken(told) == list(range(len(keyframes)))


@pytest.mark.parametrize("caption", ["swaying like seaweed", "yodelling", "hands in the air"])
@pytest.mark.parametrize("skill", list(Skill))
def test_unknown_captions_are_told_by_their_mood(skill: Skill, caption: str) -> None:
    keyframe = PlannedKeyframe(skill=skill, caption=caption, emotion="sad", furniture="bed")
    script = LongScript(theme="Grief.", events=(), short_scripts=(), keyframes=(keyframe,))
    told = narrate(script, PEOPLE[0])
    assert slips(told.text) == []
    assert spoken(told) == [0]


def test_every_caption_has_its_own_words_and_every_phrase_starts_with_a_verb() -> None:
    captions = {(k.skill, k.caption) for script in LIBRARY for k in script.keyframes}
    tables = {Skill.LOCO: phrases.WALKS, Skill.SITDOWN: phrases.SITS, Skill.LIEDOWN: phrases.LIES}
    for skill, table in tables.items():
        assert {caption for of, caption in captions if of == skill} == set(table)
    walks = [*phrases.WALKS.values(), *phrases.WALKS_IN_MOOD.values()]
    templates = [t for walk in walks for t in (*walk.to, *walk.about)]
    for table in (phrases.SITS_IN_MOOD, phrases.LIES_IN_MOOD, phrases.RISES, phrases.TOUCHES, phrases.TOUCHES_AT):
        templates += [t for ways in table.values() for t in ways]
    verbs = {verb for t in templates for verb in re.findall(r"(?:^|~)(\w+)", t)}
    assert verbs - BASES == set()


def test_variety_uses_every_option_before_any_again() -> None:
    variety = Variety(5)
    assert sorted(variety.pick("abcdef") for _ in range(6)) == list("abcdef")


def test_a_touch_is_worded_by_height_and_furniture() -> None:
    high, low, prone = "An act of reaching high", "touch low height", "Low touch from a prone position"
    assert "under" in touches(Keyframe(skill=Skill.TOUCH, caption=low, furniture="bed"))[0]
    assert "shelf" in touches(Keyframe(skill=Skill.TOUCH, caption=high, furniture="wardrobe"))[0]
    assert "crouch" in touches(Keyframe(skill=Skill.TOUCH, caption=prone, furniture="lamp"))[0]


@pytest.mark.parametrize(
    ("emotion", "mood"),
    [("neutral, calm", "neutral"), ("tired, sad", "sad"), ("happy, childish", "happy"), ("zzz", "neutral")],
)
def test_the_mood_of_a_keyframe_is_one_emotion(emotion: str, mood: str) -> None:
    assert mood_of(Keyframe(skill=Skill.LOCO, caption="walk", emotion=emotion)) == mood


@pytest.mark.parametrize(
    ("theme", "title"),
    [
        ("He wins the lottery.", "The Winning Ticket"),
        ("A person is told on the phone that he fails the job interview.", "The Job Interview"),
        ("Somebody enjoys an afternoon.", "An Afternoon at Home"),
    ],
)
def test_a_title_comes_from_the_theme(theme: str, title: str) -> None:
    assert framing.title_of(theme, "relaxed") == title


def test_a_models_story_is_tied_to_the_keyframes_by_its_furniture() -> None:
    script = long_script([BY_ID["reading-in-bed"]])
    text = "Emily reached for the nightstand. She lay down on the bed and read a very good book until dusk. She got up."
    model = ScriptedModel([{"title": "A Good Book", "text": text}])
    told = narrate_with_model(script, PEOPLE[1], model)
    assert told.title == "A Good Book"
    assert spoken(told) == list(range(len(script.keyframes)))
    assert text[told.spans[1].start : told.spans[1].end].startswith("She lay down on the bed")
    assert "Emily" in model.calls[0].prompt


def test_a_model_that_writes_no_story_is_refused() -> None:
    model = ScriptedModel(["no", "no", "no"])
    with pytest.raises(ModelAnswerError, match="no usable"):
        narrate_with_model(long_script([LIBRARY[0]]), PEOPLE[0], model)
