"""A film as USD: the home and the skinned, animated character, in the binary form that every USD tool opens.

Y up, metres, a time code a frame. The body is a UsdSkel skeleton with its animation and skinned meshes; what the face
does are blend shapes. Written by usd-core, an extra that is loaded late.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.cast import PLAIN, Role
from motion_backend.body.character_mesh import build_character
from motion_backend.body.face_track import face_track
from motion_backend.body.skinning import SkinnedMesh
from motion_backend.formats.glb_film import StaticMesh, groups_of, home_meshes_of, merged
from motion_backend.formats.glb_props import ROUGHNESS, lanes, of_one_color, prop_keys
from motion_backend.motion import Motion
from motion_backend.props import prop_tracks
from motion_backend.skeleton import Skeleton
from scene_graphs.errors import UserError

if TYPE_CHECKING:
    from scene_graphs.home import Home

ROOT: Final = "/Film"
Floats = NDArray[np.floating]


class UsdUnavailableError(UserError):
    """No USD can be written here; says what is missing."""


def check_usd() -> None:
    """UsdUnavailableError where the library that writes USD is not installed; nothing is loaded."""
    if find_spec("pxr") is None:
        raise UsdUnavailableError(
            "writing film.usd needs a library that is not installed", 'pip install "sims-stories[usd]"', at="--usd"
        )


def film_usd(home: Home | None, motion: Motion, role: Role = PLAIN) -> bytes:
    """The home, if there is one, and the character acting in it, with what is in the hands, in one file.

    UsdUnavailableError.
    """
    check_usd()
    from pxr import Usd, UsdGeom

    with tempfile.TemporaryDirectory(prefix="sims-usd-") as folder:
        path = Path(folder) / "film.usdc"
        stage = Usd.Stage.CreateNew(str(path))
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        stage.SetTimeCodesPerSecond(motion.fps)
        stage.SetFramesPerSecond(motion.fps)
        stage.SetStartTimeCode(0)
        stage.SetEndTimeCode(max(len(motion) - 1, 0))
        film = UsdGeom.Xform.Define(stage, ROOT)
        stage.SetDefaultPrim(film.GetPrim())
        if home is not None:
            UsdGeom.Xform.Define(stage, f"{ROOT}/Home")
            _add_home(stage, home_meshes_of(home, role))
        _add_body(stage, motion, role)
        _add_props(stage, motion, role)
        stage.GetRootLayer().Save()
        del stage
        return path.read_bytes()


def _add_home(stage: Any, meshes: Iterable[StaticMesh]) -> None:
    """A mesh a group and look, as in the GLB."""
    from pxr import UsdGeom

    for group, looks in groups_of(meshes).items():
        UsdGeom.Xform.Define(stage, f"{ROOT}/Home/{group}")
        for number, ((color, roughness), members) in enumerate(looks.items()):
            vertices, faces = merged(members)
            path = f"{ROOT}/Home/{group}/{_token(members[0].name)}_{number}"
            mesh = _mesh(stage, path, vertices, faces)
            _bind(stage, mesh, color, roughness)


def _add_body(stage: Any, motion: Motion, role: Role) -> None:
    from pxr import Sdf, UsdSkel

    body = UsdSkel.Root.Define(stage, f"{ROOT}/Body")
    mesh = build_character(motion.skeleton, role.look)
    names = joint_paths(motion.skeleton)
    skeleton = UsdSkel.Skeleton.Define(stage, f"{ROOT}/Body/Skeleton")
    rest = motion.skeleton.rest_positions
    skeleton.CreateJointsAttr(names)
    skeleton.CreateBindTransformsAttr([_moved(place) for place in rest])
    skeleton.CreateRestTransformsAttr([_moved(offset) for offset in motion.skeleton.offsets])
    animation = _add_animation(stage, motion, names)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([animation.GetPath()])
    units = _add_meshes(stage, mesh, skeleton)
    if units:
        assert mesh.morphs is not None
        track = np.clip(face_track(motion, role), -1, 1).astype(np.float32)
        animation.CreateBlendShapesAttr(list(mesh.morphs.names))
        weights = animation.CreateBlendShapeWeightsAttr()
        for frame, row in enumerate(track):
            weights.Set(row.tolist(), frame)
    way = motion.root_positions
    low, high = way.min(axis=0) - 1.5 * motion.skeleton.scale, way.max(axis=0) + 1.5 * motion.skeleton.scale
    body.GetPrim().CreateAttribute("extentsHint", Sdf.ValueTypeNames.Float3Array).Set([low.tolist(), high.tolist()])


def joint_paths(skeleton: Skeleton) -> list[str]:
    """What USD calls each joint: the way to it from the root, "pelvis/left_hip"."""
    paths: list[str] = []
    for name, parent in zip(skeleton.names, skeleton.parents, strict=True):
        paths.append(name if parent < 0 else f"{paths[parent]}/{name}")
    return paths


def _add_animation(stage: Any, motion: Motion, names: Sequence[str]) -> Any:
    """Every frame a time code: where the pelvis is, and the turn of every joint."""
    from pxr import Gf, UsdSkel, Vt

    animation = UsdSkel.Animation.Define(stage, f"{ROOT}/Body/Skeleton/Motion")
    animation.CreateJointsAttr(list(names))
    animation.CreateScalesAttr(Vt.Vec3hArray([Gf.Vec3h(1, 1, 1)] * len(names)))
    places, turns = animation.CreateTranslationsAttr(), animation.CreateRotationsAttr()
    offsets = np.asarray(motion.skeleton.offsets, dtype=np.float32)
    quats = rotations.continuous(rotations.normalize(motion.local_rotations.astype(np.float64)))
    for frame, (root, pose) in enumerate(zip(motion.root_positions, quats.tolist(), strict=True)):
        local = offsets.copy()
        local[0] = root
        places.Set(Vt.Vec3fArray.FromNumpy(local), frame)
        turns.Set(Vt.QuatfArray([Gf.Quatf(w, x, y, z) for x, y, z, w in pose]), frame)
    return animation


def _add_meshes(stage: Any, mesh: SkinnedMesh, skeleton: Any) -> bool:
    """A skinned mesh a look; whether any of it is moved by what the face does."""
    from pxr import Gf, UsdSkel, Vt

    any_face = False
    for index, look in enumerate(mesh.materials):
        used, faces = np.unique(mesh.faces[mesh.face_materials == index], return_inverse=True)
        if not len(used):
            continue
        path = f"{ROOT}/Body/{_token(look.name)}_{index}"
        made = _mesh(stage, path, mesh.vertices[used], faces.reshape(-1, 3), mesh.normals[used])
        _bind(stage, made, look.color, look.roughness)
        binding = UsdSkel.BindingAPI.Apply(made.GetPrim())
        binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
        binding.CreateJointIndicesPrimvar(False, 4).Set(Vt.IntArray(mesh.joints[used].reshape(-1).tolist()))
        binding.CreateJointWeightsPrimvar(False, 4).Set(
            Vt.FloatArray.FromNumpy(np.ascontiguousarray(mesh.weights[used], dtype=np.float32).reshape(-1))
        )
        binding.CreateGeomBindTransformAttr().Set(Gf.Matrix4d(1.0))
        any_face = _add_shapes(stage, mesh, used, path, binding) or any_face
    return any_face


def _add_props(stage: Any, motion: Motion, role: Role) -> None:
    """What is in the hands: an Xform a prop, as the GLB's nodes: of no size where it is not there."""
    from pxr import Gf, UsdGeom

    rows = lanes(prop_tracks(motion, role))
    if rows:
        UsdGeom.Xform.Define(stage, f"{ROOT}/Props")
    for number, lane in enumerate(rows):
        name = lane[0].prop
        path = f"{ROOT}/Props/{_token(name)}_{number}"
        prop = UsdGeom.Xform.Define(stage, path)
        place, turn, scale = prop.AddTranslateOp(), prop.AddOrientOp(), prop.AddScaleOp()
        keys = (column.tolist() for column in prop_keys(lane, len(motion)))
        for frame, position, (x, y, z, w), size in zip(*keys, strict=True):
            place.Set(Gf.Vec3d(*position), frame)
            turn.Set(Gf.Quatf(w, x, y, z), frame)
            scale.Set(Gf.Vec3f(size), frame)
        for look, (color, corners) in enumerate(of_one_color(lane[0].shape)):
            faces = np.arange(len(corners)).reshape(-1, 3)
            _bind(stage, _mesh(stage, f"{path}/{_token(name)}_{look}", corners, faces), color, ROUGHNESS)


