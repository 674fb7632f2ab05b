"""What the service asks of the process that holds the links, over its socket."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx

from app.services.errors import LinkError

_TIMEOUT_S = 5.0
_FLIGHT_ID = re.compile(r"[0-9a-f-]{36}")


@dataclass(frozen=True, slots=True)
class LinksState:
    """How the process stands; ``in_use`` names vehicles, not simulated ones, that are armed or in flight."""

    pid: int
    vehicles: int
    in_use: tuple[str, ...]


class LinksClient:
    """Questions to the process that holds the links."""

    def __init__(self, socket: Path) -> None:
        transport = httpx.AsyncHTTPTransport(uds=str(socket))
        self._client = httpx.AsyncClient(transport=transport, base_url="http://localhost", timeout=_TIMEOUT_S)

    async def close(self) -> None:
        """Hang up."""
        await self._client.aclose()

    async def state(self) -> LinksState:
        """How it stands; raises LinkError when it does not answer."""
        found = await self._ask("GET", "/links")
        return LinksState(found["pid"], found["vehicles"], tuple(found["in_use"]))

    async def answers(self) -> bool:
        """Whether it is there."""
        try:
            await self.state()
        except LinkError:
            return False
        return True

    async def place_in_flight(self, flight_id: str) -> tuple[float, float, float | None] | None:
        """As ``Fleet.place_in_flight``; what is no id of a flight is nowhere."""
        if _FLIGHT_ID.fullmatch(flight_id) is None:
            return None
        place = (await self._ask("GET", f"/links/flights/{flight_id}"))["place"]
        return None if place is None else (place[0], place[1], place[2])

    async def greet(self, wishes: dict[str, Any]) -> None:
        """Let it connect the vehicles wished for at the start."""
        await self._ask("POST", "/links/greet", wishes)

    async def metrics(self) -> str:
        """Its figures for Prometheus."""
        return str((await self._ask("GET", "/links/metrics"))["text"])

    async def end(self) -> None:
        """Tell it to end."""
        await self._ask("POST", "/links/end")

    async def _ask(self, method: str, path: str, body: dict[str, Any] | None = None) -> dict[str, Any]:
        try:
            answer = await self._client.request(method, path, json=body)
            answer.raise_for_status()
        except httpx.HTTPError as error:
            raise LinkError(f"the process that holds the links does not answer: {error}") from error
        found: dict[str, Any] = answer.json()
        return found
