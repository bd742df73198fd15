"""What a user does wrong is answered by one clear line and a non-zero exit, and leaves nothing behind."""

from __future__ import annotations

import gzip
import io
import json
import os
import struct
import zipfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from encoded import encoded, lend
from for_each import for_each
from forking import Forked

from planner_service.library.library import Shelves, open_shelves
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.scripts.script import ShortScript
from planner_service.settings import read_settings
from scene_graphs.errors import UserError
from scene_graphs.generation.generate_room import generate_room
from scene_graphs.layout import layout_from_dict, layout_to_dict
from scene_graphs.layout_library import built_in_layouts

ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith("SIMS_")}
THEME = "A person enjoys a relaxed afternoon at home."


def keyframe(**changed: object) -> dict[str, object]:
    return {"skill": "sitdown", "emotion": "neutral", "caption": "sit calmly", "furniture": "sofa"} | changed


def script(**changed: object) -> dict[str, object]:
    row: dict[str, object] = {"id": "my-own", "summary": "The character rests.", "emotion": "relaxed"}
    return row | {"room": "living_room", "keyframes": [keyframe()]} | changed


def room(**changed: object) -> dict[str, Any]:
    return layout_to_dict(generate_room("living_room", 3)) | {"id": "my-room"} | changed


def with_sizes(size: list[object]) -> dict[str, object]:
    row = room()
    objects = [dict(placed) for placed in row["objects"]]
    objects[0]["size"] = size
    return row | {"objects": objects}


def crowded_room() -> dict[str, object]:
    chairs = [
        {"id": f"chair_{i}", "category": "dining_chair", "position": [0, 0, 0], "size": [0.5, 0.9, 0.5]}
        for i in range(10_000)
    ]
    return room(objects=chairs)


def text(value: object) -> bytes:
    return json.dumps(value).encode()


def zipped(data: bytes, files: int = 1) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for number in range(files):
            archive.writestr(f"{number}.json", data)
    return stream.getvalue()


def procthor(**changed: object) -> dict[str, object]:
    """A house of one room with a bed."""
    floor = [{"x": x, "y": 0, "z": z} for x, z in ((0, 0), (0, 3.5), (4, 3.5), (4, 0))]
    bed = {"id": "2|0", "assetId": "Bed_13", "position": {"x": 3.0, "y": 0.45, "z": 2.2}}
    rooms = [{"id": "room|2", "roomType": "Bedroom", "floorPolygon": floor}]
    return {"rooms": rooms, "walls": [], "doors": [], "windows": [], "objects": [bed]} | changed


