"""A film: what it says of itself, its pictures one after the other, and those at given times as JPEG."""

from __future__ import annotations

from collections import Counter
from collections.abc import Generator, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

import numpy as np

from planner_service.extraction.video_container import (
    CODECS,
    READ,
    TEXTS,
    FilmError,
    checked_container,
    load_av,
    opened,
    said,
    size_of,
)

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.stream import Stream
    from av.subtitles.stream import SubtitleStream
    from av.video.stream import VideoStream

MAX_SIDE_PIXELS: Final = 512
"""Pixels of the longer side of a JPEG."""
_QUANTISER: Final = 4
"""Of the JPEGs; near libjpeg's quality 80."""
_EPSILON: Final = 1e-3
"""Seconds by which a picture may come too late for its time."""
_BACKWARDS: Final = 100
"""Pictures in a row that may be dated before the one they follow."""
_DAMAGED: Final = 1000
"""Packets in a row that may be damaged."""


@dataclass(frozen=True)
class FilmLimits:
    """What is read of one film at most."""

    bytes: int = 16_000_000_000
    seconds: float = 4 * 3600.0
    pixels: int = 4096 * 2304
    """Of one picture."""
    pictures: int = 1_000_000


@dataclass(frozen=True)
class Film:
    """A film that can be read. Every reading opens it anew, so nothing of it stays in memory between."""

    name: str
    source: Path | BinaryIO = field(repr=False)
    form: str
    """mp4 (or MOV), matroska (or WebM), avi, mpegts."""
    limits: FilmLimits
    width: int
    height: int
    rate: float
    """Pictures a second, on average, as the file says; 25 where it says nothing that can be."""
    claimed: float | None
    """Seconds it says it lasts: good for progress, never trusted."""
    start: float
    """Where the clock of the file is when the pictures begin (seconds)."""
    aspect: float
    """How wide a dot of its pictures is, of its height."""
    sound: bool
    texts: int
    """Tracks of subtitles that are letters."""
    faults: Counter[str] = field(default_factory=Counter, compare=False)
    """What was wrong while it was read, and how often."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What was wrong so far, a line each."""
        return tuple(f"{self.name}: {many} {what}" for what, many in sorted(self.faults.items()) if many)


@dataclass(frozen=True)
class Frame:
    """What is on the screen at a time (seconds), as a JPEG file."""

    time: float
    jpeg: bytes = field(repr=False)


def open_film(source: Path | BinaryIO, name: str, limits: FilmLimits | None = None) -> Film:
    """The film in a file, by its bytes and not by its name. FilmError says why it cannot be read.

    `name` is the film's title, for people. A file object must be seekable and is not closed.
    """
    limits = limits or FilmLimits()
    size = size_of(source)
    if size > limits.bytes:
        raise FilmError(
            f"it has {size} bytes, at most {limits.bytes} are read", "give a smaller copy or a part", at="film"
        )
    form = checked_container(_head(source))
    with opened(source, form) as container:
        stream = _track(container, limits)
        first = next(_decoded(container, stream, limits, Counter()), None)
        if first is None:
            raise FilmError("there is no picture in it that can be decoded", f"give a whole {READ}", at="film")
        rate, aspect = float(stream.average_rate or 0), float(stream.codec_context.sample_aspect_ratio or 1)
        return Film(
            name=" ".join(name.split())[:200] or "film",
            source=source,
            form=form,
            limits=limits,
            width=stream.width,
            height=stream.height,
            rate=rate if 0.01 <= rate <= 1000 else 25.0,
            claimed=container.duration / 1e6 if container.duration and container.duration > 0 else None,
            start=first.time or 0.0,
            aspect=aspect if 0.2 <= aspect <= 5 else 1.0,
            sound=bool(container.streams.audio),
            texts=len(text_tracks(container)),
        )


def pictures(film: Film, rough: bool = False) -> Iterator[tuple[float, VideoFrame]]:
    """Every picture with its time, in the order of time; one is in memory at a time.

    `rough` leaves out the last smoothing of blocks, which takes a seventh of the time. FilmError for a film that is
    longer than its limits or whose clock runs backwards.
    """
    with opened(film.source, film.form) as container:
        stream = _track(container, film.limits, {"skip_loop_filter": "all"} if rough else {})
        yield from _dated(_decoded(container, stream, film.limits, film.faults), film)


def frames_at(film: Film, times: Iterable[float]) -> Iterator[Frame]:
    """What is on the screen at the given times (seconds), in order; a picture that stays is shown once. FilmError.

    Pictures that no other one needs are not decoded, so a frame may be a few pictures old.
    """
    with opened(film.source, film.form) as container:
        stream = _track(container, film.limits)
        stream.codec_context.skip_frame = "NONREF"
        run = _dated(_decoded(container, stream, film.limits, film.faults), film)
        held, ahead, shown = None, next(run, None), None
        for time in sorted(set(times)):
            if ahead is not None and _keyframe(stream, film, time) > ahead[0]:
                run.close()
                container.seek(int((time + film.start) / (stream.time_base or 1)), stream=stream)
                run = _dated(_decoded(container, stream, film.limits, film.faults), film)
                held, ahead = None, next(run, None)
            while ahead is not None and ahead[0] <= time + _EPSILON:
                held, ahead = ahead, next(run, None)
            now = held or ahead
            if now is not None and now is not shown:
                yield Frame(round(time if held else now[0], 3), jpeg_of(now[1], film.aspect))
                shown = now


