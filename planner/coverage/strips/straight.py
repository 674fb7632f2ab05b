"""Which straight pieces of a corridor cost least: few of them, cut where the turns between them are short.

Cuts are found by what flying from piece to piece may cost about; then each cut is moved as long as that
makes the pieces round it cheaper.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString

from planner.airspace.surroundings import Surroundings
from planner.coverage.merge import MergedRegion
from planner.coverage.strips.corridor import Corridor, Piece, Pieces
from planner.progress import Stop
from planner.sensors.sar import SarSensor
from planner.sensors.strip import swaths_m

Floats = NDArray[np.float64]

#: What seeing all of these parts costs, turns between them included; inf where it cannot be.
Estimate = Callable[[tuple[MergedRegion, ...]], float]

#: Of a full turn, how much is reckoned with between two pieces.
TURN = 0.5
#: Tries without pieces that cannot be seen.
MOST_BARRED = 12
#: Cuts are moved by so many places, where that saves so much, as the pieces so far to either side tell.
MOVES = (4, 2, 1)
LEAST_GAIN_M = 1.0
WINDOW = 3


@dataclass(frozen=True, slots=True)
class Straight:
    """A region that is a corridor, its line, and how much its pieces cost."""

    region: MergedRegion
    corridor: Corridor
    estimate: Estimate

    def moved(self, pieces: tuple[Piece, ...], enough: Stop) -> tuple[Piece, ...]:
        """The pieces with cuts moved."""
        found = list(pieces)
        for step in MOVES:
            for k in range(len(found) - 1):
                for move in (-step, step):
                    if enough():
                        return tuple(found)
                    self._move(found, k, move)
        return tuple(found)

    def _move(self, pieces: list[Piece], k: int, move: int) -> None:
        """Move the cut after a piece, as often as that saves."""
        low, high = max(k - WINDOW + 1, 0), k + WINDOW + 1
        known_m = self._cost_m(pieces[low:high])
        while True:
            (begin, cut), (_, end) = pieces[k], pieces[k + 1]
            if not begin < cut + move < end:
                return
            trial = [*pieces[:k], (begin, cut + move), (cut + move, end), *pieces[k + 2 :]]
            trial_m = self._cost_m(trial[low:high])
            if not trial_m < known_m - LEAST_GAIN_M:
                return
            pieces[:], known_m = trial, trial_m

    def _cost_m(self, pieces: list[Piece]) -> float:
        return self.estimate(tuple(self.region.piece(self.corridor.ground(piece)) for piece in pieces))

    def unseen(self, pieces: tuple[Piece, ...]) -> set[Piece]:
        """Those of the pieces that no pass may see."""
        return {piece for piece in pieces if math.isinf(self._cost_m([piece]))}

    def parts(self, pieces: tuple[Piece, ...]) -> tuple[MergedRegion, ...] | None:
        """The pieces as regions; None where they leave any of the corridor out."""
        division = self.corridor.division(pieces)
        return None if division is None else tuple(self.region.piece(ground) for ground in division)


def straight_parts(
    region: MergedRegion,
    axis: LineString,
    estimate: Estimate,
    sensor: SarSensor,
    height_m: float,
    around: Surroundings,
    enough: Stop,
) -> tuple[MergedRegion, ...] | None:
    """A corridor in straight pieces; None where there are no such pieces."""

    def swaths(angles_rad: Floats) -> Floats:
        return swaths_m(sensor, height_m, angles_rad)

    headings_rad = None if region.approach_rad is None else np.asarray(region.approach_rad, dtype=np.float64)
    corridor = Corridor.of(region.originals[0], axis, sensor.swath_m(height_m))
    lengths = Pieces.of(corridor, swaths, headings_rad)
    straight = Straight(region, corridor, estimate)
    barred: set[Piece] = set()
    between_m = sensor.collection_m(height_m, 0.0) + around.settle_m + TURN * math.tau * around.radius_m
    for _ in range(MOST_BARRED):
        pieces = lengths.cheapest(between_m, barred, closed=corridor.closed)
        if pieces is None:
            return None
        unseen = straight.unseen(pieces)
        if not unseen:
            return straight.parts(straight.moved(pieces, enough))
        barred |= unseen
    return None
