"""Which words are verbs: enough of English to tell where one event of a theme ends and the next begins."""

from __future__ import annotations

import re
from functools import cache
from typing import Final

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
