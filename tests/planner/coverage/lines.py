"""Lines that corridors follow, as they are digitised: curves, noisy roads, rivers, rings, knots."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString

Floats = NDArray[np.float64]

KINDS = ("curve", "road", "river", "ring", "loop", "hairpins", "bends")


def digitised(kind: str, seed: int) -> LineString:
    """A line of one kind, some kilometres long, turned anyhow."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    count, length_m = int(rng.integers(60, 200)), float(rng.uniform(4_000.0, 12_000.0))
    along = np.linspace(0.0, 1.0, count)
    if kind == "curve":
        waves = rng.uniform(1.0, 4.0)
        places = [length_m * along, rng.uniform(200.0, 1200.0) * np.sin(math.tau * waves * along)]
    elif kind == "road":
        places = [length_m * along, rng.normal(0.0, rng.uniform(2.0, 25.0), count)]
    elif kind == "river":
        course = rng.uniform(0.6, 1.7) * np.sin(math.tau * rng.uniform(2.0, 4.0) * along)
        course += np.cumsum(rng.normal(0.0, 0.02, count))
        places = [np.cumsum(length_m / count * np.cos(course)), np.cumsum(length_m / count * np.sin(course))]
    elif kind == "ring":
        wide = 1.0 + rng.uniform(0.0, 0.25) * np.sin(math.tau * int(rng.integers(2, 5)) * along)
        places = [
            rng.uniform(800.0, 2500.0) * wide * np.cos(math.tau * along),
            rng.uniform(800.0, 2500.0) * wide * np.sin(math.tau * along),
        ]
        places = [np.append(place[:-1], place[0]) for place in places]
    elif kind == "loop":
        size_m = rng.uniform(1000.0, 2500.0)
        places = [
            size_m * np.sin(math.tau * along),
            0.6 * size_m * np.sin(2.0 * math.tau * along) + rng.normal(0.0, 2.0, count),
        ]
    elif kind == "hairpins":
        rows = np.repeat(np.arange(int(rng.integers(3, 7))), 2)
        there = (np.arange(len(rows)) % 4 == 1) | (np.arange(len(rows)) % 4 == 2)
        places = [there * rng.uniform(600.0, 2500.0), rows * rng.uniform(80.0, 500.0)]
    else:
        courses = np.cumsum(rng.uniform(-1.2, 1.2, int(rng.integers(3, 8))))
        steps = rng.uniform(400.0, 2000.0, len(courses))
        places = [np.cumsum(steps * np.cos(courses)), np.cumsum(steps * np.sin(courses))]
    turned = np.stack(places, axis=1) @ _turn(float(rng.uniform(0.0, math.tau)))
    return LineString(turned)


def _turn(angle_rad: float) -> Floats:
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[cos, -sin], [sin, cos]])
