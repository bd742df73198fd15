"""`sims serve`: the HTTP process, which supervises its workers and starts those again that die."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from types import FrameType
from typing import Final

import structlog

from planner_service.settings import Settings, SettingsError, give_backends

FIRST_WAIT, MAX_WAIT_SECONDS = 0.2, 15.0
"""Seconds before a worker that died is started again; doubled while it keeps dying."""
LIVED: Final = 30.0
"""Seconds after which a worker counts as having lived."""
GRACE: Final = 8
"""Seconds that requests and workers have to end when the service stops."""
PATIENCE: Final = 5
"""Seconds of these that a request may wait for the language model."""
FIRST: Final = "She comes home and sits down."
"""What is read before anything is asked for."""
log = structlog.get_logger("sims.serve")


@dataclass
class Slot:
    """A worker's place: its fixed id, and the process that has it now."""

    id: str
    process: subprocess.Popen[bytes] | None = None
    started: float = 0.0
    wait: float = FIRST_WAIT
    due: float = 0.0
    """When it is started again after it died."""


@dataclass
class Supervisor:
    """Keeps one process in every slot, under the same id, so that it goes on with its stories."""

    settings: Settings
    slots: list[Slot] = field(default_factory=list)
    stopping: threading.Event = field(default_factory=threading.Event)

    def start(self) -> None:
        """Start all workers, and a thread that watches them."""
        self.slots = [Slot(f"worker-{number}") for number in range(self.settings.workers)]
        for slot in self.slots:
            self._spawn(slot)
        threading.Thread(target=self._watch, name="supervisor", daemon=True).start()

    def stop(self) -> None:
        """Ask all workers to stop, and end those that do not."""
        self.stopping.set()
        running = [slot.process for slot in self.slots if slot.process is not None]
        for process in running:
            process.terminate()
        for process in running:
            try:
                process.wait(GRACE)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            if process.stdin is not None:
                process.stdin.close()

    def _watch(self) -> None:
        while not self.stopping.wait(0.1):
            now = time.monotonic()
            for slot in self.slots:
                if slot.process is None and now >= slot.due:
                    self._spawn(slot)
                elif slot.process is not None and slot.process.poll() is not None:
                    slot.wait = FIRST_WAIT if now - slot.started > LIVED else min(2 * slot.wait, MAX_WAIT_SECONDS)
                    log.warning("worker ended, starting it again", worker=slot.id, code=slot.process.returncode)
                    slot.process, slot.due = None, now + slot.wait

    def _spawn(self, slot: Slot) -> None:
        command = [sys.executable, "-m", "planner_service.cli", "worker", "--supervised"]
        slot.started = time.monotonic()
        try:
            slot.process = subprocess.Popen(command, stdin=subprocess.PIPE, env=environment(self.settings, slot.id))
        except OSError as error:  # no memory or no process number left, for now
            slot.due = slot.started + MAX_WAIT_SECONDS
            log.error("worker cannot be started", worker=slot.id, reason=str(error))


def environment(settings: Settings, worker_id: str) -> dict[str, str]:
    """The environment of a worker: these very settings, and one thread a worker."""
    from planner_service.store.database import database_url

    model = {f"SIMS_{name.upper()}": str(value) for name, value in settings if name.startswith(("llm_", "physics_"))}
    model["SIMS_PHYSICS_POLICIES"] = str(settings.physics_policies.absolute()) if settings.physics_policies else ""
    if settings.llm_story_dollars is None:
        del model["SIMS_LLM_STORY_DOLLARS"]
    given = {
        **model,
        "SIMS_DATA_DIR": str(settings.data_dir.absolute()),
        "SIMS_DATABASE_URL": database_url(settings),  # never empty: an empty one would leave it to `.env`
        "SIMS_BACKEND": settings.backend,
        "SIMS_CLIPS": str(settings.clips.absolute()) if settings.clips else None,
        "SIMS_LAYOUTS": str(settings.layouts.absolute()) if settings.layouts else None,
        "SIMS_LLM_API_KEY": settings.llm_api_key.get_secret_value(),
        "SIMS_LOG_LEVEL": settings.log_level,
        "SIMS_WORKER_ID": worker_id,
    }
    # Two threads of torch or of NumPy's BLAS on two busy cores are many times slower than one.
    calm = {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return {**os.environ, **calm, **{name: value for name, value in given.items() if value is not None}}


def serve(settings: Settings) -> None:
    """Answer until SIGTERM or SIGINT. SettingsError and BrokenBackendError name what cannot be used, before anything
    is started.
    """
    import uvicorn

    from motion_backend.backends import check_backend
    from planner_service.api.app import create_app
    from planner_service.api.authentication import check_exposure
    from planner_service.components import open_parts

    check_exposure(settings)
    give_backends(settings)
    check_backend(settings.backend)
    parts = open_parts(settings)
    supervisor = Supervisor(settings)

    class Server(uvicorn.Server):
        """Says when it is ready to answer, and where; ends streams when it stops."""

        def handle_exit(self, sig: int, frame: FrameType | None) -> None:  # noqa: ARG002
            # Not uvicorn's own, which raises the signal again at the end: that would leave no time to stop the workers.
            parts.stopping.set()
            patience = threading.Timer(PATIENCE, parts.hang_up)
            patience.daemon = True
            patience.start()
            # Ctrl-C reaches the workers as well; started again now, they would take up stories only to leave them.
            supervisor.stopping.set()
            self.force_exit = self.should_exit and sig == signal.SIGINT
            self.should_exit = True

        async def startup(self, sockets: list[object] | None = None) -> None:  # type: ignore[override]
            await super().startup(sockets)  # type: ignore[arg-type]
            if self.started:
                port = listening.getsockname()[1]
                workers = f"{settings.workers} worker{'s' * (settings.workers != 1)}"
                print(f"sims: ready at {_address(settings.host, port)} ({workers})", flush=True)  # noqa: T201
                threading.Thread(target=warm_up, name="warm up", daemon=True).start()

    listening = listen(settings)
    config = uvicorn.Config(
        create_app(parts),
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=GRACE,
        timeout_keep_alive=30,
    )
    supervisor.start()
    try:
        Server(config).run(sockets=[listening])
    finally:
        supervisor.stop()


def warm_up() -> None:
    """What the first visitor would wait for: the tables of English words that a theme is read with, the modules that
    build bodies."""
    from motion_backend.body.cast import Look
    from motion_backend.body.character_mesh import build_character
    from motion_backend.skeleton import build_skeleton
    from planner_service.pipeline import StoryRequest

    someone = StoryRequest(FIRST).character
    build_character(build_skeleton(someone.height), Look.of(someone))


def listen(settings: Settings) -> socket.socket:
    """A socket at the address of the settings. SettingsError when it cannot be had."""
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    # The protocol by name: asyncio sends small answers at once (TCP_NODELAY) only on sockets that say it.
    listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((settings.host, settings.port))
        listening.listen(512)  # a port is only ours once we listen
    except OSError as error:
        listening.close()
        where = f"{settings.host}:{settings.port}"
        raise SettingsError(
            f"{where} cannot be had: {error.strerror or error}", "try another port", at="SIMS_PORT"
        ) from error
    return listening


def _address(host: str, port: int) -> str:
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"
