"""Receding-horizon control without training: an iterative linear-quadratic regulator that tracks a plan in MuJoCo.

Every few frames the next ones are simulated with the last controls, linearised about what was simulated (about the
plan contacts would be a millimetre in or out, and the model would have no floor), improved by a Riccati recursion with
a line search (Li and Todorov 2004; Tassa et al. 2012), and the first of them are played. The last control is part of
the state, so that a price on its change is exact within the horizon and across its seam. Controls run linearly through
a frame. Nothing acts on the body but its joints, gravity and contacts.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np

from motion_backend.motion import FPS
from motion_backend.physics.contact_forces import ContactReader, Pressure, root_force
from motion_backend.physics.engine import engine
from motion_backend.physics.linear_model import NX, Frame, State, linearise
from motion_backend.physics.mjcf_character import NU, NV, SIDES, SIMULATED
from motion_backend.physics.mjcf_scene import Models
from motion_backend.physics.reference import Doing, Reference
from motion_backend.rotations import Array


@dataclass(frozen=True)
class Effort:
    """How far ahead is looked, how many frames of that are played, and how often it is improved."""

    horizon: int = 20
    played: int = 4
    rounds: int = 1


PLACE, TURN = 300.0, 120.0
"""Prices of the pelvis away from the plan, per m² and rad²."""
JOINTS: Final = {"trunk": 30, "hip": 20, "knee": 20, "ankle": 20, "shoulder": 10, "elbow": 10, "neck": 10, "toe": 5}
"""Prices of joints away from the plan, per rad²."""
VELOCITY, SPIN, JOINT_SPEED = 6.0, 1.5, 0.1
"""Prices of the pelvis' velocity and spin and of joint speeds away from the plan's."""
AT_THE_END: Final = 5.0
"""How much more the horizon's last frame counts."""
OFFSET: Final = 4.0
"""Price of a control away from the plan's, per rad²."""
CHANGE: Final = 60.0
"""Price of the change of that from frame to frame, per rad²: feet slide a third as fast with it."""
CHANGE_ON_FLOOR: Final = 480.0
"""The same where the body goes down to lie, lies, or gets up from the floor: more than its feet touches something."""
ON_FLOOR: Final = (Doing.GOES_DOWN, Doing.LIES, Doing.RISES)
SLIDING: Final = 10.0
"""Price of the velocity of sole points that the plan has planted, per (m/s)². Prices on their places make falls."""
MOST_OFFSET: Final = 0.5
"""No control is farther from the plan's (radians)."""
FADES: Final = 0.9
"""What is left of the last offset in every frame that has entered the horizon."""
SHARES: Final = (1.0, 0.6, 0.3, 0.1)
"""Of an improvement, tried from the boldest on."""
CLOSELY: Final = 6
"""So many frames of a horizon are linearised one by one, later ones by pairs: they are done again before they come."""
REGULAR: Final = 1e-3
"""Added to the price of controls, so that there always is a best one."""


def _prices() -> Array:
    price = np.zeros(NX)
    price[:3], price[3:6] = PLACE, TURN
    for joint in SIMULATED:
        price[joint.qvel : joint.qvel + (1 if joint.axis else 3)] = JOINTS[joint.name.rpartition("_")[2]]
    price[NV : NV + 3], price[NV + 3 : NV + 6], price[NV + 6 :] = VELOCITY, SPIN, JOINT_SPEED
    return price


def _legs_first(prices: Array, times: float, *sides: str) -> Array:
    """Prices in which the joints of some legs count more."""
    found = prices.copy()
    for joint in SIMULATED:
        if joint.name in {f"{side}_{one}" for side in sides for one in ("hip", "knee", "ankle")}:
            found[joint.qvel : joint.qvel + (1 if joint.axis else 3)] *= times
    return found


def _by_leg(prices: Array, times: float) -> tuple[Array, ...]:
    """Prices where the left or the right leg swings."""
    return tuple(_legs_first(prices, times, side) for side, _ in SIDES)


