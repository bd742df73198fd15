"""What lists, events and clients see of a script and of its home: small, and stored beside the whole."""

from __future__ import annotations

from typing import Any

from planner_service.furnish import Furnished
from planner_service.scripts.keyframe import LongScript

Json = dict[str, Any]


def summary_of_script(script: LongScript) -> Json:
    """What a story shows of its script."""
    return {
        "planner": script.planner,
        "encoder": script.encoder or None,
        "events": [event.model_dump() for event in script.events],
        "uncovered": list(script.uncovered),
        "repairs": list(script.repairs),
        "short_scripts": [
            {"id": r.script.id, "summary": r.script.summary, "score": round(r.score, 4), "event": r.event}
            for r in script.short_scripts
        ],
        "keyframes": _keyframes(script),
    }


def summary_of_home(stage: Furnished) -> Json:
    """What a story shows of its home: rooms, graph, and the object of every keyframe."""
    nodes: list[Json] = []
    edges: list[list[int]] = []
    for room, graph in stage.graphs.items():
        numbers = {node: len(nodes) + number for number, node in enumerate(sorted(graph))}
        nodes += [{"category": node.category, "instance": node.instance, "room": room} for node in numbers]
        edges += sorted(sorted((numbers[a], numbers[b])) for a, b in graph.edges)
    keyframes = _keyframes(stage.script)
    for row, place in zip(keyframes, stage.places, strict=True):
        row["object_id"] = place.object_id
    return {
        "keyframes": keyframes,
        "repairs": list(stage.script.repairs),
        "graph": {"nodes": nodes, "edges": edges},
        "home": {"rooms": stage.rooms_to_dicts()},
    }


def _keyframes(script: LongScript) -> list[Json]:
    ids = [retrieved.script.id for retrieved in script.short_scripts]
    return [
        {
            "index": index,
            "skill": keyframe.skill.value,
            "emotion": keyframe.emotion,
            "caption": keyframe.caption,
            "furniture": keyframe.furniture,
            "object_id": None,
            "room": keyframe.room,
            "short_script_id": None if keyframe.short_script is None else ids[keyframe.short_script],
        }
        for index, keyframe in enumerate(script.keyframes)
    ]
