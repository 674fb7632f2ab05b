"""A real ArduPlane signs: a key handed over, missions and orders signed, strangers refused, the key given up.

Skipped unless ``SWATHPLAN_ARDUPLANE`` names the simulator's binary; see ``arduplane.py``.
"""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from mavlink.errors import DoubtError, NotConnectedError
from mavlink.links.link import open_link
from mavlink.station.client import VehicleClient
from mavlink.wire.items import Command, MissionType
from mavlink.wire.signing import Signing, SigningKey
from tests.flows.arduplane import BINARY, arduplane, booted
from tests.mavlink.transfer.vehicle import waypoints
from tests.patience import PATIENCE_S

pytestmark = [
    pytest.mark.ardupilot,
    pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator"),
]

HOME = (8.5456, 47.3977)
SECRET, OTHER = bytes(range(32)), bytes(range(1, 33))


def signing(secret: bytes, link_id: int) -> Signing:
    """Signatures by this machine's clock."""
    return Signing(SigningKey(secret), time.time, link_id)


async def test_arduplane_signs(tmp_path: Path) -> None:
    """Over its USB port it is handed a key; its other port takes nothing unsigned, and everything signed."""
    link, radio = await open_link("udpin:127.0.0.1:0"), await open_link("udpin:127.0.0.1:0")
    port, other = (int(each.url.rpartition(":")[2]) for each in (link, radio))
    with arduplane(tmp_path, port, HOME, 5.0, serial1=f"udpclient:127.0.0.1:{other}"):
        async with VehicleClient(link) as client:
            await booted(client)
            assert client.state.signing is None
            await client.set_up_signing(signing(SECRET, 0))
            items = waypoints(12)
            assert (await client.upload(items, MissionType.MISSION)).kind == "accepted"
            assert len(await client.download(MissionType.MISSION)) == 12
            assert client.state.signing == "verified"

            async with VehicleClient(radio) as stranger:
                assert (await stranger.connect(20)).signing == "no_key"
                with pytest.raises(DoubtError, match="no key of it is known"):
                    await stranger.arm()
                assert (await stranger.return_to_launch()).result is None
                assert client.state.mode != "RTL"
            radio = await open_link(f"udpin:127.0.0.1:{other}")
            async with VehicleClient(radio, signing=signing(OTHER, 2)) as stranger:
                stranger._driver.start()
                await stranger.wait_for(lambda state: state.signing == "wrong_key", PATIENCE_S)
                with pytest.raises(NotConnectedError, match="another key"):
                    stranger.require_certain()
            radio = await open_link(f"udpin:127.0.0.1:{other}")
            async with VehicleClient(radio, signing=signing(SECRET, 1)) as second:
                assert (await second.connect(20)).signing == "verified"
                assert (await second.command(Command.NAV_RETURN_TO_LAUNCH)).accepted
                await second.wait_for(lambda state: state.mode == "RTL", PATIENCE_S)

            await client.stop_signing()
            assert len(await client.download(MissionType.MISSION)) == 12
