"""The HTTP service as one ASGI app: routes, who may ask, how much, and how errors are told."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import cache
from importlib.metadata import version
from typing import Any

from fastapi import APIRouter, Depends, FastAPI
from fastapi.routing import APIRoute
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import MutableHeaders
from starlette.middleware import Middleware
from starlette.routing import BaseRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from planner_service.api.authentication import Access, Cors, Gate
from planner_service.api.dependencies import only_known_parameters
from planner_service.api.error_handlers import Unforeseen, register_handlers
from planner_service.api.extractions.endpoints import EXTRACT
from planner_service.api.multipart import most_sent
from planner_service.api.openapi import document
from planner_service.api.rate_limit import LARGER, BodyLimit, Limiting, Rate
from planner_service.api.routes import ROUTERS
from planner_service.api.telemetry import Figures, Telemetry
from planner_service.api.web_page import assets
from planner_service.components import Parts
from planner_service.store.job_statistics import StoreFigures


class Service(FastAPI):
    """FastAPI with our own OpenAPI document."""

    def openapi(self) -> dict[str, Any]:
        """Made once, on the first call."""
        if self.openapi_schema is None:
            self.openapi_schema = document(self, self.state.gate.locked)
        return self.openapi_schema


def create_app(parts: Parts) -> FastAPI:
    """The service on these parts; they are closed when it shuts down."""
    gate = Gate(parts.settings.api_keys, parts.settings.cors_origins)
    figures = Figures()
    figures.register(StoreFigures(parts.engine, parts.jobs))
    app = Service(
        title="sims-stories",
        version=version("sims-stories"),
        docs_url=None,  # those pages load scripts from elsewhere
        redoc_url=None,
        redirect_slashes=False,
        generate_unique_id_function=_operation_id,
        lifespan=_closing,
        middleware=_middleware(gate, figures, parts),
        dependencies=[Depends(only_known_parameters)],
        routes=list(_routes()),
    )
    app.state.parts, app.state.gate, app.state.figures = parts, gate, figures
    register_handlers(app)
    app.mount("/assets", assets())
    return app


@cache
def _routes() -> tuple[BaseRoute, ...]:
    """All routes. FastAPI looks over what each of them takes when it first meets it, which lasts: once a process."""
    front = APIRouter(dependencies=[Depends(only_known_parameters)], generate_unique_id_function=_operation_id)
    for router in ROUTERS:
        front.include_router(router)
    return tuple(front.routes)


@asynccontextmanager
async def _closing(app: FastAPI) -> AsyncIterator[None]:
    yield
    await run_in_threadpool(app.state.parts.close)


def _middleware(gate: Gate, figures: Figures, parts: Parts) -> list[Middleware]:
    """Outermost first. Whoever is refused has an id, a line in the log and the headers of a page elsewhere."""
    cors = [Middleware(Cors, origins=gate.origins)] if gate.origins else []
    return [
        Middleware(Telemetry, figures=figures),
        Middleware(Hardened),
        *cors,
        Middleware(Unforeseen),
        Middleware(Access, gate=gate),
        Middleware(Limiting, rate=Rate(parts.settings.rate)),
        Middleware(BodyLimit, larger=LARGER | {("POST", EXTRACT): most_sent(parts.settings)}),
        Middleware(Head),
    ]


def _operation_id(route: APIRoute) -> str:
    return "_".join([*(str(tag).replace(" ", "_") for tag in route.tags[:1]), route.name])


class Hardened:
    """ASGI: browsers take an answer for what it says it is, and tell nobody where a visitor came from."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, with two headers more."""

        async def marked(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers["X-Content-Type-Options"] = "nosniff"
                headers["Referrer-Policy"] = "no-referrer"
            await send(message)

        await self.app(scope, receive, marked)


class Head:
    """ASGI: HEAD is answered as GET is, without the body; FastAPI's own routes know GET alone."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on; after the head the answer is complete, so that the server ends streams as if the caller had left."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self.app(scope, receive, send)
            return

        async def headless(message: Message) -> None:
            if message["type"] == "http.response.start":
                await send(message)
                await send({"type": "http.response.body", "body": b""})

        # A copy: the server frames the answer by the method that it keeps in the scope.
        as_get = dict(scope, method="GET")
        await self.app(as_get, receive, headless)
        scope.update({name: as_get[name] for name in ("route", "path_params") if name in as_get})
