"""Retargeting: a clip of any known skeleton becomes a motion of ours, and the report says how true it is.

Rotations are carried over, lengths are ours: the pelvis path is scaled by the legs, then put on the floor; feet that
stand are held where they stand if that makes them slide less.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.joint_limits import limits_share
from motion_backend.mocap import foot_contacts, foot_lock
from motion_backend.mocap.clip import MAX_TURNS, Clip, ClipError
from motion_backend.mocap.fidelity_report import Fidelity, fastest_turn, faults, limb_differences
from motion_backend.mocap.foot_contacts import ANKLES, BALLS, Feet, above_floor, bend_legs, resting_hands
from motion_backend.mocap.joint_map import JointMap, checked_map, find_map
from motion_backend.mocap.resampling import (
    CUTOFF,
    FAST_ENOUGH,
    low_pass,
    sample_positions,
    sample_rotations,
    sample_times,
    smooth_rotations,
)
from motion_backend.mocap.rest_pose import (
    Source,
    carry_over,
    common_rest,
    placed,
    rolled_to_hinges,
    with_flat_feet,
    world_to_local,
)
from motion_backend.motion import FPS, Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton, build_skeleton

KEYED = frozenset({"glb", "kimodo"})
"""Formats whose clips nobody's camera shook: they are not smoothed."""
MAX_FRAMES = 60_000
"""At our rate: 33 minutes, for which some 700 MB are needed."""
MIN_LEG_LENGTH = 0.05
TOY = 0.47
"""Leg over leg and trunk under which a body has a toy's proportions: its path then says nothing of ours."""


@dataclass(frozen=True)
class Retargeted:
    """A clip on our body, and how true it is."""

    motion: Motion
    hands: NDArray[np.bool_]
    """(T, 2) whether the left and the right hand rest on something: still and away from where they hang."""
    report: Fidelity


@dataclass(frozen=True)
class _Pose:
    """Our body on its way: pelvis (T, 3) and world rotations (T, 22, 4)."""

    skeleton: Skeleton
    pelvis: Array
    world: Array

    @cached_property
    def positions(self) -> Array:
        return placed(self.skeleton, self.pelvis, self.world)

    @cached_property
    def feet(self) -> Feet:
        return Feet(self.positions[:, ANKLES], self.world[:, ANKLES], self.world[:, BALLS], self.skeleton, FPS)

    @cached_property
    def skin(self) -> Array:
        """Height of the lowest point of all but the feet. (T,)."""
        return foot_contacts.lowest_skin(self.skeleton, self.positions, self.world)

    def moved(self, by: Array) -> _Pose:
        return replace(self, pelvis=self.pelvis + by)

    def with_ankles(self, ankles: Array) -> _Pose:
        return replace(self, world=bend_legs(self.skeleton, self.positions, self.world, ankles))

    def with_bent_toes(self) -> _Pose:
        world = self.world.copy()
        world[:, BALLS] = self.feet.with_bent_toes().toe_turns
        return replace(self, world=world)


