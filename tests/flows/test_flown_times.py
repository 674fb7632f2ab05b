"""Whole flights planned, encoded and flown by the simulated aircraft, which knows the items alone: how long.

``pytest --log-cli-level=INFO`` shows the figures of each flight as a row of a Markdown table.
"""

from __future__ import annotations

import json
import logging
import math
from typing import Any

import pytest

from app.routers.bodies import EXAMPLE
from mavlink.dialects import Autopilot
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import FlownPath, PlanVehicle
from tests.mavlink.sim.helpers import GEOD, Station

log = logging.getLogger(__name__)

GROUND_M = 40.0
STEP_S = 0.2
#: Of the whole duration.
WITHIN = 0.03
#: Of the time at which the mission phase ends: the simulated ArduCopter turns on the spot quicker.
MISSION_WITHIN = 0.045
WIND_FROM_DEG = 270.0


def rates(vehicle: PlanVehicle, wind_m_s: float) -> dict[str, float]:
    """Those of wings as the pre-flight check wants them: no faster in circles than the plan's slope."""
    if vehicle.type == "multirotor":
        return {}
    slope = math.tan(math.radians(vehicle.max_climb_deg))
    sink_m_s = vehicle.airspeed_m_s * slope
    return {
        "climb_m_s": (vehicle.airspeed_m_s + wind_m_s) * slope,
        "sink_m_s": min(sink_m_s, 2.0) if vehicle.autopilot == "px4" else sink_m_s,
    }


def mission_end_s(path: FlownPath, track: list[tuple[float, AircraftState]]) -> float:
    """When the track came nearest to where the mission phase ends, near the time planned for it."""
    phase = path.phase("mission")
    assert phase is not None
    last = next(s for s in path.segments if s.start_m + s.length_m >= phase.end_m - 0.01)
    height_m = last.end_altitude_m - path.line[0][2]

    def away_m(state: AircraftState) -> float:
        over_m = GEOD.inv(state.place.lon_deg, state.place.lat_deg, *last.end)[2]
        return math.hypot(over_m, state.altitude_m - GROUND_M - height_m)

    near = [(away_m(state), at_s) for at_s, state in track if abs(at_s / phase.end_s - 1.0) < 0.2]
    distance_m, at_s = min(near)
    assert distance_m < 60.0
    return at_s


@pytest.mark.parametrize("wind_m_s", [0.0, 8.0])
@pytest.mark.parametrize(
    ("autopilot", "changes"),
    [
        ("ardupilot", {}),
        ("px4", {}),
        ("ardupilot", {"type": "multirotor", "min_turn_radius_m": 60}),
        ("ardupilot", {"type": "multirotor", "min_turn_radius_m": None}),
        ("px4", {"type": "multirotor", "min_turn_radius_m": 60}),
        ("px4", {"type": "multirotor", "min_turn_radius_m": None}),
    ],
)
def test_a_whole_flight_takes_as_long_as_planned(
    autopilot: Autopilot, changes: dict[str, Any], wind_m_s: float
) -> None:
    """From lift-off to disarmed, and up to the end of the mission phase, in still air and in wind."""
    document = json.loads(json.dumps(EXAMPLE))
    document["wind"] = {"speed_m_s": wind_m_s, "from_deg": WIND_FROM_DEG}
    vehicle_document = document["vehicles"][0] | {"autopilot": autopilot, "finish": "land"} | changes
    document["vehicles"][0] = {name: value for name, value in vehicle_document.items() if value is not None}
    plan = make_plan(read_scenario(document))
    (path,) = plan.paths
    vehicle = plan.vehicles[0]
    # The simulated wing flies up to its waypoints, so the sensor needs no delay.
    options = EncodeOptions(off_delay_m=None if vehicle.type == "multirotor" else 0.0)
    mission = encode(plan, options=options)
    settings = SimSettings(
        home=Place(plan.home[1], plan.home[0], GROUND_M),
        heading_deg=path.take_off_heading_deg,
        autopilot=Flavour(autopilot),
        vehicle_type=vehicle.type,
        airspeed_m_s=vehicle.airspeed_m_s,
        wind_m_s=wind_m_s,
        wind_from_deg=WIND_FROM_DEG,
        **rates(vehicle, wind_m_s),
    )
    station = Station(SimulatedAircraft(settings))
    assert station.upload(mission.mission) == 0
    station.start()
    track: list[tuple[float, AircraftState]] = []
    lifted_s: float | None = None
    while station.aircraft.armed:
        assert station.now_s < 2.0 * path.duration_s, "still flying"
        station.wait(STEP_S)
        state = station.aircraft.state
        if lifted_s is None and not state.on_ground:
            lifted_s = station.now_s
        if lifted_s is not None:
            track.append((station.now_s - lifted_s, state))
    flown_s = track[-1][0]
    phase = path.phase("mission")
    assert phase is not None
    reached_s = mission_end_s(path, track)
    log.info(
        "| %s, %s | %.0f m/s | %.0f s | %.0f s | %+.1f %% | %.0f s | %.0f s |",
        autopilot, vehicle.type, wind_m_s, path.duration_s, flown_s,
        100.0 * (flown_s / path.duration_s - 1.0), phase.end_s, reached_s,
    )  # fmt: skip
    assert flown_s == pytest.approx(path.duration_s, rel=WITHIN)
    assert reached_s == pytest.approx(phase.end_s, rel=MISSION_WITHIN)
