"""Free words to one of the nine emotions: for keyframes ("tired, sad") and for what people write about feelings."""

from __future__ import annotations

import re
from functools import cache
from typing import Final, NamedTuple

from planner_service.scripts.script import EMOTIONS

# Stems: "*" stands for any letters, "_" for a space.
_WORDS: Final[dict[str, str]] = {
    "drunk": "drunk* tipsy tipsily intoxicated inebriated hungover hangover boozed sozzled plastered zombie "
    "glass*_too_many one_too_many too_much_wine too_much_to_drink",
    "angry": "angr* anger furious fury rage* raging enraged mad irritat* annoy* outrag* livid cross hostile resent* "
    "frustrat* quarrel* argu* shout* yell* slam* curse* cursing swear* stomp* storms storming insult* "
    "scold* sulk* grumpy tears_up tears_it_up tears_them_up tears_apart tears_to_pieces tore_up fed_up temper",
    "hurried": "hurr* rush* hast* late urgent* overslept oversleep* frantic* quickly dash* scrambl* impatient*",
    "sad": "sad sadly sadden* sadness depress* grie* mourn* cry cries cried crying weep* wept sob* tear* heartbrok* "
    "ashamed guilt* bullied heartache lonel* miser* gloom* melanchol* sorrow* dejected despair* devastat* disappoint* "
    "dead death died dies funeral miss misses missing unhappy hopeless crushed painful nostalgi* homesick "
    "regret* upset hurt",
    "stressed": "stress* anxi* anxious* nervous* worr* tense tension panic* afraid fear* scared frighten* uneas* "
    "stage_fright overwhelm* pressure troubled serious uncomfortable disturb* restless concerned dread* paranoid "
    "startl* suspicious",
    "tired": "tired* exhaust* sleepy asleep weary weari* fatigue* drowsy yawn* worn sick ill ache* aching drained "
    "jetlag* jet-lag* sluggish weak",
    "happy": "happ* joy* excit* delight* cheer* glad* thrill* elat* celebrat* laugh* giggl* ecsta* euphor* merry "
    "playful* childish childlike grin* smil* triumph* proud* overjoyed enthusias* wins won win lottery jackpot lucky "
    "love loves dance* dancing confident party birthday picnic amused pleased jubilant hopeful eager*",
    "relaxed": "relax* calm* peace* cozy cosy comfort* leisure* content* serene mellow unwind* chill* lazy lazily "
    "cool*_off cool*_down reliev* relief quietly meditat* tranquil* carefree ease soothed weekend vacation holiday",
    "neutral": "neutral ordinary normal thinking thoughtful pensive ponder* curious steady cold composed focused",
}
HINTS: Final[dict[str, str]] = {
    "tired": "sleep* nap naps napping to_bed in_bed bedtime doze dozes dozing collapse* collapsing headache fever flu "
    "a_cold sore bored limp limps limping cough* sneez*",
    "relaxed": "enjoy* rest rests resting rested stroll* sunbath* tea cocoa afternoon bath forgiv* reconcil* make_up "
    "makes_up made_up",
    "happy": "sing sings singing sang skip skips skipping promot* pass* gift present surprise* cake sweet "
    "look*_forward finds_it finds_them found_it found_them proposes_to cannot_wait "
    "good_news prais* whistl* engaged dream_job gets_the_job got_the_job",
    "sad": "fail* reject* bad_news turned_down fired widow* alone funeral divorce* breakup nobody no_one "
    "loses_at lost_at loses_the lost_the is_beaten gives_up gives_in give_up",
    "stressed": "deadline* exam* bill bills debt* interview thunder* rent overdue mistakes robbed "
    "trembl* strange_noise hears_a_noise hears_a_sound "
    "dare dares hides_from hides_under hides_behind cannot_find can't_find",
    "angry": "unfair rude broken cheat* betray* fight* fights fought spill* noisy stolen "
    "kicks_the kicked_the kicks_a kicks_at kicks_over steals stole refuse* grounded fist fists chewed ruin*",
    "drunk": "whisky whiskey beers cocktail* booze",
    "hurried": "against_the_clock in_time last_minute in_*_minutes taxi",
}
_PRECEDENCE: Final = ("drunk", "angry", "hurried", "sad", "stressed", "tired", "happy", "relaxed", "neutral")
"""When one phrase names several: what a body shows most comes first."""
_NAMES: Final = {name: name for name in EMOTIONS} | {"depressed": "sad", "excited": "happy"}
_NEGATION: Final = re.compile(
    r"(?:n't|\b(?:not|cannot|no|never|without|hardly|no longer|stops? being))\s+(?:(?!stop|help)\w+\s+){0,2}$"
    r"|\b(?:nobody|no one|no-one)\s+(?:\w+\s+){0,4}$"
)
_OVER: Final = re.compile(r"\b(?:no longer|stops? being)\s+(?:\w+\s+){0,2}$")
_OPPOSITE: Final = {"happy": "sad", "relaxed": "stressed"}
_RELIEF: Final = {"stressed": "relaxed", "angry": "relaxed", "sad": "relaxed"}
"""What one feels when these are over; who never felt them feels nothing."""


class Feeling(NamedTuple):
    """An emotion found in a text."""

    emotion: str
    sure: bool
    """Whether a word names it; False when a word only hints at it."""
    start: int
    """Where in the text."""
    end: int
    negated: bool
    """Whether the text names its opposite and denies it."""


def feelings(text: str) -> list[Feeling]:
    """Every emotion the text names or hints at, in the order of the text; "not happy" counts as sad, and "no longer
    sad" as relaxed.

    Words that are part of a longer saying do not count by themselves: "tears" in "tears up".
    """
    found = []
    for words, sure in ((_WORDS, True), (HINTS, False)):
        for emotion, stems in words.items():
            for match in _pattern(stems).finditer(text):
                negated = _NEGATION.search(before := text[: match.start()].lower()) is not None
                denied = (_RELIEF | _OPPOSITE) if _OVER.search(before) else _OPPOSITE
                if not negated or emotion in denied:
                    named = denied[emotion] if negated else emotion
                    found.append(Feeling(named, sure, match.start(), match.end(), negated))
    whole = [one for one in found if not any(_within(one, other) for other in found)]
    return sorted(whole, key=lambda feeling: feeling.start)


def _within(one: Feeling, other: Feeling) -> bool:
    return other.start <= one.start and one.end <= other.end and one.end - one.start < other.end - other.start


def emotion_of(words: str) -> str | None:
    """The one of `EMOTIONS` that a keyframe's "emotion/style" means, or None when no word of it is known.

    Plain names win over words like "uncomfortable", and among several the one that a body shows most: "stressed,
    uncomfortable, tired" is stressed.
    """
    named = {_NAMES[part] for part in re.findall(r"[a-z]+", words.lower()) if part in _NAMES}
    found = named or {feeling.emotion for feeling in feelings(words) if feeling.sure}
    return next((emotion for emotion in _PRECEDENCE if emotion in found), None)


@cache
def _pattern(stems: str) -> re.Pattern[str]:
    words = "|".join(stem.replace("*", r"\w*").replace("_", " ") for stem in stems.split())
    return re.compile(rf"\b(?:{words})\b", re.IGNORECASE)
