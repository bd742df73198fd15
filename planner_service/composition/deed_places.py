"""Where a deed is done: the room and the furniture that a beat says, else what is near, else what is usual."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.body_track import BodyTrack
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.deed_reader import DeedReader
from planner_service.composition.deed_table import deed_table
from planner_service.composition.furniture_words import listed_places, room_of, typical_of, where
from planner_service.scripts.script import PlannedKeyframe
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import ReadBeat
from planner_service.themes.clause import Clause
from planner_service.themes.details import details_of
from planner_service.themes.opening_words import opening_of
from scene_graphs import furniture

_AT: Final = frozenset(("on", "in", "at", "under", "behind", "beneath", "inside", "below"))
"""Words before another place."""
_MOST_PLACES: Final = 3


@dataclass(frozen=True)
class DeedPlaces:
    """The places that there will be for deeds."""

    home: Mapping[str, Collection[str]] | None
    """Categories of furniture that there will be, by room type; None: any."""
    reader: DeedReader

    def of(
        self, read: ReadBeat, deed: Deed, skill: Skill, body: BodyTrack, ahead: str | None = None
    ) -> tuple[str | None, str]:
        """Room and furniture where it is done: as the beat says, else as is usual, of what there will be. Who is in no
        room yet does it in the one that is spoken of next (`ahead`)."""
        need, usual = NEEDS[skill], deed_table().usual
        seat = body.resting.furniture if body.resting is not None and skill is Skill.TOUCH else ""
        asked = dict.fromkeys((read.room, room_of(read.clause), body.room or ahead))
        rooms = [room for room in asked if room is not None and room in self._rooms]
        near = [] if deed.named else [one.furniture for one in body.near()]
        near = [one for one in near if one != seat]  # what lies about does so elsewhere than under one
        last = [one for one in near if self.reader.may_be_at(read.clause, skill, one, one in deed.pieces)]
        last = [*last, *body.there(deed)]
        if deed.named:  # what is named and not there has a stand-in, which the story says
            wanted = [piece for piece in deed.pieces if affords(piece, need)]
            piece = next((one for one in wanted if self.has(one)), wanted[0] if wanted else "")
            told = (read.room, room_of(read.clause))
            fit = (room for room in rooms if room in told or piece in usual[room][need])  # else where it usually is
            return next((room for room in fit if self.has(piece, room)), None), piece
        anywhere = need == "sit" or opening_of(skill, read.text)  # no sofa in kitchens; every room has a door
        for room in rooms:
            own = [one for one in deed.pieces if anywhere and one in usual[room][need]]
            options = [one for one in (*last, *own, *deed.pieces, *usual[room][need]) if one != seat]
            if piece := next((one for one in options if affords(one, need) and self.has(one, room)), ""):
                return room, piece
        general = [piece for those in usual.values() for piece in those[need]]
        options = [*last, *deed.pieces, *(() if deed.pieces else usual["living_room"][need]), *general]
        options = [one for one in options if one != seat]
        return None, next((piece for piece in options if affords(piece, need) and self.has(piece)), "")

    @property
    def _rooms(self) -> Collection[str]:
        return deed_table().usual if self.home is None else self.home

    def has(self, word: str, room: str | None = None) -> bool:
        """Whether there will be such furniture: in a room, or anywhere."""
        if self.home is None or word == "floor":
            return True
        kinds = furniture.categories_of(word)
        return any(category in kinds for name, those in self.home.items() if room in (None, name) for category in those)


def is_at(keyframe: PlannedKeyframe, deed: Deed) -> bool:
    """Whether a keyframe is at the furniture that a deed is first done at."""
    kinds = furniture.categories_of(keyframe.piece[0])
    return any(not kinds.isdisjoint(furniture.categories_of(piece)) for piece in deed.pieces[:1] if piece != "floor")


def further(clause: Clause, deed: Deed) -> list[Deed]:
    """The same deed where else it is done: "looks under the bed, | behind the sofa"."""
    places = (where(text) for text in details_of(clause)[:_MOST_PLACES] if deed.named and text.split()[0] in _AT)
    listed = listed_places(clause) or typical_of(clause.text)
    found = [*(piece for some in places for piece in some[:1]), *listed[: _MOST_PLACES + 1]]
    found = [piece for piece in found if affords(piece, "touch") and piece != deed.pieces[0]]
    return [Deed(deed.row, deed.skill, (piece,), True) for piece in dict.fromkeys(found)]
