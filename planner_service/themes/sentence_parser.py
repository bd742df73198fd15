"""English sentences taken apart: clauses with one verb each, in the order of time, with who does it and what is denied.

Sentences end where pysbd says. It is no grammar of English: enough to tell where one thing that happens ends and the
next begins.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from itertools import groupby
from typing import Any, Final

from planner_service.themes.lexicon import grammar, is_adjective, is_noun, is_third_person, lemma_of, verb_of
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from planner_service.themes.verb_finder import Token, is_adverb, is_plural, plain, tokens_of, verb_place
from planner_service.themes.verb_group import is_past, verb_group
from scene_graphs.furniture import is_known

_QUOTE: Final = re.compile(r"[“\"]([^”\"\n]{1,400})[”\"]|(?<!\w)['‘]([^'’\n]{2,200}[.,!?])['’](?!\w)")
_PLAIN: Final = re.compile(r"[A-Za-z ,'’-]+[.!?]?\s*")
_SEMI: Final = re.compile(r"\n+|;\s+|:\s+|\s+[–—]\s*|\s*[–—]\s+|\s+-{1,2}\s+|…\s*|\.{2,}\s*|\s*[()\[\]]\s*")
_HEROES: Final = frozenset(("he", "she", "they", "i", "we"))
_THAT: Final = frozenset(("that", "how", "what", "why", "if", "whether", "which", "who"))
"""What joins a clause that is an object: "finds that he won"."""
_SUPPOSING: Final = frozenset(("if", "unless"))
"""Joints before what is only thought of: "if he calls"."""
_RELATIVES: Final = frozenset(("that", "which", "who"))
_MANNER: Final = frozenset(("way", "time", "moment", "minute", "day", "night", "morning", "year"))
"""Nouns that say no more than how or when what is told of them was: "the way he was taught"."""

_SENSES: Final = frozenset(("hear", "see", "watch", "listen", "feel", "notice", "let", "overhear"))
"""Verbs beside which stands what somebody else does: "hears the door slam"."""
_STAYS: Final = frozenset(("sit", "lie", "stand", "lean", "rest", "kneel", "stay", "wait", "be", "walk", "go", "run"))
"""Verbs after which a second place says more of the first."""
_ARTICLES: Final = frozenset(("the", "a", "an"))
_OBJECTS: Final = frozenset(("him", "her", "them", "it", "me", "us"))
_OWNERS: Final = frozenset(("his", "her", "their", "its", "my", "our"))
_LATER_JOINTS: Final = frozenset(("before", "until", "while"))
_NO_JOINTS: Final = {"once": ("at", "for", "more", "all"), "while": ("a", "long", "little", "short")}
"""What joining words stand after where they join nothing: "at once", "for a while"."""
_PARTICLES: Final = frozenset(("on", "off", "down", "up", "around", "there", "back"))
_BULLET: Final = re.compile(r"^\s*(?:\d{1,2}[.)]|[-*•])\s+", re.MULTILINE)


@dataclass(frozen=True)
class Clause:
    """A stretch of a sentence with one verb."""

    text: str
    """Without whom it is about, in the theme's words: "drinks a glass of wine"."""
    subject: str
    """Who or what does it, as it is written; empty where it goes on from the clause before."""
    verb: str
    """The base form of what is done; empty where there is no verb."""
    lemmas: tuple[str, ...]
    """The base forms of its words from the verb on."""
    joint: str = ""
    """What joins it to the clause before: "and", "before", ","; "to" and "ing" for a second deed of one clause."""
    doer: str = ""
    """Who does it: `subject`, or whoever did what is told before in its sentence."""
    denied: bool = False
    """Whether it is not done, or only wished for."""
    unable: bool = False
    """Whether it is not done since it cannot be: "cannot sleep"."""
    perfect: bool = False
    """Whether it had been done before."""
    past: bool | None = None
    """Whether it is told in the simple past, and not in the present; None where its verb does not tell."""
    aside: bool = False
    """Whether it is only spoken of: of a noun ("the letter she had hidden"), or supposed ("if he calls")."""
    quotes: tuple[str, ...] = ()
    """What is said in it."""
    sentence: int = 0
    """Index of its sentence in the text."""
    place: int = 0
    """Where in its sentence it is written."""


