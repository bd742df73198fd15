"""Bugs written by hand: into how a body moves, into what is measured, and into the exact search for rooms.

All of them must be seen: they are the bugs that somebody would really make.
"""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

from mutants.bug import Bug

KERNEL: Final = "scene_graphs/graph/branch_and_bound_kernel.py"
SEARCH: Final = "scene_graphs/graph/branch_and_bound.py"
COSTS: Final = "scene_graphs/graph/substitution_costs.py"
INDEX: Final = "scene_graphs/retrieval/layout_index.py"
PACKED: Final = "scene_graphs/graph/packed_graphs.py"
COUNTS: Final = "scene_graphs/graph/count_table.py"
GAIT: Final = "motion_backend/procedural/walk/gait.py"
SITTING: Final = "motion_backend/procedural/sit/sit_transition.py"


class Mistake(NamedTuple):
    """One text of a module in the place of another, which is there once; or code that changes a function of it."""

    bug: str
    module: str
    right: str
    """The text; where it is `def name(`, what is wrong is put at the end of the module."""
    wrong: str


BODIES: Final = (
    Mistake(
        "the pelvis turns the wrong way in every walk",
        GAIT,
        "route.heading + hip_turn + np",
        "route.heading - hip_turn + np",
    ),
    Mistake(
        "the pelvis is lowest over the standing foot",
        "motion_backend/procedural/walk/pelvis_height.py",
        "beat = -steps.wave(",
        "beat = steps.wave(",
    ),
    Mistake(
        "hips hardly fold when sitting down",
        SITTING,
        "def lower_onto(",
        """

_folding = lower_onto


def lower_onto(start, *others, **more):
    pose = _folding(start, *others, **more)
    hips = rotations.slerp(np.broadcast_to(start.hips, pose.hips.shape), pose.hips, np.full(len(pose), 0.1))
    return replace(pose, hips=hips, spine=0.1 * pose.spine)
""",
    ),
    Mistake(
        "each arm swings with the leg of its own side",
        "motion_backend/procedural/walk/arm_swing.py",
        "side * steps.first * np.cos(",
        "-side * steps.first * np.cos(",
    ),
    Mistake(
        "skating is counted below 3 cm instead of 5",
        "motion_backend/metrics/foot_skate.py",
        "LOW = 0.05",
        "LOW = 0.03",
    ),
    Mistake(
        "a contact need be held for half a second only",
        "motion_backend/metrics/contact_error.py",
        "SUSTAINED = 1.0",
        "SUSTAINED = 0.5",
    ),
    Mistake(
        "toes come down before heels",
        "motion_backend/procedural/walk/foot_trajectory.py",
        "falling = self.heel_strike *",
        "falling = -self.heel_strike *",
    ),
)

