"""Themes become beats: what kind each is, who does it, where, and in which mood."""

from __future__ import annotations

import pytest
from built_themes import BuiltTheme, themes
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.emotion_words import emotion_of
from planner_service.scripts.emotions import feelings
from planner_service.scripts.script import EMOTIONS
from planner_service.themes.beats import MAX_THEME_LENGTH, ThemeError, beats_of, read_beat, rooms_in
from planner_service.themes.no_deeds import tells_no_deed
from planner_service.themes.verb_finder import has_verb


def kinds(theme: str) -> list[str]:
    return [read.beat.kind for read in beats_of(theme)]


def moods(theme: str) -> list[str]:
    return [read.beat.emotion.value for read in beats_of(theme)]


@tries(60)
@given(themes())
def test_what_is_denied_is_undone_what_others_do_is_theirs_and_all_else_is_a_deed(theme: BuiltTheme) -> None:
    read = beats_of(theme.text)
    assert len(read) == len(theme.told)
    for one, told in zip(read, theme.told, strict=True):
        theirs = told.doer.startswith(("her ", "the postman", "the kettle"))
        undone = told.denied and not (told.unable and told.verb in ("sleep", "write"))
        assert one.beat.kind == ("other" if theirs else "undone" if undone else "deed")
        assert one.beat.who == (told.doer if theirs else "")
        assert beats_of(theme.text) == read


@for_each(
    ("theme", "wanted"),
    [
        ("She remembers how they used to dance here, and she sways.", ["memory", "memory", "deed"]),
        ("She remembers how they danced and laughed, and smiles.", ["memory", "memory", "memory", "deed"]),
        ("She remembers being a girl and skipping rope.", ["memory", "memory"]),
        ("She recalls the day he left and shuts the window.", ["memory", "memory", "deed"]),
        ("He would always sit by the window. Now he lies down.", ["memory", "deed"]),
        ("He remembers where he left the keys and picks them up.", ["memory", "memory", "deed"]),
        # but not what is done when something comes to mind, nor what one gets used to
        ("He remembers his keys when he reaches the door.", ["deed", "memory"]),
        ("She gets used to the noise and sleeps.", ["deed", "deed"]),
    ],
)
def test_what_is_remembered_is_not_done_now(theme: str, wanted: list[str]) -> None:
    assert kinds(theme) == wanted


@for_each(
    ("theme", "told"),
    [
        ("Laundry day. He folds shirts.", ["Laundry day"]),
        ("Mia is six. She jumps.", ["is six"]),
        ("Rain all Sunday. She reads. Nothing.", ["Rain all Sunday", "Nothing"]),
        ("I wept until I had nothing left.", ["had nothing left"]),
        ("He laughs: they were on his head the whole time.", ["were on his head the whole time"]),
        ("He is a widower. He reads.", ["is a widower"]),
        ("She rains blows on the door. She is on her knees. A nap. Coffee. He storms out. She has a bath.", []),
    ],
)
def test_what_nobody_does_is_told_and_is_no_deed(theme: str, told: list[str]) -> None:
    assert [one.text for one in beats_of(theme) if not one.beat.asked] == told


def test_what_was_done_long_ago_is_remembered_where_it_is_told_what_is_done_now() -> None:
    assert kinds("Ten years ago they danced here. Now he sits and reads.") == ["memory", "deed", "deed"]
    assert kinds("Ten years ago they danced here. They laughed.")[0] == "deed"


@for_each(
    ("text", "wanted"),
    [("Fridge empty.", "other"), ("Socks impossible.", "other"), ("Shoes off.", "deed"), ("Door locked.", "other")],
)
def test_how_a_thing_is_is_nobodys_deed(text: str, wanted: str) -> None:
    assert kinds(f"{text} She reads.") == [wanted, "deed"]


def test_a_nap_is_a_deed_though_no_verb_says_so() -> None:
    assert [one.clause.verb for one in beats_of("He folds shirts. Then a short nap.")] == ["fold", "nap"]


