"""What keyframes do, worded: each becomes a verb phrase that knows which keyframes it tells."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final, Literal

import numpy as np

from motion_backend.motion import RISINGS, Skill
from planner_service.narration.narrative_voice import Voice, require_blanks
from planner_service.scripts.caption_fallbacks import hashed_words
from planner_service.scripts.captions import captions
from planner_service.scripts.script import Keyframe, PlannedKeyframe
from planner_service.themes.lexicon import past
from scene_graphs.data_tables import read_table, require_known, table
from scene_graphs.furniture import class_of, display_name

_BLANKS: Final = ("to", "about", "back", "on", "onto", "the", "room")


@table
class Walk:
    """Ways to word one way of walking: towards a piece of furniture, and with no goal but the room."""

    to: tuple[str, ...]
    about: tuple[str, ...]


@table
class Phrases:
    """data/keyframe_phrases.toml: templates. How they are written, and what each is for, stands there; their blanks are
    `_BLANKS` and the pronouns of `Voice.fill`."""

    neutral_walks: tuple[str, ...]
    still: tuple[str, ...]
    to: tuple[str, ...]
    about: tuple[str, ...]
    back: tuple[str, ...]
    further: tuple[str, ...]
    further_back: tuple[str, ...]
    walks: dict[str, Walk]
    walks_in_mood: dict[str, Walk]
    sits_in_mood: dict[str, tuple[str, ...]]
    sits: dict[str, tuple[str, ...]]
    lies_in_mood: dict[str, tuple[str, ...]]
    lies: dict[str, tuple[str, ...]]
    rests_again: tuple[str, ...]
    rests_already: dict[Skill, tuple[str, ...]]
    rests_on: dict[Skill, tuple[str, ...]]
    turns: dict[str, tuple[str, ...]]
    rises: dict[Literal["neutral", "slow", "fast"], tuple[str, ...]]
    touches: dict[str, tuple[str, ...]]
    touches_at: dict[str, dict[str, tuple[str, ...]]]
    touches_doing: dict[str, tuple[str, ...]]

    def __post_init__(self) -> None:
        require_blanks("", vars(self), _BLANKS)
        require_known("neutral_walks", self.neutral_walks, self.walks)
        require_known("still", self.still, self.walks)
        require_known("turns", self.turns, RESTS)
        for class_, heights in self.touches_at.items():
            require_known(f"touches_at.{class_}", heights, self.touches)


@cache
def templates() -> Phrases:
    """How keyframes are worded, from data/keyframe_phrases.toml."""
    known: Phrases = read_table("planner_service", "keyframe_phrases.toml", Phrases)
    return known


Places = Mapping[int, tuple[str, str]]
"""Index of a keyframe to how its furniture and its room are called in the home it is acted out in."""
_IN: Final = ("armchair", "lounge chair", "lazy sofa", "rocking chair")
_DEEP: Final = (*_IN, "chair")
"""What one sits on but drops into."""
_VERB: Final = re.compile(r"(?:^|~)(\w+)")
_SEATED: Final = re.compile(r"\b(?:down|out|back|seat|comfortably)\b")
"""After such a word no furniture need be named that just was."""
RESTS: Final = (Skill.SITDOWN, Skill.LIEDOWN)


@dataclass(frozen=True)
class Phrase:
    """Something told of the story's person, without its subject, and the keyframes it tells."""

    text: str
    """In the past: "sat down on the sofa"."""
    keyframes: tuple[int, ...] = ()
    manner: str = ""
    """How the body rests, or what it does there: ", chin in hand", ", then wrote"."""
    skill: Skill | None = None
    at: str = ""
    """What it is done at, "the sofa"; empty on the floor."""
    leads: bool = False
    """Whether the next phrase is what it is done for."""
    stays: bool = False
    """Whether the body rests or stands there already."""
    begins: bool = False
    """Whether a sentence should begin with it."""

    @property
    def whole(self) -> str:
        """With its manner."""
        return self.text + self.manner


