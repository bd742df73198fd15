"""The motion planner: constraints hold for ever, motion types are balanced, and what cannot go on is refused."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import islice, pairwise

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from small_home import small_home

from motion_backend.motion import Posture
from motion_backend.planners.balanced_chain import Edges, balanced
from motion_backend.planners.markov_planner import Candidate, PlanError, Planner, mirrored
from motion_backend.planners.motion_candidates import candidates_from_home

STANDING, SEATED = Posture.STANDING, Posture.SEATED
TOLERANCE = 0.12
"""How far a type's number in 20,000 instructions may be from that of others, as a share of it."""


def walk(place: str) -> Candidate:
    return Candidate(f"walk to the {place}", "walk forward", "locomotion", place=place, goes=True)


def rests(place: str) -> list[Candidate]:
    return [
        Candidate(f"sit down on the {place}", "sit down", "locomotion", end=SEATED, place=place),
        Candidate(f"stand up from the {place}", "stand up", "locomotion", start=SEATED, place=place),
    ]


def thing(name: str, place: str, use: str, both: bool = False) -> list[Candidate]:
    right = [
        Candidate(f"pick up the {name} with the right hand", "pick up", "grasp", place=place, hand="right", takes=name),
        Candidate(
            f"put down the {name} with the right hand", "put down", "grasp", place=place, hand="right", lays=name
        ),
    ]
    hand = "both hands" if both else "the right hand"
    used = Candidate(f"{use} with {hand}", use, "interaction", start=SEATED, end=SEATED, uses=name,
                     hand="both" if both else "right")  # fmt: skip
    return list(dict.fromkeys([*right, used, *map(mirrored, [*right, used])]))


HOME = [
    *map(walk, ("sofa", "chair", "table", "shelf")), *rests("sofa"), *rests("chair"),
    *thing("cup", "table", "drink"), *thing("book", "shelf", "read", both=True),
]  # fmt: skip


def follow(sequence: list[Candidate]) -> None:
    """Act instructions out with a plain record of the body, and assert that each is possible when it comes."""
    at, posture, hands = "", STANDING, {"left": "", "right": ""}
    for candidate in sequence:
        assert posture is candidate.start, candidate.name
        if candidate.goes:
            assert posture is STANDING
            at = candidate.place
        assert candidate.place in ("", at), candidate.name
        mine = {"both": ("left", "right"), None: ()}.get(candidate.hand, (candidate.hand,))
        held = [hands[str(side)] for side in mine]
        if candidate.lays:
            assert set(held) == {candidate.lays}, candidate.name
        elif candidate.uses:
            assert candidate.uses in held, candidate.name
            assert set(held) <= {"", candidate.uses}, candidate.name
        else:
            assert not any(held), candidate.name
        if candidate.takes or candidate.lays:
            assert candidate.takes not in (*hands.values(),) or not candidate.takes, candidate.name
            hands |= dict.fromkeys(map(str, mine), candidate.takes)
        posture = candidate.end


@tries(8)
@given(st.sets(st.sampled_from(range(len(HOME)))), st.integers(0, 2**32))
def test_whatever_is_left_out_a_plan_is_refused_or_every_instruction_is_possible(left_out: set[int], seed: int) -> None:
    # Few are left out, or hardly anything could be planned.
    kept = [candidate for number, candidate in enumerate(HOME) if number not in set(sorted(left_out)[:3])]
    try:
        follow(list(Planner(kept, seed).sequence(300)))
    except PlanError as error:
        refused = str(error)
    else:
        return
    assert any(candidate.name in refused for candidate in kept) or "at the beginning" in refused


@pytest.fixture(scope="module")
def planner() -> Planner:
    return Planner(HOME, 7)


@pytest.fixture(scope="module")
def long_plan(planner: Planner) -> tuple[Candidate, ...]:
    return planner.sequence(20_000)


def test_a_long_plan_is_possible_to_its_end(long_plan: tuple[Candidate, ...]) -> None:
    follow(list(long_plan))


def test_motion_types_are_balanced_and_walks_come_more_often(
    planner: Planner, long_plan: tuple[Candidate, ...]
) -> None:
    tied = [share for kind, share in planner.shares.items() if kind != "walk forward"]
    assert max(tied) - min(tied) <= 0.01 * max(tied)
    assert planner.shares["walk forward"] > max(tied)
    counts = Counter(candidate.kind for candidate in long_plan)
    usual = np.mean([counts[kind] for kind in planner.shares if kind != "walk forward"])
    for kind, share in planner.shares.items():
        assert counts[kind] == pytest.approx(20_000 * share, rel=TOLERANCE), kind
        assert kind == "walk forward" or counts[kind] == pytest.approx(usual, rel=TOLERANCE), kind


