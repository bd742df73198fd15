"""What each kind of room is furnished with, in the order it is put in; shares follow real rooms (scene-formats 2.4).

A recipe says what falls to a room; where it goes is tried until all of it fits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from scene_graphs.data_tables import read_table, require_known, table
from scene_graphs.furniture import catalogue
from scene_graphs.generation import furniture_groups
from scene_graphs.generation.furniture_placement import Arrangement, Group, Item
from scene_graphs.generation.random_choices import Luck, size_of

Step = Callable[[Arrangement], bool]
"""Puts something into a room; False if it found no place."""
Build = Callable[[np.random.Generator], Group]
NOTHING = "nothing"
"""A choice that puts nothing in."""


@table
class Extra:
    """What stands in some rooms beside the main piece: one piece by itself, or a group of pieces."""

    share: float
    """Of the rooms that have it."""
    piece: str = ""
    front_m: float = 0.6
    """Floor that is kept free before the piece."""
    in_corner: bool = False
    """Whether the piece stands in a corner where one is free."""
    group: Literal["", "work place", "dressing place", "watching place", "reading place", "sofa corner"] = ""
    seat: str = ""
    """Of a group: a category, or the choice among some."""
    lamp: str = ""
    """Of a group: the detail that it is."""
    table: str = ""
    """Of a group: the detail that it is, or the choice among some."""

    def __post_init__(self) -> None:
        if bool(self.piece) == bool(self.group):
            raise ValueError("it is either a piece or a group")
        require_known("piece", [self.piece] if self.piece else [], catalogue().categories)


@table
class Recipe:
    """What a kind of room is furnished with."""

    floor_m2: float
    """Of a room with the least in it."""
    floor_per_extra_m2: float
    l_shaped_share: float
    """Share of rooms with six corners instead of four."""
    ceiling_lamp_share: float
    """Share of the rooms without a lamp over a table that have one under the ceiling."""
    oversampled_shares: dict[str, float]
    """Share of rooms with what stories ask for more often than real rooms have it. Studies are a quarter of all
    rooms."""
    shares: dict[str, float]
    """Of the rooms that have a detail of a group."""
    choices: dict[str, dict[str, float]]
    """What is one of several, with their shares."""
    extras: dict[str, Extra]

    def __post_init__(self) -> None:
        extras = {f"extras.{name}": extra.share for name, extra in self.extras.items()}
        choices = {f"choices.{name}.{one}": part for name, parts in self.choices.items() for one, part in parts.items()}
        for place, share in {**self.oversampled_shares, **self.shares, **extras, **choices}.items():
            if not 0 < share <= 1:
                raise ValueError(f"{place}: {share} is no share")
        for name, extra in self.extras.items():
            if self.oversampled_shares.get(name, extra.share) != extra.share:
                raise ValueError(f"extras.{name}.share: {extra.share} is not what oversampled_shares says")
            named = [word for word in (extra.seat, extra.lamp, extra.table) if word]
            require_known(f"extras.{name}", named, {*catalogue().categories, *self.choices, *self.shares})
        for name, parts in self.choices.items():
            if abs(sum(parts.values()) - 1) > 1e-9:
                raise ValueError(f"choices.{name}: the shares add up to {sum(parts.values()):g}, not to 1")


@table
class Recipes:
    """By kind of room."""

    bedroom: Recipe
    living_room: Recipe
    living_dining: Recipe
    dining_room: Recipe
    kitchen_diner: Recipe
    study: Recipe


def recipe_of(kind: str) -> Recipe:
    """What a kind of room is furnished with, from data/room_recipes.toml."""
    recipe: Recipe = getattr(read_table("scene_graphs", "room_recipes.toml", Recipes), kind)
    return recipe


@dataclass(frozen=True)
class Fate:
    """What falls to one room."""

    luck: Luck
    recipe: Recipe

    def has(self, word: str) -> bool:
        """Whether it has a detail."""
        return self.luck.has(word, self.recipe.shares[word])

    def choose(self, word: str) -> str:
        """What it has of several, "" for nothing."""
        chosen = self.luck.choose(word, self.recipe.choices[word])
        return "" if chosen == NOTHING else chosen

    def extras(self, *without: str) -> list[Step]:
        """The steps of what it has beside the main piece."""
        extras = self.recipe.extras.items()
        return [self.step(word) for word, extra in extras if word not in without and self.luck.has(word, extra.share)]

    def step(self, word: str) -> Step:
        """How an extra is put into a room."""
        extra = self.recipe.extras[word]
        if extra.piece:
            return in_corner(extra.piece) if extra.in_corner else alone(extra.piece, extra.front_m)
        seat = self.choose(extra.seat) if extra.seat in self.recipe.choices else extra.seat
        lamp = bool(extra.lamp) and self.has(extra.lamp)
        match extra.group:
            case "work place":
                return at_wall(lambda rng: furniture_groups.work_place(rng, seat, lamp))
            case "dressing place":
                return at_wall(lambda rng: furniture_groups.dressing_place(rng, seat))
            case "reading place":
                small = self.choose(extra.table) if extra.table else ""
                return at_wall(lambda rng: furniture_groups.reading_place(rng, seat, lamp, small or None))
            case "sofa corner":
                table = self.has(extra.table)
                return at_wall(lambda rng: furniture_groups.sofa_corner(rng, seat, table))
            case _:
                return at_wall(furniture_groups.watching_place)


def at_wall(build: Build, tries: int = 8) -> Step:
    """Puts a group somewhere along a wall."""
    return lambda room: room.against_wall(build(room.rng), tries=tries) is not None


def alone(category: str, front: float = 0.6) -> Step:
    """Puts a piece by itself along a wall, with that much floor before it."""
    return at_wall(lambda rng: furniture_groups.standing_alone(rng, category, front))


def in_corner(category: str) -> Step:
    """Puts a piece in a corner of the room, or where there is none free at a wall."""

    def put(room: Arrangement) -> bool:
        size = size_of(room.rng, category)
        group = Group((Item(category, 0.0, size[2] / 2 + 0.05, size),))
        corners = [1, -1] if room.rng.random() < 0.5 else [-1, 1]
        return any(room.against_wall(group, corner=corner, tries=4) is not None for corner in [*corners, 0])

    return put


def furnished(luck: Luck) -> list[Step]:
    """The steps that furnish the room with that luck, in order."""
    fate = Fate(luck, recipe_of(luck.kind))
    match luck.kind:
        case "bedroom":
            return [_bed(fate), *fate.extras()]
        case "study":
            return _study(fate)
        case "dining_room":
            return [_dining(fate, spread=0.25), *fate.extras()]
        case "kitchen_diner":
            return [_kitchen(fate), _dining(fate), *fate.extras()]
        case "living_dining":
            return [_lounge(fate), _dining(fate), *fate.extras()]
        case _:
            eats = [_dining(fate)] if fate.choose("dining seats") else []
            return [_lounge(fate), *eats, *fate.extras()]


def _study(fate: Fate) -> list[Step]:
    """A desk with its chair and books, or books and a place to read them; often somewhere softer to sit."""
    seat, lamp, is_grand = fate.choose("desk seat"), fate.has("desk lamp"), fate.has("grand desk")
    if not fate.has("desk"):
        return [alone("bookshelf"), fate.step("reading place"), *fate.extras("reading place")]

    def work(room: Arrangement) -> bool:
        if is_grand and room.against_wall(furniture_groups.free_desk(room.rng, seat, lamp), tries=6) is not None:
            return True
        return room.against_wall(furniture_groups.work_place(room.rng, seat, lamp)) is not None

    return [work, *fate.extras()]


def _bed(fate: Fate) -> Step:
    """A double bed free at both sides, a narrow one with its far side in a corner, or a sofa to sleep on."""
    category, oversampled = fate.choose("bed"), fate.recipe.oversampled_shares
    # A sofa bed has none, so that the others have a little more.
    others = 1 - fate.recipe.choices["bed"]["sofa_bed"]
    stands = int(fate.luck.has("nightstand", oversampled["nightstand"] / others))
    lamps = fate.has("bedside lamps")
    if category == "sofa_bed":
        return at_wall(furniture_groups.sofa_bed, 12)
    if category == "double_bed":
        stands *= 1 + int(fate.has("second nightstand"))

        def wide(room: Arrangement) -> bool:
            sides = (-1, 1) if room.rng.random() < 0.5 else (1, -1)
            return room.against_wall(furniture_groups.bed(room.rng, category, sides, stands, lamps)) is not None

        return wide

    def narrow(room: Arrangement) -> bool:
        side = 1 if room.rng.random() < 0.5 else -1
        return (
            room.against_wall(furniture_groups.bed(room.rng, category, (side,), stands, lamps), corner=-side)
            is not None
        )

    return narrow


def _lounge(fate: Fate) -> Step:
    """A sofa before a tv or at a wall, or two armchairs; a coffee table before them."""
    sofa, tv = fate.choose("sofa"), fate.has("tv stand")
    table = fate.luck.has("coffee table", fate.recipe.oversampled_shares["coffee_table"])
    seats = (fate.choose("lounge seat"),) * (int(fate.has("lounge seats")) * (1 + int(fate.has("two of them"))))
    end = fate.choose("sofa end")

    def before_tv(room: Arrangement) -> bool:
        for side in (int(index) for index in room.rng.permutation(len(room.shell.sides))):
            group = furniture_groups.lounge(room.rng, room.shell.sides[side].reach, sofa, seats, table)
            if group is not None and room.against_wall(group, [side], tries=6) is not None:
                return True
        return False

    def at_a_wall(room: Arrangement) -> bool:
        against = "multi_seat_sofa" if sofa == "l_shaped_sofa" else sofa
        return room.against_wall(furniture_groups.sofa_corner(room.rng, against, table, end or None)) is not None

    if sofa == "armchairs":
        return at_wall(furniture_groups.two_armchairs, 12)
    return before_tv if tv else at_a_wall


def _kitchen(fate: Fate) -> Step:
    """A line of kitchen furniture from a corner on along one wall or both; one that fits no corner stands elsewhere."""
    goes_round = fate.choose("kitchen") == "round a corner"
    microwave, dishwasher = fate.has("microwave"), fate.has("dishwasher")

    def put(room: Arrangement) -> bool:
        corners = [1, -1] if room.rng.random() < 0.5 else [-1, 1]
        for corner in corners if goes_round else [*corners, 0]:
            group = furniture_groups.kitchen(room.rng, corner or 1, goes_round, microwave, dishwasher)
            if room.against_wall(group, corner=corner) is not None:
                return True
        return False

    return put


def _dining(fate: Fate, spread: float = 0.85) -> Step:
    """A table with chairs or benches in the room, perhaps under a lamp."""
    chosen = fate.choose("dining seats")
    lamp = "lamp over the table" in fate.recipe.shares and fate.has("lamp over the table")

    def put(room: Arrangement) -> bool:
        rng = room.rng
        on_benches = chosen == "benches"
        group = furniture_groups.dining_on_benches(rng) if on_benches else furniture_groups.dining(rng, int(chosen))
        if not room.in_the_room(group, spread, tries=60):
            return False
        table = next(placed for placed in room.placed if placed.category == "dining_table")
        if lamp:
            size = size_of(rng, "pendant_lamp")
            hung = Item("pendant_lamp", 0.0, 0.0, size, 0.0, room.shell.height - size[1])
            room.add(hung, (table.position[0], table.position[2]), table.yaw)
        return True

    return put
