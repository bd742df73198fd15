"""The body while rules plan: where it is, what it rests on and holds, and the steps that prepare what is to be done."""

from __future__ import annotations

from typing import Literal

from motion_backend.markov import Category, Hand
from motion_backend.motion import Posture
from planner_service.tasks.plan import SubTask
from planner_service.tasks.surroundings import Surroundings
from planner_service.tasks.things import ANYWHERE, kept_at, words

Side = Literal["left", "right"]


class Preparing:
    """The steps so far, and how they leave the body."""

    def __init__(self, room: Surroundings) -> None:
        self.room = room
        self.steps: list[SubTask] = []
        self.at = ""
        self.posture = Posture.STANDING
        self.held: dict[str, Hand] = {}
        self.fetched: dict[str, str] = {}
        """What was taken only to be used, and where it was."""

    def add(
        self, text: str, category: Category, hand: Hand | None,
        thing: str | None, where: str | None,
    ) -> None:  # fmt: skip
        """One more step."""
        self.steps.append(SubTask(text, category, hand, thing, where))

    def rise(self) -> None:
        """Be on one's feet."""
        if self.posture is Posture.STANDING:
            return
        verb = "stand up from" if self.posture is Posture.SEATED else "get up from"
        self.add(f"{verb} the {self.at}", "locomotion", None, self.at, self.at)
        self.posture = Posture.STANDING

    def walk(self, word: str) -> None:
        """Be beside a piece of furniture, on one's feet."""
        self.rise()
        if self.at != word:
            self.add(f"walk to the {word}", "locomotion", None, word, word)
            self.at = word

    def sit(self, word: str) -> None:
        """Sit on a piece of furniture."""
        if self.posture is Posture.SEATED and self.at == word:
            return
        self.walk(word)
        self.add(f"sit down on the {word}", "locomotion", None, word, word)
        self.posture = Posture.SEATED

    def lie(self, word: str) -> None:
        """Lie on a piece of furniture."""
        if self.posture is Posture.LYING and self.at == word:
            return
        self.walk(word)
        self.add(f"lie down on the {word}", "locomotion", None, word, word)
        self.posture = Posture.LYING

    def take(self, thing: str, hand: Hand | None = None, where: str = "") -> Hand:
        """Have a thing in hand, and say in which."""
        if thing in self.held:
            return self.held[thing]
        where = where or self._keeper(thing)
        chosen = hand or self.free_hand()
        self._make_free(chosen)
        self.walk(where)
        self.add(f"pick up the {thing} {with_hand(chosen)}", "grasp", chosen, thing, where)
        self.held[thing] = chosen
        return chosen

    def put(self, thing: str, where: str) -> None:
        """Lay down what is held."""
        hand = self.held.pop(thing)
        self.fetched.pop(thing, None)
        self.walk(where)
        self.add(f"put down the {thing} {with_hand(hand)}", "grasp", hand, thing, where)

    def free_hand(self) -> Side:
        """A hand that holds nothing, the right one if it can be; one is emptied if need be."""
        taken = set(self.held.values())
        if "both" in taken or {"left", "right"} <= taken:
            self.put(next(iter(self.held)), self.at or self.room.first(words(ANYWHERE)) or "table")
            taken = set(self.held.values())
        return "left" if "right" in taken or "both" in taken else "right"

    def named(self, word: str, need: str) -> str:
        """What a piece of furniture is called here; as it was called where there is none."""
        return self.room.find(word, need) or word.lower().replace("tv", "TV")

    def _keeper(self, thing: str) -> str:
        """Where a thing is taken from: here if it may be here, else where such things usually are."""
        options = kept_at(thing)
        if self.posture is Posture.STANDING and self.at in options and self.room.find(self.at):
            return self.at
        return self.room.first(options) or options[0]

    def _make_free(self, hand: Hand) -> None:
        """Lay down what a hand holds that is to take something else."""
        for thing, holding in list(self.held.items()):
            if hand == "both" or holding in (hand, "both"):
                self.put(thing, self.at or self.room.first(words(ANYWHERE)) or "table")


def with_hand(hand: str) -> str:
    """The words for a hand at the end of a step."""
    return "with both hands" if hand == "both" else f"with the {hand} hand"
