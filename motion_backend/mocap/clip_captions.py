"""What is known of clips beside their motion: a table in the folder, or one that a user gives.

A CSV with a heading; `file` names a file from the folder, and optionally: `clip` (one animation of it), `skill`,
`style`, `caption`, `subject`, `licence`, `kind`, `source`, and `start` and `stop`, the seconds of a segment that is
a clip of its own: several rows may name one file. What it does not say is told from names.

Words for clips: which skill a file's name tells, which emotion its style, and five ways to say what is done.
"""

from __future__ import annotations

import csv
import io
import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from motion_backend import emotion_words
from motion_backend.mocap.clip import ClipError
from motion_backend.motion import Emotion

WAYS = 5
"""Captions a clip gets (SIMS 4.1)."""
_SKILLS = (
    ("getup", r"lie.?stand|get.?up|floor.?stand|\brises? from the (floor|ground)"),
    ("liedown", r"lie.?down|lying down|lie.?idle|lie.?pose|sleep|death"),
    ("standup", r"stand.?up|sitting.?exit|chair.?stand"),
    ("sitdown", r"sit"),
    ("touch", r"pick.?up|interact|touch|reach|push(?!.?up)|fixing|use.?item|consume|wash|point|grab"),
    ("squat", r"squat"),
    ("loco", r"walk|run|jog|sprint|crawl|sneak|crouch.?fwd|strafe|zombie|stealth|hop\b|march|step"),
    ("idle", r"idle|wave|stand|greet|talk|listen|pose|bow|nod|angry|tired|confused|dizzy|shiver|reject|victory"),
)


class Verb(NamedTuple):
    """Something a body does, in four forms."""

    plain: str
    third: str
    doing: str
    noun: str


_VERBS = (
    (r"\bcrawl", Verb("crawl", "crawls", "crawling", "crawl")),
    (r"\b(jog)", Verb("jog", "jogs", "jogging", "jog")),
    (r"\b(run|sprint)", Verb("run", "runs", "running", "run")),
    (r"\b(sneak|stealth)", Verb("sneak", "sneaks", "sneaking", "sneaky walk")),
    (r"\b(hop)", Verb("hop", "hops", "hopping", "hop")),
    (r"zombie|stagger", Verb("stagger", "staggers", "staggering", "staggering walk")),
    (r"squat", Verb("squat", "squats", "squatting", "squat")),
    (r"\bwave", Verb("wave hello", "waves hello", "waving hello", "wave hello")),
)
_DEEDS = {
    "loco": Verb("walk", "walks", "walking", "walk"),
    "sitdown": Verb("sit down", "sits down", "sitting down", "sit"),
    "standup": Verb("stand up", "stands up", "standing up", "rise"),
    "liedown": Verb("lie down", "lies down", "lying down", "rest"),
    "getup": Verb("get up", "gets up", "getting up", "getting up"),
    "touch": Verb("reach out", "reaches out", "reaching out", "reach"),
    "squat": Verb("squat", "squats", "squatting", "squat"),
    "idle": Verb("stand", "stands", "standing", "pause"),
}
_MANNERS = (
    (r"zombie", "like a zombie", "zombie-like"),
    (r"sneak|stealth", "quietly", "quiet"),
    (r"slow", "slowly", "slow"),
    (r"brisk|hurr|fast", "in a hurry", "hurried"),
    (r"exaggerat|large", "with large steps", "large-stepped"),
    (r"turn", "with turns", "winding"),
    (r"tired|sleep", "tiredly", "tired"),
    (r"angry", "angrily", "angry"),
    (r"sad", "sadly", "sad"),
    (r"dizzy|drunk", "unsteadily", "unsteady"),
    (r"shiver|cold", "shivering", "shivering"),
    (r"formal", "formally", "formal"),
    (r"backward", "backwards", "backward"),
    (r"friend", "in a friendly way", "friendly"),
    (r"balance", "keeping the balance", "careful"),
)


_WORD = re.compile(r"[A-Z]?[a-z']+|[A-Z]+(?![a-z])")
"""Words that stand apart or are told apart by capitals."""


def skill_of(text: str) -> str:
    """The skill that a clip's name or caption tells of; "other" where it tells of none."""
    plain = text.lower().replace("_", " ")
    return next((skill for skill, pattern in _SKILLS if re.search(pattern, plain)), "other")


def emotion_of(style: str, text: str) -> Emotion:
    """The emotion that a style names, else the one that a caption or a file's name does ("ZombieWalk_02")."""
    told = (emotion_words.emotion_of(" ".join(_WORD.findall(one))) for one in (style, text))
    return next(filter(None, told), Emotion.NEUTRAL)


