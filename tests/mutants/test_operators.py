"""The bugs that are put into code: each a change of what it does, none of what it says, and every one can be read."""

from __future__ import annotations

import ast
from pathlib import Path

from for_each import for_each

from mutants.bug import Bug
from mutants.by_hand import bugs_by_hand
from mutants.operators import bugs

ROOT = Path(__file__).resolve().parents[2]
SAYING = '''"""A module that says 1 + 2."""
from __future__ import annotations
import os

def told(value: int, other: list[int] | None = None) -> str:
    """No 3 < 4 here."""
    logger.info("5 > 6", 7)
    print(8)
    return f"{value + 9} and {other[0]}"
'''


def wrong(text: str) -> set[str]:
    """What a line becomes."""
    return {bug.put_into(text) for bug in bugs("a.py", text)}


@for_each(
    ("right", "others"),
    [
        ("x = a + b", {"x = a - b"}),
        ("x = a * -b", {"x = a / -b", "x = a * b"}),
        ("x = a < b", {"x = a <= b", "x = a > b"}),
        ("x = a == 0", {"x = a != 0", "x = a == 1"}),
        ("x = a and b or c", {"x = a or b or c", "x = a and b and c"}),
        ("x = 0.5", {"x = 0.75"}),
        ("x = a[0]", {"x = a[1]"}),
        ("x = 100", {"x = 150"}),
        ("x = zip(a, b, strict=True)", set()),
        ("x = min(a, b)", {"x = max(a, b)"}),
        ("x = np.maximum(a, b)", {"x = np.minimum(a, b)"}),
        ("x = not a", {"x = a"}),
        ("x = a is None", {"x = a is not None"}),
        ("a.append(b)", {"pass", "a.extend(b)"}),
        ("x += 1", {"pass", "x += 2"}),
        ("x = a.reshape(-1, 2)", {"x = a.reshape(-1, 3)"}),
        ("x = field(repr=False, init=True)", {"x = field(repr=False, init=False)"}),
        (
            "def f(a, b=1, *, seed=0, c=2): ...",
            {"def f(a, b=2, *, seed=0, c=2): ...", "def f(a, b=1, *, seed=0, c=3): ..."},
        ),
        ("def f(seed=0, b=1): ...", {"def f(seed=0, b=2): ..."}),
    ],
)
def test_every_sort_of_bug(right: str, others: set[str]) -> None:
    assert wrong(right) == others


def test_conditions_are_turned_round_and_values_not_returned() -> None:
    text = "def f(a):\n    if a:\n        return b\n    raise ValueError(1 + 2)\n"
    assert wrong(text) == {
        text.replace("if a", "if not (a)"),
        text.replace("return b", "return None"),
        text.replace("raise ValueError(1 + 2)", "pass"),
    }


def test_what_only_says_something_is_left_alone() -> None:
    assert {bug.kind for bug in bugs("a.py", SAYING)} == {"value returned"}


def test_letters_of_more_than_one_byte_do_not_shift_places() -> None:
    assert wrong('x = "ä€", a + b') == {'x = "ä€", a - b'}


def test_who_reads_a_constant_is_asked_and_who_runs_a_line() -> None:
    text = "LIMIT = 3\n\ndef f(a):\n    return a + 1\n"
    found = bugs("a.py", text)
    assert {bug.names for bug in found if bug.first == 1} == {("LIMIT",)}
    assert {(bug.names, bug.last) for bug in found if bug.first > 1} == {((), 4)}


def test_every_bug_of_a_module_can_be_read() -> None:
    for name in ("motion_backend/metrics/contact_error.py", "scene_graphs/home.py", "planner_service/pipeline.py"):
        text = (ROOT / name).read_text(encoding="utf-8")
        found = bugs(name, text)
        assert len(found) > 40
        for bug in found[::40]:
            assert ast.dump(ast.parse(bug.put_into(text))) != ast.dump(ast.parse(text)), bug


def test_bugs_by_hand_are_of_texts_that_are_there() -> None:
    for bug in bugs_by_hand(ROOT):
        assert isinstance(bug, Bug)
        text = (ROOT / bug.path).read_text(encoding="utf-8")
        assert bug.put_into(text) != text
        assert bug.difference(text)
