"""MuJoCo, imported when somebody asks for physics, and only in the versions that it was tried with."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from types import ModuleType
from typing import Final

from scene_graphs.errors import UserError

TESTED: Final = (3, 17)
"""The minor version whose states and figures are known; contacts and solvers change between minor versions."""
REMEDY: Final = "python -m pip install 'mujoco>={0}.{1},<{0}.{2}'".format(*TESTED, TESTED[1] + 1)


class EngineError(UserError):
    """There is no MuJoCo here, or one that was not tried."""


def require_version(version: str) -> None:
    """EngineError for a MuJoCo below or above the tested range."""
    parts = version.split(".")
    if [part for part in parts[:2] if part.isdecimal()] != [str(number) for number in TESTED]:
        raise EngineError(f"MuJoCo {version:.20} was not tried; {TESTED[0]}.{TESTED[1]} was", REMEDY, at="backend")


@contextmanager
def _without_windows() -> Iterator[None]:
    """MuJoCo is told not to look for something to draw with, which would start a process."""
    asked = os.environ.get("MUJOCO_GL")
    os.environ["MUJOCO_GL"] = asked if asked is not None else "disable"
    try:
        yield
    finally:
        if asked is None:
            del os.environ["MUJOCO_GL"]


@cache
def engine() -> ModuleType:
    """The module `mujoco`. EngineError where it is missing or of another version."""
    try:
        with _without_windows():
            import mujoco
    except ImportError as error:
        raise EngineError("MuJoCo is not installed", REMEDY, at="backend") from error
    require_version(mujoco.__version__)
    # What it warns of, states that are not finite, is looked for; it would write a file of its own into any folder.
    mujoco.set_mju_user_warning(lambda _text: None)
    module: ModuleType = mujoco
    return module
