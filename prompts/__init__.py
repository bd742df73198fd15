"""What we say to language models: one Markdown file a prompt, with named blanks, read and filled here.

A user's own folder may hold others in place of these (`use`).

A file starts with front matter between two `---` lines: `name`, `version`, `variables` (comma separated, ours) and
`data` (comma separated, words of users or models). A blank is `{{name}}`. Data is fenced as
`<data name="…">…</data>`, and a fence inside it is defused, so that what a user wrote cannot end it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

_BLANK = re.compile(r"\{\{\s*([a-z_]+)\s*\}\}")
_FENCE = re.compile(r"<(?=\s*/?\s*data\b)", re.IGNORECASE)
_FIELDS = ("name", "version", "variables", "data")


class PromptError(ValueError):
    """A prompt file is malformed, unknown, or was filled with the wrong values."""


class Filled(str):
    """What a model is told, and which version of which prompt it was filled from."""

    __slots__ = ("name", "version")

    name: str
    version: int

    def __new__(cls, text: str, name: str, version: int) -> Filled:
        """A str like any other, with its origin."""
        filled = super().__new__(cls, text)
        filled.name, filled.version = name, version
        return filled


@dataclass(frozen=True)
class Prompt:
    """One prompt file."""

    name: str
    version: int
    variables: tuple[str, ...]
    """Blanks that we fill with our own words."""
    data: tuple[str, ...]
    """Blanks that hold what a user or a model wrote: fenced."""
    text: str

    def fill(self, /, **values: str) -> Filled:
        """The text with every blank filled; PromptError names blanks without a value and values without a blank."""
        wanted = {*self.variables, *self.data}
        missing, extra = sorted(wanted - values.keys()), sorted(values.keys() - wanted)
        if missing or extra:
            raise PromptError(
                f"prompt {self.name!r}: missing {', '.join(missing) or 'nothing'}, "
                f"not asked for {', '.join(extra) or 'nothing'}; it takes {', '.join(sorted(wanted))}"
            )
        filled = {name: fence(name, values[name]) if name in self.data else values[name] for name in wanted}
        text = _BLANK.sub(lambda blank: filled[blank[1]], self.text)  # one pass: values are never read as blanks
        return Filled(text, self.name, self.version)


def fence(name: str, text: str) -> str:
    """Text of others between marks that it cannot close."""
    return f'<data name="{name}">\n{_FENCE.sub("‹", text).strip()}\n</data>'


def parse(source: str, where: str) -> Prompt:
    """A prompt from the text of its file; PromptError says what is wrong and where."""
    head, _, text = source.removeprefix("---\n").partition("\n---\n")
    if not source.startswith("---\n") or not text:
        raise PromptError(f"{where}: front matter must stand between two lines of ---")
    fields = {}
    for line in head.splitlines():
        key, colon, value = line.partition(":")
        if not colon or key.strip() not in _FIELDS:
            raise PromptError(f"{where}: cannot read {line!r}; front matter has {', '.join(_FIELDS)}")
        fields[key.strip()] = value.strip()
    if not fields.get("name") or not fields.get("version", "").isdecimal():
        raise PromptError(f"{where}: front matter needs a name and a whole number as version")
    variables, data = (_names(fields.get(key, "")) for key in ("variables", "data"))
    blanks = set(_BLANK.findall(text))
    if blanks != {*variables, *data}:
        odd = ", ".join(sorted(blanks ^ {*variables, *data}))
        raise PromptError(f"{where}: the blanks of the text and the names in the front matter differ: {odd}")
    return Prompt(fields["name"], int(fields["version"]), variables, data, text.strip() + "\n")


def names() -> tuple[str, ...]:
    """Every prompt there is."""
    files = resources.files(__package__).iterdir()
    return tuple(sorted(file.name.removesuffix(".md") for file in files if file.name.endswith(".md")))


_OWN: dict[str, Prompt] = {}
"""A user's own, by name, for the whole process."""


def use(folder: Path | None) -> None:
    """Let the prompts in a folder, NAME.md each, take the place of ours; None: ours again.

    PromptError for one that we do not have, whose blanks are others than ours, or that says something else under our
    version: what was answered to a version must stay the answer to one text.
    """
    own = {}
    for file in sorted(folder.glob("*.md")) if folder is not None else ():
        prompt, ours = parse(file.read_text(encoding="utf-8"), str(file)), shipped(file.stem)
        if (prompt.name, set(prompt.variables), set(prompt.data)) != (ours.name, set(ours.variables), set(ours.data)):
            taken = f"variables {', '.join(ours.variables) or 'none'} and data {', '.join(ours.data) or 'none'}"
            raise PromptError(f"{file}: it must be called {ours.name} and have our blanks, {taken}")
        if prompt.version == ours.version and prompt.text != ours.text:
            raise PromptError(f"{file}: version {ours.version} is ours; a changed text needs a number of its own")
        own[prompt.name] = prompt
    if folder is not None and not own:
        raise PromptError(f"{folder}: there is no prompt in it, NAME.md for one of {', '.join(names())}")
    _OWN.clear()
    _OWN.update(own)


def read(name: str) -> Prompt:
    """The prompt of that name, a user's own where there is one, or PromptError listing the names there are."""
    return _OWN.get(name) or shipped(name)


@cache
def shipped(name: str) -> Prompt:
    """Our prompt of that name."""
    if name not in names():
        raise PromptError(f"there is no prompt {name!r}; there are {', '.join(names())}")
    source = resources.files(__package__).joinpath(f"{name}.md").read_text(encoding="utf-8")
    prompt = parse(source, f"{name}.md")
    if prompt.name != name:
        raise PromptError(f"{name}.md: its front matter calls it {prompt.name!r}")
    return prompt


def render(name: str, /, **values: str) -> Filled:
    """The text of a prompt with its blanks filled."""
    return read(name).fill(**values)


def _names(value: str) -> tuple[str, ...]:
    return tuple(word.strip() for word in value.split(",") if word.strip())
