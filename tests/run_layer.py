"""Run the layers of the tests one after the other, and close with what each took beside its limits."""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Layer:
    """Tests that are run together."""

    chosen: str
    """What pytest is to choose by marker."""
    wall: float | None
    """Seconds it may take on two cores from a set-up environment; None: no limit."""
    cpu: float | None
    """Seconds that all its processes together may compute."""
    workers: int
    """Processes that share the tests."""
    starts_nothing: bool = False
    """Whether no test starts a process or a server: then one may be forked."""

    @property
    def shared(self) -> list[str]:
        """How pytest is told to share the tests among processes; those of a file stay together."""
        if self.starts_nothing and sys.platform == "linux":
            # A plugin that is not wanted takes longer to load than many tests; files by name would come line by line.
            return [
                "-q",
                "-p",
                "forked_workers",
                "--forks",
                str(self.workers),
                "-p",
                "no:xdist",
                "-p",
                "no:schemathesis",
            ]
        return ["--numprocesses", str(self.workers), "--dist", "loadfile", "--no-loadscope-reorder"]


CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
FAST = Layer("not service and not sweep", 240, 250, min(CORES, 4), starts_nothing=True)
# Tests of a whole service mostly wait for it: three files at a time on two cores.
SERVICE = Layer("service and not sweep", 480, None, min(CORES, 4) + 1)
SWEEP = Layer("sweep", None, None, CORES)
LAYERS = {"test": (FAST,), "test-service": (SERVICE,), "test-all": (FAST, SERVICE, SWEEP)}
RELEASE = {"SIMS_TEST_KILLS": "20", "SIMS_TEST_STORIES": "50", "SIMS_TEST_EXAMPLES": "many"}
"""How much `test-all` tries, where nothing else is asked for."""


KERNELS = ("scene_graphs/graph/branch_and_bound_kernel.py", "motion_backend/rendering/film_kernel.py")
"""Of what is compiled at the first use, what takes long."""


def compile_once() -> None:
    """What set-up compiles is compiled again where it has changed since, and all processes wait for one.

    What was compiled is kept beside the module; processes that begin at once would each compile it.
    """
    if not all(_is_compiled(ROOT / kernel) for kernel in KERNELS):
        print("· compiling the search for rooms and what draws films, once", flush=True)
        subprocess.run([sys.executable, "-c", "import install; exec(install.COMPILE)"], cwd=ROOT, check=True)


def _is_compiled(module: Path) -> bool:
    kept = module.parent / "__pycache__"
    return any(file.stat().st_mtime > module.stat().st_mtime for file in kept.glob(f"{module.stem}.*.nbi"))


def computed() -> float:
    """CPU-seconds of all processes that have ended below this one."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(layer: Layer, more: list[str], environment: dict[str, str]) -> tuple[int, float, float]:
    """Pytest's exit code, and the wall and CPU seconds it took."""
    command = [sys.executable, "-m", "pytest", "-m", layer.chosen, *layer.shared, *more]
    path = os.pathsep.join(filter(None, [str(ROOT / "tests"), environment.get("PYTHONPATH")]))
    began, before = time.monotonic(), computed()
    code = subprocess.run(command, cwd=ROOT, env=environment | {"PYTHONPATH": path}, check=False).returncode
    return code, time.monotonic() - began, computed() - before


def beside(seconds: float, limit: float | None, name: str) -> str:
    """A figure beside its limit."""
    over = " (over)" if limit is not None and seconds > limit else ""
    return f"{seconds:.0f} {name}" + (f" of at most {limit:.0f}{over}" if limit is not None else "")


def main() -> int:
    """Run what is asked for; 1 when a test failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("layers", choices=LAYERS)
    asked, more = parser.parse_known_args()
    # Processes that share the cores would each start a thread a core.
    one_thread = {"OMP_NUM_THREADS": "1"}
    environment = one_thread | (RELEASE if asked.layers == "test-all" else {}) | dict(os.environ)
    code, lines = 0, list[str]()
    compile_once()
    for layer in LAYERS[asked.layers]:
        if asked.layers == "test-all":
            layer = replace(layer, wall=None, cpu=None)  # so much of it is not to be quick
        ended, wall, cpu = run(layer, more, environment)
        code = code or ended
        took = f"{beside(wall, layer.wall, 'seconds')}, {beside(cpu, layer.cpu, 'CPU-seconds')}"
        lines.append(f"make {asked.layers}, {layer.chosen}: {took}, on {CORES} cores")
    print("\n".join(lines), flush=True)
    return code


if __name__ == "__main__":
    sys.exit(main())
