"""From passes in order to a flyable line: a leg to each, and to the end."""

from __future__ import annotations

import math
from dataclasses import dataclass

from planner.airspace.zones import TRANSIT_MARGIN_M, KeepOut, keep_out
from planner.dubins.path import Path, Segment, join
from planner.errors import InfeasibleError
from planner.progress import Progress, Stop, raise_if
from planner.publish import Leg
from planner.route import Anchor, CollectPass
from planner.routing.legs import anchor, leaves
from planner.tasks.setting import Setting
from planner.transit import ssas_connector
from planner.transit.refine import Risk, connect_by_cost
from planner.wishes import Objective


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
    zones: KeepOut
    risk: Risk

    @classmethod
    def of(cls, setting: Setting, objective: Objective, methods: dict[str, str]) -> Transits:
        """Round what the setting's level meets, with the margin of transits."""
        zones = keep_out(setting.airspace, setting.level, TRANSIT_MARGIN_M)
        risk = Risk.of(setting.airspace.threats, objective, setting.level.height_m)
        return cls(setting, objective, methods, zones, risk)

    def through(
        self, passes: tuple[CollectPass, ...], progress: Progress, stop: Stop
    ) -> tuple[tuple[Leg, ...], tuple[str, ...]]:
        """Legs from the start through all collects to the end, and what is to be said of them."""
        start, end = self.setting.ends
        settle_m = self.setting.model.settle_m
        starts = [anchor(start), *(leaves(one) for one in passes)]
        settling = [one.settling(settle_m) for one in passes]
        goals = [*(Anchor(*pose.position, pose.angle_rad) for pose in settling), anchor(end)]
        names = [start.name, *("+".join(one.regions) for one in passes), end.name]
        legs: list[Leg] = []
        notes: list[str] = []
        for k, (begin, goal) in enumerate(zip(starts, goals, strict=True)):
            raise_if(stop)
            progress("transit", k / len(starts))
            path, method = self.leg(begin, goal, stop, notes, names[k : k + 2])
            if k < len(passes) and settle_m > 0.0:
                path = _extended(path, passes[k])
            legs.append(Leg(names[k], names[k + 1], path, method))
        return tuple(legs), tuple(notes)

    def leg(
        self, start: Anchor, goal: Anchor, stop: Stop, notes: list[str], names: list[str]
    ) -> tuple[Path, str]:
        """One connection; where SSAS finds none, or one through threats that cost more than the tangent
        connector's line, that is taken, and ``notes`` say so.
        """
        radius_m = self.setting.model.turn_radius_m
        if self.methods["transit"] != "ssas":
            return connect_by_cost(start, goal, self.zones, radius_m, self.risk, stop), "tangent"
        threats, height_m = self.setting.airspace.threats, self.setting.level.height_m
        try:
            path, _ = ssas_connector.connect(
                start,
                goal,
                threats=threats,
                objective=self.objective,
                height_m=height_m,
                keep_out=self.zones,
                radius_m=radius_m,
                smoothing="shortcut" if self.methods["smoothing"] == "shortcut" else "fillet",
                stop=stop,
            )
        except InfeasibleError as error:
            notes.append(f"SSAS connects {names[0]} and {names[1]} in no way ({error.message}): tangent used")
            return connect_by_cost(start, goal, self.zones, radius_m, self.risk, stop), "tangent"
        avoided = ssas_connector.avoidable(start, goal, threats, self.objective, height_m, self.zones)
        if not avoided.clear(path):
            other = connect_by_cost(start, goal, self.zones, radius_m, self.risk, stop)
            if self.risk.cost_m(other) < self.risk.cost_m(path):
                notes.append(f"SSAS connects {names[0]} and {names[1]} through threats only: tangent used")
                return other, "tangent"
        return path, "ssas"


def _extended(path: Path, collect: CollectPass) -> Path:
    """A leg with its settling run: straight on to where the collect begins."""
    gap_m = math.dist(path.end.position, collect.start)
    return join(path, Path((Segment("straight", path.end, gap_m),)))
