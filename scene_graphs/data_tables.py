"""Tables that are data: TOML files shipped in a package's `data/`, read into frozen dataclasses and checked on the way.

A file is described by a class marked `@table`: its fields are the file's sections, lists of rows are tuples of other
such classes. Keys carry their units (`lean_deg`, `pelvis_back_share`). A row with a key too many, too few or of another
kind, or a number that is not finite, is refused by file, place and fault; what the rows owe one another a class checks
in its `__post_init__`.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Container, Iterable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import TypeVar, dataclass_transform

T = TypeVar("T")


class TableError(ValueError):
    """A shipped table is not what its reader expects."""


@dataclass_transform(frozen_default=True)
def table(cls: type[T]) -> type[T]:
    """A frozen dataclass that a table, or a row of one, is read into."""
    cls.__pydantic_config__ = {"extra": "forbid", "allow_inf_nan": False}  # type: ignore[attr-defined]
    return dataclass(frozen=True)(cls)


@cache
def read_table(package: str, path: str, schema: type[T]) -> T:
    """The file `path` below a package's `data/`, as `schema`; read once a process. TableError."""
    from pydantic import TypeAdapter, ValidationError

    text = files(package).joinpath("data", path).read_text(encoding="utf-8")
    try:
        return TypeAdapter(schema).validate_python(tomllib.loads(text))
    except (ValidationError, tomllib.TOMLDecodeError) as error:
        raise TableError(f"{package}/data/{path}: {_faults(error)}") from error


def _faults(error: ValueError) -> str:
    listed = getattr(error, "errors", None)
    if listed is None:
        return str(error)
    return "; ".join(_fault(".".join(map(str, fault["loc"])), fault["msg"]) for fault in listed(include_url=False))


def _fault(place: str, message: str) -> str:
    return ": ".join(filter(None, (place, message.removeprefix("Value error, "))))


def require_known(place: str, words: Iterable[str], known: Container[str]) -> None:
    """ValueError, with the place in the table, for words that are none of those that are known."""
    if unknown := sorted({word for word in words if word not in known}):
        raise ValueError(f"{place}: {', '.join(unknown)} is none of what is known there")


def require_unlike(place: str, words: Iterable[str]) -> None:
    """ValueError, with the place in the table, for words that stand there twice."""
    if twice := sorted(word for word, count in Counter(words).items() if count > 1):
        raise ValueError(f"{place}: {', '.join(twice)} stands there twice")
