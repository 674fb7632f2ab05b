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
some = st.integers(2, 8).flatmap(lambda n: st.tuples(*[st.lists(lengths, min_size=n, max_size=n)] * 3))
#: How far ground may lie beyond a lane's end to be in two of its photos, and in one.
TWICE_M, ONCE_M = 10.0, 25.0


def plainly(line_m: list[float], cells: list[tuple[float, float, float]]) -> list[float]:
    """The same in words: whoever has to see a cell in one photo, then one of the two beside it in two."""
    ends_m, last = list(line_m), len(line_m) - 1
    pairs = [(0, 1), *((k, k + 1) for k in range(last)), (last - 1, last)]
    for k, ((one, other), (far_m, near_part_m, far_part_m)) in enumerate(zip(pairs, cells, strict=True)):
        between = 0 < k < len(cells) - 1
        helped_beyond = between and other < last and ends_m[other + 1] >= far_m - ONCE_M
        helped_before = between and one > 0 and ends_m[one - 1] >= far_m - ONCE_M
        ends_m[one] = max(ends_m[one], (near_part_m if helped_beyond else far_m) - ONCE_M)
        ends_m[other] = max(ends_m[other], (far_part_m if helped_before else far_m) - ONCE_M)
    for (one, other), (far_m, _, _) in zip(pairs, cells, strict=True):
        longer = other if ends_m[other] > ends_m[one] else one
        ends_m[longer] = max(ends_m[longer], far_m - TWICE_M)
    return ends_m


@given(some, lengths)
def test_each_cell_is_seen_by_two_lanes_and_twice_by_one(
    ends: tuple[list[float], list[float], list[float]], far_m: float
) -> None:
    """As the twin has it; no lane is shorter than its own line asks for."""
    line_m, between_m, less_m = ends
    whole_m = [*between_m, far_m]
    parts_m = [min(one, other) for one, other in zip(whole_m, [*less_m, far_m], strict=True)]
    cells = list(zip(whole_m, parts_m, parts_m[::-1], strict=True))
    cells = [(whole, near, min(far, whole)) for whole, near, far in cells]
    whole, near, far = (np.array([column]) for column in zip(*cells, strict=True))
    found = lane_ends(np.array([line_m]), whole, near, far, np.array([TWICE_M]), np.array([ONCE_M]))[0]
    assert found.tolist() == plainly(line_m, cells)
    assert (found >= line_m).all()
    for cell, reach_m in enumerate(whole_m):
        one = min(max(cell - 1, 0), len(line_m) - 2)
        assert found[one : one + 2].max() >= reach_m - TWICE_M
        assert (found[max(one - 1, 0) : one + 3] >= reach_m - ONCE_M).sum() >= min(2, len(line_m)) - 1


def test_a_lane_beyond_stands_in_for_the_shorter_of_two() -> None:
    """On a slope a lane need not see what the next two do; the last but one has no such help."""
    line_m = np.array([[0.0, 100.0, 200.0, 300.0]])
    cells_m = np.array([[0.0, 100.0, 200.0, 300.0, 300.0]])
    none = np.full((1, 5), -np.inf)
    found = lane_ends(line_m, cells_m, none, none, np.array([10.0]), np.array([25.0]))[0]
    assert found.tolist() == [0.0, 100.0, 275.0, 300.0]
