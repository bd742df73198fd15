"""Pictures as an H.264 film that every browser and player shows."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

QUALITY: Final = {"preset": "veryfast", "crf": "23"}
"""As x264 names them: a minute of a still camera at 1280 x 720 takes some 3 MB."""


def write_mp4(pictures: Iterable[NDArray[np.uint8]], path: Path | str, fps: int) -> Path:
    """Write pictures (height, width, 3), sRGB, of even height and width. The same pictures give the same bytes."""
    import av

    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as container:
        stream: Any = None
        for number, picture in enumerate(pictures):
            if stream is None:
                stream = container.add_stream("libx264", rate=fps, options=QUALITY)
                stream.height, stream.width = picture.shape[:2]
                stream.pix_fmt = "yuv420p"
                # With several threads x264 cuts the film otherwise on every machine.
                stream.codec_context.thread_count = 1
            frame = av.VideoFrame.from_ndarray(picture, "rgb24")
            frame.pts, frame.time_base = number, Fraction(1, fps)
            container.mux(stream.encode(frame))
        if stream is not None:
            container.mux(stream.encode(None))
    return Path(path)
