"""The frames of a story that are ready, from any to any, while the rest is made."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from motion_backend.motion import Motion, join
from planner_service.making import read_segments
from planner_service.store.stories import Artifact, Record, Stories


@dataclass(frozen=True)
class Footage:
    """What a story's segments hold."""

    record: Record

    @cached_property
    def segments(self) -> tuple[Artifact, ...]:
        """Those that are ready, in order."""
        return tuple(artifact for artifact in self.record.artifacts if artifact.kind == "segment")

    @property
    def ready(self) -> int:
        """Frames that can be had."""
        return int(self.segments[-1].summary["end"]) if self.segments else 0

    @property
    def complete(self) -> bool:
        """Whether no more will come of a story that goes well."""
        counts = [artifact.summary["count"] for artifact in self.record.artifacts if artifact.kind == "actions"]
        return counts == [len(self.segments)]

    def etag(self, first: int, last: int) -> str:
        """A name for exactly these frames: what was made is never changed."""
        made = "".join(segment.etag[:8] for segment in self._between(first, last))
        return f"{made[:64]}-{first}-{last}"

    def motion(self, store: Stories, first: int, last: int) -> Motion:
        """Frames first to last (exclusive), at least one, all of them ready."""
        wanted = self._between(first, last)
        whole = join(read_segments(store, self.record.id, [segment.summary["index"] for segment in wanted]))
        start = wanted[0].summary["start"]
        return whole.part(first - start, last - start)

    def _between(self, first: int, last: int) -> list[Artifact]:
        return [one for one in self.segments if one.summary["start"] < last and one.summary["end"] > first]
