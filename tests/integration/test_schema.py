"""The API's own description, held against the running service: no server error, no answer that it does not describe."""

from __future__ import annotations

from typing import Any

import pytest
import schemathesis
from examples import tries
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from running import PATIENCE, SHORT, RunningService, finished
from schemathesis.checks import (
    content_type_conformance,
    not_a_server_error,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

pytestmark = pytest.mark.service
CHECKS = (
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
)
EXAMPLES = tries(40).max_examples
"""For each call: eight day by day."""


@pytest.fixture(scope="module")
def described(service: RunningService) -> Any:
    return schemathesis.openapi.from_url(f"{service.url}/openapi.json")


@pytest.fixture(scope="module")
def known(service: RunningService) -> dict[str, str]:
    """Ids that exist, so that not every path leads to a 404."""
    with service.client() as client:
        story = finished(client, client.post("/v1/stories", json={"theme": SHORT}).json()["id"])
    return {"story_id": story["id"], "script_id": "insomnia-at-three", "layout_id": "study-0000"}


def test_every_answer_is_as_described(described: Any, known: dict[str, str]) -> None:
    """Half of the calls are for things that exist; of those, nothing is deleted."""
    seen = []
    for found in described.get_all_operations():
        operation = found.ok()
        seen.append(f"{operation.method.upper()} {operation.path}")

        @given(case=operation.as_strategy(), real=st.booleans())
        @settings(
            max_examples=EXAMPLES,
            deadline=None,
            derandomize=True,
            database=None,
            phases=[Phase.explicit, Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        def ask(case: Any, real: bool) -> None:
            if real and case.method != "DELETE":
                case.path_parameters = {name: known.get(name, v) for name, v in (case.path_parameters or {}).items()}
            case.call_and_validate(checks=list(CHECKS), timeout=PATIENCE)

        ask()
    assert len(seen) >= 29, seen
