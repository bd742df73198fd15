"""The Blender add-on against a real service: its half that asks, and, where bpy is installed, Blender itself.

`SIMS_TEST_BPY` names a Python that has bpy (`pip install bpy`), if it is not this one.
"""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import threading
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from running import SHORT, RunningService, finished

pytestmark = pytest.mark.service
HERE = Path(__file__).resolve()
ADD_ON = HERE.parents[2] / "blender" / "sims_stories.py"
BLENDER = os.environ.get("SIMS_TEST_BPY") or (sys.executable if find_spec("bpy") else "")
MESHES = {"body", "face", "floor", "wall", "ceiling", "furniture"}
"""Of every film; what else a home has is in `formats/glb_film.py`."""
LOOKS = 5
"""Frames whose bones are compared."""


@pytest.fixture
def add_on(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module without Blender: classes that stand for its own."""
    kinds = ("AddonPreferences", "PropertyGroup", "Operator", "Panel", "Context", "Event", "Object")
    props = {f"{kind}Property": dict for kind in ("String", "Int", "Bool")}
    bpy = ModuleType("bpy")
    bpy.__dict__.update(types=SimpleNamespace(**{kind: type(kind, (), {}) for kind in kinds}))
    bpy.__dict__.update(props=SimpleNamespace(**props))
    monkeypatch.setitem(sys.modules, "bpy", bpy)
    spec = spec_from_file_location("sims_stories", ADD_ON)
    assert spec
    assert spec.loader
    module = module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "sims_stories", module)
    spec.loader.exec_module(module)
    return module


def test_what_is_fetched_is_the_story_s_film(add_on: Any, service: RunningService, tmp_path: Path) -> None:
    making = add_on.Making(add_on.Service(service.url + "/"), SHORT, 3, tmp_path)
    making.run()
    assert making.error == ""
    assert making.share == 1.0
    assert making.story["motion"]["frames"] == making.story["keyframes"][-1]["end"]
    with service.client() as client:
        assert making.path.read_bytes() == client.get(f"/v1/stories/{making.story['id']}/film.glb").content


def test_what_is_stopped_is_cancelled(add_on: Any, service: RunningService, tmp_path: Path) -> None:
    making = add_on.Making(add_on.Service(service.url), SHORT * 9, 3, tmp_path)
    threading.Timer(0.0, making.stop).start()
    making.run()
    assert (making.error, making.path.exists()) == ("stopped", False)
    with service.client() as client:
        assert finished(client, making.story["id"])["state"] == "cancelled"


def test_what_is_wrong_is_said_with_what_helps(add_on: Any, service: RunningService, tmp_path: Path) -> None:
    def error(url: str, theme: str = SHORT) -> str:
        making = add_on.Making(add_on.Service(url), theme, 0, tmp_path)
        making.run()
        return str(making.error)

    assert error(service.url, "").startswith("422: theme: ")
    assert "sims serve" in error("http://127.0.0.1:9")
    assert "http://" in error("127.0.0.1:8000")
    assert "no SIMS service" in error(f"{service.url}/docs") or "404" in error(f"{service.url}/docs")


def blender(service_url: str, theme: str, folder: Path, frames: list[int]) -> Any:
    if not BLENDER:
        pytest.skip("bpy is not installed: pip install bpy, or SIMS_TEST_BPY names a Python that has it")
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(folder)}
    words = [BLENDER, str(HERE.with_name("blender_import.py")), str(ADD_ON), service_url, theme, *map(str, frames)]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout.splitlines()[-1])


def test_blender_has_the_body_the_home_and_their_action(service: RunningService, tmp_path: Path) -> None:
    with service.client() as client:
        asked = client.post("/v1/stories", json={"theme": SHORT, "seed": 3}).json()
        story = finished(client, asked["id"])
        motion = np.load(io.BytesIO(client.get(f"/v1/stories/{asked['id']}/motion?format=npz").content))
    count = story["motion"]["frames"]
    frames = np.linspace(0, count - 1, LOOKS).astype(int).tolist()
    found = blender(service.url, SHORT, tmp_path, frames)
    assert found["error"] == ""
    assert len(found["armatures"]) == 1
    assert (found["fps"], found["frames"], found["keys"]) == (30, [0, count - 1], [0, count - 1])
    # Of an object and the mesh in it that would have one name, Blender numbers the second.
    assert {name.partition(".")[0] for name in found["meshes"]} >= MESHES
    assert (found["collections"], found["hidden"]) == ([story["title"]], ["ceiling"])
    assert found["markers"] == [[one["caption"], one["start"]] for one in story["keyframes"]]
    # Blender has Z up and its front where ours has +Z.
    hips = np.array([found["heads"][str(frame)]["pelvis"] for frame in frames])
    assert np.abs(hips - motion["root_positions"][frames] @ [[1, 0, 0], [0, 0, 1], [0, -1, 0]]).max() < 1e-3
    hands = np.array([found["heads"][str(frame)]["right_wrist"] for frame in frames])
    assert np.ptp(np.linalg.norm(hands - hips, axis=1)) > 0.01
    assert found["left"] is False


def test_blender_says_what_the_service_refuses(service: RunningService, tmp_path: Path) -> None:
    found = blender(service.url, "", tmp_path, [0])
    assert "theme: " in found["error"]
    assert found["armatures"] == []
