"""Where films are cut, and what they look at from near: what keeps still, without splinters, and not all the time."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
from acted import SMALL, sat, touched, walked
from for_each import for_each
from upright_body import walking

from motion_backend.body.cast import Role
from motion_backend.motion import Emotion, Motion, PhaseKind, Skill, join
from motion_backend.rendering.camera import visible_share
from motion_backend.rendering.face_deed import LEAST, face_deed
from motion_backend.rendering.film_cuts import SHORTEST, Cut, Framing, Subject, film_cuts
from motion_backend.rendering.film_shots import NO_LONGER_NEAR, WIDEST_NEAR, FilmShot, are_alike, film_shots
from motion_backend.rendering.film_sight import Appearances
from motion_backend.rendering.rasterizer import orbit
from motion_backend.rotations import rotate
from motion_backend.skeleton import INDEX
from scene_graphs.affordances.affordances import spots

ASPECT = 16 / 9
SAD = Role(emotions={0: Emotion.HAPPY, 1: Emotion.SAD, 2: Emotion.SAD})


@cache
def story() -> tuple[Motion, tuple[int, ...]]:
    """Somebody walks, sits down and touches the shelf, and where each of that begins."""
    parts = [walked("walk").motion, sat("sofa", "sit").motion, touched("shelf", "medium", "touch").motion]
    actions = np.repeat(np.arange(len(parts), dtype=np.int32), list(map(len, parts)))
    return replace(join(parts), actions=actions), tuple(np.cumsum([0, *map(len, parts)])[:-1].tolist())


def cuts(role: Role = SAD) -> list[Cut]:
    motion, starts = story()
    return list(film_cuts(motion, motion.joint_positions().astype(np.float64), starts, role))


@cache
def shots() -> tuple[FilmShot, ...]:
    motion, starts = story()
    return tuple(film_shots(SMALL, motion, starts, ASPECT, SAD))


def close_ups() -> list[FilmShot]:
    return [shot for shot in shots() if shot.subject is not Subject.BODY]


def test_cuts_follow_each_other_and_what_is_seen_from_near_leaves_no_splinter_of_a_shot():
    motion, _ = story()
    assert [cuts()[0].start, cuts()[-1].stop] == [0, len(motion)]
    assert all(one.stop == other.start for one, other in pairwise(cuts()))
    for cut in cuts():
        if cut.close is not None:
            assert cut.start <= cut.close.start < cut.close.stop <= cut.stop
            for left in (cut.close.start - cut.start, cut.stop - cut.close.stop):
                assert left == 0 or left >= SHORTEST * motion.fps


def test_a_hand_that_touches_is_seen_from_near_at_the_moment_it_does():
    motion, _ = story()
    close = next(cut.close for cut in cuts() if cut.close is not None and cut.close.subject is Subject.HANDS)
    phases = [phase for phase in motion.phases if phase.kind is PhaseKind.TOUCH]
    assert INDEX["right_wrist"] in close.hands
    assert any(phase.start < (close.start + close.stop) / 2 < phase.stop for phase in phases)


def test_hands_that_somebody_who_stands_lifts_are_a_deed_and_hanging_ones_are_none():
    stands = walking((0.0, 0.0, 0.0), 0.0)
    turns = stands.local_rotations.copy()
    turns[5:55, INDEX["right_shoulder"]] = [0.0, 0.0, 0.0, 1.0]  # held out to the side
    for motion, hands in ((stands, None), (replace(stands, local_rotations=turns), (INDEX["right_wrist"],))):
        (cut,) = film_cuts(motion, motion.joint_positions().astype(np.float64), [0])
        assert (cut.reach and cut.reach.hands) == hands
        assert cut.reach is None or (cut.whole.gesture and (cut.reach.start, cut.reach.stop) == (5, 55))


def test_nobody_upright_is_looked_at_from_near_from_above():
    joints = story()[0].joint_positions()
    upright = [shot for shot in close_ups() if joints[shot.start, INDEX["head"], 1] > 1.0]
    assert upright
    for shot in upright:
        assert shot.camera.axes[2][1] > -np.sin(0.31)


@for_each("height, hand", [("medium", "left"), ("medium", "right")])
def test_of_two_hands_the_one_that_touches_is_looked_at(height: str, hand: str):
    motion = touched("shelf", height, f"touch {height} height with the {hand} hand", hand).motion
    (close,) = (cut.close for cut in film_cuts(motion, motion.joint_positions().astype(np.float64), [0]) if cut.close)
    assert (close.subject, close.hands) == (Subject.HANDS, (INDEX[f"{hand}_wrist"],))


def test_nothing_stands_between_a_hand_that_touches_and_the_eye_near_it_nor_is_it_seen_from_behind():
    motion, _ = story()
    joints, turns = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    shot = next(one for one in close_ups() if one.subject is Subject.HANDS)
    wrists = joints[shot.start : shot.stop : 5, INDEX["right_wrist"]].astype(np.float64)
    assert visible_share(SMALL.objects, shot.camera.eye, wrists) == 1.0
    ahead = rotate(turns[shot.start : shot.stop, INDEX["head"]], np.array([0.0, 0.0, 1.0]))
    assert float(np.mean(np.arccos(np.clip(ahead @ -shot.camera.axes[2], -1, 1)))) < WIDEST_NEAR[Subject.HANDS]


def test_a_face_is_seen_from_near_where_the_mood_is_another_and_not_where_it_stays():
    faces = [cut.close for cut in cuts() if cut.close is not None and cut.close.subject is Subject.FACE]
    assert faces
    shown = [SAD.emotions[int(story()[0].actions[one.start])] for one in faces]
    assert len(set(shown)) == len(shown), "each mood once"
    assert Emotion.SAD in shown


def test_no_two_shots_in_a_row_are_seen_from_near():
    assert close_ups(), "something is seen from near"
    for one, other in pairwise(shots()):
        assert Subject.BODY in (one.subject, other.subject)


@for_each("name", ["head", "hands"])
def test_what_is_looked_at_from_near_is_in_the_picture_all_the_time(name: str):
    motion, _ = story()
    joints = motion.joint_positions().astype(np.float64)
    wanted = Subject.FACE if name == "head" else Subject.HANDS
    for shot in (one for one in close_ups() if one.subject is wanted):
        for frame in range(shot.start, shot.stop):
            points = joints[frame, [INDEX["head"]] if name == "head" else [INDEX["right_wrist"]]]
            x, y, _ = np.moveaxis(shot.camera.project(shot.camera.view(points), (160, 90)), -1, 0)
            assert ((x > 0) & (x < 160) & (y > 0) & (y < 90)).all(), (shot, frame)


def test_a_camera_from_near_is_nearer_and_neither_furniture_nor_the_body_itself_hides_what_it_is_about():
    motion, _ = story()
    framings = {cut.close.start: cut.close for cut in cuts() if cut.close is not None}
    for shot in close_ups():
        bodies = Appearances.of(motion, framings[shot.start], ASPECT)
        assert bodies.look(shot.scene, shot.camera).shown >= 0.9
        # With a hand, head and shoulders are in the picture.
        farthest = 2.2 if shot.subject is Subject.FACE else NO_LONGER_NEAR
        assert np.linalg.norm(np.subtract(shot.camera.eye, shot.camera.target)) < farthest


def test_no_cut_is_a_jump_from_nearly_the_same_place():
    pairs = [(one.camera, other.camera) for one, other in pairwise(shots()) if one.camera != other.camera]
    assert len(pairs) >= 4
    assert np.mean([are_alike(*pair) for pair in pairs]) < 0.1


def test_a_body_hides_its_own_hand_from_a_camera_behind_its_back():
    motion = touched("shelf", "medium", "touch").motion
    joints, middle = motion.joint_positions().astype(np.float64), len(motion) // 2
    hand, chest = joints[middle, INDEX["right_wrist"]], joints[middle, INDEX["spine3"]]
    bodies = Appearances.of(motion, Framing(middle, middle + 1, Subject.HANDS, (INDEX["right_wrist"],)), ASPECT)
    x, y, z = hand.tolist()
    behind = float(np.arctan2(*(chest - hand)[[0, 2]]))
    shown = [bodies.shares([], orbit((x, y, z), 1.6, behind + turn, 0.05))[0, 1] for turn in (0.0, np.pi / 2, np.pi)]
    assert shown[0] < 0.4 < min(shown[1:])


@for_each(("name", "height"), [("shelf", "low"), ("shelf", "medium"), ("shelf", "high")])
def test_a_hand_is_seen_from_near_with_head_and_shoulders_of_whose_it_is(name: str, height: str) -> None:
    if not any(spot.height == height for spot in spots(SMALL.object(f"0/{name}"), "touch")):
        return
    motion = touched(name, height, "touch").motion
    joints = motion.joint_positions().astype(np.float64)
    near = [one for one in film_shots(SMALL, motion, [0], ASPECT) if one.subject is Subject.HANDS]
    assert near or height != "medium"
    for shot in near:
        for frame in np.linspace(shot.start, shot.stop - 1, 5).round().astype(int):
            who = joints[frame, [INDEX[part] for part in ("head", "left_shoulder", "right_shoulder")]]
            x, y, depth = np.moveaxis(shot.camera.project(shot.camera.view(who), (160, 90)), -1, 0)
            assert ((x > 0) & (x < 160) & (y > 0) & (y < 90) & (depth > 0)).all(), (shot.start, frame)


WEPT = (Skill.SITDOWN, "supporting head with hands, head bowed")


@cache
def wept() -> tuple[FilmShot, ...]:
    """Somebody walks to a sofa, sits down and weeps there."""
    parts = [walked("walk").motion, sat("sofa", WEPT[1]).motion]
    actions = np.repeat(np.arange(2, dtype=np.int32), list(map(len, parts)))
    motion = replace(join(parts), actions=actions)
    role = Role(captions={0: (Skill.LOCO, "walk"), 1: WEPT})
    return tuple(film_shots(SMALL, motion, [0, len(parts[0])], ASPECT, role))


def test_a_deed_of_the_face_is_seen_from_near_and_from_before_to_its_end() -> None:
    last = wept()[-1]
    assert last.subject is Subject.FACE
    assert (last.stop - last.start) / 30 >= LEAST
    turn = join([walked("walk").motion, sat("sofa", WEPT[1]).motion]).local_rotations[last.stop - 1, 0]
    ahead = rotate(turn.astype(np.float64), np.array([0.0, 0.0, 1.0]))
    assert -last.camera.axes[2][[0, 2]] @ ahead[[0, 2]] > 0.2 * np.linalg.norm(ahead[[0, 2]])


def test_nothing_else_is_seen_from_near_right_before_a_deed_of_the_face() -> None:
    before = wept()[-2]
    assert before.subject is Subject.BODY
    assert (before.stop - before.start) / 30 >= SHORTEST


def test_who_walks_does_no_deed_of_the_face() -> None:
    motion = walked("walk").motion
    joints = motion.joint_positions().astype(np.float64)
    role = Role(captions={0: (Skill.LOCO, "sighing deeply")})
    assert face_deed(motion, joints, role, 0, len(motion), 48) is None
