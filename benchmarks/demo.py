"""`make demo` as a new user meets it: a cold process with an empty cache, its wall time and its memory."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.figure import Figure
from benchmarks.themes import demo

SECONDS, GIGABYTES = 20.0, 1.5


def measure_demo() -> list[Figure]:
    """Run `sims story` on the demo's theme. RuntimeError with its last words if it fails.

    Must come before any other child process: the peak memory is that of the largest child so far.
    """
    theme, seed = demo()
    with tempfile.TemporaryDirectory(prefix="sims-bench-") as folder:
        environment = os.environ | {"SIMS_DATA_DIR": str(Path(folder, "data")), "COLUMNS": "120"}
        command = [sys.executable, "-c", "from planner_service.cli import main; main()", "story", theme]
        started = time.perf_counter()
        done = subprocess.run(
            [*command, "--out", str(Path(folder, "out")), "--seed", str(seed)],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        wall = time.perf_counter() - started
    if done.returncode:
        raise RuntimeError(f"sims story ended with {done.returncode}: {done.stderr.strip()[-400:]}")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    scale = 1 if sys.platform == "darwin" else 1024  # macOS counts bytes, Linux kilobytes
    return [
        Figure("demo, cold process", wall, "s", SECONDS, note="set-up done, no cache of sentence features"),
        Figure("demo, peak memory", peak * scale / 1e9, "GB", GIGABYTES, digits=2),
    ]
