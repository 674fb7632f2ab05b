"""Flights that cross others above or below them, where that is better than waiting on the ground.

Of a flight that waits and the one that it waits for, the legs are found on which both would meet. One of them
is flown at another height there, further up or further down than what is kept, and all are put on the clock
anew. Of all such changes the best is taken, as long as one is better; passes stay as they are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from planner.fleet.assignment import Trip
from planner.fleet.separation import MARGIN_UP_M, Apart, Places
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flown import Flown, items_in, over
from planner.tasks.fleet.heights import at_heights
from planner.tasks.fleet.placing import Errand, Sortie, cost_of, flight_track, placed_anew
from planner.tasks.task import Controls
from planner.wishes import Objective, Separation

Floats = NDArray[np.float64]

#: So many changes are made, one after the other, of so many tried each time.
STEPS, TRIED = 8, 32
#: A change is made for this much of the cost, in seconds; flights that wait less than this are let be.
WORTH_S = 1.0
#: Heights lie apart by what is kept and this, in whole halves of metres, so many up and down.
SPARE_M, HALF_M, LAYERS = 0.5, 0.5, 2

#: Of a flight, its legs at other altitudes.
LegsM = tuple[tuple[int, float], ...]


def crossed(
    crews: Sequence[Crew],
    sorties: Sequence[Sortie],
    separation: Separation,
    weights: Objective,
    controls: Controls,
    seed: int,
) -> tuple[Sortie, ...]:
    """The flights with heights assigned where that is better; as they were where not, or where none may be.

    Parameters
    ----------
    sorties
        As they keep apart by when they begin.
    """
    if len(sorties) < 2 or not all(_free(crews[each.flown.crew], each.flown) for each in sorties):
        return tuple(sorties)
    if math.isinf(separation.vertical_m) or _waits_s(crews, sorties) < WORTH_S:
        return tuple(sorties)
    with controls.stage("separation"):
        return _Search(crews, separation, weights, controls, seed).better(sorties)


def _free(crew: Crew, flown: Flown) -> bool:
    """Whether a flight may be begun at any time, and its legs flown at other heights."""
    bound = any(job.is_timed for job, _ in flown.jobs)
    return crew.alone.band is not None and crew.aircraft.aloft is None and flown.waited_s <= 0.0 and not bound


def _waits_s(crews: Sequence[Crew], sorties: Sequence[Sortie]) -> float:
    """How much later the last lands than if none were in another's way."""
    ends_s: dict[int, float] = {}
    for each in sorties:
        crew = each.flown.crew
        ready_s = ends_s[crew] + crews[crew].aircraft.turnaround_s if crew in ends_s else 0.0
        ends_s[crew] = ready_s + each.flown.duration_s
    return max(each.end_s for each in sorties) - max(ends_s.values())


@dataclass(frozen=True, slots=True)
class _Plan:
    """Flights with their heights, on one clock.

    Parameters
    ----------
    legs_m
        Of each flight, which of its legs are at which altitudes.
    """

    sorties: tuple[Sortie, ...]
    legs_m: tuple[LegsM, ...]
    cost: float


