"""Who a theme is about."""

from __future__ import annotations

from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.motion import Character
from planner_service.pipeline import StoryRequest
from planner_service.themes.beats import beats_of
from planner_service.themes.protagonist import cast_by, hero_of
from planner_service.themes.sentence_parser import clauses_of_text


@for_each(
    ("theme", "name", "pronouns"),
    [
        ("Old Mr. Kim makes tea and sits down.", "Mr. Kim", "he"),
        ("Ms. Kim reads.", "Ms. Kim", "she"),
        ("Anna comes home and sleeps.", "Anna", "she"),
        ("On Monday Zofia comes home with her cat.", "Zofia", "she"),
        ("Late at night Karim writes a letter.", "Karim", "they"),
        ("His boss calls and Paul worries.", "Paul", "he"),
        ("She reads a book.", "Sam", "she"),
        ("Dana lies down. She sleeps.", "Dana", "she"),
        ("Alex cannot find his glasses.", "Alex", "he"),
        ("Andrea sits down. He reads and he writes.", "Andrea", "he"),
        ("Alex sits down. They read a book of her mother.", "Alex", "they"),
        ("A man argues with his sister; she cries.", "the man", "he"),
        ("The old woman waters the plants.", "the old woman", "she"),
        ("A person is told that he fails.", "Sam", "he"),
        ("After a quarrel with her boss she comes home.", "Sam", "she"),
        ("A person relaxes at home.", "Sam", "they"),
        ("Thunder rolls over the house.", "Sam", "they"),
        ("Later Christmas comes.", "Sam", "they"),
        ("Dinner burns.", "Sam", "they"),
        ("Zora waters the plants.", "Zora", "they"),
        ("Yara cannot sleep.", "Yara", "they"),
        ("Maria cannot find her glasses.", "Maria", "she"),
        ("Late for work, Ben gulps down his coffee.", "Ben", "he"),
        ("Nobody calls.", "Sam", "they"),
        ("Guests arrive.", "the guests", "they"),
        ("Happiness is a warm bed.", "Sam", "they"),
        # as the theme calls them, where it gives no name
        ("A teenage boy slams the door and cries.", "the teenage boy", "he"),
        ("My sister comes home drunk.", "my sister", "she"),
        ("Grandma knits by the fireplace.", "Grandma", "she"),
        ("A boy of six jumps onto the sofa.", "the boy", "he"),
        ("Aunt Rosa bakes a cake and hums.", "Aunt Rosa", "she"),
        ("Someone knocks; the writer jumps up and hides.", "the writer", "they"),
        ("Someone comes home and sleeps.", "Sam", "they"),
        ("My brother calls; I sit down and cry.", "Sam", "they"),
        # who does most of it
        ("A robot named Bolt sweeps the floor.", "Bolt", "they"),
        ("A boy called Max jumps on the bed.", "Max", "he"),
        ("Her Otto emigrated and sends no letters; Tante Greta waits by the window.", "Tante Greta", "she"),
        ("Gwen and Bill quarrel; Bill storms out, Gwen washes up, sits down and weeps.", "Gwen", "she"),
        ("The twins fight; their mother sits down, holds her head and sighs.", "the mother", "she"),
        ("Our Anna moved out; Papa sits in her room and looks at her photographs.", "Papa", "he"),
        ("Carla's dog died; she sits on the sofa and weeps.", "Carla", "she"),
        ("John phones Mary; Mary paces up and down and hangs up.", "Mary", "she"),
        # who does something with somebody else
        ("Marta and her husband argue. She shouts at him.", "Marta", "she"),
        ("Tom and Anna dance in the hall. Then they laugh.", "Tom", "he"),
        ("Grandma Rose knits and dozes off.", "Grandma Rose", "she"),
        ("Her mother calls. She lets it ring.", "Sam", "she"),
        ("Her husband Tom is late. She paces up and down.", "Sam", "she"),
        ("Oskar burps the baby on his shoulder until she sleeps.", "Oskar", "he"),
        ("The resident reads. He yawns.", "the resident", "he"),
    ],
)
def test_the_theme_names_its_person(theme: str, name: str, pronouns: str) -> None:
    assert cast_by(theme, Character(height=1.8)) == Character(name, pronouns, 1.8)


