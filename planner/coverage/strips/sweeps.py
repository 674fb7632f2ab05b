"""Sweeps: a region seen strip by strip, with as many lanes as its width asks for.

In axes turned by the heading θ, x̂ ahead and ŷ to the left, a region spans [ŷ_min, ŷ_max] and n strips of one
swath l_sw cover it, n = ⌈(ŷ_max − ŷ_min) / l_sw⌉. What they have to spare, s = n·l_sw − (ŷ_max − ŷ_min), goes
into the overlap of neighbouring strips and what the outer ones see beyond the region: η of it, in equal
halves, beyond the edges (but for half a metre an overlap), the rest in n − 1 equal overlaps.

A strip [ŷ_low, ŷ_high] is seen to the right from ŷ_high + l_near on the way out and from ŷ_low − l_near on
the way back, to the left the other way round. Each lane runs as far as the region within its own strip does.
The order of lanes is that with the shortest turns: racetracks where the aircraft cannot turn into the next
lane.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.coverage import lanes_kernels
from planner.coverage.lanes_kernels import VARIANTS
from planner.coverage.merge import MergedRegion
from planner.coverage.strips import kernels
from planner.coverage.strips.classify import ROUNDING_M, hull_points, spans_at
from planner.coverage.strips.headings import MOST_LANES_FACTOR, grid, telling
from planner.coverage.strips.segments import Neighbourhood, collect_along
from planner.coverage.ways import Between
from planner.route import CollectPass, Look
from planner.sensors.sar import SarSensor
from planner.sensors.strip import strip_on, swaths_m

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Headings that need this many times the fewest lanes, and more than what is tried exactly, are left out.
MOST_LANES = 1000
#: Of the headings that a shape singles out, the ones with the shortest lanes are tried, so many of them.
MOST_TELLING = 32
#: Kept between neighbouring strips where there is enough to spare.
LEAST_OVERLAP_M = 0.5
_SAME_ANGLE_RAD = math.radians(0.01)


class Judge(Protocol):
    """Says what lanes cost."""

    def __call__(
        self, lines: Floats, headings_rad: Floats, looks: tuple[Look, ...]
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Cost (inf where not to be flown), entry and exit poses, and what want of room costs there.

        Lines are (N, 2, 2), of which line n looks to ``looks[n % len(looks)]``; the results (N,), (N, 3),
        (N, 3) and (N, 2).
        """


@dataclass(frozen=True, slots=True)
class Sweep:
    """All sweeps of one region that begin and end in a certain way.

    Parameters
    ----------
    variant
        2·b + e: begins in the left (b = 0) or right half of the lanes, ends onward (e = 0) or flying back.
    extra
        Lanes beyond the fewest.
    """

    region: MergedRegion
    sensor: SarSensor
    height_m: float
    variant: int = 0
    extra: int = 0

    @property
    def angles_rad(self) -> Floats:
        """Headings worth trying, shape (M,): the allowed ones, else a grid of 10° and the telling ones."""
        if self.region.approach_rad is not None:
            return np.unique(np.mod(np.asarray(self.region.approach_rad, dtype=np.float64), math.tau))
        return np.union1d(grid(self.region.area, math.radians(10.0)), telling_headings(self, 0.0))

    def lanes(self, angles_rad: Floats) -> Ints:
        """How many lanes each heading takes, shape (M,)."""
        across_m = spans_at(hull_points(self.region.area), angles_rad).across_m
        # A crab may leave hardly any swath, and no heading takes more lanes than this.
        swath_m = np.maximum(swaths_m(self.sensor, self.height_m, angles_rad), across_m / MOST_LANES)
        fewest = np.maximum(np.ceil((across_m - ROUNDING_M) / swath_m), 1.0).astype(np.int64)
        return np.asarray(fewest + self.extra, dtype=np.int64)


#: One family of ways to see a region: with one pass or the paper's two, or strip by strip.
Side = Neighbourhood | Sweep


@dataclass(frozen=True, slots=True)
class Lanes:
    """Every lane of a sweep in every state, at several headings with equally many lanes and several η.

    Parameters
    ----------
    headings_rad
        Of each state, shape (M, B).
    looks
        Of each state, length B.
    onward
        Which states fly at the heading itself, bool (B,).
    lines
        Shape (M, K, N, B, 2, 2): heading, η, lane from left to right, state, start and end.
    """

    headings_rad: Floats
    looks: tuple[Look, ...]
    onward: NDArray[np.bool_]
    lines: Floats


