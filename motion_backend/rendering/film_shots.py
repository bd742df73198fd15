"""A motion as a film's shots: a camera that stands still and sees what is done until the next cut, near or far.

Views are scored by what can be told quickly; of the best of them small pictures are looked at, and the one is taken in
which nothing hides what it is about for more than a moment, and that shows it best. What is seen from near stands
between two parts of one shot of the whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.cast import PLAIN, Role
from motion_backend.motion import Motion, PhaseKind
from motion_backend.props import PropTrack, prop_points, prop_tracks, replaced
from motion_backend.rendering.camera import FOV, YAWS, Front, Shot, Sight, liking, outermost
from motion_backend.rendering.film_counterpart import Counterpart, Kind
from motion_backend.rendering.film_cuts import Cut, Framing, Subject, film_cuts
from motion_backend.rendering.film_edit import FilmEdit, Frames
from motion_backend.rendering.film_entrance import Entrance
from motion_backend.rendering.film_set import FilmSet
from motion_backend.rendering.film_sight import Appearances
from motion_backend.rendering.hand_deed import HANDS
from motion_backend.rendering.motion_figures import lying_solids
from motion_backend.rendering.rasterizer import Camera, orbit
from motion_backend.rendering.renderer import Solid
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

if TYPE_CHECKING:
    from scene_graphs.home import Home

EYES: Final = (1.2, 1.45, 1.7)
"""Metres that a camera stands high: at the eyes of who sits, of who stands, and of who looks over low furniture."""
OVER_TOPS: Final = 2.0
"""The same where hands are at something: over what stands on a top before them."""
LEVEL: Final = (0.12, 3.0)
"""From how many radians from above on it counts to look down, and what each of those counts."""
CLOSE_PITCHES: Final = (0.06, 0.30), (0.06, 0.30, 0.60, 0.95)
"""The same from near, of who is upright, whose crown nobody wants to see, and of who lies."""
FROM_BELOW, BOWED = (-0.10, 0.06, 0.24), -0.35
"""Of a head that is bowed, whose face is seen from below, and from which height on of where it looks it is."""
NEAREST: Final = 2.3
"""Metres from the middle of what is seen."""
CLOSEST: Final = {Subject.FACE: 1.25, Subject.HANDS: 1.2}
"""The same from near."""
NO_LONGER_NEAR: Final = 2.6
"""Metres from which on a look from near shows no more than one of the whole: who stoops moves head and hand far."""
FRAME, OVER_WORDS = 0.84, (0.88, 0.64)
"""The share of a picture that all of a body keeps within, to either side and of its upper and of its lower half: below
that words are told."""
SAMPLES: Final = 5
"""Frames of a shot that are looked at."""
ALIKE, AS_NEAR = np.radians(30.0), 1.4
"""Two cameras whose directions differ by less, and whose distances by no more than this factor, look like a mistake and
not like a cut."""
MARGIN: Final = 0.12
"""Metres around joints that skin and hair reach."""
FINGERS, CROWN = 0.17, 0.16
"""Metres that a hand reaches beyond its wrist, and a head beyond its joint."""
FAR: Final = 0.14
"""What a metre of distance counts: faces are seen from near."""
REPEATED: Final = 1.6
"""What a jump cut counts."""
LEFT_OUT: Final = 4.0
"""The same where time is left out between: who was here is there, as if by magic."""
REVERSED: Final = 3.0
"""What it counts to go on from the other side, where who went to the right goes to the left."""
SIDE: Final = 0.25
"""From how much of its way, or of where it is turned, across the picture on a body has a side."""
ON_THE_WAY: Final = (8, 0.15)
"""Frames before and after a cut, and the metres from which on a body that goes so far in them is on a way."""
FACED, WIDEST = 1.2, 1.2
"""What it counts to see a face, best at a quarter turned, and the turn in radians from which it is none."""
WIDEST_NEAR: Final = {Subject.FACE: WIDEST, Subject.HANDS: 2.0}
"""The turn from which nothing is looked at from near: of a face nothing is seen, of a hand a back before it."""
WATCHED: Final = 3.0
"""What it counts to see the face of who does not walk, in a shot of the whole,"""
COMING: Final = 0.8
"""What it counts that somebody who walks does not walk away,"""
QUARTER, PROFILE, BEYOND = (0.8, 1.6), (1.3, 1.8), (2.0, 2.5)
"""from the first turn (radians) on the less, and from the second not: of who does nothing with their hands, of who
does, and of who does it to what stands before them."""
HAND_HIDDEN: Final = 2.0
"""What it counts to have furniture before the hands that do something."""
FEET, KNEES = ([INDEX[f"{side}_{name}"] for side in ("left", "right") for name in names]
               for names in (("ankle", "foot"), ("knee",)))  # fmt: skip
ROOTED: Final = 0.12
"""Metres up to which hips and feet stay where they are: their picture ends at the knees."""
EVERY: Final = 4
"""Frames between two at which it is asked how far a body goes."""
ALONG: Final = 0.8
"""What it counts to look along an arm, of which then nothing is seen."""
STEEP, LIES = (1.0, 0.3), 0.5
"""What a radian from above counts from near, of who is upright and of who lies: whose head's up is less than that."""
FROM_FEET, OBLIQUE = 4.0, 0.3
"""What it counts to look at who lies along their legs, soles first, and the cosine from which on that begins."""
INSIDE, FROM_INSIDE = 0.6, 1.0
"""What it counts to be in the room, of a look at the whole and from near."""
AT_DOOR: Final = 3.0
"""What it counts in the first shot to see the door by which somebody comes in."""
TO_COUNTERPART: Final = 4.0
"""What it counts to see the window that somebody looks out of, the door they wait at, the mirror they are before,"""
SHOWN: Final = 0.3
"""and how well window and door must be seen, if any camera sees them so that shows the body as well."""
TO_FRONT: Final = 3.0
"""What it counts to see the front of what is touched well,"""
FRONTAL: Final = 0.4
"""and how well it must be seen, if any camera sees it so: from the side a cabinet is a board that hides the hand."""
MOVES: Final = 0.07
"""Metres a second of a hand from which on it does something: those of folded arms stir."""
ASIDE: Final = (0.19, 0.12, 0.06)
"""Radians by which a camera is turned to the side, at most so that a body that was in the middle is at a third."""
OFF_CENTRE: Final = 0.2
"""What that counts."""
STEEPEST: Final = 0.45
"""The sine of the angle from above at which a camera looks at the whole of a body, at most."""
EXACT: Final = 0.02
"""Metres that what was just within a picture may be beyond, where it is turned."""
TRIES: Final = 9
"""Views of a shot of which pictures are looked at, each from another side: one side may show what hides from the
others. Of the best of them those from other heights are looked at too."""


