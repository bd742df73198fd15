"""Packed rooms in a file: an .npz of plain arrays. What is read back is checked, since compiled code checks nothing."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Mapping
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scene_graphs.furniture import canonical
from scene_graphs.graph.packed_graphs import (
    EVERYTHING,
    MAX_OBJECTS_IN_ROOM,
    Ints,
    PackedRooms,
    Texts,
    numbered,
    offsets,
    renumbered,
    vocabulary,
)
from scene_graphs.json_fields import LayoutError

MAX_BYTES: Final = 1 << 30
"""Of a file when it is unpacked: two million rooms."""
_TEXTS: Final = ("ids", "words", "object_ids", "serves")
_KINDS: Final[dict[str, type[np.generic]]] = {
    "source": np.uint8,
    **{f"{name}_letters": np.uint8 for name in _TEXTS},
    **{f"{name}_starts": np.int64 for name in _TEXTS},
    "categories": np.uint32,
    "offers": np.uint8,
    "node_starts": np.int64,
    "edge_starts": np.int64,
    "first": np.uint16,
    "second": np.uint16,
    "types": np.uint32,
    "type_starts": np.int64,
}
"""The arrays of a file, all of one axis. Edges are a run a room: places in the room, the lower first, rising."""

Arrays = Mapping[str, NDArray[Any]]


def write_packed(path: str | Path, rooms: PackedRooms, source: bytes = b"") -> None:
    """Write packed rooms; the same rooms give the same bytes. `source` says what they were made of."""
    words = [*vocabulary().words, *rooms.words]
    used = np.unique(rooms.categories)
    names = {"ids": rooms.ids, "object_ids": rooms.object_ids, "serves": Texts.of(rooms.serves)}
    names["words"] = Texts.of(words[number] for number in used)
    sizes = np.diff(rooms.node_starts)
    room_of = np.repeat(np.arange(len(rooms)), sizes)
    node = np.repeat(np.arange(len(room_of)), np.diff(rooms.neighbour_starts))
    first = node - rooms.node_starts[room_of[node]]
    rising = first < rooms.neighbours
    arrays: Arrays = {
        "source": np.frombuffer(source, dtype=np.uint8),
        **{f"{name}_letters": texts.letters for name, texts in names.items()},
        **{f"{name}_starts": texts.starts for name, texts in names.items()},
        "categories": np.searchsorted(used, rooms.categories),
        "offers": rooms.offers,
        "node_starts": rooms.node_starts,
        "edge_starts": offsets(np.bincount(room_of[node[rising]], minlength=len(rooms))),
        "first": first[rising],
        "second": rooms.neighbours[rising],
        "types": rooms.types,
        "type_starts": rooms.type_starts,
    }
    with Path(path).open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **{name: arrays[name].astype(_KINDS[name]) for name in _KINDS})


def read_packed(path: str | Path, source: bytes | None = None) -> PackedRooms:
    """Read packed rooms. LayoutError where the file is missing, cut off, damaged, too large or no such file, or where
    it was made of something else than `source`, if that is given."""
    file = Path(path)
    arrays = _read_arrays(file)
    if source is not None and arrays["source"].tobytes() != source:
        raise LayoutError(f"{file.name} was packed from other rooms", "pack them again")
    try:
        return _checked(arrays)
    except _DamageError as damage:
        raise LayoutError(f"{file.name} is damaged: {damage}", "pack the rooms again") from None


class _DamageError(ValueError):
    """What is wrong with the arrays."""


def _read_arrays(file: Path) -> Arrays:
    try:
        with zipfile.ZipFile(file) as archive:
            sizes = {info.filename: info.file_size for info in archive.infolist()}
            if set(sizes) != {f"{name}.npy" for name in _KINDS}:
                raise LayoutError(f"{file.name} holds no packed rooms: its arrays are not those of one")
            if sum(sizes.values()) > MAX_BYTES:
                raise LayoutError(f"{file.name} is larger than {MAX_BYTES >> 20} MiB when it is unpacked", "split it")
            return {name: _array(archive.read(f"{name}.npy"), name, kind) for name, kind in _KINDS.items()}
    except (OSError, zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise LayoutError(f"{file.name} cannot be read, it is missing, cut off or damaged: {error}") from error
    except _DamageError as damage:
        raise LayoutError(f"{file.name} is damaged: {damage}", "pack the rooms again") from None


def _array(data: bytes, name: str, kind: type[np.generic]) -> NDArray[Any]:
    """An array of one axis and of the right kind; its header is not believed in anything else."""
    stream = BytesIO(data)
    try:
        if np.lib.format.read_magic(stream) != (1, 0):
            raise ValueError("its version is unknown")
        shape, _, dtype = np.lib.format.read_array_header_1_0(stream)
    except ValueError as error:
        raise _DamageError(f"{name} has no readable header ({error})") from error
    rest = data[stream.tell() :]
    if dtype != np.dtype(kind) or len(shape) != 1 or len(rest) != shape[0] * dtype.itemsize:
        raise _DamageError(f"{name} must be one row of {np.dtype(kind).name}, got {shape} of {dtype}")
    return np.frombuffer(rest, dtype=kind).copy()


def _names(numbers: Ints, texts: Texts) -> bool:
    """Whether there is a text for every number."""
    return not len(numbers) or int(numbers.max()) < len(texts)


def _checked(arrays: Arrays) -> PackedRooms:
    texts = {name: _texts(arrays, name) for name in _TEXTS}
    ids = texts["ids"][:]
    _demand(all(first < second for first, second in pairwise(ids)), "ids are not in order, or one occurs twice")
    _check_starts(arrays, "node_starts", len(ids), len(arrays["categories"]))
    _check_starts(arrays, "edge_starts", len(ids), len(arrays["first"]))
    _check_starts(arrays, "type_starts", len(ids), len(arrays["types"]))
    node_starts: Ints = arrays["node_starts"]
    sizes = np.diff(node_starts)
    _demand(sizes.max(initial=0) <= MAX_OBJECTS_IN_ROOM, "node_starts make a room too large")
    for name in ("offers", "object_ids"):
        _demand(len(arrays.get(name, texts.get(name, ()))) == sizes.sum(), f"{name} are not as many as nodes")
    _demand(_names(arrays["categories"], texts["words"]), "categories name words there are not")
    _demand(_names(arrays["types"], texts["serves"]), "types name room types there are not")
    _demand(bool((arrays["offers"] <= EVERYTHING).all()), "offers are none of the affordances")
    names = [canonical(word) for word in texts["words"]]
    words, numbers = numbered(names)
    neighbours, neighbour_starts = _neighbours(arrays, sizes)
    serves = tuple(sorted(set(texts["serves"])))
    return PackedRooms(
        ids=texts["ids"],
        words=words,
        categories=np.array([numbers[name] for name in names], dtype=np.uint32)[arrays["categories"]],
        offers=arrays["offers"],
        object_ids=texts["object_ids"],
        node_starts=node_starts,
        neighbours=neighbours,
        neighbour_starts=neighbour_starts,
        serves=serves,
        types=renumbered(arrays["types"], texts["serves"], serves),
        type_starts=arrays["type_starts"],
    )


def _neighbours(arrays: Arrays, sizes: Ints) -> tuple[NDArray[np.uint16], Ints]:
    """The neighbours of every node, from edges of which each is there once."""
    rooms = np.repeat(np.arange(len(sizes)), np.diff(arrays["edge_starts"]))
    first, second = arrays["first"].astype(np.int64), arrays["second"].astype(np.int64)
    _demand(bool((first < second).all() and (second < sizes[rooms]).all()), "edges join what is not there")
    begins = arrays["node_starts"][rooms]
    own = np.concatenate([begins + first, begins + second])
    keys = np.sort(own << 16 | np.concatenate([second, first]))
    _demand(bool((np.diff(keys) > 0).all()), "an edge is there twice")
    degrees = np.bincount(own, minlength=int(sizes.sum()))
    return (keys & 0xFFFF).astype(np.uint16), offsets(degrees)


def _texts(arrays: Arrays, name: str) -> Texts:
    letters, starts = arrays[f"{name}_letters"], arrays[f"{name}_starts"]
    _check_starts(arrays, f"{name}_starts", len(starts) - 1, len(letters))
    begins = letters[starts[starts < len(letters)]]
    _demand(bool((begins & 0xC0 != 0x80).all()), f"{name} begin inside a letter")
    _demand(bool(((letters >= 0x20) & (letters != 0x7F)).all()), f"{name} have control characters")
    try:
        letters.tobytes().decode()
    except UnicodeDecodeError as error:
        raise _DamageError(f"{name} are not UTF-8 text") from error
    return Texts(letters, starts)


def _check_starts(arrays: Arrays, name: str, runs: int, total: int) -> None:
    starts = arrays[name]
    _demand(len(starts) == runs + 1 and len(starts) > 0, f"{name} are not as many as what they begin")
    _demand(starts[0] == 0 and starts[-1] == total and bool((np.diff(starts) >= 0).all()), f"{name} do not rise")


def _demand(holds: bool, otherwise: str) -> None:
    if not holds:
        raise _DamageError(otherwise)
