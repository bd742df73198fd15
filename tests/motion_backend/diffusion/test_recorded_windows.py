"""What the model learns from and what it is told of a plan is what it was when somebody last looked at it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray
from recorded import agrees
from small_home import contact, rise, small_home, to

from motion_backend.backend_protocol import BodyState, Part, PartKind
from motion_backend.diffusion.conditions import Conditions, MadeOf
from motion_backend.diffusion.dataset import Passage, Stretch, followed, people, read_stretches, write_stretches
from motion_backend.diffusion.denoiser import Denoiser, DenoiserSizes
from motion_backend.diffusion.motion_features import FEATURES, HeadingFrame, Poses
from motion_backend.diffusion.planned_passages import PlannedPassage, passages_of
from motion_backend.diffusion.rollout import Rollout, conditions, to_motion
from motion_backend.diffusion.sampler import Sampler, Scale
from motion_backend.diffusion.windows import WindowBank
from motion_backend.director import Director
from motion_backend.language.minilm import WIDTH
from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Action, Character, Motion, Skill
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.skeleton import build_skeleton
from scene_graphs.home import Home

HOME: Final = small_home()
ROOM: Final = "bedroom-0003"
"""Of the library: what stands around is taken from there."""
SHARES: Final = {(MadeOf.PROCEDURAL, kind): 1.0 + 0.5 * number for number, kind in enumerate(PartKind)} | {
    (MadeOf.RECORDED, PartKind.WALK): 2.0
}


class Heard(ProceduralBackend):
    """The procedural body, and what it was asked for."""

    def __init__(self) -> None:
        self.heard: list[tuple[Part, Motion]] = []

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        motion, after = super().advance(home, part, upcoming, state)
        self.heard.append((part, motion))
        return motion, after


@cache
def day() -> tuple[list[Action], list[Motion], list[tuple[Part, Motion]]]:
    """A body walks, sits, rises, touches and lies."""
    chair = contact(HOME, Skill.SITDOWN, "chair", "hands on thighs")
    shelf = contact(HOME, Skill.TOUCH, "shelf", "touch medium height with the left hand")
    shelf = replace(shelf, hand="left")
    bed = contact(HOME, Skill.LIEDOWN, "bed", "right leg bent")
    actions = [to(chair), chair, rise(chair), to(shelf), shelf, to(bed), bed]
    heard = Heard()
    director = Director(heard)
    played = director.play(HOME, actions, director.begin(HOME, Character(), 3))
    return actions, [motion for motion, _ in played], heard.heard


def stretches() -> list[Stretch]:
    """The day; and its first walk as if three people of different paces had been recorded."""
    actions, motions, _ = day()
    whole = followed(actions, motions, "a day", ROOM)
    walk = followed(actions[:1], motions[:1], "a walk", None)
    passage = (Passage(0, len(walk), PartKind.WALK, "steadily walking forward"),)
    recorded = [
        replace(walk, name=name, person=name, made_of=MadeOf.RECORDED, passages=passage, roots=walk.roots * [s, 1, s])
        for name, s in (("anna", 1.0), ("bert", 0.8), ("carl", 1.2))
    ]
    return [whole, *recorded]


def encode(words: Sequence[str]) -> NDArray[np.float32]:
    return np.asarray(HashingEncoder().encode(words), dtype=np.float32)[:, :WIDTH]


def test_what_is_learned_from_is_as_recorded(tmp_path: Path) -> None:
    file = tmp_path / "acted.npz"
    write_stretches(stretches(), file)
    kept = read_stretches(file)
    bank = WindowBank(kept, encode, scenes=True)
    windows = bank.windows(SHARES, every=24)
    picked = slice(None, None, max(1, len(windows) // 6))
    starts, rows = windows.starts[picked], windows.passages[picked]
    batch = bank.batch(starts, rows, np.arange(len(starts)) % 2 == 1)
    told = {
        "passages": [f"{p.kind} {p.start}-{p.stop} {p.caption} {p.reached} {p.left}" for p in kept[0].passages],
        "hands": [short(*passage.hand) for passage in kept[0].passages if passage.hand is not None],
        "people": {name: round(seconds, 3) for name, seconds in people(kept).items()},
        "gaits": bank.gaits,
        "windows": [len(windows), *short(windows.weights.min(), windows.weights.max(), windows.weights.sum())],
        "drawn": [many.tolist() for many in windows.drawn(5, np.random.default_rng(0))],
        "features": [short(*summed(window)) for window in batch.windows.numpy()],
        "given": given(batch.given),
        "periodic": batch.periodic.tolist(),
        "over": batch.over.tolist(),
    }
    agrees("windows", told)


def test_what_is_told_of_a_plan_is_as_recorded() -> None:
    found: dict[str, Any] = {}
    for number, (part, plan) in enumerate(day()[2]):
        for passage in passages_of(HOME, part, plan, since=5 * (number % 2), count=max(len(plan) - 7, 1)):
            name = f"{number} {passage.phase}, {passage.caption}"
            found[name] = wished(passage)
    agrees("passages", found)


def wished(passage: PlannedPassage) -> dict[str, Any]:
    """What is told of the window in the middle of it."""
    done, plan = len(passage.plan) // 2, passage.plan
    place = slice(max(done - 2, 0), max(done, 2))
    before = Poses(
        plan.root_positions[place].astype(np.float64)[None], plan.local_rotations[place].astype(np.float64)[None],
        np.zeros((1, len(plan.root_positions[place]), 4)),
    )  # fmt: skip
    frame = HeadingFrame.of(before, plan.skeleton.scale, frame=-1)
    told = conditions(passage.wish(done, frame, seen=True), frame)
    return {
        "frames": [len(plan), passage.due, len(passage.told)],
        "way": short(*passage.way(done)[::5].ravel()),
        "pose": short(*summed(passage.pose(done, frame))),
        "settled": short(*passage.settled(done)[::3]),
        "held": short(*passage.held(done)[::3]),
        "facing": short(passage.facing(done)),
        "given": given(told),
    }


def test_bodies_go_on_as_recorded() -> None:
    torch.manual_seed(0)
    sampler = Sampler(
        Denoiser(DenoiserSizes(1, 2, 16, 16, True, None)), Scale(torch.zeros(FEATURES), torch.full((FEATURES,), 0.02))
    )
    part, plan = next((part, plan) for part, plan in day()[2] if part.kind is PartKind.SIT)
    passage = passages_of(HOME, part, plan)[-1]
    skeleton = build_skeleton(1.5)
    poses = Poses(
        plan.root_positions[:2].astype(np.float64)[None], plan.local_rotations[:2].astype(np.float64)[None],
        np.ones((1, 2, 4)),
    )  # fmt: skip
    made = Rollout(sampler, skeleton, poses)
    for window in range(2):
        made = made.go_on(passage.wish(14 * window, made.frame, seen=False), [window])
    whole = Poses(made.poses.roots[0], made.poses.local[0], made.poses.contacts[0])
    motions = [to_motion(whole, skeleton, 2, hold_feet) for hold_feet in (True, False)]
    agrees("rollouts", {
        "frames": [len(motion) for motion in motions],
        "roots": [short(*motion.root_positions[::9].ravel()) for motion in motions],
        "planted": [short(*motion.contacts.mean(axis=0)) for motion in motions],
    })  # fmt: skip


def given(told: Conditions) -> dict[str, Any]:
    """What is told, the long ones in sums."""
    rows: Mapping[str, Any] = {field.name: getattr(told, field.name) for field in fields(told)}
    found = {}
    for name, value in rows.items():
        if value is not None:
            numbers = value.double().numpy().reshape(len(value), -1)
            found[name] = [short(*(row if len(row) < 10 else summed(row[None]))) for row in numbers]
    return found


def summed(rows: NDArray[Any]) -> list[float]:
    """Features (T, F) in a few numbers that hang on every one of them and on its place."""
    weights = np.cos(np.arange(rows.shape[-1]) * 0.7)
    values = rows @ weights
    return [float(number) for number in (values.mean(), values[0], values[-1], rows.std())]


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
