"""English verbs for telling: past and -ing forms, and a present-tense sentence told in the past."""

from __future__ import annotations

import re
from typing import Final

_REGULAR: Final = """
accept ache act add admire adore agree aim allow amble amuse announce annoy answer apologise apologize appear applaud
apply approach argue arrange arrive ask attack attempt attend avoid await bake bang bark bask bathe battle beam beckon
beg behave believe belong blame blast blink blush boil borrow bother bounce bound bow breathe brush bump burn bustle
buzz call calm care carry celebrate change chase chat check cheer cherish chew chill choke chop chuckle circle clap
clean clear climb close collapse collect comb comfort compare complain complete compose conclude confess confide
confirm confuse connect consider console consume contemplate continue convince cook cool correct cough count cover
crack cram crash crave crawl create cross crouch crumble crumple crush cry cuddle curl curse dance dart dash daydream
decide decline decorate defeat delay deliver demand depart describe deserve desire despair destroy detect devour dial
die dim dine dip disagree disappear discard discover discuss dislike dismiss distract divorce donate doodle dose doze
drag drain dread dress drift drill drool drop drown drum dry dust earn edge edit email embark embrace employ empty
enable encounter end enjoy enter envy erupt escape evaporate examine exclaim exercise exhale exhaust exit expect
explain explode explore express face fade fail faint fear feast fetch fidget fill finish fix flatter flick flip float
flood flop flow fluff focus fold follow forward free fret frolic frown fry fulfil fumble fume fuss gallop gape gasp
gather gaze gesture giggle glance glare glide gobble gossip grab greet grieve grimace grin grip groan groom grope
grumble guard guess guide gulp guzzle hammer happen hasten hate head heat help hesitate hobble hoist hop hope host
hover huddle hug hum hunt hurl hurry ignore imagine improve improvise inch indulge inform inhale insist inspect insult
intend interrupt investigate invite iron itch jog join jot juggle jump kick kiss knit knock lament land last laugh
laze lean learn lift like limp linger listen live load loathe lock long look loom loosen lounge love lower lug lunge
lurch manage march mark marry marvel massage match matter meander measure meditate melt mend mess miss mix moan mop
mope mourn move mull mumble munch murmur muse mutter nap need nestle nibble nod note notice nudge nurse observe obsess
occur offer open order organise organize overflow overturn overwhelm own pace pack paint panic pant park party pass
pat patrol pause peek peel peep peer perch perform persist pet phone photograph pick pile pinch pine place plan play
plead plod plop pluck plug plummet plunge point poke polish ponder pop pose post pounce pour practice practise praise
pray prefer prepare press pretend prevent print process procrastinate promise promote prop propose protest prowl pull
punch purr push puzzle quarrel quiver rage rain raise rant rattle reach realise realize reassure recall receive recite
recline recognise recognize record recover reel reflect refuse regain regard regret rehearse reheat reject rejoice
relax release relieve relish relive rely remain remember remind reminisce remove renew repair repeat replace reply
report request rescue resolve rest restore resume retire retreat retrieve return reunite reveal revel review rinse rip
roam roar roast roll rouse row rub ruin rummage rush sag sail salute saunter savor savour scan scare scatter scold
scoop score scowl scramble scratch scream scroll scrub scurry scuttle seal search seat seem seethe select sense serve
settle shape share shatter shelter shift shiver shout shove shower shriek shrug shuffle sidestep sigh sip sizzle
sketch skim skip slam slap slip slouch slow slump slurp smash smell smile smoke smooth snack snap snatch sneak sneeze
sniff snooze snore snuggle soak sob soften solve soothe sort spill splash splurge spoon spot sprawl spray sprint
squash squat squeal squeeze squint squirm stack stagger stalk stamp stare start startle stash stay steady step stiffen
stir stomp stoop stop storm straighten strain stretch strip stroll struggle strum strut study stuff stumble style
subside succeed succumb suffer sulk surf surprise surrender survey survive suspect swallow sway sweat swipe swirl
switch swoon sympathise tackle talk tap taste tease telephone tempt tend tense test text thank thrash throb thump
tickle tidy tie tighten tilt tiptoe tire toast toddle toil tolerate topple toss touch trace trail train travel
treasure treat tremble trickle trip trot trudge trust try tuck tug tumble turn twiddle twirl twist twitch type
unbutton uncork uncover undress unfold unload unlock unpack unplug unroll unwrap update urge use vacuum vanish vent
view visit vomit vow wail wait walk wallow waltz wander wane want warm wash waste watch water wave weigh welcome wheel
whirl whisper whistle wince wipe wish wither witness wobble wonder work worry worsen wrap wrestle yank yawn yearn yell
zigzag zip
"""
_PAIRS: Final = """
am:was arise:arose awake:awoke be:was bear:bore beat:beat become:became begin:began bend:bent bet:bet bid:bid bite:bit
blow:blew break:broke bring:brought build:built burst:burst buy:bought cast:cast catch:caught choose:chose cling:clung
come:came creep:crept cut:cut deal:dealt dig:dug do:did draw:drew dream:dreamt drink:drank drive:drove eat:ate
fall:fell feed:fed feel:felt fight:fought find:found flee:fled fling:flung fly:flew forget:forgot forgive:forgave
freeze:froze get:got give:gave go:went grow:grew hang:hung have:had hear:heard hide:hid hit:hit hold:held hurt:hurt
keep:kept kneel:knelt know:knew lay:laid lead:led leap:leapt leave:left lend:lent let:let lie:lay light:lit lose:lost
make:made mean:meant meet:met misread:misread mistake:mistook outgrow:outgrew overcome:overcame overhear:overheard
oversee:oversaw oversleep:overslept overtake:overtook pay:paid put:put quit:quit read:read rid:rid ride:rode ring:rang
rise:rose run:ran say:said see:saw seek:sought sell:sold send:sent set:set shake:shook shed:shed shine:shone
show:showed shrink:shrank shut:shut sing:sang sink:sank sit:sat sleep:slept slide:slid sling:slung speak:spoke
spend:spent spin:spun spit:spat split:split spread:spread spring:sprang stand:stood steal:stole stick:stuck
sting:stung stride:strode strike:struck swear:swore sweep:swept swell:swelled swim:swam swing:swung take:took
teach:taught tear:tore tell:told think:thought throw:threw tread:trod undergo:underwent understand:understood
undo:undid unwind:unwound upset:upset wake:woke wear:wore weave:wove weep:wept win:won wind:wound withdraw:withdrew
wring:wrung write:wrote
"""
_IRREGULAR: Final = dict(pair.split(":") for pair in _PAIRS.split())
_DOUBLED: Final = """
beg begin bid chat chop clap cram cut dig dim dip drag drop drum flip flop forget fret get grab grin grip hit hop hug
hum jog jot knit let lug mop nap nod pat pet plan plod plop plug pop prefer prop put quarrel quit regret rid rip rub
run sag scan scrub set shrug shut sidestep sip sit skim skip slam slap slip snap sob spin spit split spot squat step
stir stop strip strum strut swim tap travel trip trot tug unplug upset win wrap zigzag zip
"""
_DOUBLING: Final = frozenset(_DOUBLED.split())
_AUXILIARY: Final = {
    "is": "was", "are": "were", "has": "had", "does": "did", "do": "did", "can": "could", "cannot": "could not",
    "will": "would", "must": "had to", "may": "might", "isn't": "wasn't", "aren't": "weren't", "hasn't": "hadn't",
    "doesn't": "didn't", "don't": "didn't", "can't": "couldn't", "won't": "wouldn't", "it's": "it was",
}  # fmt: skip
_SHIFTED: Final = (
    (r"\btomorrow (morning|afternoon|evening|night)\b", r"the next \1"),
    (r"(?<!about )\btomorrow\b", "the next day"),
    (r"\btonight\b", "that night"),
    (r"\btoday\b", "that day"),
    (r"\byesterday\b", "the day before"),
)
"""Days named from the teller's present, named from the story's."""


