"""What happens in a theme, told in nearly the theme's own words: events as sentences in the past."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from motion_backend.motion import Character
from planner_service.narration.narrative_voice import Voice, retell
from planner_service.narration.tense import base_of, base_of_gerund, is_past
from planner_service.scripts.emotions import feelings
from planner_service.themes.lexicon import english_verbs, is_verb_form, past, third_person
from planner_service.themes.protagonist import cast_by, name_in

_MAX_QUOTED_WORDS: Final = 24
"""Words of an event's own text that a story may quote."""
_MAX_EVENTS_PER_SENTENCE: Final = 3
"""Events in one sentence."""
_WEATHER: Final = re.compile(
    r"(?:is|was) (?:raining|snowing|storming)\b|(?:starts|begins) to (?:rain|snow)\b|(?:rains|snows)\b"
)
_RUN_ON: Final = re.compile(
    r"^(?:an?|the)\b.*(?<!,)(?<!\band)(?<!\bbut)(?<!\bso)(?<!\bthat)(?<!\bwhen)(?<!\bwhile)(?<!\bas)"
    r" (?:he|she|they)\b"
)
"""A noun and then a clause of its own: the word that joined them was lost."""
_HERO: Final = re.compile(
    r"(?:the|an?) (?:\w+ )??(?P<kind>teenager|detective|widower|widow|student|writer|artist|nurse|teacher|worker"
    r"|musician|painter|poet|scientist|professor|kid|child|grandmother|grandfather|grandma|grandpa|mother|father|actor|actress"
    r"|programmer|engineer|gardener|lady|gentleman|man|woman|boy|girl|guy|couple|cook|chef|singer|soldier"
    r"|pensioner|traveller|tourist|journalist|lawyer|farmer|pilot|novelist|dancer|gamer|bachelor|loner)\b",
    re.IGNORECASE,
)
_DETERMINED: Final = frozenset(
    ("the", "a", "an", "he", "she", "they", "his", "her", "their", "it", "there", "somebody", "someone", "nobody")
)
_SUBJECTS: Final = frozenset(("he", "she", "they"))
_OBJECTS: Final = frozenset(("him", "them"))
"""Who is not the subject of a clause that they are the object of."""
_OTHERS: Final = {"he": frozenset(("she", "her", "hers", "herself")), "she": frozenset(("he", "him", "his", "himself"))}
"""By the pronoun of the theme's person, those that stand for somebody else."""
_BASE_VERB: Final = re.compile(r"\band (\w+) (?=\w+ly\b|around\b|about\b|through\b|into\b|home\b)")
_LOST_SUBJECT: Final = re.compile(
    r"(?:^|[.,;!?] |\b(?:and|but|so|until|when|because|while|then|that) )(?P<who>she|he|they|(?:his|her|their|my) \w+) "
    r"(?:\w+ly |then |also |even )?$",
    re.IGNORECASE,
)
_PLURAL: Final = re.compile(
    r"\b((?:the|his|her|their|its)(?: \w+)? [\w-]+s)"
    r" (?!(?:calm|clean|clear|cool|dry|empty|free|open|slow|tidy|warm)\b)(\w+)\b",
    re.IGNORECASE,
)
"""Several and what they do: "the bills keep"; words that may say how they are left out."""
_FIRST_PERSON: Final = (
    (r"\bI['’]m\b|\bI am\b", "the character is"),
    (r"\bI['’]ve\b|\bI have\b", "the character has"),
    (r"^My\b", "The character's"),
    (r"\bmy\b", "their"),
    (r"\bme\b", "them"),
    (r"\bmyself\b", "themself"),
)
_FRAGMENT: Final = re.compile(r"(?:with|without|late|after|before|during|on|in|at|by)\b", re.IGNORECASE)


def happening(event: str, theme: str, voice: Voice, named: bool = False) -> str | None:
    """An event as a sentence of the voice in the past, or None where the rules are not sure of its grammar.

    Words that taking the theme apart had lost are looked up in the theme: joints, and who else does it.
    """
    hero = cast_by(theme, Character())
    start, text = _in_theme(event, theme)
    lost = _LOST_SUBJECT.search(theme[:start]) if start > 0 else None
    others = _OTHERS.get(hero.pronouns, frozenset()) & set(re.findall(r"\w+", theme.lower()))
    first = text.split()[0].lower() if text.split() else ""
    if lost and (is_verb_form(first) or first in english_verbs().bases):
        who = lost["who"].lower()
        if " " in who or who in others or (who == "they" and hero.pronouns in _OTHERS):
            verb = third_person(first) if first in english_verbs().bases and not is_verb_form(first) else first
            text = f"{lost['who']} {verb}{text[len(first) :]}"
            others |= {"they"} if who == "they" else frozenset()
        else:
            text = _agreeing(first) + text[len(first) :]
    elif first in english_verbs().bases and re.search(r"\b(?:they|we|I)\b", theme, re.IGNORECASE):
        text = _agreeing(first) + text[len(first) :]
    text = _with_noun(text, theme[: max(start, 0)], hero.pronouns)
    return event_retold(told_of_hero(text, theme), voice, named, others)


