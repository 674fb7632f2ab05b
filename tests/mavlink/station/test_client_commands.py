"""The client commands a stub aircraft: one at a time, in each autopilot's language."""

from __future__ import annotations

import asyncio

import pytest

from mavlink.errors import NotConnectedError
from mavlink.transfer.outcome import Accepted
from mavlink.wire.items import Command
from tests.mavlink.station.aircraft import LOST_AFTER_S, flying
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.virtual_time


async def test_commands_are_answered_and_take_turns() -> None:
    """Accepted, refused and unanswered commands; two of one number do not take each other's answer."""
    async with flying() as (client, aircraft):
        aircraft.results = {Command.MISSION_START: 2, Command.DO_SET_RELAY: None}
        outcomes = await asyncio.gather(
            client.arm(), client.disarm(), client.command(300), client.command(181)
        )
        assert [outcome.result for outcome in outcomes] == [0, 0, 2, None]
        assert [params[0] for number, params in aircraft.commands if number == 400] == [1.0, 0.0]
        assert "MISSION_START: denied" in str(outcomes[2])


async def test_a_cancelled_command_makes_room_for_the_next() -> None:
    """Giving up on an unanswered command does not block others of its number."""
    async with flying() as (client, aircraft):
        aircraft.results = {Command.COMPONENT_ARM_DISARM: None}
        first = asyncio.create_task(client.arm())
        await asyncio.sleep(0.02)
        first.cancel()
        with pytest.raises(asyncio.CancelledError):
            await first
        aircraft.results = {}
        assert (await client.disarm()).accepted


COPTER, PLANE = 2, 1

FLIGHT = [
    ("ardupilot", PLANE, "start_mission", [(176, (1.0, 10.0, 0.0)), (300, (0.0, 0.0, 0.0))]),
    ("ardupilot", PLANE, "pause", [(176, (1.0, 12.0, 0.0))]),
    ("ardupilot", PLANE, "resume", [(176, (1.0, 10.0, 0.0))]),
    ("ardupilot", COPTER, "pause", [(193, (0.0, 0.0, 0.0))]),
    ("ardupilot", COPTER, "resume", [(193, (1.0, 0.0, 0.0))]),
    ("ardupilot", COPTER, "start_mission", [(176, (1.0, 3.0, 0.0)), (300, (0.0, 0.0, 0.0))]),
    # Armed as it is: at the item it is at, where 0 would begin anew.
    ("px4", PLANE, "start_mission", [(300, (-1.0, 0.0, 0.0))]),
    ("px4", PLANE, "pause", [(176, (1.0, 4.0, 3.0))]),
    ("px4", PLANE, "resume", [(176, (1.0, 4.0, 4.0))]),
    ("generic", PLANE, "pause", [(193, (0.0, 0.0, 0.0))]),
    ("px4", PLANE, "return_to_launch", [(20, (0.0, 0.0, 0.0))]),
]


@pytest.mark.parametrize(("manner", "kind", "helper", "expected"), FLIGHT)
async def test_flight_commands_speak_each_autopilots_language(
    manner: str, kind: int, helper: str, expected: list[tuple[int, tuple[float, ...]]]
) -> None:
    """Each helper sends what that autopilot understands, and nothing else."""
    async with flying(manner, kind) as (client, aircraft):
        assert (await getattr(client, helper)()).accepted
        sent = [(number, params[:3]) for number, params in aircraft.commands if number not in (511, 512)]
        assert sent == expected


async def test_a_refused_mode_stops_the_start() -> None:
    """An ArduPilot that does not go to AUTO is not told to start."""
    async with flying() as (client, aircraft):
        aircraft.results = {Command.DO_SET_MODE: 4}
        assert (await client.start_mission()).result == 4
        assert 300 not in [number for number, _ in aircraft.commands]


async def test_an_item_becomes_the_current_one() -> None:
    """goto_item waits for the vehicle's MISSION_CURRENT, and the state shows it."""
    async with flying() as (client, _):
        assert await client.goto_item(7) == Accepted()
        assert client.state.mission_current == 7


@pytest.mark.parametrize(("manner", "kind"), [("ardupilot", PLANE), ("ardupilot", COPTER), ("px4", COPTER)])
async def test_what_makes_safe_is_sent_to_one_that_is_silent(manner: str, kind: int) -> None:
    """It may hear what it does not answer; nothing else is sent, and nothing once the client is closed."""
    async with flying(manner, kind, lost_after_s=LOST_AFTER_S) as (client, aircraft):
        aircraft.vanish()
        await client.wait_for(lambda state: not state.connected, PATIENCE_S)
        aircraft.commands.clear()
        for order in (client.start_mission, client.resume, client.arm, client.disarm, client.pause):
            with pytest.raises(NotConnectedError, match="nothing is sent"):
                await order()
        await asyncio.sleep(1.0)
        assert not aircraft.commands
        numbers = []
        for stop in (client.return_to_launch, client.hold, client.land_here):
            assert (await stop()).result is None
            numbers.append({number for number, _ in aircraft.commands})
            aircraft.commands.clear()
        assert all(len(number) == 1 for number in numbers)
        assert numbers[0] == {Command.NAV_RETURN_TO_LAUNCH}
        assert not client.state.connected
        aircraft.come_back()
        await client.wait_for(lambda state: state.connected, PATIENCE_S)
        assert (await client.return_to_launch()).accepted
    with pytest.raises(NotConnectedError):
        await client.return_to_launch()


@pytest.mark.parametrize(
    ("manner", "kind", "mode"), [("ardupilot", PLANE, 12.0), ("ardupilot", COPTER, 17.0)]
)
async def test_one_that_was_disarmed_when_it_fell_silent_may_fly(manner: str, kind: int, mode: float) -> None:
    """Somebody else may have started it: hold is that of the air, never a mode of the ground."""
    async with flying(manner, kind, lost_after_s=LOST_AFTER_S) as (client, aircraft):
        aircraft.armed = False
        await client.wait_for(lambda state: not state.armed, PATIENCE_S)
        aircraft.vanish()
        await client.wait_for(lambda state: not state.connected, PATIENCE_S)
        await client.hold()
        assert {parameters[1] for number, parameters in aircraft.commands if number == 176} == {mode}


async def test_a_stop_goes_on_when_the_vehicle_is_found_to_be_silent() -> None:
    """Given just before the loss is known it is sent as often as just after; others end with the loss."""
    async with flying(lost_after_s=LOST_AFTER_S) as (client, aircraft):
        counts = []
        for early in (True, False):
            aircraft.vanish()
            if not early:
                await client.wait_for(lambda state: not state.connected, PATIENCE_S)
            aircraft.commands.clear()
            other = asyncio.create_task(client.resume()) if early else None
            assert (await client.return_to_launch()).result is None
            assert not client.state.connected
            counts.append([number for number, _ in aircraft.commands].count(Command.NAV_RETURN_TO_LAUNCH))
            if other is not None:
                assert (await other).result is None
            aircraft.come_back()
            await client.wait_for(lambda state: state.connected, PATIENCE_S)
        assert counts[0] == counts[1] > 1
