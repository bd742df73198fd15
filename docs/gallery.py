"""What of the docs moves, and every caption: `python docs/gallery.py` films the ten stories and draws the sheets anew.

It takes a few minutes. The pages of the stories are written by docs/stories.py.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image
from stories import EXAMPLES, FOLDER, request

from motion_backend.motion import Skill
from motion_backend.rendering.film_loop import moment, write_loop
from planner_service.composition.caption_meanings import find_captions
from planner_service.output.caption_sheets import vocabulary_sheets
from planner_service.pipeline import Pipeline, Story

LOOP = (400, 224)
"""Pixels of a moving picture; both even."""
MOMENTS, SECONDS = 5, 1.7
"""How many of a story it shows at most, each for how long."""
SHEETS = Path(__file__).resolve().parent / "captions"
SEED, SHRUNK, QUALITY = 1, 2, 55
"""Of the sheets: the seed, how many times smaller they are shown than drawn, and WebP's quality."""


def main() -> None:
    """Write all of them, or the words alone."""
    if sys.argv[1:] != ["words"]:
        pipeline = Pipeline()
        for example in EXAMPLES:
            write_story_loop(pipeline.make(request(example)), FOLDER / f"{example.file}.webp")
        write_sheets()
    SHEETS.with_suffix(".md").write_text(caption_page(), encoding="utf-8")


def write_story_loop(story: Story, path: Path) -> None:
    """A story's keyframes, or as many of them as there is time for."""
    chosen = np.unique(np.linspace(0, len(story.segments) - 1, MOMENTS).round().astype(int))
    each = SECONDS * MOMENTS / len(chosen)
    moments = [moment(story.segments[k], each, story.motion.fps) for k in chosen]
    write_loop(story.planned.home, story.motion, story.segments, moments, path, LOOP, story.role)


def write_sheets() -> None:
    """Every known caption, a picture a page."""
    SHEETS.mkdir(exist_ok=True)
    for skill in Skill:
        for name, picture in vocabulary_sheets([skill], None, SEED):
            page = Image.fromarray(picture)
            page.resize((page.width // SHRUNK, page.height // SHRUNK), Image.Resampling.LANCZOS).save(
                SHEETS / Path(name).with_suffix(".webp"), quality=QUALITY, method=6
            )


def caption_page() -> str:
    """The page of the docs that has every known caption in words, and shows the pictures there are."""
    lines = [
        "# Every caption",
        "",
        "What the body knows to do: how a script says it, the deeds of a theme that are seen in it, and other words",
        "that are read as it (`sims captions WORDS` finds them; so does the page). Below each skill its captions are",
        "acted in rooms of the library by the default backend: moments from left to right, with what was acted, at",
        "which piece of furniture, where, and how far hand, seat or bed are off. `sims clips sheet` draws them larger;",
        "`python docs/gallery.py` draws them anew, and `python docs/gallery.py words` writes the words alone.",
    ]
    for skill in Skill:
        lines += ["", f"## {skill}: {skill.words}", "", "| caption | seen as | also said |", "|---|---|---|"]
        for one in find_captions(skill=skill):
            lines.append(f"| {one.caption} | {', '.join(one.shows)} | {'; '.join(one.others[:2])} |")
        lines.append("")
        for path in sorted(SHEETS.glob(f"{skill}-*.webp")):
            lines.append(f"![{skill}: {path.stem.partition('-')[2]}](captions/{path.name})")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
