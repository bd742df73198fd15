"""Subtitles of every form and encoding: nothing crashes, times can be, and who speaks is told from what is heard."""

from __future__ import annotations

import pysubs2
import pytest
from examples import tries
from for_each import for_each
from hypothesis import example, given
from hypothesis import strategies as st

from planner_service.extraction.subtitles import (
    MAX_CUE_SECONDS,
    MAX_SUBTITLE_BYTES,
    Cue,
    SubtitleError,
    Subtitles,
    read_subtitles,
)
from planner_service.extraction.text_files import decode

WORDS = st.text(st.sampled_from("abc déf ghi, Jkl. ñ"), min_size=1, max_size=30).filter(str.strip)
SPANS = st.lists(st.tuples(st.integers(0, 5_000_000), st.integers(1, 9000), WORDS), min_size=1, max_size=8)


def clock(milliseconds: int, comma: str) -> str:
    seconds, rest = divmod(milliseconds, 1000)
    return f"{seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}{comma}{rest:03}"


def srt(spans: list[tuple[int, int, str]]) -> str:
    return "\n".join(
        f"{number}\n{clock(start, ',')} --> {clock(start + length, ',')}\n{text}\n"
        for number, (start, length, text) in enumerate(spans, 1)
    )


def cues_or_refusal(data: bytes) -> tuple[Cue, ...]:
    """The cues of a file; none where it is refused in one line."""
    try:
        return read_subtitles(data).cues
    except SubtitleError as error:
        if not str(error).startswith("subtitles: ") or "\n" in str(error):
            raise
        return ()


def one(text: str) -> Subtitles:
    return read_subtitles(f"1\n00:00:01,000 --> 00:00:02,000\n{text}\n".encode())


@tries(50)
@given(SPANS, st.sampled_from(["srt", "vtt", "ass"]), st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]))
def test_what_another_library_writes_is_read(spans: list[tuple[int, int, str]], form: str, encoding: str) -> None:
    film = pysubs2.SSAFile()
    for start, length, text in spans:
        start, length = start // 10 * 10, max(10, length // 10 * 10)  # ASS has hundredths
        film.append(pysubs2.SSAEvent(start=start, end=start + length, text=text))
    read = read_subtitles(film.to_string(form).encode(encoding))
    assert read.form == form
    wanted = {(event.start / 1000, event.end / 1000, " ".join(event.text.split())) for event in film}
    assert {(cue.start, cue.end, cue.text) for cue in read.cues} == wanted
    assert [cue.start for cue in read.cues] == sorted(cue.start for cue in read.cues)


@given(st.one_of(st.binary(max_size=400), st.text(max_size=300).map(str.encode)))
@example(b"1\n00:00:00,000 --> 00:00:00,000\n\x00\n")
@example(b"WEBVTT\n\n00:00.000 --> 99:99.999\n<v >{\\p1}&#0;\n")
@example("[Events]\nFormat: ,,\nDialogue: 0,0:00:00.00,0:00:01.00".encode("utf-16"))
def test_any_bytes_are_cues_or_a_clear_error(data: bytes) -> None:
    for body in (data, b"1\n00:00:01,000 --> 00:00:02,000\n" + data, b"WEBVTT\n\n00:01.000 --> 00:02.000\n" + data):
        for cue in cues_or_refusal(body):
            assert 0 <= cue.start < cue.end <= MAX_CUE_SECONDS + 3
            assert cue.text or cue.sounds
            assert not any(letter in cue.text for letter in "\n\r\x00\x1b\u202e")


@for_each(
    ("encoding", "text"),
    [
        ("cp1252", "C’est déjà l’été, où êtes-vous, cœur brisé?"),
        ("latin-1", "Ich möchte größere Stühle über Köln"),
        ("cp1250", "Zażółć gęślą jaźń, jestem bardzo zmęczony"),
        ("cp1251", "Привет, как дела? Я очень устал."),
        ("cp1253", "Καλημέρα, τι κάνεις σήμερα;"),
        ("cp1256", "مرحبا كيف حالك اليوم"),
        ("shift_jis", "こんにちは、今日はとても疲れました。"),
        ("gb18030", "我今天很累，想在沙发上坐一会儿。"),
        ("big5", "我今天很累，想在沙發上坐一會兒。"),
        ("euc_kr", "안녕하세요, 오늘은 정말 피곤해요."),
    ],
)
def test_other_encodings_are_guessed_and_it_says_that_it_guessed(encoding: str, text: str) -> None:
    read = read_subtitles(srt([(1000, 1000, text)]).encode(encoding))
    assert read.cues[0].text == text
    assert read.encoding in (encoding, "cp1252")
    assert "guess" in read.notes[0]


