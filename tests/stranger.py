"""A stranger's motion backend: that of docs/backends.md, installed as pip would leave it, and one that is broken."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

GUIDE = Path(__file__).resolve().parents[1] / "docs" / "backends.md"
_NAMED = re.compile(r"^```\w+ ([\w.]+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def install(folder: Path) -> Path:
    """Put the backends `ghost` and `broken` into a folder that is then to be on the path."""
    files = dict(_NAMED.findall(GUIDE.read_text(encoding="utf-8")))
    project = tomllib.loads(files["pyproject.toml"])["project"]
    registered = project["entry-points"]["sims.backends"] | {"broken": "no_such_library:Backend"}
    metadata = folder / f"sims_ghost-{project['version']}.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(f"Name: {project['name']}\nVersion: {project['version']}\n")
    points = "\n".join(f"{name} = {where}" for name, where in registered.items())
    (metadata / "entry_points.txt").write_text(f"[sims.backends]\n{points}\n")
    (folder / "ghost.py").write_text(files["ghost.py"])
    return folder
