"""What keyframes do, worded: each becomes a verb phrase, and phrases become sentences tied to their keyframes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Final, Literal

import numpy as np

from motion_backend.motion import Skill
from planner_service.narration.narrative_voice import Voice, require_blanks
from planner_service.scripts.script import Keyframe, PlannedKeyframe
from planner_service.themes.lexicon import gerund, past
from scene_graphs.data_tables import read_table, require_known, table
from scene_graphs.furniture import class_of, display_name

_BLANKS: Final = ("to", "about", "back", "on", "onto", "the", "hand")


@table
class Walk:
    """Ways to word one way of walking."""

    to: tuple[str, ...]
    """Towards a piece of furniture."""
    about: tuple[str, ...]
    """With no goal but the room."""


@table
class Phrases:
    """data/keyframe_phrases.toml: templates.

    They start with a verb in its base form; further verbs are marked with ~. Blanks: {to} "to the sofa", {about}
    "around the bedroom", {back} "up and down in the bedroom", {on} "on the sofa" or "in the armchair", {onto}, {the}
    "the sofa", {hand} "a hand", and the pronouns of `Voice.fill`.
    """

    idle_walks: tuple[str, ...]
    """Captions of walks that say little."""
    neutral_walks: tuple[str, ...]
    """Captions of the walks that a walk to furniture is usually done in."""
    further: tuple[str, ...]
    """Where a walk with no goal goes after another one."""
    walks: dict[str, Walk]
    """By caption."""
    walks_in_mood: dict[str, Walk]
    """For any other caption."""
    sits_in_mood: dict[str, tuple[str, ...]]
    sits: dict[str, tuple[str, ...]]
    """By caption the manner that may follow; so for lying."""
    lies_in_mood: dict[str, tuple[str, ...]]
    lies: dict[str, tuple[str, ...]]
    rises: dict[Literal["neutral", "slow", "fast"], tuple[str, ...]]
    """By pace."""
    touches: dict[str, tuple[str, ...]]
    """By height."""
    touches_at: dict[str, dict[str, tuple[str, ...]]]
    """By class of furniture and height, where the general wording would be pale."""
    touches_doing: dict[str, tuple[str, ...]]
    """By caption, where it says what is done."""

    def __post_init__(self) -> None:
        require_blanks("", vars(self), _BLANKS)
        require_known("neutral_walks", self.neutral_walks, self.walks)
        require_known("idle_walks", self.idle_walks, self.walks)
        for class_, heights in self.touches_at.items():
            require_known(f"touches_at.{class_}", heights, self.touches)


@cache
def templates() -> Phrases:
    """How keyframes are worded, from data/keyframe_phrases.toml."""
    known: Phrases = read_table("planner_service", "keyframe_phrases.toml", Phrases)
    return known


Piece = tuple[str, tuple[int, ...]]
"""Words and the keyframes they tell, none for connecting words."""
Places = Mapping[int, tuple[str, str]]
"""Index of a keyframe to how its furniture and its room are called in the home it is acted out in."""
_IN = ("armchair", "lounge chair", "lazy sofa", "rocking chair")
_DEEP = (*_IN, "chair")
"""What one sits on but drops into."""
_CONTENT = re.compile(r"(?<!\{)\b(?:\w{4,}|lay|put|run|lie|sit)\b(?!\})")
_VERB = re.compile(r"(?:^|~)(\w+)")
_MANNER = re.compile(r"\{\w+\}|\b(?:both|their|with|over|about|from|into|then|without)\b|^\w+")
"""What is left out of a template to find the words for the manner in which something is done."""
_RISES = (Skill.STANDUP, Skill.GETUP)
_MAX_MOMENT_WORDS = 24
"""Words of a sentence after which no more is added to it."""


@dataclass(frozen=True)
class Phrase:
    """A verb phrase without its subject and the keyframes it tells."""

    base: str
    """With verbs in their base form, further ones marked: "bend down and ~reach under the bed"."""
    keyframes: tuple[int, ...]
    mood: str = "neutral"
    rises: bool = False
    anew: bool = False
    """Begins a sentence: a rising that is not told comes before it."""
    arrives: bool = False
    """A walk whose purpose follows in the next phrase: the two stay in one sentence."""
    skill: Skill = Skill.LOCO
    at: str = ""
    """What it is done at, "the sofa"; empty on the floor."""

    @cached_property
    def bare(self) -> str:
        """ "sit down on the sofa with bowed head"."""
        return self.base.replace("~", "")

    @cached_property
    def text(self) -> str:
        """In the past: "sat down on the sofa with bowed head"."""
        return _VERB.sub(lambda verb: past(verb[1]), self.base)

    @cached_property
    def gerund(self) -> str:
        """ "sitting down on the sofa with bowed head"."""
        return _VERB.sub(lambda verb: gerund(verb[1]), self.base)


class Variety:
    """Chooses among ways to say a thing: the least used so far, ties by the seed."""

    def __init__(self, *seeds: int) -> None:
        self._rng = np.random.default_rng(seeds)
        self._used: Counter[str] = Counter()

    def pick(self, options: Sequence[str]) -> str:
        """One of the options; it counts as used."""
        fewest = min(self._used[option] for option in options)
        fresh = [option for option in options if self._used[option] == fewest]
        chosen = fresh[int(self._rng.integers(len(fresh)))]
        self._used[chosen] += 1
        return chosen

    def index(self, count: int) -> int:
        """A number below `count`."""
        return int(self._rng.integers(count))

    def chance(self, share: float) -> bool:
        """True in that share of cases."""
        return bool(self._rng.random() < share)


class Wording:
    """Words one story's keyframes, remembering where the body is so that "it" can stand for the furniture."""

    def __init__(self, voice: Voice, variety: Variety, places: Places, brief: bool = False) -> None:
        self.voice = voice
        self.brief = brief
        """Whether to leave out how the body walks and rests where that says little."""
        self.variety = variety
        self.places = places
        self.say_room = True
        """Whether the room may be called by its name; not where it was already."""
        self._at: str | None = None
        self._said: str | None = None  # what "it" stands for
        self._wandering = False
        self.doing: frozenset[str] = frozenset()
        """Verbs that the scene's events tell, so that no posture need to."""
        self._manners: list[frozenset[str]] = []
        self._recent: tuple[str, ...] = ()  # the templates of the two phrases before

    def phrases(self, keyframes: Iterable[tuple[int, PlannedKeyframe]], risen: bool = False) -> list[Phrase]:
        """Keyframes of one event as phrases in order; every index is in exactly one of them.

        Where the body has just `risen`, the way to what it does next is told.
        """
        rows = list(keyframes)
        self._wandering, self._said = False, None
        told: list[Phrase] = []
        untold: tuple[int, ...] = ()
        for position, (index, keyframe) in enumerate(rows):
            before = rows[position - 1][1] if position else None
            following = rows[position + 1][1] if position + 1 < len(rows) else None
            arrives = keyframe.skill == Skill.LOCO and _goes_on(keyframe, following)
            if arrives and (self._is_here(index, keyframe) or (not risen and self._is_plain(keyframe))):
                untold = (*untold, index)
                continue
            if following is not None and self._goes_without_saying(
                before, keyframe, [row[1] for row in rows[position + 1 :]]
            ):
                untold = (*untold, index)
                continue
            text = self._text(index, keyframe)
            rises = keyframe.skill in _RISES
            at = "" if keyframe.on_floor else self._the(index, keyframe)
            anew = any(rows[i][1].skill in _RISES for i in range(position) if rows[i][0] in untold)
            told.append(Phrase(text, (*untold, index), keyframe.mood, rises, anew, arrives, keyframe.skill, at))
            untold, risen = (), rises
        return told

    def _is_plain(self, keyframe: Keyframe) -> bool:
        """Whether walking there goes without saying."""
        return self.variety.chance(0.5 + 0.5 * self.brief if keyframe.caption in templates().neutral_walks else 0.3)

    def _goes_without_saying(self, before: Keyframe | None, keyframe: Keyframe, following: Sequence[Keyframe]) -> bool:
        """Whether a keyframe says little: strolling about between two things done, or rising to rest there again."""
        if keyframe.skill in _RISES:
            after = following[1] if len(following) > 1 and _goes_on(following[0], following[1]) else following[0]
            rests = after.skill in (Skill.SITDOWN, Skill.LIEDOWN)
            return rests and before is not None and keyframe.piece == after.piece
        idle = keyframe.skill == Skill.LOCO and keyframe.on_floor and keyframe.caption in templates().idle_walks
        return idle and before is not None and self.variety.chance(0.6)

    def _is_here(self, index: int, keyframe: Keyframe) -> bool:
        return not keyframe.on_floor and self._at == self._the(index, keyframe)

    def _text(self, index: int, keyframe: PlannedKeyframe) -> str:
        mood = keyframe.mood
        match keyframe.skill:
            case Skill.LOCO:
                template = self._fresh(self._walks(keyframe, mood))
                self._note(template)
            case Skill.SITDOWN:
                template = self._posture(keyframe, templates().sits_in_mood[mood], templates().sits)
            case Skill.LIEDOWN:
                template = self._posture(keyframe, templates().lies_in_mood[mood], templates().lies)
            case Skill.TOUCH:
                template = self._fresh(touches(keyframe))
            case _:
                template = self.variety.pick(templates().rises[_pace(keyframe.caption)])
        self._recent = (*self._recent[-1:], template)
        filled = self._fill(template, index, keyframe)
        self._wandering = keyframe.skill == Skill.LOCO and keyframe.on_floor
        self._at = self._said = None if keyframe.on_floor else self._the(index, keyframe)
        return " ".join(filled.split()).replace(" ,", ",")

    def _walks(self, keyframe: Keyframe, mood: str) -> tuple[str, ...]:
        plain = templates().walks_in_mood[mood]
        walk = templates().walks.get(keyframe.caption, plain)
        ways, others = (walk.about, plain.about) if keyframe.on_floor else (walk.to, plain.to)
        ways = self._unheard(ways) or self._unheard(others) or others
        short = tuple(way for way in ways if "," not in way)
        return short if self.brief and short else ways

    def _unheard(self, templates: Sequence[str]) -> tuple[str, ...]:
        """Those whose manner no phrase of the story had."""
        return tuple(template for template in templates if not self._repeats(_manner_of(template)))

    def _repeats(self, manner: frozenset[str]) -> bool:
        return bool(manner) and any(len(manner & had) >= min(2, len(manner), len(had)) for had in self._manners)

    def _posture(self, keyframe: Keyframe, verbs: tuple[str, ...], manners: Mapping[str, tuple[str, ...]]) -> str:
        known = [
            way for way in self._unheard(manners.get(keyframe.caption, ())) if not self.doing & set(_VERB.findall(way))
        ]
        manner = self.variety.pick(known) if known and self.variety.chance(0.45 if self.brief else 0.65) else ""
        comma = "" if manner.startswith(("with ", "on ", "flat ", ",")) or not manner else ","
        self._note(manner)
        return f"{self._fresh(verbs)}{comma} {manner}"

    def _note(self, template: str) -> None:
        if manner := _manner_of(template):
            self._manners.append(manner)

    def _fresh(self, options: Sequence[str]) -> str:
        """One of the options, if possible none with a word of the two phrases before it."""
        heard = {word for template in self._recent for word in _CONTENT.findall(template)}
        shared = [len(heard.intersection(_CONTENT.findall(option))) for option in options]
        return self.variety.pick(
            [option for option, count in zip(options, shared, strict=True) if count == min(shared)]
        )

    def _fill(self, template: str, index: int, keyframe: PlannedKeyframe) -> str:
        the = self._the(index, keyframe)
        here = not keyframe.on_floor and self._said == the
        inside = the.endswith(_IN)
        name = "it" if here else the
        if here and re.search(r"\b(?:down|out|back|seat|comfortably)\b", template.split("{on}")[0]):
            template = template.replace(" {on}", "")
        if here:
            template = re.sub(r"the (\w+(?: \w+)?) of \{the\}", r"its \1", template)
        hand = _hand(keyframe.caption, self.voice)
        if hand == "a hand":
            template = template.replace(" with {hand}", "")
        room = self._room(index, keyframe)
        ways = templates().further if self._wandering else (f"around {room}", f"about {room}", f"through {room}")
        return self.voice.fill(
            template,
            the=name,
            on=f"{'in' if inside else 'on'} {name}",
            onto=f"{'into' if the.endswith(_DEEP) else 'onto'} {name}",
            to=f"{self.variety.pick(('to', 'over to', 'across to'))} {the}" if "{to}" in template else "",
            about=self.variety.pick(ways) if "{about}" in template else "",
            back=self.variety.pick(("up and down", "back and forth")) + f" in {room}" if "{back}" in template else "",
            hand=hand,
        )

    def _the(self, index: int, keyframe: Keyframe) -> str:
        if keyframe.on_floor:
            return "the floor"
        word, instance = keyframe.piece
        name = self.places[index][0] if index in self.places else display_name(word)
        return f"the {'other ' if instance > 1 else ''}{name.removeprefix('the ')}"

    def room_of(self, index: int, keyframe: PlannedKeyframe) -> str:
        """How the keyframe's room is called, "room" where it has none."""
        room = self.places[index][1] if index in self.places else (keyframe.room or "room")
        return room.replace("_", " ").lower().removeprefix("the ")

    def _room(self, index: int, keyframe: PlannedKeyframe) -> str:
        name = self.room_of(index, keyframe)
        chosen = self.variety.pick((name, "room")) if self.say_room else "room"
        self.say_room = self.say_room and chosen != name
        return f"the {chosen}"


