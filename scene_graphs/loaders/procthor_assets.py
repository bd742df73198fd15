"""What a ProcTHOR model id stands for: its type and box from an asset file, or what its name lets one guess."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final, NamedTuple

from scene_graphs.fields import LayoutError, read_point3
from scene_graphs.furniture import is_known, typical_size
from scene_graphs.layout_rows import MAX_SIZE, MIN_SIZE
from scene_graphs.loaders.naming import meaning, words_of
from scene_graphs.loaders.sizing import exact_category
from scene_graphs.loaders.source import Source
from scene_graphs.solids import Point3

MAX_ASSETS: Final = 200_000
ASSET_FILES: Final = (
    "procthor_asset_boxes.json.gz",
    "procthor_asset_boxes.json",
    "asset_boxes.json.gz",
    "asset_boxes.json",
    "asset-database.json",
)
"""Names under which an asset file is found beside the houses."""
NIGHTSTAND: Final = 0.75
"""A side table of a bedroom that is not wider is a nightstand, in metres."""
_AXES: Final = ("x", "y", "z")


class Asset(NamedTuple):
    """What the asset database says of a model."""

    type: str
    size: Point3
    """Width x, height y, depth z at rotation 0, in metres."""


def read_assets(source: Source) -> dict[str, Asset]:
    """Types and boxes by model id, from {"Bed_13": ["Bed", [x, y, z]]} or ProcTHOR's own asset-database.json.

    LayoutError if it is neither; a single entry without a usable box is left out.
    """
    table = source.json()
    if not isinstance(table, dict) or len(table) > MAX_ASSETS:
        raise LayoutError(f'{source.name} must be an object {{"Bed_13": ["Bed", [x, y, z]]}} or asset-database.json')
    assets = {}
    for name, type_, size in _entries(table):
        try:
            if isinstance(name, str) and isinstance(type_, str):
                assets[name] = Asset(type_, read_point3(size, name[:60], MIN_SIZE, MAX_SIZE))
        except LayoutError:
            continue
    if table and not assets:
        raise LayoutError(f'{source.name} has no box that can be used; an entry is "Bed_13": ["Bed", [x, y, z]]')
    return assets


def describe(asset_id: str, asset: Asset | None, room_type: str, middle: float) -> tuple[str, Point3]:
    """Our word for a model and its box, by its type and what box and room say.

    Of a model that no asset file knows, the word is the longest beginning of its id that names furniture and the box
    is estimated; `middle` is the height of its box's centre above the floor.
    """
    word = _type_by_name(asset_id) if asset is None else meaning(asset.type)
    size = _estimated_size(word, middle) if asset is None else asset.size
    return _exact_word(word, asset_id, size, room_type), size


def _exact_word(word: str, asset_id: str, size: Point3, room_type: str) -> str:
    """ProcTHOR has no office chairs and no nightstands, only some that are called so or stand in a bedroom."""
    if word == "chair" and "office" in asset_id.lower():
        return "office_chair"
    if word == "side_table" and room_type == "bedroom" and max(size[0], size[2]) <= NIGHTSTAND:
        return "nightstand"
    return exact_category(word, size)


def _estimated_size(word: str, middle: float) -> Point3:
    """What stands on the floor is twice as high as its middle; of what hangs or lies on something it is typical."""
    w, h, d = typical_size(word)
    return (w, 2 * middle if 0.5 * h <= 2 * middle <= 2 * h else h, d)


def _entries(table: dict[Any, Any]) -> Iterator[tuple[Any, Any, Any]]:
    """(model id, type, [x, y, z]) of either form of asset file, unchecked."""
    for key, value in table.items():
        if isinstance(value, list) and len(value) == 2 and isinstance(value[0], str):
            yield key, value[0], value[1]
            continue
        for entry in value if isinstance(value, list) else [value]:
            if isinstance(entry, dict) and isinstance(box := entry.get("boundingBox"), dict):
                yield entry.get("assetId", key), entry.get("objectType", key), [box.get(axis) for axis in _AXES]


def _type_by_name(asset_id: str) -> str:
    """The longest beginning of a model id that names furniture: "RoboTHOR_sofa_vreta" is a sofa."""
    words = [word for word in words_of(asset_id.removeprefix("RoboTHOR")).split("_") if word]
    for end in range(len(words), 0, -1):
        if is_known(word := meaning("_".join(words[:end]))):
            return word
    return "_".join(words)
