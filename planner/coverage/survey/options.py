"""Ways to fly the lanes over one piece of ground, as arrays: what is chosen among."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.airspace.surroundings import Surroundings
from planner.coverage.lanes_kernels import EXACT_UP_TO, STRIDES, VARIANTS, lane_orders, turns_between
from planner.coverage.lines import NO_ROOM_M, judge_lines, poses_of, roomy
from planner.coverage.merge import MergedRegion
from planner.coverage.reorder_kernels import reordered
from planner.coverage.strips.headings import first_visit_rad
from planner.coverage.survey.gaps import photographed
from planner.coverage.survey.lanes import STATES, Lanes, Survey, lanes_at
from planner.coverage.turns_kernels import ends_of
from planner.coverage.ways import Between
from planner.route import CollectPass
from planner.sensors.camera_view import seen_on_flat

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Of the half circle's share that each visit has to itself this part is used: their headings differ.
SHARE_USED = 0.8
#: Headings are allowed ones within this.
SAME_RAD = math.radians(0.01)
#: Lanes laid for one question at most, so that wide surveys take no longer: at headings and offsets that an
#: estimate tells to be the cheapest.
MOST_LAID = 6_000
FEWEST_WAYS = 4
#: More lanes than this keep the order of a pattern. Fewer are put in a shorter one, looked for so often with
#: so many pairs of lanes in all, and so often at most.
MOST_REORDERED, PAIRS_LOOKED_AT, MOST_LOOKS = 160, 100_000, 300
#: A trigger is not stopped for less than so many photos.
LEAST_PHOTOS = 3.0


@dataclass(frozen=True, slots=True)
class LaneOptions:
    """Ways to fly lanes over one piece of ground.

    Parameters
    ----------
    angles_rad, etas
        Of each, (K,).
    entries, exits
        Poses before the first lane (settling included) and after the last, (K, 3).
    inner_m
        Cost from entry to exit, (K,).
    orders
        Lanes in flight order, 2 · lane + state, −1 after the last; (K, L).
    """

    angles_rad: Floats
    etas: Floats
    entries: Floats
    exits: Floats
    inner_m: Floats
    orders: Ints

    def rows(self, kept: Ints) -> LaneOptions:
        """Some of them."""
        return LaneOptions(*(getattr(self, name)[kept] for name in LaneOptions.__slots__))


def lane_options(
    region: MergedRegion,
    survey: Survey,
    angles_rad: Floats,
    etas: Floats,
    around: Surroundings,
    between: Between | None = None,
    most: int = MOST_LAID,
) -> LaneOptions | None:
    """Options at headings and offsets that keep the hard constraints; None where there are none.

    At each heading the cheapest offset for each way to begin and end.

    Parameters
    ----------
    between
        What the orders of lanes are chosen for; for themselves where that is not known.
    most
        Lanes laid at most.
    """
    angles_rad, etas = _of_visit(region, angles_rad, etas)
    angles_rad = angles_rad[survey.frames(angles_rad).good]
    if len(angles_rad) == 0 or len(etas) == 0:
        return None
    counts = survey.counts(angles_rad)
    kept = _likely(survey, angles_rad, counts, around.radius_m, max(most // len(etas), 1))
    angles_rad, counts = angles_rad[kept], counts[kept]
    found = [
        _of_count(region, survey, angles_rad[counts == count], etas, int(count), around, between)
        for count in np.unique(counts)
    ]
    parts = [part for part in found if part is not None]
    if not parts:
        return None
    width = max(part.orders.shape[1] for part in parts)
    padded = [
        np.pad(part.orders, ((0, 0), (0, width - part.orders.shape[1])), constant_values=-1) for part in parts
    ]
    columns = ([getattr(part, name) for part in parts] for name in LaneOptions.__slots__[:-1])
    angles_rad, etas, entries, exits, inner_m = (np.concatenate(column) for column in columns)
    return LaneOptions(angles_rad, etas, entries, exits, inner_m, np.concatenate(padded))


def collect_passes(
    region: MergedRegion, survey: Survey, options: LaneOptions, index: int, around: Surroundings
) -> tuple[CollectPass, ...]:
    """The passes of one option: a lane each, or the parts of it over ground that is wanted.

    They begin and end as the option does; what lies between may be flown in a shorter order.
    """
    angle_rad, eta = options.angles_rad[index : index + 1], float(options.etas[index])
    order = options.orders[index]
    order = order[order >= 0]
    lanes = lanes_at(survey, angle_rad, np.array([eta]), len(order))
    if EXACT_UP_TO < len(order) <= MOST_REORDERED:
        order = _reordered(region, lanes, order, around)
    photos_m = float(survey.frames(angle_rad).photos_m[0])
    least_gap_m = max(LEAST_PHOTOS * photos_m, around.settle_m + photos_m)
    if survey.wanted is survey.ground and is_convex(survey.ground):
        flown = [[lanes.lines[0, 0, number // STATES, number % STATES]] for number in order.tolist()]
    else:
        flown = photographed(survey, lanes, order, least_gap_m)
    return tuple(collect_along(region, survey, part, eta) for parts in flown for part in parts)


def collect_along(
    region: MergedRegion, survey: Survey, line: Floats, eta: float, *, goes_on: bool = False
) -> CollectPass:
    """A pass with photos from end to end of a line, (2, 2)."""
    start, end = ((float(east), float(north)) for east, north in line)
    camera, height_m = survey.camera, survey.height_m
    seen = seen_on_flat(camera, line, height_m)
    apart_m = camera.photo_spacing_m(height_m, math.atan2(end[1] - start[1], end[0] - start[0]))
    return CollectPass(region.names, camera.name, "down", start, end, eta, seen, apart_m, goes_on)


def is_convex(ground: Polygon) -> bool:
    """Whether no lane over it has a gap."""
    return not ground.interiors and ground.area >= (1.0 - 1e-9) * ground.convex_hull.area


def allowed(approach_rad: Sequence[float] | None, headings_rad: Floats) -> Flags:
    """Which headings may be flown."""
    if approach_rad is None:
        return np.ones(headings_rad.shape, dtype=np.bool_)
    given = np.asarray(approach_rad, dtype=np.float64)
    apart = np.abs(np.mod(headings_rad[..., None] - given + math.pi, math.tau) - math.pi)
    return np.asarray((apart <= SAME_RAD).any(axis=-1), dtype=np.bool_)


def _of_visit(region: MergedRegion, angles_rad: Floats, etas: Floats) -> tuple[Floats, Floats]:
    """Of headings and offsets, those meant for this visit.

    Each visit has its share of the half circle; where headings are given, its share of the offsets.
    """
    if region.visit is None:
        return angles_rad, etas
    k, count = region.visit
    if region.approach_rad is None:
        share_rad = math.pi / count
        away_rad = np.mod(angles_rad - first_visit_rad(region.area) - k * share_rad + math.pi / 2.0, math.pi)
        return angles_rad[np.abs(away_rad - math.pi / 2.0) <= SHARE_USED * share_rad / 2.0], etas
    last = 1.0 + 1e-9 if k == count - 1 else (k + 1) / count - 1e-9
    return angles_rad, etas[(etas >= k / count) & (etas < last)]


def _likely(survey: Survey, angles_rad: Floats, counts: Ints, radius_m: float, most: int) -> Ints:
    """Headings whose lanes and turns are the fewest metres, so many that no more lanes are laid."""
    cost_m = survey.ground.area / survey.frames(angles_rad).spacing_m + math.pi * radius_m * counts
    order = np.argsort(cost_m, kind="stable")
    laid = np.cumsum(counts[order])
    return np.sort(order[: max(int(np.searchsorted(laid, most, side="right")), FEWEST_WAYS)])


def _of_count(
    region: MergedRegion,
    survey: Survey,
    angles_rad: Floats,
    etas: Floats,
    count: int,
    around: Surroundings,
    between: Between | None,
) -> LaneOptions | None:
    lanes = lanes_at(survey, angles_rad, etas, count)
    shape = lanes.lines.shape[:4]
    cost_m, entries, exits, cramped_m = _judged(region, lanes, around)
    before_m, behind_m = np.zeros((2, cost_m.size))
    if between is not None:
        before_m = between.before_m(entries.reshape(-1, 3))
        behind_m = between.behind_m(exits.reshape(-1, 3))
    before_m, behind_m = before_m.reshape(shape), behind_m.reshape(shape)
    problems = (shape[0] * shape[1], count, STATES)
    spacing_m = float(survey.frames(angles_rad).spacing_m.min())
    strides = min(STRIDES, math.ceil(2.0 * around.radius_m / spacing_m) + 1)
    costs_m, orders = lane_orders(
        entries.reshape(*problems, 3),
        exits.reshape(*problems, 3),
        cost_m.reshape(problems),
        cramped_m.reshape(*problems, 2),
        before_m.reshape(problems),
        behind_m.reshape(problems),
        np.ones(STATES, dtype=np.bool_),
        np.arange(STATES) == 0,
        np.ones(VARIANTS, dtype=np.bool_),
        True,
        strides,
        around.radius_m,
        around.discs,
    )
    costs_m = costs_m.reshape(*shape[:2], VARIANTS)
    best_eta = np.argmin(costs_m, axis=1)
    cheapest_m = np.take_along_axis(costs_m, best_eta[:, None, :], axis=1)[:, 0]
    m, variant = np.nonzero(np.isfinite(cheapest_m))
    if len(m) == 0:
        return None
    k = best_eta[m, variant]
    order = orders.reshape(*shape[:2], VARIANTS, count)[m, k, variant]
    begin, end = np.divmod(order[:, 0], STATES), np.divmod(order[:, -1], STATES)
    room_m = np.maximum(cramped_m[m, k, *begin, 0], cramped_m[m, k, *end, 1])
    inner_m = cheapest_m[m, variant] - before_m[m, k, *begin] - behind_m[m, k, *end] + room_m
    return LaneOptions(angles_rad[m], etas[k], entries[m, k, *begin], exits[m, k, *end], inner_m, order)


def _reordered(region: MergedRegion, lanes: Lanes, order: Ints, around: Surroundings) -> Ints:
    """Lanes at one heading and offset in an order that is no longer, and begins and ends as the given one."""
    cost_m, entries, exits, cramped_m = _judged(region, lanes, around)
    own_m = cost_m.reshape(-1)
    ends = ends_of(entries.reshape(-1, 3), exits.reshape(-1, 3), cramped_m.reshape(-1, 2))
    turns_m = turns_between(ends, own_m, STATES, around.radius_m, around.discs)
    looks = min(PAIRS_LOOKED_AT // len(order) ** 2, MOST_LOOKS)
    return reordered(order, turns_m, own_m, looks)


def _judged(
    region: MergedRegion, lanes: Lanes, around: Surroundings
) -> tuple[Floats, Floats, Floats, Floats]:
    """Of lanes in each state cost (inf where not to be flown), entry, exit, and what want of room costs."""
    shape = lanes.lines.shape[:4]
    headings_rad = np.broadcast_to(lanes.headings_rad[:, None, None, :], shape).reshape(-1)
    lines = lanes.lines.reshape(-1, 2, 2)
    good, cost_m = judge_lines(lines[:, None], around)
    good_here = good[:, 0] & allowed(region.approach_rad, headings_rad)
    entries, exits = poses_of(lines, headings_rad, around.settle_m)
    cramped = ~np.stack([roomy(entries, around), roomy(exits, around)], axis=1)
    return (
        np.where(good_here, cost_m[:, 0], np.inf).reshape(shape),
        entries.reshape(*shape, 3),
        exits.reshape(*shape, 3),
        (NO_ROOM_M * cramped.astype(np.float64)).reshape(*shape, 2),
    )
