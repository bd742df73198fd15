"""pytest in a process forked from one that has imported the libraries: to see which lines a test runs, or to see a bug.

Of the project itself nothing is imported before the fork that changes trees, so that every child reads its own.
"""

from __future__ import annotations

import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, Final

import pytest
from run_layer import FAST

LIBRARIES: Final = (
    "numpy", "scipy.ndimage", "scipy.spatial", "scipy.optimize", "scipy.interpolate", "scipy.signal", "shapely",
    "networkx", "trimesh", "numba", "torch", "safetensors", "pydantic", "pydantic_settings", "fastapi", "sqlalchemy",
    "httpx", "typer", "rich", "structlog", "matplotlib.figure", "hypothesis", "psycopg", "prometheus_client",
    "platformdirs", "coverage", "json", "unittest.mock", "xml.etree.ElementTree",
)  # fmt: skip
OURS: Final = (
    "scene_graphs.layout_library", "motion_backend.procedural.backend", "motion_backend.metrics.story_metrics",
    "planner_service.pipeline", "planner_service.output.story_files", "planner_service.cli",
)  # fmt: skip
"""What most tests import of the project, directly or not; read by those who do not change it."""
OPTIONS: Final = (
    *("-q", "-p", "no:cacheprovider", "--tb=line", "-m", FAST.chosen),
    *("-W", "ignore::pytest.PytestAssertRewriteWarning"),
)
"""For pytest: tests of the fast layer; the warning is about libraries that are imported before it."""


def load_libraries() -> None:
    """Import what takes long, once, before anything is forked."""
    for name in LIBRARIES:
        with suppress(ImportError):
            import_module(name)
    for plugin in entry_points(group="pytest11"):
        plugin.load()


def load_ours() -> None:
    """Import most of the tree that the process was moved to."""
    for name in OURS:
        import_module(name)


def child(tree: Path, work: Callable[[], int], out: Path, cpu_seconds: float, environment: dict[str, str]) -> int:
    """Exit code of some work in a forked process in a tree of its own; 124 when it takes too long. Prints go to `out`.

    A test that waits for something takes no processor time, so wall time is bounded too.
    """
    pid = os.fork()
    if pid == 0:
        code = 70
        try:
            os.setsid()
            _move_to(tree, out, environment)
            resource.setrlimit(resource.RLIMIT_CPU, (int(cpu_seconds) + 1, int(cpu_seconds) + 5))
            code = work()
        except Exception:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    deadline = time.monotonic() + 10 * cpu_seconds
    while True:
        done, status = os.waitpid(pid, os.WNOHANG)
        late = time.monotonic() > deadline
        if done or late:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(pid, signal.SIGKILL)
            if not done:
                os.waitpid(pid, 0)
            code = 124 if late and not done else os.waitstatus_to_exitcode(status)
            return 124 if code in (-signal.SIGXCPU, -signal.SIGKILL) else code
        time.sleep(0.02)


def _move_to(tree: Path, out: Path, environment: dict[str, str]) -> None:
    os.chdir(tree)
    # Beside the tree itself nothing of the project is on the path: neither the one that was run nor an installed one.
    sys.path[:] = [str(tree), *(place for place in sys.path if place and not (Path(place) / "scene_graphs").is_dir())]
    kept = {"SIMS_DATA_DIR": out.parent / "data", "SIMS_TEST_CACHE": out.parent / "sentences"}
    os.environ.update({"PYTHONPATH": str(tree)} | {name: str(folder) for name, folder in kept.items()} | environment)
    # A bug has a date of its own, so that what is compiled of it is not taken for the module without it.
    sys.dont_write_bytecode = False
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    target = os.open(out, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for stream in (1, 2):
        os.dup2(target, stream)


class Chosen:
    """Only the tests asked for, in their order; examples that fail are not made smaller."""

    def __init__(self, wanted: Sequence[str] | None = None) -> None:
        self._order = None if wanted is None else {name: place for place, name in enumerate(wanted)}
        self.failed = ""

    def pytest_configure(self) -> None:
        from hypothesis import Phase, settings

        phases = (Phase.explicit, Phase.generate)
        settings.register_profile("mutants", settings(), database=None, phases=phases)
        settings.load_profile("mutants")

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        if self._order is not None:
            order = self._order
            items[:] = sorted((item for item in items if item.nodeid in order), key=lambda item: order[item.nodeid])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed and not self.failed:
            self.failed = report.nodeid

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed and not self.failed:
            self.failed = report.nodeid


class Watched(Chosen):
    """Which lines of the packages every test runs, how long it takes and whether it passes."""

    IMPORTS: Final = "(imports)"

    def __init__(self, tree: Path, packages: Sequence[str]) -> None:
        super().__init__()
        from coverage import Coverage

        self._tree = tree
        self.seconds: dict[str, float] = {}
        self.bad: set[str] = set()
        self._coverage = Coverage(
            data_file=None, config_file=False, include=[str(tree / name / "*") for name in packages], messages=False
        )
        self._coverage.start()
        self._coverage.switch_context(self.IMPORTS)
        self._begun = time.process_time()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        self._coverage.switch_context(item.nodeid)
        start = time.process_time()
        try:
            return (yield)
        finally:
            self.seconds[item.nodeid] = time.process_time() - start
            self._coverage.switch_context(self.IMPORTS)

    def pytest_collection_finish(self) -> None:
        self.seconds[self.IMPORTS] = time.process_time() - self._begun

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed or report.skipped:
            self.bad.add(report.nodeid)

    def lines(self) -> dict[str, dict[str, list[int]]]:
        """Per context (a test, or the imports of its file) the lines run of every module."""
        self._coverage.stop()
        data = self._coverage.get_data()
        found: dict[str, dict[str, list[int]]] = {}
        for context in data.measured_contexts():
            data.set_query_context(context)
            found[context] = {
                str(Path(name).relative_to(self._tree)): sorted(lines)
                for name in data.measured_files()
                if (lines := data.lines(name))
            }
        return found