@lru_cache(maxsize=256)
def clauses_of_text(text: str) -> tuple[Clause, ...]:
    """What a text tells, in the order of time."""
    quotes: list[str] = []
    text = text.replace("«", "“").replace("»", "”")  # which stand for what is said below

    def kept(match: re.Match[str]) -> str:
        quotes.append(match[1] or match[2])
        said = quotes[-1].rstrip()
        return f"«{len(quotes) - 1}»" + (
            ". " if said[-1:] in ".!?" and match.string[match.end() :].lstrip()[:1].isupper() else " "
        )

    found: list[Clause] = []
    for number, sentence in enumerate(sentences_of(_QUOTE.sub(kept, text))):
        told: list[list[Clause]] = []
        doer = ""
        for piece in (pieces := _pieces(sentence)):
            parts = _clause(piece, quotes, number)
            parts = _sharing(_main(told[-1]), parts) if told else parts
            own = _main(parts).subject or (_next_subject(pieces, piece) if not told else "")
            own = doer if own.lower() in _RELATIVES and doer else own
            told.append(
                [replace(part, doer=part.subject if part.aside else own or doer, place=len(told)) for part in parts]
            )
            if not doer or not _is_led(piece.joint, ()):  # who does what "because guests are coming" is not the guests
                doer = own or doer
        found += [part for place in _in_time(pieces) for part in told[place]]
    return tuple(found)


def _next_subject(pieces: Sequence[_Piece], piece: _Piece) -> str:
    """Who does what opens a sentence without a subject: "before going to bed, she brushes her teeth"."""
    if piece.joint not in grammar().earlier | grammar().with_gerund | {"before", "until", "while", "when"}:
        return ""
    mains = (_main(_clause(other, (), 0)) for other in pieces)
    return next((main.subject for main in mains if main.subject), "")


def _main(parts: Sequence[Clause]) -> Clause:
    """Of the clauses of a piece the one with its subject: what is told before it has no verb."""
    return next((part for part in parts if part.verb), parts[0])


def _sharing(before: Clause, parts: list[Clause]) -> list[Clause]:
    """A clause that shares the denial of the one before, whose verb is in its base form too: "does not eat | or drink",
    "wants to sit | and rest"."""
    unshared, first = parts, _main(parts)
    word = first.text.split(" ", 1)[0].lower()
    if not first.verb and verb_of(word) == word:  # "does not smoke, | drink or dance"
        parts = [replace(part, verb=word) if part is first else part for part in parts]
        first = next(part for part in parts if part.text == first.text)
    shares = before.denied and first.verb and not first.subject and first.joint in ("or", "nor", "and", ",")
    bare = first.text.split(" ", 1)[0].lower() == first.verb and re.search(
        rf"\b{re.escape(before.verb)}\b", before.text
    )
    plain_present = first.joint != "or" and before.doer.lower() in ("i", "you", "we", "they")
    if not shares or not bare or plain_present:
        return unshared
    return [replace(part, denied=True, unable=before.unable) if part is first else part for part in parts]


def sentences_of(text: str) -> list[str]:
    """The sentences, lines and list items of a text, without marks at their ends."""
    parts = [part for line in _SEMI.split(_BULLET.sub("", text)) if line.strip() for part in _segments(line)]
    return [part.strip(' \t.!?,;:-–—"“”') for part in parts if re.search(r"\w", part)]


def _segments(line: str) -> list[str]:
    # What has no mark but commas before its end is one sentence: the library takes longer than all else to say so.
    if _PLAIN.fullmatch(line):
        return [line]
    found: list[str] = _segmenter().segment(line)
    return found


@cache
def _segmenter() -> Any:
    from pysbd import Segmenter

    return Segmenter(language="en", clean=False)


@dataclass(frozen=True)
class _Piece:
    """A stretch of a sentence, the joint before it, and where its verb stands."""

    joint: str
    tokens: tuple[Token, ...]
    source: str = field(repr=False)

    @property
    def text(self) -> str:
        return self.source[self.tokens[0].start : self.tokens[-1].end] if self.tokens else ""


def _pieces(sentence: str) -> list[_Piece]:
    """The sentence cut at commas and joining words, wherever a verb follows."""
    source = plain(sentence)
    tokens = tokens_of(source)
    cut: list[_Piece] = []
    joint, current = "", list[Token]()
    for place, token in enumerate(tokens):
        is_joint = token.low in grammar().joints and _joins(tokens, place)
        if token.text == "," or (is_joint and (not current or _may_end(token.low, cut, current))):
            if current:
                cut.append(_Piece(joint, tuple(current), source))
                joint, current = "", []
            joint = token.low if joint in ("", ",", "and", "but") and token.text != "," else joint or ","
            if token.low in grammar().with_gerund:
                current.append(token)
        else:
            starts = token.low in _HEROES or _opens_main(current, tokens[place:])
            led = starts and _is_led(joint, current) and current[-1:] and current[-1].low not in _THAT
            so = led or _is_outcome(current, tokens[place:])
            if so and verb_place(current) is not None:
                cut.append(_Piece(joint, tuple(current), source))
                joint, current = "," if led else "so", []
                if token.low == "that":
                    continue
            current.append(token)
    if current:
        cut.append(_Piece(joint, tuple(current), source))
    return _whole(cut)


