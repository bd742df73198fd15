"""A theme becomes beats: who does what, with what, where, in which mood and order of time, and what is not done."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

from motion_backend.motion import Emotion
from planner_service.scripts.emotions import feelings
from planner_service.scripts.script import Beat, BeatKind
from planner_service.themes.lexicon import grammar, is_third_person, lemma_of
from planner_service.themes.protagonist import is_name, pronouns_of
from planner_service.themes.sentence_parser import Clause, clauses_of_text
from planner_service.themes.verb_finder import tokens_of
from scene_graphs.data_tables import read_table, table
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
_LOUDER: Final = {"stressed": ("drunk", "angry", "sad", "hurried"), "relaxed": ("drunk",)}
"""Moods that a mere hint of another one does not end within a sentence: who is angry paces with anger."""
_ASIDE: Final = frozenset(("while", "until", "when", "after", "before", "because", "as", "since"))
"""Joints of clauses that tell more often than others of somebody else."""
_QUOTED: Final = re.compile(r"«\d+»")
EXPRESSIONS: Final = {
    verb: mood
    for mood, verbs in {
        Emotion.HAPPY: "laugh smile grin giggle chuckle beam sing hum whistle rejoice whoop",
        Emotion.ANGRY: "yell scream curse growl scowl snarl shout rant grumble",
        Emotion.SAD: "sigh frown sniffle",
        Emotion.STRESSED: "tremble shake sweat panic flinch shudder gasp",
        Emotion.TIRED: "yawn",
        Emotion.DRUNK: "hiccup",
    }.items()
    for verb in verbs.split()
}
"""Verbs that say how somebody feels who does it."""
_CODE: Final = re.compile(r"[{}<>;=\[\]_|\\^*/+]")
_MAIN_JOINTS: Final = frozenset(("", ",", "and", "but", "so", "then", "to", "ing"))
"""What joins main clauses: whom a theme is about does what these tell."""
_FIRST_PERSON: Final = frozenset(("i", "we", "me", "my", "you"))
_PRONOUNS: Final = {"he": "he", "she": "she", "they": "they", "who": ""}


class ThemeError(UserError):
    """A theme that no story can be made of; the text says what was not understood and what would be."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"{reason} Try for example: " + " Or: ".join(EXAMPLES), at="theme")
        self.reason = reason


@table
class ThemeWords:
    """data/theme_words.toml: words by which the rules read themes; base forms, apart by spaces."""

    people: str
    """Nouns for people."""
    person_endings: tuple[str, ...]
    """Endings of nouns for people who do something: "-er" only where what is left is a verb."""
    memory_verbs: str
    speech_verbs: str
    not_said: str
    """What is answered or said with more than words."""
    unable_verbs: str
    """What somebody who cannot do it is seen trying: "cannot sleep"."""
    no_heroes: str
    """Nouns for what does things and is nobody a theme is about."""
    body: str
    """Parts of a person: what these do, the person does."""
    thought_verbs: str
    """What goes on in a head; a body shows none of it but thinking."""
    state_verbs: str
    """Verbs that only say how somebody is or feels."""
    posed: str
    """States that a body is seen in: whoever is asleep lies."""
    state_words: str
    """Words that say no more when they stand beside a feeling."""
    foreign: str
    """The commonest words of other languages that are no English words."""

    @property
    def sets(self) -> dict[str, frozenset[str]]:
        """Every list as a set."""
        return {name: frozenset(words.split()) for name, words in vars(self).items() if isinstance(words, str)}


@cache
def theme_words() -> dict[str, frozenset[str]]:
    """The lists of `ThemeWords`."""
    known: ThemeWords = read_table("planner_service", "theme_words.toml", ThemeWords)
    return known.sets


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
    _refuse_foreign(text)
    return read_beats(clauses_of_text(text))


def read_beats(clauses: Sequence[Clause]) -> tuple[ReadBeat, ...]:
    """What clauses say happens to whom they are about."""
    hero = hero_of(clauses)
    return tuple(_moods([_read(clause, hero) for clause in clauses]))


