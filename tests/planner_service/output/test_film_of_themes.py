"""Films of the paper's seven themes, and of others, are decoded and looked at: there is somebody in them."""

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
OTHERS = {
    "letter": "A young mother comes home from work, puts down her bag on the table, reads a letter and begins to cry.",
    "water": "An old man wakes up at night, looks out of the window, drinks water in the kitchen and goes back to bed.",
    "homework": "A girl does her homework at the desk, gets angry, throws the book away and lies down on the bed.",
    "plants": "He waters the plants, calls his friend, sits down in the armchair and watches television happily.",
}
"""A child, an old man, one who comes home: whose films with this seed nobody watched."""


def filmed_of(name: str) -> Filmed:
    theme = (THEMES | OTHERS)[name]
    return Filmed.of(Pipeline(Shelves(cache=encoded())).make(StoryRequest(theme, seed=SEED)))


@pytest.mark.sweep
@pytest.mark.parametrize("name", [*THEMES, *OTHERS])
def test_the_body_is_in_95_of_100_pictures_of_a_film(name: str, tmp_path: Path) -> None:
    filmed = filmed_of(name)
    film = list(decoded(write_film(filmed, tmp_path / "film.mp4", SIZE)))
    assert len(film) == len(filmed.edit)
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
