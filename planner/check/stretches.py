"""Stretches of a line by distance along it, however long the line is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString, Point

Floats = NDArray[np.float64]

#: Vertices closer together than this are one place.
_LEAST_M = 1e-9


class Measured:
    """A line whose vertices' distances along it are known, so that a stretch costs what is in it.

    Parameters
    ----------
    line_m
        Vertices, (N, 2).
    """

    def __init__(self, line_m: Floats) -> None:
        self._line_m = line_m
        #: Of each vertex, its distance along the line.
        self.along_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line_m, axis=0).T))])

    @property
    def length_m(self) -> float:
        """From the first vertex to the last."""
        return float(self.along_m[-1])

    def between(self, from_m: float, to_m: float) -> Floats:
        """Vertices of a stretch, its ends among them, (M, 2); one place where it has no length."""
        from_m, to_m = (min(max(at_m, 0.0), self.length_m) for at_m in (from_m, to_m))
        first = self.place(from_m)
        if to_m <= from_m:
            return first[None]
        low, high = np.searchsorted(self.along_m, from_m, "right"), np.searchsorted(self.along_m, to_m)
        return np.concatenate([first[None], self._line_m[low:high], self.place(to_m)[None]])

    def place(self, at_m: float) -> Floats:
        """The place so far along, (2,)."""
        return np.array([np.interp(at_m, self.along_m, column) for column in self._line_m.T])

    def nearest_m(self, place: tuple[float, float], from_m: float, to_m: float) -> float:
        """How far along the place of a stretch is that lies nearest to another."""
        from_m = min(max(from_m, 0.0), self.length_m)
        stretch = self.between(from_m, to_m)
        # GEOS divides by the lengths of segments.
        steps_m = np.hypot(*np.diff(stretch, axis=0).T)
        stretch = stretch[np.concatenate([[True], steps_m > _LEAST_M])]
        return from_m + float(LineString(stretch).project(Point(place))) if len(stretch) > 1 else from_m
