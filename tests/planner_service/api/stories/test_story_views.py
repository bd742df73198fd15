from __future__ import annotations

from dataclasses import replace
from typing import Any

from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from planner_service.api.stories.schemas import StoryShown, StorySummary
from planner_service.api.stories.views import StoryEvent, events_of, story_shown, story_summary
from planner_service.jobs.story_stages import FIRST_SEGMENT
from planner_service.store.story_store import Artifact, Record, new_id
from planner_service.store.tables import STATES

ENDINGS = {"succeeded": "done", "failed": "failed", "cancelled": "cancelled"}


def keyframe(index: int) -> dict[str, object]:
    return {
        "index": index, "skill": "loco", "emotion": "unhappy", "mood": "sad", "caption": "walk", "furniture": "floor",
        "object_id": None, "room": "study", "short_script_id": None, "beat": None, "also": [],
    }  # fmt: skip


def artifacts(count: int, segments: int, told: bool = True) -> list[Artifact]:
    """What a story of `count` actions has made when `segments` of them are moved."""
    made: list[tuple[str, dict[str, Any], str]] = [
        ("script", {"keyframes": [keyframe(i) for i in range(count)], "planner": "rules"}, "furnish"),
        ("home", {"home": {"rooms": []}}, "narrate" if told else "act"),
        ("told", {"title": "T", "text": "Told."}, "act"),
        ("actions", {"count": count, "objects": [None] * count}, "move"),
    ]
    found = [
        Artifact(position, kind, summary, "e", following, 0.05 * (position + 1))
        for position, (kind, summary, following) in enumerate(made)
        if told or kind != "told"
    ]
    for index in range(segments):
        summary = {"index": index, "keyframe": index, "start": 10 * index, "end": 10 * index + 10, "reached": True}
        following = "judge" if index == count - 1 else None
        found.append(Artifact(FIRST_SEGMENT + index, "segment", summary, "e", following, 0.3 + 0.5 * index / count))
    return found


def record(made: list[Artifact], status: str, **more: Any) -> Record:
    base = Record(
        id=new_id(1_700_000_000_000), kind="story", created=1_700_000_000_000, theme="t", title=None, seed=0,
        backend="procedural", stage="plan", progress=0.1, error=None, status=status, attempts=1, method="matching",
        character={"name": "Sam", "pronouns": "they", "height": 1.7}, artifacts=tuple(made),
    )  # fmt: skip
    return replace(base, **more)


@st.composite
def records(draw: st.DrawFn) -> Record:
    count = draw(st.integers(1, 6))
    segments = draw(st.integers(0, count))
    made = artifacts(count, segments, draw(st.booleans()))
    shown = made if segments else made[: draw(st.integers(0, len(made)))]
    return record(shown, draw(st.sampled_from(sorted(STATES))))


@given(records())
def test_event_numbers_rise_and_the_end_comes_once_and_last(story: Record) -> None:
    events = list(events_of(story))
    assert [event.id for event in events] == sorted({event.id for event in events})
    ends = [event for event in events if event.name in ENDINGS.values()]
    state = STATES[story.status or ""]
    assert [event.name for event in ends] == ([ENDINGS[state]] if state in ENDINGS else [])
    assert not ends or events[-1] == ends[0]


@given(records(), st.integers(0, 60))
def test_events_of_a_longer_story_begin_with_those_of_the_shorter(story: Record, cut: int) -> None:
    running = replace(story, status="PENDING")
    shorter = replace(running, artifacts=running.artifacts[:cut])
    known = list(events_of(shorter))
    assert list(events_of(running))[: len(known)] == known


@given(records())
def test_every_story_fits_the_schema_it_is_answered_in(story: Record) -> None:
    shown = StoryShown.model_validate(story_shown(story))
    assert StorySummary.model_validate(story_summary(story, 0)).id == shown.id
    assert shown.motion.frames == max([k.end or 0 for k in shown.keyframes], default=0)
    assert shown.motion.complete == (bool(shown.keyframes) and all(k.end is not None for k in shown.keyframes))
    assert (shown.error is not None) == (shown.state == "failed")


def test_a_beat_is_acted_as_planned_until_the_body_does_not_reach_it() -> None:
    made = artifacts(2, 2)
    for row in made[0].summary["keyframes"]:
        row["beat"] = row["index"]
    made[0].summary["beats"] = [
        {"text": "sits"}, {"text": "reads"}, {"text": "flies", "why": "nobody can"}, {"text": "naps", "kind": "undone"},
    ]  # fmt: skip
    made[-1].summary.update(reached=False, reason="too far")
    planned, moved = (StoryShown.model_validate(story_shown(record(some, "PENDING"))) for some in (made[:1], made))
    assert [beat.acted for beat in planned.beats] == [True, True, False, False]
    assert [beat.acted for beat in moved.beats] == [True, False, False, False]
    made[0].summary["beats"][0]["unshown"], made[-1].summary["reached"] = ["sits"], True
    made[-1].summary["otherwise"] = ["nothing to lean back against: upright"]
    stood = StoryShown.model_validate(story_shown(record(made, "PENDING")))
    assert [(beat.acted, beat.stood_for) for beat in stood.beats] == [(False, True)] * 2 + [(False, False)] * 2
    made[0].summary["beats"][0].pop("unshown")
    made[-1].summary["reached"] = False
    assert [beat.why for beat in moved.beats[1:3]] == ["the body did not reach it: too far", "nobody can"]


def test_a_segment_says_which_frames_can_be_had() -> None:
    events = list(events_of(record(artifacts(2, 2), "PENDING")))
    segments = [event for event in events if event.name == "segment"]
    assert [(one.data["start"], one.data["end"]) for one in segments] == [(0, 10), (10, 20)]
    stages = [event.data["stage"] for event in events if event.name == "stage"]
    assert stages == ["plan", "furnish", "narrate", "act", "move", "judge"]


@for_each(
    ("status", "error", "title"),
    [
        ("ERROR", {"title": "This story cannot be made", "detail": "d"}, "This story cannot be made"),
        ("ERROR", None, "Something went wrong on our side"),
        ("MAX_RECOVERY_ATTEMPTS_EXCEEDED", None, "Given up"),
        (None, None, "Something went wrong on our side"),
    ],
)
def test_a_failed_story_says_why(status: str | None, error: dict[str, str] | None, title: str) -> None:
    failed = replace(record([], "PENDING"), status=status, error=error)
    shown = story_shown(failed)
    assert (shown["state"], shown["error"]["title"]) == ("failed", title)
    last = list(events_of(failed))[-1]
    assert last == StoryEvent(last.id, "failed", {"state": "failed", "error": shown["error"]})


def test_an_error_of_an_earlier_attempt_is_not_shown_once_the_story_succeeds() -> None:
    assert story_shown(record([], "SUCCESS", error={"title": "t", "detail": "d"}))["error"] is None


@given(st.integers(0, 2**48 - 1), st.integers(0, 2**48 - 1))
def test_ids_sort_by_time(first: int, second: int) -> None:
    a, b = new_id(first), new_id(second)
    assert (a < b) == (first < second) or first == second
    assert a[14] == "7"
    assert a[19] in "89ab"
