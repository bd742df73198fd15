"""The parts of a long script as a teller sees them: scenes, and the events of the theme in the teller's words."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import groupby

from motion_backend.motion import Skill
from planner_service.scripts.emotions import feelings
from planner_service.scripts.keyframe import LongScript, PlannedKeyframe
from planner_service.scripts.tense import BASES, base_of, is_past, is_verb_form, third_person
from planner_service.scripts.voice import Voice, retell

_LONGEST = 24
"""Words of an event's own text that a story may quote."""
_ASLEEP = re.compile(r"\b(?:fell (?:fast )?asleep|went to sleep|(?:took|into) a nap|dozed off|nodded off|passed out)\b")
_WEATHER = re.compile(
    r"(?:is|was) (?:raining|snowing|storming)\b|(?:starts|begins) to (?:rain|snow)\b|(?:rains|snows)\b"
)
_RUN_ON = re.compile(
    r"^(?:an?|the)\b.*(?<!,)(?<!\band)(?<!\bbut)(?<!\bso)(?<!\bthat)(?<!\bwhen)(?<!\bwhile)(?<!\bas)"
    r" (?:he|she|they)\b"
)
"""A noun and then a clause of its own: the word that joined them was lost."""
_HERO = re.compile(
    r"(?:the|an?) (?:\w+ )??(?P<kind>teenager|detective|widower|widow|student|writer|artist|nurse|teacher|worker"
    r"|musician|painter|poet|scientist|professor|kid|child|grandmother|grandfather|grandma|grandpa|mother|father|actor|actress"
    r"|programmer|engineer|gardener|lady|gentleman|man|woman|boy|girl|guy|neighbour|couple|cook|chef|singer|soldier"
    r"|pensioner|traveller|tourist|journalist|lawyer|farmer|pilot|novelist|dancer|gamer|bachelor|loner)\b",
    re.IGNORECASE,
)
_SUBJECTS = frozenset(("he", "she", "they"))
_OBJECTS = frozenset(("him", "them"))
"""Who is not the subject of a clause that they are the object of."""
_BASE_VERB = re.compile(r"\band (\w+) (?=\w+ly\b|around\b|about\b|through\b|into\b|home\b)")
_PALE_WORDS = """
again about after becom befor begin chara decid feels felt from gets herse himse into over perso some start that their
then thems this very when with
"""
_PALE = frozenset(_PALE_WORDS.split())
"""Stems that say nothing about what happens."""
RESTS = (Skill.SITDOWN, Skill.LIEDOWN)
_RISES = (Skill.STANDUP, Skill.GETUP)


@dataclass(frozen=True)
class Scene:
    """Keyframes that one short script put in, or one event where there are no short scripts."""

    script: int | None
    """Index into the long script's short scripts."""
    event: int | None
    keyframes: tuple[tuple[int, PlannedKeyframe], ...]
    """With their indices in the long script."""

    def sleeps(self, told: str) -> bool:
        """Whether the telling speaks of sleep and the body rests: sleep is then told after the last rest."""
        own = [k.skill for _, k in self.keyframes if k.short_script is not None or self.script is None]
        return bool(_ASLEEP.search(told)) and any(skill in RESTS for skill in own)


def scenes_of(script: LongScript) -> list[Scene]:
    """The scenes in order; connecting keyframes go with what follows them, but rising ends the scene before."""
    keyframes = script.keyframes
    owners: list[tuple[int | None, int | None]] = [(k.short_script, k.event) for k in keyframes]
    bridging = [k.short_script is None and bool(script.short_scripts) for k in keyframes]
    for index in reversed(range(len(keyframes) - 1)):
        if bridging[index]:
            owners[index] = owners[index + 1]
    for index in range(1, len(keyframes)):
        trailing = bridging[index] and (keyframes[index].skill in _RISES or all(bridging[index:]))
        if trailing:
            owners[index] = owners[index - 1]
    runs = groupby(enumerate(keyframes), key=lambda row: owners[row[0]])
    return [Scene(owner[0], owner[1], tuple(run)) for owner, run in runs]


