"""Tours by what they choose of each target: finer choices round them, their passes, what those hide."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.ways import Between, Options, Target
from planner.route import CollectPass, Terminal
from planner.routing.joint.chain import Layers, estimates, from_start, layers_of, to_end

Floats = NDArray[np.float64]

#: The first refinement's steps of heading and offset; each halves them.
FIRST_STEP_RAD, FIRST_STEP_ETA = math.radians(5.0), 0.25
REFINEMENTS = 5
#: The same where passes are put in the order that is best for the tour.
FITTED_STEP_RAD, FITTED_STEP_ETA, FITTINGS = math.radians(1.0), 0.1, 4
#: Tours refined besides the cheapest, so many over the number of places but at least so many: they cost no
#: more than this part more than it, and their headings at one place lie so far apart; less in tours of few
#: places, where most is lanes and a degree may change their number.
ALTERNATIVES, LEAST_ALTERNATIVES = 16, 6
WORTH = 0.05
APART_RAD, APART_OF_FEW_RAD, FEW = math.radians(15.0), math.radians(3.0), 2


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """One option of each target in visiting order.

    Parameters
    ----------
    picked
        Of each place in the order the option, a single row.
    """

    order: tuple[int, ...]
    picked: tuple[Options, ...]
    cost_m: float

    @classmethod
    def of(
        cls, order: Sequence[int], options: Sequence[Options], picked: Sequence[int], cost_m: float
    ) -> Choice:
        """The options picked of each target in an order; ``options`` are those of the targets visited."""
        rows = (o.rows(np.array([index])) for o, index in zip(options, picked, strict=True))
        return cls(tuple(order), tuple(rows), cost_m)

    def turned_rad(self, other: Choice) -> float:
        """By how much another tour's headings differ at most, place by place."""
        pairs = zip(self.picked, other.picked, strict=True)
        return max(abs(math.remainder(a.entries[0, 2] - b.entries[0, 2], math.tau)) for a, b in pairs)


@dataclass(frozen=True, slots=True)
class Pool:
    """Options of one target from several sets of them."""

    sets: tuple[Options, ...]
    entries: Floats
    exits: Floats
    inner_m: Floats

    @classmethod
    def of(cls, sets: Sequence[Options]) -> Pool:
        """All of some sets, one after the other."""
        columns = ([getattr(each, name) for each in sets] for name in ("entries", "exits", "inner_m"))
        return cls(tuple(sets), *(np.concatenate(column) for column in columns))

    def rows(self, kept: NDArray[np.int64]) -> Pool:
        """Some of them."""
        return Pool.of([self.row(index) for index in kept.tolist()])

    def row(self, index: int) -> Options:
        """One of them, as its set has it."""
        for each in self.sets:
            if index < len(each.inner_m):
                return each.rows(np.array([index]))
            index -= len(each.inner_m)
        raise IndexError(index)


