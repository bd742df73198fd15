"""English verbs and their forms, and sayings that mean something else than their words: both are data.

One list of verbs serves the reading of themes, which must tell an event from a noun, and the telling of stories.
"""

from __future__ import annotations

import re
from functools import cache, cached_property

from planner_service.themes.patterns import compiled, expanded, with_parts
from scene_graphs.data_tables import read_table, require_known, require_unlike, table


@table
class EnglishVerbs:
    """data/english_verbs.toml: words apart by spaces."""

    regular: str
    irregular: str
    """Base form, past and, where it is another word, past participle: "arise:arose:arisen"."""
    doubled: str
    """Verbs whose last letter is doubled before -ed and -ing."""
    told_only: str
    """Verbs that reading does not take for verbs."""
    read_only: str
    """Verbs that stories are not told with."""
    read_forms: str
    """Further forms that reading takes for verbs."""
    unread_forms: str
    """Forms that reading does not take for verbs."""
    lasting: str
    """Verbs for what lasts until then."""
    before_nouns_read: str
    """After these a word such as "walk" is a noun, when themes are read."""
    before_nouns_told: str
    """After these a word such as "drinks" is a noun, when stories are told."""
    auxiliary: dict[str, str]
    """Auxiliaries in the past."""

    def __post_init__(self) -> None:
        lists = {name: words.split() for name, words in vars(self).items() if isinstance(words, str)}
        for name, words in lists.items():
            require_unlike(name, words)
            if wrong := next((word for word in words if not re.fullmatch(r"[a-z':]+", word)), None):
                raise ValueError(f"{name}: {wrong!r} is no word in small letters")
        if wrong := next((row for row in lists["irregular"] if row.count(":") not in (1, 2)), None):
            raise ValueError(f"irregular: {wrong!r} is not a base form, a past and perhaps a participle")
        verbs = {*lists["regular"], *self.pasts}
        for name in ("doubled", "told_only", "read_only", "lasting"):
            require_known(name, lists[name], verbs)

    @cached_property
    def _rows(self) -> list[list[str]]:
        return [row.split(":") for row in self.irregular.split()]

    @cached_property
    def pasts(self) -> dict[str, str]:
        """The past of irregular verbs."""
        return {row[0]: row[1] for row in self._rows}

    @cached_property
    def participles(self) -> dict[str, str]:
        """Past participles that are not the past."""
        return {row[0]: row[2] for row in self._rows if len(row) == 3}

    @cached_property
    def doubling(self) -> frozenset[str]:
        """Verbs whose last letter is doubled."""
        return frozenset(self.doubled.split())

    @cached_property
    def bases(self) -> frozenset[str]:
        """Base forms of the verbs that stories are told with."""
        return frozenset({*self.regular.split(), *self.pasts} - {"be", "am", *self.read_only.split()})

    @cached_property
    def presents(self) -> dict[str, str]:
        """The base form of every present of he, she and it."""
        return {third_person(base): base for base in self.bases}

    @cached_property
    def read(self) -> frozenset[str]:
        """Every form that is a verb where themes are read."""
        forms, unread = set(self.read_forms.split()), {*self.told_only.split(), "be", "am"}
        for base in {*self.regular.split()} - unread:
            forms |= {base, *_misspelt(base)}
        for base in self.pasts.keys() - unread:
            forms |= {base, third_person(base), past(base), participle(base), gerund(base)}
        return frozenset(forms - {*self.unread_forms.split()})


@cache
def english_verbs() -> EnglishVerbs:
    """The verbs we know, from data/english_verbs.toml."""
    known: EnglishVerbs = read_table("planner_service", "english_verbs.toml", EnglishVerbs)
    return known


def is_verb(word: str) -> bool:
    """Whether the word is a form of a verb where themes are read."""
    return word.lower() in english_verbs().read


def is_verb_form(word: str) -> bool:
    """Whether a word is a third-person present we know, or an auxiliary."""
    return word in english_verbs().presents or word in english_verbs().auxiliary


def past(base: str) -> str:
    """The simple past of a base form: sit → sat, carry → carried."""
    verbs = english_verbs()
    if base in verbs.pasts:
        return verbs.pasts[base]
    if base.endswith("e"):
        return base + "d"
    if base.endswith("y") and base[-2:-1] not in "aeiou":
        return base[:-1] + "ied"
    if base in verbs.doubling:
        return base + base[-1] + "ed"
    if base.endswith("ic"):
        return base + "ked"
    return base + "ed"


def participle(base: str) -> str:
    """The past participle of a base form: go → gone, sit → sat."""
    return english_verbs().participles.get(base) or past(base)


def gerund(base: str) -> str:
    """The -ing form: sit → sitting, lie → lying, make → making."""
    if base.endswith("ie"):
        return base[:-2] + "ying"
    if base.endswith("e") and not base.endswith(("ee", "oe")) and base != "be":
        return base[:-1] + "ing"
    return base + (base[-1] if base in english_verbs().doubling else "k" if base.endswith("ic") else "") + "ing"


def third_person(base: str) -> str:
    """The present of he, she and it: carry → carries."""
    if base == "have":
        return "has"
    if base.endswith("y") and base[-2:-1] not in "aeiou":
        return base[:-1] + "ies"
    return base + ("es" if base.endswith(("s", "x", "z", "ch", "sh", "o")) else "s")


def _misspelt(verb: str) -> set[str]:
    """The forms in -s, -ed and -ing, with and without a doubled last letter, as people write them."""
    if re.search(r"[^aeiou]y$", verb):
        return {verb[:-1] + "ies", verb[:-1] + "ied", verb + "ing"}
    if verb.endswith("e"):
        return {verb + "s", verb + "d", verb[:-1] + "ing", verb + "ing"}
    plural = verb + ("es" if re.search(r"(?:s|x|z|ch|sh)$", verb) else "s")
    doubled = (
        {verb + verb[-1] + "ed", verb + verb[-1] + "ing"} if re.search(r"[^aeiou][aeiou][bdgklmnprt]$", verb) else set()
    )
    return {plural, verb + "ed", verb + "ing"} | doubled


@table
class Idiom:
    """A saying, plain words for it, and the emotion it shows."""

    saying: str
    """A regular expression with parts."""
    meaning: str
    emotion: str


@table
class Idioms:
    """data/idioms.toml."""

    parts: dict[str, str]
    idiom: tuple[Idiom, ...]

    def __post_init__(self) -> None:
        if not self.patterns:
            raise ValueError("idiom: there is none")

    @cached_property
    def patterns(self) -> tuple[tuple[re.Pattern[str], Idiom], ...]:
        """What to look for, and what it means."""
        parts = expanded(self.parts)
        sayings = [with_parts(f"idiom.{at}.saying", idiom.saying, parts) for at, idiom in enumerate(self.idiom)]
        return tuple((compiled(rf"\b(?:{saying})"), idiom) for saying, idiom in zip(sayings, self.idiom, strict=True))


def idiom_in(text: str) -> Idiom | None:
    """The first saying found in the text."""
    idioms: Idioms = read_table("planner_service", "idioms.toml", Idioms)
    return next((idiom for pattern, idiom in idioms.patterns if pattern.search(text)), None)
