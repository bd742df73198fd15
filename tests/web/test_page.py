"""A visitor's way through the page, in a real browser, against a real service."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import time
from bisect import bisect_right
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from body_in_film import PRESENT, body_shares, decoded
from running import PATIENCE, RunningService, finished

from motion_backend.backends import about
from motion_backend.rendering.film_picture import split
from planner_service.jobs.film_stages import Filmer
from planner_service.library.library import Shelves
from planner_service.pipeline import Pipeline
from planner_service.settings import Settings
from planner_service.store.database import database_url, open_engine
from planner_service.store.story_store import Stories

HERE = Path(__file__).parent
PAGE = Path(__file__).parents[2] / "planner_service" / "page" / "index.html"
THEME = (
    "A person is happy at first and walks about the bedroom, opens the wardrobe, hears on the phone that the job "
    "interview went wrong, sits down on the bed, very sad, and lies down."
)
NONSENSE = "asdf qwer zxcv"
LONG = (
    "He wakes up, reads at the desk, sits on the sofa, argues on the phone, drinks, dances, tidies the shelf, "
    "eats at the table, gets angry, calms down and falls asleep in bed."
)
"""A theme whose story is stopped before it is made."""
BRIEF = "She sits down on the sofa and gets up again."
"""A theme whose film is short, though not so short that it could not be stopped."""
APART = 0.01
"""Metres that a drawn joint may be from where the service says it is."""


def missing() -> str | None:
    """What the browser's tests need and is not here, with how to get it."""
    if shutil.which("node") is None:
        return "Node is not installed"
    if not (HERE / "node_modules" / "playwright-core").is_dir():
        return "the browser's driver is not installed: `make test-service` does that, or npm ci in tests/web"
    if not os.environ.get("CHROMIUM") and not any(map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))):
        return "no Chromium: install it, or name one by CHROMIUM"
    return None if PAGE.is_file() else "the page is not built: `make page`"


REASON = missing()
pytestmark = [pytest.mark.service, pytest.mark.skipif(REASON is not None, reason=str(REASON))]


class Visit:
    """Runs a scenario in the browser, and looks at how the page behaved whatever the scenario is about."""

    def __init__(self, service: RunningService) -> None:
        self.service = service

    def __call__(self, name: str, *words: str, refused: tuple[str, ...] = ()) -> dict[str, Any]:
        command = ["node", str(HERE / f"{name}.mjs"), self.service.url, *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=3 * PATIENCE, check=False)
        assert done.returncode == 0, done.stderr
        told: dict[str, Any] = json.loads(done.stdout)
        foreign = [url for url in told["requests"] if not url.startswith((self.service.url + "/", "blob:", "data:"))]
        assert foreign == [], "the page asks nobody but its own service"
        assert told["errors"] == []
        assert told["violations"] == [], "nothing on the page is against its own policy"
        assert sorted(told["refused"]) == sorted(refused)
        return told


@pytest.fixture(scope="module")
def visit(service: RunningService) -> Visit:
    """Visitors come once the service is warm."""
    deadline = time.monotonic() + PATIENCE
    while len(service.worker_pids()) < service.workers:
        assert time.monotonic() < deadline, "no worker is ready"
        time.sleep(0.1)
    return Visit(service)


@pytest.fixture(scope="module")
def client(service: RunningService) -> Iterator[httpx.Client]:
    with service.client() as client:
        yield client


@pytest.fixture(scope="module")
def watched(visit: Visit) -> dict[str, Any]:
    """A theme posted with the keyboard, its film played and looked at."""
    return visit("watching", THEME, str(visit.service.worker_pids()[0]))


@pytest.fixture(scope="module")
def story(watched: dict[str, Any], client: httpx.Client) -> dict[str, Any]:
    """The story that was watched."""
    return finished(client, watched["story"])


@pytest.fixture(scope="module")
def brief(visit: Visit, client: httpx.Client) -> dict[str, Any]:
    """A short story, made."""
    assert visit
    return finished(client, client.post("/v1/stories", json={"theme": BRIEF}).raise_for_status().json()["id"])


def words(text: str) -> str:
    """Text without regard to how it is broken into lines."""
    return " ".join(text.split())


