"""The circle that a flight ends in where nobody lands it: over home after a return, or over its end."""

from __future__ import annotations

import math

from planner.dubins.path import Path, Segment, join
from planner.errors import InfeasibleError
from planner.profile.heights import Heights, tidy
from planner.profile.rise import ENTRIES, SIDES, Rise, Terms
from planner.route import Anchor, Pose


def circle_down(origin: Anchor, centre: tuple[float, float], bottom_m: float, terms: Terms) -> Rise:
    """From an origin at the top to a circle, and down on it, once round at least.

    All of it counts as descending turns: ``turns_m`` of what is given is its length, ``run_m`` is 0.

    Raises
    ------
    InfeasibleError
        Where no line leads to the circle.
    """
    drop_m = max(terms.top_m - bottom_m, 0.0)
    round_m = math.tau * terms.radius_m
    turns = max(1, math.ceil(drop_m / (round_m * math.tan(terms.turning_rad)) - 1e-9))
    best: tuple[tuple[bool, float], Path] | None = None
    failed: InfeasibleError | None = None
    for side in SIDES:
        turn = 1.0 if side == "left" else -1.0
        for k in range(ENTRIES):
            at_rad = k * math.tau / ENTRIES
            place = (
                centre[0] + terms.radius_m * math.cos(at_rad),
                centre[1] + terms.radius_m * math.sin(at_rad),
            )
            entry = Pose(*place, at_rad + turn * math.pi / 2.0)
            circles = Path((Segment(side, entry, turns * round_m, terms.radius_m),))
            try:
                leg = terms.connect(origin, Anchor(*place, entry.angle_rad))
            except InfeasibleError as error:
                failed = error
                continue
            path = join(leg, circles) if leg.length_m > 0.0 else circles
            rank = (not terms.zones.clear(circles), terms.cost_m(leg))
            if best is None or rank < best[0]:
                best = (rank, path)
    if best is None:
        raise failed or InfeasibleError("return", "home", "no way leads to its circle", "Give more room.")
    path = best[1]
    along_m = path.length_m - turns * round_m
    knots = ((0.0, terms.top_m), (along_m, terms.top_m), (path.length_m, terms.top_m - drop_m))
    return Rise(path, Heights(tidy(knots)), 0.0, path.length_m, path.length_m)
