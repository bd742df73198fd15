"""Spoils a scene file the way hostile or broken programs do: one value anywhere in it becomes something else."""

from __future__ import annotations

import copy
from typing import Any

from hypothesis import strategies as st

JUNK: st.SearchStrategy[Any] = st.sampled_from(
    [
        *(None, True, False, 0, -1, 1, 3, 10**30, -(10**400), 2**63, 1e308, -1e-320, 0.5),
        *(float("nan"), float("inf"), float("-inf")),
        *("", " ", "x", "../..", "\0", "\ud800", "\x1b[2J", "x" * 3000, "scene0", "9/0", "door"),
        *([], {}, [[]], [{}], [None], [0], {"a": 1}, ["1", "2", "3"], [1e308] * 3, [float("nan")] * 3, [0] * 999),
    ]
)


@st.composite
def spoiled(draw: st.DrawFn, value: Any, most: int = 3) -> Any:
    """A copy of a JSON value in which up to `most` values, at any depth, are junk, gone or there twice."""
    whole = [copy.deepcopy(value)]
    for _ in range(draw(st.integers(1, most))):
        holder, key = draw(st.sampled_from(list(_places(whole))))
        change = draw(st.sampled_from(["junk", "junk", "junk", "gone", "twice"]))
        if change == "junk" or holder is whole:
            holder[key] = copy.deepcopy(draw(JUNK))
        elif change == "gone":
            del holder[key]
        elif isinstance(holder, list):
            holder.append(copy.deepcopy(holder[key]))
        else:
            holder[f"{key}2"] = copy.deepcopy(holder[key])
    return whole[0]


def _places(value: Any) -> Any:
    """Every (container, key) at any depth."""
    keys: Any = range(len(value)) if isinstance(value, list) else list(value) if isinstance(value, dict) else ()
    for key in keys:
        yield value, key
        yield from _places(value[key])
