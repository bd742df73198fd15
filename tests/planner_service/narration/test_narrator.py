"""The rule-based teller: beats in the theme's words and keyframes, each once, and nothing besides."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from itertools import pairwise
from typing import Any

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from narration.hand_made_scripts import (
    BY_ID,
    HAND_MADE,
    LIBRARY,
    MEMORY,
    NEGATION,
    OTHERS,
    beat,
    frame,
    long_script,
    made,
)

from motion_backend.motion import Character, Skill
from planner_service.evaluation.labels import labelled_themes
from planner_service.llm.fake_model import ScriptedModel
from planner_service.llm.structured_output import ModelAnswerError
from planner_service.narration.keyframe_phrases import Variety, templates, touches
from planner_service.narration.llm_narrator import narrate_with_model
from planner_service.narration.narrative_voice import Voice, tells_of_one
from planner_service.narration.narrator import narrate
from planner_service.narration.retold_theme import retell
from planner_service.narration.story_words import title_of
from planner_service.narration.tense import bases, form_of, in_past
from planner_service.narration.told import Told
from planner_service.scripts.acted_beats import planned_beats
from planner_service.scripts.captions import captions
from planner_service.scripts.script import WISHED, BeatKind, Keyframe, LongScript, PlannedKeyframe
from planner_service.themes.beats import beats_of
from planner_service.themes.lexicon import gerund, past, third_person
from planner_service.themes.prose import prose_of
from planner_service.themes.protagonist import cast_by
from scene_graphs.furniture import catalogue, display_name

SAM, EMILY, JAMES = Character("Sam", "they"), Character("Emily", "she"), Character("James", "he")
PEOPLE = (SAM, EMILY, JAMES, Character("the old man", "he"), Character("my sister", "she"), Character("the twins"))
SHE, HE, THEY = Voice("Ana", "she"), Voice("Tom", "he"), Voice("Sam", "they")
ME = THEY.in_theme_of("I")
SLIPS = {
    "two spaces": r"  ",
    "a space before a mark": r" [.,;:!?]",
    "two marks": r"[.,;:!?][.,;:]",
    "a doubled word": r"(?i)\b(\w+) \1\b",
    "they with a singular verb": r"\b[Tt]hey (?:was|has|is)\b",
    "one person with a plural verb": r"\b(?:[Hh]e|[Ss]he|Sam|Emily|James|man|sister) (?:were|are|have)\b",
    "several with a singular verb": r"\btwins (?:was|has|is)\b",
    "an unresolved mention": r"(?i)\b(?:the|a) character\b",
    "a blank": r"[{}~_\ue000]",
    "a sentence without a capital": r"(?:^|[.!?] |\n)[a-z]",
    "a capital inside": r"[a-z,] (?:He|She|They|His|Her|Their|The|Then)\b",
    "across across": r"\bcross(?:ed|ing) (?:over|across|to the \w+ to)",
    "a wrong case": r"\b(?:to|on|with|over) (?:he|they)\b",
    "a sentence without an end": r"[^.!?\n\"”’](?:\n\n|$)",
    "a mark without a space": r"[a-z][.,;!?][A-Za-z]",
}
stories = st.one_of(
    st.sampled_from(HAND_MADE),
    st.lists(st.sampled_from(LIBRARY), min_size=1, max_size=4, unique=True).map(long_script),
)
people, seeds = st.sampled_from(PEOPLE), st.integers(0, 99)


def slips(text: str) -> list[str]:
    return [f"{kind}: {found[0]!r}" for kind, pattern in SLIPS.items() if (found := re.search(pattern, text))]


def sentences_of(text: str) -> list[str]:
    return re.split(r"(?<=[.!?])\s+", text)


def spoken(told: Told) -> list[int]:
    return [index for span in told.spans for index in span.keyframes]


def as_cast(script: LongScript, seed: int = 0) -> str:
    return narrate(script, cast_by(script.theme, Character()), seed).text


@tries(60)
@given(stories, people, seeds)
def test_no_story_has_a_slip_of_grammar(script: LongScript, person: Character, seed: int) -> None:
    told = narrate(script, person, seed)
    assert slips(told.text) == [], told.text
    assert person.name in told.text[:1].lower() + told.text[1:] or person.name in told.text


@for_each(
    ("text", "slip"),
    [
        ("They was tired.", "they with a singular verb"),
        ("Then James were there.", "one person with a plural verb"),
        ("She sat sat down.", "a doubled word"),
        ("She sat down", "a sentence without an end"),
    ],
)
def test_the_checks_themselves_find_slips(text: str, slip: str) -> None:
    assert any(found.startswith(slip) for found in slips(text))


@tries(60)
@given(stories, people, seeds)
def test_every_keyframe_is_told_once_and_in_order(script: LongScript, person: Character, seed: int) -> None:
    told = narrate(script, person, seed)
    assert spoken(told) == list(range(len(script.keyframes)))
    bounds = [bound for span in told.spans for bound in (span.start, span.end)]
    assert bounds == sorted(bounds)
    assert all(told.text[span.start : span.end].strip() for span in told.spans)
    assert bounds[-1] <= len(told.text)


def stems(text: str) -> set[str]:
    """The base forms of a text's words, and the words where they have none."""
    words = set(re.findall(r"[a-z]+", text.lower()))
    return words | {base for word in words for base in bases(word)}


