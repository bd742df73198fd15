"""A stored story as clients see it: the resource put together from its artifacts, and its events in order.

The frames of a story that are ready, from any to any, while the rest is made.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property
from typing import Any, Final

from motion_backend.body.cast import Look, Role, rest_from_dict, thing_from_dict, worked_from_dict
from motion_backend.motion import FPS, Character, Emotion, Motion, Skill, join
from planner_service.jobs.story_stages import STAGES, read_segments
from planner_service.narration.told import Told
from planner_service.scripts.acted_beats import Outcome, Shot, acted_beats, beats_in, leads, lost_in_moving
from planner_service.scripts.script import Beat
from planner_service.store.story_store import Artifact, Record, Stories
from planner_service.store.tables import GIVEN_UP, State, state_of
from scene_graphs.json_fields import Json

STOPPED: Final = {"succeeded": "done", "failed": "failed", "cancelled": "cancelled"}
"""The last event of a story in each state it can end in."""
SLOTS: Final = 4
"""Event numbers of an artifact: a segment, a stage that begins, progress, and the end behind it."""


@dataclass(frozen=True)
class StoryEvent:
    """One event of a story; the same number always stands for the same event."""

    id: int
    name: str
    data: Json


def story_summary(record: Record, frames: int) -> Json:
    """A story in a list; `frames` are ready."""
    return {
        "id": record.id,
        "kind": record.kind,
        "state": state_of(record.status),
        "stage": record.stage,
        "progress": record.progress,
        "created": datetime.fromtimestamp(record.created / 1000, UTC),
        "theme": record.theme,
        "title": record.title,
        "seed": record.seed,
        "backend": record.backend,
        "duration": round(frames / FPS, 3),
        "error": failure_of(record),
        "derived_from": record.derived_from,
        "links": _links(record.id),
    }


def story_shown(record: Record) -> Json:
    """A story as far as it is made: later stages say more of its keyframes, so the last word counts."""
    made: Json = {}
    segments = []
    for artifact in record.artifacts:
        if artifact.kind == "segment":
            segments.append(artifact.summary)
        else:
            made |= artifact.summary
    frames = segments[-1]["end"] if segments else 0
    complete = bool(made.get("count")) and len(segments) == made.get("count")
    keyframes = _keyframes(made, segments)
    beats, shots = (
        [Beat.model_validate(row) for row in made.get("beats", [])],
        _shots(keyframes, segments, made.get("worked")),
    )
    shown = {
        "method": record.method,
        "character": made.get("character", record.character),
        "planner": made.get("planner"),
        "encoder": made.get("encoder"),
        "text": made.get("text"),
        "graph": made.get("graph", {}),
        "home": made.get("home"),
        "beats": [_plain(one) for one in acted_beats(beats, shots).outcomes],
        "keyframes": keyframes,
        "reused": made.get("reused", 0),
        "take": made.get("take", 0),
        "motion": {"frames": frames, "duration": round(frames / FPS, 3), "complete": complete},
        "report": made.get("report"),
    }
    lists = {name: made.get(name, []) for name in ("spans", "thoughts", "repairs", "short_scripts")}
    if "spans" in made:
        lists["thoughts"] = Told.from_dict(made).with_unseen(lost_in_moving(beats, shots)).to_dict()["thoughts"]
    return story_summary(record, frames) | shown | lists


def _keyframes(made: Json, segments: list[Json]) -> list[Json]:
    rows = [row | {"start": None, "end": None, "reached": None, "segments": []} for row in made.get("keyframes", [])]
    for row, object_id in zip(rows, made.get("objects", []), strict=False):
        row["object_id"] = object_id
        row["asleep"] = row["index"] in made.get("asleep", ())
    for segment in segments:
        rows[segment["keyframe"]] |= {
            name: segment[name] for name in ("start", "end", "reached", "segments", "reused") if name in segment
        }
    return rows


def _shots(keyframes: list[Json], segments: list[Json], worked: list[Json] | None) -> list[Shot]:
    """What of every keyframe says whether its beats are acted, as far as that is known."""
    reasons = {segment["keyframe"]: segment.get("reason", "") for segment in segments}
    otherwise = {segment["keyframe"]: _words(segment.get("otherwise")) for segment in segments}
    does = {row["keyframe"]: row["does"] for row in worked} if worked is not None else None
    return [
        Shot(
            beats_in(row["beat"], row["also"]),
            Emotion(row["mood"]),
            leads(Skill(row["skill"]), row["furniture"]),
            row["reached"],
            reasons.get(row["index"], ""),
            otherwise=otherwise.get(row["index"], ()),
            does=row.get("does", "") if does is None else does.get(row["index"], ""),
        )
        for row in keyframes
    ]


def _plain(outcome: Outcome) -> Json:
    return {name: value for name, value in outcome.to_dict().items() if name != "stood_for"}  # `BeatShown` tells it


def _words(otherwise: Any) -> tuple[str, ...]:
    """What a segment says was done otherwise; earlier versions kept only whether anything was."""
    return tuple(otherwise) if isinstance(otherwise, list) else ("",) * bool(otherwise)


def failure_of(record: Record) -> Json | None:
    """Why a story could not be made."""
    if state_of(record.status) != "failed":
        return None
    if record.status == GIVEN_UP:
        detail = f"its worker ended {record.attempts} times while it was made; post it again, or tell the operator"
        return {"title": "Given up", "detail": detail}
    return record.error or {"title": "Something went wrong on our side", "detail": "the service's log says more"}


def role_in(record: Record) -> Role:
    """Who is seen in a story, as far as it is made."""
    made: Json = {}
    for artifact in record.artifacts:
        if artifact.kind != "segment":
            made |= artifact.summary
    emotions = {row["index"]: Emotion(row["mood"]) for row in made.get("keyframes", [])}
    look = Look.of(Character(**made.get("character", record.character)))
    said = made.get("captions") or [row["caption"] for row in made.get("keyframes", ())]
    rows = zip(made.get("keyframes", ()), said, strict=False)
    captions = {row["index"]: (Skill(row["skill"]), caption) for row, caption in rows}
    things = {row["keyframe"]: thing_from_dict(row) for row in made.get("things", ())}
    worked = {row["keyframe"]: worked_from_dict(row) for row in made.get("worked", ())}
    rests = {row["keyframe"]: rest_from_dict(row) for row in made.get("rests", ())}
    return Role(look, emotions, frozenset(made.get("asleep", ())), captions, things, worked, rests)


def _links(story_id: str) -> dict[str, str]:
    here = f"/v1/stories/{story_id}"
    parts = {name: f"{here}/{name}" for name in ("events", "cancel", "takes", "motion", "home")}
    files = {"film": f"{here}/film.glb", "usd": f"{here}/film.usd", "mp4": f"{here}/film.mp4"}
    return {"self": here, **parts, **files, "scene": f"{here}/scene.glb", "props": f"{here}/props.glb"}


def events_of(record: Record) -> Iterator[StoryEvent]:
    """The events that a story's artifacts stand for, in order, and the last one if the story has ended."""

    def segment(artifact: Artifact) -> tuple[str, Json] | None:
        names = ("index", "keyframe", "start", "end", "reached")
        return ("segment", {name: artifact.summary[name] for name in names}) if artifact.kind == "segment" else None

    return numbered_events(record, state_of(record.status), (STAGES[0], "move", STAGES[-1]), segment)


