"""The speed of passes, or of a whole flight, on which photos would come sooner than the camera takes them.

Whether a camera has time for its overlap is known when a scenario is read; how long its passes are is not.
Among buildings some have room for no longer ones. What hovers sees the same at any speed, and flies these
passes alone more slowly; wings crab the more the slower they are, and fly all of a flight at one airspeed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from planner.errors import Finding
from planner.metrics import used
from planner.photos import TooSoon, intervals, too_soon
from planner.profile.compose import times_of
from planner.profile.slowed import slowed
from planner.route import CollectPass, Slow
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.sensors.suite import camera_on
from planner.tasks.task import Answer
from planner.vehicle.jerks import change_m
from planner.vehicle.limits import exceeded
from planner.vehicle.manners import manners_of
from planner.vehicle.model import FlightModel

#: A flight is planned anew so often, each time slower.
ROUNDS = 4
#: Slower than the photos ask for by this part: what is slower also speeds up and brakes in less time.
SPARE = 0.95
#: Nothing is flown slower than this part of the speed asked for, or than so much over the wind.
LEAST_PART, OVER_WIND = 0.25, 1.05
#: No pass of what hovers is slower than this.
SLOWEST_M_S = 0.5


def slower_passes(answer: Answer) -> Answer | None:
    """What is flown, with the passes slowed on which photos would come too soon.

    None where none would, where that is no aircraft that hovers, or where its flight would be longer than its
    limits allow.
    """
    setting, composed = answer.setting, answer.composed
    model = setting.model
    soon = {each.number: each for each in too_soon(setting.suite, composed, answer.passes)}
    if not soon or not model.aircraft.hovers:
        return None
    passes = tuple(
        replace(each, slow=_slow(each, soon[number], model)) if number in soon else each
        for number, each in enumerate(answer.passes)
    )
    if any(each.slow is not None and each.slow.speed_m_s < SLOWEST_M_S for each in passes):
        return None
    times = times_of(model, setting.level.amsl_m - setting.level.altitude_m)
    flight = slowed(composed.flight, passes, composed.passes_m, times)
    composed = replace(composed, flight=flight)
    if too_soon(setting.suite, composed, passes):
        return None
    if exceeded(model.aircraft, used(flight, model, setting.level)):
        return None
    told = _told(passes, tuple(soon.values()), model)
    return replace(answer, composed=composed, passes=passes, dropped=(*answer.dropped, told))


def _slow(collect: CollectPass, soon: TooSoon, model: FlightModel) -> Slow:
    # Told to a hundredth.
    speed_m_s = math.floor(100.0 * collect.length_m / intervals(collect) / soon.least_s) / 100.0
    manners = manners_of(model.aircraft)
    braking_m = change_m(model.airspeed_m_s, speed_m_s, manners.accel_m_s2, manners.jerk_m_s3)
    return Slow(speed_m_s, braking_m)


def _told(passes: Sequence[CollectPass], soon: Sequence[TooSoon], model: FlightModel) -> Finding:
    slowest = min(soon, key=lambda each: _speed_m_s(passes[each.number]))
    speed_m_s = _speed_m_s(passes[slowest.number])
    names = sorted({name for each in soon for name in passes[each.number].regions})
    return Finding(
        f"vehicle {model.name}",
        "speed-lowered",
        f"flies {len(soon)} of {len(passes)} passes, over {', '.join(names)}, at {speed_m_s:g} m/s at the "
        f"slowest, not {model.airspeed_m_s:g}: with no room to be longer there would be a photo every "
        f"{slowest.between_s:.2f} s, the camera takes one every {slowest.least_s:g} s",
        "Fly higher, or lower the clearance, for it to fly them faster.",
        "warning",
    )


def _speed_m_s(collect: CollectPass) -> float:
    return math.inf if collect.slow is None else collect.slow.speed_m_s


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
