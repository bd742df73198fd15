"""Every call of the HTTP API as a value: what to send, and how to read the answer. Nothing here waits for anything."""

from __future__ import annotations

import io
import json
import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, BinaryIO, Final, Generic, Literal, TypedDict, TypeVar, Unpack
from urllib.parse import quote

import httpx

from planner_service.client.responses import Extraction, Film, Json, Page, Story, page_of

if TYPE_CHECKING:
    from motion_backend.motion import Motion

T = TypeVar("T", covariant=True)
_EXTRACT: Final = "/v1/short-scripts/extract"
Format = Literal["npz", "bvh", "glb", "json", "amass", "f32"]


@dataclass(frozen=True)
class Call(Generic[T]):
    """One request, and how to read its answer."""

    method: str
    path: str
    read: Callable[[httpx.Response], T]
    query: Mapping[str, object] = field(default_factory=dict)
    body: Json | None = None
    content: bytes | None = None
    """A body that is a file, instead of JSON."""
    files: Mapping[str, tuple[str | None, bytes | BinaryIO]] = field(default_factory=dict)
    """Files of a form by their parts, each with its name; the fields of the form are `body`."""
    headers: Mapping[str, str] = field(default_factory=dict)
    repeatable: bool = True
    """Whether sending it twice does what sending it once does."""


class Options(TypedDict, total=False):
    """What stories and motions have in common."""

    backend: str
    seed: int
    character: Mapping[str, object]
    """name, pronouns (he, she, they), height (metres); how they look: member, age, build, skin, hair,
    hair_color, outfit."""
    idempotency_key: str
    """Made up if not given: the call is safe to repeat. Give one to be safe over a restart of your own program."""


class StoryOptions(Options, total=False):
    """What may be said of a story besides its theme."""

    rooms: Sequence[str]
    layouts: Sequence[str]
    home: Json
    short_scripts: int
    method: Literal["auto", "matching", "direct"]


class MotionOptions(Options, total=False):
    """Where keyframes are acted out, one of the two, and how."""

    layout_id: str
    home: Json


class ExtractOptions(TypedDict, total=False):
    """What may be said of what is extracted from."""

    name: str
    """Its title."""
    licence: str
    """Under which the scripts may be passed on."""
    add: bool
    """Whether the scripts are kept in the library, all or none."""
    idempotency_key: str
    """As for stories."""


class Choice(TypedDict, total=False):
    """Which short scripts."""

    emotion: str
    room: str
    furniture: Sequence[str]
    """Those that use all of this."""
    source: str
    licence: str


def tell(theme: str, **options: Unpack[StoryOptions]) -> Call[Story]:
    """Post a theme; the story is queued when this returns."""
    return _made("/v1/stories", {"theme": theme}, dict(options))


def act(keyframes: Sequence[Json], **options: Unpack[MotionOptions]) -> Call[Story]:
    """Act keyframes out in a room of the library (`layout_id`) or in a `home`, without planning."""
    return _made("/v1/motions", {"keyframes": list(keyframes)}, dict(options))


def take(
    story_id: str,
    keyframes: Sequence[Json] | None = None,
    home: Json | None = None,
    layouts: Sequence[str] = (),
    **options: Unpack[Options],
) -> Call[Story]:
    """Derive a story from a story: with another script, home, seed, backend or character; all else stays as it was.

    `keyframes` is the whole script as it is to be: those of the story by their `index`, changed or not, and new ones.
    Instead of a whole `home`, `layouts` names rooms of the library.
    ApiError 409 before the story has its home.
    """
    script = None if keyframes is None else list(keyframes)
    return _made(
        _at("stories", story_id, "takes"),
        _given(keyframes=script, home=home, layouts=list(layouts) or None),
        dict(options),
    )


def _made(path: str, body: Json, options: Json) -> Call[Story]:
    key = options.pop("idempotency_key", None) or str(uuid.uuid4())
    return Call("POST", path, _story, body=body | options, headers={"Idempotency-Key": key})


