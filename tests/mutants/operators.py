"""Every small bug that a module can be given: signs, borders, constants, conditions, statements, values returned.

Texts are left alone, and what only makes texts: docstrings, messages, annotations, imports, logging; and what is only
held to be so: assertions, `strict`, `frozen`.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from itertools import accumulate, pairwise
from typing import Final

from mutants.bug import Bug

ARITHMETIC: Final[dict[type[ast.operator], tuple[str, str]]] = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.FloorDiv: ("//", "*"),
    ast.Mod: ("%", "*"), ast.Pow: ("**", "*"), ast.BitAnd: ("&", "|"), ast.BitOr: ("|", "&"),
}  # fmt: skip
COMPARISONS: Final[dict[type[ast.cmpop], tuple[str, tuple[str, ...]]]] = {
    ast.Lt: ("<", ("<=", ">")), ast.LtE: ("<=", ("<", ">")), ast.Gt: (">", (">=", "<")), ast.GtE: (">=", (">", "<")),
    ast.Eq: ("==", ("!=",)), ast.NotEq: ("!=", ("==",)), ast.Is: ("is", ("is not",)), ast.IsNot: ("is not", ("is",)),
    ast.In: ("in", ("not in",)), ast.NotIn: ("not in", ("in",)),
}  # fmt: skip
TWINS: Final = {
    "min": "max", "minimum": "maximum", "argmin": "argmax", "any": "all", "floor": "ceil", "sin": "cos",
    "startswith": "endswith", "union": "intersection", "append": "extend",
}  # fmt: skip
TWIN: Final = TWINS | {second: first for first, second in TWINS.items()} | {"extend": "append"}
"""Functions that are easily mistaken for one another."""
MESSAGES: Final = {"print", "warn", "warning", "info", "debug", "error", "exception", "log", "echo", "Field", "cast"}
"""Calls that only say something, or only concern types."""
HELD: Final = {"strict", "frozen", "repr"}
"""Arguments that only hold others to something, or say how it is shown."""
SEEDS: Final = {"seed"}
"""Arguments of which one default is as good as another."""
SHAPED: Final = {"reshape"}
"""Calls to which every number below zero is a length to be found."""
SAYING: Final = {"__repr__", "__str__", "__format__"}


def bugs(path: str, text: str) -> list[Bug]:
    """All of them, in the order of their places."""
    found = _Finder(path, text).of_module()
    return sorted(found, key=lambda bug: (bug.start, bug.stop, bug.wrong))


class _Finder:
    """Walks one module, statement by statement."""

    def __init__(self, path: str, text: str) -> None:
        self._path, self._text = path, text
        self._tree = ast.parse(text)
        lines = text.splitlines(keepends=True)
        self._starts = [0, *accumulate(len(line) for line in lines)]
        self._bytes = [line.encode() for line in lines]

    def of_module(self) -> Iterator[Bug]:
        for statement in self._tree.body:
            yield from self._of_statement(statement, ())

    # Places and bugs

    def _place(self, line: int, column: int) -> int:
        """Where in the text the AST's line and column (in bytes) are."""
        return self._starts[line - 1] + len(self._bytes[line - 1][:column].decode())

    def _span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self._place(node.lineno, node.col_offset), self._place(node.end_lineno, node.end_col_offset)

    def _bug(self, span: tuple[int, int], wrong: str, lines: tuple[int, int], kind: str, names: tuple[str, ...]) -> Bug:
        return Bug(self._path, *span, wrong, *lines, kind, names)

    def _operator(self, left: ast.expr, right: ast.expr, sign: str) -> tuple[int, int] | None:
        """Where the sign between two operands stands; None where the text between them has it twice."""
        start, stop = self._span(left)[1], self._span(right)[0]
        between = self._text[start:stop]
        if between.count(sign) != 1 or "#" in between:
            return None
        at = start + between.index(sign)
        return at, at + len(sign)

    # Statements

    def _of_statement(self, node: ast.stmt, names: tuple[str, ...]) -> Iterator[Bug]:
        lines = (node.lineno, node.end_lineno or node.lineno)
        match node:
            case ast.Import() | ast.ImportFrom() | ast.Raise() | ast.Assert() | ast.Global() | ast.Nonlocal():
                if isinstance(node, ast.Raise):
                    yield self._bug(self._span(node), "pass", lines, "refusal left out", names)
                return
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                if node.name not in SAYING:
                    for default in _defaults(node.args):
                        yield from self._of_expression(default, lines, (node.name,))
                    yield from self._of_body(node.body, ())
                return
            case ast.ClassDef():
                yield from self._of_body(node.body, (node.name,))
                return
            case ast.If() if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
                return
            case ast.If(test=ast.Compare(left=ast.Name(id="__name__"))):
                return
            case ast.Expr(value=ast.Constant()):
                return
            case ast.Expr(value=ast.Call() as call) if _called(call) in MESSAGES:
                return
            case ast.Assign() | ast.AnnAssign() if self._is_global(node) and not names:
                names = _assigned(node)
        yield from self._whole(node, lines, names)
        for part in _expressions(node):
            yield from self._of_expression(part, _lines_of(part), names)
        for body in _bodies(node):
            yield from self._of_body(body, names)

    def _is_global(self, node: ast.stmt) -> bool:
        return node in self._tree.body

    def _of_body(self, body: list[ast.stmt], names: tuple[str, ...]) -> Iterator[Bug]:
        for statement in body:
            yield from self._of_statement(statement, names)

    def _whole(self, node: ast.stmt, lines: tuple[int, int], names: tuple[str, ...]) -> Iterator[Bug]:
        """Bugs of a statement as a whole."""
        span = self._span(node)
        match node:
            case ast.Expr(value=ast.Call()) | ast.AugAssign() | ast.Continue() | ast.Break() | ast.Delete():
                yield self._bug(span, "pass", lines, "statement dropped", names)
            case ast.Return(value=ast.expr() as value):
                text = self._text[slice(*self._span(value))]
                if isinstance(value, ast.Compare | ast.BoolOp) or (isinstance(value, ast.UnaryOp) and "not" in text):
                    yield self._bug(self._span(value), f"not ({text})", lines, "value returned", names)
                elif not (isinstance(value, ast.Constant) and not value.value):
                    yield self._bug(self._span(value), "None", lines, "value returned", names)
            case ast.If() | ast.While():
                test = self._span(node.test)
                where = _lines_of(node.test)
                yield self._bug(test, f"not ({self._text[slice(*test)]})", where, "condition turned round", names)

    # Expressions

    def _of_expression(self, node: ast.expr, lines: tuple[int, int], names: tuple[str, ...]) -> Iterator[Bug]:
        if isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Call) and _called(node) in MESSAGES):
            return
        for span, wrong, kind in self._here(node):
            yield self._bug(span, wrong, lines, kind, names)
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
            yield from self._of_expression(node.value, lines, names)
            return
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.UnaryOp) and isinstance(node, ast.Call) and _called(node) in SHAPED:
                continue
            if isinstance(child, ast.expr):
                yield from self._of_expression(child, lines, names)
            elif isinstance(child, ast.comprehension):
                for part in (child.iter, *child.ifs):
                    yield from self._of_expression(part, lines, names)
            elif isinstance(child, ast.keyword) and child.arg not in HELD:
                yield from self._of_expression(child.value, lines, names)

    def _here(self, node: ast.expr) -> Iterator[tuple[tuple[int, int], str, str]]:
        """Bugs of one expression, but for those of its parts."""
        match node:
            case ast.BinOp(left=left, op=op, right=right) if type(op) in ARITHMETIC and not _is_text(left, right):
                sign, wrong = ARITHMETIC[type(op)]
                if span := self._operator(left, right, sign):
                    yield span, wrong, "arithmetic"
            case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
                yield self._span(node), self._text[slice(*self._span(operand))], "sign"
            case ast.BoolOp(op=op, values=values):
                sign, wrong = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
                for left, right in pairwise(values):
                    if span := self._operator(left, right, sign):
                        yield span, wrong, "and, or"
            case ast.Compare(left=left, ops=ops, comparators=comparators):
                for before, compared, after in zip([left, *comparators], ops, comparators, strict=False):
                    sign, others = COMPARISONS[type(compared)]
                    if span := self._operator(before, after, sign):
                        for wrong in others:
                            yield span, wrong, "comparison"
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                yield self._span(node), _another(value), "constant"
            case ast.Constant(value=bool() as value):
                yield self._span(node), repr(not value), "constant"
            case ast.Subscript(slice=ast.Constant(value=int() as value)) if type(value) is int:
                yield self._span(node.slice), "1" if value == 0 else "0", "index"
            case ast.Call(func=ast.Name(id=name)) if name in TWIN:
                yield self._span(node.func), TWIN[name], "twin"
            case ast.Call(func=ast.Attribute(attr=name)) if name in TWIN:
                stop = self._span(node.func)[1]
                yield (stop - len(name), stop), TWIN[name], "twin"
            case ast.IfExp(test=test):
                yield self._span(test), f"not ({self._text[slice(*self._span(test))]})", "condition turned round"


