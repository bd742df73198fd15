"""The cast: who can be seen acting, how they look and what they wear, as rows of data/cast.toml.

A look changes the surface alone. The skeleton stays that of the height, so that motion, contacts and figures do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from typing import Any, Final, Literal, get_args

import numpy as np

from motion_backend.body.mannequin_mesh import MAX_PROPORTION, MIN_PROPORTION, Proportions
from motion_backend.motion import Action, Character, Does, Emotion, Handle, Skill
from scene_graphs.data_tables import read_table, require_known, table
from scene_graphs.errors import FieldPath
from scene_graphs.layout import Placed, placed_from_row, placed_to_row

Color = tuple[float, float, float]
Age = Literal["child", "teen", "adult", "old"]
Build = Literal["slim", "average", "heavy"]
Hair = Literal["bald", "balding", "short", "swept", "curly", "bob", "long", "ponytail", "bun"]
Top = Literal["tee", "shirt", "tunic"]
Over = Literal["", "cardigan", "coat"]
Bottom = Literal["trousers", "shorts", "skirt"]
Extra = Literal["collar", "tie", "belt", "hood", "bib", "apron", "neckline", "placket", "badge"]
UPWARD: Final = 0.9
"""Surfaces whose normal points up so far bear what is laid on them."""
GIVEN: Final = ("member", "age", "build", "skin", "hair", "hair_color", "outfit")
"""Fields of a character that say how it looks; each may be left empty."""


@table
class _Ratios:
    """Sizes against the average body."""

    girth_ratio: float
    limbs_ratio: float
    head_ratio: float


@table
class _Figure:
    """Breadths and features that differ by sex, of the flesh alone."""

    chest_ratio: float
    hips_ratio: float
    limbs_ratio: float
    bust_m: float
    brow_ratio: float
    lips_ratio: float


@table
class AgeGroup:
    """How old people of it are at most, and how tall."""

    years_max: int
    girth_ratio: float
    limbs_ratio: float
    head_ratio: float
    height_m: float
    height_min_m: float
    height_max_m: float
    heights_m: tuple[tuple[float, float], ...]
    """Years and metres, where they grow."""

    def height_at(self, years: float | None) -> float:
        """Metres of somebody that old; of nobody knows how old, the usual."""
        if years is None or not self.heights_m:
            return self.height_m
        return round(float(np.interp(years, *np.transpose(self.heights_m))), 2)


@table
class Member:
    """One of the cast."""

    name: str
    pronouns: Literal["he", "she", "they"]
    age: Age
    build: Build
    figure: str
    skin: str
    hair: Hair
    hair_color: str
    outfit: str
    beard: bool = False
    glasses: bool = False


@table
class Outfit:
    """Garments and their colours; "" and black where there is none."""

    name: str
    top: Top
    top_srgb: Color
    bottom: Bottom
    bottom_srgb: Color
    shoes_srgb: Color
    over: Over = ""
    over_srgb: Color = (0.0, 0.0, 0.0)
    accent_srgb: Color = (0.0, 0.0, 0.0)
    extras: tuple[Extra, ...] = ()
    loose: bool = False
    """Cut wide."""


@table
class Cast:
    """The whole table."""

    skins_srgb: Mapping[str, Color]
    hair_srgb: Mapping[str, Color]
    builds: Mapping[str, _Ratios]
    figures: Mapping[str, _Figure]
    ages: Mapping[str, AgeGroup]
    member: tuple[Member, ...]
    outfit: tuple[Outfit, ...]

    def __post_init__(self) -> None:
        require_known("ages", get_args(Age), self.ages)
        require_known("builds", get_args(Build), self.builds)
        for one in self.member:
            place = f"member {one.name}"
            require_known(f"{place}.figure", [one.figure], self.figures)
            require_known(f"{place}.skin", [one.skin], self.skins_srgb)
            require_known(f"{place}.hair_color", [one.hair_color], self.hair_srgb)
            require_known(f"{place}.outfit", [one.outfit], [outfit.name for outfit in self.outfit])

    def known(self, name: str) -> tuple[str, ...]:
        """What a field of a character (`GIVEN`) may be."""
        return {
            "member": tuple(one.name for one in self.member),
            "age": get_args(Age),
            "build": get_args(Build),
            "skin": tuple(self.skins_srgb),
            "hair": get_args(Hair),
            "hair_color": tuple(self.hair_srgb),
            "outfit": tuple(one.name for one in self.outfit),
        }[name]

    def named(self, name: str) -> Member:
        """The member of that name."""
        return next(one for one in self.member if one.name == name)


@cache
def cast() -> Cast:
    """The cast that is shipped."""
    known: Cast = read_table("motion_backend", "cast.toml", Cast)
    return known


@dataclass(frozen=True)
class Look:
    """How somebody looks: what a mesh is built from, in words of the cast's table."""

    age: str = "adult"
    build: str = "average"
    figure: str = "straight"
    """Breadths that differ by sex: straight, curved, or those of the young and small."""
    skin: str = "fair"
    hair: str = "short"
    hair_color: str = "brown"
    beard: bool = False
    glasses: bool = False
    outfit: str = "casual"

    @staticmethod
    def of(character: Character) -> Look:
        """A member of the cast, but for what is said of the character itself; the first member where none is named."""
        known = cast()
        member = known.named(character.member) if character.member else known.member[0]
        age = character.age or member.age
        alike = (age == "child") == (member.age == "child")
        other = "small" if age == "child" else "curved" if character.pronouns == "she" else "straight"
        return Look(
            age=age,
            build=character.build or member.build,
            figure=member.figure if alike else other,
            skin=character.skin or member.skin,
            hair=character.hair or member.hair,
            hair_color=character.hair_color or member.hair_color,
            beard=member.beard and age not in ("child", "teen"),
            glasses=member.glasses,
            outfit=character.outfit or member.outfit,
        )

    @property
    def proportions(self) -> Proportions:
        """Of the flesh, against the average body."""
        known = cast()
        build, figure, age = known.builds[self.build], known.figures[self.figure], known.ages[self.age]
        return Proportions(
            girth=_bounded(build.girth_ratio * age.girth_ratio),
            chest=_bounded(figure.chest_ratio),
            hips=_bounded(figure.hips_ratio),
            limbs=_bounded(build.limbs_ratio * figure.limbs_ratio * age.limbs_ratio),
            head=_bounded(build.head_ratio * age.head_ratio),
        )

    @property
    def clothes(self) -> Outfit:
        """What is worn."""
        return next(one for one in cast().outfit if one.name == self.outfit)