def stories(limit: int = 20, cursor: str | None = None) -> Call[Page[Story]]:
    """Stories, newest first, without their texts and keyframes."""
    return Call("GET", "/v1/stories", lambda answer: page_of(Story, answer.json()), _given(limit=limit, cursor=cursor))


def story(story_id: str) -> Call[Story]:
    """A story, as far as it is made."""
    return Call("GET", _at("stories", story_id), _story)


def cancel(story_id: str) -> Call[Story]:
    """Stop a story; what was made can still be fetched. ApiError 409 if it has ended otherwise."""
    return Call("POST", _at("stories", story_id, "cancel"), _story)


def delete(story_id: str) -> Call[None]:
    """Delete a story and all that was made of it."""
    return Call("DELETE", _at("stories", story_id), _nothing)


def motion(story_id: str, first: int = 0, last: int | None = None) -> Call[Motion]:
    """Frames first to last (exclusive) as far as they are ready, as numpy arrays. Reading them loads the engine."""
    return Call("GET", _at("stories", story_id, "motion"), _motion, _given(**{"from": first, "to": last}))


def motion_file(story_id: str, format: Format, first: int = 0, last: int | None = None) -> Call[bytes]:  # noqa: A002
    """The same frames in a format to be saved: npz, bvh, glb, json or f32."""
    query = _given(**{"format": format, "from": first, "to": last})
    return Call("GET", _at("stories", story_id, "motion"), _bytes, query)


def film(story_id: str) -> Call[bytes]:
    """The home and the animated character in one GLB."""
    return Call("GET", _at("stories", story_id, "film.glb"), _bytes)


def film_usd(story_id: str) -> Call[bytes]:
    """The same as USD. ApiError 501 where the service has no usd-core."""
    return Call("GET", _at("stories", story_id, "film.usd"), _bytes)


def make_film(story_id: str) -> Call[Film]:
    """Have a story filmed as MP4; `wait_film` waits for it. ApiError 409 before it has succeeded,
    501 where the service cannot film."""
    return Call("POST", _at("stories", story_id, "film"), _film)


def film_state(story_id: str) -> Call[Film]:
    """How far that is; its state is absent where nobody has asked for it."""
    return Call("GET", _at("stories", story_id, "film"), _film)


def film_mp4(story_id: str) -> Call[bytes]:
    """The story filmed: H.264, 1280 x 720. ApiError 404 until it is there."""
    return Call("GET", _at("stories", story_id, "film.mp4"), _bytes)


def delete_film(story_id: str) -> Call[None]:
    """Stop and delete a story's film; the story stays."""
    return Call("DELETE", _at("stories", story_id, "film"), _nothing)


def scene(story_id: str) -> Call[bytes]:
    """The home alone, as GLB."""
    return Call("GET", _at("stories", story_id, "scene.glb"), _bytes)


def props(story_id: str) -> Call[bytes]:
    """What is in the hands alone, animated, as GLB; empty where that is nothing."""
    return Call("GET", _at("stories", story_id, "props.glb"), _bytes)


def home(story_id: str) -> Call[Json]:
    """The home whole; `tell` and `act` take it again as `home`."""
    return Call("GET", _at("stories", story_id, "home"), _json)


def extract(
    text: str | None = None,
    *,
    video: bytes | BinaryIO | None = None,
    subtitles: bytes | BinaryIO | None = None,
    **options: Unpack[ExtractOptions],
) -> Call[Extraction]:
    """Short scripts out of a text, or of a film, its subtitles, or both; files are opened in binary mode.

    What is quickly read has succeeded when this returns; wait for the rest with `wait_extraction`.
    """
    fields = dict(options)
    headers = {"Idempotency-Key": str(fields.pop("idempotency_key", None) or uuid.uuid4())}
    given = {"video": video, "subtitles": subtitles}
    files = {part: (_name_of(file), file) for part, file in given.items() if file is not None}
    if (text is None) == (not files):
        raise ValueError("give a text, or a video, subtitles or both")
    if text is not None:
        return Call("POST", _EXTRACT, _extraction, body={"text": text} | fields, headers=headers)
    sent = fields | ({"add": str(fields["add"]).lower()} if "add" in fields else {})
    return Call("POST", _EXTRACT, _extraction, body=sent, files=files, headers=headers)


