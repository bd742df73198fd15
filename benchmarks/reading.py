"""Reading other people's houses."""

from __future__ import annotations

import json
from functools import partial

from benchmarks.figure import Figure
from benchmarks.houses import synthetic_house
from benchmarks.stories import timed
from scene_graphs.loaders import Imported, Source, read_scene

HOUSES = 5


def reading_figures() -> list[Figure]:
    """Invented 3D-FRONT houses of the usual size, from their bytes; the slowest counts."""
    files = [json.dumps(synthetic_house(seed)).encode() for seed in range(HOUSES)]
    _read(files[0])
    runs = [timed(partial(_read, body)) for body in files]
    slowest = 1000 * max(seconds for _, seconds in runs)
    rooms, objects = runs[0][0].report.rooms, runs[0][0].report.kept.total()
    size = f"an invented one, {len(files[0]) / 2**20:.1f} MB: {rooms} rooms, {objects} objects; slowest of {HOUSES}"
    return [Figure("reading a 3D-FRONT house", slowest, "ms", 150, note=size, digits=0)]


def _read(body: bytes) -> Imported:
    return read_scene(Source.of_bytes("house.json", body), "3d-front")
