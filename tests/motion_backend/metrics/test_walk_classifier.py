"""The judge of walks: blind to place and heading, fair to equals, sure of what differs, and never asked what it saw."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from motion_backend import rotations
from motion_backend.metrics import walk_classifier
from motion_backend.metrics.walk_classifier import auc, halves, people_apart, told_apart
from motion_backend.metrics.walk_seconds import LIMBS, Seconds, seconds_of
from motion_backend.metrics.walk_traits import give_aways, traits
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS, build_skeleton

FPS = 30
PEOPLE = tuple("abcde")


def strolled(rng: np.random.Generator, swing: float) -> Array:
    """A figure that swings its arms over two seconds of straight walking, differently each time. (61, 22, 3)."""
    times = np.arange(2 * FPS + 1) / FPS
    joints = np.tile(build_skeleton().rest_positions, (len(times), 1, 1))
    joints += 0.02 * rng.standard_normal((1, len(JOINTS), 3))
    joints[..., 2] += rng.uniform(0.9, 1.3) * times[:, None]
    beat = np.sin(2 * np.pi * (times + rng.uniform()))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        joints[:, INDEX[f"{side}_wrist"], 2] += sign * swing * beat
        joints[:, INDEX[f"{side}_knee"], 2] -= sign * 0.15 * beat
        joints[:, INDEX[f"{side}_ankle"], 2] -= sign * 0.25 * beat
    return joints


@cache
def people(seed: int = 0, names: tuple[str, ...] = PEOPLE) -> Seconds:
    rng = np.random.default_rng(seed)
    takes = [(name, f"{name} {take}") for name in names for take in range(8)]
    return seconds_of([(name, take, strolled(rng, 0.2)) for name, take in takes], FPS)


@cache
def made(swing: float) -> Seconds:
    rng = np.random.default_rng(7)
    return seconds_of([("made", f"seed {seed}", strolled(rng, swing)) for seed in range(24)], FPS)


def test_a_body_like_people_is_not_told_from_them() -> None:
    found = told_apart(people(), made(0.2))
    assert 0.35 < found.auc < 0.65
    assert set(found.by_person) == set(PEOPLE)
    assert found.low <= found.auc <= found.high


def test_a_body_with_one_limb_moved_otherwise_is_told_and_by_that_limb_alone() -> None:
    body = made(0.2)
    shifted = body.joints.copy()
    shifted[:, :, [INDEX["left_wrist"], INDEX["left_elbow"]], 0] += 0.1
    other = Seconds(shifted, body.people, body.takes)
    assert told_apart(people(), other, "arms").auc > 0.95
    assert 0.3 < told_apart(people(), other, "trunk and head").auc < 0.7


def test_people_who_are_alike_are_not_told_from_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(walk_classifier, "TEAMS", 2)
    found = people_apart(people(names=("a", "b", "c")))
    assert 0.3 < found.teams < 0.7
    assert set(found.alone) == {"a", "b", "c"}


def test_the_same_windows_and_seed_give_the_same_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(walk_classifier, "STEPS", 20)
    assert told_apart(people(), made(0.2), "feet") == told_apart(people(), made(0.2), "feet")


def test_nobody_is_asked_about_whom_the_network_has_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    body, known = made(0.3), people()
    rows = {window.tobytes(): name for window, name in zip(known.features(), known.people.tolist(), strict=True)}
    rows |= {window.tobytes(): take for window, take in zip(body.features(), body.takes.tolist(), strict=True)}
    asked: list[str] = []

    def learned(shown: Array, names: Array, ours: Array, *_: object) -> object:
        seen = {rows[window.tobytes()] for window in (*shown, *ours)}
        assert set(names) < seen

        def score(windows: Array) -> Array:
            unseen = {rows[window.tobytes()] for window in windows}
            assert seen.isdisjoint(unseen)
            asked.extend(unseen)
            return np.zeros(len(windows))

        return score

    monkeypatch.setattr(walk_classifier, "_learned", learned)
    assert told_apart(known, body).auc == 0.5
    assert set(asked) == set(PEOPLE) | set(body.takes.tolist())


def test_halves_keep_takes_whole_and_cut_a_single_one_in_time() -> None:
    body = people()
    half = halves(body)
    for take in set(body.takes.tolist()):
        assert len(set(half[body.takes == take].tolist())) == 1
    for name in PEOPLE:
        assert 0.3 < half[body.people == name].mean() < 0.7
    both = body[np.isin(body.takes, ["a 0", "a 1"])]
    assert {take: set(halves(both)[both.takes == take].tolist()) for take in ("a 0", "a 1")} in (
        {"a 0": {True}, "a 1": {False}},
        {"a 0": {False}, "a 1": {True}},
    )
    single = halves(body[body.takes == "a 0"])
    assert single.tolist() == sorted(single.tolist(), reverse=True)
    assert single.any()
    assert not single.all()


def test_windows_do_not_say_where_a_walk_is_nor_where_it_leads_to() -> None:
    walk = strolled(np.random.default_rng(1), 0.2)
    turn = rotations.axis_to_quat("y", np.array(2.1))
    elsewhere = rotations.rotate(turn, walk) + np.array([3.0, 0.0, -5.0])
    here, there = (seconds_of([("a", "a", joints)], FPS) for joints in (walk, elsewhere))
    assert len(here) == 3
    np.testing.assert_allclose(here.features(), there.features(), atol=1e-9)
    for name, values in traits(here.joints).items():
        np.testing.assert_allclose(values, traits(there.joints)[name], atol=1e-6, err_msg=name)


def test_a_limb_alone_sees_its_own_joints() -> None:
    seconds = people()
    moved = seconds.joints.copy()
    moved[:, :, INDEX["head"]] += 0.3
    other = Seconds(moved, seconds.people, seconds.takes)
    for limb, joints in LIMBS.items():
        same = np.array_equal(seconds.features(limb), other.features(limb))
        assert same == ("head" not in joints), limb


def test_what_was_changed_is_what_gives_a_body_away() -> None:
    body = made(0.2)
    lifted = body.joints.copy()
    lifted[:, :, INDEX["left_shoulder"], 1] += 0.05 * np.sin(np.linspace(0, 6, FPS))
    found = give_aways(people(), Seconds(lifted, body.people, body.takes))
    assert found[0].name == "shoulder roll, °: movement"
    assert found[0].auc > 0.95
    assert found[0].ours[0] > found[0].people[0]
    assert [one.auc for one in found] == sorted((one.auc for one in found), reverse=True)


def test_ties_count_half_in_the_area_under_the_curve() -> None:
    assert auc(np.array([0.0, 1.0]), np.array([1.0, 2.0])) == 0.875
    assert auc(np.array([3.0]), np.array([1.0])) == 0.0
