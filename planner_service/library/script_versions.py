"""Keeping a short script again under its id: what becomes of the one that is there, and which version it is then."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from planner_service.scripts.script import MAX_VERSIONS, ShortScript
from planner_service.store.library_store import AbsentError, ChangedError, FixedError, FullError

if TYPE_CHECKING:
    from planner_service.store.library_store import Renewal

Reader = Callable[[str], ShortScript]
Ours = Mapping[str, ShortScript]


@dataclass
class Added:
    """Ids of scripts that were put on the shelf, by what happened to them."""

    new: list[str] = field(default_factory=list)
    replaced: list[str] = field(default_factory=list)
    unchanged: list[str] = field(default_factory=list)
    """Those that were there already, word for word."""


def replacing(script: ShortScript, ours: Ours, read: Reader, added: Added) -> Renewal:
    """Keeps a script whether or not there is one of its id; `added` is told which. FixedError for a changed one of
    ours."""

    def renewal(body: str | None) -> str | None:
        if body is None:
            if ours.get(script.id) == script:
                added.unchanged.append(script.id)
                return None
            _refuse_ours(script.id, ours)
            added.new.append(script.id)
            return body_of(script)
        kept = read(body)
        if _same(kept, script):
            added.unchanged.append(script.id)
            return None
        added.replaced.append(script.id)
        return body_of(following(kept, script))

    return renewal


def changing(script: ShortScript, ours: Ours, read: Reader) -> Renewal:
    """Puts a script in the place of the version that it says it is.

    AbsentError, FixedError; ChangedError when there is another version by now, unless it says the same.
    """

    def renewal(body: str | None) -> str | None:
        if body is None:
            _refuse_ours(script.id, ours)
            raise AbsentError(f"there is no short script {script.id!r}")
        kept = read(body)
        if _same(kept, script):
            return None
        if kept.version != script.version:
            raise ChangedError(
                f"the short script {script.id!r} is at version {kept.version} by now, this is a change of version "
                f"{script.version}",
                f"read it again and send version {kept.version}",
                at="version",
            )
        return body_of(following(kept, script))

    return renewal


def following(kept: ShortScript, script: ShortScript) -> ShortScript:
    """The script as the version after the one that is kept."""
    if kept.version >= MAX_VERSIONS:
        raise FullError(f"the short script {kept.id!r} has had {MAX_VERSIONS} versions", "choose another id")
    return script.model_copy(update={"version": kept.version + 1})


def body_of(script: ShortScript) -> str:
    """A script as its row has it."""
    return script.model_dump_json(exclude_none=True)


def _same(kept: ShortScript, script: ShortScript) -> bool:
    return kept == script.model_copy(update={"version": kept.version})


def _refuse_ours(script_id: str, ours: Ours) -> None:
    if script_id in ours:
        raise FixedError(f"the short script {script_id!r} is ours and stays as it is", "choose another id", at="id")
