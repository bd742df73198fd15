"""A language model that replies from somewhere else, kept within a story's budget and asked nothing twice."""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from pydantic import ValidationError

from planner_service.llm.answer_cache import Memory
from planner_service.llm.budget import Spending, Spent
from planner_service.llm.messages import Source, question_of
from planner_service.llm.protocol import InvalidAnswerError, LanguageModel, T
from planner_service.llm.structured_output import read_answer

MAX_ANSWER_LENGTH: Final = 100_000
"""Letters of an answer that are read."""
log = logging.getLogger("sims.llm")


@dataclass(frozen=True)
class ServedModel:
    """A `LanguageModel` over a source of texts: validates, keeps count, and remembers the answers that were used.

    Questions count against one story's limits; `for_story` begins the next story.
    """

    source: Source
    spending: Spending = field(default_factory=Spending)
    memory: Memory | None = None
    seed: int = 0
    """The story's: answers are remembered for one seed, so that another seed asks anew."""

    @property
    def name(self) -> str:
        """The source's."""
        return self.source.name

    def for_story(self, seed: int) -> ServedModel:
        """The same model with nothing spent yet."""
        return replace(self, seed=seed, spending=Spending(self.spending.limits))

    def answer(self, prompt: str, schema: type[T], images: Sequence[bytes] = ()) -> T:
        """Ask, and read the answer. InvalidAnswerError, BudgetError, ModelError."""
        question = question_of(prompt, schema, images, self.seed)
        tokens, seconds = self.spending.allowance(question)
        self.spending.calls += 1
        begun = time.monotonic()
        try:
            reply = self.source.reply(question, tokens, seconds)
        finally:
            self.spending.seconds += time.monotonic() - begun
        self.spending.spend(question, reply)
        log.info(
            "%s answered %s in %d ms: %d tokens read, %d written, %d spent on the story",
            *(self.name, question.title, 1000 * (time.monotonic() - begun)),
            *(reply.tokens_in, reply.tokens_out, self.spending.tokens),
        )
        if len(reply.text) > MAX_ANSWER_LENGTH:
            said = f"the answer has {len(reply.text)} letters; at most {MAX_ANSWER_LENGTH} are read"
            raise InvalidAnswerError(reply.text[:MAX_ANSWER_LENGTH], [said])
        return read_answer(reply.text, schema)

    def recall(self, prompt: str, schema: type[T], images: Sequence[bytes] = ()) -> T | None:
        """The answer that was used the last time this was asked for this seed, if it is remembered and still fits."""
        if self.memory is None:
            return None
        text = self.memory.recall(self.name, question_of(prompt, schema, images).digest, self.seed)
        try:
            return None if text is None else schema.model_validate_json(text)
        except ValidationError:
            return None

    def keep(self, prompt: str, answer: T, images: Sequence[bytes] = ()) -> None:
        """Remember an answer that passed every check."""
        if self.memory is not None:
            digest = question_of(prompt, type(answer), images).digest
            self.memory.keep(self.name, digest, self.seed, answer.model_dump_json())

    def close(self) -> None:
        """Give up what is still waited for: the process is about to end."""
        self.source.close()


def spent_on(model: LanguageModel | None) -> Spent | None:
    """What a story spent on its model; None where nobody counts."""
    return model.spending.so_far if isinstance(model, ServedModel) else None


def for_story(model: LanguageModel | None, seed: int) -> LanguageModel | None:
    """The model as one story asks it: with a budget of its own where the model is a served one."""
    return model.for_story(seed) if isinstance(model, ServedModel) else model
