"""Bytes to text where nobody says which encoding they are in: UTF if they can be, else an honest guess.

A text file to text that is safe to read on: no control characters, bounded.
"""

from __future__ import annotations

import codecs
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Final

from scene_graphs.errors import UserError

_BOMS: Final = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_CANDIDATES: Final = ("cp1252", "cp1250", "cp1251", "cp1253", "cp1256", "shift_jis", "gb18030", "big5", "euc_kr")
"""Encodings that are tried for bytes that are no UTF-8, in the order in which they win a tie."""
_SAMPLE: Final = 4000
"""Letters beyond ASCII that are judged."""
_SURE: Final = 0.5
"""Mean worth of a letter below which a guess is called doubtful."""
_MARKS: Final = "’‘“”–—…«»¿¡♪、。！？"
_WESTERN: Final = "àáâãäåæçèéêëìíîïñòóôõöøùúûüýßœÀÉÈÊÇÄÖÜÅØÆÑÁÍÓÚ"
_COMMON: Final = frozenset(
    "的一是不了在人有我他这這个個们們中来來上大为為和国國地到以说說时時要就出会會可也你对對生能而子那得于於着著下自之年过過发發后後作里裡用道行所"
    "然家种種事成方多经經么麼去法学學如都同现現当當没沒动動面起看定天分还還进進好小部其些主样樣理心她本前开開但因只从從想实實"
)
_TWICE_ENCODED: Final = ("Ã©", "Ã¨", "Ã¤", "Ã¶", "Ã¼", "Ã±", "Ã¡", "Ã­", "Ã³", "â€™", "â€œ", "â€¦")


@dataclass(frozen=True)
class Decoded:
    """A text, the encoding it was read in, and what is doubtful about that."""

    text: str
    encoding: str
    note: str = ""
    """Empty where the encoding is certain."""


def decode(data: bytes) -> Decoded:
    """The text of the bytes, without a byte order mark. Never fails: what is no text at all has control characters."""
    for mark, encoding in _BOMS:
        if data.startswith(mark):
            text = data[len(mark) :].decode(encoding, errors="replace")
            broken = f"broken {encoding.upper()}: what could not be read is shown as \ufffd" if "\ufffd" in text else ""
            return Decoded(text, encoding, broken)
    if (encoding_of_zeros := _without_mark(data)) is not None:
        text = data.decode(encoding_of_zeros, errors="replace")
        return Decoded(text, encoding_of_zeros, f"no byte order mark: read as {encoding_of_zeros}, by its zero bytes")
    try:
        return _mended(data.decode("utf-8"))
    except UnicodeDecodeError:
        return _guessed(data)


def _without_mark(data: bytes) -> str | None:
    """UTF-16 of mostly Latin letters, whose every other byte is zero."""
    head = data[:4096]
    for encoding, zero in (("utf-16-le", 1), ("utf-16-be", 0)):
        if len(head) >= 8 and head[zero::2].count(0) > len(head) // 4 and head[1 - zero :: 2].count(0) == 0:
            return encoding
    return None


def _mended(text: str) -> Decoded:
    """UTF-8 that somebody took for cp1252 and encoded again is turned back, and that is told."""
    if sum(text.count(sign) for sign in _TWICE_ENCODED) >= 2:
        try:
            once = text.encode("cp1252").decode("utf-8")
        except UnicodeError:
            pass
        else:
            return Decoded(once, "utf-8", "its letters were encoded twice; turned back")
    return Decoded(text, "utf-8")


def _guessed(data: bytes) -> Decoded:
    """The candidate whose letters look most like words; latin-1, which takes any bytes, where none can read them."""
    best, worth = Decoded(data.decode("latin-1"), "latin-1"), float("-inf")
    for encoding in _CANDIDATES:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if (value := round(_worth(text), 4)) > worth:
            best, worth = Decoded(text, encoding), value
    doubt = "" if worth >= _SURE else " and a doubtful one"
    note = f"it is no UTF-8: read as {best.encoding}, which is a guess{doubt}; save it as UTF-8 if letters look wrong"
    return Decoded(best.text, best.encoding, note)


def _worth(text: str) -> float:
    """How much the letters beyond ASCII look like words, from about −2 to 1, on average."""
    values = list(_values(text))
    return sum(values) / max(1, len(values))


