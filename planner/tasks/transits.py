"""From stations in order to the whole flight, by the methods asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import cast

from planner.airspace.envelope import SMOOTH_M
from planner.airspace.zones import KeepOut
from planner.dubins.path import Path, Segment
from planner.dubins.rounding import RoundingMethod
from planner.errors import InfeasibleError
from planner.profile.compose import Composed
from planner.progress import Progress, Stop
from planner.publish import Leg
from planner.route import Anchor, CollectPass
from planner.tasks.flying import Connector, FlightLevels, Station, fly_whole
from planner.tasks.methods import GOALS
from planner.tasks.setting import Setting
from planner.transit import ssas_connector
from planner.transit.milp import connector as milp_connector
from planner.transit.refine import Risk, connect_by_cost
from planner.wishes import Objective

NO_HOLDS: Mapping[int, Path] = MappingProxyType({})

#: A line round zones, of which some can be kept out of altogether.
_Lines = Callable[[Anchor, Anchor, KeepOut, KeepOut, Stop], Path]


def _line(collect: CollectPass) -> Path:
    return Path((Segment("straight", collect.entry, collect.length_m),))


@dataclass(frozen=True, slots=True)
class Transits:
    """Connects poses in a setting by the methods asked for.

    Parameters
    ----------
    methods
        Of ``transit`` and ``smoothing``.
    """

    setting: Setting
    objective: Objective
    methods: dict[str, str]
    risk: Risk

    @classmethod
    def of(cls, setting: Setting, objective: Objective, methods: dict[str, str]) -> Transits:
        """Round what the setting's level meets."""
        risk = Risk.of(setting.airspace.threats, objective, setting.level.lowest.height_m)
        return cls(setting, objective, methods, risk)

    def through(
        self,
        passes: Sequence[CollectPass],
        progress: Progress,
        stop: Stop,
        holds: Mapping[int, Path] = NO_HOLDS,
    ) -> tuple[Composed, tuple[Leg, ...], tuple[str, ...]]:
        """The flight through all collects, its legs, and what is to be said of them.

        ``holds`` are circles before the settling run of some passes, by their numbers.
        """
        settle_m = self.setting.model.settle_m
        own_m, over_m = self.setting.altitudes_m, self.setting.over_ground_m
        following = self.setting.following
        stations = []
        for number, each in enumerate(passes):
            name, followed = each.regions[0], None
            if following is not None and name in over_m:
                followed = following.over_pass(_line(each), over_m[name] - SMOOTH_M)
            station = Station.of(each, settle_m, own_m.get(name), followed)
            stations.append(replace(station, hold=holds[number]) if number in holds else station)
        return self.by(stations, progress, stop)

    def by(
        self, stations: Sequence[Station], progress: Progress, stop: Stop
    ) -> tuple[Composed, tuple[Leg, ...], tuple[str, ...]]:
        """The flight by all stations, its legs, and what is to be said of them."""
        setting = self.setting
        levels = FlightLevels(setting.airspace, setting.level)
        weights = {"missile": self.objective.missile, "radar": self.objective.radar}
        unminded = [t.name for t in setting.airspace.threats if not t.hard and weights[t.model] <= 0.0]
        return fly_whole(
            stations,
            setting.ends,
            setting.model,
            levels,
            self._connectors(stop),
            self.risk.cost_m,
            unminded,
            progress,
            stop,
            setting.following,
        )

    def _connectors(self, stop: Stop) -> dict[str, Connector]:
        radius_m = self.setting.model.turn_radius_m

        def tangent(start: Anchor, goal: Anchor, zones: KeepOut) -> Path:
            return connect_by_cost(start, goal, zones, radius_m, self.risk, stop)

        name = self.methods["transit"]
        lines = self._milp if name in GOALS else self._ssas
        if name == "tangent":
            return {"tangent": tangent}

        @cache
        def named(start: Anchor, goal: Anchor, zones: KeepOut) -> Path:
            return self._worth_it(start, goal, zones, lines, tangent, stop)

        return {name: named, "tangent": tangent}

    def _worth_it(
        self, start: Anchor, goal: Anchor, zones: KeepOut, lines: _Lines, other: Connector, stop: Stop
    ) -> Path:
        """A method's line; none where it leads through threats and costs more than another."""
        threats, height_m = self.setting.airspace.threats, self.setting.level.lowest.height_m
        avoided = ssas_connector.avoidable(start, goal, threats, self.objective, height_m, zones)
        try:
            path = lines(start, goal, zones, avoided, stop)
        except InfeasibleError as error:
            raise InfeasibleError(
                error.constraint, error.feature, f"in no way ({error.message})", error.relaxation
            ) from error
        if not avoided.clear(path) and self.risk.cost_m(other(start, goal, zones)) < self.risk.cost_m(path):
            raise InfeasibleError("transit", "threats", "through threats only", "Use transit tangent.")
        return path

    def _ssas(self, start: Anchor, goal: Anchor, zones: KeepOut, avoided: KeepOut, stop: Stop) -> Path:
        path, _ = ssas_connector.connect(
            start,
            goal,
            threats=self.setting.airspace.threats,
            objective=self.objective,
            height_m=self.setting.level.lowest.height_m,
            keep_out=zones,
            radius_m=self.setting.model.turn_radius_m,
            smoothing=self._smoothing,
            stop=stop,
        )
        return path

    def _milp(self, start: Anchor, goal: Anchor, zones: KeepOut, avoided: KeepOut, stop: Stop) -> Path:
        """Round all that can be kept out of; where that is proven or found to be no way, round hard zones."""
        hard = zones.without([disc.name for disc in zones.discs if not disc.hard])
        try:
            return self._program(start, goal, avoided, stop)
        except InfeasibleError:
            if avoided == hard:
                raise
        return self._program(start, goal, hard, stop)

    def _program(self, start: Anchor, goal: Anchor, kept: KeepOut, stop: Stop) -> Path:
        path, _ = milp_connector.connect(
            start,
            goal,
            kept,
            self.setting.model.turn_radius_m,
            self.setting.model.airspeed_m_s,
            GOALS[self.methods["transit"]],
            directions=int(self.methods["directions"]),
            smoothing=self._smoothing,
            stop=stop,
        )
        return path

    @property
    def _smoothing(self) -> RoundingMethod:
        return cast(RoundingMethod, self.methods["smoothing"])
