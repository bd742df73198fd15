"""The motion planner: a Markov chain over instructions, plausible, endless and balanced (LINGO B.1.3, Figure A1).

States are what constraints speak of: where the body is, how it rests, what each hand holds. Candidates are the moves
between them. Of all chains on this graph whose motion types are equally frequent, the one of greatest entropy is taken:
with weights w of the candidates, M the weighted adjacency of states and M u = ρ u, a candidate from s to s' has the
probability w u(s') / (ρ u(s)). The weights of the types follow from minimising log ρ, which is convex.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend.motion import Posture
from motion_backend.planners.balanced_chain import Edges, balanced, recurrent
from motion_backend.rotations import Array

Category = Literal["locomotion", "grasp", "interaction"]
Hand = Literal["left", "right", "both"]
MAX_STATES: Final = 20_000
"""States a planner explores before it gives up."""


class PlanError(ValueError):
    """Candidates that make no endless plan; the text names the one that is wrong and what would be right."""


class State(NamedTuple):
    """What a body is about, as far as constraints ask."""

    posture: Posture = Posture.STANDING
    at: str = ""
    """The place it is at or rests on; "" for nowhere in particular."""
    left: str = ""
    right: str = ""
    """What each hand holds; "" for nothing."""
    just: str = ""
    """What was done last, walks apart: a thing that was taken or laid down, "rest", or a motion type."""
    walked: bool = False
    """Whether it has only just walked here."""

    @property
    def holding(self) -> frozenset[str]:
        """Everything in the hands."""
        return frozenset((self.left, self.right)) - {""}


START: Final = State()
SELDOM: Final = 0.02
"""What a move that undoes or repeats the last one weighs; others weigh 1, and all walks from a place together too."""


@dataclass(frozen=True)
class Candidate:
    """One thing that may be asked for: its properties and its constraints."""

    name: str
    """The instruction, such as "pick up the cup with the left hand"; no two have the same."""
    kind: str
    """Its motion type, as in LINGO's Table A1 where it fits: types are what is balanced."""
    category: Category
    seconds: float = 4.0
    """About how long it takes."""
    start: Posture = Posture.STANDING
    end: Posture = Posture.STANDING
    place: str = ""
    """Where it is done, or, with `goes`, where it leads; "" for anywhere."""
    goes: bool = False
    """Whether it takes the body there, rather than wanting it there."""
    hand: Hand | None = None
    """The hand that moves."""
    takes: str = ""
    """A thing that is in the hand afterwards; the hand must be free before."""
    lays: str = ""
    """A thing that the hand holds before, and lays down."""
    uses: str = ""
    """A thing that the hand holds and keeps (for "both": that either hand holds, the other free)."""

    def allowed(self, state: State) -> bool:
        """Whether a body can do it from there."""
        here = state.at != self.place if self.goes else not self.place or state.at == self.place
        return here and state.posture is self.start and self._hands_fit(state)

    def _hands_fit(self, state: State) -> bool:
        sides = ("left", "right") if self.hand == "both" else (self.hand,) if self.hand else ()
        held = [getattr(state, side) for side in sides]
        if self.lays:
            return all(thing == self.lays for thing in held)
        if self.uses:
            return self.uses in held and all(thing in ("", self.uses) for thing in held)
        return not any(held) and self.takes not in state.holding

    def undoes(self, state: State) -> bool:
        """Whether it only takes back or repeats what was just done: laying down what was not used, walk after walk."""
        return state.walked if self.goes else state.just == self._trace

    @property
    def _trace(self) -> str:
        return "rest" if self.start is not self.end else self.takes or self.lays or self.kind

    def after(self, state: State) -> State:
        """How it leaves a body that did it."""
        if self.goes:
            just = "" if state.just == "rest" else state.just
            return state._replace(posture=self.end, at=self.place, just=just, walked=True)
        state = state._replace(posture=self.end, just=self._trace, walked=False)
        if not (self.takes or self.lays):
            return state
        left = self.takes if self.hand in ("left", "both") else state.left
        right = self.takes if self.hand in ("right", "both") else state.right
        return state._replace(left=left, right=right)


def mirrored(candidate: Candidate) -> Candidate:
    """The same with the other hand (LINGO B.1.6); itself where no one hand is named."""
    if candidate.hand not in ("left", "right"):
        return candidate
    other: Hand = "right" if candidate.hand == "left" else "left"
    swapped = candidate.name.replace(f"{candidate.hand} hand", f"{other} hand")
    return replace(candidate, name=swapped, hand=other)


