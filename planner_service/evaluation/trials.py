"""One caption acted in one room by one seed, as a story would have it, and judged: a trial of the body.

A trial is a short script of its own. A contact begins with a walk from a random standing place 1 to 5 m away (as in
InterScene), a rise with sitting or lying down, a walk with another walk, so that there is a direction to come from.
"""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import islice
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.backend_protocol import BodyState
from motion_backend.body.cast import Role, acted_captions
from motion_backend.body.joint_limits import worst_joint
from motion_backend.body.scene_collision import Obstacles
from motion_backend.body.self_collision import deepest_pair
from motion_backend.director import Director
from motion_backend.emotion_words import emotion_of
from motion_backend.metrics import story_metrics
from motion_backend.metrics.caption_predicates import judge_caption
from motion_backend.metrics.joint_speed import fastest_joint
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.skin_penetration import THIN, skin_penetration
from motion_backend.metrics.smoothness import bone_deviation, jerk_against_real, seam_jump, seam_speed_jump
from motion_backend.motion import FPS, Action, Character, Emotion, Motion, Skill, join
from motion_backend.procedural.touch.hand_captions import handling_of
from motion_backend.procedural.touch.hand_contacts import ON_TOPS, is_top
from motion_backend.scene import scene_of
from planner_service.grounding.keyframes_to_actions import Place, UnreachableError, act, can_stand, height_of
from planner_service.scripts.caption_actions import look_of
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_words import NEEDS
from scene_graphs import furniture
from scene_graphs.affordances.affordances import Spot, spots
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Placed
from scene_graphs.layout_library import built_in_index
from scene_graphs.meshes.convex_shapes import ConvexShape, convex_shapes
from scene_graphs.navigation.path_planner import NoPath, Walkable

FLOOR: Final = "floor"
WALK: Final = Keyframe(skill=Skill.LOCO, emotion="neutral", caption="smoothly forward walk", furniture=FLOOR)
REST: Final = {Skill.STANDUP: (Skill.SITDOWN, "sitting still"), Skill.GETUP: (Skill.LIEDOWN, "lying still")}
"""What a body does before it rises."""
AWAY: Final = (1.0, 5.0)
"""How far from the standing point a trial begins (metres)."""
MIN_WALKING_ROOM: Final = 2.5
"""A room is for walking if one can walk at least this far in it (metres)."""
AHEAD: Final = (0.4, 0.7, 1.0)
"""A table over a point this far before the sitter (metres) is the seat's: chairs stand back from theirs."""
_AT_TABLE: Final = re.compile(r"\b(?:table|keyboard|keys|typing|writing|eating)\b", re.IGNORECASE)
_ARMRESTS: Final = re.compile(r"\barmrests?\b", re.IGNORECASE)
_HEIGHT: Final = re.compile(r"\b(?:low|medium|high)\b", re.IGNORECASE)
_ON_FLOOR: Final = re.compile(r"\bhands on floor\b|\bprone\b", re.IGNORECASE)
_IN_CHAIR: Final = re.compile(r"\bchair\b", re.IGNORECASE)
_ON_EDGE: Final = re.compile(r"\bfoot on the floor\b", re.IGNORECASE)
_CHAIRS: Final = frozenset({"dining_chair", "armchair", "office_chair", "lounge_chair", "dressing_chair"})
_WITH_ARMRESTS: Final = frozenset({"armchair", "multi_seat_sofa", "loveseat_sofa", "l_shaped_sofa"})

_SAT_ON: Final = frozenset({"seat", "sofa"})
_HUNG: Final = frozenset({"pendant_lamp", "ceiling_lamp", "wall_lamp"})
_KNOCKED_ON: Final = frozenset({"table", "side", "closet", "shelf", "appliance"})
_ON_TOPS: Final = ON_TOPS | {"wash"}


@dataclass(frozen=True, order=True)
class Trial:
    """What is acted, in which room of the library, with which seed."""

    skill: Skill
    caption: str
    room: str
    seed: int


