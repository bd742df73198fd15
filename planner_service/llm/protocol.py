"""One call to a language model: prompt and images in, a validated value out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar, runtime_checkable

from pydantic import BaseModel

from scene_graphs.errors import UserError

T = TypeVar("T", bound=BaseModel)


class ModelError(UserError):
    """No usable answer came from a language model.

    ModelError
    ├── InvalidAnswerError  it answered, and the answer does not fit what was asked
    ├── ModelAnswerError    it was told what was wrong, and still did not answer well (structured_output.py)
    ├── BudgetError         the story has spent what it may (budget.py)
    ├── ServerError         its server was not reached, refused, or sent what cannot be read (http_transport.py)
    └── RecordingError      a recording does not have the answer, or cannot be read (replay_model.py)
    """


class InvalidAnswerError(ModelError):
    """One answer that does not fit; `structured_output.ask` tells the model why and asks again."""

    def __init__(self, text: str, problems: Sequence[str]) -> None:
        super().__init__(f"the answer does not fit: {'; '.join(problems)}")
        self.text = text
        self.problems = tuple(problems)


class LanguageModel(Protocol):
    """What every language model looks like to us, a scripted one included."""

    @property
    def name(self) -> str:
        """Such as "openai:gpt-5" or "scripted"; stories name it as their planner."""
        ...

    def answer(self, prompt: str, schema: type[T], images: Sequence[bytes] = ()) -> T:
        """Answer as a value of `schema`. Images are JPEG or PNG files.

        Raises InvalidAnswerError when the model's text does not fit the schema, ModelError when no text came at all.
        """
        ...


@runtime_checkable
class Remembering(LanguageModel, Protocol):
    """A language model that may be handed the answers that were used, so as to give them again."""

    def recall(self, prompt: str, schema: type[T], images: Sequence[bytes] = ()) -> T | None:
        """The answer that was used the last time, or None."""
        ...

    def keep(self, prompt: str, answer: T, images: Sequence[bytes] = ()) -> None:
        """Remember an answer."""
        ...
