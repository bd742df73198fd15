"""Other words for captions, written by a language model: five a caption (LINGO B.1.6)."""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pydantic import BaseModel

import prompts
from motion_backend.motion import RISINGS, Skill
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.llm.structured_output import ask
from planner_service.scripts.captions import sides, synonyms
from planner_service.scripts.script_library import LibraryError

Synonyms = dict[str, dict[str, list[str]]]
"""By skill and caption."""
FILE: Final = "caption_synonyms.json"
MAX_LETTERS: Final = 200
MAX_QUESTIONS: Final = 3
"""About one batch of captions."""
MAX_SYNONYM_BYTES: Final = 8_000_000
"""Bytes of a file of synonyms."""
_BATCH: Final = 12
_NONE: Final = "no side"
_LEFT_RIGHT: Final = re.compile(r"\b(left|right)\b")
_MOTIONS: Final = {
    Skill.LOCO: r"walk|run|ran|strid|stroll|march|pac(?:e|ing)|skip|danc|tiptoe|shuffl",
    Skill.SITDOWN: r"sit|sat|seat",
    Skill.STANDUP: r"stand(?:s|ing)? up|stood up|rise|rising",
    Skill.LIEDOWN: r"lies?\b|lying",
    Skill.GETUP: r"get(?:s|ting)? up",
}


class Phrases(BaseModel):
    """Other words for one caption, as a model writes them."""

    number: int
    phrases: list[str]


class Phrasings(BaseModel):
    """The answer to `prompts/rephrase_captions.md`."""

    captions: list[Phrases]


@dataclass(frozen=True)
class Rephrased:
    """What came of it; none of it is stored yet."""

    synonyms: Synonyms
    """Only captions for which there are as many as were wished for."""
    missing: tuple[str, ...]
    """Captions for which the model gave too few."""
    notes: tuple[str, ...]


def rephrase(
    model: LanguageModel, captions: Mapping[str, Sequence[str]], known: Collection[str], count: int = 5
) -> Rephrased:
    """`count` other ways to say each caption, by skill; `known` are all captions there are, none of which they may be.

    What is missing of a batch is asked for again, at most MAX_QUESTIONS times. ModelError when nothing can be used.
    """
    taken = {_plain(caption) for caption in known} | {_plain(one) for some in captions.values() for one in some}
    made: Synonyms = {}
    missing: list[str] = []
    notes: list[str] = []
    for skill, batch in _batches(captions):
        if notes:
            missing += batch
            continue
        found: dict[str, list[str]] = {caption: [] for caption in batch}
        try:
            _fill(model, skill, found, taken, count)
        except ModelError as error:
            notes.append(f"asked no further: {error}")
            if not made and not any(len(phrases) == count for phrases in found.values()):
                raise
        for caption, phrases in found.items():
            if len(phrases) == count:
                made.setdefault(skill, {})[caption] = phrases
            else:
                missing.append(caption)
    return Rephrased(made, tuple(missing), tuple(notes))


def fault_of(phrase: str, caption: str, skill: str) -> str | None:
    """Why a phrase cannot stand for a caption of a skill; None where nothing speaks against it."""
    if not 0 < len(phrase) <= MAX_LETTERS:
        return f"{len(phrase)} letters, it must have 1 to {MAX_LETTERS}"
    if not phrase.isprintable() or not re.search(r"[^\W\d_]", phrase):
        return "it is no plain text"
    if _told(phrase) != _told(caption) and (_told(phrase), _told(caption)) != ("both", _NONE):
        return f"it names {_told(phrase)}, the caption {_told(caption)}"
    for other, words in _MOTIONS.items():
        said = re.compile(rf"\b(?:{words})", re.IGNORECASE)
        may = other == skill or (skill in RISINGS and other is not Skill.LOCO)
        if not may and said.search(phrase) and not said.search(caption):
            return f"it tells of {other}"
    return None


