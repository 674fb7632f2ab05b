"""What is asked for and judged follows the firmware's version, and an unknown one is said."""

from __future__ import annotations

import asyncio

import pytest
from pymavlink.dialects.v20 import ardupilotmega

from app.services.vehicles.inspection import read_parameters
from mavlink.links.memory import memory_pair
from mavlink.rules.base import OTHER_NAMES
from mavlink.rules.firmware import called, note_on, still_to_ask, version_of
from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve_link
from mavlink.sim.settings import SimSettings
from mavlink.state.telemetry import VehicleState, updated
from mavlink.station.client import VehicleClient
from mavlink.transfer.machine import TransferSettings
from mavlink.wire.codec import Codec
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

#: What ArduCopter and ArduPlane call them, by the releases' own lists of changed names.
NAMES = {
    "WPNAV_SPEED": {"4.5.7": "WPNAV_SPEED", "4.6.3": "WPNAV_SPEED", "4.7.0": "WP_SPD", "4.8.0": "WP_SPD"},
    "RTL_ALT": {"4.6.3": "RTL_ALT", "4.7.0": "RTL_ALT_M"},
    "ROLL_LIMIT_DEG": {"4.4.4": "LIM_ROLL_CD", "4.5.0": "ROLL_LIMIT_DEG", "4.7.0": "ROLL_LIMIT_DEG"},
    "MNT1_TYPE": {"4.2.3": "MNT_TYPE", "4.3.0": "MNT1_TYPE"},
    "WP_RADIUS": {"4.4.0": "WP_RADIUS", "4.7.0": "WP_RADIUS"},
}


@pytest.mark.parametrize("name", NAMES)
def test_parameters_are_called_as_the_version_does(name: str) -> None:
    """Each by its name in that release; as the table does where the version is not known, and on PX4."""
    for firmware, there in NAMES[name].items():
        assert called([name], "ardupilot", firmware) == (there,)
    assert called([name], "ardupilot", None) == called([name], "px4", "1.16.0") == (name,)


def test_every_name_is_asked_for_by_both() -> None:
    """Whichever version it is and whatever is answered, no name is left unasked, and none asked twice."""
    for firmware in (None, "4.4.0", "4.6.0", "4.7.1"):
        first = called(OTHER_NAMES, "ardupilot", firmware)
        others = still_to_ask(OTHER_NAMES, first, ())
        both = {name for pair in ((own, other) for own, (other, _) in OTHER_NAMES.items()) for name in pair}
        assert set(first) | set(others) == both
        assert not set(first) & set(others)
        assert still_to_ask(OTHER_NAMES, first, first) == ()


def test_versions_that_were_not_looked_at_are_said() -> None:
    """Newer, older and unknown ones; those of other autopilots are nobody's."""
    assert [note_on("ardupilot", v) for v in ("4.5.0", "4.6.3", "4.7.2")] == [None] * 3
    assert [note_on("px4", v) for v in ("1.15.4", "1.16.0", "1.17.0")] == [None] * 3
    assert note_on("generic", None) is None
    for autopilot, firmware in (("ardupilot", "4.8.0"), ("ardupilot", "4.4.4"), ("px4", "1.14.3")):
        note = note_on(autopilot, firmware)  # type: ignore[arg-type]
        assert note is not None
        assert firmware in note
    assert "not known" in (note_on("px4", None) or "")


def test_the_version_is_that_of_the_message() -> None:
    """As pymavlink packs AUTOPILOT_VERSION; one without a version tells nothing."""
    sender = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    for packed, told in ((4 << 24 | 6 << 16 | 3 << 8 | 255, "4.6.3"), (0, None)):
        message = ardupilotmega.MAVLink_autopilot_version_message(
            0, packed, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0
        )
        (read,) = Codec().feed(message.pack(sender))
        assert updated(VehicleState(), read, 0.0).firmware == told
    assert version_of("4.6.3") == (4, 6)


@pytest.mark.parametrize("firmware", [(4, 6), (4, 7), (4, 9)])
async def test_a_multirotor_is_read_whatever_its_version(firmware: tuple[int, int]) -> None:
    """Its version is told, all its parameters are found, and their values mean the same."""
    ground, air = memory_pair()
    settings = SimSettings(autopilot=Flavour.ARDUPILOT, vehicle_type="multirotor", firmware=firmware)
    flying = asyncio.create_task(serve_link(air, settings))
    hasty = TransferSettings(timeout_s=0.15, item_timeout_s=0.025)
    wanted = ("WPNAV_SPEED", "WPNAV_ACCEL", "WPNAV_JERK", "LAND_SPEED", "RTL_ALT", "ANGLE_MAX")
    async with VehicleClient(ground, settings=hasty, clock=loop_time_s) as client:
        await client.connect(5)
        await client.wait_for(lambda state: state.firmware is not None, PATIENCE_S)
        assert client.state.firmware == f"{firmware[0]}.{firmware[1]}.0"
        report = await read_parameters(client, wanted, None)
    flying.cancel()
    await asyncio.gather(flying, return_exceptions=True)
    assert report.missing == ()
    values = {value.name: value.value for value in report.values}
    new = firmware >= (4, 7)
    assert values["WP_SPD" if new else "WPNAV_SPEED"] == (20.0 if new else 2000.0)
