"""A film shows the body in every frame: shots follow each other without a gap, and each frame is the picture it was."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from acted import SMALL, sat, walked
from hypothesis import given
from hypothesis import strategies as st
from numba.core.registry import CPUDispatcher
from PIL import Image

from motion_backend.formats.mp4 import write_mp4
from motion_backend.motion import Motion, join
from motion_backend.rendering import depth_buffer, film_kernel, surface_light
from motion_backend.rendering.camera import SEEN
from motion_backend.rendering.film_backdrop import Backdrop, _lifted
from motion_backend.rendering.film_cuts import LONGEST, SHORTEST, Framing, Subject
from motion_backend.rendering.film_frames import compile_film, film_frames
from motion_backend.rendering.film_loop import moment, write_loop
from motion_backend.rendering.film_picture import lay_words, split, to_rgb
from motion_backend.rendering.film_set import FilmSet
from motion_backend.rendering.film_shots import EYES, FilmShot, _from_feet, _standing, _View, film_shots
from motion_backend.rendering.film_sight import Appearances
from motion_backend.rendering.motion_figures import body_solids, home_props
from motion_backend.rendering.rasterizer import Camera, orbit
from motion_backend.rendering.renderer import STUDIO, Solid, Still, nearest_of, to_srgb_bytes
from motion_backend.skeleton import INDEX
from planner_service.narration.told import Span, Told
from planner_service.output.film_pages import DONE, subtitles

SIZE = (96, 54)


@cache
def acted() -> Motion:
    return join([walked("walk").motion, sat("sofa", "sit").motion])


@cache
def shots() -> tuple[FilmShot, ...]:
    return tuple(film_shots(SMALL, acted(), [0, len(walked("walk").motion)], 16 / 9))


def test_shots_follow_each_other_without_a_gap():
    assert shots()[0].start == 0
    assert shots()[-1].stop == len(acted())
    assert all(one.stop == other.start for one, other in pairwise(shots()))
    seconds = [(shot.stop - shot.start) / acted().fps for shot in shots()]
    assert min(seconds) >= 0.6 * SHORTEST
    assert max(seconds) <= LONGEST + SHORTEST


def test_the_body_is_in_the_picture_all_the_time():
    joints = acted().joint_positions()[:, SEEN].astype(np.float64)
    for shot in (one for one in shots() if one.subject is Subject.BODY):
        for frame in range(shot.start, shot.stop):
            x, y, _ = np.moveaxis(shot.camera.project(shot.camera.view(joints[frame]), (160, 90)), -1, 0)
            assert ((x > 0) & (x < 160) & (y > 0) & (y < 90)).mean() > 0.9, (shot, frame)


def test_told_words_lie_on_no_foot_and_cameras_stand_as_high_as_eyes_do():
    joints = acted().joint_positions().astype(np.float64)
    for shot in (one for one in shots() if one.subject is Subject.BODY):
        assert 0.8 < shot.camera.eye[1] <= EYES[-1] + 0.01
        _, y, _ = np.moveaxis(shot.camera.project(shot.camera.view(joints[shot.start : shot.stop]), (160, 90)), -1, 0)
        assert y.max() <= 0.83 * 90, "two lines of words end above that"


def test_of_two_sides_of_a_body_a_film_shows_the_one_with_the_home_and_the_body_stays_in_the_picture():
    motion, joints = walked("walk").motion, walked("walk").motion.joint_positions().astype(np.float64)
    whole = FilmSet.of(SMALL)
    for one in film_shots(SMALL, motion, [0], 16 / 9):
        middle = joints[one.start : one.stop].reshape(-1, 3)
        target = (middle.min(axis=0) + middle.max(axis=0)) / 2
        centred = replace(one.camera, target=(float(target[0]), one.camera.target[1], float(target[2])))
        outside = [
            float((~nearest_of(whole.seen(camera, joints[one.start : one.stop]), camera, SIZE)[1]).mean())
            for camera in (one.camera, centred)
        ]
        assert outside[0] <= outside[1] + 0.03
        seen = one.camera.project(one.camera.view(middle), SIZE)
        assert ((seen[:, :2] > 0) & (seen[:, :2] < SIZE)).all()


def test_nothing_hides_the_body_for_more_than_a_moment():
    shares = np.concatenate(
        [
            Appearances.of(acted(), Framing(one.start, one.stop), 16 / 9).shares(one.scene, one.camera)
            for one in shots()
            if one.subject is Subject.BODY
        ]
    )
    assert np.mean((shares >= 0.4).all(axis=1)) >= 0.95


def test_no_camera_is_in_furniture():
    for shot in shots():
        for placed in SMALL.objects:
            local = np.abs(placed.to_local(shot.camera.eye))
            half = np.array([placed.size[0] / 2, placed.size[1], placed.size[2] / 2])
            assert (local > half).any(), (shot, placed.id)


def test_a_body_put_into_a_still_picture_looks_as_if_all_had_been_drawn():
    body = body_solids(acted(), [40])[0]
    x, _, z = acted().joint_positions()[40, 0].tolist()
    camera = orbit((x, 0.9, z), 3.0, 0.7, 0.3)
    still = [prop.solid for prop in home_props(SMALL)]
    whole = split(Backdrop.of([*still, body], camera, SIZE).planes)[0].astype(int)
    backdrop = Backdrop.of(still, camera, SIZE)
    made = split(backdrop.with_body(body))[0].astype(int)
    assert (np.abs(made - split(backdrop.planes)[0]) > 20).mean() > 0.05
    off = np.abs(made - whole)
    assert off.mean() < 2.0
    assert (off > 40).mean() < 0.03


def test_dark_colours_of_a_body_are_lifted_and_none_becomes_brighter_than_one_that_was_brighter():
    grey = np.linspace(0.0, 1.0, 101)[:, None].repeat(3, axis=1)
    lifted = _lifted(grey)[:, 0]
    assert (np.diff(lifted) > 0).all()
    assert lifted[5] > 1.3 * grey[5, 0]
    assert np.abs(lifted[50:] - grey[50:, 0]).max() < 0.005


def test_of_a_body_that_is_partly_behind_the_eye_the_rest_is_seen():
    """A sleeper's face is looked at from over the hips: the feet are behind the camera."""
    body = body_solids(acted(), [40])[0]
    head, pelvis = acted().joint_positions()[40, [INDEX["head"], 0]]
    camera = Camera(tuple((0.25 * head + 0.75 * pelvis + [0.3, 0.0, 0.0]).tolist()), tuple(head.tolist()))
    assert camera.view(np.asarray(body.vertices, dtype=np.float64))[:, 2].min() < 0
    backdrop = Backdrop.of([prop.solid for prop in home_props(SMALL)], camera, SIZE)
    made = split(backdrop.with_body(body))[0].astype(int)
    assert (np.abs(made - split(backdrop.planes)[0]) > 20).mean() > 0.05