def past(base: str) -> str:
    """The simple past of a base form: sit → sat, carry → carried."""
    if base in _IRREGULAR:
        return _IRREGULAR[base]
    if base.endswith("e"):
        return base + "d"
    if base.endswith("y") and base[-2:-1] not in "aeiou":
        return base[:-1] + "ied"
    if base in _DOUBLING:
        return base + base[-1] + "ed"
    if base.endswith("ic"):
        return base + "ked"
    return base + "ed"


def gerund(base: str) -> str:
    """The -ing form: sit → sitting, lie → lying, make → making."""
    if base.endswith("ie"):
        return base[:-2] + "ying"
    if base.endswith("e") and not base.endswith(("ee", "oe")) and base != "be":
        return base[:-1] + "ing"
    return base + (base[-1] if base in _DOUBLING else "k" if base.endswith("ic") else "") + "ing"


def third_person(base: str) -> str:
    """The present of he, she and it: carry → carries."""
    if base.endswith("y") and base[-2:-1] not in "aeiou":
        return base[:-1] + "ies"
    return base + ("es" if base.endswith(("s", "x", "z", "ch", "sh", "o")) else "s")


BASES: Final = frozenset(_REGULAR.split()) | _IRREGULAR.keys() - {"be", "am"}
_PRESENT: Final = {third_person(base): base for base in BASES} | {"has": "have", "does": "do", "goes": "go"}
_PASTS: Final = frozenset(past(base) for base in BASES) | {"was", "were", "could", "would", "might"}

