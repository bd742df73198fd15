"""What the body is to keep: the limits of figures over trials of captions and over whole stories (docs/metrics.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from motion_backend.metrics.figure_words import missed_words
from motion_backend.metrics.joint_speed import MOST as FASTEST_JOINT
from motion_backend.motion import RISINGS, Skill

CONTACTS: Final = (Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH)
UPRIGHT: Final = (Skill.LOCO, Skill.TOUCH)


@dataclass(frozen=True)
class Limit:
    """What a figure must keep, in metres, seconds, radians and shares; over the trials of some skills."""

    figure: str
    most: float | None = None
    least: float | None = None
    skills: tuple[Skill, ...] = tuple(Skill)

    def missed(self, value: float) -> bool:
        """Whether a value does not keep it."""
        return (self.most is not None and value > self.most) or (self.least is not None and value < self.least)


LIMITS: Final = (
    Limit("caption_kept", least=0.95),
    Limit("reached", least=0.98, skills=(Skill.SITDOWN,)),
    Limit("reached", least=0.97, skills=(Skill.LIEDOWN,)),
    Limit("reached", least=0.98, skills=(Skill.TOUCH,)),
    Limit("contact_error", most=0.02, skills=CONTACTS),
    Limit("contact_mean", most=0.02, skills=CONTACTS),
    Limit("skate_ratio", most=0.16, skills=(Skill.LOCO,)),
    Limit("slip", most=3.0, skills=(Skill.LOCO,)),
    Limit("pen_mean", most=0.01),
    Limit("pen_share", most=0.02),
    Limit("pen_max", most=0.05),
    Limit("skin_pen_share", most=0.02),
    Limit("skin_pen_max", most=0.05),
    Limit("limits_share", most=0.0),
    Limit("joint_speed", most=FASTEST_JOINT),
    Limit("frozen_share", most=0.01),
    Limit("zmp_upright", most=0.015, skills=UPRIGHT),
    Limit("zmp_rising", most=0.04, skills=RISINGS),
    Limit("jerk_against_real", least=0.5, most=1.5, skills=(Skill.LOCO,)),
)
"""Over trials of all captions; `judge` (story_metrics.py) says what each figure is."""
STORY_LIMITS: Final = (
    Limit("success", least=0.97),
    Limit("contact_error", most=0.02),
    Limit("contact_mean", most=0.02),
    Limit("skate_ratio_loco", most=0.16),
    Limit("slip", most=3.0),
    Limit("pen_mean", most=0.01),
    Limit("pen_share", most=0.02),
    Limit("pen_max", most=0.05),
    Limit("skin_pen_share", most=0.02),
    Limit("skin_pen_max", most=0.05),
    Limit("limits_share", most=0.0),
    Limit("joint_speed", most=FASTEST_JOINT),
    Limit("frozen_share", most=0.01),
    Limit("zmp_upright", most=0.015),
    Limit("zmp_rising", most=0.04),
    Limit("jerk_against_real", least=0.5, most=1.5),
    Limit("seam_jump", most=0.03),
    Limit("seam_speed_jump", most=1.0),
    Limit("walk_seam_stops", most=0.10),
    Limit("walk_seam_flows", least=0.80),
    Limit("still_share", most=0.05),
    Limit("touch_wait", most=0.25),
    Limit("spot_turning", most=0.20),
)
"""Over a whole story, and over many."""


def held_against(figures: Mapping[str, Any], limits: Sequence[Limit] = STORY_LIMITS) -> list[dict[str, Any]]:
    """Every limited figure that is there beside its limit, whether it is kept, and if not, what that means in everyday
    words; for reports."""
    rows = []
    for limit in limits:
        value = figures.get(limit.figure)
        if value is None:
            continue
        missed = limit.missed(value)
        words = missed_words(limit.figure, value, limit.least, limit.most) if missed else None
        rows.append(
            {
                "figure": limit.figure,
                "value": value,
                "least": limit.least,
                "most": limit.most,
                "kept": not missed,
                "words": words,
            }
        )
    return rows
