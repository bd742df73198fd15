"""Steps to keyframes: what a body can do of each step, and with which captions (LINGO appendix C, SIMS 3.4).

What furniture there is for a task, and what a body can really do at it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from motion_backend.motion import Posture, Skill
from planner_service.grounding.object_assignment import usable_offers
from planner_service.grounding.seat_access import pullable_seats
from planner_service.scripts.caption_actions import MAX_CAPTION_LENGTH, caption_of
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_repair import RISES
from planner_service.tasks.household_knowledge import household, is_fixed, kept_at
from planner_service.tasks.instruction_parser import Clause, clause_of, is_furniture
from planner_service.tasks.task_plan import MAX_KEYFRAMES, Step, SubTask
from scene_graphs import furniture
from scene_graphs.home import Home


class Surroundings:
    """The furniture of a home; without one, anything we know may be there."""

    def __init__(self, home: Home | None = None) -> None:
        self.home = home
        self._offers: dict[str, frozenset[str]] = {}
        if home is not None:
            usable = usable_offers(home)
            seats = pullable_seats(home, usable)
            for placed in home.objects:
                offered = usable[placed.id] | ({"sit"} if placed.id in seats else set())
                self._offers[placed.category] = self._offers.get(placed.category, frozenset()) | offered

    def find(self, word: str, need: str = "touch", exactly: bool = False) -> str:
        """The furniture that a word means and where a body can sit, lie or touch, as a keyframe calls it; "" if none.

        Of the very kind if there is one, else, if that will do, of its class (a loveseat for a sofa); a plant is no
        mirror, though.
        """
        if not furniture.is_known(word):
            return ""
        if self.home is None:
            return furniture.display_name(word) if need in furniture.affordances(word) else ""
        having = sorted(category for category, offered in self._offers.items() if need in offered)
        exact = [category for category in having if category in furniture.categories_of(word)]
        if not exact and not exactly and furniture.class_of(word) != "decor":
            exact = [category for category in having if furniture.class_of(category) == furniture.class_of(word)]
        return furniture.display_name(exact[0]) if exact else ""

    def first(self, words: Iterable[str], need: str = "touch") -> str:
        """The first of these that there is, of that very kind; "" if none."""
        return next(filter(None, (self.find(word, need, exactly=True) for word in words)), "")

    def missing(self, word: str, need: str = "touch") -> str:
        """Why `find` found nothing."""
        if not furniture.is_known(word):
            return f"“{word}” is no furniture we know"
        if need not in furniture.affordances(word):
            return f"nobody can {need} {'the' if need == 'touch' else 'on the'} {word}"
        return f"there is no {word} here that a body can {'touch' if need == 'touch' else need + ' on'}"

    @property
    def names(self) -> tuple[str, ...]:
        """Everything that can be sat or lain on or touched, as a person would call it."""
        known = self._offers if self.home is not None else furniture_words()
        return tuple(
            sorted({furniture.display_name(word) for word in known if self.find(word) or self.find(word, "sit")})
        )


def furniture_words() -> tuple[str, ...]:
    """Every kind of furniture we know."""
    return tuple(sorted(furniture.catalogue().class_of))


_RISES_FOR_IT: Final = "it rises for it: a hand reaches things standing"
_MAX_PER_STEP: Final = 4
"""Keyframes that one step may take: rising, a walk, a touch or a rest."""
_FROM_THERE: Final = "done from where it rests: the pose is held, and nothing moves"
_UNDRAWN: Final = "nothing is drawn in the hands"


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
        clause = clause_of(task.text)
        if clause is None:
            return self._unknown(task)
        if clause.deed.kind == "never":
            raise _CannotError(clause.deed.why)
        word = task.furniture or clause.furniture or _furniture_of(task)
        match clause.deed.kind:
            case "walk":
                return self._walk(clause, word)
            case "sit" | "lie" if task.category != "interaction":
                need, skill = ("sit", Skill.SITDOWN) if clause.deed.kind == "sit" else ("lie", Skill.LIEDOWN)
                return self._rest(skill, self._found(word or self.at, need) if word or self.at else "floor")
            case "rise":
                return self._rise()
            case "take" | "put" | "carry" | "touch":
                return self._handle(task, clause, word)
            case "operate":
                return self._operate(task, clause, word)
            case "stand":
                self._stand()
                self.at, how = "", clause.deed.how[0]
                return self._add(Skill.LOCO, caption_of([task.text], how), "floor"), clause.deed.why
            case _:
                return self._use(task, clause, word)

    def _unknown(self, task: SubTask) -> tuple[list[int], str]:
        """A step whose verb we do not know, by its category."""
        word = task.furniture or _furniture_of(task)
        if task.category == "locomotion":
            raise _CannotError("no such movement is known; the body walks, sits, lies, rises and reaches")
        if self.seat is not None and task.category == "interaction":
            return self._while_resting(task.text, (), "the pose is held: the body knows no such movement")
        where = self.room.find(word) if word else self._near()
        if not where:
            raise _CannotError(self.room.missing(word) if word else "there is no furniture near to do it at")
        return self._touch(
            task, where, household().captions.touch
        ), "the body only lays a hand there: it knows no such movement"

    # Moving.

    def _walk(self, clause: Clause, word: str) -> tuple[list[int], str]:
        self.seat = None
        self._stand()
        caption = household().captions.walk_by_verb.get(clause.verb.split()[0])
        if word:
            return self._go(self._found(word, "touch"), caption), ""
        named = [noun for preposition, noun in clause.places if preposition not in ("for", "with")]
        if named:
            raise _CannotError(f"“{named[0]}” is no furniture we know, so there is no place to walk to")
        self.at = ""
        return self._add(Skill.LOCO, caption or household().captions.walk, "floor"), ""

    def _go(self, word: str, caption: str | None = None) -> list[int]:
        """Walk to a piece of furniture, unless the body is there."""
        if self.at == word and self.keyframes:
            return [len(self.keyframes) - 1]
        self._stand()
        self.at = word
        return self._add(Skill.LOCO, caption or household().captions.walk, word)

    def _rest(self, skill: Skill, word: str) -> tuple[list[int], str]:
        """Sit or lie down, or stay as one is."""
        posture = Posture.SEATED if skill is Skill.SITDOWN else Posture.LYING
        self.seat = (skill, word)
        if self.posture is posture and self.at == word:
            return [len(self.keyframes) - 1], ""
        if word != "floor":
            self._go(word)
        else:
            self._stand()
        captions = household().captions
        self._add(skill, self._one_of(captions.sit if skill is Skill.SITDOWN else captions.lie), word)
        self.posture, self.at = posture, word
        return [], ""

    def _rise(self) -> tuple[list[int], str]:
        if self.posture is Posture.STANDING:
            raise _CannotError("it is on its feet already")
        self.seat = None
        return self._stand(), ""

    def _stand(self) -> list[int]:
        """Leave what the body rests on."""
        if self.posture is Posture.STANDING:
            return []
        skill, caption = RISES[self.posture]
        self.posture = Posture.STANDING
        return self._add(skill, caption, self.at)

    # Reaching.

    def _handle(self, task: SubTask, clause: Clause, word: str) -> tuple[list[int], str]:
        """A grasp: lay the named hand where the thing is, or is to be."""
        thing = task.object if task.object and not is_furniture(task.object) else clause.thing
        rises = self.posture is not Posture.STANDING
        where = self._found(word, "touch") if word else self._keeper(thing)
        how = clause.deed.how[0] if clause.deed.how else "pick up with the {hand} hand"
        used = self._touch(task, where, how)
        (self.held.discard if clause.deed.kind == "put" else self.held.add)(thing)
        return used, "; ".join(filter(None, (_RISES_FOR_IT if rises else "", clause.deed.why)))

    def _keeper(self, thing: str) -> str:
        """Where a thing of which nobody says where it is may be: here, or where such things are kept."""
        options = kept_at(thing)
        if self.at and self.room.find(self.at) and (self.at in options or thing in self.held):
            return self.at
        found = self.room.first(options) or self._near()
        if not found:
            raise _CannotError(f"there is no {', '.join(options[:3])} or the like here to have the {thing} on")
        return found

    def _operate(self, task: SubTask, clause: Clause, word: str) -> tuple[list[int], str]:
        """An interaction with something that stands there: a hand is laid on it, unless it is done from one's seat."""
        if self.posture is not Posture.STANDING and (not word or word == self.at or "remote" in self.held):
            return self._while_resting(task.text, (), _FROM_THERE)
        if self.seat is not None and "remote" in self.held:
            self._rest(*self.seat)
            return self._while_resting(task.text, (), _FROM_THERE)
        thing = clause.thing
        where = self._found(word, "touch") if word else self._near()
        if not where or is_fixed(thing):
            raise _CannotError(f"“{thing or task.text}” is no furniture with a surface that a hand could be laid on")
        rises = self.posture is not Posture.STANDING
        how = clause.deed.how[0]
        if "{hand}" not in how and task.hand not in (None, "right", "both"):
            how = household().captions.touch
        used = self._touch(task, where, how)
        return used, "; ".join(filter(None, (_RISES_FOR_IT if rises else "", clause.deed.why)))

    def _touch(self, task: SubTask, where: str, how: str) -> list[int]:
        self._stand()
        self._go(where)
        hand = "left" if task.hand == "left" else "right"
        return self._add(Skill.TOUCH, caption_of([task.text], how.format(hand=hand)), where)

    # Doing something for a while.

    def _use(self, task: SubTask, clause: Clause, word: str) -> tuple[list[int], str]:
        """An interaction with a pose: at rest where the plan has the body, else where one does it, else standing."""
        deed = clause.deed
        on_the_phone = deed.takes == "phone"
        if word and word != self.at and self.seat is None and not on_the_phone:
            need = "touch" if self.room.find(word) and not self.room.find(word, "sit") else "sit"
            where = self._found(word, need)
            if need == "touch":
                return self._touch(task, where, household().captions.touch), _UNDRAWN
            self._rest(Skill.SITDOWN, where)
        elif self.seat is not None and self.posture is Posture.STANDING:
            self._rest(*self.seat)
        if self.posture is not Posture.STANDING:
            captions = household().captions
            how = (captions.phone_by_hand["left" if task.hand == "left" else "right"],) if on_the_phone else deed.how
            if self.posture is Posture.LYING:
                how = tuple(filter(None, [captions.lie_by_verb.get(clause.verb)]))
            right = any("right hand" in one for one in how)
            other = "it is shown with the right hand" if task.hand == "left" and right else ""
            return self._while_resting(task.text, how, "; ".join(filter(None, (deed.why, other))))
        if on_the_phone:
            hand = "left" if task.hand == "left" else "right"
            self.at = ""
            return self._add(Skill.LOCO, caption_of([task.text], deed.how[0].format(hand=hand)), "floor"), deed.why
        where = self._near()
        if not where:
            raise _CannotError("there is no seat and no furniture near to do it at")
        return self._touch(task, where, household().captions.touch), _UNDRAWN

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
        self.done[index] = done
        self.keyframes[index] = self.keyframes[index].model_copy(update={"caption": caption})
        return [index], why

    # Smaller things.

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

    def _near(self) -> str:
        """What the body stands at, if it can be touched."""
        return self.room.find(self.at) if self.at else ""

    def _one_of(self, captions: Sequence[str]) -> str:
        return captions[int(self.rng.integers(len(captions)))]


def _furniture_of(task: SubTask) -> str:
    return task.object if task.object and is_furniture(task.object) else ""
