"""One test over many rows of data: it fails once, with a list of all the rows for which it does not hold."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any

import pytest

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

        if inspect.iscoroutinefunction(check):

            @wraps(check)
            async def whole(**fixtures: Any) -> None:
                failed = []
                for row in listed:
                    try:
                        await check(**dict(zip(keys, row, strict=True)), **fixtures)
                    except (Exception, pytest.fail.Exception) as error:
                        failed.append(_said(row, error))
                _report(failed, len(listed))
        else:

            @wraps(check)
            def whole(**fixtures: Any) -> None:
                failed = []
                for row in listed:
                    try:
                        check(**dict(zip(keys, row, strict=True)), **fixtures)
                    except (Exception, pytest.fail.Exception) as error:
                        failed.append(_said(row, error))
                _report(failed, len(listed))

        del whole.__wrapped__  # type: ignore[attr-defined]
        whole.__signature__ = signature.replace(parameters=kept)  # type: ignore[attr-defined]
        return whole

    return decorate


def _said(row: tuple[Any, ...], error: BaseException) -> str:
    label = ", ".join(_label(value) for value in row)
    return f"{label}: {type(error).__name__} {' '.join(str(error).split())[:SHOWN]}"


def _label(value: Any) -> str:
    return str(getattr(value, "id", None) or value)[:60]


def _report(failed: list[str], count: int) -> None:
    if failed:
        pytest.fail(f"{len(failed)} of {count}:\n" + "\n".join(failed), pytrace=False)