def _with_noun(text: str, before: str, hero: str) -> str:
    """Those whom the event does something to, "them", called by the noun that the theme has before."""
    if hero not in _OTHERS or not re.search(r"\bthem\b", text) or re.search(r"\bthey\b", text, re.IGNORECASE):
        return text
    nouns = [word for word in re.findall(r"\b[A-Za-z]\w+s\b", before) if _is_plural(word.lower())]
    return re.sub(r"\bthem\b", f"the {nouns[-1].lower()}", text, count=1) if nouns else text


def _is_plural(word: str) -> bool:
    """Whether a word in -s is a noun, as far as that can be told."""
    return not (is_verb_form(word) or word.endswith(("ss", "us", "is", "ous")) or word in ("always", "towards", "his"))


def told_together(events: Sequence[str], theme: str, voice: Voice, named: bool = False) -> list[str]:
    """Events as sentences, in one where the theme joins them and it does not get too long."""
    told: list[str] = []
    before, together = "", 0
    for event in events:
        sentence = happening(event, theme, voice, named or bool(told))
        joint = joint_between(theme, before, event) if told and sentence else ""
        words = len(told[-1].split()) + len(sentence.split()) if told and sentence else 0
        if joint and sentence and words <= _MAX_QUOTED_WORDS and together < _MAX_EVENTS_PER_SENTENCE:
            told[-1] = _with(told[-1], joint, sentence, voice)
            together += 1
        elif sentence:
            told.append(sentence)
            together = 1
        before = event
    return told


def _with(told: str, joint: str, sentence: str, voice: Voice) -> str:
    """Two sentences as one; the second loses its subject where both have the same."""
    they = voice["they"].capitalize()
    same = told.startswith((f"{voice.name} ", f"{they} ")) and sentence.startswith(f"{they} ")
    inner = sentence if sentence.startswith(voice.name) else sentence[:1].lower() + sentence[1:]
    if joint == "before":
        return f"{told[:-1]} before {inner}"
    if joint == "so" or not same or _SUBORDINATE.search(told):
        return f"{told[:-1]}, {joint} {inner}"
    if joint == "and" and _coordinated(sentence) and not _coordinated(told):
        return f"{told[:-1]}, {sentence[len(they) + 1 :]}"
    if joint == "and" and _coordinated(told):
        return f"{told[:-1]}, {'and' if ', then' in told else 'then'} {sentence[len(they) + 1 :]}"
    return f"{told[:-1]} {joint} {sentence[len(they) + 1 :]}"


def _coordinated(text: str) -> bool:
    """Whether a sentence tells of several deeds, "ate and slept", not only of "up and down"."""
    return "," in text or any(is_past(word) for word in re.findall(r" and (\w+)", text))


_SUBORDINATE: Final = re.compile(
    r"\b(?:because|when|that|while|if|who)\b|\b(?:as|until|before|after) (?:it|he|she|they|somebody|someone|[A-Z]\w+)\b"
)
"""A clause that a verb after it would be taken for a part of."""


def joint_between(theme: str, before: str, after: str) -> str:
    """How the theme joins two events: and, but, so, before; "" where it does not."""
    (first, words), (second, others) = _in_theme(before, theme), _in_theme(after, theme)
    if first < 0 or second < 0:
        return ""
    if second < first:
        between = theme[second + len(others) : first].lower()
        led = theme[max(0, second - 14) : second].lower()
        if re.search(r"\bbecause\b", between) and not re.search(r"[.;:!?]", between):
            return "so"
        return "before" if re.search(r"\bbefore (?:\w+ )?$", led) and re.match(r",[^.;:!?]*$", between) else ""
    between = theme[first + len(words) : second].lower()
    if len(between) > 25 or re.search(r"[.;:!?]|\b(?:until|because|while|when|as|that|before|after|if)\b", between):
        return ""
    found = re.search(r"\b(?:but|so)\b", between)
    return found[0] if found else "and"


def fragment(event: str) -> str:
    """An event that is no clause but says when or how the next one is: "With nothing to do"; else ""."""
    text = event.strip().rstrip(".!?,;")
    words = text.lower().split()
    verbs = any(is_verb_form(word) and before != "to" for before, word in zip(["to", *words], words, strict=False))
    return text if _FRAGMENT.match(text) and len(words) <= 10 and not (verbs or "," in text) else ""


def _in_theme(event: str, theme: str) -> tuple[int, str]:
    """Where an event stands in the theme, and its words there with the joints between them; -1 where it does not."""
    words = re.findall(r"[\w'’-]+", event)
    found = re.search(r"\W+(?:(?:and|but|so|then) )?".join(map(re.escape, words)), theme) if words else None
    return (found.start(), found[0]) if found else (-1, event.strip())


