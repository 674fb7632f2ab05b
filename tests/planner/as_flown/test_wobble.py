"""An antenna that wobbles within its margins leaves no gaps between one moment and the next."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import get_parts
from shapely.geometry import Polygon

from planner.as_flown.coverage import FlownCoverage
from tests.planner.as_flown.test_beam import HEIGHT_M, SPEED_M_S, Flight, planned
from tests.planner.terrains import grid

STEP_S = 0.25
#: Notches narrower than twice this are looked for.
NOTCH_M = 1.0


def wobbling(
    crab_deg: float, wobbles_deg: tuple[float, float, float], seed: int, on_terrain: bool
) -> Polygon:
    """What is credited of the whole pass: nose off the course, and roll, pitch and yaw about it."""
    scenario, plan = planned()
    first, last = scenario.frame.to_local([place[:2] for place in plan.collects[0].line])
    ahead = (last - first) / np.hypot(*(last - first))
    count = int(np.hypot(*(last - first)) / (SPEED_M_S * STEP_S))
    time_s = STEP_S * np.arange(count)
    random = np.random.default_rng(seed)
    phases, periods_s = random.uniform(0.0, math.tau, 3), random.uniform(3.0, 12.0, 3)
    angles = np.radians(wobbles_deg)[:, None] * np.sin(
        phases[:, None] + math.tau * time_s / periods_s[:, None]
    )
    nose = math.atan2(ahead[0], ahead[1]) + math.radians(crab_deg) + angles[2]
    flight = Flight(time_s, first + SPEED_M_S * time_s[:, None] * ahead, HEIGHT_M, angles[0], angles[1], nose)
    if on_terrain:
        scenario = replace(scenario, terrain=grid(lambda e, n: 0.0 * e))
    return all_of(flight.seen(scenario))


def all_of(found: FlownCoverage) -> Polygon:
    """One shape, all of it."""
    (shape,) = found.seen.values()
    parts = [part for part in get_parts(shape).tolist() if part.area > 1.0]
    assert len(parts) == 1, [part.area for part in parts]
    assert isinstance(parts[0], Polygon)
    return parts[0]


@settings(max_examples=8, deadline=None)
@given(
    st.floats(-20.0, 20.0),
    st.tuples(st.floats(0.0, 2.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
    st.integers(0, 2**32 - 1),
)
def test_ground_seen_is_whole(crab_deg: float, wobbles_deg: tuple[float, float, float], seed: int) -> None:
    """Closing what is narrower than two metres adds nothing: there are no slivers within."""
    seen = wobbling(crab_deg, wobbles_deg, seed, False)
    assert not seen.interiors
    closed = seen.buffer(NOTCH_M, join_style="mitre").buffer(-NOTCH_M, join_style="mitre")
    assert closed.area - seen.area < 2e-4 * seen.area


@pytest.mark.parametrize("crab_deg", [0.0, 18.0, -18.0])
def test_on_a_level_raster_the_same_is_seen(crab_deg: float) -> None:
    """Terrain that is flat gives what flat ground gives, the ends that run aslant with the beam included."""
    flat, terrain = (wobbling(crab_deg, (1.5, 0.5, 0.7), 3, on) for on in (False, True))
    assert flat.symmetric_difference(terrain).area < 0.01 * flat.area
