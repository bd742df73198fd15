"""The service as tools of an agent (Model Context Protocol, by the official SDK): plan, make, follow, fetch.

Only who asks for it imports this: the SDK is the extra `mcp`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import anyio
from mcp.server.mcpserver import Context, MCPServer
from mcp.server.mcpserver.exceptions import ToolError

from planner_service.client import ApiError, AsyncClient, ClientError, Story

Json = dict[str, Any]
File = Literal["story.json", "film.glb", "scene.glb", "motion.npz", "motion.bvh", "film.mp4"]
MAX_SECONDS: Final = 600.0
"""Nobody waits longer for one answer; following can be asked for again."""
INSTRUCTIONS: Final = """\
A story theme becomes a script, a furnished home, a told story and a human body that acts it out.
`plan` shows at once what would be done. `make` begins a story; `follow` waits for it and tells what came of it;
`fetch` writes its film (film.glb for Blender and engines, film.mp4 for people) or its motion to a file.
"""


@dataclass(frozen=True)
class Tools:
    """What an agent can ask for, of a service; files go to folders in `out`."""

    client: AsyncClient
    out: Path

    async def plan(self, theme: str, method: Literal["auto", "matching", "direct"] = "auto", seed: int = 0) -> Json:
        """Plan a theme, a few English sentences, at once and without motion: which of its beats can be acted, and by
        which keyframes."""
        script = await self._asked(self.client.long_script(theme, method=method, seed=seed))
        return {
            "planner": script["planner"],
            "beats": [_beat(one) for one in script["beats"]],
            "keyframes": [
                {name: one[name] for name in ("skill", "caption", "emotion", "furniture", "room")}
                for one in script["keyframes"]
            ],
        }

    async def make(self, theme: str, seed: int = 0, character: Json | None = None, backend: str | None = None) -> Json:
        """Begin a story of a theme; the answer is its id, `follow` waits for it. `character` may have name, pronouns,
        height and looks; another seed is another staging."""
        options: Json = {"character": character, "backend": backend}
        given = {name: value for name, value in options.items() if value is not None}
        return _told(await self._asked(self.client.tell(theme, seed=seed, **given)))

    async def follow(self, story_id: str, ctx: Context[Any, Any], seconds: float = 60.0) -> Json:
        """Wait until a story is made, or for so many seconds, telling how far it is; then what came of it: its text,
        which beats are acted and why not, its keyframes with their seconds, and figures."""
        with anyio.move_on_after(min(max(seconds, 0.0), MAX_SECONDS)):
            await self._asked(self._wait(story_id, ctx))
        return _told(await self._asked(self.client.story(story_id)))

    async def _wait(self, story_id: str, ctx: Context[Any, Any]) -> None:
        async for event in self.client.events(story_id):
            if event.name == "progress":
                await ctx.report_progress(event.data["progress"], 1.0, event.data["stage"])

    async def fetch(self, story_id: str, file: File = "film.glb") -> Json:
        """Write a file of a story that was made, and tell where it is: film.glb (home and animated body), scene.glb
        (the home), motion.npz or motion.bvh (the body), story.json (all that is known), film.mp4 (made when it is
        first asked for, which takes about as long as it plays)."""
        story = await self._asked(self.client.story(story_id))
        data = await self._asked(self._bytes(story, file))
        folder = self.out / f"{_slug(story.title or 'story')}-{_slug(story.id)[-8:]}"
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / file
        path.write_bytes(data)
        return {"path": str(path.absolute()), "bytes": len(data)}

    async def _bytes(self, story: Story, file: File) -> bytes:
        match file:
            case "film.glb":
                return await self.client.film(story.id)
            case "scene.glb":
                return await self.client.scene(story.id)
            case "film.mp4":
                return await self.client.wait_film(story.id, MAX_SECONDS)
            case "motion.npz":
                return await self.client.motion_file(story.id, "npz")
            case "motion.bvh":
                return await self.client.motion_file(story.id, "bvh")
            case "story.json":
                return json.dumps(story.data, indent=1, ensure_ascii=False).encode()

    async def _asked(self, call: Any) -> Any:
        """The answer; what the service refuses is told with its places and remedies, as an agent can mend it."""
        try:
            return await call
        except ApiError as error:
            faults = [f"{one['pointer']}: {one['detail']}" for one in error.errors or ()]
            raise ToolError("; ".join(faults) or str(error)) from error
        except ClientError as error:
            raise ToolError(str(error)) from error


def serve_tools(client: AsyncClient, out: Path) -> MCPServer[Any]:
    """A server with the four tools; `run()` speaks over standard input and output."""
    tools = Tools(client, out)
    server: MCPServer[Any] = MCPServer("sims", title="SIMS stories", instructions=INSTRUCTIONS)
    for tool in (tools.plan, tools.make, tools.follow, tools.fetch):
        server.add_tool(tool, name=tool.__name__)
    return server


def _told(story: Story) -> Json:
    """What an agent wants to know of a story."""
    row = story.data
    told = {name: row[name] for name in ("id", "state", "stage", "progress", "title", "text", "derived_from")}
    told |= {"seconds": story.duration, "error": story.error or None}
    told["beats"] = [_beat(one) | {"acted": one["acted"]} for one in row["beats"]]
    told["keyframes"] = [
        {name: one[name] for name in ("index", "skill", "caption", "mood", "object_id", "start", "end", "reached")}
        for one in story.keyframes
    ]
    report = story.report
    told["figures"] = None if report is None else report["motion"]
    return told


def _beat(row: Json) -> Json:
    """A beat, why no keyframe shows it, whether one only stands for it, and what of its words is not shown."""
    left = [words for words in row["unshown"] if words != row["text"]]
    return {"text": row["text"], "why_not": row["why"], "stood_for": _stood_for(row), "not_shown": left}


def _stood_for(row: Json) -> bool:
    """Of a story's beat, or of one that is only planned."""
    return bool(row.get("stood_for", not row["why"] and row["text"] in row["unshown"]))


def _slug(text: str) -> str:
    words = "".join(letter if letter.isascii() and letter.isalnum() else " " for letter in text.lower()).split()
    return "-".join(words)[:60] or "story"
