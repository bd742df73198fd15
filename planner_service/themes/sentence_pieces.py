"""Sentences cut at commas and joining words into pieces with one verb each, and put in the order of time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from planner_service.themes.asides import TELLING, THAT
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
from planner_service.themes.verb_finder import Token, is_adverb, names, plain, tokens_of, two_people, verb_place
from planner_service.themes.word_order import in_usual_order
from scene_graphs.furniture import is_known

HEROES: Final = frozenset(("he", "she", "they", "i", "we"))
_PLAIN_SUBJECTS: Final = frozenset(("i", "you", "we", "they"))
"""What does things in verbs' base forms."""
_TITLED: Final = theme_words()["people"]
"""What a name may follow that it belongs to: "the nurse Anna", "my friend Bo"."""
_PARTICLES: Final = frozenset(("up", "down", "out", "off", "over", "away", "back", "in", "on"))
_LATER_JOINTS: Final = frozenset(("before", "until", "while"))
_NO_JOINTS: Final = {"once": ("at", "for", "more", "all"), "while": ("a", "long", "little", "short")}
"""What joining words stand after where they join nothing: "at once", "for a while"."""
_PAIRS: Final = frozenset(
    (("up", "down"), ("down", "up"), ("back", "forth"), ("to", "fro"), ("round", "round"), ("over", "over"),
     ("on", "on"), ("in", "out"), ("again", "again"), ("hide", "seek"), ("off", "on"), ("on", "off"))
)  # fmt: skip
"""Words that "and" makes one: "up and down"."""


_OF_ORDER: Final = 2
"""Words of a sentence that orders no more than what is done to a part of the body,"""
_OWN: Final = theme_words()["body"] | {"tooth"}
"""which these are."""
_FEWEST_NOTES, _MOST_OF_NOTE = 3, 4
"""Pieces that a list of notes has more than, and words of the longest of them."""


@dataclass(frozen=True)
class Piece:
    """A stretch of a sentence, the joint before it, and where its verb stands."""

    joint: str
    tokens: tuple[Token, ...]
    source: str = field(repr=False)
    bare: bool = False
    """Whether its first word is a verb in its base form, as the one before has it: "you wake up, | stretch"."""
    verbless: bool = False
    """Whether what looks like its verb says how somebody is: "Bored stiff, | the nurse tries"."""
    told: tuple[Token, ...] = ()
    """What tells of its subject between commas: "Anna, | who lives alone, | reads"."""

    @property
    def text(self) -> str:
        return self.source[self.tokens[0].start : self.tokens[-1].end] if self.tokens else ""


def pieces_of(sentence: str) -> list[Piece]:
    """The sentence cut at commas and joining words, wherever a verb follows."""
    source = in_usual_order(plain(sentence))
    tokens = tokens_of(source)
    cut: list[Piece] = []
    joint, current = "", list[Token]()
    for place, token in enumerate(tokens):
        is_joint = token.low in grammar().joints and _joins(tokens, place)
        if token.text == "," or (is_joint and (not current or _may_end(token.low, cut, current))):
            if current:
                cut.append(Piece(joint, tuple(current), source))
                joint, current = "", []
            joint = token.low if joint in ("", ",", "and", "but") and token.text != "," else joint or ","
            if token.low in grammar().with_gerund:
                current.append(token)
        else:
            named = _is_named_doer(tokens, place) and current[-1:] and not _leads_noun(current)
            led = (token.low in HEROES or named) and is_led(joint, current)
            led = led and current[-1:] and current[-1].low not in THAT
            if led and verb_place(current) is not None:
                cut.append(Piece(joint, tuple(current), source))
                joint, current = ",", []
            current.append(token)
    if current:
        cut.append(Piece(joint, tuple(current), source))
    if len(tokens) == 1 and lemma_of(tokens[0].low) in things():  # "Shoes. Keys?"
        return [replace(cut[0], verbless=True)]
    if len(tokens) == _OF_ORDER and verb_of(tokens[0].low) == tokens[0].low and lemma_of(tokens[1].low) in _OWN:
        return [replace(cut[0], bare=True)]  # "Brush teeth."
    return _without_relatives(_whole(cut))


def _is_named_doer(tokens: Sequence[Token], place: int) -> bool:
    """Whether a name stands there with what its bearer does: "before he left | Tomas ironed a shirt"."""
    name, after = tokens[place], tokens[place + 1] if place + 1 < len(tokens) else None
    if not name.text[:1].isupper() or after is None or name.low.endswith("."):
        return False
    titled = place > 0 and tokens[place - 1].text[:1].isupper() and tokens[place - 1].low != "i"
    base = verb_of(after.low)
    finite = bool(base) and (is_third_person(after.low) or past(base) == after.low)
    return finite and not titled and (name.low in names() or not kinds_of(name.low))