def _name_of(file: bytes | BinaryIO) -> str | None:
    """The last part of the name of an open file, after which the service calls it."""
    name = getattr(file, "name", None)
    return name.replace("\\", "/").rsplit("/", 1)[-1] if isinstance(name, str) else None


def extractions(limit: int = 20, cursor: str | None = None) -> Call[Page[Extraction]]:
    """Extractions, newest first, without their scripts and scenes."""
    query = _given(limit=limit, cursor=cursor)
    return Call("GET", "/v1/extractions", lambda answer: page_of(Extraction, answer.json()), query)


def extraction(extraction_id: str) -> Call[Extraction]:
    """An extraction, as far as it is made."""
    return Call("GET", _at("extractions", extraction_id), _extraction)


def cancel_extraction(extraction_id: str) -> Call[Extraction]:
    """Stop an extraction; scripts that were made can still be fetched. ApiError 409 if it has ended otherwise."""
    return Call("POST", _at("extractions", extraction_id, "cancel"), _extraction)


def delete_extraction(extraction_id: str) -> Call[None]:
    """Delete an extraction; scripts that it put into the library stay."""
    return Call("DELETE", _at("extractions", extraction_id), _nothing)


def short_scripts(limit: int = 20, cursor: str | None = None, **choice: Unpack[Choice]) -> Call[Page[Json]]:
    """The short scripts that stories are woven from."""
    return Call("GET", "/v1/short-scripts", _page, _given(limit=limit, cursor=cursor, **choice))


def short_script(script_id: str, version: int | None = None) -> Call[Json]:
    """One short script, as it is or as it was at a version."""
    return Call("GET", _at("short-scripts", script_id), _json, _given(version=version))


def short_script_versions(script_id: str) -> Call[list[Json]]:
    """One short script as it was and is, oldest first."""
    return Call("GET", _at("short-scripts", script_id, "versions"), _items)


def export_short_scripts(own: bool = False, **choice: Unpack[Choice]) -> Call[list[Json]]:
    """The short scripts as they can be added again; `own` leaves out those that are shipped."""
    return Call("GET", "/v1/short-scripts/export", _lines, _given(own=own, **choice))


def search_short_scripts(q: str, k: int = 5, **choice: Unpack[Choice]) -> Call[list[Json]]:
    """The nearest in meaning, best first: [{score, short_script}]."""
    return Call("GET", "/v1/short-scripts/search", _items, _given(q=q, k=k, **choice))


def add_short_script(script: Json) -> Call[Json]:
    """Add one of your own."""
    return Call("POST", "/v1/short-scripts", _json, body=script, repeatable=False)


def change_short_script(script: Json) -> Call[Json]:
    """Change one of your own: whole, with the version that you read. ApiError 409 if it was changed meanwhile."""
    row = {name: value for name, value in script.items() if name != "built_in"}
    return Call("PUT", _at("short-scripts", str(script["id"])), _json, body=row)


def delete_short_script(script_id: str) -> Call[None]:
    """Remove one of your own."""
    return Call("DELETE", _at("short-scripts", script_id), _nothing)


def captions(skill: str | None = None, q: str = "") -> Call[list[Json]]:
    """How skills can be done: [{caption, skill, shows, others}]; of `q`, those that have all its words or mean them."""
    return Call("GET", "/v1/captions", _items, _given(skill=skill, q=q or None))


def emotions() -> Call[list[Json]]:
    """The nine emotions, and words that mean them: [{emotion, words}]."""
    return Call("GET", "/v1/emotions", _items)


def furniture(affords: Literal["sit", "lie", "touch"] | None = None) -> Call[list[Json]]:
    """What keyframes can name: [{word, category, of_class, group, affords}]."""
    return Call("GET", "/v1/furniture", _items, _given(affords=affords))


def skills() -> Call[list[Json]]:
    """What a body can do in one keyframe: [{skill, needs, usual, captions}]."""
    return Call("GET", "/v1/skills", _items)


