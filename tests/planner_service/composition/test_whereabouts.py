"""Things stay where they were put: what is done to them is done there, and "back" is where they came from."""

from __future__ import annotations

from for_each import for_each

from motion_backend.motion import Skill
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.deed_table import DeedRow
from planner_service.composition.whereabouts import Spot, Whereabouts, is_held, is_worn
from planner_service.themes.clause import Clause
from planner_service.themes.sentence_parser import clauses_of_text

SHELF: Spot = ("living_room", "shelf")
TABLE: Spot = ("dining_room", "table")
ANYWHERE = Deed(DeedRow(("do",), Skill.TOUCH), Skill.TOUCH, ("cabinet", "desk"), False)


def clause(text: str) -> Clause:
    return clauses_of_text(f"She {text}.")[0]


@for_each("thing", ["cup", "parcel", "scarf"])
def test_what_is_done_to_it_is_done_where_it_was_put_and_back_is_where_it_came_from(thing: str) -> None:
    known = Whereabouts()
    assert known.of(clause(f"wipes the {thing}"), ANYWHERE) is None
    known.laid(clause(f"takes the {thing} from the shelf"), SHELF)
    assert known.in_hand(clause(f"holds the {thing}"))
    assert known.in_hand(clause("closes it"))
    assert known.of(clause("wipes it"), ANYWHERE) is None, "it is in the hands"
    known.laid(clause(f"puts the {thing} on the table"), TABLE)
    for text in ("wipes it", f"wipes the {thing}", "opens it"):
        assert known.of(clause(text), ANYWHERE) == TABLE
    assert known.of(clause("puts it back"), ANYWHERE) == SHELF
    assert known.of(clause("wipes it"), Deed(ANYWHERE.row, Skill.TOUCH, ("bed",), True)) is None, "another is named"
    assert known.of(clause("washes it"), Deed(ANYWHERE.row, Skill.TOUCH, ("kitchen sink",), False)) is None


def test_what_is_taken_out_of_what_was_opened_is_there() -> None:
    known = Whereabouts()
    assert known.of(clause("takes out a scarf"), ANYWHERE) is None
    known.laid(clause("opens the box"), TABLE)
    assert known.of(clause("takes out a scarf"), ANYWHERE) == TABLE


def test_what_is_found_in_what_was_opened_is_there_and_it_is_opened_where_it_was_put() -> None:
    known = Whereabouts()
    known.laid(clause("sets it on the table"), TABLE)
    sink = Deed(ANYWHERE.row, Skill.TOUCH, ("kitchen sink",), False)
    assert [known.of(clause(text), sink) for text in ("cuts it", "washes it")] == [TABLE, None]
    known.laid(clause("opens it"), TABLE)
    assert known.of(clause("finds a scarf"), ANYWHERE) == TABLE
    assert known.of(clause("sorts a scarf"), ANYWHERE) is None


def test_nobody_walks_to_what_is_in_the_hands_or_the_pockets() -> None:
    for text in ("found them in his pocket", "takes a coin out of her coat pocket"):
        assert is_worn(clause(text))
    assert not is_worn(clause("takes a coin out of the drawer"))
    assert [is_held(one) for one in clauses_of_text("He dances, holding the picture.")] == [False, True]
