"""Functions that are compiled for this machine when they are first called. Imported late: numba takes half a second."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

_F = TypeVar("_F", bound=Callable[..., Any])


def compiled(function: _F) -> _F:
    """Compile at the first call, and keep what was compiled beside the module or in the user's cache, if one can be
    written. The interpreter's lock is released while it runs."""
    try:
        return cast(_F, numba.njit(cache=True, nogil=True)(function))
    except RuntimeError:  # There is no folder to keep it in.
        return cast(_F, numba.njit(nogil=True)(function))


def compiled_ufunc(signature: str) -> Callable[[Callable[..., None]], Callable[..., Any]]:
    """A function of one item as a ufunc over arrays of doubles, with numpy's rules for what does not fit in shape.

    The last of its arguments is what it fills; `signature` as of `numba.guvectorize`, "(n),(n)->(n)".
    """
    types = ", ".join("float64[:]" for _ in range(signature.count("(")))

    def of(function: Callable[..., None]) -> Callable[..., Any]:
        make = cast(Any, numba).guvectorize
        try:
            return cast(Callable[..., Any], make([f"void({types})"], signature, cache=True)(function))
        except RuntimeError:  # There is no folder to keep it in.
            return cast(Callable[..., Any], make([f"void({types})"], signature)(function))

    return of
