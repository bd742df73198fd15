"""What the names in scene files mean."""

from __future__ import annotations

from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture import canonical, catalogue, is_known
from scene_graphs.loaders.furniture_names import exact_category, furniture_named, likely_room, meaning, rooms_served


@given(
    st.sampled_from(sorted(catalogue().categories)), st.sampled_from(["_01", ".003", " (2)", "_Mesh", "_L", "-LOD0"])
)
def test_a_category_is_understood_however_an_exporter_writes_it(category: str, ending: str) -> None:
    title = "".join(word.capitalize() for word in category.split("_"))
    for name in (category, title, category.replace("_", " "), category.replace("_", "").upper()):
        assert furniture_named(name + ending) == category


@given(st.sampled_from(sorted(alias for alias in catalogue().aliases if "/" not in alias)))
def test_an_alias_means_what_it_stands_for(alias: str) -> None:
    assert meaning(alias) == canonical(alias)


@given(st.text(max_size=300))
def test_any_text_is_a_name(name: str) -> None:
    assert meaning(name) == meaning(name)
    assert furniture_named(name) is None or is_known(meaning(name))


@for_each(
    ("name", "word"),
    [
        ("SM_Chair_01", "chair"),
        ("DiningTable.003", "dining_table"),
        ("coffeetable", "coffee_table"),
        ("Arm Chair (2)", "armchair"),
        ("L_Shaped_Sofa", "l_shaped_sofa"),
        ("Sofa_Mesh_LOD0", "sofa"),
        ("Dog_Bed_3", "pet_bed"),
        ("SoapBar", "soap"),
        ("Drapes_L", "curtain"),
        ("WallClock", "clock"),
        ("wastepaper basket", "trash_can"),
        ("LaundryBin.002", "hamper"),
        ("vegetable", "vegetable"),
        ("bedroom_wall", "bedroom_wall"),
    ],
)
def test_names_mean_what_a_person_reads_in_them(name: str, word: str) -> None:
    assert meaning(name) == word


def test_a_room_serves_what_its_seats_stand_at() -> None:
    assert rooms_served("kitchen", ["dining_table", "dining_chair", "dining_chair"]) == ("kitchen", "dining_room")
    assert rooms_served("living_room", ["dining_table", "armchair", "armchair"]) == ("living_room",)
    assert rooms_served("bedroom", ["dining_table", "dining_chair", "dining_chair", "desk"]) == ("bedroom", "study")
    assert rooms_served("study", ["desk", "office_chair"]) == ("study",)


def test_a_room_is_what_its_file_or_its_furniture_says() -> None:
    assert likely_room("My_LivingRoom_2", ["double_bed"]) == "living_room"
    assert likely_room("scene", ["desk", "double_bed"]) == "bedroom"
    assert likely_room("scene", ["desk", "multi_seat_sofa"]) == "living_room"
    assert likely_room("scene", ["dining_table", "refrigerator"]) == "kitchen"
    assert likely_room("scene", ["dining_table", "single_bed", "toilet"]) == "bedroom"
    assert likely_room("scene", ["rug"]) == "room"


@for_each(
    ("word", "size", "category"),
    [
        ("bed", (1.0, 0.9, 2.0), "single_bed"),
        ("bed", (2.1, 0.9, 1.8), "double_bed"),
        ("sofa", (2.4, 0.8, 0.9), "multi_seat_sofa"),
        ("sofa", (2.4, 0.8, 1.7), "l_shaped_sofa"),
        ("table", (1.2, 0.4, 0.7), "coffee_table"),
        ("table", (0.5, 0.5, 0.5), "side_table"),
        ("lamp", (0.4, 1.6, 0.4), "floor_lamp"),
        ("stool", (0.4, 0.75, 0.4), "barstool"),
        ("wardrobe", (0.4, 0.75, 0.4), "wardrobe"),
    ],
)
def test_a_box_says_which_kind_of_bed_or_table_it_is(
    word: str, size: tuple[float, float, float], category: str
) -> None:
    assert exact_category(word, size) == category
