"""Rates of climb and descent that a plan asks for in its wind, by the wind triangle."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.encoding.encode import encode
from mavlink.encoding.payload import RelayPayload
from mavlink.rules.base import Needs, needs_of
from mavlink.rules.heights import heights_of
from mavlink.rules.table import judge_parameters
from mavlink.rules.wind import fastest_m_s
from planner.plan import PathSegment, Plan, PlanWind
from planner.route import Pose
from tests.mavlink.plans import SPEED_M_S, lonlat, make_plan

#: Of docs/flight.md: 20 m/s, 8 m/s of wind, 8° up, and what these are in still air.
V_M_S, W_M_S, SLOPE_DEG, STILL_M_S = 20.0, 8.0, 8.0, 2.81


def climbing(wind: PlanWind, heading_deg: float = 90.0) -> Plan:
    """A plan that climbs straight at 8°, all else level."""
    plan = make_plan(start=Pose(0.0, 0.0, math.radians(90.0 - heading_deg)), wind=wind)
    straight = next(s for s in plan.paths[0].segments if s.kind == "straight" and s.length_m > 100.0)
    level = [replace(s, end_altitude_m=s.start_altitude_m) for s in plan.paths[0].segments if s != straight]
    up_m = straight.length_m * math.sin(math.radians(SLOPE_DEG))
    steep = replace(straight, end_altitude_m=straight.start_altitude_m + up_m)
    return replace(plan, paths=(replace(plan.paths[0], segments=(steep, *level)),))


def needs(plan: Plan) -> Needs:
    return needs_of(plan, encode(plan), RelayPayload(0))


@pytest.mark.parametrize(("name", "autopilot"), [("TECS_CLMB_MAX", "ardupilot"), ("FW_T_CLMB_MAX", "px4")])
def test_the_rate_of_still_air_is_too_slow_with_the_wind_behind(name: str, autopilot: str) -> None:
    """8 m/s behind 20 m/s ask for (V + W) / V of it, which is named; ahead, less than still air does."""
    values = {name: STILL_M_S}
    behind = needs(climbing(PlanWind(W_M_S, 270.0)))
    (finding,) = judge_parameters(autopilot, "fixed_wing", behind, values)  # type: ignore[arg-type]
    assert (finding.name, finding.severity) == (name, "error")
    assert finding.advised == pytest.approx(STILL_M_S * (V_M_S + W_M_S) / V_M_S, abs=0.1)
    assert "8 m/s of wind behind" in finding.reason
    for wind in (PlanWind(), PlanWind(W_M_S, 90.0)):
        assert not judge_parameters(autopilot, "fixed_wing", needs(climbing(wind)), values)  # type: ignore[arg-type]


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_what_straight_legs_need_is_not_too_fast_for_circles(autopilot: str) -> None:
    """What is advised for the one draws nothing for the other."""
    wind = replace(needs(climbing(PlanWind(W_M_S, 270.0))).heights, turning_up_m_s=2.0, turning_down_m_s=1.0)
    both = replace(needs(climbing(PlanWind())), heights=wind)
    name = "TECS_CLMB_MAX" if autopilot == "ardupilot" else "FW_T_CLMB_R_SP"
    assert not judge_parameters(autopilot, "fixed_wing", both, {name: 3.9})  # type: ignore[arg-type]
    (finding,) = judge_parameters(autopilot, "fixed_wing", both, {name: 4.5})  # type: ignore[arg-type]
    assert "circles" in finding.reason


def test_what_hovers_gains_nothing_by_wind() -> None:
    """It holds its speed over the ground."""
    plan = make_plan(vehicle_type="multirotor", wind=PlanWind(5.0, 270.0))
    still = make_plan(vehicle_type="multirotor")
    assert heights_of(plan, "uav-1") == heights_of(still, "uav-1")


@settings(max_examples=60)
@given(
    st.floats(0.0, 360.0), st.floats(0.1, 15.0), st.floats(0.0, 360.0), st.floats(1.0, 350.0), st.booleans()
)
def test_speeds_are_those_of_the_air_and_the_wind_together(
    from_deg: float, wind_m_s: float, heading_deg: float, turn_deg: float, left: bool
) -> None:
    """On a straight the air's velocity is V long; on an arc no course of it is faster than what is told."""
    wind = PlanWind(wind_m_s, from_deg)
    angle = math.radians(90.0 - heading_deg)
    ahead = (1000.0 * math.cos(angle), 1000.0 * math.sin(angle))
    straight = PathSegment("straight", lonlat((0.0, 0.0)), lonlat(ahead), 0.0, 1000.0)

    def triangle(course_rad: float, ground_m_s: float) -> float:
        toward = math.radians(90.0 - from_deg - 180.0)
        return math.hypot(
            ground_m_s * math.cos(course_rad) - wind_m_s * math.cos(toward),
            ground_m_s * math.sin(course_rad) - wind_m_s * math.sin(toward),
        )

    assert triangle(angle, fastest_m_s(straight, V_M_S, wind)) == pytest.approx(V_M_S, abs=1e-3)
    side = 1.0 if left else -1.0
    centre = (-100.0 * side * math.sin(angle), 100.0 * side * math.cos(angle))
    arc = PathSegment(
        "left" if left else "right",
        lonlat((0.0, 0.0)),
        lonlat((0.0, 0.0)),
        0.0,
        1.0,
        100.0,
        lonlat(centre),
        turn_deg,
    )
    fastest = fastest_m_s(arc, V_M_S, wind)
    courses = [angle + side * math.radians(turn_deg) * part / 200.0 for part in range(201)]
    # What is faster than the wind triangle allows needs more air than V; what is slower, less.
    assert min(triangle(course, fastest) for course in courses) == pytest.approx(V_M_S, abs=0.02)


def test_whole_turns_count_as_in_still_air() -> None:
    """They are flown on every course."""
    turn = PathSegment("left", (0.0, 0.0), (0.0, 0.0), 0.0, 1.0, 100.0, (0.001, 0.0), 720.0)
    assert fastest_m_s(turn, SPEED_M_S, PlanWind(8.0, 10.0)) == SPEED_M_S
