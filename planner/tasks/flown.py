"""What was seen of a scenario's regions by flights of a plan for it."""

from __future__ import annotations

from collections.abc import Sequence

from planner.as_flown import coverage
from planner.as_flown.track import Record, TrackSample
from planner.plan import Plan
from planner.scenario import Scenario


def flown_coverage(scenario: Scenario, plan: Plan, track: Sequence[TrackSample]) -> coverage.FlownCoverage:
    """Of one flight by its track alone."""
    return sortie_coverage(scenario, plan, (Record(tuple(track)),))


def sortie_coverage(scenario: Scenario, plan: Plan, records: Sequence[Record]) -> coverage.FlownCoverage:
    """Of several flights together; see ``planner.as_flown.coverage.flown_coverage``."""
    asked = coverage.Asked(
        scenario.frame, scenario.regions, scenario.suite, scenario.aircraft, scenario.airspace
    )
    return coverage.flown_coverage(asked, plan, records)
