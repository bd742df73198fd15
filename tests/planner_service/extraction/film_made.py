"""Short films that are drawn: shots of moving blocks, hard cuts and fades, sound, subtitles, and ways to spoil them."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Final

import av
import numpy as np
from numpy.typing import NDArray

WIDTH, HEIGHT, RATE = 160, 120, 12
Picture = NDArray[np.uint8]
COLOURS: Final = ((200, 60, 50), (40, 90, 200), (60, 170, 70), (220, 200, 60), (120, 50, 140), (90, 90, 90))


@dataclass(frozen=True)
class Drawn:
    """One shot of a drawn film, and how long the fade into the next one takes."""

    seconds: float
    colour: int = 0
    fade: float = 0.0
    through_black: bool = False


@dataclass(frozen=True)
class Making:
    """How a film is written."""

    form: str = "mp4"
    codec: str = "libx264"
    rate: int = RATE
    size: tuple[int, int] = (WIDTH, HEIGHT)
    subtitles: tuple[tuple[float, float, str], ...] = ()
    texts: str = "mov_text"
    languages: tuple[str, ...] = ("",)
    """Of the tracks of subtitles; the last one has the words, the others are empty."""
    sound: float = 0.0
    """Seconds of a tone."""
    sounds: str = "aac"
    options: tuple[tuple[str, str], ...] = (("preset", "ultrafast"), ("crf", "26"), ("bf", "2"))


def picture_of(colour: int, number: int, size: tuple[int, int] = (WIDTH, HEIGHT)) -> Picture:
    """(H, W, 3) a coloured wall, a little noise, and blocks that move."""
    width, height = size
    rng = np.random.default_rng(colour)
    shown = np.empty((height, width, 3), np.int16)
    shown[:] = COLOURS[colour % len(COLOURS)]
    side = height // 4
    for _ in range(4):
        x, y, along, down = (int(value) for value in rng.integers(-4, 200, 4))
        x, y = (x + along % 5 * number) % (width - side), (y + down % 3 * number) % (height - side)
        shown[y : y + side, x : x + side] = rng.integers(0, 255, 3)
    noise = np.random.default_rng((colour, number)).integers(-6, 7, (height, width, 1))
    return np.clip(shown + noise, 0, 255).astype(np.uint8)


def pictures_of(shots: Sequence[Drawn], making: Making) -> Iterator[Picture]:
    """Every picture in order; a fade belongs to the end of its shot."""
    number = 0
    for index, shot in enumerate(shots):
        count = round(shot.seconds * making.rate)
        fading = round(shot.fade * making.rate)
        for at in range(count):
            drawn = picture_of(shot.colour, number, making.size)
            left = count - at
            if left <= fading:
                share = 1 - left / (fading + 1)
                then = picture_of(shots[index + 1].colour, number, making.size).astype(float)
                if shot.through_black:
                    both = drawn * (1 - 2 * share) if share < 0.5 else then * (2 * share - 1)
                else:
                    both = drawn * (1 - share) + then * share
                drawn = both.astype(np.uint8)
            yield drawn
            number += 1


def film_of(shots: Sequence[Drawn], making: Making | None = None) -> bytes:
    """The film as a file."""
    making = making or Making()
    file = io.BytesIO()
    with av.open(file, "w", format=making.form) as container:
        stream: Any = container.add_stream(making.codec, rate=making.rate, options=dict(making.options))
        stream.width, stream.height, stream.pix_fmt = *making.size, "yuvj420p" if "jpeg" in making.codec else "yuv420p"
        stream.codec_context.thread_count = 1
        sound: Any = container.add_stream(making.sounds, rate=16000) if making.sound else None
        texts: Any = None
        for language in making.languages if making.subtitles else ():
            texts = container.add_stream(making.texts)
            texts.codec_context.subtitle_header = _STYLES
            texts.time_base = texts.codec_context.time_base = Fraction(1, 1000)
            texts.metadata["language"] = language or "und"
        for number, picture in enumerate(pictures_of(shots, making)):
            frame = av.VideoFrame.from_ndarray(picture, "rgb24")
            frame.pts, frame.time_base = number, Fraction(1, making.rate)
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
        for start, end, text in making.subtitles:
            container.mux(_subtitle(texts, start, end, text))
        if sound is not None:
            for frame in _tone(making.sound):
                container.mux(sound.encode(frame))
            container.mux(sound.encode(None))
    return file.getvalue()


def four_shots(making: Making | None = None) -> bytes:
    """Eight seconds: three hard cuts, at 2, 4.5 and 6 seconds."""
    return film_of([Drawn(2, 0), Drawn(2.5, 1), Drawn(1.5, 2), Drawn(2, 3)], making)


def sound_alone(seconds: float = 1.0) -> bytes:
    """An MP4 that holds a tone and no picture."""
    file = io.BytesIO()
    with av.open(file, "w", format="mp4") as container:
        sound: Any = container.add_stream("aac", rate=16000)
        for frame in _tone(seconds):
            container.mux(sound.encode(frame))
        container.mux(sound.encode(None))
    return file.getvalue()


_STYLES: Final = (
    b"[Script Info]\nScriptType: v4.00+\n[V4+ Styles]\nFormat: Name, Fontname, Fontsize\nStyle: Default,Arial,16\n"
    b"[Events]\nFormat: Layer, Start, End, Style, Name, MarginL, MarginR, MarginV, Effect, Text\n"
)


def _subtitle(stream: Any, start: float, end: float, text: str) -> Any:
    length = round(1000 * (end - start))
    row = f"0,0,Default,,0,0,0,,{text}".encode()
    cue = av.subtitles.subtitle.SubtitleSet.create(text=row, start=0, end=length, pts=round(1000 * start))
    packet = stream.codec_context.encode_subtitle(cue)
    packet.stream, packet.time_base = stream, Fraction(1, 1000)
    packet.pts = packet.dts = round(1000 * start)
    packet.duration = length
    return packet


def _tone(seconds: float) -> Iterator[Any]:
    for start in range(0, int(seconds * 16000), 1024):
        moments = (start + np.arange(1024)) / 16000
        tone = (8000 * np.sin(2 * np.pi * 440 * moments)).astype(np.int16)[None]
        frame = av.AudioFrame.from_ndarray(tone, format="s16", layout="mono")
        frame.sample_rate, frame.pts, frame.time_base = 16000, start, Fraction(1, 16000)
        yield frame
