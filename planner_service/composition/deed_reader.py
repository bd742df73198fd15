"""What a body does for each clause of a theme: by the table of deeds, and by what has been learned of beats.

The table is exact where its rows speak of a clause; the classifier has an opinion of every clause. Where they differ,
the surer one is taken.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Final

from motion_backend.language.minilm import MiniLM
from motion_backend.language.sentence_encoder import SentenceEncoder
from motion_backend.motion import RISINGS, Emotion, Skill
from planner_service.composition.beat_classifier import BeatClassifier, Likely, shipped
from planner_service.composition.caption_senses import contradicted, is_shown, shows
from planner_service.composition.deed_lexicon import Deed, deed_of, is_another
from planner_service.composition.deed_table import DeedRow, captions_of_gestures
from planner_service.composition.furniture_words import pieces_in
from planner_service.composition.gainsaid import is_gainsaid
from planner_service.composition.mood_captions import captions_of
from planner_service.scripts.acted_beats import RESTS
from planner_service.scripts.captions import captions
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_embeddings import ByHeart
from planner_service.scripts.script_words import affords
from planner_service.themes.beats import ReadBeat
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import Words, grammar, lemma_of
from planner_service.themes.no_deeds import is_state
from planner_service.themes.opening_words import comes_in, opening_of
from planner_service.themes.protagonist import head_of, is_name, is_person
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things_called
from planner_service.themes.verb_finder import is_adverb
from scene_graphs.data_tables import read_table
from scene_graphs.furniture import categories_of, group_of

SURER: Final = 0.45
"""A learned caption is taken in place of the table's where it is so much likelier,"""
SURER_OF_THE_SAME: Final = 0.15
"""or by so much if it is of the same skill,"""
SURER_THAN_ANY: Final = 0.1
"""or by this where the table has no more than the skill."""
SHOWN: Final = 0.5
"""Where it is less likely that anything shows it, nothing does."""
UNSHOWABLE: Final = 0.3
"""Where it is less likely than this not even what the table has in so many words is done."""
LIKELY: Final = 0.5
"""One that is so likely is taken where the table has none."""
UNLIKELY: Final = 0.15
"""What the table has is left undone where nothing is likelier to show it than this."""
AS_LIKELY: Final = 0.6
"""Captions that are so nearly as likely as the likeliest show it as well,"""
LIKELIEST: Final = 0.95
"""and those that are so nearly as likely are chosen from."""
SEATED: Final = 0.15
"""Who sits already goes on sitting for what may be done so, if that is so likely."""
KNOWN_THERE: Final = 0.5
"""Hands stay where they are for what the table has done there, if that is so nearly as likely as elsewhere."""
ANY: Final = 0.5
"""Where such a share of a skill's captions shows it, it is any of them."""
SURE: Final = 0.7
"""What is likelier than this to show a clause shows it; what is less likely only stands for it."""
SAID: Final = 0.55
"""Less will do where the clause says in so many words what a caption is."""
HARDLY: Final = 0.6
"""Who rests does not get up for what is less likely to show a clause."""
SURELY: Final = 0.95
"""What the table of deeds does not take for shown is if it is so likely."""
MOUTHED: Final = 0.85
"""Who is not told to eat or drink does not where it is less likely than this and the table has another deed."""
MOODY: Final = 0.4
"""A mood that shows a clause so likely is its mood."""
FELT: Final = 0.6
"""A mood that is so likely, and likelier than any caption, is all that a clause tells: "laughs himself silly"."""
WORDS_ALONE: Final = 0.8
"""Words without a verb are done where it is so likely that something shows them."""
THEIRS: Final = {"nobody": 0.65, "a thing": 0.85, "a person": 0.95}
"""What somebody or something else is read to do is done by whom the story is about where it is so likely to be shown:
of a fragment, of what follows an article, of a person."""
HARDLY_HERE: Final = 0.3
"""Who rests does nothing else there for what is less likely to show a clause."""
BEFORE: Final = 2
"""A clause is read with so many of those before it."""
PLACED: Final = 0.15
"""Where hands do it hardly likelier than this it is done anywhere."""
PLACES: Final = 3
"""Pieces of furniture that hands may do it at."""
TOUCHES: Final = (
    "touch medium height with the right hand",
    "touch medium height",
    "touch medium height with the left hand",
)
"""Captions of a hand that is laid on something, whatever it does there."""


