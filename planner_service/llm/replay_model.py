"""A conversation with a language model, in a file: recorded once, played back without the model.

The file is JSON lines: `{"model", "prompt", "wanted", "digest", "question", "images", "answer", "tokens"}`. A line is
found by model, prompt (name and version) and digest (of everything that is asked). Of pictures only the digests are
written, and of the connection (address, key, time) nothing, so the same conversation gives the same bytes.
"""

from __future__ import annotations

import hashlib
import json
import threading
from pathlib import Path
from typing import Final, NamedTuple

from pydantic import BaseModel, ConfigDict, ValidationError

from planner_service.llm.messages import Question, Reply, Source
from planner_service.llm.protocol import ModelError
from planner_service.llm.structured_output import problems_of

MAX_RECORDING_BYTES: Final = 64_000_000
"""Bytes of a recording that are read."""


class RecordingError(ModelError):
    """A recording cannot be read or written, or does not have what is asked."""


class Line(BaseModel):
    """One question and its answer."""

    model_config = ConfigDict(extra="forbid", strict=True)

    model: str
    prompt: str
    """Name and version, "plan_events@1"."""
    wanted: str
    """The type of the answer."""
    digest: str
    question: str
    images: tuple[str, ...]
    """SHA-256 of each picture."""
    answer: str
    tokens: tuple[int, int]
    """Read and written."""


class Key(NamedTuple):
    """What an answer is found by."""

    model: str
    prompt: str
    digest: str


class Replay:
    """Answers from a recording alone. RecordingError at once for a file that is none."""

    def __init__(self, path: Path, model: str = "") -> None:
        lines = read_recording(path)
        models = sorted({line.model for line in lines})
        if model not in models and (model or len(models) != 1):
            there = f"there are {', '.join(models)}" if models else "it is empty"
            wanted = f"answers of {model}" if model else f"one model; choose it as replay:{path}=MODEL"
            raise RecordingError(f"{path} does not hold {wanted}; {there}")
        self.path = path
        self.model = model or models[0]
        self.name = f"{self.model} (replayed)"
        self._lines = {key_of(line): line for line in lines}

    def reply(self, question: Question, tokens: int, seconds: float) -> Reply:  # noqa: ARG002
        """The recorded answer. RecordingError tells what is missing, and what is there for the same prompt."""
        line = self._lines.get(Key(self.model, question.title, question.digest))
        if line is None:
            raise RecordingError(f"{self.path}: {self._missing(question)}", f"record it with record:{self.path}=MODEL")
        return Reply(line.answer, *line.tokens)

    def close(self) -> None:
        """Nothing is waited for."""

    def _missing(self, question: Question) -> str:
        asked = f"no answer of {self.model} to {question.title} ({question.digest[:12]})"
        name = question.title.partition("@")[0]
        known = sorted({key.prompt for key in self._lines if key.model == self.model})
        if question.title in known:
            return f"{asked}; the prompt is there, but with other content (theme, scripts, pictures or schema)"
        others = [title for title in known if title.partition("@")[0] == name]
        return f"{asked}; it has {', '.join(others or known)}"


class Recorder:
    """Asks a model and writes down what it answers; what is in the file already is not asked again."""

    def __init__(self, path: Path, source: Source) -> None:
        self.path = path
        self.source = source
        self._lines = {key_of(line): line for line in read_recording(path)} if path.exists() else {}
        self._writing = threading.Lock()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.open("a").close()
        except OSError as error:
            raise RecordingError(f"{path} cannot be written: {error.strerror}") from error

    @property
    def name(self) -> str:
        """The recorded model's."""
        return self.source.name

    def reply(self, question: Question, tokens: int, seconds: float) -> Reply:
        """The model's answer, written down before it is used."""
        key = Key(self.name, question.title, question.digest)
        if (known := self._lines.get(key)) is not None:
            return Reply(known.answer, *known.tokens)
        reply = self.source.reply(question, tokens, seconds)
        line = Line(
            model=self.name,
            prompt=question.title,
            wanted=question.schema_name,
            digest=question.digest,
            question=question.prompt,
            images=tuple(hashlib.sha256(image).hexdigest() for image in question.images),
            answer=reply.text,
            tokens=(reply.tokens_in, reply.tokens_out),
        )
        row = json.dumps(line.model_dump(mode="json"))
        try:
            with self._writing, self.path.open("a", encoding="utf-8") as file:
                file.write(row + "\n")
        except OSError as error:
            raise RecordingError(f"{self.path} cannot be written: {error.strerror}") from error
        self._lines[key] = line
        return reply

    def close(self) -> None:
        """As the recorded model."""
        self.source.close()


def key_of(line: Line) -> Key:
    """What that line is found by."""
    return Key(line.model, line.prompt, line.digest)


def read_recording(path: Path) -> list[Line]:
    """The lines of a recording. RecordingError names the line that cannot be read."""
    try:
        if path.stat().st_size > MAX_RECORDING_BYTES:
            raise RecordingError(f"{path}: more than {MAX_RECORDING_BYTES} bytes, that is no recording of ours")
        rows = path.read_text(encoding="utf-8").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path} cannot be read: {error}") from error
    return [_line(row, f"{path}: line {number}") for number, row in enumerate(rows, 1) if row.strip()]


def _line(row: str, where: str) -> Line:
    try:
        return Line.model_validate_json(row)
    except ValidationError as error:
        raise RecordingError(f"{where}: {'; '.join(problems_of(error))}") from error
