"""The route of Li, Chen, Wang, Li (2018): steps 1 to 3 of Algorithm 1, one decision after the other."""

from __future__ import annotations

from dataclasses import dataclass

from planner.airspace.shapes import acts
from planner.coverage.merge import PAPER_RADIUS_M, MergedRegion, merge_regions
from planner.coverage.neighbourhood import check_sensor
from planner.errors import InfeasibleError
from planner.progress import Progress, Stop, never, raise_if, silent
from planner.route import Anchor, CollectPass, Route
from planner.routing.greedy.approach import best_approach
from planner.routing.greedy.choices import Choices, choices
from planner.routing.greedy.offsets import best_passes
from planner.routing.greedy.room import Room
from planner.routing.tour import TourMethod, order
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.sensors.view import sensing
from planner.vehicle.aircraft import Aircraft
from planner.wishes import Region


@dataclass(frozen=True, slots=True)
class Greedy:
    """A route and how it came about.

    Parameters
    ----------
    route
        The passes in flight order.
    regions
        What was visited, in that order: merged neighbours, or parts of a region.
    dropped
        Why regions that are not required were left out.
    """

    route: Route
    regions: tuple[MergedRegion, ...]
    dropped: tuple[InfeasibleError, ...]


def li2018_route(
    scenario: Scenario, progress: Progress = silent, stop: Stop = never, *, threat_aware: bool = False
) -> Route:
    """The route alone; see ``greedy``."""
    return greedy(scenario, progress, stop, threat_aware=threat_aware).route


def greedy(
    scenario: Scenario,
    progress: Progress = silent,
    stop: Stop = never,
    *,
    threat_aware: bool = False,
    tour: TourMethod = "genetic",
    radius_m: float = PAPER_RADIUS_M,
    aircraft: Aircraft | None = None,
) -> Greedy:
    """Merge, classify, locate, order, choose angles, choose offsets.

    The operating area and hard zones are always kept (constraint c4), and choices that leave room to turn at
    both ends go before others.

    Parameters
    ----------
    progress
        Gets ``"coverage"`` and ``"routing"`` with the fraction done of these two together.
    threat_aware
        Also leave out, wherever there is another, choices whose line enters a soft threat or that leave no
        room to turn outside of one. The paper leaves threats out here (its section 6, relaxation 4).
    tour
        Method of the visiting order; ``"genetic"`` is the paper's.
    radius_m
        Of the close filter.
    aircraft
        The one that flies; by default the scenario's first.

    Raises
    ------
    InfeasibleError
        Where a required region cannot be seen.
    CancelledError
        Once ``stop`` says so.
    """
    flown_by = aircraft or scenario.aircraft[0]
    room = Room.of(scenario, flown_by, threat_aware=threat_aware)
    wanted, dropped = _sharp_enough(scenario)
    merged = merge_regions(wanted, radius_m, scenario.sensors[0].name)
    located: list[Choices] = []
    for number, region in enumerate(merged):
        raise_if(stop)
        progress("coverage", 0.8 * number / len(merged))
        sensor, height_m = sensing(scenario, _sensor(scenario, region), region.area)
        found, failed = _locate(region, sensor, height_m, room)
        located.extend(found)
        dropped.extend(failed)
    raise_if(stop)
    progress("routing", 0.8)
    places = [item.region.centroid for item in located]
    visiting = order(places, scenario.start.position, scenario.end.position, tour, scenario.seed)
    threats = tuple(threat for threat in scenario.threats if acts(threat, scenario.height_m))
    origin = Anchor(*scenario.start.position, scenario.start.angle_rad)
    passes: list[CollectPass] = []
    for number, place in enumerate(visiting):
        raise_if(stop)
        progress("routing", 0.8 + 0.2 * number / len(visiting))
        region_choices = located[place]
        side, index = best_approach(origin, region_choices)
        passes.extend(
            best_passes(
                origin, region_choices, region_choices.sides[side], index, threats, scenario.objective
            )
        )
        origin = Anchor(*passes[-1].end, passes[-1].angle_rad)
    progress("routing", 1.0)
    return Greedy(Route(tuple(passes)), tuple(located[place].region for place in visiting), tuple(dropped))


def _sharp_enough(scenario: Scenario) -> tuple[tuple[Region, ...], list[InfeasibleError]]:
    """The regions whose sensor is good enough, and why the others that are not required are left out."""
    kept: list[Region] = []
    dropped: list[InfeasibleError] = []
    for region in scenario.regions:
        try:
            check_sensor(region, *sensing(scenario, scenario.sensor_for(region), region.area))
        except InfeasibleError as reason:
            if region.required:
                raise
            dropped.append(reason)
        else:
            kept.append(region)
    return tuple(kept), dropped


def _sensor(scenario: Scenario, region: MergedRegion) -> SarSensor:
    return next((s for s in scenario.sensors if s.name == region.sensor), scenario.sensors[0])


def _locate(
    region: MergedRegion, sensor: SarSensor, height_m: float, room: Room
) -> tuple[list[Choices], list[InfeasibleError]]:
    """Choices for a region; for its parts one by one where together they are too much for two passes."""
    try:
        return [choices(region, sensor, height_m, room)], []
    except InfeasibleError as reason:
        parts = region.split()
        if len(parts) == 1:
            if region.required:
                raise
            return [], [reason]
    found: list[Choices] = []
    failed: list[InfeasibleError] = []
    for part in parts:
        choices_of, reasons = _locate(part, sensor, height_m, room)
        found.extend(choices_of)
        failed.extend(reasons)
    return found, failed
