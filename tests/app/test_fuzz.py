"""Generated requests, right and wrong ones, 2,000 in all, against the service as it describes itself."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given
from hypothesis import settings as hypothesis_settings
from schemathesis import GenerationMode
from schemathesis.config import SchemathesisConfig

from tests.app.test_apart import serving
from tests.patience import PATIENCE_S

#: Of each call, right and wrong ones; and the fewest in all.
EXAMPLES, FEWEST = 26, 2000
#: This one never ends.
LEFT_OUT = {("GET", "/api/v1/vehicles/{vehicle_id}/telemetry")}
#: A request may be right by its form and refused for what it says, wrong and refused by any word for it.
CONFIG = {
    "checks": {
        "positive_data_acceptance": {"expected-statuses": ["2xx", "4xx"]},
        "negative_data_rejection": {"expected-statuses": ["4xx"]},
    }
}
#: No answer takes longer on a busy machine; those that wait for a plan, if asked for more, as long as this.
WAIT_S, LONGEST_S = 2.0, 3600.0


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, int]]:
    """Address and process id of a service as it is run: links and door in processes of their own."""
    with serving(tmp_path_factory.mktemp("fuzz") / "plans.db") as (address, process):
        yield address, process.pid


def memory_bytes(pid: int) -> int:
    """What a process takes."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def _wait_shortly(case: schemathesis.Case) -> None:
    asked = (case.query or {}).get("wait")
    if isinstance(asked, int | float) and WAIT_S < asked <= LONGEST_S:
        case.query["wait"] = WAIT_S


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_generated_requests_get_documented_answers(running: tuple[str, int]) -> None:
    """None makes the service fail, take in what is wrong, or answer otherwise than it says."""
    address, pid = running
    schema = schemathesis.openapi.from_url(
        f"{address}/openapi.json", config=SchemathesisConfig.from_dict(CONFIG)
    )
    tried = 0
    before_bytes = memory_bytes(pid) if Path("/proc/self/statm").exists() else 0
    for result in schema.get_all_operations():
        operation = result.ok()
        if (operation.method.upper(), operation.path) in LEFT_OUT:
            continue
        # Without a query, a header or a body there is no wrong way to ask.
        asked = [*operation.query, *operation.headers, *operation.body]
        for mode in (
            (GenerationMode.POSITIVE, GenerationMode.NEGATIVE) if asked else (GenerationMode.POSITIVE,)
        ):

            @given(case=operation.as_strategy(generation_mode=mode))
            @hypothesis_settings(
                max_examples=EXAMPLES,
                deadline=None,
                derandomize=True,
                database=None,
                phases=[Phase.generate],
                suppress_health_check=list(HealthCheck),
            )
            def call(case: schemathesis.Case) -> None:
                nonlocal tried
                tried += 1
                _wait_shortly(case)
                case.call_and_validate(timeout=PATIENCE_S)

            call()
    assert tried > FEWEST
    assert httpx.get(f"{address}/health/ready", timeout=PATIENCE_S).status_code == 200
    if before_bytes:
        assert memory_bytes(pid) < before_bytes + 150_000_000
