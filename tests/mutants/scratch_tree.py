"""A copy of the tree to put bugs into: the tree itself is never touched."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mutants.bug import Bug


class ScratchTree:
    """What git knows of a tree, or does not ignore, in a folder of its own; kept, so that what is compiled is too."""

    def __init__(self, root: Path, place: Path) -> None:
        self.folder, self.out = place / "tree", place / "out"
        asked = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
        listed = subprocess.run(asked, cwd=root, capture_output=True, check=True).stdout.decode().split("\0")
        names = {name for name in listed if name and (root / name).is_file()}
        for name in names:
            _copy(root / name, self.folder / name)
        for path in list(self.folder.rglob("*.py")):
            if path.relative_to(self.folder).as_posix() not in names:
                path.unlink()
        shutil.rmtree(place / "data", ignore_errors=True)

    @contextmanager
    def with_bug(self, bug: Bug) -> Iterator[None]:
        """The tree with a bug in it, for as long as one looks."""
        path = self.folder / bug.path
        text, stat = path.read_text(encoding="utf-8"), path.stat()
        path.write_text(bug.put_into(text), encoding="utf-8")
        # What is compiled is told by size and date: the bug has a date of its own, and the old one comes back.
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns + 10_000_000_000))
        try:
            yield
        finally:
            path.write_text(text, encoding="utf-8")
            os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))


def _copy(source: Path, to: Path) -> None:
    if to.exists() and (to.stat().st_size, to.stat().st_mtime_ns) == (source.stat().st_size, source.stat().st_mtime_ns):
        return
    to.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(source, to)