def backends() -> Call[list[Json]]:
    """What can move a body at this service: [{backend, about, default}]."""
    return Call("GET", "/v1/backends", _items)


def long_script(theme: str, **options: Any) -> Call[Json]:
    """The plan for a theme at once, without a home or motion; options: method, short_scripts, rooms, seed."""
    return Call("POST", "/v1/long-scripts", _json, body={"theme": theme} | options)


def plan_task(action: str, **options: Any) -> Call[Json]:
    """An instruction as steps, and the keyframes that act them; options: layout_id, home, seed, method."""
    return Call("POST", "/v1/task-plans", _json, body={"action": action} | options)


def layouts(limit: int = 20, cursor: str | None = None, room: str | None = None) -> Call[Page[Json]]:
    """The rooms that homes are joined from."""
    return Call("GET", "/v1/layouts", _page, _given(limit=limit, cursor=cursor, room=room))


def layout(layout_id: str) -> Call[Json]:
    """One room."""
    return Call("GET", _at("layouts", layout_id), _json)


def add_layout(room: Json) -> Call[Json]:
    """Add a room of your own; the answer says what was checked."""
    return Call("POST", "/v1/layouts", _json, {"format": "native"}, room, repeatable=False)


def import_layouts(file: bytes, format: str, **options: Any) -> Call[Json]:  # noqa: A002
    """Add all rooms of a scene file in another format; options: name, scan, room, up, front, unit.

    The answer lists the rooms with what was kept, dropped and why.
    """
    binary = {"Content-Type": "application/octet-stream"}
    query = {"format": format} | options
    return Call("POST", "/v1/layouts", _json, query, content=file, headers=binary, repeatable=False)


def delete_layout(layout_id: str) -> Call[None]:
    """Remove a room of your own."""
    return Call("DELETE", _at("layouts", layout_id), _nothing)


def layout_drawing(layout_id: str, ending: Literal["svg", "png"] = "svg", **options: Any) -> Call[bytes]:
    """A room from above; options: graph, spots, path, to."""
    return Call("GET", _at("layouts", layout_id, f"drawing.{ending}"), _bytes, options)


def layout_scene(layout_id: str) -> Call[bytes]:
    """One room as GLB."""
    return Call("GET", _at("layouts", layout_id, "scene.glb"), _bytes)


def retrieve_layouts(graph: Json, **options: Any) -> Call[list[Json]]:
    """The rooms nearest to a furniture graph, or homes; options: k, rooms, max_rooms."""
    return Call("POST", "/v1/layouts/retrieve", _matches, body={"graph": graph} | options)


def merge_graphs(graphs: Sequence[Json], **options: Any) -> Call[Json]:
    """One furniture graph that serves all; options: method (canonical, aligned)."""
    return Call("POST", "/v1/layout-graphs/merge", _json, body={"graphs": list(graphs)} | options)


def _at(*steps: str) -> str:
    return "/v1/" + "/".join(quote(step, safe="") for step in steps)


def _given(**query: object) -> dict[str, object]:
    return {name: value for name, value in query.items() if value is not None}


def _story(answer: httpx.Response) -> Story:
    return Story(answer.json())


def _film(answer: httpx.Response) -> Film:
    return Film(answer.json())


def _extraction(answer: httpx.Response) -> Extraction:
    return Extraction(answer.json())


def _json(answer: httpx.Response) -> Json:
    row: Json = answer.json()
    return row


def _page(answer: httpx.Response) -> Page[Json]:
    return page_of(lambda row: row, answer.json())


def _items(answer: httpx.Response) -> list[Json]:
    return list(answer.json()["items"])


def _lines(answer: httpx.Response) -> list[Json]:
    return [json.loads(line) for line in answer.text.split("\n") if line]


def _matches(answer: httpx.Response) -> list[Json]:
    return list(answer.json()["matches"])


def _bytes(answer: httpx.Response) -> bytes:
    return answer.content


def _nothing(_answer: httpx.Response) -> None:
    return None


def _motion(answer: httpx.Response) -> Motion:
    from motion_backend.formats.npz import read_npz

    return read_npz(io.BytesIO(answer.content))