def test_a_body_that_is_not_in_the_picture_leaves_it_as_it_was():
    body = body_solids(acted(), [40])[0]
    camera = orbit((0.0, 40.0, 0.0), 3.0, 0.7, 0.3)
    still = [prop.solid for prop in home_props(SMALL)]
    backdrop = Backdrop.of(still, camera, SIZE)
    assert (backdrop.with_body(body) == backdrop.planes).all()


def test_a_still_picture_keeps_its_brightness_and_its_colours_at_half_the_size():
    body = body_solids(acted(), [40])[0]
    camera = orbit((0.0, 0.9, 0.0), 6.0, 0.7, 0.3)
    solids = [*(prop.solid for prop in home_props(SMALL)), body]
    whole = to_srgb_bytes(Still.of(solids, camera, SIZE, ground=None, light=STUDIO).lit.color).astype(float)
    planes = Backdrop.of(solids, camera, SIZE).planes
    bright = 16 + 219 / 255 * whole @ [0.2126, 0.7152, 0.0722]
    assert np.abs(split(planes)[0] - bright).max() < 1.5
    blocks = whole.reshape(SIZE[1] // 2, 2, SIZE[0] // 2, 2, 3).mean(axis=(1, 3))
    shown = to_rgb(planes).astype(float).reshape(SIZE[1] // 2, 2, SIZE[0] // 2, 2, 3).mean(axis=(1, 3))
    assert np.abs(shown - blocks).mean() < 1.5


def test_words_are_white_on_a_darker_band_and_elsewhere_nothing_changes():
    planes = np.full((54 * 3 // 2, 96), 150, dtype=np.uint8)
    before = planes.copy()
    letters = np.zeros((10, 41), dtype=np.float32)
    letters[4:6, 10:20] = 1
    lay_words(planes, letters, 0.94, 0.5)
    bright = split(planes)[0]
    assert (bright == 235).sum() == 20
    assert (bright == 83).sum() == 10 * 40 - 20
    assert (split(planes)[0][:38] == split(before)[0][:38]).all()


def test_what_stands_between_a_camera_and_a_body_is_seen_to_hide_it_or_its_head():
    motion = walked("walk").motion.part(40, 41)
    x, _, z = motion.joint_positions()[0, 0].tolist()
    bodies = Appearances.of(motion, Framing(0, 1), 16 / 9)
    camera = orbit((x, 0.9, z), 3.0, 0.7, 0.2)
    middle, (right, up, _) = 0.25 * np.array(camera.eye) + 0.75 * np.array([x, 0.9, z]), camera.axes

    def board(half: float, height: float) -> Solid:
        """Upright across the view, that wide and with its middle so far above that of the body."""
        corners = [
            middle + half * a * right + (height + half * b) * up for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
        return Solid(np.array(corners), np.array([[0, 1, 2], [0, 2, 3]]))

    assert bodies.look([], camera).shown == 1.0
    assert bodies.shares([], camera).min() > 0.95
    assert bodies.look([board(0.9, 0.0)], camera).shown == 0.0
    whole, head = bodies.shares([board(0.2, 0.5)], camera)[0]
    assert whole > 0.5
    assert head < 0.3


def test_a_film_has_all_frames_and_the_same_bytes_again(tmp_path: Path):
    motion = acted().part(0, 20)
    few = [FilmShot(0, 20, shots()[0].camera, shots()[0].scene)]
    one, again = (write_mp4(film_frames(motion, few, SIZE), tmp_path / name, motion.fps) for name in ("a.mp4", "b.mp4"))
    assert one.read_bytes() == again.read_bytes()
    av = pytest.importorskip("av")
    with av.open(str(one)) as film:
        shown = [frame.to_ndarray(format="yuv420p") for frame in film.decode(video=0)]
    assert len(shown) == 20
    drawn = next(iter(film_frames(motion, few, SIZE)))
    assert np.abs(shown[0].astype(int) - drawn).mean() < 4


def test_a_shot_that_goes_on_behind_a_look_from_near_is_not_drawn_anew(monkeypatch: pytest.MonkeyPatch):
    drawn = []
    real = Backdrop.of

    def counted(solids: Sequence[Solid], camera: Camera, size: tuple[int, int]) -> Backdrop:
        drawn.append(camera)
        return real(solids, camera, size)

    monkeypatch.setattr(Backdrop, "of", counted)
    whole, near = shots()[0], orbit((1.0, 1.0, 1.0), 1.3, 0.4, 0.1)
    few = [replace(whole, start=0, stop=4), FilmShot(4, 8, near, list(whole.scene)), replace(whole, start=8, stop=12)]
    assert len(list(film_frames(acted().part(0, 12), few, SIZE))) == 12
    assert drawn == [whole.camera, near]


def test_what_set_up_compiles_is_what_films_and_pictures_are_drawn_with():
    compile_film()
    next(iter(film_frames(acted().part(0, 20), shots(), SIZE)))
    kernels = [
        kernel
        for module in (depth_buffer, film_kernel, surface_light)
        for kernel in vars(module).values()
        if isinstance(kernel, CPUDispatcher)
    ]
    assert {kernel.py_func.__name__ for kernel in kernels if kernel.signatures} >= {"put_body", "shade_picture", "draw"}
    assert [kernel.py_func.__name__ for kernel in kernels if len(kernel.signatures) > 1] == []


def test_every_sentence_is_shown_while_what_it_tells_is_done():
    text = "It was late. She came home. She thought of him, and sat down. Then she slept."
    spans = [Span(text.index(word), text.index(word) + 4, (k,)) for k, word in enumerate(("came", "sat ", "slept"))]
    shown = subtitles(Told("Late", text, tuple(spans)), [(0, 60), (60, 200), (200, 300)], 30)
    assert " ".join(line.text.replace("\n", " ") for line in shown) == text
    assert [(line.start, line.stop) for line in shown] == [(0, 60), (60, 200), (200, 300)]


def test_keyframes_without_a_story_have_no_words():
    assert subtitles(Told("", "", ()), [(0, 60)], 30) == []


def test_a_sentence_that_tells_of_two_keyframes_is_shown_in_two_parts_and_none_stands_for_long():
    text = "He sat down, and read a book. He slept."
    spans = [Span(text.index(word), text.index(word) + len(word), (k,)) for k, word in enumerate(("sat down", "read"))]
    spans.append(Span(text.index("slept"), text.index("slept") + 5, (2,)))
    told = Told("", text, tuple(spans))
    shown = subtitles(told, [(0, 90), (90, 600), (600, 1500)], 30)
    assert [line.text for line in shown] == ["He sat down…", "and read a book.", "He slept."]
    assert [line.start for line in shown] == [0, 90, 600]
    assert max(line.stop - line.start for line in shown) <= 7 * 30
    together = subtitles(told, [(0, 20), (20, 600), (600, 1500)], 30)
    assert [line.text for line in together] == ["He sat down, and read a book.", "He slept."]


def test_words_are_there_when_what_they_tell_is_being_done():
    told = Told("", "She slept.", (Span(0, 9, (0, 1)),))
    (line,) = subtitles(told, [(0, 900), (900, 1500)], 30)
    assert line.start < 900 + DONE * 30 < line.stop
    (soon,) = subtitles(told, [(0, 30), (30, 60)], 30)
    assert soon.start == 0
    (after,) = subtitles(told, [(0, 30), (30, 600)], 30, titled=75)
    assert (after.start, after.text) == (75, "She slept."), "a title hides no words"


def test_a_loop_has_every_third_frame_of_its_moments_once_and_begins_anew(tmp_path: Path):
    moments = [moment((0, 40), 1.0, 30), moment((50, 59), 1.0, 30)]
    assert moments == [range(5, 35), range(50, 59)], "as far as a segment has them"
    path = write_loop(SMALL, acted(), [(0, 40), (40, 80)], moments, tmp_path / "loop.webp", SIZE)
    with Image.open(path) as picture:
        assert (picture.size, picture.info["loop"]) == (SIZE, 0)
        assert getattr(picture, "n_frames", 1) == 13


@given(st.floats(-3.1, 3.1), st.floats(0.1, 2.5), st.floats(0.5, 2.0))
def test_a_camera_turned_aside_stands_where_it_stood_and_keeps_all_in_its_picture(
    yaw: float, wide: float, high: float
) -> None:
    points = np.array([[x, y, z] for x in (-wide, wide) for y in (0.0, high) for z in (-0.3, 0.3)])
    middle = _standing(yaw, 1.4, points, 16 / 9, 2.3)
    for view in _View(0.0, middle, points).aside(16 / 9):
        assert view.camera.eye == middle.eye
        assert view.score < 0.0
        seen = view.camera.project(view.camera.view(points), (160, 90))
        assert ((seen[:, :2] > 0) & (seen[:, :2] < (160, 90))).all()
    sides = [float(view.camera.axes[2] @ middle.axes[0]) for view in _View(0.0, middle, points).aside(16 / 9)]
    assert len(sides) == 2 or wide > 0.5, "a narrow body has room at either side"
    assert len(sides) < 2 or sides[0] * sides[1] < 0


def test_soles_first_is_how_nobody_who_lies_is_looked_at() -> None:
    lies, stands = np.array([[0.0, 0.1, 1.0]]), np.array([[0.0, 1.0, 0.0]])
    ways = {"feet": (0.0, 0.0, -1.0), "side": (1.0, 0.0, 0.0), "head": (0.0, 0.0, 1.0)}
    assert _from_feet(lies, np.array(ways["feet"])) > 0.9
    assert [_from_feet(lies, np.array(ways[way])) for way in ("side", "head")] == [0.0, 0.0]
    assert _from_feet(stands, np.array((0.0, -1.0, 0.0))) == 0.0
