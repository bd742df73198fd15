"""What people do at home: each saying of the table is understood, and where a deed is done follows from its words."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest
from for_each import for_each

from motion_backend.motion import Skill
from motion_backend.props import held_in
from planner_service.composition.deed_lexicon import Deed, deed_of, row_of, without_gestures
from planner_service.composition.deed_table import DeedRow, deed_table
from planner_service.composition.furniture_words import listed_places, names_things, pieces_in, room_of, typical_of
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import past, third_person
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.things import things, things_called
from scene_graphs import furniture

FILLINGS = ("the old", "the", "", "herself", "a")
"""What a gap of a saying stands for."""


def clause(text: str) -> Clause:
    return clauses_of_text(f"She {text}.")[0]


def deed(text: str, about: str = "") -> Deed:
    found = deed_of(clause(text), about)
    assert found is not None, text
    return found


def ways(says: str) -> Iterator[list[str]]:
    """The saying with each of its words once."""
    slots = [each(word) for word in says.split()]
    for place, slot in enumerate(slots):
        for word in slot if len(slot) > 1 else slot[: place == 0]:
            yield [word if other == place else those[0] for other, those in enumerate(slots)]


def each(slot: str) -> list[str]:
    """The words of a slot; of a kind of things the first."""
    return [things_called(word[1:])[0] if word.startswith("@") else word for word in slot.split("|")]


def told(words: list[str]) -> Iterator[str]:
    """Clauses that say it, in the present and the past."""
    if words[0] in ("cannot", "..."):
        said = [" ".join(words if words[0] == "cannot" else [helper, *words]) for helper in ("has", "does")]
    else:
        said = [" ".join([form(words[0]), *words[1:]]) for form in (third_person, past)]
    for filling in FILLINGS:
        yield from (" ".join(one.replace("...", filling).replace("$", "").split()) for one in said)


def by_verb(says: str) -> Iterator[list[str]]:
    """The saying with each of its first words: verbs have forms, other words stand in the text as they are."""
    first, *others = (each(word) for word in says.split())
    yield from ([word, *(those[0] for those in others)] for word in first)


def now_and_then(says: str) -> Iterator[list[str]]:
    """The same of every fifth saying."""
    if len(says) % 5 == 0:
        yield from by_verb(says)


@pytest.mark.parametrize(
    "ways_of", [now_and_then, *(pytest.param(one, marks=pytest.mark.sweep) for one in (by_verb, ways))]
)
def test_every_saying_is_understood_as_its_row_or_another_of_its_skill(
    ways_of: Callable[[str], Iterator[list[str]]],
) -> None:
    """Else the saying can never be met, and whoever added it believes that it is."""
    rows = deed_table().deed
    place_of = {id(row): place for place, row in enumerate(rows)}
    dead = []
    for row in rows:
        for says in row.says:
            for words in ways_of(says):
                found = (place_of.get(id(one)) for text in told(words) for one in rows_of(text))
                if not any(
                    at is not None and rows[at].skill is row.skill and bool(rows[at].why) == bool(row.why)
                    for at in found
                ):
                    dead.append((row.says[0], " ".join(words)))
    assert dead == []


def rows_of(text: str) -> Iterator[DeedRow | None]:
    """What is read first, and what household instructions read, who look for no gesture."""
    for one in clauses_of_text(f"She {text}."):
        yield row_of(one, "")
        yield without_gestures(one)


@for_each(
    ("text", "skill", "piece"),
    [
        ("reads on the bed", Skill.LIEDOWN, "bed"),
        ("reads a book at the desk", Skill.SITDOWN, "office chair"),
        ("sleeps on the sofa", Skill.LIEDOWN, "sofa"),
        ("lies on the floor", Skill.LIEDOWN, "floor"),
        ("collapses into the armchair", Skill.SITDOWN, "armchair"),
        ("sinks onto the bed", Skill.LIEDOWN, "bed"),
        ("watches television on the loveseat", Skill.SITDOWN, "loveseat sofa"),
        ("puts the key on the nightstand", Skill.TOUCH, "nightstand"),
        ("walks to the wardrobe", Skill.LOCO, "wardrobe"),
        ("dances around the coffee table", Skill.LOCO, "coffee table"),
        ("looks for the ring under the bed", Skill.TOUCH, "bed"),
    ],
)
def test_furniture_that_is_named_wins(text: str, skill: Skill, piece: str) -> None:
    found = deed(text)
    assert (found.skill, found.pieces[0], found.named) == (skill, piece, True)


@for_each(
    ("text", "about", "piece"),
    [
        ("sits on it", "walks to the armchair", "armchair"),
        ("lies down there", "goes to the sofa", "sofa"),
        ("opens it", "walks to the wardrobe", "wardrobe"),
        ("puts it down", "takes the coat", "wardrobe"),
        ("opens it", "takes the parcel", "table"),
    ],
)
def test_it_is_what_was_named_before(text: str, about: str, piece: str) -> None:
    assert deed(text, about).pieces[0] == piece
    assert names_things(clause(about))


@for_each(
    ("text", "caption"),
    [
        ("works out", "squatting up and down"),
        ("works", "typing, both hands on the keyboard"),
        ("walks up and down", "pacing back and forth"),
        ("can't sleep", "lying with hands under head, legs crossed"),
        ("washes the dishes", "wash with both hands"),
        ("is sneaking to the kitchen", "walk on tiptoes"),
        ("listens at the door", "listening, right hand at the ear"),
        ("tosses her coat on the bed", "put down with the right hand"),
    ],
)
def test_captions_show_what_is_done(text: str, caption: str) -> None:
    assert caption in deed(text).row.captions


@for_each(
    ("text", "skill", "caption"),
    [
        ("He plonked himself down on the sofa", Skill.SITDOWN, ""),
        ("She puts the kettle on", Skill.TOUCH, "turn on with the right hand"),
        ("She had a quick nap", Skill.LIEDOWN, "lying still"),
        ("He tossed and turned", Skill.LIEDOWN, "lying with hands under head, legs crossed"),
        ("She was up at six", Skill.GETUP, ""),
        ("He reached for the top shelf", Skill.TOUCH, "An act of reaching high with the right hand"),
        ("I pinched the bridge of my nose", Skill.SITDOWN, "hands holding head, legs extended"),
        ("He shoved his hands in his pockets", Skill.LOCO, "strolling with hands in pockets"),
        ("She nodded", Skill.LOCO, "nodding the head"),
        ("She glanced about", Skill.LOCO, "looking around"),
        ("She did thirty jumping jacks", Skill.LOCO, "jumping jacks, arms and legs apart"),
        ("She did a jig", Skill.LOCO, "dancing steps, arms swinging"),
        ("He punched the air", Skill.LOCO, "cheering, right fist in the air"),
        ("He high-fived himself", Skill.LOCO, "skip steps running"),
        ("He staggered to the bedroom", Skill.LOCO, "walking drunkenly"),
        ("He stamped his foot", Skill.LOCO, "stomping heavily"),
        ("He rushed around like a headless chicken", Skill.LOCO, "rush anxiously forward"),
        ("He picked a sock up off the floor", Skill.TOUCH, "touch low height with the right hand"),
        ("He swept up the crumbs", Skill.LOCO, "sweeping the floor with both hands"),
        ("She fed the goldfish", Skill.TOUCH, "touch low height with the right hand"),
        ("She pruned the bonsai", Skill.TOUCH, ""),
        ("She wiped her face", Skill.LOCO, "wiping the face with the right hand"),
        ("She did the washing-up", Skill.TOUCH, "wash with both hands"),
        ("She shaved her legs", Skill.TOUCH, ""),
        ("She put on lipstick", Skill.LOCO, "wiping the face with the right hand"),
        ("She buttoned her coat", Skill.LOCO, "dressing, both hands at the chest"),
        ("He hung up his coat", Skill.TOUCH, "An act of reaching high with the right hand"),
        ("He loaded the dishwasher", Skill.TOUCH, "put down with the right hand"),
        ("She cleared the plates", Skill.TOUCH, ""),
        ("She ironed a shirt", Skill.TOUCH, ""),
        ("She rearranged the furniture", Skill.TOUCH, "put down with the right hand"),
        ("She changed a light bulb", Skill.TOUCH, "An act of reaching high with the right hand"),
        ("He wound the clock", Skill.TOUCH, "rotate with the right hand"),
        ("He cracked two eggs into a pan", Skill.TOUCH, ""),
        ("He rolled out the pastry", Skill.TOUCH, ""),
        ("He boiled an egg", Skill.TOUCH, ""),
        ("He heated up some soup", Skill.TOUCH, ""),
        ("She sipped her cocoa", Skill.SITDOWN, "drinking from a cup in the right hand"),
        ("He drank to her health", Skill.LOCO, "raising a cup in the right hand"),
        ("He picked at his food", Skill.SITDOWN, "eating at the table, right hand to the mouth"),
        ("She had a midnight snack", Skill.SITDOWN, "eating at the table, right hand to the mouth"),
        ("He buried his nose in a book", Skill.SITDOWN, "reading, book held in both hands"),
        ("She did the crossword", Skill.SITDOWN, "writing at the table, right hand moving"),
        ("She's working from home", Skill.SITDOWN, "typing, both hands on the keyboard"),
        ("She surfed the web", Skill.SITDOWN, "typing, both hands on the keyboard"),
        ("She sketched a bird", Skill.SITDOWN, "writing at the table, right hand moving"),
        ("She strummed the guitar", Skill.SITDOWN, "playing the guitar"),
        ("She was gaming all night", Skill.SITDOWN, "playing a game, controller held in both hands"),
        ("He hung up", Skill.TOUCH, "put down with the right hand"),
        ("He lit a candle", Skill.TOUCH, ""),
        ("She watched a movie", Skill.SITDOWN, "arms loosely, legs open"),
        ("He listened to a record", Skill.SITDOWN, "listening to music, both hands at the ears"),
        ("I'm taking it easy", Skill.SITDOWN, "lying back in chair, arms relaxed at sides"),
        ("She racked her brains", Skill.SITDOWN, "right hand on chin, thinking"),
        ("She said her prayers", Skill.LOCO, "praying, palms together"),
        ("She cried her eyes out", Skill.LOCO, "crying, face in both hands"),
        ("She bawled", Skill.LOCO, "crying, face in both hands"),
        ("He turned the place upside down", Skill.TOUCH, ""),
        ("He drew the blinds", Skill.TOUCH, ""),
        ("He tore the letter to shreds", Skill.TOUCH, ""),
        ("He slips in the hall", Skill.LOCO, "walking drunkenly"),
        ("She nearly falls", Skill.LOCO, "walking drunkenly"),
        ("He stubs his toe on the chair", Skill.LOCO, "walking drunkenly"),
        ("She turns over", Skill.LIEDOWN, "side-lie on right"),
        ("She thanked him", Skill.LOCO, "tap chest lightly with both hands"),
        ("He kicks the shelf", Skill.LOCO, "kicking with the right foot"),
        ("She looked for a long time at the plate", Skill.LOCO, "stand still"),
        ("He looks into the living room", Skill.LOCO, "stand still"),
        ("She rehearses in front of the mirror", Skill.TOUCH, ""),
        ("He starts a new page", Skill.SITDOWN, "writing at the table, right hand moving"),
        ("She went back to her crossword", Skill.SITDOWN, "reading, book held in both hands"),
        ("He rocks the baby to sleep", Skill.LOCO, "hugging to the chest with both arms"),
        ("She wraps herself in a blanket", Skill.LOCO, "walking with the arms wrapped around the body"),
        ("He stood there with his hands on his hips", Skill.LOCO, "walking with hands placed on the hips"),
        ("She sits with her hands over her ears", Skill.SITDOWN, "listening to music, both hands at the ears"),
        ("He crawls under the bed", Skill.TOUCH, "touch low height"),
        ("She checks the window", Skill.TOUCH, "An act of reaching high"),
        ("He throws open the door", Skill.TOUCH, "rotate with the right hand"),
        ("She slides to the floor", Skill.SITDOWN, ""),
        ("She walks into the kitchen", Skill.LOCO, ""),
        ("She samples the punch", Skill.SITDOWN, "drinking from a cup in the right hand"),
        ("He heaves himself out of the armchair", Skill.STANDUP, ""),
        ("She flattened herself against the floorboards", Skill.LIEDOWN, ""),
        ("He hops twice", Skill.LOCO, "jumping up and down"),
        ("She scrapes the icing off the rug", Skill.TOUCH, "touch low height"),
        ("He stares at the wall", Skill.LOCO, "stand still"),
        ("She slips on her headphones", Skill.SITDOWN, "listening to music, both hands at the ears"),
        ("She brushes the fluff off her knees", Skill.TOUCH, "touch low height"),
    ],
)
def test_everyday_english_is_shown_as_a_fair_viewer_would_expect(text: str, skill: Skill, caption: str) -> None:
    found = deed_of(clauses_of_text(f"{text}.")[0])
    assert found is not None
    assert found.skill is skill
    assert not caption or caption in found.row.captions


@for_each("text", ["pokes the contraption", "nudges the obelisk", "opens the casket"])
def test_what_hands_do_to_a_thing_nobody_knows_is_done_at_a_table_and_only_stood_for(text: str) -> None:
    found = deed(text)
    assert (found.skill, found.pieces[0], found.row.stands, found.named) == (Skill.TOUCH, "table", True, False)


@for_each(
    ("text", "piece"),
    [
        ("drapes fairy lights over the wardrobe", "wardrobe"),
        ("lights a candle", "table"),
        ("unblocks the plughole", "kitchen sink"),
        ("changes the mattress", "bed"),
        ("Kettle on", "kitchen counter"),
        ("gloves off", "wardrobe"),
    ],
)
def test_things_are_put_where_it_is_said_and_used_where_they_are(text: str, piece: str) -> None:
    said = clauses_of_text(f"She {text}." if text[0].islower() and " off" not in text else f"Home. {text}.")[-1]
    found = deed_of(said)
    assert found is not None
    assert found.pieces[0] == piece


@for_each("text", ["has lost her reading glasses", "sees a mouse", "owns a piano"])
def test_what_is_no_deed_is_played_by_no_noun_of_its_words(text: str) -> None:
    assert deed(text).row.why


@for_each(
    ("text", "pieces"),
    [
        ("searches the study, the kitchen and the bathroom", ["desk", "kitchen cabinet", "bathroom cabinet"]),
        ("cleans the kitchen", ["kitchen cabinet"]),
        ("rummages through the bedroom and the hall", ["wardrobe", "console table"]),
        ("opens the bedroom door", []),
        ("walks from the study to the hall", []),
    ],
)
def test_rooms_that_something_is_done_to_have_their_typical_furniture(text: str, pieces: list[str]) -> None:
    assert typical_of(text) == pieces


@for_each(
    ("text", "pieces"),
    [
        ("looks under the cushions, in the fridge, even behind the sofa", ["sofa", "refrigerator"]),
        ("turns on the radio, the television and the tap", ["tv stand", "kitchen sink"]),
        ("puts the plates and the book on the shelf", []),
        ("looks under the bed", []),
    ],
)
def test_a_list_of_places_is_one_piece_of_furniture_each(text: str, pieces: list[str]) -> None:
    assert listed_places(clause(text)) == pieces


@for_each("text", ["returns to the living room", "moves to the window", "takes the tray to the kitchen", "goes home"])
def test_ways_are_gone(text: str) -> None:
    assert (deed(text).skill, deed(text).row.why) == (Skill.LOCO, "")


@for_each("text", ["governs the universe", "is hot", "expands", "believes in ghosts", "knows the answer"])
def test_what_no_body_does_at_home_is_no_deed(text: str) -> None:
    assert deed_of(clause(text)) is None


@for_each("text", ["leaves for work", "gets married", "misses the bus", "goes shopping"])
def test_what_happens_elsewhere_has_a_reason_not_to_be_acted(text: str) -> None:
    assert deed(text).row.why


@for_each(
    ("text", "pieces"),
    [
        ("sits at the dining table near the sofa", ["dining table", "sofa"]),
        ("looks at the tv", ["tv stand"]),
        ("hangs a picture, a clock and a mirror", ["picture", "clock", "mirror"]),
        ("holds her chest", []),
        ("opens the photo album near the picture", ["picture"]),
        ("", []),
    ],
)
def test_furniture_words_are_found_in_their_order_the_longest_first(text: str, pieces: list[str]) -> None:
    assert pieces_in(text) == pieces


def test_words_make_one_think_of_a_room() -> None:
    rooms = [room_of(clause(text)) for text in ("cooks", "does her homework", "sleeps in the bed", "sings")]
    assert rooms == ["dining_room", "study", "bedroom", None]


def test_every_furniture_word_of_the_table_is_known_and_affords_what_is_done_there() -> None:
    table = deed_table()
    words = {word for places in things().values() for word in places}
    words |= {*table.stands_on.values(), *table.seats_at}
    words |= {seat for seats in table.seats_at.values() for seat in seats}
    words |= {piece for those in table.usual.values() for pieces in those.values() for piece in pieces}
    words |= {piece for row in table.deed for piece in row.at if piece != "floor"}
    assert not {word for word in words if not furniture.is_known(word)}
    for room, those in table.usual.items():
        for need, pieces in those.items():
            assert not [piece for piece in pieces if need not in furniture.affordances(piece)], (room, need)
    for row in table.deed:
        done = NEEDS.get(row.skill)
        assert not done or not [piece for piece in row.at if not affords(piece, done)], (row.says[0], row.at)


@for_each(
    ("change", "fault"),
    [
        (lambda row: replace(row, captions=("flies",)), "flies"),
        (lambda row: replace(row, at=("throne of gold",)), "throne of gold"),
        (lambda row: replace(row, mood="beige"), "beige"),
        (lambda row: replace(row, lying=("flies",)), "flies"),
        (lambda row: replace(row, seated=("flies",)), "flies"),
    ],
)
def test_a_row_with_a_word_nobody_knows_is_refused_by_it(change: Callable[[DeedRow], DeedRow], fault: str) -> None:
    table = deed_table()
    with pytest.raises(ValueError, match=fault):
        replace(table, deed=(change(table.deed[3]),))


YAWNS, THROWS, JUMPS = "yawning, right hand at the mouth", "throwing with the right hand", "jumping up and down"
PHONE, TOES, HIDES = (
    "looking at the phone in the right hand",
    "bending down, hands to the toes",
    "crouching low, arms over the head",
)
DRESSES, KISSES, SCRATCHES = (
    "dressing, both hands at the chest",
    "kissing what both hands hold",
    "scratching the head with the right hand",
)
EATS, GASPS, SHUTS = (
    "eating while standing, right hand to the mouth",
    "covering the mouth with both hands",
    "covering the ears with both hands",
)
TALKS = "talking with both hands"
PRAYS, LOOKS_UP = "praying, palms together", "looking up, head tilted back"
SHOES, KICKS = "bending to the feet, both hands at the ankles", "kicking with the right foot"


@for_each(
    ("text", "caption"),
    [
        ("checks her phone", PHONE), ("texts her sister", PHONE), ("takes a selfie", PHONE),
        ("reads a text on her phone", PHONE), ("scrolls through her messages on the phone", PHONE),
        ("yawns", YAWNS), ("stifles a yawn", YAWNS), ("gives a huge yawn", YAWNS),
        ("throws a pillow at the wall", THROWS), ("hurls the vase across the room", THROWS),
        ("tosses the ball to the dog", THROWS), ("flings her slipper at the spider", THROWS),
        ("jumps up and down", JUMPS), ("jumps for joy", JUMPS), ("skips rope", JUMPS),
        ("does twenty star jumps", "jumping jacks, arms and legs apart"),
        ("leaps into the air", JUMPS), ("touches her toes", TOES), ("bends over", TOES), ("ties her laces", TOES),
        ("takes off her shoes", TOES), ("pulls her boots on", TOES), ("hides behind the sofa", HIDES),
        ("cowers in the corner", HIDES), ("hides under the desk", HIDES), ("ducks", HIDES), ("gets dressed", DRESSES),
        ("knots her tie", DRESSES), ("puts on her jacket", DRESSES), ("changes into her pyjamas", DRESSES),
        ("takes off her coat", DRESSES), ("kisses the photograph", KISSES), ("blows a kiss", KISSES),
        ("presses the letter to her lips", KISSES), ("scratches her head", SCRATCHES),
        ("runs a hand through her hair", SCRATCHES), ("eats standing at the counter", EATS), ("licks the spoon", EATS),
        ("eats straight from the pan", EATS), ("gasps", GASPS), ("claps a hand over her mouth", GASPS),
        ("stifles a scream", GASPS), ("covers her ears", SHUTS), ("presses her hands over her ears", SHUTS),
        ("prays", PRAYS), ("makes a wish", PRAYS), ("folds her hands in prayer", PRAYS),
        ("looks up at the stars", LOOKS_UP), ("gazes at the moon", LOOKS_UP), ("tilts her head back", LOOKS_UP),
        ("rubs her sore feet", SHOES), ("says grace", "praying while seated, palms together"),
        ("kicks off her shoes", KICKS), ("pulls on her trousers", TOES), ("straightens her skirt", DRESSES),
        ("smooths his shirt", DRESSES), ("finds them on top of her own head", SCRATCHES),
        ("calls from the hall", "shouting, hands cupped at the mouth"), ("bickers over the map", TALKS),
        ("talks it over with her", TALKS), ("hugs", "hugging to the chest with both arms"),
        ("is on a video call with his boss", "talking while seated, with both hands"),
        ("listens to the rain", "listening, right hand at the ear"),
    ],
)  # fmt: skip
def test_what_limbs_and_head_do_is_a_gesture(text: str, caption: str) -> None:
    found = deed(text)
    assert found.is_gesture
    assert caption in found.row.captions


@for_each(
    "text",
    [
        "throws herself on the bed", "throws up", "throws a party", "throws open the window", "throws a tantrum",
        "throws the cup in the bin", "throws her coat on the chair", "tosses and turns", "puts on some music",
        "puts on the kettle", "jumps to a conclusion", "jumps out of bed", "hops into bed", "looks up a word",
        "looks up from her book", "kisses her goodnight", "kisses the baby", "hides the letter",
        "hides a key under the mat", "hides her face", "checks the stove", "picks up the phone",
        "puts the phone down", "holds the phone to her ear", "dresses the wound", "dresses the salad",
        "changes the sheets", "changes her mind", "changes the channel", "ties a knot", "gasps for breath",
        "bends her knees", "bites her lip", "scratches the cat", "puts a hand on her ear", "eats at the table",
        "skips breakfast", "begs the question", "takes off the lid",
    ],
)  # fmt: skip
def test_the_same_words_of_something_else_are_not(text: str) -> None:
    new = {
        YAWNS, THROWS, JUMPS, PHONE, TOES, HIDES, DRESSES, KISSES, SCRATCHES, EATS, GASPS, SHUTS, PRAYS, LOOKS_UP,
        KICKS,
    }  # fmt: skip
    found = deed_of(clause(text))
    assert found is None or not new & set(found.row.captions)


@for_each(
    ("text", "skill", "caption"),
    [
        ("checks her phone on the sofa", Skill.SITDOWN, "looking at the phone while seated, in the right hand"),
        ("takes off her shoes on the bed", Skill.SITDOWN, SHOES),
        ("yawns in the armchair", Skill.SITDOWN, "yawning while seated, right hand at the mouth"),
        ("scrolls on her phone on the bed", Skill.LIEDOWN, "reading on the back, book held above the chest"),
    ],
)
def test_where_a_seat_is_named_it_is_done_there(text: str, skill: Skill, caption: str) -> None:
    found = deed(text)
    assert (found.skill, found.named) == (skill, True)
    assert caption in found.row.captions


TOASTS, SIGHS = "raising a cup in the right hand", "sighing, shoulders sinking"
SHOUTS, WATCH = "shouting, hands cupped at the mouth", "looking at the wrist"
LISTENS, BLOWS = "listening, right hand at the ear", "blowing, hands before the mouth"
TAPS, TEETH = "tapping the foot, arms crossed", "brushing the teeth with the right hand"
DRIES, LIFTS = "drying the hair with both hands", "lifting weights with both hands"
SINGS, POINTS = "singing, right hand before the mouth", "pointing with the right hand"
KNEELS, KNEELS_TO_PRAY = "kneeling on the floor, hands on thighs", "praying while kneeling, palms together"
NODS_OFF, ON_ARMS = "asleep in the seat, head sunk to the chest", "head on folded arms on the table"


@for_each(
    ("text", "caption"),
    [
        ("proposes a toast", TOASTS), ("raises her glass", TOASTS), ("toasts the photograph", TOASTS),
        ("raises a mug to the moon", TOASTS), ("sighs", SIGHS), ("heaves a sigh", SIGHS), ("exhales", SIGHS),
        ("takes a deep breath", SIGHS), ("breathes in deeply", SIGHS), ("lets out a long breath", SIGHS),
        ("shouts", SHOUTS), ("yells for help", SHOUTS), ("screams", SHOUTS), ("calls out her name", SHOUTS),
        ("calls up the stairs", SHOUTS), ("checks her watch", WATCH), ("glances at her watch", WATCH),
        ("checks the time", WATCH), ("listens at the door", LISTENS), ("eavesdrops", LISTENS),
        ("pricks up her ears", LISTENS), ("strains to hear the neighbours", LISTENS),
        ("puts an ear to the wall", LISTENS), ("blows out the candles", BLOWS), ("blows on the soup", BLOWS),
        ("blows on her fingers", BLOWS), ("blows up a balloon", BLOWS), ("waits impatiently", TAPS),
        ("taps her foot", TAPS), ("brushes her teeth", TEETH), ("flosses her teeth", TEETH), ("dries her hair", DRIES),
        ("towels off", DRIES), ("rubs her hair dry", DRIES), ("lifts weights", LIFTS), ("pumps iron", LIFTS),
        ("does bicep curls", LIFTS), ("works out with dumbbells", LIFTS), ("sings into a hairbrush", SINGS),
        ("sings along with the radio", SINGS), ("bursts into song", SINGS), ("points at the door", POINTS),
        ("wags a finger at the dog", POINTS), ("accuses the empty chair", POINTS), ("kneels on the rug", KNEELS),
        ("kneels by the bed", KNEELS), ("falls to her knees", KNEELS), ("prays on her knees", KNEELS_TO_PRAY),
        ("kneels in prayer", KNEELS_TO_PRAY), ("nods off", NODS_OFF), ("falls asleep in her chair", NODS_OFF),
        ("dozes over the crossword", NODS_OFF), ("falls asleep sitting up", NODS_OFF),
        ("falls asleep in front of the tv", NODS_OFF), ("lays her head on her arms", ON_ARMS),
        ("puts her head down on the table", ON_ARMS), ("falls asleep at the desk among her books", ON_ARMS),
        ("slumps over the keyboard", ON_ARMS),
    ],
)  # fmt: skip
def test_what_is_told_of_voice_breath_knees_and_sleep_is_a_gesture(text: str, caption: str) -> None:
    found = deed(text)
    assert found.is_gesture
    assert caption in found.row.captions


@for_each(
    "text",
    [
        "makes toast", "makes a toast with butter", "lifts the cup to her lips", "raises the mug from the table",
        "breathes in the scent of the roses", "breathes on the window", "roars with laughter",
        "shouts into the phone", "screams into a pillow", "looks at the clock", "checks the oven one more time",
        "winds her watch", "listens to the radio", "puts the phone to her ear", "puts her hands to her ears",
        "blows her nose", "blows a kiss", "taps her foot to the music", "waits", "brushes the dog", "brushes her hair",
        "brushes her daughter's teeth", "dries the dishes", "dries her tears", "works out", "lifts the lid",
        "sings a lullaby to the baby", "hums", "points out that it is late", "points the remote at the tv",
        "kneels to look under the bed", "gets down on her hands and knees", "goes down on one knee",
        "falls asleep", "falls asleep on the sofa", "nods", "nods off on her feet", "rests her head in her hands",
        "lays her head on the pillow", "lays her head on his shoulder",
    ],
)  # fmt: skip
def test_words_of_them_that_mean_something_else_are_none(text: str) -> None:
    new = {
        TOASTS, SIGHS, SHOUTS, WATCH, LISTENS, BLOWS, TAPS, TEETH, DRIES, LIFTS, SINGS, POINTS, KNEELS_TO_PRAY,
        NODS_OFF, ON_ARMS,
    }  # fmt: skip
    found = deed_of(clause(text))
    assert found is None or not new & set(found.row.captions)


@for_each(
    ("text", "skill", "caption"),
    [
        ("raises her glass in the armchair", Skill.SITDOWN, "raising a cup while seated, in the right hand"),
        ("sighs in the armchair", Skill.SITDOWN, "sighing while seated, shoulders sinking"),
        ("dozes in the rocking chair", Skill.SITDOWN, NODS_OFF),
    ],
)
def test_who_is_told_to_sit_toasts_sighs_and_nods_off_there(text: str, skill: Skill, caption: str) -> None:
    found = deed(text)
    assert found.skill is skill
    assert caption in found.row.captions


def test_who_sings_at_work_does_the_work() -> None:
    clauses = clauses_of_text("She sweeps the floor, singing.")
    shown = [deed_of(one) for one in clauses]
    assert SINGS not in [caption for one in shown if one is not None for caption in one.row.captions]
    assert SINGS in deed("sings").row.captions


@for_each(
    ("text", "caption", "tool"),
    [
        ("chops the onions", "knocking with the right hand", "knife"),
        ("cuts it into slices", "knocking with the right hand", "knife"),
        ("peels potatoes", "wiping with the right hand", "knife"),
        ("butters a slice of toast", "wiping with the right hand", "butter knife"),
        ("kneads the dough", "wash with both hands", "dough"),
        ("irons a blouse", "wiping with the right hand", "iron"),
        ("folds the laundry", "wash with both hands", "linen"),
        ("cuts out a star", "stirring with the right hand", "scissors"),
        ("sews a button on his coat", "knitting, both hands in the lap", "needle"),
        ("repairs the chair with a hammer", "knocking with the right hand", "hammer"),
        ("tightens the screws", "rotate with the right hand", "screwdriver"),
        ("polishes his boots", "wiping with the right hand", "brush"),
        ("paints the wall", "wiping with the right hand", "paintbrush"),
        ("sprays some perfume on her neck", "wiping the face with the right hand", "perfume"),
        ("shaves", "wiping the face with the right hand", "razor"),
        ("smokes a cigarette", "eating while standing, right hand to the mouth", "cigarette"),
        ("vacuums the living room", "sweeping the floor with both hands", "vacuum"),
        ("mops the floor", "sweeping the floor with both hands", "mop"),
    ],
)
def test_what_is_done_with_a_tool_is_done_with_it_in_the_hand_and_a_motion_that_fits(
    text: str, caption: str, tool: str
) -> None:
    found = deed(text).row
    assert caption in found.captions
    assert found.holds == tool
    assert held_in(found.skill, caption, tool) is not None


@for_each("text", ["cuts his finger", "mops his brow", "folds her arms", "shaves her legs", "brushes her teeth"])
def test_what_is_done_to_the_body_has_no_tool_of_a_house(text: str) -> None:
    found = row_of(clauses_of_text(f"She {text}.")[0], "")
    assert found is None or not found.holds


@for_each("text", ["drops a glass", "drops the vase by accident", "fumbles with the keys"])
def test_what_nobody_could_see_is_named_and_nobody_walks_to_a_table_for_it(text: str) -> None:
    assert deed(text).row.why


@for_each("text", ["washes her hands of it", "jumps to conclusions", "cooks the books", "wipes the floor with him",
                   "puts up with it", "sleeps on it", "throws a party", "falls in love"])  # fmt: skip
def test_idioms_mean_nothing_that_their_words_say(text: str) -> None:
    assert deed(text).row.why


@for_each("text", ["washes her hands", "jumps to her feet", "cooks the fish", "wipes the floor", "puts the box up",
                   "sleeps on the sofa", "throws a ball", "kicks the ball", "falls into bed", "holds the key",
                   "picks up the bill", "takes it out of the box", "moves to the sideboard", "draws a line",
                   "pulls the plug", "stands by the window", "carries the tray"])  # fmt: skip
def test_words_of_idioms_that_mean_what_they_say_are_done(text: str) -> None:
    assert not deed(text).row.why


@for_each(
    ("text", "caption"),
    [
        ("snivels", "crying, face in both hands"),
        ("doubles up with laughter", "laughing, hands on belly"),
        ("huffs", "sighing, shoulders sinking"),
        ("arches her back", "stretching, both arms overhead"),
        ("natters with her friend", "talking with both hands"),
        ("gives a nod", "nodding the head"),
        ("declines politely", "shaking the head"),
        ("throws up her hands", "shrugging, palms up"),
        ("weighs up the options", "right hand on chin, thinking"),
        ("quivers", "shivering, arms wrapped tightly"),
        ("has a coughing fit", "covering the mouth with both hands"),
        ("bursts into song", "singing, right hand before the mouth"),
        ("tackles the housework", "wiping with the right hand"),
        ("does the hoovering", "sweeping the floor with both hands"),
        ("sheds her coat", "dressing, both hands at the chest"),
        ("does her taxes", "writing at the table, right hand moving"),
        ("updates her website", "typing, both hands on the keyboard"),
        ("hits snooze", "turn on with the right hand"),
        ("tidies up", "put down with the right hand"),
        ("faints", "lying still"),
        ("says goodbye to them", "wave with the right hand"),
    ],
)
def test_ways_to_say_it_are_shown_as_what_they_say(text: str, caption: str) -> None:
    assert caption in deed(text).row.captions


@for_each(
    ("text", "caption"),
    [
        ("reads the message", "looking at the phone in the right hand"),
        ("answers a message on his phone", "looking at the phone in the right hand"),
        ("types an answer", "looking at the phone in the right hand"),
        ("reads the letter", "reading while standing, paper in both hands"),
        ("calls his dog", "shouting, hands cupped at the mouth"),
        ("calls his mother", "walk while talking on the phone with the right hand"),
        ("argues with her boyfriend on the phone", "walk while talking on the phone with the right hand"),
    ],
)
def test_messages_are_on_a_screen_and_animals_are_shouted_for(text: str, caption: str) -> None:
    assert caption in deed(text).row.captions


def test_no_saying_stands_twice_since_the_later_one_would_never_be_found() -> None:
    for rows in (deed_table().deed, deed_table().gesture):
        sayings = [saying for row in rows for saying in row.says]
        assert len(sayings) == len(set(sayings))
        assert all(row.says for row in rows)
