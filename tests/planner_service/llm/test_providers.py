"""A real language model over real HTTP, from a server that may be broken, slow, lying or hostile."""

from __future__ import annotations

import asyncio
import gzip
import json
import logging
import threading
import time
import tracemalloc
from collections.abc import Callable, Iterator
from functools import partial

import pytest
from for_each import for_each
from model_server import Asked, Behaviour, ModelServer, Sent, chat, dripping, endless, failing, in_turn
from pydantic import BaseModel, ConfigDict, Field

import prompts
from planner_service.llm import http_transport
from planner_service.llm.budget import Limits, Spending
from planner_service.llm.client import MAX_ANSWER_LENGTH, ServedModel
from planner_service.llm.http_transport import ServerError, message_of, retry_after
from planner_service.llm.protocol import InvalidAnswerError, ModelError
from planner_service.llm.providers import Address, Kind, Vendor, outlined, takes_temperature
from planner_service.llm.structured_output import ModelAnswerError, ask

KEY = "sk-proj-0123456789abcdefghijklmnop"
JPEG, PNG = b"\xff\xd8\xff\xe0picture", b"\x89PNG\r\n\x1a\npicture"


class Chair(BaseModel):
    """A piece of furniture."""

    word: str


class Meal(BaseModel):
    """What is asked for."""

    model_config = ConfigDict(extra="forbid")

    dish: str = Field(min_length=1, max_length=40)
    plates: int = Field(2, ge=1, le=9)
    at: Chair | None = None


SOUP = {"dish": "soup", "plates": 2, "at": None}
GOOD = json.dumps(SOUP)


def served(server: ModelServer, seconds: float = 10.0, kind: Kind = "openai", key: str = KEY) -> ServedModel:
    url = server.url.removesuffix("/v1") if kind == "anthropic" else server.url
    model = {"openai": "gpt-x", "ollama": "qwen3", "anthropic": "claude-sonnet-5-5"}[kind]
    return ServedModel(Vendor(Address(kind, model, url, key)), Spending(Limits(seconds=seconds)))


