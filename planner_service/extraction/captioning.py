"""How a body looks while it does a deed: the known caption nearest to the words, among those of the mood."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Final

from motion_backend.motion import Skill
from planner_service.scripts.captions import captions
from planner_service.scripts.checking import hand_of
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.library import ScriptLibrary, built_in

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
            mood = emotion_of(keyframe.emotion) or "neutral"
            counts.setdefault((keyframe.skill, keyframe.caption), Counter())[mood] += 1
    return {key: {mood: n / moods.total() for mood, n in moods.items()} for key, moods in counts.items()}
