"""Steps to keyframes: what a body can do of each step, and with which captions (LINGO appendix C, SIMS 3.4)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from motion_backend.motion import Posture, Skill
from motion_backend.props import held_in
from planner_service.scripts.caption_actions import MAX_CAPTION_LENGTH, caption_of
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_repair import RISES
from planner_service.tasks.household import household, kept_at
from planner_service.tasks.instruction import Order, is_fixed, is_furniture, order_of
from planner_service.tasks.surroundings import Surroundings
from planner_service.tasks.task_plan import MAX_KEYFRAMES, Step, SubTask

_MAX_PER_STEP: Final = 4
"""Keyframes that one step may take: rising, a walk, a touch or a rest."""
_RISES_FOR_IT: Final = "it rises for it: a hand reaches things standing"
_FROM_THERE: Final = "done from where it rests: the pose is held, and nothing moves"
_UNDRAWN: Final = "nothing is drawn in the hands"
_LEFT_OUT: Final = {
    "take": "the hand is laid where it would lie; nothing is drawn in it",
    "put": "the hand is laid where it would lie; nothing is drawn in it",
    "operate": "the hand is laid on it; nothing moves",
    "call": "a phone is held to the ear; nobody is heard",
    "use": f"the pose is held; {_UNDRAWN}",
}
"""What the acting of a kind of order leaves out."""


def act_out(
    tasks: Sequence[SubTask], room: Surroundings, seed: int, most: int = MAX_KEYFRAMES
) -> tuple[list[Step], list[Keyframe]]:
    """Every step with what becomes of it, and the keyframes, which a body can act in this order as they are.

    A step that a body cannot act, or for which `most` keyframes leave no room, has none and says why. What is done in
    one rest shares its keyframe; the seed chooses among captions that show the same.
    """
    actor = _Actor(room, np.random.default_rng([seed, 11]), most)
    steps = [actor.step(number, task) for number, task in enumerate(tasks, 1)]
    return steps, actor.keyframes


class _CannotError(Exception):
    """A step that the body has no way to act; the text says why."""


class _Actor:
    """The body while steps become keyframes: where it is, what it rests on, where the plan has it seated."""

    def __init__(self, room: Surroundings, rng: np.random.Generator, most: int) -> None:
        self.room, self.rng, self.most = room, rng, most
        self.keyframes: list[Keyframe] = []
        self.posture = Posture.STANDING
        self.at = ""
        self.seat: tuple[Skill, str] | None = None
        """What the plan has the body rest on, though it may have risen to reach for something."""
        self.done: dict[int, list[str]] = {}
        """What is done in a keyframe, for its caption."""
        self.held: set[str] = set()

    def step(self, number: int, task: SubTask) -> Step:
        """One step acted, or the reason why not."""
        acted, why, used, furniture = True, "", list[int](), None
        first = len(self.keyframes)
        try:
            shared, why = self._act(task)
            used = [*range(first, len(self.keyframes))] or shared
            furniture = next((self.keyframes[i].furniture for i in reversed(used)), None)
            furniture = None if furniture == "floor" else furniture
        except _CannotError as error:
            acted, why = False, str(error)
        return Step(
            step=task.text, step_id=number, category=task.category, hand=task.hand, object=task.object,
            furniture=furniture, acted=acted, why=why, keyframes=used,
        )  # fmt: skip

    def _act(self, task: SubTask) -> tuple[list[int], str]:
        """Add what a step needs; keyframes that it shares, and what its acting leaves out."""
        if len(self.keyframes) + _MAX_PER_STEP > self.most:
            raise _CannotError(f"a plan has at most {self.most} keyframes; act the rest as a plan of its own")
        order = order_of(task.text)
        named = task.object if task.object and is_furniture(task.object) else ""
        word = task.furniture or (order.furniture if order else "") or named
        if order is None:
            return self._unknown(task, word)
        why = _LEFT_OUT.get(order.kind, "")
        match order.kind:
            case "never":
                raise _CannotError(order.why_never)
            case "walk":
                return self._walk(task, order, word), ""
            case "rest":
                need = "sit" if order.deed.skill is Skill.SITDOWN else "lie"
                word = "floor" if order.deed.pieces == ("floor",) else word or self.at or "floor"
                return self._rest(order.deed.skill, word if word == "floor" else self._found(word, need)), ""
            case "rise":
                if self.posture is Posture.STANDING:
                    raise _CannotError("it is on its feet already")
                self.seat = None
                return self._stand(), ""
            case "take" | "put":
                return self._grasp(task, order, word, why)
            case "operate":
                return self._operate(task, order, word, why)
            case "use" | "call":
                return self._use(task, order, word, why)

    def _unknown(self, task: SubTask, word: str) -> tuple[list[int], str]:
        """A step whose verb we do not know, by its category."""
        if task.category == "locomotion":
            raise _CannotError("no such movement is known; the body walks, sits, lies, rises and reaches")
        if self.seat is not None and task.category == "interaction":
            return self._while_resting(task.text, (), "the pose is held: the body knows no such movement")
        return self._touch(task, word), "the body only lays a hand there: it knows no such movement"

    # Moving.

    def _walk(self, task: SubTask, order: Order, word: str) -> list[int]:
        self.seat = None
        captions = order.deed.row.captions
        if word:
            return self._go(self._found(word, "touch"), captions[0] if captions and order.goes else None)
        target = next((words for preposition, words in order.places if preposition in ("to", "into")), "")
        if target and order.goes:
            raise _CannotError(f"“{target}” is no furniture we know, so there is no place to walk to")
        self._stand()
        self.at = ""
        caption = captions[0] if captions else household().captions["walk"][0]
        return self._add(Skill.LOCO, caption if order.goes else caption_of([task.text], caption), "floor")

    def _go(self, word: str, caption: str | None = None) -> list[int]:
        """Walk to a piece of furniture, unless the body is there."""
        if self.at == word and self.keyframes:
            return [len(self.keyframes) - 1]
        self._stand()
        self.at = word
        return self._add(Skill.LOCO, caption or household().captions["walk"][0], word)

    def _rest(self, skill: Skill, word: str) -> list[int]:
        """Sit or lie down, or stay as one is."""
        posture = Posture.SEATED if skill is Skill.SITDOWN else Posture.LYING
        self.seat = (skill, word)
        if self.posture is posture and self.at == word:
            return [len(self.keyframes) - 1]
        if word != "floor":
            self._go(word)
        self._stand()
        self._add(skill, self._one_of(household().captions["sit" if skill is Skill.SITDOWN else "lie"]), word)
        self.posture, self.at = posture, word
        return []

    def _stand(self) -> list[int]:
        """Leave what the body rests on."""
        if self.posture is Posture.STANDING:
            return []
        skill, caption = RISES[self.posture]
        self.posture = Posture.STANDING
        return self._add(skill, caption, self.at)

    # Reaching.

    def _grasp(self, task: SubTask, order: Order, word: str, why: str) -> tuple[list[int], str]:
        """Lay the named hand where a thing is, or is to be."""
        thing = task.object if task.object and not is_furniture(task.object) else order.thing
        rises = self.posture is not Posture.STANDING
        how = f"{'put down' if order.kind == 'put' else 'pick up'} with the {{hand}} hand"
        used = self._touch(task, word or self._keeper(thing), how)
        (self.held.discard if order.kind == "put" else self.held.add)(thing)
        return used, "; ".join(filter(None, (_RISES_FOR_IT if rises else "", why)))

    def _keeper(self, thing: str) -> str:
        """Where a thing of which nobody says where it is may be: here, or where such things are kept."""
        options = kept_at(thing)
        if self.at and self.room.find(self.at) and (self.at in options or thing in self.held):
            return self.at
        if found := self.room.first(options) or self.room.find(self.at):
            return found
        raise _CannotError(f"there is no {', '.join(options[:3])} or the like here to have the {thing} on")

    def _operate(self, task: SubTask, order: Order, word: str, why: str) -> tuple[list[int], str]:
        """An interaction with something that stands there: a hand is laid on it, unless it is done from one's seat."""
        here = self.posture is not Posture.STANDING and (not word or word == self.at)
        if here or (self.seat is not None and "remote" in self.held):
            return self._while_resting(task.text, (), _FROM_THERE)
        if is_fixed(order.thing) or not (word or self.room.find(self.at)):
            raise _CannotError(f"“{order.thing or task.text}” is no furniture with a surface for a hand to be laid on")
        rises = self.posture is not Posture.STANDING
        shown = order.deed.row.captions[:1]
        other = task.hand == "left" and any("right" in caption for caption in shown)
        used = self._touch(task, word, "" if other else "".join(shown))
        return used, "; ".join(filter(None, (_RISES_FOR_IT if rises else "", why)))

    def _touch(self, task: SubTask, word: str, how: str = "") -> list[int]:
        """Lay a hand on furniture, or on what the body is at."""
        if not word and not self.room.find(self.at):
            raise _CannotError("there is no furniture near to do it at")
        where = self._found(word or self.at, "touch")
        self._stand()
        self._go(where)
        hand = "left" if task.hand == "left" else "right"
        return self._add(
            Skill.TOUCH, caption_of([task.text], (how or household().captions["touch"][0]).format(hand=hand)), where
        )

    # Doing something for a while.

    def _use(self, task: SubTask, order: Order, word: str, why: str) -> tuple[list[int], str]:
        """An interaction with a pose: at rest where the plan has the body, else where one does it, else standing."""
        row = order.deed.row
        if word and word != self.at and self.seat is None and order.kind == "use":
            if self.room.find(word) and not self.room.find(word, "sit"):
                return self._touch(task, word), _UNDRAWN
            self._rest(Skill.SITDOWN, self._found(word, "sit"))
        elif self.seat is not None:
            self._rest(*self.seat)
        if self.posture is Posture.STANDING and order.kind == "call":
            self.at = ""
            return self._add(Skill.LOCO, caption_of([task.text], self._by_hand(row.captions, task)[0]), "floor"), why
        if self.posture is Posture.STANDING:
            return self._touch(task, ""), _UNDRAWN
        lying = self.posture is Posture.LYING
        skill = Skill.LIEDOWN if lying else Skill.SITDOWN
        shown = row.captions if order.deed.skill is skill else row.lying if lying else row.seated
        shown = tuple(self._by_hand(shown, task))
        other = "it is shown with the right hand" if task.hand == "left" and "right hand" in "".join(shown[:1]) else ""
        return self._while_resting(task.text, shown, "; ".join(filter(None, (why if order.hands else "", other))))

    def _while_resting(self, text: str, how: Sequence[str], why: str) -> tuple[list[int], str]:
        """Do it in the rest the body is in; the caption names it, and a pose of its own shows it."""
        if self.posture is Posture.STANDING and self.seat is not None:
            self._rest(*self.seat)
        index = len(self.keyframes) - 1
        done = [*self.done.get(index, []), text]
        pose = self._one_of(how) if how else self.keyframes[index].caption.rpartition("; ")[2]
        caption = caption_of(done, pose)
        if len(caption) > MAX_CAPTION_LENGTH:
            return [index], "the caption of this rest names no more than is done before it"
        if held_in(self.keyframes[index].skill, pose) is not None:
            why = why.removesuffix(f"; {_UNDRAWN}").replace(f"; {_UNDRAWN};", ";")
        self.done[index] = done
        self.keyframes[index] = self.keyframes[index].model_copy(update={"caption": caption})
        return [index], why

    # Smaller things.

    @staticmethod
    def _by_hand(captions: Sequence[str], task: SubTask) -> Sequence[str]:
        """The captions that show it with the hand of the task, else all."""
        hand = "left" if task.hand == "left" else "right"
        return [caption for caption in captions if hand in caption.split()] or captions

    def _add(self, skill: Skill, caption: str, word: str) -> list[int]:
        """One more keyframe; the very same one after another would be acted once, so it is there once."""
        keyframe = Keyframe(skill=skill, emotion="neutral", caption=caption, furniture=word)
        if self.keyframes[-1:] != [keyframe]:
            self.keyframes.append(keyframe)
        return [len(self.keyframes) - 1]

    def _found(self, word: str, need: str) -> str:
        if found := self.room.find(word, need):
            return found
        raise _CannotError(self.room.missing(word, need))

    def _one_of(self, captions: Sequence[str]) -> str:
        return captions[int(self.rng.integers(len(captions)))]
