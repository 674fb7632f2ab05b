"""Several flights on one clock: windows, visits apart, batteries, and how near aircraft come to each other.

Times are the judge's own: those of each edge of the line as its aircraft flies it, of what hovers between the
times that the plan says of phases and collects; what wings say of a collect is held against their line.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.check.coverage import TIME_TOLERANCE_S
from planner.check.times import edges_s, speeds_told
from planner.plan import FlownPath, LonLat, Plan, Violation
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft
from planner.wishes import Separation

Floats = NDArray[np.float64]

#: A collect's own time, and its line's, may differ by this and by this part of the flight up to it.
LINE_TOLERANCE_S, LINE_TOLERANCE = 1.0, 2e-3
#: Nearer than this under what is to be kept is rounding.
NEAR_TOLERANCE_M = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """Where one flight is when: rows of seconds on the plan's clock, east_m, north_m, altitude_m."""

    vehicle: str
    sortie: int
    rows: Floats


def fleet_violations(scenario: Scenario, plan: Plan, separation: Separation | None) -> Iterator[Violation]:
    """What is wrong with flights on one clock; nothing where there is but one that begins with it."""
    if not plan.is_fleet:
        return
    traces = [trace_of(scenario, plan, path) for path in plan.paths]
    yield from _times(scenario, plan, traces)
    yield from _batteries(scenario, plan)
    if separation is not None:
        for one, other in itertools.combinations(traces, 2):
            yield from _near(scenario, one, other, separation)


def window_violations(scenario: Scenario, plan: Plan) -> Iterator[Violation]:
    """Collects of a region outside its window."""
    windows = {r.name: r.time_window_s for r in scenario.regions if r.time_window_s is not None}
    for collect in plan.collects:
        for name in collect.regions:
            if name not in windows:
                continue
            first_s, last_s = windows[name]
            off_s = max(first_s - collect.start_s, collect.end_s - last_s)
            if off_s > TIME_TOLERANCE_S:
                yield Violation(
                    "window",
                    name,
                    f"collect {collect.seq} of {collect.vehicle} is flown from {collect.start_s:.1f} s to "
                    f"{collect.end_s:.1f} s, its window is open from {first_s:g} s to {last_s:g} s",
                    off_s,
                    "s",
                    collect.line[0][:2],
                )


def trace_of(scenario: Scenario, plan: Plan, path: FlownPath) -> Trace:
    """One flight on the plan's clock."""
    aircraft = next(a for a in scenario.aircraft if a.name == path.vehicle)
    line_m = scenario.frame.to_local([place[:2] for place in path.line])
    altitudes_m = np.array([place[2] for place in path.line])
    over_m = np.hypot(*np.diff(line_m, axis=0).T)
    reached_m = np.concatenate([[0.0], np.cumsum(np.hypot(over_m, np.diff(altitudes_m)))])
    datum_amsl_m = scenario.level.amsl_m - scenario.level.altitude_m
    told_m_s = speeds_told(plan.collects, path, line_m, altitudes_m)
    flown_by = aircraft.in_wind(scenario.wind.speed_m_s)
    edges = edges_s(line_m, altitudes_m, flown_by, scenario.wind, datum_amsl_m, told_m_s)
    own_s = np.concatenate([[0.0], np.cumsum(edges)])
    own_s *= path.duration_s / max(float(own_s[-1]), 1e-9)
    times_s = path.start_s + own_s
    if aircraft.hovers:
        times_s = _by_what_is_said(plan, path, reached_m, own_s)
    return Trace(path.vehicle, path.sortie, np.column_stack([times_s, line_m, altitudes_m]))


def _by_what_is_said(plan: Plan, path: FlownPath, reached_m: Floats, own_s: Floats) -> Floats:
    """What hovers is where the plan says at the ends of phases and collects, and goes on evenly between."""
    said = {(phase.start_m, phase.start_s) for phase in path.phases}
    said |= {(phase.end_m, phase.end_s) for phase in path.phases}
    for collect in plan.collects:
        if (collect.vehicle, collect.sortie) == (path.vehicle, path.sortie):
            said |= {(collect.start_m, collect.start_s), (collect.end_m, collect.end_s)}
    marks = np.array(sorted(said))
    scale = reached_m[-1] / max(path.length_m, 1e-9)
    own_at = np.interp(marks[:, 0] * scale, reached_m, own_s)
    apart = np.concatenate([[True], np.diff(own_at) > 1e-6])
    return np.asarray(np.interp(own_s, own_at[apart], np.maximum.accumulate(marks[apart, 1])))


