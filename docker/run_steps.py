"""The Dockerfile's steps as a plain script: builds every stage in a scratch folder, starts it, asks it, stops it.

    python docker/run_steps.py [--build-arg NAME=VALUE …]

No container engine is needed. What an engine adds, and this does not: the base images' own files, and walls between the
container and the machine.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

from building import Builder, BuildError, Image
from dockerfile import DockerfileError, read_dockerfile, read_dockerignore

ROOT = Path(__file__).resolve().parents[1]
READY_WITHIN = 60
"""Seconds from the start until the health check succeeds."""
STORY_WITHIN = 120
STOP_WITHIN = 20
THEME = "A woman comes home tired, reads a book on the sofa and falls asleep."


def main() -> int:
    """Build, start, ask, stop; 0 when all of it went well."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--build-arg", action="append", default=[], metavar="NAME=VALUE")
    given = dict(pair.split("=", 1) for pair in parser.parse_args().build_arg)
    scratch = Path(tempfile.mkdtemp(prefix="sims-image-"))
    scratch.chmod(0o755)
    start = time.perf_counter()
    try:
        stages = read_dockerfile((ROOT / "Dockerfile").read_text(encoding="utf-8"))
        image = Builder(ROOT, read_dockerignore(ROOT / ".dockerignore"), scratch, given).build(stages)
        print(f"· built in {time.perf_counter() - start:.0f} s", flush=True)
        check(image, scratch / "log")
    except (BuildError, DockerfileError) as error:
        print(f"run_steps: {error}", file=sys.stderr)
        return 1
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    print(f"· the image's steps build, start, answer and stop: {time.perf_counter() - start:.0f} s in all")
    return 0


def check(image: Image, log: Path) -> None:
    """Start the container's command, ask what a client would ask, and stop it as an engine would."""
    port, key = free_port(), secrets.token_hex(24)
    env = {**image.env, "SIMS_PORT": str(port), "SIMS_API_KEYS": key}
    user: dict[str, Any] = {"user": image.user, "group": image.user, "extra_groups": []} if may_become(image) else {}
    with log.open("wb") as out:
        process = subprocess.Popen(
            [program(image.cmd[0], env), *image.cmd[1:]], cwd=image.root / image.workdir.lstrip("/"), env=env,
            stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True, **user,
        )  # fmt: skip
        try:
            answers(f"http://127.0.0.1:{port}", key, process, lambda: healthy(image, env))
            stop(process)
        except BuildError as error:
            tail = "\n".join(log.read_text(errors="replace").splitlines()[-40:])
            raise BuildError(f"{error}\nlast lines of its log:\n{tail}") from error
        finally:
            end_group(process)


def answers(url: str, key: str, process: subprocess.Popen[bytes], healthy: Callable[[], bool]) -> None:
    """Health check, readiness, page with its script, a locked door, and one story from theme to end."""
    start = time.perf_counter()
    wait_until("the health check succeeds", READY_WITHIN, process, healthy)
    wait_until("/readyz answers 200", READY_WITHIN, process, lambda: ask(url + "/readyz")[0] == 200)
    print(f"· ready after {time.perf_counter() - start:.1f} s", flush=True)
    status, page = ask(url + "/")
    scripts = re.findall(r'<script[^>]+src="\.?/?([^"]+)"', page)
    expect(status == 200 and scripts, f"the page answers {status} and names scripts: {scripts}")
    for script in scripts:
        expect(ask(f"{url}/{script}")[0] == 200, f"{script} can be had")
    expect(ask(url + "/v1/stories")[0] == 401, "without a key /v1/stories answers 401")
    status, text = ask(url + "/v1/stories", key, {"theme": THEME})
    expect(status == 202, f"a theme is accepted: {status} {text[:300]}")
    story = url + json.loads(text)["links"]["self"]
    start = time.perf_counter()
    ended = {"succeeded", "failed", "cancelled"}
    wait_until("the story ends", STORY_WITHIN, process, lambda: json.loads(ask(story, key)[1])["state"] in ended)
    told = json.loads(ask(story, key)[1])
    expect(told["state"] == "succeeded", f"the story succeeds: {told['error']}")
    expect(told["encoder"] == "all-MiniLM-L6-v2", f"the encoder is in the image: {told['encoder']}")
    print(f"· a story of {told['motion']['duration']:.0f} s made in {time.perf_counter() - start:.1f} s", flush=True)


