"""What passes leave room for where a scenario names an autopilot and says nothing of settling or margins."""

from __future__ import annotations

import math
from typing import Any

import pytest

from planner.geojson import read_scenario
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.vehicle.model import FlightModel
from planner.vehicle.steadiness import steadiness_of
from tests.planner.scenarios import small

MARGINS = ("pointing_margin_deg", "position_margin_m")


def asked(vehicle: dict[str, Any], sensor: dict[str, Any] | None = None, **members: Any) -> Scenario:
    """The small scenario with properties of its vehicle and its sensor."""
    document = small(**members)
    document["vehicles"][0] |= vehicle
    document["sensors"][0] |= sensor or {}
    return read_scenario(document)


def margins_of(scenario: Scenario) -> tuple[float, float]:
    """Degrees and metres of the first sensor."""
    sensor = scenario.sensors[0]
    assert isinstance(sensor, SarSensor)
    return math.degrees(sensor.pointing_margin_rad), sensor.position_margin_m


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("kind", ["fixed_wing", "vtol", "multirotor"])
def test_an_autopilot_that_is_named_has_its_own(autopilot: Any, kind: Any) -> None:
    """Seconds of its straight flight at the airspeed, and its margins."""
    steady = steadiness_of(autopilot, kind)
    scenario = asked({"autopilot": autopilot, "type": kind})
    assert scenario.aircraft[0].settle_m == pytest.approx(20.0 * steady.settle_s)
    assert margins_of(scenario) == pytest.approx((steady.pointing_deg, steady.position_m))
    assert min(steady.settle_s, steady.pointing_deg, steady.position_m) > 0.0


def test_where_none_is_named_nothing_is_added() -> None:
    """The contract's zeros."""
    scenario = asked({})
    assert scenario.aircraft[0].settle_m == 0.0
    assert margins_of(scenario) == (0.0, 0.0)


def test_what_is_said_counts() -> None:
    """Zeros and other figures, each by itself."""
    named = {"autopilot": "ardupilot"}
    zero = asked(named | {"settle_m": 0.0}, dict.fromkeys(MARGINS, 0.0))
    assert (zero.aircraft[0].settle_m, margins_of(zero)) == (0.0, (0.0, 0.0))
    mixed = asked(named | {"settle_m": 35.0}, {"position_margin_m": 1.0})
    assert mixed.aircraft[0].settle_m == 35.0
    assert margins_of(mixed) == pytest.approx((steadiness_of("ardupilot", "fixed_wing").pointing_deg, 1.0))


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_wings_have_their_seconds_with_the_wind_behind(autopilot: Any) -> None:
    """At the fastest over the ground: airspeed and wind together, for what hovers the airspeed alone."""
    wind = {"speed_m_s": 8.0, "from_deg": 200.0}
    for kind, fastest_m_s in (("fixed_wing", 28.0), ("multirotor", 20.0)):
        scenario = asked({"autopilot": autopilot, "type": kind}, wind=wind)
        settle_m = FlightModel.of(scenario.aircraft[0], scenario.wind).settle_m
        assert settle_m == pytest.approx(fastest_m_s * steadiness_of(autopilot, kind).settle_s)


def test_a_narrow_beam_keeps_most_of_itself() -> None:
    """A margin that nobody asked for refuses no sensor; one that was asked for does."""
    narrow = {"elevation_beamwidth_deg": 2.0}
    pointing_deg, _ = margins_of(asked({"autopilot": "ardupilot"}, narrow))
    assert 0.0 < pointing_deg <= 0.25
    with pytest.raises(Exception, match="pointing_margin_deg"):
        asked({"autopilot": "ardupilot"}, narrow | {"pointing_margin_deg": 1.5})
