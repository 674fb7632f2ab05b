"""A pass is flown again whole from the item that is advised, though the aircraft comes from anywhere."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from app.routers.bodies import EXAMPLE
from mavlink.dialects import Autopilot
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.options import DEFAULT_PAYLOAD
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.state.passes import lead_in, passes_of
from planner.as_flown.track import TrackSample
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.tasks.flown import flown_coverage
from tests.mavlink.sim.helpers import Station

GROUND_M = 40.0


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_a_wing_sees_a_pass_whole_from_the_item_advised(autopilot: Autopilot) -> None:
    """Sent there when the pass is behind it; from the place right before the pass it misses the beginning."""
    document: dict[str, Any] = json.loads(json.dumps(EXAMPLE))
    document["features"] = [each for each in document["features"] if each["id"] != "harbour"]
    document["vehicles"][0]["autopilot"] = autopilot
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    items = encode(plan, options=EncodeOptions(off_delay_m=0.0)).mission
    (run,) = passes = passes_of(items, DEFAULT_PAYLOAD, autopilot)
    begin, before = lead_in(items, run, passes, hovers=False), run[0] - 1
    assert begin.whole
    settings = SimSettings(
        home=Place(plan.home[1], plan.home[0], GROUND_M),
        heading_deg=plan.paths[0].take_off_heading_deg,
        autopilot=Flavour(autopilot),
    )
    station = Station(SimulatedAircraft(settings))
    assert station.upload(items) == 0
    station.start()
    aircraft = station.aircraft
    seen = []
    for seq in (before, begin.seq):
        while aircraft.pilot.current < run.stop:
            station.wait(0.5)
        aircraft.pilot.select(seq, aircraft.state)
        track: list[TrackSample] = []
        while aircraft.pilot.current < run.stop:
            station.wait(0.2)
            state = aircraft.state
            place = (state.lon_deg, state.lat_deg, state.altitude_m - GROUND_M)
            angles_deg = math.degrees(state.bank_rad), math.degrees(state.heading_rad)
            on = aircraft.payload.sensor_on
            track.append(TrackSample(station.now_s, *place, angles_deg[0], on, angles_deg[1]))
        seen.append(min(flown_coverage(scenario, plan, track).fraction.values()))
    assert seen[0] < 0.9
    assert seen[1] > 0.99
