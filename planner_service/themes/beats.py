"""A theme becomes beats: who does what, with what, where, in which mood and order of time, and what is not done."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from motion_backend.motion import Emotion
from planner_service.scripts.acted_beats import RESTS
from planner_service.scripts.emotions import feelings
from planner_service.scripts.script import Beat, BeatKind
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar, lemma_of, participle
from planner_service.themes.memories import RECALLING, recalled_in
from planner_service.themes.no_deeds import tells_no_deed
from planner_service.themes.no_theme import asks_for_something, no_prose
from planner_service.themes.outline import lines_of
from planner_service.themes.protagonist import called, head_of, hero_of, is_hero, is_person, tells_of_others
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from planner_service.themes.verb_finder import is_adverb, tokens_of
from planner_service.themes.verb_group import NEARLY
from scene_graphs.errors import UserError
from scene_graphs.furniture import is_known

MAX_THEME_LENGTH: Final = 2000
"""Letters of a theme."""
LANGUAGE: Final = "Themes are read in English."
EXAMPLES: Final = (
    "A person enjoys a relaxed afternoon at home.",
    "A woman searches for her keys, misses the bus, gets angry and then calms down with a book.",
)
_ROOMS: Final = {
    "living_room": r"living[ -]?room|lounge|sitting room",
    "bedroom": r"bed ?rooms?",
    "dining_room": r"dining[ -]?room|kitchen",
    "study": r"study room|(?:in|into|to|from|of) (?:the|his|her|their) (?:study|library|office)|home office",
}
_LEFT: Final = re.compile(r"\b(?:out of|away from|leav\w+|left) (?:the|his|her|their|my) \w+ ?\w*", re.IGNORECASE)
"""Rooms that somebody goes out of are not where it is done."""
_LOUDER: Final = {"stressed": ("drunk", "angry", "sad", "hurried"), "relaxed": ("drunk",)}
"""Moods that a mere hint of another one does not end within a sentence: who is angry paces with anger."""
_MEANWHILE: Final = frozenset(("after", "once", "when", "until", "as"))
"""Joints after which what had been done belongs to the story: "once he had paid, he sat down"."""
_RECEIVERS: Final = frozenset(
    ("phone", "telephone", "receiver", "headset", "handset", "mouthpiece", "intercom", "mobile")
)
"""What is said into these is seen."""
_BY_THEN: Final = re.compile(r"\bby (?:noon|midnight|dawn|dusk|evening|night|now|then|\d+|one|two|three|four|five|six|"
                                r"seven|eight|nine|ten|eleven|twelve)\b", re.IGNORECASE)  # fmt: skip
"""By this what had been done belongs to the story: "by noon she had unpacked"."""
_HELD_THERE: Final = re.compile(
    r"(?:his|her|their|my|one|both) (?:\w+ )?(?:hands?|fingers?|thumb|palms?|wrists?) (?:under|in|on|against) ",
    re.IGNORECASE,
)
"""Where somebody's hands are, without a verb: they hold them there."""
_SETTLING: Final = frozenset(("sleep", "down", "warm", "comfortable"))
"""What somebody who cannot get it is seen trying to get to: "cannot get to sleep"."""
_QUOTED: Final = re.compile(r"«\d+»")
EXPRESSIONS: Final = {
    verb: mood
    for mood, verbs in {
        Emotion.HAPPY: "laugh smile grin giggle chuckle beam sing rejoice whoop",
        Emotion.ANGRY: "yell curse growl scowl snarl shout rant grumble hate detest resent despise",
        Emotion.SAD: "sigh frown sniffle",
        Emotion.STRESSED: "scream shriek tremble sweat panic flinch shudder gasp dread fear worry",
        Emotion.TIRED: "yawn",
        Emotion.DRUNK: "hiccup",
    }.items()
    for verb in verbs.split()
}
"""Verbs that say how somebody feels who does it."""
_CRIES: Final = ("scream", "shriek")
_WEEPS: Final = ("weep", "cry", "sob")
_LAUGHS: Final = ("laugh", "giggle", "chuckle", "cackle")
_TEARS: Final = re.compile(r"\b(?:tears?|cr(?:y|ies|ied|ying)|weeps?|wept|weeping|aches?|hurts?)\b", re.IGNORECASE)
"""Who laughs till these is happy."""
_MADE_UP: Final = re.compile(
    r"^(?:\w+ )?(?:ma(?:kes?|de) (?:it )?up(?! \w+ (?:mind|bed))|say?s?(?:id)? sorry)\b|\btogether(?: again)?$",
    re.IGNORECASE,
)
"""What people do who were angry with each other."""


