"""One question as it goes to a model, its answer as text, and what gives such answers: a server or a file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Protocol

from pydantic import BaseModel

import prompts
from planner_service.llm.protocol import ModelError
from scene_graphs.json_fields import Json

KEPT: Final = ("type", "description", "enum", "items", "anyOf")
"""Words of a JSON schema that every server enforces; bounds are left to our own validation."""
_NESTED: Final = 16


@dataclass(frozen=True)
class Question:
    """What is asked, once."""

    prompt: str
    title: str
    """Name and version of the prompt's file, "plan_events@1"; "unnamed" for a prompt of no file."""
    schema_name: str
    schema: Mapping[str, Any]
    """Portable JSON schema of the answer."""
    images: tuple[bytes, ...] = ()
    """JPEG or PNG files."""
    seed: int = 0
    """For a model that draws lots; no part of the content."""

    @property
    def rules(self) -> str:
        """What is said before the prompt, whatever it is."""
        return prompts.render("stand_firm")

    @cached_property
    def digest(self) -> str:
        """Names the content: the same for the same rules, prompt, schema and images, and for nothing else."""
        images = [hashlib.sha256(image).hexdigest() for image in self.images]
        content = [self.rules, self.title, self.prompt, self.schema_name, self.schema, images]
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

    @property
    def guess(self) -> int:
        """About how many tokens it takes, for models that do not say: four letters each, a thousand an image."""
        return (len(self.rules) + len(self.prompt)) // 4 + 1000 * len(self.images)


@dataclass(frozen=True)
class Reply:
    """A model's text, and the tokens it says it took."""

    text: str
    tokens_in: int = 0
    tokens_out: int = 0


class Source(Protocol):
    """Where replies come from."""

    @property
    def name(self) -> str:
        """Such as "openai:gpt-5"."""
        ...

    def reply(self, question: Question, tokens: int, seconds: float) -> Reply:
        """The model's text, of at most so many tokens, after at most so many seconds. ModelError if there is none."""
        ...

    def close(self) -> None:
        """Give up what is still waited for: the process is about to end."""
        ...


def question_of(prompt: str, schema: type[BaseModel], images: Sequence[bytes] = (), seed: int = 0) -> Question:
    """The question for an answer of that type. ModelError for an image that is neither JPEG nor PNG."""
    for number, image in enumerate(images):
        media_type(image, number)
    title = f"{prompt.name}@{prompt.version}" if isinstance(prompt, prompts.Filled) else "unnamed"
    return Question(str(prompt), title, schema.__name__, portable(schema.model_json_schema()), tuple(images), seed)


def media_type(image: bytes, number: int = 0) -> str:
    """ "image/jpeg" or "image/png", by the first bytes of the file. ModelError for anything else."""
    if image.startswith(b"\xff\xd8\xff"):
        return "image/jpeg"
    if image.startswith(b"\x89PNG\r\n\x1a\n"):
        return "image/png"
    raise ModelError(f"images.{number}: it is neither JPEG nor PNG; models are shown no other pictures")


def portable(schema: Mapping[str, Any]) -> Json:
    """The schema as every server takes it: references written out, all fields required, no others, no bounds.

    What it no longer says (lengths, ranges, defaults) is found by validation and told to the model. ValueError for a
    schema that contains itself.
    """
    return _portable(schema, schema.get("$defs", {}), 0)


def _portable(schema: Mapping[str, Any], named: Mapping[str, Any], depth: int) -> Json:
    if depth > _NESTED:
        raise ValueError(f"schema: it is nested more than {_NESTED} deep, or contains itself")
    if "$ref" in schema:
        return _portable(named[schema["$ref"].rsplit("/", 1)[-1]], named, depth + 1)
    kept = {word: schema[word] for word in KEPT if word in schema}
    if "const" in schema:
        kept["enum"] = [schema["const"]]
    if "items" in kept:
        kept["items"] = _portable(kept["items"], named, depth + 1)
    if "anyOf" in kept:
        kept["anyOf"] = [_portable(one, named, depth + 1) for one in kept["anyOf"]]
    if "properties" in schema:
        fields = {name: _portable(one, named, depth + 1) for name, one in schema["properties"].items()}
        kept |= {"properties": fields, "required": list(fields), "additionalProperties": False}
    return kept
