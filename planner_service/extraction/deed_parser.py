"""What a clause has a body do: the skill its verb means, the furniture it names, and what is no deed at all.

The clauses of a scene: who does what, in the order it is told, and in which mood.

English for what a body does: how a clause begins that tells of sitting, lying, rising, touching or going.

Each constant is a regular expression for the beginning of a clause without its subject; each line of it is one way.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Final

from motion_backend.motion import Skill
from planner_service.extraction.text_scenes import Line, TextScene
from planner_service.scripts.emotions import feelings
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import MAX_THEME_LENGTH, Clause, ThemeError, clauses_of, moods_of
from planner_service.themes.sentence_parser import is_verb, moments_of, sentences_of
from scene_graphs import furniture

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
_NAME_WORDS: Final = "James Thomas Charles Chris Nicholas Lucas Jonas Agnes Frances Iris Doris Louis Marcus Jess Tess"
_NAMES_IN_S: Final = frozenset(_NAME_WORDS.split())
_I: Final = re.compile(r"^(?:I|we)\s+(?=\w)")
_OTHER_WORDS: Final = """
The This That These Those There Then When While After Before Once Soon Now Later Outside Inside Nobody Everything
Nothing Something It He She They His Her Their Someone Somebody Everyone And But So Still At In On As If Finally
Suddenly Slowly Quietly Music Night Morning Evening Rain Silence Darkness Somehow Perhaps Maybe Not Only Just
"""
_NOT_NAMES: Final = frozenset(_OTHER_WORDS.split())
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
    if name.endswith("s") and name not in _NAMES_IN_S:
        return False  # "Clouds hung over the town"
    return name not in _NOT_NAMES and (is_verb(match["verb"]) or match["verb"].endswith("ly"))


OWN: Final = "(?:the|a|an|his|her|their|my|our|its)"
_SELF: Final = r"(?:(?:him|her|them|my|it)sel(?:f|ves) )?"
_WAY: Final = r"(?:\w+ly )?"
_ONTO: Final = rf"{_SELF}{_WAY}(?:back |down |out |up |over )*(?:on|onto|in|into|to|across|against|down|back|at|by)\b"


def _either(lines: str) -> str:
    """One expression for all the lines."""
    return f"(?:{'|'.join(line.strip() for line in lines.splitlines() if line.strip())})"


_RISING: Final = (
    r"(?:gets?|got|getting|stands?|stood|standing|jump\w*|leap\w*|leapt|springs?|sprang|struggl\w*|heav\w*)"
)
_SEAT: Final = "(?:bed|chair|armchair|sofa|couch|seat)"
WAKES: Final = r"(?:wake|woke|waking|awake|awoke|awaken)\w*\b(?! by)"
RISES: Final = _either(rf"""
    {_RISING} {_SELF}{_WAY}(?:back )?(?:up\b(?! to)|to {OWN} feet|out of (?:{OWN} )?{_SEAT}|from )
    (?:scrambl\w*) (?:up\b|to {OWN} feet|out of )
    rises?\b|rose\b|rising\b
    (?:leaves?|left|leaving) (?:{OWN} )?(?:bed|seat|chair|sofa|couch|armchair)\b
""")
_FLAT: Final = (
    "down|back|awake|in|on|across|there|flat|still|face|curled|motionless|asleep|beside|under|sick|ill|with|for|until"
)
_TO_BED: Final = rf"(?:back |straight |off )?(?:to|into|in) (?:{OWN} )?(?:\w+ )?bed\b"
LIES: Final = _either(rf"""
    (?:lies|lie|lay|lying|lays|laid|laying)(?: {_SELF}{_WAY}(?:{_FLAT})\b|$)
    (?:sleep|slept|nap|doz|snooz|snor)\w*
    (?:falls?|fell|falling|drift\w*|nod\w*|doz\w*) (?:\w+ )?(?:asleep|off)\b
    toss\w*(?: about| in bed)?$|toss\w* about\b
    (?:goes|went|going|go|gets?|got|retir\w*|crawl\w*|climb\w*|slip\w*) {_TO_BED}
    (?:goes|went|going|go) (?:back )?to sleep
    pass\w* out|(?:asleep|awake)\b|(?:takes?|took|taking|has|had) a nap
    turns? in for|hits? the (?:sack|hay)|hid\w* under
    (?:can(?:no|')t|cannot|can not|could(?:n't| not)|tr(?:y|ies|ied|ying) to) (?:fall asleep|get to sleep|sleep)
""")
LETS_DOWN: Final = _either(rf"""
    (?:slump|sink|sank|sunk|flop|drop|settle|settling|plop|plump|perch|slouch|slid|slide|nestle|huddle)\w* {_ONTO}
    lower\w* {_SELF}{_ONTO}
