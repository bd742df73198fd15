"""The furniture words as numbers, and the rows in which a room's furniture is counted.

A number below `len(KNOWN)` is a known word; higher ones are words that only one set of rooms knows, in its own order.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graphs.catalogue import CATALOGUE, GROUP_OF_CLASS, KINDS
from scene_graphs.costs import Key, level_between
from scene_graphs.furniture import AFFORDANCES, canonical, categories_of, class_of, group_of, is_minor

Ints = NDArray[np.int64]

_NAMES: Final = {canonical(name) for name in (*GROUP_OF_CLASS, *GROUP_OF_CLASS.values())}
KNOWN: Final = tuple(sorted({*CATALOGUE, *KINDS, *_NAMES}, key=lambda word: (group_of(word), class_of(word), word)))
"""Every category and generic kind, and the names of classes and groups where somebody calls a thing so, in such an
order that classes and groups are runs of numbers."""
NUMBER: Final = {word: number for number, word in enumerate(KNOWN)}
CLASSES: Final = tuple(dict.fromkeys(class_of(word) for word in KNOWN))
GROUPS: Final = tuple(dict.fromkeys(group_of(word) for word in KNOWN))
LEVELS: Final = ("same", "class", "group")
"""How near two words are, by number; `FAR` is across groups."""
FAR: Final = len(LEVELS)


CLASS_STARTS: Final = np.array([[class_of(word) for word in KNOWN].index(name) for name in CLASSES])
"""The first word of every class."""
GROUP_STARTS: Final = np.array([[group_of(word) for word in KNOWN].index(name) for name in GROUPS])
"""The first word of every group."""
GROUP_OF: Final = np.array([GROUPS.index(group_of(word)) for word in KNOWN], dtype=np.int64)
MINOR: Final = np.array([is_minor(word) for word in KNOWN])
EVERYTHING: Final = (1 << len(AFFORDANCES)) - 1
"""All affordances, as bits."""
COUNTS: Final[dict[Key, Ints]] = {
    **{("category", word): np.array([number]) for word, number in NUMBER.items()},
    **{("class", name): np.array([n for n, w in enumerate(KNOWN) if class_of(w) == name]) for name in CLASSES},
    **{("group", name): np.array([n for n, w in enumerate(KNOWN) if group_of(w) == name]) for name in GROUPS},
    **{("kind", kind): np.array(sorted(NUMBER[w] for w in {*categories_of(kind), kind})) for kind in sorted(KINDS)},
}
"""The words that count as each category, class, group and generic kind; a kind names its categories and itself."""
PAIRS: Final = tuple((a, b) for index, a in enumerate(GROUPS) for b in GROUPS[index:])
"""Unordered pairs of groups, in alphabetical order."""

COUNTED: Final[dict[Key, int]] = {key: row for row, key in enumerate([*COUNTS, *(("edge", *pair) for pair in PAIRS)])}
"""The row of everything known that is counted."""


@cache
def levels() -> NDArray[np.uint8]:
    """How near a room's known word is to a query's: a place in `LEVELS`, or `FAR`. (query's word, room's word)."""
    table = np.full((len(KNOWN), len(KNOWN)), FAR, dtype=np.uint8)
    for row, word in enumerate(KNOWN):
        for column, category in enumerate(KNOWN):
            if (level := level_between(word, category)) is not None:
                table[row, column] = LEVELS.index(level)
    return table


def flags(affordances: frozenset[str]) -> int:
    """Affordances as bits; one that is none of `AFFORDANCES` has a bit that nothing offers."""
    known = sum(1 << bit for bit, name in enumerate(AFFORDANCES) if name in affordances)
    return known if affordances <= frozenset(AFFORDANCES) else known | 1 << len(AFFORDANCES)


def affordances_of(bits: int) -> frozenset[str]:
    """The affordances whose bits are set."""
    return frozenset(name for bit, name in enumerate(AFFORDANCES) if bits >> bit & 1)
