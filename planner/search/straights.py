"""Lines of the published horizon and of others as strips of ground: what of them is flown straight.

A whole flight has its sensor on in straight flight alone. Arcs become corners, and what the turn at a corner
takes off the straights before and behind it is no strip.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Point
from shapely.ops import nearest_points

from planner.search.course import DiscSearch, Glider
from planner.search.families import Ground
from planner.search.horizon import VARIANTS, energy_horizon
from planner.search.programme import Pricing
from planner.search.values import Worth
from planner.vehicle.energy import ConstantPower, PowerModel

Floats = NDArray[np.float64]
Place = tuple[float, float]

#: A line is followed by its strips this closely, by the width of the swath.
FOLLOWED = 0.12
#: A strip is no shorter than this, by the width of the swath.
LEAST = 0.25
#: Corners sharper than this leave no straight beside them that a turn could leave.
SHARPEST_RAD = 3.0
#: The horizon turns no more than half round in the time that it keeps a turn rate.
MOST_TURN_RAD = math.pi
#: Flights with nothing to limit them are planned for so many times the way that sees all ground once.
UNLIMITED = 1.5


def strips_along(line: Floats, radius_m: float, width_m: float) -> Floats:
    """Middle lines (N, 2, 2) of the straight parts of a line (M, 2), in flight order.

    Parameters
    ----------
    radius_m
        Of the turns at its corners.
    width_m
        Of the swath.
    """
    corners = shapely.get_coordinates(shapely.simplify(LineString(line), FOLLOWED * width_m))
    sides = np.diff(corners, axis=0)
    lengths_m = np.hypot(*sides.T)
    kept = lengths_m > 1e-6
    corners, sides = np.vstack([corners[:-1][kept], corners[-1:]]), sides[kept]
    lengths_m = lengths_m[kept]
    if not len(sides):
        return np.empty((0, 2, 2))
    courses = np.arctan2(sides[:, 1], sides[:, 0])
    bends = np.abs(np.remainder(np.diff(courses) + math.pi, math.tau) - math.pi)
    cuts_m = radius_m * np.tan(np.minimum(bends, SHARPEST_RAD) / 2.0)
    # Half of a short side at most: the turn is then flown wider than the corner.
    before_m = np.minimum(np.concatenate([[0.0], cuts_m]), 0.5 * lengths_m)
    after_m = np.minimum(np.concatenate([cuts_m, [0.0]]), 0.5 * lengths_m)
    along = sides / lengths_m[:, None]
    strips = np.stack(
        [corners[:-1] + before_m[:, None] * along, corners[1:] - after_m[:, None] * along], axis=1
    )
    long = lengths_m - before_m - after_m >= LEAST * width_m
    return np.asarray(strips[long])


def glider_of(pricing: Pricing, radius_m: float, straight_m: float) -> Glider:
    """An aircraft as the published horizon sees it, with energy for so much of straight flight."""
    aircraft = pricing.model.aircraft
    power: PowerModel = aircraft.power or ConstantPower(1.0)
    load = Glider.load_of(aircraft.airspeed_m_s, radius_m)
    bare = Glider(power, aircraft.airspeed_m_s, load, 0.0)
    return replace(bare, energy_j=bare.energy_of_j(straight_m, 0.0))


def horizon_strips(
    name: str, ground: Ground, worth: Worth, width_m: float, pricing: Pricing, budget_m: float
) -> Floats:
    """Strips of the published receding horizon over ground, or of one of its variants.

    It enters the ground where that is nearest to the start, and leaves it where it is nearest to the end; in
    the time that it keeps a turn rate it flies the width of the swath.

    Parameters
    ----------
    budget_m
        For the whole flight.
    """
    enter, leave = (_nearest(ground, place) for place in (pricing.start, pricing.end))
    spare_m = min(budget_m, UNLIMITED * float(ground.area) / width_m)
    spare_m -= math.dist(pricing.start, enter) + math.dist(leave, pricing.end)
    radius_m = max(pricing.model.turn_radius_m, width_m / MOST_TURN_RAD)
    if spare_m <= max(math.dist(enter, leave), width_m):
        return np.empty((0, 2, 2))
    glider = glider_of(pricing, radius_m, spare_m)
    disc = DiscSearch(ground, worth, 0.5 * width_m, enter, leave, glider)
    heading = _towards(enter, pricing.start, ground)
    flown = energy_horizon(disc, heading, VARIANTS[name], width_m / glider.airspeed_m_s)
    return strips_along(flown.points, radius_m, width_m)


def _nearest(ground: Ground, place: Place) -> Place:
    found = nearest_points(ground, Point(place))[0]
    return (float(found.x), float(found.y))


def _towards(enter: Place, start: Place, ground: Ground) -> float:
    """On from the start, or to the middle of the ground where it starts over it."""
    if math.dist(enter, start) > 1.0:
        return math.atan2(enter[1] - start[1], enter[0] - start[0])
    middle = ground.centroid
    return math.atan2(middle.y - enter[1], middle.x - enter[0])
