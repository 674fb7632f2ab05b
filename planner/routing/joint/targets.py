"""From regions to the stops of a tour: parts and visits, each with the families of passes that see it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.coverage.alternatives import Target, families, parts_of, visits
from planner.coverage.merge import MergedRegion
from planner.coverage.sweeps import Side
from planner.errors import InfeasibleError
from planner.routing.joint import kernels
from planner.routing.joint.options import Options, Surroundings, make_options, roomy
from planner.sensors.sar import SarSensor

Floats = NDArray[np.float64]

#: Divisions of a region are compared at these headings and offsets,
STEP_RAD = math.radians(15.0)
ETAS = np.array([0.0, 0.5, 1.0])
#: by this many of each part's cheapest options,
OPTIONS_COMPARED = 48
#: in every order up to this many parts.
EXACT_UP_TO = 4
#: Headings tried where a coarse grid leaves no room for turns, and how many options with room are kept.
FINE_STEP_RAD = math.radians(2.5)
MOST_ROOMY = 100


def targets(
    region: MergedRegion,
    sensor: SarSensor,
    height_m: float,
    around: Surroundings,
    *,
    wide: bool = True,
    whole: bool = False,
) -> tuple[Target, ...]:
    """The stops that see one region; several where it is divided or to be visited again.

    Parameters
    ----------
    wide
        Whether more than two swaths, divisions and sweeps are allowed; without, the paper's neighbourhoods.
    whole
        Not to divide it, unless it cannot be seen otherwise.

    Raises
    ------
    InfeasibleError
        Where no pass may be flown that sees it.
    """
    known: dict[bytes, Options | None] = {}

    def options_of(part: MergedRegion) -> Options | None:
        key = part.area.wkb
        if key not in known:
            known[key] = _some(part, sensor, height_m, around, wide=wide)[1]
        return known[key]

    def estimate(parts: tuple[MergedRegion, ...]) -> float:
        options = [options_of(part) for part in parts]
        found = [_cheapest(o) for o in options if o is not None]
        return _tour_m(found, around) if len(found) == len(options) else math.inf

    undivided = options_of(region)
    parts: tuple[MergedRegion, ...] = (region,)
    if wide and (
        undivided is None or (not whole and (bool((_passes(undivided) > 1).all()) or region.axis is not None))
    ):
        parts = parts_of(region, estimate)
    found = []
    for part in parts:
        for visit in visits(part):
            sides, options = _some(visit, sensor, height_m, around, wide=wide)
            if options is None and visit.visit is not None:
                sides, options = _some(part, sensor, height_m, around, wide=wide)
                visit = part
            if options is None:
                raise refusal(region, around)
            found.append(Target(visit, sides))
    return tuple(found)


def can_be_flown(
    region: MergedRegion, sensor: SarSensor, height_m: float, around: Surroundings, *, wide: bool = True
) -> bool:
    """Whether some pass, or some sweep of the whole region, may be flown."""
    return _some(region, sensor, height_m, around, wide=wide)[1] is not None


def coarse_options(
    region: MergedRegion, sides: tuple[Side, ...], angles_rad: Floats, etas: Floats, around: Surroundings
) -> Options:
    """The options of one target to choose an order by.

    Where none has room to turn at both ends, those of a finer grid that have it are taken instead.

    Raises
    ------
    InfeasibleError
        Where no option keeps the hard constraints.
    """
    free = region.approach_rad is None
    allowed = angles_rad if region.approach_rad is None else np.asarray(region.approach_rad, dtype=np.float64)
    options = make_options(sides, allowed, etas, around)
    if options is None:
        options = make_options(sides, sides[0].angles_rad, np.linspace(0.0, 1.0, 9), around)
    if options is None:
        raise refusal(region, around)
    if _with_room(options, around).any():
        return options
    turned_rad = np.arange(-math.pi, math.pi - 1e-9, FINE_STEP_RAD, dtype=np.float64) if free else allowed
    finer = make_options(sides, turned_rad, np.linspace(0.0, 1.0, 9), around)
    kept = np.empty(0, dtype=np.int64) if finer is None else np.flatnonzero(_with_room(finer, around))
    if finer is None or len(kept) == 0:
        return options
    kept = kept[:: math.ceil(len(kept) / MOST_ROOMY)]
    return Options(*(getattr(finer, name)[kept] for name in Options.__slots__))


def refusal(region: MergedRegion, around: Surroundings) -> InfeasibleError:
    """What to say where every pass is forbidden."""
    return InfeasibleError(
        "area",
        region.label,
        "every pass that sees it leaves the operating area"
        if len(around.hard) + len(around.hard_polygons) == 0
        else "every pass that sees it leaves the operating area or enters a hard zone",
        "enlarge the area round it, or allow the other look side",
        region.centroid,
    )


def _some(
    region: MergedRegion, sensor: SarSensor, height_m: float, around: Surroundings, *, wide: bool
) -> tuple[tuple[Side, ...], Options | None]:
    """The first families with an option, and these options."""
    sides: tuple[Side, ...] = ()
    for sides in families(region, sensor, height_m, wide=wide):
        coarse = np.arange(-math.pi, math.pi - 1e-9, STEP_RAD, dtype=np.float64)
        if region.approach_rad is not None:
            coarse = np.asarray(region.approach_rad, dtype=np.float64)
        for angles_rad, count in ((coarse, 3), (sides[0].angles_rad, 3), (sides[0].angles_rad, 9)):
            options = make_options(sides, angles_rad, np.linspace(0.0, 1.0, count), around)
            if options is not None:
                return sides, options
    return sides, None


def _with_room(options: Options, around: Surroundings) -> NDArray[np.bool_]:
    """Which options have room for a full turn at both ends."""
    return roomy(options.entries, around) & roomy(options.exits, around)


def _passes(options: Options) -> NDArray[np.int64]:
    """How many passes each option takes."""
    of_sweeps = (options.lanes >= 0).sum(axis=1)
    of_others = np.where(np.isnan(options.eta_second), 1, 2)
    return np.asarray(np.where(of_sweeps > 0, of_sweeps, of_others), dtype=np.int64)


def _cheapest(options: Options) -> tuple[Floats, Floats, Floats]:
    kept = np.argsort(options.inner_m, kind="stable")[:OPTIONS_COMPARED]
    return options.entries[kept], options.exits[kept], options.inner_m[kept]


def _tour_m(found: list[tuple[Floats, Floats, Floats]], around: Surroundings) -> float:
    """Length of the cheapest open tour through one option of each part."""
    entries, exits, inner_m = (np.concatenate(column) for column in zip(*found, strict=True))
    offsets = np.concatenate([[0], np.cumsum([len(part[2]) for part in found])]).astype(np.int64)
    if len(found) == 1:
        return float(inner_m.min())
    between = kernels.transit_costs(exits, entries, around.radius_m, around.discs) + inner_m[None, :]
    nothing = np.zeros(len(inner_m))
    if len(found) <= EXACT_UP_TO:
        costs, _ = kernels.best_orders(inner_m, between, nothing, offsets)
        return float(costs.min())
    order = np.arange(len(found), dtype=np.int64)
    cost_m, _ = kernels.best_options(inner_m, between, nothing, offsets, order)
    return float(cost_m)
