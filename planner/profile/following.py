"""Heights of a flight that follows the ground: passes at one height over it, legs and both ends clear of it.

Everything rests on one surface, ``planner.airspace.envelope.Envelope``. A line that is never below it and
never steeper than the aircraft climbs can be flown on in any direction, so passes and legs are laid one by
one, and what joins them is right by itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from planner.airspace.envelope import SMOOTH_M, Envelope
from planner.airspace.zones import KeepOut
from planner.dubins.path import Path
from planner.profile.change import Changed, Layers, changed
from planner.profile.ends import Surround
from planner.profile.heights import SAME_M, Heights, tidy
from planner.profile.lines import cut
from planner.profile.rise import Rise
from planner.vehicle.model import FlightModel

Floats = NDArray[np.float64]

#: Places along a line at which the ground is looked at, in parts of the distance between its posts.
LOOKS_PER_POST = 2.0
#: Where the ground below a circle is looked at.
ROUND_RAD = np.radians(np.arange(0.0, 360.0, 15.0))
#: A way up is too steep by this part more than its slope.
STEEPER = 1.001


@dataclass(frozen=True, slots=True)
class Following:
    """What an aircraft follows the ground by.

    Parameters
    ----------
    envelope
        Of what is kept over the ground, and ``SMOOTH_M`` more.
    slope
        Steepest climb and descent, metres up for one along.
    """

    envelope: Envelope
    slope: float

    def over_pass(self, path: Path, height_m: float) -> Heights:
        """Heights of a pass: so far over the ground below, no lower than the surface.

        Where the ground is steeper than the aircraft climbs the pass is higher over it.
        """
        along_m, floor_m, ground_m = self._under(path)
        wanted_m = np.fmax(floor_m, ground_m + height_m)
        return Heights(tidy(_knots(along_m, _climbable(along_m, wanted_m, self.slope))))

    def leg(
        self,
        line: Callable[[KeepOut], Path],
        from_m: float,
        to_m: float,
        model: FlightModel,
        around: Surround,
        zones: KeepOut,
    ) -> Changed:
        """A leg from one altitude to another: evenly, where it is long enough, otherwise with turns.

        Raises
        ------
        InfeasibleError
            Where no line leads there, or there is no place for turns.
        """
        path = line(zones)
        if abs(to_m - from_m) <= self.slope * path.length_m:
            return Changed(path, Heights(((0.0, from_m), (path.length_m, to_m))))
        placed = replace(around, top_m=max(from_m, to_m), raised=self.over_leg)
        return changed(line, from_m, to_m, model, placed, Layers(zones, zones, zones))

    def over_leg(self, path: Path, heights: Heights) -> Heights:
        """Heights of a leg between passes, raised to the surface where they lie below it."""
        return self._raised(path, heights, heights.knots[-1][1])

    def rising(
        self, make: Callable[[float], Rise], goal_m: float, place: tuple[float, float], round_m: float = 0.0
    ) -> Rise:
        """A way up from a place, or down to it flown backwards, that can be flown on over the surface.

        Home on a slope may lie under a surface that is higher than the goal's, with no room on the way to
        come down from there. Then it goes up to the surface at its run's end, or to the goal's height alone.

        Parameters
        ----------
        make
            The way to an altitude from which the goal's is reached.
        goal_m
            Altitude of the goal.
        round_m
            Radius of a circle about the place that is flown there; 0 without any.
        """
        first: Rise | None = None
        tried: list[float] = []
        for last in (False, False, True):
            top_m = goal_m if last else max(goal_m, self.surface_m(place, round_m))
            if top_m in tried:
                continue
            tried.append(top_m)
            found = make(top_m)
            first = found if first is None else first
            if not self._steep(self.over_rise(found, goal_m)):
                return found
            place = cut(found.path, 0.0, found.run_m).end.position if found.run_m > SAME_M else place
        assert first is not None
        return first

    def falling(
        self, make: Callable[[float], Rise], origin_m: float, place: tuple[float, float], round_m: float
    ) -> Rise:
        """A way down, found as a way up flown backwards."""
        return _backwards(self.rising(lambda top_m: _backwards(make(top_m)), origin_m, place, round_m))

    def _steep(self, up: Rise) -> bool:
        """Whether it is somewhere steeper, behind its run, than can be climbed."""
        behind = [knot for knot in up.heights.knots if knot[0] >= up.run_m - SAME_M]
        return any(
            there_m - here_m > SAME_M and abs(up_m - from_m) > STEEPER * self.slope * (there_m - here_m)
            for (here_m, from_m), (there_m, up_m) in pairwise(behind)
        )

    def over_rise(self, up: Rise, goal_m: float) -> Rise:
        """A way up to a goal's altitude, on over what stands higher: from its run as steeply as it may be."""
        begun_m = max(up.turns_m, up.run_m)
        ahead_m = up.path.length_m - begun_m
        if ahead_m <= SAME_M:
            return up
        before = [knot for knot in up.heights.knots if knot[0] < begun_m - SAME_M or knot[0] <= SAME_M]
        behind = [(at_m - begun_m, up_m) for at_m, up_m in up.heights.knots if at_m > begun_m + SAME_M]
        ahead = Heights(((0.0, float(up.heights.at(begun_m))), *behind))
        raised = self._raised(cut(up.path, begun_m, up.path.length_m), ahead, goal_m)
        knots = (*before, *((begun_m + at_m, up_m) for at_m, up_m in raised.knots))
        return replace(up, heights=Heights(tidy(knots)))

    def over_fall(self, down: Rise, origin_m: float) -> Rise:
        """A way down: a way up flown backwards."""
        return _backwards(self.over_rise(_backwards(down), origin_m))

    def surface_m(self, place: tuple[float, float], round_m: float = 0.0) -> float:
        """Greatest altitude of the surface at a place and on a circle about it; -inf where not known."""
        ring = round_m * np.column_stack([np.cos(ROUND_RAD), np.sin(ROUND_RAD)])
        found_m = self.envelope.at(np.array(place) + np.vstack([np.zeros(2), ring]))
        return -math.inf if np.isnan(found_m).all() else float(np.nanmax(found_m))

    def _raised(self, path: Path, heights: Heights, last_m: float) -> Heights:
        """Heights no lower than the surface, as far as slopes from the first and to the last allow.

        Where it climbs on the spot it goes on doing so: what is before and behind is raised by itself.
        """
        at_m, floor_m, _ = self._under(path)
        parts = _parted(heights.knots)
        found: list[tuple[float, float]] = []
        for k, part in enumerate(parts):
            known_m, up_m = (np.array(column) for column in zip(*part, strict=True))
            inside = (at_m > known_m[0]) & (at_m < known_m[-1])
            along_m = np.union1d(at_m[inside], known_m)
            raised_m = np.fmax(np.interp(along_m, known_m, up_m), np.interp(along_m, at_m, floor_m))
            if k == 0:
                raised_m = np.minimum(raised_m, up_m[0] + self.slope * (along_m - along_m[0]))
            if k == len(parts) - 1:
                raised_m = np.minimum(raised_m, last_m + self.slope * (along_m[-1] - along_m))
                raised_m[-1] = last_m
            if k == 0:
                raised_m[0] = up_m[0]
            found += _knots(along_m, raised_m)
        return Heights(tidy(tuple(found)))

    def _under(self, path: Path) -> tuple[Floats, Floats, Floats]:
        """Places along a line, the surface there, and the ground; -inf and NaN where they are not known."""
        step_m = self.envelope.ground.step_m / LOOKS_PER_POST
        points = path.sample(step_m, step_m)
        along_m, kept = np.unique(points[:, 3], return_index=True)
        places = points[kept, :2]
        floor_m = self.envelope.at(places)
        return along_m, np.where(np.isnan(floor_m), -np.inf, floor_m), self.envelope.ground.at(places)


