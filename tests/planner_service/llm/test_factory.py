"""Which language model settings mean, and what of them cannot be used."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from planner_service.llm import factory
from planner_service.llm.client import ServedModel
from planner_service.llm.factory import load_model
from planner_service.llm.fake_model import ScriptedModel
from planner_service.server import environment
from planner_service.settings import Settings, SettingsError, read_settings

KEY = "sk-test-0123456789abcdef"


def settings(**given: Any) -> Settings:
    return Settings(_env_file=None, **given)


def test_no_name_means_rules() -> None:
    assert load_model(settings()) is None


def test_a_name_means_a_model_and_its_limits() -> None:
    model = load_model(settings(llm_model="openai:gpt-5", llm_api_key=KEY, llm_price="1.25/10", llm_story_dollars=0.5))
    assert isinstance(model, ServedModel)
    assert model.name == "openai:gpt-5"
    assert model.spending.limits.price == (1.25, 10.0)
    assert model.memory is not None
    local = load_model(settings(llm_model="ollama:qwen3:8b", llm_cache_mb=0))
    assert isinstance(local, ServedModel)
    assert (local.name, local.memory) == ("ollama:qwen3:8b", None)


def test_a_scripted_model_reads_its_file(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"dinner": {"dish": "soup"}}')
    assert isinstance(load_model(settings(llm_model=f"scripted:{tmp_path / 'a.json'}")), ScriptedModel)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"llm_model": "gpt-5"}, r"'gpt-5' is not known; leave it empty for rules, or openai:MODEL"),
        ({"llm_model": "openai:"}, "is not known"),
        ({"llm_model": "scripted:"}, "is not known"),
        ({"llm_model": "record:talk.jsonl"}, "is not known"),
        ({"llm_model": "scripted:nowhere.json"}, "nowhere.json cannot be read"),
        ({"llm_model": "replay:nowhere.jsonl"}, "nowhere.jsonl cannot be read"),
        ({"llm_model": "openai:gpt 5"}, "is no name of a model"),
        ({"llm_model": "openai:gpt-5\nX: y"}, "is no name of a model"),
        ({"llm_model": "openai:gpt-5"}, r"SIMS_LLM_API_KEY: openai:… needs a key"),
        ({"llm_model": "anthropic:claude"}, r"SIMS_LLM_API_KEY: anthropic:… needs a key"),
        ({"llm_model": "openai:x", "llm_api_key": f"{KEY}\nX-Evil: 1"}, "SIMS_LLM_API_KEY: a key has no blanks"),
        ({"llm_model": "openai:x", "llm_api_key": f"{KEY}é"}, "SIMS_LLM_API_KEY: a key has no"),
        ({"llm_model": "openai:x", "llm_base_url": "ftp://here"}, "SIMS_LLM_BASE_URL: it must be an address such as"),
        ({"llm_model": "openai:x", "llm_base_url": "localhost:11434"}, "SIMS_LLM_BASE_URL: it must be"),
        ({"llm_model": "openai:x", "llm_base_url": "http://[::1"}, "SIMS_LLM_BASE_URL: it must be"),
        ({"llm_model": "openai:x", "llm_base_url": "http://h:99999"}, "SIMS_LLM_BASE_URL: it must be"),
        ({"llm_model": "openai:x", "llm_base_url": f"http://me:{KEY}@h"}, "SIMS_LLM_BASE_URL: no password belongs"),
        ({"llm_model": "openai:x", "llm_base_url": f"http://h/?key={KEY}"}, "SIMS_LLM_BASE_URL: it must be"),
        ({"llm_model": "ollama:x", "llm_story_dollars": 1}, "SIMS_LLM_STORY_DOLLARS: it needs SIMS_LLM_PRICE"),
    ],
)
def test_what_cannot_be_used_is_named_with_its_remedy_and_without_the_key(given: dict[str, Any], said: str) -> None:
    with pytest.raises(SettingsError, match=said) as error:
        load_model(settings(**given))
    assert KEY not in str(error.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("TIMEOUT", "0"), ("TIMEOUT", "nan"), ("TIMEOUT", "1e9"), ("ON_FAILURE", "panic"), ("PRICE", "cheap"),
        ("PRICE", "1"), ("PRICE", "-1/2"), ("STORY_TOKENS", "0"), ("STORY_SECONDS", "inf"), ("STORY_DOLLARS", "-1"),
        ("ANSWER_TOKENS", "1"), ("CACHE_MB", "-1"),
    ],
)  # fmt: skip
def test_a_setting_out_of_bounds_is_named(
    name: str, value: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(f"SIMS_LLM_{name}", value)
    with pytest.raises(SettingsError, match=f"SIMS_LLM_{name}: "):
        read_settings()


def test_without_its_libraries_the_command_that_installs_them_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(factory, "find_spec", lambda _: None)
    with pytest.raises(SettingsError, match=r'pip install "sims-stories\[llm\]"'):
        load_model(settings(llm_model="ollama:qwen3"))


def test_a_key_is_not_shown_and_reaches_the_workers() -> None:
    given = settings(llm_model="openai:x", llm_api_key=KEY, llm_story_dollars=2.5, llm_price="1/2")
    assert KEY not in repr(given)
    assert KEY not in repr(load_model(given))
    passed = environment(given, "worker-0")
    assert passed["SIMS_LLM_API_KEY"] == KEY
    assert (passed["SIMS_LLM_STORY_DOLLARS"], passed["SIMS_LLM_ON_FAILURE"]) == ("2.5", "rules")
    assert "SIMS_LLM_STORY_DOLLARS" not in environment(settings(), "worker-0")


@pytest.mark.service
def test_naming_a_model_loads_no_library_yet() -> None:
    code = (
        "import sys, planner_service.api.app, planner_service.cli; from planner_service.settings import Settings;"
        "from planner_service.llm.factory import load_model;"
        "load_model(Settings(_env_file=None, llm_model='ollama:qwen3'));"
        "print([name for name in ('pydantic_ai', 'openai', 'anthropic', 'httpx2', 'torch') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
