"""Networks, what they see and what they are taught by are what they were when somebody last looked at them.

A network that has learned nothing is as good as any: of the same seed it says the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any, Final

import numpy as np
import torch
from recorded import agrees
from sample_motions import tumbling
from small_home import contact, small_home
from torch import Tensor

from motion_backend.datasets.motion_text_dataset import SAMPLED
from motion_backend.diffusion.body_kinematics import Kinematics as Bones
from motion_backend.diffusion.completion_scheduler import SCHEDULER_PRESETS, CompletionScheduler, SchedulerSizes
from motion_backend.diffusion.conditions import Conditions
from motion_backend.diffusion.denoiser import PRESETS, Denoiser, DenoiserSizes
from motion_backend.diffusion.losses import CONTACT_LOSSES, WALK_LOSSES, losses
from motion_backend.diffusion.motion_features import WINDOW, HeadingFrame, Poses, to_features
from motion_backend.diffusion.noise_schedule import NoiseSchedule, ddim_step, pairs
from motion_backend.diffusion.sampler import Scale
from motion_backend.diffusion.scene_encoder import SceneSizes
from motion_backend.diffusion.train import TrainConfig as Diffusing
from motion_backend.embedding.text_motion_autoencoder import AutoencoderConfig, TextMotionAutoencoder, autoencoder_loss
from motion_backend.embedding.train import TrainConfig as Embedding
from motion_backend.motion import Emotion, Skill
from motion_backend.physics import rewards
from motion_backend.physics.cloned_policy import CloningConfig
from motion_backend.physics.discriminator import DiscriminatorConfig, DiscriminatorTrainer, Steps, style_reward
from motion_backend.physics.mpc import Effort
from motion_backend.physics.observations import (
    STATE_SIZE,
    goal,
    goal_places,
    heightmap,
    mirror_state,
    moments_of,
    state,
)
from motion_backend.physics.policies import PolicyConfig, PolicyName, Value, five_policies, log_probability
from motion_backend.physics.ppo import PPOConfig
from motion_backend.physics.train import DistilConfig, RewardConfig
from motion_backend.scene import scene_of

HOME: Final = small_home()
SIZES: Final[Mapping[str, Mapping[str, Any]]] = {
    "denoiser": PRESETS, "scheduler": SCHEDULER_PRESETS, "noise": {"usual": NoiseSchedule()},
    "losses": {"at furniture": CONTACT_LOSSES, "walks": WALK_LOSSES}, "training": {"usual": Diffusing(1000)},
    "embedding": {"sizes": AutoencoderConfig(), "training": Embedding()},
    "policies": {name: PolicyConfig.of(name, 50) for name in PolicyName},
    "physics": {
        "discriminator": DiscriminatorConfig(), "ppo": PPOConfig(), "cloning": CloningConfig(),
        "distilling": DistilConfig(), "rewards": RewardConfig(), "control": Effort(),
    },
}  # fmt: skip
"""Those that papers print, and ours where they print none."""


def test_sizes_are_as_recorded() -> None:
    found: dict[str, Any] = {
        kind: {name: plain(asdict(one)) for name, one in some.items()} for kind, some in SIZES.items()
    }
    rates = [plain(Diffusing(1000).rate_at(step)) for step in (0, 10, 149, 150, 500, 999)]
    agrees("sizes", found | {"rates": rates})


def test_networks_are_as_recorded() -> None:
    with torch.random.fork_rng():
        torch.manual_seed(3)
        with torch.no_grad():
            found = {**diffusion(), **embedding()}
        agrees("networks", found | policies())


def windows() -> Tensor:
    """Two windows of a body, one a little later. (2, 16, 202)."""
    motion = tumbling(60)
    rows = []
    for start in (0, 5):
        frames = slice(start, start + 3 * WINDOW, 3)
        poses = Poses(
            motion.root_positions[frames].astype(float), motion.local_rotations[frames].astype(float),
            motion.contacts[frames].astype(float),
        )  # fmt: skip
        rows.append(to_features(poses, HeadingFrame.of(poses, frame=1), motion.skeleton))
    return torch.from_numpy(np.stack(rows)).float()


def diffusion() -> dict[str, Any]:
    clean = windows()
    some = torch.linspace(-1, 1, 2 * 384).reshape(2, 384)
    told = Conditions(
        some, torch.tensor([1.0, 0.0]), torch.tensor([0, 40]), torch.tensor([1, 4]), torch.tensor([2, 0]),
        some[:, :9], torch.tensor([1.0, 0.0]), some[:, :4], torch.tensor([0.0, 1.0]),
        some.sin()[:, :1, None, None].expand(2, 64, 32, 32).contiguous(), torch.ones(2),
    )  # fmt: skip
    network = Denoiser(DenoiserSizes(1, 2, 16, 24, False, SceneSizes(1, 2, 16, 24))).eval()
    scheduler = CompletionScheduler(SchedulerSizes(1, 2, 16, 24)).eval()
    schedule, scale = NoiseSchedule(), Scale(clean.mean((0, 1)), clean.std((0, 1)) + 0.1)
    guess = network(clean, torch.tensor([3, 70]), network.encode(told))
    noise = torch.linspace(0, 1, clean.numel()).reshape(clean.shape).cos()
    steps = pairs(schedule.spaced(4))
    return {
        "features": rows(clean),
        "denoiser": rows(guess),
        "scheduler": short(*scheduler(clean, some, torch.tensor([0, 40]))),
        "losses": [
            plain(losses(scale.encode(clean) + 0.1 * noise, scale.encode(clean), scale, Bones(), weights).numbers())
            for weights in (CONTACT_LOSSES, WALK_LOSSES)
        ],
        "noised": rows(schedule.noised(clean, noise, torch.tensor([0, 99]))),
        "steps": steps,
        "ddpm": rows(
            torch.stack(
                [
                    ddim_step(schedule, clean[0], noise[0], step, step - 1 if step else None, noise[1])
                    for step in (0, 50, 99)
                ]
            )
        ),
        "ddim": rows(torch.stack([ddim_step(schedule, clean[0], noise[0], *step) for step in steps])),
    }


def embedding() -> dict[str, Any]:
    model = TextMotionAutoencoder(AutoencoderConfig(8, width=16, heads=2, hidden=24, encoder_layers=1)).eval()
    states = torch.linspace(-2, 2, 2 * SAMPLED * STATE_SIZE).reshape(2, SAMPLED, STATE_SIZE).sin()
    words = torch.linspace(-1, 1, 2 * 384).reshape(2, 384).cos()
    total, terms, z = autoencoder_loss(model, states, words)
    return {"embedding": rows(z[:, None]), "its loss": short(total, *terms)}


def policies() -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, policy in five_policies(5, 0).items():
        observed = torch.linspace(-1, 1, 2 * sum(policy.input_sizes)).reshape(2, -1).sin()
        mean = policy(observed).detach()
        likely = log_probability(mean, policy.log_std.detach(), 0.1 * torch.ones_like(mean))
        found[name] = [[round(float(one), 4) for one in mean.flatten()], short(*likely), list(policy.input_sizes)]
        found[f"{name}'s worth"] = short(*Value(observed.shape[1], (8,))(observed).detach())
    trainer = DiscriminatorTrainer(DiscriminatorConfig(hidden=(8,)))
    before = torch.linspace(-1, 1, 3 * trainer.config.state).reshape(3, -1)
    clips, policy_steps = (
        Steps(before, shift + before.cos(), torch.ones(3, trainer.config.text)) for shift in (0.0, 0.3)
    )
    taught = [plain(trainer.step(clips, policy_steps)) for _ in range(3)]
    return {**found, "taught": taught, "style": short(*style_reward(torch.linspace(-2, 2, 9)))}


def test_what_policies_see_and_are_paid_for_is_as_recorded() -> None:
    motion = tumbling(30, height=1.5)
    moment = moments_of(motion)
    sofa = contact(HOME, Skill.SITDOWN, "sofa", "sitting still", Emotion.NEUTRAL)
    shelf = contact(HOME, Skill.TOUCH, "shelf", "touch medium height with the left hand")
    over = replace(moment, positions=moment.positions + np.array([4.0, 0.0, 1.5]))
    seen = {
        "state": rows(torch.from_numpy(state(moment))[None, ::7]),
        "mirrored": rows(torch.from_numpy(mirror_state(state(moment)))[None, ::7]),
        "heights": rows(torch.from_numpy(heightmap(scene_of(HOME), "0/sofa", over).reshape(30, 1, -1)[::9])),
        "goals": [rows(torch.from_numpy(goal(*goal_places(one, motion.skeleton), moment))[None, ::9])
                  for one in (sofa, shelf, replace(sofa, skill=Skill.STANDUP))],
    }  # fmt: skip
    agrees("observations", {**seen, "rewards": paid()})


def paid() -> dict[str, Any]:
    """Every reward, of bodies far from and near to where they are to be."""
    rng = np.random.default_rng(0)
    bodies = 6
    root, target, velocity, direction, facing = rng.normal(0, 0.7, (5, bodies, 3))
    direction, facing = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (direction, facing))
    on_the_way = rewards.Approach(root, target, velocity, np.full(bodies, 1.2), direction, facing)
    joints, goals = rng.normal(0, 0.5, (2, bodies, 15, 3))
    mask = rng.random((bodies, 15)) > 0.6
    return {
        "walk": short(*rewards.walk_reward(on_the_way, 0.5 * velocity)),
        "contact": short(*rewards.contact_reward(on_the_way, joints, goals, mask)),
        "nearest": short(*np.ravel(rewards.nearest_points(goals[0], joints[:, :2]))),
        "getup": short(*rewards.getup_reward(mask[:, 0], joints[:, 0, 0] ** 2, joints[:, 1, 0] ** 2)),
        "total": short(*rewards.total_reward(joints[:, 0, 0], joints[:, 0, 1], 0.3)),
    }


def rows(values: Tensor) -> list[list[float]]:
    """Of each in a batch (B, T, F): numbers that hang on every one of its numbers, and on its place."""
    weights = torch.cos(0.7 * torch.arange(values.shape[-1])).to(values)
    told = values.detach() @ weights
    return [short(one.mean(), one[0], one[-1], values[i].detach().abs().mean()) for i, one in enumerate(told)]


def plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    return float(f"{value:.4g}") if isinstance(value, float) else value


def short(*numbers: Any) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
