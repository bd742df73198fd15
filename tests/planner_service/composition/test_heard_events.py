"""What happens in a theme is reacted to there and then, and nobody is said to have acted it."""

from __future__ import annotations

from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Reacts, Skill
from planner_service.composition.compose import compose
from planner_service.composition.heard_events import taken
from planner_service.composition.request import Request
from planner_service.scripts.acted_beats import planned_beats
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import REACTED, LongScript, PlannedKeyframe, Reacted
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.themes.beats import beats_of
from scene_graphs.furniture import is_known

LIBRARY = ScriptLibrary(built_in(), Features(HashingEncoder()))


def planned(theme: str) -> LongScript:
    return compose(theme, LIBRARY, Request())


def reactions(script: LongScript) -> list[tuple[PlannedKeyframe, Reacted]]:
    return [(keyframe, row) for keyframe in script.keyframes for row in keyframe.reacts]


@for_each(
    ("theme", "how", "at"),
    [
        ("The doorbell rings. He goes to the door.", "start", "door"),
        ("There is a knock at the door. She gets up from the sofa.", "start", "door"),
        ("Somebody knocks at the door, and he stands up.", "start", "door"),
        ("The phone rang. She answered it.", "start", "phone"),
        ("A message arrives on her phone, and she reads it.", "notice", "phone"),
        ("Thunder rolls, and he sits down.", "start", "window"),
        ("It begins to rain. She sits down.", "notice", "window"),
        ("The lamp goes out. He sits down.", "start", "lamp"),
        ("She hears a noise and sits down.", "start", ""),
        ("Her friend comes in, and she sits down.", "notice", "door"),
        ("She opened the door, but nobody was there.", "search", ""),
        ("He went to the window. There was no one there. He sat down.", "search", ""),
    ],
)
def test_what_happens_is_taken_once_where_it_is(theme: str, how: Reacts, at: str) -> None:
    found = reactions(planned(theme))
    assert [(row.how, row.at) for _, row in found] == [(how, at)]


@for_each(
    "theme",
    [
        "The phone did not ring. She went to bed.",
        "He remembers how the phone rang, and sits down.",
        "The sun shines. He reads on the sofa.",
        "She waters the plants before her sister comes home.",
        "He knocks at the door and goes in.",
        "She walks in and leaves her bag on the table.",
    ],
)
def test_nothing_is_reacted_to_that_does_not_happen_or_that_one_does(theme: str) -> None:
    assert reactions(planned(theme)) == []


def test_who_rests_when_a_story_begins_is_seen_to_before_anything_happens() -> None:
    first = planned("There is a knock at the door. Anna gets up from the sofa.").keyframes[0]
    assert first.already
    assert [row.after for row in first.reacts] == [True]


def test_what_happens_meanwhile_or_last_comes_after_what_is_done() -> None:
    for theme in ("The doorbell rang while she was reading on the sofa.", "He sits down on the sofa. The phone rings."):
        ((keyframe, row),) = reactions(planned(theme))
        assert keyframe.skill is Skill.SITDOWN
        assert row.after


def test_after_a_start_nobody_gets_up_slowly_unless_told_so() -> None:
    rises = [
        one
        for one in planned("The doorbell rings. He gets up from the sofa.").keyframes
        if one.skill in (Skill.STANDUP,)
    ]
    assert [one.caption for one in rises] == ["stand up"]


def test_an_event_is_said_to_be_reacted_to_and_is_not_counted() -> None:
    script = planned("The doorbell rings. She sits down on the sofa.")
    (event, _), outcomes = script.beats, planned_beats(script)
    assert event.why.startswith(REACTED)
    assert (outcomes.acted, outcomes.asked) == (1, 1)
    assert [one.beat.text for one in outcomes.reacted] == ["The doorbell rings"]
    assert any(line.startswith("reacted to: The doorbell rings (it starts and looks") for line in outcomes.lines())


def test_places_of_events_are_openings_or_furniture_we_know() -> None:
    themes = (
        "The phone rings.",
        "The kettle whistles.",
        "The alarm clock rings.",
        "A glass falls.",
        "The radio comes on.",
    )
    found = [way for theme in themes for read in beats_of(f"She sits. {theme}") if (way := taken(read))]
    assert len(found) == len(themes)
    assert all(way.at in ("", "door", "window", "phone") or is_known(way.at) for way in found)
