"""The chain of greatest entropy on a graph of states whose motion types are equally frequent (LINGO B.1.3).

The Lagrangian dual of that problem is the logarithm of the spectral radius of the weighted adjacency, a convex function
of the types' weights whose gradient is how often each type occurs.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.sparse import coo_matrix, csc_matrix, identity
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from motion_backend.rotations import Array

Indices = NDArray[np.int64]
MAX_LOG_WEIGHT: Final = 7.0
"""Largest logarithm of a weight: types that constraints keep rare are not asked for at any price."""
CLOSE: Final = 1e-9
"""Relative gap between the bounds of an eigenvalue at which it is known."""
STEPS: Final = 60


@dataclass(frozen=True)
class Edges:
    """Moves of a graph as columns, (E,) each."""

    source: Indices
    candidate: Indices
    target: Indices
    kind: Indices
    """Of each move's candidate, an index into `kinds`."""
    usual: Array
    """What each weighs when nothing needs balance."""
    kinds: tuple[str, ...]
    states: int

    @staticmethod
    def of(moves: Sequence[tuple[int, int, int, float]], states: int, kinds: Sequence[str]) -> Edges:
        """From (source, candidate, target, usual weight) and the type of every candidate."""
        columns = np.array([move[:3] for move in moves], dtype=np.int64).T
        source, candidate, target = columns
        names = tuple(dict.fromkeys(kinds))
        number = np.array([names.index(kind) for kind in kinds], dtype=np.int64)
        usual = np.array([move[3] for move in moves])
        return Edges(source, candidate, target, number[candidate], usual, names, states)

    def matrix(self, weights: Array) -> csc_matrix:
        """Weights of moves (E,) as a matrix from source to target. (states, states)."""
        shape = (self.states, self.states)
        return coo_matrix((weights, (self.source, self.target)), shape=shape).tocsc()

    def within(self, states: Indices) -> tuple[Edges, NDArray[np.bool_]]:
        """The moves between these states alone, renumbered in their order, and which moves those are."""
        kept = np.isin(self.source, states) & np.isin(self.target, states)
        number = np.full(self.states, -1, dtype=np.int64)
        number[states] = np.arange(len(states))
        columns = (self.candidate[kept], number[self.target[kept]], self.kind[kept], self.usual[kept])
        return Edges(number[self.source[kept]], *columns, self.kinds, len(states)), kept


def recurrent(edges: Edges) -> list[Indices]:
    """The sets of states that are never left again once entered, each connected."""
    _, label = connected_components(edges.matrix(np.ones(len(edges.source))), connection="strong")
    left = set(label[edges.source][label[edges.source] != label[edges.target]].tolist())
    return [np.flatnonzero(label == one) for one in sorted(set(label.tolist()) - left)]


def balanced(edges: Edges, free: Collection[str]) -> tuple[Array, Array]:
    """The probability of every move given its source, and how often it is made in the long run. Both (E,).

    All types but the `free` ones are made equally frequent, as nearly as the graph allows. Moves of states that the
    chain leaves for good keep their usual weights.
    """
    tied = np.array([name not in free for name in edges.kinds], dtype=bool)
    weights, flow = edges.usual.copy(), np.zeros(len(edges.source))
    for states in recurrent(edges):
        inner, kept = edges.within(states)
        chain = _Chain(inner)
        chosen = _weights(chain, tied)
        chain.radius(chosen)
        weights[kept], flow[kept] = chain.weighted(chosen) * chain.right[inner.target], chain.flow(chosen)
    return weights / np.bincount(edges.source, weights, edges.states)[edges.source], flow


def _weights(chain: _Chain, tied: NDArray[np.bool_]) -> Array:
    """Logarithms of the types' weights with which tied types are equally frequent; 0 for the others. (K,)."""
    count = int(tied.sum())

    def spread(free: Array) -> Array:
        weights = np.zeros(len(tied))
        weights[tied] = free - free.mean()
        return weights

    def dual(free: Array) -> tuple[float, Array]:
        value, share = chain.radius(spread(free))
        return value, share[tied] - share[tied].mean()

    if count < 2:
        return np.zeros(len(tied))
    bounds = [(-MAX_LOG_WEIGHT, MAX_LOG_WEIGHT)] * count
    found = minimize(
        dual, np.zeros(count), jac=True, method="L-BFGS-B", bounds=bounds, options={"gtol": 2e-5, "maxiter": 150}
    )
    return spread(np.asarray(found.x))


class _Chain:
    """A connected graph, with eigenvectors kept from one weighting to the next."""

    def __init__(self, edges: Edges) -> None:
        self.edges = edges
        self.right = np.ones(edges.states)
        self.left = np.ones(edges.states)

    def weighted(self, weights: Array) -> Array:
        """What every move weighs with these logarithms of the types' weights. (E,)."""
        return np.asarray(self.edges.usual * np.exp(weights[self.edges.kind]))

    def radius(self, weights: Array) -> tuple[float, Array]:
        """Logarithm of the spectral radius, and how often each type occurs: its gradient. (K,)."""
        matrix = self.edges.matrix(self.weighted(weights))
        self.right, size = _eigenvector(matrix, self.right)
        self.left, _ = _eigenvector(matrix.T.tocsc(), self.left)
        share = np.bincount(self.edges.kind, self.flow(weights), len(self.edges.kinds)).astype(np.float64)
        return float(np.log(size)), share

    def flow(self, weights: Array) -> Array:
        """How often every move is made, with the eigenvectors of these weights. (E,)."""
        flow = self.left[self.edges.source] * self.weighted(weights) * self.right[self.edges.target]
        return np.asarray(flow / flow.sum())


def _eigenvector(matrix: csc_matrix, guess: Array) -> tuple[Array, float]:
    """The positive eigenvector of a connected matrix of nonnegative entries, and its eigenvalue (Noda's iteration).

    The ratios of image and vector bound the eigenvalue from both sides; inverse iteration at the upper bound converges
    quadratically, and periodic graphs do not disturb it.
    """
    vector, high, low = guess / guess.sum(), 1.0, 1.0
    unit = identity(matrix.shape[0], format="csc")
    for _ in range(STEPS):
        ratio = np.asarray(matrix @ vector) / vector
        high, low = float(ratio.max()), float(ratio.min())
        if high - low <= CLOSE * high:
            break
        solved = np.abs(splu(high * (1 + 1e-12) * unit - matrix).solve(vector))
        vector = np.maximum(solved / solved.sum(), np.finfo(np.float64).tiny)
    return vector, (high + low) / 2
