"""Keyframes written for beats: all that is asked for is shown or named, in order, and nothing else is acted."""

from __future__ import annotations

import re
from functools import cache

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Emotion, Skill
from planner_service.composition.beat_planner import PartFinder
from planner_service.composition.compose import compose
from planner_service.composition.deed_lexicon import deed_of
from planner_service.composition.furniture_words import pieces_in
from planner_service.composition.request import Request
from planner_service.composition.unacted_beats import NOT_ACTED, SPOKEN_OF
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.script import HAPPENS, WISHED, LongScript, PlannedKeyframe
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.scripts.script_repair import check
from planner_service.themes.beats import ThemeError, beats_of
from scene_graphs import furniture

DEEDS = (
    "sits down", "sits on the sofa", "reads a book", "drinks tea", "eats dinner", "falls asleep", "lies on the bed",
    "gets up", "stands up", "walks to the window", "paces", "dances", "washes the dishes", "opens the wardrobe",
    "searches for the keys", "types an email", "writes a letter", "watches television", "cries", "listens to music",
    "wakes up", "cannot sleep", "phones a friend", "waters the plants", "looks out of the window", "puts the book down",
    "is happy", "becomes very sad", "feels tired", "gets angry", "rests", "meditates", "sneaks to the kitchen",
    "takes a shower", "remembers the war", "yodels", "goes to bed", "thinks", "waits", "lies awake",
    "turns on the lamp",
)  # fmt: skip
UNDONE = ("does not sit down", "never lies down", "refuses to dance", "wants to sleep", "does not open the wardrobe")
THEMES = st.lists(st.sampled_from(DEEDS + UNDONE), min_size=1, max_size=7).map(
    lambda deeds: " ".join(f"She {deed}." for deed in deeds)
)
HOMES = st.fixed_dictionaries(
    {},
    optional={
        "living_room": st.sampled_from(
            [frozenset({"loveseat_sofa", "coffee_table"}), frozenset({"armchair", "bookshelf"})]
        ),
        "bedroom": st.sampled_from(
            [frozenset({"double_bed", "wardrobe"}), frozenset({"single_bed", "nightstand", "lounge_chair"})]
        ),
        "study": st.sampled_from(
            [frozenset({"desk", "office_chair"}), frozenset({"desk", "folding_chair", "cabinet"})]
        ),
    },
).filter(bool)


@cache
def library() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


def planned(theme: str, **asked: object) -> LongScript:
    return compose(theme, library(), Request(**asked))  # type: ignore[arg-type]


def planned_or_refused(theme: str, **asked: object) -> LongScript | None:
    """None where the theme has nothing that can be acted, which is said."""
    try:
        return planned(theme, **asked)
    except ThemeError:
        return None


def own(script: LongScript) -> list[PlannedKeyframe]:
    """The keyframes that are more than ways to others."""
    return [keyframe for keyframe in script.keyframes if not connects(keyframe)]


def test_nobody_gets_up_and_sits_down_again_for_what_that_would_not_show() -> None:
    script = planned("He drinks tea on the sofa while looking at a photo.")
    assert [keyframe.skill for keyframe in script.keyframes].count(Skill.SITDOWN) == 1
    assert [beat.stood_for for beat in script.beats] == [False, True]


@tries(80)
@given(THEMES, st.integers(0, 3))
def test_every_beat_is_shown_in_order_or_there_is_a_reason_and_a_body_can_act_it(theme: str, seed: int) -> None:
    script = planned_or_refused(theme, seed=seed)
    if script is None:
        return
    assert not check(script)
    served = [keyframe.beat for keyframe in script.keyframes]
    if None in served:  # somebody of whom nothing can be acted is merely seen
        assert served == [None]
        assert all(beat.why for beat in script.beats)
        return
    assert served == sorted(beat for beat in served if beat is not None)
    assert all(served.count(beat) <= 4 for beat in served)
    shown = {beat for keyframe in script.keyframes for beat in (keyframe.beat, *keyframe.also)}
    moods = {keyframe.mood for keyframe in script.keyframes}
    for place, beat in enumerate(script.beats):
        if beat.kind in NOT_ACTED:
            assert beat.why in (NOT_ACTED[beat.kind], SPOKEN_OF, WISHED, HAPPENS)
            assert place not in shown
        elif not beat.why:
            assert place in shown or beat.emotion in moods
        else:
            assert place not in shown
    assert planned(theme, seed=seed).model_dump_json() == script.model_dump_json()


