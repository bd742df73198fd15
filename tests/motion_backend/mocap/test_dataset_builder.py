"""Collections of clips: kept exactly enough, in the same bytes, split by subject, multiplied without lying about it."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from sample_motions import tumbling

from motion_backend import rotations
from motion_backend.datasets.splits import splits
from motion_backend.formats.bvh import write_bvh
from motion_backend.mocap.augmentation import change_speed, mirror, mirror_words, reverse
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.clip_captions import WAYS, labels_of, read_labels, skill_of, subject_of, ways_to_say
from motion_backend.mocap.dataset_builder import Kept, Unread, collect, folder_labels, motion_files, read_folder
from motion_backend.mocap.dataset_file import Dataset, Entry, dataset_bytes, read_dataset
from motion_backend.mocap.near_duplicates import Copy, joined_subjects, near_copies
from motion_backend.mocap.readers import read_clips
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


@tries(40)
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


def rewritten(tmp_path: Path, **changed: object) -> Path:
    """A collection of one clip with other arrays, or other values in its manifest."""
    source, path = tmp_path / "whole.npz", tmp_path / "changed.npz"
    source.write_bytes(dataset_bytes(collect([entry()])))
    with np.load(source) as whole:
        arrays = dict(whole)
    manifest = json.loads(arrays["manifest"].tobytes())
    for name, value in changed.items():
        if name in arrays:
            arrays[name] = value
        else:
            (manifest if name in manifest else manifest["clips"][0])[name] = value
    arrays["manifest"] = np.frombuffer(json.dumps(manifest).encode(), dtype=np.uint8)
    np.savez(path, **arrays)
    return path


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"captions": []}, "captions"),
        ({"captions": "walks"}, "captions"),
        ({"clips": []}, "starts"),
        ({"offsets": [[float("nan")] * 3] * 22}, "offset"),
        ({"offsets": [[1e300] * 3] * 22}, "offset"),
        ({"root_positions": np.full((40, 3), 1e30, np.float32)}, "root"),
        ({"local_rotations": np.zeros((40, 22, 4), np.int16)}, "rotation"),
        ({"starts": np.array([0, 40], np.uint64)}, "starts"),
        ({"starts": np.array([0.0, 40.0])}, "starts"),
    ],
)
def test_a_collection_with_values_that_nobody_could_draw_is_refused(
    tmp_path: Path, changed: dict[str, object], says: str
) -> None:
    assert read_dataset(rewritten(tmp_path, style="as written")).entries[0].style == "as written"
    with pytest.raises(ClipError, match=f"changed.npz: .*{says}"):
        read_dataset(rewritten(tmp_path, **changed))


def test_names_that_are_not_utf_8_are_kept(tmp_path: Path) -> None:
    (found,) = kept(collect([entry("caf\udce9.bvh")]), tmp_path).entries
    assert found.name == "caf\udce9.bvh"


def test_every_skill_is_shown_by_its_longest_recorded_clip() -> None:
    changed = replace(entry("changed", frames=60), changed=("mirrored",))
    other = replace(entry("other", skill="sit"), changed=("mirrored",))
    dataset = Dataset(entry().motion.skeleton, (entry("short", frames=20), entry("long"), changed, other))
    assert [one.name for one in dataset.of_every_skill()] == ["long", "other"]


def test_hidden_files_are_left_alone_and_clips_of_one_name_are_told_apart(tmp_path: Path) -> None:
    for name in ("._a.bvh", ".git/b.bvh", "a.bvh"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        write_bvh(tumbling(40), tmp_path / name)
    assert motion_files(tmp_path, {}) == ["a.bvh"]
    with pytest.MonkeyPatch.context() as patch:
        (clip,) = read_clips(tmp_path / "a.bvh")
        patch.setattr("motion_backend.mocap.dataset_builder.read_clips", lambda *_, **__: (clip, clip))
        names = [one.entry.name if isinstance(one, Kept) else one.name for one in read_folder(tmp_path, {})]
    assert names == ["a.bvh#a", "a.bvh#a (2)"]


def test_a_file_that_only_the_table_knows_is_told(tmp_path: Path) -> None:
    write_bvh(tumbling(40), tmp_path / "a.bvh")
    (tmp_path / "manifest.csv").write_text("file,kind\na.bvh,\nb.bvh,\nc.txt,licence\n")
    lost = [one for one in read_folder(tmp_path, folder_labels(tmp_path)) if isinstance(one, Unread)]
    assert [one.name for one in lost] == ["b.bvh"]


@pytest.mark.parametrize(("table", "says"), [("file,file\na,b\n", "twice"), ("file\na.bvh\na.bvh\n", "line 3")])
def test_a_table_that_says_something_twice_is_refused(tmp_path: Path, table: str, says: str) -> None:
    (tmp_path / "t.csv").write_text(table)
    with pytest.raises(ClipError, match=says):
        read_labels(tmp_path / "t.csv")


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


@for_each(
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
    (found,) = labels_of(read_labels(table), "a.bvh", "a")
    assert (found.skill, found.caption) == ("touch", "she waves")
    for text, says in (("name\nx\n", "file"), ("file,skill\na\n", "line 2"), ("file\n\xff", "not a table")):
        table.write_bytes(text.encode("latin-1"))
        with pytest.raises(ClipError, match=says):
            read_labels(table)


def test_rows_with_seconds_are_clips_of_their_own(tmp_path: Path) -> None:
    write_bvh(tumbling(61), tmp_path / "a.bvh")
    table = tmp_path / "manifest.csv"
    table.write_text(
        "file,skill,start,stop,caption\na.bvh,touch,,0.5,she waves\na.bvh,squat,0.5,9,\na.bvh,idle,,,\na.bvh,idle,7,,\n"
    )
    found = list(read_folder(tmp_path, folder_labels(tmp_path)))
    clips = [one.entry for one in found if isinstance(one, Kept)]
    told = [(one.name, one.skill, one.captions[0], len(one.motion)) for one in clips]
    assert told[0] == ("a.bvh@0-0.5", "touch", "she waves", 15)
    assert told[1][:2] == ("a.bvh@0.5-9", "squat")
    assert told[2][:2] == ("a.bvh", "idle")
    assert told[1][3] + 15 == told[2][3]
    (lost,) = (one for one in found if isinstance(one, Unread))
    assert lost.name.startswith("a.bvh@7-")
    assert "lasts 2.0 s" in lost.why


@pytest.mark.parametrize("cells", ["2,1", "-1,", "a,", "nan,", ",inf", "1,1"])
def test_seconds_that_are_no_segment_are_named_with_their_line(tmp_path: Path, cells: str) -> None:
    table = tmp_path / "labels.csv"
    table.write_text(f"file,start,stop\na.bvh,{cells}\n")
    with pytest.raises(ClipError, match=r"labels\.csv, line 2: .*(segment|seconds)"):
        read_labels(table)


def test_an_excerpt_of_another_subject_is_found_and_kept_on_its_side() -> None:
    whole = [entry(f"whole{seed}", f"s{seed}", seed=seed, frames=90) for seed in range(6)]
    cut = replace(entry("cut", "another"), motion=whole[2].motion.part(31, 71), hands=whole[2].hands[31:71])
    (copy,) = near_copies([*whole, cut])
    assert (copy.clip, copy.of, copy.start) == ("cut", "whole2", 31)
    assert copy.degrees < 0.1
    for second in ("another", "zz"):
        copies = near_copies([*whole, replace(cut, subject=second)])
        sides = {one.name: one.split for one in collect([*whole, replace(cut, subject=second)], copies=copies).entries}
        assert sides["cut"] == sides["whole2"]
    assert near_copies([*whole, replace(cut, subject="s2")]) == []


def test_a_body_that_stands_still_is_no_copy_of_another() -> None:
    frozen = entry(frames=40).motion
    frozen = replace(frozen, local_rotations=frozen.local_rotations[:1].repeat(40, axis=0))
    assert near_copies([replace(entry(name, name), motion=frozen) for name in "ab"]) == []


@given(st.lists(st.tuples(st.sampled_from("abcdef"), st.sampled_from("abcdef")), max_size=8))
def test_subjects_are_joined_however_long_the_chain_of_copies(pairs: list[tuple[str, str]]) -> None:
    group = joined_subjects("abcdef", [Copy("", "", pair, 0.0, 0) for pair in pairs])
    assert all(group[a] == group[b] for a, b in pairs)
    assert all(group[name] == name for name in group.values())
    assert sum(name == first for name, first in group.items()) >= 6 - len({frozenset(pair) for pair in pairs})


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


def test_a_folder_of_more_files_than_may_be_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("motion_backend.mocap.dataset_builder.MAX_FILES", 2)
    for count in range(3):
        (tmp_path / f"{count}.bvh").write_text("")
        if count < 2:
            assert len(motion_files(tmp_path, {})) == count + 1
    with pytest.raises(ClipError, match="holds 3 files, more than 2"):
        motion_files(tmp_path, {})


def test_a_folder_without_motion_says_so(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="no motion file"):
        motion_files(tmp_path, {})
    with pytest.raises(ClipError, match="no clip was accepted"):
        collect([])
