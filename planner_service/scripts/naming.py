"""Ids of short scripts: the telling words of a summary, unlike all ids that are taken."""

from __future__ import annotations

import hashlib
import re
import unicodedata
from collections.abc import Collection
from typing import Final

_WORDS: Final = 6
_MAX_NAME_LENGTH: Final = 70
_PALE_WORDS: Final = "the character a an and their is are of to in on at for with from it they then them has"
_PALE: Final = frozenset(_PALE_WORDS.split())


def slug_of(summary: str, name: str, taken: Collection[str], first: str = "") -> str:
    """An id of the summary's telling words, behind a `first` one if that is given; numbered where it is taken.

    `name`, of a film or text, tells summaries apart that have no Latin letter.
    """
    plain = unicodedata.normalize("NFKD", summary).encode("ascii", "ignore").decode().lower().replace("'", "")
    words = [word for word in re.findall(r"[a-z0-9]+", plain) if word not in _PALE][:_WORDS]
    words = words or ["scene", hashlib.sha256(f"{name}{summary}".encode()).hexdigest()[:8]]
    slug = "-".join(filter(None, (first, *words)))[:_MAX_NAME_LENGTH].strip("-")
    names = (slug if number == 1 else f"{slug}-{number}" for number in range(1, len(taken) + 2))
    return next(one for one in names if one not in taken)
