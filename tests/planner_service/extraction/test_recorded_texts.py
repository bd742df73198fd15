"""Subtitles, screenplays and files in any letters are taken apart as they were when somebody last looked at them."""

from __future__ import annotations

from typing import Any, Final

import pytest
from recorded import agrees

from motion_backend.motion import Skill
from planner_service.extraction import llm_text
from planner_service.extraction.screenplay import is_screenplay
from planner_service.extraction.script_writer import in_present, summarise
from planner_service.extraction.subtitles import SubtitleError, read_subtitles
from planner_service.extraction.text_files import ExtractionError, decode, read_text
from planner_service.extraction.text_scenes import Line, TextScene, scenes_of_cues, scenes_of_text
from planner_service.scripts.script import Keyframe
from planner_service.themes.language import language_of

SRT: Final = """1
00:00:01,000 --> 00:00:03,500
<i>She walks</i> slowly
to the window.

2
00:00:03,600 --> 00:00:02,000
- Where are you?
- (SIGHS) Here. [door slams]

oops
3
00:00:05,000 --> 00:00:07,000 X1:10 X2:20
ANNA: I cannot stay
4
00:00:07,100 --> 00:00:08,000
any longer.

5
01:00:09,5 --> 01:00:12
He sits down on the bed. ♪ la la la ♪

6
00:00:20,000 --> 00:00:21,000
{\\an8}

6
01:00:09,5 --> 01:00:12
He sits down on the bed. ♪ la la la ♪
"""
VTT: Final = """WEBVTT - a film

STYLE
::cue { color: red }

NOTE nothing to see

intro
00:01.000 --> 00:04.000 align:start position:10%
<v Tom Waits>Sit down, <b>please</b>.</v>

00:05.000 --> 00:06.500
[phone rings] &amp; he answers it &lt;quietly&gt;

00:50.000 --> 00:52.000
>> NARRATOR: Years later she lies
on the sofa and sleeps.
"""
ASS: Final = """[Script Info]
Title: x

[Events]
Format: Layer, Start, End, Style, Name, MarginL, MarginR, MarginV, Effect, Text
Comment: 0,0:00:00.00,0:00:01.00,Default,,0,0,0,,not shown
Dialogue: 0,0:00:01.50,0:00:04.00,Default,Eva,0,0,0,,{\\i1}I am tired,{\\i0}\\Nso tired, really.
Dialogue: 0,0:00:04.20,0:00:05.00,Default,,0,0,0,,{\\p1}m 0 0 l 1 1{\\p0}
Dialogue: 0,0:00:06.00,0:00:09.25,Default,,0,0,0,,She gets up and opens the wardrobe. (creaking)
"""
PLAY: Final = """THE LODGER

FADE IN:

INT. KITCHEN - DAY

MARTHA, 60, washes the dishes. Steam.

MARTHA
(not turning around)
You are late again.

The LODGER puts his hat on the table and sits.

LODGER (CONT'D)
The train...

CUT TO:

EXT. STREET - NIGHT

Rain. Nobody.

INT./EXT. CAR / BEDROOM - CONTINUOUS

He lies down, fully dressed.
"""
TALE: Final = """Chapter One

It was cold. She lit the stove, put the kettle on and waited by the window.

"Who is there?" she asked. Nobody answered.

* * *

The next day he came back. He sat at the table, ate two eggs and said nothing. After that he slept for ten hours.
"""
FILES: Final = {
    "utf-8 with a mark": "\ufeffÀ table, s’il vous plaît!".encode(),
    "utf-16": "Sie setzt sich.\r\nEr steht auf.".encode("utf-16"),
    "latin": "Er öffnet die Tür und hört Musik. Grüße!".encode("latin-1"),
    "windows": "“Sit down,” she says – and sits…".encode("cp1252"),
    "cyrillic": "Она садится на диван и читает книгу.".encode("cp1251"),
    "hyphens": b"She walks to the win-\ndow and   opens\tit.\n\n\n\nThen she sleeps.\f",
    "html": b"<p>He <b>sits</b> down.</p><script>x()</script>",
    "nothing": b" \n\t ",
    "bytes": bytes(range(256)) * 4,
    "nul": b"a\0b\0c\0" * 20,
}
LANGUAGES: Final = (
    "She sits down and reads the letter that he wrote.", "Sie setzt sich und liest den Brief, den er schrieb.",
    "Elle s'assied et lit la lettre qu'il a écrite.", "Ella se sienta y lee la carta que él escribió.", "x y z", "",
)  # fmt: skip


