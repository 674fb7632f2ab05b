"""A scenario unpacked, once: what each stage is told of it."""

from __future__ import annotations

from dataclasses import dataclass

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
    """

    airspace: Airspace
    level: Level
    model: FlightModel
    suite: Suite
    ends: tuple[Terminal, Terminal]

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
        return cls(scenario.airspace, scenario.level, model, suite, (scenario.start, scenario.end))


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
