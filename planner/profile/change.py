"""From one height to another on a leg in flight: between passes that are flown at heights of their own."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from planner.dubins.path import Path
from planner.profile.ends import Surround, climb_slope_rad, sink_slope_rad, terms_of
from planner.profile.heights import Heights, level, tidy
from planner.profile.lines import cut
from planner.profile.rise import Terms, climbed_leg, conflicts
from planner.vehicle.model import FlightModel

#: Slopes steeper than this is straight up.
STRAIGHT_UP_RAD = math.radians(89.0)


@dataclass(frozen=True, slots=True)
class Changed:
    """A leg with its heights, and the length over the ground of turns flown for the sake of height."""

    path: Path
    heights: Heights
    inserted_m: float = 0.0


def kept(leg: Path, altitude_m: float) -> Changed:
    """A leg at one altitude."""
    return Changed(leg, level(leg.length_m, altitude_m))


def changed(leg: Path, from_m: float, to_m: float, model: FlightModel, around: Surround) -> Changed:
    """A leg that begins at one altitude and ends, level, at another.

    It climbs as soon, and descends as late, as it can. Where it is too short wings fly whole turns, placed as
    those behind a take-off are; what hovers changes its height on the spot.

    Parameters
    ----------
    around
        Its top is the higher of both; its zones count anywhere between them.

    Raises
    ------
    InfeasibleError
        Where there is no place for turns.
    """
    if model.aircraft.type == "multirotor":
        return _hovered(leg, from_m, to_m, math.radians(model.max_climb_deg))
    if from_m < to_m:
        path, heights, _ = climbed_leg(from_m, leg, terms_of(around, climb_slope_rad(model), model))
        return Changed(path, heights, path.length_m - leg.length_m)
    terms = terms_of(around, sink_slope_rad(model), model)
    late = _late(leg, from_m, to_m, terms)
    if late is not None:
        return Changed(leg, late)
    # A descent is a climb with the heights turned over.
    mirrored = _turned_over(from_m + to_m)
    climb = replace(terms, too_low=lambda path, heights: terms.too_low(path, mirrored(heights)))
    path, heights, _ = climbed_leg(to_m, leg, climb)
    return Changed(path, mirrored(heights), path.length_m - leg.length_m)


def _late(leg: Path, from_m: float, to_m: float, terms: Terms) -> Heights | None:
    """Down on the last of the leg; None where that is too short, or not clear."""
    until_m = leg.length_m - terms.level_off_m
    since_m = until_m - terms.run_for_m(from_m - to_m)
    if since_m < 0.0:
        return None
    heights = Heights(tidy(((0.0, from_m), (since_m, from_m), (until_m, to_m), (leg.length_m, to_m))))
    if any(conflicts(cut(leg, since_m, leg.length_m), terms.zones)) or terms.too_low(leg, heights):
        return None
    return heights


def _turned_over(sum_m: float) -> Callable[[Heights], Heights]:
    return lambda heights: Heights(tuple((at_m, sum_m - altitude_m) for at_m, altitude_m in heights.knots))


def _hovered(leg: Path, from_m: float, to_m: float, slope_rad: float) -> Changed:
    """What can stop: along the leg as steeply as it may, else on the spot, between both passes."""
    run_m = 0.0 if slope_rad >= STRAIGHT_UP_RAD else abs(to_m - from_m) / math.tan(slope_rad)
    knots: tuple[tuple[float, float], ...]
    if not 0.0 < run_m < leg.length_m:
        half_m = 0.5 * leg.length_m
        knots = ((0.0, from_m), (half_m, from_m), (half_m, to_m), (leg.length_m, to_m))
    elif from_m < to_m:
        knots = ((0.0, from_m), (run_m, to_m), (leg.length_m, to_m))
    else:
        knots = ((0.0, from_m), (leg.length_m - run_m, from_m), (leg.length_m, to_m))
    return Changed(leg, Heights(knots))
