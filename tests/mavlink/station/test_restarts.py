"""A vehicle's new start is told by its own clock, once each; what was read before does not count after it."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.state.telemetry import VehicleState
from mavlink.station.restarts import Restarts
from mavlink.transfer.count import CountMachine
from mavlink.transfer.outcome import Accepted, Unknown
from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import HASTY, flying
from tests.mavlink.transfer.vehicle import waypoints
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.virtual_time

STATE = VehicleState(connected=True)


def told(times_s: list[float]) -> int:
    """How many starts are told of frames with these times since boot."""
    restarts = Restarts()
    return sum(
        restarts.noticed(STATE, STATE, Message("ATTITUDE", {"time_boot_ms": round(time_s * 1000.0)}))
        for time_s in times_s
    )


@settings(deadline=None, max_examples=100)
@given(st.lists(st.floats(6.0, 500.0), min_size=1, max_size=5), st.integers(0, 999))
def test_each_start_is_told_once(lives_s: list[float], seed: int) -> None:
    """Whatever is lost or overtaken by up to a second; each life is told five times a second."""
    random = Random(seed)
    frames: list[float] = []
    for life_s in lives_s:
        sent = [0.2 * n for n in range(round(life_s / 0.2)) if n < 5 or random.random() < 0.5]
        late = [(time_s + random.uniform(0.0, 1.0), time_s) for time_s in sent]
        frames += [time_s for _, time_s in sorted(late)]
    assert told(frames) == len(lives_s) - 1


def test_one_old_frame_is_no_start() -> None:
    """A frame held up for a minute on its way changes nothing."""
    assert told([100.0, 100.2, 40.0, 100.4, 41.0, 100.6]) == 0


def test_starting_is_told_by_the_heartbeat() -> None:
    """A vehicle that says that it starts, and was flying, has started anew."""
    booting = VehicleState(connected=True, booting=True)
    beat = Message("HEARTBEAT", {})
    assert Restarts().noticed(STATE, booting, beat)
    assert not Restarts().noticed(booting, booting, beat)
    assert not Restarts().noticed(VehicleState(), booting, beat)


async def test_what_was_read_before_is_read_again() -> None:
    """The mission as read last is forgotten at a start, and telemetry is asked for anew."""
    async with flying() as (client, aircraft):
        await client.upload(waypoints(4), MissionType.MISSION)
        assert len(await client.mission_held()) == 4
        for time_ms in (90_000, 90_200, 1_000, 1_200):
            await aircraft.say("ATTITUDE", time_boot_ms=time_ms)
        aircraft.vehicle.held[0] = ()
        asked = sum(number == 511 for number, _ in aircraft.commands)
        await client.wait_for(lambda state: state.restarts == 1, PATIENCE_S)
        assert await client.mission_held() == ()
        assert sum(number == 511 for number, _ in aircraft.commands) > asked


async def test_the_count_is_asked_and_nothing_is_left_open() -> None:
    """Both autopilots tell the number and take an upload right behind it."""
    for manner in ("ardupilot", "px4"):
        async with flying(manner) as (client, aircraft):
            for count in (5, 0, 3):
                assert await client.upload(waypoints(count), MissionType.MISSION) == Accepted()
                assert (await client.count_held())[0] == count
                assert not aircraft.heard[-1].name.startswith("MISSION_REQUEST_INT")


def test_a_simulated_autopilot_tells_its_id() -> None:
    """PX4's id of a list comes with the count; ArduPilot gives none. A silent vehicle is given up."""
    for flavour in Flavour:
        aircraft = SimulatedAircraft(SimSettings(autopilot=flavour))
        machine = CountMachine(MissionType.MISSION, 1, 1, HASTY)
        for question in machine.start(0.0):
            for answer in aircraft.receive(Message(question.name, question.fields, 255, 190), 0.0):
                machine.receive(Message(answer.name, answer.fields, 1, 1), 0.0)
        assert machine.outcome == Accepted()
        assert machine.opaque_id is None
    machine = CountMachine(MissionType.MISSION, 1, 1, HASTY)
    machine.start(0.0)
    for second in range(1, 20):
        machine.tick(float(second))
    assert machine.outcome == Unknown("timeout")