@dataclass(frozen=True, slots=True)
class Tours:
    """Targets, and where; tours from one end to the other choose one option of each.

    Many tours have the same options at most places: finer ones round these are found once.
    """

    ends: tuple[Terminal, Terminal]
    around: Surroundings
    targets: Sequence[Target]
    _known: dict[tuple[object, ...], Options | None] = field(default_factory=dict, repr=False)

    def refined(self, choice: Choice) -> Choice:
        """The same order with finer options round the chosen ones."""
        step_rad, step_eta = FIRST_STEP_RAD, FIRST_STEP_ETA
        for _ in range(REFINEMENTS):
            layers = self.layers(choice, step_rad, step_eta)
            cost_m, picked = layers.best()
            if cost_m < choice.cost_m:
                choice = Choice.of(choice.order, layers.options, picked, cost_m)
            step_rad, step_eta = step_rad / 2.0, step_eta / 2.0
        return choice

    def fitted(self, choice: Choice) -> Choice:
        """The same order, the passes of each target in the order that is best for what it lies between."""
        step_rad, step_eta = FITTED_STEP_RAD, FITTED_STEP_ETA
        for _ in range(FITTINGS):
            layers = self.layers(choice, step_rad, step_eta, fitting=True)
            cost_m, picked = layers.best()
            if cost_m < choice.cost_m:
                choice = Choice.of(choice.order, layers.options, picked, cost_m)
            step_rad, step_eta = step_rad / 2.0, step_eta / 2.0
        return choice

    def crossed(self, choices: Sequence[Choice]) -> list[Choice]:
        """Tours of what some tours have chosen of each target, the best in each of their orders."""
        pools = {
            target: Pool.of([choice.picked[choice.order.index(target)] for choice in choices])
            for target in choices[0].order
        }
        found = []
        for order in dict.fromkeys(choice.order for choice in choices):
            layers = layers_of(self.ends, self.around, [pools[c] for c in order], self.around.discs)
            cost_m, best = layers.best()
            rows = tuple(pools[c].row(index) for c, index in zip(order, best, strict=True))
            found.append(Choice(order, rows, cost_m))
        return found

    def _between(self, choice: Choice, place: int) -> Between:
        """What one place of a tour lies between: both ends, or the options chosen next to it."""
        (start, end), around = self.ends, self.around
        before, behind = choice.picked[:place][-1:], choice.picked[place + 1 :][:1]

        def before_m(entries: Floats) -> Floats:
            if not before:
                return from_start(start, around, entries, around.discs)
            costs_m: Floats = estimates(before[0].exits, entries, around, around.discs)[0]
            return costs_m

        def behind_m(exits: Floats) -> Floats:
            if not behind:
                return to_end(end, around, exits, around.discs)
            costs_m: Floats = estimates(exits, behind[0].entries, around, around.discs)[:, 0]
            return costs_m

        return Between(before_m, behind_m)

    def alternatives(self, choice: Choice, coarse: Sequence[Options]) -> list[Choice]:
        """Tours in the same order with another option at one place, the cheapest of headings apart."""
        layers = layers_of(self.ends, self.around, [coarse[c] for c in choice.order], self.around.discs)
        ways = sorted(
            (float(cost_m[option]), place, int(option))
            for place, cost_m in enumerate(layers.through())
            for option in np.flatnonzero(cost_m <= (1.0 + WORTH) * choice.cost_m)
        )
        apart_rad = APART_RAD if len(choice.order) > FEW else APART_OF_FEW_RAD
        taken = [[float(picked.entries[0, 2])] for picked in choice.picked]
        found: list[Choice] = []
        for _, place, option in ways:
            angle_rad = float(layers.options[place].entries[option, 2])
            if min(abs(math.remainder(angle_rad - other, math.tau)) for other in taken[place]) < apart_rad:
                continue
            taken[place].append(angle_rad)
            cost_m, picked = layers.only(place, option).best()
            found.append(Choice.of(choice.order, layers.options, picked, cost_m))
            if len(found) >= max(LEAST_ALTERNATIVES, ALTERNATIVES // len(choice.order)):
                break
        return found

    def visited(self, choice: Choice) -> list[Target]:
        """The targets in a tour's order."""
        return [self.targets[index] for index in choice.order]

    def layers(self, choice: Choice, step_rad: float, step_eta: float, *, fitting: bool = False) -> Layers:
        """Options round the chosen ones, place by place.

        Parameters
        ----------
        fitting
            Whether they are to be the best for what they lie between.
        """
        finer = [self._near(choice, place, step_rad, step_eta, fitting) for place in range(len(choice.order))]
        return layers_of(self.ends, self.around, finer, self.around.discs)

    def _near(self, choice: Choice, place: int, step_rad: float, step_eta: float, fitting: bool) -> Options:
        """Options round the one chosen at a place."""
        number, picked = choice.order[place], choice.picked[place]
        target = self.targets[number]
        key: tuple[object, ...] = (number, target.key(picked), step_rad, step_eta)
        between = None
        if fitting:
            between = self._between(choice, place)
            before, behind = choice.picked[:place][-1:], choice.picked[place + 1 :][:1]
            poses = [one.exits[0] for one in before], [one.entries[0] for one in behind]
            key += tuple(np.concatenate([*some, np.empty(0)]).tobytes() for some in poses)
        if key not in self._known:
            found = target.near(picked, step_rad, step_eta, between)
            self._known[key] = None if found is picked else found
        known = self._known[key]
        return picked if known is None else known

    def passes(self, choice: Choice) -> tuple[CollectPass, ...]:
        """A tour's passes in the order flown."""
        return tuple(
            one
            for target, picked in zip(self.visited(choice), choice.picked, strict=True)
            for one in target.passes(picked, 0)
        )

    def shadow_m(self, choice: Choice) -> float:
        """What a tour's passes cost for ground that terrain hides from them."""
        if self.around.ground is None:
            return 0.0
        return math.fsum(
            target.hidden_m(target.passes(picked, 0))
            for target, picked in zip(self.visited(choice), choice.picked, strict=True)
        )
