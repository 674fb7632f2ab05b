"""Aircraft kept apart by when they take off: the least delays that leave no two of them near each other.

Of one flight that stands and one that may begin later, every two places nearer than what is to be kept rule
out the delays that bring both there at once. What is left of all delays begins with the least.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from planner.profile.flight import Flight, Stretch
from planner.vehicle.model import FlightModel
from planner.wishes import Separation

Floats = NDArray[np.float64]
Places = NDArray[np.int64]

#: Places of a flight that are looked at lie no further apart than this part of what is kept, within bounds:
#: what lies between two of them is kept besides, and makes flights wait.
STEP_OF_KEPT, LEAST_STEP_M, MOST_STEP_M = 0.1, 4.0, 20.0
#: No two of them lie further apart in time, however slowly it is flown.
MOST_STEP_S = 1.0
#: Kept besides what is asked for: how well a place at a time is known.
MARGIN_M, MARGIN_UP_M, MARGIN_S = 5.0, 1.0, 1.0
#: Times that differ by less are one.
SAME_S = 1e-6
#: Rates that an autopilot is set to by those that its aircraft may need.
RATES_SPARE = 1.1


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Places of a flight, in order.

    Parameters
    ----------
    places
        float64, shape (N, 4): seconds, east_m, north_m, altitude_m.
    early_s
        float64, shape (N,): how much earlier each is reached where circles flown for height sink as fast as
        the aircraft may, not as planned: autopilots leave them once they are down.
    """

    places: Floats
    early_s: Floats

    def later(self, delay_s: float) -> Track:
        """The same flight begun later."""
        return Track(self.places + np.array([delay_s, 0.0, 0.0, 0.0]), self.early_s)

    def loose_s(self, drift: Drift) -> Floats:
        """How early or late each place may be reached."""
        return np.asarray(drift.part * self.places[:, 0] + (self.early_s if drift.sinking else 0.0))


@dataclass(frozen=True, slots=True)
class Drift:
    """How early or late flights may be: a part of the time flown, and by sinking as fast as they may."""

    part: float = 0.0
    sinking: bool = False


#: None; and, of aircraft planned anew in the air, the most that there is room for: ``docs/replan.md``.
NO_DRIFT = Drift()
DRIFTS = (Drift(0.02, sinking=True), Drift(0.02), NO_DRIFT)


def step_m(separation: Separation) -> float:
    """How far apart places that are looked at may lie."""
    return min(max(STEP_OF_KEPT * separation.horizontal_m, LEAST_STEP_M), MOST_STEP_M)


def track_of(flight: Flight, model: FlightModel, apart_m: float) -> Track:
    """The places of a flight, times from its lift-off."""
    rows = [
        _places(stretch, model, apart_m, flight.starts_s[k], flight.starts_s[k + 1])
        for k, stretch in enumerate(flight.stretches)
    ]
    steepest_m_s = (
        RATES_SPARE
        * (model.airspeed_m_s + model.wind.speed_m_s)
        * math.tan(math.radians(model.aircraft.max_climb_deg))
    )
    early_s = [np.zeros(1)]
    for stretch, places in zip(flight.stretches, rows, strict=True):
        spent_s, sunk_m = places[:, 0] - places[0, 0], places[0, 3] - places[:, 3]
        saved_s = (
            np.maximum(spent_s - sunk_m / steepest_m_s, 0.0) if _goes_down(stretch) else np.zeros(len(places))
        )
        early_s.append(early_s[-1][-1] + saved_s)
    return Track(np.concatenate(rows), np.concatenate(early_s[1:]))


def _goes_down(stretch: Stretch) -> bool:
    """Whether it is a circle, or more, flown for height."""
    falls = stretch.end_altitude_m < stretch.start_altitude_m
    return falls and stretch.segment is not None and abs(stretch.segment.turn_rad) >= math.tau - 1e-6


def _places(stretch: Stretch, model: FlightModel, apart_m: float, from_s: float, until_s: float) -> Floats:
    count = max(math.ceil(stretch.length_m / apart_m), math.ceil((until_s - from_s) / MOST_STEP_S), 1) + 1
    parts = np.linspace(0.0, 1.0, count)
    rise_m = stretch.end_altitude_m - stretch.start_altitude_m
    altitudes_m = stretch.start_altitude_m + parts * rise_m
    segment = stretch.segment
    if segment is None:
        east_m, north_m = stretch.pose.position
        times_s = from_s + parts * (until_s - from_s)
        return np.column_stack([times_s, np.full(count, east_m), np.full(count, north_m), altitudes_m])
    places = np.array([segment.at(part * segment.length_m).position for part in parts.tolist()])
    # An arc in a wind is flown slowly on one side, and fast on the other.
    middles = 0.5 * (parts[1:] + parts[:-1])
    slowness = 1.0 / model.ground_speed_m_s(segment.start.angle_rad + segment.turn_rad * middles)
    shares = np.concatenate([[0.0], np.cumsum(np.broadcast_to(slowness, middles.shape))])
    times_s = from_s + shares / shares[-1] * (until_s - from_s)
    return np.column_stack([times_s, places, altitudes_m])


def least_delay_s(placed: Sequence[Track], moving: Track, separation: Separation) -> float:
    """The least delay of a flight that keeps it apart from all that are placed.

    Parameters
    ----------
    placed
        Flights that stand.
    moving
        As it would be flown without a delay.
    """
    apart = Apart(separation)
    return apart.first_s([(apart.add(track), 0.0) for track in placed], apart.add(moving), 0.0)


