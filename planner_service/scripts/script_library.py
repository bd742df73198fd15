"""A library of short scripts, and the sentence features by which one is found by its meaning (SIMS 3.2).

How well each answers a query is a matter of `script_search`; a selection names emotion, room, furniture, source and
licence.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import log
from pathlib import Path
from threading import RLock
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.language.sentence_encoder import CachedEncoder, SentenceEncoder, Vectors
from planner_service.scripts.built_in_scripts import texts_of
from planner_service.scripts.emotion_classifier import MoodReader, lessons
from planner_service.scripts.script import EMOTIONS, ShortScript
from planner_service.scripts.script_embeddings import load_by_heart
from planner_service.scripts.script_search import Found, answers
from planner_service.scripts.suitability import Scores, Traits
from scene_graphs.errors import UserError
from scene_graphs.furniture import ROOM_TYPES, canonical_room, categories_of, is_known

_WORD: Final = re.compile(r"[^\W\d_]{3,}")
_ENDING: Final = re.compile(r"(?:ing|ed|es|s|ly)$")
_COMMON_WORDS: Final = """about all and are but character for from had has have her him his into its not out over she
than that the their them then they this too very was were what when who with"""
_COMMON: Final = frozenset(_COMMON_WORDS.split())


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

    @cached_property
    def traits(self) -> Traits:
        """What of every script counts besides its meaning."""
        return Traits(self.scripts)

    def search(
        self,
        query: str,
        k: int = 5,
        emotion: str | None = None,
        room: str | None = None,
        furniture: Sequence[str] = (),
    ) -> tuple[Found, ...]:
        """The k scripts that answer the query best: nearest in meaning, with feeling and furniture weighed in.

        Only those of one emotion, in one room and with all of this furniture, where these are given.
        """
        if k < 1 or not query.strip():
            raise LibraryError("ask for at least one script, with at least one word", at="query")
        fitting = np.flatnonzero(self.fitting(emotion, room, furniture))
        scores = answers(query, self)[fitting]
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
            mask &= self.traits.of_emotion(emotion)
        if room is not None:
            mask &= self.traits.in_rooms([canonical_room(room)])
        for word in furniture:
            if not is_known(word):
                raise LibraryError(
                    f"{word!r:.80} is not known", "say for example bed, sofa, desk or wardrobe", at="furniture"
                )
            mask &= self.traits.using(categories_of(word))
        return mask

    @cached_property
    def _by_name(self) -> NDArray[np.intp]:
        """The place of each script among all in the order of ids."""
        places = np.empty(len(self), dtype=np.intp)
        places[sorted(range(len(self)), key=lambda index: self.scripts[index].id)] = np.arange(len(self))
        return places

    def scores(self, vectors: NDArray[np.float32]) -> Scores:
        """How near each script is to each vector of `encoder`: by its summary, a sentence or caption. (N, scripts).

        Rounded to 1e-4, so that another machine ranks alike.
        """
        rows, places, weights, owners = self._features
        near = (vectors @ rows.T)[:, places] * weights  # (N, texts)
        best: Scores = np.maximum.reduceat(near, owners, axis=1).astype(np.float64)
        return best.round(4)

    def moods(self, vectors: Vectors) -> Scores:
        """How much each vector of `encoder` feels like each of `EMOTIONS`. (N, 9)."""
        return self._mood_reader.read(vectors)

    @cached_property
    def _mood_reader(self) -> MoodReader:
        texts, emotions = lessons(self.scripts)
        return MoodReader(self.features.of(texts), emotions)

    def summaries(self, indices: Sequence[int]) -> NDArray[np.float32]:
        """Vectors of these scripts' summaries. (N, D)."""
        return self.features.of([self.scripts[index].summary for index in indices])

    def sharing(self, text: str) -> Scores:
        """How much of a text's words each summary has, rare words for much more: 0 none, 1 all. (scripts,)."""
        shared = np.zeros(len(self))
        whole = 0.0
        for word in sorted(_words(text)):
            owners = self._owners.get(word, np.zeros(0, np.intp))
            rarity = log(1 + len(self) / max(1, len(owners))) ** 2
            whole += rarity
            shared[owners] += rarity
        return (shared / whole).round(4) if whole else shared

    @cached_property
    def _owners(self) -> dict[str, NDArray[np.intp]]:
        """The scripts whose summary has a word."""
        places: dict[str, list[int]] = {}
        for index, script in enumerate(self.scripts):
            for word in _words(script.summary):
                places.setdefault(word, []).append(index)
        return {word: np.array(owners, np.intp) for word, owners in places.items()}

    @cached_property
    def _features(self) -> tuple[Vectors, NDArray[np.intp], NDArray[np.float32], NDArray[np.intp]]:
        """A vector for each distinct text; for each text of a script which, and its weight; where scripts begin."""
        distinct: dict[str, int] = {}
        places: list[int] = []
        weights: list[float] = []
        owners: list[int] = []
        for script in self.scripts:
            owners.append(len(places))
            for text, weight in texts_of(script).items():
                places.append(distinct.setdefault(text, len(distinct)))
                weights.append(weight)
        rows = self.features.of(list(distinct))
        return rows, np.array(places, np.intp), np.array(weights, np.float32), np.array(owners, np.intp)


def _words(text: str) -> set[str]:
    """The words of three letters and more that tell something, without their endings."""
    found = set(_WORD.findall(text.lower())) - _COMMON
    return {_ENDING.sub("", word) if len(word) > 4 else word for word in found}


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
