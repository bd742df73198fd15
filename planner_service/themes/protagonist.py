"""Who a theme is about, what is theirs to do, and the name and the pronouns it calls them by."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cache, lru_cache
from itertools import groupby, takewhile
from typing import Final

from motion_backend.motion import Character
from planner_service.scripts.script import MAX_NAME_LENGTH
from planner_service.themes.asides import ARTICLES, OWNERS
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar, is_third_person, is_verb, kinds_of, lemma_of
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from planner_service.themes.verb_finder import NAMING, is_plural, tokens_of
from scene_graphs.furniture import is_known

_PRONOUN: Final = re.compile(r"\b(?:(?P<she>she|her|herself)|(?P<he>he|him|his|himself))\b", re.IGNORECASE)
_SUBJECT: Final = re.compile(r"\b(?:(?P<she>she)|(?P<he>he))\b", re.IGNORECASE)
_THEY: Final = re.compile(r"\b(?:they|their|themsel(?:f|ves))\b", re.IGNORECASE)
_KINDS: Final = re.compile(
    r"^(?:\W*(?:an?|the|this|one|our|my|his|her|their|some|old|young|tired|little|lonely|happy|sad|elderly|busy|single)\s+)*(?:"
    r"(?P<she>woman|girl|lady|mother|mum|mom|grandmother|grandma|granny|widow|wife|daughter|sister|aunt|nun|actress"
    r"|queen|bride|waitress)"
    r"|(?P<he>man|boy|guy|gentleman|father|dad|grandfather|grandpa|widower|husband|son|brother|uncle|monk|king|groom))\b",
    re.IGNORECASE,
)
_CAPITALISED: Final = re.compile(
    r"(?P<before>^|[.!?]\s+|\S\s+)(?P<name>[A-Z][a-zà-öø-ÿ]{1,19})\s+(?=(?P<verb>[a-z]+)\b)"
)
_ASIDE: Final = frozenset(("while", "until", "when", "after", "before", "because", "as", "since", "once"))
"""Joints of clauses that tell more often than others of somebody else."""
_MAIN_JOINTS: Final = frozenset(("", ",", "and", "but", "so", "then", "to", "ing"))
"""What joins main clauses: whom a theme is about does what these tell."""
_OWNED: Final = re.compile(r"^(?P<owner>.*)['’]s (?=\w)")
_SOMEBODY: Final = ("somebody", "someone")
_FIRST_PERSON: Final = frozenset(("i", "we", "me", "my", "you"))
_TOGETHER: Final = frozenset(("couple", "pair", "family", "newlyweds"))
"""What whom a theme is about is one of."""
_SUBJECTS: Final = frozenset(("he", "she", "they", "who"))


@cache
def _pronouns_by_list(listed: str) -> dict[str, str]:
    """The pronouns that first "names", or "titles", tell; "they" for those of anybody."""
    words = theme_words()
    return {word: pronouns for pronouns in ("she", "he", "they") for word in words[f"{listed}_{pronouns}"]}


def cast_by(theme: str, character: Character) -> Character:
    """The character, renamed after the theme where its name and its pronouns were both left at their defaults."""
    default = Character()
    if (character.name, character.pronouns) != (default.name, default.pronouns):
        return character
    clauses = clauses_of_text(theme)
    hero = hero_of(clauses)
    told = called(clauses, hero)
    mine = hero.lower() in _FIRST_PERSON
    name = _called_as(hero, told) or ("" if mine else _named_beside(theme, clauses, told))
    listed = _pronouns_by_list("names").get(name.lower(), "")
    own = told or pronouns_of(hero) or pronouns_of(f"the {head_of(hero)}") or listed.replace("they", "")
    beside = "" if mine or (listed and _THEY.search(theme)) else _pronouns_in(theme, is_name(name))
    pronouns = own or beside or listed or default.pronouns
    return replace(character, name=name or default.name, pronouns=pronouns)


def _called_as(hero: str, pronoun: str) -> str:
    """What to call whom a theme is about: by name ("Mr. Brown", "Aunt Rosa"), else as the theme does ("the old man",
    "my sister"); "" for "she", "I" and "a person"."""
    one = _each_of(hero, pronoun)[0].split()
    name = _name_among(one) or ("" if _is_pronoun(hero) else _noun_as_told(one))
    return name if len(name) <= MAX_NAME_LENGTH else f"the {head_of(hero)}"[:MAX_NAME_LENGTH]


def _each_of(hero: str, pronoun: str) -> list[str]:
    """The people of a subject, the one that is played first: whom the theme calls by the pronoun, else the first."""
    words = [token.text for token in tokens_of(hero)]
    each = [" ".join(part) for is_and, part in groupby(words, lambda word: word in ("and", ",")) if not is_and]
    return sorted(each or [""], key=lambda one: not pronoun or pronouns_of(one) != pronoun)


def _is_called_so(subject: str, person: str) -> bool:
    """Whether a subject means one of several people: "Karim", or "the brother", of "her brother Karim"."""
    name = _name_among(subject.split())
    same = name == _name_among(person.split()) if name else head_of(subject).lower() == head_of(person).lower()
    return bool(subject) and not _is_pronoun(subject) and same


def _name_among(words: Sequence[str]) -> str:
    """The name among the words of a subject, with its title: "Mrs. Hill" of "old Mrs. Hill", "Bolt" of "a robot named
    Bolt"."""
    told = next((at for at, word in enumerate(words) if word.lower() in NAMING), len(words))
    if told + 1 < len(words):
        return " ".join(takewhile(lambda one: one[:1].isupper(), words[told + 1 :]))
    for at, word in enumerate(words[:-1]):
        if _is_title(word) and words[at + 1][:1].isupper():
            return " ".join([word, *takewhile(lambda one: one[:1].isupper(), words[at + 1 :])])
    names = [word for word in words if is_name(word) and word.lower() not in OWNERS]
    return " ".join(word for word in names if not word.endswith(("'s", "’s")))


