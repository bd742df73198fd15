"""English sentences taken apart: stretches with one verb each, in the order of time, without their subjects.

Which words are verbs: enough of English to tell where one event of a theme ends and the next begins.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from planner_service.scripts.emotions import feelings
from planner_service.themes.lexicon import english_verbs, is_verb

_SUBJECTS: Final = frozenset(("he", "she", "they", "it", "i", "we", "you", "who"))


def has_verb(text: str) -> bool:
    """Whether some word of the text acts as a verb: a known form that does not follow a noun's mark, or any word right
    after a pronoun ("he yodels")."""
    words = re.findall(r"[a-z]+(?:'[a-z]+)?", text.lower())
    verbs, before_nouns = english_verbs().read, english_verbs().before_nouns_read.split()
    for index, word in enumerate(words):
        before = words[index - 1] if index else ""
        if before in _SUBJECTS or (before == "to" and word in verbs):
            return True
        if word in verbs and before not in before_nouns:
            return True
    return False


_PEOPLE: Final = (
    "person|character|man|woman|boy|girl|guy|student|child|kid|father|mother|writer|worker|old man|old woman"
)
_SUBJECT: Final = re.compile(
    rf"^(?:(?:(?:the|a|an|this|our|one|some)\s+)?(?:\w+\s+)?(?:{_PEOPLE})|he|she|they|someone|somebody)\s+"
    r"(?=\w)(?!of\b|in\b|on\b|at\b|with\b)",
    re.IGNORECASE,
)
_PRONOUN: Final = r"(?:he|she|they|it|the|a|an|his|her|their|someone|somebody|everything|nobody)"
_ABBREVIATION: Final = re.compile(r"\b(Mr|Mrs|Ms|Dr|St|Prof)\.", re.IGNORECASE)
_SENTENCE: Final = re.compile(r"(?<=[.!?])[\"'”’)]*\s+|\n+|[;:]\s+|\s+[–—-]\s+|…|\.{2,}")
_BULLET: Final = re.compile(r"^\s*(?:\d{1,2}[.)]|[-*•])\s+")
_LATER: Final = r"(?:then|afterwards?|after that|later|finally|eventually|suddenly|next(?! to)|soon|at last|in the end)"
_JOINT: Final = re.compile(
    r"\s*,?\s*\b(?P<word>"
    rf"(?:and|but|so)?,?\s*{_LATER}(?=[\s,])|and so|and|but|so(?=\s+{_PRONOUN}\b)|yet(?=\s+{_PRONOUN}\b)"
    rf"|before|after|until|when(?:ever)?|while|because|as soon as|once(?=\s+{_PRONOUN}\b)|since(?=\s+{_PRONOUN}\b)"
    rf"|as(?=\s+(?:he|she|they|it)\b)|although|though"
    r")\b,?\s*|\s*,\s*",
    re.IGNORECASE,
)
_BY_THEN: Final = re.compile(
    r"^(before|after|during|until) ((?:the|his|her|their|a|an) (?:\w+ )?\w+)"
    r" (?=(?:he|she|they|the \w+|(?-i:[A-Z])\w+)\b)",
    re.IGNORECASE,
)
"""A time that is told by a thing, with no comma after it: "before the interview he is nervous"."""
_ANOTHER: Final = re.compile(r"^(?:someone|somebody)\b.*\b(?:his|her|him)\b", re.IGNORECASE)
"""Somebody who does something to whom the story is about."""
_GOES_ON: Final = re.compile(r"^(?:it|everything|all) (?:is|was|gets|got|becomes|became)\b", re.IGNORECASE)
_NO_NAME_WORDS: Final = """thunder lightning rain snow wind music hunger fear sleep love work lunch dinner breakfast
nothing everything noise guests friends summer winter spring autumn money nobody everybody somebody someone everyone"""
_NO_NAMES: Final = frozenset(_NO_NAME_WORDS.split())
"""What stands before a verb at the beginning of a sentence and is nobody's name."""
_EARLIER: Final = frozenset(("after", "when", "whenever", "because", "as soon as", "once", "since", "as"))
"""What follows these happened first."""
_STATE: Final = re.compile(
    r"^(?:(?:is|are|was|were|feel|feels|felt|become|becomes|became|get|gets|got|grow|grows|grew|seems?|being|turns?)\b)"
    r"(?P<rest>.*)$",
    re.IGNORECASE,
)
_FILLER_WORDS: Final = """very really so too quite extremely deeply totally a bit little more and at first again now
suddenly all completely rather still finally even then or much no not longer any anymore"""
_FILLER: Final = frozenset(_FILLER_WORDS.split())
STRONG: Final = re.compile(r"\b(?:very|extremely|deeply|totally|completely|terribly|utterly)\b", re.IGNORECASE)


@dataclass(frozen=True)
class _Piece:
    """A stretch of a sentence and the word that joined it to the one before."""

    joint: str
    text: str