def retarget(clip: Clip, skeleton: Skeleton | None = None, joints: JointMap | None = None) -> Retargeted:
    """A clip on our skeleton at 30 frames a second. ClipError if its joints are not known (`joints`: a map)."""
    body = skeleton or build_skeleton()
    family, known = find_map(clip.bones.names) if joints is None else ("given", joints)
    known = checked_map(known, clip.bones.names)
    places = {ours: clip.bones.index(theirs) for ours, theirs in known.items()}
    notes = list(clip.notes)

    rest_positions, rest_turns = clip.tpose_kinematics()
    rest = common_rest(rest_positions, rest_turns, known, places, body)
    toy = _is_toy(rest_positions, places)
    ratio = _leg(body.rest_positions, INDEX) / _leg(rest_positions, places)
    raw, source = _timelines(clip, places, ratio, notes)

    world = carry_over(source, rest)
    rest = rolled_to_hinges(source, rest, world)  # rolls hips and shoulders; ankles and feet stay as carried over
    rest = with_flat_feet(source, rest, world, _leg(body.rest_positions, INDEX), FPS)
    pose = _Pose(body, _pelvis(source), carry_over(source, rest))
    carried = pose.world if raw is source else carry_over(raw, rest)
    theirs = Feet(raw.at("left_ankle", "right_ankle"), carried[:, ANKLES], carried[:, BALLS], body, FPS)
    pose, theirs = _travelled(pose, theirs, notes)
    pose, theirs = _grounded(pose, theirs, toy, notes)
    pose, theirs = pose.with_bent_toes(), theirs.with_bent_toes()
    pose, theirs = _standing_still(pose, theirs, notes)
    pose = _out_of_floor(pose, notes)

    local = rotations.continuous(world_to_local(pose.world))
    motion = Motion(
        root_positions=pose.pelvis.astype(np.float32),
        local_rotations=local.astype(np.float32),
        contacts=pose.feet.contacts().astype(np.float32),
        skeleton=body,
        actions=np.zeros(len(local), dtype=np.int32),
        fps=FPS,
    )
    limbs, fastest = limb_differences(raw, rest, pose.positions), fastest_turn(local, FPS)
    lowest = float(min(pose.skin.min(), pose.feet.soles[..., 1].min()))
    report = Fidelity(
        name=clip.name,
        source=clip.source,
        family=family,
        frames=len(motion),
        seconds=motion.duration,
        source_fps=clip.fps,
        ratio=ratio,
        skate=pose.feet.skate(),
        source_skate=None if toy else theirs.skate(),
        depth=pose.feet.depth(),
        source_depth=None if toy else theirs.depth(),
        lowest=lowest,
        limbs=limbs,
        fastest=fastest,
        beyond_limits=limits_share(local),
        refused=faults(pose.feet, theirs.skate(), lowest, limbs, fastest),
        conversions=tuple(notes),
    )
    return Retargeted(motion, resting_hands(pose.positions, FPS), report)


def _leg(positions: Array, places: Mapping[str, int]) -> float:
    """Thigh and shank, mean of both sides."""
    chains = [[places[f"{side}_{joint}"] for joint in ("hip", "knee", "ankle")] for side in ("left", "right")]
    found = np.mean([np.linalg.norm(np.diff(positions[chain], axis=0), axis=1).sum() for chain in chains])
    if found < MIN_LEG_LENGTH:
        raise ClipError(f"its legs are {found:.3g} m long, hip to ankle: are the units right?")
    return float(found)


def _is_toy(positions: Array, places: Mapping[str, int]) -> bool:
    """Whether legs are short for the trunk."""
    shoulders = positions[[places["left_shoulder"], places["right_shoulder"]], 1].mean()
    hips = positions[[places["left_hip"], places["right_hip"]], 1].mean()
    leg = _leg(positions, places)
    return bool(leg / (leg + shoulders - hips) < TOY)


def _timelines(clip: Clip, places: dict[str, int], ratio: float, notes: list[str]) -> tuple[Source, Source]:
    """The source at our size and rate, its pelvis starting above the origin: as it is, and smoothed."""
    if clip.duration * FPS > MAX_FRAMES or clip.duration * FPS * len(clip.bones.names) > MAX_TURNS:
        raise ClipError(
            f"it lasts {clip.duration / 60:.0f} minutes, too long for {len(clip.bones.names)} joints", "cut it"
        )
    times = sample_times(len(clip), clip.fps, FPS)
    if len(times) < 2:
        raise ClipError(f"it lasts {clip.duration:.3g} s, less than two frames at {FPS} a second")
    if clip.fps != FPS:
        notes.append(f"resampled from {clip.fps:g} to {FPS} frames a second")
    roots, turns = clip.root_positions, clip.local_rotations
    raw = _at_our_size(clip, sample_positions(roots, times), sample_rotations(turns, times), places, ratio)
    if clip.fps < FAST_ENOUGH or clip.source in KEYED:
        return raw, raw
    notes.append(f"smoothed at {CUTOFF:g} Hz")
    roots, turns = low_pass(roots, clip.fps), smooth_rotations(turns, clip.fps)
    return raw, _at_our_size(clip, sample_positions(roots, times), sample_rotations(turns, times), places, ratio)