def strings_in(tables: object) -> str:
    if isinstance(tables, str):
        return tables
    if isinstance(tables, Mapping):
        return " ".join(strings_in(part) for part in [*tables.keys(), *tables.values()])
    if isinstance(tables, Iterable):
        return " ".join(strings_in(part) for part in tables)
    return " ".join(strings_in(part) for part in vars(tables).values()) if hasattr(tables, "__dict__") else ""


GRAMMAR = "a an and around at but did had he him his her i in into it its not of on other over she the them they up was"
TABLES = stems(strings_in(vars(templates())).replace("~", " ")) | stems(GRAMMAR)


@tries(60)
@given(stories, people, seeds)
def test_no_word_is_told_that_theme_keyframes_and_tables_do_not_have(
    script: LongScript, person: Character, seed: int
) -> None:
    furniture = " ".join(f"{k.piece[0]} {display_name(k.piece[0])} {k.room}" for k in script.keyframes)
    known = TABLES | stems(f"{script.theme} {furniture} {person.name} himself herself themself".replace("_", " "))
    told = set(re.findall(r"[a-z]+", narrate(script, person, seed).text.lower()))
    assert {word for word in told if word not in known and not stems(word) & known} == set()


def test_the_same_seed_tells_the_same_story_and_another_seed_another() -> None:
    for script in HAND_MADE:
        one, same = (narrate(script, JAMES, 3) for _ in range(2))
        assert one == same
    keyframes = HAND_MADE[-1].model_copy(update={"beats": ()})  # which no theme tells of
    assert len({narrate(keyframes, JAMES, seed).text for seed in range(5)}) == 5


@for_each("seed", range(5))
def test_what_is_acted_is_told_in_the_themes_own_words_and_once(seed: int) -> None:
    evening, morning = (as_cast(script, seed) for script in HAND_MADE[:2])
    for words in ("came home in the evening", "exhausted", "drank a glass of wine alone", "lay awake until midnight"):
        assert evening.lower().count(words) == 1, evening
    assert not re.search(r"\b(?:sip|sipped|cup)\b", evening), evening
    for words in ("jumped out of bed", "grabbed her clothes from", "looked for her keys", "ran to the door"):
        assert morning.count(words) == 1, morning
    assert not re.search(r"\b(?:leapt|sprang|jumped) up\b", morning), morning
    assert as_cast(OTHERS, seed).count("read a book on") == 1