def bad_files() -> dict[str, bytes]:
    """By name; some are large."""
    return {
        "latin.txt": "A person goes to the café and is very happy.".encode("latin-1"),
        "long.txt": b"A person reads a book. " * 10_000,
        "broken.json": b'[{"id": "x", ',
        "deep.json": b"[" * 100_000,
        "cut.json.gz": gzip.compress(text([room()]) * 9)[:-200],
        "damaged.json.gz": gzip.compress(b"[]")[:10] + b"\xff" * 40,
        "plain.json.gz": text([room()]),
        "bomb.json.gz": gzip.compress(b" " * (80 << 20), 9),
        "latin.json": '[{"id": "café"}]'.encode("latin-1"),
        "number.json": b"7",
        "twice.json.gz": gzip.compress(gzip.compress(b"[]")),
        "bomb.zip": zipped(b"[" + b" " * (100 << 20)),
        "two.zip": zipped(b"[]", files=2),
        "values.json": b"[" + b"[]," * 4_000_000 + b"[]]",
        "turned.json": text(room(id="my\u202eroom")),
        "path.json": text(room(id="../../etc/room")),
        "infinity.json": text(with_sizes([float("inf"), 1.0, 1.0])),
        "digits.json": b'{"id": ' + b"9" * 5000 + b"}",
        "house.jsonl": text(procthor()) + b"\n" + text(procthor()) + b"\n",
        "cut-house.jsonl": text(procthor()) + b"\n" + text(procthor())[:-40],
        "empty-house.json": text(procthor(objects=[])),
        "many-rooms.jsonl": (text(procthor()) + b"\n") * 1_001,
        "lying.glb": b"glTF" + struct.pack("<II", 2, 1 << 31) + bytes(100),
        "lying-chunk.glb": b"glTF" + struct.pack("<IIII", 2, 40, 1 << 31, 0x4E4F534A) + bytes(20),
        "lines.obj": b"\n" * 4_000_001,
        "point.obj": b"v 1 2 three\n",
        "script.obj": b"o <script>alert(1)</script>\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n",
        "page.html": b"<!doctype html><title>scene</title>",
        "nodes.json": text({"graph": {"nodes": [{"category": "sofa", "instance": n} for n in range(1, 1001)]}}),
        "loop-graph.json": text({"nodes": [{"category": "sofa"}], "edges": [[0, 0]]}),
        "same-node.json": text({"nodes": [{"category": "sofa"}] * 2}),
        "scan/scan.aggregation.json": b"{}",
        "scan/scan_vh_clean_2.0.010000.segs.json": text({"segIndices": [0] * 3}),
        "scan/scan_vh_clean_2.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\n"
        b"property float x\nproperty float y\nproperty float z\nend_header\n",
        "none.json": b"[]",
        "corners.json": text(room(floor_polygon=[[0, 0], [4, 0]])),
        "crossed.json": text(room(floor_polygon=[[0, 0], [4, 4], [4, 0], [0, 4]])),
        "field.json": text(room(floor_polygon=[[0, 0], [0, 900], [900, 900], [900, 0]])),
        "nan.json": text(with_sizes([float("nan"), 1.0, 1.0])),
        "huge.json": text(with_sizes([10**400, 1.0, 1.0])),
        "flat.json": text(with_sizes([0.0, 1.0, 1.0])),
        "crowded.json": text(crowded_room()),
        "tags.json": text(room(tags=7)),
        "half-letter.json": text(room(id="room \ud800")),
        "twice.json": text([room(), room()]),
        "ours.json": text(room(id="study-0000")),
        "mixed.json": text([room(id="new-room"), room(id="study-0000")]),
        "five.json": text([room(id=f"room-{i}") for i in range(5)]),
        "broken-script.json": b'{"id": "x", "summary"',
        "deep-script.json": b"[" * 100_000,
        "second-line.jsonl": text(script()) + b'\n{"id": ]\n',
        "latin-script.json": '{"id": "café"}'.encode("latin-1"),
        "skill.json": text(script(keyframes=[keyframe(skill="fly")])),
        "furniture.json": text(script(keyframes=[keyframe(furniture="trampoline")])),
        "extra.json": text(script(mood="blue")),
        "no-keyframes.json": text(script(keyframes=[])),
        "empty.json": b"",
        "list.json": b"[1, 2]",
        "taken.json": text(script(id="mine")),
        "ours-changed.json": text(script(id="insomnia-at-three")),
        "film-script.json": text(script(source="video")),
        "same-twice.jsonl": text(script()) + b"\n" + text(script()) + b"\n",
        "good-then-bad.jsonl": text(script()) + b"\n" + text(script(id="b", keyframes=[keyframe(furniture="ufo")])),
    }


@dataclass(frozen=True)
class Case:
    """A command that must be refused, and words of the refusal; FILES is the folder of `bad_files`."""

    arguments: tuple[str | bytes, ...]
    says: tuple[str, ...]
    settings: tuple[tuple[str, str], ...] = ()


def story(*arguments: str | bytes, says: tuple[str, ...]) -> Case:
    return Case(("story", *arguments), says)


def layout(file: str, *says: str) -> Case:
    return Case(("story", THEME, "--layout", f"FILES/{file}"), says)


def add(file: str, *says: str) -> Case:
    return Case(("scripts", "add", f"FILES/{file}"), says)


