"""Carrying out a Dockerfile's instructions in a scratch folder, with this machine's Python and Node as base images."""

from __future__ import annotations

import fnmatch
import json
import os
import re
import shlex
import shutil
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

from dockerfile import DockerfileError, Ignore, Instruction, Stage

PASSED_ON = re.compile(
    r"(PIP_|NPM_CONFIG_|SSL_CERT_).*|(ALL|HTTPS?|NO)_PROXY|HOME|REQUESTS_CA_BUNDLE|NODE_EXTRA_CA_CERTS", re.I
)
"""Variables that say where packages come from; nothing else of this machine's environment reaches a RUN."""
SYSTEM_PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"


class BuildError(RuntimeError):
    """A step that failed, or a base image that this machine has nothing for."""


@dataclass
class Image:
    """What a stage leaves behind: its folders, and what it says about the container."""

    root: Path
    """Stands for / of the image."""
    env: dict[str, str] = field(default_factory=dict)
    """As a container gets it, paths mapped below `root`."""
    workdir: str = "/"
    user: int | None = None
    cmd: list[str] = field(default_factory=list)
    health: list[str] = field(default_factory=list)
    port: int = 0


def image_folders(stages: list[Stage]) -> tuple[str, ...]:
    """The folders that the Dockerfile makes, by their absolute paths: what is mapped into the scratch folder."""
    found = set()
    for one in (one for stage in stages for one in stage.instructions):
        if one.word in {"WORKDIR", "VOLUME", "COPY"}:
            path = one.rest.split()[-1]
            found |= {path.rstrip("/")} if path.startswith("/") else set()
    return tuple(sorted(found))