IN_HANDS: Final = ("phone", "piano", "controller", "typing", "writing", "eating", "drinking", "book", "music")
"""Parts of captions in which hands are seen with a thing."""
_INSTRUMENTS: Final = frozenset((*things_called("instrument"), "piano", "keyboard", "organ"))
_PLAYS: Final = ("play", "practise", "practice", "strum", "tune", "perform", "pluck")
"""Verbs of what is done with the instrument that was named last."""
_THINGS: Final = re.compile(
    r"(?:the|an?|his|her|its|their|my|our|your|every|each|this|that|it|some\w*|no\w+|who\w*|one) ", re.IGNORECASE
)
"""What begins so is done by a thing, or by nobody: "the latch clicks"."""

_AT_TABLES: Final = ("dining chair", "chair", "office chair")
"""Seats that stand at tables."""
_RESTING: Final = frozenset(("sit", "lie", "perch", "sink", "settle", "flop", "slump", "collapse", "stretch", "sprawl",
                             "lounge", "curl", "recline", "rest", "drop", "stay", "sleep"))  # fmt: skip
"""Verbs of which who sits or lies there is all that is told."""
_DOWN: Final = re.compile(r"\b(?:kneeling|crouching)\b")
_NOT_DRAWN: Final = grammar().prepositions | frozenset(
    (
        "up",
        "near",
        "back",
        "out",
        "aside",
        "apart",
        "close",
        "closer",
        "away",
        "breath",
        "bath",
        "curtain",
        "conclusion",
    )
)
_HURLS: Final = frozenset(("hurl", "fling", "throw", "fall", "flop", "collapse", "dive", "topple", "crash"))
_SMILES: Final = ("smile", "grin", "beam", "smirk")
_NOBODY: Final = frozenset(
    ("somebody", "someone", "everybody", "everyone", "no", "nobody", "nothing", "none", "neither", "few", "hardly")
)
"""What is done by these is not done, or by somebody else."""
_WHEN: Final = re.compile(
    r"(?<=\w) (?:(?:just|right|soon|shortly|long) )?(?:after|before|during|since) (?:an?|the|his|their|my) .+$"
)
"""When it is done says nothing of what is: "slams the cupboard | after the argument on the phone"."""


def classifier_of(encoder: SentenceEncoder) -> BeatClassifier | None:
    """What has been learned of beats, where the sentence encoder is the one that it was learned with."""
    inside = encoder.encoder if isinstance(encoder, ByHeart) else encoder
    return shipped(inside) if isinstance(inside, MiniLM) else None


