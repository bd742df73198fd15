"""Where the table of deeds and what has been learned differ the surer one is taken; alone, the table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import pytest

from motion_backend.motion import Emotion, Skill
from planner_service.composition.beat_classifier import BeatClassifier, Likely
from planner_service.composition.deed_lexicon import Deed, deed_of
from planner_service.composition.deed_reader import DeedReader, learned_row
from planner_service.composition.deed_table import captions_of_gestures
from planner_service.composition.rest_place import only_stands_for
from planner_service.scripts.captions import captions
from planner_service.scripts.script import Keyframe, PlannedKeyframe
from planner_service.themes.beats import beats_of
from planner_service.themes.clause import Clause
from planner_service.themes.sentence_parser import clauses_of_text
from scene_graphs import furniture

CLAUSES = ("She opens the fridge", "He sits down", "She lies down on the bed", "He waters the plants", "It rains")


def clause(text: str) -> Clause:
    return clauses_of_text(f"{text}.")[0]


def likely(
    shown: float = 0.9, moods: dict[Emotion, float] | None = None, pieces: dict[str, float] | None = None, **some: float
) -> Likely:
    """What is likely: captions of which a part is a keyword of `some`, underscores for spaces."""
    ours = ((Skill(skill), one) for skill, those in captions().items() for one in those)
    every = dict.fromkeys((one for one in ours if one not in captions_of_gestures()), 0.01)
    for part, share in some.items():
        every |= {known: share for known in every if part.replace("_", " ") in known[1].lower()}
    places = dict.fromkeys(furniture.catalogue().categories, 0.02) | (pieces or {})
    return Likely(every, dict.fromkeys(Emotion, 0.01) | (moods or {}), places, shown)


class Scripted:
    """Thinks of every clause the same, and remembers what it was asked."""

    def __init__(self, answer: Likely) -> None:
        self.answer = answer
        self.asked: list[tuple[str, str]] = []

    def likely(self, clauses: Sequence[str], before: Sequence[str]) -> list[Likely]:
        self.asked += list(zip(clauses, before, strict=True))
        return [self.answer] * len(clauses)


def reader(answer: Likely) -> DeedReader:
    return DeedReader(cast(BeatClassifier, Scripted(answer)))


@pytest.mark.parametrize("text", CLAUSES)
def test_without_a_classifier_there_is_the_table_alone(text: str) -> None:
    assert DeedReader().deed(clause(text)) == deed_of(clause(text))


def test_what_is_much_likelier_is_taken_in_place_of_the_tables() -> None:
    told = clause("She opens the fridge")
    table = deed_of(told)
    assert table is not None
    assert table.skill is Skill.TOUCH
    assert (found := reader(likely(pacing=0.95)).deed(told)) is not None
    assert found.skill is Skill.LOCO
    assert found.row.captions == ("pacing back and forth",)
    assert (found := reader(likely(pacing=0.3)).deed(told)) is not None
    assert found.skill is Skill.TOUCH


def test_nothing_is_done_where_nothing_is_likely_to_show_it() -> None:
    assert reader(likely(shown=0.05, pacing=0.9)).deed(clause("She opens the fridge")) is None
    assert reader(likely(pacing=0.2)).deed(clause("She frobnicates")) is None


def test_words_without_a_verb_are_done_only_where_that_is_sure() -> None:
    (told,) = (one for one in clauses_of_text("Feet on the ottoman.") if not one.verb)
    assert reader(likely(legs_extended=0.7)).deed(told) is None
    assert (found := reader(likely(legs_extended=0.9)).deed(told)) is not None
    assert found.skill is Skill.SITDOWN


def test_who_rises_does_so_from_where_they_likeliest_are_unless_it_is_named() -> None:
    rise = clause("She rises with the lark")
    assert (table := deed_of(rise)) is not None
    assert table.skill is Skill.STANDUP
    assert (found := reader(likely(get_up=0.9)).deed(rise)) is not None
    assert found.skill is Skill.GETUP
    assert (found := reader(likely(stand_up=0.9)).deed(rise)) is not None
    assert found.skill is Skill.STANDUP
    assert (found := reader(likely(get_up=0.9)).deed(clause("She rises from her chair"))) is not None
    assert found.skill is Skill.STANDUP


def test_who_rests_does_there_what_nobody_would_get_up_for() -> None:
    (read,) = beats_of("She frobnicates.")
    sofa = PlannedKeyframe(skill=Skill.SITDOWN, caption="sitting still", furniture="sofa")

    def is_left_out(**some: float) -> bool:
        heard = reader(likely(0.9, None, None, **some))
        row = learned_row(read.clause, heard.classifier.likely([""], [""])[0])  # type: ignore[union-attr]
        return only_stands_for(sofa, read, Deed(row, row.skill, row.at, False), heard)

    assert not is_left_out(pacing=0.4, sitting_still=0.4)
    assert is_left_out(pacing=0.25, sitting_still=0.25)
    assert is_left_out(pacing=0.4)
    assert not is_left_out(pacing=0.7)


def test_hands_stay_where_they_are_only_for_what_is_likely_done_there() -> None:
    told = clause("She frobnicates the gizmo")
    heard = reader(likely(touch_medium=0.9, pieces={"stove": 0.9, "desk": 0.5, "mirror": 0.3}))
    assert heard.may_be_at(told, Skill.TOUCH, "desk", True)
    assert not heard.may_be_at(told, Skill.TOUCH, "desk", False)
    assert not heard.may_be_at(told, Skill.TOUCH, "mirror", True)
    assert DeedReader().may_be_at(told, Skill.TOUCH, "mirror", True)


def test_hands_do_it_at_the_likeliest_furniture_unless_some_is_named() -> None:
    at = reader(likely(touch_medium=0.9, pieces={"washing_machine": 0.9, "mirror": 0.5}))
    assert (found := at.deed(clause("She frobnicates the gizmo"))) is not None
    assert found.pieces[:2] == ("washing machine", "mirror")
    assert (found := at.deed(clause("She wipes the desk"))) is not None
    assert found.pieces[0] == "desk"


def test_any_caption_of_a_skill_will_do_where_most_of_them_are_accepted() -> None:
    none = likely()
    every = replace(none, captions={one: 0.9 if one[0] is Skill.SITDOWN else 0.01 for one in none.captions})
    assert (row := learned_row(clause("He settles"), every)).skill is Skill.SITDOWN
    assert row.captions == ()
    assert learned_row(clause("He settles"), likely(reading=0.9)).captions == ("reading, book held in both hands",)
    assert learned_row(clause("He settles"), likely(reading=0.9)).lying == (
        "reading on the back, book held above the chest",
    )


def test_a_beat_that_a_mood_shows_is_in_that_mood_and_what_nobody_else_does_is_done() -> None:
    (funk,) = beats_of("She is in a funk.")
    assert reader(likely(moods={Emotion.SAD: 0.9})).heard(funk).beat.emotion is Emotion.SAD
    (curtains,) = beats_of("Curtains drawn.")
    assert curtains.beat.kind == "other"
    assert reader(likely(turn_on=0.9)).heard(curtains).beat.kind == "deed"
    assert reader(likely(turn_on=0.2)).heard(curtains).beat.kind == "other"
    (kettle,) = beats_of("The kettle boils.")
    assert reader(likely(turn_on=0.8)).heard(kettle).beat.kind == "other", "a thing does it"
    assert reader(likely(turn_on=0.9)).heard(kettle).beat.kind == "deed", "somebody has put it on"
    mother = next(one for one in beats_of("She sits down. Her mother opens the fridge.") if one.beat.kind == "other")
    assert reader(likely(turn_on=0.9)).heard(mother).beat.kind == "other"


def test_words_of_nobody_are_the_heros_where_that_is_likely_and_a_persons_where_it_is_all_but_sure() -> None:
    tea = next(one for one in beats_of("She comes home. A cup of tea.") if "tea" in one.text)
    nobodys = replace(tea, beat=tea.beat.model_copy(update={"kind": "other"}))
    assert reader(likely(shown=0.95, drinking=0.7)).heard(nobodys).beat.kind == "deed"
    assert reader(likely(shown=0.95, drinking=0.6)).heard(nobodys).beat.kind == "other"
    assert reader(likely(shown=0.6, drinking=0.95)).heard(nobodys).beat.kind == "other"
    mothers = replace(tea, beat=tea.beat.model_copy(update={"kind": "other", "who": "her mother"}))
    assert reader(likely(shown=0.9, drinking=0.9)).heard(mothers).beat.kind == "other"
    assert reader(likely(shown=0.99, drinking=0.99)).heard(mothers).beat.kind == "deed"


def test_a_plain_posture_is_taken_in_the_way_that_its_words_tell() -> None:
    sits = clause("She sits down")
    found = reader(likely(shown=0.95, crossing_arms=0.9)).deed(sits)
    assert found is not None
    assert found.row.captions == ("crossing arms",)
    plain = reader(likely(shown=0.95, crossing_arms=0.55, sit_upright=0.5)).deed(sits)
    assert plain is not None
    assert not plain.row.captions


def test_what_hardly_anything_shows_is_not_done_though_the_table_has_it() -> None:
    assert deed_of(drinks := clause("She drinks")) is not None
    assert reader(likely(shown=0.2, drinking=0.9)).deed(drinks) is None
    assert reader(likely(shown=0.4, drinking=0.9)).deed(drinks) is not None


def test_what_a_mood_shows_more_likely_than_any_caption_is_felt() -> None:
    (beams,) = beats_of("He prances.")
    assert reader(likely(moods={Emotion.HAPPY: 0.9}, skip=0.3)).heard(beams).beat.kind == "feeling"
    assert reader(likely(moods={Emotion.HAPPY: 0.9}, skip=0.95)).heard(beams).beat.kind == "deed"


def test_a_gesture_is_done_as_the_table_has_it_whatever_is_likelier() -> None:
    at = reader(likely(moods={Emotion.HAPPY: 0.95}, skip=0.9, typing=0.99, shown=0.1))
    (laughs,) = beats_of("He laughs himself silly.")
    assert at.heard(laughs).beat.kind == "deed"
    deed = at.deed(laughs.clause)
    assert deed is not None
    assert deed.is_gesture
    assert deed.row.captions == ("laughing, hands on belly",)
    laughing = Keyframe(skill=Skill.LOCO, emotion="happy", caption="laughing, hands on belly", furniture="floor")
    assert at.is_shown(laughs.clause, deed, [laughing])
    assert not at.is_shown(laughs.clause, deed, [laughing.model_copy(update={"caption": "stand still"})])


def test_a_word_for_a_mood_is_felt_and_not_done() -> None:
    stressed = next(one for one in beats_of("Stressed, she paces.") if "tressed" in one.text)
    heard = reader(likely(moods={Emotion.STRESSED: 0.9}, pacing=0.2)).heard(stressed)
    assert (heard.beat.kind, heard.beat.emotion) == ("feeling", Emotion.STRESSED)


def test_a_keyframe_shows_what_it_likely_shows_and_only_stands_for_the_rest() -> None:
    told = clause("She frobnicates the gizmo")
    keyframe = Keyframe(skill=Skill.TOUCH, emotion="neutral", caption="turn on with the right hand", furniture="mirror")

    def is_shown(share: float, there: float = 0.9) -> bool:
        heard = reader(likely(shown=0.99, turn_on=share, pieces={"mirror": there, "desk": 0.9}))
        deed = heard.deed(told)
        return deed is not None and heard.is_shown(told, deed, [keyframe])

    assert is_shown(0.99)
    assert not is_shown(0.45)
    assert not is_shown(0.99, there=0.1), "it is done elsewhere"


def test_a_clause_is_read_once_with_those_before_it() -> None:
    model = Scripted(likely(pacing=0.9))
    heard = DeedReader(cast(BeatClassifier, model))
    told = beats_of("She comes in. She paces. She frets. She sighs.")
    heard.hear(told)
    heard.hear(told)
    assert [before for _, before in model.asked] == ["", "comes in", "comes in. paces", "paces. frets"]


def test_when_it_was_done_says_nothing_of_what_is_done() -> None:
    read = beats_of("After the argument on the phone she slams the cupboard. She drinks during the storm.")
    heard = Scripted(likely())
    DeedReader(cast(BeatClassifier, heard)).hear(read)
    assert [text for text, _ in heard.asked] == ["slams the cupboard", "drinks"]


def _with(part: str) -> list[tuple[Skill, str]]:
    return [one for one in likely().captions if part in one[1]]


@pytest.mark.parametrize(
    ("theme", "caption", "is_played"),
    [
        ("She tunes each string.", "piano", False),
        ("He drags it down to the rug.", "dancing", False),
        ("Ring box in the left pocket.", "phone", False),
        ("The piano is open. Her fingers find the first bars.", "piano", True),
        ("The music starts. She glides about.", "dancing", True),
        ("The phone is on the table. He murmurs for an hour.", "phone", True),
    ],
)
def test_what_everybody_knows_is_played_only_where_words_tell_of_it(theme: str, caption: str, is_played: bool) -> None:
    read = beats_of(theme)
    answer = likely()
    ours = reader(replace(answer, captions=answer.captions | dict.fromkeys(_with(caption), 0.99)))
    ours.hear(read)
    thought = ours.likely(read[-1].clause)
    assert thought is not None
    assert (caption in thought.best[1]) is is_played