@for_each(
    ("theme", "told"),
    [
        ("Emma and Luca quarrel. He storms out.", "Emma and Luca quarrelled. He stormed out."),
        ("Tom and Anna kiss and sit down.", "Tom and Anna kissed and sat down."),
        ("Tom dances, third he sits down.", "Tom danced, third he sat down."),
        ("Sit down on the sofa, then brush your hair and sleep.",
         "Sam sat down on the sofa, then brushed their hair and slept."),
        ("He sits down, tears one up and sleeps.", "Sam sat down, tore one up and slept."),
    ],
)  # fmt: skip
def test_a_theme_is_told_in_one_tense_by_whoever_does_it(theme: str, told: str) -> None:
    beats = [one.beat for one in beats_of(theme)]
    assert retell(theme, beats, Voice.of(cast_by(theme, Character()))).text == told


@for_each("seed", range(5))
def test_a_body_that_goes_on_sitting_is_not_told_to_rise(seed: int) -> None:
    script = made(
        "He plays a game on the sofa and drinks cola.",
        [beat("plays a game on the sofa"), beat("drinks cola")],
        [
            frame("sitdown", "playing a game, controller held in both hands", "sofa", 0),
            frame("standup", "stand up", "sofa", 1),
            frame("loco", "walking quickly", "sofa", 1),
            frame("sitdown", "drinking from a cup in the right hand", "sofa", 1),
        ],
    )
    told = narrate(script, JAMES, seed)
    assert spoken(told) == [0, 1, 2, 3]
    assert re.fullmatch(r"James played a game on the sofa(?: and|\. He) drank cola\.", told.text)


@for_each("seed", range(5))
def test_a_body_that_lies_where_it_sat_is_not_told_to_come_there_again(seed: int) -> None:
    script = made(
        "He reads on the sofa, yawns and wonders.",
        [beat("reads on the sofa"), beat("yawns"), beat("wonders")],
        [
            frame("sitdown", "reading, book held in both hands", "sofa", 0),
            frame("sitdown", "leaning forward, elbows on knees", "sofa", 1),
            frame("liedown", "left leg bent", "sofa", 2),
        ],
    )
    told = narrate(script, JAMES, seed)
    assert spoken(told) == [0, 1, 2]
    assert told.text == "James read on the sofa, yawned and wondered."
    assert not re.search(r"\b(?:sank|slumped|sat down|settled|collapsed)\b", told.text), told.text


@for_each("seed", range(5))
def test_a_deed_that_names_all_the_furniture_is_told_once_for_all_of_it(seed: int) -> None:
    pieces = ("desk", "shelf", "sofa")
    frames = [
        frame(skill, caption, piece, 0)
        for piece in pieces
        for skill, caption in (("loco", "smoothly forward walk"), ("touch", "touch medium height"))
    ]
    told = narrate(made("He searches.", [beat("searches the desk, the shelf and the sofa")], frames), JAMES, seed)
    assert told.text == "James searched the desk, the shelf and the sofa."
    assert spoken(told) == list(range(6))


@tries(60)
@given(stories, people, seeds)
def test_no_walk_without_a_goal_names_the_room_of_the_one_before(
    script: LongScript, person: Character, seed: int
) -> None:
    told = narrate(script.model_copy(update={"beats": ()}), person, seed)
    named = r"\b(?:around|about|through|down in|forth in) the ((?:living |dining )?\w+)"
    rooms = re.findall(named, told.text)
    assert all(before != after for before, after in pairwise(rooms)), told.text


@for_each("seed", range(5))
def test_what_the_body_is_at_already_is_it(seed: int) -> None:
    frames = [
        frame("liedown", "lying still", "bed", 0),
        frame("getup", "get up", "bed", 0),
        frame("touch", "touch low height", "bed", 0),
    ]
    text = narrate(made("He lies.", [], frames), JAMES, seed).text
    assert text.count("bed") == 1, text
    assert re.search(r"(?:side|edge) of it", text), text


@tries(60)
@given(stories, people, seeds)
def test_what_the_body_is_not_seen_doing_is_a_thought_and_no_event(
    script: LongScript, person: Character, seed: int
) -> None:
    told = narrate(script, person, seed)
    thoughts = [told.text[span.start : span.end] for span in told.thoughts]
    assert sum(map(len, thoughts)) + len(told.events) == len(told.text)
    assert told.marked(lambda words: words) == told.text
    bounds = [bound for span in told.thoughts for bound in (span.start, span.end)]
    assert bounds == sorted(bounds)
    if all(one.acted and one.beat.seen and not one.beat.unshown for one in planned_beats(script).outcomes):
        assert thoughts == []


