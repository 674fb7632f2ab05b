"""Sweeps among obstacles as passes of the planner."""

from __future__ import annotations

import math

import numpy as np
from shapely.geometry import LineString, box

from planner.coverage.urban.measures import Sweep
from planner.coverage.urban.regions import EDGE_M, pass_of
from planner.photos import intervals
from planner.sensors.camera import CameraSensor
from planner.sensors.optics import Optics
from planner.wishes import Region

#: A photo every 40 m at 100 m of height, 35 m at least at 17.5 m/s.
EYE = CameraSensor(
    "eye", Optics(0.02, 4e-6, 6000, 4000), 0.5, 0.6, min_interval_s=2.0, airspeed_m_s=17.5, thin=1.0
)


def test_photos_of_sweeps_are_never_closer_than_the_camera_takes_them_where_there_is_room() -> None:
    """Of any length and heading, passes go on within the ground until the camera has its time."""
    ground = box(0.0, 0.0, 300.0, 200.0)
    region = Region("town", ground)
    rng = np.random.default_rng(3)
    longer = 0
    for _ in range(300):
        middle = rng.uniform((60.0, 60.0), (240.0, 140.0))
        angle_rad = rng.uniform(-math.pi, math.pi)
        half = rng.uniform(0.01, 55.0) * np.array([math.cos(angle_rad), math.sin(angle_rad)])
        (west, south), (east, north) = (middle - half).tolist(), (middle + half).tolist()
        sweep = Sweep((west, south), (east, north))
        flown = pass_of(region, EYE, 100.0, sweep, ground)
        line = LineString([flown.start, flown.end])
        assert line.buffer(EDGE_M).covers(LineString([sweep.start, sweep.end]))
        apart_m = flown.length_m / intervals(flown)
        assert ground.buffer(EDGE_M).covers(line)
        longer += flown.length_m > max(sweep.length_m, 1.0) + 1e-6
        assert apart_m >= EYE.least_spacing_m(angle_rad) - 1e-6
    assert longer > 50


def test_where_there_is_no_room_a_pass_ends_with_the_ground() -> None:
    """What may not be flown over is not, whatever the camera needs."""
    ground = box(0.0, 0.0, 45.0, 10.0)
    flown = pass_of(Region("yard", ground), EYE, 100.0, Sweep((1.0, 5.0), (44.0, 5.0)), ground)
    assert ground.buffer(EDGE_M).covers(LineString([flown.start, flown.end]))
    assert flown.length_m > 44.9
