"""Circles between two others, by their distances; lines reused where discs that do not matter grow."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.transit.wheels import NEAREST, between

rows = st.tuples(
    st.floats(-900.0, 900.0), st.floats(-900.0, 900.0), st.sampled_from([-300.0, -100.0, 0.0, 100.0, 250.0])
)


@settings(deadline=None)
@given(st.lists(rows, max_size=4), st.lists(rows, max_size=20))
def test_middles_touch_both(ends: list[tuple[float, ...]], others: list[tuple[float, ...]]) -> None:
    """Each touches an end and another of its sense, the other way round; each possible pair has two."""
    middles = between(
        np.array(ends, dtype=np.float64).reshape(-1, 3),
        np.array(others, dtype=np.float64).reshape(-1, 3),
        80.0,
    )
    expected = 0
    for end in ends:
        apart = [
            (math.dist(end[:2], other[:2]), abs(end[2]) + 80.0, abs(other[2]) + 80.0)
            for other in others
            if other[2] * end[2] > 0.0
        ]
        possible = [d for d, near, far in apart if abs(far - near) < d < near + far]
        expected += 2 * min(len(possible), NEAREST)
    assert len(middles) == expected
    for middle in middles:
        assert abs(middle[2]) == 80.0

        def touched(wheels: list[tuple[float, ...]], to: np.ndarray = middle) -> set[float]:
            return {
                math.copysign(1.0, w[2])
                for w in wheels
                if w[2] * to[2] < 0.0
                and math.dist(w[:2], to[:2]) == pytest.approx(abs(w[2]) + 80.0, abs=1e-6)
            }

        assert touched(ends) & touched(others)
