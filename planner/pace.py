"""The speed of a flight on whose passes photos would come sooner than the camera takes them.

Whether a camera has time for its overlap is known when a scenario is read; how long its passes are is not.
Among buildings some have room for no longer ones. An aircraft flies all of its flight at one airspeed.
"""

from __future__ import annotations

from dataclasses import replace

from planner.errors import Finding
from planner.photos import too_soon
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.sensors.suite import camera_on
from planner.tasks.task import Answer

#: A flight is planned anew so often, each time slower.
ROUNDS = 4
#: Slower than the photos ask for by this part: what is slower also speeds up and brakes in less time.
SPARE = 0.95
#: Nothing is flown slower than this part of the speed asked for, or than so much over the wind.
LEAST_PART, OVER_WIND = 0.25, 1.05


def slower_for_photos(scenario: Scenario, answer: Answer) -> Scenario | None:
    """The scenario flown more slowly; None where its photos are in time, or its aircraft has one speed."""
    soon = too_soon(answer.setting.suite, answer.composed, answer.passes)
    aircraft = scenario.aircraft[0]
    if not soon or not (aircraft.hovers or aircraft.min_airspeed_m_s is not None):
        return None
    worst = min(soon, key=lambda each: each.between_s / each.least_s)
    speed_m_s = aircraft.airspeed_m_s * SPARE * worst.between_s / worst.least_s
    # Told to a hundredth.
    speed_m_s = round(speed_m_s, 2)
    if speed_m_s < max(aircraft.min_airspeed_m_s or 0.0, OVER_WIND * scenario.wind.speed_m_s):
        return None
    slower = replace(aircraft, airspeed_m_s=speed_m_s)
    sensors = tuple(
        camera_on(sensor, slower, scenario.level.amsl_m) if isinstance(sensor, CameraSensor) else sensor
        for sensor in scenario.sensors
    )
    name = answer.passes[worst.number].regions[0]
    told = Finding(
        f"vehicle {aircraft.name}",
        "speed-lowered",
        f"is flown at {speed_m_s:g} m/s: on a pass over {name} that has no room to be longer there would be "
        f"a photo every {worst.between_s:.2f} s, its camera takes one every {worst.least_s:g} s",
        "Fly higher, or lower the clearance, for it to fly faster.",
        "warning",
    )
    earlier = tuple(each for each in scenario.warnings if each.rule != told.rule)
    return replace(scenario, aircraft=(slower,), sensors=sensors, warnings=(*earlier, told))
