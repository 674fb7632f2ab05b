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
some = st.integers(2, 8).flatmap(lambda n: st.tuples(*[st.lists(lengths, min_size=n, max_size=n)] * 4))
#: How far ground may lie beyond a lane's end to be in two of its photos, and in one.
TWICE_M, ONCE_M = 10.0, 25.0


def plainly(line_m: list[float], back_m: list[float], cells: list[tuple[float, float, float]]) -> list[float]:
    """The same in words: whoever has to see a cell in one photo, then one of the two beside it in two."""
    ends_m, last = list(line_m), len(line_m) - 1
    pairs = [(0, 1), *((k, k + 1) for k in range(last)), (last - 1, last)]
    for k, ((one, other), (far_m, near_part_m, far_part_m)) in enumerate(zip(pairs, cells, strict=True)):
        between = 0 < k < len(cells) - 1
        shorter_m = max(ends_m[one], near_part_m - ONCE_M), max(ends_m[other], far_part_m - ONCE_M)

        def helps(lane: int, leaves_off_m: float, far_m: float = far_m, between: bool = between) -> bool:
            """Whether a lane goes from where another leaves off to where the ground ends."""
            there = between and 0 <= lane <= last
            return there and ends_m[lane] >= far_m - ONCE_M and back_m[lane] <= leaves_off_m + ONCE_M

        helped = helps(other + 1, shorter_m[0]), helps(one - 1, shorter_m[1])
        ends_m[one] = shorter_m[0] if helped[0] else max(ends_m[one], far_m - ONCE_M)
        ends_m[other] = shorter_m[1] if helped[1] else max(ends_m[other], far_m - ONCE_M)
    for (one, other), (far_m, _, _) in zip(pairs, cells, strict=True):
        longer = other if ends_m[other] > ends_m[one] else one
        ends_m[longer] = max(ends_m[longer], far_m - TWICE_M)
    return ends_m


@given(some, lengths)
def test_each_cell_is_seen_by_two_lanes_and_twice_by_one(
    ends: tuple[list[float], list[float], list[float], list[float]], far_m: float
) -> None:
    """As the twin has it; no lane is shorter than its own line asks for."""
    line_m, between_m, less_m, back_m = ends
    whole_m = [*between_m, far_m]
    parts_m = [min(one, other) for one, other in zip(whole_m, [*less_m, far_m], strict=True)]
    cells = list(zip(whole_m, parts_m, parts_m[::-1], strict=True))
    cells = [(whole, near, min(far, whole)) for whole, near, far in cells]
    whole, near, far = (np.array([column]) for column in zip(*cells, strict=True))
    seen_m = np.array([TWICE_M]), np.array([ONCE_M])
    found = lane_ends(np.array([line_m]), np.array([back_m]), whole, near, far, *seen_m)[0]
    assert found.tolist() == plainly(line_m, back_m, cells)
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
    seen_m = np.array([10.0]), np.array([25.0])
    found = lane_ends(line_m, line_m - 400.0, cells_m, none, none, *seen_m)[0]
    assert found.tolist() == [0.0, 100.0, 275.0, 300.0]
    # One that begins beyond where the other leaves off is no help.
    found = lane_ends(line_m, line_m - 50.0, cells_m, none, none, *seen_m)[0]
    assert found.tolist() == [75.0, 175.0, 275.0, 300.0]
