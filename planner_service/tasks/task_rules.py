"""An instruction broken into steps by rules: go there, take what it needs, sit where one sits, do it, put it back."""

from __future__ import annotations

from collections.abc import Sequence

from motion_backend.motion import Posture, Skill
from motion_backend.planners.markov_planner import Category, Hand
from planner_service.tasks.household import household, kept_at
from planner_service.tasks.instruction import Order, is_fixed, is_furniture, orders_of
from planner_service.tasks.surroundings import Surroundings
from planner_service.tasks.task_plan import MAX_STEPS, SubTask, TaskError
from scene_graphs import furniture


def plan_by_rules(action: str, room: Surroundings) -> tuple[SubTask, ...]:
    """The steps of an instruction. TaskError says what of it the rules do not know, or that it takes too many steps."""
    body = _Body(room)
    asked = orders_of(action)
    for index, order in enumerate(asked):
        body.put_back(asked[index:])
        body.do(order)
    body.put_back(())
    if len(body.steps) > MAX_STEPS:
        raise TaskError(
            f"it takes {len(body.steps)} steps, at most {MAX_STEPS} are planned", "split it up", at="action"
        )
    return tuple(body.steps)


class _Body:
    """The steps so far, and how they leave the body."""

    def __init__(self, room: Surroundings) -> None:
        self.room = room
        self.steps: list[SubTask] = []
        self.at = ""
        self.posture = Posture.STANDING
        self.held: dict[str, Hand] = {}
        self.fetched: dict[str, str] = {}
        """What was taken only to be used, and where it was."""

    def do(self, order: Order) -> None:
        """The steps of one order."""
        match order.kind:
            case "walk":
                self._walk_as_told(order)
            case "rest":
                self._settle(order)
            case "rise":
                if self.posture is Posture.STANDING:
                    self._add(order.verb, "locomotion")
                self._rise()
            case "take":
                self._take(_thing(order), order.hand, self._named(order.source or order.furniture))
                self.fetched.pop(order.thing, None)
            case "put":
                self._put_as_told(order)
            case "operate":
                self._operate(order)
            case "use" | "call":
                self._use(order)
            case "never":
                hand: Hand | None = order.hand or ("right" if order.thing else None)
                self._add(order.phrase, "interaction" if hand else "locomotion", hand, order.thing)

    def put_back(self, coming: Sequence[Order]) -> None:
        """What was fetched for what is done, and is not used again, goes back where it was; who rests keeps it."""
        wanted = {one.needs for one in coming} | {one.thing for one in coming}
        stays = not coming or (coming[0].kind == "use" and not coming[0].furniture)
        for thing, where in list(self.fetched.items()):
            if thing not in wanted and (self.posture is Posture.STANDING or not stays):
                self._put(thing, where)

    def _walk_as_told(self, order: Order) -> None:
        self._rise()
        if word := self._named(order.furniture):
            manner = order.verb if order.goes and order.deed.row.captions else "walk"
            self._add(f"{manner} to the {word}", "locomotion", None, word, word)
            self.at = word
        if not word or not order.goes:
            hand = order.hand or order.hands
            told = f"{order.phrase} {_with(hand)}" if hand else order.phrase
            self._add(told, "interaction" if hand else "locomotion", hand)

    def _put_as_told(self, order: Order) -> None:
        thing = _thing(order)
        self._take(thing, order.hand, self._named(order.source))
        back = self.fetched.get(thing, "") if order.verb in ("put back", "put away") else self.room.find(self.at)
        self._put(thing, self._named(order.target) or back or self._first(kept_at(thing)))

    def _operate(self, order: Order) -> None:
        hand, fixed = order.hand, is_fixed(order.thing)
        if order.tool:
            hand = self._fetch(order.tool, hand)
        hand = hand or ("both" if order.hands == "both" and not self.held else self._free_hand())
        if not fixed and not (order.tool and self.at in order.deed.pieces and not order.furniture):
            self._walk(self._named(order.furniture) or self._first(order.deed.pieces or kept_at(order.thing)))
        self._add(
            f"{order.phrase} {_with(hand)}", "interaction", hand, order.thing or order.tool, "" if fixed else self.at
        )

    def _use(self, order: Order) -> None:
        hand, hands = order.hand, order.hands
        seat = self.at if self.posture is Posture.SEATED else ""
        if order.needs:
            hand = self._fetch(order.needs, hand if hand != "both" else None)
        if order.kind == "use":
            keeps = self.posture is Posture.LYING or (
                self.posture is Posture.SEATED and order.deed.skill is Skill.SITDOWN
            )
            if not keeps or order.deed.named:
                self._settle(order, seat)
            takes = household().takes_of(order.deed.row)
            if takes and takes.first and is_furniture(order.thing):
                self._add(f"{takes.first} the {order.thing} {_with(hand or 'right')}", "interaction", hand or "right",
                          order.thing, self.at)  # fmt: skip
                hands = None
        elif order.furniture:
            self._settle(order)
        chosen = hands if hands in (None, "both") else hand or "right"
        where = "" if order.kind == "call" and self.posture is Posture.STANDING else self.at
        told = f"{order.phrase} {_with(chosen)}" if chosen else order.phrase
        self._add(
            told, "interaction", chosen, order.thing if order.kind == "use" and order.thing else order.needs, where
        )

    # What prepares it.

    def _add(self, text: str, category: Category, hand: Hand | None = None, thing: str = "", where: str = "") -> None:
        self.steps.append(SubTask(text, category, hand, thing or None, where or None))

    def _rise(self) -> None:
        if self.posture is not Posture.STANDING:
            verb = "stand up from" if self.posture is Posture.SEATED else "get up from"
            self._add(f"{verb} the {self.at}", "locomotion", None, self.at, self.at)
            self.posture = Posture.STANDING

    def _walk(self, word: str) -> None:
        """Be beside a piece of furniture, on one's feet."""
        self._rise()
        if self.at != word:
            self._add(f"walk to the {word}", "locomotion", None, word, word)
            self.at = word

    def _settle(self, order: Order, seat: str = "") -> None:
        """Rest where it is done; where there is a table and no seat to it, stand there."""
        need, posture = ("lie", Posture.LYING) if order.deed.skill is Skill.LIEDOWN else ("sit", Posture.SEATED)
        named = order.furniture
        if order.deed.pieces == ("floor",):
            self._rise()
            self._add(f"{need} down on the floor", "locomotion")
            self.posture, self.at = posture, "floor"
            return
        if named and need in furniture.affordances(named) and furniture.class_of(named) != "table":
            word = self._named(named, need)
        elif seat and need == "sit" and not order.deed.named:
            word = seat
        else:
            word = self._first((*order.deed.pieces, *household().seats), need)
        table = self.room.find(named) if named else ""
        if table and not self.room.find(word, need):
            self._walk(table)
        elif (self.posture, self.at) != (posture, word):
            self._walk(word)
            self._add(f"{need} down on the {word}", "locomotion", None, word, word)
            self.posture = posture

    def _fetch(self, thing: str, hand: Hand | None) -> Hand:
        """Have in hand what is only to be used."""
        if thing not in self.held:
            hand = self._take(thing, hand)
            self.fetched[thing] = self.at
        return self.held[thing]

    def _take(self, thing: str, hand: Hand | None = None, where: str = "") -> Hand:
        """Have a thing in hand, and say in which."""
        if thing in self.held:
            return self.held[thing]
        options = kept_at(thing)
        here = self.posture is Posture.STANDING and self.at in options and self.room.find(self.at)
        where = where or (self.at if here else self._first(options))
        chosen = hand or self._free_hand()
        self._empty(chosen)
        self._walk(where)
        self._add(f"pick up the {thing} {_with(chosen)}", "grasp", chosen, thing, where)
        self.held[thing] = chosen
        return chosen

    def _put(self, thing: str, where: str) -> None:
        hand = self.held.pop(thing)
        self.fetched.pop(thing, None)
        self._walk(where)
        self._add(f"put down the {thing} {_with(hand)}", "grasp", hand, thing, where)

    def _free_hand(self) -> Hand:
        """A hand that holds nothing, the right one if it can be; one is emptied if need be."""
        if "both" in self.held.values() or {"left", "right"} <= set(self.held.values()):
            self._empty(next(iter(self.held.values())))
        return "left" if "right" in self.held.values() else "right"

    def _empty(self, hand: Hand) -> None:
        """Lay down what a hand holds."""
        for thing, holding in list(self.held.items()):
            if "both" in (hand, holding) or holding == hand:
                self._put(thing, self.room.find(self.at) or self._first(household().tables))

    def _first(self, options: Sequence[str], need: str = "touch") -> str:
        return self.room.first(options, need) or options[0]

    def _named(self, word: str, need: str = "touch") -> str:
        """What a piece of furniture is called here; as it was called where there is none."""
        return (self.room.find(word, need) or word.lower().replace("tv", "TV")) if word else ""


def _thing(order: Order) -> str:
    if not order.thing:
        raise TaskError(f"it does not say what to {order.verb}", "name the thing, such as a cup", at="action")
    return order.thing


def _with(hand: Hand) -> str:
    """The words for a hand at the end of a step."""
    return "with both hands" if hand == "both" else f"with the {hand} hand"