@given(st.text(max_size=80), st.sampled_from(["Ada", "Tom", "Noor"]), st.sampled_from(["he", "she", "they"]))
def test_a_character_that_somebody_chose_stays(theme: str, name: str, pronouns: str) -> None:
    chosen = Character(name, pronouns, 1.6)
    assert cast_by(theme, chosen) == chosen


def test_a_request_acts_with_the_person_of_its_theme() -> None:
    assert StoryRequest("Anna comes home.").character == Character("Anna", "she")
    assert StoryRequest("Anna comes home.", character=Character("Bo", "he")).character == Character("Bo", "he")


def test_who_acts_is_whom_a_theme_is_about() -> None:
    def hero(theme: str) -> str:
        return hero_of(clauses_of_text(theme))

    assert hero("Once the last guest has gone, Teodor flings himself on the couch and kicks off his boots.") == "Teodor"
    assert hero("The bosun cannot sleep, so he rolls off the bed.") == "The bosun"
    assert hero("Rex, soft as butter, comes home, kneels and pats the puppy.") == "Rex"
    assert hero("Rain falls. Rain stops.") == hero("The kettle whistles and boils over.") == ""


def test_whose_mother_calls_is_the_hero_and_not_the_mother() -> None:
    clauses = clauses_of_text("A teenager lies on the bed and her mum calls her for dinner, she gets up and she goes.")
    assert hero_of(clauses).lower() == "a teenager"


def test_who_is_told_with_how_they_are_between_commas_is_the_hero() -> None:
    assert hero_of(clauses_of_text("Grandma Ilse, her back aching, shuffles in. She sits down.")) == "Grandma Ilse"


def test_a_baby_is_the_hero_only_where_nobody_is_he_or_she() -> None:
    assert hero_of(clauses_of_text("The baby is asleep. She tiptoes out.")) != "The baby"
    assert hero_of(clauses_of_text("The baby crawls to the sofa. It sits down.")) == "The baby"


@for_each(
    ("theme", "hero"),
    [
        ("The boy next door came round to return the drill, so Anselm thanked him. He hung a painting.", "Anselm"),
        ("A courier rings the bell. Oskar opens, signs for the parcel and unpacks it.", "Oskar"),
        ("Her mother calls, and Rosa sits down on the sofa, sighs and listens.", "Rosa"),
        ("Mr Novak's wife is away. He watches football and drinks beer.", "Mr Novak"),
        ("She shouted. He slammed the door, sat down and wept.", "He"),
        ("She shouted and wept. He slammed the door, sat down and wept.", "She"),
        # whoever does more is what it is about
        ("The courier carries parcels up the stairs, rests, drinks water and leaves. Anna closes the door.",
         "The courier"),
        ("Tom's mother is visiting. She inspects the shelves and sits down on the sofa.", "Tom's mother"),
    ],
)  # fmt: skip
def test_a_visitor_is_not_the_hero_where_somebody_with_a_name_does_as_much(theme: str, hero: str) -> None:
    assert hero_of(clauses_of_text(theme)) == hero


@for_each(
    ("theme", "theirs"),
    [
        ("Omar asked some friends over. Before they arrive he sets the table.", ["they arrive"]),
        ("Before they arrive he sets the table.", ["they arrive"]),
        ("No one calls, so he goes to bed.", ["No one calls"]),
        ("Nobody calls. He goes to bed.", ["Nobody calls"]),
        ("Ola and Ben come home. They sit down.", []),
        ("A tired student comes home. They sit down.", []),
        ("Nadia and her brother Karim dance. Karim sulks and leaves; Nadia laughs.", ["Nadia laughs"]),
        ("The couple quarrel: Joanna shouts and cries, Ben shrugs.", ["Ben shrugs"]),
        ("Dad plays with me, and we laugh.", []),
    ],
)
def test_what_several_others_or_nobody_do_is_not_the_heros(theme: str, theirs: list[str]) -> None:
    assert [one.text for one in beats_of(theme) if one.beat.kind == "other"] == theirs


@for_each(
    ("theme", "kinds"),
    [
        ("A robot named Bolt sweeps. It sits down. Bolt sleeps.", ["deed", "deed", "deed"]),
        ("A robot sweeps. It rains. It is late.", ["deed", "other", "other"]),
        ("Anna sits down. It sleeps.", ["deed", "other"]),
    ],
)
def test_it_is_the_hero_only_where_one_calls_a_hero_so(theme: str, kinds: list[str]) -> None:
    assert [one.beat.kind for one in beats_of(theme)] == kinds
