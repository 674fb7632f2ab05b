"""The route of Li, Chen, Wang, Li (2018): step 3 of Algorithm 1, one decision after the other."""

from __future__ import annotations

from planner.airspace.values import Threat
from planner.coverage.strips.choices import Choices
from planner.progress import Progress, Stop, never, raise_if, silent
from planner.route import Anchor, CollectPass, Route, Terminal
from planner.routing.greedy.approach import best_approach
from planner.routing.greedy.offsets import best_passes
from planner.routing.tour import TourMethod, order
from planner.wishes import Objective


def li2018_route(
    located: tuple[Choices, ...],
    threats: tuple[Threat, ...],
    objective: Objective,
    ends: tuple[Terminal, Terminal],
    seed: int = 0,
    progress: Progress = silent,
    stop: Stop = never,
    *,
    tour: TourMethod = "genetic",
) -> tuple[Route, tuple[int, ...]]:
    """Order, choose angles, choose offsets.

    The operating area and hard zones are always kept (constraint c4), and choices that leave room to turn at
    both ends go before others. The paper leaves threats out of the choice of angles (its section 6,
    relaxation 4); choices graded with them in mind leave them out where there is another.

    Parameters
    ----------
    located
        What there is to choose from for each region.
    threats
        Those that act at the level flown.
    progress
        Gets ``"routing"`` with the fraction done.
    tour
        Method of the visiting order; ``"genetic"`` is the paper's.

    Returns
    -------
    tuple
        The route, and the regions in the order visited, as indices of ``located``.

    Raises
    ------
    CancelledError
        Once ``stop`` says so.
    """
    raise_if(stop)
    progress("routing", 0.0)
    start, end = ends
    places = [item.region.centroid for item in located]
    visiting = order(places, start.position, end.position, tour, seed)
    origin = Anchor(*start.position, start.angle_rad)
    passes: list[CollectPass] = []
    for number, place in enumerate(visiting):
        raise_if(stop)
        progress("routing", number / len(visiting))
        region_choices = located[place]
        side, index = best_approach(origin, region_choices)
        passes.extend(
            best_passes(origin, region_choices, region_choices.sides[side], index, threats, objective)
        )
        origin = Anchor(*passes[-1].end, passes[-1].angle_rad)
    progress("routing", 1.0)
    return Route(tuple(passes)), visiting
