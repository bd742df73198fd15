"""What happens in a theme besides what is done, and when the body takes it: it starts, looks there, or finds nobody.

The rows are data/events.toml. Nobody acts a knock; the body is seen to hear it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from motion_backend.motion import Emotion, Reacts, Skill
from planner_service.composition.deed_patterns import says
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.script import REACTED, PlannedKeyframe, Reacted
from planner_service.themes.beats import ReadBeat
from planner_service.themes.lexicon import lemma_of
from planner_service.themes.protagonist import is_person
from scene_graphs.data_tables import read_table, table

HOW_SEEN: Final[dict[Reacts, str]] = {
    "start": "it starts and looks",
    "notice": "it looks up",
    "search": "it looks to both sides and finds nobody",
}
"""How somebody is seen to take it."""
_HEARS: Final = ("hear", "notice", "find", "see", "be")
"""Verbs of somebody's own that tell of something that happens."""
ROUSED: Final = 3
"""Keyframes from a start on that are not begun slowly."""
_SLOW: Final = re.compile(r"\b(?:slow|stroll)")
_HEAVY: Final = (Emotion.TIRED, Emotion.SAD, Emotion.DRUNK)
_MEANWHILE: Final = ("while", "as", "when")
_NOT_NOW: Final = ("before", "until", "if", "unless", "lest", "because", "since", "that", "to")
"""Joints of what does not happen there and then."""
_SOMEBODY: Final = frozenset(("somebody", "someone", "nobody", "none"))


@table
class _Event:
    """A row of data/events.toml."""

    how: Reacts
    at: str
    says: tuple[str, ...]
    by_people: bool = False


@table
class _Events:
    """data/events.toml."""

    events: tuple[_Event, ...]


@dataclass(frozen=True)
class Taken:
    """How a beat is taken."""

    how: Reacts
    at: str

    @property
    def words(self) -> str:
        """Why it is not acted, and what is seen instead."""
        where = f" towards the {self.at}" if self.at and self.how != "search" else ""
        return f"{REACTED}: {HOW_SEEN[self.how]}{where}"


def taken(read: ReadBeat) -> Taken | None:
    """How somebody takes what a beat tells of; None where nothing happens in it."""
    beat, clause = read.beat, read.clause
    if beat.kind not in ("other", "deed", "feeling") or clause.denied or clause.joint in _NOT_NOW:
        return None
    if beat.kind != "other" and clause.subject and clause.verb not in _HEARS:
        return None
    subject = tuple(map(lemma_of, clause.subject.lower().split()))
    whole = (*subject, *clause.lemmas)
    by_people = is_person(clause.subject) or not _SOMEBODY.isdisjoint(subject)
    rows: _Events = read_table("planner_service", "events.toml", _Events)
    for row in rows.events:
        told = by_people and says(row.says, clause.lemmas) if row.by_people else _tells(row.says, whole, clause.lemmas)
        if told:
            return Taken(row.how, row.at)
    return None


def _tells(ways: tuple[str, ...], whole: Sequence[str], own: Sequence[str]) -> bool:
    """Whether a clause says it with its subject, or the words after that do: "he | hears a knock"."""
    return says(ways, tuple(whole)) or says(ways, tuple(own))


def with_reactions(
    read: Sequence[ReadBeat], keyframes: Sequence[PlannedKeyframe]
) -> tuple[tuple[PlannedKeyframe, ...], dict[int, str]]:
    """Keyframes before or after which the body takes what happens, and why those beats are not acted themselves.

    What is told before a deed happens before it, what is told last after all; what happens while something is done
    comes in the end of that.
    """
    found, whys = list(keyframes), {}
    for index, one in enumerate(read):
        acted = any(index in (keyframe.beat, *keyframe.also) for keyframe in found)
        way = taken(one)
        if way is None or (acted and one.clause.verb not in _HEARS):
            continue
        at, after = _moment(index, read, found, acted)
        known = found[at].reacts
        same = next((row for row in known if (row.how, row.at, row.after) == (way.how, way.at, after)), None)
        if same is None:
            rows = (*known, Reacted(beats=(index,), how=way.how, at=way.at, after=after))
        else:
            longer = same.model_copy(update={"beats": (*same.beats, index)})
            rows = tuple(longer if row is same else row for row in known)
        found[at] = found[at].model_copy(update={"reacts": rows})
        if way.how == "start":
            found[at : at + ROUSED] = [_at_once(keyframe, read) for keyframe in found[at : at + ROUSED]]
        if not acted:
            whys[index] = way.words
    return tuple(found), whys


def _at_once(keyframe: PlannedKeyframe, read: Sequence[ReadBeat]) -> PlannedKeyframe:
    """The way to what is done after a start: not slow, unless it is told so, or the mood makes it."""
    told = read[keyframe.beat].text if keyframe.beat is not None else ""
    leads = connects(keyframe) or keyframe.skill is Skill.LOCO
    if not (leads and _SLOW.search(keyframe.caption)) or keyframe.mood in _HEAVY or _SLOW.search(told):
        return keyframe
    caption = {Skill.STANDUP: "stand up", Skill.GETUP: "get up"}.get(keyframe.skill, "steadily walking forward")
    return keyframe.model_copy(update={"caption": caption})


def _moment(
    index: int, read: Sequence[ReadBeat], keyframes: Sequence[PlannedKeyframe], acted: bool
) -> tuple[int, bool]:
    """At which keyframe a beat happens, and whether after it."""
    later = read[index + 1] if index + 1 < len(read) else None
    if later is not None and later.clause.joint in _MEANWHILE and later.clause.sentence == read[index].clause.sentence:
        during = [at for at, one in enumerate(keyframes) if index + 1 in (one.beat, *one.also)]
        if during:
            return during[-1], True
    first = index if acted else index + 1
    at = next((at for at, one in enumerate(keyframes) if one.beat is not None and one.beat >= first), None)
    if at is None:
        return len(keyframes) - 1, True
    return at, keyframes[at].already
