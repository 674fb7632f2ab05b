"""The places a mission names along a flown path, and what is switched there."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from mavlink.wire.geometry import LocalMap, arc_points, chord_step_rad, here, offset
from planner.plan import Collect, FlownPath, LonLat, PathSegment

#: Places nearer than this along the path are one; those of a collect win.
MERGE_M = 0.5
#: From so much on an arc is whole turns; rounding may have taken a little.
WHOLE_TURN_DEG = 359.9
#: From so many radii on PX4 takes a place for one outside a circle, and a little more.
_OUTSIDE = 1.06
#: No arc is cut into chords of more than this, however large the chord error allowed.
LARGEST_STEP_RAD = math.radians(45.0)
#: A corner turns by no more than this, a right angle and a little; what turns farther is several.
MOST_CORNER_DEG = 91.0


@dataclass(frozen=True, slots=True)
class Stop:
    """A place of the path that becomes a waypoint.

    Parameters
    ----------
    along_m
        Distance along the path.
    off, on
        How many collects end and begin here.
    arc
        The arc that is flown to here round its centre, without waypoints of its own.
    turns
        Whole turns that are flown from here, and left here.
    """

    along_m: float
    place: LonLat
    altitude_m: float
    off: int = 0
    on: int = 0
    arc: PathSegment | None = None
    turns: PathSegment | None = None


def stops_along(
    path: FlownPath,
    collects: Sequence[Collect],
    local: LocalMap,
    chord_error_m: float,
    off_delay_m: float = 0.0,
    may_overshoot: Callable[[LonLat], bool] | None = None,
    flown_round: Callable[[PathSegment], bool] = lambda _: False,
    between_m: tuple[float, float] = (0.0, math.inf),
    near_m: float = 0.0,
    on_delay_m: Callable[[Collect], float] = lambda _: 0.0,
    corner_m: float = 0.0,
) -> tuple[Stop, ...]:
    """Ends of the straights, points on the arcs, and exactly both ends of each collect, in flight order.

    Parameters
    ----------
    between_m
        The part of the path whose places are named; its beginning has no stop.
    chord_error_m
        Largest distance between an arc and the line through its points (the sagitta of each chord).
    off_delay_m
        How far past a collect's end the sensor is switched off, as far as the straight goes on.
    may_overshoot
        For aircraft that turn this far before a waypoint: whether one may lie at a place off the path. Then a
        collect whose straight ends too early has its last waypoint beyond, in the line's direction: the
        aircraft begins its turn where the path does, and the sensor stays on until there.
    flown_round
        Which arcs are flown round their centres.
    near_m
        Places where nothing happens are left out so near to others: what hovers would stop there.
    on_delay_m
        How far past a collect's beginning its sensor is switched on, at most to its middle.
    corner_m
        Arcs of this radius and less are corners: the lines beside them meet in one place.
    """
    altitude = partial(altitude_along, path)
    stops: list[Stop] = []
    skipped: list[tuple[float, float]] = []
    for collect in collects:
        start, end_place = (here(place[:2]) for place in collect.line)
        delay_m = min(on_delay_m(collect), (collect.end_m - collect.start_m) / 2.0)
        if delay_m > 0.0:
            start = _beyond(collect, local, delay_m - (collect.end_m - collect.start_m))
        stops.append(Stop(collect.start_m + delay_m, start, altitude(collect.start_m + delay_m), on=1))
        end = Stop(collect.end_m, end_place, altitude(collect.end_m))
        beyond_m = collect.end_m + off_delay_m
        if may_overshoot is not None and _straight_left_m(path, collect) < off_delay_m - MERGE_M:
            place = _beyond(collect, local, off_delay_m)
            if _free(path, collects, collect.end_m, beyond_m) and may_overshoot(place):
                # Named as the collect's end, which it stands for: whole turns may begin before ``beyond_m``.
                stops.append(Stop(collect.end_m, place, altitude(collect.end_m), off=1))
                skipped.append((collect.end_m - MERGE_M, beyond_m))
                continue
        late = _late_stop(path, collect, local, off_delay_m)
        if late is None:
            stops.append(replace(end, off=1))
        else:
            stops += [end, replace(late, altitude_m=altitude(late.along_m), off=1)]
    from_m, until_m = between_m
    corners: list[Stop] = []
    cut_m: list[float] = []
    for segment in path.segments:
        if segment.start_m < from_m - MERGE_M or segment.start_m > until_m - MERGE_M:
            continue
        if segment.kind == "vertical":
            # What climbs at the take-off or lands is an item of its own; between passes it is two waypoints.
            if from_m + MERGE_M < segment.start_m:
                end_m = segment.start_m + segment.length_m
                stops.append(Stop(segment.start_m, here(segment.start), segment.start_altitude_m))
                stops.append(Stop(end_m, here(segment.start), segment.end_altitude_m))
            continue
        if is_whole_turns(segment):
            stops.append(Stop(segment.start_m, here(segment.start), segment.end_altitude_m, turns=segment))
            continue
        if flown_round(segment):
            end_m = segment.start_m + segment.length_m
            stops.append(Stop(segment.start_m, here(segment.start), altitude(segment.start_m)))
            stops.append(Stop(end_m, here(segment.end), altitude(end_m), arc=segment))
            continue
        if segment.radius_m is not None and segment.radius_m <= corner_m:
            cut_m += [segment.start_m, segment.start_m + segment.length_m]
            for along_m, place in _corners(segment, local):
                corners.append(Stop(along_m, here(place), altitude(along_m)))
            continue
        places = _segment_places(segment, local, chord_error_m)
        for number, place in enumerate(places):
            along_m = segment.start_m + segment.length_m * number / (len(places) - 1)
            if not any(since_m <= along_m <= until_m for since_m, until_m in skipped):
                stops.append(Stop(along_m, here(place), altitude(along_m)))
    # Where lines are cut short for an arc nothing happens: they meet behind it.
    stops = [s for s in stops if s.on or s.off or all(abs(s.along_m - m) > MERGE_M for m in cut_m)]
    stops += [c for c in corners if not any(since_m <= c.along_m <= to_m for since_m, to_m in skipped)]
    # Turns are left where they are entered: a waypoint there would be behind the aircraft.
    left_m = [s.turns.start_m + s.turns.length_m for s in stops if s.turns is not None]
    begun_m = [from_m, *left_m]
    stops = [
        stop
        for stop in stops
        if stop.on
        or stop.off
        or stop.turns is not None
        or (stop.along_m > from_m and all(abs(stop.along_m - m) > MERGE_M for m in begun_m))
    ]
    merged = _merged(stops, {here(place[:2]) for collect in collects for place in collect.line})
    return tuple(_apart(tuple(_left_outwards(merged, local)), local, near_m))


def _apart(stops: Sequence[Stop], local: LocalMap, near_m: float) -> Iterator[Stop]:
    """Stops without those at which nothing happens, and that lie near the last one kept or a needed one."""
    kept: Stop | None = None
    for number, stop in enumerate(stops):
        last = number == len(stops) - 1
        needed = stop.on or stop.off or stop.arc or stop.turns or last
        others = [other for other in (kept, None if last else stops[number + 1]) if other is not None]
        if not needed and any(
            _away_m(stop, other, local) < near_m for other in others if other is kept or other.on or other.off
        ):
            continue
        kept = stop
        yield stop


def _away_m(stop: Stop, other: Stop, local: LocalMap) -> float:
    over_m = math.dist(local.xy(stop.place), local.xy(other.place))
    return math.hypot(over_m, stop.altitude_m - other.altitude_m)


def _left_outwards(stops: Sequence[Stop], local: LocalMap) -> Iterator[Stop]:
    """Stops without those right behind whole turns that lie on the circle still, as on an arc that goes on.

    A circle is left towards the place behind it. PX4 waits for that course only where the place lies outside
    (``exit_course_is_reachable`` of its mission_block.cpp); else it leaves at once when it is high enough.
    """
    turns: PathSegment | None = None
    for number, stop in enumerate(stops):
        if stop.turns is not None:
            turns = stop.turns
        elif turns is not None and turns.centre is not None and turns.radius_m is not None:
            away_m = math.dist(local.xy(stop.place), local.xy(turns.centre))
            last = number == len(stops) - 1
            if away_m <= _OUTSIDE * turns.radius_m and not (stop.on or stop.off or stop.arc or last):
                continue
            turns = None
        yield stop


def _segment_places(segment: PathSegment, local: LocalMap, chord_error_m: float) -> list[LonLat]:
    """Places evenly spread over a segment, both ends among them."""
    if segment.kind == "straight" or segment.centre is None or segment.turn_deg is None:
        return [segment.start, segment.end]
    start, end, centre = (local.xy(place) for place in (segment.start, segment.end, segment.centre))
    turn_rad = math.radians(segment.turn_deg) * (1.0 if segment.kind == "left" else -1.0)
    step_rad = chord_step_rad(math.dist(start, centre), chord_error_m, LARGEST_STEP_RAD)
    between = arc_points(start, end, centre, turn_rad, step_rad)
    return [segment.start, *(local.lonlat(point) for point in between), segment.end]


def _corners(segment: PathSegment, local: LocalMap) -> Iterator[tuple[float, LonLat]]:
    """Where the tangents of an arc meet, each part a right angle at most, and how far along."""
    if segment.centre is None or segment.turn_deg is None or segment.radius_m is None:
        return
    count = max(1, math.ceil(segment.turn_deg / MOST_CORNER_DEG))
    turn_rad = math.radians(segment.turn_deg) * (1.0 if segment.kind == "left" else -1.0)
    start, centre = local.xy(segment.start), local.xy(segment.centre)
    from_rad = math.atan2(start[1] - centre[1], start[0] - centre[0])
    away_m = segment.radius_m / math.cos(turn_rad / (2.0 * count))
    for number in range(count):
        part = (number + 0.5) / count
        place = local.lonlat(offset(centre, from_rad + part * turn_rad, away_m))
        yield segment.start_m + part * segment.length_m, place


def _straight_left_m(path: FlownPath, collect: Collect) -> float:
    """How far the straight goes on behind a collect."""
    ends_m = [
        segment.start_m + segment.length_m
        for segment in path.segments
        if segment.kind == "straight" and segment.start_m <= collect.end_m + MERGE_M
    ]
    return max(0.0, max(ends_m, default=0.0) - collect.end_m)


def _beyond(collect: Collect, local: LocalMap, distance_m: float) -> LonLat:
    """A place past a collect's end, in the direction of its line; before it for less than 0."""
    (start_x, start_y), (end_x, end_y) = (local.xy(place[:2]) for place in collect.line)
    part = distance_m / math.hypot(end_x - start_x, end_y - start_y)
    return local.lonlat((end_x + part * (end_x - start_x), end_y + part * (end_y - start_y)))


