"""Query parameters that a call does not know are refused: `frm=0` must not quietly mean everything."""

from __future__ import annotations

from fastapi import Request

from planner_service.errors import Unprocessable


async def only_known_parameters(request: Request) -> None:
    """Unprocessable names the parameter that the call lacks, and those it has; async, since it waits for nothing."""
    if not request.query_params:
        return
    operation = request.app.openapi()["paths"].get(request.scope["route"].path, {}).get(request.method.lower())
    if operation is None:
        return
    known = [parameter["name"] for parameter in operation.get("parameters", ()) if parameter["in"] == "query"]
    for name in request.query_params:
        if name not in known:
            raise Unprocessable(f"?{name}", f"there is no such parameter here; there are {', '.join(known) or 'none'}")