class ThemeError(UserError):
    """A theme that no story can be made of; the text says what was not understood and what would be."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"{reason} Try for example: " + " Or: ".join(EXAMPLES), at="theme")
        self.reason = reason


@dataclass(frozen=True)
class ReadBeat:
    """A beat as the rules read it, with what of its words the planning goes by."""

    beat: Beat
    clause: Clause
    sure: bool = False
    """Whether a word names its mood; otherwise it is hinted at, or goes on from before."""
    felt: Emotion | None = None
    """The mood that its own words show."""
    room: str | None = None
    """The room it names."""
    hero: str = ""
    """Whom the theme is about, in its words."""

    @property
    def text(self) -> str:
        """The theme's words."""
        return self.beat.text

    def in_mood(self, mood: Emotion) -> ReadBeat:
        """The beat in a mood that was found otherwise."""
        return replace(self, beat=self.beat.model_copy(update={"emotion": mood}), felt=mood)


def clean(theme: object) -> str:
    """The theme without stray white space; ThemeError when it is empty, too long or not text."""
    if not isinstance(theme, str):
        raise ThemeError(f"it is {type(theme).__name__}, not text.")
    if any(unicodedata.category(letter) in ("Cc", "Cs", "Co") and letter not in "\t\n\r" for letter in theme):
        raise ThemeError("it has control characters or bytes that are not text.")
    lines = [" ".join(line.split()) for line in theme.splitlines()]
    text = "\n".join(line for line in lines if line)
    if not text:
        raise ThemeError("it is empty.")
    if len(text) > MAX_THEME_LENGTH:
        raise ThemeError(f"it has {len(text)} letters; at most {MAX_THEME_LENGTH} are read.")
    if not any(letter.isalpha() for letter in text):
        raise ThemeError(f"there is no word in {text[:60]!r}.")
    return text


def beats_of(theme: str) -> tuple[ReadBeat, ...]:
    """What a theme says happens, in the order of time. Raises ThemeError as `clean` does, and for other languages."""
    text = clean(theme)
    lines = lines_of(text)
    if why := no_prose(lines):
        raise ThemeError(f"{text[:60]!r} {why}. {LANGUAGE}")
    clauses = clauses_of_text(text)
    if asks_for_something(lines, clauses):
        raise ThemeError(f"{text[:60]!r} asks for something, and tells of nobody.")
    return read_beats(clauses)


def read_beats(clauses: Sequence[Clause]) -> tuple[ReadBeat, ...]:
    """What clauses say happens to whom they are about."""
    hero = hero_of(clauses)
    pronoun = called(clauses, hero)
    recalled = recalled_in(clauses)
    read = [
        _read(clause, hero, pronoun, tells_of_others(clause, clauses, hero, pronoun), at in recalled)
        for at, clause in enumerate(clauses)
        if clause.verb or not (clause.text.lower() == hero.lower() or _only_says_how(clause))
    ]
    return tuple(_moods(read))


def _only_says_how(clause: Clause) -> bool:
    """Whether words say how something is done, and no mood: "and | slowly | waltzes"."""
    words = [token.low for token in tokens_of(clause.text)]
    return clause.aside and all(map(is_adverb, words)) and not feelings(clause.text)


