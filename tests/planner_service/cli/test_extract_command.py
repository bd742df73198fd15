"""`sims extract` as it is typed: tables, files, the library, films, and what users do wrong."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from film_made import Drawn, Making, film_of
from stories import GERMAN, NARRATIVE, SUBTITLES
from typer.testing import CliRunner, Result

from planner_service.cli import app
from planner_service.cli.scripts import read_scripts
from planner_service.extraction.subtitles import SubtitleError
from planner_service.extraction.text_files import ExtractionError
from planner_service.extraction.video_container import FilmError
from planner_service.library.library import open_shelves
from planner_service.pipeline import RequestError
from planner_service.scripts.script_repair import check
from planner_service.settings import read_settings

CUES = ((0.5, 1.5, "She storms through the room."), (1.6, 2.8, "She sits down on the sofa, furious."))


@pytest.fixture(autouse=True)
def own_library(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A library of this test's own, and the encoder that needs no weights."""
    monkeypatch.setenv("SIMS_DATA_DIR", str(tmp_path / "data"))
    monkeypatch.setattr("motion_backend.language.minilm.weights_folder", lambda: None)


def sims(*words: str | Path, wide: bool = True) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "250" if wide else "80"})


def told(done: Result) -> str:
    assert done.exit_code == 0, (done.output, done.exception)
    return done.stdout


@pytest.fixture
def story(tmp_path: Path) -> Path:
    file = tmp_path / "story.txt"
    file.write_text(NARRATIVE, encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def film() -> bytes:
    """Three seconds with a track of subtitles."""
    return film_of([Drawn(1.5, 0), Drawn(1.5, 1)], Making(subtitles=CUES))


def test_a_text_gives_a_table_and_says_what_is_not_shown_and_who_read_it(story: Path) -> None:
    shown = told(sims("extract", story, "--name", "Martha's day"))
    assert "hurries-into-study-grabs-phone-desk" in shown
    assert "scene 4: nothing: nobody in it does what a body can act" in shown
    assert "turned until the morning: none of the captions shows it" in shown
    assert "7 short scripts of 8 scenes; by rules" in shown
    assert shown.endswith("none is kept; --add keeps them in your library, --out writes them to a file\n")


def test_what_is_written_can_be_read_and_acted_out(story: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "scripts.jsonl"
    told(sims("extract", story, "--out", out, "--licence", "CC0-1.0"))
    scripts = read_scripts(out)
    assert len(scripts) == 7
    assert not any(check(script) for script in scripts)
    assert {(script.licence, script.source, script.origin and script.origin.name) for script in scripts} == {
        ("CC0-1.0", "text", "story")
    }


def test_what_is_added_is_in_the_library_and_marked_when_it_comes_again(story: Path) -> None:
    before = len(open_shelves(read_settings()).scripts())
    assert f"added 7; the library has {before + 7} scripts" in told(sims("extract", story, "--add"))
    again = told(sims("extract", story))
    assert again.count("nearly the same as") == 7
    assert len(open_shelves(read_settings()).scripts()) == before + 7


def test_a_film_without_a_model_is_read_by_its_subtitles(film: bytes, tmp_path: Path) -> None:
    file, out = tmp_path / "film.bin", tmp_path / "scripts.jsonl"
    file.write_bytes(film)
    shown = told(sims("extract", file, "--out", out))
    (script,) = read_scripts(out)
    assert script.origin is not None
    assert (script.source, script.emotion, script.origin.by) == ("video", "angry", "rules")
    assert (script.origin.start, script.origin.end) == pytest.approx((0.5, 2.8), abs=0.1)
    assert "0:00-0:02" in shown
    assert "nobody watched the pictures" in shown


def test_subtitles_beside_a_film_come_before_those_in_it(film: bytes, tmp_path: Path) -> None:
    file, beside, out = tmp_path / "film.mp4", tmp_path / "film.srt", tmp_path / "scripts.jsonl"
    file.write_bytes(film)
    beside.write_text("1\n00:00:01,000 --> 00:00:02,000\nHe lies down on the bed.\n")
    told(sims("extract", file, "--subtitles", beside, "--out", out))
    (script,) = read_scripts(out)
    assert [keyframe.skill for keyframe in script.keyframes] == ["loco", "liedown"]


def test_a_film_without_words_and_model_is_refused_saying_what_would_help(tmp_path: Path) -> None:
    (tmp_path / "film.mp4").write_bytes(film_of([Drawn(1.0, 0)]))
    done = sims("extract", tmp_path / "film.mp4")
    assert isinstance(done.exception, ExtractionError)
    assert "give its subtitles (SRT, WebVTT or ASS), or set SIMS_LLM_MODEL" in str(done.exception)


def test_subtitles_alone_are_read_whatever_the_file_is_called(tmp_path: Path) -> None:
    (tmp_path / "words.txt").write_text(SUBTITLES)
    assert "1:30-1:33" in told(sims("extract", tmp_path / "words.txt"))


def test_a_scripted_model_is_named_and_another_language_is_passed_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sit = {"skill": "sitdown", "emotion": "tired", "caption": "sitting still", "furniture": "sofa"}
    found = {"scene": 1, "summary": "The character sits down on the sofa.", "emotion": "tired", "room": "living_room"}
    (tmp_path / "model.json").write_text(
        json.dumps({"short scripts out": {"scripts": [{**found, "keyframes": [sit]}]}})
    )
    monkeypatch.setenv("SIMS_LLM_MODEL", f"scripted:{tmp_path / 'model.json'}")
    (tmp_path / "de.txt").write_text(GERMAN)
    shown = told(sims("extract", tmp_path / "de.txt"))
    assert "1 short script of 1 scene; by llm:scripted" in shown
    assert "walk put in" in shown


@pytest.mark.parametrize(
    ("content", "words", "error", "why"),
    [
        (GERMAN.encode(), (), ExtractionError, "looks like German"),
        (b"", (), ExtractionError, "is empty"),
        (b"#EXTM3U\n", (), FilmError, "playlist"),
        (b"1\n00:00:01,000 --> 00:00:02,000\n\n", (), SubtitleError, "no cue with words"),
        (NARRATIVE.encode(), ("--name", " "), RequestError, "--name"),
        (NARRATIVE.encode(), ("--licence", ""), RequestError, "--licence"),
    ],
    ids=["German", "empty", "playlist", "silent", "name", "licence"],
)
def test_what_a_user_does_wrong_is_one_line_and_keeps_nothing(
    tmp_path: Path, content: bytes, words: tuple[str, ...], error: type[Exception], why: str
) -> None:
    (tmp_path / "file").write_bytes(content)
    done = sims("extract", tmp_path / "file", "--add", "--out", tmp_path / "out.jsonl", *words)
    assert isinstance(done.exception, error)
    assert why in str(done.exception)
    assert not (tmp_path / "out.jsonl").exists()
