"""Where the words of each beat stand in a theme: its tokens, and the stretches of them that tell a beat."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from itertools import groupby
from typing import Final

from planner_service.narration.tense import bases
from planner_service.scripts.script import Beat
from planner_service.themes.lexicon import grammar

_TOKEN: Final = re.compile(r"[^\W_]+(?:['’-][^\W_]+)*|\s+|.")
_QUOTED: Final = re.compile(r"[“\"][^”\"]*[”\"]")
_END: Final = re.compile(r"[.!?…]+[\"”’')\]]*(?=\s|$)|\n+")
_LEAST: Final = 0.4
"""Share of a beat's words that stand together in the theme where it is told."""
_NEAR: Final = 6
"""Words between the two places where a beat's words stand, less one."""
SUBJECTS: Final = frozenset(("he", "she", "it", "they", "i", "we", "you", "who", "which", "that", "there"))


@dataclass
class Token:
    """A word, a mark or white space of a theme, and how it is told."""

    text: str
    told: str
    quoted: bool = False
    before: str = ""
    """Words that are told before it and are not the theme's."""
    is_name: bool = False
    """Whether it stands for the story's person."""

    @property
    def low(self) -> str:
        """In small letters, with a straight apostrophe."""
        return self.text.lower().replace("’", "'")

    @property
    def is_word(self) -> bool:
        """Whether it is no mark and no white space."""
        return self.text[0].isalnum()


@dataclass(frozen=True)
class Stretch:
    """The words of one beat: tokens from `start` to `end`, exclusive; its verb, where one was found."""

    beat: int
    start: int
    end: int
    verb: int | None = None


@dataclass
class Retelling:
    """A theme's tokens as they are told, and where its beats stand among them."""

    tokens: list[Token]
    stretches: list[Stretch] = field(default_factory=list)
    """In the order of the theme, none over another."""
    ends: list[int] = field(default_factory=list)
    """The last token of each sentence."""

    @property
    def text(self) -> str:
        """The whole of it."""
        return "".join(token.before + token.told for token in self.tokens)

    @property
    def starts(self) -> list[int]:
        """The first token of each sentence."""
        return [0, *(end + 1 for end in self.ends if end + 1 < len(self.tokens))]

    def words(self, stretch: Stretch) -> str:
        """How a stretch is told."""
        return "".join(token.told for token in self.tokens[stretch.start : stretch.end])

    def asides(self) -> Iterator[range]:
        """Tokens between beats that tell more than who does what, and when: of which no beat is made."""
        of = {at for one in self.stretches for at in range(one.start, one.end)}
        small = grammar().marks | grammar().prepositions | grammar().joints | grammar().adverbs | SUBJECTS
        for free, run in groupby(range(len(self.tokens)), key=lambda at: at not in of and at not in self.ends):
            places = [at for at in run if self.tokens[at].is_word]
            telling = [at for at in places if self.tokens[at].low not in small and not self.tokens[at].is_name]
            if free and len(telling) > 1:
                yield range(places[0], max(at for at in places if not self._names_who(at)) + 1)

    def _names_who(self, at: int) -> bool:
        """Whether a token only says who does what follows: "at two in the morning | she"."""
        return self.tokens[at].is_name or self.tokens[at].low in SUBJECTS

    def part(self, stretch: Stretch, words: str) -> range:
        """The tokens of a stretch where some of its words stand together; none where they do not."""
        return self._words_in(stretch.start, stretch.end, words)

    def lead(self, stretch: Stretch, words: str) -> range:
        """The same of what stands before a stretch in its sentence: "before the interview | he bows"."""
        start = max(one for one in self.starts if one <= stretch.start)
        return self._words_in(start, stretch.start, words)

    def _words_in(self, start: int, end: int, words: str) -> range:
        asked = [token.low for token in tokens_of_theme(words) if token.is_word]
        found = next(runs_of(self.tokens[start:end], asked), range(0))
        return range(start + found.start, start + found.stop) if found else found

    def end_of(self, stretch: Stretch) -> int:
        """The last token of the sentence that a stretch ends in."""
        return next(end for end in self.ends if end >= stretch.end - 1)


def tokens_of_theme(theme: str) -> list[Token]:
    """Words, marks and white space, as they are written."""
    quoted = [(one.start(), one.end()) for one in _QUOTED.finditer(theme)]
    return [
        Token(one[0], one[0], any(start <= one.start() < end for start, end in quoted))
        for one in _TOKEN.finditer(theme)
    ]


def located(tokens: Sequence[Token], beats: Sequence[Beat]) -> list[Stretch]:
    """Where most of each beat's words stand together."""
    places = [at for at, token in enumerate(tokens) if token.is_word]
    words = [tokens[at].low for at in places]
    found: list[Stretch] = []
    for index, beat in enumerate(beats):
        asked = [word.low for word in tokens_of_theme(beat.text) if word.is_word]
        verb = _verb(asked, beat.who)
        matcher = SequenceMatcher(None, words, asked, autojunk=False)
        run = matcher.find_longest_match()
        has_verb = run.b <= verb < run.b + run.size
        own = matcher.find_longest_match(blo=verb)  # "with a sigh of relief, | Ida takes off her coat"
        if own.b != verb and run.b > verb:
            own = matcher.find_longest_match(blo=verb, bhi=run.b)
        apart = own.b == verb and own.size > 0 and not has_verb
        both = apart and 0 < own.a - (run.a + run.size) < _NEAR and run.size + own.size >= _LEAST * len(asked)
        if both and 2 * own.size <= run.size:  # "| on the third try | he | bows |"
            words[run.a : run.a + run.size] = [""] * run.size
            found.append(Stretch(index, places[run.a], places[run.a + run.size - 1] + 1))
            run = own
        run = own if apart and 2 * own.size > run.size else run
        if not run.size or (run.size < _LEAST * len(asked) and not both):
            continue
        words[run.a : run.a + run.size] = [""] * run.size  # which stand for no other beat
        verb += run.a - run.b
        inside = run.a <= verb < run.a + run.size
        last = places[run.a + run.size - 1]
        found.append(Stretch(index, places[run.a], last + 1, places[verb] if inside else None))
    return sorted(found, key=lambda one: one.start)


def _verb(words: Sequence[str], who: str) -> int:
    """Where the verb of a beat is likely: after who does it, and adverbs."""
    doer = [token.low for token in tokens_of_theme(who) if token.is_word]
    at = len(doer) if list(words[: len(doer)]) == doer else 0
    while at < len(words) and _is_adverb(words[at]):
        at += 1
    return at


def _is_adverb(word: str) -> bool:
    return word in grammar().adverbs | {"neither", "nor"} or (word.endswith("ly") and not bases(word))


def sentence_ends(theme: str, tokens: Sequence[Token]) -> list[int]:
    """The last token of each sentence."""
    at, ends, stops = 0, [], {one.end() for one in _END.finditer(theme)}
    for index, token in enumerate(tokens):
        at += len(token.text)
        if at in stops:
            ends.append(index)
    return ends if ends[-1:] == [len(tokens) - 1] else [*ends, len(tokens) - 1]


def runs_of(tokens: Sequence[Token], words: Sequence[str]) -> Iterator[range]:
    """Where words stand one after the other, are not quoted, and are still told."""
    places = [at for at, token in enumerate(tokens) if token.is_word]
    for number in range(len(places) - len(words) + 1 if words else 0):
        run = places[number : number + len(words)]
        low = [tokens[at].low for at in run]
        if low == list(words) and all(tokens[at].told and not tokens[at].quoted for at in run):
            yield range(run[0], run[-1] + 1)
