"""Films of the paper's seven themes are decoded and looked at: there is somebody in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from body_in_film import PRESENT, body_shares, decoded
from encoded import encoded

from benchmarks.themes import THEMES
from motion_backend.rendering.film_backdrop import Backdrop
from planner_service.library.library import Shelves
from planner_service.output.film import Filmed, write_film
from planner_service.pipeline import Pipeline, StoryRequest

SEED = 23
"""Not that of the benchmarks, whose films are watched."""
SIZE = (640, 360)


def filmed_of(name: str) -> Filmed:
    return Filmed.of(Pipeline(Shelves(cache=encoded())).make(StoryRequest(THEMES[name], seed=SEED)))


@pytest.mark.sweep
@pytest.mark.parametrize("name", list(THEMES))
def test_the_body_is_in_95_of_100_pictures_of_a_film(name: str, tmp_path: Path) -> None:
    filmed = filmed_of(name)
    film = list(decoded(write_film(filmed, tmp_path / "film.mp4", SIZE)))
    assert len(film) == len(filmed.motion)
    shares = np.array(list(body_shares(film, filmed, every=10).values()))
    assert np.mean(shares > PRESENT) >= 0.95
    assert shares.max() < 0.9, "what is behind it is seen too"


@pytest.mark.sweep
def test_a_film_that_the_body_is_left_out_of_is_seen_to_be_empty(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    filmed = filmed_of("picnic")
    with monkeypatch.context() as without:
        without.setattr(Backdrop, "with_body", lambda self, _: self.planes.copy())
        film = list(decoded(write_film(filmed, tmp_path / "film.mp4", SIZE)))
    assert max(body_shares(film, filmed, every=10).values()) < PRESENT
