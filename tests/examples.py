"""With how many examples a property is tried: a few day by day, many before a release (SIMS_TEST_EXAMPLES=many)."""

from __future__ import annotations

import os
from typing import Any

from hypothesis import settings

SCALES = {"few": 0.2, "many": 5.0}
SCALE = SCALES[os.environ.get("SIMS_TEST_EXAMPLES") or "few"]
MIN_COUNT = 4
"""No property is tried with fewer, unless it asks for fewer."""


def tries(count: int, least: int = MIN_COUNT, **more: Any) -> settings:
    """Settings for a property that is worth so many examples. How long one takes says more about the machine."""
    return settings(max_examples=max(min(count, least), round(count * SCALE)), deadline=None, **more)
