"""A library of short scripts, and the sentence features by which one is found by its meaning (SIMS 3.2).

How well each answers a query is a matter of `script_search`; a selection names emotion, room, furniture, source and
licence.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from threading import RLock
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.language.sentence_encoder import CachedEncoder, SentenceEncoder, Vectors
from motion_backend.motion import Emotion, Skill
from planner_service.scripts.built_in_scripts import texts_of
from planner_service.scripts.keyword_index import KeywordIndex
from planner_service.scripts.script import EMOTIONS, ShortScript
from planner_service.scripts.script_embeddings import load_by_heart
from planner_service.scripts.script_search import Found, Scores, rank
from scene_graphs.errors import UserError
from scene_graphs.furniture import ROOM_TYPES, canonical_room, categories_of, is_known


class LibraryError(UserError):
    """A short script cannot be read, kept or found; the text names the field."""


class Features:
    """Vectors of sentences, each made once though several threads ask, and shared by libraries that follow each other.

    An encoder is loaded when the first vector is asked for and none was given; a `cache` folder keeps what it made.
    """

    def __init__(self, encoder: SentenceEncoder | None = None, cache: Path | None = None) -> None:
        self._encoder, self._cache = encoder, cache
        self._rows: dict[str, Vectors] = {}
        self._lock = RLock()

    @property
    def encoder(self) -> SentenceEncoder:
        """What turns texts into vectors here."""
        with self._lock:
            if self._encoder is None:
                self._encoder = load_by_heart(self._cache)
            return self._encoder

    @cached_property
    def _remembering(self) -> SentenceEncoder:
        return CachedEncoder(self.encoder, self._cache) if self._cache else self.encoder

    def of(self, texts: Sequence[str]) -> Vectors:
        """One unit row a text, for texts that come back: what is said only once is for `encoder`. (N, D) float32."""
        with self._lock:
            new = [text for text in dict.fromkeys(texts) if text not in self._rows]
            made = self._remembering.encode(new) if new or not texts else ()
            self._rows.update(zip(new, made, strict=True))
            return np.stack([self._rows[text] for text in texts]) if texts else np.asarray(made)


class ScriptLibrary:
    """Short scripts with unique ids, and the sentence features by which they are found."""

    def __init__(self, scripts: Iterable[ShortScript], features: Features | None = None) -> None:
        self.scripts = tuple(scripts)
        self.features = features or Features()
        self._by_id = {script.id: script for script in self.scripts}
        if len(self._by_id) < len(self.scripts):
            twice = next(one.id for one in self.scripts if self._by_id[one.id] is not one)
            raise LibraryError(f"two short scripts are called {twice!r}", at="id")

    @property
    def encoder(self) -> SentenceEncoder:
        """What turns texts into vectors here."""
        return self.features.encoder

    def __len__(self) -> int:
        return len(self.scripts)

    def get(self, script_id: str) -> ShortScript:
        """The script of that id, or LibraryError."""
        if script_id not in self._by_id:
            raise LibraryError(f"there is no short script {script_id!r} among the {len(self)} of the library", at="id")
        return self._by_id[script_id]

    def find(self, script_id: str) -> ShortScript | None:
        """The script of that id, or None."""
        return self._by_id.get(script_id)

    def search(
        self,
        query: str,
        k: int = 5,
        emotion: str | None = None,
        room: str | None = None,
        furniture: Sequence[str] = (),
    ) -> tuple[Found, ...]:
        """The k scripts that answer the query best, best first and by id among equals.

        Only those of one emotion, in one room and with all of this furniture, where these are given.
        """
        if k < 1 or not query.strip():
            raise LibraryError("ask for at least one script, with at least one word", at="query")
        fitting = np.flatnonzero(self.fitting(emotion, room, furniture))
        scores = rank([query], self)[0][fitting]
        order = np.lexsort((self._by_name[fitting], -scores))[:k]
        return tuple(Found(self.scripts[fitting[place]], float(scores[place])) for place in order)

    def fitting(
        self, emotion: str | None = None, room: str | None = None, furniture: Sequence[str] = ()
    ) -> NDArray[np.bool_]:
        """Which scripts are of that emotion, in that room and use all of that furniture. (scripts,)."""
        if emotion is not None and emotion not in EMOTIONS:
            raise LibraryError(f"{emotion!r} is none of {', '.join(EMOTIONS)}", at="emotion")
        if room is not None and canonical_room(room) not in ROOM_TYPES:
            raise LibraryError(f"{room!r} is none of {', '.join(ROOM_TYPES)}", at="room")
        mask = np.ones(len(self), dtype=np.bool_)
        if emotion is not None:
            mask &= self.emotions == EMOTIONS.index(emotion)
        if room is not None:
            mask &= self.rooms == ROOM_TYPES.index(canonical_room(room))
        for word in furniture:
            if not is_known(word):
                raise LibraryError(
                    f"{word!r:.80} is not known", "say for example bed, sofa, desk or wardrobe", at="furniture"
                )
            mask &= self._using(categories_of(word))
        return mask

    @cached_property
    def emotions(self) -> NDArray[np.intp]:
        """The place of each script's emotion in `EMOTIONS`. (scripts,)."""
        return np.array([EMOTIONS.index(script.emotion) for script in self.scripts], np.intp)

    @cached_property
    def captions(self) -> Mapping[tuple[Emotion, Skill, str], Sequence[int]]:
        """The places of the scripts that have a caption, by the script's emotion, the keyframe's skill, and it."""
        found: dict[tuple[Emotion, Skill, str], list[int]] = {}
        for place, one in enumerate(self.scripts):
            for key in {(one.emotion, row.skill, row.caption) for row in one.keyframes}:
                found.setdefault(key, []).append(place)
        return found

    @cached_property
    def rooms(self) -> NDArray[np.intp]:
        """The place of each script's room in `ROOM_TYPES`. (scripts,)."""
        return np.array([ROOM_TYPES.index(script.room) for script in self.scripts], np.intp)

    def _using(self, categories: Iterable[str]) -> NDArray[np.bool_]:
        """Scripts with furniture of any of these categories. (scripts,)."""
        mask = np.zeros(len(self), dtype=np.bool_)
        for category in categories:
            mask[self._users.get(category, [])] = True
        return mask

    @cached_property
    def _users(self) -> dict[str, list[int]]:
        """The scripts that use furniture of a category."""
        users: dict[str, list[int]] = {}
        for index, script in enumerate(self.scripts):
            words = {keyframe.piece[0] for keyframe in script.keyframes if not keyframe.on_floor}
            for category in {category for word in words for category in categories_of(word)}:
                users.setdefault(category, []).append(index)
        return users

    @cached_property
    def _by_name(self) -> NDArray[np.intp]:
        """The place of each script among all in the order of ids."""
        places = np.empty(len(self), dtype=np.intp)
        places[sorted(range(len(self)), key=lambda index: self.scripts[index].id)] = np.arange(len(self))
        return places

    def scores(self, vectors: NDArray[np.float32]) -> Scores:
        """How near each script is to each vector of `encoder`: by summary, sentence or cue. (N, scripts).

        Rounded to 1e-4, so that another machine ranks alike.
        """
        rows, places, owners = self._features
        near = (vectors @ rows.T)[:, places]  # (N, texts)
        best: Scores = np.maximum.reduceat(near, owners, axis=1).astype(np.float64)
        return best.round(4)

    def summaries(self, indices: Sequence[int]) -> NDArray[np.float32]:
        """Vectors of these scripts' summaries. (N, D)."""
        return self.features.of([self.scripts[index].summary for index in indices])

    @cached_property
    def keywords(self) -> KeywordIndex:
        """The words of each script's summary and cues."""
        return KeywordIndex([" ".join((script.summary, *script.cues)) for script in self.scripts])

    @cached_property
    def _features(self) -> tuple[Vectors, NDArray[np.intp], NDArray[np.intp]]:
        """A vector for each distinct text; which of them each text of a script is; and where scripts begin."""
        distinct: dict[str, int] = {}
        places: list[int] = []
        owners: list[int] = []
        for script in self.scripts:
            owners.append(len(places))
            places += [distinct.setdefault(text, len(distinct)) for text in texts_of(script)]
        return self.features.of(list(distinct)), np.array(places, np.intp), np.array(owners, np.intp)


