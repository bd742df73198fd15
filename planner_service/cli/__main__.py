"""`python -m planner_service.cli` is `sims`."""

from __future__ import annotations

from planner_service.cli import main

main()