""")
FALLS: Final = _either(rf"""
    (?:collaps|sprawl|fall|fell|throw|threw|stretch|curl|snuggle|rest|loung|reclin|tumbl|cuddle|slip|roll)\w* {_ONTO}
    (?:div(?:e|es|ed|ing)|dove|crawl\w*|climb\w*|crash\w*) {_ONTO}
""")
SITS: Final = _either(rf"""
    (?:sit|sits|sat|sitting|seat(?:s|ed)?)\b
    (?:takes?|took|taking) (?:{OWN} )?seat\b
    lean\w* back
""")
DOES_SITTING: Final = _either(rf"""
    (?:read|reads|reading|writ\w+|wrote|stud(?:y|ies|ied|ying)|typ(?:e|es|ed|ing)|knit\w*|sew\w*|meditat\w*)\b
    (?:dine|dines|dined|dining)\b|(?:eat|ate)\w*\b|(?:drink|drank|sip)\w*\b
    (?:has|had|having|finish\w*|enjoy\w*) (?:{OWN} )?(?:\w+ )?(?:breakfast|lunch|dinner|supper|meal|snack)
    work\w*\b(?! out)
    watch\w* (?:.{{0,20}} )?(?:tv|television|film|movie|series|show|news|game|match|screen)\b
    play\w* (?:.{{0,20}} )?(?:piano|cards|chess|games?|guitar|console|violin)\b
    listen\w* to\b|relax\w*\b|scroll\w*\b|paints?\b|draws?\b|drew\b
    (?:weep|wept|cry|cries|cried|crying|sob)\w*\b
    (?:think|thought|ponder|brood|mull|reflect|daydream)\w*\b|wait\w*\b
    (?:bur(?:y|ies|ied|ying)|holds?|held|holding|puts?|putting|hides?|hid) {OWN} (?:face|head) in\b
""")
ON_THE_PHONE: Final = _either(r"""
    (?:talk|speak|spoke|chat|argu|shout|whisper|is|was)\w*\b.{0,40}\bon the (?:tele)?phone\b
    (?:makes?|made) a (?:phone )?call
""")
_NOT_TAKEN: Final = "seat|nap|breath|step|walk|look|bath|shower|break|place|care"
_HANDLED: Final = """grab|snatch|seiz|fetch|retriev|rummag|search|dust|polish|wip|scrub|wash|rins|clean|tid|pour|cook|
bak|boil|stir|chop|fry|unpack|pack|fold|water|dial|unplug|touch|strok|
pat|caress|knock|bang|pound|slam|brush|press|iron|vacuum|sweep|swept|sort|arrang|unlock|toast|clear|straighten|feed|fed|reheat|uncork|refill""".replace(
    "\n", ""
)
_PUT: Final = r"puts?|putting|plac(?:e|es|ed|ing)|sets?|setting|lays|laid|laying|drops?|dropped|leav(?:es|ing)|left"
_GIVES_WAY: Final = (
    r"(?:eyes?|mouth|lips|breath|nose|head|face|hair|door|window|gate|gaze|voice|tears?|doors|windows|curtains?)\b"
)
_FETCHED: Final = (
    "beer|water|milk|wine|drink|book|coat|plate|glass|cup|bottle|blanket|pillow|knife|towel|phone|keys?|snack|sandwich"
)
_MADE: Final = "tea|coffee|breakfast|lunch|dinner|supper|sandwich|meal|drink|bed|cocoa|soup|cake|toast"
TOUCHES: Final = _either(rf"""
    (?:tak(?:e|es|ing)|took)\b(?! (?:an? )?(?:\w+ )?(?:{_NOT_TAKEN})\b)
    (?:{_HANDLED})\w*\b
    pick\w* (?:.{{0,30}} )?(?:up|out)\b|pick\w* {OWN}\b
    (?:hang|hung)\w* (?:up|{OWN})\b|(?:hides?|hid|hiding) {OWN} (?!face|head)
    (?:{_PUT}) (?:{OWN} )?.{{0,40}}\b(?:on|onto|in|into|down|away|back|under|inside|beside|upon|table)\b
    put\w* on\b
    (?:open|clos|shut|push|pull)\w*\b(?! {OWN} {_GIVES_WAY})
    (?:turn|switch|click|flick)\w* (?:\w+ )*(?:on|off)\b
    (?:look|hunt|feel|felt|grop)\w* (?:\w+ )?(?:for|into|under|behind|inside)\b
    reach\w* (?:\w+ )?(?:for|into|in|up|out|under|behind|inside|toward|towards|to|across)\b
    (?:light|lights|lit) {OWN}\b
    (?:call|phone|telephon|ring)\w*\b|answer\w*\b
    (?:mak(?:e|es|ing)|made|prepar\w*|fix\w*|brew\w*) {_SELF}(?:{OWN} |some )?(?:\w+ )?(?:{_MADE})\b
    (?:gets?|got|getting) (?:{OWN}|some) .{{0,40}}(?:\bfrom\b|\bout of\b)
    (?:gets?|got|getting) (?:{OWN}|some) (?:\w+ )?(?:{_FETCHED})\b
    (?:choos|chose|dress|undress|chang)\w*\b
    (?:kick|punch|hit|smash|throw|threw|toss|hurl)\w* (?:{OWN}|it)\b
    (?:drain|empt)\w* {OWN}\b|check\w* {OWN}\b
    lean\w* (?:on|against|over)\b|plugs?\b
