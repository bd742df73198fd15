"""What is shipped: wheel and source archive hold what they should, image and compose file name what there is."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml
from for_each import for_each

from planner_service.settings import Settings

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("prompts", "scene_graphs", "motion_backend", "planner_service")
LEFT_OUT = shutil.ignore_patterns(
    ".*cache", ".venv", ".git", ".hypothesis", ".env", "node_modules", "__pycache__", "out", "dist"
)
SETTINGS = {f"SIMS_{name.upper()}" for name in Settings.model_fields}
MAX_MEGABYTES = 21
"""Of a wheel: code, scripts, rooms, the page and our own small weights; nobody else's data."""

sys.path.insert(0, str(ROOT / "docker"))
from building import image_folders  # noqa: E402
from dockerfile import DockerfileError, read_dockerfile, read_dockerignore  # noqa: E402


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The project as it is built from, with a page in it whether Node is here or not."""
    folder = tmp_path_factory.mktemp("packaging") / "sims"
    shutil.copytree(ROOT, folder, ignore=LEFT_OUT)
    page = folder / "planner_service" / "page"
    (page / "assets").mkdir(parents=True, exist_ok=True)
    if not (page / "index.html").exists():
        (page / "index.html").write_text("<!doctype html>")
        (page / "assets" / "index.js").write_text("")
    return folder


@pytest.fixture(scope="module")
def archives(tree: Path) -> tuple[Path, Path]:
    """A source archive, and the wheel that is built from it."""
    hatch(tree, "sdist")
    (archive,) = (tree / "dist").glob("*.tar.gz")
    with tarfile.open(archive) as opened:
        opened.extractall(tree / "unpacked", filter="data")
    (source,) = (tree / "unpacked").iterdir()
    hatch(source, "wheel")
    (wheel,) = (source / "dist").glob("*.whl")
    return archive, wheel


def hatch(folder: Path, target: str) -> None:
    command = [sys.executable, "-m", "hatchling", "build", "-t", target, "-d", "dist"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def files_below(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.service
def test_a_wheel_holds_the_packages_with_their_data_and_the_page_and_nothing_else(
    tree: Path, archives: tuple[Path, Path]
) -> None:
    with zipfile.ZipFile(archives[1]) as opened:
        names = {name for name in opened.namelist() if ".dist-info/" not in name}
    wanted = {f"{package}/{name}" for package in PACKAGES for name in files_below(tree / package)}
    assert names == wanted
    assert {"planner_service/page/index.html", "planner_service/data/short_scripts.jsonl"} < names


@pytest.mark.service
def test_a_wheel_is_small(archives: tuple[Path, Path]) -> None:
    assert archives[1].stat().st_size <= MAX_MEGABYTES * 1_000_000


@pytest.mark.service
def test_the_licence_and_the_command_come_with_the_wheel(archives: tuple[Path, Path]) -> None:
    with zipfile.ZipFile(archives[1]) as opened:
        (entry,) = [name for name in opened.namelist() if name.endswith("entry_points.txt")]
        assert "sims = planner_service.cli:main" in opened.read(entry).decode()
        assert [name for name in opened.namelist() if name.endswith("licenses/LICENSE")]


@pytest.mark.service
def test_the_source_archive_can_make_test_and_image(archives: tuple[Path, Path]) -> None:
    with tarfile.open(archives[0]) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    needed = {
        "Makefile",
        "Dockerfile",
        ".dockerignore",
        "compose.yaml",
        "docker/run_steps.py",
        "requirements-encoder.txt",
    }
    assert needed | {"web/package-lock.json", "tests/test_packaging.py", "docs/running.md"} <= names
    assert not [name for name in names if "node_modules" in name or name == ".env"]


def test_the_dockerfile_copies_only_what_exists_and_is_sent() -> None:
    ignore = read_dockerignore(ROOT / ".dockerignore")
    stages = read_dockerfile((ROOT / "Dockerfile").read_text(encoding="utf-8"))
    copied = [one for stage in stages for one in stage.instructions if one.word == "COPY" and not one.flag("from")]
    sources = [source for one in copied for source in one.rest.split()[:-1]]
    assert sources
    assert not [source for source in sources if not (ROOT / source).exists() or ignore.leaves_out(source)]
    for secret in (
        ".env",
        "web/.env",
        ".git/config",
        "web/node_modules/vite/package.json",
        "planner_service/page/index.html",
    ):
        assert ignore.leaves_out(secret), secret


def test_the_image_runs_as_nobody_special_keeps_its_data_and_can_be_stopped() -> None:
    last = read_dockerfile((ROOT / "Dockerfile").read_text(encoding="utf-8"))[-1]
    said = {one.word: one.rest for one in last.instructions}
    assert said["USER"].split(":")[0].isdecimal()
    assert int(said["USER"].split(":")[0]) >= 1000
    assert said["CMD"] == '["sims", "serve"]'
    assert said["VOLUME"] in image_folders([last])
    assert "/healthz" in said["HEALTHCHECK"]


def test_the_image_has_the_extras_but_those_that_bring_another_licence_or_a_compiler() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    asked = re.search(r"^ARG EXTRAS=(\S+)$", (ROOT / "Dockerfile").read_text(encoding="utf-8"), re.MULTILINE)
    assert asked is not None
    assert extras.keys() - set(asked[1].split(",")) == {"video", "asr", "llamacpp", "dev", "docs"}
    assert set(asked[1].split(",")) <= extras.keys()


@for_each("line", ["ADD x y", "RUN <<EOF", "# syntax=docker/dockerfile:1", "ONBUILD RUN true", "FROM a b c"])
def test_the_steps_are_not_run_where_a_line_is_not_understood(line: str) -> None:
    with pytest.raises(DockerfileError, match="line"):
        read_dockerfile(f"FROM python:3.11-slim\n{line}\n")


def test_image_and_compose_file_set_only_what_is_a_setting() -> None:
    for name in ("Dockerfile", "compose.yaml"):
        text = (ROOT / name).read_text(encoding="utf-8")
        assert set(re.findall(r"SIMS_[A-Z_]+", text)) - {"SIMS_PUBLISHED_PORT"} <= SETTINGS, name


def test_every_setting_is_in_the_docs_and_in_no_other_name() -> None:
    page = (ROOT / "docs" / "running.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^\| `(SIMS_\w+)`", page, re.MULTILINE)) == SETTINGS
    assert set(re.findall(r"SIMS_[A-Z_]+", page)) <= SETTINGS


def test_the_compose_file_has_a_database_a_service_and_workers_with_names_of_their_own() -> None:
    services = yaml.safe_load((ROOT / "compose.yaml").read_text(encoding="utf-8"))["services"]
    workers = [one for one in services.values() if one.get("command") == ["sims", "worker"]]
    assert len({one["environment"]["SIMS_WORKER_ID"] for one in workers}) == len(workers) == 2
    for one in (services["http"], *workers):
        assert one["depends_on"]["postgres"]["condition"] == "service_healthy"
        assert one["environment"]["SIMS_DATABASE_URL"].startswith("postgresql://")
    assert ":?" in services["http"]["environment"]["SIMS_API_KEYS"]
    assert all(port.startswith("127.0.0.1:") for port in services["http"]["ports"])
    assert "ports" not in services["postgres"]