def _at_our_size(clip: Clip, roots: Array, turns: Array, places: dict[str, int], ratio: float) -> Source:
    positions, world = clip.bones.forward_kinematics(roots, turns)
    start = positions[0, [places["left_hip"], places["right_hip"]]].mean(axis=0) * [1.0, 0.0, 1.0]
    return Source(ratio * (positions - start), world, places)


def _pelvis(source: Source) -> Array:
    """Ours is between the hips, wherever theirs is. (T, 3)."""
    return np.asarray(source.at("left_hip", "right_hip").mean(axis=1))


def _travelled(pose: _Pose, theirs: Feet, notes: list[str]) -> tuple[_Pose, Feet]:
    """A walk on the spot comes along."""
    path = foot_contacts.travel(pose.feet, pose.pelvis)
    if path is None:
        return pose, theirs
    notes.append("walks on the spot: its way was taken from the standing foot")
    return pose.moved(path), replace(theirs, ankles=theirs.ankles + path[:, None])


def _grounded(pose: _Pose, theirs: Feet, toy: bool, notes: list[str]) -> tuple[_Pose, Feet]:
    """Body and source with the floor at height 0; a toy's heights come from our body on the floor."""
    soles = pose.feet.ground
    lowest = np.minimum(pose.skin, soles)
    if toy:
        notes.append("of a toy's proportions: rotations only, heights from the floor under the body")
        floor = foot_contacts.always_down(lowest, FPS)
        pose = pose.moved(-_upwards(floor))
        return pose, replace(theirs, ankles=pose.feet.ankles)
    floor = foot_contacts.floor_under(lowest, FPS)
    climb = float(floor[-1] - floor[0])
    if climb:
        notes.append(f"its floor climbed by {100 * climb:+.0f} cm, taken out")
    # Other shanks and thighs put the source's soles at another height over the same pelvis.
    apart = np.percentile(theirs.ground, foot_contacts.SHARE) - np.percentile(soles, foot_contacts.SHARE)
    up = _upwards(floor)
    pose, theirs = pose.moved(-up), replace(theirs, ankles=theirs.ankles - up[:, None] - [0.0, apart, 0.0])
    unequal = pose.feet.unequal()
    return (
        pose.with_ankles(pose.feet.ankles + _upwards(unequal)) if unequal.any() else pose,
        replace(theirs, ankles=theirs.ankles + _upwards(theirs.unequal())),
    )


def _upwards(heights: Array) -> Array:
    return np.asarray(np.multiply.outer(heights, [0.0, 1.0, 0.0]))


def _standing_still(pose: _Pose, theirs: Feet, notes: list[str]) -> tuple[_Pose, Feet]:
    """Knees as hinges, standing feet on the floor and held where they stand; the source's put there only."""
    ankles, pelvis = foot_lock.locked(pose.feet, pose.pelvis)
    notes.append("standing feet put on the floor and held where they stand")
    return (
        pose.moved(pelvis).with_ankles(pose.feet.ankles + ankles),
        replace(theirs, ankles=theirs.ankles + ankles * [0.0, 1.0, 0.0]),
    )


def _out_of_floor(pose: _Pose, notes: list[str]) -> _Pose:
    """The whole body raised where its trunk, knees or hands are in the floor, then each foot."""
    lift = foot_contacts.out_of_floor(pose.skin, FPS)
    if lift.max() > 0.001:
        notes.append(f"raised out of the floor by up to {100 * lift.max():.1f} cm")
        pose = pose.moved(_upwards(lift))
    for _ in range(2):
        rise = above_floor(pose.feet)
        if rise.any():
            pose = pose.with_ankles(pose.feet.ankles + rise)
    return pose
