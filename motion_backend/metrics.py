"""Every figure on motion that we print, defined once (definitions: SIMS 4.3, UniHSI, GMD, PhysDiff; docs/metrics.md).

A trial is one keyframe: the frames a backend made for one action. Thresholds are the paper's: sit and reach 20 cm,
lie 30 cm; a walk hands over within 30 cm.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend import capsules, rotations
from motion_backend.motion import Action, Motion, Skill
from motion_backend.obstacles import Obstacles
from motion_backend.skeleton import INDEX

Array = NDArray[np.float64]
THRESHOLDS = {Skill.SITDOWN: 0.20, Skill.TOUCH: 0.20, Skill.LIEDOWN: 0.30}
HAND_OVER = 0.30
SUSTAINED = 1.0
RISEN = (0.85, np.cos(np.radians(30)), 0.5)
"""Share of the standing height, cosine of the trunk's tilt and seconds that count as having risen."""
CUSHION = 0.05
"""How deep a body may sink into what it sits or lies on."""
CLEARLY_IN = 0.02
_SITTING = (
    "pelvis",
    "torso",
    "left_thigh",
    "right_thigh",
    "left_hand",
    "right_hand",
    "left_lower_arm",
    "right_lower_arm",
)


@dataclass(frozen=True)
class KeyframeFigures:
    """How well one keyframe went."""

    keyframe: int
    skill: str
    reached: bool
    """Within the threshold without a break for one second (a walk: at its end; rising: for half a second)."""
    reached_any: bool
    """Within the threshold in any frame (SIMS' own rule)."""
    contact_error: float | None
    """Metres from joint to goal: the smallest in the last second of the contact."""
    seconds: float
    skate_ratio: float
    """GMD: share of frames with a toe near the floor and faster than 0.5 m/s."""
    skate: float
    """Mean speed of soles on the floor, cm/s."""
    pen_mean: float
    """Mean over frames of the deepest point inside furniture, metres."""
    pen_max: float
    pen_share: float
    """Share of frames with a point deeper than 2 cm."""
    floor_pen: float
    """Mean depth of the lowest sole corner below the floor, metres."""
    jerk: float
    """Mean over joints and frames, m/s³."""
    reason: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Plain values, rounded for reading."""
        return {key: round(value, 5) if isinstance(value, float) else value for key, value in asdict(self).items()}


@dataclass(frozen=True)
class Kinematics:
    """World positions (T, 22, 3) and rotations (T, 22, 4) of a motion, computed once."""

    positions: Array
    world: Array

    @staticmethod
    def of(motion: Motion) -> Kinematics:
        """Forward kinematics of a motion."""
        positions, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
        return Kinematics(positions.astype(np.float64), world)


def judge(motion: Motion, action: Action, obstacles: Obstacles) -> KeyframeFigures:
    """All figures of one keyframe."""
    body = Kinematics.of(motion)
    reached, reached_any, error = success(motion, action, body)
    depth = penetration(motion, body, obstacles, action)
    return KeyframeFigures(
        keyframe=action.keyframe,
        skill=action.skill.value,
        reached=reached and motion.completed,
        reached_any=reached_any and motion.completed,
        contact_error=error,
        seconds=motion.duration,
        skate_ratio=skate_ratio(motion, body),
        skate=skate_speed(motion, body),
        pen_mean=float(depth.mean()),
        pen_max=float(depth.max()),
        pen_share=float((depth > CLEARLY_IN).mean()),
        floor_pen=float(np.maximum(-sole_heights(motion, body).min(axis=(1, 2)), 0).mean()),
        jerk=jerk(body.positions, motion.fps),
        reason=motion.reason,
    )


def success(motion: Motion, action: Action, body: Kinematics) -> tuple[bool, bool, float | None]:
    """Sustained success, any-frame success, contact error (None where nothing is touched)."""
    if action.skill in THRESHOLDS:
        if not motion.goals:
            return False, False, None
        distance = contact_distance(motion, body)
        within = distance <= THRESHOLDS[action.skill]
        start, stop = longest_run(within)
        end = stop if stop > start else len(distance)
        last = distance[max(end - round(SUSTAINED * motion.fps), 0) : end]
        return stop - start >= SUSTAINED * motion.fps, bool(within.any()), float(last.min())
    if action.skill is Skill.LOCO:
        if action.goal is None:
            return motion.completed, motion.completed, None
        gap = np.hypot(*(body.positions[:, 0, [0, 2]] - np.asarray(action.goal)).T)
        return bool(gap[-1] <= HAND_OVER), bool((gap <= HAND_OVER).any()), None
    up = risen(motion, body)
    start, stop = longest_run(up)
    return bool(up[-1] and stop - start >= RISEN[2] * motion.fps), bool(up.any()), None


def contact_distance(motion: Motion, body: Kinematics) -> Array:
    """Largest distance over the goals of a motion between joint and goal. (T,)."""
    gaps = [
        np.linalg.norm(body.positions[:, INDEX[goal.joint]] - np.asarray(goal.position), axis=1)
        for goal in motion.goals
    ]
    return np.asarray(np.max(gaps, axis=0))


def longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Start and stop (exclusive) of the longest unbroken run of true; the later of equals; (0, 0) if none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return 0, 0
    lengths = runs[:, 1] - runs[:, 0]
    best = len(runs) - 1 - int(np.argmax(lengths[::-1]))
    return int(runs[best, 0]), int(runs[best, 1])


def risen(motion: Motion, body: Kinematics) -> NDArray[np.bool_]:
    """Frames in which the body stands: pelvis high and trunk upright. (T,)."""
    high = body.positions[:, 0, 1] >= RISEN[0] * motion.skeleton.standing_height
    trunk = rotations.normalize(body.positions[:, INDEX["neck"]] - body.positions[:, 0])
    return np.asarray(high & (trunk[:, 1] >= RISEN[1]))


def skate_ratio(motion: Motion, body: Kinematics) -> float:
    """GMD's foot skating ratio, heights from the toe joints' rest height, its 0.25 s window at our frame rate."""
    toes = body.positions[:, [INDEX["left_foot"], INDEX["right_foot"]]]
    if len(toes) < 3:
        return 0.0
    rest = motion.skeleton.ankle_height + motion.skeleton.offsets[INDEX["left_foot"], 1]
    low = toes[..., 1] - rest < 0.05
    speed = np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1) * motion.fps
    window = max(round(0.25 * motion.fps) // 2 * 2 - 1, 1)
    from scipy.ndimage import uniform_filter1d

    mean = uniform_filter1d(speed, window, axis=0, mode="nearest")
    skating = low[:-1] & low[1:] & (speed > 0.5) & (mean > 0.5)
    return float(skating.any(axis=1).mean())


def sole_heights(motion: Motion, body: Kinematics) -> Array:
    """Height of heel, toe and both edges of each sole above the floor. (T, 2, 4)."""
    return np.asarray(_soles(motion, body)[..., 1])


def _soles(motion: Motion, body: Kinematics) -> Array:
    feet = [INDEX["left_ankle"], INDEX["right_ankle"]]
    corners = capsules.SOLE * motion.skeleton.scale
    toe = [INDEX["left_foot"], INDEX["right_foot"]]
    found = body.positions[:, feet, None] + rotations.rotate(body.world[:, feet, None], corners)
    # The tip of the toes turns with the toe joint, not with the ankle.
    ball = motion.skeleton.offsets[INDEX["left_foot"]]
    found[:, :, 1] = body.positions[:, toe] + rotations.rotate(body.world[:, toe], corners[1] - ball)
    return np.asarray(found)


def skate_speed(motion: Motion, body: Kinematics) -> float:
    """Mean horizontal speed of sole corners lower than 1 cm in two neighbouring frames, cm/s."""
    soles = _soles(motion, body)
    low = soles[..., 1] < 0.01
    on = low[1:] & low[:-1]
    speed = np.linalg.norm(np.diff(soles[..., [0, 2]], axis=0), axis=-1) * motion.fps * 100
    return float(speed[on].mean()) if on.any() else 0.0


def penetration(motion: Motion, body: Kinematics, obstacles: Obstacles, action: Action | None) -> Array:
    """Depth of the deepest skin point of each frame inside solid furniture, cushion allowed for. (T,)."""
    start, end, radii = capsules.placed(motion.skeleton, body.positions, body.world)
    deepest = np.zeros(len(motion))
    close = obstacles.solid().near(
        np.minimum(start, end).min(axis=(0, 1)) - 0.15, np.maximum(start, end).max(axis=(0, 1)) + 0.15
    )
    flat_start, flat_end = start.reshape(-1, 3), end.reshape(-1, 3)
    radius = np.tile(radii, len(motion))
    middle, half = (flat_start + flat_end) / 2, np.linalg.norm(flat_end - flat_start, axis=1) / 2
    for index, owner in enumerate(close.owners):
        touching = np.flatnonzero(close.inside(middle, index) > -(half + radius))
        if not len(touching):
            continue
        points = capsules.skin_points(flat_start[touching], flat_end[touching], radius[touching])
        depth = close.inside(points.reshape(-1, 3), index).reshape(len(touching), -1).max(axis=1)
        bodies = touching % len(capsules.BODIES)
        depth = depth - np.array([_cushion(action, owner, capsules.BODIES[b].name) for b in bodies])
        np.maximum.at(deepest, touching // len(capsules.BODIES), depth)
    return deepest


def _cushion(action: Action | None, owner: str, body: str) -> float:
    """Contact bodies may sink into their own target and nowhere else."""
    if action is None or action.object_id != owner or action.skill in (Skill.LOCO, Skill.TOUCH):
        return 0.0
    lying = action.skill in (Skill.LIEDOWN, Skill.GETUP)
    return CUSHION if lying or body in _SITTING else 0.0


def jerk(positions: Array, fps: int) -> float:
    """Mean size of the third difference of joint positions, m/s³."""
    if len(positions) < 4:
        return 0.0
    return float(np.linalg.norm(np.diff(positions, n=3, axis=0), axis=-1).mean() * fps**3)


def seam_jump(motion: Motion) -> float:
    """Largest step of any joint from one segment to the next, beyond the median step around it (metres)."""
    positions = motion.joint_positions().astype(np.float64)
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=-1).max(axis=1)
    seams = np.flatnonzero(np.diff(motion.actions)) if len(motion) > 1 else np.array([], dtype=int)
    jumps = [steps[s] - np.median(steps[max(s - 5, 0) : s + 6]) for s in seams]
    return float(max(jumps, default=0.0))


def summarise(figures: list[KeyframeFigures]) -> dict[str, Any]:
    """The whole story: what was reached and how well, weighted by time where a figure is per frame."""
    seconds = np.array([f.seconds for f in figures])
    loco = np.array([f.skill == Skill.LOCO.value for f in figures])
    errors = [f.contact_error for f in figures if f.contact_error is not None]

    def mean(name: str, chosen: NDArray[np.bool_] | None = None) -> float:
        values = np.array([getattr(f, name) for f in figures])
        weights = seconds if chosen is None else seconds * chosen
        return round(float((values * weights).sum() / max(weights.sum(), 1e-9)), 5)

    by_skill = {
        skill.value: {
            "keyframes": sum(f.skill == skill.value for f in figures),
            "reached": sum(f.reached for f in figures if f.skill == skill.value),
        }
        for skill in Skill
        if any(f.skill == skill.value for f in figures)
    }
    return {
        "keyframes": len(figures),
        "reached": sum(f.reached for f in figures),
        "success": round(sum(f.reached for f in figures) / max(len(figures), 1), 4),
        "success_any_frame": round(sum(f.reached_any for f in figures) / max(len(figures), 1), 4),
        "by_skill": by_skill,
        "contact_error": round(float(np.mean(errors)), 5) if errors else None,
        "skate_ratio_loco": mean("skate_ratio", loco),
        "skate": mean("skate"),
        "pen_mean": mean("pen_mean"),
        "pen_share": mean("pen_share"),
        "pen_max": round(max((f.pen_max for f in figures), default=0.0), 5),
        "floor_pen": mean("floor_pen"),
        "jerk": mean("jerk"),
        "seconds": round(float(seconds.sum()), 3),
    }
