"""Generated requests against the service as it describes itself."""

from __future__ import annotations

from pathlib import Path

import pytest
import schemathesis
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from tests.app.test_process import service

CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
]
#: Streams never end, and connecting opens links wherever a generated address points.
LEFT_OUT = {("GET", "/api/v1/vehicles/{vehicle_id}/telemetry"), ("POST", "/api/v1/vehicles")}
EXAMPLES = 6


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_generated_requests_get_documented_answers(tmp_path: Path) -> None:
    """No generated request makes the service fail or answer otherwise than it says."""
    with service(tmp_path / "plans.db") as running:
        schema = schemathesis.openapi.from_url(f"{running.client.base_url}/openapi.json")
        tried = 0
        for result in schema.get_all_operations():
            operation = result.ok()
            if (operation.method.upper(), operation.path) in LEFT_OUT:
                continue

            @given(case=operation.as_strategy())
            @hypothesis_settings(
                max_examples=EXAMPLES,
                deadline=None,
                derandomize=True,
                database=None,
                suppress_health_check=list(HealthCheck),
            )
            def call(case: schemathesis.Case) -> None:
                case.validate_response(case.call(timeout=20), checks=CHECKS)

            call()
            tried += 1
        assert tried > 20