class Builder:
    """Runs stages one after another; every one sees its folders at the same place, as in an engine."""

    def __init__(self, context: Path, ignore: Ignore, scratch: Path, arguments: dict[str, str]) -> None:
        self.context = context
        self.ignore = ignore
        self.root = scratch / "root"
        self.done = scratch / "stages"
        self.arguments = arguments
        self.folders: tuple[str, ...] = ()
        self.names: dict[str, Path] = {}

    def build(self, stages: list[Stage]) -> Image:
        """The image of the last stage. BuildError tells the step that failed and the end of what it wrote."""
        self.folders = image_folders(stages)
        asked = {one.rest.partition("=")[0] for stage in stages for one in stage.instructions if one.word == "ARG"}
        if unknown := set(self.arguments) - asked:
            raise BuildError(
                f"no ARG {', '.join(sorted(unknown))} in the Dockerfile; it has {', '.join(sorted(asked))}"
            )
        for at, stage in enumerate(stages):
            tools, what = base_tools(stage.base)
            print(f"· FROM {stage.base} AS {stage.name}: {what}", flush=True)
            self.root.mkdir(parents=True)
            self.root.chmod(0o755)
            image = Image(self.root, {"PATH": f"{tools}:{SYSTEM_PATH}", "LANG": "C.UTF-8"})
            values: dict[str, str] = {}
            for one in stage.instructions:
                start = time.perf_counter()
                self._carry_out(one, image, values)
                print(f"  {time.perf_counter() - start:6.1f} s  {one}"[:150], flush=True)
            if at < len(stages) - 1:
                self.names[stage.name] = self.done / stage.name
                self.done.mkdir(exist_ok=True)
                self.root.rename(self.names[stage.name])
        return image

    def _carry_out(self, one: Instruction, image: Image, values: dict[str, str]) -> None:
        known = {**values, **image.env}
        match one.word:
            case "ARG":
                name, _, default = one.rest.partition("=")
                values[name] = self.arguments.get(name, default)
            case "ENV":
                for pair in shlex.split(one.rest):
                    name, _, value = pair.partition("=")
                    image.env[name] = ":".join(self._mapped(part) for part in expanded(value, known).split(":"))
            case "WORKDIR" | "VOLUME":
                path = os.path.normpath(os.path.join(image.workdir, one.rest))  # noqa: PTH118
                self._inside(path).mkdir(parents=True, exist_ok=True)
                image.workdir = path if one.word == "WORKDIR" else image.workdir
            case "COPY":
                self._copy(one, image)
            case "RUN":
                self._run(one, image, values)
            case "USER":
                image.user = int(one.rest.partition(":")[0])
            case "EXPOSE":
                image.port = int(one.rest)
            case "CMD":
                image.cmd = exec_form(one, one.rest)
            case "HEALTHCHECK":
                image.health = exec_form(one, one.rest.removeprefix("CMD").strip())

    def _mapped(self, part: str) -> str:
        ours = any(part == folder or part.startswith(folder + "/") for folder in self.folders)
        return str(self.root) + part if ours and not part.startswith(str(self.root)) else part

    def _inside(self, path: str) -> Path:
        return self.root / path.lstrip("/")

    def _copy(self, one: Instruction, image: Image) -> None:
        *sources, target = one.rest.split()
        stage = one.flag("from")
        origin = self.names[stage] if stage else self.context
        place = self._inside(os.path.join(image.workdir, target))  # noqa: PTH118
        into = target.endswith(("/", ".")) or place.is_dir()
        made = [folder for folder in (place, *place.parents) if not folder.exists()]
        for source in sources:
            path = origin / source.strip("/")
            if not path.exists() or (not stage and self.ignore.leaves_out(source.strip("/"))):
                raise BuildError(
                    f"line {one.line}: COPY {source}: {'stage ' + stage if stage else 'the context'} has none"
                )
            if path.is_dir():
                self._copy_folder(path, place, filtered=not stage)
            else:
                goal = place / path.name if into else place
                goal.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(path, goal)
        if (owner := one.flag("chown")) and os.geteuid() == 0:
            for folder in made:
                os.chown(folder, *map(int, owner.split(":")))

    def _copy_folder(self, path: Path, place: Path, *, filtered: bool) -> None:
        """A folder's contents; those of the context as .dockerignore says, those of a stage as hard links."""

        def left_out(folder: str, names: list[str]) -> set[str]:
            here = Path(folder).relative_to(self.context)
            return {name for name in names if self.ignore.leaves_out((here / name).as_posix())}

        shutil.copytree(
            path, place, symlinks=True, dirs_exist_ok=True,
            ignore=left_out if filtered else None,
            copy_function=shutil.copy2 if filtered else os.link,
        )  # fmt: skip

    def _run(self, one: Instruction, image: Image, values: dict[str, str]) -> None:
        for name, value in one.flags:
            if name != "mount" or not value.startswith("type=cache,"):
                raise DockerfileError(f"line {one.line}: RUN --{name}={value} is not known here")
        for folder in self.folders:
            if re.search(rf"(?<![\w./-]){re.escape(folder)}(?![\w-])", one.rest):
                raise DockerfileError(
                    f"line {one.line}: write {folder} relative to WORKDIR, so that it can be elsewhere"
                )
        passed = {name: value for name, value in os.environ.items() if PASSED_ON.fullmatch(name)}
        done = subprocess.run(
            ["/bin/sh", "-ec", one.rest], cwd=self._inside(image.workdir), env={**passed, **values, **image.env},
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            tail = "\n".join(done.stdout.splitlines()[-40:])
            raise BuildError(f"line {one.line}: {one}\nended with {done.returncode}:\n{tail}")


def exec_form(one: Instruction, text: str) -> list[str]:
    """A command as a JSON list: a signal reaches it, and no shell stands between. DockerfileError for another form."""
    try:
        words = json.loads(text)
    except ValueError:
        words = None
    if not isinstance(words, list) or not all(isinstance(word, str) for word in words) or not words:
        raise DockerfileError(f'line {one.line}: {one.word} as a list, ["program", "argument"]')
    return words


def expanded(text: str, known: dict[str, str]) -> str:
    """`$NAME` and `${NAME}` replaced."""
    return re.sub(r"\$(?:(\w+)|\{(\w+)\})", lambda match: known.get(match[1] or match[2], ""), text)


def base_tools(base: str) -> tuple[str, str]:
    """The folder of this machine's Python or Node that stands for a base image, and which one it is.

    Python's version must be the image's; Node's may be another one from 20 on, and that is said.
    """
    image, _, tag = base.partition(":")
    version = tag.partition("-")[0]
    if image == "python":
        for folder in program_folders("python3"):
            found = answer([f"{folder}/python3", "-c", "import ensurepip, sys; print(sys.version.split()[0])"])
            if fnmatch.fnmatch(found, f"{version}.*"):
                return folder, f"python {found} of this machine, {folder}"
        raise BuildError(f"{base}: this machine has no python3 of version {version} with ensurepip")
    if image == "node":
        for folder in program_folders("node"):
            found = answer([f"{folder}/node", "--version"]).lstrip("v")
            if found and int(found.partition(".")[0]) >= 20:
                return folder, f"node {found} of this machine, {folder}"
        raise BuildError(f"{base}: this machine has no Node 20 or newer")
    raise BuildError(f"{base}: only python and node images are known here")


def program_folders(name: str) -> list[str]:
    """Folders with this program: the system's first, which every user may run, then those of PATH, links resolved."""
    places = [*SYSTEM_PATH.split(":"), *os.environ.get("PATH", "").split(":")]
    found = [Path(place, name) for place in places if place]
    links = [
        str(path.resolve().parent) for path in found if path.is_file() and path.resolve().parent.joinpath(name).exists()
    ]
    return list(dict.fromkeys(links))


def answer(command: list[str]) -> str:
    """What a program prints, empty when it cannot."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""
