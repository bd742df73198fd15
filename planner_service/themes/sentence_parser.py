"""English sentences taken apart: stretches with one verb each, in the order of time, without their subjects.

Which words are verbs: enough of English to tell where one event of a theme ends and the next begins.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import Final

from planner_service.scripts.emotions import feelings

_REGULAR_WORDS: Final = """\
accept ache act add admire adore agree aim allow amuse announce annoy answer apologise apologize appear applaud apply
approach argue arrange arrive ask attack avoid awake bake bang bathe beg behave believe boil bother bounce bow breathe
brush bump burst button call calm care carry celebrate change chase chat check cheer chew choke chuckle clap clean
clear click climb close collapse collect comb comfort compare complain complete confuse console continue cook cool
cough count cover crack crash crawl cross cry cuddle curl curse cycle dance dash daydream decide decline decorate
delay deliver depart despair dial die dine disagree disappear discover discuss dislike divorce doze drag dress drift
drop drown drum dry dust earn empty end enjoy enter escape examine exercise exhaust exit expect explain explore
explode fade fail faint fall fear fetch fill finish fix flee flip flop focus fold follow fool forgive fret frown
fumble gallop gather gaze giggle glance glare grab greet grieve grin groan grope grumble guess hang happen hate help
hesitate hide hope hug hum hunt hurry imagine improvise insult invite iron jog joke juggle jump kick kiss kneel knit
knock laugh leap lean learn leave lift light limp linger listen live loathe lock long look loosen lounge love manage
march marry massage matter meditate mend miss mix moan mop mourn move mumble murmur nap need nod notice offer open
order organise organize overcome oversleep overturn pace pack paint panic pant part pass pause peek peel peer phone
pick place plan plant play plop plunge point polish ponder pop pour practise practice praise pray prepare press
pretend print promise promote propose protest prowl pull punch push puzzle quarrel quit race rage rant reach realise
realize receive recall recline record recover refuse regret rehearse reject rejoice relax relive remember remind
repair repeat replace reply rescue rest return rinse roam roar rock roll ruin rummage rush savour savor scold scramble
scratch scream scrub search seem select settle shiver shop shout shriek shrug shuffle sigh sip skip slam slip slouch
slump smash smile smoke snack sneak sneeze snooze snore snuggle sob spill splash spy squeeze stack stagger stare start
startle stay stir stomp stop storm straighten stress stretch stroke stroll study struggle stumble succeed suffer
surprise survive suspect swallow sway swoon talk tap taste tease telephone tempt test text thank tickle tidy tie
tiptoe toast toss touch trace train travel treat tremble trip trot try tuck tumble turn twirl type undress unlock
unpack unwind unwrap use vacuum visit vomit wait wake walk wander want warm wash waste watch water wave welcome
whisper whistle win wipe wish wobble wonder work worry wrap yawn yell zone reflect reminisce mull scan sort sweep
tackle tire"""
_IRREGULAR_FORMS: Final = """\
is are was were be been being am has have had having does do did doing done goes go went going gone gets get got
getting gotten becomes become became becoming feels feel felt feeling sees see saw seeing seen hears hear heard
hearing finds find found finding loses lose lost losing wins win won winning runs run ran running sits sit sat sitting
stands stand stood standing lies lie lay lying lays laid laying sleeps sleep slept sleeping drinks drink drank
drinking drunk eats eat ate eating eaten reads read reading writes write wrote writing written tells tell told telling
says say said saying thinks think thought thinking knows know knew knowing known takes take took taking taken brings
bring brought bringing buys buy bought buying catches catch caught catching comes come came coming cuts cut cutting
draws draw drew drawing drawn drives drive drove driving driven falls fall fell falling fallen fights fight fought
fighting flies fly flew flying flown forgets forget forgot forgetting forgotten gives give gave giving given grows
grow grew growing grown hides hide hid hiding hidden hits hit hitting holds hold held holding hurts hurt hurting keeps
keep kept keeping leaves leave left leaving lets let letting lights lit lighting makes make made making means mean
meant meets meet met meeting pays pay paid paying puts put putting rings ring rang ringing rung rises rise rose rising
risen sells sell sold selling sends send sent sending sets set setting shakes shake shook shaking shaken shows show
showed shuts shut shutting sings sing sang singing sung sinks sink sank sinking sunk speaks speak spoke speaking
spoken spends spend spent spending spins spin spun spinning steals steal stole stealing stolen sweeps sweep swept
sweeping swears swear swore swearing swims swim swam swimming teaches teach taught teaching tears tear tore tearing
throws throw threw throwing thrown understands understand understood wakes wake woke waking woken wears wear wore
wearing weeps weep wept weeping breaks break broke breaking broken begins begin began beginning begun bites bite bit
biting blows blow blew blowing builds build built building burns burn burnt burning chooses choose chose choosing
chosen creeps creep crept creeping dreams dream dreamt dreaming freezes freeze froze freezing oversleeps overslept
plays staying kneels knelt leans leant leaps leapt ponders reflects hangs hung sweats sweat shoots shoot shot strikes
strike struck sneaks snuck"""
_NOUN_MARK_WORDS: Final = """a an the his her their my your our its some any no every each this that these those of for
from with without in on at by into under about two three old new good bad long big little more another hot during"""
_NOUN_MARKS: Final = frozenset(_NOUN_MARK_WORDS.split())
"""Words after which a verb-like word is a noun: "a walk", "his dreams", "for work"."""
_SUBJECTS: Final = frozenset(("he", "she", "they", "it", "i", "we", "you", "who"))


def has_verb(text: str) -> bool:
    """Whether some word of the text acts as a verb: a known form that does not follow a noun's mark, or any word right
    after a pronoun ("he yodels")."""
    words = re.findall(r"[a-z]+(?:'[a-z]+)?", text.lower())
    for index, word in enumerate(words):
        before = words[index - 1] if index else ""
        if before in _SUBJECTS or (before == "to" and word in _forms()):
            return True
        if word in _forms() and before not in _NOUN_MARKS:
            return True
    return False


def is_verb(word: str) -> bool:
    """Whether the word is a form of a verb we know."""
    return word.lower() in _forms()


@cache
def _forms() -> frozenset[str]:
    forms = set(_IRREGULAR_FORMS.split())
    for verb in _REGULAR_WORDS.split():
        forms |= {verb, *_inflected(verb)}
    return frozenset(forms)


def _inflected(verb: str) -> set[str]:
    """The forms in -s, -ed and -ing, with and without a doubled last letter."""
    if re.search(r"[^aeiou]y$", verb):
        return {verb[:-1] + "ies", verb[:-1] + "ied", verb + "ing"}
    if verb.endswith("e"):
        return {verb + "s", verb + "d", verb[:-1] + "ing", verb + "ing"}
    plural = verb + ("es" if re.search(r"(?:s|x|z|ch|sh)$", verb) else "s")
    doubled = (
        {verb + verb[-1] + "ed", verb + verb[-1] + "ing"} if re.search(r"[^aeiou][aeiou][bdgklmnprt]$", verb) else set()
    )
    return {plural, verb + "ed", verb + "ing"} | doubled


_PEOPLE: Final = (
    "person|character|man|woman|boy|girl|guy|student|child|kid|father|mother|writer|worker|old man|old woman"
)
_SUBJECT: Final = re.compile(
    rf"^(?:(?:(?:the|a|an|this|our|one|some)\s+)?(?:\w+\s+)?(?:{_PEOPLE})|he|she|they|someone|somebody)\s+"
    r"(?=\w)(?!of\b|in\b|on\b|at\b|with\b)",
    re.IGNORECASE,
)
_PRONOUN: Final = r"(?:he|she|they|it|the|a|an|his|her|their|someone|somebody|everything|nobody)"
_ABBREVIATION: Final = re.compile(r"\b(Mr|Mrs|Ms|Dr|St|Prof)\.", re.IGNORECASE)
_SENTENCE: Final = re.compile(r"(?<=[.!?])[\"'”’)]*\s+|\n+|[;:]\s+|\s+[–—-]\s+|…|\.{2,}")
_BULLET: Final = re.compile(r"^\s*(?:\d{1,2}[.)]|[-*•])\s+")
_LATER: Final = r"(?:then|afterwards?|after that|later|finally|eventually|suddenly|next(?! to)|soon|at last|in the end)"
_JOINT: Final = re.compile(
    r"\s*,?\s*\b(?P<word>"
    rf"(?:and|but|so)?,?\s*{_LATER}(?=[\s,])|and so|and|but|so(?=\s+{_PRONOUN}\b)|yet(?=\s+{_PRONOUN}\b)"
    rf"|before|after|until|when(?:ever)?|while|because|as soon as|once(?=\s+{_PRONOUN}\b)|since(?=\s+{_PRONOUN}\b)"
    rf"|as(?=\s+(?:he|she|they|it)\b)|although|though"
    r")\b,?\s*|\s*,\s*",
    re.IGNORECASE,
)
_BY_THEN: Final = re.compile(
    r"^(before|after|during|until) ((?:the|his|her|their|a|an) (?:\w+ )?\w+)"
    r" (?=(?:he|she|they|the \w+|(?-i:[A-Z])\w+)\b)",
    re.IGNORECASE,
)
"""A time that is told by a thing, with no comma after it: "before the interview he is nervous"."""
_ANOTHER: Final = re.compile(r"^(?:someone|somebody)\b.*\b(?:his|her|him)\b", re.IGNORECASE)
"""Somebody who does something to whom the story is about."""
_GOES_ON: Final = re.compile(r"^(?:it|everything|all) (?:is|was|gets|got|becomes|became)\b", re.IGNORECASE)
_NO_NAME_WORDS: Final = """thunder lightning rain snow wind music hunger fear sleep love work lunch dinner breakfast
nothing everything noise guests friends summer winter spring autumn money nobody everybody somebody someone everyone"""
_NO_NAMES: Final = frozenset(_NO_NAME_WORDS.split())
"""What stands before a verb at the beginning of a sentence and is nobody's name."""
_EARLIER: Final = frozenset(("after", "when", "whenever", "because", "as soon as", "once", "since", "as"))
"""What follows these happened first."""
_STATE: Final = re.compile(
    r"^(?:(?:is|are|was|were|feel|feels|felt|become|becomes|became|get|gets|got|grow|grows|grew|seems?|being|turns?)\b)"
    r"(?P<rest>.*)$",
    re.IGNORECASE,
)
_FILLER_WORDS: Final = """very really so too quite extremely deeply totally a bit little more and at first again now
suddenly all completely rather still finally even then or much no not longer any anymore"""
_FILLER: Final = frozenset(_FILLER_WORDS.split())
STRONG: Final = re.compile(r"\b(?:very|extremely|deeply|totally|completely|terribly|utterly)\b", re.IGNORECASE)


