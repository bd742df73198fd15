"""Bugs put into the cost table, the bound and the search, one at a time: how many do the tests find?

    python tests/scene_graphs/mutants_of_retrieval.py

By hand, since it takes minutes. Every mutant is a copy of the tree with one text replaced; the kernel runs uncompiled.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
TESTS = [f"tests/scene_graphs/test_{name}.py" for name in ("distance", "retrieval", "packing")]


class Mutant(NamedTuple):
    """One text of a module in the place of another, which is there once."""

    bug: str
    module: str
    right: str
    wrong: str


MUTANTS = (
    Mutant(
        "the last candidate is dropped",
        "kernel",
        "while at_option < there.ends[depth]:",
        "while at_option < there.ends[depth] - 1:",
    ),
    Mutant("twins may not take the next node", "kernel", "if r <= above or", "if r <= above + 1 or"),
    Mutant("twins by word alone", "branching", "same and around[other] - {index} == around[index] - {other}", "same"),
    Mutant(
        "twins whatever they need",
        "branching",
        "words[other] == words[index] and needs[other] == needs[index]",
        "words[other] == words[index]",
    ),
    Mutant(
        "every relation is kept",
        "kernel",
        "if state.joined[asked.first[edge], r]:",
        "if state.image[asked.first[edge]] >= 0:",
    ),
    Mutant("the bound of a node is too high", "kernel", "* kept >= upper:", "* kept + 1 >= upper:"),
    Mutant(
        "the bound of a candidate is too high",
        "kernel",
        "most[depth] + ahead[depth] >= upper",
        "most[depth] + ahead[depth] + 1 >= upper",
    ),
    Mutant(
        "a mapping's bound is too high",
        "kernel",
        "cost[depth + 1] + ahead[depth] < upper",
        "cost[depth + 1] + ahead[depth] + 1 < upper",
    ),
    Mutant(
        "leaving out has too high a bound",
        "kernel",
        "cost[depth + 1] + ahead[depth] >= upper",
        "cost[depth + 1] + ahead[depth] + 1 >= upper",
    ),
    Mutant("edges to earlier nodes are not hoped for", "kernel", "most[depth] = asked.saved * own", "most[depth] = 0"),
    Mutant("using furniture is not refunded", "branching", "cost - c.insert for c in own", "cost for c in own"),
    Mutant("no second stage", "kernel", "for stage in range(2):", "for stage in range(1):"),
    Mutant("the first stage passes over its border", "kernel", "(bound <= border) ==", "(bound < border) =="),
    Mutant("a heap that does not sink", "kernel", "if value <= heap[child]:", "if value >= heap[child]:"),
    Mutant("ties in any order", "kernel", "return bool(place < best.place[at])", "return bool(place > best.place[at])"),
    Mutant(
        "ties without bounds", "kernel", "return bool(bound < best.bound[at])", "return bool(bound > best.bound[at])"
    ),
    Mutant(
        "candidates in any order",
        "kernel",
        "for level in range(asked.most_level):",
        "for level in range(asked.most_level - 1, -1, -1):",
    ),
    Mutant("taken nodes may be taken again", "kernel", "if r <= above or not state.free[r]:", "if r <= above:"),
    Mutant("nodes stay taken", "kernel", "    state.free[r] = True\n", "    pass\n"),
    Mutant("neighbours stay joined", "kernel", "there.shift[r]] = False", "there.shift[r]] = True"),
    Mutant("counts are not given back", "kernel", "_count(asked, there.code[r], state.counted, 1)", "pass"),
    Mutant(
        "needs are not asked after",
        "kernel",
        "if fits and asked.needs[piece] & ~rooms.offers[there.node[r]] == 0:",
        "if fits:",
    ),
    Mutant(
        "relations are hopeless too soon",
        "kernel",
        "if state.free[other] and there.may[b, other]:",
        "if state.free[other] and there.may[a, other]:",
    ),
    Mutant(
        "a term forgets its parts", "kernel", "wanted += min(asked.part_asked[depth, part], free[terms + part])", "pass"
    ),
    Mutant(
        "live terms are one too few", "branching", "place >= depth for place in last", "place > depth for place in last"
    ),
    Mutant(
        "bounds forget the parts of kinds",
        "kernel",
        "wanted[room] += own[room] if own[room] < number else number",
        "wanted[room] += 0",
    ),
    Mutant(
        "a full byte is a number", "kernel", "if asked.edge_asked[pair] < _FULL:", "if asked.edge_asked[pair] < 9999:"
    ),
    Mutant(
        "relations of one group are lost",
        "costs",
        '"edge", *sorted((group_of(first), group_of(second)))',
        '"edge", group_of(first), group_of(first)',
    ),
    Mutant(
        "the group saves what the class does",
        "costs",
        "own.delete + own.insert - own.sub_group, (",
        "own.delete + own.insert - own.sub_class, (",
    ),
    Mutant(
        "sub_group may pass delete + insert",
        "costs",
        "<= self.sub_group <= self.delete + self.insert",
        "<= self.sub_group",
    ),
    Mutant("a kind is its own name only", "costs", "if w != kind and w in categories_of(kind)", 'if w == "nothing"'),
    Mutant("rooms at the limit are dropped", "kernel", "upper = ENDLESS  # Go on", "break  # Go on"),
    Mutant("a room at the limit is called exact", "retrieval", "exact=least_doubtful >= entry.cost", "exact=True"),
    Mutant("doubt about other rooms is forgotten", "kernel", "doubtful = min(doubtful, bound)", "pass"),
    Mutant("the effort of all is no limit", "kernel", "effort -= expanded", "pass"),
    Mutant(
        "side by side, all neighbours are the first room's",
        "kernel",
        "there.node[filled], there.shift[filled] = place, begin",
        "there.node[filled], there.shift[filled] = place, 0",
    ),
    Mutant("extra relations cost nothing", "packing", "+ costs.extra_edge * (edges // 2)", ""),
    Mutant("counts wrap at a byte", "counting", "np.minimum(counts, MAX_COUNT).astype", "counts.astype"),
)


def killed(mutant: Mutant) -> str | None:
    """The test that fails with the bug, or None. ValueError if the text to replace is not there once."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder)
        for name in ("scene_graphs", "tests/scene_graphs", "pyproject.toml"):
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, tree / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy(source, tree / name)
        path = tree / "scene_graphs" / f"{mutant.module}.py"
        text = path.read_text(encoding="utf-8")
        if text.count(mutant.right) != 1:
            raise ValueError(f"{mutant.bug}: {mutant.right!r} occurs {text.count(mutant.right)} times; mend the mutant")
        path.write_text(text.replace(mutant.right, mutant.wrong), encoding="utf-8")
        command = [sys.executable, "-m", "pytest", "-xq", "-p", "no:cacheprovider", "-k", "not compile", *TESTS]
        environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": folder}
        try:
            done = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, timeout=300)
        except subprocess.TimeoutExpired:
            return "(it does not end)"
        failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
        return None if done.returncode == 0 else (failed or ["(it does not run)"])[0]


def main() -> int:
    """Print every mutant with the test that killed it; 1 if one lived."""
    if (failed := killed(Mutant("none", "kernel", "_BUCKETS: Final = 4096", "_BUCKETS: Final = 4096"))) is not None:
        print(f"without any bug there fails {failed}")
        return 1
    lived = 0
    for mutant in MUTANTS:
        found = killed(mutant)
        lived += found is None
        print(f"{'LIVES' if found is None else 'dies '} {mutant.bug}: {found or ''}", flush=True)
    print(f"{len(MUTANTS) - lived} of {len(MUTANTS)} die")
    return 1 if lived else 0


if __name__ == "__main__":
    sys.exit(main())
