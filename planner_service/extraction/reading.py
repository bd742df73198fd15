"""A scene of a text to short scripts, by rules: deeds of its clauses, what the body does between them, a summary."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from motion_backend.motion import Skill
from planner_service.extraction.captioning import captions_for, rise
from planner_service.extraction.clauses import SOMETHING, Told, clauses_in, hero_of, mood_of
from planner_service.extraction.deeds import Deed, deed_of, pieces_in
from planner_service.extraction.making import Draft, Maker
from planner_service.extraction.text import TextScene
from planner_service.scripts.events import rooms_in
from planner_service.scripts.fitting import NEEDS, affords
from planner_service.scripts.keyframe import Keyframe
from planner_service.scripts.mood_reader import clear_moods
from planner_service.scripts.sentences import state_words
from planner_service.scripts.usual import WALKS

_MAX_DEEDS: Final = 6
"""Deeds of one short script; a scene with more is told in several."""
_USUAL: Final = {
    "bedroom": {"sit": "bed", "lie": "bed", "touch": "nightstand"},
    "living_room": {"sit": "sofa", "lie": "sofa", "touch": "coffee table"},
    "dining_room": {"sit": "dining chair", "lie": "sofa", "touch": "dining table"},
    "study": {"sit": "chair", "lie": "sofa", "touch": "desk"},
}
"""Where it is done when the words name no piece."""
_PLACES: Final = (
    ("bedroom", r"bed ?room|dormitory|nursery"),
    ("dining_room", r"kitchen|dining|diner|breakfast"),
    ("study", r"study|office|library|workroom|den"),
    ("living_room", r"living|lounge|sitting room|parlou?r|apartment|flat|house|home"),
)
_HOMES: Final = {
    "bedroom": "bed|nightstand|wardrobe|dressing table|dresser",
    "dining_room": "dining table|dining chair|refrigerator|stove|kitchen counter|kitchen cabinet|microwave|dishwasher",
    "study": "desk|office chair|bookshelf",
    "living_room": "sofa|armchair|coffee table|tv stand|lounge chair",
}
_CLEAR: Final = 2
"""Words of a clause below which it says nothing."""


@dataclass(frozen=True)
class SceneRead:
    """What came of one scene."""

    drafts: tuple[Draft, ...]
    unused: tuple[str, ...] = ()
    """Clauses that no keyframe shows, each with the reason."""
    reason: str = ""
    """Why nothing came of it."""
    room: str = ""


@dataclass
class _Body:
    """The keyframes of one short script on their way: what is done, where, and how the body is left."""

    room: str
    keyframes: list[Keyframe] = field(default_factory=list)
    words: list[str] = field(default_factory=list)
    """What each keyframe is captioned by; empty where its caption stands."""
    resting: tuple[Skill, str] | None = None
    at: str = "floor"

    def do(self, deed: Deed, words: str, mood: str) -> bool:
        """Add what the deed takes; False where there is nothing to do ("stands up" on one's feet)."""
        if deed.skill in (Skill.STANDUP, Skill.GETUP):
            return self._rise(deed, mood)
        if deed.skill is Skill.LOCO:
            self._stand(mood)
            self._add(Skill.LOCO, deed.piece or "floor", mood, words)
            self.at = deed.piece or "floor"
            return True
        if self.resting is not None and self._goes_on(deed, words):
            return True
        piece = deed.piece or _USUAL[self.room][NEEDS[deed.skill]]
        if not (self.resting == (Skill.SITDOWN, piece) and deed.skill is Skill.LIEDOWN):
            self._stand(mood)
            self._walk(piece, mood)
        self._add(deed.skill, piece, mood, words)
        if deed.skill is not Skill.TOUCH:
            self.resting = (deed.skill, piece)
        return True

    def _goes_on(self, deed: Deed, words: str) -> bool:
        """Whether a seat already taken shows it too: reading where one sits, sleeping where one lies."""
        assert self.resting is not None
        skill, piece = self.resting
        same = deed.piece in ("", piece) or not deed.named
        if same and (deed.skill is skill or (deed.kind.done and skill is Skill.LIEDOWN)):
            if deed.kind.done or not self.words[-1]:
                self.words[-1] = f"{self.words[-1]}, {words}".strip(", ")
            return True
        if same and deed.skill is Skill.LIEDOWN and not deed.piece and affords(piece, "lie"):
            self._add(Skill.LIEDOWN, piece, self.keyframes[-1].emotion, words)
            self.resting = (Skill.LIEDOWN, piece)
            return True
        return False

    def _rise(self, deed: Deed, mood: str) -> bool:
        """Get up from where one rests, or from where the words say that one rested; waking is told lying."""
        if self.resting is None:
            if self._has_just_risen(deed):
                return True
            lies = deed.kind.wakes or deed.piece.endswith("bed")
            if not deed.piece and not lies:
                return False
            skill = Skill.LIEDOWN if lies else Skill.SITDOWN
            piece = deed.piece or _USUAL[self.room][NEEDS[skill]]
            self._walk(piece, mood)
            self._add(skill, piece, mood, "sleeps" if lies else "sits")
            self.resting = (skill, piece)
        if not deed.kind.wakes:
            self._stand(mood)
        return True

    def _has_just_risen(self, deed: Deed) -> bool:
        """Whether this rising is told already ("got up and got out of bed")."""
        last = self.keyframes[-1].skill if self.keyframes else None
        return last in (Skill.STANDUP, Skill.GETUP) and deed.piece in ("", self.at)

    def end(self, last: Deed, mood: str) -> None:
        """Whoever only wakes gets up as well."""
        if last.kind.wakes:
            self._stand(mood)

    def _stand(self, mood: str) -> None:
        if self.resting is None:
            return
        skill = Skill.STANDUP if self.resting[0] is Skill.SITDOWN else Skill.GETUP
        self._add(skill, self.resting[1], mood, "", rise(skill, mood))
        self.at, self.resting = self.resting[1], None

    def _walk(self, piece: str, mood: str) -> None:
        if self.at != piece:
            self._add(Skill.LOCO, piece, mood, "", WALKS[mood])
            self.at = piece

    def _add(self, skill: Skill, piece: str, mood: str, words: str, caption: str = "?") -> None:
        self.keyframes.append(Keyframe(skill=skill, emotion=mood, caption=caption, furniture=piece))
        self.words.append(words)


def read_scene(scene: TextScene, maker: Maker, room: str = "") -> SceneRead:
    """The short scripts of a scene; `room` is where the scene before it played, for one that names none."""
    if scene.outside:
        return SceneRead((), (), f"it plays outside the home ({scene.place})", room)
    told = clauses_in(scene)
    deeds = [deed_of(one.clause.text) for one in told]
    hero = hero_of(told, tuple(deed is not None for deed in deeds))
    usable = [deed if one.who in ("", hero) else None for one, deed in zip(told, deeds, strict=True)]
    unused = [line for one, deed in zip(told, usable, strict=True) if deed is None and (line := _why(one, hero))]
    room = room_of(scene, [deed.piece for deed in usable if deed], room)
    done = [(one, deed) for one, deed in zip(told, usable, strict=True) if deed is not None]
    if not done:
        said = "nobody in it does what a body can act" if told else "there is only speech in it"
        return SceneRead((), tuple(unused), said, room)
    mood = _mood(scene, told, maker)
    drafts: list[Draft] = []
    parts = -(-len(done) // _MAX_DEEDS)
    for part in range(parts):
        some = done[part * len(done) // parts : (part + 1) * len(done) // parts]
        body, shown = _Body(room), list[Told]()
        for one, deed in some:
            if body.do(deed, one.clause.text, one.mood if one.mood != "neutral" else mood):
                shown.append(one)
            else:
                unused.append(f"{one.clause.text}: nobody sits or lies there")
        if shown:
            body.end(some[-1][1], shown[-1].mood)
            drafts.append(_draft(body, shown, mood, hero, maker))
    return SceneRead(tuple(drafts), tuple(unused), "" if drafts else "nobody in it does what a body can act", room)


def room_of(scene: TextScene, pieces: Sequence[str], before: str = "") -> str:
    """The room type a scene plays in: by its slugline, its words, its furniture, the scene before, else living room."""
    place = scene.place.lower()
    if named := [room for room, words in _PLACES if re.search(words, place)]:
        return named[0]
    if told := rooms_in(scene.told):
        return told[0]
    votes = Counter(
        room for piece in (*pieces, *pieces_in(scene.told)) for room, own in _HOMES.items() if re.fullmatch(own, piece)
    )
    return max(votes, key=lambda room: votes[room]) if votes else before or "living_room"


def _draft(body: _Body, shown: Sequence[Told], mood: str, hero: str, maker: Maker) -> Draft:
    wanted = [index for index, words in enumerate(body.words) if words]
    captions = captions_for(
        [(body.keyframes[at].skill, body.words[at], body.keyframes[at].emotion) for at in wanted], maker.library
    )
    for at, caption in zip(wanted, captions, strict=True):
        body.keyframes[at] = body.keyframes[at].model_copy(update={"caption": caption})
    moods = Counter(keyframe.emotion for keyframe in body.keyframes if keyframe.emotion != "neutral")
    emotion = max(moods, key=lambda name: moods[name]) if moods else mood
    starts = [one.line.start for one in shown if one.line.start is not None]
    ends = [one.line.end for one in shown if one.line.end is not None]
    span = (min(starts, default=None), max(ends, default=None))
    clauses = [one.clause.text for one in shown]
    return maker.by_rules(clauses, body.keyframes, emotion, body.room, span, (hero,) if hero else ())


def _mood(scene: TextScene, told: Sequence[Told], maker: Maker) -> str:
    """The emotion of what is done, else of what is said, else what the whole means; neutral where nothing shows it."""
    named = Counter(one.mood for one in told if one.mood != "neutral")
    if named:
        return max(named, key=lambda name: named[name])
    if (spoken := mood_of(scene.spoken)) is not None:
        return spoken
    whole = maker.encoder.encode([f"{scene.told} {scene.spoken}"[:300]])[0]
    return clear_moods(maker.library.moods(whole[None]))[0] or "neutral"


def _why(one: Told, hero: str) -> str:
    """Why a clause is not shown; empty for one that only says how somebody feels, or is no clause."""
    text = one.clause.text
    if not one.clause.active or len(text.split()) < _CLEAR or state_words(text) is not None:
        return ""
    if one.who not in ("", hero, SOMETHING) and deed_of(text) is not None:
        return f"{text}: {one.who} does it, and the script follows {hero}"
    if re.search(r"\b(?:doors?|windows?)\b", text):
        return f"{text}: doors and windows are no furniture"
    return f"{text}: no skill of the body shows it"