@dataclass(frozen=True)
class Setting:
    """A room of the library as a home, with what is worked out about it once."""

    home: Home
    walkable: Walkable
    obstacles: Obstacles
    director: Director

    @cached_property
    def shapes(self) -> tuple[ConvexShape, ...]:
        """Walls and furniture as they are drawn, but what is thin."""
        return convex_shapes(self.home, THIN)

    @cached_property
    def longest_walk(self) -> float:
        """How far apart some places of the room are that one can walk between (metres)."""
        rng = np.random.default_rng(0)
        points = np.array([self.walkable.random_point(rng, 0) for _ in range(12)])
        return float(np.linalg.norm(points[:, None] - points[None], axis=-1).max())

    @cached_property
    def reachable(self) -> dict[str, tuple[tuple[Placed, tuple[Spot, ...]], ...]]:
        """By "sit", "lie" and "touch": every piece, but decoration, with its spots that can be walked to."""
        start = self.walkable.random_point(np.random.default_rng(0), 0)
        pieces = [placed for placed in self.home.objects if furniture.group_of(placed.category) != "decor"]
        found = {
            need: [
                (placed, tuple(spot for spot in spots(placed, need) if can_stand(self.walkable, start, spot)))
                for placed in pieces
            ]
            for need in NEEDS.values()
        }
        return {need: tuple((placed, free) for placed, free in some if free) for need, some in found.items()}


@dataclass(frozen=True)
class Performance:
    """A trial that was acted: what the body was told, what it did, and how well."""

    trial: Trial
    home: Home
    keyframes: tuple[Keyframe, ...]
    actions: tuple[Action, ...]
    motions: tuple[Motion, ...]
    figures: story_metrics.KeyframeFigures
    """Of the last action, which is the trial's own."""
    besides: dict[str, float | str | None]
    """Jumps of place (m) and speed (m/s) where it begins, how much bones change their length (m), the jerk of a
    walk against that of recorded ones, the joint farthest beyond its range and the parts deepest in each other."""

    @property
    def motion(self) -> Motion:
        """What is judged."""
        return self.motions[-1]

    @property
    def role(self) -> Role:
        """Nobody in particular, with what the captions have in the hands."""
        return Role(captions=acted_captions(self.actions))

    @property
    def object_id(self) -> str:
        """What the body used."""
        return self.actions[-1].object_id or FLOOR

    def to_dict(self) -> dict[str, Any]:
        """Everything that was measured, with what is needed to act it again."""
        acted = self.actions[-1].caption
        about = {
            "skill": self.trial.skill.value, "caption": self.trial.caption,
            "performed_as": acted if acted != look_of(self.trial.caption) else None, "room": self.trial.room,
            "notes": [note.words for note in self.motion.notes], "seed": self.trial.seed, "object": self.object_id,
        }  # fmt: skip
        own = {name: value for name, value in self.figures.to_dict().items() if name not in ("keyframe", "skill")}
        besides = {name: round(one, 5) if isinstance(one, float) else one for name, one in self.besides.items()}
        return about | own | besides


@lru_cache(maxsize=8)
def setting(room: str) -> Setting:
    """The library's room of that id. Raises LayoutError where there is none."""
    home = home_from_layouts([built_in_index().layout(room)], 0)
    scene = scene_of(home)
    return Setting(home, scene.walkable, scene.obstacles, Director.of("procedural"))


def places_for(skill: Skill, caption: str, where: Setting) -> tuple[str, ...]:
    """Ids of the pieces a caption can be acted at, `FLOOR` among them where it can be acted there; in the room's order.

    What the words ask for is there: a table before the seat, armrests, a height to reach to.
    """
    if skill is Skill.LOCO:
        return (FLOOR,) if where.longest_walk >= MIN_WALKING_ROOM else ()
    skill, caption = REST.get(skill, (skill, caption))
    need = NEEDS[skill]
    if need == "sit" and _ON_FLOOR.search(caption):
        return (FLOOR,)
    found = [
        placed.id
        for placed, free in where.reachable[need]
        if any(_serves(caption, need, placed, spot, where.home) for spot in free)
    ]
    bound = need == "touch" or any(words.search(caption) for words in (_AT_TABLE, _ARMRESTS, _IN_CHAIR, _ON_EDGE))
    return tuple(found) if bound else (*found, FLOOR)


