"""Clauses whose verb is not their deed, with the deed that they mean: "a yawn escapes her", "the dishes get washed".

Each function knows one construction of English, whatever its words; they are told apart by data/constructions.toml and
by what a word may be. The words of the clause stay as they are written.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import Final

from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import (
    Words,
    gerund,
    grammar,
    is_adjective,
    is_noun,
    kinds_of,
    lemma_of,
    participle,
    past,
    third_person,
    verb_of,
)
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things, things_called
from planner_service.themes.verb_finder import is_adverb, names, tokens_of
from scene_graphs.data_tables import read_table, table
from scene_graphs.furniture import affordances, is_known

_OWNERS: Final = {"her": "she", "his": "he", "my": "I", "their": "they", "your": "you", "our": "we"}
_OBJECTS: Final = {"her": "she", "him": "he", "me": "I", "them": "they", "you": "you", "us": "we"}
_FEWEST: Final = 2
_MOST_BEFORE_EVENT: Final = 3
"""Adjectives that may stand between a mark and an event: "a long, loud yawn"."""
_ON: Final = frozenset(("on", "off", "out", "back", "away", "down", "up"))


@table
class LimbRow:
    """What a part of the body does, and what whoever's it is does in it; `then` are words that may follow its verb, and
    "..." in what is meant stands for the rest."""

    limb: Words
    does: Words
    then: Words
    means: str


@table
class ConstructionWords:
    """data/constructions.toml."""

    events: dict[str, str]
    feelings: dict[str, str]
    words: dict[str, Words]
    limb: tuple[LimbRow, ...]


@cache
def _known() -> ConstructionWords:
    known: ConstructionWords = read_table("planner_service", "constructions.toml", ConstructionWords)
    return known


def event_of(word: str) -> str:
    """The deed that a noun stands for, or "": of "yawns" yawn."""
    low = word.lower()
    nouns = kinds_of(low).get("NOUN", ())
    return next((_known().events[one] for one in (low, *nouns) if one in _known().events), "")


def meant(clause: Clause) -> list[Clause]:
    """The clause with the deed that it means, where its verb is none; and a second one where it tells of two."""
    if made := _made_to(clause):
        return made
    if clause.quotes or (clause.aside and clause.verb):
        return [clause]
    for construction in _CONSTRUCTIONS if clause.verb else (_alone,):
        if found := construction(clause):
            return found
    return [clause]


def _words(name: str) -> frozenset[str]:
    return _known().words[name]


def _meaning(clause: Clause, words: Sequence[str], subject: str = "") -> Clause:
    """The clause with another deed and doer; what was its subject stands in its text."""
    told = clause.subject in ("", subject) or clause.text.lower().startswith(f"{clause.subject.lower()} ")
    text = clause.text if told else f"{clause.subject} {clause.text}"
    led = 0 if told else len(clause.subject.split())
    lemmas = (words[0], *map(lemma_of, words[1:]))
    plainly = " ".join((third_person(words[0]), *words[1:]))
    means = replace(clause, subject=subject, verb=words[0], lemmas=lemmas, plainly=plainly, absolute=False)
    return replace(means, text=text, led=led)


def _after(clause: Clause) -> tuple[str, ...]:
    """The words after a clause's verb, as they are written."""
    words = [token.low for token in tokens_of(clause.text) if token.text[:1].isalnum()]
    return tuple(words[len(words) - len(clause.lemmas) + 1 :]) if clause.verb else tuple(words)


def _head(subject: str) -> str:
    """The noun of a subject without what follows it."""
    words = [token.low for token in tokens_of(subject)]
    end = next((at for at, word in enumerate(words) if at and word in grammar().prepositions | {"of"}), len(words))
    return words[end - 1] if words else ""


def _owner(subject: str) -> str:
    """Whose somebody's deed is: "she" of "her yawn", "Helga" of "Helga's pacing"."""
    first = subject.split(" ", 1)[0]
    first = next((one for one in subject.split() if one.endswith(("'s", "’s"))), first)
    if first.lower() in _OWNERS:
        return _OWNERS[first.lower()]
    return first[:-2] if first.endswith(("'s", "’s")) and is_somebody(first[:-2]) else ""


