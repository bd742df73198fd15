"""The service as tools: an agent plans, makes, follows and fetches, and is told what it can mend."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI
from service_app import calling, warm_app_on
from sqlalchemy import update

from planner_service.cli import mcp as command
from planner_service.cli.mcp import McpError, check_extra
from planner_service.client import AsyncClient
from planner_service.jobs.story_stages import Maker
from planner_service.pipeline import Pipeline
from planner_service.store.story_store import Stories
from planner_service.store.tables import workflow_status

pytestmark = pytest.mark.anyio
THEME = "A woman sits down on the sofa."


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


def test_without_the_sdk_it_is_said_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "find_spec", lambda _name: None)
    with pytest.raises(McpError, match=r"sims-stories\[mcp\]"):
        check_extra()


@asynccontextmanager
async def agent(app: FastAPI, out: Path) -> AsyncIterator[Any]:
    """An agent at the other end of the protocol, in this process."""
    pytest.importorskip("mcp", reason='the MCP SDK is not installed: pip install "sims-stories[mcp]"')
    from mcp import Client

    from planner_service.mcp_server import serve_tools

    async with calling(app) as http, AsyncClient("http://localhost") as client:
        await client._http.aclose()
        client._http = http
        async with Client(serve_tools(client, out)) as agent:
            yield agent


def made(app: FastAPI, story_id: str) -> None:
    """The story, as a worker makes it, but for its film."""
    parts = app.state.parts
    desk = Maker(Stories(parts.engine), Pipeline(parts.shelves), "one")
    for stage in (desk.plan, desk.furnish, desk.narrate):
        stage(story_id)
    for index in range(desk.act(story_id)):
        desk.move(story_id, index)
    with parts.engine.execution_options(writes=True).begin() as connection:
        mine = workflow_status.c.workflow_uuid == story_id
        connection.execute(update(workflow_status).where(mine).values(status="SUCCESS"))


async def test_an_agent_plans_makes_follows_and_fetches(tmp_path: Path) -> None:
    with warm_app_on(tmp_path / "data") as app:
        async with agent(app, tmp_path / "out") as client:
            tools = {tool.name: tool for tool in (await client.list_tools()).tools}
            assert set(tools) == {"plan", "make", "follow", "fetch"}
            assert all(tool.description for tool in tools.values())

            plan = (await client.call_tool("plan", {"theme": THEME})).structured_content
            assert any(one["skill"] == "sitdown" for one in plan["keyframes"])
            assert all(one["stood_for"] is False for one in plan["beats"])
            throws = (await client.call_tool("plan", {"theme": "He throws the chair in anger."})).structured_content
            assert [(one["why_not"], one["stood_for"]) for one in throws["beats"]] == [("", True)], "nothing is thrown"
            begun = (await client.call_tool("make", {"theme": THEME, "character": {"name": "Ada"}})).structured_content
            assert begun["state"] == "queued"
            made(app, begun["id"])
            story = (await client.call_tool("follow", {"story_id": begun["id"]})).structured_content
            assert story["state"] == "succeeded"
            assert "Ada" in story["text"]
            assert story["keyframes"][-1]["end"] == round(30 * story["seconds"])
            for file, begins in (("motion.npz", b"PK"), ("scene.glb", b"glTF"), ("story.json", b"{")):
                answer = (await client.call_tool("fetch", {"story_id": begun["id"], "file": file})).structured_content
                data = Path(answer["path"]).read_bytes()
                assert (data[: len(begins)], len(data)) == (begins, answer["bytes"])
            assert json.loads(data)["id"] == begun["id"]

            for name, arguments, told in (
                ("make", {"theme": "He sleeps.", "seed": -1}, "/seed"),
                ("follow", {"story_id": "nowhere"}, "no such story"),
                ("fetch", {"story_id": begun["id"], "file": "../../passwd"}, "story.json"),
            ):
                refused = await client.call_tool(name, arguments)
                assert refused.is_error
                assert told in refused.content[0].text