def _read(clause: Clause, hero: str, pronoun: str, of_others: bool, recalled: bool) -> ReadBeat:
    if not clause.verb and (deed := RESTS.match(clause.text)):  # "then a nap"
        verb = lemma_of(deed[0].split()[-1])
        clause = replace(clause, verb=verb, lemmas=(verb, *clause.lemmas[len(deed[0].split()) :]))
    if not clause.verb and _HELD_THERE.match(clause.text):  # "Her burnt finger under the cold tap"
        clause = replace(clause, verb="hold", lemmas=("hold", *clause.lemmas), aside=False)
    ours = not of_others and (is_hero(clause.doer, hero, pronoun) or _is_it(clause, hero))
    who = "" if clause.aside or ours else clause.doer
    led = bool(who) and bool(clause.subject) and not clause.text.lower().startswith(who.lower())
    text = f"{who} {clause.text}" if led else clause.text
    if clause.aside and clause.subject and clause.subject.lower() not in text.lower():  # "the door slam"
        text = f"{clause.subject} {text}"
    if not clause.verb:
        text = clause.text
    quotes = iter(clause.quotes)
    text = _QUOTED.sub(lambda _: f"“{next(quotes, '')}”", text)
    kind = "memory" if recalled else _kind(clause, who)
    said = f"it {clause.text}" if clause.subject.lower() == "it" else clause.text  # "it is late" is no hurry
    emotion, sure = _emotion(said if clause.verb else text)
    if not sure and clause.subject:
        named, of_subject = _emotion(f"{clause.subject} {clause.text}")  # "a tired student …"
        emotion, sure = (named, True) if of_subject else (emotion, sure)
    laughs = clause.verb in _LAUGHS and _TEARS.search(clause.text)
    if emotion is Emotion.RELAXED and clause.verb in _WEEPS:
        emotion = Emotion.SAD  # who "weeps quietly" is not at peace
    if (laughs or not sure) and not who and (shown := EXPRESSIONS.get(clause.verb)):
        raves = clause.verb in _CRIES and clause.lemmas[1:2] == ("at",)  # fright is at nobody
        emotion, sure = Emotion.ANGRY if raves else shown, True
    if (kind == "deed" or (kind == "feeling" and not sure)) and tells_no_deed(clause):
        kind, clause = "other", replace(clause, aside=clause.subject.lower() == "they")
    alone = {"nobody", "nothing", "none"} & set(clause.lemmas) and {"but", "only"} & set(clause.lemmas)
    emotion = None if alone and not sure else emotion  # "finds nobody there, only a parcel"
    if emotion is None and not who and _is_frightened(clause):
        emotion = Emotion.STRESSED
    hums = bool(who) and clause.verb in (*theme_words()["sounds"], "hum", "sing", "whistle", "purr")
    left = who.lower() in ("nobody", "no one") and clause.verb in theme_words()["missed_verbs"]
    if left:  # "Nobody comes."
        emotion, sure = Emotion.SAD, True
    theirs = not left and (
        hums or is_person(who)
    )  # of what becomes of a dog, or an exam, the story's person feels something
    if theirs or (not sure and kind == "undone" and not clause.unable):
        emotion = None
    beat = Beat(text=_bounded(text), emotion=emotion or Emotion.NEUTRAL, kind=kind, who=_bounded(who, 80))
    clause = replace(clause, text=clause.plainly) if clause.plainly and not who else clause
    return ReadBeat(beat, clause, sure, emotion, next(iter(rooms_in(text)), None), hero)


def _is_frightened(clause: Clause) -> bool:
    """Whether a verb tells of fright, where nothing is done to a thing: "freezes", not "freezes the soup"."""
    on = grammar().prepositions | grammar().adverbs | {"", "and"}
    return clause.verb in theme_words()["fright_verbs"] and (*clause.lemmas[1:2], "")[0] in on


def _is_it(clause: Clause, hero: str) -> bool:
    """Whether "it" is a hero that is called so, and no weather: "a robot sweeps. It dreams"."""
    words = theme_words()
    weather = clause.verb in words["weather"] | words["state_verbs"] | {"", "take"}
    return clause.doer.lower() == "it" and head_of(hero).lower() in words["called_it"] and not weather


