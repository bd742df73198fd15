"""Free words to one of the nine emotions: for keyframes ("tired, sad") and for what people write about feelings."""

from __future__ import annotations

import re
from functools import cache
from typing import Final, NamedTuple

from planner_service.scripts.keyframe import EMOTIONS

# Stems: "*" stands for any letters, "_" for a space.
_WORDS: Final[dict[str, str]] = {
    "drunk": "drunk* tipsy intoxicated inebriated hungover hangover boozed sozzled plastered zombie",
    "angry": "angr* anger furious fury rage* raging enraged mad irritat* annoy* outrag* livid cross hostile resent* "
    "frustrat* quarrel* argu* shout* yell* slam* curse* cursing swear* stomp* storms storming insult*",
    "hurried": "hurr* rush* hast* late urgent* overslept oversleep* frantic* quickly dash* scrambl* impatient*",
    "sad": "sad sadly sadden* sadness depress* grie* mourn* cry cries cried crying weep* wept sob* tear* heartbrok* "
    "heartache lonel* miser* gloom* melanchol* sorrow* dejected despair* devastat* disappoint* dead death died dies "
    "funeral miss misses missing unhappy hopeless crushed painful nostalgi* homesick regret* upset hurt",
    "stressed": "stress* anxi* anxious* nervous* worr* tense tension panic* afraid fear* scared frighten* uneas* "
    "overwhelm* pressure troubled serious uncomfortable disturb* restless concerned dread* paranoid startl* suspicious",
    "tired": "tired* exhaust* sleepy asleep weary weari* fatigue* drowsy yawn* worn sick ill ache* aching drained "
    "jetlag* jet-lag* sluggish weak",
    "happy": "happ* joy* excit* delight* cheer* glad* thrill* elat* celebrat* laugh* giggl* ecsta* euphor* merry "
    "playful* childish childlike grin* smil* triumph* proud* overjoyed enthusias* wins won win lottery jackpot lucky "
    "love loves dance* dancing confident party birthday picnic amused pleased jubilant hopeful eager*",
    "relaxed": "relax* calm* peace* cozy cosy comfort* leisure* content* serene mellow unwind* chill* lazy lazily "
    "cool*_off cool*_down quietly meditat* tranquil* carefree ease soothed weekend vacation holiday",
    "neutral": "neutral ordinary normal thinking thoughtful pensive ponder* curious steady cold composed focused",
}
HINTS: Final[dict[str, str]] = {
    "tired": "sleep* nap naps napping to_bed in_bed bedtime doze dozes dozing collapse* collapsing",
    "relaxed": "enjoy* rest rests resting rested stroll* sunbath* tea cocoa afternoon bath forgiv* reconcil* make_up "
    "makes_up made_up",
    "happy": "sing sings singing sang skip skips skipping promot* pass* gift present surprise* cake sweet "
    "look*_forward finds_it finds_them found_it found_them cannot_wait good_news",
    "sad": "fail* reject* bad_news turned_down fired widow* alone funeral divorce* breakup",
    "stressed": "deadline* exam* bill bills debt* interview thunder*",
    "angry": "unfair rude broken cheat* betray* fight* fights fought spill* noise noisy",
    "drunk": "whisky whiskey beers cocktail* booze",
    "hurried": "against_the_clock in_time",
}
_PRECEDENCE: Final = ("drunk", "angry", "hurried", "sad", "stressed", "tired", "happy", "relaxed", "neutral")
"""When one phrase names several: what a body shows most comes first."""
_NAMES: Final = {name: name for name in EMOTIONS} | {"depressed": "sad", "excited": "happy"}
_NEGATION: Final = re.compile(
    r"(?:n't|\b(?:not|cannot|no|never|without|hardly|no longer|stops? being))\s+(?:(?!stop|help)\w+\s+){0,2}$"
)
_OPPOSITE: Final = {"happy": "sad", "relaxed": "stressed"}


class Feeling(NamedTuple):
    """An emotion found in a text."""

    emotion: str
    sure: bool
    """Whether a word names it; False when a word only hints at it."""
    start: int
    """Where in the text."""


def feelings(text: str) -> list[Feeling]:
    """Every emotion the text names or hints at, in the order of the text; "not happy" counts as sad."""
    found = []
    for words, sure in ((_WORDS, True), (HINTS, False)):
        for emotion, stems in words.items():
            for match in _pattern(stems).finditer(text):
                negated = _NEGATION.search(text[: match.start()].lower()) is not None
                if negated and emotion not in _OPPOSITE:
                    continue
                found.append(Feeling(_OPPOSITE[emotion] if negated else emotion, sure, match.start()))
    return sorted(found, key=lambda feeling: feeling.start)


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
