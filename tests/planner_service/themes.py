"""The seven themes of SIMS 8.2 and Tables 10, 11 and 13, with the events we expect in them, labelled by hand."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Expected:
    """An event that must be found, in this order."""

    words: tuple[str, ...]
    """All of these stand in the event's text."""
    emotions: tuple[str, ...]
    """Any of these is right."""
    played: str
    """A regular expression found in the chosen script's summary or captions."""


@dataclass(frozen=True)
class Theme:
    """A theme as the paper prints it, slips of the pen included."""

    name: str
    text: str
    events: tuple[Expected, ...]


THEMES = (
    Theme(
        "weekend",
        "A person relaxes at home during the weekend, drinks cokes, and reads books.",
        (
            Expected(("relaxes", "weekend"), ("relaxed",), r"weekend|nothing|lazy|relax|leisure|day fall away"),
            Expected(("drinks", "cokes"), ("relaxed", "neutral"), r"cola|drink|tea|coffee"),
            Expected(("reads", "books"), ("relaxed", "neutral"), r"read|book|novel"),
        ),
    ),
    Theme(
        "interview",
        "A person is happy at first, but he is told in the phone that he fails the job interview and becomes very "
        "depressed.",
        (
            Expected(("happy",), ("happy",), r"happy|hope|joy|excite|smile|grin|laugh|cheer"),
            Expected(("phone", "fails", "interview"), ("sad",), r"interview (?:was|has)"),
            Expected(("depressed",), ("sad",), r"depress|sad|miser|hope|worthless|small|tears"),
        ),
    ),
    Theme(
        "afternoon",
        "A person enjoys a relaxed afternoon at home.",
        (Expected(("enjoys", "afternoon"), ("relaxed",), r"afternoon|enjoy|relax|evening|day"),),
    ),
    Theme(
        "picnic",
        "A person is dressing up and feels excited about the picnic tomorrow.",
        (
            Expected(("dressing",), ("happy", "neutral"), r"outfit|dress|suit|wardrobe|clothes"),
            Expected(("excited", "picnic"), ("happy",), r"picnic|[Ee]xcited about tomorrow"),
        ),
    ),
    Theme(
        "lottery",
        "A character is sitting on the chair and becomes excited when he finds that he won a lottery, so he run "
        "excitedly around the room. And he relaxes on the sofa.",
        (
            Expected(("sitting", "chair"), ("neutral", "relaxed"), r"."),
            Expected(("excited", "lottery"), ("happy",), r"lottery"),
            Expected(("run", "excitedly"), ("happy",), r"runs?\b|danc|skip|jump|leap|spin"),
            Expected(("relaxes", "sofa"), ("relaxed",), r"sofa|relax"),
        ),
    ),
    Theme(
        "jewellery",
        "A character is searching for the jewellery under the bed. He finds it and he becomes excited, run around the "
        "house. He decided to drink a bottle of wine the celebrate and becomes drunken and rests on the sofa..",
        (
            Expected(("searching", "jewellery"), ("neutral", "hurried", "stressed"), r"search|look"),
            Expected(("finds", "excited"), ("happy",), r"finds.*jewellery"),
            Expected(("run", "house"), ("happy",), r"runs?\b|danc|skip|jump|leap|spin"),
            Expected(("drink", "wine"), ("happy",), r"wine|drink"),
            Expected(("drunken",), ("drunk",), r"[Dd]r[uai]nk"),
            Expected(("rests", "sofa"), ("drunk", "tired", "relaxed"), r"sofa"),
        ),
    ),
    Theme(
        "photograph",
        "The character ponders over an old photograph and reflects on memories in the living room. He then remembers "
        "his dead wife and becomes sad. He then decides to drink a bottle of wine and becomes drunken and rests on the "
        "sofa.",
        (
            Expected(("ponders", "photograph"), ("neutral", "sad"), r"photograph"),
            Expected(("reflects", "memories"), ("neutral", "sad"), r"."),
            Expected(("remembers", "wife", "sad"), ("sad",), r"wife"),
            Expected(("drink", "wine"), ("sad", "drunk"), r"wine|drink"),
            Expected(("drunken",), ("drunk",), r"[Dd]r[uai]nk"),
            Expected(("rests", "sofa"), ("drunk", "tired", "relaxed"), r"sofa"),
        ),
    ),
)