def take(file: str, format_name: str, *says: str, more: tuple[str, ...] = ()) -> Case:
    path = file if file.startswith("/") else f"FILES/{file}"
    return Case(("layouts", "import", path, "--format", format_name, *more), says)


def find(file: str, *says: str) -> Case:
    return Case(("layouts", "find", f"FILES/{file}"), says)


def check(file: str, *says: str) -> Case:
    return Case(("scripts", "check", f"FILES/{file}"), says)


CASES: dict[str, Case] = {
    "an empty theme": story("", says=("theme", "empty", "Try")),
    "only spaces": story(" \t \n ", says=("theme", "empty", "Try")),
    "only punctuation": story("... !? --- ...", says=("theme", "no word", "Try")),
    "an enormous theme": story("A person reads a book. " * 4_300, says=("theme", "at most 2000")),
    "a theme that is not UTF-8": story(b"A person \xff\xfe sits", says=("theme", "not text")),
    "a file that is not UTF-8": story("@FILES/latin.txt", says=("theme", "latin.txt", "UTF-8", "byte 24")),
    "an enormous file": story("@FILES/long.txt", says=("theme", "long.txt", "100000 bytes")),
    "a file that is not there": story("@FILES/none.txt", says=("theme", "none.txt", "No such file", "path of a file")),
    "a folder as theme": story("@FILES", says=("theme", "directory")),
    "control characters": story("A person \x1b[31m sits \x07", says=("theme", "control characters")),
    "letters without meaning": story("xqzt wvbnm plkj", says=("theme", "xqzt wvbnm plkj", "Try")),
    "a room misspelt": story(THEME, "--rooms", "bedrom", says=("rooms", "bedrom", "bedroom, living_room")),
    "no room at all": story(THEME, "--rooms", " , ", says=("rooms", "no room", "bedroom")),
    "five rooms": story(
        THEME, "--rooms", "study,bedroom,living_room,dining_room,garage", says=("rooms", "garage", "living_room")
    ),
    "an unknown backend": story(THEME, "--backend", "magic", says=("backend", "magic", "procedural")),
    "a seed below zero": story(THEME, "--seed", "-1", says=("seed", "0")),
    "a seed that is no number": story(THEME, "--seed", "two", says=("seed", "two|integer")),
    "a giant": story(THEME, "--height", "9", says=("height", "1.1 to 2.2", "9")),
    "a height that is no number": story(THEME, "--height", "nan", says=("height", "1.1 to 2.2", "nan")),
    "a character who is not of the cast": story(THEME, "--character", "gandalf", says=("member", "walter")),
    "an outfit that nobody has": story(THEME, "--character", "tom,outfit=armour", says=("outfit", "pyjamas")),
    "an old child": story(THEME, "--character", "mia,age=old", says=("age", "ruth")),
    "a word about nothing": story(THEME, "--character", "hat=red", says=("--character", "hair_color")),
    "unknown pronouns": story(THEME, "--pronouns", "blorp", says=("pronouns", "blorp", "he, she, they")),
    "no name": story(THEME, "--name", "  ", says=("name", "1 to 40")),
    "a name that is not text": story(THEME, "--name", b"S\xffm", says=("name", "printable")),
    "an option that is none": story(THEME, "--colour", "red", says=("--colour",)),
    "a layout that is not there": layout("nowhere.json", "--layout", "nowhere.json", "sims layouts list"),
    "a name longer than any path": story(THEME, "--layout", "x" * 9000, says=("--layout", "neither a file")),
    "a layout that is not JSON": layout("broken.json", "broken.json", "not JSON"),
    "brackets without end": layout("deep.json", "deep.json", "not JSON"),
    "a layout cut off": layout("cut.json.gz", "cut.json.gz", "cut off"),
    "a damaged layout": layout("damaged.json.gz", "damaged.json.gz", "damaged"),
    "a gz that is none": layout("plain.json.gz", "plain.json.gz", "cannot be read"),
    "a gz that unpacks to very much": layout("bomb.json.gz", "bomb.json.gz", "larger than 64 MiB"),
    "a layout that is not UTF-8": layout("latin.json", "latin.json", "UTF-8"),
    "a number for a layout": layout("number.json", "number.json", "must be an object", "floor_polygon"),
    "a file without rooms": layout("none.json", "none.json", "no room"),
    "two corners": layout("corners.json", "floor_polygon", "3 to 400"),
    "walls that cross": layout("crossed.json", "floor_polygon", "simple polygon"),
    "a room as large as a field": layout("field.json", "floor_polygon", "60 by 60"),
    "a size that is no number": layout("nan.json", "objects", "size", "must be a number"),
    "a size beyond all numbers": layout("huge.json", "objects", "size", "between"),
    "a size of nothing": layout("flat.json", "objects", "size", "between"),
    "ten thousand objects": layout("crowded.json", "objects", "at most 500"),
    "tags that are none": layout("tags.json", "tags", "list"),
    "half a letter": layout("half-letter.json", "id", "not text"),
    "two rooms of one id": layout("twice.json", "my-room", "twice"),
    "five rooms in a file": layout("five.json", "--layout", "at most 4", "5"),
    "layouts of the settings not there": Case(
        ("story", THEME), ("nowhere.json", "missing"), (("SIMS_LAYOUTS", "nowhere.json"),)
    ),
    "a script that is not JSON": add("broken-script.json", "broken-script.json:1", "not JSON"),
    "a script of brackets": add("deep-script.json", "deep-script.json", "brackets"),
    "a second line that is not JSON": add("second-line.jsonl", "second-line.jsonl:2", "not JSON"),
    "a script that is not UTF-8": add("latin-script.json", "latin-script.json", "UTF-8", "byte 11"),
    "an unknown skill": add("skill.json", "skill.json", "keyframes.0.skill", "loco (or walk)"),
    "unknown furniture": add("furniture.json", "my-own", "moment 1", "furniture", "trampoline"),
    "a field too many": add("extra.json", "extra.json", "mood", "not permitted"),
    "no keyframes": add("no-keyframes.json", "keyframes", "at least 1"),
    "an empty script file": add("empty.json", "empty.json", "no short script"),
    "numbers for scripts": add("list.json", "list.json", "dictionary|object"),
    "an id that is taken": add("taken.json", "taken.json", "'mine'", "another id"),
    "an id twice in a file": add("same-twice.jsonl", "my-own", "another id"),
    "a bad script behind a good one": add("good-then-bad.jsonl", "ufo"),
    "replacing one of ours": Case(
        ("scripts", "add", "FILES/ours-changed.json", "--replace"), ("ours-changed.json", "another id")
    ),
    "a script of a film without a licence": add("film-script.json", "film-script.json", "licence", "unknown"),
    "exporting into a folder": Case(("scripts", "export", "--out", "FILES/folder.json"), ("--out", "is a folder")),
    "exporting unknown furniture": Case(("scripts", "export", "--furniture", "ufo"), ("furniture", "ufo")),
    "showing a version there is not": Case(("scripts", "show", "mine", "--version", "7"), ("version", "mine")),
    "imitating without a model": Case(
        ("scripts", "imitate", "--emotion", "sad", "--room", "study"), ("SIMS_LLM_MODEL", "rules do not imagine")
    ),
    "a script file that is not there": add("nowhere.json", "FILE", "nowhere.json", "No such file"),
    "a folder of scripts": add("", "cannot be read", "directory"),
    "a data folder that cannot be": Case(
        ("scripts", "add", "FILES/second.json"),
        ("cannot be opened", "SIMS_DATA_DIR"),
        (("SIMS_DATA_DIR", "/dev/null"),),
    ),
    "checking an unknown skill": check("skill.json", "skill.json", "keyframes.0.skill", "loco (or walk)"),
    "checking what is not JSON": check("broken-script.json", "broken-script.json:1", "not JSON"),
    "checking what is not UTF-8": check("latin-script.json", "latin-script.json", "UTF-8"),
    "checking a field too many": check("extra.json", "mood"),
    "searching for nothing": Case(("scripts", "search", " "), ("query", "one word")),
    "searching an unknown emotion": Case(("scripts", "search", "rest", "--emotion", "bored"), ("emotion", "relaxed")),
    "listing an unknown room": Case(("layouts", "list", "--room", "garage"), ("--room", "garage", "study")),
    "drawing an unknown room": Case(("layouts", "draw", "nowhere"), ("nowhere", "sims layouts list")),
    "importing what is not JSON": Case(("layouts", "import", "FILES/broken.json"), ("broken.json", "not JSON")),
    "importing a size of nothing": Case(("layouts", "import", "FILES/flat.json"), ("objects[0].size", "between")),
    "importing an id of ours": Case(("layouts", "import", "FILES/ours.json"), ("study-0000", "another id")),
    "importing a good room before one of ours": Case(("layouts", "import", "FILES/mixed.json"), ("study-0000",)),
    "importing a file without rooms": Case(("layouts", "import", "FILES/none.json"), ("none.json", "no room")),
    "importing a format there is not": take("ours.json", "hologram", "format", "3d-front", "hologram"),
    "importing a file of another format": Case(
        ("layouts", "import", "FILES/house.jsonl"), ("house.jsonl", "room_type", "--format")
    ),
    "importing a page": take("page.html", "procthor", "page.html", "not JSON"),
    "importing what is not there": take("nowhere.glb", "glb", "nowhere.glb", "no such file"),
    "importing a pipe": take("pipe.json", "procthor", "pipe.json", "pipe"),
    "importing a device": take("/dev/zero", "procthor", "zero", "device"),
    "importing a name longer than any": take("x" * 5000, "glb", "too long"),
    "importing a link to itself": take("round.json", "procthor", "round.json", "no such file"),
    "importing a folder as a house": take("scan", "procthor", "scan", "folder"),
    "importing a file packed twice": take("twice.json.gz", "procthor", "twice.json.gz", "packed twice"),
    "importing a zip that unpacks to very much": take("bomb.zip", "procthor", "bomb.zip", "larger than"),
    "importing a zip of two": take("two.zip", "procthor", "two.zip", "zip of 2 files"),
    "importing very many values": take("values.json", "virtualhome", "values.json", "more than 4000000 values"),
    "importing brackets without end": take("deep.json", "3d-front", "deep.json", "not JSON"),
    "importing thousands of digits": take("digits.json", "procthor", "digits.json", "not JSON"),
    "importing an endless size": take("infinity.json", "native", "objects[0].size", "between"),
    "importing an id that turns the line": take("turned.json", "native", "id", "not text"),
    "importing an id that is a path": take("path.json", "native", "../../etc/room", "letters"),
    "importing houses cut off": take("cut-house.jsonl", "procthor", "cut-house.jsonl line 2", "not JSON"),
    "importing a house without furniture": take("empty-house.json", "procthor", "a room without furniture"),
    "importing very many rooms": take("many-rooms.jsonl", "procthor", "more than 1000 rooms", "scan 0-99"),
    "importing a house that is not there": take("house.jsonl", "procthor", "no house", "7", more=("--scan", "7")),
    "importing a scan that is no number": take("house.jsonl", "procthor", "scan", "0-99", more=("--scan", "first")),
    "importing houses as a scene": take("house.jsonl", "glb", "house.jsonl", "glTF|.glb"),
    "importing a house as a house of others": take("empty-house.json", "3d-front", "3D-FRONT house", "scene.room"),
    "importing a house as a flat": take("empty-house.json", "virtualhome", "VirtualHome graph"),
    "importing a house as labels": take("empty-house.json", "3dssg", "segGroups"),
    "importing a length that lies": take("lying.glb", "glb", "cut off", "2147483648"),
    "importing a chunk that lies": take("lying-chunk.glb", "glb", "cut off"),
    "importing millions of lines": take("lines.obj", "obj", "more than 4000000 lines"),
    "importing a point that is none": take("point.obj", "obj", "point.obj line 1", "three"),
    "importing what nobody can name": take("script.obj", "obj", "no furniture we know", "<script>"),
    "importing more points than there are": take("scan", "scannet", "scan_vh_clean_2.ply", "10000000 vertices"),
    "importing a unit of nothing": take("point.obj", "obj", "--unit", more=("--unit", "nan")),
    "finding a thousand pieces": find("nodes.json", "nodes.json", "52"),
    "finding what stands by itself": find("loop-graph.json", "loop-graph.json", "edges"),
    "finding one piece twice": find("same-node.json", "same-node.json", "same piece"),
    "finding a pipe": find("pipe.json", "pipe.json", "no such file"),
    "finding nothing": Case(("layouts", "find", " "), ("no furniture",)),
    "removing a room of ours": Case(("layouts", "remove", "study-0000"), ("study-0000", "cannot be removed")),
    "removing no room": Case(("layouts", "remove", "nowhere"), ("no room", "nowhere")),
    "removing no script": Case(("scripts", "remove", "nothing"), ("no short script", "nothing")),
    "generating none": Case(("layouts", "generate", "--count", "0", "--out", "out/r.json"), ("count",)),
    "generating what no reader knows": Case(("layouts", "generate", "--out", "out/rooms.txt"), ("--out", ".jsonl.gz")),
    "generating into a folder": Case(("layouts", "generate", "--out", "FILES/folder.json"), ("--out", "is a folder")),
    "out is a file": story(THEME, "--out", "FILES/none.json", says=("--out", "none.json", "a file is in the way")),
    "out below a file": story(THEME, "--out", "FILES/none.json/out", says=("--out", "Not a directory")),
    "out where nothing can be made": story(THEME, "--out", "/proc/nope/out", says=("--out", "/proc/nope")),
    "out with too long a name": story(THEME, "--out", "out/" + "x" * 300, says=("--out", "too long")),
    "a folder in the way of a file": story(THEME, "--out", "FILES/taken", says=("--out", "film.glb", "is a folder")),
}