def told_of_hero(event: str, theme: str) -> str:
    """An event with the theme's own person called "the character", also where the theme's "and she" was lost."""
    text = re.sub(r"\bin the phone\b", "on the phone", event.strip())
    text = re.sub(r"^(?:he|she)['’]s\b", "is", text, flags=re.IGNORECASE)
    for pattern, words in _FIRST_PERSON:
        text = re.sub(pattern, words, text)
    text = re.sub(r"\bI (\w+)", lambda m: f"the character {_agreeing(m[1])}", text)
    if name := name_in(theme):
        text = re.sub(rf"\b{re.escape(name)}\b", "the character", text)
    hero = _HERO.match(theme.strip())
    if hero:
        text = re.sub(rf"^(?:the|an?) (?:\w+ )?{hero['kind']}\b(?!['’])", "The character", text, flags=re.IGNORECASE)
        text = re.sub(r"^The character (\w+)", lambda m: f"The character {_agreeing(m[1])}", text)
    text = _BASE_VERB.sub(lambda m: f"and {third_person(m[1])} " if m[1] in english_verbs().bases else m[0], text)
    if text.lower().startswith(("his ", "her ", "their ", "the ", "a ", "an ")) and not text.startswith(
        "The character"
    ):
        for joint in re.finditer(r" and (\w+ \w+)", text):
            lost = re.search(rf"\b(?:he|she|they) {re.escape(joint[1])}", theme, re.IGNORECASE)
            if lost or (joint[1].startswith(("becomes ", "gets ", "feels ")) and feelings(joint[1])):
                return f"{text[: joint.start()]} and the character{text[joint.start() + 4 :]}"
    text = re.sub(r"\bbecomes drunken\b", "becomes drunk", text)
    return _listed(_PLURAL.sub(lambda m: f"{m[1]} {_agreeing(m[2])}", text))


def _listed(text: str) -> str:
    """Three things or more, one after the other: "wins, calls his brother and celebrates"."""
    before, comma, clause = text.partition(", the character ")
    if comma:
        return f"{before}{comma}{_listed(clause)}"
    parts = re.split(r",? and (?=\w+)|, (?=\w+)", text)
    verbs = all(is_verb_form(part.split()[0]) for part in parts[1:] if part.split())
    return ", ".join(parts[:-1]) + " and " + parts[-1] if len(parts) > 1 and verbs else text


def _agreeing(verb: str) -> str:
    """A base form as he, she and it have it: run → runs; any other word as it is."""
    return third_person(verb) if verb in english_verbs().bases and not is_past(verb) else verb


_UNKNOWN_VERB: Final = re.compile(
    r"^((?:the|an?|his|her|their) (?!character\b)\w*[a-rt-z]) ([a-z]{3,}[^s\W]s)\b", re.IGNORECASE
)
"""One thing or person and a verb: "the neighbour drills"."""


def event_retold(event: str, voice: Voice, named: bool = False, others: frozenset[str] = frozenset()) -> str | None:
    """An event of the theme as a sentence in the past, or None where the rules are not sure of its grammar.

    The pronouns of `others` stand for somebody else than the voice.
    """
    text = event.strip().rstrip(".!?")
    words = re.sub(r"[,;]", "", text.lower()).split()
    if not words or len(words) > _MAX_QUOTED_WORDS:
        return None
    if _WEATHER.match(text):
        return (told := retell(f"It {text}", voice, named)) and told + "."
    if _RUN_ON.search(text):
        return None
    verb = next((word for word in words[:2] if not word.endswith("ly")), "")
    if base := base_of_gerund(verb):
        text, verb = re.sub(rf"\b{verb}\b", third_person(base), text, count=1, flags=re.IGNORECASE), third_person(base)
    guessed = (
        base_of(verb)
        and len(words) > 1
        and words[1] not in ("and", "of")
        and words[1] not in english_verbs().bases
        and not is_verb_form(words[1])
    )
    if is_verb_form(verb) or is_past(verb) or guessed:
        text = f"The character {text}"
        others |= frozenset() if _SUBJECTS.intersection(words) else _OBJECTS
    elif words[0] not in _DETERMINED and "the character" not in text.lower() and not _predicated(words):
        return None
    text = _UNKNOWN_VERB.sub(lambda m: m[0] if is_verb_form(m[2]) else f"{m[1]} {past(base_of(m[2]) or m[2])}", text)
    told = retell(text, voice, named, others)
    return told and told + "."


def _predicated(words: list[str]) -> bool:
    """Whether one of the words after the first is a verb that cannot be anything else."""
    return any(is_verb_form(word) and before != "to" for before, word in pairwise(words[:5]))


_LINK = re.compile(
    r"\b(?P<word>and so|so|but then|but|however|suddenly|finally|eventually|at last|afterwards|later)"
    r"\b,?\s+(?:\w+ ){0,2}$",
    re.IGNORECASE,
)
_LINKS = {
    "so": "So", "and so": "So", "but": "But", "but then": "But then", "however": "But", "suddenly": "Suddenly",
    "finally": "Finally", "eventually": "Eventually", "at last": "At last", "afterwards": "Afterwards",
    "later": "Later",
}  # fmt: skip


def link_before(theme: str, event: str) -> str:
    """The theme's own word between an event and what comes before it, as a sentence may begin with it, or ""."""
    at = theme.find(event[:20]) if event else -1
    match = _LINK.search(theme[max(0, at - 40) : at]) if at > 0 else None
    return _LINKS[match["word"].lower()] if match else ""