def test_a_candidate_and_its_mirror_image_come_equally_often(
    planner: Planner, long_plan: tuple[Candidate, ...]
) -> None:
    counts = Counter(long_plan)
    pairs = [(one, mirrored(one)) for one in HOME if one.hand == "right"]
    assert len(pairs) == 5
    for one, other in pairs:
        assert mirrored(other) == one
        assert (other.hand, other.name) == ("left", one.name.replace("right hand", "left hand"))
        assert planner.frequencies[one.name] == pytest.approx(planner.frequencies[other.name], rel=1e-3)
        assert counts[one] == pytest.approx(counts[other], rel=2 * TOLERANCE), one.name


def test_walks_hardly_ever_follow_walks_and_nothing_is_undone_at_once(long_plan: tuple[Candidate, ...]) -> None:
    twice = sum(one.goes and other.goes for one, other in pairwise(long_plan))
    undone = sum(bool(one.takes) and one.takes == other.lays for one, other in pairwise(long_plan))
    up_at_once = sum(one.kind == "sit down" and other.kind == "stand up" for one, other in pairwise(long_plan))
    assert max(twice, undone, up_at_once) < 0.02 * len(long_plan)


def test_the_same_seed_gives_the_same_endless_plan_and_another_seed_another(planner: Planner) -> None:
    again = Planner(HOME, 7)
    assert list(islice(again, 500)) == list(planner.sequence(500))
    assert len({Planner(HOME, seed).sequence(40) for seed in (8,)} | {again.sequence(40)}) == 2


@for_each(
    ("candidates", "fault"),
    [
        ([], "there are none"),
        ([walk("sofa"), walk("sofa")], "“walk to the sofa” is there twice"),
        ([walk("sofa")], "nothing is possible after “walk to the sofa”, standing at the sofa, holding nothing"),
        ([walk("sofa"), walk("table"), rests("sofa")[0]], "nothing is possible after “sit down on the sofa”"),
        (rests("sofa"), "nothing is possible at the beginning"),
        ([walk("a"), walk("b"), rests("sofa")[0]], "“sit down on the sofa” is never possible; .*being standing at"),
        ([walk("a"), walk("b"), *thing("cup", "a", "drink")[1:2]], "never possible; .*holding the cup"),
        ([walk("a"), walk("b"), *thing("cup", "a", "drink")[:1]], "once .*“pick up the cup .*is never possible again"),
        ([replace(thing("cup", "a", "drink")[0], hand=None)], "needs a hand: left, right or both"),
        ([replace(thing("cup", "a", "drink")[0], uses="cup")], "one of the three"),
    ],
)  # fmt: skip
def test_what_cannot_go_on_for_ever_is_refused_by_name(candidates: list[Candidate], fault: str) -> None:
    with pytest.raises(PlanError, match=rf"candidates: .*{fault}"):
        Planner(candidates)


@tries(12)
@given(st.integers(2, 7), st.integers(0, 10_000))
def test_the_chain_of_any_connected_graph_has_the_shares_it_claims(states: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ring = [(s, s, (s + 1) % states, 1.0) for s in range(states)]
    more = [(int(s), states + n, int(t), 1.0) for n, (s, t) in enumerate(rng.integers(0, states, (2 * states, 2)))]
    kinds = [str(kind) for kind in rng.integers(0, 3, 3 * states)]
    edges = Edges.of(ring + more, states, kinds)
    chances, claimed = balanced(edges, {"0"})
    assert np.bincount(edges.source, chances, states) == pytest.approx(1.0)
    steps = edges.matrix(chances).toarray()
    system = np.concatenate([steps.T - np.eye(states), np.ones((1, states))])
    stationary = np.linalg.lstsq(system, np.append(np.zeros(states), 1.0), rcond=None)[0]
    assert stationary[edges.source] * chances == pytest.approx(claimed, abs=1e-6)


def test_a_furnished_home_gives_candidates_of_many_types_that_make_a_plan() -> None:
    candidates = candidates_from_home(small_home())
    kinds = {candidate.kind for candidate in candidates}
    wanted = {"walk forward", "sit down", "stand up", "lie down", "get up", "pick up", "put down", "drink", "read"}
    assert wanted <= kinds
    assert {candidate.place for candidate in candidates if candidate.goes} >= {
        "dining table",
        "bookshelf",
        "double bed",
    }
    planner = Planner(candidates, 1)
    follow(list(planner.sequence(2000)))
    tied = [share for kind, share in planner.shares.items() if kind != "walk forward"]
    assert max(tied) - min(tied) <= 0.01 * max(tied)


def test_what_no_body_gets_to_is_not_planned() -> None:
    home = small_home()
    usable = {placed.id: frozenset({"touch"}) for placed in home.objects}
    candidates = candidates_from_home(home, usable)
    assert {candidate.end for candidate in candidates} == {STANDING}
    assert not {"drink", "read"} & {candidate.kind for candidate in candidates}
