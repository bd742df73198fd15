"""A real language model, over pydantic-ai: OpenAI, servers that speak as it does (vLLM, llama.cpp, Ollama), Anthropic.

Only this module and the transport know the vendors' libraries; both are imported when the first question is asked.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import json
import re
import ssl
import time
from collections.abc import Coroutine, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Final, Literal, TypeVar

import httpx2
from pydantic_ai.direct import model_request
from pydantic_ai.exceptions import UserError
from pydantic_ai.messages import BinaryContent, ModelRequest, UserContent, UserPromptPart
from pydantic_ai.models import Model, ModelRequestParameters
from pydantic_ai.output import OutputObjectDefinition
from pydantic_ai.settings import ModelSettings

import prompts
from planner_service.llm.http_transport import Carrier, ServerError
from planner_service.llm.messages import Question, Reply, media_type
from planner_service.llm.protocol import ModelError
from planner_service.user_errors import printable

Kind = Literal["openai", "ollama", "anthropic"]
ADDRESSES: Final[dict[str, str]] = {
    "openai": "https://api.openai.com/v1",
    "ollama": "http://127.0.0.1:11434/v1",
    "anthropic": "https://api.anthropic.com",
}
CONNECT: Final = 10.0
"""Seconds for a connection."""
MAX_CHOICES_TOLD: Final = 12
"""Words of choice in a schema that is part of the prompt."""
MAX_SEED: Final = 2**31
"""Servers take seeds below this."""
_REFUSED: Final = (400, 404, 415, 422, 501)
"""How servers refuse a schema they cannot hold an answer to, a temperature, or a seed."""
_SAMPLING: Final = re.compile(r"\b(?:temperature|seed|sampling)\b", re.IGNORECASE)
R = TypeVar("R")


@dataclass(frozen=True)
class Address:
    """Where a model is, and how one is let in."""

    kind: Kind
    model: str
    base_url: str = ""
    """Empty: the vendor's own."""
    key: str = field(default="", repr=False)

    @property
    def name(self) -> str:
        """Such as "openai:gpt-5"."""
        return f"{self.kind}:{self.model}"

    @property
    def url(self) -> str:
        """Where questions go."""
        return self.base_url or ADDRESSES[self.kind]


class Vendor:
    """A `Source` that asks a server. Threads may share it; it holds no connection open between questions."""

    def __init__(self, address: Address, temperature: float = 0.0) -> None:
        self.address = address
        self.name = address.name
        self.temperature = temperature
        self.steady = True
        """Whether the server takes a temperature and a seed; one that refused them is asked without."""
        self.native = True
        """Whether the server holds answers to a JSON schema; where it refused to, the schema goes into the prompt."""
        self._closed = False
        self._waiting: set[tuple[asyncio.AbstractEventLoop, asyncio.Task[Any]]] = set()

    def reply(self, question: Question, tokens: int, seconds: float) -> Reply:
        """The model's text. ServerError says why there is none."""
        return run(self._unless_closed(self._reply(question, tokens, seconds)))

    def close(self) -> None:
        """End every question that is waited for, in whatever thread; from now on none is asked."""
        self._closed = True
        for loop, task in list(self._waiting):
            with contextlib.suppress(RuntimeError):  # it ended meanwhile
                loop.call_soon_threadsafe(task.cancel)

    async def _unless_closed(self, work: Coroutine[Any, Any, Reply]) -> Reply:
        asking = asyncio.ensure_future(work)
        mine = asyncio.get_running_loop(), asking
        self._waiting.add(mine)
        if self._closed:
            asking.cancel()
        try:
            return await asking
        except asyncio.CancelledError:
            if self._closed:
                raise ServerError(f"{self.name} is not asked any more, the service stops") from None
            raise
        finally:
            self._waiting.discard(mine)

    async def _reply(self, question: Question, tokens: int, seconds: float) -> Reply:
        """With a schema, temperature and seed; where the server refuses one of them, without it, then and later."""
        deadline = time.monotonic() + seconds
        native, steady, first = self.native, self.steady, None
        try:
            async with asyncio.timeout(seconds):
                while True:
                    try:
                        reply = await self._ask(question, tokens, deadline, native, steady)
                    except ServerError as error:
                        first = first or error
                        if error.status not in _REFUSED:
                            raise first from None
                        if steady and _SAMPLING.search(str(error)):
                            steady = False
                        elif native:
                            native = False
                        else:
                            raise first from None
                    else:
                        self.native, self.steady = native, steady
                        return reply
        except TimeoutError:
            told = f"{self.name} gave no whole answer within {seconds:.3g} seconds; SIMS_LLM_TIMEOUT allows more"
            raise ServerError(told) from None

    async def _ask(self, question: Question, tokens: int, deadline: float, native: bool, steady: bool) -> Reply:
        left = max(deadline - time.monotonic(), 0.001)
        inner = httpx2.AsyncHTTPTransport(verify=_trusted(), retries=0)
        carrier = Carrier(inner, f"{self.name} at {self.address.url}", self.address.key, deadline)
        async with httpx2.AsyncClient(
            transport=carrier,
            headers={"accept-encoding": "identity"},
            timeout=httpx2.Timeout(left, connect=min(CONNECT, left)),
        ) as http:
            model = _model(self.address, http)
            said = ModelSettings(max_tokens=tokens, timeout=left, max_retries=0)
            if steady:
                said["seed"] = question.seed % MAX_SEED
                if takes_temperature(model.profile):
                    said["temperature"] = self.temperature
            try:
                response = await model_request(
                    model,
                    [ModelRequest([UserPromptPart(_content(question, native))], instructions=question.rules)],
                    model_settings=said,
                    model_request_parameters=_parameters(question, native),
                )
            except UserError as error:  # the library knows what the model cannot do, before it asks
                raise ServerError(f"{self.name}: {printable(str(error), 200)}", 501) from None
            except Exception as error:
                raise _explained(error, self.name) from None
        usage = response.usage
        return Reply(response.text or "", _count(usage.input_tokens), _count(usage.output_tokens))


