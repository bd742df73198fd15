"""A theme told again in its own sentences: in the past, of the story's person.

Words are changed one by one where their forms tell what they are; what is not sure stays as it was written.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Final

from planner_service.narration.beat_stretches import (
    SUBJECTS,
    Retelling,
    Stretch,
    Token,
    located,
    runs_of,
    sentence_ends,
    tokens_of_theme,
)
from planner_service.narration.narrative_voice import Voice
from planner_service.narration.story_words import story_words
from planner_service.narration.tense import bases, form_of, in_past
from planner_service.scripts.script import Beat
from planner_service.themes.beats import EXPRESSIONS
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar, is_adjective, is_noun, is_verb, kinds_of, lemma_of, past
from planner_service.themes.prose import prose_of
from planner_service.themes.protagonist import called, head_of, hero_of
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from planner_service.themes.verb_finder import is_plural
from scene_graphs.furniture import is_known

_ANYBODY: Final = frozenset(("person", "character", "protagonist", "man", "woman", "human", "someone", "somebody"))
"""Nouns that a name says all of."""
_NO_ONE_PERSON: Final = frozenset(("who", "which", "that", "everyone", "everybody", "nobody", "all", "both"))
_NOBODY: Final = ("person", "character", "protagonist")
"""Those of them that are no words of a story."""
_FIRST: Final = {
    "i": "they", "me": "them", "my": "their", "mine": "theirs", "myself": "themself",
    "we": "they", "us": "them", "our": "their", "ours": "theirs", "ourselves": "themself",
}  # fmt: skip
_SECOND: Final = {"you": "they", "your": "their", "yours": "theirs", "yourself": "themself"}
_THIRD: Final = {
    "he": {"he": "they", "him": "them", "his": "their", "himself": "themself"},
    "she": {"she": "they", "her": "their", "hers": "theirs", "herself": "themself"},
    "they": {"they": "they", "them": "them", "their": "their", "theirs": "theirs", "themselves": "themself"},
}
_OWNS: Final = re.compile(r"\s+(?!(?:and|to|in|on|at|with|from|for|by|as|of|the|a|an|his|that)\b)\w")
"""What follows "her" where it owns that."""
_BASE_AFTER: Final = frozenset(("can", "will", "may", "must", "could", "would", "might", "should", "shall", "to", "not",
                                "did", "does", "do", "let", "lets", "cannot"))  # fmt: skip
"""Words before a verb that has no tense."""
_TOLD_IN_PAST: Final = frozenset(("was", "were", "had", "did", "could", "would", "might", "should"))
_AMBIGUOUS: Final = frozenset(("can", "will", "may", "must", "do", "have", "being", "been", "be", "having", "doing"))
"""Helpers that are told in the past only after a subject."""
_SINGULAR: Final = frozenset(("he", "she", "it", "who"))
_PLURAL: Final = frozenset(("i", "we", "you", "they"))
"""Who does things in verbs' base forms."""
_ASKS: Final = grammar().auxiliaries | {"what", "which", "how", "where", "why", "who", "whose", "when"}
"""Words that questions begin with."""
_TAKEN: Final = frozenset(("it", "him", "her", "them", "the", "a", "an", "his", "their", "himself", "herself"))
"""Words that what ends in -s before them does something to: "finds it", "a power cut catches him"."""
_TORN: Final = ("it", "them", "up", "open", "off", "the", "apart", "down", "out", "a", "one", "another", "each")
_TENSELESS: Final = ("ing", "participle")


def retell(theme: str, beats: Sequence[Beat], voice: Voice) -> Retelling:
    """A theme in the past, told of a voice's person."""
    theme = re.sub(r"(?<!\.)\.\.(?!\.)", ".", prose_of(theme))
    clauses = clauses_of_text(theme)
    hero = hero_of(clauses)
    order = next((one for one in clauses if not one.subject and (_begins_with_verb(one) or _is_order(one.text))), None)
    ordered = order is not None and (order is clauses[0] or not hero)
    hero = hero or ("you" if ordered else "")  # "Hide under the table, then crawl out"
    own = called(clauses, hero) or hero.lower()
    told = Retelling(tokens_of_theme(theme))
    told.stretches = [_with_verb(told.tokens, one, beats, clauses) for one in located(told.tokens, beats)]
    told.ends = sentence_ends(theme, told.tokens)
    several = own in _PLURAL or (own not in _SINGULAR and is_plural(head_of(hero).lower()))  # "two friends dance, sing"
    together = {one.text.split()[0].lower() for one in clauses if _are_several(one.doer)}  # "Emma and Luca | quarrel"
    _leave_questions(told)
    _put_in_past(told, plain=several, all_of_it=ordered or _is_present(told), together=together)
    if ordered:
        _say_who(voice, told, beats)
    _tell_of(voice, told.tokens, hero, own)
    if not ordered:
        _say_who(voice, told, beats)
    _capitalise(told)
    return told


