"""SSAS written plainly: lists, heapq and a look at every node. The twin of the compiled search."""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass

from shapely.geometry import LineString, Point, Polygon

from planner.airspace.threats import risk_of_detection
from planner.transit.ssas import SsasParameters


@dataclass
class Node:
    number: int
    place: tuple[float, float]
    angle: float
    parent: Node | None
    depth: int
    length: float
    kill: float
    detection: float
    cost: float = 0.0
    state: str = "open"

    def line(self):
        return [*(self.parent.line() if self.parent else []), self.place]


@dataclass
class Surroundings:
    """Threats as values; discs never entered; polygons never entered; area never left."""

    threats: tuple = ()
    discs: tuple = ()
    polygons: tuple[Polygon, ...] = ()
    area: Polygon | None = None

    def allows(self, a, b):
        line = LineString([a, b])
        if self.area is not None and not self.area.contains(line):
            return False
        if any(line.distance(Point(e, n)) < radius for e, n, radius in self.discs):
            return False
        return not any(line.intersects(polygon) for polygon in self.polygons)


def differ(a, b):
    return abs(math.remainder(a - b, 2.0 * math.pi))


def square_mm(a, b):
    return math.floor(((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) * 1e6)


def leg_risks(a, b, around, p, backwards):
    """Risks at the dividing points and the far end of a leg, with margin and clipping where they are on."""
    length = math.dist(a, b)
    parts = []
    along = p.dividing_m
    while along < length - 1e-6 * p.dividing_m:
        parts.append(1.0 - along / length if backwards else along / length)
        along += p.dividing_m
    samples = [(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])) for s in parts] + [b]
    sums = {"missile": 0.0, "radar": 0.0}
    for t in around.threats:
        near_m = LineString([a, b]).distance(Point(t.centre)) if length else math.dist(a, t.centre)
        distances = [math.dist(s, t.centre) for s in samples]
        unseen = all(d > t.radius_m + p.soft_margin_m for d in [math.dist(a, t.centre), *distances])
        if p.clipping and unseen:
            distances = [near_m]
        sums[t.model] += sum(threat_risk(t, d, p.soft_margin_m) for d in distances)
    return sums["missile"], sums["radar"]


def threat_risk(t, distance, margin):
    if distance > t.radius_m + margin:
        return 0.0
    if t.model == "missile":
        # eq 11 itself goes on beyond its range test
        return t.radius_m**4 / (t.radius_m**4 + distance**4)
    return risk_of_detection(distance, math.inf, t.intensity_m)


