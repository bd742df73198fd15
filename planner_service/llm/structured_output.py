"""Asking so that the answer can be used: validate, tell what was wrong, ask again, and give up clearly.

A model's text to a validated value, whatever it wrote around the JSON.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Sequence

from pydantic import ValidationError

import prompts
from planner_service.llm.protocol import InvalidAnswerError, LanguageModel, ModelError, Remembering, T

MAX_ANSWER_CHARACTERS_SHOWN = 4000
"""Letters of a refused answer that the model is shown again."""


class ModelAnswerError(ModelError):
    """The model was told what was wrong with its answers and still gave none that can be used."""

    def __init__(self, model: str, wanted: str, attempts: int, problems: Sequence[str]) -> None:
        super().__init__(
            f"{model} gave no usable {wanted} in {attempts} attempts; the last one was refused: {'; '.join(problems)}"
        )
        self.model = model
        self.wanted = wanted
        self.attempts = attempts
        self.problems = tuple(problems)


def ask(
    model: LanguageModel,
    prompt: str,
    schema: type[T],
    check: Callable[[T], Sequence[str]] | None = None,
    repairs: int = 2,
    images: Sequence[bytes] = (),
) -> T:
    """An answer that fits the schema and in which `check` finds no problem, after at most `repairs` second tries.

    A model that remembers is not asked for what it answered well before, if that still passes the check.
    Raises ModelAnswerError when the last try is no better; errors of the connection pass through unchanged.
    """
    if isinstance(model, Remembering):
        known = model.recall(prompt, schema, images)
        if known is not None and not (check and check(known)):
            return known
    question, problems = prompt, ["nothing was asked"]
    for _ in range(repairs + 1):
        try:
            answer = model.answer(question, schema, images)
        except InvalidAnswerError as error:
            text, problems = error.text, list(error.problems)
        else:
            problems = list(check(answer)) if check else []
            if not problems:
                if isinstance(model, Remembering):
                    model.keep(prompt, answer, images)
                return answer
            text = answer.model_dump_json()
        question = prompts.render(
            "repair_answer",
            prompt=prompt,
            answer=text[:MAX_ANSWER_CHARACTERS_SHOWN],
            problems="\n".join(f"- {line}" for line in problems),
        )
    raise ModelAnswerError(model.name, schema.__name__, repairs + 1, problems)


MAX_PROBLEMS_SHOWN = 8
"""Problems told to the model at once."""
_CONTROL = re.compile(r"(?<!\\)(?:\\\\)*\\(?:u00[01][0-9a-f]|[bf])")
"""A control character in JSON, other than the ends of lines and tabs: no terminal or database is safe from them."""


def read_answer(text: str, schema: type[T]) -> T:
    """The last JSON object in the text that fits the schema; InvalidAnswerError says why none does.

    Fences, greetings and thoughts around the JSON are skipped (a draft comes before the answer, so the last one
    counts); JSON that breaks off is not guessed at.
    """
    failure: ValidationError | None = None
    for value in reversed(list(_objects(text))):
        try:
            answer = schema.model_validate(value)
        except ValidationError as error:
            failure = failure or error
            continue
        if _CONTROL.search(answer.model_dump_json()):
            raise InvalidAnswerError(text, ["there are control characters in it"])
        return answer
    if failure is not None:
        raise InvalidAnswerError(text, problems_of(failure)) from failure
    broken = "the JSON is not complete" if "{" in text else "there is no JSON object in it"
    raise InvalidAnswerError(text, [broken])


def problems_of(error: ValidationError) -> list[str]:
    """What a validation found, one line a field: "events.0.emotion: …"."""
    found = [
        f"{'.'.join(map(str, item['loc'])) or 'the value'}: {item['msg']}" for item in error.errors(include_url=False)
    ]
    return (
        found
        if len(found) <= MAX_PROBLEMS_SHOWN
        else [*found[:MAX_PROBLEMS_SHOWN], f"and {len(found) - MAX_PROBLEMS_SHOWN} more"]
    )


def _objects(text: str) -> Iterator[object]:
    """Every outermost JSON object in the text, in order, up to one that the end of the text breaks off."""
    text = text.rstrip()
    decoder = json.JSONDecoder()
    start = text.find("{")
    while start >= 0:
        try:
            value, end = decoder.raw_decode(text, start)
        except RecursionError:
            return
        except json.JSONDecodeError as error:
            if error.pos >= len(text):
                return  # else every object inside of it would be looked for, each to the end
            end = start + 1
        else:
            yield value
        start = text.find("{", end)