def _is_outcome(current: Sequence[Token], rest: Sequence[Token]) -> bool:
    """Whether words tell what came of it: "laughs so hard | that she falls", "is so tired | he sits down"."""
    so = next((place for place, token in enumerate(current) if token.low == "so"), None)
    if so is None or not so + 1 < len(current) <= so + 4:
        return False
    after = rest[1:] if rest[0].low == "that" else rest
    acts = len(after) > 1 and after[0].low in _HEROES and after[1].low not in grammar().modals
    return acts and verb_place(after[:5]) is not None


def _opens_main(current: Sequence[Token], rest: Sequence[Token]) -> bool:
    """Whether a noun and its verb follow what is a whole clause already: "before he drinks it | the baby wakes"."""
    if not current or current[-1].low in grammar().prepositions | grammar().marks:
        return False
    named = rest[0].text[:1].isupper() and not is_noun(rest[0].low)
    if not named and rest[0].low not in _ARTICLES | _OWNERS:
        return False
    verb, place = verb_place(current), verb_place(rest[1:5])
    if verb is None or verb == len(current) - 1 or place is None or (place if named else not place or not _tells(rest)):
        return False
    between = rest[1 : place + 1]
    return not any(token.low in grammar().marks or token.text[:1].isupper() for token in between)


def _is_led(joint: str, current: Sequence[Token]) -> bool:
    """Whether words lead to a clause that has its own subject, with no comma between: "without a word he goes"."""
    opens = bool(current) and (current[0].low in grammar().with_gerund or current[0].low == "to")
    return opens or joint in grammar().earlier | _LATER_JOINTS


def _joins(tokens: Sequence[Token], place: int) -> bool:
    """Whether a joining word joins clauses here: "as soon as", "so tired" and "before dinner" do not."""
    low = tokens[place].low
    rest = tokens[place + 1 :]
    if place and tokens[place - 1].low in _NO_JOINTS.get(low, ()):
        return False
    ahead = rest[0].low if rest else ""
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
    if low in ("once", "since", "after", "before", "until") and _is_noun_before_subject(rest):
        return False  # "since the accident he …"
    if low in ("once", "since", "where"):
        opens = bool(rest) and (rest[0].low in grammar().marks or rest[0].text[:1].isupper())
        is_subject = bool(rest) and rest[0].low in grammar().subjects
        return is_subject or (opens and verb_place(rest[:5]) not in (None, 0))
    if low in ("after", "before", "until", "without", "instead"):
        return bool(rest) and (
            _starts_gerund(rest) or rest[0].low in grammar().subjects or (low != "instead" and _clause_follows(rest))
        )
    return True


def _is_noun_before_subject(rest: Sequence[Token]) -> bool:
    """Whether a noun, and no clause, stands between a joint and who does what follows: "since the accident | he …"."""
    place = next((at for at, token in enumerate(rest[:5]) if token.low in _HEROES), 0)
    return place > 1 and not (rest[0].low in grammar().subjects) and verb_place(rest[:place]) is None


def _may_end(joint: str, cut: Sequence[_Piece], current: Sequence[Token]) -> bool:
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
    return place is not None and place > 0


def _whole(pieces: list[_Piece]) -> list[_Piece]:
    """Pieces without a verb put to the one before ("bread and butter"), or to the one after ("one evening, …")."""
    if all(verb_place(piece.tokens) is None for piece in pieces) and all(piece.joint in ("", ",") for piece in pieces):
        return pieces  # "stretch, shower, news"
    whole: list[_Piece] = []
    waiting: _Piece | None = None
    for place, piece in enumerate(pieces):
        led = waiting is not None
        if waiting is not None:
            joint = waiting.joint if waiting.joint not in (",", "") else piece.joint if piece.joint != "," else ""
            mark = _comma(waiting) if piece.joint == "," else ()
            piece = replace(piece, joint=joint, tokens=(*waiting.tokens, *mark, *piece.tokens))
            waiting = None
        beside = bool(whole) and len(piece.tokens) == 1 and _goes_beside(piece)  # "answers, pacing"
        if (beside or verb_place(piece.tokens) is not None) and not (whole and _is_noun_list(whole[-1], piece)):
            whole.append(piece)
        elif whole and not led and _is_loose(whole[-1], piece, pieces[place + 1 :]):
            whole.append(piece)
        elif whole and not (led or _opens(piece, pieces[place + 1 :]) or _leads(whole[-1], piece, pieces[place + 1 :])):
            mark = _comma(whole[-1]) if piece.tokens[0].low in grammar().prepositions else ()
            whole[-1] = replace(whole[-1], tokens=(*whole[-1].tokens, *mark, *piece.tokens))
        else:
            waiting = piece
    return [*whole, waiting] if waiting is not None else whole


