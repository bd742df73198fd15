"""Opening a film file so that nothing but its own bytes is read: known containers, known codecs, no references."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Final, NoReturn

from scene_graphs.errors import UserError

if TYPE_CHECKING:
    from av.container import InputContainer

INSTALL: Final = 'pip install "sims-stories[video]"'
READ: Final = "MP4, MOV, MKV, WebM, AVI or MPEG-TS"
CODECS: Final = (
    *("h264", "hevc", "vp8", "vp9", "libvpx", "libvpx-vp9", "av1", "libdav1d", "libaom-av1", "mpeg4", "mpeg2video"),
    *("mpeg1video", "mjpeg", "msmpeg4v3", "msmpeg4", "h263", "prores", "theora", "dnxhd", "rawvideo", "ffv1"),
)
"""Decoders of pictures that are let near a file."""
SOUNDS: Final = (
    *("aac", "mp3", "mp3float", "opus", "libopus", "vorbis", "ac3", "eac3", "flac", "alac", "mp2", "mp2float"),
    *("pcm_s16le", "pcm_s16be", "pcm_s24le", "pcm_f32le", "pcm_u8", "dca", "truehd"),
)
TEXTS: Final = ("mov_text", "subrip", "srt", "ass", "ssa", "webvtt", "text")
"""Decoders of subtitles that are letters, not pictures."""
_MAX_TRACKS: Final = 32
_PROBED: Final = 5_000_000
"""Bytes that are looked at to find out what the tracks are."""
_ATOMS: Final = (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip", b"pnot")
_PICTURES: Final = re.compile(rb"\A[^\n]*%\d{0,2}d[^\s]*\.[a-z]{3,4}[ \t\r]*(?:\n|\Z)", re.IGNORECASE)
_OTHERS: Final = (
    (b"#EXTM3U", "a playlist (HLS), which names other files"),
    (b"ffconcat", "a list of files for FFmpeg"),
    (b"[playlist]", "a playlist, which names other files"),
    (b"[Reference]", "a playlist (ASX), which names other files"),
    (b"<", "XML or HTML, perhaps a playlist (DASH, ASX) or a drawing (SVG)"),
    (b"v=0", "a session description (SDP), which names a stream"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\xff\xd8\xff", "a single JPEG picture"),
    (b"\x89PNG", "a single PNG picture"),
    (b"GIF8", "a GIF picture"),
    (b"ID3", "sound only (MP3)"),
    (b"fLaC", "sound only (FLAC)"),
    (b"WEBVTT", "subtitles (WebVTT)"),
)


class FilmError(UserError):
    """A file that cannot be read as a film; says what it is and what would be right."""


def container_of(head: bytes) -> str | None:
    """FFmpeg's name of the container that begins with these bytes (512 at least), None for anything that we refuse."""
    if head[4:8] in _ATOMS:
        return "mp4"
    if head.startswith(b"\x1aE\xdf\xa3"):
        return "matroska"
    if head.startswith(b"RIFF") and head[8:12] == b"AVI ":
        return "avi"
    if len(head) > 376 and head[0] == head[188] == head[376] == 0x47:
        return "mpegts"
    return None


def checked_container(head: bytes) -> str:
    """As `container_of`; FilmError says what the file seems to be instead."""
    form = container_of(head)
    if form is not None:
        return form
    if not head:
        raise FilmError("the file is empty", f"give {READ}", at="film")
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    told = next((what for sign, what in _OTHERS if text.startswith(sign)), None)
    if told is None and names_pictures(head):
        told = "a pattern of picture files"
    seems = f"it is {told}" if told else "its first bytes are those of no container that is read"
    raise FilmError(f"{seems}", f"give the film itself as {READ}", at="film")


def names_pictures(head: bytes) -> bool:
    """Whether a file begins with a name that counts pictures, as "frames/img%03d.png" does."""
    return _PICTURES.match(head.lstrip(b"\xef\xbb\xbf \t\r\n")[:400]) is not None


@contextmanager
def opened(source: Path | BinaryIO, form: str) -> Iterator[InputContainer]:
    """The container, opened on its own bytes only and closed at the end. FilmError for what cannot be opened.

    References of a MOV to other files are not followed, and no other file or address is opened.
    """
    av = load_av()
    file: Any = source.open("rb") if isinstance(source, Path) else source
    try:
        file.seek(0)
        try:
            container = av.open(
                file,
                format=form,
                metadata_errors="replace",
                io_open=_refuse,
                container_options={
                    "protocol_whitelist": "",
                    "codec_whitelist": ",".join((*CODECS, *SOUNDS, *TEXTS)),
                    "max_streams": str(_MAX_TRACKS),
                    "probesize": str(_PROBED),
                    **({"enable_drefs": "0", "use_absolute_path": "0"} if form == "mp4" else {}),
                },
            )
        except (av.FFmpegError, ValueError, OSError) as error:
            raise FilmError(f"it is cut off or damaged ({said(error)})", f"give a whole {READ}", at="film") from error
        try:
            yield container
        finally:
            container.close()
    finally:
        if isinstance(source, Path):
            file.close()


def size_of(source: Path | BinaryIO) -> int:
    """Bytes of a file. FilmError for what is no file that can be read and wound back."""
    if isinstance(source, Path):
        if not source.exists():
            raise FilmError(f"there is no file {source.name}", at="film")
        if not source.is_file():
            raise FilmError(f"{source.name} is no file", f"give {READ}", at="film")
        return source.stat().st_size
    if not source.seekable():
        raise FilmError("it cannot be wound back", "give a file, not a stream", at="film")
    return source.seek(0, os.SEEK_END)


def load_av() -> Any:
    """The library that reads films. FilmError where it is not installed."""
    if find_spec("av") is None:
        raise FilmError(f"reading films needs a library that is not installed: {INSTALL}", at="film")
    import av

    return av


def said(error: Exception) -> str:
    """What FFmpeg says, without file names and numbers of ours."""
    return str(getattr(error, "strerror", None) or type(error).__name__)[:100]


def _refuse(url: str, _flags: int, _options: object) -> NoReturn:
    raise PermissionError(f"another file is not opened: {url[:100]!r}")
