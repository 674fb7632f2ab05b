"""What the paper's choices are among: of each region its collection neighbourhoods, graded by their room."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from planner.airspace.airspace import Airspace, Level
from planner.coverage.merge import PAPER_RADIUS_M, MergedRegion, merge_regions
from planner.coverage.strips.choices import Choices, choices
from planner.coverage.strips.neighbourhood import check_sensor
from planner.coverage.strips.room import Room
from planner.errors import InfeasibleError
from planner.progress import Progress, Stop, raise_if
from planner.sensors.base import Sensor
from planner.sensors.sar import SarSensor
from planner.sensors.suite import Suite
from planner.wishes import Region


@dataclass(frozen=True, slots=True)
class Located:
    """Choices of each region that can be seen, and why those that need not be are left out."""

    choices: tuple[Choices, ...]
    dropped: tuple[InfeasibleError, ...]


def located(
    regions: tuple[Region, ...],
    suite: Suite,
    airspace: Airspace,
    level: Level,
    room_at: Callable[[Level], Room],
    progress: Progress,
    stop: Stop,
    *,
    radius_m: float = PAPER_RADIUS_M,
) -> Located:
    """Merge, classify, locate: steps 1 and 2 of Algorithm 1 of Li, Chen, Wang, Li (2018).

    Parameters
    ----------
    room_at
        The room there is at a level.
    progress
        Gets ``"coverage"`` with the fraction done.
    radius_m
        Of the close filter.

    Raises
    ------
    InfeasibleError
        Where a required region cannot be seen.
    CancelledError
        Once ``stop`` says so.
    """
    wanted, dropped = _sharp_enough(regions, suite, airspace, level)
    merged = merge_regions(wanted, radius_m, suite.first)
    found: list[Choices] = []
    for number, region in enumerate(merged):
        raise_if(stop)
        progress("coverage", number / len(merged))
        own = level.of(region)
        sensor, height_m = _strips(region.label, *suite.over(region.sensor, region.area, airspace, own))
        choices_of, failed = _locate(region, sensor, height_m, room_at(own))
        found.extend(choices_of)
        dropped.extend(failed)
    return Located(tuple(found), tuple(dropped))


def _sharp_enough(
    regions: tuple[Region, ...], suite: Suite, airspace: Airspace, level: Level
) -> tuple[tuple[Region, ...], list[InfeasibleError]]:
    """The regions whose sensor is good enough, and why the others that are not required are left out."""
    kept: list[Region] = []
    dropped: list[InfeasibleError] = []
    for region in regions:
        try:
            over = suite.over(region.sensor, region.area, airspace, level.of(region))
            check_sensor(region, *_strips(region.name, *over))
        except InfeasibleError as reason:
            if region.required:
                raise
            dropped.append(reason)
        else:
            kept.append(region)
    return tuple(kept), dropped


def _strips(name: str, sensor: Sensor, height_m: float) -> tuple[SarSensor, float]:
    """The same where the sensor is one the paper is about."""
    if isinstance(sensor, SarSensor):
        return sensor, height_m
    raise InfeasibleError(
        "method",
        name,
        f"the paper's methods see with a SAR, {sensor.name} is of type {sensor.kind}",
        "set method.coverage and method.routing to auto",
    )


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