@for_each("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32", "utf-16-le", "utf-16-be"])
def test_utf_is_read_with_and_without_a_mark(encoding: str) -> None:
    read = read_subtitles(srt([(1000, 1000, "Déjà vu")]).encode(encoding))
    assert read.cues[0].text == "Déjà vu"
    assert ("guess" in " ".join(read.notes)) is False


def test_letters_that_were_encoded_twice_are_turned_back() -> None:
    twice = "été, café, où".encode().decode("cp1252", "replace").replace("\ufffd", "")
    assert decode("Déjà vu: café, été".encode().decode("latin-1").encode()).text.startswith("D")
    assert decode(f"{twice} é".encode()).encoding == "utf-8"
    assert decode("café é".encode().decode("cp1252").encode()).text == "café é"


def test_words_speakers_and_sounds_are_told_apart() -> None:
    read = one("<i>JOHN: I can't</i> believe it. {\\an8}\n- [door slams] MARY: Go!\n♪ la la ♪")
    assert [(cue.text, cue.speaker, cue.sounds) for cue in read.cues] == [
        ("I can't believe it.", "JOHN", ()),
        ("Go! la la", "MARY", ("door slams",)),
    ]
    assert one("(sighs)").cues[0].sounds == ("sighs",)
    assert one("&lt;b&gt; fish &amp; chips").cues[0].text == "<b> fish & chips"
    assert one("Note: it is five.").cues[0].speaker is None


def test_voices_of_webvtt_and_names_of_ass_are_speakers() -> None:
    vtt = "WEBVTT\n\nNOTE no cue\n\nid\n00:01.000 --> 00:02.000 line:0\n<v.loud Mary Ann>Hi <c.red>there</c></v>\n"
    cue = read_subtitles(vtt.encode()).cues[0]
    assert (cue.start, cue.end, cue.text, cue.speaker) == (1, 2, "Hi there", "Mary Ann")
    ass = "[Events]\nFormat: Start, End, Name, Text\nDialogue: 0:00:01.50,0:00:02.00,Ann,{\\i1}Well, yes\\Nno\n"
    cue = read_subtitles(ass.encode()).cues[0]
    assert (cue.start, cue.end, cue.text, cue.speaker) == (1.5, 2, "Well, yes no", "Ann")


def test_times_that_cannot_be_are_mended_or_left_out_and_told() -> None:
    rows = [("-00:00:02,000", "00:00:02,000"), ("00:00:09,000", "00:00:08,000"), ("99:00:00,000", "99:00:01,000")]
    text = "\n".join(f"{start} --> {end}\nwords {start}\n" for start, end in rows)
    read = read_subtitles(text.encode())
    assert [(cue.start, cue.end) for cue in read.cues] == [(0, 2), (9, 11)]
    assert read.notes == (
        "1 cue with a negative time, moved to the beginning",
        "1 cue that ended before they began, given 2 seconds",
        "1 cue outside of any film, left out",
    )


def test_a_missing_empty_line_and_cues_out_of_order_do_no_harm() -> None:
    text = "1\n00:00:05,000 --> 00:00:06,000\nlater\n2\n00:00:01,000 --> 00:00:07,000\nearlier\n\nstray"
    assert [cue.text for cue in read_subtitles(text.encode()).cues] == ["earlier", "later"]


@for_each(
    ("data", "says"),
    [
        (b"", "empty"),
        (b"  \n", "empty"),
        (bytes(range(256)) * 40, "no text"),
        (b"Once upon a time there was a man.", "neither SRT nor WebVTT nor ASS"),
        (b"WEBVTT\n\n", "no cue"),
        (b"x" * (MAX_SUBTITLE_BYTES + 1), "at most"),
    ],
)
def test_what_are_no_subtitles_is_refused(data: bytes, says: str) -> None:
    with pytest.raises(SubtitleError, match=says):
        read_subtitles(data)
