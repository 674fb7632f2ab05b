"""Which way a scenario lies: the local frame turned so that nothing of a plan hangs on where north is.

Arcs are cut from some azimuth on, cells are laid along axes, headings are tried from some first one: all
that begins at the frame's axes. Where those lie as the scenario does, the same scenario turned or elsewhere
is the same numbers, but for rounding and the Earth's curvature.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon

from planner.frames import LocalFrame
from planner.geojson.sheet import LonLat

Floats = NDArray[np.float64]

#: Of rectangles round everything those hardly larger than the least are told apart by what lies in them.
ALIKE = 1e-3
#: Places are told apart by these parts of the rectangle's size.
PART = 1e-5
#: An edge straight in degrees is bent by the Earth's curvature: by no more of everything's size than this.
BENT = 3e-3
#: The origin is written with so many digits: a tenth of a millimetre.
DIGITS = 9


def lying(flat: LocalFrame, features: Sequence[Sequence[LonLat]]) -> LocalFrame:
    """A frame along the least rectangle round everything, from its middle to where most features lie.

    Parameters
    ----------
    flat
        A frame near them.
    features
        Places of each, longitude and latitude, one at least.
    """
    # Hulls: of a shape cut in two, or with places on its edges, nothing is another way.
    places = flat.to_local(np.array([place for each in features for place in each]))
    parts = np.split(places, np.cumsum([len(each) for each in features])[:-1])
    hulls = shapely.convex_hull(np.array([shapely.multipoints(each) for each in parts], dtype=object))
    at = shapely.get_coordinates(shapely.centroid(hulls))
    hull = shapely.convex_hull(shapely.geometrycollections(hulls))
    if isinstance(hull, Polygon):
        corners = shapely.get_coordinates(hull)[:-1]
        outline = _cornered(corners, BENT * float(np.ptp(corners, axis=0).max()))
        along = np.roll(outline, -1, axis=0) - outline
    elif isinstance(hull, LineString):
        corners = shapely.get_coordinates(hull)
        along = corners[-1:] - corners[:1]
    else:
        return flat
    along = along / np.hypot(*along.T)[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    own = np.stack([corners @ along.T, corners @ across.T])
    sizes, middles = np.ptp(own, axis=1), 0.5 * (own.max(axis=1) + own.min(axis=1))
    areas, size = sizes[0] * sizes[1], float(np.hypot(*sizes).min())
    alike = np.flatnonzero(areas <= (1.0 + ALIKE) * areas.min() + PART * size**2)
    mean, square = at.mean(axis=0), at.T @ at / len(at)

    def off(k: int, quarter: int) -> tuple[float, float, float, float]:
        """How far to its first axis most places lie, and how far from each other; the least goes first."""
        axes = [along[k], across[k], -along[k], -across[k]]
        first = axes[quarter]
        middle = middles[0, k] * along[k] + middles[1, k] * across[k]
        aside = float((mean - middle) @ first)
        spread = math.sqrt(max(float(first @ square @ first) - float(mean @ first) ** 2, 0.0))
        angle_rad = math.atan2(first[1], first[0])
        return (-round(aside / (PART * size)), -round(spread / (PART * size)), angle_rad, int(k))

    _, _, turned_rad, k = min(off(int(k), quarter) for k in alike for quarter in range(4))
    middle = middles[0, int(k)] * along[int(k)] + middles[1, int(k)] * across[int(k)]
    first_m = 0.5 * size * np.array([math.cos(turned_rad), math.sin(turned_rad)])
    here, ahead = flat.to_wgs84(np.stack([middle, middle + first_m]))
    upright = LocalFrame(*np.round(here, DIGITS).tolist())
    # Grid north there is another than at the other frame's origin.
    (west_m, south_m), (east_m, north_m) = upright.to_local(np.stack([here, ahead])).tolist()
    return replace(upright, turned_rad=math.atan2(north_m - south_m, east_m - west_m))


def _cornered(outline: Floats, least_m: float) -> Floats:
    """A convex outline (N, 2) without corners that are hardly any, the flattest first; three at least."""
    while len(outline) > 3:
        before, after = np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0)
        chord, off = after - before, outline - before
        highs_m = np.abs(chord[:, 0] * off[:, 1] - chord[:, 1] * off[:, 0]) / np.hypot(*chord.T)
        flattest = int(np.argmin(highs_m))
        if highs_m[flattest] >= least_m:
            break
        outline = np.delete(outline, flattest, axis=0)
    return outline
