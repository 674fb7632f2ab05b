"""A disc search turned and mirrored so that its ground lies along the axes, the same for all that are alike.

Families of lines are laid along axes, and steps are drawn along them: ground turned, mirrored or elsewhere is
searched as well as the same ground upright.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.search.course import DiscSearch
from planner.search.values import Worth, worth_of_ground

Floats = NDArray[np.float64]

#: Places are told apart by metres to so many digits: turned ground differs from the same upright by rounding.
DIGITS = 7


@dataclass(frozen=True, slots=True, eq=False)
class Upright:
    """A search upright, and the way back.

    Parameters
    ----------
    axes
        Rows are unit vectors along the upright frame's axes, (2, 2); a reflection where it is mirrored.
    origin
        The upright frame's origin, (2,).
    """

    search: DiscSearch
    axes: Floats
    origin: Floats

    def back(self, points: Floats) -> Floats:
        """Places (N, 2) of the upright search where they lie in the one asked for."""
        return np.asarray(points @ self.axes + self.origin)


def upright(search: DiscSearch) -> Upright:
    """Turn a search: ground along the axes, as long as can be along the first, its start near the origin."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(search.ground))[:4]
    ends = np.array([search.start, search.end])

    def place(frame: tuple[Floats, Floats]) -> tuple[float, ...]:
        axes, origin = frame
        long_m = float(np.ptp(corners @ axes.T, axis=0)[0])
        return (-round(long_m, 3), *np.round((ends - origin) @ axes.T, 3).ravel().tolist())

    axes, origin = min(frames(corners), key=place)
    whole = shapely.transform(search.ground, lambda places: np.round((places - origin) @ axes.T, DIGITS))
    start, end = (tuple(each) for each in np.round((ends - origin) @ axes.T, DIGITS).tolist())
    plain = worth_of_ground(whole, search.worth.cell_m)
    scores = _scores(search.worth, plain.centres_m.reshape(-1, 2) @ axes + origin)
    worth = worth_of_ground(whole, search.worth.cell_m, scores.reshape(plain.scores.shape))
    return Upright(replace(search, ground=whole, worth=worth, start=start, end=end), axes, origin)


def frames(corners: Floats) -> Iterator[tuple[Floats, Floats]]:
    """Axes and origin of the rectangle seen from each corner, either side first."""
    for k in range(4):
        sides = np.stack([corners[(k + 1) % 4], corners[k - 1]]) - corners[k]
        lengths_m = np.hypot(*sides.T)
        if lengths_m.min() > 0.0:
            axes = sides / lengths_m[:, None]
            yield axes, corners[k]
            yield axes[::-1], corners[k]


def _scores(worth: Worth, places: Floats) -> Floats:
    """Scores of the cells that places lie in; of ground worth the same everywhere that, on its edges, too."""
    some = worth.scores[worth.scores > 0.0]
    if len(some) and some.min() == some.max():
        return np.full(len(places), some[0])
    rows, columns = worth.scores.shape
    column = np.floor((places[:, 0] - worth.west_m) / worth.cell_m).astype(np.int64)
    row = np.floor((places[:, 1] - worth.south_m) / worth.cell_m).astype(np.int64)
    return np.asarray(worth.scores[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)])
