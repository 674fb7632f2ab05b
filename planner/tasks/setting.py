"""A scenario unpacked, once: what each stage is told of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from shapely import Point, union_all
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.envelope import SMOOTH_M, Envelope
from planner.coverage.visible import Seeing
from planner.profile.ends import climb_slope_rad, sink_slope_rad
from planner.profile.following import Following
from planner.route import Terminal
from planner.scenario import Scenario
from planner.sensors.suite import Suite
from planner.vehicle.model import FlightModel

#: Hills farther than this from all that is flown over lift no flight that follows the ground.
LEAST_ROUND_M, TURNS_ROUND = 300.0, 6.0


@dataclass(frozen=True, slots=True)
class Setting:
    """Where one aircraft flies, at which level, and with which sensors, in the wind there is.

    Parameters
    ----------
    ends
        Where it starts and where it ends.
    altitudes_m
        Of the passes over each region that has one of its own.
    over_ground_m
        Height over the ground of the passes over each region for which they follow it.
    following
        What the ground is followed by; None for a level flight.
    """

    airspace: Airspace
    level: Level
    model: FlightModel
    suite: Suite
    ends: tuple[Terminal, Terminal]
    altitudes_m: Mapping[str, float] = field(default_factory=dict)
    over_ground_m: Mapping[str, float] = field(default_factory=dict)
    following: Following | None = None

    @classmethod
    def of(cls, scenario: Scenario) -> Setting:
        """The setting of a scenario's first aircraft.

        Raises
        ------
        InfeasibleError
            ``"wind"``: it is not faster than the wind.
        """
        home_m = scenario.level.amsl_m - scenario.level.height_m
        model = FlightModel.of(scenario.aircraft[0], scenario.wind, home_m)
        suite = scenario.suite
        if scenario.wind.speed_m_s > 0.0:
            suite = suite.in_wind(model.drift, scenario.wind.toward_rad)
        altitudes_m = {r.name: r.altitude_m for r in scenario.regions if r.altitude_m is not None}
        ends = scenario.ends_of(scenario.aircraft[0])
        over_m = {r.name: r.over_ground_m for r in scenario.regions if r.over_ground_m is not None}
        following = None
        if scenario.terrain is not None and over_m:
            slope = math.tan(min(climb_slope_rad(model), sink_slope_rad(model)))
            if model.aircraft.hovers:
                # It flies the slower where it is steep.
                slope = math.tan(math.radians(model.max_climb_deg))
            kept_m = scenario.over_ground_m + SMOOTH_M
            ground = scenario.terrain.within(_flown_over(scenario, model))
            following = Following(Envelope.over(ground, kept_m, slope), slope)
        where = (scenario.airspace, scenario.level, model, suite, ends)
        return cls(*where, altitudes_m, over_m, following)


def _flown_over(scenario: Scenario, model: FlightModel) -> BaseGeometry:
    """Ground that a flight which follows it lies over, with room for turns and ways round."""
    places: list[BaseGeometry] = [region.area for region in scenario.regions]
    places += [Point(end.position) for end in scenario.ends_of(model.aircraft)]
    reach_m = max(LEAST_ROUND_M, TURNS_ROUND * model.turn_radius_m)
    hull: BaseGeometry = union_all(places).convex_hull.buffer(reach_m)
    return hull


def seeing(scenario: Scenario, setting: Setting) -> Seeing:
    """What is to be seen of a scenario's regions."""
    return Seeing(
        regions=scenario.regions,
        suite=setting.suite,
        airspace=setting.airspace,
        level=setting.level,
        model=setting.model,
        objective=scenario.objective,
        wide=scenario.method.coverage != "li2018",
        max_height_m=scenario.max_height_m,
    )
