"""An instruction broken into steps by rules: go there, take what it needs, sit where one sits, do it, put it back.

The body while rules plan: where it is, what it rests on and holds, and the steps that prepare what is to be done.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal

from motion_backend.motion import Posture
from motion_backend.planners.markov_planner import Category, Hand
from planner_service.tasks.household_knowledge import (
    Deed,
    any_of,
    anywhere,
    household,
    is_fixed,
    kept_at,
    vessel_of,
)
from planner_service.tasks.instruction_parser import Clause, clauses, is_furniture
from planner_service.tasks.task_actions import Surroundings
from planner_service.tasks.task_plan import MAX_STEPS, SubTask, TaskError
from scene_graphs import furniture

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
            self.put(next(iter(self.held)), self.at or self.room.first(anywhere()) or "table")
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
                self.put(thing, self.at or self.room.first(anywhere()) or "table")


def with_hand(hand: str) -> str:
    """The words for a hand at the end of a step."""
    return "with both hands" if hand == "both" else f"with the {hand} hand"


_GAMES: Final = ("game", "video game", "computer game", "console")


def plan_by_rules(action: str, room: Surroundings) -> tuple[SubTask, ...]:
    """The steps of an instruction. TaskError says what of it the rules do not know, or that it takes too many steps."""
    body = _Doing(room)
    asked = clauses(action)
    for index, clause in enumerate(asked):
        body.put_back_before(clause, asked[index:])
        body.do(clause)
    body.put_back_at_end()
    if len(body.steps) > MAX_STEPS:
        raise TaskError(
            f"it takes {len(body.steps)} steps, at most {MAX_STEPS} are planned", "split it up", at="action"
        )
    return tuple(body.steps)


class _Doing(Preparing):
    """One method a kind of deed."""

    def do(self, clause: Clause) -> None:
        """The steps of one clause."""
        kind = clause.deed.kind
        doing = {
            "walk": self._walk_as_told, "sit": self._sit_as_told, "lie": self._lie_as_told, "rise": self._rise_as_told,
            "take": self._take_as_told, "put": self._put_as_told, "carry": self._carry, "touch": self._touch,
            "operate": self._operate, "use": self._use, "stand": self._simply, "never": self._simply,
        }  # fmt: skip
        doing[kind](clause)

    def put_back_before(self, clause: Clause, coming: Sequence[Clause]) -> None:
        """What was fetched for what is done, and is not used again, goes back where it was."""
        wanted = {needed(one) for one in coming} | {one.thing for one in coming}
        seated = clause.deed.kind == "use" and not clause.furniture and self.posture is not Posture.STANDING
        for thing, where in list(self.fetched.items()):
            if thing not in wanted and not seated:
                self.put(thing, where)

    def put_back_at_end(self) -> None:
        """Who stands puts back what was fetched; who rests keeps it."""
        for thing, where in list(self.fetched.items()):
            if self.posture is Posture.STANDING:
                self.put(thing, where)

    def _walk_as_told(self, clause: Clause) -> None:
        if clause.furniture:
            self.rise()
            word = self.named(clause.furniture, "touch")
            self.add(f"{_manner(clause)} to the {word}", "locomotion", None, word, word)
            self.at = word
        else:
            self.rise()
            place = f" {clause.places[0][0]} the {clause.places[0][1]}" if clause.places else ""
            self.add(f"{clause.verb}{place}", "locomotion", None, None, None)
            self.at = ""

    def _sit_as_told(self, clause: Clause) -> None:
        self.sit(self._seat(clause, clause.furniture))
        if clause.verb not in ("sit", "sit down", "sit back", "take a seat", "have a seat", "be seated"):
            self.add(clause.verb, "interaction", None, None, self.at)

    def _lie_as_told(self, clause: Clause) -> None:
        word = clause.furniture
        self.lie(self.named(word, "lie") if word else self._first(clause.deed, "lie"))
        if clause.verb not in ("lie", "lie down", "lay down", "go to bed"):
            self.add(clause.verb, "interaction", None, None, self.at)

    def _rise_as_told(self, clause: Clause) -> None:
        if self.posture is Posture.STANDING:
            self.add(clause.verb, "locomotion", None, None, None)
        self.rise()

    def _take_as_told(self, clause: Clause) -> None:
        thing = self._thing(clause)
        if is_furniture(thing) and not clause.furniture.endswith(thing):
            self._touch(clause)
            return
        source = next((noun for word, noun in clause.places if is_furniture(noun)), "")
        self.take(thing, clause.hand, self.named(source, "touch") if source else "")
        self.fetched.pop(thing, None)

    def _put_as_told(self, clause: Clause) -> None:
        thing = self._thing(clause)
        self.take(thing, clause.hand)
        back = clause.verb in ("put back", "put away")
        where = self.fetched.get(thing, "") if back else ""
        target = next((noun for _, noun in clause.places if is_furniture(noun)), "")
        here = "" if back else self.at
        self.put(thing, self.named(target, "touch") if target else where or here or self._first(clause.deed, "touch"))

    def _carry(self, clause: Clause) -> None:
        thing = self._thing(clause)
        source = next((noun for word, noun in clause.places if word in ("from", "out of") and is_furniture(noun)), "")
        target = next((noun for word, noun in clause.places if word not in ("from", "out of", "with")), "")
        self.take(thing, clause.hand, self.named(source, "touch") if source else "")
        if is_furniture(target):
            self.put(thing, self.named(target, "touch"))

    def _touch(self, clause: Clause) -> None:
        if not clause.furniture:
            raise TaskError(
                f"“{clause.phrase}” names no furniture to {clause.verb}", "name some, such as a table", at="action"
            )
        word = self.named(clause.furniture, "touch")
        hand = clause.hand or self.free_hand()
        self.walk(word)
        self.add(f"{clause.verb} the {word} {with_hand(hand)}", "grasp", hand, word, word)

    def _operate(self, clause: Clause) -> None:
        tool = tool_of(clause)
        hand = clause.hand
        if tool and not hand and tool not in self.held:
            hand = self.free_hand()
        if tool:
            fresh = tool not in self.held
            hand = self.take(tool, hand)
            if fresh:
                self.fetched[tool] = self.at
        hand = hand or ("both" if clause.deed.hands == "both" and not self.held else self.free_hand())
        fixed = is_fixed(clause.thing)
        if not fixed:
            self.walk(self._workplace(clause))
        where = None if fixed else self.at
        self.add(f"{clause.phrase} {with_hand(hand)}", "interaction", hand, clause.thing or tool or None, where)

    def _use(self, clause: Clause) -> None:
        thing, deed = needed(clause), clause.deed
        place = clause.furniture if any(noun == clause.furniture for _, noun in clause.places) else ""
        hand = clause.hand
        if thing:
            fresh = thing not in self.held
            hand = self.take(thing, hand if hand != "both" else None)
            if fresh:
                self.fetched[thing] = self.at
        if clause.verb in ("call", "phone", "ring") or "talk" in clause.verb or deed.takes == "phone":
            self._on_the_phone(clause, place, hand)
            return
        lying = place and "in" in [word for word, noun in clause.places if noun == place]
        if lying and "lie" in furniture.affordances(place):
            self.lie(self.named(place, "lie"))
        elif place or self.posture is Posture.STANDING:
            self._settle(clause, place)
        if deed.first and is_furniture(clause.thing):
            self.add(f"{deed.first} the {clause.thing} {with_hand(hand or 'right')}", "interaction", hand or "right",
                      clause.thing, self.at)  # fmt: skip
        if not deed.hands:
            hand = None
        elif deed.hands == "both":
            hand = "both"
        told = f" {with_hand(hand)}" if hand else ""
        self.add(f"{clause.phrase}{told}", "interaction", hand, clause.thing or thing or None, self.at)

    def _on_the_phone(self, clause: Clause, place: str, hand: Hand | None) -> None:
        if place:
            self._settle(clause, place)
        told = f"{clause.phrase} {with_hand(hand or 'right')}"
        where = self.at if self.posture is not Posture.STANDING else None
        self.add(told, "interaction", hand or "right", "phone", where)

    def _simply(self, clause: Clause) -> None:
        """What is done on the spot, or not at all."""
        hand = clause.hand or ("right" if clause.deed.hands else None)
        category: Category = "interaction" if clause.deed.hands else "locomotion"
        told = f" {with_hand(hand)}" if hand else ""
        if clause.deed.kind == "stand":
            self.rise()
        self.add(f"{clause.phrase}{told}", category, hand, clause.thing or None, None)

    # Where it is done.

    def _first(self, deed: Deed, need: str) -> str:
        return self.room.first(deed.where, need) or deed.where[0]

    def _settle(self, clause: Clause, place: str) -> None:
        """Sit where it is done; where there is a table and no seat to it, stand there."""
        seat, table = self._seat(clause, place), self.room.find(place)
        if self.room.find(seat, "sit") or not table:
            self.sit(seat)
        else:
            self.walk(table)

    def _seat(self, clause: Clause, place: str) -> str:
        """Where one sits: on what is named, at the table that is named, or on a usual seat."""
        if place and "sit" in furniture.affordances(place) and furniture.class_of(place) != "table":
            return self.named(place, "sit")
        at_table = place and furniture.group_of(place) == "surface"
        home = household().home
        at_tables = home.seats_beside.get(furniture.display_name(place), home.seats_at_a_table)
        options = at_tables if at_table else clause.deed.where or any_of("seat")
        return self.room.first(options, "sit") or options[0]

    @staticmethod
    def _thing(clause: Clause) -> str:
        if clause.thing:
            return clause.thing
        raise TaskError(f"it does not say what to {clause.verb}", "name the thing, such as a cup", at="action")

    def _workplace(self, clause: Clause) -> str:
        """Where an operation is done: at what is operated, where it is told, where the thing is, or the usual place."""
        if clause.furniture:
            return self.named(clause.furniture, "touch")
        if clause.deed.where:
            return self._first(clause.deed, "touch")
        if self.posture is Posture.STANDING and self.at:
            return self.at
        options = kept_at(clause.thing) if clause.thing else any_of("table")
        return self.room.first(options) or options[0]


def needed(clause: Clause) -> str:
    """What a deed needs in hand: "" for nothing."""
    deed = clause.deed
    if deed.kind in ("take", "put", "carry"):
        return clause.thing
    if deed.kind == "operate":
        return tool_of(clause)
    if deed.kind != "use":
        return ""
    if deed.first and furniture.canonical(clause.thing or "x") == "tv":
        return "remote"
    match deed.takes:
        case "=":
            return clause.thing or "book"
        case "cup" | "plate":
            return vessel_of(clause.thing, deed.takes) if clause.thing else deed.takes
        case "gamepad" if clause.thing and not clause.thing.endswith(_GAMES):
            return clause.thing
        case other:
            return other


def tool_of(clause: Clause) -> str:
    """What an operation is done with: "with the sponge", or the usual thing."""
    told = next((noun for word, noun in clause.places if word == "with"), "")
    return told or clause.deed.takes


def _manner(clause: Clause) -> str:
    return "walk" if clause.verb in ("go", "move", "come", "head", "return", "approach", "step") else clause.verb
