"""How people sit down, sit and stand up, whatever the seat, the home, the caption and the mood."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
from acted import HOMES, Body, risen_from, sat
from layers import sampled

from motion_backend.body.joint_limits import limits_share
from motion_backend.body.self_collision import self_penetration
from motion_backend.metrics.balance_figures import outside_soles, rising_frames
from motion_backend.motion import FPS, PhaseKind
from motion_backend.skeleton import SEATED_REST

UPRIGHT = ("sitting still", "crossing arms", "hands on thighs")
BENT = ("leaning forward, elbows on knees", "supporting head with hands, head bowed")
SEATS = [("chair", "small"), ("sofa", "small"), ("bed", "small"), ("chair", "hall"), ("sofa", "hall")]
SIDES = ("left", "right")
Name = tuple[str, ...]


def sittings(captions: tuple[str, ...] = (*UPRIGHT, *BENT)) -> list[tuple[Name, Body]]:
    """Every seat with every caption."""
    return [
        ((seat, home, caption), sat(seat, caption, home=home))
        for (seat, home), caption in product(SEATS, captions)
        if caption in UPRIGHT[:1] or home == "small"
    ]


def risings() -> list[tuple[Name, Body]]:
    """From every seat, and at two paces from one."""
    found = [((seat, home), risen_from(seat, "stand up", home=home)) for seat, home in SEATS]
    return [*found, *((("chair", words), risen_from("chair", words)) for words in ("stand up abruptly",))]


def failures(found: Sequence[tuple[Name, object, object]]) -> list[tuple[Name, object]]:
    """What is not so, with its figure."""
    return [(name, figure) for name, fine, figure in found if not fine]


def on_seat(body: Body) -> int:
    """The first frame in which the seat bears the body."""
    height = body.at("pelvis")[:, 1]
    down = body.phase(PhaseKind.SITDOWN).start
    return down + int(np.argmax(height[down:] < height[-1] + 0.02))


def test_the_trunk_folds_over_the_feet_before_the_seat_is_touched_and_unfolds_on_it() -> None:
    found = []
    for name, body in sittings(UPRIGHT):
        lean, seat = body.lean(body.facing), on_seat(body)
        start = body.phase(PhaseKind.SITDOWN).start
        folded = start + int(lean[start : seat + 1].argmax())
        figure = lean[folded], folded - start, seat - start, lean[-1]
        found.append((name, 20 < lean[folded] < 50 and folded < seat and abs(lean[-1]) < 12, figure))
        found.append(((*name, "at first"), lean[start] < 8, lean[start]))
    assert failures(found) == []


def test_hips_fold_as_one_sits_down_and_stay_folded() -> None:
    found = []
    for name, body in sittings(UPRIGHT):
        for side in SIDES:
            hip, knee = body.hip(side), body.knee(side)
            start, seat = body.phase(PhaseKind.SITDOWN).start, on_seat(body)
            found.append(((*name, side, "standing"), hip[start] < 20, hip[start]))
            found.append(((*name, side, "going down"), 85 < hip[start:seat].max() < 125, hip[start:seat].max()))
            found.append(((*name, side, "seated"), 65 < hip[-FPS:].min() <= hip[-FPS:].max() < 110, hip[-FPS:].mean()))
            found.append(((*name, side, "knee"), 60 < knee[-FPS:].min() <= knee[-FPS:].max() < 115, knee[-FPS:].mean()))
    assert failures(found) == []


def test_who_leans_forward_folds_hips_and_back_further() -> None:
    for (seat, home), caption in product(SEATS[:3], BENT):
        upright, bent = sat(seat, UPRIGHT[0], home=home), sat(seat, caption, home=home)
        assert bent.lean(bent.facing)[-1] > upright.lean(upright.facing)[-1] + 25
        assert bent.hip("left")[-1] > upright.hip("left")[-1] + 20


def test_who_leans_back_leans_on_the_backrest() -> None:
    sofa = sat("sofa", "hands behind head, lean back")
    assert -30 < sofa.lean(sofa.facing)[-1] < -8


def test_the_pelvis_rests_on_the_seat_where_the_spot_is() -> None:
    found = []
    for name, body in sittings():
        assert body.action.spot is not None
        off = body.at("pelvis")[-FPS:] - np.asarray(body.action.spot.point)
        found.append((name, np.abs(off[:, 1] - SEATED_REST).max() < 0.02, off[-1, 1]))
        found.append(((*name, "place"), np.linalg.norm(off[:, [0, 2]], axis=1).max() < 0.05, off[-1]))
    assert failures(found) == []


def test_the_body_faces_away_from_the_backrest() -> None:
    found = []
    for name, body in sittings():
        front = body.axis("pelvis", (0.0, 0.0, 1.0))[-FPS:] * [1.0, 0.0, 1.0]
        along = (front @ body.facing / np.linalg.norm(front, axis=1)).min()
        found.append((name, along > 0.97, along))
        assert body.action.object_id is not None
        piece = HOMES[name[1]].object(body.action.object_id)
        if name[0] in ("chair", "sofa"):
            # A piece's own front is its +Z; what one leans on stands behind.
            ahead = np.array([np.sin(piece.yaw), 0.0, np.cos(piece.yaw)])
            knees = (body.at("left_knee") + body.at("right_knee") - 2 * body.at("pelvis"))[-1]
            found.append(((*name, "knees"), knees @ ahead > 0.4, knees @ ahead))
    assert failures(found) == []


def test_a_seated_body_is_as_broad_as_it_is_and_its_feet_stand_before_the_seat() -> None:
    found = []
    for name, body in sittings(UPRIGHT):
        left = np.array([body.facing[2], 0.0, -body.facing[0]])
        for side, sign in (("left", 1), ("right", -1)):
            foot = (body.at(f"{side}_ankle") - body.at("pelvis"))[-1]
            found.append(((*name, side), 0.0 < sign * (foot @ left) < 0.3, foot @ left))
            found.append(((*name, side, "ahead"), 0.2 < foot @ body.facing < 0.65, foot @ body.facing))
            low = body.kinematics.soles[-FPS:, SIDES.index(side), :, 1]
            found.append(((*name, side, "floor"), -0.01 < low.min() <= low.max() < 0.02, low.max()))
    assert failures(found) == []


def test_feet_stay_where_they_stand_while_one_goes_down_and_comes_up() -> None:
    found = []
    for name, body in [*sittings(UPRIGHT[:1]), *risings()]:
        for foot, side in enumerate(SIDES):
            standing = body.planted[1:, foot] & body.planted[:-1, foot]
            step = np.linalg.norm(np.diff(body.at(f"{side}_foot")[:, [0, 2]], axis=0), axis=1)[standing]
            found.append(((*name, side), standing.mean() > 0.15 and step.max() < 0.02, (standing.mean(), step.max())))
    assert failures(found) == []


def test_the_trunk_folds_before_the_seat_is_left() -> None:
    found = []
    for name, body in risings():
        height, front = body.at("pelvis")[:, 1], body.facing
        off = int(np.argmax(height > height[0] + 0.03))
        lean = body.lean(front)
        found.append((name, lean[off] > 18 and lean[: off + 1].max() > 20, (lean[off], off)))
        # What bears the body after the seat are the feet: the head is over them by then.
        over = ((body.at("head") - (body.at("left_ankle") + body.at("right_ankle")) / 2) @ front)[off]
        found.append(((*name, "head"), -0.12 < over < 0.3, over))
        found.append(((*name, "hips"), body.hip("left")[off] > 90, body.hip("left")[off]))
        found.append(((*name, "upright"), abs(lean[-1]) < 8 and body.hip("left")[-1] < 20, lean[-1]))
        found.append(((*name, "height"), height[-1] > 0.95 * body.motion.skeleton.standing_height, height[-1]))
    assert failures(found) == []


def test_a_body_goes_down_once_and_comes_up_once() -> None:
    found = []
    for name, body in [*sittings(UPRIGHT[:1]), *risings()]:
        height = body.at("pelvis")[:, 1]
        way = np.abs(np.diff(height)).sum() / abs(height[-1] - height[0])
        found.append((name, way < 1.25, way))
        drop = np.abs(np.diff(height)).max() * FPS
        found.append(((*name, "speed"), 0.25 < drop < 1.6, drop))
    assert failures(found) == []


def test_who_rises_from_the_floor_is_over_the_feet_first() -> None:
    body = risen_from("floor", "stand up")
    outside = outside_soles(body.kinematics)[rising_frames(body.kinematics)]
    assert outside.mean() < 0.03
    assert limits_share(body.motion.local_rotations) == 0.0


@pytest.mark.parametrize("seed", sampled([3, 4], 2))
def test_the_sad_sit_down_more_slowly_and_more_bent_than_the_happy(seed: int) -> None:
    seconds, height, nod = {}, {}, {}
    for mood in ("happy", "neutral", "sad"):
        body = sat("chair", "sitting still", mood, seed=seed)
        seconds[mood] = on_seat(body) - body.phase(PhaseKind.SITDOWN).start
        height[mood] = (body.at("head") - body.at("pelvis"))[-1, 1]
        nod[mood] = body.axis("head", (0.0, 0.0, 1.0))[-FPS:, 1].mean()
    assert seconds["happy"] < seconds["neutral"] < seconds["sad"]
    assert height["happy"] > height["sad"]
    assert nod["happy"] > nod["neutral"] > nod["sad"]


def test_a_held_pose_breathes_and_no_more() -> None:
    for seat, home in SEATS:
        held = sat(seat, UPRIGHT[0], home=home).kinematics.positions[-FPS:]
        assert 1e-5 < np.ptp(held, axis=0).max() < 0.04


@pytest.mark.parametrize("every", sampled([2, 1], 2))
def test_on_the_floor_knees_are_drawn_up_and_who_does_something_sits_tailorwise(every: int) -> None:
    drawn_up = ("hands on knees", "arms crossed", "playing music")
    tailorwise = ("eating", "hands on thighs", "reading a book", "cross-legged, hands on knees")
    for caption in (*drawn_up, *tailorwise)[::every]:
        crossed = caption in tailorwise
        body = sat("floor", caption)
        left = np.array([body.facing[2], 0.0, -body.facing[0]])
        apart = (body.at("left_ankle") - body.at("right_ankle"))[-1] @ left
        assert (apart < 0) == crossed, caption
        assert (body.at("left_knee")[-1, 1] > 0.33) == (not crossed), caption
        assert 80 < body.knee("left")[-1] < 150, caption
        assert 0.05 < body.at("pelvis")[-1, 1] < 0.12, caption


def test_hands_on_thighs_lie_on_them_half_way_with_bent_elbows() -> None:
    for seat, home in SEATS[:3]:
        body = sat(seat, "hands on thighs", home=home)
        for side in SIDES:
            hip, knee, wrist = (body.at(f"{side}_{joint}")[-1] for joint in ("hip", "knee", "wrist"))
            share = (wrist - hip) @ (knee - hip) / ((knee - hip) @ (knee - hip))
            assert 0.3 < share < 0.95
            # A thigh is some 7 cm thick about its bone, and a wrist is held a little off what the hand lies on.
            assert 0.08 < np.linalg.norm(wrist - hip - share * (knee - hip)) < 0.13
            assert 25 < body.elbow(side)[-1] < 95
            assert wrist[1] > hip[1]


def test_hands_never_go_through_thighs_trunk_or_head() -> None:
    for _, body in [*sittings((*UPRIGHT, *BENT)), *risings()]:
        kinematics = body.kinematics
        deep = self_penetration(body.motion.skeleton, kinematics.positions, kinematics.world)
        assert deep.max() < 0.05, body.action
        assert (deep > 0.02).mean() < 0.25, body.action


def test_who_sits_on_the_floor_holds_the_trunk_as_the_words_say() -> None:
    def lean(caption: str) -> float:
        body = sat("floor", caption)
        return float(np.median(body.lean(body.facing)[-2 * FPS :]))

    assert abs(lean("sit upright with hands on thighs")) < 3
    assert lean("supporting head with hands, head bowed") > 30
    assert lean("bending to the feet, both hands at the ankles") > 20
