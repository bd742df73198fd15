"""SIMS stories in Blender 4.2 and later: a theme becomes a furnished home with a body acting in it, as an armature.

One file, nothing else to install: Edit > Preferences > Add-ons > Install from Disk. The work is done by a service
(`sims serve`) at an address that the add-on's preferences name; a thread asks it, so that Blender is free meanwhile.
"""

from __future__ import annotations

import json
import tempfile
import threading
import uuid
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import ProxyHandler, Request, build_opener

import bpy

bl_info = {
    "name": "SIMS stories",
    "author": "SIMS stories",
    "version": (0, 1, 0),
    "blender": (4, 2, 0),
    "location": "3D View > Sidebar > SIMS",
    "description": "Asks a SIMS service for a story and imports its film: home, armature and action",
    "category": "Import-Export",
}

HERE = "http://127.0.0.1:8000"
LOOPBACK = ("localhost", "127.0.0.1", "::1")
TIMEOUT = 60.0
"""Seconds for an answer to begin, and between its parts."""
PAUSE = 0.5
"""Seconds between two looks at a story that is being made."""
LOOK = 0.25
"""Seconds after which the panel is drawn anew."""


class ServiceError(Exception):
    """What went wrong at the service or on the way there, and what helps."""


class Stopped(Exception):  # noqa: N818
    """Whoever asked wants it no more."""


@dataclass(frozen=True)
class Service:
    """A service over HTTP."""

    url: str = HERE
    key: str = ""
    """Empty where none is needed."""

    def tell(self, theme: str, seed: int) -> dict[str, Any]:
        """Have a story made; the story as it is at first."""
        # A key of its own: a second click is a second story.
        return self._json("POST", "/v1/stories", {"theme": theme, "seed": seed}, {"Idempotency-Key": str(uuid.uuid4())})

    def story(self, story_id: str) -> dict[str, Any]:
        """The story as it is now."""
        return self._json("GET", f"/v1/stories/{story_id}")

    def cancel(self, story_id: str) -> dict[str, Any]:
        """Stop a story."""
        return self._json("POST", f"/v1/stories/{story_id}/cancel")

    def film(self, story_id: str) -> bytes:
        """The home and the body acting in it, as GLB."""
        return self._send("GET", f"/v1/stories/{story_id}/film.glb")

    def _json(self, method: str, path: str, body: Any = None, headers: dict[str, str] | None = None) -> dict[str, Any]:
        answer = self._send(method, path, body, headers)
        try:
            found = json.loads(answer)
        except ValueError:
            found = None
        if not isinstance(found, dict):
            raise ServiceError(f"{self.url} is no SIMS service; set its address in the add-on's preferences")
        return found

    def _send(self, method: str, path: str, body: Any = None, headers: dict[str, str] | None = None) -> bytes:
        address = urlsplit(self.url)
        if address.scheme not in ("http", "https") or not address.hostname:
            raise ServiceError(f"the service's address must begin with http:// or https://, not {self.url!r}")
        sent = {"Content-Type": "application/json", **(headers or {})}
        if self.key:
            sent["Authorization"] = f"Bearer {self.key}"
        data = None if body is None else json.dumps(body).encode()
        request = Request(self.url.rstrip("/") + path, data, sent, method=method)
        # A proxy that the environment names cannot reach this very machine.
        opener = build_opener(ProxyHandler({})) if address.hostname in LOOPBACK else build_opener()
        try:
            with opener.open(request, timeout=TIMEOUT) as answer:
                return bytes(answer.read())
        except HTTPError as error:
            with error:
                raise ServiceError(_problem(error.code, error.read())) from error
        except URLError as error:
            if isinstance(error.reason, ConnectionRefusedError):
                remedy = "start it with `sims serve`, or set its address in the add-on's preferences"
                raise ServiceError(f"nothing answers at {self.url}; {remedy}") from error
            raise ServiceError(f"{self.url}: {error.reason}") from error
        except OSError as error:
            raise ServiceError(f"{self.url} broke off: {error}") from error


