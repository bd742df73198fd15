"""Why beats are not acted, in words."""

from __future__ import annotations

from typing import Final

from planner_service.scripts.script import HAPPENS, WISHED
from planner_service.themes.beats import ReadBeat
from planner_service.themes.lexicon import grammar, lemma_of, verb_of
from planner_service.themes.protagonist import head_of, is_person
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things, things_called
from planner_service.themes.verb_finder import is_plural, tokens_of
from scene_graphs.furniture import is_known

NOT_ACTED: Final = {
    "undone": "it is not done",
    "memory": "it is remembered, not done now",
    "other": "somebody or something else does it",
    "speech": "it is said; the body does not speak",
}
"""Why beats of these kinds are not acted."""
ONE_PLAYS: Final = "one person is played"
_NOT_THERE: Final = frozenset(("nobody", "no", "none", "somebody", "someone", "everybody", "everyone"))
_LONGEST: Final = 2
"""Words of whom alone is played, after the first: of more it is not said who."""
SPOKEN_OF: Final = "it is only spoken of"
NO_DEED: Final = "it is no deed"
UNSHOWN: Final = "none of the captions shows it"
BESIDE: Final = "the body does something else meanwhile, on its feet"
"""Why what would be done sitting is not, beside that: "irons a shirt while listening to the radio"."""
HELD: Final = "what is held or worn stays as it is"
"""Why what is only held, or is in somebody's own clothes, is not acted."""


def not_acted(read: ReadBeat) -> str:
    """Why a beat of a kind that is not acted is not."""
    who, kind = read.beat.who, read.beat.kind
    if kind == "undone" and _is_wish(read.text):
        return WISHED
    if read.clause.aside and kind != "memory":
        return SPOKEN_OF
    if kind != "other" or not who or (who.lower() in ("it", "there") and read.clause.verb == "be"):
        return NO_DEED if kind == "other" else NOT_ACTED[kind]
    first, *rest = who.split(" ")
    if is_person(who) and first.lower() not in _NOT_THERE:
        named = " ".join([first.lower() if first.lower() in grammar().marks else first, *rest[:2]])
        named = named if len(rest) <= 2 and grammar().prepositions.isdisjoint(rest) else "somebody else"
        several = is_plural(head_of(named).lower()) or named.lower() == "they"
        return f"{named} {'do' if several else 'does'} it: {_played(read.hero)}"
    head = lemma_of(head_of(who).lower())
    dead = (head in things() and head not in things_called("pet")) or is_known(head) or head in theme_words()["weather"]
    return HAPPENS if dead and first.lower() not in _NOT_THERE else NOT_ACTED[kind]


def _is_wish(text: str) -> bool:
    """Whether what is not done is only wanted: "wants to call", not "does not want to"."""
    words = [token.low for token in tokens_of(text)]
    wish = next((at for at, word in enumerate(words) if verb_of(word) in grammar().wishes), None)
    return wish is not None and grammar().denials.isdisjoint(words[:wish])


def _played(hero: str) -> str:
    """Whom alone the body is: "only Ben is played"."""
    first, *rest = hero.split(" ")
    if not is_person(hero) or first.lower() in grammar().subjects or len(rest) > _LONGEST:
        return ONE_PLAYS
    if first.lower() in grammar().marks:
        hero = " ".join(["the" if first.lower() in ("a", "an") else first.lower(), *rest])
    return f"only {hero} is played"