@dataclass(frozen=True)
class FilmShot:
    """Frames start to stop (exclusive), seen by one camera."""

    start: int
    stop: int
    camera: Camera
    scene: Sequence[Solid]
    """What it sees of the home; the same object for all parts of one shot."""
    subject: Subject = Subject.BODY


def film_shots(
    home: Home, motion: Motion, starts: Sequence[int], aspect: float, role: Role = PLAIN, edit: FilmEdit | None = None
) -> Iterator[FilmShot]:
    """The shots of a motion whose actions begin at these frames, all of it or what an edit keeps; pictures are `aspect`
    times as wide as high.

    Each is chosen when it is asked for, while the one before is being drawn. The role says where moods change.
    """
    positions, turns = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    joints = positions.astype(np.float64)
    props = prop_tracks(motion, role)
    director = _Director(motion, joints, turns, FilmSet.of(home, replaced(role)), aspect, props)
    before: FilmShot | None = None
    for cut in film_cuts(motion, joints, starts, role, edit, props):
        for part in _parts(cut, director, before):
            yield part
            before = part


def _parts(cut: Cut, director: _Director, before: FilmShot | None) -> Iterator[FilmShot]:
    """A shot of the whole, with what is worth it seen from near, if any camera sees that; nothing else where that is
    all of it."""
    if cut.close is not None and (cut.close.start, cut.close.stop) == (cut.start, cut.stop):
        close = director.close_up(cut.close, before)
        yield director.shot(cut.whole, before) if close is None else close
        return
    whole = director.shot(cut.whole, before)
    close = director.close_up(cut.close, whole) if cut.close is not None else None
    if close is None:
        yield whole
        return
    for start, stop in ((cut.start, close.start), (close.stop, cut.stop)):
        if start == close.stop:
            yield close
        if stop > start:
            yield FilmShot(start, stop, whole.camera, whole.scene)


