"""A language model that makes a small model's mistakes: a good answer spoilt in one way, the same at every call."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any

from good_model import answer_to

Json = dict[str, Any]
Spoil = Callable[[Json], Json | str]


def each_beat(change: Callable[[Json], Json]) -> Spoil:
    return lambda answer: {**answer, "beats": [change(beat) for beat in answer["beats"]]}


def each_keyframe(**fields: Any) -> Spoil:
    return each_beat(lambda beat: {**beat, "keyframes": [{**one, **fields} for one in beat["keyframes"]]})


def acted(beat: Json) -> Json:
    """The beat with a body that sits down, whatever it is."""
    one = {"skill": "sitdown", "emotion": "neutral", "caption": "sitting still", "furniture": "chair"}
    return {**beat, "serve": "write", "keyframes": [one]}


MISTAKES: dict[str, Spoil] = {
    "words that are no choice": each_beat(lambda beat: {**beat, "kind": "ACTION!", "emotion": "wistful-ish"}),
    "serves that are no choice": each_beat(lambda beat: {**beat, "serve": "maybe"}),
    "captions of another skill": each_keyframe(caption="walk with depression"),
    "captions of its own": each_keyframe(caption="gazes into the void with the soul of a poet"),
    "skills of its own": each_keyframe(skill="teleport"),
    "furniture of its own": each_keyframe(furniture="throne of bones"),
    "furniture one cannot rest on": each_keyframe(furniture="TV"),
    "invented ids": each_beat(lambda beat: {**beat, "serve": "take", "script": "the-dragon", "keyframes": []}),
    "invented ids beside keyframes": each_beat(lambda beat: {**beat, "serve": "trim", "script": "no", "last": 99}),
    "places far beyond": each_beat(
        lambda beat: {**beat, "serve": "trim", "script": "passed-the-exam", "first": 70, "last": -3}
    ),
    "no keyframes": each_beat(lambda beat: {**beat, "keyframes": []}),
    "all of it denied": each_beat(lambda beat: {**beat, "kind": "undone"}),
    "all of it acted": each_beat(acted),
    "nothing served": each_beat(lambda beat: {**beat, "serve": "none", "keyframes": [], "script": ""}),
    "too many keyframes": each_beat(lambda beat: {**beat, "keyframes": beat["keyframes"] * 30}),
    "beats of another theme": each_beat(lambda beat: {**beat, "text": "conquers Bohemia"}),
    "one beat a hundred times": lambda answer: {**answer, "beats": answer["beats"][:1] * 100},
    "fields left out": each_beat(lambda beat: {"text": beat["text"]}),
    "beats that are texts": each_beat(lambda beat: beat["text"]),
    "types mixed up": each_beat(lambda beat: {**beat, "first": "3", "last": None, "keyframes": "none", "who": 7}),
    "keyframes that are texts": each_beat(lambda beat: {**beat, "keyframes": ["walks", 3, None]}),
    "a person of its own": lambda answer: {**answer, "person": {"name": "X" * 200, "pronouns": "it", "age": -4}},
    "no person": lambda answer: {"beats": answer["beats"]},
    "wrapped": lambda answer: {"answer": answer},
    "nothing": lambda _: {},
    "half of it": lambda answer: json.dumps(answer)[: len(json.dumps(answer)) // 2],
    "prose around it": lambda answer: f"Sure {{smile}}!\n```json\n{json.dumps(answer)}\n```\nHope this helps!",
    "prose instead": lambda _: "Maya comes home, and I think she should sit down first.",
    "a list": lambda answer: json.dumps(answer["beats"]),
}


def spoilt(mistake: str) -> Callable[[str], Json | str]:
    """Answers every prompt as the good model does, and spoils the plan of a theme in that way."""

    def answer(prompt: str) -> Json | str:
        good = answer_to(prompt)
        return MISTAKES[mistake](copy.deepcopy(good)) if "say, beat by beat" in prompt else good

    return answer