@for_each(
    ("script", "thoughts"),
    [
        (MEMORY, ["missing the bus", "had lost her umbrella too"]),
        (OTHERS, ["The phone rang", "her husband came in with flowers", "the guests left"]),
    ],
)
def test_memories_refusals_and_what_others_do_keep_their_places_as_thoughts(
    script: LongScript, thoughts: list[str]
) -> None:
    told = narrate(script, cast_by(script.theme, Character()))
    found = [told.text[span.start : span.end] for span in told.thoughts]
    for words in thoughts:
        assert any(words in one for one in found), (told.text, found)
        assert words not in told.events


def test_what_is_left_undone_as_asked_is_seen_not_to_be_done_and_what_is_only_wished_for_is_a_thought() -> None:
    assert "did not sit down" in narrate(NEGATION, JAMES).events
    wish = beat("wants to call", "undone", WISHED)
    told = narrate(
        made("He wants to call. He walks.", [wish, beat("walks")], [frame("loco", "stand still", "floor", 1)]), JAMES
    )
    assert "call" not in told.events


def test_what_no_door_or_lamp_is_seen_to_do_is_a_thought() -> None:
    opens = beat("stands at the open fridge")
    told = narrate(made("He stands at the open fridge.", [opens], [frame("loco", "stand still", "floor", 0)]), JAMES)
    assert told.marked(lambda words: f"*{words}*") == "James stood at the *open fridge*."


@for_each("seed", range(3))
def test_a_deed_that_something_stands_for_is_a_thought_beside_its_keyframes(seed: int) -> None:
    bakes = beat("bakes a cake").model_copy(update={"unshown": ("bakes a cake",)})
    frames = [frame("loco", "smoothly forward walk", "stove", 0), frame("touch", "touch medium height", "stove", 0)]
    told = narrate(made("He bakes a cake.", [bakes], frames), JAMES, seed)
    assert told.text == "James baked a cake."
    assert "cake" not in told.events
    assert spoken(told) == [0, 1]


def test_what_a_keyframe_shows_besides_is_told_with_it() -> None:
    script = made(
        "He sits at the desk and writes a letter, then stands up.",
        [beat("sits at the desk"), beat("writes a letter"), beat("stands up")],
        [
            frame("sitdown", "writing at the table, right hand moving", "office chair", 0).model_copy(
                update={"also": (1,)}
            ),
            frame("standup", "stand up", "office chair", 2),
        ],
    )
    told = narrate(script, JAMES)
    assert [told.text[span.start : span.end] for span in told.spans] == [
        "sat at the desk and wrote a letter",
        "stood up",
    ]


@tries(60)
@given(
    st.sampled_from(["swims across a lake", "kissed his boss", "is buying seven goats", "is furious", "says he left"]),
    st.sampled_from(["deed", "feeling", "other", "speech"]),
    seeds,
)
def test_a_beat_that_is_not_acted_is_never_a_plain_past_event(text: str, kind: BeatKind, seed: int) -> None:
    theme = f"He sits on the sofa. He {text}."
    beats = [beat("sits on the sofa"), beat(text, kind, "there is no furniture for it")]
    script = made(theme, beats, [frame("sitdown", "sitting still", "sofa", 0)])
    told = narrate(script, cast_by(theme, Character()), seed)
    assert not re.search(r"swam|kissed|bought|buying|furious|said|left", told.events), told
    assert "sat on the sofa" in told.events


@tries(20)
@given(stories, seeds)
def test_a_span_of_use_names_the_furniture_or_what_stands_for_it(script: LongScript, seed: int) -> None:
    places = {index: (f"thing{index}", "hall") for index in range(len(script.keyframes))}
    told = narrate(script.model_copy(update={"beats": ()}), EMILY, seed, places)
    for span in told.spans:
        last = script.keyframes[span.keyframes[-1]]
        if last.skill == Skill.LOCO and not last.on_floor:
            assert f"the thing{span.keyframes[-1]}" in told.text[span.start : span.end]


