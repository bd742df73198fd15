"""Films: any container that is read, every kind of bad file, references that are not followed, bounded memory."""

from __future__ import annotations

import io
import os
import random
import struct
from fractions import Fraction
from functools import cache
from pathlib import Path

import av
import numpy as np
import pytest
from film_made import Drawn, Making, film_of, four_shots, picture_of, sound_alone
from for_each import for_each

from planner_service.extraction.shot_detection import Shot, shots_of
from planner_service.extraction.subtitles import embedded_cues
from planner_service.extraction.video import Film, FilmLimits, Frame, frames_at, open_film, pictures
from planner_service.extraction.video_container import FilmError, container_of
from planner_service.extraction.video_frames import Album

whole = cache(four_shots)
SAID = ((0.5, 1.5, "Hello [sighs] there"), (3.0, 4.0, "JOHN: Sit down."))


def opened(data: bytes, limits: FilmLimits | None = None) -> Film:
    return open_film(io.BytesIO(data), "a film", limits)


def read_or_refused(data: bytes, limits: FilmLimits | None = None) -> tuple[Shot, ...] | str:
    """The shots of a film, or why it was refused."""
    try:
        return shots_of(opened(data, limits))
    except FilmError as refusal:
        return str(refusal)


def colour_of(frame: Frame) -> np.ndarray:
    """The mean colour of a JPEG, as it is decoded by itself."""
    with av.open(io.BytesIO(frame.jpeg), "r", format="jpeg_pipe") as container:
        return next(container.decode(video=0)).to_ndarray(format="rgb24").mean(axis=(0, 1))


def test_a_film_says_what_it_is() -> None:
    film = opened(film_of([Drawn(1)], Making(sound=1.0, subtitles=SAID[:1])))
    assert (film.form, film.width, film.height, film.rate) == ("mp4", 160, 120, 12.0)
    assert film.sound
    assert film.texts == 1
    assert film.claimed == pytest.approx(1.5, abs=0.6)


def test_pictures_come_in_order_and_each_once() -> None:
    times = [time for time, _ in pictures(opened(whole()))]
    assert times == pytest.approx([number / 12 for number in range(96)])


def test_a_frame_shows_what_is_on_the_screen_at_its_time() -> None:
    film = opened(whole())
    wanted = [0.1, 1.9, 2.1, 4.4, 4.6, 5.9, 6.1, 7.9]
    frames = list(frames_at(film, wanted))
    assert [frame.time for frame in frames] == wanted
    for frame, colour in zip(frames, [0, 0, 1, 1, 2, 2, 3, 3], strict=True):
        seen = colour_of(frame)
        unlike = [np.abs(seen - picture_of(other, int(frame.time * 12)).mean(axis=(0, 1))).sum() for other in range(4)]
        assert int(np.argmin(unlike)) == colour


def test_frames_can_be_asked_for_in_any_order_twice_and_beyond_the_end() -> None:
    frames = list(frames_at(opened(whole()), [7.0, 1.0, 1.0, 500.0]))
    assert [frame.time for frame in frames] == [1.0, 7.0, 500.0]
    assert list(frames_at(opened(whole()), [])) == []


def test_frames_are_small() -> None:
    film = opened(film_of([Drawn(0.25)], Making(size=(800, 450))))
    frame = next(frames_at(film, [0.0]))
    with av.open(io.BytesIO(frame.jpeg), "r", format="jpeg_pipe") as container:
        picture = next(container.decode(video=0))
    assert (picture.width, picture.height) == (512, 288)
    assert frame.jpeg.startswith(b"\xff\xd8\xff")
    assert len(frame.jpeg) < 60_000