class Apart:
    """Flights by number, and which delays of one behind another bring them near; kept once found.

    Parameters
    ----------
    drift
        How early or late they may be.
    """

    def __init__(self, separation: Separation, drift: Drift = NO_DRIFT) -> None:
        self.separation, self._drift = separation, drift
        self._tracks: list[Track] = []
        self._known: dict[tuple[int, int], Floats] = {}

    def add(self, track: Track) -> int:
        """The number of a flight, its times from lift-off."""
        self._tracks.append(track)
        return len(self._tracks) - 1

    def first_s(self, placed: Sequence[tuple[int, float]], moving: int, from_s: float) -> float:
        """The first lift-off from a time on that is apart from flights that lift off at theirs."""
        found = [self._between(number, moving) + start_s for number, start_s in placed]
        spans = np.concatenate([span for span in found if len(span)] or [np.empty((0, 2))])
        spans = spans[spans[:, 1] > from_s]
        first_s = from_s
        for begin_s, end_s in spans[np.argsort(spans[:, 0])].tolist():
            if begin_s > first_s:
                break
            first_s = max(first_s, end_s)
        return first_s

    def stopped_by(self, placed: tuple[int, float], moving: tuple[int, float]) -> tuple[Places, Places]:
        """Places of a flight that stands, and of one behind it, that let the latter begin no sooner.

        Parameters
        ----------
        placed, moving
            The numbers of both, and when they lift off.

        Returns
        -------
        tuple
            Of each the numbers of its places, as many; none where it is not these two that are too near.
        """
        (one, begun_s), (other, start_s) = placed, moving
        least_s = start_s - begun_s
        spans = self._between(one, other)
        ends = np.flatnonzero(np.abs(spans[:, 1] - least_s) < SAME_S)
        if not len(ends):
            return np.empty(0, np.int64), np.empty(0, np.int64)
        begin_s, end_s = spans[ends[0]]
        rows, columns, delays_s, _ = _near(
            self._tracks[one], self._tracks[other], self.separation, self._drift
        )
        among = (begin_s <= delays_s) & (delays_s <= end_s)
        return rows[among], columns[among]

    def track(self, number: int) -> Track:
        """One of the flights."""
        return self._tracks[number]

    def _between(self, one: int, other: int) -> Floats:
        if (one, other) not in self._known:
            found = _barred(self._tracks[one], self._tracks[other], self.separation, self._drift)
            self._known[one, other] = found
            self._known[other, one] = -found[::-1, ::-1]
        return self._known[one, other]


def _barred(track: Track, moving: Track, separation: Separation, drift: Drift) -> Floats:
    """Delays ruled out by one flight, (K, 2): from and until, those that overlap taken together."""
    _, _, delays_s, apart_s = _near(track, moving, separation, drift)
    return _together(delays_s - apart_s, delays_s + apart_s)


def _near(
    track: Track, moving: Track, separation: Separation, drift: Drift
) -> tuple[Places, Places, Floats, Floats]:
    """Places of both that are nearer than is kept, delays that bring both there, and how exact those are."""
    if separation.horizontal_m <= 0.0 or separation.vertical_m <= 0.0:
        return np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0), np.empty(0)
    one, other = track.places, moving.places
    one_halves, other_halves = _halves(one), _halves(other)
    most_m = float(one_halves[:, 1].max() + other_halves[:, 1].max())
    near = cKDTree(one[:, 1:3]).sparse_distance_matrix(
        cKDTree(other[:, 1:3]), separation.horizontal_m + most_m + MARGIN_M, output_type="ndarray"
    )
    rows, columns = near["i"], near["j"]
    # A place of a flight is no further than this from one of those that are looked at.
    off = one_halves[rows] + other_halves[columns]
    beside = near["v"] < separation.horizontal_m + off[:, 1] + MARGIN_M
    level = np.abs(one[rows, 3] - other[columns, 3]) < separation.vertical_m + off[:, 2] + MARGIN_UP_M
    hits = np.flatnonzero(beside & level)
    rows, columns = rows[hits], columns[hits]
    delays_s = one[rows, 0] - other[columns, 0]
    loose_s = np.maximum(track.loose_s(drift)[rows], moving.loose_s(drift)[columns])
    return rows, columns, delays_s, off[hits, 0] + MARGIN_S + loose_s


def _together(firsts_s: Floats, lasts_s: Floats) -> Floats:
    """Spans that overlap taken together, in order."""
    if not len(firsts_s):
        return np.empty((0, 2))
    order = np.argsort(firsts_s)
    firsts_s, reached_s = firsts_s[order], np.maximum.accumulate(lasts_s[order])
    gaps = np.flatnonzero(firsts_s[1:] > reached_s[:-1])
    begins = np.concatenate([[0], gaps + 1])
    ends = np.concatenate([gaps, [len(firsts_s) - 1]])
    return np.column_stack([firsts_s[begins], reached_s[ends]])


def _halves(places: Floats) -> Floats:
    """Of each place half of the longer way to its neighbours: seconds, metres over ground, and of height."""
    steps = np.abs(np.diff(places, axis=0))
    ways = np.column_stack([steps[:, 0], np.hypot(steps[:, 1], steps[:, 2]), steps[:, 3]])
    none = np.zeros((1, 3))
    return np.asarray(0.5 * np.maximum(np.concatenate([none, ways]), np.concatenate([ways, none])))