@dataclass
class Run:
    """One run of Algorithm 3; modes ``point``, ``vector``, ``near`` and ``inverse``."""

    mode: str
    leg: float
    root: Node
    directed: bool
    goal: tuple[float, float]
    goal_angle: float
    direct: float
    weights: tuple[float, float, float]
    p: SsasParameters
    around: Surroundings
    backwards: bool

    def total(self, node, rest=0.0):
        w1, w2, w3 = self.weights
        cost = w1 * (node.length + rest) / self.direct + w2 * node.kill + w3 * node.detection
        return math.floor(cost * 1e9 + 0.5) * 1e-9

    def child(self, node, place, number):
        kill, detection = leg_risks(node.place, place, self.around, self.p, self.backwards)
        return Node(
            number,
            place,
            math.atan2(place[1] - node.place[1], place[0] - node.place[0]),
            node,
            node.depth + 1,
            node.length + math.dist(node.place, place),
            node.kill + kill,
            node.detection + detection,
        )

    def closings(self, node, number):
        """The goal's node behind this one: by one leg, else by the cheapest two."""
        p, rest = self.p, math.dist(node.place, self.goal)
        directed = self.directed or node.parent is not None
        if rest < self.leg - 1e-6 and node.parent is not None:
            return None
        bearing = math.atan2(self.goal[1] - node.place[1], self.goal[0] - node.place[0])
        limit = (p.max_turn_rad if rest >= 0.6 * self.leg else 0.0) + 1e-9
        turns_in = not directed or differ(bearing, node.angle) <= limit
        meets = self.mode == "point" or differ(bearing, self.goal_angle) <= limit
        if turns_in and meets and self.around.allows(node.place, self.goal):
            return self.child(node, self.goal, number)
        wide = differ(bearing, self.goal_angle) > 2.0 * p.max_turn_rad + 1e-9
        if self.mode == "point" or rest < 0.6 * self.leg or wide:
            return None
        ways = []
        limit = p.max_turn_rad + 1e-9
        for branch in range(p.sectors):
            last = self.goal_angle + p.max_turn_rad * (2.0 * branch + 1.0 - p.sectors) / p.sectors
            tip = (self.goal[0] - self.leg * math.cos(last), self.goal[1] - self.leg * math.sin(last))
            into = math.atan2(tip[1] - node.place[1], tip[0] - node.place[0])
            if math.dist(node.place, tip) < 0.6 * self.leg or differ(into, last) > limit:
                continue
            if directed and differ(into, node.angle) > limit:
                continue
            if self.around.allows(node.place, tip) and self.around.allows(tip, self.goal):
                ways.append(self.child(self.child(node, tip, number), self.goal, number + 1))
        return min(ways, key=self.total, default=None)

    def grow(self):
        p = self.p
        coarse = self.mode in ("point", "near")
        within_m = max(p.neighbour_radius_m, p.neighbour_part * self.leg if coarse else 0.0)
        within_rad = p.coarse_neighbour_angle_rad if coarse else p.neighbour_angle_rad
        queue = [(0.0, 0, self.root)]
        reached = [self.root]
        count = 1
        deepest = self.root
        while queue:
            _, _, node = heapq.heappop(queue)
            if node.state == "replaced":
                continue
            if node.state == "goal":
                return True, node
            node.state = "closed"
            if node.depth > deepest.depth:
                deepest = node
            near = math.dist(node.place, self.goal) <= 2.0 * self.leg + 1e-6
            if self.mode == "near" and near:
                return True, node
            if self.mode == "inverse" and node.parent and (near or node.depth >= p.extensions):
                return True, node
            if near and self.mode in ("point", "vector"):
                goal = self.closings(node, count)
                if goal is not None:
                    goal.state = "goal"
                    goal.cost = self.total(goal)
                    heapq.heappush(queue, (goal.cost, goal.number, goal))
                    count = goal.number + 1
            for angle in self.fan(node):
                place = (
                    node.place[0] + self.leg * math.cos(angle),
                    node.place[1] + self.leg * math.sin(angle),
                )
                if self.mode == "inverse":
                    back = math.atan2(place[1] - self.root.place[1], place[0] - self.root.place[0])
                    if differ(back, self.root.angle) > p.max_turn_rad + 1e-9:
                        continue
                if not self.around.allows(node.place, place):
                    continue
                new = self.child(node, place, count)
                new.angle = angle
                new.cost = self.total(new, math.dist(place, self.goal))
                neighbours = [
                    other
                    for other in reached
                    if math.dist(other.place, place) < within_m and differ(other.angle, angle) <= within_rad
                ]
                if neighbours:
                    old = min(neighbours, key=lambda other: (square_mm(other.place, place), other.number))
                    if new.cost >= old.cost:
                        continue
                    if old.state == "open":
                        old.state = "replaced"
                    reached.remove(old)
                reached.append(new)
                heapq.heappush(queue, (new.cost, new.number, new))
                count += 1
        return False, deepest

    def fan(self, node):
        p = self.p
        width = 2.0 * p.max_turn_rad / p.sectors
        if self.directed or node.parent is not None:
            return [node.angle - p.max_turn_rad + (k + 0.5) * width for k in range(p.sectors)]
        branches = round(2.0 * math.pi / width)
        first = math.atan2(self.goal[1] - node.place[1], self.goal[0] - node.place[0])
        return [first + k * 2.0 * math.pi / branches for k in range(branches)]


def plain_search(start, goal, around, weights, p):
    """Waypoints and cost, or None where the open set runs empty; ``start`` and ``goal`` are Anchors."""
    direct = max(math.dist(start.position, goal.position), p.fine_leg_m)
    coarse = max(direct / p.coarse_legs, p.fine_leg_m)

    def root_at(anchor, turned=0.0):
        kill = sum(
            threat_risk(t, math.dist(anchor.position, t.centre), p.soft_margin_m)
            for t in around.threats
            if t.model == "missile"
        )
        detection = sum(
            threat_risk(t, math.dist(anchor.position, t.centre), p.soft_margin_m)
            for t in around.threats
            if t.model == "radar"
        )
        angle = (anchor.angle_rad or 0.0) + turned
        return Node(0, anchor.position, angle, None, 0, 0.0, kill, detection)

    def run(mode, leg, root, directed, aim, aim_angle, backwards):
        return Run(mode, leg, root, directed, aim, aim_angle, direct, weights, p, around, backwards)

    if goal.angle_rad is None:
        directed = start.angle_rad is not None
        found, last = run("point", coarse, root_at(start), directed, goal.position, 0.0, False).grow()
        line = last.line()
    elif start.angle_rad is None:
        root = root_at(goal, math.pi)
        found, last = run("point", coarse, root, True, start.position, 0.0, True).grow()
        line = last.line()[::-1]
    else:
        inverse = run("inverse", p.fine_leg_m, root_at(goal, math.pi), True, start.position, 0.0, True)
        found, middle = inverse.grow()
        if not found and middle.parent is None:
            return None
        found, far = run("near", coarse, root_at(start), True, middle.place, 0.0, False).grow()
        if not found:
            return None
        root = Node(0, far.place, far.angle, None, 0, far.length, far.kill, far.detection)
        found, last = run("vector", p.fine_leg_m, root, True, goal.position, goal.angle_rad, False).grow()
        line = far.line()[:-1] + last.line()
    if not found:
        return None
    return line, Run.total(run("point", coarse, last, True, goal.position, 0.0, False), last)
