"""What the log says until planning processes are ready."""

from __future__ import annotations

from typing import Any

from structlog.testing import capture_logs

from app.services.getting_ready import tell_until_ready


class Slow:
    """A pool that is ready when it was looked at so often."""

    def __init__(self, looks: int) -> None:
        self._looks = looks

    @property
    def ready(self) -> bool:
        self._looks -= 1
        return self._looks < 0


async def said(looks: int) -> list[str]:
    pools: Any = (Slow(0), Slow(looks))
    with capture_logs() as entries:
        await tell_until_ready(pools, soon_s=0.02, again_s=10.0, look_s=0.01)
    return [entry["event"] for entry in entries]


async def test_what_is_ready_at_once_is_said_once() -> None:
    assert await said(0) == ["planning processes are ready"]


async def test_what_takes_its_time_is_said_not_too_often() -> None:
    assert await said(20) == ["planning processes are getting ready", "planning processes are ready"]
