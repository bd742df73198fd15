"""A user's own weights, a GGUF file, asked in this process through llama-cpp-python; a grammar keeps to the schema."""

from __future__ import annotations

import importlib
import threading
import time
from pathlib import Path
from typing import Any, Final

from planner_service.llm.messages import Question, Reply
from planner_service.llm.protocol import ModelError
from planner_service.user_errors import printable

CONTEXT: Final = 16_384
"""Tokens of question and answer that room is made for: more would take more memory."""


class LlamaFile:
    """A `Source` that answers one question at a time; the weights are read at the first."""

    def __init__(self, file: Path, temperature: float = 0.0) -> None:
        self.file = file
        self.name = f"llamacpp:{file.name}"
        self.temperature = temperature
        self._llama: Any = None
        self._turn = threading.Lock()
        self._closed = False

    def reply(self, question: Question, tokens: int, seconds: float) -> Reply:
        """The model's text. ModelError where it takes too long, or cannot read the question or its own weights."""
        if question.images:
            raise ModelError(f"{self.name} is shown no pictures", "choose a model that sees")
        deadline = time.monotonic() + seconds
        if not self._turn.acquire(timeout=seconds):
            raise self._late(seconds)
        try:
            return self._reply(question, tokens, deadline, seconds)
        except ModelError:
            raise
        except Exception as error:
            said = printable(str(error), 200) or type(error).__name__
            raise ModelError(f"{self.name} gave no answer: {said}") from error
        finally:
            self._turn.release()

    def close(self) -> None:
        """Break off what it is saying; from now on it is not asked."""
        self._closed = True

    def _reply(self, question: Question, tokens: int, deadline: float, seconds: float) -> Reply:
        if self._llama is None:
            library = importlib.import_module("llama_cpp")
            self._llama = library.Llama(str(self.file), n_ctx=CONTEXT, n_gpu_layers=-1, verbose=False)
        said, count = [], 0
        for piece in self._llama.create_chat_completion(
            messages=[{"role": "system", "content": question.rules}, {"role": "user", "content": question.prompt}],
            response_format={"type": "json_object", "schema": dict(question.schema)},
            temperature=self.temperature,
            seed=question.seed % 2**31,
            max_tokens=min(tokens, CONTEXT),
            stream=True,
        ):
            if self._closed:
                raise ModelError(f"{self.name} is not asked any more, the service stops")
            if time.monotonic() > deadline:
                raise self._late(seconds)
            said.append(piece["choices"][0]["delta"].get("content") or "")
            count += 1
        return Reply("".join(said), question.guess, count)

    def _late(self, seconds: float) -> ModelError:
        told = f"{self.name} gave no whole answer within {seconds:.3g} seconds"
        return ModelError(told, "SIMS_LLM_TIMEOUT allows more")
