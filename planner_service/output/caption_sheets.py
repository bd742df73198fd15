"""Captions acted in a room of the library and drawn as contact sheets: the vocabulary to look at."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby, islice
from typing import Final

from motion_backend.motion import Skill
from motion_backend.rendering.contact_sheet import sheet
from motion_backend.rendering.renderer import Image
from planner_service.evaluation.trials import FLOOR, Performance, Trial, perform, piece_of, places_for, setting
from planner_service.pipeline import RequestError
from planner_service.scripts.captions import captions
from scene_graphs.layout_library import built_in_index

ROWS: Final = 8
"""Captions on a page."""
TRIED: Final = 8
"""Rooms among which one is looked for where the body uses furniture."""


def caption_sheet(caption: str, skill: Skill | None, room: str | None, seed: int) -> Image:
    """One caption, a known one or, with its skill, any other. RequestError where no room has what it needs."""
    return _page([trial_of(_skill_of(caption) if skill is None else skill, caption, room, seed)])


def vocabulary_sheets(skills: Sequence[Skill], room: str | None, seed: int) -> Iterator[tuple[str, Image]]:
    """Pages of all known captions of these skills, each with a name for its file; one room a page."""
    known = captions()
    for skill in skills:
        trials = [trial_of(skill, caption, room, seed) for caption in known[skill.value]]
        for where, some in groupby(sorted(trials, key=lambda trial: trial.room), key=lambda trial: trial.room):
            of_room = list(some)
            for start in range(0, len(of_room), ROWS):
                yield f"{skill}-{where}-{start // ROWS + 1}.png", _page(of_room[start : start + ROWS])


def _page(trials: Sequence[Trial]) -> Image:
    done = [perform(trial) for trial in trials]
    return sheet([(_title(one), one.motion) for one in done], done[0].home, roles=[one.role for one in done])


def _title(done: Performance) -> str:
    error, trial = done.figures.contact_error, done.trial
    off = "" if error is None else f", {100 * error:.1f} cm off"
    return f"{trial.skill}: {trial.caption}  ({done.object_id}, {trial.room}, seed {trial.seed}{off})"


def trial_of(skill: Skill, caption: str, room: str | None, seed: int) -> Trial:
    """The trial in the room, or in one of the library that has what it needs: furniture rather than the floor."""
    rooms = [layout.id for layout in built_in_index().layouts]
    if room is not None and room not in rooms:
        raise RequestError(f"the library has no room {room!r:.80}", "sims layouts list names them", at="--room")
    serving = (one for one in ([room] if room else rooms) if places_for(skill, caption, setting(one)))
    on_floor: Trial | None = None
    for trial in islice((Trial(skill, caption, one, seed) for one in serving), TRIED):
        if skill is Skill.LOCO or piece_of(trial) != FLOOR:
            return trial
        on_floor = on_floor or trial
    if on_floor is None:
        where = room or "no room of the library"
        raise RequestError(
            f"{where} has nothing for “{caption:.80}” ({skill})", "leave it out or choose another", at="--room"
        )
    return on_floor


def _skill_of(caption: str) -> Skill:
    found = [Skill(skill) for skill, some in captions().items() if caption in some]
    if not found:
        raise RequestError(f"{caption!r:.120} is not a known one", "give --skill too", at="--caption")
    return found[0]
