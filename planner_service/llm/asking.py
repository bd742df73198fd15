"""Asking so that the answer can be used: validate, tell what was wrong, ask again, and give up clearly."""

from __future__ import annotations

from collections.abc import Callable, Sequence

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
