"""An instruction in plain English: orders in the order of time, each a deed with its thing, place and hand."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import chain
from typing import Final, Literal, cast

from motion_backend.motion import Skill
from motion_backend.planners.markov_planner import Hand
from planner_service.composition.deed_lexicon import Deed, deed_of, without_gestures
from planner_service.composition.deed_patterns import says
from planner_service.composition.deed_table import DeedRow, deed_table
from planner_service.scripts.script_repair import NO_WAY_TO_GO
from planner_service.tasks.household import household, in_hand, is_one, told_by
from planner_service.tasks.task_plan import MAX_ACTION_LENGTH, TaskError
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar, lemma_of
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.verb_finder import tokens_of
from scene_graphs import furniture

Kind = Literal["walk", "rest", "use", "call", "rise", "take", "put", "operate", "never"]
MAX_ORDERS: Final = 12
_POLITE: Final = (
    r"(?:please|kindly|now|first(?:ly)?|finally|next|also|just|again|slowly|quickly|carefully|go and|try to|"
    r"(?:can|could|would|will) you|i(?:'d| would)? (?:want|like|need) (?:you )?to|"
    r"(?:you|he|she|they|i|we|it|the \w+|a \w+) (?:should|must|has to|have to|wants? to|needs? to))\b[\s,]*"
)
_OPENS: Final = re.compile(
    r"(^\s*|(?:[,;:.!?]\s*|\b(?:and|then|while|before|after|afterwards|after that)\s+)+)"
    rf"(?:{_POLITE})*(never\s+)?(\w+)",
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
_LIST: Final = re.compile(r"\s*(?:[,;]|\b(?:and|then)\b)[\s,;]*(?:\b(?:and|then)\b\s*)*", re.IGNORECASE)
_PLACE: Final = re.compile(
    r"\b(on to|onto|on top of|on|into|inside|in front of|in|at|over to|to|from|out of|off|by|next to|near|beside|under|"
    r"towards?|with|for|about|until|around|behind|against|through|across)\b\s*",
    re.IGNORECASE,
)
_PARTICLES: Final = frozenset(("up", "down", "away", "back", "out", "around", "on", "off"))
_PRONOUNS: Final = frozenset(("it", "them", "one"))
_CARRIES: Final = frozenset(("bring", "carry", "take", "drag", "haul", "deliver", "get", "fetch"))
_TAKES: Final = _CARRIES | {"pick", "hold", "grasp", "grab", "lift", "collect"}
_PUTS: Final = frozenset(("put", "place", "set", "lay", "drop", "return", "leave"))
_NO_PLACES: Final = frozenset(("with", "for", "about", "until"))
_TARGETS: Final = frozenset(("to", "on to", "onto", "over to", "into", "on", "in"))


@dataclass(frozen=True)
class Order:
    """One thing to do."""

    deed: Deed
    lemmas: tuple[str, ...]
    """The base forms of its words, from the verb on."""
    verb: str
    """In its base form, with its particle: "turn on"."""
    thing: str = ""
    """Its object without an article, "it" resolved: "cup of tea"."""
    said: str = ""
    """Its object as it was written: "your cup of tea"."""
    places: tuple[tuple[str, str], ...] = ()
    """Preposition and what follows, as it was written: ("on", "the sofa")."""
    hand: Hand | None = None

    @cached_property
    def kind(self) -> Kind:
        """What a body does of it."""
        row, verb = self.deed.row, self.verb.split()[0]
        shown = " ".join(row.captions[:1])
        if self.why_never:
            return "never"
        if self.tool:
            return "operate"
        if verb in _CARRIES and self.target and self.thing and self.deed.skill in (Skill.LOCO, Skill.TOUCH):
            return "put"  # where it is brought
        if verb in _PUTS and shown.startswith("put down") and not is_furniture(self.thing):
            return "put"
        if verb in _TAKES and self._taken(shown) and not is_furniture(self.thing):
            return "take"
        if self.needs == "phone" and self.deed.skill is Skill.LOCO:
            return "call"
        match self.deed.skill:
            case Skill.SITDOWN | Skill.LIEDOWN:
                return "use" if row.captions or row.lying else "rest"
            case Skill.STANDUP | Skill.GETUP:
                return "rise"
            case skill:
                return "walk" if skill is Skill.LOCO else "operate"

    def _taken(self, shown: str) -> bool:
        """Whether a verb of taking is meant so: not in "take a nap", though in "take the glass from the cabinet"."""
        used = bool(self.needs) and self.deed.skill is Skill.SITDOWN
        return bool(used or (self.source and self.thing)) or "pick up" in (self.verb, shown[:7]) or self.verb == "hold"

    @cached_property
    def why_never(self) -> str:
        """Why no body does it; "" where one does."""
        return self.deed.row.why or told_by(household().never, self.lemmas)

    @cached_property
    def tool(self) -> str:
        """What hands do it with: "with the sponge", or the usual thing."""
        told = (_noun(words) for word, words in self.places if word == "with" and self.verb != "play")
        usual = told_by(household().tools, self.lemmas)
        return (next(told, "") or usual) if self.deed.skill is Skill.TOUCH else ""

    @cached_property
    def needs(self) -> str:
        """What must be in hand for it."""
        return in_hand(self.deed.row, self.thing) or self.tool

    @cached_property
    def hands(self) -> Hand | None:
        """The hands it takes, as its captions and the verb have it."""
        shown = " ".join(self.deed.row.captions[:1])
        takes = household().takes_of(self.deed.row)
        if "both hands" in "".join(takes.shown[:1] if takes else shown) or (
            self.deed.skill is Skill.TOUCH and says(household().both_hands, self.lemmas)
        ):
            return "both"
        waves = self.deed.skill is Skill.LOCO and "right hand" in shown
        return "right" if self.needs or self.deed.skill is Skill.TOUCH or waves else None

    @property
    def goes(self) -> bool:
        """Whether it is a way to somewhere, if it is done on foot."""
        return not any(map(NO_WAY_TO_GO.search, self.deed.row.captions[:1]))

    @property
    def furniture(self) -> str:
        """The first furniture word it names after a preposition, else as its object; "" if none."""
        return self.source or self.target or next(filter(is_furniture, (*self._nouns(), self.thing)), "")

    @property
    def source(self) -> str:
        """The furniture from which it takes something."""
        return next(filter(is_furniture, self._nouns("from", "out of")), "")

    @property
    def target(self) -> str:
        """The furniture where something is to go."""
        return next(filter(is_furniture, self._nouns(*_TARGETS)), "")

    @property
    def phrase(self) -> str:
        """What is done, without the furniture: "turn on the TV"."""
        dropped = (self.tool, *filter(is_furniture, self._nouns()))
        others = (f"{word} {words}" for word, words in self.places if _noun(words) not in dropped)
        return " ".join(filter(None, (self.verb, self.said, *others)))

    def _nouns(self, *prepositions: str) -> Iterator[str]:
        for word, words in self.places:
            if word in prepositions or not (prepositions or word in _NO_PLACES):
                yield _noun(words)


def orders_of(action: str) -> tuple[Order, ...]:
    """What an instruction asks for, in the order of time. TaskError names what the rules do not know."""
    action = tidy(action)
    if fault := misleading(action):
        raise TaskError(fault, at="action")
    found: list[Order] = []
    for clause in clauses_of_text(_addressed(action)):
        found.extend(_orders(clause, found))
    if len(found) > MAX_ORDERS:
        raise TaskError(
            f"{len(found)} things to do, at most {MAX_ORDERS} are planned at once", "split it up", at="action"
        )
    return tuple(found)


def order_of(step: str) -> Order | None:
    """The one order of a step, or None where its verb is not known."""
    try:
        return next(iter(orders_of(step)), None)
    except TaskError:
        return None


def tidy(action: str) -> str:
    """The instruction in one line. TaskError if it is empty, longer than may be, or not text."""
    text = " ".join(action.split())
    if not text:
        raise TaskError("it is empty", "say what is to be done, such as “watch TV on the sofa”", at="action")
    if len(text) > MAX_ACTION_LENGTH:
        raise TaskError(f"it has {len(text)} letters, at most {MAX_ACTION_LENGTH} are read", "split it up", at="action")
    if not text.isprintable():
        raise TaskError("there are control characters in it", "write plain text", at="action")
    if not re.search(r"\w", text):
        raise TaskError("there is nothing to do in it", "say what to do, such as “watch TV on the sofa”", at="action")
    return text.strip(" '\"“”")


def misleading(text: str) -> str | None:
    """What would be acted wrongly: that something is not to be done, or a hand that is neither left, right nor both."""
    denied = next((clause.text for clause in clauses_of_text(_addressed(text)) if clause.denied), "")
    if denied:
        return f"“{denied}” says what is not done; say what to do, not what not to do"
    if other := _OTHER_HAND.search(_HAND.sub("", text)):
        return f"“{other[1][:40]}” is neither left nor right; say the left hand, the right hand or both hands"
    return None


def is_furniture(word: str) -> bool:
    """Whether it is furniture we know that a body can do something at, told in few words: not a book, nor a picture."""
    return bool(word) and len(word.split()) <= 4 and furniture.is_known(word) and bool(furniture.affordances(word))


def is_fixed(thing: str) -> bool:
    """Whether a noun phrase means what belongs to the house."""
    return is_one(thing, household().fixed)


def _addressed(text: str) -> str:
    """The text with "you" before every imperative, and without what is only polite: the reader knows who does it."""
    return _OPENS.sub(lambda at: f"{at[1]}{'you ' * (at[3].lower() in _imperatives())}{at[2] or ''}{at[3]}", text)


@cache
def _imperatives() -> frozenset[str]:
    """Base forms that a deed's words may begin with."""
    never = (way.split()[0].split("|") for way in chain.from_iterable(household().never.values()))
    known = {*deed_table().ways, *deed_table().gestures, *chain.from_iterable(never)}
    return frozenset(word for word in known if lemma_of(word) == word)


