"""Flights put on one clock: batteries changed, visits apart, windows kept, aircraft apart from each other."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from planner.errors import InfeasibleError
from planner.fleet.assignment import Trip
from planner.fleet.separation import DRIFTS, NO_DRIFT, Apart, Track, step_m, track_of
from planner.route import Terminal
from planner.tasks.fleet.aloft import held_apart, home_apart
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flights import SPARE_S, with_waits
from planner.tasks.fleet.flown import Flown, Order
from planner.tasks.fleet.jobs import Job
from planner.tasks.fleet.turns import other_orders
from planner.tasks.task import Controls
from planner.vehicle.aircraft import Aircraft
from planner.wishes import Objective, Separation

#: So often a flight is put off, its waits made shorter, before there is no room for it.
MOST_DELAYS = 12
#: So often a flight that found no room among the others is put on the clock before them.
MOST_FIRST = 4
#: The constraint of a flight that others leave no room for within its windows.
CROWDED = "separation"


@dataclass(frozen=True, slots=True)
class Errand:
    """One flight that is to be put on the clock.

    Parameters
    ----------
    trip
        As it was assigned.
    jobs
        In flight order, with the visit that each is.
    flown
        The flight where nothing binds its times; None where its order is given.
    order
        Its passes where its order is given.
    ends
        Where it starts and ends; None for its crew's ends.
    """

    trip: Trip
    jobs: tuple[tuple[Job, int], ...]
    flown: Flown | None = None
    order: Order | None = None
    ends: tuple[Terminal, Terminal] | None = None

    def crew(self, crews: Sequence[Crew]) -> Crew:
        """Whose it is, starting and ending where it does."""
        own = crews[self.trip.member]
        return own if self.ends is None else own.between(self.ends)


@dataclass(frozen=True, slots=True)
class Sortie:
    """A flight that lifts off at a time; ``number`` counts those of its aircraft."""

    flown: Flown
    start_s: float
    number: int

    @property
    def end_s(self) -> float:
        """When it is down."""
        return self.start_s + self.flown.duration_s


class LateError(Exception):
    """A window that a flight does not keep, by how much, and whether others are in its way."""

    def __init__(self, crew: int, job: Job, late_s: float, *, crowded: bool = False) -> None:
        super().__init__(crew, job.of, late_s)
        self.crew, self.job, self.late_s, self.crowded = crew, job, late_s, crowded


class _CrowdedError(Exception):
    """A flight that others leave no time for."""

    def __init__(self, errand: Errand, why: LateError | InfeasibleError) -> None:
        super().__init__(why)
        self.errand, self.why = errand, why


class _Clock:
    """What is placed so far."""

    def __init__(self, apart: Apart) -> None:
        self.apart = apart
        self.sorties: list[Sortie] = []
        self._placed: list[tuple[int, float]] = []
        self._landed_s: dict[int, float] = {}
        self._visits: dict[str, list[tuple[int, float, float]]] = {}

    def ready_s(self, crew: int, turnaround_s: float) -> float:
        """When an aircraft may lift off again."""
        return self._landed_s[crew] + turnaround_s if crew in self._landed_s else 0.0

    def first_s(self, track: int, from_s: float) -> float:
        """When a flight may lift off for its distance from the others."""
        return self.apart.first_s(self._placed, track, from_s)

    def bounds_s(self, job: Job, visit: int) -> tuple[float, float]:
        """When a job may begin and has to be over: by its window, and by visits of other flights."""
        opens_s, closes_s = job.region.time_window_s or (-math.inf, math.inf)
        opens_s, closes_s = opens_s + SPARE_S, closes_s - SPARE_S
        apart_s = job.region.revisit_after_s + SPARE_S
        for number, begin_s, end_s in self._visits.get(job.region.name, []):
            if number < visit:
                opens_s = max(opens_s, end_s + apart_s)
            else:
                closes_s = min(closes_s, begin_s - apart_s)
        return opens_s, closes_s

    def put(self, errand: Errand, flown: Flown, start_s: float, track: int) -> None:
        """One flight more."""
        crew = flown.crew
        number = sum(each.flown.crew == crew for each in self.sorties) + 1
        self.sorties.append(Sortie(flown, start_s, number))
        self._landed_s[crew] = start_s + flown.duration_s
        self._placed.append((track, start_s))
        for (job, visit), (begin_s, end_s) in zip(errand.jobs, flown.spans_s, strict=True):
            self._visits.setdefault(job.region.name, []).append((visit, start_s + begin_s, start_s + end_s))

    @property
    def cost_s(self) -> tuple[float, float]:
        """When the last is down, and how long all have waited."""
        return max(s.end_s for s in self.sorties), math.fsum(s.start_s for s in self.sorties)


def placed(
    crews: Sequence[Crew], errands: Sequence[Errand], separation: Separation, controls: Controls, seed: int
) -> tuple[Sortie, ...]:
    """All flights on one clock, each as soon as what was placed before it allows.

    Where nothing binds their times several orders of placing them are tried.

    Raises
    ------
    LateError
        Where a window is not kept.
    InfeasibleError
        ``"separation"``: no delay within its windows keeps a flight apart from the others.
        ``"window"``: there is no room to wait in.
    """
    if not errands:
        return ()
    aircraft = [crews[each.trip.member].aircraft for each in _in_the_air_first(crews, errands)]
    best = None
    # Those in the air cannot be put off once more: each may be early or late, where there is room for that.
    for drift in DRIFTS if aircraft[0].aloft is not None else (NO_DRIFT,):
        try:
            best = _placed(crews, errands, separation, controls, seed, Apart(separation, drift))
        except (InfeasibleError, LateError):
            if drift == NO_DRIFT:
                raise
        if best is not None:
            return tuple(sorted(best.sorties, key=lambda each: (each.flown.crew, each.number)))
    raise _too_near(aircraft, separation)


def placed_anew(
    crews: Sequence[Crew],
    errands: Sequence[Errand],
    tracks: Mapping[int, int],
    apart: Apart,
    controls: Controls,
    seed: int,
) -> tuple[Sortie, ...]:
    """Flights from the ground that may be flown at any time, as ``placed``, in the order of the errands.

    Parameters
    ----------
    tracks
        The number of each among ``apart``, by the errand's id.
    """
    clock = _placed(crews, errands, apart.separation, controls, seed, apart, tracks)
    if clock is None:
        raise ValueError("what is on the ground can always wait")
    by_flight = {id(sortie.flown): sortie for sortie in clock.sorties}
    return tuple(by_flight[id(each.flown)] for each in errands)


def _in_the_air_first(crews: Sequence[Crew], errands: Sequence[Errand]) -> list[Errand]:
    return sorted(
        errands,
        key=lambda each: (
            crews[each.trip.member].aircraft.aloft is None,
            each.trip.take_off_s,
            -each.trip.duration_s,
        ),
    )


def _placed(
    crews: Sequence[Crew],
    errands: Sequence[Errand],
    separation: Separation,
    controls: Controls,
    seed: int,
    apart: Apart,
    tracks: Mapping[int, int] | None = None,
) -> _Clock | None:
    """The best of the orders tried; None where some are too near in all of them."""
    first = _in_the_air_first(crews, errands)
    if tracks is None:
        tracks = {
            id(each): apart.add(flight_track(crews[each.trip.member], each.flown, separation))
            for each in errands
            if each.flown is not None
        }
    orders = [first]
    if len(tracks) == len(errands) > 1:
        members = [each.trip.member for each in first]
        orders += [[first[k] for k in order] for order in other_orders(members, seed)]
    best: _Clock | None = None
    tried: list[list[int]] = []
    while orders:
        order = orders.pop(0)
        tried.append([id(each) for each in order])
        try:
            clock = _in_turn(apart, order, crews, tracks, separation, controls)
        except _CrowdedError as crowded:
            sooner = _sooner(crews, order, crowded.errand)
            if [id(each) for each in sooner] in tried or len(tried) > MOST_FIRST:
                raise crowded.why from None
            orders.append(sooner)
            continue
        if clock is not None and (best is None or clock.cost_s < best.cost_s):
            best = clock
    flying = [each for each in first if crews[each.trip.member].aircraft.aloft is not None]
    for each in flying if best is None else ():
        # None may be put off: whoever is placed later waits in the air.
        order = _sooner(crews, first, each)
        clock = _in_turn(apart, order, crews, tracks, separation, controls, waiting=True)
        if clock is not None and (best is None or clock.cost_s < best.cost_s):
            best = clock
    return best


def _in_turn(
    apart: Apart,
    order: Sequence[Errand],
    crews: Sequence[Crew],
    tracks: Mapping[int, int],
    separation: Separation,
    controls: Controls,
    *,
    waiting: bool = False,
) -> _Clock | None:
    """All flights placed in an order; None where one that flies already comes too near to another.

    ``waiting`` looks for waits in the air that keep those apart.
    """
    clock = _Clock(apart)
    for errand in order:
        crew = errand.crew(crews)
        ready_s = clock.ready_s(errand.trip.member, crew.aircraft.turnaround_s)
        if crew.aircraft.aloft is not None and (waiting or errand.flown is None):
            if not _put_aloft(clock, crew, errand, separation, controls):
                return None
            continue
        if errand.flown is None:
            try:
                _put_in_order(clock, crew, errand, ready_s, separation, controls)
            except (LateError, InfeasibleError) as refused:
                if refused.crowded if isinstance(refused, LateError) else refused.constraint == CROWDED:
                    raise _CrowdedError(errand, refused) from refused
                raise
            continue
        track = tracks[id(errand)]
        start_s = clock.first_s(track, ready_s)
        if crew.aircraft.aloft is not None and start_s > 0.0:
            return None
        clock.put(errand, errand.flown, start_s, track)
    return clock


def _put_aloft(clock: _Clock, crew: Crew, errand: Errand, separation: Separation, controls: Controls) -> bool:
    """Place a flight that has begun; whether it can be kept apart from those placed, in time."""
    of = partial(flight_track, crew, separation=separation)
    if not errand.jobs and errand.flown is not None and errand.flown.order and errand.flown.order.passes:
        # A search has no jobs to wait before, and is not to be given up for its way home.
        track = clock.apart.add(of(errand.flown))
        if clock.first_s(track, 0.0) > 0.0:
            return False
        clock.put(errand, errand.flown, 0.0, track)
        return True
    if not errand.jobs:
        found = home_apart(clock, crew, errand.trip.member, of, controls)
    else:
        order = errand.order if errand.flown is None else errand.flown.order
        if order is None:
            raise ValueError("a flight without an order has no order to keep")
        bounds_s = [clock.bounds_s(job, visit) for job, visit in errand.jobs]
        found = held_apart(clock, crew, errand.trip.member, errand.jobs, order, bounds_s, of, controls)
    if found is None:
        return False
    flown, track = found
    clock.put(errand, flown, 0.0, track)
    return True


def _too_near(flying: Sequence[Aircraft], separation: Separation) -> InfeasibleError:
    aloft = "+".join(dict.fromkeys(aircraft.name for aircraft in flying if aircraft.aloft is not None))
    return InfeasibleError(
        "separation",
        aloft,
        f"fly already, and their new lines come nearer to each other than {separation.horizontal_m:g} m, or "
        f"{separation.vertical_m:g} m of height",
        "Lower separation, hold one of them where it is, or give them heights of their own.",
    )


def _sooner(crews: Sequence[Crew], order: Sequence[Errand], errand: Errand) -> list[Errand]:
    """The order with a flight, and those that its aircraft makes before it, ahead of all on the ground."""
    place = next(k for k, each in enumerate(order) if each is errand)
    own = [each for each in order[: place + 1] if each.trip.member == errand.trip.member]
    others = [each for each in order if not any(each is one for one in own)]
    return sorted(own + others, key=lambda each: crews[each.trip.member].aircraft.aloft is None)


def _put_in_order(
    clock: _Clock,
    crew: Crew,
    errand: Errand,
    ready_s: float,
    separation: Separation,
    controls: Controls,
) -> None:
    if errand.order is None:
        raise ValueError("a flight without an order has no order to keep")
    bounds_s = [clock.bounds_s(job, visit) for job, visit in errand.jobs]
    for delays in range(MOST_DELAYS):
        flown, when = with_waits(
            crew, errand.trip.member, errand.jobs, errand.order, bounds_s, ready_s, controls
        )
        if when.worst is not None:
            job = errand.jobs[when.worst][0]
            raise LateError(errand.trip.member, job, when.late_s, crowded=delays > 0 or job.visits > 1)
        track = clock.apart.add(flight_track(crew, flown, separation))
        start_s = clock.first_s(track, when.start_s)
        latest_s = min(
            closes_s - end_s for (_, closes_s), (_, end_s) in zip(bounds_s, flown.spans_s, strict=True)
        )
        if start_s <= latest_s + SPARE_S / 2.0:
            clock.put(errand, flown, start_s, track)
            return
        ready_s = start_s
    raise InfeasibleError(
        CROWDED,
        crew.aircraft.name,
        f"cannot be kept {separation.horizontal_m:g} m, or {separation.vertical_m:g} m of height, from the "
        "others within its windows",
        "Widen the windows, or lower separation.",
    )


def flight_track(crew: Crew, flown: Flown, separation: Separation) -> Track:
    """The places of a flight from its lift-off."""
    return track_of(flown.composed.flight, crew.setting.model, step_m(separation))


def cost_of(sorties: Sequence[Sortie], weights: Objective) -> float:
    """What the objective says of flights; what they leave out is the assignment's to weigh."""
    return weights.last_landing * max(each.end_s for each in sorties) + weights.total_time * math.fsum(
        each.flown.duration_s for each in sorties
    )


def powers_of(crews: Sequence[Crew], sorties: Sequence[Sortie]) -> dict[int, float]:
    """Of each crew the mean power of its flights by that at cruise, the most of any of them."""
    found: dict[int, float] = {}
    for sortie in sorties:
        crew, used_wh = sortie.flown.crew, sortie.flown.use.energy_wh
        power_w = crews[crew].power_w
        if used_wh is not None and power_w:
            part = 3600.0 * used_wh / (power_w * sortie.flown.duration_s)
            found[crew] = max(found.get(crew, 0.0), part)
    return found
