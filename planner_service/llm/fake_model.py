"""A language model that says what it was told to: for tests, demonstrations and work offline."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from pydantic import BaseModel

from planner_service.llm.protocol import ModelError, T
from planner_service.llm.structured_output import read_answer

Answer = BaseModel | Mapping[str, object] | str | Exception
"""A value, its JSON as a mapping or text (valid or not), or what to raise."""
Answers = Sequence[Answer] | Mapping[str, Answer] | Callable[[str, type[BaseModel]], Answer]


@dataclass(frozen=True)
class Call:
    """One question that was asked."""

    prompt: str
    schema: str
    images: int


class ScriptedModel:
    """Answers from a list (in turn), a mapping (the first key found in the prompt) or a function of prompt and schema.

    Every answer goes through the same reading and validation as a real model's text.
    """

    def __init__(self, answers: Answers, name: str = "scripted") -> None:
        self.name = name
        self.calls: list[Call] = []
        self._answers = answers

    def answer(self, prompt: str, schema: type[T], images: Sequence[bytes] = ()) -> T:
        """The next answer, validated. ModelError when there is none left for this prompt."""
        self.calls.append(Call(prompt, schema.__name__, len(images)))
        answer = self._next(prompt, schema)
        if isinstance(answer, Exception):
            raise answer
        if isinstance(answer, BaseModel):
            answer = answer.model_dump(mode="json")
        return read_answer(answer if isinstance(answer, str) else json.dumps(answer), schema)

    def _next(self, prompt: str, schema: type[BaseModel]) -> Answer:
        if callable(self._answers):
            return self._answers(prompt, schema)
        if isinstance(self._answers, Mapping):
            for key, answer in self._answers.items():
                if key in prompt:
                    return answer
            raise ModelError(f"{self.name}: no answer for a prompt with none of {', '.join(map(repr, self._answers))}")
        if len(self.calls) > len(self._answers):
            raise ModelError(
                f"{self.name}: call {len(self.calls)} wants a {schema.__name__}, but only "
                f"{len(self._answers)} answers were given"
            )
        return self._answers[len(self.calls) - 1]
