"""A drawn film goes in over real HTTP and short scripts with their spans come out, whatever happens to the worker."""

from __future__ import annotations

import io
import json
import os
import signal
import time
from pathlib import Path

import pytest
from film_made import Drawn, Making, film_of
from good_model import seen_in
from model_server import Asked, ModelServer, Sent, chat
from running import PATIENCE, RunningService

from planner_service.client import ApiError, Client
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_repair import check

pytestmark = pytest.mark.service
CUES = ((0.5, 1.5, "She storms through the room."), (8.0, 9.5, "He lies down on the bed."))
KEY = "sk-test-0123456789abcdef"


@pytest.fixture(scope="module")
def film() -> bytes:
    """Fourteen seconds, two scenes."""
    return film_of([Drawn(7, 0), Drawn(7, 1)], Making(rate=4, subtitles=CUES))


def test_a_film_with_subtitles_becomes_short_scripts_that_stories_can_use(
    service: RunningService, film: bytes, tmp_path: Path
) -> None:
    (tmp_path / "An evening.mp4").write_bytes(film)
    with Client(service.url) as client, (tmp_path / "An evening.mp4").open("rb") as file:
        begun = client.extract(video=file, licence="CC0-1.0", add=True, idempotency_key="evening")
        assert not begun.scripts
        done = client.wait_extraction(begun.id, timeout=PATIENCE)
        assert client.extract(
            video=film, name="An evening", licence="CC0-1.0", add=True, idempotency_key="evening"
        ).id == (begun.id)
        seen = [event.name for event in client.extraction_events(begun.id)]
        scripts = [ShortScript.model_validate(row) for row in done.scripts]
        assert [client.short_script(script.id)["licence"] for script in scripts] == ["CC0-1.0"] * len(scripts)
        for script in scripts:
            client.delete_short_script(script.id)
        with pytest.raises(ApiError, match="has succeeded"):
            client.cancel_extraction(begun.id)
        client.delete_extraction(begun.id)
    assert done["by"] == "rules"
    assert [(script.keyframes[-1].skill, script.emotion) for script in scripts] == [
        ("loco", "angry"),
        ("liedown", "neutral"),
    ]
    spans = [time for script in scripts if script.origin for time in (script.origin.start, script.origin.end)]
    assert spans == pytest.approx([time for cue in CUES for time in cue[:2]], abs=0.3)
    assert seen.count("done") == 1
    assert "scenes" in seen
    assert list((service.folder / "uploads").iterdir()) == []


@pytest.mark.sweep
def test_a_worker_that_is_killed_goes_on_and_asks_about_no_scene_twice(film: bytes, tmp_path: Path) -> None:
    """It is killed while the model still looks at the second scene, when the first one is read and stored."""
    killed: list[int] = []
    begun: list[str] = []

    def behave(asked: Asked) -> Sent:
        if "watch scene 2 of" in asked.prompt and not killed:
            with Client(service.url) as other:
                while not (begun and other.extraction(begun[0]).scenes):
                    time.sleep(0.1)
            killed.extend(service.worker_pids())
            os.kill(killed[0], signal.SIGKILL)
        return chat(json.dumps(seen_in(asked.prompt)), asked.path)

    with ModelServer(behave) as server:
        given = {"LLM_MODEL": "openai:gpt-x", "LLM_BASE_URL": server.url, "LLM_API_KEY": KEY, "LLM_CACHE_MB": "0"}
        service = RunningService(tmp_path, environment={f"SIMS_{name}": value for name, value in given.items()})
        with service, Client(service.url) as client:
            begun.append(client.extract(video=io.BytesIO(film)).id)
            done = client.wait_extraction(begun[0], timeout=PATIENCE)
    asked = ["watch" if "You watch" in prompt else "write" for prompt in server.prompts]
    assert sorted(asked[:3]) == ["watch", "watch", "write"]
    assert asked[3:] == ["watch", "write"]
    assert len(killed) == 1
    scripts = [ShortScript.model_validate(row) for row in done.scripts]
    assert [(script.origin.start, script.origin.end) for script in scripts if script.origin] == [
        (0.0, 3.0),
        (7.0, 10.0),
    ]
    assert not any(check(script) for script in scripts)
    assert (done["by"], done["name"]) == ("llm:openai:gpt-x", "film")
    assert list((tmp_path / "uploads").iterdir()) == []