def _problem(status: int, body: bytes) -> str:
    """What a service refuses, by field where it says which."""
    try:
        told = json.loads(body)
        faults = [f"{fault['pointer'].rpartition('/')[2]}: {fault['detail']}" for fault in told.get("errors") or ()]
        said = "; ".join(faults) or told.get("detail") or told["title"]
    except (ValueError, KeyError, TypeError, AttributeError):
        said = "this was not answered by a SIMS service"
    hint = "; set the key in the add-on's preferences" if status == 401 else ""
    return f"{status}: {said}{hint}"


class Making(threading.Thread):
    """A story on its way: asked for, followed, fetched. Nothing of Blender is touched."""

    def __init__(self, service: Service, theme: str, seed: int, folder: Path) -> None:
        super().__init__(name="sims-story", daemon=True)
        self.service, self.theme, self.seed = service, theme, seed
        self.path = folder / "film.glb"
        """Where the film is once it is there."""
        self.stage, self.share = "asking", 0.0
        """What is being made, and which share of the whole is done."""
        self.story: dict[str, Any] = {}
        self.error = ""
        """Why there is no film."""
        self._stopping = threading.Event()

    def stop(self) -> None:
        """Want it no more."""
        self._stopping.set()

    @property
    def stopped(self) -> bool:
        """Whether it is wanted no more."""
        return self._stopping.is_set()

    def run(self) -> None:
        """All the way to the film, or to the reason why there is none."""
        try:
            self._follow()
            self.stage = "fetching"
            self.path.write_bytes(self.service.film(self.story["id"]))
        except Stopped:
            self.error = "stopped"
        except ServiceError as error:
            self.error = str(error)
        except OSError as error:
            self.error = f"the film cannot be written: {error}"

    def _follow(self) -> None:
        self.story = self.service.tell(self.theme, self.seed)
        while self.story["state"] in ("queued", "running"):
            if self._stopping.wait(PAUSE):
                self.service.cancel(self.story["id"])
                raise Stopped
            self.story = self.service.story(self.story["id"])
            self.stage, self.share = self.story["stage"] or "waiting", self.story["progress"]
        if self.story["state"] != "succeeded":
            failure = self.story["error"] or {}
            raise ServiceError(failure.get("detail") or f"the story was {self.story['state']}")


def bring_in(context: bpy.types.Context, path: Path, story: dict[str, Any], open_above: bool) -> bpy.types.Object:
    """A story's film in a collection of its own, its frames and captions on the timeline; the armature."""
    before = set(bpy.data.objects)
    scene = context.scene
    # A key a frame: at another rate keys would fall between frames.
    scene.render.fps, scene.render.fps_base = 30, 1.0
    bpy.ops.import_scene.gltf(filepath=str(path))
    collection = bpy.data.collections.new(story["title"] or "SIMS story")
    scene.collection.children.link(collection)
    fresh = [one for one in bpy.data.objects if one not in before]
    armature = next(one for one in fresh if one.type == "ARMATURE")
    for one in (armature, *armature.children_recursive):
        for former in list(one.users_collection):
            former.objects.unlink(one)
        collection.objects.link(one)
        if open_above and one.name.partition(".")[0] == "ceiling":
            one.hide_set(True)
    scene.frame_start, scene.frame_end = 0, story["motion"]["frames"] - 1
    for keyframe in story["keyframes"]:
        scene.timeline_markers.new(keyframe["caption"], frame=keyframe["start"])
    scene.frame_set(0)
    return armature


class SimsPreferences(bpy.types.AddonPreferences):
    """Where the service is."""

    bl_idname = __name__

    url: bpy.props.StringProperty(name="Service", default=HERE)  # type: ignore[valid-type]
    key: bpy.props.StringProperty(name="Key", subtype="PASSWORD")  # type: ignore[valid-type]

    def draw(self, _context: bpy.types.Context) -> None:
        """Both fields."""
        self.layout.prop(self, "url")
        self.layout.prop(self, "key")
        self.layout.label(text="A service on this machine needs no key: sims serve")


