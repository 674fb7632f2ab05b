"""Parameters that the ends of a flight and its heights depend on, judged by the plan."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import encode
from mavlink.encoding.payload import RelayPayload
from mavlink.rules.base import Needs, ParameterFinding, needs_of
from mavlink.rules.firmware import still_to_ask
from mavlink.rules.heights import HeightNeeds
from mavlink.rules.table import judge_parameters, names_to_read
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from planner.plan import Fence, Plan, ZoneCircle
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.manners import manners_of
from tests.mavlink.plans import CIRCLE_M, SPEED_M_S, make_plan
from tests.mavlink.sim.helpers import Station, from_ground

HEIGHTS = HeightNeeds(2.8, 1.9, lowest_m=300.0)
NEEDS = Needs(
    20.0, 100.0, None, RelayPayload(0), frozenset({22, 16, 21}), False, 320.0, 4000.0, None, HEIGHTS
)
RETURNS = replace(NEEDS, heights=replace(HEIGHTS, return_m=100.0, circle_m=105.0))
KIND: dict[Autopilot, tuple[VehicleType, VehicleType]] = {
    "ardupilot": ("fixed_wing", "vtol"),
    "px4": ("fixed_wing", "vtol"),
}


def found(
    autopilot: Autopilot, kind: VehicleType, needs: Needs, values: dict[str, float]
) -> dict[str, ParameterFinding]:
    """Findings by name; what each advises draws none."""
    assert set(values) <= {*names_to_read(autopilot, kind, needs), "ALT_HOLD_RTL"}
    findings = {finding.name: finding for finding in judge_parameters(autopilot, kind, needs, values)}
    better = values | {name: f.advised for name, f in findings.items() if f.advised is not None}
    assert judge_parameters(autopilot, kind, needs, better) == ()
    return findings


@pytest.mark.parametrize(
    ("autopilot", "up", "down"),
    [
        ("ardupilot", ("TECS_CLMB_MAX",), ("TECS_SINK_MAX",)),
        ("px4", ("FW_T_CLMB_R_SP", "FW_T_CLMB_MAX"), ("FW_T_SINK_R_SP", "FW_T_SINK_MAX")),
    ],
)
def test_wings_that_climb_or_sink_slower_than_planned(
    autopilot: Autopilot, up: tuple[str, ...], down: tuple[str, ...]
) -> None:
    """Below the planned line is an error, above it a warning; the defaults are faster and draw nothing."""
    for kind in KIND[autopilot]:
        assert not found(autopilot, kind, NEEDS, dict.fromkeys((*up, *down), 5.0))
        for names, least, severity in ((up, 2.8, "error"), (down, 1.9, "warning")):
            for name in names:
                assert not found(autopilot, kind, NEEDS, {name: least})
                finding = found(autopilot, kind, NEEDS, {name: 0.8 * least})[name]
                assert finding.severity == severity
                assert f"{least:.1f} m/s" in finding.reason


@pytest.mark.parametrize(
    ("autopilot", "up", "down"),
    [("ardupilot", "TECS_CLMB_MAX", "TECS_SINK_MAX"), ("px4", "FW_T_CLMB_R_SP", "FW_T_SINK_R_SP")],
)
def test_circles_that_are_climbed_in_steeper_than_planned(autopilot: Autopilot, up: str, down: str) -> None:
    """The vehicle's rate alone decides there: a warning, at more than a quarter over the plan's."""
    turning = replace(NEEDS, heights=replace(HEIGHTS, turning_up_m_s=2.8, turning_down_m_s=1.9))
    assert not found(autopilot, "fixed_wing", turning, {up: 3.4, down: 2.3})
    findings = found(autopilot, "fixed_wing", turning, {up: 5.0, down: 5.0})
    assert {(f.name, f.severity) for f in findings.values()} == {(up, "warning"), (down, "warning")}
    assert all("max_climb_deg" in finding.reason for finding in findings.values())


@pytest.mark.parametrize(
    ("needs", "height_m", "severity", "words"),
    [
        (NEEDS, 100.0, None, ""),
        (NEEDS, -1.0, None, ""),
        (RETURNS, 100.0, None, ""),
        (RETURNS, 60.0, "warning", "at 60 m over home, the plan's comes down to 100 m"),
        (RETURNS, 300.0, "warning", "at 300 m over home"),
        (RETURNS, -1.0, "warning", "where it is"),
        (
            replace(NEEDS, heights=replace(HEIGHTS, flown_over=(120.0, "mast"))),
            100.0,
            "error",
            "mast reaches",
        ),
        (replace(NEEDS, heights=replace(HEIGHTS, flown_over=(120.0, "mast"))), 140.0, None, ""),
        (
            replace(RETURNS, heights=replace(RETURNS.heights, flown_over=(120.0, "mast"))),
            100.0,
            "error",
            "mast",
        ),
        (replace(RETURNS, heights=replace(RETURNS.heights, flown_over=(120.0, "mast"))), 130.0, None, ""),
        (replace(NEEDS, heights=replace(HEIGHTS, ground_rises=True)), 100.0, "warning", "300 m and more"),
        (replace(NEEDS, heights=replace(HEIGHTS, ground_rises=True)), 310.0, None, ""),
    ],
)
def test_arduplanes_return_height(needs: Needs, height_m: float, severity: str | None, words: str) -> None:
    """Into what the plan flies over, under the passes over known ground, or other than the plan's circle.

    ALT_HOLD_RTL is the same in centimetres, as older firmware has it.
    """
    for name, unit in (("RTL_ALTITUDE", 1.0), ("ALT_HOLD_RTL", 100.0)):
        findings = found("ardupilot", "fixed_wing", needs, {name: height_m * unit})
        assert [(f.name, f.severity) for f in findings.values()] == (
            [] if severity is None else [(name, severity)]
        )
        assert all(words in finding.reason for finding in findings.values())
    names = names_to_read("ardupilot", "fixed_wing", needs)
    assert "ALT_HOLD_RTL" in still_to_ask(names, names, ())


@pytest.mark.parametrize(
    ("values", "name"),
    [
        ({"RTL_RADIUS": 0.0, "WP_LOITER_RAD": -105.0}, None),
        ({"RTL_RADIUS": 0.0, "WP_LOITER_RAD": -150.0}, "WP_LOITER_RAD"),
        ({"RTL_RADIUS": 105.0, "WP_LOITER_RAD": 150.0}, None),
        ({"RTL_RADIUS": 150.0, "WP_LOITER_RAD": 105.0}, "RTL_RADIUS"),
        ({"WP_LOITER_RAD": 150.0}, None),
    ],
)
def test_the_circle_of_a_return_is_not_wider_than_planned(values: dict[str, float], name: str | None) -> None:
    """RTL_RADIUS where it is set, else WP_LOITER_RAD; a plan that lands has no such circle."""
    findings = found("ardupilot", "fixed_wing", RETURNS, values)
    assert list(findings) == ([] if name is None else [name])
    if name is not None:
        assert abs(findings[name].advised or 0.0) == 105.0
    assert not found("ardupilot", "fixed_wing", NEEDS, values)


@pytest.mark.parametrize(
    ("autopilot", "kind", "name", "unit"),
    [
        ("ardupilot", "multirotor", "RTL_ALT", 100.0),
        ("px4", "multirotor", "RTL_RETURN_ALT", 1.0),
        ("px4", "fixed_wing", "RTL_RETURN_ALT", 1.0),
    ],
)
def test_a_return_does_not_climb_above_what_the_plan_knows(
    autopilot: Autopilot, kind: VehicleType, name: str, unit: float
) -> None:
    """These climb to their return height first, and never come down to it."""
    assert not found(autopilot, kind, NEEDS, {name: 60.0 * unit})
    finding = found(autopilot, kind, NEEDS, {name: 400.0 * unit})[name]
    assert (finding.severity, finding.advised) == ("warning", 320.0 * unit)


MULTIROTORS: dict[Autopilot, dict[str, float]] = {
    "ardupilot": {
        "WPNAV_SPEED": 2000.0,
        "WPNAV_SPEED_UP": 250.0,
        "WPNAV_SPEED_DN": 150.0,
        "WPNAV_ACCEL": 250.0,
        "WPNAV_JERK": 1.0,
        "LAND_SPEED": 50.0,
    },
    "px4": {
        "MPC_XY_CRUISE": 20.0,
        "MPC_Z_V_AUTO_UP": 3.0,
        "MPC_Z_V_AUTO_DN": 1.5,
        "MPC_TKO_SPEED": 1.5,
        "MPC_LAND_SPEED": 0.7,
        "MPC_ACC_HOR": 3.0,
        "MPC_JERK_AUTO": 4.0,
        "NAV_ACC_RAD": 2.0,
    },
}


@pytest.mark.parametrize(
    ("autopilot", "name"), [(autopilot, name) for autopilot, values in MULTIROTORS.items() for name in values]
)
def test_what_multirotors_are_planned_with(autopilot: Autopilot, name: str) -> None:
    """The planner's own figures draw nothing; half or twice as much is told with them."""
    good = MULTIROTORS[autopilot]
    assert not found(autopilot, "multirotor", NEEDS, good)
    for part in (0.5, 2.0):
        finding = found(autopilot, "multirotor", NEEDS, good | {name: part * good[name]})[name]
        assert finding.severity == "warning"
        assert finding.advised == pytest.approx(good[name])


