"""`sims clips`: a folder of motion becomes one file, whose contents can be listed and drawn."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from motion_backend import rotations
from motion_backend.formats.bvh import write_bvh
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.dataset_file import read_dataset
from motion_backend.motion import Motion
from motion_backend.skeleton import INDEX, build_skeleton
from planner_service.cli import app
from planner_service.output.story_export import OutputError

SECONDS = 2


def waving() -> Motion:
    """Standing, while the left arm swings."""
    frames, skeleton = SECONDS * 30 + 1, build_skeleton()
    turns = np.tile(rotations.IDENTITY, (frames, 22, 1))
    swing = 0.5 * np.sin(np.linspace(0, 2 * np.pi, frames))
    turns[:, INDEX["left_shoulder"]] = rotations.rotvec_to_quat(np.outer(swing, [0.0, 0.0, 1.0]))
    return Motion(
        root_positions=np.tile([0.0, skeleton.standing_height, 0.0], (frames, 1)).astype(np.float32),
        local_rotations=turns.astype(np.float32),
        contacts=np.ones((frames, 4), dtype=np.float32),
        skeleton=skeleton,
        actions=np.zeros(frames, dtype=np.int32),
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "mocap"
    made.mkdir()
    for subject in ("01", "02"):
        write_bvh(waving(), made / f"{subject}_01.bvh")
    (made / "labels.csv").write_text("file,skill,style,caption\n01_01.bvh,idle,angry,a man waves the left arm\n")
    return made


def run(*words: object) -> Result:
    return CliRunner().invoke(app, ["clips", *map(str, words)], env={"COLUMNS": "200"})


def test_a_folder_is_built_listed_and_drawn(folder: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "clips.npz", tmp_path / "clips.png"
    built = run("build", folder, "--out", out, "--mirror", "--speeds", "0.8", "--labels", folder / "labels.csv")
    assert built.exit_code == 0, built.output
    assert "1 of 1 clips accepted; 4 clips" in built.output
    report = json.loads(Path(f"{out}.report.json").read_text())
    assert report["clips"][0]["accepted"]
    assert report["clips"][0]["frames"] == SECONDS * 30 + 1
    assert "a man waves the right arm" in run("list", out).output
    rows = json.loads(run("list", out, "--json").output)["clips"]
    assert [row["changed"] for row in rows] == [[], ["speed 0.8"], ["mirrored"], ["speed 0.8", "mirrored"]]
    assert {row["emotion"] for row in rows} == {"angry"}
    assert run("sheet", out, "--out", picture).exit_code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert isinstance(run("sheet", out, "--clip", "none", "--out", picture).exception, ClipError)


def test_without_a_table_all_files_are_read_and_the_same_folder_gives_the_same_bytes(
    folder: Path, tmp_path: Path
) -> None:
    for name in ("a.npz", "b.npz"):
        assert run("build", folder, "--out", tmp_path / name).exit_code == 0
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    assert {entry.split for entry in read_dataset(tmp_path / "a.npz").entries} <= {"train", "test"}


def test_a_file_that_cannot_be_read_is_told_and_the_others_are_kept(folder: Path, tmp_path: Path) -> None:
    (folder / "broken.bvh").write_text("HIERARCHY nothing")
    built = run("build", folder, "--out", tmp_path / "a.npz")
    assert built.exit_code == 1
    assert "not read: broken.bvh" in built.output
    assert len(read_dataset(tmp_path / "a.npz").entries) == 2


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--speeds", "fast"], "--speeds"),
        (["--speeds", "0.8,9"], "--speeds"),
        (["--kinds", "keyed"], "no clip was accepted"),
    ],
)
def test_what_a_user_does_wrong_is_one_clear_error(folder: Path, tmp_path: Path, options: list[str], says: str) -> None:
    failed = run("build", folder, "--out", tmp_path / "a.npz", *options)
    assert isinstance(failed.exception, ClipError)
    assert says in str(failed.exception)
    assert not (tmp_path / "a.npz").exists()


@pytest.mark.parametrize("out", ["", "/"])
def test_a_collection_without_a_name_is_refused(folder: Path, out: str) -> None:
    assert isinstance(run("build", folder, "--out", out).exception, OutputError)


def test_recorded_motion_is_never_written_over_but_an_earlier_collection_is(folder: Path) -> None:
    recorded = folder / "01_01.bvh"
    before = recorded.read_bytes()
    refused = run("build", folder, "--out", recorded)
    assert isinstance(refused.exception, OutputError)
    assert recorded.read_bytes() == before
    assert sorted(path.name for path in folder.iterdir()) == ["01_01.bvh", "02_01.bvh", "labels.csv"]
    for _ in range(2):
        assert run("build", folder, "--out", folder / "clips.npz").exit_code == 0
    assert len(read_dataset(folder / "clips.npz").entries) == 2


def test_names_and_words_of_others_reach_the_terminal_as_printable_letters(folder: Path, tmp_path: Path) -> None:
    (folder / "02_01.bvh").rename(folder / "\x1b]0;a\u202e.bvh")
    (folder / "labels.csv").unlink()
    (folder / "01_01.bvh").rename(folder / os.fsdecode(b"caf\xe9.bvh"))
    (folder / "\x1b[31m.bvh").write_text("nothing")
    out = tmp_path / "a.npz"
    built = run("build", folder, "--out", out)
    assert built.exit_code == 1
    told = built.output + run("list", out).output
    assert "\\x1b" in told
    assert all(letter.isprintable() or letter == "\n" for letter in told)
    assert len(json.loads(run("list", out, "--json").output)["clips"]) == 2
    assert len(json.loads(Path(f"{out}.report.json").read_text(encoding="utf-8"))["clips"]) == 2
