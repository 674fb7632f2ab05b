"""Ground that terrain hides from every pass of a tour: passes besides, from where it is seen.

No single direction may see all of a region: what is in shadow or layover from the passes chosen is measured
as the judge measures it, and the best pass for it, as a rule from the other side, is put where in the tour it
costs least. What no direction sees is left, and said.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.surroundings import Surroundings
from planner.airspace.terrain import Ground
from planner.coverage.merge import MergedRegion, polygons_of, split_region
from planner.coverage.registry import family_of
from planner.coverage.ways import Options, Target
from planner.dubins.estimate_kernels import transit_costs
from planner.errors import Finding, InfeasibleError
from planner.progress import Stop, never, raise_if
from planner.route import CollectPass, Terminal
from planner.routing.legs import Legs
from planner.sensors.registry import seen
from planner.sensors.suite import Suite
from planner.wishes import Region

Floats = NDArray[np.float64]
Passes = tuple[CollectPass, ...]

#: Regions of which no more than this part is left out count as seen, as for the judge.
LEFT_PART = 1e-5
#: Outlines are overlaid on a grid, as those of the judge are.
GRID_M = 1e-6
#: Passes for hidden ground are sought at this step of heading and these offsets,
STEP_RAD = math.radians(10.0)
ETAS = np.linspace(0.0, 1.0, 5)
#: so many of them are flown in earnest, the cheapest by estimate first,
TRIED = 12
#: and again for what is still hidden.
ROUNDS = 4
#: A pass has to see this part of what was hidden to be flown,
LEAST_GAIN = 0.02
#: and what it leaves costs this much a share, as in the choice of options.
HIDDEN_M = 100_000.0
#: Ground left out is called hidden where the beam lay on this part of it.
HIDDEN_PART = 0.5
#: Specks of hidden ground closer together than this part of the swath are seen together.
TOGETHER = 0.5


@dataclass(frozen=True, slots=True)
class _Trial:
    """Passes put at a place of the tour, with what they cost by estimate."""

    cost_m: float
    at: int
    passes: Passes


@dataclass(slots=True)
class Sight:
    """What passes see of the ground; looked at once for each pass."""

    regions: tuple[Region, ...]
    suite: Suite
    airspace: Airspace
    level: Level
    ground: Ground
    _known: dict[tuple[object, ...], BaseGeometry] = field(default_factory=dict)

    @classmethod
    def of(cls, regions: tuple[Region, ...], suite: Suite, airspace: Airspace, level: Level) -> Sight | None:
        """Over an airspace's terrain; None where passes see what they are laid for: flat, or followed."""
        level_flown = tuple(region for region in regions if region.over_ground_m is None)
        if airspace.terrain is None or not level_flown:
            return None
        return cls(level_flown, suite, airspace, level, airspace.terrain)

    def seen(self, collect: CollectPass) -> BaseGeometry:
        """The ground one pass sees."""
        key = (collect.sensor, collect.look, collect.start, collect.end, collect.regions[0])
        if key not in self._known:
            line_m, sensor = (collect.start, collect.end), self.suite.named(collect.sensor)
            level = self.level_of(collect.regions[0])
            self._known[key] = seen(sensor, line_m, collect.look, level.amsl_m, self.ground).area
        return self._known[key]

    def level_of(self, name: str) -> Level:
        """The level that a region is seen from."""
        return next(self.level.of(region) for region in self.regions if region.name == name)

    def useful(self, collect: CollectPass) -> BaseGeometry:
        """What one pass sees of the regions it counts for."""
        regions = [r.area for r in self.regions if self.counts(r, collect)]
        return shapely.intersection(
            self.seen(collect), shapely.union_all(regions, grid_size=GRID_M), grid_size=GRID_M
        )

    def unseen(self, passes: Sequence[CollectPass]) -> dict[str, BaseGeometry]:
        """What of each region the passes do not see, as often as asked, where that is more than rounding."""
        left: dict[str, BaseGeometry] = {}
        for region in self.regions:
            prints = [
                shapely.intersection(self.seen(collect), region.area, grid_size=GRID_M)
                for collect in passes
                if self.counts(region, collect)
            ]
            rest = _left(region, prints)
            if rest.area > LEFT_PART * region.area.area:
                left[region.name] = rest
        return left

    def counts(self, region: Region, collect: CollectPass) -> bool:
        """Whether a pass is of the region's sensor, at its height and in a direction it allows."""
        if self.suite.of(region).name != collect.sensor:
            return False
        if self.level_of(collect.regions[0]) != self.level.of(region):
            return False
        return region.approach_rad is None or any(
            abs(math.remainder(collect.angle_rad - allowed, math.tau)) < math.radians(1.0)
            for allowed in region.approach_rad
        )


