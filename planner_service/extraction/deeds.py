"""What a clause has a body do: the skill its verb means, the furniture it names, and what is no deed at all."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import Final

from motion_backend.motion import Skill
from planner_service.scripts.mending import NEEDS, affords
from scene_graphs import furniture

_OWN: Final = r"(?:the|a|an|his|her|their|my|our|its)"
_SELF: Final = r"(?:(?:him|her|them|my|it)sel(?:f|ves) )?"
_WAY: Final = r"(?:\w+ly )?"
_ONTO: Final = rf"{_WAY}(?:back |down |out |up |over )*(?:on|onto|in|into|to|across|against|down|back|at|by)\b"
_TO_BED: Final = rf"(?:back |straight |off )?(?:to|into|in) (?:{_OWN} )?(?:\w+ )?bed\b"
_LETS: Final = r"slump|sink|sank|sunk|flop|drop|settle|settling|plop|plump|perch|lower|slouch|slid|slide|nestle|huddle"
_FALLS: Final = (
    r"collaps|sprawl|fall|fell|throw|threw|stretch|curl|snuggle|rest|loung|reclin|tumbl|div(?:e|ing)|dove|crawl|climb"
    r"|crash|cuddle|slip|roll"
)
RISES: Final = (
    rf"(?:gets?|got|getting|stands?|stood|standing|jump\w*|leap\w*|leapt|springs?|sprang|struggl\w*|scrambl\w*|heav\w*) "
    rf"{_SELF}{_WAY}(?:back )?(?:up\b(?! to)|to {_OWN} feet|out of (?:{_OWN} )?(?:bed|chair|armchair|sofa|couch)|from )"
    r"|rises?\b|rose\b|rising\b|leaves? (?:the |his |her |their )?bed|left (?:the |his |her |their )?bed"
)
WAKES: Final = r"(?:wake|woke|waking|awake|awoke|awaken)\w*\b"
_LIES: Final = (
    rf"(?:lies|lie|lay|lying|lays|laid)(?: {_SELF}{_WAY}(?:down|back|awake|in|on|across|there|flat|still|face|curled"
    r"|motionless|asleep|beside|under|sick|ill)\b|$)"
    r"|(?:sleep|slept|nap|doz|snooz|snor)\w*|(?:falls?|fell|falling|drift\w*|nod\w*|doz\w*) (?:\w+ )?(?:asleep|off)\b"
    rf"|toss\w*$|toss\w* (?:and turn|in bed)|(?:goes|went|going|go|gets?|got|retir\w*|crawl\w*|climb\w*|slip\w*) {_TO_BED}"
    r"|(?:goes|went|going|go) (?:back )?to sleep|pass\w* out|(?:asleep|awake)\b|(?:takes?|took|taking|has|had) a nap"
    r"|turns? in for|(?:hits?) the (?:sack|hay)|hid\w* under"
    r"|(?:can(?:no|')t|cannot|can not|could(?:n't| not)|tr(?:y|ies|ied|ying) to) (?:fall asleep|get to sleep|sleep)"
)
_SITS: Final = (
    r"(?:sit|sits|sat|sitting|seat(?:s|ed)?)\b|(?:takes?|took|taking) (?:a |his |her |their |my )?seat\b|lean\w* back"
    r"|(?:read|reads|reading|writ\w+|wrote|stud(?:y|ies|ied|ying)|typ(?:e|es|ed|ing)|knit\w*|sew\w*|meditat\w*)\b"
    r"|(?:dine|dines|dined|dining)\b|(?:eat|ate)\w*\b|(?:has|had|having|finish\w*|enjoy\w*) "
    rf"(?:{_OWN} )?(?:\w+ )?(?:breakfast|lunch|dinner|supper|meal|snack)"
    r"|work\w*\b|watch\w* (?:.{0,20} )?(?:tv|television|film|movie|series|show|news|game|match|screen)\b"
    r"|play\w* (?:.{0,20} )?(?:piano|cards|chess|games?|guitar|console|violin)\b|listen\w* to\b"
    r"|(?:weep|wept|cry|cries|cried|crying|sob)\w*\b|(?:think|thought|ponder|brood|mull|reflect|daydream)\w*\b"
    rf"|wait\w*\b|(?:bur(?:y|ies|ied|ying)|holds?|held|holding|puts?|putting|hides?|hid) {_OWN} (?:face|head) in\b"
    r"|(?:drink|drank|sip)\w*\b|relax\w*\b|talk\w* on the phone|paints?\b|draws?\b|drew\b|scroll\w*\b"
)
_EYES: Final = r"(?:eyes?|mouth|lips|breath|nose|head|face|hair|door|window|gate|gaze|voice|tears?)\b"
_TOUCHES: Final = (
    r"(?:tak(?:e|es|ing)|took)\b(?! (?:an? )?(?:\w+ )?(?:seat|nap|breath|step|walk|look|bath|shower|break|place|care)\b)"
    r"|(?:grab|snatch|seiz|fetch|retriev|rummag|search|dust|polish|wip|scrub|wash|rins|clean|tid|pour|cook|bak|boil|stir"
    r"|chop|fry|unpack|pack|fold|water|dial|unplug|touch|strok|pat|caress|knock|bang|pound|slam|hang|hung|brush|press"
    r"|iron|vacuum|sweep|swept|sort|arrang|unlock|toast|clear|straighten|feed|fed|reheat|uncork|refill)\w*\b"
    r"|pick\w* (?:.{0,30} )?(?:up|out)\b|pick\w* (?:a|the|an|his|her|their)\b|(?:hides?|hid|hiding) (?:the|a|his|her|their)"
    rf"|(?:puts?|putting|plac(?:e|es|ed|ing)|sets?|setting|lays|laid|laying|drops?|dropped|leav(?:es|ing)|left) "
    rf"(?:{_OWN} )?.{{0,40}}\b(?:on|onto|in|into|down|away|back|under|inside|beside|upon|table)\b"
    rf"|put\w* on\b|(?:open|clos|shut|push|pull)\w*\b(?! {_OWN} {_EYES})|(?:turn|switch|click|flick)\w* (?:\w+ )*(?:on|off)\b"
    r"|(?:look|hunt|feel|felt|grop|reach)\w* (?:\w+ )?(?:for|into|in|up|out|under|behind|inside|toward|towards|to|at the sh)\b"
    r"|(?:light|lights|lit) (?:the|a|an|his|her)\b|(?:call|phone|telephon|ring)\w*\b|answer\w*\b"
    rf"|(?:mak(?:e|es|ing)|made|prepar\w*|fix\w*|brew\w*) {_SELF}(?:{_OWN} |some )?(?:\w+ )?"
    r"(?:tea|coffee|breakfast|lunch|dinner|supper|sandwich|meal|drink|bed|cocoa|soup|cake|toast)\b"
    r"|(?:gets?|got|getting) (?:an?|the|some|his|her|their) (?!up)\w+|(?:choos|chose|dress|undress|chang)\w*\b"
    r"|(?:kick|punch|hit|smash|throw|threw|toss|hurl)\w* (?:the|a|an|his|her|their|it)\b|(?:drain|empt)\w* (?:the|a|his|her)\b"
    r"|check\w* (?:the|his|her|their)\b|lean\w* (?:on|against|over)\b|plugs?\b"
)
_GOES: Final = (
    r"(?:walk|pac(?:e|es|ed|ing)\b|wander|stroll|run|ran\b|rush|hurr|dash|sprint|storm|stomp|march|strid|strode|shuffl"
    r"|trudg|plod|limp|hobbl|stagger|stumbl|lurch|reel|tiptoe|creep|crept|sneak|hop\b|hops\b|hopp|danc|twirl|spin|spun"
    r"|whirl|swirl|circl|enter|approach|roam|prowl|drift|bustl|sway|wobbl|ambl|saunter|bounc|skip|stalk|scurr|scuttl|race"
    r"|rac(?:es|ing)|follow|wad|waltz|barg|burst|sidestep|jog|pad(?:s|ded|ding)?\b|steal|stole|weav|wov|flit|glid|jump|leap)\w*"
    r"|(?:go|goes|went|going|come|comes|came|coming|move|moves|moved|moving|head|heads|headed|heading|return\w*|step|steps"
    r"|stepped|stepping|back(?:s|ed|ing)? away|turns? back|makes? (?:for|\w+ way)|made (?:for|\w+ way)|exit\w*|retreat\w*"
    r"|arriv\w*)\b"
    r"|cross\w* (?:the|into|to|over|his|her|their) (?!arm|leg)"
    rf"|(?:leav(?:es|ing|e)|left) (?:{_OWN} )?(?:room|kitchen|bedroom|study|house|table|home|living room|dining room|office)"
    r"|(?:carr|bring|brought|drag)\w* .{1,60}\b(?:to|into|across|over|through)\b"
)
_STANDS: Final = r"(?:stands?|stood|standing|freez\w*|froze)\b"
_ON_THE_PHONE: Final = (
    r"(?:talk|speak|spoke|chat|argu|shout|whisper|is|was)\w*\b.{0,40}\bon the (?:tele)?phone\b|(?:makes?|made) a (?:phone )?call"
)
_LEAD: Final = (
    r"(?:(?:\w+ly|then|just|still|also|finally|again|now|soon|even|too|once|always|often|there|here|all|is|are|was|were|has"
    r"|had|have|been|being|both|at last|at once|almost)\s+)*"
    r"(?:(?:starts?|started|begins?|began|decid(?:es|ed)|manag(?:es|ed)|continu(?:es|ed)|proceeds?|proceeded|gets?|got) to\s+"
    r"|(?:starts?|started|begins?|began|keeps?|kept|continu(?:es|ed)|goes|went|comes|came|spends? .{1,30}|spent .{1,30}"
    r"|ends? up|ended up)\s+(?=\w+ing\b)|(?:goes|went|comes|came|sits?|sat) (?:down )?to\s+(?=(?:read|write|eat|study)\b))?"
    r"(?:\w+ly\s+)?"
)


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
    Kind(Skill.GETUP, WAKES + r"(?! by)", wakes=True),
    Kind(Skill.STANDUP, RISES),
    Kind(Skill.LOCO, _ON_THE_PHONE),
    Kind(Skill.LIEDOWN, _LIES),
    Kind(Skill.SITDOWN, rf"(?:{_LETS})\w* {_SELF}{_ONTO}"),
    Kind(Skill.LIEDOWN, rf"(?:{_FALLS})\w* {_SELF}{_ONTO}", falls=True),
    Kind(Skill.SITDOWN, r"(?:sit|sits|sat|sitting|seat(?:s|ed)?)\b|t[ao]\w+ (?:a |his |her |their |my )?seat\b|lean\w* back"),
    Kind(Skill.TOUCH, r"(?:work\w*|listen\w*) out\b"),
    Kind(Skill.SITDOWN, _SITS, done=True),
    Kind(Skill.TOUCH, _TOUCHES),
    Kind(Skill.LOCO, _GOES),
    Kind(Skill.LOCO, _STANDS),
)
"""The first that fits."""

NO_FURNITURE: Final = re.compile(rf"^\W*(?:\w+\s+){{0,4}}?{_OWN}?\s*(?:\w+\s+)?(?:doors?|windows?|gate)\b", re.IGNORECASE)
_NOT_PIECES: Final = frozenset(("bar", "chest", "trunk", "picture", "book", "pillow", "clock", "statue", "console", "seat", "bin"))
"""Furniture words that mean something else more often."""
_STANDS_ON: Final = {"tv": "tv stand", "monitor": "desk", "table lamp": "nightstand"}
"""Where one goes for what stands on other furniture."""
_SEATS_AT: Final = {
    "desk": "chair", "dining_table": "dining chair", "table": "chair", "kitchen_counter": "barstool",
    "dressing_table": "dressing chair", "console_table": "chair",
}  # fmt: skip
"""Where one sits at what nobody sits on."""
_THINGS: Final = (
    (r"cloth\w*|suit|shirt|dress\w*|coat|jacket|jeans|sweater|socks|changes?|changed|outfit|pyjamas|pajamas|tie", "wardrobe"),
    (r"books?|novel|album|diary|dictionary|photos?|photographs?|letters?", "bookshelf"),
    (r"tv|television|remote|channel|radio|music|stereo|record", "tv stand"),
    (r"laptop|computer|keyboard|printer|papers|documents|files?|pens?|notebook|email\w*", "desk"),
    (r"light|lights|lamp", "floor lamp"),
    (r"water|milk|beer|wine|whisk\w+|bottle|glass|glasses|cups?|mug|plates?|dishes|bowl|pan|pot|food|breakfast|lunch|dinner|"
     r"supper|snack|coffee|tea|kettle|cereal|soup|cake|bread|sandwich|medicine|pills?", "cabinet"),
)  # fmt: skip
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
    if skill is Skill.TOUCH and NO_FURNITURE.match(rest) and not pieces_in(rest):
        return None
    named = pieces_in(rest)
    if kind.falls and not any(affords(piece, "lie") for piece in named):
        skill = Skill.SITDOWN
    elif kind.skill is Skill.SITDOWN and not kind.done and any(furniture.group_of(piece) == "bed" for piece in named):
        skill = Skill.LIEDOWN if re.match(rf"(?:{_LETS})", _bare(clause)) else skill
    if kind.falls and not named:
        return None  # "rests in peace", "falls into a rage"
    fitting = next((piece for piece in named if affords(piece, NEEDS[skill])), "")
    if not fitting and skill is Skill.SITDOWN:
        fitting = next((_SEATS_AT[at] for piece in named if (at := furniture.canonical(piece)) in _SEATS_AT), "")
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
    return re.sub(rf"^{_LEAD}", "", clause.strip(), count=1, flags=re.IGNORECASE)


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
