"""Sentence frames: shapes for a sentence about what a body does, and the choice of one not heard lately."""

from __future__ import annotations

import re
from collections import Counter, deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Final

from motion_backend.motion import Skill
from planner_service.narration.keyframe_phrases import Phrase, Piece, Variety, joined
from planner_service.narration.narrative_voice import Voice
from planner_service.narration.openings_and_endings import story_texts

PLAIN: Final = ("{who} {did}.",)
TIMES: Final = tuple(
    f"{words} {{who}} {{did}}."
    for words in (
        "then", "a moment later", "soon", "before long", "a little later", "next", "now",
        "some minutes later", "a short time later", "a minute or so later", "shortly afterwards", "not much later",
    )
)  # fmt: skip
QUICK_TIMES: Final = tuple(
    f"{words} {{who}} {{did}}."
    for words in (
        "without further ado", "straight afterwards", "a heartbeat later", "at once", "in no time",
    )
)  # fmt: skip
SLOW_TIMES: Final = tuple(
    f"{words} {{who}} {{did}}."
    for words in (
        "after a while", "after a pause", "presently", "in due course", "after a breath or two", "in good time",
        "a long moment later",
    )
)  # fmt: skip
LAST_TIMES: Final = (
    "at last {who} {did}.",
    "finally {who} {did}.",
    "in the end {who} {did}.",
)
AFTER: Final = ("after {doing}, {who} {rest}.",)
TWO: Final = (
    "{who} {lead}, and soon {they} {last}.",
    "{who} {lead}; then {they} {last}.",
    "first {who} {lead}, then {they} {last}.",
    "{who} {lead}, and a little later {they} {last}.",
    "{who} {lead}, and with that {they} {last}.",
    "{who} {lead}, and before long {they} {last}.",
)
"""Two things done at different places."""
BEFORE: Final = ("{who} {lead} before {lasting}.",)
WAYS: Final = (
    "{who} headed for {there} and {rest}.",
    "{who} made for {there} and {rest}.",
    "{who} went up to {there} and {rest}.",
)
"""A walk without a feeling to what comes after it."""
NEW_ROOM: Final = (
    "in the {room}, {who} {did}.",
    "then {who} went on to the {room}, where {they} {did}.",
    "now in the {room}, {who} {did}.",
    "from there {who} went to the {room}, where {they} {did}.",
    "next {who} went into the {room}, where {they} {did}.",
)
FIRST_ROOM: Final = ("in the {room}, {who} {did}.",)
KNOWN_ROOM: Final = (
    "back in the {room}, {who} {did}.",
    "in the {room} again, {who} {did}.",
    "once more in the {room}, {who} {did}.",
    "then {who} went back to the {room}, where {they} {did}.",
    "soon {who} returned to the {room}, where {they} {did}.",
    "returning to the {room}, {who} {did}.",
)
RISEN_FIRST: Final = ("in the {room}, {who} {first} and {rest}.",)
RISEN_TO_NEW: Final = (
    "then {who} {first} and went on to the {room}, where {they} {rest}.",
    "{who} {first} and went to the {room}, where {they} {rest}.",
    "a moment later {who} {first}, and in the {room} {they} {rest}.",
    "after a while {who} {first} and went into the {room}, where {they} {rest}.",
)
RISEN_TO_KNOWN: Final = (
    "then {who} {first} and went back to the {room}, where {they} {rest}.",
    "{who} {first} and returned to the {room}, where {they} {rest}.",
    "some time later {who} {first}, and back in the {room} {they} {rest}.",
)
"""Leaving a seat in one room for another."""
RISINGS: Final = (
    "after a while {who} {did}.",
    "at length {who} {did} again.",
    "eventually {who} {did}.",
    "it was some time before {who} {did}.",
    "by and by {who} {did} again.",
    "a long moment passed before {who} {did}.",
    "only much later did {who} {bare}.",
    "there {who} stayed for a while and then {did}.",
    "when the moment had passed, {who} {did}.",
    "time went by until {who} {did}.",
    "the minutes passed, and {who} {did} again.",
    "for a long time nothing stirred; then {who} {did}.",
    "sooner or later it was time to move on, and {who} {did}.",
)
"""Leaving a seat or a bed for what comes next."""
WAKINGS: Final = (
    "hours later {who} {did} again.",
    "it was much later when {who} {did}.",
    "when {who} woke, {they} {did}.",
    "only after a long, deep sleep did {who} {bare}.",
)
_SLOT: Final = re.compile(r"(\{(?:did|first|rest|lead|last|doing|lasting|there|bare)\})")
_HEAVY: Final = re.compile(r"\bheav", re.IGNORECASE)
"""What a story says once."""
_CALM: Final = ("neutral", "relaxed")
_SLOW: Final = ("neutral", "relaxed", "sad", "tired")
_QUICK: Final = ("happy", "angry", "hurried", "stressed")
_MAX_SENTENCE_WORDS: Final = 33
"""Words of a sentence."""
_WINDOW: Final = 5
"""Sentences within which no frame comes again."""


