"""The example of wide and irregular regions, planned and judged."""

from __future__ import annotations

import json

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.validate import findings
from tests.planner.scenarios import EXAMPLES


def test_the_example_is_planned_without_violations() -> None:
    """Every region is seen as often as asked, from the headings asked for, and nothing is broken."""
    document = json.loads((EXAMPLES / "wide-and-irregular.geojson").read_text())
    assert findings(document) == ()
    plan = make_plan(read_scenario(document))
    assert plan.violations == ()
    assert plan.uncovered == ()
    assert set(plan.metrics.coverage.values()) == {1.0}
    collects: dict[str, list[float]] = {}
    for collect in plan.collects:
        collects.setdefault(collect.roi, []).append(collect.heading_deg)
    assert len(collects["tidal-flats"]) > 2
    assert len(collects["buoy"]) == 2
    assert all(abs(heading - 60.0) < 0.5 for heading in collects["salt-pans"])
    # The port's arms are at right angles, and so are the passes along them.
    assert len(collects["port"]) == 2
    assert plan == make_plan(read_scenario(document))
    assert plan.methods["coverage"] == "sweeps"
