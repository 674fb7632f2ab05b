"""Who goes first where the processor is short."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import Final

#: How many steps of ``nice`` the links and the door stand before the service.
_STEPS: Final = 5
_GROUP: Final = Path("/proc/self/autogroup")
#: Where workers stand: behind all of them.
_BEHIND: Final = 10


def go_first() -> None:
    """Before other processes, where the system lets this one (RLIMIT_NICE, CAP_SYS_NICE); else among them."""
    with contextlib.suppress(PermissionError):
        os.nice(-_STEPS)
    if os.getsid(0) == os.getpid() and _GROUP.exists():
        # Between sessions Linux weighs these groups, and not the processes in them (sched(7), autogroup).
        with contextlib.suppress(OSError):
            _GROUP.write_text(str(-_STEPS))


def go_usual() -> None:
    """Among other processes, whoever started this one."""
    _no_further_than(0)


def stand_back() -> None:
    """Behind other processes."""
    _no_further_than(_BEHIND)


def _no_further_than(niceness: int) -> None:
    now = os.getpriority(os.PRIO_PROCESS, 0)
    if now < niceness:
        os.nice(niceness - now)
