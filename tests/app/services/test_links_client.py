"""What the service asks of the process that holds the links."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.services.errors import LinkError
from app.services.links.client import LinksClient


@pytest.mark.parametrize("odd", ["", "..", "../end", "a/b?c#d", "\x19,x\n", "\ud7ff", "a" * 10_000])
async def test_what_is_no_flight_is_not_asked_for(odd: str) -> None:
    """It is nowhere, whatever it is made of; for a flight the process is asked, and missed."""
    client = LinksClient(Path("/no/such/socket"))
    assert await client.place_in_flight(odd) is None
    with pytest.raises(LinkError):
        await client.place_in_flight("0" * 8 + "-0000-0000-0000-" + "0" * 12)
    await client.close()
