"""A hook of the documentation site: the API reference, a page a folder, each module by its docstrings.

The README is the front page, and every record of a decision is in the list of pages.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("prompts", "scene_graphs", "motion_backend", "planner_service")
REPOSITORY_ONLY = re.compile(r"\[([^\]]+)\]\((?!https?:|#)((?:\.\./)+(?!docs/)[^)\s]*)\)")
"""A link from a page to a file of the repository that is no page."""


def folders() -> Iterator[Path]:
    """Every folder of modules, packages first, as paths from the root."""
    for package in PACKAGES:
        yield from (path.parent.relative_to(ROOT) for path in sorted((ROOT / package).rglob("__init__.py")))


def page_of(folder: Path) -> str:
    """The reference of one folder: its own docstring, then each of its modules."""
    name = ".".join(folder.parts)
    alone = "\n    options:\n      members: false\n      show_root_heading: false\n      show_root_toc_entry: false\n"
    modules = sorted(path.stem for path in (ROOT / folder).glob("*.py") if not path.stem.startswith("__"))
    return "\n".join(
        [f"# {name}", f"::: {name}{alone if modules else ''}", *(f"::: {name}.{one}\n" for one in modules)]
    )


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """What is made or numbered is put into the list of pages."""
    decisions = sorted((ROOT / "docs" / "decisions").glob("*.md"))
    config.nav = [
        *(config.nav or []),
        {
            "API reference": [
                {package: [_entry(one) for one in folders() if one.parts[0] == package]} for package in PACKAGES
            ]
        },
        {"Decisions": [f"decisions/{path.name}" for path in decisions]},
    ]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """The README and the reference become pages."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    front = re.sub(r"(\]\(|src=\")docs/", r"\1", readme)
    files.append(
        File.generated(config, "index.md", content=re.sub(r"\[([^\]]+)\]\((?!https?:|#)([^)\s]+)\)", _kept, front))
    )
    for folder in folders():
        files.append(File.generated(config, f"reference/{folder.as_posix()}.md", content=page_of(folder)))
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Links out of the pages, into the repository, become plain words."""
    return REPOSITORY_ONLY.sub(r"\1", markdown)


def _entry(folder: Path) -> dict[str, str]:
    return {"/".join(folder.parts[1:]) or folder.name: f"reference/{folder.as_posix()}.md"}


def _kept(link: re.Match[str]) -> str:
    """A link of the README, or its words where what it names is no page."""
    target = ROOT / "docs" / link[2].split("#")[0]
    return link[0] if target.exists() else link[1]
