"""A long script told as a story: its theme in the past, and what of it no keyframe shows.

A theme is told in its own sentences, so that causes, news and other people keep their places. What of it the body is
not seen doing is a thought (`Told.thoughts`), never an event. Keyframes that no words of the theme tell of are told by
what they do.
"""

from __future__ import annotations

import re
import sys
import zlib
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby, pairwise
from typing import Final

from motion_backend.motion import Character, Emotion, Skill
from planner_service.narration.beat_stretches import SUBJECTS, Retelling, Stretch
from planner_service.narration.keyframe_phrases import RESTS, Places, Variety, Wording
from planner_service.narration.keyframe_sentences import sentences
from planner_service.narration.narrative_voice import Voice
from planner_service.narration.retold_theme import retell
from planner_service.narration.story_words import headline, title_of
from planner_service.narration.tense import form_of
from planner_service.narration.told import Told, Words, page
from planner_service.scripts.acted_beats import connects, planned_beats
from planner_service.scripts.script import WISHED, LongScript, PlannedKeyframe
from planner_service.scripts.still_things import still_words
from planner_service.themes.protagonist import hero_of
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things_told
from scene_graphs.furniture import class_of, display_name, is_known

_FEWEST_LOCATED: Final = 0.5
"""Share of the beats that must stand in the theme for it to be told; else they are told one after the other."""
_MOST_OF_ONE: Final = 2
"""Keyframes, those that only lead to others aside, which the words of one beat tell."""
MAX_TITLE_WORDS: Final = 6
"""Of one made for a script that has none."""
Rows = Sequence[tuple[int, PlannedKeyframe]]


def narrate(script: LongScript, character: Character, seed: int = 0, places: Places | None = None) -> Told:
    """The story of a script by rules; the same seed tells it in the same words."""
    voice = Voice.of(character).in_theme_of(hero_of(clauses_of_text(script.theme)))
    shown = "\n".join(beat.text for beat in script.beats if beat.seen) if script.beats else None
    title = title_of(script.theme, _mood_of(script), _thing_in(script), shown)
    wording = Wording(voice, Variety(seed, zlib.crc32(script.theme.encode())), places or {})
    if any(beat.text for beat in script.beats):
        return page(title, _Teller(script, voice, wording).sentences())
    told = page("", sentences(wording, list(enumerate(script.keyframes)), named=False))
    # Keyframes of one's own are called what they were given as.
    return replace(told, title=(title if script.beats else headline(script.theme)) or _title_of(script, wording))


def _title_of(script: LongScript, wording: Wording) -> str:
    """A title after where what is touched or rested on most is, and the mood that keyframes there have most; "" of
    none."""
    if not script.keyframes:
        return ""
    used = [(at, one) for at, one in enumerate(script.keyframes) if not (connects(one) or one.on_floor)]
    pieces = [one.piece for _, one in used]
    chosen = max(pieces, key=pieces.count) if used else None
    there = [one for _, one in used if one.piece == chosen] or script.keyframes
    moods = [one.mood.value for one in reversed(there)]
    plain = title_of("", max(moods, key=lambda mood: (mood != "neutral") * moods.count(mood)))
    if chosen is None:
        return plain
    at, one = used[pieces.index(chosen)]
    words = wording.on(at, one) if one.skill in RESTS else f"by {wording.the(at, one)}"
    where, _, name = words.partition(" the ")
    title = f"{plain.removesuffix(' at Home')} {where} the".split()
    return " ".join([*title, *name.title().split()[-(MAX_TITLE_WORDS - len(title)) :]])


def _mood_of(script: LongScript) -> str:
    """The mood of most of what happens now, and of more than one beat where there are several."""
    now = [beat.emotion for beat in reversed(script.beats) if beat.seen]
    most = max(now, key=now.count, default=Emotion.NEUTRAL)
    return most.value if 2 * now.count(most) > len(now) > 1 or len(now) == 1 else Emotion.NEUTRAL.value


def _thing_in(script: LongScript) -> str:
    """The small thing that deeds are done to most, the first of two as frequent; "" where none is."""
    deeds = [beat for beat in script.beats if beat.kind == "deed" and beat.seen]
    body = theme_words()["body"] | {"feet", "teeth", "hands", "eyes"}
    of = [word for beat in deeds for word in things_told(beat.text) if word.lower() not in body]
    return max(of, key=of.count) if of else ""