_DESCRIBING: Final = """
a an the this that's his her their its my your our some many few several of two three four five six ten no these
those all other more most old new good bad clean dirty empty first last final long loud little big small heavy with
in on at from for about into to by over under through without between after before during strange large slow
quick light short brisk hurried deep cold soft
"""
"""After these, a word such as "drinks" or "steps" is a noun."""
_NOUN_BEFORE: Final = frozenset(_DESCRIBING.split())


def is_past(word: str) -> bool:
    """Whether a word is a simple past we know."""
    return word in _PASTS


def is_verb_form(word: str) -> bool:
    """Whether a word is a third-person present we know, or an auxiliary."""
    return word in _PRESENT or word in _AUXILIARY


def base_of(present: str) -> str | None:
    """The base of a third-person present form, a regular guess for an unknown word in -s; None for anything else."""
    if present in _PRESENT:
        return _PRESENT[present]
    if not present.endswith("s") or present.endswith("ss") or len(present) < 4:
        return None
    if present.endswith("ies"):
        return present[:-3] + "y"
    return present[:-2] if present.endswith(("sses", "shes", "ches", "xes", "zzes")) else present[:-1]


_GERUNDS: Final = {gerund(base): base for base in BASES}


def base_of_gerund(word: str) -> str | None:
    """The base of an -ing form we know: losing → lose, having → have; None for anything else."""
    return _GERUNDS.get(word)


_BASE_OF_PAST: Final = {past(base): base for base in BASES}


def stem(word: str) -> str:
    """What the forms of a verb have in common, and a word with its plural: cries, cried, crying → cry; keys → key."""
    known = _PRESENT.get(word) or _BASE_OF_PAST.get(word) or _GERUNDS.get(word)
    return known or (word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 3 else word)


_LASTING: Final = """
be have do love like want need know feel live seem belong mean hate own hope believe understand think lie stand sit wait
sleep look work
"""
_STATES: Final = frozenset(_LASTING.split())
"""Verbs for what lasts until then."""
_OTHER_PARTICIPLES: Final = """
arise:arisen awake:awoken bear:borne become:become begin:begun bite:bitten blow:blown break:broken choose:chosen
come:come draw:drawn drink:drunk drive:driven eat:eaten fall:fallen fly:flown forget:forgotten forgive:forgiven
freeze:frozen give:given go:gone grow:grown hide:hidden misread:misread mistake:mistaken outgrow:outgrown
overcome:overcome oversee:overseen overtake:overtaken ride:ridden ring:rung rise:risen run:run see:seen shake:shaken
show:shown shrink:shrunk sing:sung sink:sunk speak:spoken spring:sprung steal:stolen stride:stridden swear:sworn
swell:swollen swim:swum take:taken tear:torn throw:thrown tread:trodden undergo:undergone undo:undone wake:woken
wear:worn weave:woven withdraw:withdrawn write:written
"""
_PARTICIPLES: Final = dict(pair.split(":") for pair in _OTHER_PARTICIPLES.split())
"""Participles that are not the simple past."""


def before_past(told: str) -> str:
    """The past perfect of a simple past of a deed: won → had won; any other word as it is."""
    base = _BASE_OF_PAST.get(told)
    return told if base is None or base in _STATES else f"had {_PARTICIPLES.get(base, told)}"


def word_to_past(word: str, before: str, after_subject: bool = False) -> str:
    """One word of a present-tense sentence in the past; `before` is the word in front of it, lower case.

    Right after the subject any word in -s counts as a verb, and so does a base form after "they".
    """
    lower = word.lower()
    if lower in _AUXILIARY and not (lower == "do" and before == "to"):
        return _match_case(_AUXILIARY[lower], word)
    if after_subject:
        base = lower if before == "they" and lower in BASES else base_of(lower)
        return past(base) if base else word
    if lower in _PRESENT and before not in _NOUN_BEFORE and before not in _PRESENT:
        return _match_case(past(_PRESENT[lower]), word)
    return word


def days_to_past(text: str) -> str:
    """Tomorrow → the next day, tonight → that night."""
    for pattern, told in _SHIFTED:
        text = re.sub(pattern, told, text)
        text = re.sub(pattern.replace(r"\bt", r"\bT"), told[:1].upper() + told[1:], text)
    return text


def _match_case(told: str, word: str) -> str:
    return told[:1].upper() + told[1:] if word[:1].isupper() else told
