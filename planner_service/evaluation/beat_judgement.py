"""A long script held against its labelled theme: which beats are acted in order, what nobody asked for, what is named.

Connecting keyframes (a walk to furniture, a rising) belong to the next deed; a keyframe that shows no beat is unasked.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from motion_backend.motion import Skill
from planner_service.evaluation.labels import LabelledBeat, LabelledTheme
from planner_service.scripts.acted_beats import connects, planned_beats
from planner_service.scripts.script import LongScript, PlannedKeyframe

SECONDS: Final = {
    Skill.LOCO: 7.5,
    Skill.SITDOWN: 6.0,
    Skill.STANDUP: 2.3,
    Skill.GETUP: 6.4,
    Skill.LIEDOWN: 9.4,
    Skill.TOUCH: 4.1,
}
"""Usual seconds of a keyframe: means over the 163 of the seven themes of SIMS, moved by the procedural backend."""
_SENTENCE: Final = re.compile(r"(?<=[.!?])\s+")
_WORD: Final = re.compile(r"[a-z]{2,}")
_SMALL: Final = re.compile(
    "a[nts]?|and|are|be(en)?|by|did|do(es)?|for|from|ha[ds]|have|he|hers?|him|his|i[fnts]|into|its|not|o[fnr]|off|out|"
    "over|she|so|that|the(ir|m|n|re|y)?|this|to|up|was|were|what|when|while|who|will|with"
)
"""Words that tell nothing."""
_STEM: Final = 5
"""Words that begin with the same letters are one: "watches" and "watching"."""


@dataclass(frozen=True)
class Judgement:
    """A theme's label and what was planned for it."""

    label: LabelledTheme
    script: LongScript | None
    """None where the theme was refused."""

    @property
    def keyframes(self) -> tuple[PlannedKeyframe, ...]:
        """Of the script; none where there is none."""
        return self.script.keyframes if self.script else ()

    @property
    def refused_rightly(self) -> bool:
        """Whether it was refused where that is right, and played otherwise."""
        return self.label.refuse == (self.script is None)

    @cached_property
    def _shown(self) -> list[list[bool]]:
        """Whether each beat (row) is shown by each keyframe."""
        return [
            [any(one.shown_by(keyframe) for one in beat.shown_by) for keyframe in self.keyframes]
            for beat in self.label.beats
        ]

    @cached_property
    def actable(self) -> tuple[int, ...]:
        """Beats that can be shown."""
        return tuple(index for index, beat in enumerate(self.label.beats) if beat.actable)

    @cached_property
    def acted(self) -> tuple[int, ...]:
        """The actable beats that are acted in their order: as many as can be."""
        return tuple(self.actable[row] for row in sorted(in_order([self._shown[index] for index in self.actable])))

    @cached_property
    def missing(self) -> tuple[int, ...]:
        """Beats that are not acted, actable or not; one of the rest is acted where some keyframe shows it."""
        shown = {index for index, row in enumerate(self._shown) if index not in self.actable and any(row)}
        return tuple(index for index in range(len(self.label.beats)) if index not in shown.union(self.acted))

    @cached_property
    def named(self) -> tuple[int, ...]:
        """Those of the missing that the script says are not acted; all where the theme was refused."""
        if self.script is None:
            return self.missing
        outcomes = planned_beats(self.script).outcomes
        return self._said(self.missing, [one.beat.text for one in outcomes if not one.acted] + self._unshown)

    @property
    def doubted(self) -> tuple[int, ...]:
        """The acted beats of which the script says nevertheless that something stands for them, or for a part."""
        return self._said(self.acted, self._unshown)

    @property
    def _unshown(self) -> list[str]:
        outcomes = planned_beats(self.script).outcomes if self.script else ()
        return [text for one in outcomes if one.acted or one.stood_for for text in one.beat.unshown]

    def _said(self, indices: Sequence[int], said: Sequence[str]) -> tuple[int, ...]:
        texts = {index: self.label.beats[index].text for index in indices}
        return tuple(index for index, text in texts.items() if any(same_words(text, other) for other in said))

    def told(self, story: str) -> tuple[int, ...]:
        """Those of the missing that a sentence tells nevertheless, of a whole story or of its events: `Told.events`."""
        sentences = [_stems(sentence) for sentence in _SENTENCE.split(story)]
        words = {index: _stems(self.label.beats[index].text) for index in self.missing}
        return tuple(
            index for index, stems in words.items() if any(3 * len(stems & one) > 2 * len(stems) for one in sentences)
        )

    def told_as_done(self, story: str) -> tuple[int, ...]:
        """Those of the told that the script does not name as not acted; the words of what it names stand in the telling
        of another beat."""
        return tuple(index for index in self.told(story) if index not in self.named)

    @cached_property
    def unasked(self) -> tuple[int, ...]:
        """Keyframes that show no beat, with those that lead to them.

        A beat that a mood alone shows asks for one deed in it, not for every deed in it.
        """
        moods = [[one for one in beat.shown_by if not one.names_a_deed] for beat in self.label.beats]
        unasked: list[int] = []
        leading: list[int] = []
        for index, keyframe in enumerate(self.keyframes):
            if not _shows_a_deed(keyframe, self.label.beats):
                if connects(keyframe):
                    leading.append(index)
                    continue
                mood = next((some for some in moods if any(one.shown_by(keyframe) for one in some)), None)
                if mood is None:
                    unasked += [*leading, index]
                else:
                    moods.remove(mood)
            leading = []
        return (*unasked, *leading)

    @property
    def forbidden(self) -> tuple[int, ...]:
        """Keyframes that show what must not be seen."""
        return tuple(
            index
            for index, keyframe in enumerate(self.keyframes)
            if any(one.shown_by(keyframe) for one in self.label.forbidden)
        )

    @property
    def seconds(self) -> float:
        """How long the film is, about."""
        return sum(SECONDS[keyframe.skill] for keyframe in self.keyframes)

    @property
    def unasked_seconds(self) -> float:
        """How long it shows what nobody asked for, about."""
        return sum(SECONDS[self.keyframes[index].skill] for index in self.unasked)

    @property
    def deeds(self) -> int:
        """Keyframes without the walks that connect them."""
        return sum(not (keyframe.skill is Skill.LOCO and connects(keyframe)) for keyframe in self.keyframes)


def in_order(fits: Sequence[Sequence[bool]]) -> frozenset[int]:
    """The most rows that can each be given a column that fits, no column before an earlier row's; earlier rows win."""
    best: dict[int, tuple[int, ...]] = {0: ()}  # the first column still free to the rows taken so far
    for row, columns in enumerate(fits):
        found = dict(best)
        for first, taken in best.items():
            column = next((place for place in range(first, len(columns)) if columns[place]), None)
            if column is not None:
                others = [found[column]] if column in found else []
                found[column] = min([(*taken, row), *others], key=lambda rows: (-len(rows), rows))
        best = found
    most = min(best.values(), key=lambda rows: (-len(rows), rows))
    return frozenset(most)


def same_words(text: str, other: str) -> bool:
    """Whether two texts share at least half of the words that tell something, of the one that has fewer."""
    first, second = _stems(text), _stems(other)
    return bool(first and second) and 2 * len(first & second) >= min(len(first), len(second))


def _shows_a_deed(keyframe: PlannedKeyframe, beats: Sequence[LabelledBeat]) -> bool:
    return any(one.names_a_deed and one.shown_by(keyframe) for beat in beats for one in beat.shown_by)


def _stems(text: str) -> frozenset[str]:
    return frozenset(word[:_STEM] for word in _WORD.findall(text.lower()) if not _SMALL.fullmatch(word))
