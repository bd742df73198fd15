"""The house rules that a machine can hold: which package may import which, and where third-party libraries live."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import networkx
import pytest
from for_each import for_each

from planner_service.cli.late_commands import COMMANDS

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {
    "prompts": set(),
    "scene_graphs": set(),
    "motion_backend": {"scene_graphs"},
    "planner_service": {"prompts", "scene_graphs", "motion_backend"},
}
HOMES = {
    "torch": {f"motion_backend/{room}" for room in ("embedding", "physics", "diffusion")}
    | {"planner_service/composition"},
    "safetensors": {f"motion_backend/{room}" for room in ("language", "embedding", "physics", "diffusion")}
    | {"planner_service/composition"},
    "mujoco": {"motion_backend/physics"},
    "networkx": {"scene_graphs"},
    "numba": {"scene_graphs"},
    "shapely": {"scene_graphs"},
    "trimesh": {"scene_graphs"},
    "typer": {"planner_service"},
    "rich": {"planner_service"},
    "pydantic_settings": {"planner_service"},
    "platformdirs": {"planner_service"},
    "fastapi": {"planner_service"},
    "starlette": {"planner_service"},
    "uvicorn": {"planner_service"},
    "sqlalchemy": {"planner_service"},
    "dbos": {"planner_service"},
    "httpx": {"planner_service"},
    "structlog": {"planner_service"},
    "prometheus_client": {"planner_service"},
    "limits": {"planner_service"},
    "pydantic_ai": {"planner_service/llm"},
    "openai": {"planner_service/llm"},
    "anthropic": {"planner_service/llm"},
    "httpx2": {"planner_service/llm"},
    "av": {"planner_service/extraction", "motion_backend/formats"},
    "pxr": {"motion_backend/formats"},
    "faster_whisper": {"planner_service/extraction"},
    "mcp": {"planner_service"},
}
"""Where a third-party library may be imported; libraries not named here may be used anywhere they are needed."""
FORBIDDEN = {"pickle", "shelve", "marshal"}


def modules() -> list[Path]:
    return [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]


@cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """What `ast.walk` finds, sooner."""
    found: list[ast.AST] = [tree_of(path)]
    for node in found:
        for value in vars(node).values():
            if isinstance(value, ast.AST):
                found.append(value)
            elif isinstance(value, list):
                found += [one for one in value if isinstance(one, ast.AST)]
    return tuple(found)


@cache
def imported(path: Path) -> tuple[str, ...]:
    return tuple(imports_of_tree(nodes_of(path)))


def imports_of_tree(nodes: Iterable[ast.AST]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            yield node.module


@for_each("path", modules())
def test_imports_point_one_way(path: Path) -> None:
    package = path.relative_to(ROOT).parts[0]
    ours = {name.split(".")[0] for name in imported(path)} & set(PACKAGES)
    assert ours <= PACKAGES[package] | {package}


def test_each_third_party_library_lives_where_it_belongs() -> None:
    for path in modules():
        place = path.relative_to(ROOT).as_posix()
        for name in imported(path):
            top = name.split(".")[0]
            assert top not in FORBIDDEN, f"{place} imports {top}"
            homes = HOMES.get(top)
            assert homes is None or any(place.startswith(home + "/") for home in homes), f"{place} imports {top}"


def test_every_module_says_what_it_is() -> None:
    for path in modules():
        assert ast.get_docstring(tree_of(path)), f"{path} has no docstring"


def test_nothing_imports_the_command_line() -> None:
    """It is one of several doors to what is behind it: HTTP, workers and Python are others."""
    for path in modules():
        place = path.relative_to(ROOT).as_posix()
        if not place.startswith("planner_service/cli/"):
            assert not [name for name in imported(path) if f"{name}.".startswith("planner_service.cli.")], place


def test_imports_go_round_in_no_circle() -> None:
    """Neither at the top of modules nor in functions nor for types only: an order can be named in which to read."""
    assert circles({name_of(path): imports_of(path) for path in modules()}) == []


def test_circles_are_found_wherever_they_are() -> None:
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"d"}, "d": {"b"}, "e": {"a"}}) == [["b", "c", "d"]]
    assert circles({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == []
    late = ast.parse(
        "def f():\n    from motion_backend.motion import Skill\nfrom motion_backend import motion, skeleton"
    )
    assert imports_in(ast.walk(late), "planner_service.x") == {
        "motion_backend", "motion_backend.motion", "motion_backend.skeleton"
    }  # fmt: skip
    beside = ast.parse("from motion_backend.motion import Skill")
    assert imports_in(ast.walk(beside), "motion_backend.walls") == {"motion_backend.motion"}


def name_of(path: Path) -> str:
    """Its dotted name; a package's own for its `__init__`."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


@cache
def names() -> frozenset[str]:
    return frozenset(map(name_of, modules()))


def imports_of(path: Path) -> set[str]:
    return imports_in(nodes_of(path), name_of(path))


