"""The pre-flight check's answers, one question at a time."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from app.services.vehicles.preflight import Check, Observed, preflight, settle_m
from mavlink.encoding.encode import encode
from mavlink.encoding.payload import RelayPayload
from mavlink.rules.table import needs_of
from mavlink.state.telemetry import VehicleState
from planner.plan import Plan, Violation
from planner.vehicle.steadiness import steadiness_of
from tests.mavlink.plans import make_plan, square_fence

PLAN = make_plan(fence=square_fence(5000.0), finish="return", altitude_reference="home")
LON_DEG, LAT_DEG = PLAN.home
HEADING_DEG = PLAN.paths[0].take_off_heading_deg or 0.0
STATE = VehicleState(
    connected=True,
    autopilot="ardupilot",
    type="fixed_wing",
    mode="AUTO",
    lon_deg=LON_DEG,
    lat_deg=LAT_DEG,
    home_lon_deg=LON_DEG,
    home_lat_deg=LAT_DEG,
    home_altitude_amsl_m=40.0,
    heading_deg=HEADING_DEG,
    landed=True,
    battery_percent=100.0,
    gps_fix="3d",
    satellites=12,
)
SCENARIO: dict[str, Any] = {
    "vehicles": [{"name": PLAN.vehicles[0].name, "max_flight_time_s": 3 * PLAN.paths[0].duration_s}],
    "features": [],
}
VALUES = {"WP_RADIUS": 50.0, "NAVL1_PERIOD": 10.0, "RELAY1_FUNCTION": 1.0, "FENCE_ENABLE": 1.0}


def checks(
    plan: Plan = PLAN, scenario: dict[str, Any] | None = None, observed: Observed | None = None
) -> dict[str, Check]:
    """Answers by name, for a vehicle with which all is well but for what is given."""
    mission = encode(plan)
    needs = needs_of(plan, mission, RelayPayload(0))
    seen = observed or Observed(STATE, {"mission": (), "fence": ()}, VALUES)
    report = preflight("id", plan, SCENARIO if scenario is None else scenario, mission, needs, seen)
    assert report.ready == all(check.status != "failed" for check in report.checks)
    return {check.name: check for check in report.checks}


def of_state(**changes: Any) -> dict[str, Check]:
    """Answers for a vehicle in another state."""
    return checks(observed=Observed(replace(STATE, **changes), {"mission": (), "fence": ()}, VALUES))


def test_all_well_is_ready() -> None:
    """Every question is answered ok, or with a warning that names its reason."""
    found = checks()
    assert {check.status for name, check in found.items() if name != "dialect"} == {"ok"}
    assert found["dialect"].status != "failed"
    assert "turns" not in found
    assert {"plan", "vehicle", "mission", "fence", "parameters", "battery", "place", "gps"} <= set(found)


@pytest.mark.parametrize(
    ("changes", "name", "status", "words"),
    [
        ({"connected": False}, "vehicle", "failed", "not connected"),
        ({"autopilot": "px4"}, "vehicle", "failed", "px4"),
        ({"type": "multirotor"}, "vehicle", "failed", "multirotor"),
        ({"type": "other"}, "vehicle", "warning", "other"),
        ({"battery_percent": 30.0}, "battery", "failed", "30 %"),
        ({"battery_percent": 36.0}, "battery", "warning", "36 %"),
        ({"battery_percent": None}, "battery", "warning", "how full"),
        ({"lat_deg": LAT_DEG + 0.0006}, "place", "warning", "67 m from the plan's start"),
        ({"lat_deg": LAT_DEG + 0.0004}, "place", "ok", "44 m from the plan's start"),
        ({"lat_deg": LAT_DEG + 0.008}, "place", "warning", "from the plan's start"),
        ({"lat_deg": LAT_DEG + 0.01}, "place", "failed", "from the plan's start"),
        ({"lat_deg": None}, "place", "failed", "where it is"),
        ({"home_lat_deg": LAT_DEG + 0.1}, "place", "warning", "its home"),
        ({"gps_fix": "2d"}, "gps", "failed", "2d"),
        ({"gps_fix": None}, "gps", "warning", "fix"),
        ({"satellites": 4}, "gps", "warning", "4 satellites"),
        ({"home_altitude_amsl_m": None}, "altitude", "warning", "has not said"),
        ({"home_altitude_amsl_m": 1500.0}, "turns", "warning", "24 m wider"),
    ],
)
def test_the_vehicles_state(changes: dict[str, Any], name: str, status: str, words: str) -> None:
    """What the vehicle says of itself decides, in words that name the figure."""
    check = of_state(**changes)[name]
    assert check.status == status
    assert words in check.detail


@pytest.mark.parametrize(
    ("off_deg", "status"), [(0.0, "ok"), (19.0, "ok"), (-19.0, "ok"), (21.0, "warning"), (-180.0, "warning")]
)
def test_a_wing_on_the_ground_points_where_the_plan_takes_off(off_deg: float, status: str) -> None:
    """Within 20° across north as well; unknown is told, in the air and for what hovers nobody asks."""
    for planned_deg in (HEADING_DEG, 5.0, 355.0):
        path = replace(PLAN.paths[0], take_off_heading_deg=planned_deg)
        state = replace(STATE, heading_deg=(planned_deg + off_deg) % 360.0)
        seen = Observed(state, {"mission": (), "fence": ()}, VALUES)
        check = checks(replace(PLAN, paths=(path,)), observed=seen)["heading"]
        assert check.status == status
        assert f"takes off to {planned_deg:.0f}°" in check.detail
    assert of_state(heading_deg=None)["heading"].status == "warning"
    assert "heading" not in of_state(landed=False)
    copter = make_plan(fence=square_fence(5000.0), finish="return", vehicle_type="multirotor")
    assert "heading" not in checks(copter)


def test_a_home_at_another_height_than_the_scenario_says() -> None:
    """Its zones' heights over the sea were placed by the start's: told, whatever the plan counts from."""
    for height_m, status in ((45.0, "ok"), (80.0, "warning")):
        start = {
            "properties": {"role": "start"},
            "geometry": {"coordinates": [LON_DEG, LAT_DEG, height_m]},
        }
        found = checks(scenario={**SCENARIO, "features": [start]})
        assert found["altitude"].status == status
    assert "80 m" in found["altitude"].detail


def test_violations() -> None:
    """A hard violation fails, a soft one warns."""
    broken = Violation("turn-radius", "uav", "too tight", 1.0, "m")
    assert checks(replace(PLAN, violations=(broken,)))["plan"].status == "failed"
    soft = replace(broken, hard=False)
    assert checks(replace(PLAN, violations=(soft,)))["plan"].status == "warning"


def test_what_is_held() -> None:
    """Differences and failed read-backs fail, of mission and fence alike."""
    for held, name in [
        ({"mission": ["item 3: z"], "fence": ()}, "mission"),
        ({"mission": None, "fence": ()}, "mission"),
        ({"mission": (), "fence": ["fence: count"]}, "fence"),
        ({"mission": ()}, "fence"),
    ]:
        found = checks(observed=Observed(STATE, held, VALUES))  # type: ignore[arg-type]
        assert [check.name for check in found.values() if check.status == "failed"] == [name]


def test_a_plan_without_fence_asks_for_none() -> None:
    """Nothing meant, nothing missed."""
    plan = replace(PLAN, fence=square_fence(5000.0).__class__())
    assert checks(plan, observed=Observed(STATE, {"mission": ()}, VALUES))["fence"].status == "ok"


def test_parameters() -> None:
    """Errors fail, warnings warn, silence warns."""
    for values, unread, status, words in [
        (VALUES | {"RELAY1_FUNCTION": 0.0}, (), "failed", "RELAY1_FUNCTION"),
        (VALUES | {"NAVL1_PERIOD": 30.0}, (), "warning", "NAVL1_PERIOD"),
        (VALUES, ("FENCE_TYPE",), "warning", "FENCE_TYPE"),
        (None, (), "warning", "could not be read"),
    ]:
        found = checks(observed=Observed(STATE, {"mission": (), "fence": ()}, values, unread))
        assert found["parameters"].status == status
        assert words in found["parameters"].detail


def test_battery_without_a_capacity_says_so() -> None:
    """Where the scenario limits nothing, only a low charge warns."""
    full = checks(scenario={"features": []})["battery"]
    assert (full.status, "not known" in full.detail) == ("ok", True)


@pytest.mark.parametrize(
    ("reference", "scenario", "status"),
    [
        ("terrain", {}, "warning"),
        ("terrain", {"terrain": "an id"}, "ok"),
        ("amsl", {}, "warning"),
        ("amsl", {"start_m": 42.0}, "ok"),
        ("amsl", {"start_m": 90.0}, "failed"),
    ],
)
def test_altitude_datum(reference: Any, scenario: dict[str, Any], status: str) -> None:
    """What altitudes count from is known, or it is said that it is not."""
    place = [LON_DEG, LAT_DEG, *([scenario["start_m"]] if "start_m" in scenario else [])]
    start = {"properties": {"role": "start"}, "geometry": {"type": "Point", "coordinates": place}}
    plan = replace(PLAN, altitude_reference=reference)
    assert checks(plan, SCENARIO | scenario | {"features": [start]})["altitude"].status == status


@pytest.mark.parametrize(
    ("ground_m", "status"), [(45.0, "ok"), (60.0, "warning"), (20.0, "warning"), (497.0, "failed")]
)
def test_the_rasters_ground_at_the_start_is_held_against_home(ground_m: float, status: str) -> None:
    """On terrain the plan knows how high its start is, though no third coordinate says so."""
    plan = make_plan(fence=square_fence(5000.0), altitude_reference="amsl", ground_m=ground_m)
    point = {"type": "Point", "coordinates": [LON_DEG, LAT_DEG]}
    start = {"properties": {"role": "start"}, "geometry": point}
    found = checks(plan, SCENARIO | {"terrain": "an id", "features": [start]})["altitude"]
    assert (found.status, f"at {ground_m:.0f} m" in found.detail) == (status, True)


@pytest.mark.parametrize(
    ("base_m", "terrain", "status"),
    [(43.0, {}, "ok"), (120.0, {}, "failed"), (120.0, {"terrain": "an id"}, "ok")],
)
def test_home_is_held_against_the_vehicles_own_base(
    base_m: float, terrain: dict[str, Any], status: str
) -> None:
    """Not against a start that others fly from; on terrain the raster's ground counts, whatever is stated."""
    plan = make_plan(fence=square_fence(5000.0), altitude_reference="amsl", ground_m=45.0)
    (vehicle,) = SCENARIO["vehicles"]
    features = [
        {"id": name, "properties": {"role": role}, "geometry": {"type": "Point", "coordinates": place}}
        for name, role, place in (
            ("S", "start", [LON_DEG, LAT_DEG, 300.0]),
            ("one", "base", [LON_DEG, LAT_DEG, 300.0]),
            ("own", "base", [LON_DEG, LAT_DEG, base_m]),
        )
    ]
    asked = SCENARIO | terrain | {"features": features, "vehicles": [vehicle | {"base": "own"}]}
    assert checks(plan, asked)["altitude"].status == status