def test_a_theme_posted_by_keyboard_is_seen_growing_and_plays_while_it_is_made(watched: dict[str, Any]) -> None:
    grown = watched["grown"]
    assert len({step for step in grown["steps"] if step}) >= 2, "what is being done is said"
    assert grown["cues"][-1] > 1
    assert grown["cues"] == sorted(grown["cues"])
    assert len(grown["delays"]) == grown["cues"][-1]
    # It appears keyframe by keyframe, unless it was written already when the page first looked.
    assert np.all(np.diff(grown["delays"]) > 0) or not any(grown["delays"])
    assert grown["made"] == sorted(grown["made"])
    assert len(set(grown["made"])) >= 2, "moments light up as they are made"
    first = grown["playing"]
    assert first["open"]
    assert first["state"] == "running" or first["readyFrames"] < first["framesTotal"], (
        "it need not be whole to be played"
    )


def test_the_body_moves_as_the_service_says(watched: dict[str, Any], client: httpx.Client) -> None:
    drawn = watched["drawn"]
    seen = [drawn["first"], drawn["second"], watched["follow"]]
    for moment in seen:
        options: dict[str, str | int] = {"format": "f32", "from": moment["frame"], "to": moment["frame"] + 1}
        answer = client.get(f"/v1/stories/{watched['story']}/motion", params=options).raise_for_status()
        truth = np.frombuffer(answer.content, "<f4").reshape(22, 3)
        apart = np.linalg.norm(np.array(moment["joints"]) - truth, axis=1)
        assert apart.max() < APART
    one, other = np.array(seen[0]["joints"]), np.array(seen[1]["joints"])
    assert np.linalg.norm(one - other, axis=1).min() > 0.5, "no joint is where it was"
    bent = np.linalg.norm((one - one[0]) - (other - other[0]), axis=1)
    assert bent.max() > 0.1, "the body moves, it is not only moved about"


def test_the_body_is_drawn_where_its_joints_are(watched: dict[str, Any]) -> None:
    drawn = watched["drawn"]
    assert drawn["first"]["camera"]["mode"] == drawn["second"]["camera"]["mode"] == "orbit"
    assert drawn["still"] < 0.02, "a paused film stands still"
    assert drawn["moved"] > 0.1, "where the body was there is something else once it has gone"
    assert watched["colours"] > 200
    assert watched["follow"]["camera"]["mode"] == "follow"
    bounds = watched["bounds"]
    for x, y in watched["follow"]["pixels"]:
        assert bounds["x"] < x < bounds["x"] + bounds["width"]
        assert bounds["y"] < y < bounds["y"] + bounds["height"]


def test_the_text_follows_the_film_and_leads_back_to_it(watched: dict[str, Any], story: dict[str, Any]) -> None:
    tells: dict[int, dict[str, int]] = {}
    for span in story["spans"]:
        for index in span["keyframes"]:
            tells.setdefault(index, span)  # what somebody starts at is told before what they then do
    assert len([lit for lit in watched["grown"]["lit"] if lit]) >= 2, (
        "while it plays, one sentence after another is lit"
    )
    assert len({moment["words"] for moment in watched["told"]}) >= 3
    for moment in watched["told"]:
        span = tells[moment["keyframe"]]
        assert words(moment["words"]) == words(story["text"][span["start"] : span["end"]])
    for moment in watched["clicked"]:
        keyframe = story["keyframes"][moment["keyframe"]]
        assert moment["frame"] == keyframe["start"], "a sentence leads to where its moment begins"
        span = tells[moment["keyframe"]]
        assert words(moment["words"]) in words(story["text"][span["start"] : span["end"]])


def test_words_that_are_told_and_not_acted_can_be_read(watched: dict[str, Any], story: dict[str, Any]) -> None:
    text = story["text"]
    # They are cut where words begin or end that lead to a moment: of somebody who starts at what they are told.
    slanted = "".join(one["text"] for one in watched["unseen"])
    assert words(slanted) == words("".join(text[one["start"] : one["end"]] for one in story["thoughts"]))
    assert watched["unseen"], "the theme has something that is only told"
    assert words(watched["note"]) == "Slanted words are told and not seen: the film does not show them."
    for one in watched["unseen"]:
        # Blanks at which a line breaks have no width.
        assert one["box"] > 0.9 * one["letters"] > 0, one


