"""What a theme says lasts is held longer, and nothing else."""

from __future__ import annotations

from for_each import for_each

from motion_backend.motion import Action, Emotion, Skill
from planner_service.grounding.dwell_time import LONGER, lingering

STANDING = Action(Skill.LOCO, "stand still", Emotion.NEUTRAL)
AT_A_WINDOW = Action(Skill.LOCO, "stand still", Emotion.NEUTRAL, goal=(1.0, 2.0), stands=2.5)
WALKING = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=(1.0, 2.0))
SITTING = Action(Skill.SITDOWN, "sitting still", Emotion.NEUTRAL)
TOUCHING = Action(Skill.TOUCH, "touch medium height", Emotion.NEUTRAL)


@for_each(
    ("action", "said", "seconds"),
    [
        (STANDING, "waits", LONGER),
        (STANDING, "stares at it for a long while", LONGER),
        (AT_A_WINDOW, "watches the street until the lamps come on", LONGER),
        (SITTING, "sits there for hours", LONGER),
        (SITTING, "sits down", 0.0),
        (STANDING, "looks at the waiter", 0.0),
        (WALKING, "walks up and down until dawn", 0.0),
        (TOUCHING, "wipes the table for hours", 0.0),
    ],
)
def test_what_lasts_is_held_longer(action: Action, said: str, seconds: float) -> None:
    held = lingering(action, said)
    assert (held.hold + held.stands) - (action.hold + action.stands) == seconds