def _free(path: FlownPath, collects: Sequence[Collect], since_m: float, until_m: float) -> bool:
    """Whether a piece of the path has no end of a collect in it, nor the path's own."""
    ends_m = [path.length_m, *(m for collect in collects for m in (collect.start_m, collect.end_m))]
    return not any(since_m < end_m <= until_m + MERGE_M for end_m in ends_m)


def _late_stop(path: FlownPath, collect: Collect, local: LocalMap, off_delay_m: float) -> Stop | None:
    """Where the sensor goes off past the end of a collect; None where the straight ends there."""
    if off_delay_m <= MERGE_M:
        return None
    for segment in path.segments:
        segment_end_m = segment.start_m + segment.length_m
        if segment.kind == "straight" and segment.start_m <= collect.end_m < segment_end_m - MERGE_M:
            along_m = min(collect.end_m + off_delay_m, segment_end_m)
            part = (along_m - segment.start_m) / segment.length_m
            start, end = local.xy(segment.start), local.xy(segment.end)
            middle = (start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1]))
            return Stop(along_m, local.lonlat(middle), 0.0)
    return None


def _merged(stops: list[Stop], exact: set[LonLat]) -> tuple[Stop, ...]:
    """Stops in order; those nearer than MERGE_M to each other are one, at an exact place if there is one."""
    merged: list[Stop] = []
    for stop in sorted(stops, key=_in_order):
        apart = not merged or stop.along_m - merged[-1].along_m > MERGE_M
        if apart or stop.turns is not None or merged[-1].turns is not None:
            merged.append(stop)
            continue
        last = merged[-1]
        both_exact = last.place in exact and stop.place in exact
        if both_exact and last.place != stop.place:
            merged.append(stop)
        else:
            kept = stop if stop.place in exact else last
            merged[-1] = replace(
                kept,
                off=last.off + stop.off,
                on=last.on + stop.on,
                arc=last.arc or stop.arc,
                turns=last.turns or stop.turns,
            )
    return tuple(merged)


def _in_order(stop: Stop) -> tuple[float, int, int]:
    """Whole turns come behind what is named where they begin, though a file rounds distances."""
    return stop.along_m + (0.0 if stop.turns is None else MERGE_M), -stop.off, stop.on


def altitude_along(path: FlownPath, along_m: float) -> float:
    """Altitude at a distance along a path: its segments have even slopes."""
    starts_m = [segment.start_m for segment in path.segments]
    segment = path.segments[max(0, bisect_right(starts_m, along_m) - 1)]
    part = (along_m - segment.start_m) / segment.length_m if segment.length_m > 0.0 else 1.0
    part = min(1.0, max(0.0, part))
    return segment.start_altitude_m + part * (segment.end_altitude_m - segment.start_altitude_m)


def is_whole_turns(segment: PathSegment) -> bool:
    """Whether a segment is whole turns of a circle, as heights are won and lost on."""
    return segment.turn_deg is not None and segment.turn_deg >= WHOLE_TURN_DEG
