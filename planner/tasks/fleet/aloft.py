"""Flights that begin in the air: they wait before one of their passes, or their way home when all is done."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Protocol

from planner.errors import InfeasibleError
from planner.fleet.assignment import Trip
from planner.fleet.separation import Apart, Track
from planner.fleet.waiting import least_hold_s
from planner.route import Terminal
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flights import straight_home, with_waits
from planner.tasks.fleet.flown import Flown, Order
from planner.tasks.fleet.jobs import Job
from planner.tasks.task import Controls

#: Waits that are tried, in least circles of its aircraft.
CIRCLES = (1.0, 1.3, 1.7, 2.2, 3.0, 4.0, 5.5, 7.5, 10.0)

Jobs = Sequence[tuple[Job, int]]
Bounds = Sequence[tuple[float, float]]


class Placed(Protocol):
    """The flights that stand already."""

    @property
    def apart(self) -> Apart:
        """All flights, and which delays bring two of them near."""

    def first_s(self, track: int, from_s: float) -> float:
        """When a flight may begin for its distance from the others."""


class TrackOf(Protocol):
    """The places of a flight by time."""

    def __call__(self, flown: Flown) -> Track:
        """Of a flight from its beginning."""


def held_apart(
    placed: Placed,
    crew: Crew,
    number: int,
    jobs: Jobs,
    order: Order,
    bounds_s: Bounds,
    track_of: TrackOf,
    controls: Controls,
) -> tuple[Flown, int] | None:
    """A flight that begins at once and keeps apart from those placed, by the least wait that is tried.

    Parameters
    ----------
    bounds_s
        Of each job, when it may begin and has to be over.
    track_of
        The places of a flight.

    Returns
    -------
    tuple
        The flight, and the number of its track; None where no wait that is tried is apart, or in time.
    """
    for bounds in _waited(crew, number, jobs, order, bounds_s, controls):
        try:
            flown, when = with_waits(crew, number, jobs, order, bounds, 0.0, controls)
        except InfeasibleError:
            # There is no room for the circles there.
            continue
        if when.worst is not None:
            continue
        track = placed.apart.add(track_of(flown))
        if placed.first_s(track, 0.0) <= 0.0:
            return flown, track
    return None


def home_apart(
    placed: Placed, crew: Crew, number: int, track_of: TrackOf, controls: Controls
) -> tuple[Flown, int] | None:
    """The way home of one that has nothing to do, behind the least wait that is tried, as ``held_apart``."""
    once_s = least_hold_s(crew.setting.model)
    # Where its course is not known, there is no circle to go into.
    known = crew.setting.ends[0].angle_rad is not None
    for circles in (0.0, *CIRCLES) if known else (0.0,):
        try:
            flown = straight_home(crew.landing(_nearest(crew)), number, controls, circles * once_s)
        except InfeasibleError:
            if circles == 0.0:
                raise
            # There is no room for the circles here.
            continue
        track = placed.apart.add(track_of(flown))
        if placed.first_s(track, 0.0) <= 0.0:
            return flown, track
    return None


def _waited(
    crew: Crew, number: int, jobs: Jobs, order: Order, bounds_s: Bounds, controls: Controls
) -> Iterator[Bounds]:
    """The bounds as they are, then with each job in turn begun later, by the shorter waits first."""
    yield bounds_s
    plain, _ = with_waits(crew, number, jobs, order, bounds_s, 0.0, controls)
    once_s = least_hold_s(crew.setting.model)
    for circles in CIRCLES:
        for place, (begin_s, _) in enumerate(plain.spans_s):
            opens_s, closes_s = bounds_s[place]
            later = (max(opens_s, begin_s + circles * once_s), closes_s)
            yield [*bounds_s[:place], later, *bounds_s[place + 1 :]]


def homewards(crews: Sequence[Crew], trips: Sequence[Trip], controls: Controls) -> list[tuple[Trip, Flown]]:
    """The ways home of those in the air that are given nothing by trips of others.

    Raises
    ------
    InfeasibleError
        Where there is none.
    """
    busy = {trip.member for trip in trips}
    found = []
    for number, crew in enumerate(crews):
        if busy and number not in busy and crew.aircraft.aloft is not None:
            flown = straight_home(crew.landing(_nearest(crew)), number, controls)
            length_m, duration_s, energy_wh = flown.use.length_m, flown.use.duration_s, flown.use.energy_wh
            trip = Trip(number, 0, 0, 0.0, duration_s, (), length_m, energy_wh or 0.0, 0.0)
            found.append((trip, flown))
    return found


def _nearest(crew: Crew) -> Terminal:
    """Of the places where it may land, from where it is."""
    return min(crew.landings, key=lambda end: math.dist(end.position, crew.ends[0].position))
