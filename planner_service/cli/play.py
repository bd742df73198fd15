"""`sims play SCRIPT.json`: a script of one's own, acted out in a home."""

from __future__ import annotations

import json
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Final

import typer
from pydantic import ValidationError
from rich.console import Console

from motion_backend.motion import Character, Emotion, Skill, moment
from planner_service.cli.cast_command import CharacterOption, character_given
from planner_service.cli.console import BackendOption, FilmOption, HeightOption, LayoutOption, UsdOption
from planner_service.cli.story import Extra, check_output, produce
from planner_service.library.library import open_shelves
from planner_service.pipeline import Pipeline, RequestError, StoryRequest
from planner_service.scripts.caption_actions import look_of
from planner_service.scripts.caption_fallbacks import Words, hashed_words, performed_as, usual
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


def play(
    script: Annotated[Path, typer.Argument(help="Keyframes as JSON: a list, a script that has some, or a story.json.")],
    out: Annotated[Path | None, typer.Option(help="Folder for the files; left out: a new one in out/.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same motion.")] = 0,
    layout: LayoutOption = None,
    backend: BackendOption = None,
    height: HeightOption = 1.70,
    character: CharacterOption = "",
    film: FilmOption = False,
    usd: UsdOption = False,
) -> None:
    """Act out a script of your own: nothing is planned, a home is found for it unless one is given."""
    from planner_service.cli.layouts import chosen_layouts

    settings = read_settings()
    keyframes, title = read_script(script)
    extra = Extra(film, usd)
    check_output(out, extra)
    console = Console(markup=False)
    pipeline = Pipeline(open_shelves(settings))
    for line in unknown_captions(keyframes, pipeline.words):
        console.print(f"{script.name}: {line}", highlight=False, soft_wrap=True)
    request = StoryRequest(
        theme=title,
        keyframes=tuple(keyframes),
        layouts=chosen_layouts(layout or [], pipeline.shelves),
        seed=seed,
        backend=backend or settings.backend,
        character=character_given(character, Character(height=height)),
    )
    produce(pipeline, request, out, extra, console)


def read_script(path: Path) -> tuple[list[Keyframe], str]:
    """The keyframes of a file, and its title or summary, if it has one. RequestError names the place in it, and what
    would be right there."""
    rows, title = _rows(path)
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
    return [keyframe for keyframe in keyframes if keyframe is not None], title


def _rows(path: Path) -> tuple[Any, str]:
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
        found = json.loads(data) if len(data) <= MAX_BYTES else None
    except OSError as error:
        raise RequestError(f"{path}: cannot be read: {error.strerror or error}", at="script") from error
    except (ValueError, RecursionError) as error:
        raise RequestError(f"{path.name}: is not JSON: {error}", at="script") from error
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


def _keyframe(row: Any, where: str, faults: list[str]) -> Keyframe | None:
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
        how = "is read word by word" if done == caption else f"is unknown to the body, which does {done!r} instead"
        told.append(f"{moment(number)}, caption: {caption!r} {how}{_perhaps(_meant(keyframe, caption, rows, words()))}")
    return told


def _meant(keyframe: Keyframe, caption: str, rows: Sequence[str], words: Vocabulary) -> list[str]:
    """Known captions that may be meant: misspelt ones, those near in meaning, then what the mood usually does."""
    misspelt = get_close_matches(caption, list(dict.fromkeys(rows)), n=1, cutoff=MISSPELT)
    moody = [] if keyframe.mood is Emotion.NEUTRAL else [usual(keyframe.skill, keyframe.mood, caption)]
    return [one for one in dict.fromkeys([*misspelt, *words.near(keyframe.skill, caption), *moody]) if one in rows]


def _perhaps(found: Sequence[str]) -> str:
    return f"; perhaps {', '.join(map(repr, found[:SUGGESTED]))}" if found else ""
