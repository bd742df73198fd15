"""Reading a Dockerfile and its .dockerignore: stages of instructions, and nothing that is not understood."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

KNOWN = frozenset({"ARG", "ENV", "WORKDIR", "COPY", "RUN", "USER", "VOLUME", "EXPOSE", "HEALTHCHECK", "CMD"})
"""The instructions that `run_steps.py` can carry out as an engine would."""


class DockerfileError(ValueError):
    """A line that is not understood, or that would mean something else here than in an engine."""


@dataclass(frozen=True)
class Instruction:
    """One instruction of a stage."""

    line: int
    """Where it begins, from 1."""
    word: str
    """COPY, RUN, …"""
    flags: tuple[tuple[str, str], ...]
    """What stands between the word and the rest, such as ("from", "build")."""
    rest: str
    """All else, continued lines joined."""

    def flag(self, name: str) -> str:
        """The value of a flag, empty when it is not given."""
        return dict(self.flags).get(name, "")

    def __str__(self) -> str:
        return " ".join([self.word, *(f"--{name}={value}" for name, value in self.flags), self.rest])


@dataclass(frozen=True)
class Stage:
    """What begins with FROM and ends before the next."""

    base: str
    name: str
    """Of `AS`, else its number."""
    instructions: tuple[Instruction, ...]


def read_dockerfile(text: str) -> list[Stage]:
    """The stages in order. DockerfileError names the line that is not understood."""
    stages: list[Stage] = []
    found: list[Instruction] = []
    for one in _instructions(text):
        if one.word == "FROM":
            match = re.fullmatch(r"(?P<base>[\w./:-]+)(?:\s+AS\s+(?P<name>[\w-]+))?", one.rest, re.IGNORECASE)
            if not match or one.flags:
                raise DockerfileError(f"line {one.line}: write FROM image AS name")
            found = []
            stages.append(Stage(match["base"], match["name"] or str(len(stages)), ()))
        elif not stages:
            raise DockerfileError(f"line {one.line}: {one.word} before the first FROM")
        elif one.word not in KNOWN:
            raise DockerfileError(f"line {one.line}: {one.word} is not one of {', '.join(sorted(KNOWN))}")
        else:
            found.append(one)
            stages[-1] = Stage(stages[-1].base, stages[-1].name, tuple(found))
    return stages


def _instructions(text: str) -> list[Instruction]:
    found: list[Instruction] = []
    begun, number = "", 0
    for at, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("#") or (not begun and not line.strip()):
            if re.match(r"#\s*(escape|syntax)\s*=", line):
                raise DockerfileError(f"line {at}: parser directives are not known here")
            continue
        number = number if begun else at
        begun += line.strip()
        if begun.endswith("\\"):
            begun = begun[:-1]
            continue
        found.append(_instruction(number, begun))
        begun = ""
    if begun:
        raise DockerfileError(f"line {number}: ends in a backslash")
    return found


def _instruction(line: int, text: str) -> Instruction:
    word, _, rest = text.partition(" ")
    flags: list[tuple[str, str]] = []
    rest = rest.strip()
    while match := re.match(r"--([a-z-]+)=(\S+)\s+", rest):
        flags.append((match[1], match[2]))
        rest = rest[match.end() :]
    if "<<" in rest:
        raise DockerfileError(f"line {line}: here-documents are not known here")
    return Instruction(line, word.upper(), tuple(flags), rest)


@dataclass(frozen=True)
class Ignore:
    """The rules of a .dockerignore: the last that fits a path or a folder above it counts."""

    rules: tuple[tuple[re.Pattern[str], bool], ...]
    """What to look for, and whether it is left out."""

    def leaves_out(self, path: str) -> bool:
        """Whether a path, relative to the context, is not sent."""
        parts = path.split("/")
        heads = ["/".join(parts[: n + 1]) for n in range(len(parts))]
        out = False
        for pattern, leaves in self.rules:
            if any(pattern.fullmatch(head) for head in heads):
                out = leaves
        return out


def read_dockerignore(path: Path) -> Ignore:
    """The rules of a file; none when there is no file."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    rules = [line.strip() for line in lines if line.strip() and not line.startswith("#")]
    return Ignore(tuple((_pattern(rule.lstrip("!").strip("/")), not rule.startswith("!")) for rule in rules))


def _pattern(rule: str) -> re.Pattern[str]:
    pieces = {"**/": "(?:.*/)?", "**": ".*", "*": "[^/]*", "?": "[^/]"}
    return re.compile("".join(pieces.get(piece) or re.escape(piece) for piece in re.split(r"(\*\*/|\*\*|\*|\?)", rule)))
