"""What each package offers by name: pinned, lazy, and the very things that its rooms define."""

from __future__ import annotations

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FACES = {
    "planner_service": """Keyframe LongScript Pipeline Planned ScriptLibrary Shelves ShortScript Story StoryRequest
        write_story""",
    "motion_backend": """Action BodyState Character ContactGoal Director Motion MotionBackend Part PartKind Posture
        Skeleton Skill backend_names build_skeleton join load_backend read_clips read_npz write_motion""",
    "scene_graphs": """Furniture FurnitureGraph Home Layout LayoutIndex Placed UserError built_in_index
        built_in_layouts generate_room graph_from_layout home_from_layouts read_layouts read_scene write_layouts""",
}


@pytest.mark.parametrize("package", FACES)
def test_these_names_are_public_and_sorted(package: str) -> None:
    assert importlib.import_module(package).__all__ == FACES[package].split()
    assert sorted(FACES[package].split()) == FACES[package].split()


@pytest.mark.parametrize("package", FACES)
def test_a_public_name_is_what_its_room_defines(package: str) -> None:
    face = importlib.import_module(package)
    assert list(face._ROOMS) == face.__all__
    for name, room in face._ROOMS.items():
        defined = importlib.import_module(f"{package}.{room}")
        assert getattr(face, name) is getattr(defined, name)
        assert name in dir(face)
        if isinstance(getattr(face, name), type) and name != "FurnitureGraph":
            assert getattr(face, name).__module__ == defined.__name__, f"{name} is defined elsewhere"


@pytest.mark.parametrize("package", FACES)
def test_type_checkers_are_told_the_same(package: str) -> None:
    tree = ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    told = {alias.name: node.module for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    rooms = importlib.import_module(package)._ROOMS
    assert told == {name: f"{package}.{room}" for name, room in rooms.items()}


def test_a_name_that_is_not_there_is_missing_as_anywhere() -> None:
    for package in FACES:
        with pytest.raises(AttributeError, match=f"module {package!r} has no attribute 'nothing'"):
            importlib.import_module(package).nothing  # noqa: B018


@pytest.mark.service
def test_a_package_alone_loads_nothing() -> None:
    """Neither our own rooms nor anybody's library."""
    for package in FACES:
        code = (
            f"import sys; before = set(sys.modules); import {package}; "
            "print(*sorted({name.split('.')[0] for name in set(sys.modules) - before} - set(sys.stdlib_module_names)),"
            f" *(name for name in sys.modules if name.startswith('{package}.')))"
        )
        done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
        assert done.stdout.split() == [package]
