"""The language model that settings name: none, one that was scripted or recorded, or a real one."""

from __future__ import annotations

import json
import re
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

import prompts
from planner_service.llm.answer_cache import Memory
from planner_service.llm.budget import Limits, Spending
from planner_service.llm.client import ServedModel
from planner_service.llm.fake_model import ScriptedModel
from planner_service.llm.llama_file import LlamaFile
from planner_service.llm.messages import Question, Reply, Source
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.llm.replay_model import Recorder, Replay
from planner_service.settings import Settings, SettingsError

if TYPE_CHECKING:
    from planner_service.llm.providers import Vendor

INSTALL: Final = 'pip install "sims-stories[llm]"'
INSTALL_LLAMA: Final = 'pip install "sims-stories[llamacpp]"'
LLAMA: Final = "llamacpp"
LIBRARIES: Final = {"openai": "openai", "ollama": "openai", "anthropic": "anthropic"}
"""Kinds of servers, and the library that speaks with them."""
KINDS: Final = (
    "openai:MODEL, ollama:MODEL, anthropic:MODEL, llamacpp:FILE, scripted:FILE, replay:FILE or record:FILE=openai:MODEL"
)
RULES: Final = ("", "rules")
"""Names for no model at all."""
_NAME: Final = re.compile(r"[\w./:@+-]{1,200}\Z")
_RECORD: Final = re.compile(r"(?P<file>.+?)=(?P<model>(?:openai|ollama|anthropic|llamacpp):.+)\Z", re.DOTALL)


def load_model(settings: Settings) -> LanguageModel | None:
    """The model of `SIMS_LLM_MODEL`; None for an empty name and for "rules", which plan and tell then.

    "scripted:FILE" answers from a JSON object that maps words of a prompt to the answer (an object, or text);
    "replay:FILE" from a recording, "record:FILE=openai:MODEL" makes one. SettingsError says what cannot be used;
    nothing is imported and nobody is asked yet.
    """
    use_prompts(settings.prompts)
    name = settings.llm_model
    if name in RULES:
        return None
    kind, _, rest = name.partition(":")
    if kind == "scripted" and rest:
        return ScriptedModel(_scripted(rest))
    spending = Spending(limits_of(settings))
    try:
        if kind == "replay" and rest:
            file, model = rest, ""
            if (chosen := _RECORD.match(rest)) is not None:
                file, model = chosen["file"], chosen["model"]
            return ServedModel(Replay(Path(file), model), spending)
        if kind == "record" and (wanted := _RECORD.match(rest)) is not None:
            return ServedModel(Recorder(Path(wanted["file"]), source_of(wanted["model"], settings)), spending)
    except ModelError as error:
        raise SettingsError(f"{error}", at="SIMS_LLM_MODEL") from error
    if kind in (*LIBRARIES, LLAMA) and rest:
        memory = Memory(settings.cache_dir / "answers", settings.llm_cache_mb * 1_000_000)
        return ServedModel(source_of(name, settings), spending, memory if settings.llm_cache_mb else None)
    raise SettingsError(f"{name!r:.80} is not known", f"leave it empty for rules, or {KINDS}", at="SIMS_LLM_MODEL")


def use_prompts(folder: Path | None) -> None:
    """Let prompts of a user's own take the place of ours. SettingsError says what is wrong with one."""
    try:
        prompts.use(folder)
    except (prompts.PromptError, OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"{error}", at="SIMS_PROMPTS") from error


def source_of(name: str, settings: Settings) -> Source:
    """What gives the answers of "openai:MODEL", "llamacpp:FILE" and their like. SettingsError."""
    kind, _, rest = name.partition(":")
    return weights(Path(rest), settings) if kind == LLAMA else served(name, settings)


def weights(file: Path, settings: Settings) -> LlamaFile:
    """The source of a user's own weights. SettingsError."""
    if not file.is_file():
        raise SettingsError(f"{file} is no file", "give the path of a GGUF file", at="SIMS_LLM_MODEL")
    if find_spec("llama_cpp") is None:
        raise SettingsError(
            f"{LLAMA}:… needs a library that is not installed", f"install it: {INSTALL_LLAMA}", at="SIMS_LLM_MODEL"
        )
    return LlamaFile(file, settings.llm_temperature)


