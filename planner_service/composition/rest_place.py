"""Who rests where: what is done on the seat or bed that a body is on already, or will be, and what on its feet."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Final

from motion_backend.motion import RISINGS, Skill
from planner_service.composition.caption_senses import shows
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.deed_places import DeedPlaces
from planner_service.composition.deed_reader import HARDLY, HARDLY_HERE, DeedReader, seated_as_well
from planner_service.composition.deed_table import DeedRow, deed_table
from planner_service.composition.furniture_words import where
from planner_service.scripts.script import PlannedKeyframe
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import ReadBeat
from planner_service.themes.clause import Clause
from planner_service.themes.opening_words import opening_of
from scene_graphs import furniture

AHEAD: Final = 3
"""Beats in which the seat that is named next is looked for."""
BY_A_WALL: Final = re.compile(r"\b(?:by|at|near|against) (?:the|a|an) (?:\w+ )?(?:window|door|wall)\b")
"""Where nothing is kept that could be taken."""
GETS_THERE: Final = re.compile(
    r"\b(?:down|into|onto|back|under|climbs?|crawls?|falls?|flops?|goes|go|went|gets?|got|drops?|collapses?|curls?)\b"
)
"""Words that tell of lying down, not of lying there."""
_ON_FEET: Final = re.compile(r"\b(?:standing|on (?:his|her|their|my) feet)\b")
_GOES: Final = ("leave", "exit", "go", "walk", "run", "rush", "hurry")
"""Verbs of who gets up to do it."""
_DOWN: Final = ("kneel", "bend", "crouch", "stoop", "squat", "get")
_SLEEPS: Final = ("sleep", "snore", "doze", "nap", "nod", "snooze", "slumber", "drowse")
_ASLEEP: Final = frozenset(("asleep", "sleep"))
_ON_ARMS: Final = "head on folded arms on the table"
_IN_SEAT: Final = "asleep in the seat, head sunk to the chest"
_TAKEN: Final = DeedRow(
    ("eat",), Skill.TOUCH, captions=("pick up with the right hand", "pick up with the left hand"), things=True
)
"""What is eaten or drunk on one's feet is taken from where it is."""
_STANDING: Final = DeedRow(("stand",), Skill.LOCO, captions=("stand still",))


def lies(resting: PlannedKeyframe | None) -> bool:
    """Whether a body lies, and does not sit or stand."""
    return resting is not None and resting.skill is Skill.LIEDOWN


def sits(resting: PlannedKeyframe | None) -> bool:
    """Whether a body sits."""
    return resting is not None and resting.skill is Skill.SITDOWN


def is_on(resting: PlannedKeyframe | None, deed: Deed) -> bool:
    """Whether a body rests on what a deed names: who lies on the bed hugs its pillow there."""
    return resting is not None and resting.furniture in deed.pieces


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
    known = deed.named or deed.row.rests or deed.skill in RISINGS or is_sure(read, deed)
    least = HARDLY_HERE if is_done_there(resting, deed) else HARDLY
    return not known and reader.hardly_shows(read.clause, deed, read.beat.emotion, least)


def is_sure(read: ReadBeat, deed: Deed) -> bool:
    """Whether it is done however unlikely it looks: to get up for a thing that is kept somewhere, to go, to sleep."""
    fetches = deed.skill is Skill.TOUCH and deed.row.things and bool(deed.row.captions) and not deed.row.stands
    goes = deed.skill is Skill.LOCO and read.clause.verb in _GOES
    opens = deed.skill is Skill.TOUCH and opening_of(deed.skill, read.text) is not None
    return fetches or goes or opens or (deed.skill in (Skill.SITDOWN, Skill.LIEDOWN) and read.clause.verb in _SLEEPS)


def is_done_standing(read: ReadBeat) -> bool:
    """Whether who sits gets up for what may be done sitting too: "eats standing", "stares out of the window"."""
    return "stand" in read.clause.lemmas or opening_of(Skill.LOCO, read.text) == "window"


def eats(deed: Deed) -> bool:
    """Whether it is eating or drinking, for which who lies sits up."""
    return deed.is_gesture and any("drinking" in one or "eating" in one for one in deed.row.seated)


def dozing(resting: PlannedKeyframe | None, read: ReadBeat, reader: DeedReader) -> tuple[str, ...]:
    """Ways of sitting on what cannot be lain on that show what is else done lying: "nods off"."""
    if resting is None or resting.skill is not Skill.SITDOWN or affords(resting.furniture, "lie"):
        return ()
    if sleeps(read.clause):
        at_table = any(seats[0] == resting.furniture for seats in deed_table().seats_at.values())
        own = resting.caption in (_ON_ARMS, _IN_SEAT)  # who has their head on the desk falls asleep there
        return (resting.caption if own else _ON_ARMS if at_table else _IN_SEAT,)
    if shows(Skill.SITDOWN, resting.caption, read.clause):
        return (resting.caption,)
    likely = reader.likely(read.clause)
    return seated_as_well(likely) if likely is not None else ()


def sleeps(clause: Clause) -> bool:
    """Whether somebody falls asleep, or sleeps."""
    falls = clause.verb in ("fall", "drift", "drop", "be", "stay", "go") and not _ASLEEP.isdisjoint(clause.lemmas[1:3])
    return not clause.unable and (falls or clause.verb in _SLEEPS)