def is_somebody(word: str) -> bool:
    """Whether a word may name a person: a pronoun, a name, or a noun for people."""
    low = word.lower()
    if low in _OBJECTS or low in ("he", "she", "they", "i", "we") or lemma_of(low) in theme_words()["people"]:
        return True
    return word[:1].isupper() and (low in names() or not kinds_of(low))


def _undergoer(clause: Clause) -> tuple[str, int]:
    """Who a clause's verb is done to, and how many words of it name them: "she" of "escapes her"."""
    words = [token.text for token in tokens_of(clause.text)]
    start = next((at for at, word in enumerate(words) if verb_of(word) == clause.verb), 0) + 1
    for at in range(start, min(start + 5, len(words))):
        word = words[at]
        after = words[at + 1] if at + 1 < len(words) else ""
        owned = word.lower() == "her" and after and is_noun(after) and after.lower() not in grammar().prepositions
        if is_somebody(word) and not owned and not after.endswith(("'s", "’s")):
            marked = words[at - 1].lower() in grammar().marks
            name = f"{words[at - 1]} {word}" if marked else _OBJECTS.get(word.lower(), word)
            return name, at + 1 - start
        if owned or (word.endswith(("'s", "’s")) and is_somebody(word[:-2])):
            return _owner(word) or "she", at + 1 - start
        if word.lower() in _OWNERS:
            return _OWNERS[word.lower()], at + 1 - start
    return "", 0


def _of_event(clause: Clause) -> list[Clause]:
    """What a body does is who does it: "A yawn escapes Martha", "Helga's pacing wears the rug thin"."""
    head = _head(clause.subject)
    owner = _owner(clause.subject)
    event = event_of(head)
    if not event and owner and head.endswith("ing") and verb_of(head) not in ("", head):
        event = verb_of(head)
    if not event or not clause.verb or clause.verb in _words("ending") or event in _words("looking"):
        return []
    who = owner or _undergoer(clause)[0]
    elsewhere = theme_words()["no_heroes"] | theme_words()["wheres"] | {"street", "neighbour", "neighbor"}
    if not who and not elsewhere.isdisjoint(clause.lemmas[1:]):
        return []  # "laughter comes from the street"
    falls = event == "sleep" and not clause.denied
    words = ("fall", "asleep") if falls else (event, "his", "head") if event == "shake" else (event,)
    return [replace(_meaning(clause, words, who), unable=clause.unable or (clause.denied and event == "sleep"))]


def _of_feeling(clause: Clause) -> list[Clause]:
    """What comes over somebody is how they are: "fear grips her", "anger rises in him"."""
    means = _known().feelings.get(lemma_of(_head(clause.subject)))
    who = _undergoer(clause)[0] if means and clause.verb in _words("overcoming") else ""
    return [_meaning(clause, (means or "").split(), who)] if who else []


def _of_limbs(clause: Clause) -> list[Clause]:
    """A limb moves as whoever's it is does something: "her gaze wanders round the room", "his arms go round her"."""
    head, after = lemma_of(_head(clause.subject)), _after(clause)
    words = [word for word in after if word not in ("slowly", "quickly", "gently")]
    for row in _known().limb:
        if head not in row.limb or clause.verb not in row.does:
            continue
        if row.then and (not words or words[0] not in row.then):
            continue
        rest = words[bool(row.then) :]
        plainly = [one for word in row.means.split() for one in (rest if word == "..." else [word])]
        return [_meaning(clause, plainly, _owner(clause.subject))]
    return []


def _in_event(clause: Clause) -> list[Clause]:
    """An event is how a body moves: "his mouth opens in a yawn", "heaves with sobs", "bursts into tears"."""
    limb = lemma_of(_head(clause.subject)) in theme_words()["body"] | {"lip", "body"}
    if not (limb or clause.verb in _words("shaking")):
        return []
    after = _after(clause)
    at = next((at for at, word in enumerate(after) if word in ("in", "with", "into")), None)
    rest = after[at + 1 :] if at is not None else ()
    found = _events_in(rest) or ([(event,)] if rest and (event := event_of(rest[0])) else [])
    who = _owner(clause.subject) if limb else clause.subject
    return [_meaning(clause, event, who) for event in found if event[0] not in _words("looking")]


