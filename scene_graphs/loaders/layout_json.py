"""Our own JSON (docs/architecture.md), where one bad room does not spoil the others."""

from __future__ import annotations

from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout, layout_from_dict
from scene_graphs.loaders.room_builder import Intake
from scene_graphs.loaders.scene_source import Source


def read_native(source: Source, intake: Intake) -> list[Layout]:
    """Rooms of a JSON row, a list of rows, or lines of them; a row that is not valid is dropped with its reason."""
    layouts: dict[str, Layout] = {}
    for where, row in source.rows():
        intake.count_rooms(1, source.name)
        try:
            if not isinstance(row, dict):
                raise LayoutError("must be an object with id, room_type, floor_polygon and objects", at=where)
            layout = layout_from_dict(row, where)
        except LayoutError as error:
            intake.drop("a row that is not a room", str(error))
            continue
        if layout.id in layouts:
            intake.drop("a room whose id occurs before", layout.id)
            continue
        layouts[layout.id] = layout
        intake.report.rooms += 1
        intake.report.kept.update(placed.category for placed in layout.objects)
    return list(layouts.values())
