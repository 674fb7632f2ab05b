"""A lower bound on the length of any plan that sees given regions.

What is relaxed. A plan flies passes, straight and each with its settling run, joined by lines that turn no
tighter than the aircraft can. Here

- there are no threats, no zones, no operating area: lines and passes may be anywhere;
- a region that one pass sees whole asks for one of those passes: any heading, any offset, both continuous;
- a region that takes several passes, one after the other or with other regions between, asks for as many as
  it takes at least: of the parallel strips of one swath that hold it each is flown, all along the same
  direction, one way or the other, as far as the region surely reaches in it;
- where one pass may see the region whole and several may too, one of either is kept.

Dropping a part of a line between two poses cannot make the shortest line through the rest longer, so every
plan over these regions is a tour of the relaxed problem, and no shorter than its best. Regions divided into
parts count as divided; ``ways`` looks at the ways a region may be taken.

How the relaxed one is bounded. Passes are held in cells, boxes of headings and offsets, and lines between
cells bounded by the mean value theorem (``lines_kernels``): what is given away goes with the square of
a cell's size. Up to ``EXACT_UP_TO`` passes the bound is exact over the order (``search``), beyond that
over trees (``trees``). Regions of many strips are bounded as a whole (``sweeps``): of these all
strips count, and the best bound of these is taken.
"""

from __future__ import annotations

from collections.abc import Sequence

from shapely.geometry.base import BaseGeometry

from planner.bounds.allowance import Allowance
from planner.bounds.nodes import nodes, terminal
from planner.bounds.search import exact_bound_m
from planner.bounds.sweeps import MOST_ORDERED, sweeps_bound_m
from planner.bounds.trees import trees_bound_m
from planner.coverage.strips.sweeps import Side
from planner.progress import Stop, never
from planner.route import Terminal
from planner.vehicle.model import FlightModel

#: Passes up to which the order is searched exactly.
EXACT_UP_TO = 13
#: Strips of one region asked for at most: fewer where the order can then be searched exactly.
MOST_STRIPS = 8
#: Gaps of a route worth proving, the last first only where that takes little; its mission phase, which is
#: shorter, then mostly has 5 % at most.
GAPS = (0.047, 0.02)
#: Lines between cells to evaluate: exactly over the order up to so many passes; over trees, for each pass.
EFFORT_EXACT, EFFORT_TREES = {9: 2_500_000, EXACT_UP_TO: 8_000_000}, 120_000
#: Of regions of more strips than this the whole stays say more, as a rule: of their passes no more effort.
FEW_STRIPS, EFFORT_BESIDES = 2, 800_000
#: Where the exact search comes out further below than this, trees may do better.
POOR_GAP = 0.15


def lower_bound_m(
    ends: tuple[Terminal, Terminal],
    model: FlightModel,
    sides: Sequence[Sequence[Side]],
    known_m: float,
    effort: int | None = None,
    part: float = 1.0,
    stop: Stop = never,
    allowance: Allowance | None = None,
    *,
    grounds: Sequence[BaseGeometry | None] | None = None,
) -> float:
    """No plan that sees these regions is shorter than this.

    Parameters
    ----------
    sides
        For each region, part of one or visit to one its ways to be seen.
    known_m
        Length of a plan: the bound is never above it, and says most just below it.
    effort
        Lines between cells to evaluate, about two million a second.
    part
        Of the effort where it is not given.
    stop, allowance
        The one cancels; the other is for the search for a better bound.
    grounds
        Of each region what its passes, and those over others near it, see together; None for the region.
    """
    allowance = allowance or Allowance()
    beside = grounds or [None] * len(sides)
    by_strips = [
        nodes(each, model.settle_m, index, MOST_STRIPS, ground)
        for index, (each, ground) in enumerate(zip(sides, beside, strict=True))
    ]
    passes = [node for of_region in by_strips for node in of_region]
    between = (terminal(ends[0]), terminal(ends[1]))
    radius_m = model.turn_radius_m
    best_m, most_strips = 0.0, max(len(of_region) for of_region in by_strips)
    by_sweeps = most_strips > FEW_STRIPS and len(by_strips) <= MOST_ORDERED
    joined = any(ground is not None for ground in beside)
    if most_strips > 1 or joined:
        whole = [of_region[0] for of_region in by_strips]
        best_m = sweeps_bound_m(whole, *between, radius_m, known_m * (1.0 - GAPS[0]), stop, allowance)
    if len(passes) <= EXACT_UP_TO and best_m < known_m * (1.0 - GAPS[0]) and not allowance.over:
        targets_m = tuple(known_m * (1.0 - gap) for gap in GAPS)
        most = exact_effort(len(passes))
        work = effort or int(part * (most if most_strips <= FEW_STRIPS else EFFORT_BESIDES))
        best_m = max(best_m, exact_bound_m(passes, *between, radius_m, targets_m, work, stop, allowance))
    if len(passes) > 1 and best_m < known_m * (1.0 - POOR_GAP) and not by_sweeps and not allowance.over:
        work = effort or int(part * EFFORT_TREES * len(passes))
        best_m = max(best_m, trees_bound_m(passes, *between, radius_m, known_m, work, stop, allowance))
    return min(best_m, known_m)


def exact_effort(passes: int) -> int:
    """Lines between cells worth evaluating for so many passes."""
    return next(most for up_to, most in EFFORT_EXACT.items() if passes <= up_to)