def _of_hands(clause: Clause) -> list[Clause]:
    """Hands do what whoever's they are does, where they do it to something: "his palm strikes the table"."""
    head = lemma_of(_head(clause.subject))
    known = grammar()
    after = [word for word in _after(clause) if word not in known.adverbs]
    if head not in _words("acting") or not after or clause.absolute:
        return []
    led = after[0] in known.marks or (after[0] in known.prepositions and after[1:2] and after[1] in known.marks)
    own = theme_words()["body"] - {"face", "hair"}
    if not led or not own.isdisjoint(map(lemma_of, after)):
        return []
    verb = "touch" if clause.verb in _words("finds") | {"be"} else clause.verb
    return [_meaning(clause, (verb, *after), _owner(clause.subject))]


def _carried(clause: Clause) -> list[Clause]:
    """Somebody goes where something moves them: "his feet carry him to the kitchen"."""
    carries, drops = clause.verb in _words("carrying"), clause.verb in _words("dropping")
    if not clause.subject or not (carries or drops) or any(map(is_somebody, clause.subject.split()[-1:])):
        return []
    who, size = _undergoer(clause)
    after = _after(clause)[size:]
    if (
        not who
        or size > _FEWEST
        or not after
        or after[0] not in grammar().prepositions | _ON | {"upstairs", "downstairs"}
    ):
        return []
    if {"place", "back", "time", "mind", "sleep"} & set(after) and not _ON & set(after[:1]):
        return []
    return [_meaning(clause, ("fall" if drops else "go", *after), who)]


def _made_to(clause: Clause) -> list[Clause]:
    """Somebody does what something makes them do: "the joke has him laughing", "a letter | that makes her cry"."""
    if clause.verb not in _words("making") or not clause.subject or is_somebody(clause.subject.split()[-1]):
        return []
    who, size = _undergoer(clause)
    after = _after(clause)[size:]
    after = after[after[:1] == ("to",) :]
    base = verb_of(after[0]) if after else ""
    if not who or size > _FEWEST or not base or clause.denied or after[0] not in (base, gerund(base)):
        return []
    if is_adjective(after[0]) or base in theme_words()["state_verbs"]:
        return []  # "the heat makes her sick"
    made = _meaning(clause, (base, *after[1:]), who)
    return [replace(made, text=clause.text, aside=False) if clause.aside else made]


def _way(clause: Clause) -> list[Clause]:
    """Somebody goes a way, doing something else: "yawns his way to the bathroom"."""
    after = _after(clause)
    at = next((at for at, word in enumerate(after[:3]) if word == "way"), 0)
    goes = after[at + 1 : at + 2] and after[at + 1] in (
        "to",
        "into",
        "across",
        "along",
        "down",
        "up",
        "out",
        "around",
        "towards",
    )
    if not at or after[at - 1] not in _OWNERS or not goes or not event_of(clause.verb):
        return []
    return [clause, replace(_meaning(clause, ("walk", *after[at + 1 :]), clause.subject), joint="ing")]


def _held(clause: Clause) -> list[Clause]:
    """Somebody does what is told as done, or holds themself so: "a towel clutched to her chest", "legs drawn up"."""
    head, words = lemma_of(_head(clause.subject)), [token.low for token in tokens_of(clause.text)]
    done, limb = participle(clause.verb), head in theme_words()["body"]
    if done not in words[:4] or done == clause.verb or not grammar().auxiliaries.isdisjoint(words):
        return []
    bare = clause.absolute or done != past(clause.verb)  # no finite verb: "her legs drew up"
    if limb:
        is_so = bare
    else:
        first = clause.subject.split(" ", 1)[0].lower()
        marked = first in grammar().marks or first.endswith(("'s", "’s"))
        finished = (bare or not marked) and clause.verb not in _words("states")  # "Shirt ironed, the cake eaten"
        is_so = head in things().keys() - theme_words()["no_heroes"] and (clause.verb in _words("holding") or finished)
    if not is_so:
        return []
    return [_meaning(clause, (clause.verb, *clause.subject.split(), *_after(clause)))]


def _noted(clause: Clause) -> list[Clause]:
    """Notes leave out articles: "throws phone" is throws the phone, "sits on floor" on the floor."""
    words = [token.low for token in tokens_of(clause.text) if token.text[:1].isalnum()]
    start = next((at for at, word in enumerate(words) if verb_of(word) == clause.verb), None)
    if start is None or "," in clause.text or not (grammar().marks - {"to"}).isdisjoint(words):
        return []
    written: list[str] = []
    for at, word in enumerate(words[start + 1 :], start + 1):
        if _wants_article(clause.verb, words[at - 1], word, (*words[at + 1 :], "")[0]):
            written.append("the")
        written.append(word)
    return [_meaning(clause, (clause.verb, *written), clause.subject)] if "the" in written else []


