"""What goes wrong again and again, told now and then."""

from __future__ import annotations

import asyncio
import errno
import logging
import time
from typing import Any, Final

log = logging.getLogger(__name__)

#: asyncio tries to accept once a second while there are no descriptors.
_TELL_S: Final = 60.0


class Quiet:
    """A handler of an event loop's exceptions: that there are no descriptors left is told once a minute."""

    def __init__(self) -> None:
        self._told_s = float("-inf")

    def __call__(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Take one."""
        error = context.get("exception")
        if not isinstance(error, OSError) or error.errno not in (errno.EMFILE, errno.ENFILE):
            loop.default_exception_handler(context)
        elif time.monotonic() - self._told_s >= _TELL_S:
            self._told_s = time.monotonic()
            log.error("no connection can be accepted: %s; raise the limit of open files", error.strerror)