@for_each(
    ("making", "form"),
    [
        (Making("matroska", subtitles=SAID, texts="subrip"), "matroska"),
        (Making("webm", codec="libvpx", options=(("deadline", "realtime"), ("cpu-used", "8"))), "matroska"),
        (Making("avi", codec="mpeg4", options=()), "avi"),
        (Making("mpegts"), "mpegts"),
        (Making("mov"), "mp4"),
    ],
)
def test_every_container_is_read_by_its_bytes(making: Making, form: str) -> None:
    film = opened(film_of([Drawn(1, 0), Drawn(1, 1)], making))
    assert film.form == form
    assert sum(1 for _ in pictures(film)) == 24
    assert [shot.start for shot in shots_of(film)] == [0.0, 1.0]


@pytest.mark.parametrize("texts", ["mov_text", "subrip", "ass"])
def test_subtitles_within_a_film_are_read(texts: str) -> None:
    form = "mp4" if texts == "mov_text" else "matroska"
    found = embedded_cues(opened(film_of([Drawn(5)], Making(form, subtitles=SAID, texts=texts))))
    assert found is not None
    assert [(cue.start, cue.end, cue.text, cue.speaker, cue.sounds) for cue in found.cues] == [
        (0.5, 1.5, "Hello there", None, ("sighs",)),
        (3.0, 4.0, "Sit down.", "JOHN", ()),
    ]


@pytest.mark.parametrize("form", ["mp4", "matroska"])
def test_an_empty_track_does_not_hide_one_with_words(form: str) -> None:
    texts = "mov_text" if form == "mp4" else "subrip"
    making = Making(form, subtitles=((0.5, 0.9, "She sits down."),), texts=texts, languages=("eng", "ger", "fre"))
    found = embedded_cues(opened(film_of([Drawn(1)], making)))
    assert found is not None
    assert [cue.text for cue in found.cues] == ["She sits down."]
    assert found.notes == ("3 tracks of subtitles; read: fre; nothing in: eng, ger",)


def test_a_film_without_subtitles_has_none() -> None:
    assert embedded_cues(opened(whole())) is None


@for_each(
    ("data", "says"),
    [
        (b"", "empty"),
        (b"#EXTM3U\n#EXTINF:1,\nfile:///etc/passwd\n", "playlist"),
        (b"ffconcat version 1.0\nfile 'secret.mp4'\n", "list of files"),
        (b"[playlist]\nFile1=/etc/passwd\n", "playlist"),
        (b"[Reference]\nRef1=http://127.0.0.1/\n", "playlist"),
        (b'<?xml version="1.0"?><MPD></MPD>', "XML"),
        (b'<svg xmlns="http://www.w3.org/2000/svg"/>', "XML"),
        (b"v=0\no=- 0 0 IN IP4 127.0.0.1\n", "session description"),
        (b"frames/img%03d.png\n", "pattern of picture files"),
        (b"PK\x03\x04" + bytes(600), "ZIP"),
        (b"\x89PNG\r\n\x1a\n" + bytes(600), "PNG"),
        (b"\x00" * 600, "no container"),
    ],
)
def test_what_is_no_film_is_refused_and_named(data: bytes, says: str) -> None:
    assert_refused(data, says)


