"""Whoever else is told to be there is named, since one person is played."""

from __future__ import annotations

from for_each import for_each

from motion_backend.motion import Skill
from planner_service.composition.other_people import others_in
from planner_service.scripts.script import PlannedKeyframe
from planner_service.themes.sentence_parser import clauses_of_text


@for_each(
    ("text", "others"),
    [
        ("Julia and Ben ate dinner together at the table.", ("and Ben", "together")),
        ("He kissed him on the cheek.", ("him",)),
        ("Marek hugged his mother.", ("his mother",)),
        ("She gave her the flowers.", ("her",)),
        ("He plays chess against his father.", ("against his father",)),
        ("He yells at his sister.", ("at his sister",)),
        ("He took the pizza from the courier.", ("from the courier",)),
        ("She strokes the cat on her lap.", ("the cat",)),
        ("They talk to each other.", ("each other",)),
        ("She looks at Tom.", ("at Tom",)),
        ("He puts the pieces together.", ()),
        ("She took her bag.", ()),
        ("She put her coat on.", ()),
        ("He reads his mother's letter.", ()),
        ("She braids her doll's hair.", ()),
        ("She goes to her bedroom.", ()),
        ("Bread and butter lie there together.", ("together",)),
    ],
)
def test_who_else_is_told_to_be_there_is_found(text: str, others: tuple[str, ...]) -> None:
    assert others_in(clauses_of_text(text)[0], []) == others


def test_who_is_phoned_or_written_to_need_not_be_there() -> None:
    clause = clauses_of_text("She talks to her mother.")[0]
    phones, talks = (
        PlannedKeyframe(skill=Skill.LOCO, caption=caption, furniture="floor")
        for caption in ("walk while talking on the phone with the right hand", "talking with both hands")
    )
    assert others_in(clause, [phones]) == ()
    assert others_in(clause, [talks]) == ("to her mother",)