class _Teller:
    """Tells a theme beside the keyframes of its beats."""

    def __init__(self, script: LongScript, voice: Voice, wording: Wording) -> None:
        self.script = script
        self.wording = wording
        self.runs = _runs(script.keyframes)
        self.told = _retold(script, voice)
        self.of: dict[int, Stretch] = {  # that with the verb, of those of one beat
            one.beat: one for one in sorted(self.told.stretches, key=lambda one: one.verb is not None)
        }
        self.anew = self._anew()

    def _anew(self) -> dict[int, tuple[Stretch, str]]:
        """By beat what its keyframes do, where they were put in place of others: told in place of a verb in the past
        and what goes with it."""
        found: dict[int, tuple[Stretch, str]] = {}
        for beat, rows in self.runs:
            stretch = self.of.get(beat) if beat is not None else None
            if stretch is None or stretch.verb is None or not self.script.beats[stretch.beat].replaced:
                continue
            tokens = self.told.tokens
            if form_of(tokens[stretch.verb].told.lower()) != "past":
                continue
            who = [at for at in range(stretch.start, stretch.verb) if tokens[at].is_name or tokens[at].low in SUBJECTS]
            start = next(at for at in range(who[-1] + 1 if who else stretch.start, stretch.end) if tokens[at].is_word)
            phrases = [phrase.whole for phrase in self.wording.phrases(rows, in_full=True)]
            before = found.get(stretch.beat)
            told = _listed([*([before[1].rstrip(",")] if before else ()), *phrases])
            joint = "".join(token.text for token in tokens[stretch.end : stretch.end + 2])
            comma = "," * ("," in told and joint.strip() in ("and", "then"))  # "a hand at his chin, and fell asleep"
            found[stretch.beat] = replace(stretch, start=start), told + comma
        return found

    def sentences(self) -> list[list[Words]]:
        """All sentences, each with what its beats' keyframes do besides."""
        shown, besides = self._owners()
        keyframes, thoughts = self._keyframes(shown), self._thoughts()
        told, words = list[list[Words]](), list[Words]()
        instead = {at: "" for stretch, _ in self.anew.values() for at in range(stretch.start, stretch.end)}
        instead |= {stretch.start: phrase for stretch, phrase in self.anew.values()}
        for at, token in enumerate(self.told.tokens):
            text = instead.get(at, " " if token.text.isspace() else token.told)
            before = words[-1].text[-1:] if words else " "
            if text == " " and (before.isspace() or not before):
                continue
            lead = "" if at in instead else token.before
            words += [Words(lead, keyframes.get(at, ())), Words(text, keyframes.get(at, ()), at in thoughts)]
            words = [one for one in words if one.text]
            if at in self.told.ends:
                told.append(_ended(words))
                for run in besides.get(at, ()):
                    told += sentences(self.wording, run, named=True)
                words = []
        return told

    def _owners(self) -> tuple[list[tuple[Stretch, tuple[int, ...]]], dict[int, list[Rows]]]:
        """The keyframes that each stretch tells, and those that a sentence of their own tells after a token."""
        shown: dict[int, list[int]] = {}
        besides: dict[int, list[Rows]] = {}
        last: int | None = None
        waiting: list[int] = []
        for beat, rows in self.runs:
            own = [*waiting, *(index for index, _ in rows)]
            stretch = self.of.get(beat) if beat is not None else None
            replaced = stretch is not None and self.script.beats[stretch.beat].replaced
            if stretch is not None and (self._has_more(stretch, rows) or replaced) and beat not in self.anew:
                end = self.told.end_of(stretch)
                besides.setdefault(end, []).append([(index, self.script.keyframes[index]) for index in own])
                waiting = []
            elif beat is None:
                end = self.told.end_of(self.of[last]) if last is not None else self.told.ends[-1]
                besides.setdefault(end, []).append([(index, self.script.keyframes[index]) for index in own])
                waiting = []
            elif stretch is None and last is None:
                waiting = own
            else:
                last = last if stretch is None else beat
                shown.setdefault(last, []).extend(own)  # type: ignore[arg-type]
                waiting = []
        if waiting:
            besides.setdefault(self.told.ends[-1], []).append([(at, self.script.keyframes[at]) for at in waiting])
        found = [(self.of[beat], tuple(own)) for beat, own in shown.items()]
        return sorted(found, key=lambda one: one[0].start), besides

    def _has_more(self, stretch: Stretch, rows: Rows) -> bool:
        """Whether keyframes do more than the words of their beat tell, and no other beat stands after it."""
        text = self.told.words(stretch)
        done = [one for _, one in rows if not connects(one)]
        named = all(_furniture_in(text, one.piece[0]) for one in done)
        end = self.told.end_of(stretch)
        last = not any(stretch.start < other.start <= end for other in self.told.stretches)
        same = all(one.skill is Skill.TOUCH for one in done)  # "plumps every cushion"
        return len(done) > _MOST_OF_ONE and not (named or same) and last

    def _keyframes(self, shown: Sequence[tuple[Stretch, tuple[int, ...]]]) -> dict[int, tuple[int, ...]]:
        """By token the keyframes it tells, those of each stretch by its own words alone: a theme may tell what is done
        later first."""
        groups = [(stretch.start, stretch.end, own) for stretch, own in shown]
        groups = [self._with_others(*group, *near) for group, near in zip(groups, _between(groups), strict=True)]
        return {at: keyframes for start, end, keyframes in groups for at in range(start, end)}

    def _with_others(
        self, start: int, end: int, keyframes: tuple[int, ...], after: int, before: int
    ) -> tuple[int, int, tuple[int, ...]]:
        """The words of a group of keyframes with those of other beats that they show too: "sat there | and wrote",
        as far as between two tokens."""
        also = {beat for index in keyframes for beat in self.script.keyframes[index].also}
        shown = [one for one in self.told.stretches if one.beat in also and after <= one.start and one.end <= before]
        starts, ends = (one.start for one in shown), (one.end for one in shown)
        return min(start, *starts, start), max(end, *ends, end), keyframes

    def _thoughts(self) -> set[int]:
        """Tokens of what the body is not seen doing."""
        outcomes = planned_beats(self.script).outcomes
        found = {at for run in self.told.asides() for at in run}
        for stretch in self.told.stretches:
            beat = self.script.beats[stretch.beat]
            outcome = outcomes[stretch.beat]
            if stretch.beat in self.anew or (beat.kind == "undone" and outcome.why != WISHED):
                continue  # what is not done is seen not to be
            if not (beat.seen and outcome.acted):
                found |= {*range(stretch.start, stretch.end)}
                continue
            for detail in (*beat.unshown, *filter(None, (still_words(beat.text, outcome.seen),))):
                found |= {*(self.told.part(stretch, detail) or self.told.lead(stretch, detail))}
        return found