@dataclass(frozen=True)
class Answer:
    """How a command ended, and what lay in its folder afterwards."""

    code: int
    output: str
    error: str
    left: tuple[str, ...]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the bad files, a folder of user's data with one script, and folders where files would go."""
    root = tmp_path_factory.mktemp("bad_input")
    (root / "files/taken/film.glb").mkdir(parents=True)
    (root / "files/folder.json").mkdir()
    for name, data in bad_files().items():
        (root / "files" / name).parent.mkdir(exist_ok=True)
        (root / "files" / name).write_bytes(data)
    lend(root / "data")
    os.mkfifo(root / "files/pipe.json")
    (root / "files/round.json").symlink_to("round.json")
    (root / "files/second.json").write_bytes(text(script(id="second")))
    mine = ShortScript.model_validate(script(id="mine"))
    shelves = own_shelves(root)
    shelves.add_scripts(mine)
    shelves.add_layouts(layout_from_dict(room(id="my-room-kept")))
    return root


def own_shelves(root: Path) -> Shelves:
    """The user's own scripts and rooms."""
    return open_shelves(read_settings(data_dir=root / "data"), writes=True)


def ask(place: Path, case: Case, name: str, forked: Forked) -> Answer:
    folder = place / "runs" / name.replace(" ", "-")
    folder.mkdir(parents=True)
    files = str(place / "files")
    arguments = [a.replace("FILES", files) if isinstance(a, str) else a for a in case.arguments]
    environment = ENVIRONMENT | {"SIMS_DATA_DIR": str(place / "data"), "OMP_NUM_THREADS": "1"} | dict(case.settings)
    code, output, error = forked.run(arguments, folder, environment)
    left = tuple(sorted(str(path.relative_to(folder)) for path in folder.rglob("*")))
    return Answer(code, output.decode(), error.decode(), left)


