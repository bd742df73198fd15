"""Search by shared words alone (Okapi BM25): rare words count most, and the forms of a word are one word."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from planner_service.themes.lexicon import lemma_of

_SATURATION, _LENGTH = 1.2, 0.75  # k1 and b as Robertson and Zaragoza (2009) advise
_WORD: Final = re.compile(r"[^\W_]+(?:'[a-z]+)?")


class KeywordIndex:
    """Texts as the weights of their words, so that a query is one product of sparse matrices."""

    def __init__(self, texts: Sequence[str]) -> None:
        self._places: dict[str, int] = {}
        words = [[self._places.setdefault(stem, len(self._places)) for stem in stems(text)] for text in texts]
        lengths = np.array([len(each) for each in words], dtype=np.float64)
        owners = np.repeat(np.arange(len(texts)), lengths.astype(np.intp))
        rows = np.array([place for each in words for place in each], dtype=np.intp)
        counts = sparse.csr_array((np.ones(len(rows)), (rows, owners)), shape=(len(self._places), len(texts)))
        having = np.diff(counts.indptr)
        self._rarity = np.log(1 + (len(texts) - having + 0.5) / (having + 0.5))
        self._unknown = np.log(1 + 2 * len(texts) + 1)
        damping = _SATURATION * (1 - _LENGTH + _LENGTH * lengths / max(1.0, lengths.sum() / max(1, len(texts))))
        counts.data *= np.repeat(self._rarity, having) / (counts.data + damping[counts.indices])
        self._weights = counts

    def scores(self, queries: Sequence[str]) -> NDArray[np.float64]:
        """How much of a query's words a text has, rare words for most: 0 nothing, below 1. (queries, texts).

        Rounded to 1e-4. Divided by what no text can reach, so that a rare word that no text has counts too.
        """
        scores = np.zeros((len(queries), self._weights.shape[1]))
        for row, query in zip(scores, queries, strict=True):
            asked = sorted(set(stems(query)))
            known = [self._places[stem] for stem in asked if stem in self._places]
            whole = self._rarity[known].sum() + self._unknown * (len(asked) - len(known))
            if known:
                row[:] = self._weights[known].sum(axis=0) / whole
        return scores.round(4)


def stems(text: str) -> list[str]:
    """The base form of every word, in order; of a word that no dictionary has the word itself."""
    return [lemma_of(word) if word.isalpha() else word for word in _WORD.findall(text.lower())]