@dataclass
class DeedReader:
    """Reads the deeds of clauses, of which `heard` have been thought about together."""

    classifier: BeatClassifier | None = None
    _known: dict[str, Likely] = field(default_factory=dict)
    _fitting: dict[str, Likely] = field(default_factory=dict)
    """Those of them without what a caption must not be played for."""
    _nevers: dict[str, tuple[str, ...]] = field(default_factory=dict)
    _about: dict[str, set[str]] = field(default_factory=dict)
    """The words of each clause and of all before it."""
    _instruments: dict[str, str] = field(default_factory=dict)
    """Of clauses that play something: what was named last that can be played."""

    def hear(self, read: Sequence[ReadBeat]) -> None:
        """Think about the clauses of beats as they follow each other, all at once."""
        named = ""
        about: set[str] = set()
        for one in read:
            about |= {*one.clause.lemmas, *map(lemma_of, one.clause.subject.lower().split())}
            self._about[one.clause.text] = {*about}
            named = next((word for word in one.clause.lemmas if word in _INSTRUMENTS), named)
            if one.clause.verb in _PLAYS and named:
                self._instruments[one.clause.text] = named
        told = [_WHEN.sub("", one.clause.plainly or one.text) for one in read]  # with whose deeds they are
        before = (". ".join(told[max(place - BEFORE, 0) : place]) for place in range(len(told)))
        self._think({one.clause.text: pair for one, *pair in zip(read, told, before, strict=True)})

    def _think(self, told: Mapping[str, Sequence[str]]) -> None:
        """About what is told in a clause, and was before it, by the clause's text."""
        new = {text: pair for text, pair in told.items() if text not in self._known}
        if self.classifier is not None and new:
            self._known.update(zip(new, self.classifier.likely(*zip(*new.values(), strict=True)), strict=True))

    def likely(self, clause: Clause) -> Likely | None:
        """What a clause is likely shown by; None without a classifier."""
        self._think({clause.text: (clause.text, "")})
        known = self._known.get(clause.text)
        if known is not None and clause.text not in self._fitting:
            never = self._never(clause)
            others = IN_HANDS if never and self._misled(clause) else ()
            tempting = self._tempting(clause)
            kept = {
                one: p * (_may_be(one, never, others, clause) and not _only_tempts(one, tempting, clause))
                for one, p in known.captions.items()
            }
            self._fitting[clause.text] = replace(known, captions=kept)
        return self._fitting.get(clause.text)

    def _misled(self, clause: Clause) -> bool:
        """Whether what is likeliest to show a clause must not be played for it."""
        known = self._known.get(clause.text)
        return known is not None and any(part in known.best[1] for part in self._never(clause))

    def _tempting(self, clause: Clause) -> tuple[str, ...]:
        """Parts of captions of what nobody takes for anything else, where no words tell of it: nobody plays the piano
        for what a violinist does, nor dances with a box."""
        return tuple(part for part, words in tempting().items() if words.isdisjoint(self._about.get(clause.text, ())))

    def _never(self, clause: Clause) -> tuple[str, ...]:
        """Parts of captions that must not be played for a clause, nor for the instrument that is played in it."""
        if clause.text not in self._nevers:
            instrument = self._instruments.get(clause.text)
            played = replace(clause, lemmas=(clause.verb, instrument)) if instrument else clause
            self._nevers[clause.text] = tuple(dict.fromkeys((*contradicted(clause), *contradicted(played))))
        return self._nevers[clause.text]

    def deed(self, clause: Clause, about: str = "") -> Deed | None:
        """The deed of a clause, see `deed_of`; None where nothing that a body does shows it."""
        found, likely = self._deed(clause, about), self.likely(clause)
        if found is not None and found.skill is Skill.LIEDOWN and not found.named and _falls(clause):
            return replace(found, pieces=("floor",))
        if found is not None and likely is not None and found.skill in RISINGS:
            return replace(found, skill=_rising(found, likely))
        found = _in_particular(found, likely, clause) if found is not None and likely is not None else found
        if found is None or found.named or found.row.there or found.skill is not Skill.TOUCH:
            return found
        pieces = (*found.pieces, *(likeliest_pieces(likely) if likely is not None else ()))
        bearing = [one for one in dict.fromkeys(pieces) if not is_another(clause, one)] or list(found.pieces)
        washes = any(one.startswith("wash") for one in found.row.captions)  # at a sink, where there is one
        order = sorted(bearing, key=lambda one: -at(likely, one) if likely else 0)
        return replace(found, pieces=tuple(sorted(order, key=lambda one: washes and "sink" not in one)))

    def _deed(self, clause: Clause, about: str) -> Deed | None:
        told, likely, never = deed_of(clause, about), self.likely(clause), self._never(clause)
        seems = told is None and likely is not None and _only_seems(likely.best, clause)
        if (seems or "asleep" in clause.lemmas) and lemma_of(head_of(clause.subject)) in theme_words()["body"]:
            return None  # "her leg falls asleep", "until her eyes close"
        if told is not None and never:
            told = _without(told, never)
            if (told is None or told.row.captions) and self._misled(clause):
                return told  # nothing else is played for what would be shown by its opposite
        if likely is None or (told is not None and (told.row.why or told.is_gesture)):
            return told
        if told is not None and (_is_plain(told, clause) or clause.verb == "dream"):
            return told
        skill, best = likely.best
        most = likely.captions[skill, best]
        known = likely.of(told.skill, shown_by(told, Emotion.NEUTRAL)) if told is not None else 0.0
        if likely.shown < UNSHOWABLE:
            return None
        if told is not None and told.row.captions and likely.shown < SHOWN:
            return told  # what the table says in so many words
        told_alone = told is not None and told.named  # "Bed."
        if likely.shown < SHOWN or not (clause.verb or told_alone or min(most, likely.shown) > WORDS_ALONE):
            return None
        if told is not None and most - known < (SURER_OF_THE_SAME if skill is told.skill else SURER):
            return told
        if told is not None and _is_surer(told, likely, clause):
            return told
        if most < LIKELY:
            return told if told is not None and known > UNLIKELY else None
        return deed_of(clause, about, learned_row(clause, likely)) or told

    def heard(self, one: ReadBeat) -> ReadBeat:
        """A beat with what the rules of reading have not understood of it: that it is done, or a mood it shows."""
        likely = self.likely(one.clause) if one.beat.kind in ("deed", "feeling", "other") else None
        if one.beat.kind == "deed" and one.clause.verb in _SMILES:  # seen in a face
            return replace(one, beat=one.beat.model_copy(update={"kind": "feeling"}), sure=True)
        told = deed_of(one.clause) if one.beat.kind in ("deed", "feeling") else None
        if one.beat.kind == "feeling" and not (
            one.clause.verb or one.clause.place or is_adverb(one.text)
        ):  # "Frightened, …"
            being = replace(one.clause, verb="be", lemmas=("be", *one.clause.lemmas), aside=False)
            told = deed_of(being)
            one = replace(one, clause=being) if told is not None and told.is_gesture else one
        if one.beat.kind == "feeling":
            does = told is not None and told.is_gesture and not (told.row.small or told.row.mood)  # "gets dressed"
            one = replace(one, beat=one.beat.model_copy(update={"kind": "deed"})) if does else one
            told = told if does else None
        if likely is None or (told is not None and (told.is_gesture or opening_of(told.skill, one.text))):
            return one
        most = likely.captions[likely.best]
        if one.beat.kind == "other":
            first = one.beat.who.split(" ")[0]
            not_yet = one.clause.aside and one.clause.joint == "before"
            if first.lower() in _NOBODY | {"he", "she"} or is_name(first) or not_yet:
                return one
            if _sounds(one) or is_state(one.clause):
                return one
            ours = min(most, likely.shown) > THEIRS[_whose(one)]  # "a cup of tea"
            words = one.clause.text if one.text == f"{one.beat.who} {one.clause.text}" else one.text
            return (
                replace(one, beat=one.beat.model_copy(update={"kind": "deed", "who": "", "text": words}))
                if ours
                else one
            )
        mood = max(likely.moods, key=lambda mood: likely.moods[mood])
        if likely.moods[mood] < MOODY or mood is Emotion.NEUTRAL:
            return one
        one = one if one.felt is mood else one.in_mood(mood)
        alone = " " not in one.text  # "stressed"
        if likely.moods[mood] > max(most, 0.0 if alone else FELT) and (alone or one.clause.verb):
            return replace(one, beat=one.beat.model_copy(update={"kind": "feeling"}), sure=True)
        return one

    def is_shown(self, clause: Clause, deed: Deed, keyframes: Sequence[Keyframe], placed: bool = False) -> bool:
        """Whether some keyframe shows a clause's deed, or they only stand for it; `placed` where the place is known."""
        if is_gainsaid(clause, keyframes):
            return False
        if deed.is_gesture and not deed.row.stands:
            own = (*deed.row.captions, *deed.row.seated, *deed.row.lying)
            return any(one.caption in own or shows(one.skill, one.caption, clause, own=True) for one in keyframes)
        if _says_so(deed, clause) and any(one.caption in deed.row.captions for one in keyframes):
            return True
        by_table, likely = is_shown(clause, deed, keyframes), self.likely(clause)
        if likely is None or not keyframes or deed.row.stands:
            return by_table
        if by_table and deed.skill is Skill.TOUCH and opening_of(deed.skill, clause.text):
            return True  # a hand at the door opens it, whatever else may show it
        if deed.skill is Skill.LOCO and (clause.lemmas == ("leave",) or not (clause.verb or deed.row.captions)):
            return all(one.skill is Skill.LOCO for one in keyframes)  # seen walking, however they walk
        rests = [one for one in keyframes if one.skill is deed.skill in (Skill.SITDOWN, Skill.LIEDOWN)]
        besides = clause.text.partition(" with ")[0]
        if by_table and rests and (RESTS.match(besides) or (deed.named and clause.verb in _RESTING)):
            return True  # whatever hands do there
        if deed.skill in RISINGS and keyframes and all(rises_again(one) for one in keyframes):
            return True  # who kneels gets up
        if deed.skill in RISINGS and any(one.skill in RISINGS or getattr(one, "already", False) for one in keyframes):
            if deed.named:
                return True  # "jumps out of bed"
            rises = max(share for (skill, _), share in likely.captions.items() if skill in RISINGS)
            return min(rises, likely.shown) > SURE  # from whatever: a bed or a chair
        said = any(shows(one.skill, one.caption, clause) for one in keyframes)
        if any(not likely.has_learned(one.skill, one.caption) and shows(one.skill, one.caption, clause, own=True)
               for one in keyframes):  # fmt: skip
            return True  # of a caption that no label knows only its senses tell
        least = SAID if said else SURE if by_table else SURELY
        return max(shown(likely, clause, one, placed) for one in keyframes) > least

    def hardly_shows(self, clause: Clause, deed: Deed, mood: Emotion, least: float = HARDLY) -> bool:
        """Whether a deed's captions are taken for what a clause tells less likely than `least`."""
        likely = self.likely(clause)
        if likely is None or deed.is_gesture:
            return False
        at_rest = max(likely.of(Skill.SITDOWN, deed.row.seated), likely.of(Skill.LIEDOWN, deed.row.lying))
        return min(max(likely.of(deed.skill, shown_by(deed, mood)), at_rest), likely.shown) < least

    def likelihood(self, clause: Clause, keyframe: Keyframe) -> float:
        """How likely a keyframe's caption is taken for what a clause tells, wherever it is; 1 without a classifier."""
        likely = self.likely(clause)
        if likely is None or not likely.has_learned(keyframe.skill, keyframe.caption):
            return 1.0
        return min(likely.captions.get((keyframe.skill, keyframe.caption), 0.0), likely.shown)

    def may_be_at(self, clause: Clause, skill: Skill, word: str, known: bool) -> bool:
        """Whether it may as well be done at a piece of furniture as elsewhere; `known` is what the table says."""
        likely = self.likely(clause)
        if likely is None or skill is not Skill.TOUCH:
            return known
        return at(likely, word) >= (KNOWN_THERE if known else AS_LIKELY) * max(likely.pieces.values())

    def likeliest(self, clause: Clause, skill: Skill, some: Sequence[str]) -> Sequence[str]:
        """Those of some captions that are as likely to show a clause as the likeliest of them; all where none is."""
        likely = self.likely(clause)
        if likely is None or not all(likely.has_learned(skill, one) for one in some):
            return some
        most = likely.of(skill, some)
        if most < UNLIKELY:
            return some
        return [one for one in some if likely.of(skill, (one,)) >= LIKELIEST * most]


