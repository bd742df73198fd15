from planner_service.themes.details import core_of, details_of
from planner_service.themes.sentence_parser import clauses_of_text


def test_what_a_clause_tells_besides_its_deed_is_parted_from_it() -> None:
    (clause,) = clauses_of_text("She draws out the chair for her ladyship with a tray on her fingertips.")
    assert details_of(clause) == ("for her ladyship", "with a tray on her fingertips")
    assert core_of(clause.text, details_of(clause)) == clause.text
    (clause,) = clauses_of_text("She fries the eggs with a song for her ladyship.")
    assert core_of(clause.text, details_of(clause)) == "fries the eggs for her ladyship"


def test_nothing_is_left_hanging_where_a_detail_was() -> None:
    assert core_of("checks the doors, and at four the stove", ("at four the stove",)) == "checks the doors"
    assert core_of("lies on his left side, on his right side, on his back", ("on his right side",)) == (
        "lies on his left side, on his back"
    )


def test_what_a_deed_is_done_to_is_no_detail_of_it() -> None:
    (clause,) = clauses_of_text("He looks for his keys.")
    assert details_of(clause) == ()
