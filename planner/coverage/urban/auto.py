"""``auto`` among obstacles: headings, sweeps and their order chosen for the least way in all."""

from __future__ import annotations

from dataclasses import dataclass

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.free import FreeSpace, free_space
from planner.coverage.urban.joins import Joins
from planner.coverage.urban.layout import cheapest, turn_m
from planner.coverage.urban.measures import Flown, Sweep
from planner.coverage.urban.mend import mended
from planner.coverage.urban.relay import relaid
from planner.coverage.urban.visibility import edges_of
from planner.coverage.urban.waypoints import Joiner


@dataclass(frozen=True, slots=True)
class Auto:
    """The planner's own way to cover an area among obstacles.

    1. Sweeps are laid at the headings of the ground's edges in several manners (``frontier``).
    2. Those that promise the shortest flights each get a tour over all their sweeps, either direction of each
       allowed, over true lengths among obstacles (``tour_kernels``).
    3. The tour of the shortest flight is flown: a stop to turn on the spot counts as the way flown meanwhile.

    Parameters
    ----------
    seed
        Of the shakes.
    """

    seed: int = 0

    def __call__(self, urban: UrbanArea) -> Flown:
        """The flight.

        Raises
        ------
        InfeasibleError
            Where obstacles leave no free ground, or sweeps cannot be joined.
        """
        joiner = Joiner.among(urban, free_space(urban), turn_m(urban))
        return joiner.graph(self._sequence(urban, joiner)).flown()

    def sequence(self, urban: UrbanArea, free: FreeSpace) -> tuple[Sweep, ...]:
        """Sweeps through an area's free ground in the order and direction flown, joined by nobody yet."""
        return self._sequence(urban, Joiner.among(urban, free, turn_m(urban)))

    def _sequence(self, urban: UrbanArea, joiner: Joiner) -> tuple[Sweep, ...]:
        ground = joiner.free.ground
        edges = edges_of(ground)
        best = mended(relaid(cheapest(urban, edges), urban, ground, edges), urban, ground, edges)
        _, lines = Joins.among(urban, joiner.free, joiner.ways).tour(best.lines(), self.seed)
        return tuple(Sweep((a, b), (c, d)) for (a, b), (c, d) in lines.tolist())
