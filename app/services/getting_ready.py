"""What the log says while planning processes get ready: after an install they compile for a minute."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Sequence
from typing import Final

import structlog

from app.services.plans.pool import Pool

log = structlog.get_logger(__name__)

#: Kept kernels are loaded by then; said again so often.
SOON_S: Final = 10.0
AGAIN_S: Final = 30.0
_LOOK_S: Final = 0.2


async def tell_until_ready(
    pools: Sequence[Pool], soon_s: float = SOON_S, again_s: float = AGAIN_S, look_s: float = _LOOK_S
) -> None:
    """Say what is waited for where it takes its time, and once when all is ready."""
    began_s = time.monotonic()
    next_s = soon_s
    while not all(pool.ready for pool in pools):
        await asyncio.sleep(look_s)
        waited_s = time.monotonic() - began_s
        if waited_s >= next_s:
            next_s = waited_s + again_s
            log.info(
                "planning processes are getting ready",
                reason="kernels are compiled, once after an install, by one process; plans wait",
                waited_s=round(waited_s),
            )
    log.info("planning processes are ready", after_s=round(time.monotonic() - began_s, 1))