def test_sound_alone_and_what_is_cut_off_is_refused_and_named() -> None:
    assert_refused(sound_alone(), "only sound")
    assert_refused(whole()[:100], "cut off")
    assert_refused(whole()[: len(whole()) // 2], "cut off")


def assert_refused(data: bytes, says: str) -> None:
    with pytest.raises(FilmError, match=says) as refusal:
        opened(data)
    assert str(refusal.value).startswith("film: ")
    assert "\n" not in str(refusal.value)


def test_a_file_that_is_not_there_a_folder_and_a_stream_are_refused(tmp_path: Path) -> None:
    class Stream(io.BytesIO):
        def seekable(self) -> bool:
            return False

    with pytest.raises(FilmError, match="no file missing"):
        open_film(tmp_path / "missing.mp4", "x")
    with pytest.raises(FilmError, match="is no file"):
        open_film(tmp_path, "x")
    with pytest.raises(FilmError, match="wound back"):
        open_film(Stream(whole()), "x")


def test_a_film_that_is_too_large_in_any_way_is_refused_with_a_remedy() -> None:
    with pytest.raises(FilmError, match=r"160 × 120, at most 16000 pixels .* make a smaller copy"):
        opened(whole(), FilmLimits(pixels=16_000))
    with pytest.raises(FilmError, match="at most 1000 are read"):
        opened(whole(), FilmLimits(bytes=1000))
    for limits in (FilmLimits(seconds=3), FilmLimits(pictures=50)):
        with pytest.raises(FilmError, match="goes on after"):
            list(pictures(opened(whole(), limits)))


def test_a_film_that_grows_in_the_middle_is_not_decoded_beyond_the_limit() -> None:
    small, large = (
        film_of([Drawn(0.5)], Making("mpegts", codec="mpeg2video", size=size, options=()))
        for size in ((160, 120), (640, 480))
    )
    film = opened(small + large, FilmLimits(pixels=200 * 200))
    assert sum(1 for _ in pictures(film)) <= 7
    assert film.notes


@for_each(("box", "at"), [(b"mvhd", 20), (b"tkhd", 24), (b"mdhd", 20), (b"stts", 12)])
def test_a_header_that_lies_about_time_is_not_believed(box: bytes, at: int) -> None:
    lying = bytearray(whole())
    place = lying.find(box)
    lying[place + at : place + at + 4] = (0x0FFF_FFF0).to_bytes(4, "big")
    assert shots_of(opened(bytes(lying)))[-1].end == pytest.approx(8.0, abs=0.1)


@for_each(("box", "at"), [(b"mdat", -4), (b"stsz", 12), (b"moov", -4), (b"stco", 8)])
def test_a_header_that_claims_gigabytes_is_refused_or_read_in_little_memory(box: bytes, at: int) -> None:
    huge = bytearray(whole())
    place = huge.find(box)
    huge[place + at : place + at + 4] = (0x7FFF_FFF0).to_bytes(4, "big")
    before = _resident()
    found = read_or_refused(bytes(huge))
    assert not isinstance(found, str) or "cut off or damaged" in found or "no picture" in found
    assert _resident() - before < 100_000_000


@for_each("seed", range(6))
@for_each("form", ["mp4", "matroska", "mpegts"])
def test_a_corrupt_film_is_read_as_far_as_it_can_be_or_refused(form: str, seed: int) -> None:
    rng = random.Random(seed)
    spoilt = bytearray(whole() if form == "mp4" else short_film(form))
    for _ in range(3 * 4**seed):
        spoilt[rng.randrange(16, len(spoilt))] = rng.randrange(256)
    found = read_or_refused(bytes(spoilt), FilmLimits(seconds=60))
    if isinstance(found, str):
        assert found.startswith("film: ")
    else:
        assert all(shot.start < shot.end <= 61 for shot in found)


@cache
def short_film(form: str) -> bytes:
    return film_of([Drawn(1, 0), Drawn(1, 1)], Making(form))


def test_a_film_that_is_cut_off_is_read_up_to_there_and_says_so() -> None:
    whole = four_shots(Making("matroska"))
    film = opened(whole[: len(whole) // 2])
    assert 2.5 < shots_of(film)[-1].end < 6
    assert any("less than it says" in note for note in film.notes)


def _dated(times: list[int]) -> bytes:
    """A Matroska film whose pictures have the given times (milliseconds)."""
    file = io.BytesIO()
    with av.open(file, "w", format="matroska") as container:
        stream = container.add_stream("mjpeg", rate=10)
        stream.width, stream.height, stream.pix_fmt = 160, 120, "yuvj420p"
        for number, time in enumerate(times):
            frame = av.VideoFrame.from_ndarray(picture_of(number // 10, number), "rgb24")
            frame.pts = number
            for packet in stream.encode(frame):
                packet.pts, packet.dts, packet.time_base = time, time, Fraction(1, 1000)
                container.mux_one(packet)
    return file.getvalue()


def test_variable_rates_are_read_by_the_clock() -> None:
    times = [*range(0, 1000, 100), *range(1000, 11_000, 1000), *range(11_000, 11_500, 50)]
    film = opened(_dated(times))
    assert [time for time, _ in pictures(film)] == pytest.approx([time / 1000 for time in times], abs=0.06)
    assert [frame.time for frame in frames_at(film, [2.5, 2.9, 3.1])] == [2.5, 3.1]  # one picture stays from 2 to 3


def _alias(path: str) -> bytes:
    """An entry of a `dref` that says the pictures are in another file."""
    name = Path(path).name.encode()[:63]
    body = bytes(4) + bytes(10) + bytes([1]) + b"v".ljust(27, b"\0") + bytes(12) + bytes([len(name)])
    body += name.ljust(63, b"\0") + bytes(16) + bytes(4) + bytes(16)
    body += struct.pack(">HH", 2, len(path)) + path.encode() + bytes(len(path) % 2) + struct.pack(">hH", -1, 0)
    return struct.pack(">I", len(body) + 8) + b"alis" + body


def _referring(data: bytes, path: str) -> bytes:
    """The film with its pictures said to be in another file; the boxes around the reference grow."""
    entry, at = _alias(path), data.find(b"dref") + 12
    old = struct.unpack_from(">I", data, at)[0]
    grown = bytearray(data[:at] + entry + data[at + old :])
    for box in (b"moov", b"trak", b"mdia", b"minf", b"dinf", b"dref"):
        place = data.find(box) - 4
        struct.pack_into(">I", grown, place, struct.unpack_from(">I", data, place)[0] + len(entry) - old)
    return bytes(grown)


def test_a_reference_to_another_file_is_not_followed(tmp_path: Path) -> None:
    other = tmp_path / "secret.mov"
    other.write_bytes(whole())
    forged = _referring(whole(), str(other))
    options = {"enable_drefs": "1", "use_absolute_path": "1"}
    with av.open(io.BytesIO(forged), "r", format="mp4", container_options=options) as container:
        assert len(list(container.decode(video=0))) == 96, "the forgery works where references are followed"
    with pytest.raises(FilmError):
        opened(forged)


def test_the_title_is_kept_short() -> None:
    assert open_film(io.BytesIO(whole()), "  a \n title ", None).name == "a title"
    assert len(open_film(io.BytesIO(whole()), "x" * 1000, None).name) == 200


@for_each("length", [0, 1, 3, 7, 11, 187])
def test_short_heads_are_no_containers(length: int) -> None:
    assert container_of(b"\x47" * length) is None


def _resident() -> int:
    """Bytes of memory that this process holds; 0 where that cannot be told."""
    held = Path("/proc/self/statm")
    return 0 if not held.exists() else int(held.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_pictures_do_not_stay_in_memory() -> None:
    file = io.BytesIO()
    with av.open(file, "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=30, options={"preset": "ultrafast"})
        stream.width, stream.height, stream.pix_fmt = 1280, 720, "yuv420p"
        stream.codec_context.thread_count = 1
        picture = av.VideoFrame.from_ndarray(np.zeros((720, 1280, 3), np.uint8), "rgb24")
        for number in range(60):
            picture.pts = number
            container.mux(stream.encode(picture))
        container.mux(stream.encode(None))
    before, film = _resident(), opened(file.getvalue())
    assert len(shots_of(film)) == 1
    assert max(_resident() - before for _ in pictures(film)) < 40_000_000, "60 such pictures are 83 MB"


def test_an_album_holds_the_same_frames_as_the_film() -> None:
    film, wanted = opened(whole()), [0.5, 2.5, 4.5, 5.5, 7.5]
    with Album() as album:
        shots_of(film, album=album)
        kept = list(album.frames(film, [*wanted, 3.1]))
        assert [frame.time for frame in kept] == [*wanted, 3.1]
        again = [next(album.frames(film, [time])) for time in reversed(wanted)]
    assert again[::-1] == kept[:-1]
    for frame, other in zip(kept, [*frames_at(film, wanted), *frames_at(film, [3.1])], strict=True):
        assert np.abs(colour_of(frame) - colour_of(other)).max() < 4
