"""What looks before a search's start have left of what is looked for, place by place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.wishes import Importance, Seen

Floats = NDArray[np.float64]


def missed_before(importance: Importance, places_m: Floats, drifts_m_s: Floats | None = None) -> Floats:
    """How probable it is that none of those looks has found what is at each place.

    Parameters
    ----------
    places_m
        (…, 2): east and north at the search's start.
    drifts_m_s
        (…, 2): how each moves on; None where it stays.
    """
    left = np.ones(places_m.shape[:-1])
    for look in importance.seen:
        there = places_m if drifts_m_s is None else _when_looked(look, places_m, drifts_m_s)
        shapely.prepare(look.area)
        inside = shapely.contains_xy(look.area, there[..., 0], there[..., 1])
        left = np.where(inside, left * (1.0 - importance.detection), left)
    return left


def _when_looked(look: Seen, places_m: Floats, drifts_m_s: Floats) -> Floats:
    """Where each place was when the look came by it."""
    middle_s = 0.5 * (look.begin_s + look.end_s)
    lasted_s = look.end_s - look.begin_s
    if look.course_rad is None or lasted_s <= 0.0:
        return np.asarray(places_m + middle_s * drifts_m_s)
    along = np.array([np.cos(look.course_rad), np.sin(look.course_rad)])
    ends_m = shapely.get_coordinates(look.area) @ along
    first_m, speed_m_s = float(ends_m.min()), float(np.ptp(ends_m)) / lasted_s
    at_begin_m = (places_m + look.begin_s * drifts_m_s) @ along
    closing_m_s = np.maximum(speed_m_s - drifts_m_s @ along, 1e-6)
    at_s = look.begin_s + np.clip((at_begin_m - first_m) / closing_m_s, 0.0, lasted_s)
    return np.asarray(places_m + at_s[..., None] * drifts_m_s)


def moved_on(seen: Sequence[Seen], east_m_s: float, north_m_s: float, time_s: float) -> tuple[Seen, ...]:
    """Looks where what they looked at has drifted to by a time after the search's start, about."""
    found = []
    for look in seen:
        since_s = time_s - 0.5 * (look.begin_s + look.end_s)
        moved = shapely.transform(look.area, lambda at, s=since_s: at + s * np.array([east_m_s, north_m_s]))
        found.append(Seen(moved, look.begin_s, look.end_s, look.course_rad))
    return tuple(found)
