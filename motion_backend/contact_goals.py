"""Where joints are to be in a contact, from the planning side (SIMS 3.3): positions of 15 bodies and their mask."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.capsules import BODIES
from motion_backend.motion import Action, ContactGoal, Skill
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST, LYING_REST, SEATED_REST

_REST: Final = {Skill.SITDOWN: SEATED_REST, Skill.LIEDOWN: LYING_REST, Skill.TOUCH: HAND_REST}
_BODY_OF: Final = {"pelvis": "pelvis", "head": "head", "left_wrist": "left_hand", "right_wrist": "right_hand"}
"""The contact body whose place a joint's goal gives."""


def contact_goals(action: Action) -> tuple[ContactGoal, ...]:
    """Where joints should be: surface point + normal × that joint's rest offset; none where nothing is touched."""
    if action.spot is None or action.skill not in _REST:
        return ()
    joint = f"{action.hand}_wrist" if action.skill is Skill.TOUCH else "pelvis"
    x, y, z = np.asarray(action.spot.point) + _REST[action.skill] * np.asarray(action.spot.normal)
    return (ContactGoal(joint, (float(x), float(y), float(z))),)


def positions_and_mask(goals: Sequence[ContactGoal]) -> tuple[Array, NDArray[np.bool_]]:
    """The unified contact observation of SIMS 3.3: places of the 15 bodies (15, 3) and which of them count (15,)."""
    names = [capsule.name for capsule in BODIES]
    positions, mask = np.zeros((len(names), 3)), np.zeros(len(names), dtype=bool)
    for goal in goals:
        row = names.index(_BODY_OF[goal.joint])
        positions[row], mask[row] = goal.position, True
    return positions, mask
