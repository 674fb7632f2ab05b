"""Regions that need not be seen, left out where the aircraft cannot fly to all.

Greedily: the one whose priority is least for the way that leaving it out saves goes first, until the rest is
within the limits; the rest is planned anew, and what was left out is tried again, the best for its way first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol, TypeVar

from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import Excess, Use, exceeded

Point = tuple[float, float]

#: So many of those left out are tried again.
TRIED_AGAIN = 4
#: Saving less way than this is saving none.
LEAST_SAVING_M = 1.0


class Flight(Protocol):
    """A planned flight."""

    @property
    def passes(self) -> tuple[CollectPass, ...]:
        """In flight order."""

    @property
    def use(self) -> Use:
        """Of the whole flight."""


F = TypeVar("F", bound=Flight)


@dataclass(frozen=True, slots=True)
class Dropped:
    """A region left out: the limit that a flight with it is over, and its priority by the metre it takes."""

    name: str
    excess: Excess
    worth: float


def within_limits(
    first: F,
    again: Callable[[frozenset[str]], F],
    optional: Mapping[str, float],
    aircraft: Aircraft,
    ends: tuple[Point, Point],
) -> tuple[F, tuple[Dropped, ...]]:
    """The flight with as many of the optional regions as the aircraft can fly to.

    Parameters
    ----------
    first
        The flight to all regions.
    again
        Plans without the regions named.
    optional
        Priority of each region that need not be seen.
    ends
        Start and end of the flight.

    Returns
    -------
    tuple
        The flight, still over a limit where the required regions alone are; and what was left out.

    Raises
    ------
    InfeasibleError
        Where no region is required and none fits.
    """
    flight, left = first, dict[str, Dropped]()
    while exceeded(aircraft, flight.use):
        more = _too_much(flight, {n: p for n, p in optional.items() if n not in left}, aircraft, ends)
        if not more:
            break
        left |= {dropped.name: dropped for dropped in more}
        flight = _again(again, frozenset(left), flight, aircraft)
    for dropped in sorted(left.values(), key=lambda each: (-each.worth, each.name))[:TRIED_AGAIN]:
        if exceeded(aircraft, flight.use):
            break
        trial = again(frozenset(left) - {dropped.name})
        over = exceeded(aircraft, trial.use)
        if over:
            left[dropped.name] = Dropped(dropped.name, over[0], dropped.worth)
        else:
            flight = trial
            del left[dropped.name]
    return flight, tuple(left[name] for name in optional if name in left)


def _again(again: Callable[[frozenset[str]], F], left: frozenset[str], flight: F, aircraft: Aircraft) -> F:
    """The flight without some regions; what is said where nothing would be flown then."""
    if any(not set(collect.regions) <= left for collect in flight.passes):
        return again(left)
    excess = exceeded(aircraft, flight.use)[0]
    raise InfeasibleError(
        excess.constraint,
        aircraft.name,
        f"no region is required, and none fits: the shortest flight tried takes {excess.used:.0f} "
        f"{excess.unit}, there are {excess.limit:.0f} {excess.unit}",
        "Raise the limit, or begin nearer to a region.",
    )


def _too_much(
    flight: F, optional: Mapping[str, float], aircraft: Aircraft, ends: tuple[Point, Point]
) -> list[Dropped]:
    """What to leave out, one after the other, until straight lines say that the rest is within the limits."""
    passes = flight.passes
    whole_m = _straight_m(passes, ends)
    dropped: list[Dropped] = []
    left: set[str] = set()
    while True:
        now_m = _straight_m(_without(passes, left), ends)
        over = exceeded(aircraft, flight.use.scaled(now_m / whole_m))
        if not over:
            return dropped
        seen = {name for collect in passes for name in collect.regions}
        worths = {}
        for name, priority in optional.items():
            if name in seen - left:
                saved_m = now_m - _straight_m(_without(passes, left | {name}), ends)
                worths[name] = priority / saved_m if saved_m > LEAST_SAVING_M else math.inf
        if not worths:
            return dropped
        name = min(worths, key=lambda each: (worths[each], each))
        dropped.append(Dropped(name, over[0], worths[name]))
        left.add(name)


def _without(passes: Iterable[CollectPass], left: set[str]) -> list[CollectPass]:
    """Passes that see something besides what is left out."""
    return [collect for collect in passes if not set(collect.regions) <= left]


def _straight_m(passes: Iterable[CollectPass], ends: tuple[Point, Point]) -> float:
    """Length of a tour with straight lines between passes."""
    place, length_m = ends[0], 0.0
    for collect in passes:
        length_m += math.dist(place, collect.start) + collect.length_m
        place = collect.end
    return length_m + math.dist(place, ends[1])