@tries(60)
@given(THEMES)
def test_keyframes_are_in_the_mood_of_their_beat(theme: str) -> None:
    script = planned_or_refused(theme)
    if script is None:
        return
    for keyframe in own(script):
        if keyframe.beat is None:  # somebody who is merely seen
            continue
        beat = script.beats[keyframe.beat]
        moods = {beat.emotion, *(script.beats[also].emotion for also in keyframe.also)}
        row = deed_of(beats_of(theme)[keyframe.beat].clause)
        if beat.emotion is Emotion.NEUTRAL and row is not None and row.row.mood:
            moods.add(Emotion(row.row.mood))
        assert keyframe.mood in moods or keyframe.skill in (Skill.STANDUP, Skill.GETUP), (keyframe, beat)


@tries(60)
@given(THEMES)
def test_what_is_not_done_is_not_acted_unless_another_beat_asks_for_it(theme: str) -> None:
    script = planned_or_refused(theme)
    if script is None:
        return
    done = {deed.skill for one in beats_of(theme) if one.beat.kind == "deed" and (deed := deed_of(one.clause))}
    lying = re.search(r"wakes up|gets up", theme) or Skill.LIEDOWN in done
    if "never lies down" in theme and not lying:
        assert Skill.LIEDOWN not in {keyframe.skill for keyframe in script.keyframes}
    if "does not sit down" in theme:
        for keyframe in script.keyframes:
            beat = script.beats[keyframe.beat or 0].text
            assert keyframe.skill is not Skill.SITDOWN or re.search(r"sits|sofa|stands up|gets up", beat), beat


@tries(60)
@given(THEMES, HOMES)
def test_in_a_given_home_only_its_furniture_is_used_unless_the_theme_names_a_piece(
    theme: str, home: dict[str, frozenset[str]]
) -> None:
    script = planned_or_refused(theme, furniture=home)
    if script is None:
        return
    assert not check(script)
    known = frozenset[str]().union(*home.values())
    named = {kind for word in pieces_in(theme) for kind in furniture.categories_of(word)}
    for keyframe in script.keyframes:
        if not keyframe.on_floor:
            assert furniture.categories_of(keyframe.piece[0]) & (known | named), keyframe


@tries(40)
@given(THEMES, st.integers(1, 5))
def test_seeds_change_captions_and_scripts_and_not_what_is_done(theme: str, seed: int) -> None:
    first, other = planned_or_refused(theme), planned_or_refused(theme, seed=seed)
    assert (first is None) == (other is None)
    if first is None or other is None:
        return
    assert [(beat.text, beat.why) for beat in first.beats] == [(beat.text, beat.why) for beat in other.beats]
    did = [[(keyframe.beat, keyframe.skill) for keyframe in own(script)] for script in (first, other)]
    assert did[0] == did[1]


@tries(40)
@given(THEMES)
def test_parts_of_scripts_do_the_beats_deed_in_its_mood_with_a_caption_that_shows_it(theme: str) -> None:
    read = beats_of(theme)
    for place, part in PartFinder(library()).all_of(read).items():
        deed = deed_of(read[place].clause)
        assert deed is not None
        last = part.keyframes[-1]
        assert last.skill is deed.skill
        assert last.mood is read[place].beat.emotion is part.script.emotion
        captions = deed.row.captions if deed.skill is deed.row.skill else deed.row.seated
        assert not captions or last.caption in captions
        assert all(keyframe.skill is Skill.LOCO for keyframe in part.keyframes[:-1])
        assert len(part.keyframes) <= 2
        named = [furniture.categories_of(piece) for piece in deed.pieces if piece != "floor"]
        assert not named or any(furniture.categories_of(last.piece[0]) & kinds for kinds in named)


@for_each(
    ("theme", "told"),
    [
        ("She walks to the desk and sits down.", ["loco desk", "loco office chair", "sitdown office chair"]),
        ("He sits on the sofa and reads.", ["loco sofa", "sitdown sofa"]),
        ("He lies on the sofa and reads.", ["loco sofa", "liedown sofa"]),
        ("She wakes up.", ["liedown bed", "getup bed"]),
        ("She wakes up. She gets out of bed.", ["liedown bed", "getup bed"]),
        ("He sits on the sofa. He thinks. He reads.", ["loco sofa", "sitdown sofa", "sitdown sofa"]),
        ("She wakes up. She sits up. She gets out of bed.", ["liedown bed", "sitdown bed", "standup bed"]),
        ("He is sad.", ["loco floor"]),
        ("She sits on the sofa. She is sad.", ["loco sofa", "sitdown sofa"]),
        ("He dances.", ["loco floor"]),
        ("She does not sit down. She reads.", ["loco floor"]),
        ("She sits on the sofa and cries.", ["loco sofa", "sitdown sofa"]),
        ("He throws his bag on the sofa and cries.", ["loco sofa", "touch sofa", "loco floor"]),
        (
            "He sits on the sofa, laughs, cries and bows.",
            ["loco sofa", *["sitdown sofa"] * 2, "standup sofa", "loco floor"],
        ),
        ("She wakes up. She lies there and calls her mother.", ["liedown bed", "liedown bed"]),
        (
            "She takes the album from the shelf, sits on the sofa and closes the album.",
            ["loco shelf", "touch shelf", "loco sofa", "sitdown sofa"],
        ),
        ("She bows to the floor lamp.", ["loco floor lamp", "loco floor"]),
        ("She flops onto the sofa and watches a film.", ["loco sofa", "liedown sofa"]),
        ("He looks under the bed, behind the sofa.", ["loco bed", "touch bed", "loco sofa", "touch sofa"]),
    ],
)
def test_as_few_keyframes_as_show_it_are_written(theme: str, told: list[str]) -> None:
    script = planned(theme)
    assert [f"{keyframe.skill.value} {keyframe.furniture}" for keyframe in script.keyframes] == told


