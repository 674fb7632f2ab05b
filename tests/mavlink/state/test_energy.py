"""Energy drawn: by the battery's count, by charge and by current, against power summed by the test."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavlink.state.energy import EnergyMeter
from mavlink.wire.messages import Message


def battery(
    number: int = 0, *, hectojoules: int = -1, mah: int = -1, centiamperes: int = -1, millivolts: int = 24000
) -> Message:
    """A BATTERY_STATUS."""
    return Message(
        "BATTERY_STATUS",
        {
            "id": number,
            "voltages": (millivolts, *(65535,) * 9),
            "current_battery": centiamperes,
            "current_consumed": mah,
            "energy_consumed": hectojoules,
            "battery_remaining": 50,
        },
    )


powers = st.lists(st.floats(0.0, 600.0), min_size=2, max_size=60)


@given(powers, st.integers(0, 10**6))
def test_counted_energy_is_the_difference_of_the_counts(drawn_w: list[float], before_hj: int) -> None:
    """What was drawn before the flight is no part of it; of several batteries all counts."""
    meter, counts = EnergyMeter(), [before_hj]
    for power_w in drawn_w:
        counts.append(counts[-1] + round(power_w / 100.0 * 20.0))
    for second, count in enumerate(counts):
        meter.take(battery(hectojoules=count, centiamperes=1), 20.0 * second)
        meter.take(battery(1, hectojoules=2 * count), 20.0 * second)
    energy = meter.energy
    assert energy is not None
    assert energy.used_wh == pytest.approx(3.0 * (counts[-1] - counts[0]) * 100.0 / 3600.0)
    assert (energy.source, energy.complete) == ("counted", True)


@given(powers)
def test_current_times_voltage_is_summed_over_the_time(drawn_w: list[float]) -> None:
    """Trapezoids between readings a second apart, from SYS_STATUS where there is no battery's own message."""
    meter = EnergyMeter()
    amperes = [round(power_w / 24.0 * 100.0) / 100.0 for power_w in drawn_w]
    for second, ampere in enumerate(amperes):
        fields = {"voltage_battery": 24000, "current_battery": round(ampere * 100.0)}
        meter.take(Message("SYS_STATUS", fields), float(second))
    wanted_j = sum((a + b) / 2.0 * 24.0 for a, b in pairwise(amperes))
    energy = meter.energy
    assert energy is not None
    assert energy.used_wh == pytest.approx(wanted_j / 3600.0, abs=1e-9)
    assert (energy.source, energy.complete) == ("integrated", True)


def test_a_changed_battery_and_missing_readings_are_told() -> None:
    """A count that begins anew loses what came before it, a minute without a current is not made up."""
    changed, silent = EnergyMeter(), EnergyMeter()
    for second, count in enumerate((500, 600, 3, 103)):
        changed.take(battery(hectojoules=count), float(second))
    for second in (0.0, 1.0, 61.0, 62.0):
        silent.take(battery(centiamperes=1500), second)
    for meter, wanted_wh in ((changed, 200 * 100 / 3600), (silent, 2 * 15 * 24 / 3600)):
        assert meter.energy is not None
        assert meter.energy.used_wh == pytest.approx(wanted_wh)
        assert not meter.energy.complete


def test_charge_is_counted_where_energy_is_not() -> None:
    """Milliampere hours times the voltage of the moment."""
    meter = EnergyMeter()
    for second, mah in enumerate((100, 600, 1100)):
        meter.take(battery(mah=mah), float(second))
    assert meter.energy is not None
    assert meter.energy.used_wh == pytest.approx(24.0)
    assert meter.energy.source == "charge"


def test_nothing_told_is_no_energy() -> None:
    """Without a current, a charge or a count there is none; forgotten, it begins anew."""
    meter = EnergyMeter()
    for second in range(3):
        meter.take(battery(), float(second))
        meter.take(Message("SYS_STATUS", {"voltage_battery": 65535, "current_battery": -1}), float(second))
    assert meter.energy is None
    for count in (10, 20):
        meter.take(battery(hectojoules=count), 1.0)
    meter.forget()
    assert meter.energy is None