@pytest.mark.parametrize(("speed_m_s", "status"), [(5.0, "ok"), (15.0, "warning")])
def test_wind(speed_m_s: float, status: str) -> None:
    """Wind is spoken of when it is given, and warned of when it is strong."""
    assert "wind" not in checks()
    wind = {"wind": {"speed_m_s": speed_m_s, "from_deg": 270.0}}
    assert checks(scenario=SCENARIO | wind)["wind"].status == status


def test_settling_distance_is_the_scenarios() -> None:
    """The vehicle's own, its autopilot's at its airspeed, None where nothing is said."""
    named = {"name": "b", "autopilot": "ardupilot", "airspeed_m_s": 20}
    assert settle_m({"vehicles": [named]}, "b") == 20.0 * steadiness_of("ardupilot", "fixed_wing").settle_s
    assert settle_m({"vehicles": [named | {"settle_m": 0}]}, "b") == 0.0
    assert settle_m({"vehicles": [{"name": "a"}, {"name": "b", "settle_m": 150}]}, "b") == 150.0
    assert settle_m({}, "b") is None


def test_what_flies_already_need_not_be_near_the_start() -> None:
    """A mission sent in flight begins where the aircraft is; on the ground, or from home, it is far away."""
    (vehicle,) = PLAN.vehicles
    aloft = replace(PLAN, vehicles=(replace(vehicle, home_altitude_m=0.0),))
    far = {"lat_deg": LAT_DEG + 0.1, "armed": True}
    for plan, landed, status in ((aloft, False, "ok"), (aloft, True, "failed"), (PLAN, False, "failed")):
        seen = Observed(replace(STATE, **far, landed=landed), {"mission": (), "fence": ()}, VALUES)
        assert checks(plan, observed=seen)["place"].status == status
    strange = replace(STATE, **far, landed=False, home_lat_deg=LAT_DEG + 0.01)
    found = checks(aloft, observed=Observed(strange, {"mission": (), "fence": ()}, VALUES))["place"]
    assert found.status == "warning"
    assert "its home, where returns go to" in found.detail
