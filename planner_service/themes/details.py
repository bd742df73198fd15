"""What a clause tells besides its deed: with what, as what, for whom, since when; no keyframe shows that."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from planner_service.themes.asides import MANNER
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar, is_adjective, is_noun, lemma_of, verb_of
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from planner_service.themes.verb_finder import Token, tokens_of

_LEADS: Final = frozenset(("with", "without", "for", "like", "as", "despite", "after", "since", "before", "until"))
"""Words before which a deed has been told, and after which stands how, for whom or when."""
_SENSED: Final = frozenset(("sound", "sight", "thought", "smell", "news", "noise", "mention", "idea", "click", "ring"))
"""At which something is done: "at the sound of the key"."""
_LINKS: Final = frozenset((",", "and", "or", "then"))
"""Words after which another place is told, where the same is done."""
_MARKS: Final = frozenset((",", ";"))
_LEFT_OUT: Final = frozenset(("after", "before", "since", "until", "without"))
_MOST_OF_TOOL: Final = 4
_FEWEST: Final = 2
"""Words that a deed is told in at least."""


def details_of(clause: Clause) -> tuple[str, ...]:
    """Stretches of a clause after its deed, in its words: "draws out a chair | for a lady, | thirty years gone"."""
    tokens = [token for token in tokens_of(clause.text) if token.text[:1].isalnum() or token.text in _MARKS]
    verb = next((at for at, token in enumerate(tokens) if lemma_of(token.text) == clause.verb), None)
    if not clause.verb:  # "Nothing but boredom, | a long grey Sunday"
        return tuple(filter(None, map(str.strip, clause.text.split(",")[1:])))
    if verb is None or clause.quotes:
        return ()
    starts = [at for at in range(verb + _FEWEST, len(tokens)) if _starts(tokens, at)]
    found = [_words(clause.text, tokens[start:end]) for start, end in pairwise([*starts, len(tokens)])]
    return tuple(text for text in found if len(text.split()) > 1 and not (_tells_when(text) or _is_tool(text)))


def _is_tool(text: str) -> bool:
    """Whether words only tell of a thing that a deed is done with, or for: "with honey", "for the cake"."""
    words = [token.low for token in tokens_of(text)]
    near = words[0] in ("with", "for") and len(words) <= _MOST_OF_TOOL
    return near and lemma_of(words[-1]) in things() and grammar().prepositions.isdisjoint(words[1:])


def _tells_when(text: str) -> bool:
    """Whether words only tell when, how long or how often: "for an hour", "every morning", "after the funeral"; or what
    there is none of, and what nobody sees: "without a word"."""
    known = grammar()
    lead, *rest = [token.low for token in tokens_of(text)]
    noun = [word for word in rest if word not in known.marks]
    if lead in _LEFT_OUT and len(noun) == 1 and is_noun(noun[0]) and lemma_of(noun[0]) not in theme_words()["people"]:
        return True
    small = known.prepositions | known.marks | known.numbers | known.times | known.adverbs | MANNER | {"so"}
    return all(token.low in small or lemma_of(token.low) in small for token in tokens_of(text))


def _starts(tokens: Sequence[Token], at: int) -> bool:
    """Whether a detail begins there: at a leading word, or at a deed beside."""
    low, before = tokens[at].low, tokens[at - 1]
    after = tokens[at + 1].low if at + 1 < len(tokens) else ""
    if low == "to" and verb_of(after) == after and not is_noun(after):
        return True  # "opens the door | to greet her guests"
    if low == "at" and any(token.low in _SENSED for token in tokens[at + 1 : at + 3]):
        return True
    beside = low.endswith("ing") and bool(verb_of(low)) and not is_noun(low) and is_noun(before.low)
    amid = low == "between" and after not in grammar().marks  # "between two calls"
    absolute = before.text == "," and _is_absolute(tokens[at:])
    pair = at > 1 and tokens[at - 2].low in grammar().prepositions  # "up and down the hall"
    linked = before.low in _LINKS and low in grammar().prepositions and not pair
    beside = beside and not is_adjective(before.low) and before.low not in grammar().prepositions
    return linked or absolute or amid or low in _LEADS or beside


def _is_absolute(tokens: Sequence[Token]) -> bool:
    """Whether words up to the next comma tell how something else is: "one shoe cradled in her lap"."""
    end = next((at for at, token in enumerate(tokens) if token.text in _MARKS), len(tokens))
    words = tokens[:end]
    return any(
        at and token.low.endswith(("ed", "ing")) and verb_of(token.low) and not is_noun(token.low)
        and words[at - 1].low not in grammar().marks and not is_adjective(words[at - 1].low)
        for at, token in enumerate(words)
    )  # fmt: skip


def _words(text: str, tokens: Sequence[Token]) -> str:
    while tokens and tokens[0].text in _MARKS:
        tokens = tokens[1:]
    return text[tokens[0].start : tokens[-1].end].strip(" ,;") if tokens else ""