PRICES: Final = _prices()
PRICES_PELVIS: Final[Array] = PRICES * np.repeat([10.0, 1.0, 5.0, 1.0], [6, NV - 6, 6, NV - 6])
"""The same where the pelvis comes first. Where the body gets up from the floor, joints that are as planned are worth
nothing if the pelvis stays down, since hands and knees that are not where they should be carry nothing. Where it lies
down, the whole body would come to lie to one side of its place; where it stands up from its knees quickly, it fell."""
PRICES_GOING_DOWN: Final[Array] = PRICES * np.repeat([3.0, 1.0, 3.0, 1.0], [6, NV - 6, 6, NV - 6])
"""The same on its way down to lie: with ten times as much it shakes."""
PRICES_WALKING: Final[Array] = PRICES * np.where(np.arange(NX) == 1, 10.0, 1.0)
"""The same where it walks: the height of the pelvis counts ten times as much, since it sank by a centimetre and feet
hung as much lower."""
SWINGING: Final[dict[Doing, tuple[Array, ...]]] = {
    Doing.WALKS: _by_leg(PRICES_WALKING, 10.0),
    Doing.GOES_DOWN: _by_leg(PRICES_GOING_DOWN, 5.0),
    Doing.STANDS_UP: _by_leg(PRICES_PELVIS, 5.0),
}
"""And so do the joints of the leg that swings, left or right, while the other stands; on one's knees half as much."""
CALMED: Final = 40.0
"""So much more do joint speeds count where the body rolls: limbs in the air swing at 2 to 6 Hz as what carries it
changes."""
PRICES_LYING: Final[Array] = _legs_first(PRICES_PELVIS, 4.0, "left", "right") * np.repeat([1.0, CALMED], [NV + 6, NU])
"""Where it lies down, or gets up from the floor, legs count more too: feet that the plan lifts were drawn over the
floor."""


class Moment(NamedTuple):
    """All that the simulation goes on from."""

    state: State
    warm: Array
    """The solver's last accelerations (36,), from which it starts."""
    control: Array
    """The last control (30,)."""

    @property
    def finite(self) -> bool:
        """Whether all of it is numbers."""
        return all(bool(np.isfinite(one).all()) for one in (*self.state, self.warm))


class Roll(NamedTuple):
    """A horizon as it was simulated."""

    cost: float
    states: list[State]
    """One more than there are frames."""
    offsets: Array
    """Controls less the plan's. (H, 30)."""
    answers: Sequence[Array] = ()
    """How they answer to states and last offsets that are others, (30, 102) each; none where nothing was improved."""


class Gains(NamedTuple):
    """The improvement of every frame: what is added, and how it answers to states and last offsets that are others."""

    add: list[Array]
    answer: list[Array]
    """(30, 102) each."""