def stop(process: subprocess.Popen[bytes]) -> None:
    """SIGTERM to the one process that an engine would send it to; nothing may be left of its group."""
    start = time.perf_counter()
    process.send_signal(signal.SIGTERM)
    try:
        code = process.wait(STOP_WITHIN)
    except subprocess.TimeoutExpired as error:
        raise BuildError(f"SIGTERM did not end it within {STOP_WITHIN} s") from error
    expect(code == 0, f"SIGTERM ends it with code 0: {code}")
    expect(not group_lives(process), "no process of it is left")
    print(f"· stopped by SIGTERM after {time.perf_counter() - start:.1f} s", flush=True)


def healthy(image: Image, env: dict[str, str]) -> bool:
    """Whether the image's own HEALTHCHECK command succeeds."""
    command = [program(image.health[0], env), *image.health[1:]]
    return subprocess.run(command, env=env, capture_output=True, check=False).returncode == 0


def wait_until(what: str, seconds: float, process: subprocess.Popen[bytes], happened: Callable[[], bool]) -> None:
    """Ask four times a second. BuildError when it takes too long or the process ends."""
    deadline = time.monotonic() + seconds
    while not happened():
        if process.poll() is not None:
            raise BuildError(f"it ended with code {process.returncode} before {what}")
        if time.monotonic() > deadline:
            raise BuildError(f"not within {seconds:.0f} s: {what}")
        time.sleep(0.25)


def expect(so: object, what: str) -> None:
    """BuildError unless it is so."""
    if not so:
        raise BuildError(f"expected otherwise: {what}")


def ask(url: str, key: str = "", body: dict[str, object] | None = None) -> tuple[int, str]:
    """Status and text; 0 when nothing answers."""
    headers = {"Content-Type": "application/json"} | ({"Authorization": f"Bearer {key}"} if key else {})
    data = None if body is None else json.dumps(body).encode()
    try:
        with urllib.request.urlopen(urllib.request.Request(url, data, headers), timeout=10) as response:
            return response.status, response.read().decode("utf-8", "replace")
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode("utf-8", "replace")
    except OSError:
        return 0, ""


def may_become(image: Image) -> bool:
    """Whether the command can run as the image's own user: only root may, and only where that user can reach Python."""
    if image.user is None or os.geteuid() != 0:
        print(f"· not run by root: starts as the present user, not as {image.user}", flush=True)
        return False
    command = [program("python3", image.env), "-c", ""]
    try:
        able = subprocess.run(command, user=image.user, env=image.env, capture_output=True, check=False).returncode == 0
    except PermissionError:
        able = False
    if not able:
        print(f"· user {image.user} cannot run {command[0]}: starts as the present user", flush=True)
    return able


def program(name: str, env: dict[str, str]) -> str:
    """Where a program is on the image's PATH."""
    found = shutil.which(name, path=env["PATH"])
    if not found:
        raise BuildError(f"{name} is not on the image's PATH")
    return found


def group_lives(process: subprocess.Popen[bytes]) -> bool:
    """Whether a process that it started is still there a moment later."""
    for _ in range(10):
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return False
        time.sleep(0.1)
    return True


def end_group(process: subprocess.Popen[bytes]) -> None:
    """Nothing stays behind, however it went."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        return
    process.wait()


def free_port() -> int:
    """A port that nothing listens on now."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        port: int = listener.getsockname()[1]
        return port


if __name__ == "__main__":
    sys.exit(main())