def test_texts_are_as_recorded() -> None:
    agrees("texts", {
        "subtitles": {name: subtitles(text) for name, text in (("srt", SRT), ("vtt", VTT), ("ass", ASS), ("no", TALE))},
        "scenes": {name: scenes(scenes_of_text(text)) for name, text in (("a play", PLAY), ("a tale", TALE))},
        "are plays": [is_screenplay(text) for text in (PLAY, TALE, SRT)],
        "files": {name: opened(data, name) for name, data in FILES.items()},
        "languages": [language_of(text) for text in LANGUAGES],
    })  # fmt: skip


CLAUSES: Final = (
    "slumped onto the couch", "sat by her bed", "could not sleep", "Anna's mother calls her", "is tired, and yawns",
    "<b>reads</b> the letter", "was reading my book", "the door opens", "", "goes to the window with you",
    "lies down " + "and thinks of the sea, " * 12, "had been crying",
)  # fmt: skip


def test_summaries_are_as_recorded() -> None:
    """What clauses become, one by one and several together; and what is told where none can be."""
    rows = (("sitdown", "sofa"), ("loco", "floor"), ("touch", "lamp"), ("liedown", "bed"), ("standup", "bed"))
    acted = [Keyframe(skill=Skill(skill), caption="x", furniture=piece, emotion="sad") for skill, piece in rows]
    agrees("summaries", {
        "present": {clause[:30]: in_present(clause, ["Anna"]) for clause in CLAUSES},
        "summaries": [summarise(CLAUSES[start : start + 5], acted, mood, ["Anna"])
                      for start, mood in ((0, "neutral"), (3, "tired"), (6, "angry"))],
        "plainly": [summarise([], acted[:many], "sad") for many in (1, 2, 3, 5)],
        "short": [len(summarise([f"reads {'a long, very long letter ' * 4}{n}" for n in range(8)], acted, "sad"))],
    })  # fmt: skip


def test_questions_hold_so_many_letters_and_no_word_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(llm_text, "MAX_PIECE_LENGTH", 200)
    lines = (Line(f"He walks {n} steps to the window. Then he sits.", n % 3 == 0) for n in range(20))
    long = TextScene(tuple(lines), "Hall")
    cut, notes = llm_text.portions_of([long, TextScene((Line("She sleeps."),))])
    assert all(len(llm_text.shown(scene)) <= 200 for scene in cut)
    assert len(notes) == 1
    assert " ".join(scene.told for scene in cut).split() == f"{long.told} She sleeps.".split()
    assert " ".join(scene.spoken for scene in cut).split() == long.spoken.split()
    assert len(cut) < 9, "as many lines together as one question holds"
    assert list(llm_text.fitting("One two. Three four five", 12)) == ["One two.", "Three four", "five"]
    assert list(llm_text.fitting("abcdefgh", 3)) == ["abc", "def", "gh"]


def subtitles(text: str) -> dict[str, Any]:
    try:
        read = read_subtitles(text.encode())
    except SubtitleError as error:
        return {"refused": str(error)}
    cues = [f"{cue.start:.2f}-{cue.end:.2f} {cue.speaker}: {cue.text} {list(cue.sounds)}" for cue in read.cues]
    return {"form": read.form, "notes": list(read.notes), "cues": cues, "scenes": scenes(scenes_of_cues(read.cues))}


def scenes(found: tuple[TextScene, ...]) -> list[list[str]]:
    """Of each where and when it is, then its lines."""
    return [
        [
            f"{one.place} {one.outside} {one.start}-{one.end}",
            *(f"{'says' * line.spoken}: {line.text}" for line in one.lines),
        ]
        for one in found
    ]


def opened(data: bytes, name: str) -> dict[str, Any]:
    decoded = decode(data)
    told: dict[str, Any] = {"encoding": decoded.encoding, "note": decoded.note}
    try:
        text, notes = read_text(data, name)
    except ExtractionError as error:
        return told | {"refused": str(error)}
    return told | {"text": text, "notes": list(notes)}