def shown(likely: Likely, clause: Clause, keyframe: Keyframe, placed: bool = False) -> float:
    """How likely a fair viewer takes a keyframe for what a clause tells; `placed` where it is told before."""
    there = 1.0
    if keyframe.skill is Skill.TOUCH and not (placed or pieces_in(clause.text)):
        most = max(share for piece, share in likely.pieces.items() if not is_another(clause, piece.replace("_", " ")))
        there = min(2 * at(likely, keyframe.piece[0]) / most, 1.0)
    felt = 0.0 if keyframe.mood is Emotion.NEUTRAL else likely.moods.get(keyframe.mood, 0.0)
    return min(max(there * likely.captions.get((keyframe.skill, keyframe.caption), 0.0), felt), likely.shown)


def _whose(one: ReadBeat) -> str:
    """Who is read to do what somebody else does."""
    if is_person(one.beat.who):
        return "a person"
    theirs = one.clause.verb and (one.clause.aside or _THINGS.match(one.text))
    return "a thing" if theirs else "nobody"


def _sounds(one: ReadBeat) -> bool:
    """Whether a thing, or somebody elsewhere, is only heard: nobody answers a phone because it rings, or her mother
    calls."""
    calls = one.clause.verb in ("call", "phone", "ring", "text") and one.clause.lemmas[1:2] != ("her",)
    return calls if is_person(one.beat.who) else one.clause.verb in theme_words()["sounds"]


