"""Keyframes told by what they do, where no words of a theme tell of them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from motion_backend.motion import Skill
from planner_service.narration.keyframe_phrases import Phrase, Wording
from planner_service.narration.told import Words
from planner_service.scripts.script import PlannedKeyframe
from planner_service.themes.lexicon import grammar, is_noun
from planner_service.themes.verb_finder import is_plural

_MAX_PHRASES: Final = 3
_MAX_WORDS: Final = 22
"""Words of a sentence after which no more is added to it."""


def sentences(wording: Wording, rows: Sequence[tuple[int, PlannedKeyframe]], named: bool) -> list[list[Words]]:
    """What keyframes do, each once; `named`: whether a pronoun may stand for the story's person."""
    known = ""
    told: list[list[Words]] = []
    for phrases in _together(wording.phrases(rows)):
        who = wording.voice["they"] if named or told else wording.voice.name
        words = [Words(f"{who[:1].upper()}{who[1:]} ")]
        for at, phrase in enumerate(phrases):
            again, known = _again(phrase, known)
            crowded = len(phrases) > 2 or any(re.search(r",| and ", one.whole) for one in phrases[:-1])
            if at:
                link = ", " if crowded or at < len(phrases) - 1 else " "
                words.append(Words(link + "and " * (at == len(phrases) - 1)))
            words.append(Words(again.whole, phrase.keyframes))
        told.append([*words, Words(".")])
    return told


def _together(phrases: Sequence[Phrase]) -> list[list[Phrase]]:
    """Up to three phrases a sentence; a walk stays with its purpose."""
    told: list[list[Phrase]] = []
    for phrase in phrases:
        last = told[-1] if told else []
        words = sum(len(one.whole.split()) for one in (*last, phrase))
        joined = any(re.search(r",| and ", one.whole) for one in last) or (last and " and " in phrase.whole)
        apart = len(last) == _MAX_PHRASES or words > _MAX_WORDS or joined or phrase.begins
        if last and (last[-1].leads or not apart):
            last.append(phrase)
        else:
            told.append([phrase])
    return told


def _again(phrase: Phrase, named: str) -> tuple[Phrase, str]:
    """A phrase that calls it "it" at which the one before has the body already, or does not say again where; and the
    furniture that "it" stands for after it. `named` is that before it."""
    known = bool(phrase.at) and phrase.at == named and phrase.skill is not Skill.LOCO
    again = replace(phrase, text=_said_again(phrase)) if known else phrase
    there = phrase.at if phrase.at and phrase.at in again.text else named
    told = again.whole if not phrase.at else again.whole.partition(there)[2] if there else ""
    return again, "" if _names_a_thing(told) else there


def _said_again(phrase: Phrase) -> str:
    """The text of a phrase at a place that has just been told."""
    if re.search(r"\bit\b", phrase.whole):  # which stands for something else
        return re.sub(rf"(?<=down|seat) (?:on|in) {re.escape(phrase.at)}$", "", phrase.text)
    return phrase.text.replace(phrase.at, "it", 1)


def _names_a_thing(text: str) -> bool:
    """Whether "it" may stand for something in a text."""
    small = grammar().prepositions | grammar().adverbs | grammar().marks
    words = (word for word in re.findall(r"[a-z]+", text.lower()) if word not in small and not word.endswith("ing"))
    return any(word == "it" or (is_noun(word) and not is_plural(word)) for word in words)
