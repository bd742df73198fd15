"""What a user can do wrong: one family of exceptions, whichever package raises them, each with its facts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar


@dataclass(frozen=True)
class FieldPath:
    """Where in what was given something is wrong, such as `objects[3].size`: `where / "objects" / 3 / "size"`."""

    steps: tuple[str | int, ...] = ()
    """Names of fields and numbers of rows, from the outside in."""
    file: str = ""
    """The file it is in, where that is to be said first."""

    def __truediv__(self, step: str | int) -> FieldPath:
        return replace(self, steps=(*self.steps, step))

    def __bool__(self) -> bool:
        return bool(self.steps or self.file)

    def __str__(self) -> str:
        written = ""
        for step in self.steps:
            written += f"[{step}]" if isinstance(step, int) else f".{step}" if written else step
        return " ".join(part for part in (self.file, written) if part)

    @property
    def pointer(self) -> str:
        """The same as a JSON pointer, `/objects/3/size`."""
        return "".join("/" + str(step).replace("~", "~0").replace("/", "~1") for step in self.steps)


class UserError(ValueError):
    """Something that was given cannot be used: what is wrong with it, what would be right, and where.

    The command line turns it into one line and exit code 2, the service into a problem with a pointer; anything else
    is a fault of ours.
    """

    joint: ClassVar[str] = ": "
    """What stands between the place and the fault."""

    def __init__(self, fault: str, remedy: str = "", *, at: FieldPath | str = "") -> None:
        super().__init__(fault, remedy)
        self.fault, self.remedy = fault, remedy
        self.at = at if isinstance(at, FieldPath) else FieldPath((at,) if at else ())

    @property
    def said(self) -> str:
        """Fault and remedy, for those who say the place in their own way."""
        return f"{self.fault}; {self.remedy}" if self.remedy else self.fault

    @property
    def within(self) -> str:
        """The same without the file, for those who have named that."""
        return self._told(replace(self.at, file=""))

    def __str__(self) -> str:
        return self._told(self.at)

    def _told(self, at: FieldPath) -> str:
        return f"{at}{self.joint}{self.said}" if at else self.said
