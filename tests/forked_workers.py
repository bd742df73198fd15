"""A pytest plugin: processes that share the tests are forked from the one that has collected them (`--forks N`).

What is imported, read and compiled is so once and not in each of them. A file's tests stay together; who is free takes
the next file. For tests that start nothing, and on Linux alone: who forks a process that has threads, or that others
know by its number, does not know what he gets.
"""

from __future__ import annotations

import os
import pickle
import selectors
import signal
import struct
import traceback
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from itertools import groupby
from typing import BinaryIO, cast

import pytest
from encoded import encoded

_NUMBER = struct.Struct("<I")
SHARED = ("matplotlib.figure", "mujoco", "pydantic_ai.models.openai", "scipy.signal")
"""What is imported late, and by tests of several files."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--forks", type=int, default=0, help="processes that share the tests; 0: none, but this one")


def pytest_runtestloop(session: pytest.Session) -> bool | None:
    """Instead of pytest's own loop, where forks are asked for."""
    number = session.config.getoption("forks")
    if not number or session.config.option.collectonly or session.testsfailed:
        return None
    encoded()  # Hardly a file of tests does without the libraries and tables that a plan needs.
    for name in SHARED:
        import_module(name)
    files = [list(tests) for _, tests in groupby(session.items, key=lambda item: item.path)]
    temporary = session.config._tmp_path_factory.getbasetemp()  # type: ignore[attr-defined]
    ahead, feed = os.pipe()
    os.write(feed, b"".join(map(_NUMBER.pack, range(len(files)))))
    os.close(feed)
    workers: dict[BinaryIO, int] = {}
    for worker in range(number):
        reading, writing = os.pipe()
        if not (pid := os.fork()):
            folder = temporary / f"fork{worker}"
            folder.mkdir()
            session.config._tmp_path_factory._basetemp = folder  # type: ignore[attr-defined]
            _work(session, files, ahead, os.fdopen(writing, "wb"))
        os.close(writing)
        workers[os.fdopen(reading, "rb")] = pid
    os.close(ahead)
    try:
        _report(session, workers)
    finally:
        for source, pid in workers.items():
            source.close()
            with suppress(ProcessLookupError, ChildProcessError):
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
    return True


class _Telling:
    """Sends what becomes of tests to the process that reports it."""

    def __init__(self, config: pytest.Config, sink: BinaryIO) -> None:
        self._config, self._sink = config, sink

    def pytest_runtest_logstart(self, nodeid: str, location: tuple[str, int | None, str]) -> None:
        self._send(("start", nodeid, location))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._send(("report", self._config.hook.pytest_report_to_serializable(config=self._config, report=report)))

    def _send(self, message: tuple[object, ...]) -> None:
        pickle.dump(message, self._sink)
        self._sink.flush()


def _work(session: pytest.Session, files: Sequence[Sequence[pytest.Item]], ahead: int, sink: BinaryIO) -> None:
    """Run file after file until there is none, and end. In the forked process."""
    code = 1
    try:
        manager = session.config.pluginmanager
        capture = manager.getplugin("capturemanager")
        if capture is not None:  # Else all would write into one file.
            capture.stop_global_capturing()
            capture.start_global_capturing()
        manager.unregister(name="terminalreporter")
        manager.register(_Telling(session.config, sink))
        while taken := os.read(ahead, _NUMBER.size):
            tests = files[_NUMBER.unpack(taken)[0]]
            for item, following in zip(tests, (*tests[1:], None), strict=True):
                item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sink.flush()
        os._exit(code)


def _report(session: pytest.Session, workers: dict[BinaryIO, int]) -> None:
    """What all workers tell, as if it had been seen here. pytest.exit where one ends before its time."""
    hook, ready = session.config.hook, selectors.DefaultSelector()
    running = dict.fromkeys(workers, "nothing")
    for source in workers:
        ready.register(source, selectors.EVENT_READ)
    while running:
        for key, _ in ready.select():
            source = cast(BinaryIO, key.fileobj)
            try:
                kind, *told = pickle.load(source)  # noqa: S301 our own process
            except EOFError:
                ready.unregister(source)
                last = running.pop(source)
                _, status = os.waitpid(workers[source], 0)
                if status:
                    pytest.exit(f"a process ended with {os.waitstatus_to_exitcode(status)} after {last}", 1)
                continue
            if kind == "start":
                running[source] = told[0]
                hook.pytest_runtest_logstart(nodeid=told[0], location=told[1])
                continue
            report = hook.pytest_report_from_serializable(config=session.config, data=told[0])
            hook.pytest_runtest_logreport(report=report)
            if session.shouldfail or session.shouldstop:
                return
