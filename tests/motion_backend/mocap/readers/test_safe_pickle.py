"""Pickled dictionaries are read by following a few opcodes; nothing they name is called."""

from __future__ import annotations

import io
import pickle
from collections import OrderedDict
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.readers.safe_pickle import read_pickled

PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers(-(1 << 40), 1 << 40) | st.floats(allow_nan=False) | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)


@given(value=PLAIN, protocol=st.integers(2, 5))
@tries(60)
def test_plain_values_come_back_as_python_reads_them(value, protocol):
    assert read_pickled(pickle.dumps(value, protocol)) == value


@given(
    array=arrays.arrays(
        st.sampled_from(["<f4", "<f8", "<i8", ">i2", "|b1", "<U3"]), arrays.array_shapes(max_dims=3, max_side=4)
    ),
    fortran=st.booleans(),
)
@tries(60)
def test_arrays_come_back_with_type_and_shape(array, fortran):
    array = np.asfortranarray(array) if fortran else array
    read = read_pickled(pickle.dumps(OrderedDict(a={"arr": array}), 4))
    assert read["a"]["arr"].shape == array.shape
    assert read["a"]["arr"].tobytes() == array.tobytes()


@pytest.mark.parametrize("array", [np.array([1j]), np.array(["2026-01-01"], "M8[D]"), np.zeros(2, "f4,i4")])
def test_arrays_of_other_types_are_refused_and_told(array):
    with pytest.raises(ClipError, match=r"type|structure|whole|state"):
        read_pickled(pickle.dumps({"poses": array}, 4))


@for_each("number", [np.float32(0.1), np.float64(-2.5), np.int32(7), np.bool_(True), np.str_("text")])
def test_numpys_single_numbers_come_back(number):
    read = read_pickled(pickle.dumps({"fps": number}, 4))["fps"]
    assert (read, read.dtype) == (number, number.dtype)


class Harm:
    """What an attacker pickles: unpickling it makes a file."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


@pytest.mark.parametrize("wrap", [lambda harm: harm, lambda harm: {"rotation": harm}, lambda harm: np.array([harm])])
@pytest.mark.parametrize("protocol", [0, 2, 4])
def test_nothing_is_called(tmp_path, wrap, protocol):
    data = pickle.dumps(wrap(Harm(tmp_path / "touched")), protocol)
    with pytest.raises(ClipError):
        read_pickled(data)
    assert not (tmp_path / "touched").exists()


@for_each(
    ("data", "fault"),
    [
        (b"cos\nsystem\n(S'ls'\ntR.", "os system"),
        (b"\x80\x04\x8c\x02os\x8c\x06system\x93.", "os system"),
        (b"R.", "empty stack"),
        (b"(.", "whole|else"),
        (b"]N\x85b.", "state to something other"),
        (b"cnumpy\nndarray\n)R.", "other than what builds"),
        (b"}K\x01K\x02s.", "texts as keys"),
        (b"h\x05.", "whole"),
        (b"]", "STOP|whole"),
        (b"]q\x00h\x00a.", "deeply"),
        (b"(" * 5000 + b".", "whole|else"),
    ],
)
def test_what_is_not_plain_is_refused(data, fault):
    with pytest.raises(ClipError, match=fault):
        read_pickled(data)


def test_a_list_that_holds_itself_many_times_over_costs_little():
    nested: list = [1.0]
    for _ in range(6):
        nested = [nested] * 1000
    read_pickled(pickle.dumps(nested, 4))


@given(data=st.binary(max_size=80))
@tries(150)
def test_random_bytes_end_in_an_error_or_a_value(data):
    with suppress(ClipError):
        read_pickled(b"\x80\x03" + data)


@given(place=st.integers(0, 400), byte=st.integers(0, 255))
@tries(150)
def test_a_damaged_pickle_ends_in_an_error_or_a_value(place, byte):
    file = io.BytesIO()
    np.lib.format.write_array(file, np.array(OrderedDict(a=np.arange(6.0).reshape(2, 3), b="text"), dtype=object))
    whole = bytearray(file.getvalue()[128:])
    whole[place % len(whole)] = byte
    with suppress(ClipError):
        read_pickled(bytes(whole))
