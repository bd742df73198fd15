"""What the documentation names is there: modules, paths, commands, links."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer
from for_each import for_each
from typer.testing import CliRunner

from benchmarks.themes import demo
from planner_service.cli import app

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
TOPS = ("prompts", "scene_graphs", "motion_backend", "planner_service", "benchmarks", "docs", "tests")
GROUPS = "scripts|layouts|clips|evaluate|train"
PATH = re.compile(rf"(?<![\w/.-])(?:{'|'.join(TOPS)})/[\w./-]*\w(?:\.\w+)?/?")
BUILT = {"planner_service/page"}
"""What `make page` makes where Node is installed, and git does not hold."""
LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]+)|src=\"(?!https?:)([^\"]+)\"")


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def code_of(page: Path) -> str:
    """What stands in code blocks and between back-ticks."""
    return "\n".join(re.findall(r"```.*?```|`[^`\n]+`", text_of(page), re.DOTALL))


@cache
def commands() -> dict[str, list[str]]:
    """Words after `sims` of every command there is, and its options."""
    found = {}

    def walk(command: Any, words: str) -> None:
        inner = getattr(command, "commands", {})
        for name, child in inner.items():
            walk(child, f"{words} {name}".strip())
        if not inner:
            found[words] = [option for parameter in command.params for option in parameter.opts]

    walk(typer.main.get_command(app), "")
    return found


def test_every_room_is_named_in_the_architecture() -> None:
    page = text_of(ROOT / "docs" / "architecture.md")
    packages = ("prompts", "scene_graphs", "motion_backend", "planner_service", "benchmarks")
    rooms = [
        path.parent.relative_to(ROOT).as_posix() for name in packages for path in (ROOT / name).rglob("__init__.py")
    ]
    missing = [room for room in rooms if f"\n{room}/ " not in page]
    assert not missing, "run python docs/tree.py"


def test_the_architecture_is_read_in_a_sitting() -> None:
    assert len(text_of(ROOT / "docs" / "architecture.md").splitlines()) <= 350


@for_each("page", PAGES)
def test_every_path_that_is_named_exists(page: Path) -> None:
    named = {path.rstrip("/") for path in PATH.findall(text_of(page))}
    assert not [path for path in named - BUILT if not (ROOT / path).exists()]


@for_each("page", PAGES)
def test_every_link_leads_somewhere(page: Path) -> None:
    links = [first or second for first, second in LINK.findall(text_of(page))]
    assert not [link for link in links if not (page.parent / link).exists()]


@for_each("page", PAGES)
def test_every_make_target_that_is_named_exists(page: Path) -> None:
    makefile = text_of(ROOT / "Makefile")
    targets = set(re.findall(r"^`*make ([a-z-]+)", code_of(page), re.MULTILINE))
    assert targets <= set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))


@for_each("page", PAGES)
def test_every_sims_command_that_is_named_exists_with_its_options(page: Path) -> None:
    known = commands()
    for line in re.findall(rf"\bsims ((?:story|(?:{GROUPS}) [a-z|]+)\b[^\n`]*)", code_of(page)):
        words = line.split()
        name = words[0] if words[0] == "story" else " ".join(words[:2])
        for one in expanded(name):
            assert one in known, f"sims {line}"
            options = set(re.findall(r"(?<!\S)--[a-z-]+", line))
            assert options <= {*known[one], "--help"}, f"sims {line}"


def expanded(name: str) -> list[str]:
    """`scripts search|add` stands for two commands."""
    first, _, rest = name.partition(" ")
    return [f"{first} {word}".strip() for word in rest.split("|")]


def test_the_readme_names_every_command() -> None:
    readme = code_of(ROOT / "README.md")
    assert not [name for name in commands() if f"sims {name}" not in readme]


def test_the_python_of_the_readme_uses_names_that_exist() -> None:
    (snippet,) = re.findall(r"```python\n(.*?)```", text_of(ROOT / "README.md"), re.DOTALL)
    imports = "\n".join(line for line in snippet.splitlines() if line.startswith(("from ", "import ")))
    compile(snippet, "README.md", "exec")
    names: dict[str, object] = {}
    exec(imports, names)
    assert "Pipeline" in names


def test_the_readme_shows_the_theme_of_the_demo() -> None:
    told = re.search(r"^THEME \?= (.+)$", text_of(ROOT / "Makefile"), re.MULTILINE)
    assert told is not None
    assert told[1] in re.sub(r"\n(?:> )?", " ", text_of(ROOT / "README.md"))


@pytest.mark.sweep
def test_the_readme_shows_what_the_demo_prints(tmp_path: Path) -> None:
    """All but how far it is, its table and the files that a film adds."""
    theme, seed = demo()
    done = CliRunner().invoke(app, ["story", theme, "--seed", str(seed), "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    readme = spaced(text_of(ROOT / "README.md"))
    printed = re.split(r"\n\s*\n", done.stdout)
    shown = [spaced(part) for part in printed if part.strip() and not re.search("━|reached|written to", part)]
    assert [part for part in shown if part not in readme] == []
    assert len(shown) >= 4


@pytest.mark.sweep
def test_the_readme_shows_what_its_python_prints(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    snippet, said = re.findall(r"```python\n(.*?)```\n\n```\n(.*?)```", text_of(ROOT / "README.md"), re.DOTALL)[0]
    exec(snippet, {})
    assert capsys.readouterr().out == said


def spaced(text: str) -> str:
    """Text without regard to how it is broken into lines."""
    return " ".join(text.split())


def test_the_pictures_are_small() -> None:
    for name, most in (
        ("storyboard.png", 400_000),
        ("sheet.png", 250_000),
        ("plan.png", 150_000),
        ("match.png", 150_000),
    ):
        assert (ROOT / "docs" / "images" / name).stat().st_size <= most
