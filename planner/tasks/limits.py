"""Regions that need not be seen, left out where the aircraft cannot fly to all.

By the orienteering form: what brings most priority within a length of route is planned in earnest, and the
length corrected by what that flight uses, until nothing changes. And greedily: the one whose priority is
least for the way that leaving it out saves goes first, until the rest is within the limits. What each left
out is tried again, the best for its way first; the flight that sees more priority is taken.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import Excess, Use, exceeded, strain

Point = tuple[float, float]

#: So many of those left out are tried again.
TRIED_AGAIN = 4
#: Lengths of route tried, and what of one that turned out too long is asked for next.
LENGTHS, SHORTER = 4, 0.998
#: No more regions are named in one sentence.
MOST_NAMED = 6
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


class Kept(Protocol):
    """What a route of a length may see."""

    @property
    def left(self) -> frozenset[str]:
        """Optional regions that it may not."""

    @property
    def length_m(self) -> float:
        """Of the route, as estimated."""


class Offer(Protocol):
    """Says what to leave out."""

    def kept(self, length_m: float) -> Kept | None:
        """What a route of a length sees; None where it sees not all that is required."""

    def whole_m(self) -> float:
        """Length of a route that sees all, as estimated."""


@dataclass(frozen=True, slots=True)
class _Rest(Generic[F]):
    """A flight, and what it leaves out."""

    flight: F
    left: Mapping[str, Dropped]

    def lost(self, optional: Mapping[str, float]) -> float:
        """Priority of what is left out."""
        return math.fsum(optional[name] for name in self.left)


def within_limits(
    first: F,
    again: Callable[[frozenset[str]], F],
    optional: Mapping[str, float],
    aircraft: Aircraft,
    ends: tuple[Point, Point],
    offer: Callable[[], Offer] | None = None,
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
    offer
        Made where the first flight is over a limit.

    Returns
    -------
    tuple
        The flight, still over a limit where the required regions alone are; and what was left out.

    Raises
    ------
    InfeasibleError
        Where no region is required and none fits.
    """
    if not exceeded(aircraft, first.use):
        return first, ()
    known: dict[frozenset[str], F] = {}

    def once(names: frozenset[str]) -> F:
        if names not in known:
            known[names] = again(names)
        return known[names]

    found: list[_Rest[F]] = []
    refused: InfeasibleError | None = None
    try:
        greedy = _greedily(first, once, optional, aircraft, ends)
    except InfeasibleError as error:
        refused = error
    else:
        if exceeded(aircraft, greedy.flight.use):
            return greedy.flight, _listed(greedy, optional)
        found.append(_tried_again(greedy, once, aircraft))
    if offer is not None and optional:
        best = _offered(first, once, optional, aircraft, offer())
        if best is not None and all(set(best.left) != set(other.left) for other in found):
            found.append(_tried_again(best, once, aircraft))
    if not found:
        assert refused is not None
        raise refused
    rest = min(found, key=lambda each: (each.lost(optional), each.flight.use.length_m))
    return rest.flight, _listed(rest, optional)


def short_of_energy(flight: Flight, aircraft: Aircraft, ends: tuple[Point, Point]) -> InfeasibleError | None:
    """What is said of a flight that its battery does not bring home; None where it does.

    Range and time are what somebody allows, and a plan over them is told with what it is over by; a flight
    without the energy for it is none.
    """
    short = next((each for each in exceeded(aircraft, flight.use) if each.constraint == "energy"), None)
    if short is None or aircraft.energy_wh is None:
        return None
    passes = flight.passes
    names = dict.fromkeys(name for collect in passes for name in collect.regions)
    whole_m = _straight_m(passes, ends)
    enough = []
    for name in names if len(names) > 1 and whole_m > 0.0 else ():
        rest = flight.use.scaled(_straight_m(_without(passes, {name}), ends) / whole_m)
        if rest.energy_wh is not None and rest.energy_wh <= short.limit:
            enough.append((rest.energy_wh, name))
    more_wh = math.ceil(10.0 * short.margin / (1.0 - aircraft.reserve)) / 10.0
    ways = [f"Give it {more_wh:.1f} Wh more energy_wh"]
    if aircraft.aloft is None:
        ways.append("or batteries to change")
    if enough:
        ways.append(f"or leave out {max(enough)[1]} (required false)")
    seen = ", ".join(names) if len(names) <= MOST_NAMED else f"{len(names)} regions"
    return InfeasibleError(
        "energy",
        aircraft.name,
        f"takes {short.used:.1f} Wh to see {seen} and come home, {short.limit:.1f} Wh may be used of its "
        f"{aircraft.energy_wh:g} Wh: {short.margin:.1f} Wh too little",
        ", ".join(ways) + ".",
    )


