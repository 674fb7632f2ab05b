"""Where lanes end, beside a plain twin, and what that is for."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from planner.coverage.survey.ends_kernels import lane_ends

Floats = NDArray[np.float64]

lengths = st.floats(-100.0, 100.0)
#: As many lanes as cells but one.
some = st.integers(2, 8).flatmap(lambda n: st.tuples(*[st.lists(lengths, min_size=n, max_size=n)] * 2))


def plainly(line_m: list[float], cells_m: list[float], twice_m: float, once_m: float) -> list[float]:
    """The same, cell by cell in words: both lanes in one photo first, then the longer in two."""
    ends_m = list(line_m)
    pairs = [(0, 1), *((k, k + 1) for k in range(len(ends_m) - 1)), (len(ends_m) - 2, len(ends_m) - 1)]
    for (one, other), far_m in zip(pairs, cells_m, strict=True):
        for lane in (one, other):
            ends_m[lane] = max(ends_m[lane], far_m - once_m)
    for (one, other), far_m in zip(pairs, cells_m, strict=True):
        longer = other if ends_m[other] > ends_m[one] else one
        ends_m[longer] = max(ends_m[longer], far_m - twice_m)
    return ends_m


@given(some, lengths)
def test_of_the_lanes_beside_a_cell_both_see_it_and_one_twice(
    ends: tuple[list[float], list[float]], far_m: float
) -> None:
    """As the twin has it; no lane is shorter than its own line asks for."""
    line_m, between_m = ends
    cells_m = [*between_m, far_m]
    found = lane_ends(np.array([line_m]), np.array([cells_m]), np.array([10.0]), np.array([25.0]))[0]
    assert found.tolist() == plainly(line_m, cells_m, 10.0, 25.0)
    assert (found >= line_m).all()
    for cell, reach_m in enumerate(cells_m):
        one = min(max(cell - 1, 0), len(line_m) - 2)
        pair = found[one : one + 2]
        assert pair.min() >= reach_m - 25.0
        assert pair.max() >= reach_m - 10.0