class SimsStory(bpy.types.PropertyGroup):
    """What is asked for, kept in the file."""

    theme: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Theme", default="A woman comes home tired, reads a book on the sofa and falls asleep."
    )
    seed: bpy.props.IntProperty(name="Seed", min=0, default=0)  # type: ignore[valid-type]
    open_above: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Look in from above", default=True, description="Hide the ceiling in the viewport"
    )


class SIMS_OT_tell(bpy.types.Operator):  # noqa: N801
    """Have the story made by the service, and import its film"""

    bl_idname, bl_label = "sims.tell", "Tell and import"
    making: Making | None = None
    """The one on its way, of whichever operator."""

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        """One at a time."""
        return cls.making is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Ask; without a window, as in a script, wait for it here."""
        chosen, asked = context.preferences.addons[__name__].preferences, context.scene.sims
        self._folder = tempfile.TemporaryDirectory(prefix="sims-")
        making = Making(Service(chosen.url, chosen.key), asked.theme, asked.seed, Path(self._folder.name))
        SIMS_OT_tell.making = making
        making.start()
        if bpy.app.background:
            making.join()
            return self._finish(context, making)
        self._timer = context.window_manager.event_timer_add(LOOK, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Look now and then whether it is there."""
        making = SIMS_OT_tell.making
        if event.type != "TIMER" or making is None:
            return {"PASS_THROUGH"}
        for area in context.screen.areas:
            area.tag_redraw()
        if making.is_alive():
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self._timer)
        return self._finish(context, making)

    def _finish(self, context: bpy.types.Context, making: Making) -> set[str]:
        SIMS_OT_tell.making = None
        try:
            if making.error:
                self.report({"INFO" if making.stopped else "ERROR"}, making.error)
                return {"CANCELLED"}
            bring_in(context, making.path, making.story, context.scene.sims.open_above)
        finally:
            self._folder.cleanup()
        self.report({"INFO"}, f"{making.story['title']}: {making.story['duration']:.0f} s")
        return {"FINISHED"}


class SIMS_OT_stop(bpy.types.Operator):  # noqa: N801
    """Stop the story that is being made"""

    bl_idname, bl_label = "sims.stop", "Stop"

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        """Where there is one."""
        return SIMS_OT_tell.making is not None

    def execute(self, _context: bpy.types.Context) -> set[str]:
        """The thread sees it at its next look."""
        if SIMS_OT_tell.making is not None:
            SIMS_OT_tell.making.stop()
        return {"FINISHED"}


class SIMS_PT_story(bpy.types.Panel):  # noqa: N801
    """The theme, and how far it is"""

    bl_label, bl_category = "SIMS story", "SIMS"
    bl_space_type, bl_region_type = "VIEW_3D", "UI"

    def draw(self, context: bpy.types.Context) -> None:
        """What is asked for, or how far it is."""
        asked, making = context.scene.sims, SIMS_OT_tell.making
        for name in ("theme", "seed", "open_above"):
            self.layout.prop(asked, name)
        self.layout.operator(SIMS_OT_tell.bl_idname)
        if making is not None:
            self.layout.progress(factor=making.share, text=making.stage)
            self.layout.operator(SIMS_OT_stop.bl_idname)


CLASSES = (SimsPreferences, SimsStory, SIMS_OT_tell, SIMS_OT_stop, SIMS_PT_story)


def register() -> None:
    """Switch the add-on on."""
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.sims = bpy.props.PointerProperty(type=SimsStory)


def unregister() -> None:
    """Switch it off; a story that is being made is stopped."""
    if SIMS_OT_tell.making is not None:
        SIMS_OT_tell.making.stop()
    del bpy.types.Scene.sims
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
