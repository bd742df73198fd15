"""What is seen in the hands: which caption holds what, what it looks like, and where it is in every frame"""

from motion_backend.props.fixture_tracks import replaced, works
from motion_backend.props.prop_frames import PropTrack
from motion_backend.props.prop_shapes import PropShape, prop_shape
from motion_backend.props.prop_table import Held, held_in, shown_as, things_named
from motion_backend.props.prop_tracks import prop_points, prop_tracks

__all__ = [
    "Held",
    "PropShape",
    "PropTrack",
    "held_in",
    "prop_points",
    "prop_shape",
    "prop_tracks",
    "replaced",
    "shown_as",
    "things_named",
    "works",
]
