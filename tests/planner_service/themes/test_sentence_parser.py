"""Sentences taken apart: nothing is lost, the order of time is right, and what is denied is known to be."""

from __future__ import annotations

import re
from collections import Counter

from built_themes import PRONOUNS, BuiltTheme, themes
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from planner_service.themes.lexicon import grammar, is_adjective
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.theme_words import theme_words
from planner_service.themes.verb_finder import plain


def words_of(text: str) -> Counter[str]:
    """Its words, without those that stand for what is said."""
    return Counter(re.findall(r"[^\W_]+", re.sub(r"«\d+»", "", text.lower())))


def said(text: str) -> list[str]:
    return [clause.text for clause in clauses_of_text(text)]


@for_each(
    ("theme", "verb"),
    [
        ("He lets himself sink onto the sofa.", "sink"),
        ("She forces herself to eat an apple.", "eat"),
        ("He makes himself stand up.", "stand"),
        ("She used to dance.", "dance"),
        ("He carries on typing.", "type"),
        ("She went on reading.", "read"),
        ("He carries on to the kitchen.", "carry"),
    ],
)
def test_verbs_that_only_lead_to_a_deed_leave_it_the_word(theme: str, verb: str) -> None:
    assert [clause.verb for clause in clauses_of_text(theme)] == [verb]


@tries(200)
@given(themes())
def test_a_theme_built_of_clauses_is_read_back_as_those_clauses_in_the_order_of_time(theme: BuiltTheme) -> None:
    read = clauses_of_text(theme.text)
    assert [(clause.verb, clause.denied, clause.unable, clause.text) for clause in read] == [
        (told.verb, told.denied, told.unable, plain(told.said)) for told in theme.told
    ]
    for clause, told in zip(read, theme.told, strict=True):
        own = {theme.hero.lower(), PRONOUNS[theme.hero]}
        assert clause.doer.lower() == told.doer.lower() or {clause.doer.lower(), told.doer.lower()} <= own


@tries(100)
@given(themes())
def test_every_word_of_a_theme_is_in_one_clause_or_is_a_subject_or_a_joint(theme: BuiltTheme) -> None:
    read = clauses_of_text(theme.text)
    found = words_of(" ".join(f"{clause.subject} {clause.text}" for clause in read))
    lost = words_of(plain(theme.text)) - found
    assert not {word for word in lost if word not in grammar().joints | grammar().adverbs}
    assert found <= words_of(plain(theme.text))


SUBJECTS = st.sampled_from(["She", "Anna", "The old man", "My sister", "The widow"])
DEEDS = st.sampled_from(["eats", "sleeps", "answers the phone", "opens the curtains", "reads a book on the sofa"])


@tries(40)
@given(SUBJECTS, st.lists(DEEDS, min_size=2, max_size=3, unique=True), DEEDS)
def test_of_neither_and_nor_all_is_denied_and_nothing_after_them(who: str, deeds: list[str], done: str) -> None:
    *most, last = deeds
    read = clauses_of_text(f"{who} neither {', '.join(most)} nor {last}, but {done}.")
    assert [clause.denied for clause in read] == [True] * len(deeds) + [False]
    assert [clause.text for clause in read] == [f"neither {deeds[0]}", *deeds[1:], done]
    assert {clause.doer for clause in read} == {who}


@tries(40)
@given(SUBJECTS, st.sampled_from(["who lives alone", "whose house is cold", "who neither smokes nor drinks"]), DEEDS)
def test_what_is_told_of_somebody_between_commas_leaves_them_their_deeds(who: str, told: str, deed: str) -> None:
    plainly = clauses_of_text(f"{who} {deed} and dances.")
    beside = clauses_of_text(f"{who}, {told}, {deed} and dances.")
    assert [clause for clause in beside if not clause.aside] == list(plainly)
    assert [clause.text for clause in beside if clause.aside] == [told]


NAMES = sorted(
    name for kind in ("names_she", "names_he", "names_they") for name in theme_words()[kind] if not is_adjective(name)
)


