"""Rules between features: what each is right by itself, and wrong together."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from shapely.geometry import Point

from planner.airspace.airspace import Level
from planner.airspace.growth import grown
from planner.airspace.shapes import banded_shapes
from planner.geojson.equipment import OWN_ORDER
from planner.geojson.fields import Findings
from planner.route import Terminal
from planner.scenario import Scenario

#: Left between a start or end and what is kept clear of it: what lines keep besides.
ROOM_M = 2.0
#: A region may stick out of the area by this much: the rounding of coordinates, not a wish.
AREA_TOLERANCE_M = 0.05


def check_together(scenario: Scenario, findings: Findings) -> None:
    """Add a finding for each rule between features that the scenario breaks."""
    _names(scenario, findings)
    _swaths(scenario, findings)
    _by_paper(scenario, findings)
    _patterns(scenario, findings)
    _area(scenario, findings)
    _terminals(scenario, findings)


def _names(scenario: Scenario, findings: Findings) -> None:
    for kind, names in (
        ("vehicle", [a.name for a in scenario.aircraft]),
        ("sensor", [s.name for s in scenario.sensors]),
    ):
        for name in sorted({n for n in names if names.count(n) > 1}):
            findings.error(
                f"{kind} {name}", "duplicate-id", f"is the name of two {kind}s", "Name each its own."
            )
    sensors = {s.name for s in scenario.sensors}
    for region in scenario.regions:
        if region.sensor is not None and region.sensor not in sensors:
            findings.error(
                region.name,
                "unknown-sensor",
                f"asks for the sensor {region.sensor!r}",
                f"Use one of: {', '.join(sorted(sensors))}.",
            )
    for name, level in _levels(scenario):
        if level.height_m <= 0.0:
            findings.error(
                name,
                "altitude-below-ground",
                f"altitude_m {level.altitude_m:g} is not above home, {scenario.home_amsl_m or 0.0:g} m amsl",
                "Raise altitude_m.",
            )
    _bases_below(scenario, findings)


def _bases_below(scenario: Scenario, findings: Findings) -> None:
    """Over terrain nobody takes off from, or lands on, ground that is not below all that is flown level."""
    level = scenario.level
    lowest_m = level.amsl_m - level.depth_m
    if scenario.terrain is None or level.height_m <= level.depth_m:
        return
    for end in _ends(scenario):
        ground_m = float(scenario.terrain.at(end.position))
        if end.role != "in-flight" and ground_m >= lowest_m:
            findings.error(
                end.feature,
                "altitude-below-ground",
                f"lies at {ground_m:.0f} m amsl, and passes are flown at {lowest_m:.0f} m",
                f"Raise altitude_m, or {end.move.lower()} to lower ground.",
            )


def _levels(scenario: Scenario) -> list[tuple[str, Level]]:
    """Each level that regions are seen from, and what asks for it: the scenario, or a region."""
    if scenario.level.depth_m <= 0.0 and scenario.level.altitude_m == scenario.altitude_m:
        return [("scenario", scenario.level)]
    found: dict[Level, str] = {}
    for region in scenario.regions:
        found.setdefault(scenario.level.of(region), region.name)
    return [(name, level) for level, name in found.items()]


def _swaths(scenario: Scenario, findings: Findings) -> None:
    heights_m = [level.height_m for _, level in _levels(scenario)]
    if scenario.terrain is not None or min(heights_m) <= 0.0:
        return
    for sensor, height_m in itertools.product(scenario.sensors, heights_m):
        if sensor.swath_m(height_m) <= 0.0:
            findings.error(
                f"sensor {sensor.name}",
                "swath-not-positive",
                f"has margins that leave nothing of its swath of "
                f"{sensor.whole().swath_m(height_m):.0f} m from {height_m:.0f} m",
                "Lower position_margin_m or pointing_margin_deg, or raise altitude_m.",
            )


def _by_paper(scenario: Scenario, findings: Findings) -> None:
    """The paper's routing and coverage know one visit, and radars."""
    method = scenario.method
    if method.routing == "joint" or (method.routing, method.coverage) == ("auto", "auto"):
        return
    if method.coverage in OWN_ORDER:
        _by_sweeps(scenario, findings)
        return
    for region in scenario.regions:
        if region.revisits > 1:
            findings.error(
                region.name,
                "not-supported",
                f"asks for {region.revisits} visits, which the paper's routing does not plan",
                "Leave method.routing and method.coverage at auto, or revisits at 1.",
            )
        if (kind := scenario.sensor_for(region).kind) != "sar" and "unknown-sensor" not in {
            found.rule for found in findings.all()
        }:
            findings.error(
                region.name,
                "not-supported",
                f"is seen by a {kind}, which the paper's routing and coverage do not plan",
                "Leave method.routing and method.coverage at auto.",
            )


