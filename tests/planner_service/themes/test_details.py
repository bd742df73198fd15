from planner_service.themes.details import details_of
from planner_service.themes.sentence_parser import clauses_of_text


def test_what_a_clause_tells_besides_its_deed_is_parted_from_it() -> None:
    (clause,) = clauses_of_text("She draws out the chair for her ladyship with a tray on her fingertips.")
    assert details_of(clause) == ("for her ladyship", "with a tray on her fingertips")


def test_what_a_deed_is_done_to_is_no_detail_of_it() -> None:
    (clause,) = clauses_of_text("He looks for his keys.")
    assert details_of(clause) == ()