@for_each(
    ("base", "simple_past", "ing", "present"),
    [
        ("sit", "sat", "sitting", "sits"),
        ("carry", "carried", "carrying", "carries"),
        ("lie", "lay", "lying", "lies"),
        ("travel", "travelled", "travelling", "travels"),
        ("panic", "panicked", "panicking", "panics"),
    ],
)
def test_verbs_are_inflected_as_in_a_grammar(base: str, simple_past: str, ing: str, present: str) -> None:
    assert (past(base), gerund(base), third_person(base)) == (simple_past, ing, present)
    assert {in_past(form) for form in (base, simple_past, ing, present)} == {simple_past}


def retold(theme: str, voice: Voice = SHE) -> str:
    return retell(theme, [one.beat for one in beats_of(theme)], voice).text


@for_each(
    ("theme", "told"),
    [
        ("She misses the bus.", "Ana missed the bus."),
        ("Ana drinks a glass of wine alone.", "Ana drank a glass of wine alone."),
        ("She is reading on the sofa.", "Ana was reading on the sofa."),
        ("Ana cannot find her glasses.", "Ana could not find her glasses."),
        ("She doesn't answer. It's late, and she's tired.", "Ana did not answer. It was late, and she was tired."),
        ("Ana looks, sees it's the cat, and says “It's you”.", "Ana looked, saw it was the cat, and said “It's you”."),
        ("Ana takes the parcel, tears it open and smiles.", "Ana took the parcel, tore it open and smiled."),
        ("Ana takes a book, reads it and yawns.", "Ana took a book, read it and yawned."),
        ("She decides to sit and read.", "Ana decided to sit and read."),
        ("Ana is cross because it rains.", "Ana was cross because it rained."),
        ("Ana hears that she has won.", "Ana heard that she had won."),
        ("Ana packs for tomorrow.", "Ana packed for the next day."),
        ("She sits on the chair, drinking tea.", "Ana sat on the chair, drinking tea."),
        ("She cleans because guests are coming, and waits.", "Ana cleaned because guests were coming, and waited."),
        ('She shouts "I am late!" and runs.', 'Ana shouted "I am late!" and ran.'),
        ("Comes home. Sits down and cries.", "Ana came home. She sat down and cried."),
        ("Feed the cat. Put it to bed. Set the table.", "Ana fed the cat. She put it to bed. She set the table."),
        ("Reads. Sits. Sleeps. Dances.", "Ana read. She sat. She slept. She danced."),
        ("Ana lies down, hands on her knees.", "Ana lay down, hands on her knees."),
        ("Ana came home and sat down.", "Ana came home and sat down."),
        ("A person walks to the sofa. The person sits down.", "Ana walked to the sofa. Ana sat down."),
        ("A writer paces up and down.", "Ana, a writer, paced up and down."),
        ("Ana mutes herself and carries on typing.", "Ana muted herself and carried on typing."),
        ("Ana knits until her eyes close.", "Ana knit until her eyes closed."),
        ("One sings, the other washes up.", "One sang, the other washed up."),
        ("Socks impossible. Ana sits down.", "Socks impossible. Ana sat down."),
        ("I hoover and wait.", "Ana hoovered and waited."),
        ("A power cut catches her. She sits down.", "A power cut caught her. Ana sat down."),
        ("Ana with stiff fingers takes the case and opens it.", "Ana with stiff fingers took the case and opened it."),
        ("The light moves, the rain stops. Ana finds it.", "The light moved, the rain stopped. Ana found it."),
        ("They search the desk, the shelf and the bag, and end at the mirror.",
         "Ana searched the desk, the shelf and the bag, and ended at the mirror."),
        ("You find a candle and light it. The lamps go on.", "Ana found a candle and lit it. The lamps went on."),
        ("I've been ill for weeks. Then I cried.", "Ana had been ill for weeks. Then she cried."),
        ("The keys are gone. They were here. Ana sits down.", "The keys were gone. They were here. Ana sat down."),
        ("It was Sunday. She wakes and is glad.", "It was Sunday. Ana woke and was glad."),
    ],
)  # fmt: skip
def test_a_theme_is_told_in_its_own_words_in_the_past(theme: str, told: str) -> None:
    assert retold(theme) == told


