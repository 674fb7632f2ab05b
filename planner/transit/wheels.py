"""Circles to fly round: those that hug a zone, and those an aircraft turns on at its ends.

Every circle stands for two wheels of ``tangent_kernels``, one each way round.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.polygon import orient

from planner.airspace.zones import TOUCH_M, Ground, KeepOut, ring_edges
from planner.dubins.path import Path, Segment
from planner.route import Anchor, Pose
from planner.transit.wheels_kernels import touching

#: Round a corner sharper than this, and round small discs, circles stand every so many radians.
STEP_RAD = math.radians(30.0)

#: Zones are this much smaller in the search, so that a line may touch them.
SHRINK_M = 0.75 * TOUCH_M

#: Straights flown before the first turn (after the last) that are tried, in radii.
LEADS_RADII = (0.5, 1.0, 2.0, 4.0)

#: Zones' circles nearest to an end's circle that a middle arc is sought for.
NEAREST = 12

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Obstacles:
    """What the search flies round, and the circles to do it on.

    ``discs`` (K, 3) and ``edges`` (E, 4) may not be entered or crossed; ``circles`` (C, 3): east_m, north_m,
    radius_m.
    """

    discs: Array
    edges: Array
    circles: Array


def obstacles_of(zones: KeepOut, radius_m: float) -> Obstacles:
    """Zones as the search needs them, with circles of ``radius_m`` or more round each."""
    discs = zones.disc_array()[zones.disc_array()[:, 2] > SHRINK_M]
    edges, corners = _polygon_model(zones.ground(), radius_m)
    return Obstacles(
        discs - np.array([0.0, 0.0, SHRINK_M]),
        edges,
        np.concatenate([*(_disc_circles(disc, radius_m) for disc in discs), corners]),
    )


def _disc_circles(disc: Array, radius_m: float) -> Array:
    """The disc's own circle, or where it is too tight, wider ones that touch the disc from around it."""
    east_m, north_m, disc_m = (float(value) for value in disc)
    if disc_m >= radius_m:
        return np.array([[east_m, north_m, disc_m]])
    angles = np.arange(0.0, 2.0 * math.pi - 1e-9, STEP_RAD)
    off_m = radius_m - disc_m
    return np.column_stack(
        [east_m + off_m * np.cos(angles), north_m + off_m * np.sin(angles), np.full(len(angles), radius_m)]
    )


@lru_cache(maxsize=1024)
def _polygon_model(ground: Ground, radius_m: float) -> tuple[Array, Array]:
    """Edges to test, and circles through the corners one flies round."""
    side = -1.0 if ground.free else 1.0
    loose = ground.closed.buffer(-side * SHRINK_M, join_style="mitre")
    circles: list[tuple[float, float, float]] = []
    for part in shapely.get_parts(ground.shape):
        # What is forbidden lies to the left of every ring.
        oriented = orient(part, side)
        for ring in (oriented.exterior, *oriented.interiors):
            circles.extend(_corner_circles(np.asarray(ring.coords)[:-1, :2], radius_m))
    edges = ground.edges if loose.is_empty else ring_edges(loose)
    return edges, np.array(circles, dtype=np.float64).reshape(-1, 3)


def _corner_circles(corners: Array, radius_m: float) -> list[tuple[float, float, float]]:
    """Circles that pass through each protruding corner, touching lines that the path may take there."""
    circles = []
    into = corners - np.roll(corners, 1, axis=0)
    directions = np.arctan2(into[:, 1], into[:, 0])
    for i, (east_m, north_m) in enumerate(corners):
        turn = math.remainder(float(directions[(i + 1) % len(corners)] - directions[i]), 2.0 * math.pi)
        if turn <= 1e-9:
            continue
        pieces = 0 if turn < 0.5 * STEP_RAD else math.ceil(turn / STEP_RAD)
        for share in [0.5] if pieces == 0 else np.linspace(0.0, 1.0, pieces + 1):
            # Flown with the zone to the left: the centre of the turn lies to the left, too.
            angle = float(directions[i]) + share * turn
            circles.append(
                (east_m - radius_m * math.sin(angle), north_m + radius_m * math.cos(angle), radius_m)
            )
    return circles


@dataclass(frozen=True, slots=True)
class End:
    """Ways to leave the start, or to reach the goal.

    ``wheels`` (W, 3): signed circles; ``entries``: for each way the wheel, the direction on it, and the
    straight flown between the anchor and the wheel.
    """

    wheels: Array
    entries: tuple[tuple[int, float, Segment | None], ...]

    @property
    def turns(self) -> Array:
        """The wheels one may start (end) on, shape (T, 3)."""
        return self.wheels[[wheel for wheel, _, _ in self.entries]]


def end_of(anchor: Anchor, radius_m: float, zones: KeepOut, goal: bool) -> End:
    """Turning circles at an anchor, and what helps to leave (reach) it.

    With a direction given: the circles on either side, at the anchor and after (before) some straights, and
    circles that touch the first two, for a turn the other way beforehand. With a free direction: the place
    itself, and circles through it.
    """
    wheels: list[tuple[float, float, float]] = []
    entries: list[tuple[int, float, Segment | None]] = []

    def add(pose: Pose, lead: Segment | None, helpers: bool) -> None:
        for s in (1.0, -1.0):
            centre_e = pose.east_m - s * radius_m * math.sin(pose.angle_rad)
            centre_n = pose.north_m + s * radius_m * math.cos(pose.angle_rad)
            entries.append((len(wheels), pose.angle_rad, lead))
            wheels.append((centre_e, centre_n, s * radius_m))
            for angle in np.arange(0.0, 2.0 * math.pi - 1e-9, STEP_RAD) if helpers else ():
                wheels.append(
                    (
                        centre_e + 2.0 * radius_m * math.cos(angle),
                        centre_n + 2.0 * radius_m * math.sin(angle),
                        -s * radius_m,
                    )
                )

    if anchor.angle_rad is None:
        entries.append((0, 0.0, None))
        wheels.append((anchor.east_m, anchor.north_m, 0.0))
        for angle in np.arange(0.0, 2.0 * math.pi - 1e-9, STEP_RAD):
            add(Pose(anchor.east_m, anchor.north_m, float(angle)), None, False)
    else:
        pose = Pose(anchor.east_m, anchor.north_m, anchor.angle_rad)
        add(pose, None, True)
        for lead_radii in LEADS_RADII:
            lead = Segment("straight", pose, lead_radii * radius_m)
            if goal:
                back = lead.at(-lead.length_m)
                lead = Segment("straight", back, lead.length_m)
            if zones.clear(Path((lead,))):
                add(lead.start if goal else lead.end, lead, False)
    return End(np.array(wheels, dtype=np.float64), tuple(entries))


def between(ends: Array, others: Array, radius_m: float) -> Array:
    """Wheels that touch an end's wheel and one other of the same sense: the middle of three arcs.

    Parameters
    ----------
    ends, others
        Wheels, shapes (A, 3) and (B, 3); only the nearest few of ``others`` count.
    radius_m
        Radius of the wheels between, flown the other way.

    Returns
    -------
    ndarray
        Wheels, shape (C, 3).
    """
    middles: Array = touching(ends, others, radius_m, NEAREST)
    return middles
