"""SSAS as a connector: search, make flyable, judge, and try again with other settings where it fails.

The first try is the paper's. Each further one states what it changes; they are tried in a fixed order until a
line enters nothing it could keep out of and is short enough.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import MultiPoint

from planner.airspace.threats import metres_inside, threat_arrays
from planner.airspace.values import Threat
from planner.airspace.zones import MITRE_LIMIT, KeepOut
from planner.dubins.path import Path
from planner.dubins.rounding import RoundingMethod, round_off
from planner.dubins.words import candidates
from planner.errors import InfeasibleError, OutOfBudgetError
from planner.progress import Stop, never, raise_if
from planner.route import Anchor, Pose
from planner.transit.ssas import MIN_CLOSING_PART, SsasParameters, SsasResult, search
from planner.transit.ssas_kernels import Space
from planner.wishes import Objective

Array = NDArray[np.float64]

#: A path is sampled this finely to compare metres inside threats of lines none of which is free of them.
SAMPLE_M = 5.0

#: Directions this near to a straight line are on it.
STRAIGHT_RAD = 1e-9

#: Samples stand for each other only when their directions differ by less than half a sector: with the
#: paper's comparison of places alone the last stage finds no route for most pairs of poses facing apart.
NEIGHBOUR_ANGLE_RAD = math.radians(10.0)
PLACES_ALONE_RAD = math.pi


@dataclass(frozen=True, slots=True)
class Attempt:
    """One try.

    Parameters
    ----------
    coarse_legs, neighbour_part, coarse_neighbour_angle_rad, heuristic_length
        As in ``SsasParameters``: more legs are shorter, down to the fine leg; a heuristic weight above 1
        finds sooner, though not the best.
    threats
        Soft threats cost what eqs 12 and 14 say, or are closed unless they hold an anchor, or ignored.
    margins
        How many margins zones grow and the area shrinks by.
    tight
        Whether fine legs are as short as the arcs of their corners allow, for turns in little room.
    from_goal
        As in ``search``.
    lead
        Whether the first and the last leg begin straight on, with room for half a corner.
    """

    coarse_legs: float
    neighbour_part: float = 0.5
    coarse_neighbour_angle_rad: float = NEIGHBOUR_ANGLE_RAD
    heuristic_length: float = 1.0
    threats: Literal["costly", "closed", "ignored"] = "closed"
    margins: float = 1.0
    tight: bool = False
    from_goal: bool = False
    lead: bool = True


#: The paper's setting first; then threats closed and shorter legs, from either end, at last without room to
#: spare; then any way at all.
ATTEMPTS = (
    Attempt(8.0, 0.0, PLACES_ALONE_RAD, threats="costly", margins=0.0),
    Attempt(32.0, tight=True),
    Attempt(16.0),
    Attempt(32.0, tight=True, from_goal=True),
    Attempt(16.0, from_goal=True),
    Attempt(16.0, 0.0, PLACES_ALONE_RAD),
    Attempt(32.0),
    Attempt(math.inf, tight=True, heuristic_length=2.0),
    Attempt(math.inf, tight=True, heuristic_length=2.0, from_goal=True),
    Attempt(math.inf, margins=0.0, tight=True, from_goal=True, lead=False),
    Attempt(math.inf, heuristic_length=2.0, margins=0.0, tight=True, lead=False),
    Attempt(32.0, threats="ignored", margins=0.0),
    Attempt(32.0, threats="ignored", margins=0.0, tight=True, lead=False),
)

#: A line no longer than this many times the shortest turning line without obstacles is taken at once;
#: a longer one only when there is another to compare it with.
SHORT_RATIO = 1.3

#: Nodes one run of an attempt may reach; routes that are found seldom take more.
MAX_NODES = 6_000


def connect(
    start: Anchor,
    goal: Anchor,
    *,
    threats: tuple[Threat, ...],
    objective: Objective,
    height_m: float,
    keep_out: KeepOut,
    radius_m: float,
    smoothing: RoundingMethod = "fillet",
    stop: Stop = never,
) -> tuple[Path, SsasResult]:
    """A flyable line from one anchor to another by SSAS.

    Parameters
    ----------
    start, goal
        Places, and directions where not None; met exactly.
    threats, objective
        Threats, and the weights of length, missile and radar (eq 25).
    height_m
        Flown over the ground, the datum of threat heights.
    keep_out
        Zones and area. Hard ones are never entered; soft threats of positive weight only where one holds an
        anchor, or where no attempt finds a way round.
    radius_m
        Turn radius of the arcs.
    smoothing
        How legs become arcs, see ``planner.dubins.rounding.round_off``.
    stop
        Asked before each attempt and each run of the search.

    Returns
    -------
    Path, SsasResult
        The line, and the legs it was made from; their costs are those of the search, which runs between
        the ends of the straight leads.

    Raises
    ------
    InfeasibleError
        Where no attempt gives a line free of hard zones inside the area; constraint ``search`` where every
        attempt ended for want of nodes, so that a way may exist.
    """
    job = _Job(start, goal, threats, objective, height_m, keep_out, radius_m)
    failures: list[tuple[bool, InfeasibleError]] = []
    clear: list[tuple[Path, SsasResult]] = []
    unclear: list[tuple[float, Path, SsasResult]] = []
    wanted = job.keep_out_wanted()
    hard = job.keep_out_hard()
    attempts = ATTEMPTS if not job.is_straight() else (replace(ATTEMPTS[0], lead=False), *ATTEMPTS)
    for attempt in attempts:
        raise_if(stop)
        if len(clear) == 2 or (clear and attempt.threats == "ignored"):
            break
        try:
            found = job.search(attempt, stop)
        except OutOfBudgetError:
            continue
        except InfeasibleError as error:
            failures.append((attempt.threats == "closed", error))
            continue
        path = round_off(found.waypoints, start.angle_rad, goal.angle_rad, radius_m, wanted.clear, smoothing)
        if wanted.clear(path):
            if path.length_m <= job.short_m():
                return path, found
            clear.append((path, found))
        elif hard.clear(path):
            inside_m = metres_inside(path.sample(SAMPLE_M)[:, :2], job.threats, job.height_m)
            unclear.append((inside_m, path, found))
        else:
            failures.append((attempt.threats == "closed", job.not_clear(hard, path)))
    if clear:
        return min(clear, key=lambda line: line[0].length_m)
    if unclear:
        return min(unclear, key=lambda line: (line[0], line[1].length_m))[1:]
    raise job.worst(failures)


def avoidable(
    start: Anchor,
    goal: Anchor,
    threats: tuple[Threat, ...],
    objective: Objective,
    height_m: float,
    keep_out: KeepOut,
) -> KeepOut:
    """What a line between two anchors can keep out of: all but threats of no weight or that hold one."""
    return _Job(start, goal, threats, objective, height_m, keep_out, math.inf).keep_out_wanted()


@dataclass(frozen=True, slots=True)
class _Job:
    start: Anchor
    goal: Anchor
    threats: tuple[Threat, ...]
    objective: Objective
    height_m: float
    keep_out: KeepOut
    radius_m: float

    def parameters(self, attempt: Attempt) -> SsasParameters:
        paper = SsasParameters()
        # two half corners, 2 R tan(φmax / 2): what a leg between arcs is at least
        least_m = 1.01 * 2.0 * self.radius_m * math.tan(0.5 * paper.max_turn_rad)
        fine_m = least_m if attempt.tight else max(paper.fine_leg_m, least_m / MIN_CLOSING_PART)
        return replace(
            paper,
            fine_leg_m=fine_m,
            coarse_legs=attempt.coarse_legs,
            heuristic_length=attempt.heuristic_length,
            neighbour_radius_m=paper.neighbour_radius_m * fine_m / paper.fine_leg_m,
            neighbour_part=attempt.neighbour_part,
            neighbour_angle_rad=NEIGHBOUR_ANGLE_RAD,
            coarse_neighbour_angle_rad=attempt.coarse_neighbour_angle_rad,
            soft_margin_m=self.margin_m,
            max_nodes=MAX_NODES,
        )

    @property
    def margin_m(self) -> float:
        """Above what an arc cuts off a corner, R (1 / cos(φmax / 2) - 1) = 0.035 R."""
        return max(SsasParameters().soft_margin_m, 0.05 * self.radius_m)

    @property
    def lead_m(self) -> float:
        """Straight on before the first corner and after the last: half a corner's arc."""
        return 1.01 * self.radius_m * math.tan(0.5 * SsasParameters().max_turn_rad)

    def short_m(self) -> float:
        """Length of a line that leaves little to gain."""
        bearing_rad = math.atan2(self.goal.north_m - self.start.north_m, self.goal.east_m - self.start.east_m)
        begin, end = (
            Pose(*anchor.position, bearing_rad if anchor.angle_rad is None else anchor.angle_rad)
            for anchor in (self.start, self.goal)
        )
        return SHORT_RATIO * candidates(begin, end, self.radius_m)[0].length_m

    def is_straight(self) -> bool:
        """Whether the anchors lie on one straight line in their directions."""
        (e0, n0), (e1, n1) = self.start.position, self.goal.position
        bearing_rad = math.atan2(n1 - n0, e1 - e0)
        return all(
            anchor.angle_rad is None
            or abs(math.remainder(anchor.angle_rad - bearing_rad, 2.0 * math.pi)) <= STRAIGHT_RAD
            for anchor in (self.start, self.goal)
        )

    def search(self, attempt: Attempt, stop: Stop) -> SsasResult:
        lead_m = self.lead_m if attempt.lead else 0.0
        begin, end = _moved(self.start, lead_m), _moved(self.goal, -lead_m)
        space = self._space(attempt, (self.start, begin, end, self.goal))
        objective = self.objective
        weights = (objective.length, objective.missile, objective.radar)
        if attempt.threats == "ignored":
            weights = (objective.length, 0.0, 0.0)
        aimed, from_goal = (begin, end), attempt.from_goal
        if attempt.from_goal and (begin.angle_rad is None) != (end.angle_rad is None):
            # a direction lent to the free end lets the other be reached in three stages, the last ones fine
            from_goal = end.angle_rad is None
            bearing_rad = math.atan2(end.north_m - begin.north_m, end.east_m - begin.east_m)
            aimed = (
                replace(begin, angle_rad=bearing_rad if begin.angle_rad is None else begin.angle_rad),
                replace(end, angle_rad=bearing_rad if end.angle_rad is None else end.angle_rad),
            )
        found = search(*aimed, space, weights, self.parameters(attempt), stop, from_goal=from_goal)
        points = [found.waypoints]
        if begin != self.start:
            points.insert(0, np.array([self.start.position]))
        if end != self.goal:
            points.append(np.array([self.goal.position]))
        return replace(found, waypoints=np.vstack(points))

    def _space(self, attempt: Attempt, anchors: tuple[Anchor, ...]) -> Space:
        margin_m = attempt.margins * self.margin_m
        places = np.array([anchor.position for anchor in anchors])
        ignored = self._ignored()
        discs: list[tuple[float, float, float]] = []
        for disc in self.keep_out.discs:
            room_m = float(np.hypot(*(places - (disc.east_m, disc.north_m)).T).min()) - disc.radius_m
            if disc.hard or (attempt.threats == "closed" and disc.name not in ignored and room_m > 0.0):
                # grown no further than to leave the anchors outside
                grown_m = disc.radius_m + min(margin_m, 0.9 * max(0.0, room_m))
                discs.append((disc.east_m, disc.north_m, grown_m))
        zones = self.keep_out if margin_m == 0.0 else self._grown(margin_m, places)
        missiles, radars = threat_arrays(self.threats, self.height_m)
        edges, offsets = zones.edge_arrays()
        return Space(
            missiles=missiles,
            radars=radars,
            discs=np.array(discs, dtype=np.float64).reshape(-1, 3),
            edges=edges,
            offsets=offsets,
            area=zones.area_edges(),
        )

    def _grown(self, margin_m: float, places: Array) -> KeepOut:
        """Polygons grown and the area shrunk by a margin, those left alone that would take in an anchor."""
        points = MultiPoint(places)
        polygons = []
        for zone in self.keep_out.polygons:
            grown = zone.polygon.buffer(margin_m, join_style="mitre", mitre_limit=MITRE_LIMIT)
            fits = grown.geom_type == "Polygon" and not grown.intersects(points)
            polygons.append(replace(zone, polygon=grown) if fits else zone)
        area = self.keep_out.area
        if area is not None:
            shrunk = area.buffer(-margin_m, join_style="mitre", mitre_limit=MITRE_LIMIT)
            area = shrunk if shrunk.contains(points) else area
        return replace(self.keep_out, polygons=tuple(polygons), area=area)

    def _ignored(self) -> frozenset[str]:
        """Soft threats of no weight."""
        weight = {"missile": self.objective.missile, "radar": self.objective.radar}
        return frozenset(t.name for t in self.threats if not t.hard and weight[t.model] <= 0.0)

    def keep_out_hard(self) -> KeepOut:
        """What is never entered."""
        return self.keep_out.without([disc.name for disc in self.keep_out.discs if not disc.hard])

    def keep_out_wanted(self) -> KeepOut:
        """The same and the soft threats that can be kept out of: none that holds an anchor."""
        places = (self.start.position, self.goal.position)
        names = self._ignored() | {
            disc.name
            for disc in self.keep_out.discs
            if not disc.hard
            and any(math.dist(place, (disc.east_m, disc.north_m)) < disc.radius_m for place in places)
        }
        return self.keep_out.without(names)

    def worst(self, failures: list[tuple[bool, InfeasibleError]]) -> InfeasibleError:
        """The first failure that closed threats have no part in, else the first; else the spent budgets."""
        if failures:
            return min(failures, key=lambda failure: failure[0])[1]
        return InfeasibleError(
            "search",
            "transit",
            f"none of {len(ATTEMPTS)} searches from {self.start.position} to {self.goal.position} found a "
            f"way within {MAX_NODES} nodes",
            "Connect by tangents, or open the way between the two.",
        )

    def not_clear(self, zones: KeepOut, path: Path) -> InfeasibleError:
        conflict = zones.conflict(path)
        name = "transit" if conflict is None else conflict.zone
        return InfeasibleError(
            "area" if name == "area" else "hard-zone",
            name,
            f"turns of {self.radius_m:.0f} m from {self.start.position} to {self.goal.position} enter it",
            "Give the passes more room, or let the aircraft turn tighter.",
            None if conflict is None else conflict.where,
        )


def _moved(anchor: Anchor, ahead_m: float) -> Anchor:
    """The anchor some metres on in its direction; itself where it has none."""
    if anchor.angle_rad is None or ahead_m == 0.0:
        return anchor
    return replace(
        anchor,
        east_m=anchor.east_m + ahead_m * math.cos(anchor.angle_rad),
        north_m=anchor.north_m + ahead_m * math.sin(anchor.angle_rad),
    )
