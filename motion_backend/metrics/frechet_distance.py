"""FID and APD of SIMS 4.3 over features of motions: how like a reference a set of motions is, and how varied.

The features are those of our own encoder (`embedding/text_motion_embedding.py`): figures of other encoders are on other
scales and cannot be compared with them.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from motion_backend.rotations import Array

MIN_SAMPLES: Final = 640
"""Of each set: ten for each of 64 features, or the covariances say more of the sample than of what it is drawn from."""


def frechet_distance(made: Array, reference: Array, at_least: int = MIN_SAMPLES) -> float:
    """‖μ₁ − μ₂‖² + Tr(Σ₁ + Σ₂ − 2 (Σ₁Σ₂)^½) of features (N, F) and (M, F); 0 for the same Gaussian.

    ValueError for sets with fewer samples, or with features that are no numbers.
    """
    for name, rows in (("made", made), ("reference", reference)):
        if len(rows) < at_least or not np.isfinite(rows).all():
            raise ValueError(f"{name}: a Fréchet distance needs {at_least} finite samples, these are {len(rows)}")
    one, other = np.cov(made, rowvar=False), np.cov(reference, rowvar=False)
    away = made.mean(axis=0, dtype=np.float64) - reference.mean(axis=0, dtype=np.float64)
    # The root of Σ₁Σ₂ has the trace of that of Σ₁^½ Σ₂ Σ₁^½, which is symmetric: no complex numbers on the way.
    values, vectors = np.linalg.eigh(one)
    root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    shared = np.sqrt(np.maximum(np.linalg.eigvalsh(root @ other @ root), 0.0)).sum()
    return float(away @ away + np.trace(one) + np.trace(other) - 2 * shared)


def average_pairwise_distance(features: Array) -> float:
    """APD: the mean distance of two of N samples (N, F). ValueError for fewer than two."""
    if len(features) < 2:
        raise ValueError(f"features: two samples have a distance, these are {len(features)}")
    first, second = np.triu_indices(len(features), 1)
    return float(np.linalg.norm(features[first] - features[second], axis=1).mean())
