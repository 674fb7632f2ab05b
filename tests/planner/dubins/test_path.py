"""Points along a line against its own poses."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.angles import wrap_pi
from planner.dubins.path import Path, Segment
from planner.dubins.sample_kernels import wrapped
from planner.route import Pose

lengths = st.floats(0.0, 2000.0)
segments = st.builds(
    Segment,
    st.sampled_from(["straight", "left", "right"]),
    st.builds(Pose, st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(-7.0, 7.0)),
    lengths,
    st.floats(20.0, 900.0),
)


def plain_sample(path: Path, max_chord_m: float, max_straight_m: float) -> list[tuple[float, ...]]:
    """Poses in equal parts of every segment, each segment's ends among them."""
    rows: list[tuple[float, ...]] = []
    travelled_m = 0.0
    for segment in path.segments:
        spacing_m = max_straight_m if segment.kind == "straight" else max_chord_m
        parts = max(1, math.ceil(segment.length_m / spacing_m)) if math.isfinite(spacing_m) else 1
        for part in range(1 if rows else 0, parts + 1):
            along_m = segment.length_m * part / parts
            pose = segment.at(along_m)
            rows.append((*pose.position, pose.angle_rad, travelled_m + along_m))
        travelled_m += segment.length_m
    return rows


@settings(deadline=None)
@given(
    st.lists(segments, min_size=1, max_size=5),
    st.floats(5.0, 400.0),
    st.floats(5.0, 400.0) | st.just(math.inf),
)
def test_samples_are_the_segments_own_poses(
    parts: list[Segment], max_chord_m: float, max_straight_m: float
) -> None:
    """To the last bits: position, direction in (-π, π] and distance."""
    path = Path(tuple(parts))
    found = path.sample(max_chord_m, max_straight_m)
    expected = np.array(plain_sample(path, max_chord_m, max_straight_m))
    assert found[:, [0, 1, 3]] == pytest.approx(expected[:, [0, 1, 3]], rel=1e-14, abs=1e-11)
    turned = [wrap_pi(a - b) for a, b in zip(found[:, 2], expected[:, 2], strict=True)]
    assert turned == pytest.approx(np.zeros(len(turned)), abs=1e-14)


@given(st.floats(-40.0, 40.0) | st.sampled_from([math.pi, -math.pi, 3.0 * math.pi, -3.0 * math.pi]))
def test_angles_are_wrapped_alike(angle_rad: float) -> None:
    """The compiled wrap is the plain one, bit for bit."""
    assert wrapped(angle_rad) == wrap_pi(angle_rad)
