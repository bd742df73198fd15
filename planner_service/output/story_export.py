"""A story on disk: every file of it, written aside and moved into place whole, so that nothing half-made is left."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from motion_backend.backends import about, movers
from motion_backend.formats.bvh import write_bvh
from motion_backend.formats.glb_film import film_glb
from motion_backend.formats.motion_json import phase_to_dict
from motion_backend.formats.npz import write_npz
from motion_backend.formats.usd_film import film_usd
from motion_backend.metrics.figure_limits import held_against
from motion_backend.metrics.figure_words import told_limits
from motion_backend.motion import Action
from planner_service.cast_choice import told_look
from planner_service.jobs.serialization import action_to_dict
from planner_service.narration.told import UNSEEN
from planner_service.output.film import Filmed, write_film
from planner_service.output.replayed_story import ACTED, acted_to_dict
from planner_service.output.storyboard import storyboard
from planner_service.pipeline import Planned, Story
from planner_service.scripts.caption_actions import look_of
from planner_service.scripts.caption_fallbacks import not_seen
from scene_graphs.errors import UserError
from scene_graphs.home import home_to_dict

Writer = Callable[[Path], object]
FILM = "film.mp4"
USD = "film.usd"
PLANNERS = {
    "rules": "rules, without a language model",
    "markov": "drawing at random what is plausible (markov)",
    "given": "whoever gave the keyframes",
}
"""Who plans where no language model does."""
ENCODERS = {"hashing": "their words (hashing), for want of the sentence encoder"}
"""Ways to find scripts that are no encoder's name."""
FILES = ("story.md", "story.json", "report.json", "motion.npz", "motion.bvh", "film.glb", "storyboard.png")


class OutputError(UserError):
    """The folder for a story's files cannot be written."""


def write_story(
    story: Story,
    folder: Path,
    film: bool = False,
    show: Callable[[float], None] = lambda _: None,
    usd: bool = False,
) -> list[Path]:
    """All files of a story in `folder`: story.md, story.json, report.json, motion.npz, motion.bvh, film.glb,
    storyboard.png, and where they are asked for film.usd and film.mp4, of which `show` is told which share is done. A
    file of that name from an earlier story is replaced; OutputError, FilmUnavailableError and UsdUnavailableError leave
    everything as it was.
    """
    writers: dict[str, Writer] = {
        "story.md": lambda path: path.write_text(story_to_markdown(story), encoding="utf-8"),
        "story.json": lambda path: _write_json(path, story_to_dict(story)),
        "report.json": lambda path: _write_json(path, report_to_dict(story)),
        "motion.npz": lambda path: write_npz(story.motion, path),
        "motion.bvh": lambda path: write_bvh(story.motion, path),
        "film.glb": lambda path: path.write_bytes(film_glb(story.planned.home, story.motion, story.role)),
        "storyboard.png": lambda path: _write_storyboard(story, path),
    }
    if usd:
        writers[USD] = lambda path: path.write_bytes(film_usd(story.planned.home, story.motion, story.role))
    if film:
        writers[FILM] = lambda path: write_film(Filmed.of(story), path, show=show)
    return write_files(folder, writers)


def write_files(folder: Path, writers: Mapping[str, Writer]) -> list[Path]:
    """Write every file aside, then move all of them into place. OutputError leaves everything as it was."""
    with _writing(folder) as aside:
        for name, write in writers.items():
            write(aside / name)
        _refuse_folders(folder, writers)
        for name in writers:
            (aside / name).replace(folder / name)
    return [folder / name for name in writers]


@contextmanager
def _writing(folder: Path) -> Iterator[Path]:
    """An empty folder inside `folder`; all that had to be made for it is removed again when the block fails."""
    made: list[Path] = []
    try:
        made = [path for path in (folder, *folder.parents) if not path.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".writing-", dir=folder, ignore_cleanup_errors=True) as aside:
            yield Path(aside)
    except BaseException as error:
        for path in made:
            with suppress(OSError):
                path.rmdir()
        if isinstance(error, OSError):
            why = "a file is in the way" if isinstance(error, FileExistsError) else error.strerror or error
            raise OutputError(f"{folder} cannot be written: {why}", "choose another place", at="--out") from error
        raise


