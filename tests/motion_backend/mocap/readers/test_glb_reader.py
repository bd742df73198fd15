"""Animated characters as glTF, made here piece by piece, and what is wrong with broken ones."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
import pytest

from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.readers import read_clips

HALF = float(np.sqrt(0.5))
QUARTER = [0.0, HALF, 0.0, HALF]
"""A quarter turn to the left, about Y."""


class Character:
    """An armature of half size over a root bone over hips with two legs, and an IK node."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "nodes": [
                {"name": "Armature", "children": [1], "scale": [0.5, 0.5, 0.5], "translation": [1, 0, 0]},
                {"name": "root", "children": [2, 6]},
                {"name": "hips", "children": [3, 4], "translation": [0, 2, 0]},
                {"name": "leg.l", "children": [5], "translation": [0.2, 0, 0]},
                {"name": "leg.r", "translation": [-0.2, 0, 0]},
                {"name": "foot.l", "translation": [0, -2, 0]},
                {"name": "heelIK.l"},
            ],
            "skins": [{"joints": [1, 2, 3, 4, 5, 6]}],
            "accessors": [],
            "bufferViews": [],
            "buffers": [{}],
            "animations": [],
        }

    def accessor(self, values) -> int:
        array = np.asarray(values, dtype="<f4")
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": array.nbytes})
        self.binary.extend(array.tobytes())
        kind = "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}"
        view = len(self.json["bufferViews"]) - 1
        self.json["accessors"].append({"bufferView": view, "componentType": 5126, "count": len(array), "type": kind})
        return len(self.json["accessors"]) - 1

    def animate(self, name: str, *channels, interpolation="LINEAR") -> Character:
        """Channels are (node, path, times, values)."""
        samplers = [
            {"input": self.accessor(times), "output": self.accessor(values), "interpolation": interpolation}
            for _, _, times, values in channels
        ]
        targets = [
            {"sampler": number, "target": {"node": node, "path": path}}
            for number, (node, path, *_) in enumerate(channels)
        ]
        self.json["animations"].append({"name": name, "samplers": samplers, "channels": targets})
        return self

    def read(self, folder):
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        body = struct.pack("<II", len(text), 0x4E4F534A) + text
        body += struct.pack("<II", len(self.binary), 0x004E4942) + bytes(self.binary)
        (folder / "hero.glb").write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
        return read_clips(folder / "hero.glb")


def turning() -> Character:
    """The hips turn a quarter and rise in half a second, keyed unevenly."""
    return Character().animate(
        "Turn",
        (2, "rotation", [0.0, 0.1, 0.5], [[0, 0, 0, 1], [0, np.sin(np.pi / 20), 0, np.cos(np.pi / 20)], QUARTER]),
        (2, "translation", [0.0, 0.5], [[0, 2, 0], [0, 3, 0]]),
    )


def test_every_animation_is_a_clip_and_what_only_steers_is_left_out(tmp_path):
    character = turning().animate("Nod", (3, "rotation", [0.0, 1.0], [[0, 0, 0, 1], QUARTER]))
    turn, nod = character.read(tmp_path)
    assert (turn.name, nod.name) == ("Turn", "Nod")
    assert turn.bones.names == ("hips", "leg.l", "foot.l", "leg.r")
    assert any("1 nodes left out" in note for note in turn.notes)


