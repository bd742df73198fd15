"""The two tables of a run, for a terminal or as the Markdown of docs/benchmarks.md."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.figure import Figure
from benchmarks.stories import Timed, quality

Rows = list[tuple[str, ...]]


def figure_rows(figures: Sequence[Figure]) -> Rows:
    """A heading and one row a figure; of the seven stories the worst counts."""
    head = ("what", "limit", "measured", "", "how")
    return [head, *((one.name, one.shown_limit, one.shown, one.verdict, one.note) for one in figures)]


def story_rows(made: Sequence[Timed]) -> Rows:
    """A heading and one row a story: what was reached and how well, and what each stage took."""
    head = (
        "story",
        "seconds",
        "reached",
        "contact",
        "pen_mean",
        "pen_share",
        "skating",
        "plan",
        "act",
        "move",
        "judge",
    )
    rows: Rows = [head]
    for one in made:
        report = one.story.report
        _, contact, pen_mean, pen_share, skating = quality(report)
        marks = (f"{contact:.2f} cm", f"{pen_mean:.2f} cm", f"{pen_share:.2f} %", f"{skating:.2f} %")
        stages = [f"{1000 * seconds:.0f} ms" for seconds in (min(one.plans), one.acted, one.moved, one.judged)]
        rows.append(
            (one.name, f"{report['seconds']:.0f}", f"{report['reached']}/{report['keyframes']}", *marks, *stages)
        )
    return rows


def plain(rows: Rows, left: Sequence[int]) -> str:
    """Columns of even width; those whose numbers are in `left` begin at the left."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = zip(row, widths, range(len(row)), strict=True)
        lines.append(
            "  ".join(cell.ljust(w) if number in left else cell.rjust(w) for cell, w, number in cells).rstrip()
        )
    return "\n".join(lines)


def markdown(rows: Rows) -> str:
    """A Markdown table."""
    head, *body = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([head, "|" + "---|" * len(rows[0]), *body])