def _leads_noun(current: Sequence[Token]) -> bool:
    """Whether words end in a preposition of what follows, not of the verb before it: "with", not "sitting down"."""
    particle = len(current) > 1 and current[-1].low in _PARTICLES and current[-2].low.endswith("ing")
    return current[-1].low in grammar().prepositions and not particle


def is_led(joint: str, current: Sequence[Token]) -> bool:
    """Whether words lead to a clause that has its own subject, with no comma between: "without a word he goes"."""
    opens = bool(current) and (current[0].low in grammar().with_gerund or current[0].low == "to")
    return opens or joint in grammar().earlier | _LATER_JOINTS


def _joins(tokens: Sequence[Token], place: int) -> bool:
    """Whether a joining word joins clauses here: "as soon as", "so tired" and "before dinner" do not."""
    low = tokens[place].low
    rest = tokens[place + 1 :]
    if place and tokens[place - 1].low in _NO_JOINTS.get(low, ()):
        return False
    if low == "but" and place and tokens[place - 1].low in ("nothing", "nobody", "none"):
        return False  # "finds nothing but a biscuit"
    if low == "until" and _is_of_laughing(tokens[:place], rest):
        return False
    ahead = rest[0].low if rest else ""
    if low == "and" and place and (tokens[place - 1].low, ahead) in _PAIRS:
        return False
    if low == "and" and two_people(tokens, place):
        return False
    if low in ("though", "if") and place and tokens[place - 1].low == "as":
        return False
    if low == "as" and ahead in ("though", "if"):
        return True
    if low == "so" and ahead not in grammar().subjects and (is_adjective(ahead) or ahead.endswith("ly")):
        return False  # "so fast that he forgets"
    if low == "as":
        return bool(rest) and rest[0].low in grammar().subjects | grammar().marks and verb_place(rest[:6]) is not None
    if low == "then":
        return bool(rest)
    if low in ("so", "yet", "or"):
        return bool(rest) and (rest[0].low in grammar().subjects or (low != "yet" and verb_place(rest[:2]) is not None))
    if low == "where" and ahead == "to":
        return False  # "cannot decide where to put it"
    if low in ("once", "since", "where"):
        opens = bool(rest) and (rest[0].low in grammar().marks or rest[0].text[:1].isupper())
        is_subject = bool(rest) and rest[0].low in grammar().subjects
        return is_subject or (opens and verb_place(rest[:5]) not in (None, 0))
    if low in grammar().with_gerund:
        return bool(rest) and _starts_gerund(rest)
    if low in ("after", "before", "until"):
        return bool(rest) and (_starts_gerund(rest) or rest[0].low in grammar().subjects or _clause_follows(rest))
    return True


def _is_of_laughing(before: Sequence[Token], rest: Sequence[Token]) -> bool:
    """Whether it only tells how much somebody laughs: "laughs | until she cries"."""
    laughs = any(lemma_of(token.low) in ("laugh", "giggle", "chuckle") for token in before[-4:])
    return laughs and any(lemma_of(token.low) in ("cry", "weep", "ache", "hurt", "tear") for token in rest[1:4])


def _may_end(joint: str, cut: Sequence[Piece], current: Sequence[Token]) -> bool:
    """Whether what stands before a joint can be a clause, or the end of one that lists things: not "a nurse" of
    "a nurse after a night shift", but "a pear" of "eats a plum and a pear after dinner is cooked"."""
    if joint not in grammar().earlier | {"before", "until", "without"}:
        return True
    return any(verb_place(told) is not None for told in (current, *(piece.tokens for piece in reversed(cut))))


def _starts_gerund(rest: Sequence[Token]) -> bool:
    at = 1 if rest[0].low in ("of", "even", "ever", "finally") and len(rest) > 1 else 0
    word = rest[at].low
    return word.endswith("ing") and bool(verb_of(word))


def _clause_follows(rest: Sequence[Token]) -> bool:
    """Whether a subject and its verb follow before the next comma: "after the phone rings", not "after dinner"."""
    end = next((i for i, token in enumerate(rest) if token.text == "," or token.low in ("and", "but")), len(rest))
    head = list(rest[: min(end, 6)])
    place = verb_place(head)
    return place is not None and place > 0 and not _is_when(head[:place])