def _may_be(caption: tuple[Skill, str], never: Sequence[str], others: Sequence[str], clause: Clause) -> bool:
    """Whether a caption may be played where some must not be: nor others with something in the hands instead."""
    if any(part in caption[1] for part in never):
        return False
    return shows(*caption, clause) or not any(part in caption[1] for part in others)


def _only_tempts(caption: tuple[Skill, str], tempting: Sequence[str], clause: Clause) -> bool:
    """Whether a caption has a part that no words tell of."""
    return any(part in caption[1] for part in tempting) and not shows(*caption, clause, own=True)


def _without(deed: Deed | None, never: Sequence[str]) -> Deed | None:
    """A deed without captions that must not be played for it; None where it has no others."""
    if deed is None or not never:
        return deed
    own = (deed.row.captions, deed.row.seated, deed.row.lying)
    kept = [tuple(one for one in some if not any(part in one for part in never)) for some in own]
    if deed.row.captions and not kept[0] and deed.skill is Skill.TOUCH:
        kept[0] = TOUCHES  # a hand that is laid there shows no opposite: "turns the lamp off"
    if deed.row.captions and not kept[0]:
        return None
    return replace(deed, row=replace(deed.row, captions=kept[0], seated=kept[1], lying=kept[2]))


def _in_particular(deed: Deed, likely: Likely, clause: Clause) -> Deed:
    """A deed of which the table has no more than its skill, with the captions that show how it is done: "sits
    upright"; none in which hands do what is not told of."""
    row, known = deed.row, _idle(deed.skill, _learned(deed.skill), clause)
    if row.captions or row.why or deed.skill is not row.skill or _is_plain(deed, clause):
        return deed
    most = likely.of(deed.skill, known)
    some = tuple(one for one in known if likely.of(deed.skill, (one,)) >= LIKELIEST * most)
    any_way = most < LIKELY or len(some) > ANY * len(known)
    if any_way or most - likely.of(deed.skill, shown_by(deed, Emotion.NEUTRAL)) < SURER_THAN_ANY:
        return deed
    return replace(deed, row=replace(row, captions=some))