def _is_loose(last: _Piece, piece: _Piece, after: Sequence[_Piece]) -> bool:
    """Whether words without a verb are told beside a clause and are no part of it: "sinks into the armchair, | a glass
    in his hand", but "eats a plum, a pear and cheese"."""
    known, first = grammar(), piece.tokens[0].low
    if piece.joint != "," or first in known.prepositions | known.adverbs | known.joints or len(piece.tokens) < 2:
        return False
    run = next((at for at, one in enumerate(after) if verb_place(one.tokens) is not None), len(after))
    listed = any(one.joint in ("and", "or", "plus") for one in after[:run])
    verb = verb_place(last.tokens)
    own = next((token.low for token in reversed(last.tokens[(verb or 0) + 1 :]) if token.low in known.marks), "")
    return (
        not listed and verb is not None and first != own and not _opens(piece, after) and not _leads(last, piece, after)
    )


def _comma(piece: _Piece) -> tuple[Token, ...]:
    """The comma behind a piece: "The baker, up since two, wipes the glass" has no "two wipes"."""
    end = piece.tokens[-1].end
    return (Token(",", end, end + 1),)


def _opens(piece: _Piece, after: Sequence[_Piece]) -> bool:
    """Whether a place or time belongs to the clause after it: "…, and in the kitchen, she cooks"."""
    if piece.joint == "," or piece.tokens[0].low not in grammar().prepositions or not after:
        return False
    first = after[0].tokens[0]
    return after[0].joint == "," and (first.low in grammar().subjects or first.text[:1].isupper())


def _leads(last: _Piece, piece: _Piece, after: Sequence[_Piece]) -> bool:
    """Whether a name is who does what follows what is told of them: "and Elspeth, still in her gown, beats them"."""
    named = len(piece.tokens) <= 2 and piece.tokens[0].text[:1].isupper() and not is_noun(piece.tokens[0].low)
    acting = next((one for one in after[:2] if verb_place(one.tokens) == 0), None)
    led = (
        piece.joint == "," and last.joint in grammar().earlier | _LATER_JOINTS
    )  # "while it boils, Tom, in his apron, …"
    return named and (led or piece.joint in ("and", "but", "so", "while")) and acting is not None


def _is_noun_list(last: _Piece, piece: _Piece) -> bool:
    """Whether a single word goes on with the nouns before it: "cakes and drinks", but not "eats and drinks"."""
    words = piece.tokens
    if [word.low for word in words if word.low != "up"] == ["standing"]:
        return True  # "eats from the pot, standing up"
    verb = verb_place(words) or 0
    if piece.joint in ("and", "or", ",") and verb > 2 and words[verb - 1].low in grammar().subjects and last.tokens:
        return words[0].low in _ARTICLES | _OWNERS and _ends_noun(words[verb - 3].low, words[verb - 2].low)
    if len(words) > 1 or not is_noun(words[0].low):
        return False
    end, word = last.tokens[-1].low, words[0].low
    if {end, word} <= theme_words()["body"]:
        return True  # "on his hands and knees"
    if is_third_person(word):
        listed = is_plural(end) and len(last.tokens) > 2 and last.tokens[-2].low not in grammar().marks
        return listed and (piece.joint != "," or word in things() or lemma_of(word) in things())
    return is_noun(end) and word == verb_of(word)


def _in_time(pieces: Sequence[_Piece]) -> list[int]:
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
        elif place - 1 in ordered[:-1] and _goes_beside(piece):  # "switches it on after she has sat there, | listening"
            ordered.insert(ordered.index(place - 1) + 1, place)
        else:
            ordered.append(place)
    if later:
        return [*ordered[1:], ordered[0]]
    return [*ordered[1:2], ordered[0], *ordered[2:]] if first_is_later else ordered


def _goes_beside(piece: _Piece) -> bool:
    """Whether a gerund tells what else was done in the clause just before it."""
    return piece.joint == "," and piece.tokens[0].low.endswith("ing") and bool(verb_of(piece.tokens[0].low))


