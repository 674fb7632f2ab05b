"""From passes in order to the whole flight: up to the first, on from each to the next, down from the last."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from typing import TypeVar

import numpy as np

from planner.airspace.airspace import Airspace, Level
from planner.airspace.zones import TRANSIT_MARGIN_M, KeepOut, keep_out
from planner.dubins.path import Path, Segment, join
from planner.errors import InfeasibleError
from planner.profile.change import Changed, Layers, changed, kept
from planner.profile.compose import Composed, compose, times_of
from planner.profile.ends import Surround, circle_radius_m, climb_slope_rad, down, sink_slope_rad, up
from planner.profile.finish import finish_among, finish_of
from planner.profile.following import Following
from planner.profile.heights import Heights
from planner.profile.heights import level as level_heights
from planner.profile.lines import cut
from planner.profile.rise import Rise
from planner.progress import Progress, Stop, raise_if
from planner.publish import Leg
from planner.route import Anchor, CollectPass, Terminal
from planner.vehicle.model import FlightModel

#: Take-off, climbing turns and approaches keep this far: they are held less well than lines.
MANOEUVRE_MARGIN_M = 20.0

#: From its middle a flight comes so far until it is on its last circle, in radii of that.
ROUND_RADII = 2.5

#: A flyable line between two anchors clear of zones; raises InfeasibleError.
Connector = Callable[[Anchor, Anchor, KeepOut], Path]
#: The part of a line that is flown low.
Low = Callable[[Path], Path]
#: What one leg is made of by a connector.
Made = TypeVar("Made")


@dataclass(frozen=True, slots=True)
class Station:
    """Where a leg leads: a pass, or a place that is flown over.

    Parameters
    ----------
    arrive
        Where the leg ends: before the settling run of a pass.
    collect
        The pass; None where there is none.
    altitude_m
        Its own, over the flight's datum; None for the route's.
    followed
        Heights of a pass that follows the ground, over the flight's datum; None for a level one.
    hold
        Circles flown before the settling run, back to where the leg ends; None without any.
    """

    name: str
    arrive: Anchor
    collect: CollectPass | None = None
    altitude_m: float | None = None
    followed: Heights | None = None
    hold: Path | None = None

    @classmethod
    def of(
        cls,
        collect: CollectPass,
        settle_m: float,
        altitude_m: float | None = None,
        followed: Heights | None = None,
    ) -> Station:
        """That of a pass with so much straight flight before it."""
        pose = collect.settling(settle_m)
        arrive = Anchor(*pose.position, pose.angle_rad)
        return cls("+".join(collect.regions), arrive, collect, altitude_m, followed)

    def heights(self, levels: FlightLevels) -> Heights:
        """Along its pass, at the levels of its flight."""
        length_m = 0.0 if self.collect is None else self.collect.length_m
        return self.followed or level_heights(length_m, levels.at(self.altitude_m).altitude_m)


@dataclass(frozen=True, slots=True)
class FlightLevels:
    """The flight's heights: one level of it, and what lies under it.

    Parameters
    ----------
    airspace, level
        Where it is flown.
    """

    airspace: Airspace
    level: Level

    @property
    def altitude_m(self) -> float:
        """Of the level, over the flight's datum."""
        return self.level.altitude_m

    def at(self, altitude_m: float | None) -> FlightLevels:
        """Another level of the same flight; this one where no altitude is given."""
        return self if altitude_m is None else replace(self, level=self.level.at(altitude_m))

    @property
    def home_ground_m(self) -> float:
        """Altitude of home over the flight's datum."""
        return self.altitude_m - self.level.height_m

    @property
    def datum_amsl_m(self) -> float:
        """Height of the flight's datum over mean sea level."""
        return self.level.amsl_m - self.altitude_m

    def ground_m(self, place: tuple[float, float]) -> float:
        """Altitude of the ground at a place over the flight's datum: home's where there is no terrain."""
        ground = self.airspace.terrain
        if ground is None:
            return self.home_ground_m
        there_m = float(ground.at(np.array([place]))[0])
        return self.home_ground_m if math.isnan(there_m) else there_m - self.datum_amsl_m

    def zones(self, margin_m: float, lowest: Level | None = None) -> KeepOut:
        """What is to be kept out of at the level, or anywhere from a lower one up to it.

        What is kept from everything hard counts towards the margin; lines keep theirs besides.
        """
        besides_m = max(TRANSIT_MARGIN_M, margin_m - self.airspace.clearance_m)
        return keep_out(self.airspace, self.level, besides_m, lowest=lowest, edge_m=margin_m)

    def ground(self, altitude_m: float) -> Level:
        """That of ground at an altitude."""
        return Level(altitude_m - self.home_ground_m, altitude_m + self.datum_amsl_m)


