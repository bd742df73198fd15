"""A GLB says what the motion says, and the Khronos validator has nothing against it."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_motions import standing_still, tumbling

from motion_backend import rotations
from motion_backend.body.cast import Role
from motion_backend.formats.glb_film import body_glb, film_glb, meshes_to_glb, props_glb, scene_glb
from motion_backend.formats.glb_props import lanes, prop_keys
from motion_backend.formats.gltf_document import read_glb
from motion_backend.motion import Emotion, Motion, Skill
from motion_backend.props import PropTrack, prop_tracks
from motion_backend.skeleton import INDEX
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Placed

RUNNER = Path(__file__).parent / "gltf_validate.mjs"
VALIDATOR = Path(__file__).parents[2] / "gltf" / "node_modules" / "gltf-validator"
TYPES = {5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


@dataclass(frozen=True)
class Slab:
    name: str
    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]
    color: tuple[float, float, float, float] = (0.5, 0.4, 0.3, 1.0)
    roughness: float = 0.8


HOME = home_from_layouts([Layout("room", "bedroom", ((0, 0), (0, 4), (4, 4), (4, 0)))], 0)
NODE = "prop_phone_0"


def slab(name: str, height: float, alpha: float = 1.0) -> Slab:
    corners = np.array([[0, height, 0], [0, height, 1], [1, height, 1], [1, height, 0]], dtype=np.float32)
    return Slab(name, corners, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), (0.5, 0.4, 0.3, alpha))


def accessor(document, binary: bytes, index: int):
    part = document["accessors"][index]
    view = document["bufferViews"][part["bufferView"]]
    count = part["count"] * WIDTHS[part["type"]]
    values = np.frombuffer(binary, TYPES[part["componentType"]], count, view["byteOffset"])
    values = values.reshape(part["count"], -1)
    return values / np.iinfo(values.dtype).max if part.get("normalized") else values


def played(document, binary: bytes, frame: int):
    """World positions of the joints at a frame, by walking the nodes as a viewer does."""
    nodes = document["nodes"]
    local = {
        i: (np.array(n.get("translation", (0, 0, 0))), np.array(n.get("rotation", (0, 0, 0, 1))))
        for i, n in enumerate(nodes)
    }
    animation = document["animations"][0]
    for channel in animation["channels"]:
        node, path = channel["target"]["node"], channel["target"]["path"]
        if node not in document["skins"][0]["joints"]:
            continue
        value = accessor(document, binary, animation["samplers"][channel["sampler"]]["output"])[frame]
        shift, turn = local[node]
        local[node] = (value, turn) if path == "translation" else (shift, value)
    world = {}

    def walk(node: int, position, turn):
        shift, own = local[node]
        world[nodes[node]["name"]] = position + rotations.rotate(turn, shift)
        for child in nodes[node].get("children", []):
            walk(child, world[nodes[node]["name"]], rotations.compose(turn, own))

    walk(document["skins"][0]["joints"][0], np.zeros(3), rotations.IDENTITY)
    return world


def test_a_viewer_plays_the_joints_where_the_motion_has_them():
    motion = tumbling(20)
    document, binary = read_glb(body_glb(motion))
    for frame in (0, 7, 19):
        world = played(document, binary, frame)
        for joint, name in enumerate(motion.skeleton.names):
            np.testing.assert_allclose(world[name], motion.joint_positions()[frame, joint], atol=2e-4)


def test_sixteen_bits_of_turn_move_no_joint_by_a_fifth_of_a_millimetre():
    motion = tumbling(300, seed=1)
    document, binary = read_glb(body_glb(motion))
    turns = np.tile(rotations.IDENTITY, (300, 22, 1))
    nodes, animation = document["skins"][0]["joints"], document["animations"][0]
    for channel in animation["channels"]:
        if channel["target"]["path"] == "rotation":
            output = animation["samplers"][channel["sampler"]]["output"]
            turns[:, nodes.index(channel["target"]["node"])] = accessor(document, binary, output)
    again, _ = motion.skeleton.forward_kinematics(motion.root_positions, rotations.normalize(turns))
    assert np.abs(again - motion.joint_positions()).max() < 2e-4


def test_weights_in_the_file_sum_to_one_and_name_no_joint_for_nothing():
    document, binary = read_glb(body_glb(tumbling(2)))
    for primitive in document["meshes"][0]["primitives"]:
        shares = accessor(document, binary, primitive["attributes"]["WEIGHTS_0"])
        holders = accessor(document, binary, primitive["attributes"]["JOINTS_0"])
        np.testing.assert_allclose(shares.sum(axis=1), 1.0, atol=1e-9)
        assert (holders[shares == 0] == 0).all()


def test_rotations_never_jump_to_the_other_hemisphere():
    motion = tumbling(60)
    motion.local_rotations[::2] *= -1
    document, binary = read_glb(body_glb(motion))
    animation = document["animations"][0]
    for channel in animation["channels"]:
        if channel["target"]["path"] == "rotation":
            turns = accessor(document, binary, animation["samplers"][channel["sampler"]]["output"])
            assert (np.sum(turns[1:] * turns[:-1], axis=1) > 0).all()


def test_bind_matrices_undo_the_rest_pose():
    motion = tumbling(3, height=1.6)
    document, binary = read_glb(body_glb(motion))
    matrices = accessor(document, binary, document["skins"][0]["inverseBindMatrices"]).reshape(-1, 4, 4)
    np.testing.assert_allclose(matrices[:, 3, :3], -motion.skeleton.rest_positions, atol=1e-6)
    np.testing.assert_array_equal(matrices[:, :, 3], np.tile([0, 0, 0, 1], (22, 1)))


def test_the_animation_tells_when_each_keyframe_is_served():
    document, _ = read_glb(body_glb(tumbling(40)))
    spans = document["animations"][0]["extras"]["keyframes"]
    assert [span["keyframe"] for span in spans] == [0, 1, 2, 3]
    assert [span["start"] for span in spans[1:]] == [span["end"] for span in spans[:-1]]


def test_still_meshes_of_one_look_are_merged_and_walls_kept_apart():
    meshes = [slab("wall 1", 1), slab("wall 2", 2), slab("sofa", 0.4), slab("bed", 0.5), slab("window glass", 1.5, 0.3)]
    document, _ = read_glb(meshes_to_glb(meshes))
    assert [node["name"] for node in document["nodes"]] == ["wall", "furniture", "window"]
    assert [len(mesh["primitives"]) for mesh in document["meshes"]] == [1, 1, 1]
    assert [m.get("alphaMode") for m in document["materials"]] == [None, "BLEND"]


def test_a_minute_of_body_is_small():
    assert len(body_glb(tumbling(60 * 30))) < 800_000


def holding(frames: int = 60) -> tuple[Motion, Role]:
    """Somebody whose right hand goes to the ear and down again, said to be on the phone all the time."""
    motion = standing_still(frames)
    turns = motion.local_rotations.copy()
    share = np.clip(1.5 * np.sin(np.pi * np.linspace(0, 1, frames)), 0, 1)[:, None]
    hang, bent = np.array([0.0, 0.0, 1.35]), np.array([0.0, 2.3, 0.0])
    turns[:, INDEX["right_shoulder"]] = rotations.rotvec_to_quat((1 - 0.75 * share) * hang)
    turns[:, INDEX["right_elbow"]] = rotations.rotvec_to_quat(share * bent)
    said = {0: (Skill.LOCO, "walk while talking on the phone with the right hand")}
    return replace(motion, local_rotations=turns.astype(np.float32)), Role(captions=said)


def animated(document, binary: bytes, name: str, path: str):
    """The times and values of what a node does."""
    animation, nodes = document["animations"][0], document["nodes"]
    for channel in animation["channels"]:
        if nodes[channel["target"]["node"]]["name"] == name and channel["target"]["path"] == path:
            sampler = animation["samplers"][channel["sampler"]]
            return accessor(document, binary, sampler["input"])[:, 0], accessor(document, binary, sampler["output"])
    raise AssertionError(f"{name} has no {path}")


def test_a_prop_is_a_node_where_its_track_has_it_and_of_no_size_elsewhere():
    motion, role = holding()
    frames = np.arange(len(motion))
    keyframes = np.where(frames < 3, 7, np.where(frames < len(motion) - 3, motion.actions, 8)).astype(np.int32)
    motion = replace(motion, actions=keyframes)  # in whose first and last frames nothing is held
    (track,) = prop_tracks(motion, role)
    assert 0 < track.start < track.stop < len(motion)
    for data in (film_glb(HOME, motion, role), props_glb(motion, role)):
        document, binary = read_glb(data)
        frames = np.arange(len(motion))
        there = (frames >= track.start) & (frames < track.stop)
        keyed, sizes = animated(document, binary, NODE, "scale")
        assert (sizes == sizes[:, :1]).all()
        scale = np.interp(frames / motion.fps, keyed, sizes[:, 0])
        np.testing.assert_allclose(scale[there], track.sizes, atol=5e-3)
        np.testing.assert_allclose(scale[~there], 0.0, atol=1e-6)
        times, places = animated(document, binary, NODE, "translation")
        between = [np.interp(frames[there] / motion.fps, times, places[:, axis]) for axis in range(3)]
        np.testing.assert_allclose(np.transpose(between), track.positions, atol=1e-5)
        keys = np.rint(times * motion.fps).astype(int)
        inside = np.isin(keys, frames[there])
        _, turns = animated(document, binary, NODE, "rotation")
        own = track.turns[keys[inside] - track.start]
        np.testing.assert_allclose(np.abs(np.sum(turns[inside] * own, axis=1)), 1.0, atol=1e-4)


def test_props_change_nothing_of_the_body_and_a_body_alone_has_none():
    motion, role = holding()
    bare, whole = (read_glb(film_glb(HOME, motion, one)) for one in (Role(), role))
    for frame in (0, 30):
        for name, place in played(*bare, frame).items():
            np.testing.assert_array_equal(played(*whole, frame)[name], place)
    names = [[node["name"] for node in document["nodes"]] for document, _ in (bare, whole)]
    assert names[1] == [*names[0], NODE]
    assert body_glb(motion, role) == body_glb(motion)
    assert props_glb(motion, Role()) == b""


def test_what_comes_again_is_the_same_node_and_two_at_once_are_two():
    def track(prop: str, start: int, frames: int) -> PropTrack:
        turns = np.tile(rotations.IDENTITY, (frames, 1))
        return PropTrack(prop, start, np.zeros((frames, 3)), turns, np.ones(frames))

    found = lanes([track("cup", 50, 10), track("cup", 0, 20), track("phone", 5, 9), track("cup", 10, 20)])
    assert [[(one.prop, one.start) for one in lane] for lane in found] == [
        [("cup", 0), ("cup", 50)], [("phone", 5)], [("cup", 10)],
    ]  # fmt: skip


def test_what_lies_there_all_the_time_has_two_keys():
    turns = np.tile(rotations.IDENTITY, (900, 1))
    lying = PropTrack("book", 0, np.zeros((900, 3)), turns, np.ones(900))
    frames, *_ = prop_keys([lying], 900)
    assert frames.tolist() == [0, 899]
    later = PropTrack("book", 100, np.zeros((300, 3)), turns[:300], np.ones(300))
    frames, _, _, sizes = prop_keys([later], 900)
    assert (frames.tolist(), sizes.tolist()) == ([99, 100, 399, 400], [0.0, 1.0, 1.0, 0.0])


def test_the_same_film_with_props_has_the_same_bytes():
    motion, role = holding()
    assert film_glb(HOME, motion, role) == film_glb(HOME, motion, role)
    assert props_glb(motion, role) == props_glb(motion, role)


@pytest.mark.service
@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
@pytest.mark.skipif(not VALIDATOR.is_dir(), reason="the glTF validator is not installed: npm ci in tests/gltf")
def test_the_khronos_validator_has_nothing_to_say(tmp_path):
    (tmp_path / "body.glb").write_bytes(body_glb(tumbling(30)))
    (tmp_path / "held.glb").write_bytes(props_glb(*holding()))
    (tmp_path / "scene.glb").write_bytes(meshes_to_glb([slab("floor", 0), slab("sofa", 0.4), slab("window", 1, 0.3)]))
    paths = sorted(str(p) for p in tmp_path.glob("*.glb"))
    done = subprocess.run(["node", str(RUNNER), *paths], capture_output=True, text=True, check=True, timeout=60)
    reports = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(reports) == 3
    assert [report["issues"]["messages"] for report in reports] == [[], [], []]


def test_other_bytes_are_not_taken_for_a_glb():
    with pytest.raises(ValueError, match="glTF"):
        read_glb(b"PK" + b"\0" * 40)


def test_a_film_holds_the_home_and_the_body():
    bed = Placed("bed", "double_bed", (2.0, 0.0, 1.1), (1.6, 0.9, 2.0))
    layout = Layout("room", "bedroom", ((0, 0), (0, 4), (4, 4), (4, 0)), objects=(bed,))
    home = home_from_layouts([layout], 0)
    document, _ = read_glb(film_glb(home, tumbling(5)))
    roots = [document["nodes"][index]["name"] for index in document["scenes"][0]["nodes"]]
    assert {"floor", "wall", "furniture", "body", "pelvis"} <= set(roots)
    still, _ = read_glb(scene_glb(home))
    assert "animations" not in still
    assert {node["name"] for node in still["nodes"]} < set(roots)


def test_the_face_feels_and_blinks_in_any_player() -> None:
    """Morph targets by name, animated: a smile where the keyframe is happy, lids that shut now and then."""
    motion = tumbling(300)
    document, binary = read_glb(body_glb(motion, Role(emotions={int(motion.actions[-1]): Emotion.HAPPY})))
    (mesh,) = [mesh for mesh in document["meshes"] if mesh["name"] == "face"]
    names = mesh["extras"]["targetNames"]
    assert all(len(primitive["targets"]) == len(names) for primitive in mesh["primitives"])
    assert set(mesh["extras"]["expressions"]) == set(Emotion)
    (animation,) = document["animations"]
    (channel,) = [one for one in animation["channels"] if one["target"]["path"] == "weights"]
    assert document["nodes"][channel["target"]["node"]]["name"] == "face"
    sampler = animation["samplers"][channel["sampler"]]
    times, shares = (document["accessors"][sampler[key]] for key in ("input", "output"))
    assert shares["count"] == times["count"] * len(names)
    view = document["bufferViews"][shares["bufferView"]]
    row = np.frombuffer(binary, np.int16, shares["count"], view.get("byteOffset", 0)).reshape(-1, len(names)) / 32767
    assert row[-1, names.index("smile")] > 0.9
    assert row[:, names.index("lids_down")].max() > 0.95
    still = document["accessors"][mesh["primitives"][0]["targets"][names.index("smile")]["POSITION"]]
    assert "bufferView" not in still, "what does not move takes no room"
