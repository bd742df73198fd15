"""`sims evaluate body`: every caption acted in rooms of the library, judged, and told from the others."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from motion_backend.motion import Skill
from planner_service.cli.console import JsonOption, plain_table, progress
from planner_service.cli.evaluate_stories import bounds, print_stories, read_stories, shown, stories_to_dict
from planner_service.pipeline import RequestError
from planner_service.scripts.captions import captions as known_captions

if TYPE_CHECKING:
    from planner_service.evaluation.body_evaluation import Figure, Result
    from planner_service.evaluation.caption_classifier import Telling
    from planner_service.evaluation.story_evaluation import StoryTrial
    from planner_service.evaluation.trials import Performance

UNITS = {
    "caption_kept": "%", "reached": "%", "reached_any": "%", "reached_strict": "%", "contact_error": "cm",
    "contact_mean": "cm", "execution_time": "s", "skate_ratio": "%", "skate": "cm/s", "slip": "cm/s",
    "pen_mean": "cm", "pen_share": "%", "pen_max": "cm", "skin_pen_share": "%", "skin_pen_max": "cm",
    "floor_pen": "cm", "floating": "cm", "self_pen_share": "%", "self_pen_max": "cm", "limits_share": "%",
    "joint_speed": "rad/s", "frozen_share": "%", "zmp_upright": "cm", "zmp_rising": "cm", "jerk": "m/s³",
    "jerk_peak": "m/s³", "jerk_against_real": "×", "seam_jump": "cm", "seam_speed_jump": "m/s",
    "bone_deviation": "cm",
}  # fmt: skip
"""Of the figures that are shown, in this order."""
WORST = (
    "contact_error", "contact_mean", "pen_max", "pen_share", "skin_pen_max", "skate_ratio", "self_pen_max",
    "limits_share", "joint_speed", "frozen_share", "zmp_upright", "zmp_rising", "seam_speed_jump",
)  # fmt: skip
"""Of what the worst trials are named."""
MAX_WORST = 4
MAX_CAPTION_LENGTH = 200
MAX_DIGITS = 6
FILMED = ("film.glb", "storyboard.png")
"""Files of one trial."""
PAPER_APD = {"sitdown": "1.14 (UniHSI), 16.55 (SIMS)", "liedown": "1.35 (UniHSI), 16.36 (SIMS)"}
"""SIMS Table 3. Its features are not told: only orders of size can be compared."""


def body(
    captions: Annotated[
        str | None, typer.Option(help="How many captions of each skill, or all; left out with --stories: none.")
    ] = None,
    rooms: Annotated[int, typer.Option(min=1, max=100, help="Rooms for each caption; 20 for the whole.")] = 4,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Seeds in each room; 5 for the whole.")] = 1,
    skill: Annotated[list[Skill] | None, typer.Option(help="Only this skill; may be given again.")] = None,
    only: Annotated[str | None, typer.Option(help="Only this caption; with --room, one trial.")] = None,
    room: Annotated[str | None, typer.Option(help="With --only: the id of a room of the library.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="With --only and --room: the seed.")] = 0,
    stories: Annotated[
        str | None, typer.Option(help="Whole stories: how many on themes of ours, or a file with a theme a line.")
    ] = None,
    workers: Annotated[int, typer.Option(min=1, max=64, help="Processes at once.")] = 2,
    as_json: JsonOption = False,
    out: Annotated[Path | None, typer.Option(help="Folder for all figures, or for one trial's film.")] = None,
) -> None:
    """Act captions in library rooms, from a random place 1 to 5 m away, and print every figure beside its limit.

    It also says how well captions are told apart by a nearest neighbour, and how varied sitting and lying are. The
    whole is --rooms 20 --seeds 5. With --stories, themes are told and acted as `sims story` does, and judged as wholes:
    how they flow, stand about and turn. Exit code 1 when a limit is missed.
    """
    from planner_service.output.story_export import check_writable, write_files

    console = Console(markup=False, highlight=False)
    chosen = _chosen(captions or "all", skill, only) if captions or only or skill or not stories else {}
    if room is not None:
        _one_trial(console, chosen, room, seed, as_json, out)
        return
    told = read_stories(stories, seeds) if stories else []
    if out is not None:
        check_writable(out, ("body.json", "trials.jsonl", "stories.jsonl"))
    parts: list[_Evaluated] = []
    if chosen:
        parts.append(_over_trials(chosen, rooms, seeds, workers))
    if told:
        parts.append(_over_stories(told, workers))
    value: dict[str, Any] = {"physics_mode": "none"}
    for part in parts:
        value |= part.value
    if out is not None:
        text = json.dumps(value, indent=2, ensure_ascii=False) + "\n"
        files = {part.file: "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in part.rows) for part in parts}
        write_files(out, {name: _writer(written) for name, written in (files | {"body.json": text}).items()})
    if as_json:
        console.print_json(json.dumps(value))
    else:
        for part in parts:
            part.show(console)
    if any(part.missed for part in parts):
        raise typer.Exit(1)


@dataclass(frozen=True)
class _Evaluated:
    """Trials or stories, measured."""

    value: Mapping[str, Any]
    """For JSON."""
    rows: Sequence[Mapping[str, Any]]
    """One a trial or story, for the file."""
    file: str
    show: Callable[[Console], None]
    missed: bool
    """Whether a limit is."""


def _writer(text: str) -> Callable[[Path], object]:
    return lambda path: path.write_text(text, encoding="utf-8")


def _over_trials(chosen: Mapping[Skill, list[str]], rooms: int, seeds: int, workers: int) -> _Evaluated:
    """Captions acted in library rooms, figure by figure and skill by skill."""
    from planner_service.evaluation.body_evaluation import plan_trials, run_trials, sum_up
    from planner_service.evaluation.caption_classifier import tell_apart
    from planner_service.evaluation.diversity import diversity

    trials = plan_trials(chosen, rooms, seeds)
    with progress("acting") as seen:
        results = run_trials(trials, workers, seen)
    figures = sum_up(results, tuple(UNITS))
    told = tell_apart([(one.trial, one.features) for one in results if one.features is not None])
    apd = {
        of.value: diversity([one.contact for one in results if one.trial.skill is of and one.contact is not None])
        for of in (Skill.SITDOWN, Skill.LIEDOWN)
    }
    value = {
        "trials": len(trials), "rooms": rooms, "seeds": seeds,
        "figures": [_figure_to_dict(figure) for figure in figures], "telling_apart": [asdict(one) for one in told],
        "diversity": apd, "worst": _worst(results), "by_caption": _by_caption(results),
        "not_begun": [_unbegun(one) for one in results if one.fault],
    }  # fmt: skip

    def show(console: Console) -> None:
        _print(console, figures, told, value)
        if rooms < 20 or seeds < 5:
            console.print("\na sample; the whole is --rooms 20 --seeds 5")

    rows = [dict(one.figures) for one in results if one.figures]
    missed = any(figure.missed for figure in figures) or any(telling.missed for telling in told)
    return _Evaluated(value, rows, "trials.jsonl", show, missed)


def _over_stories(trials: Sequence[StoryTrial], workers: int) -> _Evaluated:
    """Stories told and acted, figure by figure over all of them."""
    from planner_service.evaluation.story_evaluation import run_stories, sum_up_stories

    with progress("telling") as seen:
        results = run_stories(trials, workers, seen)
    figures = sum_up_stories(results)
    value = stories_to_dict(results, figures)
    rows = [{"theme": one.trial.theme, "seed": one.trial.seed, **one.report} for one in results if one.report]
    return _Evaluated(
        {"over_stories": value},
        rows,
        "stories.jsonl",
        lambda console: print_stories(console, figures, value, UNITS),
        any(figure.missed for figure in figures) or not any(one.report for one in results),
    )


def _chosen(captions: str, skills: Sequence[Skill] | None, only: str | None) -> Mapping[Skill, list[str]]:
    """The captions to be acted, by skill."""
    known = {Skill(name): some for name, some in known_captions().items() if not skills or Skill(name) in skills}
    if only is not None and not (0 < len(only) <= MAX_CAPTION_LENGTH and only.isprintable()):
        raise RequestError(f"a caption is 1 to {MAX_CAPTION_LENGTH} printable letters, got {only!r:.80}", at="--only")
    if only is not None:
        found = {skill: [only] for skill, some in known.items() if only in some}
        if not found and skills:
            return {skill: [only] for skill in skills}
        if not found:
            raise RequestError(
                f"no caption is called {only!r:.120}", "for words of your own give --skill too", at="--only"
            )
        return found
    if captions == "all":
        return known
    if not captions.isdecimal() or len(captions) > MAX_DIGITS or int(captions) < 1:
        raise RequestError(f"{captions!r:.40} must be a number from 1 on, or all", at="--captions")
    # Spread over the list, which is in the order of the alphabet.
    return {skill: some[:: max(len(some) // int(captions), 1)][: int(captions)] for skill, some in known.items()}


def _one_trial(
    console: Console, chosen: Mapping[Skill, list[str]], room: str, seed: int, as_json: bool, out: Path | None
) -> None:
    """Every figure of one trial, and its film and storyboard."""
    from planner_service.evaluation.trials import Trial, perform
    from planner_service.output.story_export import check_writable
    from scene_graphs.layout_library import built_in_index

    pairs = [(skill, caption) for skill, some in chosen.items() for caption in some]
    if len(pairs) != 1:
        raise RequestError(
            "one trial needs --only with one caption", "give --skill where several skills have it", at="--room"
        )
    if all(room != layout.id for layout in built_in_index().layouts):
        raise RequestError(f"the library has no room {room!r:.80}", "sims layouts list names them", at="--room")
    if out is not None:
        check_writable(out, FILMED)
    done = perform(Trial(*pairs[0], room, seed))
    told = done.to_dict()
    if as_json:
        console.print_json(json.dumps(told))
    else:
        table = plain_table("figure", "value", right=("value",))
        for name, value in told.items():
            words = "; ".join(value) if isinstance(value, list) else value
            unit, plain = UNITS.get(name, ""), "–" if words in (None, "") else str(words)
            table.add_row(name, f"{shown(value, unit)} {unit}" if isinstance(value, float) else plain)
        console.print(table)
    if out is not None:
        _write_trial(done, out)


def _write_trial(done: Performance, out: Path) -> None:
    from motion_backend.formats.glb_film import film_glb
    from motion_backend.motion import join
    from planner_service.output.story_export import write_files
    from planner_service.output.storyboard import storyboard

    whole = join(list(done.motions))
    known = {placed.id for placed in done.home.objects}
    targets = [action.object_id if action.object_id in known else None for action in done.actions]
    write_files(
        out,
        {
            FILMED[0]: lambda path: path.write_bytes(film_glb(done.home, whole, done.role)),
            FILMED[1]: lambda path: storyboard(
                done.home, whole, done.keyframes, path, done.trial.caption, targets, done.role
            ),
        },
    )


def _print(console: Console, figures: Sequence[Figure], told: Sequence[Telling], value: Mapping[str, Any]) -> None:
    from planner_service.evaluation.caption_classifier import APART

    console.print(_table(figures))
    console.print(f"{value['trials']} trials, {value['rooms']} rooms, seeds {value['seeds']}; kinematic; ± is 95 %")
    console.print(f"\ntold apart by a nearest neighbour in other rooms, limit ≥ {APART:.0%}")
    for one in told:
        mark = " !" if one.missed else ""
        console.print(f"{one.skill:9} {one.accuracy:6.1%}{mark} of {one.trials} trials, {one.groups} captions")
        for confusion in one.confusions[:8]:
            part = f"{confusion.times} of {confusion.of}"
            console.print(f"          {part:>9}  {confusion.caption}  →  {confusion.taken_for}", soft_wrap=True)
    if any(value["diversity"].values()):
        console.print("\nhow varied, from the start of the contact for 2 s")
    for skill, apd in value["diversity"].items():
        if apd is not None:
            console.print(
                f"{skill:9} apd_pos {apd['apd_pos']:.2f} ± {apd['apd_pos_spread']:.2f}, "
                f"apd_pos_frame {apd['apd_pos_frame']:.3f} m, n {apd['samples']:.0f}; the paper: {PAPER_APD[skill]}"
            )
    console.print("\nworst trials; sims evaluate body --only CAPTION --room ID --seed S --out DIR shows one")
    for row in value["worst"]:
        unit = UNITS[row["figure"]]
        told_as = f"{shown(row['value'], unit)} {unit}"
        where = " · ".join(str(row[key]) for key in ("caption", "room", "seed", "object", "detail") if row[key] != "")
        console.print(f"{row['figure']:15} {told_as:>9}  {where}", soft_wrap=True)
    for row in value["not_begun"][:10]:
        console.print(f"not begun: {row['caption']} · {row['room']}: {row['why']}", soft_wrap=True)


def _table(figures: Sequence[Figure]) -> Table:
    skills = list(dict.fromkeys(figure.skill for figure in figures))
    table = plain_table("figure", *skills, "limit", right=(*skills, "limit"))
    for name in dict.fromkeys(figure.name for figure in figures):
        row = {figure.skill: figure for figure in figures if figure.name == name}
        limits = dict.fromkeys(
            bounds(figure.limit, UNITS[figure.name]) for figure in row.values() if figure.limit is not None
        )
        cells = [_cell(row[skill]) if skill in row else "" for skill in skills]
        table.add_row(f"{name}, {UNITS[name]}", *cells, " ".join(limits))
    return table


def _cell(figure: Figure) -> str:
    unit = UNITS[figure.name]
    spread = (figure.high - figure.low) / 2
    around = f" ±{shown(spread, unit)}" if spread > 0 else ""
    return f"{shown(figure.value, unit)}{around}{' !' if figure.missed else ''}"


def _figure_to_dict(figure: Figure) -> dict[str, Any]:
    return {
        "name": figure.name, "skill": figure.skill, "value": round(figure.value, 5), "low": round(figure.low, 5),
        "high": round(figure.high, 5), "trials": figure.trials, "missed": figure.missed,
    }  # fmt: skip


def _unbegun(result: Result) -> dict[str, Any]:
    trial = result.trial
    return {"caption": trial.caption, "room": trial.room, "seed": trial.seed, "why": result.fault}


def _worst(results: Sequence[Result]) -> list[dict[str, Any]]:
    """The worst trials of some figures, each of another caption at another piece, and some that were not reached."""
    begun = [one.figures for one in results if one.figures]
    rows = []
    for name in WORST:
        seen: set[object] = set()
        for one in sorted((one for one in begun if one[name]), key=lambda one: -one[name]):
            own = {one["caption"], (one["room"], one["object"])}
            if seen.isdisjoint(own) and len(seen) < 2 * MAX_WORST:
                rows.append(_as_row(name, one))
                seen |= own
    return rows + [_as_row("reached", one) for one in begun if not one["reached"]][: 5 * MAX_WORST]


def _as_row(name: str, one: Mapping[str, Any]) -> dict[str, Any]:
    """One figure of one trial, and what is needed to act it again."""
    keys = ("skill", "caption", "room", "seed", "object", "reason")
    detail = {"limits_share": one["limits_joint"], "self_pen_max": one["self_pen_pair"]}.get(name, "")
    return {"figure": name, "value": float(one[name]), "detail": detail, **{key: one[key] for key in keys}}


def _by_caption(results: Sequence[Result]) -> list[dict[str, Any]]:
    """The mean of every figure of each caption (the largest, where it is one)."""
    from planner_service.evaluation.body_evaluation import WORST_OF_TRIALS

    rows = []
    for skill, caption in dict.fromkeys((one.trial.skill, one.trial.caption) for one in results):
        own = [
            one.figures for one in results if (one.trial.skill, one.trial.caption) == (skill, caption) and one.figures
        ]
        row: dict[str, Any] = {"skill": skill.value, "caption": caption, "trials": len(own)}
        for name in UNITS:
            values = [float(one[name]) for one in own if one[name] is not None]
            found = (max(values) if name in WORST_OF_TRIALS else sum(values) / len(values)) if values else None
            row[name] = None if found is None else round(found, 5)
        rows.append(row)
    return rows