def _idle(skill: Skill, some: Sequence[str], clause: Clause) -> Sequence[str]:
    """Those of some captions in which hands do nothing with a thing that is not told of; all where there are none."""
    idle = [one for one in some if not any(part in one for part in IN_HANDS) or shows(skill, one, clause, own=True)]
    return idle or some


def _is_plain(deed: Deed, clause: Clause) -> bool:
    """Whether the table has a deed for words that leave no doubt, whatever was learned of them: a door or a window,
    coming in, and getting up from what is named."""
    opens = bool(deed.row.captions) and opening_of(deed.skill, clause.text) is not None
    comes = deed.skill is Skill.LOCO and comes_in(clause.text)
    goes = deed.skill is Skill.LOCO and (not clause.verb or clause.lemmas == ("leave",))  # "Out the door."
    return opens or comes or goes or (deed.named and deed.skill in RISINGS)


def _is_surer(deed: Deed, likely: Likely, clause: Clause) -> bool:
    """Whether the table's deed is taken though another is likelier: nobody writes because a letter is taken, nor eats
    because it is crumpled."""
    skill, _ = likely.best
    takes = deed.skill is Skill.TOUCH and bool(deed.row.captions) and clause.verb in theme_words()["taking_verbs"]
    mouthed = likely.captions[likely.best] < MOUTHED and _only_seems(likely.best, clause)
    sits = deed.named and deed.skill is Skill.SITDOWN and skill is Skill.LIEDOWN and clause.verb in ("drop", "sink")
    seems = (takes and skill is not Skill.TOUCH) or mouthed or sits  # "drops on the couch"
    return seems or _says_so(deed, clause) or _falls_into_bed(deed, clause)


def _says_so(deed: Deed, clause: Clause) -> bool:
    """Whether the table has a deed in which hands are seen with a thing, and the clause tells of just that."""
    if clause.verb == "draw" and (pieces_in(clause.text) or not _NOT_DRAWN.isdisjoint(clause.lemmas)):
        return False  # "draws up a bench", "draws a bath"
    own = [one for one in deed.row.captions if any(part in one for part in IN_HANDS)]
    return bool(own) and deed.skill is deed.row.skill and all(shows(deed.skill, one, clause, own=True) for one in own)


def _falls(clause: Clause) -> bool:
    """Whether somebody falls where they are: "trips and falls", not "falls asleep"."""
    return clause.verb in ("fall", "trip", "slip", "tumble", "stumble") and not {"asleep", "sleep", "into"} & {
        *clause.lemmas
    }


