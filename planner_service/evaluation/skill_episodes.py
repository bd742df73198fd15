"""What the policies of the simulated body learn from and are judged by: skills in rooms of the library, by chance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import cycle
from typing import Final

import numpy as np

from motion_backend.backend_protocol import Part, PartKind
from motion_backend.contact_goals import contact_goals
from motion_backend.director import Director
from motion_backend.embedding.text_motion_embedding import TextMotionEmbedding
from motion_backend.metrics.contact_error import outcome
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Motion, Skill, join
from motion_backend.physics.backend import LOOKED_AHEAD
from motion_backend.physics.distillation import Episode
from motion_backend.physics.policies import POLICY_OF, WITH_TEXT, PolicyName
from motion_backend.physics.policy_player import Acts, PolicyPlayer
from motion_backend.physics.policy_view import View
from motion_backend.physics.task import Task, plan_of
from motion_backend.physics.tracker import fallen
from motion_backend.rotations import Array
from motion_backend.skeleton import build_skeleton
from planner_service.evaluation.acted_motion import is_for_training
from planner_service.evaluation.overheard_parts import Overheard
from planner_service.evaluation.trials import Trial, act_trial, places_for, setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.scripts.captions import captions
from scene_graphs.layout_library import built_in_index
from scene_graphs.navigation.path_planner import NoPath

LEARNED_IN, JUDGED_IN = 1602, 1603
"""Seeds of what is drawn."""
OWN: Final = {
    Skill.LOCO: (PartKind.WALK, PartKind.TURN),
    Skill.SITDOWN: (PartKind.SIT, PartKind.HOLD),
    Skill.LIEDOWN: (PartKind.LIE, PartKind.HOLD),
    Skill.TOUCH: (PartKind.REACH,),
    Skill.STANDUP: (PartKind.RISE,),
    Skill.GETUP: (PartKind.RISE,),
}
"""The parts of an action that its policy does; the walk up to a seat is another's."""


@dataclass(frozen=True)
class SkillEpisode:
    """An episode, and the action it is of."""

    trial: Trial
    episode: Episode
    part: Part
    planned: Motion

    def judged(self, policy: Acts) -> bool:
        """Whether a policy does it: to the paper's threshold, held for a second, without a fall."""
        done = PolicyPlayer.of(self.episode.view).play(policy, self.episode.start, self.episode.frames)
        task, frames = self.episode.view.task, len(done.moments) - 1
        if fallen(done.moments[-1], task.reference.qpos[frames]):
            return False
        motion = task.motion(done, replace(self.planned, goals=contact_goals(self.part.action)))
        return outcome(self.part.action, Kinematics.of(motion)).reached


def episodes(skill: Skill, seed: int, unseen: bool = False) -> Iterator[SkillEpisode]:
    """Without end, each with its own room, caption and seed; `unseen`: in the rooms that nothing is learned in."""
    rng = np.random.default_rng([seed, list(Skill).index(skill)])
    rooms = [layout.id for layout in built_in_index().layouts if is_for_training(layout.id) != unseen]
    known = captions()[skill.value]
    while True:
        trial = Trial(skill, str(rng.choice(known)), str(rng.choice(rooms)), int(rng.integers(1 << 31)))
        if (found := episode_of(trial)) is not None:
            yield found


def episodes_of(name: PolicyName, seed: int, unseen: bool = False) -> Iterator[SkillEpisode]:
    """Those of a policy's skills by turns: getting up is from seats and from lying (SIMS 4.2)."""
    drawn = [episodes(skill, seed, unseen) for skill, policy in POLICY_OF.items() if policy is name]
    for one in cycle(drawn):
        yield next(one)


def episode_of(trial: Trial) -> SkillEpisode | None:
    """None where the room has no place for it, or the plan does not do it either."""
    if not places_for(trial.skill, trial.caption, setting(trial.room)):
        return None
    asked = Overheard()
    try:
        _, actions, motions = act_trial(trial, Director(asked))
    except (UnreachableError, NoPath):
        return None
    own = [one for one in asked.steps if one.part.kind in OWN[trial.skill]]
    if not own or not motions[-1].completed:
        return None
    planned = join([one.motion for one in own])
    plan, home = plan_of(planned), setting(trial.room).home
    task = Task(
        home, build_skeleton(own[0].state.height), own[0].state.history, plan.followed_by(plan.last(LOOKED_AHEAD))
    )
    words = _words(actions[-1].caption) if POLICY_OF[trial.skill] in WITH_TEXT else np.zeros(0)
    view = View.of(task, own[0].part, planned, words)
    return SkillEpisode(trial, Episode(view, task.taken_up(own[0].state.history), len(planned)), own[0].part, planned)


@cache
def _embedding() -> TextMotionEmbedding:
    return TextMotionEmbedding.load()


@cache
def _words(caption: str) -> Array:
    return np.asarray(_embedding().texts([caption])[0], dtype=np.float64)
