"""The ten stories of docs/examples, told by what the program says today: `python docs/stories.py` writes them anew."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from motion_backend.motion import Character
from planner_service.pipeline import Pipeline, Planned, StoryRequest
from planner_service.scripts.script import LongScript

FOLDER = Path(__file__).resolve().parent / "examples"
WIDTH = 100


@dataclass(frozen=True)
class Example:
    """One story: the file it is in, and what is asked for."""

    file: str
    theme: str
    seed: int
    character: Character = field(default_factory=Character)

    @property
    def command(self) -> str:
        """The command line that makes the whole film of it."""
        words = ["sims", "story", self.theme, "--seed", str(self.seed), "--out", f"out/{self.file}"]
        if self.character != Character():
            words += ["--name", self.character.name, "--pronouns", self.character.pronouns]
        return shlex.join(words)


EXAMPLES = (
    Example(
        "the-interview",
        "A person is happy at first, but he is told in the phone that he fails the job interview and becomes very "
        "depressed.",
        0,
        Character("James", "he"),
    ),
    Example(
        "the-photograph",
        "The character ponders over an old photograph and reflects on memories in the living room. He then remembers "
        "his dead wife and becomes sad. He then decides to drink a bottle of wine and becomes drunken and rests on the "
        "sofa.",
        1,
        Character("Henry", "he"),
    ),
    Example(
        "the-lottery",
        "A character is sitting on the chair and becomes excited when he finds that he won a lottery, so he run "
        "excitedly around the room. And he relaxes on the sofa.",
        2,
        Character("Karim", "he"),
    ),
    Example(
        "the-picnic",
        "A person is dressing up and feels excited about the picnic tomorrow.",
        3,
        Character("Emily", "she"),
    ),
    Example(
        "the-night-shift", "Anna comes home tired after a night shift, eats something and goes straight to bed.", 4
    ),
    Example("the-quarrel", "She comes home after a quarrel with her boss, slams the door and cries on the bed.", 5),
    Example(
        "the-idea",
        "A writer has no ideas, paces up and down, and suddenly has a brilliant idea.",
        6,
        Character("Noor", "they"),
    ),
    Example(
        "the-guests", "Lisa cleans the house in a hurry because guests are coming, lays the table and welcomes them.", 7
    ),
    Example("the-exam", "Tom studies all night for an exam, falls asleep at the desk and oversleeps.", 18),
    Example(
        "the-keys", "A woman searches for her keys, misses the bus, gets angry and then calms down with a book.", 9
    ),
)


def request(example: Example) -> StoryRequest:
    """What is asked for."""
    return StoryRequest(example.theme, seed=example.seed, character=example.character)


def told(example: Example, pipeline: Pipeline) -> Planned:
    """The story of an example, planned and told."""
    return pipeline.plan(request(example))


def page(example: Example, planned: Planned) -> str:
    """The text of an example's file."""
    who = planned.request.character
    lines = [
        f"# {planned.told.title}",
        "",
        *(f"> {line}" for line in wrapped(example.theme)),
        "",
        f"![{planned.told.title}, acted]({example.file}.webp)",
        "",
        planned.told.marked(lambda words: f"*{words}*"),
        "",
        "---",
        "",
        f"Seed {example.seed}, told of {who.name} ({who.pronouns}) by rules. " + _parts(planned.script),
        "",
        "```",
        example.command,
        "```",
        "",
        "[How these pages are made](README.md)",
    ]
    return "\n".join(lines) + "\n"


def _parts(script: LongScript) -> str:
    """Which beats are acted, and what was taken from the library for them."""
    parts = ", ".join(f"`{found.script.id}`" for found in script.short_scripts)
    served = [beat for beat in script.beats if beat.stood_for and not beat.why]
    said = f"{script.acted} of {script.asked} beats of the theme are acted"
    missed = "; ".join(f"“{beat.text}”: {beat.why}" for beat in script.beats if beat.asked and beat.why)
    stood = "; ".join(f"“{beat.text}”" for beat in served)
    said += (f" (not: {missed})" if missed else "") + "." + (f" Something else stands for {stood}." if stood else "")
    return said + (f" Parts of {parts}." if parts else "")


def wrapped(text: str) -> Iterator[str]:
    """Lines of at most `WIDTH` letters."""
    line = ""
    for word in text.split():
        if len(line) + len(word) >= WIDTH:
            yield line
            line = ""
        line += f" {word}" if line else word
    yield line


def index() -> str:
    """The text of README.md in the folder."""
    rows = [
        f"| [![{name}]({example.file}.webp)]({example.file}.md) | **[{name}]({example.file}.md)**<br>{example.theme} |"
        for example in EXAMPLES
        for name in [example.file.replace("-", " ")]
    ]
    return "\n".join(
        [
            "# Ten stories",
            "",
            "Told without a language model: planned beat by beat and worded by rules. Each page has the theme, moments",
            "of the film, the story, and the command that makes it with its home and its film.",
            "`python docs/stories.py` writes the pages anew (the sentence encoder has to be installed),",
            "`python docs/gallery.py` films them; two of them are made again by a test.",
            "",
            "| moments | theme |",
            "|---|---|",
            *rows,
            "",
        ]
    )  # fmt: skip


def main() -> None:
    """Write every page, and remove none."""
    FOLDER.mkdir(exist_ok=True)
    pipeline = Pipeline()
    for example in EXAMPLES:
        (FOLDER / f"{example.file}.md").write_text(page(example, told(example, pipeline)), encoding="utf-8")
    (FOLDER / "README.md").write_text(index(), encoding="utf-8")


if __name__ == "__main__":
    main()
