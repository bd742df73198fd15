"""Instructions become the steps and keyframes that they became when somebody last read them."""

from __future__ import annotations

from typing import Any

from recorded import agrees

from planner_service.tasks.task_planner import plan_routine, plan_task
from scene_graphs.home import home_from_layouts
from scene_graphs.layout_library import built_in_index

ROOM = "living-room-0016"
INSTRUCTIONS = (
    "make a cup of tea with the left hand and drink it on the sofa",
    "watch TV, then turn it off",
    "wave with the right hand",
    "pick up the phone and the pen and put them on the coffee table",
    "play a game with both hands",
    "bring the book to the shelf and read another one while sitting",
    "walk around, lie down, stand up and open the window",
    "clean the table with a cloth, then throw it away",
)


def test_tasks_are_as_recorded() -> None:
    home = home_from_layouts([built_in_index().layout(ROOM)], 0)
    found: dict[str, Any] = {words: plan_task(words, home).model_dump(mode="json") for words in INSTRUCTIONS}
    agrees("tasks", found | {"a routine": plan_routine(home, 20, seed=1).model_dump(mode="json")})
