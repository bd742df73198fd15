"""Put a sample of small bugs into each package, and print the share that the tests see.

    PYTHONPATH=tests python -m mutants                    40 bugs a package, and those written by hand
    PYTHONPATH=tests python -m mutants --seed 7 --only motion_backend --bugs 100

Exit code 1 when a package's share is below its limit, or a bug written by hand is not seen.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Final

from mutants.bug import Bug
from mutants.by_hand import bugs_by_hand
from mutants.coverage_map import KERNEL, PACKAGES, Selection, watch
from mutants.operators import bugs
from mutants.scratch_tree import ScratchTree
from mutants.trial import Verdict, attempt, line_of
from mutants.watched_session import load_libraries

ROOT: Final = Path(__file__).resolve().parents[2]
LIMIT: Final = 0.80
"""Share of a package's sampled bugs that the tests are to see."""
SECONDS: Final = 40.0
"""Of tests that are tried on one bug."""
LEFT_OUT: Final = (
    KERNEL,
    "scene_graphs/plots/",
    "scene_graphs/meshes/interior_mesh.py",
    "scene_graphs/meshes/mesh_details.py",
    "scene_graphs/meshes/materials.py",
    "motion_backend/rendering/",
    "motion_backend/body/mannequin_clothes.py",
    "planner_service/cli/",
    "planner_service/output/storyboard.py",
    "planner_service/output/backend_sheets.py",
    "planner_service/output/caption_sheets.py",
    "planner_service/output/cast_sheet.py",
    "planner_service/output/training_pictures.py",
)
"""What is only looked at; and the compiled kernel, whose lines no watching sees: its bugs are by hand."""
SERVED: Final = (
    "planner_service/api/",
    "planner_service/client/",
    "planner_service/jobs/",
    "planner_service/store/",
    "planner_service/server.py",
)
"""What only a running service does, which the quick layer leaves to the tests of services."""


def sample(package: str, number: int, seed: int) -> list[Bug]:
    """Bugs of a package: every line that can have one is as likely, and so is every bug of a line."""
    found: dict[tuple[str, int], list[Bug]] = {}
    for path in sorted((ROOT / package).rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        if not name.startswith((*LEFT_OUT, *SERVED)) and path.name != "__main__.py":
            text = path.read_text(encoding="utf-8")
            for bug in bugs(name, text):
                found.setdefault((name, text.count("\n", 0, bug.start)), []).append(bug)
    rng = random.Random(f"{seed} {package}")
    lines = rng.sample(sorted(found), min(number, len(found)))
    return [rng.choice(found[line]) for line in lines]


def try_all(wanted: Iterable[Bug], trees: Sequence[ScratchTree], selection: Selection) -> list[Verdict]:
    """Every bug, as many side by side as there are trees; what lives is printed as it is found."""
    free = list(trees)

    def one(bug: Bug) -> Verdict:
        tree = free.pop()
        try:
            return attempt(bug, tree, selection)
        finally:
            free.append(tree)

    verdicts = []
    with ThreadPoolExecutor(len(trees)) as pool:
        for done in as_completed([pool.submit(one, bug) for bug in wanted]):
            verdicts.append(verdict := done.result())
            if not verdict.seen:
                bug = verdict.bug
                print(f"  LIVES {bug.path}:{line_of(bug, ROOT)} {bug.kind} ({verdict.by})")
                print(bug.difference((ROOT / bug.path).read_text(encoding="utf-8")), flush=True)
            elif sys.stderr.isatty():
                print(f"  seen  {verdict.bug.path}:{line_of(verdict.bug, ROOT)} by {verdict.by}", file=sys.stderr)
    return verdicts


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        prog="python -m mutants", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--bugs", type=int, default=40, help="sampled bugs a package (default 40)")
    parser.add_argument("--seed", type=int, default=0, help="which sample (default 0)")
    parser.add_argument("--only", action="append", choices=[*PACKAGES, "by-hand"], help="these alone")
    parser.add_argument("--workers", type=int, default=2, help="bugs tried side by side (default 2)")
    parser.add_argument("--map-only", action="store_true", help="only watch which lines the tests run")
    asked = parser.parse_args()
    load_libraries()
    work = ROOT / ".cache" / "mutants"
    trees = [ScratchTree(ROOT, work / str(number)) for number in range(asked.workers)]
    selection = Selection(ROOT, watch(ROOT, work / "map", trees), SECONDS)
    if asked.map_only:
        return 0
    missed = 0
    for name in asked.only or (*PACKAGES, "by-hand"):
        start = time.monotonic()
        wanted = bugs_by_hand(ROOT) if name == "by-hand" else sample(name, asked.bugs, asked.seed)
        verdicts = try_all(wanted, trees, selection)
        seen = sum(verdict.seen for verdict in verdicts)
        limit = 1.0 if name == "by-hand" else LIMIT
        share = seen / max(len(verdicts), 1)
        missed += share < limit
        print(
            f"{name}: {seen} of {len(verdicts)} bugs seen, {share:.0%} (limit {limit:.0%}, seed {asked.seed}, "
            f"{time.monotonic() - start:.0f} s){'' if share >= limit else '  MISSED'}",
            flush=True,
        )
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
