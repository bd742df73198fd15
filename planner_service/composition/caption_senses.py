"""Whether a keyframe shows a deed or only stands for it: by what its caption is, from data/caption_senses.toml."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.deed_lexicon import Deed, object_of, readings
from planner_service.composition.deed_patterns import says
from planner_service.composition.deed_table import DeedRow, deed_table
from planner_service.composition.furniture_words import pieces_in
from planner_service.scripts.script import Keyframe
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar
from planner_service.themes.protagonist import is_person
from planner_service.themes.theme_words import theme_words
from scene_graphs.data_tables import read_table, table
from scene_graphs.furniture import categories_of

_PLACE: Final = re.compile(
    r"\b(?:on|onto|into|at|under|behind|over|against) ((?:the|a|an|his|her|their|my|every|each) (?:\w+ ?){1,2})"
)
"""Where a clause says that it is done."""
_HANDS: Final = frozenset(("hand", "finger", "fingers", "arm", "arms", "palm", "palms", "thumb", "wrist", "elbow"))
"""What of the body is laid on things."""
_POSTURES: Final = (Skill.SITDOWN, Skill.LIEDOWN, Skill.STANDUP, Skill.GETUP)


@table
class Sense:
    """Deeds that captions of a skill show."""

    skill: Skill
    says: tuple[str, ...]
    captions: tuple[str, ...] = ()
    """Parts of captions; none: any of the skill."""


@table
class Contradiction:
    """Deeds that captions must not be played for: they say the opposite, or show another thing in the hands."""

    captions: tuple[str, ...]
    """Parts of captions."""
    says: tuple[str, ...]


@table
class Only:
    """Deeds that are seen in hands or limbs: no captions show them but these, whatever else is likely."""

    captions: tuple[str, ...]
    """Parts of captions; none: nothing shows them."""
    says: tuple[str, ...]
    unless: tuple[str, ...] = ()
    """Where the words mean something else: "throws the window open"."""


@table
class SenseTable:
    """data/caption_senses.toml."""

    sense: tuple[Sense, ...]
    contradiction: tuple[Contradiction, ...]
    only: tuple[Only, ...]


@cache
def _table() -> SenseTable:
    known: SenseTable = read_table("planner_service", "caption_senses.toml", SenseTable)
    return known


@cache
def senses(skill: Skill, caption: str, own: bool = False) -> tuple[str, ...]:
    """The ways to say what a caption shows; `own`: without those of its whole skill."""
    fitting = (
        one for one in _table().sense
        if one.skill is skill and (any(part in caption.lower() for part in one.captions) or not (own or one.captions))
    )  # fmt: skip
    return tuple(way for one in fitting for way in one.says)


def shows(skill: Skill, caption: str, clause: Clause, own: bool = False) -> bool:
    """Whether a caption shows what a clause tells of; hands do nothing of it to people, nor to one's own body. `own`:
    what that caption shows, and not every one of its skill."""
    if skill is Skill.TOUCH and not _is_touched(object_of(clause)):
        return False
    ways = senses(skill, caption, own)
    return any(says(ways, lemmas) for lemmas in readings(clause))


def contradicted(clause: Clause) -> tuple[str, ...]:
    """Parts of captions that must not be played for what a clause tells: of "lets it ring" those of the phone."""
    told = tuple(readings(clause))
    fitting = (one for one in _table().contradiction if any(says(one.says, lemmas) for lemmas in told))
    return tuple(part for one in fitting for part in one.captions)


def only_in(clause: Clause) -> tuple[str, ...] | None:
    """Parts of the only captions that show what a clause tells from its verb on; None where others may."""
    plain = tuple(lemma for lemma in clause.lemmas if lemma not in grammar().adverbs)  # "jumps up", "softly sings"
    rows = [
        one for one in _table().only
        if any(says(one.says, lemmas) and not says(one.unless, lemmas) for lemmas in (clause.lemmas, plain))
    ]  # fmt: skip
    return tuple(part for one in rows for part in one.captions) if rows else None


def _is_touched(noun: str) -> bool:
    """Whether hands that are laid on furniture do it to a thing, or are what does it: "bangs her fist", not "his
    knee"."""
    return not is_person(noun) and (noun not in theme_words()["body"] or noun in _HANDS)


def is_shown(clause: Clause, deed: Deed, keyframes: Iterable[Keyframe]) -> bool:
    """Whether some keyframe shows a clause's deed: by what its caption is, or as the table of deeds shows it.

    Fair viewers take a hand at the stove for baking, and whoever sits with the deed's own caption for doing it; not a
    walk for whatever is done on one's feet, nor a hand for what is done to people.
    """
    if deed.skill in _POSTURES and not deed.row.captions:
        return True
    return any(shows(one.skill, one.caption, clause) or _is_own(one, clause, deed.row) for one in keyframes)


def _is_elsewhere(keyframe: Keyframe, clause: Clause) -> bool:
    """Whether a clause tells of another place than a keyframe's: "draws a moustache on the mirror" at the desk."""
    here = categories_of(keyframe.piece[0])
    for told in _PLACE.findall(clause.text):
        places = pieces_in(told)
        seats = [seat for piece in places for seat in deed_table().seats_at.get(piece, ())]
        if places and not any(here & categories_of(piece) for piece in (*places, *seats)):
            return True
    return False


def _is_own(keyframe: Keyframe, clause: Clause, row: DeedRow) -> bool:
    """Whether a keyframe at rest, or of a hand, is the one that the table has for a deed."""
    if row.stands or all(row.says is not one.says for one in deed_table().deed) or _is_elsewhere(keyframe, clause):
        return False
    if keyframe.skill is Skill.TOUCH:
        return row.skill is Skill.TOUCH and _is_touched(object_of(clause))
    return keyframe.skill in _POSTURES and keyframe.caption in (*row.captions, *row.seated, *row.lying)
