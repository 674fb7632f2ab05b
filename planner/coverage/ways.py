"""The seam between seeing and choosing: what is to be seen, the ways to see it, and who knows them.

A *target* is one stop of a tour: a region, part of one or visit to one. It offers its ways to be seen as
*options*, poses and costs, and makes passes of the one chosen. A *family* knows the targets of one kind of
sensor. The choice among options knows neither sensors nor what an option is made of.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol, Self

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.airspace.surroundings import Surroundings
from planner.coverage.merge import MergedRegion
from planner.progress import Stop
from planner.route import CollectPass
from planner.sensors.base import Sensor
from planner.wishes import Region

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


#: How a region is divided: as costs least by an estimate; not, unless it cannot be seen otherwise; where it
#: is a corridor with bends, at each of them; or as the first, and its parts seen by as many passes as have
#: room to turn, where fewer have none.
Division = Literal["auto", "whole", "legs", "roomy"]
#: Items seen together, by their numbers.
Group = frozenset[int]
#: The sensor of a name over an area, and the flight height over its ground.
Over = Callable[[str | None, Polygon], tuple[Sensor, float]]


class Options(Protocol):
    """Ways to see one target, one row each; what else they are made of its target alone knows."""

    @property
    def entries(self) -> Floats:
        """Poses before the first pass, settling included, (K, 3): east_m, north_m, angle_rad."""

    @property
    def exits(self) -> Floats:
        """Poses after the last pass, (K, 3)."""

    @property
    def inner_m(self) -> Floats:
        """Costs from entry to exit, metres, (K,)."""

    def rows(self, kept: Ints) -> Self:
        """Some of them."""


@dataclass(frozen=True, slots=True)
class Between:
    """What one stop of a tour lies between: costs to first poses, and from last ones, (K, 3) to (K,)."""

    before_m: Callable[[Floats], Floats]
    behind_m: Callable[[Floats], Floats]


class Target(Protocol):
    """One stop of a tour, with the ways to see it. Options are those it gave itself."""

    @property
    def region(self) -> MergedRegion:
        """What is seen."""

    def options(self, angles_rad: Floats, etas: Floats) -> Options | None:
        """Options at these headings and offsets that keep the hard constraints; None where there are none."""

    def coarse(self, step_rad: float, etas: Floats) -> Options:
        """Options to choose an order by, at headings about a step apart: rather those with room for turns.

        Raises
        ------
        InfeasibleError
            Where no option keeps the hard constraints.
        """

    def key(self, picked: Any) -> tuple[float, ...]:
        """What of one, a single row, those near it are found by."""

    def near(self, picked: Any, step_rad: float, step_eta: float, between: Between | None = None) -> Options:
        """Options round one, a single row, at steps of heading and offset; that one where there are none.

        Those that are best for what they lie ``between``, where that is given.
        """

    def passes(self, options: Any, index: int) -> tuple[CollectPass, ...]:
        """The passes of one option."""

    def hidden_m(self, passes: Sequence[CollectPass]) -> float:
        """What passes of one option cost for ground of the region that terrain hides from them."""

    def plain(self) -> Target:
        """The same with its simpler ways alone where it has others too; itself where not."""


class Sharing(Protocol):
    """Which targets may be seen in one pass.

    *Items* are what one pass sees: targets, or pieces of one; a target that takes several passes has none.
    """

    @property
    def owners(self) -> Sequence[int]:
        """Of each item which target it is of; what is left of a target without its items is nothing."""

    def groups(self) -> list[Group]:
        """Groups of two items and more that one pass may see, those of most items first."""

    def target(self, group: Group) -> Target | None:
        """What sees all items of a group in one pass; None where nothing does."""


class Family(Protocol):
    """How sensors of one kind see regions from straight level passes. Sensors are of that kind."""

    def check(self, region: Region, sensor: Any, height_m: float) -> None:
        """Refuse a sensor that cannot give what a region asks for, at this height.

        Raises
        ------
        InfeasibleError
            With what it lacks.
        """

    def check_seen(
        self, region: Region, sensor: Any, height_m: float, area: Any, settle_m: float, *, wide: bool
    ) -> None:
        """Refuse a region that no passes inside an area see, zones and turns left out.

        Straight flight of ``settle_m`` before each pass lies inside, too.

        Raises
        ------
        InfeasibleError
            With the constraint and the nearest relaxation.
        """

    def fewest_passes(self, region: Region, sensor: Any, height_m: float) -> tuple[int, float]:
        """How many passes a region takes at least, and the widest that one of them sees, metres."""

    def targets(
        self,
        region: MergedRegion,
        sensor: Any,
        height_m: float,
        around: Surroundings,
        *,
        wide: bool,
        division: Division,
        enough: Stop,
    ) -> Sequence[Target]:
        """The stops that see a region: several where it is divided or to be visited again.

        Parameters
        ----------
        wide
            Whether any number of passes, and divisions, are allowed; without, the paper's ways.
        division
            How it is divided.
        enough
            Ends the search for a shorter division.

        Raises
        ------
        InfeasibleError
            Where no pass may be flown that sees it.
        """

    def can_be_flown(
        self, region: MergedRegion, sensor: Any, height_m: float, around: Surroundings, *, wide: bool
    ) -> bool:
        """Whether some passes that see a region whole may be flown."""

    def sharing(self, targets: Sequence[Any], over: Over, around: Surroundings) -> Sharing:
        """Which targets of the family may be seen in one pass."""

    def undivided(
        self, region: MergedRegion, sensor: Any, height_m: float, around: Surroundings
    ) -> Iterable[Target]:
        """Targets that see all of a region in one way each, those with the fewest passes first.

        Raises
        ------
        InfeasibleError
            Where there is none.
        """
