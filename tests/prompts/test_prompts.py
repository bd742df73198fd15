"""Prompts: files with named blanks, and what others wrote kept inside its fence."""

from __future__ import annotations

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
