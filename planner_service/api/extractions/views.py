"""A stored extraction as clients see it: the resource put together from its artifacts, and its events in order."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime

from planner_service.api.stories.views import StoryEvent, failure_of, numbered_events
from planner_service.extraction.extraction_result import stood_for
from planner_service.jobs.extraction_stages import STAGES
from planner_service.store.story_store import Artifact, Record
from planner_service.store.tables import State, state_of
from scene_graphs.json_fields import Json


def state_now(record: Record) -> State:
    """The state of an extraction: one that was made at once has no workflow, and is done."""
    return "succeeded" if record.status is None and record.progress == 1.0 else state_of(record.status)


def extraction_summary(record: Record) -> Json:
    """An extraction in a list."""
    here = f"/v1/extractions/{record.id}"
    return {
        "id": record.id,
        "name": record.theme,
        "of": record.method,
        "state": state_now(record),
        "stage": record.stage,
        "progress": record.progress,
        "created": datetime.fromtimestamp(record.created / 1000, UTC),
        "error": failure_of(record) if state_now(record) == "failed" else None,
        "links": {"self": here, "events": f"{here}/events", "cancel": f"{here}/cancel"},
    }


def extraction_shown(record: Record) -> Json:
    """An extraction as far as it is made: scripts and scenes of all pieces that were read.

    Scripts that say the same again are left out when all are gathered.
    """
    made: Json = {"scene_count": None, "by": None, "added": [], "renamed": {}, "repeats": {}}
    notes: list[str] = []
    drafts: list[Json] = []
    scenes: list[Json] = []
    for artifact in record.artifacts:
        notes += artifact.summary.get("notes", [])
        if artifact.kind == "piece":
            drafts += artifact.summary["drafts"]
            scenes += artifact.summary["scenes"]
        else:
            made |= {name: artifact.summary[name] for name in made if name in artifact.summary}
    renamed, repeats = made.pop("renamed"), made.pop("repeats")
    made["by"] = made["by"] or ", ".join(dict.fromkeys(scene["by"] for scene in scenes)) or None
    return extraction_summary(record) | made | {
        "scenes": [
            scene | {"scripts": [renamed.get(one, one) for one in stood_for(scene["scripts"], repeats)]}
            for scene in scenes
        ],
        "scripts": [
            {
                "short_script": draft["script"] | {"id": renamed.get(draft["script"]["id"], draft["script"]["id"])},
                "repairs": draft["repairs"],
                "like": draft["like"] or None,
            }
            for draft in drafts
            if draft["script"]["id"] not in repeats
        ],
        "notes": notes,
    }  # fmt: skip


def extraction_events(record: Record) -> Iterator[StoryEvent]:
    """The events that an extraction's artifacts stand for, in order, and the last one if it has ended."""

    def piece(artifact: Artifact) -> tuple[str, Json] | None:
        if artifact.kind != "piece":
            return None
        numbers = [scene["number"] for scene in artifact.summary["scenes"]]
        ids = [draft["script"]["id"] for draft in artifact.summary["drafts"]]
        return "scenes", {"scenes": numbers, "scripts": ids}

    stages = (STAGES[0 if record.method == "film" else 1], "read", STAGES[-1])
    return numbered_events(record, state_now(record), stages, piece)