def ways_to_say(skill: str, style: str, caption: str) -> tuple[str, ...]:
    """Five different captions of one clip: its own first, if it has one, then some made from skill and style."""
    own = re.sub(r"^a person does: ", "", caption.strip())
    told = f"{style} {own}".lower()
    deed = next((verb for pattern, verb in _VERBS if re.search(pattern, told)), _DEEDS.get(skill))
    if deed is None:
        words = own or style or "move"
        made = [f"a person: {words}", f"someone: {words}", f"a body: {words}", f"the motion {words}", words]
    else:
        how, kind = next(((how, kind) for pattern, how, kind in _MANNERS if re.search(pattern, told)), ("", "plain"))
        after = f" {how}" if how and how not in deed.plain else ""
        article = "an" if kind[0] in "aeiou" else "a"
        made = [
            f"{deed.doing}{after}",
            f"{deed.plain}{after}",
            f"someone {deed.third}{after}",
            f"a person is {deed.doing}{after}",
            f"{article} {kind} {deed.noun}",
        ]
    found = [own, *made] if own else made
    return tuple(dict.fromkeys(found))[:WAYS]


TABLE = "manifest.csv"
NO_MOTION = frozenset({"labels", "skeleton", "licence"})
"""Kinds of rows whose file holds no motion."""
_MAX_LABELS_BYTES = 16 << 20
_PLACE = ("file", "clip", "start", "stop")
_WORDS = ("skill", "style", "caption", "subject", "licence", "kind", "source")


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
    start: float = 0.0
    """Seconds where it begins, as the file counts them."""
    stop: float | None = None
    """Seconds where it ends; None for the end of the file."""

    @property
    def segment(self) -> bool:
        """Whether it is of a part of a clip."""
        return self.start > 0 or self.stop is not None


Labels = dict[tuple[str, str], tuple[Label, ...]]
"""By file, from the folder, and clip ("" for all clips of a file): one row, or one a segment."""


def read_labels(path: Path) -> Labels:
    """The rows of a table. ClipError names the line that is wrong."""
    try:
        if path.stat().st_size > _MAX_LABELS_BYTES:
            raise ClipError(f"{path.name}: a table of clips has at most {_MAX_LABELS_BYTES >> 20} MB")
        text = path.read_text(encoding="utf-8-sig")
        rows = csv.DictReader(io.StringIO(text), strict=True)
        if "file" not in (rows.fieldnames or ()):
            raise ClipError(
                f"{path.name}: its first line must name the columns, among them file: {', '.join((*_PLACE, *_WORDS))}"
            )
        if len(set(rows.fieldnames or ())) < len(rows.fieldnames or ()):
            raise ClipError(f"{path.name}: its first line names a column twice")
        found: dict[tuple[str, str], dict[tuple[float, float | None], Label]] = {}
        for row in rows:
            if None in row.values() or None in row:
                raise ClipError(f"{path.name}, line {rows.line_num}: as many cells as columns are needed")
            told = {name: row.get(name, "").strip() for name in (*_WORDS, *_PLACE)}
            file, clip, start, stop = (told.pop(name) for name in _PLACE)
            rows_so_far = found.setdefault((Path(file).as_posix(), clip), {})
            span = _span(start, stop, f"{path.name}, line {rows.line_num}")
            if span in rows_so_far:
                raise ClipError(f"{path.name}, line {rows.line_num}: {file!r:.80} has a row already")
            rows_so_far[span] = Label(**told, start=span[0], stop=span[1])
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ClipError(f"{path.name}: not a table of clips: {error}") from error
    return {key: tuple(rows.values()) for key, rows in found.items()}


def _span(start: str, stop: str, where: str) -> tuple[float, float | None]:
    try:
        begins, ends = float(start or 0.0), float(stop) if stop else None
    except ValueError as error:
        raise ClipError(f"{where}: start and stop are seconds: {error}") from error
    if not (0.0 <= begins < math.inf and (ends is None or begins < ends < math.inf)):
        raise ClipError(f"{where}: a segment starts at 0 s or later and stops after that, not {start!r} to {stop!r}")
    return begins, ends


def labels_of(labels: Labels, file: str, clip: str) -> tuple[Label, ...]:
    """What is known of a clip, once a segment; skill and subject are told from names where no row says them.

    A row for a whole file that lists several skills leaves each clip's to its own name.
    """
    rows = labels.get((file, clip)) or labels.get((file, "")) or (Label(),)
    return tuple(_completed(row, file, clip, (file, clip) in labels) for row in rows)


def _completed(row: Label, file: str, clip: str, own: bool) -> Label:
    """A row with what names tell. own: whether it names the clip itself, not its file."""
    skills = [one.strip() for one in row.skill.split(";") if one.strip()]
    kept = [one for one in skills if not one.endswith("-reversed")]
    named = skill_of(clip.rsplit("/", 1)[-1])
    many = clip not in ("", Path(file).stem)
    skill = kept[0] if kept and not many else named
    caption = "" if many and not own else row.caption
    style = clip.rsplit("/", 1)[-1].replace("_", " ").lower() if many and not own else row.style
    return replace(
        row,
        skill=skill if skill != "other" or not kept else kept[0] if not many else "other",
        style=style,
        caption=caption,
        subject=row.subject or subject_of(file),
        kind=row.kind or "unknown",
    )


def subject_of(file: str) -> str:
    """Who moved, from a file's name: trials are numbered subject_trial; other files share their folder's."""
    path = Path(file)
    trial = re.match(r"(\d{1,3})_\d", path.stem)
    if trial:
        return f"trial subject {int(trial[1])}"
    return path.name if path.suffix in (".glb", ".gltf") else str(path.parent)