def _wants_article(verb: str, before: str, word: str, after: str) -> bool:
    """Whether a noun that stands after a verb, its particle or a preposition is one thing, and has no article."""
    known = grammar()
    if verb in theme_words()["people"] | {"be", "become", "seem", "people"} or lemma_of(word) in _words("bare"):
        return False
    one = word in kinds_of(word).get("NOUN", ()) or verb == "do"
    thing = is_known(word) or word in things() or word in theme_words()["body"] | _words("sole")
    eaten = lemma_of(word) in (*things_called("food"), *things_called("drink"))
    led = before in _ON or verb_of(before) == verb or before in known.prepositions - _words("idle")
    in_bed = word == "bed" and before in ("to", "in", "from", "of", "into")
    limb = word in theme_words()["body"] and before in known.prepositions
    noun_follows = is_noun(after) and (is_known(after) or after in things())
    return one and thing and led and word not in _ON and not (eaten or in_bed or limb or noun_follows)


def _received(clause: Clause) -> list[Clause]:
    """Somebody rests on what takes them: "the armchair receives Gregor"."""
    head = _head(clause.subject)
    if clause.verb not in _words("receiving") or not is_known(head):
        return []
    able = affordances(head)
    who, size = _undergoer(clause)
    if not who or size > _FEWEST or not {"sit", "lie"} & {*able}:
        return []
    rests = ("lie", "on") if ("lie" in able and "sit" not in able) or head.endswith("bed") else ("sit", "in")
    return [_meaning(clause, (*rests, *clause.subject.lower().split()), who)]


def _moved(clause: Clause) -> list[Clause]:
    """Somebody does to a thing what it is told to do: "the coat comes off", "the letter goes into the drawer"."""
    head = lemma_of(_head(clause.subject))
    if head not in things() or clause.verb not in _words("moving") | {"come"} or len(clause.lemmas) < _FEWEST:
        return []
    if _owner(clause.subject) not in ("", *_OWNERS.values()):
        return []
    after, worn, thing = _after(clause), head in things_called("clothes"), clause.subject.split()
    if not after:
        return []
    way, on = after[0], len(after) == 1 and after[0] in ("on", "off")
    if on and clause.verb == "go" and head in _words("switched"):
        return [_meaning(clause, ("turn", way, *thing))]
    if on and worn:
        return [_meaning(clause, ("put" if way == "on" else "take", way, *thing))]
    if clause.verb == "come":
        return [_meaning(clause, ("take", "off", *thing))] if worn and way == "off" else []
    if way == "to" and lemma_of(after[-1]) in theme_words()["body"]:  # "the glass goes to his lips"
        return [_meaning(clause, ("put" if head == "phone" else "raise", *thing, *after))]
    placed = way in ("in", "into", "on", "onto", "under", "back", "over", "to") and len(after) > 1
    lies = after[-1] not in ("voicemail", "floor", "pieces", "waste", "ringing")
    return [_meaning(clause, ("put", *thing, *after))] if placed and lies else []


def _done_to(clause: Clause) -> list[Clause]:
    """Somebody does what is done to a thing: "the dishes get washed", "the door is slammed by Elke"."""
    known, words = grammar(), [token.low for token in tokens_of(clause.text) if token.text[:1].isalpha()]
    head = lemma_of(_head(clause.subject))
    helper = next((at for at, word in enumerate(words) if word in known.be or lemma_of(word) == "get"), None)
    if helper is None or not clause.subject or clause.verb not in ("be", "get") or is_somebody(_head(clause.subject)):
        return []
    at = helper + 1
    while at < len(words) and (words[at] in known.adverbs | known.be or is_adverb(words[at])):
        at += 1
    base = verb_of(words[at]) if at < len(words) else ""
    if not base or words[at] != participle(base) or not (head in things() or is_known(head)):
        return []
    rest = tuple(words[at + 1 :])
    by = rest.index("by") if "by" in rest else len(rest)
    agent = (
        next((token.text for token in tokens_of(clause.text)[::-1] if is_somebody(token.text)), "")
        if by < len(rest)
        else ""
    )
    if by < len(rest) and not agent:
        return []  # "the room is lit by a candle"
    happens = clause.verb == "get" or agent or (rest[:1] and rest[0] in _ON | {"open", "into", "onto"})
    if not happens and (base in _words("states") or is_adjective(words[at])):
        return []
    particle = rest[:1] if rest[:1] and rest[0] in _ON | {"open"} else ()
    rest = rest[len(particle) : by]
    return [_meaning(clause, (base, *particle, *clause.subject.split(), *rest), agent)]