@dataclass(frozen=True)
class _Piece:
    """A stretch of a sentence and the word that joined it to the one before."""

    joint: str
    text: str


def sentences_of(text: str) -> list[str]:
    """The sentences, lines and list items of a text, without marks at their ends."""
    parts = _SENTENCE.split(_ABBREVIATION.sub(r"\1", _BULLET.sub("", text)))
    return [_BULLET.sub("", part).strip(" .!?,\"'“”‘’()") for part in parts if part.strip(" .!?,\"'")]


def moments_of(sentence: str) -> list[str]:
    """What happens in a sentence, one stretch of it a moment, in the order of time."""
    return [piece.text for piece in _in_time(_whole(_pieces(sentence)))]


def _pieces(sentence: str) -> list[_Piece]:
    """The sentence cut at commas and joining words."""
    sentence = _BY_THEN.sub(r"\1 \2, ", sentence)
    pieces, joint, start = [], "", 0
    for match in _JOINT.finditer(sentence):
        if sentence[start : match.start()].strip():
            pieces.append(_Piece(joint, sentence[start : match.start()].strip()))
            joint = ""
        joint = _plain(match["word"] or ",") if joint in ("", ",") else joint
        start = match.end()
    if sentence[start:].strip():
        pieces.append(_Piece(joint, sentence[start:].strip()))
    return pieces