RETRIEVAL: Final = (
    Mistake(
        "the last candidate is dropped",
        KERNEL,
        "while at_option < there.ends[depth]:",
        "while at_option < there.ends[depth] - 1:",
    ),
    Mistake("twins may not take the next node", KERNEL, "if r <= above or", "if r <= above + 1 or"),
    Mistake("twins by word alone", SEARCH, "same and around[other] - {index} == around[index] - {other}", "same"),
    Mistake(
        "twins whatever they need",
        SEARCH,
        "words[other] == words[index] and needs[other] == needs[index]",
        "words[other] == words[index]",
    ),
    Mistake(
        "every relation is kept",
        KERNEL,
        "if state.joined[asked.first[edge], r]:",
        "if state.image[asked.first[edge]] >= 0:",
    ),
    Mistake("the bound of a node is too high", KERNEL, "* kept >= upper:", "* kept + 1 >= upper:"),
    Mistake(
        "the bound of a candidate is too high",
        KERNEL,
        "most[depth] + ahead[depth] >= upper",
        "most[depth] + ahead[depth] + 1 >= upper",
    ),
    Mistake(
        "a mapping's bound is too high",
        KERNEL,
        "cost[depth + 1] + ahead[depth] < upper",
        "cost[depth + 1] + ahead[depth] + 1 < upper",
    ),
    Mistake(
        "leaving out has too high a bound",
        KERNEL,
        "cost[depth + 1] + ahead[depth] >= upper",
        "cost[depth + 1] + ahead[depth] + 1 >= upper",
    ),
    Mistake("edges to earlier nodes are not hoped for", KERNEL, "most[depth] = asked.saved * own", "most[depth] = 0"),
    Mistake("using furniture is not refunded", SEARCH, "cost - c.insert for c in own", "cost for c in own"),
    Mistake("no second stage", KERNEL, "for stage in range(2):", "for stage in range(1):"),
    Mistake("the first stage passes over its border", KERNEL, "(bound <= border) ==", "(bound < border) =="),
    Mistake("a heap that does not sink", KERNEL, "if value <= heap[child]:", "if value >= heap[child]:"),
    Mistake("ties in any order", KERNEL, "return bool(place < best.place[at])", "return bool(place > best.place[at])"),
    Mistake(
        "ties without bounds", KERNEL, "return bool(bound < best.bound[at])", "return bool(bound > best.bound[at])"
    ),
    Mistake(
        "candidates in any order",
        KERNEL,
        "for level in range(asked.most_level):",
        "for level in range(asked.most_level - 1, -1, -1):",
    ),
    Mistake("taken nodes may be taken again", KERNEL, "if r <= above or not state.free[r]:", "if r <= above:"),
    Mistake("nodes stay taken", KERNEL, "    state.free[r] = True\n", "    pass\n"),
    Mistake("neighbours stay joined", KERNEL, "there.shift[r]] = False", "there.shift[r]] = True"),
    Mistake("counts are not given back", KERNEL, "_count(asked, there.code[r], state.counted, 1)", "pass"),
    Mistake(
        "needs are not asked after",
        KERNEL,
        "if fits and asked.needs[piece] & ~rooms.offers[there.node[r]] == 0:",
        "if fits:",
    ),
    Mistake(
        "relations are hopeless too soon",
        KERNEL,
        "if state.free[other] and there.may[b, other]:",
        "if state.free[other] and there.may[a, other]:",
    ),
    Mistake(
        "a term forgets its parts", KERNEL, "wanted += min(asked.part_asked[depth, part], free[terms + part])", "pass"
    ),
    Mistake(
        "live terms are one too few", SEARCH, "place >= depth for place in last", "place > depth for place in last"
    ),
    Mistake(
        "bounds forget the parts of kinds",
        KERNEL,
        "wanted[room] += own[room] if own[room] < number else number",
        "wanted[room] += 0",
    ),
    Mistake(
        "a full byte is a number", KERNEL, "if asked.edge_asked[pair] < _FULL:", "if asked.edge_asked[pair] < 9999:"
    ),
    Mistake(
        "relations of one group are lost",
        COSTS,
        '"edge", *sorted((group_of(first), group_of(second)))',
        '"edge", group_of(first), group_of(first)',
    ),
    Mistake(
        "the group saves what the class does",
        COSTS,
        "own.delete + own.insert - own.sub_group, (",
        "own.delete + own.insert - own.sub_class, (",
    ),
    Mistake(
        "sub_group may pass delete + insert",
        COSTS,
        "<= self.sub_group <= self.delete + self.insert",
        "<= self.sub_group",
    ),
    Mistake("a kind is its own name only", COSTS, "if w != kind and w in categories_of(kind)", 'if w == "nothing"'),
    Mistake("rooms at the limit are dropped", KERNEL, "upper = ENDLESS  # Go on", "break  # Go on"),
    Mistake(
        "a room at the limit is called exact",
        INDEX,
        "exact=least_doubtful > entry.cost or (least_doubtful == entry.cost > entry.bound)",
        "exact=True",
    ),
    Mistake("doubt about other rooms is forgotten", KERNEL, "doubtful = min(doubtful, bound)", "pass"),
    Mistake("the effort of all is no limit", KERNEL, "effort -= expanded", "pass"),
    Mistake(
        "side by side, all neighbours are the first room's",
        KERNEL,
        "there.node[filled], there.shift[filled] = place, begin",
        "there.node[filled], there.shift[filled] = place, 0",
    ),
    Mistake("extra relations cost nothing", PACKED, "+ costs.extra_edge * (edges // 2)", ""),
    Mistake("counts wrap at a byte", COUNTS, "np.minimum(counts, MAX_COUNT).astype", "counts.astype"),
)


def bugs_by_hand(root: Path) -> list[Bug]:
    """All of them. ValueError names the one whose text is not there once: then it is the bug that is to be mended."""
    return [_bug(root, mistake) for mistake in (*BODIES, *RETRIEVAL)]


def _bug(root: Path, mistake: Mistake) -> Bug:
    text = (root / mistake.module).read_text(encoding="utf-8")
    if text.count(mistake.right) != 1:
        raise ValueError(
            f"{mistake.bug}: {mistake.module} has {mistake.right!r} {text.count(mistake.right)} times; mend the mistake"
        )
    start = text.index(mistake.right)
    line = text.count("\n", 0, start) + 1
    statement = _statement_at(_parsed(text), line)
    lines = statement.lineno, statement.end_lineno or statement.lineno
    if mistake.right.startswith("def "):
        return Bug(mistake.module, len(text), len(text), mistake.wrong, *lines, mistake.bug)
    stop = start + len(mistake.right)
    names = (mistake.right.split(" ")[0],) if isinstance(statement, ast.Assign) and statement.col_offset == 0 else ()
    return Bug(mistake.module, start, stop, mistake.wrong, *lines, mistake.bug, names)


_parsed = cache(ast.parse)


def _statement_at(tree: ast.Module, line: int) -> ast.stmt:
    """The innermost statement that has a line."""
    around = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or node.lineno)
    ]
    return min(around, key=lambda node: (node.end_lineno or node.lineno) - node.lineno)