def _orders(clause: Clause, before: Sequence[Order]) -> Iterator[Order]:
    """The orders of a clause: the same is done with each thing that it lists."""
    words = [token for token in tokens_of(clause.text) if token.text[:1].isalnum()]
    heads = words[: len(words) - len(clause.lemmas) + 1] if clause.verb else []  # "and" has no base form
    verb = next((token for token in reversed(heads) if lemma_of(token.text) == clause.verb), None)
    first, *others = _LIST.split(clause.text[verb.end :] if verb else "")
    shared = _PLACE.search(_HAND.sub("", others[-1])) if others else None
    if shared and not _PLACE.search(first):  # "the cup and the plate on the table"
        first = f"{first} {shared.string[shared.start() :]}"
    order = _order(clause.verb, first, before) if verb else None
    if order is None:
        raise _unknown(clause.text)
    yield order
    for other in filter(None, others):
        order = _order(clause.verb, f"{order.verb.partition(' ')[2]} {other}", (order,)) if order.thing else None
        if order is None:
            raise _unknown(other)
        yield order


def _unknown(text: str) -> TaskError:
    known = f"they know to {household().examples.strip()}"
    return TaskError(f"rules know no way to “{text[:60]}”", known, at="action")


def _order(verb: str, rest: str, before: Sequence[Order]) -> Order | None:
    """What a verb and the words after it order; None where nobody knows a way."""
    hand = _HAND.search(rest)
    rest = " ".join(_HAND.sub("", rest).split())
    lemmas = (verb, *(lemma_of(token.text) for token in tokens_of(rest) if token.text[:1].isalnum()))
    spoken = next((one for one in reversed(before) if one.thing), None)
    clause, about = Clause(f"{verb} {rest}", "", verb, lemmas), spoken.thing if spoken else ""
    deed = deed_of(clause, about)
    if deed is not None and deed.is_gesture and (row := without_gestures(clause)):
        deed = deed_of(clause, about, row)  # what is worked with is fetched, which nobody does for a gesture
    if deed is None or not (deed.is_gesture or deed.row in deed_table().deed):
        fixed = next((lemma for lemma in lemmas if is_fixed(lemma)), "")
        nowhere = f"“{fixed}” is no furniture with a surface that a hand could be laid on" if fixed else ""
        if not (why := told_by(household().never, lemmas) or nowhere):
            return None
        deed = Deed(DeedRow((verb,), Skill.LOCO, why=why), Skill.LOCO, (), False)
    particle, rest = _particle(rest, deed.skill is Skill.TOUCH)
    said, *pieces = (piece.strip(" ,;.!?\"'“”") for piece in _PLACE.split(rest))
    places = tuple((word.lower(), words) for word, words in zip(pieces[::2], pieces[1::2], strict=True) if _noun(words))
    order = Order(
        deed,
        lemmas,
        f"{verb} {particle}".strip(),
        _noun(said),
        said,
        places,
        cast(Hand, hand[1].lower()) if hand else None,
    )
    it = (spoken.thing, f"the {spoken.thing}") if spoken else ("", "")
    if _noun(said).lower() in _PRONOUNS:
        order = replace(order, thing=it[0], said=it[1])
    return replace(order, places=tuple((word, it[1] if _noun(words) in _PRONOUNS else words) for word, words in places))


def _particle(rest: str, handled: bool) -> tuple[str, str]:
    """A verb's particle, wherever it stands ("turn the TV on"), and the other words.

    `handled`: "on" and "off" right behind the verb are particles ("turn on the TV"), not prepositions ("sit on it").
    """
    words = rest.split()
    for place, word in enumerate(word.lower() for word in words):
        ahead = words[place + 1].lower() if place + 1 < len(words) else ""
        if word in _PARTICLES and not (word == "out" and ahead == "of"):
            ends = not ahead or ahead in grammar().prepositions or ahead == "to"
            if ends or (not place and (handled or word not in ("on", "off", "around"))):
                return word, " ".join((*words[:place], *words[place + 1 :]))
        if word in grammar().prepositions or word == "to":
            break
    return "", rest


def _noun(text: str) -> str:
    """A noun phrase without what stands before its noun, and without adverbs."""
    words = text.split()
    while words and words[0].lower() in grammar().marks | {"me", "him", "us", "them"} and len(words) > 1:
        words.pop(0)
    while words and (words[-1].lower() in grammar().adverbs | _PARTICLES or words[-1].lower().endswith("ly")):
        words.pop()
    return " ".join(words)
