"""The frames of a film, one a second, put aside in a temporary file while its shots are looked for."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Self

from planner_service.extraction.video import Film, Frame, frames_at, jpeg_of

if TYPE_CHECKING:
    from av import VideoFrame

FIRST = 0.5
"""When the first frame is taken (seconds); then one every second."""


class Album:
    """Frames at 0.5 s, 1.5 s, 2.5 s … of one film. Saves decoding it twice; gone when it is closed."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile()  # noqa: SIM115 - closed by `close`
        self._places: list[tuple[int, int]] = []
        self._held: VideoFrame | None = None
        self._put = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Throw the frames away."""
        self._file.close()

    def see(self, film: Film, time: float, picture: VideoFrame) -> None:
        """The next picture of the film: the one before it was on the screen until now."""
        while FIRST + len(self._places) < time and self._held is not None:
            if self._put:
                self._places.append(self._places[-1])
            else:
                jpeg = jpeg_of(self._held, film.aspect)
                self._places.append((self._file.tell(), len(jpeg)))
                self._file.write(jpeg)
                self._put = True
        self._held, self._put = picture, False

    def frames(self, film: Film, times: Iterable[float]) -> Iterator[Frame]:
        """As `frames_at`; the film is opened only where a time was not put aside."""
        missing = []
        for time in sorted(set(times)):
            number = time - FIRST
            if number == int(number) and 0 <= number < len(self._places):
                start, length = self._places[int(number)]
                self._file.seek(start)
                yield Frame(time, self._file.read(length))
            else:
                missing.append(time)
        if missing:
            yield from frames_at(film, missing)
        self._file.seek(0, 2)
