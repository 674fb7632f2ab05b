"""How often vehicles are looked at, and how patient the service is with their links."""

from __future__ import annotations

from dataclasses import dataclass

from mavlink.transfer.machine import DEFAULT_SETTINGS, TransferSettings

#: Whoever watches a vehicle that says nothing is told so at least this often.
TELL_S = 1.0


@dataclass(frozen=True, slots=True)
class LinkTimes:
    """Times of a vehicle's link.

    Parameters
    ----------
    telemetry_s
        Listeners get a new state no more often than this.
    look_s
        How often flights are looked at.
    replay_look_s
        The same for recordings, which may run fast.
    reopen_s
        How long after a link has failed it is opened anew, again and again.
    lost_after_s
        A vehicle silent this long counts as lost.
    transfers
        Time-outs and retries of transfers and commands.
    """

    telemetry_s: float = 0.2
    look_s: float = 0.5
    replay_look_s: float = 0.05
    reopen_s: float = 2.0
    lost_after_s: float = 5.0
    transfers: TransferSettings = DEFAULT_SETTINGS


#: The protocol's recommendations, and what suits people who watch.
DEFAULT_TIMES = LinkTimes()
