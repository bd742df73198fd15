"""What the service answers, as a client holds it: a story, an extraction, a page of something, an event."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

Json = dict[str, Any]
"""An object of JSON; the client is for those who have nothing else of us, so it takes no word from the engine."""
T = TypeVar("T")
LAST_STATES = frozenset({"succeeded", "failed", "cancelled"})


@dataclass(frozen=True)
class Job:
    """Something that is made, as the service showed it; `data` is the whole resource, `job["notes"]` a part of it."""

    data: Json

    def __getitem__(self, name: str) -> Any:
        return self.data[name]

    @property
    def id(self) -> str:
        """Its name in all calls."""
        return str(self.data["id"])

    @property
    def state(self) -> str:
        """queued, running, succeeded, failed or cancelled."""
        return str(self.data["state"])

    @property
    def stage(self) -> str | None:
        """What is being made, or where it ended."""
        stage: str | None = self.data["stage"]
        return stage

    @property
    def progress(self) -> float:
        """Share that is done, 0 to 1."""
        return float(self.data["progress"])

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen."""
        return self.state in LAST_STATES

    @property
    def error(self) -> str:
        """Why it failed; empty if it did not."""
        told = self.data["error"]
        return f"{told['title']}: {told['detail']}" if told else ""


@dataclass(frozen=True)
class Story(Job):
    """A story or motion as the service showed it; `data` is the whole resource, `story["report"]` a part of it."""

    @property
    def title(self) -> str | None:
        """Of the told story, once it is told."""
        title: str | None = self.data["title"]
        return title

    @property
    def text(self) -> str | None:
        """The told story; None in a list, and before it is told."""
        return self.data.get("text")

    @property
    def keyframes(self) -> list[Json]:
        """What is done, moment after moment; empty in a list, and before it is planned."""
        return list(self.data.get("keyframes", ()))

    @property
    def frames(self) -> int:
        """Frames of motion that can be fetched now."""
        return round(self.duration * 30) if "motion" not in self.data else int(self.data["motion"]["frames"])

    @property
    def duration(self) -> float:
        """Seconds of motion that can be fetched now."""
        return float(self.data["duration"])

    @property
    def report(self) -> Json | None:
        """Figures, once they are made."""
        return self.data.get("report")


@dataclass(frozen=True)
class Extraction(Job):
    """Short scripts out of a film, subtitles or a text, as far as they are made."""

    @property
    def scripts(self) -> list[Json]:
        """The short scripts, as `add_short_script` takes them; empty in a list."""
        return [one["short_script"] for one in self.data.get("scripts", ())]

    @property
    def scenes(self) -> list[Json]:
        """What came of each scene that was read; empty in a list."""
        return list(self.data.get("scenes", ()))


@dataclass(frozen=True)
class Film(Job):
    """A story's film.mp4, as far as it is made."""


@dataclass(frozen=True)
class StoryEvent:
    """stage, progress, segment or scenes, and at the end done, failed or cancelled; `id` is where to go on from."""

    id: int
    name: str
    data: Json

    @property
    def last(self) -> bool:
        """Whether the story has ended with it."""
        return self.name in ("done", "failed", "cancelled")


@dataclass(frozen=True)
class Page(Generic[T]):
    """Some of many; `next` is the cursor of those that follow, None on the last page."""

    items: list[T]
    next: str | None

    def __iter__(self) -> Iterator[T]:
        return iter(self.items)

    def __len__(self) -> int:
        return len(self.items)


def page_of(read: Callable[[Json], T], row: Json) -> Page[T]:
    """A page as it was answered."""
    return Page([read(item) for item in row["items"]], row["next"])
