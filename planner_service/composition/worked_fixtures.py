"""What becomes of furniture under the hands by the theme's verbs: opened, shut, reached into, switched on and off."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final, Literal

from motion_backend.motion import Does, Skill
from planner_service.composition.furniture_words import pieces_in
from planner_service.scripts.script import PlannedKeyframe
from planner_service.themes.beats import ReadBeat
from planner_service.themes.clause import Clause
from planner_service.themes.opening_words import opening_of, spelt_out
from planner_service.themes.theme_words import theme_words
from scene_graphs.furniture import canonical, categories_of, class_of, typical_size
from scene_graphs.furniture_shapes import parts
from scene_graphs.meshes.mesh_details import fronts

_MEANT: Final = frozenset(("it", "them", "one"))
_INTO: Final = frozenset(("in", "into", "inside", "through", "from", "out", "drawer"))
_ONTO: Final = frozenset(("on", "onto", "upon", "top", "over", "under", "behind", "beside"))
_OPEN: Final = frozenset(("open", "ajar"))
_APART: Final = frozenset(("open", "back", "apart", "aside"))
_SHUT: Final = frozenset(("shut", "closed"))
_SWITCHED: Final = frozenset(("on", "off"))
_OPEN_ONE: Final = re.compile(
    r"\b(?:at|before|by|beside|from|in|into|of|out of) (?:the|a|an|his|her|their|my) open(?:ed)? "
    r"(?P<what>fridge|refrigerator|freezer|cupboard|wardrobe|closet|cabinet|drawer)\b",
    re.IGNORECASE,
)
"""What stands open where something is done."""
_OPENS: Final = "touch medium height with the right hand"
_DRAWERS: Final = "dresser"
"""Where drawers are, where nobody says."""
_STORES: Final = frozenset(("closet", "appliance"))
"""Classes of furniture in which things are, where nobody says that they are on it."""


def with_worked(read: Sequence[ReadBeat], keyframes: Sequence[PlannedKeyframe]) -> tuple[PlannedKeyframe, ...]:
    """Keyframes with what becomes of the piece under the hand: for every beat in the first that lays a hand on one."""
    found, told, last = list(keyframes), set[int](), ""
    for number, keyframe in enumerate(keyframes):
        does: Literal[Does, ""] = ""
        for beat in (keyframe.beat, *keyframe.also):
            if does or beat is None or beat in told or keyframe.skill is not Skill.TOUCH or keyframe.on_floor:
                continue
            said = spelt_out(read[beat].text, [one.text for one in read[:beat]])
            at_door = opening_of(Skill.TOUCH, said) is not None
            does = done_to(read[beat].clause, keyframe.piece[0], last or ("open" if at_door else ""))
            told |= {beat} if does else set()
            drawer = does in ("open", "into") and "drawer" in read[beat].clause.lemmas
            if drawer and not _has_drawers(keyframe.piece[0]):
                _move(found, number, next(filter(_has_drawers, pieces_in(read[beat].text)), _DRAWERS))
        last = does or last
        found[number] = found[number].model_copy(update={"does": does}) if does else found[number]
    return tuple(_opened_first(read, found))


def _opened_first(read: Sequence[ReadBeat], keyframes: Sequence[PlannedKeyframe]) -> Iterator[PlannedKeyframe]:
    """The same, with a hand that opens it before what is told to be done "at the open fridge", unless it is open."""
    is_open, worked = set[str](), {one.beat for one in keyframes if one.does}
    for keyframe in keyframes:
        piece = keyframe.piece[0]
        told = "" if keyframe.beat is None else read[keyframe.beat].text
        meant = [match["what"] for match in _OPEN_ONE.finditer(told)]
        at_it = any(canonical(piece) in categories_of(what) for what in meant)
        if at_it and not keyframe.on_floor and keyframe.beat not in worked and piece not in is_open:
            yield keyframe.model_copy(update={"skill": Skill.TOUCH, "caption": _OPENS, "does": "open", "held": ""})
            is_open.add(piece)
        is_open = (is_open | {piece}) if keyframe.does == "open" else is_open
        is_open = (is_open - {piece}) if keyframe.does == "close" else is_open
        yield keyframe


def _has_drawers(piece: str) -> bool:
    """Whether hands pull drawers out of a piece."""
    category = canonical(piece)
    return any(front.slides for part in parts(category, typical_size(category)) for front in fronts(category, part))


def _move(keyframes: list[PlannedKeyframe], number: int, piece: str) -> None:
    """What is done at the piece of a keyframe, on the way to it and after it, is done at another."""
    there = keyframes[number].furniture
    for way in (range(number, -1, -1), range(number + 1, len(keyframes))):
        for at in way:
            if keyframes[at].furniture == there:
                keyframes[at] = keyframes[at].model_copy(update={"furniture": piece})
            elif not keyframes[at].on_floor:
                break


def done_to(clause: Clause, piece: str, last: str = "") -> Literal[Does, ""]:
    """What a clause's deed does to the piece that a hand is at; `last` is what was done to one before, of what "it"
    may be. "" where it does nothing to it."""
    rest, table, pieces = frozenset(clause.lemmas[1:]), theme_words(), pieces_in(clause.text)
    meant = bool(_MEANT & rest) and bool(last)
    switched = _switched(clause.verb, rest)
    if switched:
        named = bool(table["switched_things"] & {*clause.lemmas}) or any(map(_is_lit, pieces))
        return switched if named or (meant and last in _SWITCHED) else ""
    if clause.verb in ("draw", "pull") and "curtain" in rest:
        return "open" if rest & _APART else "close"
    if table["opened_things"] & rest or pieces or (meant and last not in _SWITCHED):
        if clause.verb in table["shutting_verbs"] or rest & _SHUT:
            return "close"
        if clause.verb == "open" or rest & _OPEN:
            return "open"
    return "into" if _reaches_in(clause, piece) else ""


def _switched(verb: str, rest: frozenset[str]) -> Literal[Does, ""]:
    """Whether a verb and the words after it switch something on or off."""
    table = theme_words()
    turns = not verb or verb in table["switching_verbs"] | table["switched_things"] | {"shut"}  # "Lamp on."
    if verb in table["quenching_verbs"] or (turns and rest & {"off", "out"}):
        return "off"
    return "on" if verb in table["lighting_verbs"] or (turns and "on" in rest) else ""


def _is_lit(piece: str) -> bool:
    """Whether furniture of that word has a switch that something is seen of."""
    return bool(categories_of(piece) & (categories_of("lamp") | {"tv", "monitor", "stove", "kitchen_sink"}))


def _reaches_in(clause: Clause, piece: str) -> bool:
    """Whether a hand goes into a piece for a deed: to look, to take something out, to put something in."""
    table = theme_words()
    rest = frozenset(clause.lemmas[1:])
    takes = table["taking_verbs"] | table["finding_verbs"] | table["putting_verbs"] | {"store", "hide", "stow"}
    if clause.verb in table["delving_verbs"]:
        return bool(rest & _INTO)
    within = bool(rest & _INTO) or (class_of(piece.replace(" ", "_")) in _STORES and not rest & _ONTO)
    return clause.verb in takes and within