""")
_WALKED: Final = """walk|pac(?:e|es|ed|ing)\\b|wander|stroll|run|ran\\b|rush|hurr|dash|sprint|storm|stomp|march|strid|
strode|shuffl|trudg|plod|limp|hobbl|stagger|stumbl|lurch|reel|tiptoe|creep|crept|sneak|hop\\b|hops\\b|
hopp|danc|twirl|spin|spun|whirl|swirl|circl|enter|approach|roam|prowl|drift|bustl|sway|wobbl|ambl|saunter|bounc|
skip|stalk|scurr|scuttl|rac(?:e|es|ed|ing)\\b|follow|wad(?:e|es|ed|ing)\\b|waltz|barg(?:e|es|ed|ing)\\b|burst|sidestep|jog|steal|
stole|weav|wov|flit|glid|jump|leap""".replace("\n", "")
_ROOMS: Final = "room|kitchen|bedroom|study|house|table|home|living room|dining room|office"
GOES: Final = _either(rf"""
    (?:{_WALKED})\w*
    (?:go|goes|went|going|come|comes|came|coming|move|moves|moved|moving|head|heads|headed|heading|exit\w*|return\w*)\b
    (?:step|steps|stepped|stepping|retreat\w*|arriv\w*)\b|back(?:s|ed|ing)? away|turns? back
    (?:makes?|made) (?:for|\w+ way)\b
    cross\w* (?:the|into|to|over|his|her|their) (?!arm|leg)
    (?:leav(?:es|ing|e)|left) (?:{OWN} )?(?:{_ROOMS})\b
    (?:carr|bring|brought|drag)\w* .{{1,60}}\b(?:to|into|across|over|through)\b
