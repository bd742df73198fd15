"""Theme to long script and story with the shipped library and with 100,000 scripts, and the encoder's own speed."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from benchmarks.figure import Figure
from benchmarks.themes import SEED, THEMES
from motion_backend.language.sentence_encoder import SentenceEncoder, Vectors, load_encoder
from motion_backend.motion import Character
from planner_service.composition.compose import compose
from planner_service.composition.request import Request
from planner_service.narration.narrator import narrate
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_embeddings import ByHeart
from planner_service.scripts.script_library import Features, ScriptLibrary

MANY = 100_000
SMALL_MS, LARGE_MS, SENTENCES = 150.0, 300.0, 100.0
REPEATS = 3
_MARK = " ~"


class Varied:
    """The encoder inside; a text that is marked as a variation is near its original, by a draw from its number.

    So that 100,000 scripts need not be encoded, which takes a quarter of an hour.
    """

    def __init__(self, inner: SentenceEncoder) -> None:
        self.inner = inner
        self.name = inner.name

    def encode(self, texts: Sequence[str]) -> Vectors:
        """One unit row a text. (N, D) float32."""
        parts = [text.partition(_MARK) for text in texts]
        originals = {text: place for place, text in enumerate(dict.fromkeys(part[0] for part in parts))}
        rows = self.inner.encode(list(originals))[[originals[part[0]] for part in parts]]
        varied = np.array([bool(part[2]) for part in parts])
        draw = np.random.default_rng(len(texts)).standard_normal(rows.shape, dtype=np.float32)
        rows = rows + np.where(varied[:, None], 0.6 * draw / np.sqrt(rows.shape[1]), 0.0)
        return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True), dtype=np.float32)


def many_scripts(count: int) -> list[ShortScript]:
    """So many scripts: ours, and variations of their summaries and of the order of their furniture."""
    ours = built_in()
    scripts = list(ours)
    for number in range(count - len(ours)):
        script = ours[number % len(ours)]
        turned = script.keyframes[number % len(script.keyframes) :] + script.keyframes[: number % len(script.keyframes)]
        scripts.append(
            script.model_copy(
                update={
                    "id": f"{script.id[:60]}-{number}",
                    "summary": f"{script.summary.rstrip('.!?')}{_MARK}{number}.",
                    "keyframes": turned,
                }
            )
        )
    return scripts


def weaving_figures() -> list[Figure]:
    """Planning at both sizes against their limits, and sentences a second."""
    encoder = load_encoder()
    figures = [_encoding(encoder)]
    known = ByHeart(encoder)
    for scripts, limit in ((list(built_in()), SMALL_MS), (many_scripts(MANY), LARGE_MS)):
        started = time.perf_counter()
        library = ScriptLibrary(scripts, Features(Varied(known)))
        _weave(library)  # all that a server would have warm
        opened = time.perf_counter() - started
        times = 1000 * np.array([seconds for _ in range(REPEATS) for seconds in _weave(library)])
        name = f"theme to script and story, {len(scripts):,} scripts"
        note = f"p90 {np.quantile(times, 0.9):.0f} ms; library opened in {opened:.0f} s"
        if len(scripts) == MANY:
            note += ", variations of ours"
        figures.append(Figure(name, float(np.median(times)), "ms", limit, note=note, digits=0))
    return figures


def _weave(library: ScriptLibrary) -> list[float]:
    """Seconds of each of the seven themes."""
    times = []
    for theme in THEMES.values():
        started = time.perf_counter()
        narrate(compose(theme, library, Request(seed=SEED)), Character(), SEED)
        times.append(time.perf_counter() - started)
    return times


def _encoding(encoder: SentenceEncoder) -> Figure:
    texts = [script.summary for script in built_in()]
    encoder.encode(texts[:8])
    started = time.perf_counter()
    encoder.encode(texts)
    speed = len(texts) / (time.perf_counter() - started)
    return Figure("sentences encoded on one core", speed, "/s", SENTENCES, "least", f"{len(texts)} summaries", 0)