def see_hidden(
    sight: Sight,
    around: Callable[[Level], Surroundings],
    ends: tuple[Terminal, Terminal],
    passes: Passes,
    legs: Legs,
    stop: Stop = never,
) -> Passes:
    """The tour with passes besides for ground that terrain hides from those it has.

    ``around`` is what passes at a level fly among.

    A pass that sees little of what was hidden is not flown, and one that has become needless no longer.
    """
    wanted = {name for collect in passes for name in collect.regions}
    given_up: set[str] = set()
    before = passes
    for _ in range(ROUNDS):
        left = {name: rest for name, rest in sight.unseen(passes).items() if name in wanted - given_up}
        if not left:
            break
        for region in sight.regions:
            if region.name not in left:
                continue
            raise_if(stop)
            level = sight.level.of(region)
            better = _with_more(sight, around(level), ends, region, left[region.name], passes, legs)
            if better is None:
                given_up.add(region.name)
            else:
                passes = better
    return passes if passes is before else _without_needless(sight, passes, legs, stop)


def hidden_findings(sight: Sight, passes: Passes, *, by_paper: bool) -> tuple[Finding, ...]:
    """A warning for each region of which ground in the beam of its passes stays hidden."""
    findings = []
    for name, rest in sight.unseen(passes).items():
        beams = [collect.footprint for collect in passes if name in collect.regions]
        hidden = rest.intersection(shapely.union_all(beams), grid_size=GRID_M)
        if hidden.area < HIDDEN_PART * rest.area:
            continue
        fix = "Let the sensor look to both sides, allow more headings, or fly higher."
        if by_paper:
            fix = "The paper's methods take the ground for flat: auto looks for another side."
        findings.append(
            Finding(
                name,
                "hidden-ground",
                f"{rest.area:.0f} m² of it are in shadow or layover from every pass flown",
                fix,
                "warning",
            )
        )
    return tuple(findings)


def _with_more(
    sight: Sight,
    around: Surroundings,
    ends: tuple[Terminal, Terminal],
    region: Region,
    rest: BaseGeometry,
    passes: Passes,
    legs: Legs,
) -> Passes | None:
    """The tour with passes that see what is left of a region; None where none sees enough of it."""
    together_m = TOGETHER * sight.suite.of(region).swath_m(sight.level.of(region).height_m)
    improved = None
    for part in _clusters(region, rest, together_m, sight.ground.step_m / 2.0):
        hidden = shapely.union_all(part.originals, grid_size=GRID_M)
        best: tuple[float, Passes] | None = None
        for trial in _trials(sight, around, ends, part, passes):
            shown = shapely.union_all([sight.seen(collect) for collect in trial.passes])
            gained = shapely.intersection(hidden, shown, grid_size=GRID_M).area / hidden.area
            if gained < LEAST_GAIN:
                continue
            longer = passes[: trial.at] + trial.passes + passes[trial.at :]
            cost_m = legs.tour_m(longer) + HIDDEN_M * (1.0 - gained)
            if math.isfinite(cost_m) and (best is None or cost_m < best[0]):
                best = (cost_m, longer)
        if best is not None:
            passes = improved = best[1]
    return improved


def _without_needless(sight: Sight, passes: Passes, legs: Legs, stop: Stop) -> Passes:
    """The tour without passes of which all that counts is seen by others, too, where it is no costlier so."""
    if any(region.revisits > 1 for region in sight.regions):
        return passes
    useful = [sight.useful(collect) for collect in passes]
    behind: list[BaseGeometry] = [Polygon()]
    for area in useful[:0:-1]:
        behind.append(shapely.union_all([behind[-1], area], grid_size=GRID_M))
    kept: list[int] = []
    ahead: BaseGeometry = Polygon()
    cost_m = legs.tour_m(passes)
    for index, area in enumerate(useful):
        raise_if(stop)
        others = shapely.union_all([ahead, behind.pop()], grid_size=GRID_M)
        alone = shapely.difference(area, others.buffer(1e-3), grid_size=GRID_M)
        fewer = tuple(passes[k] for k in (*kept, *range(index + 1, len(passes))))
        if alone.area <= LEFT_PART * area.area and fewer and (fewer_m := legs.tour_m(fewer)) <= cost_m:
            cost_m = fewer_m
            continue
        kept.append(index)
        ahead = shapely.union_all([ahead, area], grid_size=GRID_M)
    return tuple(passes[k] for k in kept)


