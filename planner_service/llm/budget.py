"""What one story may spend on a language model, and what it has spent."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from planner_service.llm.messages import Question, Reply
from planner_service.llm.protocol import ModelError

_MIN_ANSWER: Final = 64
"""Tokens below which there is no sense in asking."""


class BudgetError(ModelError):
    """A story has spent what it may on its language model."""


@dataclass(frozen=True)
class Limits:
    """Bounds of one question and of one story."""

    seconds: float = 120.0
    """One question, with all that is tried again."""
    answer_tokens: int = 16_384
    """One answer, with the thoughts before it."""
    story_tokens: int = 200_000
    story_seconds: float = 900.0
    story_dollars: float | None = None
    """Needs a price."""
    price: tuple[float, float] | None = None
    """Dollars a million tokens read, and a million written."""

    def dollars(self, tokens_in: int, tokens_out: int) -> float:
        """What so many tokens cost; nothing where there is no price."""
        reading, writing = self.price or (0.0, 0.0)
        return (reading * tokens_in + writing * tokens_out) / 1e6


@dataclass(frozen=True)
class Spent:
    """What was asked of a language model, and what that took."""

    calls: int = 0
    tokens: int = 0
    seconds: float = 0.0
    dollars: float | None = None
    """None where there is no price."""

    def __sub__(self, before: Spent) -> Spent:
        dollars = None if self.dollars is None else self.dollars - (before.dollars or 0.0)
        seconds = round(self.seconds - before.seconds, 3)
        return Spent(self.calls - before.calls, self.tokens - before.tokens, seconds, dollars)

    def __str__(self) -> str:
        cost = "" if self.dollars is None else f", {self.dollars:.4f} dollars"
        return f"{self.calls} calls, {self.tokens} tokens, {self.seconds:.1f} s{cost}"


@dataclass
class Spending:
    """The ledger of one story; not for several threads at once."""

    limits: Limits = field(default_factory=Limits)
    calls: int = 0
    """Questions that were asked, answered or not."""
    tokens: int = 0
    dollars: float = 0.0
    seconds: float = 0.0
    """Spent waiting for the model."""

    @property
    def so_far(self) -> Spent:
        """What was spent until now."""
        priced = self.limits.price is not None
        return Spent(self.calls, self.tokens, round(self.seconds, 3), round(self.dollars, 6) if priced else None)

    def allowance(self, question: Question) -> tuple[int, float]:
        """Tokens and seconds that an answer may still take. BudgetError when too little is left to ask."""
        limits = self.limits
        tokens = min(limits.answer_tokens, limits.story_tokens - self.tokens - question.guess)
        if limits.story_dollars is not None and limits.price is not None:
            left = limits.story_dollars - self.dollars - limits.dollars(question.guess, 0)
            tokens = min(tokens, int(left * 1e6 / limits.price[1])) if limits.price[1] > 0 else tokens
            if left <= 0 or tokens < _MIN_ANSWER:
                raise BudgetError(
                    f"{question.title}: the story has spent {self.dollars:.4f} of {limits.story_dollars:g} dollars on "
                    "its language model, too little is left for another question",
                    "raise SIMS_LLM_STORY_DOLLARS",
                )
        if tokens < _MIN_ANSWER:
            raise BudgetError(
                f"{question.title}: the story has spent {self.tokens} of {limits.story_tokens} tokens on its "
                "language model, too few are left for another question",
                "raise SIMS_LLM_STORY_TOKENS",
            )
        seconds = min(limits.seconds, limits.story_seconds - self.seconds)
        if seconds <= 0:
            raise BudgetError(
                f"{question.title}: the story has waited {self.seconds:.0f} of {limits.story_seconds:g} seconds "
                "for its language model",
                "raise SIMS_LLM_STORY_SECONDS",
            )
        return tokens, seconds

    def spend(self, question: Question, reply: Reply) -> None:
        """Enter what an answer took: what the server says, or more where its text is plainly longer than that."""
        tokens_in = max(reply.tokens_in, question.guess)
        tokens_out = max(reply.tokens_out, len(reply.text) // 4)
        self.tokens += tokens_in + tokens_out
        self.dollars += self.limits.dollars(tokens_in, tokens_out)