def _clause(piece: _Piece, quotes: Sequence[str], sentence: int) -> list[Clause]:
    """The clause of a piece, and second deeds in it that stand without a joint."""
    tokens = list(piece.tokens)
    joint = piece.joint
    while (
        tokens
        and not (tokens[0].low == "too" and is_adjective(tokens[1].low if len(tokens) > 1 else ""))
        and tokens[0].low in grammar().adverbs | {"and", "but", "or"}
        and tokens[0].low not in grammar().denials
        and len(tokens) > 1
    ):
        tokens.pop(0)
    place = verb_place(tokens)
    if place is None:
        return [Clause(piece.text, "", "", _lemmas(tokens), joint, quotes=_quotes(tokens, quotes), sentence=sentence)]
    place -= 2 * ([token.low for token in tokens[max(place - 2, 0) : place]] == ["no", "longer"])
    subject = _subject([token for token in tokens[:place] if not token.text.startswith("«")])
    if (not subject and tokens[0].text.startswith("«")) or (not place and _is_inverted(tokens)):
        subject = _inverted(tokens[place + 1 :])
        tokens = [*tokens[: place + 1], *tokens[place + 1 + len(subject.split()) :]]
    denials = grammar().denials - grammar().subjects
    lead = tokens[:place] if not subject else [t for t in tokens[:place] if t.low in denials]
    words = (lead if any(token.low in grammar().denials for token in lead) else []) + tokens[place:]
    if words and words[0].low in grammar().adverbs - grammar().denials and len(words) > 1:
        words = words[1:]
    group = verb_group(words)
    supposed = joint in _SUPPOSING or piece.tokens[0].low in ("if", "though")
    words, told_of = _without_asides(words, group.place)
    lemmas = _lemmas(words[group.place :])
    too = place > 2 and tokens[place - 1].low == "to" and any(token.low == "too" for token in tokens[:place])
    hindered = (
        too or joint in ("before", "until") and words[0].low in ("can", "could")
    )  # "too proud to ask", "before he could drink it"
    first = Clause(
        _text(piece.source, words), subject, lemmas[0] if lemmas else "", lemmas, joint, denied=group.denied or hindered,
        unable=group.unable, perfect=group.perfect, past=is_past(words, group), aside=supposed,
        quotes=_quotes(tokens, quotes), sentence=sentence,
    )  # fmt: skip
    words, places = _listed_places(words, group.place)
    if places:
        lemmas = _lemmas(words[group.place :])
        first = replace(first, text=_text(piece.source, words), lemmas=lemmas)
        told = [token.low for token in words[group.place :]]
        stop = next((at for at, low in enumerate(told) if at and low in grammar().prepositions), len(told))
        again = [replace(first, text=_text(piece.source, some), subject="", joint=",", quotes=(),
                         lemmas=(*lemmas[:stop], *_lemmas(some))) for some in places]  # fmt: skip
    parted = not group.denied or group.unable
    parts = _parted(first, words, group.place, piece.source) if parted else [first]
    asides = [replace(one, sentence=sentence) for some in told_of for one in _aside(some, words, piece.source)]
    before = () if first.quotes else _before(tokens[:place], subject)
    how = [token for token in tokens[:place] if token.low.endswith("ly") and is_adverb(token.low) and subject]
    how = [token for token in how if token.low not in grammar().adverbs and not first.quotes]
    before = (*before, *(token for token in how if token not in before))
    besides = [
        Clause(_text(piece.source, some), "", "", _lemmas(some), ",", sentence=sentence)
        for some in _besides(tokens[:place], subject, before)
    ]
    return [*besides, _placed(parts[0], before, piece.source), *parts[1:], *(again if places else ()), *asides]


def _besides(tokens: Sequence[Token], subject: str, before: Sequence[Token]) -> list[list[Token]]:
    """What is told before a verb of who does it, and of nothing else: "Barefoot, | her hair wet, | Anna walks in"."""
    own = subject.split()
    starts = (
        at for at in range(len(tokens) - len(own), -1, -1) if [one.text for one in tokens[at : at + len(own)]] == own
    )
    at = next(starts, 0) if own else 0
    taken = {*before, *tokens[at : at + len(own)]}
    stretches = groupby(tokens, lambda token: token.text[0] not in ",«" and token not in taken)
    told = [words for is_told, some in stretches if is_told and _tells_something(words := list(some))]
    first = tokens[at] if own else None
    return [words for words in told if not _only_marks(words, first)]


def _only_marks(words: Sequence[Token], subject: Token | None) -> bool:
    """Whether words only stand before a subject as part of it: "old" before "Mr. Finch"."""
    known = grammar()
    small = all(token.low in known.marks | known.numbers or is_adjective(token.low) for token in words)
    return subject is not None and small and words[-1].end + 1 == subject.start


