"""`sims train beats`: which captions show what a theme tells, from labelled themes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from planner_service.cli.console import plain_table
from planner_service.output.story_export import check_writable
from scene_graphs.errors import UserError


def beats(
    out: Annotated[Path, typer.Option(help="Folder for the weights.")],
    labels: Annotated[
        list[Path] | None, typer.Option(help="Labelled themes to learn from besides ours, one JSON object a line.")
    ] = None,
    start: Annotated[
        Path | None, typer.Option(help="Weights to go on from, as this command writes them; anew without.")
    ] = None,
    epochs: Annotated[int, typer.Option(min=1, max=100, help="Times that every beat is seen.")] = 5,
    seed: Annotated[int, typer.Option(min=0, help="The same seed learns the same.")] = 0,
) -> None:
    """Learn which captions show what is told, and say how often the first is right for themes that are kept back.

    Every fifth labelled theme is kept back for that.
    """
    from motion_backend.language import minilm
    from planner_service.composition.beat_classifier import SHIPPED, BeatClassifier
    from planner_service.composition.beat_trainer import (
        BeatTraining,
        learn,
        rows_of,
        save,
        vocabulary,
    )
    from planner_service.evaluation.beat_recognition import recognised
    from planner_service.evaluation.labels import labelled_themes, read_labels, training_themes

    console = Console(markup=False, highlight=False)
    check_writable(out, (SHIPPED,))
    folder = minilm.weights_folder()
    if folder is None:
        raise UserError("the sentence encoder is not installed, which this learns upon: make demo installs it")
    known = vocabulary()
    learned, kept = training_themes()
    tuned = [theme for theme in labelled_themes() if theme.split == "tune" and not theme.refuse]
    more = [theme for path in labels or () for theme in read_labels(path)]
    rows = rows_of([*learned, *tuned, *more], known)
    console.print(f"{len(rows)} clauses of {len(learned) + len(tuned) + len(more)} themes; {len(kept)} are kept back")

    def tell(epoch: int, loss: float) -> None:
        console.print(f"epoch {epoch + 1} of {epochs}  loss {loss:.3f}")

    net = learn(rows, known, folder, BeatTraining(epochs=epochs, seed=seed), tell, start)
    out.mkdir(parents=True, exist_ok=True)
    save(net, known, out / SHIPPED)
    found = recognised(BeatClassifier(minilm.MiniLM(folder), out / SHIPPED), kept)
    table = plain_table("kept back", "beats", "first caption accepted", "shown or not", "first furniture accepted")
    table.add_row("", str(found.beats), *(f"{share:.1%}" for share in (found.first, found.shown, found.placed)))
    console.print(table)
    console.print(f"weights in {out / SHIPPED}", soft_wrap=True)
