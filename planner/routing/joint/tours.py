"""Tours by what they choose of each region: finer choices round them, their passes, what those hide."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.coverage.merge import MergedRegion
from planner.coverage.sweeps import Side
from planner.route import CollectPass
from planner.routing.joint.chain import Layers, layers_of
from planner.routing.joint.options import Options, Surroundings, collect_passes, hidden_m, make_options
from planner.routing.joint.targets import refusal
from planner.scenario import Scenario

Floats = NDArray[np.float64]

#: The first refinement's steps; each tries this many angles and offsets to either side of the last choice,
#: then halves the steps.
FIRST_STEP_RAD, FIRST_STEP_ETA = math.radians(5.0), 0.25
REFINE_ANGLES = 5
REFINE_ETAS = 2
REFINEMENTS = 5
#: Of one option that is the only one: its side counts within one.
NO_SIDE = np.zeros(1, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class Choice:
    """One option of each region in visiting order: side, angle and offsets."""

    order: tuple[int, ...]
    side: tuple[int, ...]
    angle_rad: tuple[float, ...]
    eta_first: tuple[float, ...]
    eta_second: tuple[float, ...]
    cost_m: float

    @classmethod
    def of(
        cls, order: Sequence[int], options: Sequence[Options], picked: Sequence[int], cost_m: float
    ) -> Choice:
        """The options picked of each region in an order; ``options`` are those of the regions visited."""
        pairs = list(zip(options, picked, strict=True))
        return cls(
            tuple(order),
            tuple(int(o.side[i]) for o, i in pairs),
            tuple(float(o.angles_rad[i]) for o, i in pairs),
            tuple(float(o.eta_first[i]) for o, i in pairs),
            tuple(float(o.eta_second[i]) for o, i in pairs),
            cost_m,
        )

    def picked(self, options: Sequence[Options], picked: Sequence[int], cost_m: float) -> Choice:
        """The same order and sides with other options."""
        return replace(Choice.of(self.order, options, picked, cost_m), side=self.side)


@dataclass(frozen=True, slots=True)
class Tours:
    """Regions, each with its ways to be seen, and where; tours choose one option of each.

    Parameters
    ----------
    sides
        Of each region, part of one or visit to one.
    """

    scenario: Scenario
    around: Surroundings
    regions: Sequence[MergedRegion]
    sides: Sequence[tuple[Side, ...]]

    def refined(self, choice: Choice) -> Choice:
        """The same order with finer angles and offsets round the chosen ones."""
        step_rad, step_eta = FIRST_STEP_RAD, FIRST_STEP_ETA
        for _ in range(REFINEMENTS):
            layers, _ = self.layers(choice, step_rad, step_eta)
            cost_m, picked = layers.best()
            if cost_m < choice.cost_m:
                choice = choice.picked(layers.options, picked, cost_m)
            step_rad, step_eta = step_rad / 2.0, step_eta / 2.0
        return choice

    def layers(
        self, choice: Choice, step_rad: float, step_eta: float
    ) -> tuple[Layers, list[tuple[Side, ...]]]:
        """Options round the chosen ones, place by place, and the one side each place has them of."""
        finer: list[Options] = []
        of_places: list[tuple[Side, ...]] = []
        for place, index in enumerate(choice.order):
            near_rad = step_rad * np.arange(-REFINE_ANGLES, REFINE_ANGLES + 1, dtype=np.float64)
            angles_rad: Floats = choice.angle_rad[place] + near_rad
            approach_rad = self.regions[index].approach_rad
            if approach_rad is not None:
                angles_rad = np.asarray(approach_rad, dtype=np.float64)
            etas = _near([choice.eta_first[place], choice.eta_second[place]], step_eta)
            side = (self.sides[index][choice.side[place]],)
            options = make_options(side, angles_rad, etas, self.around)
            if options is None:
                options = replace(self._single(choice, place), side=NO_SIDE)
            finer.append(options)
            of_places.append(side)
        return layers_of(self.scenario, self.around, finer, self.around.discs), of_places

    def passes(self, choice: Choice) -> tuple[CollectPass, ...]:
        """A tour's passes in the order flown."""
        return tuple(one for place in range(len(choice.order)) for one in self._of_place(choice, place))

    def shadow_m(self, choice: Choice) -> float:
        """What a tour's passes cost for ground that terrain hides from them."""
        if self.around.ground is None:
            return 0.0
        return math.fsum(
            hidden_m(self.sides[index][side], self._of_place(choice, place), self.around)
            for place, (index, side) in enumerate(zip(choice.order, choice.side, strict=True))
        )

    def _of_place(self, choice: Choice, place: int) -> tuple[CollectPass, ...]:
        return collect_passes(self.sides[choice.order[place]], self._single(choice, place), 0)

    def _single(self, choice: Choice, place: int) -> Options:
        """The chosen option of one place by itself; ``side`` counts within the region's."""
        etas = [eta for eta in (choice.eta_first[place], choice.eta_second[place]) if not math.isnan(eta)]
        chosen = (self.sides[choice.order[place]][choice.side[place]],)
        angles_rad = np.array([choice.angle_rad[place]])
        options = make_options(chosen, angles_rad, np.unique(np.array(etas)), self.around)
        if options is None:
            raise refusal(chosen[0].region, self.around)
        same = (options.eta_first == choice.eta_first[place]) & (
            np.isnan(options.eta_second) | (options.eta_second == choice.eta_second[place])
        )
        kept = {name: getattr(options, name)[same] for name in Options.__slots__}
        kept["side"] = np.full(int(same.sum()), choice.side[place], dtype=np.int64)
        return Options(**kept)


def _near(etas: list[float], step: float) -> Floats:
    steps = step * np.arange(-REFINE_ETAS, REFINE_ETAS + 1)
    around = [np.clip(eta + steps, 0.0, 1.0) for eta in etas if not math.isnan(eta)]
    return np.unique(np.concatenate(around))