def sentences_of(text: str) -> list[str]:
    """The sentences, lines and list items of a text, without marks at their ends."""
    parts = _SENTENCE.split(_ABBREVIATION.sub(r"\1", _BULLET.sub("", text)))
    return [_BULLET.sub("", part).strip(" .!?,\"'“”‘’()") for part in parts if part.strip(" .!?,\"'")]


def moments_of(sentence: str) -> list[str]:
    """What happens in a sentence, one stretch of it a moment, in the order of time."""
    return [piece.text for piece in _in_time(_whole(_pieces(sentence)))]


def _pieces(sentence: str) -> list[_Piece]:
    """The sentence cut at commas and joining words."""
    sentence = _BY_THEN.sub(r"\1 \2, ", sentence)
    pieces, joint, start = [], "", 0
    for match in _JOINT.finditer(sentence):
        if sentence[start : match.start()].strip():
            pieces.append(_Piece(joint, sentence[start : match.start()].strip()))
            joint = ""
        joint = _plain(match["word"] or ",") if joint in ("", ",") else joint
        start = match.end()
    if sentence[start:].strip():
        pieces.append(_Piece(joint, sentence[start:].strip()))
    return pieces


def _plain(joint: str) -> str:
    return " ".join(joint.lower().replace(",", " ").split()) or ","


def _whole(pieces: list[_Piece]) -> list[_Piece]:
    """Pieces without a verb put to the one before them ("bread and butter"), or to the one after ("one evening")."""
    whole: list[_Piece] = []
    waiting: _Piece | None = None
    for piece in pieces:
        if waiting is not None:
            piece = _led_by(waiting, piece)
            waiting = None
        if has_verb(piece.text) and not (whole and _only_describes(piece)):
            whole.append(piece)
        elif whole:
            last = whole[-1]
            link = ", " if piece.joint == "," else f" {piece.joint} "
            whole[-1] = _Piece(last.joint, last.text + link + piece.text)
        else:
            waiting = piece
    return [*whole, waiting] if waiting is not None else whole


def _led_by(lead: _Piece, piece: _Piece) -> _Piece:
    """A piece with the verbless one before it: "after dinner, …", or "the character" of "the character then …"."""
    if lead.joint in ("before", "until"):
        return _Piece("", f"{piece.text} {lead.joint} {lead.text}")
    if lead.joint in _EARLIER:
        return _Piece("", f"{lead.joint} {lead.text}, {piece.text}")
    return _Piece(lead.joint, f"{lead.text}{', ' if piece.joint == ',' else ' '}{piece.text}")


def _only_describes(piece: _Piece) -> bool:
    """Whether it says how or how long something is done ("laughing loudly", "drunk"), not what happens next."""
    words = piece.text.lower().split()
    if piece.joint == "until":
        return _GOES_ON.match(piece.text) is not None
    if piece.joint != "," or len(words) > 3:
        return False
    felt = [word for word in words if word not in _FILLER]
    return (len(words) <= 2 and words[0].endswith("ing")) or (bool(felt) and all(feelings(word) for word in felt))


def _in_time(pieces: list[_Piece]) -> list[_Piece]:
    """Pieces in the order they happen: "B after A" is A, B; "before B, A" is A, B; "glad when A" stays one."""
    ordered: list[_Piece] = []
    first_is_later = bool(pieces) and pieces[0].joint == "before" and len(pieces) > 1
    for piece in pieces:
        if not ordered or piece.joint not in _EARLIER:
            ordered.append(piece)
            continue
        main = ordered[-1]
        if state_words(without_subject(main.text)) is not None:
            ordered[-1] = _Piece(main.joint, f"{main.text} {piece.joint} {piece.text}")
        elif piece.joint != "after" and re.search(r"^(?:\S+\s+){0,3}(?:is|are|was|were)\s+\w+ing\b", main.text):
            ordered.append(piece)  # "is sitting there when …": the sitting came first
        else:
            ordered.insert(len(ordered) - 1, piece)
    return [*ordered[1:], ordered[0]] if first_is_later else ordered


def without_subject(text: str) -> str:
    """The words without who does it: "the character is happy" is "is happy", "Anna reads" is "reads"."""
    short = text if _ANOTHER.match(text) else _SUBJECT.sub("", text, count=1)
    named = re.match(r"^[A-Z][a-z]+\s+(?=([a-z]+)\b)", short)
    first = short.split()[0].lower() if short else ""
    if short == text and named and is_verb(named[1]) and not is_verb(first) and first not in _NO_NAMES:
        short = short[named.end() :]
    return short if has_verb(short) else text


def state_words(text: str) -> str | None:
    """The feeling, where a clause says nothing but how somebody feels ("becomes very sad" is "very sad")."""
    state = _STATE.match(text)
    if state is None:
        return None
    rest = state["rest"].strip()
    words = [word for word in re.findall(r"[\w-]+", rest.lower()) if word not in _FILLER]
    return rest if words and all(feelings(word) for word in words) else None
