"""Why a room was found: what stands for what, what is missing and why, and what every part of the distance is for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Final, Literal

from scene_graphs.furniture import Furniture, canonical, display_name
from scene_graphs.graph.edit_distance import Match
from scene_graphs.graph.furniture_graph import FurnitureGraph, needs_of
from scene_graphs.graph.substitution_costs import CostTable, Level, level_between
from scene_graphs.retrieval.home_retrieval import ANOTHER_ROOM, HomeMatch
from scene_graphs.retrieval.layout_index import LayoutMatch

Why = Literal["absent", "unfit", "taken", "spare"]
"""Nothing of its group is there; what is there cannot be used so; all that could is used already; or something could
but nothing would be gained (a strict search, or one that met its node limit)."""
_NEARNESS: Final[dict[Level, int]] = {"same": 0, "class": 1, "group": 2}
_DONE: Final = {"sit": "sat on", "lie": "lain on", "touch": "touched"}


@dataclass(frozen=True)
class CostSplit:
    """What a distance is made of."""

    substitutions: int
    missing: int
    extra: int
    """For furniture that the query does not use."""
    lost_relations: int
    extra_relations: int
    more_rooms: int

    @property
    def total(self) -> int:
        """The distance."""
        return sum(asdict(self).values())


@dataclass(frozen=True)
class Given:
    """A room's object that a query node is mapped to."""

    asked: Furniture
    given: Furniture
    object_id: str | None
    """None for a graph that was made of no layout."""
    level: Level
    cost: int


@dataclass(frozen=True)
class Missing:
    """A query node that nothing stands in for."""

    asked: Furniture
    why: Why
    nearest: Furniture | None
    """The room's node that would have come nearest; None if there is nothing of the group."""
    unmet: tuple[str, ...]
    """What cannot be done at `nearest` though it is needed."""
    cost: int


@dataclass(frozen=True)
class Explanation:
    """A match, told."""

    distance: int
    exact: bool
    costs: CostSplit
    given: tuple[Given, ...]
    missing: tuple[Missing, ...]
    extra: tuple[str, ...]
    """Ids of objects that the query does not use; of nodes without one, their words."""
    lost: tuple[tuple[Furniture, Furniture], ...]
    """Query edges whose ends are not joined in the room, or not there."""

    @property
    def substitutions(self) -> tuple[Given, ...]:
        """The pairs where something else than asked stands in."""
        return tuple(pair for pair in self.given if pair.level != "same")

    def lines(self) -> list[str]:
        """The explanation in plain English: the distance first, then one line a piece and a lost relation."""
        counts = Counter(node.category for node in self._asked())
        several = {category for category, count in counts.items() if count > 1}
        lines = [self._sum()]
        lines += [_told_given(pair, several) for pair in self.given]
        lines += [_told_missing(gap, several) for gap in self.missing]
        lost = [" and ".join(_name(node, several) for node in pair) for pair in self.lost]
        absent = {gap.asked for gap in self.missing}
        for pair, words in zip(self.lost, lost, strict=True):
            why = "not both there" if absent.intersection(pair) else "not near each other"
            lines.append(f"{words}: {why}, {self.costs.lost_relations // len(self.lost)}")
        return lines

    def _asked(self) -> list[Furniture]:
        return [pair.asked for pair in self.given] + [gap.asked for gap in self.missing]

    def _sum(self) -> str:
        words = {
            "substitutions": "substitutions",
            "missing": "missing",
            "lost_relations": "lost relations",
            "extra": "furniture not used",
            "extra_relations": "relations not asked for",
            "more_rooms": "more rooms",
        }
        split = asdict(self.costs)
        parts = [f"{split[field]} {word}" for field, word in words.items() if split[field]]
        told = f"graph distance {self.distance}" + (f" = {' + '.join(parts)}" if parts else "")
        return told if self.exact else f"{told} (not proven least)"