def _noun_as_told(words: Sequence[str]) -> str:
    """What a subject calls somebody who has no name: "the boy" for "a boy of six"; "" for "a person"."""
    noun = _noun_in(words)
    if not noun or noun[-1].lower() in theme_words()["anybody"]:
        return ""
    first, *rest = noun[0].lower(), *noun[1:]
    if first in ("my", "our"):
        return " ".join([first, *rest])
    if rest and noun[0].endswith(("'s", "’s")):
        return " ".join(noun)
    if first in ARTICLES | OWNERS | {"one", "some", "this", "that"}:
        return " ".join(["the", *rest])
    is_called = not rest and pronouns_of(first)  # "Grandma knits"
    return first.capitalize() if is_called else " ".join(["the", first, *rest])


def _noun_in(words: Sequence[str]) -> list[str]:
    """The words of a subject up to its noun: "a boy" of "a boy of six"."""
    head = head_of(" ".join(words))
    return list(words[: words.index(head) + 1]) if head in words else []


def _is_title(word: str) -> bool:
    titles = _pronouns_by_list("titles").keys() | theme_words()["people"]
    return word[:1].isupper() and word.lower().rstrip(".") in titles


def _named_beside(theme: str, clauses: Sequence[Clause], pronoun: str) -> str:
    """The first name that does something, or whose it is that does, and may be whom a pronoun stands for; or ""."""
    doing = [one["name"] for one in _CAPITALISED.finditer(theme) if is_verb(one["verb"])]
    owning = [re.sub(r"['’]s$", "", one.subject.split()[0]) for one in clauses if re.match(r"\w+['’]s\s", one.subject)]
    fitting = (name for name in doing + owning if is_name(name))
    return next((name for name in fitting if not pronoun or pronouns_of(name) in ("", pronoun)), "")