def _retold(script: LongScript, voice: Voice) -> Retelling:
    """The theme, or where few of the beats stand in it, the beats one after the other."""
    told = retell(script.theme, script.beats, voice)
    if len({one.beat for one in told.stretches}) >= _FEWEST_LOCATED * len(script.beats):
        return told
    return retell(" ".join(f"{beat.text[:1].upper()}{beat.text[1:]}." for beat in script.beats), script.beats, voice)


def _ended(words: list[Words]) -> list[Words]:
    """A sentence with a mark at its end."""
    text = "".join(word.text for word in words).rstrip()
    words = [*words[:-1], Words(words[-1].text.rstrip(), words[-1].keyframes, words[-1].thought)] if words else words
    return words if not text or re.search(r"[.!?…][\"”’')\]]*$", text) else [*words, Words(".")]


def _furniture_in(text: str, word: str) -> bool:
    """Whether a text names a piece of furniture, by its name or that of another of its class."""
    words = re.findall(r"[a-z]+", text.lower())
    names = (word.lower(), display_name(word).lower())
    two = map(" ".join, pairwise(words))
    return any(one in names or (is_known(one) and class_of(one) == class_of(word)) for one in (*two, *words))


def _listed(phrases: Sequence[str]) -> str:
    """Phrases as one: "rose, crossed to the desk and sat down"."""
    return " and ".join(filter(None, [", ".join(phrases[:-1]), *phrases[-1:]]))


def _between(groups: Sequence[tuple[int, int, tuple[int, ...]]]) -> list[tuple[int, int]]:
    """For each of some stretches where the one before ends and the next begins."""
    ends = [0, *(end for _, end, _ in groups[:-1])]
    return list(zip(ends, [*(start for start, _, _ in groups[1:]), sys.maxsize], strict=True)) if groups else []


def _runs(keyframes: Sequence[PlannedKeyframe]) -> list[tuple[int | None, Rows]]:
    """Keyframes with the beat they are told with; None: they are told by themselves.

    One of no beat that leads to others goes with what follows it, the last of all with those before it.
    """
    owners: list[int | None] = []
    for keyframe in reversed(keyframes):
        leads = keyframe.beat is None and connects(keyframe) and owners
        owners.append(owners[-1] if leads else keyframe.beat)
    if len(owners) > 1 and keyframes[-1].beat is None and connects(keyframes[-1]):
        owners[0] = owners[1]
    known = reversed(owners)
    return [(owner, list(run)) for owner, run in groupby(enumerate(keyframes), key=lambda _: next(known))]