def _read(clause: Clause, hero: str) -> ReadBeat:
    if head_of(clause.doer).lower() in ("tear", "tears"):  # they run where somebody weeps
        clause = replace(clause, verb="weep", lemmas=("weep", *clause.lemmas[1:]))
    who = "" if is_hero(clause.doer, hero) else clause.doer
    led = bool(who) and bool(clause.subject) and not clause.text.lower().startswith(who.lower())
    text = f"{who} {clause.text}" if led else clause.text
    if not clause.verb:
        text = clause.text
    quotes = iter(clause.quotes)
    text = _QUOTED.sub(lambda _: f"“{next(quotes, '')}”", text)
    kind = _kind(clause, who)
    said = f"it {clause.text}" if clause.subject.lower() == "it" else clause.text  # "it is late" is no hurry
    emotion, sure = _emotion(said if clause.verb else text)
    if not sure and clause.subject:
        named, of_subject = _emotion(f"{clause.subject} {clause.text}")  # "a tired student …"
        emotion, sure = (named, True) if of_subject else (emotion, sure)
    if not sure and not who and (shown := EXPRESSIONS.get(clause.verb)):
        emotion, sure = shown, True
    if kind in ("other", "undone") and not sure:
        emotion = None
    beat = Beat(text=_bounded(text), emotion=emotion or Emotion.NEUTRAL, kind=kind, who=_bounded(who, 80))
    return ReadBeat(beat, clause, sure, emotion, next(iter(rooms_in(text)), None))


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
    if clause.quotes or (clause.verb in words["speech_verbs"] and words["not_said"].isdisjoint(clause.lemmas)):
        return "speech" if not who else "other"
    if who:
        return "other"
    if clause.denied and not (clause.unable and clause.verb in words["unable_verbs"]):
        return "undone"
    if clause.perfect or clause.verb in words["memory_verbs"] or clause.joint == "since":
        return "memory"
    return "feeling" if is_feeling(clause) else "deed"


def is_feeling(clause: Clause) -> bool:
    """Whether a clause says nothing but how somebody feels: "becomes very sad"; or is words without a verb."""
    words = theme_words()
    if not clause.verb:
        return bool(feelings(clause.text))
    if not words["posed"].isdisjoint(clause.lemmas):
        return False
    rest = [word for word in clause.lemmas[1:] if word not in words["state_words"]]
    own = (
        f"{clause.subject} " if head_of(clause.subject).lower() in words["body"] else ""
    )  # "her heart is in her mouth"
    return clause.verb in words["state_verbs"] and bool(feelings(own + clause.text)) and len(rest) <= 4


def hero_of(clauses: Sequence[Clause]) -> str:
    """Whom the theme is about, as it is written first: the narrator, else the person that its pronouns fit best."""
    told = [clause for clause in clauses if clause.subject]
    mains = [clause.subject for clause in told if clause.joint in _MAIN_JOINTS]
    if any(clause.subject.lower() == "i" for clause in told):
        return "I"
    if mains and mains[0].lower() == "you":
        return "you"
    people = [clause for clause in told if is_person(clause.subject)]
    pronoun = next((one.subject.lower() for one in people if one.subject.lower() in ("he", "she")), "")
    first = min(((one.sentence, one.place) for one in people if _is_pronoun(one.subject)), default=(len(clauses), 0))
    nouns = [
        one
        for one in people
        if not _is_pronoun(one.subject)
        and (one is told[0] or not _is_possessed(one.subject))
        and (one.joint not in _ASIDE or (one.sentence, one.place) < first)
    ]
    if nouns:
        return max(nouns, key=lambda clause: _heroic(clause, pronoun)).subject
    opens = ("a ", "an ", "one ", "my ", "our ", *(() if people else ("the ",)))
    living = [subject for subject in mains[:1] if subject.lower().startswith(opens) and _may_live(head_of(subject))]
    return next(iter([*living, *(clause.subject for clause in people)]), "")


def _heroic(clause: Clause, pronoun: str) -> int:
    """How well a subject may be whom a theme is about, whose pronoun is "he", "she" or unknown."""
    own = pronouns_of(clause.subject)
    fits = 0 if not (pronoun and own) else 4 if own == pronoun else -8
    return (
        fits
        - 2 * _is_possessed(clause.subject)
        - 2 * (bool(pronoun) and _is_plural(clause.subject))
        - (clause.joint in _ASIDE)
    )


def _is_possessed(subject: str) -> bool:
    return subject.split()[0].lower() in ("his", "her", "their", "my", "its")


def _may_live(head: str) -> bool:
    return not is_known(head) and head.lower() not in theme_words()["no_heroes"]


def _is_pronoun(subject: str) -> bool:
    return subject.lower() in grammar().subjects


def _is_plural(subject: str) -> bool:
    head = head_of(subject).lower()
    return head.endswith("s") and lemma_of(head) != head


