"""`sims play SCRIPT.json`: a script of one's own, acted out in a home."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Final, NamedTuple

import typer
from pydantic import ValidationError
from rich.console import Console

from motion_backend.motion import Character, Emotion, Skill, moment
from planner_service.cast_choice import DEFAULT
from planner_service.cli.cast_command import CharacterOption, character_given
from planner_service.cli.console import (
    BackendOption,
    FilmOption,
    HeightOption,
    LayoutOption,
    NameOption,
    PronounsOption,
    UsdOption,
)
from planner_service.cli.story import Extra, check_output, produce
from planner_service.library.library import open_shelves
from planner_service.output.replayed_story import ReplayedStory, is_story
from planner_service.pipeline import Pipeline, RequestError, StoryRequest
from planner_service.scripts.caption_actions import look_of
from planner_service.scripts.caption_fallbacks import Words, hashed_words, not_seen, performed_as, usual
from planner_service.scripts.captions import Vocabulary, captions, synonyms
from planner_service.scripts.script import Keyframe, PlannedKeyframe, legible
from planner_service.settings import read_settings
from planner_service.tasks.task_plan import MAX_KEYFRAMES
from scene_graphs.furniture import catalogue, display_name, is_known

MAX_BYTES: Final = 1 << 20
"""Of a script's file."""
MAX_FAULTS: Final = 20
"""That are told of one file."""
SUGGESTED: Final = 3
"""Words at most, in place of one that is not known."""
MISSPELT: Final = 0.8
"""Share of its letters that a misspelt caption has in common with the one that was meant."""
NAMES: Final = ("title", "summary")
"""Under which it has what it is called."""
MAX_TITLE: Final = 200
KEYS: Final = ("script", "keyframes")
"""Under which a story.json, a long or a short script has its keyframes."""


class Script(NamedTuple):
    """What a file has to be played."""

    keyframes: list[PlannedKeyframe]
    title: str
    """Or summary; empty: it has none."""
    story: ReplayedStory | None = None
    """The story that was made of them before; None: they are just a script."""


def play(
    script: Annotated[Path, typer.Argument(help="Keyframes as JSON: a list, a script that has some, or a story.json.")],
    out: Annotated[Path | None, typer.Option(help="Folder for the files; left out: a new one in out/.")] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="The same seed gives the same motion; left out: the story's own, else 0.")
    ] = None,
    layout: LayoutOption = None,
    backend: BackendOption = None,
    name: NameOption = "Sam",
    pronouns: PronounsOption = "they",
    height: HeightOption = 1.70,
    character: CharacterOption = "",
    film: FilmOption = False,
    usd: UsdOption = False,
) -> None:
    """Act out a script of your own: nothing is planned, a home is found for it unless one is given.

    The story.json of a story plays as that story did, but for the moments that were changed in it.
    """
    from planner_service.cli.layouts import chosen_layouts

    settings = read_settings()
    given = read_script(script)
    extra = Extra(film, usd)
    check_output(out, extra)
    console = Console(markup=False)
    pipeline = Pipeline(open_shelves(settings))
    layouts = chosen_layouts(layout or [], pipeline.shelves)
    asked = Character(name, pronouns, height)
    if given.story is None:
        for line in unknown_captions(given.keyframes, pipeline.words):
            console.print(f"{script.name}: {line}", highlight=False, soft_wrap=True)
        request = StoryRequest(
            theme=given.title,
            keyframes=tuple(given.keyframes),
            layouts=layouts,
            seed=seed or 0,
            backend=backend or settings.backend,
            character=character_given(character, asked),
        )
        produce(lambda show: pipeline.make(request, show), out, extra, console)
        return
    before = given.story.request
    request = replace(
        before,
        seed=before.seed if seed is None else seed,
        backend=backend or before.backend,
        character=_who(before.character, character, asked),
    )
    with _named(script):
        planned = given.story.planned(pipeline, request, layouts)
    produce(lambda show: pipeline.play(planned, show, given.story.kept(planned)), out, extra, console)  # type: ignore[union-attr]


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """What is wrong inside is said to be in that file."""
    try:
        yield
    except RequestError as error:
        raise RequestError(f"{path.name}: {error.fault}", error.remedy, at=error.at) from error


def _who(before: Character, argument: str, asked: Character) -> Character:
    """Who plays a story again: who did, with what is asked for; another member of the cast is another person."""
    person = character_given(argument, DEFAULT).member
    told = {field: value for field, value in vars(asked).items() if value != getattr(DEFAULT, field)}
    return character_given(argument, replace(DEFAULT if person else before, **told))


