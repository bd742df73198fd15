"""Scenes that are too long for one question, cut into portions where sentences end."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

from planner_service.extraction.text import Line, TextScene

MAX_PIECE_LENGTH: Final = 6000
"""Letters of a text that one question shows."""
_MAX_PLACE_LENGTH: Final = 200
_ROUND_A_LINE: Final = 3
"""Quotation marks, and the blank before the next line."""
_SENTENCE_END: Final = re.compile(r"[.!?…]+[\"”’»)\]]*\s|[。！？]+[」』”]*")


def shown(scene: TextScene) -> str:
    """A scene as a model sees it: where, what is told, and what is said in quotation marks, in its order."""
    words = " ".join(f'"{line.text}"' if line.spoken else line.text for line in scene.lines)
    return f"{_where(scene)}{words}"


def portions_of(scenes: Sequence[TextScene]) -> tuple[tuple[TextScene, ...], tuple[str, ...]]:
    """The scenes, those that one question cannot hold as several, and a note for each of these; no word is lost."""
    cut: list[TextScene] = []
    notes: list[str] = []
    for scene in scenes:
        if len(shown(scene)) <= MAX_PIECE_LENGTH:
            cut.append(scene)
            continue
        first = len(cut) + 1
        cut += [replace(scene, lines=lines) for lines in _packed(scene)]
        notes.append(f"scenes {first} to {len(cut)}: are one of {len(shown(scene)):,} letters, cut where sentences end")
    return tuple(cut), tuple(notes)


def _where(scene: TextScene) -> str:
    return f"{scene.place[:_MAX_PLACE_LENGTH]}: " if scene.place else ""


def _packed(scene: TextScene) -> Iterator[tuple[Line, ...]]:
    """Its lines, as many together as one question holds."""
    most = MAX_PIECE_LENGTH - len(_where(scene))
    packed: list[Line] = []
    letters = 0
    for line in scene.lines:
        for text in _fitting(line.text, most - _ROUND_A_LINE):
            size = len(text) + _ROUND_A_LINE
            if packed and letters + size > most:
                yield tuple(packed)
                packed, letters = [], 0
            packed.append(line._replace(text=text))
            letters += size
    if packed:
        yield tuple(packed)


def _fitting(text: str, most: int) -> Iterator[str]:
    """The text in parts of at most so many letters: whole sentences, else whole words, else letters."""
    while len(text) > most:
        head = text[:most]
        end = max((match.end() for match in _SENTENCE_END.finditer(head)), default=0) or head.rfind(" ") + 1 or most
        yield text[:end].rstrip()
        text = text[end:].lstrip()
    yield text
