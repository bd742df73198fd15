"""The two clients: the same calls, one that blocks and one that awaits. Only what waits is written twice."""

from __future__ import annotations

import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from functools import update_wrapper
from typing import Any, Generic, ParamSpec, Self, TypeVar, overload

import anyio
import httpx

from planner_service.client import requests
from planner_service.client.event_stream_client import Following, Looking, finished
from planner_service.client.requests import Call
from planner_service.client.responses import Extraction, Story, StoryEvent
from planner_service.client.retry import Sending, http_options

P = ParamSpec("P")
T = TypeVar("T")
HERE = "http://127.0.0.1:8000"
TIMEOUT = 30.0
"""Seconds for an answer to begin, and between its parts."""


class Method(Generic[P, T]):
    """A call as a method: of a client it gives the answer, of an async one what to await."""

    def __init__(self, make: Callable[P, Call[T]]) -> None:
        self.make = make
        update_wrapper(self, make)

    @overload
    def __get__(self, client: None, owner: type) -> Method[P, T]: ...
    @overload
    def __get__(self, client: Client, owner: type) -> Callable[P, T]: ...
    @overload
    def __get__(self, client: AsyncClient, owner: type) -> Callable[P, Awaitable[T]]: ...
    def __get__(self, client: Client | AsyncClient | None, owner: type) -> Any:
        if client is None:
            return self

        def method(*args: P.args, **options: P.kwargs) -> Any:
            return client.send(self.make(*args, **options))

        return update_wrapper(method, self.make)

    def __call__(self, *args: P.args, **options: P.kwargs) -> Call[T]:
        """The call itself, unsent."""
        return self.make(*args, **options)


class Methods:
    """Every call of the service; each is documented in requests.py."""

    tell = Method(requests.tell)
    act = Method(requests.act)
    take = Method(requests.take)
    stories = Method(requests.stories)
    story = Method(requests.story)
    cancel = Method(requests.cancel)
    delete = Method(requests.delete)
    motion = Method(requests.motion)
    motion_file = Method(requests.motion_file)
    film = Method(requests.film)
    film_usd = Method(requests.film_usd)
    make_film = Method(requests.make_film)
    film_state = Method(requests.film_state)
    film_mp4 = Method(requests.film_mp4)
    delete_film = Method(requests.delete_film)
    scene = Method(requests.scene)
    props = Method(requests.props)
    home = Method(requests.home)
    short_scripts = Method(requests.short_scripts)
    short_script = Method(requests.short_script)
    short_script_versions = Method(requests.short_script_versions)
    export_short_scripts = Method(requests.export_short_scripts)
    search_short_scripts = Method(requests.search_short_scripts)
    add_short_script = Method(requests.add_short_script)
    change_short_script = Method(requests.change_short_script)
    delete_short_script = Method(requests.delete_short_script)
    extract = Method(requests.extract)
    extractions = Method(requests.extractions)
    extraction = Method(requests.extraction)
    cancel_extraction = Method(requests.cancel_extraction)
    delete_extraction = Method(requests.delete_extraction)
    long_script = Method(requests.long_script)
    captions = Method(requests.captions)
    emotions = Method(requests.emotions)
    furniture = Method(requests.furniture)
    skills = Method(requests.skills)
    backends = Method(requests.backends)
    layouts = Method(requests.layouts)
    layout = Method(requests.layout)
    add_layout = Method(requests.add_layout)
    import_layouts = Method(requests.import_layouts)
    delete_layout = Method(requests.delete_layout)
    layout_drawing = Method(requests.layout_drawing)
    layout_scene = Method(requests.layout_scene)
    retrieve_layouts = Method(requests.retrieve_layouts)
    plan_task = Method(requests.plan_task)
    merge_graphs = Method(requests.merge_graphs)