def test_how_one_sits_is_changed_beside_the_film_and_seen(
    watched: dict[str, Any], story: dict[str, Any], client: httpx.Client
) -> None:
    changed, at = watched["changed"], watched["changed"]["at"]
    count = len(story["keyframes"])
    assert changed["counts"] == [count, count - 1, count + 1, count, count + 1], "what is done can be undone"
    assert changed["playable"] == [False, True, False], "another seed can be played as soon as it is typed"
    assert changed["carried"] == f"Moment {at}: earlier", "the keyboard stays with what it moves"
    assert changed["wrong"] == []
    assert changed["sideways"] <= 0
    take = client.get(f"/v1/stories/{changed['take']}").raise_for_status().json()
    client.post(f"/v1/stories/{changed['take']}/cancel")
    assert take["derived_from"] == story["id"]
    assert take["reused"] == at - 1, "all before the walk to the seat is the old story's"
    assert f"changed: moment {at + 1} (how)" in changed["origin"]
    assert f"Acted again from moment {at} on, so that it leads to what follows now" in changed["origin"]
    assert changed["keyframe"] == at, "it plays from the first change"
    assert [one["caption"] for one in take["keyframes"]] == [
        changed["caption"] if one["index"] == at else one["caption"] for one in story["keyframes"]
    ]
    print(f"from the click to the changed moment: {changed['milliseconds']:.0f} ms")
    before, after = (np.array(changed[name]["joints"]) for name in ("before", "after"))
    assert np.linalg.norm((before - before[0]) - (after - after[0]), axis=1).max() > APART, "the pose is another"
    assert changed["apart"] > 0.001, "and is seen to be"
    options: dict[str, str | int] = {"format": "f32", "from": changed["after"]["frame"]}
    answer = client.get(f"/v1/stories/{changed['take']}/motion", params=options | {"to": int(options["from"]) + 1})
    truth = np.frombuffer(answer.raise_for_status().content, "<f4").reshape(22, 3)
    assert np.linalg.norm(after - truth, axis=1).max() < APART


def test_stories_survive_a_reload_and_the_gallery_has_them_all(
    visit: Visit, story: dict[str, Any], client: httpx.Client
) -> None:
    for seed in range(13):
        posted = client.post("/v1/stories", json={"theme": "A person sits down.", "seed": seed}).raise_for_status()
        # Whether it is stopped or done by now is all the same.
        client.post(f"/v1/stories/{posted.json()['id']}/cancel")
    told = visit("gallery", story["id"])
    assert told["before"] == told["after"] == f"{story['title']} · SIMS stories"
    assert told["opened"] == story["id"]
    assert told["counts"][0] >= 12
    assert len(told["counts"]) > 1, "more stories than a page holds"
    assert told["counts"] == sorted(set(told["counts"]))
    assert len(set(told["links"])) == len(told["links"]) == told["counts"][-1]
    assert f"#/stories/{story['id']}" in told["links"]


def test_a_caption_is_seen_acted_and_nothing_is_kept_or_lost_by_it(visit: Visit, brief: dict[str, Any]) -> None:
    told = visit("captions", brief["id"])
    assert told["said"], "who cannot see it is told that it is on its way"
    assert told["begun"]
    assert told["moved"]
    assert max(told["wide"]) <= 0
    assert told["focused"] == "drinking while standing, cup in the right hand"
    assert told["after"] == told["before"], "what was looked at is thrown away, and so is what was cancelled"
    assert told["address"] == f"#/stories/{brief['id']}"


@pytest.fixture(scope="module")
def looked(visit: Visit, story: dict[str, Any]) -> dict[str, Any]:
    """The story's page at many sizes, and the script as a form."""
    return visit("looks", story["id"])


def test_it_is_fine_on_every_screen_by_day_and_by_night_and_for_those_who_want_it_still(
    looked: dict[str, Any],
) -> None:
    told = looked
    assert len(told["shown"]) == 12
    for shown in told["shown"]:
        assert shown["overhang"] <= 0, shown
        assert not shown["wrong"], shown
    still = told["still"]
    assert not still["playing"]
    assert still["time"] == still["early"]
    assert still["camera"]["mode"] == "orbit"
    assert still["running"] == 0, "nothing moves that was not asked to"


