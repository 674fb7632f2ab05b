"""Flying over the ground in a steady wind.

The course is kept and the nose points into the wind by the crab angle (the wind triangle). Where δ is the
angle from the direction the air moves to, to the course, V the airspeed and W the wind::

    crab = asin(W sin δ / V)          ground speed = W cos δ + √(V² - W² sin² δ)

On a line that climbs m metres for each over the ground, the velocity through the air, (v, v m) less the wind,
is still as long as the airspeed, and for every V > W there is one such v > 0, however steep the line is::

    (1 + m²) v² - 2 v W cos δ + W² = V²

A turn that is an arc over the ground is none in the air: at ground speed v the aircraft needs the sideways
acceleration v² / (r cos crab), most of it downwind, where v = V + W. An arc is flyable in any wind direction
where its radius is at least ((V + W) / V)² times the tightest turn in still air.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.airspace.values import Wind
from planner.errors import InfeasibleError
from planner.route import Line, LinePiece

Array = NDArray[np.float64]

#: Times on arcs are Gauss-Legendre sums over pieces of at most this turn.
PIECE_RAD = math.radians(30.0)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)

#: Directions over which the slowness of a full turn is averaged.
CIRCLE_RAD = np.linspace(0.0, 2.0 * math.pi, 360, endpoint=False)


def crab_rad(course_rad: ArrayLike, airspeed_m_s: float, wind: Wind) -> Array:
    """Heading less course, positive to the left, of the courses given."""
    delta = np.asarray(course_rad, dtype=np.float64) - wind.toward_rad
    return np.asarray(np.arcsin(np.sin(delta) * (wind.speed_m_s / airspeed_m_s)), dtype=np.float64)


def ground_speed_m_s(course_rad: ArrayLike, airspeed_m_s: float, wind: Wind, slope: float = 0.0) -> Array:
    """Speed over the ground on the courses given; the wind must be slower than the airspeed.

    Parameters
    ----------
    slope
        Metres of climb, or of descent where negative, for one over the ground.
    """
    delta = np.asarray(course_rad, dtype=np.float64) - wind.toward_rad
    along_m_s = wind.speed_m_s * np.cos(delta)
    steep = 1.0 + slope * slope
    left = (airspeed_m_s - wind.speed_m_s) * (airspeed_m_s + wind.speed_m_s)
    root_m_s = np.sqrt(along_m_s**2 + steep * left)
    # Against the wind the root and what is taken from it are all but equal: there in the form that adds.
    return np.where(
        along_m_s < 0.0, left / (root_m_s - np.minimum(along_m_s, 0.0)), (along_m_s + root_m_s) / steep
    )


def no_headway(name: str, wind: Wind, airspeed_m_s: float) -> InfeasibleError:
    """The refusal of an aircraft that is not faster than the wind, so that some courses cannot be flown."""
    return InfeasibleError(
        "wind",
        name,
        f"the wind of {wind.speed_m_s:g} m/s is not slower than its airspeed of {airspeed_m_s:g} m/s: "
        "against it no ground is gained",
        f"Wait for a wind under {airspeed_m_s:g} m/s or fly faster.",
    )


def held_speed_m_s(course_rad: ArrayLike, airspeed_m_s: float, wind: Wind, sharing: float) -> Array:
    """Speed over the ground, on the courses given, of what holds that of still air for as long as it can.

    What hovers does: its tilt, which its autopilot limits, lets it through the air at ``airspeed_m_s`` and
    no faster, so the wind ahead or beside takes of its speed, and the wind behind adds nothing. Its nose
    stays on the course; the parts of its airspeed along and across it, u and v, share the tilt::

        u^p + v^p = V^p

    Parameters
    ----------
    sharing
        p: 2 where drag goes with the airspeed whatever its direction (the wind triangle).
    """
    delta = np.asarray(course_rad, dtype=np.float64) - wind.toward_rad
    across = np.abs(np.sin(delta)) * wind.speed_m_s / airspeed_m_s
    ahead_m_s = airspeed_m_s * (1.0 - across**sharing) ** (1.0 / sharing)
    return np.minimum(wind.speed_m_s * np.cos(delta) + ahead_m_s, airspeed_m_s)


def duration_s(path: Line, airspeed_m_s: float, wind: Wind, slope: float = 0.0) -> float:
    """Time to fly a line, which may climb all along; see ``ground_speed_m_s``."""
    if wind.speed_m_s == 0.0:
        return path.length_m * math.hypot(1.0, slope) / airspeed_m_s
    return math.fsum(_segment_s(segment, airspeed_m_s, wind, slope) for segment in path.segments)


def _segment_s(segment: LinePiece, airspeed_m_s: float, wind: Wind, slope: float) -> float:
    course_rad, turn_rad = segment.start.angle_rad, segment.turn_rad
    pieces = max(1, math.ceil(abs(turn_rad) / PIECE_RAD))
    if turn_rad == 0.0:
        return segment.length_m / float(ground_speed_m_s(course_rad, airspeed_m_s, wind, slope))
    middles = (np.arange(pieces) + 0.5) / pieces
    shares = middles[:, None] + 0.5 * NODES / pieces
    speeds = ground_speed_m_s(course_rad + turn_rad * shares, airspeed_m_s, wind, slope)
    return segment.length_m * float((WEIGHTS / speeds).sum()) / (2.0 * pieces)


def still_air_factor(course_rad: ArrayLike, airspeed_m_s: float, wind: Wind) -> Array:
    """Metres through the air for one over the ground, on the courses given: time by airspeed."""
    return airspeed_m_s / ground_speed_m_s(course_rad, airspeed_m_s, wind)


def still_air_costs(lengths_m: Array, begins: Array, ends: Array, airspeed_m_s: float, wind: Wind) -> Array:
    """Lengths of transits as metres through the air, about.

    What is flown from place to place counts by its course; what is flown besides, turning, by the mean over
    all courses.

    Parameters
    ----------
    lengths_m
        Over the ground, shape (N, M) or one that ``begins`` and ``ends`` give.
    begins, ends
        east_m, north_m in the first two columns, broadcast against each other: (N, 1, …) and (1, M, …).
    """
    if wind.speed_m_s == 0.0:
        return lengths_m
    offset = ends[..., :2] - begins[..., :2]
    direct_m = np.hypot(offset[..., 0], offset[..., 1])
    along = still_air_factor(np.arctan2(offset[..., 1], offset[..., 0]), airspeed_m_s, wind)
    turning = float(still_air_factor(CIRCLE_RAD, airspeed_m_s, wind).mean())
    return np.asarray(direct_m * along + (lengths_m - direct_m) * turning, dtype=np.float64)