def _add_shapes(stage: Any, mesh: SkinnedMesh, used: NDArray[np.integer], path: str, binding: Any) -> bool:
    """What moves some of these vertices, by unit of the face; whether anything does."""
    from pxr import UsdSkel, Vt

    if mesh.morphs is None or not (used >= mesh.morphs.first).any():
        return False
    moved = np.flatnonzero(used >= mesh.morphs.first)
    offsets = mesh.morphs.offsets[:, used[moved] - mesh.morphs.first]  # (K, N, 3)
    names, targets = [], []
    for name, unit in zip(mesh.morphs.names, offsets, strict=True):
        some = np.flatnonzero(np.any(unit != 0, axis=1))
        if not len(some):
            continue
        shape = UsdSkel.BlendShape.Define(stage, f"{path}/{name}")
        shape.CreateOffsetsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(unit[some], dtype=np.float32)))
        shape.CreatePointIndicesAttr(moved[some].tolist())
        names.append(name)
        targets.append(shape.GetPath())
    binding.CreateBlendShapesAttr(names)
    binding.CreateBlendShapeTargetsRel().SetTargets(targets)
    return bool(names)


def _mesh(stage: Any, path: str, vertices: Floats, faces: NDArray[np.integer], normals: Floats | None = None) -> Any:
    """Triangles (F, 3) of vertices (V, 3); flat unless there are normals (V, 3)."""
    from pxr import UsdGeom, Vt

    points = np.ascontiguousarray(vertices, dtype=np.float32)
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexCountsAttr([3] * len(faces))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray(faces.reshape(-1).tolist()))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateExtentAttr([points.min(axis=0).tolist(), points.max(axis=0).tolist()])
    if normals is not None:
        mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(normals, dtype=np.float32)))
        mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    return mesh


def _bind(stage: Any, mesh: Any, color: Sequence[float], roughness: float) -> None:
    """A look of that colour (sRGB, with or without alpha), beside the mesh; brighter than 1 it shines."""
    from pxr import Gf, Sdf, UsdShade

    path = f"{mesh.GetPath()}/Look"
    red, green, blue = (float(v) for v in np.minimum(_linear(np.asarray(color[:3], dtype=np.float64)), 1.0))
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(red, green, blue))
    if max(color[:3]) > 1:
        shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(red, green, blue))
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(float(roughness))
    shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(float(color[3]) if len(color) > 3 else 1.0)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    mesh.CreateDisplayColorAttr([Gf.Vec3f(red, green, blue)])


def _linear(color: Floats) -> Floats:
    """Of sRGB, 0 to 1."""
    return np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)


def _moved(place: Floats) -> Any:
    from pxr import Gf

    return Gf.Matrix4d().SetTranslate(Gf.Vec3d(*(float(v) for v in place)))


def _token(name: str) -> str:
    """A name as USD allows it."""
    kept = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in name)
    return kept if kept[:1].isalpha() else f"_{kept}"
