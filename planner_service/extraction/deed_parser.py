"""What a clause has a body do: the skill its verb means, the furniture it names, and what is no deed at all.

The clauses of a scene: who does what, in the order it is told, and in which mood.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final

from motion_backend.motion import Skill
from planner_service.extraction.text_scenes import Line, TextScene
from planner_service.scripts.emotions import feelings
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import MAX_THEME_LENGTH, Clause, ThemeError, clauses_of, moods_of
from planner_service.themes.lexicon import is_verb
from planner_service.themes.patterns import compiled, either, expanded, with_parts
from planner_service.themes.sentence_parser import moments_of, sentences_of
from scene_graphs import furniture
from scene_graphs.data_tables import read_table, require_known, table

_NAMED: Final = re.compile(
    r"^(?:(?:then|and|but|so|now|later|meanwhile|slowly|quietly|suddenly)[ ,]+)?"
    r"(?:(?:Mr|Mrs|Ms|Dr|Miss|Aunt|Uncle|Old|Young|Little)\s+)?"
    r"(?P<name>[A-Z][^\W\d_A-Z]+)(?:\s+[A-Z][^\W\d_]+)?\s+(?=(?P<verb>\w+))"
)
_KIND: Final = re.compile(
    r"^(?:the|an?|this|that|one)\s+(?:\w+\s+)?"
    r"(?P<kind>man|woman|boy|girl|guy|student|child|kid|father|mother|writer|worker)\s+(?=\w)", re.IGNORECASE,
)  # fmt: skip
_SOMETHING: Final = re.compile(
    r"^(?:(?:and|but|so|then)\s+)?(?:the|an?|his|her|their|my|our|its|this|that|these|those|every|no)\s+\w",
    re.IGNORECASE,
)
"""A subject that is no person we know of, where no person was found."""
_ADVERBIAL: Final = re.compile(
    r"^(?:later|early|late|that|this|one|the (?:next|same|following)|all|in|on|at|by|after|before|from|with|without"
    r"|during|for|under|still|now|then|once|again|back|home|alone|tired|half|not long|some|outside|inside|upstairs"
    r"|downstairs)\b"
    r"[^.;]{0,60}?[\s,](?=(?:he|she|they|I|we)\s+\w)", re.I,
)  # fmt: skip
_WHILE: Final = re.compile(r",?\s*\b(?:for|after|in|once in) a (?:little |long |short |good )?while\b,?", re.IGNORECASE)
_TOSSES: Final = re.compile(r"\b(toss\w*) and turn\w*", re.IGNORECASE)
_I: Final = re.compile(r"^(?:I|we)\s+(?=\w)")
_PERSON: Final = re.compile(
    r"^(?:the|an?|this|our|one)\s+(?:\w+\s+)?(?:character|person|protagonist|hero|heroine)\b", re.IGNORECASE
)
SOMETHING: Final = "something"


@dataclass(frozen=True)
class Told:
    """A clause and who it is about."""

    clause: Clause
    who: str
    """A name or "man"; empty where nobody is named, `SOMETHING` for what is no person we know of."""
    mood: str
    line: Line


def clauses_in(scene: TextScene) -> tuple[Told, ...]:
    """What the scene tells, clause by clause."""
    found: list[tuple[Clause, str, Line]] = []
    who = ""
    for line in scene.lines:
        if line.spoken:
            continue
        for sentence in sentences_of(_TOSSES.sub(r"\1 about", _WHILE.sub("", line.text))):
            for moment in moments_of(sentence[:MAX_THEME_LENGTH]):
                moment = _ADVERBIAL.sub("", moment)  # "that night she …"
                named = _who(moment)
                who = who if named in ("", SOMETHING) else named
                found += [(clause, named or who, line) for clause in _clauses(_without_name(moment))]
    moods = moods_of([clause for clause, _, _ in found], [None] * len(found)) if found else ()
    return tuple(Told(clause, who, mood, line) for (clause, who, line), mood in zip(found, moods, strict=True))


def hero_of(told: tuple[Told, ...], deeds: tuple[bool, ...]) -> str:
    """Who does most of what a body can act; the first of those who do as much."""
    done = Counter(one.who for one, deed in zip(told, deeds, strict=True) if deed and one.who not in ("", SOMETHING))
    return max(done, key=lambda name: done[name]) if done else ""


def mood_of(text: str) -> str | None:
    """The emotion that most words of a text name, or None."""
    named = Counter(feeling.emotion for feeling in feelings(text) if feeling.sure and feeling.emotion != "neutral")
    return max(named, key=lambda emotion: named[emotion]) if named else None


def _clauses(moment: str) -> Iterator[Clause]:
    try:
        yield from clauses_of(moment)
    except ThemeError:
        return


def _who(moment: str) -> str:
    """Whose deed it is, where a name or a kind of person begins the clause."""
    if (kind := _KIND.match(moment)) is not None:
        return kind["kind"].lower()
    named = _NAMED.match(moment)
    if named is not None and _is_name(named):
        return named["name"]
    return SOMETHING if _SOMETHING.match(moment) and not _PERSON.match(moment) else ""


def _without_name(moment: str) -> str:
    """The clause without a name or "I" in front, which the reading of themes does not expect."""
    if (spoken := _I.match(moment)) is not None:
        return moment[spoken.end() :]
    named = _NAMED.match(moment)
    return moment[named.end() :] if named is not None and _is_name(named) else moment


def _is_name(match: re.Match[str]) -> bool:
    name = match["name"]
    if name.endswith("s") and name not in deed_patterns().names_in_s.split():
        return False  # "Clouds hung over the town"
    return name not in deed_patterns().not_names.split() and (is_verb(match["verb"]) or match["verb"].endswith("ly"))


@table
class Kind:
    """A way a clause is acted out."""

    skill: Skill
    begins: tuple[str, ...]
    """How the clause begins, one way or another."""
    falls: bool = False
    """Whether one lies where one can, and else sits ("collapses onto …")."""
    lowers: bool = False
    """Whether one lies where that is a bed ("sinks onto …")."""
    wakes: bool = False
    """Whether one must have been asleep before."""
    done: bool = False
    """Whether it is done while sitting or lying, and no going to a seat by itself ("reads")."""


@table
class KeptThings:
    """A pattern for things, and the furniture where they are kept."""

    things: str
    piece: str


@table
class DeedPatterns:
    """data/deed_patterns.toml: patterns for the beginning of a clause without its subject."""

    names_in_s: str
    """First names that end in s."""
    not_names: str
    """Words with a capital that begin sentences and are nobody's name."""
    not_pieces: frozenset[str]
    """Furniture words that mean something else more often."""
    stands_on: dict[str, str]
    """Where one goes for what stands on other furniture."""
    seats_at: dict[str, str]
    """Where one sits at what nobody sits on."""
    parts: dict[str, str]
    kept: tuple[KeptThings, ...]
    kind: tuple[Kind, ...]
    """The first that fits is taken."""

    def __post_init__(self) -> None:
        require_known("parts", ("own", "lead"), self.parts)
        for place, words in {"stands_on": self.stands_on, "seats_at": self.seats_at}.items():
            if unknown := next((word for pair in words.items() for word in pair if not furniture.is_known(word)), None):
                raise ValueError(f"{place}: {unknown!r} is no furniture we know")
        if not (self.kinds and self.things and self.lead and self.no_furniture):
            raise ValueError("kind, kept: there is none")

    @cached_property
    def whole_parts(self) -> dict[str, str]:
        """Every part with the parts in it put in."""
        return expanded(self.parts)

    @cached_property
    def kinds(self) -> tuple[tuple[Kind, re.Pattern[str]], ...]:
        """How a clause of every kind begins."""
        return tuple((kind, self._compiled(f"kind.{at}.begins", kind.begins)) for at, kind in enumerate(self.kind))

    @cached_property
    def things(self) -> tuple[tuple[re.Pattern[str], str], ...]:
        """What is kept somewhere, and where."""
        patterns = (with_parts(f"kept.{at}.things", kept.things, {}) for at, kept in enumerate(self.kept))
        return tuple(
            (compiled(rf"\b(?:{pattern})\b"), kept.piece) for pattern, kept in zip(patterns, self.kept, strict=True)
        )

    @cached_property
    def lead(self) -> re.Pattern[str]:
        """What may stand before the verb that says what is done."""
        return compiled(f"^{self.whole_parts['lead']}")

    @cached_property
    def no_furniture(self) -> re.Pattern[str]:
        """What is touched where it belongs to the house."""
        own = self.whole_parts["own"]
        return compiled(rf"^\W*(?:\w+\s+){{0,4}}?{own}?\s*(?:\w+\s+)?(?:doors?|windows?|gate)\b")

    def _compiled(self, place: str, begins: tuple[str, ...]) -> re.Pattern[str]:
        ways = [with_parts(place, way, self.whole_parts) for way in begins]
        return compiled(either(ways))


