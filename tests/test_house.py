"""The house rules that a machine can hold: which package may import which, and where third-party libraries live."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {
    "prompts": set(),
    "scene_graphs": set(),
    "motion_backend": {"scene_graphs"},
    "planner_service": {"prompts", "scene_graphs", "motion_backend"},
}
HOMES = {
    "torch": {"motion_backend/language"},
    "safetensors": {"motion_backend/language"},
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
    "av": {"planner_service/extraction"},
    "faster_whisper": {"planner_service/extraction"},
}
"""Where a third-party library may be imported; libraries not named here may be used anywhere they are needed."""
FORBIDDEN = {"pickle", "shelve", "marshal"}


def modules() -> list[Path]:
    return [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]


@cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            yield node.module


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(ROOT)))
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


def test_there_is_no_drawer_for_odds_and_ends() -> None:
    for path in modules():
        assert path.stem not in {"common", "utils", "util", "helpers", "types", "misc"}, path


def test_importing_the_planner_loads_nothing_heavy() -> None:
    """Neither command line nor service."""
    modules = (
        "planner_service.cli, planner_service.api.app, planner_service.pipeline, motion_backend.procedural.backend"
    )
    heavy = ["torch", "matplotlib", "trimesh", "openai", "anthropic", "pydantic_ai", "av"]
    code = f"import sys, {modules}; print([name for name in {heavy!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_nothing_of_ours_is_pickled_or_evaluated() -> None:
    for path in modules():
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in {"eval", "exec"}, path
            if isinstance(node, ast.keyword) and node.arg == "allow_pickle":
                assert ast.unparse(node.value) == "False", path
