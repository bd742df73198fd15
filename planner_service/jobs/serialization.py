"""What the stages of a story hand to each other, as plain JSON values and back without loss.

Every stage's result is stored in this form and read again by the next one, so that a story that was interrupted and
one that was not go the very same way.

What lists, events and clients see of a script and of its home: small, and stored beside the whole.
"""

from __future__ import annotations

from dataclasses import asdict, fields

from motion_backend.motion import Action, Emotion, Handle, Reaction, Skill
from planner_service.grounding.furnish import Furnished, RoomMatch
from planner_service.grounding.keyframes_to_actions import Place
from planner_service.grounding.seat_access import pull_from_dict, pull_to_dict
from planner_service.scripts.script import LongScript
from scene_graphs.affordances.affordances import spot_from_dict, spot_to_dict
from scene_graphs.graph.furniture_graph import graph_from_dict, graph_to_dict
from scene_graphs.home import home_from_dict, home_to_dict
from scene_graphs.json_fields import Json


def furnished_to_dict(stage: Furnished) -> Json:
    """A script in its home: rooms whole, every keyframe's object, and how each room was chosen."""
    return {
        "script": stage.script.model_dump(mode="json"),
        "home": home_to_dict(stage.home),
        "matches": [asdict(match) | _moves(match) for match in stage.matches],
        "places": [[place.room, place.object_id] for place in stage.places],
        "graphs": {room: graph_to_dict(graph) for room, graph in stage.graphs.items()},
    }


def _moves(match: RoomMatch) -> Json:
    return {"pulls": list(map(pull_to_dict, match.pulls)), "drawn_up": list(map(pull_to_dict, match.drawn_up))}


def furnished_from_dict(row: Json) -> Furnished:
    """The inverse of `furnished_to_dict`, but for what only merging needs to know of a graph's nodes."""
    matches = (
        match
        | {
            "substitutions": tuple(map(tuple, match["substitutions"])),
            "missing": tuple(match["missing"]),
            # Stories of earlier versions have none.
            "pulls": tuple(map(pull_from_dict, match.get("pulls", ()))),
            "drawn_up": tuple(map(pull_from_dict, match.get("drawn_up", ()))),
        }
        for match in row["matches"]
    )
    return Furnished(
        script=LongScript.model_validate(row["script"]),
        home=home_from_dict(row["home"]),
        matches=tuple(RoomMatch(**match) for match in matches),
        places=tuple(Place(room, object_id) for room, object_id in row["places"]),
        graphs={room: graph_from_dict(graph) for room, graph in row["graphs"].items()},
    )


def action_to_dict(action: Action) -> Json:
    """Plain values of an action for story.json."""
    plain: Json = {name: value for name, value in vars(action).items() if name != "spot"}
    plain["reacts"] = [vars(one) for one in action.reacts]
    for name in ("lacks", "begins", "by", "handle", "reacts"):
        if not plain[name]:
            del plain[name]
    if action.handle is not None:
        plain["handle"] = asdict(action.handle)
    return plain | {"skill": action.skill.value, "emotion": action.emotion.value, "spot": spot_to_dict(action.spot)}


def action_from_dict(row: Json) -> Action:
    """The inverse of `action_to_dict`."""
    spot = spot_from_dict(row["spot"])
    known = {field.name for field in fields(Action)}
    told = {name: value for name, value in row.items() if name in known}
    plain: Json = {name: tuple(value) if isinstance(value, list) else value for name, value in told.items()}
    plain["reacts"] = tuple(Reaction(**one) for one in row.get("reacts", ()))
    plain |= {"handle": Handle.from_dict(row.get("handle")), "spot": spot}
    return Action(**plain | {"skill": Skill(row["skill"]), "emotion": Emotion(row["emotion"])})


__all__ = [
    "action_from_dict",
    "action_to_dict",
    "furnished_from_dict",
    "furnished_to_dict",
]


def summary_of_script(script: LongScript) -> Json:
    """What a story shows of its script."""
    return {
        "planner": script.planner,
        "encoder": script.encoder or None,
        "beats": [beat.model_dump(mode="json") for beat in script.beats],
        "repairs": list(script.repairs),
        "short_scripts": [
            {"id": r.script.id, "summary": r.script.summary, "score": round(r.score, 4), "beat": r.beat}
            for r in script.short_scripts
        ],
        "keyframes": _keyframes(script),
    }


def summary_of_home(stage: Furnished) -> Json:
    """What a story shows of its home: rooms, graph, and the object of every keyframe."""
    nodes: list[Json] = []
    edges: list[list[int]] = []
    placed = list(zip(stage.script.keyframes, stage.places, strict=True))
    called: dict[str | None, str] = {keyframe.room: stage.room_of(place) for keyframe, place in placed}
    for room, graph in stage.graphs.items():
        numbers = {node: len(nodes) + number for number, node in enumerate(sorted(graph))}
        name = called.get(room, room)
        nodes += [{"category": node.category, "instance": node.instance, "room": name} for node in numbers]
        edges += sorted(sorted((numbers[a], numbers[b])) for a, b in graph.edges)
    keyframes = _keyframes(stage.script)
    for row, place in zip(keyframes, stage.places, strict=True):
        row["object_id"], row["room"] = place.object_id, stage.room_of(place)
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
            "beat": keyframe.beat,
            "also": list(keyframe.also),
            "skill": keyframe.skill.value,
            "emotion": keyframe.emotion,
            "mood": keyframe.mood.value,
            "caption": keyframe.caption,
            "furniture": keyframe.furniture,
            "held": keyframe.held,
            "does": keyframe.does,
            "object_id": None,
            "room": keyframe.room,
            "already": keyframe.already,
            "short_script_id": None if keyframe.short_script is None else ids[keyframe.short_script],
        }
        for index, keyframe in enumerate(script.keyframes)
    ]
