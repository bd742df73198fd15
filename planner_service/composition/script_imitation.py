"""New short scripts that a language model writes in the manner of stored ones (SIMS 3.2).

What a language model is to imitate: the wish, and the stored short scripts that show the manner (SIMS 3.2).
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from random import Random
from typing import Final

import numpy as np
from pydantic import BaseModel, ValidationError

import prompts
from motion_backend.motion import Skill
from planner_service.composition.llm_planner import DirectKeyframe
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.llm.structured_output import ModelAnswerError, ask, problems_of
from planner_service.scripts.captions import Vocabulary
from planner_service.scripts.script import EMOTIONS, MAX_PIECES, Keyframe, Origin, ShortScript
from planner_service.scripts.script_duplicates import Likeness, slug_of
from planner_service.scripts.script_library import UNKNOWN, Choice, LibraryError, ScriptLibrary
from planner_service.scripts.script_repair import read_keyframe, repair
from planner_service.scripts.script_words import is_floor
from scene_graphs.furniture import ROOM_TYPES, categories_of, display_name, is_known

MAX_WANTED: Final = 20
_EXAMPLES: Final = 5
_MIN_EXAMPLES: Final = 3
"""Examples below which those of another room, then of another emotion, are taken as well."""
_FROM: Final = 200
"""Scripts among which the examples are chosen."""


@dataclass(frozen=True)
class Wish:
    """What is to be imitated: so many scripts of an emotion in a room with this furniture. LibraryError."""

    emotion: str
    room: str
    count: int
    furniture: tuple[str, ...]

    def __post_init__(self) -> None:
        if self.emotion not in EMOTIONS:
            raise LibraryError(f"{self.emotion!r:.80} is none of {', '.join(EMOTIONS)}", at="emotion")
        if self.room not in ROOM_TYPES:
            raise LibraryError(f"{self.room!r:.80} is none of {', '.join(ROOM_TYPES)}", at="room")
        if not 1 <= self.count <= MAX_WANTED:
            raise LibraryError(f"{self.count} cannot be imitated at once", f"ask for 1 to {MAX_WANTED}", at="count")
        strange = [word for word in self.furniture if not is_known(word)]
        if strange or not self.furniture:
            said = f"{strange[0]!r:.80} is not known" if strange else "nothing to play with"
            raise LibraryError(f"{said}", "name pieces such as bed, sofa, desk or wardrobe", at="furniture")

    @property
    def categories(self) -> frozenset[str]:
        """Of furniture that may be used."""
        return frozenset().union(*(categories_of(word) for word in self.furniture))


def examples(library: ScriptLibrary, wish: Wish, seed: int) -> tuple[ShortScript, ...]:
    """Three to five stored scripts of the emotion and room, as unlike each other as they are; others where these lack.

    The seed draws the first; each further one is the one whose summary is farthest from those chosen.
    """
    found: dict[str, ShortScript] = {}
    for choice in (Choice(wish.emotion, wish.room), Choice(wish.emotion), Choice(room=wish.room), Choice()):
        if len(found) < _MIN_EXAMPLES:
            found |= {script.id: script for script in choice.of(library)}
    if not found:
        raise LibraryError("there is no short script to imitate", "add one first", at="library")
    draw = Random(seed)
    ids = sorted(found)
    pool = [found[one] for one in (draw.sample(ids, _FROM) if len(ids) > _FROM else ids)]
    vectors = library.features.of([script.summary for script in pool])
    near = np.round(vectors @ vectors.T, 4)
    chosen = [draw.randrange(len(pool))]
    while len(chosen) < min(_EXAMPLES, len(pool)):
        closest = near[:, chosen].max(axis=1)
        closest[chosen] = np.inf
        chosen.append(int(closest.argmin()))
    return tuple(pool[index] for index in chosen)


Captions = Mapping[str, Mapping[str, Sequence[str]]]
MAX_QUESTIONS: Final = 4
"""How often a model is asked, its one second try at each question not counted."""
_MIN_KEYFRAMES: Final = 2
_MIN_SUMMARY_LENGTH: Final = 20
"""Letters of a summary by which something can be found."""
_MAX_KEYFRAMES: Final = 12
"""Asked for; up to MAX_PIECES are taken."""
_SHOWN: Final = 12
"""Refused scripts that a model is told of."""


class WrittenScript(BaseModel):
    """One short script as a model writes it."""

    summary: str
    keyframes: list[DirectKeyframe]


class WrittenScripts(BaseModel):
    """The answer to `prompts/imitate_scripts.md`."""

    scripts: list[WrittenScript]


@dataclass(frozen=True)
class Refused:
    """A script that a model wrote and that cannot be used."""

    summary: str
    why: str


@dataclass(frozen=True)
class Imitated:
    """What came of it; none of it is stored yet."""

    scripts: tuple[ShortScript, ...]
    refused: tuple[Refused, ...]
    notes: tuple[str, ...]
    """What was repaired, and what is missing and why."""


class _Unfit(ValueError):  # noqa: N818
    """Why a script of a model cannot be used."""


@dataclass
class _Desk:
    """The scripts that were written so far."""

    model: LanguageModel
    wish: Wish
    like: tuple[ShortScript, ...]
    vocabulary: Vocabulary
    likeness: Likeness
    taken: set[str]
    scripts: list[ShortScript] = field(default_factory=list)
    refused: list[Refused] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def missing(self) -> int:
        return self.wish.count - len(self.scripts)

    def read(self, written: WrittenScript) -> None:
        """Keep one script, or note why not."""
        try:
            script, repairs = _script(written, self.wish, self.vocabulary)
            if (twin := self.likeness.twin(script)) is not None:
                raise _Unfit(f"it is like {twin.script_id}: {twin.why}")
        except _Unfit as reason:
            self.refused.append(Refused(" ".join(written.summary.split())[:400], str(reason)))
            return
        name, like = self.model.name, [one.id for one in self.like]
        script = script.model_copy(
            update={
                "id": slug_of(script.summary, name, self.taken, self.wish.emotion),
                "licence": _licence(self.like),
                "origin": Origin.model_validate({"name": name[:200], "by": f"llm:{name}"[:200], "like": like}),
            }
        )
        self.taken.add(script.id)
        self.likeness.add(script)
        self.scripts.append(script)
        self.notes += [f"{script.id}: {line}" for line in repairs]


def imitate(model: LanguageModel, library: ScriptLibrary, wish: Wish, captions: Captions, seed: int = 0) -> Imitated:
    """Short scripts like stored ones of an emotion and room, valid, repaired and unlike all there are.

    `captions` are those that the body knows, by skill, each with other words for it; a model's own words become the
    nearest of them. What is missing is asked for again, at most MAX_QUESTIONS times; fewer than wished for are better
    than none. ModelError when nothing at all can be used.
    """
    like = examples(library, wish, seed)
    vocabulary = Vocabulary({skill: list(some) for skill, some in captions.items()}, captions, library.encoder)
    desk = _Desk(model, wish, like, vocabulary, Likeness(library), {script.id for script in library.scripts})
    questions = 0
    while desk.missing and questions < MAX_QUESTIONS:
        questions += 1
        try:
            answer = ask(model, _question(desk, captions), WrittenScripts, _some, repairs=1)
        except ModelError as error:
            if not desk.scripts:
                raise
            desk.notes.append(f"asked no further: {error}")
            break
        for written in answer.scripts[: 2 * desk.missing]:
            if desk.missing:
                desk.read(written)
    if not desk.scripts:
        raise ModelAnswerError(model.name, "short script", questions, [one.why for one in desk.refused[-_SHOWN:]])
    if desk.missing:
        made = f"{len(desk.scripts)} of {wish.count} short scripts after {questions} questions"
        desk.notes.append(f"{made}; {len(desk.refused)} were refused")
    return Imitated(tuple(desk.scripts), tuple(desk.refused), tuple(desk.notes))


def _some(answer: WrittenScripts) -> list[str]:
    return [] if answer.scripts else ["scripts: there is none"]


def _question(desk: _Desk, captions: Captions) -> str:
    wish = desk.wish
    written = [f"- {script.summary}" for script in desk.scripts]
    refused = [f"- refused ({one.why}): {one.summary}" for one in desk.refused[-_SHOWN:]]
    return prompts.render(
        "imitate_scripts",
        count=str(desk.missing),
        emotion=wish.emotion,
        room=display_name(wish.room),
        furniture=", ".join(sorted({display_name(word) for word in wish.furniture})),
        skills=", ".join(Skill),
        emotions=", ".join(EMOTIONS),
        most=str(_MAX_KEYFRAMES),
        captions="\n".join(f"{skill}: {'; '.join(known)}" for skill, known in captions.items()),
        examples="\n".join(map(_shown, desk.like)),
        before="\n".join([*written, *refused]) or "nothing",
    )


def _shown(script: ShortScript) -> str:
    """An example in the form of the answer."""
    keyframes = [keyframe.model_dump(mode="json") for keyframe in script.keyframes]
    return json.dumps({"summary": script.summary, "keyframes": keyframes}, ensure_ascii=False)


def _script(written: WrittenScript, wish: Wish, vocabulary: Vocabulary) -> tuple[ShortScript, tuple[str, ...]]:
    """A script as it can be acted out, and what was repaired; _Unfit says why it cannot be used."""
    summary = " ".join(written.summary.split())
    if not _MIN_SUMMARY_LENGTH <= len(summary) <= 400:
        raise _Unfit(f"summary: {len(summary)} letters, it must have {_MIN_SUMMARY_LENGTH} to 400")
    _refuse_count(len(written.keyframes), least=0)
    try:
        keyframes = [read_keyframe(keyframe.model_dump()) for keyframe in written.keyframes]
    except ValidationError as error:
        raise _Unfit(f"keyframes: {problems_of(error)[0]}") from error
    _refuse_strange(keyframes, wish.categories)
    kept, repairs = repair(keyframes, vocabulary)
    _refuse_strange(kept, wish.categories)
    _refuse_count(len(kept))
    if not any(keyframe.mood == wish.emotion for keyframe in kept):
        raise _Unfit(f"emotion: no keyframe is {wish.emotion}")
    row = {"id": "unnamed", "summary": summary, "emotion": wish.emotion, "room": wish.room, "keyframes": kept}
    return ShortScript.model_validate({**row, "source": "imitation"}), repairs


def _refuse_count(keyframes: int, least: int = _MIN_KEYFRAMES) -> None:
    if not least <= keyframes <= MAX_PIECES:
        raise _Unfit(f"keyframes: {keyframes} of them, there must be {_MIN_KEYFRAMES} to {MAX_PIECES}")


def _refuse_strange(keyframes: Iterable[Keyframe], offered: Collection[str]) -> None:
    for index, keyframe in enumerate(keyframes):
        word = keyframe.piece[0]
        if not is_floor(word) and not categories_of(word) & set(offered):
            raise _Unfit(f"keyframes.{index}.furniture: {word!r:.60} is not there")


def _licence(like: Iterable[ShortScript]) -> str:
    """Of what imitates these: theirs where all have the same."""
    licences = {script.licence for script in like}
    return licences.pop() if len(licences) == 1 else UNKNOWN
