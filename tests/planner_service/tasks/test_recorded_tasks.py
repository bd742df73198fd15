"""Instructions become the steps and keyframes that they became when somebody last read them."""

from __future__ import annotations

from typing import Any

from recorded import agrees

from planner_service.tasks.instruction import Order, orders_of
from planner_service.tasks.surroundings import Surroundings
from planner_service.tasks.task_actions import act_out
from planner_service.tasks.task_llm import TaskStep, TaskSteps, problems_in
from planner_service.tasks.task_plan import TaskError
from planner_service.tasks.task_planner import plan_routine, plan_task
from planner_service.tasks.task_rules import plan_by_rules
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
SHORTER = (
    "sit down on the sofa, relax and then get up",
    "open the window, look out of it and close it again",
    "take the book from the shelf and put it on the nightstand",
    "bring a glass of water to the coffee table and drink from it",
    "with both hands, lift the box and carry it to the wardrobe",
    "never mind the lamp, turn on the TV and watch a film",
    "fetch the phone, call your mother and put the phone back",
    "lie down on the bed, take a nap and wake up",
    "wipe the dining table with a sponge using the left hand",
    "stack the plates and the cups in the cabinet",
    "go to the desk, write a letter, fold it and throw it into the bin",
    "iron the shirt and hang it in the wardrobe",
    "walk to the mirror, brush your hair and put on a hat",
    "play the piano with both hands",
    "water the plants by the window, then sweep the floor",
    "before sitting down, wash your hands",
    "read the newspaper in the armchair until noon",
    "drag the chair to the table and sit on it",
    "eat an apple while standing",
    "pour some wine into two glasses and toast",
    "knock on the door, wait, then enter",
    "get the remote, switch the channel, and lay it on the sofa",
    "please pick up your toys and put them into the closet",
    "do ten push-ups and then stretch",
    "close your eyes, take a deep breath and count to ten",
    "make the bed; fluff the pillows; draw the curtains",
    "type an email, print it and sign it with a pen in the right hand",
    "dust the top of the bookshelf and touch the low shelf",
    "jump out of the window",
    "teleport to the moon",
    "run",
    "hold the umbrella in your left hand and walk around the room twice",
    "return the cup to the kitchen counter after drinking the coffee",
    "grab a blanket and cover yourself on the couch",
    "do not sit; kneel on the rug and pray",
)
"""Of which only what is to be done is kept."""


def test_instructions_are_as_recorded() -> None:
    home = home_from_layouts([built_in_index().layout(ROOM)], 0)
    rooms = {"here": Surroundings(home), "anywhere": Surroundings()}
    agrees("instructions", {words: read(words) | planned(words, rooms) for words in SHORTER})


def read(words: str) -> dict[str, Any]:
    """Its orders, a line each, or why there are none."""
    try:
        return {"orders": [line(order) for order in orders_of(words)]}
    except TaskError as error:
        return {"refused": str(error)}


def line(order: Order) -> str:
    places = " ".join(f"{word} {what};" for word, what in order.places)
    told = (order.kind, order.verb, order.thing, order.said, places, order.tool, order.needs, order.furniture)
    return " | ".join([*told, order.source, order.target, order.phrase, f"{order.hand} {order.hands} {order.goes}"])


def planned(words: str, rooms: dict[str, Surroundings]) -> dict[str, Any]:
    """What a body acts of it, a line a step and a keyframe."""
    found: dict[str, Any] = {}
    for where, room in rooms.items():
        try:
            steps, keyframes = act_out(plan_by_rules(words, room), room, 1)
        except TaskError as error:
            found[where] = str(error)
            continue
        acted = [f"{one.skill} {one.caption} | {one.furniture} | {one.emotion}" for one in keyframes]
        found[where] = [*(" ".join(map(str, step.model_dump().values())) for step in steps), *acted]
    return found


ANSWERS = (
    (1, "walk to the desk", "locomotion", None, None),
    (3, "pick up the pen with the left hand", "grasp", "left", "pen"),
    (3, "pick up the pen with the left hand", "grasp", "right", "pen"),
    (4, "grab the cup", "grasp", "null", "cup"),
    (5, "open the drawer", "interaction", None, "drawer"),
    (6, "sit down", "interaction", "both", None),
    (7, "wave", "gesture", "Third", "x, y"),
    (8, "", "interaction", "right", "<b>"),
    (9, "put it down, then go", "grasp", " Right ", "o" * 300),
    (10, "do not sit down", "interaction", None, None),
)


def test_what_is_wrong_with_a_models_steps_is_as_recorded() -> None:
    fields = ("step_id", "step", "category", "hand", "object")
    steps = [TaskStep(**dict(zip(fields, row, strict=True))) for row in ANSWERS]
    agrees("model_steps", {
        "faults": problems_in(TaskSteps(steps=steps)),
        "none": problems_in(TaskSteps(steps=[])),
        "too many": problems_in(TaskSteps(steps=steps[:1] * 99)),
    })  # fmt: skip


def test_tasks_are_as_recorded() -> None:
    home = home_from_layouts([built_in_index().layout(ROOM)], 0)
    found: dict[str, Any] = {words: plan_task(words, home).model_dump(mode="json") for words in INSTRUCTIONS}
    agrees("tasks", found | {"a routine": plan_routine(home, 20, seed=1).model_dump(mode="json")})
