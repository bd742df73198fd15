"""When a passage that was made can stand: it ends at its goal, and the plan's is the measure of all else."""

from __future__ import annotations

from typing import Final

import numpy as np

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.planned_passages import PlannedPassage
from motion_backend.metrics.caption_predicates import judge_caption
from motion_backend.metrics.foot_skate import support_slip
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import CLEARLY_IN, penetration
from motion_backend.motion import FPS, Emotion, Motion, Skill
from motion_backend.procedural.walk.walk_styles import style_of
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX
from motion_backend.walk_driver import unlike_people
from motion_backend.walk_generator import Frames

WORSE: Final = 1.5
"""Times the plan's that a made body may be deep in furniture."""
LOST: Final = 0.15
"""Metres from its goal at which a pelvis is not brought there any more."""
HOVERS: Final = 0.04
"""Metres over the floor at which a body floats whose plan stands."""
SOME, FEW, DEEP = 4, 2, 0.035
"""Frames in which a body that floats is overlooked, and one that is in furniture less than so many metres deep."""
SLIDES: Final = 8.0
"""Centimetres a second that the best supported point of soles may slide over a passage: people's do 3 to 5."""
AT_ONCE, SKIDS = 20, 16.0
"""Frames, and centimetres a second that the same may slide over so many: a body that is carried along on its feet."""
HOPS, TIPTOE = 0.045, 15.0
"""Metres by which a body bounces that hops, and degrees from which on its heels are off the floor as it stands."""
JOLT: Final = 1.6
"""Metres a second by which a joint above the legs may change its speed from frame to frame: more is a jump."""
UPPER: Final = [index for name, index in INDEX.items() if not name.endswith(("hip", "knee", "ankle", "foot"))]
HELD: Final = {Skill.SITDOWN: PartKind.HOLD, Skill.LIEDOWN: PartKind.HOLD, Skill.LOCO: PartKind.WALK}
"""The part of a skill that shows its caption."""


class RefusedError(Exception):
    """What was made cannot stand; says why."""


def refuse_unseen(passage: PlannedPassage) -> None:
    """RefusedError for walks of which ten frames a second keep nothing: hops, flights, and who goes on his toes."""
    if not passage.is_periodic or passage.part.action.skill is not Skill.LOCO:
        return
    style = style_of(passage.part.action)
    if style.double < 0:
        raise RefusedError("who runs flies, between ten frames a second")
    if style.skips or style.bounce > HOPS:
        raise RefusedError("hops are lost between ten frames a second")
    if style.tiptoe > TIPTOE:
        raise RefusedError("nobody goes on his toes in what was learned")


def refuse_beyond(metres: float, most: float, passage: PlannedPassage) -> None:
    """RefusedError for what ended farther from its goal."""
    if metres > most:
        raise RefusedError(f"the {passage.phase} ended {metres:.2f} m from its goal")


def check(made: Motion, passage: PlannedPassage, past: Frames) -> int:
    """RefusedError for a body that jumps, goes through furniture, floats or slides, or that its caption is not of.

    The plan's is the measure: it may do that `WORSE` times as much. Past are the frames before it. What comes back are
    the frames in which it is in furniture beyond that and which are overlooked.
    """
    _check_jumps(made, passage, past)
    deeper = _check_furniture(made, passage)
    _check_feet(made, passage)
    action, part = passage.part.action, passage.part
    if HELD.get(action.skill) is not part.kind or (passage.is_periodic and _is_plain(passage)):
        return deeper
    own, planned = (judge_caption(motion, action) for motion in (made, passage.plan))
    if own is not None and planned is not None and len(own.missed) > len(planned.missed):
        raise RefusedError(f"it did not look like {action.caption!r:.40}")
    return deeper


def _is_plain(passage: PlannedPassage) -> bool:
    """Whether it is a walk like any other."""
    action = passage.part.action
    return not unlike_people(action) and action.emotion is Emotion.NEUTRAL


def _check_jumps(made: Motion, passage: PlannedPassage, past: Frames) -> None:
    jolt, most = _jolt(made, past), _jolt(passage.plan, past[:0])
    if jolt > max(JOLT, WORSE * most):
        raise RefusedError(f"it jumped by {jolt:.1f} m/s in the {passage.phase}")


def _jolt(motion: Motion, past: Frames) -> float:
    """The largest change of speed from frame to frame of what is above the legs, the seam counted in."""
    made = Frames(motion.root_positions.astype(np.float64), motion.local_rotations.astype(np.float64))
    whole = past[-2:].then(made)
    places = motion.skeleton.forward_kinematics(whole.root, whole.local)[0][:, UPPER].astype(np.float64)
    if len(places) < 3:
        return 0.0
    return float(np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max()) * FPS


def _check_furniture(made: Motion, passage: PlannedPassage) -> int:
    obstacles, action = scene_of(passage.home).obstacles, passage.part.action
    own, planned = (penetration(Kinematics.of(motion), obstacles, action) for motion in (made, passage.plan))
    frames, most = int((own > CLEARLY_IN).sum()), WORSE * float((planned > CLEARLY_IN).sum())
    if frames > most + FEW * (own.max() < DEEP):
        raise RefusedError(f"the {passage.phase} was up to {own.max():.2f} m deep in furniture")
    return max(frames - int(most), 0)


def _check_feet(made: Motion, passage: PlannedPassage) -> None:
    body, plan = Kinematics.of(made), Kinematics.of(passage.plan)
    lifted, most = (int((one.soles[..., 1].min(axis=(1, 2)) > HOVERS).sum()) for one in (body, plan))
    if lifted > WORSE * most + SOME:
        raise RefusedError(f"it floated in {lifted} frames of the {passage.phase}")
    slide = support_slip(body)
    if slide > SLIDES and slide > WORSE * support_slip(plan):
        raise RefusedError(f"feet slid at {slide:.0f} cm/s in the {passage.phase}")
    skid = _skid(made)
    if skid > SKIDS and skid > WORSE * _skid(passage.plan):
        raise RefusedError(f"feet slid at {skid:.0f} cm/s at once in the {passage.phase}")


def _skid(motion: Motion) -> float:
    """How fast the best supported point of soles slides over the worst `AT_ONCE` frames, cm/s."""
    last = max(len(motion) - AT_ONCE, 0)
    starts = sorted({*range(0, last, AT_ONCE // 2), last})
    return max(support_slip(Kinematics.of(motion.part(at, min(at + AT_ONCE, len(motion))))) for at in starts)
