"""What is wished: regions to be seen, weights of what a plan costs, the algorithm of each stage."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiPolygon, Polygon

#: No aircraft is sent higher: over the scenario's datum, or the ground.
HIGHEST_M = 30_000.0

#: How a camera sees a region.
Pattern = Literal["auto", "lanes", "crosshatch", "orbit", "spiral", "look"]


@dataclass(frozen=True, slots=True)
class Region:
    """A region of interest, as an area on the ground.

    A corridor (LineString with width) and a target (Point with radius) arrive here as the area they mean.
    ``approach_rad`` holds the allowed flight directions, None for any; ``revisits`` how often it is to be
    seen, on separate occasions; ``axis`` the line a corridor follows; ``altitude_m`` is that of its passes
    over the scenario's datum, None for the route's. ``over_ground_m`` is the height of passes that follow the
    ground, None for level ones. ``min_resolution_m``, ``gsd_m`` and ``min_niirs`` ask for quality: the worst
    inside it; ``pattern`` is how a camera is to see it. All of it is to be seen within ``time_window_s``,
    seconds after the mission's start, None for any time; of several visits each begins ``revisit_after_s``
    or more after the one before has ended.
    """

    name: str
    area: Polygon | MultiPolygon
    priority: float = 1.0
    required: bool = True
    sensor: str | None = None
    min_resolution_m: float | None = None
    approach_rad: tuple[float, ...] | None = None
    revisits: int = 1
    axis: LineString | None = None
    altitude_m: float | None = None
    over_ground_m: float | None = None
    gsd_m: float | None = None
    min_niirs: float | None = None
    pattern: Pattern = "auto"
    time_window_s: tuple[float, float] | None = None
    revisit_after_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Separation:
    """What aircraft of one plan keep from each other at every instant: one of the two distances."""

    horizontal_m: float
    vertical_m: float


@dataclass(frozen=True, slots=True)
class Band:
    """Heights over ground that flights may have between their passes, where the planner chooses heights.

    Parameters
    ----------
    low_m, high_m
        None: not lower than the lowest pass, not higher than the highest.
    """

    low_m: float | None
    high_m: float | None


#: Where a scenario does not say.
DEFAULT_SEPARATION = Separation(100.0, 30.0)


@dataclass(frozen=True, slots=True)
class Unflown:
    """A pass that a search was still to fly, east and north in metres, and the side looked to."""

    start: tuple[float, float]
    end: tuple[float, float]
    look: Literal["left", "right", "down"]


@dataclass(frozen=True, slots=True)
class GoingOn:
    """What a plan takes the place of another for, while that is being flown.

    Parameters
    ----------
    begins_in_s
        From the call for it to its beginning, where aircraft in flight were then thought to be.
    order
        By the name of an aircraft, what it was still to see, in flight order.
    unless_better
        Another order is flown where it is better by this part.
    unflown
        By the name of an aircraft, what of a search it was still to fly, in flight order.
    until
        By the name of an aircraft, the line that it flies until its plan begins: east, north, and metres over
        home.
    """

    begins_in_s: float = 0.0
    order: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    unless_better: float = 0.05
    unflown: Mapping[str, tuple[Unflown, ...]] = field(default_factory=dict)
    until: Mapping[str, tuple[tuple[float, float, float], ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Objective:
    """Weights of the cost terms: w1, w2, w3 of eq 25 (Li et al. 2018) and two more.

    Those of several flights besides, by the second: when the last has landed, the time in the air of all, and
    what is collected of priority against both.
    """

    length: float = 1.0
    missile: float = 1.0
    radar: float = 1.0
    energy: float = 0.0
    turns: float = 0.0
    last_landing: float = 1.0
    total_time: float = 0.1
    priority: float = 1.0


@dataclass(frozen=True, slots=True)
class Method:
    """The algorithm of each stage, by name; ``directions`` is L of ``transit`` ``milp``."""

    coverage: str = "auto"
    routing: str = "auto"
    transit: str = "auto"
    smoothing: str = "auto"
    search: str = "auto"
    directions: int = 4


@dataclass(frozen=True, slots=True)
class ImportancePatch:
    """Ground a square metre of which is worth ``score`` to be seen; where patches overlap scores add up."""

    name: str
    area: Polygon | MultiPolygon
    score: float


@dataclass(frozen=True, slots=True, eq=False)
class ImportanceRaster:
    """Scores of a raster on local cells, by the square metre; the first is the one in the south-west.

    Parameters
    ----------
    scores
        Shape (rows, columns), none negative, 0 where the raster has none.
    west_m, south_m, cell_m
        Corner of the first cell, and the length of its edge.
    """

    name: str
    scores: NDArray[np.float64]
    west_m: float
    south_m: float
    cell_m: float


@dataclass(frozen=True, slots=True)
class ImportancePoint:
    """A place round which seeing ground is worth something: ``score`` a square metre there, less round it.

    It falls off as a normal distribution does, of the standard deviation ``spread_m`` in each direction.
    """

    name: str
    position: tuple[float, float]
    spread_m: float
    score: float

    @property
    def total(self) -> float:
        """Of all ground round it."""
        return self.score * math.tau * self.spread_m**2


@dataclass(frozen=True, slots=True)
class Drift:
    """How what is looked for moves: east and north, and how uncertain that is.

    Parameters
    ----------
    spread_m_s
        Standard deviation in each direction; it stays as it is for the whole search.
    elapsed_s
        How long before the search's start it was where importance says.
    """

    east_m_s: float
    north_m_s: float
    spread_m_s: float = 0.0
    elapsed_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Seen:
    """Ground that was looked at before the search's start, and nothing was found.

    Parameters
    ----------
    begin_s, end_s
        When, after the search's start: neither above 0.
    course_rad
        In which direction it was flown over, the rearmost of it at ``begin_s`` and the foremost at ``end_s``;
        None where all of it was looked at in the middle of that time.
    """

    area: Polygon | MultiPolygon
    begin_s: float = 0.0
    end_s: float = 0.0
    course_rad: float | None = None


@dataclass(frozen=True, slots=True)
class Importance:
    """What seeing ground is worth; all the same where there are no patches, points nor a raster.

    Parameters
    ----------
    detection
        Probability that a look finds what it sees; the k-th look pays (1 − detection)^(k − 1) of the first,
        which pays that part of what ground is worth.
    drift
        How what is looked for moves on; None where it stays.
    seen
        Looks that were had before the search's start, each counted as one.
    """

    patches: tuple[ImportancePatch, ...] = ()
    raster: ImportanceRaster | None = None
    points: tuple[ImportancePoint, ...] = ()
    detection: float = 1.0
    drift: Drift | None = None
    seen: tuple[Seen, ...] = ()

    @property
    def given(self) -> bool:
        """Whether some ground is worth more than other."""
        return bool(self.patches) or bool(self.points) or self.raster is not None
