"""A client of the HTTP service, sync and async; importing it loads httpx and nothing of the engine."""

from __future__ import annotations

from planner_service.client.client import AsyncClient, Client
from planner_service.client.errors import ApiError, ClientError, StoryCancelled, StoryFailed, Unreachable, WaitTimeout
from planner_service.client.responses import Extraction, Film, Page, Story, StoryEvent

__all__ = [
    "ApiError",
    "AsyncClient",
    "Client",
    "ClientError",
    "Extraction",
    "Film",
    "Page",
    "Story",
    "StoryCancelled",
    "StoryEvent",
    "StoryFailed",
    "Unreachable",
    "WaitTimeout",
]