@for_each("deed", ["sits down and reads.", "watches a film.", "stands up straight, nods and sits down."])
def test_whoever_bears_a_known_name_does_what_follows_it(deed: str) -> None:
    doers = {name: clauses_of_text(f"{name.capitalize()} {deed}")[0].doer for name in NAMES}
    assert {name for name, doer in doers.items() if doer != name.capitalize()} == set()


SOUP = """he she Anna reads a book and but before after until when without eating the sofa sleeps not never sits reading
to make tea goes , . tired is was cannot wants kitchen in on quickly then old had eaten “no” ; instead of says"""


@tries(100)
@given(st.lists(st.sampled_from(SOUP.split()), max_size=24).map(" ".join))
def test_no_word_of_any_text_is_read_twice(text: str) -> None:
    read = clauses_of_text(text)
    assert words_of(" ".join(clause.text for clause in read)) <= words_of(plain(text))
    assert all(clause.text.strip() for clause in read)
    assert all(clause.verb in ("", *clause.lemmas[:1]) for clause in read)
    assert clauses_of_text(text) == read


@for_each(
    ("text", "told"),
    [
        # order
        ("He washes up after he eats.", ["eats", "washes up"]),
        ("Before going to bed, he reads and drinks tea.", ["reads", "drinks tea", "going to bed"]),
        ("After eating, she sleeps.", ["eating", "sleeps"]),
        ("He drops the glass when the phone rings.", ["the phone rings", "drops the glass"]),
        ("He is reading when the phone rings.", ["is reading", "the phone rings"]),
        ("A tired old student is reading when the phone rings.", ["is reading", "the phone rings"]),
        ("She panics because guests arrive.", ["guests arrive", "panics"]),
        ("She waits until the kettle boils.", ["waits", "the kettle boils"]),
        # second deeds that no joint joins
        ("She sits reading a letter.", ["sits", "reading a letter"]),
        ("He goes to the kitchen to make tea.", ["goes to the kitchen", "make tea"]),
        ("He lies there crying.", ["lies there", "crying"]),
        ("She walks from room to room.", ["walks from room to room"]),
        ("She laughs so hard she has to sit down.", ["laughs so hard", "has to sit down"]),
        ("The old couple dance until the song ends.", ["dance", "the song ends"]),
        # when it is, between a joint and what is done then
        ("He drinks tea, and at dawn falls asleep.", ["drinks tea", "falls asleep"]),
        ("He reads, and after a while gets up.", ["reads", "gets up"]),
        ("She reads at dawn and at night.", ["reads at dawn and at night"]),
        # lists, and where and when
        ("He eats bread and butter, cheese and a pear.", ["eats bread and butter, cheese and a pear"]),
        ("She eats a plum and a pear before she sleeps.", ["eats a plum and a pear", "sleeps"]),
        ("Before the interview Tomasz bows and sits.", ["bows before the interview", "sits"]),
        ("After the argument she slams the door and cries.", ["slams the door after the argument", "cries"]),
        ("Before the guests arrive Anna bows and sits.", ["bows", "sits", "arrive"]),
        ("He sits next to the window.", ["sits next to the window"]),
        ("In the kitchen Anna reads.", ["reads in the kitchen"]),
        ("The baker, up since two, wipes the glass and hums.", ["wipes the glass", "hums"]),
        ("He writes notes, claps, stamps and bows.", ["writes notes", "claps", "stamps", "bows"]),
        ("1. wake up\n2. cook\n- go out", ["wake up", "cook", "go out"]),
        ("The man then suddenly falls and finally he sleeps.", ["falls", "sleeps"]),
        ("She sings until she sleeps, listening.", ["sings", "sleeps", "listening"]),
        # what is told beside
        ("Barefoot, her hair wet, Anna walks in.", ["Barefoot", "her hair wet", "walks in"]),
        ("One evening Mr. Finch reads.", ["reads"]),
        ("A man who has lost his job sits down.", ["sits down", "who has lost his job"]),
        ("The one who stayed in with a cold watches a film.", ["watches a film", "who stayed in with a cold"]),
        ("Someone with a bad back lies down.", ["with a bad back", "lies down"]),
        ("He sits on the sofa, next to the lamp.", ["sits on the sofa, next to the lamp"]),
        ("While it boils, Tom, in his apron, dances.", ["it boils", "in his apron", "dances"]),
        ("“Come here!” her brother says.", ["says"]),
        ("As quiet as a cat the burglar climbs in.", ["climbs in as quiet as a cat"]),
        ("Freshly shaved, the man picks a shirt.", ["Freshly shaved", "picks a shirt"]),
        ("From time to time she looks up.", ["looks up from time to time"]),
        ("Quietly, so as not to wake him, she slips out.", ["Quietly, not to wake him", "slips out"]),
        ("I was so proud that I read it to the cat.", ["was so proud", "read it to the cat"]),
        ("Two old friends play chess.", ["play chess"]),
        ("When the bell rings they all duck behind the sofa.", ["the bell rings", "duck behind the sofa"]),
        # verbs in their base forms
        ("You wake up, stretch and stare at the ceiling.", ["wake up", "stretch", "stare at the ceiling"]),
        ("They eat on the floor and fall asleep there.", ["eat on the floor", "fall asleep there"]),
        ("Load the plates, wipe the table and feed the cat.", ["Load the plates", "wipe the table", "feed the cat"]),
        ("Welcome Anna, fetch her coat.", ["Welcome Anna", "fetch her coat"]),
        ("1. Wipe the worktop. 2. Load dirty plates.", ["Wipe the worktop", "Load dirty plates"]),
        # what is told the other way about
        ("Hardly had she sat down when the phone rang.", ["the phone rang", "sat down"]),
        ("No sooner had he sat down than it rang.", ["it rang", "sat down"]),
        ("Dinner had to be cooked, so Anna left.", ["cooked Dinner", "left"]),
        ("She strode up and down the hall.", ["strode up and down the hall"]),
        # notes of things
        ("Shoes. Keys? Kettle on, coat off.", ["Shoes", "Keys", "Kettle on", "coat off"]),
        # slang
        ("cant sleep so she gets up n makes tea", ["can not sleep", "gets up", "makes tea"]),
        ("He wanna sleep but he doesnt lie down.", ["want to sleep", "does not lie down"]),
        ("She hoovers the rug and texts her mother.", ["hoovers the rug", "texts her mother"]),
    ],
)
def test_clauses_are_told_in_the_order_of_time(text: str, told: list[str]) -> None:
    read = clauses_of_text(text)
    assert [clause.text if clause.text in told else f"{clause.subject} {clause.text}" for clause in read] == told