class Variety:
    """Chooses among ways to say a thing: the least used so far, ties by the seed."""

    def __init__(self, *seeds: int) -> None:
        self._rng = np.random.default_rng(seeds)
        self.used: Counter[str] = Counter()

    def pick(self, options: Sequence[str]) -> str:
        """One of the options; it counts as used."""
        fewest = min(self.used[option] for option in options)
        fresh = [option for option in options if self.used[option] == fewest]
        chosen = fresh[int(self._rng.integers(len(fresh)))]
        self.used[chosen] += 1
        return chosen

    def chance(self, share: float) -> bool:
        """True in that share of cases."""
        return bool(self._rng.random() < share)


class Wording:
    """Words one story's keyframes."""

    def __init__(self, voice: Voice, variety: Variety, places: Places) -> None:
        self.voice = voice
        self.variety = variety
        self.places = places
        self._named = ""  # what "it" stands for
        self._room = ""  # where a walk had no goal last
        self._rests: PlannedKeyframe | None = None  # as what the body sits or lies

    def phrases(self, rows: Sequence[tuple[int, PlannedKeyframe]], in_full: bool = False) -> list[Phrase]:
        """Keyframes in order as phrases; every index is in exactly one of them. `in_full`: how the body rests is told
        wherever it can be."""
        told: list[Phrase] = []
        untold: tuple[int, ...] = ()
        self._named, stays = "", False
        for at, (index, keyframe) in enumerate(rows):
            goal = _goal(keyframe, [row[1] for row in rows[at + 1 :]])
            leads = keyframe.skill == Skill.LOCO and goal is not None
            rests = goal is not None and goal.skill in RESTS
            stays = stays or (keyframe.skill in RISINGS and rests) or self._goes_on(keyframe)
            plain = leads and rests and keyframe.caption in templates().neutral_walks
            if (rests and stays) or (plain and self.variety.chance(0.5)):  # chance is asked last
                untold = (*untold, index)
                continue
            told.append(self._phrase((*untold, index), keyframe, leads, stays, in_full))
            untold, stays = (), False
        return told

    def _goes_on(self, keyframe: Keyframe) -> bool:
        """Whether the body sits or lies there already, as it is to."""
        before = self._rests
        return before is not None and (before.skill, before.piece) == (keyframe.skill, keyframe.piece)

    def _phrase(
        self, indices: tuple[int, ...], keyframe: PlannedKeyframe, leads: bool, stays: bool, in_full: bool
    ) -> Phrase:
        index, mood, known = indices[-1], keyframe.mood, templates()
        caption = _told_as(keyframe)
        manners: tuple[str, ...] = ()
        walks, sits = keyframe.skill == Skill.LOCO, keyframe.skill == Skill.SITDOWN
        if walks:
            walk = known.walks.get(caption, known.walks_in_mood[mood])
            ways = walk.about if keyframe.on_floor else walk.to
        elif keyframe.skill in RESTS:
            usual = (known.sits_in_mood if sits else known.lies_in_mood)[mood]
            turns = self._rests is not None and self._rests.piece == keyframe.piece
            ways = known.rests_again if stays else known.turns[keyframe.skill] if turns else usual
            ways = known.rests_on[keyframe.skill] if self._goes_on(keyframe) else ways
            ways = known.rests_already[keyframe.skill] if keyframe.already else ways
            manners = (known.sits if sits else known.lies).get(caption, ())
        elif keyframe.skill == Skill.TOUCH:
            ways = touches(keyframe)
        else:
            ways = known.rises[_pace(keyframe.caption)]
        self._rests = keyframe if keyframe.skill in RESTS else None
        the = self.the(index, keyframe)
        base = " ".join(self._fill(self.variety.pick(ways), the, self.room(index, keyframe)).split())
        self._named = the if leads else ""
        manner = _VERB.sub(lambda verb: past(verb[1]), self._manner(manners, in_full))
        return Phrase(
            text=_VERB.sub(lambda verb: past(verb[1]), base),
            keyframes=indices,
            manner=manner,
            skill=keyframe.skill,
            at="" if keyframe.on_floor else the,
            leads=leads,
            stays=stays or keyframe.caption in known.still,
            begins=keyframe.skill in RISINGS,
        )

    def _manner(self, ways: Sequence[str], always: bool = False) -> str:
        """How the body rests, unless the story has told of that already."""
        fresh = [way for way in ways if always or not self.variety.used[way]]
        if not fresh or not (always or self.variety.chance(0.7)):
            return ""
        way = self.variety.pick(fresh)
        joint = "" if way.startswith(",") else " " if way.startswith(("with ", "on ", "flat ")) else ", "
        return joint + self.voice.fill(way)

    def _fill(self, template: str, the: str, room: str) -> str:
        here = self._named == the
        if here and _SEATED.search(template.partition("{on}")[0]):
            template = template.replace(" {on}", "")
        if here:
            template = re.sub(r"the (\w+(?: \w+)?) of \{the\}", r"its \1", template)
        name = "it" if here else the
        known, again = templates(), room == self._room
        about, back = (known.further, known.further_back) if again else (known.about, known.back)
        blanks = {"to": known.to, "about": about, "back": back}
        self._room = room if "{about}" in template or "{back}" in template else self._room
        ways = {blank: self.variety.pick(way) for blank, way in blanks.items() if f"{{{blank}}}" in template}
        return self.voice.fill(
            template,
            the=name,
            on=f"{_on(the)} {name}",
            onto=f"{'into' if the.endswith(_DEEP) else 'onto'} {name}",
            **{blank: way.format(the=the, room=room) for blank, way in ways.items()},
        )

    def the(self, index: int, keyframe: Keyframe) -> str:
        """How the furniture of a keyframe is called: "the other chair"."""
        if keyframe.on_floor:
            return "the floor"
        word, instance = keyframe.piece
        name = self.places[index][0] if index in self.places else display_name(word)
        return f"the {'other ' if instance > 1 else ''}{name.removeprefix('the ')}"

    def on(self, index: int, keyframe: Keyframe) -> str:
        """Where it has the body rest: "in the armchair"."""
        the = self.the(index, keyframe)
        return f"{_on(the)} {the}"

    def room(self, index: int, keyframe: PlannedKeyframe) -> str:
        """How its room is called, "the room" where it has none."""
        room = self.places[index][1] if index in self.places else (keyframe.room or "room")
        return f"the {room.replace('_', ' ').lower().removeprefix('the ')}"


