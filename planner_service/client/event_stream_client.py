"""Following a story over broken connections: server-sent events from bytes, and where to go on. Nothing waits here."""

from __future__ import annotations

import codecs
import json
import math
import time
from dataclasses import dataclass, field
from typing import Any, Final, Literal, TypeVar
from urllib.parse import quote

import httpx

from planner_service.client.errors import StoryCancelled, StoryFailed, WaitTimeout, error_of, not_ours, unreachable
from planner_service.client.responses import Film, Job, StoryEvent

J = TypeVar("J", bound=Job)
SILENCE: Final = 45.0
"""Seconds without a byte after which a connection counts as broken; the service sends something every 15."""
LOOK, MIN_LOOK = 5.0, 0.1
"""Seconds of silence after which one who waits for a limited time looks at the clock."""
BREAKS: Final = 30
"""Tries in a row to connect that may fail."""
LATER: Final = (429, 502, 503, 504)
"""Answers of a service that is busy or on its way up."""
KINDS: Final = {"stories": "story", "extractions": "extraction"}
PAUSE, MAX_PAUSE_SECONDS = 0.5, 2.0
"""Seconds before one connects again, doubled with every break; in all a minute, for a service that starts again."""


@dataclass(frozen=True)
class Message:
    """One server-sent event, as it came."""

    event: str
    data: str
    id: str


class EventParser:
    """text/event-stream to messages, in pieces cut anywhere (WHATWG HTML, 9.2.6)."""

    def __init__(self) -> None:
        self._decoder = codecs.getincrementaldecoder("utf-8-sig")("replace")
        self._line = ""
        self._after_return = False
        self._event = ""
        self._data: list[str] = []
        self._id = ""

    def feed(self, piece: bytes) -> list[Message]:
        """The messages that end in this piece."""
        return [message for line in self._lines(piece) if (message := self._take(line)) is not None]

    def _lines(self, piece: bytes) -> list[str]:
        text = self._decoder.decode(piece)
        if not text:
            return []
        if self._after_return:
            # The other half of a \r\n whose first half ended a line already.
            text = text.removeprefix("\n")
            self._after_return = False
        self._after_return = self._after_return or text.endswith("\r")
        *lines, self._line = (self._line + text).replace("\r\n", "\n").replace("\r", "\n").split("\n")
        return lines

    def _take(self, line: str) -> Message | None:
        if not line:
            message = Message(self._event or "message", "\n".join(self._data), self._id) if self._data else None
            self._event, self._data = "", []
            return message
        name, _, value = line.partition(":")
        value = value.removeprefix(" ")
        if name == "data":
            self._data.append(value)
        elif name == "event":
            self._event = value
        elif name == "id" and "\0" not in value:
            self._id = value
        return None


@dataclass
class Following:
    """One who follows a story or extraction: the last event they have, and what to do when a connection ends."""

    story_id: str
    last: int = 0
    timeout: float | None = None
    """Seconds they have."""
    kind: Literal["stories", "extractions"] = "stories"
    ended: bool = False
    pause: float = 0.0
    """Seconds to wait before connecting again."""
    _breaks: int = 0
    _heard: bool = False
    _parser: EventParser = field(default_factory=EventParser)
    _started: float = field(default_factory=time.monotonic)

    def request(self, connecting: float) -> dict[str, Any]:
        """What httpx is to send, to go on from the last event; `connecting` is the time to wait for a connection."""
        silence = SILENCE if self.timeout is None else max(MIN_LOOK, min(LOOK, self._left()))
        return {
            "method": "GET",
            "url": f"/v1/{self.kind}/{quote(self.story_id, safe='')}/events",
            "headers": {"Last-Event-ID": str(self.last)} if self.last else {},
            "timeout": httpx.Timeout(connecting, read=silence),
        }

    def _left(self) -> float:
        return math.inf if self.timeout is None else self._started + self.timeout - time.monotonic()

    def _look(self) -> None:
        """At the clock. WaitTimeout."""
        if self._left() <= 0:
            raise WaitTimeout(f"{KINDS[self.kind]} {self.story_id} did not end within {self.timeout:g} s")

    def opened(self, response: httpx.Response) -> bool:
        """Whether events will come. ApiError when they never will."""
        self._heard = True
        self._parser = EventParser()
        self.pause = 0.0
        if response.is_error and (response.status_code not in LATER or self._give_up()):
            raise error_of(response)
        self.ended = response.status_code == 204
        if self.ended or response.is_error:
            return False
        if not response.headers.get("content-type", "").startswith("text/event-stream"):
            raise not_ours(response)
        self._breaks = 0
        return True

    def feed(self, piece: bytes) -> list[StoryEvent]:
        """The events that end in this piece. WaitTimeout."""
        found = [StoryEvent(int(one.id), one.event, json.loads(one.data)) for one in self._parser.feed(piece)]
        if found:
            self.last = found[-1].id
            self.ended = found[-1].last
        if not self.ended:
            self._look()
        return found

    def closed(self) -> None:
        """The stream ended: for good, or the service stops and will be back."""
        if not self.ended:
            self._give_up()

    def broke(self, error: httpx.TransportError, base_url: str) -> None:
        """The connection broke off. Unreachable when nobody was ever there, or nobody comes back."""
        if isinstance(error, httpx.ReadTimeout) and self.timeout is not None:
            self.pause = 0.0
            self._look()
            return
        if (isinstance(error, httpx.ConnectError) and not self._heard) or self._give_up():
            raise unreachable(base_url, error) from error

    def _give_up(self) -> bool:
        """Count a break; whether there were too many of them."""
        self._look()
        self.pause = min(PAUSE * 2**self._breaks, MAX_PAUSE_SECONDS, self._left())
        self._breaks += 1
        return self._breaks > BREAKS


@dataclass
class Looking:
    """One who waits for a film, of which there are no events, by looking again."""

    film: Film
    """As it was last."""
    timeout: float | None = None
    """Seconds they have."""
    pause: float = PAUSE
    _started: float = field(default_factory=time.monotonic)

    def goes_on(self) -> bool:
        """Whether it is still being made. StoryFailed, StoryCancelled, WaitTimeout."""
        if self.film.state == "absent":
            raise StoryCancelled(self.film)
        if self.film.ended:
            finished(self.film)
            return False
        if self.timeout is not None and time.monotonic() - self._started > self.timeout:
            raise WaitTimeout(f"the film was not made within {self.timeout:g} s")
        return True


def finished(story: J) -> J:
    """A story or extraction that has ended well. StoryFailed, StoryCancelled."""
    if story.state == "failed":
        raise StoryFailed(story)
    if story.state == "cancelled":
        raise StoryCancelled(story)
    return story