@for_each(
    ("text", "verb"),
    [
        ("He does not sit down.", "sit"),
        ("She doesn't eat.", "eat"),
        ("She never eats breakfast.", "eat"),
        ("He refuses to sleep.", "sleep"),
        ("She decides not to read.", "read"),
        ("He wants to sleep.", "sleep"),
        ("He is not able to read.", "read"),
        ("He is about to leave.", "leave"),
        ("He is supposed to pack.", "pack"),
        ("She is going to cook.", "cook"),
        ("She no longer sings.", "sing"),
        ("He avoids looking at her.", "look"),
        ("He forgets to water the plants.", "water"),
        ("She stops reading.", "read"),
        ("He would not have slept.", "sleep"),
        ("She'd like to sleep.", "sleep"),
        ("She has never danced.", "dance"),
    ],
)
def test_what_is_denied_refused_or_wished_for_is_not_done(text: str, verb: str) -> None:
    (clause,) = clauses_of_text(text)
    assert (clause.verb, clause.denied) == (verb, True)


@for_each(
    ("text", "denied"),
    [
        ("She leaves the kitchen without eating.", [False, True]),
        ("Without eating, he goes to bed.", [False, True]),
        ("Instead of reading, she sleeps.", [False, True]),
        ("He sleeps instead of working.", [False, True]),
        ("She does not cook but reads.", [True, False]),
        ("He begins to read and keeps on reading.", [False, False]),
        ("He is able to read.", [False]),
        ("He has to work.", [False]),
        ("She does not eat or drink.", [True]),
        ("He doesn't smoke, drink or dance.", [True]),
        ("He wants to sit down and eat but stands up.", [True, True, False]),
        ("He does not eat and sleeps.", [True, False]),
        ("Too proud to ask, he sits down.", [False, True, False]),
        ("Before he could drink it, he slept.", [False, True]),
        ("Without a word she packed and left the key.", [False, False]),
        ("He was going to cook but instead he sleeps.", [True, False]),
        ("She cannot stop laughing.", [False]),
        ("He can neither sit nor stand still and paces.", [True, True, False]),
        ("My uncle does not eat, nor does he drink; he sits.", [True, True, False]),
        ("Not hungry, Anna sits down.", [False, False]),
        ("Never does she sit still.", [True]),
    ],
)
def test_one_clause_that_is_denied_denies_no_other(text: str, denied: list[bool]) -> None:
    assert [clause.denied for clause in clauses_of_text(text)] == denied


