"""Search by shared words alone (Okapi BM25): the baseline that knows no meaning."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence
from typing import Final

from planner_service.scripts.script import ShortScript

_SATURATION, _LENGTH = 1.2, 0.75  # k1 and b as Robertson and Zaragoza (2009) advise
_WORD: Final = re.compile(r"[^\W_]+")


class KeywordSearch:
    """Summaries ranked by the rare words they share with a query."""

    def __init__(self, scripts: Sequence[ShortScript]) -> None:
        self._bags = {script.id: Counter(_words(script.summary)) for script in scripts}
        self._owners = Counter(word for bag in self._bags.values() for word in bag)
        self._mean = sum(bag.total() for bag in self._bags.values()) / max(1, len(scripts))

    def search(self, query: str, k: int) -> list[str]:
        """Ids of the k best, best first; by id among equals."""
        words = _words(query)
        scores = {name: round(sum(self._score(word, bag) for word in words), 4) for name, bag in self._bags.items()}
        return sorted(scores, key=lambda name: (-scores[name], name))[:k]

    def _score(self, word: str, bag: Counter[str]) -> float:
        owners = self._owners[word]
        rarity = math.log(1 + (len(self._bags) - owners + 0.5) / (owners + 0.5))
        damping = _SATURATION * (1 - _LENGTH + _LENGTH * bag.total() / self._mean)
        return rarity * bag[word] * (_SATURATION + 1) / (bag[word] + damping)


def _words(text: str) -> list[str]:
    return [word.lower() for word in _WORD.findall(text)]
