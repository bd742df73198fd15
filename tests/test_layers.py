"""The layers hold: a fast test can start nothing, and a row of many that fails is named."""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import product
from pathlib import Path

import pytest
from _pytest.mark.expression import Expression
from for_each import RowsFailed, for_each
from layers import is_left_out
from run_layer import LAYERS


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


def test_a_fast_test_can_start_no_process() -> None:
    with pytest.raises(pytest.fail.Exception, match=r"pytest\.mark\.service"):
        subprocess.run([sys.executable, "-c", "pass"], check=True)
    with pytest.raises(pytest.fail.Exception, match=r"pytest\.mark\.service"):
        os.fork()


@pytest.mark.parametrize("fixture", ["service", "postgres_url"])
def test_a_fast_test_gets_nothing_live(fixture: str, request: pytest.FixtureRequest) -> None:
    with pytest.raises(pytest.fail.Exception, match=r"pytest\.mark\.service"):
        request.getfixturevalue(fixture)


SHARED = """
import os, pytest

@pytest.fixture
def broken():
    raise ValueError

def test_good(tmp_path): print("heard"); assert not list(tmp_path.iterdir())
def test_bad(): print("said"); assert 1 == 2
def test_error(broken): pass
@pytest.mark.skip(reason="not here")
def test_skipped(): pass
"""


@pytest.mark.service
@pytest.mark.parametrize(
    ("last", "says"),
    [
        ("def test_last(): pass", "2 failed, 3 passed, 2 skipped, 2 errors"),
        pytest.param(
            "def test_last(): os._exit(3)", "a process ended with 3 after test_0.py::test_last", marks=pytest.mark.sweep
        ),
    ],
)
def test_what_becomes_of_a_test_in_a_forked_process_is_told_even_if_it_ends_the_process(
    last: str, says: str, tmp_path: Path
) -> None:
    for number, more in enumerate((last, "")):
        (tmp_path / f"test_{number}.py").write_text(SHARED + more, encoding="utf-8")
    (tmp_path / "sentences-none.npz").touch()  # so that nothing is encoded for them
    (tmp_path / "pytest.ini").touch()
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent), "SIMS_TEST_CACHE": str(tmp_path)}
    command = [sys.executable, "-m", "pytest", *LAYERS["test"][0].shared, "-p", "no:cacheprovider"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert says in done.stdout
    assert "heard" not in done.stdout


@pytest.mark.service
def test_a_marked_test_may() -> None:
    assert subprocess.run([sys.executable, "-c", "pass"], check=True).returncode == 0


@pytest.mark.parametrize("marks", [set(), {"service"}, {"sweep"}, {"service", "sweep"}])
def test_every_test_is_in_one_layer_and_test_all_runs_all(marks: set[str]) -> None:
    chosen = [layer.chosen for layer in LAYERS["test-all"]]
    assert chosen[:2] == [layer.chosen for name in ("test", "test-service") for layer in LAYERS[name]]
    assert [Expression.compile(one).evaluate(lambda mark, /, **_: mark in marks) for one in chosen].count(True) == 1


def test_all_rows_that_fail_are_named() -> None:
    @for_each("number", range(5))
    @for_each(("word", "length"), [("a", 1), ("bb", 3)])
    def holds(number: int, word: str, length: int) -> None:
        assert number < 3
        assert len(word) == length

    with pytest.raises(RowsFailed, match=r"^7 failed") as told:
        holds()
    rows = [line.split(":")[0] for line in told.value.failed]
    assert rows == ["0, bb, 3", "1, bb, 3", "2, bb, 3", "3, a, 1", "3, bb, 3", "4, a, 1", "4, bb, 3"]


@pytest.mark.anyio
async def test_rows_of_a_check_that_waits_are_waited_for() -> None:
    @for_each("number", range(3))
    async def holds(number: int) -> None:
        assert number == 1

    with pytest.raises(RowsFailed, match=r"^2 failed, of 3 rows:"):
        await holds()


@for_each("chosen", [layer.chosen for layer in LAYERS["test-all"]])
def test_a_file_is_left_out_only_where_none_of_its_tests_is_chosen(chosen: str, tmp_path: Path) -> None:
    heads = ["", "pytestmark = pytest.mark.service\n"]
    marks = ["", "@pytest.mark.service\n", "@pytest.mark.sweep\n", '@pytest.mark.parametrize("database", DATABASES)\n']
    for number, (head, mark) in enumerate(product(heads, marks)):
        file = tmp_path / f"test_{number}.py"
        file.write_text(f"import pytest\n\n{head}\n{mark}def test_it() -> None:\n    pass\n", encoding="utf-8")
        has = {name for name in ("service", "sweep") if f"mark.{name}" in head + mark}
        each = [has, has | {"service"}] if "DATABASES" in mark else [has]
        runs = any(Expression.compile(chosen).evaluate(lambda name, /, has=one, **_: name in has) for one in each)
        assert not (runs and is_left_out(file, chosen)), file.read_text(encoding="utf-8")