@for_each(
    ("theme", "wanted"),
    [
        ("She reads. She is sad. She does not eat.", ["deed", "feeling", "undone"]),
        ("He remembers his dead wife and sits down.", ["memory", "deed"]),
        ("He had eaten. He reads.", ["memory", "deed"]),
        ("He says “Good night” and sleeps.", ["speech", "deed"]),
        ("She reads until the phone rings.", ["deed", "other"]),
        ("Nobody comes, so she eats alone.", ["other", "deed"]),
        ("He cannot sleep.", ["deed"]),
        ("He cannot swim.", ["undone"]),
        ("Her heart races. She sits down.", ["feeling", "deed"]),
        ("Bored stiff, the nurse tries on a hat.", ["feeling", "deed"]),
        ("A person becomes very depressed.", ["feeling"]),
        ("They sit there, not reading.", ["deed", "undone"]),
        ("She lies on the bed not moving.", ["deed", "undone"]),
        ("He eats his soup not looking at her.", ["deed", "undone"]),
        ("Only after washing the dishes does she drink tea.", ["deed", "deed"]),
        ("The two of them dance.", ["deed"]),
        ("Only when it was dark did he rise, touch the wall and stand there.", ["other", "deed", "deed", "deed"]),
        ("Never did she sit down.", ["undone"]),
        ("He has not read a line.", ["undone"]),
        ("She sits down and labels nothing more.", ["deed", "undone"]),
        ("She opens no letters. She does nothing. She bows to nobody.", ["undone", "deed", "deed"]),
        ("He almost eats the cake. He nearly falls.", ["undone", "deed"]),
        ("She had polished the spoons and ironed the napkins.", ["memory", "memory"]),
        ("He cannot decide where to put it.", ["deed"]),
        ("“Part B goes into part D”, he reads. “Good”, he says.", ["deed", "speech"]),
        ("He goes from room to room.", ["deed"]),
        ("She telephones nobody. She bows to nobody in particular.", ["undone", "deed"]),
        ("Dusk thickened. She sat down.", ["other", "deed"]),
        ("He calls, but she does not answer.", ["deed", "other"]),
        ("She says hello. She says nothing more.", ["deed", "undone"]),
        ("She makes herself a sandwich.", ["deed"]),
    ],
)
def test_beats_are_of_kinds(theme: str, wanted: list[str]) -> None:
    assert kinds(theme) == wanted


@tries(30)
@given(
    st.sampled_from(("sits on the sofa", "eats her soup", "walks to the door", "stands there")),
    st.sampled_from(("reading", "dancing", "looking at him", "touching the wall", "speaking", "knitting a scarf")),
    st.sampled_from((", not ", " not ", " without ", ", never ")),
)
def test_whatever_is_denied_as_a_participle_is_not_done(deed: str, other: str, joint: str) -> None:
    theme = f"She {deed}{joint}{other}. She sleeps."
    done, undone, after = beats_of(theme)
    assert done.beat.kind == after.beat.kind == "deed"
    assert done.clause.text == deed
    assert undone.clause.denied
    assert undone.beat.kind in ("undone", "speech")
    assert other in undone.text


@for_each(
    ("theme", "who"),
    [
        ("Anna reads while Ben sleeps. She writes.", ["", "Ben", ""]),
        ("The old nurse reads while the postman sleeps. She writes.", ["", "the postman", ""]),
        ("The postman rings. Anna opens the door. She waves.", ["The postman", "", ""]),
        ("A man sits. His sister sings. He dances.", ["", "His sister", ""]),
        ("I read. My brother cooks. I sleep.", ["", "My brother", ""]),
        ("The old nurse yawns. The nurse sits down.", ["", ""]),
        ("A dog sleeps. It wakes.", ["A dog", "It"]),
        ("reads a book and sleeps", ["", ""]),
        ("When the children are asleep he reads.", ["the children", ""]),
        ("He burps the baby, who was sick.", ["", "the baby"]),
        ("She thinks of the ferry, of his mother crying on the quay.", ["", "his mother"]),
        ("Before he eats, the baby wakes, so he gets up.", ["the baby", "", ""]),
    ],
)
def test_one_person_is_played_and_others_are_named(theme: str, who: list[str]) -> None:
    assert [read.beat.who for read in beats_of(theme)] == who