@pytest.fixture(scope="module")
def before(place: Path) -> dict[object, object]:
    return contents(place)


def contents(root: Path) -> dict[object, object]:
    """Every file, and what is on the user's shelves: the bytes of a database may differ."""
    shelves = own_shelves(root)
    files = [*(root / "files").rglob("*"), *(root / "data").glob("[!cs]*")]
    found: dict[object, object] = {path: path.read_bytes() if path.is_file() else b"" for path in files}
    found |= {script.id: script for script in shelves.scripts().scripts}
    found |= shelves.rooms().items()
    return found


@pytest.fixture(scope="module")
def answers(place: Path, before: dict[object, object]) -> dict[str, Answer]:
    """Every command, two at a time."""
    assert before
    with ExitStack() as stack, ThreadPoolExecutor(2) as pool:
        first, second = (stack.enter_context(Forked()) for _ in range(2))
        names = list(CASES)
        halves = [(forked, names[start::2]) for start, forked in enumerate((first, second))]
        asked = pool.map(lambda half: {name: ask(place, CASES[name], name, half[0]) for name in half[1]}, halves)
        return {name: answer for half in asked for name, answer in half.items()}


@pytest.mark.service
@for_each("name", CASES)
def test_a_mistake_is_answered_by_one_line_that_names_it(name: str, answers: dict[str, Answer]) -> None:
    answer = answers[name]
    assert answer.code == 2, answer
    assert "Traceback" not in answer.error + answer.output
    lines = answer.error.strip().splitlines()
    said = lines[-1]
    assert said.startswith(("sims: ", "Error: ")), answer.error
    assert len(lines) == 1 or lines[0].startswith("Usage: "), answer.error
    for words in CASES[name].says:
        assert any(word in said for word in words.split("|")), f"{words!r} is not said: {said}"
    assert len(said) < 700


