"""The client against the simulated aircraft's named faults: what it says of each upload is so."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from dataclasses import replace
from functools import partial

import pytest

from mavlink.dialects import dialect_for
from mavlink.dialects.compare import differences
from mavlink.links.link import memory_pair
from mavlink.sim.faults import Fault
from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve_link
from mavlink.sim.settings import SimSettings
from mavlink.station.client import VehicleClient
from mavlink.station.verify import Compare
from mavlink.transfer.machine import TransferSettings
from mavlink.transfer.outcome import Accepted, Refused, Unknown
from mavlink.wire.items import Command, MissionItem, MissionType
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

# The count and questions are repeated early; the patience with a vehicle that asks again each second stays.
QUICK = TransferSettings(timeout_s=0.8, retries=3, silence_s=4.0, acknowledgement_s=2.5)
ITEMS = (
    MissionItem(0, 0, Command.NAV_WAYPOINT, x=473_977_000, y=85_456_000, z=488.0),
    MissionItem(1, 3, Command.NAV_TAKEOFF, 15.0, x=473_990_000, y=85_456_000, z=80.0),
    *[
        MissionItem(seq, 3, Command.NAV_WAYPOINT, x=473_990_000 + 9_000 * seq, y=85_456_000, z=100.0)
        for seq in range(2, 12)
    ],
    MissionItem(12, 2, Command.NAV_RETURN_TO_LAUNCH),
)


def mission(flavour: Flavour) -> tuple[MissionItem, ...]:
    """Home row, take-off, ten waypoints and the way home; PX4 has no home row, and frame 6 for 3."""
    if flavour is Flavour.ARDUPILOT:
        return ITEMS
    return tuple(
        replace(
            item,
            seq=item.seq - 1,
            frame=6 if item.frame == 3 else item.frame,
            param1=0.0,
            current=item.seq == 1,
        )
        for item in ITEMS[1:]
    )


@contextlib.asynccontextmanager
async def simulated(flavour: Flavour, *faults: Fault) -> AsyncIterator[VehicleClient]:
    """A client connected to a simulated aircraft with faults."""
    ground, air = memory_pair()
    settings = SimSettings(autopilot=flavour, faults=faults, vanish_for_s=2.0)
    stop = asyncio.Event()
    flight = asyncio.create_task(serve_link(air, settings, stop=stop))
    try:
        async with VehicleClient(ground, settings=QUICK, lost_after_s=1.5, clock=loop_time_s) as client:
            await client.connect(10)
            yield client
    finally:
        stop.set()
        await flight
        await air.close()


# The status and the kind of outcome; by autopilot where they differ.
EXPECTED: dict[Fault, tuple[str, type | None] | dict[Flavour, tuple[str, type | None]]] = {
    Fault.NO_RESPONSE_TO_COUNT: ("different", Unknown),
    Fault.NO_RESPONSE_TO_FIRST_COUNT: ("stored", None),
    Fault.NO_REQUEST_0: ("different", Unknown),
    Fault.NO_REQUEST_1: ("different", Unknown),
    Fault.WRONG_REQUEST_AT_0: ("different", Unknown),
    Fault.WRONG_REQUEST_AT_1: ("different", Unknown),
    Fault.WRONG_SEQUENCE_REQUEST: ("stored", None),
    Fault.ERROR_ACK_AT_0: ("refused", Refused),
    Fault.ERROR_ACK_AT_1: ("refused", Refused),
    # ArduPilot says ERROR to a duplicate of the last item too: what it holds decides.
    Fault.ERROR_ACK_AT_END: {
        Flavour.ARDUPILOT: ("stored", Accepted),
        Flavour.PX4: ("refused", Refused),
    },
    Fault.NO_FINAL_ACK: ("stored", Accepted),
    Fault.EARLY_ACK: ("different", Unknown),
    Fault.LOST_ITEMS: ("stored", None),
    Fault.LOST_REQUESTS: ("stored", None),
    Fault.ALTERED_ITEM: ("different", None),
    Fault.NO_RESPONSE_TO_LIST: ("unknown", Unknown),
    Fault.NO_RESPONSE_TO_FIRST_LIST: ("stored", None),
    Fault.NO_ITEM_0: ("unknown", Unknown),
    Fault.NO_ITEM_1: ("unknown", Unknown),
    Fault.WRONG_ITEM_AT_0: ("unknown", Unknown),
    Fault.WRONG_ITEM_AT_1: ("unknown", Unknown),
    Fault.ERROR_ACK_FOR_ITEM_0: ("unknown", Unknown),
    Fault.ERROR_ACK_FOR_ITEM_1: ("unknown", Unknown),
    Fault.LOST_DOWNLOAD_ITEMS: ("stored", None),
    Fault.WRONG_TYPE_ACK: ("stored", Accepted),
    Fault.FOREIGN_ACK: ("stored", Accepted),
    Fault.COMPETING_STATION: ("refused", Refused),
    Fault.WRONG_OPAQUE_ID: ("stored", Accepted),
}
# Not of uploads, or with tests of their own.
ELSEWHERE = {
    Fault.VANISH_MID_UPLOAD,
    Fault.NO_COMMAND_ACK,
    Fault.DENY_ARM,
    Fault.SENSOR_DEAD,
    Fault.SENSOR_SKIPS,
    Fault.PHOTOS_LOST,
    Fault.FEEDBACK_LOST,
}


def comparison(flavour: Flavour) -> Compare:
    return partial(differences, dialect=dialect_for(flavour.value, "fixed_wing"))


def test_no_fault_is_left_out() -> None:
    """Every named fault has an expectation here, or a test elsewhere."""
    assert set(Fault) == set(EXPECTED) | ELSEWHERE


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("fault", EXPECTED)
async def test_every_fault_has_its_word(flavour: Flavour, fault: Fault) -> None:
    """What is stored is called stored, and nothing else is."""
    expected = EXPECTED[fault]
    status, outcome = expected[flavour] if isinstance(expected, dict) else expected
    async with simulated(flavour, fault) as client:
        result = await client.upload_verified(mission(flavour), MissionType.MISSION, comparison(flavour))
    assert result.status == status
    assert outcome is None or isinstance(result.outcome, outcome)


@pytest.mark.parametrize("flavour", Flavour)
async def test_an_aircraft_that_vanishes_is_resolved_on_its_return(flavour: Flavour) -> None:
    """Unknown while it is away; when it is back the read-back shows that the upload did not take."""
    async with simulated(flavour, Fault.VANISH_MID_UPLOAD) as client:
        compare = comparison(flavour)
        result = await client.upload_verified(mission(flavour), MissionType.MISSION, compare)
        assert (result.status, result.held, client.pending) == ("unknown", None, True)
        await client.wait_for(lambda state: state.connected, PATIENCE_S)
        resolved = await client.resolve_pending()
        assert resolved is not None
        assert resolved.held is not None
        assert resolved.status == "different"
        result = await client.upload_verified(mission(flavour), MissionType.MISSION, compare)
        assert result.status == "stored"


async def test_commands_without_an_answer_and_denied() -> None:
    """Silence is not success, and a denial is named."""
    async with simulated(Flavour.ARDUPILOT, Fault.NO_COMMAND_ACK) as client:
        outcome = await client.arm()
        assert outcome.result is None
    async with simulated(Flavour.ARDUPILOT, Fault.DENY_ARM) as client:
        outcome = await client.arm()
        assert outcome.result is not None
        assert not outcome.accepted