def _model(address: Address, http: httpx2.AsyncClient) -> Model[Any]:
    """pydantic-ai's model at that address."""
    if address.kind == "anthropic":
        from anthropic import AsyncAnthropic
        from pydantic_ai.models.anthropic import AnthropicModel
        from pydantic_ai.providers.anthropic import AnthropicProvider

        client = AsyncAnthropic(base_url=address.url, api_key=address.key, http_client=http, max_retries=0)
        return AnthropicModel(address.model, provider=AnthropicProvider(anthropic_client=client))
    from openai import AsyncOpenAI
    from pydantic_ai.models.openai import OpenAIChatModel
    from pydantic_ai.profiles.openai import OpenAIModelProfile
    from pydantic_ai.providers.ollama import OllamaProvider
    from pydantic_ai.providers.openai import OpenAIProvider

    # The library wants a key, and servers of one's own do not.
    given = AsyncOpenAI(base_url=address.url, api_key=address.key or "none", http_client=http, max_retries=0)
    provider = (OllamaProvider if address.kind == "ollama" else OpenAIProvider)(openai_client=given)
    # Only OpenAI itself insists on the newer name of the bound on an answer; others know the older one for sure.
    own = address.url == ADDRESSES["openai"]
    profile = None if own else OpenAIModelProfile(openai_chat_supports_max_completion_tokens=False)
    return OpenAIChatModel(address.model, provider=provider, profile=profile)


def takes_temperature(profile: Mapping[str, Any]) -> bool:
    """Whether a model is not known to refuse one: then the library would leave it out, and warn at every question."""
    thinks = profile.get("thinking_enabled_by_default", False) or not profile.get(
        "openai_supports_reasoning_effort_none", False
    )
    refuses = profile.get("openai_supports_reasoning", False) and thinks
    return not (refuses or profile.get("anthropic_disallows_sampling_settings", False))


def _parameters(question: Question, native: bool) -> ModelRequestParameters:
    if not native:
        return ModelRequestParameters(output_mode="text")
    answer = OutputObjectDefinition(dict(question.schema), name=question.schema_name.strip("_"), strict=True)
    return ModelRequestParameters(output_mode="native", output_object=answer)


def _content(question: Question, native: bool) -> list[UserContent]:
    """Prompt and pictures; the schema too, where the server does not hold the answer to it."""
    schema = json.dumps(outlined(question.schema))
    text = question.prompt if native else prompts.render("fit_schema", prompt=question.prompt, schema=schema)
    return [str(text), *(BinaryContent(image, media_type=media_type(image)) for image in question.images)]


def outlined(schema: Any) -> Any:
    """A schema without its long lists of choices: the prompt gives these already."""
    if isinstance(schema, list):
        return [outlined(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    long = len(schema.get("enum", ())) > MAX_CHOICES_TOLD
    return {word: outlined(value) for word, value in schema.items() if not (word == "enum" and long)}


def _explained(error: BaseException, name: str) -> ModelError:
    """Our own error beneath whatever the libraries made of it; what they stumbled over is the server's answer."""
    below: BaseException | None = error
    for _ in range(10):
        if below is None:
            break
        if isinstance(below, ModelError):
            return below
        below = below.__cause__ or below.__context__
    return ServerError(f"{name} answered something that is no answer of a chat ({type(error).__name__})")


def _count(tokens: object) -> int:
    """A number of tokens as a server says it, if it makes sense."""
    return min(tokens, 10**9) if isinstance(tokens, int) and tokens > 0 else 0


@functools.cache
def _trusted() -> ssl.SSLContext:
    return ssl.create_default_context()


def run(work: Coroutine[Any, Any, R]) -> R:
    """The result of `work`, also where an event loop already runs in this thread."""
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return asyncio.run(work)
    with ThreadPoolExecutor(1) as aside:
        return aside.submit(asyncio.run, work).result()
