"""Props are in the hands that hold them, while they hold them: properties of every caption that holds something."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from for_each import for_each
from sample_motions import standing_still, tumbling

from motion_backend import rotations
from motion_backend.body.cast import Role
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Motion, Skill, join
from motion_backend.props import PropTrack, held_in, prop_shape, prop_tracks
from motion_backend.props.prop_hands import Hands
from motion_backend.props.prop_table import prop_table
from motion_backend.rendering.motion_figures import Acting
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from planner_service.evaluation.trials import Performance, perform
from planner_service.output.caption_sheets import trial_of
from planner_service.scripts.captions import captions

KNOWN = [(Skill(skill), caption) for skill, some in captions().items() for caption in some]
HOLDING = [(skill, caption) for skill, caption in KNOWN if held_in(skill, caption)]
THINGS = r"\b(cup|book|paper|phone|controller|guitar|pillow|toys|keyboard)\b"
DOINGS = (
    r"\b(both hands hold|carrying|sweeping|combing|knitting|hugging"
    r"|writing|eating|drinking|pouring|stirring|wiping with"
    r"|brushing the teeth|drying the hair|lifting weights|singing)\b"
)
"""What is only done with something, where a caption does not say with what."""
NOTHING = r"face"
"""Of the body itself."""
REACH = 0.12
"""Metres from a hand to the nearest point of what it holds."""
LYING = 0.16
"""And of what lies there for it."""
PALM = np.array([0.075, -0.02, 0.0])
"""From the left wrist, in its frame."""


@cache
def acted(skill: Skill, caption: str) -> Performance:
    return perform(trial_of(skill, caption, None, 0))


@cache
def tracks(skill: Skill, caption: str) -> tuple[PropTrack, ...]:
    done = acted(skill, caption)
    return prop_tracks(done.motion, done.role)


def palms(motion: Motion) -> Array:
    """(T, 2, 3), by a way of their own."""
    body = Kinematics.of(motion)
    joints = [INDEX["left_wrist"], INDEX["right_wrist"]]
    away = np.array([PALM, PALM * [-1, 1, 1]]) * motion.skeleton.scale
    return np.asarray(body.positions[:, joints] + rotations.rotate(body.world[:, joints], away))


def raised(motion: Motion) -> Array:
    """How much higher the wrists are than the arms would hang, along the chest, in arm lengths. (T, 2)."""
    body = Kinematics.of(motion)
    names = [[f"{side}_{joint}" for side in ("left", "right")] for joint in ("shoulder", "elbow", "wrist")]
    shoulder, elbow, wrist = (body.positions[:, [INDEX[name] for name in some]] for some in names)
    length = np.linalg.norm(elbow - shoulder, axis=-1) + np.linalg.norm(wrist - elbow, axis=-1)
    up = rotations.rotate(body.world[:, INDEX["spine3"]], np.array([0.0, 1.0, 0.0]))
    return np.asarray(1.0 + np.sum((wrist - shoulder) * up[:, None], axis=-1) / length)


def way(track: PropTrack, axis: tuple[float, float, float]) -> Array:
    """Where an axis of a prop points in every frame. (N, 3)."""
    return rotations.rotate(track.turns, np.array(axis))


@for_each(("skill", "caption"), KNOWN)
def test_who_is_said_to_have_something_in_hand_has_it_and_nobody_else(skill: Skill, caption: str) -> None:
    text = caption.lower()
    named = re.search(THINGS, text) or (re.search(DOINGS, text) and not re.search(NOTHING, text))
    extra = "music" in text
    assert (held_in(skill, caption) is not None) == (bool(named) or extra)


def test_every_row_is_of_one_thing_and_the_first_that_fits() -> None:
    used = {held_in(skill, caption) for skill, caption in KNOWN}
    coming = [row for row in prop_table().held if row not in used and not row.of]
    assert all(re.search(r"looking|kissing|eating", row.words) for row in coming)
    for row in coming:
        said = re.sub(r"\\b|\.\*|\(.*?\)", " ", row.words)
        assert said.strip()


@for_each(("skill", "caption"), HOLDING)
def test_what_is_held_comes_into_view_in_a_body_that_does_so(skill: Skill, caption: str) -> None:
    held = held_in(skill, caption)
    assert held is not None
    assert {track.prop for track in tracks(skill, caption)} == {grip.prop for grip in held.props}
    assert sum(len(track.positions) for track in tracks(skill, caption)) > 30


@for_each(("skill", "caption"), HOLDING)
def test_a_prop_is_within_twelve_centimetres_of_a_hand_that_holds_it_in_every_frame(skill: Skill, caption: str) -> None:
    held = held_in(skill, caption)
    assert held is not None
    hands = palms(acted(skill, caption).motion)[:, held.hands]
    lying = {grip.prop for grip in held.props if grip.still}
    for track in tracks(skill, caption):
        points = _filled(prop_shape(track.prop).vertices.astype(np.float64))
        matrices, nearest = rotations.quat_to_matrix(track.turns), []
        for frame, (position, size, matrix) in enumerate(zip(track.positions, track.sizes, matrices, strict=True)):
            away = np.linalg.norm((position + size * points @ matrix.T)[:, None] - hands[track.start + frame], axis=-1)
            nearest.append(float(away.min()))
        # What lies there does so before hands come to it, too.
        if track.prop in lying:
            assert min(nearest) < LYING
        else:
            assert max(nearest) < REACH, (track.prop, int(np.argmax(nearest)), max(nearest))


def _filled(corners: Array) -> Array:
    """Points on the triangles of a shape, not only their corners."""
    sides = corners.reshape(-1, 3, 3)
    steps = int(np.ptp(sides, axis=1).max() / 0.07) + 2
    shares = np.array([(a, b, steps - a - b) for a in range(steps + 1) for b in range(steps + 1 - a)]) / steps
    return np.einsum("sk,fkc->sfc", shares, sides).reshape(-1, 3)


@for_each(("skill", "caption"), HOLDING)
def test_both_hands_hold_nothing_before_they_are_lifted_nor_after_they_are_down(skill: Skill, caption: str) -> None:
    held = held_in(skill, caption)
    assert held is not None
    up = raised(acted(skill, caption).motion)[:, held.hands].max(axis=1)
    between = {grip.prop for grip in held.props if grip.hand == "both" and not (grip.still or grip.stands)}
    for track in tracks(skill, caption):
        assert track.prop not in between or up[track.start : track.stop].min() > 0.25


@for_each(("skill", "caption"), HOLDING)
def test_what_one_hand_holds_or_stands_or_lies_comes_and_goes_with_its_keyframe(skill: Skill, caption: str) -> None:
    held, done = held_in(skill, caption), acted(skill, caption)
    assert held is not None
    own = np.flatnonzero(done.motion.actions == done.actions[-1].keyframe)
    between = {grip.prop for grip in held.props if grip.hand == "both" and not (grip.still or grip.stands)}
    for track in tracks(skill, caption):
        assert track.prop in between or (track.start, track.stop) == (own[0], own[-1] + 1)


def test_a_broom_stands_on_the_floor_all_along_and_goes_far_over_it() -> None:
    (broom,) = tracks(Skill.LOCO, "sweeping the floor with both hands")
    assert np.abs(broom.positions[:, 1]).max() < 0.01
    assert np.ptp(broom.positions[:, [0, 2]], axis=0).max() > 1.0


@for_each(("skill", "caption"), HOLDING)
def test_what_comes_grows_and_what_goes_shrinks(skill: Skill, caption: str) -> None:
    frames = len(acted(skill, caption).motion)
    for track in tracks(skill, caption):
        assert np.abs(np.diff(track.sizes)).max(initial=0.0) < 0.35
        assert track.start == 0 or track.sizes[0] < 0.2
        assert track.stop == frames or track.sizes[-1] < 0.2
        assert track.sizes.max() == pytest.approx(1.0)


@for_each(("skill", "caption"), HOLDING)
def test_a_prop_never_jumps(skill: Skill, caption: str) -> None:
    hands = np.linalg.norm(np.diff(palms(acted(skill, caption).motion), axis=0), axis=-1).max(axis=1)
    for track in tracks(skill, caption):
        grown = track.sizes[1:] + track.sizes[:-1] > 2 * track.sizes.max() - 1e-9
        ahead = np.linalg.norm(np.diff(track.positions, axis=0), axis=1) - hands[track.start : track.stop - 1]
        assert ahead[grown].max(initial=0.0) < 0.08, "metres a frame that it goes faster than the hands"
        assert np.sum(track.turns[1:] * track.turns[:-1], axis=1)[grown].min(initial=1.0) > np.cos(np.radians(14.5))


def test_cups_and_boxes_stay_upright_but_at_the_mouth_and_there_the_rim_is_at_the_lips() -> None:
    upright = {"cup", "box", "pot", "plate"}
    seen = set()
    for skill, caption in HOLDING:
        for track in tracks(skill, caption):
            if track.prop in upright:
                seen.add(track.prop)
                lips, away = _from_the_lips(acted(skill, caption).motion, track)
                up = way(track, (0, 1, 0))[:, 1]
                assert up[away > 0.3].min() > np.cos(np.radians(25))
                if "drinking" in caption:
                    assert up.min() < np.cos(np.radians(30))
                    rim = (track.positions + 0.05 * way(track, (0, 1, 0)))[up < np.cos(np.radians(35))]
                    gap = np.linalg.norm(rim - lips[up < np.cos(np.radians(35))], axis=1)
                    assert gap.max() < 0.11, "the middle of the rim is half its width from the lips"
    assert seen == upright


def _from_the_lips(motion: Motion, track: PropTrack) -> tuple[Array, Array]:
    """Where the lips are in the frames of a prop, (N, 3), and how far its middle is from them. (N,)."""
    body, head = Kinematics.of(motion), INDEX["head"]
    lips = body.positions[:, head] + rotations.rotate(body.world[:, head], np.array([0.0, 0.012, 0.112]))
    there = lips[track.start : track.stop]
    return there, np.linalg.norm(track.positions - there, axis=1)


def test_who_drinks_tips_the_cup_to_the_mouth_with_the_head_back() -> None:
    drinking = [(skill, caption) for skill, caption in HOLDING if "drinking" in caption]
    assert len(drinking) == 2
    for skill, caption in drinking:
        (track,) = tracks(skill, caption)
        nose = rotations.rotate(acted_body(skill, caption).world[:, INDEX["head"]], np.array([0.0, 0.0, 1.0]))
        tipped = way(track, (0, 1, 0))[:, 1] < np.cos(np.radians(35))
        assert tipped.mean() > 0.08
        up = nose[track.start : track.stop, 1][tipped]
        assert up.max() > np.sin(np.radians(12)), "the head goes back once the rim is at the lips"
        assert (up > 0).mean() > 0.45
        assert from_mouth(skill, caption, track)[tipped].max() < 0.2


def acted_body(skill: Skill, caption: str) -> Kinematics:
    return Kinematics.of(acted(skill, caption).motion)


def from_mouth(skill: Skill, caption: str, track: PropTrack) -> Array:
    """Metres from the lips to a prop."""
    body = acted_body(skill, caption)
    lips = rotations.rotate(body.world[:, INDEX["head"]], np.array([0.0, 0.015, 0.10]))
    away = body.positions[:, INDEX["head"]] + lips
    return np.asarray(np.linalg.norm(away[track.start : track.stop] - track.positions, axis=1))


def test_a_broom_reaches_the_floor() -> None:
    done = acted(Skill.LOCO, "sweeping the floor with both hands")
    (track,) = tracks(Skill.LOCO, "sweeping the floor with both hands")
    ends = track.positions[track.sizes == track.sizes.max(), 1]
    np.testing.assert_allclose(ends, 0.0, atol=0.01)
    assert way(track, (0, 1, 0))[track.sizes == track.sizes.max(), 1].min() > 0.5
    assert done.motion.joint_positions()[:, INDEX["head"], 1].max() > 1.2


def test_a_book_opens_towards_the_face() -> None:
    for skill, caption in HOLDING:
        if not re.search(r"\bbook\b", caption):
            continue
        body = Kinematics.of(acted(skill, caption).motion)
        head = body.positions[:, INDEX["head"]]
        for track in tracks(skill, caption):
            toward = rotations.normalize(head[track.start : track.stop] - track.positions)
            assert np.sum(way(track, (0, 0, 1)) * toward, axis=1).min() > np.cos(np.radians(40))


def test_a_phone_lies_at_the_ear_of_the_side_that_is_said() -> None:
    for skill, caption in HOLDING:
        if "phone" not in caption or "looking" in caption or "hanging up" in caption:
            continue
        body = Kinematics.of(acted(skill, caption).motion)
        side = 1.0 if "left" in caption else -1.0
        ear = body.positions[:, INDEX["head"]] + rotations.rotate(
            body.world[:, INDEX["head"]], np.array([0.08 * side, 0.06, 0.0])
        )
        (track,) = tracks(skill, caption)
        along = np.linspace(-0.08, 0.08, 9)[:, None, None] * way(track, (0, 1, 0))
        away = np.linalg.norm(track.positions + along - ear[track.start : track.stop], axis=-1).min(axis=0)
        called = raised(acted(skill, caption).motion)[track.start : track.stop, 0 if side > 0 else 1] > 0.8
        assert np.median(away[called]) < 0.10, (caption, float(np.median(away[called])))


def test_hands_that_hang_hold_nothing_whatever_is_said() -> None:
    """Another backend that does not lift the phone shows none."""
    done = acted(Skill.LOCO, "smoothly forward walk")
    for _, caption in HOLDING:
        assert prop_tracks(done.motion, Role(captions={int(done.motion.actions[0]): (Skill.LOCO, caption)})) == ()


def test_unknown_captions_and_roles_without_captions_hold_nothing() -> None:
    done = acted(Skill.LOCO, "carrying with both hands")
    assert prop_tracks(done.motion, Role()) == ()
    said = {int(key): (Skill.LOCO, "juggling with torches") for key in np.unique(done.motion.actions)}
    assert prop_tracks(done.motion, Role(captions=said)) == ()


def test_the_same_motion_and_role_give_the_same() -> None:
    done = acted(Skill.SITDOWN, "playing the guitar")
    for one, other in zip(prop_tracks(done.motion, done.role), prop_tracks(done.motion, done.role), strict=True):
        assert (one.prop, one.start) == (other.prop, other.start)
        assert one.positions.tobytes() == other.positions.tobytes()
        assert one.turns.tobytes() == other.turns.tobytes()
        assert one.sizes.tobytes() == other.sizes.tobytes()


def following(*done: Performance) -> tuple[Motion, Role]:
    """What was acted one after the other, as one motion and its role."""
    motions = [replace(one.motion, actions=np.full(len(one.motion), i, np.int32)) for i, one in enumerate(done)]
    said = {i: (one.actions[-1].skill, one.actions[-1].caption) for i, one in enumerate(done)}
    return join(motions), Role(captions=said)


def test_one_hand_holds_one_thing_at_a_time() -> None:
    doings = ("reading while standing, paper in both hands", "drinking while standing, cup in the right hand")
    motion, role = following(*(acted(Skill.LOCO, caption) for caption in (*doings, *doings)))
    found = prop_tracks(motion, role)
    assert [track.prop for track in found] == ["letter", "cup", "letter", "cup"]
    for one, other in pairwise(found):
        assert one.stop <= other.start


def test_what_is_held_in_two_keyframes_running_does_not_go_in_between() -> None:
    caption = "carrying with both hands"
    whole = acted(Skill.LOCO, caption).motion
    half = len(whole) // 2
    motion = replace(whole, actions=(np.arange(len(whole)) >= half).astype(np.int32))
    role = Role(captions=dict.fromkeys((0, 1), (Skill.LOCO, caption)))
    (one,) = prop_tracks(motion, role)
    (all_,) = tracks(Skill.LOCO, caption)
    assert (one.start, one.stop) == (all_.start, all_.stop)


def test_a_prop_follows_the_body_wherever_it_is() -> None:
    """Moved and turned about the vertical, a body holds it as before."""
    done = acted(Skill.SITDOWN, "drinking from a cup in the right hand")
    turn, shift = rotations.yaw_to_quat(1.1), np.array([3.0, 0.0, -2.0])
    local = done.motion.local_rotations.astype(np.float64)
    local[:, 0] = rotations.compose(turn, local[:, 0])
    roots = rotations.rotate(turn, done.motion.root_positions.astype(np.float64)) + shift
    moved = replace(done.motion, root_positions=roots.astype(np.float32), local_rotations=local.astype(np.float32))
    (there,), (here,) = prop_tracks(moved, done.role), tracks(Skill.SITDOWN, done.trial.caption)
    assert (there.start, there.stop) == (here.start, here.stop)
    np.testing.assert_allclose(there.positions, rotations.rotate(turn, here.positions) + shift, atol=1e-4)


def test_pictures_show_the_body_alone_where_nothing_is_held_and_a_prop_besides_where_it_is() -> None:
    done = acted(Skill.LOCO, "reading while standing, paper in both hands")
    (track,) = tracks(Skill.LOCO, done.trial.caption)
    middle = (track.start + track.stop) // 2
    bare, plain = (Acting.of(done.motion, role).solids([0, middle]) for role in (Role(), done.role))
    assert len(plain[0].faces) == len(bare[0].faces)
    assert len(plain[1].faces) == len(bare[1].faces) + len(prop_shape("letter").faces)
    np.testing.assert_array_equal(plain[1].vertices[: len(bare[1].vertices)], bare[1].vertices)


def test_shapes_are_small_closed_in_their_corners_and_of_real_sizes() -> None:
    for name in prop_table().shapes:
        shape = prop_shape(name)
        assert len(shape.faces) <= 420
        np.testing.assert_allclose(np.linalg.norm(shape.normals, axis=1), 1.0, atol=1e-5)
        across = np.ptp(shape.vertices, axis=0).max()
        assert 0.05 < across < 1.5, name


def test_a_body_that_only_tumbles_has_hands_of_length_one() -> None:
    """Directions are unit vectors whatever the pose, and frames are rotations."""
    hands = Hands.of(tumbling(30))
    for row in prop_table().held:
        for grip in row.props:
            _, turns, _ = hands.placed(grip, 0, 30)
            np.testing.assert_allclose(np.linalg.norm(turns, axis=1), 1.0, atol=1e-9)


def test_a_t_pose_says_where_palms_are() -> None:
    hands = Hands.of(standing_still(2))
    (left, right), wrists = hands.palms[0], standing_still(2).joint_positions()[0, [20, 21]]
    np.testing.assert_allclose(left - wrists[0], [0.075, -0.02, 0.0], atol=1e-6)
    np.testing.assert_allclose(right - wrists[1], [-0.075, -0.02, 0.0], atol=1e-6)


@for_each(
    ("caption", "thing", "props"),
    [
        ("knocking with the right hand", "", []),
        ("knocking with the right hand", "letter", []),
        ("knocking with the right hand", "hammer", ["hammer"]),
        ("knocking with the right hand", "knife", ["knife", "board"]),
        ("wiping with the right hand", "", ["cloth"]),
        ("wiping with the right hand", "iron", ["iron", "linen"]),
        ("wiping with the right hand", "butter knife", ["knife", "bread"]),
        ("wiping with the right hand", "paintbrush", ["paintbrush"]),
        ("wash with both hands", "dough", ["dough"]),
        ("wash with both hands", "rolling pin", ["rolling_pin", "dough"]),
        ("wiping the face with the right hand", "razor", ["razor"]),
        ("sweeping the floor with both hands", "vacuum", ["vacuum"]),
        ("sweeping the floor with both hands", "", ["broom"]),
    ],
)
def test_a_tool_that_is_named_is_held_at_its_work_with_what_lies_under_it(
    caption: str, thing: str, props: list[str]
) -> None:
    skill = Skill.LOCO if "face" in caption or "sweeping" in caption else Skill.TOUCH
    row = held_in(skill, caption, thing)
    assert [grip.prop for grip in row.props] == props if row is not None else not props