def _values(text: str) -> Iterator[float]:
    judged = 0
    for at, letter in enumerate(text):
        if letter < "\x80":
            continue
        judged += 1
        if judged > _SAMPLE:
            return
        yield _value(letter, text[at - 1] if at else " ", text[at + 1 : at + 2] or " ")


def _value(letter: str, before: str, after: str) -> float:
    """One letter by its neighbours: scripts do not mix in a word, and accents do not follow one another."""
    if not letter.isalpha():
        inside = before.isalpha() and after.isalpha() and letter not in "’–—"
        return 0.5 if letter in _MARKS and not inside else -1.0
    script = _script(letter)
    if any(other.isalpha() and _script(other) != script for other in (before, after)):
        return -2.0
    if script == "cjk":
        return 1.0 if letter in _COMMON or "ぁ" <= letter <= "ヺ" or "가" <= letter <= "힣" else 0.3
    if letter.isupper() and before.islower():
        return -1.0
    if script == "latin":
        accented = sum(other > "\x7f" and other.isalpha() for other in (before, after))
        return (1.0 if letter in _WESTERN else 0.8, 0.0, -1.0)[accented]
    return 1.0


def _script(letter: str) -> str:
    """latin, cyrillic, greek …; cjk for the writings of East Asia, but for halfwidth katakana, a usual error."""
    if letter < "\x80":
        return "latin"
    name = unicodedata.name(letter, "").partition(" ")[0].lower()
    return "cjk" if name in ("cjk", "hiragana", "katakana", "hangul", "katakana-hiragana") else name


MAX_TEXT_LENGTH: Final = 200_000
"""Letters of one text: about 35,000 words."""
MAX_BYTES: Final = 4 * MAX_TEXT_LENGTH
"""No text of that many letters has more in UTF-8 or UTF-16."""
_KEPT: Final = "\n\t"
_BREAKS: Final = str.maketrans({"\r": "\n", "\f": "\n\n", "\v": "\n", "\x85": "\n", "\u2028": "\n", "\u2029": "\n\n"})
_HIDDEN: Final = ("Cc", "Cf", "Cs", "Co")
_MAX_HIDDEN: Final = 0.01
"""Share of control characters above which bytes are no text."""


class ExtractionError(UserError):
    """A film, text or subtitle file that nothing can be extracted from; the text says why, and what would help."""


def read_text(data: bytes, name: str) -> tuple[str, tuple[str, ...]]:
    """The text of a file, and what was guessed about it.

    ExtractionError for what is no text, has no word in it, or is longer than `MAX_TEXT_LENGTH` letters.
    """
    if len(data) > MAX_BYTES:
        raise too_long(name, f"more than {MAX_BYTES:,} bytes")
    if not data.strip():
        raise ExtractionError(f"{name}: is empty", "give a text, subtitles or a film")
    decoded = decode(data)
    return tidy(decoded.text, name), (f"{name}: {decoded.note}",) if decoded.note else ()


def first_bytes(file: Path | BinaryIO, name: str, most: int) -> bytes:
    """The first bytes of a file. ExtractionError for what cannot be read."""
    if not isinstance(file, Path):
        file.seek(0)
        return file.read(most)
    if file.is_dir():
        raise ExtractionError(f"{name}: is a folder", "give a text, subtitles or a film")
    try:
        with file.open("rb") as stream:
            return stream.read(most)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise ExtractionError(f"{name}: cannot be read: {why}", "give a text, subtitles or a film") from error


def tidy(text: str, name: str) -> str:
    """A text without control characters and with one kind of line end. ExtractionError as for `read_text`."""
    text = text.replace("\r\n", "\n").translate(_BREAKS)
    if len(text) > MAX_TEXT_LENGTH:
        raise too_long(name, f"{len(text):,} letters")
    shown = "".join(letter for letter in text if letter in _KEPT or unicodedata.category(letter) not in _HIDDEN)
    if len(text) - len(shown) > _MAX_HIDDEN * len(text) + 8:
        raise ExtractionError(f"{name}: is no text (control characters in it)", "give a text, subtitles or a film")
    if not any(letter.isalpha() for letter in shown):
        raise ExtractionError(f"{name}: there is no word in it", "give a text in which somebody does something")
    return shown


def too_long(name: str, size: str) -> ExtractionError:
    """The error for a text of that size."""
    return ExtractionError(
        f"{name}: has {size}", f"at most {MAX_TEXT_LENGTH:,} letters are read at once, so cut it into chapters"
    )
