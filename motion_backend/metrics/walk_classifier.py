"""How surely a small network tells made walks from those of people it has never seen: the judge of every body.

Kernel distances call a body level with people whose means are right and whose spread is not; a classifier (Lopez-Paz
and Oquab, ICLR 2017) does not. It has 40 principal components of one second and 32 hidden units, and its figure is the
area under the ROC curve: 0.5 where nothing is told apart, 1 where all is.

A made body is one more person whose takes are halved: the network learns from one half and from some of the people,
and is asked about the other half and about somebody it was not shown. Everybody has a turn at that. The figure is read
against that of people, got in the same way: some of them, their takes halved, against the others.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.metrics.walk_seconds import WHOLE, Seconds
from motion_backend.rotations import Array

COMPONENTS: Final = 40
"""Principal components of the windows that a network learns from."""
UNITS: Final = 32
"""Of the hidden layer."""
STEPS: Final = 200
RATE: Final = 1e-2
DECAY: Final = 0.1
"""Of the weights, against learning a few hundred windows by heart (Adam with decoupled decay)."""
MOMENTS: Final = (0.9, 0.999)
"""How slowly Adam forgets gradients and their squares."""
TEAMS: Final = 8
"""Random halves of the people who are told from the other half."""
MIN_WINDOWS: Final = 8
"""Of a body, under which nothing is said of it."""


@dataclass(frozen=True)
class Told:
    """How surely a body is told from people."""

    auc: float
    """The mean over the people that it is told from."""
    low: float
    high: float
    """95 % of that mean, people drawn anew."""
    by_person: dict[str, float]
    """What is told apart from each of them."""


@dataclass(frozen=True)
class Yardstick:
    """How surely people are told from each other in the same way."""

    teams: float
    """Half of the people from the other half: the mean of random halves."""
    low: float
    high: float
    """Where 95 % of the halves lie."""
    alone: dict[str, float]
    """Each person from all others."""


@dataclass(frozen=True)
class _Lesson:
    """What a network learns from: standardised components, what it is to say, and how much each window weighs."""

    inputs: Array
    """(N, 40)."""
    answers: Array
    """(N,) 0 for people, 1 for the body."""
    weights: Array
    """(N,) that sum to one, a half for either answer; everybody weighs the same."""


def told_apart(people: Seconds, body: Seconds, limb: str = WHOLE, seed: int = 0) -> Told:
    """How surely windows of a body are told from those of people of whom the network has seen nothing."""
    half = halves(body)
    seen, made = people.features(limb), body.features(limb)
    by_person = {}
    for person in np.unique(people.people).tolist():
        asked = people.people == person
        found = []
        for shown in (half, ~half):
            score = _learned(seen[~asked], people.people[~asked], made[shown], body.people[shown], seed)
            found.append(auc(score(seen[asked]), score(made[~shown])))
        by_person[person] = float(np.mean(found))
    values = np.array(list(by_person.values()))
    drawn = np.random.default_rng(seed).integers(len(values), size=(1000, len(values)))
    low, high = np.quantile(values[drawn].mean(axis=1), [0.025, 0.975])
    return Told(float(values.mean()), float(low), float(high), by_person)


def people_apart(people: Seconds, limb: str = WHOLE, seed: int = 0) -> Yardstick:
    """The same among people: half of them, and each alone, against the rest."""
    names, rng = np.unique(people.people), np.random.default_rng(seed)
    teams = []
    for _ in range(TEAMS):
        team = np.isin(people.people, rng.permutation(names)[: len(names) // 2])
        teams.append(told_apart(people[~team], people[team], limb, seed).auc)
    alone = {
        str(name): told_apart(people[~own], people[own], limb, seed).auc
        for name in names
        if (own := people.people == name).sum() >= MIN_WINDOWS
    }
    low, high = np.quantile(teams, [0.025, 0.975])
    return Yardstick(float(np.mean(teams)), float(low), float(high), alone)


def halves(body: Seconds) -> NDArray[np.bool_]:
    """One half of a body's windows, its takes kept whole; who has one take is halved in time. (N,)."""
    half = np.zeros(len(body), dtype=np.bool_)
    for index, person in enumerate(np.unique(body.people)):
        own = np.flatnonzero(body.people == person)
        takes = list(dict.fromkeys(body.takes[own].tolist()))
        if len(takes) > 1:
            half[own] = np.isin(body.takes[own], takes[index % 2 :: 2])
        else:
            half[own[: len(own) // 2]] = True
    return half


def auc(people: Array, body: Array) -> float:
    """How often a window of the body has a higher score than one of a person."""
    gaps = body[:, None] - people
    return float(np.mean(gaps > 0) + np.mean(gaps == 0) / 2)


def _learned(
    people: Array, names: NDArray[np.str_], body: Array, bodies: NDArray[np.str_], seed: int
) -> Callable[[Array], Array]:
    """A network that gives windows of the body higher scores than those of people. (N, F) to (N,)."""
    mean, shown = people.mean(axis=0), np.concatenate([people, body])
    axes = _principal_axes(shown - shown.mean(axis=0))
    scale = ((people - mean) @ axes).std(axis=0) + 1e-6
    inputs = [(windows - mean) @ axes / scale for windows in (people, body)]
    weights = np.concatenate([_even(names), _even(bodies)]) / 2
    answers = np.repeat([0.0, 1.0], [len(people), len(body)])
    network = _trained(_Lesson(np.concatenate(inputs), answers, weights), seed)
    return lambda windows: _hidden(network, (windows - mean) @ axes / scale) @ network[2]


def _principal_axes(about: Array) -> Array:
    """(F, K) directions in which windows (N, F) differ most, from their products with each other: N is the smaller."""
    values, vectors = np.linalg.eigh(about @ about.T)
    kept = np.flatnonzero(values > 1e-9 * values[-1])[-COMPONENTS:]
    return np.asarray(about.T @ (vectors[:, kept] / np.sqrt(values[kept])))


def _even(names: NDArray[np.str_]) -> Array:
    """Weights that sum to one, of which everybody has the same share."""
    _, index, count = np.unique(names, return_inverse=True, return_counts=True)
    return np.asarray(1.0 / (len(count) * count[index]))


def _trained(lesson: _Lesson, seed: int) -> list[Array]:
    """Weights and biases of the hidden layer, weights and bias of the answer, by Adam on all windows at once."""
    rng, width = np.random.default_rng(seed), lesson.inputs.shape[1]
    network = [
        rng.uniform(-1, 1, (width, UNITS)) / np.sqrt(width), np.zeros(UNITS),
        rng.uniform(-1, 1, UNITS) / np.sqrt(UNITS), np.zeros(1),
    ]  # fmt: skip
    means, squares = ([np.zeros_like(part) for part in network] for _ in range(2))
    for step in range(1, STEPS + 1):
        for part, slope, mean, square in zip(network, _slopes(network, lesson), means, squares, strict=True):
            mean += (1 - MOMENTS[0]) * (slope - mean)
            square += (1 - MOMENTS[1]) * (slope**2 - square)
            size = np.sqrt(square / (1 - MOMENTS[1] ** step)) + 1e-8
            part *= 1 - RATE * DECAY
            part -= RATE * mean / (1 - MOMENTS[0] ** step) / size
    return network


def _slopes(network: list[Array], lesson: _Lesson) -> tuple[Array, Array, Array, Array]:
    """Of the weighted cross entropy, by every part of the network."""
    hidden = _hidden(network, lesson.inputs)
    guess = 1 / (1 + np.exp(-(hidden @ network[2] + network[3])))
    fault = lesson.weights * (guess - lesson.answers)
    before = np.outer(fault, network[2]) * (1 - hidden**2)
    return lesson.inputs.T @ before, before.sum(axis=0), hidden.T @ fault, fault.sum(keepdims=True)


def _hidden(network: list[Array], inputs: Array) -> Array:
    return np.asarray(np.tanh(inputs @ network[0] + network[1]))
