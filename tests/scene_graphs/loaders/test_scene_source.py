"""A source gives what is in a file, packed or not, or says in a bounded time why it cannot."""

from __future__ import annotations

import gzip
import io
import json
import os
import zipfile
from contextlib import suppress
from pathlib import Path

import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.errors import FieldPath
from scene_graphs.json_fields import LayoutError
from scene_graphs.loaders import Source
from scene_graphs.loaders import scene_source as bounds
from scene_graphs.loaders.scene_source import parse_json

ROWS = [{"id": number, "name": "a\u2028b\x85c"} for number in range(3)]
LINES = "\n".join(json.dumps(row, ensure_ascii=False) for row in ROWS).encode()


def zipped(data: bytes, files: int = 1, how: int = zipfile.ZIP_DEFLATED) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", how) as archive:
        for number in range(files):
            archive.writestr(f"häuser-{number}.json", data)
    return stream.getvalue()


@for_each("pack", [bytes, gzip.compress, zipped])
@for_each("text", [LINES, LINES + b"\n\n", b"\xef\xbb\xbf" + LINES, json.dumps(ROWS).encode()])
def test_rows_are_the_same_as_lines_or_as_a_list_packed_or_not(text: bytes, pack) -> None:
    assert [row for _, row in Source.of_bytes("a", pack(text)).rows()] == ROWS


@for_each(
    ("data", "says"),
    [
        (gzip.compress(gzip.compress(LINES)), "packed twice"),
        (gzip.compress(zipped(LINES)), "packed twice"),
        (zipped(LINES, files=2), "zip of 2 files"),
        (zipped(LINES, how=zipfile.ZIP_LZMA), "plainly"),
        (gzip.compress(b" " * (3 << 20)), "larger than 2 MiB"),
        (zipped(b"{}" + b" " * (3 << 20)), "larger than 2 MiB"),
        (gzip.compress((b'{"a": "' + b"and so on" * 999 + b'"}\n') * 300), "larger than 2 MiB"),
        (LINES + b'\n{"id": ', "line 4 is not JSON"),
        (b'{"id": 1}\n{"id": "\xff"}', "line 2 is not UTF-8"),
        (b"[" + b"9" * 5000 + b"]", "not JSON"),
    ],
)
def test_what_is_packed_to_do_damage_is_refused_with_the_reason(data: bytes, says: str) -> None:
    with pytest.raises(LayoutError, match=says):
        list(Source.of_bytes("a", data, 2 << 20).rows())


def test_a_zip_of_very_many_files_is_refused() -> None:
    with pytest.raises(LayoutError, match="many files"):
        list(Source.of_bytes("a", zipped(b"", files=10_001, how=zipfile.ZIP_STORED)).rows())


@pytest.mark.sweep
def test_a_text_of_very_many_values_or_rows_is_refused_before_it_fills_the_memory() -> None:
    with pytest.raises(LayoutError, match="values"):
        parse_json("[" + "[]," * bounds.MAX_VALUES + "[]]", FieldPath(file="a"))
    with pytest.raises(LayoutError, match="rows"):
        for _ in Source.of_bytes("a", b"{}\n" * (bounds.MAX_ROWS + 2)).rows():
            pass


@given(st.data())
def test_a_packed_file_with_flipped_bytes_is_read_or_refused(data: st.DataObject) -> None:
    packed = bytearray(data.draw(st.sampled_from([gzip.compress(LINES), zipped(LINES), zipped(LINES, 2)])))
    for place in data.draw(st.lists(st.integers(2, len(packed) - 1), min_size=1, max_size=4)):
        packed[place] = data.draw(st.integers(0, 255))
    with suppress(LayoutError):
        list(Source.of_bytes("a", bytes(packed[: data.draw(st.integers(4, len(packed)))])).rows())


def test_pipes_devices_and_what_is_no_path_are_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.json")
    (tmp_path / "round.json").symlink_to("round.json")
    for path in (tmp_path / "pipe.json", "/dev/zero", tmp_path / "round.json", "x" * 9000, "a\0b", tmp_path / "none"):
        with pytest.raises(LayoutError, match="cannot be read") as caught:
            Source.of_path(path)
        assert len(str(caught.value)) < 300


def test_nothing_but_files_in_the_folder_lies_beside(tmp_path: Path) -> None:
    (tmp_path / "outside.txt").write_text("no")
    folder = tmp_path / "house"
    folder.mkdir()
    (folder / "inside.txt").write_text("yes")
    source = Source.of_path(folder)
    for name in ("../outside.txt", str(tmp_path / "outside.txt"), "x" * 300, "x/" * 190, "a\0b", "\ud800", "."):
        assert source.beside(name) is None
    found = source.beside("none.txt", "inside.txt")
    assert found is not None
    assert found.read() == b"yes"