def _tells_something(words: Sequence[Token]) -> bool:
    """Whether words say more than when, and how often: "her hair wet", not "one evening" and "now"."""
    known = grammar()
    small = known.adverbs | known.prepositions | known.marks | known.joints | known.auxiliaries | known.numbers
    said = (token.low for token in words if token.text[:1].isalpha() and token.low not in small | known.subjects)
    return any(lemma_of(low) not in _MANNER | grammar().times for low in said)


def _without_asides(words: list[Token], main: int) -> tuple[list[Token], list[list[Token]]]:
    """The words of a clause, and those after a noun that tell of it with a verb of their own: "the flour | the cat has
    spilled", "a call | that never comes"; but "is told on the phone that he has won", which is what is said."""
    if place := _sensed(words, main):
        return words[:place], [words[place:]]
    says = any(lemma_of(word.low) in theme_words()["speech_verbs"] for word in words[main : main + 2])
    for place in range(main + 2, len(words) - 1):
        low, after = words[place].low, words[place + 1 :]
        if says and low == "that":
            break
        if low in _RELATIVES:
            tells = verb_place(after[:3]) == 0 or _tells(after)
        else:
            tells = low in grammar().subjects | _ARTICLES | _OWNERS and _tells(words[place:])
        if tells and _ends_noun(words[place - 2].low, words[place - 1].low):
            cut = place - 2 * (words[place - 1].low in _MANNER and words[place - 2].low in grammar().marks)
            return words[:cut], [words[place:]]
    return words, []


def _listed_places(words: list[Token], main: int) -> tuple[list[Token], list[list[Token]]]:
    """The words of a clause up to its first place, and further places where the same is done: "looks under the bed, |
    behind the sofa | and in the oven"; but "sits on the sofa, next to the lamp" is one place."""
    known, cuts = grammar(), list[int]()
    links = {",", "and", "or", "then"}
    for at in range(main + 2, len(words) - 1):
        opens = words[at - 1].low in links and words[at].low in known.prepositions
        first = any(
            _names_place(words[start:at]) for start in range(main + 1, at) if words[start].low in known.prepositions
        )
        end = next((place for place in range(at + 1, len(words)) if words[place].low in links), len(words))
        stays = words[at - 1].low != "then" and lemma_of(words[main].low) in _STAYS
        if opens and first and not stays and _names_place(words[at:end]):
            cuts.append(at)
    if not cuts:
        return words, []
    stretches = [words[start:end] for start, end in zip([0, *cuts], [*cuts, len(words)], strict=True)]
    bare = [_unlinked(some, links) for some in stretches]
    return bare[0], bare[1:]


def _names_place(words: Sequence[Token]) -> bool:
    """Whether a stretch that a preposition opens ends with furniture: "behind the old sofa"."""
    return 1 < len(words) <= 5 and any(is_known(token.low) for token in words[1:])


def _unlinked(words: list[Token], links: set[str]) -> list[Token]:
    while words and words[-1].low in links:
        words = words[:-1]
    return words


def _sensed(words: Sequence[Token], main: int) -> int:
    """Where the verb stands of what somebody else is heard or seen doing: "hears the door | slam"; 0 for none."""
    if not words or lemma_of(words[main].low) not in _SENSES:
        return 0
    for place in range(main + 2, len(words)):
        low, before = words[place].low, words[place - 1].low
        if low in grammar().subjects | _THAT | {"and", "or", ",", "to"}:
            return 0
        doing = verb_of(low) == low and not is_adjective(low) or (low.endswith("ing") and bool(verb_of(low)))
        marked = any(token.low in grammar().marks for token in words[main + 1 : place - 1]) and is_noun(before)
        after = words[place + 1].low if place + 1 < len(words) else ""
        goes_on = (
            not after or after in grammar().prepositions | grammar().marks | grammar().adverbs or after.endswith("ly")
        )
        if (
            doing
            and goes_on
            and before not in grammar().prepositions | grammar().marks
            and (marked or before in _OBJECTS)
        ):
            return place
    return 0


def _ends_noun(before: str, word: str) -> bool:
    """Whether a word is a noun, told by the word before it where it may be an adjective too: "the light"."""
    known = grammar()
    if word == "one" or word in known.marks | known.prepositions | known.subjects or verb_of(before) == "let":
        return False
    return is_noun(word) and (not is_adjective(word) or before in known.marks)


def _tells(words: Sequence[Token]) -> bool:
    """Whether words begin with a subject and its finite verb."""
    place = verb_place(words[:5])
    if not place or (words[0].low in _ARTICLES | _OWNERS and place < 2):
        return False
    if any(token.low in grammar().prepositions | grammar().subjects for token in words[1:place]):
        return False
    word = words[place].low
    finite = word != verb_of(word) and not word.endswith("ing")
    return finite or word in grammar().auxiliaries or is_third_person(word)


