"""`sims clips build|list|match|sheet`: other people's motion on our body, as a collection in one file.

`sims clips sheet`: contact sheets of a collection's clips, of one caption, or of all that our body can do.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer
from rich.console import Console
from rich.table import Table

from motion_backend.motion import Skill
from planner_service.cli.console import JsonOption, plain_table
from planner_service.output.story_export import OutputError, check_writable, write_files
from planner_service.pipeline import RequestError
from planner_service.user_errors import printable

if TYPE_CHECKING:
    from motion_backend.mocap.dataset_builder import Kept, Unread
    from motion_backend.mocap.dataset_file import Dataset
    from motion_backend.rendering.renderer import Image


MAX_SHOWN: Final = 40
"""Clips of a collection on one sheet."""


def sheet(
    file: Annotated[Path | None, typer.Argument(help="A collection that `sims clips build` wrote.")] = None,
    out: Annotated[Path | None, typer.Option(help="Write the picture here, as PNG.")] = None,
    clip: Annotated[
        list[str] | None, typer.Option(help="A clip's name, as often as wanted; left out: one clip of every skill.")
    ] = None,
    caption: Annotated[str | None, typer.Option(help="Instead of clips: our own body acting this caption.")] = None,
    every: Annotated[
        Path | None, typer.Option("--all", help="Instead of clips: a folder for sheets of all captions we know.")
    ] = None,
    skill: Annotated[Skill | None, typer.Option(help="The caption's skill; with --all, only this one.")] = None,
    room: Annotated[
        str | None, typer.Option(help="A room of the library; left out: the first that has what a caption needs.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Where it begins, and small differences.")] = 0,
) -> None:
    """Draw motion: poses over time from two sides, where feet stood, and the way from above."""
    from motion_backend.rendering.motion_figures import save_png

    if sum(one is not None for one in (file, caption, every)) != 1:
        raise RequestError("give one of FILE, --caption and --all; it says what to draw", at="sheet")
    if every is not None:
        _draw_all(every, skill, room, seed)
        return
    if out is None:
        raise RequestError("say where the picture goes, such as --out sheet.png", at="--out")
    check_writable(out.parent, [out.name])
    picture = _of_clips(file, clip) if file is not None else _of_caption(str(caption), skill, room, seed)
    write_files(out.parent, {out.name: lambda path: save_png(picture, path)})
    Console(markup=False, highlight=False).print(f"drawn in {out}", soft_wrap=True)


def _of_clips(file: Path, names: list[str] | None) -> Image:
    from motion_backend.mocap.clip import ClipError
    from motion_backend.mocap.dataset_file import read_dataset
    from motion_backend.rendering.contact_sheet import sheet as drawn

    dataset = read_dataset(file)
    chosen = [dataset.named(name) for name in names] if names else dataset.of_every_skill()
    if len(chosen) > MAX_SHOWN:
        raise ClipError(f"--clip: a sheet shows at most {MAX_SHOWN} clips, these are {len(chosen)}", "name fewer")
    return drawn([(printable(f"{entry.name}: {entry.captions[0]}"), entry.motion) for entry in chosen])


def _of_caption(caption: str, skill: Skill | None, room: str | None, seed: int) -> Image:
    from planner_service.output.caption_sheets import caption_sheet

    return caption_sheet(caption, skill, room, seed)


def _draw_all(folder: Path, skill: Skill | None, room: str | None, seed: int) -> None:
    from motion_backend.rendering.motion_figures import save_png
    from planner_service.output.caption_sheets import vocabulary_sheets

    console = Console(markup=False, highlight=False)
    check_writable(folder, ())
    for name, picture in vocabulary_sheets([skill] if skill else list(Skill), room, seed):

        def write(path: Path, picture: Image = picture) -> None:
            save_png(picture, path)

        write_files(folder, {name: write})
        console.print(f"{folder / name}", soft_wrap=True)


MAX_LINE_LENGTH = 300

app = typer.Typer(no_args_is_help=True, help="Recorded and keyed motion, retargeted to our body.")
app.command()(sheet)


@app.command()
def build(
    folder: Annotated[
        Path, typer.Argument(help="Folder of motion files: BVH, AMC, GLB, NPZ … and what lies below it.")
    ],
    out: Annotated[Path, typer.Option(help="Write the collection here; beside it FILE.report.json.")],
    mirror: Annotated[bool, typer.Option("--mirror", help="Add every clip as seen in a mirror.")] = False,
    reverse: Annotated[
        bool, typer.Option("--reverse", help="Add getting and standing up played backwards, labelled so.")
    ] = False,
    speeds: Annotated[str, typer.Option(help="Add every clip at these speeds too, such as 0.85,1.15.")] = "",
    joint_map: Annotated[
        Path | None, typer.Option("--map", help="JSON: our joint names to those of your files.")
    ] = None,
    labels: Annotated[
        Path | None, typer.Option(help="CSV with file, skill, style, caption, subject …; left out: manifest.csv there.")
    ] = None,
    kinds: Annotated[
        str, typer.Option(help='Only clips of these kinds of the table, such as "real mocap,hand-keyed".')
    ] = "",
) -> None:
    """Read a folder of motion, retarget it and keep what is true to its source. Exit code 1 if a file was not read."""
    from motion_backend.mocap.dataset_builder import Kept, collect, folder_labels, read_folder
    from motion_backend.mocap.dataset_file import dataset_bytes
    from motion_backend.mocap.joint_map import read_map
    from motion_backend.mocap.near_duplicates import near_copies

    wanted = {kind.strip() for kind in kinds.split(",") if kind.strip()}
    rates = _speeds(speeds)
    joints = None if joint_map is None else read_map(joint_map)
    report = out.parent / f"{out.name}.report.json"
    check_writable(out.parent, [out.name, report.name])
    _check_no_source(folder, out)
    table = folder_labels(folder, labels)
    found = [one for one in read_folder(folder, table, joints, but=(out, report)) if _wanted(one, wanted)]
    kept = [one for one in found if isinstance(one, Kept)]
    console = Console(markup=False, highlight=False)
    console.print(_report(kept))
    lost = [one for one in found if not isinstance(one, Kept)]
    for unread in lost:
        why = unread.why if unread.why.startswith(unread.name) else f"{unread.name}: {unread.why}"
        console.print(f"not read: {printable(why, MAX_LINE_LENGTH)}", soft_wrap=True)
    for clip in kept:
        if not clip.report.accepted:
            why = f"{clip.entry.name}: {'; '.join(clip.report.refused)}"
            console.print(f"refused: {printable(why, MAX_LINE_LENGTH)}", soft_wrap=True)
    accepted = [one.entry for one in kept if one.report.accepted]
    copies = near_copies(accepted)
    for copy in copies:
        alike = f"{copy.clip} is nearly in {copy.of} ({copy.degrees:.1f}°)"
        console.print(f"kept on one side of the split: {printable(alike, MAX_LINE_LENGTH)}", soft_wrap=True)
    dataset = collect(accepted, mirror, reverse, rates, copies)
    told = {
        "clips": [one.report.to_dict() for one in kept],
        "near_copies": [asdict(copy) for copy in copies],
        "not_read": [asdict(unread) for unread in lost],
    }
    content = dataset_bytes(dataset)
    write_files(
        out.parent,
        {
            out.name: lambda path: path.write_bytes(content),
            report.name: lambda path: path.write_text(
                json.dumps(told, indent=1, ensure_ascii=False, allow_nan=False) + "\n",
                encoding="utf-8",
                errors="backslashreplace",
            ),
        },
    )
    console.print(
        f"{len(accepted)} of {len(kept)} clips accepted; {len(dataset.entries)} clips, {dataset.frames} frames, "
        f"{len(content) / 1e6:.1f} MB in {out}",
        soft_wrap=True,
    )
    if lost:
        raise typer.Exit(1)


@app.command()
def match(
    file: Annotated[Path, typer.Argument(help="A collection that `sims clips build` wrote, with recorded walks.")],
    out: Annotated[Path, typer.Option(help="Write the walks here, as a collection.")],
    hours: Annotated[float, typer.Option(min=0.001, max=40.0, help="How much walking.")] = 1.0,
    rooms: Annotated[
        int, typer.Option(min=0, max=400, help="Rooms of the library that half of it leads through; 0 for none.")
    ] = 40,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same walks.")] = 0,
    everybody: Annotated[
        bool, typer.Option("--everybody", help="From everybody's walks, not only from those meant for training.")
    ] = False,
) -> None:
    """Put recorded walks together to hours of walking any way, by motion matching: what a learned walk is taught by."""
    import numpy as np

    from motion_backend.matching.matched_walks import matched_walks
    from motion_backend.matching.walk_database import build_walk_database
    from motion_backend.mocap.dataset_file import dataset_bytes, read_dataset
    from scene_graphs.home import home_from_layouts
    from scene_graphs.layout_library import built_in_index

    check_writable(out.parent, [out.name])
    database = build_walk_database(read_dataset(file), None if everybody else "train")
    layouts = built_in_index().layouts
    drawn = np.random.default_rng(seed).permutation(len(layouts))[:rooms]
    homes = [home_from_layouts([built_in_index().layout(layouts[index].id)], 0) for index in drawn]
    dataset = matched_walks(database, hours, seed, homes)
    content = dataset_bytes(dataset)
    write_files(out.parent, {out.name: lambda path: path.write_bytes(content)})
    Console(markup=False, highlight=False).print(
        f"{len(dataset.entries)} walks, {dataset.frames / 30 / 60:.1f} minutes, put together from "
        f"{len(database.clips)} recorded ones of {len(database.people)} people, {len(content) / 1e6:.1f} MB in {out}",
        soft_wrap=True,
    )


@app.command("list")
def list_clips(
    file: Annotated[Path, typer.Argument(help="A collection that `sims clips build` wrote.")],
    as_json: JsonOption = False,
) -> None:
    """Say what is in a collection."""
    from motion_backend.mocap.dataset_file import read_dataset

    dataset = read_dataset(file)
    console = Console(markup=False, highlight=False)
    if as_json:
        rows = [
            {name: value for name, value in vars(entry).items() if name not in ("motion", "hands")}
            | {"frames": len(entry.motion), "seconds": round(entry.motion.duration, 3)}
            for entry in dataset.entries
        ]
        console.print_json(json.dumps({"frames": dataset.frames, "clips": rows}), ensure_ascii=True)
        return
    console.print(_contents(dataset))
    console.print(f"{len(dataset.entries)} clips, {dataset.frames} frames, {dataset.frames / 30:.0f} s")


def _speeds(listed: str) -> tuple[float, ...]:
    """Speeds, each once, seen to be possible before any work is done."""
    from motion_backend.mocap.augmentation import SPEEDS
    from motion_backend.mocap.clip import ClipError

    try:
        found = {f"{float(word):g}": float(word) for word in listed.split(",") if word.strip()}
    except ValueError as error:
        raise ClipError(f"--speeds: {listed!r:.40} is no list of numbers such as 0.85,1.15") from error
    wrong = next((speed for speed in found.values() if not SPEEDS[0] <= speed <= SPEEDS[1]), None)
    if wrong is not None:
        raise ClipError(f"--speeds: a motion is played {SPEEDS[0]} to {SPEEDS[1]} times as fast, not {wrong:g}")
    return tuple(found.values())


def _check_no_source(folder: Path, out: Path) -> None:
    """An earlier collection may be replaced where it lies, recorded motion must not."""
    from motion_backend.mocap.dataset_file import is_dataset

    inside = out.is_file() and folder.resolve() in out.resolve().parents
    if inside and not is_dataset(out):
        raise OutputError(
            f"{out} lies among the files to be read and is no collection", "choose another name", at="--out"
        )


def _wanted(one: Kept | Unread, kinds: set[str]) -> bool:
    from motion_backend.mocap.dataset_builder import Kept

    return not (kinds and isinstance(one, Kept)) or one.entry.kind in kinds


def _report(kept: list[Kept]) -> Table:
    numbers = ("frames", "skate cm/s", "source's", "in floor mm", "source's ", "limbs °", "most °", "limits %")
    table = plain_table("clip", "skill", *numbers, "used", right=numbers)
    for one in kept:
        figures = one.report
        table.add_row(
            printable(one.entry.name),
            printable(one.entry.skill),
            str(figures.frames),
            f"{figures.skate:.1f}",
            _figure(figures.source_skate),
            f"{1000 * figures.depth:.1f}",
            _figure(figures.source_depth, 1000),
            f"{figures.limb_mean:.1f}",
            f"{figures.limb_max:.0f}",
            f"{100 * figures.beyond_limits:.0f}",
            "yes" if figures.accepted else "no",
        )
    return table


def _figure(value: float | None, times: float = 1) -> str:
    """A figure, or a dash where there is none: a toy's feet say nothing of ours."""
    return "–" if value is None else f"{times * value:.1f}"


def _contents(dataset: Dataset) -> Table:
    table = plain_table(
        "clip", "skill", "emotion", "style", "subject", "split", "seconds", "caption", right=("seconds",)
    )
    for entry in dataset.entries:
        seconds = f"{entry.motion.duration:.1f}"
        words = (entry.name, entry.skill, entry.emotion, entry.style, entry.subject, entry.split)
        table.add_row(*map(printable, words), seconds, printable(entry.captions[0]))
    return table