def is_name(word: str) -> bool:
    """Whether a word is a name: one that we know, or one with a capital that no dictionary has."""
    low = word.lower()
    known = kinds_of(low) or low in things() or not _not_names().isdisjoint((low, low.removesuffix("s")))  # "Mondays"
    return word[:1].isupper() and (low in _pronouns_by_list("names") or not known)


@lru_cache(maxsize=2_000)
def pronouns_of(subject: str) -> str:
    """ "he" or "she" for a person whose name or noun tells: "Anna", "the old man", "Mrs. Hill"; else ""."""
    subject = _OWNED.sub("", subject) if _is_somebodys(subject) else subject  # "Tom's mother" is she
    words = re.findall(r"[^\W\d_]+", subject.lower())
    titles, names = _pronouns_by_list("titles"), _pronouns_by_list("names")
    known = (word if word in ("he", "she") else titles.get(word) or names.get(word) for word in words)
    return next((one for one in known if one in ("he", "she")), "") or _pronouns_by(_KINDS, subject)


@cache
def _not_names() -> frozenset[str]:
    words = grammar()
    return theme_words()["capitals"].union(
        words.marks, words.subjects, words.prepositions, words.joints, words.adverbs, words.auxiliaries, words.numbers
    )


def _pronouns_in(theme: str, named: bool) -> str:
    """The pronouns of the theme's person: those of the noun that opens it, else the first that stands in it."""
    patterns = ([] if named else [_KINDS]) + [_SUBJECT, _PRONOUN]
    return next((told for pattern in patterns if (told := _pronouns_by(pattern, theme))), "")


def _pronouns_by(pattern: re.Pattern[str], text: str) -> str:
    found = pattern.search(text)
    return "" if found is None else "she" if found["she"] else "he"


_AT_DOORS: Final = ("knock", "ring", "call")
"""What somebody does outside, of whom nobody tells more: "somebody knocks, and he gets up"."""


def hero_of(clauses: Sequence[Clause]) -> str:
    """Whom the theme is about, as it is written first: the narrator, else the person that its pronouns fit best."""
    pronoun = _told_most(clauses)
    told = [one for one in clauses if one.subject and not (one.aside or (pronoun and _is_infant(one.subject)))]
    mains = [clause.subject for clause in told if clause.joint in _MAIN_JOINTS]
    if any(clause.subject.lower() == "i" for clause in told):
        return "I"
    if mains and mains[0].lower() == "you":
        return "you"
    people = [clause for clause in told if is_person(clause.subject) and not _are_things(clause, told)]
    others = [one for one in people if one.subject.lower() in _SOMEBODY and pronoun]
    people = [one for one in people if one not in others or (one is told[0] and one.verb not in _AT_DOORS)]
    done = (one for one in clauses if not (one.aside or one.joint == "to" or (one.denied and not one.unable)))
    deeds = Counter(one.doer for one in done)
    first = min(((one.sentence, one.place) for one in people if _stands_for(one.subject)), default=(len(clauses), 0))
    nouns = [one for one in people if not _stands_for(one.subject)
             and ((one.sentence, one.place) < first or is_name(one.subject.split()[0]))]  # fmt: skip
    # not "the doctor having gone"
    nouns = [one for one in nouns if not one.absolute or _has_name(one.subject)] or nouns
    nouns = [one for one in nouns if pronouns_of(one.subject) in ("", pronoun or pronouns_of(one.subject))] or nouns
    nouns = _without_visitors(nouns, deeds)
    nouns = [] if pronoun and all(_is_plural(one.subject) and one.joint in _ASIDE for one in nouns) else nouns
    if nouns:
        hero = max(nouns, key=lambda one: _heroic(one, pronoun) + min(deeds[one.subject], 4)).subject
        theirs = {"her": "she", "his": "he"}.get(hero.split()[0].lower(), "")
        if theirs and theirs == pronoun and (not is_name(head_of(hero)) or pronouns_of(hero) != pronoun):
            return pronoun.capitalize()  # "Her mother calls. | She | lets it ring"
        return _owner_of(hero) if pronoun and pronouns_of(hero) not in ("", pronoun) else hero
    opening = ("a ", "an ", "one ", "my ", "our ", "the ")
    called = not people and " " not in "".join(mains[:1]) and is_name("".join(mains[:1]))  # "Rose", "Wen"
    sooner = [(one.sentence, one.place) < first for one in told if one.joint in _MAIN_JOINTS][:1] == [True]
    by_pronoun = _deeds_by(clauses, ("he", "she"))
    living = [one for one in mains[:1] if sooner and (called or one.lower().startswith(opening)) and _may_live(one)]
    less = {who for who, times in by_pronoun.items() if 2 * times < by_pronoun[pronoun]}
    people.sort(key=lambda one: (bool(pronoun) and _is_several(one.subject), one.subject.lower() in less,
                                 one.sentence, one.place))  # fmt: skip
    # Whom no list knows does most: "Rex, soft as butter, comes home, kneels to tickle the puppy".
    busy = [who for who, times in deeds.most_common() if times > 1 and who.istitle() and _may_live(who)]
    return next(iter([*living, *(one.subject for one in people), *(who for who in busy if " " not in who)]), "")