def _serves(caption: str, need: str, placed: Placed, spot: Spot, home: Home) -> bool:
    """Whether a spot has what the words of a caption ask for."""
    if need == "touch":
        return _handled(caption, placed, spot) and (spot.height == height_of(caption) or not _HEIGHT.search(caption))
    if need == "lie":
        return True
    if _AT_TABLE.search(caption):
        return _table_before(spot, home)
    if _ARMRESTS.search(caption):
        return placed.category in _WITH_ARMRESTS
    return placed.category in _CHAIRS if _IN_CHAIR.search(caption) else True


def _handled(caption: str, placed: Placed, spot: Spot) -> bool:
    """Whether what hands do in a caption is done at such a piece: nobody washes a chair, turns a ceiling lamp, stirs on a
    mattress or knocks on a screen."""
    doing, kind = handling_of(caption), furniture.class_of(placed.category)
    if doing and (kind in _SAT_ON or placed.category in _HUNG):
        return False
    if doing not in ("", "pick", "put") and kind == "bed":
        return False
    if doing == "knock" and (kind not in _KNOCKED_ON or spot.height == "low"):
        return False
    return is_top(spot.normal) if doing in _ON_TOPS else True


def _table_before(spot: Spot, home: Home) -> bool:
    ahead = np.array([np.sin(spot.facing), np.cos(spot.facing)])
    points = np.array(spot.point)[[0, 2]] + np.outer(AHEAD, ahead)
    tables = [placed for placed in home.objects if furniture.class_of(placed.category) == "table"]
    return any(_over(placed, point) for placed in tables if placed.id != spot.object_id for point in points)


def _over(placed: Placed, point: NDArray[np.float64]) -> bool:
    """Whether a point of the floor is under a piece."""
    x, z = point[0] - placed.position[0], point[1] - placed.position[2]
    cos, sin = np.cos(placed.yaw), np.sin(placed.yaw)
    return bool(abs(cos * x - sin * z) <= placed.size[0] / 2 and abs(sin * x + cos * z) <= placed.size[2] / 2)


def perform(trial: Trial, director: Director | None = None) -> Performance:
    """Act one trial and judge it; its own action by another director, what leads up to it always kinematically.

    Raises UnreachableError or NoPath where its room has no place for it.
    """
    where, (keyframes, actions, motions) = setting(trial.room), act_trial(trial, director)
    motion, led = motions[-1], motions[:-1]
    figures = story_metrics.judge(motion, actions[-1], where.obstacles)
    around, body = join([led[-1].part(max(len(led[-1]) - FPS, 0), len(led[-1])), motion]), Kinematics.of(motion)
    joint, beyond = worst_joint(motion.local_rotations)
    skin = skin_penetration(motion, actions[-1], where.shapes)
    verdict = judge_caption(motion, actions[-1], trial.caption)
    besides: dict[str, float | str | None] = {
        "caption_kept": None if verdict is None else float(verdict.kept),
        "caption_missed": "" if verdict is None or verdict.kept else "; ".join(verdict.missed),
        "jerk_against_real": jerk_against_real(body) if trial.skill is Skill.LOCO else None,
        "skin_pen_share": skin.share,
        "skin_pen_max": skin.most,
        "seam_jump": seam_jump(around),
        "seam_speed_jump": seam_speed_jump(around),
        "bone_deviation": bone_deviation(body),
        "limits_joint": f"{joint} {np.degrees(beyond):.0f}°" if joint else "",
        "joint_speed_joint": fastest_joint(motion.local_rotations, motion.fps)[0],
        "self_pen_pair": " in ".join(deepest_pair(body.motion.skeleton, body.positions, body.world)),
    }
    return Performance(trial, where.home, keyframes, actions, motions, figures, besides)