@dataclass(slots=True)
class _Search:
    crews: Sequence[Crew]
    separation: Separation
    weights: Objective
    controls: Controls
    seed: int
    _apart: Apart = field(init=False)
    _begun: tuple[Sortie, ...] = ()
    #: By the flight and its heights: as it is flown, and its number among ``_apart``.
    _known: dict[tuple[int, LegsM], tuple[Flown, int] | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._apart = Apart(self.separation)

    def better(self, sorties: Sequence[Sortie]) -> tuple[Sortie, ...]:
        """The best that is found from flights without heights."""
        self._begun = tuple(sorties)
        plain: tuple[LegsM, ...] = ((),) * len(sorties)
        best = self._placed(plain)
        if best is None or cost_of(sorties, self.weights) < best.cost - WORTH_S:
            return tuple(sorties)
        for _ in range(STEPS):
            found = self._step(best)
            if found is None:
                break
            best = found
        if best.legs_m == plain:
            return tuple(sorties)
        return tuple(
            self._told(sortie, legs_m) if legs_m else sortie
            for sortie, legs_m in zip(best.sorties, best.legs_m, strict=True)
        )

    def _step(self, plan: _Plan) -> _Plan | None:
        """The best of the plans with one change more, if it is better."""
        best = None
        for tried, legs_m in enumerate(dict.fromkeys(self._changes(plan))):
            if tried >= TRIED or self.controls.enough():
                break
            found = self._placed(legs_m)
            if found is not None and found.cost < (plan if best is None else best).cost - WORTH_S:
                best = found
        return best

    def _placed(self, legs_m: Sequence[LegsM]) -> _Plan | None:
        """Flights at heights on one clock; None where one cannot be flown so."""
        errands: list[Errand] = []
        tracks: dict[int, int] = {}
        for number, (sortie, own) in enumerate(zip(self._begun, legs_m, strict=True)):
            known = self._flown(number, own)
            if known is None:
                return None
            flown, track = known
            errands.append(Errand(_trip(sortie), flown.jobs, flown))
            tracks[id(errands[-1])] = track
        sorties = placed_anew(self.crews, errands, tracks, self._apart, self.controls, self.seed)
        return _Plan(sorties, tuple(legs_m), cost_of(sorties, self.weights))

    def _flown(self, number: int, legs_m: LegsM) -> tuple[Flown, int] | None:
        key = (number, legs_m)
        if key not in self._known:
            flown = self._begun[number].flown
            crew = self.crews[flown.crew]
            new = at_heights(crew, flown, dict(legs_m)) if legs_m else flown
            lasts = new is not None and not (legs_m and _too_much(crew, new))
            self._known[key] = None
            if new is not None and lasts:
                self._known[key] = (new, self._apart.add(flight_track(crew, new, self.separation)))
        return self._known[key]

    def _changes(self, plan: _Plan) -> Iterator[tuple[LegsM, ...]]:
        """Plans with one change more: of flights that wait, the last to land first, and those before them."""
        tracks = [self._number(number, own) for number, own in enumerate(plan.legs_m)]
        last_first = sorted(range(len(tracks)), key=lambda k: -plan.sorties[k].end_s)
        for moving in last_first:
            for other in range(len(tracks)):
                if other == moving:
                    continue
                stands = (tracks[other], plan.sorties[other].start_s)
                rows, columns = self._apart.stopped_by(stands, (tracks[moving], plan.sorties[moving].start_s))
                if len(rows):
                    yield from self._apart_by_height(plan, moving, columns, tracks[other], rows)
                    yield from self._apart_by_height(plan, other, rows, tracks[moving], columns)

    def _apart_by_height(
        self, plan: _Plan, own: int, places: Places, other: int, others: Places
    ) -> Iterator[tuple[LegsM, ...]]:
        """Legs of one flight, on which it meets another, or all of its legs, over or under that."""
        flown, track = plan.sorties[own].flown, self._number(own, plan.legs_m[own])
        times_s = self._apart.track(track).places[places, 0]
        flight = flown.composed.flight
        legs: list[int] = []
        met = np.zeros(len(places), dtype=np.bool_)
        for number, (first_m, last_m) in enumerate(flown.composed.legs_m):
            first_s, last_s = flight.along(first_m)[1], flight.along(last_m)[1]
            within = (first_s <= times_s) & (times_s <= last_s)
            if within.any():
                legs.append(number)
                met |= within
        if not legs:
            return
        ways = [legs]
        if not self.crews[flown.crew].aircraft.hovers:
            # Wings climb on their way, and lose no time by it.
            ways.append(list(range(len(flown.composed.legs_m))))
        for altitude_m in _beside(self._apart.track(other).places[others[met], 3], self.separation):
            for some in ways:
                yield self._changed(plan, own, some, altitude_m)

    def _changed(self, plan: _Plan, own: int, legs: Sequence[int], altitude_m: float) -> tuple[LegsM, ...]:
        """With some legs at an altitude, those of them that can be."""
        before = dict(plan.legs_m[own])
        able = [leg for leg in legs if self._flown(own, ((leg, altitude_m),)) is not None]
        after = tuple(sorted((before | dict.fromkeys(able, altitude_m)).items()))
        return (*plan.legs_m[:own], after, *plan.legs_m[own + 1 :])

    def _number(self, number: int, legs_m: LegsM) -> int:
        known = self._flown(number, legs_m)
        if known is None:
            raise ValueError("what is on the clock has been flown")
        return known[1]

    def _told(self, sortie: Sortie, legs_m: LegsM) -> Sortie:
        """With a note that tells at which heights its legs are, and why."""
        flown, name = sortie.flown, self.crews[sortie.flown.crew].aircraft.name
        notes = []
        for altitude_m in dict.fromkeys(altitude_m for _, altitude_m in legs_m):
            legs = [flown.legs[number] for number, other_m in legs_m if other_m == altitude_m]
            ways = ", ".join(f"{leg.from_name} to {leg.to_name}" for leg in legs)
            notes.append(
                f"{name}: flies at an altitude of {altitude_m:g} m from {ways}, over or under others that it "
                "or they would have to wait for"
            )
        return replace(sortie, flown=replace(flown, notes=(*flown.notes, *notes)))


def _beside(met_m: Floats, separation: Separation) -> list[float]:
    """Altitudes over and under those at which another is met: all of them, or the one that it has longest."""
    levels_m, counts = np.unique(np.round(met_m, 1), return_counts=True)
    apart_m = separation.vertical_m + MARGIN_UP_M + SPARE_M
    found: list[float] = []
    for layer in range(1, LAYERS + 1):
        for high_m, low_m in (
            (levels_m[np.argmax(counts)],) * 2,
            (float(met_m.max()), float(met_m.min())),
        ):
            found.append(math.ceil((high_m + layer * apart_m) / HALF_M) * HALF_M)
            found.append(math.floor((low_m - layer * apart_m) / HALF_M) * HALF_M)
    return list(dict.fromkeys(found))


def _too_much(crew: Crew, flown: Flown) -> bool:
    """Whether a flight is over a limit, or comes to more items than are held."""
    return bool(over(crew, flown)) or items_in(crew, flown) > crew.aircraft.most_items


def _trip(sortie: Sortie) -> Trip:
    flown, crew = sortie.flown, sortie.flown.crew
    return Trip(
        crew,
        crew,
        crew,
        sortie.start_s,
        sortie.end_s,
        (),
        flown.use.length_m,
        flown.use.energy_wh or 0.0,
        0.0,
    )
