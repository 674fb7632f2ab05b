"""The ways to see one region strip by strip, as arrays: what is chosen among."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.lanes_kernels import VARIANTS
from planner.coverage.lines import NO_ROOM_M, cramped_m, judge_lines, poses_of, roomy
from planner.coverage.merge import GRID_M
from planner.coverage.strips.alternatives import of_visit
from planner.coverage.strips.classify import Spans, fits, hull_points, spans_at
from planner.coverage.strips.neighbourhood import complementary
from planner.coverage.strips.segments import Neighbourhood
from planner.coverage.strips.sweeps import Judge, Side, Sweep, Swept, best_sweeps, sweep_passes
from planner.coverage.ways import Between
from planner.dubins.kernels import dubins_lengths
from planner.route import CollectPass, Look
from planner.sensors.strip import swaths_m
from planner.sensors.view import shadow_cost

Floats = NDArray[np.float64]

#: Places of a region looked at for what terrain hides, in each strip and in all.
PLACES, MOST_PLACES = 60, 400


@dataclass(frozen=True, slots=True)
class Options:
    """Ways to see one region.

    Parameters
    ----------
    side
        Index into the region's sides, int64 (K,): neighbourhoods, one a look side, and sweeps, one a variant.
    angles_rad, eta_first, eta_second
        Of each option; η of the second pass is NaN where there is only one, and for sweeps, which share one
        η among their lanes. Side, angle and these tell any two options of a region apart. float64 (K,).
    entries, exits
        Poses before the first (settling included) and after the last pass, (K, 3).
    inner_m
        Cost from entry to exit: passes, the turns between them, metres inside threats.
    lanes
        The order of a sweep's lanes (see ``Swept.order``), −1 for other options and after the last lane;
        int64 (K, L).
    """

    side: NDArray[np.int64]
    angles_rad: Floats
    eta_first: Floats
    eta_second: Floats
    entries: Floats
    exits: Floats
    inner_m: Floats
    lanes: NDArray[np.int64]

    def rows(self, kept: NDArray[np.int64]) -> Options:
        """Some of them."""
        return Options(*(getattr(self, name)[kept] for name in Options.__slots__))


def make_options(
    sides: Sequence[Side],
    angles_rad: Floats,
    etas: Floats,
    around: Surroundings,
    between: Between | None = None,
) -> Options | None:
    """Options at the given angles and offsets that keep the hard constraints; None where there are none.

    Parameters
    ----------
    between
        What the orders of lanes are chosen for; for themselves where that is not known.
    """
    found = []
    angles_rad, etas = of_visit(sides[0].region, angles_rad, etas)
    if len(angles_rad) == 0 or len(etas) == 0:
        return None
    for index, side in enumerate(sides):
        if isinstance(side, Neighbourhood):
            part = _of_side(index, side, angles_rad, etas, around)
            if part is not None:
                found.append(part)
    found += _of_sweeps(sides, angles_rad, etas, around, between)
    if not found:
        return None
    width = max(part.lanes.shape[1] for part in found)
    found = [
        replace(
            part, lanes=np.pad(part.lanes, ((0, 0), (0, width - part.lanes.shape[1])), constant_values=-1)
        )
        for part in found
    ]
    return Options(*(np.concatenate([getattr(part, name) for part in found]) for name in Options.__slots__))


def collect_passes(sides: Sequence[Side], options: Options, index: int) -> tuple[CollectPass, ...]:
    """The passes of one option."""
    chosen = sides[int(options.side[index])]
    if isinstance(chosen, Sweep):
        angle_rad, eta = float(options.angles_rad[index]), float(options.eta_first[index])
        return sweep_passes(chosen, angle_rad, eta, options.lanes[index])
    side = _at(chosen, options.angles_rad[index : index + 1])
    first = side.collect(0, float(options.eta_first[index]))
    if side.turns == 0:
        return (first,)
    return (first, side.collect(0, float(options.eta_second[index]), opposite=True))


def _at(side: Neighbourhood, angles_rad: Floats) -> Neighbourhood:
    """The same neighbourhood at other angles: those of them that see the region."""
    spans = spans_at(hull_points(side.region.area), angles_rad)
    good = fits(spans.across_m, swaths_m(side.sensor, side.height_m, angles_rad), side.turns)
    kept = Spans(*(getattr(spans, name)[good] for name in Spans.__slots__))
    return Neighbourhood(
        side.region, side.sensor, side.height_m, side.look, side.turns, angles_rad[good], kept
    )


def _of_side(
    index: int, side: Neighbourhood, angles_rad: Floats, etas: Floats, around: Surroundings
) -> Options | None:
    here = _at(side, angles_rad)
    if len(here.angles_rad) == 0:
        return None
    first = here.lines(etas)
    good_first, cost_first = judge_lines(first, around)
    cost_first += _hidden_m(here, here.look, first, around)
    if side.turns == 0:
        rows = np.argwhere(good_first)
        if len(rows) == 0:
            return None
        m, k = rows.T
        line = first[m, k]
        entries, exits = poses_of(line, here.angles_rad[m], around.settle_m)
        return _finish(
            index, here, m, etas[k], np.full(len(m), np.nan), entries, exits, cost_first[m, k], around
        )
    second = here.lines(etas, opposite=True)
    good_second, cost_second = judge_lines(second, around)
    cost_second += _hidden_m(here, here.look, second, around)
    both = good_first[:, :, None] & good_second[:, None, :] & complementary(etas)
    rows = np.argwhere(both)
    if len(rows) == 0:
        return None
    m, k, n = rows.T
    entries, between0 = poses_of(first[m, k], here.angles_rad[m], around.settle_m)
    between1, exits = poses_of(second[m, n], here.angles_rad[m] + math.pi, around.settle_m)
    turn_m = dubins_lengths(between0, between1, around.radius_m)
    inner_m = cost_first[m, k] + cost_second[m, n] + turn_m + cramped_m(between0, between1, around)
    return _finish(index, here, m, etas[k], etas[n], entries, exits, inner_m, around)


def _finish(
    index: int,
    here: Neighbourhood,
    m: NDArray[np.int64],
    eta_first: Floats,
    eta_second: Floats,
    entries: Floats,
    exits: Floats,
    inner_m: Floats,
    around: Surroundings,
) -> Options:
    side = np.full(len(m), index, dtype=np.int64)
    cost_m = inner_m + cramped_m(entries, exits, around)
    none = np.empty((len(m), 0), dtype=np.int64)
    return Options(side, here.angles_rad[m], eta_first, eta_second, entries, exits, cost_m, none)


def _of_sweeps(
    sides: Sequence[Side],
    angles_rad: Floats,
    etas: Floats,
    around: Surroundings,
    between: Between | None,
) -> list[Options]:
    """Options of all sweeps among the sides; those that differ in their variant alone are solved together."""
    families: dict[int, list[tuple[int, Sweep]]] = {}
    for index, side in enumerate(sides):
        if isinstance(side, Sweep):
            families.setdefault(side.extra, []).append((index, side))
    found = []
    for family in families.values():
        judge = _lane_judge(family[0][1], around)
        variants = [side.variant for _, side in family]
        how = (judge, around.radius_m, around.discs, between, variants)
        best = best_sweeps(family[0][1], angles_rad, etas, *how)
        number = np.full(VARIANTS, -1, dtype=np.int64)
        for index, side in family:
            number[side.variant] = index
        cost_m = best.inner_m + best.cramped_m.max(axis=1, initial=0.0)
        kept = _worth(best, np.where(number[best.variant] >= 0, cost_m, np.inf), around.radius_m)
        if not kept.any():
            continue
        found.append(
            Options(
                number[best.variant[kept]],
                angles_rad[best.angle_index[kept]],
                etas[best.eta_index[kept]],
                np.full(int(kept.sum()), np.nan),
                best.entries[kept],
                best.exits[kept],
                cost_m[kept],
                best.order[kept],
            )
        )
    return found


def _worth(best: Swept, cost_m: Floats, radius_m: float) -> NDArray[np.bool_]:
    """Which sweeps can be part of the best tour: flying to the cheapest one's ends instead is not shorter.

    From one pose to another it is at most the distance and two full turns.
    """
    if len(cost_m) == 0:
        return np.zeros(0, dtype=np.bool_)
    least = int(np.argmin(cost_m))
    away_m = sum(
        np.hypot(*(poses[:, :2] - poses[least, :2]).T) + 4.0 * math.pi * radius_m
        for poses in (best.entries, best.exits)
    )
    return np.asarray(np.isfinite(cost_m) & (cost_m <= cost_m[least] + away_m), dtype=np.bool_)


def _lane_judge(sweep: Sweep, around: Surroundings) -> Judge:
    """What lanes of a sweep cost among these surroundings."""

    def judge(
        lines: Floats, headings_rad: Floats, looks: tuple[Look, ...]
    ) -> tuple[Floats, Floats, Floats, Floats]:
        good, cost_m = judge_lines(lines[:, None], around)
        cost_m = np.where(good, cost_m, np.inf)[:, 0]
        for state, look in enumerate(looks):
            rows = np.arange(state, len(lines), len(looks))
            rows = rows[np.isfinite(cost_m[rows])]
            cost_m[rows] += _hidden_m(sweep, look, lines[rows], around)
        entries, exits = poses_of(lines, headings_rad, around.settle_m)
        cramped = ~np.stack([roomy(entries, around), roomy(exits, around)], axis=1)
        return cost_m, entries, exits, NO_ROOM_M * cramped.astype(np.float64)

    return judge


def _hidden_m(side: Side, look: Look, lines: Floats, around: Surroundings) -> Floats | float:
    """What the lines cost for ground of the region that terrain hides from them.

    Each line answers for what lies in its own beam alone, so that lanes add up.
    """
    if around.ground is None or len(lines) == 0:
        return 0.0
    swath_m = side.sensor.swath_m(side.height_m)
    # As many places to a strip as a region seen at once has.
    strips = math.ceil(math.sqrt(side.region.area.area) / swath_m)
    places = min(PLACES * max(strips, 1), MOST_PLACES)
    wanted = shapely.union_all(side.region.originals, grid_size=GRID_M)
    return shadow_cost(lines, look, side.sensor, around.level_m, wanted, around.ground, places)


def hidden_m(side: Side, passes: Sequence[CollectPass], around: Surroundings) -> float:
    """What passes of one option cost for ground of the region that terrain hides from them, as in options."""
    if around.ground is None:
        return 0.0
    return math.fsum(
        float(np.sum(_hidden_m(side, collect.look, np.array([[collect.start, collect.end]]), around)))
        for collect in passes
    )