def _times(scenario: Scenario, plan: Plan, traces: list[Trace]) -> Iterator[Violation]:
    """Wings reach each collect when the plan says."""
    for trace, path in zip(traces, plan.paths, strict=True):
        if next(a for a in scenario.aircraft if a.name == path.vehicle).hovers:
            continue
        steps = np.diff(trace.rows[:, 1:], axis=0)
        reached_m = np.concatenate([[0.0], np.cumsum(np.sqrt((steps**2).sum(axis=1)))])
        scale = reached_m[-1] / max(path.length_m, 1e-9)
        for collect in plan.collects:
            if (collect.vehicle, collect.sortie) != (path.vehicle, path.sortie):
                continue
            for at_m, said_s in ((collect.start_m, collect.start_s), (collect.end_m, collect.end_s)):
                time_s = float(np.interp(at_m * scale, reached_m, trace.rows[:, 0]))
                off_s = abs(time_s - said_s)
                if off_s > LINE_TOLERANCE_S + LINE_TOLERANCE * path.duration_s:
                    yield Violation(
                        "time",
                        collect.roi,
                        f"collect {collect.seq} of {collect.vehicle} says {said_s:.1f} s, its line is there "
                        f"at {time_s:.1f} s",
                        off_s,
                        "s",
                        collect.line[0][:2],
                    )


def _batteries(scenario: Scenario, plan: Plan) -> Iterator[Violation]:
    """No more flights than batteries, each begun a turnaround after the one before has ended."""
    for aircraft in scenario.aircraft:
        paths = sorted((p for p in plan.paths if p.vehicle == aircraft.name), key=lambda p: p.start_s)
        if len(paths) > aircraft.batteries and not _on_one_battery(aircraft, paths):
            more = len(paths) - aircraft.batteries
            yield Violation(
                "batteries",
                aircraft.name,
                f"makes {len(paths)} flights with {aircraft.batteries} batteries",
                float(more),
                "",
            )
        if aircraft.aloft is not None and paths and paths[0].start_s > TIME_TOLERANCE_S:
            yield Violation(
                "take-off",
                aircraft.name,
                f"flies already, and is to begin {paths[0].start_s:.1f} s later",
                paths[0].start_s,
                "s",
            )
        for one, other in itertools.pairwise(paths):
            short_s = one.end_s + aircraft.turnaround_s - other.start_s
            if short_s > TIME_TOLERANCE_S:
                yield Violation(
                    "turnaround",
                    aircraft.name,
                    f"sortie {other.sortie} begins {short_s:.1f} s too soon behind sortie {one.sortie}",
                    short_s,
                    "s",
                )


def _on_one_battery(aircraft: Aircraft, paths: Sequence[FlownPath]) -> bool:
    """Whether one battery is enough for flights together, one after the other and none begun in the air."""
    if aircraft.batteries > 1 or aircraft.aloft is not None:
        return False
    if any(one.end_s > other.start_s + TIME_TOLERANCE_S for one, other in itertools.pairwise(paths)):
        return False
    used = (
        (math.fsum(path.length_m for path in paths), aircraft.max_range_m),
        (math.fsum(path.duration_s for path in paths), aircraft.max_flight_time_s),
        (math.fsum(path.energy_wh or math.inf for path in paths), aircraft.usable_wh),
    )
    return all(most is None or total <= most for total, most in used)


