"""A storyboard has a pair of pictures for every keyframe the motion serves."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.image import imread

from motion_backend import rotations
from motion_backend.motion import Motion, Skill
from motion_backend.skeleton import build_skeleton
from planner_service.output.storyboard import PLAN, SIDE, storyboard
from planner_service.scripts.script import Keyframe
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Placed

BED = Placed("bed", "double_bed", (2.0, 0.0, 1.1), (1.6, 0.9, 2.0))
HOME = home_from_layouts([Layout("room", "bedroom", ((0, 0), (0, 4), (4, 4), (4, 0)), objects=(BED,))], 0)
KEYFRAMES = [
    Keyframe(skill=Skill.LOCO, caption="walks to the bed"),
    Keyframe(skill=Skill.SITDOWN, caption="sits down on the edge of the bed " * 5, furniture="bed", emotion="tired"),
    Keyframe(skill=Skill.STANDUP, caption="stands up", furniture="bed"),
]


def told(served: list[int]) -> Motion:
    """A body gliding through the room, a second a keyframe."""
    actions = np.repeat(np.array(served, dtype=np.int32), 30)
    frames = len(actions)
    roots = np.linspace([1.0, 0.9, 3.0], [3.0, 0.6, 3.0], frames, dtype=np.float32)
    turns = np.tile(rotations.IDENTITY, (frames, 22, 1)).astype(np.float32)
    return Motion(roots, turns, np.ones((frames, 4), dtype=np.float32), build_skeleton(), actions)


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    """A picture of the second keyframe alone. (H, W, 4)."""
    return imread(storyboard(HOME, told([1]), KEYFRAMES, tmp_path_factory.mktemp("one") / "one.png"))


def test_every_keyframe_that_is_acted_gets_a_pair(tmp_path, one):
    two = imread(storyboard(HOME, told([0, 2]), KEYFRAMES, tmp_path / "two.png", "A test"))
    assert 2 * (SIDE[0] + PLAN[0]) < two.shape[1] < 3 * (SIDE[0] + PLAN[0])
    assert SIDE[0] + PLAN[0] < one.shape[1] < 2 * (SIDE[0] + PLAN[0])
    assert two.shape[0] == one.shape[0]


@pytest.mark.sweep
def test_the_same_story_gives_the_same_picture(tmp_path):
    first, again = (storyboard(HOME, told([0, 1]), KEYFRAMES, tmp_path / f"{n}.png") for n in "ab")
    assert first.read_bytes() == again.read_bytes()


def test_the_furniture_a_keyframe_uses_is_outlined(tmp_path, one):
    marked = imread(storyboard(HOME, told([1]), KEYFRAMES, tmp_path / "marked.png", targets=[None, "0/bed", None]))
    assert (one != marked).any()


def test_the_pictures_show_the_home_and_not_an_empty_page(one):
    picture = one[..., :3]
    pair = picture[60 : 60 + SIDE[1], 20 : 20 + PLAN[0] + SIDE[0]]
    assert len(np.unique((pair * 255).astype(int).reshape(-1, 3), axis=0)) > 500