def test_what_one_does_next_is_seen_beside_the_film_without_scrolling(looked: dict[str, Any]) -> None:
    for seen in looked["next"]:
        assert seen["named"][:2] == ["Change the script", "Download"], seen
        assert max(seen["bottom"], seen["film"]) <= seen["height"], seen
        assert seen["rows"] >= 3 or seen["width"] < 600, "the script stands there too"


def test_the_script_is_changed_in_sight_of_what_belongs_together(looked: dict[str, Any]) -> None:
    assert len(looked["form"]) == 4
    for laid in looked["form"]:
        size = laid["width"], laid["height"]
        assert laid["sideways"] <= 0, size
        assert max(laid["over"]) <= 0, (size, laid["over"])
        assert [pair["name"] for pair in laid["pairs"]] == ["Seed", "Moved by", "Played in"]
        for pair in laid["pairs"]:
            label, field = pair["label"], pair["field"]
            assert field["top"] < (label["top"] + label["bottom"]) / 2 < field["bottom"], (size, pair["name"])
            assert 0 <= field["left"] - label["right"] < 16, "a label stands at its field"
        play, foot, shown = laid["play"], laid["foot"], laid["list"]
        assert play["top"] >= 0, size
        assert play["bottom"] <= laid["height"], size
        low = min(shown["bottom"], foot["top"])
        seen = [row for row in laid["rows"] if row["top"] >= max(shown["top"], 0) - 1 and row["bottom"] <= low + 1]
        assert len(seen) >= 5, (size, len(laid["rows"]))
        lines = {round((one["top"] + one["bottom"]) / 2) for one in laid["controls"]}
        assert max(lines) - min(lines) <= 2 or laid["width"] < 600, "the film's buttons are one row"


def test_what_goes_wrong_is_said_where_it_belongs(visit: Visit, client: httpx.Client) -> None:
    refused = ("422 /v1/stories", "404 /v1/stories/00000000-0000-7000-8000-000000000000")
    told = visit("trouble", NONSENSE, LONG, refused=refused)
    assert told["empty"]["invalid"] == "true"
    assert "Write what shall happen" in told["empty"]["words"]
    assert told["tall"]["invalid"] == "true"
    assert "2.2" in told["tall"]["words"]
    assert told["tall"]["focused"]
    assert "character-height-error" in told["tall"]["described"], "a screen reader says it with the field"
    assert told["cleared"]["invalid"] is None
    assert told["cleared"]["words"] == ""
    assert NONSENSE in told["failed"]["words"], "why the story failed"
    assert told["failed"]["again"] == 1
    assert "Stopped" in told["stopped"]["words"]
    assert told["stopped"]["hidden"], "nothing is being made any more"
    ended = client.get(f"/v1/stories/{told['stopped']['id']}").raise_for_status().json()
    assert ended["state"] == "cancelled"


def test_the_library_is_looked_through_searched_added_to_and_played_in(visit: Visit, client: httpx.Client) -> None:
    refused = ("422 /v1/layouts", "422 /v1/layouts", "409 /v1/layouts", "404 /v1/layouts/page-nook")
    told = visit("rooms", refused=refused)
    client.post(f"/v1/stories/{told['used']['story']}/cancel")
    _browsed(told["browsed"], client)
    _searched(told["searched"], client)
    _looked_at(told["looked"], told["searched"]["room"], client)
    brought = told["brought"]
    assert brought["kept"]["matches"] == told["searched"]["count"], "who comes back finds what was left"
    assert brought["kept"]["words"].startswith("Sofa:sit")
    assert [brought[name]["format"] for name in ("spoiled", "cut", "obj", "own")] == ["native", "glb", "obj", "native"]
    assert "/floor_polygon: " in brought["spoiled"]["words"], "which field is wrong"
    assert "cut.glb is cut off" in brought["cut"]["words"]
    assert "sofa" in brought["obj"]["words"]
    assert "What was guessed" in brought["obj"]["words"]
    assert "page-nook is in the library: 2 pieces" in brought["own"]["words"]
    assert "choose another id" in brought["again"]["words"]
    for shown in told["judged"]:
        assert shown["overhang"] <= 0, shown
        assert not shown.get("wrong"), shown
    assert told["used"]["asked"]["layouts"] == ["page-nook"]
    assert "Played in page-nook" in told["used"]["words"]