@dataclass(frozen=True)
class _Director:
    """What shots are chosen from."""

    motion: Motion
    joints: Array
    """Of the whole motion, in the world. (T, 22, 3)."""
    turns: Array
    """Their rotations. (T, 22, 4)."""
    set: FilmSet
    aspect: float
    props: tuple[PropTrack, ...]
    """What is in the hands."""

    def shot(self, framing: Framing, before: FilmShot | None) -> FilmShot:
        """The best view, unlike the one before, in which the body is hidden for no more than a moment, else least; of
        who does not walk one with the face, if there is any."""
        return self._best(framing, self._views(framing, before))[0]

    def close_up(self, close: Framing, before: FilmShot | None) -> FilmShot | None:
        """The same from near; None where something hides it from all cameras, or is in the way of all, and of who
        looks out of a window or is at a door, which would not be seen."""
        there = None if close.of_face else self._counterpart(close)
        views = self._near(close, before) if there is None or there.kind is Kind.MIRROR else []
        if not views:
            return None
        shot, enough = self._best(close, views)
        return shot if enough else None

    def _best(self, framing: Framing, views: Sequence[_View]) -> tuple[FilmShot, bool]:
        """Of some views, the best first, the one that makes the best picture of those that show enough, else the one
        that shows most; and whether it is enough."""
        start, stop = framing.start, framing.stop
        bodies = Appearances.of(self.motion, framing, self.aspect, self.props)
        counterpart = None if framing.of_face else self._counterpart(framing)
        if counterpart is not None:
            bodies = replace(bodies, face=None if counterpart.kind is Kind.WINDOW else bodies.face, profile=True)
        telling = [view for view in views if view.tells]
        tried = telling[:TRIES] or views[:TRIES]
        best = self._first(framing, bodies, tried)
        if not any(best.worth[0]):  # what tells of it hides who does it
            best = self._first(framing, bodies, [view for view in views[:TRIES] if not view.tells], best)
        best = self._first(framing, bodies, best.view.others, best)
        best = self._first(framing, bodies, [*best.view.aside(self.aspect)], best)
        # Hands may be before a face that weeps, and a head that sank shows its crown.
        enough = any(best.worth[0]) if framing.of_face else best.worth[0][0]
        return FilmShot(start, stop, best.view.camera, best.scene, framing.subject), enough

    def _first(
        self, framing: Framing, bodies: Appearances, views: Sequence[_View], best: _Looked | None = None
    ) -> _Looked:
        """The one of some views, the best first, that makes the best picture, if it is better than one of others; none
        is made of what could not be better."""
        for view in views:
            if best is not None and all(best.worth[0]) and view.score + bodies.most <= best.worth[1]:
                break
            looked = self._looked(framing, bodies, view)
            best = looked if best is None or looked.worth > best.worth else best
        assert best is not None
        return best

    def _looked(self, framing: Framing, bodies: Appearances, view: _View) -> _Looked:
        """A view of which a small picture was looked at."""
        scene = self.set.seen(view.camera, self.joints[framing.start : framing.stop])
        opened = self._standing_open(framing.start, framing.stop, view.camera)
        look = bodies.look([*scene, *opened], view.camera)
        return _Looked((look.rank, view.score + look.appeal if any(look.rank) else look.shown), view, scene)

    def _standing_open(self, start: int, stop: int, camera: Camera) -> list[Solid]:
        """Doors and drawers as they are at first, amidst and at last in some frames, which hide what is behind. A door
        and its hall that are seen from beyond their wall are outside of a home."""
        found: dict[tuple[str, bytes], Solid] = {}
        for frame in (start, (start + stop) // 2, stop - 1):
            there = [one for one in self.props if one.own is not None and one.start <= frame < one.stop]
            for track, solid in zip(there, lying_solids(there, frame, camera, np.inf), strict=True):
                now = frame - track.start
                outside = self.set.is_beyond(camera, track.positions[now])
                found[track.prop, track.turns[now].tobytes()] = replace(solid, outside=outside)
        return [*found.values()]

    def _views(self, framing: Framing, before: FilmShot | None) -> list[_View]:
        """Cameras that have all of the body in the picture, best first: near, of its face, hands and feet, with the
        door that it comes in by or the window that it looks out of."""
        start, stop = framing.start, framing.stop
        frames = _sampled(start, stop)
        poses = self.joints[frames]
        entrance = Entrance.of(self.set.home, self.motion) if start == 0 else None
        there = self._counterpart(framing)
        openings = [one.corners for one in (entrance, there) if one is not None]
        points = outermost(np.concatenate([self._reached(framing), *openings]))
        behind = there is not None and there.kind is Kind.WINDOW
        watched = np.empty(0, np.int64) if behind else self._watched(frames, framing.deed)
        ahead = rotations.rotate(self.turns[watched, INDEX["head"]], np.array([0.0, 0.0, 1.0]))
        way = rotations.rotate(self.turns[frames, 0], np.array([0.0, 0.0, 1.0]))
        sight = self.set.sight(_middle(points), poses)
        front = self._front(framing, sight)
        before_it = front is not None or there is not None
        widest = BEYOND if before_it else PROFILE if framing.deed and not framing.gesture else QUARTER
        yaws = _yaws(front if front is not None or there is None else there.front)
        lying = rotations.rotate(self.turns[frames, 0], np.array([0.0, 1.0, 0.0]))
        liked = liking(self.motion, Shot(int(frames[len(frames) // 2])), yaws)
        eyes = EYES if framing.deed is None or framing.gesture else (*EYES, OVER_TOPS)
        scored = []
        for index, yaw in enumerate(yaws.tolist()):
            from_there = []
            for eye in eyes:
                camera = _standing(yaw, eye, points, self.aspect, NEAREST)
                score = float(liked[index]) + sight.score(camera, poses) - _down(camera)
                score += INSIDE * sight.indoors(camera)
                score -= FAR * _distance(camera) + FROM_FEET * _from_feet(lying, -camera.axes[2])
                if len(watched):
                    score += WATCHED * _is_faced(ahead, -camera.axes[2], widest)
                else:
                    score += COMING * _is_faced(way, -camera.axes[2], PROFILE)
                if front is not None:
                    score += TO_FRONT * front.seen(camera)
                if framing.deed is not None:
                    score -= HAND_HIDDEN * sight.hidden(camera, self._doing(framing))
                score += AT_DOOR * sight.shows(camera, entrance.corners, entrance.side) if entrance is not None else 0.0
                told = sight.shows(camera, there.corners, there.side) if there is not None else 1.0
                score += TO_COUNTERPART * told - self._broken(camera, before, start)
                tells = told >= SHOWN or (there is not None and there.kind is Kind.MIRROR)
                from_there.append(_View(score, camera, points, tells))
            first, *others = _sorted(from_there)
            scored.append(first._replace(others=tuple(others[:1])))
        return _sorted(_frontal(scored, front))

    def _reached(self, framing: Framing) -> Array:
        """Where joints and the crown go in some frames, at the height of a jump too, and what is in the hands; without
        the feet of who stands or sits still and does something with their hands. (N, 3)."""
        start, stop = framing.start, framing.stop
        frames = np.arange(start, stop, EVERY)
        high = start + int(self.joints[start:stop, INDEX["head"], 1].argmax())
        frames = np.unique([*frames.tolist(), high, stop - 1])
        joints, held = self.joints[frames], [prop_points(self.props, frame) for frame in frames[::EVERY].tolist()]
        rooted = np.ptp(joints[:, [0, *FEET]], axis=0).max() < ROOTED
        over_feet = joints[:, FEET, 1].max() < joints[:, 0, 1].min()  # of who does not lie
        low = min((float(points[:, 1].min()) for points in held if len(points)), default=np.inf)
        if framing.deed is not None and rooted and over_feet and low > joints[:, KNEES, 1].min():
            joints = np.delete(joints, FEET, axis=1)
        return np.concatenate([joints.reshape(-1, 3), _crowns(self.joints[frames], self.turns[frames]), *held])

    def _watched(self, frames: NDArray[np.int64], deed: Frames | None) -> NDArray[np.int64]:
        """Those of some frames in which nobody walks, or hands do what it is about."""
        first, stop = deed or (0, 0)
        walks = [p for p in self.motion.phases if p.kind is PhaseKind.WALK]
        stands = [f for f in frames.tolist() if first <= f < stop or not any(p.start <= f < p.stop for p in walks)]
        return np.array(stands, np.int64)

    def _doing(self, framing: Framing) -> Array:
        """Where the hands are that do something, in the midst of it. (H, 3)."""
        start, stop = framing.deed or (framing.start, framing.stop)
        return self.joints[(start + stop - 1) // 2, list(framing.hands)]

    def _front(self, framing: Framing, sight: Sight) -> Front | None:
        """Of what is touched, if that stands up before the hand, in the last frame of its deed or in that in which a
        door sets off, which ends with the hand in the room."""
        _, stop = framing.deed or (framing.start, framing.stop)
        starts = [p.start for p in self.motion.phases if p.kind is PhaseKind.TOUCH and p.start < stop <= p.stop]
        doors = [track for track in self.props if track.own is not None]
        if not starts or not framing.hands:
            return None
        frames = [stop - 1, *(track.sets_off(starts[0], stop) or stop - 1 for track in doors)]
        hands = (self.joints[frame, framing.hands[0]] for frame in frames)
        return next((front for hand in hands if (front := sight.front(hand)) is not None), None)

    def _counterpart(self, framing: Framing) -> Counterpart | None:
        """What the body stands before. Of who touches something no window, at which a desk may stand; of who makes
        gestures, which are seen from before, no more than a mirror."""
        start, stop = framing.start, framing.stop
        found = Counterpart.of(self.set.home, self.motion, self.joints[start:stop], self.turns[start:stop])
        if found is None or found.kind is Kind.MIRROR:
            return found
        touches = any(p.kind is PhaseKind.TOUCH and p.start < stop and p.stop > start for p in self.motion.phases)
        elsewhere = found.kind is Kind.WINDOW if touches else self._moves(framing)
        return None if elsewhere else found

    def _moves(self, framing: Framing) -> bool:
        """Whether hands that do something go on moving, most of the time: folded arms wait."""
        if framing.deed is None:
            return False
        start, stop = framing.deed
        hands = self.joints[start:stop, HANDS] - self.joints[start:stop, [0]]
        speed = self.motion.fps * np.linalg.norm(np.diff(hands, axis=0), axis=-1)
        return bool(np.median(speed, axis=0).max() > MOVES)

    def _near(self, close: Framing, before: FilmShot | None) -> list[_View]:
        """Cameras near a face, a quarter turned, or beside an arm that touches, with whose head and
        shoulders it is, best first; none is in furniture."""
        frames = _sampled(close.start, close.stop)
        poses, turns = self.joints[frames], self.turns[frames]
        hands = (
            poses[:, list(close.hands)].reshape(-1, 3) if close.subject is Subject.FACE else _arms(poses, close.hands)
        )
        # A hand without the one whose it is tells nothing of who does it, and how.
        held = [prop_points(self.props, frame) for frame in frames.tolist()] if close.hands else []
        points = np.concatenate([_head(poses, turns), hands, *held])
        ahead = rotations.rotate(turns[:, INDEX["head"]], np.array([0.0, 0.0, 1.0]))
        sight = self.set.sight(_middle(points), poses)
        front = None if close.of_face else self._front(close, sight)
        tall = turns[:, 0 if close.of_face else INDEX["head"]]  # a head may hang between the knees of who sits
        upright = rotations.rotate(tall, np.array([0.0, 1.0, 0.0]))[:, 1].mean() > LIES
        pitches: Sequence[float] = CLOSE_PITCHES[0 if upright else 1]
        steep = STEEP[0 if upright else 1]
        bowed = close.of_face and upright and ahead[:, 1].mean() < BOWED
        if bowed:  # who is before the trunk, and lower, sees most of it
            ahead = rotations.rotate(turns[:, 0], np.array([0.0, 0.0, 1.0])) * [1.0, 0.0, 1.0]
            ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-9)
            pitches = FROM_BELOW
        scored = []
        for pitch in pitches:
            for yaw in _yaws(front).tolist():
                camera = _fitted(yaw, pitch, points, self.aspect, CLOSEST[close.subject])
                if sight.blocked(camera) or _distance(camera) > NO_LONGER_NEAR:
                    continue
                towards = -camera.axes[2]
                if float(np.mean(_turns(ahead, towards))) > WIDEST_NEAR[close.subject]:
                    continue
                score = sight.score(camera, poses) + FROM_INSIDE * sight.indoors(camera) - steep * abs(pitch)
                score -= FROM_FEET * _from_feet(rotations.rotate(turns[:, 0], np.array([0.0, 1.0, 0.0])), towards)
                score += _faces(ahead, towards) * (1.0 if close.subject is Subject.FACE else 0.4)
                if close.subject is Subject.HANDS:
                    score += TO_FRONT * front.seen(camera) if front is not None else 0.0
                    score -= HAND_HIDDEN * sight.hidden(camera, hands)
                    score -= ALONG * max(abs(float(arm @ towards)) for arm in _directions(poses, close.hands))
                scored.append(_View(score - self._broken(camera, before, close.start), camera))
        return _sorted(scored)

    def _broken(self, camera: Camera, before: FilmShot | None, frame: int) -> float:
        """What the rules of cutting count against a camera: no jump from nearly the same place, nobody turns round."""
        if before is None:
            return 0.0
        now, then = self._across(camera, frame), self._across(before.camera, before.stop - 1)
        turned = min(abs(now), abs(then)) > SIDE and now * then < 0
        jump = LEFT_OUT if frame > before.stop else REPEATED
        return jump * are_alike(camera, before.camera) + REVERSED * turned

    def _across(self, camera: Camera, frame: int) -> float:
        """How far to the right of a picture the body goes, or is turned if it does not go, -1 to 1."""
        frames, least = ON_THE_WAY
        first, last = self.joints[[max(frame - frames, 0), min(frame + frames, len(self.joints) - 1)], 0]
        way = (last - first) * [1.0, 0.0, 1.0]
        far = float(np.linalg.norm(way))
        ahead = rotations.rotate(self.turns[frame, 0], np.array([0.0, 0.0, 1.0])) if far < least else way / far
        return float(ahead @ camera.axes[0])


class _View(NamedTuple):
    """A camera, and how good it seems."""

    score: float
    camera: Camera
    points: Array = np.empty((0, 3))
    """What is in its picture wherever it is turned to, (N, 3); none where it is not turned."""
    tells: bool = True
    """Whether it shows the window or door that the body stands before, if there is one."""
    others: tuple[_View, ...] = ()
    """Those from the same side and other heights, the best first."""

    def aside(self, aspect: float) -> Iterator[_View]:
        """The same turned to either side as far as it goes, up to where the body has a third of the picture before or
        behind it: there is less of what is outside of a home in one of them."""
        for side in (-1, 1) if len(self.points) else ():
            cameras = (_turned(self.camera, side * turn) for turn in ASIDE)
            turned = next((camera for camera in cameras if _holds(camera, self.points, aspect)), None)
            if turned is not None:
                yield _View(self.score - OFF_CENTRE, turned, tells=self.tells)


class _Looked(NamedTuple):
    """A view, how good its picture is, and what it sees of the home."""

    worth: tuple[tuple[bool, ...], float]
    view: _View
    scene: Sequence[Solid]


def _yaws(front: Front | None) -> Array:
    """From where one may look, beside what is touched too. (N,)."""
    return YAWS if front is None else np.append(YAWS, front.beside)


def _sampled(start: int, stop: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(start, stop - 1, SAMPLES).round().astype(np.int64))


def _middle(points: Array) -> tuple[float, float, float]:
    x, y, z = ((points.min(axis=0) + points.max(axis=0)) / 2).tolist()
    return x, y, z


def _frontal(views: list[_View], front: Front | None) -> list[_View]:
    """The views that show the front of what is touched, all where none does."""
    if front is None:
        return views
    return [view for view in views if front.seen(view.camera) >= FRONTAL] or views


def _sorted(views: Sequence[_View]) -> list[_View]:
    return sorted(views, key=lambda view: -round(view.score, 6))


def _crowns(poses: Array, turns: Array) -> Array:
    """Where the tops of heads are. (P, 3)."""
    up = rotations.rotate(turns[:, INDEX["head"]], np.array([0.0, 1.0, 0.0]))
    return np.asarray(poses[:, INDEX["head"]] + CROWN * up)


def _head(poses: Array, turns: Array) -> Array:
    """Crown, neck and shoulders. (N, 3)."""
    crown = _crowns(poses, turns)
    names = ("neck", "left_shoulder", "right_shoulder")
    return np.concatenate([crown, poses[:, [INDEX[name] for name in names]].reshape(-1, 3)])


def _arms(poses: Array, hands: Sequence[int]) -> Array:
    """Half of the forearm, wrist and fingers of each hand. (N, 3)."""
    wrists = poses[:, list(hands)]  # (P, H, 3)
    forearms = (poses[:, [hand - 2 for hand in hands]] + wrists) / 2
    fingers = wrists + FINGERS * np.stack(_directions(poses, hands))
    return np.concatenate([forearms, wrists, fingers]).reshape(-1, 3)


def _directions(poses: Array, hands: Sequence[int]) -> list[Array]:
    """Which way each forearm points, in the mean. (3,) each."""
    ways = [(poses[:, hand] - poses[:, hand - 2]).mean(axis=0) for hand in hands]
    return [way / max(float(np.linalg.norm(way)), 1e-9) for way in ways]


def _faces(ahead: Array, towards: Array) -> float:
    """How well a face that looks `ahead` (P, 3) is seen from where `towards` (3,) points to."""
    turn = _turns(ahead, towards)
    return FACED * float(np.mean(np.where(turn < WIDEST, np.cos(turn - 0.5), -1.0)))


def _is_faced(ahead: Array, towards: Array, turns: tuple[float, float]) -> float:
    """How well a face is turned to a camera: 1 up to the first of two turns, 0 at the second, and less from behind."""
    least, most = turns
    return float(np.clip((most - _turns(ahead, towards)) / (most - least), -1.0, 1.0).mean())


def _from_feet(up: Array, towards: Array) -> float:
    """How much who lies is seen from beyond their feet, where trunks point `up` (P, 3) in some frames: 0 from the side
    and of who does not lie, 1 straight along the legs."""
    beyond = np.clip(-(up @ towards) - OBLIQUE, 0.0, None) / (1.0 - OBLIQUE)
    return float((beyond * (np.abs(up[:, 1]) < LIES)).mean())


def _turns(ahead: Array, towards: Array) -> Array:
    """The angles between where a face looks in some frames and one direction, radians. (P,)."""
    return np.asarray(np.arccos(np.clip(ahead @ towards, -1.0, 1.0)))


def _fitted(
    yaw: float, pitch: float, points: Array, aspect: float, nearest: float, halves: tuple[float, float] = (FRAME, FRAME)
) -> Camera:
    """As near as all points (N, 3), with the skin around them, stay well within the picture: within so much of its
    upper and of its lower half."""
    target = _middle(points)
    axes = orbit(target, 1.0, yaw, pitch).axes
    across, up, ahead = np.moveaxis((points - target) @ axes.T, -1, 0)
    upper, lower = np.tan(FOV / 2) * np.array(halves)
    half, wide = (upper + lower) / 2, np.tan(FOV / 2) * FRAME * aspect
    # A point is within the picture where its distance to the axis, with skin, is at most `upper`, `lower` or `wide`
    # times its depth; the axis goes below the middle by so much that both halves are as full.
    asked = [
        (up + MARGIN - upper * ahead) / half, (MARGIN - up - lower * ahead) / half,
        (np.abs(across) + MARGIN) / wide - ahead, MARGIN - ahead,
    ]  # fmt: skip
    distance = max(nearest, float(np.max(asked)))
    x, y, z = (np.asarray(target) - (upper - lower) / 2 * distance * axes[1]).tolist()
    return orbit((x, y, z), distance, yaw, pitch, FOV)


def _standing(yaw: float, eye: float, points: Array, aspect: float, nearest: float) -> Camera:
    """The same from a camera that stands so high (metres), or that looks level at what is higher; told words lie on
    nothing of it."""
    camera, pitch = _fitted(yaw, 0.1, points, aspect, nearest, OVER_WORDS), 0.1
    for _ in range(2):
        pitch = float(np.arcsin(np.clip((eye - camera.target[1]) / _distance(camera), 0.0, STEEPEST)))
        camera = _fitted(yaw, pitch, points, aspect, nearest, OVER_WORDS)
    return camera


def _down(camera: Camera) -> float:
    """What it counts against a camera to look down."""
    free, steep = LEVEL
    return steep * max(-float(np.arcsin(camera.axes[2][1])) - free, 0.0)


def _turned(camera: Camera, radians: float) -> Camera:
    """A camera turned to its left where it stands."""
    way = rotations.rotate(rotations.yaw_to_quat(radians), np.subtract(camera.target, camera.eye))
    x, y, z = (np.asarray(camera.eye) + way).tolist()
    return replace(camera, target=(x, y, z))


def _holds(camera: Camera, points: Array, aspect: float) -> bool:
    """Whether all points (N, 3), with the skin around them, are well within the picture."""
    across, up, ahead = np.moveaxis(camera.view(points), -1, 0)
    upper, lower, wide = (np.tan(FOV / 2) * share * ahead + EXACT - MARGIN for share in (*OVER_WORDS, FRAME * aspect))
    return bool((up <= upper).all() and (-up <= lower).all() and (np.abs(across) <= wide).all())


def _distance(camera: Camera) -> float:
    return float(np.linalg.norm(np.subtract(camera.eye, camera.target)))


def are_alike(one: Camera, other: Camera) -> bool:
    """Whether two cameras look from nearly the same side and from nearly as far: a cut between them would be a jump."""
    ratio = _distance(one) / _distance(other)
    return max(ratio, 1 / ratio) < AS_NEAR and float(one.axes[2] @ other.axes[2]) > np.cos(ALIKE)
