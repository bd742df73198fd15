"""An instruction in plain English taken apart: clauses in the order of time, each a verb with its object and place."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Final, cast

from motion_backend.planners.markov_planner import Hand
from planner_service.tasks.household_knowledge import Deed, deeds
from planner_service.tasks.task_plan import MAX_ACTION_LENGTH, TaskError
from planner_service.themes.lexicon import gerund, third_person
from scene_graphs import furniture

MAX_CLAUSES: Final = 12
_POLITE: Final = re.compile(
    r"^(?:please|now|first(?:ly)?|finally|next|also|just|quickly|slowly|carefully|again|will|(?:can|could|would) you|"
    r"i (?:want|would like|need) (?:you )?to|(?:you|he|she|they|i|we|it) (?:should|must|has to|have to|wants? to)|"
    r"(?:the|a) (?:person|man|woman|character|human|user|robot)|you|he|she|they|i|we|to|go and|try to|starts? to|"
    r"is|are|was)\b[\s,]*",
    re.IGNORECASE,
)
_HAND: Final = re.compile(
    r"\s*\b(?:with|in|using|by)?\s*(?:the|your|his|her|their|my)?\s*"
    r"\b(left|right|both)(?:\s+of)?(?:\s+(?:the|your|his|her|their|my))?[\s-]hands?\b",
    re.IGNORECASE,
)
_OTHER_HAND: Final = re.compile(
    r"\b(?:with|using|by|in)\s+(?:(?:the|an?|your|his|her|their|my)\s+)?"
    r"((?!(?:the|an?|your|his|her|their|my|own|bare)\b)\w+[\s-]hands?)\b",
    re.IGNORECASE,
)
_NEGATED: Final = re.compile(
    r"\b(?:not|never|cannot|nothing|avoid(?:ing)?|no\s+longer|refrain|instead\s+of|rather\s+than|(?:without|no)\s+\w+ing|"
    r"(?:do|does|did|is|are|was|were|wo|ca|should|must|need|would|could)n['’`]?t)\b",
    re.IGNORECASE,
)
_BREAK: Final = re.compile(r"\s*(?:[,;.!]+\s*|\b(?:and\s+then|then|and|while|after\s+that|afterwards)\b\s*)+", re.I)
_ORDER: Final = re.compile(r"^(?P<one>.+?),?\s+(?P<word>after|before)\s+(?P<other>.+)$", re.IGNORECASE)
_ORDER_FIRST: Final = re.compile(r"^(?P<word>after|before)\s+(?P<one>[^,]+),\s*(?P<other>.+)$", re.IGNORECASE)
_PLACE: Final = re.compile(
    r"\b(on to|onto|on top of|on|into|inside|in front of|in|at|over to|to|from|out of|off|by|next to|near|beside|under|"
    r"towards?|with|for|about|until|around|behind|against)\b\s*",
    re.IGNORECASE,
)
_DETERMINER: Final = re.compile(r"^(?:the|a|an|my|your|his|her|their|our|some|this|that|these|those|all)\s+", re.I)
_NOT_AN_OBJECT: Final = re.compile(r"\b(?:quickly|slowly|carefully|again|together|there|here|up|down|away|back)$", re.I)
_TIME: Final = re.compile(
    r"\bfor (?:a|an|some|\w+) (?:while|time|moment|bit|minutes?|hours?|seconds?)\b", re.IGNORECASE
)
_PRONOUNS: Final = frozenset(("it", "them", "one"))


@dataclass(frozen=True)
class Clause:
    """One thing to do."""

    deed: Deed
    verb: str
    """In its base form, with its particle: "turn on"."""
    thing: str = ""
    """Its object without an article, "it" resolved: "cup of tea"."""
    places: tuple[tuple[str, str], ...] = ()
    """Preposition and noun of what follows: ("on", "sofa")."""
    hand: Hand | None = None
    article: str = ""
    """Of its object, as it was written."""

    @property
    def furniture(self) -> str:
        """The first furniture word it names after a preposition, else as its object; "" if none."""
        named = [noun for word, noun in self.places if word not in ("with", "for", "about", "until")]
        return next((noun for noun in [*named, self.thing] if is_furniture(noun)), "")

    @property
    def phrase(self) -> str:
        """What is done, without where: "turn on the TV"."""
        return " ".join(filter(None, (self.verb, self.article, self.thing)))


def clauses(action: str) -> tuple[Clause, ...]:
    """What an instruction asks for, in the order of time. TaskError names what the rules do not know."""
    action = tidy(action)
    if fault := misleading(action):
        raise TaskError(f"{fault}", at="action")
    found: list[Clause] = []
    for text in _ordered(action):
        carried = found[-1] if found else None
        clause = clause_of(text)
        if clause is None and carried is not None and carried.thing and not _starts_as_verb(text):
            # "the cup and the plate": the same is done with both.
            hand = _HAND.search(text)
            carried = replace(carried, hand=cast(Hand, hand[1].lower()) if hand else None)
            clause = _with_rest(carried, _HAND.sub("", text))
        if clause is None:
            raise TaskError(
                f"rules know no way to “{text[:60]}”", f"they know to {', '.join(known_verbs())}", at="action"
            )
        found.append(_resolved(clause, found))
    if not found:
        raise TaskError(
            "there is nothing to do in it", "say what is to be done, such as “watch TV on the sofa”", at="action"
        )
    if len(found) > MAX_CLAUSES:
        raise TaskError(
            f"{len(found)} things to do, at most {MAX_CLAUSES} are planned at once", "split it up", at="action"
        )
    return tuple(found)


def tidy(action: str) -> str:
    """The instruction in one line. TaskError if it is empty, longer than may be, or not text."""
    text = " ".join(action.split())
    if not text:
        raise TaskError("it is empty", "say what is to be done, such as “watch TV on the sofa”", at="action")
    if len(text) > MAX_ACTION_LENGTH:
        raise TaskError(f"it has {len(text)} letters, at most {MAX_ACTION_LENGTH} are read", "split it up", at="action")
    if not text.isprintable():
        raise TaskError("there are control characters in it", "write plain text", at="action")
    return text


def misleading(text: str) -> str | None:
    """What would be acted wrongly: that something is not to be done, or a hand that is neither left, right nor both."""
    if found := _NEGATED.search(text):
        return f"“{found[0]}” says what is not done; say what to do, not what not to do"
    if other := _OTHER_HAND.search(_HAND.sub("", text)):
        return f"“{other[1][:40]}” is neither left nor right; say the left hand, the right hand or both hands"
    return None


def clause_of(text: str) -> Clause | None:
    """One clause, or None where its verb is not known."""
    text = _TIME.sub("", text).strip(" ,;.!?\"'“”")
    while (polite := _POLITE.match(text)) and polite.end() < len(text) and not _verb_at(text)[0]:
        text = text[polite.end() :]
    hand = _HAND.search(text)
    bare = " ".join(_HAND.sub("", text).split())
    verb, rest = _verb_at(bare)
    if not verb:
        return None
    clause = Clause(_verbs()[verb], verb, hand=cast(Hand, hand[1].lower()) if hand else None)
    return _with_rest(clause, rest)


def known_verbs() -> tuple[str, ...]:
    """The first verb of every row the rules know and a body can do something of."""
    return tuple(deed.verbs[0] for deed in deeds() if deed.kind != "never")


def is_furniture(word: str) -> bool:
    """Whether it is furniture we know that a body can do something at, told in few words: not a book, nor a picture."""
    return bool(word) and len(word.split()) <= 4 and furniture.is_known(word) and bool(furniture.affordances(word))


def _ordered(text: str) -> Iterator[str]:
    """Parts of the text in the order of time, each with a verb of its own or an object for the one before."""
    if match := _ORDER_FIRST.match(text):
        pair = (match["one"], match["other"])
        yield from _parts(*pair if match["word"].lower() == "after" else pair[::-1])
    elif (match := _ORDER.match(text)) and _starts_as_verb(match["other"]):
        pair = (match["one"], match["other"])
        yield from _parts(*pair if match["word"].lower() == "before" else pair[::-1])
    else:
        yield from _parts(text)


def _parts(*texts: str) -> Iterator[str]:
    for text in texts:
        yield from (part.strip() for part in _BREAK.split(text) if re.search(r"\w", part))


def _starts_as_verb(text: str) -> bool:
    while (polite := _POLITE.match(text)) and polite.end() < len(text) and not _verb_at(text)[0]:
        text = text[polite.end() :]
    return bool(_verb_at(text)[0])


def _with_rest(clause: Clause, rest: str) -> Clause:
    """The clause with its object and places read from the words behind its verb."""
    pieces = _PLACE.split(rest)
    places = tuple(
        (word.lower(), _noun(noun)) for word, noun in zip(pieces[1::2], pieces[2::2], strict=True) if _noun(noun)
    )
    article = _DETERMINER.match(pieces[0].strip())
    clause = replace(clause, places=places or clause.places)
    if _noun(pieces[0]):
        clause = replace(clause, thing=_noun(pieces[0]), article=article[0].strip().lower() if article else "")
    return clause


def _noun(text: str) -> str:
    """A noun phrase without article and adverbs."""
    text = _NOT_AN_OBJECT.sub("", text.strip(" ,;.!?\"'“”")).strip()
    while match := _DETERMINER.match(text):
        text = text[match.end() :]
    return text if text.isupper() else text[:1].lower() + text[1:]


def _resolved(clause: Clause, before: list[Clause]) -> Clause:
    """ "it" is what was spoken of last."""
    spoken = next((one.thing for one in reversed(before) if one.thing), "")
    if clause.thing.lower() in _PRONOUNS:
        clause = replace(clause, thing=spoken, article="the" if spoken else "")
    places = tuple((word, spoken if noun.lower() in _PRONOUNS else noun) for word, noun in clause.places)
    return replace(clause, places=places)


def _verb_at(text: str) -> tuple[str, str]:
    """The longest verb that a text begins with, its particle wherever it stands, and the rest; "" if none is known."""
    found = text.split()
    low = [word.lower().strip(",;.!?") for word in found]
    for count in range(min(len(low), _MAX_VERB_WORDS), 0, -1):
        if (verb := _forms().get(" ".join(low[:count]))) is not None and (count > 1 or not _apart(low)):
            return verb, " ".join(found[count:])
    if place := _apart(low):
        return _forms()[f"{low[0]} {low[place]}"], " ".join([*found[1:place], *found[place + 1 :]])
    return "", ""


def _apart(low: list[str]) -> int:
    """Where a verb's particle stands that its object parts from it ("turn the TV on"), 0 if there is none."""
    for place in range(2, min(len(low), 6)):
        if _PLACE.match(low[place]) or low[place] in _PARTICLES:
            ends = place + 1 == len(low) or low[place + 1] in _BEHIND
            return place if low[place] in _PARTICLES and ends and f"{low[0]} {low[place]}" in _forms() else 0
    return 0


_PARTICLES: Final = frozenset(("on", "off", "up", "down", "away", "back", "out"))
_BEHIND: Final = frozenset(("on", "in", "at", "with", "from", "of", "by"))
"""Words that may follow such a particle."""
_MAX_VERB_WORDS: Final = 4
"""Words of a verb."""


@cache
def _verbs() -> dict[str, Deed]:
    return {verb: deed for deed in deeds() for verb in deed.verbs}


@cache
def _forms() -> dict[str, str]:
    """Every present and -ing form of every verb, and its base form."""
    found = dict[str, str]()
    for verb in _verbs():
        head, _, tail = verb.partition(" ")
        for form in (head, third_person(head), gerund(head)):
            found.setdefault(f"{form} {tail}".strip(), verb)
    return found
