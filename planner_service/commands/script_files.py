"""Short scripts in files: JSON with one or a list of them, or JSON lines; and kept where a command is told to."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError
from rich.console import Console

from planner_service.commands.errors import writing_database
from planner_service.filing import write_files
from planner_service.llm.answers import problems_of
from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.library import LibraryError
from planner_service.shelves import Shelves

MAX_SCRIPT_FILE_BYTES: Final = 64_000_000
"""Bytes of a script file."""


def read_scripts(file: Path) -> list[ShortScript]:
    """Short scripts of a JSON or JSON-lines file. Raises LibraryError naming file, line and what is wrong."""
    try:
        with file.open("rb") as stream:
            data = stream.read(MAX_SCRIPT_FILE_BYTES + 1)
    except OSError as error:
        raise LibraryError(f"FILE: {file} cannot be read: {error.strerror}") from error
    if len(data) > MAX_SCRIPT_FILE_BYTES:
        raise LibraryError(f"{file.name}: larger than {MAX_SCRIPT_FILE_BYTES // 1_000_000} MB; split it")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise LibraryError(
            f"{file.name}: not UTF-8 text ({error.reason} at byte {error.start}); save it as UTF-8"
        ) from error
    rows = _rows(text, file.name)
    if not rows:
        raise LibraryError(f"{file.name}: no short script in it; one is an object with id, summary and keyframes")
    return [_script(row, f"{file.name} [{number}]") for number, row in enumerate(rows)]


def lines_of(scripts: Iterable[ShortScript]) -> str:
    """Short scripts as JSON lines; `read_scripts` reads them again."""
    return "".join(f"{script.model_dump_json(exclude_none=True)}\n" for script in scripts)


def write_scripts(scripts: Sequence[ShortScript], out: Path) -> None:
    """Write them to a file, whole or not at all. OutputError."""
    lines = lines_of(scripts)
    write_files(out.parent, {out.name: lambda path: path.write_text(lines, encoding="utf-8")})


def keep_scripts(scripts: Sequence[ShortScript], out: Path | None, shelves: Shelves | None, console: Console) -> None:
    """Write what was made to a file, put it on shelves, or both, where these are given; and say so."""
    if out is not None:
        write_scripts(scripts, out)
        console.print(f"wrote {len(scripts)} to {out}", soft_wrap=True)
    if shelves is not None:
        if scripts:
            with writing_database():
                shelves.add_scripts(*scripts)
        console.print(f"added {len(scripts)}; the library has {len(shelves.scripts())} scripts")
    if scripts and out is None and shelves is None:
        console.print("none is kept; --add keeps them in your library, --out writes them to a file")


def _script(row: Any, where: str) -> ShortScript:
    try:
        return ShortScript.model_validate(row)
    except ValidationError as error:
        raise LibraryError(f"{where}: {'; '.join(problems_of(error))}") from error


def _rows(text: str, name: str) -> list[Any]:
    try:
        whole = json.loads(text)
        return whole if isinstance(whole, list) else [whole]
    except RecursionError as error:
        raise LibraryError(f"{name}: not a script: brackets within brackets without end") from error
    except ValueError as error:
        lines = [line for line in text.split("\n") if line.strip()]
        rows = []
        for number, line in enumerate(lines, 1):
            try:
                rows.append(json.loads(line))
            except (ValueError, RecursionError) as fault:
                raise LibraryError(_not_json(name, error if _spread(lines) else fault, number)) from fault
        return rows


def _spread(lines: list[str]) -> bool:
    """Whether this is one object written over several lines, not one a line."""
    return len(lines) == 1 or not lines[0].rstrip().endswith("}")


def _not_json(name: str, error: Exception, number: int) -> str:
    if isinstance(error, json.JSONDecodeError):
        line = error.lineno if error.lineno > 1 else number
        return f"{name}:{line}: not JSON: {error.msg} at column {error.colno}"
    return f"{name}:{number}: not JSON: {error}"
