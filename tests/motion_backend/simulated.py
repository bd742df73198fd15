"""Simulated motions that tests share, made once a run."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from small_home import DIRECTOR, after, small_home

from motion_backend.backend_protocol import BodyState, Part, PartKind
from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import Action, Emotion, Motion, Skill
from motion_backend.physics.mjcf_character import NU
from motion_backend.physics.mjcf_scene import Models, models_of
from motion_backend.physics.mpc import moment_of
from motion_backend.physics.reference import Plan, Reference
from motion_backend.physics.task import plan_of
from motion_backend.physics.tracker import Tracked, Tracker
from motion_backend.skeleton import build_skeleton

HOME = small_home()
NOTHING = Obstacles(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), (), np.zeros(0, dtype=bool))
WALK = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=(3.2, 4.5))


@cache
def walk() -> Motion:
    """A planned walk across the room."""
    start = replace(WALK, goal=(3.0, 1.0), facing=0.06)
    return DIRECTOR.act(HOME, WALK, after(HOME, start))[0]


@cache
def empty_room(height: float = 1.70) -> Models:
    return models_of(height, NOTHING)


def tracker_of(plan: Plan, height: float = 1.70) -> Tracker:
    skeleton = build_skeleton(height)
    return Tracker(lambda _frame: empty_room(height), Reference.of(plan, skeleton), skeleton.scale)


def tracked(plan: Plan, frames: int, height: float = 1.70) -> Tracked:
    """Some frames of a plan in an empty room, begun exactly on it."""
    tracker = tracker_of(plan, height)
    return tracker.track(moment_of(tracker.reference, 0), np.zeros((0, NU)), frames)


@cache
def stood(height: float = 1.70, seconds: float = 3) -> tuple[Plan, Tracked]:
    """A body that is to stand still."""
    state = after(HOME, height=height)
    no = np.zeros(1, dtype=np.int8)
    plan = Plan(state.history.root_positions[-1:], state.history.local_rotations[-1:], np.ones((1, 4)), no)
    frames = round(30 * seconds)
    plan = plan.last(frames + 31)
    return plan, tracked(plan, frames, height)


@cache
def walked(frames: int = 40) -> tuple[Plan, Tracked]:
    """The beginning of the walk, with its first steps."""
    plan = plan_of(walk())
    return plan, tracked(plan, frames)


def standing_still(hold: float) -> tuple[Part, BodyState]:
    """A part in which nothing is to be done but to stand, and a body that does."""
    action = Action(Skill.LOCO, "standing still", Emotion.NEUTRAL, hold=hold)
    return Part(PartKind.HOLD, action, hold=hold), after(HOME)