def fly_whole(
    stations: Sequence[Station],
    ends: tuple[Terminal, Terminal],
    model: FlightModel,
    levels: FlightLevels,
    connectors: Mapping[str, Connector],
    cost_m: Callable[[Path], float],
    unminded: Collection[str],
    progress: Progress,
    stop: Stop,
    following: Following | None = None,
) -> tuple[Composed, tuple[Leg, ...], tuple[str, ...]]:
    """The whole flight of one aircraft, its legs, and notes on legs that not the first connector found.

    Parameters
    ----------
    stations
        In flight order, one at least.
    ends
        Start and end.
    connectors
        By the name of their method; the first that finds a line makes the leg.
    cost_m
        Of a line: its length, and what its risk counts.
    unminded
        Threats whose risk has no weight.
    following
        What the ground is followed by; None for a level flight.

    Raises
    ------
    InfeasibleError
        Where no line leads from one to the next, or there is no place to climb in.
    """
    start, end = ends
    names = [start.name, *(station.name for station in stations), end.name]
    legs: list[Leg] = []
    notes: list[str] = []

    def made(make: Callable[[Connector], Made]) -> Made:
        ends_of_leg = (names[len(legs)], names[len(legs) + 1])
        *others, (last, connector) = connectors.items()
        for method, other in others:
            try:
                found = make(other)
            except InfeasibleError as error:
                said = " and ".join(ends_of_leg)
                notes.append(f"{method.upper()} connects {said} {error.message}: {last} used")
            else:
                legs.append(Leg(*ends_of_leg, method))
                return found
        found = make(connector)
        legs.append(Leg(*ends_of_leg, last))
        return found

    progress("transit", 0.0)
    layers = _Layers(levels, unminded, cost_m, stop)
    passes = [(station.collect, station.heights(levels)) for station in stations]
    first, goal, top = stations[0], stations[0].arrive, levels.at(stations[0].altitude_m)
    first_m, last_m = passes[0][1].knots[0][1], passes[-1][1].knots[-1][1]
    climb_m = top.level.height_m / math.tan(climb_slope_rad(model))
    if start.over_home_m is None:

        def risen(connector: Connector) -> Rise:
            bottom = top.ground(top.home_ground_m)
            around = layers.around(top, bottom, connector, lambda path: cut(path, 0.0, climb_m))
            if following is None:
                return up(start, top.home_ground_m, goal, model, around)
            over = replace(around, raised=following.over_leg)

            def to(top_m: float) -> Rise:
                return up(start, top.home_ground_m, goal, model, replace(over, top_m=top_m))

            return following.rising(to, first_m, start.position)

        rising = made(risen)
    else:
        # In the air already: on from there as from one pass to the next.
        aloft, from_m = Anchor(*start.position, start.angle_rad), levels.home_ground_m + start.over_home_m
        leg = made(partial(_changed, aloft, goal, (from_m, first_m), model, layers))
        rising = Rise(leg.path, leg.heights, 0.0, 0.0, leg.inserted_m)
    rising = _settled(rising, first)
    if following is not None:
        rising = following.over_rise(rising, first_m)
    arrived, between = rising.path, []
    for (here, there), ((_, left), (_, reached)) in zip(pairwise(stations), pairwise(passes), strict=True):
        raise_if(stop)
        progress("transit", len(legs) / (len(stations) + 1))
        between_m = (left.knots[-1][1], reached.knots[0][1])
        ends_of_leg = (_leaves(here, arrived), there.arrive)
        if following is None:
            leg = made(partial(_changed, *ends_of_leg, between_m, model, layers))
        else:
            leg = made(partial(_followed, *ends_of_leg, between_m, model, layers, following))
        arrived = _straight_on(leg.path, there)
        settled_m = arrived.length_m - leg.path.length_m
        if settled_m > 0.0:
            leg = replace(leg, path=arrived, heights=leg.heights.then(level_heights(settled_m, between_m[1])))
        if following is not None:
            leg = replace(leg, heights=following.over_leg(leg.path, leg.heights))
        between.append(leg)
    origin, top = _leaves(stations[-1], arrived), levels.at(stations[-1].altitude_m)
    grounds_m = (top.home_ground_m, top.ground_m(end.position))
    among = (circle_radius_m(model), layers.zones(top, top.ground(grounds_m[0]), TRANSIT_MARGIN_M))
    finish = finish_among(model.aircraft, start, end, *among)
    if finish != finish_of(model.aircraft, start, end):
        notes.append(
            f"{end.name}: the flight ends with a landing: the circle of {among[0]:.0f} m round home that a "
            "return ends in would leave the area or enter a zone"
        )

    # It may come down on lower ground than it took off from.
    bottom = top.ground(grounds_m[0 if finish == "return" else 1])
    sink_m = (top.level.height_m - bottom.height_m) / math.tan(sink_slope_rad(model))

    def fallen(connector: Connector) -> Rise:
        low = layers.around(
            top, bottom, connector, lambda path: cut(path, path.length_m - sink_m, path.length_m)
        )
        where = (end, start.ground, grounds_m, origin, model)
        if following is None:
            return down(*where, low, finish)
        over = replace(low, raised=following.over_leg)
        circles = model.aircraft.type != "multirotor" and finish != "land"

        def to(top_m: float) -> Rise:
            return down(*where, replace(over, top_m=top_m), finish)

        at = start.ground if finish == "return" else end.position
        return following.falling(to, last_m, at, ROUND_RADII * circle_radius_m(model) if circles else 0.0)

    falling = made(fallen)
    if following is not None:
        falling = following.over_fall(falling, last_m)
    times = times_of(model, levels.datum_amsl_m)
    composed = compose(rising, between, passes, falling, finish, times)
    return composed, tuple(legs), tuple(notes)