class Late:
    """A `Source` that asks a server and imports its library only then: that takes seconds."""

    def __init__(self, name: str, base_url: str, key: str, temperature: float) -> None:
        self.name = name
        self._where = base_url, key
        self._temperature = temperature
        self._vendor: Vendor | None = None

    def reply(self, question: Question, tokens: int, seconds: float) -> Reply:
        """As the server's."""
        return self.vendor.reply(question, tokens, seconds)

    def close(self) -> None:
        """As the server's."""
        if self._vendor is not None:
            self._vendor.close()

    @property
    def vendor(self) -> Vendor:
        """The real source."""
        if self._vendor is None:
            from planner_service.llm.providers import Address, Vendor

            kind, _, model = self.name.partition(":")
            self._vendor = Vendor(Address(kind, model, *self._where), self._temperature)  # type: ignore[arg-type]
        return self._vendor


def served(name: str, settings: Settings) -> Late:
    """The source of "openai:MODEL" and its like. SettingsError."""
    kind, _, model = name.partition(":")
    if not _NAME.match(model):
        raise SettingsError(f"{model!r:.80} is no name of a model", at="SIMS_LLM_MODEL")
    if find_spec("pydantic_ai") is None or find_spec(LIBRARIES[kind]) is None:
        raise SettingsError(f"{kind}:… needs libraries that are not installed: {INSTALL}", at="SIMS_LLM_MODEL")
    key = settings.llm_api_key.get_secret_value().strip()
    if not all("!" <= letter <= "~" for letter in key):
        raise SettingsError("a key has no blanks and no letters beyond ASCII", at="SIMS_LLM_API_KEY")
    if not key and not settings.llm_base_url and kind != "ollama":
        raise SettingsError(
            f"{kind}:… needs a key", "a server of your own needs SIMS_LLM_BASE_URL", at="SIMS_LLM_API_KEY"
        )
    if not key and kind == "anthropic":
        key = "none"  # the library wants one
    return Late(name, base_url_of(settings.llm_base_url), key, settings.llm_temperature)


def base_url_of(given: str, setting: str = "SIMS_LLM_BASE_URL", key: str = "SIMS_LLM_API_KEY") -> str:
    """The address that a setting gives, without a slash at its end.

    SettingsError for one that is none, or that holds a password.
    """
    if not given:
        return ""
    try:
        parts = urlsplit(given)
        good = parts.scheme in ("http", "https") and parts.hostname and not (parts.query or parts.fragment)
        _ = parts.port
    except ValueError:
        good = False
    if not good:
        raise SettingsError("it must be an address such as http://127.0.0.1:11434/v1", at=setting)
    if parts.username or parts.password:
        raise SettingsError("no password belongs into an address", f"use {key}", at=setting)
    return given.rstrip("/")


def limits_of(settings: Settings) -> Limits:
    """The bounds that settings give. SettingsError where dollars are to be counted and there is no price."""
    price = None
    if settings.llm_price:
        reading, _, writing = settings.llm_price.partition("/")
        price = float(reading), float(writing)
    if settings.llm_story_dollars is not None and price is None:
        raise SettingsError(
            "it needs SIMS_LLM_PRICE, dollars a million tokens, as 1.25/10", at="SIMS_LLM_STORY_DOLLARS"
        )
    return Limits(
        seconds=settings.llm_timeout,
        answer_tokens=settings.llm_answer_tokens,
        story_tokens=settings.llm_story_tokens,
        story_seconds=settings.llm_story_seconds,
        story_dollars=settings.llm_story_dollars,
        price=price,
    )


def _scripted(file: str) -> dict[str, dict[str, object] | str]:
    try:
        answers = json.loads(Path(file).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SettingsError(f"{file} cannot be read: {error}", at="SIMS_LLM_MODEL") from error
    if not isinstance(answers, dict) or not all(isinstance(answer, dict | str) for answer in answers.values()):
        raise SettingsError(f"{file} must be a JSON object of prompt words to answers", at="SIMS_LLM_MODEL")
    return answers
