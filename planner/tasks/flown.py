"""What was seen of a scenario's regions by a flight of a plan for it."""

from __future__ import annotations

from collections.abc import Sequence

from planner.coverage import flown
from planner.plan import Plan
from planner.scenario import Scenario


def flown_coverage(scenario: Scenario, plan: Plan, track: Sequence[flown.TrackSample]) -> flown.FlownCoverage:
    """See ``planner.coverage.flown.flown_coverage``."""
    asked = flown.Asked(
        scenario.frame, scenario.regions, scenario.suite, scenario.aircraft, scenario.airspace
    )
    return flown.flown_coverage(asked, plan, track)
