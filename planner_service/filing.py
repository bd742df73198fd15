"""A story on disk: every file of it, written aside and moved into place whole, so that nothing half-made is left."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from motion_backend.formats.bvh import write_bvh
from motion_backend.formats.glb import film_glb
from motion_backend.formats.npz import write_npz
from planner_service.scripts.acting import action_to_dict
from planner_service.stories import Story
from planner_service.storyboard import storyboard
from scene_graphs.homes import home_to_dict


class OutputError(OSError):
    """The folder for a story's files cannot be written."""


def write_story(story: Story, folder: Path) -> list[Path]:
    """All files of a story in `folder`: story.md, story.json, report.json, motion.npz, motion.bvh, film.glb,
    storyboard.png. A file of that name from an earlier story is replaced; OutputError leaves everything as it was.
    """
    writers: dict[str, Callable[[Path], object]] = {
        "story.md": lambda path: path.write_text(story_to_markdown(story), encoding="utf-8"),
        "story.json": lambda path: _write_json(path, story_to_dict(story)),
        "report.json": lambda path: _write_json(path, report_to_dict(story)),
        "motion.npz": lambda path: write_npz(story.motion, path),
        "motion.bvh": lambda path: write_bvh(story.motion, path),
        "film.glb": lambda path: path.write_bytes(film_glb(story.planned.home, story.motion)),
        "storyboard.png": lambda path: _write_storyboard(story, path),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=".writing-", dir=folder))
    except OSError as error:
        raise OutputError(f"--out: {folder} cannot be written: {error.strerror or error}") from error
    try:
        for name, write in writers.items():
            write(aside / name)
        for name in writers:
            (aside / name).replace(folder / name)
    except OSError as error:
        raise OutputError(f"--out: {folder} cannot be written: {error.strerror or error}") from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    return [folder / name for name in writers]


def _write_storyboard(story: Story, path: Path) -> Path:
    planned, targets = story.planned, [action.object_id for action in story.actions]
    return storyboard(planned.home, story.motion, planned.script.keyframes, path, planned.told.title, targets)


def check_writable(folder: Path) -> None:
    """Fail before the work, not after it. Raises OutputError."""
    nearest = folder
    while not nearest.exists():
        nearest = nearest.parent
    try:
        if not nearest.is_dir():
            raise NotADirectoryError(20, "is not a folder")
        with tempfile.TemporaryDirectory(prefix=".writing-", dir=nearest):
            pass
    except OSError as error:
        raise OutputError(f"--out: {folder} cannot be written: {error.strerror or error} ({nearest})") from error


def _write_json(path: Path, value: dict[str, Any]) -> None:
    path.write_text(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")


def story_to_markdown(story: Story) -> str:
    """The told story with what it was made of."""
    planned, script = story.planned, story.planned.script
    rows = [
        f"| {index} | {keyframe.skill.value} | {keyframe.emotion} | {keyframe.caption} | "
        f"{action.furniture}{f' ({action.object_id})' if action.object_id else ''} | {_mark(figure.reached)} |"
        for index, (keyframe, action, figure) in enumerate(
            zip(script.keyframes, story.actions, story.figures, strict=True)
        )
    ]
    rooms = [f"- {line}" for line in planned.stage.explain()]
    repairs = [f"- {line}" for line in script.repairs] or ["- none"]
    missed = [f"- not covered: {event}" for event in script.uncovered]
    return "\n".join(
        [
            f"# {planned.told.title}",
            "",
            planned.told.text,
            "",
            "## How it was made",
            "",
            f"Theme: {script.theme}",
            "",
            f"Planner: {script.planner} · method: {script.method} · encoder: {script.encoder} · "
            f"motion: {planned.request.backend} · seed: {planned.request.seed}",
            "",
            *[f"- {chosen.script.id} ({chosen.score:.2f}): {chosen.script.summary}" for chosen in script.short_scripts],
            *missed,
            "",
            "Rooms:",
            "",
            *rooms,
            "",
            "Repairs:",
            "",
            *repairs,
            "",
            "| # | skill | emotion | caption | furniture | reached |",
            "|---|---|---|---|---|---|",
            *rows,
            "",
        ]
    )


def _mark(reached: bool) -> str:
    return "yes" if reached else "**no**"


def story_to_dict(story: Story) -> dict[str, Any]:
    """Everything needed to show or repeat a story, without arrays."""
    planned = story.planned
    return {
        "theme": planned.script.theme,
        "title": planned.told.title,
        "text": planned.told.text,
        "spans": [{"start": s.start, "end": s.end, "keyframes": list(s.keyframes)} for s in planned.told.spans],
        "seed": planned.request.seed,
        "backend": planned.request.backend,
        "character": vars(planned.request.character),
        "script": planned.script.model_dump(mode="json"),
        "rooms": planned.stage.rooms_to_dicts(),
        "home": home_to_dict(planned.home),
        "actions": [
            action_to_dict(action) | {"start": start, "stop": stop}
            for action, (start, stop) in zip(story.actions, story.segments, strict=True)
        ],
        "motion": {"frames": len(story.motion), "fps": story.motion.fps, "duration": round(story.motion.duration, 3)},
    }


def report_to_dict(story: Story) -> dict[str, Any]:
    """How well every step went."""
    planned = story.planned
    return {
        "planner": planned.script.planner,
        "encoder": planned.script.encoder,
        "backend": planned.request.backend,
        "physics_mode": "none",
        "seed": planned.request.seed,
        "events": [event.model_dump() for event in planned.script.events],
        "uncovered": list(planned.script.uncovered),
        "repairs": list(planned.script.repairs),
        "rooms": planned.stage.rooms_to_dicts(),
        "motion": story.report,
        "keyframes": [figure.to_dict() for figure in story.figures],
    }
