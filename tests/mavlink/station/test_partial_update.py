"""Partial updates by the client: read back, compared, in flight, in bad weather, and refused by name."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mavlink.errors import NotConnectedError, UnsupportedError
from mavlink.links.link import memory_pair
from mavlink.sim.faults import Fault
from mavlink.sim.modes import Flavour
from mavlink.station.client import VehicleClient
from mavlink.station.verify import VerifiedUpload
from mavlink.transfer.outcome import Accepted, Refused, Unknown
from mavlink.wire.items import MissionItem, MissionResult, MissionType
from tests.mavlink.station.aircraft import flying
from tests.mavlink.station.test_client_faults import comparison, mission, simulated
from tests.mavlink.station.test_client_transfers import compare
from tests.mavlink.transfer.vehicle import waypoints
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

MISSION = MissionType.MISSION
CHANGED = range(5, 8)


def raised(items: tuple[MissionItem, ...], changed: range = CHANGED) -> tuple[MissionItem, ...]:
    """The mission with the items of a range 50 m higher."""
    return tuple(replace(item, z=item.z + 50.0) if item.seq in changed else item for item in items)


async def update(client: VehicleClient, flavour: Flavour = Flavour.ARDUPILOT) -> VerifiedUpload:
    return await client.update_items(raised(mission(flavour)), CHANGED, comparison(flavour))


async def test_items_are_replaced_and_the_whole_is_read_back() -> None:
    """Three items cross the air, the mission held is the one meant, and the next comparison is by it."""
    async with flying() as (client, aircraft):
        assert (await client.upload_verified(waypoints(12), MISSION, compare)).status == "stored"
        aircraft.heard.clear()
        result = await client.update_items(raised(waypoints(12)), CHANGED, compare)
        assert (result.status, result.outcome) == ("stored", Accepted())
        assert result.held == raised(waypoints(12)) == aircraft.vehicle.held[0]
        sent = [word.integer("seq") for word in aircraft.heard if word.name == "MISSION_ITEM_INT"]
        assert sent == [5, 6, 7]
        assert not [word for word in aircraft.heard if word.name == "MISSION_COUNT"]


async def test_what_else_differs_is_found_out() -> None:
    """The vehicle held another mission than thought: the read-back names all the rest."""
    async with flying() as (client, aircraft):
        aircraft.vehicle.held[0] = tuple(replace(item, z=1.0) for item in waypoints(12))
        result = await client.update_items(raised(waypoints(12)), CHANGED, compare)
        assert (result.status, result.outcome) == ("different", Accepted())
        assert [difference.seq for difference in result.differences] == [0, 1, 2, 3, 4, 8, 9, 10, 11]


@pytest.mark.parametrize("manner", ["px4", "generic"])
async def test_other_autopilots_are_not_asked(manner: str) -> None:
    """PX4 would ignore it: the refusal says what to do, and nothing is sent."""
    async with flying(manner) as (client, aircraft):
        await client.upload_verified(waypoints(12), MISSION, compare)
        with pytest.raises(UnsupportedError, match="takes no partial update: upload whole"):
            await client.update_items(raised(waypoints(12)), CHANGED, compare)
        assert not [word for word in aircraft.heard if word.name == "MISSION_WRITE_PARTIAL_LIST"]


@pytest.mark.parametrize("changed", [range(5, 5), range(5, 13), range(-1, 3), range(8, 5), range(1, 9, 2)])
async def test_a_range_that_is_none_is_refused(changed: range) -> None:
    """Empty, past the end, backwards or with gaps: nothing is sent."""
    async with flying() as (client, _):
        with pytest.raises(ValueError, match="no run of the mission's 12 items"):
            await client.update_items(waypoints(12), changed, compare)


async def test_home_cannot_be_replaced() -> None:
    """Item 0 is ArduPilot's home row."""
    async with flying() as (client, _):
        with pytest.raises(ValueError, match="item 0 is home"):
            await client.update_items(waypoints(12), range(0, 3), compare)


async def test_an_update_of_nobody_is_refused() -> None:
    """Without a vehicle nothing is begun."""
    ground, air = memory_pair()
    async with VehicleClient(ground, clock=loop_time_s) as client:
        with pytest.raises(NotConnectedError):
            await client.update_items(waypoints(12), CHANGED, compare)
    await air.close()


@pytest.mark.parametrize("result", [r for r in MissionResult if r not in (0, 1, 13, 14)])
async def test_a_refused_item_leaves_a_mixture_that_is_told(result: MissionResult) -> None:
    """Item 6 is refused: 5 is new, 6 and 7 are old, and the read-back says so."""
    async with flying() as (client, aircraft):
        aircraft.vehicle.held[0] = waypoints(12)
        aircraft.vehicle.refuse_item = {6: result}
        upload = await client.update_items(raised(waypoints(12)), CHANGED, compare)
        assert (upload.status, upload.outcome) == ("refused", Refused(result, 6))
        assert [difference.seq for difference in upload.differences] == [6, 7]


# What comes of it on the simulated aircraft, by fault.
EXPECTED = {
    None: ("stored", Accepted),
    Fault.NO_RESPONSE_TO_FIRST_COUNT: ("stored", Accepted),
    Fault.WRONG_SEQUENCE_REQUEST: ("stored", Accepted),
    Fault.NO_FINAL_ACK: ("stored", Accepted),
    Fault.LOST_ITEMS: ("stored", Accepted),
    Fault.LOST_REQUESTS: ("stored", Accepted),
    Fault.LOST_DOWNLOAD_ITEMS: ("stored", Accepted),
    Fault.ERROR_ACK_AT_END: ("stored", Accepted),
    Fault.NO_RESPONSE_TO_LIST: ("unknown", Unknown),
    Fault.ALTERED_ITEM: ("different", Accepted),
}


@pytest.mark.parametrize("fault", EXPECTED)
async def test_every_fault_has_its_word(fault: Fault | None) -> None:
    """What is held as meant is called stored, and nothing else is."""
    async with simulated(Flavour.ARDUPILOT, *([] if fault is None else [fault])) as client:
        # The mission goes up over the same fault, which takes no item from it.
        await client.upload(mission(Flavour.ARDUPILOT), MISSION)
        result = await update(client)
    assert (result.status, type(result.outcome)) == EXPECTED[fault]