def sits_up(read: ReadBeat, deed: Deed) -> bool:
    """Whether who lies sits there now: "sits up in bed"."""
    return deed.skill is Skill.SITDOWN and read.clause.verb == "sit" and bool(re.search(r"\bup(?:right)?\b", read.text))


def is_beside(read: ReadBeat) -> bool:
    """Whether it is done while something else is: "sits in the dark, | listening"."""
    return read.clause.joint in ("ing", ",", "while") and read.clause.text.split()[0].endswith("ing")


def on_seat_ahead(
    deed: Deed, read: ReadBeat, nexts: Sequence[ReadBeat], reader: DeedReader, places: DeedPlaces
) -> Deed:
    """Who sits for it does so where the theme has them sit next: nobody changes seats for what is told before."""
    if deed.named or deed.skill not in (Skill.SITDOWN, Skill.LIEDOWN):
        return deed
    told = [
        (one, reader.deed(one.clause)) for one in nexts[:AHEAD] if read.room is None or one.room in (None, read.room)
    ]
    for one, then in told:
        if then is None or not then.named or then.skill is not Skill.SITDOWN or not places.has(then.pieces[0]):
            continue
        if one is nexts[0] and is_beside(one):  # "collapses | giggling on the rug"
            sits = deed.skill is Skill.SITDOWN and bool(deed.row.captions)  # "eats | sitting on the floor"
            return replace(deed, pieces=then.pieces, named=True) if sits else then
        if deed.skill is Skill.SITDOWN and affords(then.pieces[0], "sit") and then.pieces[0] != "floor":
            return replace(deed, pieces=then.pieces, named=True)
    return deed


def on_place_ahead(deed: Deed, read: ReadBeat, nexts: Sequence[ReadBeat], reader: DeedReader) -> Deed:
    """Who gets down to do something does so where that is done: "kneels | to look under the sofa", "to pray by the
    bed"."""
    if deed.named or read.clause.verb not in _DOWN or not (deed.skill is Skill.TOUCH or deed.is_gesture):
        return deed
    purpose = next((one for one in nexts[:1] if one.clause.joint == "to"), None)
    then = reader.deed(purpose.clause) if purpose is not None else None
    there = then is not None and (then.skill is Skill.TOUCH or (then.named and then.is_gesture))
    return replace(deed, pieces=then.pieces, named=True) if then is not None and there else deed


def rises_later(nexts: Sequence[ReadBeat], reader: DeedReader) -> bool:
    """Whether somebody gets or sits up next, or is told to lie there: who wakes before that stays in bed."""
    deeds = ((one, reader.deed(one.clause)) for one in nexts if one.beat.kind == "deed")
    later, deed = next(((one, deed) for one, deed in deeds if deed is not None), (None, None))
    if later is None or deed is None:
        return False
    stays = deed.skill is Skill.LIEDOWN and not (GETS_THERE.search(later.text) or "asleep" in later.text)
    return deed.skill in RISINGS or sits_up(later, deed) or (stays and later is nexts[0])


def on_feet(
    read: ReadBeat, deed: Deed, resting: PlannedKeyframe | None, last: Clause | None, avoided: Collection[Skill]
) -> Deed:
    """What is done at rest, where it is done standing: as is said, or as one is while nothing is said; not
    what is avoided. `last` is of what was written last."""
    at = tuple(piece for piece in where(read.text) if affords(piece, "touch"))
    at = () if BY_A_WALL.search(read.text) else at
    stands = bool(_ON_FEET.search(read.text))
    stood = resting is None and last is not None and last.sentence == read.clause.sentence
    if deed.row.rests and stands and at:
        return Deed(_TAKEN, Skill.TOUCH, at, True)
    if deed.row.rests and (stands or deed.skill in avoided):
        return Deed(_STANDING, Skill.LOCO, deed.pieces if deed.named else (), deed.named)
    if deed.skill in avoided and (ways := standing_as_well(deed)):
        return Deed(
            replace(deed.row, skill=Skill.LOCO, captions=ways),
            Skill.LOCO,
            deed.pieces if deed.named else (),
            deed.named,
        )
    if deed.row.standing and stood and not (deed.named or read.clause.verb == "sit"):
        return Deed(_STANDING, Skill.LOCO, (), False)
    return deed


def standing_as_well(deed: Deed) -> tuple[str, ...]:
    """Ways to stand that show what is else done sitting: drinking, eating, reading, praying."""
    shown = {caption.split()[0].strip(",") for caption in deed.row.captions}
    return tuple(
        one for gesture in deed_table().gesture for one in gesture.captions
        if gesture.skill is Skill.LOCO and one.split()[0].strip(",") in shown
    )  # fmt: skip


def goes_on(read: ReadBeat, deed: Deed) -> bool:
    """Whether it is done where one rests, and shows no more: "sits in the dark, listening"; nobody gets up for what
    would only stand for it."""
    shown = deed.is_gesture or any(shows(Skill.LOCO, one, read.clause) for one in deed.row.captions)
    stands_in = bool(deed.row.captions) and not shown
    rests = not deed.named and not deed.row.seated
    return rests and (stands_in or (is_beside(read) and deed.row.captions == _STANDING.captions))
