"""English sentences taken apart: clauses with one verb each, in the order of time, with who does it and what is denied.

Sentences end where pysbd says. It is no grammar of English: enough to tell where one thing that happens ends and the
next begins.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, lru_cache
from itertools import groupby, takewhile
from typing import Any, Final

from planner_service.themes.asides import (
    ARTICLES,
    MANNER,
    OWNERS,
    RELATIVES,
    besides_of,
    without_asides,
    without_relative,
)
from planner_service.themes.clause import Clause
from planner_service.themes.constructions import meant
from planner_service.themes.lexicon import grammar, is_adjective, is_noun, kinds_of, lemma_of, participle, verb_of
from planner_service.themes.prose import prose_of
from planner_service.themes.sentence_order import in_story_time, long_ago
from planner_service.themes.sentence_pieces import Piece, in_time, is_led, pieces_of
from planner_service.themes.theme_words import theme_words
from planner_service.themes.verb_finder import FLOATING, NAMING, Token, has_verb, names, verb_place
from planner_service.themes.verb_group import NEARLY, verb_group

_QUOTE: Final = re.compile(r"[“\"]([^”\"\n]{1,400})[”\"]|(?<!\w)['‘]([^'’\n]{2,200}[.,!?])['’](?!\w)")
_PLAIN: Final = re.compile(r"[A-Za-z ,'’-]+[.!?]?\s*")
_SEMI: Final = re.compile(r"\n+|;\s+|:\s+|\s+[–—]\s*|\s*[–—]\s+|\s+-{1,2}\s+|…\s*|\.{2,}\s*|\s*[()\[\]]\s*")
_AT_ALL: Final = re.compile(r"\b(?:a single|so much as|even|any(?:thing|one|body)?)\b", re.IGNORECASE)
"""Words of what has not been done at all."""
_SUPPOSING: Final = frozenset(("if", "unless"))
"""Joints before what is only thought of: "if he calls"."""

_TITLE: Final = re.compile(r"\b(Mme|Mlle|Sgt|Capt|Col|Lt|Fr|Sr|St)\.(?= [A-Z])")
"""Titles whose full stop ends no sentence."""
_IDLE: Final = frozenset(
    ("do", "be", "have", "lose", "waste", "take", "make", "pay", "give", "get", "leave", "find", "see", "hear")
)
"""Verbs that with "nothing" or "no" tell of a deed all the same: "does nothing", "loses no time"."""
_LYING_AT: Final = frozenset(("on", "in", "there", "under", "beside", "next", "by", "across"))
"""Where somebody lies, who is said to lay."""
_FEWEST_DENYING: Final = 2
_PARTICLES: Final = frozenset(("on", "off", "down", "up", "around", "there", "back"))
_BULLET: Final = re.compile(
    r"(?:^\s*(?:\d{1,2}[.)]|[-*•])|(?<=[.!?;:] )\d{1,2}[.)]|(?<=\w )\d{1,2}\))\s+", re.MULTILINE
)
_HEADING: Final = re.compile(
    r"(?:^|(?<=[.!?] ))(?:\w+(?:['’]s)? ){0,3}(?:chores|routine|errands|tasks|plan|plans|schedule|to-?do(?: list)?"
    r"|list|diary|programme|agenda|chapter \w+|act \w+|scene \w+|part \w+|day \w+"
    r"|(?:mon|tues|wednes|thurs|fri|satur|sun)day(?: (?:morning|afternoon|evening|night))?"
    r"|morning|evening|afternoon|night|weekend): ",
    re.IGNORECASE | re.MULTILINE,
)
"""What stands over a text, and is nothing that happens: "Saturday chores: …"."""
_TIME: Final = re.compile(
    r"^(?:(?:about|nearly|almost|some|just|only) )?(?:\d+|an?|half an|one|two|three|four|five|six|seven|eight|nine|ten"
    r"|a few|several|many|a couple of) (?:seconds?|minutes?|hours?|days?|weeks?|months?|years?|nights?) "
    r"(?:into [^,.;]{1,60}|(?:after|before|from|past) (?:the|an?|his|her|their|my) (?:\w+ )?\w+), (?=\w)",
    re.IGNORECASE,
)
"""When it is: "Two hours into the power cut, Mei …"."""
_WHAT_IT_IS: Final = re.compile(
    r"(?<=\w):\s+((?:an?|the|his|her|their|my|some|one|two|three) [\w'’ -]{1,40})(?=\s*[.!?]|\s*$)", re.MULTILINE
)
"""What was meant before is named: "unwraps it: a birthday cake"."""
_SO: Final = re.compile(r"\bso (\w+)(?= (?:he|she|they|I|his|her|their|my) )")
"""What comes of how something is done: "laughs so hard | she has to sit down"."""
_BESIDE: Final = re.compile(
    r"(?<![,\w] )\b((?:[A-Z]\w+|[Tt]he|[Aa]n?)(?: \w+){0,2}), (?:her|his|their|my) (?:\w+ ){1,2}?\w+ing, (?=[a-z])"
)
"""How somebody is meanwhile, between who it is and what they do: "Grandma Ilse, her back aching, shuffles"."""
_MEANWHILE: Final = re.compile(
    r"(?<=\w)(,? (?:and|but)|,) (?:at (?:dawn|dusk|night|noon|midnight|sunrise|sunset|last)"
    r"|(?:(?:in|by) the (?:end|evening|morning)|by (?:dawn|dusk|noon|midnight)|(?:some|a long) time later"
    r"|after a (?:while|moment|bit|minute|pause|long time)"
    r"|(?:hours|minutes|moments|an hour|a minute|a moment) later)),? (?=([a-z]+)\b)"
)
"""When it is, between a joint and what is done then: "drinks coffee, and | at dawn | falls asleep"."""
_AGE: Final = re.compile(r"(?<=\w) \((\d{1,3})\)(?= [a-z])")
"""An age behind a name: "Henrik (74) waters the plants"."""


@lru_cache(maxsize=256)
def clauses_of_text(text: str) -> tuple[Clause, ...]:
    """What a text tells, in the order of time."""
    quotes: list[str] = []
    text = prose_of(text)
    text = _SO.sub(lambda one: f"{one[0]} that" if is_adjective(one[1].lower()) else one[0], text)
    text = _BESIDE.sub(r"\1 ", text)
    text = _MEANWHILE.sub(lambda one: f"{one[1]} " if verb_of(one[2]) not in ("", one[2]) else one[0], text)
    text = _TITLE.sub(r"\1", text.replace("«", "“").replace("»", "”"))  # which stand for what is said below

    def kept(match: re.Match[str]) -> str:
        quotes.append(match[1] or match[2])
        said = quotes[-1].rstrip()
        return f"«{len(quotes) - 1}»" + (
            ". " if said[-1:] in ".!?" and match.string[match.end() :].lstrip()[:1].isupper() else " "
        )

    found: list[list[Clause]] = []
    sentences = sentences_of(_QUOTE.sub(kept, text))
    past = long_ago(sentences)
    for number, sentence in enumerate(sentences):
        told: list[list[Clause]] = []
        doer = ""
        for piece in (pieces := pieces_of(sentence)):
            parts = _clause(piece, quotes, number)
            if number in past:
                parts = [replace(part, perfect=bool(part.verb)) for part in parts]
            parts = _sharing(_main(told[-1]), parts) if told else parts
            parts = [one for part in parts for one in meant(part)]
            own = _main(parts).subject or next(
                (one.subject for one in parts if one.verb and one.subject and not one.aside), ""
            )
            if own.lower() in RELATIVES and doer:
                own = _told_last(told, own.lower()) or doer
            told.append(
                [
                    replace(
                        part,
                        doer=part.subject if part.aside else (part.plainly and part.subject) or own or doer,
                        place=len(told),
                    )
                    for part in parts
                ]
            )
            beside = (
                is_led(piece.joint, ()) or _main(parts).absolute
            )  # "because guests are coming", "the coffee going cold"
            if (not doer and own.lower() != "it") or not beside:
                doer = own or doer
        found.append([part for place in in_time(pieces) for part in _as_supposed(told[place], pieces)])
    return tuple(in_story_time(sentences, found))


def _as_supposed(parts: Sequence[Clause], pieces: Sequence[Piece]) -> list[Clause]:
    """The clauses of a piece, denied where that would be so if something were: "if she were he, | she would knock"."""
    supposed = any(piece.joint in _SUPPOSING or piece.tokens[0].low in _SUPPOSING for piece in pieces)
    would = re.compile(r"^(?:\w+ )?(?:would|could|might)\b", re.IGNORECASE)
    return [replace(one, denied=True) if supposed and would.match(one.text) else one for one in parts]


def _told_last(told: Sequence[Sequence[Clause]], relative: str) -> str:
    """Somebody else whom the clause before ends with: "burps the baby, | who was sick"; of "who" a person, where one is
    named: "opens the door to the boy next door, | who waves"."""
    words = _main(told[-1]).text.split() if told else []
    people = [word for word in words[1:] if relative == "who" and lemma_of(word) in theme_words()["people"]]
    last = [*words[1:][-1:], *people][-1:]
    return f"the {last[0]}" if last and is_noun(last[0]) else ""


def _main(parts: Sequence[Clause]) -> Clause:
    """Of the clauses of a piece the one with its subject: what is told before it has no verb."""
    return next((part for part in parts if part.verb), parts[0])


def _sharing(before: Clause, parts: list[Clause]) -> list[Clause]:
    """A clause that shares the denial of the one before, whose verb is in its base form too: "does not eat | or drink",
    "wants to sit | and rest"; or after "nor", in any form: "neither eats | nor sleeps"."""
    unshared, first = parts, _main(parts)
    word = first.text.split(" ", 1)[0].lower()
    if not first.verb and verb_of(word) == word:  # "does not smoke, | drink or dance"
        parts = [replace(part, verb=word) if part is first else part for part in parts]
        first = next(part for part in parts if part.text == first.text)
    shared = before.perfect and before.joint not in grammar().earlier and not re.search(r"\bby\b", before.text)
    done = first.verb and not first.subject and first.joint in ("and", ",") and participle(first.verb)
    if shared and done == first.text.split(" ", 1)[0].lower():  # "had polished the spoons | and ironed the napkins"
        return [replace(part, perfect=True) if part is first else part for part in parts]
    listed = first.joint == "," and not first.subject and "neither" in before.text.split()
    if before.denied and (first.joint == "nor" or listed):
        return [replace(part, denied=True, unable=before.unable) if part is first else part for part in parts]
    shares = before.denied and first.verb and not first.subject and first.joint in ("or", "and", ",")
    bare = first.text.split(" ", 1)[0].lower() == first.verb and re.search(
        rf"\b{re.escape(before.verb)}\b", before.text
    )
    plain_present = first.joint != "or" and before.doer.lower() in ("i", "you", "we", "they")
    if not shares or not bare or plain_present:
        return unshared
    return [replace(part, denied=True, unable=before.unable) if part is first else part for part in parts]


def sentences_of(text: str) -> list[str]:
    """The sentences, lines and list items of a text, without marks at their ends."""
    text = _HEADING.sub("", _BULLET.sub(lambda one: "\n" if one.start() else "", text)) or text
    text = _WHAT_IT_IS.sub(_named_after, _AGE.sub(r", \1,", text))
    parts = [part for line in _SEMI.split(text) if line.strip() for part in _segments(line)]
    parts = [_TIME.sub("", part) for part in parts]
    return [part.strip(' \t.!?,;:-–—"“”') for part in parts if re.search(r"\w", part)]


def _named_after(found: re.Match[str]) -> str:
    """What stands after a colon, after a comma where it is no clause and follows one."""
    before = re.split(r"[.!?;:\n]", found.string[: found.start()])[-1]
    return f", {found[1]}" if has_verb(before) and not has_verb(found[1]) else found[0]


def _segments(line: str) -> list[str]:
    # What has no mark but commas before its end is one sentence: the library takes longer than all else to say so.
    if _PLAIN.fullmatch(line):
        return [line]
    return [part for some in _segmenter().segment(line) for part in _AFTER_MAY.split(some)]


_AFTER_MAY: Final = re.compile(r"(?<=\bMay\.) (?=[A-Z])")
"""Where pysbd takes the month for a title."""


@cache
def _segmenter() -> Any:
    from pysbd import Segmenter

    return Segmenter(language="en", clean=False)


def _is_only_when(piece: Piece) -> bool:
    """Whether it is told that nothing of it is done yet: "before she touches | a single plate"."""
    return piece.joint == "before" and _AT_ALL.search(piece.text) is not None


def _clause(piece: Piece, quotes: Sequence[str], sentence: int) -> list[Clause]:
    """The clauses of a piece: what is told before its subject, its own, second deeds without a joint, and asides."""
    tokens, relative = without_relative(_without_opening(piece.tokens))
    relative = list(piece.told) or relative
    place = 0 if piece.bare else None if piece.verbless else verb_place(tokens)
    if place is None:
        told = _quotes(tokens, quotes)
        return [Clause(piece.text, "", "", _lemmas(tokens), piece.joint, quotes=told, sentence=sentence)]
    place -= 2 * ([token.low for token in tokens[max(place - 2, 0) : place]] == ["no", "longer"])
    subject = _subject([token for token in tokens[:place] if not token.text.startswith("«")])
    subject = subject or (_who_there_is(tokens[place:]) if piece.tokens[0].low == "there" else "")
    if not subject and tokens[0].text.startswith("«"):
        subject = _inverted(tokens[place + 1 :])
        tokens = [*tokens[: place + 1], *tokens[place + 1 + len(subject.split()) :]]
    if not subject and _is_theirs(tokens, place):
        subject = " ".join(token.text for token in tokens[1:place])
    denials = _denials(tokens[:place], subject)
    words = denials + tokens[place:]
    group = verb_group(words)
    hindered = _is_hindered(piece.joint, tokens[:place], words[0])
    words, told_of = without_asides(words, group.place)
    lemmas = _lemmas(words[group.place :])
    first = Clause(
        _text(piece.source, words), subject, lemmas[0] if lemmas else "", lemmas, piece.joint,
        denied=group.denied or hindered or _does_none(words[group.place :]), unable=group.unable, perfect=group.perfect,
        absolute=bool(subject) and words[0].low.endswith("ing"),
        aside=piece.joint in _SUPPOSING or piece.tokens[0].low in ("if", "though") or _is_only_when(piece),
        quotes=_quotes(tokens, quotes), sentence=sentence,
    )  # fmt: skip
    parts = [first] if group.denied and not group.unable else _parted(first, words, group.place, piece.source)
    asides = [replace(one, sentence=sentence) for some in told_of for one in _aside(some, words, piece.source)]
    if relative:
        asides += [replace(one, sentence=sentence) for one in _aside(relative, tokens[:place], piece.source)]
    before = () if first.quotes else _before(tokens[:place], subject)
    besides = [
        # It tells how somebody is or where, and is nothing that anybody does.
        Clause(_text(piece.source, some), "", "", _lemmas(some), ",", aside=True, sentence=sentence)
        for some in (*besides_of(tokens[:place], subject, before), *_of_subject(tokens[:place], subject))
        if not set(denials).issuperset(some) and some[-1].low != "and"  # "my roommate and | I"
    ]
    if before and before[0].low in ("with", "after"):  # "With a sigh | Greta sits down"
        first = Clause(_text(piece.source, before), "", "", _lemmas(before), piece.joint, sentence=sentence)
        if any(one.verb for one in meant(first)):
            return [*besides, first, *parts, *asides]
    return [*besides, _placed(parts[0], before, piece.source), *parts[1:], *asides]


def _who_there_is(words: Sequence[Token]) -> str:
    """Somebody of whom it is told that there they are: "There is | a retired nurse"."""
    ends = grammar().prepositions | RELATIVES | {","}
    noun = list(takewhile(lambda token: token.low not in ends, words[1:])) if words[0].low in grammar().be else []
    called = [token for token in noun[:1] if token.text[:1].isupper() and not kinds_of(token.low)]
    is_somebody = noun and (called or noun[-1].low in theme_words()["people"] or noun[0].low in names())
    return " ".join(token.text for token in noun) if is_somebody else ""


def _is_theirs(tokens: Sequence[Token], place: int) -> bool:
    """Whether others are told doing it, after a preposition: "of his mother crying", "with the dog barking"."""
    words = theme_words()
    noun = lemma_of(tokens[place - 1].text) if place > 1 else ""
    others = noun in words["people"] or noun in words["no_heroes"] or tokens[place - 1].text[:1].isupper()
    return place > 1 and tokens[place].low.endswith("ing") and tokens[0].low in grammar().prepositions and others


def _of_subject(lead: Sequence[Token], subject: str) -> list[list[Token]]:
    """What a subject tells of who it is after its noun: "somebody | with a bad back"."""
    if any(token.text == "," for token in lead):
        return []  # it is told besides
    own = [token for token in lead if token.text in subject.split()][-len(subject.split()) :]
    leads = grammar().prepositions - {"of", "like"}
    start = next((at for at, token in enumerate(own) if at and token.low in leads), len(own))
    return [own[start:]] if len(own) - start > 1 else []


def _without_opening(tokens: Sequence[Token]) -> list[Token]:
    """Words without the adverbs and joints that they open with: not "too" of "too proud to ask", nor a denial."""
    known = grammar()
    for at, token in enumerate(tokens[:-1]):
        too = token.low == "too" and is_adjective(tokens[at + 1].low)
        if too or token.low in known.denials | NEARLY or token.low not in known.adverbs | {"and", "but", "or"}:
            return list(tokens[at:])
    return list(tokens if tokens[-1].low.endswith("ing") else tokens[-1:])  # "still chewing"


def _denials(lead: Sequence[Token], subject: str) -> list[Token]:
    """Of the words before a verb those that deny it; all of them where nobody is named."""
    known = grammar()
    denials = (
        (known.denials | NEARLY) - known.subjects - (known.with_gerund if subject else frozenset())
    )  # "without a word she"
    last = max((at for at, token in enumerate(lead) if token.text in subject.split()), default=0)
    commas = [at for at, token in enumerate(lead[:last]) if token.text == "," and lead[at - 1].low not in denials]
    apart = max(commas, default=0)  # "Not hungry, | Anna", but "never, she does sit still"
    denying = [token for token in lead[apart:] if token.low in denials]
    return denying if subject else list(lead) if any(token.low in known.denials | NEARLY for token in lead) else []


def _does_none(words: Sequence[Token]) -> bool:
    """Whether a deed is done to nothing, which denies it: "labels nothing more"; not of "does nothing"."""
    if len(words) < _FEWEST_DENYING or verb_of(words[0].low) in _IDLE:
        return False
    rest = [token.low for token in words[1:]]
    if {"but", "only", "except", "save"} & set(rest[1:]):
        return False  # "finds nobody there, only a parcel"
    none = rest[0] in ("nothing", "nobody", "none", "neither") or rest[:2] == ["no", "one"]
    return (none and rest[1:3] != ["in", "particular"]) or (rest[0] == "no" and rest[1:2] != ["longer"])


def _is_hindered(joint: str, lead: Sequence[Token], verb: Token) -> bool:
    """Whether something keeps one from a deed: "too proud | to ask", "before he could drink it"."""
    too = len(lead) > 2 and lead[-1].low == "to" and any(token.low == "too" for token in lead)
    return too or (joint in ("before", "until") and verb.low in ("can", "could"))


def _aside(words: list[Token], main: Sequence[Token], source: str) -> list[Clause]:
    """What is told of a noun of the main clause: it happened before or elsewhere, and somebody may have done it."""
    head = words[1:] if words[0].low in RELATIVES else words
    place = verb_place(head) or 0
    subject = _subject(head[:place]) or (words[0].text if place else main[-1].text)
    lemmas = _lemmas(head[place:])
    return [Clause(_text(source, words), subject, lemmas[0] if lemmas else "", lemmas, "that", aside=True)]


def _inverted(after: Sequence[Token]) -> str:
    """Who says it, where that stands after the verb: "“Who is there?” shouted Barnaby"."""
    if after and after[0].text[:1].isupper():
        return after[0].text
    return " ".join(token.text for token in after[:2]) if after and after[0].low in ARTICLES | OWNERS else ""


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
    if clause.quotes:
        return [clause]
    moves = clause.verb in grammar().postures
    for place in range(main + 1, len(words)):
        low, last = words[place].low, words[place - 1].low
        denied = last in ("not", "never") and low.endswith("ing") and bool(verb_of(low))
        theirs = clause.verb == "wait" and any(word.low == "for" for word in words[main:place])
        purpose = moves and last == "to" and not theirs and _is_purpose(words, place)
        if purpose and low in ("see", "check", "look") and any(word.low == "who" for word in words[place:]):
            continue  # "goes to see who it is": to the door
        if denied or purpose or (moves and _is_beside(low, last)):
            stop = place - (purpose or denied)
            if stop <= main:
                continue
            head, tail = words[:stop], words[place - denied :]
            lemmas = _lemmas(words[place:])
            second = replace(
                clause, text=_text(source, tail), subject="", verb=lemmas[0], lemmas=lemmas,
                joint="to" if purpose else "ing", denied=denied,
            )  # fmt: skip
            if len(head) - main == 1 and clause.verb in ("go", "come", "get") and purpose:
                return [replace(second, subject=clause.subject, joint=clause.joint)]  # "goes to make a coffee"
            return [replace(clause, text=_text(source, head), lemmas=_lemmas(head[main:])), second]
    return [clause]


def _is_beside(word: str, before: str) -> bool:
    """Whether a gerund is a second deed beside a posture or way: "lies there crying", not "the dining table"."""
    if not (word.endswith("ing") and verb_of(word) not in ("", word)) or (
        is_adjective(before) and before not in _PARTICLES
    ):
        return False
    return before not in (grammar().marks - {"to"}) | (grammar().prepositions - _PARTICLES)


def _is_purpose(words: Sequence[Token], place: int) -> bool:
    """Whether a word after "to" is a second deed ("to drink a glass") and not where one goes ("from room to room")."""
    low, after = words[place].low, words[place + 1].low if place + 1 < len(words) else ""
    if verb_of(low) != low or low in grammar().not_verbs_after_to:
        return False
    return not is_noun(low) or is_noun(after) or after in grammar().marks | grammar().prepositions


def _subject(tokens: Sequence[Token]) -> str:
    """Who does it, of the words before the verb: those after the last comma-like stretch of time or place."""
    parts = [list(part) for is_mark, part in groupby(tokens, lambda token: token.text == ",") if not is_mark]
    last = next((at for at in reversed(range(len(parts))) if _may_act(parts[at])), 0)  # "the baker, up since two, …"
    alone = (at for at, part in enumerate(parts) if len(part) == 1 and _may_act(part) and _is_called([part[0].text]))
    named = next(alone, last)
    if named < last and parts[last][0].low in ARTICLES:  # "Mira, the tidy one, …"
        return parts[named][0].text
    words = [token.text for token in (parts[last] if parts else ())]
    while words and (words[-1].lower() in grammar().adverbs or (words[-1].islower() and words[-1].endswith("ly"))):
        words.pop()
    if len(words) > 1 and words[-1].lower() in FLOATING and words[-2].lower() in grammar().subjects:
        words.pop()
    if len(words) > 1 and words[-1].lower() == "neither":  # "the widow | neither eats"
        words.pop()
    if words and words[-1].lower() in grammar().subjects:
        return words[-1]
    if tokens and tokens[-1].low in theme_words()["daytimes"] and len(words) == 1:
        return words[0]  # "dusk thickened"
    if words and ("to" in (words[0].lower(), words[-1].lower()) or _describes(words)):
        return ""
    while words and (words[0].lower() in grammar().adverbs or words[0].lower() in grammar().joints):
        words.pop(0)
    if words and words[0].lower() in grammar().prepositions:  # "in the kitchen Anna …"
        starts = [place for place in range(2, len(words)) if _starts_subject(words, place)]
        return " ".join(words[starts[-1] :]) if starts else next((one for one in words[1:] if one[:1].isupper()), "")
    starts = [place for place in range(1, len(words)) if _starts_subject(words, place)]
    starts = [place for place in starts if words[place].islower() or _is_called(words[place:])]
    return " ".join(words[starts[-1] :] if starts else words)  # "that night | the man …"


def _may_act(words: Sequence[Token]) -> bool:
    """Whether words between commas may be who does it."""
    known, first = grammar(), next((word for word in words if word.low not in grammar().adverbs), words[0])
    if (len(words) == 1 and first.low in known.marks) or theme_words()["wheres"].issuperset(one.low for one in words):
        return False  # "No, …", "Upstairs, …"
    return first.low in known.subjects or (
        first.low not in known.prepositions
        and (first.low in known.marks or (first.text[:1].isupper() and not is_adjective(first.low)))
    )


def _describes(words: Sequence[str]) -> bool:
    """Whether words say how somebody is, or when, and name nobody: "Angry at himself for", "one evening"."""
    low = [word.lower() for word in words]
    if low == ["no", "one"]:
        return False
    times = MANNER | grammar().times | grammar().marks | {"one"}
    names = any(is_noun(word) or word in grammar().subjects for word in low[1:]) or any(
        one[:1].isupper() for one in words[1:]
    )
    return all(word in times for word in low) or (is_adjective(low[0]) and not is_noun(low[0]) and not names)


def _starts_subject(words: Sequence[str], place: int) -> bool:
    """Whether a noun with its mark, or a name, begins there that no preposition goes before: "at last the news"."""
    before, word = words[place - 1], words[place]
    if before.lower() in NAMING | {"and"} | (theme_words()["people"] if place > 1 else frozenset()):
        return False  # "a robot named | Bolt", "Marta and | her husband", "her husband | Tom"
    day = before.lower() in grammar().times  # "on Wednesday | Hester"
    is_start = word.lower() in grammar().marks or (word[:1].isupper() and (day or not before[:1].isupper()))
    return is_start and before.lower() not in grammar().marks | grammar().prepositions


def _is_called(words: Sequence[str]) -> bool:
    """Whether a name begins there that is no part of a longer noun: "Jonas", not "German" of "German tourist"."""
    rest = next((word for word in words if not word[:1].isupper()), "of")
    return words[0][:1].isupper() and rest.lower() in grammar().prepositions


def _lemmas(tokens: Sequence[Token]) -> tuple[str, ...]:
    found = [lemma_of(token.text) for token in tokens if token.text[:1].isalnum()]
    if len(tokens) > 1 and tokens[0].low == "lay" and tokens[1].low in grammar().marks | grammar().numbers:
        found[0] = "lay"  # "I lay the table"
    at = 1 + ([token.low for token in tokens[1:2]] in (["down"], ["back"]))
    if found[:1] == ["lay"] and (tokens[at].low in _LYING_AT if len(tokens) > at else at > 1):  # "he lays on the sofa"
        found[0] = "lie"
    return tuple(found)


def _quotes(tokens: Sequence[Token], quotes: Sequence[str]) -> tuple[str, ...]:
    return tuple(quotes[int(token.text[1:-1])] for token in tokens if token.text.startswith("«"))


def _text(source: str, tokens: Sequence[Token]) -> str:
    return " ".join(source[tokens[0].start : tokens[-1].end].split()) if tokens else ""