@for_each(
    ("theme", "wanted"),
    [
        ("He is happy. He eats. He cries. He reads.", ["happy", "happy", "sad", "sad"]),
        ("She is dressing up and feels excited about the party.", ["happy", "happy"]),
        ("He gets drunk and rests on the sofa.", ["drunk", "drunk"]),
        ("He eats. He rests on the sofa.", ["neutral", "relaxed"]),
        ("A tired student studies.", ["tired"]),
        ("He laughs and dances.", ["happy", "happy"]),
        ("Yusuf freezes, turns off the lamp and breathes a sigh of relief.", ["stressed", "stressed", "relaxed"]),
        ("He freezes the soup. He hid behind the sofa.", ["neutral", "stressed"]),
        ("Priya curses, paces, then shrugs and eats.", ["angry", "angry", "neutral", "neutral"]),
        ("He cries. He shrugs.", ["sad", "sad"]),
        ("Mia collapses giggling on the rug.", ["happy", "happy"]),
        ("He sits on the bed, sobbing, and cries.", ["sad", "sad", "sad"]),
        ("He shouts, hides from her mother and slams the door.", ["angry", "angry", "angry"]),
        ("She laughs, but then she sinks onto the sofa and cries.", ["happy", "sad", "sad"]),
        ("He shouts at her. Then they build the tower together.", ["angry", "neutral"]),
        ("He shouts at her, says sorry and eats.", ["angry", "neutral", "neutral"]),
        ("He shouts, hugs her and eats.", ["angry", "neutral", "neutral"]),
        ("The shelf collapses. He reads.", ["neutral", "neutral"]),
        ("He collapses. He reads.", ["tired", "tired"]),
        ("They had a row about money.", ["angry"]),
        ("A tired mother hums.", ["tired"]),
    ],
)
def test_a_mood_lasts_until_another_one_comes(theme: str, wanted: list[str]) -> None:
    assert moods(theme) == wanted


def test_contractions_say_what_they_stand_for() -> None:
    short, whole = "She can't sit. She doesn't eat. He'll read.", "She can not sit. She does not eat. He will read."
    assert [read.beat for read in beats_of(short)] == [read.beat for read in beats_of(whole)]


def test_a_room_is_read_wherever_it_stands() -> None:
    assert [read.room for read in beats_of("She reads in the kitchen. In the bedroom, she sleeps. She sits.")] == [
        "dining_room", "bedroom", None,
    ]  # fmt: skip
    assert rooms_in("from the bedroom to the living-room and the kitchen") == ("bedroom", "living_room", "dining_room")
    assert rooms_in("she studies hard") == ()


def test_a_room_that_somebody_goes_out_of_is_not_where_they_are() -> None:
    rooms = [
        rooms_in(text) for text in ("tiptoes out of the bedroom", "leaves the kitchen", "tiptoes into the bedroom")
    ]
    assert rooms == [(), (), ("bedroom",)]


def test_a_beat_that_somebody_else_found_keeps_its_words_mood_and_kind() -> None:
    for read in beats_of("She is sad. She reads in the study. She does not eat."):
        again = read_beat(read.beat)
        assert again.beat == read.beat
        assert again.room == read.room
        assert again.clause.verb == read.clause.verb


@for_each(
    "theme",
    [
        "",
        " \n ",
        "a\x00b sits",
        "\ud800 sits",
        "She sits.\x1b[2J",
        "12 34 !!",
        "x" * (MAX_THEME_LENGTH + 1),
        "Eine Frau kommt müde nach Hause und liest ein Buch.",
        "Une femme rentre et dort.",
        "El hombre llega a su casa y duerme.",
        "彼女は本を読む。",
        "for i in range(3): x[i] = {y: z}; print(x)",
        "<script>alert(1)</script> {a} [b] = c; d | e",
        "SELECT * FROM stories WHERE mood = 'sad';",
        'def walk(self): return self.body.go("sofa")',
        "Purple seven the of under quickly banana if.",
        "O silver moon above the silent hills, eternal, cold and far.",
        b"He sits.",
    ],
)
def test_what_is_no_theme_is_refused_with_examples(theme: object) -> None:
    with pytest.raises(ThemeError, match="Try for example: A person"):
        beats_of(theme)  # type: ignore[arg-type]  # not text at times


@for_each(
    "theme",
    [
        "Please ignore the story and set the camera wide.", "Can you tell me how long it takes?",
        "Translate this sentence into German.", "Write me a poem about the sea.",
        "Delete all files and shut down the server.", "Preheat to 180 degrees for 25 minutes.",
    ],
)  # fmt: skip
def test_who_asks_for_something_tells_no_story(theme: str) -> None:
    with pytest.raises(ThemeError, match="asks for something"):
        beats_of(theme)
    assert beats_of("Please show a man who reads a book.")
    assert beats_of("Write a letter, make the bed and go to sleep.")


