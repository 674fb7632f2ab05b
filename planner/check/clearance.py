"""Where the aircraft may be: the operating area, zones and threats, and the ground below."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Point

from planner.airspace.shapes import Banded, DiscShape, banded_shapes
from planner.check.heights import between
from planner.check.places import PLACE_TOLERANCE_M, lonlat, middle
from planner.plan import FlownPath, Plan, Violation
from planner.scenario import Scenario


def place_violations(
    scenario: Scenario, path: FlownPath, line_m: NDArray[np.float64], heights_m: NDArray[np.float64]
) -> Iterator[Violation]:
    """What of a line is outside the operating area, in or too near to what is hard, or in a soft threat.

    Parameters
    ----------
    heights_m
        Of the line's vertices over home: zones count where the line is between their floor and their ceiling.
    """
    line = LineString(line_m)
    if scenario.area is not None:
        allowed = scenario.area.buffer(PLACE_TOLERANCE_M)
        shapely.prepare(allowed)
        # Lines that circle hundreds of times over each other are cut but slowly.
        outside = LineString() if allowed.covers(line) else line.difference(allowed)
        if not outside.is_empty:
            yield Violation(
                "area",
                path.vehicle,
                f"{outside.length:.1f} m are flown outside the operating area",
                float(outside.length),
                "m",
                middle(scenario, outside),
            )
    if scenario.looked_at is not None and not scenario.looked_at.covers(line):
        beyond = line.difference(scenario.looked_at)
        yield Violation(
            "zones-unknown",
            path.vehicle,
            f"{beyond.length:.1f} m are flown where zones were left out as too far off",
            float(beyond.length),
            "m",
            middle(scenario, beyond),
        )
    home_amsl_m = scenario.level.amsl_m - scenario.level.height_m
    for banded in banded_shapes(scenario.airspace, home_amsl_m):
        shape = banded.shape
        low = between(line_m, heights_m, banded.low_m, banded.high_m)
        depth_m = 0.0 if low.is_empty else shape.depth_m(low)
        if depth_m <= 0.0:
            yield from _too_near(scenario, banded, line_m, heights_m)
            continue
        inside = low.intersection(shape.polygon())
        yield Violation(
            "hard-zone" if banded.hard else "soft-threat",
            shape.name,
            f"{inside.length:.1f} m are flown inside {shape.name}, up to {depth_m:.1f} m deep",
            float(inside.length),
            "m",
            middle(scenario, inside),
            hard=banded.hard,
        )


def begun_violations(scenario: Scenario) -> Iterator[Violation]:
    """Where aircraft in flight enter what is hard, or leave the area, before the plan begins.

    They fly by another plan until then: this one can help it by nothing but beginning sooner, so that none of
    it forbids the upload.
    """
    going_on = scenario.going_on
    if going_on is None:
        return
    home_amsl_m = scenario.level.amsl_m - scenario.level.height_m
    hard = [banded for banded in banded_shapes(scenario.airspace, home_amsl_m) if banded.hard]
    flying = {aircraft.name: aircraft for aircraft in scenario.aircraft}
    for name, places in going_on.until.items():
        if name not in flying:
            continue
        # Told over where it took off, and zones count from the scenario's home.
        took_off = scenario.ends_of(flying[name])[0].ground
        higher_m = 0.0 if scenario.terrain is None else float(scenario.terrain.at(took_off)) - home_amsl_m
        line_m, heights_m = np.array(places)[:, :2], np.array(places)[:, 2] + higher_m
        entered = [
            (banded.shape.name, between(line_m, heights_m, banded.low_m, banded.high_m).intersection(shape))
            for banded in hard
            for shape in (banded.shape.polygon(),)
        ]
        if scenario.area is not None:
            outside = LineString(line_m).difference(scenario.area.buffer(PLACE_TOLERANCE_M))
            entered.append(("the outside of the area", outside))
        for zone, inside in entered:
            if inside.length <= PLACE_TOLERANCE_M:
                continue
            yield Violation(
                "hard-zone",
                zone,
                f"{name} flies {inside.length:.1f} m inside {zone} by the old plan, before this one begins "
                f"{going_on.begins_in_s:g} s after it was asked for",
                float(inside.length),
                "m",
                middle(scenario, inside),
                hard=False,
            )


def _too_near(
    scenario: Scenario, banded: Banded, line_m: NDArray[np.float64], heights_m: NDArray[np.float64]
) -> Iterator[Violation]:
    """Where a line that stays out of something hard comes nearer to it than ``clearance_m``."""
    kept_m, shape = banded.kept_m, banded.shape
    if not banded.hard or kept_m <= 0.0:
        return
    beside = between(line_m, heights_m, banded.low_m - kept_m, banded.high_m + kept_m)
    if beside.is_empty:
        return
    away_m = shape.away_m(beside)
    if away_m >= kept_m - PLACE_TOLERANCE_M:
        return
    core = Point(shape.centre) if isinstance(shape, DiscShape) else shape.area
    place = shapely.shortest_line(beside, core).coords[0]
    yield Violation(
        "clearance",
        shape.name,
        f"the line comes to {away_m:.1f} m from {shape.name}, of which {kept_m:g} m are to be kept clear",
        kept_m - away_m,
        "m",
        lonlat(scenario, (place[0], place[1])),
    )


def clearance_violations(
    scenario: Scenario, plan: Plan, path: FlownPath, line_m: NDArray[np.float64]
) -> Iterator[Violation]:
    """Height over the ground all along the line, no farther apart than half the ground's posts.

    From where the flight has first reached what is kept to where it last leaves it; before and behind that
    it is over the ground.
    """
    ground = scenario.terrain
    if ground is None:
        return
    altitude_m = np.array([place[2] for place in path.line])
    if plan.altitude_reference != "amsl":
        altitude_m = altitude_m + (scenario.home_amsl_m or 0.0)
    reached_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line_m, axis=0).T))])
    count = max(2, math.ceil(reached_m[-1] / (ground.step_m / 2.0)) + 1)
    at_m = np.union1d(np.linspace(0.0, reached_m[-1], count), reached_m)
    places = np.stack([np.interp(at_m, reached_m, line_m[:, k]) for k in (0, 1)], axis=1)
    clear_m = np.interp(at_m, reached_m, altitude_m) - ground.at(places)
    unknown = np.isnan(clear_m)
    if unknown.any():
        length_m = float(unknown.mean() * reached_m[-1])
        yield Violation(
            "terrain-clearance",
            path.vehicle,
            f"about {length_m:.0f} m are flown where the raster {ground.name} has no heights",
            length_m,
            "m",
            lonlat(scenario, places[int(np.argmax(unknown))]),
        )
    clear_m = np.where(unknown, np.inf, clear_m)
    high = np.flatnonzero(clear_m >= scenario.over_ground_m)
    if len(high) == 0:
        wanted_m = np.full(len(clear_m), scenario.over_ground_m)
    else:
        wanted_m = np.zeros(len(clear_m))
        wanted_m[high[0] : high[-1] + 1] = scenario.over_ground_m
    worst = int(np.argmin(clear_m - wanted_m))
    if clear_m[worst] < wanted_m[worst] - PLACE_TOLERANCE_M:
        yield Violation(
            "terrain-clearance",
            path.vehicle,
            f"{clear_m[worst]:.1f} m over the ground, {wanted_m[worst]:g} m are to be kept",
            float(wanted_m[worst] - clear_m[worst]),
            "m",
            lonlat(scenario, places[worst]),
        )
