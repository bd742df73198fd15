"""Every endpoint of the HTTP API: a new resource is a folder beside this file, and a line here."""

from __future__ import annotations

from typing import Final

from planner_service.api.cast.endpoints import cast_router
from planner_service.api.extractions.endpoints import extract_router, extractions_router
from planner_service.api.layouts.endpoints import layouts_router
from planner_service.api.layouts.graph_endpoints import layout_graphs_router
from planner_service.api.scripts.endpoints import long_scripts_router, short_scripts_router
from planner_service.api.stories.endpoints import motions_router, stories_router
from planner_service.api.stories.event_stream import events_router
from planner_service.api.stories.film_endpoints import film_router
from planner_service.api.stories.take_endpoints import take_router
from planner_service.api.task_plans.endpoints import task_plans_router
from planner_service.api.vocabularies.endpoints import vocabularies_router
from planner_service.api.web_page import page_router, service_router

ROUTERS: Final = (
    stories_router, take_router, film_router, events_router, motions_router, task_plans_router, extract_router,
    extractions_router, short_scripts_router, long_scripts_router, layouts_router, layout_graphs_router, cast_router,
    vocabularies_router, service_router, page_router,
)  # fmt: skip
"""In the order in which paths are looked for."""