def _by_sweeps(scenario: Scenario, findings: Findings) -> None:
    """Footprint sweeps see what is below, once, in directions of their own."""
    name = scenario.method.coverage
    for region in scenario.regions:
        wishes = {
            "approach_deg": region.approach_rad is not None,
            "revisits": region.revisits > 1,
            "pattern": region.pattern != "auto",
        }
        for wish in (wish for wish, asked in wishes.items() if asked):
            findings.error(
                region.name,
                "not-supported",
                f"has {wish}; coverage {name} sees a region once, in a direction of its own",
                f"Leave {wish} out, or method.coverage at auto.",
            )
        if (kind := scenario.sensor_for(region).kind) != "camera" and "unknown-sensor" not in {
            found.rule for found in findings.all()
        }:
            findings.error(
                region.name,
                "not-supported",
                f"is seen by a {kind}; coverage {name} sweeps the ground below with a camera",
                "See it with a camera, or leave method.coverage at auto.",
            )


def _patterns(scenario: Scenario, findings: Findings) -> None:
    """Patterns are those of photos."""
    if "unknown-sensor" in {found.rule for found in findings.all()}:
        return
    for region in scenario.regions:
        kind = scenario.sensor_for(region).kind
        if region.pattern not in ("auto", "lanes") and kind != "camera":
            findings.error(
                region.name,
                "pattern-of-cameras",
                f"has the pattern {region.pattern}, which is one of photos, and is seen by a {kind}",
                "Name a camera as its sensor, or leave pattern out.",
            )


def _area(scenario: Scenario, findings: Findings) -> None:
    area = scenario.area
    if area is None:
        return
    wide = area.buffer(AREA_TOLERANCE_M)
    for region in scenario.regions:
        if not wide.covers(region.area):
            outside_m2 = region.area.difference(area).area
            findings.error(
                region.name,
                "roi-outside-area",
                f"has {outside_m2:.0f} m² of {region.area.area:.0f} m² outside the operating area",
                "Enlarge the area or cut the region to it.",
            )
    for end in _ends(scenario):
        if not wide.covers(Point(end.position)):
            findings.error(
                end.feature,
                "outside-area",
                f"{end.is_there} outside the operating area",
                f"{end.move} inside, or enlarge the area.",
            )
    for aircraft in scenario.aircraft:
        if grown(area, -aircraft.min_turn_radius_m).is_empty:
            findings.error(
                f"vehicle {aircraft.name}",
                "turn-radius-exceeds-area",
                f"cannot turn within the operating area with a radius of {aircraft.min_turn_radius_m:.0f} m",
                "Enlarge the area, or fly slower or with more bank.",
            )


def _terminals(scenario: Scenario, findings: Findings) -> None:
    """Neither end lies in what is hard, nor nearer to it than is to be kept."""
    level = scenario.level
    for banded in banded_shapes(scenario.airspace, level.amsl_m - level.height_m):
        if not banded.hard or not banded.counts(*level.counted_m):
            continue
        shape = banded.shape
        for end in _ends(scenario):
            away_m = shape.away_m(Point(end.position))
            if away_m <= 0.0:
                findings.error(
                    end.feature,
                    f"{end.role}-in-hard-zone",
                    f"{end.is_there} inside {shape.name}, which may never be entered",
                    f"{end.move} out of {shape.name}.",
                )
            elif away_m < banded.kept_m:
                findings.error(
                    end.feature,
                    f"{end.role}-within-clearance",
                    f"{end.is_there} {away_m:.1f} m from {shape.name}, of which {banded.kept_m:g} m are kept"
                    " clear",
                    f"{end.move} away, or set clearance_m to {_whole_or_tenths(away_m - ROOM_M):g} at most.",
                )


def _whole_or_tenths(length_m: float) -> float:
    """A length rounded down, never below 0."""
    return max(0.0, math.floor(length_m) if length_m >= 1.0 else math.floor(10.0 * length_m) / 10.0)


@dataclass(frozen=True, slots=True)
class _End:
    """Where a flight starts or ends: a place on the ground, or where an aircraft flies already."""

    feature: str
    role: str
    position: tuple[float, float]

    @property
    def is_there(self) -> str:
        return "flies" if self.role == "in-flight" else "lies"

    @property
    def move(self) -> str:
        return "Fly it" if self.role == "in-flight" else "Move it"


def _ends(scenario: Scenario) -> tuple[_End, ...]:
    """Those on the ground once each, then those in the air."""
    if scenario.bases:
        based = {base.position for base in scenario.bases}
        ground = [
            _End(each.name, "base" if each.position in based else _role(scenario, each), each.position)
            for each in scenario.terminals()
            if each.over_home_m is None
        ]
    else:
        both = {end.position: end for end in (scenario.end, scenario.start)}
        ground = [_End(each.name, _role(scenario, each), each.position) for each in reversed(both.values())]
    starts = [(aircraft, scenario.ends_of(aircraft)[0]) for aircraft in scenario.aircraft]
    aloft = [
        _End(f"vehicle {aircraft.name}", "in-flight", start.position)
        for aircraft, start in starts
        if start.over_home_m is not None
    ]
    return (*ground, *aloft)


def _role(scenario: Scenario, terminal: Terminal) -> str:
    return "start" if terminal.position == scenario.start.position else "end"
