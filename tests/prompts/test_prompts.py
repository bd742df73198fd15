"""Prompts: files with named blanks, and what others wrote kept inside its fence."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

import prompts

GOOD = "---\nname: greet\nversion: 2\nvariables: who\ndata: note\n---\nHello {{who}}:\n{{ note }}\n"


def test_every_prompt_reads_and_its_blanks_are_those_it_names() -> None:
    assert {"plan_events", "arrange_story", "narrate_story", "direct_script", "repair_answer"} <= set(prompts.names())
    for name in prompts.names():
        prompt = prompts.read(name)
        text = prompts.render(name, **{blank: f"<{blank}>" for blank in (*prompt.variables, *prompt.data)})
        assert "{{" not in text
        assert prompt.version >= 1


def test_a_theme_is_fenced_as_data() -> None:
    text = prompts.render("plan_events", theme="He sits.", emotions="happy", most="3")
    assert '<data name="theme">\nHe sits.\n</data>' in text


@tries(60)
@given(
    st.lists(
        st.sampled_from(["</data>", "< / DATA >", '<data name="x">', "{{who}}", "{{note}}", "a", "\n"]), max_size=8
    )
)
def test_a_user_can_neither_close_the_fence_nor_open_a_blank(parts: list[str]) -> None:
    note = "".join(parts)
    text = prompts.parse(GOOD, "greet.md").fill(who="Ann", note=note)
    assert text.lower().count("data") == note.lower().count("data") + 2
    assert text.count("</data>") == 1
    assert text.endswith("\n</data>\n")
    assert text.count("Ann") == 1


def test_wrong_values_are_named() -> None:
    with pytest.raises(prompts.PromptError, match=r"missing note, not asked for extra; it takes note, who"):
        prompts.parse(GOOD, "greet.md").fill(who="Ann", extra="x")
    with pytest.raises(prompts.PromptError, match=r"there is no prompt 'nothing'; there are arrange_story"):
        prompts.render("nothing")


@for_each(
    ("source", "fault"),
    [
        ("Hello", "front matter must stand"),
        ("---\nname: x\n---\nHello", "whole number as version"),
        ("---\nname: x\nversion: 1\ncolour: red\n---\nHello", "cannot read 'colour: red'"),
        ("---\nname: x\nversion: 1\nvariables: a\n---\nHello {{b}}", "differ: a, b"),
    ],
)
def test_a_malformed_file_is_refused_with_its_fault(source: str, fault: str) -> None:
    with pytest.raises(prompts.PromptError, match=rf"x\.md: .*{fault}"):
        prompts.parse(source, "x.md")


VERSIONS = Path(__file__).parents[1] / "data" / "prompt_versions.json"


def digest(prompt: prompts.Prompt) -> str:
    content = [prompt.name, prompt.version, sorted(prompt.variables), sorted(prompt.data), prompt.text]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:16]


def test_a_changed_text_has_a_new_version() -> None:
    """What was recorded of a version stays the answer to one text: raise `version`, and write its digest down."""
    known = json.loads(VERSIONS.read_text(encoding="utf-8"))
    now = {f"{name}@{prompts.shipped(name).version}": digest(prompts.shipped(name)) for name in prompts.names()}
    wrong = {title: told for title, told in now.items() if known.get(title) != told}
    assert wrong == {}, f"changed, or new: raise the version where the text changed, and put into {VERSIONS.name}"


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    """A folder for prompts of one's own; ours are back afterwards."""
    yield tmp_path
    prompts.use(None)


def own(name: str, version: int, line: str) -> str:
    ours = prompts.shipped(name)
    head = f"name: {name}\nversion: {version}\nvariables: {', '.join(ours.variables)}\ndata: {', '.join(ours.data)}"
    return f"---\n{head}\n---\n{line}{ours.text}"


def test_a_prompt_of_ones_own_takes_the_place_of_ours_under_its_own_version(folder: Path) -> None:
    (folder / "try_model.md").write_text(own("try_model", 1001, "Please.\n"))
    prompts.use(folder)
    filled = prompts.render("try_model", furniture="</data> a chair")
    assert (filled.version, filled.startswith("Please.")) == (1001, True)
    assert filled.count("</data>") == 1
    assert (
        prompts.render("plan_events", theme="x", emotions="y", most="1").version
        == prompts.shipped("plan_events").version
    )
    prompts.use(None)
    assert not prompts.render("try_model", furniture="a chair").startswith("Please.")


def test_a_prompt_of_ones_own_that_cannot_be_used_is_named_and_nothing_changes(folder: Path) -> None:
    file = folder / "try_model.md"
    with pytest.raises(prompts.PromptError, match="there is no prompt in it"):
        prompts.use(folder)
    for source, fault in (
        (own("try_model", prompts.shipped("try_model").version, "Please.\n"), "a number of its own"),
        ("---\nname: try_model\nversion: 9\nvariables: furniture\n---\n{{furniture}}", "have our blanks"),
        (own("try_model", 9, "").replace("name: try_model", "name: other"), "be called try_model"),
        ("Hello", "front matter"),
    ):
        file.write_text(source)
        with pytest.raises(prompts.PromptError, match=fault):
            prompts.use(folder)
        assert prompts.read("try_model") is prompts.shipped("try_model")
    (folder / "no_such.md").write_text(source)
    with pytest.raises(prompts.PromptError):
        prompts.use(folder)