def _bounded(ratio: float) -> float:
    return float(np.clip(ratio, MIN_PROPORTION, MAX_PROPORTION))


@dataclass(frozen=True)
class InHand:
    """A thing that is in the hands in a keyframe, and where a hand meets it."""

    thing: str
    """As it is called: "letter"."""
    hand: Literal["left", "right"] = "right"
    """That reaches for it."""
    at: tuple[float, float, float] | None = None
    """The point of a surface that is reached for, in the world; None where nothing is."""
    on_top: bool = False
    """Whether things can lie there; else they come out of what is reached for, and go into it."""
    facing: float = 0.0
    """Yaw of whoever reaches."""


@dataclass(frozen=True)
class Worked:
    """A piece of furniture that a hand opens, shuts or switches in a keyframe."""

    does: Does
    piece: Placed
    """In the home; a door of a room, or the curtains of a window, as one too."""
    at: tuple[float, float, float]
    """The point of a surface that is reached for, in the world."""
    hand: Literal["left", "right"] = "right"
    """That reaches for it."""
    handle: Handle | None = None
    """What it takes along; None where it only lies there, or nothing opens."""


@dataclass(frozen=True)
class Role:
    """Somebody seen acting: the look, what the face is to show, and what is in the hands."""

    look: Look = field(default_factory=Look)
    emotions: Mapping[int, Emotion] = field(default_factory=dict)
    """By keyframe; neutral where it is not named."""
    asleep: frozenset[int] = frozenset()
    """Keyframes with closed eyes."""
    captions: Mapping[int, tuple[Skill, str]] = field(default_factory=dict)
    """What is acted, by keyframe: the hands are empty where it is not named."""
    things: Mapping[int, InHand] = field(default_factory=dict)
    """What is named to be in the hands, by keyframe; where it is not, captions say."""
    worked: Mapping[int, Worked] = field(default_factory=dict)
    """What hands open, shut or switch, by keyframe."""


def acted_captions(actions: Sequence[Action]) -> dict[int, tuple[Skill, str]]:
    """What actions have a role do, by keyframe."""
    return {action.keyframe: (action.skill, action.caption) for action in actions}


def thing_from_dict(row: Mapping[str, Any]) -> InHand:
    """The inverse of `asdict`, once lists have come back for tuples."""
    at = tuple(row["at"]) if row["at"] is not None else None
    return InHand(row["thing"], row["hand"], at, row["on_top"], row["facing"])


def worked_to_dict(worked: Worked) -> dict[str, Any]:
    """Plain values for JSON."""
    row: dict[str, Any] = {"does": worked.does, "hand": worked.hand, "at": list(worked.at)}
    row |= {"handle": asdict(worked.handle)} if worked.handle is not None else {}
    return row | {"piece": placed_to_row(worked.piece)}


def worked_from_dict(row: Mapping[str, Any]) -> Worked:
    """The inverse of `worked_to_dict`."""
    piece = placed_from_row(row["piece"], FieldPath(("worked",)))
    return Worked(row["does"], piece, tuple(row["at"]), row["hand"], Handle.from_dict(row.get("handle")))


def named_things(actions: Sequence[Action]) -> dict[int, InHand]:
    """What actions name that a role has in the hands, by keyframe; of several things the last."""
    return {
        action.keyframe: InHand(
            action.holds.rpartition(", ")[2],
            "left" if action.hand == "left" else "right",
            action.spot.point if action.spot is not None and action.skill is Skill.TOUCH else None,
            action.spot is not None and action.spot.normal[1] > UPWARD,
            action.spot.facing if action.spot is not None else 0.0,
        )
        for action in actions
        if action.holds
    }


PLAIN: Final = Role()
"""Nobody in particular, who shows no feeling."""
