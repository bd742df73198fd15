"""A text file to text that is safe to read on: no control characters, bounded, in a language we can tell."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path
from typing import BinaryIO, Final

from planner_service.extraction.decoding import decode

MAX_TEXT_LENGTH: Final = 200_000
"""Letters of one text: about 35,000 words."""
MAX_BYTES: Final = 4 * MAX_TEXT_LENGTH
"""No text of that many letters has more in UTF-8 or UTF-16."""
ENGLISH: Final = "English"
_KEPT: Final = "\n\t"
_BREAKS: Final = str.maketrans({"\r": "\n", "\f": "\n\n", "\v": "\n", "\x85": "\n", "\u2028": "\n", "\u2029": "\n\n"})
_HIDDEN: Final = ("Cc", "Cf", "Cs", "Co")
_MAX_HIDDEN: Final = 0.01
"""Share of control characters above which bytes are no text."""
_COMMON_WORDS: Final = {
    ENGLISH: "the and to of a in he she it is was his her on with that for at they their up from as into then not i",
    "German": "der die das und ist nicht ein eine einen sie er sich auf mit den dem zu im von es war ich",
    "French": "le la les et un une est elle il dans sur des du pas que qui se au son sa avec je",
    "Spanish": "el la los las y un una es en ella él se que de con su por al del lo",
    "Italian": "il la lo e un una è lei lui si che di con per nel sul della suo sua",
    "Portuguese": "o a os as e um uma é em ela ele se que de com seu sua no na do da",
    "Dutch": "de het een en is niet zij hij ze op met van te in zich naar haar zijn dat",
}
_FEW: Final = 8
"""Words below which nobody can tell a language."""
_MIN_ENGLISH: Final = 0.1
"""English prose has every third of its words among ours."""


class ExtractionError(ValueError):
    """A film, text or subtitle file that nothing can be extracted from; the text says why, and what would help."""


def read_text(data: bytes, name: str) -> tuple[str, tuple[str, ...]]:
    """The text of a file, and what was guessed about it.

    ExtractionError for what is no text, has no word in it, or is longer than `MAX_TEXT_LENGTH` letters.
    """
    if len(data) > MAX_BYTES:
        raise too_long(name, f"more than {MAX_BYTES:,} bytes")
    if not data.strip():
        raise ExtractionError(f"{name}: is empty; give a text, subtitles or a film")
    decoded = decode(data)
    return tidy(decoded.text, name), (f"{name}: {decoded.note}",) if decoded.note else ()


def first_bytes(file: Path | BinaryIO, name: str, most: int) -> bytes:
    """The first bytes of a file. ExtractionError for what cannot be read."""
    if not isinstance(file, Path):
        file.seek(0)
        return file.read(most)
    if file.is_dir():
        raise ExtractionError(f"{name}: is a folder; give a text, subtitles or a film")
    try:
        with file.open("rb") as stream:
            return stream.read(most)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise ExtractionError(f"{name}: cannot be read: {why}; give a text, subtitles or a film") from error


def tidy(text: str, name: str) -> str:
    """A text without control characters and with one kind of line end. ExtractionError as for `read_text`."""
    text = text.replace("\r\n", "\n").translate(_BREAKS)
    if len(text) > MAX_TEXT_LENGTH:
        raise too_long(name, f"{len(text):,} letters")
    shown = "".join(letter for letter in text if letter in _KEPT or unicodedata.category(letter) not in _HIDDEN)
    if len(text) - len(shown) > _MAX_HIDDEN * len(text) + 8:
        raise ExtractionError(f"{name}: is no text (control characters in it); give a text, subtitles or a film")
    if not any(letter.isalpha() for letter in shown):
        raise ExtractionError(f"{name}: there is no word in it; give a text in which somebody does something")
    return shown


def too_long(name: str, size: str) -> ExtractionError:
    """The error for a text of that size."""
    return ExtractionError(
        f"{name}: has {size}; at most {MAX_TEXT_LENGTH:,} letters are read at once, so cut it into chapters"
    )


def language_of(text: str) -> str:
    """English, another language by name, or "another language", judged by common words; English when in doubt."""
    letters = [letter for letter in text[:20_000] if letter.isalpha()]
    if letters and sum(letter > "\u024f" for letter in letters) > len(letters) / 2:
        return "another language"
    words = re.findall(r"[^\W\d_]+", text[:20_000].lower())
    if len(words) < _FEW:
        return ENGLISH
    shares = {
        name: sum(word in common for word in words) / len(words)
        for name, common in ((name, frozenset(known.split())) for name, known in _COMMON_WORDS.items())
    }
    best = max(shares, key=lambda name: shares[name])
    if shares[best] < _MIN_ENGLISH:
        return "another language" if len(words) >= 3 * _FEW else ENGLISH
    return ENGLISH if shares[ENGLISH] >= shares[best] else best
