"""A told story: its text, the words that tell each keyframe, and those that the body is not seen doing."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Final

from scene_graphs.json_fields import Json

PARAGRAPH: Final = 90
"""Words after which a paragraph ends with its sentence."""


@dataclass(frozen=True)
class Span:
    """A stretch of a told text, end exclusive, and the keyframes it tells."""

    start: int
    end: int
    keyframes: tuple[int, ...]


@dataclass(frozen=True)
class Told:
    """A story as text: paragraphs parted by empty lines, spans in order and not overlapping."""

    title: str
    text: str
    spans: tuple[Span, ...]
    thoughts: tuple[Span, ...] = ()
    """What is told and the body is not seen doing: in order, not overlapping."""

    @property
    def events(self) -> str:
        """The text without its thoughts: what is told as happening."""
        return self.marked(lambda _: "")

    def marked(self, mark: Callable[[str], str]) -> str:
        """The text with its thoughts as `mark` writes them: "*guests were coming*"."""
        ends = [0, *(span.end for span in self.thoughts)]
        starts = [*(span.start for span in self.thoughts), len(self.text)]
        plain = [self.text[end:start] for end, start in zip(ends, starts, strict=True)]
        thoughts = [mark(self.text[span.start : span.end]) for span in self.thoughts]
        return plain[0] + "".join(thought + text for thought, text in zip(thoughts, plain[1:], strict=True))

    def with_unseen(self, keyframes: Collection[int]) -> Told:
        """The same with what only these keyframes tell among its thoughts."""
        lost = [replace(span, keyframes=()) for span in self.spans if {*span.keyframes}.issubset(keyframes)]
        thoughts = _joined(self.text, sorted([*self.thoughts, *lost], key=lambda span: span.start))
        return replace(self, thoughts=tuple(thoughts)) if lost else self

    def to_dict(self) -> Json:
        """Title, text, and which letters tell which keyframes, or what is not seen."""
        spans = [{"start": one.start, "end": one.end, "keyframes": list(one.keyframes)} for one in self.spans]
        thoughts = [{"start": one.start, "end": one.end} for one in self.thoughts]
        return {"title": self.title, "text": self.text, "spans": spans, "thoughts": thoughts}

    @classmethod
    def from_dict(cls, row: Json) -> Told:
        """The inverse of `to_dict`."""
        spans = (Span(one["start"], one["end"], tuple(one["keyframes"])) for one in row["spans"])
        thoughts = (Span(one["start"], one["end"], ()) for one in row.get("thoughts", ()))
        return cls(row["title"], row["text"], tuple(spans), tuple(thoughts))


UNSEEN: Final = "Words written like {this} are told and not seen: the body does not show them."
"""`this` is to be written as they are."""


@dataclass(frozen=True)
class Words:
    """Some words of a told text, the keyframes they tell, and whether they are a thought."""

    text: str
    keyframes: tuple[int, ...] = ()
    thought: bool = False


def page(title: str, sentences: Iterable[Sequence[Words]]) -> Told:
    """Sentences as a told story, in paragraphs."""
    told = [[word for word in words if word.text] for words in sentences]
    told = [words for words in told if "".join(word.text for word in words).strip()]
    parts: list[Words] = []
    long = 0
    for words in told:
        parts += [Words("" if not parts else "\n\n" if long >= PARAGRAPH else " "), *words]
        long = (0 if long >= PARAGRAPH else long) + len("".join(word.text for word in words).split())
    text, spans, thoughts = "", list[Span](), list[Span]()
    for keyframes, same in groupby(parts, key=lambda part: part.keyframes):
        start = len(text)
        for part in same:
            if part.thought and part.text.strip():
                thoughts.append(_trimmed(text, part.text))
            text += part.text
        if keyframes and text[start:].strip():
            spans.append(_trimmed(text[:start], text[start:], keyframes))
    return Told(title, text, tuple(spans), tuple(_joined(text, thoughts)))


def _trimmed(before: str, words: str, keyframes: tuple[int, ...] = ()) -> Span:
    """Where words stand after others, white space aside."""
    start = len(before) + len(words) - len(words.lstrip())
    return Span(start, len(before) + len(words.rstrip()), keyframes)


def _joined(text: str, spans: Sequence[Span]) -> list[Span]:
    """Spans with those made one that overlap, or between which there is nothing but white space."""
    joined: list[Span] = []
    for span in spans:
        if joined and not text[joined[-1].end : span.start].strip():
            joined[-1] = Span(joined[-1].start, max(joined[-1].end, span.end), ())
        else:
            joined.append(span)
    return joined