@dataclass(frozen=True)
class Sentence:
    """One sentence of a story, piece by piece with the keyframes that each tells."""

    pieces: tuple[Piece, ...]
    frame: str = ""
    """What it shares with other sentences of its shape; empty for words that nothing else is built like."""
    family: str = ""
    named: Callable[[], tuple[Piece, ...]] | None = field(default=None, compare=False)
    """Makes the pieces with the name where the subject is, for the start of a paragraph."""

    @cached_property
    def text(self) -> str:
        """The words, with a capital."""
        words = "".join(words for words, _ in self.pieces)
        return words[:1].upper() + words[1:]

    def with_name(self) -> Sentence:
        """The same sentence with the name for its subject."""
        return replace(self, pieces=self.named()) if self.named else self

    @cached_property
    def head(self) -> str:
        """What the frame has before its subject, the whole frame where that is nothing."""
        return self.frame.split("{who}")[0] or self.frame

    @cached_property
    def opening(self) -> tuple[str, ...]:
        """The first three words."""
        return tuple(re.findall(r"[\w'’-]+", " ".join(self.text.lower().split()[:5]))[:3])


def said(text: str, frame: str = "", family: str = "told") -> Sentence:
    """A sentence that tells no keyframe."""
    return Sentence(((text, ()),), frame, family)


class Ear:
    """What a listener remembers: every sentence's opening, and the frames of the last few sentences."""

    def __init__(self, variety: Variety) -> None:
        self._variety = variety
        self._openings: set[tuple[str, ...]] = set()
        self._recent: deque[Sentence] = deque(maxlen=_WINDOW - 1)
        self._used: Counter[str] = Counter()
        self._heavy = False

    def heard(self, options: Sequence[Sentence]) -> bool:
        """Whether every option was said already, or begins as something did."""
        return all(option.opening in self._openings for option in options)

    def choose(self, options: Sequence[Sentence], first: bool = False) -> Sentence:
        """The option that sounds least like what was said before; it counts as said.

        With `first` that is the first option, as long as nothing has begun like it.
        """
        costs = [self._cost(option) + 50 * (first and bool(index)) for index, option in enumerate(options)]
        least = min(costs)
        best = [option for option, cost in zip(options, costs, strict=True) if cost <= least + 1]
        chosen = best[self._variety.index(len(best))]
        self._openings.add(chosen.opening)
        self._recent.append(chosen)
        self._used[chosen.frame] += 1
        self._heavy = self._heavy or bool(_HEAVY.search(chosen.text))
        return chosen

    def _cost(self, option: Sentence) -> int:
        recent = list(self._recent)
        cost = 200 * (option.opening in self._openings) + 2 * min(self._used[option.frame], 10)
        cost += 200 * (len(option.text.split()) > _MAX_SENTENCE_WORDS)
        if option.frame and option.family != "plain":
            cost += 100 * any(option.head == said.head for said in recent)
            cost += 8 * any(option.family == said.family for said in recent[-2:])
        cost += 40 * (self._heavy and bool(_HEAVY.search(option.text)))
        first = option.opening[:1]
        cost += 6 * any(first == said.opening[:1] for said in recent[-1:])
        cost += 3 * any(first == said.opening[:1] for said in recent[-2:-1])
        return cost + 4 * (option.family == "plain" and any(said.family == "plain" for said in recent[-2:]))


@dataclass(frozen=True)
class Manner:
    """What a sentence has to bring besides what it tells."""

    time: str = "day"
    room: str = ""
    """A room that has to be named."""
    visits: int = -1
    """How often the story was in that room before; -1 where no room came before it."""
    last: bool = False
    """Whether it ends a scene."""
    woken: bool = False
    """Whether a sleep comes before it."""


