"""Styles are rows of tables: what a row names is known, what it gives is checked, and the particular row wins."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import pytest
from for_each import for_each

from motion_backend.motion import Emotion
from motion_backend.procedural.emotion_style import THIGHS, Bearing, arm_poses, bearing_of, bearings
from motion_backend.procedural.lie.lie_styles import Lying
from motion_backend.procedural.sit.sit_pose import SURFACES
from motion_backend.procedural.sit.sit_styles import Seated, manners, sit_style
from motion_backend.procedural.style_sheet import ArmLengths, Degrees, Metres, StyleSheet, read_style_sheet
from motion_backend.procedural.touch.gestures import gesture_names
from motion_backend.procedural.touch.hand_captions import Handled, handled
from motion_backend.procedural.touch.hand_rests import HOLDS
from motion_backend.procedural.walk.walk_styles import Walk, walk_style
from scene_graphs import data_tables
from scene_graphs.data_tables import TableError

SHEETS = {
    "walk.toml": (Bearing, Walk),
    "sit.toml": (Bearing, Seated),
    "lie.toml": (Lying,),
    "touch.toml": (Handled,),
}


@dataclass(frozen=True)
class Hop:
    """A style for tests."""

    height: Metres = 0.1
    bend: Degrees = 5.0
    reach: ArmLengths = 0.0
    arms: tuple[str, str] = ("hang", "hang")
    fast: bool = False


def sheet_of(text: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> StyleSheet:
    (folder / "data" / "styles").mkdir(parents=True)
    (folder / "data" / "styles" / "hop.toml").write_text(text)
    monkeypatch.setattr(data_tables, "files", lambda _: folder)
    try:
        return read_style_sheet.__wrapped__("hop.toml", Hop)
    finally:
        data_tables.read_table.cache_clear()


def test_all_that_rows_name_is_known() -> None:
    unknown = []
    for path, styles in SHEETS.items():
        sheet = read_style_sheet(path, *styles)
        for row in (*sheet.emotions.values(), *(one.changes for one in sheet.captions)):
            arms = [arm for arm in row.get("arms", ()) if arm not in {*arm_poses(), *HOLDS, *SURFACES, THIGHS}]
            lying = {"along", "pillow", "tucked", "loose"} if path == "lie.toml" else set()
            unknown += [(path, arm) for arm in arms if arm not in lying]
            if path != "touch.toml":
                unknown += [(path, doing) for doing in [row.get("doing", "")] if doing and doing not in gesture_names()]
    assert not unknown


def test_a_row_of_a_mood_counts_in_that_mood_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    row = "[[captions]]\nwords = 'hop'\n"
    text = f'{row}height_m = 0.2\n\n{row}moods = ["angry"]\nheight_m = 0.4\n'
    sheet = sheet_of(text, tmp_path, monkeypatch)
    assert sheet.of_caption("hop", Emotion.ANGRY) == {"height": 0.4}
    assert sheet.of_caption("hop", Emotion.SAD) == sheet.of_caption("hop") == {"height": 0.2}


def test_every_row_changes_something_and_is_in_small_letters_as_captions_are_when_they_are_read() -> None:
    rows = [row for path, styles in SHEETS.items() for row in read_style_sheet(path, *styles).captions]
    assert [row.words for row in rows if not row.changes or re.search(r"(?<!\\)[A-Z]", row.words.pattern)] == []


def test_no_two_emotions_look_the_same() -> None:
    for one, other in combinations(Emotion, 2):
        assert bearings()[one] != bearings()[other]
        assert walk_style(one, "walk") != walk_style(other, "walk")
        assert manners()[one] != manners()[other]


def test_an_emotion_walks_as_its_rows_say_and_a_caption_says_more() -> None:
    tired, still = walk_style(Emotion.TIRED, "walk"), walk_style(Emotion.NEUTRAL, "walk")
    assert (tired.speed, tired.width) == (0.75, still.width)
    assert walk_style(Emotion.TIRED, "walking quickly").speed > still.speed
    assert walk_style(Emotion.HAPPY, "walk with depression").bearing.head == 26
    assert sit_style(Emotion.SAD, "sit upright").bearing.lean == 0


PLAIN = "smoothly forward walk"


def test_a_plain_walk_is_walked_in_ones_mood() -> None:
    """The words of a caption that say nothing of a mood do not drown it: tempo, arms and head show it."""
    usual = walk_style(Emotion.NEUTRAL, PLAIN)
    for emotion in set(Emotion) - {Emotion.NEUTRAL}:
        style = walk_style(emotion, PLAIN)
        assert abs(style.speed / usual.speed - 1) > 0.1, emotion
        assert style.bearing.head == bearings()[emotion].head != usual.bearing.head
        if emotion is not Emotion.RELAXED:
            assert (style.bearing.arms, style.swing, style.elbow) != (usual.bearing.arms, usual.swing, usual.elbow)
    speeds = [walk_style(one, PLAIN).speed for one in (Emotion.SAD, Emotion.RELAXED, Emotion.HAPPY, Emotion.HURRIED)]
    assert speeds == sorted(speeds)


def test_what_a_caption_asks_for_is_done_in_a_mood_that_pulls_against_it() -> None:
    """Slowly is slower than usual and quickly quicker, whoever does it, but not alike for everybody."""
    for emotion in Emotion:
        slow, plain, quick = (walk_style(emotion, words).speed for words in ("walk slowly", "walk", "walk quickly"))
        assert slow <= min(plain, 0.8)
        assert quick >= max(plain, 1.3)
    assert walk_style(Emotion.SAD, "run").speed == walk_style(Emotion.NEUTRAL, "run").speed
    assert walk_style(Emotion.STRESSED, "stroll").speed > walk_style(Emotion.SAD, "stroll").speed


def test_the_pace_of_a_caption_bounds_that_of_the_emotion() -> None:
    for emotion in Emotion:
        usual = bearing_of(emotion)
        assert bearing_of(emotion, "stand up slowly").tempo == min(usual.tempo, 0.65)
        assert bearing_of(emotion, "stand up abruptly").tempo == max(usual.tempo, 1.6)
        assert bearing_of(emotion, "sitting still").restless == pytest.approx(0.3 * usual.restless)


@for_each(
    ("caption", "said"),
    [
        ("pick it up and turn it", Handled("pick")),
        ("turn it on", Handled("press")),
        ("turn the knob with both hands", Handled("rotate", both_hands=True)),
        ("touch medium height", Handled()),
    ],
)
def test_what_hands_do_is_read_from_their_rows(caption: str, said: Handled) -> None:
    assert handled(caption) == said


def test_a_later_row_wins_and_rows_add_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = sheet_of(
        """
        [emotions.happy]
        height_m = 0.3
        [[captions]]
        words = 'hop'
        bend_deg = 10
        reach_arm_lengths = 0.2
        [[captions]]
        words = 'hop high|leap'
        bend_deg = 20
        fast = true
        arms = ["open", "hang"]
        """,
        tmp_path,
        monkeypatch,
    )
    assert sheet.emotions == {Emotion.HAPPY: {"height": 0.3}}
    assert sheet.of_caption("Hop high!") == {"bend": 20, "reach": 0.2, "fast": True, "arms": ("open", "hang")}
    assert sheet.of_caption("hop") == {"bend": 10, "reach": 0.2}
    assert sheet.of_caption("walk") == {}


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("[emotions.happy]\nheight = 0.3", "emotions.happy.height"),
        ("[emotions.happy]\nheight_cm = 30", "emotions.happy.height_cm"),
        ("[emotions.gleeful]\nheight_m = 0.3", "emotions.gleeful"),
        ("[[captions]]\nheight_m = 0.3", "captions.0.words"),
        ("[[captions]]\nwords = 'hop'\nbend_deg = nan", "captions.0.bend_deg"),
        ("[[captions]]\nwords = 'hop'\narms = ['open']", "captions.0.arms"),
    ],
)
def test_a_row_that_is_wrong_is_refused_by_its_place(
    text: str, place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(TableError, match=re.escape(f"data/styles/hop.toml: {place}")):
        sheet_of(text, tmp_path, monkeypatch)