def _browsed(told: dict[str, Any], client: httpx.Client) -> None:
    """All rooms and the studies among them, plans only of those on the screen."""
    first = client.get("/v1/layouts", params={"limit": 48}).raise_for_status().json()["items"]
    assert told["names"] == [room["id"] for room in first]
    assert told["all"]["pieces"] == first[0]["objects"]
    assert 0 < told["all"]["plans"] < told["all"]["cards"], "only what is on the screen is fetched"
    studies = client.get("/v1/layouts", params={"room": "study", "limit": 24}).raise_for_status().json()["items"]
    assert len(told["studies"]) == len(studies)
    assert told["address"] == "#/rooms?type=study"


def _searched(told: dict[str, Any], client: httpx.Client) -> None:
    """The page shows the service's first answer, piece by piece."""
    assert "sit, lie or touch" in told["wrong"]["words"]
    assert told["wrong"]["invalid"] == "true"
    assert told["wrong"]["focused"]
    nodes = [
        {"category": "Sofa", "needs": ["sit"]},
        *({"category": one} for one in ("coffee table", "piano", "tv stand")),
    ]
    ask = {"graph": {"nodes": nodes, "edges": [[0, 1], [2, 0]]}, "k": 6}
    matches = client.post("/v1/layouts/retrieve", json=ask).raise_for_status().json()["matches"]
    best = matches[0]
    assert told["count"] == len(matches)
    assert told["room"] == best["layout_id"]
    levels = {pair["node"]: pair["level"] for pair in best["mapping"]}
    assert told["found"] == [[str(node + 1), level] for node, level in levels.items()]
    assert told["asked"] == [[str(node + 1), levels.get(node, "missing")] for node in range(4)]
    assert 2 in best["missing"], "no room of ours has a piano"
    assert "nothing of its kind" in told["list"][2]
    assert told["marked"] == len(best["mapping"])
    assert [told["lost"], told["relations"]] == [len(best["lost"]), 2]
    assert told["sum"].startswith(f"Distance {best['distance']} = ")
    assert ("this is proven" in told["sum"]) == best["exact"]


def _looked_at(told: dict[str, Any], room_id: str, client: httpx.Client) -> None:
    """What the plan shows is what the service says of the room; the keyboard gets to every piece."""
    room = client.get(f"/v1/layouts/{room_id}").raise_for_status().json()
    done = {(spot["object_id"], spot["affordance"]) for spot in room["spots"]}
    shown = {name: layer["on"] for name, layer in told["layers"].items()}
    assert shown["Neighbours"] == len(room["graph"]["edges"])
    assert shown["Touching"] == sum(affordance == "touch" for _, affordance in done)
    assert shown["Sitting and lying"] == len(done) - shown["Touching"]
    assert 0 < shown["Names"] <= len(room["objects"])
    assert [layer["off"] for layer in told["layers"].values()] == [0, 0, 0, 0]
    ids = [placed["id"] for placed in room["objects"]]
    assert [told["first"]["id"], told["second"]["id"], told["chosen"]] == [ids[0], ids[1], ids[1]]
    for step in (told["first"], told["second"]):
        ends = [{room["graph"]["nodes"][end]["object_id"] for end in edge} for edge in room["graph"]["edges"]]
        near = [pair for pair in ends if step["id"] in pair]
        assert [step["edges"], step["near"]] == [len(near), len(near)]
        assert step["label"] == step["caption"], "what is seen is said as well"
    assert told["left"] == 0
    assert told["rows"] == len(ids)
    assert told["title"] == f"{room_id} · SIMS stories"
    links = room["links"]
    drawings = [links["drawing"], links["drawing"].replace(".svg", ".png")]
    assert [f"/{address}" for address in told["files"]] == [*drawings, links["scene"], links["self"]]