def framed(sentence: Sequence[Phrase], who: str, voice: Voice, manner: Manner) -> list[Sentence]:
    """Every way to say a sentence of `who`, a name or a pronoun."""
    return [
        Sentence(
            _filled(shape, sentence, who, voice), shape, family, partial(_filled, shape, sentence, voice.name, voice)
        )
        for family, shapes in _fitting(sentence, manner).items()
        for shape in (shape.replace("{room}", manner.room).replace("{time}", manner.time) for shape in shapes)
    ]


def _fitting(sentence: Sequence[Phrase], manner: Manner) -> dict[str, tuple[str, ...]]:
    """The shapes that suit a sentence, by family."""
    if manner.woken and sentence[0].rises:
        return {"rising": WAKINGS[: len(WAKINGS) - (len(sentence) > 1)]}
    if len(sentence) == 1 and sentence[0].rises:
        return {"rising": RISINGS}
    if manner.room and sentence[0].rises:
        return {"room": RISEN_FIRST if manner.visits < 0 else RISEN_TO_KNOWN if manner.visits else RISEN_TO_NEW}
    if manner.room:
        return {"room": FIRST_ROOM if manner.visits < 0 else KNOWN_ROOM if manner.visits else NEW_ROOM}
    shapes = {"plain": PLAIN, "time": TIMES, "last": LAST_TIMES if manner.last else ()}
    first = sentence[0]
    shapes["time"] += SLOW_TIMES if first.mood in _SLOW else QUICK_TIMES if first.mood in _QUICK else ()
    if not first.rises:
        shapes["mood"] = tuple(f"{words}, {{who}} {{did}}." for words in story_texts().moods.get(first.mood, ()))
        shapes["reason"] = story_texts().reasons.get(first.mood, {}).get(_kind(sentence), ())
    return shapes | (_of_several(sentence) if len(sentence) > 1 else {})


def _of_several(sentence: Sequence[Phrase]) -> dict[str, tuple[str, ...]]:
    """The shapes that need more than one phrase."""
    first, last, previous = sentence[0], sentence[-1], sentence[-2]
    resting = sentence[1].skill in (Skill.SITDOWN, Skill.LIEDOWN)
    simple = "," not in first.text and " and " not in first.text
    shapes: dict[str, tuple[str, ...]] = {}
    if simple and not (first.rises and resting):
        shapes["after"] = AFTER
    if len(sentence) == 2 and "," not in first.text and not first.arrives and not first.rises:
        shapes["two"] = TWO
    if not previous.arrives and not first.rises and "," not in last.text and " and " not in last.text:
        shapes["before"] = BEFORE
    if len(sentence) == 2 and first.arrives and first.mood in _CALM and first.at:
        shapes["way"] = WAYS
    return shapes


def _kind(sentence: Sequence[Phrase]) -> str:
    """What a sentence is for: to "rest", to go and "settle" somewhere, to "roam", or to "do" something."""
    skills = [phrase.skill for phrase in sentence if not phrase.arrives]
    if skills[0] in (Skill.SITDOWN, Skill.LIEDOWN):
        return "settle" if sentence[0].arrives else "rest"
    return "roam" if skills[0] == Skill.LOCO and not sentence[0].at else "do"


def _filled(shape: str, sentence: Sequence[Phrase], who: str, voice: Voice) -> tuple[Piece, ...]:
    pieces: list[Piece] = []
    for part in _SLOT.split(shape):
        match part:
            case "{did}":
                pieces += joined(sentence)
            case "{bare}":
                pieces.append((sentence[0].bare, sentence[0].keyframes))
            case "{first}":
                pieces.append((sentence[0].text, sentence[0].keyframes))
            case "{doing}":
                pieces.append((sentence[0].gerund, sentence[0].keyframes))
            case "{rest}":
                pieces += joined(sentence[1:])
            case "{lead}":
                pieces += joined(sentence[:-1])
            case "{last}":
                pieces.append((sentence[-1].text, sentence[-1].keyframes))
            case "{lasting}":
                pieces.append((sentence[-1].gerund, sentence[-1].keyframes))
            case "{there}":
                pieces.append((sentence[0].at, sentence[0].keyframes))
            case words if words:
                pieces.append((voice.fill(words, who=who), ()))
    return tuple(pieces)