class Client(Methods):
    """Calls the service and blocks until it answers. Threads may share one; close it, or use it in `with`.

    Every method raises ApiError for what the service refuses and Unreachable where nobody answers. `timeout` is in
    seconds. Calls that can be repeated are, three times, when the service is busy or the connection breaks off.
    """

    def __init__(self, base_url: str = HERE, key: str | None = None, timeout: float = TIMEOUT) -> None:
        self.base_url, self.timeout = base_url, timeout
        self._http = httpx.Client(**http_options(base_url, key, timeout))

    def send(self, call: Call[T]) -> T:
        """The answer to a call."""
        sending = Sending(call, self.base_url)
        while True:
            try:
                response = self._http.request(**sending.request())
            except httpx.TransportError as error:
                sending.broke(error)
            else:
                if sending.answered(response):
                    return sending.read(response)
            time.sleep(sending.wait)

    def events(self, story_id: str, after: int = 0) -> Iterator[StoryEvent]:
        """What happens to a story, as it happens, from the event behind `after` to the last; resumes by itself."""
        return self._follow(Following(story_id, after))

    def wait(self, story_id: str, timeout: float | None = None) -> Story:
        """The story once it has succeeded. StoryFailed, StoryCancelled, WaitTimeout (up to 5 s late)."""
        for _ in self._follow(Following(story_id, timeout=timeout)):
            pass
        return finished(self.story(story_id))

    def wait_film(self, story_id: str, timeout: float | None = None) -> bytes:
        """The story's film.mp4, made if need be. StoryFailed, StoryCancelled, WaitTimeout; ApiError 409, 501."""
        looking = Looking(self.make_film(story_id), timeout)
        while looking.goes_on():
            time.sleep(looking.pause)
            looking.film = self.film_state(story_id)
        return self.film_mp4(story_id)

    def extraction_events(self, extraction_id: str, after: int = 0) -> Iterator[StoryEvent]:
        """The same of an extraction."""
        return self._follow(Following(extraction_id, after, kind="extractions"))

    def wait_extraction(self, extraction_id: str, timeout: float | None = None) -> Extraction:
        """The extraction once it has succeeded. StoryFailed, StoryCancelled, WaitTimeout (up to 5 s late)."""
        for _ in self._follow(Following(extraction_id, timeout=timeout, kind="extractions")):
            pass
        return finished(self.extraction(extraction_id))

    def _follow(self, following: Following) -> Iterator[StoryEvent]:
        while not following.ended:
            try:
                with self._http.stream(**following.request(self.timeout)) as response:
                    if response.is_error:
                        response.read()
                    if following.opened(response):
                        for piece in response.iter_bytes():
                            yield from following.feed(piece)
                        following.closed()
            except httpx.TransportError as error:
                following.broke(error, self.base_url)
            time.sleep(following.pause)

    def close(self) -> None:
        """Let go of connections."""
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class AsyncClient(Methods):
    """The same calls, each to be awaited; `events` is an asynchronous iterator. Close it, or use it in `async with`."""

    def __init__(self, base_url: str = HERE, key: str | None = None, timeout: float = TIMEOUT) -> None:
        self.base_url, self.timeout = base_url, timeout
        self._http = httpx.AsyncClient(**http_options(base_url, key, timeout))

    async def send(self, call: Call[T]) -> T:
        """The answer to a call."""
        sending = Sending(call, self.base_url)
        while True:
            try:
                response = await self._http.request(**sending.request())
            except httpx.TransportError as error:
                sending.broke(error)
            else:
                if sending.answered(response):
                    return sending.read(response)
            await anyio.sleep(sending.wait)

    def events(self, story_id: str, after: int = 0) -> AsyncIterator[StoryEvent]:
        """What happens to a story, as it happens, from the event behind `after` to the last; resumes by itself."""
        return self._follow(Following(story_id, after))

    async def wait(self, story_id: str, timeout: float | None = None) -> Story:
        """The story once it has succeeded. StoryFailed, StoryCancelled, WaitTimeout (up to 5 s late)."""
        async for _ in self._follow(Following(story_id, timeout=timeout)):
            pass
        return finished(await self.story(story_id))

    async def wait_film(self, story_id: str, timeout: float | None = None) -> bytes:
        """The story's film.mp4, made if need be. StoryFailed, StoryCancelled, WaitTimeout; ApiError 409, 501."""
        looking = Looking(await self.make_film(story_id), timeout)
        while looking.goes_on():
            await anyio.sleep(looking.pause)
            looking.film = await self.film_state(story_id)
        return await self.film_mp4(story_id)

    def extraction_events(self, extraction_id: str, after: int = 0) -> AsyncIterator[StoryEvent]:
        """The same of an extraction."""
        return self._follow(Following(extraction_id, after, kind="extractions"))

    async def wait_extraction(self, extraction_id: str, timeout: float | None = None) -> Extraction:
        """The extraction once it has succeeded. StoryFailed, StoryCancelled, WaitTimeout (up to 5 s late)."""
        async for _ in self._follow(Following(extraction_id, timeout=timeout, kind="extractions")):
            pass
        return finished(await self.extraction(extraction_id))

    async def _follow(self, following: Following) -> AsyncIterator[StoryEvent]:
        while not following.ended:
            try:
                async with self._http.stream(**following.request(self.timeout)) as response:
                    if response.is_error:
                        await response.aread()
                    if following.opened(response):
                        async for piece in response.aiter_bytes():
                            for event in following.feed(piece):
                                yield event
                        following.closed()
            except httpx.TransportError as error:
                following.broke(error, self.base_url)
            await anyio.sleep(following.pause)

    async def close(self) -> None:
        """Let go of connections."""
        await self._http.aclose()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()