@cache
def deed_patterns() -> DeedPatterns:
    """How clauses begin that have a body do something, from data/deed_patterns.toml."""
    known: DeedPatterns = read_table("planner_service", "deed_patterns.toml", DeedPatterns)
    return known


@dataclass(frozen=True)
class Deed:
    """What a clause has a body do."""

    kind: Kind
    skill: Skill
    piece: str = ""
    """The furniture word it names or hints at; empty where it names none."""
    named: bool = False
    """Whether the clause itself names the piece."""


def deed_of(clause: str) -> Deed | None:
    """The deed of a clause without its subject ("slumps onto the couch"), or None where a body shows none."""
    found = _kinds(clause)
    if found is None:
        return None
    kind, rest = found
    skill = kind.skill
    if skill is Skill.LOCO:
        piece = next((one for one in pieces_in(rest) if furniture.affordances(one)), "")
        return Deed(kind, skill, piece, bool(piece))
    if skill in (Skill.STANDUP, Skill.GETUP):
        piece = next((one for one in pieces_in(rest) if furniture.affordances(one) & {"sit", "lie"}), "")
        return Deed(kind, skill, piece, bool(piece))
    if skill is Skill.TOUCH and deed_patterns().no_furniture.match(rest) and not pieces_in(rest):
        return None
    named = pieces_in(rest)
    if kind.falls and not any(affords(piece, "lie") for piece in named):
        skill = Skill.SITDOWN
    elif kind.skill is Skill.SITDOWN and not kind.done and any(furniture.group_of(piece) == "bed" for piece in named):
        skill = Skill.LIEDOWN if _lowers(_bare(clause)) else skill
    if kind.falls and not named:
        return None  # "rests in peace", "falls into a rage"
    fitting = ""
    if skill is Skill.SITDOWN and not re.search(r"\bon (?:\w+ ){0,3}(?:table|desk|counter)\b", rest):
        seats_at = deed_patterns().seats_at
        fitting = next((seats_at[at] for piece in named if (at := furniture.canonical(piece)) in seats_at), "")
    fitting = fitting or next((piece for piece in named if affords(piece, NEEDS[skill])), "")
    if fitting:
        return Deed(kind, skill, fitting, True)
    kept = next((piece for things, piece in deed_patterns().things if things.search(rest)), "")
    return Deed(kind, skill, kept if skill is Skill.TOUCH else "")


