"""Words of an English sentence, and which of them act as verbs: told by their forms, and by the words before them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Final

from planner_service.scripts.emotions import feelings
from planner_service.themes.lexicon import (
    grammar,
    is_adjective,
    is_noun,
    is_third_person,
    kinds_of,
    lemma_of,
    participle,
    past,
    verb_of,
)
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things

_WORD: Final = re.compile(r"«\d+»|\b(?:Mrs?|Ms|Dr|Prof)\.|[^\W_]+(?:['’-][^\W_]+)*|[^\w\s]", re.UNICODE)
_CONTRACTION: Final = re.compile(r"(?i)\b(ca|wo|sha|[a-z]+?)n['’]t\b")
_INVERTED: Final = re.compile(
    r"(?i)(?<=\w)(?<! to)(,?) (did|does|do|had|has|have) (he|she|they|we|i|(?-i:[A-Z][a-z]+))\b(?= (\w+))"
)
"""A verb before who does it, as after "only when", "never" and "not until"."""
_FIRST: Final = re.compile(r"(?i)\s*after \w+ing\b")
"""What is done before, as "only" has gone by then: "(only) after washing up | does she sit"."""
_SLANG_NOT: Final = re.compile(r"(?i)\b(do|does|did|is|was|are|could|would|has|had|have|should)nt\b")


_SEVERAL: Final = frozenset(("couple", "family", "pair", "people", "police", "team"))
FLOATING: Final = frozenset(("all", "both", "each"))
"""Words between several people and their verb."""
_PARTICLES: Final = frozenset(("up", "down", "out", "off", "away", "back"))
_SHORTEST: Final = 3
"""Letters of what is no plural: "as"."""
NAMING: Final = frozenset(("named", "called", "nicknamed"))
"""What stands between a noun and the name of whom it means."""
_ONE_OF: Final = frozenset(("a", "an", "one", "some", "this"))
_ARTICLES: Final = frozenset(("the", "a", "an"))
_WHERE: Final = frozenset(("in", "on", "under", "by", "beside", "behind", "near"))
"""Words after which it is told where things are."""
_OBJECTS: Final = frozenset(("him", "them", "me", "himself", "herself", "back", "home", "and"))


@dataclass(frozen=True)
class Token:
    """A word or mark of a sentence."""

    text: str
    start: int
    end: int

    @property
    def low(self) -> str:
        """In small letters."""
        return self.text.lower()


def tokens_of(text: str) -> list[Token]:
    """Words and marks; "can't" is "can not"."""
    return [Token(match[0], match.start(), match.end()) for match in _WORD.finditer(text)]


def plain(text: str) -> str:
    """A text with its contractions and the commonest slang written out: "doesn't" is "does not"."""
    text = _SLANG_NOT.sub(r"\1 not", text.replace("’", "'").replace("‘", "'"))
    known = grammar()
    text = " ".join(known.slang.get(word.lower(), word) for word in text.split(" "))
    text = _CONTRACTION.sub(lambda m: known.contractions.get(m[1].lower(), f"{m[1]} not"), text)
    for otherwise, plainly in known.rewrites:
        text = re.sub(rf"(?i)\b{otherwise}\b", plainly, text)
    return _INVERTED.sub(_turned, text)


def _turned(found: re.Match[str]) -> str:
    """An inverted clause the other way about, and apart from what goes before it if that has a verb: "only when it was
    dark | he did rise"."""
    base, word = verb_of(found[4]), found[4].lower()
    fits = word == (base if found[2].lower() in grammar().do else participle(base)) if base else is_adverb(word)
    if not fits:
        return found[0]
    before = found.string[: found.start()].rsplit(".", 1)[-1]
    apart = _FIRST.match(before) or verb_place(tokens_of(before)) is not None
    told = found[1] or ("," if apart else "")
    return f"{told} {found[3]} {found[2]}"