def _are_things(clause: Clause, told: Sequence[Clause]) -> bool:
    """Whether "they" are things, which alone were told of before: "The keys are gone. | They | were here"."""
    before = [one.subject for one in told if (one.sentence, one.place) < (clause.sentence, clause.place)]
    return (
        clause.subject.lower() == "they"
        and any(lemma_of(head_of(one)) in things() and _is_plural(one) for one in before)
        and not any(is_person(one) and one.lower() != "they" for one in before)
    )


def _without_visitors(people: Sequence[Clause], deeds: Counter[str]) -> list[Clause]:
    """Those that do things, without whoever only comes by, where somebody with a name does as much: not "the boy next
    door", who returns the drill, but Anselm, who thanks him."""
    named = [deeds[one.subject] for one in people if not _comes_by(one.subject) and _has_name(one.subject)]
    most = max(named, default=0)
    kept = [one for one in people if not _comes_by(one.subject) or deeds[one.subject] > most]
    return kept if named else list(people)


def _is_somebodys(subject: str) -> bool:
    """Whether it is somebody who is called after whose they are: "Tom's mother", not "Tom's voice"."""
    head = head_of(subject).lower()
    return _OWNED.match(subject) is not None and not theme_words()["people"].isdisjoint((head, lemma_of(head)))


def _owner_of(subject: str) -> str:
    """Whose somebody is, who is not the one that pronouns tell of: "Mr Novak" of "Mr Novak's wife is away. He reads";
    somebody as they are called where it is nobody's."""
    owned = _OWNED.match(subject)
    return owned["owner"] if owned and _is_somebodys(subject) and is_person(owned["owner"]) else subject


def _comes_by(subject: str) -> bool:
    """Whether somebody is called after whose they are, or what brings them: "her mother", "a courier"."""
    words = [token.low for token in tokens_of(subject)]
    head, near = head_of(subject).lower(), " ".join(words)
    owned = words[0] in OWNERS or any(word.endswith(("'s", "’s")) for word in words)
    return owned or head in theme_words()["visitors"] or near.endswith(("next door", "upstairs", "downstairs"))


def _has_name(subject: str) -> bool:
    words = [token.text for token in tokens_of(subject)]
    return bool(_name_among(words))


def _told_most(clauses: Sequence[Clause]) -> str:
    """The pronoun that does most of what is done, the first of two that do as much; "" where there is none."""
    return next((pronoun for pronoun, _ in _deeds_by(clauses, ("he", "she")).most_common(1)), "")


def _deeds_by(clauses: Sequence[Clause], pronouns: Collection[str]) -> Counter[str]:
    doers = (one.doer.lower() for one in clauses if not one.aside)
    return Counter(doer for doer in doers if doer in pronouns)


