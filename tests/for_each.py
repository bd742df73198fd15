"""One test over many rows of data: it fails once, with a list of all the rows for which it does not hold."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any

import pytest
from _pytest.outcomes import Failed

Check = Callable[..., Any]
SHOWN = 300
"""Letters of what is said about one row."""


def for_each(names: str | tuple[str, ...], rows: Iterable[Any]) -> Callable[[Check], Check]:
    """As `pytest.mark.parametrize`, but one test, for rows that cost little and share their fixtures.

    Stacked, it holds for every row of the one with every row of the other.
    """
    keys = tuple(name.strip() for name in names.split(",")) if isinstance(names, str) else names
    listed = [(row if len(keys) > 1 else (row,)) for row in rows]
    assert listed, f"no rows for {names}"

    def decorate(check: Check) -> Check:
        signature = inspect.signature(check)
        kept = [one for name, one in signature.parameters.items() if name not in keys]

        async def waited(**fixtures: Any) -> None:
            failed: list[str] = []
            for row in listed:
                with _noting(row, failed):
                    await check(**dict(zip(keys, row, strict=True)), **fixtures)
            _report(failed, len(listed))

        def called(**fixtures: Any) -> None:
            failed: list[str] = []
            for row in listed:
                with _noting(row, failed):
                    check(**dict(zip(keys, row, strict=True)), **fixtures)
            _report(failed, len(listed))

        whole = wraps(check)(waited if inspect.iscoroutinefunction(check) else called)
        del whole.__wrapped__
        whole.__signature__ = signature.replace(parameters=kept)  # type: ignore[attr-defined]
        return whole

    return decorate


class RowsFailed(Failed):
    """Rows for which a check does not hold."""

    def __init__(self, failed: list[str], count: int) -> None:
        super().__init__(f"{len(failed)} failed, of {count} rows:\n" + "\n".join(failed), pytrace=False)
        self.failed = failed


@contextmanager
def _noting(row: tuple[Any, ...], failed: list[str]) -> Iterator[None]:
    label = ", ".join(map(_label, row))
    try:
        yield
    except RowsFailed as inner:
        failed.extend(f"{label}, {line}" for line in inner.failed)
    except (Exception, pytest.fail.Exception) as error:
        failed.append(f"{label}: {type(error).__name__} {' '.join(str(error).split())[:SHOWN]}")


def _label(value: Any) -> str:
    if isinstance(value, Path):
        return "/".join(value.parts[-3:])
    return str(getattr(value, "id", None) or value)[:60]


def _report(failed: list[str], count: int) -> None:
    if failed:
        raise RowsFailed(failed, count)
