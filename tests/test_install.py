"""Set-up talks: where torch comes from, what a step is at, and what to do when it fails."""

from __future__ import annotations

import ast
import io
import os
import platform
import re
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Event, Thread

import pytest

pytestmark = pytest.mark.service
ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
import install  # noqa: E402

Index = Callable[[str], str]


@pytest.fixture(scope="module")
def index() -> Iterator[Index]:
    """An index that answers as its address says: /200, /404 or /hangs; on no port that is open for /closed."""
    over = Event()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            how = self.path.split("/")[1]
            if how == "hangs":
                over.wait(10)
            else:
                self.send_response(int(how))
                self.end_headers()

        def log_message(self, *words: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    Thread(target=server.serve_forever, args=(0.05,), daemon=True).start()
    closed = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    closed.server_close()
    yield lambda how: f"http://127.0.0.1:{(closed if how == 'closed' else server).server_port}/{how}"
    over.set()
    server.shutdown()
    server.server_close()


@pytest.fixture(autouse=True)
def venv(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An environment whose Python only says what it is asked for, and fails with what FAILURE says."""
    folder = tmp_path / ".venv"
    (folder / "lib" / "python3.11" / "site-packages" / "pip-23.2.1.dist-info").mkdir(parents=True)
    (folder / "bin").mkdir()
    python = folder / "bin" / "python"
    there = folder / "lib" / "python3.11" / "site-packages" / f"torch-{install.TORCH}+cpu.dist-info"
    python.write_text(
        f'#!/bin/sh\necho "$*" >> {tmp_path}/asked\nmkdir -p {there}\n'
        'echo "  Downloading a-1-py3-none-any.whl (12.5 MB)"\n[ -z "$FAILURE" ] || { echo "$FAILURE"; exit 1; }\n'
    )
    python.chmod(0o755)
    for name in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY", "PIP_CERT", "REQUESTS_CA_BUNDLE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(install, "VENV", folder)
    return folder


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(("how", "small"), [("200", True), ("404", False), ("hangs", False), ("closed", False)])
def test_on_linux_torch_is_small_where_its_index_answers_in_time(
    how: str, small: bool, index: Index, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(install, "CPU_INDEX", index(how))
    monkeypatch.setattr(install, "PROBE_SECONDS", 0.3 if how == "hangs" else 5)
    start = time.monotonic()
    chosen, words = install.torch_index("", "Linux")
    assert time.monotonic() - start < 2
    assert chosen == (index(how) if small else "")
    assert index(how) in words
    assert ("usual index" in words) is not small


@pytest.mark.parametrize(
    ("asked", "system", "chosen"), [("", "Darwin", ""), ("", "Windows", ""), ("https://x.example/cpu", "Linux", "https://x.example/cpu")]
)  # fmt: skip
def test_elsewhere_and_where_an_index_is_asked_for_nothing_is_probed(
    asked: str, system: str, chosen: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(install, "answers", lambda *_: pytest.fail("probed"))
    assert install.torch_index(asked, system)[0] == chosen


def test_what_pip_says_becomes_a_few_words(tmp_path: Path, venv: Path) -> None:
    said = "Looking in indexes: https://x.example\nCollecting torch==2.13.0\n"
    assert install.phrase("Compiling search\nCompiling film\n", tmp_path, 1) == ", film"
    assert install.phrase("", tmp_path, 1) == ""
    assert install.phrase(said, tmp_path, 1) == ", looking at torch"
    said += "  Downloading https://x.example/torch-2.13.0%2Bcpu-cp311-cp311-linux_x86_64.whl (191.8 MB)\n"
    (tmp_path / "pip-unpack-x").mkdir()
    (tmp_path / "pip-unpack-x" / "torch-2.13.0+cpu-cp311-cp311-linux_x86_64.whl").write_bytes(bytes(2_000_000))
    assert install.phrase(said, tmp_path, 1) == ", downloading torch-2.13.0+cpu, 2 of 191.8 MB"
    said += "Collecting typing-extensions>=4.10 (from torch)\n"
    assert install.phrase(said, tmp_path, 1) == ", looking at typing-extensions"
    said += "Installing collected packages: typing-extensions, torch\n"
    assert install.phrase(said, tmp_path, 1) == ", installing 1 of 2"
    (venv / "lib" / "python3.11" / "site-packages" / "typing_extensions-4.16.0.dist-info").mkdir()
    assert install.phrase(said, tmp_path, 1) == ", installing 2 of 2"


def test_a_terminal_has_one_line_a_step_and_a_log_no_line_that_is_written_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "50")
    command = [str(install.VENV / "bin" / "python"), "-m", "pip"]
    live, log = Terminal(), io.StringIO()
    assert install.run(install.Screen(live), "1/5 all", command) == 12.5
    assert live.getvalue().count("\n") == 1
    shown = live.getvalue().rstrip("\n").split("\r")
    assert {len(one) for one in shown[1:]} == {49}, "each covers the one before and none begins a second line"
    assert re.fullmatch(r"1/5 all: \d+ s, 12 MB downloaded", shown[-1].rstrip())
    assert install.run(install.Screen(log), "1/5 all", command) == 12.5
    assert re.fullmatch(r"1/5 all\n1/5 all: \d+ s, 12 MB downloaded\n", log.getvalue())
    monkeypatch.setattr(install, "NOTE_SECONDS", 0)
    install.run(install.Screen(log), "1/5 all", command)
    assert re.search(r"\n    \d+ s, downloading a-1, 0 of 12.5 MB\n", log.getvalue())


def test_all_steps_are_told_and_torch_is_fetched_only_where_it_is_missing(
    tmp_path: Path, index: Index, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(install, "CPU_INDEX", index("404"))
    monkeypatch.setattr(platform, "system", lambda: "Linux")
    for first in (True, False):
        monkeypatch.setattr(sys, "argv", ["install.py", "--dev"])
        assert install.main() == 0
        asked = (tmp_path / "asked").read_text().splitlines()
        (tmp_path / "asked").unlink()
        assert [line for line in asked if "torch==" in line] == ["-m pip install torch==2.13.0"] * first
        assert "-m pip install -e .[dev]" in asked
        told = capsys.readouterr().out.splitlines()
        assert [line[:3] for line in told if re.match(r"\d/\d .*:", line)] == [f"{n}/6" for n in range(1, 7)]
        assert ("3/6 torch 2.13.0: is there" in told) is not first
        assert re.fullmatch(r"· \.venv is ready: torch-2.13.0\+cpu \(CPU build\), 0\.0 GB .* MB downloaded", told[-1])


@pytest.mark.parametrize("works", [True, False])
def test_uv_installs_where_it_is_and_pip_what_it_could_not(
    works: bool, tmp_path: Path, venv: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    uv = venv / "bin" / "uv"
    uv.write_text(f'#!/bin/sh\necho "uv $*" >> {tmp_path}/asked\n{"true" if works else "echo no route; false"}\n')
    uv.chmod(0o755)
    (venv / "lib" / "python3.11" / "site-packages" / f"torch-{install.TORCH}.dist-info").mkdir()
    monkeypatch.setattr(sys, "argv", ["install.py"])
    assert install.main() == 0
    asked = [line for line in (tmp_path / "asked").read_text().splitlines() if " install " in line]
    wanted = ["--no-deps --require-hashes -r requirements-encoder.txt", "-e .[video]"]
    by_uv = [line for line in asked if line.startswith("uv pip install --python")]
    assert [any(line.endswith(f" {words}") for line in by_uv) for words in wanted] == [True, True]
    assert [f"-m pip install {words}" in asked for words in wanted] == [not works] * 2
    assert ("uv could not (no route): now pip does it" in capsys.readouterr().out) is not works


def test_uv_takes_packages_from_where_pip_does() -> None:
    said = (
        ":env:.index-url='https://me:secret@x.example/simple'\nglobal.index-url='https://y.example'\n"
        "global.extra-index-url='\\nfile:///a\\nfile:///b'\ninstall.find-links='/a /b'\ndownload.only-binary='x'\n"
        "global.cert='/etc/ca.crt'\nglobal.timeout='9'\n"
    )
    usual = {"UV_SYSTEM_CERTS": "1", "UV_INDEX_STRATEGY": "unsafe-best-match"}
    assert install.as_uv("") == usual, "as pip, it looks for the best in all of them"
    assert install.as_uv(said) == usual | {
        "UV_INDEX_URL": "https://me:secret@x.example/simple",
        "UV_EXTRA_INDEX_URL": "file:///a file:///b",
        "UV_FIND_LINKS": "/a,/b",
        "SSL_CERT_FILE": "/etc/ca.crt",
    }


@pytest.mark.parametrize("key", ["only-binary", "require-hashes", "no-index", "constraint", "something-new"])
def test_what_only_pip_can_follow_is_left_to_pip(key: str) -> None:
    assert install.as_uv(f"global.{key}='x'\n") is None


def test_where_pip_cannot_say_how_it_is_configured_pip_installs(
    tmp_path: Path, venv: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    python = venv / "bin" / "python"
    python.write_text(f'#!/bin/sh\necho "$*" >> {tmp_path}/asked\n[ "$3" != config ]\n')
    (venv / "bin" / "uv").write_text("#!/bin/sh\nexit 1\n")
    (venv / "bin" / "uv").chmod(0o755)
    install.Installer(install.Screen(sys.stdout)).install("5/6 all", ["x"])
    assert "-m pip install x" in (tmp_path / "asked").read_text()
    assert "uv does not know: pip does it" in capsys.readouterr().out


def test_what_uv_says_becomes_a_few_words(tmp_path: Path) -> None:
    said = "Resolved 9 packages in 1s\nDownloading torch (191.8MiB)\nDownloading mypy (9.0MiB)\n"
    assert install.phrase(said, tmp_path, 1) == ", downloading torch, mypy"
    assert install.phrase(said + " Downloaded mypy\n", tmp_path, 1) == ", downloading torch"
    assert install.phrase(said + " Downloaded mypy\n Downloaded torch\n", tmp_path, 1) == ", installing"


@pytest.mark.parametrize(
    ("failure", "remedy"),
    [
        ("OSError: [Errno 28] No space left on device", "free some disk"),
        ("THESE PACKAGES DO NOT MATCH THE HASHES", "cache purge"),
        ("NewConnectionError: Failed to establish a new connection", "HTTPS_PROXY"),
        ("The virtual environment was not created because ensurepip is not available", "apt install python3-venv"),
        ("error: subprocess-exited-with-error", "run it again"),
    ],
)
def test_a_failure_shows_what_pip_said_and_what_to_do(
    failure: str, remedy: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FAILURE", failure)
    monkeypatch.setattr(sys, "argv", ["install.py", "--torch-index", "https://x.example"])
    assert install.main() == 1
    said = capsys.readouterr()
    assert "3/6 torch 2.13.0: failed after" in said.out
    assert failure in said.err
    assert remedy in said.err.partition("What to do: ")[2]


def test_what_others_say_of_the_same_is_the_same() -> None:
    assert f'"torch=={install.TORCH}"' in (ROOT / "Dockerfile").read_text(encoding="utf-8")
    assert install.CPU_INDEX in (ROOT / "Dockerfile").read_text(encoding="utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert "install.py" in project["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
    assert project["project"]["requires-python"] == f">={'.'.join(map(str, install.OLDEST))}"
    for compiled in ast.walk(ast.parse(install.COMPILE)):
        if isinstance(compiled, ast.ImportFrom):
            text = (ROOT / str(compiled.module).replace(".", os.sep)).with_suffix(".py").read_text(encoding="utf-8")
            assert all(f"def {name.name}(" in text for name in compiled.names)