def _aside(words: list[Token], main: Sequence[Token], source: str) -> list[Clause]:
    """What is told of a noun of the main clause: it happened before or elsewhere, and somebody may have done it."""
    head = words[1:] if words[0].low in _RELATIVES else words
    place = verb_place(head) or 0
    subject = _subject(head[:place]) or (words[0].text if place else _last_noun(main))
    lemmas = _lemmas(head[place:])
    return [Clause(_text(source, words), subject, lemmas[0] if lemmas else "", lemmas, "that", aside=True)]


def _last_noun(words: Sequence[Token]) -> str:
    """The noun at the end of words, with its mark: "the door"."""
    start = next((at for at in range(len(words) - 1, 0, -1) if words[at].low in grammar().marks), len(words) - 1)
    return " ".join(token.text for token in words[start:])


def _is_inverted(words: Sequence[Token]) -> bool:
    """Whether a clause only says who thinks or says what stands beside it: "…, thinks Paloma"."""
    verbs = theme_words()["speech_verbs"] | theme_words()["thought_verbs"]
    return lemma_of(words[0].low) in verbs and 2 <= len(words) <= 3 and _inverted(words[1:]) != ""


def _inverted(after: Sequence[Token]) -> str:
    """Who says it, where that stands after the verb: "“Who is there?” shouted Barnaby"."""
    if after and after[0].text[:1].isupper():
        return after[0].text
    return " ".join(token.text for token in after[:2]) if after and after[0].low in _ARTICLES | _OWNERS else ""


def _before(tokens: Sequence[Token], subject: str) -> Sequence[Token]:
    """Where, when or how it is done, where that stands before who does it: "in the kitchen Anna reads"."""
    if not subject or not tokens or tokens[0].low not in grammar().prepositions:
        return ()
    size = len(subject.split())
    texts = [token.text for token in tokens]
    starts = (at for at in range(len(texts) - size, -1, -1) if texts[at : at + size] == subject.split())
    before = tokens[: next(starts, 0)]
    return before[:-1] if before and before[-1].text == "," else before


def _placed(clause: Clause, before: Sequence[Token], source: str) -> Clause:
    """The clause with what stands before its subject at its end."""
    if not before or clause.quotes:
        return clause
    text = " ".join(_text(source, list(some)) for _, some in groupby(before, lambda token: token.low.endswith("ly")))
    return replace(clause, text=f"{clause.text} {text[0].lower()}{text[1:]}", lemmas=(*clause.lemmas, *_lemmas(before)))


def _parted(clause: Clause, words: Sequence[Token], main: int, source: str) -> list[Clause]:
    """A clause and the second deed of it: "sits reading a letter", "goes to the kitchen to make tea"."""
    if clause.verb not in grammar().postures or clause.quotes:
        return [clause]
    for place in range(main + 1, len(words)):
        gerund = _is_beside(words[place].low, words[place - 1].low)
        purpose = words[place - 1].low == "to" and _is_purpose(clause, words, place)
        if gerund or purpose:
            stop = place - 1 if purpose else place
            if stop <= main:
                continue
            head, tail = words[:stop], words[place:]
            lemmas = _lemmas(tail)
            joint = "to" if purpose else "ing"
            second = replace(clause, text=_text(source, tail), subject="", verb=lemmas[0], lemmas=lemmas, joint=joint)
            if len(head) - main == 1 and clause.verb in ("go", "come", "get") and purpose:
                return [replace(second, subject=clause.subject, joint=clause.joint)]  # "goes to make a coffee"
            return [replace(clause, text=_text(source, head), lemmas=_lemmas(head[main:])), second]
    return [clause]


def _is_beside(word: str, before: str) -> bool:
    """Whether a gerund is a second deed beside a posture or way: "lies there crying", not "the dining table"."""
    if not (word.endswith("ing") and verb_of(word)) or (is_adjective(before) and before not in _PARTICLES):
        return False
    return before not in (grammar().marks - {"to"}) | (grammar().prepositions - _PARTICLES)


def _is_purpose(clause: Clause, words: Sequence[Token], place: int) -> bool:
    """Whether a word after "to" is a second deed ("to drink a glass") and not where one goes ("from room to room")."""
    low = words[place].low
    if verb_of(low) != low or low in grammar().not_verbs_after_to:
        return False
    if not is_noun(low):
        return True
    if place + 1 == len(words):
        return clause.verb in ("sit", "lie", "stop", "stay", "settle", "kneel")
    after = words[place + 1].low
    return (
        after in grammar().marks | grammar().prepositions - {"and"}
        or after in ("him", "them", "me", "himself", "herself")
        or is_noun(after)
    )