@for_each(
    "theme",
    [
        "Thirty-one essays on the table. Wet footprints on the rug. Ana sat down.",
        "Books on the shelf, cups in the sink, bed made, floor swept. Ana sat down.",
        "Back home, results unopened in her bag, Ana sat down.",
        "What would you do? Can you tell? Whose keys are these? Ana sat down.",
        "Is it late? Ana sat down at 7 am and said a few words of thanks.",
    ],
)
def test_what_is_no_verb_or_is_asked_of_nobody_stays(theme: str) -> None:
    assert retold(theme) == theme
    assert retold(theme.replace("sat", "sits").replace("said", "says")) == theme


@for_each("theme", [one.theme for one in labelled_themes() if not one.refuse])
def test_no_sentence_is_told_half_in_the_past(theme: str) -> None:
    """Nobody does something, in a form that can be nothing but a present, beside what we put into the past."""
    prose, told = prose_of(theme), retold(theme, THEY)
    for before, after in zip(re.split(r"(?<=[.!?]) ", prose), re.split(r"(?<=[.!?]) ", told), strict=False):
        plain = re.sub(r"“[^”]*”|\"[^\"]*\"", "", after)
        present = re.findall(
            r"\b(?:[Hh]e|[Ss]he|[Ii]t|[Tt]hey|Sam) (?:\w+ly )?(is|are|has|does|\w+[a-z]s)\b(?! \?)", plain
        )
        finite = [word for word in present if form_of(word) == "present" or word in ("is", "are", "has", "does")]
        assert before == after or not finite, after
        assert not re.search(r"\bSam (?:been|am|were|are|have)\b|\b(\w+) \1's?\b(?<!had had)(?<!that that)", plain), (
            after
        )


@for_each(
    ("theme", "voice", "told"),
    [
        ("I'm ill. I hug myself, and my cat sleeps.", ME, "I was ill. I hugged myself, and my cat slept."),
        ("He is ill.", THEY.in_theme_of("he"), "Sam was ill."),
        ("I am ill.", HE.in_theme_of("I"), "Tom was ill."),
        ("I throw myself on my bed and cry.", HE, "Tom threw himself on his bed and cried."),
        (
            "I'm ill. I call my sister, who loves me.",
            THEY,
            "Sam was ill. They called their sister, who loved them.",
        ),
        ("He is tired. He kisses her.", HE, "Tom was tired. He kissed her."),
        ("He is at home. He is tired.", THEY, "Sam was at home. They were tired."),
        ("Tom walks to his desk.", THEY, "Sam walked to their desk."),
    ],
)
def test_a_theme_is_told_of_the_storys_person(theme: str, voice: Voice, told: str) -> None:
    assert retold(theme, voice) == told


@for_each(
    "theme",
    [
        'Ana came home, took off her shoes and lay down. "Never again," she said.',
        "Ana had been ill; her mother sat beside her, reading, until the fever went.",
        "Nobody called. Ana walked up and down, as she always did when it rained, and ate nothing.",
    ],
)
def test_a_theme_in_the_past_is_told_as_it_is_written(theme: str) -> None:
    assert retold(theme) == theme


@given(st.text(max_size=80))
def test_any_text_can_be_told_again_with_as_many_letters_that_are_no_words(theme: str) -> None:
    marks = [letter for letter in retell(theme, (), HE).text if not (letter.isalnum() or letter.isspace())]
    assert len(marks) <= sum(not letter.isalnum() for letter in theme) + 1


@given(st.text(max_size=60), st.sampled_from(["deed", "feeling", "undone", "memory", "other", "speech"]))
def test_any_words_may_be_a_beat(text: str, kind: BeatKind) -> None:
    script = made("He sits.", [beat(text, kind)], [frame("sitdown", "sitting still", "sofa", 0)])
    assert spoken(narrate(script, JAMES)) == [0]


