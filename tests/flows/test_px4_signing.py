"""A real PX4 and a signing key: before 1.17 it takes none, which is said, and all goes on as before.

Skipped unless ``SWATHPLAN_PX4`` and ``SWATHPLAN_PX4_ROMFS`` name a simulator; see ``px4.py``.
"""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from mavlink.errors import SigningError
from mavlink.rules.firmware import version_of
from mavlink.wire.items import MissionType
from mavlink.wire.signing import Signing, SigningKey
from tests.flows.px4 import BINARY, ROMFS, simulated
from tests.patience import PATIENCE_S

pytestmark = [
    pytest.mark.px4,
    pytest.mark.skipif(not (BINARY and ROMFS), reason="SWATHPLAN_PX4 and …_ROMFS name no simulator"),
]

HOME = (8.5456, 47.3977)
#: The first version that signs.
SIGNS = (1, 17)


async def test_px4_takes_a_key_or_it_is_said_that_it_does_not(tmp_path: Path) -> None:
    """Its version is told; handed a key it signs from 1.17 on, and before it stays as it was."""
    async with simulated(tmp_path, HOME, 1.0) as client:
        await client.wait_for(lambda state: state.firmware is not None, PATIENCE_S)
        version = version_of(client.state.firmware)
        assert version is not None
        key = Signing(SigningKey(bytes(range(32))), time.time)
        if version < SIGNS:
            with pytest.raises(SigningError, match=r"1\.17"):
                await client.set_up_signing(key)
            await client.wait_for(lambda state: state.connected and state.signing is None, PATIENCE_S)
        else:
            await client.set_up_signing(key)
            assert client.state.signing == "verified"
        assert await client.download(MissionType.MISSION) == ()
