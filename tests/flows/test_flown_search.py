"""Searches flown by the simulated aircraft, which knows the items alone: energy used and ground seen.

``pytest --log-cli-level=INFO`` shows the figures of each flight as a row of a Markdown table.
"""

from __future__ import annotations

import logging
import math
from itertools import pairwise
from typing import Any

import pytest

from planner.as_flown.track import TrackSample
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.tasks.flown import flown_coverage
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.energy import FlightState
from tests.flows.test_flown_ground import flown
from tests.planner.search.searches import RADAR, document, rectangle

log = logging.getLogger(__name__)

#: Of the plan's energy, and of the ground that it says is seen.
WITHIN = 0.03
WIND_M_S = 8.0
WING: dict[str, Any] = {
    "name": "uav", "model": "Skywalker X8", "autopilot": "ardupilot", "finish": "land",
    "charge_mah": 2200, "voltage_v": 14.8, "min_turn_radius_m": 90,
}  # fmt: skip


def used_wh(aircraft: Aircraft, track: list[TrackSample]) -> float:
    """Energy of a track: of each step by its climb and by the bank that it turns with."""
    assert aircraft.power is not None
    joules = 0.0
    airborne = [sample for sample in track if sample.height_m > 0.5]
    for here, there in pairwise(airborne):
        step_s = there.time_s - here.time_s
        climb_m_s = (there.height_m - here.height_m) / step_s
        load = 1.0 / math.cos(math.radians(here.roll_deg))
        joules += step_s * aircraft.power.power_w(FlightState(aircraft.airspeed_m_s, climb_m_s, load))
    return joules / 3600.0


@pytest.mark.parametrize("radius_m", [47.0, 90.0], ids=["tight", "wide"])
@pytest.mark.parametrize("from_deg", [None, 60.0], ids=["still air", "wind"])
def test_a_search_uses_and_sees_what_was_planned(from_deg: float | None, radius_m: float) -> None:
    """Within 3 % of the plan, in still air and in 8 m/s of wind, and home with the reserve."""
    wind: dict[str, Any] = {}
    if from_deg is not None:
        wind = {"wind": {"speed_m_s": WIND_M_S, "from_deg": from_deg}}
    wing = WING | {"min_turn_radius_m": radius_m}
    # Tight turns bring lanes one beside the other, and part turns round a centre between them.
    method = {} if radius_m == WING["min_turn_radius_m"] else {"method": {"search": "parallel"}}
    asked = document(vehicle=wing, sensor=RADAR, altitude_m=150, **wind, **method)
    asked["features"][0] = rectangle("area", -700.0, -700.0, 1900.0, 1600.0)
    asked["features"].append(rectangle("roi", 0.0, 0.0, 1200.0, 900.0, name="ground"))
    scenario = read_scenario(asked)
    plan = make_plan(scenario)
    assert plan.violations == ()
    track = flown(plan, "ardupilot", 0.0 if from_deg is None else WIND_M_S, from_deg or 0.0)
    used = used_wh(scenario.aircraft[0], track)
    seen = flown_coverage(scenario, plan, track)
    planned_wh, planned = plan.metrics.energy_wh, plan.metrics.coverage["ground"]
    log.info(
        "| %g m | %s | %.2f Wh | %.2f Wh | %+.1f %% | %.2f %% | %.2f %% |",
        radius_m, "none" if from_deg is None else f"{WIND_M_S:g} m/s", planned_wh, used,
        100.0 * (used / (planned_wh or math.inf) - 1.0), 100.0 * planned, 100.0 * seen.fraction["ground"],
    )  # fmt: skip
    assert used == pytest.approx(planned_wh, rel=WITHIN)
    assert seen.fraction["ground"] == pytest.approx(planned, rel=WITHIN)
    assert used < (scenario.aircraft[0].energy_wh or 0.0)