def always(sent: Sent, _: Asked) -> Sent:
    return sent


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Waits between attempts of a hundredth."""
    monkeypatch.setattr(http_transport, "FIRST_WAIT", 0.005)


@pytest.mark.parametrize("kind", ["openai", "ollama", "anthropic"])
def test_a_model_is_asked_and_its_answer_read(kind: Kind) -> None:
    with ModelServer(lambda asked: chat(GOOD, asked.path)) as server:
        # The vendor's library is imported meanwhile, which takes its time on a busy machine.
        model = served(server, seconds=60.0, kind=kind)
        answer = model.answer("What is for dinner?", Meal, [JPEG, PNG])
        assert answer == Meal(dish="soup")
        assert model.name.startswith(f"{kind}:")
    (asked,) = server.asked
    assert asked.prompt == "What is for dinner?"
    assert asked.system.strip() == prompts.render("stand_firm").strip()
    assert [part["type"].removesuffix("_url") for part in asked.parts] == ["text", "image", "image"]
    assert KEY in asked.headers["authorization"]
    assert asked.headers["accept-encoding"] == "identity"
    bound = asked.body.get("max_tokens") or asked.body.get("max_completion_tokens")
    assert bound == model.spending.limits.answer_tokens


@pytest.mark.parametrize("kind", ["openai", "anthropic"])
def test_the_schema_is_sent_as_every_server_takes_it(kind: Kind) -> None:
    with ModelServer(lambda asked: chat(GOOD, asked.path)) as server:
        served(server, kind=kind).answer("?", Meal)
    schema = server.asked[0].schema
    assert schema is not None
    assert set(schema["required"]) == set(schema["properties"]) == {"dish", "plates", "at"}
    assert schema["additionalProperties"] is False
    text = json.dumps(schema)
    assert not any(word in text for word in ("$ref", "$defs", "minLength", "maximum", '"default"'))


def test_a_server_that_takes_no_schema_is_told_it_in_the_prompt_and_asked_so_from_then_on() -> None:
    def behave(asked: Asked) -> Sent:
        return failing(400, {"error": "response_format is not supported"}) if asked.schema else chat(GOOD)

    with ModelServer(behave) as server:
        model = served(server)
        assert [model.answer("?", Meal).dish for _ in range(2)] == ["soup", "soup"]
    assert [asked.schema is None for asked in server.asked] == [False, True, True]
    assert '"additionalProperties": false' in server.prompts[1]
    assert server.prompts[1] == server.prompts[2]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # the only ones of Anthropic that take a temperature
@for_each("kind", ["openai", "ollama", "anthropic"])
def test_temperature_and_the_storys_seed_are_sent(kind: Kind) -> None:
    with ModelServer(lambda asked: chat(GOOD, asked.path)) as server:
        url = server.url.removesuffix("/v1") if kind == "anthropic" else server.url
        name = {"openai": "gpt-x", "ollama": "qwen3", "anthropic": "claude-sonnet-4-5"}[kind]
        ServedModel(Vendor(Address(kind, name, url, KEY), 0.0)).for_story(2**40 + 7).answer("?", Meal)
        body = server.asked[0].body
        assert body["temperature"] == 0
        assert body.get("seed") == (None if kind == "anthropic" else 7)  # Anthropic's has none


def test_a_server_that_refuses_temperature_or_seed_is_asked_without_from_then_on() -> None:
    def behave(asked: Asked) -> Sent:
        if "temperature" in asked.body:
            return failing(400, {"error": {"message": "Unsupported value: 'temperature' does not support 0."}})
        return chat(GOOD)

    with ModelServer(behave) as server:
        model = served(server)
        assert [model.answer("?", Meal).dish for _ in range(2)] == ["soup", "soup"]
    assert ["temperature" in asked.body for asked in server.asked] == [True, False, False]
    assert all(asked.schema is not None for asked in server.asked)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_an_older_model_of_anthropic_is_told_the_schema_in_the_prompt() -> None:
    with ModelServer(lambda asked: chat(GOOD, asked.path)) as server:
        url = server.url.removesuffix("/v1")
        vendor = Vendor(Address("anthropic", "claude-3-5-haiku-latest", url, KEY))
        assert ServedModel(vendor).answer("?", Meal).dish == "soup"
    (asked,) = server.asked
    assert asked.schema is None
    assert '"additionalProperties": false' in asked.prompt


def test_a_schema_in_the_prompt_has_no_long_lists() -> None:
    short, long = {"enum": ["a", "b"]}, {"type": "string", "enum": [str(number) for number in range(99)]}
    schema = {"type": "object", "properties": {"enum": short, "other": {"anyOf": [long]}}}
    assert outlined(schema) == {
        "type": "object", "properties": {"enum": short, "other": {"anyOf": [{"type": "string"}]}},
    }  # fmt: skip


@for_each(
    ("profile", "taken"),
    [
        ({}, True),
        ({"openai_supports_reasoning": True}, False),
        ({"openai_supports_reasoning": True, "openai_supports_reasoning_effort_none": True}, True),
        (
            {"openai_supports_reasoning": True, "openai_supports_reasoning_effort_none": True,
             "thinking_enabled_by_default": True},
            False,
        ),
        ({"anthropic_disallows_sampling_settings": True}, False),
    ],
)  # fmt: skip
def test_a_model_that_is_known_to_refuse_a_temperature_is_sent_none(profile: dict[str, bool], taken: bool) -> None:
    assert takes_temperature(profile) is taken


def test_a_refusal_that_is_not_about_the_schema_is_told_as_it_was() -> None:
    with (
        ModelServer(lambda _: failing(400, {"error": {"message": "context too long"}})) as server,
        pytest.raises(ServerError, match=r"openai:gpt-x at http://\S+ answered 400 \(Bad Request\): context too long"),
    ):
        served(server).answer("?", Meal)
    assert len(server.asked) == 2


@for_each("status", [429, 500, 503, 529])
def test_a_server_that_is_busy_is_asked_again(status: int) -> None:
    behave = in_turn([failing(status, {"error": {"message": "busy"}}), failing(status), chat(GOOD)])
    with ModelServer(behave) as server:
        assert served(server).answer("?", Meal).dish == "soup"
    assert len(server.asked) == 3


def test_retry_after_is_waited_for() -> None:
    with ModelServer(in_turn([failing(429, Retry_After="0.8"), chat(GOOD)])) as server:
        begun = time.monotonic()
        served(server).answer("?", Meal)
    assert time.monotonic() - begun >= 0.8


def test_a_wait_beyond_the_deadline_is_not_begun() -> None:
    with ModelServer(lambda _: failing(429, Retry_After="3600")) as server:
        begun = time.monotonic()
        with pytest.raises(ServerError, match=r"429 \(Too Many Requests\).* asked again in 3600 s.*SIMS_LLM_TIMEOUT"):
            served(server).answer("?", Meal)
    assert time.monotonic() - begun < 8  # the deadline is 10
    assert len(server.asked) == 1


@pytest.mark.parametrize("status", [429, 500])
def test_a_storm_ends_after_four_attempts(status: int) -> None:
    with ModelServer(lambda _: failing(status)) as server, pytest.raises(ServerError, match="tried 4 times") as error:
        served(server).answer("?", Meal)
    assert len(server.asked) == 4
    assert error.value.status == status


def cut() -> Sent:
    return Sent(b'{"id": "c1", "choi', length=5000)


def many(piece: bytes, times: int) -> Callable[[], Iterator[bytes]]:
    return lambda: iter([piece] * times)


def silent() -> Iterator[bytes]:
    time.sleep(4)
    return iter(())


HOSTILE: dict[str, tuple[Behaviour, str]] = {
    "slow drip": (lambda _: dripping(), "gave no whole answer within 1 seconds"),
    "never an answer": (lambda _: Sent(silent), "gave no whole answer within 1 seconds"),
    "endless body": (lambda _: endless(), "sent more than 2000000 bytes"),
    "body that claims 100 GB": (lambda _: Sent(b"{", length=10**11), "sent more than 2000000 bytes"),
    "endless error": (lambda _: Sent(many(b"x" * 10**6, 50), 500), "sent more than 2000000 bytes"),
    "cut": (lambda _: cut(), "cannot be reached or broke off"),
    "web page": (lambda _: Sent(b"<html>", headers={"Content-Type": "text/html"}), "text/html instead of JSON"),
    "no type": (lambda _: Sent(b"{}", headers={}), "something of no type instead of JSON"),
    "zipped": (
        lambda _: Sent(
            gzip.compress(b"0" * 10**7), headers={"Content-Type": "application/json", "Content-Encoding": "gzip"}
        ),
        "answered in gzip, which was not asked for",
    ),
    "broken JSON": (lambda _: Sent(b'{"id": '), "no answer of a chat"),
    "deep JSON": (lambda _: Sent(b'{"a":' * 100_000), "no answer of a chat"),
    "another JSON": (lambda _: Sent(b'{"hello": "world"}'), "no answer of a chat"),
    "a list": (lambda _: Sent(b"[1, 2]"), "no answer of a chat"),
    "no choices": (lambda _: Sent(b'{"id": "x", "object": "chat.completion", "choices": []}'), "no answer of a chat"),
    "not UTF-8": (lambda _: Sent(b"\xff\xfe{}"), "no answer of a chat"),
    "a redirection": (lambda _: failing(307, Location="http://127.0.0.1:9/v1"), "redirections are not followed"),
    "a wrong key": (lambda _: failing(401, {"error": {"message": f"Bad key: {KEY}"}}), "401.*check SIMS_LLM_API_KEY"),
    "no such model": (lambda _: failing(404, {"error": "model not found"}), "404.*model not found.*SIMS_LLM_MODEL"),
    "a status of its own": (lambda _: failing(799), "799"),
}


@for_each("mode", HOSTILE)
def test_a_hostile_server_gets_a_clear_error_in_bounded_time_and_memory(mode: str) -> None:
    behave, said = HOSTILE[mode]
    with ModelServer(behave) as server:
        model = served(server, seconds=1.0)
        tracemalloc.start()
        begun = time.monotonic()
        with pytest.raises(ServerError, match=said) as error:
            model.answer("?", Meal)
        seconds, (_, peak) = time.monotonic() - begun, tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert seconds < 4
    assert peak < 60e6
    assert "openai:gpt-x" in str(error.value)
    assert len(str(error.value)) < 500
    assert str(error.value).isprintable()
    assert len(server.asked) <= 4


def test_a_server_that_is_not_there_is_named() -> None:
    with ModelServer(lambda _: chat(GOOD)) as server:
        model = served(server)
    with pytest.raises(ServerError, match=rf"openai:gpt-x at {server.url} cannot be reached.*tried 4 times"):
        model.answer("?", Meal)


@for_each(
    ("text", "problem"),
    [
        ("", "no JSON object"),
        ("I would rather talk about cats.", "no JSON object"),
        ('{"dish": "soup"', "not complete"),
        ('{"dish": "soup", "plates": 99}', "less than or equal to 9"),
        ('{"dish": "soup", "dragon": true}', "dragon"),
        ('{"dish": "so\\u0000up"}', "control characters"),
        ('{"dish": "so\\ud800up"}', "dish"),
        ("Once upon a time " * 10_000, rf"170000 letters; at most {MAX_ANSWER_LENGTH}"),
        ('{"a":' * 40_000, "letters"),
        ('{"a":' * 9_000, "not complete"),
        (('{"a":' * 900 + "x") * 4, "not complete"),
    ],
)
def test_an_answer_that_does_not_fit_is_told_to_the_model_twice_and_then_given_up(text: str, problem: str) -> None:
    with ModelServer(lambda _: chat(text)) as server:
        begun = time.process_time()
        with pytest.raises(ModelAnswerError, match=problem):
            ask(served(server), prompts.render("try_model", furniture="a chair"), Meal)
    assert time.process_time() - begun < 8
    assert len(server.asked) == 3
    assert "It was refused, because" in server.prompts[1]
    assert all(len(prompt) < 8000 for prompt in server.prompts)


def test_a_model_that_mends_its_answer_is_heard() -> None:
    with ModelServer(in_turn([chat('{"dish": ""}'), chat(GOOD)])) as server:
        assert ask(served(server), "?", Meal).dish == "soup"


@for_each("tokens", [(-5, -5), (None, None), ("many", []), (10**30, 10**30), (0.5, 1e308)])
def test_a_server_that_lies_about_tokens_is_counted_by_what_it_wrote(tokens: tuple[object, object]) -> None:
    with ModelServer(lambda _: chat(GOOD, tokens=tokens)) as server:
        model = served(server)
        try:
            model.answer("?" * 400, Meal)
        except ServerError:
            return  # it may also be refused as no answer of a chat
    assert 100 < model.spending.tokens <= 2 * 10**9


def test_the_key_is_in_no_error_log_or_name(caplog: pytest.LogCaptureFixture) -> None:
    said = [
        f"Incorrect key {KEY}.", f"You sent Authorization: Bearer {KEY}", f"key={KEY[:20]}", f"({KEY[8:]})", KEY * 3,
    ]  # fmt: skip
    caplog.set_level(logging.DEBUG, "sims")
    for text in said:
        for status in (400, 401, 500):
            answer = failing(status, {"error": {"message": text}})
            with ModelServer(partial(always, answer)) as server:
                model = served(server)
                with pytest.raises(ServerError) as error:
                    model.answer("?", Meal)
            assert isinstance(model.source, Vendor)
            shown = f"{error.value!r} {error.value.__cause__!r} {model!r} {model.source!r} {model.source.address!r}"
            assert KEY[:12] not in shown
            assert KEY[-12:] not in shown
    assert KEY[:12] not in caplog.text


def test_a_picture_of_another_kind_is_refused_before_anybody_is_asked() -> None:
    with ModelServer(lambda _: chat(GOOD)) as server, pytest.raises(ModelError, match=r"images\.1: .*neither JPEG nor"):
        served(server).answer("?", Meal, [JPEG, b"GIF89a"])
    assert server.asked == []


def test_it_can_be_asked_where_an_event_loop_runs() -> None:
    async def inside(model: ServedModel) -> Meal:
        return model.answer("?", Meal)

    with ModelServer(lambda _: chat(GOOD)) as server:
        assert asyncio.run(inside(served(server))).dish == "soup"


def test_thoughts_before_the_answer_are_passed_over() -> None:
    with ModelServer(lambda _: chat(f'<think>{{"dish": "bread"}} or soup?</think>\n```json\n{GOOD}\n```')) as server:
        assert served(server).answer("?", Meal).dish == "soup"


@for_each(
    ("header", "seconds"),
    [
        ("3", 3.0), ("0.5", 0.5), ("-3", 0.0), ("", 0.0), ("soon", 0.0), ("inf", 0.0), ("1e400", 0.0), ("9" * 40, 0.0),
        ("Thu, 01 Jan 1970 00:02:00 GMT", 20.0), ("Thu, 01 Jan 1970 00:00:02 GMT", 0.0), ("Thu, 99 Foo 1 ", 0.0),
    ],
)  # fmt: skip
def test_retry_after_is_read_in_seconds_or_as_a_date(header: str, seconds: float) -> None:
    assert retry_after(header, now=100.0) == seconds


@for_each(
    ("body", "said"),
    [
        (b'{"error": {"message": "no"}}', "no"), (b'{"error": "no"}', "no"), (b'{"message": "no"}', "no"),
        (b'{"error": {"message": ["no"]}}', ""), (b"<html>", ""), (b"[1]", ""), (b"[" * 90_000, ""), (b"\xff", ""),
    ],
)  # fmt: skip
def test_what_a_server_says_went_wrong_is_found(body: bytes, said: str) -> None:
    assert message_of(body) == said


def test_an_answer_too_long_is_cut_before_it_is_kept() -> None:
    with ModelServer(lambda _: chat("x" * 1_000_000)) as server, pytest.raises(InvalidAnswerError) as error:
        served(server).answer("?", Meal)
    assert len(error.value.text) == MAX_ANSWER_LENGTH


def test_a_question_that_is_waited_for_can_be_given_up_from_another_thread() -> None:
    with ModelServer(lambda _: dripping()) as server:
        model = served(server, seconds=60)
        ending = threading.Timer(0.3, model.close)
        ending.start()
        begun = time.monotonic()
        for _ in range(2):
            with pytest.raises(ServerError, match="not asked any more, the service stops"):
                model.answer("?", Meal)
        ending.join()
    assert time.monotonic() - begun < 30  # the deadline is 60
    assert len(server.asked) <= 1
