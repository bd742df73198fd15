"""Short scripts of a file: JSON with one or a list of them, or JSON lines."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from planner_service.llm.answers import problems_of
from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.library import LibraryError

LARGEST: Final = 64_000_000
"""Bytes of a script file."""


def read_scripts(file: Path) -> list[ShortScript]:
    """Short scripts of a JSON or JSON-lines file. Raises LibraryError naming file, line and what is wrong."""
    try:
        with file.open("rb") as stream:
            data = stream.read(LARGEST + 1)
    except OSError as error:
        raise LibraryError(f"FILE: {file} cannot be read: {error.strerror}") from error
    if len(data) > LARGEST:
        raise LibraryError(f"{file.name}: larger than {LARGEST // 1_000_000} MB; split it")
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
