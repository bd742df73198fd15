"""A whole service in processes of its own, as a user starts it: for tests over real HTTP, and for killing it."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import httpx
from encoded import lend

PATIENCE = 240.0
"""Seconds for anything that has to happen, on a machine that does much else."""
SHORT = "A tired woman comes home and falls asleep on the sofa."
"""A theme whose story is quickly made."""
LOOK = 0.05
"""Seconds between two looks at a story that is being made: every answer takes time from its worker."""
ENDED = ("succeeded", "failed", "cancelled")


class RunningService:
    """`sims serve` on a free port; what it writes goes to `log`."""

    def __init__(
        self,
        folder: Path,
        workers: int = 1,
        database_url: str = "",
        environment: Mapping[str, str] | None = None,
        log: Path | None = None,
    ) -> None:
        self.folder, self.workers = folder, workers
        self.log = log or folder / "service.log"
        given = {name: value for name, value in os.environ.items() if not name.startswith("SIMS_")}
        self.environment = (
            given
            | {"SIMS_DATABASE_URL": database_url, "SIMS_RATE": "1000000/minute", "OMP_NUM_THREADS": "1"}
            | dict(environment or {})
        )
        self.process: subprocess.Popen[str] | None = None
        self.url = ""

    def start(self) -> RunningService:
        """Start it, and wait for the line that says it answers."""
        self.folder.mkdir(parents=True, exist_ok=True)
        lend(self.folder)
        command = self.command("serve", "--port", "0", "--workers", str(self.workers))
        with self.log.open("a") as log:
            self.process = subprocess.Popen(
                [*command, "--data-dir", str(self.folder)],
                stdout=subprocess.PIPE, stderr=log, env=self.environment, text=True, start_new_session=True,
            )  # fmt: skip
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        match = re.search(r"ready at (http://\S+)", line)
        assert match, f"the service did not start: {line!r}\n{self.log.read_text()[-3000:]}"
        self.url = match[1]
        return self

    @staticmethod
    def command(*words: str) -> list[str]:
        """The command line of `sims`."""
        return [sys.executable, "-m", "planner_service.cli", *words]

    def stop(self) -> int:
        """Ask it to end as an operator does; its exit code."""
        assert self.process is not None
        self.process.terminate()
        code = self.process.wait(PATIENCE)
        self._close()
        return code

    def kill(self) -> None:
        """End it and all its workers at once, as a power cut does."""
        assert self.process is not None
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait(PATIENCE)
        self._close()

    def _close(self) -> None:
        if self.process is not None and self.process.stdout is not None:
            self.process.stdout.close()
        self.process = None

    def __enter__(self) -> RunningService:
        return self.start()

    def __exit__(self, *_: object) -> None:
        if self.process is not None:
            self.stop()

    def client(self, **options: Any) -> httpx.Client:
        """A plain HTTP client for it."""
        return httpx.Client(base_url=self.url, timeout=PATIENCE, **options)

    def lines(self) -> list[dict[str, Any]]:
        """What it logged."""
        return [json.loads(line) for line in self.log.read_text().splitlines() if line.startswith("{")]

    def worker_pids(self) -> list[int]:
        """The processes of the workers that said last that they are ready, one an id."""
        ready = {line["worker"]: line["pid"] for line in self.lines() if line["event"] == "worker ready"}
        return list(ready.values())


def finished(client: httpx.Client, story_id: str, patience: float = PATIENCE) -> dict[str, Any]:
    """The story, once it has ended."""
    deadline = time.monotonic() + patience
    while time.monotonic() < deadline:
        try:
            story: dict[str, Any] = client.get(f"/v1/stories/{story_id}").raise_for_status().json()
        except httpx.TransportError:
            time.sleep(0.2)
            continue
        if story["state"] in ENDED:
            return story
        time.sleep(0.2)
    raise AssertionError(f"{story_id} is still {story['state']}, {story['stage']} {story['progress']}")


def begun(client: httpx.Client, story_id: str) -> dict[str, Any]:
    """The story, once its first frames can be had."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        story: dict[str, Any] = client.get(f"/v1/stories/{story_id}").raise_for_status().json()
        if story["motion"]["frames"]:
            return story
        assert story["state"] not in ENDED, story["error"]
        time.sleep(LOOK)
    raise AssertionError(f"{story_id} has no frames yet, {story['stage']} {story['progress']}")
