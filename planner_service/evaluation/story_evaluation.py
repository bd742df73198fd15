"""Every labelled theme woven and told without a language model, beside stories that `direct` improvises (SIMS 10).

How alike stories are, and whether each is nearest to its own theme: every sentence with the one most like it.

Which labelled events a long script plays, in order, and what it says of the others.

A scripted model that writes long scripts by itself, for the baseline of SIMS 10 where no real model is at hand.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from pydantic import BaseModel

from motion_backend.emotion_words import emotion_of
from motion_backend.language.sentence_encoder import SentenceEncoder, Vectors
from motion_backend.motion import Character, Emotion, Skill
from planner_service.composition.compose import compose
from planner_service.composition.direct_generation import direct_by_rules
from planner_service.composition.llm_planner import DirectKeyframe, DirectScript
from planner_service.composition.request import Request
from planner_service.evaluation.labels import LabelledEvent, LabelledTheme
from planner_service.grounding.furnish import FurnishError, furnish
from planner_service.grounding.keyframes_to_actions import UnreachableError, act
from planner_service.llm.fake_model import ScriptedModel
from planner_service.narration.narrator import narrate
from planner_service.scripts.script import Beat, LongScript, PlannedKeyframe
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import check
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import ThemeError, clauses_of, moods_of
from scene_graphs.home import HomeError
from scene_graphs.navigation.path_planner import NoPath
from scene_graphs.retrieval.layout_index import LayoutIndex, NoSuitableRoom

_SENTENCE: Final = re.compile(r"(?<=[.!?])\s+")


class RememberingEncoder:
    """An encoder that makes every vector once: seeds ask for the same events, stories share sentences."""

    def __init__(self, encoder: SentenceEncoder) -> None:
        self._encoder = encoder
        self._rows: dict[str, Vectors] = {}

    @property
    def name(self) -> str:
        """The name of the encoder inside: the vectors are the same."""
        return self._encoder.name

    def encode(self, texts: Sequence[str]) -> Vectors:
        """As the encoder inside. (N, D) float32."""
        new = [text for text in dict.fromkeys(texts) if text not in self._rows]
        if not texts:
            return self._encoder.encode([])
        self._rows.update(zip(new, self._encoder.encode(new) if new else (), strict=True))
        return np.stack([self._rows[text] for text in texts])


def sentence_vectors(text: str, encoder: SentenceEncoder) -> Vectors:
    """One unit row a sentence: an encoder reads only so much at once, and a mean would favour long texts. (N, D)."""
    return encoder.encode([part for part in _SENTENCE.split(text.strip()) if part] or [text])


def told_in(text: Vectors, other: Vectors) -> float:
    """How well each sentence of a text is told by some sentence of another, on average, -1 to 1. (N, D), (M, D)."""
    return float((text @ other.T).max(axis=1).mean())


def alike(texts: Sequence[Vectors]) -> float:
    """Mean of how well every text is told in every other, to 1e-4. ValueError when there are fewer than two."""
    if len(texts) < 2:
        raise ValueError(f"texts: {len(texts)} of them; likeness needs two")
    return round(float(np.mean([told_in(one, other) for one, other in itertools.permutations(texts, 2)])), 4)


def nearness(story: Vectors, themes: Sequence[Vectors], own: int) -> float:
    """Share of the other themes that are told in a story less well than its own is."""
    near = np.array([told_in(theme, story) for theme in themes]).round(4)
    return float((np.delete(near, own) < near[own]).mean())


@dataclass(frozen=True)
class Coverage:
    """What became of one labelled event."""

    event: LabelledEvent
    covered: bool
    """Whether a short script plays it, in its place among the others."""
    listed: bool
    """Whether the long script says that it is not covered."""
    emotion: str | None
    """What it was given; None when the event was not found."""
    played: tuple[str, ...]
    """Ids of the short scripts that were chosen for it, right or wrong."""

    @property
    def hidden(self) -> bool:
        """Whether it is missing and nobody is told."""
        return not (self.covered or self.listed)

    @property
    def felt(self) -> bool:
        """Whether its emotion is right."""
        return self.emotion in self.event.emotions


def coverage(events: Sequence[LabelledEvent], script: LongScript) -> tuple[Coverage, ...]:
    """One a labelled event, in order; of events that cannot all be in order the most that can be count.

    A short script may play two events that follow each other, where the long script took them for one.
    """
    chosen = [(script.beats[one.beat].text, one.script) for one in script.short_scripts]
    fits = [[event.told_in(text) and event.played_by(played) for text, played in chosen] for event in events]
    covered = in_order(fits)
    return tuple(
        Coverage(
            event,
            index in covered,
            any(event.told_in(beat.text) for beat in script.beats if beat.why),
            event.emotion_in(script),
            tuple(played.id for text, played in chosen if event.told_in(text)),
        )
        for index, event in enumerate(events)
    )


def in_order(fits: Sequence[Sequence[bool]]) -> frozenset[int]:
    """The most rows that can each be given a column that fits, no column before an earlier row's; earlier rows win."""
    best: dict[int, tuple[int, ...]] = {0: ()}  # the first column still free to the rows taken so far
    for row, columns in enumerate(fits):
        found = dict(best)
        for first, taken in best.items():
            column = next((place for place in range(first, len(columns)) if columns[place]), None)
            if column is not None and _better((*taken, row), found.get(column)):
                found[column] = (*taken, row)
        best = found
    most = min(best.values(), key=lambda rows: (-len(rows), rows))
    return frozenset(most)


