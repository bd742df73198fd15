"""Parts that are no walk in full stride: the procedural body plans them, the model of all skills acts them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from motion_backend.backend_protocol import BodyState, Part, PartKind
from motion_backend.diffusion.plan_follower import LAID_OVER, Followed, PlanFollower
from motion_backend.diffusion.planned_passages import passages_of
from motion_backend.motion import Motion, Posture
from motion_backend.procedural.walk.walk_styles import style_of, walk_style
from motion_backend.walk_driver import BORROWED, by_rules, ruled
from scene_graphs.home import Home

SINCE: Final = "since"
"""What a state remembers of how long it has sat or lain there, sitting down counted in."""


@dataclass(frozen=True)
class LearnedParts:
    """Acts what the procedural body plans."""

    follower: PlanFollower

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """A part from a state; what the model cannot do is the procedural body's, with the reason."""
        plan, after = ruled(home, part, upcoming, state)
        if not len(plan) or not plan.completed:
            return by_rules(plan, plan.reason), after
        done = self._followed(home, part, plan, state, len(plan))
        after = replace(after, memory={**after.memory, SINCE: done.since})
        if not done.missed:
            return done.motion, after
        history = state.history.followed_by(done.motion)
        return done.motion, replace(after, history=history, memory={**after.memory, BORROWED: True})

    def act(self, home: Home, part: Part, plan: Motion, state: BodyState, frames: int) -> Motion:
        """So many frames of a plan acted by the model; where it cannot, the plan's, which say why."""
        return self._followed(home, part, plan, state, frames).motion

    def _followed(self, home: Home, part: Part, plan: Motion, state: BodyState, frames: int) -> Followed:
        passages = passages_of(home, part, plan, _since(part, state), frames)
        return self.follower.follow(passages, plan.notes, state, _laid_over(part))


def _since(part: Part, state: BodyState) -> int:
    """Frames that what is held has gone on for already."""
    held = part.kind is PartKind.HOLD and state.posture is not Posture.STANDING
    return int(state.memory.get(SINCE, 0)) if held else 0


def _laid_over(part: Part) -> str:
    """Why arms of the plan are laid over the model's, which has not learned what hands do; empty where they are not."""
    if part.kind is PartKind.HOLD:
        return LAID_OVER
    if part.kind not in (PartKind.WALK, PartKind.TURN):
        return ""
    style, usual = style_of(part.action), walk_style(part.action.emotion, "walk")
    posed = style.bearing.arms != usual.bearing.arms or style.doing != usual.doing
    return LAID_OVER if posed else ""
