"""Every format a motion can be written to, by name: the one table that files and HTTP answers share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from motion_backend.formats.bvh import bvh_bytes
from motion_backend.formats.glb_film import body_glb
from motion_backend.formats.motion_json import json_bytes
from motion_backend.formats.npz import amass_bytes, npz_bytes, raw_bytes
from motion_backend.motion import Motion


@dataclass(frozen=True)
class Format:
    """How a motion is written in one format."""

    encode: Callable[[Motion], bytes]
    media_type: str
    suffix: str


FORMATS = {
    "npz": Format(npz_bytes, "application/x-npz", ".npz"),
    "bvh": Format(bvh_bytes, "text/plain; charset=utf-8", ".bvh"),
    "glb": Format(body_glb, "model/gltf-binary", ".glb"),
    "json": Format(json_bytes, "application/json", ".json"),
    "amass": Format(amass_bytes, "application/x-npz", ".amass.npz"),
    "f32": Format(raw_bytes, "application/octet-stream", ".f32"),
}


def encode(motion: Motion, name: str) -> bytes:
    """The motion in the format of that name; ValueError lists the names there are."""
    if name not in FORMATS:
        raise ValueError(f"format must be one of {', '.join(FORMATS)}, not {name!r}")
    return FORMATS[name].encode(motion)


def write_motion(motion: Motion, path: Path | str) -> Path:
    """Save a motion in the format its file name ends with; ValueError lists the endings there are."""
    path = Path(path)
    endings = [one for one in FORMATS.values() if path.name.endswith(one.suffix)]
    if not endings:
        raise ValueError(f"a motion's file ends in {', '.join(one.suffix for one in FORMATS.values())}: {path.name!r}")
    path.write_bytes(max(endings, key=lambda one: len(one.suffix)).encode(motion))
    return path
