"""Random searches of every kind come home with their reserve: some in each run, a hundred by command.

``SWATHPLAN_RANDOM=all`` plans them all.
"""

from __future__ import annotations

import json
import os

import pytest

from benchmarks.mixed_searches import flights_of, mixed_search
from benchmarks.search_scenarios import random_search
from planner.geojson import write_plan
from planner.pipeline import make_plan
from planner.validate import findings, read_valid

NUMBERS = range(100) if os.environ.get("SWATHPLAN_RANDOM") == "all" else (16, 20)
#: Reckoned by the published line's vertices and by the flight's pieces.
NEAR = 0.01


@pytest.mark.parametrize("number", NUMBERS)
def test_every_flight_of_a_search_comes_home_with_its_reserve(number: int) -> None:
    """By the plan's own words, by its judge, and by geodesics along its line in the wind."""
    document, rasters = mixed_search(number)
    plan = make_plan(read_valid(document, rasters))
    assert plan.violations == ()
    assert plan.metrics.area_seen_m2
    flights = list(flights_of(document, json.loads(json.dumps(write_plan(plan)))))
    assert flights
    for name, usable_wh, said_wh, reckoned_wh in flights:
        assert said_wh <= usable_wh, name
        if reckoned_wh is not None:
            assert reckoned_wh == pytest.approx(said_wh, rel=NEAR), name


def test_searches_that_can_be_flown_are_not_refused() -> None:
    """Starts and ends near edges and zones, where the way straight from one to the other has no room."""
    asked = [(random_search(number), {}) for number in (101, 170, 206)] + [mixed_search(104)]
    refused = [f for document, rasters in asked for f in findings(document, rasters) if f.severity == "error"]
    assert refused == []
