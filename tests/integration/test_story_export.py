"""One story by the command line: every file is there, valid, agrees with the others, and comes out the same again."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from encoded import lend
from forking import Forked

from motion_backend.body.scene_collision import Obstacles
from motion_backend.formats.gltf_document import read_glb
from motion_backend.formats.npz import read_npz
from motion_backend.metrics.foot_skate import skate_ratio
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import penetration
from motion_backend.metrics.smoothness import seam_jump
from motion_backend.mocap.readers.bvh_reader import read_bvh
from motion_backend.motion import Action, Skill
from planner_service.output.story_export import FILES
from scene_graphs.home import home_from_dict, home_to_dict

pytestmark = pytest.mark.service
TESTS = Path(__file__).resolve().parents[1]
VALIDATE = TESTS / "motion_backend" / "formats" / "gltf_validate.mjs"
VALIDATOR = TESTS / "gltf" / "node_modules" / "gltf-validator"
THEME = "A person sits down on the sofa and reads a book [with a red cover]."
SMALL = 200_000
"""Bytes a file may have on the disk that fills up: the film has more."""


@dataclass(frozen=True)
class Told:
    """How a command ended, and what it said."""

    returncode: int
    stdout: str
    stderr: str


def sims_story(forked: Forked, root: Path, name: str, seed: int, most: int | None = None) -> Told:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("SIMS_")}
    environment |= {"SIMS_DATA_DIR": str(root / "data"), "OMP_NUM_THREADS": "1"}
    words = ["story", THEME, "--out", str(root / name), "--seed", str(seed), "--name", "Zoë [b]", "--pronouns", "she"]
    code, said, wrong = forked.run(words, root, environment, most)
    return Told(code, said.decode(), wrong.decode())


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("stories")
    lend(folder / "data")
    return folder


@pytest.fixture(scope="module")
def told(root: Path) -> Told:
    """The first run; its folders have to be made."""
    with Forked() as forked:
        return sims_story(forked, root, "deep/first", 7)


@pytest.fixture(scope="module")
def forked() -> Iterator[Forked]:
    """All other runs; with strings hashed otherwise than in the first."""
    with Forked() as forked:
        yield forked


@pytest.fixture(scope="module")
def folder(root: Path, told: Told) -> Path:
    assert told.returncode == 0, told.stderr
    return root / "deep" / "first"


@pytest.fixture(scope="module")
def story(folder: Path) -> dict:
    return json.loads((folder / "story.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def report(folder: Path) -> dict:
    return json.loads((folder / "report.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def motion(folder: Path):
    return read_npz(folder / "motion.npz")


def test_all_seven_files_are_there_and_no_other(folder: Path) -> None:
    assert sorted(bytes_of(folder)) == sorted(FILES)
    assert all(bytes_of(folder).values())


def test_the_command_tells_the_story_and_how_well_it_went(told: Told, story: dict, report: dict) -> None:
    figures = report["motion"]
    assert story["title"] in told.stdout
    assert "Zoë [b]" in told.stdout
    assert f"{figures['reached']} of {figures['keyframes']} moments were done" in told.stdout
    assert "Moved by rules (procedural): no learned model, no simulation." in " ".join(told.stdout.split())
    assert told.stderr == ""


def test_the_home_of_a_story_is_read_back_as_it_was_written(story: dict) -> None:
    home = home_from_dict(story["home"])
    assert home_to_dict(home) == story["home"]
    used = {action["object_id"] for action in story["actions"]} - {None, "floor"}
    assert used
    assert used <= {placed.id for placed in home.objects}


def test_the_spans_of_a_story_point_at_its_keyframes(story: dict) -> None:
    keyframes = range(len(story["script"]["keyframes"]))
    assert story["spans"]
    for span in story["spans"]:
        assert 0 <= span["start"] < span["end"] <= len(story["text"])
        assert set(span["keyframes"]) <= set(keyframes)


def test_the_story_its_report_and_the_motion_agree(story: dict, report: dict, motion) -> None:
    assert len(story["actions"]) == len(story["script"]["keyframes"]) == len(report["keyframes"])
    assert report["motion"]["keyframes"] == len(report["keyframes"])
    assert report["motion"]["reached"] == sum(figure["reached"] for figure in report["keyframes"])
    stops = [action["stop"] for action in story["actions"]]
    assert [action["start"] for action in story["actions"]] == [0, *stops[:-1]]
    assert stops[-1] == story["motion"]["frames"] == len(motion)
    assert report["motion"]["seconds"] == pytest.approx(len(motion) / motion.fps, abs=0.05)
    for field in ("seed", "backend"):
        assert story[field] == report[field]
    assert report["rooms"] == story["rooms"]
    assert report["encoder"] == story["script"]["encoder"]
    assert report["planner"] == story["script"]["planner"] == "rules"


def test_the_figures_of_the_report_are_those_of_the_motion_that_was_written(story: dict, report: dict, motion) -> None:
    assert seam_jump(motion) == pytest.approx(report["motion"]["seam_jump"], abs=2e-3)
    obstacles = Obstacles.of_home(home_from_dict(story["home"]))
    for row, figure in zip(story["actions"], report["keyframes"], strict=True):
        part = motion.part(row["start"], row["stop"])
        body = Kinematics.of(part)
        action = Action(Skill(row["skill"]), row["caption"], row["emotion"], object_id=row["object_id"])
        depth = penetration(body, obstacles, action)
        assert part.duration == pytest.approx(figure["seconds"], abs=0.05)
        assert depth.mean() == pytest.approx(figure["pen_mean"], abs=1e-3)
        assert depth.max() == pytest.approx(figure["pen_max"], abs=2e-3)
        assert skate_ratio(body) == pytest.approx(figure["skate_ratio"], abs=0.02)


def test_another_reader_of_bvh_finds_every_joint_within_a_millimetre(folder: Path, motion) -> None:
    pybvh = pytest.importorskip("pybvh")
    clip = pybvh.read_bvh_file(str(folder / "motion.bvh"))
    theirs = np.asarray(clip.joint_positions()) / 100
    names = list(clip.joint_names)
    ours = motion.joint_positions()
    assert len(theirs) == len(ours)
    for joint, name in enumerate(motion.skeleton.names):
        assert np.abs(theirs[:, names.index(name)] - ours[:, joint]).max() < 1e-3, name


def test_our_reader_of_bvh_finds_the_same_motion(folder: Path, motion) -> None:
    again = read_bvh((folder / "motion.bvh").read_text())
    assert again.fps == pytest.approx(motion.fps, abs=1e-3)
    assert np.abs(again.joint_positions() - motion.joint_positions()).max() < 1e-3


def test_the_body_is_on_the_floor_and_in_the_home(story: dict, motion) -> None:
    home = home_from_dict(story["home"])
    positions = motion.joint_positions()
    assert np.isfinite(positions).all()
    assert positions[..., 1].min() > -0.05
    assert positions[..., 1].max() < 2.6
    assert all(home.room_at((float(x), float(z))) is not None for x, _, z in positions[::10, 0])


def test_the_film_holds_the_body_the_home_and_the_whole_motion(folder: Path, motion) -> None:
    document, _ = read_glb((folder / "film.glb").read_bytes())
    assert len(document["skins"]) == 1
    assert len(document["skins"][0]["joints"]) == len(motion.skeleton.names)
    times = document["accessors"][document["animations"][0]["samplers"][0]["input"]]
    assert times["count"] == len(motion)
    assert times["max"][0] == pytest.approx((len(motion) - 1) / motion.fps, abs=1e-3)


@pytest.mark.skipif(not VALIDATOR.is_dir(), reason="the glTF validator is not installed: npm ci in tests/gltf")
def test_the_khronos_validator_finds_no_fault_in_the_film(folder: Path) -> None:
    command = ["node", str(VALIDATE), str(folder / "film.glb")]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    issues = json.loads(done.stdout)["issues"]
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]


def test_the_storyboard_is_a_picture_with_something_on_it(folder: Path) -> None:
    pixels = matplotlib.image.imread(folder / "storyboard.png")
    height, width, _ = pixels.shape
    assert height > 300
    assert width > 600
    colours = (pixels[..., :3] * 255).astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)
    assert len(np.unique(colours)) > 500
    assert pixels[..., :3].std() > 0.05


def test_story_md_reads_as_a_story(folder: Path, story: dict) -> None:
    text = (folder / "story.md").read_text(encoding="utf-8")
    assert text.startswith(f"# {story['title']}\n")
    assert story["text"] in text.replace("*", "")
    assert text.count("| yes |") + text.count("| **no** |") == len(story["actions"])


@pytest.fixture(scope="module")
def again(forked: Forked, root: Path, folder: Path) -> dict[str, bytes]:
    """The same command into a folder that holds another story and a file of the user's, and another seed elsewhere."""
    second = root / "second"
    shutil.copytree(folder, second)
    for name in FILES:
        (second / name).write_bytes(b"an earlier story")
    (second / "notes.txt").write_text("mine")
    for name, seed in (("second", 7), ("other", 8)):
        assert sims_story(forked, root, name, seed).returncode == 0
    return bytes_of(second)


def test_the_same_command_writes_the_same_bytes(folder: Path, again: dict[str, bytes]) -> None:
    for name, data in bytes_of(folder).items():
        assert again[name] == data, name


def test_an_earlier_story_is_replaced_and_other_files_are_left_alone(again: dict[str, bytes]) -> None:
    assert sorted(again) == sorted([*FILES, "notes.txt"])
    assert again["notes.txt"] == b"mine"


def test_another_seed_is_another_film(folder: Path, root: Path, again: dict[str, bytes]) -> None:
    assert again
    other = bytes_of(root / "other")
    assert all(other[name] != data for name, data in bytes_of(folder).items())


def test_a_disk_that_fills_up_leaves_the_earlier_story_untouched(forked: Forked, root: Path, folder: Path) -> None:
    full = root / "full"
    shutil.copytree(folder, full)
    for failed in (sims_story(forked, root, name, 9, SMALL) for name in ("full", "fresh/story")):
        assert failed.returncode == 2
        assert failed.stderr.startswith("sims: --out: ")
        assert len(failed.stderr.splitlines()) == 1
    assert bytes_of(full) == bytes_of(folder)
    assert not (root / "fresh").exists()
