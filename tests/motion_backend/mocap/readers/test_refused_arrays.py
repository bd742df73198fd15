"""Arrays that are none, lie about their size or are packed oddly are refused, each with its own reason."""

from __future__ import annotations

import io
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each

from motion_backend.mocap import clip, dataset_builder
from motion_backend.mocap.clip import ClipError, make_bones, make_clip
from motion_backend.mocap.dataset_builder import motion_files
from motion_backend.mocap.readers import safe_numpy
from motion_backend.mocap.readers.safe_numpy import npy_header, npz_arrays, npz_names


def npy(header: str, data: bytes = b"", magic: bytes = b"\x93NUMPY\x01\x00") -> bytes:
    """An .npy file whose header says that."""
    text = header.encode("latin-1") + b"\n"
    return magic + struct.pack("<H", len(text)) + text + data


def packed(data: bytes, how: int = zipfile.ZIP_STORED) -> bytes:
    """An archive of one array."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", how) as archive:
        archive.writestr("it.npy", data)
    return file.getvalue()


def head(descr: str = "'<f4'", shape: str = "(2,)") -> str:
    return f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}}}"


@for_each(
    ("data", "says"),
    [
        (b"", "not an .npy file"),
        (b"\x93NUMPZ\x01\x00" + bytes(8), "not an .npy file"),
        (b"\x93NUMPY\x01\x00\xff\x7f" + bytes(8), "cut off or longer"),
        (npy(head())[:40], "cut off or longer"),
        (npy("{'descr': '<f4'}"), "not that of an .npy"),
        (npy("1 +"), "not that of an .npy"),
        (npy("[1, 2]"), "not that of an .npy"),
        (npy(head(shape="[2]")), "shape is"),
        (npy(head(shape="(2, -1)")), "shape is"),
        (npy(head(shape="(True,)")), "shape is"),
        (npy(head(shape="(1 << 50,)")), "not that of an .npy"),
        (npy(head(shape=f"({1 << 41},)")), "shape is"),
    ],
)
def test_a_header_that_is_none_is_refused(data: bytes, says: str) -> None:
    with pytest.raises(ClipError, match=says):
        npy_header(data)


def test_a_header_says_what_numpy_wrote() -> None:
    file = io.BytesIO()
    np.save(file, np.asfortranarray(np.ones((2, 3), dtype=np.int16)))
    found = npy_header(file.getvalue())
    assert (found.descr, found.fortran, found.shape) == ("<i2", True, (2, 3))
    assert len(file.getvalue()) - found.start == 12


@for_each(
    ("array", "says"),
    [
        (npy(head("'nonsense'"), bytes(8)), "which is none"),
        (npy(head(), bytes(7)), "cut off"),
        (npy(head(), bytes(9)), "cut off"),
        (b"no array", "not an .npy file"),
    ],
)
def test_an_array_that_lies_about_itself_is_refused(array: bytes, says: str) -> None:
    with pytest.raises(ClipError, match=says):
        npz_arrays(packed(array))


def test_what_numpy_does_not_unpack_is_refused_and_so_is_too_much(monkeypatch: pytest.MonkeyPatch) -> None:
    good = npy(head(), np.array([1.5, -2.0], dtype="<f4").tobytes())
    assert npz_arrays(packed(good, zipfile.ZIP_DEFLATED))["it"].tolist() == [1.5, -2.0]
    assert npz_names(packed(good)) == ["it"]
    with pytest.raises(ClipError, match="packed in a way"):
        npz_arrays(packed(good, zipfile.ZIP_BZIP2))
    with pytest.raises(ClipError, match=r"not an \.npz"):
        npz_arrays(good)
    monkeypatch.setattr(safe_numpy, "MAX_UNPACKED_BYTES", len(good))
    assert npz_arrays(packed(good))
    monkeypatch.setattr(safe_numpy, "MAX_UNPACKED_BYTES", len(good) - 1)
    with pytest.raises(ClipError, match="unpacks to more"):
        npz_arrays(packed(good))


LEG = ("hip", "knee", "foot")
DOWN = np.array([[0, 0, 0], [0, -0.5, 0], [0, -0.5, 0]], dtype=float)


@for_each(
    ("names", "parents", "offsets", "says"),
    [
        ((), (), np.zeros((0, 3)), "this one has 0"),
        (LEG, (-1, 0), DOWN, "there are 2"),
        (("hip", "hip", "foot"), (-1, 0, 1), DOWN, "named 'hip'"),
        (LEG, (-1, 0, 1), DOWN * 1e9, "are the units right"),
        (LEG, (-1, 0, 1), DOWN * 0, "holds no skeleton"),
        (LEG, (-1, 2, 1), DOWN, "tree|parent|circle|hangs"),
    ],
)
def test_bones_that_are_no_skeleton_are_refused(
    names: tuple[str, ...], parents: tuple[int, ...], offsets: np.ndarray, says: str
) -> None:
    with pytest.raises(ClipError, match=says):
        make_bones(names, parents, offsets)


def test_a_clip_has_some_frames_and_not_too_many_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    bones, _ = make_bones(LEG, (-1, 0, 1), DOWN)
    assert bones.index("knee") == 1
    with pytest.raises(ClipError, match=r"no joint is named 'toe'.*hip, knee, foot"):
        bones.index("toe")

    def made(frames: int, fps: float = 30.0) -> int:
        turns = np.tile([0.0, 0.0, 0.0, 1.0], (frames, 3, 1))
        return len(make_clip("it", bones, np.zeros((frames, 3)), turns, turns[0], fps, "test"))

    assert made(2) == 2
    with pytest.raises(ClipError, match="1 frame"):
        made(1)
    with pytest.raises(ClipError, match="frames a second"):
        made(2, 1e-3)
    monkeypatch.setattr(clip, "MAX_TURNS", 30)
    assert made(10) == 10
    with pytest.raises(ClipError, match="11 frames of 3 joints"):
        made(11)


def test_a_folder_without_motion_says_what_it_lacks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ClipError, match="is no folder"):
        motion_files(tmp_path / "nowhere", {})
    with pytest.raises(ClipError, match="holds no motion file"):
        motion_files(tmp_path, {})
    for name in ("a.bvh", "b.bvh", ".hidden.bvh", "notes.md"):
        (tmp_path / name).write_text("x")
    assert motion_files(tmp_path, {}) == ["a.bvh", "b.bvh"]
    assert motion_files(tmp_path, {}, [tmp_path / "a.bvh"]) == ["b.bvh"]
    assert motion_files(tmp_path, {("b.bvh", ""): ()}) == ["b.bvh"]
    with pytest.raises(ClipError, match="that the table of clips names"):
        motion_files(tmp_path, {("c.bvh", ""): ()})
    monkeypatch.setattr(dataset_builder, "MAX_FILES", 2)
    assert len(motion_files(tmp_path, {})) == 2
    monkeypatch.setattr(dataset_builder, "MAX_FILES", 1)
    with pytest.raises(ClipError, match="2 files, more than 1"):
        motion_files(tmp_path, {})