@for_each(("written", "kind"), [("she", "she"), ("He", "he"), ("they/them", "they"), ("xe", "they"), ("", "they")])
def test_pronouns_are_read_kindly(written: str, kind: str) -> None:
    assert Voice.of(Character("Kim", written)).pronouns == kind


@for_each("summary", ["", "rain and wind", "I sit down.", "He gives her a ring.", "You are tired."])
def test_a_summary_of_nobody_or_of_two_is_found(summary: str) -> None:
    assert not tells_of_one(summary)


@for_each("caption", ["swaying like seaweed", "yodelling", "hands in the air"])
@for_each("skill", list(Skill))
def test_unknown_captions_are_told_by_their_mood(skill: Skill, caption: str) -> None:
    keyframe = PlannedKeyframe(skill=skill, caption=caption, emotion="sad", furniture="bed")
    told = narrate(made("Grief.", [], [keyframe]), SAM)
    assert slips(told.text) == []
    assert spoken(told) == [0]


def test_every_caption_has_its_own_words_and_every_phrase_starts_with_a_verb() -> None:
    known = templates()
    tables: dict[Skill, Iterable[str]] = {Skill.LOCO: known.walks, Skill.SITDOWN: known.sits, Skill.LIEDOWN: known.lies}
    for skill, table in tables.items():
        assert set(captions()[skill.value]) == set(table)
    walks = [*known.walks.values(), *known.walks_in_mood.values()]
    phrases = [t for walk in walks for t in (*walk.to, *walk.about)]
    worded: list[Mapping[Any, tuple[str, ...]]] = [known.sits_in_mood, known.lies_in_mood, known.rises, known.touches]
    for by_word in (*worded, *known.touches_at.values()):
        phrases += [t for ways in by_word.values() for t in ways]
    verbs = {verb for t in phrases for verb in re.findall(r"(?:^|~)(\w+)", t)}
    assert {verb for verb in verbs if verb not in bases(verb)} == set()


def test_variety_uses_every_option_before_any_again() -> None:
    variety = Variety(5)
    assert sorted(variety.pick("abcdef") for _ in range(6)) == list("abcdef")


def test_a_touch_is_worded_by_height_and_furniture() -> None:
    high, low, prone = "An act of reaching high", "touch low height", "Low touch from a prone position"
    assert "side" in touches(Keyframe(skill=Skill.TOUCH, caption=low, furniture="bed"))[0]
    assert "top" in touches(Keyframe(skill=Skill.TOUCH, caption=high, furniture="wardrobe"))[0]
    assert "knees" in touches(Keyframe(skill=Skill.TOUCH, caption=prone, furniture="lamp"))[0]


@for_each("height", ["An act of reaching high", "touch low height", "Low touch from a prone position", "touch it"])
@for_each("piece", sorted(catalogue().class_of))
def test_a_touch_is_told_as_a_hand_on_the_outside_of_a_thing(height: str, piece: str) -> None:
    unseen = (
        r"open|clos|look|peer|pull|push|into\b|inside|under|beneath|between|drawer|shel(?:f|ves)\b|feel|smooth|pat\b"
    )
    moving = r"hand (?:over|along|across)"
    for phrase in touches(Keyframe(skill=Skill.TOUCH, caption=height, furniture=piece)):
        assert not re.search(rf"\b(?:{unseen})|{moving}", phrase.replace("{the}", ""))


@for_each(
    ("theme", "title"),
    [
        ("He wins the lottery.", "The Lottery"),
        ("Somebody enjoys an afternoon.", "A Quiet Afternoon"),
        ("Somebody sits.", "A Quiet Day"),
    ],
)
def test_a_title_comes_from_the_theme(theme: str, title: str) -> None:
    assert title_of(theme, "relaxed") == title


def test_a_models_story_is_tied_to_the_keyframes_by_its_furniture() -> None:
    script = long_script([BY_ID["reading-in-bed"]])
    text = "Emily reached for the nightstand. She lay down on the bed and read a very good book until dusk. She got up."
    model = ScriptedModel([{"title": "A Good Book", "text": text}])
    told = narrate_with_model(script, EMILY, model)
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
    assert narrate_with_model(script, EMILY, model).text == right
    asked_again = model.calls[1].prompt
    assert "the name Emily is nowhere in it" in asked_again
    assert "the bed comes before the nightstand" in asked_again
    assert "there is a dishwasher, but no keyframe is at one" in asked_again