def _are_several(doer: str) -> bool:
    return doer.lower() in _PLURAL or " and " in doer or is_plural(head_of(doer).lower())


def _with_verb(tokens: Sequence[Token], stretch: Stretch, beats: Sequence[Beat], clauses: Sequence[Clause]) -> Stretch:
    """A stretch without a verb where the words of its beat have none: "cups in the sink"."""
    text = beats[stretch.beat].text
    own = [one for one in clauses if text == one.text or text.endswith(f" {one.text}")]
    if own and own[0].led:  # "a yawn | escapes Martha"
        words = [at for at in range(stretch.start, stretch.end) if tokens[at].is_word]
        return replace(stretch, verb=words[own[0].led]) if len(words) > own[0].led else stretch
    told = [one.verb for one in own]
    return replace(stretch, verb=None) if told and not (any(told) or _is_order(text)) else stretch


def _begins_with_verb(clause: Clause) -> bool:
    return clause.text.split()[0].lower() == clause.verb


def _is_order(text: str) -> bool:
    """Whether a word alone tells what is done, and names no thing: "Leave"."""
    word = text.lower()
    return " " not in text and word in bases(word) and not (word in things() or is_known(text))


def _leave_questions(told: Retelling) -> None:
    """Questions that are asked of nobody in the story stay as they are: "What if somebody practised?"."""
    for start, end in zip(told.starts, told.ends, strict=True):
        colon = next((at for at in range(end, start, -1) if told.tokens[at].text in ":;"), start)
        tokens = told.tokens[colon : end + 1]
        first = next((token.low for token in tokens if token.is_word), "")
        if (
            first in _ASKS
            and any(one.text == "?" for one in tokens[-2:])
            and {"he", "she"}.isdisjoint(one.low for one in tokens)
        ):
            for token in tokens:
                token.quoted = True


def _is_present(told: Retelling) -> bool:
    """Whether more of the beats' verbs are in the present than in the past, or somebody does something in it."""
    words = [token for token in told.tokens if token.is_word]
    heads = [told.tokens[one.verb] for one in told.stretches if one.verb is not None]
    now = any(
        before.low in ("he", "she") or before.text.istitle()
        for before, one in pairwise(words)
        if one in heads and not one.quoted and (form_of(one.low) == "present" or one.low in ("is", "has", "does"))
    )
    verbs = [told.tokens[one.verb].low for one in told.stretches if one.verb is not None]
    after = sum(verb in _TOLD_IN_PAST or form_of(verb) == "past" for verb in verbs)
    tenseless = sum(form_of(verb) in _TENSELESS for verb in verbs)
    return now or 2 * after <= len(verbs) - tenseless


def _put_in_past(told: Retelling, plain: bool, all_of_it: bool, together: Collection[str]) -> None:
    """Every finite verb, or what "I" and "you" do in the midst of what is past; `plain`: the theme's person does things
    in verbs' base forms, as two people do what is in `together`."""
    heads = {one.verb for one in told.stretches if one.verb is not None and not _is_list(told, one)}
    words = [(at, token) for at, token in enumerate(told.tokens) if token.is_word]
    joined = _joined_heads(told, together)
    low = ["", "", *_low(told.tokens), ""]
    for number, (at, token) in enumerate(words):
        days = story_words().days
        if not (all_of_it or (plain and {"i", "you"} & {one.strip(",") for one in low[number : number + 2]})):
            continue
        if pair := days.get(f"{token.low} {low[number + 3]}") if not token.quoted else None:
            token.told, words[number + 1][1].told = pair.split(" ", 1)
        elif number and _is_gone_to(words[number - 1][1], token, low[number + 3]):
            token.told = f"and {past(token.low)}"  # "went | and sat"
        elif not token.quoted and token.told == token.text:
            base = plain or at in joined or token.low in together
            new = days.get(token.low) or _past(low[number : number + 4], token.low, at in heads, base)
            token.told = (new.capitalize() if token.text[0].isupper() else new) if new else token.told


def _is_gone_to(before: Token, token: Token, follows: str) -> bool:
    """Whether a verb without an ending tells what somebody goes to do: "go sit at the desk", not "go home"."""
    goes = before.low in ("go", "come") and before.told in ("went", "came")
    is_noun_too = is_noun(token.low) and follows not in grammar().marks
    return goes and token.low in bases(token.low) and not (is_noun_too or is_adjective(token.low))