@pytest.mark.service
@for_each("name", CASES)
def test_a_mistake_leaves_no_file_behind(name: str, answers: dict[str, Answer]) -> None:
    assert answers[name].left == ()


@pytest.mark.service
def test_a_mistake_changes_no_file_of_the_user(answers: dict[str, Answer], place: Path, before) -> None:
    assert len(answers) == len(CASES)
    assert contents(place) == before


def test_a_fault_of_ours_is_not_taken_for_a_mistake_of_the_user() -> None:
    for fault in (ValueError, TypeError, KeyError, OSError, RuntimeError, AssertionError, UnicodeError, IndexError):
        assert not issubclass(fault, UserError)


@for_each(
    ("field", "changed"),
    [
        ("rooms", {"rooms": ("attic",)}),
        ("backend", {"backend": "magic"}),
        ("method", {"method": "guessing"}),
        ("short_scripts", {"short_scripts": 13}),
        ("seed", {"seed": -1}),
        ("layout", {"layouts": (1, 1)}),
        ("layout", {"layouts": range(5)}),
    ],
)
def test_a_request_names_the_field_that_is_out_of_bounds(field: str, changed: dict[str, Any]) -> None:
    if "layouts" in changed:
        changed = {"layouts": tuple(generate_room("study", seed) for seed in changed["layouts"])}
    with pytest.raises(UserError, match=f"^{field}: "):
        StoryRequest(THEME, **changed)


def test_furniture_of_another_kind_stands_in_and_this_is_said() -> None:
    # A room that serves as no other kind, so that nothing else is played in it.
    lounges = (room for room in built_in_layouts() if room.tags == ("living_room",))
    given = next(room for room in lounges if any(placed.category == "armchair" for placed in room.objects))
    seats = [placed for placed in given.objects if placed.category == "armchair"]
    changed = tuple(replace(placed, category="lounge_chair") if placed in seats else placed for placed in given.objects)
    request = StoryRequest("A person sits down on the armchair.", layouts=(replace(given, objects=changed),))
    planned = Pipeline(Shelves(cache=encoded())).plan(request)
    assert "armchair → lounge chair (class)" in " ".join(planned.stage.explain())
    assert planned.stage.rooms_to_dicts()[0]["substitutions"]