@for_each("text", ["He cannot sleep.", "He can't sleep.", "He could not sleep.", "He is unable to sleep."])
def test_who_cannot_do_a_thing_is_told_from_who_will_not(text: str) -> None:
    (clause,) = clauses_of_text(text)
    assert (clause.verb, clause.denied, clause.unable) == ("sleep", True, True)
    assert not clauses_of_text("He does not sleep.")[0].unable


def test_what_was_done_before_is_marked() -> None:
    assert [clause.perfect for clause in clauses_of_text("He had eaten before he read. She has eaten.")] == [
        True, False, False,
    ]  # fmt: skip


@for_each(
    ("text", "quoted", "verbs"),
    [
        ('He says "I am tired." and lies down.', ["I am tired."], ["say", "lie"]),
        ("“Where is it?” she asks. She searches.", ["Where is it?"], ["ask", "search"]),
        ("She shouts «Come here!» and sits down.", ["Come here!"], ["shout", "sit"]),
        ("He reads «7» to her.", ["7"], ["read"]),
        ("She mutters 'Good night!' and goes to bed.", ["Good night!"], ["mutter", "go"]),
    ],
)
def test_what_is_said_is_kept_and_its_words_are_no_clauses(text: str, quoted: list[str], verbs: list[str]) -> None:
    read = clauses_of_text(text)
    assert [quote for clause in read for quote in clause.quotes] == quoted
    assert [clause.verb for clause in read] == verbs


def test_who_does_it_lasts_to_the_end_of_the_sentence_but_not_who_does_it_meanwhile() -> None:
    read = clauses_of_text("Her brother sings and dances while she reads. She cooks because guests come, and yawns.")
    assert [(clause.verb, clause.doer) for clause in read] == [
        ("sing", "Her brother"), ("dance", "Her brother"), ("read", "she"),
        ("come", "guests"), ("cook", "She"), ("yawn", "She"),
    ]  # fmt: skip


@for_each(
    ("theme", "clauses"),
    [
        ("Before he left Tomas ironed his shirt.", ["ironed his shirt", "left"]),
        ("After she came home Lucy fed the cat.", ["came home", "fed the cat"]),
        ("Saturday chores: Marta strips the bed.", ["strips the bed"]),
        ("Two hours into the power cut, Mei reads.", ["reads"]),
        ("He starts over, and at the end bows to a crowd.", ["starts over", "bows to a crowd"]),
        ("She laughs until she cries.", ["laughs until she cries"]),
        ("She unwraps it: a birthday cake.", ["unwraps it, a birthday cake"]),
        ("She waits until he cries.", ["waits", "cries"]),
        ("wake up, yawn, shower, get dressed, leave", ["wake up", "yawn", "shower", "get dressed", "leave"]),
        ("1) she sets the table 2) waits 3) eats", ["sets the table", "waits", "eats"]),
        ("My roommate and I watch a film.", ["watch a film"]),
        ("Mum and Dad came home, and argued.", ["came home", "argued"]),
        ("Wake up, stretch, make the bed.", ["Wake up", "stretch", "make the bed"]),
        ("Make tea, toast and jam.", ["Make tea, toast and jam"]),
        ("Two flatmates argue about the rent.", ["argue about the rent"]),
        ("One yawns, the other washes up angrily.", ["yawns", "washes up angrily"]),
        ("Nobody comes and Vera eats alone.", ["comes", "eats alone"]),
        ("She goes and sits down.", ["sits down"]),
        ("His brother died in May. He reads.", ["died in May", "reads"]),
    ],
)
def test_a_clause_ends_where_somebody_else_is_named_and_headings_and_times_are_none(
    theme: str, clauses: list[str]
) -> None:
    assert said(theme) == clauses