def verb_place(tokens: Sequence[Token]) -> int | None:
    """Where the first verb or auxiliary of a clause stands; None where it has none."""
    if named := _opening_name(tokens):
        return named
    for place, token in enumerate(tokens):
        if token.low in grammar().auxiliaries or _acts(tokens, place):
            return place
    return None


def _opening_name(tokens: Sequence[Token]) -> int:
    """How many words name whom a clause opens with, though a name may be a verb too: "Peter | stands up", "Grandma Rose
    | knits"; 0 where none do."""
    called = tokens[:1] and (tokens[0].text[:1].isupper() and tokens[0].low in theme_words()["people"])
    end = 1 + bool(called)
    named = [token.text[:1].isupper() and token.low in names() for token in tokens[end - 1 : end]]
    return end if any(named) and len(tokens) > end and is_third_person(tokens[end].low) else 0


@cache
def names() -> frozenset[str]:
    """First names."""
    words = theme_words()
    return words["names_she"] | words["names_he"] | words["names_they"]


def next_verb(tokens: Sequence[Token], before: int) -> int | None:
    """Where the next finite verb stands after one that stands at `before`, and after what that helps."""
    known = grammar()
    no_verb_after = known.auxiliaries | known.denials | known.marks | known.prepositions | known.numbers
    for place in range(before + 1, len(tokens)):
        low, last = tokens[place].low, tokens[place - 1].low
        base = verb_of(low)
        finite = low in known.auxiliaries or (
            bool(base) and (is_third_person(low) or (low == past(base) and _acts(tokens, place)))
        )
        if finite and not (last in no_verb_after or (is_adverb(last) and place == before + 2)):
            return place
    return None


def has_verb(text: str) -> bool:
    """Whether some word of the text acts as a verb."""
    return verb_place(tokens_of(plain(text))) is not None


def is_plural(word: str) -> bool:
    """Whether a word may be the plural of a noun, or mean several people."""
    nouns = kinds_of(word).get("NOUN", ())
    people = word != lemma_of(word) in theme_words()["people"]  # "flatmates", whom no dictionary has
    return (len(word) > _SHORTEST and any(noun != word for noun in nouns)) or people or word in _SEVERAL


def is_adverb(word: str) -> bool:
    """Whether a word may stand between a subject and its verb."""
    return word in grammar().adverbs or (word.endswith("ly") and not verb_of(word) and not is_noun(word))


def _acts(tokens: Sequence[Token], place: int) -> bool:
    """Whether the word there acts as a verb, going by its form and the words about it."""
    word, base = tokens[place].low, verb_of(tokens[place].text)
    if calls(tokens, place) or tokens[place].text.endswith(("'s", "’s")):
        return False
    if not base or [token.low for token in tokens[place + 1 : place + 3]] == ["in", "hand"]:
        return False  # "phone in hand"
    at = place - 1
    if place and word.endswith("ing") and tokens[at].low in ("not", "never"):
        return True
    while at >= 0 and is_adverb(tokens[at].low):
        at -= 1
    if at < 0 or tokens[at].text == ",":
        if at >= 0 and word == base != past(base):
            return False  # nobody is told to do things
        alone = {token.low for token in tokens[1:]} <= grammar().adverbs | _PARTICLES | {"everywhere", "on", "in"}
        wet = not place and len(tokens) == 2 and is_adjective(tokens[1].low) and word.endswith("s")
        if wet and lemma_of(word) in things():
            return False  # "Socks impossible"
        if not place and tokens[1:] and alone and not word.endswith(("ed", "ing")) and lemma_of(word) in things():
            return False  # "Boxes everywhere.", "kettle on, shoes off"
        beside = at < 0 < place and word.endswith("ing")  # "still chewing"
        return (
            beside
            or _orders(tokens, place)
            or _opens(word, base, tokens[place + 1].low if place + 1 < len(tokens) else "")
        )
    before = tokens[at].low
    if before.endswith(("'s", "’s")) and is_noun(word) and not word.endswith(("ing", "ed")):
        return False  # "Martha's sobs shake the bed"
    if not at and is_noun(word) and _counts(before):
        return False  # "Thirty-one essays on the table", "Wet footprints from the bath"
    if before.startswith("«") and word != base:
        return True
    if before in grammar().subjects or before in grammar().modals or before in ("do", "does", "did"):
        return True
    if before == "to":
        again = at > 0 and tokens[at - 1].low == word  # "from time to time"
        return word == base and base not in grammar().not_verbs_after_to and not again
    if before in FLOATING and at and tokens[at - 1].low in grammar().subjects:
        return True  # "they all duck"
    if before in grammar().numbers and at and tokens[at - 1].low == "of":
        return is_third_person(word)  # "a girl of six jumps"
    if before in grammar().marks | grammar().numbers and not (before == "other" and at == 1):
        return False
    if word.endswith("ing"):
        led = before in grammar().with_gerund or tokens[0].low == "instead"
        return led or (before not in grammar().prepositions and not is_noun(word))
    return before not in grammar().prepositions and _follows(tokens, at, place, base)