def imports_in(nodes: Iterable[ast.AST], name: str) -> set[str]:
    """Our modules that a module needs, with the packages that are imported on the way to them.

    The packages that it is itself in are there already when it is imported: they count where they are named.
    """
    found: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            targets = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            within = [f"{node.module}.{alias.name}" for alias in node.names]
            targets = [target if target in names() else node.module for target in within]
        else:
            continue
        for target in targets:
            on_the_way = {target.rsplit(".", up)[0] for up in range(1, target.count(".") + 1)}
            found |= {target} | {package for package in on_the_way if not f"{name}.".startswith(f"{package}.")}
    return (found & names()) - {name}


def circles(imports: dict[str, set[str]]) -> list[list[str]]:
    """Modules that need each other, circle by circle."""
    graph = networkx.DiGraph([(module, needed) for module, all_needed in imports.items() for needed in all_needed])
    found = networkx.strongly_connected_components(graph)
    return sorted(sorted(together) for together in found if len(together) > 1)


def test_there_is_no_drawer_for_odds_and_ends() -> None:
    for path in modules():
        assert path.stem not in {"common", "utils", "util", "helpers", "types", "misc"}, path


@pytest.mark.service
def test_the_help_of_the_command_line_imports_no_command() -> None:
    code = (
        "import sys, contextlib, planner_service.cli as cli\nwith contextlib.suppress(SystemExit): cli.app(['--help'])"
        "\nprint([name for name in ('numpy', 'pydantic', 'planner_service.pipeline') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
    _, _, listed = done.stdout.partition("Commands:")
    assert all(f"  {name} " in listed for name in COMMANDS)
    assert "..." not in listed, "what each does is a line, none of which is cut"


@pytest.mark.service
def test_importing_the_planner_loads_nothing_heavy() -> None:
    """Neither command line nor service."""
    modules = (
        "planner_service.cli, planner_service.api.app, planner_service.pipeline, motion_backend.procedural.backend"
    )
    heavy = ["torch", "mujoco", "matplotlib", "trimesh", "openai", "anthropic", "pydantic_ai", "av"]
    code = f"import sys, {modules}; print([name for name in {heavy!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_no_error_is_taken_apart_by_its_text() -> None:
    """Errors carry facts (`scene_graphs/errors.py`): whoever needs the place or the remedy asks for it."""
    apart = {"split", "rsplit", "partition", "rpartition", "removeprefix", "removesuffix", "startswith", "match"}
    for path in modules():
        for node in nodes_of(path):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in apart:
                taken = [node.func.value, *node.args]
                assert not {"str(error)", "str(fault)", "explain(error)"} & set(map(ast.unparse, taken)), path


def test_nothing_of_ours_is_pickled_or_evaluated() -> None:
    for path in modules():
        for node in nodes_of(path):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in {"eval", "exec"}, path
            if isinstance(node, ast.keyword) and node.arg == "allow_pickle":
                assert ast.unparse(node.value) == "False", path


MAX_NUMBERS = 40
"""A thousand lines of `procedural/` may have so many numbers inside functions."""
MAX_NUMBERS_OF_A_FUNCTION = 8
"""A function with more is a table in disguise."""


def test_numbers_of_the_body_have_names() -> None:
    """Key poses are rows of tables (decision 0030), and other numbers constants that say what they are."""
    paths = sorted((ROOT / "motion_backend" / "procedural").rglob("*.py"))
    lines = sum(path.read_text(encoding="utf-8").count("\n") for path in paths)
    found = {f"{path.name}: {name}": count for path in paths for name, count in numbers_in(tree_of(path)).items()}
    assert not [f"{where} {count}" for where, count in found.items() if count > MAX_NUMBERS_OF_A_FUNCTION]
    assert 1000 * sum(found.values()) / lines <= MAX_NUMBERS, found


def test_numbers_are_counted_where_functions_hide_them() -> None:
    code = "WIDE = 0.4\ndef f(x, y=0.3):\n    g = lambda u: 0.7 * u\n    return [x * 0.25 + 0.5, g(2.0)] + [1.5]\n"
    assert numbers_in(ast.parse(code)) == {"f": 3}


def numbers_in(tree: ast.Module) -> dict[str, int]:
    """How many numbers with a point stand in the body of each function, but for 0, ½, 1 and 2; in the outermost of
    those that stand in each other."""
    found: dict[str, int] = {}
    seen: set[ast.Constant] = set()
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.Lambda)):
        body = function.body if isinstance(function.body, list) else [function.body]
        for node in (inner for part in body for inner in ast.walk(part) if isinstance(inner, ast.Constant)):
            if isinstance(node.value, float) and node.value not in (0.0, 0.5, 1.0, 2.0) and node not in seen:
                seen.add(node)
                name = getattr(function, "name", "lambda")
                found[name] = found.get(name, 0) + 1
    return found
