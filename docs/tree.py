"""The rooms in architecture.md, read from the folders' own docstrings: `python docs/tree.py` writes them anew."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "architecture.md"
PACKAGES = ("prompts", "scene_graphs", "motion_backend", "planner_service", "benchmarks")
BEGIN, END = "<!-- tree: written by docs/tree.py -->\n", "<!-- end of tree -->"
WIDTH = 46


def phrase_of(path: Path) -> str:
    """The first sentence of a module's docstring, without its closing full stop."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    first = re.split(r"(?<=[a-z)\d`])\.\s|\n\n", " ".join(text.split("\n\n")[0].split()))[0]
    return re.sub(r" \(notes: [^)]*\)", "", first).rstrip(".")


def lines() -> Iterator[str]:
    """A line a folder: where it is and what it is for."""
    yield "```"
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("__init__.py")):
            yield f"{path.parent.relative_to(ROOT).as_posix() + '/':<{WIDTH}} {phrase_of(path)}"
    yield "```"


def main() -> None:
    """Put the rooms between their two marks."""
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text(before + BEGIN + "\n".join(lines()) + "\n" + END + after, encoding="utf-8")


if __name__ == "__main__":
    main()