def _by_event(clause: Clause) -> list[Clause]:
    """One event is all that is told: "his only answer is a nod", "replies with a shrug", "there is a yawn"."""
    head = lemma_of(_head(clause.subject))
    says = clause.verb in _words("answering")
    alone = (
        not clause.subject or {head, _head(clause.subject)} & _words("answers") or clause.subject.endswith(("'s", "’s"))
    )
    told = clause.verb in ("be", "come", "follow") and bool(alone)
    if not (says or told) or clause.denied:
        return []
    after = _after(clause)
    if says:
        at = next((at for at, word in enumerate(after) if word in ("with", "by")), None)
        after = () if at is None else after[at + 1 :]
    who = _owner(clause.subject) or clause.subject * says
    return [_meaning(clause, event, who) for event in _events_in(after)]


def _alone(clause: Clause) -> list[Clause]:
    """An event without a verb: "A yawn.", "Apart from a yawn"."""
    words = _after(clause)
    if clause.verb or not words:
        return []
    if words[0] in ("on", "off") and words[1:2] == ("with",):  # "off with the shoes"
        return [_meaning(clause, ("put" if words[0] == "on" else "take", words[0], *words[2:]))]
    led = next((at for at, word in enumerate(words[:4]) if word in ("a", "an", "another", "one")), None)
    before = words[: led or 0]
    if led is None or not (set(before) <= grammar().adverbs | grammar().joints or before[0] in _words("besides")):
        return []
    return [replace(_meaning(clause, event), aside=False) for event in _events_in(words[led:])]


def _events_in(words: Sequence[str]) -> list[tuple[str, ...]]:
    """The deeds of events that words begin with, and what they are done to: of "a shake of the head" shake the head."""
    known = grammar()
    marks = known.marks - {"to"} | known.numbers | {"one"}
    if not words or words[0] not in marks:
        return []
    ends = known.prepositions | known.adverbs | marks | _ON | {"and", ""}
    for at, word in enumerate(words[1 : _MOST_BEFORE_EVENT + 2], 1):
        after = tuple(words[at + 1 :])
        if (event := event_of(word)) and (*after, "")[0] in ends:
            joined = after[after[:1] == ("and",) :]
            if others := _events_in(joined):
                return [(event,), *others]
            return [(event, *after[after[:1] == ("of",) :])]
        if not (is_adjective(word) or is_adverb(word)):
            return []
    return []


def light_readings(lemmas: Sequence[str]) -> list[tuple[str, ...]]:
    """What a verb means that only says that the deed of a noun is done: "gives the pot a stir" is stirs the pot."""
    if not lemmas or lemmas[0] not in _words("light"):
        return []
    ones = [at for at, word in enumerate(lemmas[:7]) if at and word in ("a", "an", "another", "one", "some")]
    given = lemmas[0] == "give" and len(lemmas) > 1 and lemmas[1] in grammar().marks - {"a", "an"}  # "gives the pot a"
    for at in ones[-1:] if given else [one for one in ones[:1] if one <= _FEWEST]:
        for place in range(at + 1, min(at + _MOST_BEFORE_EVENT + 1, len(lemmas))):
            word, after = lemmas[place], lemmas[place + 1 :]
            if (
                verb_of(word) == word
                and is_noun(word)
                and (not after or not is_noun(after[0]) or after[0] in grammar().prepositions)
            ):
                rest = after[1:] if after[:1] == ("of",) else after
                return [(event_of(word) or word, *lemmas[1:at], *rest)]
            if not (is_adjective(word) or is_adverb(word)):
                break
    return []


_CONSTRUCTIONS: Final[tuple[Callable[[Clause], list[Clause]], ...]] = (
    _of_feeling,
    _of_limbs,
    _of_event,
    _in_event,
    _of_hands,
    _held,
    _way,
    _carried,
    _received,
    _moved,
    _done_to,
    _by_event,
    _noted,
)