def _subject(tokens: Sequence[Token]) -> str:
    """Who does it, of the words before the verb: those after the last comma-like stretch of time or place."""
    parts = [list(part) for is_mark, part in groupby(tokens, lambda token: token.text == ",") if not is_mark]
    if len(parts) > 1:  # "the baker, up since two, …", "one evening, Anna, tired, …"
        last = next((at for at in reversed(range(len(parts))) if _may_act(parts[at])), 0)
        named = next((at for at, part in enumerate(parts) if len(part) == 1 and _is_called([part[0].text])), last)
        if named < last and parts[last][0].low in _ARTICLES:  # "Mira, the tidy one, …"
            parts, last = [parts[named]], 0
        tokens = [token for part in parts[last:] for token in part]
    words = [token.text for token in tokens if token.text != ","]
    while words and (words[-1].lower() in grammar().adverbs or words[-1].lower().endswith("ly")):
        words.pop()
    if words and words[-1].lower() in grammar().subjects:
        return words[-1]
    while len(words) > 1 and words[-2].lower() not in grammar().marks and _only_describes(words[-1]):
        words.pop()  # "Daniel, unshaven, …"
    if words and words[0].lower() == "to":
        return ""
    if words and (
        _describes(words)
        or all(word.lower() in _MANNER | grammar().times | grammar().marks | {"one"} for word in words)
    ):
        return ""
    while words and (words[0].lower() in grammar().adverbs or words[0].lower() in grammar().joints):
        words.pop(0)
    if words and words[0].lower() in grammar().prepositions:  # "in the kitchen Anna …"
        starts = [place for place in range(2, len(words)) if _starts_subject(words, place)]
        return " ".join(words[starts[-1] :]) if starts else next((one for one in words[1:] if one[:1].isupper()), "")
    timed = bool(words) and (words[0][:1].islower() or words[0] in ("One", "Every", "Each", "That", "This"))
    starts = [place for place in range(1, len(words)) if _starts_subject(words, place)]
    starts = [place for place in starts if (timed and words[place].islower()) or _is_called(words[place:])]
    words = words[starts[-1] :] if starts else words  # "after dinner Jonas …", "that night the man …"
    return " ".join(words)


def _may_act(words: Sequence[Token]) -> bool:
    """Whether words between commas may be who does it."""
    known, first = grammar(), next((word for word in words if word.low not in grammar().adverbs), words[0])
    if len(words) == 1 and first.low in known.marks:
        return False  # "No, …"
    return first.low in known.subjects or (
        first.low not in known.prepositions
        and (first.low in known.marks or (first.text[:1].isupper() and not is_adjective(first.low)))
    )


def _describes(words: Sequence[str]) -> bool:
    """Whether words say how somebody is and name nobody: "Angry at himself for"."""
    low = words[0].lower()
    small = grammar().prepositions | grammar().adverbs | {"himself", "herself", "themselves", "myself"}
    others = [word for word in words[1:] if word.lower() not in small]
    names = any(is_noun(word.lower()) or word[:1].isupper() or word.lower() in grammar().subjects for word in others)
    return is_adjective(low) and not is_noun(low) and not names


def _only_describes(word: str) -> bool:
    return word[:1].islower() and is_adjective(word) and not is_noun(word)


def _starts_subject(words: Sequence[str], place: int) -> bool:
    """Whether a noun with its mark, or a name, begins there that no preposition goes before: "at last the news"."""
    before, word = words[place - 1], words[place]
    is_start = word.lower() in grammar().marks or (word[:1].isupper() and not before[:1].isupper())
    return is_start and before.lower() not in grammar().marks | grammar().prepositions


def _is_called(words: Sequence[str]) -> bool:
    """Whether a name begins there that is no part of a longer noun: "Jonas", not "German" of "German tourist"."""
    rest = next((word for word in words if not word[:1].isupper()), "of")
    return words[0][:1].isupper() and rest.lower() in grammar().prepositions


def _lemmas(tokens: Sequence[Token]) -> tuple[str, ...]:
    found = [lemma_of(token.text) for token in tokens if token.text[:1].isalnum()]
    if len(tokens) > 1 and tokens[0].low == "lay" and tokens[1].low in grammar().marks | grammar().numbers:
        found[0] = "lay"  # "I lay the table"
    return tuple(found)


def _quotes(tokens: Sequence[Token], quotes: Sequence[str]) -> tuple[str, ...]:
    return tuple(quotes[int(token.text[1:-1])] for token in tokens if token.text.startswith("«"))


def _text(source: str, tokens: Sequence[Token]) -> str:
    return " ".join(source[tokens[0].start : tokens[-1].end].split()) if tokens else ""
