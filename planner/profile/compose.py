"""Rise, passes, legs and fall put together to one flight."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from planner.dubins.path import Path, Segment, join
from planner.plan import Finish
from planner.profile.change import Changed
from planner.profile.flight import Flight, Times, whole_flight
from planner.profile.heights import Heights
from planner.profile.rise import Rise
from planner.profile.slowed import slowed
from planner.profile.smoothed import smoothed_times
from planner.profile.times import rotor_times, wing_times
from planner.route import CollectPass
from planner.vehicle.manners import LIFT_OFF_HEIGHT_M, manners_of
from planner.vehicle.model import FlightModel

Span = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Composed:
    """A flight, and the distances over the ground between which its legs and its passes lie.

    The first leg begins where the mission does, the last one ends there; ``finish`` is how the flight ends.
    """

    flight: Flight
    legs_m: tuple[Span, ...]
    passes_m: tuple[Span, ...]
    finish: Finish


def compose(
    up: Rise,
    between: Sequence[Changed],
    passes: Sequence[tuple[CollectPass | None, Heights]],
    down: Rise,
    finish: Finish,
    times: Times,
) -> Composed:
    """Put a flight together.

    Parameters
    ----------
    up, down
        To the first station, and from the last.
    between
        From each station to the next.
    passes
        The pass of each station, None where one is only flown over, and its heights.
    """
    pieces: list[Path] = [up.path]
    heights: Heights = up.heights
    legs_m: list[Span] = [(up.turns_m, up.path.length_m)]
    passes_m: list[Span] = []
    for k, (collect, own) in enumerate(passes):
        at_m = heights.length_m
        if collect is not None:
            passes_m.append((at_m, at_m + collect.length_m))
            pieces.append(Path((Segment("straight", collect.entry, collect.length_m),)))
            heights = heights.then(own)
        if k < len(between):
            leg = between[k]
            legs_m.append((heights.length_m, heights.length_m + leg.path.length_m))
            pieces.append(leg.path)
            heights = heights.then(leg.heights)
    begun_m = heights.length_m
    pieces.append(down.path)
    heights = heights.then(down.heights)
    whole_m = heights.length_m
    legs_m.append((begun_m, whole_m - down.turns_m))
    bounds_m = (up.run_m, up.turns_m, whole_m - down.turns_m, whole_m - down.run_m)
    inserted_m = up.inserted_m + math.fsum(leg.inserted_m for leg in between) + down.inserted_m
    flight = whole_flight(join(*pieces), heights, bounds_m, passes_m, inserted_m, times, LIFT_OFF_HEIGHT_M)
    flown = [collect for collect, _ in passes if collect is not None]
    return Composed(slowed(flight, flown, passes_m, times), tuple(legs_m), tuple(passes_m), finish)


def times_of(model: FlightModel, datum_amsl_m: float) -> Times:
    """How long the stretches of an aircraft's flight take.

    Parameters
    ----------
    datum_amsl_m
        Height over mean sea level of the flight's datum, for the density of the air.
    """
    manners = manners_of(model.aircraft)
    if model.aircraft.type == "multirotor":
        rotor = smoothed_times if manners.corner_m > 0.0 else rotor_times
        return partial(rotor, airspeed_m_s=model.airspeed_m_s, manners=manners, wind=model.wind)
    return partial(
        wing_times, aircraft=model.aircraft, manners=manners, wind=model.wind, datum_amsl_m=datum_amsl_m
    )
