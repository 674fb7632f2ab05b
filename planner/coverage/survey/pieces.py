"""Into which pieces ground is cut, each with lanes at a heading of its own."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.surroundings import Surroundings
from planner.coverage import decompose
from planner.coverage.estimate import Ends, least_tour_m
from planner.coverage.merge import GRID_M, MergedRegion, polygons_of
from planner.coverage.survey.lanes import Survey
from planner.coverage.survey.options import LaneOptions, allowed
from planner.coverage.survey.targets import LaneTarget
from planner.errors import InfeasibleError
from planner.progress import Stop, never, raise_if
from planner.sensors.camera import TWICE, CameraSensor

#: What seeing all of these pieces costs, about; inf where it cannot be.
Estimate = Callable[[tuple[MergedRegion, ...]], float]

#: Divisions are compared at these headings and offsets, by this many of each piece's cheapest options.
STEP_RAD, ETAS, TELLING = math.radians(30.0), np.array([0.5]), 6
OPTIONS_COMPARED = 24
#: A division has to save this much of the estimated cost, and beyond this many pieces there is no further.
LEAST_SAVING, MOST_PIECES = 0.01, 6


@dataclass(slots=True)
class Pieces:
    """Trial divisions of one region, with what they cost."""

    camera: CameraSensor
    height_m: float
    around: Surroundings
    stop: Stop = never
    _known: dict[bytes, LaneOptions | None] = field(default_factory=dict)
    _cut: set[bytes] = field(default_factory=set)

    def cut(self, piece: MergedRegion) -> MergedRegion:
        """A piece cut from something wider: where lanes overlap by half and more it takes two at least."""
        self._cut.add(piece.area.wkb)
        return piece

    def target(self, piece: MergedRegion) -> LaneTarget:
        """A piece as a stop."""
        several = self.camera.side_overlap >= TWICE and piece.area.wkb in self._cut
        survey = Survey(piece.area, wanted(piece), self.camera, self.height_m, 2 if several else 1)
        return LaneTarget(piece, survey, self.around)

    def options(self, piece: MergedRegion) -> LaneOptions | None:
        """A few ways to see a piece; None where there are none."""
        key = piece.area.wkb
        if key not in self._known:
            raise_if(self.stop)
            try:
                self._known[key] = self.target(piece).coarse(STEP_RAD, ETAS, TELLING)
            except InfeasibleError:
                self._known[key] = None
        return self._known[key]

    def can_be_seen(self, piece: MergedRegion) -> bool:
        """Whether there is a way at all."""
        try:
            self.target(piece).coarse(STEP_RAD, ETAS, 0)
        except InfeasibleError:
            return False
        return True

    def cost_m(self, pieces: tuple[MergedRegion, ...], most_m: float = math.inf) -> float:
        """What seeing all of some pieces costs, about; inf where some cannot be seen.

        Where that is ``most_m`` at least, inf may be said, too: by the pieces alone, without ways between.
        """
        alone_m = 0.0
        # The smallest are those that no lanes fit into.
        for piece in sorted(pieces, key=lambda each: each.area.area):
            options = self.options(piece)
            if options is None:
                return math.inf
            alone_m += float(options.inner_m.min())
            if alone_m >= most_m:
                return math.inf
        found = [_cheapest(each) for each in map(self.options, pieces) if each is not None]
        return least_tour_m(found, self.around)


def wanted(piece: MergedRegion) -> BaseGeometry:
    """What of a piece is to be seen: the parts asked for, without the gaps between them."""
    if len(piece.originals) == 1 and piece.originals[0] is piece.area:
        return piece.area
    parts = [shapely.intersection(part, piece.area) for part in piece.originals]
    return shapely.union_all(parts, grid_size=GRID_M)


def divided(region: MergedRegion, trial: Pieces, *, whole: bool, enough: Stop) -> tuple[MergedRegion, ...]:
    """The region whole, in the parts that were merged, or cut further: as costs least.

    A corridor is cut at its bends, for lanes along it, where these can be flown; other shapes at reflex
    corners and beside holes, one cut after the other as long as that saves and until it is enough.

    Parameters
    ----------
    whole
        Not cut, where it can be seen so.
    """
    apart = tuple(_apart(region))
    along = tuple(itertools.chain.from_iterable(_legs(part) for part in apart))
    if any(leg is not part for leg, part in zip(along, apart, strict=False)):
        cost_m = trial.cost_m(along)
        if math.isfinite(cost_m):
            return along
    best: tuple[MergedRegion, ...] = (region,)
    cost_m = trial.cost_m(best)
    if whole and math.isfinite(cost_m):
        return best
    if (apart_m := trial.cost_m(apart)) < cost_m:
        best, cost_m = apart, apart_m
    while len(best) < MOST_PIECES and not (math.isfinite(cost_m) and enough()):
        trials = [
            (*best[:k], *(trial.cut(part.piece(piece)) for piece in cut), *best[k + 1 :])
            for k, part in enumerate(best)
            if not decompose.is_plain(_outline(part))
            for cut in decompose.cuts(_outline(part))
        ]
        costs = [trial.cost_m(each) for each in itertools.takewhile(lambda _: not enough(), trials)]
        if not costs or not min(costs) < (1.0 - LEAST_SAVING) * cost_m:
            return best
        cost_m = min(costs)
        best = trials[costs.index(cost_m)]
    return best


def crossed(region: MergedRegion, trial: Pieces) -> tuple[MergedRegion, ...]:
    """Each part twice: its lanes at a heading, and at one across it; at the pair that costs least.

    Raises
    ------
    InfeasibleError
        ``"approach"``: of the headings allowed none is across another; what lanes are refused for.
    """
    return tuple(itertools.chain.from_iterable(_crossed(part, trial) for part in _apart(region)))


def _crossed(part: MergedRegion, trial: Pieces) -> Iterator[MergedRegion]:
    found = trial.target(part).coarse(STEP_RAD, ETAS)
    angles_rad = np.unique(found.angles_rad)
    pairs = [(angle, angle + math.pi / 2.0) for angle in angles_rad.tolist()]
    if part.approach_rad is not None:
        pairs = [pair for pair in pairs if allowed(_half_circle(part.approach_rad), np.array(pair)).all()]
    costs_m = [sum(_at_m(part, angle, trial) for angle in pair) for pair in pairs]
    if not costs_m or not math.isfinite(min(costs_m)):
        raise InfeasibleError(
            "approach",
            part.label,
            "of the headings that may be flown none lies across another, as a cross-hatch asks for",
            "allow one at a right angle to another, or take the pattern lanes",
            part.centroid,
        )
    for angle in pairs[costs_m.index(min(costs_m))]:
        both = np.array([angle, angle + math.pi])
        kept = tuple(both[allowed(part.approach_rad, both)].tolist())
        yield replace(part, approach_rad=kept)


def _half_circle(angles_rad: Sequence[float]) -> tuple[float, ...]:
    """Headings and their opposites."""
    return (*angles_rad, *(angle + math.pi for angle in angles_rad))


def _at_m(part: MergedRegion, angle_rad: float, trial: Pieces) -> float:
    """What lanes at a heading cost at least; inf where there are none."""
    options = trial.target(part).options(np.array([angle_rad]), ETAS)
    return math.inf if options is None else float(options.inner_m.min())


def visits(piece: MergedRegion, trial: Pieces) -> Iterator[MergedRegion]:
    """A piece once for each visit asked for, from directions of its own where that can be flown."""
    for k in range(piece.revisits if piece.revisits > 1 else 0):
        visit = replace(piece, visit=(k, piece.revisits))
        yield visit if trial.can_be_seen(visit) else piece
    if piece.revisits == 1:
        yield piece


def _apart(region: MergedRegion) -> Sequence[MergedRegion]:
    """What was merged, each for itself; what touches stays one."""
    if len(region.originals) == 1:
        return (region,)
    whole = polygons_of(shapely.union_all(list(region.originals), grid_size=GRID_M))
    if len(whole) == len(region.originals):
        return region.split()
    return [region.piece(part) for part in whole]


def _legs(region: MergedRegion) -> Sequence[MergedRegion]:
    """A corridor cut at each bend of its axis, to be flown along it; itself where it is none."""
    axis = region.axis
    if axis is None or region.approach_rad is not None:
        return (region,)
    legs = decompose.legs(region.originals[0], axis)
    if legs is None:
        return (_along(region, axis),)
    return [_along(region.piece(leg), axis) for leg in legs]


def _along(leg: MergedRegion, axis: LineString) -> MergedRegion:
    """A leg to be flown along the axis within it, to and fro."""
    inside = [part for part in shapely.get_parts(leg.area.intersection(axis)) if part.length > 0.0]
    own = max(inside, key=lambda part: float(part.length), default=axis)
    # Legs reach a little over their cuts, round the bend.
    reach_m = min(2.0 * decompose.OVERLAP_M, own.length / 4.0)
    begin, end = own.interpolate(reach_m), own.interpolate(own.length - reach_m)
    angle_rad = math.atan2(end.y - begin.y, end.x - begin.x)
    return replace(leg, approach_rad=(angle_rad, angle_rad + math.pi))


def _outline(piece: MergedRegion) -> Polygon:
    """What of a piece has to be seen where that is one polygon; its hull of merged ones elsewhere."""
    parts = polygons_of(wanted(piece))
    return parts[0] if len(parts) == 1 else piece.area


def _cheapest(options: LaneOptions) -> Ends:
    kept = np.argsort(options.inner_m, kind="stable")[:OPTIONS_COMPARED]
    return options.entries[kept], options.exits[kept], options.inner_m[kept]