def touches(keyframe: Keyframe) -> tuple[str, ...]:
    """Ways to word a touch: by what its caption says is done, else by its height and what is touched."""
    known = templates()
    if keyframe.caption in known.touches_doing:
        return known.touches_doing[keyframe.caption]
    caption = keyframe.caption.lower()
    height = next((h for h in ("prone", "low", "high") if re.search(rf"\b{h}\b", caption)), "medium")
    return known.touches_at.get(class_of(keyframe.piece[0]), {}).get(height) or known.touches[height]


def joined(told: Sequence[Phrase]) -> list[Piece]:
    """Phrases as one predicate, piece by piece: "stood up, crossed to the bed, and lay down"."""
    pieces: list[Piece] = []
    for position, phrase in enumerate(told):
        last = position == len(told) - 1
        if position and last:
            crowded = len(told) > 2 or "," in told[0].text
            pieces.append((", and " if crowded else " and ", ()))
        elif position:
            pieces.append((", ", ()))
        pieces.append((phrase.text, phrase.keyframes))
    return pieces


def sentences_of(told: Sequence[Phrase], variety: Variety) -> list[tuple[Phrase, ...]]:
    """Two to four phrases a sentence: a walk stays with its purpose, rising and a change of mood start a new one."""
    groups: list[list[Phrase]] = []
    most = 3
    for phrase, following in zip(told, [*told[1:], None], strict=True):
        current = groups[-1] if groups else []
        tied = bool(current) and (current[-1].arrives or current[-1].rises)
        purpose = [following] if phrase.arrives and following is not None else []
        words = sum(len(p.text.split()) for p in [*current, phrase, *purpose])
        room = 0 < len(current) < most and words <= _MAX_MOMENT_WORDS and not (phrase.rises or phrase.anew)
        turns = len(current) >= 2 and (phrase.arrives or phrase.mood != current[-1].mood)
        if tied or (room and not turns):
            current.append(phrase)
        else:
            groups.append([phrase])
            most = 2 + variety.index(3)
    return [tuple(group) for group in groups]


