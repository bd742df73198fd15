"""Who rests where: what is done on the seat or bed that a body is on already, and what it would have to get up for."""

from __future__ import annotations

import re

from motion_backend.motion import RISINGS, Skill
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.deed_reader import HARDLY, HARDLY_HERE, DeedReader, seated_as_well
from planner_service.scripts.script import PlannedKeyframe
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import ReadBeat
from scene_graphs import furniture


def lies(resting: PlannedKeyframe | None) -> bool:
    """Whether a body lies, and does not sit or stand."""
    return resting is not None and resting.skill is Skill.LIEDOWN


def is_there(resting: PlannedKeyframe, deed: Deed, skill: Skill) -> bool:
    """Whether a deed may be done on what a body rests on: sitting or lying, as `skill` says."""
    kinds = furniture.categories_of(resting.furniture)
    same = resting.furniture in deed.pieces or any(
        not kinds.isdisjoint(furniture.categories_of(piece)) for piece in deed.pieces if piece != "floor"
    )
    return (same or not deed.named) and affords(resting.furniture, NEEDS[skill])


def is_done_there(resting: PlannedKeyframe, deed: Deed) -> bool:
    """Whether captions of a deed show it where a body rests: it does not have to get up for it."""
    own = {Skill.SITDOWN: deed.row.seated, Skill.LIEDOWN: deed.row.lying, deed.skill: deed.row.captions}
    return bool(own.get(resting.skill)) and is_there(resting, deed, resting.skill)


def only_stands_for(resting: PlannedKeyframe, read: ReadBeat, deed: Deed, reader: DeedReader) -> bool:
    """Whether what would be done is hardly taken for what is told; where it is done at a certain thing, that is gone to
    all the same."""
    known = deed.named or deed.row.rests or deed.skill in RISINGS
    least = HARDLY_HERE if is_done_there(resting, deed) else HARDLY
    return not known and reader.hardly_shows(read.clause, deed, read.beat.emotion, least)


def dozing(resting: PlannedKeyframe | None, read: ReadBeat, reader: DeedReader) -> tuple[str, ...]:
    """Ways of sitting on what cannot be lain on that show what is else done lying: "nods off"."""
    likely = reader.likely(read.clause)
    if resting is None or likely is None or resting.skill is not Skill.SITDOWN or affords(resting.furniture, "lie"):
        return ()
    return seated_as_well(likely)


def sits_up(read: ReadBeat, deed: Deed) -> bool:
    """Whether who lies sits there now: "sits up in bed"."""
    return deed.skill is Skill.SITDOWN and read.clause.verb == "sit" and bool(re.search(r"\bup\b", read.text))


def is_beside(read: ReadBeat) -> bool:
    """Whether it is done while something else is: "sits in the dark, | listening"."""
    return read.clause.joint in ("ing", ",", "while") and read.clause.text.split()[0].endswith("ing")