def told_of_hero(event: str, theme: str) -> str:
    """An event with the theme's own person called "the character", also where the theme's "and she" was lost."""
    text = re.sub(r"\bin the phone\b", "on the phone", event.strip())
    text = re.sub(r"^(?:I['’]m|I am|(?:he|she)['’]s)\b", "is", text, flags=re.IGNORECASE)
    hero = _HERO.match(theme.strip())
    if hero:
        text = re.sub(rf"^(?:the|an?) (?:\w+ )?{hero['kind']}\b(?!['’])", "The character", text, flags=re.IGNORECASE)
    text = _BASE_VERB.sub(lambda m: f"and {third_person(m[1])} " if m[1] in BASES else m[0], text)
    if text.lower().startswith(("his ", "her ", "their ", "the ", "a ", "an ")) and not text.startswith(
        "The character"
    ):
        for joint in re.finditer(r" and (\w+ \w+)", text):
            lost = re.search(rf"\b(?:he|she|they) {re.escape(joint[1])}", theme, re.IGNORECASE)
            if lost or (joint[1].startswith(("becomes ", "gets ", "feels ")) and feelings(joint[1])):
                return f"{text[: joint.start()]} and the character{text[joint.start() + 4 :]}"
    return _listed(text)


def _listed(text: str) -> str:
    """Three things or more, one after the other: "wins, calls his brother and celebrates"."""
    parts = re.split(r",? and (?=\w+)|, (?=\w+)", text)
    verbs = all(is_verb_form(part.split()[0]) for part in parts[1:] if part.split())
    return ", ".join(parts[:-1]) + " and " + parts[-1] if len(parts) > 1 and verbs else text


def event_retold(event: str, voice: Voice, named: bool = False) -> str | None:
    """An event of the theme as a sentence in the past, or None where the rules are not sure of its grammar."""
    text = event.strip().rstrip(".!?")
    words = re.sub(r"[,;]", "", text.lower()).split()
    if not words or len(words) > _LONGEST:
        return None
    if _WEATHER.match(text):
        return (told := retell(f"It {text}", voice, named)) and told + "."
    if _RUN_ON.search(text):
        return None
    others: frozenset[str] = frozenset()
    verb = next((word for word in words[:2] if not word.endswith("ly")), "")
    if is_verb_form(verb) or is_past(verb) or (base_of(verb) and len(words) > 1 and words[1] not in ("and", "of")):
        text = f"The character {text}"
        others = frozenset() if _SUBJECTS.intersection(words) else _OBJECTS
    elif words[0] not in ("the", "a", "an", "he", "she", "they", "his", "her", "their", "it", "there"):
        return None
    told = retell(text, voice, named, others)
    return told and told + "."


_LINK = re.compile(
    r"\b(?P<word>and so|so|but then|but|however|suddenly|finally|eventually|at last|afterwards|later)"
    r"\b,?\s+(?:\w+ ){0,2}$",
    re.IGNORECASE,
)
_LINKS = {
    "so": "So", "and so": "So", "but": "But", "but then": "But then", "however": "But", "suddenly": "Suddenly",
    "finally": "Finally", "eventually": "Eventually", "at last": "At last", "afterwards": "Afterwards",
    "later": "Later",
}  # fmt: skip


def link_before(theme: str, event: str) -> str:
    """The theme's own word between an event and what comes before it, as a sentence may begin with it, or ""."""
    at = theme.find(event[:20]) if event else -1
    match = _LINK.search(theme[max(0, at - 40) : at]) if at > 0 else None
    return _LINKS[match["word"].lower()] if match else ""


def covered(event: str, summary: str) -> float:
    """Share of an event's content words that the summary has too; 1 when it has no content words."""
    wanted, had = _stems(event), _stems(summary)
    return len(wanted & had) / len(wanted) if wanted else 1.0


def _stems(text: str) -> set[str]:
    return {word[:5] for word in re.findall(r"[a-z]{4,}", text.lower())} - _PALE
