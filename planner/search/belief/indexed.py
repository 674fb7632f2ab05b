"""Belief of many places, sorted so that what lines find of it is known in a fraction of a millisecond."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from planner.search.belief.indexed_kernels import found_by_time, line_by, sorted_by_cell
from planner.search.belief.lines import STEP_M, STRAIGHT_M
from planner.search.belief.patterns import Searcher
from planner.search.belief.target import Belief

Floats = NDArray[np.float64]
#: Cells to a side at most; where there are fewer, each is as wide as half of what is seen.
MOST_CELLS = 200


@dataclass(frozen=True, slots=True, eq=False)
class Indexed:
    """Places by cell for each span of time.

    Parameters
    ----------
    times_s
        Ends of the spans, by which success is told.
    middles_s
        Times at which the cells hold, one a span.
    mean_m_s, apart_m_s
        Drift that the cells go along with, and how far others are from it at most.
    soft_m
        So wide is each edge of what is seen: places stand for the ground round them.
    """

    belief: Belief
    times_s: Floats
    middles_s: Floats
    mean_m_s: Floats
    apart_m_s: float
    soft_m: float
    corner_m: Floats
    cell_m: float
    shape: tuple[int, int]
    order: NDArray[np.int32]
    begins: NDArray[np.int32]

    @classmethod
    def of(cls, belief: Belief, times_s: Floats, half_width_m: float, soft_m: float = 0.0) -> Self:
        """A belief, for lines that see about so much to either side, their edges softened by a width."""
        places, drifts = belief.places_m, belief.drifts_m_s
        mean = drifts.mean(axis=0)
        middles = times_s - 0.5 * np.diff(times_s, prepend=0.0)
        moved = np.stack([places + t * (drifts - mean) for t in (0.0, float(times_s[-1]))])
        low, high = moved.min(axis=(0, 1)), moved.max(axis=(0, 1))
        cell_m = max(half_width_m, float((high - low).max()) / MOST_CELLS)
        columns, rows = (max(1, math.ceil(size / cell_m)) for size in (high - low).tolist())
        apart = float(np.hypot(*(drifts - mean).T).max())
        order, begins = sorted_by_cell(places, drifts, mean, middles, low, cell_m, columns, rows)
        return cls(belief, times_s, middles, mean, apart, soft_m, low, cell_m, (rows, columns), order, begins)

    def success(
        self,
        lines: Sequence[Floats],
        searchers: Sequence[Searcher],
        since: Known | None = None,
        *,
        first_span: int = 0,
        keep: bool = False,
    ) -> Floats:
        """float64 (times,): probability that the target was found by each time; see ``success.success``.

        Parameters
        ----------
        since
            What is known of lines that are the same up to the span ``first_span``.
        keep
            Write it for these.
        """  # fmt: skip
        rows, columns = self.shape
        known = since or Known(np.zeros(0), np.zeros((0, 0)))
        return np.asarray(
            found_by_time(
                np.concatenate(list(lines)), np.cumsum([0, *(len(line) for line in lines)]),
                np.array([one.half_width_m for one in searchers]),
                np.array([1.0 - one.detection for one in searchers]), self.soft_m,
                self.belief.places_m, self.belief.drifts_m_s, self.belief.weights, self.times_s,
                self.middles_s, self.mean_m_s, self.apart_m_s, self.corner_m, self.cell_m, columns, rows,
                self.order, self.begins, first_span, known.found, known.lefts, keep,
            )
        )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """Of some lines: found by each time, (T,), and what looks have missed of each place by then, (T, N)."""

    found: Floats
    lefts: Floats


class Running:
    """Lines of several aircraft, and what becomes of them where one is changed.

    Parameters
    ----------
    worth
        Of success by time: the more the better.
    """

    def __init__(
        self,
        indexed: Indexed,
        searchers: Sequence[Searcher],
        worth: Callable[[Floats], float],
        lines: Sequence[Floats],
    ) -> None:
        spans, places = indexed.order.shape
        self._indexed, self._searchers, self._worth = indexed, searchers, worth
        self._known = Known(np.zeros(spans), np.zeros((spans, places)))
        self.lines = list(lines)
        self.value = worth(indexed.success(lines, searchers, self._known, keep=True))

    def better(self, index: int, line: Floats, least: float = 0.0) -> bool:
        """Whether the whole is worth more with another line of one aircraft: it is taken then."""
        again = [*self.lines[:index], line, *self.lines[index + 1 :]]
        span = self._same_spans(self.lines[index], line)
        by_time = self._indexed.success(again, self._searchers, self._known, first_span=span)
        value = self._worth(by_time)
        if value <= self.value + least:
            return False
        self._indexed.success(again, self._searchers, self._known, first_span=span, keep=True)
        self.lines, self.value = again, value
        return True

    def _same_spans(self, old: Floats, new: Floats) -> int:
        """How many spans of time two lines are the same for."""
        count = min(len(old), len(new))
        other = np.flatnonzero((old[:count] != new[:count]).any(axis=1))
        same = int(other[0]) if len(other) else count
        if same == len(old) == len(new):
            return len(self._indexed.times_s) - 1
        until_s = old[max(same - 1, 0), 2]
        return int(np.searchsorted(self._indexed.times_s, until_s, side="right"))


def flown_by(corners: Floats, one: Searcher) -> Floats:
    """Line (M, 3) along corners (K, 2) from a searcher's base, and home in time."""
    return np.asarray(line_by(corners, one.turn_radius_m, one.speed_m_s, one.until_s, STEP_M, STRAIGHT_M))
