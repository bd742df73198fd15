"""Many commands, each in a process of its own, without each importing everything again: forked from one that has."""

from __future__ import annotations

import io
import os
import pickle
import resource
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

HEAVY = (
    *(
        "planner_service.pipeline",
        "planner_service.store.database",
        "planner_service.library.import_layouts",
        "planner_service.output.story_export",
    ),
    *("planner_service.output.storyboard", "matplotlib.figure", "scipy.ndimage", "motion_backend.procedural.backend"),
    *(f"planner_service.cli.{command}" for command in ("story", "scripts", "layouts")),
    *("planner_service.api.layouts.views", "scene_graphs.loaders.mesh_scene", "motion_backend.rendering.surface_light"),
)
"""What commands load when they first use it."""


class Forked:
    """A process that has imported `sims` and forks for every command; Unix alone. Use it in `with`, in one thread.

    What says where packages are is for the process itself: `path`, as PYTHONPATH.
    """

    def __init__(self, path: str | None = None) -> None:
        self._environment = os.environ | ({"PYTHONPATH": path} if path else {})

    def __enter__(self) -> Self:
        self._process = subprocess.Popen(
            [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=self._environment
        )
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.communicate(timeout=60)

    def run(
        self, arguments: Sequence[str | bytes], folder: Path, environment: Mapping[str, str], most: int | None = None
    ) -> tuple[int, bytes, bytes]:
        """The exit code, standard output and standard error of `sims` with these arguments in a folder.

        No file may have more than `most` bytes.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        asked = ([os.fsencode(one) for one in arguments], str(folder), dict(environment), most)
        pickle.dump(asked, self._process.stdin)
        self._process.stdin.flush()
        answer: tuple[int, bytes, bytes] = pickle.load(self._process.stdout)  # noqa: S301 our own process
        return answer


def _serve(asked: BinaryIO, answers: BinaryIO) -> None:
    from importlib import import_module

    import planner_service.cli

    for name in HEAVY:
        import_module(name)
    while True:
        try:
            arguments, folder, environment, most = pickle.load(asked)  # noqa: S301
        except EOFError:
            return
        pickle.dump(_forked(arguments, folder, environment, most, planner_service.cli.main), answers)
        answers.flush()


def _forked(
    arguments: list[bytes], folder: str, environment: dict[str, str], most: int | None, main
) -> tuple[int, bytes, bytes]:
    outputs = [os.memfd_create(name) for name in ("out", "err")]
    pid = os.fork()
    if pid == 0:
        code = 70
        try:
            os.chdir(folder)
            os.environ.clear()
            os.environ.update(environment)
            for number, output in zip((1, 2), outputs, strict=True):
                os.dup2(output, number)
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            if most is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
            sys.stdin = io.TextIOWrapper(io.FileIO(0, closefd=False))
            sys.stdout, sys.stderr = (io.TextIOWrapper(io.FileIO(n, "w", closefd=False), "utf-8") for n in (1, 2))
            sys.argv = ["sims", *map(os.fsdecode, arguments)]
            code = _ended(main)
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            os._exit(code)
    _, status = os.waitpid(pid, 0)
    said = []
    for output in outputs:
        os.lseek(output, 0, os.SEEK_SET)
        with os.fdopen(output, "rb") as stream:
            said.append(stream.read())
    return os.waitstatus_to_exitcode(status), said[0], said[1]


def _ended(main) -> int:
    """What `main` ends with, as Python makes an exit code of it."""
    import traceback

    try:
        main()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0 if end.code is None else 1
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    # Nothing but answers may be written where they are read.
    channel = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    _serve(sys.stdin.buffer, channel)
