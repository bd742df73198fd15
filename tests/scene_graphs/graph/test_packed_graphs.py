"""Packed rooms are the graphs they were made of, in memory and in a file, and no damaged file comes through."""

from __future__ import annotations

import json
import zipfile
from collections import Counter
from collections.abc import Callable
from io import BytesIO
from itertools import combinations
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import pytest
from examples import tries
from graphs_at_random import CATEGORIES, build, graphs
from hypothesis import given
from hypothesis import strategies as st
from rooms_at_random import strewn

from scene_graphs.furniture import AFFORDANCES, Furniture, canonical, categories_of, class_of, group_of
from scene_graphs.graph.count_table import ANY_NUMBER, Counts
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_layout
from scene_graphs.graph.packed_graphs import LEVELS, PackedRooms, Texts, levels, vocabulary
from scene_graphs.layout import Layout, LayoutError
from scene_graphs.layout_library import built_in_index, index_from, packed_library
from scene_graphs.retrieval.layout_index import LayoutIndex, pack
from scene_graphs.retrieval.packed_graphs_file import read_packed, write_packed

WORDS = (*CATEGORIES[:8], "chair", "harp", "grand piano", "side", "storage")
"""With two words that nobody knows, and two that name a class and a group."""
ROOMS = st.lists(graphs(7, WORDS, "offers"), max_size=6)
QUICK = tries(60)


def told(rooms: PackedRooms) -> list[tuple[object, ...]]:
    """Everything that is known of packed rooms, in plain values."""
    return [
        (
            rooms.ids[number],
            sorted((node, data["offers"], data["object_id"]) for node, data in rooms.graph(number).nodes(data=True)),
            sorted(tuple(sorted(edge)) for edge in rooms.graph(number).edges),
            [kind for kind in rooms.serves if number in rooms.of_type(kind)],
            rooms.room_type(number) if len(rooms.serves) else None,
        )
        for number in range(len(rooms))
    ]


def packed(graphs_there: list[FurnitureGraph], first: int = 0) -> PackedRooms:
    for graph in graphs_there:
        nx.set_node_attributes(graph, {node: f"{node.category} Nº{node.instance}" for node in graph}, "object_id")
    ids = [f"room-{first + number:03}" for number in range(len(graphs_there))]
    kinds = [("study", "library") if number % 2 else ("bedroom",) for number in range(len(graphs_there))]
    return PackedRooms.of(graphs_there, ids, kinds)


@given(ROOMS)
@QUICK
def test_a_packed_graph_is_the_graph(rooms: list[FurnitureGraph]) -> None:
    there = packed(rooms)
    for number, graph in enumerate(rooms):
        names = {node: Furniture(canonical(node.category), node.instance) for node in graph}
        again = there.graph(number)
        assert set(again) == set(names.values())
        assert {frozenset(edge) for edge in again.edges} == {
            frozenset(edge) for edge in nx.relabel_nodes(graph, names).edges
        }
        for node, name in names.items():
            assert again.nodes[name]["offers"] == graph.nodes[node]["offers"]
            assert again.nodes[name]["object_id"] == graph.nodes[node]["object_id"]


