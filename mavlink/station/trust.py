"""Whether what is heard is the vehicle's, and orders reach it alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from mavlink.links.link import Link, OpenLink, ReplayLink
from mavlink.state.telemetry import TWO_AIRCRAFT, Doubt, VehicleState
from mavlink.station.identity import is_autopilot
from mavlink.station.peers import Peers
from mavlink.station.twins import Twins
from mavlink.wire.messages import Message
from mavlink.wire.signing import Signing, Verdict

#: What the signatures of the vehicle's heartbeats say counts this long.
_SAID_FOR_S: Final = 10.0
_ABSENCES: Final = {
    Verdict.UNSIGNED: "system {0} is heard, but does not sign, and where a key is known nothing unsigned"
    " counts: have it sign with the key (swathplan signing set-up), or give no key of it here and connect it"
    " anew",
    Verdict.WRONG_KEY: "system {0} signs with another key than the one known here: give its key here, or hand"
    " it this one over a link that it trusts",
    Verdict.REPLAYED: "system {0} signs with the right key and a time long past: its clock is behind, or"
    " somebody plays old frames; a vehicle takes the time from what it hears of here",
}


class Trust:
    """Who is believed on a link.

    Parameters
    ----------
    system_id
        The vehicle's; 0 takes the first autopilot heard.
    changed
        Called when ``told`` would say something else.
    """

    def __init__(
        self, link: Link, system_id: int, clock: Callable[[], float], changed: Callable[[], None]
    ) -> None:
        self._clock = clock
        self._system_id = system_id
        self._changed = changed
        self._said: dict[Verdict, tuple[int, float]] = {}
        self._twins = Twins()
        self._live = not isinstance(link, ReplayLink)
        self._peers: Peers | None = None
        if isinstance(link, OpenLink) and link.listens:
            self._peers = Peers(system_id, clock, changed)
            link.believe(self._peers)

    def told(self, state: VehicleState) -> VehicleState:
        """The state with all that is doubted; the same object when nothing has changed."""
        strangers: tuple[str, ...] = ()
        address = None
        if self._peers is not None:
            strangers = tuple(stranger.address for stranger in self._peers.strangers)
            address = self._peers.place
        doubt = self._doubt(state)
        verdict = self._verdict(connected=state.connected)
        signing = None if verdict is None else verdict.value
        now = (address, strangers, doubt, signing)
        if now == (state.address, state.strangers, state.doubt, state.signing):
            return state
        return replace(state, address=address, strangers=strangers, doubt=doubt, signing=signing)

    def verify(self, signing: Signing | None) -> None:
        """Let nothing count from now on but what this verifies."""
        self._said.clear()
        if self._peers is not None:
            self._peers.signing = signing

    def noted(self, message: Message, verdict: Verdict) -> None:
        """What the signature of a message heard says: of the vehicle's heartbeats alone it is told."""
        if is_autopilot(message) and self._system_id in (0, message.system_id):
            new = self._verdict(connected=True) is not verdict
            self._said[verdict] = message.system_id, self._clock()
            if new:
                self._changed()

    @property
    def said(self) -> Verdict | None:
        """What the signature of the vehicle's last heartbeat said; None where none was looked at lately."""
        return self._verdict(connected=False)

    def _verdict(self, *, connected: bool) -> Verdict | None:
        """What the signatures say; forgeries beside what is genuine say nothing of the vehicle."""
        fresh_s = self._clock() - _SAID_FOR_S
        fresh = {verdict: at_s for verdict, (_, at_s) in self._said.items() if at_s > fresh_s}
        if connected and Verdict.GENUINE in fresh:
            return Verdict.GENUINE
        return max(fresh, key=fresh.__getitem__, default=None)

    def _doubt(self, state: VehicleState) -> Doubt | None:
        if state.connected and self._twins.told(self._clock()):
            return Doubt(
                TWO_AIRCRAFT,
                f"two aircraft speak in turns as system {state.system_id} on this link: what one is ordered,"
                " both do",
                "switch one of them off, or give it another system id",
            )
        if self._live and state.connected and self._verdict(connected=True) is Verdict.UNVERIFIED:
            return Doubt(
                "no-signing-key",
                f"system {state.system_id} signs its frames, and no key of it is known here: they cannot be"
                " verified, and it does not hear what is not signed",
                "give its key (docs/security.md), or have it sign no more",
            )
        peers = self._peers
        if peers is None or peers.acknowledged or not peers.rivals:
            return None
        others = ", ".join(stranger.address for stranger in peers.rivals)
        system_id = peers.rivals[0].system_id
        if state.connected:
            return Doubt(
                TWO_AIRCRAFT,
                f"two aircraft say that they are system {system_id}: one at {peers.place}, which is heard, "
                f"and {others}, which is not",
                "give one of them another system id, or acknowledge the address of the one that is meant",
            )
        return Doubt(
            "another-address",
            f"system {system_id} speaks from {others} and not from {peers.place}, where it was",
            "acknowledge its address if it is the same aircraft",
        )

    @property
    def absence(self) -> str | None:
        """Why a vehicle that speaks is not heard; None where it is silent."""
        verdict = self._verdict(connected=False)
        if verdict in _ABSENCES:
            return _ABSENCES[verdict].format(self._said[verdict][0])
        doubt = self._doubt(VehicleState())
        return None if doubt is None else f"{doubt.message}: {doubt.fix}"

    def acknowledge(self, address: str) -> bool:
        """Take an address heard lately for the vehicle's; False when it was not heard."""
        return self._peers is not None and self._peers.acknowledge(address)

    def heard(self, message: Message, now_s: float) -> None:
        """The vehicle, or another one under its ids, has spoken."""
        self._twins.heard(message, now_s)

    def connected(self, system_id: int) -> None:
        """The vehicle is there."""
        self._system_id = system_id
        if self._peers is not None:
            self._peers.heard()

    def lost(self) -> None:
        """The vehicle has fallen silent."""
        if self._peers is not None:
            self._peers.lost()

    def adopt(self, system_id: int) -> None:
        """Another aircraft is the vehicle from now on."""
        self._twins = Twins()
        self._system_id = system_id
        self._said.clear()
        if self._peers is not None:
            self._peers.adopt(system_id)

    def let_time_pass(self) -> None:
        """Forget who is silent."""
        if self._peers is not None:
            self._peers.let_time_pass()
