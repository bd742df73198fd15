"""Verbs in the past, and sentences about "the character" told of somebody."""

from __future__ import annotations

from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.motion import Character
from planner_service.narration.event_sentences import (
    event_retold,
    fragment,
    happening,
    joint_between,
    link_before,
    told_of_hero,
    told_together,
)
from planner_service.narration.narrative_voice import Voice, retell
from planner_service.narration.tense import word_to_past
from planner_service.themes.lexicon import english_verbs, gerund, past, third_person

SHE, HE, THEY = Voice("Ana", "she"), Voice("Tom", "he"), Voice("Sam", "they")


@for_each(
    ("base", "simple_past", "ing", "present"),
    [
        ("sit", "sat", "sitting", "sits"),
        ("carry", "carried", "carrying", "carries"),
        ("stop", "stopped", "stopping", "stops"),
        ("lie", "lay", "lying", "lies"),
        ("make", "made", "making", "makes"),
        ("reach", "reached", "reaching", "reaches"),
        ("play", "played", "playing", "plays"),
        ("flee", "fled", "fleeing", "flees"),
        ("tiptoe", "tiptoed", "tiptoeing", "tiptoes"),
        ("panic", "panicked", "panicking", "panics"),
        ("sidestep", "sidestepped", "sidestepping", "sidesteps"),
    ],
)
def test_verbs_are_inflected_as_in_a_grammar(base: str, simple_past: str, ing: str, present: str) -> None:
    assert (past(base), gerund(base), third_person(base)) == (simple_past, ing, present)


@given(st.sampled_from(sorted(english_verbs().bases - {"have", "do", "be"})))
def test_the_present_of_every_verb_leads_back_to_its_past(base: str) -> None:
    assert word_to_past(third_person(base), "and") == past(base)


def test_a_noun_that_looks_like_a_verb_stays() -> None:
    told = retell("The character drinks two drinks and looks at the steps.", SHE)
    assert told == "Ana drank two drinks and looked at the steps."


@for_each(
    ("text", "voice", "told"),
    [
        ("The character is tired and sits down.", THEY, "Sam was tired and sat down."),
        ("The character sits. The character is tired.", THEY, "Sam sat. They were tired."),
        ("The character sits. The character is tired.", SHE, "Ana sat. She was tired."),
        ("It is the character's birthday, and they are happy.", HE, "It was Tom's birthday, and he was happy."),
        ("A person is told that he fails.", HE, "Tom was told that he had failed."),
        ("A person is told that he fails.", THEY, "Sam was told that they had failed."),
        ("A person finds that he won a lottery and runs.", HE, "Tom found that he had won a lottery and ran."),
        ("A person hears that the team loses.", SHE, "Ana heard that the team had lost."),
        ("A person sees that he is late.", HE, "Tom saw that he was late."),
        ("A person finds the lost key that opens the box.", HE, "Tom found the lost key that opened the box."),
        ("The rain wakes the character.", SHE, "The rain woke Ana."),
        ("The rain falls. The character, cold, sits down.", SHE, "The rain fell. Ana, cold, sat down."),
        ("The character runs. The character, cold, sits.", THEY, "Sam ran. Sam, cold, sat."),
        ("Character stomped around, holding her head.", HE, "Tom stomped around, holding his head."),
        (
            "The picnic is tomorrow and the character cannot wait.",
            SHE,
            "The picnic was the next day and Ana could not wait.",
        ),
        ("Tonight the character eats alone.", HE, "That night Tom ate alone."),
        ("The character ponders over a photograph.", SHE, "Ana pondered over a photograph."),
    ],
)
def test_a_sentence_is_told_in_the_past_of_its_person(text: str, voice: Voice, told: str) -> None:
    assert retell(text, voice) == told


@for_each("text", ["", "rain and wind", "She calls him.", "I sit down.", "He gives her a ring."])
def test_what_might_go_wrong_is_not_told(text: str) -> None:
    assert retell(text, THEY) is None


@for_each(
    ("event", "told"),
    [
        ("misses the bus", "Ana missed the bus."),
        ("is raining", "It was raining."),
        ("welcomes them with her best smile", "Ana welcomed them with her best smile."),
        ("kisses him", "Ana kissed him."),
        ("decided to drink wine", "Ana decided to drink wine."),
        ("the phone rings", "The phone rang."),
        ("a quarrel with her boss she comes home", None),
        ("insomnia", None),
        ("to relax", None),
        ("", None),
    ],
)
def test_an_event_becomes_a_sentence_or_nothing(event: str, told: str | None) -> None:
    assert event_retold(event, SHE) == told


