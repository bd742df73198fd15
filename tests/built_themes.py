"""Themes that are built of subjects, deeds and joints, so that their right reading is known."""

from __future__ import annotations

from dataclasses import dataclass, replace

from hypothesis import strategies as st

from planner_service.themes.lexicon import gerund, past, third_person

BASES = {
    "read": "a long novel",
    "drink": "some tea",
    "sit": "on the sofa",
    "sleep": "on the bed",
    "water": "the plants",
    "cook": "a soup",
    "open": "the window",
    "wash": "the dishes",
    "walk": "to the kitchen",
    "write": "a letter",
    "play": "the piano",
    "eat": "bread and butter, cheese and a pear",
    "dance": "around the room",
    "fold": "the shirts",
}
"""Verbs, and what follows them."""
DENIALS = {
    "does not": ("base", False), "never": ("present", False), "refuses to": ("base", False),
    "decides not to": ("base", False), "wants to": ("base", False), "cannot": ("base", True),
    "forgets to": ("base", False), "doesn't": ("base", False), "can't": ("base", True), "is unable to": ("base", True),
}  # fmt: skip
"""What stands before a deed that is not done, the form it wants, and whether it is not done since it cannot be."""
HEROES = ("Anna", "The old nurse", "He", "A tired student", "Mr. Smith")
OTHERS = ("her brother", "the postman", "the kettle")
PRONOUNS = {"Anna": "she", "The old nurse": "she", "He": "he", "A tired student": "he", "Mr. Smith": "he"}


@dataclass(frozen=True)
class Told:
    """A clause as it must be read."""

    verb: str
    rest: str
    doer: str
    denied: bool = False
    unable: bool = False
    said: str = ""
    """Its words without the subject."""


@dataclass(frozen=True)
class BuiltTheme:
    """A theme and its reading: clauses in the order of time."""

    text: str
    told: tuple[Told, ...]
    hero: str


@st.composite
def deeds(draw: st.DrawFn, doer: str, denials: bool = True) -> Told:
    """A deed, told in the present or the past, or said not to be done."""
    verb = draw(st.sampled_from(sorted(BASES)))
    told = Told(verb, BASES[verb], doer)
    if denials and draw(st.integers(0, 3)) == 0:
        before = draw(st.sampled_from(sorted(DENIALS)))
        form, unable = DENIALS[before]
        words = verb if form == "base" else third_person(verb)
        return replace(told, denied=True, unable=unable, said=f"{before} {words} {told.rest}")
    form = draw(st.sampled_from((third_person(verb), past(verb), f"is {gerund(verb)}")))
    return replace(told, said=f"{form} {told.rest}")


@st.composite
def sentences(draw: st.DrawFn, subject: str, hero: str) -> tuple[str, tuple[Told, ...]]:
    """A sentence about `subject`, with at most one joint that turns the order of time."""
    again = PRONOUNS[hero]
    first = draw(deeds(subject))
    shape = draw(st.sampled_from(("and", "time", "led", "gerund", "other", "one", "three")))
    if shape == "one":
        return f"{subject} {first.said}", (first,)
    if shape == "three":
        second, third = draw(deeds(subject)), draw(deeds(subject))
        return f"{subject} {first.said}, {second.said}, and {third.said}", (first, second, third)
    if shape == "and":
        joint = draw(st.sampled_from((" and ", " but ", ", then ", " and then ", ", and ")))
        second = draw(deeds(subject))
        return f"{subject} {first.said}{joint}{second.said}", (first, second)
    if shape == "gerund":
        second = draw(deeds(subject, denials=False))
        if draw(st.booleans()):
            first = draw(deeds(subject, denials=False))
            how = draw(st.sampled_from(("without", "instead of")))
            left = replace(second, denied=True, said=f"{how} {gerund(second.verb)} {second.rest}")
            return f"{subject} {first.said} {left.said}", (first, left)
        second = replace(second, said=f"{gerund(second.verb)} {second.rest}")
        joint = draw(st.sampled_from(("before", "after")))
        pair = (first, second) if joint == "before" else (second, first)
        return f"{subject} {first.said} {joint} {second.said}", pair
    if shape == "other":
        other = draw(st.sampled_from(OTHERS))
        second = draw(deeds(other, denials=False))
        joint = draw(st.sampled_from(("while", "until")))
        return f"{subject} {first.said} {joint} {other} {second.said}", (first, second)
    second = draw(deeds(again, denials=False))
    if shape == "led":
        joint = draw(st.sampled_from(("After", "Before", "When", "While")))
        opening = replace(second, doer=subject)
        main = draw(deeds(again))
        pair = (main, opening) if joint == "Before" else (opening, main)
        name = subject if subject[0:4] in ("Anna", "Mr. ") else subject[0].lower() + subject[1:]
        told = tuple(replace(one, doer=name) if one is opening else one for one in pair)
        return f"{joint} {name} {opening.said}, {again} {main.said}", told
    joint = draw(st.sampled_from(("before", "after", "until", "when", "while")))
    pair = (second, first) if joint in ("after", "when") and not _is_state(first, joint) else (first, second)
    return f"{subject} {first.said} {joint} {again} {second.said}", pair


def _is_state(told: Told, joint: str) -> bool:
    """Whether what goes on when something happens began before it: "is reading when the phone rings"."""
    return joint != "after" and told.said.startswith("is ")


@st.composite
def themes(draw: st.DrawFn) -> BuiltTheme:
    """One to three sentences about one person."""
    hero = draw(st.sampled_from(HEROES))
    text, told = draw(sentences(hero, hero))
    parts = [f"{text}."]
    for _ in range(draw(st.integers(0, 2))):
        text, more = draw(sentences(PRONOUNS[hero].capitalize(), hero))
        parts.append(f"{text}.")
        told = (*told, *more)
    return BuiltTheme(" ".join(parts), told, hero)
