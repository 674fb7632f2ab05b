"""Flights put on one clock: batteries changed, visits apart, windows kept, aircraft apart from each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from planner.errors import InfeasibleError
from planner.fleet.assignment import Trip
from planner.fleet.separation import Track, least_delay_s, step_m, track_of
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flights import SPARE_S, Flown, Order, with_waits
from planner.tasks.fleet.jobs import Job
from planner.tasks.task import Controls
from planner.wishes import Separation

#: So often a flight is put off, its waits made shorter, before there is no room for it.
MOST_DELAYS = 12


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
    """

    trip: Trip
    jobs: tuple[tuple[Job, int], ...]
    flown: Flown | None = None
    order: Order | None = None


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
    """A window that a flight does not keep, and by how much."""

    def __init__(self, crew: int, job: Job, late_s: float) -> None:
        super().__init__(crew, job.of, late_s)
        self.crew, self.job, self.late_s = crew, job, late_s


@dataclass(slots=True)
class _Clock:
    """What is placed so far."""

    separation: Separation
    tracks: list[Track] = field(default_factory=list)
    sorties: list[Sortie] = field(default_factory=list)
    landed_s: dict[int, float] = field(default_factory=dict)
    flights: dict[int, int] = field(default_factory=dict)
    visits: dict[str, list[tuple[int, float, float]]] = field(default_factory=dict)

    def ready_s(self, crew: int, turnaround_s: float) -> float:
        """When an aircraft may lift off again."""
        return self.landed_s[crew] + turnaround_s if crew in self.landed_s else 0.0

    def bounds_s(self, job: Job, visit: int) -> tuple[float, float]:
        """When a job may begin and has to be over: by its window, and by visits of other flights."""
        opens_s, closes_s = job.region.time_window_s or (-math.inf, math.inf)
        opens_s, closes_s = opens_s + SPARE_S, closes_s - SPARE_S
        apart_s = job.region.revisit_after_s + SPARE_S
        for number, begin_s, end_s in self.visits.get(job.region.name, []):
            if number < visit:
                opens_s = max(opens_s, end_s + apart_s)
            else:
                closes_s = min(closes_s, begin_s - apart_s)
        return opens_s, closes_s

    def put(self, errand: Errand, flown: Flown, start_s: float, track: Track) -> None:
        """One flight more."""
        crew = flown.crew
        self.flights[crew] = self.flights.get(crew, 0) + 1
        self.sorties.append(Sortie(flown, start_s, self.flights[crew]))
        self.landed_s[crew] = start_s + flown.duration_s
        self.tracks.append(track)
        for (job, visit), (begin_s, end_s) in zip(errand.jobs, flown.spans_s, strict=True):
            self.visits.setdefault(job.region.name, []).append((visit, start_s + begin_s, start_s + end_s))


def placed(
    crews: Sequence[Crew], errands: Sequence[Errand], separation: Separation, controls: Controls
) -> tuple[Sortie, ...]:
    """All flights on one clock, each as soon as what was placed before it allows.

    Raises
    ------
    LateError
        Where a window is not kept.
    InfeasibleError
        ``"separation"``: no delay within its windows keeps a flight apart from the others.
    """
    clock = _Clock(separation)
    for errand in sorted(errands, key=lambda each: (each.trip.take_off_s, -each.trip.duration_s)):
        crew = crews[errand.trip.member]
        ready_s = clock.ready_s(errand.trip.member, crew.aircraft.turnaround_s)
        if errand.flown is not None:
            track = _track(crew, errand.flown, separation)
            start_s = ready_s + least_delay_s(clock.tracks, track.later(ready_s), separation)
            clock.put(errand, errand.flown, start_s, track.later(start_s))
        else:
            _put_in_order(clock, crew, errand, ready_s, separation, controls)
    return tuple(sorted(clock.sorties, key=lambda each: (each.flown.crew, each.number)))


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
    for _ in range(MOST_DELAYS):
        flown, when = with_waits(
            crew, errand.trip.member, errand.jobs, errand.order, bounds_s, ready_s, controls
        )
        if when.worst is not None:
            raise LateError(errand.trip.member, errand.jobs[when.worst][0], when.late_s)
        track = _track(crew, flown, separation)
        delay_s = least_delay_s(clock.tracks, track.later(when.start_s), separation)
        slack_s = min(
            closes_s - when.start_s - end_s
            for (_, closes_s), (_, end_s) in zip(bounds_s, flown.spans_s, strict=True)
        )
        if delay_s <= slack_s:
            start_s = when.start_s + delay_s
            clock.put(errand, flown, start_s, track.later(start_s))
            return
        ready_s = when.start_s + delay_s
    raise InfeasibleError(
        "separation",
        crew.aircraft.name,
        f"cannot be kept {separation.horizontal_m:g} m, or {separation.vertical_m:g} m of height, from the "
        "others within its windows",
        "Widen the windows, or lower separation.",
    )


def _track(crew: Crew, flown: Flown, separation: Separation) -> Track:
    return track_of(flown.composed.flight, crew.setting.model, step_m(separation))
