"""Clips are read, put on our body, changed and collected as they were when somebody last looked at them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from recorded import agrees
from small_home import DIRECTOR, contact, small_home, to
from strange_clips import stranger

from motion_backend.formats import encode
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.mocap.augmentation import change_speed, mirror, mirror_words, reverse
from motion_backend.mocap.clip_captions import emotion_of, skill_of, subject_of, ways_to_say
from motion_backend.mocap.dataset_builder import collect
from motion_backend.mocap.dataset_file import Entry
from motion_backend.mocap.foot_hold import held
from motion_backend.mocap.near_duplicates import near_copies
from motion_backend.mocap.plain_walks import is_plain_walk
from motion_backend.mocap.readers import clip_of_motion, read_clips
from motion_backend.mocap.retarget import Retargeted, retarget
from motion_backend.motion import Character, Motion, Skill, join
from motion_backend.skeleton import build_skeleton

HOME: Final = small_home()
FILES: Final = {"bvh": "it.bvh", "amass": "it.npz", "npz": "own.npz", "glb": "it.glb"}
LABELS: Final = (
    ("loco", "zombie walk", "ZombieWalk_02"), ("loco", "", "a person does: hurried walk, turns left"),
    ("sitdown", "slow", "sit down on stool"), ("touch", "friendly", "wave hello, right hand"),
    ("liedown", "", "LieDown on the bed"), ("standup", "tired", "gets up from chair"), ("other", "", "cartwheel"),
    ("loco", "sad", "run and stop"), ("getup", "drunk", "get up off the floor"), ("loco", "formal", "backward steps"),
)  # fmt: skip


@cache
def acted() -> Motion:
    """A walk, and sitting down."""
    chair = contact(HOME, Skill.SITDOWN, "chair", "arms loosely, legs open")
    state = DIRECTOR.begin(HOME, Character(), 5)
    return join([motion for motion, _ in DIRECTOR.play(HOME, [to(chair, "walk with large steps"), chair], state)])


@cache
def walked() -> Motion:
    motion = acted()
    return motion.part(0, 100)


def test_clips_are_as_recorded(tmp_path: Path) -> None:
    strange = {
        f"{rest}, {fps:g} a second": stranger(acted(), rest, fps, 0.4) for rest, fps in (("n", 30.0), ("t", 60.0))
    }
    found = {name: put_on(retarget(clip, build_skeleton(1.6))) for name, clip in strange.items()}
    for name, file in FILES.items():
        (tmp_path / file).write_bytes(encode(walked(), name))
        (clip,) = read_clips(tmp_path / file)
        found[name] = {"notes": list(clip.notes), "fps": clip.fps, "frames": len(clip), **put_on(retarget(clip))}
    slides = replace(walked(), root_positions=walked().root_positions * np.array([1.2, 1.0, 1.2], dtype=np.float32))
    found["a stride too long"] = put_on(retarget(clip_of_motion(slides, "it")))
    agrees("clips", found)


def put_on(made: Retargeted) -> dict[str, Any]:
    """What was found out, and where the body is."""
    report = made.report.to_dict()
    return {"report": report, "hands": short(*made.hands.mean(axis=0)), **seen(made.motion)}


def seen(motion: Motion) -> dict[str, Any]:
    """Where joints are in a few frames, in metres."""
    body = Kinematics.of(motion)
    moments = np.linspace(len(motion) // 9, len(motion) - 1, 4).round().astype(int)
    return {
        "frames": len(motion),
        "planted": short(*motion.contacts.mean(axis=0)),
        "joints": [short(*body.positions[moment, ::3].ravel()) for moment in moments],
    }


def test_changed_motions_are_as_recorded() -> None:
    root, local, contacts = held(
        walked().root_positions.astype(float), walked().local_rotations.astype(float), walked().skeleton, 10
    )
    stood = replace(
        walked(), root_positions=root.astype(np.float32), local_rotations=local.astype(np.float32),
        contacts=contacts.astype(np.float32),
    )  # fmt: skip
    made = {"mirrored": mirror(acted()), "reversed": reverse(acted()), "held": stood}
    made |= {f"at {speed}": change_speed(acted(), speed) for speed in (0.8, 1.25)}
    agrees("changed_motions", {name: seen(motion) for name, motion in made.items()})


def test_collections_are_as_recorded() -> None:
    """Who is dealt where, what is made of each clip, and what is taken for a copy of what."""
    rng = np.random.default_rng(0)
    entries = []
    for number, (skill, style, text) in enumerate(LABELS):
        start = 9 * (number % 4)
        motion = replace(acted().part(start, start + 80), goals=(), phases=())
        entries.append(
            Entry(
                f"clip {number}", skill, style, emotion_of(style, text), ways_to_say(skill, style, text),
                f"person {number % 6}", "real mocap", "ours", "here", (), "train", motion, rng.random((80, 2)) > 0.7,
            )
        )  # fmt: skip
    made = collect(entries, mirrored=True, reversed_too=True, speeds=(0.8,))
    agrees("collections", {
        "entries": [line(entry) for entry in made.entries],
        "copies": [str(copy) for copy in near_copies(entries)],
        "texts": [f"{skill_of(text)} | {emotion_of('', text)} | {mirror_words(text)} | {subject_of(f'{text}.bvh')}"
                  for _, _, text in LABELS],
    })  # fmt: skip


def line(entry: Entry) -> str:
    told = (entry.name, entry.skill, entry.style, entry.emotion, entry.subject, entry.split, " ".join(entry.changed))
    numbers = (len(entry.motion), int(entry.hands[:, 0].sum()), int(entry.hands[:, 1].sum()), is_plain_walk(entry))
    return " | ".join([*told, *entry.captions, *map(str, numbers)])


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