def _backwards(rise: Rise) -> Rise:
    return replace(rise, path=rise.path.reverse(), heights=rise.heights.reverse())


def _parted(knots: tuple[tuple[float, float], ...]) -> list[list[tuple[float, float]]]:
    """Knots between climbs on the spot."""
    parts = [[knots[0]]]
    for knot in knots[1:]:
        if knot[0] - parts[-1][-1][0] <= SAME_M:
            parts.append([])
        parts[-1].append(knot)
    return parts


def _climbable(along_m: Floats, wanted_m: Floats, slope: float) -> Floats:
    """The lowest heights on or over those wanted that are nowhere steeper than a slope."""
    ahead = np.maximum.accumulate(wanted_m + slope * along_m) - slope * along_m
    behind = np.maximum.accumulate((wanted_m - slope * along_m)[::-1])[::-1] + slope * along_m
    return np.maximum(ahead, behind)


def _knots(along_m: Floats, heights_m: Floats) -> tuple[tuple[float, float], ...]:
    """Few of the places, the line through which leaves no height by more than ``SMOOTH_M``.

    The farthest one is taken until none is farther (D. Douglas, T. Peucker, 1973), so that no straight is
    steeper than what it stands for.
    """
    kept = np.zeros(len(along_m), dtype=np.bool_)
    kept[[0, -1]] = True
    open_spans = [(0, len(along_m) - 1)]
    while open_spans:
        first, last = open_spans.pop()
        if last - first < 2:
            continue
        inner = slice(first + 1, last)
        part = (along_m[inner] - along_m[first]) / (along_m[last] - along_m[first])
        off_m = np.abs(heights_m[inner] - heights_m[first] - part * (heights_m[last] - heights_m[first]))
        farthest = first + 1 + int(np.argmax(off_m))
        if off_m[farthest - first - 1] > SMOOTH_M:
            kept[farthest] = True
            open_spans += [(first, farthest), (farthest, last)]
    return tuple(zip(along_m[kept].tolist(), heights_m[kept].tolist(), strict=True))
