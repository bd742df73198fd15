"""A plan of the procedural body as the model is told it: passages, and what is wished for in each window of them.

The plan says where the pelvis or the hand is to be, and when; how the body gets there is the model's. Told is what was
told in training (windows.py): in locomotion where the window ends, else where the passage ends and the seconds to go.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.backend_protocol import Part, PartKind
from motion_backend.diffusion.conditions import MadeOf
from motion_backend.diffusion.dataset import NEAR, PERIODIC, PHASES, WALKING
from motion_backend.diffusion.goal_cleanup import eased, held_shares
from motion_backend.diffusion.motion_features import HISTORY, STRIDE, WINDOW, HeadingFrame, Poses, to_features, twist
from motion_backend.diffusion.rollout import HandGoal, PelvisGoal, Wish
from motion_backend.diffusion.scene_encoder import voxel_image
from motion_backend.diffusion.windows import SEATS, settled
from motion_backend.motion import FPS, Motion, PhaseKind, Skill, join
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX
from motion_backend.walk_driver import SMOOTH
from motion_backend.walk_generator import LOOK
from scene_graphs.geometry.occupancy_grid import occupancy_pair
from scene_graphs.home import Home

WIDE: Final = 18
"""Frames beyond the ends of a way that count for its smoothness."""
STOPPED, STOPS = 0.15, 24
"""Metres a second at which who has walked stands, and frames in which he comes to it."""
SURE: Final = 2
"""Frames from the last known one to the middle of the first new one at 10 a second, which frame numbers are of."""


@dataclass(frozen=True)
class PlannedPassage:
    """One passage of a plan."""

    home: Home
    part: Part
    phase: PhaseKind
    plan: Motion
    """Its frames, as the procedural body would do it."""
    onward: Motion | None = None
    """How the plan goes on in the same phase, where it is not followed to its end."""
    since: int = 0
    """Frames in which it has gone on already, in the part before: who sits there has sat down before that."""

    @property
    def kind(self) -> PartKind:
        """What the model knows it as."""
        return PHASES[self.phase]

    @property
    def is_periodic(self) -> bool:
        """Whether it is locomotion, which is told no time."""
        return self.kind in PERIODIC

    @property
    def is_seat(self) -> bool:
        """Whether its goal has a height and a facing, and it is over when the scheduler says so."""
        return self.kind in SEATS

    @property
    def is_free(self) -> bool:
        """Whether arms are in nothing on purpose: in locomotion, standing and sitting down."""
        return self.is_periodic or (self.part.kind is PartKind.SIT and not self.since)

    @property
    def caption(self) -> str:
        """What it is called."""
        action = self.part.action
        return WALKING if self.is_periodic and action.skill is not Skill.LOCO else action.caption

    @property
    def hand(self) -> tuple[Array, bool] | None:
        """Where which hand is to be (3,), and whether it is the left one; None where no hand has a goal."""
        goal = next((goal for goal in self.part.contacts if goal.joint.endswith("_wrist")), None)
        if self.kind is not PartKind.REACH or goal is None:
            return None
        return np.array(goal.position), goal.joint.startswith("left")

    @property
    def due(self) -> int:
        """The frame of the plan in which the hand is at its goal, or the pelvis where it stays."""
        told = self.hand
        if told is None:
            return settled(self.plan.root_positions.astype(np.float64)) if self.is_seat else len(self.plan) - 1
        wrists = self.plan.joint_positions()[:, INDEX["left_wrist" if told[1] else "right_wrist"]]
        away = np.linalg.norm(wrists - told[0], axis=1)
        return int(np.argmax(away < away.min() + NEAR))

    @cached_property
    def told(self) -> Motion:
        """What its goals are told of: a walk that goes on is not told to stop."""
        return self.plan if self.onward is None else join([self.plan, self.onward])

    def wish(self, done: int, frame: HeadingFrame, seen: bool) -> Wish:
        """What is told of the window that begins after `done` frames of it; `seen` with what stands around."""
        at = min(done + LOOK, len(self.told)) - 1 if self.is_periodic else len(self.plan) - 1
        place = self.told.root_positions[at].astype(np.float64)
        voxels = self._voxels(frame, place) if seen else None
        number, left = (0, None) if self.is_periodic else (self.since + done + SURE, self._left(done))
        hand = self.hand
        if hand is not None:
            assert left is not None
            reaching = HandGoal(hand[0][None], hand[1], left)
            return Wish(self.caption, None, reaching, number, MadeOf.PROCEDURAL, voxels=voxels)
        goal = PelvisGoal(place[None], np.array([self.facing(at)]), self.is_seat, left)
        return Wish(self.caption, goal, None, number, MadeOf.PROCEDURAL, voxels=voxels)

    def way(self, done: int) -> Array:
        """Where the pelvis is to be in the new frames of the window after `done` frames, without its sway. (14, 3)."""
        from scipy.ndimage import gaussian_filter1d

        # Beyond its ends a way goes on as it begins and ends: smoothed, it is not drawn back from them.
        places = self.told.root_positions.astype(np.float64)
        before, after = 2 * places[0] - places[:0:-1], 2 * places[-1] - places[-2::-1]
        whole = np.concatenate([before[-WIDE:], places, after[:WIDE]])
        begins = min(len(before), WIDE)
        smooth = gaussian_filter1d(whole, SMOOTH, axis=0, mode="nearest")[begins : begins + len(places)]
        return np.asarray(smooth[np.minimum(_keys(done), len(smooth) - 1)])

    def pose(self, done: int, frame: HeadingFrame) -> Array:
        """Features of the plan in the new frames of the window after `done` frames; at its end it stays. (14, 202)."""
        at = np.minimum(_keys(done), len(self.plan) - 1)
        roots, local = (
            values[at].astype(np.float64) for values in (self.plan.root_positions, self.plan.local_rotations)
        )
        single = HeadingFrame(frame.origin[0], np.asarray(frame.yaw)[0], frame.scale)
        return to_features(Poses(roots, local, np.zeros((len(at), 4))), single, self.plan.skeleton)

    def settled(self, done: int) -> Array:
        """How far a pose is held by then in the new frames of the window after `done` frames. (14,)."""
        return np.ones(WINDOW - HISTORY) if self.since else eased(1 - (self.due - _keys(done)) / LOOK)

    @property
    def stops(self) -> bool:
        """Whether it is a walk at whose end the body stands."""
        if self.phase is not PhaseKind.WALK or self.onward is not None or len(self.plan) < 2:
            return False
        last = self.plan.root_positions[-2:, [0, 2]].astype(np.float64)
        return float(np.linalg.norm(last[1] - last[0])) * FPS < STOPPED

    def standing(self, done: int) -> Array:
        """How far who walks or stands is held to how the plan stands in the new frames of the window after `done`
        frames: who does something where he stands throughout. (14,)."""
        if self.phase is PhaseKind.STAND and self.part.action.skill is Skill.LOCO:
            return eased((1 + _keys(done)) / LOOK)
        return eased(1 - (len(self.plan) - 1 - _keys(done)) / STOPS) if self.stops else np.zeros(WINDOW - HISTORY)

    def held(self, done: int) -> Array:
        """How far the hand is at its goal in the new frames of the window after `done` frames. (14,)."""
        return held_shares(_keys(done), self.due, round(self.part.hold * FPS))

    def facing(self, at: int) -> float:
        """The yaw at a frame of the plan; of who lies down, from the pelvis to the head."""
        if self.kind is not PartKind.LIE:
            return float(twist(self.told.local_rotations[at, 0].astype(np.float64)))
        places = self.plan.part(at, at + 1).joint_positions()[0].astype(np.float64)
        along = places[INDEX["head"]] - places[0]
        return float(np.arctan2(along[0], along[2]))

    def _left(self, done: int) -> float:
        """Seconds to go after so many frames."""
        return max(self.due - done + 1, 0) / FPS if not self.since else 0.0

    def _voxels(self, frame: HeadingFrame, place: Array) -> NDArray[np.float32]:
        """What stands around the body and its goal. (1, 64, 32, 32)."""
        here, yaw = frame.origin[0], float(np.asarray(frame.yaw)[0])
        pair = occupancy_pair(
            scene_of(self.home).heights,
            (float(here[0]), float(here[2])),
            yaw,
            (float(place[0]), float(place[2])),
            walking=self.is_periodic,
        )
        return np.asarray(voxel_image(pair)[None])


def _keys(done: int) -> NDArray[np.int64]:
    """The frames of a passage that a window after `done` frames has its new frames in. (14,)."""
    return done + STRIDE * np.arange(1, WINDOW - HISTORY + 1) - 1


def passages_of(home: Home, part: Part, plan: Motion, since: int = 0, count: int | None = None) -> list[PlannedPassage]:
    """The passages of the first `count` frames of a part's plan, in order; the first has gone on for `since` frames."""
    found: list[PlannedPassage] = []
    end = len(plan) if count is None else count
    for phase in plan.phases:
        stop = min(phase.stop, end)
        if stop > phase.start:
            frames = plan.part(phase.start, stop)
            onward = plan.part(stop, phase.stop) if phase.stop > stop else None
            found.append(PlannedPassage(home, part, phase.kind, frames, onward, 0 if found else since))
    return found