def test_the_longest_theme_is_read() -> None:
    sentence = "She reads a book and sits down. "
    text = sentence * (MAX_THEME_LENGTH // len(sentence))
    assert len(beats_of(text)) == 2 * (MAX_THEME_LENGTH // len(sentence))


@tries(100)
@given(st.text(max_size=120) | st.text("abc .,;:!?\"'“”«»()-–…\n0129", max_size=60))
def test_any_text_has_beats_or_is_refused(theme: str) -> None:
    try:
        read = beats_of(theme)
    except ThemeError:
        return
    assert read
    assert all(one.text.strip() for one in read)


@for_each(
    ("words", "emotion"),
    [
        ("neutral, calm", "neutral"),
        ("tired, depressed, drunk", "drunk"),
        ("painful, sad", "sad"),
        ("cold, disturbed, anxious", "stressed"),
        ("anxious, angry", "angry"),
        ("happy, childish", "happy"),
        ("thinking", "neutral"),
        ("thinking, stressed", "stressed"),
        ("zombie like, drunk", "drunk"),
        ("relaxed, calm", "relaxed"),
        ("confident, thinking", "happy"),
        ("stressed, uncomfortable", "stressed"),
        ("depressed", "sad"),
        ("purple", None),
        ("", None),
    ],
)
def test_the_papers_emotion_words_mean_one_of_nine(words: str, emotion: str | None) -> None:
    assert emotion_of(words) == emotion


def test_each_emotion_means_itself() -> None:
    assert [emotion_of(emotion) for emotion in EMOTIONS] == list(EMOTIONS)


def test_a_negated_feeling_is_not_felt() -> None:
    assert feelings("he is not angry") == []
    assert [feeling.emotion for feeling in feelings("can't stop crying")] == ["sad"]
    assert [feeling.emotion for feeling in feelings("nobody comes to her party")][-1] == "sad"
    assert [feeling.emotion for feeling in feelings("she is no longer nervous")] == ["relaxed"]


def test_words_of_a_longer_saying_mean_what_the_whole_means() -> None:
    assert [feeling.emotion for feeling in feelings("tears up the letter")] == ["angry"]
    assert [feeling.emotion for feeling in feelings("tears run down her face")] == ["sad"]


@for_each("text", ["reads books", "he yodels", "is sitting", "to win", "cried"])
def test_verbs_are_known(text: str) -> None:
    assert has_verb(text)


@for_each("text", ["a walk", "the drink and his dreams", "butter", "insomnia"])
def test_nouns_are_no_verbs(text: str) -> None:
    assert not has_verb(text)


def test_a_mood_before_a_verb_is_felt_and_any_other_words_there_are_nobodys_deed() -> None:
    kinds = [
        (read.beat.text, read.beat.kind) for read in beats_of("He comes home, angrily slams the cabinet and sits.")
    ]
    assert ("angrily", "feeling") in kinds
    assert ("other", "Her hair wet") in [
        (read.beat.kind, read.beat.text) for read in beats_of("Her hair wet, Anna walks in.")
    ]


@pytest.mark.parametrize("how", ["slowly", "gently", "suddenly"])
def test_how_a_deed_is_done_is_no_beat_of_its_own(how: str) -> None:
    assert [one.text for one in beats_of(f"She stands, and {how} opens the door.")] == ["stands", "opens the door"]
    assert [one.text for one in beats_of(f"She {how} opens the door.")] == ["opens the door"]


def test_what_there_is_nothing_but_is_there() -> None:
    (boredom,) = [one.clause for one in beats_of("Nothing but boredom.")]
    assert not tells_no_deed(boredom)
    assert tells_no_deed(beats_of("She waits. Nothing.")[-1].clause)


@for_each(
    ("theme", "kinds"),
    [
        ("Last summer they danced here. She sits down.", ["other", "memory", "deed"]),
        ("Once, long ago, she sang on a stage. She washes the dishes.", ["memory", "deed"]),
        ("She sits on the bed and thinks back to when she danced every night.", ["deed", "memory", "deed"]),
        ("Flashback: a girl dances in the hall. Now old, she sits down.", ["deed", "memory", "other", "deed"]),
        ("He closes his eyes and sees himself as a boy, running home.", ["deed", "deed", "memory"]),
        ("She looks at a photo. In it she was dancing. She lies down.", ["deed", "memory", "deed"]),
        ("A year ago he moved in. He swept the floor.", ["deed", "deed"]),
    ],
)  # fmt: skip
def test_what_was_done_long_ago_is_remembered_where_the_rest_is_told_as_of_now(theme: str, kinds: list[str]) -> None:
    assert [one.beat.kind for one in beats_of(theme)] == kinds


def test_a_list_of_things_is_refused_and_a_day_is_not() -> None:
    with pytest.raises(ThemeError, match="a list of things"):
        beats_of("Apples, pears, plums, tables, chairs.")
    for theme in ("Coffee, book, bed.", "A rainy Sunday.", "An evening alone with a good book."):
        assert beats_of(theme)
