"""From the ground to the height of a route: run, climb along the first leg, climbing turns where it is short.

A descent is a rise flown backwards: see :func:`fall`.

The run's direction, where it is free, and the leg behind it are chosen together. The leg climbs as steeply as
the aircraft may until it is high enough. Where the leg is too short for that, or low zones lie under it,
whole turns are flown first, on a circle that touches the leg where one is clear of zones, else beside it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from planner.airspace.zones import KeepOut
from planner.dubins.path import Path, Segment, SegmentKind, join
from planner.errors import InfeasibleError
from planner.profile.foot import HEADINGS, Foot
from planner.profile.heights import Heights, tidy
from planner.profile.lines import circle, cut, stored_radius_m, straights, with_circle
from planner.progress import Stop, never, raise_if
from planner.route import Anchor, Pose

Connect = Callable[[Anchor, Anchor], Path]

SIDES: tuple[SegmentKind, SegmentKind] = ("left", "right")
#: Distances of circles beside the leg, in turn radii, directions to them, and places where they are entered.
BESIDE_RADII, BESIDE_WAYS, ENTRIES = (3.0, 5.0, 8.0, 13.0, 21.0), 12, 8
#: Circles beside the leg to which lines are sought.
MOST_BESIDE = 6
#: About the best direction of a run others are tried, in steps that begin with the grid's and are halved.
PARTS, ROUNDS = (-2.0 / 3.0, -1.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0), 7
#: Runs this far apart, so many, are tried where there is no room to climb behind the best one.
APART_RAD, MOST_RUNS = math.tau / HEADINGS / 2.0, 12
#: A turn more is not flown for the sake of less height than this.
NO_TURN_M = 0.5


@dataclass(frozen=True, slots=True)
class Terms:
    """What a rise keeps to.

    Parameters
    ----------
    top_m
        Altitude to be reached.
    slope_rad, turning_rad
        Steepest climb, on legs and in whole turns.
    radius_m
        Of climbing turns.
    level_off_m
        Flown level at the top before the goal.
    zones
        What is to be kept out of at any height up to the top, margins included.
    connect
        A flyable line between two anchors; raises InfeasibleError.
    cost_m
        Of a line: its length, and what its risk counts.
    spare_m
        Of the way round in turns, not climbed on: who comes to them late must not fly one turn more.
    too_low
        Whether a line behind the run, at these heights, comes too near to the ground below.
    """

    top_m: float
    slope_rad: float
    turning_rad: float
    radius_m: float
    level_off_m: float
    zones: KeepOut
    connect: Connect
    cost_m: Callable[[Path], float]
    spare_m: float = 0.0
    too_low: Callable[[Path, Heights], bool] = lambda path, heights: False
    stop: Stop = never

    def run_for_m(self, rise_m: float) -> float:
        """Distance over the ground that a climb takes at least."""
        return max(rise_m, 0.0) / math.tan(self.slope_rad)


@dataclass(frozen=True, slots=True)
class Rise:
    """A way up.

    Parameters
    ----------
    path, heights
        From the foot to the goal; where it climbs on the spot first, the first two knots say so.
    run_m
        Where the run ends.
    turns_m
        Where the climbing turns end; the run's end without any.
    inserted_m
        By how much the line is longer than it would be without climbing turns.
    """

    path: Path
    heights: Heights
    run_m: float
    turns_m: float
    inserted_m: float


#: Number of hard and of other conflicts, and cost: less is better.
_Rank = tuple[int, int, float]
#: A rank, and the leg behind a run.
_Run = tuple[_Rank, Path]


def rise(foot: Foot, goal: Anchor, terms: Terms) -> Rise:
    """The cheapest way found from the ground to a goal at the top, clear of zones where there is one.

    Raises
    ------
    InfeasibleError
        Where no line leads from any run to the goal.
    """
    natural_rad = _natural_rad(foot, goal, terms)
    headings = foot.headings(natural_rad)
    runs, failed = _runs(foot, goal, terms, headings)
    lenient = foot.with_wind_behind()
    if lenient is not None and all(rank[0] for rank, _ in runs):
        foot, headings = lenient, lenient.headings(natural_rad)
        runs, failed = _runs(foot, goal, terms, headings)
    width_rad = math.tau / HEADINGS
    for _ in range(ROUNDS if runs and len(headings) > 1 else 0):
        best_rad = min(runs, key=lambda run: run[0])[1].start.angle_rad
        near = [best_rad + part * width_rad for part in PARTS]
        runs += _runs(foot, goal, terms, [angle for angle in near if foot.allows(angle)])[0]
        width_rad /= 2.0
    if not runs:
        raise failed or InfeasibleError("take-off", "start", "no way leads from it", "Move the start.")
    leg, (climbed, heights, turns_m) = _climbed(foot, sorted(runs, key=lambda run: run[0]), terms)
    run = _run(foot, climbed.start)
    knots = [(0.0, foot.ground_m)]
    if foot.lift_m > 0.0:
        knots.append((0.0, foot.ground_m + foot.lift_m))
    if foot.run_m > 0.0:
        knots.append((foot.run_m, foot.altitude_m))
    whole = Heights(tuple(knots)) if len(knots) > 1 else None
    heights = heights if whole is None else whole.then(heights)
    path = join(run, climbed) if foot.run_m > 0.0 else climbed
    return Rise(path, heights, foot.run_m, foot.run_m + turns_m, climbed.length_m - leg.length_m)


def _runs(
    foot: Foot, goal: Anchor, terms: Terms, headings: Sequence[float | None]
) -> tuple[list[_Run], InfeasibleError | None]:
    """Legs behind runs in some directions, ranked; and why one was refused."""
    found: list[_Run] = []
    failed: InfeasibleError | None = None
    for angle_rad in headings:
        raise_if(terms.stop)
        try:
            leg = terms.connect(foot.run_end(angle_rad), goal)
        except InfeasibleError as error:
            failed = error
            continue
        run = _run(foot, leg.start)
        hard, soft = conflicts(run, terms.zones)
        if foot.run_m > 0.0:
            low_m = foot.ground_m + foot.lift_m
            hard += terms.too_low(run, Heights(((0.0, low_m), (foot.run_m, foot.altitude_m))))
        found.append(((hard, soft, terms.cost_m(run) + terms.cost_m(leg)), leg))
    return found, failed


def _climbed(foot: Foot, runs: list[_Run], terms: Terms) -> tuple[Path, tuple[Path, Heights, float]]:
    """The first leg, of ranked ones, that has room to climb on; the first of all where none has."""
    best: tuple[tuple[int, int], Path, tuple[Path, Heights, float]] | None = None
    failed: InfeasibleError | None = None
    tried: list[float] = []
    for (hard, soft, _), leg in runs:
        angle_rad = leg.start.angle_rad
        if any(abs(math.remainder(angle_rad - other, math.tau)) < APART_RAD for other in tried):
            continue
        tried.append(angle_rad)
        try:
            climbed = climbed_leg(foot.altitude_m, leg, terms)
        except InfeasibleError as error:
            failed = failed or error
            continue
        path, heights, _ = climbed
        level_m = next(at_m for at_m, up_m in heights.knots if up_m >= heights.knots[-1][1])
        entered = conflicts(cut(path, 0.0, level_m), terms.zones)
        rank = (hard + entered[0] + terms.too_low(path, heights), soft + entered[1])
        if best is None or rank < best[0]:
            best = (rank, leg, climbed)
        if rank == (0, 0) or len(tried) >= MOST_RUNS:
            break
    if best is None:
        raise failed or InfeasibleError("climb", "start", "no way leads up", "Move the start.")
    return best[1:]


def fall(foot: Foot, origin: Anchor, terms: Terms) -> Rise:
    """The way down from an origin at the top to the ground: a rise flown backwards.

    ``foot.angle_rad`` is the direction in which the aircraft arrives. ``run_m`` and ``turns_m`` of what is
    given count from the ground, backwards.
    """
    backwards = replace(terms, connect=lambda a, b: terms.connect(turned(b), turned(a)).reverse())
    back = None if foot.angle_rad is None else foot.angle_rad + math.pi
    # With the wind ahead at the landing it is behind on the line flown backwards.
    into = None if foot.into_rad is None else foot.into_rad + math.pi
    up = rise(replace(foot, angle_rad=back, into_rad=into), turned(origin), backwards)
    return Rise(up.path.reverse(), up.heights.reverse(), up.run_m, up.turns_m, up.inserted_m)


def turned(anchor: Anchor) -> Anchor:
    """The same place, flown over the other way."""
    angle_rad = None if anchor.angle_rad is None else anchor.angle_rad + math.pi
    return Anchor(anchor.east_m, anchor.north_m, angle_rad)


def _run(foot: Foot, end: Pose) -> Path:
    start = Pose(*foot.position, end.angle_rad)
    return Path((Segment("straight", start, foot.run_m),))


def _natural_rad(foot: Foot, goal: Anchor, terms: Terms) -> float:
    """The direction in which the leg would leave the foot if nothing were flown straight."""
    try:
        return terms.connect(Anchor(*foot.position, None), goal).start.angle_rad
    except InfeasibleError:
        return math.atan2(goal.north_m - foot.position[1], goal.east_m - foot.position[0])


def conflicts(path: Path, zones: KeepOut) -> tuple[int, int]:
    """Hard and other zones that a line enters."""
    if path.length_m <= 0.0 or zones.clear(path):
        return 0, 0
    found = zones.conflicts(path)
    return sum(c.hard for c in found), sum(not c.hard for c in found)


def climbed_leg(low_m: float, leg: Path, terms: Terms) -> tuple[Path, Heights, float]:
    """A leg with its climb from an altitude to the top, and where on it climbing turns end (0 without any).

    Raises
    ------
    InfeasibleError
        Where there is no place for turns.
    """
    needed_m = terms.run_for_m(terms.top_m - low_m)
    if needed_m <= max(leg.length_m - terms.level_off_m, 0.0):
        plain = Heights(tidy(((0.0, low_m), (needed_m, terms.top_m), (leg.length_m, terms.top_m))))
        hard, soft = conflicts(cut(leg, 0.0, needed_m), terms.zones)
        rank = (hard + terms.too_low(leg, plain), soft, 0.0)
        if rank[:2] == (0, 0):
            return leg, plain, 0.0
        found = _turning(low_m, leg, terms)
        return found[1:] if found is not None and found[0] < rank else (leg, plain, 0.0)
    found = _turning(low_m, leg, terms)
    if found is not None and found[0][:2] == (0, 0):
        return found[1:]
    beside = _beside(low_m, leg, terms)
    choices = [choice for choice in (found, beside) if choice is not None]
    if not choices:
        raise InfeasibleError(
            "climb",
            "start",
            f"there is no place for turns of {terms.radius_m:.0f} m radius to climb {terms.top_m:.0f} m in",
            "Fly lower, climb steeper (max_climb_deg), or give more room.",
        )
    return min(choices, key=lambda choice: choice[0])[1:]


_Choice = tuple[_Rank, Path, Heights, float]


def _turning(low_m: float, leg: Path, terms: Terms) -> _Choice | None:
    """Climbing turns on a circle that touches the leg; the best there is, clear or not.

    What is flown before the leg is straight: there, at once, is the first place.
    """
    best: _Choice | None = None
    for at_m in dict.fromkeys([0.0, *straights(leg, 2.0 * terms.radius_m)]):
        raise_if(terms.stop)
        for choice in _turns_at(low_m, leg, at_m, terms):
            if best is None or choice[0] < best[0]:
                best = choice
        if best is not None and best[0][:2] == (0, 0):
            # Further along there are no fewer turns to fly, for as much is climbed on the way.
            break
    return best


def _turns_at(low_m: float, leg: Path, at_m: float, terms: Terms) -> Iterator[_Choice]:
    """Turns at one place: as many as the leg behind needs, or all of the height there."""
    slope, turning = math.tan(terms.slope_rad), math.tan(terms.turning_rad)
    in_m = min(terms.top_m, low_m + at_m * slope)
    ahead_m = max(leg.length_m - at_m - terms.level_off_m, 0.0)
    # What no turn is flown for is climbed behind the turns, where there is so much of the leg.
    left_m = min(NO_TURN_M, (leg.length_m - at_m) * slope)
    ways = dict.fromkeys(
        way
        for out_m in (max(in_m, terms.top_m - ahead_m * slope), terms.top_m)
        for way in _circles((out_m - in_m - left_m) / turning, terms.radius_m, terms.spare_m)
    )
    for count, radius_m in ways:
        climbing_m = count * math.tau * radius_m - terms.spare_m
        out_m = min(terms.top_m, in_m + climbing_m * turning)
        rest_m = min(terms.run_for_m(terms.top_m - out_m), leg.length_m - at_m)
        for side in SIDES:
            turns = circle(leg, at_m, side, radius_m, count)
            flown = (cut(leg, 0.0, at_m), circle(leg, at_m, side, radius_m, 1))
            hard, soft = (
                sum(many)
                for many in zip(
                    *(conflicts(piece, terms.zones) for piece in (*flown, cut(leg, at_m, at_m + rest_m))),
                    strict=True,
                )
            )
            knots = (
                (0.0, low_m),
                (at_m, in_m),
                (at_m + turns.length_m, out_m),
                (at_m + turns.length_m + rest_m, terms.top_m),
                (leg.length_m + turns.length_m, terms.top_m),
            )
            line, heights = with_circle(leg, at_m, turns), Heights(tidy(knots))
            hard += terms.too_low(line, heights)
            yield (hard, soft, turns.length_m), line, heights, at_m + turns.length_m


def _circles(length_m: float, radius_m: float, spare_m: float) -> Iterator[tuple[int, float]]:
    """How many whole turns, how wide, are so long with something to spare: about as tight as may be, or one.

    The last turn is one turn more neither for who comes early by what is spare, nor for who comes late by it.
    More than one are not made fewer: what climbs or descends faster than planned leaves early.
    """
    needed_m = max(length_m, 0.0)
    count = max(1, math.ceil((needed_m - spare_m) / (math.tau * radius_m)))

    def wide(turns: int) -> float:
        least_m = (needed_m + spare_m) / (turns * math.tau)
        return radius_m if least_m <= radius_m else stored_radius_m(least_m)

    yield count, wide(count)
    if count == 2:
        yield 1, wide(1)


def _beside(low_m: float, leg: Path, terms: Terms) -> _Choice | None:
    """All of the height on a circle beside the leg's beginning, with lines to it and on from it."""
    best: _Choice | None = None
    begin = Anchor(*leg.start.position, leg.start.angle_rad)
    goal = Anchor(*leg.end.position, leg.end.angle_rad)
    tried = 0
    for radii in BESIDE_RADII:
        for way in range(BESIDE_WAYS):
            way_rad = leg.start.angle_rad + way * math.tau / BESIDE_WAYS
            centre = (
                begin.east_m + radii * terms.radius_m * math.cos(way_rad),
                begin.north_m + radii * terms.radius_m * math.sin(way_rad),
            )
            for side in SIDES:
                if tried >= MOST_BESIDE:
                    return best
                if not terms.zones.clear(ring(centre, 0.0, side, terms.radius_m)):
                    continue
                tried += 1
                choice = _round(low_m, begin, goal, centre, side, terms)
                if choice is not None and (best is None or choice[0] < best[0]):
                    best = choice
    return best


