"""Regions that need not be seen, left out where the aircraft cannot fly to all.

By the orienteering form: what brings most priority within a length of route is planned in earnest, and the
length corrected by what that flight uses, until nothing changes. And greedily: the one whose priority is
least for the way that leaving it out saves goes first, until the rest is within the limits. What each left
out is tried again, the best for its way first; the choice that sees more priority is taken. All of that is
planned in haste: of thirty regions a plan in earnest takes ten times as long, and chooses no better. What has
been chosen is planned in earnest, and what its shorter way has room for is tried once more.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
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
#: The same where flights are planned in earnest.
IN_EARNEST = 4
#: What is left out is tried again where straight lines to it are no longer than there is room for, and this
#: part of the flight.
ROOM = 0.02
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
    """A flight, what it leaves out, and the length of route as estimated that it was offered for."""

    flight: F
    left: Mapping[str, Dropped]
    asked_m: float = math.inf

    def lost(self, optional: Mapping[str, float]) -> float:
        """Priority of what is left out."""
        return math.fsum(optional[name] for name in self.left)


def within_limits(
    first: F,
    again: Callable[[frozenset[str]], F],
    in_haste: Callable[[frozenset[str]], F],
    optional: Mapping[str, float],
    aircraft: Aircraft,
    ends: tuple[Point, Point],
    offer: Callable[[], Offer | None] | None = None,
) -> tuple[F, tuple[Dropped, ...]]:
    """The flight with as many of the optional regions as the aircraft can fly to.

    Parameters
    ----------
    first
        The flight to all regions.
    again, in_haste
        Plan without the regions named; the other takes the first way that it finds.
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
    known = {frozenset[str](): first}

    def once(names: frozenset[str]) -> F:
        if names not in known:
            known[names] = in_haste(names)
        return known[names]

    places = _places(first)
    found: list[_Rest[F]] = []
    refused: InfeasibleError | None = None
    try:
        greedy = _greedily(first, once, optional, aircraft, ends)
        if exceeded(aircraft, greedy.flight.use):
            greedy = _Rest(again(frozenset(greedy.left)), greedy.left)
    except InfeasibleError as error:
        refused = error
    else:
        if exceeded(aircraft, greedy.flight.use):
            return greedy.flight, _listed(greedy, optional)
        found.append(_tried_again(greedy, once, aircraft, ends, places))
    offered = offer() if offer is not None and optional else None
    best: _Rest[F] | None = None
    if offered is not None:
        whole_m = offered.whole_m() / strain(aircraft, first.use)
        best = _offered(first, once, optional, aircraft, offered, whole_m)
        if best is not None and all(set(best.left) != set(other.left) for other in found):
            found.append(_tried_again(best, once, aircraft, ends, places))
    if not found:
        assert refused is not None
        raise refused
    rest = min(found, key=lambda each: (each.lost(optional), each.flight.use.length_m))
    earnest = again(frozenset(rest.left))
    if strain(aircraft, earnest.use) <= strain(aircraft, rest.flight.use):
        rest = _Rest(earnest, rest.left)
    if offered is not None and best is not None:
        # In earnest there is room for a longer one.
        longer_m = best.asked_m / strain(aircraft, earnest.use)
        known_left = {frozenset(rest.left), frozenset(best.left)}
        more = _offered(first, again, optional, aircraft, offered, longer_m, IN_EARNEST, known_left)
        rest = min([rest, more] if more else [rest], key=lambda each: each.lost(optional))
    rest = _tried_again(rest, again, aircraft, ends, places)
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
    asked_m: float,
    lengths: int = LENGTHS,
    known: Collection[frozenset[str]] = (),
) -> _Rest[F] | None:
    """The flight of most priority among those offered that are within the limits; None where none is."""
    best: _Rest[F] | None = None
    over = exceeded(aircraft, first.use)[0]
    tried = set(known)
    for _ in range(lengths):
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
        rest = _Rest(flight, left, kept.length_m)
        if best is None or rest.lost(optional) < best.lost(optional):
            best = rest
        asked_m = kept.length_m / used
    return best


def _tried_again(
    rest: _Rest[F],
    again: Callable[[frozenset[str]], F],
    aircraft: Aircraft,
    ends: tuple[Point, Point],
    places: Mapping[str, Point],
) -> _Rest[F]:
    """The same with what fits besides after all, and what the others are truly over by."""
    flight, left = rest.flight, dict(rest.left)
    for dropped in sorted(left.values(), key=lambda each: (-each.worth, each.name))[:TRIED_AGAIN]:
        length_m = flight.use.length_m
        room_m = (1.0 / max(strain(aircraft, flight.use), 1e-9) - 1.0 + ROOM) * length_m
        place = places.get(dropped.name)
        if place is not None and _way_to_m(place, flight.passes, ends) > room_m:
            continue
        trial = again(frozenset(left) - {dropped.name})
        over = exceeded(aircraft, trial.use)
        if over:
            left[dropped.name] = Dropped(dropped.name, over[0], dropped.worth)
        else:
            flight = trial
            del left[dropped.name]
    return _Rest(flight, left)


def _places(flight: Flight) -> dict[str, Point]:
    """Of each region a place that it is seen from, the middle of a pass."""
    return {
        name: (0.5 * (collect.start[0] + collect.end[0]), 0.5 * (collect.start[1] + collect.end[1]))
        for collect in flight.passes
        for name in collect.regions
    }


def _way_to_m(place: Point, passes: Iterable[CollectPass], ends: tuple[Point, Point]) -> float:
    """What straight lines to a place make a tour longer by at least."""
    corners = [ends[0], *(corner for collect in passes for corner in (collect.start, collect.end)), ends[1]]
    return min(
        math.dist(one, place) + math.dist(place, other) - math.dist(one, other)
        for one, other in pairwise(corners)
    )


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