def _counts(word: str) -> bool:
    """Whether a word tells how many or what of the noun behind it: "thirty-one", "12", "wet", nobody's name."""
    stands_alone = word in names() | grammar().marks | {"one"}
    return word.isdigit() or word.split("-")[0] in grammar().numbers or (is_adjective(word) and not stands_alone)


def calls(tokens: Sequence[Token], place: int) -> bool:
    """Whether a word there only tells the name of whom the noun before it means: "a robot | named Bolt | sweeps"."""
    if tokens[place].low not in NAMING or not place or not is_noun(tokens[place - 1].low):
        return False
    end = place + 1
    while end < len(tokens) and tokens[end].text[:1].isupper():
        end += 1
    led = any(token.low in _ONE_OF for token in tokens[:place]) and tokens[place - 1].text[:1].islower()
    after = tokens[end].low if end < len(tokens) else ""
    goes_on = after not in {"", "and", "but"} | grammar().prepositions  # "a friend called Anna and told her"
    return end > place + 1 and led and (goes_on or tokens[place].low != "called")


def _orders(tokens: Sequence[Token], place: int) -> bool:
    """Whether a word that opens a sentence tells what to do, to what follows: "load dirty plates", "welcome Anna"."""
    word, after = tokens[place].low, tokens[place + 1] if place + 1 < len(tokens) else None
    named = word == "miss" or word in theme_words()["people"] or word in things()
    if place or after is None or named or verb_of(word) != word:
        return False
    told = (
        after.text[:1].isupper() or is_adjective(after.low) or (is_noun(after.low) and lemma_of(after.low) in things())
    )
    return told and not any(
        token.low in grammar().auxiliaries or (is_third_person(token.low) and lemma_of(token.low) not in things())
        for token in tokens[place + 2 :]
    )


def _opens(word: str, base: str, after: str) -> bool:
    """Whether a word that opens a clause acts as a verb, before another word."""
    if word.endswith("ing"):
        return not is_noun(word) or bool(after)
    if lemma_of(word) in theme_words()["body"] and participle(verb_of(after)) == after != "":
        return False  # "eyes closed"
    sure = is_third_person(word) or participle(base) != past(base) == word  # "fell", "woke"
    if is_adjective(word) and not (sure or after in grammar().marks | grammar().prepositions | _PARTICLES):
        return False
    lies_there = lemma_of(word) in things().keys() - theme_words()["body"] - {"switch"}
    if lies_there and is_noun(word) and after in (_WHERE if word != base else grammar().prepositions):
        return False  # "Bag on the bed.", "cups in the sink"
    poses = grammar().postures | theme_words()["state_verbs"]
    if is_noun(word) and is_third_person(word) and after.endswith("ed") and base not in poses:
        return False  # "results unopened in her bag"
    if is_third_person(word) or word != base:
        names = is_noun(word) and bool(verb_of(after)) and not (is_noun(after) or after.endswith("ing"))
        return not names or is_adjective(after) or bool(feelings(after))  # "sinks exhausted into it"
    return not is_noun(word) or (_goes_on(after) and bool(after))


