"""A scene of a text to short scripts, by rules: deeds of its clauses, what the body does between them, a summary.

How a body looks while it does a deed: the known caption nearest to the words, among those of the mood.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Final

from motion_backend.motion import Skill
from planner_service.extraction.deed_parser import (
    SOMETHING,
    Deed,
    Told,
    clauses_in,
    deed_of,
    hero_of,
    mood_of,
    pieces_in,
)
from planner_service.extraction.script_writer import Draft, Maker
from planner_service.extraction.text_scenes import TextScene
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.caption_fallbacks import WALKS
from planner_service.scripts.captions import captions
from planner_service.scripts.emotion_classifier import clear_moods
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import hand_of
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import rooms_in
from planner_service.themes.sentence_parser import state_words

_OF_THE_MOOD: Final = 0.5
"""What it counts that all authored keyframes of a caption have the mood, beside the nearness of the words (-1 to 1)."""
_SPECIAL: Final = (
    ("reading", r"read\w*|books?|novel|letters?|diary|newspaper|magazine"),
    ("writing", r"writ\w+|wrote|diary|draws?|drew|stud(?:y|ies)\w*|sketch\w*|signs?"),
    ("typing", r"typ(?:e|es|ed|ing)|works?|working|worked|computer|laptop|email\w*|keyboard"),
    ("game", r"games?|controller|console|gaming"),
    ("drinking", r"drink\w*|drank|sip\w*|coffee|tea|wine|beer|cocoa|whisk\w+|cup|glass"),
    ("eating", r"eat\w*|ate|breakfast|lunch|dinner|supper|meal|snack|dines?|dined|soup|cereal"),
    ("music", r"music|songs?|radio|record|headphones"),
    ("piano", r"piano"),
    ("phone", r"phone|call\w*|telephone"),
    ("thinking", r"think\w*|thought|ponder\w*|reflect\w*|wonder\w*|mull\w*|brood\w*|stud(?:y|ies)\w*|waits?"),
    ("forearms on the table", r"table|desk|eat\w*|ate|work\w*|writ\w+|wrote|breakfast|lunch|dinner"),
    ("hands on floor", r"floor|ground"),
    ("wave", r"wav(?:e|es|ed|ing)\b"),
    ("stand still", r"stands?|stood|standing|freez\w*|froze|still"),
    ("front left", r"left"),
    ("front right", r"right"),
    ("danc", r"danc\w*|waltz\w*|music"),
    ("spin", r"spin\w*|spun|twirl\w*|whirl\w*|circl\w*"),
    ("tiptoe", r"tiptoe\w*|sneak\w*|creep\w*|crept|quiet\w*|silent\w*|softly|stol?e?a?l?s?\b"),
    ("old person", r"old|aged|shuffl\w*|hobbl\w*|grand\w*"),
    ("skip steps", r"skip\w*|hop\w*|bounc\w*|jump\w*|leap\w*|bound\w*"),
    ("sidestep", r"side\w*"),
    ("knees bent", r"crouch\w*|duck\w*|bent|creep\w*|crept"),
    ("tap chest", r"chest|heart|pats?"),
    ("pacing", r"pac(?:e|es|ed|ing)\b|up and down|back and forth|to and fro|restless\w*"),
    ("pick up", r"pick\w*|tak\w+|took|grab\w*|lift\w*|fetch\w*|gets?|got"),
    ("put down", r"puts?|putting|place\w*|lays?|laid|drop\w*|sets?"),
    ("turn on", r"(?:turn|switch)\w*"),
    ("wash", r"wash\w*|rins\w*|wip\w*|clean\w*|scrub\w*"),
    ("rotate", r"rotat\w*|turns?|twist\w*"),
    ("prone", r"crawl\w*|prone|floor"),
    ("reaching high", r"high|top|upper|above|stretch\w*|reach\w* up"),
    ("low height", r"low|lower|bottom|bends?|bent|under|beneath|floor|kneel\w*|knelt|stoop\w*"),
    ("covering face", r"cry\w*|cries|cried|weep\w*|wept|sob\w*|face|asham\w*|bur(?:y|ies)\w*"),
    ("right leg held", r"leg|knee"),
)  # fmt: skip
"""Part of a caption that shows more than a mood, and the words of which a clause must have one."""
_PLAIN: Final = {
    Skill.TOUCH: ("touch medium height", "touch low height", "An act of reaching high"),
    Skill.STANDUP: ("stand up",),
    Skill.GETUP: ("get up",),
}
"""What there is to choose from without a word that asks for more."""
_RISES: Final = {
    "hurried": "quickly", "angry": "quickly", "happy": "", "tired": "slowly", "sad": "slowly", "drunk": "slowly"
}  # fmt: skip


def rise(skill: Skill, emotion: str) -> str:
    """The caption of a rising, by mood."""
    how = _RISES.get(emotion, "")
    if skill is Skill.STANDUP:
        return {"quickly": "stand up abruptly", "slowly": "stand up slowly"}.get(how, "stand up")
    return f"get up {how}".strip()


def captions_for(deeds: Sequence[tuple[Skill, str, str]], library: ScriptLibrary) -> list[str]:
    """A known caption for each (skill, words, emotion): of the mood and skill, the hands of the words, and nearest.

    Scores are rounded to 1e-4 before they rank.
    """
    offers = [_offers(*deed) for deed in deeds]
    if not deeds:
        return []
    known = list(dict.fromkeys(caption for offer in offers for caption in offer))
    words = library.encoder.encode([words for _, words, _ in deeds])
    near = words @ library.features.of(known).T  # (deeds, captions)
    at = {caption: index for index, caption in enumerate(known)}
    return [
        max(offer, key=lambda caption: (round(float(row[at[caption]]) + offer[caption], 4), caption))
        for row, offer in zip(near, offers, strict=True)
    ]


def _offers(skill: Skill, words: str, emotion: str) -> Mapping[str, float]:
    """Captions to choose from, and what each is worth besides the nearness of its words."""
    asked = {part for part, cue in _SPECIAL if re.search(rf"\b(?:{cue})(?!\w)", words, re.IGNORECASE)}
    special = {part for part, _ in _SPECIAL}
    used = _used()
    offers: dict[str, float] = {}
    for caption in captions()[skill]:
        needs = {part for part in special if part in caption}
        if needs - asked or not _hands_agree(skill, caption, words):
            continue
        share = used.get((skill, caption), {}).get(emotion, 0.0)
        if share > 0 or needs or skill is Skill.TOUCH:
            offers[caption] = _OF_THE_MOOD * share + (1.0 if needs else 0.0)
    if offers:
        return offers
    return dict.fromkeys(_PLAIN.get(skill, ()), 0.0) or {_usual(skill, emotion): 0.0}


def _hands_agree(skill: Skill, caption: str, words: str) -> bool:
    """Whether the caption's hand is the words' hand; a touch names one only where the words do."""
    hands = set(re.findall(r"\b(left|right)(?= (?:hand|ear))", caption.lower()))
    said = hand_of(words, "") if re.search(r"\bhand\b", words) else ""
    if said:
        return not hands or said in hands
    plain_touch = skill is Skill.TOUCH and ("touch" in caption or "reaching" in caption)
    return not hands or ("right" in hands and not plain_touch)


def _usual(skill: Skill, emotion: str) -> str:
    """The caption most authored keyframes of the skill and mood have."""
    shares = {caption: share.get(emotion, 0.0) for (of, caption), share in _used().items() if of is skill}
    return max(shares, key=lambda caption: (shares[caption], caption))


@cache
def _used() -> dict[tuple[Skill, str], dict[str, float]]:
    """How the authored keyframes of each caption are shared among the moods."""
    counts: dict[tuple[Skill, str], Counter[str]] = {}
    for script in built_in():
        for keyframe in script.keyframes:
            mood = keyframe.mood
            counts.setdefault((keyframe.skill, keyframe.caption), Counter())[mood] += 1
    return {key: {mood: n / moods.total() for mood, n in moods.items()} for key, moods in counts.items()}


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
