"""A film as USD is read back by USD's own library: axes, units, time, and the body where our own skinning has it."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from acted import SMALL, sat

from motion_backend.body.cast import PLAIN, Role
from motion_backend.body.character_mesh import build_character
from motion_backend.body.face_track import face_track
from motion_backend.body.skinning import skin
from motion_backend.formats import usd_film
from motion_backend.formats.usd_film import UsdUnavailableError, film_usd, joint_paths
from motion_backend.motion import Emotion, Motion, Skill
from motion_backend.props import PropTrack
from motion_backend.rotations import IDENTITY

pxr = pytest.importorskip("pxr")
FRAMES = (0, 17, 59)
SAD = Role(emotions={0: Emotion.SAD})


@cache
def acted() -> Motion:
    return sat("sofa", "sit").motion.part(0, 60)


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Any:
    from pxr import Usd

    path = tmp_path_factory.mktemp("usd") / "film.usd"
    path.write_bytes(film_usd(SMALL, acted(), SAD))
    return Usd.Stage.Open(str(path))


def test_it_is_y_up_in_metres_with_a_time_code_a_frame(stage: Any) -> None:
    from pxr import UsdGeom

    assert UsdGeom.GetStageUpAxis(stage) == "Y"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert (stage.GetTimeCodesPerSecond(), stage.GetFramesPerSecond()) == (30, 30)
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, len(acted()) - 1)
    assert str(stage.GetDefaultPrim().GetPath()) == "/Film"


def test_every_joint_is_where_the_motion_has_it(stage: Any) -> None:
    from pxr import UsdSkel

    skeleton = UsdSkel.Skeleton(stage.GetPrimAtPath("/Film/Body/Skeleton"))
    query = UsdSkel.Cache().GetSkelQuery(skeleton)
    assert query
    assert query.HasBindPose()
    assert list(query.GetJointOrder()) == joint_paths(acted().skeleton)
    expected = acted().joint_positions()
    for frame in FRAMES:
        found = [tuple(one.ExtractTranslation()) for one in query.ComputeJointSkelTransforms(frame)]
        assert np.abs(np.array(found) - expected[frame]).max() < 1e-4


def test_the_skin_moves_as_ours_does_with_its_face(stage: Any) -> None:
    from pxr import Usd, UsdGeom, UsdSkel

    root = UsdSkel.Root(stage.GetPrimAtPath("/Film/Body"))
    assert UsdSkel.BakeSkinning(root, pxr.Gf.Interval(0, len(acted()) - 1))
    mesh = build_character(acted().skeleton, SAD.look)
    track = face_track(acted(), SAD)
    meshes = [UsdGeom.Mesh(one) for one in root.GetPrim().GetChildren() if one.IsA(UsdGeom.Mesh)]
    counted = sum(len(one.GetFaceVertexCountsAttr().Get()) for one in meshes)
    assert counted == len(mesh.faces)
    for frame in FRAMES:
        chosen = slice(frame, frame + 1)
        ours, _ = skin(
            mesh, acted().skeleton, acted().root_positions[chosen], acted().local_rotations[chosen], track[chosen]
        )
        for one in meshes:
            index = int(one.GetPrim().GetName().rpartition("_")[2])
            used = np.unique(mesh.faces[mesh.face_materials == index])
            theirs = np.array(one.GetPointsAttr().Get(Usd.TimeCode(frame)))
            assert np.abs(theirs - ours[0, used]).max() < 2e-3


def test_the_home_is_there_with_all_its_groups_and_every_mesh_has_a_look(stage: Any) -> None:
    from pxr import UsdGeom, UsdShade

    groups = {one.GetName() for one in stage.GetPrimAtPath("/Film/Home").GetChildren()}
    assert {"floor", "wall", "furniture"} <= groups
    meshes = [one for one in stage.Traverse() if one.IsA(UsdGeom.Mesh)]
    assert all(UsdShade.MaterialBindingAPI(one).ComputeBoundMaterial()[0] for one in meshes)
    bound = UsdGeom.BBoxCache(0, ["default"]).ComputeWorldBound(stage.GetPrimAtPath("/Film/Home"))
    assert abs(bound.ComputeAlignedRange().GetMin()[1]) < 0.05, "it stands on the floor"


def test_what_is_in_the_hands_is_where_its_track_has_it(tmp_path: Path) -> None:
    from pxr import Usd, UsdGeom

    motion = acted()
    role = Role(captions={int(key): (Skill.SITDOWN, "crossing arms") for key in np.unique(motion.actions)})
    path = tmp_path / "none.usd"
    path.write_bytes(film_usd(None, motion, role))
    assert not Usd.Stage.Open(str(path)).GetPrimAtPath("/Film/Props")
    track = PropTrack("cup", 5, np.arange(60.0).reshape(20, 3), np.tile(IDENTITY, (20, 1)), np.linspace(0.05, 1, 20))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(usd_film, "prop_tracks", lambda *_: (track,))
        (tmp_path / "cup.usd").write_bytes(film_usd(None, motion, role))
    opened = Usd.Stage.Open(str(tmp_path / "cup.usd"))
    cup = UsdGeom.Xformable(opened.GetPrimAtPath("/Film/Props/cup_0"))
    for frame, size in ((0, 0.0), (5, 0.05), (24, 1.0), (40, 0.0)):
        matrix = np.array(cup.GetLocalTransformation(Usd.TimeCode(frame)))
        np.testing.assert_allclose(matrix[:3, :3], size * np.eye(3), atol=1e-5)
        if size:
            np.testing.assert_allclose(matrix[3, :3], track.positions[frame - 5], atol=1e-5)


def test_equal_films_give_equal_bytes() -> None:
    assert film_usd(SMALL, acted(), SAD) == film_usd(SMALL, acted(), SAD)


def test_a_body_alone_has_no_home(tmp_path: Path) -> None:
    from pxr import Usd

    path = tmp_path / "body.usd"
    path.write_bytes(film_usd(None, acted().part(0, 2), PLAIN))
    alone = Usd.Stage.Open(str(path))
    assert not alone.GetPrimAtPath("/Film/Home")
    assert alone.GetPrimAtPath("/Film/Body/Skeleton/Motion")


def test_without_the_library_one_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(usd_film, "find_spec", lambda _: None)
    with pytest.raises(UsdUnavailableError, match="not installed") as told:
        film_usd(SMALL, acted(), PLAIN)
    assert "sims-stories[usd]" in told.value.remedy
