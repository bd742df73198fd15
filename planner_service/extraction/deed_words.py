"""English for what a body does: how a clause begins that tells of sitting, lying, rising, touching or going.

Each constant is a regular expression for the beginning of a clause without its subject; each line of it is one way.
"""

from __future__ import annotations

from typing import Final

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