def _write_storyboard(story: Story, path: Path) -> Path:
    planned, known = story.planned, {placed.id for placed in story.planned.home.objects}
    # What is done on the floor has no piece of furniture to outline.
    targets = [action.object_id if action.object_id in known else None for action in story.actions]
    return storyboard(
        planned.home,
        story.motion,
        planned.script.keyframes,
        path,
        story.told.title,
        targets,
        story.role,
        Filmed.of(story).edit.left_out,
    )


class _Tried(Exception):  # noqa: N818
    """Ends a trial, so that nothing of it stays."""


def check_writable(folder: Path, names: Iterable[str] = ()) -> None:
    """Fail before the work, not after it, if files of these names cannot be put there. Raises OutputError."""
    with suppress(_Tried), _writing(folder) as aside:
        for name in names:
            (aside / name).touch()
        _refuse_folders(folder, names)
        raise _Tried


def _refuse_folders(folder: Path, names: Iterable[str]) -> None:
    """A file cannot take the place of a folder; seen in time, no earlier file is replaced."""
    for name in names:
        if (folder / name).is_dir():
            raise OutputError(f"{folder / name} is a folder, a file would be written there", "move it away", at="--out")


def _write_json(path: Path, value: dict[str, Any]) -> None:
    path.write_text(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")


def story_to_markdown(story: Story) -> str:
    """The told story with what it was made of."""
    planned, script = story.planned, story.planned.script
    rows = [
        f"| {number} | {keyframe.skill.words} | {keyframe.emotion} | {keyframe.caption} | "
        f"{action.furniture}{f' ({action.object_id})' if action.object_id else ''} | {_mark(figure.reached)} |"
        for number, (keyframe, action, figure) in enumerate(
            zip(script.keyframes, story.actions, story.figures, strict=True), 1
        )
    ]
    rooms = [f"- {line}" for line in planned.stage.explain()]
    notes = [f"- {line}" for line in told_notes(story)] or ["- nothing"]
    repairs = [f"- {line}" for line in script.repairs] or ["- none"]
    beats = [f"- {line}" for line in story.beats.lines()]
    limits = [line if line.startswith("- ") else f"{line}\n" for line in told_limits(held_against(story.report))]
    return "\n".join(
        [
            f"# {story.told.title}",
            "",
            story.told.marked(lambda words: f"*{words}*"),
            "",
            *([UNSEEN.format(this="*this*"), ""] if story.told.thoughts else []),
            "## How it was made",
            "",
            *([f"Theme: {script.theme}", ""] if script.theme else []),
            " ".join(makers(planned, story.report)),
            "",
            f"Method: {planned.script.method} · seed: {planned.request.seed}",
            "",
            f"Played by {', '.join(told_look(planned.character))}.",
            "",
            *[f"- {chosen.script.id} ({chosen.score:.2f}): {chosen.script.summary}" for chosen in script.short_scripts],
            *beats,
            "",
            "Rooms:",
            "",
            *rooms,
            "",
            "Repairs:",
            "",
            *repairs,
            "",
            "How well it moves:",
            "",
            *limits,
            "",
            "Done otherwise than the captions say:",
            "",
            *notes,
            "",
            "| # | skill | emotion | caption | furniture | reached |",
            "|---|---|---|---|---|---|",
            *rows,
            "",
        ]
    )


def told_notes(story: Story) -> list[str]:
    """What was done otherwise than the captions say, each thing once, with the moments where it was."""
    found: dict[str, list[int]] = {}
    for action, instead in zip(story.actions, _stand_ins(story), strict=True):
        if instead:
            words = (
                f"“{instead}” is done, the body knows no “{story.planned.script.keyframes[action.keyframe].caption}”"
            )
            found.setdefault(words, []).append(action.keyframe)
        elif lost := _lost(action):
            found.setdefault(lost, []).append(action.keyframe)
    for note in story.motion.notes:
        found.setdefault(note.words, []).append(note.keyframe)
    return [
        f"moment{'s' if len(where) > 1 else ''} {', '.join(str(keyframe + 1) for keyframe in where)}: {words}"
        for words, where in found.items()
    ]


def makers(planned: Planned, report: Mapping[str, Any]) -> list[str]:
    """Who planned a story, how its scripts were found, and who moved the body; in sentences."""
    script = planned.script
    planner = PLANNERS.get(script.planner, f"a language model ({script.planner})")
    encoder = [f"Scripts were found by {ENCODERS.get(script.encoder, script.encoder)}."] if script.encoder else []
    return [f"Planned by {planner}.", *encoder, *movers(report["made_by"], planned.request.backend)]


def _mark(reached: bool) -> str:
    return "yes" if reached else "**no**"


def story_to_dict(story: Story) -> dict[str, Any]:
    """Everything needed to show or repeat a story, without arrays."""
    planned = story.planned
    return {
        "theme": planned.script.theme,
        **story.told.to_dict(),
        "seed": planned.request.seed,
        "backend": planned.request.backend,
        "character": vars(planned.character),
        "script": planned.script.model_dump(mode="json"),
        ACTED: acted_to_dict(planned.stage),
        "rooms": planned.stage.rooms_to_dicts(),
        "home": home_to_dict(planned.home),
        "actions": [
            action_to_dict(action) | {"start": start, "stop": stop}
            for action, (start, stop) in zip(story.actions, story.segments, strict=True)
        ],
        "motion": {"frames": len(story.motion), "fps": story.motion.fps, "duration": round(story.motion.duration, 3)},
        "physics": story.report.get("physics"),
    }


def physics_mode(story: Story) -> str:
    """What moved the joints of a simulated body; "none" for a kinematic one."""
    physics = story.report.get("physics")
    return str(physics["mode"]) if physics else "none"


def report_to_dict(story: Story) -> dict[str, Any]:
    """How well every step went."""
    planned = story.planned
    return {
        "planner": planned.script.planner,
        "language_model": asdict(planned.spent) if planned.spent else None,
        "encoder": planned.script.encoder,
        "backend": planned.request.backend,
        "physics_mode": physics_mode(story),
        "seed": planned.request.seed,
        **story.beats.to_dict(),
        "repairs": list(planned.script.repairs),
        "rooms": planned.stage.rooms_to_dicts(),
        "moved_by": {name: about(name) for name in (planned.request.backend, *story.report["made_by"])},
        "motion": story.report,
        "limits": held_against(story.report),
        "film": Filmed.of(story).edited_to_dict(),
        "keyframes": list(_performances(story)),
    }


def _performances(story: Story) -> Iterator[dict[str, Any]]:
    """The figures of every keyframe, the parts it is made of, what stood in where its own words are not known, and
    what was done otherwise."""
    made = zip(story.figures, story.actions, story.segments, _stand_ins(story), strict=True)
    for figure, action, span, instead in made:
        row = figure.to_dict() | {"performed_as": instead}
        phases = [phase for phase in story.motion.phases if span[0] <= phase.start < span[1]]
        lost = [] if instead or not _lost(action) else [_lost(action)]
        row["notes"] = [*lost, *(note.words for note in story.motion.notes if note.keyframe == action.keyframe)]
        row["phases"] = [phase_to_dict(phase) for phase in phases]
        yield row


def _lost(action: Action) -> str:
    """Which words of a caption of one's own the body does not show, where it does the others; "" for none."""
    words = " and ".join(f"“{word}”" for word in not_seen(action.skill, action.caption))
    return f"nothing is seen of {words} in “{action.caption}”" if words else ""


def _stand_ins(story: Story) -> list[str | None]:
    """Of every action the known caption that is acted where its keyframe's own words are none of the body's."""
    own = [look_of(keyframe.caption) for keyframe in story.planned.script.keyframes]
    return [None if action.caption == own[action.keyframe] else action.caption for action in story.actions]
