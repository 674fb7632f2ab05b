"""What the lower bound asks of every tour: passes that must be flown, each one of several families."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.bounds import cells_kernels as kernels
from planner.coverage.strips.classify import ROUNDING_M, spans_at
from planner.coverage.strips.segments import Neighbourhood
from planner.coverage.strips.sweeps import Side, Sweep
from planner.route import Look, Terminal
from planner.sensors.sar import SarSensor
from planner.sensors.strip import Strip, strip_on

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Where strips that change with the heading are sampled.
HEADINGS_RAD = np.arange(720) * (2.0 * math.pi / 720)
#: Regions as wide as more strips than this count by one place alone, of about this size.
MOST_COUNTED, PLACE_M = 40, 0.01
#: A pair of strips has no least width that asks for it.
ANY_WIDTH = 1e6


@dataclass(frozen=True, slots=True)
class Seen:
    """What seeing all of a region takes, in passes of whatever directions.

    Parameters
    ----------
    by_area_m, around_m
        What passes that together see all of the region are long at least, and each of them more, sensor on
        before and after the ground, and settling.
    fewest
        How many they are at least, in whatever directions.
    extent
        Where they begin and end: least and most east and north, (2, 2).
    one_place
        Whether the region is so wide that ring and families are those of one place in it.
    joined
        Whether passes over regions near it count with its own.
    """

    by_area_m: float
    around_m: float
    fewest: int
    extent: Floats
    one_place: bool
    joined: bool


@dataclass(frozen=True, slots=True)
class Node:
    """A pass that every tour flies: the families it may be of.

    Parameters
    ----------
    region
        Which one, counted from 0.
    ring, hull
        The region's and its convex hull's, (V, 2), counter-clockwise, relative to ``middle``.
    families
        See ``cells_kernels``, (F, ``FIXED``) or wider.
    group
        Of each family: the passes of one region are of families of one group, int64 (F,).
    approach_rad
        The headings allowed; None for any.
    strip
        0 where the region asks for one pass. Of several, counted to the right from the left of the northward
        of both directions they are flown in: 1 for the first strip, 2 for the last, 2 + k for the one k after
        the first.
    seen
        What seeing all of the region takes.
    """

    region: int
    ring: Floats
    hull: Floats
    families: Floats
    group: Ints
    approach_rad: tuple[float, ...] | None
    strip: int
    seen: Seen

    @property
    def middle(self) -> Floats:
        """Where the region is."""
        return np.asarray(self.families[0, 6:8], dtype=np.float64)

    def boxes(self, headings: int) -> Floats:
        """Boxes of that many headings that hold all its passes, (B, 5)."""
        alpha = math.pi / headings
        thetas: Floats = (2.0 * np.arange(headings, dtype=np.float64) + 1.0) * alpha
        alphas: Floats = np.full(headings, alpha)
        if self.approach_rad is not None:
            thetas = np.asarray(self.approach_rad, dtype=np.float64)
            alphas = np.zeros(len(thetas))
        family, way = np.nonzero(self._see(thetas))
        half = np.full(len(family), 0.5)
        return np.stack([family.astype(np.float64), thetas[way], alphas[way], half, half], axis=1)

    def _see(self, thetas: Floats) -> Flags:
        """Whether passes of families, flown that way, see the strip, (F, H); of several one the first."""
        side, count, index = (self.families[:, k, None] for k in (1, 8, 10))
        northward = np.mod(thetas, 2.0 * math.pi) < math.pi - 1e-9
        from_left = np.where((side > 0.0) == northward, index, count - 1.0 - index)
        if self.strip < 3:
            seen = from_left == (count - 1.0 if self.strip == 2 else 0.0)
        else:
            seen = (from_left == self.strip - 2.0) & (from_left < count - 1.0)
        return np.asarray(seen | (self.families[:, 0, None] == kernels.WHOLE), dtype=np.bool_)


def nodes(
    sides: Sequence[Side],
    settle_m: float,
    region_index: int,
    most: int = 8,
    ground: BaseGeometry | None = None,
) -> list[Node]:
    """The passes one region, part of one or visit to one asks for; of many strips no more than ``most``.

    ``ground`` is what its passes and those over regions near it see together; None for the region alone.
    """
    region, sensor, height_m = sides[0].region, sides[0].sensor, sides[0].height_m
    strip = strip_on(sensor, height_m, HEADINGS_RAD if sensor.crabs else 0.0, "right")
    ring, middle, around = _rings(region.area)
    extras = sorted({side.extra for side in sides if isinstance(side, Sweep)})
    fewest = max(math.ceil((_narrowest_m(around) - ROUNDING_M) / float(strip.swath_m.max())), 1)
    widest_m, swath_m = 2.0 * float(np.hypot(*around.T).max()), float(strip.swath_m.min())
    one_place = widest_m > MOST_COUNTED * swath_m
    run_in_m, run_out_m = float(strip.run_in_m.min()), float(strip.run_out_m.min())
    reach_m = math.hypot(
        float((strip.near_m + strip.swath_m).max()),
        settle_m + max(float(np.abs(strip.run_in_m).max()), float(np.abs(strip.run_out_m).max())),
    )
    seen_area = region.area if ground is None else ground
    least, furthest = np.array(seen_area.bounds).reshape(2, 2)
    by_area_m = seen_area.area / float(strip.swath_m.max())
    seen = Seen(
        by_area_m,
        max(run_in_m + run_out_m, 0.0) + settle_m,
        max(math.ceil(region.area.area / float(strip.swath_m.max()) / widest_m - 1e-9), 1),
        np.stack([least - reach_m, furthest + reach_m]),
        one_place,
        ground is not None,
    )
    if one_place:
        # However many strips there are, some pass sees it.
        place = region.area.representative_point().buffer(PLACE_M, quad_segs=1)
        ring, middle, around = _rings(place)
        extras = []
    widest = 1 if one_place else math.ceil(widest_m / swath_m)
    # Kind, how many strips, how many of them beyond the fewest, which one, group.
    kinds: list[tuple[float, int, float, int, int]] = []
    strips = [fewest + extra for extra in extras]
    turns = {side.turns for side in sides if isinstance(side, Neighbourhood)}
    if one_place or 0 in turns or 1 in strips:
        kinds.append((kernels.WHOLE, 1, ANY_WIDTH, 0, 0))
        strips.append(1)
    if 1 in turns and not one_place:
        kinds.append((kernels.LONG, 2, ANY_WIDTH, 0, 1))
        strips.append(2)
    for extra in extras:
        for count in range(2, widest + extra + 1):
            group = 2 + len(kinds)
            kinds += [(kernels.STRIP, count, float(extra), index, group) for index in range(count)]
    rows = []
    for look in sensor.looks:
        (near_m, swath_m, run_in_m, run_out_m), more = _passes(sensor, height_m, look)
        fixed = (1.0 if look == "right" else -1.0, near_m, swath_m, run_in_m, settle_m, *middle)
        rows += [
            (kind, *fixed, count, extra, index, run_out_m, *more) for kind, count, extra, index, _ in kinds
        ]
    families = np.array(rows, dtype=np.float64)
    groups = np.array([kind[4] for _ in sensor.looks for kind in kinds], dtype=np.int64)
    flown = min(min(strips), max(most, 2))
    return [
        Node(region_index, ring, around, families, groups, region.approach_rad, strip, seen)
        for strip in (range(1, flown + 1) if flown > 1 else (0,))
    ]


def _passes(sensor: SarSensor, height_m: float, look: Look) -> tuple[tuple[float, ...], Floats]:
    """Near edge, swath, run-in and run-out of passes, and samples where they change with the heading."""
    if not sensor.crabs:
        values = strip_on(sensor, height_m, 0.0, look)
        return tuple(float(value[0]) for value in _columns(values)), np.empty(0)
    samples = np.stack(_columns(strip_on(sensor, height_m, HEADINGS_RAD, look)))
    # Between two samples a value is off the straight line through them by half a step's worth at most.
    off_m = np.array(slopes_m(sensor, height_m)) * math.pi / len(HEADINGS_RAD)
    return tuple(samples.mean(axis=1)), np.concatenate([off_m, samples.ravel()])


def _columns(strip: Strip) -> tuple[Floats, Floats, Floats, Floats]:
    return strip.near_m, strip.swath_m, strip.run_in_m, strip.run_out_m


def slopes_m(sensor: SarSensor, height_m: float) -> tuple[float, float, float, float]:
    """How much near edge, swath, run-in and run-out can change at most, for a radian of the heading.

    The crab ψ = asin(k sin δ) changes by no more than k for a radian of the heading, k the wind by the
    airspeed. A ray's place beside the track, d (tan θ cos ψ − tan θ_sq sin ψ / cos θ), changes with ψ by no
    more than d √(tan² θ + tan² θ_sq / cos² θ). Ground beside the track at y is seen x ahead; with ψ that
    changes by y + |x| tan(|ψ| + |θ_sq|) at most, with y by tan(|ψ| + |θ_sq|). The aperture's derivative is
    that of ``sar_modes.crabbed_aperture_m``.
    """
    crab_rad, margin_rad = math.asin(min(sensor.drift, 1.0)), sensor.pointing_margin_rad
    low_m = height_m + sensor.relief_m
    squint = abs(math.tan(sensor.squint_rad))
    edges_m = [
        low_m * math.hypot(math.tan(look_rad), squint / math.cos(look_rad))
        for look_rad in (sensor.steepest_rad, sensor.flattest_rad)
    ]
    leaning = math.tan(min(crab_rad + abs(sensor.squint_rad) + margin_rad, math.radians(89.9)))
    reach_m = math.hypot(edges_m[1], low_m) * leaning * (1.0 + leaning**2)
    lead_m = edges_m[1] + reach_m * leaning + leaning * max(edges_m)
    cos, sin = math.cos(sensor.squint_rad), math.sin(abs(sensor.squint_rad)) * math.sin(sensor.incidence_rad)
    turned = max(cos * math.cos(crab_rad) - sin * math.sin(crab_rad), 1e-3)
    abeam_m = low_m / math.cos(sensor.incidence_rad) * sensor.azimuth_beamwidth_rad / cos
    along_m = lead_m + abeam_m * math.hypot(cos, sin) / turned**2 / 2.0
    k = sensor.drift
    return k * edges_m[0], k * sum(edges_m), k * along_m, k * along_m


def divided(box: Floats, cell: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """The parts of a box, (P, 5), and their slopes, (P, 2): a slope is by a whole half-width."""
    parts = kernels.parts(box, cell)
    widths = box[[2, 4]]
    smaller = np.divide(parts[:, [2, 4]], widths, out=np.zeros((len(parts), 2)), where=widths > 0.0)
    return parts, slopes * smaller


def _rings(area: BaseGeometry) -> tuple[Floats, Floats, Floats]:
    """The outer ring of a polygon about its middle, that middle, and its convex hull's ring."""
    ring = _ring(area)
    middle = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
    return ring - middle, middle, _ring(shapely.convex_hull(shapely.Polygon(ring - middle)))


def _ring(area: BaseGeometry) -> Floats:
    """The outer ring of a polygon, counter-clockwise, (V, 2)."""
    if not isinstance(area, shapely.Polygon):
        raise TypeError(f"a region has an area, not a {area.geom_type}")
    outer = shapely.geometry.polygon.orient(shapely.Polygon(area.exterior)).exterior
    return np.asarray(shapely.get_coordinates(outer)[:-1], dtype=np.float64)


def _narrowest_m(hull: Floats) -> float:
    """Least width of a convex ring (V, 2): across one of its edges."""
    east, north = (np.roll(hull, -1, axis=0) - hull).T
    return float(spans_at(hull, np.arctan2(north, east)).across_m.min())


def terminal(where: Terminal) -> Floats:
    """East, north, 1 where the heading is fixed, heading; (4,)."""
    angle_rad = where.angle_rad
    return np.array([*where.position, 0.0 if angle_rad is None else 1.0, angle_rad or 0.0])