def _is_when(lead: Sequence[Token]) -> bool:
    """Whether words before a verb are a noun and then somebody else, who does it: "before the interview | Tomasz bows"
    tells when, and no clause."""
    doer = next((at for at, one in enumerate(lead) if at and (one.low in HEROES or one.text[:1].isupper())), 0)
    before = lead[doer - 1].low if doer else ""
    leads = is_adjective(before) or is_adverb(before) or before in _TITLED  # "the tired | Anna"
    return is_noun(before) and lead[0].text[:1].islower() and not leads


def _whole(pieces: list[Piece]) -> list[Piece]:
    """Pieces without a verb put to the one before ("bread and butter"), or to the one after ("one evening, …")."""
    if all(verb_place(piece.tokens) is None for piece in pieces) and all(
        piece.joint in ("", ",", "then") for piece in pieces
    ):
        return pieces  # "stretch, shower, news"
    if _is_list(pieces):
        return [replace(one, bare=_orders(one), verbless=not (_orders(one) or _is_thing_done(one))) for one in pieces]
    whole: list[Piece] = []
    waiting: Piece | None = None
    for place, piece in enumerate(pieces):
        led = waiting is not None
        if waiting is not None:
            joint = waiting.joint if waiting.joint not in (",", "") else piece.joint if piece.joint != "," else ""
            mark = _comma(waiting) if piece.joint == "," else ()
            piece = replace(piece, joint=joint, tokens=(*waiting.tokens, *mark, *piece.tokens))
            waiting = None
        beside = bool(whole) and len(piece.tokens) == 1 and _goes_beside(piece)  # "answers, pacing"
        piece = replace(piece, bare=bool(whole) and waiting is None and not led and _is_bare(whole[-1], piece))
        opens = not whole and _describes_next(piece, pieces[place + 1 :])
        piece = replace(piece, verbless=opens)
        acts = beside or piece.bare or verb_place(piece.tokens) is not None
        if acts:
            whole.append(piece)
        elif whole and not (led or all(is_adverb(one.low) for one in piece.tokens)
                            or _leads(whole[-1], piece, pieces[place + 1 :])):  # fmt: skip
            mark = _comma(whole[-1]) if piece.tokens[0].low in grammar().prepositions else ()
            whole[-1] = replace(whole[-1], tokens=(*whole[-1].tokens, *mark, *piece.tokens))
        else:
            waiting = piece
    return [*whole, waiting] if waiting is not None else whole


def _is_list(pieces: Sequence[Piece]) -> bool:
    """Whether pieces are short notes of what is done: "wake up, yawn, get dressed, coffee, leave"."""
    joined = all(piece.joint in ("", ",", "and", "then") and len(piece.tokens) <= _MOST_OF_NOTE for piece in pieces)
    nobody = all(grammar().subjects.isdisjoint(token.low for token in piece.tokens) for piece in pieces)
    told = 2 * sum(map(_orders, pieces)) > len(pieces) or not any(map(_acts, pieces))
    return len(pieces) > _FEWEST_NOTES and joined and nobody and told


def _acts(piece: Piece) -> bool:
    """Whether a piece has a verb that is no noun, nor what is done: "reads", not "lights off" and "hair dried"."""
    place = verb_place(piece.tokens)
    return place is not None and not (_is_done(piece) or is_noun(piece.tokens[place].low))


def _is_done(piece: Piece) -> bool:
    """Whether a piece tells of a thing as of what has been done to it: "hair dried"."""
    *things_, last = (token.low for token in piece.tokens)
    return bool(things_) and is_noun(things_[-1]) and last not in things() and participle(verb_of(last) or "be") == last


def _orders(piece: Piece) -> bool:
    """Whether a piece begins with a verb in its base form."""
    first = piece.tokens[0]
    alone = len(piece.tokens) == 1 and is_known(first.low)  # "bed"
    return verb_of(first.low) == first.low and not (alone or first.low in things() or is_adverb(first.low))


def _is_thing_done(piece: Piece) -> bool:
    """The same of a thing, and no part of the body: "teeth brushed"."""
    return _is_done(piece) and lemma_of(piece.tokens[-2].low) not in theme_words()["body"]


def _without_relatives(pieces: list[Piece]) -> list[Piece]:
    """Pieces whose subject is told of between commas made one, and that told of it apart."""
    for at, piece in enumerate(pieces):
        comma = next((place for place, token in enumerate(piece.tokens) if token.text == ","), 0)
        own, told = piece.tokens[:comma], piece.tokens[comma + 1 :]
        if not (own and told and told[0].low in TELLING and verb_place(own) is None):
            continue
        after = (place for place in range(at + 1, len(pieces)) if pieces[place].joint in ("", ","))
        main = next(after, None)
        if main is not None and verb_place(pieces[main].tokens) == 0:
            told += tuple(token for one in pieces[at + 1 : main] for token in one.tokens)
            whole = replace(piece, tokens=own + pieces[main].tokens, told=told)
            return [*pieces[:at], whole, *_without_relatives(pieces[main + 1 :])]
    return pieces


