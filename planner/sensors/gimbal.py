"""From the angles of a mount with two axes to the line of sight, and back.

Axes of the aircraft: x forward, y to the left, z up. The line of sight at rest is y; α turns it round x (down
where negative), θ round z (backwards where positive, towards −x). A radar's squint axis is carried by the
tilted one, a camera's tilt axis by the turning one. Displacements of the axes are left out, as in the paper.

Source: Stecz and Gromada 2020 (see ``optics``), section 3.2, equations 11 to 16.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Order = Literal["radar", "camera"]
Vector = NDArray[np.float64]

_AT_REST = np.array([0.0, 1.0, 0.0])


def _tilt(alpha_rad: float) -> Vector:
    """T_α of equation 12."""
    c, s = math.cos(alpha_rad), math.sin(alpha_rad)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def _turn(theta_rad: float) -> Vector:
    """T_θ of equation 12."""
    c, s = math.cos(theta_rad), math.sin(theta_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def line_of_sight(alpha_rad: float, theta_rad: float, order: Order) -> Vector:
    """Unit vector looked along: T_α T_θ e for a radar (equation 11), T_θ T_α e for a camera (equation 13)."""
    tilt, turn = _tilt(alpha_rad), _turn(theta_rad)
    sight: Vector = (tilt @ turn if order == "radar" else turn @ tilt) @ _AT_REST
    return sight


def angles(sight: ArrayLike, order: Order) -> tuple[float, float]:
    """α and θ, in radians, that look along a vector (equations 14 to 16 for a radar).

    The arc tangents are taken with both signs. Equation 16 is printed as atan(y / x), which has its zero
    along x; here θ counts from y, as equation 11 does. Straight along the first axis the other angle does
    not matter, and is 0.

    Raises
    ------
    ValueError
        The vector has no direction.
    """
    x, y, z = np.asarray(sight, dtype=np.float64)
    length = math.sqrt(x * x + y * y + z * z)
    if not (math.isfinite(length) and length > 0.0):
        raise ValueError("a line of sight has a direction")
    if order == "camera":
        theta_rad = math.atan2(-x, y) if x or y else 0.0
        return math.atan2(z, math.hypot(x, y)), theta_rad
    alpha_rad = math.atan2(z, y) if y or z else 0.0
    turned = _tilt(-alpha_rad) @ np.array([x, y, z])
    return alpha_rad, math.atan2(-turned[0], turned[1])