def test_a_home_is_brought_in_beside_the_script_and_both_films_play_side_by_side(
    visit: Visit, brief: dict[str, Any], client: httpx.Client
) -> None:
    refused = ("422 /v1/layouts", f"422 /v1/stories/{brief['id']}/takes")
    told = visit("elsewhere", brief["id"], refused=refused)
    moved = told["moved"]
    assert "there is no such room" in moved["unknown"].lower()
    assert "/floor_polygon: " in moved["spoiled"]["words"], "which field is wrong"
    assert "page-den is in the library" in moved["own"]["words"]
    assert (moved["own"]["rooms"], moved["layouts"]) == ("page-den", ["page-den"])
    assert (moved["wrong"], moved["sideways"]) == ([], 0)
    take = finished(client, moved["take"])
    assert (take["state"], take["derived_from"]) == ("succeeded", brief["id"])
    assert [room["layout_id"] for room in take["home"]["rooms"]] == ["page-den"]
    both = told["both"]
    assert [head.split(" · ")[0] for head in both["heads"]] == ["The story", "Take 1"]
    assert "What differs" in both["differs"]
    assert both["sideways"] <= 0
    _in_step(told["steps"], [[one["start"] for one in story["keyframes"]] for story in (brief, take)])

    learned, backends = finished(client, told["learned"]), told["backends"]
    stories = (finished(client, brief["id"]), learned)
    assert (learned["backend"], learned["take"]) == ("diffusion", 2)
    assert backends["heads"] == [
        f"The story · procedural, seed {brief['seed']}",
        f"Take 2 · diffusion, seed {brief['seed']}",
    ]
    assert backends["title"] == f"{brief['title']}, side by side"
    for story, figures, movers in zip(stories, backends["figures"], backends["movers"], strict=True):
        motion = story["report"]["motion"]
        assert f"{motion['reached']} of {motion['keyframes']}" in figures
        assert f"{motion['seconds']:.0f} s" in figures
        for name, share in motion["made_by"].items():
            assert f"Moved by {about(name)}; " in movers
            assert f"{100 * share:.1f} % of the film" in movers
    assert "Take 2" in backends["differs"], "which is which stands over it"
    assert "Moved by" in backends["differs"], "what differs is named"
    assert "Seed" not in backends["differs"], "and what does not is not"
    reasons = {phase["fallback"] for one in learned["report"]["keyframes"] for phase in one["phases"]} - {None}
    told_reasons = backends["movers"][1].count(" %: ")
    assert told_reasons >= len(reasons) > 0, "each reason is told of the backend that stood in"
    client.delete("/v1/layouts/page-den").raise_for_status()


def _in_step(seen: list[list[float]], starts: list[list[int]]) -> None:
    """Both films are in the same moment whenever one looks, or the one ahead waits where its next one begins."""
    assert len(seen) > 10
    apart = 0
    for frames in seen:
        at = [bisect_right(begun, frame + 0.001) - 1 for begun, frame in zip(starts, frames, strict=True)]
        assert abs(at[0] - at[1]) <= 1, frames
        if at[0] != at[1]:
            ahead = int(at[1] > at[0])
            assert frames[ahead] == pytest.approx(starts[ahead][at[ahead]], abs=0.01), frames
            apart += 1
    assert apart, "they last differently long, so that one has to wait"


def test_a_story_is_filmed_at_a_click_and_shows_the_body_moving(
    visit: Visit, brief: dict[str, Any], tmp_path: Path
) -> None:
    story = brief
    done = visit("filming", story["id"], str(tmp_path), refused=(f"501 /v1/stories/{story['id']}/film.usd",))
    assert done["name"].endswith(".mp4")
    assert done["seen"] == sorted(done["seen"]), "it never goes back"
    film = list(decoded(tmp_path / "film.mp4"))
    assert len(film) == story["motion"]["frames"]
    gray = [split(one)[0][::8, ::8].astype(int) for one in film[::15]]
    still = [np.abs(one - other).max() < 8 for one, other in zip(gray[::2], gray[1::2], strict=False)]
    assert np.mean(still) < 0.5, "most of the time something moves"
    engine = open_engine(database_url(Settings(data_dir=visit.service.folder)))
    filmed = Filmer(Stories(engine), Pipeline(Shelves(engine)), "").filmed(story["id"])
    engine.dispose()
    shares = np.array(list(body_shares(film, filmed, every=10).values()))
    assert np.mean(shares > PRESENT) >= 0.95, "the body is in the picture"

    usd = done["usd"]
    assert usd["reason"] == "writing film.usd needs a library"
    assert usd["name"] == usd["link"] == done["name"].replace(".mp4", ".usd")
    assert (tmp_path / "film.usd").read_bytes().startswith(b"PXR-USDC")
