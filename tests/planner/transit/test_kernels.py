"""The heap against heapq and the hash grid against a look at every pose."""

from __future__ import annotations

import heapq
import math
import random

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.transit.kernels import BUCKETS, forget, nearest, pop, push, remember


@given(st.lists(st.one_of(st.none(), st.integers(0, 20)), max_size=200))
@settings(max_examples=100, deadline=None)
def test_heap_pops_like_heapq(steps):
    """Pushes (numbers) and pops (None) in any order leave like heapq's, equal keys in order of item."""
    keys, items = np.empty(201), np.empty(201, np.int64)
    size = 0
    twin: list[tuple[float, int]] = []
    for item, key in enumerate(steps):
        if key is not None:
            size = push(keys, items, size, float(key), item)
            heapq.heappush(twin, (float(key), item))
        elif twin:
            top, size = pop(keys, items, size)
            assert top == heapq.heappop(twin)[1]
        assert size == len(twin)


def test_grid_finds_what_a_full_look_finds():
    """The nearest remembered pose within distance and direction, through forgetting, across cell borders."""
    rng = random.Random(1)
    count = 600
    poses = np.array(
        [
            [rng.uniform(-400.0, 400.0), rng.uniform(-400.0, 400.0), rng.uniform(-7.0, 7.0)]
            for _ in range(count)
        ]
    )
    heads, chain = np.full(BUCKETS, -1, np.int64), np.empty(count, np.int64)
    kept: list[int] = []
    hits = 0
    for item, (east, north, angle) in enumerate(poses):
        for within_rad in (0.3, math.pi):
            near = [
                (math.floor(((poses[k, 0] - east) ** 2 + (poses[k, 1] - north) ** 2) * 1e6), k)
                for k in kept
                if math.hypot(poses[k, 0] - east, poses[k, 1] - north) < 50.0
                and abs(math.remainder(poses[k, 2] - angle, 2.0 * math.pi)) <= within_rad
            ]
            found = nearest(east, north, angle, poses, heads, chain, 50.0, within_rad)
            assert found == (min(near)[1] if near else -1)
            hits += bool(near)
        remember(east, north, item, heads, chain, 50.0)
        kept.append(item)
        if rng.random() < 0.3:
            gone = kept.pop(rng.randrange(len(kept)))
            forget(poses[gone, 0], poses[gone, 1], gone, heads, chain, 50.0)
    assert hits > 300
