"""Power and energy against hand-worked values, closed forms and the judge's own reckoning."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from planner.check import judge
from planner.check.energy import line_wh
from planner.errors import InfeasibleError, ScenarioError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.vehicle.energy import DragPolar, FlightState, PowerTable, Rotors
from tests.planner.scenarios import small

WING = {
    "model": "drag_polar", "mass_kg": 5.0, "wing_area_m2": 0.8, "aspect_ratio": 10.0, "cd0": 0.03,
    "hover_w": 900.0,
}  # fmt: skip
ROTORS = {"model": "multirotor", "mass_kg": 2.0, "rotors": 4, "rotor_diameter_m": 0.33, "drag_area_m2": 0.015}
MODELS = {"fixed_wing": {k: v for k, v in WING.items() if k != "hover_w"}, "vtol": WING, "multirotor": ROTORS}


def test_a_wing_in_level_flight_by_hand() -> None:
    """5 kg on 0.8 m² at 20 m/s: q = 245 Pa, C_L = 0.250166, C_D = 0.03 + C_L² / (8 π), 60 % efficient."""
    wing = DragPolar(5.0, 0.8, 10.0, 0.03, oswald=0.8, efficiency=0.6)
    lift = 5.0 * 9.80665 / (245.0 * 0.8)
    drag_n = 245.0 * 0.8 * (0.03 + lift**2 / (math.pi * 8.0))
    assert wing.drag_n(FlightState(20.0)) == pytest.approx(drag_n, rel=1e-12)
    assert wing.power_w(FlightState(20.0)) == pytest.approx(drag_n * 20.0 / 0.6, rel=1e-12)
    assert wing.power_w(FlightState(20.0, climb_m_s=2.0)) == pytest.approx(
        (drag_n * 20.0 + 5.0 * 9.80665 * 2.0) / 0.6, rel=1e-12
    )
    assert wing.power_w(FlightState(20.0, climb_m_s=-9.0)) == 0.0


@given(st.floats(0.5, 50.0), st.floats(0.02, 1.0), st.floats(4.0, 25.0), st.floats(0.01, 0.08))
def test_drag_is_least_where_its_parts_are_equal(mass: float, area: float, aspect: float, cd0: float) -> None:
    """At C_L = √(C_D0 / k) drag is 2 W √(C_D0 k), and more on either side."""
    wing = DragPolar(mass, area, aspect, cd0)
    best = math.sqrt(cd0 / wing.induced)
    speed_m_s = math.sqrt(2.0 * mass * 9.80665 / (1.225 * area * best))
    least_n = wing.drag_n(FlightState(speed_m_s))
    assert least_n == pytest.approx(2.0 * mass * 9.80665 * math.sqrt(cd0 * wing.induced), rel=1e-9)
    assert all(wing.drag_n(FlightState(f * speed_m_s)) > least_n for f in (0.9, 1.1))


def test_a_hover_takes_the_power_of_momentum_theory() -> None:
    """T^1.5 / √(2 ρ A), by figure of merit and efficiency; thinner air takes more."""
    rotors = Rotors(2.0, 0.34, figure_of_merit=0.7, efficiency=0.85, avionics_w=6.0)
    thrust_n = 2.0 * 9.80665
    ideal_w = thrust_n**1.5 / math.sqrt(2.0 * 1.225 * 0.34)
    assert rotors.power_w(FlightState(0.0)) == pytest.approx(ideal_w / (0.7 * 0.85) + 6.0, rel=1e-9)
    assert rotors.power_w(FlightState(0.0, above_sea_m=3000.0)) > 1.1 * rotors.power_w(FlightState(0.0))
    assert rotors.power_w(FlightState(0.0, climb_m_s=-2.0)) == rotors.power_w(FlightState(0.0))


@given(st.floats(0.1, 30.0), st.floats(0.0, 6.0), st.floats(1.0, 2.0))
def test_induced_velocity_solves_glauert(speed_m_s: float, climb_m_s: float, load: float) -> None:
    """Forward and upward: the root of the momentum equation as scipy finds it."""
    rotors = Rotors(3.0, 0.5, drag_area_m2=0.02)
    lift_n, drag_n = load * 3.0 * 9.80665, 0.5 * 1.225 * 0.02 * speed_m_s**2
    thrust_n, tilt = math.hypot(lift_n, drag_n), math.atan2(drag_n, lift_n)
    beside = speed_m_s * math.cos(tilt)
    through = speed_m_s * math.sin(tilt) + climb_m_s * math.cos(tilt)
    induced = brentq(
        lambda v: v * math.hypot(beside, through + v) - thrust_n / (2.0 * 1.225 * 0.5), 0.0, 100.0
    )
    wanted_w = thrust_n * (through + induced) / (0.65 * 0.8)
    assert rotors.power_w(FlightState(speed_m_s, climb_m_s, load)) == pytest.approx(wanted_w, rel=1e-6)


def test_a_table_is_straight_between_its_rows() -> None:
    """numpy's interpolation, ends kept; a climb by its mass besides."""
    rows = ((0.0, 300.0), (8.0, 250.0), (15.0, 400.0))
    table = PowerTable(rows, mass_kg=2.0, efficiency=0.5)
    for speed_m_s in np.linspace(-1.0, 20.0, 43):
        wanted_w = float(np.interp(speed_m_s, *zip(*rows, strict=True)))
        assert table.power_w(FlightState(float(speed_m_s))) == pytest.approx(wanted_w)
    assert table.power_w(FlightState(8.0, climb_m_s=1.0)) == pytest.approx(250.0 + 2.0 * 9.80665 / 0.5)