@for_each("words", ["nobody there, only a parcel", "nothing but a biscuit", "no one except the cat"])
def test_who_finds_nothing_but_one_thing_finds_that(words: str) -> None:
    assert not clauses_of_text(f"She finds {words}.")[0].denied
    assert not any(one.denied for one in clauses_of_text(f"She looks around and finds {words}."))
    assert not clauses_of_text("She finds nobody there.")[0].denied, "she looked, and did not leave it undone"


@for_each(
    ("text", "subject", "verbs"),
    [
        ("A robot named Bolt sweeps the floor.", "A robot named Bolt", ["sweep"]),
        ("An old man called Viktor Petrov naps.", "An old man called Viktor Petrov", ["nap"]),
        ("A friend called Anna and told her the news.", "A friend", ["call", "tell"]),
        ("She named the cat Bolt.", "She", ["name"]),
    ],
)
def test_a_name_that_a_noun_is_given_belongs_to_who_does_it(text: str, subject: str, verbs: list[str]) -> None:
    clauses = clauses_of_text(text)
    assert (clauses[0].subject, [clause.verb for clause in clauses]) == (subject, verbs)


@for_each(
    ("text", "who"),
    [
        ("He opens the door to the boy next door, who returns the drill.", "the boy"),
        ("She burps the baby, who was sick.", "the baby"),
        ("He feeds the dog, who barks.", "the dog"),
    ],
)
def test_who_tells_of_a_person_where_one_is_named_before_it(text: str, who: str) -> None:
    assert clauses_of_text(text)[-1].doer == who


@for_each(
    ("text", "clauses"),
    [
        ("Ruth waits for the phone to ring.", ["waits for the phone to ring"]),
        ("Two unread letters lie on the doormat.", ["lie on the doormat"]),
        (
            "The twins build a tent from blankets and chairs and play cards.",
            ["build a tent from blankets and chairs", "play cards"],
        ),
        ("Too hot to sleep, Ines opens the window.", ["Too hot to sleep", "opens the window"]),
    ],
)
def test_nouns_and_purposes_are_no_deeds_of_their_own(text: str, clauses: list[str]) -> None:
    assert [one.text for one in clauses_of_text(text)] == clauses


@for_each(
    ("text", "verbs"),
    [
        ("Before going to bed, he eats. Then he reads.", ["eat", "read", "go"]),
        ("Before going to bed, he eats. Then he reads in bed.", ["eat", "go", "read"]),
        ("Before going to bed, he eats. He reads.", ["eat", "go", "read"]),
        ("Before eating, he washes. Then he sits down.", ["wash", "eat", "sit"]),
        ("He eats. Before that, he washes.", ["wash", "eat"]),
        ("Only after she has phoned, she eats.", ["phone", "eat"]),
        ("She eats only after she has phoned.", ["phone", "eat"]),
    ],
)
def test_sentences_are_in_the_order_of_time_where_that_is_plain(text: str, verbs: list[str]) -> None:
    assert [one.verb for one in clauses_of_text(text)] == verbs


def test_notes_without_verbs_are_a_deed_each() -> None:
    notes = "quick shower, then pajamas on, teeth brushed, lights off, bed"
    assert [clause.text for clause in clauses_of_text(notes)] == [
        "quick shower", "pajamas on", "teeth brushed", "lights off", "bed"
    ]  # fmt: skip


def test_what_a_teller_says_of_telling_is_no_deed() -> None:
    assert [clause.text for clause in clauses_of_text("I do not mind saying that I wept.")] == ["wept"]
