"""Features of a walk: what they say of a made-up walker is known, and neither place nor direction changes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend import rotations
from motion_backend.metrics.gait_features import SECONDS, UNITS, gait_features, windows
from motion_backend.skeleton import INDEX, JOINTS, build_skeleton

FPS = 30
FRAMES = round(SECONDS * FPS)
SIDES = (("left", 1.0, 0.0), ("right", -1.0, 0.5))
MIRRORED = [
    INDEX[{"left": "right", "right": "left"}[side] + "_" + rest] if (side := joint.split("_")[0]) in ("left", "right")
    and (rest := joint.split("_", 1)[1]) else INDEX[joint]
    for joint in JOINTS
]  # fmt: skip


@dataclass(frozen=True)
class Walker:
    """Sticks that walk along +Z: feet stand or slide forward evenly, everything else goes in sines."""

    speed: float = 1.2
    rate: float = 1.0
    duty: float = 0.6
    width: float = 0.10
    bob: float = 0.04
    sway: float = 0.05
    pitch: float = 0.1
    trunk_sway: float = 0.06
    arms: tuple[float, float] = (0.6, 0.3)
    knee: float = 1.1
    clearance: float = 0.05
    yaw: float = 0.15

    def positions(self, frames: int = FRAMES) -> np.ndarray:
        """(T, 22, 3)."""
        time = np.arange(frames) / FPS
        at = np.tile(build_skeleton().rest_positions, (frames, 1, 1))
        beat = 2 * np.pi * self.rate * time
        pelvis = np.stack(
            [self.sway / 2 * np.sin(beat), 0.95 + self.bob / 2 * np.sin(2 * beat), self.speed * time], axis=1
        )
        at += pelvis[:, None]
        lean = self.trunk_sway / 2 * np.sin(beat)
        trunk = np.stack([np.tan(lean), np.ones(frames), np.full(frames, np.tan(self.pitch))], axis=1)
        at[:, INDEX["neck"]] = pelvis + 0.5 * trunk
        for (side, out, late), swing in zip(SIDES, self.arms, strict=True):
            turned = out * self.yaw / 2 * np.sin(beat)
            hip = pelvis + 0.09 * out * np.stack([np.cos(turned), np.zeros(frames), -np.sin(turned)], axis=1)
            at[:, INDEX[f"{side}_hip"]] = hip
            arm = out * swing / 2 * np.sin(beat)
            hanging = np.stack([np.zeros(frames), -np.cos(arm), np.sin(arm)], axis=1)
            at[:, INDEX[f"{side}_wrist"]] = at[:, INDEX[f"{side}_shoulder"]] + 0.5 * hanging
            self._place_leg(at, side, out, late, time)
        return at

    def _place_leg(self, at: np.ndarray, side: str, out: float, late: float, time: np.ndarray) -> None:
        cycle = self.rate * time + late
        share = cycle % 1.0
        in_air = np.clip((share - self.duty) / (1 - self.duty), 0, 1)
        along = self.speed / self.rate * (np.floor(cycle) + in_air - late)
        height = self.clearance * (share > self.duty)
        ankle = np.stack([np.full(len(time), out * self.width / 2), 0.08 + height, along], axis=1)
        at[:, INDEX[f"{side}_ankle"]] = ankle
        at[:, INDEX[f"{side}_foot"]] = ankle + np.array([0.0, -0.05, 0.12])
        bend = self.knee / 2 * (1 - np.cos(2 * np.pi * cycle))
        knee = at[:, INDEX[f"{side}_hip"]] - [0.0, 0.4, 0.0]
        at[:, INDEX[f"{side}_knee"]] = knee
        # A shin that hangs on its own thigh: the ankle is set apart from it, since only its angle is asked for.
        shin = knee + 0.4 * np.stack([np.zeros(len(time)), -np.cos(bend), -np.sin(bend)], axis=1)
        at[:, INDEX[f"{side}_hip"]] += ankle - shin
        at[:, INDEX[f"{side}_knee"]] += ankle - shin


def told(positions: np.ndarray) -> dict[str, float]:
    found = gait_features(positions, FPS)
    assert found is not None
    return dict(zip(UNITS, found.tolist(), strict=True))


WALKERS = st.builds(
    Walker,
    speed=st.floats(0.6, 1.8),
    rate=st.sampled_from([0.9, 1.0, 1.1]),
    duty=st.floats(0.55, 0.65),
    width=st.floats(0.05, 0.2),
    bob=st.floats(0.01, 0.06),
    sway=st.floats(0.01, 0.1),
    arms=st.tuples(st.floats(0.1, 1.2), st.floats(0.1, 1.2)),
)


def test_a_made_up_walk_has_the_features_it_was_made_with() -> None:
    walker = Walker()
    found = told(walker.positions())
    assert found["speed"] == pytest.approx(walker.speed, rel=0.01)
    assert found["stride_rate"] == pytest.approx(walker.rate, rel=0.02)
    assert found["stride_length"] == pytest.approx(walker.speed / walker.rate, rel=0.02)
    assert found["step_width"] == pytest.approx(walker.width, abs=0.005)
    assert found["pelvis_bob"] == pytest.approx(walker.bob, abs=0.001)
    assert found["lateral_sway"] == pytest.approx(walker.sway, abs=0.002)
    assert found["trunk_pitch"] == pytest.approx(walker.pitch, abs=0.005)
    assert found["trunk_sway"] == pytest.approx(walker.trunk_sway, abs=0.005)
    assert found["arm_swing_left"] == pytest.approx(walker.arms[0], abs=0.02)
    assert found["arm_swing_right"] == pytest.approx(walker.arms[1], abs=0.02)
    assert found["knee_range"] == pytest.approx(walker.knee, abs=0.02)
    assert found["toe_clearance"] == pytest.approx(walker.clearance, abs=0.002)
    assert found["duty_factor"] == pytest.approx(walker.duty, abs=0.04)
    assert found["double_support"] == pytest.approx(2 * walker.duty - 1, abs=0.08)


def test_hips_that_turn_are_seen_to_turn() -> None:
    turning, still = Walker(yaw=0.3), Walker(yaw=0.0)
    positions, level = turning.positions(), still.positions()
    for at, yaw in ((positions, 0.3), (level, 0.0)):
        beat = 2 * np.pi * np.arange(FRAMES) / FPS
        for side, out in (("left", 1.0), ("right", -1.0)):
            turned = yaw / 2 * np.sin(beat)
            place = 0.09 * out * np.stack([np.cos(turned), np.zeros(FRAMES), -np.sin(turned)], axis=1)
            at[:, INDEX[f"{side}_hip"]] = at[:, 0] + place
    assert told(positions)["pelvis_yaw"] == pytest.approx(0.3, abs=0.01)
    assert told(level)["pelvis_yaw"] == pytest.approx(0.0, abs=1e-6)


@given(WALKERS, st.floats(-3, 3), st.floats(-9, 9), st.floats(-9, 9))
def test_where_it_goes_and_where_to_changes_nothing(walker: Walker, yaw: float, x: float, z: float) -> None:
    positions = walker.positions()
    turn = np.broadcast_to(rotations.yaw_to_quat(yaw), (*positions.shape[:2], 4))
    moved = rotations.rotate(turn, positions) + np.array([x, 0.0, z])
    there, here = gait_features(moved, FPS), gait_features(positions, FPS)
    assert there is not None
    assert here is not None
    np.testing.assert_allclose(there, here, atol=1e-6)


@given(WALKERS)
def test_a_mirror_changes_left_and_right_and_nothing_else(walker: Walker) -> None:
    positions = walker.positions()
    mirrored = positions[:, MIRRORED] * [-1.0, 1.0, 1.0]
    found, seen = told(positions), told(mirrored)
    found["arm_swing_left"], found["arm_swing_right"] = found["arm_swing_right"], found["arm_swing_left"]
    assert seen == pytest.approx(found, abs=1e-6)


def test_who_stands_has_no_gait_and_only_steady_walking_is_a_window() -> None:
    still = np.tile(build_skeleton().rest_positions, (FRAMES, 1, 1))
    assert gait_features(still, FPS) is None
    assert windows(still, FPS) == []
    steady = Walker().positions(4 * FPS)
    assert windows(steady, FPS) == [(0, 60), (30, 90), (60, 120)]
    stopping = np.concatenate([steady[:75], np.repeat(steady[75:76], 45, axis=0)])
    assert windows(stopping, FPS) == [(0, 60)]
    assert windows(steady[:59], FPS) == []


def test_a_way_that_bends_away_is_no_window() -> None:
    angle = np.linspace(0, 2.0, FRAMES)
    circle = Walker(speed=0.0).positions()
    circle[..., [0, 2]] += 1.2 * np.stack([1 - np.cos(angle), np.sin(angle)], axis=1)[:, None]
    assert windows(circle, FPS) == []