def planned(kind: str, power: dict[str, Any], **members: Any) -> tuple[Plan, Any]:
    document = small(**members)
    document["vehicles"][0] |= {"type": kind, "power": power, "max_climb_deg": 6.0}
    scenario = read_scenario(document)
    return make_plan(scenario), scenario


@pytest.mark.parametrize("kind", ["fixed_wing", "vtol", "multirotor"])
@pytest.mark.parametrize("wind", [None, {"speed_m_s": 7.0, "from_deg": 250.0}])
def test_the_energy_of_a_plan_is_that_of_its_line(kind: str, wind: dict[str, float] | None) -> None:
    """The judge finds the same from the published line alone; it stands in metrics and path alike."""
    plan, scenario = planned(kind, MODELS[kind], **({} if wind is None else {"wind": wind}))
    (path,) = plan.paths
    line_m = scenario.frame.to_local([place[:2] for place in path.line])
    aircraft = scenario.aircraft[0].in_wind(scenario.wind.speed_m_s)
    altitudes_m = np.array([place[2] for place in path.line])
    judged_wh = line_wh(line_m, altitudes_m, aircraft, scenario.wind, 0.0, path.duration_s)
    assert plan.metrics.energy_wh == path.energy_wh
    assert path.energy_wh == pytest.approx(judged_wh, rel=0.02)
    assert plan.violations == ()


def test_a_battery_that_does_not_suffice_is_told() -> None:
    """The plan's own energy less a watt-hour, by its reserve: there is no plan, and by how much is said."""
    plan, _ = planned("multirotor", ROTORS)
    assert plan.metrics.energy_wh is not None
    document = small()
    document["vehicles"][0] |= {
        "type": "multirotor", "power": ROTORS, "max_climb_deg": 6.0, "reserve": 0.25,
        "energy_wh": (plan.metrics.energy_wh - 1.0) / 0.75,
    }  # fmt: skip
    with pytest.raises(InfeasibleError, match=r"[0-9.]+ Wh too little") as refused:
        make_plan(read_scenario(document))
    assert refused.value.constraint == "energy"
    assert ": 1.0 Wh too little" in refused.value.message
    # The judge finds the same of a plan made for a larger battery.
    found = judge(read_scenario(document), plan).violations
    assert [(each.constraint, each.hard, each.unit) for each in found] == [("energy", True, "Wh")]
    assert found[0].amount == pytest.approx(1.0, abs=0.02 * plan.metrics.energy_wh)


@pytest.mark.parametrize(
    ("kind", "power", "said"),
    [
        ("fixed_wing", {"model": "drag_polar", "mass_kg": 5.0}, "wing_area_m2"),
        ("fixed_wing", ROTORS, "multirotor"),
        ("multirotor", MODELS["fixed_wing"], "wing"),
        ("vtol", MODELS["fixed_wing"], "hover_w"),
        ("multirotor", {"model": "multirotor", "mass_kg": 2.0}, "rotor_diameter_m"),
        ("multirotor", {"model": "multirotor", "table": [[3.0, 100.0], [1.0, 90.0]]}, "table"),
        ("fixed_wing", {"model": "magic"}, "model"),
        ("fixed_wing", {"model": "constant", "power_w": -1.0}, "power_w"),
        ("fixed_wing", {"model": "constant", "power_w": 100.0, "mass_kg": 1.0}, "mass_kg"),
        ("fixed_wing", 120.0, "power"),
    ],
)
def test_a_power_model_that_cannot_be_is_refused_by_name(kind: str, power: Any, said: str) -> None:
    """Missing, of another kind of aircraft, out of range, unknown: the property is named."""
    document = small()
    document["vehicles"][0] |= {"type": kind, "power": power}
    with pytest.raises(ScenarioError) as caught:
        read_scenario(document)
    assert said in " ".join(f"{f.feature} {f.message} {f.fix}" for f in caught.value.findings)