def _follows(tokens: Sequence[Token], at: int, place: int, base: str) -> bool:
    """Whether a word acts as the verb of the noun that stands before it, at `at`."""
    word, before = tokens[place].low, tokens[at].low
    after = tokens[place + 1].low if place + 1 < len(tokens) else ""
    if is_adjective(before) and not is_noun(before) and is_noun(word) and not (before == "other" and at == 1):
        return False  # but "the other wipes the table"
    small = grammar().marks | grammar().prepositions
    if is_noun(word) and _finite_follows(tokens, place):
        return False  # "with stiff fingers | takes the case", "a power cut | catches him"
    start = next((of + 1 for of in range(at, -1, -1) if tokens[of].text == ","), 0)
    start += tokens[start].low in grammar().adverbs
    named = any(one.low in _ARTICLES and last.low not in small for last, one in pairwise(tokens[start + 1 : at + 1]))
    if tokens[start].low in grammar().prepositions and tokens[at].text[:1].islower() and is_noun(word) and not named:
        return False  # "under the sofa cushions", but "as quiet as a cat the burglar climbs in"
    feels = is_adjective(tokens[0].low) and len(tokens) > 1 and tokens[1].low in grammar().prepositions
    if feels and tokens[at].text[:1].islower() and is_noun(word) and not named:
        return False  # "anxious about the exam results"
    if word == base:
        named = is_noun(before) or not kinds_of(before)  # "Anna put …"
        ends = _goes_on(after) or after in (",", "and")
        led = tokens[at - 1].low in _ARTICLES if at > 2 else tokens[0].low in grammar().marks | grammar().numbers
        led |= tokens[at - 1].low.endswith(("'s", "’s")) if at else False
        goes_on = after in grammar().marks or is_noun(after)
        acts = not is_noun(word) or goes_on or (ends and led)
        two = any(token.low == "and" and two_people(tokens[: place + 1], of) for of, token in enumerate(tokens[:at]))
        return (past(base) == base and named) or two or (is_plural(before) and acts)
    rests = after.endswith("ing") and before in theme_words()["people"]  # "the father stands swaying"
    plain = not (is_noun(word) and word.endswith("s")) or rests
    names_one = any(token.text[:1].isupper() for token in tokens[place + 1 : place + 2])  # "a yawn escapes Martha"
    return plain or _goes_on(after) or names_one or is_adjective(after) or is_noun(after)


def _finite_follows(tokens: Sequence[Token], place: int) -> bool:
    """Whether the word after one there is the verb of what they name, since it goes on with an object."""
    after, then = ([token.low for token in tokens[place + 1 : place + 3]] + ["", ""])[:2]
    led = then in grammar().marks - {"to"} | _OBJECTS - {"back", "home", "and"} | {"it", "her"}
    return is_third_person(after) and led


def two_people(tokens: Sequence[Token], joint: int) -> bool:
    """Whether "and", which stands there, joins two people who do something: "Marta and her husband | argue"."""
    people, end = theme_words()["people"], joint + 1
    if not joint or not (tokens[joint - 1].low in people or tokens[joint - 1].text[:1].isupper()):
        return False
    end += tokens[end : end + 1] != [] and tokens[end].low in grammar().marks
    named = tokens[end : end + 1] and (tokens[end].low in people or tokens[end].text[:1].isupper())
    end += tokens[end + 1 : end + 2] != [] and tokens[end].low in people and tokens[end + 1].text[:1].isupper()
    after = tokens[end + 1].low if end + 1 < len(tokens) else ""
    base = verb_of(after)
    acts = (bool(base) and after in (base, past(base))) or after in FLOATING | grammar().auxiliaries
    return bool(named) and acts and not is_third_person(after)


def _goes_on(after: str) -> bool:
    """Whether a verb may go on with a word, or end there."""
    known = grammar()
    goes = known.marks | known.prepositions | known.adverbs | known.subjects | known.numbers | _OBJECTS | _PARTICLES
    return not after or after in goes or after.endswith(("ly", "'s"))