def _is_bare(before: Piece, piece: Piece) -> bool:
    """Whether a piece begins with a second verb, in the form of the first: "they eat on the floor | and fall asleep",
    "she watched a film, | ordered sushi"."""
    at, first = 0 if before.bare else verb_place(before.tokens), piece.tokens[0].low
    if at is None or piece.joint not in (",", "and", "then") or is_adverb(first):
        return False
    verb = before.tokens[at].low
    if verb in grammar().do | grammar().modals:  # "did open the door, | touch the wall"
        return _is_plain_verb(piece)
    if not (verb_of(verb) and verb_of(first)):
        return False
    if at == 0 and not before.bare and verb_of(verb) == verb:  # "feed the cat, | iron a shirt"
        return _is_plain_verb(piece)
    plain = before.bare or (at > 0 and before.tokens[at - 1].low in _PLAIN_SUBJECTS)
    both_plain = plain and verb_of(verb) == verb and verb_of(first) == first
    return both_plain or (len(piece.tokens) > 1 and all(past(verb_of(one)) == one for one in (verb, first)))


def _is_plain_verb(piece: Piece) -> bool:
    """Whether a piece begins with a verb in its base form, told by what follows where it may be a noun too."""
    first, after = piece.tokens[0].low, piece.tokens[1] if len(piece.tokens) > 1 else None
    known = grammar()
    led = after is not None and (
        after.text.startswith("«") or after.low in known.marks | known.prepositions | known.subjects | known.numbers
    )
    told = led or not is_noun(first) or first in theme_words()["speech_verbs"]
    return verb_of(first) == first and (told or first not in things())


def _describes_next(piece: Piece, after: Sequence[Piece]) -> bool:
    """Whether a piece tells how somebody is who is named only after it: "Bored stiff, the nurse tries"."""
    own, places = verb_place(piece.tokens), (verb_place(one.tokens) for one in after if one.joint == ",")
    says_how = own is not None and all(is_adverb(one.low) for one in piece.tokens[:own])
    return says_how and piece.tokens[own or 0].low.endswith("ed") and any(places)


def _comma(piece: Piece) -> tuple[Token, ...]:
    """The comma behind a piece: "The baker, up since two, wipes the glass" has no "two wipes"."""
    end = piece.tokens[-1].end
    return (Token(",", end, end + 1),)


def _leads(last: Piece, piece: Piece, after: Sequence[Piece]) -> bool:
    """Whether a name is who does what follows what is told of them: "and Elspeth, still in her gown, beats them"."""
    named = len(piece.tokens) <= 2 and piece.tokens[0].text[:1].isupper()
    acting = next((one for one in after[:2] if verb_place(one.tokens) == 0), None)
    led = (
        piece.joint == "," and last.joint in grammar().earlier | _LATER_JOINTS
    )  # "while it boils, Tom, in his apron, …"
    return named and (led or piece.joint in ("and", "but", "so", "while")) and acting is not None


def in_time(pieces: Sequence[Piece]) -> list[int]:
    """Places of pieces in the order they happen: "B after A" is A, B; "before B, A" is A, B."""
    ordered: list[int] = []
    later = len(pieces) > 1 and pieces[0].joint == "before"
    first_is_later = len(pieces) > 1 and pieces[0].joint in ("until", "instead", "without")
    for place, piece in enumerate(pieces):
        if ordered and piece.joint in grammar().earlier:
            main = pieces[ordered[-1]]
            verb = verb_place(main.tokens)
            is_state = verb is not None and main.tokens[verb].low in grammar().be
            if piece.joint == "as" or (is_state and piece.joint != "after"):
                ordered.append(place)
            else:
                ordered.insert(len(ordered) - 1, place)
        else:
            ordered.append(place)
    if later:
        return [*ordered[1:], ordered[0]]
    return [*ordered[1:2], ordered[0], *ordered[2:]] if first_is_later else ordered


def _goes_beside(piece: Piece) -> bool:
    """Whether a gerund tells what else was done in the clause just before it."""
    return piece.joint == "," and piece.tokens[0].low.endswith("ing") and bool(verb_of(piece.tokens[0].low))