def _listed(rest: _Rest[F], optional: Mapping[str, float]) -> tuple[Dropped, ...]:
    return tuple(rest.left[name] for name in optional if name in rest.left)


def _greedily(
    first: F,
    again: Callable[[frozenset[str]], F],
    optional: Mapping[str, float],
    aircraft: Aircraft,
    ends: tuple[Point, Point],
) -> _Rest[F]:
    """What is worth least for its way left out until the rest is within the limits, or is required."""
    flight, left = first, dict[str, Dropped]()
    while exceeded(aircraft, flight.use):
        more = _too_much(flight, {n: p for n, p in optional.items() if n not in left}, aircraft, ends)
        if not more:
            break
        left |= {dropped.name: dropped for dropped in more}
        flight = _again(again, frozenset(left), flight, aircraft)
    return _Rest(flight, left)


def _offered(
    first: F,
    again: Callable[[frozenset[str]], F],
    optional: Mapping[str, float],
    aircraft: Aircraft,
    offer: Offer,
) -> _Rest[F] | None:
    """The flight of most priority among those offered that are within the limits; None where none is."""
    best: _Rest[F] | None = None
    asked_m = offer.whole_m() / strain(aircraft, first.use)
    over = exceeded(aircraft, first.use)[0]
    tried: set[frozenset[str]] = set()
    for _ in range(LENGTHS):
        kept = offer.kept(asked_m) if math.isfinite(asked_m) else None
        if kept is None or kept.left in tried or not _something(first, kept.left):
            break
        tried.add(kept.left)
        flight = again(kept.left)
        used = strain(aircraft, flight.use)
        if used > 1.0:
            over = exceeded(aircraft, flight.use)[0]
            asked_m = SHORTER * kept.length_m / used
            continue
        left = {name: Dropped(name, over, optional[name]) for name in kept.left}
        rest = _Rest(flight, left)
        if best is None or rest.lost(optional) < best.lost(optional):
            best = rest
        asked_m = kept.length_m / used
    return best


def _tried_again(rest: _Rest[F], again: Callable[[frozenset[str]], F], aircraft: Aircraft) -> _Rest[F]:
    """The same with what fits besides after all, and what the others are truly over by."""
    flight, left = rest.flight, dict(rest.left)
    for dropped in sorted(left.values(), key=lambda each: (-each.worth, each.name))[:TRIED_AGAIN]:
        trial = again(frozenset(left) - {dropped.name})
        over = exceeded(aircraft, trial.use)
        if over:
            left[dropped.name] = Dropped(dropped.name, over[0], dropped.worth)
        else:
            flight = trial
            del left[dropped.name]
    return _Rest(flight, left)


def _something(flight: Flight, left: frozenset[str]) -> bool:
    """Whether anything is flown without some regions."""
    return any(not set(collect.regions) <= left for collect in flight.passes)


def _again(again: Callable[[frozenset[str]], F], left: frozenset[str], flight: F, aircraft: Aircraft) -> F:
    """The flight without some regions; what is said where nothing would be flown then."""
    if _something(flight, left):
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
