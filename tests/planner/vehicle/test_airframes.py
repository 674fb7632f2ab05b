"""The airframe database: figures that make aircraft, and entries that begin with them."""

import math

import pytest

from planner.geojson.equipment import read_aircraft
from planner.geojson.fields import Findings
from planner.vehicle.airframes import AIRFRAMES, find_airframe
from planner.vehicle.energy import FlightState


def read(**entry):
    """The aircraft of an entry, and the rules of what is found."""
    findings = Findings()
    return read_aircraft({"name": "uav", **entry}, 0, findings), [f.rule for f in findings.all()]


@pytest.mark.parametrize("name", AIRFRAMES)
def test_each_airframe_is_an_aircraft(name):
    """Its name alone makes an aircraft with a power model, and it has a source."""
    aircraft, found = read(model=name.lower())
    assert not found
    assert aircraft.power.power_w(FlightState(aircraft.airspeed_m_s)) > 20.0
    assert len(AIRFRAMES[name].source) > 20


def test_there_are_ten():
    """Multirotors, wings, and one that is both."""
    assert len(AIRFRAMES) >= 10
    assert {airframe.members["type"] for airframe in AIRFRAMES.values()} == {
        "multirotor",
        "fixed_wing",
        "vtol",
    }


@pytest.mark.parametrize(
    ("name", "minutes"),
    [("DJI Matrice 300 RTK", 55.0), ("DJI Mavic 2 Pro", 29.0), ("DJI Matrice 600 Pro", 32.0)],
)
def test_batteries_last_as_published(name, minutes):
    """A hover takes the battery in the time that the maker publishes."""
    aircraft, _ = read(model=name)
    hover_w = aircraft.power.power_w(FlightState(0.0))
    assert aircraft.energy_wh / hover_w * 60.0 == pytest.approx(minutes, rel=1e-3)
    # Momentum theory by hand: T √(T / 2ρA), and rotors are worse than ideal.
    power = AIRFRAMES[name].members["power"]
    thrust_n = power["mass_kg"] * 9.80665
    disc_m2 = power["rotors"] * math.pi * power["rotor_diameter_m"] ** 2 / 4.0
    assert 0.3 < thrust_n * math.sqrt(thrust_n / (2.0 * 1.225 * disc_m2)) / hover_w < 0.75


def test_own_figures_go_first():
    """An entry's own energy, speed and turns stand in place of its model's."""
    aircraft, found = read(
        model="DJI Phantom 4 Pro", airspeed_m_s=7.0, charge_mah=5870, voltage_v=15.2, min_turn_radius_m=9.0
    )
    assert not found
    assert (aircraft.airspeed_m_s, aircraft.min_turn_radius_m) == (7.0, 9.0)
    assert aircraft.energy_wh == pytest.approx(89.224)
    assert aircraft.type == "multirotor"


def test_unknown_models_are_named_with_what_is_near():
    """No airframe is guessed."""
    _, found = read(model="Phantom 4", airspeed_m_s=10.0, min_turn_radius_m=5.0)
    assert found == ["bad-value"]
    with pytest.raises(KeyError, match="Phantom 4 Pro"):
        find_airframe("DJI Phantom 4")


@pytest.mark.parametrize(
    ("entry", "rule"),
    [
        ({"charge_mah": 5000}, "missing-property"),
        ({"voltage_v": 11.1}, "missing-property"),
        ({"charge_mah": 5000, "voltage_v": 11.1, "energy_wh": 55.5}, "bad-value"),
        ({"charge_mah": -1, "voltage_v": 11.1}, "out-of-range"),
    ],
)
def test_charge_and_voltage_go_together(entry, rule):
    """One without the other, or beside the energy, is refused."""
    _, found = read(model="Aerosonde", **entry)
    assert rule in found