@dataclass(frozen=True, slots=True)
class Swept:
    """The best sweeps, one row each.

    Parameters
    ----------
    variant, angle_index, eta_index
        Of each, int64 (R,).
    entries, exits, inner_m
        First pose, last pose, cost between them; (R, 3), (R, 3), (R,).
    cramped_m
        What want of room costs at the first entry and the last exit, (R, 2).
    order
        The lanes in flight order, each in its state: lane · B + state, −1 after the last; int64 (R, L).
    """

    variant: Ints
    angle_index: Ints
    eta_index: Ints
    entries: Floats
    exits: Floats
    inner_m: Floats
    cramped_m: Floats
    order: Ints


def sweeps(region: MergedRegion, sensor: SarSensor, height_m: float, extra: int = 0) -> tuple[Sweep, ...]:
    """The sweeps of one region, a value for each way to begin and end."""
    return tuple(Sweep(region, sensor, height_m, variant, extra) for variant in range(VARIANTS))


def telling_headings(sweep: Sweep, turn_m: float, most: int = MOST_TELLING) -> Floats:
    """Of the headings that the region's shape singles out those with the shortest lanes, ascending.

    Parameters
    ----------
    turn_m
        What a turn from lane to lane is taken to cost.
    most
        How many.
    """
    angles_rad = telling(sweep.region.area, lambda at_rad: swaths_m(sweep.sensor, sweep.height_m, at_rad))
    counts = sweep.lanes(angles_rad)
    holds = _hold(sweep, angles_rad, counts)
    cost_m = np.full(len(angles_rad), np.inf)
    most_lanes = MOST_LANES_FACTOR * counts[holds].min() if holds.any() else 0.0
    for count in np.unique(counts[holds & (counts <= most_lanes)]):
        rows = np.flatnonzero(holds & (counts == count))
        lanes = lanes_at(sweep, angles_rad[rows], np.array([0.5]), int(count))
        ends_m = lanes.lines[:, 0, :, 0, 1] - lanes.lines[:, 0, :, 0, 0]
        cost_m[rows] = np.hypot(ends_m[..., 0], ends_m[..., 1]).sum(axis=1) + count * turn_m
    best = np.argsort(cost_m, kind="stable")[:most]
    return np.sort(angles_rad[best[np.isfinite(cost_m[best])]])


def lanes_at(sweep: Sweep, angles_rad: Floats, etas: Floats, count: int) -> Lanes:
    """Lanes at headings (M,) that all take ``count`` of them, and at η (K,)."""
    sensor, height_m = sweep.sensor, sweep.height_m
    # Edges of a strip are the same to either side and in either direction.
    strip = strip_on(sensor, height_m, angles_rad, "right")
    swath_m, near_m = strip.swath_m, strip.near_m[:, None, None]
    spans = spans_at(hull_points(sweep.region.area), angles_rad)
    spare_m = np.maximum(count * swath_m - spans.across_m, 0.0)
    # Neighbours keep some overlap where there is any to spare; a strip wholly beside the region sees nothing.
    kept_m = np.minimum(LEAST_OVERLAP_M * (count - 1), spare_m / 2.0)
    beyond_m = etas[None, :] * np.minimum(spare_m - kept_m, swath_m * (1.0 - 1e-6))[:, None] / 2.0
    if count == 1:
        beyond_m = etas[None, :] * spare_m[:, None]
    overlap_m = (spare_m[:, None] - 2.0 * beyond_m) / max(count - 1, 1)
    step_m = swath_m[:, None] - overlap_m
    high_m = (spans.y_max_m[:, None] + beyond_m)[:, :, None] - step_m[:, :, None] * np.arange(count)
    low_m = high_m - swath_m[:, None, None]
    extent_m = kernels.strip_extents(_edges(sweep.region), angles_rad, low_m, high_m)
    states: list[Floats] = []
    headings, looks, onward = [], [], []
    for way in _ways(sweep):
        courses_rad = angles_rad if way == 1 else angles_rad + math.pi
        for look in sensor.looks:
            flown = strip_on(sensor, height_m, courses_rad, look)
            run_in_m, run_out_m = flown.run_in_m[:, None, None], flown.run_out_m[:, None, None]
            from_high = (look == "right") == (way == 1)
            y_m = high_m + near_m if from_high else low_m - near_m
            first_m, last_m = (extent_m[..., 0], extent_m[..., 1])[::way]
            x_m = np.stack([first_m - way * run_in_m, last_m + way * run_out_m], axis=-1)
            cos = np.cos(angles_rad)[:, None, None, None]
            sin = np.sin(angles_rad)[:, None, None, None]
            east_m = cos * x_m - sin * y_m[..., None]
            north_m = sin * x_m + cos * y_m[..., None]
            states.append(np.stack([east_m, north_m], axis=-1))
            headings.append(courses_rad)
            looks.append(look)
            onward.append(way == 1)
    return Lanes(np.stack(headings, axis=1), tuple(looks), np.array(onward), np.stack(states, axis=3))


