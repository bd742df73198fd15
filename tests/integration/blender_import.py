"""Run by a Python that has bpy, as a user would by mouse: install the add-on, ask for a story, look at what came.

`python blender_import.py ADD_ON URL THEME FRAMES…` prints a line of JSON.
"""

from __future__ import annotations

import json
import sys

import bpy


def main(add_on: str, url: str, theme: str, *frames: str) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_install(filepath=add_on)
    bpy.ops.preferences.addon_enable(module="sims_stories")
    bpy.context.preferences.addons["sims_stories"].preferences.url = url
    scene = bpy.context.scene
    scene.sims.theme, scene.sims.seed = theme, 3
    error = ""
    try:
        bpy.ops.sims.tell()
    except RuntimeError as refused:
        error = str(refused)
    armatures = [one for one in bpy.data.objects if one.type == "ARMATURE"]
    found: dict[str, object] = {"error": error, "armatures": [one.name for one in armatures]}
    if armatures:
        found |= seen(armatures[0], [int(frame) for frame in frames])
    bpy.ops.preferences.addon_disable(module="sims_stories")
    sys.stdout.write("\n" + json.dumps(found | {"left": hasattr(bpy.types.Scene, "sims")}) + "\n")


def seen(armature: bpy.types.Object, frames: list[int]) -> dict[str, object]:
    scene, action = bpy.context.scene, armature.animation_data.action
    heads = {}
    for frame in frames:
        scene.frame_set(frame)
        heads[frame] = {bone.name: list(armature.matrix_world @ bone.head) for bone in armature.pose.bones}
    return {
        "fps": scene.render.fps / scene.render.fps_base,
        "frames": [scene.frame_start, scene.frame_end],
        "action": action.name,
        "keys": list(action.frame_range),
        "meshes": sorted(one.name for one in armature.children_recursive if one.type == "MESH"),
        "collections": sorted(one.name for one in armature.users_collection),
        "hidden": sorted(one.name for one in armature.children_recursive if one.hide_get()),
        "markers": [[one.name, one.frame] for one in scene.timeline_markers],
        "heads": heads,
    }


if __name__ == "__main__":
    main(*sys.argv[1:])
