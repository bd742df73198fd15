"""Reading a film of twenty minutes: its shots, its subtitles, and the frames that show its scenes."""

from __future__ import annotations

import time
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from benchmarks.figure import Figure

WIDTH, HEIGHT, RATE = 854, 480, 25
DRAWN: Final = 20
"""Seconds that are drawn and encoded; the film is made of them again and again."""
SHOT: Final = 4
MINUTES: Final = 20


def film_figures(folder: Path) -> list[Figure]:
    """The whole way of a film but for the model: from the file to the frames of every scene; seconds of one core."""
    from planner_service.extraction.shot_detection import scenes_in, shots_of
    from planner_service.extraction.subtitles import embedded_cues
    from planner_service.extraction.video import open_film
    from planner_service.extraction.video_frames import Album

    path = folder / "film.mkv"
    _write(path)
    started = time.process_time()
    film = open_film(path, "a drawn film")
    found = embedded_cues(film)
    with Album() as album:
        shots = shots_of(film, album=album)
        looked = time.process_time()
        scenes = scenes_in(shots, found.cues if found else ())
        frames = sum(len(list(album.frames(film, scene.times))) for scene in scenes)
    seconds = time.process_time() - started
    pictures = MINUTES * 60 * RATE
    rate = pictures / (looked - started)
    note = (
        f"{MINUTES} min of {WIDTH} × {HEIGHT} H.264 with noise, {path.stat().st_size / 2**20:.0f} MB: {len(shots)} "
        f"shots, {len(found.cues) if found else 0} cues, {frames} frames of {len(scenes)} scenes; "
        f"shots at {rate:.0f} pictures/s"
    )
    path.unlink()
    return [Figure("reading a film with subtitles, one core", seconds, "s", 60, note=note)]


def _write(path: Path) -> None:
    """Twenty minutes of film with a cue a minute: `DRAWN` seconds of packets, repeated with later times."""
    import av

    with av.open(str(path), "w", format="matroska") as container:
        stream: Any = container.add_stream("libx264", rate=RATE, options={"preset": "veryfast", "crf": "26"})
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        stream.codec_context.thread_count = 1
        texts: Any = container.add_mux_stream("subrip")
        packets = []
        for number, picture in enumerate(_pictures()):
            frame = av.VideoFrame.from_ndarray(picture, "rgb24")
            frame.pts, frame.time_base = number, Fraction(1, RATE)
            packets += stream.encode(frame)
        packets += stream.encode(None)
        kept = [(bytes(one), one.pts, one.dts, one.is_keyframe) for one in packets]
        for again in range(MINUTES * 60 // DRAWN):
            if again % (60 // DRAWN) == 0:
                cue = av.Packet(b"A minute has passed.")
                cue.stream, cue.time_base, cue.duration = texts, Fraction(1, 1000), 2000
                cue.pts = cue.dts = again * DRAWN * 1000
                container.mux(cue)
            for data, pts, dts, whole in kept:
                packet = av.Packet(data)
                packet.stream, packet.time_base, packet.is_keyframe = stream, Fraction(1, RATE), whole
                packet.pts, packet.dts = pts + again * DRAWN * RATE, dts + again * DRAWN * RATE
                container.mux(packet)


def _pictures() -> Iterator[NDArray[np.uint8]]:
    """(H, W, 3) each: walls of a colour a shot, noise, and blocks that move."""
    rng = np.random.default_rng(0)
    noise = [rng.integers(0, 40, (HEIGHT, WIDTH, 3), dtype=np.uint8) for _ in range(8)]
    blocks = rng.integers(-6, 460, (DRAWN // SHOT, 6, 4))
    colours = rng.integers(20, 200, (DRAWN // SHOT, 7, 3), dtype=np.uint8)
    for number in range(DRAWN * RATE):
        shot = number // (SHOT * RATE)
        picture = colours[shot, 0] + noise[number % 8]
        for colour, (x, y, across, down) in zip(colours[shot, 1:], blocks[shot], strict=True):
            left, top = (x + across % 13 * number) % (WIDTH - 80), (y + down % 9 * number) % (HEIGHT - 80)
            picture[top : top + 80, left : left + 80] = colour
        yield picture