def best_sweeps(
    sweep: Sweep,
    angles_rad: Floats,
    etas: Floats,
    judge: Judge,
    radius_m: float,
    discs: Floats,
    between: Between | None = None,
    variants: Sequence[int] = range(VARIANTS),
) -> Swept:
    """The best order of lanes at each heading, for each of some variants; the best η only.

    The variant of ``sweep`` itself does not matter. Near the fewest lanes only: a heading that takes many
    more is left out. The best is that with what lies before and behind it, where that is known.
    """
    counts = sweep.lanes(angles_rad)
    found: list[Swept] = []
    wanted = np.isin(np.arange(VARIANTS), variants)
    # Where a crab leaves no swath, no number of lanes sees the region.
    holds = _hold(sweep, angles_rad, counts)
    if not holds.any():
        return _empty()
    most = max(lanes_kernels.EXACT_UP_TO, math.ceil(MOST_LANES_FACTOR * int(counts[holds].min())))
    kept = np.unique(counts[holds & (counts <= most)])
    for count in kept:
        rows = np.flatnonzero(holds & (counts == count))
        lanes, orders, costs, poses = _solve(
            sweep, angles_rad[rows], etas, int(count), judge, wanted, radius_m, discs, between
        )
        entries, exits, cramped_m, before_m, behind_m = poses
        best_eta = np.argmin(costs, axis=1)
        cheapest_m = np.take_along_axis(costs, best_eta[:, None, :], axis=1)[:, 0]
        m, variant = np.nonzero(np.isfinite(cheapest_m))
        k = best_eta[m, variant]
        order = orders[m, k, variant]
        begin, end = np.divmod(order[:, 0], len(lanes.looks)), np.divmod(order[:, -1], len(lanes.looks))
        room_m = np.stack([cramped_m[m, k, *begin, 0], cramped_m[m, k, *end, 1]], axis=1)
        padded = np.pad(order, ((0, 0), (0, int(kept.max()) - int(count))), constant_values=-1)
        found.append(
            Swept(
                variant,
                rows[m],
                k,
                entries[m, k, *begin],
                exits[m, k, *end],
                cheapest_m[m, variant] - before_m[m, k, *begin] - behind_m[m, k, *end],
                room_m,
                padded,
            )
        )
    if not found:
        return _empty()
    return Swept(*(np.concatenate([getattr(part, name) for part in found]) for name in Swept.__slots__))


def sweep_passes(sweep: Sweep, angle_rad: float, eta: float, order: Ints) -> tuple[CollectPass, ...]:
    """The passes of a sweep at one heading and η, in flight order.

    ``order`` is that of :class:`Swept`, shape (L,), with −1 after the last lane.
    """
    angles_rad = np.array([angle_rad])
    count = int(sweep.lanes(angles_rad)[0])
    lanes = lanes_at(sweep, angles_rad, np.array([eta]), count)
    passes = []
    for state in order[:count]:
        lane, b = divmod(int(state), len(lanes.looks))
        line = lanes.lines[0, 0, lane, b]
        heading_rad = float(lanes.headings_rad[0, b])
        passes.append(
            collect_along(sweep.region, sweep.sensor, sweep.height_m, lanes.looks[b], line, heading_rad, eta)
        )
    return tuple(passes)