@for_each(
    ("theme", "event", "told"),
    [
        ("A teenager plays games all night.", "A teenager plays games all night", "Ana played games all night."),
        ("He's so happy.", "He's so happy", "Ana was so happy."),
        (
            "Her ex calls and she becomes angry.",
            "Her ex calls and becomes angry",
            "Her ex called and Ana became angry.",
        ),
        ("She is told in the phone.", "is told in the phone", "Ana was told on the phone."),
        (
            "She wins, calls home, celebrates.",
            "wins and calls home and celebrates with wine",
            "Ana won, called home and celebrated with wine.",
        ),
        ("He wins, so he run wildly home.", "wins and run wildly home", "Ana won and ran wildly home."),
    ],
)
def test_an_event_is_told_of_the_person_whom_the_theme_is_about(theme: str, event: str, told: str) -> None:
    assert event_retold(told_of_hero(event, theme), SHE) == told


@for_each(
    ("theme", "event", "link"),
    [
        ("He wins a lottery, so he runs around the room.", "runs around the room", "So"),
        ("She is happy, but then she is told the news.", "is told the news", "But then"),
        ("She is happy and she sings.", "sings", ""),
        ("Sings.", "dances", ""),
    ],
)
def test_the_word_that_joined_two_events_is_kept(theme: str, event: str, link: str) -> None:
    assert link_before(theme, event) == link


@for_each(("written", "kind"), [("she", "she"), ("He", "he"), ("they/them", "they"), ("xe", "they"), ("", "they")])
def test_pronouns_are_read_kindly(written: str, kind: str) -> None:
    assert Voice.of(Character("Kim", written)).pronouns == kind


@for_each(
    ("theme", "event", "told"),
    [
        ("Maria cannot find her glasses.", "Maria cannot find her glasses", "Ana could not find her glasses."),
        ("The bills keep piling up. She gives up.", "The bills keep piling up", "The bills kept piling up."),
        (
            "The neighbour drills holes, and she loses her temper.",
            "The neighbour drills holes she loses her temper",
            "The neighbour drilled holes, and Ana lost her temper.",
        ),
        ("He kneels down. She says yes.", "says yes", "She said yes."),
        ("She quarrels with her sister, and they make up.", "make up", "They made up."),
        ("A child hides until his mother comforts him.", "comforts him", "Her mother comforted Ana."),
        ("After losing her job, Marta drinks.", "losing her job", "Ana lost her job."),
        ("Thunder wakes them. They hide.", "Thunder wakes them", "Thunder woke Ana."),
        ("Guests come, and Ana welcomes them.", "welcomes them", "Ana welcomed the guests."),
        ("They hide and go back to sleep.", "go back to sleep", "Ana went back to sleep."),
        ("My daughter got engaged today.", "My daughter got engaged today", "Ana's daughter got engaged that day."),
        ("I am so bored.", "I am so bored", "Ana was so bored."),
        ("Guests are coming.", "guests are coming", "Guests were coming."),
        (
            "Late for work, Ben grabs his coat, runs.",
            "Late for work, Ben grabs his coat, runs",
            "Late for work, Ana grabbed her coat and ran.",
        ),
        ("Insomnia", "Insomnia", None),
    ],
)
def test_an_event_is_told_in_the_words_that_the_theme_has_for_it(theme: str, event: str, told: str | None) -> None:
    assert happening(event, theme, SHE) == told


@for_each(
    ("theme", "events", "told"),
    [
        ("He studied but failed and cried.", ["studied", "failed", "cried"], ["Tom studied but failed and cried."]),
        ("He lost, so he drank.", ["lost", "drank"], ["Tom lost, so he drank."]),
        ("He eats. He sleeps.", ["eats", "sleeps"], ["Tom ate.", "He slept."]),
        ("Before he goes to bed, he writes.", ["writes", "goes to bed"], ["Tom wrote before he went to bed."]),
        (
            "He cannot read because the power goes out.",
            ["the power goes out", "cannot read"],
            ["The power went out, so he could not read."],
        ),
        (
            "He is cross because it rains, and he burns the roast.",
            ["is cross because it rains", "burns the roast"],
            ["Tom was cross because it rained, and he burned the roast."],
        ),
        (
            "He works until noon, eats and has a nap.",
            ["works until noon", "eats and has a nap"],
            ["Tom worked until noon, ate and had a nap."],
        ),
    ],
)
def test_events_are_told_together_as_the_theme_joins_them(theme: str, events: list[str], told: list[str]) -> None:
    assert told_together(events, theme, HE) == told


@given(st.text(max_size=60), st.text(max_size=60), st.text(max_size=60))
def test_any_theme_may_be_asked_for_its_joints_and_words(theme: str, before: str, after: str) -> None:
    assert joint_between(theme, before, after) in ("", "and", "but", "so", "before")
    assert fragment(before) in ("", before.strip().rstrip(".!?,;"))
    for sentence in told_together([before, after], theme, THEY):
        assert sentence.endswith(".")