def _trials(
    sight: Sight,
    around: Surroundings,
    ends: tuple[Terminal, Terminal],
    part: MergedRegion,
    passes: Passes,
) -> list[_Trial]:
    """Ways to see a part, each at the best place of the tour by estimate; the cheapest first."""
    level = sight.level.of(part)
    sensor, height_m = sight.suite.over(part.sensor, part.area, sight.airspace, level)
    angles_rad = np.arange(-math.pi, math.pi - 1e-9, STEP_RAD, dtype=np.float64)
    if part.approach_rad is not None:
        angles_rad = np.asarray(part.approach_rad, dtype=np.float64)
    found: list[tuple[Target, Options]] = []
    try:
        for target in family_of(sensor).undivided(part, sensor, height_m, around):
            options = target.options(angles_rad, ETAS)
            if options is not None:
                found.append((target, options))
    except InfeasibleError:
        return []
    del found[2:]
    trials = []
    leaving = np.array(
        [(*ends[0].position, ends[0].angle_rad or 0.0)]
        + [(*collect.end, collect.angle_rad) for collect in passes]
    )
    arriving = np.array(
        [(*collect.start, collect.angle_rad) for collect in passes]
        + [(*ends[1].position, ends[1].angle_rad or 0.0)]
    )
    direct_m = np.diagonal(transit_costs(leaving, arriving, around.radius_m, around.discs))
    for target, options in found:
        into_m = transit_costs(leaving, options.entries, around.radius_m, around.discs)
        from_m = transit_costs(options.exits, arriving, around.radius_m, around.discs)
        extra_m = into_m.T + from_m - direct_m[None, :]
        at = np.argmin(extra_m, axis=1)
        cost_m = extra_m[np.arange(len(at)), at] + options.inner_m
        for index in np.argsort(cost_m, kind="stable")[:TRIED].tolist():
            trials.append(_Trial(float(cost_m[index]), int(at[index]), target.passes(options, index)))
    return sorted(trials, key=lambda trial: trial.cost_m)[:TRIED]


def _clusters(region: Region, rest: BaseGeometry, together_m: float, reach_m: float) -> list[MergedRegion]:
    """Hidden ground in pieces to be seen by themselves, the largest first.

    Each is the hull of specks close together; what has to be seen are the specks, and a little round them
    inside the region, where the cells of another view have other edges.
    """
    wanted = rest.buffer(reach_m, join_style="mitre").intersection(region.area)
    groups = polygons_of(rest.buffer(together_m / 2.0)) if together_m > 0.0 else polygons_of(rest)
    whole = split_region(region)[0]
    found = []
    for group in groups:
        specks = tuple(
            part
            for part in shapely.get_parts(wanted.intersection(group)).tolist()
            if isinstance(part, Polygon) and part.area > 0.0
        )
        if not specks:
            continue
        hull = shapely.union_all(specks).convex_hull
        assert isinstance(hull, Polygon)
        found.append(
            replace(
                whole, area=hull, originals=specks, owners=(region.name,) * len(specks), axes=(), revisits=1
            )
        )
    return sorted(found, key=lambda part: -sum(speck.area for speck in part.originals))


def _left(region: Region, prints: Sequence[BaseGeometry]) -> BaseGeometry:
    """What of a region fewer footprints hold than visits are asked for."""
    deep: list[BaseGeometry] = [Polygon() for _ in range(region.revisits)]
    for area in prints:
        for k in range(region.revisits - 1, 0, -1):
            # Of an overlay with lines in it, where outlines touch, the areas alone.
            again = shapely.intersection(deep[k - 1], area, grid_size=GRID_M).buffer(0.0)
            deep[k] = shapely.union_all([deep[k], again], grid_size=GRID_M)
        deep[0] = shapely.union_all([deep[0], area], grid_size=GRID_M)
    return shapely.difference(region.area, deep[-1].buffer(1e-3), grid_size=GRID_M)
