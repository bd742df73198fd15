"""What furniture is built of."""

from __future__ import annotations

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture import catalogue, typical_size
from scene_graphs.layout import Point3
from scene_graphs.meshes.furniture_mesh import SOFT_ROLES, Part, parts

extents = st.floats(0.02, 3.0)
sizes = st.tuples(extents, extents, extents)


def by_role(category: str, size: Point3) -> dict[str, list[Part]]:
    found: dict[str, list[Part]] = {}
    for part in parts(category, size):
        found.setdefault(part.role, []).append(part)
    return found


@tries(60)
@given(st.sampled_from(sorted(catalogue().categories)), sizes)
def test_every_part_lies_within_its_piece(category: str, size: Point3) -> None:
    w, h, d = size
    built = parts(category, size)
    assert built
    for part in built:
        assert all(low >= bound - 1e-9 for low, bound in zip(part.low, (-w / 2, 0, -d / 2), strict=True))
        assert all(high <= bound + 1e-9 for high, bound in zip(part.high, (w / 2, h, d / 2), strict=True))


@for_each("category", sorted(catalogue().categories))
def test_solid_parts_of_a_piece_of_usual_size_reach_its_full_box(category: str) -> None:
    size = typical_size(category)
    built = parts(category, size)
    for axis in range(3):
        reach = max(part.high[axis] for part in built) - min(part.low[axis] for part in built)
        assert reach == pytest.approx(size[axis], abs=0.15 if category == "tv" else 0.06)


def test_a_word_without_a_form_is_one_solid_panel() -> None:
    (only,) = parts("aquarium", (1.0, 0.5, 0.4))
    assert (only.role, only.size) == ("panel", (1.0, 0.5, 0.4))


def test_a_seat_is_free_of_its_own_back_and_arms() -> None:
    for category in ("dining_chair", "office_chair", "armchair", "multi_seat_sofa", "l_shaped_sofa"):
        built = parts(category, typical_size(category))
        for seat in (part for part in built if part.role == "seat"):
            for other in (part for part in built if part.role in ("back", "arm") and part.top > seat.top):
                apart = [
                    min(seat.high[axis], other.high[axis]) - max(seat.low[axis], other.low[axis]) for axis in (0, 2)
                ]
                assert min(apart) <= 1e-9, (category, other)


def test_tables_are_hollow_so_that_knees_fit_below() -> None:
    for category in ("dining_table", "desk", "coffee_table", "dressing_table"):
        built = parts(category, typical_size(category))
        volume = sum(part.size[0] * part.size[1] * part.size[2] for part in built)
        w, h, d = typical_size(category)
        assert volume < 0.6 * w * h * d, category


def test_a_bed_is_lower_than_its_headboard_and_its_pillows_are_soft() -> None:
    roles = by_role("double_bed", (1.7, 0.9, 2.1))
    assert roles["mattress"][0].top < roles["headboard"][0].top
    assert all(pillow.is_soft for pillow in roles["pillow"])
    assert len(roles["pillow"]) == 2
    assert "pillow" in SOFT_ROLES


def test_a_size_that_is_not_positive_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="size of a desk must be three positive lengths"):
        parts("desk", (1.0, 0.0, 0.5))