def test_the_figures_of_multirotors_are_the_planners() -> None:
    """Rates, accelerations and touch-down speeds as the planner takes them."""
    for autopilot, unit, names in (
        ("ardupilot", 100.0, ("WPNAV_SPEED_UP", "WPNAV_SPEED_DN", "WPNAV_ACCEL", "LAND_SPEED")),
        ("px4", 1.0, ("MPC_Z_V_AUTO_UP", "MPC_Z_V_AUTO_DN", "MPC_ACC_HOR", "MPC_LAND_SPEED")),
    ):
        manners = manners_of(Aircraft("a", "multirotor", autopilot, 10.0, 20.0))  # type: ignore[arg-type]
        planned = (manners.climb_m_s, manners.sink_m_s, manners.accel_m_s2, manners.land_m_s)
        held = MULTIROTORS[autopilot]  # type: ignore[index]
        assert [held[name] / unit for name in names] == pytest.approx(planned)
    px4 = manners_of(Aircraft("a", "multirotor", "px4", 10.0, 20.0))
    assert (px4.take_off_m_s, px4.jerk_m_s3, px4.corner_m) == tuple(
        MULTIROTORS["px4"][name] for name in ("MPC_TKO_SPEED", "MPC_JERK_AUTO", "NAV_ACC_RAD")
    )


