"""Sentences are taken apart, and their deeds found, as they were when somebody last read them."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, Final

from recorded import agrees

from motion_backend.motion import Character
from planner_service.composition.deed_lexicon import deed_of, object_of
from planner_service.composition.furniture_words import room_of
from planner_service.composition.unshown import unshown
from planner_service.narration.narrative_voice import Voice
from planner_service.narration.retold_theme import retell
from planner_service.themes.beats import ReadBeat, ThemeError, beats_of
from planner_service.themes.clause import Clause
from planner_service.themes.details import details_of
from planner_service.themes.protagonist import cast_by, hero_of
from planner_service.themes.sentence_parser import clauses_of_text

SENTENCES: Final = (
    "Maria comes home from work, kicks off her shoes and falls onto the couch.",
    "After he had washed the dishes, Tom dried his hands and sat down to read the paper.",
    "She neither eats nor drinks; she just lies on the bed, staring at the ceiling.",
    "He wants to call his mother but cannot find the phone.",
    "Before going to sleep, she writes in her diary for an hour.",
    "Furious about the letter he found in the drawer, Jonas slams the door of the wardrobe.",
    "The old man who lost his wife walks to the window and waves at the children outside.",
    "While the soup is boiling, Anna paces up and down, humming.",
    "It is late. He switches off the lamp, gets into bed and is asleep within minutes.",
    "Her hands shaking, she opens the envelope, reads the first line and sinks to the floor.",
    "“I will never forgive you,” she says, and puts the ring on the table.",
    "He does not smoke, drink or dance, and he rarely laughs.",
    "A nervous student practises her speech in front of the mirror, then rehearses it again.",
    "They argue all evening until Peter storms out of the room.",
    "Being tired, Lea leans back in the armchair with her feet up and closes her eyes.",
    "Grandma knits by the fireplace; the cat is sleeping on her lap.",
    "She has just finished her homework, so she plays a video game on the sofa.",
    "He gets up, stretches, yawns and shuffles to the kitchen for a glass of water.",
    "If it rains tomorrow, he will stay in bed and read.",
    "Unable to sleep, the boy takes a torch and reads a comic under the blanket.",
    "She looks for her keys under the bed, behind the couch and on every shelf.",
    "Having been told the news, he drops into the chair and buries his face in his hands.",
    "Dressed in black, she walks slowly around the room and touches each of the pictures.",
    "What he saw on television made him so angry that he turned it off.",
    "She sits cross-legged on the floor and meditates; later she does push-ups.",
    "He limps to the sofa, lies down on his left side and moans softly.",
    "The phone rings. She answers it, listens, and begins to cry.",
    "Drunk and happy, Ben dances through the living room with a bottle in his hand.",
    "She was about to leave when the doorbell rang.",
    "He tidies the desk, waters the plants, feeds the fish and finally rests.",
    "Instead of working, Karl watches a film and eats popcorn on the couch.",
    "With a sigh of relief, Ida takes off her coat and hangs it in the closet.",
    "He rubs his eyes and goes on typing at the desk.",
    "The girl hides behind the curtain because she is afraid of the thunder.",
    "They sit at the dining table, hold hands and pray.",
    "She picks up the book that lies on the nightstand, leafs through it and puts it back.",
    "Restless, he sits down, gets up again, and looks at the clock.",
    "He spends the morning in bed with a fever and drinks tea.",
    "My sister brushes her hair at the dressing table before she goes dancing.",
    "Nobody is home, so Max jumps on the bed and sings as loud as he can.",
    "Kneeling beside the crib, she sings the baby to sleep.",
    "He tries on three shirts, likes none of them, and throws them on the bed.",
    "She stood at the window for a long time, thinking of what he had said.",
    "As soon as the guests are gone, she sweeps the floor and loads the dishwasher.",
    "She'd gone to bed early, though she'd like to talk; he'd rather sit alone.",
    "Only when it was dark did he rise, and never does she sit still.",
    "He nearly falls over the rug, catches himself and no longer runs.",
    "She might have been sleeping, but her husband does not; he should be working.",
    "He lets himself sink into the armchair and forces himself to smile.",
    "She used to play the piano and had been practising all day before she collapsed.",
    "He refuses to get up, fails to find his glasses and keeps complaining.",
    "There she sits, there he stands, and out of the window flies the bird.",
    "It's been a long day; it's time to lie down, so that's what I do.",
    "We'd never been so happy as when we danced in our kitchen.",
    "The bed is made, the lamp is lit, and the letter lies unopened on the desk.",
    "Who could have known? Not he, who was sitting on the floor, his back against the wall.",
    "She stops crying, starts laughing and ends up lying on the rug.",
    "Let us rest, she thinks, and without taking off her boots she stretches out on the couch.",
    "He would have called her if he had not lost his voice.",
    "Too tired to cook, they order pizza, eat it in bed and watch a film.",
    "I lay the table, and my brother and I sit down; then we argue until he leaves.",
    "My mother lay on the couch while I was laying out her clothes.",
    "The baby cries until its mother lifts it out of the crib and walks to and fro with it.",
    "A newborn sleeps on the sofa while Paula, who is exhausted, sits beside it and knits.",
    "The infant laughs. Nora claps her hands and dances.",
    "Stand up, open the window, sit down again.",
    "The doctor told him to rest; he does, with a hot-water bottle on his belly.",
)


REFUSED: Final = (
    "", " \n ", "123 !!", "x" * 9_000, "a bell \x07 rings", "Er setzt sich aufs Sofa und liest die Zeitung.",
    "What time is it?", "Please write me a poem about cats.", "Elle s'assied sur le canapé et elle pleure.",
)  # fmt: skip


def test_what_is_no_theme_is_refused_as_recorded() -> None:
    found = {}
    for text in REFUSED:
        try:
            found[text[:20]] = str(len(beats_of(text)))
        except ThemeError as error:
            found[text[:20]] = f"{error}"
    agrees("no_themes", found)


def test_sentences_are_as_recorded() -> None:
    agrees("sentences", {text: told(text) for text in SENTENCES})


def told(text: str) -> dict[str, Any]:
    """Whom it is about, and a line for every clause and for every beat."""
    clauses = clauses_of_text(text)
    hero = hero_of(clauses)
    who = cast_by(text, Character())
    beats = beats_of(text)
    return {
        "about": f"{hero}: {who.name}, {who.pronouns}, {who.age}",
        "clauses": [line(clause) for clause in clauses],
        "beats": [beat_line(beat) for beat in beats],
        "told": retell(text, [one.beat for one in beats], Voice.of(who)).text,
    }


def line(clause: Clause) -> str:
    """What was found out about a clause."""
    flags = [field.name for field in fields(clause) if getattr(clause, field.name) is True]
    words = (clause.joint, clause.doer, clause.text, clause.verb, " ".join(clause.lemmas), *clause.quotes, *flags)
    return " | ".join([*words, f"{clause.sentence}.{clause.place}"])


def beat_line(read: ReadBeat) -> str:
    """What a beat says, and what a body does for it."""
    beat, deed = read.beat, deed_of(read.clause)
    does = f"{deed.skill} at {', '.join(deed.pieces)}{' (named)' * deed.named}" if deed else "nothing"
    mood = f"{beat.emotion}{'!' * read.sure}"
    besides = [*details_of(read.clause), *unshown(read.clause, deed.pieces if deed else ())]
    return " | ".join([
        beat.text, beat.kind, beat.who, mood, read.room or "", room_of(read.clause) or "", does,
        object_of(read.clause), "; ".join(besides),
    ])  # fmt: skip