def test_sizes_and_places_above_the_hips_go_into_the_path(tmp_path):
    (clip,) = turning().read(tmp_path)
    np.testing.assert_allclose(clip.root_positions[[0, -1]], np.array([[1, 1, 0], [1, 1.5, 0]]), atol=1e-6)
    foot = clip.joint_positions()[:, clip.bones.index("foot.l")]
    np.testing.assert_allclose(foot[0], [1.1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(foot[-1], [1, 0.5, -0.1], atol=1e-6)


def test_uneven_keys_are_resampled_along_the_arc(tmp_path):
    (clip,) = turning().read(tmp_path)
    middle = clip.local_rotations[np.abs(np.arange(len(clip)) / clip.fps - 0.25).argmin(), 0]
    seconds = np.abs(np.arange(len(clip)) / clip.fps - 0.25).argmin() / clip.fps
    assert 2 * np.arctan2(middle[1], middle[3]) == pytest.approx(seconds * np.pi, abs=1e-6)


def test_stepped_keys_stay_until_the_next(tmp_path):
    times, values = np.arange(4) / 10, np.array([[0, 0, 0, 1], QUARTER, QUARTER, [0, 0, 0, 1]])
    character = Character().animate("Step", (2, "rotation", times, values), interpolation="STEP")
    character.animate("Long", (2, "rotation", [0.0, 0.95], [[0, 0, 0, 1], QUARTER]), interpolation="STEP")
    step, long = character.read(tmp_path)
    assert step.fps == 10.0
    np.testing.assert_allclose(step.local_rotations[:, 0], values, atol=1e-6)
    assert (long.local_rotations[:-1, 0] == [0, 0, 0, 1]).all()


def test_smooth_curves_are_read_at_their_keys(tmp_path):
    values = [[9, 9, 9], [0, 2, 0], [9, 9, 9], [9, 9, 9], [0, 3, 0], [9, 9, 9]]
    character = Character().animate("Curve", (2, "translation", [0.0, 1.0], values), interpolation="CUBICSPLINE")
    (clip,) = character.read(tmp_path)
    np.testing.assert_allclose(clip.root_positions[[0, -1], 1], [1, 1.5], atol=1e-6)


def test_bones_keep_their_length_and_that_is_said(tmp_path):
    (clip,) = Character().animate("Grow", (5, "translation", [0, 1], [[0, -2, 0], [0, -3, 0]])).read(tmp_path)
    np.testing.assert_allclose(clip.joint_positions()[:, 2, 1], 0.0, atol=1e-6)
    assert any("translations of 1 bones dropped" in note for note in clip.notes)


def test_a_pose_is_held_for_two_frames(tmp_path):
    (clip,) = Character().animate("Pose", (2, "rotation", [0.0], [QUARTER])).read(tmp_path)
    assert len(clip) == 2
    assert "a pose, held for two frames" in clip.notes


def change(character: Character, *path, value) -> Character:
    place: Any = character.json
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    return character


@pytest.mark.parametrize(
    ("path", "value", "fault"),
    [
        (("animations",), [], "0 animations"),
        (("skins",), [], "skins"),
        (("nodes", 5, "children"), [2], "two parents"),
        (("nodes", 5, "children"), [99], "nodes"),
        (("nodes", 1, "children"), [6], "2 root bones"),
        (("nodes", 0, "scale"), [1, 2, 1], "scaled by"),
        (("nodes", 2, "matrix"), [1.0] * 16, "matrix"),
        (("nodes", 3, "rotation"), [0, 0, 0, 0], "unit quaternion"),
        (("skins", 0, "joints"), [1, 1], "each once"),
        (("skins", 0, "joints"), [2, 3, 5, 4, 99], "nodes"),
        (("animations", 0, "channels", 0, "sampler"), 7, "sampler 7"),
        (("animations", 0, "channels", 0, "target"), None, "without target"),
        (("animations", 0, "samplers", 0, "output"), 0, "VEC4"),
        (("animations", 0, "channels"), [], "moves no bone"),
        (("accessors", 0, "count"), 2, "2 key times for 3"),
        (("accessors", 0, "count"), 1 << 30, "cut off"),
        (("bufferViews", 0, "buffer"), 3, "buffers"),
    ],
)
def test_a_broken_character_says_what_is_wrong(tmp_path, path, value, fault):
    character = change(turning(), *path, value=value)
    with pytest.raises(ClipError, match=fault):
        character.read(tmp_path)


@pytest.mark.parametrize(
    ("times", "values", "fault"),
    [
        ([0.0, 0.5, 0.1], [QUARTER] * 3, "order of time"),
        ([0.0, 0.5], [QUARTER, [np.nan] * 4], "not finite"),
        ([0.0, 1e6], [QUARTER, QUARTER], "frames between"),
        ([0.0, np.inf], [QUARTER, QUARTER], "not finite"),
        ([0.0, 1.0], [QUARTER, [0, 0, 0, 0]], "unit quaternion"),
    ],
)
def test_broken_keys_say_what_is_wrong(tmp_path, times, values, fault):
    with pytest.raises(ClipError, match=fault):
        Character().animate("Odd", (2, "rotation", times, values)).read(tmp_path)
