"""Training ends where a loss is no number, and what was in its hands then is kept."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
import torch
from torch import Tensor

from scene_graphs.errors import UserError

FILE: Final = "fault.npz"


class TrainingFaultError(UserError):
    """A loss is no number."""


def stop_if_not_finite(loss: Tensor, batch: Mapping[str, Tensor], folder: Path | None) -> None:
    """Raise TrainingFaultError for a loss that is no number; its batch is saved as `fault.npz` in a folder, if any."""
    if torch.isfinite(loss):
        return
    where = "not saved"
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        np.savez(folder / FILE, **{name: value.detach().numpy() for name, value in batch.items()})
        where = f"saved in {folder / FILE}"
    bad = [name for name, value in batch.items() if not torch.isfinite(value).all()]
    told = f"the batch has numbers that are none in {', '.join(bad)}" if bad else "the batch itself is sound"
    raise TrainingFaultError(f"the loss is {loss.item()}; {told}, {where}", "lower the rate, or look at the batch")