""")
STANDS: Final = r"(?:stands?|stood|standing|freez\w*|froze)\b"
_BEFORE: Final = (
    r"\w+ly|then|just|still|also|finally|again|now|soon|even|too|once|always|often|there|here|all|is|are|was|were|has"
    r"|had|have|been|being|at last|at once|almost"
)
_BEGINS: Final = r"starts?|started|begins?|began|continu(?:es|ed)"
LEAD: Final = (
    rf"(?:(?:{_BEFORE})\s+)*"
    rf"(?:(?:{_BEGINS}|decid(?:es|ed)|manag(?:es|ed)|proceeds?|proceeded|gets?|got) to\s+"
    rf"|(?:{_BEGINS}|keeps?|kept|goes|went|comes|came|spends? .{{1,30}}|spent .{{1,30}}|ends? up|ended up)\s+"
    r"(?=\w+ing\b)"
    r"|(?:goes|went|comes|came|sits?|sat) (?:down )?to\s+(?=(?:read|write|eat|study)\b))?"
    r"(?:\w+ly\s+)?"
)
"""What may stand before the verb that says what is done."""


@dataclass(frozen=True)
class Kind:
    """A way a clause is acted out."""

    skill: Skill
    words: str
    """How the clause begins."""
    falls: bool = False
    """Whether one lies where one can, and else sits ("collapses onto …")."""
    wakes: bool = False
    """Whether one must have been asleep before."""
    done: bool = False
    """Whether it is done while sitting or lying, and no going to a seat by itself ("reads")."""


KINDS: Final = (
    Kind(Skill.GETUP, WAKES, wakes=True),
    Kind(Skill.STANDUP, RISES),
    Kind(Skill.LOCO, ON_THE_PHONE),
    Kind(Skill.LIEDOWN, LIES),
    Kind(Skill.SITDOWN, LETS_DOWN),
    Kind(Skill.LIEDOWN, FALLS, falls=True),
    Kind(Skill.SITDOWN, SITS),
    Kind(Skill.SITDOWN, DOES_SITTING, done=True),
    Kind(Skill.TOUCH, TOUCHES),
    Kind(Skill.LOCO, GOES),
    Kind(Skill.LOCO, STANDS),
)
"""The first that fits."""

_NO_FURNITURE: Final = re.compile(
    rf"^\W*(?:\w+\s+){{0,4}}?{OWN}?\s*(?:\w+\s+)?(?:doors?|windows?|gate)\b", re.IGNORECASE
)
_NOT_PIECES: Final = frozenset(
    ("bar", "chest", "trunk", "picture", "book", "pillow", "clock", "statue", "console", "seat", "bin")
)
"""Furniture words that mean something else more often."""
_STANDS_ON: Final = {"tv": "tv stand", "monitor": "desk", "table lamp": "nightstand"}
"""Where one goes for what stands on other furniture."""
_SEATS_AT: Final = {
    "desk": "chair", "dining_table": "dining chair", "table": "chair", "kitchen_counter": "barstool",
    "dressing_table": "dressing chair", "console_table": "chair",
}  # fmt: skip
"""Where one sits at what nobody sits on."""
_CLOTHES: Final = (
    "cloth\\w*|suit|shirt|dress\\w*|coat|jacket|jeans|sweater|socks|changes?|changed|outfit|p[yj]+amas|tie"
)
_PAPERS: Final = "laptop|computer|keyboard|printer|papers|documents|files?|pens?|notebook|email\\w*"
_MEALS: Final = """water|milk|beer|wine|whisk\\w+|bottle|glass|glasses|cups?|mug|plates?|dishes|bowl|pan|pot|food|
breakfast|lunch|dinner|supper|snack|coffee|tea|kettle|cereal|soup|cake|bread|sandwich|medicine|pills?"""
_THINGS: Final = (
    (_CLOTHES, "wardrobe"),
    ("books?|novel|album|diary|dictionary|photos?|photographs?|letters?", "bookshelf"),
    ("tv|television|remote|channel|radio|music|stereo|record", "tv stand"),
    (_PAPERS, "desk"),
    ("light|lights|lamp", "floor lamp"),
    (_MEALS.replace("\n", ""), "cabinet"),
)
"""Where things are kept."""


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
    if skill is Skill.TOUCH and _NO_FURNITURE.match(rest) and not pieces_in(rest):
        return None
    named = pieces_in(rest)
    if kind.falls and not any(affords(piece, "lie") for piece in named):
        skill = Skill.SITDOWN
    elif kind.skill is Skill.SITDOWN and not kind.done and any(furniture.group_of(piece) == "bed" for piece in named):
        skill = Skill.LIEDOWN if re.match(LETS_DOWN, _bare(clause), re.IGNORECASE) else skill
    if kind.falls and not named:
        return None  # "rests in peace", "falls into a rage"
    fitting = ""
    if skill is Skill.SITDOWN and not re.search(r"\bon (?:\w+ ){0,3}(?:table|desk|counter)\b", rest):
        fitting = next((_SEATS_AT[at] for piece in named if (at := furniture.canonical(piece)) in _SEATS_AT), "")
    fitting = fitting or next((piece for piece in named if affords(piece, NEEDS[skill])), "")
    if fitting:
        return Deed(kind, skill, fitting, True)
    kept = next((piece for words, piece in _THINGS if re.search(rf"\b(?:{words})\b", rest, re.IGNORECASE)), "")
    return Deed(kind, skill, kept if skill is Skill.TOUCH else "")


def pieces_in(text: str) -> list[str]:
    """Furniture words of a text in its order, longest names first: "dining table", not "table"."""
    words = re.findall(r"[a-z]+(?:'s)?", text.lower())
    found: list[str] = []
    at = 0
    while at < len(words):
        size = next((size for size in (3, 2, 1) if _names(tuple(words[at : at + size]), size)), 0)
        if size and words[at] not in _NOT_PIECES:
            piece = furniture.canonical(" ".join(words[at : at + size])).replace("_", " ")
            found.append(_STANDS_ON.get(piece, piece))
        at += size or 1
    return found


@cache
def _known() -> tuple[tuple[Kind, re.Pattern[str]], ...]:
    return tuple((kind, re.compile(rf"(?:{kind.words})", re.IGNORECASE)) for kind in KINDS)


def _bare(clause: str) -> str:
    """The clause from its main verb on."""
    return re.sub(rf"^{LEAD}", "", clause.strip(), count=1, flags=re.IGNORECASE)


def _kinds(clause: str) -> tuple[Kind, str] | None:
    """The first kind that the clause, or the clause from its main verb on, begins with; and what follows."""
    for start in dict.fromkeys((clause.strip(), _bare(clause))):
        for kind, pattern in _known():
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
