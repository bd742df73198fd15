"""Collections of clips: kept exactly enough, in the same bytes, split by subject, multiplied without lying about it."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sample_motions import tumbling

from motion_backend import rotations
from motion_backend.clips.augmenting import change_speed, mirror, mirror_words, reverse
from motion_backend.clips.building import Kept, Unread, collect, folder_labels, motion_files, read_folder
from motion_backend.clips.clip import ClipError
from motion_backend.clips.dataset import Dataset, Entry, dataset_bytes, read_dataset, splits
from motion_backend.clips.labels import label_of, read_labels, subject_of
from motion_backend.clips.wording import WAYS, skill_of, ways_to_say
from motion_backend.formats.bvh import write_bvh
from motion_backend.skeleton import INDEX


def entry(name: str = "one", subject: str = "a", skill: str = "getup", seed: int = 0, frames: int = 40) -> Entry:
    motion = replace(tumbling(frames, seed), goals=(), completed=True, reason="")
    return Entry(
        name, skill, "slow", "tired", ("the left hand", "b", "c", "d", "e"), subject, "real mocap", "ours", "here", (),
        "train", motion, np.random.default_rng(seed).random((frames, 2)) > 0.5,
    )  # fmt: skip


def kept(dataset: Dataset, folder: Path) -> Dataset:
    path = folder / "kept.npz"
    path.write_bytes(dataset_bytes(dataset))
    return read_dataset(path)


def test_a_collection_comes_back_to_within_a_hundredth_of_a_degree(tmp_path: Path) -> None:
    given_ = collect([entry(seed=seed, name=str(seed), subject=str(seed)) for seed in range(3)])
    found = kept(given_, tmp_path)
    for one, other in zip(given_.entries, found.entries, strict=True):
        a, b = (rotations.normalize(entry.motion.local_rotations.astype(float)) for entry in (one, other))
        chord = np.minimum(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))
        assert np.degrees(4 * np.arcsin(chord / 2)).max() < 0.006
        apart = np.abs(one.motion.joint_positions() - other.motion.joint_positions()).max()
        assert apart < 2e-4
        assert (one.motion.root_positions == other.motion.root_positions).all()
        assert (one.motion.contacts == other.motion.contacts).all()
        assert (one.hands == other.hands).all()
        assert (one.captions, one.split, one.skill) == (other.captions, other.split, other.skill)


def test_the_same_clips_give_the_same_bytes_and_read_back_so(tmp_path: Path) -> None:
    dataset = collect([entry(), entry("two", "b", seed=1)])
    assert dataset_bytes(dataset) == dataset_bytes(dataset)
    assert len(kept(dataset, tmp_path).entries) == 2


@settings(deadline=None, max_examples=40)
@given(data=st.data())
def test_a_damaged_collection_is_refused_in_one_way(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    content = bytearray(dataset_bytes(Dataset(tumbling().skeleton, (entry(frames=4),))))
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.mktemp("damaged") / "x.npz"
    path.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    try:
        read_dataset(path)
    except ClipError as error:
        assert "x.npz" in str(error)  # noqa: PT017


def test_an_array_that_claims_to_be_huge_is_refused_unread(tmp_path: Path) -> None:
    whole = dataset_bytes(collect([entry()]))
    source, path = tmp_path / "a.npz", tmp_path / "b.npz"
    source.write_bytes(whole)
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name.startswith("local"):
                content = content.replace(b"(40, 22, 4), }     ", b"(9999999, 22, 4), }")
            new.writestr(name, content)
    with pytest.raises(ClipError, match="size"):
        read_dataset(path)


def test_mirroring_twice_is_no_change_and_once_swaps_hands() -> None:
    motion = tumbling()
    twice = mirror(mirror(motion))
    np.testing.assert_array_equal(twice.local_rotations, motion.local_rotations)
    there, here = mirror(motion).joint_positions(), motion.joint_positions()
    np.testing.assert_allclose(there[:, INDEX["left_wrist"]], here[:, INDEX["right_wrist"]] * [-1, 1, 1], atol=1e-5)
    np.testing.assert_allclose(there[:, INDEX["head"]], here[:, INDEX["head"]] * [-1, 1, 1], atol=1e-5)


@given(st.text(alphabet="LEFTRIGHTleftright -,", max_size=40))
def test_mirrored_words_mirrored_are_the_words(text: str) -> None:
    for word in ("left", "right", "Left-hand and RIGHT foot", text.lower()):
        assert mirror_words(mirror_words(word)) == word


def test_only_sides_are_swapped_in_words() -> None:
    assert mirror_words("Left hand up, right down; bright, all right") == "Right hand up, left down; bright, all right"


def test_reversed_and_sped_motions_show_the_same_poses() -> None:
    motion = tumbling(41)
    assert (reverse(reverse(motion)).root_positions == motion.root_positions).all()
    fast = change_speed(motion, 1.25)
    assert len(fast) == 33
    np.testing.assert_allclose(fast.root_positions[[0, -1]], motion.root_positions[[0, -1]], atol=1e-6)
    with pytest.raises(ValueError, match="times as fast"):
        change_speed(motion, 3.0)


def test_no_subject_is_on_both_sides_and_copies_stay_with_their_clip() -> None:
    entries = [entry(f"{subject}{trial}", subject, seed=trial) for subject in "abcdefgh" for trial in range(2)]
    dataset = collect(entries, mirrored=True, reversed_too=True, speeds=(0.9,))
    sides: dict[str, set[str]] = {}
    for one in dataset.entries:
        sides.setdefault(one.subject, set()).add(one.split)
    assert all(len(side) == 1 for side in sides.values())
    assert {side for some in sides.values() for side in some} == {"train", "test"}
    assert len(dataset.entries) == 16 * 2 * 2 * 2
    assert {one.skill for one in dataset.entries if "reversed" in one.changed} == {"liedown"}
    assert all(one.captions[0] == "the right hand" for one in dataset.entries if one.changed == ("mirrored",))
    assert len({one.name for one in dataset.entries}) == len(dataset.entries)


@given(st.dictionaries(st.text(min_size=1, max_size=6), st.integers(1, 1000), min_size=1, max_size=30))
def test_a_split_leaves_something_to_train_on(frames: dict[str, int]) -> None:
    sides = splits(list(frames.items()))
    assert "train" in sides.values()
    tested = sum(count for subject, count in frames.items() if sides[subject] == "test")
    assert tested <= 0.25 * sum(frames.values())


def test_captions_are_five_and_different_for_every_skill() -> None:
    for skill in ("loco", "sitdown", "standup", "liedown", "getup", "touch", "squat", "idle", "other"):
        for style, own in (
            ("neutral", ""),
            ("slow", "a person does: slow walk"),
            ("zombie", "a person staggers"),
            ("", ""),
        ):
            said = ways_to_say(skill, style, own)
            assert len(set(said)) == WAYS, (skill, style, said)
            assert not any(words.startswith("a person does:") for words in said)


@pytest.mark.parametrize(
    ("name", "skill"),
    [
        ("Lie_StandUp", "getup"), ("Lie_Down", "liedown"), ("Sit_Chair_StandUp", "standup"),
        ("Sitting_Enter", "sitdown"), ("Sitting_Exit", "standup"), ("PickUp_Table", "touch"),
        ("Walk_Formal_Loop", "loco"), ("humanoid3d_run", "loco"), ("Head Nod", "idle"), ("Spellcasting", "other"),
    ],
)  # fmt: skip
def test_names_tell_skills(name: str, skill: str) -> None:
    assert skill_of(name) == skill


def test_a_table_of_labels_is_read_and_its_faults_are_named(tmp_path: Path) -> None:
    table = tmp_path / "labels.csv"
    table.write_text("file,skill,caption\na.bvh,touch,she waves\n")
    found = label_of(read_labels(table), "a.bvh", "a")
    assert (found.skill, found.caption) == ("touch", "she waves")
    for text, says in (("name\nx\n", "file"), ("file,skill\na\n", "line 2"), ("file\n\xff", "not a table")):
        table.write_bytes(text.encode("latin-1"))
        with pytest.raises(ClipError, match=says):
            read_labels(table)


def test_trials_of_one_subject_are_of_one_subject() -> None:
    assert subject_of("cmu/35_01.bvh") == subject_of("cmu/35_30.bvh") != subject_of("cmu/07_01.bvh")
    assert subject_of("a/walk.txt") == subject_of("a/run.txt") != subject_of("b/run.txt")


def test_a_folder_is_read_clip_by_clip_and_what_cannot_be_is_told(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    write_bvh(tumbling(), tmp_path / "sub" / "01_02.bvh")
    (tmp_path / "broken.bvh").write_text("HIERARCHY")
    found = list(read_folder(tmp_path, folder_labels(tmp_path)))
    assert [type(one) for one in found] == [Unread, Kept]
    assert isinstance(found[1], Kept)
    assert found[1].entry.subject == "trial subject 1"
    json.dumps(found[1].report.to_dict(), allow_nan=False)


def test_a_folder_without_motion_says_so(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="no motion file"):
        motion_files(tmp_path, {})
    with pytest.raises(ClipError, match="no clip was accepted"):
        collect([])