def read_beat(beat: Beat) -> ReadBeat:
    """A beat that somebody else found, with what of its words the planning goes by."""
    clauses = clauses_of_text(beat.text)
    clause = clauses[0] if clauses else Clause(beat.text, "", "", ())
    felt = beat.emotion if beat.emotion is not Emotion.NEUTRAL else None
    return ReadBeat(beat, clause, felt is not None, felt, next(iter(rooms_in(beat.text)), None))


def _bounded(text: str, most: int = 300) -> str:
    return text if len(text) <= most else text[:most].rsplit(" ", 1)[0]


def _kind(clause: Clause, who: str) -> BeatKind:
    words = theme_words()
    says = clause.verb in words["speech_verbs"] and words["not_said"].isdisjoint(clause.lemmas)
    quotes = any(len(quote.split()) > 1 or quote[-1] in ".,!?" for quote in clause.quotes)
    quotes = quotes and clause.verb not in words["voiced_verbs"]
    if says or (quotes and _RECEIVERS.isdisjoint(clause.lemmas)):
        return "other" if who else "undone" if clause.denied else "speech"
    if who or (clause.aside and (clause.verb or not is_feeling(clause))):
        return "other"
    staggers = clause.verb in words["falling_verbs"] and clause.text.split()[0].lower() in NEARLY
    settles = not _SETTLING.isdisjoint(clause.lemmas) and clause.verb not in ("sit", "lie")  # "cannot sit down"
    tries = clause.unable and (clause.verb in words["unable_verbs"] or settles)
    if clause.denied and not (staggers or tries):
        return "undone"
    before = clause.perfect and clause.joint not in _MEANWHILE and not _BY_THEN.search(clause.text)
    if before or (clause.verb in words["memory_verbs"] and not clause.unable) or clause.joint == "since":
        return "memory"
    return "feeling" if is_feeling(clause) else "deed"


def is_feeling(clause: Clause) -> bool:
    """Whether a clause says nothing but how somebody feels: "becomes very sad"; or is words without a verb."""
    words = theme_words()
    if not clause.verb and names_a_thing(clause):  # "a birthday cake"
        return False
    if not clause.verb:  # "a cold kitchen" hints at a mood and is none
        says_how = clause.text.split()[0].endswith("ed")  # "Bored stiff, …"
        return any(feeling.sure or says_how for feeling in feelings(clause.text))
    if not words["posed"].isdisjoint(clause.lemmas):
        return False
    if clause.verb in words["wearing_verbs"] and clause.text.lower() == participle(clause.verb):  # "…, exhausted"
        return bool(feelings(clause.text))
    rest = [word for word in clause.lemmas[1:] if word not in words["state_words"]]
    if head_of(clause.subject).lower() in words["body"]:  # "her heart is in her mouth"
        return bool(feelings(f"{clause.subject} {clause.text}"))
    if clause.verb == "turn" and any(one in things() or is_known(one) for one in rest):  # "turns down the lamp"
        return False
    return clause.verb in words["state_verbs"] and bool(feelings(clause.text)) and len(rest) <= 4


def names_a_thing(clause: Clause) -> bool:
    """Whether words without a verb are a thing with its article, and nothing more."""
    words = [token.low for token in tokens_of(clause.text) if token.text[:1].isalpha()]
    known = grammar()
    return (
        len(words) > 1
        and words[0] in known.marks | known.numbers
        and lemma_of(words[-1]) in things()
        and known.prepositions.isdisjoint(words)
    )