def is_person(subject: str) -> bool:
    """Whether words may name a person: a pronoun, a name, or a noun for people."""
    words = [token.text for token in tokens_of(subject)]
    if not words:
        return False
    if words[-1].lower() in _PRONOUNS or words[-1].lower() in _FIRST_PERSON:
        return True
    people = theme_words()["people"]
    if words[0].lower() in people:  # "someone sick with the flu"
        return True
    head = head_of(subject)
    if head.lower() in people or lemma_of(head) in people:
        return True
    if any(is_name(word) for word in words) and words[0].lower() not in ("the", "a", "an"):
        return True
    if len(head) > 4 and head.endswith(("er", "or")):  # a "baker" is one who bakes
        stem = head.lower()[:-2]
        return is_third_person(f"{stem}s") or is_third_person(f"{stem}es")
    return len(head) > 5 and head.lower().endswith(("ist", "ian", "man", "woman", "person", "ress"))


def head_of(subject: str) -> str:
    """The noun of a subject: "the old nurse after her shift" is "nurse", "a boy of six" is "boy"."""
    words: list[str] = []
    for token in tokens_of(subject):
        if words and (token.low in grammar().prepositions or token.low in ("of", "who", "and", ",")):
            break
        words.append(token.text)
    return words[-1] if words else ""


def is_hero(subject: str, hero: str) -> bool:
    """Whether a subject is whom the theme is about. Nobody named: it goes on with who it was about."""
    if not subject or subject.lower() == hero.lower():
        return True
    if subject.lower() == "one" and _is_plural(hero):  # of several people the one is played who does something
        return True
    low, main = subject.split()[-1].lower(), hero.split()[-1].lower() if hero else ""
    if low in _FIRST_PERSON:
        return main in _FIRST_PERSON or not main
    if low in _PRONOUNS:
        return low in ("they", "who") or pronouns_of(hero) in ("", low)
    if head_of(subject).lower() in theme_words()["body"]:
        return True
    if hero and head_of(subject).lower() == head_of(hero).lower():
        return True
    if not is_person(subject):
        return False
    if not hero or hero.lower() in _PRONOUNS:
        called = pronouns_of(subject) in ("", hero.lower()) or hero.lower() not in ("he", "she")
        return subject[:1].isupper() and " " not in subject and called
    if main in _FIRST_PERSON:
        return False
    mine, theirs = head_of(subject).lower(), head_of(hero).lower()
    return mine == theirs or hero.lower() in subject.lower()


def _refuse_foreign(text: str) -> None:
    words = [token.low for token in tokens_of(text) if token.text[:1].isalpha()]
    foreign = [word for word in words if word in theme_words()["foreign"]]
    if not any(re.search(r"[a-z]", word) for word in words) or len(foreign) >= max(2, 0.2 * len(words)):
        raise ThemeError(f"{text[:60]!r} is not English. {LANGUAGE}")
    if len(_CODE.findall(text)) > max(3, len(words) / 3):
        raise ThemeError(f"{text[:60]!r} is no prose. {LANGUAGE}")


def _moods(read: Sequence[ReadBeat]) -> list[ReadBeat]:
    """Each beat in the mood it happens in: what its words show, else the mood before it, which lasts until another.

    "dresses up and feels excited" is excited from the start.
    """
    moods: list[ReadBeat] = []
    mood = Emotion.NEUTRAL
    for index, one in enumerate(read):
        after = read[index + 1] if index + 1 < len(read) else None
        together = after is not None and after.clause.sentence == one.clause.sentence
        if one.felt is not None:
            before = read[index - 1] if index else one
            if one.sure or mood not in _LOUDER.get(one.felt, ()) or before.clause.sentence != one.clause.sentence:
                mood = one.felt
        elif mood is Emotion.NEUTRAL and after is not None and together and after.beat.kind == "feeling" and after.felt:
            mood = after.felt
        moods.append(replace(one, beat=one.beat.model_copy(update={"emotion": mood})))
    return moods


def rooms_in(text: str) -> tuple[str, ...]:
    """Room types that the text names, in its order."""
    found = [
        (match.start(), room) for room, words in _ROOMS.items() if (match := re.search(words, text, re.IGNORECASE))
    ]
    return tuple(room for _, room in sorted(found))


def _emotion(text: str) -> tuple[Emotion | None, bool]:
    """The emotion the words show: drunk if that is named, else the last one named, else the last hint."""
    found = [feeling for feeling in feelings(text) if feeling.emotion != "neutral"]
    named = [feeling.emotion for feeling in found if feeling.sure]
    if named:
        return (Emotion.DRUNK if Emotion.DRUNK in named else named[-1]), True
    first = [feeling for feeling in found if feeling.start == 0]  # what is done hints more than what it is done to
    return ([*first, *found[-1:]][0].emotion, False) if found else (None, False)