def _low(tokens: Sequence[Token]) -> Iterator[str]:
    """Words in small letters, with a comma before those that a mark parts from the one before."""
    mark = ""
    for token in tokens:
        if token.is_word:
            yield f"{mark}{token.low}"
            mark = ""
        elif not token.text.isspace():
            mark = ","


def _joined_heads(told: Retelling, together: Collection[str]) -> set[int]:
    """Verbs without an ending that go on from one that has it, or from what several do: "he becomes excited, | run
    around the house", "they kiss | and sit down"."""
    found = set[int]()
    for one, other in pairwise(told.stretches):
        if one.verb is None or other.verb is None or other.verb != other.start:
            continue
        between = "".join(token.text for token in told.tokens[one.end : other.start]).strip(" ,")
        if between not in ("", "and", "then") or "to" in told.words(one).lower().split():
            continue
        verb, *before = (token.low for token in told.tokens[one.verb :: -1] if token.is_word)
        several = verb in bases(verb) and (verb in together or {*before[:1]} & _PLURAL or one.verb in found)
        if several or form_of(verb) == "present":
            found.add(other.verb)
    return found


def _past(near: Sequence[str], word: str, head: bool, plain: bool) -> str | None:
    """A word, the third of four of `near`, in the past; None where it is no finite verb. `head`: whether a beat's verb
    stands there."""
    earlier, before, marked, follows = near
    before = before.lstrip(",") if marked == word else ","
    asked = earlier in story_words().helpers and not near[1].startswith(",")  # "did she fall"
    if (before in _BASE_AFTER and word not in ("is", "are")) or (asked and marked == word and word in bases(word)):
        return None
    if word == "am" and before != "i":
        return None  # "7 am"
    if word in story_words().helpers and word not in _TOLD_IN_PAST:
        after = before in SUBJECTS or (head and word in ("have", "do") and before)
        return _helper(word, before) if after or word not in _AMBIGUOUS | {"don't"} else None
    if word == "mean" and before in _PLURAL and follows == "to":
        return "meant"
    acts = before in _PLURAL or (
        head and (is_plural(before) or (plain and before == "and") or follows in grammar().marks | _TAKEN)
    )
    orders = plain and head and before in ("", ",")  # "Feed the cat": no past of a fee
    form, how = form_of(word), is_adjective(word) and not (acts or orders)
    base = word in bases(word) and not (how or _is_noun(word, before))
    form = None if orders and base else form
    if form == "present":
        joined = before in ("and", "or", "then") and follows in story_words().after_verbs.split()
        tears = word == "tears" and follows in _TORN  # no tears of somebody who weeps
        counted = before in grammar().numbers and earlier != "of"  # "twenty crunches", not "a girl of six runs"
        led = before in grammar().marks | grammar().prepositions or is_adjective(before) or counted
        sure = not led and (follows in _TAKEN or (not is_noun(word) and "VERB" in kinds_of(word)))
        finite = before in SUBJECTS or sure or ((head or joined) and not _is_noun(word, before))
        return in_past(word) if finite or tears else None
    if form is None and base and (before in _PLURAL or (head and (plain or before in _SINGULAR or is_plural(before)))):
        return past(word)
    return None


def _helper(word: str, before: str) -> str:
    several = word in ("are", "aren't") or before in ("they", "we", "you")
    return story_words().helpers[word].format(was="were" if several else "was")


def _is_noun(word: str, before: str) -> bool:
    """Whether a word in -s names things: "the keys", "hands"."""
    led = before in grammar().marks - {"other"} | grammar().prepositions | {"no", "some"}
    of_body = lemma_of(word) in theme_words()["body"] and lemma_of(word) not in EXPRESSIONS  # "grins"
    return led or of_body or not is_verb(word)


def _is_list(told: Retelling, stretch: Stretch) -> bool:
    """Whether a sentence begins with words that only name a thing, and where it goes: "Keys", "Shoes off"."""
    start = max(one for one in told.starts if one <= stretch.start)
    first, *rest = [token.low for token in told.tokens[stretch.start : stretch.end] if token.is_word]
    known = lemma_of(first) in things() or is_known(first)
    ways = grammar().adverbs | {"on", "off", "up", "down", "out", "in", "away", "first", "next"}
    opens = not any(token.is_word for token in told.tokens[start : stretch.start])
    return opens and known and len(rest) < 2 and all(word in ways or is_adjective(word) for word in rest)


