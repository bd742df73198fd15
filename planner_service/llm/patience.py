"""How long a server of models is waited for, and what it says when it refuses."""

from __future__ import annotations

import json
import re
from email.utils import parsedate_to_datetime
from typing import Final

ATTEMPTS: Final = 4
BUSY: Final = frozenset({408, 425, 429, 500, 502, 503, 504, 529})
"""Statuses that may be better a little later; 529 is Anthropic's "overloaded"."""
FIRST_WAIT: Final = 0.5
"""Seconds, doubled each time."""


def message_of(body: bytes) -> str:
    """What a server says went wrong, if it says so in JSON as OpenAI, Ollama, vLLM or Anthropic do."""
    try:
        value = json.loads(body)
    except (ValueError, RecursionError):
        return ""
    error = value.get("error", value) if isinstance(value, dict) else None
    said = error.get("message", "") if isinstance(error, dict) else error
    return said if isinstance(said, str) else ""


def retry_after(header: str, now: float) -> float:
    """Seconds to wait as Retry-After says, in seconds or as a date; 0 for what cannot be read."""
    if re.fullmatch(r"\d{1,9}(\.\d{1,6})?", header.strip()):
        return float(header)
    try:
        return max(0.0, parsedate_to_datetime(header).timestamp() - now)
    except (ValueError, OverflowError, TypeError):
        return 0.0


def without_key(text: str, key: str) -> str:
    """A server's words, in which our key and every part of it is hidden."""

    def hidden(found: re.Match[str]) -> str:
        return "…" if key and (found[0] in key or key in found[0]) else found[0]

    return re.sub(r"[\w.~-]{6,}", hidden, text.replace(key, "…") if key else text)
