"""A scenario as it is flown in its wind."""

from __future__ import annotations

from dataclasses import replace

from planner.scenario import Scenario
from planner.vehicle.model import FlightModel


def in_wind(scenario: Scenario) -> Scenario:
    """The scenario with aircraft that plan their turns for its wind, and sensors that look where they crab.

    Raises
    ------
    InfeasibleError
        ``"wind"``: an aircraft is not faster than the wind, so some courses cannot be flown.
    """
    if scenario.wind.speed_m_s == 0.0:
        return scenario
    models = [FlightModel.of(aircraft, scenario.wind) for aircraft in scenario.aircraft]
    # One aircraft flies all passes.
    drift = models[0].drift
    return replace(
        scenario,
        aircraft=tuple(model.aircraft for model in models),
        sensors=tuple(sensor.in_wind(drift, scenario.wind.toward_rad) for sensor in scenario.sensors),
    )