def test_a_model_that_leaves_out_what_is_done_is_refused() -> None:
    idle = {"title": "Nothing", "text": "Emily stood in the middle of the room and thought of other days. " * 3}
    with pytest.raises(
        ModelAnswerError, match=r"nothing is told of the nightstand, the bed; say what Emily does there"
    ):
        narrate_with_model(long_script([BY_ID["reading-in-bed"]]), EMILY, ScriptedModel([idle] * 3))


def test_a_model_that_writes_no_story_is_refused() -> None:
    model = ScriptedModel(["no", "no", "no"])
    with pytest.raises(ModelAnswerError, match="no usable"):
        narrate_with_model(long_script([LIBRARY[0]]), SAM, model)


def test_what_is_told_before_it_is_done_has_a_span_of_its_own() -> None:
    theme = "Before going to bed she closes the curtains and sits down."
    keyframes = [
        frame("touch", "touch medium height", "curtain", 1),
        frame("sitdown", "sitting still", "chair", 2),
        frame("liedown", "lying still", "bed", 0),
    ]
    script = made(theme, [beat("going to bed"), beat("closes the curtains"), beat("sits down")], keyframes)
    told = narrate(script, EMILY)
    assert [(told.text[span.start : span.end], span.keyframes) for span in told.spans] == [
        ("going to bed", (2,)),
        ("closed the curtains", (0,)),
        ("sat down", (1,)),
    ]


def test_a_beat_whose_words_stand_apart_is_slanted_whole() -> None:
    theme = "She sits down. On the third try she yodels."
    script = made(
        theme,
        [beat("sits down"), beat("yodels on the third try", why="no")],
        [frame("sitdown", "sitting still", "chair", 0)],
    )
    told = narrate(script, EMILY)
    assert told.marked(lambda words: f"*{words}*").endswith("*On the third try* she *yodelled*.")


@for_each(
    ("theme", "told"),
    [
        ("I go sit at my desk.", "went and sat at"),
        ("They go fetch a towel and come see it.", "went and fetched a towel and came and saw it"),
        ("We go home.", "went home"),
        ("I go to bed.", "went to bed"),
    ],
)
def test_what_somebody_goes_to_do_is_told_in_the_past_too(theme: str, told: str) -> None:
    assert told in retell(theme, [read.beat for read in beats_of(theme)], Voice.of(EMILY)).text


@for_each(
    ("theme", "title"),
    [
        ("She scrubs the sink. She unwraps the scarf and folds the scarf.", "The Scarf"),
        ("She paces. She sits down. She laughs.", "A Day at Home"),
        # Not after things that nobody is seen with.
        ("She paces. The keys are gone.", "A Day at Home"),
        ("She takes the keys.", "The Keys"),
    ],
)
def test_a_story_is_called_after_what_is_done_in_it(theme: str, title: str) -> None:
    script = made(theme, [read.beat for read in beats_of(theme)], [frame("loco", "stand still", "floor", 0)])
    assert narrate(script, EMILY).title == title


@given(stories, people, st.sets(st.integers(0, 12)))
def test_what_the_body_lost_in_moving_is_slanted_and_nothing_else_changes(
    script: LongScript, person: Character, lost: set[int]
) -> None:
    told = narrate(script, person)
    left = told.with_unseen(lost)
    assert (left.title, left.text, left.spans) == (told.title, told.text, told.spans)
    seen = {at for one in told.thoughts for at in range(one.start, one.end)}
    slanted = {at for one in left.thoughts for at in range(one.start, one.end)}
    own = {at for one in told.spans if lost.issuperset(one.keyframes) for at in range(one.start, one.end)}
    assert seen | own <= slanted
    assert all(told.text[at].isspace() for at in slanted - seen - own)
    assert all(one.end <= other.start for one, other in pairwise(left.thoughts))