def called(clauses: Sequence[Clause], hero: str) -> str:
    """The pronoun by which clauses call whom they are about: as the name tells, else the one that does most.

    Who tells of somebody else is not the one that is played: "I want a film of a man. He comes in, he sits down".
    """
    most = _told_most(clauses)
    if hero.lower() in _FIRST_PERSON and _deeds_by(clauses, ("he", "she"))[most] <= _deeds_by(clauses, ("i",))["i"]:
        return ""
    if most and _is_listed(hero) and _by_what_is_theirs(clauses, hero) == pronouns_of(hero):
        return pronouns_of(hero)
    if most and _is_listed(hero) and not any(_may_be(one.subject, hero, most) for one in clauses):
        return most  # what a theme says tells more than a list of names
    return pronouns_of(hero) or most


def _by_what_is_theirs(clauses: Sequence[Clause], hero: str) -> str:
    """The pronoun that a hero's own deeds tell: Oskar, who "burps her on his shoulder", is he; "" where none does."""
    own = {word for one in clauses if one.doer == hero for word in one.lemmas}
    return "he" if not {"his", "himself"}.isdisjoint(own) else "she" if "herself" in own else ""


def _is_listed(hero: str) -> bool:
    """Whether it is a mere name that a list has."""
    return hero.lower() in _pronouns_by_list("names")


def _may_be(subject: str, hero: str, pronoun: str) -> bool:
    """Whether a subject is somebody else whom a pronoun may mean, or the other pronoun."""
    if subject.lower() in ("he", "she"):
        return subject.lower() != pronoun
    return bool(subject) and subject != hero and is_person(subject) and pronouns_of(subject) in ("", pronoun)


def _heroic(clause: Clause, pronoun: str) -> float:
    """How well a subject may be whom a theme is about, whose pronoun is "he", "she" or unknown."""
    own, first = pronouns_of(clause.subject), clause.subject.split()[0].lower()
    owned = first in OWNERS  # "her mum" is somebody else than she
    fits = 4 * bool(pronoun and own == pronoun and not owned)
    several = _is_plural(clause.subject)
    nobody = head_of(clause.subject).lower() in theme_words()["anybody"] - {"person", "character"}
    small = nobody or _is_infant(clause.subject)
    return fits - small - 2 * owned - (1 + bool(pronoun)) * several / 2 - (clause.joint in _ASIDE)


def _is_infant(subject: str) -> bool:
    return head_of(subject).lower() in theme_words()["infants"]


def _may_live(subject: str) -> bool:
    """Whether a subject that is no known person may be one: no thing, animal or weather."""
    head = head_of(subject)
    lifeless = theme_words()["no_heroes"] | theme_words()["body"] | frozenset(things()) | grammar().subjects
    near = subject.lower().split(f" {head.lower()}")[0].split()[-1:]  # "a power cut"
    return not is_known(head) and lifeless.isdisjoint((head.lower(), lemma_of(head), *near))


def _stands_for(subject: str) -> bool:
    """Whether a subject stands for somebody: "she", not "someone"."""
    return _is_pronoun(subject) and subject.lower() not in theme_words()["anybody"]


def _is_pronoun(subject: str) -> bool:
    return subject.lower() in grammar().subjects


def _is_plural(subject: str) -> bool:
    return is_plural(head_of(subject).lower())


def _is_several(subject: str) -> bool:
    return subject.lower() == "they" or _is_plural(subject)


def is_person(subject: str) -> bool:
    """Whether words may name a person: a pronoun, a name, or a noun for people."""
    words = [token.text for token in tokens_of(subject)]
    if head_of(subject)[:1].islower():  # "Carla's dog"
        words = [word for word in words if not word.endswith(("'s", "’s"))]
    if not words:  # "there's", which is somebody's nothing
        return False
    if words[-1].lower() in _SUBJECTS or words[-1].lower() in _FIRST_PERSON:
        return True
    people = theme_words()["people"]
    if words[0].lower() in people:  # "someone sick with the flu"
        return True
    head = head_of(subject)
    if head.lower() in people or lemma_of(head) in people:
        return True
    if words and any(is_name(word) for word in words) and words[0].lower() not in ("the", "a", "an"):
        return True
    made = is_known(head) or lemma_of(head) in things()
    if len(head) > 4 and head.endswith(("er", "or")) and not made:  # a "baker" is one who bakes
        stem = head.lower()[:-2]
        return any(kinds_of(verb) and is_third_person(verb) for verb in (f"{stem}s", f"{stem}es"))
    return len(head) > 5 and head.lower().endswith(("ist", "ian", "man", "woman", "person", "ress", "naut"))