@dataclass(frozen=True)
class Controller:
    """One window's body in its surroundings, and the plan it follows."""

    models: Models
    data: Any
    """A mujoco.MjData, scratch space."""
    reference: Reference
    contacts: ContactReader

    def improve(self, now: Moment, at: int, ahead: Array, effort: Effort) -> Roll:
        """The controls of the frames from `at` on, begun with the offsets (K, 30) that the last plan left."""
        frames = min(effort.horizon, len(self.reference) - 1 - at)
        last = now.control - self.reference.controls[at]
        tries = [self.roll(now, at, _fading(ahead, frames)), self.roll(now, at, np.zeros((frames, NU)))]
        best = min(tries, key=_cost)
        if not np.isfinite(best.cost):
            return tries[1]
        for _ in range(effort.rounds):
            gains = self._gains(best, at, last)
            found = self._searched(now, at, best, gains)
            better = found.cost < best.cost
            best = (found if better else best)._replace(answers=gains.answer)
            if not better:
                break
        return best

    def _searched(self, now: Moment, at: int, about: Roll, gains: Gains) -> Roll:
        best = about
        for share in SHARES:
            found = self.roll(now, at, about.offsets, gains, about, share)
            if found.cost >= best.cost and best is not about:
                break
            best = min(best, found, key=_cost)
        return best

    def roll(
        self,
        now: Moment,
        at: int,
        offsets: Array,
        gains: Gains | None = None,
        about: Roll | None = None,
        share: float = 0,
    ) -> Roll:
        """Simulate some frames with offsets (H, 30), changed by a share of what the gains say about another roll."""
        data, plan = self.data, self.reference
        self._set(now)
        states, cost, last = [now.state], 0.0, now.control - plan.controls[at]
        played = np.zeros_like(offsets)
        before = about_before = last
        for index in range(len(offsets)):
            offset = offsets[index]
            if gains is not None and about is not None:
                off = np.concatenate([self.difference(data, about.states[index]), before - about_before])
                offset = offset + share * gains.add[index] + gains.answer[index] @ off
                about_before = offsets[index]
            offset = np.clip(offset, -MOST_OFFSET, MOST_OFFSET)
            self._frame(plan.controls[at + index] + before, plan.controls[at + index + 1] + offset)
            states.append(State(data.qpos.copy(), data.qvel.copy()))
            off = self.difference(data, self._planned(at + index + 1))
            weight = AT_THE_END if index + 1 == len(offsets) else 1.0
            cost += weight * float(self._prices(at + index + 1) @ (off * off)) + OFFSET * float(offset @ offset)
            cost += self._change(at + index + 1) * float((offset - before) @ (offset - before))
            cost += self._sliding(at + index + 1)
            played[index] = before = offset
            if not np.isfinite(cost):
                return Roll(np.inf, states, played)
        return Roll(cost, states, played)

    def play(self, now: Moment, at: int, offsets: Array) -> tuple[list[Moment], list[Pressure]]:
        """Simulate frames with offsets (N, 30) for good: what is left after each, and what pressed in it."""
        plan, data = self.reference, self.data
        self._set(now)
        moments, pressures, before = [], [], now.control
        for index, offset in enumerate(offsets):
            after = plan.controls[at + index + 1] + offset
            pressures.append(self._frame(before, after, Pressure()))
            state = State(data.qpos.copy(), data.qvel.copy())
            moments.append(Moment(state, data.qacc_warmstart.copy(), after))
            before = after
        return moments, pressures

    def _set(self, now: Moment) -> None:
        self.data.qpos[:], self.data.qvel[:], self.data.qacc_warmstart[:] = now.state.qpos, now.state.qvel, now.warm

    def _frame(self, before: Array, after: Array, pressure: Pressure | None = None) -> Pressure:
        """A thirtieth of a second, the controls running from one to the other."""
        model, data, step = self.models.fine, self.data, engine().mj_step
        steps = round(1 / (FPS * model.opt.timestep))
        for index in range(steps):
            data.ctrl[:] = before + (after - before) * ((index + 1) / steps)
            step(model, data)
            if pressure is not None:
                self.contacts.read(model, data, pressure, 1 / steps)
                pressure.root[0] = max(pressure.root[0], root_force(data))
        return pressure or Pressure()

    def _prices(self, at: int) -> Array:
        does = Doing(self.reference.doing[at])
        stands = self.reference.planted[at].reshape(2, 2).any(axis=1)
        if does in SWINGING and stands.sum() == 1:
            return SWINGING[does][int(stands.argmin())]
        match does:
            case Doing.GOES_DOWN:
                return PRICES_GOING_DOWN
            case Doing.LIES | Doing.RISES:
                return PRICES_LYING
            case Doing.STANDS_UP:
                return PRICES_PELVIS
            case Doing.WALKS:
                return PRICES_WALKING
        return PRICES

    def _change(self, at: int) -> float:
        return CHANGE_ON_FLOOR if self.reference.doing[at] in ON_FLOOR else CHANGE

    def _planned(self, at: int) -> State:
        return State(self.reference.qpos[at], self.reference.qvel[at])

    def difference(self, now: State | Any, planned: State) -> Array:
        """How far a state is from another, in the tangent space. (72,)."""
        off = np.empty(NX)
        engine().mj_differentiatePos(self.models.fine, off[:NV], 1.0, planned.qpos, now.qpos)
        off[NV:] = now.qvel - planned.qvel
        return off

    def _sliding(self, at: int) -> float:
        """The price of planted points that move, of the body as its data have it."""
        planted = self.reference.planted[at].reshape(2, 2)
        if not planted.any():
            return 0.0
        mujoco, model, data, cost, velocity = engine(), self.models.fine, self.data, 0.0, np.empty(6)
        for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):
            stage(model, data)
        for side, (foot, _) in enumerate(self.contacts.feet):
            if planted[side].any():
                mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, foot, velocity, 0)
                arms = self.contacts.sole @ data.xmat[foot].reshape(3, 3).T
                x, y, z = velocity[:3]
                # What turns a row r into ω × r.
                turning = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
                moves = velocity[3:] + arms[np.repeat(planted[side], 2)] @ turning
                cost += SLIDING * float((moves * moves).sum())
        return cost

    def _planted_rows(self, at: int) -> Array | None:
        """Jacobian rows (3 N, 36) of the velocities of planted sole points; None where there are none."""
        mujoco, model, data = engine(), self.models.fine, self.data
        planted = self.reference.planted[at].reshape(2, 2)
        if not planted.any():
            return None
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        rows = []
        for side, (foot, _) in enumerate(self.contacts.feet):
            points = self.contacts.sole_points(data, side).reshape(2, 2, 3)
            for point in points[planted[side]].reshape(-1, 3):
                row = np.empty((3, NV))
                mujoco.mj_jac(model, data, row, None, point, foot)
                rows.append(row)
        return np.concatenate(rows)

    def _stage(self, state: State, at: int, weight: float) -> tuple[Array, Array]:
        """Half the cost of a state near a simulated one: its Hessian (72, 72) and gradient (72,)."""
        prices = weight * self._prices(at)
        hessian, gradient = np.diag(prices), prices * self.difference(state, self._planned(at))
        self.data.qpos[:] = state.qpos
        if (rows := self._planted_rows(at)) is not None:
            hessian[NV:, NV:] += SLIDING * rows.T @ rows
            gradient[NV:] += SLIDING * rows.T @ (rows @ state.qvel)
        return hessian, gradient

    def _gains(self, about: Roll, at: int, last: Array) -> Gains:
        """The Riccati recursion over a horizon's linear models; the state z is (δx, δ last offset)."""
        plan, frames = self.reference, len(about.offsets)
        before = np.concatenate([last[None], about.offsets[:-1]])
        every = [i for i in range(frames) if i < CLOSELY or (i - CLOSELY) % 2 == 0]
        found = linearise(
            self.models.coarse,
            [
                Frame(about.states[i], plan.controls[at + i] + before[i], plan.controls[at + i + 1] + about.offsets[i])
                for i in every
            ],
        )
        models = [found[bisect_right(every, i) - 1] for i in range(frames)]
        add, answer = [np.zeros(0)] * frames, [np.zeros(0)] * frames
        value, slope = np.zeros((NX + NU, NX + NU)), np.zeros(NX + NU)
        value[:NX, :NX], slope[:NX] = self._stage(about.states[frames], at + frames, AT_THE_END)
        identity = np.eye(NU)
        for i in range(frames - 1, -1, -1):
            # Nothing but the control itself comes to be the last control: `onward` has rows for δx alone.
            onward, driven = np.concatenate([models[i].a, models[i].c], axis=1), np.concatenate([models[i].b, identity])
            pushed, change, price = value @ driven, about.offsets[i] - before[i], self._change(at + i + 1)
            own = driven.T @ pushed + (OFFSET + price + REGULAR) * identity
            mixed = pushed[:NX].T @ onward
            mixed[:, NX:] -= price * identity
            steep = OFFSET * about.offsets[i] + price * change + driven.T @ slope
            solved = np.linalg.solve(own, np.column_stack([mixed, steep]))
            answer[i], add[i] = -solved[:, :-1], -solved[:, -1]
            hessian, gradient = self._stage(about.states[i], at + i, 1.0)
            slope = onward.T @ slope[:NX] + mixed.T @ add[i]
            slope[:NX] += gradient
            slope[NX:] -= price * change
            value = onward.T @ (value[:NX, :NX] @ onward) + mixed.T @ answer[i]
            value[:NX, :NX] += hessian
            value[NX:, NX:] += price * identity
            value = (value + value.T) / 2
        return Gains(add, answer)


def _cost(roll: Roll) -> float:
    return roll.cost


def _fading(ahead: Array, frames: int) -> Array:
    """Offsets of a last plan (K, 30) as long as a horizon: what has entered it fades from the last one. (H, 30)."""
    if not len(ahead):
        return np.zeros((frames, NU))
    kept = ahead[:frames]
    fresh = kept[-1] * FADES ** np.arange(1, frames - len(kept) + 1)[:, None]
    return np.concatenate([kept, fresh])


def moment_of(reference: Reference, at: int) -> Moment:
    """A body that is exactly where the plan has it."""
    state = State(reference.qpos[at].copy(), reference.qvel[at].copy())
    return Moment(state, np.zeros(NV), reference.controls[at].copy())


def stacked(moments: Sequence[Moment]) -> tuple[Array, Array]:
    """Positions (T, 45) and velocities (T, 36)."""
    return np.stack([m.state.qpos for m in moments]), np.stack([m.state.qvel for m in moments])
