"""The deed of a clause is found whatever the grammar that hides it."""

from __future__ import annotations

from for_each import for_each

from planner_service.themes.beats import beats_of
from planner_service.themes.constructions import light_readings
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.word_order import in_usual_order

HEROES = ("Martha", "Viktor")


def deeds(text: str) -> list[tuple[str, str]]:
    return [(clause.doer, clause.verb) for clause in clauses_of_text(text) if clause.verb and not clause.denied]


@for_each(
    ("told", "verb"),
    [
        ("A yawn escapes {}.", "yawn"),
        ("{}'s sobs shake the bed.", "sob"),
        ("{}'s pacing wears the rug thin.", "pace"),
        ("Laughter bursts out of {}.", "laugh"),
        ("{}'s mouth opens in a yawn.", "yawn"),
        ("{}'s only reply is a shrug.", "shrug"),
        ("{} answers with a nod.", "nod"),
        ("The joke has {} laughing.", "laugh"),
        ("A noise makes {} jump.", "jump"),
        ("{}'s hand closes the drawer.", "close"),
        ("{}'s eyes wander to the window.", "look"),
        ("{}'s arms go round the pillow.", "hug"),
        ("{}'s legs buckle.", "sink"),
        ("The armchair receives {}.", "sit"),
        ("The plates get washed by {}.", "wash"),
        ("{} finds himself sitting on the floor.", "sit"),
    ],
)
def test_whoever_is_told_of_does_what_another_word_than_the_verb_tells(told: str, verb: str) -> None:
    for hero in HEROES:
        assert deeds(told.format(hero)) == [(hero, verb)]


@for_each(
    ("told", "verbs"),
    [
        ("The kettle goes on, and she sits down.", ["turn", "sit"]),
        ("The coat comes off; she sighs.", ["take", "sigh"]),
        ("The book goes back on the shelf, and she sleeps.", ["put", "sleep"]),
        ("She stands there, a towel clutched to her chest.", ["stand", "clutch"]),
        ("The cake eaten, she sits back.", ["eat", "sit"]),
        ("With a groan she rises.", ["sigh", "rise"]),
        ("She yawns her way to the bathroom.", ["yawn", "walk"]),
    ],
)
def test_what_is_told_of_a_thing_or_besides_is_done_too(told: str, verbs: list[str]) -> None:
    assert [verb for _, verb in deeds(told)] == verbs


@for_each(
    "told",
    [
        "The light is gone.",
        "Carla's dog died.",
        "The door is closed.",
        "Laughter comes from the street.",
        "Her sobs subside.",
        "The room is lit by a candle.",
        "The heat makes her sick.",
        "The phone rings.",
        "The news is a shock.",
    ],
)
def test_what_nobody_does_is_not_taken_for_a_deed(told: str) -> None:
    assert not any(clause.plainly for clause in clauses_of_text(told))


@for_each(
    ("turned", "usual"),
    [
        ("Into the armchair sinks Hugo", "Hugo sinks into the armchair"),
        ("Slumped over the desk is the old man", "The old man is slumped over the desk"),
        ("A door opens and in comes Judith", "A door opens and Judith comes in"),
        ("It is Tessa who sweeps the floor", "Tessa sweeps the floor"),
        ("It is with a nod that she leaves", "with a nod, she leaves"),
        ("All he can do is lie down", "he lies down"),
        ("It takes her an hour to get up", "she gets up"),
        ("Were she braver, she would knock", "if she were braver, she would knock"),
        ("She sits in the armchair", "She sits in the armchair"),
        ("In the kitchen she sits and waits for Tom", "In the kitchen she sits and waits for Tom"),
        ("There is a retired nurse", "There is a retired nurse"),
    ],
)
def test_a_turned_sentence_is_read_in_the_usual_order_and_no_other_is(turned: str, usual: str) -> None:
    assert in_usual_order(turned) == usual
    assert in_usual_order(usual) in (usual, in_usual_order(turned))


def test_what_would_be_done_if_something_were_so_is_not_done() -> None:
    for told in ("If she were braver, she would knock.", "Were she braver, she would knock."):
        assert [clause.denied for clause in clauses_of_text(told) if clause.verb == "knock"] == [True]
    assert not any(clause.denied for clause in clauses_of_text("If it rains, she reads."))


def test_a_verb_that_only_says_that_a_noun_is_done_is_read_as_the_noun() -> None:
    assert light_readings(("give", "the", "pot", "a", "quick", "stir")) == [("stir", "the", "pot")]
    assert light_readings(("take", "a", "look", "at", "the", "clock")) == [("look", "at", "the", "clock")]
    assert light_readings(("take", "the", "cup")) == []


def test_a_beat_keeps_the_themes_words_whatever_they_mean() -> None:
    (beat,) = beats_of("A yawn escapes Martha.")
    assert beat.text == "A yawn escapes Martha"
    assert (beat.beat.kind, beat.beat.who, beat.clause.text) == ("deed", "", "yawns")


@for_each(
    ("note", "plainly"),
    (
        ("NPC throws phone.", "throws the phone"),
        ("Sits on floor.", "sits on the floor"),
        ("Ann does dishes.", "does the dishes"),
        ("Checks watch.", "checks the watch"),
    ),
)
def test_notes_leave_out_articles(note: str, plainly: str) -> None:
    assert [one.plainly for one in clauses_of_text(note)] == [plainly]


@for_each(
    "theme",
    ("She goes to bed.", "He drinks coffee.", "She throws the phone.", "He saw it on television.", "She reads."),
)
def test_prose_leaves_out_none(theme: str) -> None:
    assert [one.plainly for one in clauses_of_text(theme)] == [""]
