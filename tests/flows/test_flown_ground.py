"""What the simulated aircraft sees, in wind from any direction, of a plan with its autopilot's own margins.

``pytest --log-cli-level=INFO`` shows the figures of each flight as a row of a Markdown table.
"""

from __future__ import annotations

import json
import logging
import math
from typing import Any

import pytest

from mavlink.dialects import Autopilot
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from planner.as_flown.track import TrackSample
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.tasks.flown import flown_coverage
from tests.mavlink.sim.helpers import Station
from tests.planner.scenarios import EXAMPLES

log = logging.getLogger(__name__)

GROUND_M = 40.0
STEP_S = 0.2
WIND_M_S = 8.0
LEAST_SEEN = 0.999
#: Of the shared case half is flown: three regions among six threats.
LEFT_OUT = ("R3", "R4", "R5", "M2", "M3", "M4")


def flown(plan: Plan, autopilot: Autopilot, wind_m_s: float, from_deg: float) -> list[TrackSample]:
    """The track of a plan's mission, flown from arming to disarmed."""
    vehicle = plan.vehicles[0]
    # The simulated wing flies up to its waypoints, so the sensor needs no delay.
    options = EncodeOptions(off_delay_m=0.0)
    settings = SimSettings(
        home=Place(plan.home[1], plan.home[0], GROUND_M),
        heading_deg=plan.paths[0].take_off_heading_deg,
        autopilot=Flavour(autopilot),
        vehicle_type=vehicle.type,
        airspeed_m_s=vehicle.airspeed_m_s,
        wind_m_s=wind_m_s,
        wind_from_deg=from_deg,
    )
    station = Station(SimulatedAircraft(settings))
    assert station.upload(encode(plan, options=options).mission) == 0
    station.start()
    track = []
    while station.aircraft.armed:
        assert station.now_s < 2.0 * plan.paths[0].duration_s, "still flying"
        station.wait(STEP_S)
        state = station.aircraft.state
        track.append(
            TrackSample(
                station.now_s,
                state.lon_deg,
                state.lat_deg,
                state.altitude_m - GROUND_M,
                math.degrees(state.bank_rad),
                station.aircraft.payload.sensor_on,
                math.degrees(state.heading_rad),
            )
        )
    return track


def least_seen(autopilot: Autopilot, from_deg: float | None, **stated: float) -> float:
    """The least of any region that a fixed wing sees, with settling and margins stated or its autopilot's."""
    document: dict[str, Any] = json.loads((EXAMPLES / "sar-case-1.geojson").read_text())
    document["vehicles"][0] |= {"autopilot": autopilot, "finish": "land"}
    document["features"] = [each for each in document["features"] if each["id"] not in LEFT_OUT]
    for holder, name in (
        (document["vehicles"][0], "settle_m"),
        (document["sensors"][0], "pointing_margin_deg"),
        (document["sensors"][0], "position_margin_m"),
    ):
        del holder[name]
        holder |= {name: stated[name]} if name in stated else {}
    if from_deg is not None:
        document["wind"] = {"speed_m_s": WIND_M_S, "from_deg": from_deg}
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    wind = (0.0, 0.0) if from_deg is None else (WIND_M_S, from_deg)
    seen = flown_coverage(scenario, plan, flown(plan, autopilot, *wind))
    worst_m = max(each.cross_track_max_m for each in seen.passes)
    told = "none" if from_deg is None else f"{WIND_M_S:g} m/s from {from_deg:g}°"
    log.info("| %s | %s | %.1f m | %.4f |", autopilot, told, worst_m, min(seen.fraction.values()))
    return min(seen.fraction.values())


@pytest.mark.parametrize("from_deg", [None, 0.0, 140.0, 210.0, 280.0])
@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_every_region_is_seen_whatever_the_wind(autopilot: Autopilot, from_deg: float | None) -> None:
    """By a fixed wing whose autopilot is named and whose scenario says nothing of settling or margins."""
    assert least_seen(autopilot, from_deg) >= LEAST_SEEN


def test_without_them_less_is_seen() -> None:
    """With none of either, stated, a flight in wind leaves ground out: it is they that see it."""
    bare = {"settle_m": 0.0, "pointing_margin_deg": 0.0, "position_margin_m": 0.0}
    assert least_seen("ardupilot", 210.0, **bare) < LEAST_SEEN