def _plain(joint: str) -> str:
    return " ".join(joint.lower().replace(",", " ").split()) or ","


def _whole(pieces: list[_Piece]) -> list[_Piece]:
    """Pieces without a verb put to the one before them ("bread and butter"), or to the one after ("one evening")."""
    whole: list[_Piece] = []
    waiting: _Piece | None = None
    for piece in pieces:
        if waiting is not None:
            piece = _led_by(waiting, piece)
            waiting = None
        if has_verb(piece.text) and not (whole and _only_describes(piece)):
            whole.append(piece)
        elif whole:
            last = whole[-1]
            link = ", " if piece.joint == "," else f" {piece.joint} "
            whole[-1] = _Piece(last.joint, last.text + link + piece.text)
        else:
            waiting = piece
    return [*whole, waiting] if waiting is not None else whole


def _led_by(lead: _Piece, piece: _Piece) -> _Piece:
    """A piece with the verbless one before it: "after dinner, …", or "the character" of "the character then …"."""
    if lead.joint in ("before", "until"):
        return _Piece("", f"{piece.text} {lead.joint} {lead.text}")
    if lead.joint in _EARLIER:
        return _Piece("", f"{lead.joint} {lead.text}, {piece.text}")
    return _Piece(lead.joint, f"{lead.text}{', ' if piece.joint == ',' else ' '}{piece.text}")