@given(ROOMS, ROOMS, st.randoms(use_true_random=False))
@tries(25)
def test_rooms_are_taken_and_joined_as_lists_are(a: list[FurnitureGraph], b: list[FurnitureGraph], luck: Any) -> None:
    first, second, both = packed(a), packed(b, len(a)), packed([*a, *b])
    joined = PackedRooms.join([first, second])
    assert [one[:3] for one in told(joined)] == [one[:3] for one in told(both)]
    assert [one[3:] for one in told(joined)] == [one[3:] for one in (*told(first), *told(second))]
    order = luck.sample(range(len(joined)), k=len(joined) // 2)
    assert told(joined.take(np.array(order, dtype=np.int64))) == [told(joined)[number] for number in order]


@given(st.lists(st.text(st.characters(exclude_categories=["Cs"]), max_size=5)))
@QUICK
def test_packed_texts_are_the_texts(texts: list[str]) -> None:
    there = Texts.of(sorted(set(texts)))
    assert list(there) == there[:] == sorted(set(texts))
    assert [there.find(text) for text in there] == list(range(len(there)))
    assert there.find("\U0010ffff" * 6) is None
    assert there[::-2] == sorted(set(texts))[::-2]


@given(ROOMS)
@QUICK
def test_counts_are_what_counting_finds(rooms: list[FurnitureGraph]) -> None:
    counts = Counts(packed(rooms))
    for number, graph in enumerate(rooms):
        found: Counter[tuple[str, ...]] = Counter()
        for node in graph:
            word = canonical(node.category)
            found.update([("category", word), ("class", class_of(word)), ("group", group_of(word))])
            found.update(
                ("kind", key[1])
                for key in vocabulary().counts
                if key[0] == "kind" and word in {key[1], *categories_of(key[1])}
            )
        for a, b in graph.edges:
            found["edge", *sorted((group_of(a.category), group_of(b.category)))] += 1
        for key in {*vocabulary().counted, *found, ("category", "nothing"), ("edge", "bed", "nothing")}:
            assert counts.column(key)[number] == found[key]


def test_a_count_that_a_byte_does_not_hold_may_stand_for_any_number() -> None:
    room_of_chairs = build(["dining_chair"] * 254 + ["stool"], set())
    crowd = build(["dining_chair"] * 300, {(i, j) for i, j in combinations(range(30), 2)})
    counts = Counts(PackedRooms.of([room_of_chairs, crowd]))
    assert list(counts.column(("category", "dining_chair"))) == [254, ANY_NUMBER]
    assert list(counts.column(("class", "seat"))) == [ANY_NUMBER, ANY_NUMBER]
    assert list(counts.column(("edge", "sit", "sit"))) == [0, ANY_NUMBER]


def test_levels_of_numbers_are_those_of_words() -> None:
    from scene_graphs.graph.substitution_costs import level_between

    for row, word in enumerate(vocabulary().words):
        for column, category in enumerate(vocabulary().words):
            level = level_between(word, category)
            assert levels()[row, column] == (len(LEVELS) if level is None else LEVELS.index(level))


def test_a_thing_joined_with_itself_and_a_room_beyond_all_bounds_are_refused() -> None:
    with pytest.raises(ValueError, match="desk 1 is joined with itself; leave that edge out"):
        PackedRooms.of([build(["desk"], {(0, 0)})])
    with pytest.raises(ValueError, match="at most 65535 nodes, got 65536; split it"):
        PackedRooms.of([nx.empty_graph([Furniture("desk", number) for number in range(65_536)])])


@given(ROOMS)
@QUICK
def test_a_file_gives_back_what_was_written(
    tmp_path_factory: pytest.TempPathFactory, rooms: list[FurnitureGraph]
) -> None:
    first, second = (tmp_path_factory.mktemp("packed") / name for name in ("first.npz", "second.npz"))
    write_packed(first, packed(rooms), b"these")
    there = read_packed(first, b"these")
    assert told(there) == told(packed(rooms))
    write_packed(second, there, b"these")
    assert first.read_bytes() == second.read_bytes()


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("packed") / "rooms.npz"
    rooms = [
        build(["double_bed", "nightstand", "harp"], {(0, 1), (1, 2)}, offers=[frozenset(AFFORDANCES)] * 3),
        build(["desk", "office_chair"], {(0, 1)}),
    ]
    write_packed(path, packed(rooms))
    return path


def test_a_file_cut_off_or_changed_anywhere_is_refused(good: Path, tmp_path: Path) -> None:
    data, bad = good.read_bytes(), tmp_path / "bad.npz"
    wanted = told(read_packed(good))
    for place in range(0, len(data), 31):
        bad.write_bytes(data[:place])
        with pytest.raises(LayoutError, match=r"bad\.npz"):
            read_packed(bad)
        bad.write_bytes(data[:place] + bytes([data[place] ^ 0x10]) + data[place + 1 :])
        try:
            there = read_packed(bad)
        except LayoutError:
            continue
        # Not every byte of an archive means something, such as those of dates.
        assert told(there) == wanted


def rewritten(path: Path, source: Path, change: Callable[[dict[str, Any]], object]) -> Path:
    """The same file with other arrays in it."""
    with np.load(source, allow_pickle=False) as archive:
        arrays = dict(archive)
    change(arrays)
    with path.open("wb") as stream:
        np.savez_compressed(stream, **arrays)
    return path


CHANGES: dict[str, Callable[[dict[str, Any]], object]] = {
    "categories name words": lambda a: a["categories"].__setitem__(0, 99),
    "categories name words there": lambda a: a.update(
        words_letters=a["words_letters"][:0], words_starts=a["words_starts"][:1], categories=0 * a["categories"]
    ),
    "types name room types there": lambda a: a.update(
        serves_letters=a["serves_letters"][:0], serves_starts=a["serves_starts"][:1], types=0 * a["types"]
    ),
    "types name room types": lambda a: a["types"].__setitem__(0, 9),
    "edges join what is not there": lambda a: a["second"].__setitem__(0, 3),
    "edges join": lambda a: a["first"].__setitem__(1, 2),
    "an edge is there twice": lambda a: a.update(first=a["first"][[0, 0, 2]], second=a["second"][[0, 0, 2]]),
    "offers are none": lambda a: a["offers"].__setitem__(1, 8),
    "offers are not as many": lambda a: a.update(offers=a["offers"][1:]),
    "node_starts do not rise": lambda a: a["node_starts"].__setitem__(1, 9),
    "edge_starts do not rise": lambda a: a["edge_starts"].__setitem__(0, 1),
    "type_starts are not as many": lambda a: a.update(type_starts=a["type_starts"][1:]),
    "object_ids_starts do not": lambda a: a["object_ids_starts"].__setitem__(-1, 1 << 40),
    "object_ids begin inside": lambda a: a["object_ids_starts"].__setitem__(1, a["object_ids_starts"][1] - 2),
    "ids are not in order": lambda a: a["ids_letters"].__setitem__(slice(-1, None), ord("0")),
    "words have control characters": lambda a: a["words_letters"].__setitem__(0, 7),
    "serves are not UTF-8": lambda a: a["serves_letters"].__setitem__(1, 0xFF),
    "must be one row of uint8": lambda a: a.update(offers=a["offers"].astype(np.float64)),
    "must be one row of int64": lambda a: a.update(node_starts=a["node_starts"][None]),
    "its arrays are not those": lambda a: a.pop("offers"),
    "its arrays are not": lambda a: a.update(more=a["offers"]),
}


@pytest.mark.parametrize("message", CHANGES)
def test_arrays_that_do_not_fit_together_are_refused(good: Path, tmp_path: Path, message: str) -> None:
    bad = rewritten(tmp_path / "bad.npz", good, CHANGES[message])
    with pytest.raises(LayoutError, match=message):
        read_packed(bad)


def test_a_header_that_promises_more_than_there_is_takes_no_memory(good: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.npz"
    with zipfile.ZipFile(good) as archive, zipfile.ZipFile(bad, "w") as other:
        for name in archive.namelist():
            data = archive.read(name)
            if name == "offers.npy":
                stream = BytesIO()
                header = {"descr": "|u1", "fortran_order": False, "shape": (1 << 50,)}
                np.lib.format.write_array_header_1_0(stream, header)
                data = stream.getvalue() + b"\0" * 5
            other.writestr(name, data)
    with pytest.raises(LayoutError, match="offers must be one row of uint8"):
        read_packed(bad)


def test_a_bomb_is_not_unpacked(good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scene_graphs.retrieval.packed_graphs_file.MAX_BYTES", 1 << 20)
    bomb = rewritten(tmp_path / "bomb.npz", good, lambda a: a.update(offers=np.zeros(1 << 21, dtype=np.uint8)))
    assert bomb.stat().st_size < 1 << 14
    with pytest.raises(LayoutError, match="larger than 1 MiB when it is unpacked; split it"):
        read_packed(bomb)


@pytest.mark.parametrize("name", ["absent.npz", "rooms.json"])
def test_what_is_no_packed_file_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "rooms.json").write_text("[]")
    with pytest.raises(LayoutError, match=f"{name} cannot be read"):
        read_packed(tmp_path / name)


def test_graphs_of_other_rooms_are_refused(good: Path) -> None:
    with pytest.raises(LayoutError, match="packed from other rooms; pack them again"):
        read_packed(good, b"others")


@pytest.mark.sweep
def test_the_shipped_graphs_are_those_of_the_shipped_rooms() -> None:
    """If this fails: python -m scene_graphs.layout_library."""
    assert json.dumps(told(built_in_index().rooms), default=sorted) == json.dumps(
        told(packed_library()), default=sorted
    )


def test_packed_graphs_are_used_only_for_the_rooms_they_were_made_of(tmp_path: Path) -> None:
    rooms = [strewn("r0", ["desk"]), strewn("r1", ["stool"])]
    # Not the graphs of these rooms, so that one sees whose they are.
    write_packed(tmp_path / "rooms.npz", pack([build(["harp"], set())] * 2, rooms), b"these")
    assert set(index_from(tmp_path / "rooms.npz", rooms, b"these").graph("r0")) == {("harp", 1)}
    assert set(index_from(tmp_path / "rooms.npz", rooms, b"others").graph("r0")) == {("desk", 1)}
    assert set(index_from(tmp_path / "absent.npz", rooms, b"these").graph("r0")) == {("desk", 1)}


def test_an_index_of_packed_rooms_finds_the_same_and_reads_only_what_is_asked_for() -> None:
    rooms = sorted((strewn(f"r{i}", ["desk", "stool", "double_bed"][: 1 + i % 3], i) for i in range(9)), key=_id)

    class Unread(list[Layout]):
        def __getitem__(self, number: Any) -> Any:
            read.append(number)
            return super().__getitem__(number)

    read: list[int] = []
    index = LayoutIndex.of_packed(pack([graph_from_layout(one) for one in rooms], rooms), Unread(rooms))
    query = build(["desk", "stool"], {(0, 1)})
    assert index.search(query, 5) == LayoutIndex(rooms).search(query, 5)
    assert not read
    assert index.layout("r4") is rooms[4]
    with pytest.raises(ValueError, match="as many layouts as packed rooms, got 8 and 9"):
        LayoutIndex.of_packed(index.rooms, rooms[1:])


def test_what_an_index_knows_is_used_again() -> None:
    rooms = [strewn(f"r{i}", ["desk", "harp", "stool"][: 1 + i % 3], i) for i in range(8)]
    usable = {f"r{i}": {"o0": frozenset({"touch"})} for i in range(8)}
    before = LayoutIndex([*rooms[:3], strewn("r9", ["lyre"])], usable=usable)
    after = LayoutIndex(rooms, known=before, usable=usable)
    assert told(after.rooms) == told(LayoutIndex(rooms, usable=usable).rooms)
    # The same id is not the same room.
    other = strewn("r1", ["wardrobe"])
    assert LayoutIndex([other], known=after).graph("r1").nodes.keys() == {("wardrobe", 1)}


def _id(layout: Layout) -> str:
    return layout.id