def _solve(
    sweep: Sweep,
    angles_rad: Floats,
    etas: Floats,
    count: int,
    judge: Judge,
    wanted: NDArray[np.bool_],
    radius_m: float,
    discs: Floats,
    between: Between | None,
) -> tuple[Lanes, Ints, Floats, tuple[Floats, Floats, Floats, Floats, Floats]]:
    lanes = lanes_at(sweep, angles_rad, etas, count)
    shape = lanes.lines.shape[:4]
    headings_rad = np.broadcast_to(lanes.headings_rad[:, None, None, :], shape).ravel()
    cost_m, entries, exits, cramped_m = judge(lanes.lines.reshape(-1, 2, 2), headings_rad, lanes.looks)
    cost_m = np.where(allowed(sweep, headings_rad), cost_m, np.inf)
    before_m, behind_m = np.zeros((2, len(cost_m)))
    if between is not None:
        before_m, behind_m = between.before_m(entries), between.behind_m(exits)
    problems = (shape[0] * shape[1], *shape[2:])
    costs, orders = lanes_kernels.lane_orders(
        entries.reshape(*problems, 3),
        exits.reshape(*problems, 3),
        cost_m.reshape(problems),
        cramped_m.reshape(*problems, 2),
        before_m.reshape(problems),
        behind_m.reshape(problems),
        lanes.onward,
        lanes.onward,
        wanted,
        False,
        _strides(sweep, radius_m),
        radius_m,
        discs,
    )
    poses = (
        entries.reshape(*shape, 3),
        exits.reshape(*shape, 3),
        cramped_m.reshape(*shape, 2),
        before_m.reshape(shape),
        behind_m.reshape(shape),
    )
    return lanes, orders.reshape(*shape[:2], VARIANTS, count), costs.reshape(*shape[:2], VARIANTS), poses


def _hold(sweep: Sweep, angles_rad: Floats, counts: Ints) -> NDArray[np.bool_]:
    """At which headings so many strips hold the region, shape (M,)."""
    across_m = spans_at(hull_points(sweep.region.area), angles_rad).across_m
    swath_m = swaths_m(sweep.sensor, sweep.height_m, angles_rad)
    return np.asarray((counts * swath_m >= across_m - ROUNDING_M) & (swath_m > 0.0), dtype=np.bool_)


def _strides(sweep: Sweep, radius_m: float) -> int:
    """The widest stride of a racetrack that a turn can ask for.

    Its lanes, seen to one side out and to the other back, are a stride of strips, a strip and twice the blind
    ground below apart, or less by that; a turn is two radii wide.
    """
    strip = strip_on(sweep.sensor, sweep.height_m, 0.0, "right")
    swath_m = max(float(strip.swath_m[0]), 1e-3)
    wide_m = 2.0 * (radius_m + float(strip.near_m[0])) + swath_m
    return min(lanes_kernels.STRIDES, math.ceil(wide_m / swath_m) + 1)


def _ways(sweep: Sweep) -> tuple[int, ...]:
    """Onward, and back where some allowed heading has its opposite allowed too."""
    given = sweep.region.approach_rad
    if given is None or bool(allowed(sweep, np.asarray(given) + math.pi).any()):
        return (1, -1)
    return (1,)


def allowed(sweep: Sweep, headings_rad: Floats) -> NDArray[np.bool_]:
    """Which headings the region may be seen along."""
    if sweep.region.approach_rad is None:
        return np.ones(headings_rad.shape, dtype=np.bool_)
    given = np.asarray(sweep.region.approach_rad, dtype=np.float64)
    apart = np.abs(np.mod(headings_rad[..., None] - given + math.pi, math.tau) - math.pi)
    return np.asarray((apart <= _SAME_ANGLE_RAD).any(axis=-1), dtype=np.bool_)


def _edges(region: MergedRegion) -> Floats:
    ring = np.asarray(shapely.get_coordinates(region.area.exterior), dtype=np.float64)
    return np.concatenate([ring[:-1], ring[1:]], axis=1)


def _empty() -> Swept:
    none = np.empty(0, dtype=np.int64)
    return Swept(
        none,
        none,
        none,
        np.empty((0, 3)),
        np.empty((0, 3)),
        np.empty(0),
        np.empty((0, 2)),
        np.empty((0, 0), dtype=np.int64),
    )
