"""The simulated body, what it is to follow and what it feels are what they were when somebody last looked at them."""

from __future__ import annotations

from typing import Any

import numpy as np
from policy_episodes import PART, planned
from recorded import agrees
from simulated import HOME, tracked, walk
from small_home import contact

from motion_backend.backend_protocol import Part, PartKind
from motion_backend.motion import Skill
from motion_backend.physics.contact_forces import Pressure
from motion_backend.physics.generalized_coordinates import fold, unfold
from motion_backend.physics.mjcf_scene import models_of, near_way
from motion_backend.physics.policy_view import View
from motion_backend.physics.reference import Reference
from motion_backend.physics.task import plan_of
from motion_backend.scene import scene_of
from motion_backend.skeleton import build_skeleton

ARRAYS = (
    "body_mass", "body_inertia", "body_pos", "body_quat", "body_ipos", "geom_size", "geom_pos", "geom_friction",
    "geom_solref", "geom_contype", "geom_conaffinity", "geom_type", "jnt_range", "jnt_stiffness", "jnt_pos", "jnt_axis",
    "dof_damping", "dof_armature", "actuator_gainprm", "actuator_biasprm", "actuator_forcerange", "actuator_ctrlrange",
)  # fmt: skip


def test_the_simulated_body_is_as_recorded() -> None:
    joints = walk().joint_positions().astype(np.float64)[::10] - np.array([1.5, 0.0, 0.0])
    near = near_way(joints, scene_of(HOME).obstacles)
    found: dict[str, Any] = {"near": list(near.owners)}
    for height in (1.2, 1.85):
        models = models_of(height, near)
        found[f"{height} m"] = {name: column_sums(getattr(models.fine, name)) for name in ARRAYS}
        found[f"{height} m"]["steps"] = [models.fine.opt.timestep * 1e3, models.coarse.opt.timestep * 1e3]
    agrees("simulated_bodies", found)


def column_sums(values: Any) -> list[float]:
    """Of an array (N, …): its columns weighed by their rows, so that no two rows can be exchanged."""
    rows = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
    weights = 1.0 + np.cos(0.7 * np.arange(len(rows)))
    return short(*(weights @ rows)[:10])


def test_what_is_followed_is_as_recorded() -> None:
    task, motion = planned(12)
    sofa = contact(HOME, Skill.SITDOWN, "sofa", "sitting still")
    plan = plan_of(walk().part(0, 60))
    reference = Reference.of(plan, build_skeleton(1.5))
    roots, local = unfold(reference.qpos, reference.wrists)
    done = tracked(plan, 5)
    parts = {"walk": PART, "sit": Part(PartKind.SIT, sofa)}
    views = {name: View.of(task, part, motion, np.ones(4)) for name, part in parts.items()}
    own, frames = task.reference, np.arange(3)
    pressures: list[Pressure] = done.pressures
    agrees("followed", {
        "qpos": [short(*row) for row in reference.qpos[::20]],
        "qvel": [short(*row) for row in reference.qvel[::20]],
        "controls": [short(*row) for row in reference.controls[::20]],
        "planted": short(*reference.planted.mean(axis=0)),
        "unfolded": [short(*roots.mean(axis=0), *local.mean(axis=(0, 1))), short(*fold(roots, local).mean(axis=0))],
        "seen": {
            name: [short(row @ np.cos(0.7 * np.arange(len(row))), row.std()) for row in
                   view.observe(own.qpos[frames], own.qvel[frames], own.controls[frames], frames)]
            for name, view in views.items()
        },
        "simulated": [short(*moment.state.qpos) for moment in done.moments[::5]],
        "felt": [short(*map(float, pressure.planted), float(pressure.root[0])) for pressure in pressures],
    })  # fmt: skip


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
