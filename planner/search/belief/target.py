"""Where a target may be: from where it was last known, how it drifts, and how sure both are."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

Floats = NDArray[np.float64]


def evenly_spread(count: int, seed: int) -> Floats:
    """Rows of four numbers between 0 and 1, (count, 4), spread by a scrambled Sobol sequence of the seed."""
    # scipy.stats takes half a second to import, and few plans draw places.
    from scipy.stats.qmc import Sobol

    power = max(0, math.ceil(math.log2(count)))
    even: Floats = Sobol(4, scramble=True, seed=seed).random_base2(power)[:count]
    return even


@dataclass(frozen=True, slots=True)
class Target:
    """What is known of the one missing.

    Parameters
    ----------
    last_known_m
        East and north in the local frame.
    spread_m
        Standard deviation of that place, in each direction.
    drift_m_s
        East and north: current and leeway together.
    drift_spread_m_s
        Standard deviation of the drift, in each direction; it stays as it is for the whole search.
    elapsed_s
        How long before the search's start the target was there.
    """

    last_known_m: tuple[float, float]
    spread_m: float
    drift_m_s: tuple[float, float] = (0.0, 0.0)
    drift_spread_m_s: float = 0.0
    elapsed_s: float = 0.0

    def __post_init__(self) -> None:
        numbers = (*self.last_known_m, *self.drift_m_s)
        limits = (self.spread_m, self.drift_spread_m_s, self.elapsed_s)
        if not all(map(math.isfinite, numbers)) or not all(0.0 <= one < math.inf for one in limits):
            raise ValueError("every number of a target is finite, spreads and elapsed_s at least 0")

    def datum_m(self, time_s: float) -> tuple[float, float]:
        """Where it most likely is so long after the search's start."""
        since_s = self.elapsed_s + time_s
        east, north = self.last_known_m
        return (east + since_s * self.drift_m_s[0], north + since_s * self.drift_m_s[1])

    def error_m(self, time_s: float) -> float:
        """Standard deviation of its place then, in each direction."""
        return math.hypot(self.spread_m, self.drift_spread_m_s * (self.elapsed_s + time_s))


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """Places that the target may start from, how each moves on, and how likely each is.

    Parameters
    ----------
    places_m, drifts_m_s
        float64 (N, 2): east and north at the search's start, and after that by second.
    weights
        float64 (N,), sum 1 before anything was seen.
    """

    places_m: Floats
    drifts_m_s: Floats
    weights: Floats

    @classmethod
    def drawn(cls, target: Target, count: int, seed: int = 0) -> Belief:
        """As many equally likely places as asked for, evenly spread by a Sobol sequence of the seed.

        Counts are best powers of two; runs of places of such a length are evenly spread, too.
        """
        even = ndtri(evenly_spread(count, seed))
        drifts = np.asarray(target.drift_m_s) + target.drift_spread_m_s * even[:, 2:]
        places = np.asarray(target.last_known_m) + target.spread_m * even[:, :2]
        return cls(places + target.elapsed_s * drifts, drifts, np.full(count, 1.0 / count))

    def after(self, looks: NDArray[np.int64], detection: float, time_s: float) -> Belief:
        """What is believed after a time, when looks (N,) at each place found nothing.

        The weights' sum is the probability that the target was not found.
        """
        return replace(
            self,
            places_m=self.places_m + time_s * self.drifts_m_s,
            weights=self.weights * (1.0 - detection) ** looks,
        )