def test_px4s_multirotors_fly_no_faster_than_their_limit() -> None:
    """At 12 m/s by default a plan for 20 m/s takes far longer: an error."""
    finding = found("px4", "multirotor", NEEDS, {"MPC_XY_VEL_MAX": 12.0})["MPC_XY_VEL_MAX"]
    assert (finding.severity, finding.advised) == ("error", 20.0)


@settings(max_examples=30, deadline=None)
@given(
    top_m=st.floats(120.0, 900.0),
    finish=st.sampled_from(["land", "return", "loiter"]),
    kind=st.sampled_from(["fixed_wing", "vtol", "multirotor"]),
    circles=st.booleans(),
    ceiling_m=st.one_of(st.none(), st.floats(10.0, 100.0)),
)
def test_needs_of_heights_are_the_plans(
    top_m: float, finish: str, kind: str, circles: bool, ceiling_m: float | None
) -> None:
    """By the plan's line alone: slopes over its vertices, its last place, what it flies over."""
    disc = ZoneCircle("mast", (-117.7, 33.5), 100.0, ceiling_m=ceiling_m)
    plan: Plan = make_plan(
        vehicle_type=kind,  # type: ignore[arg-type]
        finish=finish,  # type: ignore[arg-type]
        altitude_m=top_m,
        circles=circles,
        fence=Fence(exclusion_circles=(disc,)),
    )
    mission = encode(plan)
    heights = needs_of(plan, mission, RelayPayload(0)).heights
    segments = [s for s in plan.paths[0].segments if s.kind != "vertical"]
    for rate_m_s, sign in ((heights.climb_m_s, 1.0), (heights.sink_m_s, -1.0)):
        slopes = [sign * (s.end_altitude_m - s.start_altitude_m) / s.length_m for s in segments]
        assert rate_m_s == pytest.approx(max(0.0, *slopes) * SPEED_M_S)
    turns = [s for s in segments if (s.turn_deg or 0.0) > 359.0]
    for rate_m_s, sign in ((heights.turning_up_m_s, 1.0), (heights.turning_down_m_s, -1.0)):
        slopes = [sign * (s.end_altitude_m - s.start_altitude_m) / s.length_m for s in turns]
        assert rate_m_s == pytest.approx(max(0.0, 0.0, *slopes) * SPEED_M_S)
    assert heights.lowest_m == pytest.approx(top_m)
    assert heights.flown_over == ((ceiling_m, "mast") if ceiling_m is not None else (0.0, ""))
    if finish == "return" and kind != "multirotor":
        assert heights.return_m == pytest.approx(100.0)
        assert heights.circle_m == CIRCLE_M
    else:
        assert (heights.return_m, heights.circle_m) == (None, None)


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("kind", ["fixed_wing", "multirotor"])
def test_simulated_aircraft_hold_what_is_asked_for(autopilot: Autopilot, kind: VehicleType) -> None:
    """Every rule on the whole flight can be judged, and finds nothing."""
    home = Place(33.49, -117.75, 0.0)
    flavour = Flavour(autopilot)
    simulated = SimSettings(home, autopilot=flavour, vehicle_type=kind, airspeed_m_s=20.0)
    station = Station(SimulatedAircraft(simulated))

    def read(name: str) -> float:
        (told,) = station.say(from_ground("PARAM_REQUEST_READ", param_id=name, param_index=-1))
        return told.number("param_value")

    # What climbs and sinks slower than 20 m/s at 8° would be told.
    needs = replace(NEEDS, heights=replace(HEIGHTS, climb_m_s=1.9))
    asked = names_to_read(autopilot, kind, needs)
    whole = [n for n in asked if n.startswith(("TECS", "RTL", "WPNAV", "LAND", "FW_T", "MPC", "WP_LOITER"))]
    values = {name: read(name) for name in whole}
    assert judge_parameters(autopilot, kind, needs, values) == ()
