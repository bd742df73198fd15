"""The README's pictures, made by our own code: `python docs/images/draw.py` writes storyboard.png and plan.png here."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from planner_service.stories import Story, StoryRequest, Studio
from planner_service.storyboard import COLUMNS, GAP, HEAD, PLAN, SIDE, TEXT, storyboard
from scene_graphs.drawing import draw_layout

HERE = Path(__file__).parent
THEME = (
    "A person is happy at first, but he is told in the phone that he fails the job interview and becomes very "
    "depressed."
)
"""The demo's, with the demo's seed."""
SEED = 7
SHOWN = (1, 7, 10, 17)
"""Keyframes cut out of the storyboard, two in a row."""
PLAN_OF = "living-room-0016"
COLORS = 200


def main() -> None:
    """Make the demo's story and write both pictures."""
    studio = Studio()
    with tempfile.TemporaryDirectory() as folder:
        board = draw_board(studio.make(StoryRequest(THEME, seed=SEED)), Path(folder, "board.png"))
        plan = Path(folder, "plan.png")
        draw_layout(studio.shelves.layouts().layout(PLAN_OF), plan)
        save(cut(board, SHOWN), HERE / "storyboard.png")
        save(np.asarray(Image.open(plan).convert("RGB")), HERE / "plan.png")


def draw_board(story: Story, path: Path) -> np.ndarray:
    """The whole storyboard as pixels. (H, W, 3)."""
    planned, targets = story.planned, [action.object_id for action in story.actions]
    storyboard(planned.home, story.motion, planned.script.keyframes, path, planned.told.title, targets)
    return np.asarray(Image.open(path).convert("RGB"))


def cut(board: np.ndarray, shown: tuple[int, ...]) -> np.ndarray:
    """Some keyframes of a storyboard, two in a row. (H, W, 3)."""
    width, height = SIDE[0] + PLAN[0] + 4 + 2 * GAP, SIDE[1] + TEXT + GAP
    cells = []
    for index in shown:
        row, column = divmod(index, COLUMNS)
        top, left = HEAD + row * height, column * width
        cells.append(board[top : top + height, left : left + width])
    return np.concatenate([np.concatenate(cells[i : i + 2], axis=1) for i in range(0, len(cells), 2)])


def save(pixels: np.ndarray, path: Path) -> None:
    """Write a PNG with a palette, as small as it gets."""
    flat = Image.fromarray(pixels).quantize(COLORS, dither=Image.Dither.NONE)
    flat.save(path, optimize=True)


if __name__ == "__main__":
    main()
