"""What people do at home, and how a body shows it: data/deeds.toml."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache, cached_property

from motion_backend.motion import Skill
from planner_service.composition.deed_patterns import Pattern, pattern_of
from planner_service.scripts.captions import captions
from planner_service.scripts.script import EMOTIONS
from scene_graphs import furniture
from scene_graphs.data_tables import read_table, require_known, table


@table
class DeedRow:
    """One thing that people do, and how a body shows it."""

    says: tuple[str, ...]
    skill: Skill
    at: tuple[str, ...] = ()
    captions: tuple[str, ...] = ()
    lying: tuple[str, ...] = ()
    seated: tuple[str, ...] = ()
    rests: bool = False
    things: bool = False
    there: bool = False
    """Whether hands do it at its furniture and nowhere else, unless that is named."""
    mood: str = ""
    standing: bool = False
    """Whether who is on their feet already does it standing."""
    stands: bool = False
    """Whether its captions only stand for it."""
    within: tuple[str, ...] = ()
    """Parts of captions that are seen already: who does that does this where they are, "hangs up", "listens"."""
    why: str = ""
    """Why a body at home does not do it."""
    unless: tuple[str, ...] = ()
    """Of a gesture: where the words mean something else."""
    small: bool = False
    """Whether nobody gets up for it, of a gesture; else whether nobody who lies does."""
    walks: bool = False
    """Of a gesture: whether it is a way of walking, and not done on the spot."""
    alone: bool = False
    """Of a gesture: whether it is only done where nothing else is done meanwhile: not "sweeps, singing"."""
    holds: str = ""
    """The tool in the hand for it, where the clause names none."""
    then: str = ""
    """The caption of what is done on the spot as soon as hands have done it: "puts on music" and nods."""


@table
class DeedTable:
    """data/deeds.toml."""

    not_furniture: str
    rooms: dict[str, tuple[str, ...]]
    usual: dict[str, dict[str, tuple[str, ...]]]
    typical: dict[str, str]
    stands_on: dict[str, str]
    seats_at: dict[str, tuple[str, ...]]
    deed: tuple[DeedRow, ...]
    gesture: tuple[DeedRow, ...]
    """What is seen in limbs, trunk or head, whatever else a clause tells."""

    def __post_init__(self) -> None:
        known = captions()
        for row in (*self.deed, *self.gesture):
            for skill, some in ((row.skill, row.captions), (Skill.LIEDOWN, row.lying), (Skill.SITDOWN, row.seated)):
                require_known(f"deed {row.says[0]!r}", some, known.get(skill.value, ()))
            require_known(f"deed {row.says[0]!r}: then", (row.then,) if row.then else (), known[Skill.LOCO.value])
            if row.mood:
                require_known(f"deed {row.says[0]!r}: mood", (row.mood,), [mood.value for mood in EMOTIONS])
            for word in row.at:
                if word != "floor" and not furniture.is_known(word):
                    raise ValueError(f"deed {row.says[0]!r}: {word!r} is no furniture we know")

    @cached_property
    def ways(self) -> Mapping[str, Sequence[tuple[Pattern, DeedRow]]]:
        """Every way to say a deed by each word that may begin it, "" for a gap, in the order of the rows."""
        return _by_first_word(self.deed)

    @cached_property
    def gestures(self) -> Mapping[str, Sequence[tuple[Pattern, DeedRow]]]:
        """The same of gestures."""
        return _by_first_word(self.gesture)


def _by_first_word(rows: Iterable[DeedRow]) -> Mapping[str, Sequence[tuple[Pattern, DeedRow]]]:
    found: dict[str, list[tuple[Pattern, DeedRow]]] = {}
    for row in rows:
        for pattern in map(pattern_of, row.says):
            for first in pattern[0] or ("",):
                found.setdefault(first, []).append((pattern, row))
    return found


@cache
def deed_table() -> DeedTable:
    """The deeds we know."""
    known: DeedTable = read_table("planner_service", "deeds.toml", DeedTable)
    return known


@cache
def captions_of_gestures() -> frozenset[tuple[Skill, str]]:
    """The captions that gestures have and no other deed: labels of beats that were learned from do not know them."""
    table = deed_table()
    return _captions(table.gesture) - _captions(table.deed)


def _captions(rows: Iterable[DeedRow]) -> frozenset[tuple[Skill, str]]:
    own = ((row.skill, row.captions) for row in rows)
    rest = ((skill, some) for row in rows for skill, some in ((Skill.LIEDOWN, row.lying), (Skill.SITDOWN, row.seated)))
    return frozenset((skill, one) for skill, some in (*own, *rest) for one in some)
