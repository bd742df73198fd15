"""What is known of clips beside their motion: a table in the folder, or one that a user gives.

A CSV with a heading; `file` names a file from the folder, and optionally: `clip` (one animation of it), `skill`,
`style`, `caption`, `subject`, `licence`, `kind`, `source`. What it does not say is told from names.
"""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path

from motion_backend.clips.clip import ClipError
from motion_backend.clips.wording import skill_of

TABLE = "manifest.csv"
NO_MOTION = frozenset({"labels", "skeleton", "licence"})
"""Kinds of rows whose file holds no motion."""
_LARGEST = 16 << 20
_COLUMNS = ("file", "clip", "skill", "style", "caption", "subject", "licence", "kind", "source")


@dataclass(frozen=True)
class Label:
    """One clip's row."""

    skill: str = ""
    style: str = ""
    caption: str = ""
    subject: str = ""
    """Who moved: clips of one subject stay on one side of any split."""
    licence: str = ""
    kind: str = ""
    """real mocap, hand-keyed, model-generated, or what the table says."""
    source: str = ""


Labels = dict[tuple[str, str], Label]
"""By file, from the folder, and clip ("" for all clips of a file)."""


def read_labels(path: Path) -> Labels:
    """The rows of a table. ClipError names the line that is wrong."""
    try:
        if path.stat().st_size > _LARGEST:
            raise ClipError(f"{path.name}: a table of clips has at most {_LARGEST >> 20} MB")
        text = path.read_text(encoding="utf-8-sig")
        rows = csv.DictReader(io.StringIO(text), strict=True)
        if "file" not in (rows.fieldnames or ()):
            raise ClipError(
                f"{path.name}: its first line must name the columns, among them file: {', '.join(_COLUMNS)}"
            )
        if len(set(rows.fieldnames or ())) < len(rows.fieldnames or ()):
            raise ClipError(f"{path.name}: its first line names a column twice")
        found: Labels = {}
        for row in rows:
            if None in row.values() or None in row:
                raise ClipError(f"{path.name}, line {rows.line_num}: as many cells as columns are needed")
            told = {name: row.get(name, "").strip() for name in _COLUMNS}
            file, clip = told.pop("file"), told.pop("clip")
            if (Path(file).as_posix(), clip) in found:
                raise ClipError(f"{path.name}, line {rows.line_num}: {file!r:.80} has a row already")
            found[Path(file).as_posix(), clip] = Label(**told)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ClipError(f"{path.name}: not a table of clips: {error}") from error
    return found


def label_of(labels: Labels, file: str, clip: str) -> Label:
    """What is known of a clip; skill and subject are told from names where no row says them.

    A row for a whole file that lists several skills leaves each clip's to its own name.
    """
    row = labels.get((file, clip)) or labels.get((file, "")) or Label()
    skills = [one.strip() for one in row.skill.split(";") if one.strip()]
    kept = [one for one in skills if not one.endswith("-reversed")]
    named = skill_of(clip.rsplit("/", 1)[-1])
    many = clip not in ("", Path(file).stem)
    skill = kept[0] if kept and not many else named
    caption = "" if many and (file, clip) not in labels else row.caption
    style = clip.rsplit("/", 1)[-1].replace("_", " ").lower() if many and (file, clip) not in labels else row.style
    return Label(
        skill=skill if skill != "other" or not kept else kept[0] if not many else "other",
        style=style,
        caption=caption,
        subject=row.subject or subject_of(file),
        licence=row.licence,
        kind=row.kind or "unknown",
        source=row.source,
    )


def subject_of(file: str) -> str:
    """Who moved, from a file's name: trials are numbered subject_trial; other files share their folder's."""
    path = Path(file)
    trial = re.match(r"(\d{1,3})_\d", path.stem)
    if trial:
        return f"trial subject {int(trial[1])}"
    return path.name if path.suffix in (".glb", ".gltf") else str(path.parent)