def ring(centre: tuple[float, float], at_rad: float, side: SegmentKind, radius_m: float) -> Path:
    """A whole circle about a centre, from a place at an angle seen from there."""
    turn = 1.0 if side == "left" else -1.0
    place = (centre[0] + radius_m * math.cos(at_rad), centre[1] + radius_m * math.sin(at_rad))
    return Path((Segment(side, Pose(*place, at_rad + turn * math.pi / 2.0), math.tau * radius_m, radius_m),))


def _round(
    low_m: float, begin: Anchor, goal: Anchor, centre: tuple[float, float], side: SegmentKind, terms: Terms
) -> _Choice | None:
    """The cheapest of the ways by a circle: to it, round it until high enough, and on."""
    best: _Choice | None = None
    for k in range(ENTRIES):
        raise_if(terms.stop)
        once = ring(centre, k * math.tau / ENTRIES, side, terms.radius_m)
        pose = Anchor(*once.start.position, once.start.angle_rad)
        try:
            through = join(terms.connect(begin, pose), terms.connect(pose, goal))
            there_m = terms.connect(begin, pose).length_m
        except InfeasibleError:
            continue
        for choice in _turns_at(low_m, through, there_m, terms):
            rank = (*choice[0][:2], choice[0][2] + terms.cost_m(through))
            if best is None or rank < best[0]:
                best = (rank, *choice[1:])
    return best