def read_script(path: Path) -> Script:
    """The keyframes of a file, its title or summary, if it has one, and the story it is, if it is one. RequestError
    names the place in it, and what would be right there."""
    found = _json(path)
    rows, title = _rows(found)
    if not isinstance(rows, list) or not rows:
        raise RequestError(f"{path.name}: holds no keyframes", "a list of them, or an object that has `keyframes`")
    if len(rows) > MAX_KEYFRAMES:
        raise RequestError(f"{path.name}: has {len(rows)} keyframes, at most {MAX_KEYFRAMES} are acted")
    faults: list[str] = []
    keyframes = [_keyframe(row, moment(number), faults) for number, row in enumerate(rows)]
    if faults:
        more = [f"and {len(faults) - MAX_FAULTS} more"] if len(faults) > MAX_FAULTS else []
        told = " · ".join([*faults[:MAX_FAULTS], *more])
        raise RequestError(f"{path.name}: {told}", at="script")
    read = [keyframe for keyframe in keyframes if keyframe is not None]
    with _named(path):
        return Script(read, title, ReplayedStory.read(found, read) if is_story(found) else None)


def _json(path: Path) -> Any:
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
        return json.loads(data) if len(data) <= MAX_BYTES else None
    except OSError as error:
        raise RequestError(f"{path}: cannot be read: {error.strerror or error}", at="script") from error
    except (ValueError, RecursionError) as error:
        raise RequestError(f"{path.name}: is not JSON: {error}", at="script") from error


def _rows(found: Any) -> tuple[Any, str]:
    """What may be its keyframes, and what it calls itself."""
    title = _title_of(found)
    for key in KEYS:
        if isinstance(found, dict) and key in found:
            found = found[key]
            title = title or _title_of(found)
    return found, title


def _title_of(found: Any) -> str:
    """What a script calls itself: a story its title, a short script its summary."""
    names = [found.get(name) for name in NAMES] if isinstance(found, dict) else []
    return next((legible(name)[:MAX_TITLE] for name in names if isinstance(name, str) and name.strip()), "")  # type: ignore[index]


def _keyframe(row: Any, where: str, faults: list[str]) -> PlannedKeyframe | None:
    """A keyframe at known furniture; else what is wrong with it is added to the faults."""
    keyframe = None
    try:
        keyframe = PlannedKeyframe.model_validate(row)
    except ValidationError as error:
        faults += [_fault(where, one["loc"], one["type"], one["msg"]) for one in error.errors(include_url=False)]
    furniture = Keyframe.model_construct(skill=Skill.LOCO, caption="", furniture=_furniture_of(row))
    if not furniture.on_floor and not is_known(furniture.piece[0]):
        words = sorted(map(display_name, catalogue().class_of))
        spelt_alike = get_close_matches(furniture.piece[0], list(dict.fromkeys(words)), n=SUGGESTED, cutoff=0.4)
        near = _perhaps(spelt_alike) or '; "floor" needs none'
        faults.append(f"{where}, furniture: {furniture.furniture!r:.80} is not known{near}")
        return None
    return keyframe


def _fault(where: str, loc: Sequence[int | str], kind: str, said: str) -> str:
    """Where a keyframe is wrong, and what would be right."""
    has = ", ".join(PlannedKeyframe.model_fields)
    remedy = f"; leave it out, a keyframe has {has}" if kind == "extra_forbidden" else ""
    return f"{', '.join([where, *map(str, loc)])}: {said}{remedy}"


def _furniture_of(row: Any) -> str:
    """The furniture that a row names, as far as it is text; else the floor."""
    found = row.get("furniture", row.get("furnitures")) if isinstance(row, dict) else None
    return found if isinstance(found, str) else "floor"


def unknown_captions(keyframes: Sequence[Keyframe], words: Words = hashed_words) -> list[str]:
    """Where captions stand that are none of the body's own, and what is done: their words as far as they go, or another
    caption. `words` are asked for what is near."""
    known = {skill: [*rows, *synonyms().get(skill, {})] for skill, rows in captions().items()}
    told = []
    for number, keyframe in enumerate(keyframes):
        if (caption := look_of(keyframe.caption)) in (rows := known[keyframe.skill]):
            continue
        done = performed_as(keyframe.skill, caption, keyframe.mood, words)
        near = [one for one in _meant(keyframe, caption, rows, words()) if one != done]
        told.append(f"{moment(number)}, caption: {caption!r} {_how(keyframe.skill, caption, done)}{_perhaps(near)}")
    return told


def _how(skill: Skill, caption: str, done: str) -> str:
    """What the body makes of a caption that is none of its own."""
    if done != caption:
        return f"is unknown to the body, which does {done!r} instead"
    lost = " and ".join(map(repr, not_seen(skill, caption)))
    return f"is read word by word{f', and nothing of {lost} is seen' if lost else ''}"


def _meant(keyframe: Keyframe, caption: str, rows: Sequence[str], words: Vocabulary) -> list[str]:
    """Known captions that may be meant: misspelt ones, those near in meaning, then what the mood usually does."""
    misspelt = get_close_matches(caption, list(dict.fromkeys(rows)), n=1, cutoff=MISSPELT)
    moody = [] if keyframe.mood is Emotion.NEUTRAL else [usual(keyframe.skill, keyframe.mood, caption)]
    return [one for one in dict.fromkeys([*misspelt, *words.near(keyframe.skill, caption), *moody]) if one in rows]


def _perhaps(found: Sequence[str]) -> str:
    return f"; perhaps {', '.join(map(repr, found[:SUGGESTED]))}" if found else ""
