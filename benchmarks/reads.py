"""How long reads of a running service take, over a connection that is kept: ``python -m benchmarks.reads``.

A fresh service (``swathplan serve``) with a simulated aircraft, a kept scenario and a plan that is done; each
endpoint is read so many times in turn by one client. On a machine busy otherwise (``machine_load``) the
others are measured too.
"""

from __future__ import annotations

import http.client
import json
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from benchmarks.isolation import VEHICLES, ask, served

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "sar-case-1.geojson"
#: What is promised: half of the answers are there within this, milliseconds.
MEDIAN_MS = 5.0


def _prepared(address: str) -> list[str]:
    """The paths to read, once there is something to be read at each."""
    scenario = json.loads(EXAMPLE.read_text())
    _, kept = ask(address, "POST", "/api/v1/scenarios", scenario)
    _, plan = ask(address, "POST", "/api/v1/plans?wait=50", scenario)
    _, vehicle = ask(address, "POST", VEHICLES, {"name": "uav", "url": "sim:"})
    one = f"{VEHICLES}/{vehicle['id']}"
    return [
        "/api/v1/plans",
        f"/api/v1/plans/{plan['id']}",
        f"/api/v1/plans/{plan['id']}/plan.geojson",
        "/api/v1/scenarios",
        f"/api/v1/scenarios/{kept['id']}",
        "/api/v1/terrain",
        "/api/v1/flights",
        "/api/v1/audit",
        VEHICLES,
        one,
        f"{one}/commands",
        "/health/live",
    ]


def run(reads: int = 200) -> Iterator[dict[str, Any]]:
    """A row for each endpoint: median and 95th percentile of the time to the whole answer, milliseconds."""
    with tempfile.TemporaryDirectory(prefix="swathplan-") as folder, served(Path(folder)) as (address, _):
        for path in _prepared(address):
            connection = http.client.HTTPConnection(urlsplit(address).netloc, timeout=60.0)
            took_ms, size = [], 0
            for _ in range(reads):
                began_s = time.perf_counter()
                connection.request("GET", path)
                answer = connection.getresponse()
                size = len(answer.read())
                took_ms.append((time.perf_counter() - began_s) * 1000.0)
                if answer.status != 200:
                    raise RuntimeError(f"{path} answers {answer.status}")
            connection.close()
            median_ms = float(np.median(took_ms))
            yield {
                "benchmark": "reads",
                "path": "/".join("{id}" if len(part) == 36 else part for part in path.split("/")),
                "reads": reads,
                "bytes": size,
                "median_ms": round(median_ms, 2),
                "p95_ms": round(float(np.percentile(took_ms, 95)), 2),
                "kept": median_ms < MEDIAN_MS,
                "machine_load": round(os.getloadavg()[0], 1),
            }


if __name__ == "__main__":
    for row in run():
        sys.stdout.write(json.dumps(row) + "\n")