def _better(rows: tuple[int, ...], others: tuple[int, ...] | None) -> bool:
    return others is None or (-len(rows), rows) < (-len(others), others)


def improviser(theme: str, seed: int) -> ScriptedModel:
    """A model that answers `prompts/direct_script.md` for this theme. Raises ThemeError as `clauses_of` does.

    It stands for a language model at some temperature and is none: rules find the events and what is done in each,
    and the seed chooses captions in the event's mood and furniture that serves, out of all that the prompt offers.
    """
    clauses = clauses_of(theme)
    moods = moods_of(clauses, [None] * len(clauses))
    events = [Beat(text=clause.text, emotion=Emotion(mood)) for clause, mood in zip(clauses, moods, strict=True)]

    def answer(prompt: str, _schema: type[BaseModel]) -> DirectScript:
        return improvised(events, captions_in(prompt), furniture_in(prompt), seed)

    return ScriptedModel(answer, name="improviser")


def improvised(
    events: Sequence[Beat], captions: dict[Skill, list[str]], furniture: Sequence[str], seed: int
) -> DirectScript:
    """What is done in each event, with captions and furniture by the seed."""
    luck = np.random.default_rng(seed)
    keyframes = direct_by_rules(events)
    pieces = _pieces(keyframes, events, furniture, luck)
    return DirectScript(
        keyframes=[
            DirectKeyframe(
                skill=keyframe.skill,
                emotion=keyframe.emotion,
                caption=str(luck.choice(_fitting(keyframe, captions.get(keyframe.skill, [])))),
                furniture=pieces.get(keyframe.beat, keyframe.furniture),
            )
            for keyframe in keyframes
        ]
    )


def _fitting(keyframe: PlannedKeyframe, known: Sequence[str]) -> Sequence[str]:
    """Captions that show the keyframe's emotion, else those that show none, else its own."""
    moody = [caption for caption in known if _mood(caption) == keyframe.emotion]
    return moody or [caption for caption in known if _mood(caption) in (None, "neutral")] or [keyframe.caption]


@cache
def _mood(caption: str) -> str | None:
    return emotion_of(caption)


def captions_in(prompt: str) -> dict[Skill, list[str]]:
    """The captions that a prompt offers, by skill."""
    found = re.findall(rf"^  ({'|'.join(Skill)}): (.+)$", prompt, re.MULTILINE)
    return {Skill(skill): captions.split("; ") for skill, captions in found}


