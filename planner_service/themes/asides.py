"""What a clause tells beside its deed: of a noun, of who does it, what others are heard doing, and where else."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Final

from planner_service.themes.lexicon import grammar, is_adjective, is_noun, is_third_person, lemma_of, verb_of
from planner_service.themes.theme_words import theme_words
from planner_service.themes.verb_finder import Token, next_verb, verb_place

THAT: Final = frozenset(("that", "how", "what", "why", "if", "whether", "which", "who"))
"""What joins a clause that is an object: "finds that he won"."""
RELATIVES: Final = frozenset(("that", "which", "who"))
TELLING: Final = RELATIVES | {"whom", "whose"}
MANNER: Final = frozenset(("way", "time", "moment", "minute", "day", "night", "morning", "year"))
"""Nouns that say no more than how or when what is told of them was: "the way he was taught"."""
ARTICLES: Final = frozenset(("the", "a", "an"))
OWNERS: Final = frozenset(("his", "her", "their", "its", "my", "our"))


def besides_of(tokens: Sequence[Token], subject: str, before: Sequence[Token]) -> list[list[Token]]:
    """What is told before a verb of who does it, and of nothing else: "Barefoot, | her hair wet, | Anna walks in"."""
    own = subject.split()
    texts = [token.text for token in tokens]
    starts = (at for at in range(len(tokens) - len(own), -1, -1) if texts[at : at + len(own)] == own)
    at = next(starts, len(tokens)) if own else len(tokens)  # who says it may stand behind the verb
    opening = next((token for token in tokens if token.text in own[:1]), None)
    comma = next((place for place, token in enumerate(tokens) if token.text == ","), len(tokens))
    parted = tokens[tokens.index(opening) : comma] if opening else ()  # "the baker, | up since two, wipes"
    taken = {*before, *(tokens[at : at + len(own)] or parted)}
    stretches = groupby(tokens, lambda token: token.text[0] not in ",«" and token not in taken)
    return [words for is_told, some in stretches if is_told and _tells_something(words := list(some))]


def _tells_something(words: Sequence[Token]) -> bool:
    """Whether words say more than when, and how often: "her hair wet", not "one evening" and "now"."""
    known = grammar()
    small = known.adverbs | known.prepositions | known.marks | known.joints | known.auxiliaries | known.numbers
    said = (token.low for token in words if token.text[:1].isalpha() and token.low not in small | known.subjects)
    times = MANNER | known.times | {"one"}
    return any(low not in times and lemma_of(low) not in times for low in said)


def without_asides(words: list[Token], main: int) -> tuple[list[Token], list[list[Token]]]:
    """The words of a clause, and those after a noun that tell of it with a verb of their own: "the flour | the cat has
    spilled", "a call | that never comes"; but "is told on the phone that he has won", which is what is said."""
    says = any(lemma_of(word.low) in theme_words()["speech_verbs"] for word in words[main : main + 2])
    for place in range(main + 2, len(words) - 1):
        low, after = words[place].low, words[place + 1 :]
        if says and low == "that":
            break
        if low in RELATIVES:
            is_told = verb_place(after[:3]) == 0 or tells(after)
        else:
            is_told = low in grammar().subjects | ARTICLES | OWNERS and tells(words[place:])
        # "reads one | that makes him laugh"
        one = low in RELATIVES and words[place - 1].low == "one" and verb_of(after[0].low) in ("make", "let")
        if is_told and (one or ends_noun(words[place - 2].low, words[place - 1].low)):
            cut = place - 2 * (words[place - 1].low in MANNER and words[place - 2].low in grammar().marks)
            return words[:cut], [words[place:]]
    return words, []


def without_relative(tokens: list[Token]) -> tuple[list[Token], list[Token]]:
    """The words of a clause, and those that tell of its subject with a verb of their own: "a man | who lives alone |
    reads"."""
    start = next((at for at, token in enumerate(tokens) if at and token.low in TELLING), 0)
    if not start or verb_place(tokens[:start]) is not None:
        return tokens, []
    verb = verb_place(tokens[start + 1 :])
    end = None if verb is None else next_verb(tokens, start + 1 + verb)
    return (tokens, []) if end is None else ([*tokens[:start], *tokens[end:]], tokens[start:end])


def ends_noun(before: str, word: str) -> bool:
    """Whether a word is a noun, told by the word before it where it may be an adjective too: "the light"."""
    known = grammar()
    if word == "one" or word in known.marks | known.prepositions | known.subjects or verb_of(before) == "let":
        return False
    return is_noun(word) and (not is_adjective(word) or before in known.marks)


def tells(words: Sequence[Token]) -> bool:
    """Whether words begin with a subject and its finite verb."""
    place = verb_place(words[:5])
    if not place or (words[0].low in ARTICLES | OWNERS and place < 2):
        return False
    if any(token.low in grammar().prepositions | grammar().subjects for token in words[1:place]):
        return False
    word = words[place].low
    finite = word != verb_of(word) and not word.endswith("ing")
    return finite or word in grammar().auxiliaries or is_third_person(word)
