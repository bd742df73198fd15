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


def filling_rows(number: int) -> Callable[[_F], _F]:
    """The same for one kind of arguments alone, compiled or read where it is kept as its module is imported: so many
    arrays of floats of three axes, however they lie in memory, and another that is filled."""
    given = numba.types.Array(numba.float64, 3, "A", readonly=True)
    signature = numba.void(*(given,) * number, numba.float64[:, :, ::1])

    def decorate(function: _F) -> _F:
        try:
            return cast(_F, numba.njit(signature, cache=True, nogil=True)(function))
        except RuntimeError:
            return cast(_F, numba.njit(signature, nogil=True)(function))

    return decorate


def filling(function: _F) -> _F:
    """The same for what only fills arrays that it is given: that nothing is made saves counting who holds what, which
    takes longer than the work of a pixel."""
    try:
        return cast(_F, cast(Any, numba).njit(cache=True, nogil=True, _nrt=False)(function))
    except RuntimeError:
        return cast(_F, cast(Any, numba).njit(nogil=True, _nrt=False)(function))


def inlined(function: _F) -> _F:
    """Compile into whoever calls it, which only fills arrays."""
    return cast(_F, cast(Any, numba).njit(nogil=True, _nrt=False, inline="always")(function))