def numbered_events(
    record: Record, state: State, stages: tuple[str, str, str], told: Callable[[Artifact], tuple[str, Json] | None]
) -> Iterator[StoryEvent]:
    """Events with numbers from the positions of artifacts: the same however often, and from where, one listens.

    `stages` are the first, that of which many artifacts tell, and the last; of those `told` gives name and data.
    """
    first, many, last = stages
    if record.stage is not None:
        yield StoryEvent(1, "stage", {"stage": first, "progress": 0.0})
    number = 0
    for artifact in record.artifacts:
        number, progress = SLOTS * (artifact.position + 1), artifact.progress
        if (news := told(artifact)) is not None:
            yield StoryEvent(number, news[0], news[1] | {"progress": progress})
        if artifact.following is not None:
            yield StoryEvent(number + 1, "stage", {"stage": artifact.following, "progress": progress})
        stage = artifact.following or (last if news is None else many)
        yield StoryEvent(number + 2, "progress", {"stage": stage, "progress": progress})
    if state in STOPPED:
        data: Json = {"state": state} | ({"error": failure_of(record)} if state == "failed" else {})
        yield StoryEvent(number + 3, STOPPED[state], data)


@dataclass(frozen=True)
class Footage:
    """What a story's segments hold."""

    record: Record

    @cached_property
    def segments(self) -> tuple[Artifact, ...]:
        """Those that are ready, in order."""
        return tuple(artifact for artifact in self.record.artifacts if artifact.kind == "segment")

    @property
    def ready(self) -> int:
        """Frames that can be had."""
        return int(self.segments[-1].summary["end"]) if self.segments else 0

    @property
    def complete(self) -> bool:
        """Whether no more will come of a story that goes well."""
        counts = [artifact.summary["count"] for artifact in self.record.artifacts if artifact.kind == "actions"]
        return counts == [len(self.segments)]

    def etag(self, first: int, last: int) -> str:
        """A name for exactly these frames: what was made is never changed."""
        made = "".join(segment.etag[:8] for segment in self._between(first, last))
        return f"{made[:64]}-{first}-{last}"

    def motion(self, store: Stories, first: int, last: int) -> Motion:
        """Frames first to last (exclusive), at least one, all of them ready."""
        wanted = self._between(first, last)
        whole = join(read_segments(store, self.record.id, [segment.summary["index"] for segment in wanted]))
        start = wanted[0].summary["start"]
        return whole.part(first - start, last - start)

    def _between(self, first: int, last: int) -> list[Artifact]:
        return [one for one in self.segments if one.summary["start"] < last and one.summary["end"] > first]