def names_somebody(clause: Clause) -> bool:
    """Whether a person does what a clause tells, or is named in one without a verb."""
    if clause.verb:
        return is_person(clause.doer)
    words = [token.text for token in tokens_of(clause.text)]
    return any(word.lower() in theme_words()["people"] or word.lower() in _pronouns_by_list("names") for word in words)


def is_hero(subject: str, hero: str, pronoun: str = "") -> bool:
    """Whether a subject is whom the theme is about, whom it calls by a pronoun. Nobody named: it goes on with who it
    was about."""
    mine, *others = _each_of(hero, pronoun)
    if any(_is_called_so(subject, one) for one in others):
        return False  # of "Nadia and her brother Karim" what Karim does
    if others and _is_called_so(subject, mine):
        return True
    name = _name_among([token.text for token in tokens_of(mine)])
    if not subject or subject.lower() in (hero.lower(), name.lower()):
        return True
    if subject.lower().endswith(("both of them", "all of them", "two of them", "both of us")):
        return True
    low, main = subject.split()[-1].lower(), hero.split()[-1].lower() if hero else ""
    if main == "i" and low in _SUBJECTS - {"who"}:
        return low == pronoun
    if low in _FIRST_PERSON:
        return low == "we" or main in _FIRST_PERSON or not main  # "Dad plays with me, and | we | laugh"
    if low in _SUBJECTS:
        return low in ("they", "who") or (pronoun or pronouns_of(hero)) in ("", low)
    if head_of(subject).lower() in theme_words()["body"]:
        return True
    if not is_person(subject):
        return False
    if hero and head_of(subject).lower() in _TOGETHER:
        return True  # "the couple quarrel: Joanna shouts"
    if not hero or hero.lower() in _SUBJECTS:
        called = pronouns_of(subject) in ("", hero.lower()) or hero.lower() not in ("he", "she")
        return subject[:1].isupper() and " " not in subject and called and subject.lower() not in _SOMEBODY
    if main in _FIRST_PERSON:
        return False
    mine, theirs = head_of(subject).lower(), head_of(hero).lower()
    return mine == theirs or re.search(rf"\b{re.escape(hero)}(?!['’\w])", subject, re.IGNORECASE) is not None


def tells_of_others(clause: Clause, clauses: Sequence[Clause], hero: str, pronoun: str) -> bool:
    """Whether the "they" of a clause are several people named before it, and not whom a theme calls he or she; or
    nobody has been named: "before they arrive he sets the table"."""
    if clause.doer.lower() != "they" or pronoun not in ("he", "she"):
        return False
    before = [one for one in clauses if (one.sentence, one.place) < (clause.sentence, clause.place)]
    people = theme_words()["people"]
    words = [token.low for one in before for token in tokens_of(f"{one.subject} {one.text}")]
    several = any(lemma_of(word) in people and lemma_of(word) != word for word in words)
    several |= not before and clause.joint in _ASIDE
    return several and not re.search(r"\band\b", hero)


@lru_cache(maxsize=1024)
def head_of(subject: str) -> str:
    """The noun of a subject: "the old nurse after her shift" is "nurse", "a boy of six" is "boy"."""
    words: list[str] = []
    for token in tokens_of(re.sub(r"\bback (?:home|from|at|in)\b.*", "", subject)):
        stops = grammar().prepositions | grammar().adverbs | NAMING | {"of", "who", "and", ","}
        if words and token.low in stops:
            break
        words.append(token.text)
    return words[-1] if words else ""
