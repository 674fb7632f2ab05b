"""From stations in order to the whole flight, by the methods asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
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
from planner.tasks.setting import Setting
from planner.transit import ssas_connector
from planner.transit.refine import Risk, connect_by_cost
from planner.wishes import Objective

NO_HOLDS: Mapping[int, Path] = MappingProxyType({})


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

        if self.methods["transit"] != "ssas":
            return {"tangent": tangent}

        def ssas(start: Anchor, goal: Anchor, zones: KeepOut) -> Path:
            return self._ssas(start, goal, zones, tangent, stop)

        return {"ssas": ssas, "tangent": tangent}

    def _ssas(self, start: Anchor, goal: Anchor, zones: KeepOut, other: Connector, stop: Stop) -> Path:
        """SSAS's line; none where it leads through threats and costs more than another."""
        threats, height_m = self.setting.airspace.threats, self.setting.level.lowest.height_m
        try:
            path, _ = ssas_connector.connect(
                start,
                goal,
                threats=threats,
                objective=self.objective,
                height_m=height_m,
                keep_out=zones,
                radius_m=self.setting.model.turn_radius_m,
                smoothing=cast(RoundingMethod, self.methods["smoothing"]),
                stop=stop,
            )
        except InfeasibleError as error:
            raise InfeasibleError(
                error.constraint, error.feature, f"in no way ({error.message})", error.relaxation
            ) from error
        avoided = ssas_connector.avoidable(start, goal, threats, self.objective, height_m, zones)
        if not avoided.clear(path) and self.risk.cost_m(other(start, goal, zones)) < self.risk.cost_m(path):
            raise InfeasibleError("transit", "threats", "through threats only", "Use transit tangent.")
        return path
