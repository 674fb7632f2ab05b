"""What passes find of something that drifts: places that stand for where it may be, each moving on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.special import ndtri

from planner.search.belief.target import Belief, Target, evenly_spread
from planner.search.kernels import drifting_gains
from planner.search.programme import Pricing, Sweep
from planner.search.seen import missed_before
from planner.wishes import Drift, Importance, ImportancePatch, ImportancePoint, ImportanceRaster

Floats = NDArray[np.float64]
Source = ImportancePoint | ImportancePatch | ImportanceRaster

#: Places that stand for all, and for one source of importance at least.
PLACES, LEAST_PLACES = 1024, 64
#: What is found at the flight's end counts so much less than what is found at once.
SOONER = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Drifting:
    """What is looked for, as believed at the search's start.

    Parameters
    ----------
    belief
        Its weights are worth.
    detection
        Probability that a look finds what it sees.
    lead_s
        From the start to level flight: what the way through the air does not tell.
    until_s
        How long the flight lasts at most; what is found then counts ``1 - SOONER`` of what is found at once.
    """

    belief: Belief
    detection: float
    lead_s: float
    until_s: float

    @property
    def total(self) -> float:
        """Of all there is."""
        return float(self.belief.weights.sum())

    def found(self, sweeps: Sequence[Sweep], pricing: Pricing) -> float:
        """By all passes in their order, the sooner the better."""
        if not sweeps:
            return 0.0
        rows, begins_s, lengths_m, speeds = self._flown(sweeps, pricing)
        gains = self._gains(self.belief.weights.copy(), rows, begins_s, lengths_m, speeds)
        late = np.clip(begins_s / max(self.until_s, 1e-9), 0.0, 1.0)
        return float(gains @ (1.0 - SOONER * late))

    def alone(self, sweeps: Sequence[Sweep], pricing: Pricing) -> Floats:
        """By each pass when it comes in their order, as if there were no other."""
        rows, begins_s, lengths_m, speeds = self._flown(sweeps, pricing)
        ones = [slice(k, k + 1) for k in range(len(sweeps))]
        return np.array(
            [
                self._gains(self.belief.weights.copy(), rows[k], begins_s[k], lengths_m[k], speeds[k])[0]
                for k in ones
            ]
        )

    def _flown(self, sweeps: Sequence[Sweep], pricing: Pricing) -> tuple[Floats, Floats, Floats, Floats]:
        """Rows of passes, when each begins, their lengths and speeds over the ground."""
        model = pricing.model
        entries, exits = pricing.poses(sweeps)
        factor = model.air_factor(np.array([sweep.course_rad for sweep in sweeps]))
        airspeed_m_s = model.aircraft.airspeed_m_s
        begins_m = pricing.arrivals_m(sweeps, entries, exits) + model.settle_m * factor
        lengths_m = np.array([sweep.length_m for sweep in sweeps])
        rows = np.array([sweep.row for sweep in sweeps])
        return rows, self.lead_s + begins_m / airspeed_m_s, lengths_m, np.asarray(airspeed_m_s / factor)

    def _gains(
        self, left: Floats, rows: Floats, begins_s: Floats, lengths_m: Floats, speeds: Floats
    ) -> Floats:
        belief = self.belief
        return drifting_gains(
            left, belief.places_m, belief.drifts_m_s, rows, begins_s, lengths_m, speeds, 1.0 - self.detection
        )

    def target(self) -> Target:
        """One normal distribution that has its mean and its spread."""
        belief = self.belief
        share = belief.weights / self.total
        place, drift = share @ belief.places_m, share @ belief.drifts_m_s
        spread = math.sqrt(0.5 * float(share @ ((belief.places_m - place) ** 2).sum(axis=1)))
        drift_spread = math.sqrt(0.5 * float(share @ ((belief.drifts_m_s - drift) ** 2).sum(axis=1)))
        return Target(
            (float(place[0]), float(place[1])), spread, (float(drift[0]), float(drift[1])), drift_spread
        )

    def within(self, ground: shapely.Geometry) -> Drifting:
        """Of what is over some ground in the middle of the flight; all of it where nothing is."""
        belief = self.belief
        middle = belief.places_m + 0.5 * self.until_s * belief.drifts_m_s
        inside = shapely.contains_xy(ground, middle[:, 0], middle[:, 1])
        if not inside.any():
            return self
        return replace(self, belief=replace(belief, weights=np.where(inside, belief.weights, 0.0)))


def believed(importance: Importance, drift: Drift, count: int = PLACES, seed: int = 0) -> Belief:
    """Places that importance and drift stand for at the search's start; their weights are its worth."""
    sizes = [point.total for point in importance.points]
    sizes += [patch.score * patch.area.area for patch in importance.patches]
    sources: list[Source] = [*importance.points, *importance.patches]
    if importance.raster is not None:
        sources.append(importance.raster)
        sizes.append(float(importance.raster.scores.sum()) * importance.raster.cell_m**2)
    whole = math.fsum(sizes)
    places, drifts, weights = [], [], []
    for number, (source, size) in enumerate(zip(sources, sizes, strict=True)):
        if size <= 0.0:
            continue
        many = max(LEAST_PLACES, round(count * size / whole))
        there, normal = _places_of(source, many, seed + number)
        places.append(there)
        drifts.append(np.array([drift.east_m_s, drift.north_m_s]) + drift.spread_m_s * normal)
        weights.append(np.full(len(there), size / len(there)))
    moved = np.concatenate(drifts)
    now = np.concatenate(places) + drift.elapsed_s * moved
    return Belief(now, moved, np.concatenate(weights) * missed_before(importance, now, moved))


def _places_of(source: Source, count: int, seed: int) -> tuple[Floats, Floats]:
    """Places of one source as likely as each other, and beside each a normal number for its drift, (N, 2)."""
    if isinstance(source, ImportancePoint):
        numbers = ndtri(evenly_spread(count, seed))
        return np.asarray(source.position) + source.spread_m * numbers[:, :2], numbers[:, 2:]
    if isinstance(source, ImportanceRaster):
        numbers = evenly_spread(count, seed)
        scores = source.scores.ravel()
        upto = np.cumsum(scores) / scores.sum()
        # The first number finds a cell, and what is left of it the place across the cell.
        cell = np.minimum(np.searchsorted(upto, numbers[:, 0], side="right"), len(scores) - 1)
        part = (numbers[:, 0] - np.where(cell > 0, upto[cell - 1], 0.0)) / (scores[cell] / scores.sum())
        row, column = np.divmod(cell, source.scores.shape[1])
        across = np.stack([column + np.clip(part, 0.0, 1.0), row + numbers[:, 1]], axis=1)
        return np.array([source.west_m, source.south_m]) + source.cell_m * across, ndtri(numbers[:, 2:])
    west_m, south_m, east_m, north_m = source.area.bounds
    share = source.area.area / ((east_m - west_m) * (north_m - south_m))
    numbers = evenly_spread(2 ** math.ceil(math.log2(count / share)), seed)
    there = np.array([west_m, south_m]) + numbers[:, :2] * np.array([east_m - west_m, north_m - south_m])
    inside = shapely.contains_xy(source.area, there[:, 0], there[:, 1])
    return there[inside], ndtri(numbers[inside, 2:])