UNKNOWN: Final = "unknown"
"""The licence of what nobody knows the licence of."""
FOUND: Final = frozenset({"video", "text"})
"""Sources that are works of others."""


@dataclass(frozen=True)
class Choice:
    """What a short script must be; what is left out does not matter."""

    emotion: str | None = None
    room: str | None = None
    furniture: tuple[str, ...] = ()
    """It uses all of these."""
    source: str | None = None
    licence: str | None = None

    def of(self, library: ScriptLibrary) -> tuple[ShortScript, ...]:
        """Those of a library, in its order. LibraryError for a word that is not known."""
        fitting = np.flatnonzero(library.fitting(self.emotion, self.room, self.furniture))
        return tuple(script for index in fitting if self._allows(script := library.scripts[index]))

    def search(self, library: ScriptLibrary, query: str, k: int) -> tuple[Found, ...]:
        """The k of them that are nearest to the query in meaning, nearest first. LibraryError."""
        everything = self.source is not None or self.licence is not None
        found = library.search(query, len(library) if everything else k, self.emotion, self.room, self.furniture)
        return tuple(one for one in found if self._allows(one.script))[:k]

    def _allows(self, script: ShortScript) -> bool:
        return self.source in (None, script.source) and self.licence in (None, script.licence)


def unlicensed(script: ShortScript) -> bool:
    """Whether somebody else's work comes without a word on its licence."""
    return script.source in FOUND and "licence" not in script.model_fields_set


def unknown_licences(scripts: Iterable[ShortScript]) -> tuple[str, ...]:
    """Ids of scripts of which nobody knows whether they may be passed on."""
    return tuple(script.id for script in scripts if script.licence.strip().lower() == UNKNOWN)
