"""What a body has been seen doing so far, and where it is: the keyframes of a script while it is written."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace

from motion_backend.motion import RISINGS, Emotion, Skill
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.deed_table import deed_table
from planner_service.composition.phone_call import HANGING_UP, is_talk
from planner_service.composition.whereabouts import Whereabouts
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.script import PlannedKeyframe


@dataclass
class BodyTrack:
    """The keyframes so far, and what follows from them."""

    keyframes: list[PlannedKeyframe] = field(default_factory=list)
    resting: PlannedKeyframe | None = None
    """What the body sits or lies in; None on its feet."""
    plain: bool = False
    """Whether the posture shows nothing yet but that one rests."""
    whereabouts: Whereabouts = field(default_factory=Whereabouts)
    asleep: int = 0
    """How many keyframes there were when it fell asleep."""

    hung_up: int = 0
    """How many there were when it hung up the phone."""

    @property
    def sleeps(self) -> bool:
        """Whether it has fallen asleep and done nothing since."""
        return self.resting is not None and self.asleep == len(self.keyframes) > 0

    @property
    def calling(self) -> PlannedKeyframe | None:
        """What it does with a phone at its ear; None where it has none, or has hung up."""
        if self.hung_up == len(self.keyframes):
            return None
        last = next((one for one in reversed(self.keyframes) if one.skill not in RISINGS), None)  # who gets up talks on
        return last if last is not None and is_talk(last.caption) else None

    def copy(self) -> BodyTrack:
        """The same, to be gone on with in another way."""
        return replace(self, keyframes=list(self.keyframes), whereabouts=deepcopy(self.whereabouts))

    def put(
        self, index: int | None, skill: Skill, mood: Emotion, caption: str, piece: str, room: str | None, held: str = ""
    ) -> None:
        """One more keyframe, of a beat's or of none, with a tool in the hand."""
        self.keyframes.append(
            PlannedKeyframe.model_validate(
                {
                    "skill": skill,
                    "emotion": mood.value,
                    "caption": caption,
                    "furniture": piece,
                    "beat": index,
                    "room": room,
                    "held": held,
                }
            )
        )

    def show(self, index: int) -> None:
        """The last keyframe shows this beat too."""
        last = self.keyframes[-1]
        self.keyframes[-1] = last.model_copy(update={"also": (*last.also, index)})
        if self.resting is not None:
            self.resting = self.keyframes[-1]

    def hang_up(self, index: int, mood: Emotion) -> None:
        """A call ends: it is seen of who is angry on their feet, with the hand that the phone was in."""
        last = self.keyframes[-1]
        if mood is Emotion.ANGRY and last.skill is Skill.LOCO:
            self.keyframes[-1] = last.model_copy(update={"caption": last.caption.replace("left hand", "right hand")})
            self.put(index, Skill.LOCO, mood, HANGING_UP, "floor", last.room)
        else:
            self.show(index)
        self.hung_up = len(self.keyframes)

    def go_on(self, index: int, mood: Emotion) -> None:
        """The same once more, asleep or on the phone, in another mood."""
        last, sleeps = self.keyframes[-1], self.sleeps
        self.put(index, last.skill, mood, last.caption, "floor" if connects(last) else last.furniture, last.room)
        self.resting = self.keyframes[-1] if self.resting is not None else None
        self.asleep = len(self.keyframes) if sleeps else self.asleep

    def stays(self, keyframe: PlannedKeyframe, room: str | None) -> bool:
        """Whether what a keyframe is done at is what the body sits on, or has just touched."""
        last = self.keyframes[-1] if self.keyframes else None
        if last is None or (last.skill, last.furniture) != (keyframe.skill, keyframe.furniture):
            return False
        return room is None or last.room in (None, room)

    def is_there(self, piece: str, room: str | None) -> bool:
        """Whether the body has just walked to a piece; a walk to it in no certain room is then one in `room`."""
        last = self.keyframes[-1] if self.keyframes else None
        if last is None or last.skill is not Skill.LOCO or last.furniture != piece or last.room not in (None, room):
            return False
        self.keyframes[-1] = last.model_copy(update={"room": room})
        return True

    @property
    def room(self) -> str | None:
        """The room that one was in last, where that is known."""
        return next((keyframe.room for keyframe in reversed(self.keyframes) if keyframe.room), None)

    def near(self) -> list[PlannedKeyframe]:
        """What was last done at furniture, in the room that one is in."""
        near: list[PlannedKeyframe] = []
        for one in self.keyframes[:-3:-1]:
            near += [] if one.on_floor else [one]
            if one.skill is Skill.LOCO and one.on_floor and one.room is not None:
                break  # gone to another room
        return near

    def there(self, deed: Deed) -> Sequence[str]:
        """Where one has just gone, and what is sat on there: "walks to the desk and sits down"."""
        last = self.keyframes[-1] if self.keyframes else None
        if deed.named or deed.skill is Skill.TOUCH or "floor" in deed.pieces or last is None or last.on_floor:
            return ()
        return (*deed_table().seats_at.get(last.furniture, ()), last.furniture) if last.skill is Skill.LOCO else ()
