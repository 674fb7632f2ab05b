"""How likely the target is found, by time: over what is believed, for all aircraft together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planner.search.belief.kernels import looks_by_time
from planner.search.belief.patterns import Searcher
from planner.search.belief.target import Belief

Floats = NDArray[np.float64]


def missed(lines: Sequence[Floats], searchers: Sequence[Searcher], belief: Belief, times_s: Floats) -> Floats:
    """float64 (times, N): probability at each place that no look of any aircraft has found it by then."""
    left = np.ones((len(times_s), len(belief.weights)))
    for line, one in zip(lines, searchers, strict=True):
        looks = looks_by_time(line, belief.places_m, belief.drifts_m_s, one.half_width_m, times_s)
        left *= (1.0 - one.detection) ** looks
    return left


def success(
    lines: Sequence[Floats], searchers: Sequence[Searcher], belief: Belief, times_s: Floats
) -> Floats:
    """float64 (times,): probability that the target was found by each time."""
    found: Floats = (1.0 - missed(lines, searchers, belief, times_s)) @ belief.weights
    return found
