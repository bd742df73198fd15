"""The motion backends there are, by name: ours, and those that other packages register.

A package registers one by an entry point of the group `sims.backends`: its name, and what makes it (a class, or a
function without arguments). Nothing of a backend is imported before it is asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Final

from motion_backend.backend_protocol import MotionBackend
from scene_graphs.errors import UserError

GROUP: Final = "sims.backends"
DEFAULT_BACKEND: Final = "procedural"
MATCHING: Final = "matching"
DIFFUSION: Final = "diffusion"
_OURS: Final = {
    "procedural": "motion_backend.procedural.backend:ProceduralBackend",
    "physics": "motion_backend.physics.backend:PhysicsBackend",
    MATCHING: "motion_backend.matching.backend:of_given_clips",
    DIFFUSION: "motion_backend.diffusion.backend:DiffusionBackend",
}
"""Our backends: name, and where what makes it is defined."""
_ABOUT: Final = {
    "procedural": ("rules", "no learned model, no simulation"),
    MATCHING: ("motion matching", "recorded walks of your clips, nothing else; no learned model, no simulation"),
    DIFFUSION: ("a diffusion model", "walks learned from recorded people, all else from our own body; no simulation"),
    "physics": ("physics", "simulated by MuJoCo, tracked by model-predictive control, no root force"),
}
"""Who moves the body, in plain words, and what a reader of figures must know of that."""
_given: dict[str, Path] = {}


class UnknownBackendError(UserError):
    """There is no backend of that name; says which there are."""


class BrokenBackendError(UserError):
    """There is a backend of that name, but it cannot be loaded here; says why."""


def give_file(name: str, file: Path | None) -> None:
    """Name the file that a backend of ours works by, in this process; None leaves it as it is."""
    if file is not None and _given.get(name) != file:
        _given[name] = file
        check_backend.cache_clear()


def given_file(name: str) -> Path | None:
    """The file that a backend of ours is to work by; None where nobody named one."""
    return _given.get(name)


def backend_names() -> tuple[str, ...]:
    """The names of all backends: ours, then those of other packages in alphabetical order."""
    return tuple(_registered())


def offered_backends() -> tuple[str, ...]:
    """Those that can be asked for here: not one of ours that works by a file which nobody named."""
    return tuple(name for name in backend_names() if name != MATCHING or given_file(name))


def about(name: str) -> str:
    """Who moves the body: "rules (procedural): no learned model, no simulation"; of others' backends only the name."""
    if name not in _ABOUT:
        return name
    who, what = _ABOUT[name]
    return f"{who} ({name}): {what}" if who != name else f"{name}: {what}"


def movers(made_by: Mapping[str, float], asked: str) -> list[str]:
    """Who moved a story's body, in sentences: the backend that was asked for, and for how much of the time (shares by
    backend) another stood in for it."""
    others = (f"{share:.0%} of the time by {about(name)}." for name, share in made_by.items() if name != asked)
    return [f"Moved by {about(asked)}.", *others]


def require_backend(name: str) -> None:
    """UnknownBackendError where there is no backend of that name; none is loaded."""
    # Ours first: to look through all packages that are installed takes longer than all else of a request.
    if name not in _OURS and name not in _registered():
        raise UnknownBackendError(f"{name!r:.60} is none of {', '.join(backend_names())}", at="backend")


def load_backend(name: str) -> MotionBackend:
    """A new backend of that name. UnknownBackendError, BrokenBackendError."""
    require_backend(name)
    entry = _registered()[name]
    try:
        made = entry.load()()
    except UserError as error:
        raise BrokenBackendError(f"{name!r} cannot be used: {error.fault}", error.remedy, at="backend") from error
    except Exception as error:  # whatever somebody else's code may raise
        raise _broken(entry, f"{type(error).__name__}: {error}") from error
    if lacking := [part for part in ("begin", "advance") if not callable(getattr(made, part, None))]:
        raise _broken(entry, f"it has no {' and no '.join(lacking)}")
    backend: MotionBackend = made
    return backend


@cache
def check_backend(name: str) -> None:
    """Load a backend and throw it away, so that what is wrong with it is known before it is needed.

    Done once a process, and again only where it failed. UnknownBackendError, BrokenBackendError.
    """
    load_backend(name)


@cache
def _registered() -> dict[str, EntryPoint]:
    """Every backend by name. Nobody takes the name of one of ours; of two others the first that is found has it."""
    found = {name: EntryPoint(name, where, GROUP) for name, where in _OURS.items()}
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        found.setdefault(entry.name, entry)
    return found


def _broken(entry: EntryPoint, why: str) -> BrokenBackendError:
    return BrokenBackendError(
        f"{entry.name!r} cannot be loaded from {entry.value} ({why:.200})",
        "mend or remove what registers it",
        at="backend",
    )
