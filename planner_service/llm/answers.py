"""A model's text to a validated value, whatever it wrote around the JSON."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from pydantic import ValidationError

from planner_service.llm.protocol import InvalidAnswerError, T

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
    """Every outermost JSON object in the text, in order."""
    decoder = json.JSONDecoder()
    start = text.find("{")
    while start >= 0:
        try:
            value, end = decoder.raw_decode(text, start)
        except (ValueError, RecursionError):
            end = start + 1
        else:
            yield value
        start = text.find("{", end)