def _on(the: str) -> str:
    return "in" if the.endswith(_IN) else "on"


def _told_as(keyframe: PlannedKeyframe) -> str:
    """The caption that a keyframe is told as: its own, or the known one that is nearest in its letters, "crying" as
    "crying while seated, face in both hands"."""
    if keyframe.caption in captions()[keyframe.skill.value]:
        return keyframe.caption
    nearest, score = hashed_words().nearest(keyframe.skill, keyframe.caption)
    return nearest if score >= hashed_words().least else keyframe.caption


def touches(keyframe: Keyframe) -> tuple[str, ...]:
    """Ways to word a touch: by what its caption says is done, else by its height and what is touched."""
    known, caption = templates(), keyframe.caption
    if caption in known.touches_doing:
        return known.touches_doing[caption]
    height = next((h for h in ("prone", "low", "high") if re.search(rf"\b{h}\b", caption.lower())), "medium")
    return known.touches_at.get(class_of(keyframe.piece[0]), {}).get(height) or known.touches[height]


def _goal(keyframe: Keyframe, later: Sequence[Keyframe]) -> Keyframe | None:
    """What the body does next without leaving the piece of furniture; walks there aside."""
    for one in later:
        if one.on_floor or one.piece != keyframe.piece:
            return None
        if one.skill != Skill.LOCO:
            return one
    return None


def _pace(caption: str) -> Literal["neutral", "slow", "fast"]:
    """The pace of a rising."""
    if re.search(r"slow|weari", caption):
        return "slow"
    return "fast" if re.search(r"quick|abrupt|jump", caption) else "neutral"
