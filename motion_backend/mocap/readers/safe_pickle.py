"""What a pickled dictionary of arrays holds, read without unpickling: nothing that the file names is ever called.

A small interpreter over `pickletools.genops` knows the opcodes that build dictionaries, lists, tuples, texts, numbers
and numpy arrays, and the names those need; every other opcode and name is refused.
"""

from __future__ import annotations

import pickletools
import struct
import warnings
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from motion_backend.mocap.clip import ClipError

MAX_STEPS: Final = 1_000_000
_MAX_DEPTH: Final = 8
_NUMPY: Final = ("numpy.core.multiarray", "numpy._core.multiarray")
_NAMES: Final = {
    "collections OrderedDict": "dict",
    "numpy ndarray": "ndarray",
    "numpy dtype": "dtype",
    **{f"{module} _reconstruct": "array" for module in _NUMPY},
    **{f"{module} scalar": "scalar" for module in _NUMPY},
}
_TYPES: Final = frozenset({"f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "b1"})
_MARK: Final = object()


@dataclass
class _Type:
    """A dtype under construction; "O" stands for lists of objects."""

    kind: str
    order: str = "="

    def dtype(self) -> np.dtype[Any]:
        if self.kind.startswith("U") and self.kind[1:].isdigit() and len(self.kind) < 7:
            return np.dtype(self.order + self.kind)
        if self.kind not in _TYPES:
            raise ClipError(f"it holds an array of type {self.kind!r:.20}, which is not read")
        return np.dtype(self.order + self.kind)


@dataclass
class _Array:
    """An array under construction."""

    value: Any = None


@dataclass(frozen=True)
class _Name:
    """Something that the file may call by name; it only says what to build."""

    what: str


@dataclass
class _Machine:
    """Stack and memo of one pickle."""

    stack: list[Any] = field(default_factory=list)
    memo: dict[int, Any] = field(default_factory=dict)

    def run(self, data: bytes) -> Any:
        """Follow the opcodes to STOP and answer what is left."""
        for step, (code, argument, _) in enumerate(pickletools.genops(data)):
            if step > MAX_STEPS:
                raise ClipError(f"it is built in more than {MAX_STEPS} steps")
            if code.name == "STOP":
                return self.stack.pop()
            self._step(code.name, argument)
        raise ClipError("it ends before its STOP")

    def _step(self, code: str, argument: Any) -> None:
        match code:
            case "PROTO" | "FRAME":
                pass
            case "BINUNICODE" | "SHORT_BINUNICODE" | "BINBYTES" | "SHORT_BINBYTES" | "BINBYTES8" | "BINUNICODE8":
                self.stack.append(argument)
            case "BININT" | "BININT1" | "BININT2" | "LONG1" | "BINFLOAT":
                self.stack.append(argument)
            case "NONE" | "NEWTRUE" | "NEWFALSE":
                self.stack.append({"NONE": None, "NEWTRUE": True, "NEWFALSE": False}[code])
            case "MARK":
                self.stack.append(_MARK)
            case "EMPTY_DICT" | "EMPTY_LIST" | "EMPTY_TUPLE":
                self.stack.append({"EMPTY_DICT": dict, "EMPTY_LIST": list, "EMPTY_TUPLE": tuple}[code]())
            case "TUPLE":
                self.stack.append(tuple(self._since_mark()))
            case "TUPLE1" | "TUPLE2" | "TUPLE3":
                self.stack.append(tuple(self._last(int(code[-1]))))
            case "APPEND":
                self._extend(self._last(1))
            case "APPENDS":
                self._extend(self._since_mark())
            case "SETITEM":
                self._update(self._last(2))
            case "SETITEMS":
                self._update(self._since_mark())
            case "BINPUT" | "LONG_BINPUT":
                self.memo[argument] = self.stack[-1]
            case "MEMOIZE":
                self.memo[len(self.memo)] = self.stack[-1]
            case "BINGET" | "LONG_BINGET":
                self.stack.append(self.memo[argument])
            case "GLOBAL":
                self.stack.append(_named(argument))
            case "STACK_GLOBAL":
                self.stack.append(_named(" ".join(str(part)[:60] for part in self._last(2))))
            case "REDUCE":
                function, arguments = self._last(2)
                self.stack.append(_made(function, arguments))
            case "BUILD":
                state = self.stack.pop()
                _build(self.stack[-1], state)
            case _:
                raise ClipError(f"it has the opcode {code}, which is not followed: only arrays in dictionaries are")

    def _last(self, count: int) -> list[Any]:
        taken = self.stack[-count:]
        if len(taken) < count or any(value is _MARK for value in taken):
            raise ClipError("it takes from an empty stack")
        del self.stack[-count:]
        return taken

    def _since_mark(self) -> list[Any]:
        place = len(self.stack) - 1
        while place >= 0 and self.stack[place] is not _MARK:
            place -= 1
        if place < 0:
            raise ClipError("it takes from an empty stack")
        taken = self.stack[place + 1 :]
        del self.stack[place:]
        return taken

    def _extend(self, values: list[Any]) -> None:
        if not isinstance(self.stack[-1], list):
            raise ClipError("it appends to something that is no list")
        self.stack[-1].extend(values)

    def _update(self, values: list[Any]) -> None:
        keys = values[::2]
        if not isinstance(self.stack[-1], dict) or len(values) % 2 or not all(isinstance(key, str) for key in keys):
            raise ClipError("it sets items that are not of a dictionary with texts as keys")
        self.stack[-1].update(zip(keys, values[1::2], strict=True))


def read_pickled(data: bytes) -> Any:
    """Dictionaries, lists, texts, numbers and arrays of a pickle. ClipError if it holds, or does, anything else."""
    try:
        with warnings.catch_warnings():
            # Of letters that are no escapes in the text of an opcode that is then refused.
            warnings.simplefilter("ignore", DeprecationWarning)
            return _Finish()(_Machine().run(data))
    except (ValueError, KeyError, IndexError, TypeError, OverflowError, struct.error) as error:
        if isinstance(error, ClipError):
            raise
        raise ClipError(f"it is no whole pickle: {error}") from error


def _named(name: str) -> _Name:
    if name not in _NAMES:
        raise ClipError(f"it names {name[:60]!r}, which is never called: only arrays in dictionaries are read")
    return _Name(_NAMES[name])


def _made(function: Any, arguments: Any) -> Any:
    match function, arguments:
        case _Name("dict"), ():
            return {}
        case _Name("dtype"), (str() as kind, *_):
            return _Type(kind)
        case _Name("array"), (_Name("ndarray"), *_):
            return _Array()
        case _Name("scalar"), (_Type() as type_, bytes() as content):
            return np.frombuffer(content, type_.dtype(), 1)[0]
        case _:
            raise ClipError("it calls something other than what builds an array or a dictionary")


def _build(target: Any, state: Any) -> None:
    match target, state:
        case _Type(), (_, str() as order, None, None, None, *_) if order in ("<", ">", "=", "|"):
            target.order = "=" if order == "|" else order
        case _Array(), (_, tuple() as shape, _Type() as type_, bool() as fortran, content):
            target.value = _filled(shape, type_, fortran, content)
        case _:
            raise ClipError("it gives a state to something other than an array")


def _filled(shape: tuple[Any, ...], type_: _Type, fortran: bool, content: Any) -> Any:
    if not all(type(size) is int and 0 <= size < 1 << 40 for size in shape) or len(shape) > 8:
        raise ClipError(f"it holds an array of shape {str(shape)[:60]}")
    if type_.kind in ("O", "O8"):
        if not isinstance(content, list) or shape not in ((), (len(content),)) or (shape == () and len(content) != 1):
            raise ClipError("it holds an array of objects that is no list")
        return content[0] if shape == () else content
    if not isinstance(content, bytes):
        raise ClipError("it holds an array without bytes")
    values = np.frombuffer(content, type_.dtype())
    return values.reshape(shape, order="F" if fortran else "C")


@dataclass
class _Finish:
    """Arrays put in the place of what builds them; each value once, however often the file refers to it."""

    done: dict[int, Any] = field(default_factory=dict)

    def __call__(self, value: Any, deep: int = _MAX_DEPTH) -> Any:
        if id(value) not in self.done:
            self.done[id(value)] = self._finished(value, deep)
        return self.done[id(value)]

    def _finished(self, value: Any, deep: int) -> Any:
        if isinstance(value, _Array) and deep:
            return self(value.value, deep - 1)
        if isinstance(value, dict) and deep:
            return {key: self(item, deep - 1) for key, item in value.items()}
        if isinstance(value, list | tuple) and deep:
            return [self(item, deep - 1) for item in value]
        if value is None or isinstance(value, str | bool | int | float | np.ndarray | np.generic):
            return value
        raise ClipError("it is nested more deeply than a motion, or holds something else")