def test_two_beats_that_one_posture_shows_are_one_keyframe() -> None:
    script = planned("He sits on the sofa and reads.")
    sits = script.keyframes[-1]
    assert ({sits.beat, *sits.also}, sits.caption) == ({0, 1}, "reading, book held in both hands")
    assert script.acted == script.asked == 2


def test_who_starts_again_does_again_what_was_done_at_rest() -> None:
    script = planned("He meditates. He puts his phone into the bin and starts again.")
    sits = [keyframe for keyframe in script.keyframes if keyframe.skill is Skill.SITDOWN]
    assert [keyframe.beat for keyframe in sits] == [0, 2]
    assert sits[0].caption == sits[1].caption


def test_who_knelt_gets_up_from_the_knees_and_from_no_chair_sat_on_for_it() -> None:
    prayed = planned("An old woman kneels to pray, gets up and lies down on the bed.")
    assert [one.skill for one in own(prayed)] == [Skill.LOCO, Skill.LIEDOWN]
    assert not any(beat.why for beat in prayed.beats)
    looked = planned("He kneels under the desk to look for his ring, then gets up and smiles.")
    assert Skill.SITDOWN not in [one.skill for one in looked.keyframes]


def test_who_tries_again_does_again_what_was_tried() -> None:
    script = planned("He tries to fix the clock, scratches his head and tries again.")
    assert [keyframe.furniture for keyframe in own(script)][:1] == [keyframe.furniture for keyframe in own(script)][-1:]


def test_every_place_of_a_list_is_gone_to_in_its_order() -> None:
    script = planned("She searches the study, the kitchen and the bathroom. She checks the bed and the stove.")
    touched = [keyframe.furniture for keyframe in script.keyframes if keyframe.skill is Skill.TOUCH]
    assert touched == ["desk", "kitchen cabinet", "bathroom cabinet", "bed", "stove"]


def test_a_beat_that_a_mood_shows_names_what_else_it_tells() -> None:
    script = planned("She reads. She laughs, with confetti in her hair, at the sound of the key.")
    assert script.beats[1].unshown == ("with confetti in her hair", "at the sound of the key")


def test_a_mood_alone_is_walked() -> None:
    (walk,) = planned("He is drunk.").keyframes
    assert (walk.skill, walk.caption, walk.mood) == (Skill.LOCO, usual(Skill.LOCO, Emotion.DRUNK), Emotion.DRUNK)


def test_what_cannot_be_done_in_a_home_is_named() -> None:
    script = planned("She dances. She cooks dinner.", furniture={"study": frozenset({"office_chair"})})
    assert [bool(beat.why) for beat in script.beats] == [False, True]
    seen = planned("She cooks dinner.", furniture={"study": frozenset()})
    assert [beat.why for beat in seen.beats] == ["the home has nothing to touch at for it"]
    assert [keyframe.beat for keyframe in seen.keyframes] == [None]


@for_each(
    ("theme", "already"),
    [
        ("Anna cannot sleep. She gets up and paces around the bedroom.", True),
        ("Anna goes to bed and cannot sleep. She gets up.", False),
        ("Anna lies down on the bed. She gets up.", False),
        ("Anna cannot sleep.", False),
    ],
)
def test_who_gets_up_from_sleep_in_the_first_sentence_lies_there_when_the_story_begins(
    theme: str, already: bool
) -> None:
    lying = next(one for one in planned(theme).keyframes if one.skill is Skill.LIEDOWN)
    assert lying.already is already