def pieces_in(text: str) -> list[str]:
    """Furniture words of a text in its order, longest names first: "dining table", not "table"."""
    words = re.findall(r"[a-z]+(?:'s)?", text.lower())
    found: list[str] = []
    at = 0
    while at < len(words):
        size = next((size for size in (3, 2, 1) if _names(tuple(words[at : at + size]), size)), 0)
        if size and words[at] not in deed_patterns().not_pieces:
            piece = furniture.canonical(" ".join(words[at : at + size])).replace("_", " ")
            found.append(deed_patterns().stands_on.get(piece, piece))
        at += size or 1
    return found


def _bare(clause: str) -> str:
    """The clause from its main verb on."""
    return deed_patterns().lead.sub("", clause.strip(), count=1)


def _lowers(clause: str) -> bool:
    return any(kind.lowers and pattern.match(clause) for kind, pattern in deed_patterns().kinds)


def _kinds(clause: str) -> tuple[Kind, str] | None:
    """The first kind that the clause, or the clause from its main verb on, begins with; and what follows."""
    for start in dict.fromkeys((clause.strip(), _bare(clause))):
        for kind, pattern in deed_patterns().kinds:
            if (match := pattern.match(start)) is not None:
                return kind, start[min(match.end(), _after_verb(start)) :]
    return None


def _after_verb(text: str) -> int:
    verb = re.match(r"\S+", text)
    return verb.end() if verb else 0


def _names(words: tuple[str, ...], size: int) -> bool:
    """Whether these very words, and not only the last of them, are a furniture word."""
    if len(words) < size:
        return False
    whole = " ".join(words)
    if not furniture.is_known(whole):
        return False
    return size == 1 or furniture.canonical(whole) != furniture.canonical(" ".join(words[1:]))
