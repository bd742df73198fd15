"""The service under load: answers while stories are made, the first segment, and two workers against one."""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx

from benchmarks.figure import Figure
from benchmarks.themes import demo

MEDIAN_MS, P99_MS, PER_SECOND, FIRST_SECONDS, RATIO = 20.0, 100.0, 300.0, 3.0, 1.7
LOAD_SECONDS, BATCH = 8.0, 12
PAGE_KB, PAINT_SECONDS = 250.0, 1.0
ROOT = Path(__file__).resolve().parents[1]


@contextmanager
def running(folder: Path, workers: int) -> Iterator[httpx.Client]:
    """`sims serve` on a free port, its workers warm, and a client for it."""
    command = [sys.executable, "-m", "planner_service.cli", "serve", "--port", "0", "--workers", str(workers)]
    environment = os.environ | {"SIMS_LOG_LEVEL": "info", "SIMS_RATE": "1000000/minute"}
    log = folder / f"{workers}.log"
    folder.mkdir(parents=True, exist_ok=True)
    with log.open("w") as err:
        process = subprocess.Popen(
            [*command, "--data-dir", str(folder)], stdout=subprocess.PIPE, stderr=err, env=environment, text=True
        )
        assert process.stdout is not None
        try:
            line = process.stdout.readline()
            url = re.search(r"http://\S+", line)
            if url is None:
                raise RuntimeError(f"sims serve did not start: {log.read_text()[-400:]}")
            while log.read_text().count("worker ready") < workers:
                time.sleep(0.1)
            with httpx.Client(base_url=url[0], timeout=120) as client:
                yield client
        finally:
            process.terminate()
            process.wait(30)
            process.stdout.close()


def service_figures(folder: Path) -> list[Figure]:
    """All figures of the service, on SQLite; the load comes from a second process."""
    with running(folder / "two", 2) as client:
        first = first_segment(client)
        seen = browser_figures(client)
        batch = batch_seconds(client)
        story = wait(client, post(client, 0))
        idle = load(client, 1, 0.0, [story["links"]["self"]])
        quick = load(client, 8, 0.0, [story["links"]["self"]])
        busy = load_while_busy(client, story)
    with running(folder / "one", 1) as client:
        wait(client, post(client, 99))
        alone = batch_seconds(client)
    return [
        Figure("first segment, from posting", first, "s", FIRST_SECONDS, digits=2, note="posted, followed, fetched"),
        Figure("story status, one caller", 1000 * median(idle["seconds"]), "ms", note="nothing in the making"),
        Figure(
            "story status, 8 callers", len(quick["seconds"]) / quick["wall"], "/s", PER_SECOND, bound="least", digits=0,
            note="nothing in the making",
        ),
        Figure("GET while 2 stories are made, median", 1000 * median(busy["seconds"]), "ms", MEDIAN_MS),
        Figure(
            "GET while 2 stories are made, p99", 1000 * busy["seconds"][int(0.99 * len(busy["seconds"]))], "ms", P99_MS,
            note=f"{len(busy['seconds'])} calls of 6 kinds",
        ),
        Figure(
            "two workers against one", alone / batch, "×", RATIO, bound="least", digits=2,
            note=f"{BATCH} stories: {batch:.1f} s against {alone:.1f} s",
        ),
        *page_figures(),
        *seen,
    ]  # fmt: skip


def page_figures() -> list[Figure]:
    """The size of the page, where it was built."""
    folder = ROOT / "planner_service" / "page"
    files = [path for path in folder.rglob("*") if path.suffix in (".html", ".js", ".css")]
    if not files:
        return []
    size = sum(len(gzip.compress(path.read_bytes())) for path in files)
    return [Figure("page, gzipped", size / 1000, "kB", PAGE_KB, digits=0, note=f"{len(files)} files")]


def browser_figures(client: httpx.Client) -> list[Figure]:
    """The page as Chromium shows it, by the script of its tests; where browser, driver or page is missing, nothing."""
    script = ROOT / "tests" / "web" / "measure.mjs"
    tools = [script.with_name("node_modules") / "playwright-core", ROOT / "planner_service" / "page" / "index.html"]
    chromium = os.environ.get("CHROMIUM") or any(map(shutil.which, ("chromium", "chromium-browser", "google-chrome")))
    if not chromium or shutil.which("node") is None or not all(tool.exists() for tool in tools):
        return []
    command = ["node", str(script), str(client.base_url), demo()[0]]
    told = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    note = "Chromium without a graphics card"
    return [
        Figure("first paint of the page", told["paint"], "s", PAINT_SECONDS, digits=2, note=note),
        Figure("posting to playing in the page", told["playing"], "s", FIRST_SECONDS, digits=2, note=note),
    ]


def post(client: httpx.Client, seed: int) -> str:
    """Post the demo's theme; the story's id."""
    story = client.post("/v1/stories", json={"theme": demo()[0], "seed": seed}).raise_for_status().json()
    return str(story["id"])


def wait(client: httpx.Client, story_id: str) -> dict[str, Any]:
    """The story once it has ended."""
    while True:
        story: dict[str, Any] = client.get(f"/v1/stories/{story_id}").raise_for_status().json()
        if story["state"] == "succeeded":
            return story
        if story["state"] != "queued" and story["state"] != "running":
            raise RuntimeError(f"{story_id} {story['state']}: {story['error']}")
        time.sleep(0.2)


def first_segment(client: httpx.Client) -> float:
    """Seconds from posting until home and first segment are here, as the page fetches them."""
    started = time.perf_counter()
    story_id = post(client, 1)
    with client.stream("GET", f"/v1/stories/{story_id}/events") as events:
        for line in events.iter_lines():
            if line == "event: segment":
                break
    for path in ("home", "scene.glb", "motion?format=glb&from=0&to=1", "motion?format=npz"):
        client.get(f"/v1/stories/{story_id}/{path}").raise_for_status()
    seconds = time.perf_counter() - started
    wait(client, story_id)
    return seconds


def batch_seconds(client: httpx.Client) -> float:
    """Seconds until a batch of stories is made."""
    started = time.perf_counter()
    for story_id in [post(client, seed) for seed in range(10, 10 + BATCH)]:
        wait(client, story_id)
    return time.perf_counter() - started


def load_while_busy(client: httpx.Client, story: dict[str, Any]) -> dict[str, Any]:
    """Answers to six kinds of calls while two stories are made all the time."""
    posted = [post(client, seed) for seed in range(40, 52)]
    here = story["links"]
    paths = [
        here["self"], "/v1/stories", f"/v1/stories/{posted[0]}", f"{here['motion']}?format=f32&from=0&to=90",
        here["home"], "/v1/short-scripts",
    ]  # fmt: skip
    found = load(client, 2, 0.01, paths)
    for story_id in posted:
        client.post(f"/v1/stories/{story_id}/cancel")
    return found


def load(client: httpx.Client, threads: int, pause: float, paths: Sequence[str]) -> dict[str, Any]:
    """Latencies from a second process."""
    command = [sys.executable, "-m", "benchmarks.load", str(client.base_url), str(LOAD_SECONDS)]
    done = subprocess.run([*command, str(threads), str(pause), *paths], capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def median(values: Sequence[float]) -> float:
    """The middle one of sorted values."""
    return values[len(values) // 2]
