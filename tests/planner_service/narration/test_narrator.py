"""The rule-based teller: prose without slips that follows the keyframes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from importlib import resources
from typing import Any

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.motion import Character, Skill
from planner_service.llm.fake_model import ScriptedModel
from planner_service.llm.structured_output import ModelAnswerError
from planner_service.narration.keyframe_phrases import Variety, templates, touches
from planner_service.narration.llm_narrator import narrate_with_model
from planner_service.narration.narrator import Told, narrate
from planner_service.narration.openings_and_endings import title_of
from planner_service.scripts.script import Beat, Keyframe, LongScript, PlannedKeyframe, Retrieved, ShortScript
from planner_service.themes.lexicon import english_verbs, past, third_person

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
    "they with a singular verb": r"\b[Tt]hey (?:was|has|is)\b",
    "one person with a plural verb": r"\b(?:[Hh]e|[Ss]he|Sam|Emily|James) (?:were|are|have)\b",
    "a before a vowel": r"\ba [aeio]\w+",
    "an before a consonant": r"\ban [^aeiouh\W]",
    "an unresolved mention": r"(?i)\b(?:the|a) character\b",
    "a blank": r"[{}~_⟦⟧]",
    "a sentence without a capital": r"(?:^|[.!?] |\n)[a-z]",
    "a capital inside": r"[a-z,] (?:He|She|They|His|Her|Their|The|Then)\b",
    "across across": r"\bcross(?:ed|ing) (?:over|across|to the \w+ to)",
    "a wrong case": r"\b(?:to|on|with|over) (?:he|they)\b",
    "a sentence without an end": r"[^.!?\n\"”’](?:\n\n|$)",
    "a mark without a space": r"[a-z][.,;!?][A-Za-z]",
    "a verb without a past": r"\w+(?:eed|ppped|steped|niced|ticed up)\b|\b(?:goed|runned|taked|sitted|maked)\b",
}
_SUBJECT = re.compile(r"(\w+ )?\b(?:[Hh]e|[Ss]he|[Tt]hey|Sam|Emily|James) (\w+)")
_HELPERS = {"did", "could", "would", "might", "let", "make", "made", "had", "kept", "found", "left", "woke"}
_BASES = english_verbs().bases
_PRESENT = ({third_person(base) for base in _BASES} | _BASES) - {past(base) for base in _BASES} | {"is", "has", "does"}


def long_script(
    chosen: list[ShortScript], events: list[str] | None = None, theme: str = "A person spends a day."
) -> LongScript:
    """Short scripts one after the other, with the rising in between that a body needs."""
    told = [Beat(text=text) for text in events or [script.summary for script in chosen]]
    keyframes: list[PlannedKeyframe] = []
    for number, script in enumerate(chosen):
        last = keyframes[-1] if keyframes else None
        if last is not None and last.skill in (Skill.SITDOWN, Skill.LIEDOWN):
            skill = Skill.STANDUP if last.skill == Skill.SITDOWN else Skill.GETUP
            keyframes.append(PlannedKeyframe(skill=skill, caption="get up", furniture=last.furniture, room=last.room))
        keyframes += [
            PlannedKeyframe(**k.model_dump(), short_script=number, beat=number, room=script.room)
            for k in script.keyframes
        ]
    found = tuple(Retrieved(script=script, beat=number, score=0.5) for number, script in enumerate(chosen))
    return LongScript(theme=theme, beats=tuple(told), short_scripts=found, keyframes=tuple(keyframes))


stories = st.lists(st.sampled_from(LIBRARY), min_size=1, max_size=5, unique=True).map(long_script)


def slips(text: str) -> list[str]:
    found = [f"{kind}: {found[0]!r}" for kind, pattern in SLIPS.items() if (found := re.search(pattern, text))]
    for subject in _SUBJECT.finditer(text):
        if subject[2] in _PRESENT and (subject[1] or "").strip().lower() not in _HELPERS:
            found.append(f"a verb in the present: {subject[0]!r}")
    return found + ["quotes do not pair"] * (text.count("“") != text.count("”") or text.count('"') % 2 == 1)


def sentences_of(text: str) -> list[str]:
    return re.split(r"(?<=[.!?])\s+", text)


def monotonies(text: str) -> list[str]:
    """Where a story says a thing as it said another: three first words, a frame within five sentences, length."""
    found: list[str] = []
    openings: list[str] = []
    starts: set[tuple[str, ...]] = set()
    for sentence in sentences_of(text):
        start = tuple(re.findall(r"[\w'’-]+", sentence.lower())[:3])
        opening = re.match(r"(.*?)\b(?:they|she|he|They|She|He|Sam|Emily|James)\b", sentence)
        frame = (opening[1] if opening else sentence).strip()
        if start in starts:
            found.append(f"begins like another: {sentence!r}")
        if frame and frame in openings[-4:]:
            found.append(f"is framed like another: {sentence!r}")
        if len(sentence.split()) > 35:
            found.append(f"is too long: {sentence!r}")
        starts.add(start)
        openings.append(frame)
    return found


def spoken(told: Told) -> list[int]:
    return [index for span in told.spans for index in span.keyframes]


@tries(60)
@given(stories, st.sampled_from(PEOPLE), st.integers(0, 9))
def test_no_story_has_a_slip_of_grammar_or_says_a_thing_twice_in_one_way(
    script: LongScript, person: Character, seed: int
) -> None:
    told = narrate(script, person, seed)
    assert slips(told.text) == [], told.text
    assert monotonies(told.text) == [], told.text
    assert person.name in told.text


@pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.sweep)])
def test_every_short_script_is_told_without_a_slip(step: int) -> None:
    found = {s.id: slips(narrate(long_script([s]), PEOPLE[n % 3], n).text) for n, s in enumerate(LIBRARY[::step])}
    assert {name: problems for name, problems in found.items() if problems} == {}


def test_a_story_of_twelve_short_scripts_is_not_monotonous() -> None:
    for seed in range(3):
        text = narrate(long_script(list(LIBRARY[seed :: len(LIBRARY) // 12][:12])), PEOPLE[seed], seed).text
        assert monotonies(text) == [], text


@for_each(
    ("text", "slip"),
    [
        ("They was tired.", "they with a singular verb"),
        ("Emily walk to the bed.", "a verb in the present"),
        ("Then he sits down.", "a verb in the present"),
        ("She took an glass.", "an before a consonant"),
        ("She sat sat down.", "a doubled word"),
        ("She sat down", "a sentence without an end"),
        ("“She sat down.", "quotes do not pair"),
    ],
)
def test_the_checks_themselves_find_slips(text: str, slip: str) -> None:
    assert any(found.startswith(slip) for found in slips(text))


def test_the_check_for_monotony_finds_it() -> None:
    assert len(monotonies("Soon she sat down. Soon she sat on it. Soon he rose.")) == 3


@tries(40)
@given(stories, st.integers(0, 9))
def test_spans_tell_every_keyframe_once_and_in_order(script: LongScript, seed: int) -> None:
    told = narrate(script, PEOPLE[0], seed)
    assert spoken(told) == list(range(len(script.keyframes)))
    bounds = [bound for span in told.spans for bound in (span.start, span.end)]
    assert bounds == sorted(bounds)
    assert all(told.text[span.start : span.end].strip() for span in told.spans)
    assert bounds[-1] <= len(told.text)


@tries(20)
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


@tries(20)
@given(st.lists(st.sampled_from(LIBRARY), min_size=2, max_size=6, unique=True).map(long_script), st.integers(0, 9))
def test_paragraphs_have_three_to_six_sentences(script: LongScript, seed: int) -> None:
    paragraphs = [len(sentences_of(text)) for text in narrate(script, PEOPLE[1], seed).text.split("\n\n")]
    assert all(3 <= count <= 7 for count in paragraphs)
    assert sum(count == 7 for count in paragraphs) <= len(paragraphs) / 2
    assert len(paragraphs) >= len(script.short_scripts) / 2


@tries(20)
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
    assert "James was told on the phone that he had failed the job interview." in text


@tries(20)
@given(st.lists(st.sampled_from(LIBRARY), min_size=3, max_size=3, unique=True), st.integers(0, 99))
def test_every_event_is_told_once_in_the_themes_own_words(chosen: list[ShortScript], seed: int) -> None:
    theme = "He irons a purple shirt, misses the tram to Ghent and juggles six lemons."
    events = ["irons a purple shirt", "misses the tram to Ghent", "juggles six lemons"]
    text = narrate(long_script(chosen, events, theme), PEOPLE[2], seed).text
    told = [text.count(words) for words in ("ironed a purple shirt", "missed the tram to Ghent", "juggled six lemons")]
    assert told == [1, 1, 1], text


def test_what_a_far_summary_says_is_left_out_and_its_deeds_are_told() -> None:
    script = long_script([BY_ID["insulting-email"]], ["juggles six lemons"], "He juggles six lemons.")
    far = script.model_copy(update={"short_scripts": (script.short_scripts[0].model_copy(update={"score": 0.1}),)})
    for seed in range(5):
        told = narrate(far, PEOPLE[2], seed)
        assert "insulting" not in told.text
        assert spoken(told) == list(range(len(script.keyframes)))


def test_two_seeds_share_few_sentences() -> None:
    script = long_script(list(LIBRARY[:4]), ["irons a shirt", "misses the bus", "reads mail", "sleeps"])
    tellings = [set(sentences_of(narrate(script, PEOPLE[1], seed).text)) for seed in range(5)]
    shared = [len(one & two) / len(one | two) for one in tellings for two in tellings if one is not two]
    assert max(shared) < 0.4


def test_an_event_without_a_short_script_is_told_in_its_place() -> None:
    chosen = [BY_ID["folding-the-laundry"], BY_ID["insulting-email"]]
    script = long_script(chosen, ["irons a shirt", "misses the bus", "reads mail"])
    keyframes = tuple(k.model_copy(update={"beat": 2}) if k.beat == 1 else k for k in script.keyframes)
    for seed in range(3):
        told = narrate(script.model_copy(update={"keyframes": keyframes}), PEOPLE[1], seed)
        after = next(span for span in told.spans if len(chosen[0].keyframes) in span.keyframes)
        assert 0 <= told.text.find("missed the bus") < after.start


def test_falling_asleep_is_told_last() -> None:
    text = narrate(long_script([BY_ID["falling-asleep-after-a-long-day"]]), PEOPLE[1]).text
    assert text.index("bed") < text.index("fell asleep")


def test_a_direct_script_without_short_scripts_is_told_from_its_events() -> None:
    keyframes = tuple(
        PlannedKeyframe(**k.model_dump(), beat=0, room="bedroom") for k in BY_ID["reading-in-bed"].keyframes
    )
    script = LongScript(
        theme="She rests.", beats=(Beat(text="rests"),), short_scripts=(), keyframes=keyframes, method="direct"
    )
    told = narrate(script, PEOPLE[1])
    assert re.search(r"\b(?:Emily|She) rested\.", told.text)
    assert spoken(told) == list(range(len(keyframes)))


@for_each("caption", ["swaying like seaweed", "yodelling", "hands in the air"])
@for_each("skill", list(Skill))
def test_unknown_captions_are_told_by_their_mood(skill: Skill, caption: str) -> None:
    keyframe = PlannedKeyframe(skill=skill, caption=caption, emotion="sad", furniture="bed")
    script = LongScript(theme="Grief.", beats=(), short_scripts=(), keyframes=(keyframe,))
    told = narrate(script, PEOPLE[0])
    assert slips(told.text) == []
    assert spoken(told) == [0]


def test_every_caption_has_its_own_words_and_every_phrase_starts_with_a_verb() -> None:
    captions = {(k.skill, k.caption) for script in LIBRARY for k in script.keyframes}
    known = templates()
    tables: dict[Skill, Iterable[str]] = {Skill.LOCO: known.walks, Skill.SITDOWN: known.sits, Skill.LIEDOWN: known.lies}
    for skill, table in tables.items():
        assert {caption for of, caption in captions if of == skill} == set(table)
    walks = [*known.walks.values(), *known.walks_in_mood.values()]
    phrases = [t for walk in walks for t in (*walk.to, *walk.about)]
    worded: list[Mapping[Any, tuple[str, ...]]] = [known.sits_in_mood, known.lies_in_mood, known.rises, known.touches]
    for by_word in (*worded, *known.touches_at.values()):
        phrases += [t for ways in by_word.values() for t in ways]
    verbs = {verb for t in phrases for verb in re.findall(r"(?:^|~)(\w+)", t)}
    assert verbs - _BASES == set()


def test_variety_uses_every_option_before_any_again() -> None:
    variety = Variety(5)
    assert sorted(variety.pick("abcdef") for _ in range(6)) == list("abcdef")


def test_a_touch_is_worded_by_height_and_furniture() -> None:
    high, low, prone = "An act of reaching high", "touch low height", "Low touch from a prone position"
    assert "under" in touches(Keyframe(skill=Skill.TOUCH, caption=low, furniture="bed"))[0]
    assert "shelf" in touches(Keyframe(skill=Skill.TOUCH, caption=high, furniture="wardrobe"))[0]
    assert "crouch" in touches(Keyframe(skill=Skill.TOUCH, caption=prone, furniture="lamp"))[0]


@pytest.mark.parametrize(
    ("theme", "title"),
    [
        ("He wins the lottery.", "The Winning Ticket"),
        ("A person is told on the phone that he fails the job interview.", "The Job Interview"),
        ("Somebody enjoys an afternoon.", "An Afternoon at Home"),
    ],
)
def test_a_title_comes_from_the_theme(theme: str, title: str) -> None:
    assert title_of(theme, "relaxed") == title


def test_a_models_story_is_tied_to_the_keyframes_by_its_furniture() -> None:
    script = long_script([BY_ID["reading-in-bed"]])
    text = "Emily reached for the nightstand. She lay down on the bed and read a very good book until dusk. She got up."
    model = ScriptedModel([{"title": "A Good Book", "text": text}])
    told = narrate_with_model(script, PEOPLE[1], model)
    assert told.title == "A Good Book"
    assert spoken(told) == list(range(len(script.keyframes)))
    assert text[told.spans[1].start : told.spans[1].end].startswith("She lay down on the bed")
    assert "Emily" in model.calls[0].prompt


def test_a_model_is_told_what_is_unfaithful_in_its_story() -> None:
    script = long_script([BY_ID["reading-in-bed"]])
    wrong = (
        "Anna lay down on the bed, then she went over to the nightstand. Later the dishwasher hummed in the kitchen."
    )
    right = (
        "Emily reached for the nightstand, then she lay down on the bed and read until the evening came. She got up."
    )
    model = ScriptedModel([{"title": "Late", "text": wrong}, {"title": "Late", "text": right}])
    assert narrate_with_model(script, PEOPLE[1], model).text == right
    asked_again = model.calls[1].prompt
    assert "the name Emily is nowhere in it" in asked_again
    assert "the bed comes before the nightstand" in asked_again
    assert "there is a dishwasher, but no keyframe is at one" in asked_again


def test_a_model_that_leaves_out_what_is_done_is_refused() -> None:
    idle = {"title": "Nothing", "text": "Emily stood in the middle of the room and thought of other days. " * 3}
    with pytest.raises(
        ModelAnswerError, match=r"nothing is told of the nightstand, the bed; say what Emily does there"
    ):
        narrate_with_model(long_script([BY_ID["reading-in-bed"]]), PEOPLE[1], ScriptedModel([idle] * 3))


def test_a_model_that_writes_no_story_is_refused() -> None:
    model = ScriptedModel(["no", "no", "no"])
    with pytest.raises(ModelAnswerError, match="no usable"):
        narrate_with_model(long_script([LIBRARY[0]]), PEOPLE[0], model)


@tries(40)
@given(stories, st.integers(0, 9))
def test_nobody_leaves_a_seat_without_rising(script: LongScript, seed: int) -> None:
    told = narrate(script, PEOPLE[0], seed)
    rises = (Skill.STANDUP, Skill.GETUP)
    for span in told.spans:
        first = script.keyframes[span.keyframes[0]]
        words = told.text[span.start : span.end]
        if first.skill in rises and len(span.keyframes) == 1:
            assert re.search(r"(?i)\b(?:got|g?et|getting|stood|stand|rose|ris|jump|sprang|spring|leap|leapt)", words), (
                words
            )
        rising = [index for index in span.keyframes[:-1] if script.keyframes[index].skill in rises]
        for index in rising:  # it goes without saying only where the body rests there again
            later = [script.keyframes[i].skill for i in span.keyframes if i > index]
            assert later[-1] in (Skill.SITDOWN, Skill.LIEDOWN), told.text


@tries(40)
@given(stories, st.integers(0, 9))
def test_no_manner_of_the_body_is_told_twice_in_a_story(script: LongScript, seed: int) -> None:
    told = narrate(script, PEOPLE[1], seed)
    text = " ".join(told.text[span.start : span.end] for span in told.spans)
    for manner in ("lowered eyes", "head held high", "arms crossed", "crossed arms", "open arms", "heavily"):
        assert text.count(manner) <= 1, text


def test_what_is_done_at_rest_is_told_once_the_body_is_there() -> None:
    script = long_script([BY_ID["crying-on-the-bed"]], ["weeps bitterly on the bed"], "She weeps bitterly on the bed.")
    for seed in range(5):
        told = narrate(script, PEOPLE[1], seed)
        resting = next(s for s in told.spans if script.keyframes[s.keyframes[-1]].skill == Skill.LIEDOWN)
        assert resting.end <= told.text.index("wept bitterly on the bed"), told.text
