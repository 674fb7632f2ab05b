"""What no flights of a search find more than."""

from __future__ import annotations

import math

import shapely

from planner.errors import InfeasibleError
from planner.scenario import Scenario
from planner.search.most import Sweeping, most_found
from planner.tasks.budget import limits_of, per_m_of
from planner.tasks.setting import Setting
from planner.tasks.sought import asked_of
from planner.tasks.worth import ground_of
from planner.vehicle.limits import Use


def most(scenario: Scenario) -> tuple[float, float] | None:
    """Ground that no flights of a scenario see more of, m², and worth that none find more of.

    None where what is looked for drifts: nothing but all of it is proven of that.
    """
    if scenario.importance.drift is not None:
        return None
    flights: list[Sweeping] = []
    ground = ground_of(shapely.union_all([region.area for region in scenario.regions]))
    for aircraft in scenario.aircraft:
        alone = scenario.of_one(aircraft) if scenario.is_fleet else scenario
        if not alone.regions:
            continue
        try:
            setting = Setting.of(alone)
        except InfeasibleError as error:
            if error.constraint != "wind":
                raise
            # It stays on the ground, and finds nothing.
            continue
        asked = asked_of(alone, setting)
        own, wind_m_s = setting.model.aircraft, setting.model.wind.speed_m_s
        per_m = per_m_of(own, setting.level.amsl_m)
        lengths_m = [
            limit / per_m[name]
            for name, (_, limit, _) in limits_of(own, Use(0.0, 0.0, 0.0)).items()
            if per_m[name] > 0.0
        ]
        # Downwind all the way, at most; what hovers flies no faster for it.
        faster = 1.0 if own.hovers else 1.0 + wind_m_s / own.airspeed_m_s
        start, end = (terminal.position for terminal in setting.ends)
        swaths = tuple(
            swath.nominal or swath
            for course in range(0, 360, 15)
            for look in asked.looking.looks
            for swath in (asked.looking.swath(math.radians(course), look),)
        )
        flights += own.batteries * [Sweeping(start, end, faster * min(lengths_m, default=math.inf), swaths)]
    return most_found(ground, scenario.importance, flights)