def act_trial(
    trial: Trial, director: Director | None = None, led_alike: bool = False
) -> tuple[tuple[Keyframe, ...], tuple[Action, ...], tuple[Motion, ...]]:
    """Act one trial: what it is as a script, and a motion an action, its own the last. Raises as `perform` does.

    `led_alike` leaves its caption out of what is led up to: all captions of a place share one lead, at half the time.
    """
    where, luck = setting(trial.room), _luck(trial)
    keyframes, actions = _actions(trial, where, luck)
    own = replace(actions[-1], caption="", emotion=Emotion.NEUTRAL) if led_alike else actions[-1]
    led, state = _lead(trial.room, _start(where, actions[0], luck), actions[:-1], own)
    motion, _ = (director or where.director).act(where.home, actions[-1], state)
    return keyframes, actions, (*led, motion)


def piece_of(trial: Trial) -> str:
    """The piece that a trial is acted at, or `FLOOR`. Raises UnreachableError where its room has no place for it."""
    _, actions = _actions(trial, setting(trial.room), _luck(trial))
    return actions[-1].object_id or FLOOR


def keyframes_of(trial: Trial) -> tuple[Keyframe, ...]:
    """The script of a trial: what leads up to it, and itself. Raises UnreachableError as `piece_of`."""
    return _actions(trial, setting(trial.room), _luck(trial))[0]


def _luck(trial: Trial) -> np.random.Generator:
    return np.random.default_rng([trial.seed, zlib.crc32(trial.room.encode())])


@lru_cache(maxsize=64)
def _lead(room: str, seed: int, actions: tuple[Action, ...], own: Action) -> tuple[tuple[Motion, ...], BodyState]:
    """What goes before a trial's own action, from where a seed begins; many captions are led up to alike."""
    where = setting(room)
    state = where.director.begin(where.home, Character(), seed)
    motions = []
    # What comes after them is looked ahead at, and not done here.
    for motion, after in islice(where.director.play(where.home, (*actions, own), state), len(actions)):
        motions.append(motion)
        state = after
    return tuple(motions), state


def _actions(
    trial: Trial, where: Setting, luck: np.random.Generator
) -> tuple[tuple[Keyframe, ...], tuple[Action, ...]]:
    """The trial as a script, at the first piece, in an order by chance, at which it can be done."""
    candidates = places_for(trial.skill, trial.caption, where)
    if not candidates:
        raise UnreachableError(f"{trial.room} has nothing for “{trial.caption}” ({trial.skill})", "choose another room")
    error: UnreachableError | None = None
    for index in luck.permutation(len(candidates)):
        keyframes = _script(trial, candidates[index], where.home)
        target = None if candidates[index] == FLOOR else candidates[index]
        places = [Place(0, target if keyframe.furniture != FLOOR else None) for keyframe in keyframes]
        try:
            return keyframes, act(keyframes, places, where.home, int(luck.integers(1 << 31)))
        except UnreachableError as found:
            error = found
    raise error or UnreachableError(trial.room)


def _script(trial: Trial, piece: str, home: Home) -> tuple[Keyframe, ...]:
    word = FLOOR if piece == FLOOR else furniture.canonical(home.object(piece).category).replace("_", " ")
    own = Keyframe(
        skill=trial.skill, caption=trial.caption, emotion=emotion_of(trial.caption) or "neutral", furniture=word
    )
    walk = WALK.model_copy(update={"furniture": word})
    if trial.skill not in REST:
        return walk, own
    skill, caption = REST[trial.skill]
    return walk, Keyframe(skill=skill, emotion="neutral", caption=caption, furniture=word), own


def _start(where: Setting, first: Action, luck: np.random.Generator) -> int:
    """A seed that begins 1 to 5 m from where the first walk goes, or as near to that as the room allows."""
    best: tuple[float, int] | None = None
    for seed in luck.integers(1 << 31, size=24).tolist():
        state = where.director.begin(where.home, Character(), seed)
        here = (state.pelvis[0], state.pelvis[2])
        away = np.hypot(here[0] - first.goal[0], here[1] - first.goal[1]) if first.goal else AWAY[0]
        if first.goal and not where.walkable.reachable(here, first.goal):
            continue
        off = max(AWAY[0] - away, away - AWAY[1], 0.0)
        if best is None or off < best[0]:
            best = (float(off), seed)
        if off == 0.0:
            break
    if best is None:
        raise NoPath(f"no way to {first.goal} from anywhere in {where.home.rooms[0].layout.id}")
    return best[1]