def read_synonyms(file: Path) -> Synonyms:
    """The synonyms of a file; none where there is no file. LibraryError for one that is not of this kind."""
    if not file.exists():
        return {}
    try:
        if file.stat().st_size > MAX_SYNONYM_BYTES:
            raise ValueError(f"it has more than {MAX_SYNONYM_BYTES} bytes")
        rows = json.loads(file.read_text(encoding="utf-8"))
        return {
            str(skill): {str(caption): [str(phrase) for phrase in phrases] for caption, phrases in said.items()}
            for skill, said in rows.items()
        }
    except (OSError, ValueError, AttributeError, TypeError, RecursionError) as error:
        why = f"it is not {{skill: {{caption: [phrases]}}}} ({error}); mend it or move it away"
        raise LibraryError(f"{file.name}: {why}") from error


def all_synonyms(file: Path) -> Synonyms:
    """Those that are shipped and, behind them for each caption, those of a user's file. LibraryError."""
    merged = {skill: {caption: list(some) for caption, some in said.items()} for skill, said in synonyms().items()}
    for skill, said in read_synonyms(file).items():
        for caption, phrases in said.items():
            there = merged.setdefault(skill, {}).setdefault(caption, [])
            there += [phrase for phrase in phrases if phrase not in there]
    return merged


def write_synonyms(file: Path, more: Synonyms) -> Synonyms:
    """Put synonyms beside those of the file, in the place of those for the same caption; the file changes at once."""
    kept = read_synonyms(file)
    merged = {skill: kept.get(skill, {}) | more.get(skill, {}) for skill in sorted(kept.keys() | more.keys())}
    file.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".writing-", dir=file.parent) as aside:
        new = Path(aside) / file.name
        new.write_text(json.dumps(merged, indent=2, ensure_ascii=False, sort_keys=True) + "\n", encoding="utf-8")
        new.replace(file)
    return merged


def _batches(captions: Mapping[str, Sequence[str]]) -> Iterator[tuple[str, Sequence[str]]]:
    for skill, some in captions.items():
        for start in range(0, len(some), _BATCH):
            yield skill, some[start : start + _BATCH]


def _fill(model: LanguageModel, skill: str, found: dict[str, list[str]], taken: set[str], count: int) -> None:
    """Ask until every caption has its phrases, or often enough."""
    refused: list[str] = []
    for _ in range(MAX_QUESTIONS):
        wanting = [caption for caption, phrases in found.items() if len(phrases) < count]
        if not wanting:
            return
        prompt = prompts.render(
            "rephrase_captions",
            count=str(count),
            skill=skill,
            captions="\n".join(f"{number}. {caption}" for number, caption in enumerate(wanting)),
            before="\n".join(refused) or "none yet",
        )
        answer = ask(model, prompt, Phrasings, repairs=1)
        refused = []
        for one in answer.captions[: 2 * len(wanting)]:
            if 0 <= one.number < len(wanting):
                caption = wanting[one.number]
                refused += _take(one.phrases, caption, skill, found[caption], taken, count)


def _take(
    phrases: Sequence[str], caption: str, skill: str, kept: list[str], taken: set[str], count: int
) -> Iterator[str]:
    """Keep what can be used, and tell why the rest cannot."""
    for raw in phrases[: 2 * count]:
        phrase = " ".join(raw.split())
        fault = fault_of(phrase, caption, skill) or ("it is there already" if _plain(phrase) in taken else None)
        if fault is not None:
            yield f"- {phrase[:MAX_LETTERS]} (for: {caption}): {fault}"
        elif len(kept) < count:
            kept.append(phrase)
            taken.add(_plain(phrase))


def _told(text: str) -> str:
    """The sides that a text names, in the order of left and right, so that two hands do not change places."""
    both = ["both"] if "both" in sides(text) else []
    return " and ".join([*both, *dict.fromkeys(_LEFT_RIGHT.findall(text.lower()))]) or _NONE


def _plain(text: str) -> str:
    return " ".join(re.findall(r"\w+", text.casefold()))
