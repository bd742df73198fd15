"""English sentences taken apart: clauses with one verb each, in the order of time, with who does it and what is denied.

Sentences end where pysbd says; which words are verbs is told by their forms (lexicon) and by the words before them. It is
no grammar of English: enough to tell where one thing that happens ends and the next begins.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, Final

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

_WORD: Final = re.compile(r"«\d+»|\b(?:Mrs?|Ms|Dr|Prof)\.|[^\W_]+(?:['’-][^\W_]+)*|[^\w\s]", re.UNICODE)
_CONTRACTION: Final = re.compile(r"(?i)\b(ca|wo|sha|[a-z]+?)n['’]t\b")
_SHORT: Final = {"ca": "can not", "wo": "will not", "sha": "shall not"}
_ENDS: Final = (("'ll", " will"), ("'ve", " have"), ("'re", " are"), ("'m", " am"))
_QUOTE: Final = re.compile(r"[“\"]([^”\"\n]{1,400})[”\"]|(?<!\w)['‘]([^'’\n]{2,200}[.,!?])['’](?!\w)")
_SEMI: Final = re.compile(r"\n+|;\s+|:\s+|\s+[–—]\s*|\s*[–—]\s+|\s+-{1,2}\s+|…\s*|\.{2,}\s*|\s*[()\[\]]\s*")
_BULLET: Final = re.compile(r"^\s*(?:\d{1,2}[.)]|[-*•])\s+", re.MULTILINE)


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
    quotes: tuple[str, ...] = ()
    """What is said in it."""
    sentence: int = 0
    """Index of its sentence in the text."""


def clauses_of_text(text: str) -> tuple[Clause, ...]:
    """What a text tells, in the order of time."""
    quotes: list[str] = []

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
            main = parts[0].subject or (_next_subject(pieces, piece) if not told else "")
            doer = main or doer
            told.append([replace(part, doer=doer) for part in parts])
        found += [part for place in _in_time(pieces) for part in told[place]]
    return tuple(found)


def _next_subject(pieces: Sequence[_Piece], piece: _Piece) -> str:
    """Who does what opens a sentence without a subject: "before going to bed, she brushes her teeth"."""
    if piece.joint not in grammar().earlier | grammar().with_gerund | {"before", "until", "while", "when"}:
        return ""
    return next((part.subject for other in pieces for part in _clause(other, (), 0)[:1] if part.subject), "")


def sentences_of(text: str) -> list[str]:
    """The sentences, lines and list items of a text, without marks at their ends."""
    parts = [part for line in _SEMI.split(_BULLET.sub("", text)) if line.strip() for part in _segmenter().segment(line)]
    return [part.strip(' \t.!?,;:-–—"“”') for part in parts if re.search(r"\w", part)]


@cache
def _segmenter() -> Any:
    from pysbd import Segmenter

    return Segmenter(language="en", clean=False)


def tokens_of(text: str) -> list[Token]:
    """Words and marks; "can't" is "can not"."""
    return [Token(match[0], match.start(), match.end()) for match in _WORD.finditer(text)]


_SLANG: Final = {"n": "and", "n'": "and", "'n'": "and", "cant": "can not", "wont": "will not", "gonna": "going to",
                 "wanna": "want to", "gotta": "have to", "cuz": "because", "bc": "because", "w/": "with", "&": "and"}  # fmt: skip
_SLANG_NOT: Final = re.compile(r"(?i)\b(do|does|did|is|was|are|could|would|has|had|have|should)nt\b")


def plain(text: str) -> str:
    """A text with its contractions and the commonest slang written out: "doesn't" is "does not"."""
    text = _SLANG_NOT.sub(r"\1 not", text.replace("’", "'").replace("‘", "'"))
    text = " ".join(_SLANG.get(word.lower(), word) for word in text.split(" "))
    text = _CONTRACTION.sub(lambda m: _SHORT.get(m[1].lower(), f"{m[1]} not"), text)
    for short, whole in _ENDS:
        text = re.sub(rf"(?i)(?<=\w){short}\b", whole, text)
    text = re.sub(r"(?i)\bby the time\b", "when", text)
    return re.sub(
        r"\b(I|[Hh]e|[Ss]he|[Tt]hey|[Ww]e)'d\b", r"\1 had", re.sub(r"\b([Hh]e|[Ss]he|[Ii]t)'s\b", r"\1 is", text)
    )


@dataclass(frozen=True)
class _Piece:
    """A stretch of a sentence, the joint before it, and where its verb stands."""

    joint: str
    tokens: tuple[Token, ...]
    source: str = field(repr=False)

    @property
    def text(self) -> str:
        return self.source[self.tokens[0].start : self.tokens[-1].end] if self.tokens else ""


def verb_place(tokens: Sequence[Token]) -> int | None:
    """Where the first verb or auxiliary of a clause stands; None where it has none."""
    for place, token in enumerate(tokens):
        if token.low in grammar().auxiliaries or _acts(tokens, place):
            return place
    return None


def has_verb(text: str) -> bool:
    """Whether some word of the text acts as a verb."""
    return verb_place(tokens_of(plain(text))) is not None


def _acts(tokens: Sequence[Token], place: int) -> bool:
    """Whether the word there acts as a verb, going by its form and the words about it."""
    token = tokens[place]
    base = verb_of(token.text)
    if not base:
        return False
    at = place - 1
    while at >= 0 and (
        tokens[at].low in grammar().adverbs or (tokens[at].low.endswith("ly") and not is_noun(tokens[at].low))
    ):
        at -= 1
    before = tokens[at].low if at >= 0 else ""
    after = tokens[place + 1].low if place + 1 < len(tokens) else ""
    if before in grammar().subjects or before in grammar().modals or before in ("do", "does", "did"):
        return True
    if before in ("to",):
        return token.low == base and base not in grammar().not_verbs_after_to
    if before in grammar().numbers and at and tokens[at - 1].low == "of":
        return is_third_person(token.low)
    if before in grammar().marks | grammar().numbers or (
        before in grammar().prepositions and not token.low.endswith("ing")
    ):
        return False
    goes_on = not after or after in grammar().marks or after in grammar().prepositions or after in grammar().adverbs or after in grammar().subjects | {"him", "them", "me", "himself", "herself", "back", "home", "and"} or after.endswith("ly")  # fmt: skip
    if at < 0:
        if token.low.endswith("ing"):
            return not is_noun(token.low) or bool(after)
        sure = is_third_person(token.low) or participle(base) != past(base) == token.low  # "fell", "woke"
        if is_adjective(token.low) and not (sure or after in grammar().marks | grammar().prepositions):
            return False
        if is_third_person(token.low) or token.low != base:
            return not (is_noun(token.low) and verb_of(after) and not (is_noun(after) or after.endswith("ing")))
        return not is_noun(token.low) or (goes_on and bool(after))
    if token.low.endswith("ing"):
        return (
            before in grammar().with_gerund
            or tokens[0].low == "instead"
            or (before not in grammar().prepositions and not is_noun(token.low))
        )
    beside = token.start == tokens[at].end + 1
    if beside and is_adjective(before) and not is_noun(before) and is_noun(token.low):
        return False
    if is_adjective(token.low) and (
        before in grammar().be or before in ("feels", "felt", "seems", "looks", "gets", "becomes")
    ):
        return False
    if base in ("name", "call") and token.low != base and at >= 0 and after and tokens[place + 1].text[:1].isupper():
        return False  # "a teacher named Edith"
    if (
        before.endswith("ing")
        and not is_noun(before)
        and tokens[0].low in grammar().marks | grammar().numbers
        and at <= 1
    ):
        return False  # "some jumping jacks"
    lower = tokens[at].text[:1].islower() and before not in grammar().subjects
    if tokens[0].low in grammar().prepositions and lower and is_noun(token.low):
        return False  # "under the sofa cushions"
    if token.low == base:
        same = base in grammar().unchanging and (is_noun(before) or not kinds_of(before))  # "Anna put …"
        return same or (_is_plural(before) and not is_noun(token.low))
    if is_noun(token.low) and token.low.endswith("s"):
        return goes_on or is_adjective(after) or is_noun(after)
    return True


def _is_plural(word: str) -> bool:
    nouns = kinds_of(word).get("NOUN", ())
    return bool(nouns) and word not in nouns


def _pieces(sentence: str) -> list[_Piece]:
    """The sentence cut at commas and joining words, wherever a verb follows."""
    source = plain(sentence)
    tokens = tokens_of(source)
    cut: list[_Piece] = []
    joint, current = "", list[Token]()
    for place, token in enumerate(tokens):
        if token.text == "," or (
            token.low in grammar().joints and _joins(tokens, place) and (not current or _may_end(token.low, current))
        ):
            if current:
                cut.append(_Piece(joint, tuple(current), source))
                joint, current = "", []
            joint = token.low if joint in ("", ",", "and", "but") and token.text != "," else joint or ","
            if token.low in grammar().with_gerund:
                current.append(token)
        else:
            led = (
                current and (current[0].low in grammar().with_gerund or current[0].low == "to")
            ) or joint in grammar().earlier | {
                "before",
                "until",
                "while",
            }
            if led and token.low in ("he", "she", "they", "i", "we") and verb_place(current) is not None:
                cut.append(_Piece(joint, tuple(current), source))
                joint, current = ",", []
            current.append(token)
    if current:
        cut.append(_Piece(joint, tuple(current), source))
    return _whole(cut)


def _joins(tokens: Sequence[Token], place: int) -> bool:
    """Whether a joining word joins clauses here: "as soon as", "so tired" and "before dinner" do not."""
    low = tokens[place].low
    rest = tokens[place + 1 :]
    if low == "once" and place and tokens[place - 1].low in ("at", "for", "more", "all"):
        return False
    if low == "while" and place and tokens[place - 1].low in ("a", "long", "little", "short"):
        return False
    if low == "as":
        return bool(rest) and rest[0].low in grammar().subjects | grammar().marks and verb_place(rest[:6]) is not None
    if low in ("so", "yet", "once", "since", "then", "where", "or"):
        return bool(rest) and (low == "then" or rest[0].low in grammar().subjects or (low in ("so", "or") and verb_place(rest[:2]) is not None) or (low in ("once", "since", "where") and (rest[0].low in grammar().marks or rest[0].text[:1].isupper()) and verb_place(rest[:5]) not in (None, 0)))  # fmt: skip
    if low in ("after", "before", "until", "without", "instead"):
        return bool(rest) and (
            _starts_gerund(rest) or rest[0].low in grammar().subjects or (low != "instead" and _clause_follows(rest))
        )
    return True


def _may_end(joint: str, current: Sequence[Token]) -> bool:
    """Whether what stands before a joint can be a clause of its own: not "a nurse" of "a nurse after a night shift"."""
    return joint not in grammar().earlier | {"before", "until", "without"} or verb_place(current) is not None


def _starts_gerund(rest: Sequence[Token]) -> bool:
    at = 1 if rest[0].low in ("of", "even", "ever", "finally") and len(rest) > 1 else 0
    word = rest[at].low
    return word.endswith("ing") and bool(verb_of(word))


def _clause_follows(rest: Sequence[Token]) -> bool:
    """Whether a subject and its verb follow before the next comma: "after the phone rings", not "after dinner"."""
    end = next((i for i, token in enumerate(rest) if token.text == "," or token.low in ("and", "but")), len(rest))
    head = list(rest[: min(end, 6)])
    place = verb_place(head)
    return (
        place is not None
        and place > 0
        and head[place - 1].low not in grammar().subjects | {","}
        or (place is not None and place > 0)
    )


def _whole(pieces: list[_Piece]) -> list[_Piece]:
    """Pieces without a verb put to the one before ("bread and butter"), or to the one after ("one evening, …")."""
    whole: list[_Piece] = []
    waiting: _Piece | None = None
    for piece in pieces:
        if waiting is not None:
            joint = waiting.joint if waiting.joint not in (",", "") else piece.joint if piece.joint != "," else ""
            piece = replace(piece, joint=joint, tokens=waiting.tokens + piece.tokens)
            waiting = None
        if verb_place(piece.tokens) is not None and not (whole and _is_noun_list(whole[-1], piece)):
            whole.append(piece)
        elif whole:
            whole[-1] = replace(whole[-1], tokens=whole[-1].tokens + piece.tokens)
        else:
            waiting = piece
    return [*whole, waiting] if waiting is not None else whole


def _is_noun_list(last: _Piece, piece: _Piece) -> bool:
    """Whether a single word goes on with the nouns before it: "cakes and drinks", but not "eats and drinks"."""
    words = piece.tokens
    if len(words) > 1 or not is_noun(words[0].low):
        return False
    end, word = last.tokens[-1].low, words[0].low
    if is_third_person(word):
        return _is_plural(end) and len(last.tokens) > 2 and last.tokens[-2].low not in grammar().marks
    return is_noun(end) and word == verb_of(word)


def _in_time(pieces: Sequence[_Piece]) -> list[int]:
    """Places of pieces in the order they happen: "B after A" is A, B; "before B, A" is A, B."""
    ordered: list[int] = []
    later = len(pieces) > 1 and pieces[0].joint == "before"
    first_is_later = len(pieces) > 1 and pieces[0].joint in ("until", "instead", "without")
    for place, piece in enumerate(pieces):
        if ordered and piece.joint in grammar().earlier:
            main = pieces[ordered[-1]]
            is_state = any(token.low in grammar().be for token in main.tokens[:3])
            if piece.joint == "as" or (is_state and piece.joint != "after"):
                ordered.append(place)
            else:
                ordered.insert(len(ordered) - 1, place)
        else:
            ordered.append(place)
    if later:
        return [*ordered[1:], ordered[0]]
    return [*ordered[1:2], ordered[0], *ordered[2:]] if first_is_later else ordered


def _clause(piece: _Piece, quotes: Sequence[str], sentence: int) -> list[Clause]:
    """The clause of a piece, and second deeds in it that stand without a joint."""
    tokens = list(piece.tokens)
    joint = piece.joint
    while (
        tokens
        and tokens[0].low in grammar().adverbs | {"and", "but", "or"}
        and tokens[0].low not in grammar().denials
        and len(tokens) > 1
    ):
        tokens.pop(0)
    place = verb_place(tokens)
    if place is None:
        return [Clause(piece.text, "", "", _lemmas(tokens), joint, quotes=_quotes(tokens, quotes), sentence=sentence)]
    subject = _subject(tokens[:place])
    denials = grammar().denials - grammar().subjects
    lead = tokens[:place] if not subject else [t for t in tokens[:place] if t.low in denials]
    words = (lead if any(token.low in grammar().denials for token in lead) else []) + tokens[place:]
    if words and words[0].low in grammar().adverbs - grammar().denials and len(words) > 1:
        words = words[1:]
    main, denied, unable, perfect = _main_verb(words)
    lemmas = _lemmas(words[main:])
    first = Clause(
        _text(piece.source, words), subject, lemmas[0] if lemmas else "", lemmas, joint, denied=denied, unable=unable,
        perfect=perfect, quotes=_quotes(tokens, quotes), sentence=sentence,
    )  # fmt: skip
    return [first] if denied and not unable else _parted(first, words, main, piece.source)


def _parted(clause: Clause, words: Sequence[Token], main: int, source: str) -> list[Clause]:
    """A clause and the second deed of it: "sits reading a letter", "goes to the kitchen to make tea"."""
    if clause.verb not in grammar().postures or clause.quotes:
        return [clause]
    for place in range(main + 1, len(words)):
        low, before = words[place].low, words[place - 1].low
        gerund = (
            low.endswith("ing")
            and bool(verb_of(low))
            and before not in grammar().marks - {"to"}
            and not is_adjective(before)
        )
        gerund = gerund and before not in grammar().prepositions - {
            "on",
            "off",
            "down",
            "up",
            "around",
            "there",
            "back",
        }
        purpose = (
            before == "to"
            and verb_of(low) == low
            and low not in grammar().not_verbs_after_to
            and _is_purpose(clause, words, place)
        )
        if gerund or purpose:
            stop = place - 1 if purpose else place
            if stop <= main:
                continue
            head, tail = words[:stop], words[place:]
            lemmas = _lemmas(tail)
            second = replace(clause, text=_text(source, tail), subject="", verb=lemmas[0], lemmas=lemmas, joint="to" if purpose else "ing")  # fmt: skip
            if len(head) - main == 1 and clause.verb in ("go", "come", "get") and purpose:
                return [replace(second, subject=clause.subject, joint=clause.joint)]  # "goes to make a coffee"
            return [replace(clause, text=_text(source, head), lemmas=_lemmas(head[main:])), second]
    return [clause]


def _is_purpose(clause: Clause, words: Sequence[Token], place: int) -> bool:
    """Whether a word after "to" is a second deed ("to drink a glass") rather than where one goes ("from room to room")."""
    low = words[place].low
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


def _main_verb(words: Sequence[Token]) -> tuple[int, bool, bool, bool]:
    """Where the verb of the deed stands; whether it is denied or wished for, cannot be done, was done before."""
    denied = unable = perfect = False
    at = 0
    while at < len(words):
        low = words[at].low
        base = verb_of(low)
        ahead = words[at + 1].low if at + 1 < len(words) else ""
        if low in grammar().denials:
            denied = True
            unable = unable or (at > 0 and words[at - 1].low in ("can", "could", "cannot"))
            if low in grammar().with_gerund and ahead == "of":
                at += 1
        elif low == "cannot":
            denied = unable = True
        elif low == "no" and ahead == "longer":
            denied, at = True, at + 1
        elif low in ("will", "would", "should", "must", "may", "might", "ought"):
            denied = denied or (
                low in ("would", "should", "might")
                and bool(verb_place(words[at + 1 : at + 3]) is not None)
                and low != "would"
            )
        elif low == "had" and _participle_follows(words, at):
            perfect = True
        elif (
            low == "going"
            and ahead == "to"
            and at + 2 < len(words)
            and verb_of(words[at + 2].low) == words[at + 2].low
            and words[at + 2].low not in grammar().not_verbs_after_to
        ):
            denied, at = True, at + 1
        elif low in grammar().auxiliaries and _verb_follows(words, at):
            pass
        elif low in ("unable", "about", "afraid", "too") and "to" in [token.low for token in words[at : at + 3]]:
            denied, unable = True, low == "unable"
            at += [token.low for token in words[at : at + 3]].index("to")
        elif base in grammar().refusals and (ahead == "to" or ahead.endswith("ing")):
            denied, at = True, at + (ahead == "to")
        elif base in grammar().wishes and (
            ahead == "to" or (base in ("consider", "imagine") and ahead.endswith("ing"))
        ):
            denied, at = True, at + (ahead == "to")
        elif base == "stop" and ahead.endswith("ing"):
            denied = True
        elif base in ("decide", "try", "choose", "prefer", "promise") and ahead == "not":
            denied, at = True, at + 1 + (at + 2 < len(words) and words[at + 2].low == "to")
        elif base in grammar().aspects and (jump := _aspect(words, at)):
            at = jump - 1
        elif low in grammar().adverbs or (low.endswith("ly") and not base):
            pass
        else:
            break
        at += 1
    return min(at, len(words) - 1), denied, unable, perfect


def _verb_follows(words: Sequence[Token], at: int) -> bool:
    """Whether an auxiliary is followed by the verb it helps: "is reading", "does sit", not "is tired" or "has a bath"."""
    for token in words[at + 1 : at + 4]:
        low = token.low
        if (
            low in grammar().denials
            or low in grammar().adverbs
            or low in grammar().auxiliaries
            or (low.endswith("ly") and not verb_of(low))
        ):
            continue
        base = verb_of(low)
        helper = words[at].low
        if helper in grammar().be:
            return bool(base) and low.endswith("ing")
        if helper in grammar().have:
            return bool(base) and low != base and not low.endswith("ing")
        return bool(base)
    return False


def _participle_follows(words: Sequence[Token], at: int) -> bool:
    return _verb_follows(words, at) or (at + 1 < len(words) and words[at + 1].low == "been")


def _aspect(words: Sequence[Token], at: int) -> int:
    """Where the deed of an aspect stands, 0 where the verb is the deed itself ("goes home", "tries a new recipe")."""
    base = verb_of(words[at].low)
    for place in range(at + 1, min(at + 7, len(words))):
        low = words[place].low
        if low == "to" and place + 1 < len(words):
            after = words[place + 1].low
            if (
                place == at + 1
                and base not in ("go", "come", "spend", "keep", "finish", "end", "resume")
                and verb_of(after) == after
            ):
                return place + 1 if after not in grammar().not_verbs_after_to else 0
            return 0
        if low.endswith("ing") and verb_of(low) and base not in ("need", "have", "decide", "help", "use"):
            before = words[place - 1].low
            if (
                place == at + 1
                or (base == "end" and before == "up")
                or (base == "spend" and before not in grammar().marks)
            ):
                return place
        if base not in ("spend", "end", "keep", "try") or low in ("and",):
            return 0
    return 0


def _subject(tokens: Sequence[Token]) -> str:
    """Who does it, of the words before the verb: those after the last comma-like stretch of time or place."""
    words = [token.text for token in tokens]
    while words and (words[-1].lower() in grammar().adverbs or words[-1].lower().endswith("ly")):
        words.pop()
    if words and words[-1].lower() in grammar().subjects:
        return words[-1]
    if words and words[0].lower() == "to":
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
    return tuple(lemma_of(token.text) for token in tokens if token.text[:1].isalnum())


def _quotes(tokens: Sequence[Token], quotes: Sequence[str]) -> tuple[str, ...]:
    return tuple(quotes[int(token.text[1:-1])] for token in tokens if token.text.startswith("«"))


def _text(source: str, tokens: Sequence[Token]) -> str:
    return " ".join(source[tokens[0].start : tokens[-1].end].split()) if tokens else ""
