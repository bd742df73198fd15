"""Texts give the short scripts that they gave when somebody last read them."""

from __future__ import annotations

import io
import json
from dataclasses import asdict
from typing import Any

from recorded import agrees

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.extraction.extract import extract
from planner_service.extraction.extraction_result import Means, Source
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script_library import Features, ScriptLibrary

NOVEL = """
Anna came home late on Thursday. She dropped her bag by the door, slumped onto the couch and stared at the ceiling. "I
cannot do this any more," she said. After a while she got up, opened the wardrobe and took out the old blue dress.

The next morning it rained. Tom was already sitting at the kitchen table and read the newspaper when the phone rang.
He let it ring. Anna, who had not slept, walked slowly to the window and did not look at him. Then she lay down on the
bed again and wept until noon.

Years before, they had danced in this room. Now he paced up and down, angry, and slammed the cupboard.
"""
SCREENPLAY = """
INT. STUDY - NIGHT

DANIEL (40), unshaven, shuffles in and sits down at the desk. He types.

DANIEL
(whispering)
Where is it?

He gets up, searches the bookshelf and finds a letter. He reads it, smiling.

INT. BEDROOM - MORNING

MARIA wakes, stretches and gets out of bed. She makes the bed and brushes her hair before the mirror.
"""


def test_extractions_are_as_recorded() -> None:
    means = Means(ScriptLibrary(built_in(), Features(HashingEncoder())))
    texts = {"a novel": NOVEL, "a screenplay": SCREENPLAY}
    agrees(
        "extractions",
        {
            name: json.loads(json.dumps(found, default=plain))
            for name, text in texts.items()
            for found in [asdict(extract(Source(name, io.BytesIO(text.encode())), means))]
        },
    )


def plain(found: Any) -> Any:
    return found.model_dump(mode="json")
