"""Backends by name: ours, those of others, those that are not there and those that are broken."""

from __future__ import annotations

import contextlib
import io
import json
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import pytest
from guides import BLOCK, said_as
from stranger import GUIDE, install

from motion_backend import backends
from motion_backend.backends import BrokenBackendError, UnknownBackendError, about, backend_names, load_backend, movers
from motion_backend.director import Director
from motion_backend.motion import Action, Character, Emotion, Skill
from planner_service.settings import SettingsError, read_settings
from scene_graphs.generation.generate_room import generate_room
from scene_graphs.home import home_from_layouts


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder on the path with the stranger's package; what is registered is looked up anew, before and after."""
    monkeypatch.syspath_prepend(install(tmp_path / "site"))
    monkeypatch.delitem(sys.modules, "ghost", raising=False)
    _forget()
    yield tmp_path / "site"
    _forget()


def _forget() -> None:
    backends._registered.cache_clear()
    backends.check_backend.cache_clear()


def test_ours_are_there_and_say_what_they_are() -> None:
    assert backend_names()[0] == "procedural"
    for name in backends._OURS:
        assert name in about(name)
        assert ": " in about(name)
        assert movers({name: 1.0}, name) == [f"Moved by {about(name)}."]
    assert load_backend("procedural").name == "procedural"
    assert about("procedural") == "rules (procedural): no learned model, no simulation"
    assert about("ghost") == "ghost"


def test_who_stood_in_for_a_backend_is_named_with_its_share() -> None:
    asked, stood_in = movers({"ghost": 0.75, "procedural": 0.25}, "ghost")
    assert asked == "Moved by ghost."
    assert stood_in == f"25% of the time by {about('procedural')}."


def test_a_backend_of_others_is_there_where_its_package_is(installed: Path) -> None:  # noqa: ARG001
    assert backend_names() == ("procedural", "physics", "matching", "diffusion", "broken", "ghost")
    assert "ghost" not in sys.modules, "nothing is imported before it is asked for"
    assert load_backend("ghost").name == "ghost"
    assert read_settings(backend="ghost").backend == "ghost"


def test_nobody_takes_the_name_of_one_of_ours(installed: Path) -> None:
    points = next(installed.glob("*.dist-info")) / "entry_points.txt"
    points.write_text("[sims.backends]\nprocedural = ghost:Ghost\n")
    _forget()
    assert backend_names() == ("procedural", "physics", "matching", "diffusion")
    assert type(load_backend("procedural")).__name__ == "ProceduralBackend"


def test_an_unknown_name_is_refused_with_the_names_there_are(installed: Path) -> None:  # noqa: ARG001
    names = ", ".join(backend_names())
    with pytest.raises(UnknownBackendError, match=f"^backend: 'magic' is none of {names}$"):
        load_backend("magic")
    with pytest.raises(SettingsError, match=f"^SIMS_BACKEND: .*'magic' is none of {names}"):
        read_settings(backend="magic")


@pytest.mark.parametrize(
    ("where", "why"),
    [
        ("no_such_library:Backend", "ModuleNotFoundError: No module named 'no_such_library'"),
        ("ghost:Spirit", "AttributeError: .*Spirit"),
        ("ghost:Part", "TypeError"),
        ("builtins:dict", "it has no begin and no advance"),
    ],
)
def test_one_that_cannot_be_loaded_says_why(installed: Path, where: str, why: str) -> None:
    (next(installed.glob("*.dist-info")) / "entry_points.txt").write_text(f"[sims.backends]\nbroken = {where}\n")
    _forget()
    for _ in range(2):  # one that failed is tried again, not remembered
        with pytest.raises(BrokenBackendError, match=rf"^backend: 'broken' cannot be loaded .*{why}.*; mend or remove"):
            backends.check_backend("broken")


@pytest.mark.parametrize("name", ["procedural", "ghost"])
def test_any_backend_can_be_stopped_between_two_actions_and_repeats_itself(installed: Path, name: str) -> None:  # noqa: ARG001
    home = home_from_layouts([generate_room("study", 3)], 0)
    first, second = load_backend(name), load_backend(name)
    state = first.begin(home, Character(height=1.6), 7)
    assert state == second.begin(home, Character(height=1.6), 7)
    assert json.loads(json.dumps(asdict(state))) == json.loads(json.dumps(asdict(state)))
    action = Action(
        Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(state.pelvis[0], state.pelvis[2]), facing=1.0, keyframe=4
    )
    motion, after = Director(first).act(home, action, state)
    again, same = Director(second).act(home, action, state)
    assert after == same
    assert (motion.root_positions == again.root_positions).all()
    assert set(motion.actions.tolist()) == {4}
    assert motion.skeleton.names == again.skeleton.names


def test_the_guide_to_backends_is_true(
    installed: Path,  # noqa: ARG001
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    printed, met = "", []
    for kind, name, block in BLOCK.findall(GUIDE.read_text(encoding="utf-8")):
        met.append((kind, name))
        if (kind, name) == ("python", ""):
            with contextlib.redirect_stdout(io.StringIO()) as stream:
                exec(compile(block, GUIDE.name, "exec"), names)
            printed = stream.getvalue()
        elif kind == "text":
            said_as(block.splitlines(), printed)
    assert met == [("python", "ghost.py"), ("toml", "pyproject.toml"), ("python", ""), ("text", "")]
    _, reached, _, keyframes = printed.split()
    assert reached == keyframes != "0", printed
