"""The lists of words by which the rules read themes."""

from __future__ import annotations

from functools import cache

from scene_graphs.data_tables import read_table, table


@table
class ThemeWords:
    """data/theme_words.toml: lists of base forms, apart by spaces."""

    people: str
    """Nouns for people."""
    memory_verbs: str
    speech_verbs: str
    thought_verbs: str
    not_said: str
    """What is answered or said with more than words."""
    unable_verbs: str
    """What somebody who cannot do it is seen trying: "cannot sleep"."""
    falling_verbs: str
    """What somebody who nearly does it is seen staggering by: "nearly falls"."""
    voiced_verbs: str
    """What somebody does who is quoted, and is seen doing: "“Dear John,” he writes"."""
    no_heroes: str
    """Nouns for what does things and is nobody a theme is about."""
    weather: str
    """Nouns and verbs for the weather."""
    told_times: str
    """Nouns that, without a verb, tell only when it is: "laundry day"."""
    fright_verbs: str
    """What somebody does who is afraid, where it is done to nothing."""
    calming_verbs: str
    """What somebody does whose anger is over."""
    called_it: str
    """Nouns for whom a theme may call "it"."""
    visitors: str
    """Nouns for people who come by, or call: a theme is seldom about them."""
    body: str
    """Parts of a person: what these do, the person does."""
    state_verbs: str
    """Verbs that only say how somebody is or feels."""
    posed: str
    """States that a body is seen in: whoever is asleep lies."""
    state_words: str
    """Words that say no more when they stand beside a feeling."""
    foreign: str
    """The commonest words of other languages that are no English words."""
    names_she: str
    """First names, by the pronouns that they tell."""
    names_he: str
    names_they: str

    @property
    def sets(self) -> dict[str, frozenset[str]]:
        """Every list as a set."""
        return {name: frozenset(words.split()) for name, words in vars(self).items()}


@cache
def theme_words() -> dict[str, frozenset[str]]:
    """The lists of `ThemeWords`."""
    known: ThemeWords = read_table("planner_service", "theme_words.toml", ThemeWords)
    return known.sets
