"""Screenplays, outlines, requests and chatter are read and told as the sentences that they stand for."""

from __future__ import annotations

from for_each import for_each

from motion_backend.motion import Character
from planner_service.evaluation.labels import labelled_themes
from planner_service.themes.beats import ThemeError, beats_of
from planner_service.themes.prose import prose_of
from planner_service.themes.protagonist import cast_by


@for_each(
    ("theme", "prose"),
    (
        ("INT. KITCHEN - DAWN. Marta fills the kettle.", "It is dawn in the kitchen. Marta fills the kettle."),
        ("EXT. BALCONY - NIGHT\nA man smokes.", "It is night on the balcony. A man smokes."),
        ("INT. FLAT - CONTINUOUS. Leo sleeps.", "The scene is the flat. Leo sleeps."),
        ("FADE IN: Leo drops his bag. CUT TO: Leo asleep.", "Leo drops his bag. Leo is asleep."),
        ("DANNY (40s, still in his boots) sits down.", "Danny, about forty, still in his boots, sits down."),
        ("Goal: leave the house. Obstacle: the key is gone.", "The goal is to leave the house. The key is gone."),
        ("Genre: drama. Character: a nurse. She sits down.", "There is a nurse. She sits down."),
        ("can u make one where a girl dances", "a girl dances"),
        ("Write a story about a man who loses his keys.", "a man loses his keys."),
        ("so basically my brother comes home lol", "my brother comes home"),
        ("My uncle he sits down. Then he sleeps.", "My uncle sits down. Then he sleeps."),
        ("me at 3am eating cheese", "at 3am I am eating cheese"),
        ("The floor's wet and Kwame's boss is late.", "The floor is wet and Kwame's boss is late."),
        ("She'd gone to bed, though she'd rather dance.", "She had gone to bed, though she would rather dance."),
        ("I've slept. He's sworn. It's raining.", "I have slept. He is sworn. It is raining."),
    ),
)
def test_what_is_no_sentence_is_said_in_one(theme: str, prose: str) -> None:
    assert prose_of(theme) == prose


@for_each(
    "theme",
    (
        "Who is there? asks Anna. “I'm not sure I've seen you before,” he says.",
        "He writes a list: milk, eggs, bread.",
        "The grandmother of the twins, she thinks, sleeps.",
        "A story is told to the children by the fire.",
        "Reading time. Anna reading by the window laughs.",
    ),
)
def test_prose_stays_as_it_is(theme: str) -> None:
    assert prose_of(theme) == theme


@for_each("theme", [one.theme for one in labelled_themes()])
def test_prose_is_made_once(theme: str) -> None:
    assert prose_of(prose_of(theme)) == prose_of(theme)


@for_each(
    ("theme", "name"),
    (
        ("INT. FLAT - NIGHT. DANNY (40s, in his boots) sits on the floor. Upstairs, a piano starts.", "Danny"),
        ("Character: a retired nurse. Want: to post the letter. She sits down.", "the retired nurse"),
        ("Setting: a one-room flat. Hero: Bashir, forty. He irons a shirt.", "Bashir"),
        ("Goal: leave. Obstacle: keys are not on the hook. They were in the bowl. Character sits down.", "Sam"),
        ("On Tuesday the doctor rang. On Wednesday Hester cleaned the oven. She sits down.", "Hester"),
    ),
)
def test_whom_an_outline_is_about_is_found(theme: str, name: str) -> None:
    assert cast_by(theme, Character()).name == name


@for_each(
    ("theme", "told"),
    (
        ("He sits down. Upstairs, a piano starts; he listens.", "starts"),
        ("A power cut catches him. He feels along the shelf for matches.", "catches him"),
        ("Two suitcases by the door. She lifts one.", "Two suitcases by the door"),
        ("Three cups on the table. Ilse waters the plant.", "Three cups on the table"),
        ("A novel on the rug. She picks it up.", "A novel on the rug"),
        ("Thirty-one essays on the dining table, one red pen. Tom sits down.", "Thirty-one essays on the dining table"),
    ),
)
def test_what_things_do_and_where_they_lie_is_no_deed_of_the_storys_person(theme: str, told: str) -> None:
    [beat] = [read.beat for read in beats_of(theme) if read.text.endswith(told)]
    assert beat.kind == "other"


def test_what_was_done_when_somebody_was_small_is_remembered() -> None:
    kinds = [
        read.beat.kind for read in beats_of("When I was small I hid under this table. Now I am old and I sit here.")
    ]
    assert kinds[:2] == ["memory", "memory"]
    assert kinds[-1] == "deed"


@for_each(
    ("theme", "is_refused"),
    (
        ("Can you tell me which is cheaper, a queen mattress or a spring one, and do they deliver on Sundays?", True),
        ("What are your opening hours? Do you take cards?", True),
        ("Where does she go when nobody watches? She goes to the kitchen and dances.", False),
        ("What if a burglar fell asleep? He creeps in and tests the sofa.", False),
    ),
)
def test_questions_that_tell_of_nobody_are_refused(theme: str, is_refused: bool) -> None:
    try:
        assert beats_of(theme)
    except ThemeError:
        assert is_refused
    else:
        assert not is_refused


@for_each(
    ("theme", "prose"),
    (
        ("Her morning: 1. make the bed 2. shower, 3. eat", "Her morning\nmake the bed\nshower\neat"),
        ("1) He wakes up. 2) He reads.", "He wakes up.\nHe reads."),
        ("Step 1: open the door. Step 2: leave.", "open the door.\nleave."),
        ("He lives at number 7. He sleeps.", "He lives at number 7. He sleeps."),
        ("She is 1. Then 3. She sits.", "She is 1. Then 3. She sits."),
    ),
)
def test_a_numbered_list_in_a_line_is_a_line_for_each_item(theme: str, prose: str) -> None:
    assert prose_of(theme) == prose


@for_each(
    ("theme", "prose"),
    (
        ("He did push ups, sit ups and squats.", "He did push-ups, did sit-ups and did squats."),
        (
            "She does twenty jumping jacks and a plank, then rests.",
            "She does twenty jumping jacks and does a plank, then rests.",
        ),
        ("He did star jumps and drank water.", "He did star-jumps and drank water."),
        ("After doing squats, he sits up and stretches.", "After doing squats, he sits up and stretches."),
    ),
)
def test_every_exercise_of_a_list_has_its_verb(theme: str, prose: str) -> None:
    assert prose_of(theme) == prose


def test_what_is_told_not_to_have_been_touched_at_all_is_no_deed() -> None:
    kinds = {one.text: one.beat.kind for one in beats_of("Before she touches a single plate, she sweeps the floor.")}
    assert kinds == {"sweeps the floor": "deed", "she touches a single plate": "other"}
