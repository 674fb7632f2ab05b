"""The options of regions in a given order: the chosen ones, finer ones round them, true costs fed back.

Costs between options are estimates where threats are in the way. ``true_choice`` solves with the estimates,
asks the transit stage for the true cost of the legs of that solution alone, puts it in the estimate's place
(and what it is more by, fading, on legs close by), and solves again until the solution's legs are all true.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.lines import NO_ROOM_M
from planner.coverage.ways import Options, Target
from planner.dubins.estimate_kernels import point_costs, transit_costs
from planner.dubins.run_kernels import run_costs
from planner.progress import Stop, raise_if
from planner.route import CollectPass, Terminal
from planner.routing.large.kernels import discs_between
from planner.routing.legs import Legs
from planner.vehicle.wind import still_air_costs

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: What the passes at a place in the order cost besides their flight: ground they leave in shadow.
Besides = Callable[[int, Sequence[CollectPass]], float]

#: A leg's error is put on legs whose ends together are less than this far off too, fading with distance.
FADE_M = 300.0
#: An estimate this close to the truth stands.
TRUE_WITHIN_M = 0.5


def nothing(place: int, passes: Sequence[CollectPass]) -> float:
    """Besides their flight passes cost nothing."""
    return 0.0


@dataclass(frozen=True, slots=True)
class Layers:
    """Options of regions in visiting order, with the costs between one and the next.

    Parameters
    ----------
    options
        Of each place in the order.
    first, last
        From the start to the options of the first place, their own cost included; from those of the last
        place to the end.
    between
        From the options of each place to those of the next, the cost of the latter included.
    """

    options: tuple[Options, ...]
    first: Floats
    between: tuple[Floats, ...]
    last: Floats

    def through(self) -> list[Floats]:
        """The least cost of a way through each option, place by place."""
        pre, suf = [self.first], [self.last]
        for leg_m in self.between:
            pre.append((pre[-1][:, None] + leg_m).min(axis=0))
        for leg_m in reversed(self.between):
            suf.append((leg_m + suf[-1][None, :]).min(axis=1))
        return [before + after for before, after in zip(pre, reversed(suf), strict=True)]

    def only(self, place: int, option: int) -> Layers:
        """The same where no other option of a place may be taken."""
        barred = np.full(len(self.options[place].inner_m), np.inf)
        barred[option] = 0.0
        if place == 0:
            return replace(self, first=self.first + barred)
        between = tuple(
            leg_m + barred[None, :] if k == place - 1 else leg_m for k, leg_m in enumerate(self.between)
        )
        return replace(self, between=between)

    def best(self) -> tuple[float, list[int]]:
        """The cheapest way through: its cost, and the option at each place."""
        cost_m, came_from = self.first, []
        for leg_m in self.between:
            through_m = cost_m[:, None] + leg_m
            came_from.append(np.argmin(through_m, axis=0))
            cost_m = through_m.min(axis=0)
        whole_m = cost_m + self.last
        option = int(np.argmin(whole_m))
        chosen = [option]
        for links in reversed(came_from):
            chosen.append(int(links[chosen[-1]]))
        return float(whole_m[option]), chosen[::-1]


def layers_of(
    ends: tuple[Terminal, Terminal], around: Surroundings, options: list[Options], discs: Floats
) -> Layers:
    """Estimated costs along a chain of regions."""
    between = []
    for here, there in itertools.pairwise(options):
        costs = estimates(here.exits, there.entries, around, discs)
        between.append(costs + there.inner_m[None, :])
    first = from_start(ends[0], around, options[0].entries, discs) + options[0].inner_m
    return Layers(tuple(options), first, tuple(between), to_end(ends[1], around, options[-1].exits, discs))


def estimates(exits: Floats, entries: Floats, around: Surroundings, discs: Floats) -> Floats:
    """Estimated costs from poses to others, (N, M)."""
    minded = discs_between(exits, entries, discs, 0.0)
    costs = transit_costs(exits, entries, around.radius_m, minded)
    return _in_wind(costs, exits[:, None], entries[None], around)


def from_start(start: Terminal, around: Surroundings, entries: Floats, discs: Floats) -> Floats:
    """Estimated costs from the start to poses, (N,)."""
    if start.run_m > 0.0:
        runs_rad = np.array(start.runs_rad)
        costs, _ = run_costs(*start.position, start.run_m, runs_rad, entries, around.radius_m, discs)
    else:
        costs = _terminal_costs(start, entries, around, discs)
    return _in_wind(costs, np.array(start.position), entries, around)


def to_end(end: Terminal, around: Surroundings, exits: Floats, discs: Floats) -> Floats:
    """Estimated costs from poses to the end, (N,): those of the line flown backwards."""
    angle_rad = None if end.angle_rad is None else end.angle_rad + math.pi
    turned = exits + np.array([0.0, 0.0, math.pi])
    costs = _terminal_costs(Terminal(end.name, end.position, angle_rad), turned, around, discs)
    return _in_wind(costs, exits, np.array(end.position), around)


def _in_wind(costs_m: Floats, begins: Floats, ends: Floats, around: Surroundings) -> Floats:
    """Costs in metres through the air."""
    return still_air_costs(costs_m, begins, ends, around.airspeed_m_s, around.wind)


def _terminal_costs(terminal: Terminal, entries: Floats, around: Surroundings, discs: Floats) -> Floats:
    east_m, north_m = terminal.position
    if terminal.angle_rad is None:
        costs: Floats = point_costs(east_m, north_m, entries, around.radius_m, discs)
        return costs
    pose = np.array([[east_m, north_m, terminal.angle_rad]])
    from_pose: Floats = transit_costs(pose, entries, around.radius_m, discs)[0]
    return from_pose


def true_choice(
    layers: Layers,
    targets: Sequence[Target],
    legs: Legs,
    solves: int,
    stop: Stop,
    besides: Besides = nothing,
) -> tuple[float, list[int]]:
    """The cheapest way through by true costs, as far as ``solves`` solutions tell.

    Parameters
    ----------
    targets
        Of each place in the order.
    besides
        What the passes at a place cost besides their flight.

    Returns
    -------
    tuple
        The least true cost met, and the options that have it.
    """
    layers = replace(layers, first=layers.first.copy(), between=tuple(leg.copy() for leg in layers.between))
    layers = replace(layers, last=layers.last.copy())
    done_inner: set[tuple[int, int]] = set()
    done_legs: set[tuple[int, int, int]] = set()
    best_m, best = math.inf, layers.best()[1]
    for _ in range(solves):
        raise_if(stop)
        estimate_m, chosen = layers.best()
        if not estimate_m < best_m - TRUE_WITHIN_M:
            break
        true_m = 0.0
        for place, option in enumerate(chosen):
            options = layers.options[place]
            passes = targets[place].passes(options, option)
            inner_m = legs.inner_m(passes) + besides(place, passes)
            if (place, option) not in done_inner:
                done_inner.add((place, option))
                into = layers.first if place == 0 else layers.between[place - 1]
                into[..., option] += inner_m - options.inner_m[option]
            leaving = None if place == 0 else layers.options[place - 1].exits[chosen[place - 1]]
            leg_m = legs.between_m(leaving, options.entries[option])
            true_m += leg_m + inner_m
            into = layers.first[None, :] if place == 0 else layers.between[place - 1]
            row = 0 if place == 0 else chosen[place - 1]
            if (place, row, option) not in done_legs:
                done_legs.add((place, row, option))
                rows = options.entries[:1] if place == 0 else layers.options[place - 1].exits
                _put(into, row, option, leg_m + inner_m, rows, options.entries, done_legs, place)
        leg_m = legs.between_m(layers.options[-1].exits[chosen[-1]], None)
        true_m += leg_m
        place, last = len(chosen), chosen[-1]
        if (place, last, 0) not in done_legs:
            done_legs.add((place, last, 0))
            exits = layers.options[-1].exits
            _put(layers.last[:, None], last, 0, leg_m, exits, exits[:1], done_legs, place)
        if true_m < best_m:
            best_m, best = true_m, chosen
    return best_m, best


def _put(
    costs: Floats,
    row: int,
    column: int,
    true_m: float,
    rows: Floats,
    columns: Floats,
    done: set[tuple[int, int, int]],
    place: int,
) -> None:
    """Put a leg's true cost in the estimate's place, and its error, fading, on legs close by.

    Where there is no leg, those close by are as doubtful as ends without room to turn.
    """
    error_m = true_m - float(costs[row, column]) if math.isfinite(true_m) else NO_ROOM_M
    if math.isfinite(error_m) and error_m > TRUE_WITHIN_M:
        apart_m = (
            np.hypot(*(rows[:, :2] - rows[row, :2]).T)[:, None]
            + np.hypot(*(columns[:, :2] - columns[column, :2]).T)[None, :]
        )
        extra = error_m * np.maximum(0.0, 1.0 - apart_m / FADE_M)
        for _, other_row, other_column in [key for key in done if key[0] == place]:
            extra[other_row, other_column] = 0.0
        costs += extra
    costs[row, column] = true_m
