"""A scenario unpacked, once: what each stage is told of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from planner.airspace.airspace import Airspace, Level
from planner.coverage.visible import Seeing
from planner.route import Terminal
from planner.scenario import Scenario
from planner.sensors.suite import Suite
from planner.vehicle.model import FlightModel


@dataclass(frozen=True, slots=True)
class Setting:
    """Where one aircraft flies, at which level, and with which sensors, in the wind there is.

    Parameters
    ----------
    ends
        Where it starts and where it ends.
    altitudes_m
        Of the passes over each region that has one of its own.
    """

    airspace: Airspace
    level: Level
    model: FlightModel
    suite: Suite
    ends: tuple[Terminal, Terminal]
    altitudes_m: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, scenario: Scenario) -> Setting:
        """The setting of a scenario's first aircraft.

        Raises
        ------
        InfeasibleError
            ``"wind"``: it is not faster than the wind.
        """
        model = FlightModel.of(scenario.aircraft[0], scenario.wind)
        suite = scenario.suite
        if scenario.wind.speed_m_s > 0.0:
            suite = suite.in_wind(model.drift, scenario.wind.toward_rad)
        altitudes_m = {r.name: r.altitude_m for r in scenario.regions if r.altitude_m is not None}
        ends = (scenario.start, scenario.end)
        return cls(scenario.airspace, scenario.level, model, suite, ends, altitudes_m)


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
    )