@dataclass(slots=True)
class _Layers:
    """What is kept out of between two levels of one flight, found once for each pair."""

    levels: FlightLevels
    unminded: Collection[str]
    cost_m: Callable[[Path], float]
    stop: Stop
    _known: dict[tuple[Level, Level | None, float], KeepOut] = field(default_factory=dict)

    def zones(self, top: FlightLevels, lowest: Level | None, margin_m: float) -> KeepOut:
        """At a level, or anywhere from a lower one up to it."""
        key = (top.level, lowest, margin_m)
        if key not in self._known:
            self._known[key] = top.zones(margin_m, lowest)
        return self._known[key]

    def around(self, top: FlightLevels, lowest: Level, connector: Connector, low: Low) -> Surround:
        """What a change of height up to a level, or down from it, is placed in.

        Parameters
        ----------
        low
            The part of a line that is flown below the top.
        """
        zones, low_zones = self.zones(top, None, TRANSIT_MARGIN_M), self.zones(top, lowest, TRANSIT_MARGIN_M)

        def connect(here: Anchor, there: Anchor) -> Path:
            path = connector(here, there, zones)
            if low_zones == zones or low_zones.clear(low(path)):
                return path
            try:
                return connector(here, there, low_zones)
            except InfeasibleError:
                # Not every way is barred: how it climbs is looked at by itself.
                return path

        airspace = top.airspace
        return Surround(
            top.altitude_m,
            self.zones(top, lowest, MANOEUVRE_MARGIN_M).without(self.unminded),
            connect,
            self.cost_m,
            airspace.terrain,
            airspace.over_ground_m,
            self.stop,
        )


def _changed(
    start: Anchor,
    goal: Anchor,
    between_m: tuple[float, float],
    model: FlightModel,
    layers: _Layers,
    connector: Connector,
) -> Changed:
    """A leg from one pass to the next, each at its altitude."""
    here, there = pair = tuple(layers.levels.at(altitude_m) for altitude_m in between_m)
    if here.altitude_m == there.altitude_m:
        leg = connector(start, goal, layers.zones(here, None, TRANSIT_MARGIN_M))
        return kept(leg, here.altitude_m)
    bottom, top = sorted(pair, key=lambda levels: levels.altitude_m)
    around = layers.around(top, bottom.level, connector, lambda path: path)
    of_heights = Layers(
        layers.zones(bottom, None, TRANSIT_MARGIN_M),
        layers.zones(top, None, TRANSIT_MARGIN_M),
        layers.zones(top, bottom.level, TRANSIT_MARGIN_M),
    )
    line = partial(connector, start, goal)
    return changed(line, here.altitude_m, there.altitude_m, model, around, of_heights)


def _followed(
    start: Anchor,
    goal: Anchor,
    between_m: tuple[float, float],
    model: FlightModel,
    layers: _Layers,
    following: Following,
    connector: Connector,
) -> Changed:
    """The same over ground that is followed, clear of what reaches any height flown."""
    levels = layers.levels
    zones = layers.zones(levels, None, TRANSIT_MARGIN_M)
    around = layers.around(levels, levels.level.lowest, connector, lambda path: path)
    return following.leg(partial(connector, start, goal), *between_m, model, around, zones)


def _leaves(station: Station, arrived: Path) -> Anchor:
    """Where the next leg begins: behind the pass, or where the last leg has come to."""
    pose = arrived.end if station.collect is None else station.collect.exit
    return Anchor(*pose.position, pose.angle_rad)


def _settled(rising: Rise, first: Station) -> Rise:
    """A rise with the settling run of the first pass."""
    top_m = rising.heights.knots[-1][1]
    path = _straight_on(rising.path, first)
    gap_m = path.length_m - rising.path.length_m
    heights = rising.heights.then(level_heights(gap_m, top_m)) if gap_m > 0.0 else rising.heights
    return replace(rising, path=path, heights=heights)


def _straight_on(path: Path, station: Station) -> Path:
    """A leg with the settling run behind it: straight on to where the collect begins."""
    collect = station.collect
    if station.hold is not None:
        path = join(path, station.hold)
    gap_m = 0.0 if collect is None else math.dist(path.end.position, collect.start)
    return join(path, Path((Segment("straight", path.end, gap_m),))) if gap_m > 1e-9 else path
