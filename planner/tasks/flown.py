"""What was seen of a scenario's regions by flights of a plan for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from planner.airspace.built import bare_ground
from planner.as_flown import coverage, looks
from planner.as_flown.photo_judge import PhotoJudge
from planner.as_flown.track import Record, TrackSample
from planner.plan import Plan
from planner.scenario import Scenario


def flown_coverage(scenario: Scenario, plan: Plan, track: Sequence[TrackSample]) -> coverage.FlownCoverage:
    """Of one flight by its track alone."""
    return sortie_coverage(scenario, plan, (Record(tuple(track)),))


def sortie_coverage(scenario: Scenario, plan: Plan, records: Sequence[Record]) -> coverage.FlownCoverage:
    """Of several flights together; see ``planner.as_flown.coverage.flown_coverage``."""
    return coverage.flown_coverage(_asked(scenario), plan, records)


def sortie_photos(scenario: Scenario, plan: Plan, records: Sequence[Record]) -> PhotoJudge:
    """The photos of several flights together, to be laid on grids."""
    return coverage.photo_judge(_asked(scenario), plan, records)


def sortie_looks(scenario: Scenario, plan: Plan, records: Sequence[Record]) -> tuple[looks.FlownLook, ...]:
    """Pass by pass of several flights; see ``planner.as_flown.looks.flown_looks``."""
    return looks.flown_looks(_asked(scenario), plan, records)


def _asked(scenario: Scenario) -> coverage.Asked:
    """Of regions the ground that nothing stands on, as the judge of plans asks for."""
    airspace = scenario.airspace
    regions = tuple(
        replace(region, area=bare_ground(region.area, airspace, scenario.level.of(region)))
        for region in scenario.regions
    )
    return coverage.Asked(scenario.frame, regions, scenario.suite, scenario.aircraft, airspace)
