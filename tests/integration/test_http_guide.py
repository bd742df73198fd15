"""The HTTP guide does what it says: its blocks are run in order against a real service, their output compared."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from running import RunningService

pytestmark = pytest.mark.service
GUIDE = Path(__file__).resolve().parents[2] / "docs" / "http.md"
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
END = "-- end of block --"


class Reader:
    """One who types the guide in: one shell and one Python session, from its first block to the last."""

    def __init__(self, folder: Path, url: str) -> None:
        environment = {**os.environ, "SIMS_URL": url}
        self.names: dict[str, object] = {}
        self.shell = subprocess.Popen(
            ["bash", "--norc"], cwd=folder, env=environment, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip

    def bash(self, block: str) -> str:
        """What a block prints; the first command that fails ends the shell."""
        assert self.shell.stdin is not None
        assert self.shell.stdout is not None
        self.shell.stdin.write(f"set -e -o pipefail\n{block}\necho '{END}'\n")
        self.shell.stdin.flush()
        printed = ""
        for line in self.shell.stdout:
            if line.rstrip("\n").endswith(END):
                return printed + line.rstrip("\n").removesuffix(END)
            printed += line
        raise AssertionError(f"a command failed in\n{block}\nit printed\n{printed}")

    def python(self, block: str) -> str:
        """What a block prints."""
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile(block, GUIDE.name, "exec"), self.names)
        return printed.getvalue()

    def __enter__(self) -> Reader:
        return self

    def __exit__(self, *_: object) -> None:
        self.shell.communicate("exit\n", timeout=10)


def as_pattern(shown: str) -> str:
    """A line of … stands for any lines, … within a line for anything on it."""
    lines = [
        "(?:.*\n)*?" if line.strip() == "…" else ".*".join(map(re.escape, line.split("…"))) + "\n"
        for line in shown.splitlines()
    ]
    return "".join(lines)


def test_the_guide_is_true(service: RunningService, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for command in ("bash", "curl", "jq"):
        if shutil.which(command) is None:
            pytest.skip(f"the guide's examples want {command}")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SIMS_URL", service.url)
    blocks = BLOCK.findall(GUIDE.read_text(encoding="utf-8"))
    with Reader(tmp_path, service.url) as reader:
        printed = ""
        for kind, block in blocks:
            if kind == "bash":
                printed = reader.bash(block)
                monkeypatch.setenv("STORY", reader.bash("echo $STORY").strip())
            elif kind == "python":
                printed = reader.python(block)
            elif kind == "text":
                assert re.fullmatch(as_pattern(block), printed), f"shown:\n{block}\nprinted:\n{printed}"
    assert {kind for kind, _ in blocks} >= {"bash", "python", "text"}
    for name in ("film.glb", "scene.glb"):
        assert (tmp_path / name).read_bytes()[:4] == b"glTF"