def _only_describes(piece: _Piece) -> bool:
    """Whether it says how or how long something is done ("laughing loudly", "drunk"), not what happens next."""
    words = piece.text.lower().split()
    if piece.joint == "until":
        return _GOES_ON.match(piece.text) is not None
    if piece.joint != "," or len(words) > 3:
        return False
    felt = [word for word in words if word not in _FILLER]
    return (len(words) <= 2 and words[0].endswith("ing")) or (bool(felt) and all(feelings(word) for word in felt))


def _in_time(pieces: list[_Piece]) -> list[_Piece]:
    """Pieces in the order they happen: "B after A" is A, B; "before B, A" is A, B; "glad when A" stays one."""
    ordered: list[_Piece] = []
    first_is_later = bool(pieces) and pieces[0].joint == "before" and len(pieces) > 1
    for piece in pieces:
        if not ordered or piece.joint not in _EARLIER:
            ordered.append(piece)
            continue
        main = ordered[-1]
        if state_words(without_subject(main.text)) is not None:
            ordered[-1] = _Piece(main.joint, f"{main.text} {piece.joint} {piece.text}")
        elif piece.joint != "after" and re.search(r"^(?:\S+\s+){0,3}(?:is|are|was|were)\s+\w+ing\b", main.text):
            ordered.append(piece)  # "is sitting there when …": the sitting came first
        else:
            ordered.insert(len(ordered) - 1, piece)
    return [*ordered[1:], ordered[0]] if first_is_later else ordered


def without_subject(text: str) -> str:
    """The words without who does it: "the character is happy" is "is happy", "Anna reads" is "reads"."""
    short = text if _ANOTHER.match(text) else _SUBJECT.sub("", text, count=1)
    named = re.match(r"^[A-Z][a-z]+\s+(?=([a-z]+)\b)", short)
    first = short.split()[0].lower() if short else ""
    if short == text and named and is_verb(named[1]) and not is_verb(first) and first not in _NO_NAMES:
        short = short[named.end() :]
    return short if has_verb(short) else text


def state_words(text: str) -> str | None:
    """The feeling, where a clause says nothing but how somebody feels ("becomes very sad" is "very sad")."""
    state = _STATE.match(text)
    if state is None:
        return None
    rest = state["rest"].strip()
    words = [word for word in re.findall(r"[\w-]+", rest.lower()) if word not in _FILLER]
    return rest if words and all(feelings(word) for word in words) else None