def _tell_of(voice: Voice, tokens: Sequence[Token], hero: str, own: str) -> None:
    """The voice's pronouns in place of those of the theme's person, and its name where that is first spoken of."""
    mine = {"i": _FIRST, "we": _FIRST, "you": _SECOND}.get(hero.lower(), {}) if voice.pronouns != "I" else {}
    blanks = {**mine, **(_THIRD.get(own, {}) if voice.pronouns not in (own, "I") else {})}
    words = [(at, token) for at, token in enumerate(tokens) if token.is_word and not token.quoted]
    for at, token in words:
        if blank := blanks.get(token.told.lower()):
            owns = token.low != "her" or _OWNS.match("".join(one.text for one in tokens[at + 1 : at + 3]))
            first = blank == "their" and mine and not any(one.is_name for _, one in words)
            own = f"{voice.name}'s" if first else voice[blank if owns else "them"]  # "My father used to sing here"
            token.told, token.is_name = own, True
    _name(voice, tokens, hero)
    for (_, before), (_, token) in pairwise(words):
        if token.told in ("was", "were") and (before.told.lower() == "they" or before.told == voice.name):
            token.told = voice.was(before.told if before.told == voice.name else "they")


def _name(voice: Voice, tokens: Sequence[Token], hero: str) -> None:
    """The person's name for the first words for whom the theme is about; with these, where they tell more."""
    wanted = [token.low for token in tokens_of_theme(hero) if token.is_word]
    place = next(runs_of(tokens, wanted), None)
    for at in place or ():
        tokens[at].is_name = True
    after = next((one.low for one in tokens[place.stop if place else 0 :] if one.is_word), "")
    if place is None or wanted[0] in _NO_ONE_PERSON or (len(wanted) == 1 and after == "who"):
        return  # "He who never cried …"
    own = {token.low for token in tokens_of_theme(voice.name) if token.is_word} - grammar().marks
    if not own or own - {*wanted}:  # "a woman" is called "the woman" later
        noun = "".join(token.text for token in tokens[place.start : place.stop])
        plain = len(wanted) == 1 or {wanted[0], wanted[-1]} & _ANYBODY
        _call(tokens, place, voice.name if plain else f"{voice.name}, {noun[:1].lower()}{noun[1:]},")
    if wanted[-1] in _NOBODY:
        for article in ("the", "a"):
            for again in runs_of(tokens, [article, wanted[-1]]):
                _call(tokens, again, voice.name)


def _call(tokens: Sequence[Token], place: range, name: str) -> None:
    """Some tokens told as a name."""
    for at in place:
        tokens[at].told, tokens[at].is_name = "", True
    tokens[place.start].told = name


def _say_who(voice: Voice, told: Retelling, beats: Sequence[Beat]) -> None:
    """Who does what a sentence begins with: "Comes home." """
    named = voice.name.lower() in told.text.lower()
    for stretch in told.stretches:
        start = max(one for one in told.starts if one <= stretch.start)
        opens = not any(token.is_word or token.quoted for token in told.tokens[start : stretch.start + 1][:-1])
        verb = told.tokens[stretch.verb] if stretch.verb is not None else None
        later = {token.told.lower() for token in told.tokens[stretch.end : told.end_of(stretch)]}
        alone = later.isdisjoint({"he", "she", "they", *voice.name.lower().split()[-1:]})  # "slighted, Ida withdrew"
        asked = beats[stretch.beat].kind in ("deed", "feeling") and not beats[stretch.beat].who
        led = told.tokens[stretch.start : stretch.verb or stretch.start]
        named_so = any(one.is_word and one.low not in grammar().adverbs and not one.low.endswith("ly") for one in led)
        if opens and alone and verb is not None and asked and not named_so and _is_finite(verb):
            first = told.tokens[stretch.start]
            first.told = first.told[:1].lower() + first.told[1:]
            first.before, first.is_name = f"{voice['they'] if named else voice.name} ", True
            if verb.told == "was" and named:
                verb.told = voice.was(voice["they"])
            named = True


def _is_finite(verb: Token) -> bool:
    """Whether a verb is told in the past: "read" of "reads" is, of which the form alone tells nothing."""
    first = verb.told.split()[0].lower()
    same = first in bases(first) and past(first) == first  # "put"
    changed = first != verb.low or first in _TOLD_IN_PAST or same
    return changed or (form_of(first) == "past" and not is_adjective(first))


def _capitalise(told: Retelling) -> None:
    """Begin sentences with a capital where the theme does, and wherever other words begin them now."""
    for start in told.starts:
        first = next((one for one in told.tokens[start:] if one.before or (one.is_word and one.told)), None)
        if first is not None and first.before:
            first.before = first.before[:1].upper() + first.before[1:]
        elif first is not None and (first.text[:1].isupper() or start == 0):
            first.told = first.told[:1].upper() + first.told[1:]
