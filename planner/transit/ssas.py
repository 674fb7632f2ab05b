"""Sampling-based sparse A* search, SSAS (Li et al. 2018, section 4.4): straight legs round threats.

``search`` joins two anchors by legs of fixed length with bounded turning angles. Between two vectors it is
the bidirectional search of section 4.4.4; where one end is a point, one run from the vector to the point.
The tree itself is compiled, in ``ssas_kernels``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.airspace.kernels import point_risk
from planner.airspace.threats import DIVIDING_M
from planner.errors import InfeasibleError, OutOfBudgetError
from planner.progress import Stop, never, raise_if
from planner.route import Anchor
from planner.transit import ssas_kernels as tree
from planner.transit.ssas_kernels import Rules, Space

Array = NDArray[np.float64]

#: Where length counts for nothing it is searched with this weight: else all of a map free of risk ties.
LEAST_LENGTH_WEIGHT = 1e-3

#: The legs that close a route are at least this part of a leg: room for the arcs of two corners of 30°
#: whose radius is a leg (2 tan 15° = 0.54).
MIN_CLOSING_PART = 0.6


@dataclass(frozen=True, slots=True)
class SsasParameters:
    """How SSAS searches; defaults are the paper's (section 5.2) but for the two soft-threat settings.

    Parameters
    ----------
    fine_leg_m
        Leg of stages 1 and 3, and the least leg of stage 2.
    coarse_legs
        The leg of stage 2 is the direct distance over this number.
    max_turn_rad
        Maximum turning angle φmax (eq 8).
    sectors
        Sectors, and so branches, of a fan-tail.
    neighbour_radius_m
        r_c: one sample stands for its neighbourhood of this radius.
    neighbour_part
        Where legs are coarse r_c is at least this part of a leg; 0 in the paper. Ours.
    neighbour_angle_rad, coarse_neighbour_angle_rad
        Only samples whose directions differ by no more than this stand for each other, in stages 1 and 3 and
        in stage 2; π, as in the paper, compares places alone. Ours.
    heuristic_length, heuristic_missile, heuristic_radar
        Weights α1, α2, α3 of eq 23.
    dividing_m
        Distance between dividing points (eqs 12 and 14).
    soft_margin_m
        Widens the range tests of eqs 11 and 13, so that rounding a corner does not clip a disc. Ours.
    clipping
        A leg that crosses a disc between two samples counts its nearest point once. Ours.
    max_nodes
        Nodes one run may reach.
    """

    fine_leg_m: float = 100.0
    coarse_legs: float = 8.0
    max_turn_rad: float = math.radians(30.0)
    sectors: int = 5
    neighbour_radius_m: float = 50.0
    neighbour_part: float = 0.0
    neighbour_angle_rad: float = math.pi
    coarse_neighbour_angle_rad: float = math.pi
    heuristic_length: float = 1.0
    heuristic_missile: float = 0.0
    heuristic_radar: float = 0.0
    dividing_m: float = DIVIDING_M
    soft_margin_m: float = 10.0
    clipping: bool = True
    max_nodes: int = 200_000

    def __post_init__(self) -> None:
        """Refuse what would never end: neighbourhoods as wide as a leg swallow every child."""
        if not 0.0 < self.neighbour_radius_m < self.fine_leg_m:
            raise ValueError("neighbour_radius_m must be positive and less than fine_leg_m")
        if not 0.0 <= self.neighbour_part < 1.0:
            raise ValueError("neighbour_part must be at least 0 and less than 1")
        if not 0.0 < self.max_turn_rad < math.pi / 2.0 or self.sectors < 1:
            raise ValueError("max_turn_rad must lie between 0 and π/2, sectors must be at least 1")
        if not (self.coarse_legs > 0.0 and self.dividing_m > 0.0 and self.soft_margin_m >= 0.0):
            raise ValueError("coarse_legs and dividing_m must be positive, soft_margin_m not negative")

    def faithful(self) -> SsasParameters:
        """The same without what is ours: risks at samples alone, places alone compared."""
        return replace(
            self,
            soft_margin_m=0.0,
            clipping=False,
            neighbour_part=0.0,
            neighbour_angle_rad=math.pi,
            coarse_neighbour_angle_rad=math.pi,
        )

    @property
    def extensions(self) -> int:
        """N_ex of eq 27: legs enough for a half turn."""
        return math.ceil(math.pi / self.max_turn_rad - 1e-9)


@dataclass(frozen=True, slots=True)
class SsasStage:
    """One run of Algorithm 3: its name, leg length, nodes reached and the legs it gave to the route."""

    name: str
    leg_m: float
    nodes: int
    legs: int


@dataclass(frozen=True, slots=True)
class SsasResult:
    """A route of straight legs.

    Parameters
    ----------
    waypoints
        float64, shape (N, 2): east_m, north_m from start to goal.
    cost
        Weighted sum (eq 25) of the three that follow.
    cost_plr
        Path length ratio (eq 10): length over the direct distance, or over one fine leg where that is more.
    cost_missile, cost_radar
        Risks as searched: eqs 12 and 14, with ``soft_margin_m`` and ``clipping`` where they are on.
    nodes
        Nodes reached in all runs.
    stages
        The runs, in order.
    """

    waypoints: Array
    cost: float
    cost_plr: float
    cost_missile: float
    cost_radar: float
    nodes: int
    stages: tuple[SsasStage, ...]

    @property
    def length_m(self) -> float:
        """Length of the legs."""
        return float(np.hypot(*np.diff(self.waypoints, axis=0).T).sum())


def search(
    start: Anchor,
    goal: Anchor,
    space: Space,
    weights: tuple[float, float, float] = (1.0, 1.0, 1.0),
    parameters: SsasParameters | None = None,
    stop: Stop = never,
    *,
    from_goal: bool = False,
) -> SsasResult:
    """Join two anchors by legs of bounded turning angle (Algorithm 3, section 4.4.4).

    Parameters
    ----------
    start, goal
        B and F of the paper: the directions of flight there, or None for any.
    space
        Threats, zones and area as arrays.
    weights
        w1, w2, w3 of eq 25.
    parameters
        None for the defaults.
    stop
        Asked before each run.
    from_goal
        Between two vectors, grow from the goal and turn the route round: the better way where the goal is
        the end that is hemmed in. Ours.

    Raises
    ------
    InfeasibleError
        Where a tree could grow no more: ``turning-angle``, ``area`` or ``hard-zone``, whichever refused most.
    OutOfBudgetError
        Where a run reached ``max_nodes``.
    """
    job = _Job(start, goal, space, weights, parameters or SsasParameters(), stop)
    if goal.angle_rad is None:
        return job.point_run(start, goal, backwards=False)
    if start.angle_rad is None:
        return job.point_run(_reversed(goal), start, backwards=True)
    if from_goal:
        return job.three_stages(_reversed(goal), _reversed(start), backwards=True)
    return job.three_stages(start, goal, backwards=False)


def _reversed(anchor: Anchor) -> Anchor:
    angle_rad = anchor.angle_rad
    return replace(anchor, angle_rad=None if angle_rad is None else angle_rad + math.pi)


@dataclass(frozen=True, slots=True)
class _Job:
    start: Anchor
    goal: Anchor
    space: Space
    weights: tuple[float, float, float]
    parameters: SsasParameters
    stop: Stop

    @property
    def direct_m(self) -> float:
        apart_m = math.dist(self.start.position, self.goal.position)
        return max(apart_m, self.parameters.fine_leg_m)

    @property
    def coarse_leg_m(self) -> float:
        return max(self.direct_m / self.parameters.coarse_legs, self.parameters.fine_leg_m)

    def point_run(self, root: Anchor, aim: Anchor, backwards: bool) -> SsasResult:
        rules = self._rules(tree.TO_POINT, self.coarse_leg_m, root.angle_rad is not None, backwards)
        path, stage = self._run("coarse", self._root(root), aim, rules)
        return self._result(path, (stage,), backwards)

    def three_stages(self, root: Anchor, aim: Anchor, backwards: bool) -> SsasResult:
        fine_m = self.parameters.fine_leg_m
        rules = self._rules(tree.INVERSE, fine_m, True, not backwards)
        back, inverse = self._run("inverse", self._root(_reversed(aim)), root, rules)
        middle = Anchor(float(back[-1, tree.EAST]), float(back[-1, tree.NORTH]))
        rules = self._rules(tree.NEAR_POINT, self.coarse_leg_m, True, backwards)
        far, coarse = self._run("coarse", self._root(root), middle, rules)
        rules = self._rules(tree.TO_VECTOR, fine_m, True, backwards)
        close, fine = self._run("fine", far[-1], aim, rules)
        return self._result(np.vstack((far, close[1:])), (inverse, coarse, fine), backwards)

    def _root(self, anchor: Anchor) -> Array:
        missiles, radars = self.space.missiles, self.space.radars
        kill, detection = point_risk(*anchor.position, missiles, radars, self.parameters.soft_margin_m)
        return np.array([*anchor.position, anchor.angle_rad or 0.0, 0.0, kill, detection])

    def _rules(self, mode: int, leg_m: float, directed: bool, backwards: bool) -> Rules:
        p = self.parameters
        coarse = mode in (tree.TO_POINT, tree.NEAR_POINT)
        return Rules(
            mode=mode,
            directed=directed,
            backwards=backwards,
            leg_m=leg_m,
            min_leg_m=MIN_CLOSING_PART * leg_m,
            max_turn_rad=p.max_turn_rad,
            sectors=p.sectors,
            neighbour_radius_m=max(p.neighbour_radius_m, p.neighbour_part * leg_m)
            if coarse
            else p.neighbour_radius_m,
            neighbour_angle_rad=p.coarse_neighbour_angle_rad if coarse else p.neighbour_angle_rad,
            direct_m=self.direct_m,
            weight_length=max(float(self.weights[0]), LEAST_LENGTH_WEIGHT),
            weight_missile=float(self.weights[1]),
            weight_radar=float(self.weights[2]),
            heuristic_length=p.heuristic_length,
            heuristic_missile=p.heuristic_missile,
            heuristic_radar=p.heuristic_radar,
            dividing_m=p.dividing_m,
            margin_m=p.soft_margin_m,
            clipping=p.clipping,
            max_depth=p.extensions,
            max_nodes=p.max_nodes,
        )

    def _run(self, name: str, root: Array, aim: Anchor, rules: Rules) -> tuple[Array, SsasStage]:
        raise_if(self.stop)
        target = np.array([*aim.position, aim.angle_rad or 0.0])
        ended, nodes, outside, forbidden, path = tree.grow(root, target, self.space, rules)
        # stage 1 only has to leave the non-adjustment zone: where zones end it early, its deepest node serves
        if ended == tree.EMPTY and not (rules.mode == tree.INVERSE and path.shape[0] > 1):
            raise self._infeasible(name, path[-1], int(outside), int(forbidden))
        if ended == tree.SPENT:
            raise OutOfBudgetError(f"the {name} search from {self._ends()} reached {nodes} nodes")
        return path, SsasStage(name, rules.leg_m, int(nodes), path.shape[0] - 1)

    def _infeasible(self, name: str, last: Array, outside: int, forbidden: int) -> InfeasibleError:
        reasons = {"hard-zone": forbidden, "area": outside}
        constraint = max(reasons, key=lambda reason: reasons[reason])
        if not reasons[constraint]:
            constraint = "turning-angle"
        relaxation = {
            "hard-zone": "Give the passes more room round the zones, or shrink the zones.",
            "area": "Widen the area, or keep the regions further from its edge.",
            "turning-angle": "Allow a larger turning angle or shorter legs.",
        }[constraint]
        return InfeasibleError(
            constraint,
            "transit",
            f"the {name} search from {self._ends()} ran out of legs to try",
            relaxation,
            (float(last[tree.EAST]), float(last[tree.NORTH])),
        )

    def _ends(self) -> str:
        (e0, n0), (e1, n1) = self.start.position, self.goal.position
        return f"({e0:.0f}, {n0:.0f}) to ({e1:.0f}, {n1:.0f})"

    def _result(self, path: Array, stages: tuple[SsasStage, ...], backwards: bool) -> SsasResult:
        last = path[-1]
        plr = float(last[tree.LENGTH]) / self.direct_m
        kill, detection = float(last[tree.KILL]), float(last[tree.DETECTION])
        points = np.ascontiguousarray(path[::-1, :2] if backwards else path[:, :2])
        w1, w2, w3 = self.weights
        return SsasResult(
            waypoints=points,
            cost=w1 * plr + w2 * kill + w3 * detection,
            cost_plr=plr,
            cost_missile=kill,
            cost_radar=detection,
            nodes=sum(stage.nodes for stage in stages),
            stages=stages,
        )