def furniture_in(prompt: str) -> list[str]:
    """The furniture words that a prompt offers."""
    line = re.search(r"^Furniture: (.+?)\. ", prompt, re.MULTILINE)
    return line[1].split(", ") if line else []


def _pieces(
    keyframes: Sequence[PlannedKeyframe], events: Sequence[Beat], furniture: Sequence[str], luck: np.random.Generator
) -> dict[int | None, str]:
    """The piece of furniture of each event that needs one: what its words name, else one that serves."""
    pieces: dict[int | None, str] = {}
    for keyframe in keyframes:
        if keyframe.skill is Skill.LOCO or keyframe.beat is None:
            continue
        named = keyframe.furniture in events[keyframe.beat].text.lower()
        serving = [] if named else [word for word in furniture if affords(word, NEEDS[keyframe.skill])]
        pieces[keyframe.beat] = str(luck.choice(serving)) if serving else keyframe.furniture
    return pieces


SEEDS: Final = (0, 1, 2, 3, 4)


@dataclass(frozen=True)
class Woven:
    """A theme's long script of one seed, with its story."""

    script: LongScript
    story: str
    coverage: tuple[Coverage, ...]

    @property
    def valid(self) -> bool:
        """Whether checking finds nothing that keeps it from being acted out."""
        return bool(self.script.keyframes) and not check(self.script)


@dataclass(frozen=True)
class Theme:
    """What became of one labelled theme."""

    label: LabelledTheme
    woven: tuple[Woven, ...]
    """One a seed; none where the theme was not understood."""
    fault: str
    """Why its first script cannot be acted out in any home; empty when it can."""
    alike: float
    """How well its stories are told in each other."""
    direct_alike: float
    """The same of the stories improvised for it."""
    nearness: tuple[float, ...]
    """For each story the share of the other themes it is farther from than from its own."""


def tell_themes(labels: Sequence[LabelledTheme], library: ScriptLibrary, rooms: LayoutIndex) -> tuple[Theme, ...]:
    """All themes, planned with every seed of `SEEDS`, told, and compared with each other."""
    woven = [_woven(label, library) for label in labels]
    themes = [sentence_vectors(label.text, library.encoder) for label in labels]
    told = []
    for own, (label, each) in enumerate(zip(labels, woven, strict=True)):
        stories = [sentence_vectors(one.story, library.encoder) for one in each]
        told.append(
            Theme(
                label,
                each,
                _fault(each[0].script, rooms) if each else "the theme was not understood",
                _alike(stories),
                _alike(_improvised(label.text, library)) if each else 1.0,
                tuple(round(nearness(story, themes, own), 4) for story in stories),
            )
        )
    return tuple(told)


def _woven(label: LabelledTheme, library: ScriptLibrary) -> tuple[Woven, ...]:
    try:
        scripts = [compose(label.text, library, Request(seed=seed)) for seed in SEEDS]
    except ThemeError:
        return ()
    return tuple(
        Woven(script, narrate(script, Character(), script.seed).text, coverage(label.events, script))
        for script in scripts
    )


def _improvised(theme: str, library: ScriptLibrary) -> list[Vectors]:
    """The stories that `direct` makes with the improvising model, told by the same narrator."""
    stories = []
    for seed in SEEDS:
        asked = Request(seed=seed, method="direct")
        script = compose(theme, library, asked, improviser(theme, seed), insist=True)
        stories.append(sentence_vectors(narrate(script, Character(), seed).text, library.encoder))
    return stories


def _alike(stories: Sequence[Vectors]) -> float:
    """1 where there are no stories: what was not told is no variety."""
    return alike(stories) if len(stories) else 1.0


def _fault(script: LongScript, rooms: LayoutIndex) -> str:
    try:
        stage = furnish(script, rooms, seed=script.seed)
        act(stage.script.keyframes, stage.places, stage.home, script.seed)
    except (FurnishError, NoSuitableRoom, HomeError, NoPath, UnreachableError) as error:
        return str(error)
    return ""
