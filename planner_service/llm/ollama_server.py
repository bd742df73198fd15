"""Whether an Ollama server answers on this machine, and which models it has; asked in a moment, or not at all."""

from __future__ import annotations

import json
import re
import threading
from contextlib import closing
from http.client import HTTPConnection, HTTPException
from typing import Final
from urllib.parse import urlsplit

PATIENCE: Final = 0.2
"""Seconds it may take in all."""
MAX_LIST_BYTES: Final = 1_000_000
_NAME: Final = re.compile(r"[\w./:@+-]{1,200}\Z")


def ollama_models(url: str, seconds: float = PATIENCE) -> tuple[str, ...] | None:
    """The names of the models that the server at that address has; None where none answers, or there is no address."""
    found: list[tuple[str, ...] | None] = []
    # A server that drips keeps every single wait short, and the whole one long.
    asking = threading.Thread(target=lambda: found.append(_asked(url, seconds)), daemon=True)
    asking.start()
    asking.join(seconds)
    return found[0] if found else None


def _asked(url: str, seconds: float) -> tuple[str, ...] | None:
    try:
        parts = urlsplit(url)
        if parts.scheme != "http" or not parts.hostname:
            return None
        with closing(HTTPConnection(parts.hostname, parts.port or 80, timeout=seconds)) as connection:
            connection.request("GET", "/api/tags")
            response = connection.getresponse()
            body = response.read(MAX_LIST_BYTES)
        return _names(json.loads(body)) if response.status == 200 else None
    except (OSError, HTTPException, ValueError, RecursionError):
        return None


def _names(row: object) -> tuple[str, ...] | None:
    """The names in its list; those that are none are left out."""
    models = row.get("models") if isinstance(row, dict) else None
    if not isinstance(models, list):
        return None
    names = [one.get("name") for one in models if isinstance(one, dict)]
    return tuple(name for name in names if isinstance(name, str) and _NAME.match(name))