def _pace(caption: str) -> Literal["neutral", "slow", "fast"]:
    """The pace of a rising."""
    if re.search(r"slow|weari", caption):
        return "slow"
    return "fast" if re.search(r"quick|abrupt|jump", caption) else "neutral"


def _goes_on(walk: Keyframe, following: Keyframe | None) -> bool:
    """Whether what follows is done at the piece this walk leads to."""
    return (
        following is not None
        and following.skill in (Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH)
        and not walk.on_floor
        and walk.piece == following.piece
    )


def _manner_of(template: str) -> frozenset[str]:
    """The words of a template that say in which manner, none where it tells of two deeds."""
    told = "" if "~" in template else _MANNER.sub(" ", template)
    return frozenset(re.findall(r"[a-z]{4,}", told))


def without_room(told: Sequence[Phrase], room: str, named: bool) -> tuple[Phrase, ...]:
    """The phrases of one sentence with the room said once, or not at all where it is `named` besides."""
    phrases_: list[Phrase] = []
    here = re.compile(rf" (around|about|through|in) the (?:room|{re.escape(room)})\b")
    for phrase in told:
        base = phrase.base
        if named:
            base = here.sub(
                lambda way: "" if way[1] == "in" else " about" if way[1] == "through" else f" {way[1]}", base
            )
        named = named or bool(here.search(base))
        phrases_.append(replace(phrase, base=base))
    return tuple(phrases_)


def _hand(caption: str, voice: Voice) -> str:
    side = re.search(r"\b(left|right)\b", caption)
    return f"{voice['their']} {side[1]} hand" if side else "a hand"