def jpeg_of(picture: VideoFrame, aspect: float) -> bytes:
    """The picture upright and with square pixels as JPEG, its longer side at most `MAX_SIDE_PIXELS`."""
    av = load_av()
    wide = picture.width * aspect
    share = min(1.0, MAX_SIDE_PIXELS / max(wide, picture.height))
    width, height = (max(2, round(side * share / 2) * 2) for side in (wide, picture.height))
    small = picture.reformat(width, height, "rgb24", interpolation="AREA")
    if picture.rotation % 360:
        turned = np.rot90(small.to_ndarray(), round(picture.rotation / 90) % 4)
        small = av.VideoFrame.from_ndarray(np.ascontiguousarray(turned), "rgb24")
    small = small.reformat(format="yuvj420p")
    small.pts = 0
    encoder = av.CodecContext.create("mjpeg", "w")
    encoder.width, encoder.height, encoder.pix_fmt = small.width, small.height, "yuvj420p"
    encoder.time_base, encoder.thread_count = Fraction(1, 25), 1
    encoder.options = {"qmin": str(_QUANTISER), "qmax": str(_QUANTISER)}
    return b"".join(map(bytes, (*encoder.encode(small), *encoder.encode(None))))


def text_tracks(container: InputContainer) -> list[SubtitleStream]:
    """The tracks of subtitles that are letters, the usual one first: default, not forced, English before others."""
    tracks = [one for one in container.streams.subtitles if _codec(one) in TEXTS]
    return sorted(
        tracks,
        key=lambda one: (
            bool(one.disposition & one.disposition.forced),
            not (one.language or "").startswith("en"),
            not bool(one.disposition & one.disposition.default),
            one.index,
        ),
    )


def _track(container: InputContainer, limits: FilmLimits, options: Mapping[str, str] | None = None) -> VideoStream:
    """The track of moving pictures, of a codec and size that are read. FilmError."""
    tracks = [one for one in container.streams.video if not one.disposition & one.disposition.attached_pic]
    if not tracks:
        only = "only sound" if container.streams.audio else "nothing that moves"
        raise FilmError(f"there is {only} in it, no moving picture", f"give {READ}", at="film")
    track = tracks[0]
    if _codec(track) not in CODECS:
        raise FilmError(f"its codec {_codec(track)} is not read", "make a copy in H.264", at="film")
    _measure(track.width, track.height, limits)
    track.codec_context.thread_count = 1
    track.codec_context.options = {"max_pixels": str(limits.pixels), **(options or {})}
    return track


def _codec(track: Stream) -> str:
    """The name of a track's decoder, "unknown" where there is none."""
    return track.codec_context.name[:40] if track.codec_context is not None else "unknown"


def _measure(width: int, height: int, limits: FilmLimits) -> None:
    if width * height > limits.pixels:
        raise FilmError(
            f"its pictures are {width} × {height}, at most {limits.pixels} pixels are read",
            "make a smaller copy: ffmpeg -i FILM -vf scale=1280:-2 SMALLER.mp4",
            at="film",
        )


def _decoded(
    container: InputContainer, stream: VideoStream, limits: FilmLimits, faults: Counter[str]
) -> Iterator[VideoFrame]:
    """The pictures of a track as they come; damaged ones are left out and counted. FilmError where there is no end."""
    error_type = load_av().FFmpegError
    packets = container.demux(stream)
    damaged = 0
    for _ in range(limits.pictures * 4):
        try:
            packet = next(packets, None)
        except error_type as error:
            faults[f"times the file broke off ({said(error)})"] += 1
            return
        if packet is None:
            return
        try:
            found = packet.decode()
        except error_type as error:
            damaged += 1
            faults["damaged pictures, left out"] += 1
            if damaged > _DAMAGED:
                raise FilmError(f"{damaged} damaged pictures follow one another ({said(error)})", at="film") from error
            continue
        for picture in found:
            damaged = 0
            faults["damaged pictures, shown as they are"] += bool(picture.is_corrupt)
            _measure(picture.width, picture.height, limits)
            yield picture
    raise FilmError(f"there are more than {4 * limits.pictures} packets in it", "give a part of it", at="film")


def _dated(run: Iterator[VideoFrame], film: Film) -> Generator[tuple[float, VideoFrame]]:
    """Pictures with their times (seconds), which only go up; one that is dated earlier is left out and counted."""
    last, backwards = float("-inf"), 0
    for number, picture in enumerate(run):
        undated = 0.0 if number == 0 else last + 1 / film.rate
        time = undated if picture.time is None else picture.time - film.start
        if time > film.limits.seconds or number > film.limits.pictures:
            raise FilmError(
                f"it goes on after {film.limits.seconds / 3600:g} hours or {film.limits.pictures} pictures, which "
                "is all that is read of one",
                "give a part, or mend its clock: ffmpeg -i FILM -fps_mode cfr NEW.mp4",
                at="film",
            )
        if time <= last or time < 0:
            backwards += 1
            film.faults["pictures dated before the one they follow, left out"] += 1
            if backwards > _BACKWARDS:
                raise FilmError(
                    f"its clock jumps back at {last:.1f} s",
                    "mend it: ffmpeg -fflags +genpts -i FILM MENDED.mp4",
                    at="film",
                )
            continue
        last, backwards = time, 0
        yield time, picture


def _keyframe(stream: VideoStream, film: Film, time: float) -> float:
    """When the last picture at or before a time comes that can be decoded by itself, as far as the index says."""
    base = float(stream.time_base or 0)
    at = stream.index_entries.search_timestamp(int((time + film.start) / base)) if base else -1
    return stream.index_entries[at].timestamp * base - film.start if at >= 0 else float("-inf")


def _head(source: Path | BinaryIO) -> bytes:
    """The first bytes of a file."""
    if isinstance(source, Path):
        with source.open("rb") as file:
            return file.read(512)
    source.seek(0)
    return source.read(512)
