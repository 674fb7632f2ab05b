"""Signs that a vehicle holds something else than was sent: each is told once, reports of before are none."""

from __future__ import annotations

from dataclasses import replace

from app.services.records import HeldMission
from app.services.vehicles.aboard import Aboard, Meant
from mavlink.state.telemetry import VehicleState
from tests.mavlink.transfer.vehicle import waypoints

MEANT = Meant(HeldMission("plan", "uav-1", None, None), waypoints(5), lambda meant, held: ())
STATE = VehicleState(connected=True, mission_total=5, mission_state="not_started")


def told(states: list[VehicleState], every_s: float = 0.2) -> list[str]:
    """What is told of states that follow each other."""
    aboard = Aboard()
    aboard.meant = MEANT
    said = [aboard.lost(state, number * every_s) for number, state in enumerate(states)]
    return [words for words in said if words is not None]


def test_another_number_of_items_is_told_once() -> None:
    """After three seconds of it; the number it held before, reported for one more second, is not."""
    other = replace(STATE, mission_total=7)
    assert told([other] * 200) == ["it holds 7 items, not 5"]
    assert told([other] * 5 + [STATE] * 200) == []
    assert len(told([other] * 50 + [STATE] + [other] * 50)) == 2


def test_a_mission_that_is_gone_is_told() -> None:
    """By the state of the mission, where no number is reported; where none is known nothing is concluded."""
    assert told([replace(STATE, mission_total=None, mission_state="none")] * 100) == ["it holds no mission"]
    assert told([replace(STATE, mission_total=None, mission_state=None)] * 100) == []
    assert Aboard().lost(replace(STATE, mission_total=9), 99.0) is None


def test_each_start_is_told() -> None:
    """Once for each; a new link that counts from the beginning is none."""
    again = [replace(STATE, restarts=number) for number in (0, 1, 1, 2, 0, 1)]
    assert told(again) == ["it has started anew"] * 3