def _another(number: float) -> str:
    """A number that is not this one."""
    if isinstance(number, int):
        return str(number + 1 if number < 10 else number * 3 // 2)
    return repr(number * 1.5) if number else "1.0"


def _called(call: ast.Call) -> str:
    """Name of the function or method."""
    return call.func.id if isinstance(call.func, ast.Name) else getattr(call.func, "attr", "")


def _defaults(arguments: ast.arguments) -> Iterator[ast.expr]:
    """Of a function's arguments, but for those of which any would do."""
    named = [*arguments.posonlyargs, *arguments.args]
    ended = zip(reversed(named), reversed(arguments.defaults), strict=False)
    alone = zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    for argument, default in (*reversed(list(ended)), *alone):
        if default is not None and argument.arg not in SEEDS:
            yield default


def _is_text(*operands: ast.expr) -> bool:
    return any(
        isinstance(one, ast.JoinedStr) or (isinstance(one, ast.Constant) and isinstance(one.value, str | bytes | None))
        for one in operands
    )


def _assigned(node: ast.Assign | ast.AnnAssign) -> tuple[str, ...]:
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    return tuple(name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name))


def _expressions(node: ast.stmt) -> Iterator[ast.expr]:
    """What a statement reckons with, annotations left out."""
    match node:
        case ast.AnnAssign(value=value):
            parts = [value]
        case ast.Assign(value=value, targets=targets):
            parts = [value, *(one for one in targets if isinstance(one, ast.Subscript))]
        case ast.AugAssign(value=value) | ast.Return(value=value) | ast.Expr(value=value):
            parts = [value]
        case ast.If(test=test) | ast.While(test=test):
            parts = [test]
        case ast.For(iter=iter_):
            parts = [iter_]
        case ast.With(items=items) | ast.AsyncWith(items=items):
            parts = [item.context_expr for item in items]
        case ast.Match(subject=subject, cases=cases):
            parts = [subject, *(case.guard for case in cases)]
        case _:
            parts = []
    return (part for part in parts if part is not None)


def _bodies(node: ast.stmt) -> Iterator[list[ast.stmt]]:
    for name in ("body", "orelse", "finalbody"):
        if body := getattr(node, name, None):
            yield body
    for one in (*getattr(node, "handlers", ()), *getattr(node, "cases", ())):
        yield one.body


def _lines_of(node: ast.expr) -> tuple[int, int]:
    return node.lineno, node.end_lineno or node.lineno
