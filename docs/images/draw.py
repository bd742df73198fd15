"""The pictures of the docs, made by our own code: `python docs/images/draw.py` writes them here, all but page.png.

That one a browser takes of the demo's story: `node docs/images/page.mjs URL`, with the URL of a service.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from motion_backend.motion import Skill
from motion_backend.rendering.contact_sheet import sheet
from motion_backend.rendering.film_loop import moment, write_loop
from planner_service.cli.layouts import graph_of_words
from planner_service.evaluation.trials import Trial, perform
from planner_service.output.cast_sheet import cast_sheet
from planner_service.output.room_pictures import Shown, picture
from planner_service.output.storyboard import COLUMNS, GAP, HEAD, PLAN, SIDE, TEXT, storyboard
from planner_service.pipeline import Pipeline, Story, StoryRequest
from scene_graphs.plots.match_plot import draw_match
from scene_graphs.retrieval.layout_index import LayoutIndex

HERE = Path(__file__).parent
MAKEFILE = HERE.parents[1] / "Makefile"
"""It has the theme and the seed of the demo."""
SHOWN = (1, 3, 5, 6)
"""Keyframes cut out of the storyboard, two in a row."""
MOMENTS = ((1, 2.4), (3, 1.8), (5, 2.4), (6, 4.0))
"""Keyframes of the moving picture, and how many seconds around their middles it shows."""
LOOP = (480, 270)
"""Its size in pixels."""
PLAN_OF = "living-room-0016"
ASKED = ("sofa:lie", "coffee-table", "tv-stand,", "bench:sit", "bookshelf", "wardrobe,", "piano")
"""The query of the match view, as `sims layouts find` takes it."""
ASKED_OF = "living_room"
ACTED = (
    (Skill.LOCO, "walk on tiptoes"),
    (Skill.SITDOWN, "right hand on chin, thinking"),
    (Skill.LIEDOWN, "lying with hands under head, legs crossed"),
)
"""The captions of the contact sheet."""
ACTED_IN = ("bedroom-0027", 1)
"""Where, and with which seed."""
COLORS = 200


def main() -> None:
    """Make the demo's story and write the pictures."""
    pipeline = Pipeline()
    index = pipeline.shelves.layouts()
    with tempfile.TemporaryDirectory() as folder:
        story = pipeline.make(demo())
        board = draw_board(story, Path(folder, "board.png"))
        moments = [moment(story.segments[number], seconds, story.motion.fps) for number, seconds in MOMENTS]
        write_loop(story.planned.home, story.motion, story.segments, moments, HERE / "film.webp", LOOP, story.role)
        picture(index.layout(PLAN_OF), Shown(), Path(folder, "plan.png"))
        draw_found(index, Path(folder, "match.png"))
        save(cut(board, SHOWN), HERE / "storyboard.png")
        save(draw_acted(), HERE / "sheet.png")
        # Skin and cloth have more colours than a palette.
        Image.fromarray(cast_sheet()).save(HERE / "cast.png", optimize=True)
        for name in ("plan.png", "match.png"):
            # Lines of few pixels keep their colours, which mean something.
            save(np.asarray(Image.open(Path(folder, name)).convert("RGB")), HERE / name, Image.Quantize.MAXCOVERAGE)


def demo() -> StoryRequest:
    """What `make demo` asks for."""
    told = dict(re.findall(r"^(THEME|THEME_SEED) \?= (.+)$", MAKEFILE.read_text(encoding="utf-8"), re.MULTILINE))
    return StoryRequest(told["THEME"], seed=int(told["THEME_SEED"]))


def draw_board(story: Story, path: Path) -> np.ndarray:
    """The whole storyboard as pixels. (H, W, 3)."""
    planned, targets = story.planned, [action.object_id for action in story.actions]
    storyboard(planned.home, story.motion, planned.script.keyframes, path, planned.told.title, targets, story.role)
    return np.asarray(Image.open(path).convert("RGB"))


def draw_acted() -> np.ndarray:
    """A contact sheet of our body, as `sims clips sheet` draws it. (H, W, 3)."""
    done = [perform(Trial(skill, caption, *ACTED_IN)) for skill, caption in ACTED]
    rows = [(f"{one.trial.skill}: {one.trial.caption}", one.motion) for one in done]
    return sheet(rows, done[0].home, roles=[one.role for one in done])


def draw_found(index: LayoutIndex, path: Path) -> None:
    """The query beside the room that is nearest to it."""
    query = graph_of_words(list(ASKED))
    (match,) = index.search(query, 1, ASKED_OF)
    draw_match(query, [index.layout(match.layout_id)], match, path)


def cut(board: np.ndarray, shown: tuple[int, ...]) -> np.ndarray:
    """Some keyframes of a storyboard, two in a row. (H, W, 3)."""
    width, height = SIDE[0] + PLAN[0] + 4 + 2 * GAP, SIDE[1] + TEXT + GAP
    cells = []
    for index in shown:
        row, column = divmod(index, COLUMNS)
        top, left = HEAD + row * height, column * width
        cells.append(board[top : top + height, left : left + width])
    return np.concatenate([np.concatenate(cells[i : i + 2], axis=1) for i in range(0, len(cells), 2)])


def save(pixels: np.ndarray, path: Path, method: Image.Quantize = Image.Quantize.MEDIANCUT) -> None:
    """Write a PNG with a palette, as small as it gets."""
    flat = Image.fromarray(pixels).quantize(COLORS, method, dither=Image.Dither.NONE)
    flat.save(path, optimize=True)


if __name__ == "__main__":
    main()
