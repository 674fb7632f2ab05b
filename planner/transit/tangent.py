"""The shortest flyable line round zones: tangents and arcs.

Where a Dubins word is clear it is the answer. Otherwise the line follows the circles that hug the zones
(never tighter than the turn radius) and the turning circles at its ends, and changes between them along their
common tangents; the shortest such line is found by A* over the circles, each taken both ways round. Zones
come into the search only when a line found without them enters them, so it stays as small as the way demands.

This is the tangent graph of Y.-H. Liu and S. Arimoto, "Path planning using a tangent graph for mobile robots
among polygonal and curved obstacles", International Journal of Robotics Research 11 (1992), with the turning
circles of Dubins' words in the place of its end points.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from planner.airspace.zone_kernels import edge_distance, inside
from planner.airspace.zones import AREA, TOUCH_M, Conflict, Disc, KeepOut
from planner.dubins.path import Path, Segment, SegmentKind, join
from planner.dubins.words import candidates_between
from planner.errors import InfeasibleError
from planner.progress import Stop, never, raise_if
from planner.route import Anchor, Pose
from planner.transit.escape import Solve, shorten_crossings, turned
from planner.transit.tangent_kernels import search, turn_between
from planner.transit.wheels import End, between, end_of, obstacles_of

#: Searches kept: the same few zones are minded whatever becomes of the others.
KEPT_SEARCHES = 2048

#: A search that has followed so many circles from the start goes on from the goal instead.
FORWARD_WHEELS = 32

Array = NDArray[np.float64]


def connect(start: Anchor, goal: Anchor, keep_out: KeepOut, radius_m: float, stop: Stop = never) -> Path:
    """The shortest line found from one anchor to another that keeps clear of zones and in the area.

    Never longer than any Dubins word that is clear. Soft zones are kept clear as far as possible:

    - one that holds the start or the goal cannot be, and is left out; from a disc the line then takes a short
      way out where that saves more inside than it costs outside (``escape.INSIDE_WEIGHT``);
    - where no line keeps clear of all the others, they are given up one at a time, each time the one entered
      least deeply by the line found so far, beginning with the line that minds hard zones only. What was
      given up in vain is taken up again in the end.

    Parameters
    ----------
    start, goal
        A place each, and a direction unless it is free.
    keep_out
        Zones and area, margins included. Lines may touch them.
    radius_m
        Smallest turn radius, > 0.
    stop
        Asked between searches.

    Raises
    ------
    InfeasibleError
        ``"hard-zone"`` or ``"area"``: an end lies inside a hard zone or outside the area, or no line was
        found that keeps clear of them; names the zone and the place.
    CancelledError
        ``stop`` said so.
    """
    if not (radius_m > 0.0 and math.isfinite(radius_m)):
        raise ValueError(f"the turn radius must be positive and finite, not {radius_m}")
    for end in (start, goal):
        if not all(map(math.isfinite, (end.east_m, end.north_m, end.angle_rad or 0.0))):
            raise ValueError(f"an end of a transit must be finite, not {end}")
    zones, held = _without_held_ends(start, goal, keep_out)

    def solve(a: Anchor, b: Anchor, kept: KeepOut) -> Path | None:
        return _solve(a, b, kept, radius_m, stop)

    path, given_up = _clear_as_can_be(start, goal, zones, radius_m, solve)
    return shorten_crossings(path, start, goal, held, zones.without(given_up), radius_m, solve)


def _clear_as_can_be(
    start: Anchor, goal: Anchor, zones: KeepOut, radius_m: float, solve: Solve
) -> tuple[Path, list[str]]:
    """The shortest line, and the soft zones given up for it."""
    path = solve(start, goal, zones)
    if path is not None:
        return path, []
    soft = {name for name, hard in _named(zones) if not hard}
    path = solve(start, goal, zones.without(soft)) if soft else None
    if path is None:
        raise _infeasible(start, goal, zones.without(soft), radius_m)
    given_up: list[str] = []
    while True:
        conflicts = zones.without(given_up).conflicts(path)
        if not conflicts:
            break
        given_up.append(min(conflicts, key=lambda conflict: (conflict.depth_m, conflict.zone)).zone)
        path = solve(start, goal, zones.without(given_up)) or path
    for name in tuple(given_up):
        fewer = [other for other in given_up if other != name]
        better = solve(start, goal, zones.without(fewer))
        if better is not None:
            given_up, path = fewer, better
    return path, given_up


def _solve(start: Anchor, goal: Anchor, zones: KeepOut, radius_m: float, stop: Stop) -> Path | None:
    """The shortest line found that is clear of all zones; None where none was found."""
    words = candidates_between(start, goal, radius_m)
    if zones.clear(words[0]):
        return words[0]
    found = [word for word in words[1:] if zones.clear(word)][:1]
    most_m = found[0].length_m if found else math.inf
    every = {name for name, _ in _named(zones)}
    minded = {conflict.zone for conflict in zones.conflicts(words[0])} - {AREA}
    while True:
        raise_if(stop)
        path = _search(start, goal, zones.without(every - minded), radius_m, most_m)
        entered = {conflict.zone for conflict in zones.conflicts(path)} if path else set()
        if not entered - minded:
            break
        minded |= entered
    if path is not None and not entered:
        found.append(path)
    return min(found, key=lambda path: path.length_m, default=None)


@lru_cache(maxsize=KEPT_SEARCHES)
def _search(start: Anchor, goal: Anchor, zones: KeepOut, radius_m: float, most_m: float) -> Path | None:
    """The shortest line over the circles of these zones; None where none is shorter than ``most_m``."""
    obstacles = obstacles_of(zones, radius_m)
    first = end_of(start, radius_m, zones, goal=False)
    last = end_of(goal, radius_m, zones, goal=True)
    both_ways = np.concatenate([obstacles.circles, obstacles.circles * [1.0, 1.0, -1.0]])
    middles = [
        between(first.turns, np.concatenate([last.turns, both_ways]), radius_m),
        between(last.turns, both_ways, radius_m),
    ]
    wheels = np.concatenate([first.wheels, last.wheels, both_ways, *middles])
    begins, ends = _entry_rows(first, 0), _entry_rows(last, len(first.wheels))
    zone_rows = obstacles.discs, obstacles.edges
    length_m, visits = search(wheels, begins, ends, _row(goal), radius_m, *zone_rows, most_m, FORWARD_WHEELS)
    if math.isnan(length_m):
        # Backwards it shows sooner where the goal cannot be reached: few wheels lead out of its place then.
        length_m, visits = search(
            wheels * [1.0, 1.0, -1.0], _turned_rows(ends), _turned_rows(begins), _row(turned(start)),
            radius_m, *zone_rows, most_m, len(wheels),
        )  # fmt: skip
        visits = _flown_back(visits)
    if len(visits) == 0:
        return None
    lead_in, lead_out = first.entries[int(visits[0, 0])][2], last.entries[int(visits[0, 1])][2]
    return join(
        *(Path((lead,)) for lead in (lead_in,) if lead is not None),
        _path(wheels, visits[1:], start, goal),
        *(Path((lead,)) for lead in (lead_out,) if lead is not None),
    )


def forget_searches() -> None:
    """Search anew from here on; for those who measure how long a search takes."""
    _search.cache_clear()


def _named(zones: KeepOut) -> list[tuple[str, bool]]:
    """Names of the zones, and whether they are hard."""
    return [*((d.name, d.hard) for d in zones.discs), *((z.name, z.hard) for z in zones.polygons)]


def _entry_rows(end: End, first_wheel: int) -> Array:
    rows = [
        (wheel + first_wheel, angle, lead.length_m if lead else 0.0) for wheel, angle, lead in end.entries
    ]
    return np.array(rows, dtype=np.float64)


def _row(end: Anchor) -> Array:
    """Place and direction, NaN where that is free."""
    return np.array([*end.position, math.nan if end.angle_rad is None else end.angle_rad])


def _turned_rows(entries: Array) -> Array:
    """Entries passed the other way."""
    return np.asarray(entries + np.array([0.0, math.pi, 0.0]))


def _flown_back(visits: Array) -> Array:
    """What ``search`` found backwards, as if found forwards."""
    if len(visits) == 0:
        return visits
    way = visits[:0:-1, [0, 2, 1]] - np.array([0.0, math.pi, math.pi])
    return np.concatenate([visits[:1, [1, 0, 2]], way])


def _path(wheels: Array, visits: Array, start: Anchor, goal: Anchor) -> Path:
    """Arcs on the wheels visited and straights between them."""
    segments: list[Segment] = []
    for row, (wheel, arriving, leaving) in enumerate(visits):
        east_m, north_m, signed_m = (float(value) for value in wheels[int(wheel)])

        def pose(angle_rad: float, e: float = east_m, n: float = north_m, s: float = signed_m) -> Pose:
            return Pose(e + s * math.sin(angle_rad), n - s * math.cos(angle_rad), angle_rad)

        turn = float(turn_between(signed_m, arriving, leaving))
        if turn > 0.0:
            kind: SegmentKind = "left" if signed_m > 0.0 else "right"
            segments.append(Segment(kind, pose(float(arriving)), turn * abs(signed_m), abs(signed_m)))
        if row + 1 < len(visits):
            begin = pose(float(leaving))
            east_m, north_m, signed_m = (float(value) for value in wheels[int(visits[row + 1, 0])])
            end = Pose(
                east_m + signed_m * math.sin(leaving), north_m - signed_m * math.cos(leaving), float(leaving)
            )
            segments.append(Segment("straight", begin, math.dist(begin.position, end.position)))
    if not segments:
        angle_rad = start.angle_rad if start.angle_rad is not None else goal.angle_rad or 0.0
        segments.append(Segment("straight", Pose(start.east_m, start.north_m, angle_rad), 0.0))
    return Path(tuple(segments))


def _without_held_ends(start: Anchor, goal: Anchor, zones: KeepOut) -> tuple[KeepOut, list[Disc]]:
    """The zones without the soft ones that hold an end, and the discs among those.

    Discs that an end touches are shrunk to pass through it.
    Raises InfeasibleError where a hard zone holds an end or the area does not.
    """
    left_out: set[str] = set()
    for end, which in ((start, "start"), (goal, "end")):
        for zone, depth_m, hard in _holding(end, zones):
            if hard:
                raise InfeasibleError(
                    AREA if zone == AREA else "hard-zone",
                    zone,
                    f"the {which} of a transit lies {depth_m:.1f} m "
                    + ("outside the area" if zone == AREA else "inside the zone"),
                    f"Move it at least {depth_m:.1f} m, or change the zone or its margin.",
                    end.position,
                )
            left_out.add(zone)
    held = [disc for disc in zones.discs if disc.name in left_out]
    zones = zones.without(left_out)
    discs = tuple(
        Disc(
            d.name, d.east_m, d.north_m, min(d.radius_m, *(_from_disc_m(e, d) for e in (start, goal))), d.hard
        )
        for d in zones.discs
    )
    return (zones if discs == zones.discs else replace(zones, discs=discs)), held


def _from_disc_m(end: Anchor, disc: Disc) -> float:
    return math.hypot(end.east_m - disc.east_m, end.north_m - disc.north_m)


def _holding(end: Anchor, zones: KeepOut) -> list[tuple[str, float, bool]]:
    """Zones that hold an end deeper than by a touch: name, depth in metres, hard."""
    held = [(d.name, d.radius_m - _from_disc_m(end, d), d.hard) for d in zones.discs]
    edges, offsets = zones.edge_arrays()
    for zone, first, last in zip(zones.polygons, offsets[:-1], offsets[1:], strict=True):
        if inside(edges, first, last, end.east_m, end.north_m):
            held.append((zone.name, edge_distance(edges, first, last, end.east_m, end.north_m), zone.hard))
    area = zones.area_edges()
    if zones.area is not None and not inside(area, 0, len(area), end.east_m, end.north_m):
        held.append((AREA, edge_distance(area, 0, len(area), end.east_m, end.north_m), True))
    return [(name, depth_m, hard) for name, depth_m, hard in held if depth_m > 0.5 * TOUCH_M]


def _infeasible(start: Anchor, goal: Anchor, zones: KeepOut, radius_m: float) -> InfeasibleError:
    """Why there is no line: the zone that corners an end, else the worst conflict of the Dubins word."""
    for end, which, turned_rad in ((start, "start", 0.0), (goal, "end", math.pi)):
        if end.angle_rad is None:
            continue
        pose = Pose(end.east_m, end.north_m, end.angle_rad + turned_rad)
        quarter_m = 0.5 * math.pi * radius_m
        ahead = Segment("straight", pose, radius_m)
        turns = (Segment("left", pose, quarter_m, radius_m), Segment("right", pose, quarter_m, radius_m))
        conflicts = [zones.conflict(Path((segment,))) for segment in (ahead, *turns)]
        if conflicts[0] is not None and all(conflicts):
            return _refusal(
                conflicts[0], f"the {which} of a transit is too close to it to turn with {radius_m:.1f} m"
            )
    conflict = zones.conflict(candidates_between(start, goal, radius_m)[0])
    assert conflict is not None, "a clear word is a line"
    return _refusal(
        conflict,
        f"no line with turns of {radius_m:.1f} m was found from ({start.east_m:.0f}, {start.north_m:.0f}) to "
        f"({goal.east_m:.0f}, {goal.north_m:.0f}) m that keeps clear of it and of its neighbours",
    )


def _refusal(conflict: Conflict, message: str) -> InfeasibleError:
    return InfeasibleError(
        AREA if conflict.zone == AREA else "hard-zone",
        conflict.zone,
        message,
        "Move the ends or the zone, or use a smaller margin or turn radius.",
        conflict.where,
    )