class Planner:
    """An endless sequence of candidates, every one possible after those before it.

    Raises PlanError where a body would come to an end, or where some candidate is never possible (again).
    """

    def __init__(self, candidates: Sequence[Candidate], seed: int = 0) -> None:
        self.candidates, self.seed = tuple(candidates), seed
        _check(self.candidates)
        self.states, moves = _explored(self.candidates)
        edges = Edges.of(moves, len(self.states), [c.kind for c in self.candidates])
        self._check_returns(edges)
        chances, flow = balanced(edges, _free_kinds(self.candidates))
        self.frequencies = {
            candidate.name: round(float(share), 6)
            for candidate, share in zip(
                self.candidates, np.bincount(edges.candidate, flow, len(self.candidates)), strict=True
            )
        }
        """The share of instructions that each candidate has in the long run, by name."""
        self._table = [_row(edges, chances, state) for state in range(len(self.states))]

    def __iter__(self) -> Iterator[Candidate]:
        """Instructions without end, from the beginning, the same for the same seed."""
        rng = np.random.default_rng(self.seed)
        state = 0
        while True:
            chosen, targets, bounds = self._table[state]
            place = int(np.searchsorted(bounds, rng.random(), side="right"))
            state = int(targets[place])
            yield self.candidates[int(chosen[place])]

    @property
    def shares(self) -> dict[str, float]:
        """The share of instructions that each motion type has in the long run."""
        found = dict[str, float]()
        for candidate in self.candidates:
            found[candidate.kind] = found.get(candidate.kind, 0.0) + self.frequencies[candidate.name]
        return {kind: round(share, 4) for kind, share in found.items()}

    def sequence(self, count: int) -> tuple[Candidate, ...]:
        """The first instructions."""
        return tuple(islice(self, count))

    def _check_returns(self, edges: Edges) -> None:
        """Every candidate must stay possible for ever, wherever the chain has gone."""
        for inside in recurrent(edges):
            usable = {int(c) for c in edges.candidate[np.isin(edges.source, inside)]}
            lost = [c.name for number, c in enumerate(self.candidates) if number not in usable]
            if lost:
                where = _told(self.states[int(inside[0])])
                raise PlanError(
                    f"candidates: once {where}, “{lost[0]}” is never possible again; "
                    "add what leads back, such as a rising, a walk or a laying down"
                )


def _check(candidates: Sequence[Candidate]) -> None:
    if not candidates:
        raise PlanError("candidates: there are none; give some, such as those of a furnished home")
    names = [candidate.name for candidate in candidates]
    if twice := next((name for number, name in enumerate(names) if name in names[:number]), None):
        raise PlanError(f"candidates: “{twice}” is there twice; give every candidate its own name")
    for candidate in candidates:
        if bool(candidate.takes) + bool(candidate.lays) + bool(candidate.uses) > 1:
            raise PlanError(f"candidates: “{candidate.name}” may take, lay down or use a thing, one of the three")
        if (candidate.takes or candidate.lays or candidate.uses) and candidate.hand is None:
            raise PlanError(f"candidates: “{candidate.name}” needs a hand: left, right or both")


Move = tuple[int, int, int, float]
"""From a state, by a candidate, to a state, and what it usually weighs."""


def _explored(candidates: Sequence[Candidate]) -> tuple[list[State], list[Move]]:
    """Every state that can be reached, the start first, and the moves between them. PlanError for a dead end."""
    states, index, way = [START], {START: 0}, {START: ""}
    moves: list[Move] = []
    met = set[int]()
    for state in states:
        possible = [number for number, candidate in enumerate(candidates) if candidate.allowed(state)]
        if not possible:
            after = f"after “{way[state]}”" if way[state] else "at the beginning"
            raise PlanError(f"candidates: nothing is possible {after}, {_told(state)}; add what can be done there")
        walks = sum(candidates[number].goes for number in possible)
        for number in possible:
            following = candidates[number].after(state)
            if following not in index:
                index[following] = len(states)
                states.append(following)
                way[following] = candidates[number].name
                if len(states) > MAX_STATES:
                    raise PlanError(f"candidates: they lead to over {MAX_STATES} states; give fewer places or things")
            usual = (1 / walks if candidates[number].goes else 1.0) * (
                SELDOM if candidates[number].undoes(state) else 1.0
            )
            moves.append((index[state], number, index[following], usual))
        met.update(possible)
    never = next((candidate for number, candidate in enumerate(candidates) if number not in met), None)
    if never is not None:
        raise PlanError(f"candidates: “{never.name}” is never possible; add what leads to {_wanted(never)}")
    return states, moves


def _free_kinds(candidates: Sequence[Candidate]) -> frozenset[str]:
    """Types that come as often as others need them: a walk is between any two things at different places."""
    return frozenset(
        candidate.kind for candidate in candidates if candidate.category == "locomotion" and candidate.goes
    )


def _row(edges: Edges, chances: Array, state: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """The candidates of a state, where they lead, and the upper bounds of their shares of [0, 1)."""
    own = np.flatnonzero(edges.source == state)
    bounds = np.cumsum(np.round(chances[own], 6))
    return edges.candidate[own], edges.target[own], bounds / bounds[-1]


def _told(state: State) -> str:
    where = f"{state.posture} {'at' if state.posture is Posture.STANDING else 'on'} the {state.at}" if state.at else ""
    holding = " and ".join(sorted(state.holding)) or "nothing"
    return f"{where or state.posture}, holding {holding}"


def _wanted(candidate: Candidate) -> str:
    thing = candidate.lays or candidate.uses
    where = f" at the {candidate.place}" if candidate.place and not candidate.goes else ""
    return f"being {candidate.start}{where}{f', holding the {thing}' if thing else ''}"