def _near(scenario: Scenario, one: Trace, other: Trace, kept: Separation) -> Iterator[Violation]:
    """The nearest that two flights come to each other, where it is nearer than is kept."""
    found = nearest(one.rows, other.rows, kept)
    if found is None:
        return
    short_m, at_s, place = found
    if short_m <= NEAR_TOLERANCE_M:
        return
    lon, lat = (float(value) for value in scenario.frame.to_wgs84(np.array([place]))[0])
    where: LonLat = (lon, lat)
    yield Violation(
        "separation",
        f"{one.vehicle}, {other.vehicle}",
        f"come within {kept.horizontal_m - short_m:.1f} m of each other {at_s:.0f} s after the start, and "
        f"within {kept.vertical_m:g} m in height; {kept.horizontal_m:g} m are kept",
        short_m,
        "m",
        where,
    )


def nearest(one: Floats, other: Floats, kept: Separation) -> tuple[float, float, tuple[float, float]] | None:
    """By how much two flights come too near at worst, when, and where; None where they never do.

    Between the vertices of both the one moves straight against the other: where it is nearer than either
    distance is an interval of time, found exactly, and so what both have in common.
    """
    first_s, last_s = max(one[0, 0], other[0, 0]), min(one[-1, 0], other[-1, 0])
    if not first_s < last_s:
        return None
    times = np.union1d(one[:, 0], other[:, 0])
    times = np.unique(np.concatenate([[first_s], times[(times > first_s) & (times < last_s)], [last_s]]))
    here = np.column_stack([np.interp(times, one[:, 0], one[:, k]) for k in (1, 2, 3)])
    there = np.column_stack([np.interp(times, other[:, 0], other[:, k]) for k in (1, 2, 3)])
    apart = here - there
    begin, move = apart[:-1], np.diff(apart, axis=0)
    low, high = _beside(begin, move, kept.horizontal_m)
    under, over = _over(begin[:, 2], move[:, 2], kept.vertical_m)
    low, high = np.maximum(low, under), np.minimum(high, over)
    hits = np.flatnonzero(low < high)
    if not len(hits):
        return None
    speed2 = (move[hits, :2] ** 2).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        best = np.where(speed2 > 0.0, -(begin[hits, :2] * move[hits, :2]).sum(axis=1) / speed2, 0.0)
    part = np.clip(best, low[hits], high[hits])
    places = begin[hits, :2] + part[:, None] * move[hits, :2]
    distances = np.hypot(*places.T)
    worst = int(np.argmin(distances))
    k = hits[worst]
    at_s = float(times[k] + part[worst] * (times[k + 1] - times[k]))
    place = (
        float(np.interp(at_s, one[:, 0], one[:, 1])),
        float(np.interp(at_s, one[:, 0], one[:, 2])),
    )
    return kept.horizontal_m - float(distances[worst]), at_s, place


def _beside(begin: Floats, move: Floats, kept_m: float) -> tuple[Floats, Floats]:
    """Between which parts of each interval the horizontal distance is less; empty where nowhere."""
    a = (move[:, :2] ** 2).sum(axis=1)
    b = 2.0 * (begin[:, :2] * move[:, :2]).sum(axis=1)
    c = (begin[:, :2] ** 2).sum(axis=1) - kept_m**2
    root = np.sqrt(np.maximum(b**2 - 4.0 * a * c, 0.0))
    still = a <= 1e-18
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = (-b - root) / (2.0 * a), (-b + root) / (2.0 * a)
    none = np.where(still, c >= 0.0, b**2 - 4.0 * a * c <= 0.0)
    low, high = np.where(still, 0.0, low), np.where(still, 1.0, high)
    return np.where(none, 1.0, np.clip(low, 0.0, 1.0)), np.where(none, 0.0, np.clip(high, 0.0, 1.0))


def _over(begin: Floats, move: Floats, kept_m: float) -> tuple[Floats, Floats]:
    """The same for heights."""
    still = np.abs(move) <= 1e-12
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.sort(np.stack([(-kept_m - begin) / move, (kept_m - begin) / move]), axis=0)
    low, high = np.where(still, 0.0, ends[0]), np.where(still, 1.0, ends[1])
    none = (still & (np.abs(begin) >= kept_m)) | (low >= 1.0) | (high <= 0.0)
    if math.isinf(kept_m):
        none, low, high = np.zeros_like(none), np.zeros_like(low), np.ones_like(high)
    return np.where(none, 1.0, np.clip(low, 0.0, 1.0)), np.where(none, 0.0, np.clip(high, 0.0, 1.0))