def test_named_furniture_is_looked_for_where_it_usually_is_and_not_in_the_room_of_what_was_done_before() -> None:
    script = planned("She opens the wardrobe in the bedroom. She sits on the office chair.")
    rooms = {one.furniture: one.room for one in script.keyframes}
    assert rooms["wardrobe"] == "bedroom"
    assert rooms["office chair"] != "bedroom"


@pytest.mark.parametrize(
    ("theme", "seats"),
    [
        ("She reads the letter twice. She sits down on the sofa and weeps.", ["sofa"]),
        ("She reads a book. She opens the fridge.", ["armchair", "sofa", "chair"]),
        ("She reads a book. She opens the fridge. She sinks to the floor.", ["armchair", "sofa", "chair", "floor"]),
    ],
)
def test_who_sits_for_something_does_so_where_the_theme_has_them_sit_next(theme: str, seats: list[str]) -> None:
    found = {one.furniture for one in own(planned(theme)) if one.skill in (Skill.SITDOWN, Skill.LIEDOWN)}
    assert found
    assert found <= {*seats}


@for_each(
    ("theme", "done"),
    [
        # Who drinks or sits up in bed stays in it, and is in it when the story begins.
        ("She lies in bed. She drinks tea and falls asleep.", ["liedown", "sitdown", "liedown"]),
        ("She sits up in bed, blows her nose and lies back down.", ["liedown", "sitdown", "liedown"]),
        ("She stays in bed.", ["liedown"]),
        ("She gets up from the sofa.", ["sitdown", "standup"]),
        # A way is gone though no verb tells of it.
        ("She drinks tea. Out the door.", ["sitdown", "standup", "loco"]),
        ("She assembles a bookcase. She sits on the floor, reads the manual and starts again.",
         ["touch", "sitdown", "standup", "loco", "touch"]),
    ],
)  # fmt: skip
def test_nobody_leaves_where_it_is_done_for_what_is_told_next(theme: str, done: list[str]) -> None:
    script = planned(theme)
    way = next(at for at, one in enumerate(script.keyframes) if one.already or not connects(one))
    assert [one.skill.value for one in script.keyframes[way:]] == done


def test_who_eats_before_the_television_sits_on_the_sofa() -> None:
    assert [one.furniture for one in own(planned("She eats it in front of the television."))] == ["sofa"]


def test_who_puts_on_music_nods_to_it_before_anything_else_is_done() -> None:
    for theme in ("He puts on some music and sits down on the sofa.", "She turns on the radio and dances."):
        assert [one.caption for one in own(planned(theme))][:2] == ["turn on with the right hand", "nodding the head"]
    assert "nodding the head" not in [one.caption for one in own(planned("She turns on the lamp and sits down."))]


def test_one_leg_is_no_bed_that_was_named_before() -> None:
    assert own(planned("She looks under the bed. She hops on one leg."))[-1].furniture == "floor"


def test_who_stood_still_looks_out_of_the_window_in_a_moment_of_its_own() -> None:
    stands = [one.beat for one in own(planned("She stays perfectly still. She looks out of the window."))]
    assert stands == [0, 1]
    assert len(own(planned("She stays perfectly still. She stands still."))) == 1


def test_who_sits_by_a_window_is_not_told_to_be_seen_there() -> None:
    (drinks,) = planned("She sits by the window.").beats
    assert drinks.unshown == ("by the window",)


def test_who_smiles_between_two_looks_at_the_phone_smiles() -> None:
    script = planned("She read the message, smiled and typed an answer.")
    looks = [(one.caption.split()[0], one.mood) for one in script.keyframes]
    assert looks == [("looking", Emotion.NEUTRAL), ("looking", Emotion.HAPPY)]
    assert not any(one.why for one in script.beats)


def test_who_vacuums_and_then_mops_has_two_tools_in_the_hands() -> None:
    script = planned("She vacuums the living room and mops the floor.")
    assert [one.held for one in script.keyframes] == ["vacuum", "mop"]


def test_whoever_is_not_there_is_named_beside_what_is_acted() -> None:
    script = planned("He yells at his sister and points at the door.")
    assert script.beats[0].unshown == ("at his sister",)


@for_each(
    "theme",
    ["It had been an awful day at work. Petra came in and sat.", "After a bad day he came in and sat."],
)
def test_a_bad_day_is_seen_in_who_comes_home(theme: str) -> None:
    assert all(one.mood is Emotion.SAD for one in planned(theme).keyframes)


def test_who_is_bored_does_not_grieve() -> None:
    script = planned("Bored, Felix sits on the sofa and stares at the ceiling.")
    assert all(one.mood is Emotion.NEUTRAL and "head bowed" not in one.caption for one in script.keyframes)