def _falls_into_bed(deed: Deed, clause: Clause) -> bool:
    """Whether somebody gets onto a bed in a way that ends lying: "hurls herself onto the bed"."""
    bed = any(group_of(piece) == "bed" for piece in deed.pieces)
    return deed.named and bed and deed.skill is Skill.LIEDOWN and clause.verb in _HURLS


def _only_seems(best: tuple[Skill, str], clause: Clause) -> bool:
    """Whether somebody eats or drinks in what a clause is likeliest shown by, which it does not tell of."""
    return any(part in best[1] for part in ("eating", "drinking")) and not shows(*best, clause, own=True)


@cache
def tempting() -> Mapping[str, frozenset[str]]:
    """Captions whose thing or way everybody knows, with the words that tell of it: data/tempting_captions.toml."""
    known: dict[str, frozenset[str]] = read_table("planner_service", "tempting_captions.toml", dict[str, Words])
    return known


def rises_again(keyframe: Keyframe) -> bool:
    """Whether somebody gets down to the floor in it and is on their feet again at its end."""
    return keyframe.skill is Skill.LOCO and bool(_DOWN.search(keyframe.caption))


def _rising(deed: Deed, likely: Likely) -> Skill:
    """From a seat or a bed: as is named, else as is likelier: "rises with the lark"."""
    if deed.named:
        return deed.skill if any(affords(piece, "lie") for piece in deed.pieces) else Skill.STANDUP
    return max(RISINGS, key=lambda one: likely.of(one, captions()[one.value]))


def _learned(skill: Skill) -> list[str]:
    """The captions of a skill that were learned."""
    return [one for one in captions()[skill.value] if (skill, one) not in captions_of_gestures()]


def seated_as_well(likely: Likely) -> tuple[str, ...]:
    """Ways of sitting that may show what is usually done lying: "nods off"."""
    seated = {one: share for (skill, one), share in likely.captions.items() if skill is Skill.SITDOWN}
    most = max(seated.values())
    return tuple(one for one, share in seated.items() if share >= max(AS_LIKELY * most, SEATED))


def at(likely: Likely, word: str) -> float:
    """How likely hands do it at a piece of furniture."""
    kinds = categories_of(word)
    return max((share for piece, share in likely.pieces.items() if piece in kinds), default=0.0)


def likeliest_pieces(likely: Likely) -> tuple[str, ...]:
    """Furniture where hands likeliest do it."""
    able = [one for one in likely.pieces if one != "floor" and affords(one, "touch")]
    found = [one for one in sorted(able, key=lambda one: -likely.pieces[one])[:PLACES] if likely.pieces[one] > PLACED]
    return tuple(one.replace("_", " ") for one in found)


def shown_by(deed: Deed, mood: Emotion) -> tuple[str, ...]:
    """The captions that show a deed, else those of its skill that show nothing but a mood."""
    own = deed.row.captions if deed.skill is deed.row.skill else deed.row.seated
    return tuple(own or (TOUCHES if deed.skill is Skill.TOUCH else captions_of(deed.skill, mood)))


def learned_row(clause: Clause, likely: Likely) -> DeedRow:
    """What the table of deeds would have for a clause, if it had what was learned."""
    skill, best = likely.best
    least = AS_LIKELY * likely.captions[skill, best]

    def of(other: Skill) -> tuple[str, ...]:
        found = [one for (kind, one), share in likely.captions.items() if kind is other and share >= least]
        return tuple(_idle(other, found, clause) if clause.verb else found)  # "a cup of tea"

    some = of(skill)
    table = skill is Skill.SITDOWN and ("table" in best or "keyboard" in best)
    everything = len(some) > ANY * len(_learned(skill))
    return DeedRow(
        (clause.verb or clause.text,),
        skill,
        at=likeliest_pieces(likely) if skill is Skill.TOUCH else _AT_TABLES if table else (),
        captions=() if everything else some,
        lying=of(Skill.LIEDOWN) if skill is Skill.SITDOWN else (),
        seated=of(Skill.SITDOWN) if skill is Skill.LOCO else (),
        rests=skill in (Skill.SITDOWN, Skill.LIEDOWN),
    )