def _moods(read: Sequence[ReadBeat]) -> list[ReadBeat]:
    """Each beat in the mood it happens in: what its words show, else the mood before it, which lasts until another.

    "dresses up and feels excited" is excited from the start. What is remembered has its own mood, which ends with it.
    """
    moods: list[ReadBeat] = []
    mood = Emotion.NEUTRAL
    recalled = {one.clause.sentence for one in read if one.beat.kind == "memory"}
    for index, one in enumerate(read):
        after = read[index + 1] if index + 1 < len(read) else None
        together = after is not None and after.clause.sentence == one.clause.sentence
        before = read[index - 1] if index else one
        told = one.clause.joint in RECALLING or (before.beat.kind == "memory" and one.clause.subject != "")
        if one.beat.kind == "memory" or (one.clause.sentence in recalled and told):
            own = one.felt or mood
            moods.append(replace(one, beat=one.beat.model_copy(update={"emotion": own})))
            continue
        if after is not None and together and not one.sure and _is_meanwhile(after):
            one = one.in_mood(after.felt or mood)  # "collapses | giggling"
        if after is not None and together and one.felt is None and _is_settled_for(one, after):
            one = one.in_mood(after.felt or mood)  # "sinks onto the sofa | and cries"
        spoken = index > 0 and before.sure and before.beat.kind == one.beat.kind == "speech"
        if spoken:  # how it is said tells less than what is said: "“I am so happy!” she shouts"
            mood = before.felt or mood
        elif mood is Emotion.ANGRY and (one.clause.verb in theme_words()["calming_verbs"] or _MADE_UP.search(one.text)):
            mood = Emotion.NEUTRAL  # who shrugs is angry no more
        elif one.felt is Emotion.HAPPY and one.clause.verb in theme_words()["finding_verbs"] and not one.sure:
            found = one.beat.model_copy(update={"emotion": mood})  # glad of it, and not on the way to it
            moods.append(replace(one, beat=found))
            mood = one.felt
            continue
        elif mood is Emotion.HAPPY and one.clause.verb in _CRIES and one.clause.lemmas[1:2] != ("at",):
            one = one.in_mood(mood)  # who has won screams for joy
        elif one.felt is Emotion.TIRED and _is_a_thing(one.beat.who):
            pass  # the shelf collapses
        elif one.felt is not None:
            if one.sure or mood not in _LOUDER.get(one.felt, ()) or before.clause.sentence != one.clause.sentence:
                mood = one.felt
        elif mood is Emotion.NEUTRAL and after is not None and together and after.beat.kind == "feeling" and after.felt:
            mood = after.felt
        moods.append(replace(one, beat=one.beat.model_copy(update={"emotion": mood})))
    return moods


def _is_meanwhile(one: ReadBeat) -> bool:
    """Whether a beat tells how somebody looks who does the one before it: "sits there, | crying"."""
    beside = one.clause.joint in ("ing", ",") and not one.clause.subject and one.text.split()[0].endswith("ing")
    return beside and one.sure and one.felt is not None


def _is_a_thing(who: str) -> bool:
    head = lemma_of(head_of(who).lower())
    return head == "it" or head in things() or is_known(head)


def _is_settled_for(one: ReadBeat, after: ReadBeat) -> bool:
    """Whether somebody sits or lies down in the mood that the next beat tells."""
    goes_on = after.clause.joint in ("and", ",") and not after.clause.subject
    return goes_on and after.sure and after.felt is not None and one.clause.verb in theme_words()["settling_verbs"]


def rooms_in(text: str) -> tuple[str, ...]:
    """Room types that the text names, in its order."""
    text = _LEFT.sub("", text)
    found = [
        (match.start(), room) for room, words in _ROOMS.items() if (match := re.search(words, text, re.IGNORECASE))
    ]
    return tuple(room for _, room in sorted(found))


def _emotion(text: str) -> tuple[Emotion | None, bool]:
    """The emotion the words show: drunk if that is named, else the last one named, else the last hint."""
    found = [feeling for feeling in feelings(text) if feeling.emotion != "neutral"]
    named = [feeling.emotion for feeling in found if feeling.sure]
    if Emotion.HAPPY in named and _TEARS.search(text):
        return Emotion.HAPPY, True
    if named:
        return (Emotion.DRUNK if Emotion.DRUNK in named else named[-1]), True
    first = [feeling for feeling in found if feeling.start == 0]  # what is done hints more than what it is done to
    return ([*first, *found[-1:]][0].emotion, False) if found else (None, False)