def explain(
    query: FurnitureGraph,
    room: FurnitureGraph,
    match: Match | LayoutMatch | HomeMatch,
    costs: CostTable | None = None,
) -> Explanation:
    """Explain a match of a query with a room, by the cost table that it was found with.

    `room` is the graph that was searched: `LayoutIndex.graph`, or for several rooms `merge.side_by_side` of theirs.
    ValueError if the costs do not add up to the distance, because the match is of another query or room.
    """
    table = costs or CostTable()
    images = _images(room, match)
    if set(images) | set(match.missing) != set(query):
        raise ValueError("the match is of another query: its nodes are not those that were given")
    given = tuple(_given(asked, image, room, table) for asked, image in sorted(images.items()))
    missing = tuple(_missing(asked, query, room, images, table) for asked in sorted(match.missing))
    unused = sorted(node for node in room if node not in set(images.values()))
    kept = {(a, b) for a, b in query.edges if a in images and b in images and room.has_edge(images[a], images[b])}
    lost = tuple(sorted((min(edge), max(edge)) for edge in query.edges if edge not in kept))
    split = CostSplit(
        substitutions=sum(pair.cost for pair in given),
        missing=sum(gap.cost for gap in missing),
        extra=sum(table.of(node.category).insert for node in unused),
        lost_relations=table.lost_edge * len(lost),
        extra_relations=table.extra_edge * (room.number_of_edges() - len(kept)),
        more_rooms=ANOTHER_ROOM * (len(match.layout_ids) - 1) if isinstance(match, HomeMatch) else 0,
    )
    distance = match.cost if isinstance(match, Match) else match.distance
    if split.total != distance:
        raise ValueError(f"the match is of another room or cost table: it costs {distance}, not {split.total}")
    extra = tuple(room.nodes[node].get("object_id") or display_name(node.category) for node in unused)
    return Explanation(distance, match.exact, split, given, missing, extra, lost)


def _images(room: FurnitureGraph, match: Match | LayoutMatch | HomeMatch) -> dict[Furniture, Furniture]:
    """The room's node of every query node that has one. ValueError if the room has no such node."""
    if isinstance(match, Match):
        images = {pair.query: pair.room for pair in match.pairs}
    else:
        by_id = {str(name): node for node, name in room.nodes(data="object_id")}
        absent = [object_id for _, object_id, _ in match.mapping if object_id not in by_id]
        if absent:
            raise ValueError(f"the match is of another room: there is no object {absent[0]!r} in this one")
        images = {asked: by_id[object_id] for asked, object_id, _ in match.mapping}
    if any(node not in room for node in images.values()):
        raise ValueError("the match is of another room: this one has not all of its nodes")
    return images


def _given(asked: Furniture, image: Furniture, room: FurnitureGraph, costs: CostTable) -> Given:
    word, category = canonical(asked.category), canonical(image.category)
    level, cost = level_between(word, category), costs.substitution(word, category)
    if level is None or cost is None:
        raise ValueError(f"nothing is mapped across groups, but {word} is to {category}")
    return Given(asked, image, room.nodes[image].get("object_id"), level, cost)


def _missing(
    asked: Furniture,
    query: FurnitureGraph,
    room: FurnitureGraph,
    images: Mapping[Furniture, Furniture],
    costs: CostTable,
) -> Missing:
    needs, used = needs_of(query, asked), set(images.values())

    def farness(node: Furniture) -> tuple[int, int, bool, Furniture]:
        level = level_between(canonical(asked.category), canonical(node.category))
        return len(_unmet(needs, room, node)), _NEARNESS[level or "group"], node in used, node

    group = [node for node in room if level_between(canonical(asked.category), canonical(node.category))]
    fit = [node for node in group if not _unmet(needs, room, node)]
    free = [node for node in fit if node not in used]
    why: Why = "spare" if free else "taken" if fit else "unfit" if group else "absent"
    nearest = min(free or fit or group, key=farness, default=None)
    unmet = () if nearest is None else _unmet(needs, room, nearest)
    return Missing(asked, why, nearest, unmet, costs.of(canonical(asked.category)).delete)


def _unmet(needs: frozenset[str], room: FurnitureGraph, node: Furniture) -> tuple[str, ...]:
    offered: Iterable[str] = room.nodes[node].get("offers", ())
    return tuple(sorted(needs.difference(offered)))


def _name(node: Furniture, several: set[str]) -> str:
    return display_name(node.category) + (f" {node.instance}" if node.category in several else "")


def _told_given(pair: Given, several: set[str]) -> str:
    name = display_name(pair.given.category)
    if pair.object_id is not None:
        name += f" ({pair.object_id})"
    told = f"{_name(pair.asked, several)}: {name}"
    return told if pair.level == "same" else f"{told} stands in, of the same {pair.level}, {pair.cost}"


def _told_missing(gap: Missing, several: set[str]) -> str:
    there = None if gap.nearest is None else display_name(gap.nearest.category)
    reasons: dict[Why, str] = {
        "absent": "there is nothing of its kind",
        "unfit": f"the {there} there cannot be {' and '.join(_DONE.get(need, need) for need in gap.unmet)}",
        "taken": f"the {there} there is used already",
        "spare": f"though there is another {there}",
    }
    return f"{_name(gap.asked, several)}: missing, {reasons[gap.why]}, {gap.cost}"
