"""What a model says it saw in a scene, checked: times inside it, known emotions, known furniture."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import BaseModel, ConfigDict, Field

from motion_backend.emotion_words import emotion_of
from planner_service.extraction.shot_detection import Scene
from planner_service.scripts.script import EMOTIONS
from scene_graphs.furniture import ROOM_TYPES, canonical, canonical_room, display_name, is_known

LEEWAY: Final = 1.0
"""Seconds by which a model's time may lie outside of the scene; it is moved inside."""
_MAX_ENTRIES: Final = 40
"""Entries of each list."""
_NOBODY: Final = frozenset(("", "none", "nothing", "unknown", "floor", "ground", "air", "n/a"))
Said = Annotated[str, Field(max_length=500)]
Name = Annotated[str, Field(max_length=80)]


class SeenCharacter(BaseModel):
    """Somebody in the scene, as a model writes it."""

    name: Name
    emotion: Name


class SeenContact(BaseModel):
    """Somebody touching, sitting or lying on something, as a model writes it."""

    character: Name
    object: Name
    how: Said
    time: float


class SeenMoment(BaseModel):
    """Something that happens, as a model writes it."""

    time: float
    who: Name
    what: Said
    emotion: Name


class SceneAnswer(BaseModel):
    """The answer to `prompts/watch_scene.md`."""

    room: Name
    place: Said
    summary: Said
    characters: list[SeenCharacter]
    objects: list[Name]
    contacts: list[SeenContact]
    moments: list[SeenMoment]


class _Kept(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Character(_Kept):
    """Somebody in the scene, and one of the nine emotions."""

    name: str
    emotion: str


class Contact(_Kept):
    """Who is in contact with which furniture, how, and when (seconds of the film)."""

    character: str
    object: str
    how: str
    time: float


class Moment(_Kept):
    """What somebody does, in which of the nine emotions, and when (seconds of the film)."""

    time: float
    who: str
    what: str
    emotion: str


class SceneOutline(_Kept):
    """A scene in words that can be relied on; all lists in the order of time."""

    number: int
    start: float
    end: float
    room: str | None
    """One of the four room types, or None for any other place."""
    place: str
    summary: str
    characters: tuple[Character, ...]
    objects: tuple[str, ...]
    """Furniture that is known, each once."""
    contacts: tuple[Contact, ...]
    moments: tuple[Moment, ...]
    notes: tuple[str, ...] = ()
    """What was left out, and why."""


def problems_in(answer: SceneAnswer, scene: Scene) -> list[str]:
    """What a model has to mend: emotions that are none, times of another scene, too much or nothing at all."""
    found = [] if answer.summary.strip() else ["summary: it is empty; write what happens"]
    lists = {name: len(getattr(answer, name)) for name in ("characters", "objects", "contacts", "moments")}
    found += [f"{name}: {many} of them, at most {_MAX_ENTRIES}" for name, many in lists.items() if many > _MAX_ENTRIES]
    feeling = [("characters", index, one.emotion) for index, one in enumerate(answer.characters)]
    feeling += [("moments", index, one.emotion) for index, one in enumerate(answer.moments)]
    for name, index, emotion in feeling[: 2 * _MAX_ENTRIES]:
        if emotion_of(emotion) is None:
            found.append(f"{name}.{index}.emotion: {emotion!r} is none of {', '.join(EMOTIONS)}")
    timed = [("contacts", index, one.time) for index, one in enumerate(answer.contacts)]
    timed += [("moments", index, one.time) for index, one in enumerate(answer.moments)]
    for name, index, time in timed[: 2 * _MAX_ENTRIES]:
        if not scene.start - LEEWAY <= time <= scene.end + LEEWAY:
            found.append(f"{name}.{index}.time: {time:g} is not in the scene, {scene.start:g} to {scene.end:g} s")
    return found


def outline_of(answer: SceneAnswer, scene: Scene) -> SceneOutline:
    """The outline of an answer in which `problems_in` finds nothing; unknown things are dropped with a note."""
    dropped: dict[str, str] = {}
    contacts = []
    for contact in sorted(answer.contacts, key=lambda one: one.time):
        known = _furniture(contact.object, dropped)
        if known is not None:
            contacts.append(
                Contact(
                    character=_tidy(contact.character),
                    object=known,
                    how=_tidy(contact.how),
                    time=inside(contact.time, scene),
                )
            )
    named = [_furniture(word, dropped) for word in answer.objects]
    room = canonical_room(answer.room)
    return SceneOutline(
        number=scene.number,
        start=scene.start,
        end=scene.end,
        room=room if room in ROOM_TYPES else None,
        place=_tidy(answer.place),
        summary=_tidy(answer.summary),
        characters=tuple(
            Character(name=_tidy(one.name), emotion=emotion_of(one.emotion) or "neutral") for one in answer.characters
        ),
        objects=tuple(dict.fromkeys(word for word in (*named, *(one.object for one in contacts)) if word)),
        contacts=tuple(contacts),
        moments=tuple(
            Moment(
                time=inside(one.time, scene),
                who=_tidy(one.who),
                what=_tidy(one.what),
                emotion=emotion_of(one.emotion) or "neutral",
            )
            for one in sorted(answer.moments, key=lambda one: one.time)
            if one.what.strip()
        ),
        notes=tuple(f"scene {scene.number}: {note}" for note in dropped.values()),
    )


def inside(time: float, scene: Scene | SceneOutline) -> float:
    """A time of a scene that may lie a little outside of it (seconds)."""
    return round(min(max(time, scene.start), scene.end), 2)


def _furniture(word: str, dropped: dict[str, str]) -> str | None:
    """The furniture a word means; None, with a note, for what is no furniture."""
    plain = _tidy(word)
    if plain.lower() in _NOBODY:
        return None
    if is_known(plain):
        return display_name(canonical(plain))
    dropped.setdefault(plain.lower(), f'"{plain[:60]}" is no furniture that is known; left out')
    return None


def _tidy(text: str) -> str:
    """One line without control characters."""
    return "".join(letter for letter in " ".join(text.split()) if letter.isprintable())
